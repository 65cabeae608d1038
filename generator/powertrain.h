/* SPDX-License-Identifier: MIT
 *
 * Arrays between the blocks of a powertrain (models/POWERTRAIN.md) and the code around them. */
#ifndef POWERTRAIN_H
#define POWERTRAIN_H

/* gear: the gears as numbers: which one it is; ratio of it and of the one before; 1 where they engage, 0 in neutral. */
enum { GEAR_NUMBER, GEAR_RATIO, GEAR_ENGAGED = GEAR_RATIO + 2, GEAR_NUMBERS = GEAR_ENGAGED + 2 };

/* watch: what outputs tell, in their order. */
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

/* choice: what a change of gear follows. Behind the speeds at which gears go up stand those at which they go down. */
enum { CHOICE_SELECTOR, CHOICE_TURBINE, CHOICE_UP };

#endif
