/* complex_find.c - what is asked of a complex: vertices, numbers, faces, components. */
#include "dec/complex.h"

#include <string.h>

/* The first four are those of the face that is left without the last vertices, the last four those
 * of the one without the first: all, since k < 8. */
static const uint32_t *find_vertices(const dm_complex *K, uint32_t k, uint32_t cell,
                                     uint32_t *room) {
    uint32_t low = cell, high = cell;
    for (uint32_t d = k; d > DM_SMALL; d--) {
        low = K->face[d][(size_t)low * (d + 1) + d];
        high = K->face[d][(size_t)high * (d + 1)];
    }
    const uint32_t *small = K->vertex[DM_SMALL];
    memcpy(room, small + (size_t)low * (DM_SMALL + 1), (DM_SMALL + 1) * sizeof *room);
    memcpy(room + k - DM_SMALL, small + (size_t)high * (DM_SMALL + 1),
           (DM_SMALL + 1) * sizeof *room);
    return room;
}

const uint32_t *dm_complex_vertices(const dm_complex *K, uint32_t k, uint32_t cell,
                                    uint32_t *room) {
    if (K->vertex[k]) return K->vertex[k] + (size_t)cell * (k + 1);
    return find_vertices(K, k, cell, room);
}

/* the order of two cells of degree k */
static int compare(const uint32_t *a, const uint32_t *b, uint32_t k) {
    for (uint32_t i = 0; i <= k; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

uint32_t dm_complex_find(const dm_complex *K, uint32_t k, const uint32_t *tuple) {
    uint32_t room[DM_DIMENSION + 1], low = 0, high = k <= K->n ? K->count[k] : 0;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        const int order = compare(dm_complex_vertices(K, k, middle, room), tuple, k);
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
