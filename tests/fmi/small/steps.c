/* SPDX-License-Identifier: MIT
 * steps STEP COUNT UNIT TOKEN REFERENCES [UNIT TOKEN REFERENCES ...]: co-simulation of FMUs by turns, COUNT steps of
 * STEP seconds each, with C99 and what loads libraries alone, so that it runs where an FMU's binary does. Prints the
 * real variables with the value references `1,2,3` at the end: bits and number, one a line. VERSION, 2 or 3: of FMI.
 * UNIT: a library; where FIRST and SECOND are defined, 1 or 2: the one of two FMUs linked into this program whose
 * functions' names begin with it. Declared after the standard's text; no code of the exporter. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *Component;
typedef void Log2(void *, const char *, int, const char *, const char *, ...);
typedef void Log3(void *, int, const char *, const char *);
typedef struct Callbacks {
    Log2 *logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *rest[2];
} Callbacks;

#if VERSION == 2
#define FUNCTIONS(X) \
    X(const char *, fmi2GetVersion, (void)) \
    X(Component, fmi2Instantiate, (const char *, int, const char *, const char *, const Callbacks *, int, int)) \
    X(int, fmi2SetupExperiment, (Component, int, double, double, int, double)) \
    X(int, fmi2EnterInitializationMode, (Component)) \
    X(int, fmi2ExitInitializationMode, (Component)) \
    X(int, fmi2DoStep, (Component, double, double, int)) \
    X(int, fmi2GetReal, (Component, const unsigned[], size_t, double[])) \
    X(int, fmi2Terminate, (Component)) \
    X(void, fmi2FreeInstance, (Component))
#else
#define FUNCTIONS(X) \
    X(const char *, fmi3GetVersion, (void)) \
    X(Component, fmi3InstantiateCoSimulation, \
      (const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t[], size_t, void *, Log3 *, \
       void *)) \
    X(int, fmi3EnterInitializationMode, (Component, bool, double, double, bool, double)) \
    X(int, fmi3ExitInitializationMode, (Component)) \
    X(int, fmi3DoStep, (Component, double, double, bool, bool *, bool *, bool *, double *)) \
    X(int, fmi3GetFloat64, (Component, const uint32_t[], size_t, double[], size_t)) \
    X(int, fmi3Terminate, (Component)) \
    X(void, fmi3FreeInstance, (Component))
#endif

typedef struct Unit {
#define MEMBER(type, name, arguments) type(*name) arguments;
    FUNCTIONS(MEMBER)
#undef MEMBER
    Component instance;
} Unit;

static void need(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "steps: %s\n", what);
        exit(1);
    }
}

#ifdef FIRST
#define PASTE(a, b) a##b
#define PASTED(a, b) PASTE(a, b)
#define DECLARE(type, name, arguments) \
    extern type PASTED(FIRST, name) arguments; \
    extern type PASTED(SECOND, name) arguments;
FUNCTIONS(DECLARE)

static void load(Unit *unit, const char *which)
{
#define TAKE(type, name, arguments) unit->name = *which == '1' ? PASTED(FIRST, name) : PASTED(SECOND, name);
    FUNCTIONS(TAKE)
}
#else
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) (void *)LoadLibraryA(path)
#define FIND(library, name) (void *)(uintptr_t)GetProcAddress((HMODULE)(library), name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

static void load(Unit *unit, const char *path)
{
    void *library = OPEN(path), *found;
    need(library != NULL, "the library can't be loaded");
#define TAKE(type, name, arguments) \
    found = FIND(library, #name); \
    need(found != NULL, #name); \
    memcpy(&unit->name, &found, sizeof found);
    FUNCTIONS(TAKE)
}
#endif

#if VERSION == 2
static void say(void *environment, const char *name, int status, const char *category, const char *text, ...)
{
    (void)environment;
    fprintf(stderr, "%s: %d %s: %s\n", name, status, category, text);
}

static void begin(Unit *unit, const char *token)
{
    static const Callbacks callbacks = {say, calloc, free, {NULL, NULL}};
    need(!strcmp(unit->fmi2GetVersion(), "2.0"), "the version is not 2.0");
    need(!unit->fmi2Instantiate("x", 1, "another", "", &callbacks, 0, 0), "another GUID is taken");
    unit->instance = unit->fmi2Instantiate("x", 1, token, "", &callbacks, 0, 0);
    need(unit->instance != NULL, "there is no instance");
    need(!unit->fmi2SetupExperiment(unit->instance, 0, 0, 0, 0, 0), "fmi2SetupExperiment");
    need(!unit->fmi2EnterInitializationMode(unit->instance), "fmi2EnterInitializationMode");
    need(!unit->fmi2ExitInitializationMode(unit->instance), "fmi2ExitInitializationMode");
}

static bool step(const Unit *unit, double time, double length)
{
    return !unit->fmi2DoStep(unit->instance, time, length, 1);
}

static bool get(const Unit *unit, uint32_t reference, double *value)
{
    const unsigned one = reference;
    return !unit->fmi2GetReal(unit->instance, &one, 1, value);
}

static void end(const Unit *unit)
{
    need(!unit->fmi2Terminate(unit->instance), "fmi2Terminate");
    unit->fmi2FreeInstance(unit->instance);
}
#else
static void say(void *environment, int status, const char *category, const char *text)
{
    (void)environment;
    fprintf(stderr, "%d %s: %s\n", status, category, text);
}

static void begin(Unit *unit, const char *token)
{
    need(!strcmp(unit->fmi3GetVersion(), "3.0"), "the version is not 3.0");
    need(!unit->fmi3InstantiateCoSimulation("x", "another", "", 0, 0, 0, 0, NULL, 0, NULL, say, NULL),
         "another token is taken");
    unit->instance = unit->fmi3InstantiateCoSimulation("x", token, "", 0, 0, 0, 0, NULL, 0, NULL, say, NULL);
    need(unit->instance != NULL, "there is no instance");
    need(!unit->fmi3EnterInitializationMode(unit->instance, 0, 0, 0, 0, 0), "fmi3EnterInitializationMode");
    need(!unit->fmi3ExitInitializationMode(unit->instance), "fmi3ExitInitializationMode");
}

static bool step(const Unit *unit, double time, double length)
{
    bool event, terminate, early;
    double last;
    return !unit->fmi3DoStep(unit->instance, time, length, 1, &event, &terminate, &early, &last);
}

static bool get(const Unit *unit, uint32_t reference, double *value)
{
    return !unit->fmi3GetFloat64(unit->instance, &reference, 1, value, 1);
}

static void end(const Unit *unit)
{
    need(!unit->fmi3Terminate(unit->instance), "fmi3Terminate");
    unit->fmi3FreeInstance(unit->instance);
}
#endif

int main(int count, char **word)
{
    Unit unit[4];
    const int units = (count - 3) / 3;
    need(units >= 1 && units <= 4 && count == 3 + 3 * units, "usage: steps STEP COUNT UNIT TOKEN REFERENCES ...");
    const double length = strtod(word[1], NULL);
    for (int u = 0; u < units; ++u) {
        load(&unit[u], word[3 + 3 * u]);
        begin(&unit[u], word[4 + 3 * u]);
    }
    for (long k = 0; k < strtol(word[2], NULL, 10); ++k)
        for (int u = 0; u < units; ++u)
            need(step(&unit[u], (double)k * length, length), "a step failed");
    for (int u = 0; u < units; ++u) {
        for (char *at = word[5 + 3 * u]; *at; at += *at == ',') {
            double value;
            uint64_t bits;
            need(get(&unit[u], (uint32_t)strtoul(at, &at, 10), &value), "a value can't be had");
            memcpy(&bits, &value, sizeof bits);
            printf("%08lx%08lx %.17g\n", (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffff), value);
        }
        end(&unit[u]);
    }
    return 0;
}
