/* SPDX-License-Identifier: MIT
 * Reaction forces of joints from the multipliers of the augmented system. */
#include "solve.h"

#include <quadmath.h>
#include <string.h>

Reaction joint_reaction(const Solver *solver, int index)
{
    const Model *model = solver->model;
    const Joint *joint = &model->joint[index];
    const quad *lambda = solver->unknown + BODY_COORDINATES * solver->moving;
    int body = joint->body[1];
    const quad *p = solver->configuration->q[body] + 3;
    quad Q[BODY_COORDINATES] = {0}, G[3][4], s[3], arm[3], own[3], turn[3];
    Reaction reaction;
    for (int r = joint_row(model, index); r < joint_row(model, index + 1); ++r)
        for (int i = 0; i < BODY_COORDINATES; ++i)
            Q[i] -= lambda[r] * solver->row[r].slope[1][i];
    /* Q . q' = F . v + torque . omega for every motion, and p' = G^T omega / 2 */
    euler_rate_matrix(p, G);
    for (int i = 0; i < 3; ++i) {
        reaction.force[i] = Q[i];
        own[i] = quad_dot(G[i], Q + 3, 4) / 2;
    }
    rotate(p, own, reaction.torque);
    from_com(model, body, joint->point[1], s);
    rotate(p, s, arm);
    quad_cross(arm, reaction.force, turn);
    quad force = sqrtq(quad_dot(reaction.force, reaction.force, 3));
    reaction.force_scale = force;
    /* where the arm is none, it is still known to some 2e-15 of the model's length only, as places are */
    reaction.torque_scale = sqrtq(quad_dot(reaction.torque, reaction.torque, 3)) +
                            force * (sqrtq(quad_dot(arm, arm, 3)) + 1e-3 * (quad)model->length);
    for (int i = 0; i < 3; ++i)
        reaction.torque[i] -= turn[i];
    return reaction;
}
