/* ensemble_reasons.c - why members failed: what runs of their own would say. */
#include "bind/ensemble/bind_ensemble.h"

void dml_ensemblemessages(lua_State *L, int at) {
    at = lua_absindex(L, at);
    if (lua_getiuservalue(L, at, DML_ENSEMBLE_MESSAGES) == LUA_TTABLE) return;
    lua_newtable(L);
    lua_copy(L, -1, -2);
    lua_setiuservalue(L, at, DML_ENSEMBLE_MESSAGES);
}

int dml_ensemblereason(lua_State *L, int at, long i) {
    if (lua_getiuservalue(L, at, DML_ENSEMBLE_MESSAGES) == LUA_TTABLE) {
        lua_rawgeti(L, -1, i + 1);
        lua_remove(L, -2);
    }
    if (lua_type(L, -1) == LUA_TSTRING) return 1;
    lua_pop(L, 1);
    return 0;
}

/* is this the start of a member at which d2L/dv2 has no inverse? */
static int is_degenerate(const dml_stepping *r, const dm_member *m, dm_inertia *x, double h) {
    return x && m->status == DM_SINGULAR && m->steps == 0 &&
           dm_inertia_begin(x, r->state, r->t0, h) != DM_OK && x->seen.degenerate;
}

/* of member i, which failed */
static void note_reason(lua_State *L, const dml_part *p, dml_stepping *r, dm_inertia *x, long i) {
    const dml_ensemble *e = p->e;
    const dm_member *m = e->member + i;
    const uint32_t many = r->stepper.model->params;
    const int top = lua_gettop(L);
    if (many) r->stepper.params = p->values + (size_t)(i - p->first) * many;
    r->state = e->state + (size_t)i * dm_state_size(e->n);
    r->stepper.report.trouble = m->trouble ? e->trouble[i] : (dm_trouble){0};
    r->fading = m->fading;
    r->degenerate = NULL;
    if (is_degenerate(r, m, x, e->pace ? e->pace[i].h : e->h)) dml_note_degenerate(L, r, x);
    if (dml_stepping_reason(L, r, m->status)) {
        dml_ensemblemessages(L, p->at);
        lua_insert(L, -2);
        lua_rawseti(L, -2, i + 1);
    }
    lua_settop(L, top);
}

/* Engines that are keyed speak of the last step that they made, which is one of another member. */
void dml_note_reasons(lua_State *L, const dml_part *p, const dml_stepping *of, dm_inertia *x) {
    const dm_member *const all = p->e->member, *const end = all + p->first + p->count;
    dml_stepping r = *of;
    if (r.stepper.engine->keyed) r.stepper.engine = NULL;
    for (const dm_member *m = all + p->first; m < end; m++)
        if (m->status != DM_OK && m->status != DM_STOPPED) note_reason(L, p, &r, x, m - all);
}
