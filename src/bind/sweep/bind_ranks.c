/* bind_ranks.c - `core.ranks`: messages between processes that mpirun has started, through
 * dm/mpi.so. */
#define _DEFAULT_SOURCE /* on_exit */
#include "bind/core/bind.h"
#include "bind/core/module.h"
#include "bind/core/new_file.h"
#include "mpi/ranks.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const dm_ranks *ranks; /* NULL: not opened */
static int own_rank, all_ranks = 1;

/* Raises where MPI is not open. */
static const dm_ranks *check(lua_State *L) {
    if (!ranks) luaL_error(L, "MPI is not open: require \"dm.mpi\"");
    return ranks;
}

/* The rank at `arg`, of those there are. */
static int check_rank(lua_State *L, int arg) {
    const lua_Integer rank = dml_checkinteger(L, arg);
    if (rank < 0 || rank >= all_ranks)
        luaL_error(L, "there are ranks 0 to %d (got %I)", all_ranks - 1, (LUAI_UACINT)rank);
    return (int)rank;
}

/* MPI wants an end from every process; one that failed ends the others */
static void end_ranks(int status, void *ud) {
    (void)ud;
    ranks->end(status);
}

/* core.ranks_open() -> rank, size */
static int open_ranks(lua_State *L) {
    char why[DML_WHY];
    if (!ranks) {
        const dm_ranks *table = dml_module("mpi", "dm_mpi", "libopenmpi-dev and openmpi-bin", why);
        if (!table) return luaL_error(L, "%s with `make mpi`", why);
        const char *wrong = table->open(&own_rank, &all_ranks);
        if (wrong) return luaL_error(L, "dm.mpi: %s", wrong);
        ranks = table;
        on_exit(end_ranks, NULL);
        if (own_rank > 0) dml_silencefiles();
    }
    lua_pushinteger(L, own_rank);
    lua_pushinteger(L, all_ranks);
    return 2;
}

/* (to, tag, bytes) */
static int send_bytes(lua_State *L) {
    size_t size;
    const int to = check_rank(L, 1);
    const char *bytes = luaL_checklstring(L, 3, &size);
    check(L)->send(to, (int)dml_checkinteger(L, 2), bytes, size);
    return 0;
}

/* (from or nil, tag [, at once]) -> bytes, from; nothing where none has come */
static int receive(lua_State *L) {
    int from = lua_isnil(L, 1) ? -1 : check_rank(L, 1);
    const int tag = (int)dml_checkinteger(L, 2), wait = !lua_toboolean(L, 3);
    size_t size;
    luaL_Buffer b;
    if (!check(L)->probe(&from, tag, &size, wait)) return 0;
    char *to = luaL_buffinitsize(L, &b, size + 1);
    ranks->receive(from, tag, to, size);
    luaL_pushresultsize(&b, size);
    lua_pushinteger(L, from);
    return 2;
}

/* (root, bytes of the root) -> bytes */
static int broadcast(lua_State *L) {
    const int root = check_rank(L, 1);
    size_t size = 0;
    const char *bytes = own_rank == root ? luaL_checklstring(L, 2, &size) : NULL;
    uint64_t length = size;
    luaL_Buffer b;
    check(L)->broadcast(root, &length, sizeof length);
    char *all = luaL_buffinitsize(L, &b, (size_t)length + 1);
    if (bytes) memcpy(all, bytes, size);
    ranks->broadcast(root, all, (size_t)length);
    luaL_pushresultsize(&b, (size_t)length);
    return 1;
}

static int barrier(lua_State *L) {
    check(L)->barrier();
    return 0;
}

/* (code) */
static int abort_all(lua_State *L) {
    const lua_Integer code = dml_optinteger(L, 1, 1);
    check(L)->end(code > 0 && code < 256 ? (int)code : 1);
    return 0;
}

static const dml_row functions[] =
    {{"ranks_open", open_ranks,
      "core.ranks_open() -> integer, integer\nThe rank of this process and how many there are."},
     {"ranks_send", send_bytes, "core.ranks_send(to, tag, bytes)\nA message to a rank."},
     {"ranks_receive", receive,
      "core.ranks_receive(from, tag [, at_once]) -> bytes, from\n"
      "The next message of a rank (nil: of any); at_once: nothing where none has come."},
     {"ranks_broadcast", broadcast,
      "core.ranks_broadcast(root, bytes) -> bytes\nThe same bytes on every rank."},
     {"ranks_barrier", barrier, "core.ranks_barrier()\nWait for all ranks."},
     {"ranks_abort", abort_all, "core.ranks_abort([code])\nEnd all ranks."},
     {NULL, NULL, NULL}};

const dml_class dml_class_ranks = {
    .functions = functions,
};
