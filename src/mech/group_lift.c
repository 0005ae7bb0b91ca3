/* group_lift.c - a system on a group as one on R^N: H(g, mu, t) becomes H(q, J(q, p), t) on T*R^N,
 * where q are the flat coordinates and J_a = p . X_a(q) the momentum map of translations q -> q
 * near(e) (McLachlan, Modin & Verdier 2014). With a relation that these keep, |q| = 1 or g J g^T =
 * J, the group is a level set of quadratic invariants, and a method that keeps these keeps it. */
#include "algebra/derive.h"
#include "graph/linear.h"
#include "mech/group.h"

#include <string.h>

/* what is worked on while a lift is made */
typedef struct {
    const dm_model *m;
    const dm_group *group;
    dm_arena *arena;
    dm_graph *g; /* inputs q[n], p[n], t */
    uint32_t n, d;
    dm_node *X;    /* [n*d] by rows: d(place of q near(e))/de at e = 0 */
    dm_node *J;    /* [d] */
    dm_node *with; /* [inputs of L] what stands for them */
    dm_node H;
} lifting;

/* nodes in the arena of the model */
static dm_node *take(const lifting *l, size_t count) {
    return dm_arena_take(l->arena, (count + 1) * sizeof(dm_node));
}

/* J = X^T p */
static dm_status find_momentum(lifting *l) {
    l->J = take(l, l->d);
    if (!l->J) return DM_NO_MEMORY;
    for (uint32_t a = 0; a < l->d; a++) {
        l->J[a] = 0;
        for (uint32_t i = 0; i < l->n; i++) {
            const dm_node p = dm_input(l->g, l->n + i);
            l->J[a] = dm_add(l->g, l->J[a], dm_mul(l->g, p, l->X[i * l->d + a]));
        }
    }
    return dm_graph_status(l->g);
}

/* what stands for q, v, t of the model: q, `second` (d nodes, then zeros; NULL: zeros), t */
static void stand_in(lifting *l, const dm_node *second) {
    const uint32_t n = l->n;
    memset(l->with, 0, dm_graph_inputs(l->m->source.graph) * sizeof *l->with);
    dm_inputs(l->g, l->with, 0, n);
    if (second) memcpy(l->with + n, second, l->d * sizeof *second);
    l->with[2 * n] = dm_input(l->g, 2 * n);
}

/* y = M^-1 y with the mass of xi, M at v = 0 */
static dm_status divide_by_mass(lifting *l, dm_node *y) {
    const uint32_t n = l->n, d = l->d;
    dm_graph *from = l->m->source.graph;
    dm_node *slope = take(l, (size_t)d * d), *M = take(l, (size_t)d * d);
    if (!slope || !M) return DM_NO_MEMORY;
    dm_jacobian(from, l->m->source.gradient + n, d, n, d, slope);
    dm_transplant(l->g, from, slope, d * d, l->with, M);
    if (dm_graph_status(from) != DM_OK) return dm_graph_status(from);
    dm_graph_solve(l->g, M, y, d, 1, NULL);
    return dm_graph_status(l->g);
}

/* W y with W = M^-1 in numbers */
static void weigh(const lifting *l, dm_node *x, const dm_node *y) {
    const dm_model *m = l->m;
    const int diagonal = (m->structure & DM_DIAGONAL_MASS) != 0;
    for (uint32_t a = 0; a < l->d; a++) {
        x[a] = 0;
        for (uint32_t b = 0; b < l->d; b++) {
            const double w = !diagonal ? m->inverse_mass[a * (size_t)l->n + b]
                             : a == b  ? m->inverse_mass[a]
                                       : 0.0;
            x[a] = dm_add(l->g, x[a], dm_mul(l->g, dm_constant(l->g, w), y[b]));
        }
    }
}

/* H = y . M^-1 y/2 - L at xi = 0, y = J - L_xi there */
static dm_status transform(lifting *l) {
    const uint32_t n = l->n, d = l->d;
    const dm_source *s = &l->m->source;
    dm_node *y = take(l, d), *x = take(l, d), L;
    if (!y || !x) return DM_NO_MEMORY;
    stand_in(l, NULL);
    dm_transplant(l->g, s->graph, &s->lagrangian, 1, l->with, &L);
    dm_transplant(l->g, s->graph, s->gradient + n, d, l->with, y);
    for (uint32_t a = 0; a < d; a++) y[a] = dm_sub(l->g, l->J[a], y[a]);
    memcpy(x, y, d * sizeof *x);
    dm_status status = DM_OK;
    if (l->m->structure & DM_CONSTANT_MASS)
        weigh(l, x, y);
    else
        status = divide_by_mass(l, x);
    l->H = 0;
    for (uint32_t a = 0; a < d; a++) l->H = dm_add(l->g, l->H, dm_mul(l->g, y[a], x[a]));
    l->H = dm_sub(l->g, dm_mul(l->g, dm_constant(l->g, 0.5), l->H), L);
    return status == DM_OK ? dm_graph_status(l->g) : status;
}

/* H of the lift, of a system that is given by L or by H */
static dm_status find_hamiltonian(lifting *l) {
    const dm_source *s = &l->m->source;
    l->with = take(l, dm_graph_inputs(s->graph));
    if (!l->with) return DM_NO_MEMORY;
    if (!(l->m->structure & DM_HAMILTONIAN)) return transform(l);
    stand_in(l, l->J);
    dm_transplant(l->g, s->graph, &s->lagrangian, 1, l->with, &l->H);
    return dm_graph_status(l->g);
}

/* The model of H, and the two kernels between its states and those of the group. */
dm_status dm_group_lift(dm_group *out, const dm_model *m, dm_compile *compile) {
    lifting l = {.m = m,
                 .group = out,
                 .arena = m->source.arena,
                 .g = dm_graph_new(m->source.arena, 2 * m->n + 1),
                 .n = m->n,
                 .d = out->momenta};
    dm_model *lifted = dm_arena_take(l.arena, sizeof *lifted);
    if (!l.g || !lifted) return DM_NO_MEMORY;
    l.X = take(&l, (size_t)l.n * l.d);
    if (!l.X) return DM_NO_MEMORY;
    dm_status status = dm_group_directions(l.X, l.g, out->trace + DM_TAU_EXP, l.n, l.d, l.arena);
    if (status == DM_OK) status = find_momentum(&l);
    if (status == DM_OK) status = find_hamiltonian(&l);
    if (status == DM_OK) status = compile(&out->directions, l.g, l.X, l.n * l.d, l.arena);
    if (status == DM_OK) status = compile(&out->momentum, l.g, l.J, l.d, l.arena);
    if (status == DM_OK)
        status = dm_hamiltonian_build(lifted, l.g, l.H, l.n, DM_WANT_FIELD | DM_WANT_FIELD_CURVE,
                                      compile, l.arena);
    if (status != DM_OK) return status;
    lifted->source.cache = m->source.cache;
    lifted->structure &= ~(unsigned)DM_SEPARABLE;
    out->lifted = lifted;
    return DM_OK;
}
