/* SPDX-License-Identifier: MIT
 *
 * The longest step that skips no feature of a road. */
#ifndef RUN_ROAD_RESOLUTION_H
#define RUN_ROAD_RESOLUTION_H

#include "gic_runtime.h"

#include <stdbool.h>

/* A road that forwards every call to another one and records the places where heights were asked for. */
typedef struct Probe Probe;

/* NULL: no memory. */
Probe *probe_new(void);
void probe_free(Probe *probe);

/* The probe as a road in place of `road`, until the next call; NULL for NULL. */
const gic_road *probe_road(Probe *probe, const gic_road *road);
/* A right-hand side at `time` begins. */
void probe_begin(Probe *probe, double time);
/* A step has ended: record the points of its last right-hand side and their speeds. */
void probe_end(Probe *probe);
/* True if the last step asked for a height. */
bool probe_asked(const Probe *probe);
/* The longest step (s) in which no point passes over a feature of the road; INFINITY if there is none. */
double probe_longest(const Probe *probe);

/* How far (m) a point may move from (x, y) so that at least some steps fall on every feature: half the way to the
 * next part that is not straight, or a share of that part's length. INFINITY on planes, and on roads that are not
 * gic_road.h's. */
double road_clear(const gic_road *road, double x, double y);

#endif
