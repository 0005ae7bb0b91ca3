#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* as the files that need it ask, who come too late behind this */
#endif
/* what clang-tidy cannot know of Lua: these never return */
#include <lauxlib.h>
__attribute__((noreturn)) int lua_error(lua_State *L);
__attribute__((noreturn)) int luaL_error(lua_State *L, const char *format, ...);
__attribute__((noreturn)) int luaL_argerror(lua_State *L, int arg, const char *message);
__attribute__((noreturn)) int luaL_typeerror(lua_State *L, int arg, const char *name);
