/* SPDX-License-Identifier: MIT
 * The vehicle of a manoeuvre: what can steer, drive and brake it; scenes that begin straight ahead, in the right gear.
 */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/manoeuvre.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* The base's axes at design are those of the drawing; place and coordinates of rest as keys of `initial`. Wherever the
 * vehicle is drawn, it begins with its centre of mass at x = 0 and the middle between its wheels at y = 0. */
static const char *rest_of(TestCar *car)
{
    const Model *model = car->model;
    const double *state = tape_array(car->sheet.found->self, car->sheet.found->engine->code->state_offset);
    const double beside[3] = {0, kc_middle_of(model) - model->body[BODY_BASE].position[1], 0};
    double A[9], com[3], middle[3];
    Text text = {.pool = car->pool};
    mat_from_euler(state + 3, A);
    apply3(A, car->com, com);
    apply3(A, beside, middle);
    text_print(&text, "  position: [%.17g, %.17g, %.17g]\n  orientation: {euler: [%.17g, %.17g, %.17g, %.17g]}\n",
               -com[0] + 0.0, -middle[1] + 0.0, state[2], state[3], state[4], state[5], state[6]);
    bool any = false;
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven) {
            text_print(&text, "%s%s: %.17g", any ? ", " : "  coordinates: {", model->coordinate[c].name,
                       car->sheet.w[c]);
            any = true;
        }
    text_print(&text, "%s", any ? "}\n" : "");
    return text.s;
}

/* An input of unit 1 with this name; -1: there is none. */
static int pedal(const Model *model, const char *name)
{
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(model->input[i].name, name) && !strcmp(model->input[i].unit, "1"))
            return i;
    return -1;
}

static void find_loads(TestCar *car)
{
    const Model *model = car->model;
    car->load = pool_alloc(car->pool, (size_t)(model->wheels + 1) * sizeof *car->load);
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        if (model->output[i].type == OUTPUT_WHEEL)
            car->load[model->output[i].index] = at;
}

/* The coordinates that move wheels up and down, by their names. */
static void find_travel(TestCar *car)
{
    const Kc *kc = car->sheet.kc;
    car->travel = pool_alloc(car->pool, (size_t)(car->model->wheels + 1) * sizeof *car->travel);
    for (int w = 0; w < car->model->wheels; ++w) {
        car->travel[w] = -1;
        for (int a = 0; a < kc->axles; ++a)
            for (int k = 0; k < kc->axle[a].wheels && !kc->axle[a].refusal; ++k)
                for (int i = 0; i < kc->axle[a].wheel[k].parts; ++i)
                    if (!strcmp(kc->axle[a].wheel[k].part[i]->name, car->model->wheel[w].name))
                        car->travel[w] = kc->axle[a].travel[k];
    }
}

static void find_steering(TestCar *car)
{
    const Model *model = car->model;
    car->axle = sheet_steered(&car->sheet, &car->angle, &car->unsteered, &car->steer_remedy);
    car->steering = -1;
    if (!car->axle)
        return;
    const Coordinate *c = &model->coordinate[car->axle->steer];
    car->steering = c->input;
    car->straight = model->input[c->input].initial;
    for (int i = 0; i < 2; ++i)
        car->range[i] = (c->range[i] - car->straight) * car->angle;
    if (car->range[0] > car->range[1]) {
        const double low = car->range[1];
        car->range[1] = car->range[0];
        car->range[0] = low;
    }
}

static void open_engine(TestCar *car, const Model *model)
{
    const Request *request = car->request;
    car->engine = engine_open(car->pool, request->engine, model,
                              &(EngineOptions){.solve = request->solve,
                                               .recovery = request->recovery,
                                               .compiler = request->compiler,
                                               .flags = request->flags,
                                               .quiet = request->quiet});
    car->code = car->engine->code;
}

TestCar *car_open(Pool *pool, const Model *model, const Request *request)
{
    TestCar *car = pool_alloc(pool, sizeof *car);
    const double *e = model->body[BODY_BASE].euler;
    *car = (TestCar){.pool = pool, .request = request, .sheet = sheet_open(pool, model, NULL, request->solve)};
    car->units = units_find(&car->sheet);
    if (car->units) { /* the linear model also tells how the last unit moves */
        car->unit = model->output_components;
        model = model_watch_body(pool, model, car->units->body, car->units->last);
        car->sheet = sheet_open(pool, model, NULL, request->solve);
    }
    car->model = model_watch_wheels(pool, model);
    find_loads(car);
    find_travel(car);
    if (fabs(fabs(e[0]) - 1) > equilibrium_limit)
        car_refuse(car, "leave out `orientation` of the base", "the axes of the base are not those of the drawing");
    for (int w = 0; w < model->wheels; ++w)
        if (model->wheel[w].tire < 0)
            car_refuse(car, "give its wheels the key `tire`",
                       pool_print(pool, "wheel '%s' has no tire", model->wheel[w].name));
    sub3(car->sheet.com, model->body[BODY_BASE].position, car->com);
    if (car->units)
        copy3(car->units->first, car->com);
    car->accelerator = pedal(model, "accelerator");
    car->brake = pedal(model, "brake");
    find_steering(car);
    car->rest = rest_of(car);
    car->running = "";
    car->pedals = pedal_driver_first;
    car->output_step = 0.01;
    open_engine(car, car->model);
    return car;
}

const Model *car_stand_on_posts(TestCar *car, const char *text, const Scene **scene)
{
    *scene = scene_read_text(car->pool, "the scene on posts", text, car->model);
    const Model *posted = scene_rig(car->pool, car->model, scene);
    engine_rest(car->engine);
    engine_close(car->engine);
    open_engine(car, posted);
    return posted;
}

void car_refuse(const TestCar *car, const char *remedy, const char *what)
{
    diag_fail((Place){car->model ? car->model->source : NULL, 0, 0}, remedy, "%s", what);
}

void car_need_origin(const TestCar *car)
{
    static const double near_enough = 0.1; /* m */
    const double *origin = car->model->body[BODY_BASE].position, beside = origin[1] - kc_middle_of(car->model);
    if (fabs(beside) > near_enough || fabs(car->com[0]) > car->sheet.wheelbase)
        car_refuse(
            car, "give the base a `position` between its wheels",
            pool_print(
                car->pool,
                "drivers steer and keep a speed by the base's origin, and that of body '%s' is %.3g m aside of the "
                "middle between the wheels and %.3g m from the centre of mass along x",
                car->model->body[BODY_BASE].name, fabs(beside), fabs(car->com[0])));
}

void car_need_steering(const TestCar *car)
{
    if (!car->axle)
        car_refuse(car, car->steer_remedy, pool_print(car->pool, "the vehicle can't be steered: %s", car->unsteered));
    car_need_origin(car);
}

void car_need_drive(const TestCar *car)
{
    if (car->accelerator < 0)
        car_refuse(car, "add it to `inputs` and to formulas of `drive`, or a powertrain that reads it",
                   "nothing drives the vehicle: the model has no input 'accelerator' of unit 1");
}

void car_need_brake(const TestCar *car)
{
    if (car->brake < 0)
        car_refuse(car, "add it to `inputs` and to formulas of `brake` of wheels",
                   "nothing brakes the vehicle: the model has no input 'brake' of unit 1");
}

const char *car_scene(TestCar *car, double duration, double speed, bool drives, const char *more)
{
    Text text = {.pool = car->pool};
    text_print(&text,
               "gicscene: 1\nduration: %.9g\nintegrator: rkck\ntolerance: 1e-6\noutput_step: %g\n"
               "initial:\n%s  velocity: [%.17g, 0, 0]\n%s",
               duration, car->output_step, car->rest, speed, speed > 0 ? car->running : "");
    if (drives && car->accelerator >= 0 && car->brake >= 0)
        text_print(&text, "driver:\n%s", car_pedals(car, pool_print(car->pool, "%.17g", speed)));
    text_print(&text, "%s", more ? more : "");
    return text.s;
}

/* ---- straight ahead ------------------------------------------------------------------------------------- */

/* Beyond these the vehicle does not run straight: m/s^2 across, m of the circle's radius. The mean of so long, s, after
 * so long with free pedals. */
static const double most_across = 0.5, least_radius = 200, looked = 1, coasting = 4;

static double last_mean(const Trial *trial, Channel channel)
{
    const double end = trial->row[trial->rows - 1][TRIAL_TIME];
    return trial_mean(trial, channel, end - looked, end);
}

static bool is_half(void *context, const Trial *trial)
{
    return trial->row[trial->rows - 1][TRIAL_SPEED] < 0.5 * *(const double *)context;
}

/* Straight ahead with free pedals, down to half the speed. */
static const Trial *roll(TestCar *car, double speed, const char *more)
{
    return trial_run(car, "rolling", car_scene(car, coasting, speed, false, more), is_half, &speed);
}

/* The value of the steering with which it runs straight at a speed, by secants from the trial at hand. False: none was
 * found within its range. */
static bool find_centre(TestCar *car, const Trial *trial, double speed, double *value)
{
    enum { TRIES = 8 };
    static const double near = 3e-4; /* of what it turns */
    const Coordinate *c = &car->model->coordinate[car->axle->steer];
    double by_ay = car_angle_by_acceleration(car, speed), at[2], ay[2];
    if (isnan(by_ay))
        by_ay = car->sheet.wheelbase / (speed * speed);
    at[0] = car->straight;
    ay[0] = last_mean(trial, TRIAL_AY);
    at[1] = at[0] - ay[0] * by_ay / car->angle;
    const double enough = near * fabs(ay[0]);
    for (int k = 0; k < TRIES && at[1] > c->range[0] && at[1] < c->range[1]; ++k) {
        const char *more = pool_print(car->pool, "inputs: {%s: %.17g}\n", car->model->input[car->steering].name, at[1]);
        trial = roll(car, speed, more);
        ay[1] = last_mean(trial, TRIAL_AY);
        *value = at[1];
        if (trial->end || trial->tipped || ay[1] == ay[0])
            return false;
        if (fabs(ay[1]) < enough)
            return true;
        const double next = at[1] - ay[1] * (at[1] - at[0]) / (ay[1] - ay[0]);
        at[0] = at[1];
        ay[0] = ay[1];
        at[1] = next;
    }
    return false;
}

/* What makes a vehicle run straight that does not. */
static const char *straightening(TestCar *car, const Trial *trial, double speed)
{
    double value;
    if (!car->axle)
        return "make left and right the same: what `gicrun --sheet` says of the wheels";
    const Coordinate *c = &car->model->coordinate[car->axle->steer];
    if (!find_centre(car, trial, speed, &value))
        return pool_print(
            car->pool,
            "centre the steering by `initial` of coordinate '%s', make left and right the same, or choose "
            "a lower speed",
            c->name);
    const double grain = 1e-4 * (c->range[1] - c->range[0]);
    return pool_print(car->pool, "centre the steering: `initial: %.6g` in coordinate '%s'",
                      grain * round(value / grain) + 0.0, c->name);
}

/* True: what was driven straight ahead is near enough to it. */
static bool is_straight(TestCar *car, const Trial *trial, double speed, const char **why)
{
    const double ay = last_mean(trial, TRIAL_AY), r = last_mean(trial, TRIAL_YAW_RATE);
    const double v = last_mean(trial, TRIAL_SPEED), radius = v > 0.3 * speed ? fabs(v / r) : INFINITY;
    car->aside[0] = ay;
    car->aside[1] = -last_mean(trial, TRIAL_ROLL);
    car->aside[2] = speed;
    if (fabs(ay) <= most_across && !(radius < least_radius))
        return true;
    const char *steered = "";
    if (car->axle)
        steered = pool_print(car->pool, " with %s at %.6g %s, as it is set up", car->model->input[car->steering].name,
                             car->straight, car->model->input[car->steering].unit);
    *why = pool_print(car->pool,
                      "the vehicle does not run straight ahead%s: at %.4g m/s it turns to the %s by %.3g m/s^2, in a "
                      "circle of %.3g m radius",
                      steered, speed, r > 0 ? "left" : "right", fabs(ay), radius);
    car->remedy = straightening(car, trial, speed);
    return false;
}

bool car_runs_straight(TestCar *car, double speed, const char **why)
{
    const Trial *trial = roll(car, speed, NULL);
    return trial->end /* which the manoeuvre tells */ || is_straight(car, trial, speed, why);
}

/* ---- the right gear ------------------------------------------------------------------------------------- */

/* Lasts as long as it takes, s; near enough, m/s and m/s^2; for so long, rows. */
static const double settling = 40, slow = 0.05, quiet = 0.05;
enum { LONG_ENOUGH = 200 };

typedef struct Settled {
    double speed;
    int rows;
} Settled;

static bool is_settled(void *context, const Trial *trial)
{
    Settled *settled = context;
    const double *row = trial->row[trial->rows - 1];
    const bool good = fabs(row[TRIAL_SPEED] - settled->speed) < slow && fabs(row[TRIAL_AX]) < quiet;
    settled->rows = good ? settled->rows + 1 : 0;
    return settled->rows >= LONG_ENOUGH;
}

/* A drive straight ahead until the speed is kept: by the gains that serve most vehicles, and where these do not keep it
 * by those that are found where they have brought it. */
static const Trial *settle(TestCar *car, double speed, Settled *settled)
{
    car->settling = NULL;
    car->pedals = pedal_driver_first;
    for (int tries = 0;; ++tries) {
        const Trial *trial =
            trial_run(car, "settling", car_scene(car, settling, speed, true, NULL), is_settled, settled);
        car->settling = trial->end ? NULL : trial;
        car->settled = speed;
        if (settled->rows >= LONG_ENOUGH || trial->end || tries > 0)
            return trial;
        settled->rows = 0;
    }
}

bool car_keeps(TestCar *car, double speed, const char **why)
{
    const Powertrain *powertrain = car->model->powertrain;
    Settled settled = {.speed = speed};
    car->remedy = NULL;
    if (!(speed > 0) || car->settled == speed)
        return true;
    if (car->accelerator < 0 || car->brake < 0) {
        if (!car_runs_straight(car, speed, why))
            return false;
        car->settled = speed;
        return true;
    }
    const Trial *trial = settle(car, speed, &settled);
    car->reached = trial->row[trial->rows - 1][TRIAL_SPEED];
    const bool straight = is_straight(car, trial, speed, why);
    if (!straight || settled.rows < LONG_ENOUGH) {
        car->settling = NULL;
        car->settled = 0;
        if (!straight)
            return false;
        car->remedy =
            car->reached > 0.1 * speed
                ? pool_print(car->pool, "choose a speed that it keeps: speed=%.3g", 0.9 * car->reached)
                : "does `accelerator` drive it forwards, and `brake` not hold it at 0? see the torques of its wheels";
        *why = trial->end ? trial->end
                          : pool_print(car->pool,
                                       "the vehicle does not keep %.4g m/s straight ahead: after %g s it has %.4g m/s",
                                       speed, settling, car->reached);
        return false;
    }
    car->settled = speed;
    if (!powertrain)
        return true;
    const gic_signal *name = descriptor_fast_states(car->pool, car->model);
    const int at = powertrain->fast + POWERTRAIN_SPEED;
    const double *fast = trial->state + car->engine->standard_count - car->code->fast_count;
    car->running = pool_print(car->pool, "  gear: %d\n  states: {%s: %.17g}\n", trial->gear, name[at].name, fast[at]);
    return true;
}

void car_settle(TestCar *car, double speed)
{
    const char *why;
    if (!car_keeps(car, speed, &why))
        car_refuse(car, car->remedy, why);
}

/* ---- steering ------------------------------------------------------------------------------------------- */

double car_steering(const TestCar *car, double angle)
{
    return car->straight + angle / car->angle;
}

double car_angle_by_acceleration(const TestCar *car, double speed)
{
    double *z = pool_alloc(car->pool, (size_t)car->sheet.found->linear->count * sizeof *z);
    if (sheet_respond(&car->sheet, car->axle->steer, speed, z, NULL) != GIC_OK)
        return NAN;
    const double by_unit = speed * sheet_yaw_rate(&car->sheet, z);
    return by_unit * car->angle > 0 ? car->angle / by_unit : NAN;
}
