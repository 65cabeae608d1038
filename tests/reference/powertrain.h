/* SPDX-License-Identifier: MIT
 * The powertrain, POWERTRAIN.md: not reduced to the wheels as there, but with the acceleration and the torque of each
 * shaft as an unknown of its own. */
#ifndef REFERENCE_POWERTRAIN_H
#define REFERENCE_POWERTRAIN_H

#include "wheel.h"

/* Its states; gear and the one before. */
typedef struct Line {
    quad speed, age;
    int gear[2];
} Line;

/* Results: rates of its states, and the components of an output `powertrain`. */
enum {
    SPEED_RATE,
    AGE_RATE,
    ENGINE_SPEED,
    ENGINE_TORQUE,
    THROTTLE,
    GEAR,
    RATIO,
    TURBINE_SPEED,
    TURBINE_TORQUE,
    PUMP_TORQUE,
    LINE_RESULTS
};

/* Scales: as those of WheelState. */
typedef struct LineState {
    quad value[LINE_RESULTS], scale[LINE_RESULTS];
} LineState;

/* Names of states (without rates' suffix), and of results as columns. */
extern const char *const line_column[LINE_RESULTS];

/* Whether wheel and transmission are connected by the tree. */
bool line_drives(const Model *model, int wheel);
/* After wheel_evaluate() of all wheels; corrects spin acceleration, drive and reaction of those that it drives. */
void line_evaluate(const Model *model, const Configuration *configuration, const Line *line, WheelState *wheel,
                   LineState *out);

#endif
