/* gsl_transforms.c - the table of transforms by GSL, which works in place. */
#include "wave/transforms.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_fft_complex.h>
#include <string.h>

/* Tables of sines and scratch of one length; the sign chooses between two functions of GSL. */
typedef struct {
    uint32_t n;
    int sign;
    gsl_fft_complex_wavetable *table;
    gsl_fft_complex_workspace *work;
} gsl_transform;

/* GSL has both from malloc, so they are given back with the arena. */
static void release(void *thing, size_t size) {
    gsl_transform *t = thing;
    (void)size;
    gsl_fft_complex_wavetable_free(t->table);
    gsl_fft_complex_workspace_free(t->work);
    t->table = NULL, t->work = NULL;
}

static dm_status open_transform(dm_transform **made, uint32_t n, int sign, int measure, double *in,
                                double *out, dm_arena *arena) {
    gsl_transform *t = dm_arena_take(arena, sizeof *t);
    (void)measure, (void)in, (void)out;
    if (!t) return DM_NO_MEMORY;
    gsl_set_error_handler_off(); /* NULL, not abort() */
    *t = (gsl_transform){.n = n, .sign = sign};
    t->table = gsl_fft_complex_wavetable_alloc(n);
    t->work = gsl_fft_complex_workspace_alloc(n);
    if (t->table && t->work && dm_arena_on_release(arena, release, t, sizeof *t)) {
        *made = (dm_transform *)(void *)t;
        return DM_OK;
    }
    if (t->table) gsl_fft_complex_wavetable_free(t->table);
    if (t->work) gsl_fft_complex_workspace_free(t->work);
    return DM_NO_MEMORY;
}

static void run(const dm_transform *made, double *out, const double *in) {
    const gsl_transform *t = (const gsl_transform *)(const void *)made;
    memcpy(out, in, 2 * (size_t)t->n * sizeof *out);
    if (t->sign == DM_FORWARD)
        gsl_fft_complex_forward(out, 1, t->n, t->table, t->work);
    else
        gsl_fft_complex_backward(out, 1, t->n, t->table, t->work);
}

const dm_transforms dm_transforms_gsl = {.name = "GSL", .open = open_transform, .run = run};
