/* mass_turns.c - are cosines beside the entries of a form products of unit vectors? */
#include "mech/mass_form.h"

/* The angles that x_i may be, two at most; known: some are. */
typedef struct {
    dm_node angle[2];
    uint32_t count;
    int known;
} choice;

/* The two angles whose difference a cosine is of: one alone is that to 0. */
static void angles_of(const dm_graph *g, dm_node cosine, dm_node out[2]) {
    const dm_node argument = dm_graph_at(g, cosine)->as.arg[0];
    const dm_expr *e = dm_graph_at(g, argument);
    const int is_difference = e->op == DM_OP_SUB;
    out[0] = is_difference ? e->as.arg[0] : argument;
    out[1] = is_difference ? e->as.arg[1] : 0; /* node 0 is the number 0 */
}

/* What is left of a choice that is one of two angles, too. */
static void meet(choice *x, const dm_node with[2]) {
    uint32_t left = 0;
    if (!x->known) *x = (choice){.angle = {with[0], with[1]}, .count = 2, .known = 1};
    for (uint32_t k = 0; k < x->count; k++)
        if (x->angle[k] == with[0] || x->angle[k] == with[1]) x->angle[left++] = x->angle[k];
    x->count = left;
}

static void choose(choice *x, dm_node angle) {
    x->angle[0] = angle;
    x->count = 1;
}

/* Two that may still be either: one is the first angle; what the other is follows. */
static int choose_both(choice *x, choice *y, const dm_node angles[2]) {
    if (x->count > 1 && y->count > 1) choose(x, angles[0]);
    if (x->count > 1) choose(x, angles[y->angle[0] == angles[0]]);
    if (y->count > 1) choose(y, angles[x->angle[0] == angles[0]]);
    return (x->angle[0] == angles[0] && y->angle[0] == angles[1]) ||
           (x->angle[0] == angles[1] && y->angle[0] == angles[0]);
}

static int is_zero(dm_interval c) {
    return c.lo == 0.0 && c.hi == 0.0;
}

int dm_form_turns(const dm_form *f) {
    choice x[DM_FORM_MOST] = {0};
    dm_node angles[2];
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < f->count; j++) {
            if (i == j || !f->turn[i][j]) continue;
            angles_of(f->g, f->turn[i][j], angles);
            meet(&x[i], angles);
            if (!x[i].count) return 0;
        }
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < i; j++) {
            if (is_zero(f->c[i][j])) continue;
            if (!f->turn[i][j] && (x[i].known || x[j].known)) return 0;
            if (!f->turn[i][j]) continue;
            angles_of(f->g, f->turn[i][j], angles);
            if (!choose_both(&x[i], &x[j], angles)) return 0;
        }
    return 1;
}
