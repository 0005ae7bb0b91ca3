/* group_homogeneous.c - a system on a group as one on R^N that does not see multiples of q. A unit
 * quaternion u = q/|q|, a matrix g/det(g)^(1/n) are those of an element, and with their velocity xi
 *   L(q, v) = L(u, xi, t) + sum_k m_k (d log s_k/dt)^2/2,  s_k the scales, such as |q|,
 * m_k > 0 of the size of the masses of L at rest (at xi = 1 where they are zero or infinite at
 * rest), so that units of mass change nothing, is a regular Lagrangian on R^N that the multiples
 * q -> s q leave alone. These are linear, so that every variational rule and every symplectic
 * pair keeps their momenta, zero at the start, exactly, and its step goes down to
 * T*(R^N without 0)/scales at momentum zero, which is T*G: it is a symplectic step on the group,
 * whatever the rule does to |q| (docs/theory/lie.md).
 * Constraints and forces are pulled back: their covectors f become f dxi/dv, which do no work along
 * q. */
#include "algebra/derive.h"
#include "graph/analyse.h"
#include "mech/constraints.h"
#include "mech/group_inside.h"

#include <math.h>
#include <string.h>

/* what is worked on while a lift is made */
typedef struct {
    const dm_model *m;
    const dm_homogeneous *h;
    dm_arena *arena;
    uint32_t n, d;
    dm_node *rate;  /* [n + d + scales] u, xi, rates of scales in the graph g */
    dm_node *slope; /* [d*n] dxi/dv */
    dm_node *with;  /* what stands for the inputs of another graph */
} pulling;

/* nodes in the arena of the model */
static dm_node *take(const pulling *l, size_t count) {
    return dm_arena_take(l->arena, (count + 1) * sizeof(dm_node));
}

/* u, xi and dxi/dv in a graph that begins with q[n], v[n] */
static dm_status find_rates(pulling *l, dm_graph *g) {
    const dm_homogeneous *h = l->h;
    const uint32_t n = l->n, d = l->d, count = n + d + h->scales;
    dm_node *inputs = take(l, 2 * (size_t)n);
    l->rate = take(l, count);
    l->slope = take(l, (size_t)d * n);
    if (!inputs || !l->rate || !l->slope) return DM_NO_MEMORY;
    dm_inputs(g, inputs, 0, 2 * n);
    dm_transplant(g, h->rates, h->rate, count, inputs, l->rate);
    dm_jacobian(g, l->rate + n, d, n, n, l->slope);
    return dm_graph_status(g);
}

/* what stands for q, v, t and all behind them in a graph of so many inputs: u, xi, t, the inputs of
 * g behind t; `momenta` in the place of xi unless it is NULL. 0: no memory */
static int stand_in(pulling *l, dm_graph *g, const dm_node *second, uint32_t inputs) {
    const uint32_t n = l->n, own = dm_graph_inputs(g);
    l->with = take(l, inputs);
    if (!l->with) return 0;
    memset(l->with, 0, inputs * sizeof *l->with);
    memcpy(l->with, l->rate, n * sizeof *l->with);
    memcpy(l->with + n, second, l->d * sizeof *second);
    for (uint32_t i = 2 * n; i < inputs && i < own; i++) l->with[i] = dm_input(g, i);
    return 1;
}

/* p = (dxi/dv)^T mu of coordinates on the group */
static dm_status make_up(pulling *l, dm_kernel *out, dm_compile *compile) {
    const uint32_t n = l->n, d = l->d;
    dm_graph *g = dm_graph_new(l->arena, 2 * n + 1);
    dm_node *p = take(l, n), *inputs = take(l, 2 * (size_t)n), *at = take(l, (size_t)d * n);
    dm_graph *from = dm_graph_new(l->arena, 2 * n);
    if (!g || !from || !p || !inputs || !at) return DM_NO_MEMORY;
    dm_status status = find_rates(l, from);
    if (status != DM_OK) return status;
    dm_inputs(g, inputs, 0, n);
    memset(inputs + n, 0, n * sizeof *inputs); /* xi is linear in v */
    dm_transplant(g, from, l->slope, d * n, inputs, at);
    for (uint32_t i = 0; i < n; i++) {
        p[i] = 0;
        for (uint32_t a = 0; a < d; a++)
            p[i] = dm_add(g, p[i], dm_mul(g, at[(size_t)a * n + i], dm_input(g, n + a)));
    }
    status = dm_graph_status(g);
    return status == DM_OK ? compile(out, g, p, n, l->arena) : status;
}

/* The traces of a group are those of all models: a graph of its own is compiled. */
static dm_status make_down(pulling *l, dm_kernel *out, dm_compile *compile) {
    const uint32_t n = l->n, count = 2 * n + l->d;
    dm_graph *g = dm_graph_new(l->arena, 2 * n + 1);
    dm_node *inputs = take(l, 2 * (size_t)n), *below = take(l, count);
    if (!g || !inputs || !below) return DM_NO_MEMORY;
    dm_inputs(g, inputs, 0, 2 * n);
    dm_transplant(g, l->h->momenta, l->h->momentum, count, inputs, below);
    const dm_status status = dm_graph_status(g);
    return status == DM_OK ? compile(out, g, below, count, l->arena) : status;
}

/* L_xi_xi[d*d] in a graph f of its own of so many inputs */
static dm_node *second_of(pulling *l, dm_graph *f, uint32_t count) {
    const dm_source *s = &l->m->source;
    const uint32_t d = l->d;
    dm_node *inputs = take(l, count), *slope = take(l, d), L = 0;
    dm_node *second = take(l, (size_t)d * d);
    if (!inputs || !slope || !second) return NULL;
    dm_inputs(f, inputs, 0, count);
    dm_transplant(f, s->graph, &s->lagrangian, 1, inputs, &L);
    dm_hessian(f, L, l->n, d, slope, second);
    return dm_graph_status(f) == DM_OK ? second : NULL;
}

/* are those finite at xi[d] = (at, ... at), t = 1 and one element, which coordinates of the
 * `seed` are a multiple of? */
static int is_finite_at(const pulling *l, dm_graph *f, const dm_node *second, double at,
                        uint32_t seed) {
    const uint32_t n = l->n, d = l->d, count = dm_graph_inputs(f);
    dm_graph *g = dm_graph_new(l->arena, 2 * n + 1);
    dm_node *inputs = take(l, 2 * (size_t)n), *with = take(l, count + d);
    dm_node *out = take(l, (size_t)d * d);
    if (!g || !inputs || !with || !out) return 0;
    memset(inputs, 0, 2 * n * sizeof *inputs);
    memset(with, 0, count * sizeof *with);
    for (uint32_t i = 0; i < n; i++) inputs[i] = dm_constant(g, sin(seed + 1.7 * i * seed + i));
    dm_transplant(g, l->h->rates, l->h->rate, n, inputs, with);
    for (uint32_t a = 0; a < d; a++) with[n + a] = dm_constant(g, at);
    if (count > 2 * n) with[2 * n] = dm_constant(g, 1.0);
    dm_transplant(g, f, second, d * d, with, out);
    for (uint32_t a = 0; a < d * d; a++) {
        double value = 0.0;
        if (out[a] && !(dm_is_constant(g, out[a], &value) && isfinite(value))) return 0;
    }
    return dm_graph_status(g) == DM_OK;
}

/* L_xi_xi[d*d] at (u, xi, t), xi[d] = (at, ... at) where it depends on xi; zeros where that is not
 * finite, as at rest for |xi|^(3/2) */
static dm_node *find_inertia(pulling *l, dm_graph *g, double at) {
    static const uint32_t SEEDS = 8; /* elements that are tried: of some, det g has no root */
    const uint32_t n = l->n, d = l->d, count = dm_graph_inputs(l->m->source.graph);
    dm_graph *f = dm_graph_new(l->arena, count);
    dm_node *still = take(l, d), *out = take(l, (size_t)d * d);
    dm_node *second = f ? second_of(l, f, count) : NULL;
    if (!still || !out || !second) return NULL;
    for (uint32_t a = 0; a < d; a++) still[a] = dm_constant(g, at);
    memset(out, 0, (size_t)d * d * sizeof *out);
    int finite = !dm_depends(f, second, d * d, n, d);
    for (uint32_t seed = 1; seed <= SEEDS && !finite; seed++)
        finite = is_finite_at(l, f, second, at, seed);
    if (!finite) return out;
    if (!stand_in(l, g, still, count)) return NULL;
    dm_transplant(g, f, second, d * d, l->with, out);
    return out;
}

/* does entry a of xi move with the coordinates that scale k, of the rates `scale`, is one of? */
static int moves_with(const pulling *l, const dm_node *scale, uint32_t k, uint32_t a) {
    for (uint32_t i = 0; i < l->n; i++)
        if (scale[(size_t)k * l->n + i] && l->slope[(size_t)a * l->n + i]) return 1;
    return 0;
}

/* 4 times the mean size of the inertia of those entries: that of a ball of quaternions, |xi|^2/2
 * along the sphere and 4 s'^2/2 across it; 0: there is none */
static dm_node scale_mass(const pulling *l, dm_graph *g, const dm_node *inertia,
                          const dm_node *scale, uint32_t k) {
    dm_node sum = 0;
    uint32_t count = 0;
    double value = 0.0;
    for (uint32_t a = 0; a < l->d; a++) {
        if (!moves_with(l, scale, k, a)) continue;
        count++;
        for (uint32_t b = 0; b < l->d; b++) {
            const dm_node x = inertia[(size_t)a * l->d + b];
            if (moves_with(l, scale, k, b)) sum = dm_add(g, sum, dm_mul(g, x, x));
        }
    }
    if (count == 0 || (dm_is_constant(g, sum, &value) && !(value > 0.0))) return 0;
    sum = dm_mul(g, sum, dm_constant(g, 16.0 / count));
    return dm_power(g, sum, dm_constant(g, 0.5));
}

/* The Lagrangian on R^N in a new graph. */
static dm_graph *pull_lagrangian(pulling *l, dm_node *L) {
    const dm_source *s = &l->m->source;
    dm_graph *g = dm_graph_new(l->arena, 2 * l->n + 1);
    if (!g || find_rates(l, g) != DM_OK) return NULL;
    const uint32_t scales = l->h->scales;
    dm_node *scale = take(l, (size_t)scales * l->n);
    dm_node *rest = find_inertia(l, g, 0.0), *moving = find_inertia(l, g, 1.0);
    if (!scale || !rest || !moving) return NULL;
    dm_jacobian(g, l->rate + l->n + l->d, scales, l->n, l->n, scale);
    if (!stand_in(l, g, l->rate + l->n, dm_graph_inputs(s->graph))) return NULL;
    dm_transplant(g, s->graph, &s->lagrangian, 1, l->with, L);
    for (uint32_t k = 0; k < scales; k++) {
        const dm_node rate = l->rate[l->n + l->d + k];
        dm_node mass = scale_mass(l, g, rest, scale, k);
        if (!mass) mass = scale_mass(l, g, moving, scale, k);
        if (!mass) mass = dm_constant(g, 1.0);
        const dm_node half = dm_mul(g, dm_constant(g, 0.5), mass);
        *L = dm_add(g, *L, dm_mul(g, half, dm_mul(g, rate, rate)));
    }
    return g;
}

/* H on T*R^N in a new graph; nothing is added, H_pp may be singular */
static dm_graph *pull_hamiltonian(pulling *l, dm_node *H) {
    const dm_source *s = &l->m->source;
    const dm_homogeneous *h = l->h;
    dm_graph *g = dm_graph_new(l->arena, 2 * l->n + 1);
    dm_node *inputs = take(l, 2 * (size_t)l->n);
    l->rate = take(l, l->n + (size_t)l->d);
    if (!g || !inputs || !l->rate) return NULL;
    dm_inputs(g, inputs, 0, 2 * l->n);
    dm_transplant(g, h->momenta, h->momentum, l->n + l->d, inputs, l->rate);
    if (!stand_in(l, g, l->rate + l->n, dm_graph_inputs(s->graph))) return NULL;
    dm_transplant(g, s->graph, &s->lagrangian, 1, l->with, H);
    return g;
}

/* rows of d entries as rows of n, f dxi/dv */
static dm_node *pull_rows(pulling *l, dm_graph *g, const dm_node *rows, uint32_t count) {
    const size_t n = l->n;
    dm_node *out = take(l, count * n);
    if (!out) return NULL;
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t i = 0; i < n; i++) {
            dm_node sum = 0;
            for (uint32_t a = 0; a < l->d; a++)
                sum = dm_add(g, sum, dm_mul(g, rows[k * n + a], l->slope[a * n + i]));
            out[k * n + i] = sum;
        }
    return out;
}

/* nodes of the constraints of the model at u and xi */
static dm_node *carry(const pulling *l, dm_graph *g, const dm_node *nodes, size_t count) {
    dm_node *out = take(l, count);
    if (out && nodes)
        dm_transplant(g, l->m->constraints->graph, nodes, (uint32_t)count, l->with, out);
    return out;
}

/* constraints, forces and controls of the model on R^N */
static dm_status pull_constraints(pulling *l, dm_homogeneous *to) {
    const dm_constraints *c = l->m->constraints;
    const uint32_t inputs = dm_graph_inputs(c->graph);
    dm_graph *g = dm_graph_new(l->arena, inputs);
    dm_constraints *out = dm_arena_take(l->arena, sizeof *out);
    if (!g || !out || find_rates(l, g) != DM_OK) return DM_NO_MEMORY;
    if (!stand_in(l, g, l->rate + l->n, inputs)) return DM_NO_MEMORY;
    const int given = (c->structure & DM_CONSTRAINTS_GIVEN_REACTIONS) != 0;
    const dm_node *f = carry(l, g, c->f, l->n), *u = carry(l, g, c->u, c->controls);
    const dm_node *E = carry(l, g, given ? c->E : NULL, c->rolling * (size_t)l->n);
    const dm_node *holonomic = carry(l, g, c->g, c->holonomic);
    const dm_node *rolling = carry(l, g, c->phi, c->rolling);
    if (!f || !u || !E || !holonomic || !rolling) return DM_NO_MEMORY;
    f = c->f ? pull_rows(l, g, f, 1) : NULL;
    E = given ? pull_rows(l, g, E, c->rolling) : NULL;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    const dm_constraints_traced traced = {.graph = g,
                                          .n = l->n,
                                          .holonomic = c->holonomic,
                                          .rolling = c->rolling,
                                          .controls = c->controls,
                                          .forces = c->f ? l->n : 0,
                                          .crossings = c->crossings,
                                          .u = c->controls ? u : NULL,
                                          .g = holonomic,
                                          .phi = rolling,
                                          .f = f,
                                          .E = E};
    const dm_status status = dm_constraints_build(out, &traced, l->arena);
    to->constraints = status == DM_OK ? out : NULL;
    return status;
}

/* a new one in a graph of its own, with its structure */
static dm_status make_model(dm_model **out, pulling *l) {
    dm_model *lifted = dm_arena_take(l->arena, sizeof *lifted);
    if (!lifted) return DM_NO_MEMORY;
    const int phase = (l->m->structure & DM_HAMILTONIAN) != 0;
    dm_node value = 0;
    dm_graph *g = phase ? pull_hamiltonian(l, &value) : pull_lagrangian(l, &value);
    if (!g || dm_graph_status(g) != DM_OK) return g ? dm_graph_status(g) : DM_NO_MEMORY;
    const dm_status status =
        (phase ? dm_hamiltonian_build : dm_model_build)(lifted, g, value, l->n, 0, NULL, l->arena);
    if (status == DM_OK) *out = lifted;
    return status;
}

/* the first one, and the kernels between its states and those of the group */
static dm_status begin(dm_homogeneous *out, pulling *l, dm_compile *compile) {
    dm_model *lifted = NULL;
    dm_status status = make_model(&lifted, l);
    if (status == DM_OK && l->m->constraints) status = pull_constraints(l, out);
    if (status == DM_OK) status = make_up(l, &out->up, compile);
    if (status == DM_OK) status = make_down(l, &out->down, compile);
    if (status == DM_OK) out->lifted = lifted;
    return status;
}

/* the one that serves the wishes */
static dm_status choose(dm_model **out, dm_homogeneous *h, pulling *l, unsigned want) {
    *out = h->lifted;
    const unsigned stage = DM_WANT_STAGE | DM_WANT_STAGE_LATER;
    if (!want || want & stage || h->lifted->structure & DM_HAMILTONIAN) return DM_OK;
    const dm_status status = h->plain ? DM_OK : make_model(&h->plain, l);
    *out = h->plain;
    return status;
}

/* Starts that are brought onto the constraints move in the chart. */
static dm_status want_moves(dm_group *out, const pulling *l, dm_compile *compile) {
    if (!l->m->constraints || out->joints.finish.eval) return DM_OK;
    const dm_joining j = {.m = l->m,
                          .trace = out->trace + DM_TAU_EXP,
                          .arena = l->arena,
                          .n = l->n,
                          .d = l->d};
    return dm_joining_finish(&j, &out->joints.finish, NULL, 0, compile);
}

/* what dm_model_build does not know */
static void attach(dm_model *lifted, const dm_model *m, dm_homogeneous *h) {
    lifted->source.cache = m->source.cache ? h->cache + (lifted == h->plain) : NULL;
    lifted->constraints = h->constraints;
    if (h->constraints && h->constraints->structure & DM_CONSTRAINTS_TIMED)
        lifted->structure &= ~(unsigned)DM_AUTONOMOUS;
}

dm_status dm_group_homogeneous(dm_group *out, const dm_model *m, unsigned want,
                               dm_compile *compile) {
    dm_homogeneous *h = &out->homogeneous;
    pulling l = {.m = m, .h = h, .arena = m->source.arena, .n = m->n, .d = out->momenta};
    dm_status status = h->lifted ? DM_OK : begin(h, &l, compile);
    dm_model *lifted = NULL;
    if (status == DM_OK) status = want_moves(out, &l, compile);
    if (status == DM_OK) status = choose(&lifted, h, &l, want);
    if (status != DM_OK) return status;
    const dm_source *s = &lifted->source;
    const unsigned of_model = want & ~(unsigned)DM_WANT_CONSTRAINTS;
    if (of_model & ~lifted->has)
        status = (lifted->structure & DM_HAMILTONIAN
                      ? dm_hamiltonian_build
                      : dm_model_build)(lifted, s->graph, s->lagrangian, l.n,
                                        of_model | lifted->has, compile, l.arena);
    if (status == DM_OK && h->constraints)
        status = dm_constraints_want(h->constraints, want, compile);
    if (status == DM_OK) attach(lifted, m, h);
    return status;
}
