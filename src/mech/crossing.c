/* crossing.c - does a step go over a place where holonomic constraints cross? The level set is
 * walked from its start toward its end, in parts in which the rows turn and shrink by little. Where
 * rows depend on each other parts become ever shorter, and the volume that the rows span vanishes;
 * on any other way the walk arrives. It needs no more than g and G, whatever rule made the step. */
#include "mech/crossing.h"

#include "linalg/lu.h"

#include <math.h>
#include <string.h>

/* ---- steps that are looked into ---- */

/* Speed: steps, rattle, double spherical pendulum: 1.01x, against the ratio to the step before. */
void dm_crossing_expect(dm_crossing_watch *w, double volume) {
    static const double LESS = 0.64,
                        MORE = 1.56; /* MORE times what FALL leaves is less than LESS */
    *w = (dm_crossing_watch){volume, LESS * volume, MORE * volume};
}

int dm_crossing_suspects(dm_crossing_watch *w, double before, double now) {
    static const double FALL = 0.6; /* by less: steps on a line to a node are three away, or more */
    const int after = !(w->volume > 0.0), calm = fabs(now - before) < FALL * before;
    dm_crossing_expect(w, calm ? fabs(now) : -fabs(now));
    return after || !calm;
}

/* ---- one step ---- */

/* Parts that are tried first, and the shortest ones; of the volume, as logarithms: what a part may
 * change, less is none, less is nearly none where no part is short enough; the least cosine between
 * both ends of a part. */
static const double FIRST = 0.25, SHORTEST = 0x1p-40;
static const double CHANGE = 0.3, NONE = -11.5, FEW = -2.3, TURN = 0.95;
/* Of q: nearer to a node g is zero to round-off on all sides, since it is quadratic there. */
static const double BLURRED = 1e-7;
static const double ANGLE = 1.0; /* of this size are places, of which a chart tells nothing */
enum { PROJECTIONS = 12 };
static const double SETTLED = 1e-6; /* a projection, of the length of its part */

/* Entries of a row: all before `from` and from `to` on are zero. */
typedef struct {
    uint32_t from, to;
} span;

/* Rows at a point, each of them a sum of those of an orthonormal frame. */
typedef struct {
    double *Q, *L; /* [k*n], [k*k], the lower half */
    span *span;    /* [k] of Q */
    double size;   /* logarithm of the volume */
} frame;

typedef struct {
    const dm_constraints *c;
    const dm_crossing_way *way;
    uint32_t all, n, k; /* coordinates; those that count, of so many constraints */
    size_t pitch;       /* of rows of G */
    double reach;       /* from end to end, in the units of the way */
    double whole;       /* the larger size of both ends */
    double none;        /* less than that by so much is none */
    frame here, there;
    double *x, *out; /* arguments and outputs of the kernel */
    double *q, *next, *move, *unit, *S, *first;
    uint32_t *pivot;
} walk;

/* In the order of begin. */
size_t dm_crossing_work(const dm_constraints *c) {
    const size_t n = c->n, k = c->holonomic;
    return 2 * n + 1 + k * (n + 2) + 2 * (k * n + k * k + k) + 4 * n + k * k + 2 * k;
}

static double *take(double **work, size_t count) {
    double *out = *work;
    *work += count;
    return out;
}

static frame take_frame(double **work, size_t n, size_t k) {
    frame f = {.Q = take(work, k * n), .L = take(work, k * k)};
    f.span = (span *)(void *)take(work, k);
    return f;
}

static walk begin(const dm_constraints *c, const dm_crossing_way *way, double *work) {
    const uint32_t all = way->chart ? way->chart->n : c->n;
    walk own = {.c = c, .way = way, .all = all, .pitch = all}, *w = &own;
    w->n = all >> c->prolonged, w->k = c->holonomic >> c->prolonged;
    const size_t n = w->n, k = w->k, inputs = 2 * (size_t)c->n + 1;
    w->x = take(&work, inputs), w->out = take(&work, c->holonomic * ((size_t)c->n + 2));
    w->here = take_frame(&work, n, k);
    w->there = take_frame(&work, n, k);
    w->q = take(&work, all), w->next = take(&work, all);
    w->move = take(&work, n), w->unit = take(&work, n);
    w->S = take(&work, k * k), w->first = take(&work, k);
    w->pivot = (uint32_t *)(void *)take(&work, k);
    memset(w->x, 0, inputs * sizeof *w->x);
    for (size_t i = 0; i < n; i++) w->unit[i] = sqrt(way->weight[i]);
    memcpy(w->q, way->q0, all * sizeof *w->q);
    memcpy(w->next, way->q0, all * sizeof *w->next);
    if (!w->way->chart) dm_kernel_prepare(&w->c->holonomic_kernel, w->out);
    return own;
}

static double dot(const double *a, const double *b, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* Where entries of a row are. */
static span span_of(const double *row, uint32_t n) {
    span out = {0, n};
    while (out.from < n && row[out.from] == 0.0) out.from++;
    while (out.to > out.from && row[out.to - 1] == 0.0) out.to--;
    return out;
}

/* Row c of Q less its parts along those before it, which go into L. Rows that have no entry in
 * common have none: those of a chain or a tree are few. Speed: steps, 80 rods, rattle: 2.8x. */
static void subtract_parts(const frame *f, uint32_t c, size_t n, size_t k) {
    double *row = f->Q + c * n;
    span own = f->span[c];
    for (uint32_t b = 0; b < c; b++) {
        const span other = f->span[b];
        const uint32_t from = other.from > own.from ? other.from : own.from,
                       to = other.to < own.to ? other.to : own.to;
        const double *Q = f->Q + b * n;
        const double part = from < to ? dot(row + from, Q + from, to - from) : 0.0;
        if (part == 0.0) continue;
        for (uint32_t i = other.from; i < other.to; i++) row[i] -= part * Q[i];
        f->L[c * k + b] += part;
        if (other.from < own.from) own.from = other.from;
        if (other.to > own.to) own.to = other.to;
    }
    f->span[c] = own;
}

/* Again where less than HALF of the square is left, since then the first time leaves round-off. */
static double orthogonalize(const frame *f, uint32_t c, size_t n, size_t k) {
    static const double HALF = 0.5;
    double *row = f->Q + c * n, *L = f->L + c * k;
    memset(L, 0, k * sizeof *L);
    f->span[c] = span_of(row, (uint32_t)n);
    const double before = dot(row, row, n);
    subtract_parts(f, c, n, k);
    double left = dot(row, row, n);
    if (!(left >= HALF * before)) {
        subtract_parts(f, c, n, k);
        left = dot(row, row, n);
    }
    L[c] = sqrt(left);
    for (size_t i = 0; i < n; i++) row[i] /= L[c];
    return L[c];
}

/* The frame at w->next or w->q, whose G is at hand, in units; 0: rows depend on each other to the
 * last bit. */
static int find_frame(const walk *w, frame *f) {
    const size_t n = w->n, k = w->k;
    const double *G = w->out + w->c->holonomic;
    f->size = 0.0;
    for (uint32_t c = 0; c < k; c++) {
        for (size_t i = 0; i < n; i++) f->Q[c * n + i] = G[c * w->pitch + i] * w->unit[i];
        f->size += log(orthogonalize(f, c, n, k));
    }
    return isfinite(f->size);
}

/* sum of a_i b_i weight_i where both rows can have entries, before `end` */
static double weighted(const double *a, const dm_row *A, const double *b, const dm_row *B,
                       const double *weight, uint32_t end) {
    const uint32_t from = A->from > B->from ? A->from : B->from;
    uint32_t to = A->to < B->to ? A->to : B->to;
    double sum = 0.0;
    if (to > end) to = end;
    for (uint32_t i = from; i < to; i++) sum += a[i] * b[i] * weight[i];
    return sum;
}

/* Of G weight G^T by Cholesky's method, which leaves alone what is left of the first entry in a
 * row: a chain has two in each. Speed: steps, 80 rods, gauss(2) */
dm_wide_product dm_crossing_volume(const dm_constraints *c, const double *holonomic,
                                   const double *weight, double *work) {
    const size_t n = c->n, k = c->holonomic >> c->prolonged;
    const uint32_t end = c->n >> c->prolonged;
    const double *G = holonomic + c->holonomic;
    dm_wide_product out = DM_WIDE_ONE;
    for (size_t a = 0; a < k; a++) {
        const dm_row *A = c->rows + a;
        double *L = work + a * k;
        for (size_t b = A->first; b <= a; b++) {
            const dm_row *B = c->rows + b;
            const double *other = work + b * k;
            double sum = weighted(G + a * n, A, G + b * n, B, weight, end);
            for (size_t j = A->first > B->first ? A->first : B->first; j < b; j++)
                sum -= L[j] * other[j];
            L[b] = b < a ? sum / other[b] : sum;
        }
        if (!(L[a] > 0.0)) return (dm_wide_product){0.0, 0};
        out = dm_wide_times(out, L[a]);
        L[a] = sqrt(L[a]);
    }
    return out;
}

static int look(walk *w, frame *f, const double *q, double t) {
    const dm_crossing_chart *chart = w->way->chart;
    if (chart) {
        chart->look(chart->ctx, w->out, w->out + w->c->holonomic, q, t);
    } else {
        memcpy(w->x, q, w->all * sizeof *q);
        w->x[2 * (size_t)w->all] = t;
        dm_kernel_eval(&w->c->holonomic_kernel, w->x, w->out);
    }
    return find_frame(w, f);
}

/* The shortest move onto g = 0, to first order, by the rows there; its length. */
static double correct(walk *w, const frame *f, double *q) {
    const uint32_t n = w->n, k = w->k;
    double squares = 0.0, *g = w->out;
    memset(w->move, 0, n * sizeof *w->move);
    for (uint32_t c = 0; c < k; c++) {
        g[c] = -(g[c] + dot(f->L + c * (size_t)k, g, c)) / f->L[c * (size_t)k + c];
        for (uint32_t i = 0; i < n; i++) w->move[i] += g[c] * f->Q[c * (size_t)n + i];
        squares += g[c] * g[c];
    }
    for (uint32_t i = 0; i < n; i++) q[i] += w->unit[i] * w->move[i];
    return sqrt(squares);
}

/* w->next onto g = 0, with the frame there; 0: it is not near. */
static int project(walk *w, double t, double length) {
    for (int i = 0; i < PROJECTIONS; i++) {
        if (!look(w, &w->there, w->next, t)) return 0;
        const double by = correct(w, &w->there, w->next);
        if (!(by <= 2.0 * length)) return 0;
        if (by <= SETTLED * length) return 1;
    }
    return 0;
}

/* Cosine of the angle between both tangent spaces; less than 0: rows have turned over. */
static double cosine(walk *w) {
    const uint32_t n = w->n, k = w->k;
    double out = 1.0;
    int odd = 0;
    for (uint32_t b = 0; b < k; b++)
        for (uint32_t c = 0; c < k; c++)
            w->S[b * k + c] = dot(w->here.Q + b * (size_t)n, w->there.Q + c * (size_t)n, n);
    if (dm_lu_factor(w->S, w->pivot, k) != DM_OK) return 0.0;
    for (uint32_t c = 0; c < k; c++) out /= w->S[c * k + c], odd ^= w->pivot[c] != c;
    return odd ? -out : out;
}

/* A part of the way that is left, along the level set; 0: it is too long. */
static int make_part(walk *w, double part, double t, double length) {
    const uint32_t n = w->n;
    const double *unit = w->unit;
    for (uint32_t i = 0; i < n; i++) w->move[i] = part * (w->way->q1[i] - w->q[i]) / unit[i];
    for (uint32_t c = 0; c < w->k; c++) {
        const double *row = w->here.Q + c * (size_t)n, across = dot(w->move, row, n);
        for (uint32_t i = 0; i < n; i++) w->move[i] -= across * row[i];
    }
    for (uint32_t i = 0; i < n; i++) w->next[i] = w->q[i] + unit[i] * w->move[i];
    return project(w, t, length) && fabs(w->there.size - w->here.size) <= CHANGE &&
           cosine(w) >= TURN;
}

static void go_on(walk *w) {
    const frame kept = w->here;
    w->here = w->there, w->there = kept;
    memcpy(w->q, w->next, w->n * sizeof *w->q);
}

/* Of the volume at the start: a row whose own part fell most. */
static uint32_t lost_row(const walk *w) {
    const size_t k = w->k;
    uint32_t row = 0;
    double least = INFINITY;
    for (uint32_t c = 0; c < k; c++) {
        const double left = w->here.L[c * k + c] / w->first[c];
        if (left < least) least = left, row = c;
    }
    return row + 1;
}

/* From 0 to 1; where it ends, less than 1 where the volume vanishes. */
static double walk_on(walk *w) {
    const dm_crossing_way *way = w->way;
    double a = 0.0, width = FIRST;
    while (a < 1.0) {
        if (width > 1.0 - a) width = 1.0 - a;
        const double end = a + width, t = way->t0 + end * (way->t1 - way->t0);
        if (make_part(w, width / (1.0 - a), t, width * w->reach)) {
            go_on(w);
            a = end, width *= 2.0;
            if (w->here.size - w->whole < w->none) return a < 1.0 ? a : 1.0 - SHORTEST;
        } else {
            width *= 0.5;
            if (width < SHORTEST) return w->here.size - w->whole < FEW ? a : 1.0;
        }
    }
    return a;
}

int dm_crossing_between(const dm_constraints *c, const dm_crossing_way *way, dm_crossing_place *out,
                        double *work) {
    double squares = 0.0, largest = 0.0;
    if (c->crossings) return 0;
    walk w = begin(c, way, work);
    for (uint32_t i = 0; i < w.n; i++) {
        const double d = (way->q1[i] - way->q0[i]) / w.unit[i];
        squares += d * d;
        largest = fmax(largest, (way->chart ? ANGLE : fabs(way->q0[i])) / w.unit[i]);
    }
    w.reach = sqrt(squares);
    w.none = fmin(fmax(NONE, log(BLURRED * largest / w.reach)), FEW);
    if (!(w.reach > 0.0) || !look(&w, &w.here, w.q, way->t0)) return 0;
    w.whole = w.here.size;
    if (look(&w, &w.there, way->q1, way->t1)) w.whole = fmax(w.whole, w.there.size);
    for (size_t i = 0; i < w.k; i++) w.first[i] = w.here.L[i * w.k + i];
    const double a = walk_on(&w);
    *out = (dm_crossing_place){lost_row(&w), way->t0 + a * (way->t1 - way->t0)};
    return a < 1.0;
}

enum { POWER, BEFORE, COMPARED }; /* what watched are */

static double power_of(const double *watched, dm_wide_product volume) {
    const int starts = watched[BEFORE] == 0.0 && watched[COMPARED] == 0.0;
    return starts ? (double)volume.power : watched[POWER];
}

int dm_crossing_is_calm(double *watched, dm_wide_product volume) {
    const double power = power_of(watched, volume), now = dm_wide_over(volume, power);
    dm_crossing_watch watch;
    dm_crossing_expect(&watch, watched[COMPARED]);
    if (!dm_crossing_is_far(&watch, now)) return 0;
    watched[POWER] = power, watched[BEFORE] = now;
    return 1;
}

int dm_crossing_in_step(const dm_constraints *c, double *watched, dm_wide_product volume,
                        const dm_crossing_way *way, dm_crossing_place *out, double *work) {
    if (dm_crossing_is_calm(watched, volume)) return 0;
    const double power = power_of(watched, volume), now = dm_wide_over(volume, power);
    dm_crossing_watch watch;
    dm_crossing_expect(&watch, watched[COMPARED]);
    const int suspect = dm_crossing_suspects(&watch, watched[BEFORE], now);
    if (suspect && dm_crossing_between(c, way, out, work)) return 1;
    watched[COMPARED] = watch.volume;
    watched[POWER] = power, watched[BEFORE] = now; /* of a step that is taken */
    return 0;
}

int dm_crossing_at_end(const dm_constraints *c, double *watched, const double *holonomic,
                       const double *mass, dm_crossing_way way, dm_crossing_place *out,
                       double *work) {
    const dm_crossing_mass m = {mass, c->n, c->n};
    double *weight = work, *room = work + c->n;
    if (!dm_crossing_weights(weight, &m, c->prolonged)) return 0;
    way.weight = weight;
    const dm_wide_product volume = dm_crossing_volume(c, holonomic, weight, room);
    return dm_crossing_in_step(c, watched, volume, &way, out, room);
}
