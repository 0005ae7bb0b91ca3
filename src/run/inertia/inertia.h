/* inertia.h - how many values of d2L/dv2 are negative, on the velocities that constraints allow. A
 * motion keeps that number: where a value passes through zero the momentum no longer determines
 * the velocity and the motion ends, but a step may go over such a place. */
#ifndef DM_INERTIA_H
#define DM_INERTIA_H

#include "integ/method/method.h"

/* What is known of a run. A look costs a part of a step: the next one is due when a value could be
 * near zero by how fast the least one moved, a number of steps that depends on the states alone. */
typedef struct {
    uint32_t negative; /* at the start */
    int known;         /* is it? a start without a velocity has none */
    double least;      /* size of the value next to zero, when it was looked at last */
    double left;       /* steps until one vanishes, as it fell before that; infinite: none did */
    long looked, due;  /* steps done then, and when the next look is due */
    /* How much M can bend in a unit of time squared, over what it was at the start: for unit
     * speeds anywhere, and in the region around the motion up to so high a speed and so long. */
    double anywhere, bend, speed, until;
    double shift_anywhere, shift; /* how much it can move in a unit of time, alike */
    long wide;                    /* steps that a region is made for */
    int wait;                     /* looks until the next one is tried */
    int told;                     /* do bounds tell how M moves from the last look on? */
    double credit;  /* nodes whose bounds may be found yet: looks cost a part of the steps */
    double at;      /* the time of the last look */
    double h;       /* of the steps, or of the next one */
    int degenerate; /* d2L/dv2 is singular to round-off at the start */
    int open;       /* the next step may go over a place that looks do not see */
} dm_inertia_seen;

/* What is known of a block of velocities that M couples. Each is judged by itself: the product of
 * all values of n that move alike moves n times as fast as one.
 * Speed: tests/bench/moving_masses.lua: 4.8x for n = 20, 30x for 60, against one product. */
typedef struct {
    double least;     /* size of its value next to zero, when it was looked at last */
    double all;       /* size of the product of its values (signature.h); 0: it is not known */
    double ones;      /* `all` where the scales were found */
    double nearest;   /* `left`, or steps until a value could vanish by how that product moved */
    double left;      /* steps until it vanishes, as it fell before that; infinite: it did not */
    double rate, way; /* how fast the logarithm of what is looked at moved, a step, in how many */
    double turn;      /* how much faster with every step; way 0: not known */
    double reach;     /* steps that could come before the next look */
    double fell;      /* 1: it did */
} dm_inertia_course;

/* Of a block: sizes of the value next to zero and of the product. */
typedef struct {
    double least, all;
} dm_inertia_value;

typedef struct {
    const dm_model *model;
    dm_inertia_seen seen;
    dm_blocks blocks;               /* one under constraints and on groups */
    dm_inertia_course *course;      /* [blocks] */
    double close_least, close_left; /* of the last step, where every one is looked at */
    double kept_left;               /* seen.left at the kept state */
    double before;                  /* what was left before the last look */
    double *scale; /* [n] of the velocities: where the mass was largest its diagonal has ones */
    double *region, *place;      /* [2n] of q: the least, then the largest; q[n] at the last look */
    double *members;             /* [][]: these three and the courses */
    double *room, *out;          /* arguments (q, v, t) and outputs of kernels */
    double *A, *work;            /* matrices; the Legendre transform */
    uint32_t holonomic, rolling; /* rows of constraints */
    uint32_t tangent;            /* entries of a tangent vector, the last ones; 0: there is none */
    dm_inertia_value *values;    /* [blocks] that were found last */
    double *first, *last, *middle; /* [blocks] products on a line */
    /* a state that steps can be taken again from, what the engine remembered there, its time, how
     * many steps and rows were done */
    double *state, *memory, t;
    size_t memory_size;
    long done, rows;
    double *aside;              /* states and memories of parts of a step */
    double *end;                /* [state] of who looks into a step that is not its last one */
    int own;                    /* steps choose their length */
    const double *next;         /* and the next one has this; NULL: nothing is known of it */
    double *boxes;              /* what inertia_step.c works on */
    struct dm_mass_lanes *wide; /* several masses at once; NULL: one by one */
} dm_inertia;

/* Values that are positive by far; of the larger product at two ends of a line, where a zero leaves
 * a fourth in the middle; (1/2)^(2/3): what falls or rises by more may have met zero; what one end
 * of a line has more than the other where a step may have been thrown over a pole. */
#define DM_INERTIA_FAR 1e-3
#define DM_INERTIA_VALLEY 0.5
#define DM_INERTIA_PART 0.63
#define DM_INERTIA_THROWN 4.0

/* At a state: how many values are negative, the size of the one next to zero, and those of the
 * blocks. */
typedef struct {
    uint32_t negative;
    double least;
    const dm_inertia_value *of; /* [blocks] */
} dm_inertia_there;

/* Can the inertia of a model change? Not where its mass is constant, or definite anywhere. */
int dm_inertia_may_change(const dm_model *m);

/* Doubles of room, for an engine with so much memory and runs that take turns. */
size_t dm_inertia_work(const dm_model *m, size_t memory, size_t members);
void dm_inertia_open(dm_inertia *x, const dm_model *m, size_t memory, double *room);

/* Whose turn it is, and what was seen of it. */
void dm_inertia_choose(dm_inertia *x, size_t member, const dm_inertia_seen *seen);

/* The state of a start, from which the first step is h long. DM_SINGULAR: d2L/dv2 is singular to
 * round-off there, and a value is about to vanish. */
dm_status dm_inertia_begin(dm_inertia *x, const double *state, double t, double h);

/* Was a value about to vanish within a few steps of the last look? */
int dm_inertia_is_fading(const dm_inertia *x);

/* What is there, the blocks until another is found; 0: no velocity is known. */
int dm_inertia_values(const dm_inertia *x, const double *state, double t, dm_inertia_there *out);

/* How many values are negative, and the size of the one next to zero. */
int dm_inertia_at(const dm_inertia *x, const double *state, double t, uint32_t *negative,
                  double *least);

/* Does the mass depend on v? */
static inline int dm_inertia_sees_velocity(const dm_model *m) {
    return !(m->structure & DM_QUADRATIC_IN_V);
}

/* The velocity v[n] there, until something else is asked; NULL: none is known. */
const double *dm_inertia_velocity(const dm_inertia *x, const double *state, double t);

/* After a look at its end: does a value vanish inside the step of h from the kept state, at time t,
 * and have the same sign at its end, the state `to`? Before it a value fell steeply, or nothing was
 * known of the way (`open`). The step is made again in parts, which leave nothing behind but arrays
 * of the engine (dm_stepper.goes_on), unless its length is the rule's own business. */
int dm_inertia_vanishes(dm_inertia *x, dm_stepper *s, const double *to, double t, double h,
                        int steep, int open);

/* The same of the step of h from another state, which takes up nothing of the steps before. */
int dm_inertia_vanishes_anew(dm_inertia *x, dm_stepper *s, const double *state, const double *to,
                             double t, double h, int steep, int open);

/* ---- starts that are degenerate (inertia_start.c) ---- */

/* Is it surely regular at a start that was counted just now and on the way to x->end, where
 * x->values are? Told where x->wide looks at all places at once. */
int dm_inertia_starts_by_far(dm_inertia *x, const double *state, double t);

/* Is d2L/dv2 singular to round-off at a start whose mass was found and counted just now? */
int dm_inertia_is_degenerate(const dm_inertia *x, const double *state, double t);

/* v[n], the largest entry 1, with d2L/dv2 v zero to round-off at a start that is degenerate; 0:
 * nothing is known of it, as under constraints. */
int dm_inertia_direction(const dm_inertia *x, const double *state, double t, double *v);

/* The scaled u[n] of size 1 that A[n*n] u is least for, by inverse iteration; by how much its
 * inverse is larger, zero where there is none. From the moves by dp[n]: where scales hide a small
 * value, as at a fold of a diagonal mass, they have its direction already. A becomes its factors,
 * with room for n pivots behind it. */
double dm_inertia_find_least(double *A, const double *dp, double *u, uint32_t n);

/* ---- between looks (inertia_step.c) ---- */

/* Doubles of boxes for a model. */
size_t dm_inertia_boxes(const dm_model *m);

/* Of a start. */
void dm_inertia_expect(dm_inertia *x);

/* After a look: can values vanish unseen within steps from here? Lets the next look be due where
 * the answer ends, and marks the next step as open where it may. */
void dm_inertia_foresee(dm_inertia *x, const double *state, double t, long done);

/* Does a value vanish and come back on the way between two states, one open step apart? 0, surely,
 * or it has a place to do so where the motion need not come. */
enum { DM_INERTIA_HIDDEN = 1, DM_INERTIA_NEAR = 2 };
int dm_inertia_hides(dm_inertia *x, const double *from, double t0, const double *to, double t1);

/* A straight way from a[n] at time ta to b[n] at tb. */
typedef struct {
    const double *a, *b;
    double ta, tb;
    int known; /* x->first and x->last are the products of the values of blocks there */
    int poles; /* both ends are states: places are looked for where M grows without bound, too */
} dm_chord;

/* Does a value vanish on the chord c, a small part of `way` or of a curve beside it, without a
 * change of sign, so that the motion ends there (inertia_touch.c)? v[n]: a velocity there, NULL
 * where M does not depend on it. room[5n]. */
int dm_inertia_touches(const dm_inertia *x, const dm_chord *c, const dm_chord *way, const double *v,
                       double *room);

/* Does one on a line between two places, the second one that of a state? */
int dm_inertia_has_touched(const dm_inertia *x, const dm_chord *way);

/* Keep a state, and go back to it. */
void dm_inertia_keep(dm_inertia *x, dm_stepper *s, const double *state);
void dm_inertia_go_back(const dm_inertia *x, dm_stepper *s, double *state);

#endif
