/* fftw_transforms.c - dm/fft.so: the table of transforms by FFTW. Plans are chosen by rule
 * (FFTW_ESTIMATE), so that bits do not depend on timings, or by timing once (FFTW_MEASURE), where
 * what was chosen, FFTW's wisdom, is kept in a file. */
#include "wave/transforms.h"

#include <fftw3.h>

/* A plan is FFTW's own, from its own allocator. */
static void release(void *thing, size_t size) {
    (void)size;
    fftw_destroy_plan(thing);
}

static dm_status open_transform(dm_transform **made, uint32_t n, int sign, int measure, double *in,
                                double *out, dm_arena *arena) {
    const unsigned how = FFTW_PRESERVE_INPUT | (measure ? FFTW_MEASURE : FFTW_ESTIMATE);
    const fftw_plan plan =
        fftw_plan_dft_1d((int)n, (fftw_complex *)in, (fftw_complex *)out, sign, how);
    if (!plan) return DM_NO_MEMORY;
    if (!dm_arena_on_release(arena, release, plan, 0)) {
        fftw_destroy_plan(plan);
        return DM_NO_MEMORY;
    }
    *made = (dm_transform *)(void *)plan;
    return DM_OK;
}

/* FFTW does not change what it preserves, but takes no const. */
static void run(const dm_transform *t, double *out, const double *in) {
    fftw_execute_dft((fftw_plan)(uintptr_t)t, (fftw_complex *)(uintptr_t)in, (fftw_complex *)out);
}

/* Wisdom of the file is added to that of the process. */
static int recall(const char *file) {
    return fftw_import_wisdom_from_filename(file);
}

/* All that the process knows by now. */
static int keep(const char *file) {
    return fftw_export_wisdom_to_filename(file);
}

extern const dm_transforms dm_transforms_table;
const dm_transforms dm_transforms_table = {.name = "FFTW",
                                           .open = open_transform,
                                           .run = run,
                                           .recall = recall,
                                           .keep = keep};
