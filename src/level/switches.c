/* switches.c - where a level set may be narrow, told by the operations of its graph. */
#include "level/switches.h"

#include "graph/analyse.h"

#include <math.h>
#include <string.h>

enum { AIMS = 16 };
static const double WIDE = 5, BACK = 0.4, PART = 0.6, /* of a change at a switch: a step */
    BEYOND = 1.02,                                    /* of the way to a break: just behind it */
    PASSED = 8,  /* |u| beyond which tanh and exp(-u) are flat */
    CLOSE = 0.3, /* |u| that is aimed at, */
    EDGE = 0.03; /* of an edge: so much of what it is */

/* ---- the graph ---- */

/* the operand of an operation that makes it a switch; 0: it is none */
static dm_node operand(dm_graph *g, const dm_expr *e, dm_switch *kind) {
    double power;
    switch (e->op) {
    case DM_OP_EXP:
    case DM_OP_TANH:
    case DM_OP_ATAN:
    case DM_OP_SINH:
    case DM_OP_COSH:
    case DM_OP_ASIN:
    case DM_OP_ACOS:
        *kind = DM_BENDS;
        return e->as.arg[0];
    case DM_OP_SIN:
    case DM_OP_COS:
    case DM_OP_TAN:
        *kind = DM_TURNS;
        return e->as.arg[0];
    case DM_OP_SQRT:
    case DM_OP_RSQRT:
    case DM_OP_RSQRT3:
    case DM_OP_LOG:
        *kind = DM_DIVIDES;
        return e->as.arg[0];
    case DM_OP_DIV:
        *kind = DM_DIVIDES;
        return e->as.arg[1];
    case DM_OP_POW:
        *kind = DM_DIVIDES;
        if (dm_is_constant(g, e->as.arg[1], &power) && power > 0 && power == floor(power)) return 0;
        return e->as.arg[0];
    case DM_OP_ATAN2:
        *kind = DM_DIVIDES;
        return dm_add(g, dm_mul(g, e->as.arg[0], e->as.arg[0]),
                      dm_mul(g, e->as.arg[1], e->as.arg[1]));
    default:
        *kind = DM_BREAKS;
        return dm_break_of(g, e);
    }
}

uint32_t dm_switches_find(dm_graph *g, dm_node *of, dm_switch *kind) {
    const uint32_t size = dm_graph_size(g);
    uint32_t count = 0;
    for (dm_node i = 1; i < size && count < DM_SWITCHES; i++) {
        const dm_expr e = *dm_graph_at(g, i);
        double constant;
        dm_switch what = DM_BENDS;
        const dm_node u = operand(g, &e, &what);
        int known = !u || dm_is_constant(g, u, &constant);
        for (uint32_t j = 0; j < count; j++) known |= of[j] == u && kind[j] == what;
        if (!known) of[count] = u, kind[count++] = what;
    }
    return count;
}

/* ---- how long steps may be ---- */

/* by how much u may change at a switch of that kind */
static double scale(dm_switch kind, double u) {
    switch (kind) {
    case DM_BENDS:
        return fmax(1, fabs(u) / 2);
    case DM_TURNS:
        return 1;
    case DM_DIVIDES:
        return fabs(u) / 2;
    default:
        return INFINITY;
    }
}

static double dot(const double *a, const double *b, uint32_t n) {
    double sum = 0;
    for (uint32_t k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

static const double *slope_of(const dm_level *l, uint32_t j) {
    return l->slope + (size_t)(l->c + j) * l->n;
}

/* the part of it that switch j allows */
static double reach(const dm_level *l, uint32_t j, double rate) {
    const double u = l->u[j];
    const int leaves = u * rate > 0;
    if (!isfinite(u) || !isfinite(rate) || rate == 0) return INFINITY;
    if (l->kind[j] == DM_BREAKS) return leaves || u == 0 ? INFINITY : BEYOND * fabs(u / rate);
    if (l->kind[j] == DM_TURNS || l->kind[j] == DM_EDGES) return INFINITY;
    if (l->kind[j] == DM_BENDS && leaves && fabs(u) > PASSED) return INFINITY;
    return PART * scale(l->kind[j], u) / fabs(rate);
}

double dm_level_reach(const dm_level *l, const double *v, double *breaks) {
    double most[2] = {INFINITY, INFINITY};
    for (uint32_t j = 0; j < l->s; j++) {
        const int is_break = l->kind[j] == DM_BREAKS;
        most[is_break] = fmin(most[is_break], reach(l, j, dot(slope_of(l, j), v, l->n)));
    }
    *breaks = most[1];
    return most[0];
}

double dm_level_width(dm_level *l, uint32_t j, double *across) {
    const double *slope = slope_of(l, j);
    memcpy(across, slope, l->n * sizeof *across);
    for (uint32_t k = 0; k < l->n; k++)
        if (!isfinite(across[k])) return INFINITY;
    if (!dm_level_turn(l, across, 0)) return INFINITY;
    const double width = scale(l->kind[j], l->u[j]) / fabs(dot(slope, across, l->n));
    return width > 0 ? width : INFINITY;
}

/* ---- towards switches ---- */

/* what is aimed at from here */
static void set_goals(dm_level *l, const uint32_t *which, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t j = which[i];
        const int is_edge = l->kind[j] == DM_EDGES;
        l->goal[j] = is_edge ? EDGE * l->u[j] : 0;
        l->unit[j] = is_edge && l->u[j] != 0 ? fabs(l->u[j]) : 1;
    }
}

/* how far the worst of them is off, NAN where one is not finite */
static double off_by(const dm_level *l, const uint32_t *which, uint32_t count) {
    double most = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t j = which[i];
        const double off = fabs(l->u[j] - l->goal[j]) / l->unit[j];
        if (!(off <= most)) most = off;
    }
    return isfinite(most) ? most : NAN;
}

/* Newton's step to F = 1 and the goals in l->change; its length */
static double step_towards(dm_level *l, const uint32_t *which, uint32_t count) {
    const size_t n = l->n, c = l->c;
    memcpy(l->rows, l->slope, c * n * sizeof *l->rows);
    for (uint32_t i = 0; i < count; i++)
        memcpy(l->rows + (c + i) * n, slope_of(l, which[i]), n * sizeof *l->rows);
    for (uint32_t i = 0; i < l->c; i++) l->y[i] = l->value[i] - 1;
    for (uint32_t i = 0; i < count; i++) l->y[c + i] = l->u[which[i]] - l->goal[which[i]];
    return dm_level_normal_step(l, l->rows, l->c + count);
}

/* are these close enough? Of those that break or divide nothing is known but the zero */
static int is_close(const dm_level *l, const uint32_t *which, uint32_t count, double off) {
    double most = CLOSE;
    for (uint32_t i = 0; i < count; i++) {
        const dm_switch kind = l->kind[which[i]];
        most = kind == DM_BENDS ? most : kind == DM_EDGES ? fmin(most, EDGE / 2) : 0;
    }
    return off < most;
}

/* x = 0.4 of the way from the best one */
static void go_back(const dm_level *l, double *x) {
    for (uint32_t k = 0; k < l->n; k++) x[k] = l->best[k] + BACK * (x[k] - l->best[k]);
}

/* Newton's steps, each brought to the level set and shortened until it comes closer. A u that has
 * its zero where its slope is zero too, as that of exp(-x^2), becomes a quarter by every step:
 * twice the step then. */
int dm_level_aim(dm_level *l, double *x, const uint32_t *which, uint32_t count) {
    const uint32_t n = l->n;
    double least = INFINITY, factor = 1, size = 1;
    int better = -1;
    for (int i = 0; i < AIMS; i++) {
        const int is = dm_level_bring(l, x, WIDE * size) && dm_level_look(l, x);
        if (is && better < 0) set_goals(l, which, count);
        const double off = is ? off_by(l, which, count) : NAN, ratio = off / least;
        if (better < 0 && !(off < INFINITY)) return 0;
        if (!(off < least)) {
            go_back(l, x);
            continue;
        }
        least = off, better++;
        memcpy(l->best, x, n * sizeof *x);
        if (is_close(l, which, count, off)) break;
        const double length = step_towards(l, which, count);
        if (!(length < INFINITY)) break;
        size = fmax(sqrt(dot(x, x, n)), 0.1);
        factor = ratio > 0.2 && ratio < 0.3 && factor == 1 ? 2 : 1;
        const double part = fmin(factor, size / length);
        for (uint32_t k = 0; k < n; k++) x[k] -= part * l->change[k];
    }
    memcpy(x, l->best, n * sizeof *x);
    return better > 0;
}
