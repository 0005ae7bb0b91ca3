/* log_loop.c - the parts of a logarithmic-Hamiltonian step as graphs, and their loop.
 * Speed: P1-0.9: 1.6x by log-hamiltonian(kahan-li(8)), against kernels called one by one. */
#include "integ/split/log_loop.h"

#include "algebra/compact.h"
#include "algebra/derive.h"
#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "integ/split/fused.h"

#include <math.h>
#include <string.h>

/* what a model keeps: it serves every composition and every h */
struct dm_log_loop {
    dm_kicks kicks; /* L_q/U */
    dm_node well;   /* U, compacted */
    dm_loop_part part[DM_LOOP_PARTS];
    dm_loop one, many; /* for one member, for lanes; what is carried is the state */
    double *spread;    /* lanes: coefficients */
    dm_lanes lanes;
};

/* ---- parts of the loop: head: drift; body: kick, drift; tail: a look at the well ---- */

/* x where c > 0, else NaN, which stops the run */
static dm_node guarded(dm_fusion *b, dm_node c, dm_node x) {
    const dm_node nan = dm_constant(b->graph, NAN);
    return dm_apply(b->graph, DM_OP_WHERE, c, x, nan);
}

/* start + v . moved, as two sums that do not wait for each other */
static dm_node fuse_product(dm_fusion *b, dm_node start, const dm_node *v, const dm_node *moved) {
    dm_node even = dm_multiply_add(b->graph, v[0], moved[0], start), odd = 0;
    for (uint32_t i = 1; i < b->model->n; i++) {
        dm_node *sum = i % 2 ? &odd : &even;
        *sum = *sum ? dm_multiply_add(b->graph, v[i], moved[i], *sum)
                    : dm_mul(b->graph, v[i], moved[i]);
    }
    return odd ? dm_add(b->graph, even, odd) : even;
}

/* where every factor is a quotient over the same d: d; else 0 */
static dm_node denominator(const dm_fusion *b, const dm_node *factors) {
    dm_node d = 0;
    if (!(b->model->structure & DM_DIAGONAL_MASS)) return 0;
    for (uint32_t i = 0; i < b->model->n; i++) {
        const dm_expr *x = dm_graph_at(b->graph, factors[b->kicks->which[i]]);
        if (b->kicks->constant[i] != 0.0 || b->kicks->coordinate[i] < 0 || x->op != DM_OP_DIV)
            return 0;
        if (d && x->as.arg[1] != d) return 0;
        d = x->as.arg[1];
    }
    return d;
}

/* p += hb L_q/U; what the drift needs of it: d and y[n] = d p, made before the quotients are
 * known; 0: p itself */
static dm_node fuse_kick(dm_fusion *b, dm_node *y, dm_node *factors) {
    const uint32_t n = b->model->n;
    const dm_node hb = dm_fusion_coefficient(b), minus = dm_fusion_coefficient(b);
    dm_fusion_factors(b, factors, 0, hb, minus);
    const dm_node d = denominator(b, factors);
    for (uint32_t i = 0; i < n && d; i++) {
        const dm_expr *x = dm_graph_at(b->graph, factors[b->kicks->which[i]]);
        const dm_node above = x->as.arg[0];
        const dm_node kick = dm_mul(b->graph, above, b->q[b->kicks->coordinate[i]]);
        y[i] = dm_multiply_add(b->graph, b->p[i], d, kick);
    }
    for (uint32_t i = 0; i < n; i++) {
        b->low_p[i] = dm_fusion_constant(b, i, hb, b->low_p[i]);
        dm_fusion_add_product(b, b->p + i, b->low_p + i, dm_fusion_kick(b, factors, i, hb));
    }
    return d;
}

/* t += dt, q += dt v with dt = ha/(T + B) = 2 ha d^2 / (d v . d (p - shift) + 2 B d^2): so the
 * division does not wait for the one of the kick. scratch[2 n]; d and y = d p as above. */
static void fuse_drift(dm_fusion *b, dm_node *scratch, dm_node d, const dm_node *y) {
    const uint32_t n = b->model->n;
    dm_node *v = scratch, *moved = v + n;
    dm_node above = dm_fusion_coefficient(b);
    dm_node start = dm_add(b->graph, b->more[2], b->more[2]);
    dm_fusion_velocity(b, v, moved, d ? y : b->p);
    if (d) {
        const dm_node d2 = dm_mul(b->graph, d, d);
        above = dm_mul(b->graph, above, d2);
        start = dm_mul(b->graph, start, d2);
    }
    const dm_node speed = fuse_product(b, start, v, moved);
    const dm_node dt = dm_div(b->graph, above, speed);
    dm_fusion_velocity(b, v, NULL, b->p);
    for (uint32_t i = 0; i < n; i++)
        dm_fusion_add_product(b, b->q + i, b->low_q + i, (dm_product){dt, v[i]});
    const dm_node z = dm_add(b->graph, b->more[1], dt);
    dm_fusion_sum(b, b->more, b->more + 1, z);
    b->more[1] = guarded(b, speed, b->more[1]);
}

/* t's low part becomes NaN where the well is not attracting */
static void fuse_look(dm_fusion *b, const dm_log_loop *l) {
    dm_node well = 0;
    memcpy(b->with, b->q, b->model->n * sizeof *b->q);
    dm_transplant(b->graph, b->model->source.graph, &l->well, 1, b->with, &well);
    b->more[1] = guarded(b, well, b->more[1]);
}

/* Scratch: v and the moved momenta of a drift, y = d p and the factors of a kick. */
static int fuse_part(const dm_model *m, const dm_log_loop *l, dm_loop_kind kind,
                     dm_loop_part *out) {
    dm_fusion b;
    const size_t n = m->n;
    dm_node *scratch = dm_arena_take(m->source.arena, 4 * n * sizeof *scratch), d = 0;
    if (!scratch || !dm_fusion_begin(&b, m, &l->kicks, 4 * m->n + DM_STATE_OWN)) return 0;
    if (kind == DM_LOOP_BODY) d = fuse_kick(&b, scratch + 2 * n, scratch + 3 * n);
    if (kind == DM_LOOP_TAIL)
        fuse_look(&b, l);
    else
        fuse_drift(&b, scratch, d, scratch + 2 * n);
    return dm_fusion_end(&b, out);
}

/* Head, body and tail. */
static int fuse(const dm_model *m, dm_log_loop *l) {
    for (int kind = DM_LOOP_HEAD; kind <= DM_LOOP_TAIL; kind++)
        if (!fuse_part(m, l, (dm_loop_kind)kind, l->part + kind)) return 0;
    return 1;
}

/* What is carried is the whole state, its own time too. */
static int build(dm_loop *out, const dm_model *m, const dm_log_loop *l, uint32_t lanes) {
    return dm_fused_build(out, m, l->part, 4 * m->n + DM_STATE_OWN, lanes);
}

/* L_q/U and U in the graph of the model, where they simplify: -q/r^2 for Kepler */
static int read_pulls(dm_log_loop *l, const dm_model *m) {
    const dm_source *s = &m->source;
    dm_node *out = dm_arena_take(s->arena, m->n * sizeof *out);
    if (!out) return 0;
    for (uint32_t i = 0; i < m->n; i++) out[i] = dm_div(s->graph, s->gradient[i], s->potential);
    if (!dm_kicks_read(&l->kicks, m, out, 1)) return 0;
    dm_compact(s->graph, &s->potential, 1, &l->well);
    return dm_graph_status(s->graph) == DM_OK;
}

/* in the arena of the model, which keeps it */
dm_log_loop *dm_log_loop_open(const dm_model *m) {
    static const char maker;
    dm_kernel kept;
    if (dm_cache_find(&kept, m, &maker, 0)) return (dm_log_loop *)(uintptr_t)kept.pool;
    dm_log_loop *l = m->source.graph ? dm_arena_take(m->source.arena, sizeof *l) : NULL;
    if (l) *l = (dm_log_loop){0};
    if (!l || !read_pulls(l, m) || !fuse(m, l) || !build(&l->one, m, l, 1)) return NULL;
    dm_cache_add(m, &maker, 0, &(dm_kernel){.pool = l}, 1);
    return l;
}

/* Coefficients are the same for all lanes: steps have one h. */
int dm_log_loop_widen(dm_log_loop *l, const dm_model *m, dm_lanes *x) {
    if (l->spread && l->lanes.lanes == dm_jit_lanes()) return *x = l->lanes, 1;
    l->spread = NULL;
    if (!l->one.native || !dm_lanes_open(x, m, 4 * m->n + DM_STATE_OWN)) return 0;
    if (!build(&l->many, m, l, x->lanes)) return 0;
    x->together = l->many.together;
    if (x->groups % x->together != 0) return 0;
    l->lanes = *x;
    l->spread =
        dm_arena_take(m->source.arena, DM_LOG_LOOP_WORK * (size_t)x->lanes * sizeof *l->spread);
    return l->spread != NULL;
}

/* ---- running ---- */

/* of a step: 2 h a_0, then h b_k, -h b_k, 2 h a_k; they stay for the next run */
static void put_step(double *c, const dm_log_burst *x) {
    double *h = c + DM_LOG_LOOP_WORK - 1;
    if (*h == x->h) return;
    *h = x->h;
    for (int k = 0; k < x->table->stages; k++) {
        if (k) *c++ = x->h * x->table->b[k], *c++ = -x->h * x->table->b[k];
        *c++ = 2.0 * x->h * x->table->a[k];
    }
}

/* All steps in one call: coefficients do not depend on the time. */
void dm_log_loop_run(const dm_log_loop *l, double *state, const dm_log_burst *x, double *work) {
    put_step(work, x);
    dm_loop_call call = {.state = state,
                         .coefficients = work,
                         .groups = 1,
                         .repeats = x->table->stages - 1,
                         .steps = x->count};
    dm_loop_run(&l->one, &call);
}

/* The coefficients once for each lane. */
void dm_log_loop_run_lanes(const dm_log_loop *l, dm_lanes *lanes, const dm_log_burst *x,
                           double *work) {
    const uint32_t each = 3 * (uint32_t)x->table->stages - 2, width = lanes->lanes;
    put_step(work, x);
    for (size_t i = 0; i < each; i++)
        for (uint32_t lane = 0; lane < width; lane++) l->spread[i * width + lane] = work[i];
    dm_loop_call call = {.state = lanes->state,
                         .coefficients = l->spread,
                         .groups = lanes->groups,
                         .repeats = x->table->stages - 1,
                         .steps = x->count};
    dm_loop_run(&l->many, &call);
}
