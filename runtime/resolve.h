/* SPDX-License-Identifier: MIT
 *
 * resolve: how long a step may be that misses nothing of a road. */
#ifndef RESOLVE_H
#define RESOLVE_H

#include "gic_runtime.h"

#include <stdbool.h>

/* A road that hands on every call to another one and keeps where it was asked for heights. */
typedef struct Probe Probe;

/* NULL: no memory. */
Probe *probe_new(void);
void probe_free(Probe *probe);

/* The road that stands for `road` until the next call; NULL for NULL. */
const gic_road *probe_road(Probe *probe, const gic_road *road);
/* A right-hand side at `time` begins. */
void probe_begin(Probe *probe, double time);
/* A step has ended: points of its last right-hand side, and how fast they have moved. */
void probe_end(Probe *probe);
/* Did the last step ask for any height? */
bool probe_asked(const Probe *probe);
/* The longest step (s) in which no point passes over a part of the road unseen; INFINITY where there is nothing to
 * miss. */
double probe_longest(const Probe *probe);

/* How far (m) a point may move from (x, y) so that at least some steps fall on whatever is there: half the way to the
 * next part that is not straight, or a share of its length. INFINITY on planes, and on roads that are not gic_road.h's.
 */
double road_clear(const gic_road *road, double x, double y);

#endif
