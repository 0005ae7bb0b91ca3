/* lattice.h - the force of a Lagrangian whose potential is made of sums over bodies and
 * neighbours (algebra/body_sum.h), as loops along arrays (code/loops/array_loop.h).
 *
 * Coordinate c of all bodies is one array, cut into 8 parts that lie side by side: body l depth
 * + j is entry 8 j + l, so that its neighbours are entries 8 further on in the same lane, and
 * what crosses from part to part is a few copies at the ends, renewed before every pass. Each
 * sum has a loop over its rounds which writes the derivatives of the term to a buffer; body i
 * takes entry i - shift of it for every place that it has in the term, F_i = sum over columns
 * of slope[i - shift]. So no two lanes write one entry, and the order of every sum is that of
 * the graph: tape, scalar code, 4 and 8 lanes have the same bits. Tile by tile, so that the
 * buffer stays in the cache.
 * Speed: P8-fpu-1024: 12.7x, against loops over rounds (chain/loops.h). */
#ifndef DM_LATTICE_H
#define DM_LATTICE_H

#include "code/loops/array_loop.h"
#include "code/source.h"

#include <stddef.h>

/* what a sum gives to a coordinate */
typedef struct {
    uint32_t coordinate, slot, shift;
    int minus;
} dm_lattice_share;

/* the loop of one sum */
typedef struct {
    dm_array_loop loop;
    uint32_t rounds, shift; /* shift: the largest of its shares */
    int periodic;
    uint32_t slot, slots; /* of the buffer */
} dm_lattice_sum;

enum { DM_LATTICE_SCALARS = 5 }; /* that are the same for all bodies; 0 is the time */

typedef struct {
    const dm_source *source;
    uint32_t n; /* coordinates, of `bodies` with `block` each */
    uint32_t block, bodies;
    uint32_t depth;      /* bodies of a part */
    uint32_t pad;        /* as many beyond both ends of a part that neighbours may read */
    uint32_t pitch;      /* doubles from array to array; coordinate c is array c */
    uint32_t arrays;     /* so far */
    uint32_t tile;       /* of `depth` at a time */
    uint32_t row, slots; /* rows of the buffer, doubles, and how many */
    uint32_t sums, shares;
    dm_lattice_sum *sum;
    dm_lattice_share *share;
    double *space, *buffer, *scalars;
    struct dm_lattice_data *data; /* [columns] of numbers */
    uint32_t columns;
} dm_lattice;

/* Loops for the force of an L with n coordinates, in the arena of its source; DM_TOO_LARGE where
 * it is not of this kind. */
dm_status dm_lattice_open(dm_lattice *l, const dm_source *source, uint32_t n);

/* One more array of every coordinate; gives the number of the first. */
uint32_t dm_lattice_arrays(dm_lattice *l);

/* Doubles of workspace, at most, with so many arrays of every coordinate; 0: not of this kind. */
size_t dm_lattice_work(const dm_source *source, uint32_t n, uint32_t arrays);

/* Lay the arrays into workspace, and clear what no body is loaded to: any copy of an open
 * lattice can have one. */
void dm_lattice_place(dm_lattice *l, double *work);

static inline dm_array_ref dm_lattice_entry(const dm_lattice *l, uint32_t array) {
    return (dm_array_ref){DM_ARRAY_MAIN, (int64_t)array * l->pitch};
}
static inline dm_array_ref dm_lattice_scalar(uint32_t slot) {
    return (dm_array_ref){DM_ARRAY_SCALAR, slot};
}
void dm_lattice_set(dm_lattice *l, uint32_t slot, double value);

/* Arrays first .. first + block - 1 from x[n], and back. */
void dm_lattice_load(dm_lattice *l, uint32_t first, const double *x);
void dm_lattice_store(const dm_lattice *l, double *x, uint32_t first);

/* Every entry of arrays first .. first + block - 1 is a number. */
int dm_lattice_is_finite(const dm_lattice *l, uint32_t first);

/* Nodes of the force on one body in a draft: F[block]. */
void dm_lattice_force(const dm_lattice *l, dm_array_loop_draft *d, dm_node *F);

/* positions are the sum of two arrays, whose first numbers these are; low DM_LATTICE_NONE: those
 * of one array */
typedef struct {
    uint32_t high, low;
} dm_lattice_pair;
#define DM_LATTICE_NONE UINT32_MAX

/* `use`, which changes positions by the arrays `low`, if there are any, and the slopes that it
 * takes as one loop in which positions and slopes go from group to group in registers:
 * neighbours one body away, eight lanes. DM_NO_NATIVE elsewhere. */
dm_status dm_lattice_fuse(const dm_lattice *l, dm_array_loop *out, const dm_array_loop *use,
                          dm_lattice_pair at);

/* What dm_lattice_run does, by such a loop; coordinates at the ends only are kept. */
void dm_lattice_run_fused(dm_lattice *l, const dm_array_loop *fused, const dm_array_loop *use,
                          dm_lattice_pair at, double t);

/* The coordinates themselves are these. */
void dm_lattice_add_up(dm_lattice *l, dm_lattice_pair at);

/* The slopes at the coordinates and time t, and `use` of the forces behind them, which may move the
 * coordinates. */
void dm_lattice_run(dm_lattice *l, const dm_array_loop *use, double t);

/* L_q, and with a diagonal `mass`[n] L_v = mass v behind it, as a kernel of x = (q, v, t);
 * DM_TOO_LARGE as above. */
dm_status dm_lattice_gradient(dm_kernel *out, const dm_source *source, uint32_t n,
                              const double *mass);

/* A loop without forces over all bodies. */
void dm_lattice_move(const dm_lattice *l, const dm_array_loop *loop);

#endif
