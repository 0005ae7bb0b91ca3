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

/* Is no value of (c_ij) negative? Of w_i that stand alone, by their squares; of others together. */
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

/* In the box of r->in? So much is tried to be taken apart. */
static int is_convex_in(reading *r, int most) {
    dm_form *f = &r->form;
    int out = 0;
    r->credit -= (long)dm_graph_size(f->g);
    dm_bounds(f->g, r->in, f->value);
    for (f->apart = DM_FORM_PLAIN; f->apart <= most && !out; f->apart++)
        out = dm_form_read(f) && is_positive(f) && dm_form_turns(f);
    return out;
}

/* In it or in its parts, angles halved in turn? */
static int is_convex_in_parts(reading *r, uint32_t halved) {
    if (is_convex_in(r, DM_FORM_FACTORS)) return 1;
    if (r->credit <= 0 || halved == HALVINGS * r->angles) return 0;
    dm_interval *angle = r->in + r->angle[halved % r->angles], whole = *angle;
    const double middle = 0.5 * (whole.lo + whole.hi);
    *angle = (dm_interval){whole.lo, middle};
    int out = is_convex_in_parts(r, halved + 1);
    *angle = (dm_interval){middle, whole.hi};
    out = out && is_convex_in_parts(r, halved + 1);
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
static int is_convex(dm_graph *g, dm_node L, uint32_t first, uint32_t velocities, dm_arena *arena) {
    dm_node alone;
    reading *r = dm_arena_take(arena, sizeof *r);
    const dm_graph *own = dm_graph_copy(g, &L, 1, &alone);
    if (!r || !own || dm_graph_size(own) > DM_MASS_MOST_NODES) return 0;
    *r = (reading){.form = {.g = own, .L = alone, .first = first, .velocities = velocities},
                   .credit = MOST_BOUNDED};
    dm_form *f = &r->form;
    const uint32_t size = dm_graph_size(own), inputs = dm_graph_inputs(own);
    unsigned char *scratch = dm_arena_take(arena, 2 * (size_t)size + 1);
    f->degree = dm_arena_take(arena, (size_t)size + 1);
    f->value = dm_arena_take(arena, ((size_t)size + inputs) * sizeof *f->value);
    if (!scratch || !f->degree || !f->value) return 0;
    r->in = f->value + size;
    for (uint32_t i = 0; i < inputs; i++) r->in[i] = (dm_interval)DM_ANYWHERE;
    dm_form_degrees(f);
    if (is_convex_in(r, DM_FORM_COSINES)) return 1;
    find_angles(r, scratch);
    for (uint32_t k = 0; k < r->angles; k++)
        r->in[r->angle[k]] = (dm_interval){-PI_AND_MORE, PI_AND_MORE};
    return r->angles && is_convex_in_parts(r, 0);
}

/* What is least over y of an f(x, y) convex in both is convex in x (ensembles of reduced systems in
 * docs/benchmarks/reduction.md). */
int dm_mass_is_convex(dm_graph *g, dm_node L, uint32_t n, dm_arena *arena) {
    const dm_extremum *e = dm_extremum_find(g, L);
    if (e && e->n == 2 * n) return is_convex(e->of, e->f, n, n + e->m, arena);
    return is_convex(g, L, n, n, arena);
}
