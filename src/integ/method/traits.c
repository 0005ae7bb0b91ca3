#include "integ/method/traits.h"

#include "integ/method/method.h"
#include "integ/method/stage_table.h"

#include <math.h>

static const long double SAME = 1e-14L;

/* nodes and weights are their own mirror image; a tableau: a_ij + a_(s+1-i)(s+1-j) = b_j (HLW
 * V.2.1) */
static int is_symmetric(const dm_galerkin *g) {
    const int r = g->q.r;
    for (int i = 0; i < r; i++) {
        if (fabsl(g->q.c[i] + g->q.c[r - 1 - i] - 1.0L) > SAME ||
            fabsl(g->q.b[i] - g->q.b[r - 1 - i]) > SAME)
            return 0;
        for (int j = 0; g->tableau && j < r; j++)
            if (fabsl(g->a[i][j] + g->a[r - 1 - i][r - 1 - j] - g->q.b[j]) > SAME) return 0;
    }
    return 1;
}

unsigned dm_rule_traits(const dm_rule *rule) {
    const dm_method *method = rule->method;
    dm_galerkin g = {.s = 0};
    if (!method->basis) return method->traits;
    method->basis(&g, rule);
    return method->traits | (g.s && is_symmetric(&g) ? DM_SYMMETRIC : 0);
}
