/* midpoint.c - implicit midpoint steps of waves (a 0-form), of Maxwell's equations (a 1-form) and
 * of sine-Gordon's on the hexagonal torus of N x N vertices by hand, the rows "midpoint" of
 * tests/bench/fields.lua: slopes cell by cell, then entry by entry what they add up to, and CHOLMOD.
 * With Z = Q - q0 at the middle
 *   (M + h^2/4 K) Z = h/2 p0 + h^2/4 F(q0),  q1 = q0 + 2 Z,  p1 = 4/h M Z - p0,
 * so a linear step is one product and one solve by factors that stay. Sine-Gordon: Newton's method
 * until the increment is round-off, the ordering found once, new numbers into the same factor at
 * the start of every step. Argument: N. Plain loops: gathers of -march=native are slower. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <time.h>

#define PLAIN __attribute__((optimize("no-tree-vectorize")))

enum { STEPS = 40, REPEATS = 9, MOST = 40 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *take(size_t count, size_t size) {
    void *x = calloc(count, size);
    if (!x) exit(1);
    return x;
}

/* |dA|^2 with one weight; entry a meets `many` cells of[a][k], with a sign; a cell has `faces` */
typedef struct {
    int n, cells, many, faces;
    int *of, *face;
    double *sign, *part, *slope, star, mass;
    int wells; /* - the sum of mass (1 - cos A) */
    double h;
    cholmod_common c;
    cholmod_sparse *S; /* upper triangle */
    int *diagonal;     /* [n] places in S */
    double *stiff;     /* of the diagonal, without mass and wells */
    cholmod_factor *L;
    cholmod_dense *b, *x, *y, *e;
} field;

static void room(field *f, int n, int cells, int many, int faces) {
    f->n = n, f->cells = cells, f->many = many, f->faces = faces;
    f->of = take((size_t)n * (size_t)many, sizeof *f->of);
    f->sign = take((size_t)n * (size_t)many, sizeof *f->sign);
    f->face = take((size_t)cells * (size_t)faces, sizeof *f->face);
    f->part = take((size_t)cells * (size_t)faces, sizeof *f->part);
    f->slope = take((size_t)cells, sizeof *f->slope);
}

/* who reads whom, backwards */
static void turn_round(field *f) {
    uint8_t *count = take((size_t)f->n, 1);
    for (int i = 0; i < f->cells; i++)
        for (int j = 0; j < f->faces; j++) {
            const int a = f->face[i * f->faces + j], k = count[a]++;
            f->of[a * f->many + k] = i;
            f->sign[a * f->many + k] = f->part[i * f->faces + j];
        }
    free(count);
}

/* edges 3 v + d of vertex v to v + (1, 0), (0, 1), (1, -1), all of length 1/N */
static void waves(field *f, int N) {
    room(f, N * N, 3 * N * N, 6, 2);
    for (int v = 0; v < N * N; v++) {
        const int i = v / N, j = v % N, x = (i + 1) % N, y = (j + 1) % N;
        const int to[3] = {x * N + j, i * N + y, x * N + (j + N - 1) % N};
        for (int d = 0; d < 3; d++) {
            f->face[2 * (3 * v + d)] = v, f->part[2 * (3 * v + d)] = -1;
            f->face[2 * (3 * v + d) + 1] = to[d], f->part[2 * (3 * v + d) + 1] = 1;
        }
    }
    f->star = 1.0 / sqrt(3.0), f->mass = sqrt(0.75) / N / N;
    f->h = 1.0 / (N * sqrt(6.0));
    turn_round(f);
}

/* number of the edge from v to a larger vertex; edges are in the order of (v, to), as in dmlua, so
 * that the orderings meet the same matrix */
static int edge_of(const int *first, const int (*larger)[6], int v, int to) {
    int k = 0;
    while (larger[v][k] != to) k++;
    return first[v] + k;
}

static int compare(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}

/* the vertices larger than each, ascending, and the number of the first edge to them */
static void number_edges(int N, int *first, int (*larger)[6]) {
    static const int step[6][2] = {{0, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, 0}, {-1, 1}};
    int edges = 0;
    for (int v = 0; v < N * N; v++) {
        int count = 0;
        for (int k = 0; k < 6; k++) {
            const int i = (v / N + step[k][0] + N) % N, j = (v % N + step[k][1] + N) % N;
            if (i * N + j > v) larger[v][count++] = i * N + j;
        }
        qsort(larger[v], (size_t)count, sizeof(int), compare);
        first[v] = edges;
        edges += count;
    }
}

/* two triangles a vertex; faces in ascending order of vertices, the middle one backwards */
static void maxwell(field *f, int N) {
    int *first = take((size_t)(N * N), sizeof *first), (*larger)[6];
    larger = take((size_t)(N * N), sizeof *larger);
    number_edges(N, first, larger);
    room(f, 3 * N * N, 2 * N * N, 2, 3);
    for (int c = 0; c < 2 * N * N; c++) {
        const int v = c / 2, i = v / N, j = v % N, x = (i + 1) % N, y = (j + 1) % N;
        int p[3] = {x * N + j, i * N + y, c % 2 ? x * N + y : v};
        qsort(p, 3, sizeof *p, compare);
        f->face[3 * c] = edge_of(first, larger, p[0], p[1]);
        f->face[3 * c + 1] = edge_of(first, larger, p[0], p[2]);
        f->face[3 * c + 2] = edge_of(first, larger, p[1], p[2]);
        for (int k = 0; k < 3; k++) f->part[3 * c + k] = k == 1 ? -1 : 1;
    }
    f->star = N * N / sqrt(0.1875), f->mass = 1.0 / sqrt(3.0);
    f->h = 0.5 / (N * sqrt(6.0));
    turn_round(f);
    free(first), free(larger);
}

/* ---- the matrix M + h^2/4 (K + mass cos q) ---- */

static void assemble(field *f) {
    const size_t n = (size_t)f->n, faces = (size_t)f->faces;
    const double w = 0.25 * f->h * f->h * f->star;
    cholmod_start(&f->c);
    f->c.final_ll = 1;
    cholmod_triplet *T = cholmod_allocate_triplet(n, n, n + (size_t)f->cells * faces * faces, 1,
                                                  CHOLMOD_REAL, &f->c);
    int *row = T->i, *column = T->j;
    double *x = T->x;
    for (int i = 0; i < f->n; i++) row[T->nnz] = column[T->nnz] = i, x[T->nnz++] = f->mass;
    for (int i = 0; i < f->cells; i++)
        for (int a = 0; a < f->faces; a++)
            for (int b = 0; b < f->faces; b++) {
                const int at = i * f->faces;
                if (f->face[at + a] > f->face[at + b]) continue;
                row[T->nnz] = f->face[at + a], column[T->nnz] = f->face[at + b];
                x[T->nnz++] = w * f->part[at + a] * f->part[at + b];
            }
    f->S = cholmod_triplet_to_sparse(T, T->nnz, &f->c);
    cholmod_sort(f->S, &f->c);
    cholmod_free_triplet(&T, &f->c);
    f->diagonal = take(n, sizeof *f->diagonal), f->stiff = take(n, sizeof *f->stiff);
    for (int i = 0; i < f->n; i++) {
        f->diagonal[i] = ((int *)f->S->p)[i + 1] - 1;
        f->stiff[i] = ((double *)f->S->x)[f->diagonal[i]];
    }
    f->L = cholmod_analyze(f->S, &f->c);
    cholmod_factorize(f->S, f->L, &f->c);
    f->b = cholmod_zeros(n, 1, CHOLMOD_REAL, &f->c);
}

static void refactor(field *f, const double *q) {
    double *value = f->S->x;
    const double w = 0.25 * f->h * f->h * f->mass;
    for (int i = 0; i < f->n; i++) value[f->diagonal[i]] = f->stiff[i] + w * cos(q[i]);
    cholmod_factorize(f->S, f->L, &f->c);
}

/* the solution for f->b */
static const double *solve(field *f) {
    cholmod_solve2(CHOLMOD_A, f->L, f->b, NULL, &f->x, NULL, &f->y, &f->e, &f->c);
    return f->x->x;
}

/* ---- steps ---- */

PLAIN static void slopes(const field *f, const double *A) {
    for (int i = 0; i < f->cells && f->faces == 2; i++)
        f->slope[i] = f->star * (A[f->face[2 * i + 1]] - A[f->face[2 * i]]);
    for (int i = 0; i < f->cells && f->faces == 3; i++)
        f->slope[i] = f->star * (A[f->face[3 * i]] - A[f->face[3 * i + 1]] + A[f->face[3 * i + 2]]);
}

/* -F of entry a; `many` is a number where it is called */
static inline double minus_force(const field *f, int a, int many) {
    double sum = 0.0;
    for (int k = 0; k < many; k++) sum += f->sign[a * many + k] * f->slope[f->of[a * many + k]];
    return sum;
}

PLAIN static void right_side(field *f, const double *p, int many) {
    double *b = f->b->x;
    for (int a = 0; a < f->n; a++)
        b[a] = 0.5 * f->h * p[a] - 0.25 * f->h * f->h * minus_force(f, a, many);
}

static void linear_step(field *f, double *q, double *p) {
    slopes(f, q);
    right_side(f, p, f->many == 6 ? 6 : 2);
    const double *Z = solve(f), scale = 4.0 / f->h * f->mass;
    for (int a = 0; a < f->n; a++) q[a] += 2.0 * Z[a], p[a] = scale * Z[a] - p[a];
}

/* h/2 p - M Z + h^2/4 F(Q) */
static void residual(field *f, const double *p, const double *Q, const double *Z) {
    double *b = f->b->x;
    slopes(f, Q);
    for (int a = 0; a < f->n; a++)
        b[a] = 0.5 * f->h * p[a] - f->mass * Z[a] -
               0.25 * f->h * f->h * (minus_force(f, a, 6) + f->mass * sin(Q[a]));
}

static int nonlinear_step(field *f, double *q, double *p, double *Q, double *Z) {
    double last = INFINITY;
    refactor(f, q);
    for (int a = 0; a < f->n; a++) Z[a] = 0.5 * f->h * p[a] / f->mass, Q[a] = q[a] + Z[a];
    for (int k = 1; k < MOST; k++) {
        double step = 0.0, size = 0.0;
        residual(f, p, Q, Z);
        const double *d = solve(f);
        for (int a = 0; a < f->n; a++) {
            Z[a] += d[a], Q[a] = q[a] + Z[a];
            if (fabs(d[a]) > step) step = fabs(d[a]);
            if (fabs(Z[a]) > size) size = fabs(Z[a]);
        }
        if (step <= 4e-15 * size || (step >= 0.5 * last && step <= 1e-12 * size)) {
            for (int a = 0; a < f->n; a++)
                q[a] += 2.0 * Z[a], p[a] = 4.0 / f->h * f->mass * Z[a] - p[a];
            return k;
        }
        last = step;
    }
    exit(1);
}

static void race(const char *what, field *f, int N) {
    const size_t n = (size_t)f->n;
    double *q = take(n, 8), *p = take(n, 8), *Q = take(n, 8), *Z = take(n, 8), best = 1e9;
    int iterations = 0;
    assemble(f);
    for (int r = 0; r < REPEATS; r++) {
        for (int a = 0; a < f->n; a++) q[a] = sin(a + 1), p[a] = 0.0;
        const double t = now();
        for (int s = 0; s < STEPS; s++)
            if (f->wells)
                iterations = nonlinear_step(f, q, p, Q, Z);
            else
                linear_step(f, q, p);
        best = fmin(best, now() - t);
    }
    printf("%-28s by hand, N = %-4d          %9.1f ns an unknown   (%d; q = %.9f", what, N,
           best / STEPS / f->n * 1e9, f->n, q[1]);
    printf(f->wells ? "; %d iterations)\n" : ")\n", iterations);
}

int main(int count, char **word) {
    const int N = count > 1 ? atoi(word[1]) : 60;
    field a = {0}, b = {0}, c = {.wells = 1};
    waves(&a, N), race("wave, midpoint", &a, N);
    maxwell(&b, N), race("Maxwell, midpoint", &b, N);
    waves(&c, N), race("sine-Gordon, midpoint", &c, N);
    return 0;
}
