/* complex.c - from given simplices to all their faces.
 *
 * Degree by degree from the top: the cells of degree k are the given simplices of that degree and
 * the faces of the cells of degree k + 1, sorted, each once. Sorting takes most of the time of a
 * mesh, so tuples are first dealt out by their first vertex, which leaves a few in each bucket,
 * and only buckets are sorted. A record is a tuple with where it comes from behind it. */
#include "dec/complex.h"

#include <string.h>

/* records of degree k: [count][k + 2], vertices ascending, then the source */
typedef struct {
    uint32_t *at;
    size_t count;
    uint32_t k;
} records;

static uint32_t *record(const records *r, size_t i) {
    return r->at + i * (r->k + 2);
}

static int compare(const uint32_t *a, const uint32_t *b, uint32_t length) {
    for (uint32_t i = 0; i < length; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* by all entries, the source last: equal tuples keep the order of their sources. Shell's sort:
 * buckets are short, and a long one (a hub) still costs less than its square */
static void sort_bucket(const records *r, size_t from, size_t to) {
    const uint32_t length = r->k + 2;
    uint32_t moved[DM_DIMENSION + 2];
    size_t gap = 1;
    while (gap < (to - from) / 3) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3)
        for (size_t i = from + gap; i < to; i++) {
            size_t j = i;
            memcpy(moved, record(r, i), length * sizeof *moved);
            for (; j >= from + gap && compare(record(r, j - gap), moved, length) > 0; j -= gap)
                memcpy(record(r, j), record(r, j - gap), length * sizeof *moved);
            memcpy(record(r, j), moved, length * sizeof *moved);
        }
}

/* *out = the records in order; place: [vertices + 1] */
static void sort_records(records *out, const records *in, uint32_t *place, uint32_t vertices) {
    const uint32_t length = in->k + 2;
    memset(place, 0, ((size_t)vertices + 1) * sizeof *place);
    for (size_t i = 0; i < in->count; i++) place[record(in, i)[0] + 1]++;
    for (uint32_t v = 0; v < vertices; v++) place[v + 1] += place[v];
    for (size_t i = 0; i < in->count; i++) {
        const uint32_t *r = record(in, i);
        memcpy(record(out, place[r[0]]++), r, length * sizeof *r);
    }
    size_t from = 0;
    for (uint32_t v = 0; v < vertices; v++) { /* place[v] is where the bucket of v ends now */
        if (place[v] - from > 1) sort_bucket(out, from, place[v]);
        from = place[v];
    }
}

/* ---- what is given ---- */

static void sort_tuple(uint32_t *tuple, uint32_t length) {
    for (uint32_t i = 1; i < length; i++) {
        const uint32_t moved = tuple[i];
        uint32_t j = i;
        for (; j > 0 && tuple[j - 1] > moved; j--) tuple[j] = tuple[j - 1];
        tuple[j] = moved;
    }
}

static dm_status refuse(dm_complex_report *report, dm_complex_fault fault, uint32_t simplex,
                        uint32_t other) {
    *report = (dm_complex_report){fault, simplex, other};
    return DM_SINGULAR;
}

static uint32_t degree_of(const dm_simplices *given, uint32_t i) {
    return given->start[i + 1] - given->start[i] - 1;
}

/* the given simplices of degree r->k, ascending, behind what r has; sources are their numbers */
static dm_status add_given(records *r, const dm_simplices *given, dm_complex_report *report) {
    for (uint32_t i = 0; i < given->simplices; i++) {
        if (degree_of(given, i) != r->k) continue;
        uint32_t *tuple = record(r, r->count++);
        memcpy(tuple, given->vertex + given->start[i], (r->k + 1) * sizeof *tuple);
        sort_tuple(tuple, r->k + 1);
        tuple[r->k + 1] = i;
        if (tuple[r->k] >= given->vertices) return refuse(report, DM_COMPLEX_UNKNOWN, i, i);
        for (uint32_t j = 0; j < r->k; j++)
            if (tuple[j] == tuple[j + 1]) return refuse(report, DM_COMPLEX_REPEATED, i, i);
    }
    return DM_OK;
}

static uint32_t given_of_degree(const dm_simplices *given, uint32_t k) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < given->simplices; i++) count += degree_of(given, i) == k;
    return count;
}

/* faces of the cells of degree r->k + 1; the source of face j of cell i is base + i (k + 2) + j */
static void add_faces(records *r, const dm_complex *K, uint32_t base) {
    const uint32_t k = r->k, length = k + 2, count = K->count[k + 1];
    const uint32_t *cell = K->vertex[k + 1];
    for (uint32_t i = 0; i < count; i++, cell += length)
        for (uint32_t j = 0; j < length; j++) {
            uint32_t *tuple = record(r, r->count++);
            memcpy(tuple, cell, j * sizeof *tuple);
            memcpy(tuple + j, cell + j + 1, (k + 1 - j) * sizeof *tuple);
            tuple[k + 1] = base + i * length + j;
        }
}

/* ---- cells of one degree ---- */

/* sorted records to cells, each once, and the faces of the degree above to their numbers */
static dm_status number_cells(dm_complex *K, dm_arena *arena, const records *r, uint32_t base,
                              dm_complex_report *report) {
    const uint32_t k = r->k, length = k + 1;
    uint32_t count = 0;
    for (size_t i = 0; i < r->count; i++)
        count += i == 0 || compare(record(r, i - 1), record(r, i), length) != 0;
    K->count[k] = count;
    K->vertex[k] = dm_arena_take(arena, ((size_t)count + 1) * length * sizeof(uint32_t));
    if (!K->vertex[k]) return DM_NO_MEMORY;
    uint32_t cell = UINT32_MAX;
    for (size_t i = 0; i < r->count; i++) {
        const uint32_t *tuple = record(r, i), source = tuple[length];
        if (i == 0 || compare(record(r, i - 1), tuple, length) != 0)
            memcpy(K->vertex[k] + (size_t)++cell * length, tuple, length * sizeof *tuple);
        else if (source < base)
            return refuse(report, DM_COMPLEX_DUPLICATE, source, record(r, i - 1)[length]);
        if (source >= base)
            K->face[k + 1][source - base] = cell;
        else if (k < K->n)
            K->pure = K->pure && i + 1 < r->count && compare(tuple, record(r, i + 1), length) == 0;
    }
    return DM_OK;
}

static dm_status make_degree(dm_complex *K, dm_arena *arena, dm_arena *scratch,
                             const dm_simplices *given, uint32_t k, dm_complex_report *report) {
    const uint32_t base = given->simplices;
    const size_t faces = k < K->n ? (size_t)K->count[k + 1] * (k + 2) : 0;
    const size_t most = faces + given_of_degree(given, k);
    if (base + faces >= UINT32_MAX) return DM_TOO_LARGE;
    records in = {dm_arena_take(scratch, (most + 1) * (k + 2) * sizeof(uint32_t)), 0, k};
    records out = {dm_arena_take(scratch, (most + 1) * (k + 2) * sizeof(uint32_t)), 0, k};
    uint32_t *place = dm_arena_take(scratch, ((size_t)given->vertices + 1) * sizeof *place);
    if (!in.at || !out.at || !place) return DM_NO_MEMORY;
    const dm_status status = add_given(&in, given, report);
    if (status != DM_OK) return status;
    if (k < K->n) {
        K->face[k + 1] = dm_arena_take(arena, (faces + 1) * sizeof(uint32_t));
        if (!K->face[k + 1]) return DM_NO_MEMORY;
        add_faces(&in, K, base);
    }
    out.count = in.count;
    sort_records(&out, &in, place, given->vertices);
    return number_cells(K, arena, &out, base, report);
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
    for (size_t i = pairs; i-- > 0;) coface[--at[K->face[k + 1][i]]] = (uint32_t)(i / length);
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

dm_status dm_complex_build(dm_complex *K, dm_arena *arena, const dm_simplices *given,
                           volatile const int *stop, dm_complex_report *report) {
    dm_status status = DM_OK;
    *K = (dm_complex){.pure = 1};
    *report = (dm_complex_report){DM_COMPLEX_FINE, 0, 0};
    for (uint32_t i = 0; i < given->simplices; i++)
        if (degree_of(given, i) > K->n) K->n = degree_of(given, i);
    for (uint32_t k = K->n; status == DM_OK && k > 0; k--) {
        dm_arena *scratch = dm_arena_scratch(arena);
        if (!scratch) return DM_NO_MEMORY;
        if (stop && *stop) return DM_STOPPED;
        status = make_degree(K, arena, scratch, given, k, report);
    }
    if (status == DM_OK) status = make_vertices(K, arena, given);
    for (uint32_t k = 0; status == DM_OK && k < K->n; k++) status = make_cofaces(K, arena, k);
    if (status == DM_OK) K->pure = K->pure && !has_loose_vertices(K);
    return status;
}

/* ---- questions ---- */

uint32_t dm_complex_find(const dm_complex *K, uint32_t k, const uint32_t *tuple) {
    uint32_t low = 0, high = k <= K->n ? K->count[k] : 0;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        const int order = compare(K->vertex[k] + (size_t)middle * (k + 1), tuple, k + 1);
        if (order == 0) return middle;
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return UINT32_MAX;
}

/* vertices are dropped from the last one, so that those before keep their places */
uint32_t dm_complex_face(const dm_complex *K, uint32_t k, uint32_t cell, uint32_t set) {
    uint32_t d = k;
    for (uint32_t p = k + 1; p-- > 0 && d > 0;)
        if (!(set >> p & 1)) cell = K->face[d][(size_t)cell * (d + 1) + p], d--;
    return cell;
}

long dm_complex_euler(const dm_complex *K) {
    long sum = 0;
    for (uint32_t k = 0; k <= K->n; k++) sum += k % 2 ? -(long)K->count[k] : (long)K->count[k];
    return sum;
}

static uint32_t root_of(uint32_t *parent, uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

uint32_t dm_complex_components(const dm_complex *K, uint32_t *component, uint32_t *work) {
    uint32_t count = 0;
    for (uint32_t v = 0; v < K->count[0]; v++) work[v] = v;
    for (uint32_t e = 0; e < K->count[1]; e++) {
        const uint32_t a = root_of(work, K->vertex[1][2 * e]);
        const uint32_t b = root_of(work, K->vertex[1][2 * e + 1]);
        if (a < b)
            work[b] = a; /* the root is the first vertex of a component */
        else
            work[a] = b;
    }
    for (uint32_t v = 0; v < K->count[0]; v++) {
        const uint32_t root = root_of(work, v);
        component[v] = root == v ? count++ : component[root];
    }
    return count;
}
