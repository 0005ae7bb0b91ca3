/* group_field.h - the equations of motion on a group, as explicit rules of Lie groups step them:
 *   g' = g xi,  pi' = Ad*_(1/f) (L_g + force),  g = g0 f,  mu = Ad*_f pi,
 * where mu = dL/dxi is the momentum at g and pi the same carried back to the start of the step: it
 * changes by the torque alone, so that momenta of an L that does not see g are kept. Of an H(g, mu)
 * xi = H_mu and the torque is -H_g. With right trivialization f stands on the left. */
#ifndef DM_GROUP_FIELD_H
#define DM_GROUP_FIELD_H

#include "integ/method/method.h"
#include "mech/group.h"

enum { DM_FIELD_TEXT = 128 };

/* Laid into the workspace of a stepper; sizes: n flat coordinates, d dimension of the group. */
typedef struct {
    const dm_model *m;
    const dm_group *group;
    uint32_t n, d;
    double *x;     /* [n + 2d + 1] element, chart 0, velocity, t: inputs of the slopes */
    double *slope; /* [3d] */
    double *v, *p; /* [n] each, for the Legendre transform */
    double *in;    /* [n + 2d] of the end of a chart and of its differential */
    double *end;   /* [n + d + arcs] */
    double *pull;  /* [d (2d + 1)] the differential of the chart, and derivatives */
    double *A;     /* [d*d] then [d] pivots: it as a matrix */
    double *room;  /* of its map */
    double *work;  /* of the Legendre transform */
    double turn;   /* rad, of a step that went past pi, else 0 */
    char text[DM_FIELD_TEXT];
} dm_group_field;

/* For engines: what they want, doubles of memory, a static sentence where they cannot. */
const char *dm_group_field_fits(const dm_rule *rule, const dm_model *m);
unsigned dm_group_field_wants(const dm_rule *rule, const dm_model *m);
size_t dm_group_field_size(const dm_model *m);

/* Lay *f out in `memory`, and fill in constant outputs. */
void dm_group_field_open(dm_group_field *f, const dm_model *m, double *memory);

/* xi[d] and torque[d] at (q, mu, t). */
dm_status dm_group_field_at(dm_group_field *f, double *xi, double *torque, const double *q,
                            const double *mu, double t);

/* q[n] times exp(xi) and mu[d] carried there, in place, where xi is `share` > 0 of a step;
 * DM_NO_CONVERGENCE where that is half a turn or more. */
dm_status dm_group_field_move(dm_group_field *f, double *q, double *mu, const double *xi,
                              double share);

/* mu[d] carried back along exp(xi), in place. */
void dm_group_field_carry_back(dm_group_field *f, double *mu, const double *xi);

/* u'[d] with exp(u)' = exp(u) xi, in place of xi. */
dm_status dm_group_field_chart_rate(dm_group_field *f, double *xi, const double *u);

/* A step ends at (q, mu): the state, whose low parts these rules do not keep. */
void dm_group_field_end(const dm_group_field *f, double *state, const double *q, const double *mu);

/* Why a step failed that turned so far, or NULL. */
const char *dm_group_field_why(dm_group_field *f, double turn);

#endif
