/* step_tied.c - steps that hold constraints: what is left of them, and where they cross. */
#include "integ/step_inside.h"
#include "linalg/solve/newton.h"

#include <math.h>
#include <string.h>

/* Room beside Newton's method, which is done then. */
size_t dm_step_scratch(const dm_model *m, size_t unknowns) {
    const dm_constraints *c = m->constraints;
    const size_t newton = dm_newton_work((uint32_t)unknowns);
    const size_t rows = c ? c->holonomic * (m->n + (size_t)2) : 0;
    const size_t crossing = c ? 4 * (size_t)m->n + 1 + rows + dm_crossing_work(c) : 0;
    return newton > crossing ? newton : crossing;
}

/* for dm_crossing_chart: of F about the start of the step, where other unknowns do not matter */
static void look(void *step, double *g, double *G, const double *y, double t) {
    dm_made_step *e = step;
    const size_t m = e->k->m, d = e->k->d, first = m - e->ties, k = e->row->holonomic;
    (void)t;
    memcpy(e->in + dm_step_numbers(e), y, d * sizeof *y);
    dm_kernel_eval(&e->k->tangent, e->in, e->out);
    memcpy(g, e->out + first, k * sizeof *g);
    for (size_t c = 0; c < k; c++) memcpy(G + c * d, e->out + m + (first + c) * m, d * sizeof *G);
}

/* In which masses are 1: the derivative of F is nearly the mass over h. 0: there are none. */
static int find_weights(const dm_made_step *e, const dm_constraints *c, double *weight) {
    const size_t m = e->k->m, d = e->k->d;
    const dm_crossing_mass mass = {e->out + m, e->k->d, m};
    for (size_t i = d; i < e->k->n; i++) weight[i] = 1.0;
    return dm_crossing_weights(weight, &mass, c->prolonged);
}

/* The square of the volume of the rows at the end. */
static dm_wide_product find_volume(dm_made_step *e, const dm_constraints *c, const double *weight,
                                   double t, double *room) {
    const size_t n = c->n;
    double *x = room, *rows = x + 2 * n + 1;
    memset(x, 0, (2 * n + 1) * sizeof *x);
    memcpy(x, e->reached, n * sizeof *x);
    x[2 * n] = t;
    dm_kernel_prepare(&c->holonomic_kernel, rows);
    dm_kernel_eval(&c->holonomic_kernel, x, rows);
    return dm_crossing_volume(c, rows, weight, rows + c->holonomic_kernel.outputs);
}

/* From the start of the step to e->x; q0 is where the chart begins. */
typedef struct {
    dm_crossing_chart chart;
    dm_crossing_way way;
    double *room;
} walk;

/* 0: there is nothing to look for */
static int begin(walk *w, dm_made_step *e, const dm_constraints *c, double t, double h) {
    double *weight = e->newton, *here = weight + e->k->n;
    if (!e->row->holonomic || !find_weights(e, c, weight)) return 0;
    memset(here, 0, e->k->n * sizeof *here);
    w->chart = (dm_crossing_chart){e->k->d, look, e};
    w->way = (dm_crossing_way){here, e->x, weight, t, t + h, &w->chart};
    w->room = here + e->k->n;
    return 1;
}

static dm_status end_at(dm_stepper *s, const dm_crossing_place *place) {
    s->report.trouble = (dm_trouble){.dependent = (int)place->row, .crosses = 1, .at = place->t};
    return DM_SINGULAR;
}

dm_status dm_step_crosses(dm_made_step *e, dm_stepper *s, double t, double h) {
    const dm_constraints *c = s->model->constraints;
    dm_crossing_place place;
    walk w;
    if (!begin(&w, e, c, t, h)) return DM_OK;
    const dm_wide_product volume = find_volume(e, c, w.way.weight, t + h, w.room);
    const int crosses = dm_crossing_in_step(c, e->watched, volume, &w.way, &place, w.room);
    return crosses ? end_at(s, &place) : DM_OK;
}

dm_status dm_step_stuck(dm_made_step *e, dm_stepper *s, double t, double h, dm_status status) {
    static const double NEAR = 1e-6; /* of the size of the terms: x nearly is a root */
    const dm_constraints *c = s->model->constraints;
    dm_crossing_place place;
    walk w;
    if (status != DM_NO_CONVERGENCE && status != DM_SINGULAR) return status;
    if (!(s->report.residual <= NEAR * e->first) || !begin(&w, e, c, t, h)) return status;
    const int crosses = dm_crossing_between(c, &w.way, &place, w.room);
    return crosses ? end_at(s, &place) : status;
}

void dm_step_report_ties(dm_made_step *e, dm_stepper *s) {
    const double *held = e->out + (e->k->m - e->ties);
    memcpy(e->in + dm_step_numbers(e), e->x, e->k->m * sizeof *e->x);
    dm_kernel_prepare(&e->k->equation, e->out);
    dm_kernel_eval(&e->k->equation, e->in, e->out);
    for (uint32_t c = 0; c < e->ties; c++) {
        double *worst = c < e->row->holonomic ? &s->report.constraint : &s->report.rolling;
        *worst = fmax(*worst, fabs(held[c]));
    }
    dm_kernel_prepare(&e->k->tangent, e->out);
}
