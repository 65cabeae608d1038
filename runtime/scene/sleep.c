/* SPDX-License-Identifier: MIT
 * Vehicles at rest that sleep (models/SCENE.md section 9): steps that keep the state and cost next to nothing,
 * until an input changes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "scene/scene.h"
#include "scene/sleep.h"

#include <math.h>
#include <string.h>

static const double rounding = 1e-9; /* relative to a time: differences of times have this accuracy */

/* ---- what is compared ------------------------------------------------------------------------------------------- */

/* Record all numbers besides the state that a rate can depend on. */
static void note_surroundings(Sleep *rest, const gic_model *model, gic_head *self)
{
    const double *const array[] = {instance_array(self, model->input_offset),
                                   instance_array(self, model->parameter_offset),
                                   instance_array(self, model->port_offset)};
    const int count[] = {model->input_count, model->parameter_count, model->port_count};
    double *next = rest->around;
    for (int k = 0; k < 3; ++k) {
        memcpy(next, array[k], sizeof *next * (size_t)count[k]);
        next += count[k];
    }
    rest->road = self->road;
    for (int i = 0; i < model->discrete_count; ++i)
        rest->discrete[i] = ((const int32_t *)(const void *)((const char *)self + model->discrete_offset))[i];
}

static bool surroundings_stay(const Sleep *rest, const gic_model *model, gic_head *self)
{
    const double *const array[] = {instance_array(self, model->input_offset),
                                   instance_array(self, model->parameter_offset),
                                   instance_array(self, model->port_offset)};
    const int count[] = {model->input_count, model->parameter_count, model->port_count};
    const double *next = rest->around;
    for (int k = 0; k < 3; ++k) {
        if (memcmp(next, array[k], sizeof *next * (size_t)count[k]))
            return false;
        next += count[k];
    }
    return rest->road == self->road && !memcmp(rest->discrete, (const char *)self + model->discrete_offset,
                                               sizeof *rest->discrete * (size_t)model->discrete_count);
}

/* The state that grows with time at rest, the time since a shift: the one whose unit is a time. -1: none. */
static int clock_of(const gic_model *model)
{
    int i = model->slow_count + model->fast_count - 1;
    while (i >= 0 && strcmp(model->state[i].unit, "s") != 0)
        --i;
    return i;
}

static bool state_stays(const Sleep *rest, const gic_model *model, gic_head *self)
{
    const double *state = instance_array(self, model->state_offset);
    for (int i = 0; i < model->slow_count + model->fast_count; ++i)
        if (!(fabs(state[i] - rest->state[i]) <= rest->within) && i != rest->clock)
            return false;
    return true;
}

static void note_state(Sleep *rest, const gic_model *model, gic_head *self)
{
    const size_t count = (size_t)(model->slow_count + model->fast_count);
    memcpy(rest->state, instance_array(self, model->state_offset), sizeof *rest->state * count);
    rest->since = gic_time(self);
}

/* ---- a run ------------------------------------------------------------------------------------------------------ */

void sleep_start(Sleep *rest, const gic_model *model, gic_head *self)
{
    const size_t around = (size_t)(model->input_count + model->parameter_count + model->port_count);
    if (rest->model != model) {
        rest->model = model;
        rest->state = pool_alloc(rest->pool, sizeof *rest->state * (size_t)(model->slow_count + model->fast_count + 1));
        rest->around = pool_alloc(rest->pool, sizeof *rest->around * (around + 1));
        rest->input = pool_alloc(rest->pool, sizeof *rest->input * (size_t)(model->input_count + 1));
        rest->discrete = pool_alloc(rest->pool, sizeof *rest->discrete * (size_t)(model->discrete_count + 1));
    }
    rest->clock = clock_of(model);
    rest->asleep = false;
    rest->slumbers = 0;
    note_surroundings(rest, model, self);
    note_state(rest, model, self);
}

/* True if all inputs are constant until the end of a step from now. */
static bool inputs_stay(Sleep *rest, const gic_model *model, gic_head *self, const Scene *scene, double end)
{
    if (end <= rest->quiet)
        return true;
    const double *input = instance_array(self, model->input_offset);
    const size_t size = sizeof *input * (size_t)model->input_count;
    memcpy(rest->input, input, size);
    self->input_function(self->user, self->lane, end, rest->input);
    rest->quiet = scene_quiet_until(scene, end);
    return !memcmp(rest->input, input, size);
}

bool sleep_step(Sleep *rest, const gic_model *model, const Scene *scene, gic_head *self)
{
    if (!rest->asleep)
        return false;
    const double end = gic_time(self) + scene->step;
    if (!inputs_stay(rest, model, self, scene, end) || !surroundings_stay(rest, model, self)) {
        rest->asleep = false;
        self->history = 0; /* the integrator starts anew */
        note_state(rest, model, self);
        return false;
    }
    ++self->steps;
    ++self->sleep_count;
    if (rest->clock >= 0)
        ((double *)instance_array(self, model->state_offset))[rest->clock] += scene->step;
    return true;
}

void sleep_watch(Sleep *rest, const gic_model *model, gic_head *self)
{
    if (!surroundings_stay(rest, model, self)) {
        note_surroundings(rest, model, self);
        note_state(rest, model, self);
    } else if (!state_stays(rest, model, self)) {
        note_state(rest, model, self);
    } else if (gic_time(self) - rest->since >= (1 - rounding) * rest->after) {
        rest->asleep = true;
        ++rest->slumbers;
        rest->quiet = -INFINITY;
    }
}
