/* SPDX-License-Identifier: MIT
 * Variable steps find every beginning and end of a contact: many in what would be one step, at the same time and a
 * nanosecond apart, those that touch and leave; and contacts that change without end give a status, not a hang. */
#include "gic_runtime.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* A point on a line that moves at 1 m/s. Each contact holds between two places; its number is a parabola over them
 * whose integral is 1, and the second state is the integral of all. */
typedef struct Point {
    gic_head head;
    double state[2], rate[2], history[GIC_HISTORY(2, 0)], scratch[GIC_SCRATCH(2, 0)];
    int count;
    double low[GIC_CONTACTS], high[GIC_CONTACTS]; /* m */
    double beat;                                  /* 1/s: of a contact that is made and lost as often; 0: none */
} Point;

static double depth(const Point *point, int i, double x)
{
    return (x - point->low[i]) * (point->high[i] - x) * 6 / pow(point->high[i] - point->low[i], 3);
}

static int point_rhs(void *self, double time, const double *state, double *rate)
{
    Point *point = self;
    (void)time;
    ++point->head.rhs_count;
    rate[0] = 1;
    rate[1] = 0;
    for (int i = 0; i < point->count; ++i)
        rate[1] += fmax(depth(point, i, state[0]), 0);
    return GIC_OK;
}

static int point_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 2) ? GIC_OK : GIC_ERROR_INPUT;
}

static int point_contacts(void *self, double time, const double *state, double *press)
{
    const Point *point = self;
    for (int i = 0; i < GIC_CONTACTS; ++i)
        press[i] = i < point->count ? depth(point, i, state[0]) : -1;
    if (point->beat > 0)
        press[GIC_CONTACTS - 1] = sin(point->beat * time) + 1e-3;
    return GIC_OK;
}

static const char *const point_name[GIC_CONTACTS] = {"first", [GIC_CONTACTS - 1] = "last"};
static const gic_contacts point_touches = {point_name, 0, point_contacts};

static const gic_model point_model = {.abi_version = GIC_ABI_VERSION,
                                      .real_size = sizeof(gic_real),
                                      .size = sizeof(Point),
                                      .slow_count = 2,
                                      .state_offset = offsetof(Point, state),
                                      .rate_offset = offsetof(Point, rate),
                                      .history_offset = offsetof(Point, history),
                                      .scratch_offset = offsetof(Point, scratch),
                                      .rhs = point_rhs,
                                      .settle = point_settle,
                                      .contact_count = GIC_CONTACTS,
                                      .contacts = &point_touches};

/* 2 s with few or no output times; the sum must be that of all contacts, and each have been made and lost. */
static void passes(Point *point, int32_t method, double tolerance, double limit)
{
    Variable *variable = variable_open(&point_model, method, tolerance);
    int status = GIC_OK;
    assert_non_null(variable);
    while (status == GIC_OK && gic_time(point) < 2)
        status = variable_step(variable, point, 2);
    variable_close(variable);
    assert_int_equal(status, GIC_OK);
    assert_float_equal(point->state[0], 2, 1e-12);
    assert_float_equal(point->state[1], point->count, limit);
}

static const int32_t methods[] = {METHOD_ADAMS, METHOD_RKCK};

/* Contacts by twos from 0.1 to 1.9 m, each 30 mm wide, those of a pair at the same place, a nanometre apart, or
 * touching. */
static void test_many(void **state)
{
    static const double apart[] = {0, 1e-9, 0.03, 0.015};
    (void)state;
    for (int m = 0; m < 2; ++m)
        for (int k = 0; k < 4; ++k) {
            Point point = {.count = 60};
            for (int i = 0; i < point.count; ++i) {
                point.low[i] = 0.1 + 0.06 * (i / 2) + apart[k] * (i % 2);
                point.high[i] = point.low[i] + 0.03;
            }
            passes(&point, methods[m], 1e-10, 1e-6);
            assert_int_equal(point.head.contact_count, 2 * point.count);
        }
}

/* One that lasts a millisecond, or three microseconds (slopes are differences over one), where a step without it would
 * have no end: in 2 s the step is bound to go over both its ends. */
static void test_short(void **state)
{
    static const double width[] = {1, 0.1, 1e-3, 3e-6}, place[] = {0, 0.5, 1, 0.3127};
    (void)state;
    for (int m = 0; m < 2; ++m)
        for (int w = 0; w < 4; ++w)
            for (int p = 0; p < 4; ++p) {
                Point point = {.count = 1, .low = {place[p]}, .high = {place[p] + width[w]}};
                passes(&point, methods[m], 1e-6, 1e-4);
                /* one that ends at the end is still to come */
                assert_int_equal(point.head.contact_count, (place[p] > 0) + (place[p] + width[w] < 2));
            }
}

/* A contact that changes ten thousand million times a second: a status, the instance at a step's start. */
static void test_chatter(void **state)
{
    (void)state;
    for (int m = 0; m < 2; ++m) {
        Point point = {.beat = 6e10};
        Variable *variable = variable_open(&point_model, methods[m], 1e-6);
        int status = GIC_OK, steps = 0;
        assert_non_null(variable);
        while (status == GIC_OK && gic_time(&point) < 2 && steps < 100000) {
            const double before = gic_time(&point), place = point.state[0];
            status = variable_step(variable, &point, 2);
            ++steps;
            if (status != GIC_OK)
                assert_true(gic_time(&point) == before && point.state[0] == place);
        }
        variable_close(variable);
        assert_int_equal(status, GIC_ERROR_EVENTS);
        assert_string_equal(gic_event_name(&point_model, &point), "last");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_many), cmocka_unit_test(test_short),
                                       cmocka_unit_test(test_chatter)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
