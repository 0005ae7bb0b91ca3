/* stage_weights.c - coefficients of a stage method multiplied by powers of the step. */
#include "integ/stage/stage_inside.h"

size_t dm_stage_weights_size(size_t s, size_t r) {
    return 2 * (r * r + r + 3 * r * s + s + 3 * r);
}

void dm_stage_weights_place(dm_stage *g, double *memory) {
    const size_t s = g->table.s, r = g->table.r;
    g->hA = (dm_weight *)(void *)memory;
    g->hmean = g->hA + r * r;
    g->ha = g->hmean + r;
    g->wq = g->ha + r * s;
    g->wv = g->wq + r * s;
    g->hbeta = g->wv + r * s;
    g->hb = g->hbeta + s;
    g->hc = g->hb + r;
    g->hreach = g->hc + r;
}

static void scale(dm_weight *out, const dm_weight *in, long double factor, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) out[i] = dm_weight_of(factor * dm_weight_exact(in[i]));
}

void dm_stage_weights_scale(dm_stage *g, double h) {
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s, r = t->r;
    g->h = h;
    g->weighed = 0;
    if (g->separable) {
        scale(g->hA, t->A, (long double)h * h, r * r);
        scale(g->hmean, t->mean, (long double)h * h, r);
    } else {
        scale(g->ha, t->a, h, r * s);
    }
    scale(g->hb, t->b, h, r);
    scale(g->hc, t->c, h, r);
}

void dm_stage_weights_complete(dm_stage *g) {
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s, r = t->r;
    const double h = g->h;
    g->weighed = 1;
    scale(g->hreach, t->reach, h, r);
    g->pushes.over = 1.0 / dm_weight_double(*g->hA);
    if (g->separable) return;
    scale(g->hbeta, t->beta, h, s);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < s; j++) {
            const long double b = dm_weight_exact(t->b[i]);
            const long double a = dm_weight_exact(t->a[i * s + j]);
            g->wq[i * s + j] = dm_weight_of(h * b * (a - dm_weight_exact(t->beta[j])));
            g->wv[i * s + j] = dm_weight_of(b * dm_weight_exact(t->d[i * s + j]));
        }
}
