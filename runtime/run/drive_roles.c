/* SPDX-License-Identifier: MIT
 * Which input of a vehicle steers, and which are its pedals: for the keys of a page of --drive. */
#include "base/vec3.h"
#include "engine/engine.h"
#include "run/drive.h"
#include "scene/driver.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

static const double turn_least =
    0.05; /* rad of a wheel over an input's range: bumps of a suspension turn wheels less */

static int input_named(const Model *model, const char *name)
{
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(model->input[i].name, name))
            return i;
    return -1;
}

/* Headings of all wheels, rad; false: there is no such pose. */
static bool headings(const Engine *engine, const Model *model, gic_head *self, double *heading)
{
    double pose[7 * model->bodies + 1];
    if (engine->code->poses(self, pose) != GIC_OK)
        return false;
    for (int w = 0; w < model->wheels; ++w) {
        double A[9], axis[3];
        mat_from_euler(pose + 7 * model->wheel[w].body + 3, A);
        apply3(A, model->wheel[w].axis, axis);
        heading[w] = atan2(axis[1], axis[0]);
    }
    return true;
}

/* The turn of the wheel that turns most to the left or right, when an input moves from its value to another one. */
static double turn(const Engine *engine, const Model *model, gic_head *self, int input, double value)
{
    double before[model->wheels + 1], after[model->wheels + 1], most = 0;
    double *place = instance_array(self, engine->code->input_offset) + input;
    const double was = *place;
    bool good = headings(engine, model, self, before);
    *place = value;
    good = headings(engine, model, self, after) && good;
    *place = was;
    for (int w = 0; good && w < model->wheels; ++w) {
        const double change = remainder(after[w] - before[w], 6.283185307179586);
        if (fabs(change) > fabs(most))
            most = change;
    }
    return most;
}

static void find_steering(Pool *pool, const Model *model, const Scene *scene, const Engine *engine, Roles *roles)
{
    gic_head *self = instance_new(pool, engine), *kept = instance_new(pool, engine);
    double most = turn_least;
    if (scene_start(engine, scene, self) != GIC_OK)
        return;
    self->input_function = NULL;
    memcpy(kept, self, engine->code->size);
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *c = &model->coordinate[i];
        const double low = c->range[0], high = c->range[1], width = high - low;
        if (!c->driven || !isfinite(width) || width <= 0)
            continue;
        /* a small move, in the range, tells the sense; larger ones may be out of reach at once */
        const double now = instance_array(self, engine->code->input_offset)[c->input];
        const double to = now + 0.01 * width <= high ? now + 0.01 * width : now - 0.01 * width;
        const double slope = turn(engine, model, self, c->input, to) / (to - now);
        memcpy(self, kept, engine->code->size);
        if (fabs(slope) * width < most)
            continue;
        most = fabs(slope) * width;
        roles->steering = c->input;
        roles->left = slope > 0 ? high : low;
        roles->right = slope > 0 ? low : high;
    }
}

Roles drive_roles(Pool *pool, const Model *model, const Scene *scene, const Engine *engine)
{
    const Driver *driver = scene->driver;
    Roles roles = {.accelerator = input_named(model, "accelerator"),
                   .brake = input_named(model, "brake"),
                   .steering = -1,
                   .selector = model->powertrain && model->powertrain->selector ? input_named(model, "selector") : -1};
    if (driver && driver->accelerator >= 0) {
        roles.accelerator = driver->accelerator;
        roles.brake = driver->brake;
    }
    if (driver && driver->steering >= 0 && isfinite(driver->limit)) {
        roles.steering = driver->steering;
        roles.left = driver->middle + copysign(driver->limit, driver->per_angle);
        roles.right = driver->middle - copysign(driver->limit, driver->per_angle);
    } else {
        find_steering(pool, model, scene, engine, &roles);
    }
    return roles;
}
