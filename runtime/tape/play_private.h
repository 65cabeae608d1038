/* SPDX-License-Identifier: MIT
 *
 * play_dual.c's derivatives of tables and roads, for the way back through tapes. */
#ifndef TAPE_PLAY_PRIVATE_H
#define TAPE_PLAY_PRIVATE_H

#include "tape/record.h"

/* Slope of a table at x; at a point of it, that of the piece towards which x changes where world->near says that this
 * is looked at. */
double tape_table_slope(const TapeWorld *world, const gic_table *table, double x, double dx);
/* How height and slopes of the road, and friction, change when the point moves by dx, dy. False where the road has no
 * finite height. */
bool tape_road_change(const TapeWorld *world, double x, double y, double dx, double dy, const double road[3],
                      double out[3]);
double tape_friction_change(const TapeWorld *world, double x, double y, double dx, double dy);

#endif
