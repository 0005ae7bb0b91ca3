/* reference.h - the benchmark problems in a number type of more digits than double, for the
 * reference solutions. All are second-order systems q'' = a(q, q'). */
#ifndef BENCH_REFERENCE_H
#define BENCH_REFERENCE_H

#ifdef BENCH_LONG_DOUBLE
#include <math.h>
#include <stdio.h>
typedef long double real;
#define REAL(x) x##L
#define FN(name) name##l
#define PRINT_REAL(text, size, digits, x) snprintf(text, size, "%.*Le", digits, x)
#else
#include <quadmath.h>
typedef __float128 real;
#define REAL(x) x##Q
#define FN(name) name##q
#define PRINT_REAL(text, size, digits, x) quadmath_snprintf(text, size, "%.*Qe", digits, x)
#endif

enum { OUTPUTS = 32, LARGEST = 1024 };

typedef struct {
    const char *key;  /* also the name of the data file */
    int n;            /* coordinates */
    real T;           /* the end of the run */
    int steps;        /* Gauss steps per output, enough for 25 digits */
    double parameter; /* eccentricity, stiffness, unused */
    void (*start)(real *q, real *v);
    void (*force)(real *a, const real *q, const real *v);
    void (*position)(real *out, const real *q); /* NULL: out = q */
} reference_problem;

extern const reference_problem reference_problems[]; /* ends with key NULL */
extern const reference_problem *reference_now;       /* the one being run: n, parameter */

#endif
