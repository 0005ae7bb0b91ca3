#include "integ/registry.h"

#include <ctype.h>
#include <string.h>

#define X(name) extern const dm_method dm_method_##name;
#include "integ/methods.def"
#undef X

const dm_method *const dm_methods[] = {
#define X(name) &dm_method_##name,
#include "integ/methods.def"
#undef X
    NULL};

/* Of three. */
static int smallest(int a, int b, int c) {
    const int ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Case does not count. */
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

/* is the name one of a list "leapfrog, strang"? */
static int is_among(const char *name, const char *list) {
    const size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 2 : NULL)
        if (strncmp(at, name, length) == 0 && (!at[length] || at[length] == ',')) return 1;
    return 0;
}

/* what others call a rule that is here, or NULL */
static const char *usual_name(const char *name) {
    for (const dm_method *const *m = dm_methods; *m; m++)
        if (is_among(name, (*m)->aliases)) return (*m)->name;
    return NULL;
}

/* A name of others is nearer than any misprint; a distance of half a short name is none. */
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

/* nested rules that are no method (a quadrature, a tableau) keep NULL */
static void resolve(dm_rule *rule, const char **nearest) {
    rule->method = dm_method_find(rule->name, nearest);
}

/* Nested rules first; what the outermost lacks is told by *nearest. */
const char *dm_rule_read(dm_rule nodes[DM_RULE_NODES], const char *text, const char **nearest) {
    const char *wrong = dm_rule_parse(nodes, text);
    if (wrong) return wrong;
    for (int k = DM_RULE_NODES - 1; k > 0; k--)
        if (nodes[k].name[0]) resolve(nodes + k, NULL);
    resolve(nodes, nearest);
    return NULL;
}
