/* incidence.h - d as a sparse matrix, and what of a complex lies on its boundary. */
#ifndef DM_INCIDENCE_H
#define DM_INCIDENCE_H

#include "dec/complex.h"
#include "linalg/sparse/sparse.h"

/* d of k-forms, [count[k + 1]][count[k]], entries 1 and -1; k < n. Status of dm_sparse_room. */
dm_status dm_incidence(dm_sparse *d, dm_arena *arena, const dm_complex *K, uint32_t k);

/* mark[count[k]]: is the cell a face of a cell of degree n - 1 that lies in one top cell alone?
 * All 0 where the complex is closed, and for k = n. */
void dm_boundary_marks(unsigned char *mark, const dm_complex *K, uint32_t k);

#endif
