/* model.h - what the step kernels know of a mechanical system: its dimension, its structure and
 * the kernels derived from its Lagrangian L(q, v, t), from a discrete Lagrangian Ld(q0, q1), or
 * from a Hamiltonian H(q, p, t) that is no Legendre transform of an L with a formula.
 *
 * Structure is read off the graph, never measured: a bit says that something holds everywhere.
 * A kernel is made only when a rule wants it (DM_WANT_*), in the caller's arena, and is there
 * when its bit is in `has`. A model is not changed after it has been built, but for the stage
 * kernel that may be made late and for its cache; threads have models of their own. */
#ifndef DM_MODEL_H
#define DM_MODEL_H

#include "code/source.h"
#include "linalg/blocks.h"

#include <stddef.h>

enum {                          /* structure, read off the graph */
       DM_SEPARABLE = 1,        /* L = T(v) - V(q, t): no mixed second derivatives */
       DM_CONSTANT_MASS = 2,    /* d2L/dv2 does not depend on q, v, t */
       DM_DIAGONAL_MASS = 4,    /* and is diagonal, with nothing linear in v */
       DM_AUTONOMOUS = 8,       /* neither L nor its constraints depend on t */
       DM_LINEAR_IN_V = 16,     /* d2L/dv2 = 0: degenerate */
       DM_QUADRATIC_IN_V = 32,  /* d2L/dv2 does not depend on v */
       DM_DEFINITE_MASS = 2048, /* and moves, but is positive definite, whatever q, t, parameters */
       DM_NO_VELOCITY = 128,    /* dL/dv = 0, DM_LINEAR_IN_V too: nothing moves */
       DM_SADDLE = 256, /* d2L/dv2 is singular by itself: L of the model is that of saddle.h */
       /* H(q, p, t) is given and there is no L (hamiltonian.c): kernels are value and energy, both
        * H at (q, p, t), field and field_curve. DM_SEPARABLE: H = T(p) + V(q, t) */
       DM_HAMILTONIAN = 512,
       DM_LOOPS = 64,  /* sums are kept as loops: no n x n tables, DM_WANT_DENSE cannot be had */
       DM_CELLS = 1024 /* some of them are over cells of a mesh, and are never written out */
};

enum {                      /* kernels; each takes x = (q[n], v[n], t) */
       DM_WANT_VALUE = 1,   /* L, on the tape */
       DM_WANT_SLOPE = 2,   /* L_q[n], L_v[n] */
       DM_WANT_STAGE = 4,   /* L_q[n], L_v[n], L_qq[n*n], L_qv[n*n] (row q, column v), L_vv[n*n] */
       DM_WANT_FORCE = 8,   /* L_q[n] */
       DM_WANT_ENERGY = 16, /* v . L_v - L */
       DM_WANT_MASS = 32,   /* L_v[n], L_vv[n*n] */
       DM_WANT_POTENTIAL = 128, /* L(q, 0, t) = -V, then L_q[n]: separable L only */
       DM_WANT_PAIR = 64,   /* takes (q0[n], q1[n]): D1[n], D2[n], D1D2[n*n] (row q0, column q1) */
       DM_WANT_MAP = 16384, /* takes (q0[n], p0[n]): q1[n], p1[n], impulses; of a given step */
       DM_WANT_FIELD = 131072,       /* of H, at (q, p, t): H_p[n], -H_q[n] */
       DM_WANT_FIELD_CURVE = 262144, /* the same, then its derivatives by (q, p): [2n*2n] by rows */
       DM_WANT_STAGE_LATER = 8192,   /* when dm_model_stage asks for it, mostly never */
       DM_WANT_DENSE = DM_WANT_STAGE | DM_WANT_STAGE_LATER | DM_WANT_MASS |
                       DM_WANT_POTENTIAL, /* with sums written out */
       DM_WANT_HOLONOMIC = 256,           /* of the constraints (mech/constraints.h): g, G, g_t */
       DM_WANT_ROLLING = 512,             /* phi, E, phi_v, phi_q */
       DM_WANT_CONSTRAINT_FORCE = 1024,   /* f */
       DM_WANT_FORCE_CURVE = 2048,        /* f, f_q, f_v */
       DM_WANT_REACTION = 4096,           /* r = G^T lambda + E^T mu, r_q, r_v */
       DM_WANT_CHART = 1 << 21, /* of a system on a group, the charts of mech/group.h: this bit
                                 shifted by the number of a dm_tau */
       DM_WANT_CHARTS = 31 << 21,
       DM_WANT_CURVATURE = 1 << 27, /* of a field (DM_CELLS): L_qq as a sparse matrix */
       DM_WANT_LIFT = 524288, /* of a system on a group: its collective lift (mech/group_lift.c) */
       DM_WANT_JOINTS = 1048576,   /* of a chart that is wanted: dm_group_joints, in its place */
       DM_WANT_STRAIGHT = 1 << 26, /* of a chart that is wanted: for curves xi = a V alone */
       DM_WANT_ON_GROUP = DM_WANT_CHARTS | DM_WANT_LIFT | DM_WANT_JOINTS | DM_WANT_STRAIGHT,
       DM_WANT_OF_H = DM_WANT_VALUE | DM_WANT_ENERGY | DM_WANT_FIELD |
                      DM_WANT_FIELD_CURVE, /* all of a DM_HAMILTONIAN model */
       DM_WANT_CONSTRAINTS = 7936 /* all of these; what a model does not have is not made */
};

/* forces on a field beside those of L, and whether they depend on v */
enum { DM_WORKED = 1, DM_WORKED_BY_RATES = 2 };

struct dm_constraints;
struct dm_group;

/* A system as steps see it. Where L is a discrete Lagrangian only n, value, pair and operations
 * are set; where L is a function that cannot be traced its kernels are callbacks and
 * source.graph is NULL. */
typedef struct {
    uint32_t n; /* dim Q */
    unsigned structure;
    unsigned has; /* DM_WANT_* that are built */
    dm_kernel value, slope, stage, force, energy, mass, potential, pair, map, field, field_curve;
    /* D1[n] + D2[n] of a pair, rewritten by itself: velocity terms cancel before they are rounded.
     * No eval: Ld has implicit functions or is a callback, take the sum of both */
    dm_kernel pair_sum;
    const double *inverse_mass;   /* DM_CONSTANT_MASS: [n*n], or [n] when diagonal; else NULL */
    const double *mass_matrix;    /* same shape */
    const double *momentum_shift; /* DM_CONSTANT_MASS and separable: p = M v + shift, [n] */
    /* of M(q, t), for boxes (mech/mass_bounds.h); NULL: it is constant, a sum of squares,
     * definite, depends on v, or is large */
    const struct dm_mass_bounds *mass_bounds;
    dm_blocks mass_blocks;          /* of a mass that moves; count 0: not known */
    const uint8_t *cyclic;          /* [n]: 1 where L does not depend on q_i */
    struct dm_curvature *curvature; /* DM_WANT_CURVATURE (chain/curvature.h); else NULL */
    struct dm_work *work; /* forces beside L on a field (chain/virtual_work.h), DM_WANT_FORCE; NULL:
                           * none */
    unsigned worked;      /* DM_WORKED: such forces are there, made or not */
    uint32_t sphere; /* q is cut into unit vectors of so many entries (DM_CELLS); 0: it is not */
    const uint8_t *held; /* [n]: DM_HELD, DM_MASSLESS or 0 (DM_CELLS); NULL: nowhere */
    uint32_t massless;   /* entries that are DM_MASSLESS */
    const char *unfit;   /* why no rule steps these masses of a field, a sentence; NULL */
    uint32_t operations; /* of L itself */
    uint32_t params;     /* inputs of L behind t: numbers that a stepper brings; mostly 0 */
    dm_source source;
    const struct dm_constraints *constraints; /* NULL: none */
    const struct dm_group *group;             /* NULL: q are coordinates (mech/group.h) */
    struct dm_later *later;                   /* how to make the stage kernel; NULL: nobody asked */
} dm_model;

/* With sums (algebra/body_sum.h) or very many coordinates: so many rounds are written out as
 * they are; above, loops stay where mass is constant and diagonal; what needs n x n tables
 * writes them out up to so many coordinates. */
enum { DM_MODEL_WRITTEN_OUT = 40, DM_MODEL_DENSE = 400 };

/* Read the structure of L in g (inputs q[n], v[n], t) and build the wanted kernels. Everything
 * that *m points to is in `arena`. DM_SINGULAR: the mass matrix is constant and singular;
 * inverse_mass is then NULL and the model cannot be stepped, all the rest is usable.
 * DM_TOO_LARGE with sums: above DM_MODEL_DENSE, and d2L/dv2 not constant and diagonal or
 * DM_WANT_DENSE. */
dm_status dm_model_build(dm_model *m, dm_graph *g, dm_node L, uint32_t n, unsigned want,
                         dm_compile *compile, dm_arena *arena);

/* The stage kernel of a model that was built with DM_WANT_STAGE or DM_WANT_STAGE_LATER, made now
 * where it is not there yet, in the arena of the model: the caller owns it, other threads have
 * models of their own. */
dm_status dm_model_stage(const dm_kernel **out, const dm_model *m);

/* The same for H(q, p, t) in g, with inputs q[n], p[n], t; *m is DM_HAMILTONIAN. What else than
 * VALUE, ENERGY, FIELD and FIELD_CURVE is wanted there is not. */
dm_status dm_hamiltonian_build(dm_model *m, dm_graph *g, dm_node H, uint32_t n, unsigned want,
                               dm_compile *compile, dm_arena *arena);

/* The same for a discrete Lagrangian in g with inputs q0[n], q1[n]: value takes (q0, q1). */
dm_status dm_model_build_pair(dm_model *m, dm_graph *g, dm_node Ld, uint32_t n, dm_compile *compile,
                              dm_arena *arena);

/* The model with loops (loops_model.c); *fits = 0 where the mass is not constant and diagonal. */
dm_status dm_loops_model(dm_model *m, dm_graph *g, dm_node L, unsigned want, int *fits);

/* Is it a model of this L of a field (DM_CELLS)? Then its structure need not be read again: more
 * kernels. */
static inline int dm_loops_of(const dm_model *m, const dm_graph *g, dm_node L) {
    return m->structure & DM_CELLS && m->source.sums == g && m->source.lagrangian == L;
}
dm_status dm_loops_more(dm_model *m, unsigned want, dm_compile *compile);

/* Doubles of scratch that the two functions below need. */
size_t dm_legendre_work(const dm_model *m);

/* p = dL/dv at (q, v, t). Needs DM_WANT_MASS or DM_DIAGONAL_MASS; of an H, where it is Newton's
 * method for dH/dp = v, DM_WANT_FIELD_CURVE. */
dm_status dm_legendre(const dm_model *m, double *p, const double *q, const double *v, double t,
                      double *work);

/* v with dL/dv(q, v, t) = p, Newton from the v given (which may alias p). Needs DM_WANT_MASS or
 * DM_SEPARABLE and DM_CONSTANT_MASS, where it is one product; of an H, v = dH/dp, DM_WANT_FIELD. On
 * failure v is unchanged. Where L
 * is linear in v no p determines it: v stays as it is, which is enough for the energy. */
dm_status dm_legendre_inverse(const dm_model *m, double *v, const double *q, const double *p,
                              double t, double *work);

#endif
