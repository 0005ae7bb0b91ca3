/* stage_weights.c - coefficients of a stage method multiplied by powers of the step. */
#include "integ/stage/workspace/workspace.h"

#include <math.h>

size_t dm_stage_weights_size(size_t s, size_t r) {
    return 2 * (r * r + r + 3 * r * s + s + 3 * r + 1);
}

/* behind each other in the order of the struct, hA first: dm_stage_group.one counts from there */
void dm_stage_weights_place(dm_stage_weights *w, const dm_stage_table *t, double *memory) {
    const size_t s = t->s, r = t->r;
    w->hA = (dm_weight *)(void *)memory;
    w->hmean = w->hA + r * r;
    w->ha = w->hmean + r;
    w->wq = w->ha + r * s;
    w->wv = w->wq + r * s;
    w->hbeta = w->wv + r * s;
    w->hb = w->hbeta + s;
    w->hc = w->hb + r;
    w->reach = w->hc + r;
    w->flight = w->reach + r;
}

/* in long double: the two parts of a weight are exact to more than a double */
static void scale(dm_weight *out, const dm_weight *in, long double factor, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) out[i] = dm_weight_of(factor * dm_weight_exact(in[i]));
}

/* what every step reads; a step that Newton's method takes has the rest made, too */
void dm_stage_weights_scale(dm_stage *g, double h) {
    dm_stage_weights *w = &g->weights;
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s, r = t->r;
    w->h = h;
    w->complete = 0;
    if (g->separable) {
        scale(w->hA, t->A, (long double)h * h, r * r);
        scale(w->hmean, t->mean, (long double)h * h, r);
        *w->flight = dm_weight_of(h);
    } else {
        scale(w->ha, t->a, h, r * s);
    }
    scale(w->hb, t->b, h, r);
    scale(w->hc, t->c, h, r);
}

void dm_stage_weights_complete(dm_stage *g) {
    dm_stage_weights *w = &g->weights;
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s, r = t->r;
    w->complete = 1;
    scale(w->reach, t->reach, w->h, r);
    if (g->separable) return;
    scale(w->hbeta, t->beta, w->h, s);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < s; j++) {
            const long double b = dm_weight_exact(t->b[i]);
            const long double a = dm_weight_exact(t->a[i * s + j]);
            w->wq[i * s + j] = dm_weight_of(w->h * b * (a - dm_weight_exact(t->beta[j])));
            w->wv[i * s + j] = dm_weight_of(b * dm_weight_exact(t->d[i * s + j]));
        }
}

double dm_stage_heaviest(const dm_model *m) {
    const size_t n = m->n, count = m->structure & DM_DIAGONAL_MASS ? n : n * n;
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(m->mass_matrix[i]));
    return largest;
}
