/* derham.c - the de Rham map (Leok 3.5): integrals of a form, a function of the point that gives
 * its components, over cells and over dual cells. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/array.h"
#include "dec/cell.h"
#include "dec/simplex_rule.h"

#include <math.h>
#include <string.h>

enum { MESH = 1, DEGREE, FUNCTION, DUAL, ORDER, CHART, MOST_COMPONENTS = 10000 };

/* An integral in the making; all memory is the collector's. The form has a component for every
 * ascending list of k of the N coordinates, lists in lexicographic order. */
typedef struct {
    lua_State *L;
    uint32_t N, k, components, nodes;
    const double *node, *weight; /* [nodes][k + 1], [nodes] */
    int chart;                   /* the place of the chart on the stack, 0: cells are flat */
    double *value;               /* [components] at a node */
    double *minor;               /* [components]: k x k minors of the edges */
    double *corner;              /* [k + 1][N]: the simplex */
    double *edge;                /* [k][N]: images of the edges from corner 0 */
    double *x, *moved, *shifted; /* [N] each */
} integral;

/* f(x, y, ...) of the function at `place` on the stack, `count` numbers */
static void call(const integral *q, int place, const char *name, const double *x, double *out,
                 uint32_t count) {
    lua_State *L = q->L;
    luaL_checkstack(L, (int)q->N + 4, NULL);
    lua_pushvalue(L, place);
    for (uint32_t i = 0; i < q->N; i++) lua_pushnumber(L, x[i]);
    dml_callone(L, (int)q->N, name);
    dml_vectorarg(L, -1, name, out, count);
    lua_pop(L, 1);
}

/* determinant of columns `list` of edge[k][N], by elimination with pivots */
static double minor_of(const integral *q, const uint32_t *list) {
    double A[DM_DIMENSION][DM_DIMENSION], det = 1.0;
    const uint32_t k = q->k;
    for (uint32_t i = 0; i < k; i++)
        for (uint32_t j = 0; j < k; j++) A[i][j] = q->edge[i * q->N + list[j]];
    for (uint32_t c = 0; c < k; c++) {
        uint32_t p = c;
        for (uint32_t i = c + 1; i < k; i++)
            if (fabs(A[i][c]) > fabs(A[p][c])) p = i;
        if (A[p][c] == 0.0) return 0.0;
        for (uint32_t j = 0; p != c && j < k; j++) {
            const double moved = A[c][j];
            A[c][j] = A[p][j], A[p][j] = moved;
        }
        det *= p != c ? -A[c][c] : A[c][c];
        for (uint32_t i = c + 1; i < k; i++)
            for (uint32_t j = k; j-- > c;) A[i][j] -= A[i][c] / A[c][c] * A[c][j];
    }
    return det;
}

/* all k x k minors of the edges, by their lists of columns in lexicographic order */
static void make_minors(const integral *q) {
    uint32_t list[DM_DIMENSION + 1];
    for (uint32_t j = 0; j < q->k; j++) list[j] = j;
    for (uint32_t I = 0; I < q->components; I++) {
        q->minor[I] = minor_of(q, list);
        for (uint32_t j = q->k; j-- > 0;) { /* the next list */
            if (list[j] + q->k - j == q->N) continue;
            list[j]++;
            for (uint32_t i = j + 1; i < q->k; i++) list[i] = list[i - 1] + 1;
            break;
        }
    }
}

/* derivatives of the chart along the edges at x, by differences of order 6 over 1/64 of them: an
 * error of some 1e-13 where the chart bends a cell by a radian */
static void bend_edges(const integral *q) {
    static const double factor[] = {45.0, -9.0, 1.0};
    const uint32_t N = q->N;
    for (uint32_t j = 0; j < q->k; j++) {
        double *edge = q->edge + (size_t)j * N;
        memset(edge, 0, N * sizeof *edge);
        for (int at = -3; at <= 3; at++) {
            if (at == 0) continue;
            for (uint32_t m = 0; m < N; m++)
                q->shifted[m] = q->x[m] + at / 64.0 * (q->corner[(j + 1) * N + m] - q->corner[m]);
            call(q, q->chart, "chart(x, y, ...)", q->shifted, q->moved, N);
            const double weight = factor[at < 0 ? -at - 1 : at - 1] * 64.0 / 60.0;
            for (uint32_t m = 0; m < N; m++) edge[m] += (at < 0 ? -weight : weight) * q->moved[m];
        }
    }
}

/* over the simplex of the corners, in their order */
static double integrate(const integral *q) {
    const uint32_t N = q->N, k = q->k;
    double sum = 0.0, factor = 1.0;
    dml_checkstop(q->L);
    for (uint32_t i = 2; i <= k; i++) factor /= i;
    for (uint32_t i = 0; i < k * N; i++) q->edge[i] = q->corner[i + N] - q->corner[i % N];
    if (!q->chart) make_minors(q);
    for (uint32_t i = 0; i < q->nodes; i++) {
        memset(q->x, 0, N * sizeof *q->x);
        for (uint32_t j = 0; j <= k; j++)
            for (uint32_t m = 0; m < N; m++)
                q->x[m] += q->node[i * (k + 1) + j] * q->corner[j * N + m];
        if (q->chart) {
            bend_edges(q);
            make_minors(q);
            call(q, q->chart, "chart(x, y, ...)", q->x, q->moved, N);
        }
        call(q, FUNCTION, "f(x, y, ...)", q->chart ? q->moved : q->x, q->value, q->components);
        double here = 0.0;
        for (uint32_t I = 0; I < q->components; I++) here += q->value[I] * q->minor[I];
        sum += q->weight[i] * here;
    }
    return factor * sum;
}

/* corner j = the point of a vertex */
static void set_corner(const integral *q, const dml_mesh *m, uint32_t j, uint32_t vertex) {
    memcpy(q->corner + (size_t)j * q->N, m->points + (size_t)vertex * q->N,
           q->N * sizeof *q->corner);
}

/* out[count[k]]: cells about ascending vertices */
static void over_cells(const integral *q, const dml_mesh *m, double *out) {
    uint32_t room[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < m->K.count[q->k]; i++) {
        const uint32_t *vertex = dm_complex_vertices(&m->K, q->k, i, room);
        for (uint32_t j = 0; j <= q->k; j++) set_corner(q, m, j, vertex[j]);
        out[i] = integrate(q);
    }
}

/* ---- dual cells: a simplex of centres for every flag above a cell ---- */

/* corner j = the centre of face `set` of c */
static void set_centre(const integral *q, const dml_mesh *m, dm_cell *c, uint32_t set, uint32_t j) {
    double lambda[DM_DIMENSION + 1];
    double *corner = q->corner + (size_t)j * q->N;
    dm_metric_centre(lambda, &c->metric, set, m->metric.centres);
    memset(corner, 0, q->N * sizeof *corner);
    for (uint32_t i = 0; i <= c->n; i++)
        for (uint32_t x = 0; x < q->N; x++)
            corner[x] += lambda[i] * m->points[(size_t)c->vertex[i] * q->N + x];
}

/* corners from j on, through all orders in which vertices join `set`; the sign of a flag is that of
 * the cell with the vertices that joined behind it */
static double over_flags(const integral *q, const dml_mesh *m, dm_cell *c, uint32_t set, uint32_t j,
                         int sign) {
    const uint32_t all = (2u << c->n) - 1;
    double sum = 0.0;
    set_centre(q, m, c, set, j);
    if (set == all) return sign * integrate(q);
    for (uint32_t w = 0, rest = all & ~set; w <= c->n; w++)
        if (rest >> w & 1) /* w comes before those of the rest that are below it */
            sum += over_flags(q, m, c, set | 1u << w, j + 1,
                              dm_bits(rest & ((1u << w) - 1)) % 2 ? -sign : sign);
    return sum;
}

/* out[count[n - k]]: every top cell adds its part of the dual cells of its faces. A dual function
 * (k = 0) is a plain value: no sign */
static void over_duals(const integral *q, const dml_mesh *m, double *out) {
    dm_cell c;
    const uint32_t n = m->K.n, all = (2u << n) - 1;
    for (uint32_t top = 0; top < m->K.count[n]; top++) {
        dm_cell_read(&c, &m->K, &m->metric, top);
        for (uint32_t set = 1; set <= all; set++) {
            if (dm_bits(set) != n - q->k + 1) continue;
            const int sign = q->k ? c.sign * dm_parity(set, all & ~set) : 1;
            out[dm_complex_face(&m->K, n, top, set)] += over_flags(q, m, &c, set, 0, sign);
        }
    }
}

/* ---- the call ---- */

/* memory of the collector */
static double *take(lua_State *L, size_t count) {
    return lua_newuserdatauv(L, (count + 1) * sizeof(double), 0);
}

/* C(N, k) */
static uint32_t count_components(lua_State *L, uint32_t N, uint32_t k) {
    double count = 1.0;
    for (uint32_t i = 1; i <= k; i++) count = count * (N - k + i) / i;
    if (!(count <= MOST_COMPONENTS))
        luaL_error(L, "a form of degree %d in %d dimensions has too many components", (int)k,
                   (int)N);
    return (uint32_t)(count + 0.5);
}

/* rule and memory of all integrals of a call */
static void make(lua_State *L, integral *q, const dml_mesh *m, uint32_t k, uint32_t order) {
    *q = (integral){.L = L, .N = m->ambient, .k = k};
    q->components = count_components(L, q->N, k);
    q->nodes = k ? dm_simplex_nodes(k, order) : 1;
    double *node = take(L, (size_t)q->nodes * (k + 1)), *weight = take(L, q->nodes);
    dm_simplex_rule(node, weight, k, k ? order : 1);
    q->node = node, q->weight = weight;
    q->value = take(L, q->components);
    q->minor = take(L, q->components);
    q->corner = take(L, (size_t)(k + 1) * q->N);
    q->edge = take(L, (size_t)(k + 1) * q->N);
    q->x = take(L, q->N);
    q->moved = take(L, q->N);
    q->shifted = take(L, q->N);
    q->chart = lua_isnil(L, CHART) ? 0 : CHART;
}

/* what can be called, or nothing where it may be left out */
static void check_callable(lua_State *L, int arg, int optional) {
    if (optional && lua_isnil(L, arg)) return;
    if (lua_type(L, arg) == LUA_TFUNCTION) return;
    if (lua_isnumber(L, arg) || luaL_getmetafield(L, arg, "__call") == LUA_TNIL)
        luaL_typeerror(L, arg, "function"); /* numbers: see mesh_euler.c */
    lua_pop(L, 1);
}

/* stack: mesh, degree, function, dual, order, chart */
int dml_mesh_integrals(lua_State *L) {
    const dml_mesh *m = dml_checkmesh(L, MESH);
    const uint32_t k = dml_checkdegree(L, DEGREE, m);
    const int dual = lua_toboolean(L, DUAL);
    const lua_Integer order = dml_optinteger(L, ORDER, 5);
    integral q;
    lua_settop(L, CHART);
    if (!m->points)
        luaL_error(L, "a function of the point needs points, and this mesh has none: give values");
    check_callable(L, FUNCTION, 0);
    check_callable(L, CHART, 1);
    luaL_argcheck(L, order >= 1 && order <= 21, ORDER, "an order from 1 to 21 is needed");
    if (dual && k) dml_needorientation(L, m);
    if (dual) dml_needmetric(L, m);
    make(L, &q, m, k, (uint32_t)order);
    double *out = dml_pushvector(L, m->K.count[dual ? m->K.n - k : k]);
    if (dual)
        over_duals(&q, m, out);
    else
        over_cells(&q, m, out);
    return 1;
}
