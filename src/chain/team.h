/* team.h - threads that wait for work between the bursts of a run. All parts of a piece of work
 * meet at barriers, which spin a while and then give way: a step has a few, microseconds apart. */
#ifndef DM_TEAM_H
#define DM_TEAM_H

#include <stddef.h>
#include <stdint.h>

enum { DM_TEAM_MOST = 16 };

typedef struct dm_team dm_team;

/* Part `part` of `parts` of some work. */
typedef void dm_team_work(void *context, uint32_t part, uint32_t parts);

/* Doubles of memory for a team. */
size_t dm_team_size(void);

/* A team of `threads` with the caller, in memory[dm_team_size()]; fewer where the system gives no
 * more. */
dm_team *dm_team_open(double *memory, int threads);
void dm_team_close(dm_team *t);
uint32_t dm_team_parts(const dm_team *t);

/* All parts side by side; returns when the last one is done. t = NULL: one part. */
void dm_team_run(dm_team *t, dm_team_work *work, void *context);

/* Inside of such work: goes on when all parts have come here. */
void dm_team_meet(dm_team *t);

#endif
