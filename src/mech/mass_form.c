#include "mech/mass_form.h"

#include <math.h>
#include <string.h>

/* products that are looked into for a cosine: their factors may share others, over and over */
enum { MOST_DEGREE = 3, VISITS = 20000, MOST_OPENED = 32 };

static const dm_interval ONE = {1.0, 1.0};

/* c times some nodes that are not bounded, and one cosine that is kept apart, if any */
typedef struct {
    dm_interval c;
    dm_node turn;
    uint32_t count, opened;
    dm_node part[2 * DM_FORM_PARTS]; /* so many while they are compared */
} coefficient;

/* ---- degrees ---- */

static unsigned char lesser(int degree) {
    return (unsigned char)(degree < MOST_DEGREE ? degree : MOST_DEGREE);
}

/* Of a power: k degrees where k is 1 or 2. */
static int of_power(const dm_form *f, const dm_expr *e) {
    const dm_expr *k = dm_graph_at(f->g, e->as.arg[1]);
    const int degree = f->degree[e->as.arg[0]];
    const int low = k->op == DM_OP_CONSTANT && (k->as.value == 1.0 || k->as.value == 2.0);
    return degree ? low ? degree * (int)k->as.value : MOST_DEGREE : f->degree[e->as.arg[1]];
}

static int degree_of(const dm_form *f, const dm_expr *e) {
    int all[3] = {0, 0, 0}, most = 0;
    for (int i = 0; i < dm_op_operands(e->op); i++) {
        all[i] = f->degree[e->as.arg[i]];
        most = all[i] > most ? all[i] : most;
    }
    switch (e->op) {
    case DM_OP_INPUT:
        return f->first <= e->as.input && e->as.input - f->first < f->velocities;
    case DM_OP_NEG:
    case DM_OP_ADD:
    case DM_OP_SUB:
        return most;
    case DM_OP_MUL:
        return all[0] + all[1];
    case DM_OP_DIV:
        return all[1] ? MOST_DEGREE : all[0];
    case DM_OP_POW:
        return of_power(f, e);
    default:
        return most ? MOST_DEGREE : 0;
    }
}

void dm_form_degrees(dm_form *f) {
    const uint32_t size = dm_graph_size(f->g);
    for (dm_node n = 0; n < size; n++) f->degree[n] = lesser(degree_of(f, dm_graph_at(f->g, n)));
}

void dm_form_factors(const dm_form *f, unsigned char *marks) {
    const uint32_t size = dm_graph_size(f->g);
    for (dm_node n = 0; n < size; n++) marks[n] = 0;
    for (dm_node n = 0; n < size; n++) {
        const dm_expr *e = dm_graph_at(f->g, n);
        if (!f->degree[n] || (e->op != DM_OP_MUL && e->op != DM_OP_DIV)) continue;
        for (int i = 0; i < 2; i++)
            if (!f->degree[e->as.arg[i]]) marks[e->as.arg[i]] = 1;
    }
}

/* ---- factors ---- */

/* The node whose square it is; 0: none. */
static dm_node root_of(const dm_form *f, const dm_expr *e) {
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    if (e->op == DM_OP_MUL) return a == b ? a : 0;
    const dm_expr *k = e->op == DM_OP_POW ? dm_graph_at(f->g, b) : NULL;
    return k && k->op == DM_OP_CONSTANT && k->as.value == 2.0 ? a : 0;
}

static void scale(coefficient *x, dm_interval by) {
    x->c = dm_interval_multiply(x->c, by);
}

/* Do bounds tell enough of it, or is there no room for factors? */
static int is_bounded(const dm_form *f, const coefficient *x, dm_node at) {
    const dm_interval value = f->value[at];
    const int finite = isfinite(value.lo) && isfinite(value.hi);
    return finite || f->apart == DM_FORM_PLAIN || x->count + 2 > DM_FORM_PARTS;
}

static void add_part(coefficient *x, dm_node part) {
    x->part[x->count++] = part;
}

/* Times the square of a node that is free of v. */
static void multiply_square(const dm_form *f, coefficient *x, dm_node root) {
    const dm_expr *e = dm_graph_at(f->g, root);
    if (is_bounded(f, x, root))
        scale(x, dm_interval_square(f->value[root]));
    else if (e->op == DM_OP_NEG)
        multiply_square(f, x, e->as.arg[0]);
    else if (e->op == DM_OP_MUL)
        multiply_square(f, x, e->as.arg[0]), multiply_square(f, x, e->as.arg[1]);
    else
        add_part(x, root), add_part(x, root);
}

/* Times a node that is free of v: factors apart, or into the bounds. */
static void multiply(const dm_form *f, coefficient *x, dm_node by) {
    const dm_expr *e = dm_graph_at(f->g, by);
    const dm_node a = e->as.arg[0], b = e->as.arg[1], root = root_of(f, e);
    const int looks = f->apart == DM_FORM_COSINES && !root && x->opened < MOST_OPENED;
    if (looks && e->op == DM_OP_COS && !x->turn)
        x->turn = by;
    else if (is_bounded(f, x, by) && !(looks && (e->op == DM_OP_NEG || e->op == DM_OP_MUL)))
        scale(x, f->value[by]);
    else if (root)
        multiply_square(f, x, root);
    else if (e->op == DM_OP_NEG)
        scale(x, (dm_interval){-1.0, -1.0}), multiply(f, x, a);
    else if (e->op == DM_OP_MUL)
        x->opened++, multiply(f, x, a), multiply(f, x, b);
    else
        add_part(x, by);
}

/* Takes the outermost factor that does not depend on v off a node, into *x; 0: there is none. */
static int strip(const dm_form *f, dm_node *at, coefficient *x) {
    const dm_expr *e = dm_graph_at(f->g, *at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    const int product = e->op == DM_OP_MUL;
    if (e->op == DM_OP_NEG)
        scale(x, (dm_interval){-1.0, -1.0}), *at = a;
    else if (product && f->degree[b] && !f->degree[a])
        multiply(f, x, a), *at = b;
    else if (product && f->degree[a] && !f->degree[b])
        multiply(f, x, b), *at = a;
    else if (e->op == DM_OP_DIV && f->degree[a] && !f->degree[b])
        x->c = dm_interval_divide(x->c, f->value[b]), *at = a;
    else
        return 0;
    return 1;
}

/* Takes one such factor out of *x; 0: it is not there. */
static int take(coefficient *x, dm_node part) {
    uint32_t k = 0;
    while (k < x->count && x->part[k] != part) k++;
    if (k == x->count) return 0;
    x->part[k] = x->part[--x->count];
    return 1;
}

/* ---- the form ---- */

/* A w with that node; count: there is none. */
static uint32_t find_node(const dm_form *f, dm_node node) {
    uint32_t i = 0;
    while (i < f->count && f->w[i].node != node) i++;
    return i;
}

/* Are some factors those, whatever their order? */
static int is_same(const dm_node *a, uint32_t many, const dm_node *b, uint32_t count) {
    coefficient left = {.c = ONE};
    int out = many == count;
    for (uint32_t k = 0; k < many; k++) add_part(&left, a[k]);
    for (uint32_t k = 0; out && k < count; k++) out = take(&left, b[k]);
    return out;
}

/* The w that is that one; count: there is none. */
static uint32_t find_w(const dm_form *f, const dm_form_w *w) {
    uint32_t i = 0;
    while (i < f->count && (f->w[i].node != w->node ||
                            !is_same(f->w[i].square, f->w[i].count, w->square, w->count)))
        i++;
    return i;
}

static void add_to(dm_interval *sum, dm_interval c) {
    *sum = dm_interval_add(*sum, c);
}

/* c w w; 0: there are too many w */
static int add_square(dm_form *f, const dm_form_w *w, dm_interval c) {
    uint32_t i = find_w(f, w);
    if (i == DM_FORM_MOST) return 0;
    if (i == f->count) {
        f->w[f->count++] = *w;
        for (uint32_t k = 0; k <= i; k++) {
            f->c[i][k] = f->c[k][i] = (dm_interval){0.0, 0.0};
            f->turn[i][k] = f->turn[k][i] = 0;
        }
    }
    add_to(&f->c[i][i], dm_interval_multiply(c, (dm_interval){2.0, 2.0}));
    return 1;
}

/* The w whose square is *x times that of a node, but for its bounds; 0: factors are left without a
 * root. */
static int find_root(const dm_form *f, coefficient x, dm_node node, dm_form_w *w) {
    *w = (dm_form_w){.node = node, .count = x.count};
    memcpy(w->square, x.part, sizeof w->square);
    while (x.count) {
        const dm_node part = x.part[--x.count];
        if (!take(&x, part) && !(f->value[part].lo >= 0.0)) return 0;
    }
    return 1;
}

/* A square has no cosine apart. */
static void settle(const dm_form *f, coefficient *x) {
    if (x->turn) scale(x, f->value[x->turn]);
    x->turn = 0;
}

/* x times the square of a node, of which numbers and what is not bounded are taken off. */
static int add_square_of(dm_form *f, dm_node node, coefficient x) {
    coefficient own = {.c = ONE};
    dm_form_w w;
    dm_node inside = node;
    while (strip(f, &inside, &own)) continue;
    settle(f, &own);
    settle(f, &x);
    const int is_plain = own.c.lo == own.c.hi && x.count + 2 * own.count <= DM_FORM_PARTS;
    for (uint32_t k = 0; is_plain && k < own.count; k++)
        add_part(&x, own.part[k]), add_part(&x, own.part[k]);
    if (!find_root(f, x, is_plain ? inside : node, &w)) return 0;
    const dm_interval squared = dm_interval_square(own.c);
    return add_square(f, &w, is_plain ? dm_interval_multiply(x.c, squared) : x.c);
}

/* Down to the node of a w; 0: it holds none. */
static int strip_to_w(const dm_form *f, dm_node *at, coefficient *x) {
    while (find_node(f, *at) == f->count)
        if (!strip(f, at, x)) return 0;
    return 1;
}

/* x w_i w_j; 0: another cosine stands there */
static int add_entry(dm_form *f, uint32_t i, uint32_t j, const coefficient *x) {
    coefficient own = *x;
    if (i == j) settle(f, &own);
    const dm_interval c = f->c[i][j];
    const int is_first = c.lo == 0.0 && c.hi == 0.0;
    if (!is_first && f->turn[i][j] != own.turn) return 0;
    f->turn[i][j] = f->turn[j][i] = own.turn;
    add_to(&f->c[i][j], own.c);
    add_to(&f->c[j][i], own.c);
    return 1;
}

/* Is the square of the factors in *x those of two squares? */
static int has_factors(const coefficient *x, const dm_form_w *a, const dm_form_w *b) {
    dm_node twice[2 * DM_FORM_PARTS], squares[2 * DM_FORM_PARTS];
    memcpy(twice, x->part, sizeof a->square);
    memcpy(twice + x->count, x->part, sizeof a->square);
    memcpy(squares, a->square, sizeof a->square);
    memcpy(squares + a->count, b->square, sizeof b->square);
    return is_same(twice, 2 * x->count, squares, a->count + b->count);
}

/* x w_i w_j of the pair with these nodes that has its factors; 0: there is none */
static int add_pair(dm_form *f, dm_node one, dm_node other, const coefficient *x) {
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < f->count; j++)
            if (f->w[i].node == one && f->w[j].node == other && has_factors(x, &f->w[i], &f->w[j]))
                return add_entry(f, i, j, x);
    return 0;
}

/* x a b, of first degree each: a square, where they are one without their factors, is for the first
 * pass, others are for the second one, which knows the squares. */
static int add_product(dm_form *f, dm_node a, dm_node b, coefficient x, int pass) {
    dm_node one = a, other = b;
    coefficient whole = x;
    dm_form_w w;
    if (a == b) return pass ? 1 : add_square_of(f, a, x);
    while (strip(f, &one, &whole)) continue;
    while (strip(f, &other, &whole)) continue;
    if (one == other && find_root(f, whole, one, &w)) {
        settle(f, &whole);
        return pass ? 1 : add_square(f, &w, whole.c);
    }
    if (!pass) return 1;
    return strip_to_w(f, &a, &x) && strip_to_w(f, &b, &x) && add_pair(f, a, b, &x);
}

/* Adds x times a node to the form; 0: it is not of that kind. */
static int collect(dm_form *f, dm_node at, coefficient x, int pass) {
    if (f->degree[at] <= 1) return 1;
    if (f->visits-- <= 0) return 0;
    while (strip(f, &at, &x)) continue;
    const dm_expr *e = dm_graph_at(f->g, at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    coefficient minus_x = x;
    scale(&minus_x, (dm_interval){-1.0, -1.0});
    switch (e->op) {
    case DM_OP_ADD:
        return collect(f, a, x, pass) && collect(f, b, x, pass);
    case DM_OP_SUB:
        return collect(f, a, x, pass) && collect(f, b, minus_x, pass);
    case DM_OP_POW:
        return f->degree[a] == 1 && f->degree[at] == 2 && add_product(f, a, a, x, pass);
    case DM_OP_MUL:
        return f->degree[a] == 1 && f->degree[b] == 1 && add_product(f, a, b, x, pass);
    default:
        return 0;
    }
}

int dm_form_read(dm_form *f) {
    f->visits = VISITS, f->count = 0;
    for (int pass = 0; pass < 2; pass++)
        if (!collect(f, f->L, (coefficient){.c = ONE}, pass)) return 0;
    return 1;
}

/* ---- turns: are cosines beside the entries of a form products of unit vectors? ---- */

/* The angles that x_i may be, two at most; known: some are. */
typedef struct {
    dm_node angle[2];
    uint32_t count;
    int known;
} choice;

/* The two angles whose difference a cosine is of: one alone is that to 0. */
static void angles_of(const dm_graph *g, dm_node cosine, dm_node out[2]) {
    const dm_node argument = dm_graph_at(g, cosine)->as.arg[0];
    const dm_expr *e = dm_graph_at(g, argument);
    const int is_difference = e->op == DM_OP_SUB;
    out[0] = is_difference ? e->as.arg[0] : argument;
    out[1] = is_difference ? e->as.arg[1] : 0; /* node 0 is the number 0 */
}

/* What is left of a choice that is one of two angles, too. */
static void meet(choice *x, const dm_node with[2]) {
    uint32_t left = 0;
    if (!x->known) *x = (choice){.angle = {with[0], with[1]}, .count = 2, .known = 1};
    for (uint32_t k = 0; k < x->count; k++)
        if (x->angle[k] == with[0] || x->angle[k] == with[1]) x->angle[left++] = x->angle[k];
    x->count = left;
}

static void choose(choice *x, dm_node angle) {
    x->angle[0] = angle;
    x->count = 1;
}

/* Two that may still be either: one is the first angle; what the other is follows. */
static int choose_both(choice *x, choice *y, const dm_node angles[2]) {
    if (x->count > 1 && y->count > 1) choose(x, angles[0]);
    if (x->count > 1) choose(x, angles[y->angle[0] == angles[0]]);
    if (y->count > 1) choose(y, angles[x->angle[0] == angles[0]]);
    return (x->angle[0] == angles[0] && y->angle[0] == angles[1]) ||
           (x->angle[0] == angles[1] && y->angle[0] == angles[0]);
}

static int is_zero(dm_interval c) {
    return c.lo == 0.0 && c.hi == 0.0;
}

int dm_form_turns(const dm_form *f) {
    choice x[DM_FORM_MOST] = {0};
    dm_node angles[2];
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < f->count; j++) {
            if (i == j || !f->turn[i][j]) continue;
            angles_of(f->g, f->turn[i][j], angles);
            meet(&x[i], angles);
            if (!x[i].count) return 0;
        }
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < i; j++) {
            if (is_zero(f->c[i][j])) continue;
            if (!f->turn[i][j] && (x[i].known || x[j].known)) return 0;
            if (!f->turn[i][j]) continue;
            angles_of(f->g, f->turn[i][j], angles);
            if (!choose_both(&x[i], &x[j], angles)) return 0;
        }
    return 1;
}
