/* cells_push.c - forces f(q, v, t) beside L in the kicks of a splitting. The kick that ends a step
 * is implicit in v; what is left on the force, f at its end, begins the next one. */
#include "chain/virtual_work.h"
#include "integ/split/cells_split_inside.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

enum { PASSES = 50 }; /* of Newton's method */

/* what is worked on of one block, in the scratch of a thread */
typedef struct {
    double *f, *dp, *next; /* [unit] the forces; change of p so far; what the forces make of it */
    double *f_q, *f_v;     /* [unit][values] */
    double *J, *rest;      /* [values][values]; scratch of the forces */
} block;

static block block_of(const dm_cells_split *s, double *scratch) {
    const size_t unit = s->unit, v = s->m->work->values;
    block b = {.f = scratch, .dp = scratch + unit, .next = scratch + 2 * unit};
    b.f_q = scratch + 3 * unit;
    b.f_v = b.f_q + unit * v;
    b.J = b.f_v + unit * v;
    b.rest = b.J + v * v + v;
    return b;
}

/* rates of a block, which forces read; the kick that began the step is in the low part of p */
static void set_rates(const dm_cells_split *s, uint32_t i, uint32_t count, const double *dp) {
    const uint32_t n = s->m->n;
    const double *p = s->state + n + i, *low = p + 2 * (size_t)n, *w = s->m->inverse_mass + i;
    double *v = s->x + n + i;
    for (uint32_t k = 0; k < count; k++) v[k] = w[k] * (p[k] + ((dp ? dp[k] : 0.0) + low[k]));
}

/* (1 - hb f_v M^-1) d = r of one cell, by elimination; d takes the place of r */
static void solve_cell(double *J, double *r, const double *f_v, const double *w, double hb,
                       uint32_t v) {
    for (uint32_t a = 0; a < v; a++)
        for (uint32_t b = 0; b < v; b++)
            J[a * v + b] = (a == b ? 1.0 : 0.0) - hb * f_v[a * v + b] * w[b];
    for (uint32_t c = 0; c < v; c++)
        for (uint32_t a = 0; a < v; a++) {
            const double factor = a == c ? 0.0 : J[a * v + c] / J[c * v + c];
            for (uint32_t b = c; b < v && factor != 0.0; b++) J[a * v + b] -= factor * J[c * v + b];
            if (factor != 0.0) r[a] -= factor * r[c];
        }
    for (uint32_t a = 0; a < v; a++) r[a] /= J[a * v + a];
}

/* next[k] = hb (L_q + f), of unit vectors without what turns p out of the tangent space */
static void add_up(const dm_cells_split *s, const block *b, double hb, uint32_t i, uint32_t count) {
    const uint32_t m = s->m->sphere;
    const double *q = s->x + i, *p = s->state + s->m->n + i;
    for (uint32_t k = 0; k < count; k++) b->next[k] = hb * (s->force[i + k] + b->f[k]);
    for (uint32_t k = 0; m && k < count; k += m) {
        const double out = (dm_cells_dot(q + k, p + k, m) + dm_cells_dot(q + k, b->next + k, m)) /
                           dm_cells_dot(q + k, q + k, m);
        for (uint32_t c = 0; c < m; c++) b->next[k + c] -= out * q[k + c];
    }
}

/* The kick that ends a step, p1 = p + hb (L_q + f(q, M^-1 p1, t)), by Newton's method cell by
 * cell; dp is left NaN where it finds nothing. */
static void find_kick(const dm_cells_split *s, const block *b, double hb, uint32_t i,
                      uint32_t count) {
    const uint32_t v = s->m->work->values;
    double last = INFINITY;
    memset(b->dp, 0, count * sizeof *b->dp);
    for (int pass = 0; pass < PASSES; pass++) {
        double step = 0.0, size = 0.0;
        set_rates(s, i, count, b->dp);
        dm_work_force(s->m->work, b->f, b->f_q, b->f_v, s->x, i, count, b->rest);
        add_up(s, b, hb, i, count);
        for (uint32_t k = 0; k < count; k += v) {
            for (uint32_t c = k; c < k + v; c++) b->next[c] -= b->dp[c];
            solve_cell(b->J, b->next + k, b->f_v + (size_t)k * v, s->m->inverse_mass + i + k, hb,
                       v);
        }
        for (uint32_t k = 0; k < count; k++) {
            b->dp[k] += b->next[k];
            step = fmax(step, fabs(b->next[k]));
            size = fmax(size, fabs(b->dp[k]) + fabs(s->state[s->m->n + i + k]));
            if (b->next[k] != b->next[k]) step = INFINITY;
        }
        if (step <= 4e-16 * size || (pass > 2 && step >= 0.5 * last && step <= 1e-12 * size))
            return;
        last = step;
    }
    for (uint32_t k = 0; k < count; k++) b->dp[k] = NAN;
}

void dm_cells_push(const dm_cells_split *s, dm_cells_move *v, uint32_t i, uint32_t count,
                   double *scratch) {
    const block b = block_of(s, scratch);
    double *p = s->state + s->m->n + i, *low_p = p + 2 * (size_t)s->m->n;
    if (s->m->work->reads_v && v->kicks) {
        find_kick(s, &b, v->kick, i, count);
        for (uint32_t k = 0; k < count && !s->plain; k++) dm_sum_add(p + k, low_p + k, b.dp[k]);
        for (uint32_t k = 0; k < count && s->plain; k++) p[k] += b.dp[k];
        v->kicks = 0;
    }
    if (s->m->work->reads_v) set_rates(s, i, count, NULL);
    dm_work_force(s->m->work, b.f, NULL, NULL, s->x, i, count, b.rest);
    for (uint32_t k = 0; k < count; k++) s->force[i + k] += b.f[k];
}
