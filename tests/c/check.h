/* check.h - a small test harness that speaks TAP. A test is a void function of CHECKs;
 * main runs each by RUN(function, "sentence") and returns check_finish().
 * A failed check prints where and what as a "# " line and fails its test, the rest runs
 * on. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_tests, check_failed_tests, check_failures;

static inline int check_report(int right, const char *file, int line, const char *what) {
    if (!right && check_failures++ < 10) printf("# %s:%d: %s\n", file, line, what);
    return right;
}

/* |got - want| <= tolerance; NaN never is near. */
static inline int check_near(double got, double want, double tolerance, const char *what) {
    const int right = fabs(got - want) <= tolerance;
    if (!right && check_failures < 10)
        printf("# %s: got %.17g, want %.17g, off by %.2g\n", what, got, want, fabs(got - want));
    return right;
}

static inline void check_run(void (*test)(void), const char *sentence) {
    check_failures = 0;
    test();
    check_failed_tests += check_failures > 0;
    printf("%sok %d - %s\n", check_failures ? "not " : "", ++check_tests, sentence);
    fflush(stdout);
}

/* The plan, and the exit status of main. */
static inline int check_finish(void) {
    printf("1..%d\n", check_tests);
    return check_failed_tests != 0;
}

#define CHECK(condition) check_report((condition), __FILE__, __LINE__, #condition)
#define CHECK_NEAR(got, want, tolerance)                                                           \
    check_report(check_near((got), (want), (tolerance), #got), __FILE__, __LINE__,                 \
                 #got " is near " #want)
#define RUN(test, sentence) check_run(test, sentence)

/* valgrind computes long double in 64 bits: what rests on coefficients of two doubles cannot be
 * seen there */
static inline int doubles_only(void) {
    const char *under = getenv("UNDER");
    return under && strcmp(under, "valgrind") == 0;
}

/* Steps or samples of which more of the same are taken: a tenth of them where sanitizers or
 * valgrind watch, who see the same code. */
static inline long check_count(long n) {
    const char *under = getenv("UNDER");
    return under && *under ? n / 10 : n;
}

#endif
