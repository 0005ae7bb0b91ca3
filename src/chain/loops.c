/* loops.c - whole kernels of expressions with sums: the straight-line part, and the loops of the
 * sums that it depends on. */
#include "chain/loops.h"

#include "algebra/derive.h"
#include "chain/cells.h"
#include "chain/rounds.h"
#include "graph/analyse.h"

#include <string.h>

/* what an expression with sums needs: the graph's part takes x, then the sums */
typedef struct {
    dm_kernel outer;
    double *x; /* [inputs of the graph]: x and the values of the sums */
    double *y; /* [outputs of `outer`]: what does not vanish, then the factors */
    uint32_t inputs, values, slopes, m, direct;
    dm_rounds *value;  /* [values] sums that the outer kernel reads */
    dm_rounds *slope;  /* [slopes] */
    uint32_t *at;      /* [direct] number of the output */
    dm_cells *cells;   /* slopes of sums over cells, behind the others, or NULL */
    double *cell_work; /* their scratch; where others are there too, [m] for their gradient */
} whole;

/* values of sums first, then the straight-line kernel */
static void eval_outer(const whole *w, const double *x, double *y) {
    memcpy(w->x, x, w->inputs * sizeof *x);
    for (uint32_t k = 0; k < w->values; k++)
        w->x[w->value[k].sum->input] = dm_rounds_value(w->value + k, x);
    dm_kernel_eval(&w->outer, w->x, y);
}

/* one output */
static void eval_value(const void *pool, const double *x, double *out) {
    eval_outer(pool, x, out);
}

/* behind what is there, by way of a scratch of its own: cells are added up first */
static void add_cells(const whole *w, double *out, const double *x) {
    double *own = w->cell_work + w->cells->work;
    dm_cells_gradient(w->cells, own, w->y + w->direct + w->slopes, x, w->cell_work);
    for (uint32_t i = 0; i < w->m; i++) out[i] += own[i];
}

/* direct derivatives, then those by way of the sums */
static void eval_gradient(const void *pool, const double *x, double *out) {
    const whole *w = pool;
    if (w->outer.eval) eval_outer(w, x, w->y);
    if (w->cells && !w->direct && !w->slopes) {
        dm_cells_gradient(w->cells, out, w->y, x, w->cell_work);
        return;
    }
    memset(out, 0, w->m * sizeof *out);
    for (uint32_t k = 0; k < w->direct; k++) out[w->at[k]] = w->y[k];
    for (uint32_t k = 0; k < w->slopes; k++)
        dm_rounds_slopes(w->slope + k, out, w->y[w->direct + k], x);
    if (w->cells) add_cells(w, out, x);
}

/* of the graph */
static uint32_t count_sums(const dm_graph *g) {
    uint32_t count = 0;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) count++;
    return count;
}

/* with room for everything but x, NULL without memory */
static whole *new_whole(dm_graph *g, uint32_t m, uint32_t outputs, dm_arena *arena) {
    const uint32_t sums = count_sums(g);
    whole *w = dm_arena_take(arena, sizeof *w);
    if (!w) return NULL;
    *w = (whole){.inputs = dm_sum_first(g), .m = m};
    w->y = dm_arena_take(arena, (outputs + 1) * sizeof *w->y);
    w->at = dm_arena_take(arena, (outputs + 1) * sizeof *w->at);
    w->value = dm_arena_take(arena, (sums + 1) * sizeof *w->value);
    w->slope = dm_arena_take(arena, (sums + 1) * sizeof *w->slope);
    return w->y && w->at && w->value && w->slope ? w : NULL;
}

/* x, where a kernel reads it */
static dm_status make_inputs(whole *w, const dm_graph *g, dm_arena *arena) {
    const uint32_t inputs = dm_graph_inputs(g);
    w->x = dm_arena_take(arena, inputs * sizeof *w->x);
    if (!w->x) return DM_NO_MEMORY;
    memset(w->x, 0, inputs * sizeof *w->x);
    return DM_OK;
}

/* the kernel of roots[m] and the loops of the sums that they depend on */
static dm_status make_outer(whole *w, dm_graph *g, const dm_node *roots, uint32_t m,
                            dm_compile *compile, dm_arena *arena) {
    dm_status status = DM_OK;
    for (const dm_sum *s = dm_sums(g); s && status == DM_OK; s = s->next)
        if (dm_depends(g, roots, m, s->input, 1))
            status = dm_rounds_of_value(w->value + w->values++, s, compile, arena);
    w->outer.backend = "tape";
    return status == DM_OK && m ? compile(&w->outer, g, roots, m, arena) : status;
}

/* operations of one evaluation, saturated */
static uint32_t operations(const whole *w) {
    double count = w->outer.operations;
    for (uint32_t k = 0; k < w->values; k++)
        count += dm_sum_all_rounds(w->value[k].sum) * (w->value[k].one.operations + 1.0);
    for (uint32_t k = 0; k < w->slopes; k++)
        count += dm_sum_all_rounds(w->slope[k].sum) *
                 (w->slope[k].one.operations + 2.0 * w->slope[k].outputs);
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

dm_status dm_loops_value(dm_kernel *out, dm_graph *g, dm_node root, dm_compile *compile,
                         dm_arena *arena) {
    whole *w = new_whole(g, 1, 1, arena);
    if (!w) return DM_NO_MEMORY;
    dm_status status = make_outer(w, g, &root, 1, compile, arena);
    if (status == DM_OK) status = make_inputs(w, g, arena);
    if (status != DM_OK) return status;
    *out = w->outer;
    out->eval = eval_value;
    out->pool = w;
    out->inputs = w->inputs;
    out->operations = operations(w);
    return DM_OK;
}

const dm_kernel *dm_loops_outer(const dm_kernel *value, const double **x) {
    const whole *w = value->pool;
    *x = w->x;
    return &w->outer;
}

/* loops of the sums that f depends on; their factors df/dS behind the direct parts in roots */
static dm_status make_slopes(whole *w, dm_graph *g, dm_node root, dm_node *roots,
                             dm_compile *compile, dm_arena *arena) {
    dm_status status = DM_OK;
    for (const dm_sum *s = dm_sums(g); s && status == DM_OK; s = s->next) {
        dm_node factor;
        dm_gradient(g, root, s->input, 1, &factor);
        if (!factor || s->cells) continue;
        status = dm_rounds_of_slopes(w->slope + w->slopes, s, w->m, compile, arena);
        if (w->slope[w->slopes].outputs) roots[w->direct + w->slopes++] = factor;
    }
    return status;
}

/* the same for sums over cells, all together; their factors come last */
static dm_status make_cells(whole *w, dm_graph *g, dm_node root, dm_node *roots, uint32_t *factors,
                            dm_compile *compile, dm_arena *arena) {
    const dm_sum **sums = dm_cells_sums(g, root, roots + w->direct + w->slopes, factors, arena);
    if (sums && !*factors) return DM_OK;
    w->cells = sums ? dm_arena_take(arena, sizeof *w->cells) : NULL;
    if (!w->cells) return DM_NO_MEMORY;
    const dm_status status = dm_cells_open(w->cells, sums, *factors, w->m, compile, arena);
    const size_t room = w->cells->work + (w->direct || w->slopes ? w->m : 0) + 1;
    w->cell_work = status == DM_OK ? dm_arena_take(arena, room * sizeof *w->cell_work) : NULL;
    return status == DM_OK && !w->cell_work ? DM_NO_MEMORY : status;
}

/* constants need no kernel at run time */
static void drop_constant_outer(whole *w, uint32_t m) {
    uint32_t fixed = 0;
    dm_kernel_prepare(&w->outer, w->y);
    for (uint32_t i = 0; i < m; i++) fixed += w->outer.fixed && w->outer.fixed[i];
    if (fixed == m) w->outer.eval = NULL;
}

dm_status dm_loops_gradient(dm_kernel *out, dm_graph *g, dm_node root, const dm_node *nodes,
                            uint32_t m, dm_compile *compile, dm_arena *arena) {
    uint32_t most = count_sums(g);
    for (uint32_t i = 0; nodes && i < m; i++) most += nodes[i] != 0;
    whole *w = new_whole(g, m, most, arena);
    dm_node *roots = dm_arena_take(arena, (most + 1) * sizeof *roots);
    if (!w || !roots) return DM_NO_MEMORY;
    for (uint32_t i = 0; nodes && i < m; i++) {
        if (!nodes[i]) continue;
        w->at[w->direct] = i;
        roots[w->direct++] = nodes[i];
    }
    uint32_t factors = 0;
    dm_status status = make_slopes(w, g, root, roots, compile, arena);
    if (status == DM_OK) status = make_cells(w, g, root, roots, &factors, compile, arena);
    const uint32_t roots_count = w->direct + w->slopes + factors;
    if (status == DM_OK) status = make_outer(w, g, roots, roots_count, compile, arena);
    if (status != DM_OK) return status;
    drop_constant_outer(w, roots_count);
    if (w->outer.eval) status = make_inputs(w, g, arena);
    if (status != DM_OK) return status;
    *out = (dm_kernel){.eval = eval_gradient,
                       .pool = w,
                       .inputs = w->inputs,
                       .outputs = m,
                       .operations = operations(w),
                       .backend = w->outer.backend};
    return DM_OK;
}

int dm_loops_lend(const dm_kernel *gradient, dm_team *team) {
    int lent = 0;
    if (gradient->eval != eval_gradient) return 0;
    const whole *w = gradient->pool;
    for (uint32_t k = 0; k < w->slopes; k++) {
        dm_pairs *pairs = w->slope[k].pairs;
        if (!pairs || !dm_pairs_shared(pairs)) continue;
        pairs->team = team;
        lent = 1;
    }
    return lent;
}

const dm_cells *dm_loops_cells(const dm_kernel *gradient) {
    if (gradient->eval != eval_gradient) return NULL;
    const whole *w = gradient->pool;
    return w->direct || w->slopes ? NULL : w->cells;
}

const double *dm_loops_factors(const dm_kernel *gradient, const double *x) {
    const whole *w = gradient->pool;
    if (w->outer.eval) eval_outer(w, x, w->y);
    return w->y;
}

int dm_loops_constant(const dm_kernel *gradient) {
    return !((const whole *)gradient->pool)->outer.eval;
}
