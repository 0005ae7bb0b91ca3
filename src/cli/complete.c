/* complete.c - completion of what stands before the cursor. No code of the user runs: dm.complete
 * looks with raw accesses, hooks are off, and the collector, with its finalizers, waits. */
#ifdef DM_READLINE

#include "cli/complete.h"

#include "cli/call.h"

#include <lauxlib.h>
#include <readline/readline.h>
#include <stdlib.h>
#include <string.h>

static lua_State *asked;
static const char *before = "";

/* whatever cannot be part of a Lua name ends a word */
static const char breaks[] = " \t\n\"\\'`@$><=;|&{(}),:.[]+-*/%^~#?!";

/* the i-th candidate of the list on top, as memory for readline */
static char *candidate(const char *text, int state) {
    static lua_Integer i;
    (void)text;
    if (state == 0) i = 0;
    lua_rawgeti(asked, -1, ++i);
    const char *word = lua_tostring(asked, -1);
    char *copy = word ? malloc(strlen(word) + 1) : NULL;
    if (copy) strcpy(copy, word);
    lua_pop(asked, 1);
    return copy;
}

/* push the list of candidates, or true for file names; a status */
static int ask(int end) {
    lua_State *L = asked;
    const int status = dml_push_function(L, "dm.session.complete", "candidates");
    if (status != LUA_OK) return status;
    lua_pushstring(L, before);
    lua_pushlstring(L, rl_line_buffer, (size_t)end);
    lua_concat(L, 2);
    return lua_pcall(L, 1, 1, 0);
}

/* readline asks for candidates between start and end; they come from Lua, which runs no code of
 * the user for it. */
static char **attempt(const char *text, int start, int end) {
    lua_State *L = asked;
    const int top = lua_gettop(L);
    const lua_Hook hook = lua_gethook(L);
    const int mask = lua_gethookmask(L), count = lua_gethookcount(L);
    const int collecting = lua_gc(L, LUA_GCISRUNNING);
    char **found = NULL;
    (void)start;
    lua_sethook(L, NULL, 0, 0);
    lua_gc(L, LUA_GCSTOP);
    rl_attempted_completion_over = 1;
    rl_completion_append_character = '\0';
    if (ask(end) == LUA_OK && lua_istable(L, -1)) {
        found = rl_completion_matches(text, candidate);
    } else if (lua_isboolean(L, -1)) {
        rl_filename_completion_desired = 1;
        found = rl_completion_matches(text, rl_filename_completion_function);
    }
    lua_settop(L, top);
    if (collecting) lua_gc(L, LUA_GCRESTART);
    lua_sethook(L, hook, mask, count);
    return found;
}

/* is text[index] inside of quotes? then it ends no word, such as the / of a file name */
static int is_quoted(char *text, int index) {
    char quote = '\0';
    for (int i = 0; i < index && text[i]; i++) {
        if (quote && text[i] == '\\' && text[i + 1])
            i++;
        else if (quote)
            quote = text[i] == quote ? '\0' : quote;
        else if (text[i] == '"' || text[i] == '\'')
            quote = text[i];
    }
    return quote != '\0';
}

static int is_blank(const char *text, int length) {
    for (int i = 0; i < length; i++)
        if (text[i] != ' ' && text[i] != '\t') return 0;
    return 1;
}

/* Tab: at the start of a line of an entry that goes on it indents, as in text that is pasted */
static int tab(int count, int key) {
    if (*before && is_blank(rl_line_buffer, rl_point)) return rl_insert(count, key);
    if (rl_last_func == tab) rl_last_func = rl_complete; /* the second one lists */
    return rl_complete(count, key);
}

/* Word breaks of Lua, not of a shell. */
void dml_complete_open(lua_State *L) {
    asked = L;
    rl_initialize();
    if (rl_function_of_keyseq("\t", NULL, NULL) == rl_complete) rl_bind_key('\t', tab);
    rl_char_is_quoted_p = is_quoted;
    rl_completer_word_break_characters = breaks;
    rl_completer_quote_characters = "\"'";
    rl_attempted_completion_function = attempt;
}

void dml_complete_before(const char *text) {
    before = text ? text : "";
}

#endif
