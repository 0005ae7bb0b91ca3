/* curve_order.c - the order of a Runge-Kutta method by its order conditions (Butcher; HNW I,
 * II.2): for every rooted tree t of order up to p, sum_i b_i phi_i(t) = 1/gamma(t). With t =
 * [t_1, ..., t_m]: phi_i(t) = prod_k sum_j a_ij phi_j(t_k) and gamma(t) = |t| prod_k gamma(t_k). */
#include "integ/curve/curve_written.h"

#include <math.h>
#include <string.h>

enum { HIGHEST = 8, TREES = 85 };  /* trees of order below 8 */
static const double EXACT = 1e-10; /* coefficients are doubles, up to about 30 */

typedef struct {
    const dm_curve *c;
    int count, order;                     /* trees so far; of those that are made */
    int orders[TREES];                    /* growing */
    double gamma[TREES];                  /* of tree k */
    double grown[TREES][DM_CURVE_STAGES]; /* sum_j a_ij phi_j of tree k */
    double defect;
} forest;

/* a tree of the order that is made */
static void add_tree(forest *f, const double *phi, double gamma) {
    const int s = f->c->s, k = f->count;
    double sum = 0.0;
    for (int i = 0; i < s; i++) sum += f->c->plus[i] * phi[i];
    f->defect = fmax(f->defect, fabs(sum - 1.0 / gamma));
    if (f->order == HIGHEST) return;
    f->orders[k] = f->order;
    f->gamma[k] = gamma;
    for (int i = 0; i < s; i++) {
        f->grown[k][i] = 0.0;
        for (int j = 0; j < i; j++) f->grown[k][i] += f->c->a[i][j] * phi[j];
    }
    f->count++;
}

/* branches of order `left` in all, none with a number above `last` */
static void branch(forest *f, const double *phi, double gamma, int left, int last) {
    double grown[DM_CURVE_STAGES];
    if (left == 0) {
        add_tree(f, phi, gamma);
        return;
    }
    for (int k = 0; k <= last && f->orders[k] <= left; k++) {
        for (int i = 0; i < f->c->s; i++) grown[i] = phi[i] * f->grown[k][i];
        branch(f, grown, gamma * f->gamma[k], left - f->orders[k], k);
    }
}

/* Trees are made order by order, each from those before it, until one of their conditions fails. */
int dm_curve_conditions(const dm_curve *c, double *defect) {
    forest f = {.c = c};
    double one[DM_CURVE_STAGES];
    for (int i = 0; i < c->s; i++) one[i] = 1.0;
    for (f.order = 1; f.order <= HIGHEST; f.order++) {
        f.defect = 0.0;
        branch(&f, one, f.order, f.order - 1, f.count - 1);
        if (defect) *defect = f.defect;
        if (!(f.defect <= EXACT)) break;
    }
    return f.order - 1;
}

/* ---- what no conditions are at hand for: measured ---- */

/* q'' = -sin q + q^2/3, y = (q, v), one step of the method with bias 1 */
static void test_step(double *y, const dm_curve *c, double h) {
    double v[DM_CURVE_STAGES], a[DM_CURVE_STAGES], end[2] = {y[0], y[1]};
    for (int i = 0; i < c->s; i++) {
        double q = y[0];
        v[i] = y[1];
        for (int j = 0; j < i; j++) {
            q += h * c->a[i][j] * v[j] + h * h * c->lift[i][j] * a[j];
            v[i] += h * c->push[i][j] * a[j];
        }
        a[i] = q * q / 3.0 - sin(q);
        end[0] += h * c->plus[i] * v[i] + h * h * c->plus_lift[i] * a[i];
        end[1] += h * c->arrival[i] * a[i];
    }
    memcpy(y, end, sizeof end);
}

/* what makes a step of h of two such coordinates, y = (q, v) */
typedef struct {
    const dm_curve *tableau;
    const dm_written *written; /* where there is no tableau */
    double *x, *out;           /* of its kernels */
} stepping;

/* Coordinates of the test do not see each other, but a method may mix them in a norm. */
static void make_step(double y[4], const stepping *s, double h) {
    if (s->tableau) {
        for (int i = 0; i < 2; i++) {
            double one[2] = {y[i], y[2 + i]};
            test_step(one, s->tableau, h);
            y[i] = one[0];
            y[2 + i] = one[1];
        }
        return;
    }
    memcpy(s->x, y, 4 * sizeof *y);
    s->x[s->written->h] = h;
    dm_kernel_eval(&s->written->ends, s->x, s->out);
    for (int i = 0; i < 2; i++) {
        y[i] += s->out[i];
        y[2 + i] = s->out[4 + i];
    }
}

/* error of one step, added up over some starts */
static double local_error(const stepping *s, const stepping *fine, double h) {
    enum { STARTS = 7, FINE = 32 };
    double sum = 0.0;
    for (int k = 0; k < STARTS; k++) {
        double y[4] = {cos(1.7 * k), sin(0.9 * k), sin(1.1 * k), cos(2.3 * k)}, goal[4];
        memcpy(goal, y, sizeof goal);
        make_step(y, s, h);
        for (int i = 0; i < FINE; i++) make_step(goal, fine, h / FINE);
        for (int i = 0; i < 4; i++) sum += fabs(y[i] - goal[i]);
    }
    return sum;
}

/* From the error of one step and of half of it, against many small steps of order 8, as small as
 * round-off allows; rounded down unless it is near the next number. */
static int measure(const stepping *s) {
    static const double CLEAR = 1e-9, LEAST = 0.01; /* error above round-off; step */
    dm_curve dop853;
    if (!dm_curve_find(&dop853, "dop853")) return 0;
    const stepping fine = {.tableau = &dop853};
    double h = 0.25, coarse = local_error(s, &fine, h), half = local_error(s, &fine, 0.5 * h);
    while (half > CLEAR && h > LEAST) {
        h *= 0.5;
        coarse = half;
        half = local_error(s, &fine, 0.5 * h);
    }
    const double order = floor(log2(coarse / half) - 1.0 + 0.35);
    return !(order >= 1.0) ? 0 : order > HIGHEST ? HIGHEST : (int)order;
}

/* At least 1: its consistency has been checked by its coefficients. */
int dm_curve_measure(const dm_curve *c) {
    const stepping s = {.tableau = c};
    const int order = measure(&s);
    return order < 1 ? 1 : order;
}

/* L = sum of v^2/2 + cos q + q^3/9, whose equations test_step knows */
static dm_node lagrangian(dm_graph *g) {
    dm_node sum = 0;
    for (uint32_t i = 0; i < 2; i++) {
        const dm_node q = dm_input(g, i), v = dm_input(g, 2 + i);
        const dm_node vv = dm_mul(g, dm_constant(g, 0.5), dm_mul(g, v, v));
        const dm_node qqq = dm_mul(g, dm_constant(g, 1.0 / 9.0), dm_mul(g, q, dm_mul(g, q, q)));
        const dm_node pull = dm_apply(g, DM_OP_COS, q, 0, 0);
        sum = dm_add(g, sum, dm_add(g, vv, dm_add(g, pull, qqq)));
    }
    return sum;
}

/* With bias 1 and no substeps, which do not change the order. */
dm_status dm_curve_measure_recipe(int *order, const dm_curve *c, dm_compile *compile,
                                  dm_arena *arena) {
    dm_model m;
    dm_written written;
    dm_curve whole = *c;
    whole.order = 1; /* of the action, which is not looked at */
    whole.bias = 1.0;
    whole.centred = whole.substeps = 0;
    dm_graph *g = dm_graph_new(arena, 5);
    if (!g) return DM_NO_MEMORY;
    const dm_node L = lagrangian(g);
    dm_status status = dm_model_build(&m, g, L, 2, DM_WANT_VALUE, compile, arena);
    if (status == DM_OK) status = dm_written_build(&written, &whole, &m);
    if (status != DM_OK) return status;
    const size_t room = written.inputs + dm_written_outputs(&m);
    double *x = dm_arena_take(arena, room * sizeof *x);
    if (!x) return DM_NO_MEMORY;
    memset(x, 0, room * sizeof *x);
    const stepping s = {.written = &written, .x = x, .out = x + written.inputs};
    dm_kernel_prepare(&written.ends, s.out);
    *order = measure(&s);
    return DM_OK;
}
