#include "run/inertia/inertia_look.h"
#include "run/inertia/inertia_values.h"

#include "linalg/lu.h"
#include "mech/constraints.h"
#include "mech/group.h"

#include <math.h>
#include <string.h>

int dm_inertia_may_change(const dm_model *m) {
    const unsigned never = DM_CONSTANT_MASS | DM_DEFINITE_MASS | DM_LINEAR_IN_V | DM_LOOPS;
    return m->mass.eval != NULL && !(m->structure & never);
}

/* Rows of the constraints: those of the kernels that are there. */
static uint32_t holonomic(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return c && c->holonomic && c->holonomic_kernel.eval ? c->holonomic : 0;
}

static uint32_t rolling(const dm_model *m) {
    const dm_constraints *c = m->constraints;
    return c && c->rolling && c->rolling_kernel.eval ? c->rolling : 0;
}

/* Entries of what the kernels give, the largest of them. */
static size_t outputs(const dm_model *m) {
    size_t most = m->n + (size_t)m->n * m->n;
    const size_t g = holonomic(m) ? m->constraints->holonomic_kernel.outputs : 0;
    const size_t phi = rolling(m) ? m->constraints->rolling_kernel.outputs : 0;
    if (g > most) most = g;
    return phi > most ? phi : most;
}

static size_t order(const dm_model *m) {
    return (size_t)m->n + holonomic(m) + rolling(m);
}

/* the mass and a copy of it, the rows of constraints, a vector, the bordered matrix, which has room
 * for the rows once more; the velocity in their place */
static size_t matrices(const dm_model *m) {
    const size_t n = m->n, all = order(m), rows = all - n;
    return n * (n + all + 1) + (rows ? all * all + (rows + 1) * n : n);
}

/* (q, v, t), outputs, matrices, the Legendre transform */
static size_t room(const dm_model *m) {
    return 2 * (size_t)m->n + 1 + outputs(m) + matrices(m) + dm_legendre_work(m);
}

/* Are blocks judged each by itself? Without constraints, and in coordinates. */
static int has_blocks(const dm_model *m) {
    return m->mass_blocks.count && order(m) == m->n && dm_momenta(m) == m->n;
}

static size_t blocks(const dm_model *m) {
    return has_blocks(m) ? m->mass_blocks.count : 1;
}

/* values and products on a line; all coordinates as one block */
static size_t of_blocks(const dm_model *m) {
    return 5 * blocks(m) + (size_t)m->n + 2;
}

/* [n]: scales, a region, a place; then the courses */
enum { TO_PLACE = 3, TO_COURSE = 4, OF_COURSE = sizeof(dm_inertia_course) / sizeof(double) };

static size_t of_member(const dm_model *m) {
    return TO_COURSE * (size_t)m->n + OF_COURSE * blocks(m);
}

static void find_member(dm_inertia *x, size_t member) {
    const size_t n = x->model->n;
    x->scale = x->members + member * of_member(x->model);
    x->region = x->scale + n, x->place = x->scale + TO_PLACE * n;
    x->course = (dm_inertia_course *)(void *)(x->scale + TO_COURSE * n);
}

size_t dm_inertia_work(const dm_model *m, size_t memory, size_t members) {
    return room(m) + 4 * dm_state_size(m->n) + 3 * memory + dm_inertia_boxes(m) + of_blocks(m) +
           members * of_member(m);
}

void dm_inertia_open(dm_inertia *x, const dm_model *m, size_t memory, double *work) {
    *x = (dm_inertia){.model = m, .room = work, .memory_size = memory};
    x->holonomic = holonomic(m), x->rolling = rolling(m);
    x->out = work + 2 * (size_t)m->n + 1, x->A = x->out + outputs(m);
    x->work = x->A + matrices(m);
    x->state = work + room(m);
    x->memory = x->state + dm_state_size(m->n);
    x->aside = x->memory + memory;
    x->end = x->aside + 2 * (dm_state_size(m->n) + memory);
    x->boxes = x->end + dm_state_size(m->n);
    x->first = x->boxes + dm_inertia_boxes(m);
    x->last = x->first + blocks(m), x->middle = x->last + blocks(m);
    x->values = (dm_inertia_value *)(void *)(x->middle + blocks(m));
    x->members = x->first + of_blocks(m);
    find_member(x, 0);
    memset(work, 0, dm_inertia_work(m, memory, 0) * sizeof *work);
    dm_kernel_prepare(&m->mass, x->out);
    x->blocks = has_blocks(m) ? m->mass_blocks
                              : dm_blocks_whole(m->n, (uint32_t *)(void *)(x->values + blocks(m)));
}

void dm_inertia_choose(dm_inertia *x, size_t member, const dm_inertia_seen *seen) {
    find_member(x, member);
    x->seen = *seen;
}

void dm_inertia_keep_places(dm_inertia *x, size_t first, const double *q, uint32_t lanes,
                            uint32_t which) {
    const size_t n = x->model->n, size = of_member(x->model);
    double *place = x->members + size * first + TO_PLACE * n;
    for (uint32_t l = 0; l < lanes; l++, place += size, q++)
        for (size_t i = 0; i < n && (which >> l & 1); i++) place[i] = q[i * lanes];
}

const double *dm_inertia_place_of(const dm_inertia *x, size_t member) {
    return x->members + of_member(x->model) * member + TO_PLACE * x->model->n;
}

dm_inertia_course *dm_inertia_courses_of(const dm_inertia *x, size_t member, size_t *apart) {
    *apart = of_member(x->model);
    return (dm_inertia_course *)(void *)(x->members + *apart * member +
                                         TO_COURSE * (size_t)x->model->n);
}

/* Where a coordinate has no mass of its own but beside the diagonal, or one of rounding alone, its
 * scale takes the largest entry of its row near to one: the units of the others say nothing of it.
 */
static void scale_rows(double *scale, const double *M, size_t pitch, uint32_t n) {
    static const double FAR = 1e6;
    enum { PASSES = 6 };
    for (uint32_t k = 0, end = n; k < PASSES * n && k < end; k++) { /* to n that stay */
        const uint32_t i = k % n;
        double largest = 0.0;
        for (uint32_t j = 0; j < n; j++) {
            const double size = fabs(scale[i] * M[i * pitch + j] * scale[j]);
            if (size > largest) largest = size;
        }
        const int alone = M[i * pitch + i] == 0.0 && largest > 0.0;
        if (!((alone || largest > FAR) && largest < INFINITY)) continue;
        scale[i] /= sqrt(largest);
        end = k + 1 + n;
    }
}

/* Of velocities, by what is found: the diagonal becomes ones; of a prolonged L that of M. */
static void find_scales(dm_inertia *x) {
    const uint32_t n = x->model->n, d = dm_momenta(x->model);
    double *M = x->A;
    memcpy(M, x->out + n, (size_t)n * n * sizeof *M);
    dm_inertia_narrow(M, d, n, d);
    const uint32_t half = dm_inertia_is_prolonged(M, d) ? d / 2 : d;
    x->tangent = d - half;
    const double *block = M + (d - half);
    for (uint32_t i = 0; i < n; i++) x->scale[i] = 1.0;
    for (uint32_t i = 0; i < half; i++) {
        const double own = fabs(block[i * d + i]);
        x->scale[i] = own > 0.0 && own < INFINITY ? 1.0 / sqrt(own) : 1.0;
    }
    scale_rows(x->scale, block, d, half);
    memcpy(x->scale + half, x->scale, (d - half) * sizeof *x->scale);
}

void dm_inertia_scale_again(dm_inertia *x, const double *state, double t) {
    const uint32_t n = x->model->n;
    double *before = x->A + (size_t)n * n;
    dm_inertia_seen *s = &x->seen;
    const double credit = s->credit;
    dm_inertia_there there = {0};
    if (!dm_inertia_find_state(x, state, t)) return;
    memcpy(before, x->scale, n * sizeof *before);
    find_scales(x);
    for (uint32_t i = 0; i < n; i++) x->scale[i] = fmin(x->scale[i], before[i]);
    if (dm_inertia_values(x, state, t, &there)) s->least = there.least;
    for (uint32_t b = 0; b < x->blocks.count && there.of; b++)
        x->course[b].least = there.of[b].least,
        x->course[b].all = x->course[b].ones = there.of[b].all;
    dm_inertia_expect(x);
    s->credit = credit;
}

/* Of M(q) v = p - shift, with what was found at the start: as in Newton's method, but not to
 * round-off. */
static const double *velocity_of_mass(const dm_inertia *x, const double *p) {
    const size_t n = x->model->n;
    const double *shift = x->out, *M = shift + n;
    double *v = x->A, *A = v + n;
    uint32_t *pivot = (uint32_t *)(void *)(A + n * n);
    for (size_t i = 0; i < n; i++) v[i] = p[i] - shift[i];
    memcpy(A, M, n * n * sizeof *A);
    if (dm_lu_factor(A, pivot, (uint32_t)n) != DM_OK) return NULL;
    dm_lu_solve(v, A, pivot, (uint32_t)n);
    return v;
}

/* Where a step of h leads if no force acted, as a state in x->end; 0: that is not known. Asked when
 * the mass was found at the state. */
static int go_ahead(const dm_inertia *x, const double *state, double t, double h) {
    const size_t n = x->model->n;
    const int alone = !dm_inertia_sees_velocity(x->model) && !x->model->constraints;
    const double *v = alone ? velocity_of_mass(x, state + n) : dm_inertia_velocity(x, state, t);
    for (size_t i = 0; i < n && v; i++) {
        x->end[i] = state[i] + h * v[i];
        x->end[n + i] = state[n + i];
    }
    return v != NULL;
}

/* What is next to zero in a block falls at the start as it would without forces, to x->values.
 * Infinite where that is not known, or where it depends on the velocity alone, which does not move.
 */
static void expect_falls(dm_inertia *x) {
    for (uint32_t b = 0; b < x->blocks.count; b++) {
        dm_inertia_course *c = x->course + b;
        const double falls = c->least - x->values[b].least;
        c->left = c->nearest = falls > 0.0 ? c->least / (1.5 * falls) : INFINITY;
        x->seen.left = fmin(x->seen.left, c->left);
    }
}

/* To what is there without forces after a step; does it change on the way? */
static int changes_ahead(dm_inertia *x, const double *state, double t) {
    dm_inertia_there there;
    dm_chord way = {.a = state, .b = x->end, .ta = t, .tb = t};
    if (!dm_inertia_values(x, x->end, t, &there)) return 0;
    expect_falls(x);
    way.known = !dm_inertia_sees_velocity(x->model);
    for (uint32_t b = 0; b < x->blocks.count; b++)
        x->first[b] = x->course[b].all, x->last[b] = there.of[b].all;
    return there.negative != x->seen.negative || dm_inertia_has_touched(x, &way);
}

/* Is d2L/dv2 singular there? Else the steps that are left; `ahead`: it is known where a step leads.
 */
static int is_singular(dm_inertia *x, const double *state, double t, int ahead) {
    x->seen.left = INFINITY;
    if (ahead && dm_inertia_starts_by_far(x, state, t)) {
        expect_falls(x);
        return 0;
    }
    if (dm_inertia_is_degenerate(x, state, t)) return 1;
    if (ahead && changes_ahead(x, state, t)) {
        for (uint32_t b = 0; b < x->blocks.count; b++)
            x->course[b].left = x->course[b].nearest = 0.0;
        x->seen.left = 0.0;
    }
    return 0;
}

/* Of a start, whose values are these. */
static void begin_courses(dm_inertia *x, const dm_inertia_value *of) {
    for (uint32_t b = 0; b < x->blocks.count; b++)
        x->course[b] = (dm_inertia_course){.least = of[b].least,
                                           .all = of[b].all,
                                           .ones = of[b].all,
                                           .nearest = INFINITY,
                                           .left = INFINITY};
}

dm_status dm_inertia_begin(dm_inertia *x, const double *state, double t, double h) {
    dm_inertia_seen *s = &x->seen;
    *s = (dm_inertia_seen){.due = 1, .known = dm_inertia_find_state(x, state, t), .h = h};
    memset(x->course, 0, x->blocks.count * sizeof *x->course);
    if (!s->known) return DM_OK;
    const int ahead = go_ahead(x, state, t, h);
    find_scales(x);
    const dm_inertia_there there = dm_inertia_count(x);
    s->negative = there.negative, s->least = there.least;
    begin_courses(x, there.of);
    s->degenerate = is_singular(x, state, t, ahead);
    if (s->degenerate) return DM_SINGULAR;
    s->at = t;
    dm_inertia_keep_place(x, state);
    dm_inertia_expect(x);
    dm_inertia_foresee(x, state, t, 0);
    return DM_OK;
}
