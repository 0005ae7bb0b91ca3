#include "mech/mass_convex.h"

#include "algebra/compact.h"
#include "algebra/extremum.h"
#include "graph/period.h"
#include "linalg/signature.h"
#include "mech/mass_bounds.h"
#include "mech/mass_form.h"

#include <math.h>

/* Angles are cut into boxes, halved until their bounds tell: at most so often each, and so many
 * nodes are bounded in all.
 * Speed: ensembles of reduced systems, double spherical pendulum. */
enum { HALVINGS = 8, MOST_BOUNDED = 40000, MOST_ANGLES = 8 };
static const double PI_AND_MORE = 3.1415926535897936;

typedef struct {
    dm_form form;
    dm_interval *in; /* [inputs] of its graph */
    uint32_t angles, angle[MOST_ANGLES];
    long credit; /* nodes */
} reading;

static int number(const dm_form *f, dm_node at, double *c) {
    const dm_expr *e = dm_graph_at(f->g, at);
    if (e->op != DM_OP_CONSTANT) return 0;
    *c = e->as.value;
    return 1;
}

/* The numbers that a node of first degree is a sum of velocities with, times `by`, into row[]; 0:
 * it is no such sum. */
static int find_row(dm_form *f, dm_node at, double by, double *row) {
    const dm_expr *e = dm_graph_at(f->g, at);
    const dm_node a = e->as.arg[0], b = e->as.arg[1];
    double c;
    if (f->degree[at] != 1 || f->visits-- <= 0) return 0;
    switch (e->op) {
    case DM_OP_INPUT:
        row[e->as.input - f->first] += by;
        return 1;
    case DM_OP_NEG:
        return find_row(f, a, -by, row);
    case DM_OP_ADD:
        return find_row(f, a, by, row) && find_row(f, b, by, row);
    case DM_OP_SUB:
        return find_row(f, a, by, row) && find_row(f, b, -by, row);
    case DM_OP_MUL: /* a number comes first or last */
        return number(f, a, &c) ? find_row(f, b, c * by, row)
                                : number(f, b, &c) && find_row(f, a, c * by, row);
    default:
        return 0;
    }
}

/* Are v = 0 where all w_i = 0? As those tell that are sums of velocities with numbers: the sum of
 * their squares is definite then. */
static int are_all_moving(dm_form *f) {
    const uint32_t n = f->velocities;
    double A[DM_SURELY_MOST * DM_SURELY_MOST] = {0}, none[DM_SURELY_MOST * DM_SURELY_MOST] = {0};
    if (n > DM_SURELY_MOST) return 0;
    for (uint32_t k = 0; k < f->count; k++) {
        double row[DM_SURELY_MOST] = {0};
        if (f->w[k].count || !find_row(f, f->w[k].node, 1.0, row)) continue;
        for (uint32_t i = 0; i < n * n; i++) A[i] += row[i / n] * row[i % n];
    }
    return dm_surely_positive(A, none, n);
}

/* Has every w_i a square that counts, and no weight that grows without bound? Beside such a one the
 * others are lost in rounding, though the mass is definite. */
static int are_weights_bounded(const dm_form *f) {
    for (uint32_t i = 0; i < f->count; i++)
        if (f->w[i].count || !(f->c[i][i].lo > 0.0 && f->c[i][i].hi < INFINITY)) return 0;
    return 1;
}

/* Is no value of (c_ij) negative? Of w_i that stand alone, by their squares; of others together,
 * where none is zero, either. */
static int is_positive(const dm_form *f) {
    double centre[DM_FORM_MOST * DM_FORM_MOST], radius[DM_FORM_MOST * DM_FORM_MOST];
    uint32_t together[DM_FORM_MOST], m = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        int alone = 1;
        for (uint32_t j = 0; j < f->count; j++)
            alone &= i == j || (f->c[i][j].lo == 0.0 && f->c[i][j].hi == 0.0);
        if (!(f->c[i][i].lo >= 0.0)) return 0;
        if (!alone) together[m++] = i;
    }
    for (uint32_t k = 0; k < m * m; k++) {
        const dm_interval c = f->c[together[k / m]][together[k % m]];
        centre[k] = k / m == k % m ? c.lo : 0.5 * c.lo + 0.5 * c.hi;
        radius[k] = k / m == k % m ? 0.0 : 0.5 * c.hi - 0.5 * c.lo;
    }
    return !m || dm_surely_positive(centre, radius, m);
}

static dm_convexity lesser(dm_convexity a, dm_convexity b) {
    return a < b ? a : b;
}

/* In the box of r->in; so much is tried to be taken apart. */
static dm_convexity tell_in(reading *r, int most) {
    dm_form *f = &r->form;
    dm_convexity out = DM_NOT_CONVEX;
    r->credit -= (long)dm_graph_size(f->g);
    dm_bounds(f->g, r->in, f->value);
    for (f->apart = DM_FORM_PLAIN; f->apart <= most && out != DM_DEFINITE; f->apart++)
        if (dm_form_read(f) && is_positive(f) && dm_form_turns(f))
            out = are_weights_bounded(f) && are_all_moving(f) ? DM_DEFINITE : DM_CONVEX;
    return out;
}

/* In it or in its parts, angles halved in turn. */
static dm_convexity tell_in_parts(reading *r, uint32_t halved) {
    dm_convexity out = tell_in(r, DM_FORM_FACTORS);
    if (out || r->credit <= 0 || halved == HALVINGS * r->angles) return out;
    dm_interval *angle = r->in + r->angle[halved % r->angles], whole = *angle;
    const double middle = 0.5 * (whole.lo + whole.hi);
    *angle = (dm_interval){whole.lo, middle};
    out = tell_in_parts(r, halved + 1);
    *angle = (dm_interval){middle, whole.hi};
    if (out) out = lesser(out, tell_in_parts(r, halved + 1));
    *angle = whole;
    return out;
}

/* Inputs that the coefficients see by sines and cosines alone are taken over one turn. */
static void find_angles(reading *r, unsigned char *scratch) {
    const dm_form *f = &r->form;
    unsigned char *marks = scratch, *kinds = scratch + dm_graph_size(f->g);
    dm_form_factors(f, marks);
    for (uint32_t i = 0; i < dm_graph_inputs(f->g) && r->angles < MOST_ANGLES; i++)
        if (dm_has_period(f->g, marks, i, kinds)) r->angle[r->angles++] = i;
}

/* In so many inputs of g, from one on. */
static dm_convexity tell(dm_graph *g, dm_node L, uint32_t first, uint32_t velocities,
                         dm_arena *arena) {
    dm_node alone;
    reading *r = dm_arena_take(arena, sizeof *r);
    const dm_graph *own = dm_graph_copy(g, &L, 1, &alone);
    if (!r || !own || dm_graph_size(own) > DM_MASS_MOST_NODES) return DM_NOT_CONVEX;
    *r = (reading){.form = {.g = own, .L = alone, .first = first, .velocities = velocities},
                   .credit = MOST_BOUNDED};
    dm_form *f = &r->form;
    const uint32_t size = dm_graph_size(own), inputs = dm_graph_inputs(own);
    unsigned char *scratch = dm_arena_take(arena, 2 * (size_t)size + 1);
    f->degree = dm_arena_take(arena, (size_t)size + 1);
    f->value = dm_arena_take(arena, ((size_t)size + inputs) * sizeof *f->value);
    if (!scratch || !f->degree || !f->value) return DM_NOT_CONVEX;
    r->in = f->value + size;
    for (uint32_t i = 0; i < inputs; i++) r->in[i] = (dm_interval)DM_ANYWHERE;
    dm_form_degrees(f);
    const dm_convexity anywhere = tell_in(r, DM_FORM_COSINES);
    if (anywhere) return anywhere;
    find_angles(r, scratch);
    for (uint32_t k = 0; k < r->angles; k++)
        r->in[r->angle[k]] = (dm_interval){-PI_AND_MORE, PI_AND_MORE};
    return r->angles ? tell_in_parts(r, 0) : DM_NOT_CONVEX;
}

/* What is least over y of an f(x, y) convex in both is convex in x (ensembles of reduced systems in
 * docs/benchmarks/reduction.md). */
dm_convexity dm_mass_convexity(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena) {
    const dm_extremum *e = dm_extremum_find(g, L);
    if (e && e->n == 2 * n) return tell(e->of, e->f, n, n + e->m, arena);
    return tell(g, L, n, n, arena);
}
