/* new_file.h - a file that takes the place of another one when it is whole: its name cannot be
 * foreseen, so that no link of somebody else lies in its way, and a crash leaves the old one. */
#ifndef DML_NEW_FILE_H
#define DML_NEW_FILE_H

#include "bind/core/bind.h"

#include <stdio.h>
#include <sys/types.h>

enum { DML_FILE_NAME = 4096 };

/* The name of a file at arg. Raises where a zero byte would cut it to that of another file. */
const char *dml_filename(lua_State *L, int arg);

/* A new file beside `file`, open for writing, its name, which ends as that of `file`, in `name`.
 * Such of runs that were killed over an hour ago are removed. NULL: errno says why. */
FILE *dml_newfile(const char *file, mode_t mode, char name[DML_FILE_NAME]);

/* Close it and, where `whole` and all of it is on the disk, put it in the place of `file`; else
 * remove it. 0: errno says why. */
int dml_endfile(FILE *f, int whole, const char *name, const char *file);

/* The lock of an open file: NULL, it is this process's until any descriptor of the file is closed;
 * or why not, EAGAIN in errno where another process has it. A child that is forked has no lock. */
const char *dml_lockfile(lua_State *L, int fd);

/* From now on nothing is put in its place: of many ranks one writes. */
void dml_silencefiles(void);
int dml_issilent(void);

/* core.new_file and core.end_file, for what other programs write */
int dml_core_new_file(lua_State *L);
int dml_core_end_file(lua_State *L);
int dml_core_is_silent(lua_State *L);

/* core.cut_file, for rows that a run which goes on writes anew */
int dml_core_cut_file(lua_State *L);

/* core.lock_file, for rows that are written as they come */
int dml_core_lock_file(lua_State *L);

#endif
