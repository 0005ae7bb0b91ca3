#include "run/hidden.h"

#include <math.h>

/* of the largest sample of the step: more is a feature, which begins where it is so much */
static const double UNLIKE = 0.1, BEGINS = 1e-4;
/* of the other samples: how far one may be from the mean of those beside it, and the first from
 * the second, where a jump lies between them */
static const double JUMP = 0.6, OUTER_JUMP = 1.2;
enum { DEEPEST = 12 }; /* bisections of a part of a step */

/* the parabola through a, b, c at 0, 1/2, 1: value = a + s (slope + s bend) */
typedef struct {
    double start, slope, bend;
} parabola;

/* coordinate i */
static parabola through(const dm_swept *step, uint32_t i) {
    const double a = step->q[0][i], b = step->q[1][i], c = step->q[2][i];
    return (parabola){a, 4.0 * (b - a) - (c - a), 2.0 * (c - a) - 4.0 * (b - a)};
}

/* a + s (slope + s bend) */
static double at(parabola p, double s) {
    return p.start + s * (p.slope + s * p.bend);
}

/* in any order */
static dm_interval hull_of(double a, double b) {
    return (dm_interval){fmin(a, b), fmax(a, b)};
}

/* the inputs, and how fast they change with s, while s goes from a to b, parts of the step */
static void sweep(dm_hidden *x, const dm_swept *step, double a, double b) {
    const uint32_t n = x->n;
    for (uint32_t i = 0; i < n; i++) {
        const parabola p = through(step, i);
        const double top = p.bend != 0.0 ? -0.5 * p.slope / p.bend : -1.0, h = step->h;
        const dm_interval rate = hull_of(p.slope + 2.0 * a * p.bend, p.slope + 2.0 * b * p.bend);
        dm_interval q = hull_of(at(p, a), at(p, b));
        if (top > a && top < b) q = (dm_interval){fmin(q.lo, at(p, top)), fmax(q.hi, at(p, top))};
        x->in[i] = q;
        x->in[n + i] = (dm_interval){rate.lo / h, rate.hi / h};
        x->rate_in[i] = rate;
        x->rate_in[n + i] = hull_of(2.0 * p.bend / h, 2.0 * p.bend / h);
    }
    x->in[2 * n] = hull_of(step->t + a * step->h, step->t + b * step->h);
    x->rate_in[2 * n] = (dm_interval){step->h, step->h};
    dm_bounds(x->graph, x->in, x->value);
    x->looked++;
}

/* what the forces can be while s goes from a to b: by their bounds, and by their value in the
 * middle and the bounds of their rate, which is better the smaller the box */
static void enclose(dm_hidden *x, const dm_swept *step, double a, double b) {
    const double middle = 0.5 * (a + b);
    const dm_interval reach = {a - middle, b - middle};
    sweep(x, step, middle, middle);
    for (uint32_t i = 0; i < x->count; i++) x->found[i] = x->value[x->roots[i]];
    sweep(x, step, a, b);
    dm_bounds_rate(x->graph, x->rate_in, x->value, x->rate);
    for (uint32_t i = 0; i < x->count; i++) {
        const dm_interval far = dm_interval_multiply(x->rate[x->roots[i]], reach);
        const dm_interval near = dm_interval_add(x->found[i], far);
        x->found[i] = dm_interval_common(x->value[x->roots[i]], near);
    }
}

/* the forces at the ends of the parts */
static void sample(dm_hidden *x, const dm_swept *step) {
    for (uint32_t k = 0; k <= DM_HIDDEN_PARTS; k++) {
        const double s = (double)k / DM_HIDDEN_PARTS;
        sweep(x, step, s, s);
        for (uint32_t i = 0; i < x->count; i++) {
            const dm_interval e = x->value[x->roots[i]];
            x->samples[k * (size_t)x->count + i] = 0.5 * e.lo + 0.5 * e.hi;
        }
    }
}

/* what force i may be in part k, by the samples around it */
static dm_interval expected(const dm_hidden *x, const dm_swept *step, uint32_t k, uint32_t i,
                            double unlike) {
    const uint32_t first = k ? k - 1 : 0;
    const uint32_t last = k + 2 < DM_HIDDEN_PARTS ? k + 2 : DM_HIDDEN_PARTS;
    const double negligible = x->negligible * step->momentum / (i < x->impulses ? step->h : 1.0);
    double size = 0.0;
    dm_interval out = {INFINITY, -INFINITY};
    for (uint32_t j = 0; j <= DM_HIDDEN_PARTS; j++) {
        const double e = x->samples[j * (size_t)x->count + i];
        size = fmax(size, fabs(e));
        if (j >= first && j <= last) out = (dm_interval){fmin(out.lo, e), fmax(out.hi, e)};
    }
    const double slack = unlike * size + negligible;
    return (dm_interval){out.lo - slack, out.hi + slack};
}

/* Are the forces inside what is expected in part k, from a to b? */
static int is_like_samples(dm_hidden *x, const dm_swept *step, uint32_t k, double a, double b,
                           double unlike) {
    enclose(x, step, a, b);
    for (uint32_t i = 0; i < x->count; i++) {
        const dm_interval e = x->found[i], wanted = expected(x, step, k, i, unlike);
        if (!(e.lo >= wanted.lo && e.hi <= wanted.hi)) return 0;
    }
    return 1;
}

/* Boxes of part k, from the first on, halved until they are small enough to tell. */
static int look_at_part(dm_hidden *x, const dm_swept *step, uint32_t k, double unlike,
                        double *where) {
    const double start = (double)k / DM_HIDDEN_PARTS,
                 least = ldexp(1.0 / DM_HIDDEN_PARTS, -DEEPEST);
    double a = start, width = 1.0 / DM_HIDDEN_PARTS;
    while (a < start + 1.0 / DM_HIDDEN_PARTS) {
        if (is_like_samples(x, step, k, a, a + width, unlike)) {
            a += width;
            /* twice as wide where that is a box of the bisection */
            while (width < 1.0 / DM_HIDDEN_PARTS && fmod(a - start, 2.0 * width) == 0.0)
                width *= 2.0;
            continue;
        }
        if (width <= least) {
            *where = step->t + a * step->h;
            return 0;
        }
        width *= 0.5;
    }
    return 1;
}

/* Does sample j of force i stand out from those beside it, more than a jump does? Then the rule,
 * which evaluates it elsewhere, need not have seen it. */
static int stands_out(const dm_hidden *x, const dm_swept *step, uint32_t j, uint32_t i) {
    const double negligible = x->negligible * step->momentum / (i < x->impulses ? step->h : 1.0);
    const double *e = x->samples + i;
    const size_t width = x->count;
    double others = 0.0;
    for (uint32_t k = 0; k <= DM_HIDDEN_PARTS; k++)
        if (k != j) others = fmax(others, fabs(e[k * width]));
    if (j == 0 || j == DM_HIDDEN_PARTS) {
        const double beside = e[(j ? j - 1 : 1) * width];
        return !(fabs(e[j * width] - beside) <= OUTER_JUMP * others + negligible);
    }
    const double mean = 0.5 * (e[(j - 1) * width] + e[(j + 1) * width]);
    return !(fabs(e[j * width] - mean) <= JUMP * others + negligible);
}

/* Of every sample of every force; *where is the time of the sample before. */
static int samples_agree(dm_hidden *x, const dm_swept *step, double *where) {
    for (uint32_t j = 0; j <= DM_HIDDEN_PARTS; j++)
        for (uint32_t i = 0; i < x->count; i++)
            if (stands_out(x, step, j, i)) {
                *where = step->t + step->h * (j ? j - 1 : 0) / DM_HIDDEN_PARTS;
                return 0;
            }
    return 1;
}

int dm_hidden_nothing(dm_hidden *x, const dm_swept *step, double *where) {
    sample(x, step);
    if (!samples_agree(x, step, where)) return 0;
    for (uint32_t k = 0; k < DM_HIDDEN_PARTS; k++)
        if (!look_at_part(x, step, k, UNLIKE, where)) {
            if (!k || look_at_part(x, step, k - 1, BEGINS, where))
                look_at_part(x, step, k, BEGINS, where);
            return 0;
        }
    return 1;
}
