/* SPDX-License-Identifier: MIT
 *
 * Random equations of motion for the tests of their solvers, and the reference: the matrix of Serban and Haug 2000,
 * equation 16, in all seven accelerations of each body with its normalization, by dense elimination in extended
 * precision. */
#ifndef TEST_EQUATIONS_H
#define TEST_EQUATIONS_H

#include "base/pool.h"
#include "base/random.h"
#include "base/vec3.h"
#include "world/equations.h"

#include <math.h>
#include <string.h>

typedef struct Case {
    Equations *equations;
    Numbers numbers;
    double *mass, *inertia; /* [bodies], [bodies][6] */
    double *q, *rate, *jacobian, *gamma, *force;
} Case;

static inline double *numbers_new(Pool *pool, int count)
{
    return pool_alloc(pool, (size_t)(count + 1) * sizeof(double));
}

/* New random numbers for a case. */
static inline void case_shake(Case *c, Random *random)
{
    const Equations *e = c->equations;
    for (int i = 0; i < e->bodies; ++i) {
        bool moves = i > 0 || e->free_base;
        double *q = c->q + 7 * i, *rate = c->rate + 7 * i, norm = 0, along = 0;
        for (int k = 0; k < 7; ++k) {
            q[k] = random_uniform(random, -1, 1);
            rate[k] = moves ? random_uniform(random, -2, 2) : 0;
            norm += k < 3 ? 0 : q[k] * q[k];
        }
        for (int k = 3; k < 7; ++k)
            q[k] /= sqrt(norm), along += q[k] * rate[k];
        for (int k = 3; k < 7; ++k)
            rate[k] -= along * q[k];
        for (int k = 0; k < 6; ++k)
            c->force[6 * i + k] = random_uniform(random, -3, 3);
        c->mass[i] = exp(random_uniform(random, -3, 3));
        /* B B^T + 0.1 */
        double B[9], *J = c->inertia + 6 * i;
        static const int place[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
        for (int k = 0; k < 9; ++k)
            B[k] = random_uniform(random, -1, 1);
        for (int k = 0; k < 6; ++k)
            J[k] = dot3(B + 3 * place[k][0], B + 3 * place[k][1]) + (k < 3 ? 0.1 : 0);
        if (moves)
            equations_mass(c->equations, i, c->mass[i], J);
    }
    for (int i = 0; i < 14 * e->rows; ++i)
        c->jacobian[i] = random_uniform(random, -1, 1);
    for (int i = 0; i < e->rows; ++i)
        c->gamma[i] = random_uniform(random, -5, 5);
}

static inline Case case_new(Pool *pool, int bodies, bool free_base, int constraints, const Constraint *constraint)
{
    Case c = {.equations = equations_new(pool, bodies, free_base, constraints, constraint)};
    int rows = c.equations->rows;
    c.mass = numbers_new(pool, bodies);
    c.inertia = numbers_new(pool, 6 * bodies);
    c.q = numbers_new(pool, 7 * bodies);
    c.rate = numbers_new(pool, 7 * bodies);
    c.jacobian = numbers_new(pool, 14 * rows);
    c.gamma = numbers_new(pool, rows);
    c.force = numbers_new(pool, 6 * bodies);
    c.numbers =
        (Numbers){c.q, c.rate, c.jacobian, c.gamma, c.force, numbers_new(pool, 7 * bodies), numbers_new(pool, rows)};
    return c;
}

/* 15 joints of models/hmmwv.veh: bodies 0 chassis, 1 rack, 2..5 arms, 6..9 wheel assemblies (front ones first). */
enum { HMMWV_BODIES = 10, HMMWV_JOINTS = 15 };
static const Constraint hmmwv_constraint[HMMWV_JOINTS] = {
    {{0, 1}, 5}, {{0, 2}, 5}, {{0, 3}, 5}, {{0, 4}, 5}, {{0, 5}, 5}, {{2, 6}, 3}, {{3, 7}, 3}, {{0, 6}, 2},
    {{0, 7}, 2}, {{1, 6}, 1}, {{1, 7}, 1}, {{4, 8}, 5}, {{5, 9}, 5}, {{0, 8}, 1}, {{0, 9}, 1}};

#endif
