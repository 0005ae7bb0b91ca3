#include "bind/trace/cc.h"

#include "algebra/compact.h"
#include "code/implicit/implicit_kernel.h"
#include "code/tape/emit_c.h"
#include "code/tape/tape.h"
#include "numbers/fma.h"
#include "numbers/functions.h"

#include <dlfcn.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* without it fma() is a call */
#if defined(__x86_64__)
#define FUSED "-mfma"
#else
#define FUSED "-w"
#endif

enum { LONGEST = 512 };

typedef struct {
    char folder[LONGEST], source[LONGEST + 8], object[LONGEST + 8];
} workshop;

/* A folder of its own with a name of mkdtemp; 0: there is none. */
static int open_workshop(workshop *w) {
    const char *tmp = getenv("TMPDIR");
    const int n =
        snprintf(w->folder, sizeof w->folder, "%s/dmlua-XXXXXX", tmp && *tmp ? tmp : "/tmp");
    if (n < 0 || n >= (int)sizeof w->folder || !mkdtemp(w->folder)) return 0; /* mode 0700 */
    snprintf(w->source, sizeof w->source, "%s/k.c", w->folder);
    snprintf(w->object, sizeof w->object, "%s/k.so", w->folder);
    return 1;
}

/* The files are not needed once the object is loaded. */
static void close_workshop(const workshop *w) {
    unlink(w->source);
    unlink(w->object);
    rmdir(w->folder);
}

/* A piece of text to the source. */
static void put(void *ud, const char *text, size_t length) {
    fwrite(text, 1, length, ud);
}

/* the elementary functions are those of the tape, called through a table that is filled in when
 * it is loaded */
static void write_head(FILE *f) {
    fprintf(f, "#include <math.h>\n\ndouble (*functions[%d])(double);\n", (int)DM_OP_COUNT);
    for (int op = DM_OP_RSQRT; op <= DM_OP_TANH; op++) {
        const char *name = op == DM_OP_RSQRT    ? "reciprocal_root"
                           : op == DM_OP_RSQRT3 ? "reciprocal_root3"
                                                : dm_op_text((dm_op)op);
        fprintf(f, "#define %s(x) functions[%d](x)\n", name, op);
    }
}

/* One function of the graph, and the helpers that it calls. */
static int write_source(const workshop *w, dm_graph *g, const dm_node *roots, uint32_t m) {
    FILE *f = fopen(w->source, "w");
    if (!f) return 0;
    write_head(f);
    const int whole = dm_emit_c(g, roots, m, "kernel", NULL, put, f);
    return fclose(f) == 0 && whole;
}

/* The compiler of CC, with the flags that give the bits of the tape; 0: it failed. gcc 12 makes
 * alternating sums of products into vfmaddsub in spite of -ffp-contract=off, so it shall not
 * look for them. */
static int run_compiler(workshop *w) {
    char *cc = getenv("CC");
    char *argv[] = {cc && *cc ? cc : "cc",
                    "-std=c17",
                    "-O2",
                    "-ffp-contract=off",
                    "-fno-tree-slp-vectorize",
                    "-fno-math-errno",
                    dm_fma_is_fused() ? FUSED : "-w",
                    "-w",
                    "-shared",
                    "-fPIC",
                    "-o",
                    w->object,
                    w->source,
                    "-lm",
                    NULL};
    pid_t child;
    int status;
    if (posix_spawnp(&child, argv[0], NULL, NULL, argv, environ) != 0) return 0;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* the function of the shared object behind a kernel */
typedef struct {
    void (*kernel)(const double *in, double *out);
} object;

/* By the collector, with the arena of the kernel. */
static void unload(void *handle, size_t size) {
    (void)size;
    dlclose(handle);
}

/* The function of the shared object. */
static void eval(const void *pool, const double *in, double *out) {
    const object *o = pool;
    o->kernel(in, out);
}

/* Elementary functions are those of the program, not of libm. */
static void give_functions(void *handle) {
    unsigned char *table = dlsym(handle, "functions");
    for (int op = DM_OP_RSQRT; table && op <= DM_OP_TANH; op++) {
        dm_function *const f = op == DM_OP_RSQRT    ? (dm_function *)dm_rsqrt
                               : op == DM_OP_RSQRT3 ? (dm_function *)dm_rsqrt3
                                                    : dm_function_for(dm_op_function((dm_op)op), 1);
        memcpy(table + (size_t)op * sizeof f, &f, sizeof f);
    }
}

/* NULL where the object cannot be opened. */
static object *load(const workshop *w, dm_arena *arena) {
    object *o = dm_arena_take(arena, sizeof *o);
    void *handle = o ? dlopen(w->object, RTLD_NOW | RTLD_LOCAL) : NULL;
    void *symbol = handle ? dlsym(handle, "kernel") : NULL;
    if (!handle) return NULL;
    if (!symbol || !dm_arena_on_release(arena, unload, handle, 0)) {
        dlclose(handle);
        return NULL;
    }
    give_functions(handle);
    memcpy(&o->kernel, &symbol, sizeof symbol); /* POSIX lets a function pointer be data */
    return o;
}

dm_status dml_cc_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                       dm_arena *arena) {
    workshop w;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    const uint32_t operations = dm_operations(g, roots, m);
    if (dm_has_roots(g, roots, m)) return dm_root_kernel(out, g, roots, m, dml_cc_or_tape, arena);
    if (!open_workshop(&w)) return DM_NO_NATIVE;
    object *o = write_source(&w, g, roots, m) && run_compiler(&w) ? load(&w, arena) : NULL;
    close_workshop(&w);
    if (!o) return DM_NO_NATIVE;
    *out = (dm_kernel){.eval = eval,
                       .pool = o,
                       .inputs = dm_graph_inputs(g),
                       .outputs = m,
                       .operations = operations,
                       .backend = "cc"};
    dm_node *compact = dm_arena_take(dm_graph_arena(g), m * sizeof *compact);
    dm_graph *small = compact ? dm_compact_graph(g, roots, m, compact) : NULL;
    return small && dm_kernel_report_fixed(out, small, compact, arena) ? DM_OK : DM_NO_MEMORY;
}

dm_status dml_cc_or_tape(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                         dm_arena *arena) {
    const dm_status status = dml_cc_build(out, g, roots, m, arena);
    return status == DM_NO_NATIVE ? dm_tape_build(out, g, roots, m, arena) : status;
}
