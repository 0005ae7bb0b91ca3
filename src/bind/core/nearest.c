/* nearest.c - the name that was meant by a word: what others call it, or a misprint of it. */
#include "bind/core/bind.h"

#include "bind/core/missing_key.h"

#include <ctype.h>
#include <string.h>

/* what others call an option or a method, and what it is called here */
static const char *const other_names[][2] = {{"dt", "h"},
                                             {"step", "h"},
                                             {"stepsize", "h"},
                                             {"step_size", "h"},
                                             {"timestep", "h"},
                                             {"method", "rule"},
                                             {"integrator", "rule"},
                                             {"scheme", "rule"},
                                             {"time", "t"},
                                             {"T", "t"},
                                             {"duration", "t"},
                                             {"t_end", "t"},
                                             {"n", "steps"},
                                             {"N", "steps"},
                                             {"nsteps", "steps"},
                                             {"x", "q"},
                                             {"position", "q"},
                                             {"velocity", "v"},
                                             {"qdot", "v"},
                                             {"momentum", "p"},
                                             {"lagrangian", "L"},
                                             {"Lagrangian", "L"},
                                             {"space", "Q"},
                                             {"constraints", "constraint"},
                                             {"parameters", "params"},
                                             {"params", "vary"},
                                             {"forces", "force"},
                                             {"tol", "tolerance"},
                                             {"output", "file"},
                                             {"filename", "file"},
                                             {"vertices", "points"},
                                             {"nodes", "points"},
                                             {"triangles", "simplices"},
                                             {"tetrahedra", "simplices"},
                                             {"elements", "simplices"},
                                             {"cells", "simplices"},
                                             {"dirichlet", "fixed"},
                                             {"bc", "fixed"},
                                             {"names", "coordinates"},
                                             {"rhs", "f"},
                                             {"boundary", "fixed"},
                                             {"hamiltonian", "energy"},
                                             {"integrate", "solver"},
                                             {"simulate", "solver"},
                                             {"solve", "solver"},
                                             {"convergence", "chart"},
                                             {"inv", "inverse"},
                                             {"T", "transpose"},
                                             {"save", "csv"},
                                             {"export", "csv"},
                                             {"potential", "L"},
                                             {"V", "L"},
                                             {"omega", "v"},
                                             {"w", "v"},
                                             {"angular_velocity", "v"},
                                             {"phase_portrait", "plot"},
                                             {"period", "frequency"},
                                             {"error", "drift"},
                                             {"energy_error", "drift"},
                                             {"symmetries", "structure"},
                                             {"equations", "graph"},
                                             {"effective_potential", "amended_potential"},
                                             {"bracket", "ad"},
                                             {"adjoint", "Ad"},
                                             {"coadjoint", "coAd"},
                                             {"sample", "random"},
                                             {"geometric_phase", "holonomy"},
                                             {"tspan", "t"},
                                             {"t_final", "t"},
                                             {"t_max", "t"},
                                             {"tmax", "t"},
                                             {"tol", "newton"},
                                             {"tolerance", "newton"},
                                             {"aspect", "equal"},
                                             {"eye", "identity"},
                                             {"lie_poisson", "euler_poincare"},
                                             {"determinant", "det"},
                                             {"length", "norm"},
                                             {"magnitude", "norm"},
                                             {"gradient", "derivative"},
                                             {"grad", "derivative"},
                                             {"jacobian", "derivative"},
                                             {"poincare", "section"},
                                             {"symplectic_form", "two_form"},
                                             {"dt_out", "every"},
                                             {"save_every", "every"},
                                             {"Sphere", "S"},
                                             {"sphere", "S"},
                                             {"Torus", "T"},
                                             {"torus", "T"},
                                             {"Circle", "T"},
                                             {"circle", "T"},
                                             {"Euclidean", "R"},
                                             {"euclidean", "R"},
                                             {"Rn", "R"},
                                             {"Sn", "S"},
                                             {"Tn", "T"},
                                             {NULL, NULL}};

static int is_among(const char *word, const char *const *known) {
    while (*known && strcmp(*known, word) != 0) known++;
    return *known != NULL;
}

static const char *other_name(const char *word, const char *const *known) {
    if (is_among(word, known)) return NULL;
    for (int k = 0; other_names[k][0]; k++)
        if (strcmp(other_names[k][0], word) == 0 && is_among(other_names[k][1], known))
            return other_names[k][1];
    return NULL;
}

enum { LONGEST_WORD = 40 };

static int smallest(int a, int b, int c) {
    const int least = a < b ? a : b;
    return least < c ? least : c;
}

static int differ(char a, char b) {
    return tolower((unsigned char)a) != tolower((unsigned char)b);
}

/* insertions, deletions, replacements and swaps of neighbours that turn a into b */
static int distance(const char *a, const char *b) {
    int row[3][LONGEST_WORD + 1];
    const int n = (int)strlen(b);
    int *before = row[0], *last = row[1], *now = row[2];
    for (int j = 0; j <= n; j++) last[j] = j, before[j] = 0;
    for (int i = 0; a[i]; i++) {
        now[0] = i + 1;
        for (int j = 0; j < n; j++) {
            now[j + 1] = smallest(last[j] + differ(a[i], b[j]), last[j + 1] + 1, now[j] + 1);
            const int swap = i && j && !differ(a[i], b[j - 1]) && !differ(a[i - 1], b[j]);
            if (swap && before[j - 1] + 1 < now[j + 1]) now[j + 1] = before[j - 1] + 1;
        }
        int *free = before;
        before = last, last = now, now = free;
    }
    return last[n];
}

const char *dml_nearest(const char *word, const char *const *known) {
    const size_t length = strlen(word);
    const char *best = other_name(word, known);
    int least = 2 + (int)length / 6; /* further away is no misprint */
    if (best || length > LONGEST_WORD) return best;
    for (; *known; known++) {
        if (strlen(*known) > LONGEST_WORD) continue;
        const int d = distance(word, *known);
        const int similar = d < (int)length;
        if (d < least && similar) best = *known, least = d;
    }
    return best;
}

int dml_core_nearest(lua_State *L) {
    const char *word = luaL_checkstring(L, 1);
    luaL_checktype(L, 2, LUA_TTABLE);
    const lua_Integer count = (lua_Integer)lua_rawlen(L, 2);
    const char **known = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *known, 0);
    for (lua_Integer i = 1; i <= count; i++) {
        lua_rawgeti(L, 2, i); /* the table keeps it alive */
        known[i - 1] = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        lua_pop(L, 1);
    }
    known[count] = NULL;
    lua_pushstring(L, dml_nearest(word, known));
    return 1;
}
