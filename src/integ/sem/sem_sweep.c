/* sem_sweep.c - symplectic-energy-momentum steps of one point of L = |v|^2/2 - V(q), the norm by a
 * constant mass M, by sweeps as midpoint has them: with m = q0 + h v/2,
 *   w = M^-1 (p0 + h/2 L_q(m)),  E_d = |w|^2/2 + V(m) + h/2 L_q . (v - w),
 * where the last term makes what v is off by enter E_d squared. The border is eliminated: along the
 * solutions of the first equation v changes with h by M^-1 (L_q/2 + h/4 L_qq x) and E_d by
 *   dE_d/dh = -h/4 (L_q . M^-1 L_q - M^-1 p0 . L_qq x),  x = M^-1 (p0 + h L_q),
 * up to a part (h omega)^2/4, which is what a sweep contracts by. So dh = (E - E_d)/(dE_d/dh), and
 * v <- w + dv/dh dh. */
#include "integ/sem/sem_sweep.h"
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

static const double ROUND = 4 * DBL_EPSILON; /* of the terms: what is left is round-off */
static const double STILL = DBL_EPSILON;     /* of w: what is left of one sign would be a drift */
static const double SMALL = 9e-28;           /* of the terms, squared: may be so, if it stays */
static const double SLOW = 0.09;             /* squared: sweeps that contract less are left */
enum { SWEEPS = 40, EARLY = 3 };

/* ---- kernels ---- */

int dm_sem_sweep_fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return m->n > DM_SEM_FEW && (m->structure & simple) == simple;
}

/* What kernels are made from may be missing. */
static int can_be_made(const dm_model *m) {
    return dm_sem_sweep_fits(m) && m->has & DM_WANT_POTENTIAL && m->inverse_mass &&
           m->source.graph && m->source.compile && !m->params;
}

/* L_qq x as the gradient of L_q . x, with x in the place of v, which L_q does not know. */
static int build_bend(dm_kernel *out, const dm_model *m) {
    const uint32_t n = m->n;
    dm_node L, along = 0;
    dm_node *roots = dm_arena_take(m->source.arena, n * sizeof *roots);
    dm_graph *g = dm_graph_copy(m->source.graph, &m->source.lagrangian, 1, &L);
    if (!roots || !g || dm_has_roots(g, &L, 1)) return 0;
    dm_gradient(g, L, 0, n, roots);
    for (uint32_t k = 0; k < n; k++)
        along = dm_add(g, along, dm_mul(g, roots[k], dm_input(g, n + k)));
    dm_gradient(g, along, 0, n, roots);
    if (dm_graph_status(g) != DM_OK) return 0;
    return dm_lanes_build(out, m, g, roots, n, 1) == 1;
}

/* From the model where it was made before. */
static int find_bend(dm_kernel *out, const dm_model *m) {
    static const char maker;
    if (dm_cache_find(out, m, &maker, 1)) return out->eval != NULL;
    *out = (dm_kernel){0};
    if (!build_bend(out, m)) *out = (dm_kernel){0};
    dm_cache_add(m, &maker, 1, out, 1);
    return out->eval != NULL;
}

/* Arrays are as long as whole vectors; what is behind their n numbers stays zero. */
static uint32_t whole(uint32_t n) {
    return (n + DM_SEM_WIDTH - 1) / DM_SEM_WIDTH;
}

enum { ARRAYS = 11 };

/* -V stands before the force. */
size_t dm_sem_sweep_size(const dm_model *m) {
    if (!dm_sem_sweep_fits(m)) return 0;
    return ARRAYS * whole(m->n) * DM_SEM_WIDTH + 2 * (size_t)m->n + 1 + DM_SEM_WIDTH + 1;
}

/* The diagonal of M^-1, where that is all of it. */
static void open_mass(dm_sem_sweeps *w) {
    const dm_model *m = w->m;
    w->full = m->structure & DM_DIAGONAL_MASS ? NULL : m->inverse_mass;
    if (!w->full) memcpy(w->inverse, m->inverse_mass, m->n * sizeof(double));
}

void dm_sem_sweep_open(dm_sem_sweeps *w, const dm_model *m, double *memory) {
    const size_t length = (size_t)whole(m->n) * DM_SEM_WIDTH;
    *w = (dm_sem_sweeps){.m = m, .wide = whole(m->n)};
    if (!can_be_made(m) || !find_bend(&w->bend, m)) return;
    dm_sem_wide **const blocks[] = {&w->shifted, &w->v,    &w->w,    &w->R,    &w->pull,
                                    &w->from,    &w->gain, &w->bent, &w->turn, &w->inverse};
    memset(memory, 0, dm_sem_sweep_size(m) * sizeof *memory);
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++, memory += length)
        *blocks[i] = (dm_sem_wide *)(void *)memory;
    w->potential = memory;
    w->force = (dm_sem_wide *)(void *)(memory + 1);
    w->x = memory + 1 + length;
    open_mass(w);
    dm_kernel_prepare(&m->potential, w->potential);
    dm_kernel_prepare(&w->bend, (double *)w->bent);
}

/* ---- a sweep ---- */

/* The entries of a vector, pairwise. */
static inline double total(const dm_sem_wide *x) {
    return ((*x)[0] + (*x)[2]) + ((*x)[1] + (*x)[3]);
}

static double dot(const dm_sem_sweeps *w, const dm_sem_wide *a, const dm_sem_wide *b) {
    dm_sem_wide sum = {0};
    for (uint32_t k = 0; k < w->wide; k++) sum += a[k] * b[k];
    return total(&sum);
}

/* out = M^-1 a */
static void divide_by_mass(const dm_sem_sweeps *w, dm_sem_wide *out, const dm_sem_wide *a) {
    const uint32_t n = w->m->n;
    const double *row = w->full, *of = (const double *)a;
    for (uint32_t k = 0; !row && k < w->wide; k++) out[k] = w->inverse[k] * a[k];
    for (uint32_t i = 0; row && i < n; i++, row += n) {
        double sum = 0.0;
        for (uint32_t j = 0; j < n; j++) sum += row[j] * of[j];
        ((double *)out)[i] = sum;
    }
}

/* What is left of both equations, squared, by sizes that their terms have in the first sweep. */
typedef struct {
    double velocity, energy;
} rest_of_step;

/* Sums over all coordinates. */
typedef struct {
    double twice, gap, rest, square;
} sums;

/* m, of which x are the arguments of the kernels. */
static void place(const dm_sem_sweeps *w) {
    dm_sem_wide *restrict x = (dm_sem_wide *)(void *)w->x;
    const dm_sem_wide *q = w->q, *low = w->low, *v = w->v;
    const double half = 0.5 * w->h;
    for (uint32_t k = 0, wide = w->wide; k < wide; k++) x[k] = q[k] + (low[k] + half * v[k]);
}

/* p0 + h/2 L_q */
static void push(const dm_sem_sweeps *w) {
    dm_sem_wide *restrict pull = w->pull;
    const dm_sem_wide *p = w->p, *force = w->force;
    const double half = 0.5 * w->h;
    for (uint32_t k = 0, wide = w->wide; k < wide; k++) pull[k] = p[k] + half * force[k];
}

/* w, R = v - w and, with f = L_q and P = p0 + h/2 f, P . w, f . R, R . R, w . w; full, a constant
 * where this is called: w is there. */
INLINE sums compare(const dm_sem_sweeps *w, int full) {
    dm_sem_wide *restrict to = w->w, *restrict R = w->R;
    const dm_sem_wide *p = w->p, *force = w->force, *v = w->v, *inverse = w->inverse;
    dm_sem_wide twice = {0}, gap = {0}, rest = {0}, square = {0};
    const double half = 0.5 * w->h;
    for (uint32_t k = 0, wide = w->wide; k < wide; k++) {
        const dm_sem_wide f = force[k], P = p[k] + half * f;
        dm_sem_wide u = to[k];
        if (!full) u = inverse[k] * P;
        const dm_sem_wide left = v[k] - u;
        to[k] = u, R[k] = left;
        twice += P * u, gap += f * left;
        rest += left * left, square += u * u;
    }
    return (sums){total(&twice), total(&gap), total(&rest), total(&square)};
}

/* The same whatever the mass. */
static sums find_velocity(dm_sem_sweeps *w) {
    if (!w->full) return compare(w, 0);
    push(w);
    divide_by_mass(w, w->w, w->pull);
    return compare(w, 1);
}

/* The force at m, w beside v, and E_d. */
static rest_of_step sweep(dm_sem_sweeps *w, int first) {
    place(w);
    dm_kernel_eval(&w->m->potential, w->x, w->potential);
    const sums of = find_velocity(w);
    w->twice = of.twice;
    w->energy = 0.5 * of.twice - *w->potential + 0.5 * w->h * of.gap;
    if (first) {
        const double size = fabs(of.twice) + fabs(of.twice - w->energy);
        w->scale[0] = 1.0 / of.square, w->scale[1] = 1.0 / (size * size);
    }
    const double excess = w->energy - w->E;
    return (rest_of_step){of.rest * w->scale[0], excess * excess * w->scale[1]};
}

/* dv/dh and dE_d/dh, once a step: at its first point they are as near as sweeps contract. */
static void find_turn(dm_sem_sweeps *w) {
    const double quarter = 0.25 * w->h, over = 1.0 / w->h;
    double *x = w->x + w->m->n;
    divide_by_mass(w, w->from, w->p);
    for (uint32_t k = 0; k < w->wide; k++) w->gain[k] = w->w[k] - w->from[k];
    const double *to = (const double *)w->w, *gain = (const double *)w->gain;
    for (uint32_t k = 0; k < w->m->n; k++) x[k] = to[k] + gain[k];
    dm_kernel_eval(&w->bend, w->x, (double *)w->bent);
    divide_by_mass(w, w->turn, w->bent);
    for (uint32_t k = 0; k < w->wide; k++) w->turn[k] = over * w->gain[k] + quarter * w->turn[k];
    const double slope = quarter * dot(w, w->from, w->bent) - 0.5 * dot(w, w->force, w->gain);
    w->inverse_slope = 1.0 / slope, w->bow = 0.5 * over;
}

/* ---- a step ---- */

/* The length that is to have the energy, as if h^2 were the unknown, since E_d - H = C h^2 +
 * O(h^3). */
static double improve(const dm_sem_sweeps *w) {
    const double move = (w->E - w->energy) * w->inverse_slope;
    return w->h + (move - move * move * w->bow);
}

/* Not where it is NaN. */
static int is_round_off(const rest_of_step *of) {
    return of->velocity <= STILL * STILL && of->energy <= ROUND * ROUND;
}

/* The guess becomes w, or, where h moves, what w is there. */
static void go_on(dm_sem_sweeps *w, double by) {
    if (by == 0.0)
        memcpy(w->v, w->w, w->wide * sizeof *w->v);
    else
        for (uint32_t k = 0; k < w->wide; k++) w->v[k] = w->w[k] + w->turn[k] * by;
}

/* Ends where what is left is round-off or no longer shrinks; returns the sweeps, 0: it fails. */
static int iterate(dm_sem_sweeps *w, int moves) {
    double last = INFINITY;
    for (int count = 1; count <= SWEEPS; count++) {
        rest_of_step of = sweep(w, count == 1);
        if (!moves) of.energy = 0.0;
        const double rest = of.velocity > of.energy ? of.velocity : of.energy;
        const int slows = rest > SLOW * last;
        if (!isfinite(of.velocity + of.energy)) return 0;
        if (moves && count == 1) find_turn(w);
        if (is_round_off(&of) || (slows && rest <= SMALL)) return count;
        if (slows && count > EARLY) return 0;
        const double h = moves ? improve(w) : w->h, by = h - w->h;
        if (!(h > 0.0)) return 0;
        go_on(w, by);
        w->h = h, last = rest;
    }
    return 0;
}

/* Where the step begins, and the guess z = (v, h). Behind n numbers of a state there are others,
 * which meet zeros. */
static void begin(dm_sem_sweeps *w, const double *state, const double *z) {
    const size_t n = w->m->n;
    const double *shift = w->m->momentum_shift;
    w->q = (const dm_sem_wide *)(const void *)state;
    w->low = (const dm_sem_wide *)(const void *)(state + 2 * n);
    w->p = (const dm_sem_wide *)(const void *)(state + n);
    if (w->full) {
        double *p = (double *)w->shifted;
        for (size_t k = 0; k < n; k++) p[k] = state[n + k] - shift[k];
        w->p = w->shifted;
    }
    memcpy(w->v, z, n * sizeof *z);
    w->h = z[n];
}

int dm_sem_sweep(dm_sem_sweeps *w, const double *state, const double *z, double *out, int moves) {
    const size_t n = w->m->n;
    double *numbers = out + 3 * n + 1;
    begin(w, state, z);
    const int count = iterate(w, moves);
    memcpy(out, w->w, n * sizeof *out);
    out[n] = w->h;
    memcpy(out + n + 1, w->force, n * sizeof *out);
    memcpy(out + 2 * n + 1, w->R, n * sizeof *out);
    numbers[0] = w->twice, numbers[1] = w->energy;
    /* where any h has the energy, as without a potential, it stays as it was guessed */
    numbers[2] = moves && isfinite(w->inverse_slope) ? w->inverse_slope : 0.0;
    return count;
}
