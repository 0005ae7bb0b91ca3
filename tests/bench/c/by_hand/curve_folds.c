/* curve_folds.c - steps of curve(rk4) for L = -sqrt(1 - v^2) + 1/|q| in the plane, followed in h by
 * arc length from the root of a small step, in long double, with derivatives by dual numbers. A
 * line "q1 q2 v1 v2 h" of the input gives q1 of that root at h, or where the branch turns back (a
 * fold: beyond it small steps have no root) or ends.
 *
 *   cc -O2 -o curve_folds tests/bench/c/by_hand/curve_folds.c -lm && ./curve_folds */
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef long double real;
typedef struct {
    real x, d[4]; /* derivatives in q and in v */
} dual;
enum { STEPS = 6000 };

static real q0[2], p0[2], H;

static dual constant(real x) {
    return (dual){x, {0}};
}
static dual mapped(dual a, real f, real slope) {
    dual r = {f, {0}};
    for (int i = 0; i < 4; i++) r.d[i] = slope * a.d[i];
    return r;
}
static dual scaled(real s, dual a) {
    return mapped(a, s * a.x, s);
}
static dual add(dual a, dual b) {
    a.x += b.x;
    for (int i = 0; i < 4; i++) a.d[i] += b.d[i];
    return a;
}
static dual product(dual a, dual b) {
    return add(mapped(a, a.x * b.x, b.x), mapped(b, 0, a.x));
}
static dual root_of(dual a) {
    return mapped(a, sqrtl(a.x), 0.5L / sqrtl(a.x));
}
static dual inverse(dual a) {
    return mapped(a, 1 / a.x, -1 / (a.x * a.x));
}
static dual dot(const dual *a, const dual *b) {
    return add(product(a[0], b[0]), product(a[1], b[1]));
}

/* sqrt(1 - v^2) */
static dual slowness(const dual *v) {
    return root_of(add(constant(1), scaled(-1, dot(v, v))));
}
static void acceleration(const dual *q, const dual *v, dual *a) {
    const dual r = inverse(root_of(dot(q, q))), r3 = product(r, product(r, r));
    const dual f[2] = {scaled(-1, product(q[0], r3)), scaled(-1, product(q[1], r3))};
    const dual w = slowness(v), work = dot(v, f);
    for (int i = 0; i < 2; i++) a[i] = product(w, add(f[i], scaled(-1, product(work, v[i]))));
}

/* the four stages from the momentum w: Ld and q1; 0: faster than light */
static int segment(const real *w, real h, dual *end, dual *Ld) {
    static const real at[4] = {0, 0.5L, 0.5L, 1}, weight[4] = {1, 2, 2, 1};
    const real g = sqrtl(1 + w[0] * w[0] + w[1] * w[1]);
    dual q[2], v[2], V[2], A[2];
    for (int i = 0; i < 2; i++) {
        end[i] = q[i] = constant(q0[i]), v[i] = constant(w[i] / g), V[i] = A[i] = constant(0);
        end[i].d[i] = q[i].d[i] = v[i].d[2 + i] = 1;
    }
    *Ld = constant(0);
    for (int s = 0; s < 4; s++) {
        dual Q[2];
        for (int i = 0; i < 2; i++) {
            Q[i] = add(q[i], scaled(at[s] * h, V[i]));
            V[i] = add(v[i], scaled(at[s] * h, A[i]));
        }
        if (V[0].x * V[0].x + V[1].x * V[1].x >= 1) return 0;
        acceleration(Q, V, A);
        const dual L = add(inverse(root_of(dot(Q, Q))), scaled(-1, slowness(V)));
        *Ld = add(*Ld, scaled(weight[s] * h / 6, L));
        for (int i = 0; i < 2; i++) end[i] = add(end[i], scaled(weight[s] * h / 6, V[i]));
    }
    return 1;
}

/* f = p0 + D1 Ld(q0, q1) at X = (w, h / H), with p1 = Ld_v / q1_v */
static int equation(const real *X, real *f) {
    dual e[2], L;
    if (!segment(X, X[2] * H, e, &L)) return 0;
    const real a = e[0].d[2], b = e[0].d[3], c = e[1].d[2], d = e[1].d[3], det = a * d - b * c;
    const real p1[2] = {(L.d[2] * d - L.d[3] * c) / det, (L.d[3] * a - L.d[2] * b) / det};
    for (int i = 0; i < 2; i++) f[i] = L.d[i] + p0[i] - p1[0] * e[0].d[i] - p1[1] * e[1].d[i];
    return isfinite(f[0]) && isfinite(f[1]);
}
static int slopes(const real *X, real J[2][3]) {
    for (int k = 0; k < 3; k++) {
        const real s = 1e-7L * (k == 2 ? fabsl(X[2]) : 1 + fabsl(X[k]));
        real Y[3] = {X[0], X[1], X[2]}, plus[2], minus[2];
        Y[k] = X[k] + s;
        if (!equation(Y, plus)) return 0;
        Y[k] = X[k] - s;
        if (!equation(Y, minus)) return 0;
        for (int i = 0; i < 2; i++) J[i][k] = (plus[i] - minus[i]) / (2 * s);
    }
    return 1;
}
static void cross(const real *a, const real *b, real *t) {
    for (int i = 0; i < 3; i++)
        t[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}
static real inner(const real *a, const real *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* X to the branch, in the plane of normal n through it, with the tangent t: iterations, -1: none */
static int correct(real *X, const real *n, real *t) {
    const real place[3] = {X[0], X[1], X[2]};
    for (int k = 0; k < 25; k++) {
        real f[2], J[2][3], u[3], w[3], off[3], step = 0;
        if (!equation(X, f) || !slopes(X, J)) return -1;
        for (int i = 0; i < 3; i++) off[i] = X[i] - place[i];
        cross(J[0], J[1], t); /* Cramer's rule */
        cross(J[1], n, u);
        cross(n, J[0], w);
        const real det = inner(t, n), g = inner(n, off);
        for (int i = 0; i < 3; i++) {
            const real d = -(f[0] * u[i] + f[1] * w[i] + g * t[i]) / det;
            X[i] += d;
            step = fmaxl(step, fabsl(d) / (1 + fabsl(X[i])));
        }
        const real size = sqrtl(inner(t, t));
        for (int i = 0; i < 3; i++) t[i] /= size;
        if (!isfinite(step)) return -1;
        if (step < 1e-12L) return k;
    }
    return -1;
}

static void follow(void) {
    static const real up[3] = {0, 0, 1};
    real X[3] = {p0[0], p0[1], 1e-4L}, t[3], ds = 1e-3L;
    int last = correct(X, up, t);
    if (t[2] < 0) t[0] = -t[0], t[1] = -t[1], t[2] = -t[2];
    for (int k = 0; last >= 0 && k < STEPS && ds > 1e-13L; k++) {
        real Y[3], next[3];
        for (int i = 0; i < 3; i++) Y[i] = X[i] + ds * t[i];
        const int past = Y[2] >= 1; /* the root at h itself */
        if (past)
            for (int i = 0; i < 3; i++) Y[i] = X[i] + (1 - X[2]) / t[2] * t[i];
        last = correct(Y, past ? up : t, next);
        const real turn = last >= 0 ? inner(t, next) : 0;
        if (fabsl(turn) < 0.995L) {
            ds *= 0.5L, last = 0;
            continue;
        }
        for (int i = 0; i < 3; i++) next[i] *= turn < 0 ? -1 : 1;
        if (past) {
            dual e[2], L;
            segment(Y, H, e, &L);
            printf("%.15Lf %.15Lf\n", e[0].x, e[1].x);
            return;
        }
        if (next[2] < 0) {
            printf("a fold at %.4Lf h\n", Y[2]);
            return;
        }
        memcpy(X, Y, sizeof X);
        memcpy(t, next, sizeof t);
        if (last < 4) ds = fminl(1.5L * ds, 0.02L * (1 + fabsl(X[0]) + fabsl(X[1])));
    }
    printf("no end by %.4Lf h, momentum %.3Lg %.3Lg\n", X[2], X[0], X[1]);
}

int main(void) {
    real v[2];
    while (scanf("%Lf %Lf %Lf %Lf %Lf", &q0[0], &q0[1], &v[0], &v[1], &H) == 5) {
        const real g = 1 / sqrtl(1 - v[0] * v[0] - v[1] * v[1]);
        p0[0] = g * v[0], p0[1] = g * v[1];
        follow();
    }
    return 0;
}
