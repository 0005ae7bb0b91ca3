/* rattle_cells.h - RATTLE for fields whose values are unit vectors, cell by cell: each constraint
 * is on one cell, so its multiplier is the root of a quadratic equation. */
#ifndef DM_RATTLE_CELLS_H
#define DM_RATTLE_CELLS_H

#include "integ/method/method.h"

extern const dm_engine dm_engine_rattle_cells;

#endif
