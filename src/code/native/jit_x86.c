/* jit_x86.c - from a plan to machine code in one pass: a function for every kind of operation
 * takes the operands where they are, writes the instruction and says where the result is. All
 * roads round as dm_op_value does: no contraction but the operation fma, library functions
 * called.
 *
 *   rdi/rbx pool   rsi/r14 in   rdx/r15 out   rsp stack   (the second where there are calls)
 *
 * The body is written first and the prologue put before it, since only then it is known how
 * much stack the kernel wants. A kernel whose frame or displacements would be too large is
 * refused.
 * Speed: P4: 24x, against the tape. */
#include "code/native/jit.h"

#include "algebra/compact.h"
#include "code/implicit/implicit_kernel.h"
#include "code/native/code_memory.h"
#include "code/native/jit_pool.h"
#include "code/native/jit_root.h"
#include "code/tape/tape.h"
#include "graph/nodes.h"
#include "numbers/fma.h"

#include <string.h>

/* lanes that the user allows (dm_jit_limit), in the whole process */
static uint32_t limit = 8;

void dm_jit_limit(uint32_t lanes) {
    limit = lanes;
}

#if defined(__x86_64__)

/* AVX for 4 lanes, AVX-512 with its parts F, DQ and VL for 8 */
static uint32_t processor_lanes(void) {
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx")) return 0;
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl")
               ? 8
               : 4;
}

uint32_t dm_jit_lanes(void) {
    const uint32_t own = processor_lanes(), most = own < limit ? own : limit;
    return most >= 8 ? 8 : most >= 4 ? 4 : most != 0;
}

/* for those the operand in memory can be the second one */
static int is_commutative(uint8_t op) {
    return op == DM_OP_ADD || op == DM_OP_MUL;
}

/* d = a op b; min and max take their operands the other way round, as b < a ? b : a asks */
static void two_operands(dm_emitter *e, const dm_step *s, int opcode) {
    dm_node a = s->arg[0], b = s->arg[1];
    const int swap = s->op == DM_OP_MIN || s->op == DM_OP_MAX ||
                     (is_commutative(s->op) && e->at[a].reg < 0 && e->at[b].reg >= 0);
    if (swap) a = s->arg[1], b = s->arg[0];
    const int first = dm_in_a_register(e, a);
    const dm_operand second = dm_anywhere(e, b);
    dm_pass_operands(e, s);
    const int d = dm_take_register(e);
    dm_x86_op(&e->code, e->width, opcode, d, first, second);
    dm_define(e, s->d, d);
}

/* a second operand from the masks, or the same register again */
static void one_operand(dm_emitter *e, const dm_step *s, int opcode, int mask) {
    const int a = dm_in_a_register(e, s->arg[0]);
    dm_pass_operands(e, s);
    const int d = dm_take_register(e);
    const dm_operand second = mask < 0 ? dm_in_register(a) : dm_pool_mask(e, mask);
    dm_x86_op(&e->code, e->width, opcode, d, a, second);
    dm_define(e, s->d, d);
}

/* (x > 0) - (x < 0) out of ones and zeros */
static void sign(dm_emitter *e, const dm_step *s) {
    const int a = dm_in_a_register(e, s->arg[0]), d = dm_take_register(e), t = dm_take_register(e);
    static const int relations[2] = {DM_X86_GREATER, DM_X86_LESS};
    const int to[2] = {d, t};
    for (int k = 0; k < 2; k++) {
        if (e->width == DM_LANES8) {
            dm_x86_compare(&e->code, e->width, 1, a, dm_pool_mask(e, DM_POOL_ZERO), relations[k]);
            dm_x86_load_masked(&e->code, to[k], 1, dm_pool_mask(e, DM_POOL_ONE));
            continue;
        }
        dm_x86_compare(&e->code, e->width, to[k], a, dm_pool_mask(e, DM_POOL_ZERO), relations[k]);
        dm_x86_op(&e->code, e->width, DM_X86_AND, to[k], to[k], dm_pool_mask(e, DM_POOL_ONE));
    }
    dm_x86_op(&e->code, e->width, DM_X86_SUB, d, d, dm_in_register(t));
    dm_pass_operands(e, s);
    dm_define(e, s->d, d);
}

/* a > 0 ? b : c */
static void where(dm_emitter *e, const dm_step *s) {
    const int a = dm_in_a_register(e, s->arg[0]), yes = dm_in_a_register(e, s->arg[1]),
              no = dm_in_a_register(e, s->arg[2]), d = dm_take_register(e);
    const int mask = e->width == DM_LANES8 ? 1 : d;
    dm_x86_compare(&e->code, e->width, mask, a, dm_pool_mask(e, DM_POOL_ZERO), DM_X86_GREATER);
    dm_x86_blend(&e->code, e->width, d, no, yes, mask);
    dm_pass_operands(e, s);
    dm_define(e, s->d, d);
}

/* the operand of s whose register the result can have: it is in one, for the last time here; -1:
 * none */
static int last_used_operand(const dm_emitter *e, const dm_step *s) {
    static const int order[3] = {2, 0, 1};
    for (int i = 0; i < 3; i++) {
        const int k = order[i];
        const int8_t reg = e->at[s->arg[k]].reg;
        if (s->next[k] == DM_NEVER && reg >= 0 && !(e->fixed >> reg & 1)) return k;
    }
    return -1;
}

/* 213 and 231 */
static const uint8_t fused_opcodes[DM_OP_COUNT][2] =
    {[DM_OP_FMA] = {DM_X86_FMADD213, DM_X86_FMADD231},
     [DM_OP_FMS] = {DM_X86_FMSUB213, DM_X86_FMSUB231},
     [DM_OP_FNMA] = {DM_X86_FNMADD213, DM_X86_FNMADD231}};

/* +-(a * b) +- c, which goes into the register of one of them, or of a copy of c */
static void fused_sum(dm_emitter *e, const dm_step *s) {
    const int k = last_used_operand(e, s), first = k == 0 ? 1 : 0, third = k == 2 || k < 0 ? 1 : 2;
    const int a = dm_in_a_register(e, s->arg[first]);
    int d = k < 0 ? 0 : dm_in_a_register(e, s->arg[k]);
    if (k < 0) {
        const dm_place *v = e->at + s->arg[2];
        const int loaded = v->homed && e->width == DM_LANES8; /* a move takes a turn */
        const dm_operand c = loaded ? v->home : dm_anywhere(e, s->arg[2]);
        d = dm_take_register(e);
        dm_x86_load(&e->code, e->width, d, c);
    }
    const dm_operand last = dm_anywhere(e, s->arg[third]);
    const int opcode = fused_opcodes[s->op][k == 2 || k < 0];
    dm_x86_fused(&e->code, e->width, opcode, d, a, last, 0);
    dm_pass_operands(e, s);
    dm_define(e, s->d, d);
}

/* the same rounded twice; the product may go where an operand was that the sum does not need */
static void plain_sum(dm_emitter *e, const dm_step *s) {
    const int a = dm_in_a_register(e, s->arg[0]);
    const int c = dm_in_a_register(e, s->arg[2]), d = dm_take_register(e);
    dm_x86_op(&e->code, e->width, DM_X86_MUL, d, a, dm_anywhere(e, s->arg[1]));
    if (s->op == DM_OP_FNMA)
        dm_x86_op(&e->code, e->width, DM_X86_SUB, d, c, dm_in_register(d));
    else
        dm_x86_op(&e->code, e->width, s->op == DM_OP_FMS ? DM_X86_SUB : DM_X86_ADD, d, d,
                  dm_in_register(c));
    dm_pass_operands(e, s);
    dm_define(e, s->d, d);
}

/* one value: argument and result as the C calling convention has them; sincos gives the sine,
 * the cosine goes to memory */
static void call_scalar(dm_emitter *e, const dm_step *s) {
    dm_save_registers(e);
    dm_x86_load(&e->code, DM_SCALAR, 0, dm_anywhere(e, s->arg[0]));
    if (s->operands > 1) dm_x86_load(&e->code, DM_SCALAR, 1, e->at[s->arg[1]].home);
    dm_forget_registers(e);
    if (s->d2) {
        dm_expect_in_memory(e, s->d2);
        dm_x86_lea(&e->code, DM_RDI, e->at[s->d2].home);
    }
    dm_x86_call(&e->code, dm_pool_pointer(e, s->d2 ? DM_OP_CONSTANT : s->op));
    dm_pass_operands(e, s);
    dm_define(e, s->d, 0);
    if (s->d2) dm_take_from_memory(e, s->d2);
}

/* lanes: arguments in memory, results to memory */
static void call_lanes(dm_emitter *e, const dm_step *s) {
    static const int argument[3] = {DM_RDX, DM_RCX, DM_RCX};
    dm_save_registers(e);
    dm_forget_registers(e);
    dm_expect_in_memory(e, s->d);
    if (s->d2) dm_expect_in_memory(e, s->d2);
    dm_x86_lea(&e->code, DM_RDI, e->at[s->d].home);
    dm_x86_lea(&e->code, DM_RSI, e->at[s->d2 ? s->d2 : s->d].home);
    for (int k = 0; k < s->operands; k++) dm_x86_lea(&e->code, argument[k], e->at[s->arg[k]].home);
    dm_x86_clear_uppers(&e->code); /* the C library's SSE code is 20 times slower otherwise */
    dm_x86_call(&e->code, dm_pool_pointer(e, s->d2 ? DM_OP_CONSTANT : s->op));
    dm_pass_operands(e, s);
    dm_take_from_memory(e, s->d);
    if (s->d2) dm_take_from_memory(e, s->d2);
}

static const uint8_t opcodes[DM_OP_COUNT] =
    {[DM_OP_ADD] = DM_X86_ADD, [DM_OP_SUB] = DM_X86_SUB, [DM_OP_MUL] = DM_X86_MUL,
     [DM_OP_DIV] = DM_X86_DIV, [DM_OP_MIN] = DM_X86_MIN, [DM_OP_MAX] = DM_X86_MAX};

/* One step of the plan; slots that the last step freed can be used from now on. */
void dm_emit_step(dm_emitter *e, const dm_step *s) {
    dm_free_slots(e);
    if (opcodes[s->op])
        two_operands(e, s, opcodes[s->op]);
    else if (s->op == DM_OP_NEG)
        one_operand(e, s, DM_X86_XOR, DM_POOL_SIGN_BIT);
    else if (s->op == DM_OP_ABS)
        one_operand(e, s, DM_X86_AND, DM_POOL_ALL_BUT_SIGN);
    else if (s->op == DM_OP_SQRT)
        one_operand(e, s, DM_X86_SQRT, -1);
    else if (s->op == DM_OP_RSQRT || s->op == DM_OP_RSQRT3)
        dm_emit_reciprocal_root(e, s);
    else if (s->op == DM_OP_SIGN)
        sign(e, s);
    else if (s->op == DM_OP_WHERE)
        where(e, s);
    else if (fused_opcodes[s->op][0] && dm_fma_is_fused())
        fused_sum(e, s);
    else if (fused_opcodes[s->op][0])
        plain_sum(e, s);
    else if (e->width == DM_SCALAR)
        call_scalar(e, s);
    else
        call_lanes(e, s);
}

/* outputs that are inputs */
static void copy_inputs(dm_emitter *e, const dm_graph *g) {
    for (dm_node n = 0; n < e->plan->end; n++) {
        if (!e->plan->output[n] || !dm_is_op(g, n, DM_OP_INPUT)) continue;
        const dm_place v = e->at[n];
        dm_x86_load(&e->code, e->width, 0, v.home);
        dm_write_outputs(e, n, 0);
        e->at[n] = v;
    }
}

/* with calls: a frame with the bases in registers that survive, the stack aligned to 64;
 * without: rsp moved only when there are slots, kept in rax */
static void prologue(dm_code *c, const dm_emitter *e) {
    const int32_t frame = (e->slots * e->bytes + 63) & ~63;
    if (e->plan->calls)
        dm_x86_bytes(c,
                     "\x55\x48\x89\xE5\x53\x41\x56\x41\x57"  /* push rbp; rbp = rsp; push 3 */
                     "\x48\x89\xFB\x49\x89\xF6\x49\x89\xD7", /* rbx = rdi, r14, r15 */
                     18);
    else if (frame)
        dm_x86_bytes(c, "\x48\x89\xE0", 3); /* rax = rsp */
    if (!frame && !e->plan->calls) return;
    dm_x86_bytes(c, "\x48\x81\xEC", 3); /* rsp -= frame */
    dm_x86_bytes(c, &frame, sizeof frame);
    dm_x86_bytes(c, "\x48\x83\xE4\xC0", 4); /* rsp &= -64 */
}

/* stack and registers as they were */
static void epilogue(dm_code *c, const dm_emitter *e) {
    if (e->width != DM_SCALAR) dm_x86_clear_uppers(c);
    if (e->plan->calls)
        dm_x86_bytes(c, "\x48\x8D\x65\xE8\x41\x5F\x41\x5E\x5B\x5D", 10); /* rsp = rbp - 24; pop */
    else if (e->slots)
        dm_x86_bytes(c, "\x48\x89\xC4", 3); /* rsp = rax */
    dm_x86_bytes(c, "\xC3", 1);
}

enum { FRONT = 64, USUAL = 16 }; /* bytes: left for the prologue, of the code of a step */

/* room for the code, all of which is seldom used */
static void open_code(dm_code *c, uint32_t steps) {
    dm_x86_reserve(c, FRONT + USUAL * (size_t)steps);
    if (!c->failed) c->size = FRONT;
}

/* the body is made first, when it is known how much stack it wants */
static dm_status place_code(const void **at, dm_emitter *e, dm_arena *arena) {
    unsigned char front[FRONT];
    dm_code before = {.bytes = front, .capacity = FRONT};
    if ((int64_t)e->slots * e->bytes > DM_LARGEST_FRAME) return DM_NO_NATIVE;
    epilogue(&e->code, e);
    prologue(&before, e);
    if (e->code.failed) return DM_NO_MEMORY;
    unsigned char *begin = e->code.bytes + FRONT - before.size;
    memcpy(begin, front, before.size);
    return dm_code_place(at, begin, e->code.size - FRONT + before.size, arena);
}

/* displacements are 32 bits: a frame, a pool or an output beyond goes to the tape */
static int is_too_large(const dm_plan *plan, uint32_t inputs, uint32_t lanes) {
    const uint64_t most = (uint64_t)plan->end + plan->m + inputs;
    return most * lanes * 8 > INT32_MAX / 4;
}

/* Scratch memory serves the plan, places and bytes; what the kernel needs later is in `arena`. */
dm_status dm_jit_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             uint32_t lanes, dm_arena *arena) {
    dm_plan plan;
    dm_emitter e;
    void *pool;
    dm_kernel k = {.inputs = dm_graph_inputs(g), .outputs = m, .backend = "jit"};
    const void *code = NULL;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (lanes > dm_jit_lanes() || (lanes != 1 && lanes != 4 && lanes != 8)) return DM_NO_NATIVE;
    if (dm_has_roots(g, roots, m)) return DM_NO_NATIVE;
    dm_arena *scratch = dm_arena_scratch(dm_graph_arena(g));
    if (!scratch || !dm_plan_make(&plan, g, roots, m, scratch)) return DM_NO_MEMORY;
    if (is_too_large(&plan, k.inputs, lanes)) return DM_NO_NATIVE;
    if (!dm_emit_open(&e, g, &plan, lanes) || !(pool = dm_pool_make(&e, g, arena)) ||
        !dm_kernel_report_fixed(&k, g, roots, arena))
        return DM_NO_MEMORY;
    open_code(&e.code, plan.count);
    if (e.code.failed) return DM_NO_MEMORY;
    copy_inputs(&e, g);
    for (uint32_t i = 0; i < plan.count; i++) dm_emit_step(&e, plan.steps + i);
    const dm_status status = place_code(&code, &e, arena);
    if (status != DM_OK) return status;
    memcpy(&k.eval, &code, sizeof code); /* POSIX lets a function pointer be data */
    k.pool = pool;
    k.operations = plan.count;
    *out = k;
    return DM_OK;
}

#else

uint32_t dm_jit_lanes(void) {
    return 0;
}

dm_status dm_jit_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             uint32_t lanes, dm_arena *arena) {
    (void)out, (void)g, (void)roots, (void)m, (void)lanes, (void)arena;
    return DM_NO_NATIVE;
}

#endif

/* compacted as a graph of its own, so that a lane has the bits of the kernel for one */
dm_status dm_jit_build_lanes(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             uint32_t lanes, dm_arena *arena) {
    if (lanes > dm_jit_lanes()) return DM_NO_NATIVE;
    dm_node *compact = dm_arena_take(dm_graph_arena(g), m * sizeof *compact);
    if (!compact) return DM_NO_MEMORY;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (dm_has_roots(g, roots, m))
        return lanes == 1 ? dm_root_kernel(out, g, roots, m, dm_jit_build, arena) : DM_NO_NATIVE;
    dm_graph *small = dm_compact_graph(g, roots, m, compact);
    return small ? dm_jit_build_exact(out, small, compact, m, lanes, arena) : DM_NO_MEMORY;
}

dm_status dm_jit_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                       dm_arena *arena) {
    return dm_jit_build_lanes(out, g, roots, m, 1, arena);
}

dm_status dm_native_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                          dm_arena *arena) {
    const dm_status status = dm_jit_build(out, g, roots, m, arena);
    return status == DM_NO_NATIVE ? dm_tape_build(out, g, roots, m, arena) : status;
}

/* each constant once a lane */
void dm_kernel_prepare_lanes(const dm_kernel *k, uint32_t lanes, double *out) {
    for (uint32_t i = 0; k->fixed && i < k->outputs; i++)
        for (uint32_t lane = 0; k->fixed[i] && lane < lanes; lane++)
            out[(size_t)i * lanes + lane] = k->constant[i];
}
