/* bound.h - the hand-written C that the rest is measured against: each problem with its force as
 * scalars and as lanes, and the methods made special to it by inlining. */
#ifndef BENCH_BOUND_H
#define BENCH_BOUND_H

#include "gauss.h"
#include "rk8.h"
#include "search.h"
#include "splitting.h"
#include "stoermer.h"

extern const bench_problem bench_kepler[], bench_satellite[], bench_planets[], bench_pendulum[],
    bench_body[], bench_spring[], bench_chain[];

#endif
