/* jit_root.c - x^(-1/2) and x^(-3/2) in machine code, operation by operation what
 * numbers/reciprocal_root.c does, so that both have the same bits: a look-up to 14 bits and one
 * correction of high order with AVX-512, root and division elsewhere.
 * Speed: P3: 1.60x, gauss(8, 6) against root and division. */
#include "code/native/jit_root.h"

#include "code/native/jit_pool.h"
#include "numbers/processor.h"

/* registers: the argument, the look-up y, the error e0 = 1 - x y^2, the polynomial p(e0) */
typedef struct {
    dm_emitter *e;
    int x, y, error, p; /* registers */
} roots;

static void multiply(const roots *r, int d, int a, int b) {
    dm_x86_op(&r->e->code, r->e->width, DM_X86_MUL, d, a, dm_in_register(b));
}

/* d = +-(a d) + b, or a b +- d */
static void fused(const roots *r, int opcode, int d, int a, dm_operand b) {
    dm_x86_fused(&r->e->code, r->e->width, opcode, d, a, b, 0);
}

/* d = c1 + c2 e0 */
static void pair(const roots *r, int d, int first) {
    dm_x86_load(&r->e->code, r->e->width, d, dm_pool_mask(r->e, first + 1));
    fused(r, DM_X86_FMADD213, d, r->error, dm_pool_mask(r->e, first));
}

/* a += a e p where the error is a number, and a finite if the mask register says so; e may be
 * destroyed */
static void correct(const roots *r, int a, int e, int under) {
    dm_code *c = &r->e->code;
    dm_x86_test(c, r->e->width, 1, r->error, dm_in_register(r->error), DM_X86_NUMBERS, under);
    multiply(r, e, e, a);
    dm_x86_fused(c, r->e->width, DM_X86_FMADD231, a, e, dm_in_register(r->p), 1);
}

/* x y may be rounded where y^2 would be infinite: e takes that in */
static void root(const roots *r) {
    const int low = dm_take_register(r->e);
    dm_x86_rsqrt14(&r->e->code, r->e->width, r->y, r->x);
    multiply(r, r->error, r->x, r->y);
    dm_x86_load(&r->e->code, r->e->width, low, dm_in_register(r->error));
    fused(r, DM_X86_FMSUB231, low, r->x, dm_in_register(r->y));
    fused(r, DM_X86_FNMADD213, r->error, r->y, dm_pool_mask(r->e, DM_POOL_ONE));
    fused(r, DM_X86_FNMADD213, low, r->y, dm_in_register(r->error)); /* e */
    pair(r, r->p, DM_POOL_ROOT2);
    fused(r, DM_X86_FMADD213, r->p, r->error, dm_pool_mask(r->e, DM_POOL_ROOT1));
    correct(r, r->y, low, 0);
}

/* y^3 where y^3 (1 + e p) is no number, and that elsewhere */
static void correct_lanes(const roots *r) {
    multiply(r, r->error, r->error, r->y);
    fused(r, DM_X86_FMADD213, r->p, r->error, dm_in_register(r->y));
    dm_x86_fix(&r->e->code, r->y, r->p, dm_pool_mask(r->e, DM_POOL_NUMBERS_PASS));
}

/* y^2 is exact where y^3 is finite, so is y^3. Lanes wait for no single result, but for their
 * turn: one instruction fewer */
static void cube(const roots *r) {
    const int t = dm_take_register(r->e), square = dm_take_register(r->e);
    const int eight = r->e->width == DM_LANES8;
    dm_x86_rsqrt14(&r->e->code, r->e->width, r->y, r->x);
    multiply(r, r->error, r->y, r->y);
    multiply(r, r->y, r->y, r->error);
    fused(r, DM_X86_FNMADD213, r->error, r->x, dm_pool_mask(r->e, DM_POOL_ONE)); /* e */
    if (!eight)
        dm_x86_test(&r->e->code, r->e->width, 1, r->y, dm_pool_mask(r->e, DM_POOL_INFINITY),
                    DM_X86_LESS, 0);
    pair(r, t, DM_POOL_CUBE3);
    pair(r, r->p, DM_POOL_CUBE1);
    multiply(r, square, r->error, r->error);
    fused(r, DM_X86_FMADD231, r->p, t, dm_in_register(square));
    if (eight)
        correct_lanes(r);
    else
        correct(r, r->y, r->error, 1);
}

/* one rounding more, and two long instructions */
static void by_division(const roots *r, int cubed) {
    dm_code *c = &r->e->code;
    dm_x86_op(c, r->e->width, DM_X86_SQRT, r->y, r->x, dm_in_register(r->x));
    if (cubed) multiply(r, r->y, r->x, r->y);
    dm_x86_load(c, r->e->width, r->p, dm_pool_mask(r->e, DM_POOL_ONE));
    dm_x86_op(c, r->e->width, DM_X86_DIV, r->y, r->p, dm_in_register(r->y));
}

void dm_emit_reciprocal_root(dm_emitter *e, const dm_step *s) {
    roots r = {.e = e, .x = dm_in_a_register(e, s->arg[0])};
    const int cubed = s->op == DM_OP_RSQRT3;
    r.y = dm_take_register(e);
    r.error = dm_take_register(e);
    r.p = dm_take_register(e);
    if (dm_processor() != DM_AVX512)
        by_division(&r, cubed);
    else if (cubed)
        cube(&r);
    else
        root(&r);
    dm_pass_operands(e, s);
    dm_define(e, s->d, r.y);
}
