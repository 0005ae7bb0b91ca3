/*
** From a plan to machine code in one pass. Values live in vector registers; the one whose next
** use is furthest away gives way (Belady 1966). Constants, inputs and outputs are read from
** where they are, others get a stack slot, given back with their last use. All roads round as
** dm_op_value does: no contraction, library functions called.
**   rdi/rbx pool   rsi/r14 in   rdx/r15 out   rsp stack   (the second where there are calls)
*/
#define _GNU_SOURCE /* sincos */
#include "expr/jit.h"

#include "expr/code_memory.h"
#include "expr/compact.h"
#include "expr/jit_plan.h"
#include "expr/nodes.h"
#include "expr/tape.h"

#include <math.h>
#include <string.h>

static uint32_t limit = 8;

void dm_jit_limit(uint32_t lanes) {
    limit = lanes;
}

#if defined(__x86_64__)

#include "expr/x86.h"

static uint32_t processor_lanes(void) {
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx")) return 0;
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? 8
                                                                                   : 4;
}

uint32_t dm_jit_lanes(void) {
    const uint32_t own = processor_lanes(), most = own < limit ? own : limit;
    return most >= 8 ? 8 : most >= 4 ? 4 : most != 0;
}

typedef void function0(void); /* any of them, in the pool */

/* the library by operation; its first entry is sincos */
#define CALLS(X)                                                                         \
    X(EXP, exp)                                                                          \
    X(LOG, log)                                                                          \
    X(SIN, sin)                                                                          \
    X(COS, cos)                                                                          \
    X(TAN, tan) X(ASIN, asin) X(ACOS, acos) X(ATAN, atan) X(SINH, sinh) X(COSH, cosh)    \
        X(TANH, tanh)

enum {
    ONE,
    ZERO,
    SIGN_BIT,
    ALL_BUT_SIGN,
    MASKS,
    POINTERS = 32, /* entries kept for function pointers, one per operation */
    SLOT_NONE = -1
};

typedef struct {
    uint32_t next; /* position of the next use */
    int8_t reg;    /* -1: in none */
    uint8_t homed; /* home is a copy in memory */
    int32_t slot;  /* stack slot that is the home, or SLOT_NONE */
    dm_operand home;
} place;

typedef struct {
    dm_code code;
    dm_width width;
    int registers;     /* 16 or 32 */
    int32_t bytes;     /* of one value in memory */
    int pool, in, out; /* base registers */
    place *at;         /* [nodes] */
    uint32_t held[32]; /* node in each register plus one, 0: free */
    uint32_t pinned;   /* registers that the current step needs */
    int32_t *free;     /* stack of stack slots to use again */
    int32_t frees, slots;
    const dm_plan *plan;
} emitter;

static int32_t mask_offset(const emitter *e, int mask) {
    (void)e;
    return POINTERS * 8 + 64 * mask;
}

static dm_operand mask_at(const emitter *e, int mask) {
    return dm_in_memory(e->pool, mask_offset(e, mask));
}

static void give_slot_back(emitter *e, place *v) {
    if (v->slot == SLOT_NONE) return;
    e->free[e->frees++] = v->slot;
    v->slot = SLOT_NONE;
    v->homed = 0;
}

/* a copy in memory, on the stack unless there is one */
static void give_home(emitter *e, dm_node n) {
    place *v = e->at + n;
    if (v->homed) return;
    v->slot = e->frees ? e->free[--e->frees] : e->slots++;
    v->home = dm_in_memory(DM_RSP, v->slot * e->bytes);
    v->homed = 1;
    dm_x86_store(&e->code, e->width, v->home, v->reg);
}

static void leave_register(emitter *e, int reg) {
    if (!e->held[reg]) return;
    const dm_node n = e->held[reg] - 1;
    if (e->at[n].next != DM_NEVER) give_home(e, n);
    e->at[n].reg = -1;
    e->held[reg] = 0;
}

/* a free register, or the one whose value is needed latest */
static int take_register(emitter *e) {
    int best = -1;
    for (int r = 0; r < e->registers; r++) {
        if (e->pinned >> r & 1) continue;
        if (!e->held[r]) {
            best = r;
            break;
        }
        if (best < 0 || e->at[e->held[r] - 1].next > e->at[e->held[best] - 1].next)
            best = r;
    }
    leave_register(e, best);
    e->pinned |= 1u << best;
    return best;
}

/* n in a register that stays until the step is over */
static int in_register(emitter *e, dm_node n) {
    place *v = e->at + n;
    if (v->reg < 0) {
        const int reg = take_register(e);
        dm_x86_load(&e->code, e->width, reg, v->home);
        v->reg = (int8_t)reg;
        e->held[reg] = n + 1;
    }
    e->pinned |= 1u << v->reg;
    return v->reg;
}

/* n where it is */
static dm_operand anywhere(emitter *e, dm_node n) {
    const place *v = e->at + n;
    if (v->reg < 0) return v->home;
    e->pinned |= 1u << v->reg;
    return dm_in_register(v->reg);
}

/* operands move on to their next use; what has none makes room */
static void pass_operands(emitter *e, const dm_step *s) {
    for (int k = 0; k < s->operands; k++) {
        place *v = e->at + s->arg[k];
        v->next = s->next[k];
        if (v->next != DM_NEVER) continue;
        if (v->reg >= 0) e->held[v->reg] = 0;
        v->reg = -1;
        give_slot_back(e, v);
    }
    e->pinned = 0;
}

/* outputs are written as soon as they are known and serve as the value's home */
static void write_outputs(emitter *e, dm_node n, int reg) {
    place *v = e->at + n;
    for (uint32_t i = e->plan->output[n]; i; i = e->plan->also[i - 1]) {
        const dm_operand to = dm_in_memory(e->out, (int32_t)(i - 1) * e->bytes);
        dm_x86_store(&e->code, e->width, to, reg);
        v->home = to;
        v->homed = 1;
    }
}

static void define(emitter *e, dm_node n, int reg) {
    place *v = e->at + n;
    v->next = e->plan->first[n];
    write_outputs(e, n, reg);
    if (v->next == DM_NEVER) return;
    v->reg = (int8_t)reg;
    e->held[reg] = n + 1;
}

static int is_commutative(uint8_t op) {
    return op == DM_OP_ADD || op == DM_OP_MUL;
}

/* d = a op b; min and max take their operands the other way round, as b < a ? b : a asks */
static void two_operands(emitter *e, const dm_step *s, int opcode) {
    dm_node a = s->arg[0], b = s->arg[1];
    const int swap = s->op == DM_OP_MIN || s->op == DM_OP_MAX ||
                     (is_commutative(s->op) && e->at[a].reg < 0 && e->at[b].reg >= 0);
    if (swap) a = s->arg[1], b = s->arg[0];
    const int first = in_register(e, a);
    const dm_operand second = anywhere(e, b);
    pass_operands(e, s);
    const int d = take_register(e);
    dm_x86_op(&e->code, e->width, opcode, d, first, second);
    define(e, s->d, d);
}

static void one_operand(emitter *e, const dm_step *s, int opcode, int mask) {
    const int a = in_register(e, s->arg[0]);
    pass_operands(e, s);
    const int d = take_register(e);
    const dm_operand second = mask < 0 ? dm_in_register(a) : mask_at(e, mask);
    dm_x86_op(&e->code, e->width, opcode, d, a, second);
    define(e, s->d, d);
}

/* (x > 0) - (x < 0) out of ones and zeros */
static void sign(emitter *e, const dm_step *s) {
    const int a = in_register(e, s->arg[0]), d = take_register(e), t = take_register(e);
    static const int relations[2] = {DM_X86_GREATER, DM_X86_LESS};
    const int to[2] = {d, t};
    for (int k = 0; k < 2; k++) {
        if (e->width == DM_LANES8) {
            dm_x86_compare(&e->code, e->width, 1, a, mask_at(e, ZERO), relations[k]);
            dm_x86_load_masked(&e->code, to[k], 1, mask_at(e, ONE));
            continue;
        }
        dm_x86_compare(&e->code, e->width, to[k], a, mask_at(e, ZERO), relations[k]);
        dm_x86_op(&e->code, e->width, DM_X86_AND, to[k], to[k], mask_at(e, ONE));
    }
    dm_x86_op(&e->code, e->width, DM_X86_SUB, d, d, dm_in_register(t));
    pass_operands(e, s);
    define(e, s->d, d);
}

/* a > 0 ? b : c */
static void where(emitter *e, const dm_step *s) {
    const int a = in_register(e, s->arg[0]), yes = in_register(e, s->arg[1]),
              no = in_register(e, s->arg[2]), d = take_register(e);
    const int mask = e->width == DM_LANES8 ? 1 : d;
    dm_x86_compare(&e->code, e->width, mask, a, mask_at(e, ZERO), DM_X86_GREATER);
    dm_x86_blend(&e->code, e->width, d, no, yes, mask);
    pass_operands(e, s);
    define(e, s->d, d);
}

/* nothing survives a call in a register */
static void save_all(emitter *e) {
    for (int r = 0; r < e->registers; r++)
        if (e->held[r]) give_home(e, e->held[r] - 1);
}

static void forget_registers(emitter *e) {
    for (int r = 0; r < e->registers; r++) {
        if (e->held[r]) e->at[e->held[r] - 1].reg = -1;
        e->held[r] = 0;
    }
}

/* a new home on the stack for a result that the library writes there itself */
static void expect_in_memory(emitter *e, dm_node n) {
    place *v = e->at + n;
    v->slot = e->frees ? e->free[--e->frees] : e->slots++;
    v->home = dm_in_memory(DM_RSP, v->slot * e->bytes);
    v->homed = 1;
    v->next = e->plan->first[n];
}

/* a result of the library that is an output is fetched and written; else it stays */
static void take_from_memory(emitter *e, dm_node n) {
    place *v = e->at + n;
    if (e->plan->output[n]) {
        const int32_t slot = v->slot;
        const int reg = take_register(e);
        dm_x86_load(&e->code, e->width, reg, v->home);
        e->free[e->frees++] = slot;
        v->slot = SLOT_NONE;
        define(e, n, reg);
        e->pinned = 0;
    } else if (v->next == DM_NEVER) {
        give_slot_back(e, v);
    }
}

static dm_operand pointer_of(const emitter *e, int op) {
    return dm_in_memory(e->pool, 8 * op);
}

/* one value: arguments and result as the C calling convention has them */
static void call_scalar(emitter *e, const dm_step *s) {
    save_all(e);
    dm_x86_load(&e->code, DM_SCALAR, 0, anywhere(e, s->arg[0]));
    if (s->operands > 1) dm_x86_load(&e->code, DM_SCALAR, 1, e->at[s->arg[1]].home);
    forget_registers(e);
    if (s->d2) {
        expect_in_memory(e, s->d);
        expect_in_memory(e, s->d2);
        dm_x86_lea(&e->code, DM_RDI, e->at[s->d].home);
        dm_x86_lea(&e->code, DM_RSI, e->at[s->d2].home);
    }
    dm_x86_call(&e->code, pointer_of(e, s->d2 ? 0 : s->op));
    pass_operands(e, s);
    if (s->d2) {
        take_from_memory(e, s->d);
        take_from_memory(e, s->d2);
    } else {
        define(e, s->d, 0);
    }
}

/* lanes: a loop in C over arguments in memory, results to memory */
static void call_lanes(emitter *e, const dm_step *s) {
    static const int argument[3] = {DM_RDX, DM_RCX, DM_RCX};
    save_all(e);
    forget_registers(e);
    expect_in_memory(e, s->d);
    if (s->d2) expect_in_memory(e, s->d2);
    dm_x86_lea(&e->code, DM_RDI, e->at[s->d].home);
    dm_x86_lea(&e->code, DM_RSI, e->at[s->d2 ? s->d2 : s->d].home);
    for (int k = 0; k < s->operands; k++)
        dm_x86_lea(&e->code, argument[k], e->at[s->arg[k]].home);
    dm_x86_clear_uppers(&e->code);
    dm_x86_call(&e->code, pointer_of(e, s->d2 ? 0 : s->op));
    pass_operands(e, s);
    take_from_memory(e, s->d);
    if (s->d2) take_from_memory(e, s->d2);
}

static const uint8_t opcodes[DM_OP_COUNT] = {
    [DM_OP_ADD] = DM_X86_ADD, [DM_OP_SUB] = DM_X86_SUB, [DM_OP_MUL] = DM_X86_MUL,
    [DM_OP_DIV] = DM_X86_DIV, [DM_OP_MIN] = DM_X86_MIN, [DM_OP_MAX] = DM_X86_MAX};

static void emit_step(emitter *e, const dm_step *s) {
    if (opcodes[s->op])
        two_operands(e, s, opcodes[s->op]);
    else if (s->op == DM_OP_NEG)
        one_operand(e, s, DM_X86_XOR, SIGN_BIT);
    else if (s->op == DM_OP_ABS)
        one_operand(e, s, DM_X86_AND, ALL_BUT_SIGN);
    else if (s->op == DM_OP_SQRT)
        one_operand(e, s, DM_X86_SQRT, -1);
    else if (s->op == DM_OP_SIGN)
        sign(e, s);
    else if (s->op == DM_OP_WHERE)
        where(e, s);
    else if (e->width == DM_SCALAR)
        call_scalar(e, s);
    else
        call_lanes(e, s);
}

/* outputs that are inputs */
static void copy_inputs(emitter *e, const dm_graph *g) {
    for (dm_node n = 0; n < e->plan->end; n++) {
        if (!e->plan->output[n] || !dm_is_op(g, n, DM_OP_INPUT)) continue;
        const place v = e->at[n];
        dm_x86_load(&e->code, e->width, 0, v.home);
        write_outputs(e, n, 0);
        e->at[n] = v;
    }
}

/* what the code reads besides its inputs */
typedef struct {
    unsigned char *bytes;
    size_t size;
} pool;

#define LANES(name, f)                                                                   \
    static void name##4(double *d, double *d2, const double *a, const double *b) {       \
        (void)d2, (void)b;                                                               \
        for (int i = 0; i < 4; i++) d[i] = f;                                            \
    }                                                                                    \
    static void name##8(double *d, double *d2, const double *a, const double *b) {       \
        (void)d2, (void)b;                                                               \
        for (int i = 0; i < 8; i++) d[i] = f;                                            \
    }
#define X(name, f) LANES(lanes_##f, f(a[i]))
CALLS(X)
#undef X
LANES(lanes_pow, pow(a[i], b[i]))
LANES(lanes_atan2, atan2(a[i], b[i]))
#undef LANES

static void lanes_sincos4(double *s, double *c, const double *a) {
    for (int i = 0; i < 4; i++) sincos(a[i], s + i, c + i);
}

static void lanes_sincos8(double *s, double *c, const double *a) {
    for (int i = 0; i < 8; i++) sincos(a[i], s + i, c + i);
}

/* entry op of the pool: what a call of op jumps to; entry 0 is sincos */
static void fill_pointers(unsigned char *bytes, dm_width w) {
#define CHOOSE(f)                                                                        \
    (w == DM_SCALAR   ? (function0 *)f                                                   \
     : w == DM_LANES4 ? (function0 *)lanes_##f##4                                        \
                      : (function0 *)lanes_##f##8)
#define X(name, f) [DM_OP_##name] = CHOOSE(f),
    function0 *const pointers[POINTERS] = {[0] = CHOOSE(sincos),
                                           CALLS(X)[DM_OP_POW] = CHOOSE(pow),
                                           [DM_OP_ATAN2] = CHOOSE(atan2)};
#undef X
#undef CHOOSE
    memcpy(bytes, pointers, sizeof pointers);
}

static void fill_masks(unsigned char *bytes) {
    static const uint64_t masks[MASKS] = {
        [ONE] = 0x3FF0000000000000u,
        [ZERO] = 0,
        [SIGN_BIT] = 0x8000000000000000u,
        [ALL_BUT_SIGN] = 0x7FFFFFFFFFFFFFFFu,
    };
    for (int k = 0; k < MASKS; k++)
        for (int lane = 0; lane < 8; lane++)
            memcpy(bytes + 64 * k + 8 * lane, masks + k, sizeof masks[k]);
}

/* constants behind pointers and masks, one per lane; their homes are set */
static int fill_pool(pool *p, emitter *e, const dm_graph *g, dm_arena *arena) {
    const int32_t start = POINTERS * 8 + 64 * MASKS;
    int32_t offset = start;
    for (dm_node n = 0; n < e->plan->end; n++)
        if (dm_is_marked(g, n) && dm_is_op(g, n, DM_OP_CONSTANT)) offset += e->bytes;
    p->bytes = dm_arena_take(arena, (size_t)offset);
    if (!p->bytes) return 0;
    fill_pointers(p->bytes, e->width);
    fill_masks(p->bytes + POINTERS * 8);
    offset = start;
    for (dm_node n = 0; n < e->plan->end; n++) {
        if (!dm_is_marked(g, n) || !dm_is_op(g, n, DM_OP_CONSTANT)) continue;
        e->at[n].home = dm_in_memory(e->pool, offset);
        for (int lane = 0; lane < (int)e->width; lane++, offset += 8)
            memcpy(p->bytes + offset, &dm_at(g, n)->as.value, sizeof(double));
    }
    return 1;
}

static int open_emitter(emitter *e, dm_graph *g, const dm_plan *plan, uint32_t lanes) {
    dm_arena *arena = dm_graph_arena(g);
    *e = (emitter){.width = (dm_width)lanes,
                   .registers = lanes == 8 ? 32 : 16,
                   .bytes = (int32_t)lanes * 8,
                   .pool = plan->calls ? DM_RBX : DM_RDI,
                   .in = plan->calls ? DM_R14 : DM_RSI,
                   .out = plan->calls ? DM_R15 : DM_RDX,
                   .plan = plan,
                   .code.arena = arena};
    e->at = dm_arena_take(arena, plan->end * sizeof *e->at);
    e->free = dm_arena_take(arena, (2 * plan->count + 1) * sizeof *e->free);
    if (!e->at || !e->free) return 0;
    for (dm_node n = 0; n < plan->end; n++) {
        const dm_expr *x = dm_at(g, n);
        e->at[n] = (place){.next = plan->first[n], .reg = -1, .slot = SLOT_NONE};
        e->at[n].homed = x->op == DM_OP_INPUT || x->op == DM_OP_CONSTANT;
        if (x->op == DM_OP_INPUT)
            e->at[n].home = dm_in_memory(e->in, (int32_t)x->as.input * e->bytes);
    }
    return 1;
}

/* with calls: a frame with the bases in registers that survive, the stack aligned to 64;
** without: rsp moved only when there are slots, kept in rax */
static void prologue(dm_code *c, const emitter *e) {
    const int32_t frame = (e->slots * e->bytes + 63) & ~63;
    if (e->plan->calls)
        dm_x86_bytes(
            c,
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

static void epilogue(dm_code *c, const emitter *e) {
    if (e->width != DM_SCALAR) dm_x86_clear_uppers(c);
    if (e->plan->calls)
        dm_x86_bytes(c, "\x48\x8D\x65\xE8\x41\x5F\x41\x5E\x5B\x5D",
                     10); /* rsp = rbp - 24; pop */
    else if (e->slots)
        dm_x86_bytes(c, "\x48\x89\xC4", 3); /* rsp = rax */
    dm_x86_bytes(c, "\xC3", 1);
}

/* the body is made first, when it is known how much stack it wants */
static dm_status place_code(const void **at, emitter *e, dm_arena *arena) {
    dm_code whole = {.arena = e->code.arena};
    epilogue(&e->code, e);
    prologue(&whole, e);
    dm_x86_bytes(&whole, e->code.bytes, e->code.size);
    if (whole.failed || e->code.failed) return DM_NO_MEMORY;
    return dm_code_place(at, whole.bytes, whole.size, arena);
}

static int report_fixed(dm_kernel *k, const dm_graph *g, const dm_node *roots,
                        dm_arena *arena) {
    uint8_t *fixed = dm_arena_take(arena, k->outputs);
    double *constant = dm_arena_take(arena, k->outputs * sizeof *constant);
    if (!fixed || !constant) return 0;
    for (uint32_t i = 0; i < k->outputs; i++) {
        constant[i] = 0.0;
        fixed[i] = (uint8_t)dm_is_constant(g, roots[i], constant + i);
    }
    k->fixed = fixed;
    k->constant = constant;
    return 1;
}

/* displacements are 32 bits: a frame, a pool or an output beyond goes to the tape */
static int is_too_large(const dm_plan *plan, uint32_t inputs, uint32_t lanes) {
    const uint64_t most = (uint64_t)plan->end + plan->m + inputs;
    return most * lanes * 8 > INT32_MAX / 4;
}

dm_status dm_jit_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots,
                             uint32_t m, uint32_t lanes, dm_arena *arena) {
    dm_plan plan;
    emitter e;
    pool p;
    dm_kernel k = {.inputs = dm_graph_inputs(g), .outputs = m, .backend = "jit"};
    const void *code = NULL;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (lanes > dm_jit_lanes() || (lanes != 1 && lanes != 4 && lanes != 8))
        return DM_NO_NATIVE;
    if (!dm_plan_make(&plan, g, roots, m)) return DM_NO_MEMORY;
    if (is_too_large(&plan, k.inputs, lanes)) return DM_NO_NATIVE;
    if (!open_emitter(&e, g, &plan, lanes) || !fill_pool(&p, &e, g, arena) ||
        !report_fixed(&k, g, roots, arena))
        return DM_NO_MEMORY;
    copy_inputs(&e, g);
    for (uint32_t i = 0; i < plan.count; i++) emit_step(&e, plan.steps + i);
    const dm_status status = place_code(&code, &e, arena);
    if (status != DM_OK) return status;
    memcpy(&k.eval, &code, sizeof code); /* POSIX lets a function pointer be data */
    k.pool = p.bytes;
    k.operations = plan.count;
    *out = k;
    return DM_OK;
}

#else

uint32_t dm_jit_lanes(void) {
    return 0;
}

dm_status dm_jit_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots,
                             uint32_t m, uint32_t lanes, dm_arena *arena) {
    (void)out, (void)g, (void)roots, (void)m, (void)lanes, (void)arena;
    return DM_NO_NATIVE;
}

#endif

dm_status dm_jit_build_lanes(dm_kernel *out, dm_graph *g, const dm_node *roots,
                             uint32_t m, uint32_t lanes, dm_arena *arena) {
    if (lanes > dm_jit_lanes()) return DM_NO_NATIVE;
    dm_node *compact = dm_arena_take(dm_graph_arena(g), m * sizeof *compact);
    if (!compact) return DM_NO_MEMORY;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    dm_graph *small = dm_compact_graph(g, roots, m, compact);
    return small ? dm_jit_build_exact(out, small, compact, m, lanes, arena)
                 : DM_NO_MEMORY;
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

void dm_kernel_prepare_lanes(const dm_kernel *k, uint32_t lanes, double *out) {
    for (uint32_t i = 0; k->fixed && i < k->outputs; i++)
        for (uint32_t lane = 0; k->fixed[i] && lane < lanes; lane++)
            out[(size_t)i * lanes + lane] = k->constant[i];
}
