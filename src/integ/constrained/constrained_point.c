/* constrained_point.c - kernels of L and of its constraints at points of the curve. */
#include "integ/constrained/constrained_inside.h"

#include "base/largest.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* The low-order parts of q are added to the shift first: q0 + (low + shift) loses nothing of them.
 */
void dm_constrained_at(dm_constrained *g, const double *shift, const double *v, double after) {
    const uint32_t n = g->n;
    const double *q = g->state, *low = q + 2 * (size_t)n;
    double *x = g->x;
    if (shift)
        for (uint32_t i = 0; i < n; i++) x[i] = q[i] + (low[i] + shift[i]);
    else
        for (uint32_t i = 0; i < n; i++) x[i] = q[i] + 0.0;
    dm_small_copy(x + n, v, n);
    x[2 * n] = g->t + after;
}

/* x at a point with the rows ha[s] and d[s] */
static void place(dm_constrained *g, const dm_weight *ha, const dm_weight *d, double after,
                  const double *V) {
    const uint32_t n = g->n;
    dm_small_zero(g->shift, n);
    dm_small_zero(g->v, n);
    for (uint32_t j = 0; j < g->table.s; j++) {
        const double *Vj = V + j * (size_t)n;
        dm_weighted_add(g->shift, ha[j], Vj, n);
        if (d[j].top != 0.0) dm_weighted_add(g->v, d[j], Vj, n);
    }
    dm_constrained_at(g, g->shift, g->v, after);
}

/* The velocity of the curve there stays in g->v. */
void dm_constrained_at_constraint(dm_constrained *g, const double *V, uint32_t k) {
    const uint32_t s = g->table.s;
    place(g, g->constraint_ha + k * s, g->constraint.d + k * s,
          g->h * dm_weight_double(g->constraint.c[k]), V);
}

/* L_q += f, and its curves where they are wanted */
static void add_force(dm_constrained *g, double *slope, double *drag, int with_curve) {
    if (!g->constraints->forced) return;
    dm_kernel_eval(with_curve ? &g->constraints->force_curve : &g->constraints->force, g->x, drag);
    for (uint32_t k = 0; k < g->n; k++) slope[k] += drag[k];
}

/* With derivatives by the stage kernel, without by the cheaper slope kernel; the slopes lie in
 * g->slope either way, the derivatives behind theirs in g->curve and g->drag. */
void dm_constrained_slopes(dm_constrained *g, const double *V, int with_curve) {
    const size_t n = g->n, s = g->table.s, width = 2 * n + 3 * n * n;
    for (uint32_t i = 0; i < g->table.r; i++) {
        double *slope = g->slope + i * 2 * n, *curve = g->curve + i * width;
        double *out = with_curve ? curve : g->plain + i * 2 * n;
        place(g, g->ha + i * s, g->table.d + i * s, g->h * dm_weight_double(g->table.c[i]), V);
        dm_kernel_eval(with_curve ? &g->m->stage : &g->m->slope, g->x, out);
        dm_small_copy(slope, out, n);
        dm_small_copy(slope + n, out + n, n);
        add_force(g, slope, g->drag + i * (n + 2 * n * n), with_curve);
    }
    g->evaluations += g->table.r;
}

/* multipliers of the constraint point k as the reactions take them */
static void unscale(dm_constrained *g, const double *impulses) {
    const uint32_t m = g->k + g->l;
    for (uint32_t c = 0; c < m; c++) g->lambda[c] = impulses[c] * g->impulse_unit[c];
}

/* impulse += rows^T lambda, over the entries that can differ from zero. */
static void add_rows(double *impulse, const double *rows, const double *lambda,
                     const dm_constrained_entries *e) {
    for (uint32_t i = 0; i < e->count; i++)
        impulse[e->column[i]] += lambda[e->row[i]] * rows[e->entry[i]];
}

/* I = G^T lambda + E^T mu from the rows at the constraint point k */
void dm_constrained_impulse(dm_constrained *g, double *impulse, const double *impulses,
                            uint32_t k) {
    unscale(g, impulses);
    dm_small_zero(impulse, g->n);
    add_rows(impulse, dm_constrained_holonomic(g, k) + g->k, g->lambda, &g->G);
    add_rows(impulse, dm_constrained_rolling(g, k) + g->l, g->lambda + g->k, &g->E);
}

/* derivatives of the impulse in q and v at x, behind it in `reaction` */
void dm_constrained_reaction(dm_constrained *g, const double *impulses, uint32_t k) {
    unscale(g, impulses);
    memcpy(g->x + 2 * g->n + 1, g->lambda, (g->k + g->l) * sizeof *g->lambda);
    dm_kernel_eval(&g->constraints->reaction, g->x, dm_constrained_curved(g, k));
}

/* g, G and g_t at x, for the constraint point k. */
static void eval_holonomic(dm_constrained *g, uint32_t k) {
    if (g->k)
        dm_kernel_eval(&g->constraints->holonomic_kernel, g->x, dm_constrained_holonomic(g, k));
}

/* phi, E, phi_v and phi_q at x. */
static void eval_rolling(dm_constrained *g, double *out) {
    if (g->l) dm_kernel_eval(&g->constraints->rolling_kernel, g->x, out);
}

/* Both at the place of the constraint point k, where they stay until the next look at it. */
void dm_constrained_rows(dm_constrained *g, uint32_t k) {
    eval_holonomic(g, k);
    eval_rolling(g, dm_constrained_rolling(g, k));
}

/* impulses between the ends: their rows move with the curve */
static void inner_constraint(dm_constrained *g, const double *impulses, uint32_t k,
                             int with_curve) {
    if (dm_constrained_turns(g))
        memcpy(g->x + g->n, g->inner_v + (k - 1) * (size_t)g->n, g->n * sizeof *g->x);
    if (g->k || g->l) dm_constrained_rows(g, k);
    dm_constrained_impulse(g, g->impulse + k * (size_t)g->n, impulses, k);
    if (with_curve) dm_constrained_reaction(g, impulses, k);
}

/* The impulse of the start has rows that are fixed for the step; those of the points between move
 * with the curve; at the end only g is wanted, since the rows there belong to the hidden
 * constraint. */
void dm_constrained_constraints(dm_constrained *g, const double *V, int with_curve) {
    const size_t n = g->n, s = g->table.s, m = g->k + g->l;
    const double *impulses = V + s * n;
    if (m == 0) return;
    dm_constrained_impulse(g, g->impulse, impulses, 0);
    for (uint32_t k = 1; k <= g->K; k++) {
        if (k == g->K && !g->k) break; /* rolling ends there with the momentum */
        dm_constrained_at_constraint(g, V, k);
        if (k < g->K)
            inner_constraint(g, impulses + k * m, k, with_curve);
        else
            eval_holonomic(g, k);
    }
    for (uint32_t k = 0; k < g->K && g->l; k++) {
        place(g, g->gauss_ha + k * s, g->gauss.d + k * s, g->h * dm_weight_double(g->gauss.c[k]),
              V);
        eval_rolling(g, g->roll + k * g->l * (1 + 3 * n));
    }
}

/* NaN when there is one */
static double largest(const double *a, size_t count) {
    double most = 0.0;
    for (size_t i = 0; i < count; i++) most = dm_largest(most, a[i]);
    return most;
}

/* units of the rows make equations and multipliers comparable with momenta and velocities */
static dm_status find_units(dm_constrained *g) {
    const uint32_t n = g->n;
    const double *G = dm_constrained_holonomic(g, 0) + g->k;
    const double *E = dm_constrained_rolling(g, 0) + g->l, *phi_v = E + g->l * n;
    for (uint32_t c = 0; c < g->k + g->l; c++) {
        const uint32_t j = c < g->k ? c : c - g->k;
        const double row = largest((c < g->k ? G : phi_v) + j * n, n);
        const double across = c < g->k ? row : largest(E + j * n, n);
        if (!isfinite(row + across)) return DM_NOT_FINITE;
        if (row == 0.0 || across == 0.0) {
            g->lost = c + 1;
            return DM_SINGULAR;
        }
        g->row_unit[c] = g->mass_size / row;
        g->impulse_unit[c] = g->mass_size / across;
    }
    return DM_OK;
}

/* v0 from the memory, or from p0 */
static dm_status find_velocity(dm_constrained *g) {
    const uint32_t n = g->n;
    if (g->k + g->l && g->goes_on) {
        dm_small_copy(g->v0, dm_constrained_memory_velocity(g), n);
        return DM_OK;
    }
    memset(g->v0, 0, n * sizeof *g->v0);
    return dm_legendre_inverse(g->m, g->v0, g->state, g->state + n, g->t, g->scratch);
}

/* The largest entry of L_vv, which turns velocities into momenta; once where the mass is constant.
 */
static dm_status find_mass_size(dm_constrained *g) {
    const size_t n = g->n;
    if (!(g->m->structure & DM_CONSTANT_MASS) || g->mass_size == 0.0) {
        dm_kernel_eval(&g->m->mass, g->x, g->mass);
        g->mass_size = largest(g->mass + n, n * n);
    }
    if (!isfinite(g->mass_size)) return DM_NOT_FINITE;
    return g->mass_size > 0.0 ? DM_OK : DM_SINGULAR;
}

/* controls are held: behind the multipliers in x they stay for the whole step */
static dm_status hold_controls(dm_constrained *g) {
    const dm_constraints *constraints = g->constraints;
    double *u = g->x + 2 * g->n + 1 + g->k + g->l;
    if (!constraints->controls) return DM_OK;
    dm_kernel_prepare(&constraints->control, u);
    dm_kernel_eval(&constraints->control, g->x, u);
    return isfinite(largest(u, constraints->controls)) ? DM_OK : DM_NOT_FINITE;
}

/* What holds for the whole step: v0, controls, the unit of mass, the rows at the start and their
 * units. */
dm_status dm_constrained_begin(dm_constrained *g) {
    g->goes_on = dm_constrained_memory_fits(g);
    dm_status status = find_velocity(g);
    if (status != DM_OK) return status;
    dm_constrained_at(g, NULL, g->v0, 0.0);
    status = hold_controls(g);
    if (status == DM_OK) status = find_mass_size(g);
    dm_constrained_rows(g, 0);
    return status == DM_OK ? find_units(g) : status;
}
