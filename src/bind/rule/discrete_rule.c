#include "bind/rule/discrete_rule.h"
#include "integ/registry.h"

#include "bind/model/model_constraints.h"
#include "bind/rule/bind_rule.h"

#include <math.h>
#include <string.h>

static const char EXACT[] = "exact";
enum { EXACT_STAGES = 8, EXACT_PIECES = 64, EXACT_UNKNOWNS = 520, EXACT_FAILURES = 3 };

/* nodes of the rule in field `rule` of the table at `at`; nested ones point into nodes; the text
 * is left on the stack */
static const dm_method *read_rule(lua_State *L, int at, dm_rule *nodes) {
    const dml_rule *object;
    const char *wrong = NULL, *nearest = NULL;
    lua_getfield(L, at, "rule");
    object = dml_torule(L, -1);
    if (object) {
        nodes[0] = object->rule;
    } else if (lua_type(L, -1) == LUA_TSTRING) {
        wrong = dm_rule_read(nodes, lua_tostring(L, -1), &nearest);
    } else {
        luaL_error(L,
                   "field 'rule' must be the name of a stage rule, for instance \"galerkin(3, "
                   "lobatto(4))\", or a dm.rule (got %s)",
                   luaL_typename(L, -1));
    }
    const char *text = luaL_tolstring(L, -1, NULL);
    const dm_method *method = wrong ? NULL : nodes[0].method;
    if (wrong) luaL_error(L, "field 'rule': '%s': %s", text, wrong);
    if (!method && nearest) luaL_error(L, "unknown rule '%s'; did you mean '%s'?", text, nearest);
    if (!method) luaL_error(L, "unknown rule '%s'; ?rules lists them", text);
    wrong = dm_rule_check(nodes);
    if (wrong)
        luaL_error(L, "field 'rule': '%s': %s; it is written %s", text, wrong, method->signature);
    return method;
}

/* The flow itself is no rule of the list: its Ld is found by gauss(8) on as many pieces as
 * round-off needs. Leaves the stack as it is. */
static int is_exact(lua_State *L, int at) {
    lua_getfield(L, at, "rule");
    const int exact = lua_type(L, -1) == LUA_TSTRING && strcmp(lua_tostring(L, -1), EXACT) == 0;
    lua_pop(L, 1);
    return exact;
}

/* Nodes and quadrature of the rule in the table at `at`; a rule without stages has no discrete
 * Lagrangian. */
static void read_basis(lua_State *L, int at, dm_galerkin *g) {
    dm_rule nodes[DM_RULE_NODES];
    dm_quadrature q;
    if (is_exact(L, at)) {
        dm_quadrature_gauss(&q, EXACT_STAGES);
        dm_galerkin_collocation(g, &q);
        return;
    }
    const dm_method *method = read_rule(L, at, nodes);
    *g = (dm_galerkin){.s = 0};
    if (method->basis) method->basis(g, nodes);
    if (!g->s)
        luaL_error(L,
                   "%s has no discrete Lagrangian of stages; the rules that have one: midpoint, "
                   "trapezoidal, verlet, symplectic-euler, gauss(s), lobatto(s), galerkin(s, "
                   "quadrature(r)), sprk(pair, s) and what dm.galerkin and dm.sprk make",
                   lua_tostring(L, -1));
    lua_pop(L, 2);
}

/* rule = "galerkin", degree = 3, quadrature = "lobatto(4)" at 2 become rule = "galerkin(3,
 * lobatto(4))" in a new table there */
static void join_arguments(lua_State *L) {
    static const char *const kept[] = {"h", "name", NULL};
    const int degree = lua_getfield(L, 2, "degree"), quadrature = lua_getfield(L, 2, "quadrature");
    if (degree == LUA_TNIL && quadrature == LUA_TNIL) {
        lua_pop(L, 2);
        return;
    }
    lua_getfield(L, 2, "rule");
    if (lua_type(L, -1) != LUA_TSTRING)
        luaL_error(L, "fields 'degree' and 'quadrature' go with rule = \"galerkin\"");
    if (quadrature != LUA_TSTRING)
        luaL_error(L,
                   "field 'quadrature' must be text, as in rule = \"galerkin\", degree = 3, "
                   "quadrature = \"lobatto(4)\" (got %s)",
                   luaL_typename(L, -2));
    const long s = dml_count(L, 2, "degree", 1, 0);
    lua_newtable(L);
    lua_pushfstring(L, "%s(%I, %s)", lua_tostring(L, -2), (LUAI_UACINT)s, lua_tostring(L, -3));
    lua_setfield(L, -2, "rule");
    for (const char *const *key = kept; *key; key++)
        lua_getfield(L, 2, *key), lua_setfield(L, -2, *key);
    lua_replace(L, 2);
    lua_settop(L, 2);
}

/* It keeps the system and the rule, and traces L when it is asked for something. */
void dml_pushruled(lua_State *L) {
    static const char *const known[] = {"rule", "h", "name", "degree", "quadrature", NULL};
    static const char *const copied[] = {"Q", "name", "coordinates", "units", "params", NULL};
    dm_galerkin g;
    dml_options(L, 2, known);
    join_arguments(L);
    read_basis(L, 2, &g);
    const dml_system *system = luaL_checkudata(L, 1, DML_SYSTEM);
    const double h = dml_positive(L, 2, "h", 0);
    if (system->placed)
        luaL_error(L, "discrete Lagrangians are made of systems on free coordinates; one on a "
                      "group is stepped by lie(s)");
    dml_system *s = lua_newuserdatauv(L, sizeof *s, 1);
    *s = (dml_system){.n = system->n, .momenta = system->n, .pair = 1, .ruled = 1, .h = h};
    lua_newtable(L);
    for (const char *const *key = copied; *key; key++)
        dml_systemfield(L, 1, *key), lua_setfield(L, -2, *key);
    lua_pushvalue(L, 1);
    lua_setfield(L, -2, "system");
    lua_getfield(L, 2, "rule");
    lua_setfield(L, -2, "rule");
    if (lua_getfield(L, 2, "name") != LUA_TNIL)
        lua_setfield(L, -2, "name");
    else
        lua_pop(L, 1);
    lua_setiuservalue(L, -2, 1);
    luaL_setmetatable(L, DML_DISCRETE);
}

/* Why the curve between q0 and q1 was not found, in words. */
static void check_status(lua_State *L, dml_model *m, dm_status status, const dml_system *s) {
    dml_rethrow(L, m);
    if (status == DM_SINGULAR)
        luaL_error(L,
                   "the stage equations between q0 and q1 are singular: is L regular (d2L/dv2 "
                   "invertible) there, and h = %f below a conjugate time?",
                   s->h);
    if (status != DM_OK)
        luaL_error(L,
                   "no curve of this rule was found from q0 to q1 in the time h = %f (%s); are "
                   "they one step apart, and inside the domain of L?",
                   s->h, dm_status_text(status));
}

/* The problem with so many pieces, in a userdata that stays on the stack. */
static dm_status solve_pieces(lua_State *L, dm_discrete *out, dm_discrete_problem *problem,
                              uint32_t pieces) {
    const size_t size = dm_discrete_work(problem->basis, problem->model->n, pieces);
    double *work = lua_newuserdatauv(L, size * sizeof *work, 0);
    memset(work, 0, size * sizeof *work);
    problem->pieces = pieces;
    return dm_discrete_solve(out, problem, work);
}

/* The largest |a_i - b_i| over `size`, which grows to what the entries are. */
static double apart(const double *a, const double *b, uint32_t n, double size) {
    double worst = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        worst = fmax(worst, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return worst / size;
}

/* What two numbers of pieces differ by, over the action, whose terms are p . q, and the momenta. */
static double difference(const dm_discrete *a, const dm_discrete *b, const dm_discrete_problem *p) {
    const uint32_t n = p->model->n;
    double size = fabs(b->value), momentum = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        momentum = fmax(momentum, fmax(fabs(b->p0[i]), fabs(b->p1[i])));
        size += fabs(b->p0[i] * p->q0[i]) + fabs(b->p1[i] * p->q1[i]);
    }
    const double worst = fmax(apart(a->p0, b->p0, n, momentum), apart(a->p1, b->p1, n, momentum));
    const double off = fabs(a->value - b->value);
    return fmax(worst, off > 0.0 ? off / size : 0.0);
}

/* Each doubling takes off four digits: so little that the finer one is exact to round-off; or what
 * no longer shrinks, near conjugate points. */
static int is_settled(double difference, double before) {
    static const double LAST = 1e-10, STAYS = 1e-6;
    return difference <= LAST || (difference <= STAYS && difference >= 0.25 * before);
}

/* dp0/dq1 goes to infinity where q0 and q1 are conjugate */
static void check_conjugate(lua_State *L, const dm_discrete *d, const dm_discrete_problem *p) {
    static const double MOST = 1e9;
    const uint32_t n = p->model->n;
    double largest = 0.0;
    for (size_t k = 0; k < (size_t)n * n; k++) largest = fmax(largest, fabs(d->two_form[k]));
    if (largest * p->h <= MOST * d->mass) return;
    luaL_error(L,
               "q0 and q1 are conjugate for h = %f: a whole family of motions leads from one to "
               "the "
               "other, or none; take another h",
               p->h);
}

/* As many pieces as it takes until twice as many tell no other action and no other momenta. */
static void solve_exact(lua_State *L, dm_discrete *out, dm_discrete_problem *problem, dml_model *m,
                        const dml_system *s) {
    dm_discrete last = {0};
    double before = INFINITY;
    int known = 0, failed = 0;
    dm_status status = DM_OK;
    for (uint32_t pieces = 1; pieces <= EXACT_PIECES && failed < EXACT_FAILURES; pieces *= 2) {
        if (pieces > 2 && (EXACT_STAGES * pieces + 1) * s->n > EXACT_UNKNOWNS) break;
        dml_checkstop(L);
        status = solve_pieces(L, out, problem, pieces);
        failed = status == DM_OK ? 0 : failed + 1;
        if (status == DM_OK) check_conjugate(L, out, problem);
        const double now = status == DM_OK && known ? difference(&last, out, problem) : INFINITY;
        if (is_settled(now, before)) return;
        known = status == DM_OK, before = now;
        last = *out;
    }
    check_status(L, m, status, s);
    luaL_error(L,
               "the motion from q0 to q1 is not resolved by gauss(8) on as many pieces as fit: h = "
               "%f is too long, or it passes a singularity",
               s->h);
}

/* Arguments at 2, 3, 4 of the caller: q0, q1, t. What *out points to stays on the stack. */
void dml_solveruled(lua_State *L, dm_discrete *out) {
    const dml_system *s = luaL_checkudata(L, 1, DML_DISCRETE);
    const uint32_t n = s->n;
    const double t = dml_optnumber(L, 4, 0.0);
    dm_galerkin g;
    lua_getiuservalue(L, 1, 1);
    read_basis(L, lua_gettop(L), &g);
    lua_getfield(L, -1, "system");
    dml_model *m = dml_pushlast(L, lua_gettop(L), NULL);
    if (m->hamiltonian)
        luaL_error(L, "a discrete Lagrangian needs an L, and this H has none with a formula");
    dml_want(L, m, DM_WANT_STAGE | DM_WANT_VALUE | DM_WANT_FORCE_CURVE, NULL);
    double *q0 = lua_newuserdatauv(L, 2 * (size_t)n * sizeof *q0, 0);
    dml_vectorarg(L, 2, "q0", q0, n);
    dml_vectorarg(L, 3, "q1", q0 + n, n);
    dm_discrete_problem problem =
        {.model = &m->model, .basis = &g, .q0 = q0, .q1 = q0 + n, .h = s->h, .t = t};
    lua_getiuservalue(L, 1, 1);
    const int exact = is_exact(L, lua_gettop(L));
    if (exact)
        solve_exact(L, out, &problem, m, s);
    else
        check_status(L, m, solve_pieces(L, out, &problem, 1), s);
}

/* t[key] = the high parts of rows x columns weights: a matrix, or of one row a vector */
static void set_weights(lua_State *L, const char *key, const dm_weight *w, uint32_t rows,
                        uint32_t columns) {
    double *out = rows ? dml_pushmatrix(L, rows, columns) : dml_pushvector(L, columns);
    for (size_t i = 0; i < (rows ? rows : 1) * (size_t)columns; i++)
        out[i] = dm_weight_double(w[i]);
    lua_setfield(L, -2, key);
}

void dml_needstages(lua_State *L, const dml_system *s) {
    if (!s->ruled)
        luaL_error(L, "a formula Ld(q0, q1) has no stages: this is for a discrete Lagrangian of a "
                      "system and a rule of stages; gauss(1) is midpoint and galerkin(1, "
                      "lobatto(2)) trapezoidal written so");
}

int dml_discrete_coefficients(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 1, DML_DISCRETE);
    dm_galerkin g;
    dm_stage_table t;
    dml_needstages(L, s);
    lua_getiuservalue(L, 1, 1);
    if (is_exact(L, lua_gettop(L)))
        luaL_error(L, "the exact discrete Lagrangian is that of the flow: it has no coefficients");
    read_basis(L, lua_gettop(L), &g);
    const size_t size = dm_stage_table_size((size_t)g.s, (size_t)g.q.r);
    dm_stage_table_fill(&t, &g, lua_newuserdatauv(L, size * sizeof(double), 0));
    lua_createtable(L, 0, 5);
    dml_setresult(L);
    set_weights(L, "a", t.a, t.r, t.s);
    set_weights(L, "d", t.d, t.r, t.s);
    set_weights(L, "b", t.b, 0, t.r);
    set_weights(L, "c", t.c, 0, t.r);
    set_weights(L, "beta", t.beta, 0, t.s);
    return 1;
}

/* A solver of such an Ld is the solver of its system with its rule: the steps are the same. */
void dml_unfoldruled(lua_State *L) {
    const dml_system *s = luaL_checkudata(L, 2, DML_DISCRETE);
    lua_newtable(L);
    for (lua_pushnil(L); lua_next(L, 1);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
    const int given = lua_getfield(L, -1, "rule") != LUA_TNIL;
    const dm_method *method = given ? dm_method_find(luaL_tolstring(L, -1, NULL), NULL) : NULL;
    if (given && !(method && method->traits & DM_FOR_PAIRS))
        luaL_error(L, "field 'rule': this discrete Lagrangian has its rule: leave it out here");
    lua_settop(L, 3);
    if (dml_positive(L, 3, "h", s->h) != s->h)
        luaL_error(L, "field 'h': the discrete Lagrangian was made with h = %f: leave it out here",
                   s->h);
    dml_systemfield(L, 2, "rule");
    lua_setfield(L, 3, "rule");
    if (is_exact(L, 3))
        luaL_error(L,
                   "the exact discrete Lagrangian is there to compare with: step its system with "
                   "a rule, gauss(8) for instance");
    lua_pushnumber(L, s->h);
    lua_setfield(L, 3, "h");
    lua_replace(L, 1);
    dml_systemfield(L, 2, "system");
    lua_replace(L, 2);
}
