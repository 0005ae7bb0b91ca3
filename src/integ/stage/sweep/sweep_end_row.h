/* sweep_end_row.h - the end of a step, for sweep_row.h alone, which has the names of its text. */
#ifdef FOUR_TOTALS
/* sum_m b_m u_m of four rows */
HOW INLINE v4 OWN(four)(V top, V rest, BITS used, const double *u) {
    V x[4];
    for (int i = 0; i < 4; i++) {
        const V y = (V)(used & (BITS)LOAD(u + (size_t)i * W));
        x[i] = top * y + rest * y;
    }
    return FOUR_TOTALS(x[0], x[1], x[2], x[3]);
}

HOW INLINE v4 OWN(add_four)(double *high, double *low, v4 d) {
    v4 *h = (v4 *)(void *)high, *l = (v4 *)(void *)low;
    const v4 old = *h, e = *l + d, sum = old + e, rest = e + (old - sum);
    *h = sum;
    *l = rest;
    return rest;
}
#endif

#ifndef FINISH
HOW static double OWN(finish)(const dm_sweep_end *a) {
    const dm_sweep_end at = *a;
    const V top_q = LOAD(at.b[0]->top), rest_q = LOAD(at.b[0]->rest);
    const V top_p = LOAD(at.b[1]->top), rest_p = LOAD(at.b[1]->rest);
    /* lanes without a weight are no stages, and may be at a pole */
    const BITS used_q = (BITS)(top_q != (V){0}), used_p = (BITS)(top_p != (V){0});
    const uint32_t n = at.rows;
    double *high = at.state, *low = at.state + 2 * (size_t)n;
    v2 bad = {0};
    uint32_t k = 0;
#ifdef FOUR_TOTALS
    v4 spoilt = {0};
    for (; k + 4 <= n; k += 4) {
        const v4 q = OWN(four)(top_q, rest_q, used_q, at.u[0] + (size_t)k * W);
        const v4 p = OWN(four)(top_p, rest_p, used_p, at.u[1] + (size_t)k * W);
        const v4 d = q * FOUR(at.factor + k) + FOUR(at.drift + k);
        spoilt += 0.0 * OWN(add_four)(high + k, low + k, d);
        spoilt += 0.0 * OWN(add_four)(high + n + k, low + n + k, p);
    }
    bad = (v2){spoilt[0] + spoilt[1], spoilt[2] + spoilt[3]};
#endif
    for (; k < n; k++) {
        const V u = (V)(used_q & (BITS)LOAD(at.u[0] + (size_t)k * W));
        const V f = (V)(used_p & (BITS)LOAD(at.u[1] + (size_t)k * W));
        /* two roundings also where one would do: by a decimal coefficient it is not even */
        const V q = top_q * u + rest_q * u, p = top_p * f + rest_p * f;
        const H *x = (const H *)(const void *)&q, *y = (const H *)(const void *)&p;
        const H q_half = x[0] + x[1], p_half = y[0] + y[1];
        const v2 d = TOTALS(q_half, p_half) * (v2){at.factor[k], 1.0} + (v2){at.drift[k], 0.0};
        const v2 old = {high[k], high[n + k]}, e = (v2){low[k], low[n + k]} + d;
        const v2 sum = old + e, rest = e + (old - sum);
        high[k] = sum[0];
        high[n + k] = sum[1];
        low[k] = rest[0];
        low[n + k] = rest[1];
        bad += 0.0 * rest; /* NaN where the sum is infinite */
    }
    return bad[0] + bad[1];
}
#define FINISH OWN(finish)
#endif
