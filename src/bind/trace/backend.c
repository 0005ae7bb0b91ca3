#include "bind/trace/backend.h"

#include "bind/trace/cc.h"
#include "code/native/jit.h"
#include "code/tape/tape.h"
#include "numbers/fma.h"
#include "numbers/processor.h"

#include <stdlib.h>
#include <string.h>

/* "jit" is the tape where the processor or the system has no native code for it, "cc" where
 * there is no compiler */
static const dml_backend backends[] = {{"jit", dm_native_build, NULL},
                                       {"tape", dm_tape_build, NULL},
                                       {"cc", dml_cc_or_tape, NULL},
                                       {NULL, NULL, NULL}};

/* `from`: where the name was given, for the message. */
static const dml_backend *by_name(lua_State *L, const char *name, const char *from) {
    luaL_Buffer b;
    for (const dml_backend *row = backends; row->name; row++)
        if (strcmp(row->name, name) == 0 && (!row->available || row->available())) return row;
    luaL_buffinit(L, &b);
    for (const dml_backend *row = backends; row->name; row++) {
        if (row != backends) luaL_addstring(&b, ", ");
        luaL_addstring(&b, row->name);
    }
    luaL_pushresult(&b);
    luaL_error(L, "%s must be one of: %s (got '%s')", from, lua_tostring(L, -1), name);
    return NULL;
}

/* An option comes before the environment. */
const dml_backend *dml_findbackend(lua_State *L, const char *name) {
    if (name) return by_name(L, name, "field 'backend'");
    const char *env = getenv("DMLUA_BACKEND");
    if (env && *env) return by_name(L, env, "environment variable DMLUA_BACKEND");
    const dml_backend *row = backends;
    while (row->available && !row->available()) row++;
    return row;
}

/* Once, when the bindings open: kernels that are there stay as they are. */
void dml_limitprocessor(lua_State *L) {
    static const char *const names[] =
        {[DM_PLAIN] = "plain", [DM_FMA] = "fma", [DM_AVX512] = "avx512"};
    const char *text = getenv("DMLUA_PROCESSOR");
    if (!text || !*text) return;
    for (int level = DM_PLAIN; level <= DM_AVX512; level++)
        if (strcmp(text, names[level]) == 0) {
            dm_processor_limit((dm_processor_level)level);
            dm_fma_allow(level > DM_PLAIN);
            return;
        }
    luaL_error(L, "environment variable DMLUA_PROCESSOR must be plain, fma or avx512 (got '%s')",
               text);
}
