/* text.c - how scalars, vectors and matrices print. */
#include "algebra/implicit.h"
#include "bind/core/state.h"
#include "bind/value/array.h"

#include <stdio.h>
#include <string.h>

enum {
    LONGEST_EXPRESSION = 60, /* characters */
    DEEPEST_EXPRESSION = 12,
    LONGEST_VECTOR = 12, /* entries printed in full; else the first 3 and the last */
    LONGEST_MATRIX = 10,
    SHOWN = 3
};

/* ---- a symbol: its expression, cut off when long ---- */

typedef struct {
    char text[LONGEST_EXPRESSION + 4];
    size_t length;
    const dm_graph *graph;
} writer;

/* What does not fit is cut with three dots. */
static void write_text(writer *w, const char *text) {
    for (; *text && w->length < LONGEST_EXPRESSION; text++) w->text[w->length++] = *text;
    w->text[w->length] = '\0';
    if (*text) memcpy(w->text + LONGEST_EXPRESSION, "...", 4);
}

/* how tightly an operation binds: sums, products, signs, powers, all else */
static int strength(dm_op op) {
    switch (op) {
    case DM_OP_ADD:
    case DM_OP_SUB:
        return 1;
    case DM_OP_MUL:
    case DM_OP_DIV:
    case DM_OP_RSQRT:
        return 2;
    case DM_OP_NEG:
        return 3;
    case DM_OP_POW:
        return 4;
    default:
        return 5;
    }
}

static void write_node(writer *w, dm_node n, int least, int depth);

/* f(a, b). */
static void write_call(writer *w, const dm_expr *e, int depth) {
    write_text(w, e->op == DM_OP_RSQRT ? "1/sqrt" : dm_op_text(e->op));
    for (int k = 0; k < dm_op_operands(e->op); k++) {
        write_text(w, k ? ", " : "(");
        write_node(w, e->as.arg[k], 0, depth);
    }
    write_text(w, ")");
}

static void write_arguments(writer *w, dm_node with, int depth) {
    const dm_expr *e = dm_graph_at(w->graph, with);
    if (e->op != DM_OP_WITH) return;
    write_arguments(w, e->as.arg[0], depth);
    if (dm_graph_at(w->graph, e->as.arg[0])->op == DM_OP_WITH) write_text(w, ", ");
    write_node(w, e->as.arg[1], 0, depth);
}

/* an entry of an implicit function: name(x1, x2)[1] */
static void write_root(writer *w, const dm_expr *e, int depth) {
    char entry[24];
    dm_node leaf = e->as.arg[0];
    while (dm_graph_at(w->graph, leaf)->op == DM_OP_WITH)
        leaf = dm_graph_at(w->graph, leaf)->as.arg[0];
    const double serial = dm_graph_at(w->graph, leaf)->as.value;
    snprintf(entry, sizeof entry, ")[%lu]",
             1 + (unsigned long)dm_graph_at(w->graph, e->as.arg[1])->as.value);
    write_text(w, dm_implicit_find(w->graph, serial)->name);
    write_text(w, "(");
    write_arguments(w, e->as.arg[0], depth);
    write_text(w, entry);
}

/* Parentheses only where the order of operations needs them. */
static void write_infix(writer *w, const dm_expr *e, int depth) {
    const int own = strength(e->op), loose = e->op == DM_OP_ADD || e->op == DM_OP_MUL;
    if (e->op == DM_OP_NEG) {
        write_text(w, "-");
        write_node(w, e->as.arg[0], own, depth);
        return;
    }
    write_node(w, e->as.arg[0], e->op == DM_OP_POW ? own + 1 : own, depth);
    if (own == 1) write_text(w, " ");
    write_text(w, dm_op_text(e->op));
    if (own == 1) write_text(w, " ");
    write_node(w, e->as.arg[1], loose ? own : own + 1, depth);
}

static void write_leaf(writer *w, const dm_expr *e) {
    char leaf[40];
    if (e->op == DM_OP_INPUT)
        snprintf(leaf, sizeof leaf, "x%lu", (unsigned long)e->as.input + 1);
    else
        snprintf(leaf, sizeof leaf, "%.6g", e->as.value);
    write_text(w, leaf);
}

/* `least` is how tightly the surroundings bind; `depth` ends what would be too long to read. */
static void write_node(writer *w, dm_node n, int least, int depth) {
    const dm_expr *e = dm_graph_at(w->graph, n);
    const int own = strength(e->op);
    if (w->length == LONGEST_EXPRESSION) return;
    if (dm_op_operands(e->op) == 0) {
        write_leaf(w, e);
    } else if (depth == DEEPEST_EXPRESSION) {
        write_text(w, "(...)");
    } else if (e->op == DM_OP_ROOT) {
        write_root(w, e, depth + 1);
    } else if (own == 5) {
        write_call(w, e, depth + 1);
    } else {
        if (own < least) write_text(w, "(");
        if (e->op == DM_OP_RSQRT)
            write_call(w, e, depth + 1);
        else
            write_infix(w, e, depth + 1);
        if (own < least) write_text(w, ")");
    }
}

/* The expression of a symbol, as far as it fits. */
static void symbol_text(lua_State *L, char *out, const dml_scalar *x) {
    const dml_frame *frame = dml_findframe(L, x->serial);
    writer w = {.length = 0};
    if (!frame) {
        strcpy(out, "symbol of a trace that has ended");
        return;
    }
    w.graph = frame->graph;
    write_node(&w, x->as.node, 0, 0);
    strcpy(out, w.text);
}

/* Numbers as Lua prints them, hyper-dual numbers as f + a e1 + b e2 + c e1e2. */
void dml_scalartext(lua_State *L, char out[DML_TEXT], const dml_scalar *x) {
    const dml_hyperdual *h = &x->as.hyper;
    if (x->kind == DML_NUMBER)
        snprintf(out, DML_TEXT, "%.14g", x->as.number);
    else if (x->kind == DML_SYMBOL)
        symbol_text(L, out, x);
    else
        snprintf(out, DML_TEXT, "%.14g + %.14g e1 + %.14g e2 + %.14g e1e2", h->f, h->a, h->b,
                 h->ab);
}

/* ---- arrays ---- */

const char *dml_shape(lua_State *L, const dml_array *a) {
    luaL_checkstack(L, 4, NULL);
    if (a->rank == 1) return lua_pushfstring(L, "a vector of %d", (int)a->rows);
    return lua_pushfstring(L, "a matrix of %d x %d", (int)a->rows, (int)a->columns);
}

/* what is printed of n entries: all, or the first few and the last */
static uint32_t next_shown(uint32_t i, uint32_t n, uint32_t most) {
    return n > most && i + 1 == SHOWN ? n - 1 : i + 1;
}

static uint32_t most_shown(const dml_array *a) {
    return a->rank == 1 ? LONGEST_VECTOR : LONGEST_MATRIX;
}

/* entries first .. first+n-1 in brackets, each at least `width` wide */
static void add_row(luaL_Buffer *b, const dml_array *a, uint32_t first, uint32_t n, size_t width) {
    const uint32_t most = most_shown(a);
    char text[DML_TEXT];
    luaL_addchar(b, '[');
    for (uint32_t i = 0; i < n; i = next_shown(i, n, most)) {
        const dml_scalar x = dml_get(a, first + i);
        if (i) luaL_addstring(b, ", ");
        if (i >= SHOWN && n > most) luaL_addstring(b, "... , ");
        dml_scalartext(b->L, text, &x);
        for (size_t length = strlen(text); length < width; length++) luaL_addchar(b, ' ');
        luaL_addstring(b, text);
    }
    luaL_addchar(b, ']');
}

/* width of the widest entry that is shown */
static size_t widest(lua_State *L, const dml_array *m) {
    char text[DML_TEXT];
    size_t width = 0;
    for (uint32_t i = 0; i < m->rows; i = next_shown(i, m->rows, LONGEST_MATRIX))
        for (uint32_t j = 0; j < m->columns; j = next_shown(j, m->columns, LONGEST_MATRIX)) {
            const dml_scalar x = dml_get(m, i * m->columns + j);
            dml_scalartext(L, text, &x);
            if (strlen(text) > width) width = strlen(text);
        }
    return width;
}

int dml_vectortext(lua_State *L) {
    const dml_array *a = dml_checkarray(L, 1, 1);
    char count[32];
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    add_row(&b, a, 0, a->rows, 0);
    snprintf(count, sizeof count, " (%lu)", (unsigned long)a->rows);
    if (a->rows > LONGEST_VECTOR) luaL_addstring(&b, count);
    luaL_pushresult(&b);
    return 1;
}

int dml_matrixtext(lua_State *L) {
    const dml_array *m = dml_checkarray(L, 1, 2);
    const size_t width = widest(L, m);
    char count[48];
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '[');
    for (uint32_t i = 0; i < m->rows; i = next_shown(i, m->rows, LONGEST_MATRIX)) {
        if (i) luaL_addstring(&b, ",\n ");
        if (i >= SHOWN && m->rows > LONGEST_MATRIX) luaL_addstring(&b, "...\n ");
        add_row(&b, m, i * m->columns, m->columns, width);
    }
    luaL_addchar(&b, ']');
    snprintf(count, sizeof count, " (%lu x %lu)", (unsigned long)m->rows,
             (unsigned long)m->columns);
    if (m->rows > LONGEST_MATRIX || m->columns > LONGEST_MATRIX) luaL_addstring(&b, count);
    luaL_pushresult(&b);
    return 1;
}
