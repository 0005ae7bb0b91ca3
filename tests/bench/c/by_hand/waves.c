/* waves.c - a Strang step of i psi_t = -psi_xx/2 + V psi on N points by hand: half a kick, FFTW forward, a
 * drift with 1/N in it, FFTW back; kicks between steps are whole. Arguments: N, steps, "estimate" | "measure".
 * Prints nanoseconds a step, the best of many, and sum |psi|^2 - 1. */
#define _POSIX_C_SOURCE 200809L
#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct {
    int n;
    double complex *psi, *c, *half, *kick, *drift;
    fftw_plan forward, backward;
} loop;

static void multiply(double complex *restrict z, const double complex *restrict e, int n) {
    for (int j = 0; j < n; j++) {
        const double a = creal(z[j]), b = cimag(z[j]), c = creal(e[j]), d = cimag(e[j]);
        z[j] = CMPLX(a * c - b * d, a * d + b * c);
    }
}

static void steps(const loop *l, long count) {
    multiply(l->psi, l->half, l->n);
    for (long i = 1; i <= count; i++) {
        fftw_execute(l->forward);
        multiply(l->c, l->drift, l->n);
        fftw_execute(l->backward);
        multiply(l->psi, i < count ? l->kick : l->half, l->n);
    }
}

static double complex *array(int n) {
    return fftw_malloc((size_t)n * sizeof(double complex));
}

static void fill(loop *l, double h) {
    const double length = 20.0;
    double norm = 0.0;
    for (int j = 0; j < l->n; j++) {
        const double x = -10.0 + length * j / l->n, V = 0.5 * x * x;
        const double k = 2.0 * acos(-1.0) / length * (j <= l->n / 2 ? j : j - l->n);
        l->half[j] = cexp(-0.5 * I * h * V);
        l->kick[j] = cexp(-I * h * V);
        l->drift[j] = cexp(-0.5 * I * h * k * k) / l->n;
        l->psi[j] = exp(-0.5 * (x - 1.0) * (x - 1.0));
        norm += creal(l->psi[j] * conj(l->psi[j]));
    }
    for (int j = 0; j < l->n; j++) l->psi[j] /= sqrt(norm);
}

int main(int argc, char **argv) {
    if (argc < 4) return 1;
    loop l = {.n = atoi(argv[1])};
    const long count = atol(argv[2]);
    const unsigned how = strcmp(argv[3], "measure") == 0 ? FFTW_MEASURE : FFTW_ESTIMATE;
    double best = INFINITY, sum = 0.0;
    l.psi = array(l.n), l.c = array(l.n), l.half = array(l.n);
    l.kick = array(l.n), l.drift = array(l.n);
    l.forward = fftw_plan_dft_1d(l.n, l.psi, l.c, FFTW_FORWARD, how | FFTW_PRESERVE_INPUT);
    l.backward = fftw_plan_dft_1d(l.n, l.c, l.psi, FFTW_BACKWARD, how | FFTW_PRESERVE_INPUT);
    fill(&l, 0.01);
    for (int round = 0; round < 20; round++) {
        const double began = now();
        steps(&l, count);
        best = fmin(best, now() - began);
    }
    for (int j = 0; j < l.n; j++) sum += creal(l.psi[j] * conj(l.psi[j]));
    printf("%.1f %.3g\n", best / (double)count * 1e9, sum - 1.0);
    return 0;
}
