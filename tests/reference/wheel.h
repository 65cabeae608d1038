/* SPDX-License-Identifier: MIT
 * Wheels on a road: FORMAT.md section 8, TIRES.md. */
#ifndef REFERENCE_WHEEL_H
#define REFERENCE_WHEEL_H

#include "mechanism.h"

enum { FAST_STATES = 4 }; /* spin, slip_x, slip_y, brake */
extern const char *const fast_name[FAST_STATES];
/* Whether a wheel has that state. */
bool wheel_has(const Wheel *wheel, int state);

/* Results of a wheel; of one without tire up to HEIGHT, and FORCE. */
enum {
    FZ,
    RHO,
    RHO_RATE,
    HEIGHT,
    FX,
    FY,
    MX,
    MY,
    MZ,
    KAPPA,
    ALPHA,
    CAMBER,
    SPIN,
    SPIN_RATE,
    DRIVE,
    BRAKE,
    CONTACT,
    CONTACT_Y,
    CONTACT_Z,
    SLIP_X_RATE,
    SLIP_Y_RATE,
    WINDUP_RATE,
    FORCE,
    TORQUE = FORCE + 3,    /* on the carrier, at the wheel centre; world */
    REACTION = TORQUE + 3, /* torque on the body that takes the reaction of the drive; world */
    WHEEL_RESULTS = REACTION + 3
};

/* scale: how much a result would change if each number that it follows from (place, velocity, orientation of the
 * carrier, fast states) changed by its own size, by the slope; with the result itself. So a result that is computed in
 * a precision of u can't be asked to be nearer to `value` than a few u `scale`. */
typedef struct WheelState {
    quad value[WHEEL_RESULTS], scale[WHEEL_RESULTS];
} WheelState;

/* Results by the names that they have as outputs (`NAME_load`, `NAME_tire`, `NAME_contact` of the types `wheel`,
 * `tire`, `contact`) and as rates of fast states, without the wheel's name before them. */
enum { WHEEL_COLUMNS = 23 };
typedef struct WheelColumn {
    const char *name;
    int result;
    bool is_rate;
} WheelColumn;
extern const WheelColumn wheel_column[WHEEL_COLUMNS];
/* Whether a wheel has that column. */
bool wheel_shows(const Wheel *wheel, int column);

void wheel_evaluate(const Model *model, const Configuration *configuration, const Road *road, int wheel,
                    const quad fast[FAST_STATES], WheelState *out);
/* Another torque of the drive than that of the wheel's formula. */
void wheel_drive(const Model *model, const Configuration *configuration, int wheel, quad torque, quad scale,
                 WheelState *out);
/* Add the generalized forces of a wheel: of what x holds as FORCE, TORQUE and REACTION. */
void add_wheel(const Model *model, const Configuration *configuration, int wheel, const quad x[WHEEL_RESULTS],
               quad (*Q)[BODY_COORDINATES]);

#endif
