/* SPDX-License-Identifier: MIT
 * FMI 2.0 for one instance of fmu_core.h: model exchange and co-simulation. A call in a mode where the standard does
 * not allow it returns fmi2Error and changes nothing. */
#include "fmi2_api.h"
#include "fmu_core.h"

#include <stdlib.h>
#include <string.h>

enum {
    ALL = FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_CONTINUOUS | FMU_STEP | FMU_FAILED | FMU_TERMINATED,
    READABLE = ALL & ~FMU_INSTANTIATED,
    CATEGORIES = 4
};

static const char *const category_name[CATEGORIES] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                                      "logStatusError"};

typedef struct Component {
    fmu_instance core; /* first, so that one pointer is the other */
    fmi2CallbackFunctions callback;
    char *name; /* behind the structure */
    int logging, wanted[CATEGORIES];
} Component;

static fmi2Status status_of(fmu_result result)
{
    static const fmi2Status status[] = {fmi2OK, fmi2Warning, fmi2Discard, fmi2Error};
    return status[result];
}

/* Errors and what was discarded are told in any case. A message goes as an argument, for it may have percent signs. */
static void pass_on(fmu_instance *instance, fmu_result result, const char *category, const char *text)
{
    Component *c = (Component *)(void *)instance;
    int i, wanted = result >= FMU_DISCARD || c->wanted[0];
    for (i = 1; i < CATEGORIES; ++i)
        wanted = wanted || (c->wanted[i] && !strcmp(category, category_name[i]));
    if (c->callback.logger && (result >= FMU_DISCARD || (c->logging && wanted)))
        c->callback.logger(c->callback.componentEnvironment, c->name, status_of(result), category, "%s", text);
}

static void *allocate(const fmi2CallbackFunctions *callback, size_t size)
{
    return callback->allocateMemory ? callback->allocateMemory(1, size) : calloc(1, size);
}

static void release(const fmi2CallbackFunctions *callback, void *memory)
{
    if (!callback->allocateMemory)
        free(memory);
    else if (callback->freeMemory)
        callback->freeMemory(memory);
}

/* Begin a function: the instance, or leave where there is none or the mode is wrong. */
#define BEGIN(name, modes) \
    fmu_instance *const core = (fmu_instance *)component; \
    if (!core) \
        return fmi2Error; \
    if (fmu_legal(core, name, modes) != FMU_OK) \
    return fmi2Error

/* An array of `count` elements must be there. */
#define NEEDS(count, array) \
    if ((count) && !(array)) \
    return status_of(fmu_say(core, FMU_ERROR, "an argument is NULL"))

static fmu_result worse(fmu_result a, fmu_result b)
{
    return a > b ? a : b;
}

const char *FMI2(fmi2GetTypesPlatform)(void)
{
    return "default";
}

const char *FMI2(fmi2GetVersion)(void)
{
    return "2.0";
}

fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String category[])
{
    size_t i;
    int k, known;
    BEGIN("fmi2SetDebugLogging", ALL);
    NEEDS(count, category);
    Component *c = (Component *)component;
    c->logging = on != 0;
    if (count == 0)
        for (k = 0; k < CATEGORIES; ++k)
            c->wanted[k] = on != 0;
    for (i = 0; i < count; ++i) {
        for (known = k = 0; k < CATEGORIES; ++k)
            if (category[i] && !strcmp(category[i], category_name[k]))
                c->wanted[k] = on != 0, known = 1;
        if (!known)
            return status_of(fmu_say(core, FMU_ERROR, "there is no such log category"));
    }
    return fmi2OK;
}

/* ---- instances -------------------------------------------------------------------------------------------------- */

fmi2Component FMI2(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    const char *error = NULL;
    Component *c;
    int k;
    (void)resources, (void)visible;
    if (!functions)
        return NULL;
    if (!name || !name[0])
        error = "the instance has no name";
    else if (!guid || strcmp(guid, FMU_TOKEN))
        error = "the GUID is not that of this FMU: modelDescription.xml and binary are not of the same export";
    else if (type != fmi2ModelExchange && type != fmi2CoSimulation)
        error = "the type is neither model exchange nor co-simulation";
    else if (type == fmi2ModelExchange)
        error = fmu_no_exchange();
    c = error ? NULL : (Component *)allocate(functions, sizeof *c + strlen(name) + 1);
    if (!error && !c)
        error = "no memory for the instance";
    if (error) {
        if (functions->logger)
            functions->logger(functions->componentEnvironment, name ? name : "", fmi2Error, "logStatusError", "%s",
                              error);
        return NULL;
    }
    memset(c, 0, sizeof *c);
    c->callback = *functions;
    c->name = (char *)(c + 1);
    strcpy(c->name, name);
    c->core.log = pass_on;
    c->logging = logging != 0;
    for (k = 0; k < CATEGORIES; ++k)
        c->wanted[k] = logging != 0;
    c->core.data.exchange = type == fmi2ModelExchange;
    fmu_reset(&c->core);
    return c;
}

void FMI2(fmi2FreeInstance)(fmi2Component component)
{
    Component *c = (Component *)component;
    if (c) {
        const fmi2CallbackFunctions callback = c->callback;
        release(&callback, c);
    }
}

fmi2Status FMI2(fmi2SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                     fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    BEGIN("fmi2SetupExperiment", FMU_INSTANTIATED);
    (void)tolerance_defined, (void)tolerance; /* steps are of constant length */
    return status_of(fmu_experiment(core, start, stop_defined, stop));
}

fmi2Status FMI2(fmi2EnterInitializationMode)(fmi2Component component)
{
    BEGIN("fmi2EnterInitializationMode", FMU_INSTANTIATED);
    core->data.mode = FMU_INITIALIZATION;
    return fmi2OK;
}

fmi2Status FMI2(fmi2ExitInitializationMode)(fmi2Component component)
{
    fmu_result result;
    BEGIN("fmi2ExitInitializationMode", FMU_INITIALIZATION);
    result = fmu_initialize(core);
    if (result == FMU_OK)
        core->data.mode = core->data.exchange ? FMU_EVENT : FMU_STEP;
    return status_of(result);
}

fmi2Status FMI2(fmi2Terminate)(fmi2Component component)
{
    BEGIN("fmi2Terminate", FMU_EVENT | FMU_CONTINUOUS | FMU_STEP | FMU_FAILED);
    core->data.mode = FMU_TERMINATED;
    return fmi2OK;
}

fmi2Status FMI2(fmi2Reset)(fmi2Component component)
{
    BEGIN("fmi2Reset", ALL);
    fmu_reset(core);
    return fmi2OK;
}

/* ---- values ----------------------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2GetReal)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                             fmi2Real value[])
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi2GetReal", READABLE);
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_get_real(core, reference[i], &value[i]));
    return status_of(result);
}

fmi2Status FMI2(fmi2SetReal)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                             const fmi2Real value[])
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi2SetReal", FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_CONTINUOUS | FMU_STEP);
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_set_real(core, reference[i], value[i]));
    return status_of(result);
}

fmi2Status FMI2(fmi2GetInteger)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                                fmi2Integer value[])
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi2GetInteger", READABLE);
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i) {
        int32_t whole = 0;
        result = worse(result, fmu_get_integer(core, reference[i], &whole));
        value[i] = (fmi2Integer)whole;
    }
    return status_of(result);
}

fmi2Status FMI2(fmi2SetInteger)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                                const fmi2Integer value[])
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi2SetInteger", FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_STEP);
    NEEDS(count, reference && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_set_integer(core, reference[i], (int32_t)value[i]));
    return status_of(result);
}

/* There are no variables of these types. */
static fmi2Status none(fmu_instance *core, size_t count)
{
    return count ? status_of(fmu_say(core, FMU_ERROR, "this FMU has no variables of this type")) : fmi2OK;
}

fmi2Status FMI2(fmi2GetBoolean)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                                fmi2Boolean value[])
{
    BEGIN("fmi2GetBoolean", READABLE);
    (void)reference, (void)value;
    return none(core, count);
}

fmi2Status FMI2(fmi2GetString)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                               fmi2String value[])
{
    BEGIN("fmi2GetString", READABLE);
    (void)reference, (void)value;
    return none(core, count);
}

fmi2Status FMI2(fmi2SetBoolean)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                                const fmi2Boolean value[])
{
    BEGIN("fmi2SetBoolean", FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_STEP);
    (void)reference, (void)value;
    return none(core, count);
}

fmi2Status FMI2(fmi2SetString)(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                               const fmi2String value[])
{
    BEGIN("fmi2SetString", FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_EVENT | FMU_STEP);
    (void)reference, (void)value;
    return none(core, count);
}

/* ---- copies of the state ---------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    BEGIN("fmi2GetFMUstate", ALL);
    NEEDS(1, state);
    if (!*state)
        *state = allocate(&((Component *)component)->callback, fmu_copy_size());
    if (!*state)
        return status_of(fmu_say(core, FMU_ERROR, "no memory for a copy of the state"));
    fmu_copy_out(core, (char *)*state);
    return fmi2OK;
}

fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component component, fmi2FMUstate state)
{
    BEGIN("fmi2SetFMUstate", ALL);
    NEEDS(1, state);
    return status_of(fmu_copy_in(core, (const char *)state, fmu_copy_size()));
}

fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    BEGIN("fmi2FreeFMUstate", ALL);
    if (state && *state) {
        release(&((Component *)component)->callback, *state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status FMI2(fmi2SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    BEGIN("fmi2SerializedFMUstateSize", ALL);
    NEEDS(1, state && size);
    *size = fmu_copy_size();
    return fmi2OK;
}

fmi2Status FMI2(fmi2SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    BEGIN("fmi2SerializeFMUstate", ALL);
    NEEDS(1, state && bytes);
    if (size < fmu_copy_size())
        return status_of(
            fmu_say(core, FMU_ERROR, "there is no room for the state's %u bytes", (unsigned)fmu_copy_size()));
    memcpy(bytes, state, fmu_copy_size());
    return fmi2OK;
}

fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                         fmi2FMUstate *state)
{
    BEGIN("fmi2DeSerializeFMUstate", ALL);
    NEEDS(1, bytes && state);
    if (fmu_copy_check(core, bytes, size) != FMU_OK)
        return fmi2Error;
    if (!*state)
        *state = allocate(&((Component *)component)->callback, fmu_copy_size());
    if (!*state)
        return status_of(fmu_say(core, FMU_ERROR, "no memory for a copy of the state"));
    memcpy(*state, bytes, fmu_copy_size());
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetDirectionalDerivative)(fmi2Component component, const fmi2ValueReference unknown[],
                                              size_t unknowns, const fmi2ValueReference known[], size_t knowns,
                                              const fmi2Real seed[], fmi2Real sensitivity[])
{
    BEGIN("fmi2GetDirectionalDerivative", READABLE);
#if FMU_DERIVATIVES
    NEEDS(unknowns, unknown && sensitivity);
    NEEDS(knowns, known && seed);
    return status_of(fmu_directional(core, unknown, unknowns, known, knowns, seed, sensitivity));
#else
    (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seed, (void)sensitivity;
    return status_of(fmu_say(core, FMU_ERROR, "this FMU provides no directional derivatives"));
#endif
}

/* ---- model exchange --------------------------------------------------------------------------------------------- */

/* These functions are not part of the other interface. */
#define OF_EXCHANGE(name) \
    if (!core->data.exchange) \
    return status_of(fmu_say(core, FMU_ERROR, name " is for model exchange"))
#define OF_STEPS(name) \
    if (core->data.exchange) \
    return status_of(fmu_say(core, FMU_ERROR, name " is for co-simulation"))

fmi2Status FMI2(fmi2EnterEventMode)(fmi2Component component)
{
    BEGIN("fmi2EnterEventMode", FMU_CONTINUOUS | FMU_EVENT);
    core->data.mode = FMU_EVENT;
    return fmi2OK;
}

fmi2Status FMI2(fmi2NewDiscreteStates)(fmi2Component component, fmi2EventInfo *info)
{
    BEGIN("fmi2NewDiscreteStates", FMU_EVENT);
    NEEDS(1, info);
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = fmu_event(core) ? fmi2True : fmi2False;
    return fmi2OK;
}

fmi2Status FMI2(fmi2EnterContinuousTimeMode)(fmi2Component component)
{
    BEGIN("fmi2EnterContinuousTimeMode", FMU_EVENT);
    core->data.mode = FMU_CONTINUOUS;
    return fmi2OK;
}

fmi2Status FMI2(fmi2CompletedIntegratorStep)(fmi2Component component, fmi2Boolean no_rollback,
                                             fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    BEGIN("fmi2CompletedIntegratorStep", FMU_CONTINUOUS);
    NEEDS(1, enter_event_mode && terminate);
    (void)no_rollback;
    *enter_event_mode = fmu_event_due(core) ? fmi2True : fmi2False;
    *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status FMI2(fmi2SetTime)(fmi2Component component, fmi2Real time)
{
    BEGIN("fmi2SetTime", FMU_EVENT | FMU_CONTINUOUS);
    return status_of(fmu_set_time(core, time));
}

fmi2Status FMI2(fmi2SetContinuousStates)(fmi2Component component, const fmi2Real x[], size_t count)
{
    BEGIN("fmi2SetContinuousStates", FMU_CONTINUOUS);
    NEEDS(count, x);
    return status_of(fmu_set_states(core, x, count));
}

fmi2Status FMI2(fmi2GetDerivatives)(fmi2Component component, fmi2Real rate[], size_t count)
{
    BEGIN("fmi2GetDerivatives", READABLE);
    OF_EXCHANGE("fmi2GetDerivatives");
    NEEDS(count, rate);
    return status_of(fmu_get_rates(core, rate, count));
}

fmi2Status FMI2(fmi2GetEventIndicators)(fmi2Component component, fmi2Real indicator[], size_t count)
{
    BEGIN("fmi2GetEventIndicators", READABLE);
    OF_EXCHANGE("fmi2GetEventIndicators");
    NEEDS(count, indicator);
    return status_of(fmu_get_indicators(core, indicator, count));
}

fmi2Status FMI2(fmi2GetContinuousStates)(fmi2Component component, fmi2Real x[], size_t count)
{
    BEGIN("fmi2GetContinuousStates", READABLE);
    OF_EXCHANGE("fmi2GetContinuousStates");
    NEEDS(count, x);
    return status_of(fmu_get_states(core, x, count));
}

fmi2Status FMI2(fmi2GetNominalsOfContinuousStates)(fmi2Component component, fmi2Real x[], size_t count)
{
    BEGIN("fmi2GetNominalsOfContinuousStates", ALL);
    OF_EXCHANGE("fmi2GetNominalsOfContinuousStates");
    NEEDS(count, x);
    return status_of(fmu_get_nominals(core, x, count));
}

/* ---- co-simulation ---------------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2SetRealInputDerivatives)(fmi2Component component, const fmi2ValueReference reference[],
                                             size_t count, const fmi2Integer order[], const fmi2Real value[])
{
    fmu_result result = FMU_OK;
    size_t i;
    BEGIN("fmi2SetRealInputDerivatives", FMU_INSTANTIATED | FMU_INITIALIZATION | FMU_STEP);
    OF_STEPS("fmi2SetRealInputDerivatives");
    NEEDS(count, reference && order && value);
    for (i = 0; i < count && result < FMU_DISCARD; ++i)
        result = worse(result, fmu_set_slope(core, reference[i], (int32_t)order[i], value[i]));
    return status_of(result);
}

fmi2Status FMI2(fmi2GetRealOutputDerivatives)(fmi2Component component, const fmi2ValueReference reference[],
                                              size_t count, const fmi2Integer order[], fmi2Real value[])
{
    BEGIN("fmi2GetRealOutputDerivatives", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    (void)reference, (void)count, (void)order, (void)value;
    return status_of(fmu_say(core, FMU_ERROR, "this FMU gives no derivatives of outputs (maxOutputDerivativeOrder 0)"));
}

fmi2Status FMI2(fmi2DoStep)(fmi2Component component, fmi2Real point, fmi2Real step, fmi2Boolean no_rollback)
{
    BEGIN("fmi2DoStep", FMU_STEP);
    (void)no_rollback;
    return status_of(fmu_do_step(core, point, step));
}

fmi2Status FMI2(fmi2CancelStep)(fmi2Component component)
{
    BEGIN("fmi2CancelStep", 0); /* no step is ever pending */
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    BEGIN("fmi2GetStatus", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    (void)kind, (void)value;
    return status_of(fmu_say(core, FMU_DISCARD, "no step is pending"));
}

fmi2Status FMI2(fmi2GetRealStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    BEGIN("fmi2GetRealStatus", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    OF_STEPS("fmi2GetRealStatus");
    NEEDS(1, value);
    if (kind != fmi2LastSuccessfulTime)
        return status_of(fmu_say(core, FMU_DISCARD, "there is no such real status"));
    *value = fmu_time(core);
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetIntegerStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    BEGIN("fmi2GetIntegerStatus", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    (void)kind, (void)value;
    return status_of(fmu_say(core, FMU_DISCARD, "there is no status that is a whole number"));
}

fmi2Status FMI2(fmi2GetBooleanStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    BEGIN("fmi2GetBooleanStatus", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    OF_STEPS("fmi2GetBooleanStatus");
    NEEDS(1, value);
    if (kind != fmi2Terminated)
        return status_of(fmu_say(core, FMU_DISCARD, "there is no such Boolean status"));
    *value = fmi2False; /* the vehicle never ends the simulation by itself */
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetStringStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    BEGIN("fmi2GetStringStatus", FMU_STEP | FMU_FAILED | FMU_TERMINATED);
    (void)kind, (void)value;
    return status_of(fmu_say(core, FMU_DISCARD, "no step is pending"));
}
