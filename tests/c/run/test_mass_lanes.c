/* pivots of many masses side by side have the bits that dm_all_positive finds for each alone; quiet
 * looks at many members leave what looks at each of them leave; many masses are looked at as one */
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "integ/method/cache.h"
#include "linalg/signature.h"
#include "numbers/processor.h"
#include "run/inertia/inertia_look.h"
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

static void make_masses(double *M, const dm_blocks *blocks, uint32_t lanes, double shift) {
    for (uint32_t b = 0; b < blocks->count; b++) {
        const uint32_t n = dm_block_size(blocks, b);
        make_mass(M, n, lanes, shift);
        M += n * (n + 1) / 2 * lanes;
    }
}

/* of a block of one lane, whose M and scales begin there: as a look alone has it */
static int alone(const double *M, const double *scale, uint32_t n, uint32_t lanes,
                 dm_inertia_value *out) {
    double A[MOST * MOST];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++, M += lanes)
            A[i * n + j] = scale[i * lanes] * *M * scale[j * lanes];
    return dm_all_positive(A, n, FAR, &out->least, &out->all);
}

static void compare(const dm_mass_lanes *w, uint32_t asked, long *some) {
    const uint32_t told = w->pivots(w, w->scale, FAR, asked), lanes = w->lanes;
    for (uint32_t l = 0; l < lanes; l++) {
        const double *M = w->M + l, *scale = w->scale + l;
        dm_inertia_value own[MOST];
        int fine = asked >> l & 1;
        for (uint32_t b = 0; b < w->blocks.count; b++) {
            const uint32_t n = dm_block_size(&w->blocks, b);
            fine &= alone(M, scale, n, lanes, own + b);
            M += n * (n + 1) / 2 * lanes, scale += n * lanes;
        }
        CHECK(fine == (int)(told >> l & 1));
        for (uint32_t b = 0; b < w->blocks.count && fine; b++)
            CHECK(memcmp(&w->least[b * lanes + l], &own[b].least, sizeof own->least) == 0 &&
                  w->all[b * lanes + l] == own[b].all);
        *some += fine;
    }
}

/* n coordinates as blocks of so many rows, the last one of what is left; room[2n + 1] */
static dm_blocks cut(uint32_t n, uint32_t rows, uint32_t *room) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) room[i] = i;
    for (uint32_t i = 0; i < n; i += rows) room[n + count++] = i;
    room[n + count] = n;
    return (dm_blocks){.count = count, .order = room, .first = room + n};
}

static void compare_all(uint32_t lanes, dm_mass_lanes_pivots *pivots) {
    static _Alignas(64) double M[MOST * MOST * 8], A[MOST * MOST * 8], scale[MOST * 8];
    static _Alignas(64) double out[2 * MOST * 8];
    long some = 0, all = 0;
    for (uint32_t n = 1; n <= MOST; n++)
        for (int k = 0; k < TRIES; k++) {
            uint32_t room[2 * MOST + 1];
            dm_mass_lanes w = {.n = n,
                               .lanes = lanes,
                               .blocks = cut(n, k % 5 ? n : 1 + (uint32_t)k / 5 % n, room),
                               .M = M,
                               .A = A,
                               .scale = scale,
                               .least = out,
                               .all = out + MOST * 8,
                               .pivots = pivots};
            for (uint32_t l = 0; l < lanes; l++)
                make_masses(M + l, &w.blocks, lanes, k % 3 ? 0.01 : -0.1);
            for (uint32_t i = 0; i < n * lanes; i++) scale[i] = 1.0 + 0.5 * any();
            if (k % 50 == 0) M[0] = NAN;
            compare(&w, k % 4 ? (1u << lanes) - 1 : 5u, &some);
            all += lanes;
        }
    CHECK(some > all / 4 && some < all);
}

/* ---- quiet looks ---- */

enum { LOOKS = 20000, LANES = 8, BLOCKS = 3 };

/* between 1/e and e, sometimes zero */
static double any_value(void) {
    return any() > 0.95 ? 0.0 : exp(any());
}

/* members, the courses of their blocks, and what was found of these */
typedef struct {
    dm_inertia_seen seen[LANES];
    dm_inertia_course course[LANES][BLOCKS];
} members;

static _Alignas(64) double least[BLOCKS * LANES], all[BLOCKS * LANES], between[BLOCKS * LANES];
static _Alignas(64) double times[LANES], noted[sizeof(dm_inertia_course) * BLOCKS * LANES];

static void make_course(dm_inertia_course *c) {
    *c = (dm_inertia_course){.least = any_value(), .all = any_value()};
    c->nearest = 1.0 + 10.0 * fabs(any()), c->left = any() > 0.0 ? INFINITY : c->nearest;
    c->fell = any() > 0.0, c->rate = any(), c->way = any() > -0.5 ? 3.0 : 0.0;
    c->turn = any() > 0.0 ? 0.3 * any() : 0.0, c->ones = any() > 0.5 ? 0.1 * any_value() : 0.0;
    c->reach = 1.0 + fabs(any()) * 20.0;
}

static void make_members(members *m, uint32_t lanes, uint32_t blocks, long done) {
    memset(m, 0, sizeof *m);
    for (uint32_t l = 0; l < lanes; l++) {
        m->seen[l].negative = any() > 0.9;
        m->seen[l].known = 1;
        m->seen[l].looked = done - (long)(4.0 * (1.0 + any()));
        times[l] = any();
        for (uint32_t b = 0; b < blocks; b++) {
            const uint32_t at = b * lanes + l;
            make_course(&m->course[l][b]);
            least[at] = m->course[l][b].least * exp(0.5 * any());
            all[at] = m->course[l][b].all * exp(0.5 * any());
            between[at] = all[at] * (1.0 + any());
        }
    }
}

/* what one look leaves: every number is finite, the next look is ahead; as the most urgent block
 * has it */
static void check_left(const dm_inertia_seen *s, const dm_inertia_course *c, uint32_t blocks,
                       long done) {
    CHECK(s->due > done && s->due <= done + 512);
    CHECK(s->looked == done && isfinite(s->least));
    for (uint32_t b = 0; b < blocks; b++) {
        CHECK(c[b].reach >= 1.0 && c[b].reach <= 512.0);
        CHECK(s->due <= done + (long)c[b].reach);
        CHECK(s->least <= c[b].least && s->left <= c[b].left);
    }
}

static dm_mass_found found_of(members *m, uint32_t lane, int lines) {
    return (dm_mass_found){.course = m->course[lane],
                           .apart = BLOCKS * sizeof(dm_inertia_course) / sizeof(double),
                           .least = least + lane,
                           .all = all + lane,
                           .between = lines ? between + lane : NULL,
                           .t = times + lane};
}

/* one lane of them alone, whose numbers are `lanes` apart */
static uint32_t look_alone(members *m, uint32_t lane, uint32_t lanes, uint32_t blocks, int lines,
                           long done) {
    double own[3][BLOCKS];
    uint32_t room[2 * BLOCKS + 1];
    const dm_mass_lanes w = {.lanes = 1, .blocks = cut(blocks, 1, room), .noted = noted};
    dm_mass_found f = found_of(m, lane, lines);
    for (uint32_t b = 0; b < blocks; b++) {
        const uint32_t at = b * lanes + lane;
        own[0][b] = least[at], own[1][b] = all[at], own[2][b] = between[at];
    }
    f.least = own[0], f.all = own[1];
    if (lines) f.between = own[2];
    return look_quietly(&w, m->seen + lane, &f, done, 1);
}

static void compare_quiet(uint32_t lanes, dm_mass_lanes_quiet *quiet) {
    long some = 0;
    for (long k = 0; k < LOOKS; k++) {
        uint32_t room[2 * BLOCKS + 1];
        const uint32_t blocks = k % 4 ? 1 : 1 + (uint32_t)(k / 4) % BLOCKS;
        const dm_mass_lanes w = {.lanes = lanes, .blocks = cut(blocks, 1, room), .noted = noted};
        members side, one;
        const long done = 1000 + k;
        const int lines = k % 2 != 0;
        const uint32_t asked = (uint32_t)(state % (1u << lanes));
        make_members(&side, lanes, blocks, done);
        one = side;
        const dm_mass_found f = found_of(&side, 0, lines);
        const uint32_t told = quiet(&w, side.seen, &f, done, asked);
        for (uint32_t l = 0; l < lanes; l++) {
            const uint32_t alone =
                asked >> l & 1 ? look_alone(&one, l, lanes, blocks, lines, done) : 0;
            CHECK(alone == (told >> l & 1));
            if (alone) check_left(side.seen + l, side.course[l], blocks, done);
            some += alone;
        }
        CHECK(memcmp(&side, &one, sizeof side) == 0);
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
    uint32_t room[3];
    const dm_model m = {.n = 1,
                        .mass_blocks = dm_blocks_whole(1, room),
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

/* ---- how often many masses that move alike are looked at ---- */

static long evaluations;
static dm_kernel counted;

static void count_mass(const void *pool, const double *in, double *out) {
    evaluations++;
    counted.eval(pool, in, out);
}

/* sum_i exp(-q_i) v_i^2/2 */
static dm_node alike(dm_graph *g, uint32_t n) {
    dm_node L = 0;
    for (uint32_t i = 0; i < n; i++) {
        const dm_node v = dm_input(g, n + i), minus = dm_sub(g, 0, dm_input(g, i));
        const dm_node M = dm_apply(g, DM_OP_EXP, minus, 0, 0);
        L = dm_add(g, L, dm_mul(g, dm_constant(g, 0.5), dm_mul(g, M, dm_mul(g, v, v))));
    }
    return L;
}

/* (sum_i v_i^2 + (sum_i v_i)^2/n) exp(-mean of q)/4: with all q_i alike their motion is the same */
static dm_node as_a_whole(dm_graph *g, uint32_t n) {
    dm_node squares = 0, sum = 0, mean = 0;
    const dm_node part = dm_constant(g, 1.0 / n);
    for (uint32_t i = 0; i < n; i++) {
        const dm_node v = dm_input(g, n + i);
        squares = dm_add(g, squares, dm_mul(g, v, v));
        sum = dm_add(g, sum, v);
        mean = dm_add(g, mean, dm_mul(g, part, dm_input(g, i)));
    }
    const dm_node T = dm_add(g, squares, dm_mul(g, part, dm_mul(g, sum, sum)));
    const dm_node M = dm_apply(g, DM_OP_EXP, dm_sub(g, 0, mean), 0, 0);
    return dm_mul(g, dm_constant(g, 0.25), dm_mul(g, M, T));
}

/* From q = 0, v = 1/2: exp(-q/2) = 1 - t/4, p = (1 - t/4)/2. How often M, of so many blocks, is
 * found in steps of 0.02 up to t = 3, when it is looked at as is due. */
static long looks_at(dm_node make(dm_graph *, uint32_t), uint32_t n, uint32_t blocks) {
    enum { STEPS = 150, ROOM = 4 * 64 + 8 };
    static double at[ROOM];
    const double h = 0.02;
    dm_arena arena;
    dm_arena_init(&arena, allocate, NULL);
    dm_graph *g = dm_graph_new(&arena, 2 * n + 1);
    dm_model m;
    CHECK(dm_model_build(&m, g, make(g, n), n, DM_WANT_MASS, dm_tape_build, &arena) == DM_OK);
    CHECK(m.mass_blocks.count == blocks);
    counted = m.mass;
    m.mass.eval = count_mass;
    evaluations = 0;
    double *room = malloc(dm_inertia_work(&m, 0, 1) * sizeof *room);
    dm_inertia x;
    dm_inertia_open(&x, &m, 0, room);
    for (long k = 0; k <= STEPS; k++) {
        const double left = 1.0 - 0.25 * h * (double)k;
        for (uint32_t i = 0; i < n; i++) at[i] = -2.0 * log(left), at[n + i] = 0.5 * left;
        if (k == 0) CHECK(dm_inertia_begin(&x, at, 0.0, h) == DM_OK);
        if (k == 0 || k < x.seen.due) continue;
        CHECK(dm_inertia_look(&x, at, h * (double)k, k, NULL) == 0);
        dm_inertia_go_on(&x, at, h * (double)k);
    }
    free(room);
    dm_arena_release(&arena);
    return evaluations;
}

/* the product of all moves n times as fast as one */
static void many_alike(void) {
    const long few = looks_at(alike, 13, 13);
    CHECK(few > 5 && few < 60);
    CHECK(looks_at(alike, 30, 30) == few && looks_at(alike, 60, 60) == few);
    for (uint32_t n = 13; n <= 60; n++) CHECK(looks_at(as_a_whole, n, 1) == few);
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
    RUN(many_alike, "many masses that move alike are looked at as often as one");
    RUN(never_again, "a model whose masses cannot be side by side is not asked again");
    return check_finish();
}
