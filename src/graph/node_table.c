/* node_table.c - the table that finds a node by its content. Who makes a node has most often
 * just made one of its operands, so its first places are near that operand's: those of nodes
 * made in a row are in a row, too, and in the processor's caches. Where many nodes have one
 * newest operand (a constant, an input) all but the first few go to places anywhere, by the
 * hash. A graph that nothing is looked for in has no table: it is made when it is first asked,
 * and again after growth.
 *
 * Nodes below g->tabled are in the table, at most half of whose slots are taken. The table is
 * an index only: taking the newest nodes out again, newest first, leaves it as it was before
 * them. */
#include "graph/nodes.h"

/* what tells one node from another: op and three words */
typedef struct {
    uint64_t first, second;
} content;

/* operands that an operation does not have are 0, so that contents can be compared as words */
static inline content content_of(const dm_expr *e) {
    const int is_value = e->op == DM_OP_CONSTANT || e->op == DM_OP_IMPLICIT;
    uint64_t bits;
    memcpy(&bits, &e->as.value, sizeof bits);
    if (is_value) return (content){e->op | bits << 32, bits >> 32};
    return (content){e->op | (uint64_t)e->as.arg[0] << 32,
                     e->as.arg[1] | (uint64_t)e->as.arg[2] << 32};
}

/* multiply and fold, twice: good enough for small integers in neighbouring words */
static uint32_t hash(content c) {
    uint64_t h = c.first * 0x9E3779B97F4A7C15u;
    h ^= h >> 32;
    h = (h + c.second) * 0xD6E8FEB86659FD93u;
    return (uint32_t)(h >> 32);
}

/* the slots in a line of the caches, of which four nodes in a row have one */
enum { LINE = 8 };

/* where the slots for users of e's newest operand begin */
static uint32_t line_of(const dm_graph *g, const dm_expr *e, uint32_t h) {
    const dm_node *arg = e->as.arg;
    if (e->op == DM_OP_CONSTANT || e->op == DM_OP_IMPLICIT)
        return h & g->mask & ~(uint32_t)(LINE - 1);
    const uint32_t newer = arg[0] > arg[1] ? arg[0] : arg[1];
    const uint32_t newest = arg[2] > newer ? arg[2] : newer;
    return 2 * newest & g->mask & ~(uint32_t)(LINE - 1);
}

/* the hash first, since the node itself may not be in the caches */
static inline int holds(const dm_graph *g, const dm_slot *slot, content c, uint32_t h) {
    if (slot->hash != h) return 0;
    const content other = content_of(g->nodes + slot->node);
    return other.first == c.first && other.second == c.second;
}

/* the slot that holds this content, or the free one where it belongs, with its hash */
static dm_slot *slot_of(const dm_graph *g, const dm_expr *e) {
    const content c = content_of(e);
    const uint32_t h = hash(c);
    dm_slot *line = g->table + line_of(g, e, h), *slot;
    for (uint32_t k = 0; k < LINE; k++) {
        slot = line + ((h >> 29) + k) % LINE;
        if (slot->node && !holds(g, slot, c, h)) continue;
        slot->hash = h;
        return slot;
    }
    for (uint32_t at = h & g->mask;; at = (at + 1) & g->mask) {
        slot = g->table + at;
        if (slot->node && !holds(g, slot, c, h)) continue;
        slot->hash = h;
        return slot;
    }
}

/* the newest first: every place is then again what it was before the node was made */
void dm_table_forget(dm_graph *g, uint32_t size) {
    for (; g->tabled > size; g->tabled--)
        if (g->nodes[g->tabled - 1].op != DM_OP_INPUT)
            slot_of(g, g->nodes + g->tabled - 1)->node = 0;
}

/* an empty table for all that there is room for, at most half full */
static int open_table(dm_graph *g) {
    const size_t slots = 2 * (size_t)g->capacity;
    g->table = dm_arena_take(g->arena, slots * sizeof *g->table);
    if (!g->table) return dm_graph_fail(g, DM_NO_MEMORY), 0;
    memset(g->table, 0, slots * sizeof *g->table);
    g->mask = (uint32_t)(slots - 1);
    g->tabled = 1;
    return 1;
}

/* nodes that were made since the last look-up are put in first */
dm_node *dm_table_place(dm_graph *g, const dm_expr *e) {
    if (g->tabled == 0 && !open_table(g)) return NULL;
    for (; g->tabled < g->size; g->tabled++)
        if (g->nodes[g->tabled].op != DM_OP_INPUT)
            slot_of(g, g->nodes + g->tabled)->node = g->tabled;
    return &slot_of(g, e)->node;
}
