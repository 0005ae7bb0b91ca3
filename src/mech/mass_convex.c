#include "mech/mass_convex.h"

#include "algebra/compact.h"
#include "algebra/extremum.h"
#include "linalg/signature.h"
#include "mech/mass_bounds.h"

#include <math.h>

/* What is read off L in a graph of its own: degrees in v, MOST_DEGREE and more as one, and bounds
 * of all nodes for any state. */
enum { MOST_DEGREE = 3, MOST_FORMS = 24 };

typedef struct {
    const dm_graph *g;
    uint32_t first, velocities; /* v are so many inputs, from that one on */
    unsigned char *degree;
    dm_interval *value;
    /* the form: w_i, whose squares stand in L, and c_ij[count*count], of MOST_FORMS in a row */
    uint32_t count;
    dm_node w[MOST_FORMS];
    dm_interval c[MOST_FORMS][MOST_FORMS];
} reading;

static unsigned char lesser(int degree) {
    return (unsigned char)(degree < MOST_DEGREE ? degree : MOST_DEGREE);
}

/* Of a power: k degrees where k is 1 or 2. */
static int of_power(const reading *r, const dm_expr *e) {
    const dm_expr *k = dm_graph_at(r->g, e->as.arg[1]);
    const int degree = r->degree[e->as.arg[0]];
    const int low = k->op == DM_OP_CONSTANT && (k->as.value == 1.0 || k->as.value == 2.0);
    return degree ? low ? degree * (int)k->as.value : MOST_DEGREE : r->degree[e->as.arg[1]];
}

static int degree_of(const reading *r, const dm_expr *e) {
    int all[3] = {0, 0, 0}, most = 0;
    for (int i = 0; i < dm_op_operands(e->op); i++) {
        all[i] = r->degree[e->as.arg[i]];
        most = all[i] > most ? all[i] : most;
    }
    switch (e->op) {
    case DM_OP_INPUT:
        return r->first <= e->as.input && e->as.input - r->first < r->velocities;
    case DM_OP_NEG:
    case DM_OP_ADD:
    case DM_OP_SUB:
        return most;
    case DM_OP_MUL:
        return all[0] + all[1];
    case DM_OP_DIV:
        return all[1] ? MOST_DEGREE : all[0];
    case DM_OP_POW:
        return of_power(r, e);
    default:
        return most ? MOST_DEGREE : 0;
    }
}

/* The w_i that a node is; count: none. */
static uint32_t find_form(const reading *r, dm_node at) {
    uint32_t i = 0;
    while (i < r->count && r->w[i] != at) i++;
    return i;
}

/* Takes the outermost factor that does not depend on v off a node, times *c; 0: there is none. */
static int strip(const reading *r, dm_node *at, dm_interval *c) {
    const dm_expr *e = dm_graph_at(r->g, *at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    const int product = e->op == DM_OP_MUL;
    if (e->op == DM_OP_NEG)
        *c = dm_interval_negative(*c), *at = a;
    else if (product && r->degree[b] && !r->degree[a])
        *c = dm_interval_multiply(*c, r->value[a]), *at = b;
    else if (product && r->degree[a] && !r->degree[b])
        *c = dm_interval_multiply(*c, r->value[b]), *at = a;
    else if (e->op == DM_OP_DIV && r->degree[a] && !r->degree[b])
        *c = dm_interval_divide(*c, r->value[b]), *at = a;
    else
        return 0;
    return 1;
}

static void add_to(dm_interval *sum, dm_interval c) {
    *sum = dm_interval_add(*sum, c);
}

/* c w w; 0: there are too many w */
static int add_square(reading *r, dm_node w, dm_interval c) {
    const uint32_t i = find_form(r, w);
    if (i == MOST_FORMS) return 0;
    if (i == r->count) {
        r->w[r->count++] = w;
        for (uint32_t k = 0; k <= i; k++) r->c[i][k] = r->c[k][i] = (dm_interval){0.0, 0.0};
    }
    add_to(&r->c[i][i], c);
    return 1;
}

/* Down to a w_i whose square is there; count: it holds none. */
static uint32_t form_of(const reading *r, dm_node at, dm_interval *c) {
    uint32_t i = find_form(r, at);
    while (i == r->count && strip(r, &at, c)) i = find_form(r, at);
    return i;
}

/* c a b, of first degree each: a square, where they are one without their factors, is for the first
 * pass, others are for the second one, which knows the squares. */
static int add_product(reading *r, dm_node a, dm_node b, dm_interval c, int pass) {
    dm_node one = a, other = b;
    dm_interval whole = c;
    while (a != b && strip(r, &one, &whole)) continue;
    while (a != b && strip(r, &other, &whole)) continue;
    if (one == other) return pass ? 1 : add_square(r, one, whole);
    if (!pass) return 1;
    const uint32_t i = form_of(r, a, &c), j = form_of(r, b, &c);
    if (i == r->count || j == r->count) return 0;
    const dm_interval half = dm_interval_multiply(c, (dm_interval){0.5, 0.5});
    if (i == j)
        add_to(&r->c[i][i], c);
    else
        add_to(&r->c[i][j], half), add_to(&r->c[j][i], half);
    return 1;
}

/* Adds c times a node to the form; 0: it is not of that kind. */
static int collect(reading *r, dm_node at, dm_interval c, int pass) {
    if (r->degree[at] <= 1) return 1;
    while (strip(r, &at, &c)) continue;
    const dm_expr *e = dm_graph_at(r->g, at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    switch (e->op) {
    case DM_OP_ADD:
        return collect(r, a, c, pass) && collect(r, b, c, pass);
    case DM_OP_SUB:
        return collect(r, a, c, pass) && collect(r, b, dm_interval_negative(c), pass);
    case DM_OP_POW:
        return r->degree[a] == 1 && r->degree[at] == 2 && add_product(r, a, a, c, pass);
    case DM_OP_MUL:
        return r->degree[a] == 1 && r->degree[b] == 1 && add_product(r, a, b, c, pass);
    default:
        return 0;
    }
}

/* Is no value of (c_ij) negative? Of w_i that stand alone, by their squares; of others together. */
static int is_positive(const reading *r) {
    double C[MOST_FORMS * MOST_FORMS];
    uint32_t together[MOST_FORMS], m = 0;
    for (uint32_t i = 0; i < r->count; i++) {
        int alone = 1;
        for (uint32_t j = 0; j < r->count; j++)
            alone &= i == j || (r->c[i][j].lo == 0.0 && r->c[i][j].hi == 0.0);
        if (!(r->c[i][i].lo >= 0.0)) return 0;
        if (!alone) together[m++] = i;
    }
    for (uint32_t k = 0; k < m * m; k++) {
        const dm_interval c = r->c[together[k / m]][together[k % m]];
        C[k] = k / m == k % m ? c.lo : fmax(fabs(c.lo), fabs(c.hi));
    }
    return !m || dm_surely_positive(C, m);
}

/* In so many inputs of g, from one on. */
static int is_convex(dm_graph *g, dm_node L, uint32_t first, uint32_t velocities, dm_arena *arena) {
    dm_node alone;
    reading *r = dm_arena_take(arena, sizeof *r);
    if (!r) return 0;
    *r = (reading){.g = dm_graph_copy(g, &L, 1, &alone), .first = first, .velocities = velocities};
    const uint32_t size = r->g ? dm_graph_size(r->g) : 0, inputs = dm_graph_inputs(g);
    r->degree = dm_arena_take(arena, size + 1);
    r->value = dm_arena_take(arena, ((size_t)size + inputs) * sizeof *r->value);
    if (!r->g || !r->degree || !r->value || size > DM_MASS_MOST_NODES) return 0;
    dm_interval *in = r->value + size;
    for (uint32_t i = 0; i < inputs; i++) in[i] = (dm_interval)DM_ANYWHERE;
    dm_bounds(r->g, in, r->value);
    for (dm_node i = 0; i < size; i++) r->degree[i] = lesser(degree_of(r, dm_graph_at(r->g, i)));
    for (int pass = 0; pass < 2; pass++)
        if (!collect(r, alone, (dm_interval){1.0, 1.0}, pass)) return 0;
    return is_positive(r);
}

/* What is least over y of an f(x, y) convex in both is convex in x (ensembles of reduced systems in
 * docs/benchmarks/reduction.md). */
int dm_mass_is_convex(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena) {
    const dm_extremum *e = dm_extremum_find(g, L);
    if (e && e->n == 2 * n) return is_convex(e->of, e->f, n, n + e->m, arena);
    return is_convex(g, L, n, n, arena);
}
