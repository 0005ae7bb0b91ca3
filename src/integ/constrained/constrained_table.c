/* constrained_table.c - coefficients of the curve at the constraint points and at the Gauss points
 * between them. */
#include "integ/constrained/constrained_inside.h"

enum { MOST = DM_QUADRATURE_NODES + 1, SMOOTH = 8 };

/* s constraint intervals for a curve of degree s; where velocities and quadrature share nodes with
 * both ends the curve has a degree more than the quadrature can tell apart, and its nodes are the
 * constraint points (Jay 1996) */
uint32_t dm_constrained_count(size_t s, size_t r, const dm_galerkin *g) {
    const int both_ends = g->q.c[0] == 0.0L && g->q.c[r - 1] == 1.0L;
    const size_t K = s == r && both_ends ? s - 1 : s;
    return (uint32_t)(K < DM_QUADRATURE_NODES ? K : DM_QUADRATURE_NODES - 1);
}

/* Weights: c, a and d. */
static size_t points_size(size_t count, size_t s) {
    return count + 2 * count * s;
}

size_t dm_constrained_weights_size(size_t s, size_t r) {
    const size_t pairs =
        points_size(s + 1, s) + points_size(s, s) + r + s + 3 * r * s + (s + 1) * s + 2 * s * s;
    return 2 * pairs + 2 * s * (s + 1) + s * (r + s + 1);
}

/* The next block of weights. */
static dm_weight *take(dm_weight **memory, size_t count) {
    dm_weight *block = *memory;
    *memory += count;
    return block;
}

/* The curve of the basis at the nodes of `at`. */
static void points_fill(dm_constrained_points *p, const dm_quadrature *at, const dm_galerkin *basis,
                        dm_weight **memory) {
    const int s = basis->s;
    long double d[MOST], a[MOST];
    p->count = (uint32_t)at->r;
    p->c = take(memory, (size_t)at->r);
    p->a = take(memory, (size_t)at->r * (size_t)s);
    p->d = take(memory, (size_t)at->r * (size_t)s);
    for (int k = 0; k < at->r; k++) {
        dm_lagrange(d, a, basis->node, s, at->c[k]);
        p->c[k] = dm_weight_of(at->c[k]);
        for (int j = 0; j < s; j++) {
            p->a[k * s + j] = dm_weight_of(a[j]);
            p->d[k * s + j] = dm_weight_of(d[j]);
        }
    }
}

/* row[s+1]: weights of the velocities at the nodes and, behind them, of one more at `extra`,
 * that take the polynomial through all of them to x; the one more is left out where a node is
 * there */
static void extrapolate(double *row, const dm_galerkin *basis, long double extra, long double x) {
    const int s = basis->s;
    long double node[MOST] = {0}, value[MOST];
    int count = s;
    for (int j = 0; j < s; j++) node[j] = basis->node[j];
    if (node[0] != extra && node[s - 1] != extra) node[count++] = extra;
    dm_lagrange_value(value, node, count, x);
    for (int j = 0; j <= s; j++) row[j] = j < count ? (double)value[j] : 0.0;
}

/* steep polynomials of many nodes would lead away: there the last velocity is the guess */
static void guesses_fill(dm_constrained *g, const dm_galerkin *basis) {
    const int s = basis->s;
    for (int j = 0; j < s; j++) {
        double *ahead = g->ahead + j * (s + 1), *longer = g->longer + j * (s + 1);
        extrapolate(ahead, basis, 1.0L, 1.0L + basis->node[j]);
        extrapolate(longer, basis, 0.0L, 2.0L * basis->node[j]);
        for (int m = 0; m <= s && s > SMOOTH; m++) ahead[m] = longer[m] = m == s;
    }
}

/* integrals of polynomials through the quadrature points, and through the constraint points, up to
 * the inner ones */
static void inner_fill(dm_constrained *g, const dm_galerkin *basis,
                       const dm_quadrature *constraints) {
    long double value[MOST], integral[MOST];
    const int r = basis->q.r;
    for (int k = 1; k < constraints->r - 1; k++) {
        dm_lagrange(value, integral, basis->q.c, r, constraints->c[k]);
        for (int i = 0; i < r; i++) g->inner_force[(k - 1) * r + i] = (double)integral[i];
        dm_lagrange(value, integral, constraints->c, constraints->r, constraints->c[k]);
        for (int i = 0; i < constraints->r; i++)
            g->inner_impulse[(k - 1) * constraints->r + i] =
                (double)(integral[i] / constraints->b[i]);
    }
}

/* What does not depend on h, once; the places of what does are laid out too. */
void dm_constrained_weights_fill(dm_constrained *g, const dm_galerkin *basis, double *memory) {
    const uint32_t s = g->table.s, r = g->table.r;
    dm_weight *at = (dm_weight *)(void *)memory;
    dm_quadrature lobatto, gauss;
    dm_quadrature_lobatto(&lobatto, (int)g->K + 1);
    dm_quadrature_gauss(&gauss, (int)g->K);
    points_fill(&g->constraint, &lobatto, basis, &at);
    points_fill(&g->gauss, &gauss, basis, &at);
    g->hb = take(&at, r);
    g->hbeta = take(&at, s);
    g->ha = take(&at, r * s);
    g->wq = take(&at, r * s);
    g->wv = take(&at, r * s);
    g->constraint_ha = take(&at, (g->K + 1) * s);
    g->gauss_ha = take(&at, g->K * s);
    g->lever = take(&at, g->K * s);
    g->ahead = (double *)(void *)at;
    g->longer = g->ahead + s * (s + 1);
    g->inner_force = g->longer + s * (s + 1);
    g->inner_impulse = g->inner_force + s * r;
    guesses_fill(g, basis);
    inner_fill(g, basis, &lobatto);
    for (uint32_t k = 0; k < g->K; k++)
        for (uint32_t j = 0; j < s; j++)
            g->lever[k * s + j] = dm_weight_of(dm_weight_exact(g->constraint.a[k * s + j]) -
                                               dm_weight_exact(g->table.beta[j]));
}

/* Products with h are made in long double and kept as two doubles: h a is as good as a. */
static void scale(dm_weight *out, const dm_weight *in, double h, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        out[i] = dm_weight_of((long double)h * dm_weight_exact(in[i]));
}

/* Everything that h is a factor of; wv is not, and stands beside wq for the sums that need both. */
void dm_constrained_weights_scale(dm_constrained *g, double h) {
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s, r = t->r;
    g->h = h;
    scale(g->hb, t->b, h, r);
    scale(g->hbeta, t->beta, h, s);
    scale(g->ha, t->a, h, r * s);
    scale(g->constraint_ha, g->constraint.a, h, (g->K + 1) * s);
    scale(g->gauss_ha, g->gauss.a, h, g->K * s);
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < s; j++) {
            const long double b = dm_weight_exact(t->b[i]);
            const long double a = dm_weight_exact(t->a[i * s + j]);
            g->wq[i * s + j] = dm_weight_of(h * b * (a - dm_weight_exact(t->beta[j])));
            g->wv[i * s + j] = dm_weight_of(b * dm_weight_exact(t->d[i * s + j]));
        }
}
