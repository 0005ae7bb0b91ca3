/* implicit functions in graphs: closed forms, bits of backends and copies, memory that is
 * refused */
#include "algebra/derive.h"
#include "algebra/implicit.h"
#include "check.h"
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "graph/analyse.h"
#include "linalg/inverse.h"
#include "linalg/lu.h"

typedef struct {
    long left; /* requests that are granted; < 0: all */
} purse;

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    purse *p = ud;
    (void)old_size;
    if (!new_size) {
        free(block);
        return NULL;
    }
    if (p->left == 0) return NULL;
    if (p->left > 0) p->left--;
    return realloc(block, new_size);
}

static purse all = {.left = -1};

static double random_number(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53 - 0.5;
}

/* polar coordinates (rho, phi) of (x, z): rho cos phi = x, rho sin phi = z; rho > 0 */
static dm_implicit *polar(dm_arena *arena, dm_status *status) {
    dm_graph *g = dm_graph_new(arena, 4);
    *status = DM_NO_MEMORY;
    if (!g) return NULL;
    const dm_node rho = dm_input(g, 0), phi = dm_input(g, 1);
    const dm_node c = dm_apply(g, DM_OP_COS, phi, 0, 0), s = dm_apply(g, DM_OP_SIN, phi, 0, 0);
    const dm_node x = dm_mul(g, rho, c), z = dm_mul(g, rho, s);
    const dm_node F[2] = {dm_sub(g, x, dm_input(g, 2)), dm_sub(g, z, dm_input(g, 3))};
    const dm_node start[2] = {dm_constant(g, 1.0), dm_constant(g, 0.3)};
    const dm_implicit_draft draft = {.serial = 1,
                                     .name = "polar",
                                     .unknowns = 2,
                                     .inputs = 2,
                                     .starts = 1,
                                     .graph = g,
                                     .equation = F,
                                     .branch = &rho,
                                     .start = start};
    return dm_implicit_make(&draft, arena, status);
}

/* rho^3 phi of (a + b, a b) for inputs a, b of g */
static dm_node made_of(dm_graph *g, const dm_implicit *f) {
    const dm_node a = dm_input(g, 0), b = dm_input(g, 1);
    const dm_node x[2] = {dm_add(g, a, b), dm_mul(g, a, b)};
    const dm_node with = dm_implicit_with(g, dm_implicit_leaf(g, f), x, 2);
    const dm_node rho = dm_implicit_root(g, with, 0), phi = dm_implicit_root(g, with, 1);
    return dm_mul(g, dm_mul(g, rho, dm_mul(g, rho, rho)), phi);
}

/* the same with its formula */
static dm_node formula(dm_graph *g) {
    const dm_node a = dm_input(g, 0), b = dm_input(g, 1);
    const dm_node x = dm_add(g, a, b), z = dm_mul(g, a, b);
    const dm_node rho = dm_apply(g, DM_OP_SQRT, dm_add(g, dm_mul(g, x, x), dm_mul(g, z, z)), 0, 0);
    const dm_node phi = dm_apply(g, DM_OP_ATAN2, z, x, 0);
    return dm_mul(g, dm_mul(g, rho, dm_mul(g, rho, rho)), phi);
}

/* value, gradient[2], Hessian[4] */
enum { OUTPUTS = 7 };
static dm_status build(dm_kernel *out, dm_graph *g, dm_node value, dm_compile *compile,
                       dm_arena *arena) {
    dm_node roots[OUTPUTS] = {value};
    dm_hessian(g, value, 0, 2, roots + 1, roots + 3);
    if (dm_graph_status(g) != DM_OK) return dm_graph_status(g);
    return compile(out, g, roots, OUTPUTS, arena);
}

static void values(const dm_kernel *k, double a, double b, double *out) {
    const double in[2] = {a, b};
    dm_kernel_prepare(k, out);
    dm_kernel_eval(k, in, out);
}

static void closed_form(void) {
    dm_arena arena;
    dm_status status;
    dm_kernel by_root, by_form;
    uint64_t random = 7;
    dm_arena_init(&arena, allocate, &all);
    const dm_implicit *f = polar(&arena, &status);
    if (!CHECK(f && status == DM_OK)) return;
    dm_graph *g = dm_graph_new(&arena, 2), *h = dm_graph_new(&arena, 2);
    CHECK(build(&by_root, g, made_of(g, f), dm_tape_build, &arena) == DM_OK);
    CHECK(build(&by_form, h, formula(h), dm_tape_build, &arena) == DM_OK);
    for (int k = 0; k < 50; k++) {
        double x[OUTPUTS], y[OUTPUTS];
        const double a = 0.8 + random_number(&random), b = 0.9 + random_number(&random);
        values(&by_root, a, b, x);
        values(&by_form, a, b, y);
        for (int i = 0; i < OUTPUTS; i++) CHECK_NEAR(x[i], y[i], 1e-13 * (1.0 + fabs(y[i])));
    }
    dm_arena_release(&arena);
}

static void equal_calls(void) {
    dm_arena arena;
    dm_status status;
    dm_arena_init(&arena, allocate, &all);
    const dm_implicit *f = polar(&arena, &status);
    dm_graph *g = dm_graph_new(&arena, 2);
    const dm_node once = made_of(g, f);
    const uint32_t size = dm_graph_size(g);
    CHECK(made_of(g, f) == once && dm_graph_size(g) == size);
    const dm_node constants[2] = {dm_constant(g, 0.5), dm_constant(g, 1.5)};
    dm_node at;
    dm_substitute(g, &once, 1, constants, &at);
    CHECK(!dm_depends(g, &at, 1, 0, 2) && dm_depends(g, &once, 1, 1, 1));
    dm_kernel k;
    const double in[2] = {0.0, 0.0};
    double out = 0.0;
    CHECK(dm_tape_build(&k, g, &at, 1, &arena) == DM_OK);
    dm_kernel_eval(&k, in, &out);
    const double rho = sqrt(4.0 + 0.5625), phi = atan2(0.75, 2.0);
    CHECK_NEAR(out, rho * rho * rho * phi, 1e-14);
    dm_arena_release(&arena);
}

/* tape, native code, and the tape of a copy in another arena */
static void bits(void) {
    dm_arena arena, other;
    dm_status status;
    dm_kernel k[3];
    uint64_t random = 11;
    dm_arena_init(&arena, allocate, &all);
    dm_arena_init(&other, allocate, &all);
    const dm_implicit *f = polar(&arena, &status);
    dm_graph *g = dm_graph_new(&arena, 2), *copy = dm_graph_new(&other, 2);
    CHECK(build(k, g, made_of(g, f), dm_tape_build, &arena) == DM_OK);
    CHECK(build(k + 1, g, made_of(g, f), dm_native_build, &arena) == DM_OK);
    const dm_node value = made_of(copy, f);
    CHECK(dm_implicit_find(copy, 1)->graph != f->graph);
    CHECK(build(k + 2, copy, value, dm_tape_build, &other) == DM_OK);
    for (int i = 0; i < 200; i++) {
        double out[3][OUTPUTS];
        const double a = 4 * random_number(&random), b = 4 * random_number(&random);
        for (int j = 0; j < 3; j++) values(k + j, a, b, out[j]);
        CHECK(memcmp(out[0], out[1], sizeof out[0]) == 0);
        CHECK(memcmp(out[0], out[2], sizeof out[0]) == 0);
    }
    dm_arena_release(&other);
    dm_arena_release(&arena);
}

/* a kernel that remembers finds the same roots to round-off; prepared, it has forgotten: the
 * same bits as at first */
static void memory(void) {
    dm_arena arena;
    dm_status status;
    dm_kernel k;
    double cold[OUTPUTS], warm[OUTPUTS], again[OUTPUTS];
    dm_arena_init(&arena, allocate, &all);
    const dm_implicit *f = polar(&arena, &status);
    dm_graph *g = dm_graph_new(&arena, 2);
    CHECK(build(&k, g, made_of(g, f), dm_tape_build, &arena) == DM_OK && k.memory_size > 0);
    for (int i = 0; i < 100; i++) {
        const double in[2] = {0.7 + 0.01 * i, 1.3 - 0.005 * i};
        values(&k, in[0], in[1], cold);
        if (i == 0) dm_kernel_remember(&k, 1);
        for (int j = 0; j <= i; j++) {
            const double on_the_way[2] = {0.7 + 0.01 * j, 1.3 - 0.005 * j};
            if (j == 0) dm_kernel_remember(&k, 1);
            dm_kernel_eval(&k, on_the_way, warm);
        }
        for (int j = 0; j < OUTPUTS; j++)
            CHECK_NEAR(warm[j], cold[j], 1e-13 * (1.0 + fabs(cold[j])));
        values(&k, in[0], in[1], again);
        CHECK(memcmp(cold, again, sizeof cold) == 0);
    }
    dm_arena_release(&arena);
}

static void no_root(void) {
    dm_arena arena;
    dm_status status;
    dm_kernel k;
    double out[OUTPUTS];
    dm_arena_init(&arena, allocate, &all);
    const dm_implicit *f = polar(&arena, &status);
    dm_graph *g = dm_graph_new(&arena, 2);
    CHECK(build(&k, g, made_of(g, f), dm_tape_build, &arena) == DM_OK);
    values(&k, 1.0, -1.0, out); /* x = 0, z = -1 */
    CHECK(isfinite(out[0]) && !dm_root_troubled(g));
    values(&k, 0.0, 0.0, out); /* the origin has no phi */
    CHECK(isnan(out[0]) && isnan(out[1]));
    const dm_implicit *who = dm_root_troubled(g);
    CHECK(who && strcmp(who->name, "polar") == 0 && who->trouble->outcome == DM_ROOT_SINGULAR);
    dm_root_forget(g);
    CHECK(!dm_root_troubled(g));
    dm_arena_release(&arena);
}

static void refused(void) {
    for (long n = 0;; n++) {
        purse p = {.left = n};
        dm_arena arena;
        dm_status status;
        dm_kernel k = {.outputs = 77};
        dm_arena_init(&arena, allocate, &p);
        const dm_implicit *f = polar(&arena, &status);
        dm_graph *g = f ? dm_graph_new(&arena, 2) : NULL;
        const dm_status built =
            g ? build(&k, g, made_of(g, f), dm_tape_build, &arena) : DM_NO_MEMORY;
        dm_arena_release(&arena);
        CHECK(built == DM_OK || (built == DM_NO_MEMORY && k.outputs == 77));
        if (built == DM_OK) return;
    }
}

static void inverses(void) {
    enum { MOST = 9 };
    uint64_t random = 3;
    for (uint32_t n = 1; n <= MOST; n++) {
        double A[MOST * MOST], inverse[MOST * MOST], LU[MOST * MOST];
        uint32_t pivot[MOST];
        for (uint32_t i = 0; i < n * n; i++) A[i] = random_number(&random);
        if (n > 1) A[0] = 0.0; /* exchanges are needed */
        memcpy(inverse, A, sizeof A);
        memcpy(LU, A, sizeof A);
        CHECK(dm_invert(inverse, pivot, n) == DM_OK);
        CHECK(dm_lu_factor(LU, pivot, n) == DM_OK);
        for (uint32_t k = 0; k < n; k++) {
            double x[MOST] = {0.0};
            x[k] = 1.0;
            dm_lu_solve(x, LU, pivot, n);
            for (uint32_t i = 0; i < n; i++)
                CHECK_NEAR(inverse[i * n + k], x[i], 1e-11 * (1.0 + fabs(x[i])));
        }
    }
    double singular[4] = {1.0, 2.0, 2.0, 4.0}, bad[1] = {NAN};
    uint32_t pivot[2];
    CHECK(dm_invert(singular, pivot, 2) == DM_SINGULAR);
    CHECK(dm_invert(bad, pivot, 1) == DM_NOT_FINITE);
}

int main(void) {
    RUN(closed_form, "value, gradient and Hessian of polar coordinates are those of the formula");
    RUN(equal_calls, "equal calls are one node, substitution reaches the arguments");
    RUN(bits, "tape, native code and a copy in another arena give the same bits");
    RUN(memory, "what a kernel remembers changes round-off only, and is forgotten when "
                "it is prepared");
    RUN(no_root, "no root is NaN, and its reason is kept");
    RUN(refused, "memory refused anywhere is a status, and nothing is lost");
    RUN(inverses, "inverses of small matrices against LU; singular and NaN are refused");
    return check_finish();
}
