/* bind_pin.c - `dm.pin`: measured times are of one core, not of the way from one to another. */
#ifdef __linux__
#define _GNU_SOURCE /* sched_setaffinity */
#include <sched.h>
#endif
#include "bind/core/bind.h"

#include <string.h>

/* dm.pin() -> the set of cores before, as bytes; nothing where that is not possible */
static int pin(lua_State *L) {
#ifdef __linux__
    cpu_set_t before, one;
    const int here = sched_getcpu();
    if (here < 0 || sched_getaffinity(0, sizeof before, &before) != 0) return 0;
    CPU_ZERO(&one);
    CPU_SET((size_t)here, &one);
    if (sched_setaffinity(0, sizeof one, &one) != 0) return 0;
    lua_pushlstring(L, (const char *)&before, sizeof before);
    return 1;
#else
    (void)L;
    return 0;
#endif
}

/* dm.unpin(before) */
static int unpin(lua_State *L) {
#ifdef __linux__
    size_t size = 0;
    const char *bytes = luaL_optlstring(L, 1, NULL, &size);
    cpu_set_t before;
    if (!bytes) return 0;
    luaL_argcheck(L, size == sizeof before, 1, "not what dm.pin() gave");
    memcpy(&before, bytes, sizeof before);
    lua_pushboolean(L, sched_setaffinity(0, sizeof before, &before) == 0);
    return 1;
#else
    (void)L;
    return 0;
#endif
}

static const dml_row functions[] =
    {{"pin", pin,
      "dm.pin() -> string or nothing\n"
      "Keep this thread on the core where it runs, so that measured times are of one core; threads "
      "that it makes stay there, too. Returns what dm.unpin takes to undo it; nothing where the "
      "system cannot."},
     {"unpin", unpin,
      "dm.unpin(before) -> boolean\n"
      "Undo dm.pin(): `before` is what it returned. Whether it was done; nothing without an "
      "argument."},
     {NULL, NULL, NULL}};

const dml_class dml_class_pin = {
    .functions = functions,
};
