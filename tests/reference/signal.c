/* SPDX-License-Identifier: MIT
 * Outputs that formulas read (FORMAT.md sections 7.1 and 9), from poses and velocities of the bodies in the world. */
#include "formula.h"
#include "mechanism.h"
#include "support.h"
#include "wheel.h"

#include <quadmath.h>
#include <string.h>

static void angular_velocity(const Configuration *configuration, int body, quad out[3])
{
    quad own[3], G[3][4];
    memset(out, 0, 3 * sizeof *out);
    if (body == GROUND)
        return;
    euler_rate_matrix(configuration->q[body] + 3, G);
    for (int i = 0; i < 3; ++i)
        own[i] = 2 * quad_dot(G[i], configuration->rate[body] + 3, 4);
    rotate(configuration->q[body] + 3, own, out);
}

/* Roll, pitch and yaw from where the axes of the body point. */
static void attitude(const Configuration *configuration, int body, quad out[3])
{
    quad axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3 && body != GROUND; ++i) {
        const quad own[3] = {i == 0, i == 1, i == 2};
        rotate(configuration->q[body] + 3, own, axis[i]);
    }
    out[0] = atan2q(axis[1][2], axis[2][2]);
    out[1] = -asinq(fmaxq(-1, fminq(1, axis[0][2])));
    out[2] = atan2q(axis[0][1], axis[0][0]);
}

/* Components of a vector of the world in the frame that is asked for. */
static void express(const Configuration *configuration, int in, quad vector[3])
{
    quad own[3];
    if (in == GROUND)
        return;
    rotate_back(configuration->q[in] + 3, vector, own);
    memcpy(vector, own, sizeof own);
}

quad signal_value(const SignalSource *source, const Surroundings *around)
{
    const Model *model = around->model;
    const Configuration *configuration = around->configuration;
    quad x[3] = {0}, v[3] = {0};
    const char *type = source->type;
    if (!model)
        fail("formulas read the signal '%s' where there is no mechanism", type);
    if (!strcmp(type, "coordinate") && source->component < 2)
        return source->component ? configuration->w_rate[source->index] : configuration->w[source->index];
    if (!strcmp(type, "tire") && source->component == SPIN - FX)
        return model->spin[source->index];
    if (!strcmp(type, "force"))
        return element_value(model, configuration, source->index);
    if (!strcmp(type, "position") || !strcmp(type, "velocity"))
        point_motion(model, configuration, source->body, source->point, x, v);
    if (!strcmp(type, "position"))
        return x[source->component];
    if (!strcmp(type, "roll_pitch_yaw")) {
        attitude(configuration, source->body, x);
        return x[source->component];
    }
    if (!strcmp(type, "angular_velocity"))
        angular_velocity(configuration, source->body, v);
    else if (strcmp(type, "velocity") != 0)
        fail("formulas read the signal '%s', which this program does not know", type);
    express(configuration, source->in, v);
    return v[source->component];
}
