/* SPDX-License-Identifier: MIT
 * Accelerations and multipliers of a World by one of the linear solvers of equations.h. */
#include "base/vec3.h"
#include "model/model.h"
#include "world/equations.h"
#include "world/world.h"

#include <string.h>

void world_set_solver(Pool *pool, World *world, const Solver *solver)
{
    if (!world->equations) {
        Constraint *constraint = pool_alloc(pool, ((size_t)world->constraints + 1) * sizeof *constraint);
        for (int i = 0; i < world->constraints; ++i) {
            const Tie *tie = &world->tie[i];
            constraint[i] = (Constraint){.body = {tie->body[0], tie->body[1]}, .rows = tie->rows};
        }
        world->equations = equations_new(pool, world->bodies, world->first == 0, world->constraints, constraint);
        for (int b = world->first; b < world->bodies; ++b)
            equations_mass(world->equations, b, world->model->body[b].mass, world->model->body[b].inertia);
    } else {
        world->solver->close(world->solving);
    }
    world->solver = solver;
    world->solving = solver->open(pool, world->equations);
}

int world_accelerate(World *world)
{
    const Model *model = world->model;
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven)
            world->gamma[world->tie[world->coordinate_tie[c]].first] -= world->dual[c] * world->xdd[c];
    const Numbers numbers = {.q = world->q[0],
                             .rate = world->qd[0],
                             .jacobian = world->J,
                             .gamma = world->gamma,
                             .force = world->wrench[0],
                             .acceleration = world->qdd[0],
                             .multiplier = world->multiplier};
    const int lost = world->solver->solve(world->solving, &numbers);
    if (lost >= 0) {
        const int *body = world->tie[lost].body, *subset = world->sequence->body_subset;
        world->lost = subset[body[0]] > subset[body[1]] ? subset[body[0]] : subset[body[1]];
        return GIC_ERROR_MASS;
    }
    for (int b = world->first; b < world->bodies; ++b) {
        euler_turn(world->q[b] + 3, world->qdd[b] + 3, world->alpha[b]);
        for (int i = 0; i < 3; ++i)
            world->alpha[b][i] *= 2;
    }
    for (int c = 0; c < model->coordinates; ++c) {
        const int tie = world->coordinate_tie[c];
        if (!model->coordinate[c].driven)
            world->xdd[c] = (world->gamma[world->tie[tie].first] -
                             world_product(world, tie, 0, (const double(*)[BODY_Q])world->qdd)) /
                            world->dual[c];
    }
    return GIC_OK;
}
