/* jit_array_loop.c - the loop of an array loop as machine code: the body is a kernel whose
 * inputs are where the references say; its outputs are held to the end, so that all reads come
 * before all writes. Carried values and, as far as registers go, scalars and constants have
 * registers of their own during the whole loop.
 *
 * rbx pool   r14 main base   r15 scalars   r12 end of main   r13 buffer base   rsp stack
 *
 * Speed: P8-fpu-1024: 57x, machine code against the tape. */
#include "code/loops/array_loop.h"

#include "algebra/implicit.h"
#include "code/native/code_memory.h"
#include "code/native/jit.h"
#include "code/native/jit_exp.h"
#include "code/native/jit_pool.h"
#include "graph/nodes.h"
#include "numbers/processor.h"

#include <string.h>

#if defined(__x86_64__)

enum {
    R12 = 12,
    R13 = 13,
    LARGEST_FRAME = 1 << 16,
    ALIGN = 32,
    MOST_NUMBERS = 12,
    FOR_EXPONENTIALS = 12
};

/* the plan's steps, then one step that writes for every output: an operand like others */
static int add_writes(dm_plan *p) {
    dm_step *steps = dm_arena_take(p->scratch, (p->count + p->m) * sizeof *steps);
    if (!steps) return 0;
    memcpy(steps, p->steps, p->count * sizeof *steps);
    for (uint32_t k = 0; k < p->m; k++)
        steps[p->count + k] = (dm_step){.operands = 1, .arg = {p->roots[k]}};
    p->steps = steps;
    p->count += p->m;
    memset(p->output, 0, p->end * sizeof *p->output);
    memset(p->first, 0xFF, p->end * sizeof *p->first);
    for (uint32_t i = p->count; i-- > 0;) {
        dm_step *s = p->steps + i;
        for (int k = 0; k < s->operands; k++) s->next[k] = p->first[s->arg[k]];
        for (int k = 0; k < s->operands; k++) p->first[s->arg[k]] = i;
    }
    return 1;
}

/* carried values have the last registers */
static int carrier(const dm_array_ref *s) {
    return 31 - (int)s->at;
}

/* where a reference is for the group in hand */
static dm_operand home_of(dm_array_ref s) {
    if (s.base == DM_ARRAY_CARRIED) return dm_in_register(carrier(&s));
    if (s.base == DM_ARRAY_SCALAR)
        return dm_in_memory(DM_R15, (int32_t)(s.at * DM_ARRAY_GROUP * 8));
    return dm_in_memory(s.base == DM_ARRAY_MAIN ? DM_R14 : R13, (int32_t)(s.at * 8));
}

/* displacements are 32 bits */
static int is_within(const dm_array_ref *s, uint32_t count) {
    for (uint32_t k = 0; k < count; k++)
        if (s[k].at > INT32_MAX / 256 || s[k].at < INT32_MIN / 256) return 0;
    return 1;
}

/* inputs of the body are read from where their references say */
static void place_inputs(dm_emitter *e, const dm_graph *g, const dm_array_ref *in) {
    e->pool = DM_RBX;
    for (dm_node n = 0; n < e->plan->end; n++)
        if (dm_is_op(g, n, DM_OP_INPUT)) e->at[n].home = home_of(in[dm_at(g, n)->as.input]);
}

/* Numbers that are the same for all entries stay in the last registers, as far as there are some
 * to spare; a call would lose them. */
static void place_numbers(dm_emitter *e, const dm_graph *g, dm_code *before) {
    const int most = e->plan->calls ? 0 : e->registers > 16 ? MOST_NUMBERS : 4;
    int taken = 0;
    for (dm_node n = 0; n < e->plan->end && taken < most; n++) {
        const dm_operand home = e->at[n].home;
        const int constant = dm_is_op(g, n, DM_OP_CONSTANT);
        const int number = dm_is_op(g, n, DM_OP_INPUT) && home.reg < 0 && home.base == DM_R15;
        if (e->plan->first[n] == DM_NEVER || !(constant || number)) continue;
        const int reg = e->registers - 1 - taken++;
        dm_x86_load(before, e->width, reg, home);
        e->at[n].home = dm_in_register(reg);
    }
    e->registers -= taken;
}

/* operations, then one store for every output, to memory or to a carrier */
static void emit_body(dm_emitter *e, const dm_array_ref *out) {
    const uint32_t steps = e->plan->count - e->plan->m;
    for (uint32_t i = 0; i < steps; i++) {
        const dm_step *s = e->plan->steps + i;
        if (s->op == DM_OP_EXP && !e->plan->calls)
            dm_emit_exponential(e, s);
        else
            dm_emit_step(e, s);
    }
    for (uint32_t k = 0; k < e->plan->m; k++) {
        const dm_step *s = e->plan->steps + steps + k;
        dm_free_slots(e);
        const int reg = dm_in_a_register(e, s->arg[0]);
        if (out[k].base == DM_ARRAY_CARRIED)
            dm_x86_load(&e->code, e->width, carrier(out + k), dm_in_register(reg));
        else
            dm_x86_store(&e->code, e->width, home_of(out[k]), reg);
        dm_pass_operands(e, s);
    }
}

/* push rbp, rbx, r12 .. r15; rbx = rdi, r14 = rsi, r15 = rdx, r12 = rcx, r13 = r8 */
static void prologue(dm_code *c, int32_t frame, const dm_code *numbers) {
    dm_x86_bytes(c, "\x55\x48\x89\xE5\x53\x41\x54\x41\x55\x41\x56\x41\x57", 13);
    dm_x86_bytes(c, "\x48\x89\xFB\x49\x89\xF6\x49\x89\xD7\x49\x89\xCC\x4D\x89\xC5", 15);
    dm_x86_bytes(c, "\x48\x81\xEC", 3); /* rsp -= frame, aligned */
    dm_x86_bytes(c, &frame, sizeof frame);
    dm_x86_bytes(c, "\x48\x83\xE4\xC0", 4);
    dm_x86_bytes(c, numbers->bytes, numbers->size);
    while (c->size % ALIGN && !c->failed) dm_x86_bytes(c, "\x90", 1);
}

/* how many steps are exponentials */
static uint32_t has_exponentials(const dm_plan *p) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->count - p->m; i++) count += p->steps[i].op == DM_OP_EXP;
    return count;
}

/* Our own exponentials of 8 lanes need no call, where nothing else does: calls lose registers. */
static void count_calls(dm_plan *p, uint32_t lanes) {
    if (lanes == 8 && dm_processor() != DM_PLAIN && has_exponentials(p) == p->calls) p->calls = 0;
}

/* r9 = where the numbers of exponentials are */
static void fetch_table(dm_code *c) {
    const uintptr_t table = (uintptr_t)dm_exp_table;
    dm_x86_bytes(c, "\x49\xB9", 2);
    dm_x86_bytes(c, &table, sizeof table);
}

/* r14 and r13 += bytes of a group; again while r14 < r12 */
static void close_loop(dm_code *c, size_t top, int32_t group) {
    dm_x86_bytes(c, "\x49\x81\xC6", 3);
    dm_x86_bytes(c, &group, sizeof group);
    dm_x86_bytes(c, "\x49\x81\xC5", 3);
    dm_x86_bytes(c, &group, sizeof group);
    dm_x86_bytes(c, "\x4D\x39\xE6\x0F\x82", 5);
    const int32_t back = (int32_t)top - (int32_t)(c->size + 4);
    dm_x86_bytes(c, &back, sizeof back);
}

/* registers and stack as they were, and back */
static void epilogue(dm_code *c) {
    dm_x86_clear_uppers(c);
    dm_x86_bytes(c, "\x48\x8D\x65\xD8\x41\x5F\x41\x5E\x41\x5D\x41\x5C\x5B\x5D\xC3", 15);
}

/* the first and the last of what is carried; the bases have moved by one group beyond the last
 * then */
static void load_carried(dm_code *c, const dm_array_loop_draft *d) {
    for (uint32_t k = 0; k < d->carried; k++)
        dm_x86_load(c, DM_LANES8, 31 - (int)k, home_of(d->start[k]));
}

/* values that are asked for at the end go back to where they came from */
static void store_carried(dm_code *c, const dm_array_loop_draft *d) {
    if (d->carried) dm_x86_bytes(c, "\x4D\x89\xC5", 3); /* r13 = r8 */
    for (uint32_t k = 0; k < d->carried; k++)
        if (d->stored[k]) dm_x86_store(c, DM_LANES8, home_of(d->start[k]), 31 - (int)k);
}

/* prologue, what comes before the loop, body, jump, what comes behind, put where it can run */
static dm_status place_loop(const void **at, dm_emitter *e, const dm_code *numbers,
                            const dm_array_loop_draft *d, dm_arena *arena) {
    dm_code c = {.arena = e->code.arena};
    const int64_t frame = ((int64_t)e->slots * e->bytes + 63) & ~63;
    if (frame > LARGEST_FRAME) return DM_NO_NATIVE;
    prologue(&c, (int32_t)frame, numbers);
    const size_t top = c.size;
    dm_x86_bytes(&c, e->code.bytes, e->code.size);
    close_loop(&c, top, e->bytes);
    store_carried(&c, d);
    epilogue(&c);
    if (c.failed || numbers->failed || e->code.failed) return DM_NO_MEMORY;
    return dm_code_place(at, c.bytes, c.size, arena);
}

/* a carried value that is handed on as it came could be overwritten first */
static int hands_on(const dm_array_loop_draft *d, const dm_graph *g, const dm_node *root) {
    for (uint32_t k = 0; k < d->outputs; k++)
        if (d->out[k].base == DM_ARRAY_CARRIED && dm_is_op(g, root[k], DM_OP_INPUT) &&
            d->in[dm_at(g, root[k])->as.input].base == DM_ARRAY_CARRIED)
            return 1;
    return 0;
}

/* carried values need registers that nothing else wants, calls neither */
static int can_carry(const dm_array_loop_draft *d, const dm_plan *plan, uint32_t lanes) {
    if (!d->carried) return 1;
    return lanes == 8 && !plan->calls && d->carried <= DM_ARRAY_LOOP_CARRIED;
}

dm_status dm_jit_build_array_loop(dm_array_loop *s, const dm_array_loop_draft *d, dm_arena *arena) {
    const uint32_t lanes = dm_jit_lanes(), m = d->outputs;
    const void *code = NULL;
    dm_plan plan;
    dm_emitter e;
    if (dm_has_roots(s->g, s->root, m)) return DM_NO_NATIVE;
    if (!lanes || !is_within(s->in, s->one.inputs) || !is_within(s->out, m)) return DM_NO_NATIVE;
    dm_arena *scratch = dm_arena_scratch(arena);
    if (!scratch || !dm_plan_make(&plan, s->g, s->root, m, scratch) || !add_writes(&plan) ||
        !dm_emit_open(&e, s->g, &plan, lanes))
        return DM_NO_MEMORY;
    count_calls(&plan, lanes);
    if (!can_carry(d, &plan, lanes) || hands_on(d, s->g, s->root)) return DM_NO_NATIVE;
    e.registers -= (int)d->carried;
    place_inputs(&e, s->g, s->in);
    void *pool = dm_pool_make(&e, s->g, arena);
    if (!pool) return DM_NO_MEMORY;
    dm_code numbers = {.arena = scratch};
    fetch_table(&numbers);
    load_carried(&numbers, d);
    place_numbers(&e, s->g, &numbers);
    if (has_exponentials(&plan) && !plan.calls) dm_exp_to_registers(&e, &numbers, FOR_EXPONENTIALS);
    emit_body(&e, s->out);
    const dm_status status = place_loop(&code, &e, &numbers, d, arena);
    if (status != DM_OK) return status;
    memcpy(&s->eval, &code, sizeof code);
    s->pool = pool;
    s->lanes = lanes;
    s->one.operations = plan.count - m;
    return DM_OK;
}

#else

dm_status dm_jit_build_array_loop(dm_array_loop *s, const dm_array_loop_draft *d, dm_arena *arena) {
    (void)s, (void)d, (void)arena;
    return DM_NO_NATIVE;
}

#endif
