/* team.c - a team is a counting barrier, and a mutex with a condition for threads that wait. */
#include "chain/team.h"

#include "base/doubles.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

/* looks at a number that another thread changes before a thread gives way, and before it sleeps:
 * some 1 and 20 microseconds, as a burst follows soon on the one before */
enum { SPINS = 2000, PATIENCE = 50000 };

typedef struct {
    dm_team *team;
    uint32_t part;
} member;

struct dm_team {
    pthread_mutex_t lock;
    pthread_cond_t begin;
    pthread_t thread[DM_TEAM_MOST];
    member of[DM_TEAM_MOST];
    uint32_t parts;
    atomic_uint burst;  /* number of the work that is to be done */
    dm_team_work *work; /* NULL: the team is closed */
    void *context;
    atomic_uint waiting, phase; /* of the barrier */
};

size_t dm_team_size(void) {
    return dm_doubles(sizeof(dm_team));
}

uint32_t dm_team_parts(const dm_team *t) {
    return t ? t->parts : 1;
}

void dm_team_meet(dm_team *t) {
    if (!t || t->parts < 2) return;
    const unsigned phase = atomic_load(&t->phase);
    if (atomic_fetch_add(&t->waiting, 1) + 1 == t->parts) {
        atomic_store(&t->waiting, 0);
        atomic_store(&t->phase, phase + 1);
        return;
    }
    for (int spins = 0; atomic_load(&t->phase) == phase;)
        if (spins < SPINS)
            spins++;
        else
            sched_yield();
}

/* Returns when the burst is another one than `done`. */
static void await(dm_team *t, unsigned done) {
    for (int spins = 0; spins < PATIENCE; spins++)
        if (atomic_load(&t->burst) != done) return;
    pthread_mutex_lock(&t->lock);
    while (atomic_load(&t->burst) == done) pthread_cond_wait(&t->begin, &t->lock);
    pthread_mutex_unlock(&t->lock);
}

/* the next burst, of this work */
static void call(dm_team *t, dm_team_work *work, void *context) {
    pthread_mutex_lock(&t->lock);
    t->work = work;
    t->context = context;
    atomic_fetch_add(&t->burst, 1);
    pthread_cond_broadcast(&t->begin);
    pthread_mutex_unlock(&t->lock);
}

/* a thread of the team, until it is closed */
static void *serve(void *of) {
    const member *m = of;
    dm_team *t = m->team;
    for (unsigned done = 0;; done++) {
        await(t, done);
        if (!t->work) return NULL;
        t->work(t->context, m->part, t->parts);
        dm_team_meet(t);
    }
}

dm_team *dm_team_open(double *memory, int threads) {
    dm_team *t = (dm_team *)(void *)memory;
    if (threads > DM_TEAM_MOST) threads = DM_TEAM_MOST;
    *t = (dm_team){.parts = 1};
    atomic_init(&t->waiting, 0);
    atomic_init(&t->phase, 0);
    atomic_init(&t->burst, 0);
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->begin, NULL);
    while ((int)t->parts < threads) {
        t->of[t->parts] = (member){t, t->parts};
        if (pthread_create(t->thread + t->parts, NULL, serve, t->of + t->parts) != 0) break;
        t->parts++;
    }
    return t;
}

void dm_team_close(dm_team *t) {
    if (!t) return;
    call(t, NULL, NULL);
    for (uint32_t k = 1; k < t->parts; k++) pthread_join(t->thread[k], NULL);
    pthread_cond_destroy(&t->begin);
    pthread_mutex_destroy(&t->lock);
}

void dm_team_run(dm_team *t, dm_team_work *work, void *context) {
    if (!t || t->parts < 2) {
        work(context, 0, 1);
        return;
    }
    call(t, work, context);
    work(context, 0, t->parts);
    dm_team_meet(t);
}
