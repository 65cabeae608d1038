/* SPDX-License-Identifier: MIT
 * Names and units of the quantities of models/KC.md: SI in files, degrees and millimetres on pages. */
#include "model/model.h"
#include "run/kc.h"

#include <stddef.h>

#define DEGREES 57.29577951308232

const KcQuantity kc_of_wheel[KC_OF_WHEEL] = {
    [KC_TRAVEL] = {"travel", "Wheel travel", "m", "mm", 1e3, false},
    [KC_CAMBER] = {"camber", "Camber", "rad", "deg", DEGREES, false},
    [KC_TOE] = {"toe", "Toe (in is positive)", "rad", "deg", DEGREES, false},
    [KC_STEER_ANGLE] = {"steer", "Steer angle (left is positive)", "rad", "deg", DEGREES, false},
    [KC_CAMBER_RATE] = {"camber_rate", "Change of camber", "rad/m", "deg/m", DEGREES, false},
    [KC_TOE_RATE] = {"toe_rate", "Change of toe", "rad/m", "deg/m", DEGREES, false},
    [KC_CENTRE_X] = {"centre_x", "Wheel recession (forward is positive)", "m", "mm", 1e3, false},
    [KC_CENTRE_Y] = {"centre_y", "Wheel centre, change of y", "m", "mm", 1e3, false},
    [KC_CONTACT_X] = {"contact_x", "Contact, x", "m", "mm", 1e3, false},
    [KC_CONTACT_Y] = {"contact_y", "Contact, y", "m", "mm", 1e3, false},
    [KC_CONTACT_Z] = {"contact_z", "Contact, z", "m", "mm", 1e3, false},
    [KC_FRONT_ARM] = {"front_arm", "Front-view swing arm, length", "m", "mm", 1e3, false},
    [KC_FRONT_ANGLE] = {"front_angle", "Front-view swing arm, angle", "rad", "deg", DEGREES, false},
    [KC_SIDE_ARM] = {"side_arm", "Side-view swing arm, length", "m", "mm", 1e3, false},
    [KC_SIDE_ANGLE] = {"side_angle", "Side-view swing arm, angle", "rad", "deg", DEGREES, false},
    [KC_BRAKE_ANGLE] = {"brake_angle", "Support angle of braking", "rad", "deg", DEGREES, false},
    [KC_DRIVE_ANGLE] = {"drive_angle", "Support angle of driving", "rad", "deg", DEGREES, false},
    [KC_FORCE] = {"force", "Force of springs at the contact", "N", "N", 1, false},
    [KC_RATE] = {"wheel_rate", "Wheel rate", "N/m", "N/mm", 1e-3, false},
    [KC_INCLINATION] = {"kingpin_inclination", "Kingpin inclination", "rad", "deg", DEGREES, true},
    [KC_CASTER] = {"caster", "Caster", "rad", "deg", DEGREES, true},
    [KC_SCRUB] = {"scrub_radius", "Scrub radius", "m", "mm", 1e3, true},
    [KC_TRAIL] = {"caster_trail", "Caster (mechanical) trail", "m", "mm", 1e3, true},
    [KC_OFFSET] = {"kingpin_offset", "Kingpin offset at the wheel centre", "m", "mm", 1e3, true},
    [KC_OFFSET_X] = {"caster_offset", "Caster offset at the wheel centre", "m", "mm", 1e3, true},
};

const KcQuantity kc_of_axle[KC_OF_AXLE] = {
    [KC_TRACK] = {"track", "Track", "m", "mm", 1e3, false},
    [KC_TRACK_RATE] = {"track_rate", "Change of track", "1", "1", 1, false},
    [KC_CENTRE_HEIGHT] = {"roll_centre_height", "Roll centre (velocity pole), height", "m", "mm", 1e3, false},
    [KC_CENTRE_SIDE] = {"roll_centre_y", "Roll centre (velocity pole), y", "m", "mm", 1e3, false},
    [KC_FORCE_HEIGHT] = {"roll_centre_force", "Roll centre by forces, height", "m", "mm", 1e3, false},
    [KC_ROLL_RATE] = {"roll_rate", "Roll rate", "N m/rad", "N m/deg", 1 / DEGREES, false},
    [KC_ANTI_BRAKE] = {"anti_brake", "Anti-dive (front), anti-lift (rear) in braking", "1", "%", 100, false},
    [KC_ANTI_DRIVE] = {"anti_drive", "Anti-lift (front), anti-squat (rear) in driving", "1", "%", 100, false},
    [KC_MEAN_STEER] = {"mean_steer", "Mean steer angle", "rad", "deg", DEGREES, true},
    [KC_RATIO] = {"steering_ratio", "Steering ratio", "1", "1", 1, true},
    [KC_ACKERMANN_ERROR] = {"ackermann_error", "Ackermann error", "rad", "deg", DEGREES, true},
    [KC_ACKERMANN] = {"ackermann", "Ackermann percentage", "1", "%", 100, true},
    [KC_RADIUS] = {"turning_radius", "Turning radius, outer contact", "m", "m", 1, true},
};

const char *kc_unit(const Kc *kc, const KcAxle *axle, int of_axle)
{
    if (of_axle == KC_RATIO && axle->steer >= 0)
        return kc->model->coordinate[axle->steer].type == COORDINATE_ANGLE ? "1" : "m/rad";
    return kc_of_axle[of_axle].unit;
}
