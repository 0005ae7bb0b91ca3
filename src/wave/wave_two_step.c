/* wave_two_step.c - the scheme of linear functions in time with exact integrals (Leok 5.8), mode by
 * mode: (i/2 - theta/6) c+ = (i/2 + theta/6) c- + (2 theta/3) c [+ lambda c], theta = h E/hbar. Its
 * roots have modulus 1 for |theta| <= sqrt(3); one of them, near -1, is parasitic. */
#include "wave/complex_number.h"
#include "wave/wave_stepper.h"

#include <math.h>
#include <string.h>

typedef struct {
    dm_modes modes;
    dm_complex_number *back, *now, *multiplier; /* [n] coefficients of c-, c, and of lambda c */
    int keeps_norm;
    double norm;             /* that of the start; stands behind the levels in the state */
    dm_complex_number *next; /* [n] */
    double *a;               /* [2 n] */
} two_step;

/* Row k has levels k and k + 1: the state is both, and the norm. */
static dm_complex_number *level(const dm_wave_stepper *s, int which) {
    return (dm_complex_number *)(void *)(s->state + (which ? 2 * (size_t)s->wave->n : 0));
}

/* ---- the multiplier ---- */

/* The smaller root lambda of |A + lambda B|^2 = norm; DM_SINGULAR: there is none. */
static dm_status find_multiplier(double *lambda, const two_step *p, const dm_complex_number *c,
                                 double norm) {
    double AA = 0.0, AB = 0.0, BB = 0.0;
    for (uint32_t k = 0; k < p->modes.n; k++) {
        const dm_complex_number B = dm_cproduct(p->multiplier[k], c[k]);
        AA += dm_csquare(p->next[k]), BB += dm_csquare(B);
        AB += dm_cinner(p->next[k], B).re;
    }
    const double rest = AA - norm, root = AB * AB - BB * rest;
    if (!(root >= 0.0)) return DM_SINGULAR;
    const double sum = AB + copysign(sqrt(root), AB);
    *lambda = sum == 0.0 ? 0.0 : -rest / sum;
    return DM_OK;
}

/* ---- steps ---- */

/* One step, from levels k - 1 and k to k and k + 1; on failure both stay. */
static dm_status step(dm_wave_stepper *s) {
    const two_step *p = s->data;
    const uint32_t n = p->modes.n;
    dm_complex_number *before = level(s, 0), *c = level(s, 1);
    double lambda = 0.0;
    for (uint32_t k = 0; k < n; k++)
        p->next[k] = dm_csum(dm_cproduct(p->back[k], before[k]), dm_cproduct(p->now[k], c[k]));
    if (p->keeps_norm) {
        const dm_status status = find_multiplier(&lambda, p, c, s->state[4 * (size_t)n]);
        if (status != DM_OK) return status;
        for (uint32_t k = 0; k < n; k++)
            p->next[k] =
                dm_csum(p->next[k], dm_cscaled(lambda, dm_cproduct(p->multiplier[k], c[k])));
    }
    memcpy(before, c, n * sizeof *c);
    memcpy(c, p->next, n * sizeof *c);
    return DM_OK;
}

/* Up to the first step that has no multiplier. */
static dm_status advance(dm_wave_stepper *s, long count, long *done) {
    dm_status status = DM_OK;
    for (long i = 0; status == DM_OK && i < count; i++) {
        status = step(s);
        if (status == DM_OK) ++*done;
    }
    return status;
}

/* The parasitic part of mode k: c0 = a + b, c1 = a z + b y with the roots z, y of y^2 = now y +
 * back, z = exp(-i angle), 3 sin(angle)/(2 + cos(angle)) = theta; beyond the limit, or where they
 * come together, there is no telling. */
static double parasitic_square(const dm_wave_stepper *s, uint32_t k) {
    const two_step *p = s->data;
    const double theta = s->h * p->modes.energy[k] / s->wave->hbar;
    const double size = 9.0 + theta * theta, root = 9.0 - 3.0 * theta * theta;
    if (root <= 1e-8) return 0.0;
    /* 3 sin - theta cos = 2 theta */
    const double angle = asin(2.0 * theta / sqrt(size)) + atan2(theta, 3.0);
    const dm_complex_number z = dm_cunit(-angle), c0 = level(s, 0)[k], c1 = level(s, 1)[k];
    const dm_complex_number back = p->back[k]; /* - z y */
    const dm_complex_number y = dm_cscaled(-1.0, dm_cquotient(back, z));
    const dm_complex_number left = dm_csum(c1, dm_cscaled(-1.0, dm_cproduct(z, c0)));
    return dm_csquare(left) / dm_csquare(dm_csum(y, dm_cscaled(-1.0, z)));
}

/* root of its share of the norm */
static double parasitic_share(const dm_wave_stepper *s) {
    double sum = 0.0, all = 0.0;
    for (uint32_t k = 0; k < s->wave->n; k++) {
        sum += parasitic_square(s, k);
        all += dm_csquare(level(s, 0)[k]);
    }
    return sqrt(sum / all);
}

/* the second level: (1 + i theta/2) c1 = (1 - i theta/2) c0 */
static dm_status start(dm_wave_stepper *s, const double *a) {
    two_step *p = s->data;
    const uint32_t n = p->modes.n;
    dm_complex_number *first = level(s, 0), *second = level(s, 1);
    double norm = 0.0;
    memcpy(p->a, a, 2 * (size_t)n * sizeof *a);
    dm_to_modes(&p->next->re, &p->modes, p->a);
    memcpy(first, p->next, n * sizeof *first);
    for (uint32_t k = 0; k < n; k++) {
        const double phase = dm_gauss_phase(1, s->h * p->modes.energy[k] / s->wave->hbar);
        second[k] = dm_cproduct(dm_cunit(phase), first[k]);
        norm += dm_csquare(first[k]);
    }
    s->state[4 * (size_t)n] = norm;
    s->parasitic = parasitic_share(s);
    return DM_OK;
}

/* Those of the earlier level, which the row shows. */
static void amplitudes(const dm_wave_stepper *s, double *a) {
    const two_step *p = s->data;
    memcpy(p->next, s->state, 2 * (size_t)p->modes.n * sizeof *a);
    dm_from_modes(p->a, &p->modes, &p->next->re);
    memcpy(a, p->a, 2 * (size_t)p->modes.n * sizeof *a);
}

/* hbar Re <c0, c1> - h/3 Im <c0, H c1> */
static double noether(const dm_wave_stepper *s) {
    const two_step *p = s->data;
    double re = 0.0, im = 0.0;
    for (uint32_t k = 0; k < p->modes.n; k++) {
        const dm_complex_number product = dm_cinner(level(s, 0)[k], level(s, 1)[k]);
        re += product.re;
        im += p->modes.energy[k] * product.im;
    }
    return s->wave->hbar * re - s->h / 3.0 * im;
}

static const dm_wave_engine engine = {start, advance, amplitudes, noether};

/* ---- opening ---- */

dm_status dm_wave_two_step(dm_wave_stepper *s, const dm_wave *w, double h, int keeps_norm,
                           dm_arena *arena, volatile const int *stop) {
    const size_t n = w->n, size = n * sizeof(dm_complex_number);
    const double *rest;
    two_step *p = dm_arena_take(arena, sizeof *p);
    *s = (dm_wave_stepper){.engine = &engine, .wave = w, .h = h, .size = 4 * n + 1, .data = p};
    s->state = dm_arena_take(arena, (4 * n + 1) * sizeof(double));
    if (!p || !s->state) return DM_NO_MEMORY;
    *p = (two_step){.keeps_norm = keeps_norm};
    p->back = dm_arena_take(arena, size), p->now = dm_arena_take(arena, size);
    p->multiplier = dm_arena_take(arena, size), p->next = dm_arena_take(arena, size);
    p->a = dm_arena_take(arena, size);
    if (!p->back || !p->now || !p->multiplier || !p->next || !p->a) return DM_NO_MEMORY;
    dm_status status = dm_wave_modes(&p->modes, &rest, w, arena, stop);
    if (status == DM_OK && rest) status = DM_TOO_LARGE;
    for (size_t k = 0; status == DM_OK && k < n; k++) {
        const double theta = h * p->modes.energy[k] / w->hbar;
        const dm_complex_number left = {-theta / 6.0, 0.5};
        p->back[k] = dm_cquotient((dm_complex_number){theta / 6.0, 0.5}, left);
        p->now[k] = dm_cquotient((dm_complex_number){2.0 * theta / 3.0, 0.0}, left);
        p->multiplier[k] = dm_cquotient((dm_complex_number){1.0, 0.0}, left);
    }
    return status;
}
