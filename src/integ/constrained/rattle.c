/* rattle.c - RATTLE and SHAKE: the loop around the kernels of rattle_kernels.c. */
#include "integ/constrained/rattle.h"
#include "base/doubles.h"
#include "base/written_out.h"
#include "integ/constrained/constrained.h"
#include "integ/constrained/rattle_cells.h"
#include "linalg/solve/newton.h"
#include "linalg/solve/newton_limits.h"
#include "mech/crossing.h"

#include <math.h>
#include <string.h>

/* relative changes: of q1 at the last iteration; that may stall; that is foreseen for one more,
 * of the tolerance */
static const double STALLED = 1e-12, NEGLIGIBLE = 2.5e-3;

/* workspace: this, memory, two buffers of a step, one for an iteration, the last change of y */
typedef struct {
    dm_rattle_layout at;
    dm_rattle_kernels kernel;
    double *memory, *now, *next, *iterate, *change;
    double *weight, *crossing; /* of mech/crossing.h: [n], room */
    dm_crossing_watch watch;
    int begun; /* iterations that the first kernel makes: 0 where nothing is solved for */
    int looks; /* for places where constraints cross */
} layout;

/* memory: h of the last step (0: there is none), which may be a part of a composition, the volume
 * of its rows and one to compare with (mech/crossing.h), its mu[m], the squares[m] that rows of G
 * had at the start; and behind the norms of a step */
enum { LAST, VOLUME, WATCHED, MU };
enum { VOLUME_OF_NORMS = 3, LEAST_OF_NORMS };

static size_t memory_size(const dm_rattle_layout *at) {
    return MU + 2 * (size_t)at->m;
}

/* In doubles, so that what follows is aligned. */
static size_t layout_size(void) {
    return dm_doubles(sizeof(layout));
}

static layout *layout_of(const dm_stepper *s) {
    return (layout *)(void *)s->work;
}

/* The kick is explicit and M constant: only the multipliers are unknown (and v, where a force sees
 * it). */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    (void)rule;
    if (m->structure & DM_LOOPS)
        return "it writes its steps out, which dm.sum_over with so many rounds is not meant for; "
               "take verlet";
    if ((m->structure & simple) != simple || !m->inverse_mass)
        return "it needs L = T(v) - V(q, t) with a constant mass; for any other L take a rule that "
               "solves for the multipliers in every stage, for instance midpoint or lobatto(3), or "
               "lie(1) on a group";
    if (!m->source.graph) return "it needs L as an expression, not on hyper-dual numbers";
    if (m->constraints && m->constraints->controls)
        return "it knows no controls; take midpoint or gauss";
    return NULL;
}

/* Its kernels are its own but for what steps that may cross a singular place are looked into by. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->constraints && m->constraints->holonomic ? DM_WANT_HOLONOMIC : 0;
}

/* The kernels read and write whole buffers, three of them. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const dm_rattle_layout at = dm_rattle_lay_out(m);
    const size_t crossing = at.m ? at.n + dm_crossing_work(m->constraints) : 0;
    (void)rule;
    return layout_size() + memory_size(&at) + 3 * (size_t)at.size + at.n + crossing;
}

/* what never varies stays in the buffers */
static void prepare(layout *l) {
    double *buffers[] = {l->now, l->next};
    for (int i = 0; i < 2; i++) {
        dm_kernel_prepare(&l->kernel.end, buffers[i]);
        dm_kernel_prepare(&l->kernel.first, buffers[i] + l->at.y);
        dm_kernel_prepare(&l->kernel.begin, buffers[i] + l->at.force);
    }
    dm_kernel_prepare(&l->kernel.newton, l->iterate);
}

static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    *l = (layout){.at = dm_rattle_lay_out(s->model)};
    l->begun = l->at.m || l->at.drags ? 2 : 0;
    l->memory = s->work + layout_size();
    l->now = l->memory + memory_size(&l->at);
    l->next = l->now + l->at.size;
    l->iterate = l->next + l->at.size;
    l->change = l->iterate + l->at.size;
    l->weight = l->change + l->at.n;
    l->crossing = l->weight + l->at.n;
    const int diagonal = (s->model->structure & DM_DIAGONAL_MASS) != 0;
    const dm_crossing_mass mass = {s->model->mass_matrix, l->at.n, diagonal ? 0 : l->at.n};
    l->looks = l->at.m && dm_crossing_weights(l->weight, &mass, s->model->constraints->prolonged);
    memset(l->memory, 0, memory_size(&l->at) * sizeof *l->memory); /* a step before any start */
    const int shake = (s->rule->method->traits & DM_LOOSE_MOMENTUM) != 0;
    const dm_status status = dm_rattle_build(&l->kernel, s->model, shake);
    if (status != DM_OK) return status;
    s->report.operations = l->kernel.first.operations + l->kernel.end.operations;
    prepare(l);
    return DM_OK;
}

/* No mu is known, whatever the length of the steps. */
static dm_status start(dm_stepper *s, double *state, double t, double h) {
    layout *l = layout_of(s);
    (void)state, (void)t, (void)h;
    memset(l->memory, 0, memory_size(&l->at) * sizeof *l->memory);
    return DM_OK;
}

static size_t memory(dm_stepper *s, double **place) {
    *place = layout_of(s)->memory;
    return memory_size(&layout_of(s)->at);
}

/* lambda of the last step, which is in the buffer it began in, and mu; of SHAKE the next lambda
 * does all */
static void impulses(const dm_stepper *s, double *out) {
    const layout *l = layout_of(s);
    const uint32_t m = l->at.m;
    const int shake = (s->rule->method->traits & DM_LOOSE_MOMENTUM) != 0;
    for (uint32_t i = 0; i < m; i++) {
        out[i] = l->next[l->at.lambda + i];
        out[m + i] = shake ? 0.0 : l->now[l->at.guess + i];
    }
}

/* ---- a step ---- */

/* The squares of the last two changes and of a size of q1 say that it is known to round-off: the
 * last change is, or what Newton's method, being quadratic, would change next. */
DM_WRITTEN_OUT int is_known(const dm_stepper *s, const double *norms, double size) {
    const double before = norms[0], now = norms[1];
    const double tolerance = s->tolerance * s->tolerance * size;
    if (now <= tolerance) return 1;
    if (now < before && now * now * now <= NEGLIGIBLE * NEGLIGIBLE * tolerance * before * before)
        return 1;
    return now >= before && now <= STALLED * STALLED * size;
}

/* one iteration more; what it changes y by */
static void iterate_once(dm_stepper *s, layout *l) {
    const size_t n = l->at.n, count = n + l->at.m + DM_RATTLE_NORMS;
    double *y = l->now + l->at.y;
    dm_kernel_eval(&l->kernel.newton, l->now, l->iterate);
    for (size_t c = 0; c < n; c++) l->change[c] = l->iterate[c] - y[c];
    memcpy(y, l->iterate, count * sizeof *y);
    s->report.iterations++;
}

DM_WRITTEN_OUT int is_last(const dm_stepper *s, const double *norms) {
    return is_known(s, norms, norms[2]);
}

/* further iterations, where two were not enough */
static dm_status iterate(dm_stepper *s, layout *l, const double *norms) {
    while (!is_last(s, norms)) {
        if (s->report.iterations >= s->max_iterations) return DM_NO_CONVERGENCE;
        iterate_once(s, l);
        if (!isfinite(norms[1] + norms[2])) return DM_NO_CONVERGENCE;
    }
    return DM_OK;
}

/* Is some coordinate much smaller than the largest, not zero, and not known yet? Mostly not, as the
 * least |y| says. Speed: instructions, rattle. */
static int has_small_ones(const dm_stepper *s, const layout *l) {
    const double *q = l->now, *y = q + l->at.y, *norms = q + l->at.norms;
    const double near = norms[LEAST_OF_NORMS];
    double least = norms[2];
    if (near * near * 0x1p19 > least) return 0;
    for (uint32_t c = 0; c < l->at.n; c++) {
        const double own = q[c] * q[c] + y[c] * y[c];
        least = own < least && own > 0.0 ? own : least;
    }
    return least * 0x1p20 < norms[2] && !is_known(s, norms, least);
}

/* And on, until each of them is. */
static void iterate_small_ones(dm_stepper *s, layout *l, double h) {
    const uint32_t n = l->at.n;
    const double *y = l->now + l->at.y;
    const dm_newton_problem judge = {.m = n,
                                     .place = l->now,
                                     .places = n,
                                     .over = l->at.drags ? h : DM_NEWTON_BESIDE, /* v; q */
                                     .tolerance = s->tolerance};
    dm_newton_wait wait = {0};
    do {
        iterate_once(s, l);
    } while (!dm_newton_small_settled(&wait, &judge, y, l->change) &&
             s->report.iterations < s->max_iterations);
}

/* The largest |g| so far, for the report. */
static inline void look_at_constraint(dm_stepper *s, const layout *l, const double *g) {
    double largest = s->report.constraint;
    for (const double *end = g + l->at.m; g < end; g++)
        if (fabs(*g) > largest) largest = fabs(*g);
    s->report.constraint = largest;
}

/* A volume, in a buffer; masses may have values of both signs. */
static double volume_of(const layout *l, const double *buffer) {
    return fabs(buffer[l->at.norms + VOLUME_OF_NORMS]);
}

/* Does the step that was made go over a place where constraints cross? `last`: of the one before */
static dm_status look_for_crossing(dm_stepper *s, layout *l, double last) {
    const double *x = l->now;
    const dm_crossing_way way = {x, l->next, l->weight, x[l->at.t0], x[l->at.t], NULL};
    dm_crossing_place place;
    if (!l->looks || !dm_crossing_suspects(&l->watch, last, volume_of(l, x))) return DM_OK;
    if (!dm_crossing_between(s->model->constraints, &way, &place, l->crossing)) return DM_OK;
    s->report.trouble = (dm_trouble){.dependent = (int)place.row, .crosses = 1, .at = place.t};
    return DM_SINGULAR;
}

/* from l->now, which is left as it was where this fails, to l->next; then they change places */
static dm_status step_once(dm_stepper *s, layout *l, double t, double h) {
    double *x = l->now, *norms = x + l->at.norms;
    x[l->at.t0] = t;
    x[l->at.t] = t + h;
    dm_kernel_eval(&l->kernel.first, x, x + l->at.y);
    s->report.iterations = l->begun;
    if (l->begun && !is_last(s, norms)) {
        const dm_status status = iterate(s, l, norms);
        s->report.residual = sqrt(norms[1]);
        if (status != DM_OK) return status;
    }
    if (l->begun && has_small_ones(s, l)) iterate_small_ones(s, l, h);
    dm_kernel_eval(&l->kernel.end, x, l->next);
    if (!dm_crossing_is_far(&l->watch, volume_of(l, x))) {
        const dm_status status = look_for_crossing(s, l, volume_of(l, l->next));
        if (status != DM_OK) return status;
    }
    look_at_constraint(s, l, l->next + l->at.g);
    s->report.newton += s->report.iterations;
    s->report.evaluations++;
    l->now = l->next;
    l->next = x;
    return DM_OK;
}

/* Of the rows of G at the start, in the units of the masses: volumes begin near one, however many
 * rows there are. */
static void find_squares(const dm_stepper *s, layout *l) {
    const double *G = l->now + l->at.G;
    const uint8_t *touches = s->model->constraints->touches;
    for (uint32_t c = 0; c < l->at.m; c++) {
        double sum = 0.0;
        for (uint32_t i = 0; i < l->at.n; i++)
            if (*touches++) sum += *G * *G * l->weight[i], G++;
        l->memory[MU + l->at.m + c] = l->looks && sum > 0.0 && isfinite(sum) ? sum : 1.0;
    }
}

/* mu of the last step is a guess for this one, in proportion to their lengths */
static void load(const dm_stepper *s, const double *state, double t, double h) {
    layout *l = layout_of(s);
    const dm_rattle_layout *at = &l->at;
    l->now[at->h] = l->next[at->h] = h;
    l->now[at->half] = l->next[at->half] = 0.5 * h;
    memcpy(l->now, state, 4 * (size_t)at->n * sizeof *state);
    l->now[at->t] = t;
    dm_kernel_eval(&l->kernel.begin, l->now, l->now + at->force);
    const double last = l->memory[LAST];
    const double part = last == h ? 1.0 : last == 0.0 ? 0.0 : h / last;
    if (last == 0.0 && at->m) find_squares(s, l);
    l->next[at->norms + VOLUME_OF_NORMS] = l->memory[VOLUME];
    dm_crossing_expect(&l->watch, l->memory[WATCHED]);
    for (uint32_t i = 0; i < at->m; i++) {
        l->now[at->guess + i] = part * l->memory[MU + i];
        l->now[at->unit + i] = l->next[at->unit + i] = 1.0 / (h * l->memory[MU + at->m + i]);
    }
}

/* For the next step, of whatever length: mu is an impulse. */
static void remember(layout *l, double h) {
    l->memory[LAST] = h;
    l->memory[VOLUME] = volume_of(l, l->next);
    l->memory[WATCHED] = l->watch.volume;
    memcpy(l->memory + MU, l->now + l->at.guess, l->at.m * sizeof *l->memory);
}

/* What is not finite stays so, hence one look at the end of a burst. */
static int is_finite(const layout *l) {
    for (uint32_t i = 0; i < 4 * l->at.n; i++)
        if (!isfinite(l->now[i])) return 0;
    return 1;
}

/* State, forces and rows stay in the buffers during a burst; the state is written when it has ended
 * well. */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    layout *l = layout_of(s);
    const dm_rattle_layout *at = &l->at;
    dm_status status = DM_OK;
    load(s, state, t, h);
    long made = 0;
    while (made < count && (status = step_once(s, l, t + (double)made * h, h)) == DM_OK) made++;
    *done = made;
    /* one look at the end of a burst; then the burst is done again to find the step and stop
     * before it */
    if (!is_finite(l)) {
        *done = 0;
        return count > 1 ? dm_advance_by_step(s, state, t, h, count, done) : DM_NOT_FINITE;
    }
    memcpy(state, l->now, 4 * (size_t)at->n * sizeof *state);
    remember(l, h);
    return status;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    long done;
    return advance(s, state, t, h, 1, &done);
}

/* A mass that is singular by itself leaves a Lagrangian that is not separable: RATTLE is then the
 * Lobatto IIIA-IIIB pair of 2 stages with constraints (HLW VII.1.4, (1.26)). */
static const dm_engine *choose(const dm_rule *rule, const dm_model *m);

static const dm_engine engine = {
    .choose = choose,
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .advance = advance,
    .memory = memory,
    .impulses = impulses,
};

static const dm_engine *choose(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (m->structure & DM_CELLS) return &dm_engine_rattle_cells;
    return m->structure & DM_SADDLE ? &dm_engine_constrained : &engine;
}

/* Lobatto nodes are both ends. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    (void)rule;
    dm_quadrature_lobatto(&q, 2);
    dm_galerkin_collocation(g, &q);
}

const dm_method dm_method_rattle = {
    .name = "rattle",
    .signature = "rattle",
    .doc = "RATTLE, order 2: Stoermer-Verlet on the constraints g(q, t) = 0, for L = T(v) - V(q, "
           "t) with constant mass and forces f(q, t); Newton for as many unknowns as there are "
           "constraints (cost linear in them where each touches its neighbours only), and the "
           "hidden constraint projected once a step. The base of compositions: yoshida(4, rattle), "
           "kahan-li(8, rattle). Andersen 1983; HLW VII.1.4.",
    .orders = "2",
    .stages = "2",
    .cost = "2 n unknowns and multipliers, or eliminated",
    .instances = "",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_HOLONOMIC | DM_FORCED,
    .engine = &engine,
    .basis = basis,
};

const dm_method dm_method_shake = {
    .name = "shake",
    .signature = "shake",
    .doc = "SHAKE, order 2: the positions of rattle without the projection of momenta, whose part "
           "across the constraint is left to the next step: the velocities of rows err like h "
           "across it (along it, and energies, like h^2), and a start from q and p takes any p. "
           "Ryckaert, Ciccotti & Berendsen 1977; HLW VII.1.4.",
    .orders = "2",
    .stages = "2",
    .cost = "2 n unknowns and multipliers, or eliminated",
    .instances = "",
    .traits = DM_SYMPLECTIC | DM_HOLONOMIC | DM_FORCED | DM_LOOSE_MOMENTUM,
    .engine = &engine,
    .basis = basis,
};
