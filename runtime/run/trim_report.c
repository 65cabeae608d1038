/* SPDX-License-Identifier: MIT
 * Steady driving: the words of the command line, what is told of it, and the scene that goes on with it. */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "base/vec3.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/trim.h"
#include "scene/driver.h"
#include "tape/engine_tape.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- words ---------------------------------------------------------------------------------------------- */

typedef enum Key { SPEED, CURVATURE, LATERAL, GEAR, STEER, DRIVE, KEYS } Key;

static const struct {
    const char *name;
    double least, most; /* of numbers; 0, 0: a name */
} key_of[KEYS] = {
    [SPEED] = {"speed", 1e-3, 500},     [CURVATURE] = {"curvature", -10, 10},
    [LATERAL] = {"lateral", -100, 100}, [GEAR] = {"gear", -100, 100},
    [STEER] = {"steer", 0, 0},          [DRIVE] = {"drive", 0, 0},
};

static _Noreturn void refuse(const char *what)
{
    diag_fail_call(program_place(),
                   "steady driving takes speed=20 (m/s), curvature=0.01 (1/m) or lateral=4 (m/s^2), both to the left, "
                   "gear=3, steer=INPUT and drive=INPUT",
                   "%s", what);
}

static void usage(Pool *pool, const char *word, const char *what)
{
    refuse(pool_print(pool, "%s, unlike '%s'", what, word));
}

/* The key of a word, and what is behind its sign. */
static Key read_word(Pool *pool, const char *word, const char **value)
{
    const char *sign = strchr(word, '=');
    for (Key k = 0; sign && k < KEYS; ++k)
        if (strlen(key_of[k].name) == (size_t)(sign - word) && !strncmp(key_of[k].name, word, (size_t)(sign - word))) {
            *value = sign + 1;
            return k;
        }
    usage(pool, word, "no such key");
    return KEYS;
}

static double read_number(Pool *pool, const char *word, const char *value, Key key)
{
    static const char decimal[] = "0123456789+-.eE"; /* strtod() takes others, too: 0x10, inf */
    char *end;
    const double number = strtod(value, &end);
    if (*end || end == value || value[strspn(value, decimal)] ||
        !(number >= key_of[key].least && number <= key_of[key].most))
        usage(pool, word,
              pool_print(pool, "%s is a decimal number from %g to %g", key_of[key].name, key_of[key].least,
                         key_of[key].most));
    return number;
}

static int input_named(const Model *model, const char *name, const char *unit)
{
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(model->input[i].name, name) && (!unit || !strcmp(model->input[i].unit, unit)))
            return i;
    return -1;
}

/* What steers, where nobody says it: the input of the scene's driver, or the only driven coordinate. */
static int find_steering(Pool *pool, const Model *model, const Scene *scene, bool turns)
{
    int found = -1;
    if (scene && scene->driver && scene->driver->steering >= 0)
        return scene->driver->steering;
    for (int c = 0; c < model->coordinates; ++c) {
        if (!model->coordinate[c].driven)
            continue;
        if (found >= 0 && turns)
            refuse(pool_print(pool, "which input steers? steer=%s or steer=%s, for example", model->input[found].name,
                              model->coordinate[c].name));
        found = found >= 0 ? -2 : model->coordinate[c].input;
    }
    return found < 0 ? -1 : found;
}

static int read_input(Pool *pool, const Model *model, const char *name, const char *word)
{
    const int input = input_named(model, name, NULL);
    if (input < 0)
        usage(pool, word, pool_print(pool, "the model has no input '%s'", name));
    return input;
}

TrimGoal trim_goal(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const char *value[KEYS] = {NULL}, *word[KEYS] = {NULL};
    double number[KEYS] = {0};
    for (int i = 0; i < request->keys; ++i) {
        const char *text;
        const Key k = read_word(pool, request->key[i], &text);
        if (value[k])
            usage(pool, request->key[i], pool_print(pool, "%s is given twice", key_of[k].name));
        value[k] = text;
        word[k] = request->key[i];
        if (k < STEER)
            number[k] = read_number(pool, word[k], text, k);
    }
    if (!value[SPEED])
        refuse("steady driving needs a speed, speed=20 for one");
    if (value[CURVATURE] && value[LATERAL])
        usage(pool, word[LATERAL], "curvature and lateral are one thing");
    if (value[GEAR] && (!model->powertrain || number[GEAR] != round(number[GEAR]) ||
                        number[GEAR] < -model->powertrain->reverse || number[GEAR] > model->powertrain->forward))
        usage(pool, word[GEAR], "the model has no such gear");
    TrimGoal goal = {.speed = number[SPEED],
                     .curvature =
                         value[LATERAL] ? number[LATERAL] / (number[SPEED] * number[SPEED]) : number[CURVATURE],
                     .gear = value[GEAR] ? (int)number[GEAR] : TRIM_ANY_GEAR,
                     .steer = value[STEER] ? read_input(pool, model, value[STEER], word[STEER]) : -1,
                     .drive = value[DRIVE] ? read_input(pool, model, value[DRIVE], word[DRIVE]) : -1,
                     .brake = -1};
    if (!value[STEER])
        goal.steer = find_steering(pool, model, scene, goal.curvature != 0);
    if (!value[DRIVE]) {
        goal.drive = input_named(model, "accelerator", "1");
        goal.brake = goal.drive < 0 ? -1 : input_named(model, "brake", "1");
        goal.pedal = goal.drive >= 0;
    }
    if (goal.steer >= 0 && goal.steer == goal.drive)
        usage(pool, value[DRIVE] ? word[DRIVE] : word[STEER], "steer and drive are two inputs");
    return goal;
}

/* ---- what is told --------------------------------------------------------------------------------------- */

const char *trim_text(Pool *pool, const TrimGoal *goal)
{
    const double across = goal->curvature * goal->speed * goal->speed;
    if (goal->curvature == 0)
        return pool_print(pool, "steady driving at %.6g m/s straight ahead", goal->speed);
    return pool_print(pool, "steady cornering at %.6g m/s, %.6g m/s^2 to the %s (%.6g m radius)", goal->speed,
                      fabs(across), across > 0 ? "left" : "right", 1 / fabs(goal->curvature));
}

static Place place_of(const Model *model, const Scene *scene)
{
    return (Place){scene ? scene->source : model->source, 0, 0};
}

/* Warn if a small disturbance grows by more than 5 percent in a second. */
static void warn_unstable(Pool *pool, const Trim *trim, Place at)
{
    const double slowest = 0.05; /* 1/s */
    const Modes *modes = modes_find(pool, trim->found->linear, trim->found->A);
    for (int k = 0; k < modes->count; ++k)
        if (modes->mode[k].real > slowest) {
            diag_warn(at, "nothing: a controller or a driver may hold it",
                      "the motion is unstable: a disturbance grows by %.3g times in a second",
                      exp(modes->mode[k].real));
            return;
        }
}

static const Trim *find(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const TrimGoal goal = trim_goal(pool, model, scene, request);
    const Trim *trim = trim_find(pool, model, scene, request->solve, &goal);
    if (trim->shifts && !request->quiet)
        diag_warn(place_of(model, scene), "leave gear=... out", "the transmission leaves gear %d there by itself",
                  trim->gear);
    if (trim->held && fabs(trim->slowing) > equilibrium_limit && !request->quiet)
        diag_warn(place_of(model, scene), "name the input that drives: drive=NAME",
                  "nothing drives: the speed is held, and changes by %.4g m/s^2", trim->slowing);
    else if (!request->quiet)
        warn_unstable(pool, trim, place_of(model, scene));
    return trim;
}

OperatingPoint operating_point_trim(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Trim *trim = find(pool, model, scene, request);
    return (OperatingPoint){.linear = trim->found->linear,
                            .self = trim->found->self,
                            .source = scene ? scene->source : model->source,
                            .text = pool_print(pool, "about %s", trim_text(pool, &trim->goal))};
}

bool trim_file_known(const char *path)
{
    return !strcmp(path, "-") || path_ends(path, ".csv") || path_ends(path, ".scene");
}

/* Angle of the velocity of the base's origin to its heading, in the plane; to the left. */
static double sideslip(const Trim *trim)
{
    const gic_model *code = trim->found->engine->code;
    const double *y = tape_array(trim->found->self, code->state_offset), *v = y + trim->found->linear->places + 1;
    double R[9];
    mat_from_euler(y + 3, R);
    const double off = atan2(v[1], v[0]) - atan2(R[3], R[0]);
    return remainder(off, 2 * 3.141592653589793);
}

static void print_motion(Text *out, const Trim *trim)
{
    const gic_model *code = trim->found->engine->code;
    const double *input = tape_array(trim->found->self, code->input_offset);
    const int found[] = {trim->goal.steer, trim->goal.drive, trim->goal.brake};
    text_print(out, "%-24s  %.2g m/s^2 or rad/s^2\n", "largest acceleration", trim->found->residual);
    if (trim->found->model->powertrain)
        text_print(out, "%-24s  %d\n", "gear", trim->gear);
    for (size_t i = 0; i < sizeof found / sizeof *found; ++i)
        if (found[i] >= 0)
            text_print(out, "%-24s  %.9g %s\n", code->input[found[i]].name, input[found[i]] + 0.0,
                       code->input[found[i]].unit);
    text_print(out, "%-24s  %.9g rad/s\n", "yaw rate", trim->goal.curvature * trim->goal.speed);
    text_print(out, "%-24s  %.6g deg\n", "sideslip of the base", sideslip(trim) * 57.29577951308232);
}

/* ---- the scene ------------------------------------------------------------------------------------------ */

/* Inputs that are not at the model's value; of driven coordinates the value alone. */
static void write_inputs(Text *out, const Trim *trim)
{
    const Model *model = trim->found->model;
    const double *input = tape_array(trim->found->self, trim->found->engine->code->input_offset);
    bool begun = false;
    for (int i = 0; i < model->inputs; ++i) {
        bool is_rate = false;
        for (int c = 0; c < model->coordinates; ++c)
            is_rate = is_rate || (model->coordinate[c].driven &&
                                  (i == model->coordinate[c].input + 1 || i == model->coordinate[c].input + 2));
        if (is_rate || input[i] == model->input[i].initial)
            continue;
        text_print(out, "%s  %s: %.17g\n", begun ? "" : "inputs:\n", model->input[i].name, input[i]);
        begun = true;
    }
}

static void write_parameters(Text *out, const Trim *trim, const Scene *scene)
{
    const gic_model *code = trim->found->engine->code;
    for (int i = 0; scene && i < code->parameter_count; ++i)
        text_print(out, "%s  %s: %.17g\n", i ? "" : "parameters:\n", code->parameter[i].name, scene->parameter[i]);
}

static void write_road(Text *out, Pool *pool, const Scene *scene)
{
    const Plane *plane = scene_plane(pool, scene ? scene->road : NULL);
    if (plane->height != 0 || plane->friction != 1)
        text_print(out, "road: {type: flat, height: %.17g, friction: {value: %.17g}}\n", plane->height,
                   plane->friction);
}

/* A scene of ten seconds that goes on with the motion. */
static void write_scene(Pool *pool, const Trim *trim, const Scene *scene, const char *path)
{
    Text out = {.pool = pool};
    text_print(&out, "# %s: %s\ngicscene: 1\nduration: 10\nintegrator: rkck\ntolerance: 1e-9\noutput_step: 0.01\n\n",
               trim->found->model->name, trim_text(pool, &trim->goal));
    equilibrium_initial(&out, trim->found);
    text_print(&out, "\n");
    write_inputs(&out, trim);
    write_parameters(&out, trim, scene);
    write_road(&out, pool, scene);
    file_write(path, out.s, out.size);
}

void trim_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const Trim *trim = find(pool, model, scene, request);
    const char *path = request->results;
    if (!path || (strcmp(path, "-") != 0 && !request->quiet)) {
        Text out = {.pool = pool};
        text_print(&out, "%s: %s, found in %d steps\n", model->name, trim_text(pool, &trim->goal), trim->steps);
        print_motion(&out, trim);
        equilibrium_tables(&out, trim->found);
        write_inputs(&out, trim);
        diag_text(out.s);
    }
    if (path && path_ends(path, ".scene"))
        write_scene(pool, trim, scene, path);
    else if (path)
        equilibrium_row(pool, trim->found, path);
}
