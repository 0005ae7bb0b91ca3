/* rotations.c - explicit splittings on groups for H = sum_a mu_a^2/(2 I_a) + V(g, t) with constant
 * moments I_a: the flow of each term mu_a^2/(2 I_a) is g exp(h mu_a/I_a e_a), with mu carried by
 * the coadjoint action, that of V a kick mu -= h X^T V_q. Of a rigid body these are three rotations
 * and a torque (Reich 1994; Dullweber, Leimkuhler & McLachlan 1997). Axes that commute may be
 * coupled, as those of R^m, or each with its own of the tangent group, whose step is the tangent
 * of a step. The symmetric step of order 2 is composed to orders 4, 6, 8. */
#include "base/doubles.h"
#include "code/native/jit.h"
#include "integ/lie/turns.h"
#include "integ/method/lanes.h"
#include "integ/rules/compositions/composition.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

extern const dm_method dm_method_suzuki, dm_method_kahan_li;

/* A state, or members of a group of lanes: what the kernels of turns.h read and write, entries of
 * so many lanes each. after[n + d + 2] is (q, mu) after the turns, then w and t of the kick, whose
 * results lie behind q in before[n + 2d + 2], where the next step finds them. Where the turns are
 * gains, so is what the kick gives, and (q, mu) are sums with low-order parts. */
typedef struct {
    double *before, *after;
    double *mu, *low; /* [d]; [n + d] */
} room;

/* at the head of the workspace, behind it the room of one state */
typedef struct {
    uint32_t n, d;
    int timed;          /* L depends on t */
    int sums;           /* turns are gains */
    dm_splitting table; /* its drifts are the gammas of the composition */
    dm_turns one, wide; /* kernels for a state, and for lanes of members */
    room alone, group[DM_LANES_GROUPS];
} layout;

/* the struct, in doubles */
static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

static layout *layout_of(const dm_stepper *s) {
    return (layout *)(void *)s->work;
}

/* 2 where none is given */
static int order(const dm_rule *rule) {
    return rule->count ? (int)rule->arg[0].number : 2;
}

/* It is an order, no number of stages. */
static const char *check(const dm_rule *rule) {
    const double k = rule->count ? rule->arg[0].number : 2;
    if (rule->count > 1 || (rule->count && rule->arg[0].rule) ||
        (k != 2 && k != 4 && k != 6 && k != 8))
        return "rotations takes its order, 2, 4, 6 or 8";
    return NULL;
}

/* gammas: one step, Suzuki's five, Kahan and Li's nine and seventeen */
static void find_table(dm_splitting *out, const dm_rule *rule) {
    static const double one = 1.0;
    dm_rule composition = {.count = 1};
    composition.arg[0].number = order(rule);
    composition.method = order(rule) == 4 ? &dm_method_suzuki : &dm_method_kahan_li;
    if (order(rule) == 2)
        dm_splitting_compose(out, &one, 1);
    else
        dm_composition_splitting(out, &composition);
}

/* p = M v + shift */
static int is_shifted(const dm_model *m) {
    double most = 0.0;
    for (uint32_t a = 0; m->momentum_shift && a < m->group->momenta; a++)
        most = fmax(most, fabs(m->momentum_shift[a]));
    return most > 0.0;
}

/* On R^n it would be verlet. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_CONSTANT_MASS | DM_SEPARABLE;
    (void)rule;
    if (!m->group) return "it steps systems on groups, such as dm.SO(3); verlet is for R^n";
    if (m->constraints) return "it knows no constraints and forces; lie(s) does";
    if ((m->structure & simple) != simple || !m->source.graph || is_shifted(m) ||
        !dm_turns_split(m))
        return "it splits L = sum I_a xi_a^2/2 - V(g, t) with constant moments I_a along the axes "
               "(coupled where they commute); take lie(s) or gauss(s)";
    return NULL;
}

/* Its kernels are made of L and the traces of the group. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return 0;
}

/* doubles of a room of one lane */
static size_t room_size(const dm_model *m) {
    return (size_t)dm_turns_inputs(m) + dm_turns_kick_inputs(m) + m->n + 2 * (size_t)dm_momenta(m);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return head() + room_size(m);
}

/* constant results of the kick lie behind q */
static void lay_room(room *r, const dm_model *m, const dm_turns *k, uint32_t lanes, double *at) {
    memset(at, 0, room_size(m) * lanes * sizeof *at);
    r->before = at;
    r->after = at + (size_t)dm_turns_inputs(m) * lanes;
    r->mu = r->after + (size_t)dm_turns_kick_inputs(m) * lanes;
    r->low = r->mu + (size_t)dm_momenta(m) * lanes;
    dm_kernel_prepare_lanes(&k->turns, lanes, r->after);
    dm_kernel_prepare_lanes(&k->kick, lanes, r->before + (size_t)m->n * lanes);
}

static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    const dm_model *m = s->model;
    *l = (layout){.n = m->n, .d = m->group->momenta};
    l->timed = !(m->structure & DM_AUTONOMOUS);
    l->sums = dm_turns_sum(m);
    find_table(&l->table, s->rule);
    if (!dm_turns_find(&l->one, m, 1)) return DM_NO_MEMORY;
    lay_room(&l->alone, m, &l->one, 1, s->work + head());
    s->report.operations = l->one.turns.operations + l->one.kick.operations;
    return DM_OK;
}

/* ---- steps ---- */

/* high += x in as many entries, and x becomes the sum */
static void sum_up(double *high, double *low, double *x, size_t count) {
    for (size_t i = 0; i < count; i++) {
        dm_sum_add(high + i, low + i, x[i]);
        x[i] = high[i];
    }
}

/* one stage of length a h of all lanes from t on: turns, then the torque at its end and a kick
 * there; w and h are written for every lane */
static void stage(const layout *l, const dm_turns *k, const room *r, uint32_t lanes, double t,
                  const double *h, double a) {
    double *const w = r->before + (size_t)(l->n + 2 * l->d) * lanes, *const length = w + lanes;
    double *const kick = r->after + (size_t)(l->n + l->d) * lanes, *const time = kick + lanes;
    for (uint32_t i = 0; i < lanes; i++) {
        length[i] = a * h[i];
        w[i] = kick[i] = 0.5 * length[i];
        time[i] = t + length[i];
    }
    const size_t n = (size_t)l->n * lanes, d = (size_t)l->d * lanes;
    dm_kernel_eval(&k->turns, r->before, r->after);
    if (l->sums)
        sum_up(r->before, r->low, r->after, n);
    else
        memcpy(r->before, r->after, n * sizeof *r->before);
    dm_kernel_eval(&k->kick, r->after, r->before + n);
    if (l->sums) sum_up(r->mu, r->low + n, r->before + n, d);
}

/* the torque at t, where the state in hand is behind the turns */
static void find_torque(const layout *l, const dm_turns *k, const room *r, uint32_t lanes,
                        double t) {
    double *const w = r->after + (size_t)(l->n + l->d) * lanes;
    for (uint32_t i = 0; i < lanes; i++) {
        w[i] = 0.0;
        w[lanes + i] = t;
    }
    dm_kernel_eval(&k->kick, r->after, r->before + (size_t)l->n * lanes);
}

/* the state into the room, with the torque there */
static void enter(const layout *l, const dm_turns *k, const room *r, uint32_t lanes, double t,
                  const double *state) {
    const size_t n = (size_t)l->n * lanes, d = (size_t)l->d * lanes;
    memcpy(r->after, state, (n + d) * sizeof *state);
    memcpy(r->before, state, n * sizeof *state);
    memcpy(r->mu, state + n, d * sizeof *state);
    memcpy(r->low, state + 2 * n, n * sizeof *state);
    memcpy(r->low + n, state + 3 * n, d * sizeof *state);
    find_torque(l, k, r, lanes, t);
}

/* And back; an element that is no sum has no low-order parts. */
static void leave(const layout *l, const room *r, uint32_t lanes, double *state) {
    const size_t n = (size_t)l->n * lanes, d = (size_t)l->d * lanes;
    memcpy(state, r->before, (n + d) * sizeof *state);
    memset(state + 2 * n, 0, 2 * n * sizeof *state);
    if (!l->sums) return;
    memcpy(state + 2 * n, r->low, n * sizeof *state);
    memcpy(state + 3 * n, r->low + n, d * sizeof *state);
}

/* all stages of step k of a burst; its start has the torque of the end before, at a time that may
 * be rounded otherwise */
static void walk(const layout *l, const dm_turns *kernels, const room *r, uint32_t lanes, double t,
                 const double *h, long k) {
    const size_t n = (size_t)l->n * lanes, d = (size_t)l->d * lanes;
    t += (double)k * h[0];
    if (k > 0 && l->timed) {
        memcpy(r->after + n, r->before + n, d * sizeof *r->after);
        find_torque(l, kernels, r, lanes, t);
    }
    for (int j = 0; j < l->table.stages; j++) {
        stage(l, kernels, r, lanes, t, h, l->table.a[j]);
        t += l->table.a[j] * h[0];
    }
}

/* The torque at the end of a step is that at the start of the next. */
static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    layout *l = layout_of(s);
    const room *r = &l->alone;
    const size_t all = l->n + l->d;
    double bad = 0.0;
    enter(l, &l->one, r, 1, t, state);
    for (long k = 0; k < count; k++) walk(l, &l->one, r, 1, t, &h, k);
    s->report.evaluations += count * l->table.stages + 1;
    for (size_t i = 0; i < all; i++) bad += 0.0 * r->before[i];
    *done = count;
    if (bad == 0.0) {
        leave(l, r, 1, state);
        return DM_OK;
    }
    *done = 0;
    if (count == 1) return DM_NOT_FINITE;
    return dm_advance_by_step(s, state, t, h, count, done);
}

/* A burst of one. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    long done;
    return advance(s, state, t, h, 1, &done);
}

/* ---- members side by side ---- */

/* Kernels for lanes are those of the model's last ensemble. */
static int widen(dm_stepper *s, dm_lanes *x) {
    layout *l = layout_of(s);
    const dm_model *m = s->model;
    if (m->params || !dm_lanes_open(x, m, (uint32_t)(dm_state_size(m->n) + room_size(m))) ||
        !dm_turns_find(&l->wide, m, x->lanes))
        return 0;
    const size_t one = room_size(m) * x->lanes;
    double *at = dm_arena_take(m->source.arena, x->groups * one * sizeof *at);
    if (!at) return 0;
    for (uint32_t i = 0; i < x->groups; i++)
        lay_room(l->group + i, m, &l->wide, x->lanes, at + i * one);
    x->paced = 1;
    return 1;
}

/* Groups take turns, so that none waits for itself. */
static void advance_lanes(dm_stepper *s, dm_lanes *x, double t, const double *h, long count) {
    layout *l = layout_of(s);
    const size_t size = dm_state_size(l->n) * x->lanes;
    for (uint32_t i = 0; i < x->groups; i++)
        enter(l, &l->wide, l->group + i, x->lanes, t, x->state + i * size);
    for (long k = 0; k < count; k++)
        for (uint32_t i = 0; i < x->groups; i++)
            walk(l, &l->wide, l->group + i, x->lanes, t, h + i * x->lanes, k);
    for (uint32_t i = 0; i < x->groups; i++) leave(l, l->group + i, x->lanes, x->state + i * size);
}

static const dm_engine engine = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
    .advance = advance,
    .widen = widen,
    .advance_lanes = advance_lanes,
};

const dm_method dm_method_rotations = {
    .name = "rotations",
    .signature = "rotations[(k)]",
    .doc = "Explicit splitting of order k = 2, 4, 6, 8 on groups for L = sum I_a xi_a^2/2 - V(g, "
           "t) with constant moments along the axes, coupled only where these commute: of a rigid "
           "body "
           "three rotations and a torque (Reich 1994; Dullweber, Leimkuhler & McLachlan 1997), "
           "composed after Suzuki (4), Kahan "
           "and Li (6, 8). Symplectic, keeps momentum maps.",
    .orders = "2, 4, 6, 8",
    .stages = "1, 5, 9, 17",
    .cost = "2, 6, 10, 18 torques, 2 dim G - 1 turns a stage",
    .instances = "",
    .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_EXPLICIT | DM_ON_GROUPS,
    .check = check,
    .order = order,
    .engine = &engine,
};
