/* SPDX-License-Identifier: MIT
 * The importer as a master: two FMUs in one process, coupled to each other or to a controller. */
#include "importer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Motion of front.veh drives the hitch of rear.veh, whose force acts on the former at the next communication step.
 * Rows every 10 ms. */
void couple(const Unit *front, const Unit *rear, double step, double stop)
{
    static const char *const part[] = {"value", "rate", "acceleration"};
    Component a = instantiate(front, "front", STEPS), b = instantiate(rear, "rear", STEPS);
    const long steps = lround(stop / step), every = lround(0.01 / step);
    expect(every > 0, "a step of at most 10 ms");
    initialize_on(front, a, NULL, stop, 0, NULL);
    initialize_on(rear, b, NULL, stop, 0, NULL);
    printf("time,front.value [m],front.rate [m/s],rear.value [m],rear.rate [m/s]\n");
    for (long k = 0;; ++k) {
        for (int i = 0; i < 3; ++i) {
            char name[2][40];
            snprintf(name[0], sizeof name[0], "front.%s", part[i]);
            snprintf(name[1], sizeof name[1], "input.hitch.%s", part[i]);
            set_named(rear, b, name[1], get_named(front, a, name[0]));
        }
        set_named(front, a, "port.hitch.force.x", -get_named(rear, b, "drive"));
        if (k % every == 0)
            printf("%.15g,%.17g,%.17g,%.17g,%.17g\n", (double)k * step, get_named(front, a, "front.value"),
                   get_named(front, a, "front.rate"), get_named(rear, b, "rear.value"),
                   get_named(rear, b, "rear.rate"));
        if (k == steps)
            break;
        need(front->DoStep(a, (double)k * step, step, 1), "fmi2DoStep");
        need(rear->DoStep(b, (double)k * step, step, 1), "fmi2DoStep");
    }
    front->FreeInstance(a);
    rear->FreeInstance(b);
}

/* All real variables at the end of some steps. */
static double *finish(const Unit *unit, Component c)
{
    double *value = calloc((size_t)unit->d.variables + 1, sizeof *value);
    for (int i = 0; i < unit->d.variables; ++i)
        if (unit->d.variable[i].type == REAL)
            need(unit->GetReal(c, &unit->d.variable[i].reference, 1, &value[i]), "fmi2GetReal");
    unit->FreeInstance(c);
    return value;
}

static double *alone(const Unit *unit, double step, double stop)
{
    Component c = instantiate(unit, "alone", STEPS);
    initialize_on(unit, c, NULL, stop, 0, NULL);
    for (long k = 0; k < lround(stop / step); ++k)
        need(unit->DoStep(c, (double)k * step, step, 1), "fmi2DoStep");
    return finish(unit, c);
}

/* Each of two vehicles, step by step by turns, runs as it does alone. */
void both(const Unit *one, const Unit *other, double step, double stop)
{
    const Unit *unit[] = {one, other};
    double *lone[] = {alone(one, step, stop), alone(other, step, stop)};
    Component c[] = {instantiate(one, "one", STEPS), instantiate(other, "other", STEPS)};
    expect(strcmp(one->d.token, other->d.token) != 0, "two FMUs have the same GUID");
    for (int i = 0; i < 2; ++i)
        initialize_on(unit[i], c[i], NULL, stop, 0, NULL);
    for (long k = 0; k < lround(stop / step); ++k)
        for (int i = 0; i < 2; ++i)
            need(unit[i]->DoStep(c[i], (double)k * step, step, 1), "fmi2DoStep");
    for (int i = 0; i < 2; ++i) {
        double *together = finish(unit[i], c[i]);
        expect(!memcmp(together, lone[i], sizeof *together * (size_t)unit[i]->d.variables),
               "a vehicle beside another one runs otherwise");
        free(together);
        free(lone[i]);
    }
}

/* A controller in the master steers by the rack until the vehicle turns at 0.2 rad/s. */
void control(const Unit *unit, double step, double stop)
{
    const double wanted = 0.2, proportional = -0.02, integral = -0.15; /* the rack to the right steers to the left */
    Component c = instantiate(unit, "vehicle", STEPS);
    double sum = 0, rack = 0, yaw_rate = 0;
    initialize_on(unit, c, NULL, stop, 0, NULL);
    for (long k = 0; k < lround(stop / step); ++k) {
        yaw_rate = get_named(unit, c, "chassis_angular_velocity.z");
        sum += step * (wanted - yaw_rate);
        const double rate = (proportional * (wanted - yaw_rate) + integral * sum - rack) / step;
        rack += rate * step; /* what it reaches at the end of the step */
        set_named(unit, c, "input.rack.rate", rate);
        need(unit->DoStep(c, (double)k * step, step, 1), "fmi2DoStep");
        expect(fabs(get_named(unit, c, "input.rack.value") - rack) < 1e-12, "the rack is not where it was driven to");
    }
    fprintf(stderr, "importer: yaw rate %.6f rad/s, rack %.6f m\n", yaw_rate, rack);
    expect(fabs(yaw_rate - wanted) < 0.002, "the controller does not reach the yaw rate");
    unit->FreeInstance(c);
}
