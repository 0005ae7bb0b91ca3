/* functions.c - which elementary function is called: our own with fused multiply-add, the C
 * library's elsewhere and for those that we do not have, by the level of this process. The
 * table of powers of two that exp reads stands here once for all widths. */
#include "numbers/functions.h"

#include "numbers/processor.h"

#include <math.h>

const double dm_exp_powers[2][16]
    __attribute__((aligned(64))) = {{EXP_POWERS, EXP_LATER_POWERS}, {EXP_LOWS, EXP_LATER_LOWS}};

typedef double one(double x);
typedef double two(double x, double *cosine);

/* dm_exp(x) and the like: the function of one lane */
#define FUNCTION(name, op)                                                                         \
    double dm_##name(double x) {                                                                   \
        return ((one *)dm_function_for(op, 1))(x);                                                 \
    }
FUNCTION(exp, DM_FUNCTION_EXP)
FUNCTION(log, DM_FUNCTION_LOG)
FUNCTION(sin, DM_FUNCTION_SIN)
FUNCTION(cos, DM_FUNCTION_COS)
FUNCTION(tan, DM_FUNCTION_TAN)
FUNCTION(sinh, DM_FUNCTION_SINH)
FUNCTION(cosh, DM_FUNCTION_COSH)
FUNCTION(tanh, DM_FUNCTION_TANH)
#undef FUNCTION

double dm_sincos(double x, double *cosine) {
    return ((two *)dm_function_for(DM_FUNCTION_SINCOS, 1))(x, cosine);
}

/* own first; 1, 4 and 8 are the widths there are */
dm_function *dm_function_for(dm_function_name name, uint32_t lanes) {
    dm_function *own = 0;
    if (dm_processor() != DM_PLAIN)
        own = lanes == 1   ? dm_own_function1(name)
              : lanes == 4 ? dm_own_function4(name)
                           : dm_own_function8(name);
    if (own) return own;
    return lanes == 1   ? dm_library_function1(name)
           : lanes == 4 ? dm_library_function4(name)
                        : dm_library_function8(name);
}
