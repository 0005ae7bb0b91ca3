/* strip_solve.c - Newton's method for the upper level of a strip.
 * One matrix serves while the increments shrink by ten or more. */
#include "base/largest.h"
#include "field/line/strip.h"

#include <string.h>

enum { MOST = 60, DAMPINGS = 10 };
static const double SLOW = 0.1;         /* rate that calls for a new matrix */
static const double ROUND_OFF = 4e-15;  /* an increment that small is the last */
static const double NEGLIGIBLE = 1e-17; /* error left that is not worth an iteration */
static const double STALLED = 1e-11;    /* an increment that small may be all noise */
static const double LEFT = 2e-14;       /* of the terms of the residual: so may what is left */
static const double LARGEST = 1e13;     /* a column over its pivot: it has none but round-off */
static const double SMALL = 1e-3;       /* of the largest value: the least scale of another */
static const double STRETCH = 1.5;      /* of the height, in one iteration at most */
static const double EXACT = 1e-15;      /* of the energy: a height that gives it so serves */
static const double NOISE = 1e-9;       /* an increment of the height that small may be noise */

/* ---- residual and matrix ---- */

/* what does not come from cells: momenta below, absorbing ends; held rows follow below */
static void begin(dm_strip_room *room) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    if (s->boxes) {
        memset(room->r, 0, dm_strip_unknowns(s) * sizeof *room->r);
        return;
    }
    for (uint32_t i = 0; i < s->nodes; i++)
        for (uint32_t k = 0; k < n; k++)
            room->r[(size_t)dm_strip_place(s, i) * n + k] = room->p[(size_t)i * n + k];
    for (int side = 0; side < 2; side++) {
        const uint32_t i = dm_strip_end(s, side);
        for (uint32_t k = 0; k < n && s->absorbs[side] != 0.0; k++)
            room->r[(size_t)dm_strip_place(s, i) * n + k] -=
                0.5 * s->absorbs[side] * dm_strip_moved(room, i, k);
    }
}

/* cell c, number i of its block: equations of its nodes or its own, and the matrix */
static inline __attribute__((always_inline)) void add_rows(dm_strip_room *room, uint32_t c,
                                                           uint32_t i, uint32_t n, uint32_t rows,
                                                           int matrix) {
    const dm_strip *s = room->strip;
    const uint32_t place[2] = {dm_strip_place(s, c) * n, dm_strip_place(s, c + 1) * n};
    const double *out = room->buffer + i;
    for (uint32_t a = 0; a < rows; a++)
        room->r[place[a / n] + a % n] += out[(size_t)a * DM_CELL_BLOCK];
    if (!matrix) return;
    for (uint32_t a = 0; a < rows; a++)
        room->terms = fmax(room->terms, fabs(out[(size_t)a * DM_CELL_BLOCK]));
    const size_t w = room->band.width;
    out += (size_t)rows * DM_CELL_BLOCK;
    for (uint32_t a = 0; a < rows; a++)
        for (uint32_t b = 0; b < 2 * n; b++, out += DM_CELL_BLOCK) {
            const size_t row = place[a / n] + a % n, column = place[b / n] + b % n;
            room->A[2 * w + row + column * 3 * w] += *out;
        }
}

/* A field of one value has loops of its own, whose counts are constants. */
static void add_block(dm_strip_room *room, uint32_t c, uint32_t count, int matrix) {
    const uint32_t n = room->strip->layout.values, rows = dm_strip_rows(room->strip);
    if (n == 1 && rows == 2 && matrix)
        for (uint32_t i = 0; i < count; i++) add_rows(room, c + i, i, 1, 2, 1);
    else if (n == 1 && rows == 2)
        for (uint32_t i = 0; i < count; i++) add_rows(room, c + i, i, 1, 2, 0);
    else
        for (uint32_t i = 0; i < count; i++) add_rows(room, c + i, i, n, rows, matrix);
}

/* Rows and values that are held: row and column of 1, nothing to do. Without its column the pivots
 * would mix that 1 with entries of L's own size. */
static void hold(dm_strip_room *room, int matrix) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values, w = room->band.width;
    for (uint32_t u = 0; u < dm_strip_unknowns(s); u++) {
        if (!s->held[u]) continue;
        const uint32_t row = dm_strip_place(s, u / n) * n + u % n;
        room->r[row] = 0.0;
        if (!matrix) continue;
        const uint32_t first = row > w ? row - w : 0;
        const uint32_t last = row + w < room->band.n ? row + w : room->band.n - 1;
        for (uint32_t j = first; j <= last; j++) {
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, j)] = j == row;
            room->A[dm_band_row(&room->band, j) + dm_band_column(&room->band, row)] = j == row;
        }
    }
}

/* d(force)/d(upper) of absorbing ends, -c/2 on the diagonal. */
static void add_absorbing(dm_strip_room *room) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    for (int side = 0; side < 2; side++) {
        const uint32_t first = dm_strip_place(s, dm_strip_end(s, side)) * n;
        for (uint32_t row = first; row < first + n; row++)
            room->A[dm_band_row(&room->band, row) + dm_band_column(&room->band, row)] -=
                0.5 * s->absorbs[side];
    }
}

/* r, and with `matrix` A; the largest entry of r, NaN where there is one */
static double evaluate(dm_strip_room *room, int matrix) {
    const dm_strip *s = room->strip;
    begin(room);
    if (matrix) {
        memset(room->A, 0, dm_band_size(&room->band) * sizeof *room->A);
        room->terms = 0.0;
    }
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(matrix ? &s->tangent : &s->equation, room->memory, room->scalars,
                        room->buffer, c, count);
        add_block(room, c, count, matrix);
    }
    if (matrix) add_absorbing(room);
    hold(room, matrix);
    double largest = 0.0;
    for (uint32_t i = 0; i < room->band.n; i++) largest = dm_largest(largest, room->r[i]);
    return largest;
}

/* ---- the iteration ---- */

/* The factors; those of the first level of a run are looked at for pivots that are zero to
 * round-off of their columns: what no equation determines. */
static dm_status factor(dm_strip_room *room) {
    const uint32_t n = room->band.n, w = room->band.width;
    for (uint32_t j = 0; j < n && !room->checked; j++) {
        const uint32_t first = j > w ? j - w : 0, last = j + w < n ? j + w : n - 1;
        room->scratch[j] = 0.0;
        for (uint32_t i = first; i <= last; i++) {
            const double x = room->A[dm_band_row(&room->band, i) + dm_band_column(&room->band, j)];
            room->scratch[j] = fmax(room->scratch[j], fabs(x));
        }
    }
    const dm_status status = dm_band_factor(room->A, room->pivot, &room->band);
    for (uint32_t j = 0; j < n && !room->checked && status == DM_OK; j++) {
        const size_t at = dm_band_row(&room->band, j) + dm_band_column(&room->band, j);
        if (fabs(room->A[at]) * room->scratch[j] > LARGEST) return DM_SINGULAR;
    }
    room->checked = 1;
    return status;
}

/* the largest increment, each value in units of its own largest, or a share of the largest of all;
 * upper += part * dx */
static double advance(dm_strip_room *room, double part) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    double size[DM_ARRAY_LOOP_MOST], moved[DM_ARRAY_LOOP_MOST], all = 0.0, step = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        double *upper = room->memory + dm_cell_upper(&s->layout, k);
        size[k] = moved[k] = 0.0;
        for (uint32_t i = 0; i < s->nodes; i++) {
            const double dx = room->dx[(size_t)dm_strip_place(s, i) * n + k];
            upper[i] += part * dx;
            moved[k] = dm_largest(moved[k], dx);
            size[k] = dm_largest(size[k], upper[i]);
        }
        if (dm_strip_is_ring(s)) upper[s->nodes] = upper[0];
        all = dm_largest(all, size[k]);
        all = dm_largest(all, moved[k]);
    }
    for (uint32_t k = 0; k < n; k++) {
        const double scale = fmax(size[k] + moved[k], SMALL * all);
        step = dm_largest(step, scale > 0.0 ? moved[k] / scale : moved[k]);
    }
    return step;
}

/* dx = -A^-1 r */
static void find_increment(dm_strip_room *room) {
    for (uint32_t i = 0; i < room->band.n; i++) room->dx[i] = -room->r[i];
    dm_band_solve(room->dx, room->A, room->pivot, &room->band, room->scratch);
}

/* Is the residual of cell i of the block at c no more than round-off of the terms of its rows,
 * |A| (|upper| + |lower|)? The buffer holds residual and matrix. */
static int is_left_in(const dm_strip_room *room, uint32_t c, uint32_t i) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values, rows = dm_strip_rows(s);
    const double *A = room->buffer + i + (size_t)rows * DM_CELL_BLOCK;
    for (uint32_t a = 0; a < rows; a++) {
        double terms = 0.0;
        for (uint32_t b = 0; b < 2 * n; b++, A += DM_CELL_BLOCK) {
            const double *lower = room->memory + dm_cell_lower(&s->layout, b % n) + c + i + b / n,
                         *upper = room->memory + dm_cell_upper(&s->layout, b % n) + c + i + b / n;
            terms += fabs(*A) * (fabs(*upper) + fabs(*lower));
        }
        const int held = s->held[(size_t)(c + i) * n + a];
        if (!held && !(fabs(room->buffer[(size_t)a * DM_CELL_BLOCK + i]) <= LEFT * terms)) return 0;
    }
    return 1;
}

/* Is what is left round-off? A row of boxes is a whole equation, in units of its own. */
static int is_left(dm_strip_room *room, double residual) {
    const dm_strip *s = room->strip;
    if (!s->boxes) return residual <= LEFT * room->terms;
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(&s->tangent, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t i = 0; i < count; i++)
            if (!is_left_in(room, c, i)) return 0;
    }
    return 1;
}

/* Is x + dx, which stands there, the root to round-off, or all that can be had? */
static int is_last(dm_strip_room *room, double step, double last, int fresh, double residual) {
    const double rate = last < INFINITY ? step / last : fresh ? SLOW : 1.0;
    if (step <= ROUND_OFF && (fresh || rate < SLOW)) return 1;
    if (rate < SLOW && step * rate <= NEGLIGIBLE) return 1;
    return rate > 0.5 && (step <= STALLED || is_left(room, residual));
}

/* An increment that makes the residual larger is halved, a few times. */
static dm_status damp(dm_strip_room *room, double *residual) {
    const double before = *residual;
    double part = 1.0;
    for (int k = 0; k < DAMPINGS; k++) {
        *residual = evaluate(room, 0);
        if (*residual <= before || (k == 0 && *residual <= 2.0 * before)) return DM_OK;
        advance(room, -0.5 * part);
        part *= 0.5;
    }
    *residual = evaluate(room, 0);
    return isfinite(*residual) ? DM_OK : DM_NOT_FINITE;
}

/* the upper level at the height that is set */
static dm_status solve_level(dm_strip_room *room, dm_strip_report *report) {
    double last = INFINITY;
    int fresh = 1;
    for (int k = 0; k < MOST; k++) {
        report->residual = evaluate(room, fresh);
        report->iterations++;
        if (!isfinite(report->residual)) return DM_NOT_FINITE;
        dm_status status = DM_OK;
        if (fresh) status = factor(room);
        if (status != DM_OK) return status;
        find_increment(room);
        const double step = advance(room, 1.0);
        if (!isfinite(step)) return DM_NOT_FINITE;
        if (is_last(room, step, last, fresh, report->residual)) return DM_OK;
        if (step > last && fresh && step > STALLED) status = damp(room, &report->residual);
        if (status != DM_OK) return status;
        fresh = step > SLOW * last;
        last = step;
    }
    return DM_NO_CONVERGENCE;
}

/* ---- an unknown height ----
 * F(h) = (S_t - S_h)(u(h), h) - target is a function of one number: safeguarded Newton steps. A
 * step of u and h together would have a root only where u is nearly right already. */

typedef struct {
    double F, slope;  /* at h, and dF/dh along the levels u(h) */
    double low, high; /* a root lies between them, once a change of sign was seen; else 0, 0 */
    double before, F_before;
} height_search;

/* G - target, G_h; room->slope = dG/du, room->z = dS_lower/dh */
static void evaluate_clock(dm_strip_room *room, double target, height_search *f) {
    const dm_strip *s = room->strip;
    const uint32_t n = s->layout.values;
    memset(room->z, 0, room->band.n * sizeof *room->z);
    memset(room->slope, 0, room->band.n * sizeof *room->slope);
    f->F = -target;
    f->slope = 0.0;
    for (uint32_t c = 0; c < s->cells; c += DM_CELL_BLOCK) {
        const uint32_t count = s->cells - c < DM_CELL_BLOCK ? s->cells - c : DM_CELL_BLOCK;
        dm_cell_map_run(&s->clock, room->memory, room->scalars, room->buffer, c, count);
        for (uint32_t i = 0; i < count; i++) {
            const double *out = room->buffer + i;
            f->F += out[0];
            f->slope += out[(size_t)(1 + 2 * n) * DM_CELL_BLOCK];
            for (uint32_t a = 0; a < 2 * n; a++) {
                const uint32_t row = dm_strip_place(s, a < n ? c + i : c + i + 1) * n + a % n;
                room->slope[row] += out[(size_t)(1 + a) * DM_CELL_BLOCK];
                room->z[row] += out[(size_t)(2 + 2 * n + a) * DM_CELL_BLOCK];
            }
        }
    }
    for (uint32_t u = 0; u < room->band.n; u++) {
        const uint32_t row = dm_strip_place(s, u / n) * n + u % n;
        if (s->held[u]) room->z[row] = room->slope[row] = 0.0;
    }
}

/* F and dF/dh at a level that is solved; z = -du/dh */
static dm_status evaluate_height(dm_strip_room *room, double target, height_search *f) {
    evaluate(room, 1);
    const dm_status status = factor(room);
    if (status != DM_OK) return status;
    evaluate_clock(room, target, f);
    dm_band_solve(room->z, room->A, room->pivot, &room->band, room->scratch);
    for (uint32_t i = 0; i < room->band.n; i++) f->slope -= room->slope[i] * room->z[i];
    return DM_OK;
}

/* The next increment of h: Newton's, which stretches h by a factor at most, so that it stays
 * positive (the step back is a false root), or half of the way between changes of sign. */
static double next_increment(height_search *f, double h) {
    if (f->before > 0.0 && f->F * f->F_before < 0.0 &&
        (f->low == 0.0 || (f->before >= f->low && f->before <= f->high))) {
        f->low = fmin(h, f->before);
        f->high = fmax(h, f->before);
    }
    double next = h - f->F / f->slope;
    if (!(next < STRETCH * h)) next = STRETCH * h;
    if (next < h / STRETCH) next = h / STRETCH;
    if (f->low > 0.0 && !(next >= f->low && next <= f->high)) next = 0.5 * (f->low + f->high);
    f->before = h;
    f->F_before = f->F;
    return next - h;
}

/* The level of every height that is tried is solved to round-off, from the one before, moved along
 * du/dh: so F is smooth. */
static dm_status solve_height(dm_strip_room *room, double *height, double target,
                              dm_strip_report *report) {
    height_search f = {0};
    double last = INFINITY;
    for (int k = 0; k < MOST; k++) {
        dm_status status = solve_level(room, report);
        if (status == DM_OK) status = evaluate_height(room, target, &f);
        if (status != DM_OK || fabs(f.F) <= EXACT * fabs(target)) return status;
        const double dh = next_increment(&f, *height), step = fabs(dh) / *height;
        if (!isfinite(dh)) return DM_NOT_FINITE;
        if (step <= ROUND_OFF || (step <= NOISE && step > 0.5 * last)) return DM_OK;
        for (uint32_t i = 0; i < room->band.n; i++) room->dx[i] = -room->z[i] * dh;
        advance(room, 1.0);
        *height += dh;
        dm_strip_set(room, DM_STRIP_HEIGHT, *height);
        last = step;
    }
    return DM_NO_CONVERGENCE;
}

/* *height is the guess, and then the height. */
dm_status dm_strip_solve(dm_strip_room *room, double *height, double target,
                         dm_strip_report *report) {
    *report = (dm_strip_report){0};
    return height ? solve_height(room, height, target, report) : solve_level(room, report);
}
