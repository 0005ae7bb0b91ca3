/* rattle_cells.c - kick, turn, kick on every cell (Leimkuhler & Skeel 1994), by the loops of
 * integ/split/cells_split.h. */
#include "integ/constrained/rattle_cells.h"

#include "integ/split/cells_split.h"

/* workspace: this, the loops */
typedef struct {
    dm_cells_split *cells;
} layout;

static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (m->sphere && m->inverse_mass) return NULL;
    return "on fields it is for values on a sphere (on = dm.S(m)); take verlet";
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FORCE;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return 1 + dm_cells_split_work(m);
}

static dm_status open(dm_stepper *s) {
    static const double one = 1.0;
    layout *l = (layout *)(void *)s->work;
    dm_splitting table = {0};
    dm_splitting_compose(&table, &one, 1);
    l->cells = dm_cells_split_open(s->model, &table, 1, s->threads, s->work + 1);
    s->report.plain = 1; /* on the sphere to round-off after every step: no low parts */
    return l->cells ? DM_OK : DM_NO_MEMORY;
}

/* A step that is too long for a sphere leaves NaN. */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    const layout *l = (const layout *)(const void *)s->work;
    long forces;
    const dm_status status =
        dm_cells_split_run(l->cells, state, t, h, count, s->goes_on, done, &forces);
    s->report.evaluations += forces;
    s->goes_on = 0;
    return status;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    long done;
    return advance(s, state, t, h, 1, &done);
}

/* Threads end. */
static void close(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    if (l->cells) dm_cells_split_close(l->cells);
    l->cells = NULL;
}

const dm_engine dm_engine_rattle_cells = {
    .spheres = 1,
    .works = 1,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .advance = advance,
    .close = close,
};
