/* lattice_force.c - the force by loops along arrays as a kernel like others: x = (q, v, t) in,
 * L_q and L_v out, for rules that ask for a force rather than for passes over the bodies.
 * Speed: P8-toda-32: 2.0x by rk8pd. */
#include "chain/lattice.h"

/* the kernel's own arrays and loop; one call at a time, as kernels of a model are used */
typedef struct {
    dm_source source; /* as far as it is known when this is made */
    dm_lattice l;
    dm_array_loop loop;
    uint32_t force, n;  /* first array of the force */
    const double *mass; /* [n], or NULL: no momenta */
} force_loop;

/* positions into arrays, slopes and their sums, forces out of arrays */
static void eval(const void *pool, const double *x, double *out) {
    force_loop *f = (force_loop *)(uintptr_t)pool;
    dm_lattice_load(&f->l, 0, x);
    dm_lattice_run(&f->l, &f->loop, x[2 * (size_t)f->n]);
    dm_lattice_store(&f->l, out, f->force);
    for (uint32_t i = 0; f->mass && i < f->n; i++) out[f->n + i] = f->mass[i] * x[f->n + i];
}

/* the force on a body from the buffer of slopes */
static dm_status make_loop(force_loop *f, const dm_source *from) {
    dm_node F[DM_ARRAY_LOOP_MOST];
    dm_array_loop_draft d;
    if (f->l.block > DM_ARRAY_LOOP_MOST) return DM_TOO_LARGE;
    if (!dm_array_loop_begin(&d, from->arena)) return DM_NO_MEMORY;
    dm_graph_verbatim(d.g, 1);
    dm_lattice_force(&f->l, &d, F);
    for (uint32_t c = 0; c < f->l.block; c++)
        dm_array_loop_write(&d, dm_lattice_entry(&f->l, f->force + c), F[c]);
    return dm_array_loop_end(&f->loop, &d, from->compile, from->arena);
}

/* of all bodies and rounds, saturated */
static uint32_t operations(const force_loop *f) {
    double count = (double)f->loop.one.operations * f->l.bodies;
    for (uint32_t k = 0; k < f->l.sums; k++)
        count += (double)f->l.sum[k].loop.one.operations * f->l.sum[k].rounds;
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

dm_status dm_lattice_gradient(dm_kernel *out, const dm_source *from, uint32_t n,
                              const double *mass) {
    dm_arena *arena = from->arena;
    const size_t size = dm_lattice_work(from, n, 2);
    if (!size) return DM_TOO_LARGE;
    force_loop *f = dm_arena_take(arena, sizeof *f);
    double *work = dm_arena_take(arena, size * sizeof *work);
    if (!f || !work) return DM_NO_MEMORY;
    *f = (force_loop){.source = *from, .n = n, .mass = mass};
    dm_status status = dm_lattice_open(&f->l, &f->source, n);
    if (status != DM_OK) return status;
    f->force = dm_lattice_arrays(&f->l);
    status = make_loop(f, from);
    if (status != DM_OK) return status;
    dm_lattice_place(&f->l, work);
    *out = (dm_kernel){.eval = eval,
                       .pool = f,
                       .inputs = 2 * n + 1,
                       .outputs = mass ? 2 * n : n,
                       .operations = operations(f),
                       .backend = f->loop.one.backend};
    return DM_OK;
}
