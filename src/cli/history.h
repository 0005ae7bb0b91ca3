/* history.h - the entries of earlier sessions, one a line; newlines are written \n, \ is \\. */
#ifndef DML_HISTORY_H
#define DML_HISTORY_H

#include <lua.h>

/* Push $<variable>/dmlua/<name>, by default under ~/<fallback>; nil without a home. */
void dml_history_path(lua_State *L, const char *variable, const char *fallback, const char *name);

/* Give every kept entry to dml_line_remember; a file grown too long is cut to its end. */
void dml_history_load(lua_State *L, const char *path);

/* Append one entry; folders are made. A file that cannot be written is left alone. */
void dml_history_append(lua_State *L, const char *path, const char *entry);

#endif
