#include "run/inertia.h"

#include "linalg/signature.h"
#include "mech/constraints.h"

#include <math.h>
#include <string.h>

enum { MOST = 512 }; /* steps between looks */
/* Of the steps to zero by how a value moved last, the part that is not looked at: at a fold of the
 * momentum it goes like a root, and arrives in half of them. */
static const double OF_POSITION = 0.5, OF_VELOCITY = 0.2;

int dm_inertia_may_change(const dm_model *m) {
    const unsigned never = DM_CONSTANT_MASS | DM_LINEAR_IN_V | DM_LOOPS;
    return m->mass.eval != NULL && !(m->structure & never);
}

static int sees_velocity(const dm_model *m) {
    return !(m->structure & DM_QUADRATIC_IN_V);
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

/* (q, v, t), outputs, the matrix, the Legendre transform */
static size_t room(const dm_model *m) {
    return 2 * (size_t)m->n + 1 + outputs(m) + order(m) * order(m) + dm_legendre_work(m);
}

size_t dm_inertia_work(const dm_model *m, size_t memory, size_t members) {
    return room(m) + dm_state_size(m->n) + memory + members * m->n;
}

void dm_inertia_open(dm_inertia *x, const dm_model *m, size_t memory, double *work) {
    *x = (dm_inertia){.model = m, .room = work, .memory_size = memory};
    x->state = work + room(m);
    x->memory = x->state + dm_state_size(m->n);
    x->scale = x->scales = x->memory + memory;
    memset(work, 0, dm_inertia_work(m, memory, 0) * sizeof *work);
}

void dm_inertia_choose(dm_inertia *x, size_t member, const dm_inertia_seen *seen) {
    x->scale = x->scales + member * x->model->n;
    x->seen = *seen;
}

/* [M, G^T; G, 0] of the rows G of a kernel, `count` of them behind `before` others, each of size
 * 1 */
static void border(const dm_inertia *x, double *A, const double *G, uint32_t count,
                   uint32_t before) {
    const size_t n = x->model->n, N = order(x->model);
    for (size_t c = 0; c < count; c++) {
        double size = 0.0;
        for (size_t i = 0; i < n; i++) size = fmax(size, fabs(G[c * n + i] * x->scale[i]));
        for (size_t i = 0; i < n; i++) {
            double *below = A + (n + before + c) * N + i;
            *below = size > 0.0 ? G[c * n + i] * x->scale[i] / size : 0.0;
            A[i * N + n + before + c] = *below;
        }
    }
}

static void add_constraints(const dm_inertia *x, double *A, const double *at, double *out) {
    const dm_model *m = x->model;
    const uint32_t k = holonomic(m), l = rolling(m);
    const size_t n = m->n;
    if (k) {
        dm_kernel_prepare(&m->constraints->holonomic_kernel, out);
        dm_kernel_eval(&m->constraints->holonomic_kernel, at, out);
        border(x, A, out + k, k, 0);
    }
    if (l) { /* phi[l], E[l*n], phi_v[l*n] */
        dm_kernel_prepare(&m->constraints->rolling_kernel, out);
        dm_kernel_eval(&m->constraints->rolling_kernel, at, out);
        border(x, A, out + l + l * n, l, k);
    }
}

/* M at a state, into the outputs of the kernel behind its n momenta; 0: no velocity is known */
static int find_mass(const dm_inertia *x, const double *state, double t) {
    const dm_model *m = x->model;
    const size_t n = m->n, N = order(m);
    double *at = x->room, *out = at + 2 * n + 1, *work = out + outputs(m) + N * N;
    memcpy(at, state, n * sizeof *at);
    memset(at + n, 0, n * sizeof *at);
    at[2 * n] = t;
    if (sees_velocity(m) && dm_legendre_inverse(m, at + n, state, state + n, t, work) != DM_OK)
        return 0;
    dm_kernel_prepare(&m->mass, out);
    dm_kernel_eval(&m->mass, at, out);
    return 1;
}

/* The mass that was found, scaled, as the first rows and columns of A[N*N]. */
static void place_mass(const dm_inertia *x, double *A, size_t N) {
    const size_t n = x->model->n;
    const double *M = x->room + 3 * n + 1;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) A[i * N + j] = x->scale[i] * M[i * n + j] * x->scale[j];
}

/* How many are negative of the mass that was found, and the size of the value next to zero. The
 * bordered matrix has as many negative values more as there are independent constraints. Without
 * any, and with all values far above zero, as they mostly are, less work tells so. */
static uint32_t count(const dm_inertia *x, double *least) {
    static const double FAR = 1e-3;
    const dm_model *m = x->model;
    const size_t n = m->n, N = order(m);
    double *at = x->room, *out = at + 2 * n + 1, *A = out + outputs(m);
    place_mass(x, A, N);
    if (N == n && dm_all_positive(A, (uint32_t)N, FAR, least)) return 0;
    memset(A, 0, N * N * sizeof *A);
    place_mass(x, A, N);
    add_constraints(x, A, at, out);
    return dm_negative_values(A, (uint32_t)N, least);
}

void dm_inertia_begin(dm_inertia *x, const double *state, double t) {
    const size_t n = x->model->n;
    const double *M = x->room + 2 * n + 1 + n;
    x->seen = (dm_inertia_seen){.due = 1, .known = find_mass(x, state, t)};
    for (size_t i = 0; i < n && x->seen.known; i++) {
        const double own = fabs(M[i * n + i]);
        x->scale[i] = own > 0.0 && own < INFINITY ? 1.0 / sqrt(own) : 1.0;
    }
    if (x->seen.known) x->seen.negative = count(x, &x->seen.least);
}

int dm_inertia_has_changed(const dm_inertia *x, const double *state, double t) {
    double least;
    return x->seen.known && find_mass(x, state, t) && count(x, &least) != x->seen.negative;
}

int dm_inertia_look(dm_inertia *x, const double *state, double t, long done) {
    dm_inertia_seen *s = &x->seen;
    double least = s->least;
    const int found = s->known && find_mass(x, state, t);
    const int changed = found && count(x, &least) != s->negative;
    if (!found) least = 0.0;               /* so near to a fold that no velocity is found */
    if (done == s->looked) return changed; /* a step from here failed */
    const long since = done > s->looked ? done - s->looked : 1;
    const double rate = fabs(least - s->least) / (double)since;
    const double part = sees_velocity(x->model) ? OF_VELOCITY : OF_POSITION;
    const double safe = rate > 0.0 ? part * least / rate : INFINITY;
    const double far = fmin(fmin(safe, MOST), 2.0 * (double)since);
    s->due = done + (found && far >= 1.0 ? (long)far : 1);
    s->rate = rate;
    s->falls = least < s->least;
    s->least = least;
    s->looked = done;
    return changed;
}

int dm_inertia_is_fading(const dm_inertia *x) {
    static const double STEPS = 4.0; /* as it moved last; by a root there are half of them */
    return x->seen.known && x->seen.falls && x->seen.least <= STEPS * x->seen.rate;
}

void dm_inertia_keep(dm_inertia *x, dm_stepper *s, const double *state) {
    double *place;
    memcpy(x->state, state, dm_state_size(x->model->n) * sizeof *state);
    if (!x->memory_size) return;
    dm_stepper_memory(s, &place);
    memcpy(x->memory, place, x->memory_size * sizeof *place);
}

void dm_inertia_go_back(const dm_inertia *x, dm_stepper *s, double *state) {
    double *place;
    memcpy(state, x->state, dm_state_size(x->model->n) * sizeof *state);
    if (!x->memory_size) return;
    dm_stepper_memory(s, &place);
    memcpy(place, x->memory, x->memory_size * sizeof *place);
}
