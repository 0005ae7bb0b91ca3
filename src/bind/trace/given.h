/* given.h - rounds of a sum that are compared with the term that was traced. A test with == inside
 * of a term sees a symbol while it is traced, and may hold in few rounds: of bodies, or cells, that
 * are not like the others. */
#ifndef DML_GIVEN_H
#define DML_GIVEN_H

#include "bind/core/state.h"

/* Every so many'th of `rounds` is to be compared now, from the first one on, and the last one: many
 * where this sum is looked at for the first time. */
uint32_t dml_given_stride(dml_given *given, uint32_t rounds);

/* What round `round` of `rounds` is when called and as it was traced; `what`: the function. */
void dml_given_compare(dml_given *given, const char *what, uint32_t round, uint32_t rounds,
                       double plain, double traced);

#endif
