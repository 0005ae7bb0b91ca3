/* sums_text.h - the sums of sweep_row.h for W members, every stage of whom is a number of its own;
 * a text for files that have numbers/lanes_text.h. Orders of addition are those that the lanes of
 * one member's registers have. */
#ifndef DM_SUMS_TEXT_H
#define DM_SUMS_TEXT_H

#include "numbers/lanes_text.h"

/* of terms[width], as lanes of one register are added up there: halves, then their halves */
INLINE V total_of(const V *t, uint32_t width) {
    if (width == 1) return t[0];
    if (width == 4) return (t[0] + t[2]) + (t[1] + t[3]);
    return ((t[0] + t[4]) + (t[1] + t[5])) + ((t[2] + t[6]) + (t[3] + t[7]));
}

INLINE V moved_of(const V *t, uint32_t width) {
    if (width == 1) return t[0];
    if (width == 4) return (t[0] + t[2]) + (t[1] + t[3]);
    return ((t[0] + t[4]) + (t[2] + t[6])) + ((t[1] + t[5]) + (t[3] + t[7]));
}

#endif
