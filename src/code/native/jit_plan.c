/* jit_plan.c - the order of a kernel's operations. Node numbers are topological, so without
 * calls that is the order. A call of the library destroys all registers: therefore whatever a
 * call needs comes first, then the calls with what leads to further calls, and all that no call
 * needs last, when nothing has to survive one any more.
 * Speed: P4: 24x, native code against the tape. */
#include "code/native/jit_plan.h"

#include "graph/nodes.h"

#include <string.h>

/* early[n]: a call needs n, or n is one; also the partner of every sine and cosine */
static void find_early(const dm_graph *g, uint32_t end, uint8_t *early, dm_node *cosine) {
    for (dm_node n = end; n-- > 0;) {
        const dm_expr *e = dm_at(g, n);
        if (!dm_is_marked(g, n)) continue;
        if (dm_is_call((uint8_t)e->op)) early[n] = 1;
        if (e->op == DM_OP_COS) cosine[e->as.arg[0]] = n;
        for (int k = 0; early[n] && k < dm_arity(e->op); k++) early[e->as.arg[k]] = 1;
    }
}

/* a sine takes the cosine of its angle along, wherever that stands */
static void add_step(dm_plan *p, const dm_graph *g, dm_node n, dm_node *cosine, uint8_t *done) {
    const dm_expr *e = dm_at(g, n);
    dm_step *s = p->steps + p->count++;
    *s = (dm_step){.op = (uint8_t)e->op, .d = n};
    s->operands = (uint8_t)dm_arity(e->op);
    for (int k = 0; k < s->operands; k++) s->arg[k] = e->as.arg[k];
    p->calls += (uint32_t)dm_is_call(s->op);
    if (s->op != DM_OP_SIN || !cosine[s->arg[0]]) return;
    s->d2 = cosine[s->arg[0]];
    done[s->d2] = 1;
}

/* the sine of the angle of a cosine, should it be needed too; else 0 */
static dm_node partner(dm_graph *g, const dm_expr *e) {
    const dm_expr sine = {.op = DM_OP_SIN, .as.arg = {e->as.arg[0]}};
    const dm_node n = e->op == DM_OP_COS ? dm_node_find(g, &sine) : 0;
    return dm_is_marked(g, n) ? n : 0;
}

/* two rounds by number: what calls need, then the rest */
static void order_around_calls(dm_plan *p, dm_graph *g, const uint8_t *early, dm_node *cosine,
                               uint8_t *done) {
    for (int late = 0; late < 2; late++)
        for (dm_node n = 1; n < p->end; n++) {
            const dm_expr *e = dm_at(g, n);
            if (!dm_is_marked(g, n) || done[n] || early[n] == late) continue;
            if (dm_arity(e->op) == 0) continue;
            const dm_node sine = partner(g, e);
            done[sine ? sine : n] = 1;
            add_step(p, g, sine ? sine : n, cosine, done);
        }
}

/* from the last step back: where each operand is used again */
static void find_uses(dm_plan *p, int at_end) {
    memset(p->first, 0xFF, p->end * sizeof *p->first);
    for (uint32_t i = 0; at_end && i < p->m; i++) p->first[p->roots[i]] = p->count;
    for (uint32_t i = p->count; i-- > 0;) {
        dm_step *s = p->steps + i;
        for (int k = 0; k < s->operands; k++) s->next[k] = p->first[s->arg[k]];
        for (int k = 0; k < s->operands; k++) p->first[s->arg[k]] = i;
    }
}

/* several outputs may be one node: chained by `also` */
static void find_outputs(dm_plan *p) {
    for (uint32_t i = 0; i < p->m; i++) {
        p->also[i] = p->output[p->roots[i]];
        p->output[p->roots[i]] = i + 1;
    }
}

static int has_calls(const dm_graph *g, uint32_t end) {
    for (dm_node n = 1; n < end; n++)
        if (dm_is_marked(g, n) && dm_is_call((uint8_t)dm_at(g, n)->op)) return 1;
    return 0;
}

/* operations as they are numbered */
static void order_plainly(dm_plan *p, const dm_graph *g) {
    dm_step *s = p->steps;
    for (dm_node n = 1; n < p->end; n++) {
        const dm_expr *e = dm_at(g, n);
        const int operands = dm_arity(e->op);
        if (!operands || !dm_is_marked(g, n)) continue;
        *s = (dm_step){.op = (uint8_t)e->op, .operands = (uint8_t)operands, .d = n};
        for (int k = 0; k < operands; k++) s->arg[k] = e->as.arg[k];
        s++;
    }
    p->count = (uint32_t)(s - p->steps);
}

/* steps, with pairs of sine and cosine joined where there are calls */
static int order_steps(dm_plan *p, dm_graph *g) {
    dm_arena *arena = p->scratch;
    if (!has_calls(g, p->end)) {
        order_plainly(p, g);
        return 1;
    }
    uint8_t *early = dm_arena_take(arena, p->end), *done = dm_arena_take(arena, p->end);
    dm_node *cosine = dm_arena_take(arena, p->end * sizeof *cosine);
    if (!early || !done || !cosine) return 0;
    memset(early, 0, p->end);
    memset(done, 0, p->end);
    memset(cosine, 0, p->end * sizeof *cosine);
    find_early(g, p->end, early, cosine);
    order_around_calls(p, g, early, cosine, done);
    return 1;
}

/* from roots to steps with their next uses; a part of a loop uses its roots once more at the
 * end */
static int make(dm_plan *p, dm_graph *g, int part) {
    const uint32_t end = p->end = dm_mark(g, p->roots, p->m);
    p->steps = dm_arena_take(p->scratch, end * sizeof *p->steps);
    p->first = dm_arena_take(p->scratch, end * sizeof *p->first);
    p->output = dm_arena_take(p->scratch, end * sizeof *p->output);
    p->also = dm_arena_take(p->scratch, p->m * sizeof *p->also);
    if (!p->steps || !p->first || !p->output || !p->also) return 0;
    memset(p->output, 0, end * sizeof *p->output);
    if (!order_steps(p, g)) return 0;
    find_uses(p, part);
    if (!part) find_outputs(p);
    return 1;
}

int dm_plan_make(dm_plan *p, dm_graph *g, const dm_node *roots, uint32_t m, dm_arena *scratch) {
    *p = (dm_plan){.roots = roots, .m = m, .scratch = scratch};
    return make(p, g, 0);
}

int dm_plan_make_part(dm_plan *p, dm_graph *g, const dm_node *roots, uint32_t m,
                      dm_arena *scratch) {
    *p = (dm_plan){.roots = roots, .m = m, .scratch = scratch};
    return make(p, g, 1);
}
