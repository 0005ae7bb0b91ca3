/* rattle.h - kernels of RATTLE and SHAKE for L = T(v) - V(q, t) with constant mass M, W = M^-1,
 * and holonomic constraints g(q, t) = 0, G = dg/dq: p+ = p0 + h/2 F(q0) + G(q0)^T lambda,  q1 =
 * q0 + h W (p+ - shift),  g(q1) = 0 by Newton in lambda, p1 = p+ + h/2 F(q1) + G(q1)^T mu,
 * G(q1) W (p1 - shift) + g_t(q1) = 0 (Andersen 1983; Leimkuhler & Skeel 1994; HLW VII.1.4).
 * SHAKE leaves the last term out (Ryckaert, Ciccotti & Berendsen 1977). F = L_q + f; an f that
 * sees v is taken at v = (q1 - q0)/h in both kicks, which keeps the rule symmetric, and v is
 * unknown like lambda. The linear systems are eliminated in the graph, where zeros are left out. */
#ifndef DM_RATTLE_H
#define DM_RATTLE_H

#include "integ/method/method.h"

/* Where the numbers of a step lie in its buffer: what `end` writes comes first. */
typedef struct {
    uint32_t n, m;                      /* dim Q, constraints */
    int drags;                          /* f sees v */
    uint32_t nonzeros;                  /* of G */
    uint32_t p, low_q, low_p, force, G; /* q is at 0 */
    uint32_t guess;                     /* of lambda */
    uint32_t g;                         /* at q, for the record */
    uint32_t h, half, t0, t;            /* t at the end of the step */
    uint32_t unit;                      /* 1/h over the square of each row of G at the start */
    /* iterates of q1 (of v where f sees v) and lambda, what `first` and `newton` write */
    uint32_t y, lambda;
    /* squares: of the last two changes of y, of y; of the volume that the rows of G span, det(G W
     * G0^T) with each row in its unit; the least |y_c| */
    uint32_t norms;
    uint32_t size;
} dm_rattle_layout;

enum { DM_RATTLE_NORMS = 5 };

/* Each takes a whole buffer. */
typedef struct {
    dm_kernel begin;  /* F and G at q, t */
    dm_kernel first;  /* kick, lambda guessed, two Newton iterations: y, lambda, norms */
    dm_kernel newton; /* one more: the same outputs */
    dm_kernel end;    /* q, p, their low parts, F, G, guess, g at the end of the step */
} dm_rattle_kernels;

dm_rattle_layout dm_rattle_lay_out(const dm_model *m);

/* Make them, or find them with the model (cache.h). */
dm_status dm_rattle_build(dm_rattle_kernels *out, const dm_model *m, int shake);

#endif
