/* jit_exp.h - the exponential of 8 lanes without a call, with the bits of functions_text.h. */
#ifndef DM_JIT_EXP_H
#define DM_JIT_EXP_H

#include "code/native/jit_emit.h"

enum { DM_EXP_BASE = 9 }; /* r9 holds the address of the table below */

extern const double dm_exp_table[][8];

/* Its first numbers into the last registers of e, as many as leave it `least`; `before` the
 * loop. */
void dm_exp_to_registers(dm_emitter *e, dm_code *before, int least);

/* The code of the step, which is an exponential; table and registers as above. */
void dm_emit_exponential(dm_emitter *e, const dm_step *s);

#endif
