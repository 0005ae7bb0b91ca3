/* looks_members - what it costs members of an ensemble by hand to see that d2L/dv2 keeps its signs:
 * 16 double spherical pendulums in angles (newton_models.c) a little apart, four side by side,
 * midpoint steps with Newton's method to round-off from a quadratic guess, no rows exchanged: without
 * looks; with one at every state; with one when due, by the schedule of dmlua for members
 * (src/run/inertia/inertia_look.c, dm_inertia_is_quiet), the line from the last look searched in its
 * middle where the product of all values moved by more than it was let; at a start looks at the
 * place, at what rounding makes of it, ahead and between. Argument: one of these, 0 to 3, once, to
 * count its instructions (callgrind, --toggle-collect=run).
 *   cc -O2 -mavx2 -mfma -o looks_members tests/bench/c/by_hand/looks_members.c -lmvec -lm */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 4, W = 4, GROUPS = 4, TURNS = 200, MOST = 512, ITERATIONS = 50 };
typedef double V __attribute__((vector_size(8 * W)));
typedef long long I __attribute__((vector_size(8 * W)));
V _ZGVdN4v_sin(V x), _ZGVdN4v_cos(V x); /* of glibc's libmvec */

typedef enum { NEVER, STARTS, EVERY, DUE, POLICIES } policy;
static const char *const names[] = {"no looks", "at starts alone", "at every state", "when due"};
static const double STEP = 0.01, NEAR = 4.0;

typedef struct {
    double least, all, left, nearest, rate, way, reach;
    long looked, due;
    int fell;
} seen;

/* four members: states, velocities of the last three steps, what looks have seen */
typedef struct {
    V q[N], p[N], v[3][N], place[N]; /* place: of the last looks */
    seen seen[W];
    long looks, lines, lost;
} group;

typedef struct {
    V Lq[N], Lv[N], Lqq[N][N], Lqv[N][N], Lvv[N][N];
} derivatives;

static inline V same(double x) {
    return x - (V){0};
}
static inline V pick(I yes, V a, V b) {
    return (V)((yes & (I)a) | (~yes & (I)b));
}
static inline V size_of(V x) {
    return (V)((I)x & ~(I)same(-0.0));
}
static inline int some(I yes) {
    return (yes[0] | yes[1] | yes[2] | yes[3]) != 0;
}

/* ---- the pendulum ---- */

typedef struct {
    V w[3], a[3], x[3], y[3], ax[3], ay[3];
} rod;

static inline rod rod_at(V s, V c, V x, V y) {
    const V o = {0};
    return (rod){{c * x, s * y, s * x},
                 {-s * x, c * y, c * x},
                 {c, o, s},
                 {o, s, o},
                 {-s, o, c},
                 {o, c, o}};
}
static inline void turn(V *w, V s, V c) {
    const V x = w[0], y = w[1];
    w[0] = c * x - s * y, w[1] = s * x + c * y;
}
static inline V dot(const V *x, const V *y) {
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}
static inline V across(const V *u, const V *w) {
    return u[1] * w[0] - u[0] * w[1];
}
static inline void set(V M[N][N], int i, int j, V x) {
    M[i][j] = M[j][i] = x;
}

static inline void couple(derivatives *d, const rod *f, const rod *g) {
    const V all = dot(f->w, g->w), level = all - f->w[2] * g->w[2], beside = across(f->w, g->w);
    const V ab = across(f->a, g->w), ba = across(f->w, g->a);
    d->Lq[0] += dot(f->a, g->w), d->Lq[1] -= beside;
    d->Lq[2] += dot(f->w, g->a), d->Lq[3] += beside;
    d->Lv[0] += dot(f->x, g->w), d->Lv[1] += dot(f->y, g->w);
    d->Lv[2] += dot(f->w, g->x), d->Lv[3] += dot(f->w, g->y);
    d->Lqq[0][0] -= all, d->Lqq[2][2] -= all, d->Lqq[1][1] -= level, d->Lqq[3][3] -= level;
    set(d->Lqq, 1, 3, level), set(d->Lqq, 0, 1, -ab), set(d->Lqq, 0, 3, ab);
    set(d->Lqq, 0, 2, dot(f->a, g->a)), set(d->Lqq, 1, 2, -ba), set(d->Lqq, 2, 3, ba);
    const V vx[N] = {across(f->x, g->w), across(f->y, g->w), across(f->w, g->x),
                     across(f->w, g->y)};
    for (int j = 0; j < N; j++) d->Lqv[1][j] -= vx[j], d->Lqv[3][j] += vx[j];
    d->Lqv[0][0] += dot(f->ax, g->w), d->Lqv[0][1] += dot(f->ay, g->w);
    d->Lqv[0][2] += dot(f->a, g->x), d->Lqv[0][3] += dot(f->a, g->y);
    d->Lqv[2][0] += dot(f->x, g->a), d->Lqv[2][1] += dot(f->y, g->a);
    d->Lqv[2][2] += dot(f->w, g->ax), d->Lqv[2][3] += dot(f->w, g->ay);
    set(d->Lvv, 0, 2, dot(f->x, g->x)), set(d->Lvv, 0, 3, dot(f->x, g->y));
    set(d->Lvv, 1, 2, dot(f->y, g->x)), set(d->Lvv, 1, 3, dot(f->y, g->y));
}

static inline void own(derivatives *d, int i, double m, V s, V c, const V *v) {
    const V x = v[i], y = v[i + 1];
    const double g = 9.81;
    d->Lq[i] = m * (s * c * y * y - g * s), d->Lq[i + 1] = (V){0};
    d->Lv[i] = m * x, d->Lv[i + 1] = m * s * s * y;
    d->Lqq[i][i] = m * ((c * c - s * s) * y * y - g * c);
    d->Lqv[i][i + 1] = 2.0 * m * s * c * y;
    d->Lvv[i][i] = same(m), d->Lvv[i + 1][i + 1] = m * s * s;
}

static void pendulum(derivatives *d, const V *q, const V *v) {
    const V s1 = _ZGVdN4v_sin(q[0]), c1 = _ZGVdN4v_cos(q[0]), s2 = _ZGVdN4v_sin(q[2]);
    const V c2 = _ZGVdN4v_cos(q[2]), sd = _ZGVdN4v_sin(q[3] - q[1]);
    const V cd = _ZGVdN4v_cos(q[3] - q[1]);
    const rod f = rod_at(s1, c1, v[0], v[1]);
    rod g = rod_at(s2, c2, v[2], v[3]);
    V *turned[] = {g.w, g.a, g.x, g.y, g.ax, g.ay};
    for (int i = 0; i < 6; i++) turn(turned[i], sd, cd);
    memset(d->Lqq, 0, sizeof d->Lqq), memset(d->Lqv, 0, sizeof d->Lqv);
    memset(d->Lvv, 0, sizeof d->Lvv);
    own(d, 0, 2.0, s1, c1, v), own(d, 2, 1.0, s2, c2, v);
    couple(d, &f, &g);
}

/* ---- steps ---- */

/* x = A^-1 x */
static inline void solve(V A[N][N], V *x) {
#pragma GCC unroll 4
    for (int k = 0; k < N; k++) {
        const V inverse = 1.0 / A[k][k];
#pragma GCC unroll 4
        for (int i = k + 1; i < N; i++) {
            const V f = A[i][k] * inverse;
#pragma GCC unroll 4
            for (int j = k + 1; j < N; j++) A[i][j] -= f * A[k][j];
            x[i] -= f * x[k];
        }
        A[k][k] = inverse;
    }
#pragma GCC unroll 4
    for (int i = N - 1; i >= 0; i--) {
#pragma GCC unroll 4
        for (int j = i + 1; j < N; j++) x[i] -= A[i][j] * x[j];
        x[i] *= A[i][i];
    }
}

static inline V largest(const V *x) {
    V m = size_of(x[0]);
    for (int i = 1; i < N; i++) m = pick(size_of(x[i]) > m, size_of(x[i]), m);
    return m;
}

/* a lane whose increment is round-off keeps its v */
static int newton(group *g, V *v, derivatives *d) {
    const double h = STEP;
    V before = same(INFINITY), middle[N], r[N], J[N][N];
    I open = ~(I){0};
    for (int k = 0; k < ITERATIONS && some(open); k++) {
        for (int i = 0; i < N; i++) middle[i] = g->q[i] + 0.5 * h * v[i];
        pendulum(d, middle, v);
        for (int i = 0; i < N; i++) {
            r[i] = g->p[i] - d->Lv[i] + 0.5 * h * d->Lq[i];
            for (int j = 0; j < N; j++)
                J[i][j] = d->Lvv[i][j] + 0.5 * h * (d->Lqv[j][i] - d->Lqv[i][j]) -
                          0.25 * h * h * d->Lqq[i][j];
        }
        solve(J, r);
        for (int i = 0; i < N; i++) v[i] = pick(open, v[i] + r[i], v[i]);
        const V change = largest(r), size = largest(v);
        open &= ~((change <= 4e-15 * size) | ((change >= before) & (change < 1e-12 * size)));
        before = change;
    }
    return !some(open);
}

static int step(group *g) {
    derivatives d;
    V v[N];
    for (int i = 0; i < N; i++) v[i] = 3.0 * (g->v[0][i] - g->v[1][i]) + g->v[2][i];
    if (!newton(g, v, &d)) return 0;
    for (int i = 0; i < N; i++) {
        g->q[i] += STEP * v[i], g->p[i] += STEP * d.Lq[i];
        g->v[2][i] = g->v[1][i], g->v[1][i] = g->v[0][i], g->v[0][i] = v[i];
    }
    return 1;
}

/* ---- looks ---- */

/* pivots of d2L/dv2 with ones on the diagonal where rods are level: the least, their product */
static V pivots(const V *q, V *least) {
    const V s1 = _ZGVdN4v_sin(q[0]), c1 = _ZGVdN4v_cos(q[0]), s2 = _ZGVdN4v_sin(q[2]);
    const V c2 = _ZGVdN4v_cos(q[2]), sd = _ZGVdN4v_sin(q[3] - q[1]);
    const V cd = _ZGVdN4v_cos(q[3] - q[1]), one = same(1.0), o = {0};
    const double u = sqrt(0.5);
    V M[N][N] = {{one},
                 {o, s1 * s1},
                 {u * (c1 * cd * c2 + s1 * s2), u * s1 * sd * c2, one},
                 {-u * c1 * sd * s2, u * s1 * cd * s2, o, s2 * s2}};
    V all = one;
    *least = same(INFINITY);
#pragma GCC unroll 4
    for (int k = 0; k < N; k++) {
        const V inverse = 1.0 / M[k][k];
        *least = pick(M[k][k] < *least, M[k][k], *least), all *= M[k][k];
#pragma GCC unroll 4
        for (int i = k + 1; i < N; i++) {
            const V f = M[i][k] * inverse;
#pragma GCC unroll 4
            for (int j = k + 1; j <= i; j++) M[i][j] -= f * M[j][k];
        }
    }
    return all;
}

static inline double lesser(double a, double b) {
    return b < a ? b : a;
}
static inline double larger(double a, double b) {
    return b > a ? b : a;
}

static inline double left_of(double before, double now, double since) {
    return before > now ? since / (before / now * sqrt(before / now) - 1.0) : INFINITY;
}

/* dm_inertia_is_quiet and what it keeps; 1: the line from the last look is to be searched */
static int judge(seen *s, double least, double all, long done) {
    const double since = (double)(done - s->looked), ratio = all / s->all;
    const double fall = left_of(s->all, all, since), back = left_of(all, s->all, since) + since;
    const double left = lesser(fall, back);
    const int line = (s->fell && ratio > 1.0) || !(ratio < 1.4 && ratio * 1.4 > 1.0) ||
                     (since == 1.0 && lesser(s->nearest, left) < NEAR);
    s->left = left_of(s->least, least, since), s->nearest = lesser(s->left, left);
    const double rate = log(lesser(ratio, least / s->least)) / since;
    const double bend = s->way > 0.0 ? 2.0 * (rate - s->rate) / (since + s->way) : 0.0;
    const double now = fabs(rate + 0.5 * bend * since), let = larger(s->reach, since);
    const double steps = 0.6 / (now + sqrt(now * now + 0.6 * fabs(bend)));
    const double still = lesser(steps, larger(let + 1.0, lesser(2.0 * let, 0.25 * steps)));
    const double far = s->left <= NEAR ? 1.0 : lesser(lesser(0.5 * s->nearest, MOST), still);
    long unit = 1;
    s->reach = larger(far, 1.0);
    while (2 * unit <= (long)s->reach) unit *= 2;
    s->rate = rate, s->way = since;
    s->due = (done + (long)s->reach) & -unit;
    s->least = least, s->all = all, s->fell = ratio < 1.0, s->looked = done;
    return line;
}

/* Is the product small in the middle of the line to the state before? */
static void search(group *g, const V *from, int line, V first, V last) {
    V middle[N], least;
    for (int i = 0; i < N; i++) middle[i] = 0.5 * (from[i] + g->q[i]);
    const V all = pivots(middle, &least);
    for (int l = 0; l < W; l++)
        if (line >> l & 1) g->lines++, g->lost += all[l] < 0.5 * larger(first[l], last[l]);
}

static void look(group *g, long done) {
    V least, first = {0};
    const V all = pivots(g->q, &least);
    int line = 0;
    for (int l = 0; l < W; l++) {
        if (done < g->seen[l].due) continue;
        first[l] = g->seen[l].all;
        g->lost += !(least[l] > 0.0), g->looks++;
        line |= judge(&g->seen[l], least[l], all[l], done) << l;
    }
    if (line) search(g, g->place, line, first, all);
    for (int l = 0; l < W; l++)
        for (int i = 0; i < N && g->seen[l].looked == done; i++) g->place[i][l] = g->q[i][l];
}

/* the place, what rounding makes of it, one step ahead, and between */
static void begin_looks(group *g) {
    V least, ahead, side[N];
    const V all = pivots(g->q, &least);
    for (int sign = -1; sign < 2; sign += 2) {
        for (int i = 0; i < N; i++) side[i] = g->q[i] * (1.0 + (i % 2 ? sign : -sign) * 7.1e-15);
        pivots(side, &ahead);
        for (int l = 0; l < W; l++) g->lost += !(ahead[l] > 0.0);
    }
    for (int i = 0; i < N; i++) side[i] = g->q[i] + STEP * g->v[0][i], g->place[i] = g->q[i];
    const V after = pivots(side, &ahead);
    search(g, side, (1 << W) - 1, all, after);
    for (int l = 0; l < W; l++) {
        const double falls = least[l] - ahead[l];
        const double left = falls > 0.0 ? least[l] / (1.5 * falls) : INFINITY;
        g->seen[l] =
            (seen){.least = least[l], .all = all[l], .left = left, .nearest = left, .due = 1};
    }
}

/* ---- runs ---- */

static void begin(group *g, int number) {
    static const double q[N] = {1.0, 0.0, 0.7, 0.4}, v[N] = {0.0, 1.5, 0.0, 2.0};
    derivatives d;
    *g = (group){0};
    for (int i = 0; i < N; i++)
        g->q[i] = same(q[i]), g->v[0][i] = g->v[1][i] = g->v[2][i] = same(v[i]);
    for (int l = 0; l < W; l++) g->q[0][l] += 0.1 * (number * W + l + 1) / (GROUPS * W);
    pendulum(&d, g->q, g->v[0]);
    memcpy(g->p, d.Lv, sizeof g->p);
}

__attribute__((noinline)) static double run(policy how, long steps, group *all) {
    double sum = 0.0;
    for (int k = 0; k < GROUPS; k++) {
        group *g = all + k;
        begin(g, k);
        if (how != NEVER) begin_looks(g);
        long next = how == DUE ? 1 : how == EVERY ? 0 : steps + 1;
        for (long done = 1; done <= steps; done++) {
            if (!step(g)) return NAN;
            if (how == EVERY) {
                V least;
                pivots(g->q, &least);
                for (int l = 0; l < W; l++) g->lost += !(least[l] > 0.0), g->looks++;
            } else if (done >= next) {
                look(g, done);
                next = g->seen[0].due;
                for (int l = 1; l < W; l++) next = next < g->seen[l].due ? next : g->seen[l].due;
            }
        }
        sum += g->q[0][0];
    }
    return sum;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void print(policy how, long steps, double ns, double none, const group *g) {
    const double all = (double)steps * GROUPS * W;
    double looks = 0.0, lines = 0.0, lost = 0.0;
    for (int k = 0; k < GROUPS; k++)
        looks += (double)g[k].looks, lines += (double)g[k].lines, lost += (double)g[k].lost;
    printf("%5ld steps, %-16s %7.1f ns a step %6.3f  looks %.3f  lines %.3f  lost %.0f\n", steps,
           names[how], ns / all, ns / none, looks / all, lines / all, lost);
}

int main(int count, char **argument) {
    static const long lengths[] = {1, 200, 1000};
    static group g[POLICIES][GROUPS];
    if (count > 1) {
        const long steps = count > 2 ? atol(argument[2]) : 200;
        printf("%.17g\n", run((policy)atoi(argument[1]), steps, g[0]));
        return 0;
    }
    for (int l = 0; l < 3; l++) {
        double best[POLICIES] = {INFINITY, INFINITY, INFINITY, INFINITY};
        for (int turns = 0; turns < TURNS; turns++)
            for (int how = NEVER; how < POLICIES; how++) {
                const double t = now();
                if (!isfinite(run((policy)how, lengths[l], g[how]))) return 1;
                best[how] = fmin(best[how], now() - t);
            }
        for (int how = NEVER; how < POLICIES; how++)
            print((policy)how, lengths[l], best[how], best[NEVER], g[how]);
    }
    return 0;
}
