/* solver_fail.c - what a run ended with, as an error. */
#include "bind/core/bind_failure.h"
#include "bind/run/start_constraints.h"
#include "bind/run/stepping.h"
#include "graph/analyse.h"

#include <math.h>

/* a step that failed since d2L/dv2 was about to lose a value, not its constraints */
static int fades(const dml_stepping *r, dm_status status) {
    return !r->stepper.report.trouble.dependent && dml_failure_fades(r->fading, status);
}

/* is there a branch in the force? It may jump there, as dry friction does */
static int branches(const dml_model *m) {
    const dml_traced *force = &m->constraint[DML_FORCE];
    uint32_t counts[DM_OP_COUNT];
    if (!force->graph) return 0;
    dm_operation_counts(force->graph, force->out, force->outputs, counts);
    return counts[DM_OP_WHERE] > 0;
}

/* what is known of a step that failed from r->state, or NULL; *turned: and that is all there is to
 * say */
static const char *why_of(const dml_stepping *r, dm_status status, int *turned) {
    dm_stepper s = r->stepper;
    const dm_trouble *trouble = &s.report.trouble;
    const char *why = NULL;
    if (status == DM_NOT_WRITTEN) return r->unwritten;
    if (status == DM_NO_VALUE && r->unseen) return *turned = 1, r->unseen;
    if (r->degenerate) return r->degenerate;
    if (fades(r, status)) return dml_failure_fading;
    if (status == DM_TOO_SHORT)
        return isnan(r->control->place)
                   ? "no step is short enough there: a singularity of the motion, such as a "
                     "collision, or of the coordinates"
                   : "the forces may have something there so narrow that no step is short enough "
                     "to see it, or to rule it out";
    if (status == DM_NO_CONVERGENCE && trouble->outside)
        return "Newton's method was stopped at the edge of the domain of L (a root of a negative "
               "number, a logarithm, a speed limit): the step has no solution inside, or none that "
               "a shorter step leads to";
    if (s.engine && s.engine->why) why = s.engine->why(&s, r->state, status);
    *turned = trouble->turn > 0.0 && (status == DM_NO_CONVERGENCE || status == DM_NOT_FINITE);
    if (!*turned && status == DM_NO_CONVERGENCE && branches(r->model))
        return "the force has a branch (dm.where): where it jumps, a step may have no solution, "
               "however short; make the jump steep, as dm.tanh(v/eps) for a sign, or take an "
               "explicit rule such as rk4";
    return why;
}

void dml_note_degenerate(lua_State *L, dml_stepping *r, const dm_inertia *x) {
    enum { FEW = 8 };
    const dm_model *m = &r->model->model;
    const uint32_t n = dm_momenta(m);
    double *v = lua_newuserdatauv(L, m->n * sizeof *v, 0);
    luaL_Buffer b;
    const int found = dm_inertia_direction(x, r->state, r->t0, v) && n <= FEW;
    luaL_buffinit(L, &b);
    luaL_addstring(&b, "L is degenerate at the start: d2L/dv2 is zero to round-off");
    for (uint32_t i = 0; i < n && found; i++) {
        char text[40];
        snprintf(text, sizeof text, "%s%.3g",
                 i          ? ", "
                 : m->group ? " along xi = ("
                            : " along v = (",
                 fabs(v[i]) < 1e-6 ? 0.0 : v[i]);
        luaL_addstring(&b, text);
    }
    luaL_addstring(&b, found ? ")" : " in some direction");
    luaL_addstring(&b, " (system:mass(q, v) shows it), and the momentum does not determine the "
                       "velocity there");
    luaL_pushresult(&b);
    r->degenerate = lua_tostring(L, -1);
}

/* the time of the state after `done` steps; a rule with a time of its own has it in the state */
static double time_of(const dml_stepping *r, long done) {
    if (r->control) return r->control->t;
    if (r->solver->method->traits & DM_OWN_TIME) return r->state[4 * (size_t)r->model->model.n];
    return r->t0 + r->solver->h * (double)done;
}

/* What a step that failed says of itself. */
static dml_failure failure_of(const dml_stepping *r, dm_status status) {
    const dm_constraints *constraints = r->model->model.constraints;
    const int constraint = r->stepper.report.trouble.dependent,
              rolls = constraints && constraint > (int)constraints->holonomic;
    dml_failure f = {.constraint = rolls ? 0 : constraint,
                     .rolling = rolls ? constraint - (int)constraints->holonomic : 0,
                     .constrained =
                         constraints && constraints->holonomic + constraints->rolling > 0,
                     .crosses = r->stepper.report.trouble.crosses,
                     .at = r->stepper.report.trouble.at,
                     .status = status,
                     .fading = fades(r, status) ||
                               dml_failure_fades(r->stepper.report.trouble.fading, status)};
    f.root = why_of(r, status, &f.turned);
    return f;
}

int dml_stepping_reason(lua_State *L, const dml_stepping *r, dm_status status) {
    const dml_failure f = failure_of(r, status);
    if (f.turned) return lua_pushstring(L, f.root), 1;
    if (!f.root && !(status == DM_SINGULAR && (f.constraint || f.rolling))) return 0;
    lua_pushfstring(L, "%s: ", dm_status_text(status));
    dml_failure_reason(L, &f);
    lua_concat(L, 2);
    return 1;
}

/* constraints that lose rank, where only the straight line of the step says so */
static void look_ahead(dml_failure *f, const dml_stepping *r) {
    const int stuck =
        f->status == DM_NO_CONVERGENCE || f->status == DM_SINGULAR || f->status == DM_NOT_FINITE;
    if (!stuck || f->root || f->constraint || f->rolling) return;
    const int lost = (int)dml_lost_constraint(r, f->time);
    if (!lost) return;
    const int k = (int)r->model->model.constraints->holonomic;
    f->status = DM_SINGULAR;
    f->constraint = lost > k ? 0 : lost;
    f->rolling = lost > k ? lost - k : 0;
}

/* An error of the user's own function comes before what it did to the numbers. */
void dml_solver_fail(lua_State *L, const dml_stepping *r, dm_status status, long done, int path) {
    const dml_solver *s = r->solver;
    dml_rethrow(L, r->model);
    if (status == DM_OK) return;
    lua_getiuservalue(L, 1, DML_SOLVER_RULE);
    dml_failure f = failure_of(r, status);
    f.rule = lua_tostring(L, -1);
    const char *trouble = dml_modeltrouble(L, r->model);
    if (*trouble) f.root = trouble, f.turned = 0;
    f.step = done + (status != DM_STOPPED && status != DM_NOT_WRITTEN && status != DM_OUT_OF_TIME);
    f.time = time_of(r, done);
    if (status == DM_NO_VALUE && r->unseen) { /* a row: no step failed */
        f.step -= r->unseen_at <= f.time;
        f.time = r->unseen_at;
    }
    f.h = s->h;
    f.residual = r->stepper.report.residual;
    f.iterations = r->stepper.report.iterations;
    look_ahead(&f, r);
    dml_fail(L, &f, path);
}
