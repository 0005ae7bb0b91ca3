/* icosphere.c - every face knows, for each of its edges, the face beyond it and which edge it is
 * there, so midpoints are found without a search. */
#include "dec/named/icosphere.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 12, FACES = 20, EVERY = 1 << 14 /* faces between looks at stop */ };

/* golden ratio */
#define G 1.6180339887498949

static const double CORNER[CORNERS][3] = {{-1, G, 0}, {1, G, 0}, {-1, -G, 0}, {1, -G, 0},
                                          {0, -1, G}, {0, 1, G}, {0, -1, -G}, {0, 1, -G},
                                          {G, 0, -1}, {G, 0, 1}, {-G, 0, -1}, {-G, 0, 1}};

static const uint32_t FACE[FACES][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10},
                                        {0, 10, 11}, {1, 5, 9},  {5, 11, 4}, {11, 10, 2},
                                        {10, 7, 6},  {7, 1, 8},  {3, 9, 4},  {3, 4, 2},
                                        {3, 2, 6},   {3, 6, 8},  {3, 8, 9},  {4, 9, 5},
                                        {2, 4, 11},  {6, 2, 10}, {8, 6, 7},  {9, 8, 1}};

/* Edge i of a face goes from its vertex i to the next; mate 3 f + i: the same edge, the other way,
 * in another face. middle: the vertex halfway, once it is there. */
typedef struct {
    uint32_t *face, *mate, *middle; /* [faces][3] */
} level;

static void put(double *to, double x, double y, double z) {
    const double r = sqrt(x * x + y * y + z * z);
    to[0] = x / r, to[1] = y / r, to[2] = z / r;
}

/* the edge from b to a among the first faces */
static uint32_t find(const uint32_t *face, uint32_t a, uint32_t b) {
    uint32_t e = 0;
    while (face[e] != b || face[e - e % 3 + (e + 1) % 3] != a) e++;
    return e;
}

static dm_status room(level *l, dm_arena *arena, size_t faces) {
    l->face = dm_arena_take(arena, faces * 3 * sizeof *l->face);
    l->mate = dm_arena_take(arena, faces * 3 * sizeof *l->mate);
    l->middle = dm_arena_take(arena, faces * 3 * sizeof *l->middle);
    return l->face && l->mate && l->middle ? DM_OK : DM_NO_MEMORY;
}

static dm_status begin(level *l, dm_icosphere *out, dm_arena *scratch) {
    const dm_status status = room(l, scratch, FACES);
    if (status != DM_OK) return status;
    memcpy(l->face, FACE, sizeof FACE);
    for (uint32_t e = 0; e < 3 * FACES; e++)
        l->mate[e] = find(l->face, l->face[e], l->face[e - e % 3 + (e + 1) % 3]);
    for (uint32_t i = 0; i < CORNERS; i++)
        put(out->point + 3 * i, CORNER[i][0], CORNER[i][1], CORNER[i][2]);
    out->vertices = CORNERS;
    out->faces = FACES;
    return DM_OK;
}

/* the vertices halfway along the edges of face f: new ones, or those of a face before it */
static void find_middles(level *l, dm_icosphere *out, uint32_t f) {
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t mate = l->mate[3 * f + i];
        if (mate / 3 < f) {
            l->middle[3 * f + i] = l->middle[mate];
            continue;
        }
        const double *a = out->point + 3 * (size_t)l->face[3 * f + i];
        const double *b = out->point + 3 * (size_t)l->face[3 * f + (i + 1) % 3];
        l->middle[3 * f + i] = out->vertices;
        put(out->point + 3 * (size_t)out->vertices++, a[0] + b[0], a[1] + b[1], a[2] + b[2]);
    }
}

/* the four parts of face f to `to`: part i < 3 is at vertex i, part 3 in the middle */
static void split(const level *from, level *to, uint32_t f) {
    const uint32_t *v = from->face + 3 * f, *m = from->middle + 3 * f, *mate = from->mate + 3 * f;
    uint32_t *part = to->face + 12 * f, *other = to->mate + 12 * f;
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t last = (i + 2) % 3, there = mate[i] / 3, edge = mate[i] % 3;
        part[3 * i] = v[i], part[3 * i + 1] = m[i], part[3 * i + 2] = m[last];
        part[9 + i] = m[i];
        /* halves of edge i: the first of part i, the second of the next; and inner edges */
        other[3 * i] = 12 * there + 3 * ((edge + 1) % 3) + 2;
        other[3 * ((i + 1) % 3) + 2] = 12 * there + 3 * edge;
        other[3 * i + 1] = 12 * f + 9 + last;
        other[9 + last] = 12 * f + 3 * i + 1;
    }
}

/* all faces in four: l becomes what they are */
static dm_status split_all(level *l, dm_icosphere *out, dm_arena *scratch,
                           volatile const int *stop) {
    level next;
    const dm_status status = room(&next, scratch, 4 * (size_t)out->faces);
    if (status != DM_OK) return status;
    for (uint32_t f = 0; f < out->faces; f++) {
        if (f % EVERY == 0 && stop && *stop) return DM_STOPPED;
        find_middles(l, out, f);
        split(l, &next, f);
    }
    out->faces *= 4;
    *l = next;
    return DM_OK;
}

dm_status dm_icosphere_make(dm_icosphere *out, dm_arena *arena, uint32_t splits,
                            volatile const int *stop) {
    dm_arena *scratch = dm_arena_scratch(arena);
    level l;
    size_t faces = FACES;
    if (splits > DM_ICOSPHERE_MOST) return DM_TOO_LARGE;
    for (uint32_t s = 0; s < splits; s++) faces *= 4;
    out->point = dm_arena_take(arena, (faces / 2 + 2) * 3 * sizeof *out->point);
    out->face = dm_arena_take(arena, faces * 3 * sizeof *out->face);
    if (!scratch || !out->point || !out->face) return DM_NO_MEMORY;
    dm_status status = begin(&l, out, scratch);
    for (uint32_t s = 0; status == DM_OK && s < splits; s++)
        status = split_all(&l, out, scratch, stop);
    if (status == DM_OK) memcpy(out->face, l.face, faces * 3 * sizeof *out->face);
    return status;
}
