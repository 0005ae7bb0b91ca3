#include "bind/run/run_events.h"
#include "bind/model/space_group.h"

#include <string.h>

struct dml_found {
    dml_found *next;
    uint32_t which;
    double t;
    double state[]; /* q[n], p[n] */
};

/* "up", "down", 1 or -1 in the table on top; both where it is left out */
static int read_direction(lua_State *L, const char *what) {
    int direction = 0;
    lua_getfield(L, -1, "direction");
    const char *text = lua_tostring(L, -1);
    if (text && (strcmp(text, "up") == 0 || strcmp(text, "1") == 0)) direction = 1;
    if (text && (strcmp(text, "down") == 0 || strcmp(text, "-1") == 0)) direction = -1;
    if (text && strcmp(text, "1.0") == 0) direction = 1;
    if (text && strcmp(text, "-1.0") == 0) direction = -1;
    if (!direction && !lua_isnil(L, -1))
        luaL_error(L, "%s: 'direction' must be \"up\" or \"down\" (got %s)", what,
                   luaL_tolstring(L, -1, NULL));
    lua_pop(L, 1);
    return direction;
}

/* the event on top, a function or { g =, direction =, stop = }; its function replaces it */
static dm_event read_event(lua_State *L, const char *what) {
    static const char *const known[] = {"g", "direction", "stop", NULL};
    dm_event event = {.direction = 0};
    if (lua_isfunction(L, -1)) return event;
    if (!lua_istable(L, -1))
        luaL_error(L,
                   "%s must be a function of (q, v, t, p) or { g = function, direction = \"up\" or "
                   "\"down\", stop = true } (got %s)",
                   what, luaL_typename(L, -1));
    dml_options(L, lua_gettop(L), known);
    event.direction = read_direction(L, what);
    event.stop = dml_flag(L, lua_gettop(L), "stop", 0);
    lua_getfield(L, -1, "g");
    lua_remove(L, -2);
    return event;
}

/* Called between steps, from inside of the run: it takes from the arena and never raises. */
static dm_status found(void *ud, uint32_t which, double t, const double *state) {
    dml_run_events *e = ud;
    const size_t size = 2 * (size_t)e->g.observer.model->n * sizeof(double);
    dml_found *f = dm_arena_take(e->arena, sizeof *f + size);
    if (!f) return DM_NO_MEMORY;
    *f = (dml_found){.which = which, .t = t};
    memcpy(f->state, state, size);
    *e->last = f;
    e->last = &f->next;
    return DM_OK;
}

/* Brackets, and the states between which an event is looked for. */
static void take_room(lua_State *L, dml_run_events *e, const dml_stepping *r) {
    const size_t size = dm_events_size(e->g.observer.count, r->solver->n);
    double *memory = lua_newuserdatauv(L, size * sizeof *memory, 0);
    memset(memory, 0, size * sizeof *memory);
    e->events = (dm_events){.observer = &e->g.observer, .list = e->list, .found = found, .ud = e};
    dm_events_lay_out(&e->events, memory, r->solver->n);
    e->arena = dml_pusharena(L);
    e->first = NULL;
    e->last = &e->first;
}

/* Names are in alphabetic order, as columns are; the list stands at e->names. */
void dml_events_read(lua_State *L, dml_run_events *e, const dml_stepping *r) {
    if (r->solver->alone)
        luaL_error(L, "a discrete Lagrangian has a fixed step: no state between two steps is "
                      "known, so no events");
    lua_getfield(L, 2, "events");
    const int table = lua_gettop(L);
    if (!lua_istable(L, table))
        luaL_error(L,
                   "field 'events' must be a table { name = function(q, v, t, p) ... end } (got "
                   "%s)",
                   luaL_typename(L, table));
    dml_observables_start(&e->g, r);
    dml_pushkeys(L, table, "events");
    e->names = lua_gettop(L);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, e->names);
    if (!count) luaL_error(L, "field 'events' is empty: leave it out, or name a function");
    for (lua_Integer i = 1; i <= count; i++) {
        luaL_checkstack(L, 12, NULL);
        lua_rawgeti(L, e->names, i);
        const char *what = lua_pushfstring(L, "events.%s", luaL_tolstring(L, -1, NULL));
        lua_rawgeti(L, e->names, i);
        lua_gettable(L, table);
        const dm_event event = read_event(L, what);
        dml_observables_add(L, &e->g, r, what, 0);
        e->list[i - 1] = event;
    }
    dml_observables_end(L, &e->g);
    take_room(L, e, r);
}

/* In the order of time, each with copies of q and p. */
void dml_pushevents(lua_State *L, const dml_run_events *e, int system) {
    const uint32_t n = e->g.observer.model->n, momenta = dml_checksystem(L, system)->momenta;
    lua_Integer i = 0;
    lua_newtable(L);
    for (const dml_found *f = e->first; f; f = f->next) {
        lua_createtable(L, 0, 4);
        lua_rawgeti(L, e->names, (lua_Integer)f->which + 1);
        lua_setfield(L, -2, "name");
        lua_pushnumber(L, f->t);
        lua_setfield(L, -2, "t");
        dml_pushposition(L, system, f->state);
        lua_setfield(L, -2, "q");
        memcpy(dml_pushvector(L, momenta), f->state + n, momenta * sizeof(double));
        lua_setfield(L, -2, "p");
        lua_rawseti(L, -2, ++i);
    }
}

void dml_events_missed(lua_State *L, const dml_run_events *e, dml_stepping *r) {
    const dm_observer *seen = &e->g.observer;
    if (!seen->missing) return;
    lua_rawgeti(L, e->names, seen->missing);
    r->unseen_at = seen->missed;
    r->unseen = lua_pushfstring(L,
                                "event '%s' is NaN there: is its function inside its domain (a "
                                "logarithm, root or quotient)? dm.where(c, a, b) gives it a value "
                                "elsewhere; failure.path has the rows before",
                                lua_tostring(L, -1));
}
