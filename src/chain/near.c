/* near.c - cells, lists and rows. */
#include "chain/near.h"

#include <math.h>
#include <string.h>

/* cells of half the side r + margin: partners are at most so many cells away along an axis */
enum { REACH = 2 };

/* two numbers of any place, which every processor handles side by side */
typedef double two __attribute__((vector_size(16), aligned(8)));

/* the pairs that lists have room for, at most all of them */
static size_t room_for(uint32_t bodies) {
    const size_t all = (size_t)bodies * (bodies - 1) / 2, some = (size_t)bodies * DM_NEAR_MEAN;
    return all < some ? all : some;
}

dm_status dm_near_open(dm_near *n, dm_arena *arena) {
    const size_t bodies = n->bodies;
    n->most = 4 * n->bodies + 64;
    n->room = room_for(n->bodies);
    n->then = dm_arena_take(arena, 2 * (n->axes * bodies + 1) * sizeof *n->then);
    n->square = dm_arena_take(arena, (bodies + 2) * sizeof *n->square);
    n->begin = dm_arena_take(arena, ((size_t)n->most + 2) * sizeof *n->begin);
    n->order = dm_arena_take(arena, (bodies + 1) * sizeof *n->order);
    n->start = dm_arena_take(arena, (bodies + 1) * sizeof *n->start);
    n->item = dm_arena_take(arena, (n->room + 1) * sizeof *n->item);
    if (!n->then || !n->square || !n->begin || !n->order || !n->start || !n->item)
        return DM_NO_MEMORY;
    n->sorted = n->then + n->axes * bodies;
    for (uint32_t a = 0; a < n->axes; a++) n->inverse[a] = n->box[a] > 0.0 ? 1.0 / n->box[a] : 0.0;
    n->made = n->listed = 0;
    return DM_OK;
}

/* the whole number nearest to x, for |x| < 2^51: the sum has no room for a fraction */
static const double SHIFT = 6755399441055744.0; /* 1.5 2^52 */
static inline double whole(double x) {
    return (x + SHIFT) - SHIFT;
}

/* ---- cells ---- */

/* Along an axis: as many cells as have at least half of r + margin as their side, in the box or
 * around all bodies; fewer where there would be more than memory. */
static void choose_cells(dm_near *n, const double *const *x) {
    const double side = (n->within + n->margin) / REACH;
    double product = 1.0;
    for (uint32_t a = 0; a < DM_NEAR_AXES; a++) n->cells[a] = 1;
    for (uint32_t a = 0; a < n->axes; a++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < n->bodies && !(n->box[a] > 0.0); i++) {
            low = fmin(low, x[a][i]);
            high = fmax(high, x[a][i]);
        }
        const double span = n->box[a] > 0.0 ? n->box[a] : high - low;
        const double count = fmin(1024.0, floor(span / side));
        n->low[a] = n->box[a] > 0.0 ? 0.0 : low;
        n->cells[a] = count > 1.0 ? (uint32_t)count : 1;
        n->scale[a] = span > 0.0 && isfinite(span) ? n->cells[a] / span : 0.0;
        product *= n->cells[a];
    }
    while (product > n->most)
        for (uint32_t a = 0; a < n->axes; a++) {
            if (n->cells[a] < 2) continue;
            const uint32_t half = n->cells[a] / 2;
            product *= (double)half / n->cells[a];
            n->scale[a] *= (double)half / n->cells[a];
            n->cells[a] = half;
        }
}

/* the cell of position x along axis a; what is not a number is in the first one */
static uint32_t cell_along(const dm_near *n, uint32_t a, double x) {
    double place = x;
    if (n->box[a] > 0.0) place = x - n->box[a] * floor(x / n->box[a]);
    place = (place - n->low[a]) * n->scale[a];
    if (!(place > 0.0)) return 0;
    return place < n->cells[a] - 1 ? (uint32_t)place : n->cells[a] - 1;
}

static uint32_t cell_of(const dm_near *n, uint32_t body) {
    uint32_t number = 0;
    for (uint32_t a = n->axes; a-- > 0;)
        number = number * n->cells[a] + cell_along(n, a, n->then[(size_t)a * n->bodies + body]);
    return number;
}

/* Counting sort: begin[] is one cell ahead while it is filled, so that it ends where it belongs. */
static void fill_cells(dm_near *n, const double *const *x) {
    choose_cells(n, x);
    const uint32_t count = n->cells[0] * n->cells[1] * n->cells[2];
    for (uint32_t a = 0; a < n->axes; a++)
        memcpy(n->then + (size_t)a * n->bodies, x[a], n->bodies * sizeof *n->then);
    memset(n->begin, 0, ((size_t)count + 2) * sizeof *n->begin);
    for (uint32_t i = 0; i < n->bodies; i++) n->begin[cell_of(n, i) + 2]++;
    for (uint32_t c = 0; c < count; c++) n->begin[c + 2] += n->begin[c + 1];
    for (uint32_t i = 0; i < n->bodies; i++) {
        const uint32_t to = n->begin[cell_of(n, i) + 1]++;
        n->order[to] = i;
        for (uint32_t a = 0; a < n->axes; a++) n->sorted[(size_t)a * n->bodies + to] = x[a][i];
    }
    n->made = 1;
}

/* cells from first to last, and from 0 to `wrapped` - 1 or `wrapped` to the end beside them */
typedef struct {
    uint32_t count;          /* of ranges, at most two */
    uint32_t from[2], to[2]; /* both are in the range */
} range;

/* the cells that are at most REACH away from cell `at` along an axis, each once */
static range beside(const dm_near *n, uint32_t a, uint32_t at) {
    const uint32_t cells = n->cells[a];
    const int periodic = n->box[a] > 0.0;
    if (periodic && cells <= 2 * REACH + 1) return (range){1, {0}, {cells - 1}};
    range r = {1, {at < REACH ? 0 : at - REACH}, {at + REACH < cells ? at + REACH : cells - 1}};
    if (periodic && at < REACH) r.count = 2, r.from[1] = cells - (REACH - at), r.to[1] = cells - 1;
    if (periodic && at + REACH >= cells) r.count = 2, r.to[1] = at + REACH - cells;
    return r;
}

/* ---- candidates ---- */

/* square[k] of the distance of bodies order[from + k], k < count, from x, as they were when cells
 * were made; two at a time, one more than asked for where the count is odd */
static void find_squares(double *square, const dm_near *n, const double x[DM_NEAR_AXES],
                         uint32_t from, uint32_t count) {
    for (uint32_t k = 0; k < count; k += 2) {
        two sum = {0.0, 0.0};
        for (uint32_t a = 0; a < n->axes; a++) {
            two d = *(const two *)(n->sorted + (size_t)a * n->bodies + from + k) - x[a];
            d -= n->box[a] * ((d * n->inverse[a] + SHIFT) - SHIFT);
            sum += d * d;
        }
        *(two *)(square + k) = sum;
    }
}

/* ascending: bodies of one cell are already */
static void sort(uint32_t *item, uint32_t count) {
    for (uint32_t gap = count > 60 ? count / 3 : 1; gap > 0; gap = gap == 1 ? 0 : gap / 3 + 1)
        for (uint32_t k = gap; k < count; k++) {
            const uint32_t x = item[k];
            uint32_t to = k;
            for (; to >= gap && item[to - gap] > x; to -= gap) item[to] = item[to - gap];
            item[to] = x;
        }
}

/* those of cells first .. last that are partners of i */
static uint32_t add_run(const dm_near *n, uint32_t i, const double *x, uint32_t first,
                        uint32_t last, uint32_t *out, double *square) {
    const double far = n->within + n->margin, far2 = far * far;
    const uint32_t from = n->begin[first], count = n->begin[last + 1] - from;
    uint32_t found = 0;
    find_squares(square, n, x, from, count);
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t j = n->order[from + k];
        out[found] = j;
        found += (j > i) & (square[k] < far2);
    }
    return found;
}

/* partners j > i within r + margin, ascending, into out[bodies]; square[bodies + 2] scratch */
static uint32_t candidates(const dm_near *n, uint32_t i, uint32_t *out, double *square) {
    range r[DM_NEAR_AXES] = {{1, {0}, {0}}, {1, {0}, {0}}, {1, {0}, {0}}};
    double x[DM_NEAR_AXES] = {0.0};
    uint32_t found = 0;
    for (uint32_t a = 0; a < n->axes; a++) {
        x[a] = n->then[(size_t)a * n->bodies + i];
        r[a] = beside(n, a, cell_along(n, a, x[a]));
    }
    for (uint32_t w = 0; w < r[2].count; w++)
        for (uint32_t c = r[2].from[w]; c <= r[2].to[w]; c++)
            for (uint32_t v = 0; v < r[1].count; v++)
                for (uint32_t b = r[1].from[v]; b <= r[1].to[v]; b++)
                    for (uint32_t u = 0; u < r[0].count; u++) {
                        const uint32_t line = (c * n->cells[1] + b) * n->cells[0];
                        found += add_run(n, i, x, line + r[0].from[u], line + r[0].to[u],
                                         out + found, square);
                    }
    sort(out, found);
    return found;
}

/* ---- lists ---- */

/* has a body moved more than margin / 2, or nowhere that is a number? */
static int is_old(const dm_near *n, const double *const *x) {
    const double limit = 0.25 * n->margin * n->margin;
    for (uint32_t i = 0; i < n->bodies; i++) {
        double sum = 0.0;
        for (uint32_t a = 0; a < n->axes; a++) {
            const double d = x[a][i] - n->then[(size_t)a * n->bodies + i];
            sum += d * d;
        }
        if (!(sum <= limit)) return 1;
    }
    return 0;
}

/* Rows one after the other; a row may need as much room as there are bodies behind, so that is what
 * must be left. */
static int make_lists(dm_near *n) {
    size_t at = 0;
    for (uint32_t i = 0; i < n->bodies; i++) {
        const size_t rest = n->bodies - i;
        n->start[i] = (uint32_t)at;
        if (at + rest > n->room + 1 || at > UINT32_MAX - rest) return 0;
        at += candidates(n, i, n->item + at, n->square);
    }
    n->start[n->bodies] = (uint32_t)at;
    return 1;
}

void dm_near_update(dm_near *n, const double *const *x) {
    if (n->made && !is_old(n, x)) return;
    fill_cells(n, x);
    n->listed = make_lists(n);
}

/* ---- rows ---- */

void dm_near_find(const dm_near *n, dm_near_row *row, const double *const *x, uint32_t i) {
    const uint32_t *j = row->all;
    uint32_t many, found = 0;
    const double within2 = n->within * n->within;
    if (n->listed) {
        j = n->item + n->start[i];
        many = n->start[i + 1] - n->start[i];
    } else {
        many = candidates(n, i, row->all, row->square);
    }
    for (uint32_t k = 0; k < many; k++) {
        double sum = 0.0;
        for (uint32_t a = 0; a < n->axes; a++) {
            double at = x[a][j[k]];
            at -= n->box[a] * whole((at - x[a][i]) * n->inverse[a]);
            const double d = at - x[a][i];
            row->at[a][found] = at;
            sum += d * d;
        }
        row->j[found] = j[k];
        found += sum < within2;
    }
    row->count = found;
}
