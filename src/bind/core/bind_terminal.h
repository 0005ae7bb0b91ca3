/* bind_terminal.h - what a program may know of the terminal it writes to, and the line of
 * progress. */
#ifndef DML_TERMINAL_H
#define DML_TERMINAL_H

#include "bind/core/bind.h"

/* When to colour: FORCE_COLOR, NO_COLOR and TERM decide for auto, unless the environment is
 * not to be read (-E). */
enum { DML_COLOUR_AUTO, DML_COLOUR_ALWAYS, DML_COLOUR_NEVER };
void dml_terminal_choose(int colour, int environment);

/* fd: 1 stdout, 2 stderr */
int dml_terminal_colour(int fd);
void dml_terminal_size(int *width, int *height); /* characters; 80 x 24 when unknown */

/* A line of progress on stderr: only on a terminal, only from half a second after the first call
 * on. fraction done, rate per second. The end erases the line. */
void dml_progress(lua_State *L, const char *what, double fraction, double rate,
                  double seconds_left);
void dml_progress_end(lua_State *L);

#endif
