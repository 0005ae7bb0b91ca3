/* fingerprint.c - one hash a node, operands first; those of implicit functions and of sums take
 * the hashes of the graphs they have of their own. */
#include "algebra/fingerprint.h"

#include "algebra/body_sum.h"
#include "algebra/implicit.h"

uint64_t dm_hash(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; i++) hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}

/* ---- implicit functions ---- */

/* by what they solve and where they begin */
static int of_implicit(uint64_t *hash, const dm_implicit *f, dm_arena *arena) {
    const uint32_t r = f->unknowns;
    const uint32_t shape[] = {r, f->inputs, f->starts, (uint32_t)f->has_branch,
                              (uint32_t)f->has_value};
    *hash = dm_hash(*hash, shape, sizeof shape);
    *hash = dm_hash(*hash, &f->angles, sizeof f->angles);
    return dm_fingerprint(hash, f->graph, f->equation, r, arena) &&
           (!f->has_branch ||
            dm_fingerprint(hash, f->graph, f->equation + r + r * (size_t)r, 1, arena)) &&
           (!f->has_value || dm_fingerprint(hash, f->graph, f->value, 1, arena)) &&
           dm_fingerprint(hash, f->graph, f->start, f->starts * r, arena);
}

/* ---- sums ---- */

/* the bodies that a column reads, and its numbers */
static uint64_t of_column(uint64_t hash, const dm_sum *s, const dm_column *c) {
    const uint32_t shape[] = {c->first,
                              c->step,
                              (uint32_t)c->partner,
                              (uint32_t)c->varied,
                              c->data != NULL,
                              c->index != NULL};
    hash = dm_hash(hash, shape, sizeof shape);
    if (c->index) hash = dm_hash(hash, c->index, s->bodies * sizeof *c->index);
    const uint32_t entries = c->step ? s->bodies : 1;
    for (uint32_t i = 0; c->data && i < entries; i++) {
        const size_t at = c->index ? dm_sum_entry(s, c, i, 0) : c->first + (size_t)c->step * i;
        hash = dm_hash(hash, c->data + at, sizeof *c->data);
    }
    return hash;
}

/* which bodies meet */
static uint64_t of_pattern(uint64_t hash, const dm_sum *s) {
    const uint32_t counts[] = {s->columns,
                               s->bodies,
                               s->from,
                               s->to,
                               (uint32_t)s->periodic,
                               s->axes,
                               s->partner,
                               (uint32_t)s->cells,
                               (uint32_t)s->work,
                               s->sphere};
    const double lengths[] = {s->within, s->margin, s->box[0], s->box[1], s->box[2]};
    hash = dm_hash(hash, counts, sizeof counts);
    hash = dm_hash(hash, lengths, sizeof lengths);
    return s->held ? dm_hash(hash, s->held, s->coordinates) : hash;
}

static int of_sum(uint64_t *hash, const dm_sum *s, dm_arena *arena) {
    *hash = of_pattern(*hash, s);
    for (uint32_t c = 0; c < s->columns; c++) *hash = of_column(*hash, s, s->column + c);
    return dm_fingerprint(hash, s->term, &s->value, 1, arena);
}

/* The sum that an input stands for; NULL: it is an input of the function. */
static const dm_sum *sum_at(const dm_graph *g, uint32_t input) {
    const dm_sum *s = dm_sums(g);
    while (s && s->input != input) s = s->next;
    return s;
}

/* ---- nodes ---- */

static int of_input(uint64_t *hash, const dm_graph *g, uint32_t input, dm_arena *arena) {
    const dm_sum *s = sum_at(g, input);
    if (s) return of_sum(hash, s, arena);
    *hash = dm_hash(*hash, &input, sizeof input);
    return 1;
}

/* node i, those of its operands being known */
static int of_node(uint64_t *of, const dm_graph *g, dm_node i, dm_arena *arena) {
    const dm_expr *x = dm_graph_at(g, i);
    const uint32_t op = x->op;
    uint64_t *hash = of + i;
    *hash = dm_hash(DM_HASH_START, &op, sizeof op);
    if (x->op == DM_OP_INPUT) return of_input(hash, g, x->as.input, arena);
    if (x->op == DM_OP_IMPLICIT) return of_implicit(hash, dm_implicit_find(g, x->as.value), arena);
    if (x->op == DM_OP_CONSTANT) *hash = dm_hash(*hash, &x->as.value, sizeof x->as.value);
    if (x->op == DM_OP_ADD || x->op == DM_OP_MUL) { /* a graph orders operands by number */
        const uint64_t both = of[x->as.arg[0]] + of[x->as.arg[1]];
        *hash = dm_hash(*hash, &both, sizeof both);
        return 1;
    }
    for (int k = 0; k < dm_op_operands(x->op); k++)
        *hash = dm_hash(*hash, of + x->as.arg[k], sizeof *of);
    return 1;
}

int dm_fingerprint(uint64_t *hash, const dm_graph *g, const dm_node *out, uint32_t count,
                   dm_arena *arena) {
    dm_node size = 1;
    for (uint32_t i = 0; i < count; i++)
        if (out[i] >= size) size = out[i] + 1;
    uint64_t *of = dm_arena_take(arena, size * sizeof *of), work = 0;
    if (!of) return 0;
    for (dm_node i = 0; i < size; i++)
        if (!of_node(of, g, i, arena)) return 0;
    for (uint32_t i = 0; i < count; i++) *hash = dm_hash(*hash, of + out[i], sizeof *of);
    for (const dm_sum *s = dm_sums(g); s; s = s->next) {
        uint64_t one = DM_HASH_START;
        if (s->work && !of_sum(&one, s, arena)) return 0;
        if (s->work) work += one; /* in any order */
    }
    *hash = dm_hash(*hash, &work, sizeof work);
    return 1;
}
