/* emit_c.c - a graph as C text. The text of every operation stands in graph/ops.def with %a,
 * %b, %c for the operands; here they are filled in, one operation a line, and numbers are
 * written so that they are read back bit for bit. */
#include "code/tape/emit_c.h"

#include "algebra/compact.h"
#include "algebra/implicit.h"
#include "graph/nodes.h"
#include "numbers/fma.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* from the list of operations; "" where an operation has no C text */
static const char *const c_text[DM_OP_COUNT] = {
#define X(name, operands, text, c) c,
#include "graph/ops.def"
#undef X
};

typedef struct {
    const dm_graph *g;
    const char *const *names;
    dm_put *put;
    void *ud;
} writer;

/* a text as it is */
static void text(const writer *w, const char *s) {
    w->put(w->ud, s, strlen(s));
}

/* short pieces only */
static void format(const writer *w, const char *pattern, ...) {
    char s[128];
    va_list list;
    va_start(list, pattern);
    vsnprintf(s, sizeof s, pattern, list);
    va_end(list);
    text(w, s);
}

/* 17 digits; whole numbers as 2.0, so that no division is one of integers */
static void constant(const writer *w, double x) {
    if (isnan(x))
        text(w, "NAN");
    else if (isinf(x))
        text(w, x > 0 ? "HUGE_VAL" : "(-HUGE_VAL)");
    else
        format(w,
               x < 0 || signbit(x)               ? "(%.17g)"
               : x == floor(x) && fabs(x) < 1e15 ? "%.1f"
                                                 : "%.17g",
               x);
}

/* constants in place, inputs by their names, operations as t<node> */
static void operand(const writer *w, dm_node n) {
    const dm_expr *e = dm_at(w->g, n);
    if (e->op == DM_OP_CONSTANT)
        constant(w, e->as.value);
    else if (e->op != DM_OP_INPUT)
        format(w, "t%u", (unsigned)n);
    else if (w->names)
        text(w, w->names[e->as.input]);
    else
        format(w, "x%u", (unsigned)e->as.input + 1);
}

/* the C text of an operation with %a, %b, %c filled in */
static void operation(const writer *w, const dm_expr *e) {
    static const char *const twice[DM_OP_COUNT] =
        {[DM_OP_FMA] = "%a * %b + %c", [DM_OP_FMS] = "%a * %b - %c", [DM_OP_FNMA] = "%c - %a * %b"};
    const char *apart = dm_fma_is_fused() ? NULL : twice[e->op];
    for (const char *c = apart ? apart : c_text[e->op]; *c; c++) {
        if (*c == '%')
            operand(w, e->as.arg[*++c - 'a']);
        else
            w->put(w->ud, c, 1);
    }
}

/* inputs that are used, then one line an operation */
static int body(const writer *w, uint32_t end) {
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(w->g, n);
        if (!dm_is_marked(w->g, n) || e->op == DM_OP_CONSTANT) continue;
        text(w, "    const double ");
        if (e->op == DM_OP_INPUT) {
            operand(w, n);
            format(w, " = in[%u];\n", (unsigned)e->as.input);
            continue;
        }
        if (!*c_text[e->op]) return 0;
        format(w, "t%u = ", (unsigned)n);
        operation(w, e);
        text(w, ";\n");
    }
    return 1;
}

/* Constants stand where they are used, so that no line is spent on them. */
int dm_emit_c(dm_graph *g, const dm_node *roots, uint32_t m, const char *name,
              const char *const *names, dm_put *put, void *ud) {
    if (dm_has_roots(g, roots, m)) return 0;
    dm_node *compact = dm_arena_take(g->arena, m * sizeof *compact);
    dm_graph *small = compact ? dm_compact_graph(g, roots, m, compact) : NULL;
    if (!small) return 0;
    const writer w = {.g = small, .names = names, .put = put, .ud = ud};
    const uint32_t end = dm_mark(small, compact, m);
    format(&w, "/* %u operations; in[%u], out[%u] */\nvoid ",
           (unsigned)dm_operations(small, compact, m), (unsigned)g->inputs, (unsigned)m);
    text(&w, name);
    text(&w, "(const double *in, double *out) {\n");
    dm_mark(small, compact, m);
    if (!body(&w, end)) return 0;
    for (uint32_t i = 0; i < m; i++) {
        format(&w, "    out[%u] = ", (unsigned)i);
        operand(&w, compact[i]);
        text(&w, ";\n");
    }
    text(&w, "}\n");
    return 1;
}

/* reciprocal roots only where the text calls them */
void dm_emit_c_head(dm_put *put, void *ud, const char *body) {
    static const char library[] = "#include <math.h>\n\n",
                      root[] = "static inline double reciprocal_root(double x) {\n"
                               "    return 1.0 / sqrt(x);\n"
                               "}\n\n",
                      root3[] = "static inline double reciprocal_root3(double x) {\n"
                                "    return 1.0 / (x * sqrt(x));\n"
                                "}\n\n";
    put(ud, library, sizeof library - 1);
    if (strstr(body, "reciprocal_root(")) put(ud, root, sizeof root - 1);
    if (strstr(body, "reciprocal_root3(")) put(ud, root3, sizeof root3 - 1);
}
