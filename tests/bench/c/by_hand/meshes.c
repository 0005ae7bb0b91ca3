/* meshes - the cells, incidences, signed dual volumes and stars of a mesh of tests/bench/meshes.lua
 * by hand, for triangles and for tetrahedra alone: no checks, no orientation, int and double arrays.
 * cc -O3 -march=native -o meshes tests/bench/c/by_hand/meshes.c -lm; meshes [LEVEL [CUBES]] */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *get(size_t size) {
    void *block = malloc(size);
    if (!block) exit(1);
    return block;
}

typedef struct {
    int vertices, cells, n;
    double (*point)[3];
    int *cell; /* [cells][n + 1], ascending */
} input;

static void sort_small(int *v, int count) {
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && v[j - 1] > v[j]; j--) {
            const int moved = v[j];
            v[j] = v[j - 1], v[j - 1] = moved;
        }
}

/* ---- faces: rows of `width` vertices, each once, in order; in: [count][width], out: of[count] */

static int *unique_rows(int *of, int *found, const int *row, int count, int width, int vertices) {
    int *start = calloc((size_t)vertices + 2, sizeof *start),
        *order = get((size_t)count * sizeof *order);
    if (!start) exit(1);
    for (int i = 0; i < count; i++) start[row[i * width] + 2]++;
    for (int v = 0; v <= vertices; v++) start[v + 1] += start[v];
    for (int i = 0; i < count; i++) order[start[row[i * width] + 1]++] = i;
    int *out = get((size_t)count * (size_t)width * sizeof *out), cells = 0;
    for (int v = 0; v < vertices; v++) {
        for (int i = start[v] + 1; i < start[v + 1]; i++) { /* insertion */
            const int moved = order[i];
            int j = i;
            for (; j > start[v]; j--) {
                const int *a = row + order[j - 1] * width, *b = row + moved * width;
                int differ = 1;
                while (differ < width - 1 && a[differ] == b[differ]) differ++;
                if (a[differ] <= b[differ]) break;
                order[j] = order[j - 1];
            }
            order[j] = moved;
        }
        for (int i = start[v]; i < start[v + 1]; i++) {
            const int *a = row + order[i] * width;
            if (i == start[v] ||
                memcmp(a, row + order[i - 1] * width, (size_t)width * sizeof *a) != 0)
                memcpy(out + (size_t)cells++ * (size_t)width, a, (size_t)width * sizeof *a);
            of[order[i]] = cells - 1;
        }
    }
    free(start);
    free(order);
    *found = cells;
    return out;
}

/* cofaces of every face, one behind the other: at[faces + 1], list[cells * width] */
static void cofaces(int **at, int **list, const int *face, int cells, int width, int faces) {
    int *start = *at = calloc((size_t)faces + 1, sizeof **at);
    *list = get((size_t)cells * (size_t)width * sizeof **list);
    if (!start) exit(1);
    for (int i = 0; i < cells * width; i++) start[face[i]]++;
    for (int i = 1; i < faces; i++) start[i] += start[i - 1];
    start[faces] = cells * width;
    for (int i = cells * width; i-- > 0;) (*list)[--start[face[i]]] = i / width;
}

static double distance2(const input *in, int a, int b) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double d = in->point[a][i] - in->point[b][i];
        sum += d * d;
    }
    return sum;
}

/* ---- triangles ---- */

static double triangles(const input *in) {
    const int T = in->cells;
    int *row = get((size_t)T * 6 * sizeof *row), *face = get((size_t)T * 3 * sizeof *face), edges;
    for (int t = 0; t < T; t++) {
        const int *v = in->cell + 3 * t;
        const int r[6] = {v[1], v[2], v[0], v[2], v[0], v[1]};
        memcpy(row + 6 * t, r, sizeof r);
    }
    int *edge = unique_rows(face, &edges, row, 3 * T, 2, in->vertices);
    int *at, *list, *vat, *vlist;
    cofaces(&at, &list, face, T, 3, edges);
    cofaces(&vat, &vlist, edge, edges, 2, in->vertices);
    double *length2 = get((size_t)edges * sizeof *length2),
           *dual1 = calloc((size_t)edges, sizeof *dual1);
    double *area = get((size_t)T * sizeof *area),
           *dual0 = calloc((size_t)in->vertices, sizeof *dual0);
    double *star0 = get((size_t)in->vertices * sizeof *star0),
           *star1 = get((size_t)edges * sizeof *star1);
    double *star2 = get((size_t)T * sizeof *star2), *length = get((size_t)edges * sizeof *length),
           sum = 0.0;
    if (!dual0 || !dual1) exit(1);
    for (int e = 0; e < edges; e++) {
        length2[e] = distance2(in, edge[2 * e], edge[2 * e + 1]);
        length[e] = sqrt(length2[e]);
    }
    for (int t = 0; t < T; t++) {
        const int *e = face + 3 * t, *v = in->cell + 3 * t;
        const double l[3] = {length2[e[0]], length2[e[1]], length2[e[2]]};
        const double mixed = l[0] + l[1] - l[2], area4 = sqrt(4 * l[0] * l[1] - mixed * mixed);
        area[t] = area4 / 4;
        star2[t] = 1 / area[t];
        for (int i = 0; i < 3; i++) {
            const double cot = (l[(i + 1) % 3] + l[(i + 2) % 3] - l[i]) / area4;
            dual1[e[i]] += cot * length[e[i]] / 2;
            dual0[v[(i + 1) % 3]] += cot * l[i] / 8;
            dual0[v[(i + 2) % 3]] += cot * l[i] / 8;
        }
    }
    for (int e = 0; e < edges; e++) star1[e] = dual1[e] / length[e];
    for (int v = 0; v < in->vertices; v++) sum += star0[v] = dual0[v];
    free(row), free(face), free(edge), free(at), free(list), free(vat), free(vlist), free(length2);
    free(dual1), free(area), free(dual0), free(star0), free(star1), free(star2), free(length);
    return sum;
}

/* ---- tetrahedra ---- */

/* circumcentre of a tetrahedron in barycentric coordinates, from squared lengths */
static void centre(double *lambda, double *volume, double l[4][4]) {
    double G[3][3], r[3], c[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) G[i][j] = (l[0][i + 1] + l[0][j + 1] - l[i + 1][j + 1]) / 2;
    const double c0 = G[1][1] * G[2][2] - G[1][2] * G[2][1],
                 c1 = G[1][2] * G[2][0] - G[1][0] * G[2][2];
    const double c2 = G[1][0] * G[2][1] - G[1][1] * G[2][0];
    const double c4 = G[0][0] * G[2][2] - G[0][2] * G[2][0],
                 c5 = G[0][1] * G[2][0] - G[0][0] * G[2][1];
    const double c8 = G[0][0] * G[1][1] - G[0][1] * G[1][0];
    const double det = G[0][0] * c0 + G[0][1] * c1 + G[0][2] * c2;
    for (int i = 0; i < 3; i++) r[i] = G[i][i] / 2;
    c[0] = (c0 * r[0] + c1 * r[1] + c2 * r[2]) / det;
    c[1] = (c1 * r[0] + c4 * r[1] + c5 * r[2]) / det;
    c[2] = (c2 * r[0] + c5 * r[1] + c8 * r[2]) / det;
    lambda[0] = 1 - c[0] - c[1] - c[2], lambda[1] = c[0], lambda[2] = c[1], lambda[3] = c[2];
    *volume = sqrt(det) / 6;
}

/* the edges of a tetrahedron as pairs of its vertices */
static const int pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* cells of every degree: faces of tetrahedra, sides of triangles, ends of edges, and back */
typedef struct {
    int T, faces, edges, vertices;
    int *face, *triangle, *side, *edge;
    int *at2, *list2, *at1, *list1, *at0, *list0;
} solid;

static void find_cells(solid *s, const input *in) {
    const int T = s->T = in->cells;
    int *row = get((size_t)T * 12 * sizeof *row);
    s->vertices = in->vertices;
    s->face = get((size_t)T * 4 * sizeof(int));
    for (int t = 0; t < T; t++)
        for (int j = 0; j < 4; j++)
            for (int i = 0, at = 0; i < 4; i++)
                if (i != j) row[12 * t + 3 * j + at++] = in->cell[4 * t + i];
    s->triangle = unique_rows(s->face, &s->faces, row, 4 * T, 3, in->vertices);
    free(row);
    row = get((size_t)s->faces * 6 * sizeof *row);
    s->side = get((size_t)s->faces * 3 * sizeof(int));
    for (int f = 0; f < s->faces; f++) {
        const int *v = s->triangle + 3 * f;
        const int r[6] = {v[1], v[2], v[0], v[2], v[0], v[1]};
        memcpy(row + 6 * f, r, sizeof r);
    }
    s->edge = unique_rows(s->side, &s->edges, row, 3 * s->faces, 2, in->vertices);
    free(row);
}

static void find_cofaces(solid *s) {
    cofaces(&s->at2, &s->list2, s->face, s->T, 4, s->faces);
    cofaces(&s->at1, &s->list1, s->side, s->faces, 3, s->edges);
    cofaces(&s->at0, &s->list0, s->edge, s->edges, 2, s->vertices);
}

static void free_cells(solid *s) {
    free(s->face), free(s->triangle), free(s->side), free(s->edge);
    free(s->at2), free(s->list2), free(s->at1), free(s->list1), free(s->at0), free(s->list0);
}

/* squares of lengths, areas, volumes; duals begin at 0 */
typedef struct {
    double *length2, *area, *volume, *dual[3], *star[4];
} sizes;

static void open_sizes(sizes *m, const solid *s) {
    const size_t count[4] = {(size_t)s->vertices, (size_t)s->edges, (size_t)s->faces, (size_t)s->T};
    m->length2 = get(count[1] * sizeof(double));
    m->area = get(count[2] * sizeof(double));
    m->volume = get(count[3] * sizeof(double));
    for (int k = 0; k < 4; k++) m->star[k] = get(count[k] * sizeof(double));
    for (int k = 0; k < 3; k++)
        if (!(m->dual[k] = calloc(count[k], sizeof(double)))) exit(1);
}

static void free_sizes(sizes *m) {
    free(m->length2), free(m->area), free(m->volume);
    for (int k = 0; k < 4; k++) free(m->star[k]);
    for (int k = 0; k < 3; k++) free(m->dual[k]);
}

static void measure_faces(sizes *m, const solid *s, const input *in) {
    for (int e = 0; e < s->edges; e++)
        m->length2[e] = distance2(in, s->edge[2 * e], s->edge[2 * e + 1]);
    for (int f = 0; f < s->faces; f++) {
        const double a = m->length2[s->side[3 * f]], b = m->length2[s->side[3 * f + 1]],
                     c = m->length2[s->side[3 * f + 2]];
        const double mixed = a + b - c;
        m->area[f] = sqrt(4 * a * b - mixed * mixed) / 4;
    }
}

/* to the duals of the faces of tetrahedron t; one[p]: of edge p, times its length, for later */
static void add_faces(sizes *m, const solid *s, int t, double l[4][4], double *one) {
    double lambda[4];
    const int *F = s->face + 4 * t;
    centre(lambda, m->volume + t, l);
    m->star[3][t] = 1 / m->volume[t];
    for (int j = 0; j < 4; j++) {
        const double share = lambda[j] * 3 * m->volume[t] / m->area[F[j]];
        m->dual[2][F[j]] += share;
        const double scale = 1 / (16 * m->area[F[j]] * m->area[F[j]]);
        for (int p = 0; p < 6; p++) {
            const int a = pair[p][0], b = pair[p][1];
            if (a == j || b == j) continue;
            const int w = 6 - a - b - j;
            const double x = l[a][b] * (l[a][w] + l[b][w] - l[a][b]) * scale;
            one[p] += x * m->area[F[j]] * share; /* times |e|, height and half */
        }
    }
}

static void add_tetrahedron(sizes *m, const solid *s, const input *in, int t) {
    const int *v = in->cell + 4 * t, *F = s->face + 4 * t;
    /* edges of the tetrahedron: 01 02 12 of face 3, 03 13 of face 2 and 1, 23 of face 0 */
    const int *f3 = s->side + 3 * F[3], *f2 = s->side + 3 * F[2], *f0 = s->side + 3 * F[0];
    const int E[6] = {f3[2], f3[1], f2[1], f3[0], f0[1], f0[0]};
    double l[4][4] = {{0}}, one[6] = {0};
    for (int p = 0; p < 6; p++)
        l[pair[p][0]][pair[p][1]] = l[pair[p][1]][pair[p][0]] = m->length2[E[p]];
    add_faces(m, s, t, l, one);
    for (int p = 0; p < 6; p++) {
        m->dual[1][E[p]] += one[p] / sqrt(l[pair[p][0]][pair[p][1]]);
        m->dual[0][v[pair[p][0]]] += one[p] / 6;
        m->dual[0][v[pair[p][1]]] += one[p] / 6;
    }
}

static double tetrahedra(const input *in) {
    solid s;
    sizes m;
    double sum = 0.0;
    find_cells(&s, in);
    find_cofaces(&s);
    open_sizes(&m, &s);
    measure_faces(&m, &s, in);
    for (int t = 0; t < s.T; t++) add_tetrahedron(&m, &s, in, t);
    for (int f = 0; f < s.faces; f++) m.star[2][f] = m.dual[2][f] / m.area[f];
    for (int e = 0; e < s.edges; e++) m.star[1][e] = m.dual[1][e] / sqrt(m.length2[e]);
    for (int x = 0; x < s.vertices; x++) sum += m.star[0][x] = m.dual[0][x];
    free_cells(&s);
    free_sizes(&m);
    return sum;
}

/* ---- what is measured ---- */

static const double g = 1.6180339887498949;

/* an icosahedron, split in four `level` times; the midpoint of an edge by a table of hashes */
static input icosphere(int level) {
    static const int first[60] = {0, 11, 5, 0, 5,  1,  0,  1,  7,  0,  7, 10, 0, 10, 11,
                                  1, 5,  9, 5, 11, 4,  11, 10, 2,  10, 7, 6,  7, 1,  8,
                                  3, 9,  4, 3, 4,  2,  3,  2,  6,  3,  6, 8,  3, 8,  9,
                                  4, 9,  5, 2, 4,  11, 6,  2,  10, 8,  6, 7,  9, 8,  1};
    const double start[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    int T = 20;
    for (int s = 0; s < level; s++) T *= 4;
    input in = {12, 20, 2, get(((size_t)T / 2 + 2) * sizeof *in.point),
                get((size_t)T * 3 * sizeof(int))};
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 3; j++) in.point[i][j] = start[i][j] / sqrt(1 + g * g);
    memcpy(in.cell, first, sizeof first);
    const uint32_t size = 1u << 21;
    uint64_t *key = get(size * sizeof *key);
    int *value = get(size * sizeof *value), *old = get((size_t)T * 3 * sizeof *old);
    for (int s = 0; s < level; s++) {
        memset(key, 0, size * sizeof *key);
        memcpy(old, in.cell, (size_t)in.cells * 3 * sizeof *old);
        for (int t = in.cells; t-- > 0;) {
            int m[3];
            for (int i = 0; i < 3; i++) {
                const int a = old[3 * t + i], b = old[3 * t + (i + 1) % 3], lo = a < b ? a : b;
                const uint64_t k = (uint64_t)lo << 32 | (uint32_t)(a < b ? b : a);
                uint32_t at = (uint32_t)(k * 0x9e3779b97f4a7c15u >> 43);
                while (key[at] && key[at] != k) at = (at + 1) % size;
                if (!key[at]) {
                    double p[3], r = 0;
                    for (int j = 0; j < 3; j++)
                        p[j] = in.point[a][j] + in.point[b][j], r += p[j] * p[j];
                    for (int j = 0; j < 3; j++) in.point[in.vertices][j] = p[j] / sqrt(r);
                    key[at] = k, value[at] = in.vertices++;
                }
                m[i] = value[at];
            }
            const int *v = old + 3 * t;
            const int four[12] = {v[0], m[0], m[2], v[1], m[1], m[0],
                                  v[2], m[2], m[1], m[0], m[1], m[2]};
            memcpy(in.cell + 12 * t, four, sizeof four);
        }
        in.cells *= 4;
    }
    for (int t = 0; t < in.cells; t++) sort_small(in.cell + 3 * t, 3);
    free(key), free(value), free(old);
    return in;
}

/* the unit cube in N^3 cubes of six tetrahedra */
static input cubes(int N) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int M = N + 1;
    input in = {M * M * M, 6 * N * N * N, 3, get((size_t)(M * M * M) * sizeof *in.point),
                get((size_t)(24 * N * N * N) * sizeof(int))};
    for (int v = 0; v < in.vertices; v++) {
        in.point[v][0] = (double)(v % M) / N;
        in.point[v][1] = (double)(v / M % M) / N;
        in.point[v][2] = (double)(v / M / M) / N;
    }
    int *at = in.cell;
    for (int c = 0; c < N * N * N; c++)
        for (int o = 0; o < 6; o++, at += 4) {
            const int step[3] = {1, M, M * M};
            at[0] = c % N + M * (c / N % N) + M * M * (c / N / N);
            for (int i = 0; i < 3; i++) at[i + 1] = at[i] + step[order[o][i]];
        }
    return in;
}

static double by_name(int size, input (*make)(int), double (*build)(const input *)) {
    const input in = make(size);
    const double sum = build(&in);
    free(in.point), free(in.cell);
    return sum;
}

/* `made`: the input is made each time, too */
static void race(const char *name, int size, int made, input (*make)(int),
                 double (*build)(const input *)) {
    const input in = make(size);
    double best = INFINITY, sum = 0;
    for (int i = 0; i < 9; i++) {
        const double began = now();
        sum = made ? by_name(size, make, build) : build(&in);
        const double took = now() - began;
        best = took < best ? took : best;
    }
    printf("%-28s by hand in C      %9.1f ns a cell   (|K| = %.12g)\n", name, best / in.cells * 1e9,
           sum);
    free(in.point), free(in.cell);
}

int main(int count, char **word) {
    const int level = count > 1 ? atoi(word[1]) : 7, side = count > 2 ? atoi(word[2]) : 30;
    race("mesh of triangles", level, 0, icosphere, triangles);
    race("mesh of tetrahedra", side, 0, cubes, tetrahedra);
    race("icosphere by name", level, 1, icosphere, triangles);
    race("cube tiling by name", side, 1, cubes, tetrahedra);
    return 0;
}
