/* bind_sum.c - dm.sum_over: a sum over equal bodies, neighbours or pairs. On numbers and
 * hyper-dual numbers it is a loop; in a Lagrangian that is traced the function is called once, with
 * symbols of its own, and the sum stays a loop in the kernels (algebra/body_sum.h). */
#include "algebra/body_sum.h"
#include "algebra/implicit.h"
#include "bind/trace/apart.h"
#include "bind/trace/given.h"
#include "bind/trace/sum_request.h"
#include "bind/trace/traced_call.h"
#include "bind/value/array.h"
#include "bind/value/trace_log.h"
#include "numbers/compensated.h"

#include <math.h>
#include <string.h>

enum { FEWEST_ROUNDS = 16 /* fewer are written out at once */ };

typedef dml_sum_request request;

/* Bodies that have a partner at this distance; with shift 0 all. */
static uint32_t rounds(const request *r, uint32_t shift) {
    return r->periodic ? r->bodies : r->bodies - shift;
}

/* ---- the loop in Lua ---- */

/* the first vector: the positions of pairs within a distance */
static int place_of(const request *r) {
    int k = 1;
    while (k < r->given && !r->width[k]) k++;
    return k;
}

/* the value of an entry of the positions, of whatever kind */
static double position(lua_State *L, const request *r, uint32_t body, uint32_t axis) {
    const dml_scalar x = dml_get(lua_touserdata(L, place_of(r)), body * r->axes + axis);
    if (x.kind == DML_SYMBOL)
        luaL_error(L, "dm.sum_over: which pairs are within a distance is asked of numbers, or of L "
                      "of a system that is stepped by an explicit rule; here it is asked of "
                      "symbols");
    return x.kind == DML_HYPERDUAL ? x.as.hyper.f : x.as.number;
}

/* Are bodies i and j near? image[axes]: what is taken from j's position to have its image that is
 * nearest to i. */
static int is_near(lua_State *L, const request *r, uint32_t i, uint32_t j, double *image) {
    double sum = 0.0;
    for (uint32_t a = 0; a < r->axes; a++) {
        const double d = position(L, r, j, a) - position(L, r, i, a);
        image[a] = r->box[a] > 0.0 ? r->box[a] * nearbyint(d / r->box[a]) : 0.0;
        sum += (d - image[a]) * (d - image[a]);
    }
    return !(sum >= r->within * r->within); /* what is no number is not left out */
}

/* entry of argument k, for what its nearest image is */
static dml_scalar entry_of(lua_State *L, const request *r, int k, uint32_t i, const double *image) {
    const dml_scalar x = dml_get(lua_touserdata(L, k), i);
    if (!image || k != place_of(r) || image[i % r->axes] == 0.0) return x;
    const dml_scalar away = {.kind = DML_NUMBER, .as.number = image[i % r->axes]};
    return dml_apply(L, DM_OP_SUB, &x, &away, NULL);
}

/* push what a body has of every vector; image: NULL, or what positions are moved by */
static void push_body(lua_State *L, const request *r, uint32_t body, const double *image) {
    for (int k = 1; k <= r->given; k++) {
        const uint32_t width = r->width[k];
        if (!width) continue;
        const dml_array *a = lua_touserdata(L, k);
        const dml_scalar kind = dml_kindof(a);
        if (width == 1) {
            const dml_scalar x = entry_of(L, r, k, body, image);
            dml_pushscalar(L, &x);
            continue;
        }
        dml_array *v = dml_newarray(L, 1, width, 1, &kind);
        for (uint32_t i = 0; i < width; i++) {
            const dml_scalar x = entry_of(L, r, k, body * width + i, image);
            dml_put(L, v, i, &x);
        }
    }
}

/* One round of the function; its result is a scalar of any kind. */
static dml_scalar call(lua_State *L, const request *r, uint32_t i, uint32_t shift) {
    double image[3] = {0.0};
    const uint32_t j = (i + shift) % r->bodies;
    if (r->axes) is_near(L, r, i, j, image);
    lua_pushvalue(L, r->fn);
    push_body(L, r, i, NULL);
    if (r->to) push_body(L, r, j, r->axes ? image : NULL);
    for (int k = 1; k <= r->given; k++)
        if (!r->width[k]) lua_pushvalue(L, k);
    dml_callone(L, r->signature.arguments, r->signature.what);
    const int result = lua_gettop(L);
    dml_result_length(L, &r->signature, result);
    const dml_scalar x = dml_result_entry(L, &r->signature, result, 0);
    lua_settop(L, result - 1);
    return x;
}

/* numbers are summed with compensation; all else by the operations of its kind */
static int loop_in_lua(lua_State *L, const request *r) {
    double sum = 0.0, low = 0.0;
    dml_scalar total = {.kind = DML_NUMBER};
    for (uint32_t shift = r->from; shift <= r->to; shift++)
        for (uint32_t i = 0; i < rounds(r, shift); i++) {
            double image[3];
            if (r->axes && !is_near(L, r, i, i + shift, image)) continue;
            const dml_scalar x = call(L, r, i, shift);
            if (x.kind == DML_NUMBER)
                dm_sum_add(&sum, &low, x.as.number);
            else
                total = dml_apply(L, DM_OP_ADD, &total, &x, NULL);
        }
    const dml_scalar numbers = {.kind = DML_NUMBER, .as.number = sum + low};
    if (total.kind != DML_NUMBER)
        total = dml_apply(L, DM_OP_ADD, &total, &numbers, NULL);
    else
        total = numbers;
    dml_pushscalar(L, &total);
    return 1;
}

/* ---- the loop of a trace ---- */

/* the trace that the symbols among the arguments belong to; NULL: there are none, or a mixture,
 * or its function is not one that keeps loops */
static dml_frame *find_trace(lua_State *L, const request *r) {
    dml_frame *frame = NULL;
    for (int k = 1; k <= r->given; k++) {
        dml_scalar x;
        if (!dml_toscalar(L, k, &x)) x = dml_kindof(lua_touserdata(L, k));
        if (x.kind == DML_NUMBER) continue;
        dml_frame *own = x.kind == DML_SYMBOL ? dml_findframe(L, x.serial) : NULL;
        if (!own || (frame && own != frame)) return NULL;
        frame = own;
    }
    return frame && frame->keeps_sums ? frame : NULL;
}

/* the entries of argument k: neighbouring inputs of the graph from *first on, or numbers */
static int is_run_of_inputs(const dml_frame *frame, const dml_array *a, uint32_t *first) {
    const dm_node inputs = dm_sum_first(frame->graph), *nodes = dml_nodesof(a);
    dm_node differ = 0;
    if (!a->rows || !nodes[0] || nodes[0] > inputs || a->rows > inputs) return 0;
    for (uint32_t i = 0; i < a->rows; i++) differ |= nodes[i] ^ (nodes[0] + i);
    *first = nodes[0] - 1; /* input i is node i + 1 of every trace */
    return !differ && *first + a->rows <= inputs;
}

/* what argument k is in the graph: inputs from first on, or a copy of its numbers */
static int find_entries(lua_State *L, const request *r, const dml_frame *frame, int k,
                        dm_column *out) {
    dml_scalar x;
    const int scalar = r->width[k] == 0;
    const dml_array *a = scalar ? NULL : lua_touserdata(L, k);
    const uint32_t n = scalar ? 1 : a->rows;
    *out = (dm_column){.step = r->width[k]};
    x = scalar && dml_toscalar(L, k, &x) ? x : dml_kindof(a);
    if (x.kind == DML_SYMBOL && !scalar) return is_run_of_inputs(frame, a, &out->first);
    if (x.kind == DML_SYMBOL) {
        const dm_expr *e = dm_graph_at(frame->graph, x.as.node);
        out->first = e->as.input;
        return e->op == DM_OP_INPUT && e->as.input < dm_sum_first(frame->graph);
    }
    double *data = dm_arena_take(frame->arena, n * sizeof *data);
    if (!data) luaL_error(L, "not enough memory");
    for (uint32_t i = 0; i < n; i++) data[i] = scalar ? x.as.number : dml_get(a, i).as.number;
    out->data = data;
    return 1;
}

/* columns in the order of the function's arguments; 0 where the pattern is not one for a loop */
static int make_columns(lua_State *L, const request *r, const dml_frame *frame, dm_sum *s,
                        dm_column *column) {
    dm_column of[DML_SUM_VECTORS + 1];
    for (int k = 1; k <= r->given; k++)
        if (!find_entries(L, r, frame, k, of + k)) return 0;
    for (int part = 0; part < 3; part++)
        for (int k = 1; k <= r->given; k++) {
            const uint32_t width = part < 2 ? r->width[k] : !r->width[k];
            if ((part == 1 && !r->to) || (part == 2) != (r->width[k] == 0)) continue;
            for (uint32_t c = 0; c < width; c++) {
                if (s->columns == DML_SUM_COLUMNS) return 0;
                column[s->columns] = of[k];
                column[s->columns].first += c;
                column[s->columns++].partner = part == 1;
            }
        }
    s->column = column;
    for (s->partner = 0; r->axes && !column[s->partner].partner; s->partner++) {}
    return 1;
}

/* trace the function on symbols of its own; *last: a trace that it may repeat, or NULL */
static void trace_term(lua_State *L, const request *r, const dml_frame *frame, dm_sum *s,
                       const dml_traced *last, dml_traced *out) {
    dml_retrace(L, r->fn, &r->signature, frame->arena, last, out);
    s->term = out->graph;
    s->value = out->out[0];
}

/* the leaf of the sum that was noted next, where this is it again; 0: it is another one */
static dm_node repeat_sum(lua_State *L, const request *r, dml_frame *frame, dm_sum *s) {
    const dml_summed *next = dml_nextsum(frame);
    dml_traced traced;
    if (!next || !dm_sum_alike(next->sum, s)) return 0;
    trace_term(L, r, frame, s, &next->term, &traced);
    return traced.graph == next->term.graph ? dml_sumagain(frame) : 0;
}

/* The sum becomes a leaf of the graph, or is written out where roots are in its term. */
static int keep_loop(lua_State *L, const request *r, dml_frame *frame, dm_sum *s) {
    dml_traced traced;
    dml_scalar x = {.kind = DML_SYMBOL, .serial = frame->serial};
    x.as.node = repeat_sum(L, r, frame, s);
    if (!x.as.node) {
        trace_term(L, r, frame, s, NULL, &traced);
        if (dm_has_roots(s->term, &s->value, 1)) return loop_in_lua(L, r);
        x.as.node = dml_sumanew(L, frame, s, &traced);
    }
    dml_checkgraph(L, frame);
    dml_pushscalar(L, &x);
    return 1;
}

/* ---- a sum that is given ---- */

/* the sum that this call of dm.sum_over became in the trace; NULL: none. Newer ones are made of
 * it. */
static const dm_sum *find_given(const dml_given *given, const request *r) {
    const dm_sum *found = NULL;
    for (const dm_sum *s = dm_sums(given->graph); s; s = s->next)
        if (s->call == given->calls) found = s;
    if (!found || found->bodies != r->bodies) return NULL;
    return found->from == r->from && found->to == r->to ? found : NULL;
}

/* entry of column c, which the function takes, in a round */
static double column_value(lua_State *L, const request *r, uint32_t c, uint32_t i, uint32_t shift) {
    const uint32_t bodies[3] = {i, (i + shift) % r->bodies, 0};
    double image[3] = {0.0};
    if (r->axes) is_near(L, r, i, bodies[1], image);
    for (int part = 0; part < 3; part++)
        for (int k = 1; k <= r->given; k++) {
            const uint32_t width = part < 2 ? r->width[k] : !r->width[k];
            if ((part == 1 && !r->to) || (part == 2) != (r->width[k] == 0)) continue;
            if (c >= width) {
                c -= width;
                continue;
            }
            if (part == 2) return lua_tonumber(L, k);
            const double *moved = r->axes && part == 1 ? image : NULL;
            return entry_of(L, r, k, bodies[part] * width + c, moved).as.number;
        }
    return 0.0;
}

/* one round, plain and as it was traced */
static void compare_round(lua_State *L, const request *r, dml_given *given, const dm_sum *s,
                          uint32_t i) {
    double in[DML_SUM_COLUMNS];
    const dml_scalar plain = call(L, r, i, r->from);
    for (uint32_t c = 0; c < s->columns; c++) in[c] = column_value(L, r, c, i, r->from);
    double *work = lua_newuserdatauv(L, (s->value + 1) * sizeof *work, 0);
    const double traced = dm_sum_term(s, in, work);
    lua_pop(L, 1);
    if (plain.kind == DML_NUMBER)
        dml_given_compare(given, "dm.sum_over", i, rounds(r, r->from), plain.as.number, traced);
}

/* The number that stands in the comparison, after some rounds were looked at. */
static int give(lua_State *L, const request *r, dml_given *given, const dm_sum *s) {
    const double *values = given->values;
    const uint32_t all = rounds(r, r->from), stride = dml_given_stride(given, all);
    given->values = NULL; /* sums inside of the function are loops */
    for (uint32_t i = 0; i + 1 < all; i += stride) compare_round(L, r, given, s, i);
    compare_round(L, r, given, s, all - 1);
    given->values = values;
    lua_pushnumber(L, values[s->input - dm_sum_first(given->graph)]);
    return 1;
}

/* Numbers are summed in a loop; symbols of a trace that keeps sums make a leaf. */
static int sum_over(lua_State *L) {
    request r = {.bodies = 0};
    dml_state *state = dml_getstate(L);
    luaL_checkstack(L, 2 * DML_MAX_ARGUMENTS + 20, NULL);
    dml_read_sum(L, &r);
    if (r.from > r.to) return loop_in_lua(L, &r); /* pairs of one body: none */
    dml_given *given = dml_sumsgiven(state);
    if (given) {
        const dm_sum *summed = find_given(given, &r);
        given->calls++;
        if (summed) return give(L, &r, given, summed);
    }
    dml_frame *frame = find_trace(L, &r);
    dm_sum s = {.bodies = r.bodies, .from = r.from, .to = r.to, .periodic = r.periodic};
    s.within = r.within, s.margin = r.margin, s.axes = r.axes;
    memcpy(s.box, r.box, sizeof s.box);
    if (state->frames) s.call = state->frames->sums++;
    if (!frame || (!r.axes && dm_sum_all_rounds(&s) < FEWEST_ROUNDS)) return loop_in_lua(L, &r);
    dm_column *column = dm_arena_take(frame->arena, DML_SUM_COLUMNS * sizeof *column);
    if (!column) return luaL_error(L, "not enough memory");
    if (!make_columns(L, &r, frame, &s, column)) return loop_in_lua(L, &r);
    return keep_loop(L, &r, frame, &s);
}

static const dml_row functions[] =
    {{"sum_over", sum_over,
      "dm.sum_over(x, ..., f [, {shift=, periodic=, pairs=, within=, margin=, box=, block=}]) -> "
      "number\n"
      "Sum of f over equal bodies. f gets what a body has of every vector (f(x_i, u_i, m_i) for "
      "dm.sum_over(q, v, masses, f)), numbers are passed on as they are, behind. shift = k: f also "
      "gets the same of body i + k (f(x_i, x_j)), periodic = true: the last ones meet the first. "
      "pairs = true: all pairs i < j. within = r: of these the ones nearer than r alone, by the "
      "positions in the first vector (1 to 3 coordinates), found by lists that are kept until a "
      "body has moved margin/2 (margin: r/10 by default); box = L or a list of sides "
      "(math.huge: open): a periodic box, sides at least 2 (r + margin), in which f gets the "
      "image of x_j that is nearest to x_i. A term that does not end at 0 at the distance r makes "
      "the energy jump there. block = 3: a body has 3 neighbouring entries, f gets "
      "vectors. In L of a system f is traced once and the sum stays a loop in the kernels: a chain "
      "of 10^5 bodies costs 100 times one of 10^3. f must not use other arguments of L than those "
      "it is given. Loops are for explicit rules, for kinetic energies that are sums of m v^2/2 "
      "and without constraints; implicit rules, constraints and forces write the sums out, up to "
      "400 coordinates, but none within a distance."},
     {NULL, NULL, NULL}};

const dml_class dml_class_sum = {
    .functions = functions,
};
