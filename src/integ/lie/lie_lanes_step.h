/* lie_lanes_step.h - a step in the natural chart by chord iterations for W members; a text for the
 * files of lie_lanes.h. */
#ifndef DM_LIE_LANES_STEP_H
#define DM_LIE_LANES_STEP_H

#include "integ/lie/lie_lanes.h"
#include "integ/lie/lie_step_text.h"
#include "linalg/lu_text.h"
#include "linalg/solve/newton_text.h"

INLINE void copy_lanes_where(I yes, double *to, const double *from, size_t count) {
    for (size_t k = 0; k < count; k++) put_where(yes, to + k * W, load(from + k * W));
}

/* P and p0 + P of the evaluation that was made, where it is that of a lane */
INLINE void note_momenta(const dm_lie_lanes *w, I yes) {
    copy_lanes_where(yes, w->gain, w->group.gain, w->group.d);
    copy_lanes_where(yes, w->mu, w->group.mu, w->group.d);
}

/* residual of lanes that keep their matrix */
INLINE void evaluate_old(chord *c, const dm_lie_lanes *w, I old) {
    const V terms = find_equation(&w->group, c->r, NULL, c->x);
    c->terms = pick(old, terms, c->terms);
    note_momenta(w, old);
}

/* residual, matrix and factors of those that take a new one; `all`: of every lane */
INLINE void evaluate_fresh(chord *c, const dm_lie_lanes *w, uint32_t m, int all) {
    double *r = all ? c->r : w->r2, *J = all ? w->J : w->J2;
    I *pivot = (I *)(void *)(all ? w->pivot : w->pivot2), *kept = (I *)(void *)w->pivot, numbers;
    const V terms = find_equation(&w->group, r, J, c->x);
    c->terms = pick(c->fresh, terms, c->terms);
    note_momenta(w, c->fresh);
    copy_lanes_where(c->fresh, w->mu_V, w->group.mu_V, (size_t)w->group.d * m);
    if (!all) copy_lanes_where(c->fresh, c->r, r, m);
    c->fresh &= is_finite(norm_of(r, m));
    const I regular = factor_matrix(J, pivot, m, &numbers);
    c->todo &= regular | not_of(c->fresh);
    c->fresh &= c->todo;
    if (all) return;
    copy_lanes_where(c->fresh, w->J, J, (size_t)m * m);
    for (uint32_t k = 0; k < m; k++) kept[k] = pick_number(c->fresh, pivot[k], kept[k]);
}

/* For the text of the iterations; lanes where that does not go well leave. */
INLINE void evaluate_lanes(chord *c, void *ctx, uint32_t m, int all) {
    const dm_lie_lanes *w = ctx;
    const I old = c->todo & not_of(c->fresh);
    if (some(old)) evaluate_old(c, w, old);
    if (some(c->fresh)) evaluate_fresh(c, w, m, all);
    c->residual = norm_of(c->r, m);
    c->todo &= is_finite(c->residual);
    c->fresh &= c->todo;
}

INLINE void solve_lanes(const chord *c, void *ctx, double *x, uint32_t m) {
    const dm_lie_lanes *w = ctx;
    (void)c;
    solve_factored(x, w->J, (const I *)(const void *)w->pivot, m);
}

/* unknowns of one group of lanes; the lanes that have ended well */
INLINE uint32_t step_in_lanes(const dm_lie_lanes *w, uint32_t asked) {
    const dm_lie *e = &w->group;
    chord c = {.x = e->V,
               .r = w->r,
               .dx = w->dx,
               .tolerance = w->tolerance,
               .own = {w->ones, 1, load(e->h), 0},
               .factored = 1};
    copy_lanes(e->x, e->state, e->n);
    c.todo = c.fresh = mask_of(asked) & guess_ahead(e);
    if (!some(c.todo)) return 0;
    I ended = iterate_chord(&c, evaluate_lanes, solve_lanes, (void *)(uintptr_t)w, e->m,
                            w->max_iterations, NULL);
    copy_lanes(e->gain, w->gain, e->d);
    copy_lanes(e->mu, w->mu, e->d);
    copy_lanes(e->mu_V, w->mu_V, (size_t)e->d * e->m);
    correct_momenta(e, w->dx);
    find_end(e);
    /* next to the edge of the chart the stepper decides */
    ended &= has_finite_end(e) & WHERE(arc_of(e) < 8.8);
    leave_end(e, ended);
    keep_step(e, ended);
    return bits_of(ended);
}

#endif
