/* model.c - a Lagrangian as a model: its structure is read off the derivatives, then the
 * kernels that are wanted are made. L_q and L_v are made once (`gradient`), the mass L_vv from
 * L_v; whether an entry is zero, or a number, is known of its node. Hence separable: L_v
 * depends on v alone; constant mass: every entry of L_vv is a number; linear in v: every entry
 * is node 0.
 *
 * Compaction is most of the work of a kernel, so slope and mass are taken out of the compacted
 * stage where there is one. They round in another way than alone; which kernels a model has is
 * therefore decided by the rule that opens it, never by what ran before.
 *
 * Long because structure and kernels are made of the same derivatives, by one builder. */
#include "mech/model.h"

#include "algebra/body_sum.h"
#include "algebra/compact.h"
#include "algebra/derive.h"
#include "algebra/even.h"
#include "algebra/extremum.h"
#include "algebra/implicit.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"
#include "linalg/blocks.h"
#include "linalg/lu.h"
#include "mech/mass_bounds.h"
#include "mech/mass_convex.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* what is worked on while a model is built; gradient and mass are nodes of g */
typedef struct {
    dm_model m;
    dm_graph *g;
    dm_node L;
    dm_node *gradient; /* [2n] dL/dq, dL/dv */
    dm_node *mass;     /* [n*n] d2L/dv2 */
    dm_node *hessian;  /* [4n*n] in (q, v), of an extremum; else NULL */
    dm_arena *arena;
    dm_compile *compile;
} builder;

/* nodes[count] in the model's arena */
static dm_node *take_nodes(const builder *b, size_t count) {
    return dm_arena_take(b->arena, count * sizeof(dm_node));
}

/* all of nodes[count] are numbers */
static int all_constant(const dm_graph *g, const dm_node *nodes, size_t count) {
    double value;
    for (size_t i = 0; i < count; i++)
        if (!dm_is_constant(g, nodes[i], &value)) return 0;
    return 1;
}

/* node 0 is the only zero */
static int all_zero(const dm_node *nodes, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (nodes[i]) return 0;
    return 1;
}

/* nothing beside the diagonal, anywhere */
static int is_diagonal(const dm_node *mass, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            if (i != j && mass[i * (size_t)n + j]) return 0;
    return 1;
}

/* p = M v + shift: nodes of shift[n], dL/dv at v = 0 */
static dm_status find_shift(const builder *b, dm_node *shift) {
    const uint32_t n = b->m.n, inputs = dm_graph_inputs(b->g);
    dm_node *zero = take_nodes(b, inputs);
    if (!zero) return DM_NO_MEMORY;
    memset(zero, 0, inputs * sizeof *zero);
    dm_substitute(b->g, b->gradient + n, n, zero, shift);
    return dm_graph_status(b->g);
}

/* what derivatives say without being evaluated: DM_* bits, cyclic coordinates */
static dm_status read_structure(builder *b) {
    const uint32_t n = b->m.n;
    const dm_node *momentum = b->gradient + n;
    unsigned has = 0;
    if (!dm_depends(b->g, &b->L, 1, 2 * n, 1)) has |= DM_AUTONOMOUS;
    if (!dm_depends(b->g, momentum, n, 0, n) && !dm_depends(b->g, momentum, n, 2 * n, 1))
        has |= DM_SEPARABLE;
    if (all_constant(b->g, b->mass, (size_t)n * n)) has |= DM_CONSTANT_MASS;
    if (!dm_depends(b->g, b->mass, n * n, n, n)) has |= DM_QUADRATIC_IN_V;
    if (all_zero(b->mass, (size_t)n * n)) has |= DM_LINEAR_IN_V;
    if (all_zero(momentum, n)) has |= DM_NO_VELOCITY;
    b->m.structure = has;
    uint8_t *cyclic = dm_arena_take(b->arena, n);
    if (!cyclic) return DM_NO_MEMORY;
    dm_independent(cyclic, b->g, &b->L, 1, 0, n);
    b->m.cyclic = cyclic;
    b->m.operations = dm_operations(b->g, &b->L, 1);
    return dm_graph_status(b->g);
}

/* the numbers that constant nodes are */
static void read_values(double *out, const dm_graph *g, const dm_node *nodes, size_t count) {
    for (size_t i = 0; i < count; i++) dm_is_constant(g, nodes[i], out + i);
}

/* the inverse of the full matrix M[n*n]; scratch from the arena. What is singular as it stands is
 * judged again in units that make its entries comparable: M^-1 = D (D M D)^-1 D. There, rounding of
 * the entries alone leaves a singular M an inverse of 1/(some DBL_EPSILON). */
enum { ROUNDINGS = 1024 };
static dm_status invert(const builder *b, double *inverse, const double *M) {
    const uint32_t n = b->m.n;
    const size_t size = (size_t)n * n;
    double *factors = dm_arena_take(b->arena, (size + 2 * (size_t)n) * sizeof *factors);
    uint32_t *pivot = dm_arena_take(b->arena, n * sizeof *pivot);
    if (!factors || !pivot) return DM_NO_MEMORY;
    double *column = factors + size, *unit = column + n;
    memcpy(factors, M, size * sizeof *M);
    dm_status status = dm_lu_inverse(inverse, factors, pivot, column, n);
    if (status != DM_SINGULAR) return status;
    memcpy(factors, M, size * sizeof *M);
    if (!dm_equilibrate(factors, unit, n)) return DM_SINGULAR;
    status = dm_lu_inverse(inverse, factors, pivot, column, n);
    if (status != DM_OK) return status;
    for (size_t k = 0; k < size; k++) {
        if (!(fabs(inverse[k]) * ROUNDINGS * DBL_EPSILON < 1.0)) return DM_SINGULAR;
        inverse[k] *= unit[k / n] * unit[k % n];
        if (!isfinite(inverse[k])) return DM_SINGULAR;
    }
    return DM_OK;
}

/* reciprocals in place of an inverse; a mass of zero is singular */
static dm_status keep_diagonal(builder *b, double *mass, double *inverse) {
    const uint32_t n = b->m.n;
    for (uint32_t i = 0; i < n; i++) {
        const double m = mass[i * ((size_t)n + 1)];
        if (!isfinite(1.0 / m)) return DM_SINGULAR; /* zero, or too small to be told from it */
        mass[i] = m;
        inverse[i] = 1.0 / m;
    }
    b->m.structure |= DM_DIAGONAL_MASS;
    return DM_OK;
}

/* mass matrix, its inverse and the shift of a constant mass */
static dm_status read_mass(builder *b) {
    const uint32_t n = b->m.n;
    double *mass = dm_arena_take(b->arena, (2 * (size_t)n * n + n) * sizeof *mass);
    dm_node *shift_nodes = take_nodes(b, n);
    if (!mass || !shift_nodes) return DM_NO_MEMORY;
    double *inverse = mass + (size_t)n * n, *shift = inverse + (size_t)n * n;
    const int separable = (b->m.structure & DM_SEPARABLE) != 0;
    dm_status status = separable ? find_shift(b, shift_nodes) : DM_OK;
    if (status != DM_OK) return status;
    read_values(mass, b->g, b->mass, (size_t)n * n);
    const int diagonal = separable && is_diagonal(b->mass, n) && all_zero(shift_nodes, n);
    status = diagonal ? keep_diagonal(b, mass, inverse) : invert(b, inverse, mass);
    if (status != DM_OK) return status;
    if (separable) {
        read_values(shift, b->g, shift_nodes, n);
        b->m.momentum_shift = shift;
    }
    b->m.mass_matrix = mass;
    b->m.inverse_mass = inverse;
    return DM_OK;
}

/* v . L_v - L */
static dm_node energy(const builder *b) {
    dm_node sum = dm_neg(b->g, b->L);
    for (uint32_t i = 0; i < b->m.n; i++) {
        const dm_node v = dm_input(b->g, b->m.n + i);
        sum = dm_add(b->g, sum, dm_mul(b->g, v, b->gradient[b->m.n + i]));
    }
    return sum;
}

/* rows [row, row+n), columns [column, column+n) of the 2n x 2n matrix `whole` */
static void copy_block(dm_node *out, const dm_node *whole, uint32_t row, uint32_t column,
                       uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        memcpy(out + (size_t)i * n, whole + (size_t)(row + i) * 2 * n + column, n * sizeof *out);
}

/* L_q, L_v, L_qq, L_qv, L_vv */
static dm_status stage_roots(const builder *b, dm_node *roots) {
    const uint32_t n = b->m.n;
    const size_t nn = (size_t)n * n;
    dm_node *hessian = b->hessian ? b->hessian : take_nodes(b, 4 * nn);
    if (!hessian) return DM_NO_MEMORY;
    if (b->hessian)
        memcpy(roots, b->gradient, 2 * (size_t)n * sizeof *roots);
    else
        dm_hessian(b->g, b->L, 0, 2 * n, roots, hessian);
    copy_block(roots + 2 * n, hessian, 0, 0, n);
    copy_block(roots + 2 * n + nn, hessian, 0, n, n);
    copy_block(roots + 2 * n + 2 * nn, hessian, n, n, n);
    return dm_graph_status(b->g);
}

/* a kernel of roots[count]; `which` says that it is there */
static dm_status make(builder *b, dm_kernel *out, const dm_node *roots, size_t count,
                      unsigned which) {
    dm_status status = dm_graph_status(b->g);
    if (status == DM_OK) status = b->compile(out, b->g, roots, (uint32_t)count, b->arena);
    if (status == DM_OK) b->m.has |= which;
    return status;
}

/* as they stand, from a graph that was compacted before */
static dm_status make_verbatim(builder *b, dm_graph *g, dm_kernel *out, const dm_node *roots,
                               size_t count, unsigned which) {
    dm_graph_verbatim(g, 1);
    const dm_status status = b->compile(out, g, roots, (uint32_t)count, b->arena);
    dm_graph_verbatim(g, 0);
    if (status == DM_OK) b->m.has |= which;
    return status;
}

/* compacting is most of the work: the slope and the mass are taken out of the compacted stage */
static dm_status make_stage_from(builder *b, unsigned want) {
    const size_t n = b->m.n, nn = n * n, count = 2 * n + 3 * nn;
    dm_node *roots = take_nodes(b, 2 * count), *mass = roots + count;
    if (!roots) return DM_NO_MEMORY;
    dm_status status = stage_roots(b, roots);
    if (status != DM_OK) return status;
    dm_graph *small = dm_compact_graph(b->g, roots, (uint32_t)count, roots);
    if (!small) return dm_graph_status(b->g) != DM_OK ? dm_graph_status(b->g) : DM_NO_MEMORY;
    memcpy(mass, roots + n, n * sizeof *mass);
    memcpy(mass + n, roots + 2 * n + 2 * nn, nn * sizeof *mass);
    b->m.source.stage_graph = small;
    b->m.source.stage = roots;
    status = make_verbatim(b, small, &b->m.stage, roots, count, DM_WANT_STAGE);
    if (status == DM_OK && want & DM_WANT_SLOPE)
        status = make_verbatim(b, small, &b->m.slope, roots, 2 * n, DM_WANT_SLOPE);
    if (status == DM_OK && want & DM_WANT_MASS)
        status = make_verbatim(b, small, &b->m.mass, mass, n + nn, DM_WANT_MASS);
    return status;
}

/* Where the kernel may be made late: from a graph of its own, so that it rounds alike whatever
 * the other one holds by then; and the mass, which a start needs, is not taken out of it. */
static dm_status make_stage(builder *b, unsigned want) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    builder apart = *b;
    if ((b->m.structure & simple) != simple) return make_stage_from(b, want);
    apart.g = dm_graph_copy(b->g, &b->L, 1, &apart.L);
    if (!apart.g) return DM_NO_MEMORY;
    const dm_status status = make_stage_from(&apart, want & DM_WANT_SLOPE);
    b->m = apart.m;
    return status;
}

/* L_v, then L_vv */
static dm_status make_mass(builder *b) {
    const size_t n = b->m.n, count = n + n * n;
    dm_node *roots = take_nodes(b, count);
    if (!roots) return DM_NO_MEMORY;
    memcpy(roots, b->gradient + n, n * sizeof *roots);
    memcpy(roots + n, b->mass, n * n * sizeof *roots);
    return make(b, &b->m.mass, roots, count, DM_WANT_MASS);
}

/* -V = L at v = 0, then L_q */
static dm_status make_potential(builder *b) {
    const uint32_t n = b->m.n, inputs = dm_graph_inputs(b->g);
    dm_node *roots = take_nodes(b, n + 1), *with = take_nodes(b, inputs);
    if (!roots || !with) return DM_NO_MEMORY;
    for (uint32_t i = 0; i < inputs; i++)
        with[i] = i >= n && i < 2 * n ? dm_constant(b->g, 0.0) : dm_input(b->g, i);
    dm_substitute(b->g, &b->L, 1, with, roots);
    b->m.source.potential = roots[0];
    memcpy(roots + 1, b->gradient, n * sizeof *roots);
    return make(b, &b->m.potential, roots, n + 1, DM_WANT_POTENTIAL);
}

/* in an order in which later kernels find what earlier ones brought along */
static dm_status make_kernels(builder *b, unsigned want) {
    dm_status status = DM_OK;
    if (want &
        DM_WANT_VALUE) { /* evaluated a few times, to check the trace: not worth native code */
        status = dm_tape_build_exact(&b->m.value, b->g, &b->L, 1, b->arena);
        if (status == DM_OK) b->m.has |= DM_WANT_VALUE;
    }
    if (status == DM_OK && want & DM_WANT_STAGE) status = make_stage(b, want);
    want &= ~b->m.has;
    if (status == DM_OK && want & DM_WANT_SLOPE)
        status = make(b, &b->m.slope, b->gradient, 2 * (size_t)b->m.n, DM_WANT_SLOPE);
    if (status == DM_OK && want & DM_WANT_FORCE)
        status = make(b, &b->m.force, b->gradient, b->m.n, DM_WANT_FORCE);
    if (status == DM_OK && want & DM_WANT_ENERGY) {
        const dm_node root = energy(b);
        status = make(b, &b->m.energy, &root, 1, DM_WANT_ENERGY);
    }
    if (status == DM_OK && want & DM_WANT_POTENTIAL) status = make_potential(b);
    if (status == DM_OK && want & DM_WANT_MASS) status = make_mass(b);
    return status;
}

/* what a model remembers of its making */
struct dm_later {
    builder b;
};

/* the builder stays with the model, in its arena */
static dm_status make_later(builder *b) {
    struct dm_later *later = dm_arena_take(b->arena, sizeof *later);
    if (!later) return DM_NO_MEMORY;
    b->m.has |= DM_WANT_STAGE_LATER;
    later->b = *b;
    b->m.later = later;
    return DM_OK;
}

/* made at most once; later calls find it */
dm_status dm_model_stage(const dm_kernel **out, const dm_model *m) {
    *out = &m->stage;
    if (m->stage.eval) return DM_OK;
    builder *b = &m->later->b;
    *out = &b->m.stage;
    return b->m.stage.eval ? DM_OK : make_stage(b, 0);
}

/* L_q, L_v and L_vv */
static dm_status differentiate(builder *b) {
    const uint32_t n = b->m.n;
    b->gradient = take_nodes(b, 2 * (size_t)n);
    b->mass = take_nodes(b, (size_t)n * n);
    if (!b->gradient || !b->mass) return DM_NO_MEMORY;
    dm_gradient(b->g, b->L, 0, 2 * n, b->gradient);
    dm_jacobian(b->g, b->gradient + n, n, n, n, b->mass);
    return dm_graph_status(b->g);
}

/* derivatives of an extremum by the envelope property; a separable L has none that are shorter */
static dm_status use_extremum(builder *b) {
    const uint32_t n = b->m.n;
    const dm_extremum *e = dm_extremum_find(b->g, b->L);
    if (!e || e->n != 2 * n || b->m.structure & DM_SEPARABLE) return DM_OK;
    b->hessian = take_nodes(b, 4 * (size_t)n * n);
    if (!b->hessian) return DM_NO_MEMORY;
    dm_extremum_derive(b->g, e, b->gradient, b->hessian);
    if (!(b->m.structure & DM_CONSTANT_MASS)) copy_block(b->mass, b->hessian, n, n, n);
    return dm_graph_status(b->g);
}

/* of a mass that moves with q: is it definite and without poles, or else may it have negative
 * values? */
static void keep_bounds(builder *b) {
    const unsigned moves = b->m.structure & (DM_CONSTANT_MASS | DM_LINEAR_IN_V | DM_QUADRATIC_IN_V);
    if (!b->m.mass.eval || moves != DM_QUADRATIC_IN_V) return;
    const dm_mass_bounds *M =
        dm_mass_bounds_new(b->g, b->gradient + b->m.n, b->mass, b->m.n, b->arena);
    if (!M) return;
    const size_t room = 2 * (M->inputs + (size_t)M->size);
    dm_interval *scratch = dm_arena_take(b->arena, room * sizeof *scratch);
    const dm_convexity convex = scratch && dm_mass_is_definite(M, scratch)
                                    ? DM_DEFINITE
                                    : dm_mass_convexity(b->g, b->L, b->m.n, b->arena);
    if (convex == DM_DEFINITE && scratch && !dm_mass_may_have_pole(M, scratch))
        b->m.structure |= DM_DEFINITE_MASS;
    if (convex == DM_NOT_CONVEX) b->m.mass_bounds = M;
}

/* of a mass that moves: which velocities does it couple? */
static dm_status keep_blocks(builder *b) {
    const uint32_t n = b->m.n;
    if (!b->m.mass.eval || b->m.structure & DM_CONSTANT_MASS) return DM_OK;
    uint32_t *room = dm_arena_take(b->arena, (2 * (size_t)n + 1) * sizeof *room);
    if (!room) return DM_NO_MEMORY;
    b->m.mass_blocks = dm_blocks_find(b->mass, n, room);
    return DM_OK;
}

/* the usual model: all sums written out, n x n tables allowed */
static dm_status build_dense(dm_model *m, dm_graph *g, dm_node L, uint32_t n, unsigned want,
                             dm_compile *compile, dm_arena *arena) {
    builder b = {.m = {.n = n}, .g = g, .L = L, .arena = arena, .compile = compile};
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = differentiate(&b);
    if (status == DM_OK) status = read_structure(&b);
    if (status == DM_OK) status = use_extremum(&b);
    if (status != DM_OK) return status;
    dm_status mass = DM_OK;
    if (b.m.structure & DM_CONSTANT_MASS) mass = read_mass(&b);
    if (mass != DM_OK && mass != DM_SINGULAR) return mass;
    b.m.source = (dm_source){.graph = g,
                             .lagrangian = L,
                             .gradient = b.gradient,
                             .compile = compile,
                             .arena = arena};
    /* what a root leaves to the next evaluation has to be known from the start */
    if (want & DM_WANT_STAGE_LATER && dm_has_roots(g, &L, 1)) want |= DM_WANT_STAGE;
    status = make_kernels(&b, want);
    if (status == DM_OK && want & DM_WANT_STAGE_LATER) status = make_later(&b);
    if (status == DM_OK) keep_bounds(&b);
    if (status == DM_OK) status = keep_blocks(&b);
    if (status != DM_OK) return status;
    *m = b.m;
    return mass;
}

/* few rounds of sums, few coordinates */
static int is_short(const dm_graph *g, uint32_t n) {
    double rounds = 0;
    for (const dm_sum *s = dm_sums(g); s; s = s->next) rounds += dm_sum_all_rounds(s);
    return rounds <= DM_MODEL_WRITTEN_OUT && n <= DM_MODEL_DENSE;
}

/* sums as plain additions in a graph of their own, then as above */
static dm_status build_written_out(dm_model *m, dm_graph *g, dm_node L, unsigned want,
                                   dm_compile *compile, dm_arena *arena) {
    const uint32_t n = m->n;
    if (!dm_sums(g)) return build_dense(m, g, L, n, want, compile, arena);
    if (n > DM_MODEL_DENSE) return DM_TOO_LARGE;
    dm_graph *plain = dm_graph_new(arena, dm_sum_first(g));
    if (!plain) return DM_NO_MEMORY;
    const dm_node all = dm_sum_write_out(plain, g, L);
    return build_dense(m, plain, all, n, want, compile, arena);
}

/* sums stay loops where they are long and nobody wants n x n tables */
dm_status dm_model_build(dm_model *m, dm_graph *g, dm_node L, uint32_t n, unsigned want,
                         dm_compile *compile, dm_arena *arena) {
    int fits = 0;
    dm_model now = {.n = n, .source = {.compile = compile, .arena = arena}};
    dm_status status = dm_graph_status(g);
    const int cells = dm_sum_over_cells(g) != NULL, near = dm_sum_over_near(g) != NULL;
    if (near && want & DM_WANT_DENSE) return DM_TOO_LARGE;
    if (status == DM_OK && (cells || near || (!is_short(g, n) && !(want & DM_WANT_DENSE))))
        status = dm_loops_model(&now, g, L, want & ~(cells ? DM_WANT_DENSE : 0u), &fits);
    if (status == DM_OK && !fits && (cells || near)) return DM_TOO_LARGE;
    if (status == DM_OK && !fits) status = build_written_out(&now, g, L, want, compile, arena);
    if (status == DM_OK || status == DM_SINGULAR) *m = now;
    return status;
}

/* a kernel of a pair; roundings that have a mean, and coefficients that differ between kernels,
 * would make momentum maps drift */
static dm_status make_even(builder *b, dm_kernel *out, dm_node *roots, size_t count) {
    dm_graph_exact(b->g, 1);
    dm_graph *g = dm_compact_graph(b->g, roots, (uint32_t)count, roots);
    dm_graph_exact(b->g, 0);
    if (g) g = dm_even_graph(g, roots, (uint32_t)count, roots);
    if (!g) return dm_graph_status(b->g) != DM_OK ? dm_graph_status(b->g) : DM_NO_MEMORY;
    return make_verbatim(b, g, out, roots, count, DM_WANT_PAIR);
}

/* D1, D2, D1D2, and D1 + D2 by itself. With implicit functions each evaluation starts from the
 * last, and there is no sum. */
static dm_status make_pair(builder *b, dm_node *roots, size_t count) {
    const uint32_t n = b->m.n;
    dm_node *sum = roots + count;
    if (dm_has_roots(b->g, roots, (uint32_t)count))
        return make(b, &b->m.pair, roots, count, DM_WANT_PAIR);
    for (uint32_t i = 0; i < n; i++) sum[i] = dm_add(b->g, roots[i], roots[n + i]);
    const dm_status status = make_even(b, &b->m.pair, roots, count);
    return status == DM_OK ? make_even(b, &b->m.pair_sum, sum, n) : status;
}

/* D1 and D2 are the gradient, D1D2 the upper right block of the Hessian */
dm_status dm_model_build_pair(dm_model *m, dm_graph *g, dm_node Ld, uint32_t n, dm_compile *compile,
                              dm_arena *arena) {
    builder b = {.m = {.n = n}, .g = g, .L = Ld, .arena = arena, .compile = compile};
    const size_t nn = (size_t)n * n;
    dm_node *roots = take_nodes(&b, 3 * n + nn), *hessian = take_nodes(&b, 4 * nn);
    if (!roots || !hessian) return DM_NO_MEMORY;
    b.m.operations = dm_operations(g, &Ld, 1);
    dm_status status = make(&b, &b.m.value, &Ld, 1, DM_WANT_VALUE);
    if (status != DM_OK) return status;
    dm_hessian(g, Ld, 0, 2 * n, roots, hessian);
    copy_block(roots + 2 * n, hessian, 0, n, n);
    status = make_pair(&b, roots, 2 * n + nn);
    if (status == DM_OK) *m = b.m;
    return status;
}
