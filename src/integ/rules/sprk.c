#include "integ/rules/sprk.h"

#include "integ/stage/stage.h"

#include <math.h>
#include <string.h>

static const long double SAME = 1e-13L; /* tableaus are given as doubles */

/* ---- tableaus ---- */

/* From b_i A_ij + B_j a_ji = b_i B_j with B = b. */
void dm_tableau_partner(dm_tableau *t) {
    for (int i = 0; i < t->s; i++) {
        t->B[i] = t->b[i];
        for (int j = 0; j < t->s; j++) t->A[i][j] = t->b[j] * (1.0L - t->a[j][i] / t->b[i]);
    }
}

/* Where it is worst, for the words of an error. */
long double dm_tableau_defect(const dm_tableau *t, int *i, int *j) {
    long double worst = 0.0L;
    *i = *j = 0;
    for (int k = 0; k < t->s; k++)
        for (int l = 0; l < t->s; l++) {
            const long double d = t->b[k] * t->A[k][l] + t->B[l] * t->a[l][k] - t->b[k] * t->B[l];
            if (fabsl(d) <= fabsl(worst)) continue;
            worst = d;
            *i = k, *j = l;
        }
    return worst;
}

/* m_ij = w_j up to the diagonal (whole = 1) or below it, else 0 */
static int is_triangle(const dm_tableau *t, const long double m[DM_SPRK_STAGES][DM_SPRK_STAGES],
                       const long double *w, int whole) {
    for (int i = 0; i < t->s; i++)
        for (int j = 0; j < t->s; j++) {
            const long double want = j < i + whole ? w[j] : 0.0L;
            if (fabsl(m[i][j] - want) > SAME) return 0;
        }
    return 1;
}

/* drift b_1, kick B_1, drift b_2 ...; or kick B_1, drift b_1, ..., for which a drift of length
 * zero comes first, since a table that begins with a kick takes its force from the end of the
 * step before */
static int split(dm_splitting *out, const dm_tableau *t) {
    const int drift_first = is_triangle(t, t->a, t->b, 1) && is_triangle(t, t->A, t->B, 0);
    const int kick_first = is_triangle(t, t->a, t->b, 0) && is_triangle(t, t->A, t->B, 1);
    const int before = kick_first;
    if ((!drift_first && !kick_first) || t->s + before > DM_SPLITTING_STAGES) return 0;
    *out = (dm_splitting){.stages = t->s + before};
    for (int i = 0; i < t->s; i++) {
        out->a[i + before] = (double)t->b[i];
        out->b[i + 1] = (double)t->B[i];
    }
    return 1;
}

/* b = B, and every stage counts */
static int stage(dm_galerkin *g, const dm_tableau *t) {
    for (int i = 0; i < t->s; i++)
        if (fabsl(t->b[i] - t->B[i]) > SAME || fabsl(t->b[i]) < SAME) return 0;
    *g = (dm_galerkin){.s = t->s, .tableau = 1};
    g->q.r = t->s;
    for (int i = 0; i < t->s; i++) {
        g->q.b[i] = t->b[i];
        g->q.c[i] = g->node[i] = t->c[i];
        memcpy(g->a[i], t->a[i], sizeof g->a[i]);
    }
    return 1;
}

/* Its order is measured: as a rule of stages on any L, else on separable ones. */
int dm_sprk_of(dm_sprk *out, const dm_tableau *t) {
    *out = (dm_sprk){.stages = t->s};
    out->staged = stage(&out->g, t);
    out->split = split(&out->table, t);
    out->order = dm_tableau_order(t, !out->staged);
    return out->staged || out->split;
}

/* ---- pairs with names ---- */

typedef struct {
    const char *name;
    const char *quadrature;
    int partner; /* positions by the partner of collocation, momenta by collocation */
    int lost;    /* order 2 s - lost */
} pair;

static const pair pairs[] = {{"gauss", "gauss", 0, 0},
                             {"radau-2a", "radau", 0, 1},
                             {"radau-1a", "radau-left", 1, 1},
                             {"lobatto-3a-3b", "lobatto", 0, 2},
                             {"lobatto-3b-3a", "lobatto", 1, 2}};

/* The row of the named pair; NULL where the arguments do not fit. */
static const pair *find(const dm_rule *rule) {
    if (rule->count != 2 || !rule->arg[0].rule || rule->arg[1].rule) return NULL;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (strcmp(pairs[i].name, rule->arg[0].rule->name) == 0 && !rule->arg[0].rule->count)
            return pairs + i;
    return NULL;
}

/* Of the data, or the second argument. */
static int stages(const dm_rule *rule) {
    return rule->data ? ((const dm_sprk *)rule->data)->stages : (int)rule->arg[1].number;
}

/* a'_ij = b_j (1 - a_ji / b_i) */
static void take_partner(dm_galerkin *g) {
    long double value[DM_QUADRATURE_NODES], a[DM_QUADRATURE_NODES][DM_QUADRATURE_NODES];
    const dm_quadrature *q = &g->q;
    for (int i = 0; i < q->r; i++) dm_lagrange(value, a[i], q->c, q->r, q->c[i]);
    g->tableau = 1;
    for (int i = 0; i < q->r; i++)
        for (int j = 0; j < q->r; j++) {
            const long double part = 1.0L - a[j][i] / q->b[i];
            g->a[i][j] = fabsl(part) < 1e-17L ? 0.0L : q->b[j] * part;
        }
}

/* Collocation at the nodes of the pair, with the partner for positions where the pair says so; data
 * without a basis have s = 0. */
static void basis(dm_galerkin *g, const dm_rule *rule) {
    dm_quadrature q;
    if (rule->data) {
        *g = ((const dm_sprk *)rule->data)->g;
        return;
    }
    dm_quadrature_find(find(rule)->quadrature)->fill(&q, stages(rule));
    dm_galerkin_collocation(g, &q);
    if (find(rule)->partner) take_partner(g);
}

/* kicks and drifts instead of stages */
static int splitting(dm_splitting *out, const dm_rule *rule) {
    const dm_sprk *data = rule->data;
    if (!data || !data->split) return 0;
    if (out) *out = data->table;
    return 1;
}

/* ---- the method ---- */

static const char *check(const dm_rule *rule) {
    if (rule->data) return NULL; /* checked where it was made */
    const pair *p = find(rule);
    if (!p)
        return "sprk takes a pair (gauss, radau-1a, radau-2a, lobatto-3a-3b or lobatto-3b-3a) and "
               "a number of stages; any other: dm.sprk{a =, b =}";
    const double s = rule->arg[1].number;
    const int least = dm_quadrature_find(p->quadrature)->least;
    if (!(s >= least && s <= DM_SPRK_STAGES) || s != floor(s))
        return "a pair takes a whole number of stages from 1 (Lobatto: 2) to 32";
    return NULL;
}

static int order(const dm_rule *rule) {
    if (rule->data) return ((const dm_sprk *)rule->data)->order;
    return 2 * stages(rule) - find(rule)->lost;
}

const dm_method dm_method_sprk = {
    .name = "sprk",
    .signature = "sprk(pair, s)",
    .doc =
        "Symplectic partitioned Runge-Kutta pair with s stages: gauss (order 2 s), radau-2a and "
        "radau-1a (2 s - 1), lobatto-3a-3b and lobatto-3b-3a (2 s - 2); the name before says how "
        "positions are found, momenta follow from b_i A_ij + b_j a_ji = b_i b_j; s n unknowns a "
        "step. Tableaus of one's own: dm.sprk. HLW VI.4.2, VI.6.4, Jay 1996, Leok 2.4.",
    .orders = "gauss 2 s, radau 2 s - 1, lobatto 2 s - 2",
    .stages = "s",
    .cost = "s n unknowns",
    .instances = "sprk(gauss, 2):2:0; sprk(radau-2a, 2):2:0; sprk(radau-1a, 1):1:0; sprk(radau-1a, "
                 "2):2:0; sprk(radau-1a, 3):3:0; sprk(lobatto-3a-3b, 3):3:0; sprk(lobatto-3b-3a, "
                 "2):2:0; sprk(lobatto-3b-3a, 3):3:0; sprk(lobatto-3b-3a, 4):4:0",
    .traits = DM_SYMPLECTIC,
    .check = check,
    .order = order,
    .engine = &dm_engine_stage,
    .basis = basis,
    .splitting = splitting,
};
