#include "integ/rules/compositions/composition.h"

#include "base/doubles.h"
#include "integ/rules/verlet.h"
#include "numbers/small_copy.h"

#include <math.h>
#include <string.h>

/* the first one of that order and number of stages, as far as they are given */
static const dm_scheme *find(const dm_rule *rule) {
    const int order = rule->count > 0 ? (int)rule->arg[0].number : 0;
    const int stages = rule->count > 1 && !rule->arg[1].rule ? (int)rule->arg[1].number : 0;
    for (const dm_scheme *s = rule->method->table; s->order; s++)
        if ((!order || s->order == order) && (!stages || s->stages == stages)) return s;
    return NULL;
}

/* ---- coefficients ---- */

/* entry i of a palindrome of `count` whose first entries are given, the middle ones sharing what
 * is left of 1 */
static double palindrome(const double *given, int stride, int known, int count, int i) {
    double sum = 0.0;
    const int mirrored = i < count - 1 - i ? i : count - 1 - i;
    if (mirrored < known) return given[stride * mirrored];
    for (int k = 0; k < known; k++) sum += given[stride * k];
    return (1.0 - 2.0 * sum) / (count - 2 * known);
}

/* All gammas of a composition, which add up to 1. */
static void lay_gamma(double *gamma, const dm_scheme *s) {
    for (int i = 0; i < s->stages; i++)
        gamma[i] = palindrome(s->half, 1, (s->stages - 1) / 2, s->stages, i);
}

/* the kind that comes first has stages + 1 entries, at even places of the half table; the other
 * has stages */
static void lay_alternating(dm_splitting *out, const dm_scheme *s) {
    const int n = s->stages, drift_first = s->kind == DM_DRIFT_FIRST;
    double *first = drift_first ? out->a : out->b;
    double *second = drift_first ? out->b + 1 : out->a;
    out->stages = drift_first ? n + 1 : n;
    for (int i = 0; i <= n; i++) first[i] = palindrome(s->half, 2, n / 2, n + 1, i);
    for (int i = 0; i < n; i++) second[i] = palindrome(s->half + 1, 2, (n - 1) / 2, n, i);
    if (drift_first) out->b[0] = out->b[n + 1] = 0.0;
}

/* ---- the rule ---- */

/* NULL: none is named. */
static const dm_rule *named_base(const dm_rule *rule) {
    return rule->count ? rule->arg[rule->count - 1].rule : NULL;
}

/* verlet is the same map as kicks and drifts where L separates */
static const dm_rule *base_rule(const dm_rule *rule) {
    return named_base(rule) ? named_base(rule) : &dm_rule_verlet;
}

/* of the whole step; a base that is named is stepped as it is */
int dm_composition_splitting(dm_splitting *out, const dm_rule *rule) {
    const dm_scheme *s = find(rule);
    double gamma[DM_SPLITTING_STAGES];
    if (named_base(rule) || !out) return !named_base(rule);
    if (s->kind != DM_GAMMA) return lay_alternating(out, s), 1;
    lay_gamma(gamma, s);
    dm_splitting_compose(out, gamma, s->stages);
    return 1;
}

/* order, for splittings the number of stages, then the base */
static int is_well_formed(const dm_rule *rule) {
    const int numbers = rule->count - (named_base(rule) ? 1 : 0);
    for (int k = 0; k < numbers; k++)
        if (rule->arg[k].rule || rule->arg[k].number != floor(rule->arg[k].number)) return 0;
    return numbers <= (find(rule)->kind != DM_GAMMA ? 2 : 1);
}

const char *dm_composition_check(const dm_rule *rule) {
    const dm_rule *base = base_rule(rule);
    const dm_method *method = base->method;
    if (!find(rule) || !is_well_formed(rule)) return "there is no such order or number of stages";
    if (method && dm_rule_check(base)) return dm_rule_check(base);
    if (!method || !(method->traits & DM_SYMMETRIC) || method->traits & DM_FOR_PAIRS ||
        dm_rule_order(base) != 2)
        return "the base must be a symmetric rule of order 2: verlet, midpoint, trapezoidal, "
               "gauss(1), lobatto(2) or rattle";
    if (find(rule)->kind != DM_GAMMA && named_base(rule))
        return "a Runge-Kutta-Nystroem splitting has no base rule";
    return NULL;
}

/* Of the row that the arguments choose. */
int dm_composition_order(const dm_rule *rule) {
    return find(rule)->order;
}

/* ---- steps of the base ---- */

static const dm_engine *choose(const dm_rule *rule, const dm_model *m) {
    return dm_splitting_steps(rule, m) ? &dm_engine_splitting : &dm_engine_composition;
}

/* what the base says, which must know the constraints of the model */
static const char *fits(const dm_rule *rule, const dm_model *m) {
    const dm_rule *base = base_rule(rule);
    if (m->structure & DM_HAMILTONIAN && find(rule)->kind != DM_GAMMA)
        return "a Runge-Kutta-Nystroem splitting needs an H that is quadratic in p; compose a rule "
               "instead, for instance kahan-li(6)";
    if (dm_method_needs(m) & ~base->method->traits)
        return "its base rule does not know constraints, rolling constraints or forces; name one "
               "that does, for instance yoshida(4, midpoint), or yoshida(4, rattle) for "
               "constraints alone";
    return dm_rule_fits(base, m);
}

/* Steps of a base that does. */
static int keeps_quadratic(const dm_rule *rule, const dm_model *m) {
    const dm_engine *e = dm_rule_engine(base_rule(rule), m);
    return e->keeps_quadratic && e->keeps_quadratic(base_rule(rule), m);
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    return dm_rule_engine(base_rule(rule), m)->wants(base_rule(rule), m);
}

/* workspace: this, the state at the start of the step, the workspace of the base */
typedef struct {
    dm_stepper base;
    int stages;
    double gamma[DM_SPLITTING_STAGES], *before;
} layout;

/* In doubles. */
static size_t head(void) {
    return dm_doubles(sizeof(layout));
}

static dm_stepper *base_of(const dm_stepper *s) {
    return &((layout *)(void *)s->work)->base;
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    const dm_rule *base = base_rule(rule);
    return head() + dm_state_size(m->n) + dm_rule_engine(base, m)->work(base, m);
}

/* A copy of this stepper with another rule and workspace. */
static dm_status open(dm_stepper *s) {
    layout *l = (layout *)(void *)s->work;
    *l = (layout){.base = *s, .stages = find(s->rule)->stages, .before = s->work + head()};
    lay_gamma(l->gamma, find(s->rule));
    l->base.rule = base_rule(s->rule);
    l->base.work = l->before + dm_state_size(s->model->n);
    return dm_stepper_open(&l->base);
}

static dm_status start(dm_stepper *s, double *state, double t, double h) {
    return dm_stepper_start(base_of(s), state, t, h);
}

/* one step of the base for every gamma; a failing one takes the whole step back */
static dm_status step(dm_stepper *s, double *state, double t, double h) {
    layout *l = (layout *)(void *)s->work;
    const size_t size = dm_state_size(s->model->n);
    dm_status status = DM_OK;
    dm_fresh_copy(l->before, state, size);
    for (int i = 0; i < l->stages && status == DM_OK; i++) {
        const double part = l->gamma[i] * h;
        status = l->base.engine->step(&l->base, state, t, part);
        t += part;
    }
    s->report = l->base.report;
    if (status != DM_OK) memcpy(state, l->before, size * sizeof *state);
    return status;
}

static size_t memory(dm_stepper *s, double **place) {
    return dm_stepper_memory(base_of(s), place);
}

/* What the base has outside of its workspace. */
static void close(dm_stepper *s) {
    dm_stepper_close(base_of(s));
}

const dm_engine dm_engine_composition = {
    .hamiltonian = 1,
    .spheres = 1,
    .works = 1,
    .choose = choose,
    .fits = fits,
    .keeps_quadratic = keeps_quadratic,
    .wants = wants,
    .work = work,
    .open = open,
    .start = start,
    .step = step,
    .memory = memory,
    .close = close,
};
