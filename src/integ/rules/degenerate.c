/* degenerate.c - L = alpha(q, t) . v - H(q, t), linear in v: guiding centres, Lotka-Volterra,
 * point vortices. Its equations are of first order, (d alpha^T - d alpha) v = -grad H, and p =
 * alpha(q) is a constraint on the momenta. Gauss collocation in position- momentum form leaves
 * that constraint with every step, and the parasitic motion off it is only neutrally stable; so
 * each step is projected, symmetrically (Kraus 2017, after Hairer 2000): with K = d alpha^T,
 * sigma = (-1)^s, q~ = q0 + h l,  p~ = alpha(q0) + h K(q0) l,   (q^, p^) = one Gauss step from
 * (q~, p~), q1 = q^ + h sigma l,  alpha(q1) = p^ + h sigma K(q1) l, solved for the stage
 * velocities V and the multiplier l together. Since L_q(q, l) - L_q(q, 0) = K(q) l, the stage
 * kernel gives all derivatives. `free` leaves l = 0: symplectic on T*Q, for comparison.
 * Long because it is one step equation, from its workspace to its Newton method. */
#include "base/doubles.h"
#include "integ/method/stage_table.h"
#include "linalg/lu.h"
#include "linalg/solve/newton.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* unknowns z = (V[s][n], l[n]), or V alone */
typedef struct {
    dm_stage_table table;
    const dm_model *m;
    uint32_t n, unknowns;
    int projected;
    double h, t, sigma, size;
    double scaled; /* the h of these: h a[s*s], h b_i (a_ij - b_j)[s*s], h b[s] */
    dm_weight *ha, *hw, *hb;
    const double *state;
    double *x;    /* [2n+1] arguments */
    double *rest; /* [n] what rounding took from the positions there */
    /* [width] outputs of the stage kernel, and what L_v lacks[n]: at a point, at (q0, 0), at (q1,
     * l) */
    double *at, *begin, *end;
    double *still; /* [width] at (q1, 0) */
    double *shift; /* [n] q^ - q0 */
    double *dp;    /* [n] h sum b_i L_q(i) */
    double *turn;  /* [n] h K(q0) l */
    double *W, *U; /* [n*n] */
    double *z, *next, *scratch;
    long evaluations;
} degenerate;

/* The first argument. */
static int stages(const dm_rule *rule) {
    return (int)rule->arg[0].number;
}

/* The second one is there, which can only be the word. */
static int is_free(const dm_rule *rule) {
    return rule->count == 2;
}

static const char *check(const dm_rule *rule) {
    enum { MOST = 16 };
    const double s = rule->arg[0].number;
    if (rule->count < 1 || rule->count > 2 || rule->arg[0].rule || !(s >= 1 && s <= MOST) ||
        s != floor(s))
        return "degenerate takes one whole number of stages from 1 to 16";
    if (is_free(rule) && (!rule->arg[1].rule || strcmp(rule->arg[1].rule->name, "free") != 0))
        return "the second argument of degenerate can only be the word free";
    return NULL;
}

/* The two-form is antisymmetric: of an odd number of coordinates it is singular. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!(m->structure & DM_LINEAR_IN_V))
        return "L is not linear in v; this rule is for L = alpha(q) . v - H(q) alone, gauss(s) is "
               "for a regular L";
    if (m->n % 2)
        return "the number of coordinates is odd: the two-form of alpha is then singular, and the "
               "motion is not determined";
    return NULL;
}

static int order(const dm_rule *rule) {
    return 2 * stages(rule);
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_STAGE;
}

/* V[s][n], and l[n] where steps are projected. */
static size_t unknowns_of(const dm_rule *rule, const dm_model *m) {
    return ((size_t)stages(rule) + !is_free(rule)) * m->n;
}

/* The arrays of the struct in its order, Newton's method at the end. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, s = (size_t)stages(rule), width = 3 * n + 3 * n * n;
    const size_t z = unknowns_of(rule, m);
    return dm_doubles(sizeof(degenerate)) + dm_stage_table_size(s, s) + 2 * (2 * s * s + s) +
           4 * n + 1 + 4 * width + 2 * n + 2 * n * n + z + 4 * n + dm_newton_work((uint32_t)z);
}

/* A product of h and a coefficient in two parts: h times one has roundings with a mean by a decimal
 * h, and momentum maps drifted. */
static void scale(degenerate *g, double h) {
    const dm_stage_table *t = &g->table;
    const uint32_t s = t->s;
    if (g->scaled == h) return;
    for (uint32_t i = 0; i < s; i++) {
        const long double hb = h * dm_weight_exact(t->b[i]);
        g->hb[i] = dm_weight_of(hb);
        for (uint32_t j = 0; j < s; j++) {
            const long double a = dm_weight_exact(t->a[i * s + j]);
            g->ha[i * s + j] = dm_weight_of(h * a);
            g->hw[i * s + j] = dm_weight_of(hb * (a - dm_weight_exact(t->b[j])));
        }
    }
    g->scaled = h;
}

/* sigma = (-1)^s makes the projection symmetric: the stability function of Gauss collocation at
 * infinity. */
static dm_status open(dm_stepper *stepper) {
    degenerate *g = (degenerate *)(void *)stepper->work;
    const dm_model *m = stepper->model;
    const size_t n = m->n, width = 3 * n + 3 * n * n;
    double *memory = stepper->work + dm_doubles(sizeof *g);
    dm_quadrature q;
    dm_galerkin basis;
    dm_quadrature_gauss(&q, stages(stepper->rule));
    dm_galerkin_collocation(&basis, &q);
    *g = (degenerate){.m = m, .n = m->n, .projected = !is_free(stepper->rule)};
    g->unknowns = (uint32_t)unknowns_of(stepper->rule, m);
    g->sigma = basis.s % 2 ? -1.0 : 1.0;
    dm_stage_table_fill(&g->table, &basis, memory);
    memory += dm_stage_table_size(g->table.s, g->table.r);
    const size_t s = g->table.s;
    g->scaled = NAN;
    g->ha = (dm_weight *)(void *)dm_take(&memory, 2 * s * s);
    g->hw = (dm_weight *)(void *)dm_take(&memory, 2 * s * s);
    g->hb = (dm_weight *)(void *)dm_take(&memory, 2 * s);
    g->x = dm_take(&memory, 2 * n + 1);
    g->rest = dm_take(&memory, n);
    g->at = dm_take(&memory, width);
    g->begin = dm_take(&memory, width);
    g->end = dm_take(&memory, width);
    g->still = dm_take(&memory, width);
    g->shift = dm_take(&memory, n);
    g->dp = dm_take(&memory, n);
    g->turn = dm_take(&memory, n);
    g->W = dm_take(&memory, n * n);
    g->U = dm_take(&memory, n * n);
    g->z = dm_take(&memory, g->unknowns);
    g->next = dm_take(&memory, 4 * n);
    g->scratch = memory;
    for (double *out = g->at; out < g->shift; out += width) dm_kernel_prepare(&m->stage, out);
    return DM_OK;
}

/* parts of the outputs */
static const double *qq_of(const degenerate *g, const double *out) {
    return out + 2 * g->n;
}
static const double *K_of(const degenerate *g, const double *out) { /* row q, column v */
    return out + 2 * g->n + (size_t)g->n * g->n;
}

/* what L_v lacks */
static double *low_of(const degenerate *g, double *out) {
    return out + 2 * g->n + 3 * (size_t)g->n * g->n;
}

/* The kernel sees positions that are rounded, and Newton's method would stop up to half a unit of
 * the last place of q1 from the root, on the side that it comes from. L_q becomes that at x + rest,
 * to first order, and what L_v lacks is kept beside it. */
static void add_rounded(const degenerate *g, double *out, const double *rest) {
    const uint32_t n = g->n;
    const double *qq = qq_of(g, out), *K = K_of(g, out);
    double *low = low_of(g, out);
    memset(low, 0, n * sizeof *low);
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = 0; i < n && rest[k] != 0.0; i++) {
            out[i] += qq[i * (size_t)n + k] * rest[k];
            low[i] += K[k * (size_t)n + i] * rest[k];
        }
}

/* the stage kernel at (q0 + shift, v, t + after) */
static void evaluate(degenerate *g, double *out, const double *shift, const double *v,
                     double after) {
    const uint32_t n = g->n;
    const double *low = g->state + 2 * n;
    for (uint32_t k = 0; k < n; k++) {
        const double d = shift ? low[k] + shift[k] : low[k];
        g->x[k] = g->state[k] + d;
        g->rest[k] = d - (g->x[k] - g->state[k]);
        g->x[n + k] = v ? v[k] : 0.0;
    }
    g->x[2 * n] = g->t + after;
    dm_kernel_eval(&g->m->stage, g->x, out);
    add_rounded(g, out, g->rest);
    g->evaluations++;
}

/* out += w B x, or w B^T x */
static void multiply(double *out, double w, const double *B, const double *x, uint32_t n,
                     int transposed) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            out[i] += w * B[transposed ? j * (size_t)n + i : i * (size_t)n + j] * x[j];
}

/* the block of J at (row, column), in units of n */
static double *block(const degenerate *g, double *J, uint32_t row, uint32_t column) {
    return J + row * (size_t)g->n * g->unknowns + column * (size_t)g->n;
}

/* The block `to` of J += w B, or w B^T. */
static void add(const degenerate *g, double *to, double w, const double *B, int transposed) {
    const uint32_t n = g->n;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            to[i * (size_t)g->unknowns + j] +=
                w * B[transposed ? j * (size_t)n + i : i * (size_t)n + j];
}

/* ---- one point: its part of the stage equations, of dp, and of their derivatives ---- */

static void place(degenerate *g, uint32_t i, const double *z) {
    const uint32_t n = g->n, s = g->table.s;
    const double *l = z + s * (size_t)n;
    double *shift = g->next; /* free until the end of the step */
    for (uint32_t k = 0; k < n; k++) shift[k] = g->projected ? g->h * l[k] : 0.0;
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++)
            shift[k] += dm_weighted(g->ha[i * s + j], z[j * (size_t)n + k]);
    evaluate(g, g->at, shift, z + i * (size_t)n, g->h * dm_weight_double(g->table.c[i]));
}

/* entry k of L_v - p~ at the point in hand, p~ = p0 + h K(q0) l: what is large is subtracted first,
 * before anything is rounded */
static double momentum(const degenerate *g, uint32_t k) {
    const uint32_t n = g->n;
    const double *p0 = g->state + n, *low = g->state + 3 * n, L_v = g->at[n + k];
    const double rest = low_of(g, g->at)[k];
    if (!g->projected) return (L_v - p0[k]) + (rest - low[k]);
    return (L_v - g->begin[n + k]) + (rest - low_of(g, g->begin)[k] - g->turn[k]);
}

/* b_i [h (a_ij - b_j) L_q(i) + delta_ij (L_v(i) - p~)] and h b_i L_q(i) */
static void add_values(degenerate *g, double *r, uint32_t i) {
    const uint32_t n = g->n, s = g->table.s;
    const double b = dm_weight_double(g->table.b[i]);
    for (uint32_t k = 0; k < n; k++) g->dp[k] += dm_weighted(g->hb[i], g->at[k]);
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++) {
            const double force = dm_weighted(g->hw[i * s + j], g->at[k]);
            r[j * (size_t)n + k] += i == j ? force + b * momentum(g, k) : force;
            g->size = fmax(g->size, fabs(force) + (i == j ? fabs(b * g->at[n + k]) : 0.0));
        }
}

/* rows j and, in row s, h b_i L_q(i); columns V_k through a_ik and V_i, l through q~ */
static void add_slopes(degenerate *g, double *J, uint32_t i) {
    const uint32_t s = g->table.s, columns = s + (g->projected ? 1 : 0);
    const double b = dm_weight_double(g->table.b[i]);
    for (uint32_t j = 0; j < columns; j++) {
        const double a =
            j < s ? dm_weight_double(g->table.a[i * s + j]) - dm_weight_double(g->table.b[j]) : 1.0;
        const double w = b * g->h * a;
        for (uint32_t k = 0; k < columns; k++) {
            const double ha = g->h * (k < s ? dm_weight_double(g->table.a[i * s + k]) : 1.0);
            double *to = block(g, J, j, k);
            add(g, to, w * ha, qq_of(g, g->at), 0);
            if (k == i) add(g, to, w, K_of(g, g->at), 0);
            if (j == i) add(g, to, b * ha, K_of(g, g->at), 1);
        }
    }
}

/* ---- the ends ---- */

/* h K(q0) l, which the stage equations have in p~ */
static void take_start(degenerate *g, double *J, const double *z) {
    const uint32_t n = g->n, s = g->table.s;
    if (!g->projected) return;
    memset(g->turn, 0, n * sizeof *g->turn);
    multiply(g->turn, g->h, K_of(g, g->begin), z + s * (size_t)n, n, 0);
    for (uint32_t j = 0; J && j < s; j++)
        add(g, block(g, J, j, s), -dm_weight_double(g->hb[j]), K_of(g, g->begin), 0);
}

/* q1 - q0 = h sum b_j V_j + h (1 + sigma) l */
static void find_shift(degenerate *g, const double *z) {
    const uint32_t n = g->n, s = g->table.s;
    const double *l = z + s * (size_t)n;
    for (uint32_t k = 0; k < n; k++)
        g->shift[k] = g->projected ? g->h * (1.0 + g->sigma) * l[k] : 0.0;
    for (uint32_t j = 0; j < s; j++)
        for (uint32_t k = 0; k < n; k++) g->shift[k] += dm_weighted(g->hb[j], z[j * (size_t)n + k]);
}

/* p^ + h sigma K(q1) l - alpha(q1), in row s; p^ = alpha(q0) + h K(q0) l + dp */
static void close_end(degenerate *g, double *r, double *J, const double *z) {
    const uint32_t n = g->n, s = g->table.s;
    const double *l = z + s * (size_t)n, hs = g->h * g->sigma;
    double *end = r + s * (size_t)n;
    find_shift(g, z);
    evaluate(g, g->end, g->shift, l, g->h);
    evaluate(g, g->still, g->shift, NULL, g->h);
    for (uint32_t k = 0; k < n; k++)
        end[k] = (g->begin[n + k] - g->still[n + k]) +
                 (low_of(g, g->begin)[k] - low_of(g, g->still)[k] + g->dp[k] + g->turn[k] +
                  hs * (g->end[k] - g->still[k]));
    if (!J) return;
    add(g, block(g, J, s, s), g->h, K_of(g, g->begin), 0);
    add(g, block(g, J, s, s), hs, K_of(g, g->still), 0);
    for (uint32_t k = 0; k <= s; k++) { /* by way of q1 */
        const double w = g->h * (k < s ? dm_weight_double(g->table.b[k]) : 1.0 + g->sigma);
        add(g, block(g, J, s, k), w * hs, qq_of(g, g->end), 0);
        add(g, block(g, J, s, k), -w * hs, qq_of(g, g->still), 0);
        add(g, block(g, J, s, k), -w, K_of(g, g->still), 1);
    }
}

/* For dm_newton: points first, since dp and the end need all of them. */
static dm_status equation(void *ctx, double *r, double *J, const double *z) {
    degenerate *g = ctx;
    g->size = 0.0;
    memset(r, 0, g->unknowns * sizeof *r);
    memset(g->dp, 0, g->n * sizeof *g->dp);
    if (J) memset(J, 0, (size_t)g->unknowns * g->unknowns * sizeof *J);
    take_start(g, J, z);
    for (uint32_t i = 0; i < g->table.s; i++) {
        place(g, i, z);
        add_values(g, r, i);
        if (J) add_slopes(g, J, i);
    }
    if (g->projected) close_end(g, r, J, z);
    return DM_OK;
}

/* V_j = v with (K^T - K) v = L_q(q0, 0), the equation of motion; l = 0 */
static dm_status guess(degenerate *g) {
    const uint32_t n = g->n;
    const double *K = K_of(g, g->begin);
    uint32_t *pivot = (uint32_t *)(void *)g->U;
    evaluate(g, g->begin, NULL, NULL, 0.0);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            g->W[i * (size_t)n + j] = K[j * (size_t)n + i] - K[i * (size_t)n + j];
    const dm_status status = dm_lu_factor(g->W, pivot, n);
    memset(g->z, 0, g->unknowns * sizeof *g->z);
    for (uint32_t j = 0; j < g->table.s && status == DM_OK; j++) {
        memcpy(g->z + j * (size_t)n, g->begin, n * sizeof *g->z);
        dm_lu_solve(g->z + j * (size_t)n, g->W, pivot, n);
    }
    return status;
}

/* q1 = q0 + shift; p1 = alpha(q1), or p0 + dp when it is free */
static dm_status finish(degenerate *g) {
    const uint32_t n = g->n;
    find_shift(g, g->z);
    memcpy(g->next, g->state, 4 * (size_t)n * sizeof *g->next);
    dm_sum_add_n(g->next, g->next + 2 * n, g->shift, n);
    if (g->projected) {
        evaluate(g, g->still, g->shift, NULL, g->h);
        memcpy(g->next + n, g->still + n, n * sizeof *g->next);
        memcpy(g->next + 3 * n, low_of(g, g->still), n * sizeof *g->next);
    } else {
        dm_sum_add_n(g->next + n, g->next + 3 * n, g->dp, n);
    }
    for (uint32_t k = 0; k < 4 * n; k++)
        if (!isfinite(g->next[k])) return DM_NOT_FINITE;
    return DM_OK;
}

/* The state is overwritten last; nothing is left to the next step. */
static dm_status step(dm_stepper *stepper, double *state, double t, double h) {
    degenerate *g = (degenerate *)(void *)stepper->work;
    dm_newton_report report = {0};
    const dm_newton_problem problem = {.m = g->unknowns,
                                       .equation = equation,
                                       .ctx = g,
                                       .size = &g->size,
                                       .place = state,
                                       .places = g->n,
                                       .shared = g->projected ? g->n : 0,
                                       .over = h,
                                       .tolerance = stepper->tolerance,
                                       .max_iterations = stepper->max_iterations};
    g->state = state;
    g->t = t;
    g->h = h;
    scale(g, h);
    g->evaluations = 0;
    dm_status status = guess(g);
    if (status == DM_OK) status = dm_newton(g->z, &problem, g->scratch, &report);
    if (status == DM_OK) status = finish(g);
    stepper->report.iterations = report.iterations;
    stepper->report.residual = report.residual;
    stepper->report.solves++;
    stepper->report.newton += report.iterations;
    stepper->report.matrices += report.jacobians;
    stepper->report.evaluations += g->evaluations;
    if (status == DM_OK) memcpy(state, g->next, 4 * (size_t)g->n * sizeof *state);
    return status;
}

static const char *why(dm_stepper *stepper, const double *state, dm_status status) {
    (void)stepper, (void)state;
    if (status != DM_SINGULAR) return NULL;
    return "the two-form d alpha of L = alpha(q) . v - H(q) is singular there, so that the motion "
           "is not determined: is alpha more than the gradient of a function, has every coordinate "
           "a partner?";
}

static const dm_engine engine = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .why = why,
};

const dm_method dm_method_degenerate = {
    .name = "degenerate",
    .signature = "degenerate(s [, free])",
    .doc = "For L = alpha(q) . v - H(q), linear in v (guiding centres, Lotka-Volterra, vortices): "
           "Gauss collocation with s stages in position-momentum form, every step projected "
           "symmetrically onto p = alpha(q); order 2 s, symmetric; the form d alpha is kept up to "
           "a defect of higher order than the error (s = 1: about h^6 a step); (s + 1) n unknowns "
           "a step. It starts from q alone. free leaves the projection out: symplectic on T*Q, but "
           "p - alpha(q) and with it the order are not kept, which is what the projection is for "
           "(Kraus 2017; Hairer 2000).",
    .orders = "2 s",
    .stages = "s",
    .cost = "(s + 1) n unknowns",
    .instances = "",
    .traits = DM_SYMMETRIC | DM_DEGENERATE,
    .engine = &engine,
    .check = check,
    .order = order,
};
