/* ranks.h - what the core uses of MPI, as a table that dm/mpi.so holds: it alone sees mpi.h. */
#ifndef DM_RANKS_H
#define DM_RANKS_H

#include <stddef.h>

/* All messages are bytes. Every function but open is for a process that has been opened. */
typedef struct {
    /* Begin, once; without mpirun rank 0 of 1. NULL, or why not. */
    const char *(*open)(int *rank, int *size);
    void (*send)(int to, int tag, const void *bytes, size_t size);
    /* The sender and size of a message that has come, or (wait) comes; from < 0: of anybody; 0:
     * there is none. Its bytes are taken by `receive` from that sender. */
    int (*probe)(int *from, int tag, size_t *size, int wait);
    void (*receive)(int from, int tag, void *bytes, size_t size);
    void (*broadcast)(int root, void *bytes, size_t size);
    void (*barrier)(void);
    void (*end)(int status); /* of this process; not 0: all ranks are ended */
} dm_ranks;

#endif
