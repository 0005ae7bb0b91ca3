/* system_new.c - from a table of options to a system or a discrete Lagrangian. */
#include "bind/model/bind_space.h"
#include "bind/model/bind_system.h"
#include "bind/model/model_constraints.h"
#include "bind/model/space_group.h"
#include "bind/model/system_dual.h"

#include <math.h>
#include <string.h>

/* field `key` of the table at 1, or an error that shows what is expected */
static void require_field(lua_State *L, const char *key, int type, const char *expected) {
    if (lua_getfield(L, 1, key) != type)
        luaL_error(L, "field '%s' must be %s (got %s)", key, expected, luaL_typename(L, -1));
    lua_pop(L, 1);
}

static uint32_t check_Q(lua_State *L) {
    lua_getfield(L, 1, "Q");
    const dml_space *Q = luaL_testudata(L, -1, "dm.space");
    if (!Q)
        luaL_error(L, "field 'Q' must be a space, for instance dm.R(2) or dm.T(1) (got %s)",
                   luaL_typename(L, -1));
    if (!Q->chart)
        luaL_error(L,
                   "field 'Q': %s has no global coordinates; use dm.R(n) or dm.T(n), with a "
                   "constraint where it must be",
                   luaL_tolstring(L, -1, NULL));
    lua_pop(L, 1);
    return Q->n;
}

/* the name on top must not be that of the column of another one's momentum, "p_x" beside "x" */
static void check_momenta(lua_State *L, int names, uint32_t n) {
    const char *name = lua_tostring(L, -1);
    if (strncmp(name, "p_", 2) != 0) return;
    for (uint32_t k = 1; k <= n; k++, lua_pop(L, 1)) {
        const char *other = lua_geti(L, names, k) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        if (strcmp(other, name + 2) == 0)
            luaL_error(L,
                       "field 'coordinates': '%s' is the column of the momentum of '%s'; choose "
                       "another name",
                       name, other);
    }
}

/* a name of coordinate i (from 1) on top: one word that no other column has */
static void check_name(lua_State *L, int names, uint32_t i) {
    static const char *const taken[] = {"t", "time", "energy", NULL};
    size_t length;
    const char *name = lua_type(L, -1) == LUA_TSTRING ? lua_tolstring(L, -1, &length) : NULL;
    if (!name || !length || strlen(name) != length || strpbrk(name, "\n\r\",\t "))
        luaL_error(L, "field 'coordinates'[%d] must be a name of one word", (int)i);
    for (const char *const *other = taken; *other; other++)
        if (strcmp(name, *other) == 0)
            luaL_error(L,
                       "field 'coordinates'[%d]: '%s' is a column of every path; choose another "
                       "name",
                       (int)i, name);
    for (uint32_t k = 1; k < i; k++, lua_pop(L, 1)) {
        lua_geti(L, names, k);
        if (lua_rawequal(L, -1, -2))
            luaL_error(L, "field 'coordinates': '%s' stands there twice", name);
    }
}

static void check_coordinates(lua_State *L, uint32_t n) {
    if (dml_field(L, 1, "coordinates")) {
        const int names = lua_gettop(L);
        if (!lua_istable(L, names) || dml_length(L, names) != (long)n)
            luaL_error(L, "field 'coordinates' must be a table of %d names", (int)n);
        for (uint32_t i = 1; i <= n; i++, lua_pop(L, 1)) {
            lua_geti(L, names, i);
            check_name(L, names, i);
            check_momenta(L, names, n);
        }
    }
    lua_pop(L, 1);
}

static int wants_hyperdual(lua_State *L) {
    static const char *const modes[] = {"exact", "hyperdual", NULL};
    lua_getfield(L, 1, "derivatives");
    const char *mode = lua_isnil(L, -1) ? modes[0] : lua_tostring(L, -1);
    if (!mode || (strcmp(mode, modes[0]) != 0 && strcmp(mode, modes[1]) != 0))
        luaL_error(L, "field 'derivatives' must be \"exact\" (traced, the default) or "
                      "\"hyperdual\"");
    const int hyper = strcmp(mode, modes[1]) == 0;
    lua_pop(L, 1);
    return hyper;
}

const char *const dml_names[] = {"coordinates", "units", NULL};

/* copy the options at 1 and the names in them, so that later changes of these tables do not reach
 * the system */
static void keep_fields(lua_State *L, const char *const *known) {
    lua_newtable(L);
    const int kept = lua_gettop(L);
    for (; *known; known++) {
        lua_getfield(L, 1, *known);
        lua_setfield(L, kept, *known);
    }
    for (const char *const *key = dml_names; *key; key++) {
        if (dml_field(L, 1, *key)) dml_pushcopy(L, lua_gettop(L)), lua_setfield(L, kept, *key);
        lua_settop(L, kept);
    }
}

/* no number among the params at the top of the stack is NaN */
static void check_numbers(lua_State *L) {
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
        if (lua_type(L, -1) == LUA_TNUMBER && isnan(lua_tonumber(L, -1)))
            luaL_error(L, "field 'params': params.%s is NaN", luaL_tolstring(L, -2, NULL));
}

/* pushes it */
static int check_crossings(lua_State *L) {
    const int type = lua_getfield(L, 1, "crossings");
    if (type != LUA_TNIL && type != LUA_TBOOLEAN)
        luaL_error(L, "field 'crossings' must be true or false (got %s)", luaL_typename(L, -1));
    return lua_toboolean(L, -1);
}

/* what L can index */
static void check_params(lua_State *L) {
    const int type = lua_getfield(L, 1, "params");
    if (type != LUA_TNIL && type != LUA_TTABLE && type != LUA_TUSERDATA)
        luaL_error(L,
                   "field 'params' must be a table that L gets as its last argument, for instance "
                   "{ k = 2 } (got %s)",
                   luaL_typename(L, -1));
    if (type == LUA_TTABLE) check_numbers(L);
    lua_pop(L, 1);
}

/* Raise where argument `at` of the function in field `key`, which is the time (the step of an Ld),
 * has the name of a parameter: it would be taken for one without a word. */
static void check_argument(lua_State *L, const char *key, int at, const char *what) {
    const int top = lua_gettop(L);
    lua_getfield(L, 1, "params");
    if (lua_getfield(L, 1, key) == LUA_TFUNCTION && lua_istable(L, top + 1)) {
        const char *name = lua_getlocal(L, NULL, at); /* pops the function; of one in C NULL */
        lua_settop(L, top + 1);
        if (name && strcmp(name, what) != 0 && lua_getfield(L, top + 1, name) != LUA_TNIL)
            luaL_error(L,
                       "field '%s': its argument %d is %s, but is called like the parameter '%s': "
                       "params are a table behind it, function(%s, %s, params), and the parameter "
                       "is params.%s",
                       key, at, what, name,
                       at == 2                 ? "q"
                       : *what == 'h'          ? "q0, q1"
                       : strcmp(key, "H") == 0 ? "q, p"
                                               : "q, v",
                       what, name);
    }
    lua_settop(L, top);
}

/* Raise where the first two arguments of the function in field `key` have each other's names, as in
 * H = function(p, q): another motion without a word. */
static void check_order(lua_State *L, const char *key) {
    static const char *const order[][2] = {{"q", "v"}, {"q", "p"}, {"q0", "q1"}, {"g", "xi"}};
    const int top = lua_gettop(L), is = lua_getfield(L, 1, key) == LUA_TFUNCTION;
    const char *name[2] = {NULL, NULL};
    for (int i = 0; is && i < 2; i++) {
        lua_pushvalue(L, top + 1);
        name[i] = lua_getlocal(L, NULL, i + 1);
    }
    lua_settop(L, top);
    for (size_t i = 0; name[0] && name[1] && i < sizeof order / sizeof *order; i++)
        if (!strcmp(name[0], order[i][1]) && !strcmp(name[1], order[i][0]))
            luaL_error(L,
                       "field '%s': it is called with %s, %s in this order, and its arguments are "
                       "called %s, %s: write function(%s, %s)",
                       key, name[1], name[0], name[0], name[1], name[1], name[0]);
}

static void check_orders(lua_State *L) {
    static const char *const of[] = {"L",     "H",        "Ld",      "constraint", "rolling",
                                     "force", "reaction", "control", NULL};
    for (const char *const *key = of; *key; key++) check_order(L, *key);
}

static void check_arguments(lua_State *L) {
    static const char *const behind[] = {"L", "H", "rolling", "force", "reaction", "control", NULL};
    const int pair = dml_field(L, 1, "Ld");
    lua_pop(L, 1);
    if (pair) return check_argument(L, "Ld", 3, "h");
    for (const char *const *key = behind; *key; key++) check_argument(L, *key, 3, "t");
    check_argument(L, "constraint", 2, "t");
}

/* is `name` among the names of coordinates, or a parameter? */
static int is_named(lua_State *L, const char *name) {
    const int top = lua_gettop(L);
    int found = lua_getfield(L, 1, "params") == LUA_TTABLE && lua_getfield(L, -1, name) != LUA_TNIL;
    if (lua_getfield(L, 1, "coordinates") == LUA_TTABLE)
        for (lua_Integer i = luaL_len(L, -1); i > 0 && !found; i--, lua_pop(L, 1))
            found = lua_geti(L, -1, i) == LUA_TSTRING && !strcmp(lua_tostring(L, -1), name);
    lua_settop(L, top);
    return found;
}

/* Units are of what is drawn or printed. Any name may be that of a watched function, but for those
 * of dimensions, which mean something else than was done. */
static void check_unit_name(lua_State *L, const char *name) {
    static const char *const dimensions[] = {"length", "mass", "time", NULL};
    const char *const *d = dimensions;
    while (*d && strcmp(*d, name) != 0) d++;
    if (*d && !is_named(L, name))
        luaL_error(L,
                   "field 'units': '%s' is no column: units stand under q and p (all positions, "
                   "all "
                   "momenta), t, energy, names of coordinates (q1, ...), of params or of what runs "
                   "watch, for instance { q = \"m\", t = \"s\" }",
                   name);
}

/* name -> unit */
static void check_units(lua_State *L) {
    dml_field(L, 1, "units");
    const int type = lua_type(L, -1);
    if (type != LUA_TNIL && type != LUA_TTABLE)
        luaL_error(L,
                   "field 'units' must be a table name -> unit, for instance { q1 = \"m\", t = "
                   "\"s\" } (got %s)",
                   luaL_typename(L, -1));
    if (type == LUA_TTABLE)
        for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
            if (lua_type(L, -2) != LUA_TSTRING || lua_type(L, -1) != LUA_TSTRING)
                luaL_error(L,
                           "field 'units'[%s] must be a text under the name of what has it, for "
                           "instance { q1 = \"m\", t = \"s\" }",
                           luaL_tolstring(L, -2, NULL));
            check_unit_name(L, lua_tostring(L, -2));
        }
    lua_pop(L, 1);
}

/* push the place of a system on a group, whose options at 1 become those on R^N, and a copy of the
 * options as they were given in its field `given`; nil of another system */
static void push_place(lua_State *L) {
    dml_pushcopy(L, 1);
    dml_unfold_group(L);
    if (lua_istable(L, -1)) {
        lua_pushvalue(L, -2);
        lua_setfield(L, -2, "given");
    }
    lua_remove(L, -2);
}

/* fields that only a system on a group has, into the table on top */
static void keep_place(lua_State *L, int place) {
    lua_pushvalue(L, place);
    lua_setfield(L, -2, "place");
    dml_place_lagrangian(L, place);
}

/* how elements are written, which only a system on a group has */
static void refuse_place(lua_State *L) {
    static const char *const keys[] = {"columns", "trivialization", NULL};
    for (const char *const *key = keys; *key; key++, lua_pop(L, 1))
        if (lua_getfield(L, 1, *key) != LUA_TNIL)
            luaL_error(L, "field '%s' is for systems on groups, such as dm.SO(3)", *key);
}

void dml_newsystem(lua_State *L, const char *const *known, int pair) {
    lua_settop(L, 1);
    dml_unlock(L, 1);
    luaL_checktype(L, 1, LUA_TTABLE);
    dml_options(L, 1, known);
    dml_text(L, 1, "name");
    dml_plainparams(L);
    check_orders(L);
    dml_unfold_spheres(L);
    if (pair)
        lua_pushnil(L);
    else
        push_place(L);
    const int place = lua_gettop(L), placed = !lua_isnil(L, place);
    const uint32_t n = placed ? dml_place_size(L, 0) : check_Q(L);
    if (!placed && !pair) refuse_place(L);
    const int hamiltonian = !pair && dml_add_lagrangian(L, n);
    if (!hamiltonian)
        require_field(L, pair ? "Ld" : "L", LUA_TFUNCTION,
                      pair ? "a function of (q0, q1) or (q0, q1, h)"
                           : "a function of (q, v) or (q, v, t), or there is 'H', one of (q, p) or "
                             "(q, p, t)");
    check_coordinates(L, n);
    check_units(L);
    check_params(L);
    check_arguments(L);
    dml_check_functions(L, wants_hyperdual(L), pair);
    const double h = pair ? dml_positive(L, 1, "h", 0) : 0.0;
    const int field = lua_getfield(L, 1, "field") != LUA_TNIL;
    const int stand_in = lua_getfield(L, 1, "stand_in") != LUA_TNIL;
    const int prolonged = lua_getfield(L, 1, "prolonged") != LUA_TNIL;
    const int crossings = check_crossings(L);
    lua_pop(L, 4);
    lua_pushvalue(L, place);
    const uint32_t momenta = dml_place_dimension(L, n);
    lua_pop(L, 1);
    dml_system *s = lua_newuserdatauv(L, sizeof *s, 1);
    *s = (dml_system){.n = n,
                      .momenta = momenta,
                      .placed = placed,
                      .pair = pair,
                      .hamiltonian = hamiltonian,
                      .hyperdual = wants_hyperdual(L),
                      .stand_in = stand_in,
                      .crossings = crossings,
                      .prolonged = prolonged,
                      .field = field,
                      .h = h};
    keep_fields(L, known);
    if (placed) keep_place(L, place);
    lua_setiuservalue(L, -2, 1);
    luaL_setmetatable(L, pair ? DML_DISCRETE : DML_SYSTEM);
    dml_pushlast(
        /* what cannot be traced is refused where it is given; the first run takes it over */
        L, -1, NULL);
    lua_pop(L, 1);
}

int dml_system_new(lua_State *L) {
    static const char *const known[] = {"Q",         "L",           "H",
                                        "name",      "coordinates", "units",
                                        "params",    "derivatives", "constraint",
                                        "rolling",   "control",     "force",
                                        "reaction",  "columns",     "trivialization",
                                        "crossings", NULL};
    dml_newsystem(L, known, 0);
    return 1;
}

int dml_prolonged_new(lua_State *L) {
    static const char *const known[] =
        {"Q",     "L",        "H",       "params",         "constraint", "rolling",   "control",
         "force", "reaction", "columns", "trivialization", "crossings",  "prolonged", NULL};
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_pushboolean(L, 1);
    lua_setfield(L, 1, "prolonged");
    dml_newsystem(L, known, 0);
    return 1;
}

int dml_stand_in_new(lua_State *L) {
    static const char *const known[] = {"Q",          "L",        "name",
                                        "constraint", "rolling",  "reaction",
                                        "crossings",  "stand_in", NULL};
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_pushboolean(L, 1);
    lua_setfield(L, 1, "stand_in");
    dml_newsystem(L, known, 0);
    return 1;
}
