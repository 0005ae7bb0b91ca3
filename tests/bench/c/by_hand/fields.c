/* fields.c - leapfrog of waves (a 0-form) and of Maxwell's equations (a 1-form) on the hexagonal
 * torus of N x N vertices by hand: slopes cell by cell, then entry by entry what they add up to,
 * the kick and the drift; also with slopes that are added to the entries at once, which needs
 * neither a list of them nor room for them: a thread goes through all cells that have entries of
 * its rows, and adds up in an array of its own. Arguments: N, threads. gcc's gathers of
 * -march=native are slower than loads one by one, so nothing is vectorized. */
#include <math.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define PLAIN __attribute__((optimize("no-tree-vectorize")))

enum { STEPS = 40 };

static int repeats; /* of which the best counts */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* entry a gets sign[a][k] times slope of cell of[a][k], `many` of them; a cell reads `faces` */
typedef struct {
    uint32_t entries, cells, many, faces;
    uint32_t *of, *face;
    double *sign, *part, *star, *w;
} complex2;

static void *take(size_t count, size_t size) {
    void *x = calloc(count, size);
    if (!x) exit(1);
    return x;
}

static complex2 room(uint32_t entries, uint32_t cells, uint32_t many, uint32_t faces) {
    complex2 K = {entries, cells, many, faces, 0, 0, 0, 0, 0, 0};
    K.of = take((size_t)entries * many, sizeof *K.of);
    K.sign = take((size_t)entries * many, sizeof *K.sign);
    K.face = take((size_t)cells * faces, sizeof *K.face);
    K.part = take((size_t)cells * faces, sizeof *K.part);
    K.star = take(cells, sizeof *K.star);
    K.w = take(entries, sizeof *K.w);
    return K;
}

/* who reads whom, backwards */
static void turn_round(complex2 *K) {
    uint8_t *count = take(K->entries, 1);
    for (uint32_t i = 0; i < K->cells; i++)
        for (uint32_t j = 0; j < K->faces; j++) {
            const uint32_t a = K->face[i * K->faces + j], k = count[a]++;
            K->of[a * K->many + k] = i;
            K->sign[a * K->many + k] = K->part[i * K->faces + j];
        }
    for (uint32_t i = 0; i < K->cells; i++) K->star[i] = 1.0 + 1e-3 * (i % 7);
    for (uint32_t a = 0; a < K->entries; a++) K->w[a] = 0.01;
    free(count);
}

/* edges 3 v + d of vertex v to v + (1, 0), (0, 1), (1, 1) */
static complex2 waves(uint32_t N) {
    complex2 K = room(N * N, 3 * N * N, 6, 2);
    for (uint32_t v = 0; v < N * N; v++) {
        const uint32_t i = v / N, j = v % N, x = (i + 1) % N, y = (j + 1) % N;
        const uint32_t to[3] = {x * N + j, i * N + y, x * N + y};
        for (uint32_t d = 0; d < 3; d++) {
            K.face[2 * (3 * v + d)] = v, K.part[2 * (3 * v + d)] = -1;
            K.face[2 * (3 * v + d) + 1] = to[d], K.part[2 * (3 * v + d) + 1] = 1;
        }
    }
    turn_round(&K);
    return K;
}

/* two triangles a vertex: (1, 0) then (0, 1), and the other way round */
static complex2 maxwell(uint32_t N) {
    complex2 K = room(3 * N * N, 2 * N * N, 2, 3);
    for (uint32_t v = 0; v < N * N; v++) {
        const uint32_t i = v / N, j = v % N, x = (i + 1) % N * N + j, y = i * N + (j + 1) % N;
        const uint32_t f[2][3] = {{3 * v, 3 * v + 2, 3 * x + 1}, {3 * v + 1, 3 * v + 2, 3 * y}};
        for (uint32_t d = 0; d < 2; d++)
            for (uint32_t k = 0; k < 3; k++) {
                K.face[3 * (2 * v + d) + k] = f[d][k];
                K.part[3 * (2 * v + d) + k] = k == 1 ? -1 : 1;
            }
    }
    turn_round(&K);
    return K;
}

PLAIN static void slopes2(const complex2 *K, double *B, const double *A) {
#pragma omp for
    for (uint32_t i = 0; i < K->cells; i++)
        B[i] = 0.01 * K->star[i] * (A[K->face[2 * i + 1]] - A[K->face[2 * i]]);
}

PLAIN static void slopes3(const complex2 *K, double *B, const double *A) {
#pragma omp for
    for (uint32_t i = 0; i < K->cells; i++)
        B[i] =
            0.01 * K->star[i] * (A[K->face[3 * i]] - A[K->face[3 * i + 1]] + A[K->face[3 * i + 2]]);
}

PLAIN static void move(const complex2 *K, double *A, double *p, const double *B, uint32_t many) {
#pragma omp for
    for (uint32_t a = 0; a < K->entries; a++) {
        double sum = 0.0;
        for (uint32_t k = 0; k < many; k++) sum += K->sign[a * many + k] * B[K->of[a * many + k]];
        p[a] -= sum;
        A[a] += K->w[a] * p[a];
    }
}

/* all threads have come here; they spin, as those of OpenMP do */
static void meet(uint32_t parts) {
    static atomic_uint waiting, phase;
    const unsigned now = atomic_load(&phase);
    if (parts == 1) return;
    if (atomic_fetch_add(&waiting, 1) + 1 == parts) {
        atomic_store(&waiting, 0);
        atomic_store(&phase, now + 1);
        return;
    }
    for (int spins = 0; atomic_load(&phase) == now; spins++)
        if (spins > 2000) sched_yield();
}

/* slopes of cells straight to the entries of F, which moves take and clear */
PLAIN static void add2(const complex2 *K, double *restrict F, const double *restrict A,
                       uint32_t from, uint32_t to) {
    for (uint32_t i = from; i < to; i++) {
        const uint32_t *f = K->face + 2 * i;
        const double y = 0.01 * K->star[i] * (A[f[1]] - A[f[0]]);
        F[f[0]] -= y;
        F[f[1]] += y;
    }
}

PLAIN static void add3(const complex2 *K, double *restrict F, const double *restrict A,
                       uint32_t from, uint32_t to) {
    for (uint32_t i = from; i < to; i++) {
        const uint32_t *f = K->face + 3 * i;
        const double y = 0.01 * K->star[i] * (A[f[0]] - A[f[1]] + A[f[2]]);
        F[f[0]] += y;
        F[f[1]] -= y;
        F[f[2]] += y;
    }
}

static void add(const complex2 *K, double *F, const double *A, uint32_t from, uint32_t to) {
    if (K->faces == 2)
        add2(K, F, A, from, to);
    else
        add3(K, F, A, from, to);
}

static void move_cleared(const complex2 *K, double *restrict A, double *restrict p,
                         double *restrict F, uint32_t from, uint32_t to) {
    for (uint32_t a = from; a < to; a++) {
        p[a] -= F[a];
        F[a] = 0.0;
        A[a] += K->w[a] * p[a];
    }
}

/* Cells of row i have entries of the rows i and i + 1: those of the row before mine come first.
 * What is added to entries of others is never read. */
static void add_rows(const complex2 *K, uint32_t N, double *F, const double *A, uint32_t part,
                     uint32_t parts) {
    const uint32_t from = N * part / parts, to = N * (part + 1) / parts, cells = K->cells / N;
    const uint32_t before = (from + N - 1) % N;
    if (parts > 1) add(K, F, A, cells * before, cells * (before + 1));
    add(K, F, A, cells * from, cells * to);
}

static void race_adding(const char *what, const complex2 *K, uint32_t N, int threads) {
    double *A = take(K->entries, 8), *p = take(K->entries, 8), best = 1e9, *F[16];
    const uint32_t entries = K->entries / N, parts = (uint32_t)threads;
    for (uint32_t k = 0; k < parts; k++) F[k] = take(K->entries, 8);
    for (uint32_t a = 0; a < K->entries; a++) A[a] = sin(a);
    for (int r = 0; r < repeats; r++) {
        const double t = now();
#pragma omp parallel for num_threads(threads) schedule(static, 1)
        for (uint32_t k = 0; k < parts; k++)
            for (int s = 0; s < STEPS; s++) {
                add_rows(K, N, F[k], A, k, parts);
                meet(parts);
                move_cleared(K, A, p, F[k], entries * (N * k / parts),
                             entries * (N * (k + 1) / parts));
                meet(parts);
            }
        best = fmin(best, now() - t);
    }
    printf("%-28s added at once, %d thread%s %9.2f ns an unknown   (%u; %g)\n", what, threads,
           threads > 1 ? "s" : " ", best / STEPS / K->entries * 1e9, K->entries, A[1]);
}

static void race(const char *what, const complex2 *K, int threads) {
    double *A = take(K->entries, 8), *p = take(K->entries, 8), *B = take(K->cells, 8);
    double best = 1e9;
    for (uint32_t a = 0; a < K->entries; a++) A[a] = sin(a);
    for (int r = 0; r < repeats; r++) {
        const double t = now();
#pragma omp parallel num_threads(threads)
        for (int s = 0; s < STEPS; s++) {
            if (K->faces == 2) {
                slopes2(K, B, A);
                move(K, A, p, B, 6);
            } else {
                slopes3(K, B, A);
                move(K, A, p, B, 2);
            }
        }
        best = fmin(best, now() - t);
    }
    printf("%-28s by hand, %d thread%s     %9.2f ns an unknown   (%u; %g)\n", what, threads,
           threads > 1 ? "s" : " ", best / STEPS / K->entries * 1e9, K->entries, A[1]);
}

int main(int argc, char **argv) {
    const uint32_t N = argc > 1 ? (uint32_t)atoi(argv[1]) : 60;
    const int threads = argc > 2 ? atoi(argv[2]) : 1;
    repeats = N > 200 ? 6 : 60;
    const complex2 a = waves(N), b = maxwell(N);
    race("wave, leapfrog", &a, threads);
    race("Maxwell, leapfrog", &b, threads);
    race_adding("wave, leapfrog", &a, N, threads);
    race_adding("Maxwell, leapfrog", &b, N, threads);
    return 0;
}
