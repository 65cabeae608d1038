/* SPDX-License-Identifier: MIT
 * Scenes: what is read against values worked out by hand, profiles of inputs against their finite differences. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <math.h>

#include "base/pool.h"
#include "base/vec3.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "read/read.h"
#include "scene/profile.h"
#include "scene/scene.h"

static const char model_text[] =
    "gicgen: 1\n"
    "model: cart\n"
    "base: hull\n"
    "bodies:\n"
    "  hull: {mass: 10, com: [0, 0, 1], inertia: [1, 1, 1]}\n"
    "  slide: {mass: 1, com: [1, 0, 1], inertia: [1, 1, 1]}\n"
    "  rod: {mass: 1, com: [-1, 0, 1], inertia: [1, 1, 1]}\n"
    "joints:\n"
    "  up: {type: prismatic, bodies: [hull, slide], axis: [0, 0, 1]}\n"
    "  across: {type: prismatic, bodies: [hull, rod], axis: [0, 1, 0]}\n"
    "coordinates:\n"
    "  rack: {type: translation, bodies: [hull, rod], axis: [0, 1, 0], driven: true, design: 0.01}\n"
    "  lift: {type: translation, bodies: [hull, slide], axis: [0, 0, 1], design: 0.02}\n"
    "outputs:\n"
    "  hull: {type: position, body: hull}\n"
    "  lift: {type: coordinate, coordinate: lift}\n"
    "  slide: {type: position, body: slide}\n";

static const char time_text[] = "gicscene: 1\nduration: 1\nstep: 0.01\n";

static char *write_temporary(Pool *pool, const char *text)
{
    char *path = pool_print(pool, "%s/test-scene-XXXXXX", temporary_folder());
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    return path;
}

static const Scene *scene_of(Pool *pool, const char *text)
{
    char *model_path = write_temporary(pool, model_text);
    char *scene_path = write_temporary(pool, pool_print(pool, "%s%s", time_text, text));
    const Scene *scene = scene_read(pool, scene_path, model_read(pool, model_path), NULL, 0);
    unlink(model_path);
    unlink(scene_path);
    return scene;
}

static void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.17g is not %.17g", a, b);
}

static void test_defaults(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "");
    const double design[] = {0, 0, 1}, upright[] = {1, 0, 0, 0};
    assert_int_equal(scene->method, GIC_AB3);
    assert_int_equal(scene->outputs, 100);
    assert_int_equal(scene->per_output, 1);
    assert_memory_equal(scene->position, design, sizeof design);
    assert_memory_equal(scene->euler, upright, sizeof upright);
    assert_true(scene->value[1] == 0.02 && scene->rate[1] == 0);
    assert_null(scene->road);
    assert_int_equal(scene->columns, 9);
    assert_int_equal(scene->curves, 2);
    assert_true(scene->curve[0] == 2 && scene->curve[1] == 8); /* hull.z, slide.z */
    pool_free(pool);
}

static void test_times(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "output_step: 0.03\nintegrator: rk4\n");
    assert_int_equal(scene->method, GIC_RK4);
    assert_int_equal(scene->per_output, 3);
    assert_int_equal(scene->outputs, 33); /* the last at 0.99 s */
    pool_free(pool);
}

static void test_initial(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const double yaw = 0.7, pitch = -0.4, roll = 2.1;
    const Scene *scene = scene_of(pool, "initial: {orientation: {yaw: 0.7, pitch: -0.4, roll: 2.1}, speed: 3,\n"
                                        "  angular_velocity: [1, 2, 3],\n"
                                        "  coordinates: {lift: 0.03}, rates: {lift: -2}}\n");
    /* Rz(yaw) Ry(pitch) Rx(roll), written out */
    const double expected[9] = {cos(yaw) * cos(pitch),
                                cos(yaw) * sin(pitch) * sin(roll) - sin(yaw) * cos(roll),
                                cos(yaw) * sin(pitch) * cos(roll) + sin(yaw) * sin(roll),
                                sin(yaw) * cos(pitch),
                                sin(yaw) * sin(pitch) * sin(roll) + cos(yaw) * cos(roll),
                                sin(yaw) * sin(pitch) * cos(roll) - cos(yaw) * sin(roll),
                                -sin(pitch),
                                cos(pitch) * sin(roll),
                                cos(pitch) * cos(roll)};
    double A[9];
    mat_from_euler(scene->euler, A);
    for (int i = 0; i < 9; ++i)
        assert_near(A[i], expected[i], 1e-15);
    for (int i = 0; i < 3; ++i) {
        assert_near(scene->velocity[i], 3 * expected[3 * i], 4e-15);
        assert_true(scene->angular_velocity[i] == i + 1);
    }
    assert_true(scene->value[1] == 0.03 && scene->rate[1] == -2);

    scene = scene_of(pool, "initial: {orientation: {euler: [0, 0.6, 0, -0.8]},\n"
                           "  velocity: [1, 2, 3], position: [7, 8, 9]}\n");
    assert_near(scene->euler[1], 0.6, 1e-15);
    assert_near(scene->euler[3], -0.8, 1e-15);
    assert_true(scene->velocity[2] == 3 && scene->position[0] == 7);
    pool_free(pool);
}

static void test_names(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "outputs: [slide.y, lift, hull.z, slide]\nplot: [lift.rate]\n");
    const int expected[] = {7, 3, 4, 5, 2, 6, 8}; /* slide.y once, at its first place */
    assert_int_equal(scene->columns, 7);
    assert_memory_equal(scene->column, expected, sizeof expected);
    assert_true(scene->curves == 1 && scene->curve[0] == 4);
    /* inputs stand behind the nine components: value, rate and acceleration of the rack */
    scene = scene_of(pool, "outputs: [input.rack.rate, hull.x]\n"
                           "plot: [{x: hull.x, y: hull.y}, lift.rate, {x: input.rack, y: slide.z}]\n");
    const int panel[] = {0, 1, 9, 8};
    assert_true(scene->columns == 2 && scene->column[0] == 10 && scene->column[1] == 0);
    assert_string_equal(scene->signal[10].name, "input.rack.rate");
    assert_string_equal(scene->signal[10].unit, "m/s");
    assert_true(scene->curves == 1 && scene->curve[0] == 4 && scene->panels == 2);
    assert_memory_equal(scene->panel, panel, sizeof panel);
    pool_free(pool);
}

static double height(const Scene *scene, double x, double y)
{
    double out[3];
    scene->road->height(scene->road, 0, 0, x, y, out);
    return out[0];
}

static void test_roads(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "road: {type: slope, height: 1, x: 0.5, y: -0.25}\n");
    assert_near(height(scene, 2, 4), 1, 1e-15);
    scene = scene_of(pool, "road: {type: flat, height: -0.5}\n");
    assert_near(height(scene, 2, 4), -0.5, 0);
    scene = scene_of(pool, "road: {type: sine, amplitude: 0.2, wavelength: 4, start: 1, phase_per_y: 0}\n");
    assert_near(height(scene, 2, 0), 0.2, 1e-15);
    assert_near(height(scene, 4, 0), -0.2, 1e-15);
    scene = scene_of(pool, "road:\n  type: bumps\n  bumps:\n"
                           "    - {x: 1, length: 2, height: 0.1, tracks: left}\n"
                           "    - {x: 1, length: 2, height: 0.2, tracks: right}\n"
                           "    - {x: 2, length: 2, height: -0.4, tracks: both}\n"
                           "    - {x: 9, length: 2, height: 1, y: [3, 4]}\n");
    assert_near(height(scene, 2, 1), 0.1, 1e-15);
    assert_near(height(scene, 2, -1), 0.2, 1e-15);
    assert_near(height(scene, 2, 0), 0.2, 1e-15); /* the middle belongs to the right */
    assert_near(height(scene, 2.5, 1), 0.05 - 0.2, 1e-15);
    assert_near(height(scene, 10, 3.5), 1, 1e-15);
    assert_near(height(scene, 10, 2.9), 0, 0);
    scene = scene_of(pool, "road: {type: table, x: [0, 1, 2], left: [0, 1, 0], right: [5, 6, 7]}\n");
    assert_near(height(scene, 1, 1), 1, 1e-15);
    assert_near(height(scene, 0.5, 1), 0.5, 1e-15); /* level at both ends: halfway up */
    assert_near(height(scene, 9, -1), 7, 0);
    scene = scene_of(pool, "road: {type: table, x: [0, 2], height: [1, 3]}\n");
    assert_near(height(scene, 1, 1), 2, 1e-15);
    assert_near(height(scene, 1, -1), 2, 1e-15);
    pool_free(pool);
}

static double friction(const Scene *scene, double x, double y)
{
    return scene->road->friction(scene->road, 0, 0, x, y);
}

/* A scene beside a file that holds its road. */
static const Scene *scene_with(Pool *pool, const char *file, const char *road)
{
    char *path = write_temporary(pool, file);
    const Scene *scene = scene_of(pool, pool_print(pool, "road: {%s, file: %s}\n", road, strrchr(path, '/') + 1));
    unlink(path);
    return scene;
}

static void test_road_files(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    /* a comment, a byte order mark, units, columns in another order */
    const Scene *scene =
        scene_with(pool, "\xef\xbb\xbf# ours\nright [m],x [m],left\n5,0,0\n6,1,1\n7,2,0\n", "type: table");
    assert_near(height(scene, 1, 1), 1, 1e-15);
    assert_near(height(scene, 0.5, 1), 0.5, 1e-15);
    assert_near(height(scene, 9, -1), 7, 0);
    scene = scene_with(pool, "x,height\n0,1\n2,3\n", "type: table");
    assert_near(height(scene, 1, 1), 2, 1e-15);
    assert_near(height(scene, 1, -1), 2, 1e-15);
    /* rows in any order; 0.33 and 0.67 for thirds */
    scene = scene_with(pool,
                       "x,y,z\n1,0,0\n0,0,4\n0.3333,0,0\n0.6667,0,0\n1,2,0\n0.6667,2,0\n0.3333,2,0\n0,2,0\n"
                       "1,4,0\n0.6667,4,5\n0.3333,4,7\n0,4,0\n",
                       "type: grid");
    assert_near(height(scene, -9, -9), 4, 0);
    assert_near(height(scene, 1.0 / 3, 4), 7, 1e-14);
    assert_near(height(scene, 2.0 / 3, 99), 5, 1e-14);
    assert_near(height(scene, 1, 4), 0, 1e-14);
    /* halfway between the nodes: 9/16 of the near ones, -1/16 of the far ones; along y from 0 to 2: level at 0, slope
     * (h2 - h0) / 2 at 2, so that (h0 + h1) / 2 - (h2 - h0) / 16 */
    assert_near(height(scene, 0.5, 4), 9.0 / 16 * 12, 1e-13);
    assert_near(height(scene, 1.0 / 3, 1), -7.0 / 16, 1e-13);
    pool_free(pool);
}

static void test_made_roads(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    const Scene *scene = scene_of(pool, "road: {type: iso8608, class: E, seed: 3, length: 40, start: 5, fade: 2,\n"
                                        "       spacing: 0.1, track: 2}\n");
    gic_road_grid grid;
    double node[2 * 401], out[3];
    const gic_iso8608 profile = {'E', 3, 5, 40, 2, 2};
    assert_int_equal(gic_road_iso8608_setup(&grid, &profile, node, 401), GIC_OK);
    for (double x = 4; x < 46; x += 0.37) {
        grid.head.height(&grid.head, 0, 0, x, 0.3, out);
        assert_true(height(scene, x, 0.3) == out[0]);
    }
    assert_null(scene->road->friction);
    /* what SCENE.md gives as defaults */
    scene = scene_of(pool, "road: {type: iso8608, class: E, length: 40}\n");
    const gic_iso8608 usual = {'E', 1, 0, 40, 1.5, 5};
    double usual_node[2 * 801];
    assert_int_equal(gic_road_iso8608_setup(&grid, &usual, usual_node, 801), GIC_OK);
    grid.head.height(&grid.head, 0, 0, 33, 0.3, out);
    assert_true(height(scene, 33, 0.3) == out[0]);

    scene = scene_of(pool, "road:\n  type: sum\n  roads:\n    - {type: flat, height: 0.5}\n"
                           "    - {type: slope, x: 0.25}\n    - {type: flat, height: 2}\n"
                           "  friction: {value: 0.5, patches: [{x: [0, 4], y: [-1, 1], value: 0.25},\n"
                           "                                   {x: [2, 6], y: [-1, 1], value: 1, fade: 1}]}\n");
    assert_near(height(scene, 2, 4), 3, 1e-15);
    assert_near(friction(scene, 2, 4), 0.5, 0);
    assert_near(friction(scene, 1, 0), 0.25, 0);
    assert_near(friction(scene, 5, 0), 1, 0);
    assert_near(friction(scene, 2, 0), 0.625, 1e-15);
    assert_near(friction(scene, 0.05, 0), 0.25, 1e-15); /* the default fade: 0.1 */
    assert_near(friction(scene, -0.05, 0), 0.5, 1e-15);
    scene = scene_of(pool, "road: {type: flat, friction: {patches: [{x: [0, 4], y: [-1, 1], value: 0.25}]}}\n");
    assert_near(friction(scene, 9, 0), 1, 0);
    pool_free(pool);
}

/* Rate and acceleration are the derivatives of the value, and none of the three jumps. */
static void check_profile(const Profile *profile, double end, double largest_jerk)
{
    const double d = 1e-5;
    double out[3], before[3], after[3];
    for (double t = -0.1; t < end; t += 0.00317) {
        profile_at(profile, t, out);
        profile_at(profile, t - d, before);
        profile_at(profile, t + d, after);
        assert_near(out[1], (after[0] - before[0]) / (2 * d), 1e-8);
        assert_near(out[2], (after[1] - before[1]) / (2 * d), largest_jerk * d);
        assert_near(after[2], before[2], 2 * largest_jerk * d);
    }
}

static void test_profiles(void **unused)
{
    (void)unused;
    Pool *pool = pool_new();
    double out[3];
    const Scene *scene = scene_of(pool, "inputs:\n  rack: {knots: {times: [0.2, 0.7, 1.9],\n"
                                        "                 values: [0.01, 0.04, -0.03]}}\n");
    const Profile *profile = scene->profile;
    assert_true(scene->profiles == 1 && profile->input == 0 && profile->driven);
    check_profile(profile, 2.5, 60 * 0.03 / pow(0.5, 3));
    const double knots[][2] = {{-1, 0.01},   {0.2, 0.01},  {0.45, 0.025}, {0.7, 0.04},
                               {1.3, 0.005}, {1.9, -0.03}, {5, -0.03}};
    for (size_t i = 0; i < sizeof knots / sizeof *knots; ++i) {
        profile_at(profile, knots[i][0], out);
        assert_near(out[0], knots[i][1], 1e-16);
    }

    scene = scene_of(pool, "inputs: {rack: {sine: {amplitude: 0.02, frequency: 2, start: 0.3}}}\n");
    profile = scene->profile;
    check_profile(profile, 2, 3 * 0.02 * pow(12.6, 3));
    profile_at(profile, 0.3, out);
    assert_true(out[0] == 0.01 && out[1] == 0 && out[2] == 0); /* from the design value, at rest */
    profile_at(profile, 0.3 + 0.5 + 0.125, out);               /* a quarter period after the fade */
    assert_near(out[0], 0.01 + 0.02, 1e-16);

    double input[] = {9, 9, 9, 9};
    scene = scene_of(pool, "inputs: {rack: -0.02}\n");
    scene_inputs((void *)scene, 0, 0.5, input);
    assert_true(input[0] == -0.02 && input[1] == 0 && input[2] == 0 && input[3] == 9);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),   cmocka_unit_test(test_times),      cmocka_unit_test(test_initial),
        cmocka_unit_test(test_names),      cmocka_unit_test(test_roads),      cmocka_unit_test(test_profiles),
        cmocka_unit_test(test_road_files), cmocka_unit_test(test_made_roads),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
