/* x86.h - the few x86-64 instructions that kernels are made of, as bytes. */
#ifndef DM_X86_H
#define DM_X86_H

#include "base/arena.h"

#include <stdint.h>

enum {
    DM_RAX,
    DM_RCX,
    DM_RDX,
    DM_RBX,
    DM_RSP,
    DM_RBP,
    DM_RSI,
    DM_RDI,
    DM_R13 = 13,
    DM_R14,
    DM_R15
};

/* code on its way: bytes[size] in the arena; failed once memory was refused */
typedef struct {
    dm_arena *arena;
    unsigned char *bytes;
    size_t size, capacity;
    int failed;
} dm_code;

/* a vector register, or memory at base + disp; fits into a register itself */
typedef struct {
    int16_t reg; /* -1: memory */
    int16_t base;
    int32_t disp;
} dm_operand;

static inline dm_operand dm_in_register(int reg) {
    return (dm_operand){.reg = (int16_t)reg};
}

static inline dm_operand dm_in_memory(int base, int32_t disp) {
    return (dm_operand){.reg = -1, .base = (int16_t)base, .disp = disp};
}

/* doubles that one instruction works on: 1 (VEX scalar), 4 (VEX 256), 8 (EVEX 512) */
typedef enum { DM_SCALAR = 1, DM_LANES4 = 4, DM_LANES8 = 8 } dm_width;

enum { /* operations d = a op b with one opcode in all widths */
       DM_X86_SQRT = 0x51,
       DM_X86_AND = 0x54,
       DM_X86_XOR = 0x57,
       DM_X86_ADD = 0x58,
       DM_X86_MUL = 0x59,
       DM_X86_SUB = 0x5C,
       DM_X86_MIN = 0x5D,
       DM_X86_DIV = 0x5E,
       DM_X86_MAX = 0x5F
};

/* Bytes as they are; an instruction that works on `w` doubles: d = a op b, moves. */
void dm_x86_bytes(dm_code *c, const void *bytes, size_t count);
void dm_x86_reserve(dm_code *c, size_t count); /* room for so many more */
void dm_x86_op(dm_code *c, dm_width w, int opcode, int d, int a, dm_operand b);
void dm_x86_load(dm_code *c, dm_width w, int d, dm_operand from);
void dm_x86_store(dm_code *c, dm_width w, dm_operand to, int from);

enum { DM_X86_NUMBERS = 0x07, DM_X86_LESS = 0x11, DM_X86_GREATER = 0x1E }; /* quiet; no NaN: true */

/* d = all ones where a `relation` b (8 lanes: mask register d) */
void dm_x86_compare(dm_code *c, dm_width w, int d, int a, dm_operand b, int relation);
/* d = d * a + b, or d = a * b + d (accumulate), rounded once */
void dm_x86_fma(dm_code *c, dm_width w, int accumulate, int d, int a, dm_operand b);
/* d = mask ? yes : no */
void dm_x86_blend(dm_code *c, dm_width w, int d, int no, int yes, int mask);
/* 8 lanes: d = mask register ? from : 0 */
void dm_x86_load_masked(dm_code *c, int d, int mask, dm_operand from);

/* AVX-512: 1/sqrt(a) to 14 bits */
void dm_x86_rsqrt14(dm_code *c, dm_width w, int d, int a);

enum { /* 213: d = +-(a d) + b; 231: d = a b +- d */
       DM_X86_FMADD213 = 0xA8,
       DM_X86_FMSUB213 = 0xAA,
       DM_X86_FNMADD213 = 0xAC,
       DM_X86_FMADD231 = 0xB8,
       DM_X86_FMSUB231 = 0xBA,
       DM_X86_FNMADD231 = 0xBC
};

/* rounded once; with AVX-512 only where a mask register (not 0) says so */
void dm_x86_fused(dm_code *c, dm_width w, int opcode, int d, int a, dm_operand b, int mask);

/* AVX-512: mask register `mask` = a `relation` b, and mask register `under` where that is not 0 */
void dm_x86_test(dm_code *c, dm_width w, int mask, int a, dm_operand b, int relation, int under);

/* 8 lanes: d = a where a nibble of the table for its kind says 1, as it was where 0 */
void dm_x86_fix(dm_code *c, int d, int a, dm_operand table);

/* 8 lanes: d = a, at most as large as b and with its sign; b where a is no number */
void dm_x86_bound(dm_code *c, int d, int a, dm_operand b);

/* 8 lanes: d = those of the 16 numbers in a and b that the low bits of d say */
void dm_x86_pick(dm_code *c, int d, int a, dm_operand b);

/* 8 lanes: d = a 2^floor(b) */
void dm_x86_scale(dm_code *c, int d, int a, int b);

/* A call through a pointer, an address, and the end of the use of upper halves of registers. */
void dm_x86_call(dm_code *c, dm_operand pointer);
void dm_x86_lea(dm_code *c, int d, dm_operand memory);
void dm_x86_clear_uppers(dm_code *c);

#endif
