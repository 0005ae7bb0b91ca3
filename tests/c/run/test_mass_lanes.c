/* pivots of many masses side by side have the bits that dm_all_positive finds for each alone; quiet
 * looks at many members leave what looks at each of them leave */
#include "code/native/jit.h"
#include "integ/method/cache.h"
#include "linalg/signature.h"
#include "numbers/processor.h"
#include "run/inertia/mass_lanes.h"

#include "check.h"

#define W 1
#define HOW
#define DM_LANES_FUSED 0
#include "run/inertia/mass_lanes_text.h"

enum { MOST = 7, TRIES = 400 };
static const double FAR = 1e-3;
static uint64_t state = 88172645463325252u;

/* in [-1, 1), xorshift (Marsaglia 2003) */
static double any(void) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (double)(int64_t)state / 9223372036854775808.0;
}

/* M = B B^T + shift, its lower triangle row by row; a shift below zero makes some indefinite */
static void make_mass(double *M, uint32_t n, uint32_t lanes, double shift) {
    double B[MOST * MOST];
    for (uint32_t i = 0; i < n * n; i++) B[i] = any();
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, M += lanes) {
            *M = i == j ? shift : 0.0;
            for (uint32_t k = 0; k < n; k++) *M += B[i * n + k] * B[j * n + k];
        }
}

/* of one lane: as a look alone has it */
static int alone(const dm_mass_lanes *w, uint32_t lane, double *least, double *all) {
    const uint32_t n = w->n;
    const double *M = w->M + lane;
    double A[MOST * MOST];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, M += w->lanes)
            A[i * n + j] = w->scale[i * w->lanes + lane] * *M * w->scale[j * w->lanes + lane];
    const int fine = dm_all_positive(A, n, FAR, least);
    *all = 1.0;
    for (uint32_t i = 0; i < n; i++) *all *= A[i * n + i];
    return fine;
}

static void compare(const dm_mass_lanes *w, uint32_t asked, long *some) {
    const uint32_t told = w->pivots(w, w->scale, FAR, asked);
    for (uint32_t l = 0; l < w->lanes; l++) {
        double least, all;
        const int fine = alone(w, l, &least, &all) && (asked >> l & 1);
        CHECK(fine == (int)(told >> l & 1));
        if (fine) CHECK(memcmp(&w->least[l], &least, sizeof least) == 0 && w->all[l] == all);
        *some += fine;
    }
}

static void compare_all(uint32_t lanes, dm_mass_lanes_pivots *pivots) {
    static _Alignas(64) double M[MOST * MOST * 8], A[MOST * MOST * 8], scale[MOST * 8], out[16];
    long some = 0, all = 0;
    for (uint32_t n = 1; n <= MOST; n++)
        for (int k = 0; k < TRIES; k++) {
            dm_mass_lanes w = {.n = n,
                               .lanes = lanes,
                               .M = M,
                               .A = A,
                               .scale = scale,
                               .least = out,
                               .all = out + 8,
                               .pivots = pivots};
            for (uint32_t l = 0; l < lanes; l++) make_mass(M + l, n, lanes, k % 3 ? 0.01 : -0.1);
            for (uint32_t i = 0; i < n * lanes; i++) scale[i] = 1.0 + 0.5 * any();
            if (k % 50 == 0) M[0] = NAN;
            compare(&w, k % 4 ? (1u << lanes) - 1 : 5u, &some);
            all += lanes;
        }
    CHECK(some > all / 4 && some < all);
}

/* ---- quiet looks ---- */

enum { LOOKS = 20000, LANES = 8 };

/* between 1/e and e, sometimes zero */
static double any_value(void) {
    return any() > 0.95 ? 0.0 : exp(any());
}

static void make_seen(dm_inertia_seen *s, long done) {
    memset(s, 0, sizeof *s);
    s->negative = any() > 0.9;
    s->known = 1;
    s->looked = done - (long)(4.0 * (1.0 + any()));
    s->least = any_value(), s->all = any_value();
    s->nearest = 1.0 + 10.0 * fabs(any()), s->left = any() > 0.0 ? INFINITY : s->nearest;
    s->fell = any() > 0.0, s->rate = any(), s->way = any() > -0.5 ? 3.0 : 0.0;
    s->turn = any() > 0.0 ? 0.3 * any() : 0.0, s->ones = any() > 0.5 ? 0.1 * any_value() : 0.0;
    s->reach = 1.0 + fabs(any()) * 20.0;
}

/* what one look leaves: every number is finite, the next look is ahead */
static void check_left(const dm_inertia_seen *s, long done) {
    CHECK(s->due > done && s->due <= done + 512);
    CHECK(s->looked == done && s->reach >= 1.0 && s->reach <= 512.0);
    CHECK(s->due <= done + (long)s->reach && isfinite(s->least));
}

static void compare_quiet(uint32_t lanes, dm_mass_lanes_quiet *quiet) {
    static _Alignas(64) double least[LANES], all[LANES], between[LANES], t[LANES];
    long some = 0;
    for (long k = 0; k < LOOKS; k++) {
        dm_inertia_seen seen[LANES], one[LANES];
        const long done = 1000 + k;
        const uint32_t asked = (uint32_t)(state % (1u << lanes));
        for (uint32_t l = 0; l < lanes; l++) {
            make_seen(seen + l, done);
            one[l] = seen[l];
            least[l] = seen[l].least * exp(0.5 * any()), all[l] = seen[l].all * exp(0.5 * any());
            between[l] = all[l] * (1.0 + any()), t[l] = any();
        }
        const double *middle = k % 2 ? between : NULL;
        const uint32_t told = quiet(seen, least, all, middle, t, done, asked);
        for (uint32_t l = 0; l < lanes; l++) {
            const double *own = middle ? middle + l : NULL;
            const uint32_t alone =
                look_quietly(one + l, least + l, all + l, own, t + l, done, asked >> l & 1);
            CHECK(alone == (told >> l & 1));
            CHECK(memcmp(seen + l, one + l, sizeof *seen) == 0);
            if (alone) check_left(seen + l, done);
            some += alone;
        }
    }
    CHECK(some > LOOKS / 4);
}

static void quiet_looks(void) {
    dm_mass_lanes_quiet *four = NULL, *eight = NULL;
#ifdef __x86_64__
    four = dm_mass_quiet_avx, eight = dm_mass_quiet_avx512;
#endif
    if (four && dm_processor() >= DM_FMA) compare_quiet(4, four);
    if (eight && dm_processor() == DM_AVX512) compare_quiet(8, eight);
}

/* ---- a model that has no lanes ---- */

static int refuses;

static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    (void)ud, (void)old_size;
    if (new_size) return refuses ? NULL : realloc(block, new_size);
    free(block);
    return NULL;
}

static void no_mass(const void *pool, const double *in, double *out) {
    (void)pool, (void)in, (void)out;
}

/* its graph has failed, so that no kernel can be made of it: that is tried once */
static void never_again(void) {
    dm_arena arena;
    dm_arena_init(&arena, allocate, NULL);
    dm_graph *g = dm_graph_new(&arena, 3);
    const dm_node one = dm_constant(g, 1.0), roots[5] = {one, one, one, one, one};
    refuses = 1;
    for (double x = 2.0; dm_graph_status(g) == DM_OK; x += 1.0) dm_constant(g, x);
    refuses = 0;
    dm_cache_entry *cache = NULL;
    const dm_model m = {.n = 1,
                        .structure = DM_QUADRATIC_IN_V,
                        .mass = {.eval = no_mass},
                        .source = {.arena = &arena,
                                   .cache = &cache,
                                   .stage_graph = g,
                                   .stage = roots,
                                   .compile = dm_native_build}};
    const dm_lanes lanes = {.lanes = 4};
    CHECK(dm_mass_lanes_open(&m, &lanes) == NULL);
    const size_t used = arena.used, total = arena.total;
    CHECK(dm_mass_lanes_open(&m, &lanes) == NULL);
    CHECK(arena.used == used && arena.total == total);
    dm_arena_release(&arena);
}

static void sides(void) {
    dm_mass_lanes_pivots *four = NULL, *eight = NULL;
#ifdef __x86_64__
    four = dm_mass_pivots_avx, eight = dm_mass_pivots_avx512;
#endif
    if (four && dm_processor() >= DM_FMA) compare_all(4, four);
    if (eight && dm_processor() == DM_AVX512) compare_all(8, eight);
}

int main(void) {
    RUN(sides, "pivots of masses side by side are those of each alone, to the bit");
    RUN(quiet_looks, "quiet looks side by side leave what they leave alone, to the bit");
    RUN(never_again, "a model whose masses cannot be side by side is not asked again");
    return check_finish();
}
