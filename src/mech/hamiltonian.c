/* hamiltonian.c - a Hamiltonian H(q, p, t) as a model: q' = H_p, p' = -H_q. It may have any form,
 * H_pp may be singular; where an L with a formula belongs to it, that is stepped instead. */
#include "algebra/derive.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"
#include "mech/model.h"

/* what is worked on while a model is built; field and curve are nodes of g */
typedef struct {
    dm_model m;
    dm_graph *g;
    dm_node H;
    dm_node *field; /* [2n] H_p, -H_q; behind it the curve [2n*2n] where it is wanted */
    dm_compile *compile;
    dm_arena *arena;
} builder;

/* H_p and -H_q */
static dm_status differentiate(builder *b) {
    const size_t n = b->m.n;
    b->field = dm_arena_take(b->arena, (4 * n + 4 * n * n) * sizeof *b->field);
    if (!b->field) return DM_NO_MEMORY;
    dm_node *gradient = b->field + 2 * n + 4 * n * n;
    dm_gradient(b->g, b->H, 0, 2 * b->m.n, gradient);
    for (size_t i = 0; i < n; i++) {
        b->field[i] = gradient[n + i];
        b->field[n + i] = dm_neg(b->g, gradient[i]);
    }
    return dm_graph_status(b->g);
}

/* bits, cyclic coordinates, operations */
static dm_status read_structure(builder *b) {
    const uint32_t n = b->m.n;
    uint8_t *cyclic = dm_arena_take(b->arena, n);
    if (!cyclic) return DM_NO_MEMORY;
    b->m.structure = DM_HAMILTONIAN;
    if (!dm_depends(b->g, &b->H, 1, 2 * n, 1)) b->m.structure |= DM_AUTONOMOUS;
    if (!dm_depends(b->g, b->field, n, 0, n) && !dm_depends(b->g, b->field, n, 2 * n, 1))
        b->m.structure |= DM_SEPARABLE;
    dm_independent(cyclic, b->g, &b->H, 1, 0, n);
    b->m.cyclic = cyclic;
    b->m.operations = dm_operations(b->g, &b->H, 1);
    return dm_graph_status(b->g);
}

/* a kernel of nodes[count]; `which` says that it is there */
static dm_status make(builder *b, dm_kernel *out, const dm_node *nodes, size_t count,
                      unsigned which) {
    const dm_status status = b->compile(out, b->g, nodes, (uint32_t)count, b->arena);
    if (status == DM_OK) b->m.has |= which;
    return status;
}

/* The derivatives of the field lie behind it. */
static dm_status make_curve(builder *b) {
    const uint32_t n = b->m.n;
    dm_jacobian(b->g, b->field, 2 * n, 0, 2 * n, b->field + 2 * n);
    const dm_status status = dm_graph_status(b->g);
    if (status != DM_OK) return status;
    return make(b, &b->m.field_curve, b->field, 2 * n + 4 * (size_t)n * n, DM_WANT_FIELD_CURVE);
}

/* The value is evaluated a few times, to check the trace: on the tape. */
static dm_status make_kernels(builder *b, unsigned want) {
    dm_status status = DM_OK;
    if (want & DM_WANT_VALUE) {
        status = dm_tape_build_exact(&b->m.value, b->g, &b->H, 1, b->arena);
        if (status == DM_OK) b->m.has |= DM_WANT_VALUE;
    }
    if (status == DM_OK && want & DM_WANT_ENERGY)
        status = make(b, &b->m.energy, &b->H, 1, DM_WANT_ENERGY);
    if (status == DM_OK && want & DM_WANT_FIELD)
        status = make(b, &b->m.field, b->field, 2 * (size_t)b->m.n, DM_WANT_FIELD);
    if (status == DM_OK && want & DM_WANT_FIELD_CURVE) status = make_curve(b);
    return status;
}

dm_status dm_hamiltonian_build(dm_model *m, dm_graph *g, dm_node H, uint32_t n, unsigned want,
                               dm_compile *compile, dm_arena *arena) {
    builder b = {.m = {.n = n}, .g = g, .H = H, .compile = compile, .arena = arena};
    dm_status status = dm_graph_status(g);
    if (status == DM_OK) status = differentiate(&b);
    if (status == DM_OK) status = read_structure(&b);
    if (status == DM_OK) status = make_kernels(&b, want);
    if (status != DM_OK) return status;
    b.m.source = (dm_source){.graph = g,
                             .lagrangian = H,
                             .field = b.field,
                             .compile = compile,
                             .arena = arena};
    *m = b.m;
    return DM_OK;
}
