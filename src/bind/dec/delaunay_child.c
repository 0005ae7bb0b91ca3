/* delaunay_child.c - the child has a copy of all that it needs and writes into a pipe: a head, then
 * the simplices. The parent looks at stop while it waits. */
#include "bind/dec/delaunay_child.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum { FEW = 5000, WAIT = 50 /* ms between looks at stop */ };

typedef struct {
    dm_status status;
    uint32_t cells;
    dm_delaunay_report report;
} head;

typedef struct {
    int from; /* end of the pipe to read */
    pid_t child;
    volatile const int *stop;
} line;

static int write_all(int to, const void *block, size_t size) {
    const char *at = block;
    while (size > 0) {
        const ssize_t n = write(to, at, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return 0;
        at += n, size -= (size_t)n;
    }
    return 1;
}

/* DM_NO_MEMORY: the child ended before its time, as for want of memory it may */
static dm_status read_all(const line *l, void *block, size_t size) {
    char *at = block;
    while (size > 0) {
        struct pollfd ready = {.fd = l->from, .events = POLLIN};
        const int polled = poll(&ready, 1, WAIT);
        if (*l->stop) return DM_STOPPED;
        if (polled <= 0) continue;
        const ssize_t n = read(l->from, at, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return DM_NO_MEMORY;
        at += n, size -= (size_t)n;
    }
    return DM_OK;
}

/* simplices of a triangulation that is done; where there is none, why */
static dm_status receive(const line *l, uint32_t **cell, uint32_t *cells, uint32_t n,
                         dm_arena *arena, dm_delaunay_report *report) {
    head h;
    dm_status status = read_all(l, &h, sizeof h);
    if (status != DM_OK) return status;
    *report = h.report;
    *cells = h.cells;
    if (h.status != DM_OK) return h.status;
    const size_t size = (size_t)h.cells * (n + 1) * sizeof **cell;
    *cell = dm_arena_take(arena, size + 1);
    return *cell ? read_all(l, *cell, size) : DM_NO_MEMORY;
}

dm_status dml_triangulate(const dm_delaunay *table, uint32_t **cell, uint32_t *cells,
                          const double *points, uint32_t count, uint32_t n, dm_arena *arena,
                          volatile const int *stop, dm_delaunay_report *report) {
    int ends[2];
    if (count <= FEW || pipe(ends) != 0)
        return table->triangulate(cell, cells, points, count, n, arena, report);
    line l = {ends[0], fork(), stop};
    if (l.child == 0) {
        signal(SIGINT, SIG_IGN); /* a terminal sends it to both: the parent decides */
        close(ends[0]);
        head h = {.cells = 0};
        h.status = table->triangulate(cell, &h.cells, points, count, n, arena, &h.report);
        const int sent = write_all(ends[1], &h, sizeof h) &&
                         (h.status != DM_OK ||
                          write_all(ends[1], *cell, (size_t)h.cells * (n + 1) * sizeof **cell));
        _exit(sent ? 0 : 1);
    }
    close(ends[1]);
    const dm_status status = l.child < 0
                                 ? table->triangulate(cell, cells, points, count, n, arena, report)
                                 : receive(&l, cell, cells, n, arena, report);
    close(ends[0]);
    if (l.child > 0) {
        kill(l.child, SIGKILL); /* one that has ended stays until it is waited for */
        while (waitpid(l.child, NULL, 0) < 0 && errno == EINTR) continue;
    }
    return status;
}
