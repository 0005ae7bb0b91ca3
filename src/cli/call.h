/* call.h - protected calls with traceback and Ctrl-C, and reports of what went wrong. */
#ifndef DML_CALL_H
#define DML_CALL_H

#include <lua.h>

/* stands before messages; NULL in a session */
extern const char *dml_program;

/* Call the function below its `arguments`: a traceback is added to a message, Ctrl-C stops. */
int dml_call(lua_State *L, int arguments, int results);

/* The same, but a dm.failure stays what it is. */
int dml_call_keeping(lua_State *L, int arguments, int results);

/* Ctrl-C stops what runs in the thread co from now on; gives the thread before. */
lua_State *dml_running(lua_State *co);

/* Has Ctrl-C just raised an error that no function of the user has dealt with yet? Asked when a
 * thread ended by an error: it then goes on in the one that runs. */
int dml_interrupted(void);

/* From now on Ctrl-C does nothing between calls, instead of killing: for a session. */
void dml_drop_interrupts(void);

/* Did SIGTERM end what ran? */
int dml_terminated(void);

/* Did Ctrl-C end the script, and no pcall of it? */
int dml_ended_by_interrupt(void);

/* Is the value at `index` a dm.failure? */
int dml_is_failure(lua_State *L, int index);

void dml_message(const char *program, const char *text);

/* Print and pop the message of a status that is not LUA_OK; give the status back. */
int dml_report(lua_State *L, int status);

/* Add to the message on top, of a chunk that does not compile, what is to be written instead, where
 * that is known. The chunk is a text, or that of a file where text is NULL. */
void dml_explain_syntax(lua_State *L, const char *text, const char *file);

/* Push `field` of module `name` (require'd; both functions of the session itself). A status. */
int dml_push_function(lua_State *L, const char *name, const char *field);

#endif
