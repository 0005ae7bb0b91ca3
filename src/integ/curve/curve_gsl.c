/* curve_gsl.c - the explicit steppers of GSL as tableaux. A stepper is run on a right-hand side
 * whose i-th call answers with the i-th unit vector: the point of call i then is (a_i1, a_i2,
 * ...), and the end is b. So the coefficients are those of the library that is linked, and a
 * step of the tableau is a step of the stepper. */
#include "integ/curve/curve.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <string.h>

typedef struct {
    int calls;
    double a[DM_CURVE_STAGES * DM_CURVE_STAGES];
} probe;

static int answer(double t, const double y[], double slope[], void *params) {
    probe *p = params;
    (void)t;
    if (p->calls == DM_CURVE_STAGES) return GSL_EFAILED;
    memcpy(p->a + p->calls * DM_CURVE_STAGES, y, DM_CURVE_STAGES * sizeof *y);
    memset(slope, 0, DM_CURVE_STAGES * sizeof *slope);
    slope[p->calls++] = 1.0;
    return GSL_SUCCESS;
}

/* points that reach the end, directly or through others */
static void find_needed(int *needed, const probe *p, const double *b) {
    for (int i = p->calls - 1; i >= 0; i--) {
        needed[i] = b[i] != 0.0;
        for (int j = i + 1; j < p->calls; j++)
            if (needed[j] && p->a[j * DM_CURVE_STAGES + i] != 0.0) needed[i] = 1;
    }
}

/* without the points that serve GSL's estimate of the error alone */
static void keep_needed(dm_curve *out, const probe *p, const double *b) {
    double a[DM_CURVE_STAGES * DM_CURVE_STAGES], weight[DM_CURVE_STAGES];
    int needed[DM_CURVE_STAGES], place[DM_CURVE_STAGES], s = 0;
    find_needed(needed, p, b);
    for (int i = 0; i < p->calls; i++)
        if (needed[i]) place[s++] = i;
    for (int i = 0; i < s; i++) {
        weight[i] = b[place[i]];
        for (int j = 0; j < s; j++) a[i * s + j] = p->a[place[i] * DM_CURVE_STAGES + place[j]];
    }
    dm_curve_fill(out, s, a, weight);
}

/* One step of length 1 from zero: the end has the weights b in its entries. */
static int read_off(dm_curve *out, const gsl_odeiv2_step_type *type) {
    static const double none[DM_CURVE_STAGES];
    double y[DM_CURVE_STAGES], error[DM_CURVE_STAGES];
    probe p = {.calls = 0};
    const gsl_odeiv2_system system = {answer, NULL, DM_CURVE_STAGES, &p};
    gsl_set_error_handler_off();
    gsl_odeiv2_step *stepper = gsl_odeiv2_step_alloc(type, DM_CURVE_STAGES);
    if (!stepper) return 0;
    memcpy(y, none, sizeof y);
    const int failed = gsl_odeiv2_step_apply(stepper, 0.0, 1.0, y, error, NULL, NULL, &system);
    gsl_odeiv2_step_free(stepper);
    if (failed) return 0;
    keep_needed(out, &p, y);
    return 1;
}

/* With or without gsl- before the name; the embedded estimate of the error is not used. */
int dm_curve_gsl(dm_curve *out, const char *name) {
    const struct {
        const char *name;
        const gsl_odeiv2_step_type *type;
        int order;
    } steppers[] = {{"gsl-rk2", gsl_odeiv2_step_rk2, 3},
                    {"gsl-rk4", gsl_odeiv2_step_rk4, 4},
                    {"gsl-rkf45", gsl_odeiv2_step_rkf45, 5},
                    {"gsl-rkck", gsl_odeiv2_step_rkck, 5},
                    {"gsl-rk8pd", gsl_odeiv2_step_rk8pd, 8}};
    for (size_t i = 0; i < sizeof steppers / sizeof *steppers; i++) {
        const char *whole = steppers[i].name;
        if (strcmp(whole, name) != 0 && strcmp(whole + 4, name) != 0) continue;
        if (!read_off(out, steppers[i].type)) return 0;
        strcpy(out->name, whole);
        out->order = steppers[i].order;
        return 1;
    }
    return 0;
}
