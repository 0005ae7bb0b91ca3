#include "run/hidden.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of the largest sample of the step: more is a feature, which begins where it is so much */
static const double UNLIKE = 0.1, BEGINS = 1e-4;
/* of the other samples: how far one may be from the mean of those beside it, and the first from
 * the second, where a jump lies between them */
static const double JUMP = 0.6, OUTER_JUMP = 1.2;
enum { DEEPEST = 12 }; /* bisections of a part of a step */
enum { FEWEST = 4 };   /* parts that are looked at together, at least */
/* of what a node counts for: the round-off of its operation, and some more */
static const double ROUND_OFF = 0x1p-50;
/* of a position: what h v is off by along the polynomial, 30 roundings of it at its ends */
static const double DIFFERENCE = 0x1p-47;

/* ---- the step ---- */

/* v at the start, in the middle, at the end; 0: there is none */
static int find_velocities(dm_hidden *x, const dm_swept *step) {
    const uint32_t n = x->n;
    if (!x->model) return 0;
    for (uint32_t k = 0; k < 3; k++) {
        double *v = x->velocity + k * (size_t)n;
        memset(v, 0, n * sizeof *v);
        if (dm_legendre_inverse(x->model, v, step->q[k], step->p[k], step->t + 0.5 * k * step->h,
                                x->work) != DM_OK)
            return 0;
        for (uint32_t i = 0; i < n; i++)
            if (!isfinite(v[i])) return 0;
    }
    return 1;
}

/* k[] of the parabola through a, b, c at the start, in the middle, at the end; what it bends by */
static double parabola(double k[6], double a, double b, double c) {
    const double even = 0.5 * (a + c) - b;
    k[0] = b, k[1] = c - a, k[2] = 4.0 * even, k[3] = k[4] = k[5] = 0.0;
    return even;
}

/* The polynomial of degree 5 through q and v at the start, in the middle and at the end; without v
 * the parabola, as that of p is. */
static void find_curve(dm_hidden *x, const dm_swept *step) {
    const uint32_t n = x->n;
    const int known = find_velocities(x, step);
    for (uint32_t i = 0; x->in_phase_space && i < n; i++)
        parabola(x->curve[n + i], step->p[0][i], step->p[1][i], step->p[2][i]);
    for (uint32_t i = 0; i < n; i++) {
        const double a = step->q[0][i], b = step->q[1][i], c = step->q[2][i];
        double *k = x->curve[i];
        const double even = parabola(k, a, b, c);
        if (!known) continue;
        const double *v = x->velocity;
        const double start = step->h * v[i], end = step->h * v[2 * (size_t)n + i];
        k[1] = step->h * v[n + (size_t)i];
        const double odd = 0.5 * (c - a) - 0.5 * k[1], slope = 0.5 * (start + end) - k[1];
        const double bend = 0.5 * (end - start);
        k[2] = 8.0 * even - bend, k[4] = 4.0 * bend - 16.0 * even;
        k[3] = 20.0 * odd - 2.0 * slope, k[5] = 8.0 * slope - 48.0 * odd;
    }
}

/* The same polynomial about s = 1/2 + m. */
static void shift(double to[6], const double from[6], double m) {
    memcpy(to, from, 6 * sizeof *to);
    for (int done = 0; done < 5; done++)
        for (int k = 4; k >= done; k--) to[k] += m * to[k + 1];
}

/* what it, or its derivative number `order` by s, can be up to d away from there */
static dm_interval around(const double k[6], int order, double d) {
    double value = 0.0, reach = 0.0, power = 1.0;
    for (int i = order; i < 6; i++, power *= d) {
        double factor = 1.0;
        for (int j = 0; j < order; j++) factor *= i - j;
        if (i == order)
            value = factor * k[i];
        else
            reach += factor * fabs(k[i]) * power;
    }
    return (dm_interval){value - reach, value + reach};
}

static dm_interval divided(dm_interval a, double h) {
    return (dm_interval){fmin(a.lo / h, a.hi / h), fmax(a.lo / h, a.hi / h)};
}

/* input i, whose curve is known, and its derivatives by s, up to d away from s = 1/2 + m */
static void sweep_input(dm_hidden *x, uint32_t i, double m, double d) {
    double k[6];
    shift(k, x->curve[i], m);
    x->in[i] = around(k, 0, d);
    x->rate_in[i] = around(k, 1, d);
    x->bend_in[i] = around(k, 2, d);
}

/* the same of the velocity of q_i, its derivative by the time */
static void sweep_rate(dm_hidden *x, uint32_t i, double m, double d, double h) {
    const uint32_t of = x->n + i;
    double k[6];
    shift(k, x->curve[i], m);
    x->in[of] = divided(x->rate_in[i], h);
    x->rate_in[of] = divided(x->bend_in[i], h);
    x->bend_in[of] = divided(around(k, 3, d), h);
}

/* the inputs, and their derivatives by s, while s goes from a to b, parts of the step */
static void sweep(dm_hidden *x, const dm_swept *step, double a, double b) {
    const uint32_t n = x->n;
    const double h = step->h, m = 0.5 * (a + b) - 0.5, d = 0.5 * (b - a);
    for (uint32_t i = 0; i < n; i++) {
        sweep_input(x, i, m, d);
        if (x->in_phase_space)
            sweep_input(x, n + i, m, d);
        else
            sweep_rate(x, i, m, d, h);
    }
    const double start = step->t + a * h, end = step->t + b * h;
    x->in[2 * n] = (dm_interval){fmin(start, end), fmax(start, end)};
    x->rate_in[2 * n] = (dm_interval){h, h};
    x->bend_in[2 * n] = (dm_interval){0.0, 0.0};
    dm_bounds(x->graph, x->in, x->value);
}

/* input i at s */
static double input_at(const dm_hidden *x, const dm_swept *step, uint32_t i, double s) {
    const uint32_t n = x->n;
    const double u = s - 0.5;
    double out = 0.0;
    if (i >= 2 * n) return step->t + s * step->h;
    const int is_rate = i >= n && !x->in_phase_space;
    const double *k = x->curve[is_rate ? i - n : i];
    for (int j = 5; !is_rate && j >= 0; j--) out = out * u + k[j];
    for (int j = 5; is_rate && j > 0; j--) out = out * u + j * k[j];
    return is_rate ? out / step->h : out;
}

/* y[] = all nodes at s; what only an equation defines is no number */
static void evaluate(const dm_hidden *x, const dm_swept *step, double s, double *y) {
    const uint32_t size = dm_graph_size(x->graph);
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(x->graph, n);
        const int operands = dm_op_operands(e->op);
        if (e->op == DM_OP_CONSTANT)
            y[n] = e->as.value;
        else if (e->op == DM_OP_INPUT)
            y[n] = input_at(x, step, e->as.input, s);
        else
            y[n] = !operands
                       ? NAN
                       : dm_op_value(e->op, y[e->as.arg[0]], operands > 1 ? y[e->as.arg[1]] : 0.0,
                                     operands > 2 ? y[e->as.arg[2]] : 0.0);
    }
}

/* the forces at the ends of the parts, and the largest of these */
static void sample(dm_hidden *x, const dm_swept *step) {
    const uint32_t all = x->count + x->parts;
    double *size = x->samples + (DM_HIDDEN_PARTS + 1) * (size_t)all, *y = x->weight;
    for (uint32_t k = 0; k <= DM_HIDDEN_PARTS; k++) {
        evaluate(x, step, (double)k / DM_HIDDEN_PARTS, y);
        for (uint32_t i = 0; i < all; i++) {
            const double e = y[x->roots[i]];
            x->samples[k * (size_t)all + i] = e;
            size[i] = k ? fmax(size[i], fabs(e)) : fabs(e);
        }
    }
}

/* what it can be where it is `start` and `end` at the ends of a box of so much width, by bounds
 * of its derivatives there; anywhere where the ends are no numbers */
static dm_interval between(double start, double end, dm_interval rate, dm_interval bend,
                           double width) {
    const dm_interval e = {fmin(start, end), fmax(start, end)};
    const double middle = 0.5 * (start + end);
    const double bent = 0.125 * width * width * fmax(fabs(bend.lo), fabs(bend.hi));
    const double moved = 0.5 * width * fmax(fabs(rate.lo), fabs(rate.hi));
    if (!isfinite(middle)) return (dm_interval)DM_ANYWHERE;
    return (dm_interval){fmax(e.lo - bent, middle - moved), fmin(e.hi + bent, middle + moved)};
}

/* what the forces can be while s goes from a to b: by their bounds, and by their values at the ends
 * and bounds of their derivatives, which are better the smaller the box */
static void enclose(dm_hidden *x, const dm_swept *step, double a, double b) {
    const uint32_t all = x->count + x->parts;
    double *y = x->weight;
    evaluate(x, step, a, y);
    for (uint32_t i = 0; i < all; i++) x->found[i].lo = y[x->roots[i]];
    evaluate(x, step, b, y);
    sweep(x, step, a, b);
    dm_bounds_rate(x->graph, x->rate_in, x->value, x->rate);
    dm_bounds_bend(x->graph, x->bend_in, x->value, x->rate, x->bend);
    for (uint32_t i = 0; i < all; i++) {
        const dm_node r = x->roots[i];
        const dm_interval e = between(x->found[i].lo, y[r], x->rate[r], x->bend[r], b - a);
        x->found[i] = dm_interval_common(x->value[r], e);
    }
}

/* an impulse, or a momentum, that counts for nothing */
static double nothing(const dm_hidden *x, const dm_swept *step) {
    return x->negligible * step->momentum;
}

/* How far what force i, or a part of them, is in a box may be from samples around part k of the
 * step: the excess of `found` beyond them and a bit more, 0 or less where there is none. */
static double excess(const dm_hidden *x, uint32_t k, uint32_t i, double unlike) {
    const size_t width = x->count + x->parts;
    const uint32_t first = k ? k - 1 : 0;
    const uint32_t last = k + 2 < DM_HIDDEN_PARTS ? k + 2 : DM_HIDDEN_PARTS;
    const double size = x->samples[(DM_HIDDEN_PARTS + 1) * width + i];
    dm_interval out = {INFINITY, -INFINITY};
    for (uint32_t j = first; j <= last; j++) {
        const double e = x->samples[j * width + i];
        out = (dm_interval){fmin(out.lo, e), fmax(out.hi, e)};
    }
    const dm_interval e = x->found[i];
    const double below = out.lo - e.lo, above = e.hi - out.hi;
    return (below > above || isnan(below) ? below : above) - unlike * size;
}

/* What root i counts for over a time h, as an impulse: what is watched, off by one, for what is
 * still nothing; the way that a rate makes as a part of the largest q, that is of p. */
static double weight_of(const dm_hidden *x, const dm_swept *step, double h, uint32_t i) {
    if (i + x->watched >= x->count) return fmax(nothing(x, step), DBL_MIN);
    if (i < x->impulses) return fabs(h);
    if (!x->in_phase_space) return 1.0;
    return step->position > 0.0 ? fabs(h) * step->momentum / step->position : 0.0;
}

/* What node n may be off by in the box of x->value: its operation is rounded; velocities are
 * differences of positions, divided by the time between them. */
static double round_off(const dm_hidden *x, const dm_swept *step, dm_node n) {
    const dm_expr *e = dm_graph_at(x->graph, n);
    const dm_interval y = x->value[n];
    const double off = ROUND_OFF * fmax(fabs(y.lo), fabs(y.hi));
    if (x->in_phase_space || e->op != DM_OP_INPUT || e->as.input < x->n || e->as.input >= 2 * x->n)
        return off;
    const dm_interval q = x->in[e->as.input - x->n];
    return off + DIFFERENCE * fmax(fabs(q.lo), fabs(q.hi)) / fabs(step->h);
}

/* What all nodes count for in the impulse of the forces over a time h, in the box of x->value, and
 * what the impulse may be by their round-off. */
static void weigh(dm_hidden *x, const dm_swept *step, double h) {
    const uint32_t size = dm_graph_size(x->graph);
    memset(x->weight, 0, size * sizeof *x->weight);
    for (uint32_t i = 0; i < x->count; i++)
        x->weight[x->roots[i]] = fmax(x->weight[x->roots[i]], weight_of(x, step, h, i));
    dm_bounds_weight(x->graph, x->value, x->weight);
    x->noise = 0.0;
    for (dm_node n = 0; n < size; n++) {
        const double most = x->weight[n] * round_off(x, step, n);
        if (isfinite(most)) x->noise += most;
    }
}

/* Does it matter that force i, or a part of them, is `off`? */
static int matters(const dm_hidden *x, const dm_swept *step, uint32_t i, double off) {
    const double weight = x->weight[x->roots[i]];
    return weight != 0.0 && !(off * weight <= nothing(x, step) + x->noise);
}

/* Are the forces, and what they are made of, as good as straight lines between their samples in
 * parts `first` to `end` of the step? By their second derivatives: so much less than `unlike` they
 * are inside of the samples of each part. */
static int is_straight(dm_hidden *x, const dm_swept *step, uint32_t first, uint32_t end) {
    enum { EIGHTH = 8 }; /* of a second derivative times the square of their distance */
    const uint32_t all = x->count + x->parts;
    const double *size = x->samples + (DM_HIDDEN_PARTS + 1) * (size_t)all;
    const double a = (double)first / DM_HIDDEN_PARTS, b = (double)end / DM_HIDDEN_PARTS;
    int weighted = 0;
    sweep(x, step, a, b);
    dm_bounds_rate(x->graph, x->rate_in, x->value, x->rate);
    dm_bounds_bend(x->graph, x->bend_in, x->value, x->rate, x->bend);
    for (uint32_t i = 0; i < all; i++) {
        const dm_interval e = x->bend[x->roots[i]];
        const double most = fmax(fabs(e.lo), fabs(e.hi));
        const double off = most / (EIGHTH * DM_HIDDEN_PARTS * DM_HIDDEN_PARTS) - UNLIKE * size[i];
        if (off <= 0.0) continue;
        if (!weighted) weigh(x, step, (b - a) * step->h);
        weighted = 1;
        if (isnan(off) || matters(x, step, i, off)) return 0;
    }
    return 1;
}

/* Are the forces inside what is expected in part k, from a to b, and what they are made of? */
static int is_like_samples(dm_hidden *x, const dm_swept *step, uint32_t k, double a, double b,
                           double unlike) {
    int weighted = 0;
    enclose(x, step, a, b);
    for (uint32_t i = 0; i < x->count + x->parts; i++) {
        const double off = excess(x, k, i, unlike);
        if (off <= 0.0) continue;
        if (!weighted) weigh(x, step, (b - a) * step->h);
        weighted = 1;
        if (matters(x, step, i, off)) return 0;
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

/* How far sample j of force i, or of a part of them, stands out from those beside it, more than a
 * jump does? Then the rule, which evaluates it elsewhere, need not have seen it. 0 or less: not. */
static double standing_out(const dm_hidden *x, uint32_t j, uint32_t i) {
    const double *e = x->samples + i;
    const size_t width = x->count + x->parts;
    double others = 0.0;
    for (uint32_t k = 0; k <= DM_HIDDEN_PARTS; k++)
        if (k != j) others = fmax(others, fabs(e[k * width]));
    if (j == 0 || j == DM_HIDDEN_PARTS) {
        const double beside = e[(j ? j - 1 : 1) * width];
        return fabs(e[j * width] - beside) - OUTER_JUMP * others;
    }
    const double mean = 0.5 * (e[(j - 1) * width] + e[(j + 1) * width]);
    return fabs(e[j * width] - mean) - JUMP * others;
}

/* Of every sample of every force and of what they are made of; *where is the time of the sample
 * before. */
static int samples_agree(dm_hidden *x, const dm_swept *step, double *where) {
    int weighted = 0;
    for (uint32_t j = 0; j <= DM_HIDDEN_PARTS; j++)
        for (uint32_t i = 0; i < x->count + x->parts; i++) {
            const double off = standing_out(x, j, i);
            if (off <= 0.0) continue;
            if (!weighted) {
                sweep(x, step, 0.0, 1.0);
                weigh(x, step, step->h);
            }
            weighted = 1;
            if (!matters(x, step, i, off)) continue;
            *where = step->t + step->h * (j ? j - 1 : 0) / DM_HIDDEN_PARTS;
            return 0;
        }
    return 1;
}

/* The first part in which something is unlike, DM_HIDDEN_PARTS: none. Many parts at once, by
 * second derivatives, before each by itself. */
static uint32_t first_unlike(dm_hidden *x, const dm_swept *step, double *where) {
    uint32_t width = DM_HIDDEN_PARTS;
    for (uint32_t k = 0; k < DM_HIDDEN_PARTS;) {
        if (is_straight(x, step, k, k + width)) {
            k += width;
            continue;
        }
        if (width > FEWEST) {
            width /= 2;
            continue;
        }
        for (const uint32_t end = k + width; k < end; k++)
            if (!look_at_part(x, step, k, UNLIKE, where)) return k;
    }
    return DM_HIDDEN_PARTS;
}

int dm_hidden_nothing(dm_hidden *x, const dm_swept *step, double *where) {
    find_curve(x, step);
    sample(x, step);
    if (!samples_agree(x, step, where)) return 0;
    const uint32_t k = first_unlike(x, step, where);
    if (k == DM_HIDDEN_PARTS) return 1;
    if (!k || look_at_part(x, step, k - 1, BEGINS, where)) look_at_part(x, step, k, BEGINS, where);
    return 0;
}
