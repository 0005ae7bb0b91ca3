/* cell_ranges.c - which cells have entries of a range, and the entries of a range. */
#include "chain/cell_ranges.h"

#include <string.h>

/* border cells that are nearer to each other are gone through together with what is between them;
 * more pieces of one sum in one range than MOST, or more than an eighth of all cells at borders,
 * are too many */
enum { BLOCK = DM_CELL_BLOCK, NEAR = 64, MOST = 64, FEW = 8 };

void dm_cell_range(uint32_t m, uint32_t unit, uint32_t part, uint32_t parts, uint32_t *from,
                   uint32_t *to) {
    const uint32_t units = (m + unit - 1) / unit;
    *from = (uint32_t)((uint64_t)units * part / parts) * unit;
    *to = (uint32_t)((uint64_t)units * (part + 1) / parts) * unit;
    if (*from > m) *from = m;
    if (*to > m) *to = m;
}

/* ---- pieces ---- */

/* pieces of one sum in one range */
typedef struct {
    dm_cell_piece *piece; /* [MOST + 2] */
    uint32_t sum, count;
} pieces;

/* how many entries of cell i are in [from, to) */
static uint32_t entries_inside(const dm_cell_slopes *d, uint32_t i, uint32_t from, uint32_t to) {
    uint32_t inside = 0;
    for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++)
        inside += dm_cell_share_entry(s, i) - from < to - from;
    return inside;
}

static uint32_t end_of(const dm_cell_piece *p) {
    return p->first + p->count;
}

/* cell i behind all cells so far */
static void put(pieces *p, uint32_t i, int border) {
    const uint32_t gap = border ? NEAR : 1;
    uint32_t n = p->count;
    if (border && n > 1 && !p->piece[n - 1].border && p->piece[n - 2].border &&
        i - end_of(p->piece + n - 2) < gap)
        n--;
    dm_cell_piece *last = p->piece + (n ? n - 1 : 0);
    if (n && last->border == border && i - end_of(last) < gap) {
        last->count = i + 1 - last->first;
        p->count = n;
        return;
    }
    p->piece[n] = (dm_cell_piece){.sum = p->sum, .first = i, .count = 1, .border = border};
    p->count = n <= MOST ? n + 1 : n;
}

/* the pieces of sum k in [from, to); returns how many of their cells are at borders */
static uint32_t cut(const dm_cells *c, pieces *p, uint32_t from, uint32_t to) {
    const dm_cell_slopes *d = c->sum + p->sum;
    const uint32_t cells = d->shares ? d->loop.sum->bodies : 0;
    uint32_t border = 0;
    for (uint32_t i = 0; i < cells; i++) {
        const uint32_t inside = entries_inside(d, i, from, to);
        if (inside) put(p, i, inside < d->shares);
    }
    for (uint32_t j = 0; j < p->count; j++)
        if (p->piece[j].border) border += p->piece[j].count;
    return border;
}

/* all pieces of all ranges to r; 0: there are too many, or too many cells in them */
static int find_pieces(const dm_cells *c, dm_cell_ranges *r, dm_cell_piece *piece,
                       uint32_t *start) {
    uint64_t border = 0, cells = 0;
    uint32_t count = 0, from, to;
    for (uint32_t k = 0; k < c->sums; k++)
        cells += c->sum[k].shares ? c->sum[k].loop.sum->bodies : 0;
    for (uint32_t part = 0; part < r->parts; part++) {
        start[part] = count;
        dm_cell_range(c->m, r->unit, part, r->parts, &from, &to);
        for (uint32_t k = 0; k < c->sums; k++) {
            pieces p = {.piece = piece + count, .sum = k};
            border += cut(c, &p, from, to);
            if (p.count > MOST || FEW * border > cells) return 0;
            count += p.count;
        }
    }
    start[r->parts] = count;
    return 1;
}

const dm_cell_ranges *dm_cell_ranges_make(const dm_cells *c, uint32_t unit, uint32_t parts,
                                          dm_arena *arena) {
    for (const dm_cell_ranges *r = *c->ranges; r; r = r->next)
        if (r->parts == parts && r->unit == unit) return r->start ? r : NULL;
    dm_cell_ranges *r = dm_arena_take(arena, sizeof *r);
    dm_arena *scratch = dm_arena_scratch(arena);
    const size_t most = (size_t)c->sums * parts * (MOST + 1) + 2;
    dm_cell_piece *piece = scratch ? dm_arena_take(scratch, most * sizeof *piece) : NULL;
    uint32_t *start = dm_arena_take(arena, ((size_t)parts + 1) * sizeof *start);
    if (!r || !piece || !start) return NULL;
    *r = (dm_cell_ranges){.next = *c->ranges, .parts = parts, .unit = unit};
    if (find_pieces(c, r, piece, start)) {
        r->piece = dm_arena_take(arena, (start[parts] + 1) * sizeof *piece);
        if (!r->piece) return NULL;
        memcpy(r->piece, piece, start[parts] * sizeof *piece);
        r->start = start;
    }
    *c->ranges = r;
    return r->start ? r : NULL;
}

/* ---- entries ---- */

/* the slopes of a piece to its entries in [from, to) */
static void add_border(const dm_cell_slopes *d, const dm_cell_piece *p, double *out, double factor,
                       const double *x, double *work, uint32_t from, uint32_t to) {
    const dm_cell_loop *l = &d->loop;
    for (uint32_t done = 0; done < p->count; done += BLOCK) {
        const uint32_t first = p->first + done;
        const uint32_t count = p->count - done < BLOCK ? p->count - done : BLOCK;
        dm_cell_loop_run(l, work, BLOCK, x, first, count, work + (size_t)l->outputs * BLOCK);
        for (uint32_t i = 0; i < count; i++)
            for (const dm_cell_share *s = d->share; s < d->share + d->shares; s++) {
                const size_t entry = dm_cell_share_entry(s, first + i);
                if (entry - from < to - from)
                    out[entry] += s->sign * factor * work[s->output * BLOCK + i];
            }
    }
}

void dm_cell_ranges_gradient(const dm_cells *c, const dm_cell_ranges *r, double *out,
                             const double *factor, const double *x, double *work, uint32_t part) {
    uint32_t from, to;
    dm_cell_range(c->m, r->unit, part, r->parts, &from, &to);
    memset(out + from, 0, (to - from) * sizeof *out);
    for (uint32_t j = r->start[part]; j < r->start[part + 1]; j++) {
        const dm_cell_piece *p = r->piece + j;
        const dm_cell_slopes *d = c->sum + p->sum;
        if (p->border)
            add_border(d, p, out, factor[p->sum], x, work, from, to);
        else
            dm_cells_add(d, out, factor[p->sum], x, p->first, p->count, work);
    }
    dm_cells_hold(c, out, from, to);
}
