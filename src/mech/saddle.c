#include "mech/saddle.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "base/random.h"
#include "code/tape/tape.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

/* least pivot over the largest one, of a matrix whose rows are of size 1: less is singular */
static const double LEAST = 1e-10;
enum { TRIES = 12, ENOUGH = 4 };
static const double scales[] = {1.0, 0.1, 10.0};
enum { SCALES = sizeof scales / sizeof *scales };

/* ---- the question, at numbers ---- */

/* everything that one point needs */
typedef struct {
    dm_constraints t; /* its kernels on the tape */
    dm_kernel mass;   /* M[n*n] */
    uint32_t n, m;    /* coordinates, constraints */
    double *x;        /* q[n], v[n], t, and the multipliers, which are 0 */
    double *W, *work; /* [n*n] the unit matrix, scratch of projections */
    double *M, *out;  /* [n*n]; outputs of the kernels of the constraints */
    double *K, *unit; /* [(n+m)^2], [n+m] */
    uint32_t *pivot;  /* [n+m] */
} probe;

/* the constraints as they were traced in a graph of their own: no kernel of the model's is made
 * here */
static dm_status copy_constraints(probe *p, const dm_constraints *t, dm_arena *arena) {
    const size_t k = t->holonomic, l = t->rolling, n = t->n;
    dm_node *roots = dm_arena_take(arena, (k + l + l * n + 1) * sizeof *roots);
    if (!roots) return DM_NO_MEMORY;
    if (k) memcpy(roots, t->g, k * sizeof *roots);
    if (l) memcpy(roots + k, t->phi, l * sizeof *roots);
    if (l) memcpy(roots + k + l, t->E, l * n * sizeof *roots);
    dm_constraints_traced traced = {.n = t->n, .holonomic = t->holonomic, .rolling = t->rolling};
    dm_node *copied = dm_arena_take(arena, (k + l + l * n + 1) * sizeof *copied);
    if (!copied) return DM_NO_MEMORY;
    traced.graph = dm_graph_new(arena, dm_graph_inputs(t->graph));
    dm_node *with = dm_arena_take(arena, dm_graph_inputs(t->graph) * sizeof *with);
    if (!traced.graph || !with) return DM_NO_MEMORY;
    dm_inputs(traced.graph, with, 0, dm_graph_inputs(t->graph));
    dm_transplant(traced.graph, t->graph, roots, (uint32_t)(k + l + l * n), with, copied);
    traced.g = copied;
    traced.phi = copied + k;
    if (l && t->structure & DM_CONSTRAINTS_GIVEN_REACTIONS) traced.E = copied + k + l;
    const dm_status status = dm_constraints_build(&p->t, &traced, arena);
    if (status != DM_OK) return status;
    return dm_constraints_want(&p->t, DM_WANT_HOLONOMIC | DM_WANT_ROLLING, dm_tape_build_exact);
}

/* M of a copy of L */
static dm_status make_mass(probe *p, dm_graph *g, dm_node L, dm_arena *arena) {
    const size_t n = p->n, inputs = dm_graph_inputs(g);
    dm_graph *own = dm_graph_new(arena, dm_graph_inputs(g));
    dm_node *nodes = dm_arena_take(arena, (inputs + n + n * n) * sizeof *nodes);
    if (!own || !nodes) return DM_NO_MEMORY;
    dm_node *slope = nodes + inputs, *mass = slope + n, root;
    dm_inputs(own, nodes, 0, dm_graph_inputs(g));
    dm_transplant(own, g, &L, 1, nodes, &root);
    dm_gradient(own, root, p->n, p->n, slope);
    dm_jacobian(own, slope, p->n, p->n, p->n, mass);
    if (dm_graph_status(own) != DM_OK) return dm_graph_status(own);
    return dm_tape_build_exact(&p->mass, own, mass, (uint32_t)(n * n), arena);
}

static dm_status take_memory(probe *p, dm_arena *arena) {
    const size_t n = p->n, N = n + p->m;
    const size_t out = p->t.holonomic * (n + 2) + p->t.rolling * (3 * n + 1);
    const size_t x = 2 * n + 1 + p->m, work = dm_constraints_start_work(&p->t);
    double *at = dm_arena_take(arena, (x + 2 * n * n + work + out + N * N + N) * sizeof *at);
    p->pivot = dm_arena_take(arena, N * sizeof *p->pivot);
    if (!at || !p->pivot) return DM_NO_MEMORY;
    p->x = at;
    p->W = p->x + x;
    p->M = p->W + n * n;
    p->work = p->M + n * n;
    p->out = p->work + work;
    p->K = p->out + out;
    p->unit = p->K + N * N;
    memset(p->x, 0, x * sizeof *p->x);
    memset(p->W, 0, n * n * sizeof *p->W);
    for (size_t i = 0; i < n; i++) p->W[i * (n + 1)] = 1.0;
    return DM_OK;
}

/* by the pivots of K, which is lost */
static int is_regular(double *K, double *unit, uint32_t *pivot, uint32_t N) {
    double least = INFINITY, most = 0.0;
    if (!dm_equilibrate(K, unit, N) || dm_lu_factor(K, pivot, N) != DM_OK) return 0;
    for (uint32_t i = 0; i < N; i++) { /* the diagonal holds reciprocals */
        least = fmin(least, 1.0 / fabs(K[i * ((size_t)N + 1)]));
        most = fmax(most, 1.0 / fabs(K[i * ((size_t)N + 1)]));
    }
    return least > LEAST * most;
}

static int all_finite(const double *a, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(a[i])) return 0;
    return 1;
}

/* row c of A and of the reactions at x, from the outputs of the kernels */
static void rows_of(const probe *p, uint32_t c, const double **along, const double **across) {
    const size_t n = p->n, k = p->t.holonomic, l = p->t.rolling;
    const double *G = p->out + k, *E = p->out + k * (n + 2) + l;
    *along = *across = G + c * n;
    if (c < k) return;
    *across = E + (c - k) * n;
    *along = E + l * n + (c - k) * n;
}

/* K = (M, E^T; A, 0) at x; 0: something there has no value */
static int fill_saddle(probe *p) {
    const size_t n = p->n, N = n + p->m, k = p->t.holonomic, l = p->t.rolling;
    double *rolling = p->out + k * (n + 2);
    if (k) dm_kernel_prepare(&p->t.holonomic_kernel, p->out);
    if (k) dm_kernel_eval(&p->t.holonomic_kernel, p->x, p->out);
    if (l) dm_kernel_prepare(&p->t.rolling_kernel, rolling);
    if (l) dm_kernel_eval(&p->t.rolling_kernel, p->x, rolling);
    if (!all_finite(p->out, k * (n + 2) + l * (3 * n + 1))) return 0;
    memset(p->K, 0, N * N * sizeof *p->K);
    for (size_t i = 0; i < n; i++) memcpy(p->K + i * N, p->M + i * n, n * sizeof *p->M);
    for (uint32_t c = 0; c < p->m; c++) {
        const double *along, *across;
        rows_of(p, c, &along, &across);
        for (size_t i = 0; i < n; i++) {
            p->K[(n + c) * N + i] = along[i];
            p->K[i * N + n + c] = across[i];
        }
    }
    return 1;
}

/* a point of the constraints near a random one; 0: none was found */
static int find_point(probe *p, uint64_t number) {
    const uint32_t n = p->n;
    const double scale = scales[number % SCALES];
    for (uint32_t i = 0; i <= 2 * n; i++)
        p->x[i] = scale * (2.0 * dm_random_uniform(0, number, i) - 1.0);
    return dm_constraints_project_position(&p->t, p->x, p->W, p->work) == DM_OK &&
           dm_constraints_project_velocity(&p->t, p->x, p->W, p->work) == DM_OK;
}

/* M over its largest entry: masses have any unit */
static void normalize_mass(probe *p) {
    const size_t count = (size_t)p->n * p->n;
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(p->M[i]));
    for (size_t i = 0; i < count && largest > 0.0; i++) p->M[i] /= largest;
}

/* at x: -1 nothing is known, 0 M is regular or nothing helps, 1 the constraints help */
static int look(probe *p) {
    const size_t n = p->n;
    dm_kernel_prepare(&p->mass, p->M);
    dm_kernel_eval(&p->mass, p->x, p->M);
    if (!all_finite(p->M, n * n)) return -1;
    normalize_mass(p);
    memcpy(p->K, p->M, n * n * sizeof *p->M);
    if (is_regular(p->K, p->unit, p->pivot, p->n)) return 0;
    return fill_saddle(p) ? is_regular(p->K, p->unit, p->pivot, p->n + p->m) : -1;
}

dm_status dm_saddle_needed(int *needed, dm_graph *g, dm_node L, const dm_constraints *t,
                           dm_arena *scratch) {
    probe p = {.n = t->n, .m = t->holonomic + t->rolling};
    int found = 0;
    *needed = 0;
    dm_status status = copy_constraints(&p, t, scratch);
    if (status == DM_OK) status = make_mass(&p, g, L, scratch);
    if (status == DM_OK) status = take_memory(&p, scratch);
    for (uint64_t i = 0; status == DM_OK && i < TRIES && found < ENOUGH; i++) {
        const int answer = find_point(&p, i) ? look(&p) : -1;
        if (answer == 0) return DM_OK;
        found += answer > 0;
    }
    *needed = found > 0;
    return status;
}

/* ---- the Lagrangian ---- */

/* sum of squares of nodes[count] */
static dm_node square(dm_graph *g, const dm_node *nodes, size_t count) {
    dm_node sum = 0;
    for (size_t i = 0; i < count; i++)
        if (nodes[i]) sum = dm_add(g, sum, dm_mul(g, nodes[i], nodes[i]));
    return sum;
}

/* |M| = sqrt(sum M_ij^2) */
static dm_node size_of_mass(dm_graph *g, dm_node L, uint32_t n, dm_node *nodes) {
    dm_node *mass = nodes + n;
    dm_gradient(g, L, n, n, nodes);
    dm_jacobian(g, nodes, n, n, n, mass);
    return dm_apply(g, DM_OP_SQRT, square(g, mass, (size_t)n * n), 0, 0);
}

/* w_c^2 / |A_c|^2, w_c = A_c v + rest for a holonomic constraint, phi for a rolling one */
static dm_node share(dm_graph *g, dm_node w, const dm_node *row, uint32_t n, int holonomic) {
    for (uint32_t i = 0; holonomic && i < n; i++)
        w = dm_add(g, w, dm_mul(g, row[i], dm_input(g, n + i)));
    return dm_div(g, dm_mul(g, w, w), square(g, row, n));
}

dm_status dm_saddle_lagrangian(dm_node *out, dm_graph *g, dm_node L, const dm_constraints *t,
                               dm_arena *scratch) {
    const uint32_t n = t->n, k = t->holonomic, l = t->rolling, inputs = dm_graph_inputs(t->graph);
    const size_t N = n, room = N + N * N > k * (N + 2) + l * (N + 1) ? N + N * N
                                                                     : k * (N + 2) + l * (N + 1);
    dm_node *with = dm_arena_take(scratch, (inputs + room + 1) * sizeof *with), sum = 0;
    if (!with) return DM_NO_MEMORY;
    dm_node *nodes = with + inputs;
    const dm_node size = size_of_mass(g, L, n, nodes);
    memset(with, 0, inputs * sizeof *with);
    dm_inputs(g, with, 0, 2 * n + 1);
    dm_node *G = nodes, *g_t = G + k * N, *phi = g_t + k, *phi_v = phi + l;
    if (k) dm_transplant(g, t->graph, t->G, k * n, with, G);
    if (k) dm_transplant(g, t->graph, t->g_t, k, with, g_t);
    if (l) dm_transplant(g, t->graph, t->phi, l, with, phi);
    if (l) dm_transplant(g, t->graph, t->phi_v, l * n, with, phi_v);
    for (uint32_t c = 0; c < k; c++) sum = dm_add(g, sum, share(g, g_t[c], G + c * N, n, 1));
    for (uint32_t c = 0; c < l; c++) sum = dm_add(g, sum, share(g, phi[c], phi_v + c * N, n, 0));
    const dm_node half = dm_mul(g, dm_constant(g, 0.5), size);
    *out = dm_add(g, L, dm_mul(g, half, sum));
    return dm_graph_status(g);
}
