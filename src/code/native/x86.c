/* x86.c - encodings after the Intel 64 manual, volume 2: VEX (2.3) and EVEX (2.7). Every memory
 * operand is base + displacement. VEX scalars leave the upper lanes to the first source.
 *
 * Two families are enough. Scalars and 4 lanes use VEX, which reaches 16 registers; 8 lanes use
 * EVEX, which reaches 32, has mask registers and counts short displacements in units of an
 * operand. A `form` names the fields of an instruction as the manual does, and emit() lays the
 * prefix, the opcode and the address out. Nothing here knows what a value means: that is
 * jit_emit.c's.
 * Speed: P4: 24x, native code against the tape. */
#include "code/native/x86.h"

#include <string.h>

/* values of the fields pp and mmmmm of both prefixes: what stood before the opcode in older
 * encodings */
enum { PP_NONE, PP_66, PP_F3, PP_F2 };
enum { MAP_0F = 1, MAP_0F38, MAP_0F3A };

/* an instruction without its operand in memory: opcode map, prefix, opcode, and the fields that
 * say which registers; reg is ModRM.reg, vvvv the first source */
typedef struct {
    int map, prefix, opcode;
    int wide; /* the W bit */
    int reg, vvvv;
    int mask, zeroing; /* EVEX only */
} form;

/* Room doubles, so that a kernel of n bytes is copied O(n) bytes in all; a refusal is
 * remembered. */
void dm_x86_reserve(dm_code *c, size_t count) {
    if (c->failed || c->size + count <= c->capacity) return;
    const size_t room = c->capacity ? 2 * c->capacity + count : 4096 + count;
    unsigned char *grown = dm_arena_grow(c->arena, c->bytes, c->size, room);
    c->failed = !grown;
    if (!grown) return;
    c->bytes = grown;
    c->capacity = room;
}

void dm_x86_bytes(dm_code *c, const void *bytes, size_t count) {
    dm_x86_reserve(c, count);
    if (c->failed) return;
    memcpy(c->bytes + c->size, bytes, count);
    c->size += count;
}

enum { LONGEST = 16 }; /* bytes of an instruction, and some to spare */

/* An instruction on its way, in registers: bytes that were written one by one could not be read
 * together before they are in the cache. */
typedef struct {
    uint64_t head; /* all before the displacement: up to 7 bytes */
    int size;
    int moved; /* bytes of the displacement: 0, 1 or 4 */
    int32_t disp;
} instruction;

/* one more byte of the head */
static inline void byte(instruction *i, int value) {
    i->head |= (uint64_t)(value & 0xFF) << 8 * i->size++;
}

/* with one byte more at the end, or NONE */
enum { NONE = -1 };

static inline void put(dm_code *c, const instruction *i, int last) {
    if (c->size + LONGEST > c->capacity) dm_x86_reserve(c, LONGEST);
    if (c->failed) return;
    unsigned char *to = c->bytes + c->size;
    memcpy(to, &i->head, sizeof i->head);
    memcpy(to + i->size, &i->disp, sizeof i->disp);
    to[i->size + i->moved] = (unsigned char)last;
    c->size += (size_t)(i->size + i->moved + (last != NONE));
}

/* ModRM and what follows; an 8-bit displacement counts in units of `unit` bytes, a power of two */
static inline void address(instruction *i, int reg, dm_operand o, int unit) {
    const int middle = (reg & 7) << 3;
    if (o.reg >= 0) {
        byte(i, 0xC0 | middle | (o.reg & 7));
        return;
    }
    const int small = !(o.disp & (unit - 1)) && o.disp >= -128 * unit && o.disp <= 127 * unit;
    byte(i, (small ? 0x40 : 0x80) | middle | (o.base & 7));
    if ((o.base & 7) == DM_RSP) byte(i, 0x24);
    i->disp = small ? o.disp / unit : o.disp;
    i->moved = small ? 1 : 4;
}

/* high bits of ModRM.rm: register or base */
static int high(dm_operand o) {
    return (o.reg >= 0 ? o.reg : o.base) >> 3;
}

/* the two-byte form where nothing beyond reg and vvvv needs a bit; bits of registers are stored
 * inverted in both forms */
static inline void vex(instruction *i, const form *f, int length, dm_operand o) {
    const int r = f->reg >> 3 & 1, b = high(o) & 1, last = length << 2 | f->prefix;
    const int vvvv = (~f->vvvv & 15) << 3;
    if (!b && f->map == MAP_0F && !f->wide) {
        byte(i, 0xC5);
        byte(i, (!r << 7) | vvvv | last);
    } else {
        byte(i, 0xC4);
        byte(i, (!r << 7) | 0x40 | (!b << 5) | f->map);
        byte(i, f->wide << 7 | vvvv | last);
    }
    byte(i, f->opcode);
    address(i, f->reg, o, 1);
}

/* length 0, 1, 2: 128 bits or scalar, 256, 512; short displacements count in the size of a
 * memory operand */
static inline void evex(instruction *i, const form *f, int length, int unit, dm_operand o) {
    const int top = o.reg >= 0 ? o.reg >> 4 & 1 : 0; /* bit 4 of a register goes to X */
    byte(i, 0x62);
    byte(i, (!(f->reg >> 3 & 1) << 7) | (!top << 6) | (!(high(o) & 1) << 5) |
                (!(f->reg >> 4 & 1) << 4) | f->map);
    byte(i, 0x80 | (~f->vvvv & 15) << 3 | 4 | f->prefix);
    byte(i, f->zeroing << 7 | length << 5 | (!(f->vvvv >> 4 & 1) << 3) | f->mask);
    byte(i, f->opcode);
    address(i, f->reg, o, unit);
}

/* EVEX in all widths */
static void emit_evex(dm_code *c, dm_width w, const form *f, dm_operand o, int last) {
    instruction i = {.size = 0};
    evex(&i, f, w == DM_LANES8 ? 2 : w == DM_LANES4, 8 * (int)w, o);
    put(c, &i, last);
}

/* VEX for scalars and 4 lanes; `last` is an immediate byte */
static void emit_vex(dm_code *c, dm_width w, const form *f, dm_operand o, int last) {
    instruction i = {.size = 0};
    vex(&i, f, w == DM_LANES4, o);
    put(c, &i, last);
}

/* the family that a width has */
static void emit(dm_code *c, dm_width w, const form *f, dm_operand o, int last) {
    if (w == DM_LANES8)
        emit_evex(c, w, f, o, last);
    else
        emit_vex(c, w, f, o, last);
}

/* d = a op b; logic on bits has no scalar form, so a scalar uses the packed one of 128 bits */
void dm_x86_op(dm_code *c, dm_width w, int opcode, int d, int a, dm_operand b) {
    const int bits = opcode == DM_X86_AND || opcode == DM_X86_XOR; /* no scalar form */
    const form f = {.map = MAP_0F,
                    .opcode = opcode,
                    .reg = d,
                    .prefix = w == DM_SCALAR && !bits ? PP_F2 : PP_66,
                    /* the packed root has one source */
                    .vvvv = opcode == DM_X86_SQRT && w != DM_SCALAR ? 0 : a};
    emit(c, w, &f, b, NONE);
}

/* from a register: all lanes are moved; from memory: as many as the width says */
void dm_x86_load(dm_code *c, dm_width w, int d, dm_operand from) {
    const form move = {.map = MAP_0F, .opcode = 0x28, .reg = d, .prefix = PP_66};
    const form load = {.map = MAP_0F,
                       .opcode = 0x10,
                       .reg = d,
                       .prefix = w == DM_SCALAR ? PP_F2 : PP_66};
    if (from.reg == d) return;
    emit(c, w, from.reg >= 0 ? &move : &load, from, NONE);
}

/* memory = register, unaligned */
void dm_x86_store(dm_code *c, dm_width w, dm_operand to, int from) {
    const form f = {.map = MAP_0F,
                    .opcode = 0x11,
                    .reg = from,
                    .prefix = w == DM_SCALAR ? PP_F2 : PP_66};
    emit(c, w, &f, to, NONE);
}

/* the relation is an immediate byte */
void dm_x86_compare(dm_code *c, dm_width w, int d, int a, dm_operand b, int relation) {
    const form f = {.map = MAP_0F,
                    .opcode = 0xC2,
                    .reg = d,
                    .vvvv = a,
                    .prefix = w == DM_SCALAR ? PP_F2 : PP_66};
    emit(c, w, &f, b, relation);
}

/* 4 lanes take the sign bits of a vector as the mask, 8 lanes a mask register */
void dm_x86_blend(dm_code *c, dm_width w, int d, int no, int yes, int mask) {
    if (w == DM_LANES8) {
        const form f =
            {.map = MAP_0F38, .opcode = 0x65, .reg = d, .vvvv = no, .prefix = PP_66, .mask = mask};
        emit_evex(c, w, &f, dm_in_register(yes), NONE);
        return;
    }
    const form f = {.map = MAP_0F3A, .opcode = 0x4B, .reg = d, .vvvv = no, .prefix = PP_66};
    emit_vex(c, w, &f, dm_in_register(yes), mask << 4);
}

/* lanes that the mask leaves out become zero */
void dm_x86_load_masked(dm_code *c, int d, int mask, dm_operand from) {
    const form f =
        {.map = MAP_0F, .opcode = 0x10, .reg = d, .prefix = PP_66, .mask = mask, .zeroing = 1};
    emit_evex(c, DM_LANES8, &f, from, NONE);
}

/* the scalar form has a second source for the lanes above */
void dm_x86_rsqrt14(dm_code *c, dm_width w, int d, int a) {
    const form f = {.map = MAP_0F38,
                    .opcode = w == DM_SCALAR ? 0x4F : 0x4E,
                    .reg = d,
                    .vvvv = w == DM_SCALAR ? a : 0,
                    .prefix = PP_66};
    emit_evex(c, w, &f, dm_in_register(a), NONE);
}

/* with a mask only EVEX will do, whatever the width */
void dm_x86_fused(dm_code *c, dm_width w, int opcode, int d, int a, dm_operand b, int mask) {
    const form f = {.map = MAP_0F38,
                    .opcode = opcode + (w == DM_SCALAR),
                    .reg = d,
                    .vvvv = a,
                    .prefix = PP_66,
                    .wide = 1,
                    .mask = mask};
    if (mask)
        emit_evex(c, w, &f, b, NONE);
    else
        emit(c, w, &f, b, NONE);
}

void dm_x86_fma(dm_code *c, dm_width w, int accumulate, int d, int a, dm_operand b) {
    dm_x86_fused(c, w, accumulate ? DM_X86_FMADD231 : DM_X86_FMADD213, d, a, b, 0);
}

/* a comparison into a mask register, in lanes where another mask holds */
void dm_x86_test(dm_code *c, dm_width w, int mask, int a, dm_operand b, int relation, int under) {
    const form f = {.map = MAP_0F,
                    .opcode = 0xC2,
                    .reg = mask,
                    .vvvv = a,
                    .prefix = w == DM_SCALAR ? PP_F2 : PP_66,
                    .mask = under};
    emit_evex(c, w, &f, b, relation);
}

/* vfixupimm: each lane's kind (number, NaN, infinity ...) picks a nibble of the table */
void dm_x86_fix(dm_code *c, int d, int a, dm_operand table) {
    const form f = {.map = MAP_0F3A, .opcode = 0x54, .reg = d, .vvvv = a, .prefix = PP_66};
    emit_evex(c, DM_LANES8, &f, table, 0); /* no flags */
}

/* vrange: the smaller absolute value with the sign of the first operand */
void dm_x86_bound(dm_code *c, int d, int a, dm_operand b) {
    const form f =
        {.map = MAP_0F3A, .opcode = 0x50, .reg = d, .vvvv = a, .prefix = PP_66, .wide = 1};
    emit_evex(c, DM_LANES8, &f, b, 2); /* the smaller size, the first one's sign */
}

/* vpermt2pd: a look-up in 16 numbers */
void dm_x86_pick(dm_code *c, int d, int a, dm_operand b) {
    const form f =
        {.map = MAP_0F38, .opcode = 0x77, .reg = d, .vvvv = a, .prefix = PP_66, .wide = 1};
    emit_evex(c, DM_LANES8, &f, b, NONE);
}

/* vscalef: times a power of two, without overflow on the way */
void dm_x86_scale(dm_code *c, int d, int a, int b) {
    const form f = {.map = MAP_0F38, .opcode = 0x2C, .reg = d, .vvvv = a, .prefix = PP_66};
    emit_evex(c, DM_LANES8, &f, dm_in_register(b), NONE);
}

/* call through a pointer in memory */
void dm_x86_call(dm_code *c, dm_operand pointer) {
    instruction i = {.size = 0};
    if (pointer.base >> 3) byte(&i, 0x41);
    byte(&i, 0xFF);
    address(&i, 2, pointer, 1);
    put(c, &i, NONE);
}

/* an address into a general register */
void dm_x86_lea(dm_code *c, int d, dm_operand memory) {
    instruction i = {.size = 0};
    byte(&i, 0x48 | (d >> 3) << 2 | memory.base >> 3);
    byte(&i, 0x8D);
    address(&i, d, memory, 1);
    put(c, &i, NONE);
}

/* vzeroupper: SSE code of the C library is slow while upper halves are dirty */
void dm_x86_clear_uppers(dm_code *c) {
    dm_x86_bytes(c, "\xC5\xF8\x77", 3);
}
