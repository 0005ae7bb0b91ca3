#include "run/inertia/inertia_look.h"

#include "linalg/lu.h"
#include "linalg/signature.h"
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

/* [n]: scales, a region, a place */
enum { OF_MEMBER = 4, TO_PLACE = 3 };

static void find_member(dm_inertia *x, size_t member) {
    const size_t n = x->model->n;
    x->scale = x->members + member * OF_MEMBER * n;
    x->region = x->scale + n, x->place = x->scale + TO_PLACE * n;
}

size_t dm_inertia_work(const dm_model *m, size_t memory, size_t members) {
    return room(m) + 4 * dm_state_size(m->n) + 3 * memory + dm_inertia_boxes(m) +
           members * OF_MEMBER * (size_t)m->n;
}

void dm_inertia_open(dm_inertia *x, const dm_model *m, size_t memory, double *work) {
    *x = (dm_inertia){.model = m, .room = work, .memory_size = memory};
    x->state = work + room(m);
    x->memory = x->state + dm_state_size(m->n);
    x->aside = x->memory + memory;
    x->end = x->aside + 2 * (dm_state_size(m->n) + memory);
    x->boxes = x->end + dm_state_size(m->n);
    x->members = x->boxes + dm_inertia_boxes(m);
    find_member(x, 0);
    memset(work, 0, dm_inertia_work(m, memory, 0) * sizeof *work);
}

void dm_inertia_choose(dm_inertia *x, size_t member, const dm_inertia_seen *seen) {
    find_member(x, member);
    x->seen = *seen;
}

void dm_inertia_keep_places(dm_inertia *x, size_t first, const double *q, uint32_t lanes,
                            uint32_t which) {
    const size_t n = x->model->n;
    double *place = x->members + (OF_MEMBER * first + TO_PLACE) * n;
    for (uint32_t l = 0; l < lanes; l++, place += OF_MEMBER * n, q++)
        for (size_t i = 0; i < n && (which >> l & 1); i++) place[i] = q[i * lanes];
}

const double *dm_inertia_place_of(const dm_inertia *x, size_t member) {
    return x->members + (OF_MEMBER * member + TO_PLACE) * x->model->n;
}

/* `count` rows of a kernel, scaled, each of size 1, at G */
static void place_rows(const dm_inertia *x, double *G, const double *rows, uint32_t count) {
    const size_t n = x->model->n;
    for (size_t c = 0; c < count; c++) {
        double size = 0.0;
        for (size_t i = 0; i < n; i++) size = fmax(size, fabs(rows[c * n + i] * x->scale[i]));
        for (size_t i = 0; i < n; i++)
            G[c * n + i] = size > 0.0 ? rows[c * n + i] * x->scale[i] / size : 0.0;
    }
}

/* The rows of the constraints, at G. */
static void place_constraints(const dm_inertia *x, double *G, const double *at, double *out) {
    const dm_model *m = x->model;
    const uint32_t k = holonomic(m), l = rolling(m);
    const size_t n = m->n;
    if (k) {
        dm_kernel_prepare(&m->constraints->holonomic_kernel, out);
        dm_kernel_eval(&m->constraints->holonomic_kernel, at, out);
        place_rows(x, G, out + k, k);
    }
    if (l) { /* phi[l], E[l*n], phi_v[l*n] */
        dm_kernel_prepare(&m->constraints->rolling_kernel, out);
        dm_kernel_eval(&m->constraints->rolling_kernel, at, out);
        place_rows(x, G + k * n, out + l + l * n, l);
    }
}

/* M at (q, v, t), which lies in x->room, into the outputs of the kernel behind its n momenta */
static void evaluate(const dm_inertia *x) {
    double *out = x->room + 2 * (size_t)x->model->n + 1;
    dm_kernel_prepare(&x->model->mass, out);
    dm_kernel_eval(&x->model->mass, x->room, out);
}

/* the same at a state; 0: no velocity is known */
static int find_mass(const dm_inertia *x, const double *state, double t) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    double *at = x->room, *out = at + 2 * n + 1, *work = out + outputs(m) + matrices(m);
    memcpy(at, state, n * sizeof *at);
    memset(at + n, 0, n * sizeof *at);
    at[2 * n] = t;
    if (dm_inertia_sees_velocity(m) &&
        dm_legendre_inverse(m, at + n, state, state + n, t, work) != DM_OK)
        return 0;
    evaluate(x);
    return 1;
}

/* The mass that was found, scaled, as A. */
static void place_mass(const dm_inertia *x, double *A, const double *M) {
    const uint32_t n = x->model->n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) A[i * n + j] = x->scale[i] * M[i * n + j] * x->scale[j];
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

/* The first d columns of rows[count*n], d at most n, in their place: on a group the others have
 * masses of 1, which are no velocities (mech/group.h). */
static void narrow(double *rows, size_t count, uint32_t n, uint32_t d) {
    for (size_t i = 0; i < count && d < n; i++)
        memmove(rows + i * d, rows + i * n, d * sizeof *rows);
}

/* Of velocities, by what is found: the diagonal becomes ones; of a prolonged L that of M. */
static void find_scales(dm_inertia *x, const double *whole) {
    const uint32_t n = x->model->n, d = dm_momenta(x->model);
    double *M = x->room + 2 * (size_t)n + 1 + outputs(x->model);
    memcpy(M, whole, (size_t)n * n * sizeof *M);
    narrow(M, d, n, d);
    const uint32_t half = dm_inertia_is_prolonged(M, d) ? d / 2 : d;
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
    double *M = x->room + 2 * (size_t)n + 1 + outputs(x->model), *before = M + (size_t)n * n;
    dm_inertia_seen *s = &x->seen;
    const double credit = s->credit;
    dm_inertia_there there;
    if (!find_mass(x, state, t)) return;
    memcpy(before, x->scale, n * sizeof *before);
    find_scales(x, x->room + 2 * (size_t)n + 1 + n);
    for (uint32_t i = 0; i < n; i++) x->scale[i] = fmin(x->scale[i], before[i]);
    if (dm_inertia_values(x, state, t, &there))
        s->least = there.least, s->all = s->ones = there.all;
    dm_inertia_expect(x);
    s->credit = credit;
}

/* [M, G^T; G, 0] as A[N*N] */
static void place_border(double *A, size_t N, const double *M, const double *G, size_t n) {
    memset(A, 0, N * N * sizeof *A);
    for (size_t i = 0; i < n; i++) memcpy(A + i * N, M + i * n, n * sizeof *A);
    for (size_t c = n; c < N; c++)
        for (size_t i = 0; i < n; i++) A[c * N + i] = A[i * N + c] = G[(c - n) * n + i];
}

dm_inertia_form dm_inertia_place(const dm_inertia *x) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    double *at = x->room, *out = at + 2 * n + 1;
    dm_inertia_form f = {.A = out + outputs(m), .n = dm_momenta(m)};
    f.rows = (uint32_t)(order(m) - n);
    f.copy = f.A + n * n, f.G = f.copy + n * n, f.border = f.G + (f.rows + 1) * n;
    place_mass(x, f.A, out + n);
    if (f.rows) place_constraints(x, f.G, at, out); /* where the mass was */
    narrow(f.A, f.n, m->n, f.n);
    narrow(f.G, f.rows, m->n, f.n);
    f.n = dm_inertia_halve(f.A, f.G, &f.rows, f.n, f.border);
    return f;
}

/* Without constraints: the lower triangle of the mass that was found tells. */
int dm_inertia_is_far(const dm_inertia *x, double *least, double *all) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    const double *M = x->room + 2 * n + 1 + n, *scale = x->scale;
    double *A = x->room + 2 * n + 1 + outputs(m);
    if (order(m) != n || dm_momenta(m) != n) return 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) A[i * n + j] = scale[i] * M[i * n + j] * scale[j];
    if (!dm_all_positive(A, (uint32_t)n, DM_INERTIA_FAR, least)) return 0;
    *all = 1.0;
    for (size_t i = 0; i < n; i++) *all *= A[i * n + i];
    return 1;
}

/* How many are negative of the mass that was found, and the size of the value next to zero. With
 * all values far above zero, as they mostly are, less work tells so. Under constraints the size is
 * that on the velocities they allow; the number is that of the bordered matrix, which has as many
 * more as there are independent constraints. *all: the size of the product of the values. */
static uint32_t count(const dm_inertia *x, double *least, double *all) {
    if (dm_inertia_is_far(x, least, all)) return 0;
    const dm_inertia_form f = dm_inertia_place(x);
    uint32_t N = f.n, negative = 0;
    if (f.rows) {
        double unused[2];
        place_border(f.border, (size_t)f.n + f.rows, f.A, f.G, f.n);
        negative = dm_negative_values(f.border, f.n + f.rows, unused, unused + 1);
        N = dm_restrict(f.A, f.n, f.G, f.rows, f.border);
    }
    memcpy(f.copy, f.A, (size_t)N * N * sizeof *f.A);
    *all = 1.0;
    const int told = dm_all_positive(f.A, N, DM_INERTIA_FAR, least);
    for (size_t i = 0; i < N && told; i++) *all *= f.A[i * N + i];
    if (told) return negative;
    const uint32_t own = dm_negative_values(f.copy, N, least, all);
    return f.rows ? negative : own;
}

int dm_inertia_values(const dm_inertia *x, const double *state, double t, dm_inertia_there *out) {
    if (!find_mass(x, state, t)) return 0;
    out->negative = count(x, &out->least, &out->all);
    return 1;
}

int dm_inertia_at(const dm_inertia *x, const double *state, double t, uint32_t *negative,
                  double *least) {
    dm_inertia_there there;
    if (!dm_inertia_values(x, state, t, &there)) return 0;
    *negative = there.negative, *least = there.least;
    return 1;
}

void dm_inertia_find(const dm_inertia *x, const double *q, const double *v, double t) {
    const size_t n = x->model->n;
    memcpy(x->room, q, n * sizeof *q);
    memcpy(x->room + n, v, n * sizeof *v);
    x->room[2 * n] = t;
    evaluate(x);
}

double *dm_inertia_mass(const dm_inertia *x, const double *q, const double *v, double t) {
    const size_t n = x->model->n;
    double *out = x->room + 2 * n + 1, *A = out + outputs(x->model);
    dm_inertia_find(x, q, v, t);
    place_mass(x, A, out + n);
    return A;
}

uint32_t dm_inertia_negative(const dm_inertia *x, const double *q, const double *v, double t) {
    double least, all;
    dm_inertia_mass(x, q, v, t);
    return count(x, &least, &all);
}

const double *dm_inertia_velocity(const dm_inertia *x, const double *state, double t) {
    const dm_model *m = x->model;
    const size_t n = m->n;
    double *v = x->room + 2 * n + 1 + outputs(m), *work = v + matrices(m);
    memset(v, 0, n * sizeof *v);
    return dm_legendre_inverse(m, v, state, state + n, t, work) == DM_OK ? v : NULL;
}

/* Of M(q) v = p - shift, with what find_mass found at the start: as in Newton's method, but not to
 * round-off. */
static const double *velocity_of_mass(const dm_inertia *x, const double *p) {
    const size_t n = x->model->n;
    double *shift = x->room + 2 * n + 1, *M = shift + n, *v = shift + outputs(x->model);
    double *A = v + n;
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

/* The size of the value next to zero there; *changed: and beyond zero. What depends on the velocity
 * alone does not move. */
static double look_ahead(const dm_inertia *x, const double *state, double t, int *changed) {
    dm_inertia_there there;
    *changed = 0;
    if (!dm_inertia_values(x, x->end, t, &there)) return x->seen.least;
    dm_chord way = {.a = state, .b = x->end, .ta = t, .tb = t};
    if (!dm_inertia_sees_velocity(x->model)) way.first = x->seen.all, way.last = there.all;
    *changed = there.negative != x->seen.negative || dm_inertia_has_touched(x, &way);
    return there.least;
}

/* What is next to zero falls at the start as it would without forces. */
static double steps_left(const dm_inertia_seen *s, double ahead) {
    const double falls = s->least - ahead;
    return falls > 0.0 ? s->least / (1.5 * falls) : INFINITY;
}

/* Is d2L/dv2 singular there? Else the steps that are left; `ahead`: it is known where a step leads.
 */
static int is_singular(dm_inertia *x, const double *state, double t, int ahead) {
    dm_inertia_seen *s = &x->seen;
    double there;
    int changed = 0;
    s->left = INFINITY;
    if (ahead && dm_inertia_starts_by_far(x, state, t, &there)) {
        s->left = steps_left(s, there);
        return 0;
    }
    if (dm_inertia_is_degenerate(x, state, t)) return 1;
    if (!ahead) return 0;
    there = look_ahead(x, state, t, &changed);
    s->left = changed ? 0.0 : steps_left(s, there);
    return 0;
}

dm_status dm_inertia_begin(dm_inertia *x, const double *state, double t, double h) {
    dm_inertia_seen *s = &x->seen;
    const size_t n = x->model->n;
    *s = (dm_inertia_seen){.due = 1, .known = find_mass(x, state, t), .h = h};
    if (!s->known) return DM_OK;
    const int ahead = go_ahead(x, state, t, h);
    find_scales(x, x->room + 2 * n + 1 + n);
    s->negative = count(x, &s->least, &s->all);
    s->ones = s->all;
    s->degenerate = is_singular(x, state, t, ahead);
    if (s->degenerate) return DM_SINGULAR;
    s->at = t;
    s->nearest = s->left;
    dm_inertia_keep_place(x, state);
    dm_inertia_expect(x);
    dm_inertia_foresee(x, state, t, 0);
    return DM_OK;
}
