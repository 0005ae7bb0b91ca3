/* supports.h - the transfer of forms by supports, as it is printed (Leok 3.14): the support of a
 * cell is the union of the simplices of the circumcentric subdivision that meet it in its centre,
 * taken with their signs where centres lie outside. */
#ifndef DM_SUPPORTS_H
#define DM_SUPPORTS_H

#include "dec/transfer/entries.h"
#include "dec/transfer/transfer.h"

/* sgn(t, s) |V_t and V_s| / |V_s| for all k-cells s of `from` and t of `to`; N = n. Cells s without
 * a support give nothing. DM_NO_MEMORY, DM_STOPPED. */
dm_status dm_supports_transfer(dm_entries *out, const dm_realization *from,
                               const dm_realization *to, uint32_t k, dm_arena *scratch,
                               volatile const int *stop);

#endif
