/* A graph as text: what is used once is written in place, what is shared gets a line and
 * a
 * name t1, t2, ... of its own, results are y1, y2, ... Nesting is bounded, so that the
 * deepest graph needs no deep recursion. */
#include "graph/analyse.h"

#include "algebra/implicit.h"
#include "graph/nodes.h"

#include <stdio.h>
#include <string.h>

enum { DEEPEST = 12 };                          /* operations written in place inside each other */
enum { SUM = 1, PRODUCT, SIGNED, POWER, ATOM }; /* how strongly a text holds together */

/* a text in the making */
typedef struct {
    dm_graph *g;
    const char *const *names;
    dm_put *put;
    void *ud;
    uint32_t *name;  /* [nodes] number of the t that holds it, 0: none */
    uint8_t *height; /* [nodes] of what would be written in place */
    uint8_t *uses;   /* [nodes] saturated */
} printer;

/* as it is */
static void text(printer *p, const char *s) {
    p->put(p->ud, s, strlen(s));
}

/* as short as reads back to the same number */
static void number(printer *p, double x) {
    char s[40];
    double back = 0.0;
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(s, sizeof s, "%.*g", digits, x);
        if (sscanf(s, "%lf", &back) == 1 && back == x) break;
    }
    text(p, s);
}

/* a letter and a number, as x12 */
static void numbered(printer *p, const char *letter, uint32_t i) {
    char s[24];
    snprintf(s, sizeof s, "%s%u", letter, (unsigned)i);
    text(p, s);
}

/* the number 1 */
static int is_one(const dm_graph *g, dm_node n) {
    return dm_is_op(g, n, DM_OP_CONSTANT) && dm_at(g, n)->as.value == 1.0;
}

/* 1/x written in place, so that y * (1/x) can be written y / x */
static int is_plain_reciprocal(const printer *p, dm_node n) {
    const int turns = dm_is_op(p->g, n, DM_OP_DIV) && is_one(p->g, dm_at(p->g, n)->as.arg[0]);
    return !p->name[n] && (turns || dm_is_op(p->g, n, DM_OP_RSQRT));
}

/* how tightly the operation of n binds: sums, products, signs, powers, calls */
static int strength(const printer *p, dm_node n) {
    const dm_expr *e = dm_at(p->g, n);
    if (p->name[n]) return ATOM;
    switch (e->op) {
    case DM_OP_CONSTANT:
        return e->as.value < 0.0 ? SIGNED : ATOM;
    case DM_OP_ADD:
    case DM_OP_SUB:
        return SUM;
    case DM_OP_MUL:
        return e->as.arg[0] == e->as.arg[1] ? POWER : PRODUCT;
    case DM_OP_DIV:
    case DM_OP_RSQRT:
        return PRODUCT;
    case DM_OP_NEG:
        return SIGNED;
    case DM_OP_POW:
    case DM_OP_RSQRT3:
        return POWER;
    default:
        return ATOM;
    }
}

static void node(printer *p, dm_node n, int inside);

/* a and b with a sign between them */
static void operation(printer *p, dm_node a, const char *sign, dm_node b, int holds) {
    node(p, a, holds);
    text(p, sign);
    node(p, b, holds + 1);
}

/* a power with exponent 1/2 */
static void root(printer *p, dm_node n) {
    text(p, "sqrt(");
    node(p, n, 0);
    text(p, ")");
}

/* y / x, given the reciprocal of x */
static void quotient(printer *p, dm_node y, dm_node reciprocal) {
    const dm_expr *e = dm_at(p->g, reciprocal);
    if (e->op != DM_OP_RSQRT) {
        operation(p, y, "/", e->as.arg[1], PRODUCT);
        return;
    }
    node(p, y, PRODUCT);
    text(p, "/");
    root(p, e->as.arg[0]);
}

/* y * (1/x) as y / x */
static void product(printer *p, dm_node a, dm_node b) {
    if (a == b) {
        node(p, a, ATOM);
        text(p, "^2");
    } else if (is_plain_reciprocal(p, b)) {
        quotient(p, a, b);
    } else if (is_plain_reciprocal(p, a)) {
        quotient(p, b, a);
    } else {
        operation(p, a, "*", b, PRODUCT);
    }
}

/* f(a), f(a, b) */
static void call(printer *p, const dm_expr *e) {
    text(p, dm_op_text(e->op));
    for (int k = 0; k < dm_arity(e->op); k++) {
        text(p, k ? ", " : "(");
        node(p, e->as.arg[k], 0);
    }
    text(p, ")");
}

/* the links of an implicit function's arguments, the first one first */
static void arguments(printer *p, dm_node with) {
    const dm_expr *e = dm_at(p->g, with);
    if (e->op != DM_OP_WITH) return;
    arguments(p, e->as.arg[0]);
    if (dm_is_op(p->g, e->as.arg[0], DM_OP_WITH)) text(p, ", ");
    node(p, e->as.arg[1], 0);
}

/* name(x1, x2)[1]: an entry of the root; behind its arguments may stand what J^-T and J^-1 work
 * on */
static void implicit(printer *p, const dm_expr *e) {
    dm_node leaf = e->as.arg[0];
    while (dm_is_op(p->g, leaf, DM_OP_WITH)) leaf = dm_at(p->g, leaf)->as.arg[0];
    const dm_implicit *f = dm_implicit_find(p->g, dm_at(p->g, leaf)->as.value);
    text(p, f->name);
    text(p, "(");
    arguments(p, e->as.arg[0]);
    text(p, ")");
    numbered(p, "[", 1 + (uint32_t)dm_at(p->g, e->as.arg[1])->as.value);
    text(p, "]");
}

/* a number or an input by its name */
static void leaf(printer *p, const dm_expr *e) {
    if (e->op == DM_OP_CONSTANT)
        number(p, e->as.value);
    else if (p->names)
        text(p, p->names[e->as.input]);
    else
        numbered(p, "x", e->as.input + 1);
}

/* the right-hand side of n */
static void body(printer *p, dm_node n) {
    const dm_expr *e = dm_at(p->g, n);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    switch (e->op) {
    case DM_OP_CONSTANT:
    case DM_OP_INPUT:
        leaf(p, e);
        break;
    case DM_OP_NEG:
        text(p, "-");
        node(p, a, SIGNED);
        break;
    case DM_OP_ADD:
        operation(p, a, " + ", b, SUM);
        break;
    case DM_OP_SUB:
        operation(p, a, " - ", b, SUM);
        break;
    case DM_OP_MUL:
        product(p, a, b);
        break;
    case DM_OP_DIV:
        operation(p, a, "/", b, PRODUCT);
        break;
    case DM_OP_RSQRT:
        text(p, "1/");
        root(p, a);
        break;
    case DM_OP_RSQRT3:
        node(p, a, ATOM);
        text(p, "^(-3/2)");
        break;
    case DM_OP_ROOT:
        implicit(p, e);
        break;
    case DM_OP_POW:
        node(p, a, ATOM);
        text(p, "^");
        node(p, b, ATOM);
        break;
    default:
        call(p, e);
    }
}

/* n by its name or in place, in parentheses where it holds less than what is around it */
static void node(printer *p, dm_node n, int inside) {
    const int open = strength(p, n) < inside;
    if (p->name[n]) {
        numbered(p, "t", p->name[n]);
        return;
    }
    if (open) text(p, "(");
    body(p, n);
    if (open) text(p, ")");
}

/* what is used twice gets a line of its own */
static void count_uses(printer *p, const dm_node *roots, uint32_t m, uint32_t end) {
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(p->g, n);
        for (int k = 0; dm_is_marked(p->g, n) && k < dm_arity(e->op); k++) {
            const int square = e->op == DM_OP_MUL && k == 1 && e->as.arg[0] == e->as.arg[1];
            if (!square && p->uses[e->as.arg[k]] < 2) p->uses[e->as.arg[k]]++;
        }
    }
    for (uint32_t i = 0; i < m; i++)
        if (p->uses[roots[i]] < 2) p->uses[roots[i]]++;
}

/* shared and too deep operations get a line each, in order */
static void shared_lines(printer *p, uint32_t end) {
    uint32_t names = 0;
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(p->g, n);
        if (!dm_is_marked(p->g, n) || dm_arity(e->op) == 0) continue;
        p->height[n] = 1;
        for (int k = 0; k < dm_arity(e->op); k++)
            if (p->height[e->as.arg[k]] >= p->height[n])
                p->height[n] = (uint8_t)(p->height[e->as.arg[k]] + 1);
        if ((p->uses[n] < 2 && p->height[n] < DEEPEST) || e->op == DM_OP_WITH) continue;
        numbered(p, "t", ++names);
        text(p, " = ");
        body(p, n);
        text(p, "\n");
        p->name[n] = names;
        p->height[n] = 0;
    }
}

/* shared parts first, then one line a root */
void dm_print(dm_graph *g, const dm_node *roots, uint32_t m, const char *const *names, dm_put *put,
              void *ud) {
    printer p = {.g = g, .names = names, .put = put, .ud = ud};
    const uint32_t end = dm_mark(g, roots, m);
    p.name = dm_arena_take(g->arena, (end + 1) * sizeof *p.name);
    p.height = dm_arena_take(g->arena, end + 1);
    p.uses = dm_arena_take(g->arena, end + 1);
    if (!p.name || !p.height || !p.uses) {
        dm_graph_fail(g, DM_NO_MEMORY);
        return;
    }
    memset(p.name, 0, end * sizeof *p.name);
    memset(p.height, 0, end);
    memset(p.uses, 0, end);
    count_uses(&p, roots, m, end);
    shared_lines(&p, end);
    for (uint32_t i = 0; i < m; i++) {
        numbered(&p, "y", i + 1);
        text(&p, " = ");
        node(&p, roots[i], 0);
        text(&p, "\n");
    }
}
