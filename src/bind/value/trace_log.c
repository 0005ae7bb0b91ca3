/* trace_log.c - the log of a trace: written once, compared with what the next call of the
 * function does, copied into a graph of its own where that differs.
 * Speed: setup, again: 1.6x, against a new trace and a comparison of graphs. */
#include "bind/value/trace_log.h"

#include "algebra/prefix.h"

enum {
    FIRST = 64,
    MOST = 1 << 16,        /* steps; no log is longer */
    MOST_SYMBOLS = 1 << 11 /* nodes of a trace whose symbols are kept */
};

/* symbols for the nodes of a log that is repeated for the first time */
static void make_symbols(const dml_traced *last) {
    dm_arena *arena = dm_graph_arena(last->graph);
    dml_symbols *s = last->log->symbols;
    const uint32_t count = last->log->count;
    s->count = count ? last->log->step[count - 1].size : 1 + last->inputs;
    if (s->count > MOST_SYMBOLS) s->count = 0;
    s->of = dm_arena_take(arena, s->count * sizeof(dml_symbol *));
    if (!s->of) return;
    memset(s->of, 0, s->count * sizeof(dml_symbol *));
    s->keeper = dml_arenastack(arena);
}

/* Symbols of the last time are given out again: making and collecting userdata was half of the
 * time of an operation. */
static void take_symbols(dml_frame *f) {
    dml_symbols *s = f->last->log->symbols;
    if (!s->of) make_symbols(f->last);
    if (s->busy || !s->keeper) return;
    s->busy = 1;
    f->symbols = s;
}

void dml_leavesymbols(dml_frame *f) {
    if (f->symbols) f->symbols->busy = 0;
    f->symbols = NULL;
}

/* They stay on the keeper's stack, for the next trace of the same function. */
void dml_dropsymbols(dml_frame *f) {
    dml_symbols *s = f->symbols;
    dml_leavesymbols(f);
    if (!s) return;
    s->count = 0;
    s->keeper = NULL;
}

/* It grows in the arena of the trace. */
static dml_log *new_log(dm_arena *arena) {
    dml_log *log = dm_arena_take(arena, sizeof *log);
    dml_symbols *symbols = dm_arena_take(arena, sizeof *symbols);
    if (!log || !symbols) return NULL;
    *symbols = (dml_symbols){0};
    *log = (dml_log){.symbols = symbols};
    return log;
}

/* 1: the trace repeats *last and makes no nodes until something differs. */
int dml_beginlog(dml_frame *f, const dml_traced *last) {
    f->last = last && last->log && dm_graph_status(last->graph) == DM_OK ? last : NULL;
    if (f->last) {
        f->graph = last->graph;
        f->step = last->log->step;
        f->end = f->step + last->log->count;
        take_symbols(f);
        return 1;
    }
    f->log = new_log(f->arena);
    return f->log != NULL;
}

/* room for so many steps and sums */
static int make_room(dm_arena *arena, dml_log *log, uint32_t steps, uint32_t sums) {
    uint32_t room = log->room ? log->room : FIRST;
    if (steps > MOST) return 0;
    while (room < steps) room *= 2;
    if (steps > log->room) {
        dml_step *step =
            dm_arena_grow(arena, log->step, log->room * sizeof *step, room * sizeof *step);
        if (!step) return 0;
        log->step = step;
        log->room = room;
    }
    if (sums <= log->sums_room) return 1;
    dml_summed *sum = dm_arena_grow(arena, log->sum, log->sums_room * sizeof *sum,
                                    2 * (size_t)sums * sizeof *sum);
    if (!sum) return 0;
    log->sum = sum;
    log->sums_room = 2 * sums;
    return 1;
}

/* The deed and the node that it became, at the end of the log. */
static void note(dml_frame *f, const dml_deed *d, dm_node node) {
    if (!f->log || dm_graph_status(f->graph) != DM_OK) return;
    if (!make_room(f->arena, f->log, f->log->count + 1, 0)) {
        f->log = NULL;
        return;
    }
    f->log->step[f->log->count++] =
        (dml_step){.did = *d, .node = node, .size = dm_graph_size(f->graph)};
}

/* The trace of a term in the arena of this trace: the other one may go first. */
static dml_traced copy_term(dm_arena *arena, const dm_sum *s, const dml_traced *term) {
    dml_traced copy = *term;
    dml_log *log = new_log(arena);
    dm_node *out = dm_arena_take(arena, sizeof *out);
    copy.graph = s->term;
    copy.out = out;
    copy.log = NULL;
    if (out) *out = s->value;
    if (!log || !term->log || !out) return copy;
    if (!make_room(arena, log, term->log->count, 0)) return copy;
    memcpy(log->step, term->log->step, term->log->count * sizeof *log->step);
    log->count = term->log->count;
    copy.log = log;
    return copy;
}

/* the sum of g whose leaf is node */
static const dm_sum *sum_of(const dm_graph *g, dm_node node) {
    const uint32_t input = dm_graph_at(g, node)->as.input;
    const dm_sum *s = dm_sums(g);
    while (s->input != input) s = s->next;
    return s;
}

/* the first `count` steps, for the frame's own graph */
static int copy_log(dml_frame *f, const dml_log *from, uint32_t count) {
    dml_log *log = new_log(f->arena);
    if (!log || !make_room(f->arena, log, count, from->sums)) return 0;
    if (count) memcpy(log->step, from->step, count * sizeof *log->step);
    log->count = count;
    for (uint32_t i = 0; i < count; i++) {
        if (log->step[i].did.op != DM_OP_COUNT) continue;
        const uint32_t k = log->sums++;
        const dm_sum *s = sum_of(f->own, log->step[i].node);
        log->sum[k] = (dml_summed){s, copy_term(f->arena, s, &from->sum[k].term)};
    }
    f->log = log;
    return 1;
}

/* Something differs: from here on the trace has a graph of its own, which begins as a copy of
 * what was the same, under the same numbers. */
void dml_leavelast(lua_State *L, dml_frame *f) {
    if (!f->last) return;
    const dml_log *log = f->last->log;
    const uint32_t count = (uint32_t)(f->step - log->step);
    const uint32_t size = count ? f->step[-1].size : 1 + f->last->inputs;
    f->own = dm_graph_prefix(f->arena, f->last->graph, size);
    if (!f->own || !copy_log(f, log, count)) luaL_error(L, "not enough memory");
    f->graph = f->own;
    f->last = NULL; /* its symbols stay with this trace: the function has them in its hands */
    f->step = f->end = NULL;
}

/* The operation is made in the graph and noted. */
dm_node dml_doanew(lua_State *L, dml_frame *f, const dml_deed *d) {
    dml_leavelast(L, f);
    double x;
    memcpy(&x, d->word, sizeof x);
    const dm_node node = d->op == DM_OP_CONSTANT
                             ? dm_constant(f->own, x)
                             : dm_apply(f->own, (dm_op)d->op, d->word[0], d->word[1], d->word[2]);
    note(f, d, node);
    return node;
}

dm_graph *dml_owngraph(lua_State *L, dml_frame *f) {
    dml_leavelast(L, f);
    f->log = NULL;
    return f->own;
}

const dml_summed *dml_nextsum(const dml_frame *f) {
    if (f->step == f->end || f->step->did.op != DM_OP_COUNT) return NULL;
    return f->last->log->sum + f->step->did.word[0];
}

dm_node dml_sumagain(dml_frame *f) {
    return f->step++->node;
}

/* A sum over bodies is one entry, with the log of its term. */
dm_node dml_sumanew(lua_State *L, dml_frame *f, const dm_sum *s, const dml_traced *term) {
    dml_leavelast(L, f);
    const dm_node node = dm_sum_leaf(f->own, s);
    if (!f->log || dm_graph_status(f->own) != DM_OK) return node;
    const uint32_t k = f->log->sums;
    if (!make_room(f->arena, f->log, f->log->count, k + 1)) {
        f->log = NULL;
        return node;
    }
    f->log->sum[f->log->sums++] = (dml_summed){sum_of(f->own, node), *term};
    note(f, &(dml_deed){.op = DM_OP_COUNT, .word = {k}}, node);
    return node;
}

const dml_traced *dml_repeated(const dml_frame *f, const dm_node *out, uint32_t outputs) {
    if (!f->last || f->step != f->end) return NULL;
    if (outputs != f->last->outputs) return NULL;
    return memcmp(out, f->last->out, outputs * sizeof *out) == 0 ? f->last : NULL;
}
