/* pairs.c - rows of pairs, each a run of one loop along arrays. */
#include "chain/pairs.h"

#include "algebra/derive.h"
#include "graph/analyse.h"
#include "numbers/compensated.h"

#include <string.h>

enum { GROUP = DM_ARRAY_GROUP };

/* two numbers of any place, which every processor adds side by side */
typedef double two __attribute__((vector_size(16), aligned(8)));

/* What a strip works with: outputs along the row, where those by columns of partners add up when
 * all pairs count; the totals of outputs; a scalar for every column of body i; and of near partners
 * the row itself and their columns. */
typedef struct {
    double *out;    /* [outputs][pitch] */
    double *total;  /* [outputs][pitch] */
    double *scalar; /* [columns][GROUP] */
    double *beside; /* [columns][pitch] */
    dm_near_row row;
} strip;

static strip strip_of(const dm_pairs *p, uint32_t number) {
    strip s = {.out = p->strip + number * p->size};
    s.total = s.out + p->outputs * p->pitch;
    s.scalar = s.total + p->outputs * p->pitch;
    s.beside = s.scalar + (size_t)p->sum->columns * GROUP;
    if (!p->near) return s;
    for (uint32_t a = 0; a < p->sum->axes; a++)
        s.row.at[a] = s.beside + (p->sum->partner + a) * p->pitch;
    s.row.j = (void *)(s.beside + p->sum->columns * p->pitch);
    s.row.all = s.row.j + p->pitch;
    s.row.square = s.beside + (p->sum->columns + 1) * p->pitch;
    return s;
}

/* doubles of a strip; two whole numbers take the place of one */
static size_t strip_size(const dm_pairs *p) {
    const size_t columns = p->sum->columns, own = 2 * p->outputs * p->pitch + columns * GROUP;
    return p->near ? own + (columns + 2) * p->pitch : own;
}

/* is output k added along the row, at the place of the partner? */
static int is_partner(const dm_pairs *p, uint32_t k) {
    return p->slopes && p->sum->column[p->column[k]].partner;
}

/* ---- making one ---- */

/* the list of neighbours of a sum within a distance */
static dm_status open_near(dm_pairs *p, dm_arena *arena) {
    const dm_sum *s = p->sum;
    if (!(s->within > 0.0)) return DM_OK;
    p->near = dm_arena_take(arena, sizeof *p->near);
    if (!p->near) return DM_NO_MEMORY;
    *p->near =
        (dm_near){.bodies = s->bodies, .axes = s->axes, .within = s->within, .margin = s->margin};
    for (uint32_t a = 0; a < s->axes; a++) p->near->box[a] = s->box[a];
    return dm_near_open(p->near, arena);
}

static dm_status open_arrays(dm_pairs *p, dm_arena *arena) {
    const dm_sum *s = p->sum;
    p->strips = s->bodies < DM_PAIR_MANY ? 1 : DM_PAIR_STRIPS;
    p->pitch = (s->bodies + 3 * GROUP - 1) / GROUP * GROUP;
    p->size = strip_size(p);
    p->array = dm_arena_take(arena, s->columns * p->pitch * sizeof *p->array);
    p->strip = dm_arena_take(arena, p->strips * p->size * sizeof *p->strip);
    if (!p->array || !p->strip) return DM_NO_MEMORY;
    memset(p->array, 0, s->columns * p->pitch * sizeof *p->array);
    memset(p->strip, 0, p->strips * p->size * sizeof *p->strip);
    return DM_OK;
}

/* The loop of a row: columns of i are scalars, those of partners arrays; outputs by columns of
 * partners take along what stands at their places, unless these are scattered. */
static dm_status make_loop(dm_pairs *p, const dm_node *roots, dm_compile *compile,
                           dm_arena *arena) {
    const dm_sum *s = p->sum;
    dm_node with[DM_SUM_COLUMNS] = {0}, out[DM_PAIR_COLUMNS];
    dm_array_loop_draft d;
    if (!dm_array_loop_begin(&d, arena)) return DM_NO_MEMORY;
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_array_ref own = {DM_ARRAY_SCALAR, c},
                           other = {DM_ARRAY_MAIN, (int64_t)(c * p->pitch)};
        if (dm_depends(s->term, roots, p->outputs, c, 1))
            with[c] = dm_array_loop_read(&d, s->column[c].partner ? other : own);
    }
    dm_transplant(d.g, s->term, roots, p->outputs, with, out);
    for (uint32_t k = 0; k < p->outputs; k++) {
        const dm_array_ref to = {DM_ARRAY_BUFFER, (int64_t)(k * p->pitch)};
        const int adds = is_partner(p, k) && !p->near;
        const dm_node sum = adds ? dm_add(d.g, dm_array_loop_read(&d, to), out[k]) : out[k];
        dm_array_loop_write(&d, to, sum);
    }
    return dm_array_loop_end(&p->loop, &d, compile, arena);
}

dm_status dm_pairs_open(dm_pairs *p, const dm_sum *s, const dm_node *roots, uint32_t outputs,
                        const uint8_t *column, int slopes, dm_compile *compile, dm_arena *arena) {
    *p = (dm_pairs){.sum = s, .outputs = outputs, .slopes = slopes};
    for (uint32_t k = 0; slopes && k < outputs; k++) p->column[k] = column[k];
    dm_status status = open_near(p, arena);
    if (status == DM_OK) status = open_arrays(p, arena);
    return status == DM_OK ? make_loop(p, roots, compile, arena) : status;
}

/* ---- a row ---- */

static double *array_of(const dm_pairs *p, uint32_t column) {
    return p->array + column * p->pitch;
}

/* the positions of the bodies, for the list */
static void find_positions(const dm_pairs *p, const double *at[DM_NEAR_AXES]) {
    for (uint32_t a = 0; a < p->sum->axes; a++) at[a] = array_of(p, a);
}

/* Every column as an array over the bodies: a partner's is that of the body it is. */
static void begin(const dm_pairs *p, const double *x) {
    const dm_sum *s = p->sum;
    const double *at[DM_NEAR_AXES];
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_column *column = s->column + c;
        const double *from = (column->data ? column->data : x) + column->first;
        double *to = array_of(p, c);
        for (uint32_t i = 0; i < s->bodies; i++) to[i] = from[(size_t)i * column->step];
    }
    if (!p->near) return;
    find_positions(p, at);
    dm_near_update(p->near, at);
}

/* the partners of i within the distance, and their columns; positions come with them */
static uint32_t find_row(const dm_pairs *p, strip *s, uint32_t i) {
    const double *at[DM_NEAR_AXES];
    const dm_sum *sum = p->sum;
    find_positions(p, at);
    dm_near_find(p->near, &s->row, at, i);
    for (uint32_t c = sum->partner + sum->axes; c < sum->columns; c++) {
        double *to = s->beside + c * p->pitch;
        const double *from = array_of(p, c);
        if (!sum->column[c].partner) continue;
        for (uint32_t k = 0; k < s->row.count; k++) to[k] = from[s->row.j[k]];
    }
    return s->row.count;
}

/* Entries first .. i of output k, of bodies that are no partners of i: a row begins with a whole
 * group, so that its loads and stores cross no line of the cache. What is added along the row is
 * put back there, other outputs are 0. */
static void keep_head(const dm_pairs *p, strip *s, double *head, size_t first, size_t behind) {
    for (uint32_t k = 0; k < p->outputs; k++)
        if (is_partner(p, k))
            memcpy(head + k * GROUP, s->out + k * p->pitch + first, behind * sizeof *head);
}

static void clear_head(const dm_pairs *p, strip *s, const double *head, size_t first,
                       size_t behind) {
    for (uint32_t k = 0; k < p->outputs; k++) {
        double *out = s->out + k * p->pitch + first;
        if (is_partner(p, k))
            memcpy(out, head + k * GROUP, behind * sizeof *head);
        else
            memset(out, 0, behind * sizeof *out);
    }
}

/* All outputs of the pairs of i; they stand at s->out + *first, as many as are returned. */
static uint32_t run_row(const dm_pairs *p, strip *s, uint32_t i, size_t *first) {
    double head[DM_PAIR_COLUMNS * GROUP];
    *first = p->near ? 0 : (i + 1) / GROUP * GROUP;
    const size_t behind = p->near ? 0 : i + 1 - *first;
    const uint32_t count = p->near ? find_row(p, s, i) : p->sum->bodies - (uint32_t)*first;
    for (uint32_t c = 0; c < p->sum->columns; c++)
        for (uint32_t l = 0; !p->sum->column[c].partner && l < GROUP; l++)
            s->scalar[c * GROUP + l] = array_of(p, c)[i];
    const dm_array_bases at = {.main = (p->near ? s->beside : p->array) + *first,
                               .buffer = s->out + *first,
                               .scalars = s->scalar};
    if (behind) keep_head(p, s, head, *first, behind);
    dm_array_loop_run(&p->loop, at, count);
    if (behind) clear_head(p, s, head, *first, behind);
    return count;
}

/* ---- the sum ---- */

double dm_pairs_value(const dm_pairs *p, const double *x) {
    double sum[GROUP] = {0.0}, low[GROUP] = {0.0};
    strip s = strip_of(p, 0);
    begin(p, x);
    for (uint32_t i = 0; i + 1 < p->sum->bodies; i++) {
        size_t first;
        const uint32_t count = run_row(p, &s, i, &first);
        for (uint32_t k = 0; k < count; k++)
            dm_sum_add(sum + k % GROUP, low + k % GROUP, s.out[first + k]);
    }
    for (uint32_t l = 1; l < GROUP; l++) {
        dm_sum_add(sum, low, sum[l]);
        dm_sum_add(sum, low, low[l]);
    }
    return sum[0] + low[0];
}

/* ---- slopes ---- */

/* y[count] in eight partial sums, of numbers k mod 8 */
static double add_up(const double *y, uint32_t count) {
    two a = {0.0, 0.0}, b = a, c = a, d = a;
    const double *end = y + count / GROUP * GROUP;
    for (; y < end; y += GROUP) {
        a += *(const two *)y, b += *(const two *)(y + 2);
        c += *(const two *)(y + 4), d += *(const two *)(y + 6);
    }
    double part[GROUP] = {a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]};
    for (uint32_t l = 0; l < count % GROUP; l++) part[l] += y[l];
    return ((part[0] + part[1]) + (part[2] + part[3])) +
           ((part[4] + part[5]) + (part[6] + part[7]));
}

/* the rows of one strip */
static void run_strip(const dm_pairs *p, uint32_t number) {
    strip s = strip_of(p, number);
    memset(s.out, 0, 2 * p->outputs * p->pitch * sizeof *s.out); /* and the totals behind it */
    for (uint32_t i = number; i + 1 < p->sum->bodies; i += p->strips) {
        size_t first;
        const uint32_t count = run_row(p, &s, i, &first);
        for (uint32_t k = 0; k < p->outputs; k++) {
            const double *y = s.out + k * p->pitch + first;
            double *total = s.total + k * p->pitch;
            if (!is_partner(p, k))
                total[i] += add_up(y, count);
            else
                for (uint32_t l = 0; p->near && l < count; l++) total[s.row.j[l]] += y[l];
        }
    }
}

/* strip by strip in their order */
static void end(const dm_pairs *p, double *out, double factor) {
    for (uint32_t k = 0; k < p->outputs; k++) {
        const dm_column *c = p->sum->column + p->column[k];
        const size_t behind = is_partner(p, k) && !p->near ? 0 : p->outputs * p->pitch;
        const double *of = p->strip + behind + k * p->pitch;
        for (uint32_t i = 0; i < p->sum->bodies; i++) {
            double sum = 0.0;
            for (uint32_t number = 0; number < p->strips; number++) sum += of[number * p->size + i];
            out[c->first + (size_t)c->step * i] += factor * sum;
        }
    }
}

/* dm_team_work: strips in turns */
static void run_strips(void *context, uint32_t part, uint32_t parts) {
    const dm_pairs *p = context;
    for (uint32_t number = part; number < p->strips; number += parts) run_strip(p, number);
}

void dm_pairs_slopes(const dm_pairs *p, double *out, double factor, const double *x) {
    dm_pairs shared = *p;
    begin(p, x);
    dm_team_run(p->team, run_strips, &shared);
    end(p, out, factor);
}

int dm_pairs_shared(const dm_pairs *p) {
    return p->strips > 1 && p->loop.one.backend && strcmp(p->loop.one.backend, "jit") == 0;
}
