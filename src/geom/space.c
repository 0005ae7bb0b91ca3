/* space.c - the list of spaces.def as a table. */
#include "geom/space.h"

#include <stddef.h>

const dm_space *const dm_spaces[] = {
#define X(name) &dm_space_##name,
#include "geom/spaces.def"
#undef X
    NULL};
