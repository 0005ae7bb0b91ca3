/* pairs.c - Verlet steps of bodies in pairs, as one writes them in C: all pairs of a cluster of
 * stars, a row of partners in lanes by `omp simd`, both bodies at once; and Lennard-Jones atoms in
 * a periodic box, by lists of the partners within r + margin, made by way of cells and kept until
 * an atom has moved half of the margin. Prints ns a pair and step, the best of some runs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STARS = 1000, SIDE = 6, ATOMS = 4 * SIDE * SIDE * SIDE, STEPS = 40, REPEATS = 9 };
enum { MOST = ATOMS > STARS ? ATOMS : STARS, LIST = 96 * ATOMS };

static double x[3][MOST], v[3][MOST], f[3][MOST], mass[MOST], then[3][MOST];
static int start[ATOMS + 1], item[LIST], count_lists;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- all pairs ---- */

static void gravity(int n) {
    const double soft = 0.02 * 0.02;
    memset(f, 0, sizeof f);
    for (int i = 0; i < n; i++) {
        const double a = x[0][i], b = x[1][i], c = x[2][i], m = mass[i];
        double fa = 0.0, fb = 0.0, fc = 0.0;
#pragma omp simd reduction(+ : fa, fb, fc)
        for (int j = i + 1; j < n; j++) {
            const double dx = a - x[0][j], dy = b - x[1][j], dz = c - x[2][j];
            const double r2 = dx * dx + dy * dy + dz * dz + soft, s = m * mass[j] / (r2 * sqrt(r2));
            fa -= s * dx, fb -= s * dy, fc -= s * dz;
            f[0][j] += s * dx, f[1][j] += s * dy, f[2][j] += s * dz;
        }
        f[0][i] += fa, f[1][i] += fb, f[2][i] += fc;
    }
}

/* ---- pairs by lists ---- */

static const double cut = 2.5, margin = 0.3;
static double box;

/* by way of cells at least r + margin wide: SIDE = 6 has three of them along a side */
static void make_lists(int n) {
    const double reach = cut + margin;
    int many = (int)(box / reach), used = 0;
    static int head[1000], next[ATOMS], cell[ATOMS];
    for (int c = 0; c < many * many * many; c++) head[c] = -1;
    for (int i = n; i-- > 0;) {
        int at[3];
        for (int k = 0; k < 3; k++) {
            const double s = x[k][i] / box - floor(x[k][i] / box);
            at[k] = (int)(s * many) % many;
        }
        cell[i] = (at[2] * many + at[1]) * many + at[0];
        next[i] = head[cell[i]], head[cell[i]] = i;
    }
    for (int i = 0; i < n; i++) {
        const int cx = cell[i] % many, cy = cell[i] / many % many, cz = cell[i] / many / many;
        start[i] = used;
        for (int k = 0; k < 27; k++) {
            const int a = (cx + k % 3 + many - 1) % many, b = (cy + k / 3 % 3 + many - 1) % many;
            const int c = (cz + k / 9 + many - 1) % many;
            for (int j = head[(c * many + b) * many + a]; j >= 0; j = next[j]) {
                double r2 = 0.0;
                for (int l = 0; l < 3; l++) {
                    double d = x[l][i] - x[l][j];
                    d -= box * rint(d / box);
                    r2 += d * d;
                }
                if (j > i && r2 < reach * reach) item[used++] = j;
            }
        }
    }
    start[n] = used;
    memcpy(then, x, sizeof x);
    count_lists++;
}

static void lennard_jones(int n) {
    double moved = 0.0;
    for (int i = 0; i < n; i++) {
        const double a = x[0][i] - then[0][i], b = x[1][i] - then[1][i], c = x[2][i] - then[2][i];
        moved = fmax(moved, a * a + b * b + c * c);
    }
    if (!start[n] || moved > 0.25 * margin * margin) make_lists(n);
    memset(f, 0, sizeof f);
    const double inverse = 1.0 / box;
    for (int i = 0; i < n; i++) {
        const double a = x[0][i], b = x[1][i], c = x[2][i];
        double fa = 0.0, fb = 0.0, fc = 0.0;
        for (int k = start[i]; k < start[i + 1]; k++) {
            const int j = item[k];
            double dx = a - x[0][j], dy = b - x[1][j], dz = c - x[2][j];
            dx -= box * rint(dx * inverse), dy -= box * rint(dy * inverse);
            dz -= box * rint(dz * inverse);
            const double r2 = dx * dx + dy * dy + dz * dz;
            if (r2 >= cut * cut) continue;
            const double s2 = 1.0 / r2, s6 = s2 * s2 * s2, s = 24.0 * (2.0 * s6 - 1.0) * s6 * s2;
            fa += s * dx, fb += s * dy, fc += s * dz;
            f[0][j] -= s * dx, f[1][j] -= s * dy, f[2][j] -= s * dz;
        }
        f[0][i] += fa, f[1][i] += fb, f[2][i] += fc;
    }
}

/* ---- steps ---- */

static void verlet(int n, double h, void (*force)(int)) {
    force(n);
    for (int step = 0; step < STEPS; step++) {
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < n; i++) {
                v[k][i] += 0.5 * h * f[k][i] / mass[i];
                x[k][i] += h * v[k][i];
            }
        force(n);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < n; i++) v[k][i] += 0.5 * h * f[k][i] / mass[i];
    }
}

static void stars(void) {
    for (int i = 0; i < STARS; i++) {
        mass[i] = 1.0 / STARS;
        for (int k = 0; k < 3; k++)
            x[k][i] = fmod((i + 1) * (0.618033988749895 + 0.1300000000000001 * k), 1.0),
            v[k][i] = 0.0;
    }
}

static void atoms(void) {
    static const double corner[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    box = cbrt(ATOMS / 0.8442);
    start[ATOMS] = 0;
    for (int i = 0; i < ATOMS; i++) {
        const int c = i / 4, at[3] = {c / SIDE / SIDE, c / SIDE % SIDE, c % SIDE};
        mass[i] = 1.0;
        for (int k = 0; k < 3; k++) {
            x[k][i] = (at[k] + corner[i % 4][k]) * box / SIDE;
            v[k][i] = 3.6 * (fmod((3 * i + k + 1) * 0.618033988749895, 1.0) - 0.5);
        }
    }
}

static void race(const char *name, int n, double pairs, double h, void (*begin)(void),
                 void (*force)(int)) {
    double best = INFINITY;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        begin();
        const double began = now();
        verlet(n, h, force);
        best = fmin(best, now() - began);
    }
    printf("%-28s by hand in C        %9.2f ns a pair   (%d bodies, x = %.9f)\n", name,
           best / (STEPS + 1) / pairs * 1e9, n, x[0][0]);
}

/* pairs nearer than the cut at the start */
static double count_near(void) {
    double count = 0.0;
    for (int i = 0; i < ATOMS; i++)
        for (int j = i + 1; j < ATOMS; j++) {
            double r2 = 0.0;
            for (int k = 0; k < 3; k++) {
                double d = x[k][i] - x[k][j];
                d -= box * rint(d / box);
                r2 += d * d;
            }
            count += r2 < cut * cut;
        }
    return count;
}

int main(void) {
    race("all pairs", STARS, 0.5 * STARS * (STARS - 1), 1e-3, stars, gravity);
    atoms();
    race("pairs by lists", ATOMS, count_near(), 0.004, atoms, lennard_jones);
    return 0;
}
