/* SPDX-License-Identifier: MIT
 * Reference points: body-fixed points that make the equations of a body's subset sparse. */
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"

#include <string.h>

/* How much a joint simplifies its subset if the reference point of one end is on it. */
static int joint_merit(const Sequence *sequence, int subset, const Joint *joint, int end)
{
    static const int merit[JOINT_TYPES] = {
        [JOINT_REVOLUTE] = 4,       [JOINT_SPHERICAL] = 4,         [JOINT_UNIVERSAL] = 4,     [JOINT_FIXED] = 4,
        [JOINT_PRISMATIC] = 2,      [JOINT_CYLINDRICAL] = 2,       [JOINT_POINT_ON_LINE] = 2, [JOINT_DISTANCE] = 1,
        [JOINT_POINT_IN_PLANE] = 1, [JOINT_REVOLUTE_SPHERICAL] = 1};
    int other = joint->body[1 - end];
    bool known = other == BODY_BASE || sequence->body_subset[other] != subset;
    return merit[joint->type] ? 2 * merit[joint->type] + known : 0;
}

double (*reference_points(Pool *pool, const Model *model, const Sequence *sequence))[3]
{
    double(*origin)[3] = pool_alloc(pool, (size_t)model->bodies * sizeof *origin);
    int *best = pool_alloc(pool, (size_t)model->bodies * sizeof *best);
    const double **held = pool_alloc(pool, (size_t)model->bodies * sizeof *held);
    for (int s = 0; s < sequence->subsets; ++s)
        for (int i = 0; i < sequence->subset[s].joints; ++i) {
            const Joint *joint = &model->joint[sequence->subset[s].joint[i]];
            for (int end = 0; end < 2; ++end) {
                int body = joint->body[end];
                if (body == BODY_BASE || sequence->body_subset[body] != s)
                    continue;
                int merit = joint_merit(sequence, s, joint, end);
                if (merit > best[body]) {
                    best[body] = merit;
                    memcpy(origin[body], joint->point[end], sizeof origin[body]);
                    held[body] = joint->point[end];
                }
            }
        }
    for (int body = 0; body < model->bodies; ++body)
        if (held[body])
            tuning_copy(model, origin[body], held[body], 3);
    return origin;
}
