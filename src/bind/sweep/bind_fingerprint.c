/* bind_fingerprint.c - what decides the result of a run, as a short text: two systems whose
 * functions are traced to the same graph have the same one, whatever their script looks like. */
#include "bind/model/bind_system.h"
#include "graph/graph.h"
#include "numbers/processor.h"

#include <stdio.h>
#include <string.h>

/* FNV-1a, 64 bits */
static uint64_t mix(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; i++) hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}

/* Of every node of a graph, by what it is made of: the order in which a script makes them does not
 * count. Serial numbers of implicit functions differ from process to process. Pushes the room. */
static const uint64_t *node_hashes(lua_State *L, const dm_graph *g, uint32_t size) {
    uint64_t *out = lua_newuserdatauv(L, (size + (size_t)1) * sizeof *out, 0);
    for (dm_node i = 0; i < size; i++) {
        const dm_expr *x = dm_graph_at(g, i);
        const uint32_t op = x->op;
        uint64_t hash = mix(0xcbf29ce484222325u, &op, sizeof op);
        if (x->op == DM_OP_CONSTANT) hash = mix(hash, &x->as.value, sizeof x->as.value);
        if (x->op == DM_OP_INPUT) hash = mix(hash, &x->as.input, sizeof x->as.input);
        for (int k = 0; k < dm_op_operands(x->op); k++)
            hash = mix(hash, out + x->as.arg[k], sizeof *out);
        if (x->op == DM_OP_ADD || x->op == DM_OP_MUL) { /* a graph orders operands by number */
            const uint64_t both = out[x->as.arg[0]] + out[x->as.arg[1]];
            hash = mix(mix(0xcbf29ce484222325u, &op, sizeof op), &both, sizeof both);
        }
        out[i] = hash;
    }
    return out;
}

static uint64_t mix_outputs(lua_State *L, uint64_t hash, const dm_graph *g, const dm_node *out,
                            uint32_t count) {
    const uint64_t *hashes = node_hashes(L, g, dm_graph_size(g));
    for (uint32_t i = 0; i < count; i++) hash = mix(hash, hashes + out[i], sizeof *hashes);
    lua_pop(L, 1);
    return hash;
}

/* L (or Ld, H) and the functions that constrain the system or act on it */
static uint64_t fingerprint_of(lua_State *L, const dml_model *m) {
    uint64_t hash = mix(0xcbf29ce484222325u, &m->n, sizeof m->n);
    hash = mix_outputs(L, hash, m->graph, &m->lagrangian, 1);
    for (int k = 0; k < DML_CONSTRAINT_FUNCTIONS; k++) {
        const dml_traced *t = &m->constraint[k];
        if (t->graph)
            hash = mix_outputs(L, mix(hash, &k, sizeof k), t->graph, t->out, (uint32_t)t->outputs);
    }
    return hash;
}

/* (system) -> text; functions on hyper-dual numbers have no graph */
static int fingerprint(lua_State *L) {
    char text[24];
    dml_checksystem(L, 1);
    lua_settop(L, 1);
    const dml_model *m = dml_pushmodel(L, 1);
    if (!m->graph) return lua_pushliteral(L, "untraced"), 1;
    snprintf(text, sizeof text, "%016llx", (unsigned long long)fingerprint_of(L, m));
    lua_pushstring(L, text);
    return 1;
}

/* (system) -> entries of q, entries of p */
static int sizes(lua_State *L) {
    const dml_system *s = dml_checksystem(L, 1);
    lua_pushinteger(L, s->n);
    lua_pushinteger(L, s->momenta);
    return 2;
}

/* () -> name of the level that holds now */
static int processor(lua_State *L) {
    static const char *const names[] = {"plain", "fma", "avx512"};
    lua_pushstring(L, names[dm_processor()]);
    return 1;
}

static const dml_row functions[] =
    {{"fingerprint", fingerprint,
      "core.fingerprint(system) -> string\n"
      "Sixteen digits that another L, force or constraint changes, and another script does not; "
      "\"untraced\" of functions on hyper-dual numbers."},
     {"sizes", sizes, "core.sizes(system) -> integer, integer\nEntries of q (flat) and of p."},
     {"processor", processor,
      "core.processor() -> string\n"
      "\"plain\", \"fma\" or \"avx512\": what bits of results depend on (DMLUA_PROCESSOR)."},
     {NULL, NULL, NULL}};

const dml_class dml_class_fingerprint = {
    .functions = functions,
};
