/* kernel.h - a compiled function from doubles to doubles: tape, native code, C of the system's
 * compiler or a callback. eval is straight-line: no allocation, no Lua inside (a callback
 * kernel is the named exception). It writes only the outputs that vary: call dm_kernel_prepare
 * once on every output buffer, which fills in the constant ones; they are then never touched.
 *
 * Between calls a kernel keeps nothing but its memory, and that only with implicit functions
 * (algebra/implicit.h): it can be told to remember, and then begins to look for a root at the
 * last one. Who does so counts the kernel's memory among what a run goes on from, since the
 * bits of the outputs depend on it. A kernel without memory may be shared by threads if its
 * backend says so. */
#ifndef DM_KERNEL_H
#define DM_KERNEL_H

#include "graph/graph.h"

typedef void dm_eval(const void *pool, const double *in, double *out);

/* one function of inputs[inputs] with outputs[outputs]; a copy of it is the same kernel */
typedef struct {
    dm_eval *eval;
    const void *pool; /* what eval needs: constants, tape, callback context */
    uint32_t inputs, outputs;
    uint32_t operations;    /* per evaluation */
    const char *backend;    /* "tape", "jit", "cc", "hyperdual" */
    const uint8_t *fixed;   /* [outputs]: 1 where the output is a constant; NULL: none is */
    const double *constant; /* [outputs]: its value there */
    double *memory;         /* what an evaluation leaves to the next one; NULL: nothing */
    uint32_t memory_size;
} dm_kernel;

/* How roots[m] of a graph become a kernel in `arena`; dm_tape_build is one. */
typedef dm_status dm_compile(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                             dm_arena *arena);

/* out[outputs] = f(in[inputs]), but for constant outputs; in and out do not overlap. */
static inline void dm_kernel_eval(const dm_kernel *k, const double *in, double *out) {
    k->eval(k->pool, in, out);
}

/* The last entry of the memory: is it used? Outputs depend on inputs alone where it is not. */
static inline void dm_kernel_remember(const dm_kernel *k, int on) {
    for (uint32_t i = 0; i < k->memory_size; i++) k->memory[i] = 0.0;
    if (k->memory_size) k->memory[k->memory_size - 1] = on;
}

/* Which outputs of the kernel are constants: matrices of a step are laid out without those that
 * are zero, so every backend must tell. k->outputs is set; the roots are those that eval is made
 * of, after compaction. 0: no memory. */
int dm_kernel_report_fixed(dm_kernel *k, const dm_graph *g, const dm_node *roots, dm_arena *arena);

/* Fill in the constant outputs and empty the memory: before the first evaluation into `out`. */
static inline void dm_kernel_prepare(const dm_kernel *k, double *out) {
    dm_kernel_remember(k, 0);
    for (uint32_t i = 0; k->fixed && i < k->outputs; i++)
        if (k->fixed[i]) out[i] = k->constant[i];
}

#endif
