/* cells_split.c - a burst of steps: every thread goes through the same stages, and all meet before
 * slopes are added up and before they are made anew. */
#include "integ/split/cells_split.h"

#include "chain/cells.h"
#include "chain/curvature.h"
#include "chain/loops.h"
#include "chain/team.h"
#include "chain/virtual_work.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

/* entries at once: forces, then kicks and drifts; passes of Newton's methods */
enum { BLOCK = 64, ELIMINATIONS = 20, PASSES = 50 };

struct dm_cells_split {
    const dm_model *m;
    const dm_cells *cells;
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    int plain;
    dm_team *team;   /* NULL: one thread */
    double *x;       /* (q, v, t): v is not read by forces */
    double *force;   /* [n] of the last evaluation */
    double *slope;   /* [slots] */
    double *scratch; /* [threads][room] */
    size_t room;     /* of slopes, or of forces beside L */
    uint32_t unit;   /* entries of a block: whole cells */
    const double *factor;
    /* of the burst */
    double *state, t, h;
    long count;
};

/* what happens to an entry once its force is there: the kick hb, then with `begins` the kick that
 * begins the next step, then the drift ha; 0: none */
typedef struct {
    double kick, begin, drift;
    int kicks, begins;
} move;

static size_t struct_size(void) {
    return (sizeof(struct dm_cells_split) + sizeof(double) - 1) / sizeof(double);
}

/* entries of a block */
static uint32_t unit_of(const dm_model *m) {
    if (m->sphere) return m->sphere * BLOCK;
    return m->work ? m->work->values * BLOCK : BLOCK;
}

/* scratch of a thread: slopes of cells; of a block the forces beside L, what is added to p and to
 * both forces, their derivatives by v and q, one cell's matrix */
static size_t room_of(const dm_model *m, const dm_cells *cells) {
    if (!m->work) return cells->work;
    const size_t v = m->work->values, unit = unit_of(m);
    const size_t room = m->work->room + (3 + 2 * v) * unit + v * v + v;
    return room > cells->work ? room : cells->work;
}

size_t dm_cells_split_work(const dm_model *m) {
    const dm_cells *cells = m->has & DM_WANT_FORCE ? dm_loops_cells(&m->force) : NULL;
    if (!(m->structure & DM_CELLS) || !cells) return 0;
    return struct_size() + dm_team_size() + 3 * (size_t)m->n + 1 + cells->slots +
           DM_TEAM_MOST * room_of(m, cells) + 8;
}

int dm_cells_split_damps(const dm_splitting *table) {
    return table->stages == 1 && table->b[0] > 0.0 && table->b[1] > 0.0;
}

dm_cells_split *dm_cells_split_open(const dm_model *m, const dm_splitting *table, int plain,
                                    int threads, double *work) {
    dm_cells_split *s = (dm_cells_split *)(void *)work;
    if (!dm_cells_split_work(m)) return NULL;
    const dm_cells *cells = dm_loops_cells(&m->force);
    *s = (dm_cells_split){.m = m, .cells = cells, .table = *table, .plain = plain};
    s->room = room_of(m, cells);
    s->unit = unit_of(m);
    for (int k = 0; k < table->stages; k++) s->c[k + 1] = s->c[k] + table->a[k];
    s->c[table->stages] = 1.0;
    work += struct_size();
    if (threads > 1 && cells->shared && (!m->work || m->work->shared))
        s->team = dm_team_open(work, threads);
    s->x = work + dm_team_size();
    s->force = s->x + 2 * (size_t)m->n + 1;
    s->slope = s->force + m->n;
    s->scratch = s->slope + cells->slots;
    memset(s->x, 0, (2 * (size_t)m->n + 1) * sizeof *s->x);
    return s;
}

void dm_cells_split_close(dm_cells_split *s) {
    if (s->team) dm_team_close(s->team);
    s->team = NULL;
}

/* ---- entries ---- */

/* kicks and drift of `count` entries */
static void move_block(const dm_cells_split *s, const move *v, uint32_t i, uint32_t count) {
    const uint32_t n = s->m->n;
    double *x = s->x + i, *p = s->state + n + i, *force = s->force + i;
    double *low_q = s->state + 2 * (size_t)n + i, *low_p = s->state + 3 * (size_t)n + i;
    const double *w = s->m->inverse_mass + i;
    for (uint32_t k = 0; v->kicks && k < count; k++)
        dm_sum_add(p + k, low_p + k, v->kick * force[k]);
    if (v->begins) {
        for (uint32_t k = 0; k < count; k++) {
            const double kicked = p[k] + v->begin * force[k];
            low_p[k] += v->begin * force[k];
            dm_sum_add(x + k, low_q + k, (v->drift * w[k]) * kicked);
        }
        return;
    }
    for (uint32_t k = 0; v->drift != 0.0 && k < count; k++)
        dm_sum_add(x + k, low_q + k, (v->drift * w[k]) * p[k]);
}

/* the same without low parts */
static void move_plainly(const dm_cells_split *s, const move *v, uint32_t i, uint32_t count) {
    const uint32_t n = s->m->n;
    double *x = s->x + i, *p = s->state + n + i, *force = s->force + i;
    const double *w = s->m->inverse_mass + i;
    for (uint32_t k = 0; v->kicks && k < count; k++) p[k] += v->kick * force[k];
    for (uint32_t k = 0; v->begins && k < count; k++) p[k] += v->begin * force[k];
    for (uint32_t k = 0; v->drift != 0.0 && k < count; k++) x[k] += (v->drift * w[k]) * p[k];
}

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* RATTLE on one unit vector q of m entries of one mass: q1 = a - s q with |q1| = 1, a = q + h w p;
 * p loses s q / (h w). NaN where no such s is there: the step is longer than the sphere is wide. */
static void turn(double *q, double *p, double hw, uint32_t m) {
    double along = 0.0, square = 0.0;
    if (hw == 0.0) return;
    for (uint32_t i = 0; i < m; i++) {
        const double d = hw * p[i]; /* a = q + d, |q| = 1 */
        along += q[i] * d;
        square += d * d;
    }
    const double b = 1.0 + along, gap = 2.0 * along + square;
    const double s = gap / (b + sqrt(b * b - gap));
    for (uint32_t i = 0; i < m; i++) {
        const double old = q[i];
        q[i] = (old + hw * p[i]) - s * old;
        p[i] -= s * old / hw;
    }
}

/* kick, projection to the tangent, kick, turn of whole cells */
static void move_on_spheres(const dm_cells_split *s, const move *v, uint32_t i, uint32_t count) {
    const uint32_t n = s->m->n, m = s->m->sphere;
    for (uint32_t end = i + count; i < end; i += m) {
        double *q = s->x + i, *p = s->state + n + i;
        const double *force = s->force + i;
        if (v->kicks) {
            for (uint32_t k = 0; k < m; k++) p[k] += v->kick * force[k];
            const double out = dot(q, p, m) / dot(q, q, m);
            for (uint32_t k = 0; k < m; k++) p[k] -= out * q[k];
        }
        if (v->begins)
            for (uint32_t k = 0; k < m; k++) p[k] += v->begin * force[k];
        turn(q, p, v->drift * s->m->inverse_mass[i], m);
    }
}

/* ---- forces beside L ---- */

/* what is worked on of one block, in the scratch of a thread */
typedef struct {
    double *f, *dp, *next; /* [unit] the forces; change of p so far; what the forces make of it */
    double *f_q, *f_v;     /* [unit][values] */
    double *J, *rest;      /* [values][values]; scratch of the forces */
} block;

static block block_of(const dm_cells_split *s, double *scratch) {
    const size_t unit = s->unit, v = s->m->work->values;
    block b = {.f = scratch, .dp = scratch + unit, .next = scratch + 2 * unit};
    b.f_q = scratch + 3 * unit;
    b.f_v = b.f_q + unit * v;
    b.J = b.f_v + unit * v;
    b.rest = b.J + v * v + v;
    return b;
}

/* rates of a block, which forces read; the kick that began the step is in the low part of p */
static void set_rates(const dm_cells_split *s, uint32_t i, uint32_t count, const double *dp) {
    const uint32_t n = s->m->n;
    const double *p = s->state + n + i, *low = p + 2 * (size_t)n, *w = s->m->inverse_mass + i;
    double *v = s->x + n + i;
    for (uint32_t k = 0; k < count; k++) v[k] = w[k] * (p[k] + ((dp ? dp[k] : 0.0) + low[k]));
}

/* (1 - hb f_v M^-1) d = r of one cell, by elimination; d takes the place of r */
static void solve_cell(double *J, double *r, const double *f_v, const double *w, double hb,
                       uint32_t v) {
    for (uint32_t a = 0; a < v; a++)
        for (uint32_t b = 0; b < v; b++)
            J[a * v + b] = (a == b ? 1.0 : 0.0) - hb * f_v[a * v + b] * w[b];
    for (uint32_t c = 0; c < v; c++)
        for (uint32_t a = 0; a < v; a++) {
            const double factor = a == c ? 0.0 : J[a * v + c] / J[c * v + c];
            for (uint32_t b = c; b < v && factor != 0.0; b++) J[a * v + b] -= factor * J[c * v + b];
            if (factor != 0.0) r[a] -= factor * r[c];
        }
    for (uint32_t a = 0; a < v; a++) r[a] /= J[a * v + a];
}

/* next[k] = hb (L_q + f), of unit vectors without what turns p out of the tangent space */
static void add_up(const dm_cells_split *s, const block *b, double hb, uint32_t i, uint32_t count) {
    const uint32_t m = s->m->sphere;
    const double *q = s->x + i, *p = s->state + s->m->n + i;
    for (uint32_t k = 0; k < count; k++) b->next[k] = hb * (s->force[i + k] + b->f[k]);
    for (uint32_t k = 0; m && k < count; k += m) {
        const double out =
            (dot(q + k, p + k, m) + dot(q + k, b->next + k, m)) / dot(q + k, q + k, m);
        for (uint32_t c = 0; c < m; c++) b->next[k + c] -= out * q[k + c];
    }
}

/* The kick that ends a step, p1 = p + hb (L_q + f(q, M^-1 p1, t)), by Newton's method cell by
 * cell; dp is left NaN where it finds nothing. */
static void find_kick(const dm_cells_split *s, const block *b, double hb, uint32_t i,
                      uint32_t count) {
    const uint32_t v = s->m->work->values;
    double last = INFINITY;
    memset(b->dp, 0, count * sizeof *b->dp);
    for (int pass = 0; pass < PASSES; pass++) {
        double step = 0.0, size = 0.0;
        set_rates(s, i, count, b->dp);
        dm_work_force(s->m->work, b->f, b->f_q, b->f_v, s->x, i, count, b->rest);
        add_up(s, b, hb, i, count);
        for (uint32_t k = 0; k < count; k += v) {
            for (uint32_t c = k; c < k + v; c++) b->next[c] -= b->dp[c];
            solve_cell(b->J, b->next + k, b->f_v + (size_t)k * v, s->m->inverse_mass + i + k, hb,
                       v);
        }
        for (uint32_t k = 0; k < count; k++) {
            b->dp[k] += b->next[k];
            step = fmax(step, fabs(b->next[k]));
            size = fmax(size, fabs(b->dp[k]) + fabs(s->state[s->m->n + i + k]));
            if (b->next[k] != b->next[k]) step = INFINITY;
        }
        if (step <= 4e-16 * size || (pass > 2 && step >= 0.5 * last && step <= 1e-12 * size))
            return;
        last = step;
    }
    for (uint32_t k = 0; k < count; k++) b->dp[k] = NAN;
}

/* Forces beside L of one block, which has new ones of L: those of q and t are added to them; where
 * they read v the kick that ends a step is made here, and what is left to begin the next. */
static void push(const dm_cells_split *s, move *v, uint32_t i, uint32_t count, double *scratch) {
    const block b = block_of(s, scratch);
    double *p = s->state + s->m->n + i, *low_p = p + 2 * (size_t)s->m->n;
    if (s->m->work->reads_v && v->kicks) {
        find_kick(s, &b, v->kick, i, count);
        for (uint32_t k = 0; k < count && !s->plain; k++) dm_sum_add(p + k, low_p + k, b.dp[k]);
        for (uint32_t k = 0; k < count && s->plain; k++) p[k] += b.dp[k];
        v->kicks = 0;
    }
    if (s->m->work->reads_v) set_rates(s, i, count, NULL);
    dm_work_force(s->m->work, b.f, NULL, NULL, s->x, i, count, b.rest);
    for (uint32_t k = 0; k < count; k++) s->force[i + k] += b.f[k];
}

/* the part of a thread, block by block: forces where new ones are there, then the move */
static void entries(const dm_cells_split *s, const move *given, int fresh, uint32_t part,
                    uint32_t parts) {
    const uint32_t n = s->m->n, m = s->m->sphere, unit = s->unit;
    const uint32_t blocks = (n + unit - 1) / unit;
    const uint32_t from = (uint32_t)((uint64_t)blocks * part / parts);
    const uint32_t to = (uint32_t)((uint64_t)blocks * (part + 1) / parts);
    for (uint32_t b = from; b < to; b++) {
        const uint32_t i = b * unit, count = n - i < unit ? n - i : unit;
        for (uint32_t k = i; fresh && k < i + count; k++)
            s->force[k] = dm_cells_entry(s->cells, s->slope, k);
        move v = *given;
        if (s->m->work && fresh) push(s, &v, i, count, s->scratch + part * s->room);
        if (m)
            move_on_spheres(s, &v, i, count);
        else if (s->plain)
            move_plainly(s, &v, i, count);
        else
            move_block(s, &v, i, count);
    }
}

/* ---- steps ---- */

/* Values without mass, no two of which meet in a cell: Newton's method for each, dL/dq_i = 0, and
 * slopes anew. One thread does it all, with the bits of one. */
static void eliminate(dm_cells_split *s) {
    const dm_model *m = s->m;
    const dm_sparse *A = &m->curvature->A;
    for (int pass = 0; pass < ELIMINATIONS; pass++) {
        double step = 0.0, size = 0.0;
        dm_curvature_at(m->curvature, s->factor, s->x);
        for (uint32_t i = 0; i < m->n; i++) {
            if (m->held[i] != DM_MASSLESS) continue;
            double own = 0.0;
            for (int32_t k = A->start[i]; k < A->start[i + 1]; k++)
                if (A->row[k] == (int32_t)i) own = A->value[k];
            const double change = -dm_cells_entry(s->cells, s->slope, i) / own;
            s->x[i] += change;
            step = fmax(step, fabs(change));
            size = fmax(size, fabs(s->x[i]));
            if (change != change) step = size = NAN;
        }
        dm_cells_slopes(s->cells, s->slope, s->factor, s->x, s->scratch, 0, 1);
        if (!(step > 4e-16 * size)) return;
    }
}

/* all slopes at the time t; everybody has moved his entries before */
static void slopes(dm_cells_split *s, double t, uint32_t part, uint32_t parts) {
    dm_team_meet(s->team);
    if (part == 0) {
        s->x[2 * (size_t)s->m->n] = t;
        s->factor = dm_loops_factors(&s->m->force, s->x);
    }
    dm_team_meet(s->team);
    dm_cells_slopes(s->cells, s->slope, s->factor, s->x, s->scratch + part * s->room, part, parts);
    dm_team_meet(s->team);
    if (!s->m->massless) return;
    if (part == 0) eliminate(s);
    dm_team_meet(s->team);
}

void dm_cells_split_settle(dm_cells_split *s, double *q, double t) {
    dm_team *team = s->team;
    if (!s->m->massless) return;
    s->team = NULL;
    memcpy(s->x, q, s->m->n * sizeof *q);
    slopes(s, t, 0, 1);
    memcpy(q, s->x, s->m->n * sizeof *q);
    s->team = team;
}

/* dm_team_work: all steps of the burst */
static void run(void *context, uint32_t part, uint32_t parts) {
    dm_cells_split *s = context;
    const dm_splitting *table = &s->table;
    const int kicks = table->b[0] != 0.0;
    const double h = s->h;
    const move first = {.begins = kicks, .begin = h * table->b[0], .drift = h * table->a[0]};
    if (kicks) slopes(s, s->t, part, parts);
    entries(s, &first, kicks, part, parts);
    for (long step = 0; step < s->count; step++) {
        const double now = s->t + (double)step * h;
        for (int k = 0; k < table->stages; k++) {
            const int last = k + 1 == table->stages;
            const int more = !last || step + 1 < s->count;
            const int fresh = table->b[k + 1] != 0.0 || (kicks && last);
            move v = {.kicks = table->b[k + 1] != 0.0, .kick = h * table->b[k + 1]};
            if (more) v.drift = h * table->a[last ? 0 : k + 1];
            if (more && last && kicks) v.begins = 1, v.begin = first.begin;
            if (fresh) slopes(s, now + s->c[k + 1] * h, part, parts);
            entries(s, &v, fresh, part, parts);
        }
    }
}

long dm_cells_split_run(dm_cells_split *s, double *state, double t, double h, long count) {
    const size_t bytes = s->m->n * sizeof *state;
    long forces = s->table.b[0] != 0.0;
    for (int k = 0; k < s->table.stages; k++)
        forces += (s->table.b[k + 1] != 0.0 || (forces && k + 1 == s->table.stages)) * count;
    memcpy(s->x, state, bytes);
    s->state = state;
    s->t = t;
    s->h = h;
    s->count = count;
    dm_team_run(s->team, run, s);
    memcpy(state, s->x, bytes);
    return forces;
}
