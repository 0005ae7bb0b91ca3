/* level.c - points of a level set and its angle with orbits. */
#include "level/level.h"

#include "algebra/derive.h"
#include "code/tape/tape.h"
#include "level/switches.h"
#include "linalg/inverse.h"
#include "linalg/lu.h"

#include <math.h>
#include <string.h>

enum { CORRECTIONS = 3 };
static const double MOST = 0.3, /* of a step: a correction that is larger is refused, */
    LAST = 0.02,                /* the last one is smaller */
    ALONG = 1e-3;               /* of a unit vector, what has a direction along the set */

/* ---- making one ---- */

/* psi[n r] = the slope of moved by y at y = 0, in the graph g of x */
static int orbit_slopes(dm_graph *g, const dm_level_function *moved, dm_node *psi,
                        dm_arena *arena) {
    const uint32_t n = moved->outputs, r = moved->inputs - n;
    dm_node *slopes = dm_arena_take(arena, (size_t)n * r * sizeof *slopes);
    dm_node *with = dm_arena_take(arena, moved->inputs * sizeof *with);
    if (!slopes || !with) return 0;
    dm_jacobian(moved->graph, moved->value, n, 0, r, slopes);
    for (uint32_t i = 0; i < r; i++) with[i] = dm_constant(g, 0.0);
    for (uint32_t i = 0; i < n; i++) with[r + i] = dm_input(g, i);
    dm_transplant(g, moved->graph, slopes, n * r, with, psi);
    return 1;
}

/* nodes of the graph g for all outputs of the kernel: F, slopes of F and switches, psi, switches */
static dm_node *all_nodes(dm_level *l, dm_graph *g, const dm_level_function *F,
                          const dm_level_function *moved, const dm_level_function *inside,
                          dm_arena *arena) {
    const size_t n = l->n, c = l->c, r = l->r, most = c + DM_SWITCHES;
    dm_node *value = dm_arena_take(arena, (most + most * n + n * r + most) * sizeof *value);
    dm_node *with = dm_arena_take(arena, n * sizeof *with);
    if (!value || !with) return NULL;
    for (uint32_t i = 0; i < n; i++) with[i] = dm_input(g, i);
    dm_transplant(g, F->graph, F->value, l->c, with, value);
    dm_node of[DM_SWITCHES];
    l->s = dm_switches_find(g, of, l->kind);
    if (inside && l->s && l->s + inside->outputs <= DM_SWITCHES) {
        dm_transplant(g, inside->graph, inside->value, inside->outputs, with, of + l->s);
        for (uint32_t i = 0; i < inside->outputs; i++) l->kind[l->s++] = DM_EDGES;
    }
    dm_node *slope = value + c, *psi = slope + (c + l->s) * n;
    dm_jacobian(g, value, l->c, 0, l->n, slope);
    if (l->s) dm_jacobian(g, of, l->s, 0, l->n, slope + c * n);
    if (!orbit_slopes(g, moved, psi, arena)) return NULL;
    memcpy(psi + n * r, of, l->s * sizeof *of);
    return value;
}

static int take_memory(dm_level *l, dm_arena *arena) {
    const size_t n = l->n, c = l->c, r = l->r, all = c + l->s;
    const size_t out = l->kernel.outputs,
                 total = out + all * n + all + all * all + 2 * r * r + 2 * n;
    double *block = dm_arena_take(arena, total * sizeof *block);
    l->pivot = dm_arena_take(arena, (all + r) * sizeof *l->pivot);
    if (!block || !l->pivot) return 0;
    memset(block, 0, total * sizeof *block);
    l->value = block, l->slope = block + c, l->psi = l->slope + all * n, l->u = l->psi + n * r;
    l->rows = block + out, l->y = l->rows + all * n, l->gram = l->y + all;
    l->A = l->gram + all * all, l->turns = l->A + r * r;
    l->change = l->turns + r * r, l->best = l->change + n;
    return 1;
}

dm_status dm_level_build(dm_level *out, const dm_level_function *F, const dm_level_function *moved,
                         const dm_level_function *inside, dm_arena *arena) {
    dm_level l = {.n = F->inputs, .c = F->outputs, .r = moved->inputs - F->inputs};
    dm_graph *g = dm_graph_new(arena, l.n);
    dm_node *nodes = g ? all_nodes(&l, g, F, moved, inside, arena) : NULL;
    if (!nodes) return DM_NO_MEMORY;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    const uint32_t outputs = l.c + (l.c + l.s) * l.n + l.n * l.r + l.s;
    const dm_status status = dm_tape_build(&l.kernel, g, nodes, outputs, arena);
    if (status != DM_OK) return status;
    if (!take_memory(&l, arena)) return DM_NO_MEMORY;
    dm_kernel_prepare(&l.kernel, l.value);
    *out = l;
    return DM_OK;
}

/* ---- points ---- */

int dm_level_look(dm_level *l, const double *x) {
    l->has_gram = 0;
    dm_kernel_eval(&l->kernel, x, l->value);
    const uint32_t needed = l->c + l->c * l->n;
    for (uint32_t i = 0; i < needed; i++)
        if (!isfinite(l->value[i])) return 0;
    return 1;
}

/* out[rows rows] = A A^T of the first rows, `n` long */
static void square(double *out, const double *A, uint32_t rows, uint32_t n) {
    memset(out, 0, (size_t)rows * rows * sizeof *out);
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t k = 0; k < n; k++) {
            const double a = A[i * n + k];
            if (a == 0.0) continue;
            for (uint32_t j = 0; j <= i; j++) out[i * rows + j] += a * A[j * n + k];
        }
        for (uint32_t j = 0; j < i; j++) out[j * rows + i] = out[i * rows + j];
    }
}

double dm_level_normal_step(dm_level *l, const double *rows, uint32_t count) {
    const uint32_t n = l->n;
    double size = 0;
    const int of_F = rows == l->slope && count == l->c;
    if (!(of_F && l->has_gram)) {
        l->has_gram = 0;
        square(l->gram, rows, count, n);
        if (dm_lu_factor(l->gram, l->pivot, count) != DM_OK) return NAN;
        l->has_gram = of_F;
    }
    dm_lu_solve(l->y, l->gram, l->pivot, count);
    for (uint32_t k = 0; k < n; k++) {
        double sum = 0;
        for (uint32_t i = 0; i < count; i++) sum += rows[i * n + k] * l->y[i];
        l->change[k] = sum;
        size += sum * sum;
    }
    return sqrt(size);
}

int dm_level_bring(dm_level *l, double *x, double step) {
    for (int i = 0; i < CORRECTIONS; i++) {
        if (!dm_level_look(l, x)) return 0;
        for (uint32_t k = 0; k < l->c; k++) l->y[k] = l->value[k] - 1;
        const double size = dm_level_normal_step(l, l->slope, l->c);
        if (!(size < MOST * step)) return 0;
        for (uint32_t k = 0; k < l->n; k++) x[k] -= l->change[k];
        if (size <= LAST * step) return 1;
    }
    return 0;
}

int dm_level_turn(dm_level *l, double *v, uint32_t more) {
    const uint32_t n = l->n, count = l->c + more;
    const double *rows = more ? l->rows : l->slope;
    double size = 0, before = 0;
    if (more) memcpy(l->rows, l->slope, (size_t)l->c * n * sizeof *l->rows);
    for (uint32_t i = 0; i < count; i++) {
        l->y[i] = 0;
        for (uint32_t k = 0; k < n; k++) l->y[i] += rows[i * n + k] * v[k];
    }
    for (uint32_t k = 0; k < n; k++) before += v[k] * v[k];
    if (!isfinite(dm_level_normal_step(l, rows, count))) return 0;
    for (uint32_t k = 0; k < n; k++) {
        v[k] -= l->change[k];
        size += v[k] * v[k];
    }
    if (!(size > ALONG * ALONG * before)) return 0;
    for (uint32_t k = 0; k < n; k++) v[k] /= sqrt(size);
    return 1;
}

/* determinant from factors, which have the reciprocals of pivots */
static double product(const double *A, const uint32_t *pivot, uint32_t n) {
    double out = 1;
    for (uint32_t i = 0; i < n; i++) out *= pivot[i] == i ? A[i * n + i] : -A[i * n + i];
    return 1 / out;
}

/* determinant of A[n n], which becomes its factors; pivot[n]: scratch */
static double determinant(double *A, uint32_t *pivot, uint32_t n) {
    return dm_lu_factor(A, pivot, n) == DM_OK ? product(A, pivot, n) : 0;
}

/* product of the lengths of the rows of A[n n] */
static double lengths(const double *A, uint32_t n) {
    double out = 1;
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0;
        for (uint32_t j = 0; j < n; j++) sum += A[i * n + j] * A[i * n + j];
        out *= sum;
    }
    return sqrt(out);
}

/* det J J^T of the section's rows */
static double of_section(dm_level *l, uint32_t *scratch) {
    if (l->has_gram && l->c == l->r) return product(l->gram, l->pivot, l->r);
    square(l->turns, l->slope, l->r, l->n);
    return determinant(l->turns, scratch, l->r);
}

/* out[r r] = B psi, where entry (i, k) of B stands at B[i row + k column] */
static void multiply(double *out, const double *B, size_t row, size_t column, const dm_level *l) {
    const uint32_t n = l->n, r = l->r;
    memset(out, 0, (size_t)r * r * sizeof *out);
    for (uint32_t i = 0; i < r; i++) {
        double *restrict sum = out + (size_t)i * r;
        for (uint32_t k = 0; k < n; k++) {
            const double b = B[i * row + k * column], *psi = l->psi + (size_t)k * r;
            if (b == 0.0) continue; /* as most of a section's slopes (first, bench frames) */
            for (uint32_t j = 0; j < r; j++) sum[j] += b * psi[j];
        }
    }
}

double dm_level_sine(dm_level *l, double *slant) {
    const uint32_t n = l->n, r = l->r;
    uint32_t *scratch = l->pivot + l->c + l->s;
    multiply(l->A, l->slope, n, 1, l);
    multiply(l->turns, l->psi, 1, r, l);
    const double rows = lengths(l->A, r), cut = determinant(l->A, scratch, r);
    const double turns = determinant(l->turns, scratch, r);
    const double sine = cut / sqrt(turns * of_section(l, scratch));
    if (slant) *slant = r > 1 && rows > 0 ? cut / rows : sine;
    return sine;
}

/* ---- away from the level set ---- */

static double length(const double *x, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += x[i] * x[i];
    return sqrt(sum);
}

static int are_finite(const double *x, size_t n) {
    int are = 1;
    for (size_t i = 0; i < n; i++) are &= isfinite(x[i]) != 0;
    return are;
}

int dm_level_cut(dm_level *l, const double *x, double *A, double *inverse, double *unit,
                 double *condition) {
    const uint32_t n = l->n, r = l->r;
    const size_t size = (size_t)n * r, all = (size_t)r * r;
    double rows = 0;
    l->has_gram = 0;
    dm_kernel_eval(&l->kernel, x, l->value);
    if (!are_finite(l->slope, size) || !are_finite(l->psi, size)) return 0;
    multiply(A, l->slope, n, 1, l);
    for (uint32_t i = 0; i < r; i++) {
        const double *J = l->slope + (size_t)i * n, reach = length(J, n);
        unit[i] = reach > 0 ? 1 / reach : 1;
        rows += reach > 0;
        for (uint32_t j = 0; j < r; j++) A[i * r + j] *= unit[i];
    }
    memcpy(inverse, A, all * sizeof *A);
    const int is = dm_invert(inverse, l->pivot, r) == DM_OK;
    const double turns = sqrt(rows) * length(x, n), most = fmax(length(A, all) / r, turns);
    *condition = is ? length(inverse, all) * most : INFINITY;
    if (isnan(*condition)) *condition = INFINITY;
    return 1;
}

int dm_level_approach(dm_level *l, const double *x, const double *goal, double *y) {
    const uint32_t n = l->n, r = l->r;
    l->has_gram = 0;
    dm_kernel_eval(&l->kernel, x, l->value);
    if (!are_finite(l->psi, (size_t)n * r)) return 0;
    multiply(l->A, l->psi, 1, r, l);
    if (dm_lu_factor(l->A, l->pivot, r) != DM_OK) return 0;
    for (uint32_t j = 0; j < r; j++) {
        y[j] = 0;
        for (uint32_t k = 0; k < n; k++) y[j] += l->psi[(size_t)k * r + j] * (goal[k] - x[k]);
    }
    dm_lu_solve(y, l->A, l->pivot, r);
    return 1;
}
