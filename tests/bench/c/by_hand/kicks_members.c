/* kicks_members.c - what compensated sums cost members of Verlet's rule in C by hand: 32 Kepler orbits,
 * four side by side, a state that is whole at the end of every step; rows of docs/benchmarks/steps.md.
 * Operations a coordinate of a step beside the force:
 *   plain       4     no low parts
 *   rounded     13    low + a b in one rounding: J drifts by 2e-20 a step where forces are linear
 *   exact       15    low + (a b + (high - high')), and h low_p goes into the low part of q: no drift
 *   one kick    11    the same with one kick a step, its p between two steps: no row can be shown
 *   cc -O2 -mavx2 -mfma -o kicks_members tests/bench/c/by_hand/kicks_members.c -lm
 *   ./kicks_members                                                   ns a step of a member
 *   valgrind --tool=callgrind --toggle-collect=run_exact ./kicks_members 1 1000    instructions */
#include <immintrin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { LANES = 4, GROUPS = 8, MEMBERS = LANES * GROUPS };
enum sums { PLAIN, ROUNDED, EXACT, ONE_KICK };

typedef double four __attribute__((vector_size(8 * LANES)));

/* f: -h/2 / r^3 of the last force, which the next step begins with */
typedef struct {
    four q[2], p[2], low_q[2], low_p[2], f;
} group;

#define INLINE __attribute__((always_inline)) static inline

INLINE four factor(const four q[2], double hb) {
    const four rr = q[0] * q[0] + q[1] * q[1];
    return -hb / (rr * _mm256_sqrt_pd(rr));
}

/* p = what a kick of f q makes of `from`; the low part of that */
INLINE void kick(group *g, int i, four from, enum sums how) {
    const four old = g->p[i], low = g->low_p[i];
    g->p[i] = g->f * g->q[i] + from;
    if (how == ROUNDED)
        g->low_p[i] = (g->f * g->q[i] + low) + (old - g->p[i]);
    else if (how != PLAIN)
        g->low_p[i] = low + (g->f * g->q[i] + (old - g->p[i]));
}

/* what of a drift comes before the force, and after it */
INLINE void drift(group *g, const four old[2], double h, enum sums how) {
    for (int i = 0; i < 2; i++) {
        if (how == PLAIN)
            g->q[i] = h * g->p[i] + old[i];
        else
            g->q[i] = old[i] + (h * g->p[i] + g->low_q[i]);
    }
}
INLINE void leave(group *g, const four old[2], double h, enum sums how) {
    for (int i = 0; i < 2 && how != PLAIN; i++) {
        const four lost = old[i] - g->q[i];
        if (how == ROUNDED)
            g->low_q[i] = (h * g->p[i] + g->low_q[i]) + lost;
        else
            g->low_q[i] = h * g->low_p[i] + (g->low_q[i] + (h * g->p[i] + lost));
    }
}

INLINE void step(group *g, double h, enum sums how) {
    const double hb = how == ONE_KICK ? h : h / 2;
    for (int i = 0; i < 2 && how != ONE_KICK; i++) kick(g, i, g->p[i], how);
    const four old[2] = {g->q[0], g->q[1]};
    drift(g, old, h, how);
    const four f = factor(g->q, hb);
    leave(g, old, h, how);
    g->f = f;
    for (int i = 0; i < 2; i++) kick(g, i, how == PLAIN ? g->p[i] : g->p[i] + g->low_p[i], how);
}

#define RUN(name, how)                                                                             \
    __attribute__((noinline)) static void run_##name(group *all, long steps, double h) {           \
        for (long k = 0; k < steps; k++)                                                           \
            for (int g = 0; g < GROUPS; g++) step(all + g, h, how);                                \
    }
RUN(plain, PLAIN)
RUN(rounded, ROUNDED)
RUN(exact, EXACT)
RUN(one_kick, ONE_KICK)

static void start(group *all, double h) {
    for (int i = 0; i < MEMBERS; i++) {
        group *g = all + i / LANES;
        const int k = i % LANES;
        g->q[0][k] = 0.4 + 0.1 * i / MEMBERS, g->q[1][k] = 0.0;
        g->p[0][k] = 0.0, g->p[1][k] = 2.0;
        for (int c = 0; c < 2; c++) g->low_q[c][k] = g->low_p[c][k] = 0.0;
        g->f = factor(g->q, h / 2);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int count, char **word) {
    static void (*const run[])(group *, long, double) = {run_plain, run_rounded, run_exact,
                                                         run_one_kick};
    static const char *const name[] = {"plain", "rounded", "exact", "one kick"};
    const int turns = count > 1 ? atoi(word[1]) : 200;
    const long steps = count > 2 ? atol(word[2]) : 5000;
    static group all[GROUPS];
    double least[4] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, sum = 0.0;
    for (int turn = 0; turn < turns; turn++)
        for (int k = 0; k < 4; k++) {
            start(all, 0.05);
            const double t = now();
            run[k](all, steps, 0.05);
            least[k] = fmin(least[k], (now() - t) / (double)steps / MEMBERS);
            sum += all[0].q[0][0];
        }
    for (int k = 0; k < 4; k++)
        printf("%-9s %6.3f ns  %.3f of rounded\n", name[k], least[k] * 1e9, least[k] / least[1]);
    return sum == 0.0;
}
