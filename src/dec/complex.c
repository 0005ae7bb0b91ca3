/* complex.c - from given simplices to all their faces.
 *
 * Degree by degree from the top: the cells of degree k are the given simplices of that degree and
 * the faces of the cells of degree k + 1, sorted, each once. Sorting takes most of the time of a
 * mesh (rows "mesh of triangles", "mesh of tetrahedra" of make bench), so tuples are first dealt
 * out by their first vertex, which leaves a few in each bucket, and only buckets are sorted. */
#include "dec/complex.h"

#include <string.h>

/* for functions whose length or degree is a constant where they are called: short straight loops */
#define INLINE static inline __attribute__((always_inline))

INLINE int compare(const uint32_t *a, const uint32_t *b, const uint32_t length) {
    for (uint32_t i = 0; i < length; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

INLINE void copy(uint32_t *to, const uint32_t *from, const uint32_t length) {
    for (uint32_t i = 0; i < length; i++) to[i] = from[i];
}

/* ---- sorting ---- */

/* Records of degree k in the making, dealt out by their first vertex v into the buckets
 * at[start[v] (k + 1)] .. at[start[v + 1] (k + 1)]: the other k vertices, then the source. */
typedef struct {
    uint32_t k;
    uint32_t *at;
    uint32_t *start; /* [vertices + 1]; while records come, where the next one of v goes */
    uint32_t vertices;
} buckets;

enum { SHORT = 64 };

/* by all entries, the source last: equal tuples keep the order of their sources. Shell's sort:
 * buckets are short, and a long one (a hub) still costs less than its square */
INLINE void sort_any(uint32_t *at, size_t count, const uint32_t length) {
    uint32_t moved[DM_DIMENSION + 2];
    size_t gap = 1;
    while (count > SHORT && gap < count / 3) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3)
        for (size_t i = gap; i < count; i++) {
            size_t j = i;
            copy(moved, at + i * length, length);
            for (; j >= gap && compare(at + (j - gap) * length, moved, length) > 0; j -= gap)
                copy(at + j * length, at + (j - gap) * length, length);
            if (j != i) copy(at + j * length, moved, length);
        }
}

/* the first two entries as one number, with their order */
INLINE uint64_t key_of(const uint32_t *at) {
    return (uint64_t)at[0] << 32 | at[1];
}

/* The same for short buckets, whose records come in the order of their sources: insertion by the
 * other entries alone, two at a time. */
INLINE void sort_short(uint32_t *at, size_t count, const uint32_t length) {
    uint32_t moved[DM_DIMENSION + 2];
    for (size_t i = 1; i < count; i++) {
        uint32_t *to = at + i * length;
        const uint64_t key = length > 2 ? key_of(to) : *to;
        copy(moved, to, length);
        for (; to > at; to -= length) {
            const uint32_t *before = to - length;
            const uint64_t other = length > 2 ? key_of(before) : *before;
            if (other < key) break;
            if (other == key && (length < 4 || compare(before + 2, moved + 2, length - 3) <= 0))
                break;
            copy(to, before, length);
        }
        copy(to, moved, length);
    }
}

/* different tuples of a sorted bucket */
INLINE uint32_t count_any(const uint32_t *at, size_t count, const uint32_t length) {
    uint32_t different = count > 0;
    for (size_t i = 1; i < count; i++)
        different += compare(at + (i - 1) * length, at + i * length, length - 1) != 0;
    return different;
}

/* sorts all buckets and counts the cells */
INLINE uint32_t sort_length(const buckets *b, const uint32_t length) {
    uint32_t cells = 0;
    for (uint32_t v = 0; v < b->vertices; v++) {
        uint32_t *at = b->at + (size_t)b->start[v] * length;
        const size_t count = b->start[v + 1] - b->start[v];
        if (count <= SHORT)
            sort_short(at, count, length);
        else
            sort_any(at, count, length);
        cells += count_any(at, count, length);
    }
    return cells;
}

static uint32_t sort_buckets(const buckets *b) {
    if (b->k == 1) return sort_length(b, 2);
    if (b->k == 2) return sort_length(b, 3);
    if (b->k == 3) return sort_length(b, 4);
    return sort_length(b, b->k + 1);
}

/* ---- what is given ---- */

static dm_status refuse(dm_complex_report *report, dm_complex_fault fault, uint32_t simplex,
                        uint32_t other) {
    *report = (dm_complex_report){fault, simplex, other};
    return DM_SINGULAR;
}

static uint32_t degree_of(const dm_simplices *given, uint32_t i) {
    return given->start[i + 1] - given->start[i] - 1;
}

/* given simplex i of degree k, ascending */
INLINE void read_ascending(uint32_t *tuple, const dm_simplices *given, uint32_t i,
                           const uint32_t k) {
    const uint32_t *v = given->vertex + given->start[i];
    for (uint32_t at = 0; at <= k; at++) {
        uint32_t j = at;
        for (; j > 0 && tuple[j - 1] > v[at]; j--) tuple[j] = tuple[j - 1];
        tuple[j] = v[at];
    }
}

/* the same, or what is wrong with it */
static dm_status read_given(uint32_t *tuple, const dm_simplices *given, uint32_t i, uint32_t k,
                            dm_complex_report *report) {
    read_ascending(tuple, given, i, k);
    if (tuple[k] >= given->vertices) return refuse(report, DM_COMPLEX_UNKNOWN, i, i);
    for (uint32_t j = 0; j < k; j++)
        if (tuple[j] == tuple[j + 1]) return refuse(report, DM_COMPLEX_REPEATED, i, i);
    return DM_OK;
}

/* ---- cells of one degree ---- */

/* how many records begin with each vertex, to start[v + 1] */
static dm_status count_records(buckets *b, const dm_complex *K, const dm_simplices *given,
                               dm_complex_report *report) {
    const uint32_t k = b->k, above = k < K->n ? K->count[k + 1] : 0;
    uint32_t tuple[DM_DIMENSION + 1];
    const uint32_t *cell = above ? K->vertex[k + 1] : NULL;
    memset(b->start, 0, ((size_t)b->vertices + 1) * sizeof *b->start);
    for (uint32_t i = 0; i < given->simplices; i++) {
        if (degree_of(given, i) != k) continue;
        const dm_status status = read_given(tuple, given, i, k, report);
        if (status != DM_OK) return status;
        b->start[tuple[0] + 1]++;
    }
    for (uint32_t i = 0; i < above; i++, cell += k + 2) {
        b->start[cell[1] + 1]++; /* the face opposite to vertex 0 */
        b->start[cell[0] + 1] += k + 1;
    }
    return DM_OK;
}

INLINE void put(const buckets *b, uint32_t first, const uint32_t *rest, uint32_t source,
                const uint32_t k) {
    uint32_t *at = b->at + (size_t)b->start[first]++ * (k + 1);
    copy(at, rest, k);
    at[k] = source;
}

/* the k + 2 faces of every cell of degree k + 1; the source of face j of cell i is
 * base + i (k + 2) + j */
INLINE void put_faces(const buckets *b, const dm_complex *K, uint32_t base, const uint32_t k) {
    const uint32_t *cell = K->vertex[k + 1];
    uint32_t rest[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < K->count[k + 1]; i++, cell += k + 2, base += k + 2) {
        put(b, cell[1], cell + 2, base, k);
        copy(rest, cell + 2, k);
        for (uint32_t j = 1; j < k + 2; j++) { /* rest: without vertex j */
            put(b, cell[0], rest, base + j, k);
            if (j < k + 1) rest[j - 1] = cell[j];
        }
    }
}

INLINE void put_length(const buckets *b, const dm_complex *K, const dm_simplices *given,
                       const uint32_t k) {
    uint32_t tuple[DM_DIMENSION + 1];
    for (uint32_t i = 0; i < given->simplices; i++) {
        if (degree_of(given, i) != k) continue;
        read_ascending(tuple, given, i, k);
        put(b, tuple[0], tuple + 1, i, k);
    }
    if (k < K->n) put_faces(b, K, given->simplices, k);
}

/* given ones before faces; they have been looked at by count_records */
static void put_records(const buckets *b, const dm_complex *K, const dm_simplices *given) {
    if (b->k == 1)
        put_length(b, K, given, 1);
    else if (b->k == 2)
        put_length(b, K, given, 2);
    else if (b->k == 3)
        put_length(b, K, given, 3);
    else
        put_length(b, K, given, b->k);
}

/* What sorted record i tells: `cell` is its cell, is_first and is_last of the records of it. */
INLINE dm_status number_record(dm_complex *K, const uint32_t *at, const uint32_t k, uint32_t cell,
                               int is_first, int is_last, uint32_t base,
                               dm_complex_report *report) {
    const uint32_t source = at[k];
    if (source >= base)
        K->face[k + 1][source - base] = cell;
    else if (!is_first) /* given ones come before faces */
        return refuse(report, DM_COMPLEX_DUPLICATE, source, at[-1]);
    else if (k < K->n && is_last)
        K->pure = 0;
    return DM_OK;
}

/* sorted records to cells, each once, and the faces of the degree above to their numbers */
INLINE dm_status number_length(dm_complex *K, const buckets *b, uint32_t base,
                               dm_complex_report *report, const uint32_t k) {
    const uint32_t *at = b->at;
    uint32_t *tuple = K->vertex[k], cell = UINT32_MAX;
    for (uint32_t v = 0; v < b->vertices; v++) {
        int is_first = 1;
        for (uint32_t i = b->start[v]; i < b->start[v + 1]; i++, at += k + 1) {
            const int is_last = i + 1 == b->start[v + 1] || compare(at, at + k + 1, k) != 0;
            if (is_first) {
                cell++;
                *tuple++ = v;
                for (uint32_t j = 0; j < k; j++) *tuple++ = at[j];
            }
            const dm_status status = number_record(K, at, k, cell, is_first, is_last, base, report);
            if (status != DM_OK) return status;
            is_first = is_last;
        }
    }
    return DM_OK;
}

static dm_status number_cells(dm_complex *K, const buckets *b, uint32_t base,
                              dm_complex_report *report) {
    if (b->k == 1) return number_length(K, b, base, report, 1);
    if (b->k == 2) return number_length(K, b, base, report, 2);
    if (b->k == 3) return number_length(K, b, base, report, 3);
    return number_length(K, b, base, report, b->k);
}

/* where degree k of a complex gets its memory from */
typedef struct {
    dm_arena *arena, *tuples; /* what stays; vertices of the cells */
    dm_arena *scratch;
} places;

static dm_status make_degree(dm_complex *K, const places *from, const dm_simplices *given,
                             uint32_t k, volatile const int *stop, dm_complex_report *report) {
    const uint32_t base = given->simplices;
    const size_t faces = k < K->n ? (size_t)K->count[k + 1] * (k + 2) : 0;
    if (base + faces >= UINT32_MAX) return DM_TOO_LARGE;
    uint32_t *start = dm_arena_take(from->scratch, ((size_t)given->vertices + 2) * sizeof *start);
    if (!start) return DM_NO_MEMORY;
    /* begins stand one place further while put_records moves each to its end, the next begin */
    buckets b = {k, NULL, start + 1, given->vertices};
    start[0] = 0;
    const dm_status status = count_records(&b, K, given, report);
    if (status != DM_OK) return status;
    for (uint32_t v = 0; v < given->vertices; v++) b.start[v + 1] += b.start[v];
    b.at = dm_arena_take(from->scratch,
                         ((size_t)b.start[given->vertices] + 1) * (k + 1) * sizeof *b.at);
    if (faces) K->face[k + 1] = dm_arena_take(from->arena, faces * sizeof(uint32_t));
    if (!b.at || (faces && !K->face[k + 1])) return DM_NO_MEMORY;
    put_records(&b, K, given);
    b.start = start;
    if (stop && *stop) return DM_STOPPED;
    K->count[k] = sort_buckets(&b);
    if (stop && *stop) return DM_STOPPED;
    K->vertex[k] =
        dm_arena_take(from->tuples, ((size_t)K->count[k] + 1) * (k + 1) * sizeof(uint32_t));
    if (!K->vertex[k]) return DM_NO_MEMORY;
    return number_cells(K, &b, base, report);
}

/* every vertex is a cell, in a simplex or not: faces of edges are their vertices' numbers */
static dm_status make_vertices(dm_complex *K, dm_arena *arena, const dm_simplices *given) {
    const uint32_t edges = K->n ? K->count[1] : 0;
    K->count[0] = given->vertices;
    K->vertex[0] = dm_arena_take(arena, ((size_t)given->vertices + 1) * sizeof(uint32_t));
    if (!K->vertex[0]) return DM_NO_MEMORY;
    for (uint32_t v = 0; v < given->vertices; v++) K->vertex[0][v] = v;
    if (!K->n) return DM_OK;
    K->face[1] = dm_arena_take(arena, ((size_t)edges + 1) * 2 * sizeof(uint32_t));
    if (!K->face[1]) return DM_NO_MEMORY;
    for (uint32_t e = 0; e < edges; e++) { /* face j is opposite to vertex j */
        K->face[1][2 * e] = K->vertex[1][2 * e + 1];
        K->face[1][2 * e + 1] = K->vertex[1][2 * e];
    }
    return DM_OK;
}

static dm_status make_cofaces(dm_complex *K, dm_arena *arena, uint32_t k) {
    const uint32_t count = K->count[k], above = K->count[k + 1], length = k + 2;
    const size_t pairs = (size_t)above * length;
    uint32_t *at = dm_arena_take(arena, ((size_t)count + 1) * sizeof *at);
    uint32_t *coface = dm_arena_take(arena, (pairs + 1) * sizeof *coface);
    if (!at || !coface) return DM_NO_MEMORY;
    memset(at, 0, ((size_t)count + 1) * sizeof *at);
    for (size_t i = 0; i < pairs; i++) at[K->face[k + 1][i]]++;
    for (uint32_t i = 0, sum = 0; i <= count; i++) {
        const uint32_t here = i < count ? at[i] : 0;
        at[i] = sum += here; /* the end of the list of i, from which it is filled backwards */
    }
    const uint32_t *face = K->face[k + 1] + pairs;
    for (uint32_t cell = above; cell-- > 0;)
        for (uint32_t j = 0; j < length; j++) coface[--at[*--face]] = cell;
    K->coface_at[k] = at;
    K->coface[k] = coface;
    return DM_OK;
}

/* an isolated vertex is a component, but not one of top cells */
static int has_loose_vertices(const dm_complex *K) {
    if (K->n == 0) return 0;
    for (uint32_t v = 0; v < K->count[0]; v++)
        if (K->coface_at[0][v] == K->coface_at[0][v + 1]) return 1;
    return 0;
}

static int is_stored(const dm_complex *K, uint32_t k) {
    return k <= DM_SMALL || k == K->n;
}

/* From the top down. Vertices that are not stored are needed until the degree below is made, so two
 * arenas take turns with them. */
static dm_status make_degrees(dm_complex *K, dm_arena *arena, const dm_simplices *given,
                              volatile const int *stop, dm_complex_report *report) {
    dm_status status = DM_OK;
    dm_arena passing[2];
    for (uint32_t i = 0; i < 2; i++) dm_arena_init(&passing[i], arena->allocate, arena->ud);
    for (uint32_t k = K->n; status == DM_OK && k > 0; k--) {
        dm_arena *tuples = is_stored(K, k) ? arena : &passing[k % 2];
        const places from = {arena, tuples, dm_arena_scratch(arena)};
        if (stop && *stop) status = DM_STOPPED;
        if (!from.scratch) status = DM_NO_MEMORY;
        if (status != DM_OK) break;
        if (tuples != arena) dm_arena_release(tuples);
        status = make_degree(K, &from, given, k, stop, report);
    }
    for (uint32_t i = 0; i < 2; i++) dm_arena_release(&passing[i]);
    for (uint32_t k = 0; k < K->n; k++)
        if (!is_stored(K, k)) K->vertex[k] = NULL;
    return status;
}

dm_status dm_complex_build(dm_complex *K, dm_arena *arena, const dm_simplices *given,
                           volatile const int *stop, dm_complex_report *report) {
    dm_status status = DM_OK;
    *K = (dm_complex){.pure = 1};
    *report = (dm_complex_report){DM_COMPLEX_FINE, 0, 0};
    for (uint32_t i = 0; i < given->simplices; i++)
        if (degree_of(given, i) > K->n) K->n = degree_of(given, i);
    status = make_degrees(K, arena, given, stop, report);
    if (status == DM_OK) status = make_vertices(K, arena, given);
    for (uint32_t k = 0; status == DM_OK && k < K->n; k++)
        status = stop && *stop ? DM_STOPPED : make_cofaces(K, arena, k);
    if (status == DM_OK) K->pure = K->pure && !has_loose_vertices(K);
    return status;
}
