/* cells_split.c - a burst of steps: every thread goes through the same stages, and all meet before
 * entries are moved and before their forces are made anew. */
#include "base/doubles.h"
#include "integ/split/cells_split_inside.h"

#include "chain/cell_lists.h"
#include "chain/cell_ranges.h"
#include "chain/curvature.h"
#include "chain/loops.h"
#include "chain/team.h"
#include "chain/virtual_work.h"

#include <math.h>
#include <string.h>

/* entries at once: forces, then kicks and drifts; passes of Newton's method; steps that are made
 * again where one fails, at most */
enum { BLOCK = DM_CELL_BLOCK, ELIMINATIONS = 100, AGAIN = 32 };
/* of the largest value without mass: a change that is none, and one that no root is near to */
static const double SETTLED = 4e-16, FAR = 1e-8;

static size_t struct_size(void) {
    return dm_doubles(sizeof(struct dm_cells_split));
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

/* do forces depend on t? */
static int is_timed(const dm_model *m) {
    return !(m->structure & DM_AUTONOMOUS) || !dm_loops_constant(&m->force);
}

/* doubles of (q, v, t), which forces read; without t and v they read q in the state */
static size_t arguments_of(const dm_model *m) {
    return is_timed(m) || m->work ? 2 * (size_t)m->n + 1 : 0;
}

size_t dm_cells_split_work(const dm_model *m) {
    const dm_cells *cells = m->has & DM_WANT_FORCE ? dm_loops_cells(&m->force) : NULL;
    if (!(m->structure & DM_CELLS) || !cells) return 0;
    return struct_size() + dm_team_size() + arguments_of(m) + 5 * (size_t)m->n +
           DM_TEAM_MOST * room_of(m, cells) + 8;
}

int dm_cells_split_damps(const dm_splitting *table) {
    return table->stages == 1 && table->b[0] > 0.0 && table->b[1] > 0.0;
}

/* ranges of entries where few cells are at their borders, or lists; one thread without memory */
static void open_team(dm_cells_split *s, int threads, double *memory) {
    dm_arena *arena = s->m->source.arena;
    s->team = dm_team_open(memory, threads);
    s->ranges = dm_cell_ranges_make(s->cells, s->unit, dm_team_parts(s->team), arena);
    if (!s->ranges && dm_cell_lists_make(s->cells, arena) != DM_OK) dm_cells_split_close(s);
}

dm_cells_split *dm_cells_split_open(const dm_model *m, const dm_splitting *table, int plain,
                                    int threads, double *work) {
    dm_cells_split *s = (dm_cells_split *)(void *)work;
    if (!dm_cells_split_work(m)) return NULL;
    const dm_cells *cells = dm_loops_cells(&m->force);
    *s = (dm_cells_split){.m = m, .cells = cells, .table = *table, .plain = plain};
    s->room = room_of(m, cells);
    s->unit = unit_of(m);
    s->timed = is_timed(m);
    for (int k = 0; k < table->stages; k++) s->c[k + 1] = s->c[k] + table->a[k];
    s->c[table->stages] = 1.0;
    work += struct_size();
    if (threads > 1 && cells->shared && (!m->work || m->work->shared)) open_team(s, threads, work);
    const size_t arguments = arguments_of(m);
    s->own = arguments > 0;
    s->x = work + dm_team_size();
    s->force = s->x + arguments;
    s->kept = s->force + m->n;
    s->scratch = s->kept + 4 * (size_t)m->n;
    memset(s->x, 0, arguments * sizeof *s->x);
    return s;
}

void dm_cells_split_close(dm_cells_split *s) {
    if (s->team) dm_team_close(s->team);
    s->team = NULL;
}

/* ---- entries ---- */

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
static void move_on_spheres(const dm_cells_split *s, const dm_cells_move *v, uint32_t i,
                            uint32_t count) {
    const uint32_t n = s->m->n, m = s->m->sphere;
    for (uint32_t end = i + count; i < end; i += m) {
        double *q = s->x + i, *p = s->state + n + i;
        const double *force = s->force + i;
        if (v->kicks) {
            for (uint32_t k = 0; k < m; k++) p[k] += v->kick * force[k];
            const double out = dm_cells_dot(q, p, m) / dm_cells_dot(q, q, m);
            for (uint32_t k = 0; k < m; k++) p[k] -= out * q[k];
        }
        if (v->begins)
            for (uint32_t k = 0; k < m; k++) p[k] += v->begin * force[k];
        turn(q, p, v->drift * s->m->inverse_mass[i], m);
    }
}

/* The part of a thread, block by block. `fresh`: the forces of L are new ones. */
static void entries(const dm_cells_split *s, const dm_cells_move *given, int fresh, uint32_t part,
                    uint32_t parts) {
    uint32_t from, to;
    dm_cell_range(s->m->n, s->unit, part, parts, &from, &to);
    for (uint32_t i = from; i < to; i += s->unit) {
        const uint32_t count = to - i < s->unit ? to - i : s->unit;
        dm_cells_move v = *given;
        if (s->m->work && fresh) dm_cells_push(s, &v, i, count, s->scratch + part * s->room);
        if (s->m->sphere)
            move_on_spheres(s, &v, i, count);
        else
            dm_cells_move_block(s, &v, i, count);
    }
}

/* ---- steps ---- */

/* Newton's change of a value without mass, dL/dq_i = 0: 0 where L does not have it at all (no
 * slope, no second derivative) */
static double change_of(const dm_cells_split *s, uint32_t i) {
    const dm_sparse *A = &s->m->curvature->A;
    const double slope = s->force[i];
    double own = 0.0;
    for (int32_t k = A->start[i]; k < A->start[i + 1]; k++)
        if (A->row[k] == (int32_t)i) own = A->value[k];
    return slope == 0.0 && own == 0.0 ? 0.0 : -slope / own;
}

/* Are all changes within `bound` of the values? A NaN is not, and the value then takes it. */
static int are_within(const dm_cells_split *s, double bound) {
    double step = 0.0, size = 0.0;
    for (uint32_t i = 0; i < s->m->n; i++) {
        if (s->m->held[i] != DM_MASSLESS) continue;
        const double change = fabs(change_of(s, i));
        if (change != change) return 0;
        step = fmax(step, change);
        size = fmax(size, fabs(s->x[i]));
    }
    return step <= bound * size;
}

/* Are the equations of values without mass numbers? Not where the others have grown too large. */
static int are_numbers(const dm_cells_split *s) {
    double sum = 0.0; /* 0 * infinity is NaN */
    for (uint32_t i = 0; i < s->m->n; i++)
        if (s->m->held[i] == DM_MASSLESS) sum += 0.0 * s->force[i];
    return sum == 0.0;
}

/* Values without mass, no two of which meet in L, and forces anew; what is settled stays as it is,
 * so that a run that is cut here has the bits of a whole one. Where Newton's method finds no root
 * the values become NaN. One thread does it all, with the bits of one. */
static void eliminate(dm_cells_split *s) {
    const dm_model *m = s->m;
    const int passes = are_numbers(s) ? ELIMINATIONS : 1;
    s->lost = 0;
    for (int pass = 0; pass < passes; pass++) {
        dm_curvature_at(m->curvature, s->factor, s->x);
        if (are_within(s, SETTLED)) return;
        s->lost = pass + 1 == ELIMINATIONS && !are_within(s, FAR);
        for (uint32_t i = 0; i < m->n; i++)
            if (m->held[i] == DM_MASSLESS) s->x[i] = s->lost ? NAN : s->x[i] + change_of(s, i);
        dm_cells_gradient(s->cells, s->force, s->factor, s->x, s->scratch);
    }
}

static void set_time(dm_cells_split *s, double t) {
    if (s->own) s->x[2 * (size_t)s->m->n] = t;
}

/* positions that forces read are those of q[n] from here on, or a copy of them */
static void set_positions(dm_cells_split *s, double *q) {
    if (s->own)
        memcpy(s->x, q, s->m->n * sizeof *q);
    else
        s->x = q;
}

/* Forces of L at the time t, of the entries of a thread; everybody has moved his entries before,
 * and nobody moves them before all have their forces. */
static void forces_of(dm_cells_split *s, double t, uint32_t part, uint32_t parts) {
    double *scratch = s->scratch + part * s->room;
    uint32_t from, to;
    dm_team_meet(s->team);
    if (part == 0 && s->timed) {
        set_time(s, t);
        s->factor = dm_loops_factors(&s->m->force, s->x);
    }
    if (s->timed) dm_team_meet(s->team);
    if (s->team && s->ranges) {
        dm_cell_ranges_gradient(s->cells, s->ranges, s->force, s->factor, s->x, scratch, part);
        dm_team_meet(s->team);
    } else if (s->team) {
        dm_cell_lists_slopes(s->cells, s->factor, s->x, scratch, part, parts);
        dm_team_meet(s->team);
        dm_cell_range(s->m->n, s->unit, part, parts, &from, &to);
        dm_cell_lists_entries(s->cells, s->force, from, to);
    } else {
        dm_cells_gradient(s->cells, s->force, s->factor, s->x, scratch);
    }
    if (!s->m->massless) return;
    dm_team_meet(s->team);
    if (part == 0) eliminate(s);
    dm_team_meet(s->team);
}

dm_status dm_cells_split_settle(dm_cells_split *s, double *q, double t) {
    dm_team *team = s->team;
    if (!s->m->massless) return DM_OK;
    s->team = NULL;
    set_positions(s, q);
    set_time(s, t);
    s->factor = dm_loops_factors(&s->m->force, s->x);
    forces_of(s, t, 0, 1);
    if (s->own) memcpy(q, s->x, s->m->n * sizeof *q);
    s->team = team;
    return s->lost ? DM_NO_CONVERGENCE : DM_OK;
}

/* dm_team_work: all steps of the burst */
static void run(void *context, uint32_t part, uint32_t parts) {
    dm_cells_split *s = context;
    const dm_splitting *table = &s->table;
    const int kicks = table->b[0] != 0.0;
    const double h = s->h;
    const dm_cells_move first = {.begins = kicks,
                                 .begin = h * table->b[0],
                                 .drift = h * table->a[0]};
    if (kicks && !s->knows) forces_of(s, s->t, part, parts);
    entries(s, &first, kicks && !s->knows, part, parts);
    for (long step = 0; step < s->count; step++) {
        const double now = s->t + (double)step * h;
        for (int k = 0; k < table->stages; k++) {
            const int last = k + 1 == table->stages;
            const int more = !last || step + 1 < s->count;
            const int fresh = table->b[k + 1] != 0.0 || (kicks && last);
            dm_cells_move v = {.kicks = table->b[k + 1] != 0.0, .kick = h * table->b[k + 1]};
            if (more) v.drift = h * table->a[last ? 0 : k + 1];
            if (more && last && kicks) v.begins = 1, v.begin = first.begin;
            if (fresh) forces_of(s, now + s->c[k + 1] * h, part, parts);
            entries(s, &v, fresh, part, parts);
        }
    }
}

/* Forces that are known have the bits that making them anew would give, except where values
 * without mass follow them. Returns the number of forces. */
static long burst(dm_cells_split *s, double *state, double t, long count, int goes_on) {
    s->knows = goes_on && !s->timed && !s->m->massless;
    long forces = s->table.b[0] != 0.0;
    for (int k = 0; k < s->table.stages; k++)
        forces += (s->table.b[k + 1] != 0.0 || (forces && k + 1 == s->table.stages)) * count;
    if (!s->own || !s->knows) set_positions(s, state);
    set_time(s, t);
    s->factor = dm_loops_factors(&s->m->force, s->x);
    s->state = state;
    s->t = t;
    s->count = count;
    dm_team_run(s->team, run, s);
    if (s->own) memcpy(state, s->x, s->m->n * sizeof *state);
    return forces;
}

/* ---- failures ---- */

/* bytes of what steps change */
static size_t state_bytes(const dm_cells_split *s) {
    return (s->plain ? 2 : 4) * (size_t)s->m->n * sizeof(double);
}

static int is_finite(const dm_cells_split *s, const double *state) {
    const size_t size = state_bytes(s) / sizeof *state;
    double sum[2] = {0.0, 0.0}; /* 0 * infinity is NaN */
    for (size_t i = 0; i < size; i += 2) {
        sum[0] += 0.0 * state[i];
        sum[1] += 0.0 * state[i + 1];
    }
    return sum[0] + sum[1] == 0.0;
}

/* steps from the kept state, one by one, up to the one that fails, which is not taken; returns how
 * many */
static long find_failure(dm_cells_split *s, double *state, double t, long count) {
    long done = 0;
    memcpy(state, s->kept, state_bytes(s));
    while (done < count) {
        memcpy(s->kept, state, state_bytes(s));
        burst(s, state, t + (double)done * s->h, 1, 0);
        if (!is_finite(s, state)) break;
        done++;
    }
    memcpy(state, s->kept, state_bytes(s));
    return done;
}

/* What is not finite stays so, hence one look at the end of a burst. A copy of the state is kept
 * every few steps, since on large meshes a burst is one step, and a copy costs as much. */
dm_status dm_cells_split_run(dm_cells_split *s, double *state, double t, double h, long count,
                             int goes_on, long *done, long *forces) {
    if (!goes_on || s->timed || h != s->h || s->since + count > AGAIN) {
        memcpy(s->kept, state, state_bytes(s));
        s->since = 0;
    }
    s->h = h;
    *forces = burst(s, state, t, count, goes_on);
    *done = count;
    if (is_finite(s, state)) {
        s->since += count;
        return DM_OK;
    }
    const long since = s->since;
    *done = find_failure(s, state, t - (double)since * h, since + count) - since;
    s->since = AGAIN; /* the copy is another one now */
    return s->lost ? DM_NO_CONVERGENCE : DM_NOT_FINITE;
}
