/* history.c - history in the XDG state directory. */
#include "cli/history.h"

#include "bind/core/new_file.h"
#include "cli/line.h"

#include <lauxlib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* entries recalled; a file of twice as many is cut */
enum { KEPT = 2000 };

void dml_history_path(lua_State *L, const char *variable, const char *fallback, const char *name) {
    const char *base = getenv(variable), *home = getenv("HOME");
    if (base && base[0] == '/')
        lua_pushfstring(L, "%s/dmlua/%s", base, name);
    else if (home && *home)
        lua_pushfstring(L, "%s/%s/dmlua/%s", home, fallback, name);
    else
        lua_pushnil(L);
}

/* push `line` with \\ and \n read back */
static void push_entry(lua_State *L, const char *line, size_t n) {
    luaL_Buffer b;
    luaL_buffinit(L, &b);
    for (size_t i = 0; i < n; i++) {
        const int escaped = line[i] == '\\' && i + 1 < n;
        if (escaped) i++;
        luaL_addchar(&b, (char)(escaped && line[i] == 'n' ? '\n' : line[i]));
    }
    luaL_pushresult(&b);
}

/* push a list of the lines of a file as they are; their number */
static lua_Integer push_lines(lua_State *L, FILE *file) {
    lua_Integer lines = 0;
    char *line = NULL;
    size_t size = 0;
    lua_newtable(L);
    for (ssize_t n; (n = getline(&line, &size, file)) > 0;) {
        if (line[n - 1] == '\n') n--;
        lua_pushlstring(L, line, (size_t)n);
        lua_rawseti(L, -2, ++lines);
    }
    free(line);
    return lines;
}

/* write the last KEPT of the lines on top of the stack beside the file, then in its place */
static void cut(lua_State *L, const char *path, lua_Integer lines) {
    char beside[DML_FILE_NAME];
    FILE *file = dml_newfile(path, 0600, beside);
    int fine = file != NULL;
    for (lua_Integer i = lines - KEPT + 1; fine && i <= lines; i++) {
        lua_rawgeti(L, -1, i);
        fine = fprintf(file, "%s\n", lua_tostring(L, -1)) > 0;
        lua_pop(L, 1);
    }
    if (file) dml_endfile(file, fine, beside, path);
}

/* One entry a line; those of several lines are kept with escaped ends of line. */
void dml_history_load(lua_State *L, const char *path) {
    FILE *file = fopen(path, "r");
    if (!file) return;
    const lua_Integer lines = push_lines(L, file);
    fclose(file);
    for (lua_Integer i = lines > KEPT ? lines - KEPT + 1 : 1; i <= lines; i++) {
        size_t n;
        lua_rawgeti(L, -1, i);
        const char *line = lua_tolstring(L, -1, &n);
        push_entry(L, line, n);
        dml_line_remember(lua_tostring(L, -1));
        lua_pop(L, 2);
    }
    if (lines > 2 * KEPT) cut(L, path, lines);
    lua_pop(L, 1);
}

/* make the folders that lead to a file */
static void make_folders(lua_State *L, const char *path) {
    for (const char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        lua_pushlstring(L, path, (size_t)(slash - path));
        mkdir(lua_tostring(L, -1), 0700);
        lua_pop(L, 1);
    }
}

/* At once, so that a session that is killed keeps its history; two sessions do not overwrite
 * each other. */
void dml_history_append(lua_State *L, const char *path, const char *entry) {
    FILE *file = fopen(path, "a");
    if (!file) {
        make_folders(L, path);
        file = fopen(path, "a");
    }
    if (!file) return;
    chmod(path, 0600);
    for (; *entry; entry++) {
        if (*entry == '\\') fputc('\\', file);
        if (*entry == '\n')
            fputs("\\n", file);
        else
            fputc(*entry, file);
    }
    fputc('\n', file);
    fclose(file);
}
