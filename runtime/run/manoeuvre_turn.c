/* SPDX-License-Identifier: MIT
 * In a steady turn, with the steering held: the accelerator is released, or the brake is pressed. */
#include "run/manoeuvre.h"

#include <math.h>

static const double begin = 10, rise = 0.1, after = 4; /* s: when pedals move, and how long that takes */
static const double looks[] = {0.5, 1, 2};             /* s after it */
static const double slowest = 2;                       /* m/s, where the run ends */
static const double apart = 0.05;                      /* s between samples of a pedal */

static bool is_over(void *context, const Trial *trial)
{
    const double *row = trial->row[trial->rows - 1];
    (void)context;
    return trial_spins(trial) || (row[TRIAL_TIME] > begin && row[TRIAL_SPEED] < slowest);
}

/* A pedal as it was up to `begin`, and then at a level. */
static const char *pedal(Manoeuvre *m, const Trial *trial, Channel channel, double level)
{
    Text times = {.pool = m->pool}, values = {.pool = m->pool};
    for (int k = 0; k * apart <= begin + apart / 2; ++k) {
        text_print(&times, "%g, ", k * apart);
        text_print(&values, "%.9g, ", trial_at(trial, channel, fmin(k * apart, begin)));
    }
    return pool_print(m->pool, "{samples: {times: [%s%g], values: [%s%.17g], fit: monotone}}", times.s, begin + rise,
                      values.s, level);
}

/* The turn up to there as a driver keeps its speed; then the same pedals once more, and a brake. */
static const Trial *drive(Manoeuvre *m, const Trial *turn, double angle, double brake, const char *name)
{
    TestCar *car = m->car;
    const Model *model = car->model;
    const char *more = pool_print(m->pool, "%s  %s: %s\n  %s: %s\n", manoeuvre_step_profile(m, angle),
                                  model->input[car->accelerator].name, pedal(m, turn, TRIAL_ACCELERATOR, 0),
                                  model->input[car->brake].name, pedal(m, turn, TRIAL_BRAKE, brake));
    return trial_run(car, name, car_scene(car, begin + after, m->value[0], false, more), is_over, NULL);
}

/* What the vehicle does beside the turn that it would go on with: yaw rates over those of its speed on the circle,
 * side slip beyond that of the turn, distance from the circle inwards. */
static void add_results(Manoeuvre *m, const Trial *trial, double sign, const char *section)
{
    Sheet *s = m->result;
    double before[TRIAL_CHANNELS];
    for (Channel c = 0; c < TRIAL_CHANNELS; ++c)
        before[c] = trial_at(trial, c, begin);
    const double speed = before[TRIAL_SPEED] / cos(before[TRIAL_SIDESLIP]), radius = speed / before[TRIAL_YAW_RATE];
    const double course = before[TRIAL_YAW] + before[TRIAL_SIDESLIP];
    const double centre[2] = {before[TRIAL_X] - radius * sin(course), before[TRIAL_Y] + radius * cos(course)};
    const double end = trial->row[trial->rows - 1][TRIAL_TIME];
    const char *name = trial->name;
    sheet_add(s, section, pool_print(m->pool, "%s.speed", name), "Speed in the turn", "m/s", before[TRIAL_SPEED]);
    sheet_add(s, NULL, pool_print(m->pool, "%s.ay", name), "Lateral acceleration in the turn", "m/s^2",
              sign * before[TRIAL_AY]);
    sheet_add_way(s, NULL, pool_print(m->pool, "%s.radius", name), "Radius of the turn", fabs(radius));
    const double one = fmin(begin + 1, end);
    sheet_add(s, NULL, pool_print(m->pool, "%s.deceleration", name), "Mean deceleration in the first second", "m/s^2",
              (before[TRIAL_SPEED] - trial_at(trial, TRIAL_SPEED, one)) / (one - begin));
    for (size_t i = 0; i < sizeof looks / sizeof *looks; ++i) {
        const double at = begin + looks[i];
        if (at > end)
            break;
        const char *when = pool_print(m->pool, "%s.at_%g", name, looks[i]);
        const double slip = trial_at(trial, TRIAL_SIDESLIP, at);
        const double on_circle = trial_at(trial, TRIAL_SPEED, at) / cos(slip) / radius;
        sheet_add(s, NULL, pool_print(m->pool, "%s.yaw_rate_ratio", when),
                  pool_print(m->pool, "Yaw rate over that of the circle after %g s", looks[i]), "1",
                  trial_at(trial, TRIAL_YAW_RATE, at) / on_circle);
        sheet_add(s, NULL, pool_print(m->pool, "%s.sideslip_change", when),
                  pool_print(m->pool, "Side slip beyond that of the turn after %g s", looks[i]), "rad",
                  sign * (slip - before[TRIAL_SIDESLIP]));
        sheet_add_way(s, NULL, pool_print(m->pool, "%s.inwards", when),
                      pool_print(m->pool, "Inside of the circle after %g s", looks[i]),
                      fabs(radius) -
                          hypot(trial_at(trial, TRIAL_X, at) - centre[0], trial_at(trial, TRIAL_Y, at) - centre[1]));
    }
    double most = 0, slip = 0;
    for (int i = 0; i < trial->rows; ++i) {
        const double *row = trial->row[i];
        if (row[TRIAL_TIME] < begin)
            continue;
        most = fmax(most, row[TRIAL_YAW_RATE] * radius * cos(row[TRIAL_SIDESLIP]) / row[TRIAL_SPEED]);
        slip = fmax(slip, fabs(row[TRIAL_SIDESLIP]));
    }
    sheet_add(s, NULL, pool_print(m->pool, "%s.yaw_rate_ratio", name), "Largest yaw rate over that of the circle", "1",
              most);
    sheet_add(s, NULL, pool_print(m->pool, "%s.sideslip", name), "Largest side slip", "rad", slip);
    if (trial->tipped || trial->end || trial_spins(trial))
        sheet_note(s, pool_print(m->pool, "%s: %s", name,
                                 trial->tipped ? "the vehicle tips over"
                                 : trial->end
                                     ? trial->end
                                     : pool_print(m->pool, "the vehicle spins, by %.3g s after it", end - begin)));
}

/* Both sides, with the brake at each of `levels` shares of a pedal. */
static void drive_turns(Manoeuvre *m, double brake, int levels)
{
    static const Channel over[] = {TRIAL_YAW_RATE, TRIAL_AY,   TRIAL_SIDESLIP, TRIAL_SPEED,
                                   TRIAL_AX,       TRIAL_ROLL, TRIAL_LOAD};
    manoeuvre_begin(m);
    const double angle = manoeuvre_steady_angle(m);
    for (int side = 1; side >= -1; side -= 2) {
        const char *word = side > 0 ? "left" : "right";
        const Trial *turn = manoeuvre_step_trial(m, side * angle, word);
        manoeuvre_whole(m, turn, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]));
        for (int k = 1; k <= levels; ++k) {
            const double level = brake * k / levels;
            const char *name = brake > 0 ? pool_print(m->pool, "%s.brake_%.3g", word, level) : word;
            const Trial *trial = drive(m, turn, side * angle, level, name);
            const char *section = pool_print(m->pool, "To the %s%s", word,
                                             brake > 0 ? pool_print(m->pool, ", brake at %.3g", level) : "");
            if (trial->row[trial->rows - 1][TRIAL_TIME] < begin + looks[0])
                car_refuse(m->car, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]),
                           trial->end      ? trial->end
                           : trial->tipped ? "the vehicle tips over in the turn"
                                           : "the vehicle stops within half a second");
            manoeuvre_keep(m, trial);
            add_results(m, trial, side, section);
        }
    }
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}

void manoeuvre_lift_off(Manoeuvre *m)
{
    drive_turns(m, 0, 1);
}

void manoeuvre_turn_braking(Manoeuvre *m)
{
    drive_turns(m, m->value[2], 4);
}
