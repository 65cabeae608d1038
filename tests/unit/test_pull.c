/* SPDX-License-Identifier: MIT
 * Derivatives backwards against those forwards: for directions d and weights w, both drawn, w . (J d) = (J^T w) . d but
 * for rounding of the sum of the magnitudes of its terms, at random states of models of all kinds, on a road of waves.
 */
#include "base/pool.h"
#include "base/random.h"
#include "engine/engine.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/linearize.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { STATES = 1000 };

static void draw(Random *random, double *number, int count)
{
    for (int i = 0; i < count; ++i)
        number[i] = random_uniform(random, -1, 1);
}

/* A state about that of set-up: false where the mechanism is not there. */
static bool move_somewhere(const gic_model *code, Instance *self, Random *random)
{
    if (code->setup(self) != GIC_OK)
        return false;
    double *y = instance_array(&self->head, code->state_offset), *u = instance_array(&self->head, code->input_offset);
    const int states = code->slow_count + code->fast_count;
    double rate[states + 1];
    for (int i = 0; i < code->slow_count; ++i)
        y[i] += 0.03 * random_uniform(random, -1, 1);
    for (int i = code->slow_count; i < states; ++i)
        y[i] += (y[i] != 0 ? 0.1 * y[i] : 0.1) * random_uniform(random, -1, 1);
    if (code->free_base) {
        double square = 0;
        for (int i = 3; i < 7; ++i)
            square += y[i] * y[i];
        for (int i = 3; i < 7; ++i)
            y[i] /= sqrt(square);
    }
    for (int i = 0; i < code->input_count; ++i)
        u[i] += 0.01 * random_uniform(random, -1, 1);
    draw(random, instance_array(&self->head, code->port_offset), code->port_count);
    return code->settle(self, y) == GIC_OK && code->rhs(self, 0, y, rate) == GIC_OK;
}

static double product(const double *a, const double *b, int count, double *size)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += a[i] * b[i];
        *size += fabs(a[i] * b[i]);
    }
    return sum;
}

/* At the present state; the largest difference, relative to the magnitudes. */
static double compare(const Linear *linear, const Instance *self, Random *random)
{
    const gic_model *code = &linear->engine->code;
    const int states = code->slow_count + code->fast_count, outputs = code->output_count, rows = states + outputs;
    const int inputs = code->input_count, ports = code->port_count, parameters = code->parameter_count;
    double d[states + inputs + ports + parameters + 1], w[rows + 1];
    const Direction *along = &linear->along;
    draw(random, d, states + inputs + ports + parameters);
    draw(random, w, rows);
    memcpy(along->y, d, (size_t)states * sizeof *d);
    memcpy(along->u, d + states, (size_t)inputs * sizeof *d);
    memcpy(along->port, d + states + inputs, (size_t)ports * sizeof *d);
    memcpy(along->p, d + states + inputs + ports, (size_t)parameters * sizeof *d);
    if (linear_slope(linear, self, LINEAR_RATE, outputs) != GIC_OK || !gic_finite(linear->drate, rows))
        return 0;
    double size = 0;
    const double forwards = product(w, linear->drate, rows, &size);
    memcpy(linear->drate, w, (size_t)rows * sizeof *w);
    assert_int_equal(linear_pull(linear, self, LINEAR_RATE, outputs), GIC_OK);
    double backwards = product(along->y, d, states, &size);
    backwards += product(along->u, d + states, inputs, &size);
    backwards += product(along->port, d + states + inputs, ports, &size);
    backwards += product(along->p, d + states + inputs + ports, parameters, &size);
    return fabs(forwards - backwards) / size;
}

static void test_pull(void **unused)
{
    (void)unused;
    static const char *const models[] = {
        "models/andrews.veh",       "models/five_link.veh",     "models/formula_student.veh", "models/hatchback.veh",
        "models/hmmwv.veh",         "models/hmmwv14.veh",       "models/hmmwv_full.veh",      "models/hmmwv_tires.veh",
        "models/hmmwv_tmeasy.veh",  "models/hmmwv_vehicle.veh", "models/motorcycle.veh",      "models/pendulum.veh",
        "models/quarter_car.veh",   "models/semitrailer.veh",   "models/solid_axle.veh",      "models/trailing_arm.veh",
        "tests/data/tuning/car.veh"};
    static const gic_road_sine waves = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.05, 3, 0.3, 0.7};
    for (size_t m = 0; m < sizeof models / sizeof *models; ++m) {
        Pool *pool = pool_new();
        const Model *model = model_read(pool, models[m]);
        const Engine *engine = engine_open(pool, "tape", model, &(EngineOptions){.quiet = true});
        const Linear *linear = linear_open(pool, engine);
        Instance *self = (Instance *)(void *)instance_new(pool, engine);
        Random random = {.state = 1 + m};
        double worst[2] = {0};
        int compared = 0;
        for (int k = 0; k < 4 * STATES && compared < STATES; ++k) {
            memset(&self->head, 0, sizeof self->head);
            if (!move_somewhere(engine->code, self, &random))
                continue;
            self->head.road = k % 2 ? &waves.head : NULL;
            double rate[engine->code->slow_count + engine->code->fast_count + 1];
            if (engine->code->rhs(self, 0, instance_array(&self->head, engine->code->state_offset), rate) != GIC_OK)
                continue;
            worst[k % 2] = fmax(worst[k % 2], compare(linear, self, &random));
            ++compared;
        }
        printf("%s: %.1e, on waves %.1e, in %d states\n", models[m], worst[0], worst[1], compared);
        assert_true(compared >= STATES / 2 && worst[0] < 1e-13 && worst[1] < 1e-12);
        pool_free(pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pull)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
