/* implicit_solve.c - damped Newton's method with the natural monotonicity test (Deuflhard 2004,
 * 3.3): a step is short enough when the increment that its end asks for, with the same matrix,
 * is shorter than the step's own. That test does not depend on how the equations are scaled. The
 * matrix is inverted: the inverse is wanted at the root anyway. Long because it is one method, from
 * its starts to what is known of a root. */
#include "code/implicit/implicit_solve.h"

#include "base/largest.h"
#include "code/implicit/implicit_bracket.h"
#include "linalg/inverse.h"

#include <math.h>
#include <string.h>

enum {
    ITERATIONS = 60,
    AT_MOST_NEAR = 8, /* from a y that should be near */
    HALVINGS = 16,
    SCATTERED = 32, /* starts beside those of the function */
    SLOW = 8, /* full steps that halve the error, no quick ones after: a root of higher order */
    FORGOTTEN = 64 /* roots found after a trouble */
};
static const double EXACT = 0x1p-50;             /* increment, relative: nothing is left to gain */
static const double NEAR = 1e-9;                 /* and one that rounding may keep from shrinking */
static const double ROUNDED = 0x1p-40;           /* of the terms of F */
static const double CUT = 0x1p-4, GROWN = 0x1p8; /* parts of increments, and how these grow */
static const double QUICK = 0.1;
static const double ROUGH = 0x1p-24; /* increment, relative */
static const double LEAST = 0x1p-15; /* part of an increment, */
static const double LONGER = 4.0;    /* than the last part */
static const double STEEPEST = 16.0; /* and what is left of one at least */
static const double ROOT = 1e-9;     /* |F| at a root, of that at the start */
static const double RANK = 1e13;     /* | |J^-1| |J| |: beyond, J has lost its rank */
static const double UNKNOWN = 1e7;   /* the same of y when terms of F are rounded: 1e-9 are wrong */
static const double radii[] = {1.0, 3.0, 0.3, 6.0};

/* ---- making one ---- */

/* starts that are numbers need no kernel */
static int all_constant(const dm_implicit *f, double *value) {
    for (uint32_t i = 0; i < f->starts * f->unknowns; i++)
        if (!dm_is_constant(f->graph, f->start[i], value + i)) return 0;
    return 1;
}

/* one block for all numbers that an attempt works on; 0 without memory */
static int take_memory(dm_root_solver *s, const dm_implicit *f, dm_arena *arena) {
    const size_t r = f->unknowns, in = dm_graph_inputs(f->graph);
    const size_t total = in + (r + r * r + 1) + f->starts * r + 2 * r * r + 6 * r + r * f->inputs;
    double *block = dm_arena_take(arena, total * sizeof *block);
    s->pivot = dm_arena_take(arena, r * sizeof *s->pivot);
    if (!block || !s->pivot) return 0;
    memset(block, 0, total * sizeof *block);
    s->in = block;
    s->out = s->in + in;
    s->from = s->out + r + r * r + 1;
    s->inverse = s->from + f->starts * r;
    s->other = s->inverse + r * r;
    s->dy = s->other + r * r;
    s->trial = s->dy + r;
    s->next = s->trial + r;
    s->best = s->next + r;
    s->scratch = s->best + r;
    s->by_x = s->scratch + r;
    s->stride = s->by_x + r * f->inputs;
    return 1;
}

/* strides 1/g, 1/g^2, ... of a sequence that fills the cube evenly, g^(r+1) = g + 1 (Roberts
 * 2018) */
static void find_strides(dm_root_solver *s) {
    double g = 2.0, stride = 1.0;
    for (int k = 0; k < 64; k++) g = pow(1.0 + g, 1.0 / (s->r + 1.0));
    for (uint32_t i = 0; i < s->r; i++) s->stride[i] = stride /= g;
}

/* Starts that are numbers are read once; else they have a kernel of x. */
dm_status dm_root_solver_build(dm_root_solver *out, const dm_implicit *f, dm_compile *compile,
                               dm_compile *slopes, dm_arena *arena, int noted) {
    const uint32_t r = f->unknowns;
    dm_root_solver s = {.r = r,
                        .n = f->inputs,
                        .starts = f->starts,
                        .has_branch = f->has_branch,
                        .most = ITERATIONS,
                        .angles = f->angles,
                        .trouble = noted ? f->trouble : NULL};
    if (!take_memory(&s, f, arena)) return DM_NO_MEMORY;
    dm_status status =
        compile(&s.equation, f->graph, f->equation, r + r * r + (uint32_t)f->has_branch, arena);
    if (status == DM_OK) status = slopes(&s.slope, f->graph, f->slope, r * f->inputs, arena);
    if (status == DM_OK && !all_constant(f, s.from)) {
        status = compile(&s.start, f->graph, f->start, f->starts * r, arena);
        if (status == DM_OK) dm_kernel_prepare(&s.start, s.from);
    }
    if (status != DM_OK) return status;
    find_strides(&s);
    dm_kernel_prepare(&s.equation, s.out);
    dm_kernel_prepare(&s.slope, s.by_x);
    *out = s;
    return DM_OK;
}

/* ---- Newton's method ---- */

/* the largest |a_i|; a NaN stays */
static double norm(const double *a, uint32_t m) {
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++) largest = dm_largest(largest, a[i]);
    return largest;
}

/* F, F_y and the branch condition at y; 0: F is not finite there */
static int evaluate(dm_root_solver *s, const double *y) {
    memcpy(s->in, y, s->r * sizeof *y);
    dm_kernel_eval(&s->equation, s->in, s->out);
    return isfinite(norm(s->out, s->r));
}

/* dy = -J^-1 F; its length */
static double increment(const dm_root_solver *s, double *dy, const double *inverse) {
    const uint32_t r = s->r;
    for (uint32_t i = 0; i < r; i++) {
        double sum = 0.0;
        for (uint32_t k = 0; k < r; k++) sum -= inverse[i * (size_t)r + k] * s->out[k];
        dy[i] = sum;
    }
    return norm(dy, r);
}

/* of the branch condition, where it was last evaluated */
static double branch(const dm_root_solver *s) {
    return s->has_branch ? s->out[s->r + (size_t)s->r * s->r] : 1.0;
}

/* J^-1 where F was last evaluated; 0: there is none */
static int invert(dm_root_solver *s, double *inverse) {
    memcpy(inverse, s->out + s->r, (size_t)s->r * s->r * sizeof *inverse);
    return dm_invert(inverse, s->pivot, s->r) == DM_OK;
}

/* one Newton iteration on its way; y is far apart where one is that much smaller than another, and
 * that many increments more are waited for then */
enum { PATIENCE = 4 };
static const double APART = 0x1p10;

typedef struct {
    double *y;
    double step, next, size; /* |dy|, the next one, the largest and |y| */
    double first;            /* |F| at the start */
    double noise;            /* what rounding may leave of F where the start is a root */
    int inside;              /* stay where the branch condition holds */
    int blocked;             /* by that, lately */
    int quick;
    double part; /* of dy that the last step took */
    double cut;  /* |dy| where steps began to be cut short, or y had doubled; 0: they are not */
    double from; /* |y| there */
    double bend; /* of the path where a part of dy was too long, per length of dy; 0: not told */
    int waited;  /* increments since only small y had not settled */
    int slow;    /* iterations that halved the step at best, since quick ones */
} path;

/* to = y + part dy */
static void move(double *to, const double *y, const double *dy, double part, uint32_t r) {
    for (uint32_t i = 0; i < r; i++) to[i] = y[i] + part * dy[i];
}

/* an increment that changes no digit of y */
static double exact(const path *p, uint32_t r) {
    return EXACT * norm(p->y, r);
}

/* sum_l |a_kl x_l| of row k, |a_kl| where x is NULL */
static double row_sum(const double *a, const double *x, uint32_t k, uint32_t columns) {
    double sum = 0.0;
    for (uint32_t l = 0; l < columns; l++)
        sum += fabs(a[k * (size_t)columns + l] * (x ? x[l] : 1.0));
    return sum;
}

/* Where the y are far apart in size: has each settled by its own, which is what the equations make
 * of its digits, sum_k |J^-1_ik| sum_l |J_kl y_l|? */
static int each_settled(dm_root_solver *s, path *p) {
    const uint32_t r = s->r;
    double least = INFINITY, *t = s->trial;
    for (uint32_t i = 0; i < r; i++) least = fmin(least, fabs(p->y[i]) + fabs(s->dy[i]));
    if (APART * least >= norm(p->y, r) || p->waited++ >= PATIENCE) return 1;
    for (uint32_t k = 0; k < r; k++) t[k] = row_sum(s->out + r, p->y, k, r);
    for (uint32_t i = 0; i < r; i++)
        if (fabs(s->dy[i]) > EXACT * row_sum(s->inverse, t, i, r)) return 0;
    return 1;
}

/* is trial = y + part dy nearer to a root? Then the next increment is shorter, or the one with
 * the old matrix is; the next one and its matrix are in s */
static int is_nearer(dm_root_solver *s, path *p, double part) {
    move(s->trial, p->y, s->dy, part, s->r);
    p->bend = 0.0;
    if (!evaluate(s, s->trial)) return 0;
    p->blocked = p->inside && !(branch(s) > 0.0);
    if (p->blocked) return 0;
    if (!invert(s, s->other)) return 0;
    p->next = increment(s, s->next, s->other);
    if (p->next <= 0.5 * p->step) return 1;
    const double old = increment(s, s->scratch, s->inverse);
    if (old <= (1.0 - 0.25 * part) * p->step || old <= exact(p, s->r)) return 1;
    move(s->scratch, s->scratch, s->dy, part - 1.0, s->r);
    p->bend = 2.0 * norm(s->scratch, s->r) / (part * part * p->step);
    return 0;
}

/* a shorter part than one that was too long: the old matrix makes (1 - part) dy + part^2 bend dy/2
 * of a path that bends evenly, which asks for 1/bend */
static double shorter(const path *p, double part) {
    if (!(p->bend * part > 2.0)) return 0.5 * part;
    return fmax(1.0 / p->bend, part / STEEPEST);
}

/* y + dy, y + dy/2, ...: the first that is nearer; the part taken, 0: none */
static double search(dm_root_solver *s, path *p) {
    const int most = p->step > NEAR * p->size ? HALVINGS : 1;
    double part = most > 1 ? fmin(1.0, LONGER * p->part) : 1.0;
    for (int k = 0; k < most && part >= LEAST; k++, part = shorter(p, part))
        if (is_nearer(s, p, part)) return p->part = part;
    return 0.0;
}

/* two matrices, or two increments, change places; nothing is copied */
static void swap(double **a, double **b) {
    double *const kept = *a;
    *a = *b;
    *b = kept;
}

/* the trial point becomes the point, with its matrix and its increment */
static void take_step(dm_root_solver *s, path *p) {
    memcpy(p->y, s->trial, s->r * sizeof *p->y);
    swap(&s->inverse, &s->other);
    swap(&s->dy, &s->next);
    p->step = p->next;
}

/* J lost its rank: at a root, or where the function begins, it is that; else on the way to
 * nowhere */
static dm_root_outcome rankless(const dm_root_solver *s, const path *p) {
    const int at_root = norm(s->out, s->r) <= ROOT * p->first;
    return at_root || p->step == INFINITY ? DM_ROOT_SINGULAR : DM_ROOT_NONE;
}

/* |F| at the start and what of it may be rounding */
static void note_first(const dm_root_solver *s, path *p) {
    double largest = 0.0;
    for (uint32_t k = 0; k < s->r; k++)
        largest = dm_largest(largest, row_sum(s->out + s->r, NULL, k, s->r));
    p->first = norm(s->out, s->r);
    p->noise = ROUNDED * largest * fmax(1.0, norm(p->y, s->r));
}

/* a short increment is that of a root, or of a pole, where J grows faster than F: there F is
 * larger than at the start */
static dm_root_outcome arrived(const dm_root_solver *s, const path *p) {
    if (!(norm(s->out, s->r) <= fmax(ROOT * p->first, p->noise))) return DM_ROOT_NONE;
    return p->slow < SLOW ? DM_ROOT_FOUND : DM_ROOT_SINGULAR;
}

/* Quick convergence begins where y is still rough: at a root of higher order F comes to be what
 * its terms round to, and that may vanish quickly. */
static int is_quick(const path *p, double before) {
    return p->step < QUICK * before && (p->quick || before > ROUGH * p->size);
}

/* Steps that are cut short while increments grow and y does not double lead to where J loses its
 * rank and F does not vanish, or to nowhere. On the way to a root that is far, as of y^0.1 = 100,
 * both grow. */
static int is_lost(path *p, double part, uint32_t r) {
    const double size = norm(p->y, r);
    if (part > CUT)
        p->cut = 0.0;
    else if (p->cut == 0.0 || size > 2.0 * p->from)
        p->cut = p->step, p->from = size;
    return p->cut > 0.0 && p->step > GROWN * p->cut;
}

/* to the root: y, with J^-1 next to it */
static dm_root_outcome iterate(dm_root_solver *s, path *p) {
    if (!evaluate(s, p->y)) return DM_ROOT_NONE;
    if (p->inside && !(branch(s) > 0.0)) return DM_ROOT_BRANCH;
    note_first(s, p);
    p->step = INFINITY;
    p->part = 1.0;
    if (!invert(s, s->inverse)) return rankless(s, p);
    p->step = increment(s, s->dy, s->inverse);
    p->size = norm(p->y, s->r);
    for (int k = 0; k < s->most && isfinite(p->step); k++) {
        p->size = fmax(p->size, p->step);
        if (p->step <= exact(p, s->r) && each_settled(s, p)) {
            move(p->y, p->y, s->dy, 1.0, s->r);
            return arrived(s, p);
        }
        const double part = search(s, p), before = p->step;
        if (part == 0.0) {
            evaluate(s, p->y);
            if (before > NEAR * p->size || p->blocked) return DM_ROOT_NONE;
            return arrived(s, p); /* F is noise */
        }
        take_step(s, p);
        if (is_lost(p, part, s->r)) return DM_ROOT_NONE;
        p->quick = is_quick(p, before) ? p->quick + 1 : 0;
        if (p->quick == 2) p->slow = 0; /* one may be F that rounds to zero */
        if (p->step > 0.3 * before) p->slow++;
    }
    return p->slow < SLOW ? DM_ROOT_NONE : rankless(s, p);
}

/* max_i sum_k |J^-1_ik| t_k */
static double amplified(const double *inverse, const double *t, uint32_t r) {
    double worst = 0.0;
    for (uint32_t i = 0; i < r; i++) {
        const double sum = row_sum(inverse, t, i, r);
        worst = dm_largest(worst, sum);
    }
    return worst;
}

/* Is y known at the root y? With t_k = sum_l |J_kl| a condition number that scaling the
 * equations does not change (Skeel 1979); with the size of the terms of F, t = |J| |y| + |F_x|
 * |x|, what their rounding does to y. */
static int is_known(dm_root_solver *s, const double *y, double *condition) {
    const uint32_t r = s->r;
    const double *inverse = s->inverse;
    double *t = s->trial;
    for (uint32_t k = 0; k < r; k++) t[k] = row_sum(s->out + r, NULL, k, r);
    *condition = amplified(inverse, t, r);
    dm_kernel_eval(&s->slope, s->in, s->by_x);
    for (uint32_t k = 0; k < r; k++)
        t[k] = row_sum(s->out + r, y, k, r) + row_sum(s->by_x, s->in + r, k, s->n);
    const double terms = amplified(inverse, t, r), size = fmax(1.0, norm(y, r));
    if (!(terms <= *condition * size)) *condition = terms / size;
    return *condition < RANK && terms < UNKNOWN * size;
}

/* ---- starts ---- */

/* y = start number k: those of the function, then around the first one */
static void choose(const dm_root_solver *s, uint32_t k, double *y) {
    const uint32_t r = s->r;
    if (k < s->starts) {
        memcpy(y, s->from + k * (size_t)r, r * sizeof *y);
        return;
    }
    k -= s->starts;
    const double radius = radii[k % (sizeof radii / sizeof *radii)];
    for (uint32_t i = 0; i < r; i++) {
        const double u = (k + 1.0) * s->stride[i];
        y[i] = s->from[i] + radius * (1.0 + fabs(s->from[i])) * (2.0 * (u - floor(u)) - 1.0);
    }
}

/* a root of another branch is told rather than a singular point, that rather than none */
static void note(dm_root_solver *s, dm_root_trouble *found, const dm_root_trouble *now,
                 const double *y) {
    const int better = now->outcome > found->outcome ||
                       (now->outcome == found->outcome && now->residual < found->residual);
    if (!better) return;
    *found = *now;
    memcpy(s->best, y, s->r * sizeof *y);
}

/* what was nearest to a root, for the message */
static void keep(const dm_root_solver *s, const dm_root_trouble *found, const double *x) {
    dm_root_trouble *t = s->trouble;
    double *const where_x = t->x, *const where_y = t->y;
    *t = *found;
    t->x = where_x;
    t->y = where_y;
    memcpy(t->x, x, s->n * sizeof *x);
    memcpy(t->y, s->best, s->r * sizeof *s->best);
}

/* whole turns taken off angles of more than one, which have lost digits; 1 where there were any */
static int unwind(const dm_root_solver *s, double *y) {
    static const double TURN = 0x1.921fb54442d18p+2; /* 2 pi */
    int changed = 0;
    for (uint32_t i = 0; i < s->r; i++)
        if ((s->angles >> i & 1) && fabs(y[i]) > TURN) {
            y[i] -= TURN * floor(y[i] / TURN + 0.5);
            changed = 1;
        }
    return changed;
}

/* To the root next to y; once more from there without its whole turns, for its digits. Equations
 * that are not periodic after all may lead nowhere then. */
static dm_root_outcome find(dm_root_solver *s, double *y, int inside) {
    double wound[DM_ROOT_MOST];
    const dm_root_outcome outcome = iterate(s, &(path){.y = y, .inside = inside});
    memcpy(wound, y, s->r * sizeof *y);
    if (outcome != DM_ROOT_FOUND || !unwind(s, y)) return outcome;
    if (iterate(s, &(path){.y = y, .inside = inside}) == DM_ROOT_FOUND) return DM_ROOT_FOUND;
    memcpy(y, wound, s->r * sizeof *y);
    return iterate(s, &(path){.y = y, .inside = inside});
}

/* one start; what is found is in y, the matrix in s */
static dm_root_trouble attempt(dm_root_solver *s, double *y, double *inverse, int inside) {
    dm_root_trouble t = {.outcome = find(s, y, inside), .condition = INFINITY};
    t.residual = norm(s->out, s->r);
    t.branch = branch(s);
    if (!(t.residual <= INFINITY)) t.residual = INFINITY;
    if (t.outcome != DM_ROOT_FOUND) return t;
    if (inverse) memcpy(inverse, s->inverse, (size_t)s->r * s->r * sizeof *inverse);
    if (!is_known(s, y, &t.condition))
        t.outcome = DM_ROOT_SINGULAR;
    else if (!(t.branch > 0.0))
        t.outcome = DM_ROOT_BRANCH;
    return t;
}

/* all starts, one after the other; inside: only those where the branch condition holds, on paths
 * where it does */
static int try_all(dm_root_solver *s, double *y, double *inverse, int inside,
                   dm_root_trouble *found) {
    for (uint32_t k = 0; k < s->starts + SCATTERED; k++) {
        choose(s, k, y);
        const dm_root_trouble now = attempt(s, y, inverse, inside);
        if (now.outcome == DM_ROOT_FOUND) return 1;
        if (!inside) note(s, found, &now, y);
    }
    return 0;
}

/* of one unknown: beside each change of sign of F */
static int try_signs(dm_root_solver *s, double *y, double *inverse, dm_root_trouble *found) {
    for (int next = 0; s->r == 1 && dm_root_bracket(s, &next, y);) {
        const dm_root_trouble now = attempt(s, y, inverse, 0);
        if (now.outcome == DM_ROOT_FOUND) return 1;
        note(s, found, &now, y);
    }
    return 0;
}

/* NaN everywhere: who computes with it sees that there is no root */
static void give_nothing(const dm_root_solver *s, double *y, double *inverse) {
    for (uint32_t i = 0; i < s->r; i++) y[i] = NAN;
    for (uint32_t i = 0; inverse && i < s->r * s->r; i++) inverse[i] = NAN;
}

/* a failure that lies far back is no longer told */
static void forget(dm_root_trouble *t) {
    if (t && t->outcome != DM_ROOT_FOUND && ++t->since > FORGOTTEN) t->outcome = DM_ROOT_FOUND;
}

/* a few iterations from y, and all starts where they do not do */
dm_root_outcome dm_root_solve_near(dm_root_solver *s, const double *x, double *y, double *inverse) {
    memcpy(s->in + s->r, x, s->n * sizeof *x);
    s->most = AT_MOST_NEAR;
    const dm_root_trouble now = attempt(s, y, inverse, s->has_branch);
    s->most = ITERATIONS;
    if (now.outcome != DM_ROOT_FOUND) return dm_root_solve(s, x, y, inverse);
    forget(s->trouble);
    return DM_ROOT_FOUND;
}

/* F_x is that of the root that was found last */
void dm_root_slope(const dm_root_solver *s, double *slope, const double *inverse) {
    const uint32_t r = s->r, n = s->n;
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < n; j++) {
            double sum = 0.0;
            for (uint32_t k = 0; k < r; k++)
                sum -= inverse[i * (size_t)r + k] * s->by_x[k * (size_t)n + j];
            slope[i * (size_t)n + j] = sum;
        }
}

/* first on paths that stay on the branch, then on any, then by signs */
dm_root_outcome dm_root_solve(dm_root_solver *s, const double *x, double *y, double *inverse) {
    dm_root_trouble found = {.outcome = DM_ROOT_NONE, .residual = INFINITY};
    if (!isfinite(norm(x, s->n))) { /* the trouble is elsewhere */
        give_nothing(s, y, inverse);
        return DM_ROOT_NONE;
    }
    memcpy(s->in + s->r, x, s->n * sizeof *x);
    if (s->start.eval) dm_kernel_eval(&s->start, s->in, s->from);
    memcpy(s->best, s->from, s->r * sizeof *s->best);
    if ((s->has_branch && try_all(s, y, inverse, 1, &found)) || try_all(s, y, inverse, 0, &found) ||
        try_signs(s, y, inverse, &found)) {
        forget(s->trouble);
        return DM_ROOT_FOUND;
    }
    if (s->trouble) keep(s, &found, x);
    give_nothing(s, y, inverse);
    return found.outcome;
}
