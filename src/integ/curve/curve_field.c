#include "integ/curve/curve_field.h"

#include "algebra/derive.h"
#include "integ/curve/curve_defect.h"
#include "integ/method/cache.h"

#include <string.h>

/* equations, and roots of the kernel in hand */
typedef struct {
    dm_defect d;
    dm_node *roots;
} builder;

enum { FORCE, GRADIENT, CURVE, TANGENT, MOMENTUM };
static const char maker;

/* Rows of R: one for every coordinate, one for every constraint. */
uint32_t dm_field_rows(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return m->n + (c ? c->holonomic + c->rolling : 0);
}

/* q, v, t, w, U, l and the controls. */
size_t dm_field_inputs(const dm_model *m) {
    const size_t controls = m->constraints ? m->constraints->controls : 0;
    return 2 * (size_t)m->n + 2 + 2 * (size_t)dm_field_rows(m) + controls;
}

/* Second derivatives, R_y, B, and the part of C that sees mu. */
size_t dm_field_curve(const dm_model *m) {
    const size_t n = m->n, N = dm_field_rows(m),
                 rolling = m->constraints ? m->constraints->rolling : 0;
    return 4 * n * n + 4 * N * n + n * rolling;
}

/* ---- kernels ---- */

/* The roots so far as a kernel, which the model keeps. */
static dm_status make(const builder *b, dm_kernel *out, size_t count, uint32_t which) {
    dm_status status = dm_graph_status(b->d.g);
    if (status == DM_OK)
        status =
            b->d.m->source.compile(out, b->d.g, b->roots, (uint32_t)count, b->d.m->source.arena);
    if (status == DM_OK) dm_cache_add(b->d.m, &maker, which, out, 1);
    return status;
}

/* The acceleration itself where M is constant; else M a and M, to be solved at every point; with
 * constraints R and S. */
static dm_status make_force(const builder *b, dm_field *out) {
    const size_t n = b->d.n, N = b->d.N;
    if (N > n) {
        const dm_status status = dm_defect_rows(&b->d, b->roots, b->roots + N);
        return status == DM_OK ? make(b, &out->force, N + N * N, FORCE) : status;
    }
    dm_defect_push(&b->d, b->roots, b->roots + n);
    if (out->solved) {
        dm_defect_divide(&b->d, b->roots, b->roots + n);
        return make(b, &out->force, n, FORCE);
    }
    dm_jacobian(b->d.g, b->d.gradient + n, b->d.n, b->d.n, b->d.n, b->roots + n);
    return make(b, &out->force, n + n * n, FORCE);
}

/* l C_i */
static dm_node work_of(const builder *b, uint32_t i) {
    const dm_node l = dm_input(b->d.g, b->d.l);
    return dm_mul(b->d.g, l, b->d.push[i]);
}

/* psi_y + l C */
static dm_status make_gradient(const builder *b, dm_kernel *out) {
    const uint32_t n = b->d.n;
    dm_gradient(b->d.g, b->d.psi, 0, 2 * n, b->roots);
    for (uint32_t i = 0; i < n && b->d.push; i++)
        b->roots[i] = dm_add(b->d.g, b->roots[i], work_of(b, i));
    return make(b, out, 2 * (size_t)n, GRADIENT);
}

/* psi_yy += l C_y, and l E^T, by which C sees mu, into bend[n*rolling] */
static void add_work_curve(const builder *b, dm_node *second, dm_node *bend) {
    const uint32_t n = b->d.n, N = 2 * n, l = b->d.rolling;
    dm_node *row = bend + n * (size_t)l; /* [2n] scratch */
    for (uint32_t i = 0; i < n && b->d.push; i++) {
        const dm_node work = work_of(b, i);
        dm_gradient(b->d.g, work, 0, N, row);
        for (uint32_t j = 0; j < N; j++) {
            dm_node *entry = second + i * (size_t)N + j;
            *entry = dm_add(b->d.g, *entry, row[j]);
        }
        if (l) dm_gradient(b->d.g, work, b->d.w + n + b->d.k, l, bend + i * (size_t)l);
    }
}

/* psi_yy, then R_y and B = psi_wy. */
static dm_status make_curve(const builder *b, dm_kernel *out) {
    const uint32_t n = b->d.n, N = 2 * n, M = b->d.N;
    dm_node *rows = b->roots + (size_t)N * N, *mixed = rows + (size_t)M * N;
    dm_node *bend = mixed + (size_t)M * N, *slope = bend + n * (size_t)b->d.rolling;
    dm_hessian(b->d.g, b->d.psi, 0, N, slope, b->roots);
    dm_gradient(b->d.g, b->d.psi, b->d.U, M, slope);
    dm_jacobian(b->d.g, slope, M, 0, N, rows);
    dm_gradient(b->d.g, b->d.psi, b->d.w, M, slope);
    dm_jacobian(b->d.g, slope, M, 0, N, mixed);
    add_work_curve(b, b->roots, bend);
    return make(b, out, dm_field_curve(b->d.m), CURVE);
}

/* R_y alone. */
static dm_status make_tangent(const builder *b, dm_kernel *out) {
    const uint32_t n = b->d.n, N = 2 * n, M = b->d.N;
    dm_node *defect = b->roots + (size_t)M * N; /* [M] scratch */
    dm_gradient(b->d.g, b->d.psi, b->d.U, M, defect);
    dm_jacobian(b->d.g, defect, M, 0, N, b->roots);
    return make(b, out, (size_t)M * N, TANGENT);
}

/* L_vy. */
static dm_status make_momentum(const builder *b, dm_kernel *out) {
    const uint32_t n = b->d.n, N = 2 * n;
    dm_jacobian(b->d.g, b->d.gradient + n, n, 0, N, b->roots);
    return make(b, out, (size_t)n * N, MOMENTUM);
}

/* The roots are overwritten from kernel to kernel; the largest are those of `curve`. */
static dm_status build(dm_field *out, const dm_model *m) {
    const size_t n = out->n, N = out->N;
    builder b;
    dm_status status = dm_defect_build(&b.d, m, 0);
    if (status != DM_OK) return status;
    b.roots = dm_defect_take(&b.d, dm_field_curve(m) + N * N + 4 * n + N);
    if (!b.roots) return DM_NO_MEMORY;
    status = make_force(&b, out);
    if (status == DM_OK) status = make_gradient(&b, &out->gradient);
    if (status == DM_OK) status = make_curve(&b, &out->curve);
    if (status == DM_OK) status = make_tangent(&b, &out->tangent);
    return status == DM_OK ? make_momentum(&b, &out->momentum) : status;
}

/* All five or none are found with the model. */
static int find(dm_field *out, const dm_model *m) {
    return dm_cache_find(&out->force, m, &maker, FORCE) &&
           dm_cache_find(&out->gradient, m, &maker, GRADIENT) &&
           dm_cache_find(&out->curve, m, &maker, CURVE) &&
           dm_cache_find(&out->tangent, m, &maker, TANGENT) &&
           dm_cache_find(&out->momentum, m, &maker, MOMENTUM);
}

/* What a segment without kernels of points needs to know, too. */
void dm_field_shape(dm_field *out, const dm_model *m) {
    out->n = m->n;
    out->N = dm_field_rows(m);
    out->rolling = m->constraints ? m->constraints->rolling : 0;
    out->solved = m->inverse_mass && out->N == m->n;
}

dm_status dm_field_build(dm_field *out, const dm_model *m) {
    dm_field_shape(out, m);
    if (!m->source.graph || !m->source.compile) return DM_TOO_LARGE;
    return find(out, m) ? DM_OK : build(out, m);
}
