/* linear.c - linear systems as nodes. Whether an entry is zero is known while the graph is made
 * (node 0), so elimination leaves zeros out and looks for an order that fills in little; there
 * is no pivoting by size, since sizes are not known. A reciprocal a pivot, products elsewhere:
 * chains of divisions are what such a kernel waits for. */
#include "graph/linear.h"

#include "graph/nodes.h"

/* nothing is made where a factor is zero everywhere */
dm_node dm_add_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    if (!x || !y) return sum;
    return sum ? dm_multiply_add(g, x, y, sum) : dm_mul(g, x, y);
}

/* a fused product with the sign in a factor */
dm_node dm_subtract_product(dm_graph *g, dm_node sum, dm_node x, dm_node y) {
    if (!x || !y) return sum;
    const dm_node minus = dm_neg(g, x);
    return dm_add_product(g, sum, minus, y);
}

/* rows k and i of A, from column k on, and of x change places */
static void exchange(dm_node *A, dm_node *x, uint32_t m, uint32_t k, uint32_t i) {
    dm_node *a = A + k * (size_t)m, *b = A + i * (size_t)m;
    for (uint32_t j = k; j < m; j++) {
        const dm_node kept = a[j];
        a[j] = b[j], b[j] = kept;
    }
    const dm_node kept = x[k];
    x[k] = x[i], x[i] = kept;
}

/* a pivot that is zero everywhere: the next row that has one */
static void find_pivot(dm_node *A, dm_node *x, uint32_t m, uint32_t k) {
    for (uint32_t i = k; i < m; i++)
        if (A[i * (size_t)m + k]) {
            if (i != k) exchange(A, x, m, k, i);
            return;
        }
}

/* a diagonal entry is zero everywhere, as in [0, B; B^T, C]: 0, and A has its lower half too */
static int has_diagonal(dm_node *A, uint32_t m, int symmetric) {
    uint32_t zeros = 0;
    for (uint32_t i = 0; i < m; i++) zeros += A[i * (size_t)m + i] == 0;
    for (uint32_t i = 0; zeros && symmetric && i < m; i++)
        for (uint32_t j = 0; j < i; j++) A[i * (size_t)m + j] = A[j * (size_t)m + i];
    return !zeros;
}

/* volume x pivot x unit, where there is a unit; node 0 is a volume of none yet */
static dm_node widen(dm_graph *g, dm_node volume, dm_node pivot, dm_node unit) {
    if (!unit) return volume;
    const dm_node own = dm_mul(g, unit, pivot);
    return volume ? dm_mul(g, volume, own) : own;
}

/* eliminated in the order of the rows; the reciprocals of the pivots stay on the diagonal */
static dm_node eliminate(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, const dm_node *units) {
    const dm_node one = dm_constant(g, 1.0);
    dm_node volume = 0;
    for (uint32_t k = 0; k < m; k++) {
        dm_node *pivot = A + k * (size_t)m;
        find_pivot(A, x, m, k);
        if (units) volume = widen(g, volume, pivot[k], units[k]);
        pivot[k] = dm_div(g, one, pivot[k]);
        for (uint32_t i = k + 1; i < m; i++) {
            dm_node *row = A + i * (size_t)m;
            if (!row[k]) continue;
            const dm_node factor = dm_mul(g, row[k], pivot[k]);
            for (uint32_t j = k + 1; j < m; j++)
                row[j] = dm_subtract_product(g, row[j], factor, pivot[j]);
            x[i] = dm_subtract_product(g, x[i], factor, x[k]);
        }
    }
    for (uint32_t k = m; k-- > 0;) {
        const dm_node *row = A + k * (size_t)m;
        for (uint32_t j = k + 1; j < m; j++) x[k] = dm_subtract_product(g, x[k], row[j], x[j]);
        if (x[k]) x[k] = dm_mul(g, x[k], row[k]);
    }
    return volume;
}

/* ---- along the diagonal, in an order that fills in little ---- */

/* a system in elimination; rows order[0 .. k-1] are done */
typedef struct {
    dm_graph *g;
    dm_node *A, *x;
    uint32_t m, *order; /* [m]: what is eliminated first, second ... */
    uint32_t *depth;    /* [m]: divisions in a row before the pivot of a row is known */
    int symmetric;
    const dm_node *units; /* [m] of pivots; NULL: their product is not asked for */
    dm_node volume;       /* that of the pivots so far */
} system_of;

/* entry of the unknowns i, j */
static dm_node *entry(const system_of *s, uint32_t i, uint32_t j) {
    const int upper = !s->symmetric || i <= j;
    return s->A + (upper ? i * (size_t)s->m + j : j * (size_t)s->m + i);
}

/* entries that row i has in what is not eliminated yet */
static uint32_t degree(const system_of *s, uint32_t k, uint32_t i) {
    uint32_t count = 0;
    for (uint32_t c = k; c < s->m; c++) count += *entry(s, i, s->order[c]) != 0;
    return count;
}

/* the row with the fewest entries is next (minimum degree, Tinney & Walker 1967), of these the
 * one that waits for the fewest divisions: from both ends of a chain they are made side by side */
static void choose(system_of *s, uint32_t k) {
    uint32_t best = k, least = degree(s, k, s->order[k]);
    for (uint32_t c = k + 1; c < s->m; c++) {
        const uint32_t i = s->order[c], now = degree(s, k, i);
        const int sooner = s->depth[i] < s->depth[s->order[best]];
        if (now < least || (now == least && sooner)) best = c, least = now;
    }
    const uint32_t kept = s->order[k];
    s->order[k] = s->order[best];
    s->order[best] = kept;
}

/* the pivot's reciprocal stays in its place, fill-in where both row and column have an entry */
static void eliminate_one(system_of *s, uint32_t k) {
    const uint32_t p = s->order[k];
    dm_node *pivot = entry(s, p, p);
    if (s->units) s->volume = widen(s->g, s->volume, *pivot, s->units[p]);
    *pivot = dm_div(s->g, dm_constant(s->g, 1.0), *pivot);
    for (uint32_t r = k + 1; r < s->m; r++) {
        const uint32_t i = s->order[r];
        if (!*entry(s, i, p)) continue;
        if (s->depth[i] <= s->depth[p]) s->depth[i] = s->depth[p] + 1;
        const dm_node factor = dm_mul(s->g, *entry(s, i, p), *pivot);
        for (uint32_t c = s->symmetric ? r : k + 1; c < s->m; c++) {
            dm_node *to = entry(s, i, s->order[c]);
            *to = dm_subtract_product(s->g, *to, factor, *entry(s, p, s->order[c]));
        }
        s->x[i] = dm_subtract_product(s->g, s->x[i], factor, s->x[p]);
    }
}

/* elimination in that order, then back substitution in the reverse one */
static void eliminate_diagonal(system_of *s) {
    for (uint32_t k = 0; k < s->m; k++) s->order[k] = k, s->depth[k] = 0;
    for (uint32_t k = 0; k < s->m; k++) {
        choose(s, k);
        eliminate_one(s, k);
    }
    for (uint32_t k = s->m; k-- > 0;) {
        const uint32_t p = s->order[k];
        for (uint32_t c = k + 1; c < s->m; c++) {
            const uint32_t j = s->order[c];
            s->x[p] = dm_subtract_product(s->g, s->x[p], *entry(s, p, j), s->x[j]);
        }
        if (s->x[p]) s->x[p] = dm_mul(s->g, s->x[p], *entry(s, p, p));
    }
}

/* three and more */
static dm_node solve_many(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, int symmetric,
                          const dm_node *units) {
    system_of s = {.g = g, .A = A, .x = x, .m = m, .symmetric = symmetric, .units = units};
    if (!has_diagonal(A, m, symmetric)) return eliminate(g, A, x, m, units);
    s.order = dm_arena_take(dm_graph_arena(g), 2 * (size_t)m * sizeof *s.order);
    s.depth = s.order + m;
    if (s.order)
        eliminate_diagonal(&s);
    else
        dm_graph_fail(g, DM_NO_MEMORY);
    return s.volume;
}

/* two by two by Cramer's rule: one division */
static dm_node solve_two(dm_graph *g, const dm_node *A, dm_node *x, int symmetric) {
    const dm_node a10 = symmetric ? A[1] : A[2], one = dm_constant(g, 1.0);
    dm_node determinant = dm_add_product(g, 0, A[0], A[3]);
    determinant = dm_subtract_product(g, determinant, A[1], a10);
    const dm_node inverse = dm_div(g, one, determinant);
    dm_node first = dm_add_product(g, 0, A[3], x[0]);
    first = dm_subtract_product(g, first, A[1], x[1]);
    dm_node second = dm_add_product(g, 0, A[0], x[1]);
    second = dm_subtract_product(g, second, a10, x[0]);
    x[0] = dm_mul(g, first, inverse);
    x[1] = dm_mul(g, second, inverse);
    return determinant;
}

/* one unknown by a division, two by Cramer's rule */
dm_node dm_graph_solve(dm_graph *g, dm_node *A, dm_node *x, uint32_t m, int symmetric,
                       const dm_node *units) {
    if (m > 2) return solve_many(g, A, x, m, symmetric, units);
    dm_node volume = m ? A[0] : 0;
    if (m == 2) volume = solve_two(g, A, x, symmetric);
    if (m == 1) x[0] = dm_div(g, x[0], A[0]);
    for (uint32_t i = 0; units && i < m; i++)
        if (units[i]) volume = dm_mul(g, units[i], volume);
    return volume;
}
