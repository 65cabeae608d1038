/* SPDX-License-Identifier: MIT
 * Where a scene has the numbers by which runs are differentiated: values and rates of coordinates, parameters, values
 * of profiles. */
#include "run/number_place.h"
#include "base/message.h"
#include "host/host.h"
#include "scene/profile.h"

#include <string.h>

static double *copied(Pool *pool, const double *from, int count)
{
    double *to = pool_alloc(pool, ((size_t)count + 1) * sizeof *to);
    return memcpy(to, from, (size_t)count * sizeof *to);
}

Scene *scene_with_numbers(Pool *pool, const Model *model, const Scene *scene)
{
    Scene *copy = pool_alloc(pool, sizeof *copy);
    const size_t profiles = (size_t)scene->profiles * sizeof *scene->profile, given = (size_t)model->coordinates;
    *copy = *scene;
    copy->value = copied(pool, scene->value, model->coordinates);
    copy->rate = copied(pool, scene->rate, model->coordinates);
    copy->parameter = copied(pool, scene->parameter, model->tunables);
    copy->given = memcpy(pool_alloc(pool, given + 1), scene->given, given);
    copy->profile = pool_alloc(pool, profiles + 1);
    if (profiles)
        memcpy(copy->profile, scene->profile, profiles);
    for (int i = 0; i < copy->profiles; ++i)
        if (copy->profile[i].form == PROFILE_KNOTS)
            copy->profile[i].value = copied(pool, scene->profile[i].value, copy->profile[i].count);
    return copy;
}

const Scene *scene_renewed(const Scene *copy, Scene *running)
{
    Profile *profile = running->profile;
    *running = *copy;
    running->profile = profile;
    if (copy->profiles)
        memcpy(profile, copy->profile, (size_t)copy->profiles * sizeof *profile);
    return running;
}

/* The value or rate of a coordinate, of which the scene has the numbers from now on. */
static double *initial_number(const Model *model, const Scene *copy, const RunVariable *v)
{
    int place = model->free_base ? 6 : 0, places = place; /* small motions: those of the base first */
    for (int c = 0; c < model->coordinates; ++c)
        places += !model->coordinate[c].driven;
    for (int c = 0; c < model->coordinates; ++c) {
        if (model->coordinate[c].driven)
            continue;
        if (v->index == places + place)
            return &copy->rate[c];
        if (v->index == place++) {
            copy->value[c] = copy->given[c] ? copy->value[c] : v->value;
            copy->given[c] = true;
            return &copy->value[c];
        }
    }
    return NULL;
}

static double *input_number(const Scene *copy, const RunVariable *v)
{
    Profile *profile = NULL;
    for (int i = 0; i < copy->profiles; ++i)
        profile = copy->profile[i].input == v->index ? &copy->profile[i] : profile;
    if (!profile)
        return NULL;
    return profile->form == PROFILE_KNOTS ? &profile->value[v->number]
           : v->number                    ? &profile->offset
                                          : &profile->amplitude;
}

double *number_place(const Model *model, const Scene *copy, const RunVariable *v)
{
    return v->kind == BY_PARAMETER ? &copy->parameter[v->index]
           : v->kind == BY_INITIAL ? initial_number(model, copy, v)
                                   : input_number(copy, v);
}

void number_places_check(const Model *model, const Scene *copy, const RunVariable *variable, int variables,
                         const char *option)
{
    for (int k = 0; k < variables; ++k)
        if (!number_place(model, copy, &variable[k]))
            diag_fail_call(program_place(),
                           "parameter/NAME, initial/NAME and initial/NAME.rate of coordinates, and numbers of inputs "
                           "that the scene sets",
                           "%s does not find '%s'", option, variable[k].name);
}
