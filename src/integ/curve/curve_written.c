#include "integ/curve/curve_written.h"

#include "algebra/derive.h"
#include "integ/curve/curve_defect.h"
#include "integ/curve/curve_field.h"
#include "integ/method/cache.h"
#include "integ/method/quadrature.h"

#include <string.h>

enum { ENDS, GRADIENT, HESSIAN, KERNELS };
static const char maker;

/* nodes of the graph in hand */
typedef struct {
    dm_defect d;
    const dm_curve *c;
    const dm_curve_recipe *r;
    size_t n;
    uint32_t h, p1, p0, share, direction, held, along_by; /* inputs */
    uint32_t inputs;
    dm_quadrature gauss;
    dm_node
        *along[DM_RECIPE_DIRECTIONS + 1]; /* [n] a and its derivatives along formal directions */
    dm_node *w, *push;                    /* [N]; [n] work with w in it, NULL: none */
    dm_node *with, *asked, *answer; /* inputs of a substitution; of the call in hand; answers */
} writer;

/* ---- sizes ---- */

/* Exact to degree 2 r - 1: the action has the order of the method. */
static size_t gauss_nodes(const dm_curve *c) {
    return (size_t)(c->order + 1) / 2;
}

/* Formal directions are inputs of the graph, as many as any call asks for. */
static size_t most_directions(const dm_curve_recipe *r) {
    int most = 0;
    for (int i = 0; i < r->calls; i++)
        if (r->directions[i] > most) most = r->directions[i];
    return (size_t)most;
}

/* Those of the field, h, both momenta, shares; formal directions, formal work and a way along a
 * direction, which no caller sets. */
size_t dm_written_inputs(const dm_curve *c, const dm_model *m) {
    const size_t n = m->n,
                 formal = (2 * n + 1) * most_directions(c->recipe) + n * gauss_nodes(c) + 1;
    return dm_field_inputs(m) + 1 + 2 * n + (size_t)c->substeps + formal;
}

/* Of `ends`, `gradient` and `hessian` together. */
size_t dm_written_outputs(const dm_model *m) {
    const size_t n = m->n, rolling = m->constraints ? m->constraints->rolling : 0;
    return 4 * n + 1 + 2 * rolling + 2 * n + 8 * n * n;
}

/* In the arena of the model. */
static dm_node *take(const writer *b, size_t count) {
    return dm_defect_take(&b->d, count);
}

/* ---- the field at a point ---- */

/* every input as it is */
static void stand(const writer *b) {
    for (uint32_t i = 0; i < b->inputs; i++) b->with[i] = dm_input(b->d.g, i);
}

/* roots[count] at y[2n] and the time t, with directions[2n + 1] each */
static void put(const writer *b, dm_node *out, const dm_node *roots, size_t count, const dm_node *y,
                dm_node t, const dm_node *directions, int asked) {
    const size_t N = 2 * b->n;
    stand(b);
    memcpy(b->with, y, N * sizeof *y);
    b->with[N] = t;
    for (size_t i = 0; directions && i < (N + 1) * (size_t)asked; i++)
        b->with[b->direction + i] = directions[i];
    dm_substitute(b->d.g, roots, (uint32_t)count, b->with, out);
}

/* out[n] = d/ds f[n](y + s u, t + s dt) at s = 0, (u, dt) the formal direction of that number: one
 * sweep, where the Jacobian would need one for each entry of y and its derivatives N times as many
 * nodes */
static void differentiate(const writer *b, dm_node *out, const dm_node *f, size_t which) {
    const uint32_t n = (uint32_t)b->n, N = 2 * n, s = b->along_by;
    dm_graph *g = b->d.g;
    stand(b);
    for (uint32_t j = 0; j <= N; j++) {
        const dm_node u = dm_input(g, b->direction + (uint32_t)which * (N + 1) + j);
        b->with[j] = dm_add(g, dm_input(g, j), dm_mul(g, dm_input(g, s), u));
    }
    dm_substitute(g, f, n, b->with, b->asked);
    dm_jacobian(g, b->asked, n, s, 1, out);
    memcpy(b->asked, out, n * sizeof *out);
    stand(b);
    b->with[s] = dm_constant(g, 0.0);
    dm_substitute(g, b->asked, n, b->with, out);
}

/* w of the equations, put into the work; the acceleration and its derivatives */
static dm_status solve_field(writer *b) {
    const size_t n = b->n, N = b->d.N, most = most_directions(b->r);
    b->w = take(b, N);
    if (!b->w) return DM_NO_MEMORY;
    dm_status status = dm_defect_solve(&b->d, b->w);
    b->along[0] = b->w;
    for (size_t i = 1; status == DM_OK && i <= most; i++) {
        b->along[i] = take(b, n);
        if (!b->along[i]) return DM_NO_MEMORY;
        differentiate(b, b->along[i], b->along[i - 1], i - 1);
        status = dm_graph_status(b->d.g);
    }
    if (status != DM_OK || !b->d.push) return status;
    b->push = take(b, n);
    if (!b->push) return DM_NO_MEMORY;
    stand(b);
    for (size_t i = 0; i < N; i++) b->with[b->d.w + i] = b->w[i];
    dm_substitute(b->d.g, b->d.push, (uint32_t)n, b->with, b->push);
    return dm_graph_status(b->d.g);
}

/* ---- the method ---- */

/* inputs of the recipe: x, h, answers, t */
static void offer(const writer *b, const dm_node *x, dm_node length, dm_node t) {
    const size_t N = 2 * b->n;
    memcpy(b->with, x, N * sizeof *x);
    b->with[N] = length;
    memcpy(b->with + N + 1, b->answer, DM_CURVE_STAGES * N * sizeof *b->answer);
    b->with[N + 1 + DM_CURVE_STAGES * N] = t;
}

/* f, or a derivative of it, at what the call asks for: (x, t, directions) */
static void answer_call(const writer *b, dm_node *k, const dm_node *asked, int directions) {
    const size_t n = b->n, N = 2 * n;
    const dm_node *u = asked + N + 1, *velocity = directions ? u : asked;
    for (size_t i = 0; i < n; i++) k[i] = directions > 1 ? 0 : velocity[n + i];
    put(b, k + n, b->along[directions], n, asked, asked[N], u, directions);
}

/* x after a step of that length from x at t, into x itself */
static void step_method(const writer *b, dm_node *x, dm_node length, dm_node t) {
    const size_t N = 2 * b->n;
    const dm_node *out = b->r->out;
    memset(b->answer, 0, DM_CURVE_STAGES * N * sizeof *b->answer);
    for (int i = 0; i < b->r->calls; i++) {
        const size_t count = (N + 1) * (1 + (size_t)b->r->directions[i]);
        offer(b, x, length, t);
        dm_transplant(b->d.g, b->r->graph, out, (uint32_t)count, b->with, b->asked);
        answer_call(b, b->answer + (size_t)i * N, b->asked, b->r->directions[i]);
        out += count;
    }
    offer(b, x, length, t);
    dm_transplant(b->d.g, b->r->graph, out, (uint32_t)N, b->with, b->asked);
    memcpy(x, b->asked, N * sizeof *x);
}

/* x[2n] at the end of the curve from (q, v) over `part` of h, in substeps where there are some */
static void run(const writer *b, dm_node *x, double part) {
    dm_graph *g = b->d.g;
    const dm_node whole = dm_mul(g, dm_constant(g, part), dm_input(g, b->h));
    dm_node t = dm_input(g, b->d.t);
    dm_inputs(g, x, 0, (uint32_t)(2 * b->n));
    if (part == 0.0) return;
    if (!b->c->substeps) {
        step_method(b, x, whole, t);
        return;
    }
    for (int i = 0; i < b->c->substeps; i++) {
        const dm_node length = dm_mul(g, whole, dm_input(g, b->share + (uint32_t)i));
        step_method(b, x, length, t);
        t = dm_add(g, t, length);
    }
}

/* ---- what is made of the runs ---- */

/* all of a segment: ends x+, x- [2n], their distance from q [n] */
typedef struct {
    dm_node *after, *before, *plus, *minus;
    dm_node action, scalar; /* Ld; Ld + formal work . dq - p1 . plus + p0 . minus */
    dm_node *impulse;       /* [2][rolling] */
    dm_node *work;          /* [gauss][n] */
    dm_node *slope;         /* [2n] */
} segment;

/* q itself where the bias leaves one side without length: its distance is then a constant zero. */
static void find_ends(const writer *b, segment *s) {
    dm_graph *g = b->d.g;
    run(b, s->after, b->c->bias);
    run(b, s->before, b->c->bias - 1.0);
    for (uint32_t i = 0; i < b->n; i++) {
        s->plus[i] = dm_sub(g, s->after[i], dm_input(g, i));
        s->minus[i] = dm_sub(g, s->before[i], dm_input(g, i));
    }
}

/* h b times what rolling constraints do at a node, by time to both ends */
static void add_impulses(const writer *b, segment *s, const dm_node *y, dm_node t, dm_node weight,
                         double c) {
    dm_graph *g = b->d.g;
    const uint32_t rolling = b->d.rolling;
    dm_node *mu = s->impulse + 2 * rolling; /* scratch */
    if (!rolling) return;
    put(b, mu, b->w + b->d.N - rolling, rolling, y, t, NULL, 0);
    for (uint32_t i = 0; i < rolling; i++) {
        const dm_node all = dm_mul(g, weight, mu[i]);
        s->impulse[i] = dm_defect_add(g, s->impulse[i], dm_constant(g, 1.0 - c), all);
        s->impulse[rolling + i] = dm_defect_add(g, s->impulse[rolling + i], dm_constant(g, c), all);
    }
}

/* Ld and the virtual work at Gauss node i, to which the method is run */
static void add_node(const writer *b, segment *s, int i) {
    dm_graph *g = b->d.g;
    const double c = (double)b->gauss.c[i], part = b->c->bias - 1.0 + c;
    const dm_node h = dm_input(g, b->h);
    const dm_node weight = dm_mul(g, dm_constant(g, (double)b->gauss.b[i]), h);
    const dm_node t = dm_defect_add(g, dm_input(g, b->d.t), dm_constant(g, part), h);
    dm_node *y = s->slope, L; /* the slope is not known yet */
    run(b, y, part);
    put(b, &L, &b->d.L, 1, y, t, NULL, 0);
    s->action = dm_defect_add(g, s->action, weight, L);
    s->scalar = dm_defect_add(g, s->scalar, weight, L);
    add_impulses(b, s, y, t, weight, c);
    if (!b->push) return;
    dm_node *work = s->work + (size_t)i * b->n;
    put(b, work, b->push, b->n, y, t, NULL, 0);
    for (uint32_t k = 0; k < b->n; k++) {
        const dm_node formal = dm_input(g, b->held + (uint32_t)i * (uint32_t)b->n + k);
        s->scalar = dm_defect_add(g, s->scalar, dm_mul(g, weight, formal), y[k]);
    }
}

/* The gradient with the work held, which is put in afterwards: a one-form that need not be
 * closed. */
static void find_slope(const writer *b, segment *s) {
    dm_graph *g = b->d.g;
    const size_t N = 2 * b->n;
    for (uint32_t i = 0; i < b->n; i++) {
        const dm_node p1 = dm_input(g, b->p1 + i), p0 = dm_input(g, b->p0 + i);
        const dm_node back = dm_mul(g, p1, s->plus[i]);
        s->scalar = dm_sub(g, s->scalar, back);
        s->scalar = dm_defect_add(g, s->scalar, p0, s->minus[i]);
    }
    dm_gradient(g, s->scalar, 0, (uint32_t)N, s->slope);
    if (!b->push) return;
    stand(b);
    for (size_t i = 0; i < (size_t)b->gauss.r * b->n; i++) b->with[b->held + i] = s->work[i];
    memcpy(b->asked, s->slope, N * sizeof *s->slope);
    dm_substitute(g, b->asked, (uint32_t)N, b->with, s->slope);
}

/* Ends first, since p1 and p0 pull along their distances. */
static dm_status describe(writer *b, segment *s) {
    const size_t n = b->n, rolling = b->d.rolling;
    s->after = take(b, 2 * n);
    s->before = take(b, 2 * n);
    s->plus = take(b, n);
    s->minus = take(b, n);
    s->slope = take(b, 2 * n);
    s->work = take(b, (size_t)b->gauss.r * n);
    s->impulse = take(b, 3 * rolling);
    if (!s->after || !s->before || !s->plus || !s->minus || !s->slope || !s->work || !s->impulse)
        return DM_NO_MEMORY;
    memset(s->impulse, 0, 3 * rolling * sizeof *s->impulse);
    find_ends(b, s);
    for (int i = 0; i < b->gauss.r; i++) add_node(b, s, i);
    find_slope(b, s);
    return dm_graph_status(b->d.g);
}

/* ---- kernels ---- */

/* A kernel is known by the serial number of its recipe: another curve of the same place in memory
 * has another. */
static dm_status make(const writer *b, dm_kernel *out, const dm_node *roots, size_t count,
                      uint32_t which) {
    const dm_model *m = b->d.m;
    dm_status status = dm_graph_status(b->d.g);
    if (status == DM_OK)
        status = m->source.compile(out, b->d.g, roots, (uint32_t)count, m->source.arena);
    if (status == DM_OK) dm_cache_add(m, &maker, b->r->serial * KERNELS + which, out, 1);
    return status;
}

/* Velocities at both ends are the guess of the next step. */
static dm_status make_ends(const writer *b, dm_kernel *out, const segment *s, dm_node *roots) {
    const size_t n = b->n, rolling = b->d.rolling;
    memcpy(roots, s->plus, n * sizeof *roots);
    memcpy(roots + n, s->minus, n * sizeof *roots);
    memcpy(roots + 2 * n, s->after + n, n * sizeof *roots);
    memcpy(roots + 3 * n, s->before + n, n * sizeof *roots);
    roots[4 * n] = s->action;
    memcpy(roots + 4 * n + 1, s->impulse, 2 * rolling * sizeof *roots);
    return make(b, out, roots, 4 * n + 1 + 2 * rolling, ENDS);
}

/* The slope is no gradient where there is work, so that its derivatives are not symmetric. */
static dm_status make_all(const writer *b, dm_written *out, const segment *s) {
    const uint32_t n = (uint32_t)b->n, N = 2 * n;
    dm_node *roots = take(b, dm_written_outputs(b->d.m));
    if (!roots) return DM_NO_MEMORY;
    dm_status status = make_ends(b, &out->ends, s, roots);
    if (status == DM_OK) status = make(b, &out->gradient, s->slope, N, GRADIENT);
    if (status != DM_OK) return status;
    dm_jacobian(b->d.g, s->slope, N, 0, N, roots);
    dm_jacobian(b->d.g, s->plus, n, 0, N, roots + (size_t)N * N);
    dm_jacobian(b->d.g, s->minus, n, 0, N, roots + (size_t)N * N + (size_t)n * N);
    return make(b, &out->hessian, roots, 2 * (size_t)N * N, HESSIAN);
}

/* Behind those of curve_field.h, in the order of curve_written.h. */
static void place_inputs(writer *b, dm_written *out) {
    const size_t known = b->d.more;
    out->h = known;
    out->p1 = out->h + 1;
    out->p0 = out->p1 + b->n;
    out->share = out->p0 + b->n;
    b->h = (uint32_t)out->h;
    b->p1 = (uint32_t)out->p1;
    b->p0 = (uint32_t)out->p0;
    b->share = (uint32_t)out->share;
    b->direction = b->share + (uint32_t)b->c->substeps;
    b->held = b->direction + (uint32_t)((2 * b->n + 1) * most_directions(b->r));
    b->along_by = b->held + (uint32_t)(b->n * gauss_nodes(b->c));
}

/* All three or none. */
static int find(dm_written *out, const dm_model *m, const dm_curve_recipe *r) {
    return dm_cache_find(&out->ends, m, &maker, r->serial * KERNELS + ENDS) &&
           dm_cache_find(&out->gradient, m, &maker, r->serial * KERNELS + GRADIENT) &&
           dm_cache_find(&out->hessian, m, &maker, r->serial * KERNELS + HESSIAN);
}

/* The substitution buffer serves two graphs, this one and that of the recipe. */
static dm_status write_out(dm_written *out, writer *b) {
    const size_t N = 2 * b->n;
    segment s = {0};
    b->answer = take(b, DM_CURVE_STAGES * N);
    b->asked = take(b, (N + 1) * (1 + DM_RECIPE_DIRECTIONS));
    const size_t recipe = dm_graph_inputs(b->r->graph);
    b->with = take(b, b->inputs > recipe ? b->inputs : recipe);
    if (!b->answer || !b->asked || !b->with) return DM_NO_MEMORY;
    dm_status status = solve_field(b);
    if (status == DM_OK) status = describe(b, &s);
    return status == DM_OK ? make_all(b, out, &s) : status;
}

/* Where all kernels are known no graph is made. */
dm_status dm_written_build(dm_written *out, const dm_curve *c, const dm_model *m) {
    writer b = {.c = c, .r = c->recipe, .n = m->n, .inputs = (uint32_t)dm_written_inputs(c, m)};
    const size_t known = dm_field_inputs(m), runs = gauss_nodes(c) + 1 + (c->centred != 0);
    if (!m->source.graph || !m->source.compile) return DM_TOO_LARGE;
    b.d.more = (uint32_t)known;
    place_inputs(&b, out);
    out->inputs = b.inputs;
    out->calls = runs * (size_t)c->recipe->calls * (c->substeps ? (size_t)c->substeps : 1);
    if (find(out, m, c->recipe)) return DM_OK;
    dm_quadrature_gauss(&b.gauss, (int)gauss_nodes(c));
    const dm_status status = dm_defect_build(&b.d, m, b.inputs - (uint32_t)known);
    return status == DM_OK ? write_out(out, &b) : status;
}
