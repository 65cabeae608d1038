/* SPDX-License-Identifier: MIT
 * The driver of scenes (models/SCENE.md section 5): movements against their finite differences, commands against values
 * worked out by hand, paths against circles, and whole turns of a car that the test integrates itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <math.h>

#include "base/text.h"
#include "host/host.h"
#include "read/read.h"
#include "scene/driver.h"
#include "scene/scene.h"

static const double pi = 3.141592653589793;

enum { RACK, ACCELERATOR = 3, BRAKE, INPUTS }; /* of the rack value, rate, acceleration */

static const char model_text[] =
    "gicgen: 1\n"
    "model: car\n"
    "base: hull\n"
    "inputs: {accelerator: {unit: '1'}, brake: {unit: '1'}}\n"
    "bodies:\n"
    "  hull: {mass: 10, com: [0, 0, 1], inertia: [1, 1, 1]}\n"
    "  rod: {mass: 1, com: [-1, 0, 1], inertia: [1, 1, 1]}\n"
    "joints:\n"
    "  across: {type: prismatic, bodies: [hull, rod], axis: [0, 1, 0]}\n"
    "coordinates:\n"
    "  rack: {type: translation, bodies: [hull, rod], axis: [0, 1, 0], range: [-1, 1], driven: true, initial: 0.01}\n"
    "outputs:\n"
    "  hull: {type: position, body: hull}\n";

static char *write_temporary(Pool *pool, const char *text)
{
    char *path = pool_print(pool, "%s/test-driver-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    return path;
}

static const Scene *scene_of(Pool *pool, const char *driver)
{
    char *model_path = write_temporary(pool, model_text);
    char *scene_path =
        write_temporary(pool, pool_print(pool, "gicscene: 1\nduration: 1\nstep: 0.005\ndriver:\n%s", driver));
    const Scene *scene = scene_read(pool, scene_path, model_read(pool, model_path), NULL, 0);
    unlink(model_path);
    unlink(scene_path);
    return scene;
}

static Driver *driver_of(Pool *pool, const char *text)
{
    return scene_of(pool, text)->driver;
}

static void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

static double command(const Driver *driver, double time, int input)
{
    double value[INPUTS];
    driver_inputs(driver, time, value);
    return value[input];
}

/* ---- movements ---------------------------------------------------------------------------------------------- */

/* The rack through 40 decisions, some of them before the movement before has ended: rate and acceleration are
 * derivatives of the value, neither one of the three nor the jerk jumps at a decision, and in the end the rack rests
 * where it shall. */
static void test_movements(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    Driver *driver = driver_of(pool, "  steering: {path: {points: [[-1000, 0], [1000, 0]]}, input: rack,\n"
                                     "             per_angle: 0.2, wheelbase: 3, adapt: 0}\n");
    /* after the model's initial value, before which nothing is decided */
    assert_near(command(driver, -1, RACK), 0.01, 0);
    /* Movements s^4 (35 - 84 s + 70 s^2 - 20 s^3) of at most 0.1 within 0.1 s that may begin with the largest
     * derivatives of such a one: jerks below 3 * 52.5 * 0.1 / 0.1^3 and fourth derivatives below 3 * 840 * 0.1 / 0.1^4,
     * so that differences over d are off by d times those. */
    const double d = 1e-7, jerk = 15750, fourth = 2.52e6;
    double before[INPUTS], at[INPUTS], after[INPUTS], time = 0;
    for (int k = 0; k < 40; ++k, time = k * 0.02) {
        assert_true(driver_is_due(driver, time));
        driver_inputs(driver, time - d, before);
        driver_inputs(driver, time, at);
        const double jerk_before = (at[RACK + 2] - before[RACK + 2]) / d;
        memcpy(before, at, sizeof before);
        driver_look(driver, time, &(Sight){.position = {k, sin(1.7 * k)}, .velocity = {10}, .yaw = 0.1 * cos(k)});
        assert_false(driver_is_due(driver, time));
        driver_inputs(driver, time, at);
        for (int i = 0; i < 3; ++i)
            assert_near(at[RACK + i], before[RACK + i], 1e-12 * pow(100, i));
        driver_inputs(driver, time + d, after);
        assert_near((after[RACK + 2] - at[RACK + 2]) / d, jerk_before, 2 * fourth * d);
        for (double t = time + 0.001; t < time + (k == 39 ? 0.15 : 0.019); t += 0.003) {
            driver_inputs(driver, t - d, before);
            driver_inputs(driver, t, at);
            driver_inputs(driver, t + d, after);
            assert_near(at[RACK + 1], (after[RACK] - before[RACK]) / (2 * d), 1e-6);
            assert_near(at[RACK + 2], (after[RACK + 1] - before[RACK + 1]) / (2 * d), jerk * d + 1e-4);
            assert_near(after[RACK + 2], before[RACK + 2], 2 * jerk * d);
        }
    }
    driver_inputs(driver, 40, at);
    assert_true(at[RACK] != 0.01 && at[RACK + 1] == 0 && at[RACK + 2] == 0);
    /* from the beginning once more */
    driver_start(driver);
    assert_true(driver_is_due(driver, 0) && command(driver, 0.1, RACK) == 0.01);
    pool_free(pool);
}

/* A movement that ends before the next decision is a place where variable steps stop. */
static void test_kinks(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "  period: 0.5\n  reach: 0.2\n  speed: {target: 10}\n");
    driver_look(scene->driver, 0, &(Sight){.velocity = {8}});
    assert_near(scene_next_kink(scene, 0), 0.2, 1e-15);
    assert_near(scene_next_kink(scene, 0.2), 0.5, 1e-15);
    driver_look(scene->driver, 0.5, &(Sight){.velocity = {8}});
    assert_near(scene_next_kink(scene, 0.5), 0.7, 1e-15);
    scene = scene_of(pool, "  speed: {target: 10}\n");
    driver_look(scene->driver, 0, &(Sight){.velocity = {8}});
    assert_near(scene_next_kink(scene, 0.01), 0.02, 1e-15);
    pool_free(pool);
}

/* Looks are at multiples of the period, which is one of the step, however time is rounded. */
static void test_looks(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    Driver *driver = driver_of(pool, "  period: 0.015\n  speed: {target: 10}\n");
    int looks = 0;
    for (int step = 0; step < 30000; ++step)
        if (driver_is_due(driver, step * 0.005)) {
            assert_int_equal(step % 3, 0);
            driver_look(driver, step * 0.005, &(Sight){.velocity = {10}});
            ++looks;
        }
    assert_int_equal(looks, 10000);
    assert_near(driver_of(pool, "  speed: {target: 10}\n")->period, 0.02, 1e-15);
    pool_free(pool);
}

/* ---- speed -------------------------------------------------------------------------------------------------- */

/* Where the pedals go after a look at a speed. */
static void look_at_speed(Driver *driver, int look, double speed, double pedal[2])
{
    const double yaw = 0.4; /* sideways motion does not count */
    driver_look(driver, look * 0.02,
                &(Sight){.velocity = {speed * cos(yaw) - 3 * sin(yaw), speed * sin(yaw) + 3 * cos(yaw)}, .yaw = yaw});
    for (int i = 0; i < 2; ++i)
        pedal[i] = command(driver, look * 0.02 + 1, ACCELERATOR + i);
}

static void test_speed(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    double pedal[2];
    Driver *driver = driver_of(pool, "  speed: {target: 20, gain: 0.5, integral: 0.2, full: [4, 10]}\n");
    look_at_speed(driver, 0, 18, pedal); /* 0.5 * 2 m/s^2 */
    assert_near(pedal[0], 1.0 / 4, 1e-12);
    assert_true(pedal[1] == 0);
    look_at_speed(driver, 1, 26, pedal); /* -0.5 * 6 + 0.2 * 2 * 0.02 */
    assert_true(pedal[0] == 0);
    assert_near(pedal[1], (3 - 0.008 - 0.2) / 10, 1e-12);
    look_at_speed(driver, 2, 20, pedal); /* 0.2 * 0.02 * (2 - 6), left to rolling resistance */
    assert_true(pedal[0] == 0 && pedal[1] == 0);
    /* a target that rises: 0 to 10 m/s within 4 s has a rate of 1.875 * 10 / 4 in the middle */
    driver =
        driver_of(pool, "  speed: {target: {knots: {times: [0, 4], values: [0, 10]}}, integral: 0, full: [5, 9]}\n");
    look_at_speed(driver, 100, 5, pedal);
    assert_near(pedal[0], 4.6875 / 5, 1e-12);
    pool_free(pool);
}

static void test_integral(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    double pedal[2];
    Driver *driver = driver_of(pool, "  speed: {target: 20, gain: 1, integral: 0.5}\n");
    /* a minute of full accelerator and one of full brake leave nothing */
    for (int k = 0; k < 3000; ++k) {
        look_at_speed(driver, k, 5, pedal);
        assert_true(pedal[0] == 1 && pedal[1] == 0);
    }
    look_at_speed(driver, 3000, 20, pedal);
    assert_true(pedal[0] == 0 && pedal[1] == 0);
    for (int k = 3001; k < 6000; ++k) {
        look_at_speed(driver, k, 40, pedal);
        assert_true(pedal[0] == 0 && pedal[1] == 1);
    }
    look_at_speed(driver, 6000, 20, pedal);
    assert_true(pedal[0] == 0 && pedal[1] == 0);
    /* within its range it grows: 0.5 * 0.3 * 0.02 a look */
    for (int k = 6001; k < 6101; ++k)
        look_at_speed(driver, k, 19.7, pedal);
    assert_near(pedal[0], (0.3 + 99 * 0.003) / 3, 1e-12);
    pool_free(pool);
}

/* A point mass with drag on a slope reaches the speed and keeps it: the integral finds the pedal that this takes. Then
 * it stops and is held. */
static void test_stop_and_hold(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    Driver *driver = driver_of(pool, "  speed: {target: {knots: {times: [60, 70], values: [15, 0]}}, integral: 0.2}\n");
    const double step = 0.005;
    double speed = 0;
    for (int k = 0; k * step < 90; ++k) {
        const double time = k * step;
        if (driver_is_due(driver, time))
            driver_look(driver, time, &(Sight){.velocity = {speed}});
        const double drive = 4 * command(driver, time, ACCELERATOR) - 0.5 - 0.002 * speed * speed;
        const double brake = 6 * command(driver, time, BRAKE);
        /* brakes take speed away, but give none */
        speed += step * drive;
        speed -= copysign(fmin(fabs(speed), step * brake), speed);
        if (time > 59 && time < 60)
            assert_near(speed, 15, 0.001);
    }
    assert_true(fabs(speed) < 1e-9);
    assert_true(command(driver, 90, BRAKE) >= 0.3);
    pool_free(pool);
}

/* ---- paths -------------------------------------------------------------------------------------------------- */

static double length_of(const Path *path)
{
    return path->step * (path->count - 1);
}

static void test_circle(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    for (int side = -1; side <= 1; side += 2) {
        const Path path = driver_of(pool, pool_print(pool,
                                                     "  steering: {path: {circle: {center: [3, -4], radius: %d}},\n"
                                                     "             input: rack, per_angle: 1, wheelbase: 3}\n",
                                                     20 * side))
                              ->path;
        assert_true(path.closed);
        assert_near(length_of(&path), 40 * pi, 1e-9);
        assert_true(path.step <= 0.1);
        for (int i = 0; i < path.count; ++i) {
            const double *p = path.point[i];
            assert_near(hypot(p[0] - 3, p[1] + 4), 20, 1e-12);
            /* to the left is anticlockwise */
            if (i)
                assert_true(side * ((path.point[i - 1][0] - 3) * (p[1] + 4) - (path.point[i - 1][1] + 4) * (p[0] - 3)) >
                            0);
        }
        /* it begins along x */
        assert_near(path.point[0][1], -4 - 20 * side, 1e-12);
        assert_true(path.point[1][0] > path.point[0][0]);
    }
    pool_free(pool);
}

/* Distance of a point of the plane from a path. */
static double distance_from(const Path *path, const double at[2])
{
    double least = INFINITY;
    for (int i = 1; i < path->count; ++i) {
        const double *a = path->point[i - 1], *b = path->point[i], d[2] = {b[0] - a[0], b[1] - a[1]};
        const double share = ((at[0] - a[0]) * d[0] + (at[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        const double s = fmin(fmax(share, 0), 1);
        least = fmin(least, hypot(a[0] + s * d[0] - at[0], a[1] + s * d[1] - at[1]));
    }
    return least;
}

/* `count` points of a circle of radius 20 about the origin. */
static const char *round_points(Pool *pool, int count, const char *separator, const char *begin, const char *end)
{
    Text text = {.pool = pool};
    for (int i = 0; i < count; ++i)
        text_print(&text, "%s%s%.12g,%.12g%s", i ? separator : "", begin, 20 * cos(2 * pi * i / count),
                   20 * sin(2 * pi * i / count), end);
    return text.s;
}

static void test_points(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const char *rest = "input: rack, per_angle: 1, wheelbase: 3";
    Path path = driver_of(pool, pool_print(pool, "  steering: {path: {closed: true, points: [%s]}, %s}\n",
                                           round_points(pool, 24, ",", "[", "]"), rest))
                    ->path;
    /* A cubic spline through points on a circle every 15 degrees, chords of 5.2 m, is off by 5.2^4 / (384 * 20^3); its
     * points are joined by straight lines every 0.1 m, off by 0.1^2 / (8 * 20). */
    for (int i = 0; i < path.count; ++i)
        assert_near(hypot(path.point[i][0], path.point[i][1]), 20, 2.5e-4);
    for (int i = 0; i < 24; ++i)
        assert_true(distance_from(&path, (double[]){20 * cos(pi * i / 12), 20 * sin(pi * i / 12)}) < 1e-4);
    /* round without a corner where it closes */
    const double *a = path.point[path.count - 2], *b = path.point[0], *c = path.point[1];
    assert_near(path.point[path.count - 1][0], b[0], 1e-12);
    assert_near((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]), path.step * path.step * path.step / 20,
                1e-5);
    /* the same from a file */
    char *file = write_temporary(
        pool, pool_print(pool, "y [m],x\n%s\n", round_points(pool, 24, "\n", "", ""))); /* x and y exchanged */
    Path other =
        driver_of(pool, pool_print(pool, "  steering: {path: {closed: true, file: %s}, %s}\n", file, rest))->path;
    unlink(file);
    assert_int_equal(other.count, path.count);
    for (int i = 0; i < path.count; ++i)
        assert_true(fabs(other.point[i][0] - path.point[i][1]) < 1e-9 &&
                    fabs(other.point[i][1] - path.point[i][0]) < 1e-9);
    /* open: from the first to the last point */
    path = driver_of(pool, pool_print(pool, "  steering: {path: {points: [[0, 0], [3, 4]]}, %s}\n", rest))->path;
    assert_false(path.closed);
    assert_near(length_of(&path), 5, 1e-12);
    assert_near(path.point[25][0], 1.5, 1e-12);
    assert_near(path.point[path.count - 1][1], 4, 1e-12);
    pool_free(pool);
}

/* ---- steering ----------------------------------------------------------------------------------------------- */

static void test_aim(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const char *straight = "  steering: {path: {points: [[-10, 1], [100, 1]]}, input: rack, per_angle: -0.25,\n"
                           "             wheelbase: 3, preview: 0.5, shortest: 4%s}\n";
    Driver *driver = driver_of(pool, pool_print(pool, straight, ""));
    /* 6 m ahead of the nearest point, 1 m to the left */
    driver_look(driver, 0, &(Sight){.velocity = {12}, .yaw_rate = 0.3});
    assert_near(command(driver, 1, RACK), -0.25 * atan(3 * 2 * 1 / 37.0), 1e-7);
    /* c - yaw rate / speed has been learned from: 0.5 / s, 20 ms */
    driver_look(driver, 0.02, &(Sight){.velocity = {12}, .yaw_rate = 0.3});
    assert_near(command(driver, 1, RACK), -0.25 * (atan(6 / 37.0) + 3 * 0.5 * 0.02 * (2 / 37.0 - 0.3 / 12)), 1e-7);
    /* the path goes on straight beyond its end */
    driver_start(driver);
    driver_look(driver, 0, &(Sight){.position = {98}, .velocity = {12}});
    assert_near(command(driver, 1, RACK), -0.25 * atan(6 / 37.0), 1e-7);
    /* not nearer than `shortest`, and a vehicle that stands learns nothing; turned by 90 degrees the point lies behind
     */
    driver_start(driver);
    for (int k = 0; k < 100; ++k)
        driver_look(driver, 0.02 * k, &(Sight){.velocity = {0.2}, .yaw_rate = 1});
    assert_near(command(driver, 9, RACK), -0.25 * atan(6 / 17.0), 1e-7);
    driver_start(driver);
    driver_look(driver, 0, &(Sight){.velocity = {0, 0.2}, .yaw = pi / 2});
    assert_near(command(driver, 9, RACK), 0.25 * atan(3 * 2 * 4 / 17.0), 1e-7);
    /* at the limit it learns nothing either: as soon as the path asks for less, less is there */
    driver = driver_of(pool, pool_print(pool, straight, ", limit: 0.02"));
    for (int k = 0; k < 1000; ++k)
        driver_look(driver, 0.02 * k, &(Sight){.velocity = {12}});
    assert_near(command(driver, 99, RACK), -0.02, 1e-15);
    driver_look(driver, 20, &(Sight){.position = {0, 1}, .velocity = {12}});
    assert_near(command(driver, 99, RACK), 0, 1e-7);
    pool_free(pool);
}

/* A car with wheels that roll, but for `turning` times its angle, at 8 m/s, from 3 m beside the path. Returns the
 * largest distance from the path over the last turn of the circle. */
static double drive_round(Driver *driver, double radius, double turning)
{
    const double step = 0.005, wheelbase = 3, speed = 8, end = 60, turn = 2 * pi * fabs(radius) / speed;
    double x = 0, y = 3, yaw = 0.3, rate = 0, worst = 0;
    for (int k = 0; k * step < end; ++k) {
        const double time = k * step;
        if (driver_is_due(driver, time))
            driver_look(driver, time,
                        &(Sight){.position = {x, y},
                                 .velocity = {speed * cos(yaw), speed * sin(yaw)},
                                 .yaw = yaw,
                                 .yaw_rate = rate});
        rate = turning * speed / wheelbase * tan(command(driver, time, RACK) / 0.2);
        yaw += step * rate / 2;
        x += step * speed * cos(yaw);
        y += step * speed * sin(yaw);
        yaw += step * rate / 2;
        if (time > end - turn)
            worst = fmax(worst, fabs(hypot(x, y - radius) - fabs(radius)));
    }
    return worst;
}

/* A car that rolls stays on the circle: within the corners of the polygon that it follows and of its steps, 1 mm. One
 * that turns too little or too much is learned from, as far as 60 s allow: 1 cm. */
static void test_steady_circle(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    for (int side = -1; side <= 1; side += 2) {
        Driver *driver =
            driver_of(pool, pool_print(pool,
                                       "  steering: {path: {circle: {center: [0, %d], radius: %d}}, input: rack,\n"
                                       "             per_angle: 0.2, wheelbase: 3}\n",
                                       25 * side, 25 * side));
        const double turning[] = {1, 0.6, 1.3};
        for (int i = 0; i < 3; ++i) {
            driver_start(driver);
            const double worst = drive_round(driver, 25 * side, turning[i]);
            if (!(worst < (i ? 0.01 : 0.001)))
                fail_msg("%g of its angle, radius %d: %g m beside the path", turning[i], 25 * side, worst);
        }
    }
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_movements),     cmocka_unit_test(test_kinks),    cmocka_unit_test(test_looks),
        cmocka_unit_test(test_speed),         cmocka_unit_test(test_integral), cmocka_unit_test(test_stop_and_hold),
        cmocka_unit_test(test_circle),        cmocka_unit_test(test_points),   cmocka_unit_test(test_aim),
        cmocka_unit_test(test_steady_circle),
    };
    return cmocka_run_group_tests_name("driver", tests, NULL, NULL);
}
