/* SPDX-License-Identifier: MIT
 * Kinematics of interpreted engines against differences of their own values: J and Psi_w by first, gamma by second
 * differences, for every type of joint and coordinate; coordinates as functions of the configuration; small systems. */
#include "base/pool.h"
#include "base/random.h"
#include "model/model.h"
#include "read/read.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "world/dense.h"
#include "world/world.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static const char *const models[] = {"tests/data/dump/joints.veh", "models/hmmwv.veh", "models/trailing_arm.veh"};
enum { MODELS = sizeof models / sizeof *models };

static World *open_world(Pool *pool, const char *path)
{
    const Model *drawn = model_read(pool, path);
    const Sequence *sequence = sequence_find(pool, drawn);
    World *world = world_new(pool, model_assemble(pool, drawn, sequence), sequence);
    for (int c = 0; c < world->model->coordinates; ++c)
        world->x[c] = world->model->coordinate[c].design;
    return world;
}

/* Rates of everything that moves, p' perpendicular to p. */
static void random_rates(World *world, Random *random, double (*qd)[BODY_Q])
{
    for (int b = 0; b < world->bodies; ++b) {
        const double *p = world->q[b] + 3;
        double along = 0;
        memset(qd[b], 0, sizeof qd[b]);
        if (b < world->first)
            continue;
        for (int i = 0; i < BODY_Q; ++i)
            qd[b][i] = random_uniform(random, -1, 1);
        for (int i = 0; i < 4; ++i)
            along += p[i] * qd[b][3 + i];
        for (int i = 0; i < 4; ++i)
            qd[b][3 + i] -= along * p[i];
    }
    for (int c = 0; c < world->model->coordinates; ++c)
        world->xd[c] = random_uniform(random, -1, 1);
}

/* All values at time t of the motion without accelerations: r straight, p along a great circle. */
static void values_at(World *world, const double (*q)[BODY_Q], const double (*qd)[BODY_Q], const double *x, double t,
                      double *value)
{
    for (int b = 0; b < world->bodies; ++b) {
        double moved[BODY_Q], speed = 0;
        for (int i = 3; i < BODY_Q; ++i)
            speed += qd[b][i] * qd[b][i];
        speed = sqrt(speed);
        for (int i = 0; i < BODY_Q; ++i)
            moved[i] = i < 3 || speed == 0 ? q[b][i] + t * qd[b][i]
                                           : cos(speed * t) * q[b][i] + sin(speed * t) / speed * qd[b][i];
        world_set_q(world, b, moved);
    }
    for (int c = 0; c < world->model->coordinates; ++c)
        world->x[c] = x[c] + t * world->xd[c];
    for (int i = 0; i < world->ties; ++i)
        world_values(world, i);
    memcpy(value, world->value, (size_t)world->rows * sizeof *value);
}

/* Differences over 2e-4: truncation is 4e-8 of the next two derivatives, rounding of second ones 1e-7 of values of the
 * order of 10. */
static void test_derivatives(void **state)
{
    (void)state;
    const double h = 2e-4;
    for (int m = 0; m < MODELS; ++m) {
        Pool *pool = pool_new();
        World *world = open_world(pool, models[m]);
        Random random = {.state = 7};
        const size_t bodies = (size_t)world->bodies, coordinates = (size_t)world->model->coordinates;
        double q[bodies][BODY_Q], qd[bodies][BODY_Q], x[coordinates], value[3][world->rows];
        for (int round = 0; round < 5; ++round) {
            memcpy(q, world->q_design, sizeof q);
            for (size_t c = 0; c < coordinates; ++c)
                x[c] = world->model->coordinate[c].design;
            for (int b = 0; b < world->bodies; ++b)
                world_set_q(world, b, q[b]);
            random_rates(world, &random, qd);
            for (int k = -1; k <= 1; ++k)
                values_at(world, (const double(*)[BODY_Q])q, (const double(*)[BODY_Q])qd, x, k * h, value[k + 1]);
            for (int b = 0; b < world->bodies; ++b) {
                world_set_q(world, b, q[b]);
                world_set_rate(world, b, qd[b]);
            }
            memcpy(world->x, x, sizeof x);
            for (int i = 0; i < world->ties; ++i) {
                const Tie *tie = &world->tie[i];
                assert_true(world_rows(world, i));
                world_gamma(world, i);
                for (int r = 0; r < tie->rows; ++r) {
                    const int row = tie->first + r;
                    const double rate = (value[2][row] - value[0][row]) / (2 * h);
                    const double second = (value[2][row] - 2 * value[1][row] + value[0][row]) / (h * h);
                    double expected = world_product(world, i, r, (const double(*)[BODY_Q])qd);
                    if (tie->coordinate >= 0)
                        expected += world->dual[tie->coordinate] * world->xd[tie->coordinate];
                    assert_true(fabs(rate - expected) < 1e-6 * (1 + fabs(rate)));
                    assert_true(fabs(second + world->gamma[row]) < 1e-6 * (1 + fabs(second)));
                }
            }
        }
        pool_free(pool);
    }
}

/* A coordinate is what its definition holds at: at the design its value there, a whole turn on where that is nearer. */
static void test_coordinates(void **state)
{
    (void)state;
    const double turn = 6.283185307179586;
    for (int m = 0; m < MODELS; ++m) {
        Pool *pool = pool_new();
        World *world = open_world(pool, models[m]);
        for (int c = 0; c < world->model->coordinates; ++c) {
            const Coordinate *coordinate = &world->model->coordinate[c];
            const bool angle = coordinate->type == COORDINATE_ANGLE;
            double out[2];
            world_coordinate(world, c, coordinate->design + 3 * turn + 0.2, out);
            assert_true(fabs(out[0] - coordinate->design - (angle ? 3 * turn : 0)) < 1e-11);
            assert_true(out[1] == 0);
        }
        assert_true(world_residual(world) < 1e-11);
        pool_free(pool);
    }
}

/* A b from factors of random matrices, with a zero pivot to begin with; a rotation's determinant. */
static void test_dense(void **state)
{
    (void)state;
    Random random = {.state = 3};
    for (int n = 1; n <= 21; n += n == 1 ? 6 : 7) {
        double A[n * n], factors[n * n], x[n], b[n];
        int swap[n];
        for (int i = 0; i < n * n; ++i)
            factors[i] = A[i] = n > 1 && i == 0 ? 0 : random_uniform(&random, -1, 1);
        for (int i = 0; i < n; ++i)
            x[i] = random_uniform(&random, -1, 1);
        for (int i = 0; i < n; ++i) {
            b[i] = 0;
            for (int j = 0; j < n; ++j)
                b[i] += A[n * i + j] * x[j];
        }
        assert_true(dense_factor(n, factors, swap));
        dense_solve(n, factors, swap, b);
        for (int i = 0; i < n; ++i)
            assert_true(fabs(b[i] - x[i]) < 1e-11); /* condition numbers are below 1e4 */
    }
    double turned[9] = {0, 0, 2, 1, 0, 0, 0, 3, 0}, flat[4] = {1, 2, 2, 4};
    int swap[3];
    assert_true(dense_factor(3, turned, swap));
    assert_true(fabs(dense_determinant(3, turned, swap) - 6) < 1e-14);
    assert_false(dense_factor(2, flat, swap));
}

/* A rod of 1 m, with its middle as the origin, on one hinge: moved away from it what does not fit is the distance;
 * turned about the hinge or across it, the distance and the sine between the axes. */
static void test_residual(void **state)
{
    (void)state;
    Pool *pool = pool_new();
    World *world = open_world(pool, "models/pendulum.veh");
    world->x[0] = 0;
    for (int b = 0; b < world->bodies; ++b)
        world_set_q(world, b, (const double[BODY_Q]){b ? -0.5 : 0, 0, 0, 1});
    assert_true(world_residual(world) < 1e-15);
    const int rod = world->bodies - 1;
    for (int i = 0; i < 3; ++i) {
        double moved[BODY_Q] = {-0.5, 0, 0, 1};
        moved[i] -= 0.03;
        world_set_q(world, rod, moved);
        assert_true(fabs(world_residual(world) - 0.03 / fmin(world->size, 1)) < 1e-15);
    }
    world_set_q(world, rod, (const double[BODY_Q]){-0.5, 0, 0, cos(0.01), sin(0.01), 0, 0});
    assert_true(fabs(world_residual(world) - sin(0.02) / fmin(world->size, 1)) < 1e-15);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_derivatives), cmocka_unit_test(test_coordinates),
                                       cmocka_unit_test(test_residual), cmocka_unit_test(test_dense)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
