/* child_process.c - a child and this process share pages that are reserved before it begins, many
 * more than there is memory: only those that are written to are there. The parent waits at the end
 * of a pipe that nobody writes to, which closes with the child, and looks at stop meanwhile. */
#define _GNU_SOURCE /* MAP_ANONYMOUS, MADV_REMOVE */
#include "bind/core/child_process.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* CPU time, s, of children that have ended, and the clock of the one that works */
static volatile double ended;
static volatile clockid_t working;
static volatile sig_atomic_t is_working;

enum { WAIT = 50 /* ms between looks at stop */, ALIGNMENT = 64, TIMES = 8 };

/* the head of the shared pages: the job stands behind it, blocks behind that */
typedef struct {
    size_t room, used; /* bytes, from the head */
    size_t page;       /* bytes */
    dm_arena arena;    /* of blocks of these pages */
    dm_status status;  /* of the work */
} shared;

static size_t rounded(size_t size) {
    return (size + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
}

/* ---- memory ---- */

/* whole pages of a block that is free are given back; its addresses are not used again */
static void give_back(const shared *s, void *block, size_t size) {
#ifdef MADV_REMOVE
    const uintptr_t from = ((uintptr_t)block + s->page - 1) & ~(s->page - 1);
    const uintptr_t to = ((uintptr_t)block + size) & ~(s->page - 1);
    if (to > from) madvise((void *)from, to - from, MADV_REMOVE);
#else
    (void)s, (void)block, (void)size;
#endif
}

/* One block behind the other. None is resized, as with arenas of Lua's memory. */
static void *allocate(void *ud, void *block, size_t old_size, size_t new_size) {
    shared *s = ud;
    if (block && !new_size) give_back(s, block, old_size);
    if (block || !new_size || new_size > s->room - s->used - ALIGNMENT) return NULL;
    unsigned char *now = (unsigned char *)s + s->used;
    s->used += rounded(new_size);
    return now;
}

static void unmap(void *pages, size_t size) {
    munmap(pages, size);
}

/* pages with a copy of the job in them; NULL: there are none to be had */
static shared *reserve(const void *job, size_t size) {
    const long page = sysconf(_SC_PAGESIZE), pages = sysconf(_SC_PHYS_PAGES);
    if (page <= 0 || pages <= 0) return NULL;
    const size_t room = (size_t)page * (size_t)pages * TIMES;
    shared *s =
        mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (s == MAP_FAILED) return NULL;
    *s = (shared){.room = room, .page = (size_t)page, .status = DM_NO_MEMORY};
    s->used = rounded(sizeof *s) + rounded(size);
    memcpy((unsigned char *)s + rounded(sizeof *s), job, size);
    dm_arena_init(&s->arena, allocate, s);
    return s;
}

/* ---- the child ---- */

/* A terminal sends SIGINT to both, and the parent decides; a child goes with its parent. */
static void be_child(shared *s, dml_work *work, const int *ends) {
    signal(SIGINT, SIG_IGN);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    close(ends[0]);
    s->status = work((unsigned char *)s + rounded(sizeof *s), &s->arena);
    _exit(0);
}

/* the child's end, and what it cost */
static void reap(pid_t child) {
    struct rusage used;
    is_working = 0;
    while (wait4(child, NULL, 0, &used) < 0)
        if (errno != EINTR) return;
    ended += (double)used.ru_utime.tv_sec + 1e-6 * (double)used.ru_utime.tv_usec;
    ended += (double)used.ru_stime.tv_sec + 1e-6 * (double)used.ru_stime.tv_usec;
}

/* s of a clock; 0: that of a child which is gone */
static double seconds(clockid_t clock) {
    struct timespec t;
    if (clock_gettime(clock, &t) != 0) return 0.0;
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double dml_cpu(void) {
    return seconds(CLOCK_PROCESS_CPUTIME_ID) + ended + (is_working ? seconds(working) : 0.0);
}

/* until the child has ended or stop is set; then it is ended */
static int wait_for(pid_t child, int end, volatile const int *stop) {
    struct pollfd line = {.fd = end, .events = POLLIN};
    clockid_t clock;
    if (clock_getcpuclockid(child, &clock) == 0) working = clock, is_working = 1;
    while (!*stop && poll(&line, 1, WAIT) <= 0) continue;
    const int stopped = line.revents == 0;
    if (stopped) kill(child, SIGKILL);
    reap(child);
    return stopped;
}

/* the work in a child; 0: there can be none */
static int run(shared *s, dml_work *work, volatile const int *stop) {
    int ends[2];
    if (pipe(ends) != 0) return 0;
    const pid_t child = fork();
    if (child == 0) be_child(s, work, ends);
    close(ends[1]);
    if (child > 0 && wait_for(child, ends[0], stop)) s->status = DM_STOPPED;
    close(ends[0]);
    return child > 0;
}

dm_status dml_child(dml_work *work, void *job, size_t size, dm_arena *arena,
                    volatile const int *stop) {
    shared *s = reserve(job, size);
    if (!s) return work(job, arena);
    if (!run(s, work, stop)) {
        unmap(s, s->room);
        return work(job, arena);
    }
    dm_status status = s->status;
    memcpy(job, (unsigned char *)s + rounded(sizeof *s), size);
    if (status == DM_OK && !dm_arena_on_release(arena, unmap, s, s->room)) status = DM_NO_MEMORY;
    if (status != DM_OK) unmap(s, s->room);
    return status;
}
