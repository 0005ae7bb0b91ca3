/* inertia_look.h - looks along a run, when the next one is due, and what they leave. */
#ifndef DM_INERTIA_LOOK_H
#define DM_INERTIA_LOOK_H

#include "run/inertia/inertia.h"

/* Are more or fewer values negative after so many steps than at the start, or may that have changed
 * and come back? A run on its own goes back to see; a member in lanes begins anew alone. Or did a
 * value that fell not go on falling in the one step since the last look, so that it may have
 * vanished inside? And when to look again. told: what is there, where the caller knows. */
enum { DM_INERTIA_CHANGED = 1, DM_INERTIA_STRANGE = 2, DM_INERTIA_TURNED = 3 };
int dm_inertia_look(dm_inertia *x, const double *state, double t, long done,
                    const dm_inertia_there *told);

/* From the state of the last look on, to which steps are taken: scales that do not hide the fall of
 * what has grown meanwhile. */
void dm_inertia_go_on(dm_inertia *x, const double *state, double t);

/* New scales, by the mass at the state of the last look where that is larger (inertia.c). */
void dm_inertia_scale_again(dm_inertia *x, const double *state, double t);

/* From the kept state on again, after every step: 0 or DM_INERTIA_CHANGED; *steep: or a value may
 * have vanished inside. Leaves `seen` as it is. */
void dm_inertia_begin_closely(dm_inertia *x);
int dm_inertia_look_closely(dm_inertia *x, const double *state, double t, int *steep);

/* Steps until a value vanishes that was `before` so many steps ago; infinite: it does not fall. */
double dm_inertia_left(const dm_inertia *x, double before, double now, double since);

/* May it vanish in the next step, or be so near that DM_INERTIA_TURNED may come of it? */
#define DM_INERTIA_STEEP 1.25
int dm_inertia_is_steep(const dm_inertia_seen *s);

/* The next line between states begins at this one. */
void dm_inertia_keep_place(dm_inertia *x, const double *state);

/* Of `which` members from `first` on, whose q[n][lanes] these are; and where it begins of one. */
void dm_inertia_keep_places(dm_inertia *x, size_t first, const double *q, uint32_t lanes,
                            uint32_t which);
const double *dm_inertia_place_of(const dm_inertia *x, size_t member);

/* Of a member; those of the next one are so many numbers further on. */
dm_inertia_course *dm_inertia_courses_of(const dm_inertia *x, size_t member, size_t *apart);

#endif
