/* SPDX-License-Identifier: MIT
 * Facts about a scene's whole run, on which code for this scene relies. */
#include "engine/engine.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/action.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

/* ---- outputs ---------------------------------------------------------------------------------------------------- */

/* The output that signal i is a component of; -1: it is an input. */
static int output_of(const Model *model, int signal)
{
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        if (signal < at + model->output[i].count)
            return i;
    return -1;
}

static void want(const Model *model, bool *wanted, const int *signal, int count)
{
    for (int i = 0; i < count; ++i) {
        const int output = output_of(model, signal[i]);
        if (output >= 0)
            wanted[output] = true;
    }
}

static const bool *wanted_outputs(Pool *pool, const Model *model, const Scene *scene, bool drawn)
{
    bool *wanted = pool_alloc(pool, (size_t)model->outputs + 1);
    want(model, wanted, scene->column, scene->columns);
    want(model, wanted, scene->watched, scene->watches);
    if (drawn || scene->plotted) {
        want(model, wanted, scene->curve, scene->curves);
        want(model, wanted, scene->panels ? scene->panel[0] : NULL, 2 * scene->panels);
    }
    return wanted;
}

/* ---- inputs -------------------------------------------------------------------------------------------------------
 */

static void fix_inputs(Pool *pool, const Model *model, const Scene *scene, Facts *facts)
{
    bool *fixed = pool_alloc(pool, (size_t)model->inputs + 1);
    double *value = pool_alloc(pool, ((size_t)model->inputs + 1) * sizeof *value);
    for (int i = 0; i < model->inputs; ++i) {
        fixed[i] = true;
        value[i] = model->input[i].initial;
    }
    for (int i = 0; i < scene->profiles; ++i) {
        const Profile *profile = &scene->profile[i];
        double at[3];
        profile_at(profile, 0, at);
        for (int k = 0; k < profile_orders(profile); ++k) {
            fixed[profile->input + k] = profile_is_constant(profile);
            value[profile->input + k] = at[k];
        }
    }
    if (scene->driver)
        driver_moves(scene->driver, fixed);
    actions_move(scene, fixed);
    facts->fixed = fixed;
    facts->input = value;
}

/* ---- powertrain ---------------------------------------------------------------------------------------------------
 */

/* True if a law consists of numbers, parameters and constant inputs. */
static bool law_is_fixed(const Law *law, const Facts *facts)
{
    if (law->op == LAW_INPUT)
        return facts->fixed[law->index];
    bool fixed = law->op == LAW_NUMBER || law->op == LAW_PARAMETER || law->op == LAW_CALL || law->op == LAW_TABLE;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        fixed = fixed && law_is_fixed(law->arg[i], facts);
    return fixed;
}

/* True if the transmission is in neutral at the start and the selector keeps it there (models/POWERTRAIN.md section 4).
 */
static bool stays_neutral(Pool *pool, const Model *model, const Scene *scene, const Facts *facts)
{
    const double engaging = 0.5;
    const Law *selector = model->powertrain ? model->powertrain->selector : NULL;
    if (!selector || scene->gear || !law_is_fixed(selector, facts))
        return false;
    Model now = *model;
    now.input = pool_alloc(pool, ((size_t)model->inputs + 1) * sizeof *now.input);
    now.parameter = pool_alloc(pool, ((size_t)model->parameters + 1) * sizeof *now.parameter);
    for (int i = 0; i < model->inputs; ++i) {
        now.input[i] = model->input[i];
        now.input[i].initial = facts->input[i];
    }
    for (int i = 0; i < model->parameters; ++i) {
        now.parameter[i] = model->parameter[i];
        if (now.parameter[i].tunable)
            now.parameter[i].value = scene->parameter[now.parameter[i].index];
    }
    return fabs(law_number(selector, &now)) <= engaging;
}

/* ---- road -----------------------------------------------------------------------------------------------------------
 */

const Plane *scene_plane(Pool *pool, const gic_road *road)
{
    Plane *plane = pool_alloc(pool, sizeof *plane);
    plane->friction = 1;
    if (road && road->height == gic_patched_height) {
        const gic_road_patched *patched = (const gic_road_patched *)road;
        if (patched->count)
            return NULL;
        plane->friction = patched->value;
        road = patched->under;
    } else if (road && road->friction) {
        return NULL;
    }
    if (road && road->height != gic_plane_height)
        return NULL;
    if (road) {
        const gic_road_plane *flat = (const gic_road_plane *)road;
        plane->height = flat->z0;
        plane->slope[0] = flat->sx;
        plane->slope[1] = flat->sy;
    }
    return plane;
}

/* True if nothing of the road depends on y. */
static bool is_across(const gic_road *road)
{
    const double far = 1e30; /* m, as in read_road.c; states are refused long before */
    if (!road || road->height == gic_plane_height)
        return !road || (!road->friction && ((const gic_road_plane *)road)->sy == 0);
    if (road->height == gic_patched_height) {
        const gic_road_patched *patched = (const gic_road_patched *)road;
        return !patched->count && is_across(patched->under);
    }
    if (road->friction)
        return false;
    if (road->height == gic_sine_height)
        return ((const gic_road_sine *)road)->phase_per_y == 0;
    if (road->height == gic_table_height) {
        const gic_road_table *table = (const gic_road_table *)road;
        return !memcmp(table->left, table->right, sizeof *table->left * (size_t)table->count);
    }
    bool across = road->height == gic_bumps_height || road->height == gic_sum_height;
    const gic_road_bumps *bumps = road->height == gic_bumps_height ? (const gic_road_bumps *)road : NULL;
    for (int i = 0; bumps && i < bumps->count; ++i)
        across = across && bumps->bump[i].y_low <= -far && bumps->bump[i].y_high >= far;
    const gic_road_sum *sum = road->height == gic_sum_height ? (const gic_road_sum *)road : NULL;
    for (int i = 0; sum && i < sum->count; ++i)
        across = across && is_across(sum->part[i]);
    return across;
}

/* ---- symmetry -------------------------------------------------------------------------------------------------------
 */

/* Largest deviation of a static equilibrium from symmetry that is taken for rounding and removed. */
static const double uneven = 1e-9;

/* A part of the base's motion or of the road that deviates from symmetry by more than `most`; NULL: none. */
static const char *asymmetry_of(const Model *model, const Scene *scene, bool across, double most)
{
    const double *euler = scene->euler, *omega = scene->angular_velocity;
    if (!(fabs(euler[1]) <= most && fabs(euler[3]) <= most))
        return "the vehicle is turned about x or z at the beginning";
    if (!(fabs(scene->velocity[1]) <= most && fabs(omega[0]) <= most && fabs(omega[2]) <= most))
        return "the vehicle does not move straight ahead at the beginning";
    if (model->controllers)
        return "the model has controllers, which are not looked through";
    if (scene->posts)
        return "wheels stand on posts";
    return model->wheels && !across ? "the road is not known to be the same on both sides" : NULL;
}

const Scene *scene_even(Pool *pool, const Model *model, const Scene *given)
{
    const char *why = NULL;
    const Mirror *mirror = model->free_base ? mirror_find(pool, model, &why) : NULL;
    if (!mirror || asymmetry_of(model, given, true, uneven))
        return given;
    Scene *scene = pool_alloc(pool, sizeof *scene);
    *scene = *given;
    const double norm = hypot(scene->euler[0], scene->euler[2]);
    scene->euler[0] /= norm;
    scene->euler[2] /= norm;
    scene->euler[1] = scene->euler[3] = scene->velocity[1] = 0;
    scene->angular_velocity[0] = scene->angular_velocity[2] = 0;
    scene->value = memcpy(pool_alloc(pool, sizeof(double) * (size_t)(model->coordinates + 1)), scene->value,
                          sizeof(double) * (size_t)model->coordinates);
    scene->rate = memcpy(pool_alloc(pool, sizeof(double) * (size_t)(model->coordinates + 1)), scene->rate,
                         sizeof(double) * (size_t)model->coordinates);
    scene_along(scene);
    for (int w = 0; w < model->coordinates; ++w) {
        const int of = mirror->coordinate[w];
        const double sign = mirror->sign[w];
        const bool odd = of == w && sign < 0;
        const double value = odd ? 0 : sign * scene->value[of], rate = odd ? 0 : sign * scene->rate[of];
        if (of <= w && fabs(scene->value[w] - value) <= uneven && fabs(scene->rate[w] - rate) <= uneven) {
            scene->value[w] = value;
            scene->rate[w] = rate;
        }
    }
    return scene;
}

const Facts *scene_facts(Pool *pool, const Model *model, const Scene *scene, const char *path, bool drawn)
{
    Facts *facts = pool_alloc(pool, sizeof *facts);
    const char *slash = strrchr(path, '/');
    facts->scene = slash ? slash + 1 : path;
    facts->massless = scene->massless;
    facts->lost = scene->lost;
    facts->massless_names = scene->massless_names;
    facts->wanted = wanted_outputs(pool, model, scene, drawn);
    facts->parameter = scene->parameter;
    facts->idle = true; /* scenes can not use ports */
    facts->plane = scene_plane(pool, scene->road);
    fix_inputs(pool, model, scene, facts);
    facts->across = !facts->plane && is_across(scene->road);
    facts->asymmetry = asymmetry_of(model, scene, is_across(scene->road), 0);
    facts->value = scene->value;
    facts->rate = scene->rate;
    facts->state = scene->fast;
    facts->neutral = stays_neutral(pool, model, scene, facts);
    return facts;
}

/* ---- the scene, for such code */

/* -1: code for the scene does not compute it. */
static int signal_place(const Scene *scene, int i, const gic_model *code, int outputs)
{
    for (int place = 0; i < outputs && place < code->output_count; ++place)
        if (!strcmp(code->output[place].name, scene->signal[i].name))
            return place;
    return i < outputs ? -1 : code->output_count + i - outputs;
}

static void narrow_list(Pool *pool, const Scene *scene, const gic_model *code, int outputs, int **list, int *count)
{
    int *kept = pool_alloc(pool, sizeof *kept * (size_t)(*count + 1)), places = 0;
    for (int i = 0; i < *count; ++i) {
        kept[places] = signal_place(scene, (*list)[i], code, outputs);
        places += kept[places] >= 0;
    }
    *list = kept;
    *count = places;
}

const Scene *scene_narrow(Pool *pool, const Scene *scene, const Model *model, const Engine *engine)
{
    const gic_model *code = engine->code;
    if (!engine->facts)
        return scene;
    Scene *narrow = pool_alloc(pool, sizeof *narrow);
    gic_signal *signal = pool_alloc(pool, sizeof *signal * (size_t)(code->output_count + code->input_count + 1));
    *narrow = *scene;
    memcpy(signal, code->output, sizeof *signal * (size_t)code->output_count);
    memcpy(signal + code->output_count, scene->signal + model->output_components,
           sizeof *signal * (size_t)model->inputs);
    narrow->signal = signal;
    narrow_list(pool, scene, code, model->output_components, &narrow->column, &narrow->columns);
    narrow_list(pool, scene, code, model->output_components, &narrow->curve, &narrow->curves);
    narrow_list(pool, scene, code, model->output_components, &narrow->watched, &narrow->watches);
    int *axis = scene->panels ? scene->panel[0] : NULL, axes = 2 * scene->panels;
    narrow_list(pool, scene, code, model->output_components, &axis, &axes);
    narrow->panel = (int(*)[2])axis;
    narrow->panels = axes / 2; /* all panels or none */
    if (engine->facts->plane)  /* the road is part of the code */
        narrow->road = NULL;
    return narrow;
}

/* ---- for the validation of such code --------------------------------------------------------------------------------
 */

const Validation *scene_validation(Pool *pool, const Model *model, const Scene *scene)
{
    Validation *validation = pool_alloc(pool, sizeof *validation);
    bool *driven = pool_alloc(pool, (size_t)model->inputs + 1);
    double *moment = NULL;
    *validation = (Validation){
        .inputs = scene_inputs, .context = (void *)scene, .road = scene->road, .duration = scene->duration};
    for (int i = 0; i < model->inputs; ++i)
        driven[i] = true;
    if (scene->driver)
        driver_moves(scene->driver, driven);
    for (int i = 0; i < model->inputs; ++i)
        driven[i] = !driven[i];
    for (double time = scene_next_kink(scene, 0); time < scene->duration && validation->moments < 64;
         time = scene_next_kink(scene, time))
        *POOL_PUSH(pool, moment, validation->moments) = time;
    validation->moment = moment;
    validation->free = driven;
    return validation;
}
