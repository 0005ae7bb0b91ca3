/* jit_emit.h - the state of a kernel on its way to machine code: where every value is. Values
 * live in vector registers; the one whose next use is furthest away gives way (Belady 1966).
 * Constants, inputs and outputs are read from where they are, others get a stack slot, given
 * back with their last use. */
#ifndef DM_JIT_EMIT_H
#define DM_JIT_EMIT_H

#include "code/native/jit_plan.h"
#include "code/native/x86.h"

/* where one node's value is; small, as there is one for every node */
typedef struct {
    dm_operand home;  /* in memory, or a register that the body of a loop only reads */
    uint32_t next;    /* position of the next use */
    int8_t reg;       /* -1: in none */
    uint8_t homed;    /* home is a copy */
    uint8_t on_stack; /* home is a slot of the stack */
} dm_place;

typedef struct {
    dm_code code;
    dm_width width;
    int registers;             /* 16 or 32 */
    int32_t bytes;             /* of one value in memory */
    int pool, in, out;         /* base registers */
    dm_place *at;              /* [nodes] */
    dm_node held[32];          /* node in each register that is occupied */
    uint32_t until[32];        /* its next use */
    uint32_t occupied, pinned; /* registers, one bit each; pinned: the current step needs it */
    uint32_t fixed;            /* registers that keep a constant all along */
    int eager;         /* what is in memory and used again is fetched while there are registers */
    uint32_t reserved; /* registers that are taken last: they have a purpose (loops) */
    int exp_first, exp_registers;     /* the registers that hold the first numbers of jit_exp.c */
    int8_t mask[8], mask_register[8]; /* numbers of jit_pool.h that have a register */
    int masks;
    int preferred; /* register for the result of the current step where it is free; -1: any */
    int32_t *free; /* stack of stack slots to use again */
    int32_t frees, slots;
    int32_t released[8]; /* slots whose value this step used last */
    int releases;
    const dm_plan *plan;
} dm_emitter;

/* 0 without memory, which is the scratch of the plan. lanes is 1, 4 or 8. */
int dm_emit_open(dm_emitter *e, const dm_graph *g, const dm_plan *plan, uint32_t lanes);

int dm_take_register(dm_emitter *e);              /* a free one, pinned */
int dm_in_a_register(dm_emitter *e, dm_node n);   /* n in one, pinned */
dm_operand dm_anywhere(dm_emitter *e, dm_node n); /* n where it is, pinned */

/* Slots that the step before used last are free from now on. */
void dm_free_slots(dm_emitter *e);

/* The operands of s move on to their next use; what has none makes room; nothing is pinned. */
void dm_pass_operands(dm_emitter *e, const dm_step *s);

/* n is in `reg` now: written to its outputs, kept as long as it is used. */
void dm_define(dm_emitter *e, dm_node n, int reg);
void dm_write_outputs(dm_emitter *e, dm_node n, int reg);

/* The code of one step. */
void dm_emit_step(dm_emitter *e, const dm_step *s);

/* Around a call: every value has a copy in memory; none is in a register any more. */
void dm_save_registers(dm_emitter *e);
void dm_forget_registers(dm_emitter *e);

/* A result that the library writes to memory: its slot before, what becomes of it after. */
void dm_expect_in_memory(dm_emitter *e, dm_node n);
void dm_take_from_memory(dm_emitter *e, dm_node n);

/* Up to so many bytes of stack; threads have little. */
enum { DM_LARGEST_FRAME = 1 << 20 };

#endif
