/* SPDX-License-Identifier: MIT
 * The driver in a run with derivatives. Between looks its commands are polynomials in time, whose coefficients follow
 * linearly from those before the look and from where it wants to go; that and what it sums up follow from what it sees
 * (driver_slope.c). */
#include "run/tangent_private.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <string.h>

void tangent_drive(const TangentRun *run, Movement *movement[DRIVE_MOVEMENTS], int input[DRIVE_MOVEMENTS])
{
    Driver *driver = run->scene->driver;
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m) {
        movement[m] = m < 2 ? &driver->pedal[m] : &driver->wheel;
        input[m] = m == 2 ? driver->steering : driver->accelerator < 0 ? -1 : m ? driver->brake : driver->accelerator;
    }
}

int tangent_drive_orders(const TangentRun *run, int m)
{
    return m == 2 && run->scene->driver->driven ? 3 : 1;
}

void tangent_drive_inputs(const TangentRun *run, int k, double time, double *change)
{
    Movement *present[DRIVE_MOVEMENTS];
    int input[DRIVE_MOVEMENTS];
    tangent_drive(run, present, input);
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m) {
        double out[4];
        if (input[m] < 0)
            continue;
        movement_at(&run->drive[k].movement[m], time, out);
        memcpy(change + input[m], out, (size_t)tangent_drive_orders(run, m) * sizeof *out);
    }
}

/* Movements and sums of one variable go on. dstate: how the state that was seen changes. */
static void turn(const TangentRun *run, double time, DriveSlope *own, const double *dstate, int half,
                 double slope[DRIVE_RESULTS][DRIVE_SEEN + DRIVE_SUMS])
{
    Movement *present[DRIVE_MOVEMENTS];
    int input[DRIVE_MOVEMENTS];
    double result[DRIVE_RESULTS], seen[DRIVE_SEEN + DRIVE_SUMS];
    memcpy(seen, dstate, 7 * sizeof *seen);
    memcpy(seen + 7, dstate + half + 1, 6 * sizeof *seen);
    memcpy(seen + DRIVE_SEEN, own->sum, sizeof own->sum);
    for (int r = 0; r < DRIVE_RESULTS; ++r) {
        result[r] = 0;
        for (int i = 0; i < DRIVE_SEEN + DRIVE_SUMS; ++i)
            result[r] += slope[r][i] * seen[i];
    }
    tangent_drive(run, present, input);
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m)
        if (input[m] >= 0)
            movement_turn(&own->movement[m], time, result[m], present[m]->duration);
    memcpy(own->sum, result + DRIVE_MOVEMENTS, sizeof own->sum);
}

int tangent_drive_look(TangentRun *run)
{
    Driver *driver = run->scene->driver;
    const double time = gic_time(run->both), *both = tangent_array(run, run->descriptor.state_offset);
    if (!driver || !driver_is_due(driver, time))
        return -1;
    const int half = run->code->slow_count / 2, event = run->trail ? trail_events(run->trail) : -1;
    const Driver before = *driver;
    double own[run->states + 1], slope[DRIVE_RESULTS][DRIVE_SEEN + DRIVE_SUMS];
    tangent_take(run, both, 0, own);
    const Sight sight = sight_of(own, half);
    driver_look(driver, time, &sight);
    driver_look_slope(&before, driver, time, own, half, slope);
    for (int k = 0; k < run->carried; ++k) {
        double change[run->states + 1];
        tangent_take(run, both, 1 + k, change);
        turn(run, time, &run->drive[k], change, half, slope);
    }
    const Movement old[DRIVE_MOVEMENTS] = {before.pedal[0], before.pedal[1], before.wheel};
    double kept[(sizeof slope + sizeof old) / sizeof(double)];
    memcpy(kept, slope, sizeof slope);
    memcpy(kept + sizeof slope / sizeof(double), old, sizeof old);
    tangent_note(run, TRAIL_DRIVE, time, own, run->states, kept, (int)(sizeof kept / sizeof *kept));
    return event;
}
