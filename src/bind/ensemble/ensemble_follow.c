/* ensemble_follow.c - `beside = {}` of an ensemble: members are compared with resolved flows while
 * they are made, and `ensemble:followed(i)` tells how far off they were. */
#include "bind/ensemble/bind_ensemble.h"
#include "bind/run/observables.h"

#include <math.h>
#include <string.h>

int dml_follow_options(lua_State *L) {
    if (lua_getfield(L, 2, "beside") == LUA_TNIL) return lua_pop(L, 1), 0;
    luaL_checktype(L, -1, LUA_TTABLE);
    lua_pushvalue(L, 2);
    lua_insert(L, -2);
    lua_replace(L, 2);
    return 1;
}

/* Push the names of the columns that are looked at, behind that of t. */
static uint32_t push_names(lua_State *L, double t0) {
    dml_stepping r = {.solver = lua_touserdata(L, 1)};
    const int top = lua_gettop(L);
    dml_observables *o = lua_newuserdatauv(L, sizeof *o, 0);
    dml_stepping_prepare(L, &r, t0);
    const int names = lua_gettop(L) + 1;
    dml_watch_read(L, o, &r);
    lua_pushvalue(L, names);
    lua_replace(L, top + 1);
    lua_settop(L, top + 1);
    return dm_observer_width(&o->observer);
}

/* what all members share: the table `beside`, names of its columns and which of them flows have */
typedef struct {
    int names, compared; /* stack indices of lists */
    uint32_t count;
} plan;

/* places in `compared` of the columns of `names`; 0: it is not compared */
static void find_compared(lua_State *L, const plan *p, uint32_t *out) {
    for (uint32_t k = 0; k < p->count; k++) {
        lua_rawgeti(L, p->names, (lua_Integer)k + 2);
        out[k] = 0;
        for (uint32_t i = 1; i <= lua_rawlen(L, p->compared); i++) {
            lua_rawgeti(L, p->compared, i);
            if (lua_rawequal(L, -1, -2)) out[k] = i;
            lua_pop(L, 1);
        }
        lua_pop(L, 1);
    }
}

/* a number of the table on top of the stack */
static double number_of(lua_State *L, const char *key, double otherwise) {
    lua_getfield(L, -1, key);
    const double x = dml_optnumber(L, -1, otherwise);
    lua_pop(L, 1);
    return x;
}

/* bounds of the compared columns, infinite for the others */
static void read_bounds(lua_State *L, dm_follow *f, double *bound, const uint32_t *place) {
    if (lua_getfield(L, -1, "bound") == LUA_TTABLE) {
        for (uint32_t k = 0; k < f->count; k++) {
            bound[k] = INFINITY;
            if (!place[k]) continue;
            lua_rawgeti(L, -1, place[k]);
            bound[k] = dml_checknumber(L, -1);
            lua_pop(L, 1);
        }
        f->bound = bound;
    }
    lua_pop(L, 1);
}

/* the flow of a member, the table on top of the stack: { e =, i =, horizon =, rows =, bound = } */
static void read_flow(lua_State *L, const plan *p, dm_follow *f, double *bound, uint32_t *column,
                      const uint32_t *place) {
    const int at = lua_gettop(L) + 1;
    lua_getfield(L, -1, "e");
    lua_getfield(L, -2, "i");
    f->flow = dml_ensemble_table(L, at);
    for (uint32_t k = 0; k < f->count; k++) {
        if (!place[k]) continue;
        lua_rawgeti(L, p->names, (lua_Integer)k + 2);
        column[k] = dml_ensemble_column(L, at, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    lua_pop(L, 2);
    f->until = number_of(L, "horizon", INFINITY);
    const double rows = number_of(L, "rows", 1.0);
    read_bounds(L, f, bound, place);
    const long steps = f->sparse; /* of the member, until its looks are known */
    f->dense = (double)steps > rows && rows >= 1.0 ? (steps - 1) / (long)rows + 1 : 1;
}

/* Steps of a member from row to row; all of them where no rows are kept. */
static long sparse_of(const dml_ensemble *e, long i, long steps) {
    const long every = e->pace ? e->pace[i].every : e->rows.every;
    return e->rows.room ? every : steps > 0 ? steps : 1;
}

/* all of them, whose arrays lie behind the list */
static void read_members(lua_State *L, const plan *p, const dml_part *part, dm_follow *list,
                         int flows) {
    const dml_ensemble *e = part->e;
    const size_t members = (size_t)e->members, count = p->count;
    double *numbers = (double *)(void *)(list + members), *bound = numbers + 4 * members * count;
    uint32_t *place = (uint32_t *)(void *)(bound + members * count), *column = place + count;
    find_compared(L, p, place);
    for (size_t i = 0; i < members; i++, numbers += 4 * count, bound += count, column += count) {
        dm_follow *f = list + i;
        const long steps = e->pace ? e->pace[i].steps : part->steps;
        *f = (dm_follow){.column = column, .count = p->count, .until = -INFINITY};
        f->largest = numbers;
        f->dense = f->sparse = steps;
        for (uint32_t k = 0; k < count; k++) column[k] = DM_NO_COLUMN;
        if (lua_rawgeti(L, flows, (lua_Integer)i + 1) == LUA_TTABLE)
            read_flow(L, p, f, bound, column, place);
        lua_pop(L, 1);
        f->sparse = sparse_of(e, (long)i, steps);
        if (!f->flow.rows) f->dense = f->sparse;
        dm_follow_begin(f);
    }
}

dm_follow *dml_read_follow(lua_State *L, const dml_part *part, double t0) {
    const int options = lua_gettop(L) + 1;
    plan p = {.names = options + 1, .compared = options + 2};
    if (!dml_follow_options(L)) return lua_pushnil(L), lua_pushnil(L), NULL;
    p.count = push_names(L, t0);
    if (lua_getfield(L, 2, "compared") != LUA_TTABLE || lua_getfield(L, 2, "flows") != LUA_TTABLE)
        luaL_error(L,
                   "field 'beside' must be a table { watch =, compared = names of those columns "
                   "that flows have, flows = { { e =, i =, horizon =, rows =, bound = }, ... } }");
    const size_t members = (size_t)part->e->members, count = p.count;
    const size_t each = sizeof(dm_follow) + count * (5 * sizeof(double) + sizeof(uint32_t));
    dm_follow *list = lua_newuserdatauv(L, members * each + count * sizeof(uint32_t) + 8, 0);
    read_members(L, &p, part, list, options + 3);
    lua_pushvalue(L, options);
    lua_replace(L, 2);
    lua_replace(L, options);
    lua_settop(L, options + 1);
    return list;
}

/* (ensemble, member) */
int dml_ensemble_followed(lua_State *L) {
    dml_ensemble_table(L, 1); /* raises where there is no such member, or no ensemble */
    const lua_Integer i = dml_checkinteger(L, 2);
    if (lua_getiuservalue(L, 1, DML_ENSEMBLE_FOLLOWED) != LUA_TUSERDATA)
        luaL_error(L, "this ensemble was not run beside flows: ask for it with beside = { ... }");
    const dm_follow *f = (const dm_follow *)lua_touserdata(L, -1) + (i - 1);
    lua_getiuservalue(L, 1, DML_ENSEMBLE_ASIDE);
    lua_createtable(L, 0, (int)f->count);
    for (uint32_t k = 0; k < f->count; k++) {
        lua_rawgeti(L, -2, (lua_Integer)k + 2);
        lua_pushnumber(L, f->largest[k]);
        lua_rawset(L, -3);
    }
    return 1;
}
