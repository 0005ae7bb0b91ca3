/* strip_run.h - a run over the levels of a strip, and what its laws are looked at by. */
#ifndef DM_STRIP_RUN_H
#define DM_STRIP_RUN_H

#include "field/line/strip.h"

/* Where a run stands behind a slab, beside u and p of the level: what goes on from here has the
 * bits of a run that never stopped. */
typedef struct {
    long done;           /* slabs since t0 */
    double t, before, h; /* of the level, of the one before, height of the slab between them */
    double energy,
        target;         /* of that slab; what S_t - S_h of all slabs is, where heights are free */
    double scale, most; /* of the first slab the energies of all cells, without their signs; and
                              the largest sum of p u_t so far: what a blow-up is told by */
} dm_strip_ending;

typedef struct {
    double t0, h; /* start, height of a slab (the first, where heights are free) */
    long steps, every;
    int is_free;                 /* heights are unknown: G of each slab is that of the first one */
    const double *guess;         /* [unknowns] of the first upper level; NULL: the start */
    const dm_strip_ending *from; /* go on from here, with the two levels before in old[2][unknowns];
                                    NULL: a start */
    const double *old;
    const volatile sig_atomic_t *stop; /* may be NULL */
} dm_strip_plan;

/* What a run leaves: rows of `unknowns` numbers, the first of which is given. */
typedef struct {
    double *u, *p;  /* p: NULL for boxes */
    double *t;      /* [rows] */
    double *energy; /* [rows] -S_h of the slab that ends at the row, first: of the first slab;
                       NULL for boxes */
} dm_strip_record;

typedef struct {
    long done, rows;  /* valid also after a failure */
    double h;         /* the last height */
    uint32_t tangled; /* the cell, from 1, whose nodes have passed each other; 0: none */
    dm_strip_report solve;
    dm_strip_ending ending;
} dm_strip_outcome;

long dm_strip_plan_rows(const dm_strip_plan *plan);

/* A step that fails leaves the rows before it and, as the last one, the last good level.
 * DM_BLOW_UP: the energy of a field without time in it has grown by more than 2^104, as only an
 * instability makes it. */
dm_status dm_strip_go(dm_strip_room *room, const dm_strip_plan *plan, dm_strip_record *rows,
                      dm_strip_outcome *outcome);

/* Levels that are known, for laws: u[levels][unknowns] at times t[levels]. */
typedef struct {
    const double *u, *t;
    long levels;
} dm_strip_levels;

/* First variations: v[levels][unknowns], the first level given, from the linearized equation; dp:
 * variation of the momenta of the first level (NULL for boxes), overwritten. */
dm_status dm_strip_vary(dm_strip_room *room, const dm_strip_levels *along, double *v, double *dp);

/* What the boundary sums of a law are, over the cells around each node inside: of the currents
 * S_node . xi (xi[levels][unknowns]), or of the forms d(S_node)^d(u_node) of v and w. */
typedef struct {
    const double *xi; /* else NULL, and: */
    const double *v, *w;
    const uint8_t *leave; /* [nodes] 1: no law there, its equation has a force or is missing */
} dm_strip_law;

/* The largest sum, in units of `area`; *size: the largest of what one corner of a cell adds to it,
 * all terms without signs, so that round-off is some 1e-16 of that. */
double dm_strip_residual(dm_strip_room *room, const dm_strip_levels *along, const dm_strip_law *law,
                         double area, double *size);

/* The height at which the fastest oscillation about the level u begins to grow: where
 * S_ll + S_uu - S_lu - S_ul, lower and upper level being u, changes its signature; heights are
 * looked at around `unit`. INFINITY: none; -1: none is seen, and the kinetic energy is of both
 * signs; NaN: the form is degenerate for small heights. */
double dm_strip_limit(dm_strip_room *room, const double *u, double unit);

#endif
