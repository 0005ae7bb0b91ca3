/* processor.h - what the processor can do as far as results depend on it. One level holds for all
 * backends and widths, so that they give the same bits. */
#ifndef DM_PROCESSOR_H
#define DM_PROCESSOR_H

typedef enum {
    DM_PLAIN, /* the C library's functions, 1/sqrt(x) by root and division */
    DM_FMA,   /* AVX2 and fused multiply-add */
    DM_AVX512 /* F, DQ, VL too */
} dm_processor_level;

/* The level that holds now: the machine's, or a lower one that was asked for. */
dm_processor_level dm_processor(void);

/* At most `level` from now on, in the whole process (tests, options); kernels built before are
 * to be built again. */
void dm_processor_limit(dm_processor_level level);

#endif
