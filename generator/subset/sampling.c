/* SPDX-License-Identifier: MIT
 * Admissible configurations: random values of the coordinates inside their ranges, reached from the design. */
#include "base/random.h"
#include "base/vec3.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"

#include <string.h>

enum { STEPS = 8, CONFIGURATIONS = 6, SAMPLES_MOST = 512 };

Sampling *sampling_new(Pool *pool, const Model *model, const Sequence *sequence, const double (*origin)[3])
{
    Sampling *sampling = pool_alloc(pool, sizeof *sampling);
    int members = 1;
    for (int i = 0; i < sequence->classes; ++i)
        members = sequence->class[i].members > members ? sequence->class[i].members : members;
    /* many members of a class share the samples of a range */
    int configurations = SAMPLES_MOST / members;
    configurations = configurations < 2 ? 2 : configurations > CONFIGURATIONS ? CONFIGURATIONS : configurations;
    size_t bodies = (size_t)model->bodies, coordinates = (size_t)model->coordinates, count = (size_t)configurations;
    *sampling = (Sampling){.configurations = configurations,
                           .steps = STEPS,
                           .bodies = model->bodies,
                           .coordinates = model->coordinates,
                           .target = pool_alloc(pool, count * coordinates * sizeof(double)),
                           .pose = pool_alloc(pool, (STEPS + 1) * count * bodies * 12 * sizeof(double)),
                           .usable = pool_alloc(pool, count * bodies * sizeof(bool)),
                           .S = pool_alloc(pool, bodies * sizeof(double *)),
                           .swing = pool_alloc(pool, (coordinates + 1) * sizeof(double))};
    Random random = {.state = 2000};
    for (int c = 0; c < configurations; ++c)
        for (int i = 0; i < model->coordinates; ++i) {
            const Coordinate *w = &model->coordinate[i];
            double share = random_uniform(&random, -0.9, 0.9); /* share of the way from the design to the end of the
                                                                * range */
            double end = share < 0 ? w->design - w->range[0] : w->range[1] - w->design;
            sampling->target[c * model->coordinates + i] = w->design + (c ? share * end : 0);
        }
    /* each body starts at its design pose */
    double base[9], body[9];
    mat_from_euler(model->body[BODY_BASE].euler, base);
    for (int b = 0; b < model->bodies; ++b) {
        double pose[12], offset[3], at[3];
        mat_from_euler(model->body[b].euler, body);
        apply3(body, origin[b], offset);
        for (int i = 0; i < 3; ++i)
            at[i] = model->body[b].position[i] + offset[i] - model->body[BODY_BASE].position[i];
        apply3_transposed(base, at, pose);
        for (int i = 0; i < 3; ++i) {
            double column[3], turned[3];
            for (int j = 0; j < 3; ++j)
                column[j] = body[3 * j + i];
            apply3_transposed(base, column, turned);
            for (int j = 0; j < 3; ++j)
                pose[3 + 3 * j + i] = turned[j];
        }
        for (int s = 0; s <= STEPS; ++s)
            for (int c = 0; c < configurations; ++c)
                memcpy(sampling_pose(sampling, s, c, b), pose, sizeof pose);
        for (int c = 0; c < configurations; ++c)
            sampling->usable[b * configurations + c] = true;
    }
    return sampling;
}

double sampling_coordinate(const Sampling *sampling, const Model *model, int step, int configuration, int coordinate)
{
    double design = model->coordinate[coordinate].design;
    double target = sampling->target[configuration * sampling->coordinates + coordinate];
    return step == sampling->steps ? target : design + (target - design) * step / sampling->steps;
}

double *sampling_pose(const Sampling *sampling, int step, int configuration, int body)
{
    size_t row = (size_t)step * (size_t)sampling->configurations + (size_t)configuration;
    return sampling->pose + (row * (size_t)sampling->bodies + (size_t)body) * 12;
}

/* The reference point of a body in the model frame. */
static void reference_place(const Model *model, const double (*origin)[3], int body, double out[3])
{
    double A[9];
    mat_from_euler(model->body[body].euler, A);
    apply3(A, origin[body], out);
    for (int i = 0; i < 3; ++i)
        out[i] += model->body[body].position[i];
}

void sampling_design(const Sampling *sampling, const Model *model, const double (*origin)[3], int anchor, int body,
                     double q[7])
{
    double A[9], own[3], from[3];
    euler_relative(model->body[anchor].euler, model->body[body].euler, q + 3);
    if (anchor == BODY_BASE) {
        memcpy(q, sampling_pose(sampling, 0, 0, body), 3 * sizeof *q);
        return;
    }
    reference_place(model, origin, body, own);
    reference_place(model, origin, anchor, from);
    for (int i = 0; i < 3; ++i)
        own[i] -= from[i];
    mat_from_euler(model->body[anchor].euler, A);
    apply3_transposed(A, own, q);
}
