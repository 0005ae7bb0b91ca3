/* fused.h - the parts of an explicit step as graphs from state to state (code/tape/loop.h): force,
 * kick, drift and their compensated sums together, the coefficients of the stage among the
 * inputs. The same numbers as through a force kernel but for rounding; every backend gives the
 * same bits.
 *
 * Carried: q[n], p[n], the low parts of both, then what a part adds. A kick is high' = (high + low)
 * + a b, where a b is added with one rounding, so that the next force waits for one operation; a
 * drift is high' = high + (low + a b). Of both low' = low + (a b + (high - high')), in which a b is
 * not rounded where the processor rounds a b + c once: by a decimal h roundings of a b, alone or
 * with low, have a mean. A drift adds a rest, which is what p has beside b, to the low part of q.
 *
 * Where a force is a coordinate times a factor, as in -q/r^3, it is the factor that is multiplied
 * by h b, as early as can be: one product for all coordinates, and none of them waits for it. */
#ifndef DM_FUSED_H
#define DM_FUSED_H

#include "code/tape/loop.h"
#include "integ/method/method.h"

/* Operations of the force; above, a kernel for it alone serves as well. */
enum { DM_FUSED_LARGEST = 20000 };

/* n expressions of q (and t) as what is added to n momenta. */
typedef struct {
    uint32_t count;    /* different factors */
    dm_graph *graph;   /* of the factors, which are compacted */
    dm_node *factor;   /* [count] */
    uint8_t *negative; /* [count] 1: the expression has the other sign */
    uint32_t *which;   /* [n] the factor of expression i */
    /* [n] what it is multiplied by; -1: nothing, and it is not scaled either */
    int32_t *coordinate;
    double *constant; /* [n] what is added to the product */
} dm_kicks;

/* scaled = 0: factors are the expressions themselves. 0 when it cannot be had: no graph
 * (hyper-dual numbers), too large, no memory. */
int dm_kicks_read(dm_kicks *k, const dm_model *m, const dm_node *expressions, int scaled);

/* Products in the factors are added at once (algebra/contract.h). 0 without memory. */
int dm_kicks_contract(dm_kicks *k);

/* a * b, what is added to a momentum or a position. */
typedef struct {
    dm_node a, b;
} dm_product;

/* A low part that is still to be made. */
typedef struct {
    dm_node high, sum, *low;
    dm_product x;
} dm_remainder;

/* A part under construction, made as it stands. */
typedef struct {
    dm_graph *graph;
    const dm_model *model;
    const dm_kicks *kicks;
    uint32_t size;
    dm_node *state;                        /* [size] what the carried values are by now */
    dm_node *q, *p, *low_q, *low_p, *more; /* inside of state */
    dm_node *with;                         /* [inputs of L] what stands for q, v, t */
    uint32_t coefficients;                 /* asked for so far */
    dm_remainder *late;                    /* [2n] */
    uint32_t late_count;
    dm_node drifted; /* ha of a drift whose q lack the low parts of p; 0: none */
    int failed;      /* memory was refused */
    int plain;       /* sums without low parts: the state's stay as they are */
} dm_fusion;

/* 0 without memory. */
int dm_fusion_begin(dm_fusion *b, const dm_model *m, const dm_kicks *k, uint32_t size);

/* The next coefficient of the part. */
dm_node dm_fusion_coefficient(dm_fusion *b);

/* The parameters of the model are the next coefficients. */
void dm_fusion_params(dm_fusion *b);

/* factors[kicks->count] at b->q and time t, those of coordinates times hb; minus = -hb. */
void dm_fusion_factors(dm_fusion *b, dm_node *factors, dm_node t, dm_node hb, dm_node minus);

/* to + hb times the constant of expression i. */
dm_node dm_fusion_constant(dm_fusion *b, uint32_t i, dm_node hb, dm_node to);

/* What expression i adds beside it, factors as above. */
dm_product dm_fusion_kick(dm_fusion *b, const dm_node *factors, uint32_t i, dm_node hb);

/* high + low += x; low may have other increments in it already. What waits for the last of x
 * waits for one operation. The low part is made by dm_fusion_settle. */
void dm_fusion_add_product(dm_fusion *b, dm_node *high, dm_node *low, dm_product x);

/* The same, *high being `sum`. */
void dm_fusion_leave(dm_fusion *b, dm_node *high, dm_node *low, dm_node sum, dm_product x);

/* high + low += y - low, where y has the old low part in it. */
void dm_fusion_sum(dm_fusion *b, dm_node *high, dm_node *low, dm_node y);

/* high + low += x, as numbers/compensated.h does it. */
void dm_fusion_add(dm_fusion *b, dm_node *high, dm_node *low, dm_node x);

/* v[n] = M^-1 (p - shift), and the shifted moved[n] = p - shift (may be NULL). */
void dm_fusion_velocity(dm_fusion *b, dm_node *v, dm_node *moved, const dm_node *p);

/* q += ha M^-1 (p - shift), and the low parts of p in the low parts of q, by dm_fusion_settle. */
void dm_fusion_drift(dm_fusion *b, dm_node ha);

/* Make the low parts of all sums so far; dm_fusion_end does it too. */
void dm_fusion_settle(dm_fusion *b);

/* What dm_loop_native takes; 0: no memory. */
int dm_fusion_end(dm_fusion *b, dm_loop_part *out);

/* The loop of these parts for one member by the backend of the model (lanes = 1), or for lanes;
 * 0: there is none. */
int dm_fused_build(dm_loop *out, const dm_model *m, const dm_loop_part *part, uint32_t size,
                   uint32_t lanes);

#endif
