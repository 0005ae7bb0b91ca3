#include "search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LARGEST = 1024, CURVE = 64, BATCHES = 5 };
static const double TARGETS[] = {1e-4, 1e-8, 1e-10};
static const double LONGEST = 6e7; /* ns of one run, until something has reached the last target */

typedef struct {
    const char *side;
    const bench_problem *problem;
    const bench_method *method;
    double *out, *reference;
    double longest; /* ns: beyond it a method has lost */
} search;

double bench_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int bench_read_reference(double *reference, const char *folder, const bench_problem *problem) {
    char name[512], line[32768];
    int count = 0;
    snprintf(name, sizeof name, "%s/%s.txt", folder, problem->key);
    FILE *file = fopen(name, "r");
    if (!file) return 0;
    while (fgets(line, sizeof line, file)) {
        char *at = line, *end;
        for (; line[0] != '#' && count < BENCH_OUTPUTS * problem->n; count++, at = end) {
            reference[count] = strtod(at, &end);
            if (end == at) break;
        }
    }
    fclose(file);
    return count == BENCH_OUTPUTS * problem->n;
}

/* max norm over all outputs; infinite when a number is not one */
static double error_of(const search *s, long steps) {
    double worst = 0.0;
    const int count = BENCH_OUTPUTS * s->problem->n;
    s->method->run(s->out, s->method, steps);
    for (int i = 0; i < count; i++) {
        const double d = fabs(s->out[i] - s->reference[i]);
        if (!(d <= worst)) worst = isfinite(d) ? d : INFINITY;
    }
    return worst;
}

static double once(double *out, const bench_method *method, long steps) {
    const double t = bench_now();
    method->run(out, method, steps);
    return bench_now() - t;
}

static int increasing(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_time(double *out, const bench_method *method, long steps) {
    double best[BATCHES];
    for (int i = 0; i < BATCHES; i++) {
        double spent = 0.0;
        best[i] = INFINITY;
        for (int k = 0; k < 3 || (spent < 3e6 && k < 1000); k++) {
            const double ns = once(out, method, steps);
            spent += ns;
            if (ns < best[i]) best[i] = ns;
        }
    }
    qsort(best, BATCHES, sizeof *best, increasing);
    return best[BATCHES / 2];
}

static void print_line(const search *s, const char *kind, long steps, double error, double ns) {
    printf("%s\t%s\t%s\t%s\t%ld\t%.3e\t%.1f", kind, s->side, s->problem->key, s->method->name,
           steps * BENCH_OUTPUTS, error, ns);
}

/* smallest number of steps in (low, high] whose error is below the target; high's is */
static long smallest(const search *s, long low, long high, double target) {
    while (high - low > 1) {
        const long middle = low + (high - low) / 2;
        if (error_of(s, middle) <= target)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* errors over a range of step numbers, until round-off or the longest run; returns their number */
static int curve(const search *s, long *steps, double *errors) {
    int count = 0;
    double best = INFINITY;
    for (double at = 1.0; count < CURVE; at *= 1.35) {
        const long m = lround(at);
        if (count > 0 && m == steps[count - 1]) continue;
        steps[count] = m;
        errors[count] = error_of(s, m);
        double ns = once(s->out, s->method, m);
        for (int k = 0; k < 2; k++) ns = fmin(ns, once(s->out, s->method, m));
        if (errors[count] < 1e3) {
            print_line(s, "point", m, errors[count], ns);
            printf("\n");
        }
        /* beyond the last target, or no longer falling */
        if (errors[count] < 2e-11 || ns > s->longest) return count + 1;
        if (errors[count] > 30 * best && best < 1e-7) return count + 1;
        best = fmin(best, errors[count++]);
    }
    return count;
}

/* thirty times the best is off the picture */
static void shorten(search *s, double target, double ns) {
    if (target == TARGETS[sizeof TARGETS / sizeof *TARGETS - 1])
        s->longest = fmin(s->longest, fmax(30.0 * ns, 2e6));
}

static void search_method(search *s) {
    long steps[CURVE];
    double errors[CURVE];
    const int count = curve(s, steps, errors);
    for (size_t t = 0; t < sizeof TARGETS / sizeof *TARGETS; t++) {
        int i = 0;
        while (i < count && !(errors[i] <= TARGETS[t])) i++;
        if (i == count) continue;
        const long m = smallest(s, i ? steps[i - 1] : 0, steps[i], TARGETS[t]);
        const double error = error_of(s, m);
        const double ns = bench_time(s->out, s->method, m);
        print_line(s, "target", m, error, ns);
        printf("\t%g\n", TARGETS[t]);
        shorten(s, TARGETS[t], ns);
        fflush(stdout);
    }
}

int bench_search(const char *side, const bench_problem *problems, const char *folder,
                 const char *only) {
    const size_t room = BENCH_OUTPUTS * LARGEST * sizeof(double);
    search s = {.side = side, .out = malloc(room), .reference = malloc(room)};
    int missing = !s.out || !s.reference;
    for (const bench_problem *p = problems; !missing && p->key; p++) {
        if (strncmp(p->key, only, strlen(only)) != 0) continue;
        s.problem = p;
        s.longest = LONGEST;
        if (!bench_read_reference(s.reference, folder, p)) {
            fprintf(stderr, "bench: no reference for %s in %s\n", p->key, folder);
            missing = 1;
        }
        for (s.method = p->methods; !missing && s.method->name; s.method++) search_method(&s);
    }
    free(s.out);
    free(s.reference);
    return missing;
}
