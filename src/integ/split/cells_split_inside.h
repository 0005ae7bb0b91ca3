/* cells_split_inside.h - what the files of cells_split.h share: what a burst works on, and what
 * happens to an entry. */
#ifndef DM_CELLS_SPLIT_INSIDE_H
#define DM_CELLS_SPLIT_INSIDE_H

#include "chain/cells.h"
#include "chain/team.h"
#include "integ/split/cells_split.h"

struct dm_cells_split {
    const dm_model *m;
    const dm_cells *cells;
    dm_splitting table;
    double c[DM_SPLITTING_STAGES + 1]; /* time of kick k is t + c_k h */
    int plain;
    dm_team *team;                       /* NULL: one thread */
    const struct dm_cell_ranges *ranges; /* of a team; NULL: it goes by lists */
    double *x;     /* (q, v, t), or q of the state where forces read q alone */
    int own;       /* x is a copy */
    double *force; /* [n] those of the newest positions */
    double *kept;  /* [4n] the state `since` steps ago */
    long since;
    double *scratch; /* [threads][room] */
    size_t room;     /* of the gradient of L, or of forces beside L */
    uint32_t unit;   /* entries of a block: whole cells */
    const double *factor;
    /* of the burst */
    double *state, t, h;
    long count;
    int knows; /* q and the forces there are those of the last burst */
    int timed; /* forces depend on t: they are made anew in every burst */
    int lost;  /* no root was found for values without mass, which are NaN */
};

/* what happens to an entry once its force is there: the kick hb, then with `begins` the kick that
 * begins the next step, then the drift ha; 0: none */
typedef struct {
    double kick, begin, drift;
    int kicks, begins;
} dm_cells_move;

/* Kicks and drifts of `count` entries from i on, by the forces there (cells_move.c). */
void dm_cells_move_block(const dm_cells_split *s, const dm_cells_move *v, uint32_t i,
                         uint32_t count);

static inline double dm_cells_dot(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* Forces beside L on `count` entries from i on, in a block that has new ones of L: they are added
 * to these; where they read v the kick of v that ends a step is made here, and v loses it.
 * scratch[room] of a thread. */
void dm_cells_push(const dm_cells_split *s, dm_cells_move *v, uint32_t i, uint32_t count,
                   double *scratch);

#endif
