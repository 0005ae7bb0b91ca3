/* members in lanes: the bits of one member, for any number of them; no lanes where none can be
 * had. */
#include "check.h"
#include "code/native/jit.h"
#include "integ/registry.h"
#include "problems.h"
#include "run/ensemble/ensemble.h"

#include <sys/resource.h>

enum { MOST = 75, STEPS = 200, SIZE = 4 * 2 + DM_STATE_OWN };

typedef struct {
    dm_arena arena;
    dm_model model;
    dm_rule nodes[DM_RULE_NODES];
    dm_stepper s;
} kepler;

/* L = v^2/2 + 1/r as a graph */
static dm_node lagrangian(dm_graph *g) {
    dm_node x[4];
    for (uint32_t i = 0; i < 4; i++) {
        const dm_node q = dm_input(g, i);
        x[i] = dm_mul(g, q, q);
    }
    const dm_node r2 = dm_add(g, x[0], x[1]), v2 = dm_add(g, x[2], x[3]);
    const dm_node r = dm_apply(g, DM_OP_SQRT, r2, 0, 0), one = dm_constant(g, 1.0);
    const dm_node half = dm_constant(g, 0.5), T = dm_mul(g, half, v2);
    const dm_node U = dm_div(g, one, r);
    return dm_add(g, T, U);
}

static int kepler_open(kepler *k, const char *rule) {
    *k = (kepler){.s = {.tolerance = 4e-15, .max_iterations = 50}};
    dm_arena_init(&k->arena, problem_allocate, NULL);
    dm_graph *g = dm_graph_new(&k->arena, 5);
    const dm_node L = lagrangian(g);
    if (dm_rule_read(k->nodes, rule, NULL)) return 0;
    k->s.rule = k->nodes;
    if (dm_model_build(&k->model, g, L, 2, 0, NULL, &k->arena) != DM_OK) return 0;
    const unsigned wants = dm_rule_engine(k->nodes, &k->model)->wants(k->nodes, &k->model);
    if (dm_model_build(&k->model, g, L, 2, wants, dm_native_build, &k->arena) != DM_OK) return 0;
    k->s.model = &k->model;
    const size_t work =
        dm_rule_engine(k->nodes, &k->model)->work(k->nodes, &k->model) * sizeof(double);
    k->s.work = dm_arena_take(&k->arena, work);
    memset(k->s.work, 0, work);
    return dm_stepper_open(&k->s) == DM_OK;
}

/* member i starts at q = (0.4 + i/1000, 0), p = (0, 2); member `broken` at NaN */
static void starts(double *state, long members, long broken) {
    memset(state, 0, (size_t)members * SIZE * sizeof *state);
    for (long i = 0; i < members; i++) {
        state[i * SIZE] = i == broken ? NAN : 0.4 + 1e-3 * (double)i;
        state[i * SIZE + 3] = 2.0;
    }
}

static uint32_t run_all(double *state, dm_member *member, long members, kepler *k) {
    uint32_t lanes = 0;
    dm_stepper *steppers[1] = {&k->s};
    for (long i = 0; i < members; i++) member[i] = (dm_member){.status = DM_STOPPED};
    const dm_ensemble e = {.members = members,
                           .h = 0.01,
                           .steps = STEPS,
                           .state = state,
                           .member = member,
                           .lanes = &lanes};
    CHECK(dm_ensemble_run(&e, steppers, 1) == DM_OK);
    return lanes;
}

static const char *const rules[] = {"verlet", "kahan-li(8)", "blanes-moan(6, 14)",
                                    "log-hamiltonian(yoshida(4))"};
enum { RULES = sizeof rules / sizeof *rules };

/* the ends of `members` under a limit of lanes against those of runs one by one */
static void compare(const char *rule, long members, long broken, uint32_t limit) {
    static double state[MOST * SIZE], alone[MOST * SIZE];
    static dm_member member[MOST], one[MOST];
    kepler k;
    CHECK(kepler_open(&k, rule));
    dm_jit_limit(1);
    starts(alone, members, broken);
    CHECK(run_all(alone, one, members, &k) == 1);
    dm_jit_limit(limit);
    starts(state, members, broken);
    CHECK(run_all(state, member, members, &k) == (dm_jit_lanes() < 4 ? 1 : dm_jit_lanes()));
    dm_jit_limit(8);
    for (long i = 0; i < members; i++) {
        CHECK(member[i].status == (i == broken ? DM_NOT_FINITE : DM_OK));
        CHECK(member[i].steps == (i == broken ? 0 : STEPS));
        CHECK(one[i].status == member[i].status && one[i].steps == member[i].steps);
        for (int j = 0; i != broken && j < SIZE; j++)
            CHECK(state[i * SIZE + j] == alone[i * SIZE + j]);
    }
    dm_arena_release(&k.arena);
}

static void members_are_single_runs(void) {
    static const long members[] = {1, 4, 7, 8, 9, 64, 65, MOST};
    for (int r = 0; r < RULES; r++)
        for (int i = 0; i < 8; i++)
            for (uint32_t limit = 1; limit <= 8; limit += limit == 1 ? 3 : 4)
                compare(rules[r], members[i], -1, limit);
}

static void broken_members_leave_the_others_alone(void) {
    for (int r = 0; r < RULES; r++)
        for (long broken = 0; broken < 20; broken += 3) compare(rules[r], 20, broken, 8);
    compare("verlet", 1, 0, 8);
}

/* the energy of Kepler's problem after 200 steps of a rule of order 8: an independent road */
static void energy_is_kept(void) {
    static double state[MOST * SIZE];
    static dm_member member[MOST];
    kepler k;
    CHECK(kepler_open(&k, "kahan-li(8)"));
    starts(state, MOST, -1);
    run_all(state, member, MOST, &k);
    for (long i = 0; i < MOST; i++) {
        const double *z = state + i * SIZE, q0 = 0.4 + 1e-3 * (double)i;
        const double E = 0.5 * (z[2] * z[2] + z[3] * z[3]) - 1.0 / hypot(z[0], z[1]);
        CHECK_NEAR(E, 2.0 - 1.0 / q0, 1e-12);
        CHECK_NEAR(z[0] * z[3] - z[1] * z[2], 2.0 * q0, 1e-14);
    }
    dm_arena_release(&k.arena);
}

/* valgrind and the sanitizer live in the same address space and need it themselves */
#if defined(__SANITIZE_ADDRESS__)
#define LIMITS_ADDRESSES 0
#elif defined(__has_feature)
#define LIMITS_ADDRESSES !__has_feature(address_sanitizer)
#else
#define LIMITS_ADDRESSES 1
#endif

static int may_limit_addresses(void) {
    const char *preload = getenv("LD_PRELOAD");
    return LIMITS_ADDRESSES && !(preload && strstr(preload, "valgrind"));
}

/* no executable memory after the kernels of one member are there: members go one by one */
static void refused_code_memory(void) {
    static double state[MOST * SIZE];
    static dm_member member[MOST];
    struct rlimit old, none;
    kepler k;
    CHECK(kepler_open(&k, "verlet"));
    starts(state, MOST, -1);
    CHECK(getrlimit(RLIMIT_AS, &old) == 0);
    none = old;
    none.rlim_cur = 1;
    const int limited = may_limit_addresses() && setrlimit(RLIMIT_AS, &none) == 0;
    const uint32_t lanes = run_all(state, member, MOST, &k);
    CHECK(setrlimit(RLIMIT_AS, &old) == 0);
    CHECK(!limited || lanes == 1);
    for (long i = 0; i < MOST; i++) CHECK(member[i].status == DM_OK && member[i].steps == STEPS);
    dm_arena_release(&k.arena);
}

/* what was told of the steps so far: how often, the last of them, did they ever go back? */
typedef struct {
    long calls, last;
    int back;
} told;

static void listen(void *ud, long done) {
    told *t = ud;
    t->back |= done < t->last;
    t->last = done;
    t->calls++;
}

/* of two members that take long, one by one and side by side, one of which fails at once; without
 * machine code a tenth of the steps is long */
static void progress_counts_steps(void) {
    static double state[2 * SIZE];
    static dm_member member[2];
    const long steps = dm_jit_lanes() < 4 ? 300000 : 3000000;
    const dm_pace own[2] = {{0.01, steps, 1}, {0.02, steps / 2, 1}};
    for (int k = 0; k < 6; k++) {
        kepler one;
        told t = {0};
        uint32_t lanes = 1;
        dm_stepper *steppers[1] = {&one.s};
        CHECK(kepler_open(&one, "verlet"));
        dm_jit_limit(k % 2 ? 8 : 1);
        starts(state, 2, k / 2 == 1 ? 1 : -1);
        member[0] = member[1] = (dm_member){.status = DM_STOPPED};
        const dm_ensemble e = {.members = 2,
                               .h = 0.01,
                               .steps = steps,
                               .pace = k / 2 == 2 ? own : NULL,
                               .state = state,
                               .member = member,
                               .lanes = &lanes,
                               .progress = listen,
                               .ud = &t};
        CHECK(dm_ensemble_run(&e, steppers, 1) == DM_OK);
        CHECK(t.last == (k / 2 == 2 ? steps + steps / 2 : 2 * steps));
        CHECK(!t.back);
        if (lanes > 1 && !e.pace) CHECK(t.calls > 2); /* not at the ends of members alone */
        dm_jit_limit(8);
        dm_arena_release(&one.arena);
    }
}

int main(void) {
    RUN(progress_counts_steps, "progress counts the steps of all members");
    RUN(members_are_single_runs, "members in lanes are single runs, bit for bit");
    RUN(broken_members_leave_the_others_alone,
        "a broken member leaves the others alone and says where it stopped");
    RUN(energy_is_kept, "energy and angular momentum of every member are kept");
    RUN(refused_code_memory, "refused executable memory: members go one by one");
    return check_finish();
}
