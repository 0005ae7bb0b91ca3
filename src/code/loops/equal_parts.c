/* equal_parts.c - outputs are sorted by bodies; a body whose functions are those of an earlier one,
 * with other inputs in their places, is one more copy of it. */
#include "code/loops/equal_parts.h"

#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "code/native/jit.h"
#include "graph/analyse.h"
#include "graph/nodes.h"

#include <string.h>

/* doubles of inputs and of outputs that are in hand at once; kinds of bodies */
enum { ROOM = 4096, KINDS = 24, LANES = 8 };

/* ---- the kernel ---- */

/* Copies of one part: inputs and outputs of copy c are those of the whole kernel with the numbers
 * in[c * inputs + k], out[c * vary + k]; output k is number varying[k] of `part`. */
typedef struct {
    dm_kernel part;
    uint32_t lanes, copies, inputs, vary;
    uint32_t *in, *out, *varying;
} kind;

typedef struct {
    kind of[KINDS];
    uint32_t count;
} kinds;

/* A load of all lanes waits for the stores of their parts: many groups are gathered before the
 * first is evaluated. Idle lanes repeat the last copy. */
__attribute__((always_inline)) static inline void gather(double *to, const kind *k,
                                                         const double *in, uint32_t first,
                                                         uint32_t groups, const uint32_t lanes) {
    for (uint32_t c = first; c < first + groups * lanes; c += lanes, to += k->inputs * lanes)
        for (uint32_t lane = 0; lane < lanes; lane++) {
            const uint32_t copy = c + lane < k->copies ? c + lane : k->copies - 1;
            const uint32_t *from = k->in + (size_t)copy * k->inputs;
            for (uint32_t i = 0; i < k->inputs; i++) to[i * lanes + lane] = in[from[i]];
        }
}

__attribute__((always_inline)) static inline void scatter(const kind *k, double *out,
                                                          const double *from, uint32_t first,
                                                          const uint32_t lanes) {
    for (uint32_t lane = 0; lane < lanes && first + lane < k->copies; lane++) {
        const uint32_t *to = k->out + (size_t)(first + lane) * k->vary;
        for (uint32_t i = 0; i < k->vary; i++) out[to[i]] = from[k->varying[i] * lanes + lane];
    }
}

/* `lanes` is a constant where this is called */
__attribute__((always_inline)) static inline void run(const kind *k, const double *in, double *out,
                                                      const uint32_t lanes) {
    _Alignas(64) double x[ROOM], y[ROOM];
    const uint32_t all = (k->copies + lanes - 1) / lanes, size = k->inputs * lanes;
    const uint32_t most = size ? ROOM / size : all;
    for (uint32_t done = 0, groups; done < all; done += groups) {
        groups = all - done < most ? all - done : most;
        gather(x, k, in, done * lanes, groups, lanes);
        for (uint32_t i = 0; i < groups; i++) {
            dm_kernel_eval(&k->part, x + i * size, y);
            scatter(k, out, y, (done + i) * lanes, lanes);
        }
    }
}

/* For dm_kernel. */
static void eval(const void *pool, const double *in, double *out) {
    const kinds *all = pool;
    for (uint32_t i = 0; i < all->count; i++) {
        const kind *k = all->of + i;
        if (k->lanes == 8)
            run(k, in, out, 8);
        else if (k->lanes == 4)
            run(k, in, out, 4);
        else
            run(k, in, out, 1);
    }
}

/* ---- which bodies are equal ---- */

/* The roots sorted by bodies: those of body b from first[b] on, each with its number among all.
 * Constants are in the arena, the rest is not needed any more when kernels are made. */
typedef struct {
    dm_graph *g;
    const dm_node *all; /* [m] the roots as they were given */
    uint32_t m, bodies;
    dm_arena *arena;
    uint32_t *first;  /* [bodies + 1] */
    uint32_t *number; /* [m] */
    dm_node *root;    /* [m] */
    uint32_t *like;   /* [bodies] the first body that each is a copy of */
    dm_node *pair; /* [nodes] the node of another body that stands for this one, and 1; 0: none */
    dm_node *seen; /* [pairs] those that have one */
    uint32_t pairs;
    dm_node *stack;   /* [6 nodes + 2] */
    uint32_t *body;   /* [nodes] the first body that a node depends on */
    uint8_t *fixed;   /* [m] as of dm_kernel */
    double *constant; /* [m] */
} sorting;

static uint32_t size_of(const sorting *s, uint32_t b) {
    return s->first[b + 1] - s->first[b];
}

/* of the nodes below `end` that are marked */
static void find_bodies(sorting *s, uint32_t end, const uint32_t *body) {
    for (dm_node n = 0; n < end; n++) {
        const dm_expr *e = dm_at(s->g, n);
        s->body[n] = DM_NO_BODY;
        if (!dm_is_marked(s->g, n)) continue;
        if (e->op == DM_OP_INPUT) s->body[n] = body[e->as.input];
        for (int k = 0; k < dm_arity(e->op); k++)
            if (s->body[e->as.arg[k]] < s->body[n]) s->body[n] = s->body[e->as.arg[k]];
    }
}

/* Outputs of no body are those of the body before; constants are nobody's. */
static void sort(sorting *s, const uint32_t *body) {
    find_bodies(s, dm_mark(s->g, s->all, s->m), body);
    memset(s->first, 0, (s->bodies + 1) * sizeof *s->first);
    uint32_t last = 0;
    for (uint32_t i = 0; i < s->m; i++) {
        uint32_t *own = s->body + s->all[i];
        s->constant[i] = 0.0;
        s->fixed[i] = (uint8_t)dm_is_constant(s->g, s->all[i], s->constant + i);
        if (s->fixed[i]) continue;
        if (*own == DM_NO_BODY) *own = last;
        last = *own;
        s->first[last + 1]++;
    }
    for (uint32_t b = 0; b < s->bodies; b++) s->first[b + 1] += s->first[b];
    for (uint32_t i = 0; i < s->m; i++)
        if (!s->fixed[i]) s->number[s->first[s->body[s->all[i]]]++] = i;
    memmove(s->first + 1, s->first, s->bodies * sizeof *s->first); /* each has gone to the next */
    s->first[0] = 0;
    for (uint32_t i = 0; i < s->first[s->bodies]; i++) s->root[i] = s->all[s->number[i]];
}

/* a of one body and b of another one: the same operation, and operands that stand for each other as
 * far as is known; those that are not known yet are put on the stack, two by two */
static int stands(sorting *s, dm_node a, dm_node b, uint32_t *depth) {
    const dm_expr *x = dm_at(s->g, a), *y = dm_at(s->g, b);
    if (s->pair[a]) return s->pair[a] == b + 1;
    if (x->op != y->op) return 0;
    s->pair[a] = b + 1;
    s->seen[s->pairs++] = a;
    if (x->op == DM_OP_INPUT) return 1;
    if (!dm_arity(x->op)) return dm_same_expr(x, y);
    for (int k = 0; k < dm_arity(x->op); k++) {
        s->stack[(*depth)++] = x->as.arg[k];
        s->stack[(*depth)++] = y->as.arg[k];
    }
    return 1;
}

/* Is body b like body a? Then s->pair says what stands for what in a. */
static int is_copy(sorting *s, uint32_t a, uint32_t b) {
    if (size_of(s, b) != size_of(s, a)) return 0;
    for (uint32_t i = 0; i < s->pairs; i++) s->pair[s->seen[i]] = 0;
    s->pairs = 0;
    for (uint32_t i = 0; i < size_of(s, a); i++) {
        uint32_t depth = 2;
        s->stack[0] = s->root[s->first[a] + i];
        s->stack[1] = s->root[s->first[b] + i];
        while (depth) {
            depth -= 2;
            if (!stands(s, s->stack[depth], s->stack[depth + 1], &depth)) return 0;
        }
    }
    return 1;
}

/* how many kinds of bodies there are; more than KINDS: too many */
static uint32_t find_kinds(sorting *s) {
    uint32_t leader[KINDS], count = 0;
    for (uint32_t b = 0; b < s->bodies; b++) {
        uint32_t k = 0;
        s->like[b] = b;
        if (!size_of(s, b)) continue;
        while (k < count && !is_copy(s, leader[k], b)) k++;
        if (k == KINDS) return KINDS + 1;
        if (k == count) leader[count++] = b;
        s->like[b] = leader[k];
    }
    return count;
}

/* ---- making ---- */

/* the inputs of body a, in the place of those of the first copy; returns how many there are */
static uint32_t list_inputs(const sorting *s, uint32_t *out, uint32_t a) {
    const uint32_t end = dm_mark(s->g, s->root + s->first[a], size_of(s, a));
    uint32_t count = 0;
    for (dm_node n = 0; n < end; n++)
        if (dm_is_marked(s->g, n) && dm_is_op(s->g, n, DM_OP_INPUT))
            out[count++] = dm_at(s->g, n)->as.input;
    return count;
}

/* where body b, a copy of body a, takes its inputs and leaves its outputs */
static void place_copy(sorting *s, kind *k, uint32_t a, uint32_t b) {
    const uint32_t c = k->copies++, m = size_of(s, a);
    is_copy(s, a, b);
    for (uint32_t i = 0; i < k->inputs; i++) {
        const dm_node leaf = s->pair[dm_leaf_of(s->g, k->in[i])] - 1;
        k->in[(size_t)c * k->inputs + i] = dm_at(s->g, leaf)->as.input;
    }
    memcpy(k->out + (size_t)c * m, s->number + s->first[b], m * sizeof *k->out);
}

/* body a and all of its copies; 0: no memory */
static int place_kind(sorting *s, kind *k, uint32_t a) {
    uint32_t copies = 0, *inputs = dm_arena_take(s->arena, dm_graph_inputs(s->g) * sizeof *inputs);
    for (uint32_t b = a; b < s->bodies; b++) copies += s->like[b] == a && size_of(s, b);
    if (!inputs) return 0;
    *k = (kind){.inputs = list_inputs(s, inputs, a), .vary = size_of(s, a)};
    k->in = dm_arena_take(s->arena, ((size_t)copies * k->inputs + 1) * sizeof *k->in);
    k->out = dm_arena_take(s->arena, ((size_t)copies * k->vary + 1) * sizeof *k->out);
    if (!k->in || !k->out) return 0;
    memcpy(k->in, inputs, k->inputs * sizeof *inputs);
    for (uint32_t b = a; b < s->bodies; b++)
        if (s->like[b] == a && size_of(s, b)) place_copy(s, k, a, b);
    return 1;
}

/* the part in a graph of its own; NULL: no memory */
static dm_graph *separate(const sorting *s, const kind *k, dm_node *roots) {
    dm_node *with = dm_arena_take(s->arena, (dm_graph_inputs(s->g) + k->vary) * sizeof *with);
    dm_graph *h = dm_graph_new(s->arena, k->inputs);
    if (!h || !with) return NULL;
    dm_node *given = with + dm_graph_inputs(s->g);
    for (uint32_t i = 0; i < k->inputs; i++) with[k->in[i]] = dm_input(h, i);
    for (uint32_t i = 0; i < k->vary; i++) given[i] = s->all[k->out[i]];
    dm_transplant(h, s->g, given, k->vary, with, roots);
    return h;
}

/* in lanes where the kernel of one is native */
static dm_status compile_part(kind *k, dm_graph *h, const dm_node *roots, dm_compile *compile,
                              dm_arena *arena) {
    k->lanes = dm_jit_lanes();
    if (compile == dm_native_build && k->lanes >= 4 && k->copies >= 4 &&
        dm_jit_build_lanes(&k->part, h, roots, k->vary, k->lanes, arena) == DM_OK)
        return DM_OK;
    k->lanes = 1;
    return compile(&k->part, h, roots, k->vary, arena);
}

/* Outputs that the compiler found to be constants are taken out of the lists. */
static void drop_constants(const sorting *s, kind *k) {
    const dm_kernel *part = &k->part;
    uint32_t *to = k->out;
    k->vary = 0;
    for (uint32_t i = 0; i < part->outputs; i++)
        if (!part->fixed || !part->fixed[i]) k->varying[k->vary++] = i;
    for (uint32_t c = 0; c < k->copies; c++)
        for (uint32_t i = 0; i < part->outputs; i++) {
            const uint32_t number = k->out[(size_t)c * part->outputs + i];
            if (!part->fixed || !part->fixed[i]) {
                *to++ = number;
                continue;
            }
            s->fixed[number] = 1;
            s->constant[number] = part->constant[i];
        }
}

static dm_status make_kind(const sorting *s, kind *k, dm_compile *compile) {
    dm_node *roots = dm_arena_take(s->arena, k->vary * sizeof *roots);
    dm_graph *h = roots ? separate(s, k, roots) : NULL;
    k->varying = dm_arena_take(s->arena, k->vary * sizeof *k->varying);
    if (!h || !k->varying) return DM_NO_MEMORY;
    dm_status status = dm_graph_status(h);
    if (status == DM_OK) status = compile_part(k, h, roots, compile, s->arena);
    if (status == DM_OK) drop_constants(s, k);
    return status;
}

/* Is it worth it? Many bodies of few kinds, parts that there is room for, and little that is
 * computed twice. */
static int pays(const sorting *s, uint32_t kinds_found) {
    uint32_t there = 0;
    uint64_t operations = 0;
    for (uint32_t b = 0; b < s->bodies; b++) {
        const uint32_t size = size_of(s, b);
        there += size > 0;
        if (size > ROOM / LANES) return 0;
        operations += dm_operations(s->g, s->root + s->first[b], size);
    }
    return 2 * kinds_found <= there &&
           operations <= 2 * (uint64_t)dm_operations(s->g, s->all, s->m);
}

/* 0: no memory */
static int open_sorting(sorting *s) {
    const size_t nodes = dm_graph_size(s->g), m = s->m;
    dm_arena *scratch = dm_arena_scratch(dm_graph_arena(s->g));
    if (!scratch) return 0;
    s->fixed = dm_arena_take(s->arena, m + 1);
    s->constant = dm_arena_take(s->arena, (m + 1) * sizeof *s->constant);
    s->first = dm_arena_take(scratch, (s->bodies + 1) * sizeof *s->first);
    s->like = dm_arena_take(scratch, s->bodies * sizeof *s->like);
    s->number = dm_arena_take(scratch, (m + 1) * sizeof *s->number);
    s->root = dm_arena_take(scratch, (m + 1) * sizeof *s->root);
    s->body = dm_arena_take(scratch, nodes * sizeof *s->body);
    s->pair = dm_arena_take(scratch, nodes * sizeof *s->pair);
    s->seen = dm_arena_take(scratch, nodes * sizeof *s->seen);
    s->stack = dm_arena_take(scratch, (6 * nodes + 2) * sizeof *s->stack);
    if (!s->fixed || !s->constant || !s->first || !s->like || !s->number || !s->root || !s->body ||
        !s->pair || !s->seen || !s->stack)
        return 0;
    memset(s->pair, 0, nodes * sizeof *s->pair);
    return 1;
}

/* where the copies are: with the arrays of the sorting, which the compiler writes over; 0 kinds:
 * it does not pay */
static dm_status place(kinds *all, sorting *s, const uint32_t *body) {
    if (!open_sorting(s)) return DM_NO_MEMORY;
    sort(s, body);
    const uint32_t count = find_kinds(s);
    if (count > KINDS || !pays(s, count)) return DM_OK;
    for (uint32_t b = 0; b < s->bodies; b++) {
        if (s->like[b] != b || !size_of(s, b)) continue;
        kind *k = all->of + all->count++;
        if (!place_kind(s, k, b)) return DM_NO_MEMORY;
        if (k->inputs > ROOM / LANES) all->count = 0, b = s->bodies;
    }
    return DM_OK;
}

dm_status dm_equal_parts_build(dm_kernel *out, dm_graph *g, const dm_node *roots, uint32_t m,
                               const uint32_t *body, uint32_t bodies, dm_compile *compile,
                               dm_arena *arena) {
    sorting s = {.g = g, .all = roots, .m = m, .bodies = bodies, .arena = arena};
    *out = (dm_kernel){.inputs = dm_graph_inputs(g), .outputs = m};
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    if (dm_has_roots(g, roots, m)) return DM_OK;
    kinds *all = dm_arena_take(arena, sizeof *all);
    if (!all) return DM_NO_MEMORY;
    all->count = 0;
    dm_status status = place(all, &s, body);
    for (uint32_t i = 0; i < all->count && status == DM_OK; i++) {
        status = make_kind(&s, all->of + i, compile);
        out->operations += all->of[i].part.operations * all->of[i].copies;
    }
    if (status != DM_OK || !all->count) return status;
    out->eval = eval;
    out->pool = all;
    out->backend = all->of->part.backend;
    out->fixed = s.fixed;
    out->constant = s.constant;
    return DM_OK;
}
