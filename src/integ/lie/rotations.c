/* rotations.c - explicit splittings on groups for H = sum_a mu_a^2/(2 I_a) + V(g, t) with constant
 * moments I_a: the flow of each term mu_a^2/(2 I_a) is g exp(h mu_a/I_a e_a), with mu carried by
 * the coadjoint action, that of V a kick mu -= h X^T V_q. Of a rigid body these are three rotations
 * and a torque (Reich 1994; Dullweber, Leimkuhler & McLachlan 1997). The symmetric step of order 2
 * is composed to orders 4, 6, 8. */
#include "integ/rules/compositions/composition.h"
#include "mech/group.h"

#include <math.h>
#include <string.h>

extern const dm_method dm_method_suzuki, dm_method_kahan_li;

/* at the head of the workspace; the state in hand is q[n], mu[d] at `at` */
typedef struct {
    const dm_model *m;
    const dm_group *group;
    uint32_t n, d;
    dm_splitting table; /* its drifts are the gammas of the composition */
    double *x;          /* [2n + 1] (q, 0, t) */
    double *force;      /* [n] L_q, then */
    double *X;          /* [n*d] directions */
    double *torque;     /* [d] X^T L_q where the state in hand is */
    double *at;         /* [n + d] */
    double *in, *out;   /* [n + 2d], [n + d + arcs] of the end of a chart */
} layout;

/* the struct, in doubles */
static size_t head(void) {
    return (sizeof(layout) + sizeof(double) - 1) / sizeof(double);
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

/* On R^n it would be verlet. */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    if (!m->group) return "it steps systems on groups, such as dm.SO(3); verlet is for R^n";
    if (m->constraints) return "it knows no constraints and forces; lie(s) does";
    if (!(m->structure & DM_DIAGONAL_MASS) || !m->source.graph)
        return "it splits L = sum I_a xi_a^2/2 - V(g, t) with constant moments I_a along the axes; "
               "take lie(s) or gauss(s)";
    return NULL;
}

/* Directions come with the lift, the end of a turn with the chart of exp. */
static unsigned wants(const dm_rule *rule, const dm_model *m) {
    (void)rule, (void)m;
    return DM_WANT_FORCE | DM_WANT_LIFT | DM_WANT_CHART;
}

/* squares of angles behind the end of a chart */
static size_t arcs_of(const dm_group *g) {
    return g->trace[DM_TAU_EXP].arcs;
}

/* In the order of the struct. */
static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n, d = m->group->momenta;
    (void)rule;
    return head() + 2 * n + 1 + n + n * d + d + n + d + n + 2 * d + n + d + arcs_of(m->group);
}

/* Arrays one after the other; v of the force is zero. */
static dm_status open(dm_stepper *s) {
    layout *l = layout_of(s);
    const dm_model *m = s->model;
    const size_t n = m->n, d = m->group->momenta;
    memset(s->work, 0, work(s->rule, m) * sizeof *s->work);
    *l = (layout){.m = m, .group = m->group, .n = m->n, .d = m->group->momenta};
    find_table(&l->table, s->rule);
    l->x = s->work + head();
    l->force = l->x + 2 * n + 1;
    l->X = l->force + n;
    l->torque = l->X + n * d;
    l->at = l->torque + d;
    l->in = l->at + n + d;
    l->out = l->in + n + 2 * d;
    dm_kernel_prepare(&m->force, l->force);
    dm_kernel_prepare(&m->group->directions, l->X);
    dm_kernel_prepare(&m->group->finish, l->out);
    return DM_OK;
}

/* X^T L_q at the element in hand */
static void find_torque(layout *l, double t) {
    const size_t n = l->n, d = l->d;
    memcpy(l->x, l->at, n * sizeof *l->x);
    l->x[2 * n] = t;
    dm_kernel_eval(&l->m->force, l->x, l->force);
    dm_kernel_eval(&l->group->directions, l->x, l->X);
    memset(l->torque, 0, d * sizeof *l->torque);
    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < d; a++) l->torque[a] += l->X[i * d + a] * l->force[i];
}

/* mu += h X^T L_q */
static void kick(layout *l, double h) {
    for (size_t a = 0; a < l->d; a++) l->at[l->n + a] += h * l->torque[a];
}

/* the flow of mu_a^2/(2 I_a) */
static void turn(layout *l, size_t a, double h) {
    const size_t n = l->n, d = l->d;
    memcpy(l->in, l->at, n * sizeof *l->in);
    memset(l->in + n, 0, d * sizeof *l->in);
    l->in[n + a] = h * l->m->inverse_mass[a] * l->at[n + a];
    memcpy(l->in + n + d, l->at + n, d * sizeof *l->in);
    dm_kernel_eval(&l->group->finish, l->in, l->out);
    memcpy(l->at, l->out, (n + d) * sizeof *l->at);
}

/* kick, half turns about all axes but the last, a whole one about that, and back */
static void symmetric_step(layout *l, double t, double h) {
    const size_t d = l->d;
    kick(l, 0.5 * h);
    for (size_t a = 0; a + 1 < d; a++) turn(l, a, 0.5 * h);
    turn(l, d - 1, h);
    for (size_t a = d - 1; a-- > 0;) turn(l, a, 0.5 * h);
    find_torque(l, t + h);
    kick(l, 0.5 * h);
}

/* An element is no sum: there are no low-order parts. */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = layout_of(s);
    const size_t n = l->n, d = l->d;
    double bad = 0.0;
    memcpy(l->at, state, (n + d) * sizeof *state);
    find_torque(l, t);
    for (int k = 0; k < l->table.stages; k++) {
        symmetric_step(l, t, l->table.a[k] * h);
        t += l->table.a[k] * h;
    }
    s->report.evaluations += l->table.stages + 1;
    for (size_t i = 0; i < n + d; i++) bad += 0.0 * l->at[i];
    if (bad != 0.0) return DM_NOT_FINITE;
    memcpy(state, l->at, (n + d) * sizeof *state);
    memset(state + 2 * n, 0, 2 * n * sizeof *state);
    return DM_OK;
}

static const dm_engine engine = {
    .fits = fits,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
};

const dm_method dm_method_rotations = {
    .name = "rotations",
    .signature = "rotations[(k)]",
    .doc = "Explicit splitting of order k = 2, 4, 6, 8 on groups for L = sum I_a xi_a^2/2 - V(g, "
           "t) with constant moments along the axes: of a rigid body three rotations and a torque "
           "(Reich 1994; Dullweber, Leimkuhler & McLachlan 1997), composed after Suzuki (4), Kahan "
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
