/* avi.c - asynchronous steps of Maxwell's equations on the hexagonal torus of N x N vertices by
 * hand: a triangle's edges are drifted to its time and kicked by h_K, and its next time goes back
 * to the queue. Two queues: a binary heap of (time, cell), and buckets of time whose few cells are
 * sorted when theirs has come; and without a queue. Equal times go by the number of the cell.
 * Argument: N. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 7 };

/* what belongs to an edge stands in one line of the cache, and so does what belongs to a cell */
typedef struct {
    double x, p, w, last;
} edge;

typedef struct {
    double h, star, fired;
    uint32_t face[3], unused;
} cell;

typedef struct {
    double time;
    uint32_t cell, unused;
} event;

static uint32_t edges, cells;
static edge *E;
static cell *C;
static event *heap;
static double *times;
static uint32_t *head, *next, *list; /* of buckets; those of one, sorted */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *take(size_t count, size_t size) {
    void *x = calloc(count, size);
    if (!x) exit(1);
    return x;
}

/* two triangles a vertex, edges 3 v + d to (1, 0), (0, 1), (1, 1) */
static void make_torus(uint32_t N) {
    edges = 3 * N * N, cells = 2 * N * N;
    E = take(edges, sizeof *E), C = take(cells, sizeof *C), heap = take(cells + 1, sizeof *heap);
    times = take(cells, sizeof *times);
    next = take(cells, sizeof *next), list = take(cells, sizeof *list);
    for (uint32_t v = 0; v < N * N; v++) {
        const uint32_t i = v / N, j = v % N, x = (i + 1) % N * N + j, y = i * N + (j + 1) % N;
        const uint32_t f[2][3] = {{3 * v, 3 * v + 2, 3 * x + 1}, {3 * v + 1, 3 * v + 2, 3 * y}};
        for (uint32_t d = 0; d < 2; d++) memcpy(C[2 * v + d].face, f[d], sizeof f[d]);
    }
}

static void start(double h) {
    for (uint32_t i = 0; i < edges; i++) E[i] = (edge){sin(i + 1), 0.0, 1.0, 0.0};
    for (uint32_t k = 0; k < cells; k++) {
        C[k].h = h * (0.5 + fmod(0.6180339887498949 * (k + 1), 1.0));
        C[k].star = 1.0;
        C[k].fired = 0.0;
    }
}

/* returns the next time of the cell */
static inline double fire(uint32_t k, double t) {
    cell *c = C + k;
    edge *a = E + c->face[0], *b = E + c->face[1], *d = E + c->face[2];
    a->x += (t - a->last) * (a->w * a->p), a->last = t;
    b->x += (t - b->last) * (b->w * b->p), b->last = t;
    d->x += (t - d->last) * (d->w * d->p), d->last = t;
    const double kick = c->h * (c->star * (a->x - b->x + d->x));
    a->p -= kick, b->p += kick, d->p -= kick;
    c->fired += 1.0;
    return (c->fired + 1.0) * c->h;
}

static inline int is_before(event a, event b) {
    return a.time < b.time || (a.time == b.time && a.cell < b.cell);
}

static void sink(uint32_t at, event x) {
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= cells) break;
        if (child + 1 < cells && is_before(heap[child + 1], heap[child])) child++;
        if (!is_before(heap[child], x)) break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = x;
}

static double by_heap(double end) {
    double events = 0.0;
    for (uint32_t k = 0; k < cells; k++) heap[k] = (event){C[k].h, k, 0};
    for (uint32_t k = cells / 2; k-- > 0;) sink(k, heap[k]);
    while (heap[0].time <= end) {
        const event x = heap[0];
        sink(0, (event){fire(x.cell, x.time), x.cell, 0});
        events++;
    }
    return events;
}

/* buckets of a ring as long as the largest step; no cell comes twice within the least one, which is
 * longer than a bucket */
static double by_buckets(double end, double least, double largest) {
    const double width = least / (double)cells * 2.0, scale = 1.0 / width;
    uint64_t ring = 1;
    while ((double)ring < largest / width + 2.0) ring *= 2;
    head = take(ring, sizeof *head);
    memset(head, 0xff, ring * sizeof *head);
    double events = 0.0;
    for (uint32_t k = 0; k < cells; k++) {
        const uint64_t b = (uint64_t)((times[k] = C[k].h) * scale) & (ring - 1);
        next[k] = head[b], head[b] = k;
    }
    for (uint64_t b = 0;; b++) {
        uint32_t *first = head + (b & (ring - 1)), count = 0;
        if (*first == UINT32_MAX) continue;
        for (uint32_t k = *first; k != UINT32_MAX; k = next[k]) {
            uint32_t at = count++;
            for (; at > 0 && (times[k] < times[list[at - 1]] ||
                              (times[k] == times[list[at - 1]] && k < list[at - 1]));
                 at--)
                list[at] = list[at - 1];
            list[at] = k;
        }
        *first = UINT32_MAX;
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t k = list[i];
            if (times[k] > end) {
                free(head);
                return events;
            }
            times[k] = fire(k, times[k]);
            const uint64_t to = (uint64_t)(times[k] * scale) & (ring - 1);
            next[k] = head[to], head[to] = k;
            events++;
        }
    }
}

/* no queue: a cell fires when it is before all cells that share an edge with it, of which
 * blocked[k] are before it; what has no edge in common may go in any order, with the same bits */
static uint32_t (*near)[3], *blocked, *stack;

static void find_neighbours(void) {
    uint32_t(*of)[2] = take(edges, sizeof *of), *count = take(edges, sizeof *count);
    near = take(cells, sizeof *near), blocked = take(cells, 4), stack = take(cells + 1, 4);
    for (uint32_t k = 0; k < cells; k++)
        for (int j = 0; j < 3; j++) of[C[k].face[j]][count[C[k].face[j]]++] = k;
    for (uint32_t k = 0; k < cells; k++)
        for (int j = 0; j < 3; j++) {
            const uint32_t *both = of[C[k].face[j]];
            near[k][j] = both[0] == k ? both[1] : both[0];
        }
    free(of), free(count);
}

static double by_neighbours(double end) {
    double events = 0.0;
    uint32_t top = 0;
    for (uint32_t k = 0; k < cells; k++) times[k] = C[k].h;
    for (uint32_t k = cells; k-- > 0;) {
        blocked[k] = 0;
        for (int j = 0; j < 3; j++) {
            const uint32_t l = near[k][j];
            blocked[k] += times[l] < times[k] || (times[l] == times[k] && l < k);
        }
        if (!blocked[k]) stack[top++] = k;
    }
    while (top) {
        const uint32_t k = stack[--top];
        const double t = times[k];
        if (t > end) continue;
        const double then = times[k] = fire(k, t);
        uint32_t before = 0;
        for (int j = 0; j < 3; j++) {
            const uint32_t l = near[k][j];
            const uint32_t is = times[l] < then || (times[l] == then && l < k);
            before += is;
            blocked[l] -= is;
            stack[top] = l;
            top += is && !blocked[l];
        }
        blocked[k] = before;
        stack[top] = k;
        top += !before;
        events++;
    }
    return events;
}

/* every cell in its turn, whatever its time: what drifts and kicks alone cost */
static double without_order(double end) {
    double events = 0.0, h = end / 60.0;
    for (double t = h; t < end; t += h)
        for (uint32_t k = 0; k < cells; k++, events++) times[k] = fire(k, t);
    return events;
}

int main(int argc, char **argv) {
    const uint32_t N = argc > 1 ? (uint32_t)atoi(argv[1]) : 60;
    const double h = 0.1, end = 60 * h;
    static const char *const name[] = {"heap", "buckets", "neighbours", "no order"};
    make_torus(N);
    find_neighbours();
    for (int queue = 0; queue < 4; queue++) {
        double best = INFINITY, events = 0.0;
        for (int r = 0; r < REPEATS; r++) {
            start(h);
            const double t = now();
            events = queue == 0   ? by_heap(end)
                     : queue == 1 ? by_buckets(end, 0.5 * h, 1.5 * h)
                     : queue == 2 ? by_neighbours(end)
                                  : without_order(end);
            best = fmin(best, (now() - t) / events);
        }
        printf("%-28s by hand, %-10s    %9.2f ns an event     (%u cells, %.0f events; %.15g)\n",
               "Maxwell, avi", name[queue], best * 1e9, cells, events, E[1].x);
    }
    return 0;
}
