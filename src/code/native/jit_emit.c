/* jit_emit.c - where values are while code is written. A value is in a register, in its home (a
 * place in memory), or in both. Between two steps nothing is pinned, every occupied register
 * knows the next use of its value, and a value without a register that is used again has a
 * home. When registers run out the one whose value is needed latest goes (Belady 1966), to a
 * slot of the stack unless it has a home already; straight-line code knows all next uses, so
 * this is not a guess.
 * Speed: P4: 24x, native code against the tape. */
#include "code/native/jit_emit.h"

#include "graph/nodes.h"

/* n is in reg from now on */
static void hold(dm_emitter *e, dm_node n, int reg) {
    e->at[n].reg = (int8_t)reg;
    e->held[reg] = n;
    e->until[reg] = e->at[n].next;
    e->occupied |= 1u << reg;
}

/* reg is free; the value is lost unless it has a home */
static void drop(dm_emitter *e, int reg) {
    e->at[e->held[reg]].reg = -1;
    e->occupied &= ~(1u << reg);
}

/* a slot that was given back, or one more */
static void take_slot(dm_emitter *e, dm_place *v) {
    const int32_t slot = e->frees ? e->free[--e->frees] : e->slots++;
    v->home = dm_in_memory(DM_RSP, slot * e->bytes);
    v->on_stack = v->homed = 1;
}

/* free for the next step: this one may still read it after it has put another value away */
static void give_slot_back(dm_emitter *e, dm_place *v) {
    if (!v->on_stack) return;
    e->released[e->releases++] = v->home.disp / e->bytes;
    v->on_stack = v->homed = 0;
}

/* what the step before used last */
void dm_free_slots(dm_emitter *e) {
    while (e->releases) e->free[e->frees++] = e->released[--e->releases];
}

/* a copy in memory, on the stack unless there is one */
static void give_home(dm_emitter *e, dm_node n) {
    dm_place *v = e->at + n;
    if (v->homed) return;
    take_slot(e, v);
    dm_x86_store(&e->code, e->width, v->home, v->reg);
}

/* the register whose value is needed latest, the first of several */
static int furthest(const dm_emitter *e) {
    const uint32_t taken = e->pinned | e->fixed;
    uint64_t most = 0;
    for (int r = 0; r < e->registers; r++) {
        const uint64_t key = (uint64_t)e->until[r] << 8 | (uint64_t)(64 - r);
        const uint64_t own = taken >> r & 1 ? 0 : key;
        most = own > most ? own : most;
    }
    return 64 - (int)(most & 0xFF);
}

/* In this order: the register that the caller prefers, a free one without a purpose, any free
 * one, and the one that is needed latest. */
int dm_take_register(dm_emitter *e) {
    const uint32_t all = e->registers == 32 ? UINT32_MAX : (1u << e->registers) - 1;
    const uint32_t free = all & ~e->occupied & ~e->pinned & ~e->fixed, better = free & ~e->reserved;
    const int granted = e->preferred >= 0 && (free >> e->preferred & 1);
    const int reg = granted  ? e->preferred
                    : better ? __builtin_ctz(better)
                    : free   ? __builtin_ctz(free)
                             : furthest(e);
    if (!free) {
        give_home(e, e->held[reg]);
        drop(e, reg);
    }
    e->pinned |= 1u << reg;
    return reg;
}

/* fetched from its home where it is in none; a preference for the result is not for operands */
int dm_in_a_register(dm_emitter *e, dm_node n) {
    if (e->at[n].reg < 0 && e->at[n].homed && e->at[n].home.reg >= 0)
        return e->at[n].home.reg; /* one that is never written in the body of a loop */
    if (e->at[n].reg < 0) {
        const int preferred = e->preferred;
        e->preferred = -1;
        const int reg = dm_take_register(e);
        e->preferred = preferred;
        dm_x86_load(&e->code, e->width, reg, e->at[n].home);
        hold(e, n, reg);
    }
    e->pinned |= 1u << e->at[n].reg;
    return e->at[n].reg;
}

enum { SPARE = 4 }; /* registers left for results */

/* n, an operand of the current step, has another use and there is room for it */
static int is_worth_fetching(const dm_emitter *e, dm_node n) {
    const uint32_t all = e->registers == 32 ? UINT32_MAX : (1u << e->registers) - 1;
    uint32_t free = all & ~e->occupied & ~e->pinned & ~e->fixed;
    const dm_step *s = e->plan->steps + e->at[n].next;
    for (int i = 0; i < SPARE; i++) free &= free - 1; /* without its lowest bit */
    if (!e->eager || !free) return 0;
    for (int k = 0; k < s->operands; k++)
        if (s->arg[k] == n && s->next[k] < e->plan->count) return 1;
    return 0;
}

/* memory will do as an operand; a value with another use is fetched where there is room */
dm_operand dm_anywhere(dm_emitter *e, dm_node n) {
    const dm_place *v = e->at + n;
    if (v->reg < 0 && is_worth_fetching(e, n)) dm_in_a_register(e, n);
    if (v->reg < 0) return v->home;
    e->pinned |= 1u << v->reg;
    return dm_in_register(v->reg);
}

/* A register or slot is given back with the last use of its value, before the result gets a
 * place: so a result may take the register of an operand that dies here. */
void dm_pass_operands(dm_emitter *e, const dm_step *s) {
    for (int k = 0; k < s->operands; k++) {
        dm_place *v = e->at + s->arg[k];
        v->next = s->next[k];
        if (v->reg >= 0) e->until[v->reg] = v->next;
        if (v->next != DM_NEVER) continue;
        if (v->reg >= 0 && !(e->fixed >> v->reg & 1)) drop(e, v->reg);
        give_slot_back(e, v);
    }
    e->pinned = 0;
}

/* outputs are written as soon as they are known and serve as the value's home */
void dm_write_outputs(dm_emitter *e, dm_node n, int reg) {
    dm_place *v = e->at + n;
    for (uint32_t i = e->plan->output[n]; i; i = e->plan->also[i - 1]) {
        const dm_operand to = dm_in_memory(e->out, (int32_t)(i - 1) * e->bytes);
        dm_x86_store(&e->code, e->width, to, reg);
        v->home = to;
        v->homed = 1;
    }
}

/* the result of a step: stored where it is an output, held while somebody needs it */
void dm_define(dm_emitter *e, dm_node n, int reg) {
    e->at[n].next = e->plan->first[n];
    dm_write_outputs(e, n, reg);
    if (e->at[n].next != DM_NEVER) hold(e, n, reg);
}

/* before a call, which may destroy every vector register */
void dm_save_registers(dm_emitter *e) {
    for (int r = 0; r < e->registers; r++)
        if (e->occupied >> r & 1) give_home(e, e->held[r]);
}

/* all are free; values are in their homes */
void dm_forget_registers(dm_emitter *e) {
    for (int r = 0; r < e->registers; r++)
        if (e->occupied >> r & 1) drop(e, r);
}

/* a slot for a result that a call writes */
void dm_expect_in_memory(dm_emitter *e, dm_node n) {
    take_slot(e, e->at + n);
    e->at[n].next = e->plan->first[n];
}

/* an output is fetched and written, anything else stays in its slot */
void dm_take_from_memory(dm_emitter *e, dm_node n) {
    dm_place *v = e->at + n;
    if (e->plan->output[n]) {
        const int reg = dm_take_register(e);
        dm_x86_load(&e->code, e->width, reg, v->home);
        give_slot_back(e, v);
        dm_define(e, n, reg);
        e->pinned = 0;
    } else if (v->next == DM_NEVER) {
        give_slot_back(e, v);
    }
}

/* Inputs and constants have homes from the start; the bases of in, out and pool move to
 * registers that survive calls where there are calls. */
int dm_emit_open(dm_emitter *e, const dm_graph *g, const dm_plan *plan, uint32_t lanes) {
    dm_arena *arena = plan->scratch;
    *e = (dm_emitter){.width = (dm_width)lanes,
                      .registers = lanes == 8 ? 32 : 16,
                      .bytes = (int32_t)lanes * 8,
                      .preferred = -1,
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
        e->at[n] = (dm_place){.next = plan->first[n], .reg = -1};
        e->at[n].homed = x->op == DM_OP_INPUT || x->op == DM_OP_CONSTANT;
        if (x->op == DM_OP_INPUT)
            e->at[n].home = dm_in_memory(e->in, (int32_t)x->as.input * e->bytes);
    }
    return 1;
}
