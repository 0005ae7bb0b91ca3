/* fingerprint.h - what a function computes, as 64 bits: of the nodes it is made of, the equations
 * of its implicit functions, the terms, columns and data of its sums. The order in which a script
 * made the nodes does not count, nor do serial numbers, which differ from process to process. */
#ifndef DM_FINGERPRINT_H
#define DM_FINGERPRINT_H

#include "graph/graph.h"

#include <stdint.h>

/* Where a hash begins: FNV-1a, 64 bits. */
#define DM_HASH_START ((uint64_t)0xcbf29ce484222325u)

/* Continue a hash with bytes. */
uint64_t dm_hash(uint64_t hash, const void *bytes, size_t size);

/* *hash continued with out[count] of g, and with the sums of virtual work in g, on which no root
 * depends. Scratch is taken from `arena`; 0 without memory. */
int dm_fingerprint(uint64_t *hash, const dm_graph *g, const dm_node *out, uint32_t count,
                   dm_arena *arena);

#endif
