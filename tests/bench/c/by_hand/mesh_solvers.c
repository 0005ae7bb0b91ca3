/* mesh_solvers - Poisson's equation and eigenvalues on an icosphere, the rows of
 * tests/bench/mesh_solvers.lua, by hand in C that calls the same libraries: cotangents to the upper
 * triangle of d^T M d, one vertex held, CHOLMOD; ARPACK with shift and invert.
 * cc -O3 -march=native -o mesh_solvers tests/bench/c/by_hand/mesh_solvers.c -lcholmod -larpack -lm
 * mesh_solvers [LEVEL [LEVEL OF EIGENVALUES]] */
#include <arpack/arpack.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *get(size_t size) {
    void *block = calloc(size ? size : 1, 1);
    if (!block) exit(1);
    return block;
}

typedef struct {
    int vertices, cells;
    double (*point)[3];
    int (*cell)[3];
} sphere;

/* numbered as in tests/bench/c/by_hand/meshes.c, so that the values can be compared */
static sphere icosphere(int level) {
    static const int first[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const double g = (1 + sqrt(5)) / 2,
                 start[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    const size_t T = (size_t)20 << (2 * level);
    sphere s = {12, 20, get((T / 2 + 2) * sizeof *s.point), get(T * sizeof *s.cell)};
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 3; j++) s.point[i][j] = start[i][j] / sqrt(1 + g * g);
    memcpy(s.cell, first, sizeof first);
    const uint32_t size = 1u << 21;
    uint64_t *key = get(size * sizeof *key);
    int *value = get(size * sizeof *value), (*old)[3] = get(T * sizeof *old);
    for (int l = 0; l < level; l++) {
        memset(key, 0, size * sizeof *key);
        memcpy(old, s.cell, (size_t)s.cells * sizeof *old);
        for (int t = 0; t < s.cells; t++) {
            int m[3];
            const int *v = old[t];
            for (int i = 0; i < 3; i++) {
                const int a = v[i], b = v[(i + 1) % 3];
                const uint64_t k = (uint64_t)(a < b ? a : b) << 32 | (uint32_t)(a < b ? b : a);
                uint32_t at = (uint32_t)(k * 0x9e3779b97f4a7c15u >> 43);
                while (key[at] && key[at] != k) at = (at + 1) % size;
                if (!key[at]) {
                    double p[3], r = 0;
                    for (int j = 0; j < 3; j++)
                        p[j] = s.point[a][j] + s.point[b][j], r += p[j] * p[j];
                    for (int j = 0; j < 3; j++) s.point[s.vertices][j] = p[j] / sqrt(r);
                    key[at] = k, value[at] = s.vertices++;
                }
                m[i] = value[at];
            }
            const int four[4][3] = {{v[0], m[0], m[2]},
                                    {v[1], m[1], m[0]},
                                    {v[2], m[2], m[1]},
                                    {m[0], m[1], m[2]}};
            memcpy(s.cell + 4 * t, four, sizeof four);
        }
        s.cells *= 4;
    }
    free(key), free(value), free(old);
    return s;
}

/* upper triangle of d^T M_1 d with `shift` M_0 on the diagonal, without the first `held` vertices;
 * mass[vertices] */
static cholmod_sparse *stiffness(const sphere *s, double shift, int held, double *mass,
                                 cholmod_common *c) {
    const size_t n = (size_t)(s->vertices - held);
    cholmod_triplet *T =
        cholmod_allocate_triplet(n, n, (size_t)s->cells * 3 + 3 * n, 1, CHOLMOD_REAL, c);
    int *row = T->i, *column = T->j;
    double *x = T->x, *diagonal = get((size_t)s->vertices * sizeof *diagonal);
    size_t count = 0;
    for (int t = 0; t < s->cells; t++) {
        double l[3], sum;
        const int *v = s->cell[t];
        for (int i = 0; i < 3; i++) {
            const double *p = s->point[v[(i + 1) % 3]], *q = s->point[v[(i + 2) % 3]];
            sum = 0;
            for (int j = 0; j < 3; j++) sum += (p[j] - q[j]) * (p[j] - q[j]);
            l[i] = sum;
        }
        const double mixed = l[0] + l[1] - l[2], area4 = sqrt(4 * l[0] * l[1] - mixed * mixed);
        for (int i = 0; i < 3; i++) {
            const int a = v[(i + 1) % 3], b = v[(i + 2) % 3], lo = a < b ? a : b,
                      hi = a < b ? b : a;
            const double w = (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) / area4 / 2;
            diagonal[a] += w, diagonal[b] += w;
            mass[a] += w * l[i] / 4, mass[b] += w * l[i] / 4;
            if (lo >= held) row[count] = lo - held, column[count] = hi - held, x[count++] = -w;
        }
    }
    for (int v = held; v < s->vertices; v++)
        row[count] = column[count] = v - held, x[count++] = diagonal[v] + shift * mass[v];
    T->nnz = count;
    cholmod_sparse *A = cholmod_triplet_to_sparse(T, count, c);
    cholmod_free_triplet(&T, c);
    free(diagonal);
    return A;
}

static void poisson(const sphere *s) {
    cholmod_common c;
    double *mass = get((size_t)s->vertices * sizeof *mass), began = now();
    cholmod_start(&c);
    cholmod_sparse *A = stiffness(s, 0, 1, mass, &c);
    cholmod_factor *L = cholmod_analyze(A, &c);
    cholmod_factorize(A, L, &c);
    cholmod_dense *b = cholmod_zeros(A->nrow, 1, CHOLMOD_REAL, &c);
    for (size_t i = 0; i < A->nrow; i++) ((double *)b->x)[i] = s->point[i + 1][2] * mass[i + 1];
    cholmod_dense *u = cholmod_solve(CHOLMOD_A, L, b, &c);
    printf("%-34s C by hand %9.1f ms\n", "Poisson, first solve", (now() - began) * 1e3);
    double best = 1e9;
    for (int i = 0; i < 5; i++) {
        cholmod_free_dense(&u, &c);
        began = now();
        u = cholmod_solve(CHOLMOD_A, L, b, &c);
        best = fmin(best, now() - began);
    }
    printf("%-34s C by hand %9.1f ms\n", "Poisson, next solve", best * 1e3);
}

enum { PAIRS = 17, BASIS = 2 * PAIRS + 1 };

static void eigenvalues(const sphere *s) {
    cholmod_common c;
    const int n = s->vertices;
    const size_t size = (size_t)n;
    double *mass = get(size * sizeof *mass), began = now();
    cholmod_start(&c);
    cholmod_sparse *A = stiffness(s, 1, 0, mass, &c);
    cholmod_factor *L = cholmod_analyze(A, &c);
    cholmod_factorize(A, L, &c);
    cholmod_dense *b = cholmod_zeros(size, 1, CHOLMOD_REAL, &c), *x = NULL, *y = NULL, *e = NULL;
    double *v = get(size * BASIS * 8), *work = get(3 * size * 8), small[BASIS * (BASIS + 8)],
           *start = get(size * 8), value[PAIRS];
    int ido = 0, info = 1, select[BASIS], at[14] = {0}, how[11] = {1, 0, 300, 1, 0, 0, 3};
    for (int i = 0; i < n; i++) start[i] = sin(1.0 + i * (double)i);
    for (;;) {
        dsaupd_c(&ido, "G", n, "LM", PAIRS, 1e-14, start, BASIS, v, n, how, at, work, small,
                 BASIS * (BASIS + 8), &info);
        if (ido == 99) break;
        const double *from = ido == 1 ? work + at[2] - 1 : work + at[0] - 1;
        double *to = work + at[1] - 1, *right = ido == 2 ? to : b->x;
        for (int i = 0; i < n; i++) right[i] = ido == 1 ? from[i] : mass[i] * from[i];
        if (ido == 2) continue;
        cholmod_solve2(CHOLMOD_A, L, b, NULL, &x, NULL, &y, &e, &c);
        memcpy(to, x->x, size * 8);
    }
    dseupd_c(1, "A", select, value, v, n, -1.0, "G", n, "LM", PAIRS, 1e-14, start, BASIS, v, n, how,
             at, work, small, BASIS * (BASIS + 8), &info);
    printf("%-34s C by hand %9.1f ms   (the last is %.9f)\n", "17 eigenpairs",
           (now() - began) * 1e3, value[PAIRS - 1]);
}

int main(int count, char **word) {
    const sphere large = icosphere(count > 1 ? atoi(word[1]) : 7);
    poisson(&large);
    const sphere small = icosphere(count > 2 ? atoi(word[2]) : 5);
    eigenvalues(&small);
    return 0;
}
