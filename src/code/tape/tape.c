/* tape.c - the tape: the needed nodes in order of number, each an instruction on a file of
 * doubles laid out as constants, inputs, slots. A slot is given back after its last use. A
 * product used once rides on the sum or product that uses it (rounded twice all the same), sine
 * and cosine of one angle come from one call. Dispatch is by computed goto (GNU C).
 *
 * The tape runs on every machine and defines the bits: native code, loops and kernels of the
 * system's compiler are compared with it. So it does exactly what dm_op_value does, operation
 * by operation; what is made of two operations here saves a dispatch, not a rounding. */
#include "code/tape/tape.h"

#include "algebra/compact.h"
#include "code/implicit/implicit_kernel.h"
#include "graph/nodes.h"
#include "numbers/fma.h"
#include "numbers/functions.h"

#include <math.h>
#include <string.h>

enum { /* instructions: the operations, and what is made of several */
#define X(name, operands, text, c) DO_##name,
#include "graph/ops.def"
#undef X
       DO_MUL_ADD, /* a*b + c */
       DO_MUL_SUB, /* a*b - c */
       DO_SUB_MUL, /* c - a*b */
       DO_MUL_MUL, /* (a*b)*c */
       DO_ADD_ADD, /* (a+b)+c */
       DO_SINCOS,  /* d = sin a, b = cos a */
       DO_END,
       DO_COUNT
};

/* one instruction: d = op(a, b, c), all of them places in the file */
typedef struct {
    const void *go; /* address of the code that does it */
    uint32_t d, a, b, c;
} instruction;

typedef struct {
    double *file;
    const instruction *code;
    const uint32_t *from; /* [moves] place in the file ... */
    const uint32_t *to;   /* ... and number of the output */
    double *in;           /* inputs in the file */
    uint32_t inputs, moves;
} tape;

/* Run t; without one, give the addresses of the instructions. */
__attribute__((noinline)) static const void *const *engine(const tape *t, double *out) {
    static const void *const address[DO_COUNT] = {
#define X(name, operands, text, c) [DO_##name] = &&name,
#include "graph/ops.def"
#undef X
        [DO_MUL_ADD] = &&MUL_ADD, [DO_MUL_SUB] = &&MUL_SUB, [DO_SUB_MUL] = &&SUB_MUL,
        [DO_MUL_MUL] = &&MUL_MUL, [DO_ADD_ADD] = &&ADD_ADD, [DO_SINCOS] = &&SINCOS,
        [DO_END] = &&END,
    };
    if (!t) return address;
    double *const r = t->file;
    const instruction *i = t->code;
    goto * i->go;

#define A r[i->a]
#define B r[i->b]
#define C r[i->c]
#define DO(name, value)                                                                            \
    name:                                                                                          \
    r[i->d] = (value);                                                                             \
    i++;                                                                                           \
    goto * i->go;
    DO(NEG, -A)
    DO(ABS, fabs(A))
    DO(SIGN, (double)((A > 0) - (A < 0)))
    DO(SQRT, sqrt(A))
    DO(RSQRT, dm_rsqrt(A))
    DO(RSQRT3, dm_rsqrt3(A))
    DO(EXP, dm_exp(A))
    DO(LOG, dm_log(A))
    DO(SIN, dm_sin(A))
    DO(COS, dm_cos(A))
    DO(TAN, dm_tan(A))
    DO(ASIN, asin(A))
    DO(ACOS, acos(A))
    DO(ATAN, atan(A))
    DO(SINH, dm_sinh(A))
    DO(COSH, dm_cosh(A))
    DO(TANH, dm_tanh(A))
    DO(ADD, A + B)
    DO(SUB, A - B)
    DO(MUL, A * B)
    DO(DIV, A / B)
    DO(POW, pow(A, B))
    DO(ATAN2, atan2(A, B))
    DO(MIN, B < A ? B : A)
    DO(MAX, A < B ? B : A)
    DO(WHERE, A > 0 ? B : C)
    DO(FMA, dm_fma(A, B, C))
    DO(FMS, dm_fma(A, B, -C))
    DO(FNMA, dm_fma(-A, B, C))
    DO(MUL_ADD, A * B + C)
    DO(MUL_SUB, A * B - C)
    DO(SUB_MUL, C - A * B)
    DO(MUL_MUL, (A * B) * C)
    DO(ADD_ADD, (A + B) + C)
SINCOS:
    r[i->d] = dm_sincos(A, &B);
    i++;
    goto * i->go;
CONSTANT:
INPUT:
IMPLICIT:
WITH:
ROOT:
END:
#undef DO
#undef A
#undef B
#undef C
    for (uint32_t k = 0; k < t->moves; k++) out[t->to[k]] = r[t->from[k]];
    return NULL;
}

/* inputs into the file, instructions, outputs out of it */
static void evaluate(const void *pool, const double *in, double *out) {
    const tape *t = pool;
    for (uint32_t k = 0; k < t->inputs; k++) t->in[k] = in[k];
    engine(t, out);
}

/* a node on its way to being an instruction */
typedef struct {
    uint32_t arg[3]; /* nodes */
    uint32_t uses;   /* as operand or root, counting each time */
    uint32_t last;   /* number of the last node that uses it */
    uint32_t place;  /* in the file */
    uint8_t kind;    /* DO_... */
    uint8_t operands;
    uint8_t absorbed; /* done as a part of another */
    uint8_t kept;     /* a root: its slot is not given back */
} draft;

typedef struct {
    dm_graph *g;
    draft *d;
    uint32_t end;   /* nodes are below */
    uint32_t *free; /* [end] stack of slots to use again */
    uint32_t frees;
    uint32_t places; /* in the file so far */
} builder;

/* what is needed, and how often */
static void draft_nodes(builder *w, const dm_node *roots, uint32_t m) {
    for (dm_node n = 0; n < w->end; n++) {
        const dm_expr *e = dm_at(w->g, n);
        draft *d = w->d + n;
        *d = (draft){.kind = (uint8_t)e->op, .absorbed = !dm_is_marked(w->g, n)};
        if (d->absorbed) continue;
        d->operands = (uint8_t)dm_arity(e->op);
        for (int k = 0; k < d->operands; k++) {
            d->arg[k] = e->as.arg[k];
            w->d[d->arg[k]].uses++;
        }
    }
    for (uint32_t i = 0; i < m; i++) {
        w->d[roots[i]].uses++;
        w->d[roots[i]].kept = 1;
    }
}

/* operand k of n becomes a part of n: (x, y) of it come first, the other operand third */
static void absorb(builder *w, draft *n, int k, uint8_t kind) {
    draft *part = w->d + n->arg[k];
    const uint32_t other = n->arg[1 - k];
    part->absorbed = 1;
    n->arg[0] = part->arg[0];
    n->arg[1] = part->arg[1];
    n->arg[2] = other;
    n->operands = 3;
    n->kind = kind;
}

/* pairs of operations that have one instruction: outer, inner, which operand, instruction
 */
static const uint8_t pairs[][4] = {
    {DO_ADD, DO_MUL, 1, DO_MUL_ADD}, {DO_ADD, DO_MUL, 0, DO_MUL_ADD},
    {DO_SUB, DO_MUL, 0, DO_MUL_SUB}, {DO_SUB, DO_MUL, 1, DO_SUB_MUL},
    {DO_MUL, DO_MUL, 0, DO_MUL_MUL}, {DO_MUL, DO_MUL, 1, DO_MUL_MUL},
    {DO_ADD, DO_ADD, 0, DO_ADD_ADD}, {DO_ADD, DO_ADD, 1, DO_ADD_ADD},
};

/* a part that has one user is done by it; the first pair in the table that fits is taken */
static void fuse_pairs(builder *w) {
    for (dm_node n = 0; n < w->end; n++) {
        draft *d = w->d + n;
        if (d->absorbed || d->operands != 2) continue;
        for (size_t p = 0; p < sizeof pairs / sizeof pairs[0]; p++) {
            const draft *part = w->d + d->arg[pairs[p][2]];
            if (d->kind != pairs[p][0] || part->kind != pairs[p][1] || part->uses != 1) continue;
            absorb(w, d, pairs[p][2], pairs[p][3]);
            break;
        }
    }
}

/* sin a and cos a: the first of the two does both. `seen`[end] is 0. */
static void fuse_sincos(builder *w, uint32_t *seen) {
    for (dm_node n = 0; n < w->end; n++) {
        draft *d = w->d + n;
        if (d->absorbed || (d->kind != DO_SIN && d->kind != DO_COS)) continue;
        draft *first = w->d + seen[d->arg[0]];
        if (!seen[d->arg[0]]) {
            seen[d->arg[0]] = n;
            continue;
        }
        first->arg[1] = first->kind == DO_SIN ? n : seen[d->arg[0]]; /* the cosine */
        first->arg[2] = first->kind == DO_SIN ? seen[d->arg[0]] : n; /* the sine */
        first->kind = DO_SINCOS;
        d->absorbed = 1;
    }
}

/* after fusing: an absorbed node's operands are those of the node that does it */
static void find_last_uses(builder *w) {
    for (dm_node n = 0; n < w->end; n++) {
        const draft *d = w->d + n;
        for (int k = 0; !d->absorbed && k < d->operands; k++) w->d[d->arg[k]].last = n;
    }
}

/* a slot that was given back last is warm in the cache */
static uint32_t take_place(builder *w) {
    return w->frees ? w->free[--w->frees] : w->places++;
}

/* after instruction n: operands used for the last time give their slots back */
static void release_operands(builder *w, dm_node n) {
    const draft *d = w->d + n;
    for (int k = 0; k < d->operands; k++) {
        draft *a = w->d + d->arg[k];
        if (a->last != n || a->kept || a->kind == DO_CONSTANT || a->kind == DO_INPUT) continue;
        a->last = UINT32_MAX; /* x*x gives back once */
        w->free[w->frees++] = a->place;
    }
}

/* operands give their slots back before the result takes one: it may be the same */
static instruction translate(builder *w, dm_node n, const void *const *address) {
    const draft *d = w->d + n;
    instruction i = {.go = address[d->kind]};
    if (d->kind == DO_SINCOS) { /* both results get their places before the angle goes */
        i.a = w->d[d->arg[0]].place;
        i.d = w->d[d->arg[2]].place = take_place(w);
        i.b = w->d[d->arg[1]].place = take_place(w);
        release_operands(w, n);
        return i;
    }
    i.a = w->d[d->arg[0]].place;
    i.b = w->d[d->arg[1]].place;
    i.c = w->d[d->arg[2]].place;
    release_operands(w, n);
    i.d = w->d[n].place = take_place(w);
    return i;
}

/* constants of the needed operations, then the inputs, have the first places */
static void place_leaves(builder *w, uint32_t inputs) {
    uint32_t constants = 0;
    for (dm_node n = 0; n < w->end; n++)
        if (!w->d[n].absorbed && w->d[n].kind == DO_CONSTANT) w->d[n].place = constants++;
    for (dm_node n = 0; n < w->end; n++)
        if (!w->d[n].absorbed && w->d[n].kind == DO_INPUT)
            w->d[n].place = constants + dm_at(w->g, n)->as.input;
    w->places = constants + inputs;
}

/* drafts of all nodes, pairs found, leaves placed; 0 without memory */
static int open_builder(builder *w, dm_graph *g, const dm_node *roots, uint32_t m) {
    *w = (builder){.g = g, .end = dm_mark(g, roots, m)};
    dm_arena *scratch = dm_arena_scratch(dm_graph_arena(g));
    if (!scratch) return 0;
    w->d = dm_arena_take(scratch, (w->end + 1) * sizeof *w->d);
    w->free = dm_arena_take(scratch, (w->end + 1) * sizeof *w->free);
    if (!w->d || !w->free) return 0;
    memset(w->free, 0, (w->end + 1) * sizeof *w->free);
    draft_nodes(w, roots, m);
    fuse_sincos(w, w->free);
    fuse_pairs(w);
    find_last_uses(w);
    place_leaves(w, dm_graph_inputs(g));
    return 1;
}

/* leaves have none */
static uint32_t count_instructions(const builder *w) {
    uint32_t count = 0;
    for (dm_node n = 0; n < w->end; n++) count += !w->d[n].absorbed && w->d[n].operands;
    return count;
}

/* the code; returns 0 without memory */
static int write_code(tape *t, builder *w, dm_arena *arena) {
    const void *const *address = engine(NULL, NULL);
    instruction *code = dm_arena_take(arena, (count_instructions(w) + 1) * sizeof(instruction));
    if (!code) return 0;
    t->code = code;
    for (dm_node n = 0; n < w->end; n++)
        if (!w->d[n].absorbed && w->d[n].operands) *code++ = translate(w, n, address);
    *code = (instruction){.go = address[DO_END]};
    return 1;
}

/* the file with its constants */
static int make_file(tape *t, const builder *w, dm_arena *arena) {
    t->file = dm_arena_take(arena, (w->places + 1) * sizeof(double));
    if (!t->file) return 0;
    memset(t->file, 0, (w->places + 1) * sizeof(double));
    t->inputs = dm_graph_inputs(w->g);
    t->in = t->file;
    for (dm_node n = 0; n < w->end; n++)
        if (!w->d[n].absorbed && w->d[n].kind == DO_CONSTANT) {
            t->file[w->d[n].place] = dm_at(w->g, n)->as.value;
            t->in = t->file + w->d[n].place + 1;
        }
    return 1;
}

/* outputs that vary are moved out at the end, the others are reported as fixed */
static int make_moves(dm_kernel *out, tape *t, const builder *w, const dm_node *roots,
                      dm_arena *arena) {
    const size_t m = out->outputs;
    uint32_t *from = dm_arena_take(arena, m * sizeof *from);
    uint32_t *to = dm_arena_take(arena, m * sizeof *to);
    if (!from || !to || !dm_kernel_report_fixed(out, w->g, roots, arena)) return 0;
    t->from = from;
    t->to = to;
    t->moves = 0;
    for (uint32_t i = 0; i < m; i++) {
        if (out->fixed[i]) continue;
        from[t->moves] = w->d[roots[i]].place;
        to[t->moves++] = i;
    }
    return 1;
}

/* The tape in the caller's arena; what is only needed to make it, in scratch memory. */
dm_status dm_tape_build_exact(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                              dm_arena *arena) {
    builder w;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (dm_has_roots(g, roots, m))
        return dm_root_kernel(out, g, roots, m, dm_tape_build_exact, arena);
    tape *t = dm_arena_take(arena, sizeof *t);
    dm_kernel k = {.eval = evaluate,
                   .pool = t,
                   .inputs = dm_graph_inputs(g),
                   .outputs = m,
                   .backend = "tape"};
    if (!t || !open_builder(&w, g, roots, m)) return DM_NO_MEMORY;
    k.operations = 0;
    for (dm_node n = 0; n < w.end; n++)
        k.operations += dm_is_marked(g, n) && dm_arity(dm_at(g, n)->op);
    if (!write_code(t, &w, arena) || !make_file(t, &w, arena) ||
        !make_moves(&k, t, &w, roots, arena))
        return DM_NO_MEMORY;
    *out = k;
    return DM_OK;
}

dm_status dm_tape_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                        dm_arena *arena) {
    dm_node *compact = dm_arena_take(dm_graph_arena(g), m * sizeof *compact);
    if (!compact) return DM_NO_MEMORY;
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (dm_has_roots(g, roots, m)) return dm_root_kernel(out, g, roots, m, dm_tape_build, arena);
    dm_graph *small = dm_compact_graph(g, roots, m, compact);
    return small ? dm_tape_build_exact(out, small, compact, m, arena) : DM_NO_MEMORY;
}
