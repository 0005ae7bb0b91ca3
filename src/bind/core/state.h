/* state.h - what the bindings keep per Lua state: the classes of values, the traces in
 * progress, the memory of arenas. */
#ifndef DML_STATE_H
#define DML_STATE_H

#include "bind/core/bind.h"
#include "graph/graph.h"

enum {
    DML_CLASS_VECTOR,
    DML_CLASS_MATRIX,
    DML_CLASS_SYMBOL,
    DML_CLASS_HYPERDUAL,
    DML_CLASSES,
    DML_NO_CLASS = DML_CLASSES
};

struct dml_state;

/* Something that is under way (scope.h). */
typedef struct dml_scope {
    lua_State *thread; /* in which, or NULL */
    void (*leave)(struct dml_state *state, struct dml_scope *scope);
    struct dml_scope *before; /* the one that it is nested in */
    int entered;
} dml_scope;

/* What a symbol of a trace is in Lua. */
typedef struct {
    dm_node node;
    uint32_t serial; /* of the trace */
    int slot;        /* among those that are kept, or 0 */
} dml_symbol;

/* Symbols of a trace that is repeated: the next time they are given out again. */
typedef struct {
    lua_State *keeper; /* they stand on its stack; NULL: none are kept */
    dml_symbol **of;   /* [count] by node, NULL: not made yet */
    uint32_t count;
    int busy; /* a trace that repeats has them */
} dml_symbols;

struct dml_log;
struct dml_step;
struct dml_traced;

/* A trace in progress: its symbols carry the serial number. What adds to its graph goes by
 * trace_log.h. */
typedef struct dml_frame {
    dml_scope scope;
    const dm_graph *graph; /* its own, or that of the trace that it repeats */
    dm_graph *own;         /* NULL while it repeats one */
    dm_arena *arena;
    struct dml_log *log;               /* being written, or NULL */
    const struct dml_traced *last;     /* being repeated, or NULL */
    const struct dml_step *step, *end; /* of its log: the next, and one past the last */
    dml_symbols *symbols;              /* of its log, or NULL */
    const char *what;                  /* "L": the function as messages name it */
    uint32_t serial;
    int keeps_sums, may_branch; /* as its signature says */
    uint32_t sums;              /* calls of dm.sum_over so far */
    /* of the term of a sum over cells: what a scalar of the trace around it is inside, where it
     * becomes one more input; NULL elsewhere: symbols of two traces do not meet */
    dm_node (*capture)(lua_State *L, struct dml_frame *f, uint32_t serial, dm_node node);
    void *request;          /* of it */
    struct dml_frame *next; /* the trace that this one is nested in */
} dml_frame;

/* While a function is compared with its trace: dm.sum_over and K:sum give these numbers where the
 * trace has a sum, instead of a loop over all bodies, and compare rounds of it with the term that
 * was traced (trace/given.h). */
typedef struct dml_given {
    dml_scope scope;
    const dm_graph *graph; /* of the trace */
    const double *values;  /* of its sums; NULL: not now */
    uint32_t calls;        /* of sums in this call of the function */
    uint32_t looked;       /* sums, in their order, that many rounds of were compared */
    int differs;           /* a term did: in this round of so many of this function */
    double plain, traced;
    const char *what;
    uint32_t round, rounds;
    const dml_frame *within;  /* the newest trace then: later ones sum themselves */
    struct dml_given *before; /* the comparison that this one is nested in */
} dml_given;

typedef struct dml_state {
    const void *metatable[DML_CLASSES];
    dml_scope *scopes;             /* all that is under way, newest first */
    dml_given *given;              /* or NULL */
    dml_frame *frames;             /* newest first */
    uint32_t serial;               /* of the newest trace */
    double roots;                  /* serial number of the newest implicit function */
    int depth;                     /* callbacks inside callbacks */
    int spare;                     /* an arena waits to be used again */
    int memory_least, memory_seen; /* KB of Lua: since they last shrank, when last looked at */
    int closing;                   /* its Lua is about to go */
} dml_state;

dml_state *dml_getstate(lua_State *L);

/* Make metatable `tname` the one of values of that class. */
void dml_setclass(lua_State *L, int class, const char *tname);

/* Class of the userdata at arg, DML_NO_CLASS when it is none of these. */
int dml_classof(lua_State *L, int arg);

/* Push an empty userdata of the class. */
void *dml_newvalue(lua_State *L, int class, size_t size, int uservalues);

/* The trace with this number, NULL when it has ended. */
dml_frame *dml_findframe(lua_State *L, uint32_t serial);

/* Raise "`how` met a symbol": what needs a value in the trace with this number, and what to use
 * instead. */
int dml_refusesymbol(lua_State *L, const char *how, uint32_t serial);

/* KB that Lua takes before its collector begins: what a first model or frame leaves behind (first
 * frames of docs/benchmarks/frames.md, 8 %). */
enum { DML_ROOM = 4096 };

/* Push what keeps the memory of an arena of dml_pusharena alive. */
void dml_pushkeeper(lua_State *L, const dm_arena *arena);

/* Give back the arena at arg, of dml_pusharena: nothing in it is needed any more. The next one
 * that is asked for gets its memory, which saves the collector work. */
void dml_sparearena(lua_State *L, int arg);

/* A stack of its own for values that live as long as the arena, which is one of dml_pusharena;
 * NULL: no memory. */
lua_State *dml_arenastack(const dm_arena *arena);

/* Has the collector given back what kernels of the arena had outside of Lua? Only finalizers can
 * see that. */
int dml_arenalost(const dm_arena *arena);

/* Raise when the graph refused to grow. */
void dml_checkgraph(lua_State *L, const dml_frame *frame);

#endif
