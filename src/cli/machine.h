/* machine.h - a session for a program instead of a person: dmlua --machine IN,OUT. */
#ifndef DML_MACHINE_H
#define DML_MACHINE_H

#include <lua.h>

/* Answer the frames of the descriptors in `ends`, "IN,OUT", until they end; the protocol stands in
 * lua/dm/notebook/machine.lua. 0, with a message: they are no two open descriptors. */
int dml_machine(lua_State *L, const char *ends);

#endif
