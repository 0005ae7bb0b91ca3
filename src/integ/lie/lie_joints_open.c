/* lie_joints_open.c - coefficients and workspace of lie(s) with constraints. */
#include "base/doubles.h"
#include "integ/constrained/constrained.h"
#include "integ/lie/lie_joints_inside.h"

#include <math.h>
#include <string.h>

/* ---- coefficients ---- */

static void take_points(dm_lie_points *p, uint32_t count, uint32_t s, dm_layout *to) {
    p->count = count;
    p->a = dm_layout_take(to, (size_t)count * s);
    p->d = dm_layout_take(to, (size_t)count * s);
    p->c = dm_layout_take(to, count);
}

/* in doubles: what is rounded alike everywhere stays variational */
static void fill_points(dm_lie_points *p, const dm_galerkin *g, const long double *c) {
    long double value[DM_QUADRATURE_NODES], integral[DM_QUADRATURE_NODES];
    for (uint32_t i = 0; i < p->count; i++) {
        dm_lagrange(value, integral, g->node, g->s, c[i]);
        p->c[i] = (double)c[i];
        for (int j = 0; j < g->s; j++) {
            p->a[i * (uint32_t)g->s + (uint32_t)j] = (double)integral[j];
            p->d[i * (uint32_t)g->s + (uint32_t)j] = (double)value[j];
        }
    }
}

/* integrals of polynomials through c[count] up to the inner constraint points, over weights[count]
 * where these are there */
static void fill_inner(double *out, const dm_lie_joints *e, const long double *c, int count,
                       const long double *weights) {
    long double value[DM_QUADRATURE_NODES], integral[DM_QUADRATURE_NODES];
    for (uint32_t k = 1; k < e->K; k++)
        for (int i = 0; i < count; i++) {
            if (i == 0) dm_lagrange(value, integral, c, count, (long double)e->nodes.c[k]);
            *out++ = (double)(weights ? integral[i] / weights[i] : integral[i]);
        }
}

static void fill(dm_lie_joints *e, const dm_galerkin *g) {
    dm_quadrature q = g->q;
    long double value[DM_QUADRATURE_NODES], beta[DM_QUADRATURE_NODES];
    fill_points(&e->at, g, q.c);
    for (int i = 0; i < q.r; i++) e->b[i] = (double)q.b[i];
    dm_lagrange(value, beta, g->node, g->s, 1.0L);
    for (int j = 0; j < g->s; j++) e->beta[j] = (double)beta[j];
    if (!e->K) return;
    dm_quadrature_lobatto(&q, (int)e->K + 1);
    fill_points(&e->nodes, g, q.c);
    fill_inner(e->inner_force, e, g->q.c, g->q.r, NULL);
    fill_inner(e->inner_impulse, e, q.c, q.r, q.b);
    dm_quadrature_gauss(&q, (int)e->K);
    fill_points(&e->rolls, g, q.c);
}

/* ---- workspace ---- */

/* K is that of rules of stages; without constraints there are no constraint points. */
static dm_lie_joints sizes(const dm_galerkin *g, const dm_model *m) {
    const dm_constraints *c = m->constraints;
    dm_lie_joints e = {.model = m,
                       .joints = &m->group->joints,
                       .constraints = c,
                       .n = m->n,
                       .d = dm_momenta(m),
                       .s = (uint32_t)g->s};
    e.along = e.s == 1 ? &e.joints->line : &e.joints->slope;
    e.k = c ? c->holonomic : 0;
    e.l = c ? c->rolling : 0;
    e.m = e.k + e.l;
    e.K = e.m ? dm_constrained_nodes(g) - 1 : 0;
    e.N = e.s * e.d + e.K * e.m;
    e.at.count = (uint32_t)g->q.r;
    return e;
}

size_t dm_lie_joints_memory_size(const dm_lie_joints *e) {
    return dm_lie_joints_kept(e) + DM_LIE_JOINTS_KEPT * (size_t)e->N;
}

static void lay_out_outputs(dm_lie_joints *e, dm_layout *to) {
    const size_t n = e->n;
    e->slope = dm_layout_take(to, dm_group_entries_size(e->along));
    e->reaction = dm_layout_take(to, dm_group_entries_size(&e->joints->reaction));
    e->phi = dm_layout_take(to, dm_group_entries_size(&e->joints->rolling));
    e->pull = dm_layout_take(to, dm_group_entries_size(&e->joints->pull));
    e->hidden = dm_layout_take(to, dm_group_entries_size(&e->joints->hidden));
    e->holonomic = dm_layout_take(to, e->k * (n + 2));
    e->rolling = dm_layout_take(to, e->l * (3 * n + 1));
}

/* Newton's methods with a look at the whole matrix before, the Legendre transform, a look at the
 * rank of the constraints take turns. */
static size_t work(const dm_lie_joints *e) {
    const uint32_t closing = e->d + e->m;
    const size_t rank = e->m ? dm_constraints_dependent_work(e->constraints) : 0;
    const size_t newton = dm_larger(dm_newton_work(e->N), dm_newton_work(closing));
    const size_t looking = (size_t)e->N * e->N + 2 * (size_t)e->N;
    const size_t legendre = dm_legendre_work(e->model) + 4 * (size_t)e->n;
    return dm_larger(dm_larger(dm_larger(newton, looking), dm_larger(legendre, rank)),
                     dm_lie_joints_crossing_work(e));
}

/* all arrays of *e, whose sizes are known, `work` last; returns how many doubles that took */
static size_t lay_out(dm_lie_joints *e, double *memory) {
    dm_layout to = {memory, 0};
    const size_t n = e->n, d = e->d, s = e->s, m = e->m;
    const uint32_t controls = e->constraints ? e->constraints->controls : 0;
    take_points(&e->at, e->at.count, e->s, &to);
    take_points(&e->nodes, e->K ? e->K + 1 : 0, e->s, &to);
    take_points(&e->rolls, e->K, e->s, &to);
    e->b = dm_layout_take(&to, e->at.count);
    e->beta = dm_layout_take(&to, s);
    e->x = dm_layout_take(&to, n + 3 * d + 1 + m + controls);
    e->v = dm_layout_take(&to, dm_larger(e->K, 1) * n);
    e->inner_force = dm_layout_take(&to, (size_t)e->K * e->at.count);
    e->inner_impulse = dm_layout_take(&to, (size_t)e->K * (e->K + 1));
    e->of_e = dm_layout_take(&to, (e->at.count + e->K + 1) * d);
    lay_out_outputs(e, &to);
    e->pull_first = (uint32_t *)(void *)dm_layout_take(&to, d + 1);
    e->pull_entry = (uint32_t *)(void *)dm_layout_take(&to, e->joints->pull.count);
    e->z = dm_layout_take(&to, e->N);
    e->w = dm_layout_take(&to, d);
    e->xi = dm_layout_take(&to, d);
    e->last = dm_layout_take(&to, d + m);
    e->in = dm_layout_take(&to, n + 2 * d + 1 + m);
    e->end = dm_layout_take(&to, n + d + e->joints->arcs);
    e->row_unit = dm_layout_take(&to, m);
    e->impulse_unit = dm_layout_take(&to, m);
    e->end_x = dm_layout_take(&to, 2 * n + 1 + m + controls);
    e->momenta = dm_layout_take(&to, (e->K + 1) * m);
    e->memory = dm_layout_take(&to, dm_lie_joints_memory_size(e));
    e->work = dm_layout_take(&to, work(e));
    return to.used;
}

size_t dm_lie_joints_work(const dm_rule *rule, const dm_model *m) {
    dm_galerkin g;
    dm_stage_basis(&g, rule, m);
    dm_lie_joints e = sizes(&g, m);
    return dm_doubles(sizeof e) + dm_step_matrix_work(e.N) + dm_step_matrix_work(e.d + e.m) +
           lay_out(&e, NULL);
}

/* constant outputs of the kernels, once */
static void prepare(dm_lie_joints *e) {
    const dm_group_joints *j = e->joints;
    dm_group_entries_prepare(e->along, e->slope);
    dm_group_entries_prepare(&j->pull, e->pull);
    dm_kernel_prepare(&j->finish, e->end);
    if (e->m) dm_group_entries_prepare(&j->reaction, e->reaction);
    if (e->m) dm_group_entries_prepare(&j->hidden, e->hidden);
    if (e->l) dm_group_entries_prepare(&j->rolling, e->phi);
    if (e->k) dm_kernel_prepare(&e->constraints->holonomic_kernel, e->holonomic);
    if (e->l) dm_kernel_prepare(&e->constraints->rolling_kernel, e->rolling);
}

/* entries of pull by the columns of w, as a sparse matrix by columns */
static void sort_pull(dm_lie_joints *e) {
    const dm_group_entries *f = &e->joints->pull;
    uint32_t count = 0;
    for (uint32_t column = 0; column < e->d; column++) {
        e->pull_first[column] = count;
        for (uint32_t i = 0; i < f->count; i++)
            if (f->column[i] == e->d + column) e->pull_entry[count++] = i;
    }
    e->pull_first[e->d] = count;
}

/* dense, and narrow where a look at the entries says that it pays */
static void open_matrices(dm_lie_joints *e, double *memory) {
    const uint32_t closing = e->d + e->m;
    double *J = e->work;
    dm_step_matrix_open(&e->step, e->N, memory);
    dm_step_matrix_open(&e->closing, closing, memory + dm_step_matrix_work(e->N));
    dm_lie_joints_pattern(e, J);
    dm_step_matrix_narrow(&e->step, J, (uint32_t *)(void *)(J + (size_t)e->N * e->N));
    if (!e->m) return;
    dm_lie_joints_closing_pattern(e, J);
    dm_step_matrix_narrow(&e->closing, J, (uint32_t *)(void *)(J + (size_t)closing * closing));
}

dm_status dm_lie_joints_open(dm_stepper *s) {
    dm_galerkin g;
    dm_lie_joints *e = dm_lie_joints_of(s);
    dm_stage_basis(&g, s->rule, s->model);
    *e = sizes(&g, s->model);
    double *matrices = s->work + dm_doubles(sizeof *e);
    const size_t taken = dm_step_matrix_work(e->N) + dm_step_matrix_work(e->d + e->m);
    lay_out(e, matrices + taken);
    fill(e, &g);
    sort_pull(e);
    open_matrices(e, matrices);
    prepare(e);
    memset(e->memory, 0, dm_lie_joints_memory_size(e) * sizeof *e->memory);
    s->report.operations =
        (e->along->map.columns ? &e->along->map.row : &e->along->kernel)->operations;
    return DM_OK;
}
