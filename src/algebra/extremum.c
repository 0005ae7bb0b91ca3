/* extremum.c - derivatives of y -> ext f(x, y) by the envelope property, in the graph of f,
 * where they are short, and brought over to the graph of the value in the end.
 *
 *   value_x = f_x,   value_xx = f_xx - f_xy f_yy^-1 f_yx,   both at the y that makes f_y = 0
 *
 * Speed: routh, 2 rotors by gauss(1): 1.30x, against derivatives of the formula of y. */
#include "algebra/extremum.h"

#include "algebra/derive.h"
#include "graph/linear.h"
#include "graph/nodes.h"

/* the arrays stay where they are, the record is copied */
void dm_extremum_keep(dm_graph *g, const dm_extremum *e) {
    dm_extremum *kept = dm_arena_take(g->arena, sizeof *kept);
    if (!kept) {
        dm_graph_fail(g, DM_NO_MEMORY);
        return;
    }
    *kept = *e;
    kept->next = g->extrema;
    g->extrema = kept;
}

/* by its value; nodes are equal where expressions are */
const dm_extremum *dm_extremum_find(const dm_graph *g, dm_node value) {
    const dm_extremum *e = g->extrema;
    while (e && e->value != value) e = e->next;
    return e;
}

/* H[w*w], w = n + m, of which the first n rows and columns become those of the Schur complement
 * of the last m */
static void complement(dm_graph *g, dm_node *H, uint32_t n, uint32_t m, dm_node *A, dm_node *x) {
    const size_t w = (size_t)n + m;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t a = 0; a < m; a++) {
            x[a] = H[(n + a) * w + j];
            for (uint32_t b = 0; b < m; b++) A[a * m + b] = H[(n + a) * w + n + b];
        }
        dm_graph_solve(g, A, x, m, 1, NULL);
        for (uint32_t i = 0; i <= j; i++)
            for (uint32_t a = 0; a < m; a++)
                H[i * w + j] = dm_subtract_product(g, H[i * w + j], H[i * w + n + a], x[a]);
    }
}

/* gradient[n] and the upper half of hessian[n*n], one after the other, as nodes of e->of;
 * returns how many */
static uint32_t collect(const dm_extremum *e, dm_node *out, const dm_node *gradient,
                        const dm_node *H) {
    const size_t w = (size_t)e->n + e->m;
    uint32_t count = e->n;
    memcpy(out, gradient, e->n * sizeof *out);
    for (uint32_t i = 0; i < e->n; i++)
        for (uint32_t j = i; j < e->n; j++) out[count++] = H[i * w + j];
    return count;
}

/* what the inputs of e->of are in g */
static void inputs_of(dm_graph *g, const dm_extremum *e, dm_node *with) {
    for (uint32_t i = 0; i < e->n; i++) with[i] = dm_input(g, i);
    memcpy(with + e->n, e->y, e->m * sizeof *with);
    for (uint32_t i = e->n; i + e->m < dm_graph_inputs(e->of); i++) with[i + e->m] = dm_input(g, i);
}

void dm_extremum_derive(dm_graph *g, const dm_extremum *e, dm_node *gradient, dm_node *hessian) {
    const uint32_t n = e->n, m = e->m, w = n + m, inputs = dm_graph_inputs(e->of);
    const size_t count = (size_t)w * w + 2 * (size_t)w + m * (m + 1) + 2 * (n + n * (size_t)n);
    dm_node *all = dm_arena_take(g->arena, (count + inputs) * sizeof *all);
    memset(gradient, 0, n * sizeof *gradient);
    memset(hessian, 0, (size_t)n * n * sizeof *hessian);
    if (!all) {
        dm_graph_fail(g, DM_NO_MEMORY);
        return;
    }
    dm_node *G = all + inputs, *H = G + w, *A = H + (size_t)w * w, *x = A + m * m, *out = x + m;
    dm_hessian(e->of, e->f, 0, w, G, H);
    complement(e->of, H, n, m, A, x);
    const uint32_t made = collect(e, out, G, H);
    inputs_of(g, e, all);
    dm_transplant(g, e->of, out, made, all, out + made);
    if (dm_graph_status(g) != DM_OK) return;
    memcpy(gradient, out + made, n * sizeof *gradient);
    for (uint32_t i = 0, k = made + n; i < n; i++)
        for (uint32_t j = i; j < n; j++, k++)
            hessian[i * (size_t)n + j] = hessian[j * (size_t)n + i] = out[k];
}
