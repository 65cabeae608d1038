/* SPDX-License-Identifier: MIT
 *
 * profile: an input as a function of time; models/SCENE.md section 4. */
#ifndef SCENE_PROFILE_H
#define SCENE_PROFILE_H

#include "base/message.h"
#include "host/host.h"
#include "model/model.h"
#include "scene/profile_form.h"

/* ---- profile.c */

/* How many inputs follow it, from profile->input on: the value; of a post its rate, too; of a driven coordinate also
 * its acceleration. */
int profile_orders(const Profile *profile);
/* True if it is constant for all time. */
bool profile_is_constant(const Profile *profile);
/* The first time after `time` at which it is less smooth; INFINITY: none. */
double profile_next_kink(const Profile *profile, double time);
/* The first time after `time` at which only its jerk jumps, between pieces that constant steps of `step` s resolve, so
 * that knot_cross() knows what they miss there; INFINITY: none. */
double profile_next_knot(const Profile *profile, double time, double step);
/* The longest step from `time` (s) that skips no feature of it, or INFINITY. */
double profile_longest_step(const Profile *profile, double time);
/* The time up to which it is constant; `time` itself if that is unknown. */
double profile_quiet_until(const Profile *profile, double time);
/* The lowest and highest value, and the largest magnitudes of rate and acceleration from 0 to `duration`, s. All but
 * those of knots are from values at many times. */
typedef struct ProfilePeaks {
    double low, high, rate, acceleration;
} ProfilePeaks;
ProfilePeaks profile_peaks(const Profile *profile, double duration);

/* ---- read_profile.c */

/* A profile as it stands in a scene. Its input, driven, unit, offset (the value that forms begin from), end (of the
 * scene, s; 0: not known) and model are set. name: of the input, and of its column in a file. */
void profile_read(Pool *pool, const Item *item, const char *name, Profile *profile);
/* A curve through samples at rising times: a cubic spline, or monotone between samples. It is at rest at its first
 * sample where that is after time 0, and at its last one where that is before the scene's end. */
void profile_through(Pool *pool, Profile *profile, int count, double *time, double *value, bool monotone);

/* ---- read_input_file.c: profiles from tables of samples (CSV) */

/* The form `file: {name, column, fit, scale, offset}` of one input; its column has the input's name by default. */
void profile_read_file(Pool *pool, const Item *item, const char *input, Profile *profile);
/* `fit` of an input: is it monotone? item NULL: as is usual, for driven coordinates a spline. */
bool profile_fit_monotone(const Item *item, bool driven);
/* The samples of a column, in `unit`: *time (s) and *value, as many as the result says. unit NULL: numbers stay
 * as they are. monotone: gaps are allowed. */
int samples_read(Pool *pool, const CsvTable *table, int column, const char *unit, bool monotone, double **time,
                 double **value);

/* ---- formula_of_time.c */

/* Value, first and second derivative by time of a formula whose only local is the time. */
void formula_of_time(const Law *law, const Model *model, double time, double out[3]);
/* The name of an operation whose rate may jump, as it was written; NULL: there is none. */
const char *formula_of_time_kink(const Law *law);

#endif
