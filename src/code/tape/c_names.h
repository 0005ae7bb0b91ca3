/* c_names.h - names that a function in emitted C may have. */
#ifndef DM_C_NAMES_H
#define DM_C_NAMES_H

/* What the name is instead of a free one, as a sentence goes on behind it ("is a word of C"); NULL:
 * it is free. */
const char *dm_c_taken(const char *name);

#endif
