/* lie_joints_equation.c - the step equation of lie_joints.h and its exact matrix. */
#include "base/largest.h"
#include "integ/lie/lie_joints_inside.h"

#include <math.h>
#include <string.h>

/* ---- where the values and the columns of a kernel go ---- */

enum { BLOCKS = 4 };

/* Entries first .. first + length - 1 of the values (or columns) of a kernel go to `count` places
 * in the equation (or among the unknowns): to at, at + stride, ... with weights w[count], times
 * unit[i] of each entry where that is there. */
typedef struct {
    uint32_t first, length, count, at, stride;
    const double *w, *unit;
    int pulled; /* they are a part of w, from where dtau_R(xi1)^T takes them to all V */
} block;

typedef struct {
    block of[BLOCKS];
    int count;
} blocks;

/* of a kernel's number i; NULL: it goes nowhere */
static const block *find(const blocks *b, uint32_t i) {
    for (int k = 0; k < b->count; k++)
        if (i - b->of[k].first < b->of[k].length) return b->of + k;
    return NULL;
}

static double weight(const block *b, uint32_t i, uint32_t place) {
    return b->unit ? b->w[place] * b->unit[i - b->first] : b->w[place];
}

/* R += values by way of `rows`; the size of the largest term */
static void add_values(dm_lie_joints *e, double *R, const double *values, const blocks *rows) {
    for (int k = 0; k < rows->count; k++) {
        const block *b = rows->of + k;
        double *out = b->pulled ? e->w : R + b->at;
        for (uint32_t p = 0; p < b->count; p++)
            for (uint32_t i = 0; i < b->length; i++) {
                const double term = weight(b, b->first + i, p) * values[b->first + i];
                out[p * b->stride + i] += term;
                e->size = dm_largest(e->size, term);
            }
    }
}

/* J += x in these rows and one column */
static void add_down(const dm_lie_joints *e, double *J, const block *r, uint32_t row, size_t column,
                     double x) {
    for (uint32_t p = 0; p < r->count && !r->pulled; p++)
        J[e->step.row[r->at + p * r->stride + row - r->first] + column] += weight(r, row, p) * x;
    if (!r->pulled) return;
    const dm_group_entries *f = &e->joints->pull;
    const uint32_t *first = e->pull_first + row - r->first;
    for (uint32_t i = first[0]; i < first[1]; i++) {
        const uint32_t entry = e->pull_entry[i];
        const double y = *r->w * e->pull[f->values + entry] * x;
        for (uint32_t j = 0; j < e->s; j++)
            J[e->step.row[j * e->d + f->row[entry]] + column] -= e->beta[j] * y;
    }
}

/* J += entries by way of `rows` and `columns` */
static void add_entries(const dm_lie_joints *e, double *J, const dm_group_entries *f,
                        const double *values, const blocks *rows, const blocks *columns) {
    for (uint32_t i = 0; i < f->count; i++) {
        const block *r = find(rows, f->row[i]), *c = find(columns, f->column[i]);
        for (uint32_t q = 0; r && c && q < c->count; q++)
            add_down(e, J, r, f->row[i],
                     e->step.column[c->at + q * c->stride + f->column[i] - c->first],
                     weight(c, f->column[i], q) * values[f->values + i]);
    }
}

/* ---- points of the curve ---- */

/* out[d] = factor sum_j a_j V_j */
static void combine(double *out, const dm_lie_joints *e, const double *a, double factor,
                    const double *V) {
    memset(out, 0, e->d * sizeof *out);
    for (uint32_t j = 0; j < e->s; j++)
        for (uint32_t k = 0; k < e->d; k++) out[k] += factor * a[j] * V[j * e->d + k];
}

/* xi, its rate and the time of a point, behind g0 */
static void place(dm_lie_joints *e, const dm_lie_points *p, uint32_t i, const double *V) {
    double *xi = e->x + e->n;
    combine(xi, e, p->a + i * e->s, e->h, V);
    combine(xi + e->d, e, p->d + i * e->s, 1.0, V);
    e->x[e->n + 2 * e->d] = e->t + p->c[i] * e->h;
}

/* weights of the places of a point: those of its values, and of its columns xi and rate */
typedef struct {
    double of_e, of_xi[DM_QUADRATURE_NODES], of_rate[DM_QUADRATURE_NODES];
    double xi[DM_QUADRATURE_NODES], rate[DM_QUADRATURE_NODES];
} weights;

static void weigh_columns(weights *w, const dm_lie_joints *e, const dm_lie_points *p, uint32_t i) {
    for (uint32_t j = 0; j < e->s; j++) {
        w->xi[j] = e->h * p->a[i * e->s + j];
        w->rate[j] = p->d[i * e->s + j];
    }
}

/* columns xi and rate of a point lead to all V_j */
static blocks columns_of(const dm_lie_joints *e, const weights *w) {
    const uint32_t d = e->d, s = e->s;
    return (blocks){.count = 2,
                    .of = {{.length = d, .count = s, .stride = d, .w = w->xi},
                           {.first = d, .length = d, .count = s, .stride = d, .w = w->rate}}};
}

static const double ONE = 1.0;

/* what a point gives w, for turning.c */
static void keep_for_w(dm_lie_joints *e, uint32_t i, const double *of_e) {
    if (dm_lie_joints_turn(e)) memcpy(e->of_e + i * e->d, of_e, e->d * sizeof *of_e);
}

/* ---- the terms of the equation; J NULL: its matrix is not asked for ---- */

/* L at point i of the quadrature */
static void add_slope(dm_lie_joints *e, double *R, double *J, uint32_t i, const double *V) {
    const uint32_t d = e->d, s = e->s;
    weights w = {.of_e = e->h * e->b[i]};
    for (uint32_t j = 0; j < s; j++) {
        w.of_xi[j] = e->h * e->b[i] * e->at.a[i * s + j];
        w.of_rate[j] = e->b[i] * e->at.d[i * s + j];
    }
    const blocks rows =
        {.count = 3,
         .of = {{.length = d, .count = 1, .w = &w.of_e, .pulled = 1},
                {.first = d, .length = d, .count = s, .stride = d, .w = w.of_xi},
                {.first = 2 * d, .length = d, .count = s, .stride = d, .w = w.of_rate}}};
    place(e, &e->at, i, V);
    if (e->s == 1) e->x[e->n] = e->h * e->at.a[i];
    if (R) dm_group_entries_eval(e->along, e->x, e->slope, J != NULL);
    if (R) add_values(e, R, e->slope, &rows);
    if (R) keep_for_w(e, i, e->slope);
    if (!J) return;
    weigh_columns(&w, e, &e->at, i);
    const blocks columns = columns_of(e, &w);
    add_entries(e, J, e->along, e->slope, &rows, &columns);
}

/* g and the impulse at constraint point i: g stands in the rows of the point before */
static void add_reaction(dm_lie_joints *e, double *R, double *J, uint32_t i, const double *z) {
    const uint32_t d = e->d, s = e->s, k = e->k, first = s * d;
    const int acts = i<e->K, holds = i> 0;
    const double of_g = 1.0 / e->h;
    weights w = {0};
    for (uint32_t j = 0; j < s; j++) w.of_xi[j] = e->nodes.a[i * s + j];
    blocks rows = {.of = {{.length = k,
                           .count = (uint32_t)holds,
                           .at = first + (i - (uint32_t)holds) * e->m,
                           .w = &of_g,
                           .unit = e->row_unit},
                          {.first = k, .length = d, .count = 1, .w = &ONE, .pulled = 1},
                          {.first = k + d, .length = d, .count = s, .stride = d, .w = w.of_xi}}};
    rows.count = acts ? 3 : 1;
    place(e, &e->nodes, i, z);
    if (acts) memcpy(e->x + e->n + 2 * d + 1 + e->m, e->v + i * e->n, d * sizeof *e->v);
    for (uint32_t c = 0; c < e->m; c++)
        e->x[e->n + 2 * d + 1 + c] = acts ? z[first + i * e->m + c] * e->impulse_unit[c] : 0.0;
    if (R) dm_group_entries_eval(&e->joints->reaction, e->x, e->reaction, J != NULL);
    if (R) add_values(e, R, e->reaction, &rows);
    if (R && acts) keep_for_w(e, e->at.count + i, e->reaction + k);
    if (!J) return;
    weigh_columns(&w, e, &e->nodes, i);
    blocks columns = columns_of(e, &w);
    columns.of[2] = (block){.first = 2 * d + 1,
                            .length = e->m,
                            .count = (uint32_t)acts,
                            .at = first + i * e->m,
                            .w = &ONE,
                            .unit = e->impulse_unit};
    columns.count = 3;
    add_entries(e, J, &e->joints->reaction, e->reaction, &rows, &columns);
}

/* phi at Gauss point i, behind the rows of g of constraint point i + 1 */
static void add_rolling(dm_lie_joints *e, double *R, double *J, uint32_t i, const double *V) {
    const uint32_t first = e->s * e->d;
    weights w = {0};
    const blocks rows = {.count = 1,
                         .of = {{.length = e->l,
                                 .count = 1,
                                 .at = first + i * e->m + e->k,
                                 .w = &ONE,
                                 .unit = e->row_unit + e->k}}};
    place(e, &e->rolls, i, V);
    if (R) dm_group_entries_eval(&e->joints->rolling, e->x, e->phi, J != NULL);
    if (R) add_values(e, R, e->phi, &rows);
    if (!J) return;
    weigh_columns(&w, e, &e->rolls, i);
    const blocks columns = columns_of(e, &w);
    add_entries(e, J, &e->joints->rolling, e->phi, &rows, &columns);
}

/* dtau_R(xi1)^T w into e->pull */
static void pull(dm_lie_joints *e, int with_entries, const double *z) {
    combine(e->xi, e, e->beta, e->h, z);
    memcpy(e->in, e->xi, e->d * sizeof *e->in);
    memcpy(e->in + e->d, e->w, e->d * sizeof *e->in);
    dm_group_entries_eval(&e->joints->pull, e->in, e->pull, with_entries);
}

/* - beta_j dtau_R(xi1)^T w; its derivative in w is that of what w is the sum of */
static void add_pull(dm_lie_joints *e, double *R, double *J, const double *z) {
    const uint32_t d = e->d, s = e->s;
    double minus[DM_QUADRATURE_NODES], of_xi[DM_QUADRATURE_NODES];
    for (uint32_t j = 0; j < s; j++) {
        minus[j] = -e->beta[j];
        of_xi[j] = e->h * e->beta[j];
    }
    const blocks rows = {.count = 1, .of = {{.length = d, .count = s, .stride = d, .w = minus}}};
    const blocks columns = {.count = 1, .of = {{.length = d, .count = s, .stride = d, .w = of_xi}}};
    if (R) pull(e, J != NULL, z);
    if (R) add_values(e, R, e->pull, &rows);
    if (J) add_entries(e, J, &e->joints->pull, e->pull, &rows, &columns);
}

/* rounding the element moves g by about G q, which is no error of the step */
static double position_size(const dm_lie_joints *e) {
    double most = 0.0;
    for (uint32_t i = 0; i < e->n; i++) most = dm_largest(most, e->state[i]);
    return e->k ? e->mass * most / fabs(e->h) : 0.0;
}

/* R NULL: the matrix of the outputs that lie there */
static void add_all(dm_lie_joints *e, double *R, double *J, const double *z) {
    for (uint32_t i = 0; i < e->at.count; i++) add_slope(e, R, J, i, z);
    for (uint32_t i = 0; i <= e->K && e->m; i++) add_reaction(e, R, J, i, z);
    for (uint32_t i = 0; i < e->K && e->l; i++) add_rolling(e, R, J, i, z);
    add_pull(e, R, J, z);
}

/* The map that w is taken by is known before w is: its entries come first. */
dm_status dm_lie_joints_equation(void *joints, double *R, double *J, const double *z) {
    dm_lie_joints *e = joints;
    memset(R, 0, e->N * sizeof *R);
    memcpy(e->w, e->state + e->n, e->d * sizeof *e->w);
    e->size = position_size(e);
    if (J) dm_step_matrix_zero(J, &e->step);
    if (J) pull(e, 1, z);
    add_all(e, R, J, z);
    e->evaluations += e->at.count;
    return DM_OK;
}

/* Numbers without meaning, different from each other and from zero. */
static void scatter(const dm_group_entries *f, double *out) {
    for (uint32_t i = 0; i < f->count; i++) out[f->values + i] = 1.5 + sin(1.0 + i);
}

void dm_lie_joints_pattern(dm_lie_joints *e, double *J) {
    scatter(e->along, e->slope);
    scatter(&e->joints->pull, e->pull);
    if (e->m) scatter(&e->joints->reaction, e->reaction);
    if (e->l) scatter(&e->joints->rolling, e->phi);
    for (uint32_t c = 0; c < e->m; c++) e->row_unit[c] = e->impulse_unit[c] = 1.0;
    memset(e->z, 0, e->N * sizeof *e->z);
    memset(J, 0, (size_t)e->N * e->N * sizeof *J);
    e->h = e->mass = 1.0;
    add_all(e, NULL, J, e->z);
}
