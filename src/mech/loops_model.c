/* loops_model.c - a Lagrangian with sums over many bodies as a model without n x n tables. It
 * is one when dL/dv_i depends on v_i alone, linearly and by a factor that is a number: then the
 * mass is constant and diagonal, and since mixed derivatives are symmetric, L is separable. One
 * sweep over the graph and one look at the term of each sum decide that, whatever the number of
 * bodies. */
#include "mech/model.h"

#include "algebra/derive.h"
#include "chain/curvature.h"
#include "chain/lattice.h"
#include "chain/loops.h"
#include "chain/virtual_work.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"

#include <math.h>
#include <string.h>

/* a model in the making */
typedef struct {
    dm_model *m;
    dm_graph *g;
    dm_node L;
    const dm_node *gradient; /* [2n] with the sums held; NULL: they all vanish */
    double *mass;            /* [n] */
    dm_node energy;          /* sum of v dL/dv over what depends on v */
} builder;

/* input number of column c when it is a velocity, else 0 */
static int is_velocity(const builder *b, const dm_column *c) {
    return !c->data && c->first >= b->m->n && c->first < 2 * b->m->n;
}

/* ---- what stands outside of sums ---- */

enum { NONE = UINT32_MAX, MANY = UINT32_MAX - 1 };

/* the one input that each node depends on: only[end] */
static void find_only_inputs(const dm_graph *g, uint32_t *only, uint32_t end) {
    for (dm_node k = 0; k < end; k++) {
        const dm_expr *e = dm_graph_at(g, k);
        uint32_t one = e->op == DM_OP_INPUT ? e->as.input : NONE;
        for (int a = 0; a < dm_op_operands(e->op); a++) {
            const uint32_t other = only[e->as.arg[a]];
            if (other == NONE || other == one) continue;
            one = one == NONE ? other : MANY;
        }
        only[k] = one;
    }
}

/* every dL/dv_i depends on v_i alone, and vanishes with it */
static int is_own_momentum(const builder *b, const dm_node *momentum, dm_status *status) {
    const uint32_t n = b->m->n, end = dm_graph_size(b->g);
    dm_arena *arena = dm_graph_arena(b->g);
    uint32_t *only = dm_arena_take(arena, (end + 1) * sizeof *only);
    dm_node *with = dm_arena_take(arena, (dm_graph_inputs(b->g) + n + 1) * sizeof *with);
    if (!only || !with) *status = DM_NO_MEMORY;
    if (*status != DM_OK) return 0;
    find_only_inputs(b->g, only, end);
    for (uint32_t i = 0; i < n; i++)
        if (momentum[i] && only[momentum[i]] != n + i) return 0;
    dm_node *rest = with + dm_graph_inputs(b->g);
    memset(with, 0, dm_graph_inputs(b->g) * sizeof *with);
    dm_substitute(b->g, momentum, n, with, rest);
    for (uint32_t i = 0; i < n; i++)
        if (rest[i]) return 0;
    return 1;
}

/* d/dv_i of the sum of all dL/dv_j is d2L/dv_i^2, the others being zero */
static int read_direct_mass(builder *b, dm_status *status) {
    const uint32_t n = b->m->n;
    *status = DM_OK;
    if (!b->gradient) return 1;
    const dm_node *momentum = b->gradient + n;
    dm_node sum = 0, *curve = dm_arena_take(dm_graph_arena(b->g), (n + 1) * sizeof *curve);
    *status = curve ? DM_OK : DM_NO_MEMORY;
    if (!curve) return 0;
    for (uint32_t i = 0; i < n; i++) sum = dm_add(b->g, sum, momentum[i]);
    if (!sum) return 1;
    if (!is_own_momentum(b, momentum, status)) return 0;
    dm_gradient(b->g, sum, n, n, curve);
    for (uint32_t i = 0; i < n; i++) {
        if (!dm_is_constant(b->g, curve[i], b->mass + i)) return 0;
        const dm_node v = dm_input(b->g, n + i);
        b->energy = dm_add(b->g, b->energy, dm_mul(b->g, v, momentum[i]));
    }
    return 1;
}

/* ---- sums ---- */

/* the slope of a term in column c: it depends on that column and on data, linearly and without a
 * constant; *curve is then its derivative */
static int is_own_slope(const dm_sum *s, dm_node slope, uint32_t c, dm_node *curve) {
    dm_node with[DM_LOOP_COLUMNS], rest;
    for (uint32_t k = 0; k < s->columns; k++) {
        with[k] = k == c ? 0 : dm_input(s->term, k);
        if (k != c && !s->column[k].data && dm_depends(s->term, &slope, 1, k, 1)) return 0;
    }
    dm_gradient(s->term, slope, c, 1, curve);
    dm_substitute(s->term, &slope, 1, with, &rest);
    return !dm_depends(s->term, curve, 1, c, 1) && rest == 0;
}

/* mass += factor * curve, a function of the data of a body */
static dm_status add_mass(builder *b, const dm_sum *s, uint32_t c, double factor, dm_node curve) {
    double in[DM_LOOP_COLUMNS] = {0}, value = 0.0;
    dm_kernel k;
    const dm_status status = dm_tape_build(&k, s->term, &curve, 1, dm_graph_arena(b->g));
    if (status != DM_OK) return status;
    dm_kernel_prepare(&k, &value);
    for (uint32_t i = 0; i < s->bodies; i++) {
        for (uint32_t a = 0; a < s->columns; a++)
            if (s->column[a].data) in[a] = s->column[a].data[dm_sum_entry(s, s->column + a, i, 0)];
        dm_kernel_eval(&k, in, &value);
        b->mass[dm_sum_entry(s, s->column + c, i, 0) - b->m->n] += factor * value;
    }
    return DM_OK;
}

/* the part of one sum in mass and energy; 0: it is not of the simple kind */
static int read_sum(builder *b, const dm_sum *s, dm_status *status) {
    dm_node factor, slope[DM_LOOP_COLUMNS], energy = 0, curve;
    double value = 0.0;
    dm_gradient(b->g, b->L, s->input, 1, &factor);
    if (!factor) return 1;
    dm_gradient(s->term, s->value, 0, s->columns, slope);
    for (uint32_t c = 0; c < s->columns; c++) {
        if (!slope[c] || !is_velocity(b, s->column + c)) continue;
        if (s->column[c].partner || !s->column[c].step || s->from != s->to || s->from) return 0;
        if (!dm_is_constant(b->g, factor, &value)) return 0;
        if (!is_own_slope(s, slope[c], c, &curve)) return 0;
        *status = add_mass(b, s, c, value, curve);
        if (*status != DM_OK) return 0;
        energy = dm_add(s->term, energy, dm_mul(s->term, dm_input(s->term, c), slope[c]));
    }
    if (energy) {
        const dm_node part = dm_sum_of(b->g, s, energy);
        b->energy = dm_add(b->g, b->energy, dm_mul(b->g, factor, part));
    }
    return 1;
}

/* outside of sums first, then sum by sum */
static int read_mass(builder *b, dm_status *status) {
    int fits = read_direct_mass(b, status);
    for (const dm_sum *s = dm_sums(b->g); s && fits; s = s->next) fits = read_sum(b, s, status);
    if (*status == DM_OK) *status = dm_graph_status(b->g);
    return fits && *status == DM_OK;
}

/* ---- the rest of the structure ---- */

/* coordinates that a sum reads are not cyclic; one that reads t is not autonomous */
static void forget_cyclic(const builder *b, uint8_t *cyclic, const dm_sum *s) {
    for (uint32_t c = 0; c < s->columns; c++) {
        const dm_column *column = s->column + c;
        if (column->data || !dm_depends(s->term, &s->value, 1, c, 1)) continue;
        if (column->first == 2 * b->m->n) b->m->structure &= ~(unsigned)DM_AUTONOMOUS;
        if (column->first >= b->m->n) continue;
        for (uint32_t i = 0; i < s->bodies; i++) cyclic[dm_sum_entry(s, column, i, 0)] = 0;
    }
}

/* does a sum of virtual work depend on velocities? */
static int reads_rates(const builder *b, const dm_sum *s) {
    for (uint32_t c = 0; c < s->columns; c++)
        if (is_velocity(b, s->column + c) && dm_depends(s->term, &s->value, 1, c, 1)) return 1;
    return 0;
}

/* coordinates that L does not depend on, and whether it depends on t */
static dm_status read_cyclic(const builder *b) {
    const uint32_t n = b->m->n;
    uint8_t *cyclic = dm_arena_take(b->m->source.arena, n + 1);
    if (!cyclic) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < n; i++) cyclic[i] = !b->gradient || b->gradient[i] == 0;
    if (dm_depends(b->g, &b->L, 1, 2 * n, 1)) b->m->structure &= ~(unsigned)DM_AUTONOMOUS;
    for (const dm_sum *s = dm_sums(b->g); s; s = s->next) {
        forget_cyclic(b, cyclic, s);
        if (s->work) b->m->worked |= reads_rates(b, s) ? DM_WORKED | DM_WORKED_BY_RATES : DM_WORKED;
    }
    b->m->cyclic = cyclic;
    return DM_OK;
}

/* K:field looks at the masses that L has there; L may read something that has changed since */
static const char *why_unfit(const builder *b) {
    const dm_model *m = b->m;
    for (uint32_t i = 0; i < m->n; i++) {
        const int held = m->held ? m->held[i] : 0;
        if (held == DM_MASSLESS && b->mass[i] != 0.0)
            return "what L reads has changed since K:field, and values that it eliminated have a "
                   "mass now; make the field anew";
        if (!held && b->mass[i] < 0.0)
            return "what L reads has changed since K:field, and some values have a negative mass "
                   "now: every explicit rule is unstable there, whatever its step";
        if (m->sphere && !held &&
            fabs(b->mass[i] - b->mass[i - i % m->sphere]) > 1e-14 * b->mass[i])
            return "what L reads has changed since K:field, and values of one unit vector have "
                   "unlike masses now, which rattle does not know";
    }
    return NULL;
}

/* as a diagonal model has it: 1/m, m, no shift */
static dm_status keep_mass(const builder *b) {
    const uint32_t n = b->m->n;
    double *inverse = dm_arena_take(b->m->source.arena, 2 * (size_t)n * sizeof *inverse);
    if (!inverse) return DM_NO_MEMORY;
    double *shift = inverse + n;
    memset(shift, 0, n * sizeof *shift);
    const dm_sum *cells = dm_sum_over_cells(b->g);
    if (cells) {
        b->m->held = cells->held;
        for (uint32_t i = 0; cells->held && i < n; i++)
            b->m->massless += cells->held[i] == DM_MASSLESS;
        b->m->sphere = cells->sphere;
        b->m->mass_matrix = b->mass; /* also where it is singular */
        b->m->unfit = why_unfit(b);
    }
    for (uint32_t i = 0; i < n; i++) {
        const int held = b->m->held && b->m->held[i];
        if (held) b->mass[i] = inverse[i] = 0.0; /* whatever its momentum, it stays */
        if (held) continue;
        if (!isfinite(1.0 / b->mass[i])) return DM_SINGULAR;
        inverse[i] = 1.0 / b->mass[i];
    }
    b->m->mass_matrix = b->mass;
    b->m->inverse_mass = inverse;
    b->m->momentum_shift = shift;
    return DM_OK;
}

/* along arrays where that can be, else sum by sum */
static dm_status make_gradient(const builder *b, dm_kernel *out, int momenta) {
    const dm_model *m = b->m;
    dm_status status = DM_TOO_LARGE;
    if (m->inverse_mass)
        status = dm_lattice_gradient(out, &m->source, m->n, momenta ? m->mass_matrix : NULL);
    if (status != DM_TOO_LARGE) return status;
    return dm_loops_gradient(out, b->g, b->L, b->gradient, momenta ? 2 * m->n : m->n,
                             m->source.compile, m->source.arena);
}

/* of the sums that the force is made of, in their order */
static dm_status make_curvature(const builder *b) {
    dm_arena *arena = b->m->source.arena;
    uint32_t count = 0;
    for (const dm_sum *s = dm_sums(b->g); s; s = s->next) count++;
    dm_node *factor = dm_arena_take(arena, (count + 1) * sizeof *factor);
    b->m->curvature = dm_arena_take(arena, sizeof *b->m->curvature);
    if (!factor || !b->m->curvature) return DM_NO_MEMORY;
    const dm_sum **sums = dm_cells_sums(b->g, b->L, factor, &count, arena);
    if (!sums) return DM_NO_MEMORY;
    return dm_curvature_open(b->m->curvature, sums, count, b->m->n, b->m->source.compile, arena);
}

/* forces beside L, where some are there */
static dm_status make_work(const builder *b) {
    dm_arena *arena = b->m->source.arena;
    if (!b->m->worked) return DM_OK;
    b->m->work = dm_arena_take(arena, sizeof *b->m->work);
    if (!b->m->work) return DM_NO_MEMORY;
    return dm_work_open(b->m->work, b->g, b->m->n, b->m->source.compile, arena);
}

/* value, force, slope and energy, as far as they are wanted; stages would want n x n tables */
static dm_status make_kernels(const builder *b, unsigned want) {
    dm_model *m = b->m;
    dm_compile *compile = m->source.compile;
    dm_arena *arena = m->source.arena;
    dm_status status = DM_OK;
    if (want & DM_WANT_VALUE) status = dm_loops_value(&m->value, b->g, b->L, compile, arena);
    if (status == DM_OK && want & DM_WANT_FORCE) status = make_gradient(b, &m->force, 0);
    if (status == DM_OK && want & DM_WANT_FORCE) status = make_work(b);
    if (status == DM_OK && want & DM_WANT_SLOPE) status = make_gradient(b, &m->slope, 1);
    if (status == DM_OK && want & DM_WANT_ENERGY) {
        const dm_node energy = dm_sub(b->g, b->energy, b->L);
        status = dm_loops_value(&m->energy, b->g, energy, compile, arena);
    }
    if (status == DM_OK && want & DM_WANT_CURVATURE) status = make_curvature(b);
    m->has |= want;
    return status;
}

/* derivatives outside of sums; sums over cells leave nothing there but t, whatever their number of
 * entries */
static dm_status find_gradient(builder *b) {
    const uint32_t inputs = 2 * b->m->n;
    if (dm_sum_over_cells(b->g) && !dm_depends(b->g, &b->L, 1, 0, inputs)) return DM_OK;
    dm_node *gradient = dm_arena_take(b->m->source.arena, inputs * sizeof *gradient);
    if (!gradient) return DM_NO_MEMORY;
    dm_gradient(b->g, b->L, 0, inputs, gradient);
    b->gradient = gradient;
    return DM_OK;
}

/* *fits says whether sums stay loops; where they do not, nothing of *m is to be used */
dm_status dm_loops_model(dm_model *m, dm_graph *g, dm_node L, unsigned want, int *fits) {
    builder b = {.m = m, .g = g, .L = L};
    const size_t n = m->n;
    dm_status status = DM_OK;
    b.mass = dm_arena_take(m->source.arena, (n + 1) * sizeof *b.mass);
    if (!b.mass) return DM_NO_MEMORY;
    memset(b.mass, 0, n * sizeof *b.mass);
    status = find_gradient(&b);
    if (status != DM_OK) return status;
    *fits = read_mass(&b, &status);
    if (!*fits || status != DM_OK) return status;
    m->structure = DM_SEPARABLE | DM_CONSTANT_MASS | DM_DIAGONAL_MASS | DM_AUTONOMOUS |
                   DM_QUADRATIC_IN_V | DM_LOOPS | (dm_sum_over_cells(g) ? DM_CELLS : 0u);
    status = read_cyclic(&b);
    if (status != DM_OK) return status;
    const dm_status mass = keep_mass(&b);
    if (mass != DM_OK && mass != DM_SINGULAR) return mass;
    m->operations = dm_operations(g, &L, 1);
    m->source.sums = g;
    m->source.lagrangian = L;
    m->source.gradient = b.gradient;
    m->source.energy = b.energy;
    status = make_kernels(&b, want);
    return status == DM_OK ? mass : status;
}

dm_status dm_loops_more(dm_model *m, unsigned want, dm_compile *compile) {
    const builder b = {.m = m,
                       .g = m->source.sums,
                       .L = m->source.lagrangian,
                       .gradient = m->source.gradient,
                       .energy = m->source.energy};
    m->source.compile = compile;
    const dm_status status = make_kernels(&b, want & ~m->has & ~(unsigned)DM_WANT_DENSE);
    if (status == DM_OK) m->has |= want;
    return status == DM_OK && !m->inverse_mass ? DM_SINGULAR : status;
}
