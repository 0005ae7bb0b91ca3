/* library.c - dm/sparse.so, opened when the first solver is asked for: the core links none of its
 * libraries, so starting costs nothing. It lies beside core.so, or where the program and its core
 * are built and installed. DMLUA_SPARSE=no does without it. */
#define _GNU_SOURCE /* dladdr */
#include "bind/dec/bind_sparse.h"

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

/* The first place that has one that opens. RTLD_LOCAL keeps its BLAS from other modules; *why says
 * what to install. */
static const dm_solvers *open_library(const char **why) {
    static const char *const places[] = {"sparse.so", "dm/sparse.so", "../dm/sparse.so",
                                         "../lib/lua/5.4/dm/sparse.so"};
    static const char missing[] = "dm/sparse.so is not there: install libsuitesparse-dev and "
                                  "libarpack2-dev (as Debian calls them) and build dmlua again";
    char folder[LONGEST_PATH], file[LONGEST_PATH + 32];
    const char *wish = getenv("DMLUA_SPARSE");
    *why = missing;
    if (wish && strcmp(wish, "no") == 0) {
        *why = "DMLUA_SPARSE=no keeps dm/sparse.so (libsuitesparse-dev, libarpack2-dev) out";
        return NULL;
    }
    if (!own_folder(folder, sizeof folder)) return NULL;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(file, sizeof file, "%s/%s", folder, places[i]);
        if (access(file, R_OK) != 0) continue;
        void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
        const dm_solvers *table = handle ? dlsym(handle, DM_SOLVERS_SYMBOL) : NULL;
        if (table) return table;
        *why = "dm/sparse.so cannot be opened: its libraries (libsuitesparse-dev, libarpack2-dev) "
               "are missing";
    }
    return NULL;
}

/* It stays open until the program ends. */
const dm_solvers *dml_solvers(const char **why) {
    static const dm_solvers *solvers;
    static const char *reason;
    if (!solvers && !reason) solvers = open_library(&reason);
    *why = solvers ? NULL : reason;
    return solvers;
}
