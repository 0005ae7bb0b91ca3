/* group_joints.c - kernels of steps with constraints, and of many bodies: with the entries of their
 * matrices that are not zero, since those of joints are few. */
#include "algebra/derive.h"
#include "code/loops/equal_parts.h"
#include "graph/analyse.h"
#include "mech/constraints.h"
#include "mech/group_inside.h"

#include <string.h>

/* what all kernels are made with */
typedef struct {
    dm_joining j;
    uint32_t k, l, m; /* constraints, rolling constraints, both */
    dm_graph *pull;   /* inputs xi[d], mu[d]: */
    dm_node *pulled;  /* [d] dtau_R(xi)^T mu */
    dm_group_bodies bodies;
    dm_compile *compile;
} making;

/* the inputs of a graph that derivatives are taken in; nobody asks for those in the first ones and
 * in the one at gap; body[inputs] as of dm_equal_parts_build */
typedef struct {
    uint32_t first, count, gap, unasked;
    const uint32_t *body;
} columns;

/* What tells the bodies is a kernel too. */
static dm_status open_bodies(making *b) {
    b->pull = dm_graph_new(b->j.arena, 2 * b->j.d);
    b->pulled = dm_joining_take(&b->j, b->j.d);
    if (!b->pull || !b->pulled) return DM_NO_MEMORY;
    const dm_status status = dm_joining_pull(&b->j, b->pull, b->pulled);
    return status == DM_OK ? dm_group_bodies_find(&b->bodies, &b->j, b->pull, b->pulled) : status;
}

/* rows, columns of slope[values * in.count] that are not zero */
static int list_entries(dm_group_entries *out, const making *b, const dm_node *slope, columns in) {
    const size_t all = (size_t)out->values * in.count;
    for (size_t i = 0; i < all; i++) out->count += slope[i] != 0;
    uint32_t *row = dm_arena_take(b->j.arena, (2 * (size_t)out->count + 1) * sizeof *row);
    if (!row) return 0;
    uint32_t *column = row + out->count;
    out->row = row;
    out->column = column;
    for (size_t i = 0; i < all; i++) {
        if (!slope[i]) continue;
        *row++ = (uint32_t)(i / in.count);
        *column++ = (uint32_t)(i % in.count);
    }
    return 1;
}

/* key[values]: the first coordinate that each value sees */
static void find_keys(uint32_t *key, const dm_group_entries *f, uint32_t d, columns in) {
    for (uint32_t i = 0; i < f->values; i++) key[i] = d;
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t coordinate = f->column[i] % d;
        const int is_multiplier = f->column[i] > in.gap;
        if (!is_multiplier && coordinate < key[f->row[i]]) key[f->row[i]] = coordinate;
    }
    for (uint32_t i = 0; i < f->values; i++)
        if (key[i] == d) key[i] = i % d;
}

/* numbers first .. last of the outputs by the keys of their values, behind the others; returns how
 * many there are then */
static uint32_t sort(uint32_t *order, const dm_group_entries *f, const uint32_t *key,
                     uint32_t count, uint32_t d) {
    uint32_t done = 0;
    for (uint32_t a = 0; a < d; a++)
        for (uint32_t i = 0; i < count; i++)
            if (key[i < f->values ? i : f->row[i - f->values]] == a) order[done++] = i;
    return done;
}

/* roots[count] in their order where bodies are equal, else in that of `order` (out->order NULL,
 * and it) */
static dm_status compile_with(dm_kernel *out, const uint32_t **order, const making *b, dm_graph *g,
                              dm_node *roots, uint32_t count, const uint32_t *body) {
    dm_arena *arena = b->j.arena;
    dm_status status =
        body ? dm_equal_parts_build(out, g, roots, count, body, b->bodies.count, b->compile, arena)
             : DM_NO_MEMORY;
    if (status != DM_OK) return status;
    const uint32_t *sorted = *order;
    if (out->eval) *order = NULL;
    if (out->eval) return DM_OK;
    dm_node *given = dm_joining_take(&b->j, count);
    if (!given) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) given[i] = roots[sorted[i]];
    return b->compile(out, g, given, count, arena);
}

/* those that are asked for stand for what is not zero: 0 and 1 into slope */
static void ask(dm_node *slope, uint32_t count, columns in) {
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < in.count; k++)
            slope[i * (size_t)in.count + k] = k >= in.unasked && k != in.gap;
}

/* the matrix row by row, in a graph of its own, where it cannot be written out */
static dm_status make_by_rows(dm_group_entries *out, const making *b, dm_graph *g,
                              const dm_node *values, uint32_t count, columns in) {
    dm_node *slope = dm_joining_take(&b->j, (size_t)count * in.count);
    if (!slope) return DM_NO_MEMORY;
    *out = (dm_group_entries){.values = count};
    ask(slope, count, in);
    if (!list_entries(out, b, slope, in)) return DM_NO_MEMORY;
    const dm_status status =
        dm_group_map_make(&out->map, g, values, count, in.first, in.count, b->compile, b->j.arena);
    out->plain = out->map.plain;
    return status;
}

/* copies of the values in a graph of their own, where their matrix may be too large; else NULL */
static dm_graph *keep(const making *b, dm_graph *g, const dm_node *values, uint32_t count,
                      columns in, dm_node *kept) {
    const uint32_t inputs = dm_graph_inputs(g);
    if (dm_operations(g, values, count) < DM_GRAPH_LIMIT / in.count) return NULL;
    dm_graph *copy = dm_graph_new(b->j.arena, inputs);
    dm_node *with = dm_joining_take(&b->j, inputs);
    if (!copy || !with) return NULL;
    dm_inputs(copy, with, 0, inputs);
    dm_transplant(copy, g, values, count, with, kept);
    return copy;
}

/* values[count] and those entries of their derivatives that are not zero */
static dm_status make(dm_group_entries *out, const making *b, dm_graph *g, const dm_node *values,
                      uint32_t count, columns in) {
    const size_t all = (size_t)count * in.count;
    dm_node *slope = dm_joining_take(&b->j, all), *roots = dm_joining_take(&b->j, count + all);
    uint32_t *key = dm_joining_take(&b->j, count), *order = dm_joining_take(&b->j, 2 * count + all);
    if (!slope || !roots || !key || !order) return DM_NO_MEMORY;
    dm_graph *kept = keep(b, g, values, count, in, roots);
    dm_jacobian(g, values, count, in.first, in.count, slope);
    if (kept && dm_graph_status(g) == DM_TOO_LARGE)
        return make_by_rows(out, b, kept, roots, count, in);
    for (uint32_t i = 0; i < count; i++) {
        memset(slope + (size_t)i * in.count, 0, in.unasked * sizeof *slope);
        if (in.gap < in.count) slope[i * in.count + in.gap] = 0;
    }
    *out = (dm_group_entries){.values = count, .plain_order = order, .order = order + count};
    if (!list_entries(out, b, slope, in)) return DM_NO_MEMORY;
    find_keys(key, out, b->j.d, in);
    sort(order, out, key, count, b->j.d);
    sort(order + count, out, key, count + out->count, b->j.d);
    memcpy(roots, values, count * sizeof *roots);
    for (uint32_t i = 0; i < out->count; i++)
        roots[count + i] = slope[out->row[i] * in.count + out->column[i]];
    dm_status status = dm_graph_status(g);
    if (status == DM_OK)
        status = compile_with(&out->plain, &out->plain_order, b, g, roots, count, in.body);
    if (status == DM_OK)
        status = compile_with(&out->kernel, &out->order, b, g, roots, count + out->count, in.body);
    return status;
}

void dm_group_entries_prepare(const dm_group_entries *f, double *out) {
    double *raw = out + f->values + f->count;
    if (f->map.columns) {
        dm_kernel_prepare(&f->plain, raw);
        return;
    }
    dm_kernel_prepare(&f->kernel, raw);
    dm_kernel_prepare(&f->plain, raw + f->values + f->count);
}

/* values and matrix into raw, then what is listed of them */
static void eval_by_rows(const dm_group_entries *f, const double *in, double *out,
                         int with_entries) {
    double *raw = out + f->values + f->count;
    const dm_group_map *m = &f->map;
    const double *matrix = raw + m->values;
    if (with_entries)
        dm_group_map_eval(m, in, raw, 1, raw + m->values * ((size_t)m->columns + 1));
    else
        dm_kernel_eval(&f->plain, in, raw);
    memcpy(out, raw, f->values * sizeof *out);
    for (uint32_t i = 0; with_entries && i < f->count; i++)
        out[f->values + i] = matrix[(size_t)f->row[i] * m->columns + f->column[i]];
}

void dm_group_entries_eval(const dm_group_entries *f, const double *in, double *out,
                           int with_entries) {
    if (f->map.columns) {
        eval_by_rows(f, in, out, with_entries);
        return;
    }
    const uint32_t count = f->values + (with_entries ? f->count : 0);
    const uint32_t *order = with_entries ? f->order : f->plain_order;
    double *raw = out + f->values + f->count + (with_entries ? 0 : f->values + f->count);
    dm_kernel_eval(with_entries ? &f->kernel : &f->plain, in, raw);
    if (!order) memcpy(out, raw, count * sizeof *out);
    for (uint32_t i = 0; order && i < count; i++) out[order[i]] = raw[i];
}

/* nodes[count] of the joined graph at e = 0, in a graph without e, by their entries */
static dm_status make_at_g0(dm_group_entries *out, const making *b, const dm_node *nodes,
                            uint32_t count, uint32_t unasked) {
    const dm_joining *j = &b->j;
    const uint32_t inputs = j->n + 2 * j->d + 1 + j->extras;
    dm_graph *g = dm_graph_new(j->arena, inputs);
    dm_node *with = dm_joining_take(j, inputs + (size_t)j->d);
    dm_node *values = dm_joining_take(j, count);
    if (!g || !with || !values) return DM_NO_MEMORY;
    dm_inputs(g, with, 0, inputs);
    memset(with + inputs, 0, j->d * sizeof *with);
    dm_transplant(g, j->g, nodes, count, with, values);
    uint32_t *body = dm_group_bodies_of(&b->bodies, j->n, 2, 1 + j->extras, 0);
    if (body && unasked) body[j->n] = DM_NO_BODY; /* a of a straight curve */
    return make(out, b, g, values, count,
                (columns){.first = j->n,
                          .count = 2 * j->d + 1 + b->m,
                          .gap = 2 * j->d,
                          .unasked = unasked,
                          .body = body});
}

/* sum_c lambda_c rows_c[d] with the multipliers from number `first` on */
static void add_rows(const making *b, dm_node *sum, const dm_node *rows, uint32_t count,
                     uint32_t first) {
    const dm_joining *j = &b->j;
    for (uint32_t c = 0; c < count; c++)
        for (uint32_t a = 0; a < j->d; a++) {
            const dm_node term = dm_mul(j->g, rows[c * (size_t)j->n + a], j->extra[first + c]);
            sum[a] = dm_add(j->g, sum[a], term);
        }
}

/* g, then what I does: as the potential lambda . g, and as a force E^T mu */
static dm_status make_reaction(dm_group_joints *out, making *b) {
    dm_joining *j = &b->j;
    const dm_constraints *c = j->m->constraints;
    const uint32_t n = j->n, d = j->d, k = b->k, l = b->l, e = n + 2 * d + 1 + j->extras;
    dm_node *nodes = dm_joining_take(j, k + 2 * (size_t)d), *f = dm_joining_take(j, d);
    dm_node *rows = dm_joining_take(j, (size_t)l * n);
    dm_node *with = dm_joining_at_element(j, dm_graph_inputs(c->graph)), sum = 0;
    if (!nodes || !f || !rows || !with) return DM_NO_MEMORY;
    dm_transplant(j->g, c->graph, c->g, k, with, nodes);
    for (uint32_t i = 0; i < k; i++) sum = dm_add(j->g, sum, dm_mul(j->g, nodes[i], j->extra[i]));
    dm_gradient(j->g, sum, e, d, nodes + k);
    dm_gradient(j->g, sum, n, d, nodes + k + d);
    memcpy(with + n, j->extra + b->m, d * sizeof *with);
    dm_transplant(j->g, c->graph, c->E, l * n, with, rows);
    out->turns = l && dm_depends(j->g, rows, l * n, n + 2 * d + 1 + b->m, d);
    memset(f, 0, d * sizeof *f);
    add_rows(b, f, rows, l, k);
    if (l && !dm_joining_covector(j, f, nodes + k, nodes + k + d)) return DM_NO_MEMORY;
    return make_at_g0(&out->reaction, b, nodes, k + 2 * d, 0);
}

/* phi */
static dm_status make_rolling(dm_group_joints *out, making *b) {
    dm_joining *j = &b->j;
    const dm_constraints *c = j->m->constraints;
    dm_node *phi = dm_joining_take(j, b->l);
    dm_node *with = dm_joining_at_element(j, dm_graph_inputs(c->graph));
    if (!phi || !with) return DM_NO_MEMORY;
    dm_transplant(j->g, c->graph, c->phi, b->l, with, phi);
    return make_at_g0(&out->rolling, b, phi, b->l, 0);
}

/* nodes of the functions of (q, v, t) of a graph, in that of the hidden constraints */
static dm_status bring(const making *b, dm_graph *to, dm_graph *from, const dm_node *nodes,
                       uint32_t count, dm_node *out) {
    const uint32_t n = b->j.n, d = b->j.d, inputs = dm_graph_inputs(from);
    dm_node *with = dm_joining_take(&b->j, inputs > 2 * n + 1 ? inputs : 2 * n + 1);
    if (!with) return DM_NO_MEMORY;
    memset(with, 0, (inputs > 2 * n + 1 ? inputs : 2 * n + 1) * sizeof *with);
    dm_inputs(to, with, 0, n + d);
    with[2 * n] = dm_input(to, n + d);
    dm_transplant(to, from, nodes, count, with, out);
    return dm_graph_status(to);
}

/* G v + g_t, where g_t stands */
static void add_velocity(const making *b, dm_graph *g, dm_node *g_t, const dm_node *G) {
    const uint32_t n = b->j.n, d = b->j.d;
    for (uint32_t c = 0; c < b->k; c++)
        for (uint32_t a = 0; a < d; a++)
            g_t[c] = dm_add(g, g_t[c], dm_mul(g, G[c * (size_t)n + a], dm_input(g, n + a)));
}

/* L_v - I - p, where L_v stands */
static void subtract_impulse(const making *b, dm_graph *g, dm_node *slope, const dm_node *rows) {
    const uint32_t n = b->j.n, d = b->j.d, first = n + d + 1;
    for (uint32_t a = 0; a < d; a++) {
        slope[a] = dm_sub(g, slope[a], dm_input(g, first + b->m + a));
        for (uint32_t c = 0; c < b->m; c++) {
            const dm_node term = dm_mul(g, rows[c * (size_t)n + a], dm_input(g, first + c));
            slope[a] = dm_sub(g, slope[a], term);
        }
    }
}

/* L_v - I - p, G v + g_t, phi at the end of a step */
static dm_status make_hidden(dm_group_joints *out, making *b) {
    const dm_joining *j = &b->j;
    const dm_constraints *c = j->m->constraints;
    const uint32_t n = j->n, d = j->d, k = b->k, l = b->l;
    dm_graph *g = dm_graph_new(j->arena, n + 2 * d + 1 + b->m);
    dm_node *values = dm_joining_take(j, d + (size_t)b->m);
    dm_node *rows = dm_joining_take(j, (size_t)b->m * n);
    if (!g || !values || !rows) return DM_NO_MEMORY;
    dm_status status = bring(b, g, dm_group_graph(j->m), j->m->source.gradient + n, d, values);
    if (status == DM_OK) status = bring(b, g, c->graph, c->G, k * n, rows);
    if (status == DM_OK) status = bring(b, g, c->graph, c->E, l * n, rows + (size_t)k * n);
    if (status == DM_OK) status = bring(b, g, c->graph, c->g_t, k, values + d);
    if (status == DM_OK) status = bring(b, g, c->graph, c->phi, l, values + d + k);
    if (status != DM_OK) return status;
    add_velocity(b, g, values + d, rows);
    subtract_impulse(b, g, values, rows);
    return make(&out->hidden, b, g, values, d + b->m,
                (columns){.first = n,
                          .count = d + 1 + b->m,
                          .gap = d,
                          .body = dm_group_bodies_of(&b->bodies, n, 1, 1 + b->m, d)});
}

/* by its entries */
static dm_status make_pull(dm_group_joints *out, making *b) {
    const uint32_t d = b->j.d;
    return make(&out->pull, b, b->pull, b->pulled, d,
                (columns){.count = 2 * d,
                          .gap = 2 * d,
                          .body = dm_group_bodies_of(&b->bodies, 0, 2, 0, 0)});
}

/* equal bodies have equal ends */
static dm_status make_finish(dm_group_joints *out, making *b) {
    const uint32_t *body = dm_group_bodies_of(&b->bodies, b->j.n, 2, 0, 0);
    return body ? dm_joining_finish(&b->j, &out->finish, body, b->bodies.count, b->compile)
                : DM_NO_MEMORY;
}

/* multipliers, velocities where reactions turn with them, controls */
static uint32_t extras_of(const making *b, const dm_group *group, const dm_model *m) {
    return b->m + group->momenta + (m->constraints ? m->constraints->controls : 0);
}

/* Constraints that are not there have no kernels. */
static dm_status make_others(dm_group_joints *out, making *b) {
    out->ready = out->curved = out->straight = 0;
    dm_status status = make_pull(out, b);
    if (status == DM_OK && b->m) status = make_reaction(out, b);
    if (status == DM_OK && b->l) status = make_rolling(out, b);
    if (status == DM_OK && b->m) status = make_hidden(out, b);
    if (status == DM_OK) status = make_finish(out, b);
    out->arcs = b->j.trace->arcs;
    out->ready = status == DM_OK;
    return status;
}

/* L along a curve of one velocity, in a joined graph of its own */
static dm_status make_line(dm_group *group, making *b, const dm_model *m, dm_tau tau) {
    const uint32_t d = group->momenta;
    dm_status status = dm_joining_open_line(&b->j, group, m, tau, extras_of(b, group, m), m->n);
    if (status != DM_OK) return status;
    if (!dm_joining_line_slopes(&b->j)) return DM_NO_MEMORY;
    memcpy(b->j.slope + 2 * d, b->j.slope + d, d * sizeof *b->j.slope);
    memset(b->j.slope + d, 0, d * sizeof *b->j.slope);
    status = make_at_g0(&group->joints.line, b, b->j.slope, 3 * d, d);
    group->joints.straight = status == DM_OK;
    return status;
}

/* What is there already stays. */
dm_status dm_group_want_joints(dm_group *group, const dm_model *m, dm_tau tau, int straight,
                               dm_compile *compile) {
    const dm_constraints *c = m->constraints;
    dm_group_joints *out = &group->joints;
    making b = {.k = c ? c->holonomic : 0, .l = c ? c->rolling : 0, .compile = compile};
    const int others = out->ready && out->tau == tau;
    if (others && (straight ? out->straight : out->curved)) return DM_OK;
    b.m = b.k + b.l;
    dm_status status = dm_joining_open(&b.j, group, m, tau, extras_of(&b, group, m));
    if (status == DM_OK) status = open_bodies(&b);
    if (status == DM_OK && !others) status = make_others(out, &b);
    if (status != DM_OK) return status;
    out->tau = tau;
    if (straight) return make_line(group, &b, m, tau);
    if (!dm_joining_slopes(&b.j)) return DM_NO_MEMORY;
    status = make_at_g0(&out->slope, &b, b.j.slope, 3 * b.j.d, 0);
    out->curved = status == DM_OK;
    return status;
}
