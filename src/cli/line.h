/* line.h - one line from the user: readline on a terminal, plain stdio in a build without it. */
#ifndef DML_LINE_H
#define DML_LINE_H

#include <lua.h>

typedef enum { DML_LINE, DML_LINE_END, DML_LINE_CANCELLED } dml_line_result;

/* Prepare for a session; L is asked for completions. */
void dml_line_open(lua_State *L);

/* Push a line without its newline (nothing when the input ended or Ctrl-C dropped the entry). */
dml_line_result dml_line_read(lua_State *L, const char *prompt);

/* What was typed before on earlier lines of the same entry, for completion. */
void dml_line_before(const char *text);

/* Entries for recall, oldest first. */
void dml_line_remember(const char *entry);

#endif
