/* rk8.c - an explicit Runge-Kutta method of order 8 on Hamilton's equations of L:
 *   q' = v(q, p, t), the inverse Legendre transform,  p' = L_q(q, v, t),
 * 12 evaluations a step, fixed step, compensated sums. Coefficients: Dormand & Prince, DOP853 in
 * Hairer, Norsett & Wanner I, II.5. It is not symplectic: its use is comparison and short runs. */
#include "integ/rules/rk8.h"
#include "integ/method/cache.h"
#include "integ/method/hamilton.h"
#include "integ/method/method.h"
#include "mech/constraints.h"
#include "numbers/compensated.h"

#include <string.h>

enum { STAGES = DM_RK8_STAGES };

const double dm_rk8_tableau[STAGES + 1][STAGES] =
    {{0},
     {5.26001519587677318785587544488e-2},
     {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
     {2.95875854768068491816892993775e-2, 0, 8.87627564304205475450678981324e-2},
     {2.41365134159266685502369798665e-1, 0, -8.84549479328286085344864962717e-1,
      9.24834003261792003115737966543e-1},
     {1.0 / 27, 0, 0, 1.70828608729473871279604482173e-1, 1.25467687566822425016691814123e-1},
     {19.0 / 512, 0, 0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2,
      -9.0 / 512},
     {3.70920001185047927108779319836e-2, 0, 0, 1.70383925712239993810214054705e-1,
      1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2,
      8.27378916381402288758473766002e-3},
     {6.24110958716075717114429577812e-1, 0, 0, -3.36089262944694129406857109825,
      -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1,
      2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1},
     {4.77662536438264365890433908527e-1, 0, 0, -2.48811461997166764192642586468,
      -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1,
      1.52792336328824235832596922938e1, -3.32882109689848629194453265587e1,
      -2.03312017085086261358222928593e-2},
     {-9.3714243008598732571704021658e-1, 0, 0, 5.18637242884406370830023853209,
      1.09143734899672957818500254654, -8.14978701074692612513997267357,
      -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
      2.49360555267965238987089396762, -3.0467644718982195003823669022},
     {2.27331014751653820792359768449, 0, 0, -1.05344954667372501984066689879e1,
      -2.00087205822486249909675718444, -1.79589318631187989172765950534e1,
      2.79488845294199600508499808837e1, -2.85899827713502369474065508674,
      -8.87285693353062954433549289258, 1.23605671757943030647266201528e1,
      6.43392746015763530355970484046e-1},
     {5.42937341165687622380535766363e-2, 0, 0, 0, 0, 4.45031289275240888144113950566,
      1.89151789931450038304281599044, -5.8012039600105847814672114227,
      3.1116436695781989440891606237e-1, -1.52160949662516078556178806805e-1,
      2.01365400804030348374776537501e-1, 4.47106157277725905176885569043e-2}};

/* at the head of the workspace */
typedef struct {
    const dm_model *m;
    dm_kernel kernel; /* Hamilton's equations, outputs 0: the Legendre transform and L_q apart */
    double c[STAGES];
    double *x;     /* [2n+1] (q, p, t) of a stage; without a kernel (q, v, t) */
    double *slope; /* [STAGES][2n] */
    double *out;   /* [3n] of the kernel */
    double *next;  /* [4n] */
    double *p;     /* [n] momentum of a stage */
    double *scratch;
} explicit8;

static const char *check(const dm_rule *rule) {
    return rule->count ? "rk8 takes no argument" : NULL;
}

static int order(const dm_rule *rule) {
    (void)rule;
    return 8;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    (void)rule;
    return m->constraints && m->constraints->controls
               ? "it knows no controls; take midpoint or gauss"
               : NULL;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    const unsigned simple = DM_SEPARABLE | DM_CONSTANT_MASS;
    const unsigned mass = (m->structure & simple) == simple ? 0 : DM_WANT_MASS;
    (void)rule;
    return DM_WANT_FORCE | mass | (m->constraints ? DM_WANT_CONSTRAINT_FORCE : 0);
}

static size_t head(void) {
    return (sizeof(explicit8) + sizeof(double) - 1) / sizeof(double);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const size_t n = m->n;
    (void)rule;
    return head() + 2 * n + 1 + STAGES * 2 * n + 3 * n + 4 * n + n + dm_legendre_work(m);
}

static void find_kernel(explicit8 *e) {
    static const char maker;
    if (dm_cache_find(&e->kernel, e->m, &maker, 0)) return;
    if (!dm_hamilton_build(&e->kernel, e->m, 1))
        e->kernel.outputs = 0;
    else
        dm_cache_add(e->m, &maker, 0, &e->kernel, 1);
}

static dm_status open(dm_stepper *s) {
    explicit8 *e = (explicit8 *)(void *)s->work;
    const size_t n = s->model->n;
    *e = (explicit8){.m = s->model, .x = s->work + head()};
    e->slope = e->x + 2 * n + 1;
    e->out = e->slope + STAGES * 2 * n;
    e->next = e->out + 3 * n;
    e->p = e->next + 4 * n;
    e->scratch = e->p + n;
    for (int i = 0; i < STAGES; i++)
        for (int j = 0; j < i; j++) e->c[i] += dm_rk8_tableau[i][j];
    find_kernel(e);
    dm_kernel_prepare(e->kernel.outputs ? &e->kernel : &s->model->force, e->out);
    return DM_OK;
}

/* x = (q0, p0, t) + h sum_j a_ij slope_j */
static void place(explicit8 *e, const double *state, int i, double h) {
    const size_t n = e->m->n;
    double *x = e->x;
    for (size_t k = 0; k < 2 * n; k++) x[k] = state[2 * n + k];
    for (int j = 0; j < i; j++) {
        const double a = h * dm_rk8_tableau[i][j], *slope = e->slope + (size_t)j * 2 * n;
        if (a == 0.0) continue;
        for (size_t k = 0; k < 2 * n; k++) x[k] += a * slope[k];
    }
    for (size_t k = 0; k < 2 * n; k++) x[k] += state[k];
}

/* 0: there is no kernel, or the mass matrix is not positive and it cannot be trusted */
static int by_kernel(explicit8 *e, double *slope) {
    const uint32_t n = e->m->n;
    if (!e->kernel.outputs) return 0;
    dm_kernel_eval(&e->kernel, e->x, e->out);
    for (uint32_t k = 2 * n; k < 3 * n; k++)
        if (!(e->out[k] > 0.0)) return 0;
    memcpy(slope, e->out, 2 * n * sizeof *slope);
    return 1;
}

static dm_status by_legendre(explicit8 *e, double *slope) {
    const uint32_t n = e->m->n;
    double *v = e->x + n;
    memcpy(e->p, v, n * sizeof *v);
    memset(v, 0, n * sizeof *v); /* a function of (q, p, t) alone */
    const dm_status status = dm_legendre_inverse(e->m, v, e->x, e->p, e->x[2 * n], e->scratch);
    if (status != DM_OK) return status;
    memcpy(slope, v, n * sizeof *slope);
    dm_kernel_prepare(&e->m->force, slope + n);
    dm_kernel_eval(&e->m->force, e->x, slope + n);
    dm_constraints_add_force(slope + n, e->m->constraints, e->x, e->out);
    return DM_OK;
}

/* state + h sum_i b_i slope_i */
static dm_status finish(explicit8 *e, double *state, double h) {
    const uint32_t n = e->m->n;
    double sum = 0.0; /* 0 * infinity is NaN */
    memcpy(e->next, state, 4 * (size_t)n * sizeof *state);
    for (uint32_t k = 0; k < 2 * n; k++) {
        double change = 0.0;
        for (int i = 0; i < STAGES; i++)
            change += dm_rk8_tableau[STAGES][i] * e->slope[(size_t)i * 2 * n + k];
        dm_sum_add(e->next + k, e->next + 2 * n + k, h * change);
        sum += 0.0 * e->next[k];
    }
    if (sum != 0.0) return DM_NOT_FINITE;
    memcpy(state, e->next, 4 * (size_t)n * sizeof *state);
    return DM_OK;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    explicit8 *e = (explicit8 *)(void *)s->work;
    const size_t n = s->model->n;
    dm_status status = DM_OK;
    for (int i = 0; i < STAGES && status == DM_OK; i++) {
        double *slope = e->slope + (size_t)i * 2 * n;
        place(e, state, i, h);
        e->x[2 * n] = t + e->c[i] * h;
        if (!by_kernel(e, slope)) status = by_legendre(e, slope);
    }
    s->report.evaluations += STAGES;
    s->report.solves++;
    return status == DM_OK ? finish(e, state, h) : status;
}

const dm_method dm_method_rk8 = {
    .name = "rk8",
    .signature = "rk8",
    .doc = "Explicit Runge-Kutta of Dormand and Prince, order 8, 12 stages; not "
           "symplectic, energy drifts: for short runs and comparison (HNW I, II.5).",
    .orders = "8",
    .stages = "11",
    .cost = "12 accelerations",
    .instances = "rk8:12:12",
    .traits = DM_EXPLICIT | DM_KEEPS | DM_FORCED,
    .check = check,
    .fits = fits,
    .order = order,
    .wants = wants,
    .work = work,
    .open = open,
    .step = step,
};
