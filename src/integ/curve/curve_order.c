/* curve_order.c - the order of a Runge-Kutta method by its order conditions (Butcher; HNW I,
 * II.2): for every rooted tree t of order up to p, sum_i b_i phi_i(t) = 1/gamma(t). With t =
 * [t_1, ..., t_m]: phi_i(t) = prod_k sum_j a_ij phi_j(t_k) and gamma(t) = |t| prod_k gamma(t_k). */
#include "integ/curve/curve.h"

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

/* error of one step, added up over some starts */
static double local_error(const dm_curve *c, const dm_curve *fine, double h) {
    enum { STARTS = 7, FINE = 32 };
    double sum = 0.0;
    for (int k = 0; k < STARTS; k++) {
        double y[2] = {cos(1.7 * k), sin(1.1 * k)}, goal[2] = {y[0], y[1]};
        test_step(y, c, h);
        for (int i = 0; i < FINE; i++) test_step(goal, fine, h / FINE);
        sum += fabs(y[0] - goal[0]) + fabs(y[1] - goal[1]);
    }
    return sum;
}

/* From the error of one step and of half of it, against many small steps of order 8; rounded down
 * unless it is near the next number. */
int dm_curve_measure(const dm_curve *c) {
    dm_curve fine;
    if (!dm_curve_find(&fine, "dop853")) return 0;
    const double h = 0.25;
    const double coarse = local_error(c, &fine, h), half = local_error(c, &fine, 0.5 * h);
    const int order = (int)floor(log2(coarse / half) - 1.0 + 0.35);
    return order < 1 ? 1 : order > HIGHEST ? HIGHEST : order;
}
