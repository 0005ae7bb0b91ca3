/* crossing.h - places where holonomic constraints cross: the rows of G = dg/dq depend on each other
 * at a point of the level set, as at the node of x y = 0, and g = 0 no longer says where a motion
 * goes on. A step may go over such a place, or onto another branch behind it. */
#ifndef DM_CROSSING_H
#define DM_CROSSING_H

#include "base/wide_product.h"
#include "mech/constraints.h"

/* Coordinates y[n] about the start of a step, where it is y = 0, for a step on a group: g[k] and
 * its derivatives in y [k*n] there. */
typedef struct {
    uint32_t n; /* at most that of the constraints */
    void (*look)(void *ctx, double *g, double *G, const double *y, double t);
    void *ctx;
} dm_crossing_chart;

/* A step from q0[n] to q1[n]; weight[n]: squares of lengths in which masses are 1. chart: of what
 * both are coordinates; NULL: they are q themselves. */
typedef struct {
    const double *q0, *q1, *weight;
    double t0, t1;
    const dm_crossing_chart *chart;
} dm_crossing_way;

/* row: from 1, the one that lost most; when it is reached */
typedef struct {
    uint32_t row;
    double t;
} dm_crossing_place;

/* A mass: the entries of row i begin at M[i pitch]; pitch 0: M[n] is its diagonal. */
typedef struct {
    const double *M;
    uint32_t n;
    size_t pitch;
} dm_crossing_mass;

/* weight[n] by masses of coordinates, those of tangent maps (prolonged) by those of L; of one that
 * has none of its own by what couples it. 0: some are no numbers. */
int dm_crossing_weights(double *weight, const dm_crossing_mass *mass, int prolonged);

/* Does the way along g = 0 from q0 toward q1 lead over such a place? Needs DM_WANT_HOLONOMIC;
 * work[dm_crossing_work]. */
size_t dm_crossing_work(const dm_constraints *c);
int dm_crossing_between(const dm_constraints *c, const dm_crossing_way *way, dm_crossing_place *out,
                        double *work);

/* The square of the volume that the rows span in these units, of the outputs of the kernel, whose
 * rows on a group are body covectors with zeros behind them. */
dm_wide_product dm_crossing_volume(const dm_constraints *c, const double *holonomic,
                                   const double *weight, double *work);

/* The square of the volume falls by a large part in a step that goes over such a place, or in the
 * one before it: these steps, which are rare, are looked into. */
typedef struct {
    double volume;      /* where it was compared last; not positive: the next step is looked into */
    double least, most; /* steps in which it stays between these are not */
} dm_crossing_watch;

void dm_crossing_expect(dm_crossing_watch *w, double volume);

static inline int dm_crossing_is_far(const dm_crossing_watch *w, double now) {
    return now > w->least && now < w->most;
}

/* Of one that is not far: is the step looked into in which it came from `before`? */
int dm_crossing_suspects(dm_crossing_watch *w, double before, double now);

/* All of this for a step with that volume at its end; watched[3]: what the step before left, zeros
 * at a start: a power of two that volumes are divided by, the last one, one to compare with. */
enum { DM_CROSSING_WATCHED = 3 };
/* The first part of it: is the step one that need not be looked into? Else watched is as it was. */
int dm_crossing_is_calm(double *watched, dm_wide_product volume);
int dm_crossing_in_step(const dm_constraints *c, double *watched, dm_wide_product volume,
                        const dm_crossing_way *way, dm_crossing_place *out, double *work);

/* The same of a step of h at whose end the kernel gave `holonomic`; mass[n*n].
 * work[n + dm_crossing_work] */
int dm_crossing_at_end(const dm_constraints *c, double *watched, const double *holonomic,
                       const double *mass, dm_crossing_way way, dm_crossing_place *out,
                       double *work);

#endif
