/* SPDX-License-Identifier: MIT
 * Steady cornering: at constant speed with steering that grows slowly, and on a circle with a speed that grows slowly.
 */
#include "run/manoeuvre.h"

#include <math.h>
#include <string.h>

static const double gravity = 9.80665, by_default = 2; /* m/s^2; the driver on a circle is found for this at most */
static const double begin = 5;                         /* s straight ahead, or into the circle */
static const double learns = 0.5;                      /* 1/s, how fast the driver on the circle does */
static const double shortest = 3, hold = 12, look = 3; /* s, on the circle: from level to level at least, at each; look:
                                                          its end */
static const double well_reached = 0.98;               /* share of `high` up to which gradients are taken */
static const double slowest = 0.95;                    /* share of the speed below which it is not kept */
/* Of the largest lateral acceleration, below which the limit is passed: with steering that grows, and on a circle. */
static const double past_peak[] = {0.98, 0.9};

/* A run to the limit. */
typedef struct Limit {
    double sign, speed, radius; /* radius 0: at constant speed */
    double most;                /* lateral acceleration so far */
    const TestCar *car;
    const char *why; /* the run ended */
} Limit;

static bool is_at_limit(void *context, const Trial *trial)
{
    Limit *limit = context;
    const double *row = trial->row[trial->rows - 1], now = row[TRIAL_TIME];
    if (now < begin + (limit->radius > 0 ? look : 0))
        return false;
    /* On a circle that which belongs to the mean speed of some seconds: a pedal that moves makes the yaw rate dip, a
     * gear that changes the speed. */
    const double speed = limit->radius > 0 ? trial_mean(trial, TRIAL_SPEED, now - look, now) : row[TRIAL_SPEED];
    const double ay = limit->radius > 0 ? speed * speed / limit->radius : limit->sign * row[TRIAL_AY];
    limit->most = fmax(limit->most, ay);
    if (limit->radius == 0 && row[TRIAL_SPEED] < slowest * limit->speed)
        limit->why = "the speed is not kept";
    else if (limit->radius > 0 &&
             fabs(hypot(row[TRIAL_X], row[TRIAL_Y] - limit->sign * limit->radius) - limit->radius) > 1)
        limit->why = "the circle is left by more than 1 m";
    else if (manoeuvre_side_lifts(limit->car, trial, trial->rows - 1))
        limit->why = "the wheels of one side are without load";
    else if (ay < past_peak[limit->radius > 0] * limit->most && limit->most > 1)
        limit->why = "the lateral acceleration no longer grows";
    return limit->why;
}

/* Points of a curve over the lateral acceleration that gradients are taken from. */
typedef struct Points {
    int count;
    double (*point)[TRIAL_CHANNELS];
} Points;

/* All rows within [low, high], once. */
static Points rows_between(const Manoeuvre *m, const Trial *trial, double sign)
{
    const double low = m->value[1], high = m->value[2];
    Points points = {0, pool_alloc(m->pool, (size_t)trial->rows * sizeof *trial->row)};
    for (int i = 0; i < trial->rows; ++i) {
        const double ay = sign * trial->row[i][TRIAL_AY];
        if (trial->row[i][TRIAL_TIME] < begin || ay < low)
            continue;
        if (ay > high)
            break;
        memcpy(points.point[points.count++], trial->row[i], sizeof *trial->row);
    }
    return points;
}

/* What a slope is taken of, beside channels as they are. */
typedef enum Part {
    WHOLE,
    BEYOND_NO_SLIP, /* the steer angle beyond that of a vehicle without slip, L yaw rate / speed */
    ON_THE_CIRCLE   /* the steer angle without that of the curvature that is driven beyond the circle's */
} Part;

static double slope(const Manoeuvre *m, const Points *points, const Limit *limit, Channel channel, Part part)
{
    const double sign = limit->sign, wheelbase = m->car->sheet.wheelbase;
    double *x = pool_alloc(m->pool, (size_t)(points->count + 1) * sizeof *x);
    double *y = pool_alloc(m->pool, (size_t)(points->count + 1) * sizeof *y);
    for (int i = 0; i < points->count; ++i) {
        const double *at = points->point[i];
        x[i] = sign * at[TRIAL_AY];
        y[i] = sign * at[channel];
        if (part != WHOLE)
            y[i] -= wheelbase * sign * at[TRIAL_YAW_RATE] / at[TRIAL_SPEED];
        if (part == ON_THE_CIRCLE) /* the path's speed is that along the vehicle over cos(side slip) */
            y[i] += wheelbase / (limit->radius * cos(at[TRIAL_SIDESLIP]));
    }
    return fit_slope(points->count, x, y);
}

static void add_results(Manoeuvre *m, const Trial *trial, const Points *points, const Limit *limit)
{
    Sheet *s = m->result;
    const char *side = trial->name, *section = limit->sign > 0 ? "To the left" : "To the right";
    const double understeer = slope(m, points, limit, TRIAL_ANGLE, BEYOND_NO_SLIP);
    const double wheelbase = m->car->sheet.wheelbase;
    const int peak = trial_peak(trial, TRIAL_AY, begin, INFINITY, limit->sign);
    const double *at = trial->row[peak];
    if (isnan(understeer)) {
        sheet_note(s, pool_print(m->pool, "gradients %s: there are not two lateral accelerations from %g to %g m/s^2",
                                 side, m->value[1], m->value[2]));
    } else {
        sheet_add(s, section, pool_print(m->pool, "%s.understeer", side), "Understeer gradient", "rad s^2/m",
                  understeer);
        sheet_add(s, NULL, pool_print(m->pool, "%s.steer_gradient", side), "Steer angle gradient", "rad s^2/m",
                  slope(m, points, limit, TRIAL_ANGLE, limit->radius > 0 ? ON_THE_CIRCLE : WHOLE));
        sheet_add(s, NULL, pool_print(m->pool, "%s.roll_gradient", side), "Roll gradient", "rad s^2/m",
                  slope(m, points, limit, TRIAL_ROLL, WHOLE));
        sheet_add(s, NULL, pool_print(m->pool, "%s.sideslip_gradient", side), "Side-slip gradient", "rad s^2/m",
                  slope(m, points, limit, TRIAL_SIDESLIP, WHOLE));
        section = NULL;
        if (understeer > 0)
            sheet_add(s, NULL, pool_print(m->pool, "%s.characteristic_speed", side), "Characteristic speed", "m/s",
                      sqrt(wheelbase / understeer));
        else if (understeer < 0)
            sheet_add(s, NULL, pool_print(m->pool, "%s.critical_speed", side), "Critical speed", "m/s",
                      sqrt(-wheelbase / understeer));
    }
    const double reached = points->count ? limit->sign * points->point[points->count - 1][TRIAL_AY] : 0;
    if (!isnan(understeer) && reached < well_reached * m->value[2])
        sheet_note(s, pool_print(m->pool, "gradients %s are of lateral accelerations up to %.3g m/s^2, not to high=%g",
                                 side, reached, m->value[2]));
    sheet_add(s, section, pool_print(m->pool, "%s.limit", side), "Largest lateral acceleration", "m/s^2",
              limit->sign * at[TRIAL_AY]);
    sheet_add(s, NULL, pool_print(m->pool, "%s.limit_steer", side), "Steer angle there", "rad",
              limit->sign * at[TRIAL_ANGLE]);
    sheet_add(s, NULL, pool_print(m->pool, "%s.limit_sideslip", side), "Side slip there", "rad",
              limit->sign * at[TRIAL_SIDESLIP]);
    sheet_add(s, NULL, pool_print(m->pool, "%s.limit_roll", side), "Roll angle there", "rad",
              limit->sign * at[TRIAL_ROLL]);
    sheet_note(s, pool_print(m->pool, "more than %.2f m/s^2 (%.2f g) %s: %s", limit->sign * at[TRIAL_AY],
                             limit->sign * at[TRIAL_AY] / gravity, side,
                             trial->tipped ? "the vehicle tips over"
                             : trial->end  ? trial->end
                             : limit->why  ? limit->why
                                           : "the run is over"));
}

static void draw(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_SIDESLIP, TRIAL_ROLL, TRIAL_YAW_RATE, TRIAL_LOAD};
    for (size_t i = 0; i < sizeof over / sizeof *over; ++i)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_AY, over[i]};
}

void manoeuvre_steady_speed(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double speed = m->value[0], growth = m->value[3], most = 40; /* m/s^2 by the linear model, where it ends */
    car_need_steering(car);
    car_need_drive(car);
    car_need_brake(car);
    car_settle(car, speed);
    const double by_ay = manoeuvre_angle_by_acceleration(m);
    for (int side = 1; side >= -1; side -= 2) {
        const double end = 0.999 * car->range[side > 0], to = side * fmin(most * by_ay, fabs(end));
        const double duration = fabs(to) / by_ay / growth + 1;
        Limit limit = {.sign = side, .speed = speed, .car = car};
        const char *more =
            pool_print(m->pool, "inputs:\n  %s: {ramp: {to: %.17g, duration: %.9g, start: %g, blend: 1}}\n",
                       car->model->input[car->steering].name, car_steering(car, to), duration, begin);
        const Trial *trial = trial_run(car, side > 0 ? "left" : "right",
                                       car_scene(car, begin + duration, speed, true, more), is_at_limit, &limit);
        if (!limit.why && !trial->tipped && !trial->end)
            limit.why =
                fabs(to) < most * by_ay
                    ? "the steering is at its end"
                    : pool_print(
                          m->pool,
                          "there the steering is what the linear model turns into %g m/s^2, which is all that is tried",
                          most);
        manoeuvre_keep(m, trial);
        const Points points = rows_between(m, trial, side);
        add_results(m, trial, &points, &limit);
    }
    draw(m);
}

/* Speeds over time on a circle: levels of lateral acceleration that are held, then growth to the limit. */
enum { LEVELS = 5 };

static double level(const Manoeuvre *m, int k)
{
    return m->value[1] + (m->value[2] - m->value[1]) * k / (LEVELS - 1);
}

/* s from level to level, whose steepest slope in time, 3/2 of the mean one, is at most `growth`. */
static double rise_of(const Manoeuvre *m)
{
    return fmax(shortest, 1.5 * (level(m, 1) - level(m, 0)) / m->value[3]);
}

static double level_end(const Manoeuvre *m, int k)
{
    return begin + (k + 1) * (rise_of(m) + hold);
}

static const char *speeds(const Manoeuvre *m, double radius, double most, double *duration)
{
    const double spacing = 0.5, high = m->value[2], growth = m->value[3], rise = rise_of(m);
    Text times = {.pool = m->pool}, values = {.pool = m->pool};
    *duration = level_end(m, LEVELS - 1) + rise / 2 + (most - high) / growth;
    for (double t = 0; t <= *duration + spacing; t += spacing) {
        const int k = (int)fmin(fmax(floor((t - begin) / (rise + hold)), 0), LEVELS - 1);
        const double share = fmin(fmax((t - begin - k * (rise + hold)) / rise, 0), 1);
        const double before = level(m, k > 0 ? k - 1 : 0);
        double ay = before + (level(m, k) - before) * share * share * (3 - 2 * share);
        const double after = fmax(0, t - level_end(m, LEVELS - 1)), eased = fmin(after, rise);
        ay += growth * (eased * eased / (2 * rise) + after - eased);
        text_print(&times, "%s%g", t > 0 ? ", " : "", t);
        text_print(&values, "%s%.12g", t > 0 ? ", " : "", sqrt(ay * radius));
    }
    return pool_print(m->pool, "{samples: {times: [%s], values: [%s], fit: monotone}}", times.s, values.s);
}

/* Means at the ends of the levels that were reached. */
static Points levels_of(const Manoeuvre *m, const Trial *trial)
{
    Points points = {0, pool_alloc(m->pool, LEVELS * sizeof *trial->row)};
    for (int k = 0; k < LEVELS && trial->row[trial->rows - 1][TRIAL_TIME] >= level_end(m, k); ++k) {
        for (Channel c = 0; c < TRIAL_CHANNELS; ++c)
            points.point[points.count][c] = trial_mean(trial, c, level_end(m, k) - look, level_end(m, k));
        ++points.count;
    }
    return points;
}

void manoeuvre_steady_radius(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double radius = m->value[0], most = 15; /* m/s^2 */
    double duration;
    const char *target = speeds(m, radius, most, &duration);
    const double start = sqrt(level(m, 0) * radius);
    car_need_steering(car);
    car_need_drive(car);
    car_need_brake(car);
    const double least = car->sheet.wheelbase / fmin(-car->range[0], car->range[1]);
    if (radius < least)
        car_refuse(car, pool_print(m->pool, "radius=%.3g", ceil(1.2 * least)),
                   "the steering does not reach that circle");
    car_settle(car, start);
    const PathDriver driver = manoeuvre_driver(m, sqrt(fmin(m->value[2], by_default) * radius), learns);
    for (int side = 1; side >= -1; side -= 2) {
        Limit limit = {.sign = side, .radius = radius, .car = car};
        const char *more = manoeuvre_driver_text(
            m, &driver, car_pedals(car, target),
            pool_print(m->pool, "{circle: {center: [0, %.17g], radius: %.17g}}", side * radius, side * radius));
        const Trial *trial = trial_run(car, side > 0 ? "left" : "right", car_scene(car, duration, start, false, more),
                                       is_at_limit, &limit);
        const double end = trial->row[trial->rows - 1][TRIAL_TIME],
                     last = trial_mean(trial, TRIAL_SPEED, end - look, end);
        if (!limit.why && last * last / radius < past_peak[true] * most)
            limit.why = "the drive does not reach higher speeds in time";
        const Points points = levels_of(m, trial);
        manoeuvre_keep(m, trial);
        add_results(m, trial, &points, &limit);
    }
    manoeuvre_driver_rows(m, &driver, "");
    draw(m);
}
