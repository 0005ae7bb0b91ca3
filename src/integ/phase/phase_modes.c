#include "integ/phase/phase_modes.h"

#include <complex.h>
#include <math.h>

typedef long double complex number;

/* of r stages: the b_i, W and the entries x_k of the tridiagonal matrix, x[0] = 0 */
typedef struct {
    uint32_t r;
    double b[DM_QUADRATURE_NODES], W[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES];
    long double x[DM_QUADRATURE_NODES];
    number value[DM_QUADRATURE_NODES];
} spectrum;

size_t dm_phase_modes_size(uint32_t r) {
    return (r + 1) / 2 * (2 + 4 * (size_t)r);
}

/* sqrt(2 j + 1) P_j(2 c - 1) */
static void fill_legendre(spectrum *s, const dm_stage_table *t) {
    for (uint32_t i = 0; i < s->r; i++) {
        const double z = 2.0 * dm_weight_double(t->c[i]) - 1.0;
        double p = 1.0, before = 0.0;
        s->b[i] = dm_weight_double(t->b[i]);
        for (uint32_t j = 0; j < s->r; j++) {
            const double next = ((2.0 * j + 1.0) * z * p - j * before) / (j + 1.0);
            s->W[i][j] = sqrt(2.0 * j + 1.0) * p;
            before = p;
            p = next;
        }
    }
    for (uint32_t k = 0; k < s->r; k++) s->x[k] = k ? 0.5L / sqrtl(4.0L * k * k - 1.0L) : 0.0L;
}

/* entry k, l of W^T B A W */
static double transformed(const spectrum *s, const dm_stage_table *t, uint32_t k, uint32_t l) {
    double sum = 0.0;
    for (uint32_t i = 0; i < s->r; i++)
        for (uint32_t j = 0; j < s->r; j++)
            sum += s->W[i][k] * s->b[i] * dm_weight_double(t->a[i * s->r + j]) * s->W[j][l];
    return sum;
}

/* does W bring the coefficients to their tridiagonal form? */
static int is_gauss(const spectrum *s, const dm_stage_table *t) {
    for (uint32_t k = 0; k < s->r; k++)
        for (uint32_t l = 0; l < s->r; l++) {
            double entry = k == 0 && l == 0 ? 0.5 : 0.0;
            if (l == k + 1) entry = -(double)s->x[l];
            if (k == l + 1) entry = (double)s->x[k];
            if (!(fabs(transformed(s, t, k, l) - entry) < 1e-12)) return 0;
        }
    return 1;
}

/* p/p' of the characteristic polynomial at z */
static number newton_of(const spectrum *s, number z) {
    number p = 0.5L - z, slope = -1.0L, before = 1.0L, slope_before = 0.0L;
    for (uint32_t k = 1; k < s->r; k++) {
        const long double x2 = s->x[k] * s->x[k];
        const number next = x2 * before - z * p;
        const number next_slope = x2 * slope_before - z * slope - p;
        before = p, slope_before = slope;
        p = next, slope = next_slope;
    }
    return p / slope;
}

/* all roots side by side (Aberth 1973), until rounding is all that moves them; 0: they did not
 * settle */
static int find_values(spectrum *s) {
    enum { MOST = 200 };
    static const long double NEAR = 1e-6L;
    long double last = INFINITY;
    const uint32_t r = s->r;
    for (uint32_t k = 0; k < r; k++) {
        const long double angle = (6.2831853L * k + 0.4L) / r;
        s->value[k] = (cosl(angle) + sinl(angle) * _Complex_I) * (0.6L / r);
    }
    for (int turn = 0; turn < MOST; turn++) {
        long double largest = 0.0L;
        for (uint32_t k = 0; k < r; k++) {
            const number step = newton_of(s, s->value[k]);
            number others = 0.0L;
            for (uint32_t l = 0; l < r; l++)
                if (l != k) others += 1.0L / (s->value[k] - s->value[l]);
            const number change = step / (1.0L - step * others);
            s->value[k] -= change;
            largest = fmaxl(largest, cabsl(change) * r);
        }
        if (!isfinite(largest)) return 0;
        if (largest < NEAR && largest >= last) return 1;
        last = largest;
    }
    return 0;
}

/* v of the tridiagonal matrix, and sum_k (-1)^k v_k^2, which v times its left fellow is */
static number find_vector(const spectrum *s, number z, number *v) {
    number scale = 0.0L;
    for (uint32_t k = 0; k < s->r; k++) {
        if (k == 0)
            v[k] = 1.0L;
        else if (k == 1)
            v[k] = (0.5L - z) * v[0] / s->x[1];
        else
            v[k] = (s->x[k - 1] * v[k - 2] - z * v[k - 1]) / s->x[k];
        scale += (k % 2 ? -1.0L : 1.0L) * v[k] * v[k];
    }
    return scale;
}

static void put(double *to, number x) {
    to[0] = (double)creall(x);
    to[1] = (double)cimagl(x);
}

/* the next eigenvalue, with its vectors in the stages */
static void add(dm_phase_modes *out, const spectrum *s, number z) {
    number v[DM_QUADRATURE_NODES];
    const uint32_t r = s->r;
    const number scale = find_vector(s, z, v);
    put(out->value + 2 * (size_t)out->count, z);
    for (uint32_t i = 0; i < r; i++) {
        number up = 0.0L, down = 0.0L;
        for (uint32_t k = 0; k < r; k++) {
            up += s->W[i][k] * v[k];
            down += (k % 2 ? -1.0L : 1.0L) * v[k] * s->W[i][k];
        }
        put(out->up + 2 * (out->count * (size_t)r + i), up);
        put(out->down + 2 * (out->count * (size_t)r + i), down * s->b[i] / scale);
    }
    out->count++;
}

/* are the coefficients the sum of up_i value down_j? Digits are lost with the number of stages. */
static int is_right(const dm_phase_modes *m, const dm_stage_table *t) {
    static const double ENOUGH = 1e-4;
    const uint32_t r = t->r;
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t j = 0; j < r; j++) {
            double sum = 0.0;
            for (uint32_t k = 0; k < m->count; k++) {
                const double *z = m->value + 2 * (size_t)k;
                const double *u = m->up + 2 * (k * (size_t)r + i);
                const double *d = m->down + 2 * (k * (size_t)r + j);
                const double re = z[0] * u[0] - z[1] * u[1], im = z[0] * u[1] + z[1] * u[0];
                sum += (z[1] > 0.0 ? 2.0 : 1.0) * (re * d[0] - im * d[1]);
            }
            if (!(fabs(sum - dm_weight_double(t->a[i * r + j])) < ENOUGH)) return 0;
        }
    return 1;
}

void dm_phase_modes_find(dm_phase_modes *out, const dm_stage_table *t, double *memory) {
    static const long double REAL = 1e-7L;
    const uint32_t r = t->r, pairs = (r + 1) / 2;
    spectrum s = {.r = r};
    *out = (dm_phase_modes){.value = memory,
                            .down = memory + 2 * (size_t)pairs,
                            .up = memory + 2 * (size_t)pairs * (1 + r)};
    if (t->s != r) return;
    fill_legendre(&s, t);
    if (!is_gauss(&s, t) || !find_values(&s)) return;
    for (uint32_t k = 0; k < r; k++) {
        const long double above = cimagl(s.value[k]);
        if (above < -REAL || out->count == pairs) continue;
        add(out, &s, above > REAL ? s.value[k] : (number)creall(s.value[k]));
    }
    if (out->count != pairs || !is_right(out, t)) out->count = 0;
}
