/* bind_root.h - `dm.root`: an implicit function of a script, traced anew for every shape of its
 * arguments. */
#ifndef DML_ROOT_H
#define DML_ROOT_H

#include "bind/trace/trace.h"
#include "code/implicit/implicit_solve.h"

#define DML_ROOT "dm.root"

/* What was traced for one shape: functions of (y, x...), in an arena that user value 1 keeps. */
typedef struct {
    dm_arena *arena;
    dml_signature s; /* of the equations: y, then the arguments */
    uint32_t unknowns, inputs;
    /* entries of the arguments that y depends on, and their number: those of f */
    uint32_t *used, uses;
    /* as the functions of the script gave them; graph NULL: there is none */
    dml_traced equation, branch, start;
    dm_implicit *f;
    dm_root_solver solver;            /* on the tape */
    dm_kernel value;                  /* S, where F = dS/dy */
    double *x, *chosen, *y, *inverse; /* all arguments, those that are used */
    int checked;    /* the equations were compared with plain calls of the function */
    uint32_t trace; /* the outermost one in which the functions were last compared with these */
} dml_root_shape;

/* Push the shape for arguments 2, 3, ... of the call with the root at 1, which is traced when it
 * is new, or (anew = 1) when its functions are not what they were. */
dml_root_shape *dml_rootshape(lua_State *L, int anew);

/* The same, of what was compared with plain calls of the functions as they are, or is now. */
dml_root_shape *dml_rootchecked(lua_State *L, int anew);

/* Push the name of the root at arg. */
const char *dml_rootname(lua_State *L, int arg);

/* Do the equations, or S, at (s->y, s->x) say other than what was traced? plain: their plain
 * result. */
int dml_rootdiffers(const dml_root_shape *s, const double *plain);

/* S at (s->y, s->x). */
double dml_rootvalue(const dml_root_shape *s);

/* Entry k of f (algebra/implicit.h) of m arguments of any kind. */
dml_scalar dml_rootentry(lua_State *L, const dm_implicit *f, const dml_scalar *a, uint32_t m,
                         uint32_t k);

/* y[r] for hyper-dual x[n]: the root at their real parts, and two Newton iterations for the
 * others. */
void dml_roothyper(lua_State *L, const dm_implicit *f, dm_root_solver *solver, const dml_scalar *x,
                   dml_scalar *y);

/* out[m] = nodes of g with inputs x of any kind (function_replay.c). */
void dml_replay(lua_State *L, const dm_graph *g, const dm_node *nodes, uint32_t m,
                const dml_scalar *x, dml_scalar *out);

/* Push why an implicit function of g had no value lately, "; root 'f' ...", or "" where all had;
 * g may be NULL. */
const char *dml_roottrouble(lua_State *L, const dm_graph *g);

/* Raise what dml_roottrouble says of f. */
void dml_raiseroot(lua_State *L, const dm_implicit *f);

#endif
