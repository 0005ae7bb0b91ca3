/* reduced_point.h - what the step equation of reduced.c is made of, in numbers of a kind: NUM with
 * the operations ADD, SUB, MUL, TIMES (by a double), ROOT, OVER, NUMBER (of a double) and the names
 * OF(name). Vectors have DIM entries, turns TURNS of the SIZE entries of a velocity. */

typedef struct {
    NUM x[DIM];
} OF(vec);

/* R, and the velocities of a point of the chart */
typedef struct {
    NUM V[SIZE], x, R[DIM][DIM];
} OF(point);

typedef struct {
    NUM mu[SIZE];    /* L_V at fixed g */
    NUM slope;       /* L_x */
    NUM turn[TURNS]; /* L_g, a body torque: forces cancel */
} OF(slopes);

INLINE NUM OF(dot)(const OF(vec) * a, const OF(vec) * b) {
    NUM out = MUL(a->x[0], b->x[0]);
    for (int i = 1; i < DIM; i++) out = ADD(out, MUL(a->x[i], b->x[i]));
    return out;
}

/* omega x r */
INLINE OF(vec) OF(spin)(const NUM *w, const OF(vec) * r) {
    OF(vec) o;
#if DIM == 2
    o.x[0] = TIMES(MUL(w[0], r->x[1]), -1.0);
    o.x[1] = MUL(w[0], r->x[0]);
#else
    for (int i = 0, j = 1, k = 2; i < 3; i++, j = (j + 1) % 3, k = (k + 1) % 3)
        o.x[i] = SUB(MUL(w[j], r->x[k]), MUL(w[k], r->x[j]));
#endif
    return o;
}

/* out += r x f */
INLINE void OF(add_moment)(NUM *out, const OF(vec) * r, const OF(vec) * f) {
#if DIM == 2
    out[0] = ADD(out[0], SUB(MUL(r->x[0], f->x[1]), MUL(r->x[1], f->x[0])));
#else
    for (int i = 0, j = 1, k = 2; i < 3; i++, j = (j + 1) % 3, k = (k + 1) % 3)
        out[i] = ADD(out[i], SUB(MUL(r->x[j], f->x[k]), MUL(r->x[k], f->x[j])));
#endif
}

/* R r, and R^T r */
INLINE OF(vec) OF(rotate)(NUM R[DIM][DIM], const OF(vec) * r) {
    OF(vec) o;
    for (int i = 0; i < DIM; i++) {
        o.x[i] = MUL(R[i][0], r->x[0]);
        for (int j = 1; j < DIM; j++) o.x[i] = ADD(o.x[i], MUL(R[i][j], r->x[j]));
    }
    return o;
}

INLINE OF(vec) OF(rotate_back)(NUM R[DIM][DIM], const OF(vec) * r) {
    OF(vec) o;
    for (int i = 0; i < DIM; i++) {
        o.x[i] = MUL(R[0][i], r->x[0]);
        for (int j = 1; j < DIM; j++) o.x[i] = ADD(o.x[i], MUL(R[j][i], r->x[j]));
    }
    return o;
}

/* where mass k is in the body */
INLINE OF(vec) OF(place)(int k, NUM x) {
    OF(vec) r;
    for (int i = 0; i < DIM; i++) r.x[i] = NUMBER(((k + i + 2) % 3 - 0.7) * (1 + 0.2 * (i + 1)));
    if (k == 0) r.x[0] = x;
    return r;
}

/* w = omega x r + v + u, body frame */
INLINE OF(vec) OF(velocity)(const NUM *V, int k, const OF(vec) * r) {
    OF(vec) w = OF(spin)(V + 1 + MOVES, r);
    for (int i = 0; i < MOVES; i++) w.x[i] = ADD(w.x[i], V[1 + i]);
    if (k == 0) w.x[0] = ADD(w.x[0], V[0]);
    return w;
}

/* L_V, L_x and, unreduced, L_g, of a point; velocities and springs in space where `space` is set */
INLINE void OF(differentiate)(OF(slopes) * o, OF(point) * z, int space) {
    OF(vec) first = OF(place)(0, z->x), pull = {{NUMBER(0.0)}}, at, axis = {{NUMBER(0.0)}};
    for (int i = 0; i < DIM; i++) pull.x[i] = axis.x[i] = NUMBER(0.0);
    axis.x[0] = NUMBER(1.0);
    for (int i = 0; i < SIZE; i++) o->mu[i] = NUMBER(0.0);
    for (int i = 0; i < TURNS; i++) o->turn[i] = NUMBER(0.0);
    at = space ? OF(rotate)(z->R, &first) : first;
    o->slope = TIMES(z->x, -2.0);
    for (int k = 0; k < 4; k++) {
        const OF(vec) r = OF(place)(k, z->x);
        OF(vec) w = OF(velocity)(z->V, k, &r), p;
        if (space) w = OF(rotate)(z->R, &w);
        for (int i = 0; i < DIM; i++) p.x[i] = TIMES(w.x[i], 1 + 0.1 * (k + 1));
        if (space) p = OF(rotate_back)(z->R, &p);
        OF(add_moment)(o->mu + 1 + MOVES, &r, &p);
        for (int i = 0; i < MOVES; i++) o->mu[1 + i] = ADD(o->mu[1 + i], p.x[i]);
        if (k == 0) {
            const OF(vec) swing = OF(spin)(z->V + 1 + MOVES, &axis);
            o->mu[0] = ADD(o->mu[0], p.x[0]);
            o->slope = ADD(o->slope, OF(dot)(&p, &swing));
            continue;
        }
        const OF(vec) there = space ? OF(rotate)(z->R, &r) : r;
        OF(vec) gap, f;
        for (int i = 0; i < DIM; i++) gap.x[i] = SUB(at.x[i], there.x[i]);
        const NUM stretch = SUB(OVER(ROOT(OF(dot)(&gap, &gap))), NUMBER(1.0));
        for (int i = 0; i < DIM; i++) f.x[i] = MUL(stretch, gap.x[i]);
        for (int i = 0; i < DIM; i++) pull.x[i] = ADD(pull.x[i], f.x[i]);
        if (space) { /* the moment of f and of its reaction */
            OF(vec) body = OF(rotate_back)(z->R, &f), apart = OF(rotate_back)(z->R, &gap);
            OF(add_moment)(o->turn, &apart, &body);
        }
    }
    if (space) pull = OF(rotate_back)(z->R, &pull);
    o->slope = ADD(o->slope, pull.x[0]);
}

/* c_2 .. c_5 of Stumpff within a chart */
INLINE void OF(stumpff)(NUM c[6], NUM t) {
    NUM a = NUMBER(SERIES[6][11]), b = NUMBER(SERIES[7][11]);
    for (int j = 10; j >= 0; j--) {
        a = ADD(MUL(a, t), NUMBER(SERIES[6][j]));
        b = ADD(MUL(b, t), NUMBER(SERIES[7][j]));
    }
    c[4] = SUB(NUMBER(1.0 / 24), MUL(t, a));
    c[5] = SUB(NUMBER(1.0 / 120), MUL(t, b));
    c[2] = SUB(NUMBER(0.5), MUL(t, c[4]));
    c[3] = SUB(NUMBER(1.0 / 6), MUL(t, c[5]));
}

/* phi(ad xi)^T mu, b[1 ...] from xi = h V and mu; sign -1: of -xi, the other trivialization */
INLINE void OF(pull_back)(NUM *b, const NUM *V, const NUM *mu, double h) {
    NUM w[TURNS], v[DIM];
    for (int i = 0; i < TURNS; i++) w[i] = TIMES(V[1 + MOVES + i], h);
    for (int i = 0; i < MOVES; i++) v[i] = TIMES(V[1 + i], h);
    b[0] = mu[0];
    (void)w, (void)v;
#if DIM == 2
    b[1 + MOVES] = mu[1 + MOVES];
#if MOVES
    NUM c[6];
    const NUM t = MUL(w[0], w[0]);
    OF(stumpff)(c, t);
    const NUM s = SUB(NUMBER(1.0), MUL(t, c[3])), u = MUL(w[0], c[2]), q = MUL(w[0], c[3]);
    b[1] = ADD(MUL(s, mu[1]), MUL(u, mu[2]));
    b[2] = SUB(MUL(s, mu[2]), MUL(u, mu[1]));
    b[3] = ADD(b[3], ADD(MUL(ADD(MUL(c[2], v[1]), MUL(q, v[0])), mu[1]),
                         MUL(SUB(MUL(q, v[1]), MUL(c[2], v[0])), mu[2])));
#endif
#else
    NUM c[6];
    OF(vec) m, a, d, e;
    for (int i = 0; i < 3; i++) m.x[i] = mu[1 + MOVES + i];
    NUM t = MUL(w[0], w[0]);
    for (int i = 1; i < 3; i++) t = ADD(t, MUL(w[i], w[i]));
    OF(stumpff)(c, t);
    a = OF(spin)(w, &m);
    d = OF(spin)(w, &a);
    for (int i = 0; i < 3; i++)
        b[1 + MOVES + i] = ADD(SUB(m.x[i], MUL(c[2], a.x[i])), MUL(c[3], d.x[i]));
#if MOVES
    OF(vec) f, wf, wwf, vf, x, y;
    NUM slope = MUL(w[0], v[0]);
    for (int i = 1; i < 3; i++) slope = ADD(slope, MUL(w[i], v[i]));
    for (int i = 0; i < 3; i++) f.x[i] = mu[1 + i];
    wf = OF(spin)(w, &f);
    wwf = OF(spin)(w, &wf);
    vf = OF(spin)(v, &f);
    x = OF(spin)(w, &vf);
    y = OF(spin)(v, &wf);
    const NUM k4 = MUL(slope, SUB(TIMES(c[4], 2.0), c[3]));
    const NUM k5 = MUL(slope, SUB(TIMES(c[5], 3.0), c[4]));
    for (int i = 0; i < 3; i++) {
        b[1 + i] = ADD(SUB(f.x[i], MUL(c[2], wf.x[i])), MUL(c[3], wwf.x[i]));
        e.x[i] = ADD(SUB(MUL(c[3], ADD(x.x[i], y.x[i])), MUL(c[2], vf.x[i])),
                     SUB(MUL(k5, wwf.x[i]), MUL(k4, wf.x[i])));
        b[4 + i] = ADD(b[4 + i], e.x[i]);
    }
#else
    (void)e;
#endif
#endif
}

/* exp of the turn in h V: 1 + c_1 W + c_2 W^2 */
INLINE void OF(turn)(NUM R[DIM][DIM], const NUM *V, double h) {
    NUM w[TURNS], c[6];
    for (int i = 0; i < TURNS; i++) w[i] = TIMES(V[1 + MOVES + i], h);
    NUM t = MUL(w[0], w[0]);
    for (int i = 1; i < TURNS; i++) t = ADD(t, MUL(w[i], w[i]));
    OF(stumpff)(c, t);
    const NUM c1 = SUB(NUMBER(1.0), MUL(t, c[3]));
    for (int j = 0; j < DIM; j++) {
        OF(vec) e, once, twice;
        for (int i = 0; i < DIM; i++) e.x[i] = NUMBER(i == j ? 1.0 : 0.0);
        once = OF(spin)(w, &e);
        twice = OF(spin)(w, &once);
        for (int i = 0; i < DIM; i++)
            R[i][j] = ADD(e.x[i], ADD(MUL(c1, once.x[i]), MUL(c[2], twice.x[i])));
    }
}

/* L_V - dtau_R(h V)^T P of the curve x0 + h V/2, g0 exp(h V/2); P = p0 + h L_e goes into `mu` */
INLINE void OF(equation)(NUM *out, NUM *mu, const NUM *V, const state *s, int space) {
    OF(point) z;
    OF(slopes) L;
    NUM half[DIM][DIM], b[SIZE], moment[SIZE];
    for (int i = 0; i < SIZE; i++) z.V[i] = V[i];
    z.x = ADD(NUMBER(s->x), TIMES(V[0], 0.5 * H));
    if (space) {
        OF(turn)(half, V, 0.5 * H);
        for (int i = 0; i < DIM; i++)
            for (int j = 0; j < DIM; j++) {
                z.R[i][j] = TIMES(half[0][j], s->R[i][0]);
                for (int k = 1; k < DIM; k++)
                    z.R[i][j] = ADD(z.R[i][j], TIMES(half[k][j], s->R[i][k]));
            }
    }
    OF(differentiate)(&L, &z, space);
    for (int i = 0; i < SIZE; i++) mu[i] = NUMBER(s->p[i]), out[i] = L.mu[i];
    mu[0] = ADD(mu[0], TIMES(L.slope, H));
    out[0] = ADD(out[0], TIMES(L.slope, 0.5 * H));
    if (space) { /* the work of L_g on V, and what it is at g0 */
        for (int i = 0; i < SIZE; i++) moment[i] = NUMBER(0.0);
        for (int i = 0; i < TURNS; i++) moment[1 + MOVES + i] = L.turn[i];
        OF(pull_back)(b, V, moment, -0.5 * H);
        for (int i = 1 + MOVES; i < SIZE; i++) out[i] = ADD(out[i], TIMES(b[i], 0.5 * H));
#if DIM == 2
        mu[1 + MOVES] = ADD(mu[1 + MOVES], TIMES(L.turn[0], H));
#else
        OF(vec) torque = {{L.turn[0], L.turn[1], L.turn[2]}};
        torque = OF(rotate)(half, &torque);
        for (int i = 0; i < TURNS; i++)
            mu[1 + MOVES + i] = ADD(mu[1 + MOVES + i], TIMES(torque.x[i], H));
#endif
    }
    OF(pull_back)(b, V, mu, H);
    for (int i = 0; i < SIZE; i++) out[i] = SUB(out[i], b[i]);
}

#undef NUM
#undef NUMBER
#undef ADD
#undef SUB
#undef MUL
#undef TIMES
#undef ROOT
#undef OVER
#undef OF
