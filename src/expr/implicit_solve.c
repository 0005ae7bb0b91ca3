/*
** implicit_solve.c - damped Newton's method with the natural monotonicity test (Deuflhard 2004, 3.3): a step is short
** enough when the increment that its end asks for, with the same matrix, is shorter than the step's own. That test does
** not depend on how the equations are scaled, and costs one solution with factors that are there.
*/
#include "expr/implicit_solve.h"

#include "linalg/lu.h"

#include <math.h>
#include <string.h>

enum {
    ITERATIONS = 60,
    HALVINGS = 16,
    SCATTERED = 24, /* starts beside those of the function */
    SLOW =
        8, /* full steps that but halve the error, and no two quick ones after: a root of higher order */
    FORGOTTEN = 64 /* roots found after a trouble */
};
static const double EXACT = 0x1p-50; /* increment, relative: nothing is left to gain */
static const double NEAR = 1e-9;     /* and one that rounding may keep from shrinking */
static const double QUICK = 0.1;
static const double ROOT = 1e-9; /* |F| at a root, of that at the start */
static const double RANK = 1e13; /* | |J^-1| |J| |: beyond, J has lost its rank */
static const double UNKNOWN =
    1e7; /* the same of y when terms of F are rounded: 1e-9 are wrong */
static const double radii[] = {0.3, 1.0, 0.1, 3.0};

/* ---- making one ---- */

static int all_constant(const dm_implicit *f, double *value) {
    for (uint32_t i = 0; i < f->starts * f->unknowns; i++)
        if (!dm_is_constant(f->graph, f->start[i], value + i)) return 0;
    return 1;
}

static int take_memory(dm_root_solver *s, const dm_implicit *f, dm_arena *arena) {
    const size_t r = f->unknowns, in = dm_graph_inputs(f->graph);
    const size_t total =
        in + (r + r * r + 1) + f->starts * r + 2 * r * r + 4 * r + r * f->inputs;
    double *block = dm_arena_take(arena, total * sizeof *block);
    s->pivot = dm_arena_take(arena, r * sizeof *s->pivot);
    if (!block || !s->pivot) return 0;
    memset(block, 0, total * sizeof *block);
    s->in = block;
    s->out = s->in + in;
    s->from = s->out + r + r * r + 1;
    s->factors = s->from + f->starts * r;
    s->row = s->factors + r * r;
    s->dy = s->row + r * r;
    s->trial = s->dy + r;
    s->next = s->trial + r;
    s->best = s->next + r;
    s->by_x = s->best + r;
    return 1;
}

dm_status dm_root_solver_build(dm_root_solver *out, const dm_implicit *f,
                               dm_root_compile *compile, dm_arena *arena, int noted) {
    const uint32_t r = f->unknowns;
    dm_root_solver s = {.r = r,
                        .n = f->inputs,
                        .starts = f->starts,
                        .has_branch = f->has_branch,
                        .trouble = noted ? f->trouble : NULL};
    if (!take_memory(&s, f, arena)) return DM_NO_MEMORY;
    dm_status status = compile(&s.equation, f->graph, f->equation,
                               r + r * r + (uint32_t)f->has_branch, arena);
    if (status == DM_OK)
        status = compile(&s.slope, f->graph, f->slope, r * f->inputs, arena);
    if (status == DM_OK && !all_constant(f, s.from)) {
        status = compile(&s.start, f->graph, f->start, f->starts * r, arena);
        if (status == DM_OK) dm_kernel_prepare(&s.start, s.from);
    }
    if (status != DM_OK) return status;
    dm_kernel_prepare(&s.equation, s.out);
    dm_kernel_prepare(&s.slope, s.by_x);
    *out = s;
    return DM_OK;
}

/* ---- Newton's method ---- */

static double norm(const double *a, uint32_t m) {
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++)
        if (!(fabs(a[i]) <= largest)) largest = fabs(a[i]);
    return largest;
}

static int evaluate(dm_root_solver *s, const double *y) {
    memcpy(s->in, y, s->r * sizeof *y);
    dm_kernel_eval(&s->equation, s->in, s->out);
    return isfinite(norm(s->out, s->r));
}

/* dy = -F_y^-1 F with the factors that there are; its length */
static double increment(const dm_root_solver *s, double *dy) {
    for (uint32_t i = 0; i < s->r; i++) dy[i] = -s->out[i];
    dm_lu_solve(dy, s->factors, s->pivot, s->r);
    return norm(dy, s->r);
}

static int factor(dm_root_solver *s) {
    const size_t size = (size_t)s->r * s->r * sizeof *s->factors;
    memcpy(s->factors, s->out + s->r, size);
    return dm_lu_factor(s->factors, s->pivot, s->r) == DM_OK;
}

/* one Newton iteration on its way */
typedef struct {
    double *y;
    double step, size; /* |dy|; what y is measured against */
    double first;      /* |F| at the start */
    int quick;
    int slow; /* iterations that halved the step at best, since quick ones */
} path;

static void move(double *to, const double *y, const double *dy, double part, uint32_t r) {
    for (uint32_t i = 0; i < r; i++) to[i] = y[i] + part * dy[i];
}

/* trial = y + dy, y + dy/2, ...: the first where the next increment is shorter; the part taken, 0: none */
static double search(dm_root_solver *s, const path *p) {
    const int most = p->step > NEAR * p->size ? HALVINGS : 1;
    double part = 1.0;
    for (int k = 0; k < most; k++, part *= 0.5) {
        move(s->trial, p->y, s->dy, part, s->r);
        if (!evaluate(s, s->trial)) continue;
        const double next = increment(s, s->next);
        if (next <= (1.0 - 0.25 * part) * p->step || next <= EXACT * p->size) return part;
    }
    return 0.0;
}

/* J lost its rank: at a root, or where the function begins, it is that; else on the way to nowhere */
static dm_root_outcome rankless(const dm_root_solver *s, const path *p) {
    const int at_root = norm(s->out, s->r) <= ROOT * p->first;
    return at_root || p->step == INFINITY ? DM_ROOT_SINGULAR : DM_ROOT_NONE;
}

/* to the root: y, with the factors of F_y next to it */
static dm_root_outcome iterate(dm_root_solver *s, path *p) {
    if (!evaluate(s, p->y)) return DM_ROOT_NONE;
    p->first = norm(s->out, s->r);
    p->step = INFINITY;
    if (!factor(s)) return rankless(s, p);
    p->step = increment(s, s->dy);
    p->size = norm(p->y, s->r);
    for (int k = 0; k < ITERATIONS && isfinite(p->step); k++) {
        p->size = fmax(p->size, p->step);
        if (p->step <= EXACT * p->size) {
            move(p->y, p->y, s->dy, 1.0, s->r);
            return p->slow < SLOW ? DM_ROOT_FOUND : DM_ROOT_SINGULAR;
        }
        const double part = search(s, p), before = p->step;
        if (part == 0.0) {
            evaluate(s, p->y);
            if (before > NEAR * p->size) return DM_ROOT_NONE;
            return p->slow < SLOW ? DM_ROOT_FOUND : DM_ROOT_SINGULAR; /* F is noise */
        }
        memcpy(p->y, s->trial, s->r * sizeof *p->y);
        if (!factor(s)) return rankless(s, p);
        p->step = increment(s, s->dy);
        p->quick = p->step < QUICK * before ? p->quick + 1 : 0;
        if (p->quick == 2) p->slow = 0; /* one may be F that rounds to zero */
        if (p->step > 0.3 * before && part == 1.0) p->slow++;
    }
    return p->slow < SLOW ? DM_ROOT_NONE : DM_ROOT_SINGULAR;
}

static void invert(const dm_root_solver *s, double *inverse) {
    const uint32_t r = s->r;
    for (uint32_t k = 0; k < r; k++) {
        memset(s->next, 0, r * sizeof *s->next);
        s->next[k] = 1.0;
        dm_lu_solve(s->next, s->factors, s->pivot, r);
        for (uint32_t i = 0; i < r; i++) inverse[i * (size_t)r + k] = s->next[i];
    }
}

/* sum_l |a_kl x_l| of row k, |a_kl| where x is NULL */
static double row_sum(const double *a, const double *x, uint32_t k, uint32_t columns) {
    double sum = 0.0;
    for (uint32_t l = 0; l < columns; l++)
        sum += fabs(a[k * (size_t)columns + l] * (x ? x[l] : 1.0));
    return sum;
}

/* max_i sum_k |J^-1_ik| t_k */
static double amplified(const double *inverse, const double *t, uint32_t r) {
    double worst = 0.0;
    for (uint32_t i = 0; i < r; i++) {
        const double sum = row_sum(inverse, t, i, r);
        if (!(sum <= worst)) worst = sum;
    }
    return worst;
}

/* Is y known at the root y? With t_k = sum_l |J_kl| a condition number that scaling the equations does not change
** (Skeel 1979); with the size of the terms of F, t = |J| |y| + |F_x| |x|, what their rounding does to y. */
static int is_known(dm_root_solver *s, const double *y, const double *inverse,
                    double *condition) {
    const uint32_t r = s->r;
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

/* uniform in [-1, 1), the same in every call (xorshift64*, Vigna 2016) */
static double scatter(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)((*state * 0x2545F4914F6CDD1Du) >> 11) * 0x1p-52 - 1.0;
}

/* y = start number k: those of the function, then around the first one */
static void choose(const dm_root_solver *s, uint32_t k, double *y, uint64_t *random) {
    const uint32_t r = s->r;
    if (k < s->starts) {
        memcpy(y, s->from + k * (size_t)r, r * sizeof *y);
        return;
    }
    const double radius = radii[(k - s->starts) % (sizeof radii / sizeof *radii)];
    for (uint32_t i = 0; i < r; i++)
        y[i] = s->from[i] + radius * (1.0 + fabs(s->from[i])) * scatter(random);
}

/* a root of another branch is told rather than a singular point, that rather than none */
static void note(dm_root_solver *s, dm_root_trouble *found, const dm_root_trouble *now,
                 const double *y) {
    const int better = now->outcome > found->outcome || (now->outcome == found->outcome &&
                                                         now->residual < found->residual);
    if (!better) return;
    *found = *now;
    memcpy(s->best, y, s->r * sizeof *y);
}

static void keep(const dm_root_solver *s, const dm_root_trouble *found, const double *x) {
    dm_root_trouble *t = s->trouble;
    double *const where_x = t->x, *const where_y = t->y;
    *t = *found;
    t->x = where_x;
    t->y = where_y;
    memcpy(t->x, x, s->n * sizeof *x);
    memcpy(t->y, s->best, s->r * sizeof *s->best);
}

/* one start; what is found is in y, the matrix in s */
static dm_root_trouble attempt(dm_root_solver *s, double *y, double *inverse) {
    path p = {.y = y};
    const size_t at = s->r + (size_t)s->r * s->r;
    dm_root_trouble t = {.outcome = iterate(s, &p), .residual = norm(s->out, s->r)};
    t.condition = INFINITY;
    t.branch = s->has_branch ? s->out[at] : 1.0;
    if (!(t.residual <= INFINITY)) t.residual = INFINITY;
    if (t.outcome != DM_ROOT_FOUND) return t;
    invert(s, inverse);
    if (!is_known(s, y, inverse, &t.condition))
        t.outcome = DM_ROOT_SINGULAR;
    else if (!(t.branch > 0.0))
        t.outcome = DM_ROOT_BRANCH;
    return t;
}

static void give_nothing(const dm_root_solver *s, double *y, double *inverse) {
    for (uint32_t i = 0; i < s->r; i++) y[i] = NAN;
    for (uint32_t i = 0; inverse && i < s->r * s->r; i++) inverse[i] = NAN;
}

dm_root_outcome dm_root_solve(dm_root_solver *s, const double *x, double *y,
                              double *inverse) {
    uint64_t random = 0x9E3779B97F4A7C15u;
    dm_root_trouble found = {.outcome = DM_ROOT_NONE, .residual = INFINITY};
    double *matrix = inverse ? inverse : s->row;
    if (!isfinite(norm(x, s->n))) { /* the trouble is elsewhere */
        give_nothing(s, y, inverse);
        return DM_ROOT_NONE;
    }
    memcpy(s->in + s->r, x, s->n * sizeof *x);
    if (s->start.eval) dm_kernel_eval(&s->start, s->in, s->from);
    memcpy(s->best, s->from, s->r * sizeof *s->best);
    for (uint32_t k = 0; k < s->starts + SCATTERED; k++) {
        choose(s, k, y, &random);
        const dm_root_trouble now = attempt(s, y, matrix);
        if (now.outcome != DM_ROOT_FOUND) {
            note(s, &found, &now, y);
            continue;
        }
        if (s->trouble && s->trouble->outcome != DM_ROOT_FOUND &&
            ++s->trouble->since > FORGOTTEN)
            s->trouble->outcome = DM_ROOT_FOUND;
        return DM_ROOT_FOUND;
    }
    if (s->trouble) keep(s, &found, x);
    give_nothing(s, y, inverse);
    return found.outcome;
}
