/* SPDX-License-Identifier: MIT
 * Profiles of inputs (models/SCENE.md section 4): against closed forms written out here, rates and accelerations
 * against differences, samples against the functions that they were taken from. */
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
#include "scene/profile.h"
#include "scene/scene.h"

static const double pi = 3.14159265358979323846;

static const char model_text[] =
    "gicgen: 1\n"
    "model: cart\n"
    "base: hull\n"
    "bodies:\n"
    "  hull: {mass: 10, com: [0, 0, 1], inertia: [1, 1, 1]}\n"
    "  rod: {mass: 1, com: [-1, 0, 1], inertia: [1, 1, 1]}\n"
    "joints:\n"
    "  across: {type: prismatic, bodies: [hull, rod], axis: [0, 1, 0]}\n"
    "coordinates:\n"
    "  rack: {type: translation, bodies: [hull, rod], axis: [0, 1, 0], driven: true, design: 0.01, range: [-99, 99]}\n"
    "parameters:\n"
    "  high: {value: 0.25}\n"
    "inputs:\n"
    "  pedal: {unit: \"1\", default: 0.5}\n"
    "  speed: {unit: rad/s}\n"
    "tables:\n"
    "  bend: {x: [0, 1, 3], y: [0, 2, 3], interpolation: cubic}\n";

static char *write_temporary(Pool *pool, const char *text)
{
    char *path = pool_print(pool, "%s/test-profiles-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    return path;
}

static const Scene *scene_of(Pool *pool, const char *text)
{
    char *model_path = write_temporary(pool, model_text);
    char *scene_path = write_temporary(pool, pool_print(pool, "gicscene: 1\nduration: 4\nstep: 0.01\n%s\n", text));
    const Scene *scene = scene_read(pool, scene_path, model_read(pool, model_path), NULL, 0);
    unlink(model_path);
    unlink(scene_path);
    return scene;
}

static const Profile *rack_of(Pool *pool, const char *form)
{
    const Scene *scene = scene_of(pool, pool_print(pool, "inputs: {rack: %s}", form));
    assert_true(scene->profiles == 1 && scene->profile[0].driven);
    return scene->profile;
}

static void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", a, b, tolerance);
}

static double value_at(const Profile *profile, double time)
{
    double out[3];
    profile_at(profile, time, out);
    return out[0];
}

/* Rate and acceleration are the derivatives of the value, and none of the three jumps. */
static void check_derivatives(const Profile *profile, double end, double jerk)
{
    const double d = 1e-5;
    double out[3], before[3], after[3];
    for (double t = -0.1; t < end; t += 0.00317) {
        profile_at(profile, t, out);
        profile_at(profile, t - d, before);
        profile_at(profile, t + d, after);
        assert_near(out[1], (after[0] - before[0]) / (2 * d), jerk * d * d + 1e-9);
        assert_near(out[2], (after[1] - before[1]) / (2 * d), jerk * d);
        assert_near(after[2], before[2], 2 * jerk * d);
    }
}

static void test_moves(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Profile *step = rack_of(pool, "{step: {to: 0.05, start: 1, rise: 0.5}}");
    check_derivatives(step, 2, 60 * 0.04 / pow(0.5, 3));
    assert_true(value_at(step, 1) == 0.01 && value_at(step, 1.5) == 0.05); /* from the design value */
    assert_near(value_at(step, 1.25), 0.03, 1e-16);

    /* the rate rises over 0.2 s by 3 s^2 - 2 s^3, so that the ramp covers as much as one of 0.8 s at its full rate */
    const Profile *ramp = rack_of(pool, "{ramp: {from: 0.01, to: 0.09, start: 1, duration: 1, blend: 0.2}}");
    check_derivatives(ramp, 3, 6 * 0.1 / 0.04);
    double out[3];
    for (double t = 1.2; t < 1.8; t += 0.05) {
        profile_at(ramp, t, out);
        assert_near(out[0], 0.01 + 0.1 * (t - 1.1), 1e-15);
        assert_near(out[1], 0.1, 1e-14);
        assert_near(out[2], 0, 1e-13);
    }
    for (double s = 0; s <= 1; s += 0.125) {
        profile_at(ramp, 1 + 0.2 * s, out);
        assert_near(out[0], 0.01 + 0.1 * 0.2 * (s * s * s - s * s * s * s / 2), 1e-15);
        assert_near(out[1], 0.1 * (3 * s * s - 2 * s * s * s), 1e-14);
    }
    assert_true(value_at(ramp, 9) == 0.09 && value_at(ramp, 0) == 0.01);
    const Profile *bent = rack_of(pool, "{ramp: {from: 0, to: 1, start: 0, duration: 2, blend: 1}}");
    check_derivatives(bent, 3, 6);
    profile_at(bent, 1, out);
    assert_near(out[0], 0.5, 1e-15);
    assert_near(out[1], 1, 1e-15);

    const Profile *pulse =
        rack_of(pool, "{pulse: {from: 0, to: 1, start: 0.5, rise: 0.1, duration: 0.4, period: 1, count: 3}}");
    check_derivatives(pulse, 4, 60 / pow(0.1, 3));
    for (double t = 0; t < 4; t += 0.01) {
        const double phase = t < 0.5 ? 0.99 : fmod(t - 0.5, 1), now = value_at(pulse, t);
        if (t > 3.5 || phase > 0.4001)
            assert_near(now, 0, 1e-11);
        else if (phase > 0.1001 && phase < 0.2999)
            assert_near(now, 1, 1e-11);
    }
    /* it falls once it has risen, and rises once it has fallen: times that are equal but for rounding, too */
    const char *const touching[] = {"{pulse: {from: 0, to: 2, rise: 0.5, duration: 1, period: 1, count: 3}}",
                                    "{pulse: {from: 0, to: 2, rise: 0.15, duration: 0.3, period: 0.3, count: 10}}"};
    for (int i = 0; i < 2; ++i) {
        const Profile *wave = rack_of(pool, touching[i]);
        const double rise = i == 0 ? 0.5 : 0.15;
        check_derivatives(wave, 4, 2 * 60 / pow(rise, 3));
        for (double t = 0; t < 4; t += 0.01) {
            const double phase = fmod(t, 2 * rise) / rise, u = phase < 1 ? phase : 2 - phase;
            assert_near(value_at(wave, t), t > 3 ? 0 : 2 * u * u * u * (10 - 15 * u + 6 * u * u), 1e-11);
        }
    }
    pool_free(pool);
}

static void test_chirps(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Profile *linear =
        rack_of(pool, "{chirp: {amplitude: 0.02, from: 1, to: 9, duration: 3, start: 0.5, offset: 0}}");
    check_derivatives(linear, 4, 0.02 * 4 * pow(2 * pi * 9, 3));
    const Profile *logarithmic =
        rack_of(pool, "{chirp: {amplitude: 0.02, from: 1, to: 8, duration: 3, growth: logarithmic, offset: 0.1}}");
    check_derivatives(logarithmic, 4, 0.02 * 4 * pow(2 * pi * 8, 3));
    for (double t = 1; t < 2.8; t += 0.0123) {
        assert_near(value_at(linear, t + 0.5), 0.02 * sin(2 * pi * (t + 8 * t * t / 6)), 1e-14);
        /* 1 Hz, 2 Hz after a second, 4 Hz after two: the integral of 2^t */
        assert_near(value_at(logarithmic, t), 0.1 + 0.02 * sin(2 * pi * (pow(2, t) - 1) / log(2)), 1e-14);
    }
    assert_true(value_at(linear, 0.4) == 0 && value_at(linear, 3.6) == 0 && value_at(logarithmic, 3.01) == 0.1);
    /* the same frequency all along is a sine */
    const Profile *steady =
        rack_of(pool, "{chirp: {amplitude: 1, from: 2, to: 2, duration: 3, growth: logarithmic, offset: 0}}");
    const Profile *sine = rack_of(pool, "{sine: {amplitude: 1, frequency: 2, offset: 0}}");
    for (double t = 0; t < 2.4; t += 0.037)
        assert_near(value_at(steady, t), value_at(sine, t), 1e-13);
    pool_free(pool);
}

/* Samples of a sine, `count` in a period of 1 s, for 4 s. */
static const char *sine_samples(Pool *pool, int count)
{
    Text times = {.pool = pool}, values = {.pool = pool};
    for (int i = 0; i <= 4 * count; ++i) {
        text_print(&times, "%s%.17g", i ? ", " : "", (double)i / count);
        text_print(&values, "%s%.17g", i ? ", " : "", 0.1 * sin(2 * pi * i / count));
    }
    return pool_print(pool, "{times: [%s], values: [%s]}", times.s, values.s);
}

/* The largest errors of value, rate and acceleration against the sine, away from the ends. */
static void sine_errors(const Profile *profile, double error[3])
{
    memset(error, 0, 3 * sizeof *error);
    for (double t = 1; t < 2; t += 0.00123) {
        double out[3];
        profile_at(profile, t, out);
        const double w = 2 * pi, s = 0.1 * sin(w * t), c = 0.1 * cos(w * t);
        const double exact[3] = {s, w * c, -w * w * s};
        for (int k = 0; k < 3; ++k)
            error[k] = fmax(error[k], fabs(out[k] - exact[k]) / pow(w, k) / 0.1);
    }
}

static void test_samples(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    double coarse[3], fine[3];
    const Profile *spline = rack_of(pool, pool_print(pool, "{samples: %s}", sine_samples(pool, 20)));
    sine_errors(spline, coarse);
    assert_true(coarse[0] < 2e-4 && coarse[1] < 2e-3 && coarse[2] < 1e-2);
    sine_errors(rack_of(pool, pool_print(pool, "{samples: %s}", sine_samples(pool, 40))), fine);
    assert_true(coarse[0] / fine[0] > 14 && coarse[1] / fine[1] > 7 && coarse[2] / fine[2] > 3.8); /* orders 4, 3, 2 */
    double out[3];
    profile_at(spline, 0, out);               /* a scene that begins with the samples begins as they do */
    assert_near(out[1], 0.1 * 2 * pi, 0.005); /* h^3 / 4 times the fourth derivative */
    /* knots stop at every sample: their rate is up to 1.875 times that of the chord */
    const Profile *knots = rack_of(pool, pool_print(pool, "{knots: %s}", sine_samples(pool, 20)));
    assert_near(profile_peaks(knots, 4).rate, 1.875 * 20 * 0.1 * sin(2 * pi / 20), 1e-13);
    assert_near(profile_peaks(spline, 4).rate, 0.1 * 2 * pi, 0.005);
    for (int i = 0; i <= 80; ++i)
        assert_near(value_at(spline, i / 20.0), 0.1 * sin(2 * pi * i / 20), 1e-16);

    /* samples that begin and end within the scene begin and end at rest */
    const Profile *within = rack_of(pool, "{samples: {times: [0.5, 1, 1.5, 2, 3], values: [0, 1, 3, 2, 2]}}");
    check_derivatives(within, 4, 1000);
    profile_at(within, 0.5, out);
    assert_true(out[0] == 0 && out[1] == 0 && out[2] == 0);

    /* pedals stay between their samples, driven coordinates get the spline */
    const Scene *scene =
        scene_of(pool, "inputs: {pedal: {samples: {times: [0, 1, 1.1, 2, 3], values: [0, 0, 1, 1, 0]}}}");
    for (double t = -1; t < 4; t += 0.01) {
        const double now = value_at(scene->profile, t);
        assert_true(now >= 0 && now <= 1 && (t > 1 || now == 0) && (t < 1.1 || t > 2 || now == 1));
    }
    scene =
        scene_of(pool, "inputs: {pedal: {samples: {times: [0, 1, 1.1, 2, 3], values: [0, 0, 1, 1, 0], fit: spline}}}");
    assert_true(profile_peaks(scene->profile, 4).low < -0.01);
    /* two samples, and one */
    assert_near(value_at(rack_of(pool, "{samples: {times: [1, 2], values: [0, 1]}}"), 1.5), 0.5, 1e-15);
    assert_true(value_at(rack_of(pool, "{samples: {times: [1], values: [3]}}"), 0.5) == 3);
    pool_free(pool);
}

static void test_formulas(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    static const char *const smooth[] = {
        "0.1 * sin(2 * pi * 3 * time)",
        "high * time ^ 3 - 2 * time",
        "exp(-time) * cos(3 * time) / (1 + time ^ 2)",
        "sqrt(1 + time ^ 2) + log(2 + time)",
        "atan(time) + tanh(2 * time) - tan(0.3 * time)",
        "asin(0.2 * time) + acos(0.1 * time)",
        "atan2(1 + time, 2 - sin(time))",
        "pow(2 + time, 1 + 0.1 * time)",
        "(1 + time) ^ -1.5 + time ^ 1 + time ^ 0",
        "-(time - 1) ^ 2",
    };
    for (size_t i = 0; i < sizeof smooth / sizeof *smooth; ++i)
        check_derivatives(rack_of(pool, pool_print(pool, "{formula: \"%s\"}", smooth[i])), 4, 1000);
    double out[3];
    profile_at(rack_of(pool, "{formula: \"high * time ^ 3 - 2 * time\"}"), 2, out);
    assert_near(out[0], -2, 1e-15);
    assert_near(out[1], 1, 1e-15);
    assert_near(out[2], 3, 1e-15);
    profile_at(rack_of(pool, "{formula: \"time ^ 2\"}"), 0, out); /* where logarithms have no value */
    assert_true(out[0] == 0 && out[1] == 0 && out[2] == 2);

    /* of other inputs values count alone, so that they may bend */
    const Scene *scene =
        scene_of(pool, "inputs: {pedal: {formula: \"if(time < 1, 0, min(1, time - 1)) + bend(time) / 10\"}}");
    /* slopes of the monotone cubic (FORMAT.md section 7): 2 at the end, the weighted mean at x = 1 */
    const double h = 1, t = 0.5, inner = ((2 * 2 + 1) + (2 + 2 * 1)) / ((2 * 2 + 1) / 2.0 + (2 + 2 * 1) / 0.5);
    const double u = 1 - t, cubic = t * u * u * h * 2 + t * t * (3 - 2 * t) * 2 - t * t * u * h * inner;
    assert_near(value_at(scene->profile, 0.5), 0.1 * cubic, 1e-15);
    assert_near(value_at(scene->profile, 3.5), 1.3, 1e-15);
    pool_free(pool);
}

static void test_files(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    char *path = write_temporary(pool, "# recorded\ntime [ms],wheel [deg],input.pedal [%],engine [rpm]\n"
                                       "0,0,50,60\n500,90,100,600\n1500,-180,0,0\n\n2000,0,25,6\n");
    const char *text = "inputs:\n"
                       "  rack: {file: {name: %s, column: wheel, scale: 0.001, offset: 0.01}}\n"
                       "  pedal: {file: {name: %s}}\n"
                       "  speed: {file: {name: %s, column: engine}}\n";
    const Scene *scene = scene_of(pool, pool_print(pool, text, path, path, path));
    const double time[] = {0, 0.5, 1.5, 2}, wheel[] = {0.01, 0.1, -0.17, 0.01}, pedal[] = {0.5, 1, 0, 0.25};
    const double speed[] = {60, 600, 0, 6};
    assert_true(scene->profiles == 3);
    for (int i = 0; i < 4; ++i) {
        assert_near(value_at(&scene->profile[0], time[i]), wheel[i], 1e-15);
        assert_near(value_at(&scene->profile[1], time[i]), pedal[i], 1e-16);
        assert_near(value_at(&scene->profile[2], time[i]), speed[i] * 2 * pi / 60, 1e-13);
    }
    check_derivatives(&scene->profile[0], 2.2, 100);
    assert_true(scene->profile[0].acceleration && !scene->profile[1].acceleration); /* spline; monotone */
    unlink(path);

    path = write_temporary(pool, "time,rack [mm],pedal\n0,10,0.5\n1,20,0.75\n2,-10,1\n");
    scene = scene_of(pool, pool_print(pool, "input_file: %s\ninputs: {speed: 3}", path));
    assert_true(scene->profiles == 3);
    double input[] = {0, 0, 0, 0, 0};
    scene_inputs((void *)scene, 0, 1, input);
    /* inputs of driven coordinates stand behind or before the others: by their names */
    for (int i = 0; i < 3; ++i)
        assert_near(input[scene->profile[i].input], scene->profile[i].driven ? 0.02 : i == 0 ? 3 : 0.75, 1e-16);
    scene = scene_of(pool, pool_print(pool, "input_file: {name: %s, fit: spline}", path));
    assert_true(scene->profiles == 2 && scene->profile[0].acceleration && scene->profile[1].acceleration);
    unlink(path);
    pool_free(pool);
}

/* Where steps must end, how long they may be, and how long an input stays. */
static void test_times(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Profile *knots = rack_of(pool, "{knots: {times: [1, 2, 3], values: [0, 1, 1]}}");
    assert_true(profile_next_kink(knots, 0) == 1 && profile_next_kink(knots, 1) == 2 &&
                profile_next_kink(knots, 2.5) == 3);
    assert_true(isinf(profile_next_kink(knots, 3)) && isinf(profile_longest_step(knots, 1.5)));
    assert_true(profile_quiet_until(knots, 0) == 1 && profile_quiet_until(knots, 1) == 1);
    assert_true(profile_quiet_until(knots, 2) == 3 && isinf(profile_quiet_until(knots, 3)));
    /* steps end at the first and the last sample, and between pass one at most */
    const Profile *samples = rack_of(pool, "{samples: {times: [1, 2, 2.5, 3], values: [0, 1, 1, 0]}}");
    assert_true(profile_next_kink(samples, 0) == 1 && profile_next_kink(samples, 1) == 3);
    assert_true(profile_longest_step(samples, 1.25) == 1.25 && profile_longest_step(samples, 2.75) == 0.25);
    assert_true(isinf(profile_longest_step(samples, 0)) && isinf(profile_longest_step(samples, 3)));
    assert_true(profile_quiet_until(samples, 2.2) == 2.2 && isinf(profile_quiet_until(samples, 3)));
    const Profile *chirp = rack_of(pool, "{chirp: {amplitude: 1, from: 1, to: 8, duration: 3, start: 0.5}}");
    assert_true(profile_longest_step(chirp, 1) == 1.0 / 64 && profile_next_kink(chirp, 0) == 0.5);
    assert_true(profile_next_kink(chirp, 0.5) == 1.5 && profile_next_kink(chirp, 2) == 3.375);
    assert_true(profile_quiet_until(chirp, 0.1) == 0.5 && isinf(profile_quiet_until(chirp, 3.5)));
    const Profile *formula = rack_of(pool, "{formula: \"time\"}");
    assert_true(profile_longest_step(formula, 1) == 0.01 && profile_quiet_until(formula, 1) == 1);
    assert_true(!profile_is_constant(formula) && profile_is_constant(rack_of(pool, "0.3")));
    assert_true(profile_is_constant(rack_of(pool, "{samples: {times: [0, 1, 2], values: [1, 1, 1]}}")));
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moves),    cmocka_unit_test(test_chirps), cmocka_unit_test(test_samples),
        cmocka_unit_test(test_formulas), cmocka_unit_test(test_files),  cmocka_unit_test(test_times),
    };
    return cmocka_run_group_tests_name("profiles", tests, NULL, NULL);
}
