/* SPDX-License-Identifier: MIT
 * Models with a base that is held, coordinates that are driven and wheels on posts, as on a test rig. */
#include "base/vec3.h"
#include "model/model.h"
#include "specialize/specialize.h"

#include <string.h>

const Model *model_hold(Pool *pool, const Model *model, const double position[3], const double euler[4])
{
    Model *held = pool_alloc(pool, sizeof *held);
    const size_t size = sizeof *model->body * (size_t)model->bodies;
    *held = *model;
    held->free_base = false;
    held->body = pool_grow(pool, model->body, size, size);
    const Body *base = &model->body[BODY_BASE];
    double A[9], A0[9], relative[3], local[3];
    mat_from_euler(euler, A);
    mat_from_euler(base->euler, A0);
    for (int b = 0; b < model->bodies; ++b) {
        Body *body = &held->body[b];
        double turned[4];
        for (int i = 0; i < 3; ++i)
            relative[i] = model->body[b].position[i] - base->position[i];
        apply3_transposed(A0, relative, local);
        apply3(A, local, relative);
        for (int i = 0; i < 3; ++i)
            body->position[i] = position[i] + relative[i];
        euler_relative(base->euler, model->body[b].euler, turned);
        euler_product(euler, turned, body->euler);
    }
    if (!memcmp(position, base->position, sizeof base->position) && !memcmp(euler, base->euler, sizeof base->euler))
        memcpy(held->body, model->body, size);
    return held;
}

const Model *model_drive(Pool *pool, const Model *model, const int *coordinate, int count)
{
    static const char *const suffix[3] = {"", ".rate", ".acceleration"};
    static const char *const unit[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    Model *driven = pool_alloc(pool, sizeof *driven);
    const size_t coordinates = sizeof *model->coordinate * (size_t)model->coordinates;
    const size_t inputs = sizeof *model->input * (size_t)model->inputs;
    *driven = *model;
    driven->coordinate = pool_grow(pool, model->coordinate, coordinates, coordinates);
    driven->input = pool_grow(pool, model->input, inputs, inputs + sizeof *model->input * (size_t)(3 * count));
    for (int i = 0; i < count; ++i) {
        Coordinate *c = &driven->coordinate[coordinate[i]];
        c->driven = true;
        c->input = driven->inputs;
        for (int k = 0; k < 3; ++k)
            driven->input[driven->inputs++] = (Input){.name = pool_print(pool, "%s%s", c->name, suffix[k]),
                                                      .unit = unit[c->type == COORDINATE_ANGLE][k],
                                                      .initial = k ? 0 : c->initial};
    }
    return driven;
}

const Model *model_post(Pool *pool, const Model *model, const int *wheel, int count)
{
    Model *posted = pool_alloc(pool, sizeof *posted);
    const size_t wheels = sizeof *model->wheel * (size_t)model->wheels;
    const size_t inputs = sizeof *model->input * (size_t)model->inputs;
    *posted = *model;
    posted->wheel = pool_grow(pool, model->wheel, wheels, wheels);
    posted->input = pool_grow(pool, model->input, inputs, inputs + sizeof *model->input * (size_t)(2 * count));
    for (int i = 0; i < count; ++i) {
        Wheel *w = &posted->wheel[wheel[i]];
        posted->input[posted->inputs++] = (Input){.name = pool_print(pool, "%s.post", w->name), .unit = "m"};
        w->post = posted->inputs;
        posted->input[posted->inputs++] = (Input){.name = pool_print(pool, "%s.post_rate", w->name), .unit = "m/s"};
    }
    return posted;
}
