/* turns.c - the graphs of a splitting step on a group. Joined from the traces of the chart: g0
 * tau(xi) with xi along one axis is most of it zeros, which vanish as the nodes are made. */
#include "integ/lie/turns.h"

#include "algebra/derive.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"

#include <string.h>

/* what is worked on while the graphs are made */
typedef struct {
    const dm_model *m;
    const dm_chart_trace *trace;
    dm_graph *g;
    uint32_t n, d;
    dm_node *with; /* [n + 3d] what stands for the inputs of a trace */
    dm_node *out;  /* [n + d + arcs] */
    dm_node *gain; /* [n + d] of (q, mu) so far; NULL: nobody asked */
    dm_node *rest; /* [d] what rounding left of the kick, turned with mu, where there are gains */
} writing;

/* nodes in the arena of the model */
static dm_node *take(const writing *x, size_t count) {
    return dm_arena_take(x->m->source.arena, (count + 1) * sizeof(dm_node));
}

/* A new graph, and room for the arguments and results of a trace; 0: no memory. */
static int begin(writing *x, const dm_model *m, uint32_t inputs) {
    *x = (writing){.m = m, .n = m->n, .d = dm_momenta(m)};
    x->trace = m->group->trace + DM_TAU_EXP;
    x->g = dm_graph_new(m->source.arena, inputs);
    x->with = take(x, x->n + 3 * (size_t)x->d);
    x->out = take(x, x->n + x->d + (size_t)x->trace->arcs);
    return x->trace->chart && x->g && x->with && x->out;
}

/* (q, mu) becomes that at g0 exp(xi), xi along axis a */
static void turn_by_chart(writing *x, dm_node *q, dm_node *mu, uint32_t a, dm_node xi) {
    const uint32_t n = x->n, d = x->d;
    memset(x->with, 0, (n + 3 * (size_t)d) * sizeof *x->with);
    x->with[n + a] = xi;
    memcpy(x->with + n + d, mu, d * sizeof *mu);
    dm_transplant(x->g, x->trace->end, x->trace->carried + n, d, x->with, mu);
    memcpy(x->with, q, n * sizeof *q);
    memset(x->with + n, 0, 3 * (size_t)d * sizeof *x->with);
    x->with[n + d + a] = xi;
    dm_transplant(x->g, x->trace->chart, x->trace->place, n, x->with, q);
}

/* The rest of the kick is turned, as a turn is linear in mu. Unseen by turns it has a mean
 * where h is a ratio of small numbers, and J drifts: "top rotations(2)" of
 * tests/bench/dm/long_runs.lua. */
static void turn_rest(writing *x, uint32_t a, dm_node xi) {
    const uint32_t n = x->n, d = x->d;
    memset(x->with, 0, n * sizeof *x->with);
    memcpy(x->with + n, x->rest, d * sizeof *x->rest);
    x->with[n + d] = xi;
    dm_transplant(x->g, x->trace->axes, x->trace->turned + a * ((size_t)n + d) + n, d, x->with,
                  x->out);
    for (uint32_t i = 0; i < d; i++) {
        x->rest[i] = dm_add(x->g, x->rest[i], x->out[i]);
        x->gain[n + i] = dm_add(x->g, x->gain[n + i], x->out[i]);
    }
}

/* (q, mu) becomes that at q exp(x e_a) */
static void turn_axis(writing *x, dm_node *q, dm_node *mu, uint32_t a, dm_node xi) {
    const uint32_t n = x->n, d = x->d;
    if (!x->trace->axes) {
        turn_by_chart(x, q, mu, a, xi);
        return;
    }
    memcpy(x->with, q, n * sizeof *q);
    memcpy(x->with + n, mu, d * sizeof *mu);
    x->with[n + d] = xi;
    dm_transplant(x->g, x->trace->axes, x->trace->turned + a * ((size_t)n + d), n + d, x->with,
                  x->out);
    for (uint32_t i = 0; i < n + d; i++) {
        dm_node *const to = i < n ? q + i : mu + i - n;
        *to = dm_add(x->g, *to, x->out[i]);
        if (x->gain) x->gain[i] = dm_add(x->g, x->gain[i], x->out[i]);
    }
    if (x->gain) turn_rest(x, a, xi);
}

/* entry of the inertia or of its inverse, as the model has them */
static double entry(const dm_model *m, const double *matrix, uint32_t a, uint32_t b) {
    if (m->structure & DM_DIAGONAL_MASS) return a == b ? matrix[a] : 0.0;
    return matrix[(size_t)a * m->n + b];
}

/* block[d]: the first axis of those that the inertia couples to each axis */
static void find_blocks(uint32_t *block, const dm_model *m) {
    const uint32_t d = dm_momenta(m);
    for (uint32_t a = 0; a < d; a++) block[a] = a;
    for (uint32_t a = 0; a < d; a++)
        for (uint32_t b = 0; b < a; b++) {
            const uint32_t one = block[a], other = block[b], first = one < other ? one : other;
            if (one == other || entry(m, m->mass_matrix, a, b) == 0.0) continue;
            for (uint32_t c = 0; c <= a; c++)
                if (block[c] == one || block[c] == other) block[c] = first;
        }
}

/* xi_a/h of the velocities (inertia)^-1 mu */
static dm_node rate_of(writing *x, const dm_node *mu, const uint32_t *block, uint32_t a) {
    dm_node rate = 0;
    for (uint32_t b = 0; b < x->d; b++) {
        if (block[b] != block[a]) continue;
        const dm_node w = dm_constant(x->g, entry(x->m, x->m->inverse_mass, a, b));
        rate = dm_add(x->g, rate, dm_mul(x->g, w, mu[b]));
    }
    return rate;
}

/* (q, mu) after the flow of length h of the kinetic energy of one block, whose axes commute and
 * whose momenta therefore stay: q exp(xi), mu carried there */
static void turn(writing *x, dm_node *q, dm_node *mu, const uint32_t *block, uint32_t first,
                 dm_node h) {
    for (uint32_t a = first; a < x->d; a++)
        if (block[a] == first) turn_axis(x, q, mu, a, dm_mul(x->g, h, rate_of(x, mu, block, a)));
}

/* coordinates nearer to the group by what rounding left, as at the end of a chart at xi = 0 */
static void tidy(writing *x, dm_node *q) {
    memset(x->with, 0, (x->n + 3 * (size_t)x->d) * sizeof *x->with);
    memcpy(x->with, q, x->n * sizeof *q);
    dm_transplant(x->g, x->trace->end, x->trace->carried, x->n, x->with, q);
}

/* the same as a gain, of the coordinates that a step begins with */
static void mend(writing *x) {
    const uint32_t n = x->n, d = x->d;
    memset(x->with, 0, (n + 3 * (size_t)d) * sizeof *x->with);
    dm_inputs(x->g, x->with, 0, n);
    dm_transplant(x->g, x->trace->axes, x->trace->turned + d * ((size_t)n + d), n, x->with, x->out);
    for (uint32_t i = 0; i < n; i++) x->gain[i] = dm_add(x->g, x->gain[i], x->out[i]);
}

/* half turns of all blocks but the last, a whole one of that, and back */
static void turn_all(writing *x, dm_node *q, dm_node *mu, const uint32_t *block, dm_node h) {
    const dm_node half = dm_mul(x->g, dm_constant(x->g, 0.5), h);
    uint32_t last = 0;
    for (uint32_t a = 0; a < x->d; a++)
        if (block[a] == a) last = a;
    for (uint32_t a = 0; a < last; a++)
        if (block[a] == a) turn(x, q, mu, block, a, half);
    turn(x, q, mu, block, last, h);
    for (uint32_t a = last; a-- > 0;)
        if (block[a] == a) turn(x, q, mu, block, a, half);
}

static uint32_t build_turns(dm_kernel *out, const dm_model *m, uint32_t lanes) {
    writing x;
    if (!begin(&x, m, dm_turns_inputs(m))) return 0;
    const uint32_t n = x.n, d = x.d;
    dm_node *q = take(&x, n + 2 * (size_t)d), *mu = q + n, *gain = take(&x, n + (size_t)d);
    uint32_t *block = take(&x, d);
    if (!q || !block || !gain) return 0;
    dm_inputs(x.g, q, 0, n + 2 * d);
    memset(gain, 0, (n + (size_t)d) * sizeof *gain);
    const dm_node w = dm_input(x.g, n + 2 * d), h = dm_input(x.g, n + 2 * d + 1);
    for (uint32_t a = 0; a < d; a++) {
        const dm_node torque = q[n + d + a], before = mu[a];
        gain[n + a] = dm_mul(x.g, w, torque);
        mu[a] = dm_multiply_add(x.g, w, torque, before);
        const dm_node seen = dm_sub(x.g, mu[a], before);
        q[n + d + a] = dm_multiply_add(x.g, w, torque, dm_neg(x.g, seen)); /* the rest */
    }
    if (dm_turns_sum(m)) x.gain = gain, x.rest = mu + d;
    find_blocks(block, m);
    turn_all(&x, q, mu, block, h);
    x.gain ? mend(&x) : tidy(&x, q);
    return dm_lanes_build(out, m, x.g, x.gain ? gain : q, n + d, lanes);
}

/* does a turn about axis a leave the momenta of its block as they are? So do all turns by which
 * they do not begin to move. */
static int commutes(writing *x, const uint32_t *block, uint32_t a) {
    const uint32_t n = x->n, d = x->d;
    dm_node *q = take(x, n + (size_t)d), *mu = q + n, rate, begins;
    dm_node *at = take(x, dm_turns_inputs(x->m));
    dm_graph *still = dm_graph_new(x->m->source.arena, n + d);
    if (!q || !at || !still) return 0;
    dm_inputs(x->g, q, 0, n + d);
    memset(at, 0, dm_turns_inputs(x->m) * sizeof *at);
    dm_inputs(still, at, 0, n + d);
    turn_axis(x, q, mu, a, dm_input(x->g, n + d));
    for (uint32_t b = 0; b < d; b++) {
        if (block[b] != block[a]) continue;
        dm_gradient(x->g, mu[b], n + d, 1, &rate);
        dm_transplant(still, x->g, &rate, 1, at, &begins);
        if (begins != 0) return 0;
    }
    return dm_graph_status(still) == DM_OK;
}

int dm_turns_split(const dm_model *m) {
    writing x;
    if (m->structure & DM_DIAGONAL_MASS) return 1;
    if (!m->inverse_mass || !begin(&x, m, dm_turns_inputs(m))) return 0;
    uint32_t *block = take(&x, x.d);
    if (!block) return 0;
    find_blocks(block, m);
    for (uint32_t a = 0; a < x.d; a++)
        if (!commutes(&x, block, a)) return 0;
    return dm_graph_status(x.g) == DM_OK;
}

/* -V_e(q near(e), t) at e = 0, in a graph of its own with e in place of mu */
static int find_torque(writing *x, dm_node *torque, const dm_node *inputs, dm_node t) {
    writing about;
    const dm_source *s = &x->m->source;
    const uint32_t n = x->n, d = x->d, many = dm_graph_inputs(s->graph);
    if (!begin(&about, x->m, n + d + 1)) return 0;
    dm_node *with = take(x, (size_t)many + 2 * n + 1), L;
    if (!with) return 0;
    memset(about.with, 0, (n + 3 * (size_t)d) * sizeof *about.with);
    dm_inputs(about.g, about.with, 0, n + d);
    dm_transplant(about.g, about.trace->chart, about.trace->place, n, about.with, about.out);
    memset(with, 0, ((size_t)many + 2 * n + 1) * sizeof *with);
    memcpy(with, about.out, n * sizeof *with);
    with[2 * n] = dm_input(about.g, n + d);
    dm_transplant(about.g, s->graph, &s->lagrangian, 1, with, &L);
    dm_gradient(about.g, L, n, d, about.out);
    memcpy(with, inputs, n * sizeof *with);
    memset(with + n, 0, d * sizeof *with);
    with[n + d] = t;
    dm_transplant(x->g, about.g, about.out, d, with, torque);
    return dm_graph_status(about.g) == DM_OK;
}

static uint32_t build_kick(dm_kernel *out, const dm_model *m, uint32_t lanes) {
    writing x;
    if (!begin(&x, m, dm_turns_kick_inputs(m))) return 0;
    const uint32_t n = x.n, d = x.d;
    dm_node *q = take(&x, n + d), *roots = take(&x, 2 * (size_t)d);
    if (!q || !roots) return 0;
    dm_inputs(x.g, q, 0, n + d);
    const dm_node w = dm_input(x.g, n + d), t = dm_input(x.g, n + d + 1);
    if (!find_torque(&x, roots + d, q, t)) return 0;
    for (uint32_t a = 0; a < d; a++) roots[a] = dm_add(x.g, q[n + a], dm_mul(x.g, w, roots[d + a]));
    return dm_lanes_build(out, m, x.g, roots, 2 * d, lanes);
}

int dm_turns_find(dm_turns *out, const dm_model *m, uint32_t lanes) {
    static const char maker, kicker;
    if (dm_cache_find(&out->turns, m, &maker, lanes))
        return dm_cache_find(&out->kick, m, &kicker, lanes) == lanes;
    if (build_turns(&out->turns, m, lanes) != lanes) return 0;
    if (build_kick(&out->kick, m, lanes) != lanes) return 0;
    dm_cache_add(m, &maker, lanes, &out->turns, lanes);
    dm_cache_add(m, &kicker, lanes, &out->kick, lanes);
    return 1;
}
