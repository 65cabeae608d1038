/* SPDX-License-Identifier: MIT
 *
 * Arrays between the blocks of a powertrain (models/POWERTRAIN.md) and the code around them. */
#ifndef MODEL_POWERTRAIN_NUMBERS_H
#define MODEL_POWERTRAIN_NUMBERS_H

/* gear[]: number of the gear; ratio of the gear and of the previous one; for each of the two 1 if engaged, 0 in
 * neutral. */
enum { GEAR_NUMBER, GEAR_RATIO, GEAR_ENGAGED = GEAR_RATIO + 2, GEAR_NUMBERS = GEAR_ENGAGED + 2 };

/* watch[]: the components of powertrain outputs, in their order. */
enum {
    WATCH_ENGINE_SPEED,
    WATCH_ENGINE_TORQUE,
    WATCH_THROTTLE,
    WATCH_GEAR,
    WATCH_RATIO,
    WATCH_TURBINE_SPEED,
    WATCH_TURBINE_TORQUE,
    WATCH_PUMP_TORQUE,
    WATCH_NUMBERS
};

/* choice[]: the numbers that decide on a change of gear: selector, turbine speed, then the speeds for shifting up, then
 * those for shifting down. */
enum { CHOICE_SELECTOR, CHOICE_TURBINE, CHOICE_UP };

#endif
