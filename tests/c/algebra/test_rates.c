/* bounds of how fast an operation changes, how much it bends along a line, and of what its operands
 * count for, hold every slope and second derivative in a box, and close in on them */
#include "algebra/derive.h"
#include "graph/bounds.h"

#include "check.h"
#include "random_graph.h"

enum { INPUTS = 3, BOXES = 60, POINTS = 20, MOST = 200 };

/* f(x, y, z) = op(x, y, z) for operands between lo and hi; is its slope bounded in small boxes? */
typedef struct {
    dm_op op;
    int bounded;
    double lo, hi, power; /* power: x^power */
} row;

static const row rows[] = {
    {DM_OP_NEG, 1, -2, 2, 0},     {DM_OP_ABS, 1, -2, 2, 0},      {DM_OP_SQRT, 1, 0.1, 3, 0},
    {DM_OP_RSQRT, 1, 0.1, 3, 0},  {DM_OP_RSQRT3, 1, 0.1, 3, 0},  {DM_OP_EXP, 1, -2, 2, 0},
    {DM_OP_LOG, 1, 0.1, 3, 0},    {DM_OP_SIN, 1, -4, 4, 0},      {DM_OP_COS, 1, -4, 4, 0},
    {DM_OP_TAN, 1, -1.4, 1.4, 0}, {DM_OP_ASIN, 0, -0.9, 0.9, 0}, {DM_OP_ACOS, 0, -0.9, 0.9, 0},
    {DM_OP_ATAN, 1, -3, 3, 0},    {DM_OP_SINH, 1, -2, 2, 0},     {DM_OP_COSH, 1, -2, 2, 0},
    {DM_OP_TANH, 1, -2, 2, 0},    {DM_OP_ADD, 1, -2, 2, 0},      {DM_OP_SUB, 1, -2, 2, 0},
    {DM_OP_MUL, 1, -2, 2, 0},     {DM_OP_DIV, 1, 0.2, 3, 0},     {DM_OP_DIV, 1, -3, -0.2, 0},
    {DM_OP_POW, 1, 0.2, 3, 2.5},  {DM_OP_POW, 1, -3, -0.2, -3},  {DM_OP_POW, 1, -2, 2, 4},
    {DM_OP_ATAN2, 0, 0.2, 3, 0},  {DM_OP_MIN, 1, -2, 2, 0},      {DM_OP_MAX, 1, -2, 2, 0},
    {DM_OP_WHERE, 1, -2, 2, 0},   {DM_OP_FMA, 1, -2, 2, 0},      {DM_OP_FMS, 1, -2, 2, 0},
    {DM_OP_FNMA, 1, -2, 2, 0},
};

static dm_graph *g;
static dm_node x[INPUTS], f, slope[INPUTS], second[INPUTS * INPUTS];
static const double along[INPUTS] = {0.7, -1.1, 0.4};   /* a direction */
static const double turning[INPUTS] = {-0.3, 2.1, 0.9}; /* the second derivatives of a curve */

/* between 0 and 1 */
static double uniform(uint32_t k, uint32_t i) {
    return fmod(0.5 + 0.618033988749895 * k + 0.7548776662466927 * i * (1.0 + 0.1 * k), 1.0);
}

static double middle(dm_interval a) {
    return 0.5 * (a.lo + a.hi);
}

/* the slopes at a point of the box, which are those of the graph */
static void slopes_at(double d[INPUTS], const dm_interval *box, uint32_t k, uint32_t i) {
    dm_interval in[INPUTS], value[MOST];
    for (uint32_t a = 0; a < INPUTS; a++) {
        const double at = box[a].lo + uniform(k + 7 * a, i) * (box[a].hi - box[a].lo);
        in[a] = (dm_interval){at, at};
    }
    dm_bounds(g, in, value);
    for (uint32_t a = 0; a < INPUTS; a++) d[a] = slope[a] ? middle(value[slope[a]]) : 0.0;
}

/* the second derivative along the direction at a point of the box */
static double second_at(const dm_interval *box, uint32_t k, uint32_t i) {
    dm_interval in[INPUTS], value[MOST];
    double sum = 0.0;
    for (uint32_t a = 0; a < INPUTS; a++) {
        const double at = box[a].lo + uniform(k + 7 * a, i) * (box[a].hi - box[a].lo);
        in[a] = (dm_interval){at, at};
    }
    dm_bounds(g, in, value);
    for (uint32_t a = 0; a < INPUTS * INPUTS; a++)
        if (second[a]) sum += along[a / INPUTS] * along[a % INPUTS] * middle(value[second[a]]);
    return sum;
}

/* the second derivative along the curve that goes that way at a point of the box */
static double turned_at(const dm_interval *box, uint32_t k, uint32_t i) {
    double d[INPUTS], sum = second_at(box, k, i);
    slopes_at(d, box, k, i);
    for (uint32_t a = 0; a < INPUTS; a++) sum += turning[a] * d[a];
    return sum;
}

/* of a line through the box, and of a curve; value[] of it */
static void look_at_bend(const row *r, const dm_interval *box, const dm_interval *value, uint32_t k,
                         double width) {
    dm_interval in[INPUTS], bend_in[INPUTS], rate[MOST], bend[MOST], turned[MOST];
    for (uint32_t a = 0; a < INPUTS; a++) {
        in[a] = (dm_interval){along[a], along[a]};
        bend_in[a] = (dm_interval){turning[a], turning[a]};
    }
    dm_bounds_rate(g, in, value, rate);
    dm_bounds_bend(g, NULL, value, rate, bend);
    dm_bounds_bend(g, bend_in, value, rate, turned);
    for (uint32_t i = 0; i < POINTS; i++) {
        const double d = second_at(box, k, i), slack = 1e-11 * (1.0 + fabs(d));
        const double e = turned_at(box, k, i), more = 1e-11 * (1.0 + fabs(e));
        CHECK(bend[f].lo <= d + slack && bend[f].hi >= d - slack);
        CHECK(turned[f].lo <= e + more && turned[f].hi >= e - more);
        if (r->bounded && width < 1e-6 && bend[f].hi < INFINITY)
            CHECK_NEAR(middle(bend[f]), d, 1e-3 * (1.0 + fabs(d)));
    }
}

/* in a box of that width */
static void look(const row *r, uint32_t k, double width) {
    dm_interval box[INPUTS], value[MOST], rate[MOST], in[INPUTS];
    double weight[MOST] = {0.0}, d[INPUTS];
    for (uint32_t a = 0; a < INPUTS; a++) {
        box[a].lo = r->lo + uniform(k, a) * (r->hi - r->lo - width);
        box[a].hi = box[a].lo + width;
    }
    dm_bounds(g, box, value);
    weight[f] = 1.0;
    dm_bounds_weight(g, value, weight);
    look_at_bend(r, box, value, k, width);
    for (uint32_t a = 0; a < INPUTS; a++) {
        for (uint32_t b = 0; b < INPUTS; b++) in[b] = (dm_interval){a == b, a == b};
        dm_bounds_rate(g, in, value, rate);
        for (uint32_t i = 0; i < POINTS; i++) {
            slopes_at(d, box, k, i);
            const double slack = 1e-12 * (1.0 + fabs(d[a]));
            CHECK(rate[f].lo <= d[a] + slack && rate[f].hi >= d[a] - slack);
            CHECK(weight[x[a]] >= fabs(d[a]) - slack);
        }
        if (!r->bounded || width > 1e-6) continue;
        CHECK_NEAR(middle(rate[f]), d[a], 1e-4 * (1.0 + fabs(d[a])));
        if (r->op != DM_OP_MIN && r->op != DM_OP_MAX) /* which count for both operands */
            CHECK_NEAR(weight[x[a]], fabs(d[a]), 1e-4 * (1.0 + fabs(d[a])));
    }
}

static void operations(void) {
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const row *r = rows + k;
        const int failures = check_failures;
        dm_arena arena = new_arena();
        g = dm_graph_new(&arena, INPUTS);
        for (uint32_t a = 0; a < INPUTS; a++) x[a] = dm_input(g, a);
        f = r->op == DM_OP_POW ? dm_apply(g, r->op, x[0], dm_constant(g, r->power), 0)
                               : dm_apply(g, r->op, x[0], dm_op_operands(r->op) > 1 ? x[1] : 0,
                                          dm_op_operands(r->op) > 2 ? x[2] : 0);
        dm_hessian(g, f, 0, INPUTS, slope, second);
        CHECK(dm_graph_status(g) == DM_OK && dm_graph_size(g) <= MOST);
        for (uint32_t i = 0; i < BOXES; i++)
            look(r, i, i % 2 ? 1e-7 : 0.4 * (r->hi - r->lo) * uniform(i, 9));
        if (check_failures > failures) printf("# of operation %d\n", (int)r->op);
        dm_arena_release(&arena);
    }
}

int main(void) {
    RUN(operations, "rates, bends and weights of all operations hold their derivatives");
    return check_finish();
}
