/* SPDX-License-Identifier: MIT
 * Wheels with tires and the powertrain apart from the bodies that carry them, for dual rate: models/TIRES.md section 9.
 */
#include "compare/interpreted.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/wheel.h"
#include "world/world.h"

#include <string.h>

static const Interpreted *context_of(const Instance *self)
{
    return self->context;
}

int interpreted_link_count(const Model *model)
{
    int rolling = 0;
    for (int i = 0; i < model->wheels; ++i)
        rolling += model->wheel[i].tire >= 0;
    return MOTION_NUMBERS * rolling + model->signals + 2 * model->coordinates;
}

int interpreted_link(void *instance, double time, const double *slow, double *link)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const World *world = context->world;
    const size_t coordinates = (size_t)world->model->coordinates;
    const int32_t count = context->code.link_count;
    double found[count], *next = found;
    int status = gic_bounded(slow, context->code.slow_count) ? interpreted_load(self, time) : GIC_ERROR_INPUT;
    if (status == GIC_OK)
        status = context->place(context, self, slow);
    if (status != GIC_OK)
        return self->head.status = status;
    for (int i = 0; i < world->model->wheels; ++i)
        if (world->model->wheel[i].tire >= 0) {
            WheelMotion motion;
            world_wheel_motion(world, i, &motion);
            memcpy(next, &motion, sizeof motion);
            next += MOTION_NUMBERS;
        }
    for (int i = 0; i < world->model->signals; ++i) {
        const Signal *signal = &world->model->signal[i];
        const bool motion = !signal->law && output_is_motion(signal->output.type, signal->component);
        *next++ = motion ? world_signal(world, i) : 0;
    }
    memcpy(next, world->x, sizeof *link * coordinates);
    memcpy(next + coordinates, world->xd, sizeof *link * coordinates);
    if (!gic_finite(found, count))
        return self->head.status = GIC_ERROR_RESULT;
    memcpy(link, found, sizeof found);
    return self->head.status = GIC_OK;
}

/* What formulas may ask for: free coordinates from the links, driven ones from the inputs of the moment. */
static void set_coordinates(World *world, const double *link)
{
    const Model *model = world->model;
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *w = &model->coordinate[c];
        world->x[c] = w->driven ? world->input[w->input] : link[c];
        world->xd[c] = w->driven ? world->input[w->input + 1] : link[model->coordinates + c];
    }
}

int interpreted_fast(void *instance, double time, const double *link, const double *fast, double *rate)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    World *world = context->world;
    const Model *model = world->model;
    const int count = context->code.fast_count;
    const double begun = profile_clock(context->profile);
    const bool finite = gic_bounded(fast, count) && gic_finite(link, context->code.link_count);
    double result[count];
    int status = finite ? interpreted_load(self, time) : GIC_ERROR_INPUT;
    if (status == GIC_OK)
        set_coordinates(world, link + context->code.link_count - 2 * model->coordinates);
    for (int i = 0; i < model->wheels; ++i)
        if (model->wheel[i].tire >= 0) {
            memcpy(&world->motion[i], link, sizeof *world->motion);
            link += MOTION_NUMBERS;
        }
    world->linked = link;
    world->fast = fast;
    if (status == GIC_OK)
        status = world_wheels_turn(world, fast, result);
    if (status == GIC_OK)
        contact_pieces_note(context->pieces, true);
    world->linked = NULL;
    if (status == GIC_OK && !gic_finite(result, count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK)
        memcpy(rate, result, sizeof result);
    const double taken = profile_clock(context->profile) - begun;
    context->profile->acceleration += taken;
    context->profile->acceleration_functions += taken;
    return self->head.status = status;
}

int interpreted_roll(void *instance)
{
    Instance *self = instance;
    const gic_model *code = &context_of(self)->code;
    const World *world = context_of(self)->world;
    const Model *model = world->model;
    double *fast = instance_array(&self->head, code->state_offset) + code->slow_count;
    const int status = interpreted_refresh(self);
    for (int i = 0; i < model->wheels && status == GIC_OK; ++i) {
        const Wheel *wheel = &model->wheel[i];
        if (wheel->tire >= 0)
            wheel_roll(wheel, &model->tire[wheel->tire], &world->rolling[i], fast + wheel->fast);
    }
    if (status == GIC_OK)
        gic_restart(self, gic_time(&self->head));
    return status;
}
