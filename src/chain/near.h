/* near.h - which pairs of bodies are nearer than a distance r: lists of those within r + margin
 * (Verlet 1967), made by way of cells of half that side, and kept until a body has moved margin / 2
 * from where it was then. In a periodic box of sides L the nearest image of a partner counts, which
 * is the only one within r + margin as long as L >= 2 (r + margin). Positions are not wrapped.
 *
 * Rows list partners j > i ascending, and what lies beyond r is left out each time, so that sums
 * over rows depend on positions alone, whenever the lists were made. Lists that outgrow their
 * memory are done without: rows then come from the cells. */
#ifndef DM_NEAR_H
#define DM_NEAR_H

#include "base/arena.h"
#include "base/status.h"

#include <stdint.h>

enum { DM_NEAR_AXES = 3, DM_NEAR_MEAN = 96 /* partners for which a list has room, in the mean */ };

typedef struct {
    uint32_t bodies, axes;
    double within, margin;
    double box[DM_NEAR_AXES];     /* sides; 0: not periodic along this axis */
    double inverse[DM_NEAR_AXES]; /* 1 / side, or 0: then no image is taken */
    int made;                     /* there are cells of the positions in `then` */
    int listed;                   /* and lists */
    double *then;                 /* [axes][bodies] positions when they were made */
    /* cells, those along axis 0 one after the other; bodies in the order of their cells */
    uint32_t cells[DM_NEAR_AXES];
    double low[DM_NEAR_AXES], scale[DM_NEAR_AXES];
    uint32_t most;          /* cells */
    uint32_t *begin;        /* [most + 1]: bodies of cell c are order[begin[c] ..] */
    uint32_t *order;        /* [bodies] ascending within a cell */
    double *sorted;         /* [axes][bodies] their positions in that order */
    double *square;         /* [bodies + 2] scratch of who makes lists: squares of distances */
    uint32_t *start, *item; /* [bodies + 1]: partners of i at item[start[i] .. start[i + 1] - 1] */
    size_t room;            /* of item */
} dm_near;

/* A row: partners within r, with the positions of their nearest images. */
typedef struct {
    uint32_t count;
    uint32_t *j;              /* [bodies] */
    double *at[DM_NEAR_AXES]; /* [bodies + 8] */
    uint32_t *all;            /* [bodies]: scratch */
    double *square;           /* [bodies + 2]: scratch, of this row alone, since threads share n */
} dm_near_row;

/* bodies, axes, within, margin and box are set. DM_NO_MEMORY. */
dm_status dm_near_open(dm_near *n, dm_arena *arena);

/* Bring it up to date for positions x[axis] + body. */
void dm_near_update(dm_near *n, const double *const *x);

/* The row of body i at these positions. */
void dm_near_find(const dm_near *n, dm_near_row *row, const double *const *x, uint32_t i);

#endif
