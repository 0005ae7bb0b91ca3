/* turns.c - rotations(2) by hand: heavy tops in lanes, five turns and a torque a step. Moments
 * (1, 1.2, 0.6), mgl = 1 on the third axis; quaternions and body momenta; sine and cosine of the
 * library's own lanes. */
#include "lanes.h"

#ifdef __AVX512F__
extern v8 _ZGVeN8v_sin(v8 x), _ZGVeN8v_cos(v8 x);
#define SIN(x) _ZGVeN8v_sin(x)
#define COS(x) _ZGVeN8v_cos(x)
#else
static v8 each(double f(double), v8 x) {
    for (int i = 0; i < 8; i++) x[i] = f(x[i]);
    return x;
}
#define SIN(x) each(sin, x)
#define COS(x) each(cos, x)
#endif

/* q exp(x e_a), mu carried there; b and c are the axes behind a */
INLINE void turn(v8 *q, v8 *p, v8 x, int a, int b, int c) {
    const v8 s = SIN(0.5 * x), w = COS(0.5 * x);
    const v8 q0 = w * q[0] - s * q[1 + a], qa = w * q[1 + a] + s * q[0];
    const v8 qb = w * q[1 + b] + s * q[1 + c], qc = w * q[1 + c] - s * q[1 + b];
    const v8 cosine = w * w - s * s, sine = 2.0 * (w * s);
    const v8 pb = cosine * p[b] + sine * p[c], pc = cosine * p[c] - sine * p[b];
    q[0] = q0, q[1 + a] = qa, q[1 + b] = qb, q[1 + c] = qc;
    p[b] = pb, p[c] = pc;
}

INLINE void kick(const v8 *q, v8 *p, double w) {
    p[0] += w * 2.0 * (q[2] * q[3] + q[0] * q[1]);
    p[1] -= w * 2.0 * (q[1] * q[3] - q[0] * q[2]);
}

INLINE void step(v8 *q, v8 *p, double h) {
    const double half = 0.5 * h;
    kick(q, p, half);
    turn(q, p, half * p[0], 0, 1, 2);
    turn(q, p, half / 1.2 * p[1], 1, 2, 0);
    turn(q, p, h / 0.6 * p[2], 2, 0, 1);
    turn(q, p, half / 1.2 * p[1], 1, 2, 0);
    turn(q, p, half * p[0], 0, 1, 2);
    kick(q, p, half);
}

double turns_lanes(long steps) {
    v8 q[TURNS_GROUPS][4], p[TURNS_GROUPS][3], sum = {0};
    for (int g = 0; g < TURNS_GROUPS; g++)
        for (int i = 0; i < 8; i++) {
            q[g][0][i] = cos(0.2), q[g][1][i] = sin(0.2), q[g][2][i] = q[g][3][i] = 0.0;
            p[g][0][i] = 0.2, p[g][1][i] = 0.1, p[g][2][i] = 1.5 + 1e-3 * (8 * g + i);
        }
    for (long k = 0; k < steps; k++)
        for (int g = 0; g < TURNS_GROUPS; g++) step(q[g], p[g], 0.05);
    for (int g = 0; g < TURNS_GROUPS; g++) sum += q[g][0] + p[g][1];
    return sum8(sum);
}
