/* trace_values.c - traced functions that have no value at all. */
#include "bind/trace/trace.h"
#include "graph/analyse.h"

#include <math.h>

/* A constant that is NaN in a part of L, as where a condition never holds, is not looked at. */
void dml_refusenans(lua_State *L, const dml_traced *traced, const char *what) {
    double x = 0.0;
    for (uint32_t i = 0; traced->graph && i < traced->outputs; i++) {
        if (!dm_is_constant(traced->graph, traced->out[i], &x) || isfinite(x)) continue;
        const char *entry =
            traced->outputs > 1 ? lua_pushfstring(L, "entry %d of ", (int)i + 1) : "";
        luaL_error(L,
                   "%s%s is %s whatever its arguments are: is there a 0/0 in it, or a number that "
                   "overflows?",
                   entry, what, isnan(x) ? "NaN" : "infinite");
    }
}
