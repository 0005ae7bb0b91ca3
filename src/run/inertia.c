#include "run/inertia.h"

#include "linalg/signature.h"
#include "mech/constraints.h"
#include "mech/group.h"

#include <math.h>
#include <string.h>

enum { MOST = 512 }; /* steps between looks */
/* Of the steps until a value vanishes, the part that is not looked at: of a mass that depends on
 * positions alone, and of others. */
static const double OF_POSITION = 0.5, OF_VELOCITY = 0.4;

int dm_inertia_may_change(const dm_model *m) {
    const unsigned never = DM_CONSTANT_MASS | DM_DEFINITE_MASS | DM_LINEAR_IN_V | DM_LOOPS;
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

size_t dm_inertia_work(const dm_model *m, size_t memory, size_t members) {
    return room(m) + 4 * dm_state_size(m->n) + 3 * memory + dm_inertia_boxes(m) +
           members * 3 * (size_t)m->n;
}

void dm_inertia_open(dm_inertia *x, const dm_model *m, size_t memory, double *work) {
    *x = (dm_inertia){.model = m, .room = work, .memory_size = memory};
    x->state = work + room(m);
    x->memory = x->state + dm_state_size(m->n);
    x->aside = x->memory + memory;
    x->end = x->aside + 2 * (dm_state_size(m->n) + memory);
    x->boxes = x->end + dm_state_size(m->n);
    x->members = x->boxes + dm_inertia_boxes(m);
    x->scale = x->members, x->region = x->scale + m->n;
    memset(work, 0, dm_inertia_work(m, memory, 0) * sizeof *work);
}

void dm_inertia_choose(dm_inertia *x, size_t member, const dm_inertia_seen *seen) {
    x->scale = x->members + member * 3 * x->model->n;
    x->region = x->scale + x->model->n;
    x->seen = *seen;
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
    if (sees_velocity(m) && dm_legendre_inverse(m, at + n, state, state + n, t, work) != DM_OK)
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
    for (uint32_t k = 0; k < PASSES * n; k++) {
        const uint32_t i = k % n;
        double largest = 0.0;
        for (uint32_t j = 0; j < n; j++)
            largest = fmax(largest, fabs(scale[i] * M[i * pitch + j] * scale[j]));
        const int alone = M[i * pitch + i] == 0.0 && largest > 0.0;
        if ((alone || largest > FAR) && largest < INFINITY) scale[i] /= sqrt(largest);
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

/* How many are negative of the mass that was found, and the size of the value next to zero. With
 * all values far above zero, as they mostly are, less work tells so. Under constraints the size is
 * that on the velocities they allow; the number is that of the bordered matrix, which has as many
 * more as there are independent constraints. *all: the product of the values, zero where less work
 * did not tell. */
static uint32_t count(const dm_inertia *x, double *least, double *all) {
    static const double FAR = 1e-3;
    const dm_inertia_form f = dm_inertia_place(x);
    uint32_t N = f.n, negative = 0;
    if (f.rows) {
        double unused;
        place_border(f.border, (size_t)f.n + f.rows, f.A, f.G, f.n);
        negative = dm_negative_values(f.border, f.n + f.rows, &unused);
        N = dm_restrict(f.A, f.n, f.G, f.rows, f.border);
    }
    memcpy(f.copy, f.A, (size_t)N * N * sizeof *f.A);
    const int told = dm_all_positive(f.A, N, FAR, least);
    *all = told ? 1.0 : 0.0;
    for (size_t i = 0; i < N && told; i++) *all *= f.A[i * N + i];
    if (told) return negative;
    const uint32_t own = dm_negative_values(f.copy, N, least);
    return f.rows ? negative : own;
}

int dm_inertia_at(const dm_inertia *x, const double *state, double t, uint32_t *negative,
                  double *least) {
    if (!find_mass(x, state, t)) return 0;
    double all;
    *negative = count(x, least, &all);
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

/* The size of the value next to zero one step on, if no force acted; *changed: and beyond zero.
 * What depends on the velocity alone does not move. */
static double look_ahead(const dm_inertia *x, const double *state, double t, double h,
                         int *changed) {
    const size_t n = x->model->n;
    const double *v = dm_inertia_velocity(x, state, t);
    double *ahead = x->aside, least = x->seen.least;
    uint32_t negative = x->seen.negative;
    *changed = 0;
    for (size_t i = 0; i < n && v; i++) {
        ahead[i] = state[i] + h * v[i];
        ahead[n + i] = state[n + i];
    }
    if (!v || !dm_inertia_at(x, ahead, t, &negative, &least)) return x->seen.least;
    const dm_chord way = {.a = state, .b = ahead, .ta = t, .tb = t};
    *changed = negative != x->seen.negative || dm_inertia_has_touched(x, &way);
    return least;
}

dm_status dm_inertia_begin(dm_inertia *x, const double *state, double t, double h) {
    dm_inertia_seen *s = &x->seen;
    const size_t n = x->model->n;
    const double *M = x->room + 2 * n + 1 + n;
    *s = (dm_inertia_seen){.due = 1, .known = find_mass(x, state, t)};
    if (!s->known) return DM_OK;
    find_scales(x, M);
    s->negative = count(x, &s->least, &s->all);
    s->degenerate = dm_inertia_is_degenerate(x, state, t);
    if (s->degenerate) return DM_SINGULAR;
    int changed = 0;
    const double ahead = look_ahead(x, state, t, h, &changed), falls = s->least - ahead;
    s->left = changed ? 0.0 : falls > 0.0 ? s->least / (1.5 * falls) : INFINITY;
    s->at = t;
    s->nearest = s->left;
    dm_inertia_keep_place(x, state);
    x->h = h;
    dm_inertia_expect(x);
    dm_inertia_foresee(x, state, t, 0);
    return DM_OK;
}

/* Like (t0 - t)^(2/3) where the mass depends on positions alone, since M v^2 stays finite; else
 * like the root of t0 - t, as at a fold of the momentum. */
double dm_inertia_left(const dm_inertia *x, double before, double now, double since) {
    const double ratio = before / now;
    if (!(ratio > 1.0)) return INFINITY;
    return since / (ratio * (sees_velocity(x->model) ? ratio : sqrt(ratio)) - 1.0);
}

/* Did a value fall by more than a part of the way to zero leaves of it, or rise from less? What was
 * behind zero in between came back. */
static int is_strange(double before, double now) {
    static const double PART = 0.63; /* (1/2)^(2/3): after half of the way */
    return now < PART * before || before < PART * now;
}

/* Steps until a value may vanish, so few that one which does not go on falling may have been thrown
 * back: by what it kept in one step. */
static const double NEAR = 4.0, KEPT = 0.9;

/* Steps that may come before the next look, so that the value moves by little meanwhile, since to
 * go back costs more than to look: by how fast its logarithm moved, and how that changed, as that
 * of a value that is about to turn does. Ways grow slowly, but for a value that hardly moves. */
static double still_steps(dm_inertia_seen *s, double ratio, double since) {
    static const double LITTLE = 0.3, SURELY = 0.25;
    const double rate = log(ratio) / since;
    const double bend = s->way > 0.0 ? 2.0 * (rate - s->rate) / (since + s->way) : 0.0;
    const double now = fabs(rate + 0.5 * bend * since);
    const double steps = 2.0 * LITTLE / (now + sqrt(now * now + 2.0 * LITTLE * fabs(bend)));
    s->rate = rate, s->way = since;
    return fmin(steps, fmax(since + 1.0, fmin(2.0 * since, SURELY * steps)));
}

int dm_inertia_look(dm_inertia *x, const double *state, double t, long done) {
    dm_inertia_seen *s = &x->seen;
    double least = s->least, all = 0.0;
    const int found = s->known && find_mass(x, state, t);
    const int changed = found && count(x, &least, &all) != s->negative;
    if (!found) least = 0.0; /* so near to a fold that no velocity is found */
    if (done == s->looked) return changed ? DM_INERTIA_CHANGED : 0; /* a step from here failed */
    x->before = s->left;
    const long since = done > s->looked ? done - s->looked : 1;
    const int strange = found && since > 1 && is_strange(s->least, least);
    const double part = sees_velocity(x->model) ? OF_VELOCITY : OF_POSITION;
    s->left = dm_inertia_left(x, s->least, least, (double)since);
    const dm_inertia_way way = dm_inertia_way_since(x, least, all, since);
    const double nearest = fmin(s->left, way.left), safe = part * nearest;
    const int touched = found && !changed && dm_inertia_touches_since(x, state, t, &way);
    const int turned = since == 1 && x->before <= NEAR && least > KEPT * s->least;
    const double still = still_steps(s, fmin(way.is / way.was, least / s->least), (double)since);
    const double far = s->left <= NEAR ? 1.0 : fmin(fmin(safe, MOST), still);
    s->due = done + (found && far >= 1.0 ? (long)far : 1);
    s->least = least, s->all = all, s->nearest = nearest, s->fell = way.is < way.was;
    s->open = 0;
    if (found && !changed) dm_inertia_foresee(x, state, t, done);
    s->looked = done;
    s->at = t;
    dm_inertia_keep_place(x, state);
    if (changed || touched) return DM_INERTIA_CHANGED;
    return strange ? DM_INERTIA_STRANGE : found && turned ? DM_INERTIA_TURNED : 0;
}

void dm_inertia_begin_closely(dm_inertia *x) {
    uint32_t negative;
    x->close_left = x->kept_left;
    if (!dm_inertia_at(x, x->state, x->t, &negative, &x->close_least)) x->close_least = 0.0;
}

int dm_inertia_look_closely(dm_inertia *x, const double *state, double t, int *steep) {
    const dm_chord way = {.a = x->state, .b = state, .ta = x->t, .tb = t};
    const double before = x->close_least;
    uint32_t negative;
    double least;
    *steep = 0;
    x->before = x->close_left;
    if (!x->seen.known || !dm_inertia_at(x, state, t, &negative, &least)) return 0;
    x->close_least = least, x->close_left = dm_inertia_left(x, before, least, 1.0);
    *steep = x->before <= (least > KEPT * before ? NEAR : DM_INERTIA_STEEP);
    const int changed = negative != x->seen.negative || dm_inertia_has_touched(x, &way);
    return changed ? DM_INERTIA_CHANGED : 0;
}

int dm_inertia_is_fading(const dm_inertia *x) {
    static const double STEPS = 2.5;
    return x->seen.known && x->seen.left <= STEPS;
}

int dm_inertia_is_steep(const dm_inertia_seen *s) {
    return s->known && s->left <= DM_INERTIA_STEEP;
}

int dm_inertia_is_near(const dm_inertia_seen *s) {
    return s->known && s->left <= NEAR;
}
