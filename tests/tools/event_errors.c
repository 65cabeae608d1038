/* SPDX-License-Identifier: MIT
 * event_errors MODEL.veh SCENE [ab3|rk4] [RATIO]
 *
 * Says which events the error of a scene's constant steps comes from. The run is cut into windows of 16 steps. Each
 * window starts from the state of a reference (RK4, a sixteenth of the step), is computed with the step, half of it and
 * a quarter, without a past, and then carried on for 0.5 s by RK4 with an eighth of the step, as the reference is. The
 * error of the window is the distance of the two: position of the base, m, plus its velocity, m/s, times 1 s.
 *
 * Standard output: CSV, one row for each set of events that windows contain: windows, sums of errors with the step, its
 * half and its quarter. The last row says how far a difference of 1e-12 m/s at the start grows. tests/bench/events.sh
 * does this for the scenes of models/EVENTS.md. */
#include "base/table.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/driver.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    WINDOW = 16, /* steps */
    FINE = 16,   /* parts of a step that the reference takes */
    CARRY = 8,   /* parts of a step that take errors further */
    LENGTHS = 3, /* the step, its half, its quarter */
    SETS = 256,
    WHEELS = 16,
};

static const double carried = 0.5; /* s */

/* Events. A window has a set of them. */
enum { GEAR, CONTACT, FADE, STOP, BRAKE, CONVERTER, NODE, GOVERNOR, CREEP, KNOT, ROAD, EVENTS };
static const char *const event_name[EVENTS] = {"gear",      "contact",  "fade",     "stop", "brake",   "converter",
                                               "tablenode", "governor", "lowspeed", "knot", "roadnode"};

typedef struct Sum {
    unsigned set;
    int windows;
    double error[LENGTHS], largest;
} Sum;

/* Signs of everything whose change of sign is an event. */
typedef struct Signs {
    int gear[4], place[400], count, event[400];
} Signs;

typedef struct Study {
    Pool *pool;
    const Model *model;
    const Engine *engine;
    const gic_model *code;
    const Scene *scene;
    gic_head *copy; /* for outputs */
    Sum sum[SETS];
    int sets;
} Study;

static void sign(Signs *signs, int event, double x)
{
    if (signs->count == 400)
        diag_fail(program_place(), NULL, "too many events");
    signs->event[signs->count] = event;
    signs->place[signs->count++] = x > 0;
}

/* The number of the interval that x is in counts as well as a sign. */
static void interval(Signs *signs, int event, const double *node, int count, double x)
{
    int i = 0;
    while (i < count && x > node[i])
        ++i;
    sign(signs, event, 0);
    signs->place[signs->count - 1] = i;
}

static bool ends(const char *name, const char *end)
{
    const size_t n = strlen(name), m = strlen(end);
    return n >= m && !strcmp(name + n - m, end);
}

static double output_of(const Study *study, gic_head *self, const char *name)
{
    for (int i = 0; i < study->code->output_count; ++i)
        if (!strcmp(study->code->output[i].name, name))
            return instance_array(self, study->code->output_offset)[i];
    return NAN;
}

static void powertrain_signs(const Study *study, gic_head *self, Signs *signs)
{
    const Powertrain *powertrain = study->model->powertrain;
    const double engine = output_of(study, self, "drive.engine_speed");
    const double turbine = output_of(study, self, "drive.turbine_speed");
    const double nu = engine >= turbine ? fmax(turbine, 0) / fmax(engine, 1) : fmax(engine, 0) / fmax(turbine, 1);
    const double pedal = study->model->inputs ? output_of(study, self, "drive.throttle") : 0;
    const double governor = (powertrain->idle - engine) / (0.2 * powertrain->idle);
    sign(signs, CONVERTER, engine - turbine);
    sign(signs, CONVERTER, nu - 0.95);
    sign(signs, GOVERNOR, governor);
    sign(signs, GOVERNOR, pedal - fmin(1, fmax(0, governor)) - 1e-12);
    for (int i = 0; i < study->model->tables; ++i) {
        const Table *table = &study->model->table[i];
        const bool converter = i == powertrain->capacity || i == powertrain->multiplication;
        interval(signs, NODE, table->x, table->count, converter ? nu : engine * 30 / 3.141592653589793);
    }
}

static int look(const Study *study, const gic_head *self, Signs *signs)
{
    const gic_model *code = study->code;
    const Model *model = study->model;
    *signs = (Signs){.count = 0};
    memcpy(study->copy, self, code->size);
    const int status = code->outputs(study->copy);
    const double *state = instance_array(study->copy, code->state_offset);
    const int32_t *discrete = (const int32_t *)(const void *)instance_array(study->copy, code->discrete_offset);
    for (int i = code->free_base; i < code->discrete_count && i < 4; ++i)
        signs->gear[i] = discrete[i];
    for (int i = 0; i < code->output_count; ++i) {
        const double x = instance_array(study->copy, code->output_offset)[i];
        if (ends(code->output[i].name, ".deflection")) {
            sign(signs, CONTACT, x);
            sign(signs, FADE, x - 0.01);
        } else if (ends(code->output[i].name, ".fz")) {
            sign(signs, CONTACT, x);
        }
    }
    for (int i = 0; i < model->forces; ++i) {
        const int c = model->force[i].coordinate, at = c < 0 ? -1 : code->coordinate_state[c];
        if (!force_is_stop(&model->force[i]) || at < 0)
            continue;
        sign(signs, STOP, state[at] - law_number(model->force[i].low, model));
        sign(signs, STOP, state[at] - law_number(model->force[i].high, model));
    }
    for (int i = code->slow_count; i < code->slow_count + code->fast_count; ++i)
        if (ends(code->state[i].name, ".brake")) {
            interval(signs, BRAKE, (double[4]){-1, -0.7, 0.7, 1}, 4, state[i]);
        }
    if (code->free_base)
        sign(signs, CREEP, fabs(output_of(study, study->copy, "chassis_velocity.x")) - 1);
    if (model->powertrain)
        powertrain_signs(study, study->copy, signs);
    return status;
}

static unsigned changes(const Signs *a, const Signs *b)
{
    unsigned set = 0;
    for (int i = 0; i < 4; ++i)
        set |= a->gear[i] != b->gear[i] ? 1U << GEAR : 0;
    for (int i = 0; i < a->count; ++i)
        set |= a->place[i] != b->place[i] ? 1U << a->event[i] : 0;
    return set;
}

/* A run of `steps` steps of one kind. */
static int run(const Study *study, gic_head *self, double step, int steps, int32_t method, int32_t ratio)
{
    Scene scene = *study->scene;
    scene.step = step;
    scene.method = method;
    scene.ratio = ratio;
    scene.rest = NULL;
    int status = GIC_OK;
    gic_restart(self, gic_time(self));
    for (int i = 0; i < steps && status == GIC_OK; ++i)
        status = scene_step(study->engine, study->code, &scene, NULL, self, 0);
    return status;
}

/* Take errors further, with the driver as it is. */
static int carry(const Study *study, gic_head *self)
{
    const double step = study->scene->step / CARRY;
    return run(study, self, step, (int)(carried / step), GIC_RK4, 1);
}

static double distance(const Study *study, gic_head *a, gic_head *b)
{
    const double *x = instance_array(a, study->code->state_offset), *y = instance_array(b, study->code->state_offset);
    const int half = study->code->slow_count / 2 + 1; /* velocities behind positions and four Euler parameters */
    double place = 0, speed = 0;
    for (int i = 0; i < 3; ++i) {
        place += (x[i] - y[i]) * (x[i] - y[i]);
        speed += (x[half + i] - y[half + i]) * (x[half + i] - y[half + i]);
    }
    return sqrt(place) + sqrt(speed);
}

/* The whole scene by RK4 with a quarter of the step, twice: the second run starts 1e-12 m/s faster. Returns the largest
 * growth of this difference. */
static double growth(const Study *study, gic_head *a, gic_head *b)
{
    static const double start = 1e-12;
    const Scene *scene = study->scene;
    const int parts = 4, steps = (int)(scene->duration / scene->step);
    const int half = study->code->slow_count / 2 + 1;
    double most = 0;
    Driver driver[2] = {{0}};
    if (scene_start(study->engine, scene, a) != GIC_OK || scene_start(study->engine, scene, b) != GIC_OK)
        return NAN;
    for (int k = 0; k < 2 && scene->driver; ++k)
        driver[k] = *scene->driver;
    instance_array(b, study->code->state_offset)[half] += start;
    for (int i = 0; i < steps; i += WINDOW) {
        for (int k = 0; k < 2; ++k) {
            if (scene->driver)
                *scene->driver = driver[k];
            if (run(study, k ? b : a, scene->step / parts, WINDOW * parts, GIC_RK4, 1) != GIC_OK)
                return NAN;
            if (scene->driver)
                driver[k] = *scene->driver;
        }
        most = fmax(most, distance(study, a, b) / start);
    }
    return most;
}

static Sum *sum_of(Study *study, unsigned set)
{
    for (int i = 0; i < study->sets; ++i)
        if (study->sum[i].set == set)
            return &study->sum[i];
    if (study->sets == SETS)
        diag_fail(program_place(), NULL, "too many sets of events");
    study->sum[study->sets].set = set;
    return &study->sum[study->sets++];
}

static void print(const Study *study)
{
    double all[LENGTHS] = {0};
    printf("events,windows,step,half,quarter,largest window\n");
    for (int i = 0; i < study->sets; ++i) {
        const Sum *sum = &study->sum[i];
        for (int e = 0, first = 1; e < EVENTS; ++e)
            if (sum->set >> e & 1U) {
                printf("%s%s", first ? "" : "+", event_name[e]);
                first = 0;
            }
        printf("%s,%d,%.3g,%.3g,%.3g,%.3g\n", sum->set ? "" : "none", sum->windows, sum->error[0], sum->error[1],
               sum->error[2], sum->largest);
        for (int k = 0; k < LENGTHS; ++k)
            all[k] += sum->error[k];
    }
    printf("all,,%.3g,%.3g,%.3g,\n", all[0], all[1], all[2]);
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        fputs("usage: event_errors MODEL.veh SCENE [ab3|rk4] [RATIO]\n", stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const Model *model = model_read(pool, argv[1]);
    const Scene *scene = equilibrium_start(pool, model, scene_read(pool, argv[2], model, NULL, 0), SOLVE_AUTO);
    const int32_t method = argc > 3 ? integrator_method(argv[3]) : GIC_AB3;
    const int32_t ratio = method != GIC_AB3 ? 1 : argc > 4 ? atoi(argv[4]) : scene->ratio;
    const Engine *engine =
        engine_open(pool, "cc", model, &(EngineOptions){.compiler = "cc", .flags = "", .quiet = true});
    static Study study;
    study = (Study){.pool = pool, .model = model, .engine = engine, .code = engine->code, .scene = scene};
    study.copy = instance_new(pool, engine);
    const gic_model *code = engine->code;
    gic_head *self = instance_new(pool, engine), *target = instance_new(pool, engine),
             *trial = instance_new(pool, engine), *reference = instance_new(pool, engine);
    if (scene_start(engine, scene, self) != GIC_OK)
        diag_fail(program_place(), NULL, "the scene does not start");
    const double step = scene->step;
    const int windows = (int)(scene->duration / (WINDOW * step) + 1e-9);
    Signs before, after;
    int status = look(&study, self, &before);
    for (int w = 0; w < windows && status == GIC_OK; ++w) {
        Driver driver = {0}, later = {0};
        if (scene->driver)
            driver = *scene->driver;
        unsigned set = scene_next_kink(&(Scene){.profiles = scene->profiles, .profile = scene->profile},
                                       gic_time(self)) < gic_time(self) + WINDOW * step
                           ? 1U << KNOT
                           : 0;
        gic_head *start = target; /* of the window */
        memcpy(start, self, code->size);
        for (int i = 0; i < WINDOW * FINE && status == GIC_OK; ++i) {
            Scene fine = *scene;
            fine.step = step / FINE;
            fine.method = GIC_RK4;
            fine.ratio = 1;
            fine.rest = NULL;
            status = scene_step(engine, code, &fine, NULL, self, 0);
            if (status == GIC_OK)
                status = look(&study, self, &after);
            set |= changes(&before, &after);
            before = after;
        }
        if (scene->driver)
            later = *scene->driver;
        memcpy(reference, self, code->size);
        if (status == GIC_OK)
            status = carry(&study, reference);
        Sum *sum = sum_of(&study, set);
        ++sum->windows;
        for (int k = 0; k < LENGTHS && status == GIC_OK; ++k) {
            memcpy(trial, start, code->size);
            if (scene->driver)
                *scene->driver = driver;
            status = run(&study, trial, step / (1 << k), WINDOW << k, method, ratio);
            if (status == GIC_OK)
                status = carry(&study, trial);
            const double error = distance(&study, trial, reference);
            sum->error[k] += error;
            if (k == 0 && error > sum->largest)
                sum->largest = error;
        }
        if (scene->driver)
            *scene->driver = later;
    }
    print(&study);
    printf("a difference of 1e-12 grows at most,,%.3g,,,\n", growth(&study, trial, reference));
    if (status != GIC_OK)
        diag_fail(program_place(), NULL, "%s", gic_status_text(status));
    return 0;
}
