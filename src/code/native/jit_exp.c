/* jit_exp.c - exp(x) = 2^m 2^(j/16) (1 + r + r^2 p(r)), (m + j/16) log 2 + r = x: operation by
 * operation what `exponential` in numbers/functions_text.h does, but that r is kept between
 * bounds and not x: where x is beyond them the last operation, 2^m, decides alone, and where it
 * is no number that gives it back. Written out because a call would lose all registers of a
 * loop along arrays; elsewhere exp is called.
 * Speed: P8-toda-1024: 1.43x, against a call for every 8 bodies. */
#include "code/native/jit_exp.h"

#include "numbers/functions.h"

/* numbers of the table, in the order in which registers are given to them */
enum {
    TO_POWER,
    SHIFT,
    LOG2_1,
    LOG2_2,
    BOUND,
    C0,
    C1,
    C2,
    C3,
    C4,
    POWERS,
    LATER_POWERS,
    LOWS,
    LATER_LOWS,
    NUMBERS
};

#define ALL(c)                                                                                     \
    { c, c, c, c, c, c, c, c }
const double dm_exp_table[][8] __attribute__((aligned(64))) = {
    [TO_POWER] = ALL(0x1.71547652b82fep+0),
    [SHIFT] = ALL(0x1.8p48),
    [LOG2_1] = ALL(-0x1.62e42fefa39efp-1),
    [LOG2_2] = ALL(-0x1.abc9e3b39803fp-56),
    [BOUND] = ALL(0.025),
    [C0] = ALL(EXP_0),
    [C1] = ALL(EXP_1),
    [C2] = ALL(EXP_2),
    [C3] = ALL(EXP_3),
    [C4] = ALL(EXP_4),
    [POWERS] = {EXP_POWERS},
    [LATER_POWERS] = {EXP_LATER_POWERS},
    [LOWS] = {EXP_LOWS},
    [LATER_LOWS] = {EXP_LATER_LOWS},
};
#undef ALL

/* in its register, if it has got one, else in the table */
static dm_operand number(const dm_emitter *e, int which) {
    return which < e->exp_registers ? dm_in_register(e->exp_first + which)
                                    : dm_in_memory(DM_EXP_BASE, 64 * which);
}

void dm_exp_to_registers(dm_emitter *e, dm_code *before, int least) {
    const int room = e->registers - least, all = NUMBERS;
    const int count = room < 0 ? 0 : room < all ? room : all;
    e->registers -= count;
    e->exp_first = e->registers;
    for (; e->exp_registers < count; e->exp_registers++)
        dm_x86_load(before, DM_LANES8, e->exp_first + e->exp_registers,
                    dm_in_memory(DM_EXP_BASE, 64 * e->exp_registers));
}

/* d = that number in all lanes */
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

/* d = a op b in 8 lanes */
static void operate(dm_emitter *e, int opcode, int d, int a, dm_operand b) {
    dm_x86_op(&e->code, DM_LANES8, opcode, d, a, b);
}

/* registers: sixteenths, what they leave of x, its square, and what the polynomial wants */
typedef struct {
    int t, k, r, r2, low, high, p;
} registers;

/* t = x in sixteenths of log 2, rounded by adding SHIFT; k = that as a number, r = x - k log 2 */
static void reduce(dm_emitter *e, const registers *u, int x) {
    fetch(e, u->t, TO_POWER);
    fuse(e, u->t, x, number(e, SHIFT));
    operate(e, DM_X86_SUB, u->k, u->t, number(e, SHIFT));
    fetch(e, u->r, LOG2_1);
    fuse(e, u->r, u->k, dm_in_register(x));
    dm_x86_fma(&e->code, DM_LANES8, 1, u->r, u->k, number(e, LOG2_2));
    dm_x86_bound(&e->code, u->r, u->r, number(e, BOUND));
}

/* p = r + r^2 p(r) */
static void polynomial(dm_emitter *e, const registers *u) {
    const int p = u->p, r = u->r, r2 = u->r2;
    operate(e, DM_X86_MUL, r2, r, dm_in_register(r));
    line(e, u->low, r, C1, C0);
    line(e, u->high, r, C3, C2);
    fetch(e, p, C4);
    fuse(e, p, r2, dm_in_register(u->high));
    fuse(e, p, r2, dm_in_register(u->low));
    fuse(e, p, r2, dm_in_register(r));
}

/* d = entries of table `first` and the one behind it that the sixteenths say; `room` may be used */
static void pick(dm_emitter *e, const registers *u, int d, int first, int room) {
    const dm_operand table = number(e, first);
    const int in = table.reg < 0 ? room : table.reg;
    if (d != u->t) dm_x86_load(&e->code, DM_LANES8, d, dm_in_register(u->t));
    if (table.reg < 0) fetch(e, in, first);
    dm_x86_pick(&e->code, d, in, number(e, first + 1));
}

void dm_emit_exponential(dm_emitter *e, const dm_step *s) {
    registers u;
    int *const all[] = {&u.t, &u.k, &u.r, &u.r2, &u.low, &u.high, &u.p};
    dm_free_slots(e);
    const int x = dm_in_a_register(e, s->arg[0]);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) *all[i] = dm_take_register(e);
    reduce(e, &u, x);
    polynomial(e, &u);
    pick(e, &u, u.high, POWERS, u.r);
    pick(e, &u, u.t, LOWS, u.r2);
    fuse(e, u.p, u.high, dm_in_register(u.t));
    operate(e, DM_X86_ADD, u.p, u.high, dm_in_register(u.p));
    dm_x86_scale(&e->code, u.p, u.p, u.k);
    dm_pass_operands(e, s);
    dm_define(e, s->d, u.p);
}
