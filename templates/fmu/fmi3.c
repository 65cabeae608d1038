/* SPDX-License-Identifier: MIT
 * FMI 3.0 for one instance of fmu_core.h: model exchange and co-simulation, with intermediate update and early return.
 * A call in a mode where the standard does not allow it returns fmi3Error and changes nothing. */
#include "fmi3_api.h"
#include "fmu_core.h"

#include <stdlib.h>
#include <string.h>

enum {
    ALL = FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_CONTINUOUS | FMU_STEP | FMU_TERMINATED,
    READABLE = ALL & ~FMU_INSTANTIATED,
    SETTABLE = FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_STEP,
    CATEGORIES = 4
};

static const char *const category_name[CATEGORIES] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                                      "logStatusError"};

typedef struct Instance {
    fmu_instance core; /* first, so that one pointer is the other */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback message;
    fmi3IntermediateUpdateCallback update;
    int logging, wanted[CATEGORIES];
    int may_return, returned; /* early: is it allowed; did the last step? */
    int inside;               /* of a call of `update` */
} Instance;

static fmi3Status status_of(fmu_result result)
{
    static const fmi3Status status[] = {fmi3OK, fmi3Warning, fmi3Discard, fmi3Error};
    return status[result];
}

/* Errors and what was discarded are told in any case. */
static void pass_on(fmu_instance *core, fmu_result result, const char *category, const char *text)
{
    Instance *instance = (Instance *)(void *)core;
    int i, wanted = instance->wanted[0];
    for (i = 1; i < CATEGORIES; ++i)
        wanted = wanted || (instance->wanted[i] && !strcmp(category, category_name[i]));
    if (instance->message && (result >= FMU_DISCARD || (instance->logging && wanted)))
        instance->message(instance->environment, status_of(result), category, text);
}

/* Begin a function: the instance, or leave where there is none or the mode is wrong. */
#define BEGIN(name, modes) \
    fmu_instance *const core = (fmu_instance *)self; \
    if (!core) \
        return fmi3Error; \
    if (fmu_legal(core, name, modes) != FMU_OK || outside(core, name) != FMU_OK) \
    return fmi3Error

/* The same for what may be called in an intermediate update too. */
#define BEGIN_INSIDE(name, modes) \
    fmu_instance *const core = (fmu_instance *)self; \
    if (!core) \
        return fmi3Error; \
    if (fmu_legal(core, name, modes) != FMU_OK) \
    return fmi3Error

#define NEEDS(count, array) \
    if ((count) && !(array)) \
    return status_of(fmu_say(core, FMU_ERROR, "an argument is NULL"))

#define OF_EXCHANGE(name) \
    if (!core->data.exchange) \
    return status_of(fmu_say(core, FMU_ERROR, name " is for model exchange"))
#define OF_STEPS(name) \
    if (core->data.exchange) \
    return status_of(fmu_say(core, FMU_ERROR, name " is for co-simulation"))

static fmu_result outside(fmu_instance *core, const char *name)
{
    if (!((Instance *)(void *)core)->inside)
        return FMU_OK;
    return fmu_say(core, FMU_ERROR, "%s is not allowed in an intermediate update", name);
}

static fmu_result worse(fmu_result a, fmu_result b)
{
    return a > b ? a : b;
}

const char *FMI3(fmi3GetVersion)(void)
{
    return "3.0";
}

fmi3Status FMI3(fmi3SetDebugLogging)(fmi3Instance self, fmi3Boolean on, size_t count, const fmi3String category[])
{
    Instance *instance = (Instance *)self;
    size_t i;
    int k, known;
    BEGIN("fmi3SetDebugLogging", ALL);
    NEEDS(count, category);
    instance->logging = on;
    if (count == 0)
        for (k = 0; k < CATEGORIES; ++k)
            instance->wanted[k] = on;
    for (i = 0; i < count; ++i) {
        for (known = k = 0; k < CATEGORIES; ++k)
            if (category[i] && !strcmp(category[i], category_name[k]))
                instance->wanted[k] = on, known = 1;
        if (!known)
            return status_of(fmu_say(core, FMU_ERROR, "there is no such log category"));
    }
    return fmi3OK;
}

/* ---- instances ------------------------------------------------------------------------------------------------ */

static fmi3Instance instantiate(fmi3String name, fmi3String token, fmi3Boolean logging,
                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback message, const char *error)
{
    Instance *instance = NULL;
    int k;
    if (!error && (!name || !name[0]))
        error = "the instance has no name";
    if (!error && (!token || strcmp(token, FMU_TOKEN)))
        error = "the instantiation token is not that of this FMU: modelDescription.xml and binary are not of the same "
                "export";
    if (!error && !(instance = (Instance *)calloc(1, sizeof *instance)))
        error = "no memory for the instance";
    if (error) {
        if (message)
            message(environment, fmi3Error, "logStatusError", error);
        return NULL;
    }
    instance->environment = environment;
    instance->message = message;
    instance->core.log = pass_on;
    instance->logging = logging;
    for (k = 0; k < CATEGORIES; ++k)
        instance->wanted[k] = logging;
    return instance;
}

fmi3Instance FMI3(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging,
                                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback message)
{
    Instance *instance = (Instance *)instantiate(name, token, logging, environment, message, fmu_no_exchange());
    (void)resources, (void)visible;
    if (instance) {
        instance->core.data.exchange = 1;
        fmu_reset(&instance->core);
    }
    return instance;
}

/* After a step within a communication step: show it to the importer, who may end the communication step. */
static int intermediate(fmu_instance *core)
{
    Instance *instance = (Instance *)(void *)core;
    const double now = fmu_time(core);
    fmi3Boolean requested = false;
    fmi3Float64 time = now;
    instance->inside = 1;
    instance->update(instance->environment, now, false, true, true, instance->may_return != 0, &requested, &time);
    instance->inside = 0;
    return instance->returned = requested && instance->may_return && time <= now;
}

fmi3Instance FMI3(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                               fmi3Boolean early_return, const fmi3ValueReference intermediates[],
                                               size_t count, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback message, fmi3IntermediateUpdateCallback update)
{
    const char *error = event_mode ? "this FMU has no event mode in co-simulation" : NULL;
    Instance *instance = (Instance *)instantiate(name, token, logging, environment, message, error);
    (void)resources, (void)visible, (void)intermediates, (void)count; /* all outputs are there */
    if (instance) {
        instance->may_return = early_return;
        instance->update = update;
        instance->core.between = update ? intermediate : NULL;
        fmu_reset(&instance->core);
    }
    return instance;
}

fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging,
                                                     fmi3InstanceEnvironment environment,
                                                     fmi3LogMessageCallback message, fmi3ClockUpdateCallback clock,
                                                     fmi3LockPreemptionCallback lock,
                                                     fmi3UnlockPreemptionCallback unlock)
{
    (void)resources, (void)visible, (void)clock, (void)lock, (void)unlock;
    return instantiate(name, token, logging, environment, message, "this FMU has no scheduled execution");
}

void FMI3(fmi3FreeInstance)(fmi3Instance self)
{
    free(self);
}

fmi3Status FMI3(fmi3EnterInitializationMode)(fmi3Instance self, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                             fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop)
{
    fmu_result result;
    BEGIN("fmi3EnterInitializationMode", FMU_INSTANTIATED);
    (void)tolerance_defined, (void)tolerance; /* steps are of constant length */
    result = fmu_experiment(core, start, stop_defined, stop);
    if (result == FMU_OK)
        core->data.mode = FMU_INITIALIZATION;
    return status_of(result);
}

fmi3Status FMI3(fmi3ExitInitializationMode)(fmi3Instance self)
{
    fmu_result result;
    BEGIN("fmi3ExitInitializationMode", FMU_INITIALIZATION);
    result = fmu_initialize(core);
    if (result == FMU_OK)
        core->data.mode = core->data.exchange ? FMU_EVENT : FMU_STEP;
    return status_of(result);
}

fmi3Status FMI3(fmi3EnterEventMode)(fmi3Instance self)
{
    BEGIN("fmi3EnterEventMode", FMU_CONTINUOUS);
    core->data.mode = FMU_EVENT;
    return fmi3OK;
}

fmi3Status FMI3(fmi3Terminate)(fmi3Instance self)
{
    BEGIN("fmi3Terminate", FMU_EVENT | FMU_CONTINUOUS | FMU_STEP);
    core->data.mode = FMU_TERMINATED;
    return fmi3OK;
}

fmi3Status FMI3(fmi3Reset)(fmi3Instance self)
{
    BEGIN("fmi3Reset", ALL);
    fmu_reset(core);
    return fmi3OK;
}

/* There is no structural parameter. */
fmi3Status FMI3(fmi3EnterConfigurationMode)(fmi3Instance self)
{
    BEGIN("fmi3EnterConfigurationMode", ALL);
    return status_of(fmu_say(core, FMU_ERROR, "this FMU has no structural parameters to configure"));
}

fmi3Status FMI3(fmi3ExitConfigurationMode)(fmi3Instance self)
{
    BEGIN("fmi3ExitConfigurationMode", ALL);
    return status_of(fmu_say(core, FMU_ERROR, "this FMU is not in configuration mode"));
}

/* ---- values --------------------------------------------------------------------------------------------------- */

/* All variables are scalars. */
#define ONE_EACH \
    if (count != values) \
    return status_of(fmu_say(core, FMU_ERROR, "variables are scalars: as many values as references are wanted"))

fmi3Status FMI3(fmi3GetFloat64)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                fmi3Float64 value[], size_t values)
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN_INSIDE("fmi3GetFloat64", READABLE);
    ONE_EACH;
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_get_real(core, reference[i], &value[i]));
    return status_of(result);
}

fmi3Status FMI3(fmi3SetFloat64)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                const fmi3Float64 value[], size_t values)
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi3SetFloat64", SETTABLE | FMU_CONTINUOUS);
    ONE_EACH;
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_set_real(core, reference[i], value[i]));
    return status_of(result);
}

/* The method is an enumeration, which FMI 3.0 reads as Int64; the other whole numbers are Int32. */
static int is_method(fmi3ValueReference reference)
{
    return reference == FMU_SOLVER * FMU_KIND + FMU_SOLVER_METHOD;
}

#define WHOLE(type, method) \
    fmi3Status FMI3(fmi3Get##type)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, \
                                   fmi3##type value[], size_t values) \
    { \
        fmu_result result = FMU_OK; \
        size_t i; \
        BEGIN_INSIDE("fmi3Get" #type, READABLE); \
        ONE_EACH; \
        NEEDS(count, reference &&value); \
        for (i = 0; i < count && result < FMU_DISCARD; ++i) { \
            int32_t whole = 0; \
            result = \
                worse(result, fmu_get_integer(core, is_method(reference[i]) == method ? reference[i] : ~0u, &whole)); \
            value[i] = whole; \
        } \
        return status_of(result); \
    } \
\
    fmi3Status FMI3(fmi3Set##type)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, \
                                   const fmi3##type value[], size_t values) \
    { \
        fmu_result result = FMU_OK; \
        size_t i; \
        BEGIN("fmi3Set" #type, SETTABLE); \
        ONE_EACH; \
        NEEDS(count, reference &&value); \
        for (i = 0; i < count && result < FMU_DISCARD; ++i) { \
            const int fits = value[i] >= INT32_MIN && value[i] <= INT32_MAX; \
            result = worse(result, fmu_set_integer(core, is_method(reference[i]) == method ? reference[i] : ~0u, \
                                                   fits ? (int32_t)value[i] : INT32_MIN)); \
        } \
        return status_of(result); \
    }

WHOLE(Int32, 0)
WHOLE(Int64, 1)

/* There are no variables of these types. */
static fmi3Status none(fmu_instance *core, size_t count)
{
    return count ? status_of(fmu_say(core, FMU_ERROR, "this FMU has no variables of this type")) : fmi3OK;
}

#define NONE(type) \
    fmi3Status FMI3(fmi3Get##type)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, \
                                   fmi3##type value[], size_t values) \
    { \
        BEGIN_INSIDE("fmi3Get" #type, READABLE); \
        (void)reference, (void)value, (void)values; \
        return none(core, count); \
    } \
\
    fmi3Status FMI3(fmi3Set##type)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, \
                                   const fmi3##type value[], size_t values) \
    { \
        BEGIN("fmi3Set" #type, SETTABLE); \
        (void)reference, (void)value, (void)values; \
        return none(core, count); \
    }

NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(UInt32)
NONE(UInt64)
NONE(Boolean)
NONE(String)

fmi3Status FMI3(fmi3GetBinary)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, size_t size[],
                               fmi3Binary value[], size_t values)
{
    BEGIN_INSIDE("fmi3GetBinary", READABLE);
    (void)reference, (void)size, (void)value, (void)values;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetBinary)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                               const size_t size[], const fmi3Binary value[], size_t values)
{
    BEGIN("fmi3SetBinary", SETTABLE);
    (void)reference, (void)size, (void)value, (void)values;
    return none(core, count);
}

/* There are no clocks. */
fmi3Status FMI3(fmi3GetClock)(fmi3Instance self, const fmi3ValueReference reference[], size_t count, fmi3Clock value[])
{
    BEGIN("fmi3GetClock", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)value;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetClock)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                              const fmi3Clock value[])
{
    BEGIN("fmi3SetClock", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)value;
    return none(core, count);
}

fmi3Status FMI3(fmi3GetIntervalDecimal)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                        fmi3Float64 interval[], fmi3IntervalQualifier qualifier[])
{
    BEGIN("fmi3GetIntervalDecimal", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)interval, (void)qualifier;
    return none(core, count);
}

fmi3Status FMI3(fmi3GetIntervalFraction)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                         fmi3UInt64 counter[], fmi3UInt64 resolution[],
                                         fmi3IntervalQualifier qualifier[])
{
    BEGIN("fmi3GetIntervalFraction", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)counter, (void)resolution, (void)qualifier;
    return none(core, count);
}

fmi3Status FMI3(fmi3GetShiftDecimal)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                     fmi3Float64 shift[])
{
    BEGIN("fmi3GetShiftDecimal", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)shift;
    return none(core, count);
}

fmi3Status FMI3(fmi3GetShiftFraction)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                      fmi3UInt64 counter[], fmi3UInt64 resolution[])
{
    BEGIN("fmi3GetShiftFraction", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)counter, (void)resolution;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetIntervalDecimal)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                        const fmi3Float64 interval[])
{
    BEGIN("fmi3SetIntervalDecimal", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)interval;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetIntervalFraction)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                         const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
{
    BEGIN("fmi3SetIntervalFraction", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)counter, (void)resolution;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetShiftDecimal)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                     const fmi3Float64 shift[])
{
    BEGIN("fmi3SetShiftDecimal", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)shift;
    return none(core, count);
}

fmi3Status FMI3(fmi3SetShiftFraction)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                      const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
{
    BEGIN("fmi3SetShiftFraction", FMU_INITIALIZATION | FMU_EVENT);
    (void)reference, (void)counter, (void)resolution;
    return none(core, count);
}

fmi3Status FMI3(fmi3ActivateModelPartition)(fmi3Instance self, fmi3ValueReference clock, fmi3Float64 time)
{
    BEGIN("fmi3ActivateModelPartition", ALL);
    (void)clock, (void)time;
    return none(core, 1);
}

fmi3Status FMI3(fmi3GetNumberOfVariableDependencies)(fmi3Instance self, fmi3ValueReference reference, size_t *count)
{
    BEGIN("fmi3GetNumberOfVariableDependencies", READABLE);
    (void)reference, (void)count;
    return status_of(fmu_say(core, FMU_ERROR, "this FMU has no arrays, whose dependencies this function is for"));
}

fmi3Status FMI3(fmi3GetVariableDependencies)(fmi3Instance self, fmi3ValueReference reference, size_t element[],
                                             fmi3ValueReference independent[], size_t independent_element[],
                                             fmi3DependencyKind kind[], size_t count)
{
    BEGIN("fmi3GetVariableDependencies", READABLE);
    (void)reference, (void)element, (void)independent, (void)independent_element, (void)kind, (void)count;
    return status_of(fmu_say(core, FMU_ERROR, "this FMU has no arrays, whose dependencies this function is for"));
}

#if FMU_DERIVATIVES
/* given, wanted: which of the lists seeds and sensitivities belong to. */
#define DERIVATIVE(name, function, given, wanted) \
    fmi3Status FMI3(name)(fmi3Instance self, const fmi3ValueReference unknown[], size_t unknowns, \
                          const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[], size_t seeds, \
                          fmi3Float64 sensitivity[], size_t sensitivities) \
    { \
        BEGIN(#name, READABLE); \
        NEEDS(unknowns, unknown); \
        NEEDS(knowns, known); \
        NEEDS(seeds, seed); \
        NEEDS(sensitivities, sensitivity); \
        if (seeds != given || sensitivities != wanted) \
            return status_of( \
                fmu_say(core, FMU_ERROR, #name ": numbers of seeds, sensitivities and references differ")); \
        return status_of(function(core, unknown, unknowns, known, knowns, seed, sensitivity)); \
    }
#else
#define DERIVATIVE(name, function, given, wanted) \
    fmi3Status FMI3(name)(fmi3Instance self, const fmi3ValueReference unknown[], size_t unknowns, \
                          const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[], size_t seeds, \
                          fmi3Float64 sensitivity[], size_t sensitivities) \
    { \
        BEGIN(#name, READABLE); \
        (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seed, (void)seeds, (void)sensitivity, \
            (void)sensitivities; \
        return status_of(fmu_say(core, FMU_ERROR, "this FMU provides no partial derivatives")); \
    }
#endif

DERIVATIVE(fmi3GetDirectionalDerivative, fmu_directional, knowns, unknowns)
DERIVATIVE(fmi3GetAdjointDerivative, fmu_adjoint, unknowns, knowns)

/* ---- copies of the state -------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3GetFMUState)(fmi3Instance self, fmi3FMUState *state)
{
    BEGIN("fmi3GetFMUState", ALL);
    NEEDS(1, state);
    if (!*state)
        *state = malloc(fmu_copy_size());
    if (!*state)
        return status_of(fmu_say(core, FMU_ERROR, "no memory for a copy of the state"));
    fmu_copy_out(core, (char *)*state);
    return fmi3OK;
}

fmi3Status FMI3(fmi3SetFMUState)(fmi3Instance self, fmi3FMUState state)
{
    BEGIN("fmi3SetFMUState", ALL);
    NEEDS(1, state);
    return status_of(fmu_copy_in(core, (const char *)state, fmu_copy_size()));
}

fmi3Status FMI3(fmi3FreeFMUState)(fmi3Instance self, fmi3FMUState *state)
{
    BEGIN("fmi3FreeFMUState", ALL);
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializedFMUStateSize)(fmi3Instance self, fmi3FMUState state, size_t *size)
{
    BEGIN("fmi3SerializedFMUStateSize", ALL);
    NEEDS(1, state && size);
    *size = fmu_copy_size();
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializeFMUState)(fmi3Instance self, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    BEGIN("fmi3SerializeFMUState", ALL);
    NEEDS(1, state && bytes);
    if (size < fmu_copy_size())
        return status_of(
            fmu_say(core, FMU_ERROR, "there is no room for the state's %u bytes", (unsigned)fmu_copy_size()));
    memcpy(bytes, state, fmu_copy_size());
    return fmi3OK;
}

fmi3Status FMI3(fmi3DeserializeFMUState)(fmi3Instance self, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    BEGIN("fmi3DeserializeFMUState", ALL);
    NEEDS(1, bytes && state);
    if (fmu_copy_check(core, (const char *)bytes, size) != FMU_OK)
        return fmi3Error;
    if (!*state)
        *state = malloc(fmu_copy_size());
    if (!*state)
        return status_of(fmu_say(core, FMU_ERROR, "no memory for a copy of the state"));
    memcpy(*state, bytes, fmu_copy_size());
    return fmi3OK;
}

/* ---- model exchange ------------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3EvaluateDiscreteStates)(fmi3Instance self)
{
    BEGIN("fmi3EvaluateDiscreteStates", FMU_INITIALIZATION | FMU_EVENT);
    return fmi3OK;
}

fmi3Status FMI3(fmi3UpdateDiscreteStates)(fmi3Instance self, fmi3Boolean *again, fmi3Boolean *terminate,
                                          fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                          fmi3Boolean *time_defined, fmi3Float64 *time)
{
    BEGIN("fmi3UpdateDiscreteStates", FMU_EVENT);
    NEEDS(1, again && terminate && nominals_changed && values_changed && time_defined && time);
    *again = *terminate = *nominals_changed = *time_defined = false;
    *time = 0;
    *values_changed = fmu_event(core) != 0;
    return fmi3OK;
}

fmi3Status FMI3(fmi3EnterContinuousTimeMode)(fmi3Instance self)
{
    BEGIN("fmi3EnterContinuousTimeMode", FMU_EVENT);
    core->data.mode = FMU_CONTINUOUS;
    return fmi3OK;
}

fmi3Status FMI3(fmi3CompletedIntegratorStep)(fmi3Instance self, fmi3Boolean no_rollback, fmi3Boolean *enter_event_mode,
                                             fmi3Boolean *terminate)
{
    BEGIN("fmi3CompletedIntegratorStep", FMU_CONTINUOUS);
    NEEDS(1, enter_event_mode && terminate);
    (void)no_rollback;
    *enter_event_mode = fmu_event_due(core) != 0;
    *terminate = false;
    return fmi3OK;
}

fmi3Status FMI3(fmi3SetTime)(fmi3Instance self, fmi3Float64 time)
{
    BEGIN("fmi3SetTime", FMU_EVENT | FMU_CONTINUOUS);
    return status_of(fmu_set_time(core, time));
}

fmi3Status FMI3(fmi3SetContinuousStates)(fmi3Instance self, const fmi3Float64 x[], size_t count)
{
    BEGIN("fmi3SetContinuousStates", FMU_CONTINUOUS);
    NEEDS(count, x);
    return status_of(fmu_set_states(core, x, count));
}

fmi3Status FMI3(fmi3GetContinuousStateDerivatives)(fmi3Instance self, fmi3Float64 rate[], size_t count)
{
    BEGIN("fmi3GetContinuousStateDerivatives", READABLE);
    OF_EXCHANGE("fmi3GetContinuousStateDerivatives");
    NEEDS(count, rate);
    return status_of(fmu_get_rates(core, rate, count));
}

fmi3Status FMI3(fmi3GetEventIndicators)(fmi3Instance self, fmi3Float64 indicator[], size_t count)
{
    BEGIN("fmi3GetEventIndicators", READABLE);
    OF_EXCHANGE("fmi3GetEventIndicators");
    NEEDS(count, indicator);
    return status_of(fmu_get_indicators(core, indicator, count));
}

fmi3Status FMI3(fmi3GetContinuousStates)(fmi3Instance self, fmi3Float64 x[], size_t count)
{
    BEGIN("fmi3GetContinuousStates", READABLE);
    OF_EXCHANGE("fmi3GetContinuousStates");
    NEEDS(count, x);
    return status_of(fmu_get_states(core, x, count));
}

fmi3Status FMI3(fmi3GetNominalsOfContinuousStates)(fmi3Instance self, fmi3Float64 x[], size_t count)
{
    BEGIN("fmi3GetNominalsOfContinuousStates", ALL);
    OF_EXCHANGE("fmi3GetNominalsOfContinuousStates");
    NEEDS(count, x);
    return status_of(fmu_get_nominals(core, x, count));
}

fmi3Status FMI3(fmi3GetNumberOfEventIndicators)(fmi3Instance self, size_t *count)
{
    BEGIN("fmi3GetNumberOfEventIndicators", ALL);
    OF_EXCHANGE("fmi3GetNumberOfEventIndicators");
    NEEDS(1, count);
    *count = FMU_INDICATORS;
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetNumberOfContinuousStates)(fmi3Instance self, size_t *count)
{
    BEGIN("fmi3GetNumberOfContinuousStates", ALL);
    OF_EXCHANGE("fmi3GetNumberOfContinuousStates");
    NEEDS(1, count);
    *count = FMU_STATES;
    return fmi3OK;
}

/* ---- co-simulation -------------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3EnterStepMode)(fmi3Instance self)
{
    BEGIN("fmi3EnterStepMode", 0); /* there is no event mode to leave */
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetOutputDerivatives)(fmi3Instance self, const fmi3ValueReference reference[], size_t count,
                                          const fmi3Int32 order[], fmi3Float64 value[], size_t values)
{
    BEGIN_INSIDE("fmi3GetOutputDerivatives", FMU_STEP | FMU_TERMINATED);
    (void)reference, (void)count, (void)order, (void)value, (void)values;
    return status_of(fmu_say(core, FMU_ERROR, "this FMU gives no derivatives of outputs (maxOutputDerivativeOrder 0)"));
}

fmi3Status FMI3(fmi3DoStep)(fmi3Instance self, fmi3Float64 point, fmi3Float64 step, fmi3Boolean no_rollback,
                            fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                            fmi3Float64 *last_successful_time)
{
    Instance *instance = (Instance *)self;
    fmu_result result;
    BEGIN("fmi3DoStep", FMU_STEP);
    NEEDS(1, event_needed && terminate && early_return && last_successful_time);
    (void)no_rollback;
    instance->returned = 0;
    result = fmu_do_step(core, point, step);
    core->data.mode = FMU_STEP; /* after a step that failed the importer may try a shorter one from there */
    *event_needed = *terminate = false;
    *early_return = instance->returned != 0;
    *last_successful_time = fmu_time(core);
    return status_of(result);
}
