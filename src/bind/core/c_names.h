/* c_names.h - names that a function in emitted C may have. */
#ifndef DML_C_NAMES_H
#define DML_C_NAMES_H

/* What the name is instead of a free one, as a sentence goes on behind it ("is a word of C"); NULL:
 * it is free. */
const char *dml_c_taken(const char *name);

#endif
