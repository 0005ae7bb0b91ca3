/* matching.c - coreductions and collapses, and chains that flow along the pairs. */
#include "dec/homology/matching.h"

#include <string.h>

/* ---- pairs ---- */

/* A complex that is being taken apart; cells wait in `queue` until they may go. */
typedef struct {
    dm_matching *M;
    const dm_complex *K;
    uint8_t *alive[DM_DIMENSION + 1];
    uint8_t *faces[DM_DIMENSION + 1];    /* of cell i, how many are alive */
    uint32_t *cofaces[DM_DIMENSION + 1]; /* the same of cofaces; only for collapses */
    uint8_t *queue_degree;
    uint32_t *queue; /* a ring of `room` entries */
    size_t room, head, length;
    volatile const int *stop;
    uint32_t polls;
    int stopped; /* *stop was seen: nobody comes any more */
} taking;

static int sign_of(uint32_t place) {
    return place % 2 ? -1 : 1;
}

/* [b : a] for a face a of cell b of degree k */
static int incidence(const dm_complex *K, uint32_t k, uint32_t b, uint32_t a) {
    const uint32_t *face = K->face[k] + (size_t)b * (k + 1);
    uint32_t j = 0;
    while (face[j] != a) j++;
    return sign_of(j);
}

/* A cell waits at most once for each of its faces or cofaces, so the ring is never full. */
static void wait_for(taking *t, uint32_t k, uint32_t cell) {
    const size_t at = (t->head + t->length++) % t->room;
    t->queue_degree[at] = (uint8_t)k;
    t->queue[at] = cell;
}

static int is_somebody_waiting(taking *t) {
    enum { EVERY = 8192 };
    if (++t->polls % EVERY == 0 && t->stop && *t->stop) t->stopped = 1;
    return t->length > 0 && !t->stopped;
}

static uint32_t next_waiting(taking *t, uint32_t *k) {
    const uint32_t cell = t->queue[t->head];
    *k = t->queue_degree[t->head];
    t->head = (t->head + 1) % t->room;
    t->length--;
    return cell;
}

static uint32_t cofaces_of(const dm_complex *K, uint32_t k, uint32_t cell, const uint32_t **list) {
    if (k == K->n) return 0;
    const uint32_t from = K->coface_at[k][cell];
    *list = K->coface[k] + from;
    return K->coface_at[k][cell + 1] - from;
}

static void put_last(dm_matching *M, uint32_t k, uint32_t cell) {
    M->time[k][cell] = M->present[k];
    M->order[k][M->present[k]++] = cell;
}

static void make_pair(dm_matching *M, uint32_t k, uint32_t a, uint32_t b) {
    M->kind[k][a] = DM_CELL_LOWER;
    M->kind[k + 1][b] = DM_CELL_UPPER;
    M->partner[k][a] = b;
    M->partner[k + 1][b] = a;
}

/* ---- coreductions: from nothing upwards ---- */

/* the cell has come; cofaces that lack one face now may come with it */
static void come(taking *t, uint32_t k, uint32_t cell) {
    const uint32_t *list = NULL;
    const uint32_t count = cofaces_of(t->K, k, cell, &list);
    t->alive[k][cell] = 0;
    put_last(t->M, k, cell);
    for (uint32_t j = 0; j < count; j++)
        if (t->alive[k + 1][list[j]] && --t->faces[k + 1][list[j]] == 1)
            wait_for(t, k + 1, list[j]);
}

static void come_in_pairs(taking *t) {
    while (is_somebody_waiting(t)) {
        uint32_t k = 0;
        const uint32_t b = next_waiting(t, &k);
        if (!t->alive[k][b] || t->faces[k][b] != 1) continue;
        const uint32_t *face = t->K->face[k] + (size_t)b * (k + 1);
        while (!t->alive[k - 1][*face]) face++;
        make_pair(t->M, k - 1, *face, b);
        come(t, k - 1, *face);
        come(t, k, b);
    }
}

static void come_alone(taking *t, uint32_t k, uint32_t cell) {
    t->M->kind[k][cell] = DM_CELL_CRITICAL;
    come(t, k, cell);
    come_in_pairs(t);
}

/* Every cell comes: in pairs as long as there are any, then the first one of the lowest degree,
 * all of whose faces are there, alone. */
static dm_status coreduce(taking *t, uint32_t hub) {
    come_in_pairs(t); /* beside a part that is taken as nothing */
    if (hub != UINT32_MAX && t->alive[0][hub]) come_alone(t, 0, hub);
    for (uint32_t k = 0; k <= t->K->n; k++)
        for (uint32_t i = 0; i < t->K->count[k] && !t->stopped; i++)
            if (t->alive[k][i]) come_alone(t, k, i);
    return t->stopped ? DM_STOPPED : DM_OK;
}

/* ---- collapses: from the whole downwards ---- */

static int is_free(const taking *t, uint32_t k, uint32_t a, uint32_t hub) {
    return t->alive[k][a] && t->cofaces[k][a] == 1 && !(k == 0 && a == hub);
}

static void leave(taking *t, uint32_t k, uint32_t cell) {
    t->alive[k][cell] = 0;
    for (uint32_t j = 0; k > 0 && j <= k; j++) {
        const uint32_t face = t->K->face[k][(size_t)cell * (k + 1) + j];
        if (t->alive[k - 1][face] && --t->cofaces[k - 1][face] == 1) wait_for(t, k - 1, face);
    }
}

static uint32_t living_coface(const taking *t, uint32_t k, uint32_t a) {
    const uint32_t *list = NULL;
    cofaces_of(t->K, k, a, &list);
    while (!t->alive[k + 1][*list]) list++;
    return *list;
}

/* Pairs in the order in which they leave: `lower` [2 * pairs] holds degree and cell of each a. */
static uint32_t collapse(taking *t, uint32_t hub, uint32_t *lower) {
    uint32_t pairs = 0;
    for (uint32_t k = t->K->n; k-- > 0;)
        for (uint32_t i = 0; i < t->K->count[k]; i++)
            if (t->alive[k][i] && t->cofaces[k][i] == 1) wait_for(t, k, i);
    while (is_somebody_waiting(t)) {
        uint32_t k = 0;
        const uint32_t a = next_waiting(t, &k);
        if (!is_free(t, k, a, hub)) continue;
        const uint32_t b = living_coface(t, k, a);
        make_pair(t->M, k, a, b);
        lower[2 * pairs] = k;
        lower[2 * pairs++ + 1] = a;
        leave(t, k + 1, b);
        leave(t, k, a);
    }
    return pairs;
}

/* what left last comes first */
static void come_back(dm_matching *M, const uint32_t *lower, uint32_t pairs) {
    while (pairs-- > 0) {
        const uint32_t k = lower[2 * pairs], a = lower[2 * pairs + 1];
        put_last(M, k, a);
        put_last(M, k + 1, M->partner[k][a]);
    }
}

/* ---- the whole ---- */

/* who is alive, and how many faces and cofaces of everybody are */
static void count_living(taking *t, const dm_matching_wish *wish) {
    const dm_complex *K = t->K;
    for (uint32_t k = 0; k <= K->n; k++)
        for (uint32_t i = 0; i < K->count[k]; i++) {
            t->alive[k][i] = !(wish->absent[k] && wish->absent[k][i]);
            t->M->kind[k][i] = DM_CELL_ABSENT;
            t->faces[k][i] = 0;
            if (t->cofaces[k]) t->cofaces[k][i] = 0;
            for (uint32_t j = 0; t->alive[k][i] && k > 0 && j <= k; j++) {
                const uint32_t face = K->face[k][(size_t)i * (k + 1) + j];
                t->faces[k][i] = (uint8_t)(t->faces[k][i] + t->alive[k - 1][face]);
                if (t->cofaces[k - 1]) t->cofaces[k - 1][face]++;
            }
        }
    for (uint32_t k = 1; k <= K->n; k++)
        for (uint32_t i = 0; i < K->count[k]; i++)
            if (t->alive[k][i] && t->faces[k][i] == 1) wait_for(t, k, i);
}

/* after collapses: faces of those that are left are all alive, for what is left is a complex */
static void count_core(taking *t) {
    t->head = t->length = 0;
    for (uint32_t k = 0; k <= t->K->n; k++)
        for (uint32_t i = 0; i < t->K->count[k]; i++) t->M->core[k] += t->alive[k][i];
}

static int take_arrays(dm_matching *M, taking *t, dm_arena *arena, dm_arena *scratch,
                       int with_cofaces) {
    size_t pairs = 1;
    int fine = 1;
    for (uint32_t k = 0; k <= t->K->n; k++) {
        const size_t count = (size_t)t->K->count[k] + 1;
        pairs += (k + 1) * count;
        fine &= (M->kind[k] = dm_arena_take(arena, count)) != NULL;
        fine &= (M->partner[k] = dm_arena_take(arena, count * sizeof(uint32_t))) != NULL;
        fine &= (M->order[k] = dm_arena_take(arena, count * sizeof(uint32_t))) != NULL;
        fine &= (M->time[k] = dm_arena_take(arena, count * sizeof(uint32_t))) != NULL;
        fine &= (t->alive[k] = dm_arena_take(scratch, count)) != NULL;
        fine &= (t->faces[k] = dm_arena_take(scratch, count)) != NULL;
        if (with_cofaces)
            fine &= (t->cofaces[k] = dm_arena_take(scratch, count * sizeof(uint32_t))) != NULL;
    }
    t->room = pairs;
    t->queue = dm_arena_take(scratch, pairs * sizeof *t->queue);
    t->queue_degree = dm_arena_take(scratch, pairs);
    return fine && t->queue && t->queue_degree;
}

static dm_status list_criticals(dm_matching *M, dm_arena *arena) {
    for (uint32_t k = 0; k <= M->K->n; k++) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < M->K->count[k]; i++) count += M->kind[k][i] == DM_CELL_CRITICAL;
        M->critical[k] = dm_arena_take(arena, ((size_t)count + 1) * sizeof(uint32_t));
        if (!M->critical[k]) return DM_NO_MEMORY;
        M->criticals[k] = 0;
        for (uint32_t i = 0; i < M->K->count[k]; i++)
            if (M->kind[k][i] == DM_CELL_CRITICAL) M->critical[k][M->criticals[k]++] = i;
    }
    return DM_OK;
}

dm_status dm_matching_build(dm_matching *M, dm_arena *arena, const dm_complex *K,
                            const dm_matching_wish *wish, volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    taking t = {.M = M, .K = K, .stop = stop};
    uint32_t pairs = 0, *lower = NULL;
    *M = (dm_matching){.K = K};
    if (!scratch || !take_arrays(M, &t, arena, scratch, wish->collapse)) return DM_NO_MEMORY;
    count_living(&t, wish);
    if (wish->collapse) {
        lower = dm_arena_take(scratch, t.room * 2 * sizeof *lower);
        if (!lower) return DM_NO_MEMORY;
        t.head = t.length = 0;
        pairs = collapse(&t, wish->hub, lower);
        count_core(&t);
    }
    const dm_status status = coreduce(&t, wish->hub);
    if (status != DM_OK) return status;
    come_back(M, lower, pairs);
    return list_criticals(M, arena);
}

/* ---- chains ---- */

dm_status dm_flow_open(dm_flow *w, dm_arena *arena, const dm_matching *M, uint32_t k) {
    const size_t count = (size_t)M->K->count[k] + 1;
    *w = (dm_flow){.M = M, .k = k};
    w->sum = dm_arena_take(arena, count * sizeof *w->sum);
    w->listed = dm_arena_take(arena, count);
    w->heap = dm_arena_take(arena, count * sizeof *w->heap);
    w->upper = dm_arena_take(arena, count * sizeof *w->upper);
    w->rest = dm_arena_take(arena, count * sizeof *w->rest);
    if (!w->sum || !w->listed || !w->heap || !w->upper || !w->rest) return DM_NO_MEMORY;
    memset(w->sum, 0, count * sizeof *w->sum);
    memset(w->listed, 0, count);
    return DM_OK;
}

static void push(dm_flow *w, uint32_t time) {
    uint32_t i = w->heaped++;
    for (; i > 0 && w->heap[(i - 1) / 2] < time; i = (i - 1) / 2) w->heap[i] = w->heap[(i - 1) / 2];
    w->heap[i] = time;
}

static uint32_t pop(dm_flow *w) {
    const uint32_t top = w->heap[0], last = w->heap[--w->heaped];
    uint32_t i = 0, child = 1;
    for (; child < w->heaped; i = child, child = 2 * i + 1) {
        if (child + 1 < w->heaped && w->heap[child + 1] > w->heap[child]) child++;
        if (w->heap[child] <= last) break;
        w->heap[i] = w->heap[child];
    }
    w->heap[i] = last;
    return top;
}

int dm_flow_add(dm_flow *w, uint32_t cell, int64_t x) {
    const uint8_t kind = w->M->kind[w->k][cell];
    if (kind == DM_CELL_ABSENT) return 1;
    if (__builtin_add_overflow(w->sum[cell], x, &w->sum[cell])) return 0;
    if (!w->listed[cell]) {
        w->listed[cell] = 1;
        push(w, w->M->time[w->k][cell]);
    }
    return 1;
}

/* x a is replaced by -c x tau, which came before, and x c b is noted */
static int replace(dm_flow *w, uint32_t a, int64_t x) {
    const dm_complex *K = w->M->K;
    const uint32_t b = w->M->partner[w->k][a], k = w->k + 1;
    const uint32_t *face = K->face[k] + (size_t)b * (k + 1);
    int64_t cx = 0;
    if (__builtin_mul_overflow(x, (int64_t)incidence(K, k, b, a), &cx)) return 0;
    w->upper[w->uppers++] = (dm_term){b, cx};
    for (uint32_t j = 0; j <= k; j++) {
        int64_t share = 0;
        if (face[j] == a) continue;
        if (__builtin_mul_overflow(cx, (int64_t)-sign_of(j), &share)) return 0;
        if (!dm_flow_add(w, face[j], share)) return 0;
    }
    return 1;
}

static void forget(dm_flow *w) {
    while (w->heaped) {
        const uint32_t cell = w->M->order[w->k][w->heap[--w->heaped]];
        w->sum[cell] = 0;
        w->listed[cell] = 0;
    }
}

dm_status dm_flow_run(dm_flow *w, volatile const int *stop) {
    w->uppers = w->rests = 0;
    for (uint32_t polls = 0; w->heaped;) {
        const uint32_t cell = w->M->order[w->k][pop(w)];
        const int64_t x = w->sum[cell];
        const uint8_t kind = w->M->kind[w->k][cell];
        w->sum[cell] = 0;
        w->listed[cell] = 0;
        if (x == 0) continue;
        if (kind == DM_CELL_CRITICAL) w->rest[w->rests++] = (dm_term){cell, x};
        const int fine = kind != DM_CELL_LOWER || replace(w, cell, x);
        if (!fine || (++polls % 65536 == 0 && stop && *stop)) {
            forget(w);
            return fine ? DM_STOPPED : DM_TOO_LARGE;
        }
    }
    return DM_OK;
}

/* ---- cochains ---- */

void dm_matching_cocone(const dm_matching *M, uint32_t k, const double *alpha, double *beta) {
    for (uint32_t i = 0; i < M->present[k]; i++) {
        const uint32_t a = M->order[k][i];
        if (M->kind[k][a] == DM_CELL_UPPER) beta[a] = 0.0;
        if (M->kind[k][a] != DM_CELL_LOWER) continue;
        const uint32_t b = M->partner[k][a];
        const uint32_t *face = M->K->face[k + 1] + (size_t)b * (k + 2);
        double sum = alpha ? alpha[b] : 0.0;
        for (uint32_t j = 0; j < k + 2; j++)
            if (face[j] != a) sum -= sign_of(j) * beta[face[j]];
        beta[a] = incidence(M->K, k + 1, b, a) * sum;
    }
}

void dm_matching_gather(const dm_matching *M, uint32_t k, const double *alpha, const double *below,
                        double *out) {
    for (uint32_t c = 0; c < M->criticals[k]; c++) {
        const uint32_t m = M->critical[k][c];
        out[c] = alpha[m];
        for (uint32_t j = 0; k > 0 && j <= k; j++)
            out[c] -= sign_of(j) * below[M->K->face[k][(size_t)m * (k + 1) + j]];
    }
}
