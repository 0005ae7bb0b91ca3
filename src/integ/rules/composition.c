/* composition.c - symmetric compositions of a symmetric second-order rule, and Runge-Kutta-Nystroem
 * splittings: one row per table of coefficients. HLW = Hairer, Lubich & Wanner 2006, V.3.2. */
#include "integ/split/splitting.h"

#include <math.h>
#include <string.h>

extern const dm_method dm_method_verlet; /* the base where none is named */

enum { GAMMA, KICK_FIRST, DRIFT_FIRST };

typedef struct {
    const char *name;
    int order;
    int stages; /* force evaluations per step */
    int kind;   /* GAMMA: multiples of the base step; else kicks and drifts of their own */
    double half
        /* gamma_1, ..., or the alternating kicks and drifts, up to where palindrome and sum fix
         * the rest */
        [20];
} scheme;

/* the middle coefficient of every row follows from sum = 1 and is not written */
static const scheme schemes[] = {
    /* Yoshida 1990, HLW (II.4.4) */
    {"yoshida", 4, 3, GAMMA, {1.35120719195965763405}},
    /* Yoshida 1990, solution A, HLW (V.3.11) */
    {"yoshida",
     6,
     7,
     GAMMA,
     {0.78451361047755726382, 0.23557321335935813368, -1.17767998417887100695}},
    /* Suzuki 1990, HLW (II.4.5) */
    {"suzuki", 4, 5, GAMMA, {0.41449077179437573714, 0.41449077179437573714}},
    /* McLachlan 1995, five stages */
    {"mclachlan", 4, 5, GAMMA, {0.28, 0.62546642846767004501}},
    /* Kahan & Li 1997, HLW (V.3.11) */
    {"kahan-li",
     6,
     9,
     GAMMA,
     {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981,
      0.08221359629355080023}},
    /* Kahan & Li 1997, HLW (V.3.13) */
    {"kahan-li",
     8,
     17,
     GAMMA,
     {0.13020248308889008088, 0.56116298177510838456, -0.38947496264484728641,
      0.15884190655515560090, -0.39590389413323757734, 0.18453964097831570709,
      0.25837438768632204729, 0.29501172360931029887}},
    /* Suzuki & Umeno 1993, HLW (V.3.12) */
    {"suzuki-umeno",
     8,
     15,
     GAMMA,
     {0.74167036435061295345, -0.40910082580003159400, 0.19075471029623837995,
      -0.57386247111608226666, 0.29906418130365592384, 0.33462491824529818378,
      0.31529309239676659663}},
    /* Sofroniou & Spaletta 2005, HLW (V.3.14) */
    {"sofroniou-spaletta",
     10,
     35,
     GAMMA,
     {0.07879572252168641926, 0.31309610341510852776, 0.02791838323507806611,
      -0.22959284159390709415, 0.13096206107716486317, -0.26973340565451071434,
      0.07497334315589143567, 0.11199342399981020489, 0.36613344954622675119,
      -0.39910563013603589788, 0.10308739852747107732, 0.41143087395589023782,
      -0.00486636058313526176, -0.39203335370863990644, 0.05194250296244964704,
      0.05066509075992449634, 0.04967437063972987905}},
    /* Blanes & Moan 2002, SRKN 6b of order 4 */
    {"blanes-moan",
     4,
     6,
     KICK_FIRST,
     {0.0829844064174052, 0.245298957184271, 0.396309801498368, 0.604872665711080,
      -0.0390563049223486}},
    /* Blanes & Moan 2002, SRKN 11b of order 6 */
    {"blanes-moan",
     6,
     11,
     KICK_FIRST,
     {0.0414649985182624, 0.123229775946271, 0.198128671918067, 0.290553797799558,
      -0.0400061921041533, -0.127049212625417, 0.0752539843015807, -0.246331761062075,
      -0.0115113874206879, 0.357208872795928}},
    /* Blanes & Moan 2002, SRKN 14a of order 6 */
    {"blanes-moan",
     6,
     14,
     DRIFT_FIRST,
     {0.0378593198406116, 0.09171915262446165, 0.102635633102435, 0.183983170005006,
      -0.0258678882665587, -0.05653436583288827, 0.314241403071447, 0.004914688774712854,
      -0.130144459517415, 0.143761127168358, 0.106417700369543, 0.328567693746804,
      -0.00879424312851058}},
};

/* the first row of that name and, when given, order and number of stages */
static const scheme *find(const dm_rule *rule) {
    const int order = rule->count > 0 ? (int)rule->arg[0].number : 0;
    const int stages = rule->count > 1 && !rule->arg[1].rule ? (int)rule->arg[1].number : 0;
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
        const scheme *s = schemes + i;
        if (strcmp(s->name, rule->name) == 0 && (!order || s->order == order) &&
            (!stages || s->stages == stages))
            return s;
    }
    return NULL;
}

/* entry i of a palindrome of `count` whose first entries are given, the middle ones sharing what
 * is left of 1 */
static double palindrome(const double *given, int stride, int known, int count, int i) {
    double sum = 0.0;
    const int mirrored = i < count - 1 - i ? i : count - 1 - i;
    if (mirrored < known) return given[stride * mirrored];
    for (int k = 0; k < known; k++) sum += given[stride * k];
    return (1.0 - 2.0 * sum) / (count - 2 * known);
}

static void lay_gamma(dm_splitting *out, const scheme *s) {
    double gamma[DM_SPLITTING_STAGES];
    for (int i = 0; i < s->stages; i++)
        gamma[i] = palindrome(s->half, 1, (s->stages - 1) / 2, s->stages, i);
    dm_splitting_compose(out, gamma, s->stages);
}

int dm_splitting_named(dm_splitting *out, const dm_rule *rule) {
    static const double one = 1.0;
    const scheme *s = find(rule);
    if (strcmp(rule->name, "verlet") == 0 && !rule->count)
        dm_splitting_compose(out, &one, 1);
    else if (s && s->kind == GAMMA && rule->count < 2)
        lay_gamma(out, s);
    else
        return 0;
    return 1;
}

/* the kind that comes first has stages + 1 entries, at even places of the half table; the other
 * has stages */
static void lay_alternating(dm_splitting *out, const scheme *s) {
    const int n = s->stages, drift_first = s->kind == DRIFT_FIRST;
    double *first = drift_first ? out->a : out->b;
    double *second = drift_first ? out->b + 1 : out->a;
    out->stages = drift_first ? n + 1 : n;
    for (int i = 0; i <= n; i++) first[i] = palindrome(s->half, 2, n / 2, n + 1, i);
    for (int i = 0; i < n; i++) second[i] = palindrome(s->half + 1, 2, (n - 1) / 2, n, i);
    if (drift_first) out->b[0] = out->b[n + 1] = 0.0;
}

/* the implicit rule composed when L does not separate, or is not known to: the one named in the
 * rule, else verlet, which is the same map where L does separate */
static const dm_rule *base_rule(const dm_rule *rule) {
    static const dm_rule verlet = {.name = "verlet", .method = &dm_method_verlet};
    const dm_rule *last = rule->count ? rule->arg[rule->count - 1].rule : NULL;
    return last ? last : &verlet;
}

static const dm_method *base_method(const dm_rule *rule) {
    return base_rule(rule)->method;
}

/* explicit unless a base is named */
static int is_splitting(const dm_rule *rule, const dm_model *m) {
    return dm_splitting_fits(m) && !(rule->count && rule->arg[rule->count - 1].rule);
}

/* order, for splittings the number of stages, then the base */
static int is_well_formed(const dm_rule *rule) {
    const int has_base = rule->count && rule->arg[rule->count - 1].rule;
    const int numbers = rule->count - (has_base ? 1 : 0);
    const scheme *s = find(rule);
    for (int k = 0; k < numbers; k++)
        if (rule->arg[k].rule || rule->arg[k].number != floor(rule->arg[k].number)) return 0;
    return numbers <= (s && s->kind != GAMMA ? 2 : 1);
}

static const char *check(const dm_rule *rule) {
    const dm_rule *base = base_rule(rule);
    const dm_method *method = base_method(rule);
    if (!find(rule) || !is_well_formed(rule)) return "there is no such order or number of stages";
    if (!method || !(method->traits & DM_SYMMETRIC) || method->traits & DM_FOR_PAIRS ||
        method->order(base) != 2)
        return "the base must be a symmetric rule of order 2: verlet, midpoint, "
               "trapezoidal, gauss(1), lobatto(2) or rattle";
    if (method->check && method->check(base)) return method->check(base);
    if (find(rule)->kind != GAMMA && rule->count && rule->arg[rule->count - 1].rule)
        return "a Runge-Kutta-Nystroem splitting has no base rule";
    return NULL;
}

/* what the base says, which must know the constraints of the model */
static const char *fits_base(const dm_rule *rule, const dm_model *m) {
    const dm_method *base = base_method(rule);
    if (dm_method_needs(m) & ~base->traits)
        return "its base rule does not know constraints or forces; name one that does, "
               "for instance yoshida(4, rattle)";
    return base->fits ? base->fits(base_rule(rule), m) : NULL;
}

static const char *fits(const dm_rule *rule, const dm_model *m) {
    if (find(rule)->kind == GAMMA && !is_splitting(rule, m)) return fits_base(rule, m);
    if (find(rule)->kind == GAMMA || dm_splitting_fits(m)) return NULL;
    return "a Runge-Kutta-Nystroem splitting needs a separable L = T(v) - V(q) with "
           "constant mass; compose "
           "an implicit rule instead, for instance kahan-li(6, midpoint), or take "
           "gauss(3)";
}

static int order(const dm_rule *rule) {
    return find(rule)->order;
}

static unsigned wants(const dm_rule *rule, const dm_model *m) {
    if (is_splitting(rule, m)) return DM_WANT_FORCE;
    return base_method(rule)->wants(base_rule(rule), m);
}

/* implicit: the stepper of the base, a copy of the state to go back to, the workspace of the
 * base */
static size_t stepper_size(void) {
    return (sizeof(dm_stepper) + sizeof(double) - 1) / sizeof(double);
}

static size_t work(const dm_rule *rule, const dm_model *m) {
    if (is_splitting(rule, m)) return dm_splitting_work(m);
    return stepper_size() + dm_state_size(m->n) + base_method(rule)->work(base_rule(rule), m);
}

static dm_status open_base(dm_stepper *s) {
    dm_stepper *base = (dm_stepper *)(void *)s->work;
    *base = *s;
    base->method = base_method(s->rule);
    base->rule = base_rule(s->rule);
    base->work = s->work + stepper_size() + dm_state_size(s->model->n);
    return base->method->open ? base->method->open(base) : DM_OK;
}

static dm_status open(dm_stepper *s) {
    const scheme *row = find(s->rule);
    dm_splitting table;
    if (!is_splitting(s->rule, s->model)) return open_base(s);
    if (row->kind == GAMMA)
        lay_gamma(&table, row);
    else
        lay_alternating(&table, row);
    dm_splitting_open(s, &table);
    return DM_OK;
}

/* one step of the base for every gamma; a failing one takes the whole step back */
static dm_status step_base(dm_stepper *s, double *state, double t, double h) {
    const scheme *row = find(s->rule);
    dm_stepper *base = (dm_stepper *)(void *)s->work;
    double *kept = s->work + stepper_size();
    const size_t bytes = dm_state_size(s->model->n) * sizeof *kept;
    memcpy(kept, state, bytes);
    for (int i = 0; i < row->stages; i++) {
        const double gamma = palindrome(row->half, 1, (row->stages - 1) / 2, row->stages, i);
        const double part = gamma * h;
        const dm_status status = base->method->step(base, state, t, part);
        t += part;
        s->report = base->report;
        if (status == DM_OK) continue;
        memcpy(state, kept, bytes);
        return status;
    }
    return DM_OK;
}

static dm_status step(dm_stepper *s, double *state, double t, double h) {
    return is_splitting(s->rule, s->model) ? dm_splitting_step(s, state, t, h)
                                           : step_base(s, state, t, h);
}

static dm_status advance(dm_stepper *s, double *state, double t, double h, long count, long *done) {
    return is_splitting(s->rule, s->model) ? dm_splitting_advance(s, state, t, h, count, done)
                                           : dm_advance_by_step(s, state, t, h, count, done);
}

/* a splitting leaves nothing, the base may */
static size_t memory(dm_stepper *s, double **place) {
    dm_stepper *base = (dm_stepper *)(void *)s->work;
    if (is_splitting(s->rule, s->model) || !base->method->memory) return 0;
    return base->method->memory(base, place);
}

static dm_status start(dm_stepper *s, double *state, double t, double h) {
    dm_stepper *base = (dm_stepper *)(void *)s->work;
    if (is_splitting(s->rule, s->model) || !base->method->start) return DM_OK;
    return base->method->start(base, state, t, h);
}

static int widen(dm_stepper *s, dm_lanes *x) {
    return is_splitting(s->rule, s->model) && dm_splitting_widen(s, x);
}

/* a row of methods.def: only names and texts differ */
#define CLAIMS(order_, stages_, cost_, instances_)                                                 \
    .orders = order_, .stages = stages_, .cost = cost_, .instances = instances_
#define COMPOSITION(id, rule_name, form, knows, claims, text)                                      \
    const dm_method dm_method_##id = {.name = rule_name,                                           \
                                      .signature = form,                                           \
                                      .doc = text,                                                 \
                                      claims,                                                      \
                                      .traits = DM_SYMMETRIC | DM_SYMPLECTIC | DM_KEEPS | (knows), \
                                      .check = check,                                              \
                                      .fits = fits,                                                \
                                      .order = order,                                              \
                                      .wants = wants,                                              \
                                      .work = work,                                                \
                                      .open = open,                                                \
                                      .start = start,                                              \
                                      .step = step,                                                \
                                      .memory = memory,                                            \
                                      .advance = advance,                                          \
                                      .widen = widen,                                              \
                                      .advance_lanes = dm_splitting_advance_lanes}

COMPOSITION(yoshida, "yoshida", "yoshida(4|6 [, base])", DM_CONSTRAINTS,
            CLAIMS("4, 6", "3, 7", "3, 7 forces; else steps of the base",
                   "yoshida(4):3:3; yoshida(6):7:7; yoshida(4, midpoint):3:0"),
            "Yoshida's compositions of order 4 (3 stages) and 6 (7 stages). Explicit "
            "when L separates, else "
            "steps of the base rule (verlet). Yoshida 1990; HLW (II.4.4), (V.3.11).");
COMPOSITION(suzuki, "suzuki", "suzuki(4 [, base])", DM_CONSTRAINTS,
            CLAIMS("4", "5", "5 forces; else steps of the base", "suzuki(4):5:5"),
            "Suzuki's composition of order 4, 5 stages. Suzuki 1990; HLW (II.4.5).");
COMPOSITION(mclachlan, "mclachlan", "mclachlan(4 [, base])", DM_CONSTRAINTS,
            CLAIMS("4", "5", "5 forces; else steps of the base", "mclachlan(4):5:5"),
            "McLachlan's composition of order 4, 5 stages with small error constant. "
            "McLachlan 1995.");
COMPOSITION(kahan_li, "kahan-li", "kahan-li(6|8 [, base])", DM_CONSTRAINTS,
            CLAIMS("6, 8", "9, 17", "9, 17 forces; else steps of the base",
                   "kahan-li(6):9:9; kahan-li(8):17:17; kahan-li(6, midpoint):9:0"),
            "Kahan and Li's compositions of order 6 (9 stages) and 8 (17 stages). HLW "
            "(V.3.11), (V.3.13).");
COMPOSITION(suzuki_umeno, "suzuki-umeno", "suzuki-umeno(8 [, base])", DM_CONSTRAINTS,
            CLAIMS("8", "15", "15 forces; else steps of the base", "suzuki-umeno(8):15:15"),
            "Suzuki and Umeno's composition of order 8, 15 stages. HLW (V.3.12).");
COMPOSITION(sofroniou_spaletta, "sofroniou-spaletta", "sofroniou-spaletta(10 [, base])",
            DM_CONSTRAINTS,
            CLAIMS("10", "35", "35 forces; else steps of the base", "sofroniou-spaletta(10):35:35"),
            "Sofroniou and Spaletta's composition of order 10, 35 stages. HLW (V.3.14).");
COMPOSITION(blanes_moan, "blanes-moan", "blanes-moan(4|6 [, 6|11|14])", 0,
            CLAIMS("4, 6", "6, 11, 14", "6, 11, 14 forces",
                   "blanes-moan(4):6:6; blanes-moan(6):11:11; blanes-moan(6, 14):14:14"),
            "Blanes and Moan's Runge-Kutta-Nystroem splittings of order 4 (6 stages) and "
            "6 (11 or 14 stages) "
            "for separable L with constant mass. Blanes & Moan 2002.");
