/* constraints.c - derivatives, structure and kernels of constraints and forces. */
#include "mech/constraints.h"

#include "algebra/derive.h"
#include "graph/analyse.h"

#include <string.h>

/* room for at least one node, so that a length of zero is no special case */
static dm_node *take_nodes(dm_arena *arena, size_t count) {
    return dm_arena_take(arena, (count + 1) * sizeof(dm_node));
}

/* ---- structure ---- */

/* which functions see t and v, by their graphs */
static unsigned read_structure(dm_graph *g, const dm_constraints *t) {
    const uint32_t n = t->n, k = t->holonomic, l = t->rolling, time = 2 * n;
    unsigned has = 0;
    if (k && dm_depends(g, t->g, k, time, 1)) has |= DM_CONSTRAINTS_MOVING | DM_CONSTRAINTS_TIMED;
    if (l && dm_depends(g, t->phi, l, time, 1)) has |= DM_CONSTRAINTS_TIMED;
    if (l && dm_depends(g, t->E, l * n, time, 1)) has |= DM_CONSTRAINTS_TIMED;
    if (t->f && dm_depends(g, t->f, t->forces, time, 1)) has |= DM_CONSTRAINTS_TIMED;
    if (t->controls && dm_depends(g, t->u, t->controls, time, 1)) has |= DM_CONSTRAINTS_TIMED;
    if (t->f && dm_depends(g, t->f, t->forces, n, n)) has |= DM_CONSTRAINTS_FORCE_SEES_V;
    if (!l || !dm_depends(g, t->phi_v, l * n, n, n)) has |= DM_CONSTRAINTS_LINEAR;
    return has;
}

/* entries of G that can differ from zero */
static dm_status read_pattern(dm_constraints *t) {
    const size_t count = (size_t)t->holonomic * t->n;
    uint8_t *touches = dm_arena_take(t->arena, count + 1);
    if (!touches) return DM_NO_MEMORY;
    for (size_t i = 0; i < count; i++) touches[i] = t->G[i] != 0; /* node 0 is zero */
    t->touches = touches;
    return DM_OK;
}

static int meet(const dm_row *a, const dm_row *b) {
    return a->from < b->to && b->from < a->to;
}

static dm_status read_rows(dm_constraints *t) {
    const uint32_t n = t->n, k = t->holonomic;
    dm_row *rows = dm_arena_take(t->arena, (k + (size_t)1) * sizeof *rows);
    if (!rows) return DM_NO_MEMORY;
    for (uint32_t c = 0; c < k; c++) {
        const uint8_t *touches = t->touches + c * (size_t)n;
        dm_row *row = rows + c;
        *row = (dm_row){0, n, 0};
        while (row->from < n && !touches[row->from]) row->from++;
        while (row->to > row->from && !touches[row->to - 1]) row->to--;
        while (row->first < c && !meet(row, rows + row->first)) row->first++;
    }
    t->rows = rows;
    return DM_OK;
}

/* rows of dg/dq become those of g(q near(e)) in e, with zeros behind them */
static int turn_to_group(const dm_constraints_traced *x, dm_node *G, dm_arena *arena) {
    const uint32_t n = x->n, d = x->momenta;
    dm_node *row = take_nodes(arena, n);
    if (!row) return 0;
    for (uint32_t c = 0; c < x->holonomic; c++, G += n) {
        memcpy(row, G, n * sizeof *row);
        memset(G, 0, n * sizeof *G);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t a = 0; row[i] && a < d; a++) {
                const dm_node term = dm_mul(x->graph, row[i], x->directions[i * d + a]);
                G[a] = dm_add(x->graph, G[a], term);
            }
    }
    return 1;
}

/* derivatives of what was traced; E is phi_v unless it is given */
dm_status dm_constraints_build(dm_constraints *out, const dm_constraints_traced *x,
                               dm_arena *arena) {
    const uint32_t n = x->n, k = x->holonomic, l = x->rolling;
    dm_node *G = take_nodes(arena, (size_t)k * n), *g_t = take_nodes(arena, k);
    dm_node *phi_v = take_nodes(arena, (size_t)l * n);
    if (!G || !g_t || !phi_v) return DM_NO_MEMORY;
    if (k) dm_jacobian(x->graph, x->g, k, 0, n, G);
    if (k && x->directions && !turn_to_group(x, G, arena)) return DM_NO_MEMORY;
    if (k) dm_jacobian(x->graph, x->g, k, 2 * n, 1, g_t);
    if (l) dm_jacobian(x->graph, x->phi, l, n, n, phi_v);
    dm_constraints t = {.n = n,
                        .holonomic = k,
                        .rolling = l,
                        .forced = x->f != NULL,
                        .forces = x->forces,
                        .controls = x->controls,
                        .crossings = x->crossings,
                        .prolonged = x->prolonged,
                        .u = x->u,
                        .graph = x->graph,
                        .g = x->g,
                        .G = G,
                        .g_t = g_t,
                        .phi = x->phi,
                        .E = x->E ? x->E : phi_v,
                        .phi_v = phi_v,
                        .f = x->f,
                        .arena = arena};
    if (dm_graph_status(x->graph) != DM_OK) return dm_graph_status(x->graph);
    t.structure = read_structure(x->graph, &t) | (x->E ? DM_CONSTRAINTS_GIVEN_REACTIONS : 0u);
    dm_status status = read_pattern(&t);
    if (status == DM_OK) status = read_rows(&t);
    if (status == DM_OK) *out = t;
    return status;
}

/* zero everywhere */
static int all_zero(const dm_node *row, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        if (row[i]) return 0;
    return 1;
}

/* known of the nodes, without a point */
uint32_t dm_constraints_idle(const dm_constraints *t) {
    const size_t n = t->n;
    for (uint32_t i = 0; i < t->holonomic; i++)
        if (all_zero(t->G + i * n, t->n)) return i;
    for (uint32_t i = 0; i < t->rolling; i++)
        if (all_zero(t->phi_v + i * n, t->n)) return t->holonomic + i;
    return t->holonomic + t->rolling;
}

/* ---- kernels ---- */

/* roots of a kernel under construction */
typedef struct {
    dm_constraints *t;
    dm_node *roots;
    size_t count;
} list;

/* room for so many roots */
static int begin(list *b, dm_constraints *t, size_t room) {
    *b = (list){.t = t, .roots = take_nodes(t->arena, room)};
    return b->roots != NULL;
}

/* the next roots */
static void add(list *b, const dm_node *nodes, size_t count) {
    if (count) memcpy(b->roots + b->count, nodes, count * sizeof *nodes);
    b->count += count;
}

/* derivatives of f[m] in the n inputs from `first` */
static void add_jacobian(list *b, const dm_node *f, uint32_t m, uint32_t first) {
    dm_jacobian(b->t->graph, f, m, first, b->t->n, b->roots + b->count);
    b->count += (size_t)m * b->t->n;
}

/* all of them as one kernel */
static dm_status end(list *b, dm_kernel *out, unsigned which, dm_compile *compile) {
    dm_constraints *t = b->t;
    dm_status status = dm_graph_status(t->graph);
    if (status == DM_OK) status = compile(out, t->graph, b->roots, (uint32_t)b->count, t->arena);
    if (status == DM_OK) t->has |= which;
    return status;
}

/* g, G, g_t */
static dm_status make_holonomic(dm_constraints *t, dm_compile *compile) {
    const size_t k = t->holonomic;
    list b;
    if (!begin(&b, t, k * (t->n + (size_t)2))) return DM_NO_MEMORY;
    add(&b, t->g, k);
    add(&b, t->G, k * t->n);
    add(&b, t->g_t, k);
    return end(&b, &t->holonomic_kernel, DM_WANT_HOLONOMIC, compile);
}

/* phi, E, phi_v, phi_q */
static dm_status make_rolling(dm_constraints *t, dm_compile *compile) {
    const size_t l = t->rolling;
    list b;
    if (!begin(&b, t, l + 3 * l * t->n)) return DM_NO_MEMORY;
    add(&b, t->phi, l);
    add(&b, t->E, l * t->n);
    add(&b, t->phi_v, l * t->n);
    add_jacobian(&b, t->phi, t->rolling, 0);
    return end(&b, &t->rolling_kernel, DM_WANT_ROLLING, compile);
}

/* u, which a step evaluates once, at its start */
static dm_status make_control(dm_constraints *t, dm_compile *compile) {
    list b;
    if (!begin(&b, t, t->controls)) return DM_NO_MEMORY;
    add(&b, t->u, t->controls);
    return end(&b, &t->control, DM_WANT_CONSTRAINT_FORCE, compile);
}

/* f */
static dm_status make_force(dm_constraints *t, dm_compile *compile) {
    list b;
    if (!begin(&b, t, t->forces)) return DM_NO_MEMORY;
    add(&b, t->f, t->forces);
    return end(&b, &t->force, DM_WANT_CONSTRAINT_FORCE, compile);
}

/* f, f_q, f_v */
static dm_status make_force_curve(dm_constraints *t, dm_compile *compile) {
    const size_t forces = t->forces;
    list b;
    if (!begin(&b, t, forces + 2 * forces * t->n)) return DM_NO_MEMORY;
    add(&b, t->f, forces);
    add_jacobian(&b, t->f, t->forces, 0);
    add_jacobian(&b, t->f, t->forces, t->n);
    return end(&b, &t->force_curve, DM_WANT_FORCE_CURVE, compile);
}

/* r[i] += sum_j lambda_j A_ji; the multipliers are inputs from `first` */
static void add_reaction(dm_constraints *t, dm_node *r, const dm_node *A, uint32_t rows,
                         uint32_t first) {
    for (uint32_t j = 0; j < rows; j++) {
        const dm_node lambda = dm_input(t->graph, first + j);
        for (uint32_t i = 0; i < t->n; i++) {
            const dm_node term = dm_mul(t->graph, A[j * (size_t)t->n + i], lambda);
            r[i] = dm_add(t->graph, r[i], term);
        }
    }
}

/* r = G^T lambda + E^T mu with its derivatives, the multipliers held */
static dm_status make_reaction(dm_constraints *t, dm_compile *compile) {
    const size_t n = t->n;
    list b;
    dm_node *r = take_nodes(t->arena, n);
    if (!r || !begin(&b, t, n + 2 * n * n)) return DM_NO_MEMORY;
    memset(r, 0, n * sizeof *r);
    add_reaction(t, r, t->G, t->holonomic, 2 * t->n + 1);
    add_reaction(t, r, t->E, t->rolling, 2 * t->n + 1 + t->holonomic);
    add(&b, r, n);
    add_jacobian(&b, r, t->n, 0);
    add_jacobian(&b, r, t->n, t->n);
    return end(&b, &t->reaction, DM_WANT_REACTION, compile);
}

void dm_constraints_add_force(double *sum, const dm_constraints *constraints, const double *x,
                              double *f) {
    if (!constraints || !constraints->forced) return;
    dm_kernel_prepare(&constraints->force, f);
    dm_kernel_eval(&constraints->force, x, f);
    for (uint32_t i = 0; i < constraints->n; i++) sum[i] += f[i];
}

/* One after the other, the first refusal ends it; what is there is not made again. */
dm_status dm_constraints_want(dm_constraints *t, unsigned want, dm_compile *compile) {
    const unsigned missing = want & ~t->has;
    dm_status status = DM_OK;
    if (missing & DM_WANT_HOLONOMIC && t->holonomic) status = make_holonomic(t, compile);
    if (status == DM_OK && missing & DM_WANT_ROLLING && t->rolling)
        status = make_rolling(t, compile);
    if (status == DM_OK && missing & DM_WANT_CONSTRAINT_FORCE && t->controls)
        status = make_control(t, compile);
    if (status == DM_OK && missing & DM_WANT_CONSTRAINT_FORCE && t->forced)
        status = make_force(t, compile);
    if (status == DM_OK && missing & DM_WANT_FORCE_CURVE && t->forced)
        status = make_force_curve(t, compile);
    if (status == DM_OK && missing & DM_WANT_REACTION && t->holonomic + t->rolling)
        status = make_reaction(t, compile);
    return status;
}
