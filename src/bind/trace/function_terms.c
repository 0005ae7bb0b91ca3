/* function_terms.c - a traced function taken apart: the terms of its sum, the factors of a
 * product, the inputs that it depends on. The parts are functions of the same arguments, in the
 * same graph. */
#include "algebra/compact.h"
#include "bind/trace/function.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>

enum {
    MOST_TERMS = 4096, /* beyond it a product of sums is left as it is */
    MOST_FACTORS = 64  /* of a product; what more there is counts as one */
};

/* c * product of base[i]^power[i] */
typedef struct {
    double c;
    uint32_t count;
    dm_node base[MOST_FACTORS];
    double power[MOST_FACTORS];
} product;

/* Powers of one base are added. */
static void add_factor(product *p, dm_node base, double power) {
    for (uint32_t i = 0; i < p->count; i++)
        if (p->base[i] == base) {
            p->power[i] += power;
            return;
        }
    p->base[p->count] = base;
    p->power[p->count++] = power;
}

/* parts of a product that are still to be looked at */
typedef struct {
    product *p;
    uint32_t count;
    dm_node node[MOST_FACTORS];
    double power[MOST_FACTORS];
} todo;

/* What is still to be opened. */
static void later(todo *t, dm_node n, double power) {
    t->node[t->count] = n;
    t->power[t->count++] = power;
}

/* Open n^power where (a b)^power = a^power b^power for all numbers; what cannot be opened is a
 * factor. */
static void open_factor(const dm_graph *g, todo *t, dm_node n, double power) {
    const dm_expr e = *dm_graph_at(g, n);
    const int whole = power == floor(power), one = fabs(power) == 1.0;
    const int room = t->p->count + t->count + 2 <= MOST_FACTORS;
    double k;
    if (e.op == DM_OP_CONSTANT && (whole || e.as.value > 0.0) && e.as.value != 0.0)
        t->p->c *= pow(e.as.value, power);
    else if (e.op == DM_OP_NEG && whole && room)
        t->p->c *= fmod(power, 2.0) != 0.0 ? -1.0 : 1.0, later(t, e.as.arg[0], power);
    else if ((e.op == DM_OP_MUL || e.op == DM_OP_DIV) && whole && room)
        later(t, e.as.arg[1], e.op == DM_OP_DIV ? -power : power), later(t, e.as.arg[0], power);
    else if (e.op == DM_OP_POW && one && room && dm_is_constant(g, e.as.arg[1], &k))
        later(t, e.as.arg[0], power * k);
    else if (e.op == DM_OP_SQRT && whole && room)
        later(t, e.as.arg[0], 0.5 * power);
    else if (e.op == DM_OP_RSQRT && whole && room)
        later(t, e.as.arg[0], -0.5 * power);
    else if (e.op == DM_OP_RSQRT3 && whole && room)
        later(t, e.as.arg[0], -1.5 * power);
    else
        add_factor(t->p, n, power);
}

/* *p = n as a product */
static void factor(const dm_graph *g, product *p, dm_node n) {
    todo t = {.p = p};
    p->c = 1.0, p->count = 0;
    later(&t, n, 1.0);
    while (t.count) {
        t.count--;
        open_factor(g, &t, t.node[t.count], t.power[t.count]);
    }
}

/* the first factor that is a sum to the power 1; count: none */
static uint32_t open_sum(const dm_graph *g, const product *p) {
    for (uint32_t i = 0; i < p->count; i++) {
        const dm_op op = dm_graph_at(g, p->base[i])->op;
        if (p->power[i] == 1.0 && (op == DM_OP_ADD || op == DM_OP_SUB)) return i;
    }
    return p->count;
}

/* the product without factor `left`, as a node */
static dm_node rest_of(dm_graph *g, const product *p, uint32_t left) {
    dm_node n = dm_constant(g, p->c);
    for (uint32_t i = 0; i < p->count; i++)
        if (i != left) n = dm_mul(g, n, dm_power(g, p->base[i], dm_constant(g, p->power[i])));
    return n;
}

typedef struct {
    dm_graph *graph;
    uint32_t count, waiting; /* terms so far; nodes that may be sums */
    dm_node term[MOST_TERMS], wait[MOST_TERMS];
} sum;

/* Two nodes in the place of n = rest (a + b), or n as a term. */
static void open_term(sum *s, dm_node n) {
    product p;
    factor(s->graph, &p, n);
    const uint32_t i = open_sum(s->graph, &p);
    if (i == p.count || s->count + s->waiting + 2 > MOST_TERMS) {
        if (p.c != 0.0 && n != 0) s->term[s->count++] = n;
        return;
    }
    const dm_expr e = *dm_graph_at(s->graph, p.base[i]);
    const dm_node rest = rest_of(s->graph, &p, i);
    const dm_node a = dm_mul(s->graph, rest, e.as.arg[0]);
    const dm_node b = dm_mul(s->graph, rest, e.as.arg[1]);
    s->wait[s->waiting++] = e.op == DM_OP_SUB ? dm_neg(s->graph, b) : b;
    s->wait[s->waiting++] = a;
}

/* the terms of node n: sums opened, products of sums multiplied out, powers of sums kept */
static void split(sum *s, dm_node n) {
    s->count = 0, s->waiting = 1;
    s->wait[0] = n;
    while (s->waiting) open_term(s, s->wait[--s->waiting]);
}

/* push a function of the arguments of f, of `count` outputs: nodes[] in its graph g, which the one
 * at 1 keeps */
static dml_function *push_part(lua_State *L, const dml_function *f, dm_graph *g,
                               const dm_node *nodes, uint32_t count) {
    dml_function *part = lua_newuserdatauv(L, sizeof *part, 1);
    *part = (dml_function){.graph = g,
                           .arena = f->arena,
                           .s = f->s,
                           .rows = count,
                           .columns = 1,
                           .inputs = f->inputs};
    lua_getiuservalue(L, 1, 1);
    lua_setiuservalue(L, -2, 1);
    dm_node *own = dm_arena_take(f->arena, count * sizeof *own);
    part->x = dm_arena_take(f->arena, f->inputs * sizeof *part->x);
    if (!own || !part->x || dm_graph_status(g) != DM_OK) luaL_error(L, "not enough memory");
    memcpy(own, nodes, count * sizeof *own);
    part->parts[DML_VALUE].nodes = own;
    luaL_setmetatable(L, DML_FUNCTION);
    return part;
}

/* The function at 1, which must give one number. */
static dml_function *check_number(lua_State *L, const char *what) {
    dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    if (dml_outputs(f) != 1)
        luaL_error(L, "%s are of a function that gives one number (this one gives %d)", what,
                   (int)dml_outputs(f));
    return f;
}

/* A list of functions whose sum is f. */
static int function_terms(lua_State *L) {
    dml_function *f = check_number(L, "terms");
    sum *s = lua_newuserdatauv(L, sizeof *s, 0);
    s->graph = f->graph;
    split(s, *f->parts[DML_VALUE].nodes);
    lua_createtable(L, (int)s->count, 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < s->count; i++) {
        push_part(L, f, f->graph, &s->term[i], 1);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 1;
}

/* The constant, then the powers. */
static int function_factors(lua_State *L) {
    dml_function *f = check_number(L, "factors");
    product *p = lua_newuserdatauv(L, sizeof *p, 0);
    factor(f->graph, p, *f->parts[DML_VALUE].nodes);
    lua_pushnumber(L, p->c);
    lua_createtable(L, (int)p->count, 0);
    dml_setresult(L);
    for (uint32_t i = 0; i < p->count; i++) {
        lua_createtable(L, 0, 2);
        push_part(L, f, f->graph, &p->base[i], 1);
        lua_setfield(L, -2, "base");
        lua_pushnumber(L, p->power[i]);
        lua_setfield(L, -2, "power");
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    return 2;
}

/* By outputs, a boolean for every input. */
static int function_depends(lua_State *L) {
    const dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    const dm_node *roots = f->parts[DML_VALUE].nodes;
    uint32_t input = 0;
    lua_createtable(L, f->s.arguments, 0);
    dml_setresult(L);
    for (int k = 0; k < f->s.arguments; k++) {
        const int scalar = f->s.length[k] == DML_SCALAR_ARGUMENT;
        const uint32_t n = scalar ? 1 : (uint32_t)f->s.length[k];
        lua_createtable(L, (int)n, 0);
        for (uint32_t i = 0; i < n; i++, input++) {
            lua_pushboolean(L, dm_depends(f->graph, roots, dml_outputs(f), input, 1));
            lua_rawseti(L, -2, (lua_Integer)i + 1);
        }
        lua_rawseti(L, -2, k + 1);
    }
    return 1;
}

/* n is one of the `count` nodes, each once; a constant is none */
static uint32_t add_once(const dm_graph *g, dm_node *nodes, uint32_t count, dm_node n) {
    double constant;
    int known = !n || dm_is_constant(g, n, &constant);
    for (uint32_t i = 0; i < count; i++) known |= nodes[i] == n;
    if (!known) nodes[count++] = n;
    return count;
}

/* push the function whose entries are these nodes; false: there are none */
static void push_entries(lua_State *L, const dml_function *f, dm_graph *g, const dm_node *nodes,
                         uint32_t count) {
    if (count)
        push_part(L, f, g, nodes, count)->rank = 1;
    else
        lua_pushboolean(L, 0);
}

/* Breaks and edges of all nodes that the value needs, in a graph of its own. */
static int function_breaks(lua_State *L) {
    const dml_function *f = luaL_checkudata(L, 1, DML_FUNCTION);
    const uint32_t m = dml_outputs(f);
    dm_node *roots = lua_newuserdatauv(L, m * sizeof *roots, 0);
    dm_graph *g = dm_graph_copy(f->graph, f->parts[DML_VALUE].nodes, m, roots);
    if (!g) return luaL_error(L, "not enough memory");
    const uint32_t size = dm_graph_size(g);
    dm_node *breaks = lua_newuserdatauv(L, 2 * (size_t)size * sizeof *breaks, 0);
    dm_node *edges = breaks + size;
    uint32_t count = 0, rest = 0;
    for (dm_node i = 1; i < size; i++) {
        const dm_expr e = *dm_graph_at(g, i);
        count = add_once(g, breaks, count, dm_break_of(g, &e));
        rest = add_once(g, edges, rest, dm_edge_of(g, &e));
    }
    push_entries(L, f, g, breaks, count);
    push_entries(L, f, g, edges, rest);
    return 2;
}

const dml_row dml_function_parts[] =
    {{"terms", function_terms,
      "f:terms() -> list of dm.function\n"
      "The terms of which f, a function that gives one number, is the sum: sums opened, products "
      "of sums multiplied out, powers of sums kept. Each is a function of the same arguments."},
     {"factors", function_factors,
      "f:factors() -> c, list of {base =, power =}\n"
      "f = c * product of base^power: the constant factor, and the functions whose powers are "
      "multiplied. A spring k/2 g^2 gives k/2 and { { base = g, power = 2 } }."},
     {"depends", function_depends,
      "f:depends() -> table of tables of booleans\n"
      "depends[k][i]: is entry i of argument k (i = 1 for a bare number) in the expression of f?"},
     {"breaks", function_breaks,
      "f:breaks() -> dm.function or false, dm.function or false\n"
      "What is zero where f passes from one formula to another, as a function of the same "
      "arguments that gives a vector: the operands of abs, sign and where, a - b of min(a, b) and "
      "max(a, b); false where f is one formula, as it is in each of the cells between. Behind it "
      "what must be > 0 where f is finite: the operands of roots, logarithms and powers."},
     {NULL, NULL, NULL}};
