/* SPDX-License-Identifier: MIT
 * FMI 3.0 behind the functions that the importer calls, written from the standard's text. */
#include "unit.h"

#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void Log(void *environment, Status status, const char *category, const char *message);
typedef void Update(void *environment, double time, bool set_requested, bool get_allowed, bool finished,
                    bool can_return, bool *return_early, double *return_time);

/* X(name, arguments) */
#define FUNCTIONS_3(X) \
    X(SetDebugLogging, (Component, bool, size_t, const char *const[])) \
    X(EnterInitializationMode, (Component, bool, double, double, bool, double)) \
    X(ExitInitializationMode, (Component)) \
    X(Terminate, (Component)) \
    X(Reset, (Component)) \
    X(GetFloat64, (Component, const uint32_t[], size_t, double[], size_t)) \
    X(SetFloat64, (Component, const uint32_t[], size_t, const double[], size_t)) \
    X(GetInt32, (Component, const uint32_t[], size_t, int32_t[], size_t)) \
    X(SetInt32, (Component, const uint32_t[], size_t, const int32_t[], size_t)) \
    X(GetInt64, (Component, const uint32_t[], size_t, int64_t[], size_t)) \
    X(SetInt64, (Component, const uint32_t[], size_t, const int64_t[], size_t)) \
    X(GetBoolean, (Component, const uint32_t[], size_t, bool[], size_t)) \
    X(GetFMUState, (Component, void **)) \
    X(SetFMUState, (Component, void *)) \
    X(FreeFMUState, (Component, void **)) \
    X(SerializedFMUStateSize, (Component, void *, size_t *)) \
    X(SerializeFMUState, (Component, void *, uint8_t[], size_t)) \
    X(DeserializeFMUState, (Component, const uint8_t[], size_t, void **)) \
    X(EnterEventMode, (Component)) \
    X(UpdateDiscreteStates, (Component, bool *, bool *, bool *, bool *, bool *, double *)) \
    X(EnterContinuousTimeMode, (Component)) \
    X(CompletedIntegratorStep, (Component, bool, bool *, bool *)) \
    X(SetTime, (Component, double)) \
    X(SetContinuousStates, (Component, const double[], size_t)) \
    X(GetContinuousStateDerivatives, (Component, double[], size_t)) \
    X(GetEventIndicators, (Component, double[], size_t)) \
    X(GetContinuousStates, (Component, double[], size_t)) \
    X(GetNominalsOfContinuousStates, (Component, double[], size_t)) \
    X(GetNumberOfContinuousStates, (Component, size_t *)) \
    X(GetNumberOfEventIndicators, (Component, size_t *)) \
    X(GetDirectionalDerivative, \
      (Component, const uint32_t[], size_t, const uint32_t[], size_t, const double[], size_t, double[], size_t)) \
    X(GetAdjointDerivative, \
      (Component, const uint32_t[], size_t, const uint32_t[], size_t, const double[], size_t, double[], size_t)) \
    X(EnterStepMode, (Component)) \
    X(DoStep, (Component, double, double, bool, bool *, bool *, bool *, double *))

/* What the importer does not call here, but the standard demands of every FMU. */
static const char *const demanded[] = {"InstantiateScheduledExecution",
                                       "EnterConfigurationMode",
                                       "ExitConfigurationMode",
                                       "GetFloat32",
                                       "SetFloat32",
                                       "GetInt8",
                                       "SetInt8",
                                       "GetUInt8",
                                       "SetUInt8",
                                       "GetInt16",
                                       "SetInt16",
                                       "GetUInt16",
                                       "SetUInt16",
                                       "GetUInt32",
                                       "SetUInt32",
                                       "GetUInt64",
                                       "SetUInt64",
                                       "SetBoolean",
                                       "GetString",
                                       "SetString",
                                       "GetBinary",
                                       "SetBinary",
                                       "GetClock",
                                       "SetClock",
                                       "GetNumberOfVariableDependencies",
                                       "GetVariableDependencies",
                                       "GetIntervalDecimal",
                                       "GetIntervalFraction",
                                       "GetShiftDecimal",
                                       "GetShiftFraction",
                                       "SetIntervalDecimal",
                                       "SetIntervalFraction",
                                       "SetShiftDecimal",
                                       "SetShiftFraction",
                                       "EvaluateDiscreteStates",
                                       "GetOutputDerivatives",
                                       "ActivateModelPartition"};

/* One library at a time. */
static struct {
#define MEMBER(name, arguments) Status(*name) arguments;
    FUNCTIONS_3(MEMBER)
#undef MEMBER
    Component (*InstantiateModelExchange)(const char *, const char *, const char *, bool, bool, void *, Log *);
    Component (*InstantiateCoSimulation)(const char *, const char *, const char *, bool, bool, bool, bool,
                                         const uint32_t[], size_t, void *, Log *, Update *);
    uint32_t enumerated; /* the variable that is read as Int64 */
    const Callbacks *callbacks;
    bool stops;
    double start, stop;
} api;

Updates updates;

static void pass_on(void *environment, Status status, const char *category, const char *message)
{
    (void)environment;
    if (api.callbacks && api.callbacks->logger)
        api.callbacks->logger(NULL, "3.0", status, category, "%s", message);
}

static void update(void *environment, double time, bool set_requested, bool get_allowed, bool finished, bool can_return,
                   bool *return_early, double *return_time)
{
    (void)environment;
    if (set_requested || !get_allowed || !finished || !(time > updates.last_time)) {
        fprintf(stderr, "importer: a wrong intermediate update at %g s\n", time);
        exit(1);
    }
    updates.last_time = time;
    ++updates.intermediate;
    if (can_return && updates.leave > 0 && --updates.leave == 0) {
        *return_early = true;
        *return_time = time;
    }
}

static Component Instantiate(const char *name, int kind, const char *token, const char *resources,
                             const Callbacks *callbacks, int visible, int logging)
{
    if (!callbacks)
        return NULL; /* no counterpart */
    api.callbacks = callbacks;
    updates.last_time = -1;
    if (kind == 0)
        return api.InstantiateModelExchange(name, token, resources, visible, logging, NULL, pass_on);
    if (kind == 1)
        return api.InstantiateCoSimulation(name, token, resources, visible, logging, false, true, NULL, 0, NULL,
                                           pass_on, update);
    return NULL;
}

/* Part of fmi3EnterInitializationMode. */
static Status SetupExperiment(Component c, int defined, double tolerance, double start, int stops, double stop)
{
    (void)c, (void)defined, (void)tolerance;
    if (isnan(start) || (stops && stop < start)) /* what the call below would answer */
        return ERROR;
    api.start = start;
    api.stops = stops;
    api.stop = stop;
    return OK;
}

static Status EnterInitializationMode(Component c)
{
    updates.last_time = -1;
    return api.EnterInitializationMode(c, false, 0, api.start, api.stops, api.stop);
}

static Status GetDirectionalDerivative(Component c, const unsigned unknown[], size_t unknowns, const unsigned known[],
                                       size_t knowns, const double seed[], double sensitivity[])
{
    return api.GetDirectionalDerivative(c, unknown, unknowns, known, knowns, seed, knowns, sensitivity, unknowns);
}

static Status GetAdjointDerivative(Component c, const unsigned unknown[], size_t unknowns, const unsigned known[],
                                   size_t knowns, const double seed[], double sensitivity[])
{
    return api.GetAdjointDerivative(c, unknown, unknowns, known, knowns, seed, unknowns, sensitivity, knowns);
}

static Status GetReal(Component c, const unsigned reference[], size_t count, double value[])
{
    return api.GetFloat64(c, reference, count, value, count);
}

static Status SetReal(Component c, const unsigned reference[], size_t count, const double value[])
{
    return api.SetFloat64(c, reference, count, value, count);
}

static Status GetInteger(Component c, const unsigned reference[], size_t count, int value[])
{
    int64_t wide = 0;
    if (count != 1 || reference[0] != api.enumerated)
        return api.GetInt32(c, reference, count, value, count);
    const Status status = api.GetInt64(c, reference, 1, &wide, 1);
    *value = (int)wide;
    return status;
}

static Status SetInteger(Component c, const unsigned reference[], size_t count, const int value[])
{
    const int64_t wide = *value;
    if (count != 1 || reference[0] != api.enumerated)
        return api.SetInt32(c, reference, count, value, count);
    return api.SetInt64(c, reference, 1, &wide, 1);
}

static Status GetBoolean(Component c, const unsigned reference[], size_t count, int value[])
{
    bool truth[1];
    (void)value;
    return api.GetBoolean(c, reference, count, truth, count);
}

static Status SerializeFMUstate(Component c, void *state, char bytes[], size_t size)
{
    return api.SerializeFMUState(c, state, (uint8_t *)bytes, size);
}

static Status DeSerializeFMUstate(Component c, const char bytes[], size_t size, void **state)
{
    return api.DeserializeFMUState(c, (const uint8_t *)bytes, size, state);
}

static Status NewDiscreteStates(Component c, EventInfo *info)
{
    bool again, terminate, nominals, values, defined;
    const Status status = api.UpdateDiscreteStates(c, &again, &terminate, &nominals, &values, &defined, &info->time);
    if (status == OK)
        *info = (EventInfo){again, terminate, nominals, values, defined, info->time};
    return status;
}

static Status CompletedIntegratorStep(Component c, int no_rollback, int *enter, int *terminate)
{
    bool event = false, end = false;
    const Status status = api.CompletedIntegratorStep(c, no_rollback, &event, &end);
    *enter = event;
    *terminate = end;
    return status;
}

/* A communication step that ends early is made to its end by others. */
static Status DoStep(Component c, double point, double step, int no_rollback)
{
    bool event, terminate, early = true;
    double last = point;
    Status status = OK;
    if (!(step > 0))
        return api.DoStep(c, point, step, no_rollback, &event, &terminate, &early, &last);
    for (const double end = point + step; status == OK && early; point = last) {
        if (updates.last_time > point + step) /* the vehicle went back */
            updates.last_time = point;
        updates.last_time = fmin(updates.last_time, point);
        status = api.DoStep(c, point, end - point, no_rollback, &event, &terminate, &early, &last);
        updates.early += status == OK && early;
        if (status == OK && (event || terminate || (!early && fabs(last - end) > 1e-9)))
            return FATAL;
    }
    return status;
}

static Status GetEventIndicators(Component c, double value[], size_t count)
{
    size_t there = 0;
    const Status status = api.GetNumberOfEventIndicators(c, &there);
    if (status != OK)
        return status;
    return there == count ? api.GetEventIndicators(c, value, count) : FATAL;
}

static void *symbol(void *library, const char *name)
{
    char text[80];
    snprintf(text, sizeof text, "fmi3%s", name);
    void *found = dlsym(library, text);
    if (!found) {
        fprintf(stderr, "importer: no function %s\n", text);
        exit(1);
    }
    return found;
}

void version_3_load(Unit *unit, void *library)
{
    void *found;
#define LOAD(name, arguments) found = symbol(library, #name), memcpy(&api.name, &found, sizeof found);
    FUNCTIONS_3(LOAD)
    LOAD(InstantiateModelExchange, )
    LOAD(InstantiateCoSimulation, )
#undef LOAD
    for (size_t i = 0; i < sizeof demanded / sizeof *demanded; ++i)
        symbol(library, demanded[i]);
    const int method = description_find(&unit->d, "solver.method");
    api.enumerated = method < 0 ? UINT32_MAX : unit->d.variable[method].reference;
    found = symbol(library, "GetVersion"), memcpy(&unit->GetVersion, &found, sizeof found);
    found = symbol(library, "FreeInstance"), memcpy(&unit->FreeInstance, &found, sizeof found);
    unit->Instantiate = Instantiate;
    unit->SetupExperiment = SetupExperiment;
    unit->EnterInitializationMode = EnterInitializationMode;
    unit->ExitInitializationMode = api.ExitInitializationMode;
    unit->Terminate = api.Terminate;
    unit->Reset = api.Reset;
    unit->GetDirectionalDerivative = GetDirectionalDerivative;
    unit->GetAdjointDerivative = GetAdjointDerivative;
    unit->GetReal = GetReal;
    unit->SetReal = SetReal;
    unit->GetInteger = GetInteger;
    unit->SetInteger = SetInteger;
    unit->GetBoolean = GetBoolean;
    unit->GetFMUstate = api.GetFMUState;
    unit->SetFMUstate = api.SetFMUState;
    unit->FreeFMUstate = api.FreeFMUState;
    unit->SerializedFMUstateSize = api.SerializedFMUStateSize;
    unit->SerializeFMUstate = SerializeFMUstate;
    unit->DeSerializeFMUstate = DeSerializeFMUstate;
    unit->EnterEventMode = api.EnterEventMode;
    unit->NewDiscreteStates = NewDiscreteStates;
    unit->EnterContinuousTimeMode = api.EnterContinuousTimeMode;
    unit->CompletedIntegratorStep = CompletedIntegratorStep;
    unit->SetTime = api.SetTime;
    unit->SetContinuousStates = api.SetContinuousStates;
    unit->GetDerivatives = api.GetContinuousStateDerivatives;
    unit->GetEventIndicators = GetEventIndicators;
    unit->GetContinuousStates = api.GetContinuousStates;
    unit->GetNominalsOfContinuousStates = api.GetNominalsOfContinuousStates;
    unit->DoStep = DoStep;
    unit->CancelStep = api.EnterStepMode; /* never legal in an FMU without event mode */
}
