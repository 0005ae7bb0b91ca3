#define _GNU_SOURCE /* dladdr */
#include "bind/core/module.h"

#include "bind/core/bind.h"

#include <ctype.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LONGEST_PATH = 4096 };

/* The folder of what this code is in: a program or core.so. A program may have been started by a
 * name that says nothing, so that one is asked for by the link of the process. */
static int own_folder(char *out, size_t size) {
    Dl_info info;
    ssize_t n = -1;
    const char *extension = NULL;
    if (dladdr((const void *)&dml_stop, &info) && info.dli_fname) {
        n = (ssize_t)strlen(info.dli_fname);
        extension = strrchr(info.dli_fname, '.');
    }
    if (extension && strcmp(extension, ".so") == 0 && (size_t)n < size)
        memcpy(out, info.dli_fname, (size_t)n);
    else
        n = readlink("/proc/self/exe", out, size);
    if (n <= 0 || (size_t)n >= size) return 0;
    out[n] = '\0';
    char *slash = strrchr(out, '/');
    if (slash) *slash = '\0';
    return slash != NULL;
}

/* DMLUA_<NAME>=no */
static int is_unwanted(const char *name) {
    char variable[64] = "DMLUA_";
    size_t at = strlen(variable);
    for (; *name && at + 1 < sizeof variable; name++)
        variable[at++] = (char)toupper((unsigned char)*name);
    variable[at] = '\0';
    const char *wish = getenv(variable);
    return wish && strcmp(wish, "no") == 0;
}

/* the first place that has one that opens */
const void *dml_module(const char *name, const char *symbol, const char *packages,
                       char why[DML_WHY]) {
    static const char *const places[] = {"", "dm/", "../dm/", "../lib/lua/5.4/dm/"};
    char folder[LONGEST_PATH], file[LONGEST_PATH + 64];
    snprintf(why, DML_WHY,
             "dm/%s.so is not there%s: install %s (as Debian calls it) and build dmlua again", name,
             is_unwanted(name) ? " by the wish of the environment" : "", packages);
    if (is_unwanted(name) || !own_folder(folder, sizeof folder)) return NULL;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(file, sizeof file, "%s/%s%s.so", folder, places[i], name);
        if (access(file, R_OK) != 0) continue;
        void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
        const void *table = handle ? dlsym(handle, symbol) : NULL;
        if (table) return table;
        snprintf(why, DML_WHY, "dm/%s.so cannot be opened: its libraries (%s) are missing", name,
                 packages);
    }
    return NULL;
}
