/* mpi.c - dm/mpi.so: ranks.h by MPI. Messages longer than an int counts go in pieces. */
#define _GNU_SOURCE /* dladdr */
#include "mpi/ranks.h"

#include <dlfcn.h>
#include <mpi.h>
#include <stdint.h>

static const size_t PIECE = (size_t)1 << 28; /* bytes of a call */

/* Open MPI's components look for its symbols among the global ones, where a module that was opened
 * locally has not put them. */
static void make_global(void) {
    Dl_info info;
    if (dladdr((void *)(uintptr_t)&MPI_Init, &info) && info.dli_fname)
        dlopen(info.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
}

static const char *open_ranks(int *rank, int *size) {
    int there = 0;
    make_global();
    if (MPI_Initialized(&there) != MPI_SUCCESS) return "MPI does not answer";
    if (!there && MPI_Init(NULL, NULL) != MPI_SUCCESS) return "MPI_Init failed";
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, size);
    return NULL;
}

/* the length goes first, in a message of its own */
static void send_bytes(int to, int tag, const void *bytes, size_t size) {
    const uint64_t length = size;
    MPI_Send(&length, 1, MPI_UINT64_T, to, tag, MPI_COMM_WORLD);
    for (size_t done = 0; done < size; done += PIECE) {
        const size_t piece = size - done < PIECE ? size - done : PIECE;
        MPI_Send((const char *)bytes + done, (int)piece, MPI_BYTE, to, tag, MPI_COMM_WORLD);
    }
}

/* the length of the next message, which is taken; its bytes are left */
static int probe(int *from, int tag, size_t *size, int wait) {
    MPI_Status status;
    uint64_t length;
    int there = 1;
    const int source = *from < 0 ? MPI_ANY_SOURCE : *from;
    if (wait)
        MPI_Probe(source, tag, MPI_COMM_WORLD, &status);
    else
        MPI_Iprobe(source, tag, MPI_COMM_WORLD, &there, &status);
    if (!there) return 0;
    *from = status.MPI_SOURCE;
    MPI_Recv(&length, 1, MPI_UINT64_T, *from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    *size = (size_t)length;
    return 1;
}

static void receive(int from, int tag, void *bytes, size_t size) {
    for (size_t done = 0; done < size; done += PIECE) {
        const size_t piece = size - done < PIECE ? size - done : PIECE;
        MPI_Recv((char *)bytes + done, (int)piece, MPI_BYTE, from, tag, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
    }
}

/* of the root to all, in pieces alike */
static void broadcast(int root, void *bytes, size_t size) {
    for (size_t done = 0; done < size; done += PIECE) {
        const size_t piece = size - done < PIECE ? size - done : PIECE;
        MPI_Bcast((char *)bytes + done, (int)piece, MPI_BYTE, root, MPI_COMM_WORLD);
    }
}

static void barrier(void) {
    MPI_Barrier(MPI_COMM_WORLD);
}

/* once; after MPI_Abort nobody comes back */
static void end(int status) {
    int over = 0;
    MPI_Finalized(&over);
    if (over) return;
    if (status != 0)
        MPI_Abort(MPI_COMM_WORLD, status);
    else
        MPI_Finalize();
}

const dm_ranks dm_mpi = {
    .open = open_ranks,
    .send = send_bytes,
    .probe = probe,
    .receive = receive,
    .broadcast = broadcast,
    .barrier = barrier,
    .end = end,
};
