/* options.h - the command line: Lua 5.4's options, and a few of our own. */
#ifndef DML_OPTIONS_H
#define DML_OPTIONS_H

#include <lua.h>

enum {
    DML_INTERACTIVE = 1,    /* -i */
    DML_VERSION_LINE = 2,   /* -v, and -i which implies it */
    DML_EXECUTE = 4,        /* -e */
    DML_NO_ENVIRONMENT = 8, /* -E */
    DML_QUIET = 16,
    DML_NO_STARTUP = 32,
    DML_HELP = 64,
    DML_ONLY_VERSION = 128,
    DML_BAD_OPTION = 256,
    DML_DEMO = 512,    /* what follows are words for the demonstration */
    DML_JOIN = 1024,   /* what follows are names of journals */
    DML_JUPYTER = 2048 /* install the kernel of notebooks */
};

/* before the name of a demonstration, where it is in the same word */
#define DML_DEMO_IS "--demo="

typedef struct {
    int flags;
    int script;          /* index of the script, argc when none; of the wrong option when bad */
    int colour;          /* DML_COLOUR_... */
    const char *part;    /* behind --part, or NULL */
    const char *machine; /* behind --machine=, or NULL */
    const char *prefix;  /* behind --jupyter=, or NULL */
    const char *where;   /* behind --where, or NULL */
} dml_command;

/* Read argv; runs nothing. */
dml_command dml_command_read(char **argv);

/* The text of --help: usage and one line per option, to stdout or after a wrong option to
 * stderr. */
void dml_command_help(const char *program, int to_stderr);
void dml_command_wrong(const char *program, const char *option);

void dml_version_line(void); /* -v, as Lua's with our name before it */
void dml_banner(void);       /* one line at the start of a session */

/* Loader of module dm.manual: the rows of manual.def as a table. */
int dml_open_manual(lua_State *L);

#endif
