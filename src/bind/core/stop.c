/* stop.c - stops that signal handlers tell, and those that wait. */
#include "bind/core/bind.h"

volatile sig_atomic_t dml_stop = 0;
volatile sig_atomic_t dml_raised = 0;
static volatile sig_atomic_t holds, waiting; /* a stop that came meanwhile */

void dml_tell_stop(void) {
    if (holds)
        waiting = 1;
    else
        dml_stop = 1;
}

void dml_hold_stops(void) {
    holds++;
    if (!dml_stop) return;
    waiting = 1;
    dml_stop = 0;
}

void dml_release_stops(void) {
    if (--holds || !waiting) return;
    waiting = 0;
    dml_stop = 1;
}

int dml_holds_stops(void) {
    return holds > 0;
}
