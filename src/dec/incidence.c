/* incidence.c - rows of d are the faces of a cell; its columns are the cofaces, which the complex
 * has in ascending order already. */
#include "dec/incidence.h"

#include <string.h>

/* the sign of `face` in the boundary of cell `cell` of degree k */
static double sign_in(const dm_complex *K, uint32_t k, uint32_t cell, uint32_t face) {
    const uint32_t *faces = K->face[k] + (size_t)cell * (k + 1);
    uint32_t j = 0;
    while (faces[j] != face) j++;
    return j % 2 ? -1.0 : 1.0;
}

/* Cofaces are ascending, so rows are; every cell of degree k + 1 has k + 2 entries. */
dm_status dm_incidence(dm_sparse *d, dm_arena *arena, const dm_complex *K, uint32_t k) {
    if (K->count[k] > INT32_MAX || K->count[k + 1] > INT32_MAX) return DM_TOO_LARGE;
    const int64_t entries = (int64_t)K->count[k + 1] * (k + 2);
    const dm_status status =
        dm_sparse_room(d, arena, (int32_t)K->count[k + 1], (int32_t)K->count[k], entries);
    if (status != DM_OK) return status;
    for (uint32_t i = 0; i <= K->count[k]; i++) d->start[i] = (int32_t)K->coface_at[k][i];
    for (uint32_t i = 0; i < K->count[k]; i++)
        for (int32_t p = d->start[i]; p < d->start[i + 1]; p++) {
            d->row[p] = (int32_t)K->coface[k][p];
            d->value[p] = sign_in(K, k + 1, K->coface[k][p], i);
        }
    return DM_OK;
}

/* every face of degree k of cell i of degree n - 1: by the bits of its vertices */
static void mark_faces(unsigned char *mark, const dm_complex *K, uint32_t k, uint32_t i) {
    const uint32_t n = K->n;
    for (uint32_t set = 1; set < 1u << n; set++) {
        uint32_t bits = 0;
        for (uint32_t b = set; b; b &= b - 1) bits++;
        if (bits == k + 1) mark[dm_complex_face(K, n - 1, i, set)] = 1;
    }
}

/* cells of lower degree by the facets that have them: nothing is stored for it */
void dm_boundary_marks(unsigned char *mark, const dm_complex *K, uint32_t k) {
    const uint32_t n = K->n;
    memset(mark, 0, K->count[k]);
    if (k >= n) return;
    for (uint32_t i = 0; i < K->count[n - 1]; i++)
        if (K->coface_at[n - 1][i + 1] - K->coface_at[n - 1][i] == 1) mark_faces(mark, K, k, i);
}
