/* search.h - how every side of the benchmark is measured: the number of steps that just reaches
 * a position error, and the process CPU time of a run with that many. */
#ifndef BENCH_SEARCH_H
#define BENCH_SEARCH_H

#ifdef __cplusplus
extern "C" {
#endif

enum { BENCH_OUTPUTS = 32 };

typedef struct bench_method {
    const char *name;
    /* positions at 32 equally spaced times into out[32][n], `steps` steps (or so) in each
     * interval */
    void (*run)(double *out, const struct bench_method *method, long steps);
    const void *table; /* coefficients, if any */
    int k;             /* sweeps of a fixed point, if any */
} bench_method;

typedef struct {
    const char *key;             /* names the file of reference positions */
    int n;                       /* numbers per output */
    const bench_method *methods; /* ends with name NULL */
} bench_problem;

/* Read <folder>/<key>.txt into reference[32 n]; 0 when it is missing or too short. */
int bench_read_reference(double *reference, const char *folder, const bench_problem *problem);

/* Nanoseconds of process CPU time. */
double bench_now(void);

/* Median of batches, each the best of many repeats, of run(out, method, steps), ns. */
double bench_time(double *out, const bench_method *method, long steps);

/* Search all problems whose key begins with `only`; lines to stdout:
 *   point  SIDE PROBLEM METHOD STEPS ERROR NS
 *   target SIDE PROBLEM METHOD STEPS ERROR NS TARGET                        tab-separated */
int bench_search(const char *side, const bench_problem *problems, const char *folder,
                 const char *only);

#ifdef __cplusplus
}
#endif

#endif
