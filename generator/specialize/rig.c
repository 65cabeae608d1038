/* SPDX-License-Identifier: MIT
 * Models with a base that is held, coordinates that are driven and wheels on posts, as on a test rig. */
#include "base/vec3.h"
#include "model/model.h"
#include "model/tunable.h"
#include "specialize/specialize.h"

#include <string.h>

/* Places and orientations of bodies that follow parameters, moved with the base: position + R (place - that of the
 * base) and the product of quaternions q = euler base* body, all of them linear in the body's. */
static void move_formulas(const Model *model, const Model *held, const double position[3], const double euler[4])
{
    const Body *base = &model->body[BODY_BASE];
    Dag *dag = model->tuning->dag;
    double A[9], A0[9], R[9], turn[4], column[4];
    mat_from_euler(euler, A);
    mat_from_euler(base->euler, A0);
    for (int i = 0; i < 9; ++i)
        R[i] =
            A[i / 3 * 3] * A0[i % 3 * 3] + A[i / 3 * 3 + 1] * A0[i % 3 * 3 + 1] + A[i / 3 * 3 + 2] * A0[i % 3 * 3 + 2];
    const double back[4] = {base->euler[0], -base->euler[1], -base->euler[2], -base->euler[3]};
    euler_product(euler, back, turn);
    for (int b = 0; b < model->bodies; ++b) {
        const Body *from = &model->body[b];
        Ex place[3], q[4];
        for (int i = 0; i < 3; ++i) {
            place[i] = ex_literal(dag, position[i]);
            for (int k = 0; k < 3; ++k) {
                Ex apart =
                    ex_sub(dag, tuned_or_fixed(model, &from->position[k]), tuned_or_fixed(model, &base->position[k]));
                place[i] = ex_add(dag, place[i], ex_mul(dag, ex_literal(dag, R[3 * i + k]), apart));
            }
        }
        for (int i = 0; i < 4; ++i)
            q[i] = ex_literal(dag, 0);
        for (int k = 0; k < 4; ++k) {
            const double unit[4] = {k == 0, k == 1, k == 2, k == 3};
            euler_product(turn, unit, column);
            for (int i = 0; i < 4; ++i)
                q[i] =
                    ex_add(dag, q[i], ex_mul(dag, ex_literal(dag, column[i]), tuned_or_fixed(model, &from->euler[k])));
        }
        tuning_drop(model->tuning, held->body[b].position, 3);
        tuning_drop(model->tuning, held->body[b].euler, 4);
        tuning_set(model->tuning, held->body[b].position, place, 3);
        tuning_set(model->tuning, held->body[b].euler, q, 4);
    }
}

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
    tuning_copy_all(model, held->body, model->body, size);
    if (!memcmp(position, base->position, sizeof base->position) && !memcmp(euler, base->euler, sizeof base->euler))
        memcpy(held->body, model->body, size);
    else if (model->tuning)
        move_formulas(model, held, position, euler);
    held->drawn = held->body; /* set-up with other parameters begins there */
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
    tuning_copy_all(model, driven->coordinate, model->coordinate, coordinates);
    tuning_copy_all(model, driven->input, model->input, inputs);
    for (int i = 0; i < count; ++i) {
        Coordinate *c = &driven->coordinate[coordinate[i]];
        c->driven = true;
        c->input = driven->inputs;
        for (int k = 0; k < 3; ++k)
            driven->input[driven->inputs++] = (Input){.name = pool_print(pool, "%s%s", c->name, suffix[k]),
                                                      .unit = unit[c->type == COORDINATE_ANGLE][k],
                                                      .initial = k ? 0 : c->initial};
        if (model->tuning)
            tuning_copy(model, &driven->input[driven->inputs - 3].initial, &model->coordinate[coordinate[i]].initial,
                        1);
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
    tuning_copy_all(model, posted->wheel, model->wheel, wheels);
    tuning_copy_all(model, posted->input, model->input, inputs);
    for (int i = 0; i < count; ++i) {
        Wheel *w = &posted->wheel[wheel[i]];
        posted->input[posted->inputs++] = (Input){.name = pool_print(pool, "%s.post", w->name), .unit = "m"};
        w->post = posted->inputs;
        posted->input[posted->inputs++] = (Input){.name = pool_print(pool, "%s.post_rate", w->name), .unit = "m/s"};
    }
    return posted;
}
