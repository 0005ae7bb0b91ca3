/* functions_in_lanes.h - the functions of functions_text.h as entries of a table, included once a
 * width: real, TARGET and OWN_FUNCTION, the name of the table's function, are the includer's. */

/* through memory: how vectors are passed depends on the compiler's switches */
typedef real anywhere __attribute__((aligned(8)));

#define IN_LANES(f)                                                                                \
    TARGET static void f##_in_lanes(anywhere *d, anywhere *d2, const anywhere *a,                  \
                                    const anywhere *b) {                                           \
        (void)d2, (void)b;                                                                         \
        *d = f(*a);                                                                                \
    }
IN_LANES(exponentials)
IN_LANES(logarithms)
IN_LANES(sines)
IN_LANES(cosines)
IN_LANES(tangents)
IN_LANES(hyperbolic_sines)
IN_LANES(hyperbolic_cosines)
IN_LANES(hyperbolic_tangents)

TARGET static void both_in_lanes(anywhere *s, anywhere *c, const anywhere *a, const anywhere *b) {
    real cosine;
    (void)b;
    *s = both(*a, &cosine);
    *c = cosine;
}

/* by name; NULL where there is none of our own */
dm_function *OWN_FUNCTION(dm_function_name name) {
    static dm_function *const table[DM_FUNCTION_COUNT] = {
        [DM_FUNCTION_EXP] = (dm_function *)exponentials_in_lanes,
        [DM_FUNCTION_LOG] = (dm_function *)logarithms_in_lanes,
        [DM_FUNCTION_SIN] = (dm_function *)sines_in_lanes,
        [DM_FUNCTION_COS] = (dm_function *)cosines_in_lanes,
        [DM_FUNCTION_TAN] = (dm_function *)tangents_in_lanes,
        [DM_FUNCTION_SINH] = (dm_function *)hyperbolic_sines_in_lanes,
        [DM_FUNCTION_COSH] = (dm_function *)hyperbolic_cosines_in_lanes,
        [DM_FUNCTION_TANH] = (dm_function *)hyperbolic_tangents_in_lanes,
        [DM_FUNCTION_SINCOS] = (dm_function *)both_in_lanes,
    };
    return table[name];
}
