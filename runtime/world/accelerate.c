/* SPDX-License-Identifier: MIT
 * Accelerations and multipliers of a World by one of the linear solvers of equations.h. */
#include "base/vec3.h"
#include "model/model.h"
#include "world/dense.h"
#include "world/equations.h"
#include "world/world.h"

#include <math.h>
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

/* Accelerations where what gears and couplers measure accelerates as gamma says. */
static int solve(World *world)
{
    const Model *model = world->model;
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
    for (int c = 0; c < model->coordinates; ++c) {
        const int tie = world->coordinate_tie[c];
        if (!model->coordinate[c].driven)
            world->xdd[c] = (world->gamma[world->tie[tie].first] -
                             world_product(world, tie, 0, (const double(*)[BODY_Q])world->qdd)) /
                            world->dual[c];
    }
    return GIC_OK;
}

/* A gear or coupler is driven, like a driven coordinate: what it measures accelerates by a, and its drive has the force
 * F = multiplier times dual. The coordinates w that it follows drive it: a = f_w w'' (the rest is in gamma), and along
 * them acts -f_w F. Everything is linear in a and F. */
static void push_back(World *world, const Tie *tie, double F)
{
    double way[world->model->coordinates + 1];
    memset(way, 0, sizeof way);
    for (int c = 0; c < world->model->coordinates; ++c)
        if (law_follows(tie->law, c)) {
            way[c] = 1;
            world_push(world, c, -F * world_jet(world, tie->law, way).rate);
            way[c] = 0;
        }
}

/* The constraint's accelerations and forces of the couplers [couplers], each y[i], y[couplers + i]; what is left of
 * their equations. */
static int solve_coupled(World *world, const int *coupler, int couplers, const double *y, double *left)
{
    double wrench[world->bodies][6], gamma[couplers];
    memcpy(wrench, world->wrench, sizeof wrench);
    for (int i = 0; i < couplers; ++i) {
        const Tie *tie = &world->tie[coupler[i]];
        gamma[i] = world->gamma[tie->first];
        world->gamma[tie->first] -= world->tie_dual[coupler[i]] * y[i];
        push_back(world, tie, y[couplers + i]);
    }
    const int status = solve(world);
    for (int i = 0; i < couplers; ++i) {
        const Tie *tie = &world->tie[coupler[i]];
        world->gamma[tie->first] = gamma[i];
        left[i] = world_jet(world, tie->law, world->xdd).rate - y[i];
        left[couplers + i] = world->multiplier[tie->first] * world->tie_dual[coupler[i]] - y[couplers + i];
    }
    memcpy(world->wrench, wrench, sizeof wrench);
    return status;
}

/* With couplers: what is left is linear in their accelerations and forces; corrections until it is rounding. */
static int couple(World *world, const int *coupler, int couplers)
{
    enum { CORRECTIONS = 3 };
    const int n = 2 * couplers;
    double y[n], left[n], at[n], K[n * n];
    int swap[n], status;
    memset(y, 0, sizeof y);
    status = solve_coupled(world, coupler, couplers, y, left);
    for (int j = 0; j < n && status == GIC_OK; ++j) {
        const double step = 1 + fabs(left[j]);
        y[j] = step;
        status = solve_coupled(world, coupler, couplers, y, at);
        y[j] = 0;
        for (int i = 0; i < n; ++i)
            K[n * i + j] = (left[i] - at[i]) / step;
    }
    if (status == GIC_OK && !dense_factor(n, K, swap)) {
        world->lost = world->sequence->body_subset[world->tie[coupler[0]].body[1]];
        status = GIC_ERROR_MASS;
    }
    for (int pass = 0; pass <= CORRECTIONS && status == GIC_OK; ++pass) {
        dense_solve(n, K, swap, left);
        for (int i = 0; i < n; ++i)
            y[i] += left[i];
        status = solve_coupled(world, coupler, couplers, y, left);
    }
    /* what acts back stays among the wrenches, for the balance of all forces */
    for (int i = 0; i < couplers && status == GIC_OK; ++i)
        push_back(world, &world->tie[coupler[i]], y[couplers + i]);
    return status;
}

int world_accelerate(World *world)
{
    const Model *model = world->model;
    int coupler[model->joints + 1], couplers = 0;
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven)
            world->gamma[world->tie[world->coordinate_tie[c]].first] -= world->dual[c] * world->xdd[c];
    for (int i = 0; i < model->joints; ++i)
        if (world->tie[i].law)
            coupler[couplers++] = i;
    const int status = couplers ? couple(world, coupler, couplers) : solve(world);
    for (int b = world->first; b < world->bodies && status == GIC_OK; ++b) {
        euler_turn(world->q[b] + 3, world->qdd[b] + 3, world->alpha[b]);
        for (int i = 0; i < 3; ++i)
            world->alpha[b][i] *= 2;
    }
    return status;
}
