/* options.c - reading the command line, and the texts about it. */
#include "cli/options.h"

#include "bind/core/bind_terminal.h"

#include <stdio.h>
#include <string.h>

/* --help, --version, --color=. */
static int long_option(dml_command *c, const char *option) {
    static const char *const when[] = {"auto", "always", "never"};
    static const char colour[] = "--color=";
    if (strcmp(option, "--help") == 0) return c->flags |= DML_HELP;
    if (strcmp(option, "--version") == 0) return c->flags |= DML_ONLY_VERSION;
    if (strncmp(option, colour, sizeof colour - 1) != 0) return 0;
    for (int i = 0; i < 3; i++) {
        if (strcmp(option + sizeof colour - 1, when[i]) != 0) continue;
        c->colour = DML_COLOUR_AUTO + i;
        return 1;
    }
    return 0;
}

/* flag of an option without argument; 0 when there is none of that letter */
static int letter(char option) {
    switch (option) {
    case 'i':
        return DML_INTERACTIVE | DML_VERSION_LINE;
    case 'v':
        return DML_VERSION_LINE;
    case 'E':
        return DML_NO_ENVIRONMENT;
    case 'q':
        return DML_QUIET;
    case 'n':
        return DML_NO_STARTUP;
    default:
        return 0;
    }
}

/* --part k/n or --part=k/n */
static int part_option(dml_command *c, char **argv, int *i) {
    static const char part[] = "--part";
    const size_t length = sizeof part - 1;
    const char *option = argv[*i];
    if (strncmp(option, part, length) != 0) return 0;
    if (option[length] == '=')
        c->part = option + length + 1;
    else if (option[length] == '\0')
        c->part = argv[++*i];
    return c->part != NULL;
}

/* Behind "NAME" or "NAME=": "" or what follows; NULL when the option is another. */
static const char *value_of(const char *option, const char *name) {
    const size_t length = strlen(name);
    if (!option || strncmp(option, name, length) != 0) return NULL;
    if (option[length] == '\0') return "";
    return option[length] == '=' ? option + length + 1 : NULL;
}

/* --where name or --where=name */
static int where_option(dml_command *c, char **argv, int *i) {
    const char *name = value_of(argv[*i], "--where");
    if (!name) return 0;
    if (!*name && argv[*i + 1]) name = argv[++*i];
    c->where = name;
    return 1;
}

/* --machine=in,out and --jupyter or --jupyter=PREFIX */
static int notebook_option(dml_command *c, const char *option) {
    const char *prefix = value_of(option, "--jupyter");
    if (prefix) {
        c->prefix = *prefix ? prefix : NULL;
        return c->flags |= DML_JUPYTER;
    }
    c->machine = value_of(option, "--machine");
    return c->machine != NULL;
}

/* one option at argv[*i], which moves on past a separate argument; 0: wrong */
static int short_option(dml_command *c, char **argv, int *i) {
    const char *option = argv[*i];
    if (option[1] == 'e' || option[1] == 'l') {
        if (option[1] == 'e') c->flags |= DML_EXECUTE;
        if (option[2] == '\0') {
            const char *argument = argv[++*i];
            if (!argument || argument[0] == '-') return 0;
        }
        return 1;
    }
    if (option[2] != '\0') return 0;
    const int flags = letter(option[1]);
    c->flags |= flags;
    return flags || option[1] == 'W';
}

/* --demo, whose name is the next word, or --demo=name */
static int is_demo(const char *option) {
    return strcmp(option, "--demo") == 0 || strncmp(option, DML_DEMO_IS, 7) == 0;
}

/* Only reads: nothing is run before all options are known to be right. */
dml_command dml_command_read(char **argv) {
    dml_command c = {0};
    int i = 1;
    for (; argv[0] && argv[i]; i++) {
        c.script = i;
        if (argv[i][0] != '-' || argv[i][1] == '\0') return c;
        if (strcmp(argv[i], "--") == 0) {
            c.script = i + 1;
            return c;
        }
        if (is_demo(argv[i])) {
            c.flags |= DML_DEMO;
            c.script = argv[i][6] ? i : i + 1;
            return c;
        }
        if (strcmp(argv[i], "--join") == 0) {
            c.flags |= DML_JOIN;
            c.script = i + 1;
            return c;
        }
        const int is_long = argv[i][1] == '-';
        const int fine = is_long ? long_option(&c, argv[i]) || part_option(&c, argv, &i) ||
                                       where_option(&c, argv, &i) || notebook_option(&c, argv[i])
                                 : short_option(&c, argv, &i);
        if (!fine) {
            c.flags |= DML_BAD_OPTION;
            return c;
        }
    }
    c.script = argv[0] ? i : 0;
    return c;
}

/* ---- texts ---- */

typedef struct {
    const char *name, *argument, *what, *more;
} row;

static const row options[] = {
#define OPTION(flag, argument, what, more) {flag, argument, what, more},
#include "cli/manual.def"
    {NULL, NULL, NULL, NULL}};
static const row variables[] = {
#define VARIABLE(name, what) {name, "", what, ""},
#include "cli/manual.def"
    {NULL, NULL, NULL, NULL}};
static const row files[] = {
#define FILE_ROW(path, what) {path, "", what, ""},
#include "cli/manual.def"
    {NULL, NULL, NULL, NULL}};
static const row keys[] = {
#define KEY(key, what) {key, "", what, ""},
#include "cli/manual.def"
    {NULL, NULL, NULL, NULL}};
static const row statuses[] = {
#define STATUS(status, when) {status, "", when, ""},
#include "cli/manual.def"
    {NULL, NULL, NULL, NULL}};

void dml_command_help(const char *program, int to_stderr) {
    FILE *out = to_stderr ? stderr : stdout;
    fprintf(out, "usage: %s [options] [script [args]]\nAvailable options are:\n", program);
    for (const row *r = options; r->name; r++) {
        const int is_long = strncmp(r->name, "--", 2) == 0;
        const char *gap = *r->argument ? (is_long ? "=" : " ") : "";
        const int width = 12 - (int)strlen(r->name) - (int)strlen(gap);
        fprintf(out, "  %s%s%-*s  %s\n", r->name, gap, width, r->argument, r->what);
    }
    fflush(out);
}

void dml_command_wrong(const char *program, const char *option) {
    fprintf(stderr, "%s: ", program);
    if (option[1] == 'e' || option[1] == 'l' || strcmp(option, "--part") == 0)
        fprintf(stderr, "'%s' needs argument\n", option);
    else if (strncmp(option, "--color", 7) == 0)
        fprintf(stderr, "'%s': write --color=auto, --color=always or --color=never\n", option);
    else
        fprintf(stderr, "unrecognized option '%s'\n", option);
    dml_command_help(program, 1);
}

void dml_version_line(void) {
    printf("dmlua %s  %s\n", DM_VERSION, LUA_COPYRIGHT);
    fflush(stdout);
}

void dml_banner(void) {
    printf("dmlua %s  %s  type ? for help\n", DM_VERSION, LUA_VERSION);
    fflush(stdout);
}

/* ---- the same rows for Lua ---- */

static void set_text(lua_State *L, const char *key, const char *text) {
    lua_pushstring(L, text);
    lua_setfield(L, -2, key);
}

/* Rows of the manual as tables, for the man page and completions. */
static void set_rows(lua_State *L, const char *key, const row *rows) {
    lua_newtable(L);
    for (int i = 0; rows[i].name; i++) {
        lua_createtable(L, 0, 4);
        set_text(L, "name", rows[i].name);
        set_text(L, "argument", rows[i].argument);
        set_text(L, "what", rows[i].what);
        set_text(L, "more", rows[i].more);
        lua_rawseti(L, -2, i + 1);
    }
    lua_setfield(L, -2, key);
}

/* The one list of options, as Lua modules read it. */
int dml_open_manual(lua_State *L) {
    lua_newtable(L);
    set_rows(L, "options", options);
    set_rows(L, "variables", variables);
    set_rows(L, "files", files);
    set_rows(L, "keys", keys);
    set_rows(L, "statuses", statuses);
    set_text(L, "version", DM_VERSION);
    set_text(L, "lua", lua_ident);
#ifdef DM_READLINE
    lua_pushboolean(L, 1);
#else
    lua_pushboolean(L, 0);
#endif
    lua_setfield(L, -2, "readline");
    return 1;
}
