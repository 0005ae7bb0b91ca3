#include "integ/method.h"

#include "mech/ties.h"

#include <ctype.h>
#include <string.h>

const dm_method *const dm_methods[] = {
#define X(name) &dm_method_##name,
#include "integ/methods.def"
#undef X
    NULL};

static int smallest(int a, int b, int c) {
    const int ab = a < b ? a : b;
    return ab < c ? ab : c;
}

static int differ(char a, char b) {
    return tolower((unsigned char)a) != tolower((unsigned char)b);
}

/* letters to insert, delete or replace (Levenshtein); names are shorter than DM_RULE_NAME */
static int distance(const char *a, const char *b) {
    int row[DM_RULE_NAME];
    const int length = (int)strlen(b);
    for (int j = 0; j <= length; j++) row[j] = j;
    for (int i = 0; a[i]; i++) {
        int diagonal = row[0];
        row[0] = i + 1;
        for (int j = 0; j < length; j++) {
            const int replaced = diagonal + differ(a[i], b[j]);
            diagonal = row[j + 1];
            row[j + 1] = smallest(replaced, diagonal + 1, row[j] + 1);
        }
    }
    return row[length];
}

/* what others call a rule that is here, or NULL */
static const char *usual_name(const char *name) {
    static const char *const others[][2] = {{"leapfrog", "verlet"},
                                            {"stoermer-verlet", "verlet"},
                                            {"stormer-verlet", "verlet"},
                                            {"strang", "verlet"},
                                            {"euler", "symplectic-euler"},
                                            {"implicit-midpoint", "midpoint"},
                                            {"rk45", "rkf45"},
                                            {"ruth", "yoshida"}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strcmp(name, others[i][0]) == 0) return others[i][1];
    return NULL;
}

const dm_method *dm_method_find(const char *name, const char **nearest) {
    const int length = (int)strlen(name);
    for (const dm_method *const *m = dm_methods; *m; m++)
        if (strcmp((*m)->name, name) == 0) return *m;
    const char *usual = usual_name(name);
    int best = usual ? 0 : 2 + length / 4; /* further away is no misprint */
    if (nearest) *nearest = usual;
    for (const dm_method *const *m = dm_methods; *m; m++) {
        const int d = distance(name, (*m)->name);
        if (d < best && d < length) {
            best = d;
            if (nearest) *nearest = (*m)->name;
        }
    }
    return NULL;
}

unsigned dm_method_needs(const dm_model *m) {
    unsigned needs = 0;
    if (m->ties && m->ties->holonomic) needs |= DM_HOLONOMIC;
    if (m->ties && m->ties->rolling) needs |= DM_ROLLING;
    if (m->ties && m->ties->forced) needs |= DM_FORCED;
    return needs;
}

dm_status dm_advance(dm_stepper *s, double *state, double t, long count, long *done) {
    if (s->method->advance) return s->method->advance(s, state, t, count, done);
    return dm_advance_by_step(s, state, t, count, done);
}

dm_status dm_advance_by_step(dm_stepper *s, double *state, double t, long count, long *done) {
    for (*done = 0; *done < count; ++*done) {
        const dm_status status = s->method->step(s, state, t + (double)*done * s->h);
        if (status != DM_OK) return status;
    }
    return DM_OK;
}

int dm_state_is_finite(const double *state, uint32_t n) {
    const size_t size = dm_state_size(n), whole = size & ~(size_t)3;
    double sum[4] = {0.0}; /* 0 * infinity is NaN; four sums do not wait for each other */
    for (size_t i = 0; i < whole; i += 4)
        for (size_t k = 0; k < 4; k++) sum[k] += 0.0 * state[i + k];
    for (size_t i = whole; i < size; i++) sum[0] += 0.0 * state[i];
    return sum[0] + sum[1] + sum[2] + sum[3] == 0.0;
}
