/* bind_quaternion.c - rotations and unit quaternions for lua/dm/group: a run on SO(3) makes one of
 * the other when it reads its start, and again with symbols and with numbers when it calls L.
 * Speed: setup, a body on SO(3): 1.5x. */
#include "bind/value/array.h"
#include "bind/value/trace_log.h"

#include <math.h>

enum { W, X, Y, Z };

/* the entry a b (+ or -) c d, doubled, of coordinates of q off the diagonal */
typedef struct {
    uint8_t a, b, c, d;
    dm_op op;
} product;

/* by rows; those on the diagonal are not read */
static const product products[9] =
    {{0}, {X, Y, W, Z, DM_OP_SUB}, {X, Z, W, Y, DM_OP_ADD}, {X, Y, W, Z, DM_OP_ADD},
     {0}, {Y, Z, W, X, DM_OP_SUB}, {X, Z, W, Y, DM_OP_SUB}, {Y, Z, W, X, DM_OP_ADD},
     {0}};

/* whose symbols are combined; frame NULL: there are none */
typedef struct {
    lua_State *L;
    dml_frame *frame;
} context;

static int is_symbol(const context *c, const dml_scalar *x) {
    return c->frame && x->kind == DML_SYMBOL && x->serial == c->frame->serial;
}

/* op(a, b), in a few instructions where b is a symbol or both are numbers */
static dml_scalar combine(const context *c, dm_op op, dml_scalar a, dml_scalar b) {
    if (is_symbol(c, &b) && (is_symbol(c, &a) || a.kind == DML_NUMBER)) {
        const dm_node node =
            a.kind == DML_NUMBER ? dml_constant(c->L, c->frame, a.as.number) : a.as.node;
        b.as.node = dml_operation(c->L, c->frame, op, node, b.as.node, 0);
        return b;
    }
    if (a.kind != DML_NUMBER || b.kind != DML_NUMBER) return dml_apply(c->L, op, &a, &b, NULL);
    a.as.number = dm_op_value(op, a.as.number, b.as.number, 0.0);
    return a;
}

/* w^2 with the other squares: that of the axis is added, those across it are taken away */
static dml_scalar along(const context *c, const dml_scalar *q, int axis) {
    dml_scalar sum = combine(c, DM_OP_MUL, q[W], q[W]);
    for (int i = X; i <= Z; i++)
        sum = combine(c, i == axis ? DM_OP_ADD : DM_OP_SUB, sum, combine(c, DM_OP_MUL, q[i], q[i]));
    return sum;
}

static dml_scalar across(const context *c, const dml_scalar *q, const product *p) {
    static const dml_scalar two = {.kind = DML_NUMBER, .as.number = 2.0};
    const dml_scalar first = combine(c, DM_OP_MUL, q[p->a], q[p->b]);
    const dml_scalar second = combine(c, DM_OP_MUL, q[p->c], q[p->d]);
    return combine(c, DM_OP_MUL, two, combine(c, p->op, first, second));
}

/* Entries of any kind, in the order of the operations of a trace. */
static int rotation(lua_State *L) {
    dml_scalar q[4], R[9], kind = {.kind = DML_NUMBER};
    context c = {.L = L};
    luaL_argcheck(L, dml_length(L, 1) >= 4, 1, "four numbers expected");
    for (uint32_t i = 0; i < 4; i++) q[i] = dml_entry(L, 1, i);
    if (q[W].kind == DML_SYMBOL) c.frame = dml_findframe(L, q[W].serial);
    for (int i = 0; i < 9; i++) {
        R[i] = i % 4 ? across(&c, q, products + i) : along(&c, q, 1 + i / 4);
        kind = dml_common(L, &kind, R + i);
    }
    if (c.frame) dml_checkgraph(L, c.frame);
    dml_array *m = dml_newarray(L, 2, 3, 3, &kind);
    for (uint32_t i = 0; i < 9; i++) dml_put(L, m, i, R + i);
    return 1;
}

/* entries of the square matrix at 1 where they are numbers, else NULL */
static const double *numbers_of(lua_State *L, uint32_t *n) {
    const dml_array *m = dml_checkarray(L, 1, 2);
    luaL_argcheck(L, m->rows == m->columns, 1, "a square matrix expected");
    *n = m->rows;
    return dml_numbersof(m);
}

/* 4 q q^T of the rows R, S, T; its largest row gives q without a loss of digits (Shepperd 1978) */
static void outer_square(double K[4][4], const double *R, const double *S, const double *T) {
    const double a = R[0], b = S[1], c = T[2];
    K[W][W] = 1 + a + b + c;
    K[X][X] = 1 + a - b - c;
    K[Y][Y] = 1 - a + b - c;
    K[Z][Z] = 1 - a - b + c;
    K[W][X] = K[X][W] = T[1] - S[2];
    K[W][Y] = K[Y][W] = R[2] - T[0];
    K[W][Z] = K[Z][W] = S[0] - R[1];
    K[X][Y] = K[Y][X] = S[0] + R[1];
    K[X][Z] = K[Z][X] = T[0] + R[2];
    K[Y][Z] = K[Z][Y] = T[1] + S[2];
}

static int quaternion(lua_State *L) {
    uint32_t n;
    double K[4][4];
    const double *R = numbers_of(L, &n);
    luaL_argcheck(L, n >= 3, 1, "a matrix of 3 x 3 or more expected");
    if (!R) return 0;
    outer_square(K, R, R + n, R + 2 * (size_t)n);
    int best = W;
    for (int k = X; k <= Z; k++)
        if (K[k][k] > K[best][best]) best = k;
    double scale = 0.5 / sqrt(K[best][best]);
    if (K[best][W] < 0) scale = -scale;
    lua_createtable(L, 4, 0);
    for (int i = 0; i < 4; i++) {
        lua_pushnumber(L, K[best][i] * scale);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

/* NaN is kept: it is no distance from anything */
static int orthonormality(lua_State *L) {
    uint32_t n;
    const double *R = numbers_of(L, &n);
    const lua_Integer m = dml_checkinteger(L, 2);
    luaL_argcheck(L, m >= 1 && m <= n, 2, "as many columns as there are, or fewer, expected");
    if (!R) return 0;
    const uint32_t size = (uint32_t)m;
    double worst = 0.0;
    for (uint32_t i = 0; i < size; i++)
        for (uint32_t j = i; j < size; j++) {
            double sum = i == j ? -1.0 : 0.0;
            for (uint32_t k = 0; k < size; k++) sum += R[k * n + i] * R[k * n + j];
            if (!(fabs(sum) <= worst) && worst == worst) worst = fabs(sum);
        }
    lua_pushnumber(L, worst);
    return 1;
}

static const dml_row functions[] = {
    {"rotation", rotation,
     "core.rotation(q) -> matrix of 3 x 3\n"
     "The rotation of a quaternion (w, x, y, z), a vector or table of numbers or symbols; times "
     "|q|^2 where that is not 1."},
    {"quaternion", quaternion,
     "core.quaternion(R) -> {w, x, y, z} or nothing\n"
     "The unit quaternion with w >= 0 of a rotation matrix, or of the upper left 3 x 3 corner of a "
     "larger one; nothing where its entries are no numbers."},
    {"orthonormality", orthonormality,
     "core.orthonormality(R, n) -> number or nothing\n"
     "Largest entry of R^T R - 1 of the upper left n x n corner of a matrix of numbers."},
    {NULL, NULL, NULL}};

const dml_class dml_class_quaternion = {
    .functions = functions,
};
