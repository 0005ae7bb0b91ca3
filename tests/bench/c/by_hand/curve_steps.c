/* curve_steps.c - steps of curve(rk4) for L = -sqrt(1 - v^2) - a q - b q^2 by a continuation in h in
 * long double, with derivatives by dual numbers: a line "a b q v h" of the input gives q1 of the
 * root that is the one of a small step.
 *
 *   cc -O2 -o curve_steps tests/bench/c/by_hand/curve_steps.c -lm && ./curve_steps */
#include <math.h>
#include <stdio.h>

typedef long double real;
typedef struct {
    real x, q, v; /* derivatives in q and in v = tanh u by u */
} dual;

static dual constant(real x) {
    return (dual){x, 0, 0};
}
static dual add(dual a, dual b) {
    return (dual){a.x + b.x, a.q + b.q, a.v + b.v};
}
static dual scaled(real s, dual a) {
    return (dual){s * a.x, s * a.q, s * a.v};
}
static dual product(dual a, dual b) {
    return (dual){a.x * b.x, a.q * b.x + a.x * b.q, a.v * b.x + a.x * b.v};
}
static dual root_of(dual a) {
    const real r = sqrtl(a.x);
    return (dual){r, a.q / (2 * r), a.v / (2 * r)};
}

static real a, b, q0, p0;

static dual defect(dual v) {
    return add(constant(1), scaled(-1, product(v, v)));
}
static dual acceleration(dual q, dual v) {
    const dual w = defect(v), force = scaled(-1, add(constant(a), scaled(2 * b, q)));
    return product(force, product(w, root_of(w)));
}
static dual lagrangian(dual q, dual v) {
    const dual V = add(scaled(a, q), scaled(b, product(q, q)));
    return scaled(-1, add(root_of(defect(v)), V));
}

/* the four stages: Ld and q1 */
static dual segment(real h, real u, dual *Ld) {
    static const real at[4] = {0, 0.5L, 0.5L, 1}, weight[4] = {1, 2, 2, 1};
    const real t = tanhl(u);
    const dual q = {q0, 1, 0}, v = {t, 0, 1 - t * t};
    dual V = constant(0), A = constant(0), end = q;
    *Ld = constant(0);
    for (int i = 0; i < 4; i++) {
        const dual Q = add(q, scaled(at[i] * h, V)), W = add(v, scaled(at[i] * h, A));
        V = W;
        A = acceleration(Q, W);
        *Ld = add(*Ld, scaled(weight[i] * h / 6, lagrangian(Q, W)));
        end = add(end, scaled(weight[i] * h / 6, V));
    }
    return end;
}

/* p0 + D1 Ld(q0, q1), with p1 = Ld_v / q1_v */
static real equation(real h, real u) {
    dual Ld;
    const dual end = segment(h, u, &Ld);
    return Ld.q + p0 - Ld.v / end.v * end.q;
}

static real slope(real h, real u) {
    const real e = 1e-7L;
    return (equation(h, u + e) - equation(h, u - e)) / (2 * e);
}

static int newton(real h, real *u) {
    real y = *u;
    for (int i = 0; i < 40; i++) {
        const real step = equation(h, y) / slope(h, y);
        if (!isfinite(step)) return 0;
        y -= step;
        if (fabsl(step) < 1e-10L * (1 + fabsl(y))) {
            *u = y;
            return 1;
        }
    }
    return 0;
}

/* parts of h up to 1, each near the tangent: how far it came */
static real follow(real h, real *u) {
    real part = 1e-3L, step = 1e-4L;
    if (!newton(part * h, u)) return 0;
    while (part < 1 && step > 1e-13L) {
        const real next = fminl(1, part + step), e = 1e-7L * part;
        const real by_h = (equation((part + e) * h, *u) - equation((part - e) * h, *u)) / (2 * e);
        const real foretold = *u - by_h / slope(part * h, *u) * (next - part);
        real found = foretold;
        const int near = newton(next * h, &found) &&
                         fabsl(found - foretold) <= 1e-6L + 0.03L * fabsl(foretold - *u);
        if (near) part = next, *u = found;
        step = near ? fminl(1e-4L, 1.5L * step) : 0.5L * step;
    }
    return part;
}

int main(void) {
    real v, h;
    while (scanf("%Lf %Lf %Lf %Lf %Lf", &a, &b, &q0, &v, &h) == 5) {
        real u = atanhl(v);
        dual Ld;
        p0 = v / sqrtl(1 - v * v);
        const real part = follow(h, &u);
        if (part < 1)
            printf("the branch ends at %.6Lf h\n", part);
        else
            printf("%.15Lf\n", segment(h, u, &Ld).x);
    }
    return 0;
}
