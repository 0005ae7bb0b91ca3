/*
** Derivatives as nodes. A reverse sweep carries df/dn ("bar") from f down to the inputs,
*a
** forward sweep dn/dx ("dot") from one input up to the results. Both use the same local
** rules; results reuse the node itself where they can: d sqrt(u) = du / (2 sqrt(u)).
** A branch that is not taken adds nothing, even where its derivative is not finite.
*/
#include "expr/derive.h"

#include "expr/analyse.h"
#include "expr/compact.h"
#include "expr/derive_inside.h"
#include "expr/nodes.h"

#include <string.h>

static dm_node one(dm_graph *g) {
    return dm_constant(g, 1.0);
}

static dm_node half(dm_graph *g, dm_node a) {
    const dm_node c = dm_constant(g, 0.5);
    return dm_mul(g, c, a);
}

static dm_node one_plus(dm_graph *g, dm_node a) {
    return dm_add(g, one(g), a);
}

static dm_node square(dm_graph *g, dm_node a) {
    return dm_mul(g, a, a);
}

static dm_node inverse(dm_graph *g, dm_node a) {
    return dm_div(g, one(g), a);
}

/* a + b for derivatives: what stands under the same condition stays together, so that the side that is
** not taken stays zero */
dm_node dm_derive_join(dm_graph *g, dm_node a, dm_node b) {
    const dm_expr x = *dm_at(g, a), y = *dm_at(g, b);
    if (!a || !b) return a ? a : b;
    if (x.op != DM_OP_WHERE || y.op != DM_OP_WHERE || x.as.arg[0] != y.as.arg[0])
        return dm_add(g, a, b);
    const dm_node yes = dm_derive_join(g, x.as.arg[1], y.as.arg[1]);
    const dm_node no = dm_derive_join(g, x.as.arg[2], y.as.arg[2]);
    return dm_apply(g, DM_OP_WHERE, x.as.arg[0], yes, no);
}

enum { DEEPEST_BRANCH = 12 };

/* can branches make n zero, however deep they stand in it? */
static int vanishes(const dm_graph *g, dm_node n, int depth) {
    const dm_expr *e = dm_at(g, n);
    if (n == 0) return 1;
    if (depth == 0) return 0;
    if (e->op == DM_OP_WHERE)
        return vanishes(g, e->as.arg[1], depth - 1) ||
               vanishes(g, e->as.arg[2], depth - 1);
    return e->op == DM_OP_ADD && vanishes(g, e->as.arg[0], depth - 1) &&
           vanishes(g, e->as.arg[1], depth - 1);
}

/* factor * slope; a factor that a branch makes zero stays zero whatever the slope is */
dm_node dm_derive_times(dm_graph *g, dm_node factor, dm_node slope) {
    const dm_expr e = *dm_at(g, factor);
    if (factor == 0) return 0;
    if (!vanishes(g, factor, DEEPEST_BRANCH)) return dm_mul(g, factor, slope);
    const int is_sum = e.op == DM_OP_ADD;
    const dm_node first = dm_derive_times(g, e.as.arg[is_sum ? 0 : 1], slope);
    const dm_node second = dm_derive_times(g, e.as.arg[is_sum ? 1 : 2], slope);
    return is_sum ? dm_derive_join(g, first, second)
                  : dm_apply(g, DM_OP_WHERE, e.as.arg[0], first, second);
}

/* 1 / sqrt(1 - a^2) */
static dm_node arcsine_slope(dm_graph *g, dm_node a) {
    const dm_node a2 = square(g, a), u = dm_sub(g, one(g), a2);
    return inverse(g, dm_apply(g, DM_OP_SQRT, u, 0, 0));
}

/* d a^b / da = b a^(b-1); d a^b / db = a^b log(a), which is 0 at a = 0 for b > 0 */
static dm_node power_slope(dm_graph *g, dm_node n, int k) {
    const dm_node a = dm_at(g, n)->as.arg[0], b = dm_at(g, n)->as.arg[1];
    if (k == 0) return dm_mul(g, b, dm_power(g, a, dm_sub(g, b, one(g))));
    const dm_node size = dm_apply(g, DM_OP_ABS, a, 0, 0);
    const dm_node safe = dm_apply(g, DM_OP_WHERE, size, a, one(g));
    return dm_mul(g, n, dm_apply(g, DM_OP_LOG, safe, 0, 0));
}

/* d atan2(y, x) = (x dy - y dx) / (x^2 + y^2) */
static dm_node angle_slope(dm_graph *g, dm_node y, dm_node x, int k) {
    const dm_node x2 = square(g, x), y2 = square(g, y);
    const dm_node w = inverse(g, dm_add(g, x2, y2));
    return k == 0 ? dm_mul(g, x, w) : dm_neg(g, dm_mul(g, y, w));
}

/* d (a/b) / da = 1/b, d (a/b) / db = -(a/b) / b */
static dm_node quotient_slope(dm_graph *g, dm_node n, int k) {
    const dm_node w = inverse(g, dm_at(g, n)->as.arg[1]);
    return k == 0 ? w : dm_neg(g, dm_mul(g, n, w));
}

/* dn / d(operand k) for operations of one operand */
static dm_node slope1(dm_graph *g, dm_node n) {
    const dm_expr e = *dm_at(g, n);
    const dm_node a = e.as.arg[0];
    switch (e.op) {
    case DM_OP_NEG:
        return dm_constant(g, -1.0);
    case DM_OP_ABS:
        return dm_apply(g, DM_OP_SIGN, a, 0, 0);
    case DM_OP_SQRT:
        return half(g, inverse(g, n));
    case DM_OP_RSQRT:
        return dm_neg(g, half(g, dm_mul(g, n, square(g, n))));
    case DM_OP_RSQRT3: /* -3/2 n / a */
        return dm_mul(g, dm_mul(g, dm_constant(g, -1.5), n),
                      square(g, dm_apply(g, DM_OP_RSQRT, a, 0, 0)));
    case DM_OP_EXP:
        return n;
    case DM_OP_LOG:
        return inverse(g, a);
    case DM_OP_SIN:
        return dm_apply(g, DM_OP_COS, a, 0, 0);
    case DM_OP_COS:
        return dm_neg(g, dm_apply(g, DM_OP_SIN, a, 0, 0));
    case DM_OP_TAN:
        return one_plus(g, square(g, n));
    case DM_OP_ASIN:
        return arcsine_slope(g, a);
    case DM_OP_ACOS:
        return dm_neg(g, arcsine_slope(g, a));
    case DM_OP_ATAN:
        return inverse(g, one_plus(g, square(g, a)));
    case DM_OP_SINH:
        return dm_apply(g, DM_OP_COSH, a, 0, 0);
    case DM_OP_COSH:
        return dm_apply(g, DM_OP_SINH, a, 0, 0);
    case DM_OP_TANH:
        return one_plus(g, dm_neg(g, square(g, n)));
    default:
        return 0; /* sign: constant but for its jump */
    }
}

/* dn / d(operand k), for all operations but those that choose */
static dm_node slope(dm_graph *g, dm_node n, int k) {
    const dm_expr e = *dm_at(g, n);
    switch (e.op) {
    case DM_OP_ADD:
        return one(g);
    case DM_OP_SUB:
        return dm_constant(g, k == 0 ? 1.0 : -1.0);
    case DM_OP_MUL:
        return e.as.arg[1 - k];
    case DM_OP_FMA:
        return k == 2 ? one(g) : e.as.arg[1 - k];
    case DM_OP_FMS:
        return k == 2 ? dm_constant(g, -1.0) : e.as.arg[1 - k];
    case DM_OP_FNMA:
        return k == 2 ? one(g) : dm_neg(g, e.as.arg[1 - k]);
    case DM_OP_DIV:
        return quotient_slope(g, n, k);
    case DM_OP_POW:
        return power_slope(g, n, k);
    case DM_OP_ATAN2:
        return angle_slope(g, e.as.arg[0], e.as.arg[1], k);
    default:
        return slope1(g, n);
    }
}

/* which operand min, max and where give: where(condition, yes, no) */
typedef struct {
    dm_node condition;
    int yes, no; /* numbers of the operands */
} choice;

static int is_choice(dm_graph *g, dm_node n, choice *out) {
    const dm_expr e = *dm_at(g, n);
    const dm_node a = e.as.arg[0], b = e.as.arg[1];
    if (e.op == DM_OP_MIN)
        *out = (choice){dm_sub(g, a, b), 1, 0};
    else if (e.op == DM_OP_MAX)
        *out = (choice){dm_sub(g, b, a), 1, 0};
    else if (e.op == DM_OP_WHERE)
        *out = (choice){a, 1, 2};
    else
        return 0;
    return 1;
}

static int is_sum(dm_op op) {
    return op == DM_OP_ADD || op == DM_OP_SUB;
}

/* what operand k gets of, or gives to, a derivative `factor` at n */
static dm_node share(dm_graph *g, dm_node n, int k, dm_node factor) {
    choice c;
    const dm_op op = dm_at(g, n)->op;
    if (factor == 0) return 0;
    if (is_sum(op) && !vanishes(g, factor, DEEPEST_BRANCH))
        return op == DM_OP_SUB && k == 1 ? dm_neg(g, factor) : factor;
    if (!is_choice(g, n, &c)) return dm_derive_times(g, factor, slope(g, n, k));
    if (k == c.yes) return dm_apply(g, DM_OP_WHERE, c.condition, factor, 0);
    return k == c.no ? dm_apply(g, DM_OP_WHERE, c.condition, 0, factor) : 0;
}

typedef dm_derive_sweep sweep;

static int sweep_open(sweep *s, dm_graph *g, uint32_t first, uint32_t n) {
    s->first = first;
    s->n = n;
    s->room = dm_graph_size(g);
    s->d = dm_arena_take(g->arena, s->room * sizeof *s->d);
    s->active = dm_arena_take(g->arena, s->room);
    if (!s->d || !s->active) return dm_graph_fail(g, DM_NO_MEMORY), 0;
    return 1;
}

static int is_wanted_input(const sweep *s, const dm_expr *e) {
    return e->op == DM_OP_INPUT && e->as.input - s->first < s->n;
}

/* active: marked, and depending on the inputs first .. first+n-1 */
static void find_active(sweep *s, dm_graph *g, uint32_t end) {
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(g, n);
        uint8_t on = 0;
        if (dm_is_marked(g, n)) {
            on = (uint8_t)is_wanted_input(s, e);
            for (int k = 0; k < dm_arity(e->op); k++) on |= s->active[e->as.arg[k]];
        }
        s->active[n] = on;
        s->d[n] = 0;
    }
}

static int is_square(const dm_expr *e) {
    return e->op == DM_OP_MUL && e->as.arg[0] == e->as.arg[1];
}

/* operand k of n gets its share of d[n]; what is taken away need not be negated, nor a square looked at twice */
static void hand_down(sweep *s, dm_graph *g, dm_node n, int k) {
    const dm_expr e = *dm_at(g, n);
    const dm_node a = e.as.arg[k], held = s->d[a], factor = s->d[n];
    if (!s->active[a]) return;
    if (is_square(&e) && !vanishes(g, factor, DEEPEST_BRANCH)) {
        if (k == 0)
            s->d[a] = dm_derive_join(g, held, dm_mul(g, dm_add(g, factor, factor), a));
    } else if (e.op == DM_OP_SUB && k == 1 && held && !vanishes(g, factor, DEEPEST_BRANCH))
        s->d[a] = dm_sub(g, held, factor);
    else
        s->d[a] = dm_derive_join(g, held, share(g, n, k, factor));
}

/* out[n] = df/dx_i */
static void reverse(sweep *s, dm_graph *g, dm_node f, dm_node *out) {
    memset(out, 0, s->n * sizeof *out);
    const uint32_t end = dm_mark(g, &f, 1);
    find_active(s, g, end);
    s->roots = NULL;
    if (s->active[f]) s->d[f] = one(g);
    for (dm_node n = end; n-- > 0 && g->status == DM_OK;) {
        const dm_expr e = *dm_at(g, n);
        if (!s->active[n] || !s->d[n]) continue;
        if (e.op == DM_OP_INPUT) out[e.as.input - s->first] = s->d[n];
        if (e.op == DM_OP_ROOT || e.op == DM_OP_WITH) {
            dm_derive_root(s, g, n);
            continue;
        }
        for (int k = 0; k < dm_arity(e.op); k++) hand_down(s, g, n, k);
    }
}

/* d[n] = dn/dx_j for all active nodes */
static void forward(sweep *s, dm_graph *g, uint32_t end, uint32_t j) {
    for (dm_node n = 0; n < end && g->status == DM_OK; n++) {
        const dm_expr e = *dm_at(g, n);
        s->d[n] = 0;
        if (!s->active[n]) continue;
        if (e.op == DM_OP_INPUT) s->d[n] = e.as.input == s->first + j ? one(g) : 0;
        for (int k = 0; k < dm_arity(e.op); k++)
            s->d[n] = dm_derive_join(g, s->d[n], share(g, n, k, s->d[e.as.arg[k]]));
    }
}

/* the last gradient is asked for again by who compiles what somebody else has looked at */
static int is_last(const dm_graph *g, dm_node f, uint32_t first, uint32_t n) {
    const dm_gradient_kept *last = &g->gradient;
    return g->status == DM_OK && last->of && last->f == f && last->first == first &&
           last->n == n;
}

static void keep_gradient(dm_graph *g, dm_node f, uint32_t first, uint32_t n,
                          const dm_node *out) {
    dm_node *of = dm_arena_take(g->arena, n * sizeof *of);
    if (!of || g->status != DM_OK || g->verbatim) return;
    memcpy(of, out, n * sizeof *of);
    g->gradient = (dm_gradient_kept){f, first, n, of};
}

static void gradient_of(dm_graph *g, dm_node f, uint32_t first, uint32_t n,
                        dm_node *out) {
    sweep s;
    if (is_last(g, f, first, n)) {
        memcpy(out, g->gradient.of, n * sizeof *out);
        return;
    }
    memset(out, 0, n * sizeof *out);
    if (!sweep_open(&s, g, first, n)) return;
    reverse(&s, g, f, out);
    keep_gradient(g, f, first, n, out);
}

void dm_gradient(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *out) {
    gradient_of(g, dm_compact_source(g, f), first, n, out);
}

static void jacobian_by_rows(sweep *s, dm_graph *g, const dm_node *f, uint32_t m,
                             dm_node *out) {
    for (uint32_t i = 0; i < m; i++) reverse(s, g, f[i], out + (size_t)i * s->n);
}

static void jacobian_by_columns(sweep *s, dm_graph *g, const dm_node *f, uint32_t m,
                                dm_node *out) {
    const uint32_t end = dm_mark(g, f, m);
    find_active(s, g, end);
    for (uint32_t j = 0; j < s->n; j++) {
        forward(s, g, end, j);
        for (uint32_t i = 0; i < m; i++) out[(size_t)i * s->n + j] = s->d[f[i]];
    }
}

/* operations for f and its derivatives together: what a kernel of both has to do */
static uint32_t cost(dm_graph *g, dm_node *all, uint32_t m, const dm_node *d,
                     size_t count) {
    memcpy(all + m, d, count * sizeof *d);
    return dm_operations(g, all, m + (uint32_t)count);
}

void dm_jacobian(dm_graph *g, const dm_node *f, uint32_t m, uint32_t first, uint32_t n,
                 dm_node *out) {
    sweep s;
    const size_t count = (size_t)m * n;
    memset(out, 0, count * sizeof *out);
    dm_node *other = dm_arena_take(g->arena, (count + 1) * sizeof *other);
    dm_node *all = dm_arena_take(g->arena, (m + count + 1) * sizeof *all);
    if (!other || !all) dm_graph_fail(g, DM_NO_MEMORY);
    if (g->status != DM_OK || !sweep_open(&s, g, first, n)) return;
    memcpy(all, f, m * sizeof *all);
    jacobian_by_rows(&s, g, f, m, out);
    if (dm_has_roots(g, f, m)) return; /* whose rules are those of a reverse sweep */
    jacobian_by_columns(&s, g, f, m, other);
    if (g->status == DM_OK && cost(g, all, m, other, count) < cost(g, all, m, out, count))
        memcpy(out, other, count * sizeof *out);
}

/* copy one triangle over the other: the halves are equal, their expressions need not be
 */
static void mirror(dm_node *to, const dm_node *from, uint32_t n, int upper) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const int keep = upper ? i <= j : i >= j;
            to[i * n + j] = keep ? from[i * n + j] : from[j * n + i];
        }
}

/* best of the two triangles of `tried` and what *least belongs to */
static void keep_smaller(dm_graph *g, dm_node *best, uint32_t *least, dm_node *all,
                         const dm_node *tried, uint32_t n) {
    const size_t count = (size_t)n * n;
    for (int upper = 0; upper < 2; upper++) {
        mirror(all + n, tried, n, upper);
        const uint32_t now = dm_operations(g, all, n + (uint32_t)count);
        if (now >= *least) continue;
        *least = now;
        memcpy(best, all + n, count * sizeof *best);
    }
}

void dm_hessian(dm_graph *g, dm_node f, uint32_t first, uint32_t n, dm_node *gradient,
                dm_node *hessian) {
    sweep s;
    const size_t count = (size_t)n * n;
    uint32_t least = UINT32_MAX;
    memset(hessian, 0, count * sizeof *hessian);
    f = dm_compact_source(g, f);
    gradient_of(g, f, first, n, gradient);
    dm_node *tried = dm_arena_take(g->arena, (count + 1) * sizeof *tried);
    dm_node *all = dm_arena_take(g->arena, (n + count + 1) * sizeof *all);
    if (!tried || !all) dm_graph_fail(g, DM_NO_MEMORY);
    if (g->status != DM_OK || !sweep_open(&s, g, first, n)) return;
    memcpy(all, gradient, n * sizeof *all);
    jacobian_by_rows(&s, g, gradient, n, tried);
    keep_smaller(g, hessian, &least, all, tried, n);
    if (!dm_has_roots(g, gradient, n)) {
        jacobian_by_columns(&s, g, gradient, n, tried);
        keep_smaller(g, hessian, &least, all, tried, n);
    }
    if (g->status != DM_OK) memset(hessian, 0, count * sizeof *hessian);
}
