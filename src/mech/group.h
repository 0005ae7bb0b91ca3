/* group.h - the group that a system lives on, as steps see it: q[n] are flat coordinates of an
 * element, p[n] begins with the momentum dL/dxi and has zeros behind it
 * (docs/design/groups.md). */
#ifndef DM_GROUP_H
#define DM_GROUP_H

#include "mech/group_map.h"
#include "mech/model.h"

/* Maps tau from the algebra to the group whose charts g0 tau(xi) are known. */
typedef enum {
    DM_TAU_EXP,
    DM_TAU_CAYLEY,
    DM_TAU_PADE, /* that of degree 2, then of degrees 3 and 4 */
    DM_TAUS = 5
} dm_tau;

/* The traces of one tau (lua/dm/group/place.lua); chart NULL: the group has no such map. With
 * right trivialization tau(xi) stands on the left of g0. */
typedef struct {
    dm_graph *chart;        /* inputs q0[n], e[d], xi[d], rate[d] */
    const dm_node *place;   /* [n + d]: coordinates of g0 near(e) tau(xi), then its velocity */
    dm_graph *end;          /* inputs q0[n], xi[d], mu[d] */
    const dm_node *carried; /* [n + d + arcs]: g0 tau(xi), mu carried there, squares of angles */
    uint32_t arcs;
    int looked; /* was `change` asked for? It is traced for engines that sum it (integ/lie/lie.h) */
    dm_graph *change;       /* inputs as of `end`; NULL: none, as above 24 dimensions */
    const dm_node *changed; /* [n + d + arcs]: what `end` has more than q0 and mu, angles */
    dm_graph *axes;         /* inputs q0[n], mu[d], x; NULL: only by way of `end` */
    /* [d][n + d], then [n]: what g0 exp(x e_a) and mu carried there have more than g0 and mu, for x
     * of any size; what is to be added to q0 for what rounding took */
    const dm_node *turned;
} dm_chart_trace;

/* Values; and values with, behind them, those entries of their matrix of derivatives that are not
 * zero everywhere. The kernels compute coordinate after coordinate, since what bodies far apart
 * have in flight at the same time does not fit into a cache. */
typedef struct {
    dm_kernel plain, kernel;
    uint32_t values, count;
    const uint32_t *row, *column; /* [count] from 0 */
    const uint32_t *order; /* [values + count] output i of `kernel` is number order[i]; NULL: i */
    const uint32_t *plain_order; /* [values] of `plain` */
    dm_group_map map; /* in place of `kernel` where that would be too large; no columns: not here */
} dm_group_entries;

/* What a step with constraints, or of many bodies, is made of (group_joints.c); m multipliers
 * lambda[k], mu[l], c controls u. The first three take (q0[n], xi[d], rate[d], t, lambda[m], v[d],
 * u[c]) with columns (xi, rate, t, lambda). The impulse of a constraint point is I = G^T lambda +
 * E^T mu there, a body covector, with E at the velocity v. */
typedef struct {
    int ready; /* kernels are made, of: */
    dm_tau tau;
    int curved, straight;   /* and slope; line */
    dm_group_entries slope; /* L_e[d], L_xi[d], L_rate[d], forces added */
    /* the same of curves tau(a V), velocity V where tau is exp: L_e[d], zeros, dL/dV[d], with a in
     * the place of xi[1] and V in that of the rate; columns V alone */
    dm_group_entries line;
    dm_group_entries reaction; /* g[k], I_e[d], I_xi[d]: what I does to e and to xi */
    dm_group_entries rolling;  /* phi[l] */
    dm_group_entries pull;     /* as dm_group.pull, columns (xi, mu) */
    /* takes (q[n], v[d], t, lambda[m], p[d]): L_v - I - p [d], G v + g_t [k], phi [l], columns (v,
     * t, lambda) */
    dm_group_entries hidden;
    dm_kernel finish; /* as dm_chart_trace.end */
    uint32_t arcs;
    int turns; /* does E see v? */
} dm_group_joints;

/* Coordinates whose multiples stand for an element too, or that have no relation: the system as one
 * on R^n (group_homogeneous.c). */
typedef struct {
    /* inputs q[n], v[n]: coordinates on the group [n], velocity there [d], rates of the logarithms
     * of what q was divided by [scales]; NULL: they are not homogeneous */
    dm_graph *rates;
    const dm_node *rate;
    uint32_t scales;
    dm_graph *momenta;       /* inputs q[n], p[n]: */
    const dm_node *momentum; /* [2n + d] coordinates on the group, mu there, divisors of q */
    dm_model *lifted;        /* NULL: nobody asked yet */
    /* the same without the stage kernel, out of which slope and mass are taken where it is there
     * and round in another way than alone; NULL: nobody asked, or of an H */
    dm_model *plain;
    struct dm_constraints *constraints; /* of both, or NULL */
    dm_cache_entry *cache[2];           /* kernels of methods, of either: not those of all lifts */
    dm_kernel up;                       /* takes (q[n] on the group, mu[n], t), gives p[n] */
    dm_kernel down;                     /* takes (q[n], p[n], t), gives what `momentum` is */
} dm_homogeneous;

/* L in the chart about g0. Kernels are there for one tau at a time. */
typedef struct dm_group {
    uint32_t momenta; /* d, dimension of the algebra */
    dm_chart_trace trace[DM_TAUS];
    int ready; /* the kernels of the end of a step are made, of: */
    dm_tau tau;
    int curved, straight; /* and point; line */
    /* takes (q0[n], xi[d], rate[d], t): L_e, L_xi, L_rate of L(g0 near(e) tau(xi), velocity, t) at
     * e = 0, forces added: [3d]; columns (xi, rate) */
    dm_group_map point;
    /* of curves tau(a V), velocity V where tau is exp; takes (q0[n], unused[d], V[d], t, a):
     * L_e, dL/dV [2d]; columns V */
    dm_group_map line;
    /* the equation of such a curve where L does not see g; takes (V[d], mu[d], t, a, h): R =
     * dL/dV - b, b = dtau_R(h V)^T mu [2d]; behind them dR/dV [d*d]; no outputs: not here */
    dm_kernel free, free_matrix;
    dm_group_map pull; /* takes (xi[d], mu[d]): b = dtau_R(xi)^T mu [d]; columns (xi, mu) */
    dm_kernel finish;  /* as dm_chart_trace.end */
    dm_kernel change;  /* as dm_chart_trace.change; no outputs: none */
    uint32_t arcs;
    dm_group_joints joints;
    /* the collective lift (group_lift.c), where it is made: H on T*R^n; take (q[n], p[n], t) of
     * that and give the momenta J[d], and the directions X[n*d] in which J = X^T p */
    int liftable; /* the group is a level set of quadratic invariants of the lift */
    const dm_model *lifted;
    dm_kernel momentum, directions;
    dm_homogeneous homogeneous; /* for all rules that the former does not serve */
} dm_group;

/* Entries of p that are momenta, those that rows hold. */
static inline uint32_t dm_momenta(const dm_model *m) {
    return m->group ? m->group->momenta : m->n;
}

/* The graph of L, also where it has very many coordinates; NULL: it was not traced, or has sums
 * that stay loops. */
dm_graph *dm_group_graph(const dm_model *m);

/* Make the kernels of tau for a model that was built, in its arena; `straight`: line in the place
 * of point. */
dm_status dm_group_want(dm_group *out, const dm_model *m, dm_tau tau, int straight,
                        dm_compile *compile);

/* The same of its joints, `straight`: with line in the place of slope. */
dm_status dm_group_want_joints(dm_group *out, const dm_model *m, dm_tau tau, int straight,
                               dm_compile *compile);

/* Doubles of `out` for one: values, entries, room for both as the kernels leave them. */
static inline size_t dm_group_entries_size(const dm_group_entries *f) {
    const dm_group_map *m = &f->map;
    const size_t matrix = (size_t)m->values * m->columns;
    const size_t by_rows =
        m->columns ? matrix + dm_group_map_room((size_t)m->inputs + m->values + m->columns) : 0;
    return 3 * (size_t)f->values + 2 * (size_t)f->count + by_rows;
}

/* Constant outputs, once; then values and, where they are asked for, entries into out. */
void dm_group_entries_prepare(const dm_group_entries *f, double *out);
void dm_group_entries_eval(const dm_group_entries *f, const double *in, double *out,
                           int with_entries);

/* X[n*d] in a graph that begins with the inputs q[n]: d(coordinates of q near(e))/de at e = 0, by
 * rows. */
dm_status dm_group_directions(dm_node *X, dm_graph *g, const dm_chart_trace *exp, uint32_t n,
                              uint32_t d, dm_arena *arena);

/* Make the lift of a model that was built, in its arena; L quadratic in xi with a regular mass. */
dm_status dm_group_lift(dm_group *out, const dm_model *m, dm_compile *compile);

/* The homogeneous one, where coordinates are, with the kernels `want` of it and of its constraints
 * that are missing: `plain` where the stage kernel is not among them; with none, the structure of
 * `lifted` alone. DM_SINGULAR: its mass is constant and singular. */
dm_status dm_group_homogeneous(dm_group *out, const dm_model *m, unsigned want,
                               dm_compile *compile);

#endif
