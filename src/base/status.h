/* status.h - the one list of ways a kernel can end: name, key that a script sees, sentence. */
#ifndef DM_STATUS_H
#define DM_STATUS_H

#define DM_STATUS_LIST(X)                                                                          \
    X(OK, "ok", "done")                                                                            \
    X(NO_CONVERGENCE, "no_convergence", "the step equation did not converge")                      \
    X(SINGULAR, "singular", "the matrix of the step equation is singular")                         \
    X(NOT_FINITE, "not_finite", "a value became NaN or infinite")                                  \
    X(INERTIA, "inertia", "the step goes over a change of inertia of d2L/dv2")                     \
    X(CALLBACK, "callback", "a function of the script failed")                                     \
    X(STOPPED, "stopped", "stopped on request")                                                    \
    X(NO_MEMORY, "no_memory", "not enough memory")                                                 \
    X(TOO_LARGE, "too_large", "the expression graph grew too large")                               \
    X(NO_NATIVE, "no_native", "native code is not possible here")                                  \
    X(NOT_WRITTEN, "not_written", "a file could not be written")                                   \
    X(NO_START, "no_start", "the run could not start")                                             \
    X(OUT_OF_TIME, "out_of_time", "the seconds or steps allowed were over")                        \
    X(TOO_SHORT, "too_short", "the steps of controlled length became too short")                   \
    X(BLOW_UP, "blow_up", "the energy has left that of the start")                                 \
    X(NO_VALUE, "no_value", "a recorded column is NaN")

#define DM_STATUS_ENUM(name, code, text) DM_##name,
typedef enum { DM_STATUS_LIST(DM_STATUS_ENUM) } dm_status;
#undef DM_STATUS_ENUM

#define DM_STATUS_ONE(name, code, text) +1
enum { DM_STATUSES = DM_STATUS_LIST(DM_STATUS_ONE) };
#undef DM_STATUS_ONE

/* "no_convergence" style key, and the sentence a user reads. */
const char *dm_status_code(dm_status status);
const char *dm_status_text(dm_status status);

/* The status that has this key; 0: none has. */
int dm_status_find(dm_status *out, const char *code);

#endif
