/* doubles.h - a block of doubles and the arrays that it is divided into, one behind the other: the
 * workspace of a stepper, whose size is asked for before there is memory for it. */
#ifndef DM_DOUBLES_H
#define DM_DOUBLES_H

#include <stddef.h>

/* Doubles that hold so many bytes. */
static inline size_t dm_doubles(size_t bytes) {
    return (bytes + sizeof(double) - 1) / sizeof(double);
}

static inline size_t dm_larger(size_t a, size_t b) {
    return a > b ? a : b;
}

/* The next `count` doubles; *memory moves behind them. */
static inline double *dm_take(double **memory, size_t count) {
    double *block = *memory;
    *memory += count;
    return block;
}

/* The same where one function counts and divides; memory NULL: it is only counted. */
typedef struct {
    double *memory;
    size_t used;
} dm_layout;

/* The next `count` doubles; where memory is only counted a NULL, which nobody reads. */
static inline double *dm_layout_take(dm_layout *to, size_t count) {
    double *block = to->memory ? to->memory + to->used : NULL;
    to->used += count;
    return block;
}

#endif
