/* stage_lanes_newton.h - a step of the general form by chord iterations for W members; a text for
 * the files of stage_lanes.h. */
#ifndef DM_STAGE_LANES_NEWTON_H
#define DM_STAGE_LANES_NEWTON_H

#include "integ/stage/lanes/end_text.h"
#include "integ/stage/lanes/stage_lanes.h"
#include "integ/stage/lanes/warm_text.h"
#include "linalg/lu_text.h"
#include "linalg/solve/newton_text.h"

typedef struct {
    step_equation e;
    const dm_lanes_newton *matrix;
} lanes_newton;

/* factors and pivots of the lanes of `yes` from another matrix */
INLINE void take_factors(I yes, double *to, I *pivot, const double *from, const I *other,
                         uint32_t n) {
    copy_where(yes, to, from, n * n);
    for (uint32_t k = 0; k < n; k++) pivot[k] = pick_number(yes, other[k], pivot[k]);
}

/* Of a quadratic L the matrix is one of h alone: the factors that a lane has serve all its steps.
 * Speed: ensembles, chain of 12, magnetic field, lobatto(3): 3x. */
INLINE I lacks_factors(const lanes_newton *it) {
    return it->e.g->newton.linear ? WHERE(load(it->matrix->made) != load(it->e.group->h))
                                  : all_lanes();
}

/* factors of all lanes are new, those of `fine` are of their h; or of these alone */
INLINE void note_factors(const lanes_newton *it, I fine, int all) {
    const V h = load(it->e.group->h);
    store(it->matrix->made, all ? pick(fine, h, (V){0}) : pick(fine, h, load(it->matrix->made)));
}

/* residual, and matrix and factors of the lanes that renew them; lanes where that does not go
 * well leave */
INLINE void evaluate_equation(chord *c, void *ctx, uint32_t m, int all) {
    const lanes_newton *it = ctx;
    const dm_lanes_newton *w = it->matrix;
    evaluate_points(&it->e, c->x, c->fresh, c->todo & not_of(c->fresh), all);
    c->terms = find_residual(&it->e, c->r);
    c->residual = norm_of(c->r, m);
    c->todo &= is_finite(c->residual);
    c->fresh &= c->todo;
    if (!some(c->fresh & lacks_factors(it))) return;
    double *J = all ? w->J : w->J2;
    I *pivot = (I *)(void *)(all ? w->pivot : w->pivot2), numbers;
    find_matrix(&it->e, J);
    c->todo &= factor_matrix(J, pivot, m, &numbers) | not_of(c->fresh);
    c->fresh &= c->todo;
    if (!all) take_factors(c->fresh, w->J, (I *)(void *)w->pivot, J, pivot, m);
    note_factors(it, c->fresh, all);
}

INLINE void solve_equation(const chord *c, void *ctx, double *x, uint32_t m) {
    const lanes_newton *it = ctx;
    (void)c;
    solve_factored(x, it->matrix->J, (const I *)(const void *)it->matrix->pivot, m);
}

INLINE uint32_t step_of(const dm_stage_lanes *w, uint32_t asked, uint32_t n, uint32_t s,
                        uint32_t r) {
    const dm_stage_group *x = &w->group;
    lanes_newton it = {{w->g, x, &w->newton, w->matrix.other, n, s, r}, &w->matrix};
    chord c = {.x = w->newton.root,
               .r = w->matrix.r,
               .dx = w->matrix.dx,
               .tolerance = x->tolerance,
               .own = {x->state, n, load(x->h), 0},
               .factored = 1};
    c.todo = c.fresh = mask_of(asked) & guess_velocities(&it.e);
    if (!some(c.todo)) return 0;
    I ended =
        iterate_chord(&c, evaluate_equation, solve_equation, &it, s * n, x->max_iterations, NULL);
    ended &= find_end(&it.e, c.x, c.dx);
    keep_velocities(&it.e, ended, all_lanes());
    copy_where(ended, x->state, x->next, 4 * n);
    return bits_of(ended);
}

/* few coordinates and one stage are written out */
HOW static uint32_t step_by_newton(const dm_stage_lanes *w, uint32_t asked) {
    const dm_stage *g = w->g;
    const uint32_t n = g->n, s = g->table.s, r = g->table.r;
    const int one = s == 1 && r == 1;
    if (one && n == 1) return step_of(w, asked, 1, 1, 1);
    if (one && n == 2) return step_of(w, asked, 2, 1, 1);
    if (one && n == 3) return step_of(w, asked, 3, 1, 1);
    if (one && n == 4) return step_of(w, asked, 4, 1, 1);
    return step_of(w, asked, n, s, r);
}

#endif
