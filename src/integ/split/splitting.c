#include "integ/split/splitting.h"

#include "base/doubles.h"
#include "chain/loops.h"
#include "chain/team.h"
#include "integ/split/cells_split.h"
#include "integ/split/chain.h"
#include "integ/split/splitting_loop.h"
#include "numbers/compensated.h"

#include <string.h>

/* workspace: this, then x = (q, v, t, parameters), force[n], kicked[n], the state at the start
 * of a burst, what the loop needs; a field on a mesh has its own */
typedef struct {
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    dm_splitting_loop *loop;           /* NULL: none */
    dm_chain *chain;                   /* NULL: no loops along arrays */
    dm_cells_split *cells;             /* NULL: no field on a mesh */
    dm_team *team;                     /* for sums over pairs; NULL: one thread */
} layout;

int dm_splitting_fits(const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    return (m->structure & simple) == simple && m->inverse_mass && !m->constraints && !m->sphere;
}

/* The row tells with its arguments, the model with its structure. */
int dm_splitting_steps(const dm_rule *rule, const dm_model *m) {
    const dm_method *method = rule->method;
    return dm_splitting_fits(m) && method->splitting && method->splitting(NULL, rule);
}

/* Kick, drift, kick of every step: the kick between two steps is half of both. */
void dm_splitting_compose(dm_splitting *out, const double *gamma, int s) {
    out->stages = s;
    for (int k = 0; k <= s; k++) {
        const double before = k > 0 ? gamma[k - 1] : 0.0, after = k < s ? gamma[k] : 0.0;
        out->b[k] = 0.5 * (before + after);
        if (k < s) out->a[k] = gamma[k];
    }
}

/* The struct at the head of the workspace, in doubles. */
static size_t layout_size(void) {
    return dm_doubles(sizeof(layout));
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    dm_splitting table;
    if (dm_splitting_steps(rule, m)) {
        rule->method->splitting(&table, rule);
        if (!(m->worked & DM_WORKED_BY_RATES) || dm_cells_split_damps(&table)) return NULL;
        return "the field has forces of the rate V (friction, absorbing), and it has kicks inside "
               "of a step or back in time, where they would feed the waves; take verlet, midpoint "
               "or gauss(s)";
    }
    return "it makes kicks and drifts, which need a separable L = T(v) - V(q) with constant mass; "
           "compose an implicit rule instead, for instance kahan-li(6, midpoint), or take gauss(3)";
}

/* A force; velocities come from the constant mass. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return DM_WANT_FORCE | (m->massless ? DM_WANT_CURVATURE : 0u);
}

/* Either kind of loop behind what plain C needs. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    const size_t cells = m->structure & DM_CELLS ? dm_cells_split_work(m) : 0;
    if (cells) return layout_size() + cells;
    const size_t loops = m->structure & DM_CELLS   ? 0
                         : m->structure & DM_LOOPS ? dm_chain_work(m)
                                                   : dm_splitting_loop_work(m);
    const size_t room = layout_size() + 4 * (size_t)m->n + 1 + m->params + dm_state_size(m->n);
    return room + (m->structure & DM_LOOPS ? dm_team_size() : 0) + loops;
}

/* Behind x, force, kicked and the state at the start. */
static double *team_work(const dm_stepper *s) {
    const uint32_t n = s->model->n;
    return s->work + layout_size() + 4 * (size_t)n + 1 + s->model->params + dm_state_size(n);
}

static double *loop_work(const dm_stepper *s) {
    return team_work(s) + (s->model->structure & DM_LOOPS ? dm_team_size() : 0);
}

/* forces a step: one for every kick but the first, which has that of the end of the step before,
 * also where no kick is there */
static uint32_t evaluations(const dm_splitting *table) {
    const int drifts = table->b[0] == 0.0 && table->b[table->stages] == 0.0;
    return (uint32_t)(table->stages - drifts);
}

/* A loop makes the force where it kicks, so that kick, drift needs no drift of length zero before
 * it, by which other roads have the force of the end of the step before. */
static dm_splitting for_loop(const dm_splitting *table) {
    dm_splitting out = *table;
    if (table->b[0] != 0.0 || table->a[0] != 0.0) return out;
    out.stages--;
    memmove(out.b, table->b + 1, sizeof out.b - sizeof *out.b);
    memmove(out.a, table->a + 1, sizeof out.a - sizeof *out.a);
    return out;
}

/* times of kicks */
static void set_times(layout *l) {
    for (int k = 0; k < l->table.stages; k++) l->c[k + 1] = l->c[k] + l->table.a[k];
    l->c[l->table.stages] = 1.0;
}

/* The loop of the table, which is then the one that it goes by. */
static void open_loop(layout *l, const dm_stepper *s) {
    const dm_splitting table = for_loop(&l->table);
    l->loop = dm_splitting_loop_open(s->model, &table, s->plain);
    if (!l->loop) return;
    l->table = table;
    set_times(l);
}

static dm_status open(dm_stepper *s) {
    const dm_model *m = s->model;
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.loop = NULL};
    s->rule->method->splitting(&l->table, s->rule);
    const dm_splitting *table = &l->table;
    set_times(l);
    /* without them the loop below serves */
    if (m->structure & DM_CELLS)
        l->cells = dm_cells_split_open(m, table, s->plain, s->threads, s->work + layout_size());
    else if (m->structure & DM_LOOPS)
        l->chain = dm_chain_open(m, table, s->plain, loop_work(s));
    else
        open_loop(l, s);
    if (m->structure & DM_LOOPS && !l->cells && !l->chain && s->threads > 1 &&
        dm_loops_lend(&m->force, NULL))
        l->team = dm_team_open(team_work(s), s->threads);
    s->report.plain = s->plain && (l->loop || l->chain || l->cells);
    return DM_OK;
}

static int widen(dm_stepper *s, dm_lanes *x) {
    layout *l = (layout *)(void *)s->work;
    return l->loop && dm_splitting_loop_widen(l->loop, s->model, x);
}

/* p += h b F, with compensation. */
static inline void kick(uint32_t n, double *p, double *low, double hb, const double *force) {
    for (uint32_t i = 0; i < n; i++) dm_sum_add(p + i, low + i, hb * force[i]);
}

/* The kick that begins a step, with the force that ended the last one: p + hb force is what the
 * first drift sees; p itself gets it with the next kick, by way of the low part, so that the drift
 * does not wait for two sums. */
static inline void begin(uint32_t n, double *kicked, double *p, double hb, const double *force) {
    double *low = p + 2 * n; /* behind p in the state */
    for (uint32_t i = 0; i < n; i++) {
        kicked[i] = p[i] + hb * force[i];
        low[i] += hb * force[i];
    }
}

/* q += h a M^-1 (p - shift) */
static inline void drift(const dm_model *m, double *q, double *low, double ha, const double *p) {
    const uint32_t n = m->n;
    const double *w = m->inverse_mass, *shift = m->momentum_shift;
    if (m->structure & DM_DIAGONAL_MASS) {
        for (uint32_t i = 0; i < n; i++) dm_sum_add(q + i, low + i, (ha * w[i]) * p[i]);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        double v = 0.0;
        for (uint32_t j = 0; j < n; j++) v += w[i * n + j] * (p[j] - shift[j]);
        dm_sum_add(q + i, low + i, ha * v);
    }
}

/* What a call of a loop is told. */
static dm_splitting_burst burst_of(const dm_stepper *s, double t, double h, long count) {
    const layout *l = (const layout *)(const void *)s->work;
    return (dm_splitting_burst){.table = &l->table,
                                .c = l->c,
                                .h = h,
                                .t = t,
                                .count = count,
                                .many = s->model->params,
                                .params = s->params};
}

/* count steps with no look at what comes out */
static void run(dm_stepper *s, double *state, double t, double h, long count) {
    const dm_model *m = s->model;
    const uint32_t n = m->n;
    layout *l = (layout *)(void *)s->work;
    if (l->loop) {
        const dm_splitting_burst burst = burst_of(s, t, h, count);
        dm_splitting_loop_run(l->loop, m, state, &burst, loop_work(s));
        s->report.evaluations += 1 + count * evaluations(&l->table);
        return;
    }
    const dm_splitting *table = &l->table;
    double *x = s->work + layout_size(), *force = x + 2 * n + 1 + m->params, *kicked = force + n;
    double *p = state + n, *low_q = state + 2 * n, *low_p = state + 3 * n;
    memcpy(x, state, n * sizeof *x);
    x[2 * n] = t;
    if (m->params) memcpy(x + 2 * n + 1, s->params, m->params * sizeof *x);
    dm_kernel_prepare(&m->force, force);
    if (l->team) dm_loops_lend(&m->force, l->team);
    if (table->b[0] != 0.0) dm_kernel_eval(&m->force, x, force);
    for (long step = 0; step < count; step++) {
        const double now = t + (double)step * h;
        const int kicks = table->b[0] != 0.0;
        if (kicks) begin(n, kicked, p, h * table->b[0], force);
        for (int k = 0; k < table->stages; k++) {
            drift(m, x, low_q, h * table->a[k], kicks && k == 0 ? kicked : p);
            x[2 * n] = now + l->c[k + 1] * h;
            if (table->b[k + 1] == 0.0 && (!kicks || k + 1 < table->stages)) continue;
            dm_kernel_eval(&m->force, x, force);
            kick(n, p, low_p, h * table->b[k + 1], force);
        }
    }
    if (l->team) dm_loops_lend(&m->force, NULL);
    memcpy(state, x, n * sizeof *x);
    s->report.evaluations += (table->b[0] != 0.0) + count * evaluations(table);
}

/* up to a step that fails */
static dm_status run_cells(dm_stepper *s, double *state, double t, double h, long count,
                           long *done) {
    const layout *l = (const layout *)(const void *)s->work;
    long forces;
    const dm_status status =
        dm_cells_split_run(l->cells, state, t, h, count, s->goes_on, done, &forces);
    s->goes_on = 0;
    s->report.evaluations += forces;
    return status;
}

/* all steps, or the state as it was */
static int run_chain(dm_stepper *s, double *state, double t, double h, long count) {
    const layout *l = (const layout *)(const void *)s->work;
    const dm_chain_burst burst = {h, t, count, s->goes_on};
    const long forces = dm_chain_run(l->chain, state, &burst);
    s->goes_on = 0;
    s->report.evaluations += forces;
    return forces > 0;
}

/* what is not finite stays so, hence one look at the end; then the burst is done again to find
 * the step */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    const uint32_t n = s->model->n;
    const size_t bytes = dm_state_size(n) * sizeof *state;
    double *start = s->work + layout_size() + 4 * (size_t)n + 1 + s->model->params;
    if (((const layout *)(const void *)s->work)->cells)
        return run_cells(s, state, t, h, count, done);
    *done = count;
    if (((const layout *)(const void *)s->work)->chain) {
        if (run_chain(s, state, t, h, count)) return DM_OK;
    } else {
        memcpy(start, state, bytes);
        run(s, state, t, h, count);
        if (dm_state_is_finite(state, n)) return DM_OK;
        memcpy(state, start, bytes);
    }
    *done = 0;
    return count > 1 ? dm_advance_by_step(s, state, t, h, count, done) : DM_NOT_FINITE;
}

/* Without steps of their own: *h is that of all. */
static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    const layout *l = (const layout *)(const void *)s->work;
    const dm_splitting_burst burst = burst_of(s, t, *h, count);
    dm_splitting_loop_run_lanes(l->loop, s->model, x, &burst, loop_work(s));
}

/* A burst of one, which looks at its end. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    long done;
    return advance(s, state, t, h, 1, &done);
}

/* Values without mass are what the others make of them. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    const layout *l = (const layout *)(const void *)s->work;
    (void)h;
    return l->cells ? dm_cells_split_settle(l->cells, state, t) : DM_OK;
}

static const char *why(dm_stepper *s, const double *state, dm_status status) {
    (void)state;
    return s->model->massless && status == DM_NO_CONVERGENCE
               ? "Newton's method finds no root of the equation dL/dA = 0 of a value without mass: "
                 "has L a value of it at which it is stationary, and does the start lie near to it?"
               : NULL;
}

/* Threads end. */
static void close(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    if (l->cells) dm_cells_split_close(l->cells);
    if (l->team) dm_team_close(l->team);
    l->cells = NULL;
    l->team = NULL;
}

const dm_engine dm_engine_splitting = {
    .works = 1,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .advance = advance,
    .widen = widen,
    .advance_lanes = advance_lanes,
    .why = why,
    .close = close,
};
