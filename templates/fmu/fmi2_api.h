/* SPDX-License-Identifier: MIT
 *
 * fmi2_api: types and functions of FMI 2.0 for one FMU, declared after the standard's text (fmi-standard.org). Programs
 * that link several FMUs statically define FMI2_FUNCTION_PREFIX, as for the standard's own headers. */
#ifndef FMI2_API_H
#define FMI2_API_H

#include <stddef.h>

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char *fmi2String;
enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category, fmi2String message,
                   ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#define FMI2_PASTE(a, b) a##b
#define FMI2_PASTED(a, b) FMI2_PASTE(a, b)
#ifdef FMI2_FUNCTION_PREFIX
#define FMI2(name) FMI2_PASTED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif

#if defined _WIN32
#define FMI2_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

#define FMI2_CALL(name) FMI2_EXPORT fmi2Status FMI2(name)
#define FMI2_REFERENCES fmi2Component, const fmi2ValueReference reference[], size_t count

#ifdef __cplusplus
extern "C" {
#endif

FMI2_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void);
FMI2_EXPORT const char *FMI2(fmi2GetVersion)(void);
FMI2_CALL(fmi2SetDebugLogging)(fmi2Component, fmi2Boolean on, size_t count, const fmi2String category[]);
FMI2_EXPORT fmi2Component FMI2(fmi2Instantiate)(fmi2String name, fmi2Type, fmi2String guid, fmi2String resources,
                                                const fmi2CallbackFunctions *, fmi2Boolean visible,
                                                fmi2Boolean logging);
FMI2_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component);
FMI2_CALL(fmi2SetupExperiment)
(fmi2Component, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
 fmi2Real stop);
FMI2_CALL(fmi2EnterInitializationMode)(fmi2Component);
FMI2_CALL(fmi2ExitInitializationMode)(fmi2Component);
FMI2_CALL(fmi2Terminate)(fmi2Component);
FMI2_CALL(fmi2Reset)(fmi2Component);
FMI2_CALL(fmi2GetReal)(FMI2_REFERENCES, fmi2Real value[]);
FMI2_CALL(fmi2GetInteger)(FMI2_REFERENCES, fmi2Integer value[]);
FMI2_CALL(fmi2GetBoolean)(FMI2_REFERENCES, fmi2Boolean value[]);
FMI2_CALL(fmi2GetString)(FMI2_REFERENCES, fmi2String value[]);
FMI2_CALL(fmi2SetReal)(FMI2_REFERENCES, const fmi2Real value[]);
FMI2_CALL(fmi2SetInteger)(FMI2_REFERENCES, const fmi2Integer value[]);
FMI2_CALL(fmi2SetBoolean)(FMI2_REFERENCES, const fmi2Boolean value[]);
FMI2_CALL(fmi2SetString)(FMI2_REFERENCES, const fmi2String value[]);
FMI2_CALL(fmi2GetFMUstate)(fmi2Component, fmi2FMUstate *state);
FMI2_CALL(fmi2SetFMUstate)(fmi2Component, fmi2FMUstate state);
FMI2_CALL(fmi2FreeFMUstate)(fmi2Component, fmi2FMUstate *state);
FMI2_CALL(fmi2SerializedFMUstateSize)(fmi2Component, fmi2FMUstate state, size_t *size);
FMI2_CALL(fmi2SerializeFMUstate)(fmi2Component, fmi2FMUstate state, fmi2Byte bytes[], size_t size);
FMI2_CALL(fmi2DeSerializeFMUstate)(fmi2Component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state);
FMI2_CALL(fmi2GetDirectionalDerivative)
(fmi2Component, const fmi2ValueReference unknown[], size_t unknowns, const fmi2ValueReference known[], size_t knowns,
 const fmi2Real seed[], fmi2Real sensitivity[]);
FMI2_CALL(fmi2EnterEventMode)(fmi2Component);
FMI2_CALL(fmi2NewDiscreteStates)(fmi2Component, fmi2EventInfo *);
FMI2_CALL(fmi2EnterContinuousTimeMode)(fmi2Component);
FMI2_CALL(fmi2CompletedIntegratorStep)
(fmi2Component, fmi2Boolean no_rollback, fmi2Boolean *enter_event_mode, fmi2Boolean *terminate);
FMI2_CALL(fmi2SetTime)(fmi2Component, fmi2Real);
FMI2_CALL(fmi2SetContinuousStates)(fmi2Component, const fmi2Real x[], size_t count);
FMI2_CALL(fmi2GetDerivatives)(fmi2Component, fmi2Real rate[], size_t count);
FMI2_CALL(fmi2GetEventIndicators)(fmi2Component, fmi2Real indicator[], size_t count);
FMI2_CALL(fmi2GetContinuousStates)(fmi2Component, fmi2Real x[], size_t count);
FMI2_CALL(fmi2GetNominalsOfContinuousStates)(fmi2Component, fmi2Real x[], size_t count);
FMI2_CALL(fmi2SetRealInputDerivatives)(FMI2_REFERENCES, const fmi2Integer order[], const fmi2Real value[]);
FMI2_CALL(fmi2GetRealOutputDerivatives)(FMI2_REFERENCES, const fmi2Integer order[], fmi2Real value[]);
FMI2_CALL(fmi2DoStep)(fmi2Component, fmi2Real point, fmi2Real step, fmi2Boolean no_rollback);
FMI2_CALL(fmi2CancelStep)(fmi2Component);
FMI2_CALL(fmi2GetStatus)(fmi2Component, const fmi2StatusKind, fmi2Status *);
FMI2_CALL(fmi2GetRealStatus)(fmi2Component, const fmi2StatusKind, fmi2Real *);
FMI2_CALL(fmi2GetIntegerStatus)(fmi2Component, const fmi2StatusKind, fmi2Integer *);
FMI2_CALL(fmi2GetBooleanStatus)(fmi2Component, const fmi2StatusKind, fmi2Boolean *);
FMI2_CALL(fmi2GetStringStatus)(fmi2Component, const fmi2StatusKind, fmi2String *);

#ifdef __cplusplus
}
#endif
#endif
