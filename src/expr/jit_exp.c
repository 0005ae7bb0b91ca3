/*
** jit_exp.c - exp(x) = 2^k (1 + r + r^2 p(r)), k log 2 + r + low = x: operation by operation what `exponential` in
** functions_text.h does, whose numbers these are.
*/
#include "expr/jit_exp.h"

enum {
    LEAST,
    MOST,
    TO_POWER,
    SHIFT,
    LOG2_1,
    LOG2_2,
    ONE,
    C0,
    C1,
    C2,
    C3,
    C4,
    C5,
    C6,
    C7,
    C8,
    C9,
    C10
};

#define ALL(c)                                                                           \
    { c, c, c, c, c, c, c, c }
const double dm_exp_table[][8] = {
    [LEAST] = ALL(-746.0),
    [MOST] = ALL(710.0),
    [TO_POWER] = ALL(0x1.71547652b82fep+0),
    [SHIFT] = ALL(6755399441055744.0),
    [LOG2_1] = ALL(-0x1.62e42fefa39efp-1),
    [LOG2_2] = ALL(-0x1.abc9e3b39803fp-56),
    [ONE] = ALL(1.0),
    [C0] = ALL(0.5),
    [C1] = ALL(0x1.555555555555cp-3),
    [C2] = ALL(0x1.555555555555ep-5),
    [C3] = ALL(0x1.111111110ebb0p-7),
    [C4] = ALL(0x1.6c16c16c13564p-10),
    [C5] = ALL(0x1.a01a01b3bc314p-13),
    [C6] = ALL(0x1.a01a01b45dd8dp-16),
    [C7] = ALL(0x1.71ddef91216c9p-19),
    [C8] = ALL(0x1.27e4bf230b4f3p-22),
    [C9] = ALL(0x1.af6cd1891ec5bp-26),
    [C10] = ALL(0x1.1f9dfff721344p-29),
};
#undef ALL

static dm_operand number(const dm_emitter *e, int which) {
    return which < e->shelved ? dm_in_register(e->shelf + which)
                              : dm_in_memory(DM_EXP_BASE, 64 * which);
}

void dm_shelve_exponential(dm_emitter *e, dm_code *before, int least) {
    const int room = e->registers - least, all = C10 + 1;
    const int count = room < 0 ? 0 : room < all ? room : all;
    e->registers -= count;
    e->shelf = e->registers;
    for (; e->shelved < count; e->shelved++)
        dm_x86_load(before, DM_LANES8, e->shelf + e->shelved,
                    dm_in_memory(DM_EXP_BASE, 64 * e->shelved));
}

static void fetch(dm_emitter *e, int d, int which) {
    dm_x86_load(&e->code, DM_LANES8, d, number(e, which));
}

/* d = a d + b */
static void fuse(dm_emitter *e, int d, int a, dm_operand b) {
    dm_x86_fma(&e->code, DM_LANES8, 0, d, a, b);
}

/* d = r high + low */
static void line(dm_emitter *e, int d, int r, int high, int low) {
    fetch(e, d, high);
    fuse(e, d, r, number(e, low));
}

static void operate(dm_emitter *e, int opcode, int d, int a, dm_operand b) {
    dm_x86_op(&e->code, DM_LANES8, opcode, d, a, b);
}

/* registers: what x is reduced to, its powers, and what the polynomial wants */
typedef struct {
    int k, r, low, r2, r4, t[6];
} registers;

/* t0 = x between its bounds; k, r, low */
static void reduce(dm_emitter *e, const registers *u, int x) {
    const int y = u->t[0], exact = u->t[1];
    fetch(e, y, LEAST);
    operate(e, DM_X86_MAX, y, y, dm_in_register(x));
    fetch(e, exact, MOST);
    operate(e, DM_X86_MIN, y, exact, dm_in_register(y));
    fetch(e, u->k, TO_POWER);
    fuse(e, u->k, y, number(e, SHIFT));
    operate(e, DM_X86_SUB, u->k, u->k, number(e, SHIFT));
    fetch(e, exact, LOG2_1);
    fuse(e, exact, u->k, dm_in_register(y));
    fetch(e, u->r, LOG2_2);
    fuse(e, u->r, u->k, dm_in_register(exact));
    operate(e, DM_X86_SUB, u->low, exact, dm_in_register(u->r));
    dm_x86_fma(&e->code, DM_LANES8, 1, u->low, u->k, number(e, LOG2_2));
}

/* t5 = r^2 p(r) */
static void polynomial(dm_emitter *e, const registers *u) {
    const int *t = u->t, r = u->r, high = t[5];
    operate(e, DM_X86_MUL, u->r2, r, dm_in_register(r));
    operate(e, DM_X86_MUL, u->r4, u->r2, dm_in_register(u->r2));
    line(e, t[0], r, C1, C0);
    line(e, t[1], r, C3, C2);
    line(e, t[2], r, C5, C4);
    line(e, t[3], r, C7, C6);
    line(e, t[4], r, C9, C8);
    fetch(e, high, C10);
    fuse(e, high, u->r2, dm_in_register(t[4]));
    fuse(e, t[3], u->r2, dm_in_register(t[2]));
    fuse(e, high, u->r4, dm_in_register(t[3]));
    fuse(e, t[1], u->r2, dm_in_register(t[0]));
    fuse(e, high, u->r4, dm_in_register(t[1]));
    operate(e, DM_X86_MUL, high, u->r2, dm_in_register(high));
}

void dm_emit_exponential(dm_emitter *e, const dm_step *s) {
    registers u;
    int *const all[] = {&u.k,    &u.r,    &u.low,  &u.r2,   &u.r4,  u.t,
                        u.t + 1, u.t + 2, u.t + 3, u.t + 4, u.t + 5};
    dm_bury_slots(e);
    const int x = dm_in_a_register(e, s->arg[0]);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) *all[i] = dm_take_register(e);
    const int y = u.t[5];
    reduce(e, &u, x);
    polynomial(e, &u);
    operate(e, DM_X86_ADD, y, y, dm_in_register(u.low));
    operate(e, DM_X86_ADD, y, u.r, dm_in_register(y));
    operate(e, DM_X86_ADD, y, y, number(e, ONE));
    dm_x86_scale(&e->code, y, y, u.k);
    dm_pass_operands(e, s);
    dm_define(e, s->d, y);
}
