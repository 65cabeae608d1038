/* SPDX-License-Identifier: MIT
 * fmu_step LIBRARY TOKEN: what a communication step of an FMU (2.0) costs beyond the step of the same code called
 * directly; compiled with the FMU's own sources by fmu.sh. Both take the same steps, by turns, and must end in the same
 * state to the last bit. Prints the least time of a step in microseconds: plain, FMU. */
#define _POSIX_C_SOURCE 200809L
#include "fmi2_api.h"
#include "fmu_core.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 25, STEPS = 1000 };

static const gic_model *const model = &FMU_DESCRIPTOR;

static void *library;

static void *allocate(size_t count, size_t size)
{
    return calloc(count, size);
}

static void function(const char *name, void *pointer)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "fmu_step: no function %s\n", name);
        exit(1);
    }
    memcpy(pointer, &found, sizeof found);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void need(int status, const char *what)
{
    if (status) {
        fprintf(stderr, "fmu_step: %s: status %d\n", what, status);
        exit(1);
    }
}

/* The plain instance at the state of the FMU after its initialization. */
static void set_up(FMU_TYPE *plain, const double *state)
{
    need(model->setup_with(plain, fmu_start_parameter), "set-up");
    memcpy(plain->input, fmu_start_input, sizeof(gic_real) * FMU_INPUTS);
    memcpy(plain->state, state, sizeof(gic_real) * FMU_STATES);
    for (int32_t i = model->free_base; i < model->discrete_count; ++i)
        plain->discrete[i] = FMU_START_GEAR;
}

int main(int count, char **word)
{
    static FMU_TYPE plain;
    static const fmi2CallbackFunctions callbacks = {NULL, allocate, free, NULL, NULL};
    fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *,
                                 fmi2Boolean, fmi2Boolean);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component), (*reset)(fmi2Component);
    fmi2Status (*get)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
    fmi2Status (*step)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
    double least[2] = {1e9, 1e9}, state[2][FMU_STATES_ROOM];
    fmi2ValueReference reference[FMU_STATES_ROOM];
    const double length = FMU_START_STEP;
    if (count != 3 || !(library = dlopen(word[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "fmu_step: %s\n", count == 3 ? dlerror() : "usage: fmu_step LIBRARY TOKEN");
        return 1;
    }
    function("fmi2Instantiate", &instantiate);
    function("fmi2EnterInitializationMode", &enter);
    function("fmi2ExitInitializationMode", &leave);
    function("fmi2Reset", &reset);
    function("fmi2GetReal", &get);
    function("fmi2DoStep", &step);
    for (unsigned i = 0; i < FMU_STATES; ++i)
        reference[i] = FMU_STATE * FMU_KIND + i;
    fmi2Component c = instantiate("fmu", fmi2CoSimulation, word[2], "", &callbacks, 0, 0);
    need(c == NULL, "instance");
    for (int run = 0; run < RUNS; ++run) {
        double from;
        need(reset(c), "reset");
        need(enter(c), "initialization");
        need(leave(c), "end of initialization");
        need(get(c, reference, FMU_STATES, state[0]), "states");
        set_up(&plain, state[0]);
        from = now();
        for (int k = 0; k < STEPS; ++k)
            need(FMU_START_METHOD == GIC_AB3 + 1 ? gic_step_steady(model, &plain, length, FMU_START_RATIO, FMU_STEADY)
                                                 : gic_step(model, &plain, length, GIC_RK4),
                 "plain step");
        least[0] = now() - from < least[0] ? now() - from : least[0];
        from = now();
        for (int k = 0; k < STEPS; ++k)
            need(step(c, k * length, length, 1), "step of the FMU");
        least[1] = now() - from < least[1] ? now() - from : least[1];
        need(get(c, reference, FMU_STATES, state[1]), "states");
        need(memcmp(state[1], plain.state, sizeof(double) * FMU_STATES) != 0, "another state");
    }
    printf("%.4f %.4f\n", 1e6 * least[0] / STEPS, 1e6 * least[1] / STEPS);
    return 0;
}
