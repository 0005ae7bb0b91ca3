#include "linalg/step_matrix.h"

#include "base/doubles.h"

#include <string.h>

enum { SMALL = 24 }; /* unknowns for which a band is not worth its numbering */

size_t dm_step_matrix_work(uint32_t unknowns) {
    return 2 * dm_doubles(unknowns * sizeof(size_t)) + dm_doubles(unknowns * sizeof(uint32_t));
}

/* Dense by rows, until it is found to be narrow. */
void dm_step_matrix_open(dm_step_matrix *m, uint32_t n, double *memory) {
    m->row = (size_t *)(void *)memory;
    m->column = m->row + n;
    m->order = (uint32_t *)(void *)(memory + 2 * dm_doubles(n * sizeof(size_t)));
    m->banded = 0;
    m->band = (dm_band){.n = n};
    for (uint32_t i = 0; i < n; i++) {
        m->row[i] = i * (size_t)n;
        m->column[i] = i;
    }
}

/* the order is there; a band of width w costs about 4 n w^2 against 2/3 n^3, and more for every
 * number */
static void narrow(dm_step_matrix *m, uint32_t width) {
    const uint32_t n = m->band.n;
    m->band.width = width;
    if (width > n / 4) return;
    m->banded = 1;
    m->band.order = m->order;
    for (uint32_t i = 0; i < n; i++) {
        m->row[i] = dm_band_row(&m->band, i);
        m->column[i] = dm_band_column(&m->band, i);
    }
}

void dm_step_matrix_narrow(dm_step_matrix *m, const double *J, uint32_t *scratch) {
    if (m->band.n >= SMALL) narrow(m, dm_band_order(m->order, J, m->band.n, scratch));
}

void dm_step_matrix_narrow_blocks(dm_step_matrix *m, const double *pattern, uint32_t count,
                                  uint32_t *scratch) {
    const uint32_t blocks = m->band.n / count;
    if (m->band.n < SMALL) return;
    const uint32_t width = dm_band_order(m->order, pattern, count, scratch);
    for (uint32_t i = blocks; i-- > 0;) /* the first of them last: its places are read until then */
        for (uint32_t k = 0; k < count; k++) m->order[i * count + k] = m->order[k] * blocks + i;
    narrow(m, (width + 1) * blocks - 1);
}

void dm_step_matrix_zero(double *J, const dm_step_matrix *m) {
    const size_t n = m->band.n;
    memset(J, 0, (m->banded ? dm_band_size(&m->band) : n * n) * sizeof *J);
}
