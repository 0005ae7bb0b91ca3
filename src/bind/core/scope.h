/* scope.h - what is under way in a Lua state, newest last: traces, comparisons, calls that stand
 * apart. A coroutine that dies of an error closes nothing, so what it entered is over as soon as it
 * is dead. It cannot yield inside: a call from C is between. */
#ifndef DML_SCOPE_H
#define DML_SCOPE_H

#include "bind/core/state.h"

/* Enter it: it is the newest one. thread: that which enters it; NULL: it ends without fail. */
void dml_enter(dml_state *state, dml_scope *scope, lua_State *thread,
               void (*leave)(dml_state *, dml_scope *));

/* Leave it, once; what is newer is over. */
void dml_leave(dml_state *state, dml_scope *scope);

/* Push a userdata, zeroed, that begins with a scope; it is entered, and left when the stack is cut
 * back behind it or an error passes. User value 1 is taken. */
void *dml_pushscope(lua_State *L, size_t size, int uservalues,
                    void (*leave)(dml_state *, dml_scope *));

/* Leave what dead coroutines have entered: before frames, or what is given, are looked at. */
void dml_leavedead(dml_state *state);

#endif
