/* SPDX-License-Identifier: MIT
 *
 * fmi3_api: types and functions of FMI 3.0 for one FMU, declared after the standard's text (fmi-standard.org). Programs
 * that link several FMUs statically define FMI3_FUNCTION_PREFIX, as for the standard's own headers. */
#ifndef FMI3_API_H
#define FMI3_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean, fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time, fmi3Boolean set_requested,
                                               fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early, fmi3Boolean *return_early,
                                               fmi3Float64 *return_time);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#define FMI3_PASTE(a, b) a##b
#define FMI3_PASTED(a, b) FMI3_PASTE(a, b)
#ifdef FMI3_FUNCTION_PREFIX
#define FMI3(name) FMI3_PASTED(FMI3_FUNCTION_PREFIX, name)
#else
#define FMI3(name) name
#endif

#if defined _WIN32
#define FMI3_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define FMI3_EXPORT __attribute__((visibility("default")))
#else
#define FMI3_EXPORT
#endif

#define FMI3_CALL(name) FMI3_EXPORT fmi3Status FMI3(name)
#define FMI3_REFERENCES fmi3Instance, const fmi3ValueReference reference[], size_t count
#define FMI3_DERIVATIVE \
    fmi3Instance, const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[], \
        size_t knowns, const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities

/* X(type): those with a Get and a Set of one form. */
#define FMI3_TYPES(X) \
    X(Float32) X(Float64) X(Int8) X(UInt8) X(Int16) X(UInt16) X(Int32) X(UInt32) X(Int64) X(UInt64) X(Boolean) X(String)

#ifdef __cplusplus
extern "C" {
#endif

FMI3_EXPORT const char *FMI3(fmi3GetVersion)(void);
FMI3_CALL(fmi3SetDebugLogging)(fmi3Instance, fmi3Boolean on, size_t count, const fmi3String category[]);
FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                            fmi3Boolean visible, fmi3Boolean logging,
                                                            fmi3InstanceEnvironment, fmi3LogMessageCallback);
FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3Boolean event_mode, fmi3Boolean early_return,
                                                           const fmi3ValueReference intermediate[],
                                                           size_t intermediates, fmi3InstanceEnvironment,
                                                           fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token,
                                                                 fmi3String resources, fmi3Boolean visible,
                                                                 fmi3Boolean logging, fmi3InstanceEnvironment,
                                                                 fmi3LogMessageCallback, fmi3ClockUpdateCallback,
                                                                 fmi3LockPreemptionCallback,
                                                                 fmi3UnlockPreemptionCallback);
FMI3_EXPORT void FMI3(fmi3FreeInstance)(fmi3Instance);
FMI3_CALL(fmi3EnterInitializationMode)
(fmi3Instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
 fmi3Float64 stop);
FMI3_CALL(fmi3ExitInitializationMode)(fmi3Instance);
FMI3_CALL(fmi3EnterEventMode)(fmi3Instance);
FMI3_CALL(fmi3Terminate)(fmi3Instance);
FMI3_CALL(fmi3Reset)(fmi3Instance);
#define FMI3_DECLARE(type) \
    FMI3_CALL(fmi3Get##type)(FMI3_REFERENCES, fmi3##type value[], size_t values); \
    FMI3_CALL(fmi3Set##type)(FMI3_REFERENCES, const fmi3##type value[], size_t values);
FMI3_TYPES(FMI3_DECLARE)
#undef FMI3_DECLARE
FMI3_CALL(fmi3GetBinary)(FMI3_REFERENCES, size_t size[], fmi3Binary value[], size_t values);
FMI3_CALL(fmi3SetBinary)(FMI3_REFERENCES, const size_t size[], const fmi3Binary value[], size_t values);
FMI3_CALL(fmi3GetClock)(FMI3_REFERENCES, fmi3Clock value[]);
FMI3_CALL(fmi3SetClock)(FMI3_REFERENCES, const fmi3Clock value[]);
FMI3_CALL(fmi3GetNumberOfVariableDependencies)(fmi3Instance, fmi3ValueReference, size_t *count);
FMI3_CALL(fmi3GetVariableDependencies)
(fmi3Instance, fmi3ValueReference, size_t element[], fmi3ValueReference independent[], size_t independent_element[],
 fmi3DependencyKind kind[], size_t count);
FMI3_CALL(fmi3GetFMUState)(fmi3Instance, fmi3FMUState *state);
FMI3_CALL(fmi3SetFMUState)(fmi3Instance, fmi3FMUState state);
FMI3_CALL(fmi3FreeFMUState)(fmi3Instance, fmi3FMUState *state);
FMI3_CALL(fmi3SerializedFMUStateSize)(fmi3Instance, fmi3FMUState state, size_t *size);
FMI3_CALL(fmi3SerializeFMUState)(fmi3Instance, fmi3FMUState state, fmi3Byte bytes[], size_t size);
FMI3_CALL(fmi3DeserializeFMUState)(fmi3Instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state);
FMI3_CALL(fmi3GetDirectionalDerivative)(FMI3_DERIVATIVE);
FMI3_CALL(fmi3GetAdjointDerivative)(FMI3_DERIVATIVE);
FMI3_CALL(fmi3EnterConfigurationMode)(fmi3Instance);
FMI3_CALL(fmi3ExitConfigurationMode)(fmi3Instance);
FMI3_CALL(fmi3GetIntervalDecimal)(FMI3_REFERENCES, fmi3Float64 interval[], fmi3IntervalQualifier qualifier[]);
FMI3_CALL(fmi3GetIntervalFraction)
(FMI3_REFERENCES, fmi3UInt64 counter[], fmi3UInt64 resolution[], fmi3IntervalQualifier qualifier[]);
FMI3_CALL(fmi3GetShiftDecimal)(FMI3_REFERENCES, fmi3Float64 shift[]);
FMI3_CALL(fmi3GetShiftFraction)(FMI3_REFERENCES, fmi3UInt64 counter[], fmi3UInt64 resolution[]);
FMI3_CALL(fmi3SetIntervalDecimal)(FMI3_REFERENCES, const fmi3Float64 interval[]);
FMI3_CALL(fmi3SetIntervalFraction)(FMI3_REFERENCES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[]);
FMI3_CALL(fmi3SetShiftDecimal)(FMI3_REFERENCES, const fmi3Float64 shift[]);
FMI3_CALL(fmi3SetShiftFraction)(FMI3_REFERENCES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[]);
FMI3_CALL(fmi3EvaluateDiscreteStates)(fmi3Instance);
FMI3_CALL(fmi3UpdateDiscreteStates)
(fmi3Instance, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
 fmi3Boolean *time_defined, fmi3Float64 *time);
FMI3_CALL(fmi3EnterContinuousTimeMode)(fmi3Instance);
FMI3_CALL(fmi3CompletedIntegratorStep)
(fmi3Instance, fmi3Boolean no_rollback, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate);
FMI3_CALL(fmi3SetTime)(fmi3Instance, fmi3Float64);
FMI3_CALL(fmi3SetContinuousStates)(fmi3Instance, const fmi3Float64 x[], size_t count);
FMI3_CALL(fmi3GetContinuousStateDerivatives)(fmi3Instance, fmi3Float64 rate[], size_t count);
FMI3_CALL(fmi3GetEventIndicators)(fmi3Instance, fmi3Float64 indicator[], size_t count);
FMI3_CALL(fmi3GetContinuousStates)(fmi3Instance, fmi3Float64 x[], size_t count);
FMI3_CALL(fmi3GetNominalsOfContinuousStates)(fmi3Instance, fmi3Float64 x[], size_t count);
FMI3_CALL(fmi3GetNumberOfEventIndicators)(fmi3Instance, size_t *count);
FMI3_CALL(fmi3GetNumberOfContinuousStates)(fmi3Instance, size_t *count);
FMI3_CALL(fmi3EnterStepMode)(fmi3Instance);
FMI3_CALL(fmi3GetOutputDerivatives)(FMI3_REFERENCES, const fmi3Int32 order[], fmi3Float64 value[], size_t values);
FMI3_CALL(fmi3DoStep)
(fmi3Instance, fmi3Float64 point, fmi3Float64 step, fmi3Boolean no_rollback, fmi3Boolean *event_needed,
 fmi3Boolean *terminate, fmi3Boolean *early_return, fmi3Float64 *last_successful_time);
FMI3_CALL(fmi3ActivateModelPartition)(fmi3Instance, fmi3ValueReference clock, fmi3Float64 time);

#ifdef __cplusplus
}
#endif
#endif
