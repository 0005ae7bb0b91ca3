#include "bind/trace/apart.h"

/* Those that it was entered in are the newest ones again. */
static void end_apart(dml_state *state, dml_scope *scope) {
    const dml_apart *a = (const dml_apart *)scope;
    if (state->given) state->given->values = a->values;
    if (state->frames) state->frames->sums = a->sums;
}

static void begin(const dml_state *state, dml_apart *a) {
    a->values = state->given ? state->given->values : NULL;
    a->sums = state->frames ? state->frames->sums : 0;
    if (state->given) state->given->values = NULL;
}

void dml_setapart(dml_state *state, dml_apart *a) {
    dml_enter(state, &a->scope, NULL, end_apart);
    begin(state, a);
}

void dml_endapart(dml_state *state, dml_apart *a) {
    dml_leave(state, &a->scope);
}

/* A value to be closed is left on the stack. */
void dml_pushapart(lua_State *L) {
    dml_state *state = dml_getstate(L);
    dml_leavedead(state);
    if (!state->given && !state->frames) return;
    begin(state, dml_pushscope(L, sizeof(dml_apart), 0, end_apart));
}

dml_given *dml_sumsgiven(dml_state *state) {
    dml_leavedead(state);
    dml_given *given = state->given;
    return given && given->values && given->within == state->frames ? given : NULL;
}
