#include "dec/quality.h"

#include "dec/cell.h"

#include <math.h>

/* below 0: the centre lies beyond a facet */
static double least_of(const double *lambda, uint32_t n) {
    double least = INFINITY;
    for (uint32_t i = 0; i <= n; i++) least = fmin(least, lambda[i]);
    return least;
}

dm_status dm_quality_measure(dm_quality *out, const dm_complex *K, const dm_metric *metric,
                             volatile const int *stop) {
    enum { EVERY = 4096 };
    dm_cell_metric c;
    *out = (dm_quality){.least = INFINITY};
    for (uint32_t k = 0; k <= K->n; k++) {
        const double zero = dm_metric_least(K, metric, k);
        for (uint32_t i = 0; i < K->count[k]; i++) {
            const double dual = metric->dual[k][i];
            if (i % EVERY == 0 && stop && *stop) return DM_STOPPED;
            out->zero[k] += fabs(dual) <= zero;
            out->negative[k] += dual < -zero;
            out->crossed +=
                k + 1 == K->n && dual < -zero && K->coface_at[k][i + 1] - K->coface_at[k][i] > 1;
            if (k == 0) continue;
            dm_metric_simplex(&c, K, metric, k, i);
            dm_metric_centre(c.centre, &c, (2u << k) - 1, DM_CIRCUMCENTRES);
            out->least = fmin(out->least, least_of(c.centre, k));
        }
    }
    return DM_OK;
}

/* ---- flips ---- */

/* where triangle a stands beside triangle b, or 3 */
static uint32_t place_of(const dm_triangles *t, uint32_t b, uint32_t a) {
    uint32_t i = 0;
    while (i < 3 && t->beside[b][i] != a) i++;
    return i;
}

void dm_triangles_read(dm_triangles *out, const dm_complex *K, const double *length2) {
    out->triangles = K->count[2];
    out->flips = 0;
    for (uint32_t c = 0; c < K->count[2]; c++) {
        const uint32_t turned = K->orientation[c] < 0; /* places 1 and 2 change */
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t from = turned && i ? 3 - i : i;
            const uint32_t e = K->face[2][3 * (size_t)c + from];
            const uint32_t at = K->coface_at[1][e], end = K->coface_at[1][e + 1];
            out->vertex[c][i] = K->vertex[2][3 * (size_t)c + from];
            out->length2[c][i] = length2[e];
            out->beside[c][i] = end - at == 1           ? UINT32_MAX
                                : K->coface[1][at] == c ? K->coface[1][at + 1]
                                                        : K->coface[1][at];
        }
    }
}

/* four times the area */
static double area4(const double *l) {
    const double s = l[0] + l[1] + l[2];
    return sqrt(fmax(s * s - 2.0 * (l[0] * l[0] + l[1] * l[1] + l[2] * l[2]), 0.0));
}

/* cotangent of the angle at vertex i, (b^2 + c^2 - a^2) / 4A */
static double cotangent(const double *l, uint32_t i) {
    return (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) / area4(l);
}

/* |the other diagonal|^2 of the two triangles beside edge i of a, laid in a plane with the edge
 * along x: apexes at (x, y) and (x', -y') */
static double diagonal2(const double *la, uint32_t i, const double *lb, uint32_t j) {
    const double e2 = la[i], e = sqrt(e2);
    /* from the vertex behind i in a, which is the one before j in b */
    const double x = (e2 + la[(i + 2) % 3] - la[(i + 1) % 3]) / (2.0 * e);
    const double u = (e2 + lb[(j + 1) % 3] - lb[(j + 2) % 3]) / (2.0 * e);
    const double y = area4(la) / (2.0 * e), v = area4(lb) / (2.0 * e);
    return (x - u) * (x - u) + (y + v) * (y + v);
}

/* is there an edge between two vertices among the triangles round vertex place i of c? The fan is
 * walked both ways, as it may end at the boundary */
static int meets(const dm_triangles *t, uint32_t c, uint32_t i, uint32_t other) {
    for (uint32_t way = 1; way <= 2; way++) {
        uint32_t at = c, place = i;
        do {
            if (t->vertex[at][(place + 1) % 3] == other || t->vertex[at][(place + 2) % 3] == other)
                return 1;
            const uint32_t next = t->beside[at][(place + way) % 3];
            if (next == UINT32_MAX) break;
            const uint32_t shared = place_of(t, next, at);
            place = (shared + way) % 3;
            at = next;
        } while (at != c);
        if (at == c && place == i) break; /* all the way round */
    }
    return 0;
}

static void set_beside(dm_triangles *t, uint32_t c, uint32_t from, uint32_t to) {
    if (c != UINT32_MAX) t->beside[c][place_of(t, c, from)] = to;
}

/* The edge of a = (p, q, r) opposite to p and of b = (s, r, q) becomes the one from p to s:
 * a = (p, q, s), b = (s, r, p). */
static void flip(dm_triangles *t, uint32_t a, uint32_t i, uint32_t b, uint32_t j, double d2) {
    const uint32_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    const uint32_t p = t->vertex[a][i], q = t->vertex[a][i1], r = t->vertex[a][i2];
    const uint32_t s = t->vertex[b][j];
    const double rp = t->length2[a][i1], pq = t->length2[a][i2];
    const double qs = t->length2[b][j1], sr = t->length2[b][j2];
    const uint32_t at_rp = t->beside[a][i1], at_pq = t->beside[a][i2];
    const uint32_t at_qs = t->beside[b][j1], at_sr = t->beside[b][j2];
    const uint32_t va[3] = {p, q, s}, vb[3] = {s, r, p};
    const double la[3] = {qs, d2, pq}, lb[3] = {rp, d2, sr};
    const uint32_t na[3] = {at_qs, b, at_pq}, nb[3] = {at_rp, a, at_sr};
    set_beside(t, at_qs, b, a);
    set_beside(t, at_rp, a, b);
    for (uint32_t m = 0; m < 3; m++) {
        t->vertex[a][m] = va[m], t->vertex[b][m] = vb[m];
        t->length2[a][m] = la[m], t->length2[b][m] = lb[m];
        t->beside[a][m] = na[m], t->beside[b][m] = nb[m];
    }
    t->flips++;
}

/* 1: flipped; where an edge asks for it and cannot, ends[2] is the one that there would be */
static int improve(dm_triangles *t, uint32_t a, uint32_t i, uint32_t *ends, dm_status *status) {
    const uint32_t b = t->beside[a][i];
    if (b == UINT32_MAX) return 0;
    const uint32_t j = place_of(t, b, a);
    const double sum = cotangent(t->length2[a], i) + cotangent(t->length2[b], j);
    if (!(sum < -1e-10)) return 0;
    if (t->vertex[a][i] == t->vertex[b][j] || meets(t, a, i, t->vertex[b][j])) {
        ends[0] = t->vertex[a][i], ends[1] = t->vertex[b][j];
        *status = DM_SINGULAR;
        return 0;
    }
    flip(t, a, i, b, j, diagonal2(t->length2[a], i, t->length2[b], j));
    return 1;
}

/* flips one edge of a triangle; the triangle beside it, or UINT32_MAX where none asks for it */
static uint32_t improve_one(dm_triangles *t, uint32_t a) {
    dm_status status = DM_OK;
    uint32_t ends[2];
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t b = t->beside[a][i];
        if (improve(t, a, i, ends, &status)) return b;
    }
    return UINT32_MAX;
}

/* Each pass looks at every triangle; those of a flip are looked at again at once. It ends, as
 * every flip makes the Dirichlet energies of functions smaller (Rippa 1990). */
dm_status dm_triangles_flip(dm_triangles *t, uint32_t *stack, volatile const int *stop,
                            uint32_t *ends) {
    dm_status status = DM_OK;
    uint32_t depth = 0, before;
    do {
        before = t->flips;
        for (uint32_t c = 0; c < t->triangles; c++) {
            for (stack[depth++] = c; depth > 0;) {
                const uint32_t a = stack[--depth], b = improve_one(t, a);
                if (stop && *stop) return DM_STOPPED;
                if (b == UINT32_MAX || depth + 2 > 3 * t->triangles) continue;
                stack[depth++] = b, stack[depth++] = a;
            }
        }
    } while (t->flips > before);
    for (uint32_t c = 0; c < t->triangles; c++) /* what is left cannot be flipped */
        for (uint32_t i = 0; i < 3 && status == DM_OK; i++) improve(t, c, i, ends, &status);
    return status;
}
