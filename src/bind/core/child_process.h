/* child_process.h - computations of libraries that ask nobody whether to go on: Ctrl-C ends them,
 * since they run in a process of their own. */
#ifndef DML_CHILD_PROCESS_H
#define DML_CHILD_PROCESS_H

#include "base/arena.h"
#include "base/status.h"

#include <stddef.h>

/* Work on a job, whose fields say what to do and are set to what came out. What it takes from the
 * arena stays; nothing else that it writes is seen by anybody. */
typedef dm_status dml_work(void *job, dm_arena *arena);

/* work(job, an arena of pages that both processes have at the same addresses) in a child. When it
 * is done the job's `size` bytes are as it left them, and the pages, with all that points into
 * them, go with `arena`. DM_STOPPED: *stop was set, and the child was ended; DM_NO_MEMORY: it ended
 * before its time, as one may that takes too much. On any failure the pages go at once. Where there
 * can be no child: work(job, arena) in this process. */
dm_status dml_child(dml_work *work, void *job, size_t size, dm_arena *arena,
                    volatile const int *stop);

/* Seconds of CPU time of this process, all its threads, and of such children; signal handlers may
 * ask. */
double dml_cpu(void);

#endif
