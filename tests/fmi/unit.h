/* SPDX-License-Identifier: MIT
 *
 * The functions of an FMU as the importer calls them: those of FMI 2.0; version_3.c makes them of those of FMI 3.0. */
#ifndef FMI_UNIT_H
#define FMI_UNIT_H

#include "description.h"

#include <stddef.h>

typedef void *Component;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef struct {
    void (*logger)(void *, const char *, Status, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;
typedef struct {
    int again, terminate, nominals_changed, values_changed, time_defined;
    double time;
} EventInfo;

/* X(name, arguments behind the component) */
#define FUNCTIONS(X) \
    X(SetDebugLogging, (Component, int, size_t, const char *const[])) \
    X(SetupExperiment, (Component, int, double, double, int, double)) \
    X(EnterInitializationMode, (Component)) \
    X(ExitInitializationMode, (Component)) \
    X(Terminate, (Component)) \
    X(Reset, (Component)) \
    X(GetReal, (Component, const unsigned[], size_t, double[])) \
    X(GetInteger, (Component, const unsigned[], size_t, int[])) \
    X(GetBoolean, (Component, const unsigned[], size_t, int[])) \
    X(GetString, (Component, const unsigned[], size_t, const char *[])) \
    X(SetReal, (Component, const unsigned[], size_t, const double[])) \
    X(SetInteger, (Component, const unsigned[], size_t, const int[])) \
    X(SetBoolean, (Component, const unsigned[], size_t, const int[])) \
    X(SetString, (Component, const unsigned[], size_t, const char *const[])) \
    X(GetFMUstate, (Component, void **)) \
    X(SetFMUstate, (Component, void *)) \
    X(FreeFMUstate, (Component, void **)) \
    X(SerializedFMUstateSize, (Component, void *, size_t *)) \
    X(SerializeFMUstate, (Component, void *, char[], size_t)) \
    X(DeSerializeFMUstate, (Component, const char[], size_t, void **)) \
    X(GetDirectionalDerivative, \
      (Component, const unsigned[], size_t, const unsigned[], size_t, const double[], double[])) \
    X(EnterEventMode, (Component)) \
    X(NewDiscreteStates, (Component, EventInfo *)) \
    X(EnterContinuousTimeMode, (Component)) \
    X(CompletedIntegratorStep, (Component, int, int *, int *)) \
    X(SetTime, (Component, double)) \
    X(SetContinuousStates, (Component, const double[], size_t)) \
    X(GetDerivatives, (Component, double[], size_t)) \
    X(GetEventIndicators, (Component, double[], size_t)) \
    X(GetContinuousStates, (Component, double[], size_t)) \
    X(GetNominalsOfContinuousStates, (Component, double[], size_t)) \
    X(SetRealInputDerivatives, (Component, const unsigned[], size_t, const int[], const double[])) \
    X(GetRealOutputDerivatives, (Component, const unsigned[], size_t, const int[], double[])) \
    X(DoStep, (Component, double, double, int)) \
    X(CancelStep, (Component)) \
    X(GetStatus, (Component, int, Status *)) \
    X(GetRealStatus, (Component, int, double *)) \
    X(GetIntegerStatus, (Component, int, int *)) \
    X(GetBooleanStatus, (Component, int, int *)) \
    X(GetStringStatus, (Component, int, const char **))

typedef struct Unit {
    Description d;
    /* NULL: FMI 2.0, which has none */
    Status (*GetAdjointDerivative)(Component, const unsigned[], size_t, const unsigned[], size_t, const double[],
                                   double[]);
#define MEMBER(name, arguments) Status(*name) arguments;
    FUNCTIONS(MEMBER)
#undef MEMBER
    Component (*Instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    void (*FreeInstance)(Component);
    const char *(*GetVersion)(void), *(*GetTypesPlatform)(void);
} Unit;

/* Functions of FMI 3.0 behind those of the structure. `intermediate` counts intermediate updates; where `leave` is
 * greater than 0 the next but so many asks for an early return. */
void version_3_load(Unit *unit, void *library);
typedef struct Updates {
    int intermediate, leave, early;
    double last_time;
} Updates;
extern Updates updates;

#endif
