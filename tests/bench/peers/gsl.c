/* gsl FOLDER [KEY] - GSL's explicit Runge-Kutta of order 8 (rk8pd), fixed steps and error
 * control */
#include "forces.h"
#include "search.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    const char *key;
    int n;
    double T, parameter;
    void (*start)(double *q, double *v, double parameter);
    int (*slope)(double t, const double *y, double *f, void *params); /* y = (q, v) */
    void (*positions)(double *out);
    int first; /* y is no (q, v): so many numbers, of which row makes those of an output */
    void (*row)(double *out, const double *y);
} model;

static double parameter_of(void *params) {
    return ((const model *)params)->parameter;
}
static int length_of(void *params) {
    return ((const model *)params)->n;
}

/* starts of the same shape, then y' = (v, a) for each problem */
static void start_kepler(double *q, double *v, double e) {
    kepler_start(q, v, e);
}
static void start_satellite(double *q, double *v, double e) {
    (void)e;
    satellite_start(q, v);
}
static void start_planets(double *q, double *v, double e) {
    (void)e;
    planets_start(q, v);
}
static void start_pendulum(double *q, double *v, double e) {
    (void)e;
    pendulum_start(q, v);
}
static void start_spring(double *q, double *v, double e) {
    (void)e;
    spring_start(q, v);
}
static void start_chain(double *q, double *v, double n) {
    chain_start(q, v, (int)n);
}

static void start_body(double *q, double *v, double top) {
    (void)v;
    body_start(q, (int)top);
}
static int slope_body(double t, const double *y, double *f, void *params) {
    (void)t;
    body(f, y, (int)parameter_of(params));
    return GSL_SUCCESS;
}

#define SLOPE(name, n, call)                                                                       \
    static int slope_##name(double t, const double *y, double *f, void *params) {                  \
        (void)t;                                                                                   \
        (void)params;                                                                              \
        memcpy(f, y + (n), (size_t)(n) * sizeof *f);                                               \
        call;                                                                                      \
        return GSL_SUCCESS;                                                                        \
    }
SLOPE(kepler, 2, kepler(f + 2, y))
SLOPE(satellite, 3, satellite(f + 3, y))
SLOPE(planets, 18, planets(f + 18, y))
SLOPE(pendulum, 6, pendulum(f + 6, y, y + 6))
SLOPE(spring, 2, spring(f + 2, y, parameter_of(params)))
SLOPE(toda, length_of(params), toda(f + length_of(params), y, length_of(params)))
SLOPE(fpu, length_of(params), fpu(f + length_of(params), y, length_of(params)))

static const model models[] = {
    {.key = "P5-body",
     .n = 9,
     .T = 100.0,
     .parameter = 0,
     .start = start_body,
     .slope = slope_body,
     .first = 7,
     .row = body_row},
    {.key = "P5-top",
     .n = 9,
     .T = 100.0,
     .parameter = 1,
     .start = start_body,
     .slope = slope_body,
     .first = 7,
     .row = body_row},
    {"P1-0.6", 2, 628.31853071795864769, 0.6, start_kepler, slope_kepler, NULL, 0, NULL},
    {"P1-0.9", 2, 628.31853071795864769, 0.9, start_kepler, slope_kepler, NULL, 0, NULL},
    {"P2", 3, 628.31853071795864769, 0, start_satellite, slope_satellite, NULL, 0, NULL},
    {"P3", 18, 200000.0, 0, start_planets, slope_planets, NULL, 0, NULL},
    {"P4", 6, 10.0, 0, start_pendulum, slope_pendulum, pendulum_positions, 0, NULL},
    {"P6-1e2", 2, 16.0, 1e2, start_spring, slope_spring, NULL, 0, NULL},
    {"P6-1e4", 2, 16.0, 1e4, start_spring, slope_spring, NULL, 0, NULL},
    {"P6-1e6", 2, 16.0, 1e6, start_spring, slope_spring, NULL, 0, NULL},
    {"P8-toda-3", 3, 100.0, 3, start_chain, slope_toda, NULL, 0, NULL},
    {"P8-toda-32", 32, 100.0, 32, start_chain, slope_toda, NULL, 0, NULL},
    {"P8-toda-1024", 1024, 16.0, 1024, start_chain, slope_toda, NULL, 0, NULL},
    {"P8-fpu-3", 3, 100.0, 3, start_chain, slope_fpu, NULL, 0, NULL},
    {"P8-fpu-32", 32, 100.0, 32, start_chain, slope_fpu, NULL, 0, NULL},
    {"P8-fpu-1024", 1024, 16.0, 1024, start_chain, slope_fpu, NULL, 0, NULL},
};

/* with k = 0, `steps` fixed steps an output; else error control at the tolerance 10^(-steps/16) */
static void run(double *out, const bench_method *method, long steps) {
    const model *m = method->table;
    const size_t n = (size_t)m->n;
    double y[2 * 1024], t = 0.0;
    union {
        const model *in;
        void *out;
    } params = {m};
    gsl_odeiv2_system system = {m->slope, NULL, m->first ? (size_t)m->first : 2 * n, params.out};
    const double row_time = m->T / BENCH_OUTPUTS,
                 tolerance = method->k ? pow(10.0, -(double)steps / 16.0) : 1e100;
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd,
                                      row_time / (double)(method->k ? 64 : steps), tolerance,
                                      method->k ? tolerance : 0.0);
    int status = method->k && steps > 240; /* below round-off */
    m->start(y, y + n, m->parameter);
    for (int row = 0; row < BENCH_OUTPUTS; row++) {
        if (!status)
            status = method->k
                         ? gsl_odeiv2_driver_apply(driver, &t, row_time * (row + 1), y)
                         : gsl_odeiv2_driver_apply_fixed_step(driver, &t, row_time / (double)steps,
                                                              (unsigned long)steps, y);
        if (m->row) m->row(out + (size_t)row * n, y);
        for (size_t i = 0; i < n && (status || !m->row); i++)
            out[(size_t)row * n + i] = status ? NAN : y[i];
    }
    gsl_odeiv2_driver_free(driver);
    if (m->positions) m->positions(out);
}

int main(int argc, char **argv) {
    enum { COUNT = sizeof models / sizeof *models };
    bench_method methods[COUNT][3];
    bench_problem problems[COUNT + 1] = {{0}};
    if (argc < 2) {
        fprintf(stderr, "usage: gsl FOLDER [KEY]\n");
        return 2;
    }
    gsl_set_error_handler_off();
    for (int i = 0; i < COUNT; i++) {
        methods[i][0] = (bench_method){"gsl rk8pd, fixed step", run, &models[i], 0};
        methods[i][1] = (bench_method){"gsl rk8pd", run, &models[i], 1};
        methods[i][2] = (bench_method){0};
        problems[i] = (bench_problem){models[i].key, models[i].n, methods[i]};
    }
    return bench_search("peer", problems, argv[1], argc > 2 ? argv[2] : "");
}
