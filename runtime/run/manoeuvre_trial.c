/* SPDX-License-Identifier: MIT
 * One run of a manoeuvre: a scene from a text, what the vehicle does at its output times. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/engines.h"
#include "run/manoeuvre.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

const gic_signal trial_signal[TRIAL_CHANNELS] = {[TRIAL_TIME] = {"time", "s"},
                                                 [TRIAL_STEER] = {"steering", ""},
                                                 [TRIAL_ANGLE] = {"steer_angle", "rad"},
                                                 [TRIAL_ACCELERATOR] = {"accelerator", "1"},
                                                 [TRIAL_BRAKE] = {"brake", "1"},
                                                 [TRIAL_X] = {"x", "m"},
                                                 [TRIAL_Y] = {"y", "m"},
                                                 [TRIAL_YAW] = {"yaw", "rad"},
                                                 [TRIAL_SPEED] = {"speed", "m/s"},
                                                 [TRIAL_SIDESLIP] = {"sideslip", "rad"},
                                                 [TRIAL_YAW_RATE] = {"yaw_rate", "rad/s"},
                                                 [TRIAL_AX] = {"ax", "m/s^2"},
                                                 [TRIAL_AY] = {"ay", "m/s^2"},
                                                 [TRIAL_AZ] = {"az", "m/s^2"},
                                                 [TRIAL_ROLL] = {"roll", "rad"},
                                                 [TRIAL_PITCH] = {"pitch", "rad"},
                                                 [TRIAL_LOAD] = {"least_load", "N"},
                                                 [TRIAL_LAST_X] = {"last.x", "m"},
                                                 [TRIAL_LAST_Y] = {"last.y", "m"},
                                                 [TRIAL_LAST_YAW_RATE] = {"last.yaw_rate", "rad/s"},
                                                 [TRIAL_LAST_AY] = {"last.ay", "m/s^2"},
                                                 [TRIAL_LAST_ROLL] = {"last.roll", "rad"},
                                                 [TRIAL_ARTICULATION] = {"articulation", "rad"}};

static const double patience = 0.5; /* s of run time, after which faster code is worth its compiler */

/* A run under way. */
typedef struct Way {
    TestCar *car;
    const Scene *scene;
    gic_head *self, *copy;
    Variable *variable;
    int64_t slumber;
    double *state, *rate;
    Trial *trial;
    int room;
} Way;

/* Place, velocity and acceleration of the centre of mass, of a base whose state and rate are known. */
static void centre(const TestCar *car, const double *state, const double *rate, int half, double r[3], double v[3],
                   double a[3])
{
    const double *omega = state + half + 4, *alpha = rate + half + 4;
    double A[9], lever[3], of_v[3], of_a[2][3], turned[3];
    mat_from_euler(state + 3, A);
    apply3(A, car->com, lever);
    cross3(omega, car->com, of_v);
    cross3(alpha, car->com, of_a[0]);
    cross3(omega, of_v, of_a[1]);
    for (int i = 0; i < 3; ++i) {
        r[i] = state[i] + lever[i];
        v[i] = state[half + 1 + i];
        a[i] = rate[half + 1 + i];
        of_a[0][i] += of_a[1][i];
    }
    apply3(A, of_v, turned);
    add_scaled3(1, turned, v);
    apply3(A, of_a[0], turned);
    add_scaled3(1, turned, a);
}

static void motion(const Way *way, const double *output, double *row)
{
    const TestCar *car = way->car;
    const Trial *trial = way->trial;
    const int half = (car->engine->standard_count - car->code->fast_count) / 2;
    double A[9], r[3], v[3], a[3];
    mat_from_euler(way->state + 3, A);
    centre(car, way->state, way->rate, half, r, v, a);
    const double before = trial->rows > 0 ? trial->row[trial->rows - 1][TRIAL_YAW] : 0;
    const double c = cos(atan2(A[3], A[0])), s = sin(atan2(A[3], A[0]));
    row[TRIAL_X] = r[0];
    row[TRIAL_Y] = r[1];
    row[TRIAL_YAW] = before + remainder(atan2(A[3], A[0]) - before, 2 * 3.141592653589793);
    row[TRIAL_SPEED] = c * v[0] + s * v[1];
    row[TRIAL_SIDESLIP] = atan2(c * v[1] - s * v[0], row[TRIAL_SPEED]);
    row[TRIAL_YAW_RATE] = dot3(A + 6, way->state + half + 4);
    row[TRIAL_AX] = c * a[0] + s * a[1];
    row[TRIAL_AY] = c * a[1] - s * a[0];
    row[TRIAL_AZ] = a[2];
    row[TRIAL_ROLL] = atan2(A[7], A[8]);
    row[TRIAL_PITCH] = -asin(fmax(-1, fmin(1, A[6])));
    for (int k = TRIAL_OF_ONE; k < TRIAL_CHANNELS; ++k)
        row[k] = 0;
    if (car->units)
        units_motion(output + car->unit, row);
}

/* A row at the present time. Returns a status. */
static int record(Way *way)
{
    TestCar *car = way->car;
    Trial *trial = way->trial;
    int status = scene_outputs(car->code, way->scene, way->self, way->copy, &way->slumber);
    if (status == GIC_OK)
        status = engine_look(car->engine, way->copy, way->state, way->rate);
    if (status != GIC_OK)
        return status;
    if (trial->rows == way->room) {
        const size_t old = (size_t)way->room, of_wheels = (size_t)car->model->wheels * TRIAL_OF_WHEEL * sizeof(double);
        way->room = 2 * way->room + 512;
        trial->row = pool_grow(car->pool, trial->row, old * sizeof *trial->row, (size_t)way->room * sizeof *trial->row);
        trial->wheel = pool_grow(car->pool, trial->wheel, old * of_wheels, (size_t)way->room * of_wheels);
    }
    const double *input = instance_array(way->copy, car->code->input_offset);
    const double *output = instance_array(way->copy, car->code->output_offset);
    double *row = trial->row[trial->rows];
    row[TRIAL_TIME] = gic_time(way->self);
    row[TRIAL_STEER] = car->steering < 0 ? 0 : input[car->steering];
    row[TRIAL_ANGLE] = car->steering < 0 ? 0 : (input[car->steering] - car->straight) * car->angle;
    row[TRIAL_ACCELERATOR] = car->accelerator < 0 ? 0 : input[car->accelerator];
    row[TRIAL_BRAKE] = car->brake < 0 ? 0 : input[car->brake];
    row[TRIAL_LOAD] = INFINITY;
    for (int w = 0; w < car->model->wheels; ++w) {
        double *of = trial->wheel + (trial->rows * car->model->wheels + w) * TRIAL_OF_WHEEL;
        of[TRIAL_WHEEL_LOAD] = output[car->load[w]];
        of[TRIAL_WHEEL_ROAD] = output[car->load[w] + 3];
        const int travel = car->travel[w] < 0 ? -1 : car->code->coordinate_state[car->travel[w]];
        of[TRIAL_WHEEL_TRAVEL] = travel < 0 ? 0 : way->state[travel];
        row[TRIAL_LOAD] = fmin(row[TRIAL_LOAD], of[TRIAL_WHEEL_LOAD]);
    }
    motion(way, output, row);
    ++trial->rows;
    return GIC_OK;
}

/* True where the vehicle leans by more than 60 degrees. */
static bool is_over(const Way *way)
{
    double A[9];
    mat_from_euler(way->state + 3, A);
    return A[8] < 0.5;
}

static void take_faster_code(Way *way)
{
    const gic_model *faster = engine_faster(way->car->engine, way->self);
    if (!faster)
        return;
    way->car->code = faster;
    if (way->variable)
        variable_change(way->variable, faster);
}

/* Steps up to an output time. Returns a status. */
static int advance(Way *way, double end)
{
    int status = GIC_OK;
    while (status == GIC_OK && gic_time(way->self) < end)
        status = scene_step(way->car->engine, way->car->code, way->scene, way->variable, way->self, end);
    return status;
}

Trial *trial_run(TestCar *car, const char *name, const char *text, TrialStop *stop, void *context)
{
    const Scene *scene = scene_read_text(car->pool, pool_print(car->pool, "the scene of %s", name), text, car->model);
    scene_rig(car->pool, car->model, &scene); /* its model is the engine's */
    const size_t numbers = (size_t)car->engine->standard_count + 1;
    Trial *trial = pool_alloc(car->pool, sizeof *trial);
    *trial = (Trial){.name = name, .scene = text, .state = pool_alloc(car->pool, numbers * sizeof(double))};
    Way way = {.car = car,
               .scene = scene,
               .self = instance_new(car->pool, car->engine),
               .copy = instance_new(car->pool, car->engine),
               .state = trial->state,
               .rate = pool_alloc(car->pool, numbers * sizeof(double)),
               .trial = trial};
    int status = scene_start(car->engine, scene, way.self);
    way.variable = variable_open(car->code, scene->method, scene->tolerance);
    if (!way.variable)
        diag_fail(program_place(), NULL, "no memory for the integrator");
    if (status == GIC_OK)
        status = record(&way);
    const double begin = clock_seconds(CLOCK_MONOTONIC);
    bool ended = false;
    for (int64_t k = 0; k < scene->outputs && status == GIC_OK && !ended; ++k) {
        status = advance(&way, (double)(k + 1) * scene->output_step);
        if (status == GIC_OK)
            status = record(&way);
        trial->tipped = status == GIC_OK && is_over(&way);
        ended = trial->tipped || (status == GIC_OK && stop && stop(context, trial));
        if (clock_seconds(CLOCK_MONOTONIC) - begin > patience)
            take_faster_code(&way);
    }
    if (status != GIC_OK)
        trial->end = pool_print(car->pool, "the run ends at t = %.6g s: %s", gic_time(way.self),
                                instance_status(car->pool, car->code, way.self, status));
    const int32_t *discrete = (const int32_t *)(const void *)((const char *)way.self + car->code->discrete_offset);
    trial->gear = car->model->powertrain ? discrete[car->code->free_base + POWERTRAIN_GEAR] : 0;
    variable_close(way.variable);
    return trial;
}
