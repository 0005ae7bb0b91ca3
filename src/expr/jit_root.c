#include "expr/jit_root.h"

#include "expr/jit_pool.h"
#include "expr/processor.h"

/* as rsqrt_avx512 in root.c does it; x, y, e, p, low are registers */
static void by_series(dm_emitter *e, int x, int y, int error, int p, int low) {
    dm_code *c = &e->code;
    const dm_width w = e->width;
    dm_x86_rsqrt14(c, w, y, x);
    dm_x86_op(c, w, DM_X86_MUL, error, x, dm_in_register(y)); /* s = x y */
    dm_x86_load(c, w, low, dm_in_register(error));
    dm_x86_fused(c, w, DM_X86_FMSUB231, low, x, dm_in_register(y), 0); /* x y - s */
    dm_x86_fused(c, w, DM_X86_FNMADD213, error, y, dm_pool_mask(e, DM_POOL_ONE), 0);
    dm_x86_load(c, w, p, dm_pool_mask(e, DM_POOL_ROOT3));
    dm_x86_fused(c, w, DM_X86_FMADD213, p, error, dm_pool_mask(e, DM_POOL_ROOT2), 0);
    dm_x86_fused(c, w, DM_X86_FMADD213, p, error, dm_pool_mask(e, DM_POOL_ROOT1), 0);
    dm_x86_is_number(c, w, 1, error);
    dm_x86_fused(c, w, DM_X86_FNMADD213, low, y, dm_in_register(error), 0);
    dm_x86_op(c, w, DM_X86_MUL, low, low, dm_in_register(y));
    dm_x86_fused(c, w, DM_X86_FMADD231, y, low, dm_in_register(p), 1);
}

void dm_emit_reciprocal_root(dm_emitter *e, const dm_step *s) {
    const int x = dm_in_a_register(e, s->arg[0]), y = dm_take_register(e);
    const int error = dm_take_register(e), p = dm_take_register(e);
    const int low = dm_take_register(e);
    if (dm_processor() == DM_AVX512) {
        by_series(e, x, y, error, p, low);
    } else {
        dm_x86_op(&e->code, e->width, DM_X86_SQRT, y, x, dm_in_register(x));
        dm_x86_load(&e->code, e->width, p, dm_pool_mask(e, DM_POOL_ONE));
        dm_x86_op(&e->code, e->width, DM_X86_DIV, y, p, dm_in_register(y));
    }
    dm_pass_operands(e, s);
    dm_define(e, s->d, y);
}
