/* SPDX-License-Identifier: MIT
 * In a steady turn, with the steering held or by a driver who keeps the circle: the accelerator is released, or the
 * brake is pressed. */
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

/* A turn: how it is steered, as text of a scene's `inputs` or `driver`; with a driver the centre of his circle. */
typedef struct Turn {
    const Trial *trial; /* up to `begin`, at a speed that a driver keeps */
    const char *steering;
    bool driven;
    double centre[2];
} Turn;

/* Once more with the pedals as they were, and a brake. */
static const Trial *drive(Manoeuvre *m, const Turn *turn, double brake, const char *name)
{
    TestCar *car = m->car;
    const Model *model = car->model;
    const char *more = pool_print(m->pool, "%s%s  %s: %s\n  %s: %s\n", turn->steering, turn->driven ? "inputs:\n" : "",
                                  model->input[car->accelerator].name, pedal(m, turn->trial, TRIAL_ACCELERATOR, 0),
                                  model->input[car->brake].name, pedal(m, turn->trial, TRIAL_BRAKE, brake));
    return trial_run(car, name, car_scene(car, begin + after, m->value[0], false, more), is_over, NULL);
}

/* Ways of the driver's path: straight ahead, into the circle as by a clothoid, and on. */
static const double straight = 4, into = 2;           /* s */
static const double beyond = 10, points_apart = 0.05; /* s */
static const double learns = 0.5, near_circle = 0.5;  /* 1/s; m from it when pedals move */

/* The path as text; *turn: its centre. radius: negative to the right. */
static const char *path_into(Manoeuvre *m, double radius, Turn *turn)
{
    enum { FINE = 50 };
    const double speed = m->value[0], ds = speed * points_apart / FINE, most = begin + after + beyond;
    double p[2] = {0, 0}, heading = 0;
    Text text = {.pool = m->pool};
    text_print(&text, "{points: [[%.9g, 0]", -speed);
    for (int k = 0; k * points_apart < most; ++k) {
        text_print(&text, ", [%.12g, %.12g]", p[0], p[1]);
        for (int i = 0; i < FINE; ++i) { /* midpoints */
            const double time = (k + (i + 0.5) / FINE) * points_apart;
            const double turning = ds * fmin(fmax((time - straight) / into, 0), 1) / radius;
            p[0] += ds * cos(heading + turning / 2);
            p[1] += ds * sin(heading + turning / 2);
            heading += turning;
        }
    }
    turn->centre[0] = p[0] - radius * sin(heading);
    turn->centre[1] = p[1] + radius * cos(heading);
    text_print(&text, "]}");
    return text.s;
}

/* With the steering held at an angle that ends in the lateral acceleration; or a driver on a circle of that radius. */
static Turn turn_of(Manoeuvre *m, double angle, const PathDriver *driver, const char *name)
{
    TestCar *car = m->car;
    Turn turn = {.driven = driver, .steering = manoeuvre_step_profile(m, angle)};
    const char *less = pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]);
    turn.trial = manoeuvre_step_trial(m, angle, name);
    manoeuvre_whole(m, turn.trial, less);
    if (!driver)
        return turn;
    const double *last = turn.trial->row[turn.trial->rows - 1];
    const double radius = last[TRIAL_SPEED] / cos(last[TRIAL_SIDESLIP]) / last[TRIAL_YAW_RATE];
    const char *path = path_into(m, radius, &turn);
    const char *pedals = car_pedals(car, pool_print(m->pool, "%.17g", m->value[0]));
    turn.steering = manoeuvre_driver_text(m, driver, "", path);
    turn.trial =
        trial_run(car, name, car_scene(car, begin, m->value[0], false, manoeuvre_driver_text(m, driver, pedals, path)),
                  NULL, NULL);
    manoeuvre_whole(m, turn.trial, less);
    last = turn.trial->row[turn.trial->rows - 1];
    const double off = hypot(last[TRIAL_X] - turn.centre[0], last[TRIAL_Y] - turn.centre[1]) - fabs(radius);
    if (!(fabs(off) < near_circle))
        car_refuse(car, less,
                   pool_print(m->pool, "%s: the driver does not keep the circle of %.3g m radius, but is %.2g m %s it",
                              name, fabs(radius), fabs(off), off > 0 ? "outside" : "inside"));
    return turn;
}

/* What the driver does to keep the circle, and how far from it the vehicle gets. */
static void add_steering(Manoeuvre *m, const Trial *trial, double sign, double angle, const double centre[2], double on)
{
    Sheet *s = m->result;
    const double end = trial->row[trial->rows - 1][TRIAL_TIME];
    double off = 0, into_turn = 0, out_of_turn = 0;
    for (size_t i = 0; i < sizeof looks / sizeof *looks && begin + looks[i] <= end; ++i)
        sheet_add(s, NULL, pool_print(m->pool, "%s.at_%g.steer_change", trial->name, looks[i]),
                  pool_print(m->pool, "Steer angle beyond that of the turn after %g s", looks[i]), "rad",
                  sign * (trial_at(trial, TRIAL_ANGLE, begin + looks[i]) - angle));
    for (int i = 0; i < trial->rows; ++i) {
        const double *row = trial->row[i], change = sign * (row[TRIAL_ANGLE] - angle);
        if (row[TRIAL_TIME] < begin)
            continue;
        off = fmax(off, fabs(hypot(row[TRIAL_X] - centre[0], row[TRIAL_Y] - centre[1]) - on));
        into_turn = fmax(into_turn, change);
        out_of_turn = fmax(out_of_turn, -change);
    }
    sheet_add(s, NULL, pool_print(m->pool, "%s.steer_in", trial->name), "He steers into the turn, at most", "rad",
              into_turn);
    sheet_add(s, NULL, pool_print(m->pool, "%s.steer_out", trial->name), "And out of it", "rad", out_of_turn);
    sheet_add_way(s, NULL, pool_print(m->pool, "%s.off", trial->name), "Off the circle at most", off);
}

/* What the vehicle does beside the turn that it would go on with: yaw rates over those of its speed on the circle,
 * side slip beyond that of the turn, distance from the circle inwards. */
static void add_results(Manoeuvre *m, const Turn *turn, const Trial *trial, double sign, const char *section)
{
    Sheet *s = m->result;
    double before[TRIAL_CHANNELS];
    for (Channel c = 0; c < TRIAL_CHANNELS; ++c)
        before[c] = trial_at(trial, c, begin);
    const double speed = before[TRIAL_SPEED] / cos(before[TRIAL_SIDESLIP]), radius = speed / before[TRIAL_YAW_RATE];
    const double course = before[TRIAL_YAW] + before[TRIAL_SIDESLIP];
    double centre[2] = {before[TRIAL_X] - radius * sin(course), before[TRIAL_Y] + radius * cos(course)};
    for (int i = 0; i < 2 && turn->driven; ++i)
        centre[i] = turn->centre[i];
    const double on = turn->driven ? hypot(before[TRIAL_X] - centre[0], before[TRIAL_Y] - centre[1]) : fabs(radius);
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
                      on - hypot(trial_at(trial, TRIAL_X, at) - centre[0], trial_at(trial, TRIAL_Y, at) - centre[1]));
    }
    if (turn->driven)
        add_steering(m, trial, sign, before[TRIAL_ANGLE], centre, on);
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

/* Both sides, with the brake at each of `levels` shares of a pedal. driven: a driver keeps the circle. */
static void drive_turns(Manoeuvre *m, double brake, int levels, bool driven)
{
    static const Channel over[] = {TRIAL_YAW_RATE, TRIAL_AY,   TRIAL_SIDESLIP, TRIAL_SPEED,
                                   TRIAL_AX,       TRIAL_ROLL, TRIAL_LOAD};
    manoeuvre_begin(m);
    const double angle = manoeuvre_steady_angle(m);
    PathDriver driver = {0};
    if (driven) { /* who was found for this speed, and is steady at lower ones where he looks as far ahead in m */
        driver = manoeuvre_driver(m, m->value[0], learns);
        driver.nearest = driver.preview * driver.speed;
    }
    for (int side = 1; side >= -1; side -= 2) {
        const char *word = side > 0 ? "left" : "right";
        const Turn turn = turn_of(m, side * angle, driven ? &driver : NULL, word);
        for (int k = 1; k <= levels; ++k) {
            const double level = brake * k / levels;
            const char *name = brake > 0 ? pool_print(m->pool, "%s.brake_%.3g", word, level) : word;
            const Trial *trial = drive(m, &turn, level, name);
            const char *section = pool_print(m->pool, "To the %s%s", word,
                                             brake > 0 ? pool_print(m->pool, ", brake at %.3g", level) : "");
            if (trial->row[trial->rows - 1][TRIAL_TIME] < begin + looks[0])
                car_refuse(m->car, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]),
                           trial->end      ? trial->end
                           : trial->tipped ? "the vehicle tips over in the turn"
                                           : "the vehicle stops within half a second");
            manoeuvre_keep(m, trial);
            add_results(m, &turn, trial, side, section);
        }
    }
    if (driven)
        manoeuvre_driver_rows(m, &driver, "");
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
    if (driven)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_TIME, TRIAL_ANGLE};
}

void manoeuvre_lift_off(Manoeuvre *m)
{
    drive_turns(m, 0, 1, m->value[2] > 0.5);
}

void manoeuvre_turn_braking(Manoeuvre *m)
{
    drive_turns(m, m->value[2], 4, m->value[3] > 0.5);
}
