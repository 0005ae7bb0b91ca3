/* mesh_new.c - from simplices and points, or lengths, to a dm.mesh. Ids of a script are from 1. */
#include "bind/dec/bind_mesh.h"
#include "bind/value/array.h"
#include "dec/orientation.h"

#include <math.h>
#include <string.h>

/* the stack of dml_mesh_new: options, mesh, arena, what was read */
enum { OPTIONS = 1, MESH, ARENA };

/* vertices in no simplex for each that is named: before it is a mistake, and at most */
enum { SPARE = 64, MOST_SPARE = 4096 };

/* Memory of an arena, or an error: the arena is Lua's, so nothing is lost by it. */
static void *take(lua_State *L, dm_arena *arena, size_t size) {
    void *block = dm_arena_take(arena, size);
    if (!block) luaL_error(L, "dm.mesh: not enough memory");
    return block;
}

/* ---- simplices ---- */

/* The vertex on top of the stack, from 0; `simplex` is for the message. */
static uint32_t read_id(lua_State *L, lua_Integer simplex) {
    int whole = 0;
    const lua_Integer id = dml_tointegerx(L, -1, &whole);
    if (!whole || id < 1 || id >= UINT32_MAX)
        luaL_error(L, "dm.mesh: simplex %I: vertices are whole numbers from 1 (got %s)", simplex,
                   luaL_tolstring(L, -1, NULL));
    return (uint32_t)id - 1;
}

/* a vector of all ids, k + 1 a simplex */
static void read_flat(lua_State *L, dm_arena *arena, dm_simplices *out, const dml_array *a) {
    const double *id = dml_numbersof(a);
    const long degree = dml_count(L, OPTIONS, "degree", 0, -1);
    const uint32_t length = degree <= DM_DIMENSION ? (uint32_t)degree + 1 : 0;
    if (!id || !length || a->rows % length)
        luaL_error(L, "dm.mesh: field 'simplices' as a vector has degree + 1 numbers a simplex");
    uint32_t *start = take(L, arena, ((size_t)a->rows / length + 1) * sizeof *start);
    uint32_t *vertex = take(L, arena, ((size_t)a->rows + 1) * sizeof *vertex);
    for (uint32_t i = 0; i < a->rows; i++) {
        if (!(id[i] >= 1 && id[i] < UINT32_MAX && id[i] == floor(id[i])))
            luaL_error(L, "dm.mesh: simplex %d: vertices are whole numbers from 1",
                       (int)(i / length) + 1);
        vertex[i] = (uint32_t)id[i] - 1;
    }
    for (uint32_t i = 0; i <= a->rows / length; i++) start[i] = i * length;
    *out = (dm_simplices){0, a->rows / length, start, vertex};
}

/* a table of lists */
static void read_lists(lua_State *L, dm_arena *arena, dm_simplices *out) {
    const lua_Integer count = luaL_len(L, -1);
    size_t total = 0;
    for (lua_Integer i = 1; i <= count; i++) {
        if (lua_geti(L, -1, i) != LUA_TTABLE)
            luaL_error(L, "dm.mesh: simplex %I must be a list of vertices (got %s)", i,
                       luaL_typename(L, -1));
        const lua_Integer length = luaL_len(L, -1);
        if (length < 1 || length > DM_DIMENSION + 1)
            luaL_error(L, "dm.mesh: simplex %I has %I vertices; 1 to %d are possible", i, length,
                       DM_DIMENSION + 1);
        total += (size_t)length;
        lua_pop(L, 1);
    }
    if (total >= UINT32_MAX) luaL_error(L, "dm.mesh: too many simplices");
    uint32_t *start = take(L, arena, ((size_t)count + 1) * sizeof *start);
    uint32_t *vertex = take(L, arena, (total + 1) * sizeof *vertex), at = 0;
    for (lua_Integer i = 1; i <= count; i++) {
        start[i - 1] = at;
        lua_geti(L, -1, i);
        for (lua_Integer j = 1, length = luaL_len(L, -1); j <= length && at < total; j++) {
            lua_geti(L, -1, j);
            vertex[at++] = read_id(L, i);
            lua_pop(L, 1);
        }
        lua_pop(L, 1);
    }
    start[count] = at;
    *out = (dm_simplices){0, (uint32_t)count, start, vertex};
}

/* The field simplices in either of its forms; vertices beyond the largest one that is named are
 * asked for by `vertices`. */
static void read_simplices(lua_State *L, dm_arena *arena, dm_simplices *out) {
    if (!dml_field(L, OPTIONS, "simplices"))
        luaL_error(L, "dm.mesh: field 'simplices' is missing: a list of lists of vertices");
    const dml_array *a = dml_toarray(L, -1, 1);
    if (!a && !lua_istable(L, -1)) {
        dml_wrongfield(L, "simplices", "a list of lists of vertices");
        return;
    }
    if (a)
        read_flat(L, arena, out, a);
    else
        read_lists(L, arena, out);
    lua_pop(L, 1);
    uint32_t most = 0;
    for (uint32_t i = 0; i < out->start[out->simplices]; i++)
        most = out->vertex[i] >= most ? out->vertex[i] + 1 : most;
    /* no memory by a number that is only claimed: ids that nobody uses are asked for by name */
    if (most / SPARE > out->start[out->simplices] + SPARE && !dml_field(L, OPTIONS, "vertices"))
        luaL_error(L,
                   "dm.mesh: vertex %I is far above the %d vertices that are named; vertices = %I "
                   "says that there are so many",
                   (lua_Integer)most, (int)out->start[out->simplices], (lua_Integer)most);
    const long vertices = dml_count(L, OPTIONS, "vertices", 0, most);
    if (vertices == 0) luaL_error(L, "dm.mesh: there are no vertices");
    if (vertices / MOST_SPARE > (long)out->start[out->simplices] + MOST_SPARE)
        luaL_error(L, "dm.mesh: field 'vertices' is too large for the %d vertices that are named",
                   (int)out->start[out->simplices]);
    out->vertices = (uint32_t)vertices;
}

const char *dml_pushcell(lua_State *L, const uint32_t *vertex, uint32_t count) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    luaL_addchar(&b, '{');
    for (uint32_t i = 0; i < count; i++) {
        if (i) luaL_addstring(&b, ", ");
        lua_pushinteger(L, (lua_Integer)vertex[i] + 1);
        luaL_addvalue(&b);
    }
    luaL_addchar(&b, '}');
    luaL_pushresult(&b);
    return lua_tostring(L, -1);
}

const char *dml_pushface(lua_State *L, const dm_complex *K, uint32_t k, uint32_t cell) {
    uint32_t room[DM_DIMENSION + 1];
    return dml_pushcell(L, dm_complex_vertices(K, k, cell, room), k + 1);
}

/* The sentence of a fault, with the simplex as it was given. */
static void refuse(lua_State *L, const dm_simplices *given, const dm_complex_report *report) {
    static const char *const why[] =
        {"", "a vertex is repeated in simplex %d, %s",
         "simplex %d, %s, is a duplicate of simplex %d",
         "simplex %d, %s, has a vertex that there is not: there are %d"};
    const uint32_t i = report->simplex, from = given->start[i];
    const char *cell = dml_pushcell(L, given->vertex + from, given->start[i + 1] - from);
    const int last =
        report->fault == DM_COMPLEX_UNKNOWN ? (int)given->vertices : (int)report->other + 1;
    lua_pushfstring(L, why[report->fault], (int)i + 1, cell, last);
    luaL_error(L, "dm.mesh: %s", lua_tostring(L, -1));
}

/* ---- metric ---- */

/* of a matrix of numbers, all at once; 0: it is something else */
static int copy_points(lua_State *L, dm_arena *arena, dml_mesh *m, const dml_array *a) {
    const double *x = a ? dml_numbersof(a) : NULL;
    if (!x || a->columns == 0) return 0;
    m->ambient = a->columns;
    m->points = take(L, arena, (size_t)a->rows * a->columns * sizeof *x);
    memcpy(m->points, x, (size_t)a->rows * a->columns * sizeof *x);
    for (size_t i = 0; i < (size_t)a->rows * a->columns; i++)
        if (!isfinite(x[i]))
            luaL_error(L, "dm.mesh: point %d is not finite", (int)(i / a->columns) + 1);
    return 1;
}

/* points[count[0]][N] from a matrix or a list of lists */
static void read_points(lua_State *L, dm_arena *arena, dml_mesh *m) {
    if (!dml_field(L, OPTIONS, "points")) {
        lua_pop(L, 1);
        return;
    }
    const uint32_t count = m->K.count[0];
    const int points = lua_gettop(L);
    const dml_array *a = dml_toarray(L, points, 2);
    if (!a && lua_type(L, points) != LUA_TTABLE)
        dml_wrongfield(L, "points", "a list of points or a matrix of rows");
    const lua_Integer rows = a ? (lua_Integer)a->rows : luaL_len(L, points);
    if (rows != (lua_Integer)count)
        luaL_error(L, "dm.mesh: there are %d vertices, but %I points", (int)count, rows);
    const int copied = copy_points(L, arena, m, a);
    for (uint32_t i = 0; i < count && !copied; i++) {
        lua_geti(L, points, (lua_Integer)i + 1);
        if (i == 0) {
            const long N = dml_length(L, -1);
            if (N < 1) luaL_error(L, "dm.mesh: point 1 must be a list of numbers");
            m->ambient = (uint32_t)N;
            m->points = take(L, arena, (size_t)count * m->ambient * sizeof(double));
        }
        const char *name = lua_pushfstring(L, "dm.mesh: point %d", (int)i + 1);
        dml_vectorarg(L, -2, name, m->points + (size_t)i * m->ambient, m->ambient);
        lua_pop(L, 2);
    }
    lua_pop(L, 1);
}

/* The length of edge e, on top of the stack. */
static double length_of(lua_State *L, const dml_mesh *m, uint32_t e) {
    const int at = lua_gettop(L);
    const double length = lua_tonumber(L, at);
    if (lua_type(L, at) != LUA_TNUMBER || !(length > 0.0) || !isfinite(length))
        luaL_error(L, "dm.mesh: the length of edge %s must be a number > 0 (got %s)",
                   dml_pushface(L, &m->K, 1, e), luaL_tolstring(L, at, NULL));
    return length;
}

/* squares, from a number, a list in the order of the edges, or a function of i < j */
static void read_lengths(lua_State *L, const dml_mesh *m, double *length2) {
    const int given = lua_gettop(L), kind = lua_type(L, given);
    const uint32_t edges = m->K.count[1];
    if (kind != LUA_TNUMBER && kind != LUA_TFUNCTION && dml_length(L, given) != (long)edges)
        luaL_error(L,
                   "dm.mesh: field 'lengths' must be a number, a function (i, j) or a list of "
                   "as many as there are edges, %d",
                   (int)edges);
    for (uint32_t e = 0; e < edges; e++) {
        if (kind == LUA_TFUNCTION) {
            lua_pushvalue(L, given);
            lua_pushinteger(L, (lua_Integer)m->K.vertex[1][2 * (size_t)e] + 1);
            lua_pushinteger(L, (lua_Integer)m->K.vertex[1][2 * (size_t)e + 1] + 1);
            dml_callone(L, 2, "lengths");
        } else if (kind == LUA_TNUMBER) {
            lua_pushvalue(L, given);
        } else {
            lua_geti(L, given, (lua_Integer)e + 1);
        }
        const double length = length_of(L, m, e);
        length2[e] = length * length;
        lua_pop(L, 1);
    }
}

/* The field dual: where duals of simplices meet. */
static dm_centres read_centres(lua_State *L) {
    static const char *const names[] = {"circumcentric", "barycentric", NULL};
    if (!dml_field(L, OPTIONS, "dual")) {
        lua_pop(L, 1);
        return DM_CIRCUMCENTRES;
    }
    const char *name = lua_tostring(L, -1);
    if (!name || (strcmp(name, names[0]) != 0 && strcmp(name, names[1]) != 0))
        dml_wrongfield(L, "dual", "\"circumcentric\" or \"barycentric\"");
    const dm_centres centres = strcmp(name, names[1]) == 0 ? DM_BARYCENTRES : DM_CIRCUMCENTRES;
    lua_pop(L, 1);
    return centres;
}

/* Volumes are powers of lengths: an edge so long, or so short, that they are no numbers. */
static void check_range(lua_State *L, const dml_mesh *m, const double *length2) {
    static const double RANGE = 290.0; /* powers of ten */
    const double n = fmax(2.0, m->K.n);
    for (uint32_t e = 0; e < m->K.count[1]; e++)
        if (length2[e] != 0.0 || !m->points) { /* two equal points are told as such */
            if (fabs(log10(length2[e]) / 2.0) * n < RANGE) continue;
            luaL_error(L,
                       "dm.mesh: edge %s is too %s for volumes of degree %d, which leave the "
                       "range of numbers: take another unit of length",
                       dml_pushface(L, &m->K, 1, e), length2[e] > 1.0 ? "long" : "short", (int)n);
        }
}

/* Squares of lengths, then all volumes and duals. They are made from lengths alone, also where
 * there are points, so that both roads give the same numbers, but for slender triangles. */
static void measure(lua_State *L, dm_arena *arena, dml_mesh *m) {
    uint32_t k = 0, cell = 0;
    double *length2 = lua_newuserdatauv(L, ((size_t)m->K.count[1] + 1) * sizeof *length2, 0);
    const dm_centres centres = read_centres(L);
    const dm_points points = {m->points, m->ambient};
    const int given = dml_field(L, OPTIONS, "lengths");
    if (given && m->points) luaL_error(L, "dm.mesh: give 'points' or 'lengths', not both");
    if (!given && !m->points) return;
    if (given)
        read_lengths(L, m, length2);
    else
        dm_metric_lengths(length2, &m->K, &points);
    check_range(L, m, length2);
    const dm_status status = dm_metric_build(&m->metric, arena, &m->K, length2,
                                             given ? NULL : &points, centres, &k, &cell);
    if (status == DM_NO_MEMORY) luaL_error(L, "dm.mesh: not enough memory");
    if (status != DM_OK)
        luaL_error(L,
                   given ? "dm.mesh: no simplex of degree %d has the lengths of the edges of %s: "
                           "its Cayley-Menger determinant is not positive"
                         : "dm.mesh: the simplex of degree %d %s is degenerate: its points lie "
                           "in a smaller space",
                   (int)k, dml_pushface(L, &m->K, k, cell));
    m->measured = 1;
}

/* sign of the volume of a top cell in R^n, by elimination with pivots */
static int8_t sign_of(const dml_mesh *m, uint32_t cell) {
    const uint32_t n = m->K.n, *v = m->K.vertex[n] + (size_t)cell * (n + 1);
    double E[DM_DIMENSION][DM_DIMENSION];
    int8_t sign = 1;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            E[i][j] = m->points[(size_t)v[i + 1] * n + j] - m->points[(size_t)v[0] * n + j];
    for (uint32_t k = 0; k < n; k++) {
        uint32_t p = k;
        for (uint32_t i = k + 1; i < n; i++)
            if (fabs(E[i][k]) > fabs(E[p][k])) p = i;
        for (uint32_t j = 0; p != k && j < n; j++) {
            const double moved = E[k][j];
            E[k][j] = E[p][j], E[p][j] = moved;
        }
        if (p != k) sign = (int8_t)-sign;
        if (E[k][k] < 0.0) sign = (int8_t)-sign;
        for (uint32_t i = k + 1; i < n && E[k][k] != 0.0; i++)
            for (uint32_t j = n; j-- > k;) E[i][j] -= E[i][k] / E[k][k] * E[k][j];
    }
    return sign;
}

/* coherent signs; of a mesh in a space of its own dimension those of positive volume */
static void orient(lua_State *L, dm_arena *arena, dml_mesh *m) {
    int8_t *wish = NULL;
    if (m->points && m->ambient == m->K.n) {
        wish = lua_newuserdatauv(L, (size_t)m->K.count[m->K.n] + 1, 0);
        for (uint32_t c = 0; c < m->K.count[m->K.n]; c++) wish[c] = sign_of(m, c);
    }
    if (dm_complex_orient(&m->K, arena, wish) != DM_OK) luaL_error(L, "dm.mesh: not enough memory");
    if (wish && m->K.n > 0) m->folds = dm_complex_folds(&m->K, wish, &m->fold);
}

/* The mesh is pushed before anything is read: its arena belongs to Lua from the start, and an
 * error anywhere gives all memory back. */
int dml_mesh_new(lua_State *L) {
    static const char *const known[] = {"simplices", "degree", "vertices", "points",
                                        "lengths",   "dual",   NULL};
    dm_simplices given;
    dm_complex_report report;
    luaL_checktype(L, OPTIONS, LUA_TTABLE);
    lua_settop(L, OPTIONS);
    dml_options(L, OPTIONS, known);
    dml_mesh *m = lua_newuserdatauv(L, sizeof *m, 1);
    *m = (dml_mesh){.manifold = -1};
    dm_arena *arena = dml_pusharena(L), *reading = dml_pusharena(L);
    arena->exact = 1; /* a few arrays of known size: nothing is held in reserve */
    lua_pushvalue(L, ARENA);
    lua_setiuservalue(L, MESH, 1);
    read_simplices(L, reading, &given);
    const dm_status status = dm_complex_build(&m->K, arena, &given, &dml_stop, &report);
    if (status == DM_SINGULAR) refuse(L, &given, &report);
    if (status == DM_STOPPED) dml_checkstop(L);
    if (status != DM_OK) luaL_error(L, "dm.mesh: %s", dm_status_text(status));
    read_points(L, arena, m);
    orient(L, arena, m);
    dml_checkstop(L);
    measure(L, arena, m);
    if (arena->scratch) dm_arena_release(arena->scratch);
    m->bytes = arena->total;
    lua_settop(L, MESH);
    luaL_setmetatable(L, DML_MESH);
    return 1;
}
