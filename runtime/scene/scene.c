/* SPDX-License-Identifier: MIT
 * Scenes: models/SCENE.md. */
#include "base/text.h"
#include "base/vec3.h"
#include "base/yaml.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/limits.h"
#include "model/model.h"
#include "read/read.h"
#include "scene/action.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/hold.h"
#include "scene/replay.h"
#include "scene/scene.h"
#include "scene/sleep.h"

#include <math.h>
#include <string.h>

/* State of reading: the scene and its model. */
typedef struct Reader {
    Pool *pool;
    const Model *model;
    Scene *scene;
    bool own; /* not a file of the user's: of where it begins nobody is told */
} Reader;

const Item *scene_need(const Item *map, const char *key, const char *what)
{
    const Item *item = doc_find(map, key);
    char remedy[80];
    snprintf(remedy, sizeof remedy, "add `%s: ...`", key);
    if (!item)
        diag_fail(map->at, remedy, "%s needs the key '%s'", what, key);
    return item;
}

double scene_number(const Item *map, const char *key, const char *what, double absent)
{
    const Item *item = doc_find(map, key);
    return item ? doc_number(item, what) : absent;
}

double scene_positive(const Item *item, const char *what)
{
    double value = doc_number(item, what);
    if (value <= 0)
        diag_fail(item->at, "write a number greater than zero", "%s must be positive", what);
    return value;
}

double *scene_numbers(Pool *pool, const Item *item, const char *what, int least)
{
    if (item->kind != ITEM_LIST || item->count < least)
        diag_fail(item->at, "write [first, second, ...]", "%s must be a list of at least %d number%s", what, least,
                  least == 1 ? "" : "s");
    double *out = pool_alloc(pool, sizeof *out * (size_t)item->count);
    doc_vector(item, what, out, item->count);
    return out;
}

int scene_name_index(Pool *pool, const Item *item, const char *word, const char *kind, const char *const *name,
                     int count)
{
    for (int i = 0; i < count; ++i)
        if (!strcmp(name[i], word))
            return i;
    Text remedy = {.pool = pool};
    const char *nearest = diag_nearest(word, name, count);
    if (nearest)
        text_print(&remedy, "did you mean '%s'?", nearest);
    const int shown = count <= 20 ? count : 16;
    for (int i = 0; !nearest && i < shown; ++i)
        text_print(&remedy, "%s%s", i ? ", " : "there are: ", name[i]);
    if (!nearest && shown < count)
        text_print(&remedy, " and %d more, which gicgen --dump-model lists", count - shown);
    diag_fail(item->at, count ? remedy.s : "remove it", "the model has no %s '%s'", kind, word);
}

/* ---- time ----------------------------------------------------------------------------------------------- */

enum { AUTOMATIC = 1000 }; /* what `auto` is until the scene is read */

static const struct {
    const char *name;
    int32_t method;
} integrators[] = {{"ab3", GIC_AB3},    {"rk4", GIC_RK4},   {"ros2", GIC_ROS2},      {"ros3", GIC_ROS3},
                   {"imex", GIC_IMEX},  {"exp3", GIC_EXP3}, {"adams", METHOD_ADAMS}, {"rkck", METHOD_RKCK},
                   {"bdf", METHOD_BDF}, {"auto", AUTOMATIC}};

enum { INTEGRATORS = sizeof integrators / sizeof *integrators };

int32_t integrator_method(const char *name)
{
    for (int i = 0; i < INTEGRATORS; ++i)
        if (!strcmp(integrators[i].name, name))
            return integrators[i].method;
    return -1;
}

const char *integrator_word(int index)
{
    return index >= 0 && index < INTEGRATORS ? integrators[index].name : NULL;
}

const char *integrator_name(int32_t method)
{
    int i = 0;
    while (integrators[i].method != method)
        ++i;
    return integrators[i].name;
}

bool method_implicit(int32_t method)
{
    return method >= GIC_ROS2 && method <= GIC_EXP3;
}

bool scene_implicit(const Scene *scene)
{
    return method_implicit(scene->method);
}

int32_t scene_method_of_parts(const Scene *scene)
{
    return !scene_implicit(scene) ? GIC_RK4 : scene->method == GIC_EXP3 ? GIC_ROS3 : scene->method;
}

Place scene_place(const Scene *scene, const char *key)
{
    for (int i = 0; i < scene->root->count; ++i)
        if (!strcmp(scene->root->key[i]->text, key))
            return scene->root->key[i]->at;
    return (Place){scene->source, 0, 0};
}

void scene_no_auto(const Scene *scene, const char *what)
{
    if (scene && scene->automatic)
        diag_fail(scene_place(scene, "integrator"), "name one; `gicrun` with the scene says which one it takes",
                  "%s does not choose an integrator (auto) yet", what);
}

static void no_implicit(const Scene *scene, const char *what, const char *remedy)
{
    scene_no_auto(scene, what);
    if (scene && scene_implicit(scene))
        diag_fail(scene_place(scene, "integrator"), remedy, "%s does not take implicit steps (%s) yet", what,
                  integrator_name(scene->method));
}

void scene_no_implicit(const Scene *scene, const char *what)
{
    no_implicit(scene, what, "write `integrator: ab3` or `rk4`, with a shorter step");
}

void scene_no_implicit_engine(Pool *pool, const Scene *scene, const char *engine)
{
    no_implicit(scene, pool_print(pool, "the engine '%s'", engine),
                "take `--engine tcc` or `cc`, or write `integrator: ab3` or `rk4`, with a shorter step");
}

/* Smaller tolerances are below rounding, larger ones give useless results. */
bool tolerance_known(double tolerance)
{
    return tolerance >= 1e-13 && tolerance <= 0.1;
}

/* integrator, tolerance: replace the scene's; NULL and 0: do not. */
static void read_integrator(Reader *reader, const Item *root, const char *integrator, double tolerance)
{
    Scene *scene = reader->scene;
    const Item *method = doc_find(root, "integrator"), *limit = doc_find(root, "tolerance");
    const char *word = method ? doc_word(method, "integrator") : "ab3";
    if (integrator_method(word) < 0)
        diag_fail(method->at, "write ab3, rk4, ros2, ros3, imex, exp3, adams, rkck, bdf or auto",
                  "there is no integrator '%s'", word);
    scene->method = integrator_method(integrator ? integrator : word);
    scene->automatic = scene->method == AUTOMATIC;
    scene->method = scene->automatic ? GIC_AB3 : scene->method;
    scene->tolerance = limit ? doc_number(limit, "tolerance") : 1e-6;
    if (!tolerance_known(scene->tolerance))
        diag_fail(limit->at, "write a larger or smaller one, for example 1e-6",
                  "tolerance must be between 1e-13 and 0.1");
    if (tolerance > 0)
        scene->tolerance = tolerance;
    const bool constant = scene->method < METHOD_ADAMS;
    if (constant && limit && !integrator)
        diag_fail(limit->at, "remove it, or write `integrator: adams`", "%s has constant steps and no tolerance", word);
    if (constant && tolerance > 0)
        diag_fail(root->at, "add --integrator adams", "--tolerance, but %s has constant steps",
                  integrator_name(scene->method));
}

static const double most_steps = 1e12; /* steps of a run; a double could count further */

/* The number of constant steps in an output step. */
static void count_steps(Reader *reader, const Item *step, const Item *output)
{
    Scene *scene = reader->scene;
    if (scene->duration / scene->step > most_steps)
        diag_fail(step->at, "a longer step or a shorter duration", "the run would take more than %g steps", most_steps);
    const double steps = round(scene->output_step / scene->step);
    if (steps < 1 || fabs(steps * scene->step - scene->output_step) > 1e-9 * scene->output_step)
        diag_fail(output->at, pool_print(reader->pool, "write %.15g, or change the step", fmax(steps, 1) * scene->step),
                  "output_step must be a multiple of step (%.15g s)", scene->step);
    scene->per_output = (int64_t)steps;
}

static void read_ratio(Reader *reader, const Item *item, bool replaced)
{
    const double most = 1000, ratio = doc_number(item, "ratio");
    if (!(ratio >= 1 && ratio <= most && ratio == floor(ratio)))
        diag_fail(item->at, "write how many fast steps make a step, for example 6",
                  "ratio must be a whole number from 1 to %g", most);
    const int32_t method = reader->scene->method;
    if (method != GIC_AB3 && !method_implicit(method) && !replaced)
        diag_fail(item->at, "remove it, or write `integrator: ab3` or an implicit one",
                  "%s has one rate for everything", integrator_name(method));
    /* what is meant for explicit steps is not for implicit ones in their place */
    const Item *own = doc_find(reader->scene->root, "integrator");
    if (method == GIC_AB3 || (method_implicit(method) && own && method_implicit(integrator_method(own->text))))
        reader->scene->ratio = (int32_t)ratio;
}

static void read_keep(Reader *reader, const Item *item, bool replaced)
{
    const double keep = doc_number(item, "keep_jacobian");
    if (!(keep >= 1 && keep <= KEEP_MOST && keep == floor(keep)))
        diag_fail(item->at, "write how many steps are made with one Jacobian, for example 4",
                  "keep_jacobian must be a whole number from 1 to %d", KEEP_MOST);
    if (!scene_implicit(reader->scene) && !reader->scene->automatic && !replaced)
        diag_fail(item->at, "remove it, or write `integrator: ros2`, `ros3`, `imex` or `exp3`",
                  reader->scene->method == METHOD_BDF ? "%s decides itself how long it keeps a Jacobian"
                                                      : "%s needs no Jacobian",
                  integrator_name(reader->scene->method));
    if (reader->scene->method == GIC_EXP3 && keep == 1 && !replaced)
        diag_fail(item->at, "write 2 or more, or remove it: all steps are made with the first one then",
                  "exp3 has no new Jacobian for each step, as exponentials of it take many steps' work");
    reader->scene->keep = (int32_t)keep;
}

static void read_spread(Reader *reader, const Item *item, bool replaced)
{
    Scene *scene = reader->scene;
    const bool shares = scene_implicit(scene) && scene->method != GIC_EXP3;
    scene->spread = doc_bool(item, "spread_jacobian") && shares;
    if (!shares && !replaced && (!scene_implicit(scene) || doc_bool(item, "spread_jacobian")))
        diag_fail(item->at, "remove it, or write `integrator: ros2`, `ros3` or `imex`",
                  "spread_jacobian is for implicit steps by these");
    if (scene->spread && scene->keep < 2)
        diag_fail(item->at, "write for example `keep_jacobian: 16`, or remove it",
                  "spread_jacobian needs a Jacobian that is kept for 2 steps or more, which share its work");
}

static void read_implicit(Reader *reader, const Item *item, bool replaced)
{
    Scene *scene = reader->scene;
    const char *which = doc_word(item, "implicit");
    const bool takes = scene->automatic || (scene_implicit(scene) && scene->method != GIC_EXP3);
    if (strcmp(which, "all") && strcmp(which, "stiff"))
        diag_fail(item->at, "write `all` or `stiff`", "implicit is which states implicit steps treat so, not '%s'",
                  which);
    if (!takes && !replaced)
        diag_fail(item->at, "remove it, or write `integrator: ros2`, `ros3` or `imex`",
                  scene->method == GIC_EXP3 ? "exp3 treats all states alike" : "%s has no implicit steps of this kind",
                  integrator_name(scene->method));
    scene->stiff = takes && !strcmp(which, "stiff");
}

static void read_time(Reader *reader, const Item *root)
{
    Scene *scene = reader->scene;
    const bool constant = scene->method < METHOD_ADAMS;
    const Item *duration = scene_need(root, "duration", "the scene"), *step = doc_find(root, "step");
    const Item *output = doc_find(root, "output_step");
    if (constant)
        step = scene_need(
            root, "step",
            pool_print(reader->pool, "a scene with %s", scene->automatic ? "auto" : integrator_name(scene->method)));
    else if (!step)
        output = scene_need(root, "output_step", "a scene without step");
    scene->duration = scene_positive(duration, "duration");
    scene->step = step ? scene_positive(step, "step") : 0;
    scene->output_step = output ? scene_positive(output, "output_step") : scene->step;
    if (!(scene->duration / scene->output_step <= most_steps))
        diag_fail(duration->at, "a longer output_step or a shorter duration",
                  "the run would have more than %g output times", most_steps);
    scene->outputs = (int64_t)floor(scene->duration / scene->output_step * (1 + 1e-12) + 1e-9);
    if (!scene->outputs)
        diag_fail(duration->at, "a longer duration, or a shorter step or output_step",
                  "the scene ends before the first output at %.15g s", scene->output_step);
    if (constant)
        count_steps(reader, step, output);
}

/* ---- the initial state ---------------------------------------------------------------------------------- */

static void read_orientation(const Item *item, double e[4])
{
    CHECK_KEYS(item, "orientation", "yaw", "pitch", "roll", "euler");
    const Item *euler = doc_find(item, "euler");
    if (euler) {
        if (item->count > 1)
            diag_fail(item->at, "keep either euler, or yaw, pitch and roll", "orientation is given twice");
        doc_vector(euler, "Euler parameters", e, 4);
        double norm = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
        if (fabs(norm - 1) > 1e-6)
            diag_fail(euler->at, "divide them by it", "the norm of Euler parameters must be 1, not %.9g", norm);
        for (int i = 0; i < 4; ++i)
            e[i] /= norm;
        return;
    }
    double yaw = scene_number(item, "yaw", "yaw", 0) / 2, pitch = scene_number(item, "pitch", "pitch", 0) / 2,
           roll = scene_number(item, "roll", "roll", 0) / 2;
    double cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch), cr = cos(roll), sr = sin(roll);
    e[0] = cr * cp * cy + sr * sp * sy;
    e[1] = sr * cp * cy - cr * sp * sy;
    e[2] = cr * sp * cy + sr * cp * sy;
    e[3] = cr * cp * sy - sr * sp * cy;
}

void scene_along(Scene *scene)
{
    double A[9];
    mat_from_euler(scene->euler, A);
    const double level = hypot(A[0], A[3]), length = level * hypot(1, scene->climb);
    const bool upright = scene->rested && level > 1e-6; /* else x points up or down, and there is no heading */
    const double along[3] = {upright ? A[0] / length : A[0], upright ? A[3] / length : A[3],
                             upright ? scene->climb * level / length : A[6]};
    for (int i = 0; i < 3 && scene->along; ++i)
        scene->velocity[i] = scene->speed * along[i];
}

static void read_base(Reader *reader, const Item *initial)
{
    static const char *const keys[] = {"position", "orientation", "velocity", "speed", "angular_velocity"};
    Scene *scene = reader->scene;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; ++i) {
        const Item *item = doc_find(initial, keys[i]);
        if (item && !reader->model->free_base)
            diag_fail(item->at, "remove it: coordinates and rates alone describe the state",
                      "%s of the base, but the base of '%s' is fixed", keys[i], reader->model->name);
    }
    const Item *position = doc_find(initial, "position"), *orientation = doc_find(initial, "orientation");
    const Item *velocity = doc_find(initial, "velocity"), *speed = doc_find(initial, "speed");
    const Item *angular = doc_find(initial, "angular_velocity");
    if (position)
        doc_vector(position, "initial position", scene->position, 3);
    scene->placed = position;
    if (orientation)
        read_orientation(orientation, scene->euler);
    if (velocity && speed)
        diag_fail(speed->at, "keep one of the two", "the initial state has both velocity and speed");
    if (velocity)
        doc_vector(velocity, "initial velocity", scene->velocity, 3);
    scene->along = speed;
    scene->speed = speed ? doc_number(speed, "initial speed") : 0;
    scene_along(scene);
    if (angular)
        doc_vector(angular, "initial angular velocity", scene->angular_velocity, 3);
}

/* A map from free coordinates to numbers; `what` is "coordinate" or "rate". */
static void read_coordinates(Reader *reader, const Item *map, const char *what, double *out)
{
    const Model *model = reader->model;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(model->coordinates + 1));
    for (int i = 0; i < model->coordinates; ++i)
        name[i] = model->coordinate[i].name;
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write {name: number}", "initial %ss must be a map", what);
    for (int k = 0; k < map->count; ++k) {
        const Item *key = map->key[k];
        int i = scene_name_index(reader->pool, key, key->text, "coordinate", name, model->coordinates);
        if (model->coordinate[i].driven)
            diag_fail(key->at, "describe it under `inputs`", "coordinate '%s' is driven, not part of the state",
                      name[i]);
        out[i] = doc_number(map->value[k], pool_print(reader->pool, "initial %s of '%s'", what, name[i]));
    }
}

/* Is it the number of a controller's next sample or of a rule's next effect? They follow from the time. */
static bool counts_instants(const Model *model, int fast)
{
    for (int i = 0; i < model->controllers; ++i) {
        const Controller *controller = &model->controller[i];
        if (model->state[controller->samples].fast == fast)
            return true;
        for (int k = 0; k < controller->rules; ++k)
            if (controller->rule[k].effects >= 0 && model->state[controller->rule[k].effects].fast == fast)
                return true;
    }
    return false;
}

/* A map from fast states to numbers. */
static void read_states(Reader *reader, const Item *map, double *out)
{
    const int count = reader->model->fast_states;
    const gic_signal *signal = descriptor_fast_states(reader->pool, reader->model);
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(count + 1));
    for (int i = 0; i < count; ++i)
        name[i] = signal[i].name;
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write {name: number}", "initial states must be a map");
    for (int k = 0; k < map->count; ++k) {
        const Item *key = map->key[k];
        const int i = scene_name_index(reader->pool, key, key->text, "fast state", name, count);
        if (counts_instants(reader->model, i))
            diag_fail(key->at, "remove it: the controller's `offset` says when it samples first",
                      "'%s' follows from the time at which the run begins", name[i]);
        out[i] = doc_number(map->value[k], pool_print(reader->pool, "initial value of '%s'", name[i]));
    }
}

static void read_gear(Reader *reader, const Item *item)
{
    const Powertrain *powertrain = reader->model->powertrain;
    const double gear = doc_number(item, "gear");
    if (!powertrain)
        diag_fail(item->at, "remove it", "gear is given, but '%s' has no powertrain", reader->model->name);
    if (gear != floor(gear) || gear < -powertrain->reverse || gear > powertrain->forward)
        diag_fail(item->at, "0 is neutral, 1 the first gear", "gear must be a whole number from %d to %d",
                  -powertrain->reverse, powertrain->forward);
    reader->scene->gear = (int32_t)gear;
}

void scene_warn_range(const Coordinate *coordinate, Place at, double low, double high)
{
    if (low < coordinate->range[0] || high > coordinate->range[1])
        diag_warn(at, "the model may not reach that far; `range` of the coordinate states what it is made for",
                  "coordinate '%s' leaves its range [%g, %g]", coordinate->name, coordinate->range[0],
                  coordinate->range[1]);
}

static void read_initial(Reader *reader, const Item *initial)
{
    const Model *model = reader->model;
    Scene *scene = reader->scene;
    CHECK_KEYS(initial, "the initial state", "position", "orientation", "velocity", "speed", "angular_velocity",
               "coordinates", "rates", "states", "gear", "equilibrium");
    read_base(reader, initial);
    const Item *equilibrium = doc_find(initial, "equilibrium");
    scene->equilibrium = equilibrium && doc_bool(equilibrium, "equilibrium");
    const Item *coordinates = doc_find(initial, "coordinates"), *rates = doc_find(initial, "rates");
    const Item *states = doc_find(initial, "states");
    if (coordinates)
        read_coordinates(reader, coordinates, "coordinate", scene->value);
    if (rates)
        read_coordinates(reader, rates, "rate", scene->rate);
    if (states)
        read_states(reader, states, scene->fast);
    if (doc_find(initial, "gear"))
        read_gear(reader, doc_find(initial, "gear"));
    for (int i = 0; coordinates && i < model->coordinates; ++i) {
        const Item *item = doc_find(coordinates, model->coordinate[i].name);
        scene->given[i] = item;
        if (item && !reader->own)
            scene_warn_range(&model->coordinate[i], item->at, scene->value[i], scene->value[i]);
    }
}

/* ---- inputs --------------------------------------------------------------------------------------------- */

const Coordinate *scene_driven_by(const Model *model, int input)
{
    for (int i = 0; i < model->coordinates; ++i)
        if (model->coordinate[i].driven && model->coordinate[i].input == input)
            return &model->coordinate[i];
    return NULL;
}

void scene_check_profile(const Scene *scene, const Model *model, const Profile *profile, Place at)
{
    const Coordinate *coordinate = scene_driven_by(model, profile->input);
    if (!coordinate)
        return;
    const ProfilePeaks peaks = profile_peaks(profile, scene->duration);
    scene_warn_range(coordinate, at, peaks.low, peaks.high);
}

Profile *scene_profile(Pool *pool, const Model *model, Scene *scene, const Item *key, const char *const *name)
{
    const int i = scene_name_index(pool, key, key->text, "input", name, model->inputs);
    const char *dot = strchr(name[i], '.');
    if (dot)
        diag_fail(
            key->at,
            pool_print(pool, "describe '%.*s'; rate and acceleration follow from it", (int)(dot - name[i]), name[i]),
            "'%s' is no input of its own", name[i]);
    for (int k = 0; k < scene->profiles; ++k)
        if (scene->profile[k].input == i)
            diag_fail(key->at, "remove one of them", "input '%s' is described twice", name[i]);
    Profile *profile = POOL_PUSH(pool, scene->profile, scene->profiles);
    *profile = (Profile){.input = i,
                         .driven = scene_driven_by(model, i),
                         .unit = model->input[i].unit,
                         .offset = model->input[i].initial,
                         .end = scene->duration,
                         .until = scene->duration,
                         .model = model};
    return profile;
}

static void read_inputs(Reader *reader, const Item *map, const Item *file)
{
    const Model *model = reader->model;
    Scene *scene = reader->scene;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(model->inputs + 1));
    for (int i = 0; i < model->inputs; ++i)
        name[i] = model->input[i].name;
    if (map && map->kind != ITEM_MAP)
        diag_fail(map->at, "write {name: number or profile}", "inputs must be a map");
    for (int k = 0; map && k < map->count; ++k) {
        Profile *profile = scene_profile(reader->pool, model, scene, map->key[k], name);
        profile_read(reader->pool, map->value[k], map->key[k]->text, profile);
        scene_check_profile(scene, model, profile, map->value[k]->at);
    }
    if (file)
        scene_read_input_file(reader->pool, file, model, name, scene);
}

/* What the model's file would refuse is refused here, at the value that it follows. */
static void check_limits(const Model *model, const Scene *scene, const Item *map)
{
    BrokenLimit broken;
    const Item *key = map;
    if (!limit_broken(model, scene->parameter, &broken))
        return;
    for (int k = map->count - 1; k >= 0; --k)
        for (int i = 0; i < model->parameters; ++i)
            if (model->parameter[i].tunable && !strcmp(model->parameter[i].name, map->key[k]->text) &&
                limit_follows(model, &broken, model->parameter[i].index))
                key = map->value[k];
    diag_fail(key->at, "choose other values of the parameters", "with these parameters the model is impossible: %s",
              broken.text);
}

/* Values of tunable parameters for this scene. */
static void read_parameters(Reader *reader, const Item *map)
{
    const Model *model = reader->model;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(model->parameters + 1));
    for (int i = 0; i < model->parameters; ++i)
        name[i] = model->parameter[i].name;
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write {name: number}", "parameters must be a map");
    for (int k = 0; k < map->count; ++k) {
        const Item *key = map->key[k];
        const Parameter *parameter =
            &model->parameter[scene_name_index(reader->pool, key, key->text, "parameter", name, model->parameters)];
        if (!parameter->tunable)
            diag_fail(
                key->at,
                pool_print(reader->pool, "write `tunable: true` for it in %s, or change it there", model->source->path),
                "parameter '%s' is fixed when the code is generated", parameter->name);
        reader->scene->parameter[parameter->index] =
            doc_number(map->value[k], pool_print(reader->pool, "parameter '%s'", parameter->name));
    }
    check_limits(model, reader->scene, map);
}

void scene_inputs(void *user, int32_t lane, double time, double *input)
{
    const Scene *scene = user;
    (void)lane;
    for (int i = 0; i < scene->profiles; ++i) {
        const Profile *profile = &scene->profile[i];
        double out[3];
        profile_at(profile, time, out);
        memcpy(input + profile->input, out, (size_t)profile_orders(profile) * sizeof *out);
    }
    if (scene->driver)
        driver_inputs(scene->driver, time, input);
    if (scene->replay)
        replay_inputs(scene->replay, time, input);
    if (scene->hold)
        hold_inputs(scene->hold, scene->driver, time, input);
}

double scene_next_kink(const Scene *scene, double time)
{
    double next = scene->driver ? driver_next_kink(scene->driver, time) : INFINITY;
    for (int i = 0; i < scene->profiles; ++i)
        next = fmin(next, profile_next_kink(&scene->profile[i], time));
    return next;
}

double scene_next_knot(const Scene *scene, double time)
{
    double next = INFINITY;
    for (int i = 0; i < scene->profiles; ++i)
        if (scene->profile[i].driven)
            next = fmin(next, profile_next_knot(&scene->profile[i], time, scene->step));
    return next;
}

double scene_longest_step(const Scene *scene, double time)
{
    double longest = INFINITY;
    for (int i = 0; i < scene->profiles; ++i)
        longest = fmin(longest, profile_longest_step(&scene->profile[i], time));
    return longest;
}

double scene_quiet_until(const Scene *scene, double time)
{
    double until = scene->driver || actions_pending(scene->actions) ? time : (double)INFINITY;
    for (int i = 0; i < scene->profiles; ++i)
        until = fmin(until, profile_quiet_until(&scene->profile[i], time));
    return until;
}

/* After the ratio is known. */
static void read_most_work(Scene *scene, const Item *most, bool replaced)
{
    if (!most || (replaced && scene->method >= METHOD_ADAMS))
        return;
    const int least = GIC_LEAST_MOST(scene->ratio);
    if (scene->method >= METHOD_ADAMS)
        diag_fail(most->at, "leave it out, or take constant steps", "variable steps take as much work as they need");
    const double number = doc_number(most, "most_work"), largest = SCENE_MOST_WORK;
    if (!(number >= least && number <= largest && number == floor(number)))
        diag_fail(most->at, "steps in which nothing happens take up to 4 `ratio` + 4 evaluations",
                  "most_work must be a whole number from %d to %g", least, largest);
    scene->most_work = (int)number;
}

/* What head.locate is. */
static int locate_word(const Item *locate)
{
    static const char *const word[] = {"false", "true", "loads"};
    for (int i = 0; i < 3; ++i)
        if (locate->kind == ITEM_SCALAR && !locate->quoted && !strcmp(locate->text, word[i]))
            return i;
    diag_fail(locate->at, "write one of them, without quotes", "locate must be true, false or loads");
}

/* ---- what may be left out: SCENE.md section 9 ------------------------------------------------------------- */

static void read_skips(Reader *reader, const Item *root, bool replaced)
{
    const Item *steady = doc_find(root, "steady"), *sleep = doc_find(root, "sleep");
    Scene *scene = reader->scene;
    if (steady) {
        scene->steady = scene_positive(steady, "steady");
        if (scene->ratio == 1 && !replaced)
            diag_fail(steady->at, "add `ratio: 6`", "steady is about fast steps, of which there are none");
    }
    const Item *locate = doc_find(root, "locate");
    const int located = locate ? locate_word(locate) : 0;
    scene->locate = scene->method < METHOD_ADAMS ? located : 0;
    if (locate && !located && scene->method >= METHOD_ADAMS)
        diag_fail(locate->at, "leave it out, or take constant steps", "variable steps always end at contacts");
    read_most_work(scene, doc_find(root, "most_work"), replaced);
    if (sleep && scene->method >= METHOD_ADAMS && !replaced)
        diag_fail(sleep->at, "write `integrator: ab3` and a step", "only constant steps can be slept through");
    if (sleep && scene->method < METHOD_ADAMS)
        scene->rest = sleep_read(reader->pool, sleep, reader->model);
}

/* ---- the scene ------------------------------------------------------------------------------------------ */

/* path: for models beside it that fit better; NULL: none is looked for. */
static const Scene *scene_of(Pool *pool, const Item *root, const char *path, const Model *model, const char *integrator,
                             double tolerance)
{
    Scene *scene = pool_alloc(pool, sizeof *scene);
    Reader reader = {pool, model, scene, !path};
    const Item *other = root->kind == ITEM_MAP ? doc_find(root, "gicgen") : NULL;
    if (other && !doc_find(root, "gicscene"))
        diag_fail(other->at, "name the model first, then the scene", "this is a model, where a scene is wanted");
    CHECK_KEYS(root, "the scene", "gicscene", "description", "duration", "step", "integrator", "tolerance", "ratio",
               "steady", "sleep", "locate", "most_work", "keep_jacobian", "spread_jacobian", "implicit", "massless",
               "base", "driven", "posts", "output_step", "initial", "road", "inputs", "input_file", "driver", "course",
               "parameters", "outputs", "plot", "units", "until", "when");
    scene->source = root->at.source;
    scene->root = root;
    const Item *version = scene_need(root, "gicscene", "the scene");
    if (doc_number(version, "gicscene") != 1)
        diag_fail(version->at, "write 1, or use a newer gicrun", "this gicrun reads version 1 of the scene format");
    if (doc_find(root, "description"))
        doc_word(doc_find(root, "description"), "description");
    if (path)
        scene_check_fit(pool, root, path, model);
    read_integrator(&reader, root, integrator, tolerance);
    scene->ratio = scene->keep = 1;
    if (doc_find(root, "ratio"))
        read_ratio(&reader, doc_find(root, "ratio"), integrator);
    if (doc_find(root, "keep_jacobian"))
        read_keep(&reader, doc_find(root, "keep_jacobian"), integrator);
    if (doc_find(root, "spread_jacobian"))
        read_spread(&reader, doc_find(root, "spread_jacobian"), integrator);
    if (doc_find(root, "implicit"))
        read_implicit(&reader, doc_find(root, "implicit"), integrator);
    read_time(&reader, root);
    read_skips(&reader, root, integrator);
    scene->parameter = pool_alloc(pool, sizeof(double) * (size_t)(model->tunables + 1));
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            scene->parameter[model->parameter[i].index] = model->parameter[i].value;
    if (doc_find(root, "parameters"))
        read_parameters(&reader, doc_find(root, "parameters"));
    if (model->tuning && rig_wanted(root))
        reader.model = model = scene->fixed = model_read_fixed(pool, model, NULL, 0, scene->parameter);
    memcpy(scene->position, model->body[BODY_BASE].position, sizeof scene->position);
    memcpy(scene->euler, model->body[BODY_BASE].euler, sizeof scene->euler);
    scene->value = pool_alloc(pool, sizeof(double) * (size_t)(model->coordinates + 1));
    scene->rate = pool_alloc(pool, sizeof(double) * (size_t)(model->coordinates + 1));
    scene->given = pool_alloc(pool, sizeof(bool) * (size_t)(model->coordinates + 1));
    for (int i = 0; i < model->coordinates; ++i)
        scene->value[i] = model->coordinate[i].initial;
    scene->fast = pool_alloc(pool, sizeof(double) * (size_t)(model->fast_states + 1));
    for (int i = 0; i < model->fast_states; ++i)
        scene->fast[i] = NAN;
    scene->gear = model->powertrain ? model->powertrain->start_gear : 0;
    const Item *initial = doc_find(root, "initial"), *road = doc_find(root, "road"), *inputs = doc_find(root, "inputs");
    if (initial)
        read_initial(&reader, initial);
    if (road)
        scene->road = road_read(pool, road);
    if (inputs || doc_find(root, "input_file"))
        read_inputs(&reader, inputs, doc_find(root, "input_file"));
    if (doc_find(root, "driver"))
        scene->driver =
            driver_read(pool, doc_find(root, "driver"), model, scene->method < METHOD_ADAMS ? scene->step : 0);
    if (doc_find(root, "course"))
        scene->course = course_read(pool, doc_find(root, "course"));
    scene->actions = actions_read(pool, root, model, scene);
    rig_read(pool, root, model, scene);
    scene_read_outputs(pool, root, model, scene);
    scene_read_units(pool, root, scene);
    return scene;
}

const Scene *scene_read(Pool *pool, const char *path, const Model *model, const char *integrator, double tolerance)
{
    return scene_of(pool, doc_read(pool, path), path, model, integrator, tolerance);
}

const Scene *scene_read_text(Pool *pool, const char *name, const char *text, const Model *model)
{
    return scene_of(pool, doc_read_text(pool, name, text, strlen(text)), NULL, model, NULL, 0);
}
