/* jit_loop.c - machine code for loops of steps. A single member's carried values have a
 * register each as far as they go, the others and those of lanes stay in the state in memory,
 * where a new value is put as soon as the old one has been used. At the end of a part every
 * carried value is where the next part expects it: that is what stays true between parts, and
 * what lets one loop serve every number of repeats. Coefficients are read from memory, one part
 * after the other.
 *
 * rbx pool of the part   r13 the call   r14 state (of the group)   r15 coefficients   rsp stack
 *
 * Long because registers, parts and the loops around them are one layout.
 * Speed: steps, leapfrog ensemble of Kepler orbits: 19x, and 1.1x for a single member. */
#include "code/loops/jit_loop.h"

#include "code/native/code_memory.h"
#include "code/native/jit.h"
#include "code/native/jit_pool.h"
#include "graph/nodes.h"

#include <string.h>

#if defined(__x86_64__)

enum { FREE_REGISTERS = 6 }; /* at least so many without a carried value */

/* a loop on its way to code, and the part in hand */
typedef struct {
    dm_loop *loop;
    dm_arena *arena, *scratch;
    dm_code code;
    dm_width width;
    uint32_t size, held; /* carried values; the first `held` of them are in registers */
    int32_t bytes;       /* of a value in memory */
    int32_t frame;       /* slots of the stack, the most of any part */
    size_t frame_at;     /* place of that number in the code */
    dm_emitter e;        /* of the part in hand */
    const dm_node *roots;
    uint8_t *done;    /* [size] 1: carried value i is where it has to be */
    uint8_t *carried; /* [nodes] 1: of the part in hand, a value that is carried on */
} maker;

/* code as bytes; the comments beside them say what they are */
#define PUT(m, bytes) dm_x86_bytes(&(m)->code, bytes, sizeof bytes - 1)
/* a 32-bit immediate or displacement */
static void put_number(maker *m, int32_t x) {
    dm_x86_bytes(&m->code, &x, sizeof x);
}

/* an instruction with an 8-bit displacement from r13, the field of the call */
static void put_field(maker *m, const char *instruction, size_t offset) {
    const unsigned char displacement = (unsigned char)offset;
    dm_x86_bytes(&m->code, instruction, 3);
    dm_x86_bytes(&m->code, &displacement, 1);
}

#define FIELD(name) offsetof(dm_loop_call, name)
#define LOAD_RAX "\x49\x8B\x45"
#define STORE_RAX "\x49\x89\x45"
#define ADD_RAX_TO "\x49\x01\x45"
#define LOAD_RBX "\x49\x8B\x5D"
#define LOAD_R14 "\x4D\x8B\x75"
#define LOAD_R15 "\x4D\x8B\x7D"
#define STORE_R15 "\x4D\x89\x7D"
#define ADD_TO_R15 "\x4D\x03\x7D"
#define DECREMENT "\x49\xFF\x4D"

/* one round less; back to `target` while there are some left */
static void put_again(maker *m, size_t counter, size_t target) {
    put_field(m, DECREMENT, counter);
    PUT(m, "\x0F\x85"); /* jnz */
    put_number(m, (int32_t)((int64_t)target - (int64_t)(m->code.size + 4)));
}

/* field = field, by way of rax */
static void put_copy(maker *m, size_t to, size_t from) {
    put_field(m, LOAD_RAX, from);
    put_field(m, STORE_RAX, to);
}

/* carried value i of the group in hand */
static dm_operand in_state(const maker *m, uint32_t i) {
    return dm_in_memory(DM_R14, (int32_t)i * m->bytes);
}

/* where the inputs are when the part begins */
static void place_inputs(maker *m, const dm_graph *g, uint32_t coefficients) {
    dm_emitter *e = &m->e;
    for (uint32_t i = 0; i < m->size + coefficients; i++) {
        const dm_node n = dm_leaf_of(g, i);
        if (!n || n >= e->plan->end) continue;
        dm_place *v = e->at + n;
        v->home =
            i < m->size ? in_state(m, i) : dm_in_memory(DM_R15, (int32_t)(i - m->size) * m->bytes);
        if (i >= m->held) continue;
        v->homed = 0;
        if (v->next == DM_NEVER) continue;
        v->reg = (int8_t)i;
        e->held[i] = n;
        e->until[i] = v->next;
        e->occupied |= 1u << i;
    }
}

/* the old value of carried i is used no more */
static int is_over(const maker *m, const dm_graph *g, uint32_t i) {
    const dm_node n = dm_leaf_of(g, i);
    return !n || n >= m->e.plan->end || m->e.at[n].next == DM_NEVER;
}

/* a new value that lives in memory goes there when nobody needs the old one */
static void put_away(maker *m, const dm_graph *g, dm_node n) {
    dm_place *v = m->e.at + n;
    if (!m->carried[n]) return;
    for (uint32_t i = m->held; i < m->size && v->reg >= 0; i++) {
        if (m->roots[i] != n || m->done[i] || !is_over(m, g, i)) continue;
        dm_x86_store(&m->e.code, m->width, in_state(m, i), v->reg);
        m->done[i] = 1;
        if (v->homed) continue;
        v->home = in_state(m, i);
        v->homed = 1;
    }
}

/* the register in which the carried value n is expected, -1: none */
static int preferred_register(const maker *m, dm_node n) {
    if (!m->carried[n]) return -1;
    for (uint32_t i = 0; i < m->held; i++)
        if (m->roots[i] == n) return (int)i;
    return -1;
}

/* what is left of those in memory: all old values are used up now, but for those that stay */
static void finish_memory(maker *m, const dm_graph *g) {
    for (uint32_t i = m->held; i < m->size; i++) {
        const dm_node n = m->roots[i];
        if (m->done[i] || (n && n == dm_leaf_of(g, i))) continue;
        const int reg = dm_in_a_register(&m->e, n);
        dm_x86_store(&m->e.code, m->width, in_state(m, i), reg);
        m->e.pinned = 0;
    }
}

/* another value that is still to be moved sits in register i */
static int is_blocked(const maker *m, uint32_t i) {
    for (uint32_t k = 0; k < m->held; k++)
        if (k != i && !m->done[k] && m->e.at[m->roots[k]].reg == (int)i) return 1;
    return 0;
}

/* carried value i into its register */
static void move_to(maker *m, uint32_t i) {
    const dm_place *v = m->e.at + m->roots[i];
    dm_x86_load(&m->e.code, m->width, (int)i, v->reg >= 0 ? dm_in_register(v->reg) : v->home);
    m->done[i] = 1;
}

/* a ring of values, each in the place of the next: one steps aside */
static void break_ring(maker *m, uint32_t i) {
    const dm_node n = m->roots[i];
    const int8_t from = m->e.at[n].reg;
    const int aside = m->e.registers - 1;
    dm_x86_load(&m->e.code, m->width, aside, dm_in_register(from));
    m->e.at[n].reg = (int8_t)aside;
}

/* moves in an order in which no value is overwritten before it has been moved; rings are broken */
static void finish_registers(maker *m) {
    for (;;) {
        uint32_t left = m->held, moved = 0;
        for (uint32_t i = 0; i < m->held; i++) {
            if (m->done[i]) continue;
            if (m->e.at[m->roots[i]].reg == (int)i) {
                m->done[i] = 1;
            } else if (is_blocked(m, i)) {
                left = i;
                continue;
            } else {
                move_to(m, i);
            }
            moved++;
        }
        if (left == m->held) return;
        if (!moved) break_ring(m, left);
    }
}

/* no value is in the place of another */
static int is_orderly(const maker *m, const dm_loop_part *p) {
    for (uint32_t i = 0; i < m->size; i++) {
        const dm_expr *x = dm_at(p->graph, p->roots[i]);
        if (x->op == DM_OP_INPUT && x->as.input < m->size && x->as.input != i) return 0;
    }
    return 1;
}

/* Plan, pool and places of a part; the code goes on behind that of the part before. */
static dm_status open_part(maker *m, const dm_loop_part *p, dm_plan *plan, void **pool) {
    const uint64_t inputs = m->size + (uint64_t)p->coefficients;
    if (dm_graph_status(p->graph) != DM_OK) return dm_graph_status(p->graph);
    if (!is_orderly(m, p)) return DM_NO_NATIVE;
    if (!dm_plan_make_part(plan, p->graph, p->roots, m->size, m->scratch)) return DM_NO_MEMORY;
    if ((plan->end + inputs) * m->width * 8 > INT32_MAX / 4) return DM_NO_NATIVE;
    if (!dm_emit_open(&m->e, p->graph, plan, m->width)) return DM_NO_MEMORY;
    m->e.pool = DM_RBX;
    *pool = dm_pool_make(&m->e, p->graph, m->arena);
    if (!*pool) return DM_NO_MEMORY;
    m->e.reserved = (1u << m->held) - 1;
    m->e.code = m->code;
    m->roots = p->roots;
    m->carried = dm_arena_take(m->scratch, plan->end);
    if (!m->carried) return DM_NO_MEMORY;
    memset(m->carried, 0, plan->end);
    for (uint32_t i = 0; i < m->size; i++) m->carried[p->roots[i]] = 1;
    memset(m->done, 0, m->size);
    place_inputs(m, p->graph, p->coefficients);
    return DM_OK;
}

/* uses of n, a constant or a coefficient, in a pass; 0 for all others */
static uint32_t count_uses(const maker *m, const dm_loop_part *p, dm_node n) {
    const dm_expr *x = dm_at(p->graph, n);
    uint32_t uses = 0;
    const int shared = x->op == DM_OP_INPUT && x->as.input >= m->size && !p->own;
    if (!(x->op == DM_OP_CONSTANT || shared)) return 0;
    for (uint32_t i = 0; i < m->e.plan->count; i++)
        for (int k = 0; k < m->e.plan->steps[i].operands; k++)
            uses += m->e.plan->steps[i].arg[k] == n;
    return uses;
}

enum { MOST_FIXED = 8, LARGE = 400 }; /* registers; steps */

/* before the groups: what all of them read often goes to registers */
static void fix_constants(maker *m, const dm_loop_part *p) {
    dm_emitter *e = &m->e;
    if (e->registers < 32 || e->plan->calls || e->plan->count > LARGE) return;
    for (int k = 0; k < MOST_FIXED; k++) {
        const int reg = e->registers - 1 - k;
        uint32_t most = 1;
        dm_node best = 0;
        for (dm_node n = 0; n < e->plan->end; n++) {
            const uint32_t uses = e->at[n].reg < 0 ? count_uses(m, p, n) : 0;
            if (uses > most) most = uses, best = n;
        }
        if (most < 2) return;
        dm_x86_load(&e->code, e->width, reg, e->at[best].home);
        e->at[best].reg = (int8_t)reg;
        e->fixed |= 1u << reg;
    }
}

/* the same for the numbers that x^(-3/2) needs */
static void fix_masks(maker *m) {
    static const int8_t wanted[] = {DM_POOL_ONE, DM_POOL_NUMBERS_PASS, DM_POOL_CUBE1,
                                    DM_POOL_CUBE3};
    dm_emitter *e = &m->e;
    uint32_t cubes = 0;
    for (uint32_t i = 0; i < e->plan->count; i++) cubes += e->plan->steps[i].op == DM_OP_RSQRT3;
    if (!cubes || e->registers < 32 || e->plan->calls || e->plan->count > LARGE) return;
    for (int k = 0; k < (int)sizeof wanted; k++) {
        const int reg = e->registers - 1 - MOST_FIXED - k;
        dm_x86_load(&e->code, e->width, reg, dm_pool_mask(e, wanted[k]));
        e->fixed |= 1u << reg;
        e->mask[k] = wanted[k];
        e->mask_register[k] = (int8_t)reg;
    }
    e->masks = (int)sizeof wanted;
}

/* the steps of a part, for one group */
static dm_status emit_part(maker *m, const dm_loop_part *p, const dm_plan *plan) {
    for (uint32_t i = 0; i < plan->count; i++) {
        const dm_step *s = plan->steps + i;
        m->e.preferred = preferred_register(m, s->d);
        dm_emit_step(&m->e, s);
        put_away(m, p->graph, s->d);
        if (s->d2) put_away(m, p->graph, s->d2);
    }
    m->e.preferred = -1;
    finish_memory(m, p->graph);
    finish_registers(m);
    m->code = m->e.code;
    m->loop->operations += plan->count;
    const int64_t frame = (int64_t)m->e.slots * m->bytes;
    if (frame > DM_LARGEST_FRAME) return DM_NO_NATIVE;
    if (frame > m->frame) m->frame = (int32_t)frame;
    return m->code.failed ? DM_NO_MEMORY : DM_OK;
}

/* ---- the loops around them ---- */

/* a part for all groups, then on to the coefficients behind its own */
static dm_status put_part(maker *m, const dm_loop_part *part, dm_loop_kind kind) {
    const dm_loop_part *p = part + kind;
    const int own = p->own && m->width != DM_SCALAR;
    dm_plan plan;
    void *pool = NULL;
    if (!p->graph) return DM_OK;
    dm_status status = open_part(m, p, &plan, &pool);
    if (status != DM_OK) return status;
    m->e.eager = m->width != DM_SCALAR;
    put_field(m, LOAD_RBX, FIELD(pool) + kind * sizeof(void *));
    if (m->width != DM_SCALAR) {
        put_field(m, LOAD_R14, FIELD(state));
        put_copy(m, FIELD(groups_left), FIELD(groups));
    }
    if (own) put_field(m, STORE_R15, FIELD(part_now));
    m->e.code = m->code;
    if (m->width != DM_SCALAR) fix_constants(m, p);
    if (m->width != DM_SCALAR) fix_masks(m);
    m->code = m->e.code;
    const size_t again = m->code.size;
    status = emit_part(m, p, &plan);
    if (status != DM_OK) return status;
    if (own) put_field(m, ADD_TO_R15, FIELD(group_stride));
    if (m->width != DM_SCALAR) {
        PUT(m, "\x49\x81\xC6"); /* r14 += a group */
        put_number(m, (int32_t)m->size * m->bytes);
        put_again(m, FIELD(groups_left), again);
    }
    if (own) put_field(m, LOAD_R15, FIELD(part_now));
    PUT(m, "\x49\x81\xC7"); /* r15 += coefficients */
    put_number(m, (int32_t)p->coefficients * m->bytes);
    m->loop->pool[kind] = pool;
    return DM_OK;
}

/* the C calling convention's registers are saved, carried values fetched */
static void put_beginning(maker *m) {
    PUT(m, "\x55\x48\x89\xE5\x53\x41\x54\x41\x55\x41\x56\x41\x57" /* push rbp; rbp = rsp; push 5 */
           "\x48\x81\xEC");                                       /* rsp -= frame */
    m->frame_at = m->code.size;
    put_number(m, 0);
    PUT(m, "\x48\x83\xE4\xC0\x49\x89\xFD"); /* rsp &= -64; r13 = rdi */
    put_field(m, LOAD_R14, FIELD(state));
    put_field(m, LOAD_R15, FIELD(coefficients));
    for (uint32_t i = 0; i < m->held; i++) dm_x86_load(&m->code, m->width, (int)i, in_state(m, i));
}

/* carried values back to the state, the frame's size filled in where it was left open */
static void put_end(maker *m) {
    for (uint32_t i = 0; i < m->held; i++) dm_x86_store(&m->code, m->width, in_state(m, i), (int)i);
    dm_x86_clear_uppers(&m->code);
    PUT(m, "\x48\x8D\x65\xD8\x41\x5F\x41\x5E\x41\x5D\x41\x5C\x5B\x5D\xC3"); /* pop 5; ret */
    const int32_t frame = (m->frame + 63) & ~63;
    if (!m->code.failed) memcpy(m->code.bytes + m->frame_at, &frame, sizeof frame);
}

/* start; then for every step: head, body as often as it is repeated, tail */
static dm_status put_all(maker *m, const dm_loop_part *part) {
    dm_status status;
    put_beginning(m);
    if ((status = put_part(m, part, DM_LOOP_START)) != DM_OK) return status;
    put_field(m, STORE_R15, FIELD(now));
    const size_t step = m->code.size;
    put_field(m, LOAD_R15, FIELD(now));
    if ((status = put_part(m, part, DM_LOOP_HEAD)) != DM_OK) return status;
    if (part[DM_LOOP_BODY].graph) {
        put_copy(m, FIELD(repeats_left), FIELD(repeats));
        const size_t repeat = m->code.size;
        if ((status = put_part(m, part, DM_LOOP_BODY)) != DM_OK) return status;
        put_again(m, FIELD(repeats_left), repeat);
    }
    if ((status = put_part(m, part, DM_LOOP_TAIL)) != DM_OK) return status;
    put_field(m, LOAD_RAX, FIELD(stride));
    put_field(m, ADD_RAX_TO, FIELD(now));
    put_again(m, FIELD(steps), step);
    put_end(m);
    return m->code.failed ? DM_NO_MEMORY : DM_OK;
}

dm_status dm_loop_code(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                       uint32_t lanes, dm_arena *arena) {
    dm_loop l = {.size = size, .lanes = lanes, .together = 1};
    maker m = {.loop = &l,
               .arena = arena,
               .scratch = dm_arena_scratch(arena),
               .width = (dm_width)lanes,
               .size = size,
               .bytes = (int32_t)lanes * 8};
    const void *code = NULL;
    if (lanes > dm_jit_lanes() || (lanes != 1 && lanes != 4 && lanes != 8)) return DM_NO_NATIVE;
    if (lanes == 1) m.held = size < 16 - FREE_REGISTERS ? size : 16 - FREE_REGISTERS;
    if (!m.scratch) return DM_NO_MEMORY;
    m.code.arena = m.scratch;
    m.done = dm_arena_take(m.scratch, size + 1);
    if (!m.done) return DM_NO_MEMORY;
    for (int k = 0; k < DM_LOOP_PARTS; k++) l.coefficients[k] = part[k].coefficients;
    dm_status status = put_all(&m, part);
    if (status == DM_OK) status = dm_code_place(&code, m.code.bytes, m.code.size, arena);
    if (status != DM_OK) return status;
    memcpy(&l.native, &code, sizeof code); /* POSIX lets a function pointer be data */
    *out = l;
    return DM_OK;
}

#else

dm_status dm_loop_code(dm_loop *out, const dm_loop_part part[DM_LOOP_PARTS], uint32_t size,
                       uint32_t lanes, dm_arena *arena) {
    (void)out, (void)part, (void)size, (void)lanes, (void)arena;
    return DM_NO_NATIVE;
}

#endif
