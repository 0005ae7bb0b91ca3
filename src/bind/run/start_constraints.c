/* start_constraints.c - is the start on the constraints, are they independent there, where is the
 * nearest start that is? */
#include "bind/run/start_constraints.h"
#include "bind/model/space_group.h"
#include "integ/registry.h"

#include "mech/constraints.h"

#include <math.h>
#include <string.h>

static const double ON = 1e-10; /* a start that far off, relatively, lies on the constraints */

/* ---- rules that do not know them ---- */

/* What a rule that lacks it cannot step, in words. */
static const char *name_of(unsigned lacking) {
    return lacking & DM_HOLONOMIC ? "constraints"
           : lacking & DM_ROLLING ? "rolling constraints"
                                  : "forces";
}

/* Names of rules that know all of `needs`. */
static void add_rules(luaL_Buffer *b, unsigned needs) {
    const char *separator = "";
    for (const dm_method *const *m = dm_methods; *m; m++) {
        if (needs & ~(*m)->traits) continue;
        luaL_addstring(b, separator);
        luaL_addstring(b, (*m)->signature);
        separator = ", ";
    }
    if (!*separator) luaL_addstring(b, "none");
}

/* Of a system that knows no time any will do where none is kept. */
void dml_stepping_checktime(lua_State *L, const dml_stepping *r) {
    const unsigned traits = r->solver->method->traits;
    if (r->untimed && r->model->model.structure & DM_AUTONOMOUS) return;
    if (traits & DM_BY_ENERGY || !(traits & DM_OWN_TIME)) dml_refuse_late(L, r->t0, r->solver->h);
}

/* Before any step: a rule must not drop what it does not know. */
void dml_refuseconstraints(lua_State *L, const dml_solver *s, const dml_model *m) {
    const unsigned needs = dm_method_needs(&m->model);
    const unsigned lacking = needs & ~s->method->traits;
    luaL_Buffer b;
    if (!lacking) return;
    luaL_buffinit(L, &b);
    lua_pushfstring(L, "rule '%s' cannot step this system: it knows no %s; rules that do: ",
                    s->nodes[0].name, name_of(lacking));
    luaL_addvalue(&b);
    add_rules(&b, needs);
    luaL_addstring(&b, " (where base is one of the others)");
    luaL_pushresult(&b);
    luaL_error(L, "%s", lua_tostring(L, -1));
}

/* does any rule for L linear in v know what the system has beside it? */
static int is_known_beside(unsigned needs) {
    for (const dm_method *const *m = dm_methods; *m; m++)
        if ((*m)->traits & DM_DEGENERATE && !(needs & ~(*m)->traits)) return 1;
    return 0;
}

void dml_refuselinear(lua_State *L, const dml_solver *s, const dml_model *m) {
    const unsigned needs = dm_method_needs(&m->model);
    if (!(m->model.structure & DM_LINEAR_IN_V) || s->method->traits & DM_FOR_PAIRS) return;
    if (!is_known_beside(needs))
        luaL_error(L,
                   "L is linear in v, so that its equations are of first order, and there are %s "
                   "beside it: no rule steps such a system",
                   name_of(needs));
    if (!(s->method->traits & DM_DEGENERATE))
        luaL_error(L,
                   "L is linear in v: its equations are of first order, no momentum determines a "
                   "velocity, and rule '%s' needs a regular Lagrangian; \"degenerate(2)\" is for "
                   "such an L",
                   s->nodes[0].name);
}

/* ---- the start ---- */

/* Kernels for defects and projections, whatever the rule itself needs. */
unsigned dml_start_wants(const dml_stepping *r) {
    if (!r->model->model.constraints) return 0;
    return DM_WANT_HOLONOMIC | DM_WANT_ROLLING | (r->solver->pair ? 0 : DM_WANT_MASS);
}

/* Inverse mass n x n, and scratch for the projections. */
size_t dml_start_work(const dm_model *m) {
    return m->constraints ? m->n * (size_t)m->n + dm_constraints_start_work(m->constraints) : 0;
}

/* "constraint 2" or "rolling constraint 1" for row i, from 1 */
static const char *push_name(lua_State *L, const dm_constraints *t, uint32_t i) {
    if (i <= t->holonomic) return lua_pushfstring(L, "constraint %d", (int)i);
    return lua_pushfstring(L, "rolling constraint %d", (int)(i - t->holonomic));
}

/* project = true among the options at 2. */
static int wants_projection(lua_State *L) {
    return dml_flag(L, 2, "project", 0);
}

/* Constraints that depend on each other at the start hold nothing there. */
static void check_rank(lua_State *L, const dm_constraints *t, const dm_constraints_defect *d,
                       const char *who) {
    if (!d->depends) return;
    const char *name = push_name(L, t, d->depends);
    if (!d->on)
        luaL_error(L,
                   "%sno start: the gradient of %s is zero at this q, so it holds nothing there "
                   "(is it the square of a constraint, or 1 - the cosine of an angle that is "
                   "zero?)",
                   who, name);
    luaL_error(L,
               "%sno start: the constraints are redundant at this q: %s depends on those before "
               "it, most of all on %s; leave it out%s, or begin elsewhere if they are so in this "
               "position only",
               who, name, push_name(L, t, d->on),
               d->depends <= t->holonomic && !t->group
                   ? " (system:independent{ q = } does so where it always follows)"
                   : "");
}

/* A computation at the start that failed, as an error of the start. */
static void check_status(lua_State *L, dm_status status, const char *who) {
    if (status == DM_OK) return;
    luaL_error(L,
               "%sno start: %s in the constraints at the given q; is it inside their domain, and "
               "is d2L/dv2 regular there?",
               who, dm_status_text(status));
}

/* |g(q, t)| beside the size of its terms. */
static void check_position(lua_State *L, dml_stepping *r, const char *who) {
    const dm_constraints *t = r->model->model.constraints;
    dm_constraints_defect d;
    check_status(L,
                 dm_constraints_position_defect(&d, t, r->x, r->metric,
                                                r->metric + t->n * (size_t)t->n),
                 who);
    check_rank(L, t, &d, who);
    if (!(d.move <= ON))
        luaL_error(L, "%sno start: it is off the constraints: %s: |g(q)| = %f%s", who,
                   push_name(L, t, d.row), d.distance,
                   r->solver->alone ? "" : "; project = true moves it to the nearest q on them");
}

/* dg/dq v + dg/dt and phi(q, v, t); loose: the velocity came out of a momentum. */
static void check_velocity(lua_State *L, dml_stepping *r, const char *who, int loose) {
    const dm_constraints *t = r->model->model.constraints;
    dm_constraints_defect d;
    check_status(L,
                 dm_constraints_velocity_defect(&d, t, r->x, r->metric,
                                                r->metric + t->n * (size_t)t->n),
                 who);
    check_rank(L, t, &d, who);
    if (loose || d.move <= ON) return;
    luaL_error(L,
               "%sno start: the velocity does not fit %s: %s = %f; project = true moves it to the "
               "nearest velocity that does",
               who, push_name(L, t, d.row), d.row <= t->holonomic ? "|G v + dg/dt|" : "|phi(q, v)|",
               d.distance);
}

/* onto the constraints, then the momentum of that velocity */
static void project(lua_State *L, dml_stepping *r, const char *who) {
    const dm_model *m = &r->model->model;
    double *work = r->metric + m->n * (size_t)m->n;
    dm_constraints_defect first;
    const dm_status ranked =
        dm_constraints_velocity_defect(&first, m->constraints, r->x, r->metric, work);
    dm_status status = dm_constraints_project_position(m->constraints, r->x, r->metric, work);
    if (status == DM_OK && !m->inverse_mass)
        status = dm_constraints_inverse_mass(r->metric, m, r->x, work);
    if (status == DM_OK)
        status = dm_constraints_project_velocity(m->constraints, r->x, r->metric, work);
    if (status == DM_OK)
        status = dm_legendre(m, r->state + m->n, r->x, r->x + m->n, r->t0, r->work);
    if (status != DM_OK && ranked == DM_OK) check_rank(L, m->constraints, &first, who);
    if (status != DM_OK)
        luaL_error(L,
                   "%sno start: project = true found no state on the constraints near this one "
                   "(%s): begin nearer to them",
                   who, dm_status_text(status));
    memcpy(r->state, r->x, m->n * sizeof *r->state);
}

/* of the mass; of a discrete Lagrangian, which has none, 1 */
static void take_metric(lua_State *L, dml_stepping *r, const char *who) {
    const dm_model *m = &r->model->model;
    const size_t n = m->n;
    if (r->solver->pair) {
        memset(r->metric, 0, n * n * sizeof *r->metric);
        for (size_t i = 0; i < n; i++) r->metric[i * (n + 1)] = 1.0;
        return;
    }
    check_status(L,
                 dm_constraints_inverse_mass(r->metric, m, r->x, r->metric + m->n * (size_t)m->n),
                 who);
}

/* there is no metric to do it in */
static void refuse_projection(lua_State *L, const dml_stepping *r, const char *who) {
    if (r->solver->alone && wants_projection(L))
        luaL_error(L,
                   "%sno start: a discrete Lagrangian has no mass, and 'project' moves a start in "
                   "its metric: begin on the constraint",
                   who);
}

void dml_check_on_constraints(lua_State *L, dml_stepping *r, const char *who) {
    if (!r->model->model.constraints) return;
    refuse_projection(L, r, who);
    take_metric(L, r, who);
    check_position(L, r, who);
}

void dml_check_rolling_pair(lua_State *L, const dml_stepping *r) {
    const dm_constraints *t = r->model->model.constraints;
    if (!t || !t->rolling) return;
    const size_t n = t->n, l = t->rolling;
    const size_t room = 2 * n + 1 + t->holonomic + l;
    double *x = lua_newuserdatauv(L, (room + t->rolling_kernel.outputs) * sizeof *x, 0);
    double *phi = x + room;
    const double *slope = phi + l + l * n; /* dphi/dq1 */
    memset(x, 0, room * sizeof *x);
    memcpy(x, r->x, 2 * n * sizeof *x);
    dm_kernel_prepare(&t->rolling_kernel, phi);
    dm_kernel_eval(&t->rolling_kernel, x, phi);
    for (size_t c = 0; c < l; c++) {
        double size = 0.0;
        for (size_t i = 0; i < n; i++)
            size += fabs(slope[c * n + i]) * (fabs(x[i]) + fabs(x[n + i]));
        if (!(fabs(phi[c]) <= ON * size))
            luaL_error(L, "no start: q0 and q1 do not fit rolling constraint %d: it is %f",
                       (int)c + 1, phi[c]);
    }
    lua_pop(L, 1);
}

/* p and v of the state belong to each other on return. */
dm_status dml_tangent_momentum(dml_stepping *r) {
    const dm_model *m = &r->model->model;
    double *v = r->x + m->n, *p = r->state + m->n;
    if (!m->constraints) return DM_OK;
    memcpy(r->x, r->state, m->n * sizeof *r->x);
    dm_status status = dm_legendre_inverse(m, v, r->x, p, r->t0, r->work);
    if (status == DM_OK)
        status = dm_constraints_project_velocity(m->constraints, r->x, r->metric,
                                                 r->metric + m->n * (size_t)m->n);
    return status == DM_OK ? dm_legendre(m, p, r->x, v, r->t0, r->work) : status;
}

/* Lifts and turns multiply momenta by each other: their squares must be numbers. */
static void check_size(lua_State *L, const dml_stepping *r, const char *who) {
    static const double LEAST = 1e-100, MOST = 1e100;
    const double *p = r->state + r->solver->n;
    double size = 0.0;
    for (uint32_t i = 0; i < r->solver->n; i++) size = fmax(size, fabs(p[i]));
    if (size == 0.0 || (size >= LEAST && size <= MOST) || !isfinite(size)) return;
    luaL_error(L,
               "%sno start: the momentum is %f, and on groups its squares would be lost: take "
               "other units of mass (L times a constant has the same motion)",
               who, size);
}

void dml_start_on_constraints(lua_State *L, dml_stepping *r, const char *who, int given_p) {
    const int moves = wants_projection(L);
    if (dml_placed(L, r->system)) check_size(L, r, who);
    if (!r->model->model.constraints) return;
    refuse_projection(L, r, who);
    /* rows are looked at where steps begin, at g1 = g0: a stand-in knows no velocity */
    if (r->solver->alone) memset(r->x + r->solver->n, 0, r->solver->n * sizeof *r->x);
    take_metric(L, r, who);
    if (moves) project(L, r, who);
    check_position(L, r, who);
    check_velocity(L, r, who, given_p && r->solver->method->traits & DM_LOOSE_MOMENTUM);
}

/* the constraint that loses rank at r->x; 0: none, or it is not known */
static uint32_t lost_there(const dml_stepping *r) {
    const dm_model *m = &r->model->model;
    double *work = r->metric + m->n * (size_t)m->n;
    dm_constraints_defect d;
    if (dm_constraints_inverse_mass(r->metric, m, r->x, work) != DM_OK) return 0;
    if (dm_constraints_velocity_defect(&d, m->constraints, r->x, r->metric, work) != DM_OK)
        return 0;
    return d.depends;
}

/* Of groups and discrete Lagrangians, whose states go no straight line, nothing is known. */
uint32_t dml_lost_constraint(const dml_stepping *r, double t) {
    const dm_model *m = &r->model->model;
    const dm_constraints *c = m->constraints;
    double *v = r->x + m->n;
    if (!c || c->holonomic + c->rolling == 0 || c->group || r->solver->pair) return 0;
    memcpy(r->x, r->state, m->n * sizeof *r->x);
    memset(v, 0, m->n * sizeof *v);
    r->x[2 * m->n] = t;
    if (dm_legendre_inverse(m, v, r->x, r->state + m->n, t, r->work) != DM_OK) return 0;
    const uint32_t here = lost_there(r);
    for (uint32_t i = 0; i < m->n; i++) r->x[i] += r->solver->h * v[i];
    r->x[2 * m->n] += r->solver->h;
    return here ? here : lost_there(r);
}
