/* SPDX-License-Identifier: MIT
 * Random sequences of contacts: a mass between two stops, with weight or without, by every integrator with location,
 * against a solution in long double that goes from event to event: none is lost, none is found twice, numbers are
 * finite and near. `test_event_sequences COUNT` makes more of them. */
#include "gic_runtime.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { EVENTS = 16 };

static long sequences = 2000;

/* x'' = pull - w^2 depth beyond `low` and `high`. */
typedef struct Mass {
    gic_head head;
    double state[2], rate[2], history[GIC_HISTORY(2, 0)], scratch[GIC_SCRATCH(2, 0)], touch[4];
    double low, high, omega[2], pull; /* m, 1/s at either end, m/s^2 */
} Mass;

static int mass_rhs(void *self, double time, const double *state, double *rate)
{
    Mass *mass = self;
    (void)time;
    ++mass->head.rhs_count;
    rate[0] = state[1];
    rate[1] = mass->pull + mass->omega[0] * mass->omega[0] * fmax(mass->low - state[0], 0) -
              mass->omega[1] * mass->omega[1] * fmax(state[0] - mass->high, 0);
    return GIC_OK;
}

static int mass_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 2) ? GIC_OK : GIC_ERROR_INPUT;
}

static int mass_contacts(void *self, double time, const double *state, double *press)
{
    const Mass *mass = self;
    (void)time;
    press[0] = mass->low - state[0];
    press[1] = state[0] - mass->high;
    return GIC_OK;
}

static const gic_contacts mass_touches = {(const char *const[]){"low", "high"}, offsetof(Mass, touch), mass_contacts};

static const gic_model mass_model = {.abi_version = GIC_ABI_VERSION,
                                     .real_size = sizeof(gic_real),
                                     .size = sizeof(Mass),
                                     .slow_count = 2,
                                     .state_offset = offsetof(Mass, state),
                                     .rate_offset = offsetof(Mass, rate),
                                     .history_offset = offsetof(Mass, history),
                                     .scratch_offset = offsetof(Mass, scratch),
                                     .rhs = mass_rhs,
                                     .settle = mass_settle,
                                     .contact_count = 2,
                                     .contacts = &mass_touches};

/* ---- from event to event ---------------------------------------------------------------------------------------- */

typedef struct Exact {
    long double x, v, time, shortest; /* shortest: of the contacts */
    int grazes;                       /* contacts without a depth but for rounding, made or not: either is right */
} Exact;

/* The first time > 0 at which x + v t + a t^2 / 2 is 0; INFINITY: none. For x != 0 or a root that leads away from it.
 */
static long double reaches(long double x, long double v, long double a)
{
    long double soonest = INFINITY;
    if (a == 0)
        return x != 0 && -x / v > 0 ? -x / v : INFINITY;
    if (x == 0)
        return -2 * v / a > 0 ? -2 * v / a : INFINITY;
    const long double inner = v * v - 2 * a * x;
    if (inner < 0)
        return INFINITY;
    const long double q = -(v + copysignl(sqrtl(inner), v)), root[2] = {q / a, 2 * x / q};
    for (int i = 0; i < 2; ++i)
        if (root[i] > 0 && root[i] < soonest)
            soonest = root[i];
    return soonest;
}

/* One flight from the start, or from a stop that has been left; then the contact; half a piece after the last one. */
static Exact follow(const Mass *mass)
{
    Exact at = {mass->state[0], mass->state[1], 0, INFINITY, 0};
    const long double a = mass->pull;
    int left = -1; /* the end where the flight began */
    for (int event = 0; event <= EVENTS; ++event) {
        const int rest = event == EVENTS; /* what follows is gone half through */
        const long double from_low = left == 0 ? 0 : at.x - mass->low, from_high = left == 1 ? 0 : at.x - mass->high;
        if (event % 2 == 0) {
            const long double low = reaches(from_low, at.v, a), high = reaches(from_high, at.v, a);
            const int end = high < low;
            const long double t = (end ? high : low) / (rest ? 2 : 1);
            const long double turn = a == 0 ? 0 : -at.v / a, there = at.x + at.v * turn / 2;
            if (turn > 0 && turn < t + 1e-6L && fminl(fabsl(there - mass->low), fabsl(there - mass->high)) < 1e-6L)
                ++at.grazes;
            at.x = rest ? at.x + at.v * t + a * t * t / 2 : end ? mass->high : mass->low;
            at.v += a * t;
            at.time += t;
            left = end;
        } else {
            const long double w = mass->omega[left == 1], side = left == 1 ? 1 : -1;
            const long double c = side * a / (w * w), v = side * at.v;
            const long double half = fmaxl(atan2l(v, -w * c) / w, 0); /* of the contact */
            at.shortest = fminl(at.shortest, 2 * half);
            at.grazes += half < 1e-6L;
            at.time += 2 * half;
            at.v = -at.v;
        }
    }
    return at;
}

/* ---- a sequence ---------------------------------------------------------------------------------------------------
 */

static uint64_t seed = 1;

static double uniform(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

/* Between low and high; half of them numbers as people write them. */
static double draw(double low, double high)
{
    static const double nice[] = {0.125, 0.25, 0.5, 1, 2, 4, 5, 8, 10, 20, 50};
    for (int i = 0; i < 20 && seed % 2; ++i) {
        const double x = nice[(size_t)(uniform() * 11)];
        if (x >= low && x <= high)
            return x;
    }
    return low * pow(high / low, uniform());
}

static void draw_mass(Mass *mass)
{
    const double gap = draw(0.1, 2), share = uniform();
    *mass = (Mass){.low = 0, .high = gap, .omega = {draw(5, 100), draw(5, 100)}};
    mass->state[0] = share < 0.3 ? gap / 2 : share < 0.9 ? gap * uniform() : gap;
    mass->state[1] = (uniform() < 0.5 ? 1 : -1) * draw(0.1, 5);
    /* from the edge inwards: what begins in a contact is test_contact_variable.sh's */
    if (mass->state[0] >= gap)
        mass->state[1] = -fabs(mass->state[1]);
    mass->pull = uniform() < 0.3 ? 0 : (uniform() < 0.5 ? 1 : -1) * draw(0.1, 20);
}

static int by_variable_steps(Mass *mass, double end, int32_t method)
{
    Variable *variable = variable_open(&mass_model, method, 1e-10);
    int status = GIC_OK;
    assert_non_null(variable);
    while (status == GIC_OK && gic_time(mass) < end)
        status = variable_step(variable, mass, end);
    variable_close(variable);
    return status;
}

static int by_constant_steps(Mass *mass, double end, int32_t method, int32_t locate, double most)
{
    const double steps = ceil(end / most);
    int status = GIC_OK;
    mass->head.locate = locate;
    for (double k = 0; k < steps && status == GIC_OK; ++k)
        status = gic_step(&mass_model, mass, end / steps, method);
    return status;
}

static void test_random(void **state)
{
    static const char *const name[] = {"adams", "rkck", "ab3", "rk4", "ab3, loads", "rk4, loads"};
    long events = 0, skipped = 0;
    (void)state;
    for (long k = 0; k < sequences; ++k)
        for (int way = 0; way < 6; ++way) {
            Mass mass;
            draw_mass(&mass);
            const Exact exact = follow(&mass);
            const double end = (double)exact.time, speed = fabs(mass.state[1]) + sqrt(2 * fabs(mass.pull) * mass.high);
            const double omega = fmax(mass.omega[0], mass.omega[1]);
            /* contacts that constant steps resolve, in some thousand of them; parts of RK4 resolve more */
            const double step = fmin((double)exact.shortest / 8, 0.02 / omega) * (way < 5 ? 1 : 4);
            const Mass start = mass;
            if (!isfinite(end) || end > 1000 || (way > 1 && end / step > 20000)) {
                ++skipped;
                continue;
            }
            const int status = way < 2 ? by_variable_steps(&mass, end, way ? METHOD_RKCK : METHOD_ADAMS)
                                       : by_constant_steps(&mass, end, way % 2 ? GIC_RK4 : GIC_AB3, way / 2, step);
            const double off =
                fmax(fabs(mass.state[0] - (double)exact.x) * omega, fabs(mass.state[1] - (double)exact.v));
            /* AB3: 3/8 (w h)^4 a step, over the phase of all contacts and the flights after them, and RK4 far below;
             * variable steps: some thousand errors of the tolerance in place and speed, which grow with the way */
            const double limit = way < 2 ? 1e4 * 1e-10 * (1 + end) * (1 + omega) : way % 2 ? 1e-3 * speed : 0.1 * speed;
            const int changes = (int)mass.head.contact_count;
            if (status != GIC_OK || abs(changes - EVENTS) > 2 * exact.grazes || !(off <= limit)) {
                printf("%s, seed %ld: status %d, %d changes, off %g of %g; gap %.17g, omega %.17g %.17g, pull %.17g, "
                       "x %.17g, v %.17g, end %.17g\n",
                       name[way], k, status, changes, off, limit, start.high, start.omega[0], start.omega[1],
                       start.pull, start.state[0], start.state[1], end);
                fail();
            }
            events += EVENTS;
        }
    printf("%ld events, %ld sequences left out\n", events, skipped);
    assert_true(skipped < 3 * sequences / 2);
}

int main(int count, char **word)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random)};
    if (count > 1)
        sequences = atol(word[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
