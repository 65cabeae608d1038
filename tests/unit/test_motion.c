/* SPDX-License-Identifier: MIT
 * Trajectories of generated code against what is known of them: published positions, orders of the integrators,
 * conservation laws, and the invisibility of a change of the dependent Euler parameter. */
#include "motion.h"

#include <stdbool.h>
#include <stdio.h>

#include "gic_road.h"
#include "gic_runtime.h"
#include "glider.h"
#include "hmmwv.h"
#include "pendulum.h"
#include "undamped.h"

static const double pi = 3.14159265358979323846;

/* ---- published positions ------------------------------------------------------------------------------------- */

/* IFToMM benchmark A01; at this step RK4 is right to 1e-10 m at 10 s. */
static void test_pendulum(void **unused)
{
    (void)unused;
    Vehicle swing = vehicle_new(&pendulum_model);
    vehicle_steps(&swing, 0.001, GIC_RK4, 2000);
    assert_int_equal(swing.model->outputs(swing.head), GIC_OK);
    assert_true(fabs(output_named(&swing, "bob.x") + 0.793566195343) < 1e-9);
    assert_true(fabs(output_named(&swing, "bob.z") + 0.608483930444) < 1e-9);
    vehicle_steps(&swing, 0.001, GIC_RK4, 8000);
    assert_int_equal(swing.model->outputs(swing.head), GIC_OK);
    assert_true(fabs(output_named(&swing, "bob.x") + 0.275087462576) < 1e-9);
    assert_true(fabs(output_named(&swing, "bob.z") + 0.961419205099) < 1e-9);
    free(swing.head);
}

/* ---- orders ---------------------------------------------------------------------------------------------------- */

/* One second of a smooth ride at 5 m/s; the low waves keep every tire deflected by more than `fade`, beyond which its
 * damping is smooth. The final state into `end`. */
static void smooth_ride(gic_method method, int steps, double end[HMMWV_STATES])
{
    static const gic_road_sine waves = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.004, 8, 1, 0.5};
    static const char *const deflection[] = {"tire_f_l.deflection", "tire_f_r.deflection", "tire_r_l.deflection",
                                             "tire_r_r.deflection"};
    Vehicle car = vehicle_new(&hmmwv_model);
    car.head->road = &waves.head;
    *state_named(&car, "r.z") = 0.476;
    *state_named(&car, "v.x") = 5;
    *state_named(&car, "omega.z") = 0.2;
    *state_named(&car, "rack.rate") = 0.2;
    for (int i = 0; i < 20; ++i) {
        vehicle_steps(&car, 1.0 / steps, method, steps / 20);
        assert_int_equal(car.model->outputs(car.head), GIC_OK);
        for (int wheel = 0; wheel < 4; ++wheel)
            assert_true(output_named(&car, deflection[wheel]) > 0.011);
    }
    assert_true(fabs(gic_time(car.head) - 1) < 1e-12);
    memcpy(end, car.state, HMMWV_STATES * sizeof *end);
    free(car.head);
}

/* Largest difference of positions, orientation and coordinates, m and 1. */
static double distance(const double *a, const double *b)
{
    double worst = 0;
    for (int i = 0; i < HMMWV_TWIST; ++i)
        worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

/* Observed orders, from errors against a much finer step of the same method, and against the other method, which
 * shares neither its coefficients nor its start. The steps are small enough for the next term of the error to be less
 * than a tenth of an order, and large enough for the 1e-12 m that rounding gathers not to show. */
static void test_orders(void **unused)
{
    (void)unused;
    static const int steps[] = {[GIC_AB3] = 2000, [GIC_RK4] = 200}, expected[] = {[GIC_AB3] = 3, [GIC_RK4] = 4};
    static double fine[2][HMMWV_STATES], coarse_end[HMMWV_STATES], end[HMMWV_STATES];
    smooth_ride(GIC_AB3, 40000, fine[GIC_AB3]);
    smooth_ride(GIC_RK4, 8000, fine[GIC_RK4]);
    for (int method = GIC_AB3; method <= GIC_RK4; ++method) {
        smooth_ride((gic_method)method, steps[method], coarse_end);
        smooth_ride((gic_method)method, 2 * steps[method], end);
        for (int reference = GIC_AB3; reference <= GIC_RK4; ++reference) {
            const double order = log2(distance(coarse_end, fine[reference]) / distance(end, fine[reference]));
            if (!(fabs(order - expected[method]) < 0.1))
                fail_msg("observed order of method %d against method %d: %g", method, reference, order);
        }
    }
}

/* ---- conservation --------------------------------------------------------------------------------------------------
 */

/* Energy with what the tires store, on the flat road. */
static double total_energy(Vehicle *car)
{
    static const char *const tire[] = {"tire_f_l", "tire_f_r", "tire_r_l", "tire_r_r"};
    assert_int_equal(car->model->outputs(car->head), GIC_OK);
    double energy = output_named(car, "energy.kinetic") + output_named(car, "energy.potential");
    for (int i = 0; i < 4; ++i) {
        char name[40];
        snprintf(name, sizeof name, "%s.deflection", tire[i]);
        const double deflection = output_named(car, name), stiffness = 283000;
        snprintf(name, sizeof name, "%s.fz", tire[i]);
        /* never off the ground, where the force would have a kink */
        assert_true(deflection > 0);
        assert_true(fabs(output_named(car, name) - stiffness * deflection) < 1e-9 * stiffness);
        energy += 0.5 * stiffness * deflection * deflection;
    }
    return energy;
}

/* Largest change of energy over one second of rolling and bouncing without dampers; *moved: how far the kinetic energy
 * of the bounce went up and down, to compare with. */
static double energy_drift(gic_method method, int steps, double *moved)
{
    Vehicle car = vehicle_new(&undamped_model);
    *state_named(&car, "r.z") = 0.48;
    *state_named(&car, "v.x") = 5;
    *state_named(&car, "omega.x") = 0.1;
    *state_named(&car, "omega.z") = 0.4;
    *state_named(&car, "rack.rate") = 0.2;
    const double start = total_energy(&car);
    double worst = 0, low = INFINITY, high = 0;
    for (int i = 0; i < 100; ++i) {
        vehicle_steps(&car, 1.0 / steps, method, steps / 100);
        worst = fmax(worst, fabs(total_energy(&car) - start));
        low = fmin(low, output_named(&car, "energy.kinetic"));
        high = fmax(high, output_named(&car, "energy.kinetic"));
    }
    *moved = high - low;
    free(car.head);
    return worst;
}

/* Drift falls with the step at least as the method's order says; RK4's falls faster on oscillations, whose amplitude
 * it keeps to the fifth order. */
static void test_energy(void **unused)
{
    (void)unused;
    static const int steps[] = {[GIC_AB3] = 2000, [GIC_RK4] = 400}, expected[] = {[GIC_AB3] = 3, [GIC_RK4] = 4};
    for (int method = GIC_AB3; method <= GIC_RK4; ++method) {
        double moved;
        const double coarse = energy_drift((gic_method)method, steps[method], &moved);
        const double fine = energy_drift((gic_method)method, 2 * steps[method], &moved);
        const double order = log2(coarse / fine);
        if (!(order > expected[method] - 0.1))
            fail_msg("energy drifts by %g J, at half the step by %g J: order %g with method %d", coarse, fine, order,
                     method);
        /* and it is a small part of what goes to and fro */
        assert_true(coarse < 1e-3 * moved);
    }
}

/* Centre of mass of the HMMWV from poses and the masses of models/hmmwv.veh. */
static void centre_of_mass(Vehicle *car, double centre[3])
{
    /* in the order of the model: front axle, rear axle; body frames have their origin there, but for the chassis */
    static const double mass[] = {2086.52, 9.072, 23.965, 23.965, 90.555, 90.555, 23.965, 23.965, 90.555, 90.555};
    static const double of_chassis[] = {0.056, 0, 0.213};
    double pose[10][7], sum = 0;
    assert_int_equal(car->model->body_count, 10);
    assert_int_equal(car->model->poses(car->head, &pose[0][0]), GIC_OK);
    centre[0] = centre[1] = centre[2] = 0;
    for (int b = 0; b < 10; ++b) {
        sum += mass[b];
        for (int i = 0; i < 3; ++i)
            centre[i] += mass[b] * pose[b][i];
    }
    /* A = (2 e0^2 - 1) I + 2 (e e^T + e0 [e]x) */
    const double *e = &pose[0][3];
    const double dot = e[1] * of_chassis[0] + e[2] * of_chassis[1] + e[3] * of_chassis[2];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double cross = e[1 + j] * of_chassis[k] - e[1 + k] * of_chassis[j];
        centre[i] += mass[0] * ((2 * e[0] * e[0] - 1) * of_chassis[i] + 2 * (e[1 + i] * dot + e[0] * cross));
    }
    for (int i = 0; i < 3; ++i)
        centre[i] /= sum;
}

/* Thrown into the air, tumbling, springs strained: largest distance of the centre of mass from its parabola, which it
 * must follow whatever the bodies do to each other, and largest change of energy. */
static void fly(int steps, double *off, double *drift)
{
    static const double omega[] = {2, -1, 3}, v[] = {8, 0, 3};
    Vehicle car = vehicle_new(&glider_model);
    double start[3], centre[3], arm[3];
    for (int i = 0; i < 3; ++i) {
        car.state[GLIDER_STATE_V_X + i] = v[i];
        car.state[GLIDER_STATE_OMEGA_X + i] = omega[i];
    }
    car.state[GLIDER_STATE_R_Z] = 100;
    car.state[GLIDER_STATE_SPRING_F_L] += 0.02;
    car.state[GLIDER_STATE_SPRING_R_R] -= 0.015;
    car.state[GLIDER_STATE_RACK] = 0.01;
    centre_of_mass(&car, start);
    for (int i = 0; i < 3; ++i)
        arm[i] = start[i] - car.state[i];
    assert_int_equal(car.model->outputs(car.head), GIC_OK);
    const double energy = car.output[GLIDER_OUTPUT_ENERGY_KINETIC] + car.output[GLIDER_OUTPUT_ENERGY_POTENTIAL];
    *off = *drift = 0;
    for (int n = 0; n < 20; ++n) {
        vehicle_steps(&car, 1.0 / steps, GIC_RK4, steps / 20);
        centre_of_mass(&car, centre);
        const double t = gic_time(car.head);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const double velocity = v[i] + omega[j] * arm[k] - omega[k] * arm[j]; /* the suspension is at rest */
            const double expected = start[i] + velocity * t - (i == 2 ? 0.5 * 9.81 * t * t : 0);
            *off = fmax(*off, fabs(centre[i] - expected));
        }
        assert_int_equal(car.model->outputs(car.head), GIC_OK);
        assert_true(car.output[GLIDER_OUTPUT_TIRE_F_L_FZ] == 0);
        *drift = fmax(*drift, fabs(car.output[GLIDER_OUTPUT_ENERGY_KINETIC] +
                                   car.output[GLIDER_OUTPUT_ENERGY_POTENTIAL] - energy));
    }
    free(car.head);
}

static void test_flight(void **unused)
{
    (void)unused;
    double off[2], drift[2];
    fly(400, &off[0], &drift[0]);
    fly(800, &off[1], &drift[1]);
    /* both are errors of RK4, fourth order at least */
    if (!(off[0] < 1e-9 && log2(off[0] / off[1]) > 3.9))
        fail_msg("%g m off the parabola, at half the step %g m", off[0], off[1]);
    if (!(drift[0] < 1e-3 && log2(drift[0] / drift[1]) > 3.9))
        fail_msg("energy drifts by %g J, at half the step by %g J", drift[0], drift[1]);
}

/* ---- change of the dependent Euler parameter
 * --------------------------------------------------------------------------- */

enum { WINDOW = 10 }; /* steps before and after a change to compare with */

/* Outputs of a run at every step of it. */
typedef struct Record {
    int steps, outputs;
    double *value;     /* [steps + 1][outputs] */
    int64_t *switches; /* [steps + 1] */
} Record;

/* A bouncing car that turns at omega, on the road or in the air. */
static Record record(const gic_model *model, double height, const double omega[3], double step, int steps)
{
    Record r = {.steps = steps, .outputs = model->output_count};
    r.value = calloc((size_t)(steps + 1) * (size_t)r.outputs, sizeof *r.value);
    r.switches = calloc((size_t)steps + 1, sizeof *r.switches);
    assert_true(r.value && r.switches);
    Vehicle car = vehicle_new(model);
    *state_named(&car, "r.z") += height;
    *state_named(&car, "v.z") = 0.1;
    *state_named(&car, "rack.rate") = 0.1;
    memcpy(state_named(&car, "omega.x"), omega, 3 * sizeof *omega);
    for (int n = 0; n <= steps; ++n) {
        assert_int_equal(model->outputs(car.head), GIC_OK);
        memcpy(r.value + n * r.outputs, car.output, (size_t)r.outputs * sizeof *r.value);
        r.switches[n] = car.head->switch_count;
        vehicle_steps(&car, step, GIC_AB3, 1);
        /* no integrator history is lost */
        assert_true(n < 1 || car.head->history == 2);
    }
    free(car.head);
    return r;
}

static void record_free(Record *r)
{
    free(r->value);
    free(r->switches);
}

static bool switched(const Record *r, int n, int span)
{
    return r->switches[n] != r->switches[n + span];
}

/* b - a, for angles the short way round. */
static double change(const gic_signal *signal, double a, double b)
{
    return strcmp(signal->unit, "rad") ? b - a : remainder(b - a, 2 * pi);
}

/* The fourth difference of output o from step n on: h^4 times the fourth derivative, of the size of AB3's local error
 * (3/8 of that), unless the output jumps. */
static double roughness(const Record *r, const gic_signal *signal, int n, int o)
{
    static const double weight[] = {-1, 3, -3, 1}; /* on first differences, which know about angles */
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        const double *at = r->value + (n + i) * r->outputs + o;
        sum += weight[i] * change(signal, at[0], at[r->outputs]);
    }
    return fabs(sum);
}

/* The largest of the steps around n, of which those across a switch count (`across`) or the others. */
static double roughest(const Record *r, const gic_signal *signal, int n, int o, bool across)
{
    double worst = 0;
    for (int k = n - 3 - WINDOW; k <= n + WINDOW; ++k)
        if (switched(r, k, 4) == across)
            worst = fmax(worst, roughness(r, signal, k, o));
    return worst;
}

/* No output jumps by more than the local error where the dependent parameter changes: fourth differences across the
 * change are at most four times as large as around it. The factor is there because the change alters the orientation
 * by a local error: that of another parameter is now the one that normalization removes. An angle may grow evenly and
 * have no fourth difference of its own, but is made of parameters that have. Returns the angle that output `angle` has
 * run through. */
static double check_switches(const Record *r, const gic_model *model, const char *angle)
{
    const int turning = signal_index(model->output, model->output_count, angle);
    const int e0 = signal_index(model->output, model->output_count, "chassis_orientation.e0");
    double turned = 0;
    for (int o = 0; o < r->outputs; ++o) {
        const gic_signal *signal = &model->output[o];
        double scale = 0;
        for (int n = 0; n < r->steps; ++n) {
            const double *at = r->value + n * r->outputs + o;
            scale = fmax(scale, fabs(*at));
            if (o == turning)
                turned += change(signal, at[0], at[r->outputs]);
        }
        for (int n = WINDOW + 3; n + WINDOW + 4 < r->steps; ++n) {
            if (!switched(r, n, 1))
                continue;
            const double across = roughest(r, signal, n, o, true);
            double around = roughest(r, signal, n, o, false);
            for (int i = 0; i < 4 && !strcmp(signal->unit, "rad"); ++i)
                around = fmax(around, 2 * roughest(r, &model->output[e0 + i], n, e0 + i, false));
            if (!(across <= 4 * around + 1e-12 * scale))
                fail_msg("%s jumps at step %d: %g, around it %g", signal->name, n, across, around);
        }
    }
    return fabs(turned);
}

/* Two full turns on the road, which has no side force to resist: e0 and e3 take turns as the dependent
 * parameter, four times. A barrel roll in the air. */
static void test_switches(void **unused)
{
    (void)unused;
    Record spin = record(&undamped_model, 0, (double[]){0, 0, pi}, 0.005, 840);
    assert_true(check_switches(&spin, &undamped_model, "chassis_attitude.yaw") > 4 * pi);
    assert_true(spin.switches[spin.steps] >= 4);
    record_free(&spin);
    Record roll = record(&glider_model, 100, (double[]){2 * pi, 0, 0}, 0.005, 220);
    assert_true(check_switches(&roll, &glider_model, "chassis_attitude.roll") > 2 * pi);
    assert_true(roll.switches[roll.steps] >= 2);
    record_free(&roll);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_orders),   cmocka_unit_test(test_energy),
        cmocka_unit_test(test_flight),   cmocka_unit_test(test_switches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
