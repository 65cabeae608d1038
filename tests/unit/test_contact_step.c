/* SPDX-License-Identifier: MIT
 * Contacts within constant steps, by a mass on a stop: those that are made and lost again within one step, or lost and
 * made, against the closed solution; bounded work (head.most) in every step; more changes than a step follows end with
 * a status that names the contact. */
#include "gic_runtime.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { STOPS = 3 };

/* x'' = -pull - w^2 (x - edge) above the edge, for each of several masses side by side. */
typedef struct Masses {
    gic_head head;
    double state[2 * STOPS], rate[2 * STOPS], history[GIC_HISTORY(2 * STOPS, 0)], scratch[GIC_SCRATCH(2 * STOPS, 0)],
        touch[2 * STOPS];
    double edge[STOPS], omega, pull;
} Masses;

static int masses_rhs(void *self, double time, const double *state, double *rate)
{
    Masses *m = self;
    (void)time;
    ++m->head.rhs_count;
    for (int i = 0; i < STOPS; ++i) {
        rate[i] = state[STOPS + i];
        rate[STOPS + i] = -m->pull - m->omega * m->omega * fmax(state[i] - m->edge[i], 0);
    }
    return GIC_OK;
}

static int masses_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 2 * STOPS) ? GIC_OK : GIC_ERROR_INPUT;
}

static int masses_press(void *self, double time, const double *state, double *press)
{
    const Masses *m = self;
    (void)time;
    for (int i = 0; i < STOPS; ++i)
        press[i] = state[i] - m->edge[i];
    return GIC_OK;
}

static const char *const stop_name[STOPS] = {"first", "second", "third"};
static const gic_contacts masses_contacts = {stop_name, offsetof(Masses, touch), masses_press};

static const gic_model masses_model = {.abi_version = GIC_ABI_VERSION,
                                       .real_size = sizeof(gic_real),
                                       .size = sizeof(Masses),
                                       .slow_count = 2 * STOPS,
                                       .state_offset = offsetof(Masses, state),
                                       .rate_offset = offsetof(Masses, rate),
                                       .history_offset = offsetof(Masses, history),
                                       .scratch_offset = offsetof(Masses, scratch),
                                       .rhs = masses_rhs,
                                       .settle = masses_settle,
                                       .contact_count = STOPS,
                                       .contacts = &masses_contacts};

/* ---- the closed solution -------------------------------------------------------------------------------------- */

typedef struct Place {
    double x, v; /* over the edge */
} Place;

/* So long (s) does a mass that enters with speed v > 0 stay on its stop: its motion is about -pull / w^2. */
static double stay(const Masses *m, double v)
{
    return 2 * atan2(v * m->omega, m->pull) / m->omega;
}

/* From a place beyond the edge: harmonic. */
static Place harmonic(const Masses *m, Place from, double t)
{
    const double w = m->omega, rest = -m->pull / (w * w), a = from.x - rest, c = cos(w * t), s = sin(w * t);
    return (Place){rest + a * c + from.v / w * s, from.v * c - a * w * s};
}

static Place flight(const Masses *m, Place from, double t)
{
    return (Place){from.x + from.v * t - m->pull * t * t / 2, from.v - m->pull * t};
}

/* Thrown up from below the edge at `speed` there, which it reaches at `reach`. */
static Place thrown(const Masses *m, double speed, double reach, double t)
{
    const double in = stay(m, speed), after = t - reach;
    if (after <= 0)
        return flight(m, (Place){0, speed}, after);
    if (after <= in)
        return harmonic(m, (Place){0, speed}, after);
    return flight(m, (Place){0, -speed}, after - in);
}

/* ---- made and lost -------------------------------------------------------------------------------------------- */

static double off(const Masses *m, int i, Place due)
{
    return fmax(fabs(m->state[i] - m->edge[i] - due.x), fabs(m->state[STOPS + i] - due.v));
}

/* All masses are thrown up; the middle of the contact of mass i is at `middle` + i `apart`, and it lasts `lasts`. */
static void skims(double step, int32_t method, double middle, double apart, double lasts, double edge)
{
    Masses m = {.omega = 5, .pull = 8, .edge = {edge, edge, edge}};
    const double speed = m.pull / m.omega * tan(lasts * m.omega / 2);
    double reach[STOPS];
    for (int i = 0; i < STOPS; ++i) {
        reach[i] = middle + i * apart - stay(&m, speed) / 2;
        const Place start = thrown(&m, speed, reach[i], 0);
        m.state[i] = edge + start.x;
        m.state[STOPS + i] = start.v;
    }
    Masses blind = m;
    m.head.locate = 1;
    double worst = 0, worst_blind = 0;
    const int steps = (int)(2 * middle / step) + 4;
    for (int k = 0; k < steps; ++k) {
        assert_int_equal(gic_step(&masses_model, &m, step, method), GIC_OK);
        assert_int_equal(gic_step(&masses_model, &blind, step, method), GIC_OK);
        for (int i = 0; i < STOPS; ++i) {
            const Place due = thrown(&m, speed, reach[i], gic_time(&m));
            worst = fmax(worst, off(&m, i, due));
            worst_blind = fmax(worst_blind, off(&blind, i, due));
        }
    }
    /* flights are parabolas, which have no error; of a contact RK4 leaves (w t)^5 / 120 of its speed */
    /* one of a thousandth of a step may pass unseen beside another, whose force leaves next to nothing */
    const int seen = (int)m.head.contact_count, missed = 2 * STOPS - seen;
    const double limit = 1e-10 + 2 * speed * pow(m.omega * lasts, 5) / 120 + (missed ? 0.01 * worst_blind : 0);
    if (missed < 0 || (missed > 0 && lasts > 2e-3 * step) || !(worst <= limit) || !(worst <= worst_blind + 1e-10))
        fail_msg("step %g, method %d, middle %.17g, apart %g, lasts %g: %d changes, off %g of %g, blindly %g", step,
                 method, middle, apart, lasts, seen, worst, limit, worst_blind);
}

/* Contacts in the middle of a step and anywhere in it, of a thousandth of its length to nearly all; masses one after
 * the other and at the same time; steps, places and speeds that are powers of two among them. */
static void test_touch_and_leave(void **state)
{
    static const double steps[] = {0.0078125, 0.01}, place[] = {0.5, 0.25, 0.75, 0.3127},
                        share[] = {0.001, 0.01, 0.125, 0.25, 0.4};
    (void)state;
    for (int s = 0; s < 2; ++s)
        for (int method = 0; method < 2; ++method)
            for (int p = 0; p < 4; ++p)
                for (int l = 0; l < 5; ++l)
                    for (int edge = 0; edge < 2; ++edge) {
                        const double middle = (20 + place[p]) * steps[s];
                        skims(steps[s], method, middle, 0, share[l] * steps[s], edge);
                        skims(steps[s], method, middle, steps[s], share[l] * steps[s], edge);
                        skims(steps[s], method, middle, 1e-3 * steps[s], share[l] * steps[s], edge);
                        skims(steps[s], method, 1.5 * steps[s], 0.25 * steps[s], 0.1 * steps[s], edge);
                    }
}

/* A mass that bounces softly on its stop, from which it is parted for less than a step each time: lost and made. */
static void test_leave_and_touch(void **state)
{
    (void)state;
    for (int method = 0; method < 2; ++method)
        for (int part = 1; part <= 9; part += 2) {
            const double step = 1.0 / 1024, apart = step * part / 10;
            Masses m = {.omega = 20, .pull = -8};
            /* on the stop it moves about pull / w^2 and leaves so fast that it returns after `apart` */
            const double speed = 8 * apart / 2, in = stay(&m, speed);
            for (int i = 0; i < STOPS; ++i) {
                m.edge[i] = -0.125 * i;
                m.state[i] = m.edge[i];
                m.state[STOPS + i] = speed;
            }
            m.head.locate = 1;
            m.head.touching = 0;
            double worst = 0;
            for (int k = 0; k < 2000; ++k) {
                assert_int_equal(gic_step(&masses_model, &m, step, method), GIC_OK);
                const double t = fmod(gic_time(&m), in + apart);
                const Place due = t < in ? harmonic(&m, (Place){0, speed}, t) : flight(&m, (Place){0, -speed}, t - in);
                for (int i = 0; i < STOPS; ++i)
                    worst = fmax(worst, off(&m, i, due));
            }
            const double end = gic_time(&m), whole = floor(end / (in + apart));
            const int changes = 2 * (int)whole + (end - whole * (in + apart) > in);
            /* AB3: 3/8 (w h)^4 a step; RK4 is far below */
            const double limit = (method == GIC_AB3 ? 0.4 * pow(20 * step, 4) : pow(20 * step, 5) / 60) * 2000 * 0.4;
            if (m.head.contact_count / STOPS - changes > 1 || !(worst <= limit))
                fail_msg("method %d, part %d: %d changes of %d, off %g of %g", method, part,
                         (int)m.head.contact_count / STOPS, changes, worst, limit);
        }
}

/* ---- loads that bend ------------------------------------------------------------------------------------------ */

/* Masses thrown up to stops on which they stay for `stays` steps, with head.locate as given: the largest error from
 * three steps before to three steps after, relative to the speed. */
static double thrown_off(int32_t locate, int32_t method, double stays, double reach)
{
    const double step = 1.0 / 256, speed = 2;
    Masses m = {.omega = 3.141592653589793 / (stays * step), .head = {.locate = locate}};
    double worst = 0;
    for (int i = 0; i < STOPS; ++i) {
        m.edge[i] = 0.5 * i;
        m.state[i] = m.edge[i] - speed * (reach + 0.25 * i) * step;
        m.state[STOPS + i] = speed;
    }
    for (int k = 0; k < reach + stays + 4; ++k) {
        assert_int_equal(gic_step(&masses_model, &m, step, method), GIC_OK);
        for (int i = 0; i < STOPS; ++i) {
            const Place due = thrown(&m, speed, (reach + 0.25 * i) * step, gic_time(&m));
            const double place = fabs(m.state[i] - m.edge[i] - due.x) * m.omega,
                         rate = fabs(m.state[STOPS + i] - due.v);
            worst = fmax(worst, fmax(place, rate) / speed);
        }
    }
    return worst;
}

/* A load that comes and goes within 3 to 12 steps. RK4 leaves some (w h)^5 / 120 of each step of it, AB3 far more. In
 * parts in which it bends by a 64th, w h is 1/8, and 25 of them, half a period, leave 6e-6. The step in which a load
 * begins shows only a share of the bend, which matters where the load lasts but few steps: there parts of half a step
 * with w h = pi / 6 leave 3e-4 each. */
static void test_loads(void **state)
{
    (void)state;
    for (int method = 0; method < 2; ++method)
        for (double stays = 3; stays <= 12; stays *= 2)
            for (int place = 0; place < 8; ++place) {
                const double reach = 6 + 0.125 * place;
                const double parted = thrown_off(2, method, stays, reach), plain = thrown_off(1, method, stays, reach);
                if (!(parted < (stays < 6 ? 2e-3 : 1e-4)) || !(parted < plain / 16))
                    fail_msg("method %d, %g steps from %g on: off %g, without parts %g", method, stays, reach, parted,
                             plain);
            }
}

/* ---- bounded work ----------------------------------------------------------------------------------------------- */

/* No step takes more than it may, whatever happens in it; what it may take without end is as if there were no bound. */
static void test_most(void **state)
{
    (void)state;
    for (int way = 0; way < 4; ++way)
        for (int most = GIC_LEAST_MOST(1); most <= 200; most += most < 60 ? 1 : 20) {
            const int32_t method = way % 2;
            Masses m = {.omega = 300, .pull = 8}, free;
            for (int i = 0; i < STOPS; ++i) {
                m.edge[i] = 0.5;
                m.state[STOPS + i] = 3 + 0.001 * i;
            }
            m.head.locate = 1 + way / 2;
            free = m;
            m.head.most = most;
            for (int k = 0; k < 200; ++k) {
                const int64_t before = m.head.rhs_count + m.head.look_count;
                assert_int_equal(gic_step(&masses_model, &m, 0.005, method), GIC_OK);
                assert_int_equal(gic_step(&masses_model, &free, 0.005, method), GIC_OK);
                assert_true(m.head.rhs_count + m.head.look_count - before <= most);
            }
            assert_int_equal(free.head.passed_count, 0);
            /* each is located or gone over; some are, where no step may locate one */
            assert_true(most > 16 || m.head.contact_count == 0);
            assert_true(m.head.contact_count + m.head.passed_count > 0);
            /* parts of steps where loads bend take what they are given */
            assert_true(way > 1 || most < 200 ||
                        (!m.head.passed_count && !memcmp(m.state, free.state, sizeof m.state)));
            assert_true(gic_bounded(m.state, 2 * STOPS));
        }
    Masses m = {.omega = 1, .head = {.most = GIC_LEAST_MOST(1) - 1}};
    assert_int_equal(gic_step(&masses_model, &m, 0.01, GIC_RK4), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step(&masses_model, &m, 0.01, GIC_AB3), GIC_ERROR_ARGUMENT);
}

/* A point that passes a ladder of contacts, one each millimetre from 1 m on. */
typedef struct Ladder {
    gic_head head;
    double state[1], rate[1], history[GIC_HISTORY(1, 0)], scratch[GIC_SCRATCH(1, 0)], touch[2 * GIC_CONTACTS], speed;
} Ladder;

static int ladder_rhs(void *self, double time, const double *state, double *rate)
{
    (void)time;
    (void)state;
    rate[0] = ((Ladder *)self)->speed;
    return GIC_OK;
}

static int ladder_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 1) ? GIC_OK : GIC_ERROR_INPUT;
}

static int ladder_press(void *self, double time, const double *state, double *press)
{
    (void)self;
    (void)time;
    for (int i = 0; i < GIC_CONTACTS; ++i)
        press[i] = state[0] - 1 - 0.001 * i;
    return GIC_OK;
}

static const char *const rung_name[GIC_CONTACTS] = {[0] = "rung 0", [GIC_CHANGES] = "rung 32"};
static const gic_contacts ladder_contacts = {rung_name, offsetof(Ladder, touch), ladder_press};

static const gic_model ladder_model = {.abi_version = GIC_ABI_VERSION,
                                       .real_size = sizeof(gic_real),
                                       .size = sizeof(Ladder),
                                       .slow_count = 1,
                                       .state_offset = offsetof(Ladder, state),
                                       .rate_offset = offsetof(Ladder, rate),
                                       .history_offset = offsetof(Ladder, history),
                                       .scratch_offset = offsetof(Ladder, scratch),
                                       .rhs = ladder_rhs,
                                       .settle = ladder_settle,
                                       .contact_count = GIC_CONTACTS,
                                       .contacts = &ladder_contacts};

/* As many changes in a step as it follows; one more: a status, the name of the contact, the instance as before. */
static void test_bound(void **state)
{
    (void)state;
    for (int method = 0; method < 2; ++method)
        for (int before = 0; before < 4; ++before)
            for (int beyond = 0; beyond < 2; ++beyond) {
                Ladder ladder = {.state = {0.25}, .head = {.locate = 1}};
                for (int k = 0; k < before; ++k)
                    assert_int_equal(gic_step(&ladder_model, &ladder, 0.0625, method), GIC_OK);
                /* to the middle between two rungs */
                ladder.speed = 16 * (0.75 + 0.001 * (GIC_CHANGES - 0.5 + beyond));
                const Ladder good = ladder;
                const int status = gic_step(&ladder_model, &ladder, 0.0625, GIC_RK4);
                assert_int_equal(status, beyond ? GIC_ERROR_EVENTS : GIC_OK);
                if (!beyond) {
                    assert_int_equal(ladder.head.contact_count, GIC_CHANGES);
                    assert_null(gic_event_name(&ladder_model, &ladder));
                    continue;
                }
                assert_string_equal(gic_event_name(&ladder_model, &ladder), "rung 32");
                assert_memory_equal(ladder.state, good.state, sizeof ladder.state);
                assert_true(gic_time(&ladder) == gic_time(&good));
                /* it can go on in shorter steps */
                for (int k = 0; k < 64; ++k)
                    assert_int_equal(gic_step(&ladder_model, &ladder, 0.0009765625, method), GIC_OK);
                assert_int_equal(ladder.head.contact_count, GIC_CHANGES + 1);
                assert_null(gic_event_name(&ladder_model, &ladder));
            }
}

/* Numbers that head.locate does not have, and its bounds, leave the instance as it was. */
static void test_arguments(void **state)
{
    (void)state;
    static const int32_t wrong[] = {3, -1, 2147483647};
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
            Masses m = {.omega = 5, .state = {1, 1, 1}};
            for (int before = 0; before < 6; before += 3) {
                for (int k = 0; k < before; ++k)
                    assert_int_equal(gic_step(&masses_model, &m, 0.01, method), GIC_OK);
                m.head.locate = wrong[i];
                const Masses good = m;
                assert_int_equal(gic_step(&masses_model, &m, 0.01, method), GIC_ERROR_ARGUMENT);
                assert_memory_equal(m.state, good.state, sizeof m.state);
                assert_true(gic_time(&m) == gic_time(&good));
                m.head.locate = 0;
                assert_int_equal(gic_step(&masses_model, &m, 0.01, method), GIC_OK);
            }
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_touch_and_leave), cmocka_unit_test(test_leave_and_touch),
                                       cmocka_unit_test(test_loads),           cmocka_unit_test(test_most),
                                       cmocka_unit_test(test_bound),           cmocka_unit_test(test_arguments)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
