/* curve_tables.c - explicit Runge-Kutta methods of orders 1 to 8, the one list of them. */
#include "integ/curve/curve.h"
#include "integ/method/quadrature.h"
#include "integ/rules/explicit/rk8.h"

#include <math.h>
#include <string.h>

typedef struct {
    const char *name, *source;
    int order, s;
    const double *a; /* below the diagonal, row by row; NULL: rk8.h */
    const double *b;
} tableau;

/* Coefficients, packed: row i of a has i numbers. */
static const double EULER_B[] = {1.0};
static const double MIDPOINT_A[] = {0.5}, MIDPOINT_B[] = {0.0, 1.0};
static const double HEUN_A[] = {1.0}, HEUN_B[] = {0.5, 0.5};
static const double KUTTA3_A[] = {0.5, -1.0, 2.0}, KUTTA3_B[] = {1.0 / 6, 2.0 / 3, 1.0 / 6};
static const double RK4_A[] = {0.5, 0.0, 0.5, 0.0, 0.0, 1.0};
static const double RK4_B[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
static const double DOPRI5_A[] = {1.0 / 5,        3.0 / 40,     9.0 / 40,       44.0 / 45,
                                  -56.0 / 15,     32.0 / 9,     19372.0 / 6561, -25360.0 / 2187,
                                  64448.0 / 6561, -212.0 / 729, 9017.0 / 3168,  -355.0 / 33,
                                  46732.0 / 5247, 49.0 / 176,   -5103.0 / 18656};
static const double DOPRI5_B[] = {35.0 / 384,     0.0,      500.0 / 1113, 125.0 / 192,
                                  -2187.0 / 6784, 11.0 / 84};
static const double BUTCHER6_A[] = {1.0 / 3,      0.0,        2.0 / 3,    1.0 / 12,    1.0 / 3,
                                    -1.0 / 12,    25.0 / 48,  -55.0 / 24, 35.0 / 48,   15.0 / 8,
                                    3.0 / 20,     -11.0 / 24, -1.0 / 8,   1.0 / 2,     1.0 / 10,
                                    -261.0 / 260, 33.0 / 13,  43.0 / 156, -118.0 / 39, 32.0 / 195,
                                    80.0 / 39};
static const double BUTCHER6_B[] = {13.0 / 200, 0.0,      11.0 / 40, 11.0 / 40,
                                    4.0 / 25,   4.0 / 25, 13.0 / 200};
static const double FEHLBERG7_A[] = {2.0 / 27,     1.0 / 36,      1.0 / 12,    1.0 / 24,
                                     0.0,          1.0 / 8,       5.0 / 12,    0.0,
                                     -25.0 / 16,   25.0 / 16,     1.0 / 20,    0.0,
                                     0.0,          1.0 / 4,       1.0 / 5,     -25.0 / 108,
                                     0.0,          0.0,           125.0 / 108, -65.0 / 27,
                                     125.0 / 54,   31.0 / 300,    0.0,         0.0,
                                     0.0,          61.0 / 225,    -2.0 / 9,    13.0 / 900,
                                     2.0,          0.0,           0.0,         -53.0 / 6,
                                     704.0 / 45,   -107.0 / 9,    67.0 / 90,   3.0,
                                     -91.0 / 108,  0.0,           0.0,         23.0 / 108,
                                     -976.0 / 135, 311.0 / 54,    -19.0 / 60,  17.0 / 6,
                                     -1.0 / 12,    2383.0 / 4100, 0.0,         0.0,
                                     -341.0 / 164, 4496.0 / 1025, -301.0 / 82, 2133.0 / 4100,
                                     45.0 / 82,    45.0 / 164,    18.0 / 41};
static const double FEHLBERG7_B[] = {41.0 / 840, 0.0,        0.0,       0.0,
                                     0.0,        34.0 / 105, 9.0 / 35,  9.0 / 35,
                                     9.0 / 280,  9.0 / 280,  41.0 / 840};

/* Names are those of curve(name); the first one is also `straight`. */
static const tableau tableaux[] = {
    {"euler", "explicit Euler", 1, 1, EULER_B, EULER_B},
    {"midpoint", "explicit midpoint (Runge)", 2, 2, MIDPOINT_A, MIDPOINT_B},
    {"heun", "Heun's method of order 2", 2, 2, HEUN_A, HEUN_B},
    {"kutta3", "Kutta's method of order 3", 3, 3, KUTTA3_A, KUTTA3_B},
    {"rk4", "the classical Runge-Kutta method", 4, 4, RK4_A, RK4_B},
    {"dopri5", "Dormand-Prince 1980, order 5, 6 stages", 5, 6, DOPRI5_A, DOPRI5_B},
    {"butcher6", "Butcher 1964, order 6, 7 stages", 6, 7, BUTCHER6_A, BUTCHER6_B},
    {"fehlberg7", "Fehlberg 1968, order 7, 11 stages", 7, 11, FEHLBERG7_A, FEHLBERG7_B},
    {"dop853", "Dormand-Prince, order 8, 12 stages (HNW I, II.5)", 8, DM_RK8_STAGES, NULL,
     dm_rk8_tableau[DM_RK8_STAGES]},
};
enum { TABLEAUX = sizeof tableaux / sizeof tableaux[0] };

/* In the order of the table. */
const char *dm_curve_name(int i, const char **source) {
    if (i < 0 || i >= TABLEAUX) return NULL;
    if (source) *source = tableaux[i].source;
    return tableaux[i].name;
}

/* As a Runge-Kutta method has it: weight and arrival are b, push is a, c are the row sums. */
static void finish(dm_curve *c) {
    c->bias = 1.0;
    c->centred = c->lifted = 0;
    memcpy(c->push, c->a, sizeof c->a);
    for (int i = 0; i < c->s; i++) {
        c->weight[i] = c->arrival[i] = c->plus[i];
        c->minus[i] = c->c[i] = 0.0;
        for (int j = 0; j < i; j++) c->c[i] += c->a[i][j];
    }
}

/* Only what is below the diagonal is read. */
void dm_curve_fill(dm_curve *out, int s, const double *a, const double *b) {
    memset(out, 0, sizeof *out);
    out->s = s;
    for (int i = 0; i < s; i++) {
        memcpy(out->a[i], a + i * s, (size_t)i * sizeof *a);
        out->plus[i] = b[i];
    }
    finish(out);
}

/* Rows of the built-in tables lie behind each other, row i with i numbers. */
static void fill_packed(dm_curve *out, const tableau *t) {
    const double *a = t->a;
    out->s = t->s;
    out->order = t->order;
    strcpy(out->name, t->name);
    for (int i = 0; i < t->s; i++) {
        if (a)
            memcpy(out->a[i], a + i * (i - 1) / 2, (size_t)i * sizeof *a);
        else
            memcpy(out->a[i], dm_rk8_tableau[i], (size_t)i * sizeof *a);
        out->plus[i] = t->b[i];
    }
    finish(out);
}

/* `straight` has the table of Euler's method and another bias. */
int dm_curve_find(dm_curve *out, const char *name) {
    const int straight = strcmp(name, "straight") == 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < TABLEAUX && !straight; i++)
        if (strcmp(tableaux[i].name, name) == 0) {
            fill_packed(out, tableaux + i);
            return 1;
        }
    if (!straight) return dm_curve_gsl(out, name);
    fill_packed(out, tableaux);
    strcpy(out->name, name);
    out->bias = 0.5;
    return 1;
}

/* points 1 .. s-1 of the method with the signed length `side` of a step, point 0 being y itself:
 * where they go, less i */
static int add_points(dm_curve *out, const dm_curve *whole, double side) {
    const int first = out->s - 1;
    for (int i = 1; i < whole->s; i++) {
        const int k = first + i;
        out->c[k] = side * whole->c[i];
        for (int j = 0; j < i; j++) {
            const int l = j ? first + j : 0;
            out->a[k][l] = side * whole->a[i][j];
            out->push[k][l] = side * whole->push[i][j];
            out->lift[k][l] = side * side * whole->lift[i][j];
        }
    }
    out->s += whole->s - 1;
    return first;
}

/* Lengths are signed, weights are not: the action is summed forward on both sides. */
static void add_side(dm_curve *out, const dm_curve *whole, double side) {
    double *q = side > 0.0 ? out->plus : out->minus;
    double *lift = side > 0.0 ? out->plus_lift : out->minus_lift;
    double *v = side > 0.0 ? out->arrival : out->departure;
    if (side == 0.0) return;
    const int first = add_points(out, whole, side);
    for (int i = 0; i < whole->s; i++) {
        const int k = i ? first + i : 0;
        q[k] = side * whole->plus[i];
        lift[k] = side * side * whole->plus_lift[i];
        v[k] = side * whole->arrival[i];
        if (i) out->weight[k] = fabs(side) * whole->weight[i];
    }
}

/* Ld of a method that cannot sum it: by Gauss nodes, to each of which the method is run from y */
static void add_nodes(dm_curve *out, const dm_curve *whole, double bias) {
    dm_quadrature gauss;
    dm_quadrature_gauss(&gauss, (whole->order + 1) / 2);
    for (int i = 0; i < gauss.r; i++) {
        const double length = bias - 1.0 + (double)gauss.c[i];
        const int first = add_points(out, whole, length), node = out->s++;
        for (int j = 0; j < whole->s; j++) {
            const int k = j ? first + j : 0;
            out->a[node][k] = length * whole->plus[j];
            out->push[node][k] = length * whole->arrival[j];
            out->lift[node][k] = length * length * whole->plus_lift[j];
        }
        out->c[node] = length;
        out->weight[node] = (double)gauss.b[i];
    }
}

/* points and ends of one substep of that length, which begins after `start` */
static void add_substep(dm_curve *out, const dm_curve *whole, double length, double start) {
    const int first = out->s;
    for (int i = 0; i < whole->s; i++) {
        const int k = first + i;
        memcpy(out->a[k], out->plus, (size_t)first * sizeof *out->plus);
        memcpy(out->push[k], out->arrival, (size_t)first * sizeof *out->plus);
        memcpy(out->lift[k], out->plus_lift, (size_t)first * sizeof *out->plus);
        for (int j = 0; j < i; j++) {
            out->a[k][first + j] = length * whole->a[i][j];
            out->push[k][first + j] = length * whole->push[i][j];
            out->lift[k][first + j] = length * length * whole->lift[i][j];
        }
        out->c[k] = start + length * whole->c[i];
    }
    for (int i = 0; i < whole->s; i++) {
        out->plus[first + i] = length * whole->plus[i];
        out->arrival[first + i] = length * whole->arrival[i];
        out->plus_lift[first + i] = length * length * whole->plus_lift[i];
        out->weight[first + i] = length * whole->weight[i];
    }
    out->s += whole->s;
}

/* The points of a substep begin where those before it have led: rows of plus and arrival so far. */
int dm_curve_compose(dm_curve *out, const dm_curve *whole, const double *share) {
    double start = 0.0;
    *out = (dm_curve){.order = whole->order, .lifted = whole->lifted, .bias = 1.0};
    memcpy(out->name, whole->name, sizeof out->name);
    for (int i = 0; i < whole->substeps; i++) {
        if (share[i] == 0.0) continue;
        if (out->s + whole->s > DM_CURVE_STAGES) return 0;
        add_substep(out, whole, share[i], start);
        start += share[i];
    }
    return 1;
}

/* Point 0 is y itself and belongs to both sides; a lifted method needs Gauss nodes for its action,
 * with points of their own. */
int dm_curve_bias(dm_curve *c, double bias) {
    if (c->recipe || c->choice) { /* of the whole step, which is not known yet */
        c->bias = bias;
        c->centred = bias != 1.0;
        return 1;
    }
    const dm_curve whole = *c;
    const int sides = (bias != 0.0) + (bias != 1.0), nodes = (whole.order + 1) / 2;
    const int points = 1 + sides * (whole.s - 1);
    if (points + (whole.lifted ? nodes * whole.s : 0) > DM_CURVE_STAGES) return 0;
    memset(c, 0, sizeof *c);
    memcpy(c->name, whole.name, sizeof c->name);
    c->order = whole.order;
    c->lifted = whole.lifted;
    c->s = 1;
    c->weight[0] = whole.weight[0];
    add_side(c, &whole, bias);
    add_side(c, &whole, bias - 1.0);
    if (whole.lifted) add_nodes(c, &whole, bias);
    c->bias = bias;
    c->centred = bias != 1.0;
    return 1;
}

/* bias 1/2: Ld is the same from both ends, so that the step is symmetric */
int dm_curve_order(const dm_curve *c) {
    return c->bias == 0.5 && c->order % 2 ? c->order + 1 : c->order;
}
