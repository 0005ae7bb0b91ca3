/* bind_system.h - `dm.system`, `dm.discrete_lagrangian` and their models as the other bindings
 * see them. */
#ifndef DML_SYSTEM_H
#define DML_SYSTEM_H

#include "bind/trace/trace.h"
#include "mech/constraints.h"
#include "mech/group.h"

/* A mechanical system: the userdata keeps numbers, its user value 1 the fields as given.
 */
typedef struct {
    uint32_t n;       /* dim Q; on a group: flat coordinates of an element */
    uint32_t momenta; /* entries of p: n, or the dimension of the group */
    int placed;       /* Q is a group: field `place` says how (space_group.h) */
    int pair;         /* 1: a discrete Lagrangian Ld(q0, q1), 0: L(q, v, t) */
    int ruled;        /* 1: a discrete Lagrangian of a system and a rule (discrete_rule.h) */
    int hyperdual;    /* 1: derivatives = "hyperdual" */
    int solved;       /* 1: its map solves equations of its own, and is not compared with Ld */
    int hamiltonian;  /* 1: H(q, p, t) is stepped, there is no L (mech/hamiltonian.c) */
    int stand_in;     /* 1: of a discrete Lagrangian on a group; its L is none of the motion's */
    int field;        /* 1: of cells of a mesh; L gets no symbols for q and v, its sums read them */
    int crossings;    /* 1: steps may go over places where its constraints cross */
    int prolonged;    /* 1: its runs are tangent maps (core.prolonged) */
    double h;         /* step of a discrete Lagrangian, else 0 */
    int constrained;  /* 1: it has one of the functions below; known once `asked` */
    int asked;
} dml_system;

#define DML_SYSTEM "dm.system"
#define DML_DISCRETE "dm.discrete_lagrangian"

/* Push a new system (or, pair = 1, discrete Lagrangian) from the options table at 1. */
void dml_newsystem(lua_State *L, const char *const *known, int pair);

/* Push the space R(n), of any n. */
void dml_push_rn(lua_State *L, uint32_t n);

/* dm.system{ Q =, L = }, as a C function. */
int dml_system_new(lua_State *L);

/* core.stand_in{ Q =, L =, name = }: a system that a discrete Lagrangian on a group is stepped
 * with, whose runs have no energy and no velocity. */
int dml_stand_in_new(lua_State *L);

/* core.prolonged{ Q =, ... }: a system of (q, u), half of whose constraints are those of q, the
 * others their change along u. */
int dml_prolonged_new(lua_State *L);

/* The system or discrete Lagrangian at `arg`; raises when it is neither. */
dml_system *dml_checksystem(lua_State *L, int arg);

/* Push field `key` of the system at `arg` (Q, L, Ld, name, coordinates, params, units,
 * h); returns its type. */
int dml_systemfield(lua_State *L, int arg, const char *key);

/* Names of the n coordinates: given ones or q1 .. qn; pushes the name of coordinate i
 * (from 0). */
const char *dml_coordinate(lua_State *L, int arg, uint32_t i);

/* The functions that constrain a system or act on it (model_constraints.h). */
enum {
    DML_CONSTRAINT,
    DML_ROLLING,
    DML_CONTROL,
    DML_FORCE,
    DML_REACTION,
    DML_MAP, /* the step of a discrete Lagrangian, where it is given */
    DML_CONSTRAINT_FUNCTIONS
};

/* A traced system: what one run uses. Pushed as a userdata that keeps arena and function
 * alive. */
typedef struct {
    dm_arena *arena;
    dm_graph *graph; /* NULL when on hyper-dual numbers */
    dm_node lagrangian;
    dm_node stepped; /* the same node, or of a singular mass that of mech/saddle.h */
    uint32_t n;
    uint32_t params; /* inputs behind t (model_params.h) */
    double *values;  /* [params] of the system when it was traced */
    dm_model model;
    int hamiltonian;        /* what was traced is H(q, p, t) */
    dml_callback *callback; /* NULL when traced */
    const char *backend;    /* of the kernels: "tape", "hyperdual" */
    double trace_ms, compile_ms;
    dml_traced trace;      /* of L, to be repeated; log NULL: none */
    uint32_t traced;       /* nodes of the graph when only L was in it */
    int checked;           /* compared with the function around the start of a run */
    dm_compile *compile;   /* of a model in the cache (model_cache.h), else NULL */
    dm_cache_entry *cache; /* kernels of methods */
    dml_traced constraint
        [DML_CONSTRAINT_FUNCTIONS]; /* each in a graph of its own; graph NULL: there is none */
    dm_kernel constraint_kernel[DML_CONSTRAINT_FUNCTIONS]; /* the same for comparisons, once made */
    double *room;                      /* for their inputs and outputs, or NULL */
    double *work_room;                 /* for forces of a checkpoint, or NULL */
    dm_constraints_traced constrained; /* all in one graph, NULL without any */
    uint32_t constraints_traced;       /* its nodes, before derivatives */
    dm_constraints constraints;
    dm_group group;
    int placed; /* it is on a group */
} dml_model;

/* Trace the system at `arg` and push its model with no kernels yet but its structure. */
dml_model *dml_pushmodel(lua_State *L, int arg);

/* The same for a run with the backend of that name by a method that DM_KEEPS: the model of the
 * last such run where the trace is the same, with all its kernels. */
dml_model *dml_pushlast(lua_State *L, int arg, const char *backend);

/* Make the kernels `want` (DM_WANT_*) that are missing, with the backend of that name
 * (NULL: the default). */
void dml_want(lua_State *L, dml_model *m, unsigned want, const char *backend);

/* From now on *m is made of L as it is given, however singular its mass is. */
void dml_asgiven(lua_State *L, dml_model *m);

/* From now on the graph of *m has no sums, every round is written out; raises where that is too
 * large. */
void dml_writeout(lua_State *L, dml_model *m);

/* Names that a system is made with, NULL behind them: lists and tables that are copied. */
extern const char *const dml_names[];

/* Push field `key` of the system at 1 as a script sees it: names cannot be set. */
int dml_shownfield(lua_State *L, const char *key);

/* (system, key) -> params as a script sees them; the options at 1 with those behind such. */
int dml_shownparams(lua_State *L);
void dml_plainparams(lua_State *L);

/* Push another userdata with the bytes and the metatable of the one at `of`. */
void *dml_pushtwin(lua_State *L, int of, int user_values);

/* core.trace_with */
int dml_core_trace_with(lua_State *L);

/* Push function `key` of the system at `arg`, its params bound as the last argument. */
void dml_pushbound(lua_State *L, int arg, const char *key);

/* The same of a discrete Lagrangian, whose functions get h before the params. */
void dml_pushboundpair(lua_State *L, int arg, const char *key);

/* What dm_legendre and its inverse need of this model, of which `want` is wanted too. */
unsigned dml_legendre_wants(const dml_model *m, unsigned want);

/* Raise a mismatch between trace and function (trace.h) for the system at `arg` at x =
 * (q, v, t) or (q0, q1). */
void dml_checkmodel(lua_State *L, int arg, dml_model *m, const double *x);

/* The same at the start of one of many members, which may be outside of the domain of L. */
void dml_checkmember(lua_State *L, int arg, dml_model *m, const double *x);

/* Push why an implicit function of L or of the constraints had no value lately (dml_roottrouble),
 * "" where all had; and from now on they have had none. */
const char *dml_modeltrouble(lua_State *L, const dml_model *m);
void dml_forgetroots(const dml_model *m);

/* A callback failed inside a kernel: raise the user's own error. Else nothing. */
void dml_rethrow(lua_State *L, dml_model *m);

/* Hyper-dual kernels in the layout of mech/model.h. */
void dml_hyperdual_model(lua_State *L, dml_model *m, unsigned want, int pair);

/* A kernel that calls L itself at x: raises where it is NaN there, unless it may be, or not the
 * same number when asked again. */
void dml_check_callback(lua_State *L, dml_model *m, const char *what, const double *x,
                        int may_be_outside);

/* tostring(system), which raises nothing that the functions of the system raise; system:graph(). */
int dml_system_tostring(lua_State *L);
int dml_system_graph(lua_State *L);

#endif
