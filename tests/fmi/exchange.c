/* SPDX-License-Identifier: MIT
 * Model exchange: the importer integrates, by CVODE, and finds events by their indicators. */
#include "importer.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

typedef struct Exchange {
    const Unit *unit;
    Component c;
    const double *plane; /* the road, NULL: the FMU's own */
    double nominal[1000];
} Exchange;

static int derivatives(double time, N_Vector x, N_Vector rate, void *context)
{
    const Exchange *e = context;
    const size_t n = (size_t)e->unit->d.states;
    if (e->unit->SetTime(e->c, time) != OK || e->unit->SetContinuousStates(e->c, N_VGetArrayPointer(x), n) != OK)
        return 1;
    if (e->plane)
        give_road(e->unit, e->c, e->plane);
    const Status status = e->unit->GetDerivatives(e->c, N_VGetArrayPointer(rate), n);
    return status == OK ? 0 : status == DISCARD ? 1 : -1; /* 1: a shorter step may do */
}

/* d(derivatives)/d(states) by differences on the scale of nominal values. CVODE's own would take the first step's
 * length as a scale, of 1e-13 s here: states that are zero then move by 1e-30, and their columns are rounding. */
static int jacobian(double time, N_Vector x, N_Vector rate, SUNMatrix matrix, void *context, N_Vector work,
                    N_Vector moved, N_Vector other)
{
    const Exchange *e = context;
    const int n = e->unit->d.states;
    double *state = N_VGetArrayPointer(moved);
    (void)work;
    N_VScale(1, x, moved);
    for (int j = 0; j < n; ++j) {
        const double at = state[j];
        state[j] += 1e-8 * (fabs(at) + e->nominal[j]);
        const int status = derivatives(time, moved, other, context);
        if (status)
            return status;
        for (int i = 0; i < n; ++i)
            SM_ELEMENT_D(matrix, i, j) = (N_VGetArrayPointer(other)[i] - N_VGetArrayPointer(rate)[i]) / (state[j] - at);
        state[j] = at;
    }
    return 0;
}

static int indicators(double time, N_Vector x, double *value, void *context)
{
    const Exchange *e = context;
    if (e->unit->SetTime(e->c, time) != OK ||
        e->unit->SetContinuousStates(e->c, N_VGetArrayPointer(x), (size_t)e->unit->d.states) != OK)
        return -1;
    return e->unit->GetEventIndicators(e->c, value, (size_t)e->unit->d.indicators) == OK ? 0 : -1;
}

/* Event mode until nothing changes; 1: states did. */
int event(const Unit *unit, Component c)
{
    EventInfo info = {.again = 1};
    int changed = 0;
    for (int i = 0; info.again; ++i) {
        expect(i < 10, "events without end");
        need(unit->NewDiscreteStates(c, &info), "fmi2NewDiscreteStates");
        changed |= info.values_changed;
    }
    need(unit->EnterContinuousTimeMode(c), "fmi2EnterContinuousTimeMode");
    return changed;
}

void cvode(const Unit *unit, double tolerance, const double *plane, double step, double stop, int count, char **word)
{
    const int n = unit->d.states;
    Exchange e = {unit, instantiate(unit, "vehicle", EXCHANGE), plane, {0}};
    SUNContext context;
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(NULL, &context);
#endif
    N_Vector x = N_VNew_Serial(n, context), bound = N_VNew_Serial(n, context);
    void *memory = CVodeCreate(CV_BDF, context);
    SUNMatrix matrix = SUNDenseMatrix(n, n, context);
    SUNLinearSolver solver = SUNLinSol_Dense(x, matrix, context);
    double time = 0, *state = N_VGetArrayPointer(x);
    int events = 0, contacts = 0;
    initialize_on(unit, e.c, plane, stop, count, word);
    event(unit, e.c);
    need(unit->GetContinuousStates(e.c, state, (size_t)n), "fmi2GetContinuousStates");
    need(unit->GetNominalsOfContinuousStates(e.c, N_VGetArrayPointer(bound), (size_t)n), "nominals");
    memcpy(e.nominal, N_VGetArrayPointer(bound), sizeof(double) * (size_t)n);
    N_VScale(tolerance, bound, bound);
    expect(!CVodeInit(memory, derivatives, 0, x) && !CVodeSVtolerances(memory, tolerance, bound) &&
               !CVodeSetUserData(memory, &e) && !CVodeSetLinearSolver(memory, solver, matrix) &&
               !CVodeSetJacFn(memory, jacobian) && !CVodeRootInit(memory, unit->d.indicators, indicators) &&
               !CVodeSetMaxNumSteps(memory, 1000000),
           "CVODE");
    header(unit);
    row(unit, e.c, 0);
    for (long k = 1; k <= lround(stop / step); ++k) {
        const double end = (double)k * step;
        CVodeSetStopTime(memory, end);
        while (time < end) {
            int enter, terminate;
            const int found = CVode(memory, end, x, &time, CV_ONE_STEP);
            expect(found >= 0, "CVODE failed");
            need(unit->SetTime(e.c, time), "fmi2SetTime");
            need(unit->SetContinuousStates(e.c, state, (size_t)n), "fmi2SetContinuousStates");
            need(unit->CompletedIntegratorStep(e.c, 1, &enter, &terminate), "fmi2CompletedIntegratorStep");
            expect(!terminate, "the simulation ends by itself");
            if (!enter && found != CV_ROOT_RETURN)
                continue;
            expect(found == CV_ROOT_RETURN, "an event that no indicator had");
            events += enter;
            contacts += !enter;
            need(unit->EnterEventMode(e.c), "fmi2EnterEventMode");
            const int changed = event(unit, e.c);
            expect(changed == enter, enter ? "the event that was located is not there" : "a contact changes states");
            if (changed)
                need(unit->GetContinuousStates(e.c, state, (size_t)n), "fmi2GetContinuousStates");
            CVodeReInit(memory, time, x); /* at a contact the first derivative of the rates jumps */
        }
        if (plane)
            give_road(unit, e.c, plane);
        row(unit, e.c, end);
    }
    need(unit->Terminate(e.c), "fmi2Terminate");
    unit->FreeInstance(e.c);
    CVodeFree(&memory);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(x);
    N_VDestroy(bound);
    fprintf(stderr, "importer: %d events, %d contacts\n", events, contacts);
    SUNContext_Free(&context);
}
