/* SPDX-License-Identifier: MIT
 * importer LIBRARY modelDescription.xml TASK ...: an importer for FMI 2.0 and 3.0, written from the standard's text; it
 * shares no code with the exporter.
 *
 *   steps STEP STOP [NAME=VALUE ...]      co-simulation, a row of all outputs at each communication point (CSV)
 *   cvode TOLERANCE STEP STOP [NAME=VALUE ...]  the same by model exchange under CVODE (BDF, dense)
 *   road SLOPE_X SLOPE_Y FRICTION STEP STOP     as `steps` on a slope that the master gives, wheel by wheel
 *   slope SLOPE_X SLOPE_Y FRICTION STEP STOP    as `cvode 1e-9` there
 *   rollback STEP STOP SEED               co-simulation that goes back at random times, by copies and by bytes, and one
 *                                         that does not: bit for bit the same; two instances by turns
 *   attack SEED CALLS                     random calls in legal and illegal order, see below
 *   early STEP STOP                       FMI 3.0: intermediate updates, and steps that end early, change nothing
 *   dependencies                          outputs and derivatives change with states and inputs that are listed alone
 *   derivatives [NAME=VALUE ...]          directional and adjoint derivatives against differences
 *   control STEP STOP                     a controller in the master steers by the yaw rate
 *   misuse                                wrong GUID, names, references, NaN
 *
 * With LIBRARY modelDescription.xml of a second FMU of FMI 2.0 before TASK:
 *   both STEP STOP                        two vehicles by turns: bit for bit as alone
 *   couple STEP STOP                      front.veh pulls rear.veh
 *
 * Exit status 0: as the standard says. */
#include "importer.h"

#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int messages, allocated; /* of all instances */
static int loud = 1;

static void logger(void *environment, const char *instance, Status status, const char *category, const char *message,
                   ...)
{
    char text[1024];
    va_list args;
    va_start(args, message);
    vsnprintf(text, sizeof text, message, args);
    va_end(args);
    (void)environment;
    ++messages;
    if (loud)
        fprintf(stderr, "%s: %d %s: %s\n", instance, (int)status, category, text);
}

static void *allocate(size_t count, size_t size)
{
    ++allocated;
    return calloc(count, size);
}

static void release(void *memory)
{
    allocated -= memory != NULL;
    free(memory);
}

static const Callbacks callbacks = {logger, allocate, release, NULL, NULL};

_Noreturn void fail(const char *what)
{
    fprintf(stderr, "importer: %s\n", what);
    exit(1);
}

void need(Status status, const char *what)
{
    if (status != OK) {
        fprintf(stderr, "importer: %s returned %d\n", what, (int)status);
        exit(1);
    }
}

void expect(bool good, const char *what)
{
    if (!good)
        fail(what);
}

static void *symbol(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found)
        fail(name);
    return found;
}

Unit unit_load(const char *library_path, const char *description)
{
    Unit unit = {.d = description_read(description)};
    void *library = dlopen(library_path, RTLD_NOW | RTLD_GLOBAL /* symbols that are not hidden would mix */), *found;
    if (!library)
        fail(dlerror());
    if (unit.d.version == 3) {
        version_3_load(&unit, library);
        expect(!strcmp(unit.GetVersion(), "3.0"), "version is not 3.0");
        return unit;
    }
#define LOAD(name, arguments) found = symbol(library, "fmi2" #name), memcpy(&unit.name, &found, sizeof found);
    FUNCTIONS(LOAD)
    LOAD(Instantiate, )
    LOAD(FreeInstance, )
    LOAD(GetVersion, )
    LOAD(GetTypesPlatform, )
#undef LOAD
    expect(!strcmp(unit.GetVersion(), "2.0"), "version is not 2.0");
    expect(!strcmp(unit.GetTypesPlatform(), "default"), "types platform is not default");
    return unit;
}

Component instantiate(const Unit *unit, const char *name, int kind)
{
    Component c = unit->Instantiate(name, kind, unit->d.token, "file:///nowhere", &callbacks, 0, 0);
    expect(c != NULL, "no instance");
    return c;
}

/* NAME=VALUE of real or whole variables. */
static void set(const Unit *unit, Component c, int count, char **word)
{
    for (int i = 0; i < count; ++i) {
        char *equals = strchr(word[i], '=');
        expect(equals != NULL, "NAME=VALUE expected");
        *equals = 0;
        const int v = description_find(&unit->d, word[i]);
        expect(v >= 0, word[i]);
        const double value = strtod(equals + 1, NULL);
        const int whole = (int)value;
        if (unit->d.variable[v].type == REAL)
            need(unit->SetReal(c, &unit->d.variable[v].reference, 1, &value), "fmi2SetReal");
        else
            need(unit->SetInteger(c, &unit->d.variable[v].reference, 1, &whole), "fmi2SetInteger");
        *equals = '=';
    }
}

/* plane: the road of the master's, NULL: none. */
void initialize_on(const Unit *unit, Component c, const double *plane, double stop, int count, char **word)
{
    set(unit, c, count, word);
    need(unit->SetupExperiment(c, 0, 0, 0, 1, stop), "fmi2SetupExperiment");
    need(unit->EnterInitializationMode(c), "fmi2EnterInitializationMode");
    if (plane)
        expect(give_road(unit, c, plane) > 0, "no wheels to give a road to");
    need(unit->ExitInitializationMode(c), "fmi2ExitInitializationMode");
}

static void initialize(const Unit *unit, Component c, double stop, int count, char **word)
{
    initialize_on(unit, c, NULL, stop, count, word);
}

void header(const Unit *unit)
{
    printf("time");
    for (int i = 0; i < unit->d.variables; ++i)
        if (!strcmp(unit->d.variable[i].causality, "output") && unit->d.variable[i].type == REAL)
            printf(",%s [%s]", unit->d.variable[i].name, unit->d.variable[i].unit);
    printf("\n");
}

void row(const Unit *unit, Component c, double time)
{
    printf("%.15g", time);
    for (int i = 0; i < unit->d.variables; ++i)
        if (!strcmp(unit->d.variable[i].causality, "output") && unit->d.variable[i].type == REAL) {
            double value;
            need(unit->GetReal(c, &unit->d.variable[i].reference, 1, &value), "fmi2GetReal");
            printf(",%.17g", value);
        }
    printf("\n");
}

static void steps(const Unit *unit, double step, double stop, int count, char **word)
{
    Component c = instantiate(unit, "vehicle", STEPS);
    const long rows = lround(stop / step);
    initialize(unit, c, stop, count, word);
    header(unit);
    row(unit, c, 0);
    for (long k = 0; k < rows; ++k) {
        need(unit->DoStep(c, (double)k * step, step, 1), "fmi2DoStep");
        row(unit, c, (double)(k + 1) * step);
    }
    need(unit->Terminate(c), "fmi2Terminate");
    unit->FreeInstance(c);
}

/* ---- a road that the master has --------------------------------------------------------------------------------- */

static unsigned named(const Unit *unit, const char *name)
{
    const int v = description_find(&unit->d, name);
    expect(v >= 0, name);
    return unit->d.variable[v].reference;
}

double get_named(const Unit *unit, Component c, const char *name)
{
    const unsigned reference = named(unit, name);
    double value = 0;
    need(unit->GetReal(c, &reference, 1, &value), name);
    return value;
}

void set_named(const Unit *unit, Component c, const char *name, double value)
{
    const unsigned reference = named(unit, name);
    need(unit->SetReal(c, &reference, 1, &value), name);
}

static const char *part(const char *wheel, const char *name)
{
    static char text[200];
    snprintf(text, sizeof text, "%s.%s", wheel, name);
    return text;
}

int give_road(const Unit *unit, Component c, const double plane[3])
{
    int wheels = 0;
    for (int v = 0; v < unit->d.variables; ++v) {
        char wheel[100], *end;
        snprintf(wheel, sizeof wheel, "%s", unit->d.variable[v].name);
        end = strstr(wheel, ".height");
        if (strncmp(wheel, "road.", 5) || !end)
            continue;
        *end = 0;
        const double x = get_named(unit, c, part(wheel, "x")), y = get_named(unit, c, part(wheel, "y"));
        set_named(unit, c, part(wheel, "height"), plane[0] * x + plane[1] * y);
        set_named(unit, c, part(wheel, "normal.x"), -2 * plane[0]); /* of any length */
        set_named(unit, c, part(wheel, "normal.y"), -2 * plane[1]);
        set_named(unit, c, part(wheel, "normal.z"), 2);
        set_named(unit, c, part(wheel, "friction"), plane[2]);
        ++wheels;
    }
    return wheels;
}

static void road(const Unit *unit, const double plane[3], double step, double stop, int count, char **word)
{
    Component c = instantiate(unit, "vehicle", STEPS);
    const long rows = lround(stop / step);
    initialize_on(unit, c, plane, stop, count, word);
    header(unit);
    row(unit, c, 0);
    for (long k = 0; k < rows; ++k) {
        need(unit->DoStep(c, (double)k * step, step, 1), "fmi2DoStep");
        give_road(unit, c, plane);
        row(unit, c, (double)(k + 1) * step);
    }
    need(unit->Terminate(c), "fmi2Terminate");
    unit->FreeInstance(c);
}

/* ---- going back ------------------------------------------------------------------------------------------------- */

static uint64_t random_state;

static unsigned chance(unsigned most)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(random_state >> 33) % most;
}

/* All real variables, as bits. */
static void look(const Unit *unit, Component c, double *value)
{
    for (int i = 0; i < unit->d.variables; ++i)
        if (unit->d.variable[i].type == REAL)
            need(unit->GetReal(c, &unit->d.variable[i].reference, 1, &value[i]), "fmi2GetReal");
}

static void same(const Unit *unit, Component a, Component b, double tolerance)
{
    const size_t size = sizeof(double) * (size_t)unit->d.variables;
    double *one = calloc(1, size), *other = calloc(1, size);
    look(unit, a, one);
    look(unit, b, other);
    for (int i = 0; i < unit->d.variables; ++i)
        if (memcmp(&one[i], &other[i], sizeof *one) && !(fabs(one[i] - other[i]) <= tolerance * (1 + fabs(one[i])))) {
            fprintf(stderr, "importer: '%s' is %.17g and %.17g\n", unit->d.variable[i].name, one[i], other[i]);
            exit(1);
        }
    free(one);
    free(other);
}

/* As `steps` has it, but communication steps take ten steps and some end early: the same rows. */
static void early(const Unit *unit, double step, double stop)
{
    Component straight = instantiate(unit, "straight", STEPS), cut = instantiate(unit, "cut", STEPS);
    const double solver = 0.1 * step;
    const unsigned reference = unit->d.variable[description_find(&unit->d, "solver.step")].reference;
    const long rows = lround(stop / step);
    need(unit->SetReal(straight, &reference, 1, &solver), "fmi3SetFloat64");
    need(unit->SetReal(cut, &reference, 1, &solver), "fmi3SetFloat64");
    initialize(unit, straight, stop, 0, NULL);
    initialize(unit, cut, stop, 0, NULL);
    for (long k = 0; k < rows; ++k) {
        const int before = updates.intermediate;
        need(unit->DoStep(straight, (double)k * step, step, 1), "fmi3DoStep");
        expect(updates.intermediate == before + 9, "not nine intermediate updates in ten steps");
        updates.leave = 1 + (int)(k % 9);
        need(unit->DoStep(cut, (double)k * step, step, 1), "fmi3DoStep");
        updates.leave = 0;
    }
    expect(updates.early == rows, "not one early return in a communication step");
    same(unit, straight, cut, 1e-9);
    unit->FreeInstance(straight);
    unit->FreeInstance(cut);
}

static void rollback(const Unit *unit, double step, double stop, unsigned seed)
{
    Component straight = instantiate(unit, "straight", STEPS), back = instantiate(unit, "back", STEPS);
    void *kept = NULL, *again = NULL;
    char *bytes = NULL;
    size_t size = 0;
    random_state = seed;
    initialize(unit, straight, stop, 0, NULL);
    initialize(unit, back, stop, 0, NULL);
    const long rows = lround(stop / step);
    give_road(unit, straight, (const double[]){0, 0, 0.9});
    give_road(unit, back, (const double[]){0, 0, 0.9});
    for (long k = 0; k < rows; ++k) {
        const double time = (double)k * step;
        if (chance(3) == 0) { /* some steps ahead, then back */
            need(unit->GetFMUstate(back, &kept), "fmi2GetFMUstate");
            need(unit->SerializedFMUstateSize(back, kept, &size), "fmi2SerializedFMUstateSize");
            bytes = realloc(bytes, size);
            need(unit->SerializeFMUstate(back, kept, bytes, size), "fmi2SerializeFMUstate");
            for (long i = 0; i < 1 + (long)chance(4) && k + i < rows; ++i)
                need(unit->DoStep(back, (double)(k + i) * step, step, 0), "fmi2DoStep");
            if (chance(2)) {
                need(unit->SetFMUstate(back, kept), "fmi2SetFMUstate");
            } else { /* into an instance that did not exist when it was made */
                unit->FreeFMUstate(back, &kept);
                unit->FreeInstance(back);
                back = instantiate(unit, "back", STEPS);
                need(unit->DeSerializeFMUstate(back, bytes, size, &again), "fmi2DeSerializeFMUstate");
                need(unit->SetFMUstate(back, again), "fmi2SetFMUstate");
                need(unit->FreeFMUstate(back, &again), "fmi2FreeFMUstate");
                expect(!again, "a freed state is not NULL");
            }
        }
        if (chance(4) == 0)
            same(unit, straight, back, -1); /* looking leaves no trace: one of the two is looked at twice */
        if (chance(4) == 0)
            look(unit, straight, (double[10000]){0});
        need(unit->DoStep(straight, time, step, 0), "fmi2DoStep");
        need(unit->DoStep(back, time, step, 0), "fmi2DoStep");
    }
    same(unit, straight, back, -1);
    /* reset begins anew */
    Component fresh = instantiate(unit, "fresh", STEPS);
    need(unit->Reset(back), "fmi2Reset");
    initialize(unit, back, stop, 0, NULL);
    initialize(unit, fresh, stop, 0, NULL);
    need(unit->DoStep(back, 0, step, 0), "fmi2DoStep");
    need(unit->DoStep(fresh, 0, step, 0), "fmi2DoStep");
    same(unit, fresh, back, -1);
    if (kept)
        need(unit->FreeFMUstate(back, &kept), "fmi2FreeFMUstate");
    unit->FreeInstance(straight);
    unit->FreeInstance(back);
    unit->FreeInstance(fresh);
    free(bytes);
    expect(!allocated, "memory is left behind");
}

/* ---- dependencies ---------------------------------------------------------------------------------------------- */

/* All outputs and derivatives at the present states and inputs. */
static void unknowns(const Unit *unit, Component c, double *value)
{
    for (int i = 0; i < unit->d.variables; ++i) {
        const Variable *v = &unit->d.variable[i];
        if (v->type == REAL && (!strcmp(v->causality, "output") || v->derivative >= 0))
            need(unit->GetReal(c, &v->reference, 1, &value[i]), "fmi2GetReal");
    }
}

static bool is_dependency(const Variable *unknown, int known)
{
    for (int i = 0; i < unknown->dependencies; ++i)
        if (unknown->dependency[i] == known)
            return true;
    return unknown->everything;
}

/* What changes with a state or an input is listed as dependence. */
static void dependencies(const Unit *unit)
{
    const Description *d = &unit->d;
    const size_t n = (size_t)d->states, size = sizeof(double) * (size_t)(d->variables + 1);
    double *x = calloc(n + 1, sizeof *x), *before = calloc(1, size), *after = calloc(1, size);
    Component c = instantiate(unit, "vehicle", EXCHANGE);
    long changed = 0, free = 0;
    random_state = 11;
    initialize(unit, c, 1, 0, NULL);
    event(unit, c);
    need(unit->GetContinuousStates(c, x, n), "fmi2GetContinuousStates");
    for (size_t i = 0; i < n; ++i) /* nothing is zero */
        x[i] += 1e-3 * (1 + chance(100) / 100.0);
    need(unit->SetContinuousStates(c, x, n), "fmi2SetContinuousStates");
    unknowns(unit, c, before);
    for (int known = 0; known < d->variables; ++known) {
        const Variable *v = &d->variable[known];
        int state = (int)n - 1;
        double value = 0, moved;
        while (state >= 0 && d->state[state] != known)
            --state;
        if (state < 0 && (strcmp(v->causality, "input") || v->type != REAL))
            continue;
        if (state < 0)
            need(unit->GetReal(c, &v->reference, 1, &value), "fmi2GetReal");
        moved = (state < 0 ? value : x[state]) + 1e-4;
        if (state < 0) {
            need(unit->SetReal(c, &v->reference, 1, &moved), "fmi2SetReal");
        } else {
            value = x[state];
            x[state] = moved;
            need(unit->SetContinuousStates(c, x, n), "fmi2SetContinuousStates");
        }
        unknowns(unit, c, after);
        for (int i = 0; i < d->variables; ++i) {
            const bool other = fabs(after[i] - before[i]) > 1e-8 * (1 + fabs(before[i]));
            changed += other;
            free += !is_dependency(&d->variable[i], known);
            if (other && !is_dependency(&d->variable[i], known)) {
                fprintf(stderr, "importer: '%s' depends on '%s', which is not listed: %.17g and %.17g\n",
                        d->variable[i].name, v->name, before[i], after[i]);
                exit(1);
            }
        }
        if (state < 0) {
            need(unit->SetReal(c, &v->reference, 1, &value), "fmi2SetReal");
        } else {
            x[state] = value;
            need(unit->SetContinuousStates(c, x, n), "fmi2SetContinuousStates");
        }
    }
    expect(changed > 0 && free > 0, "nothing depends on anything, or all on everything");
    fprintf(stderr, "importer: %ld dependences seen, %ld pairs are said to have none\n", changed, free);
    unit->FreeInstance(c);
}

/* ---- calls in any order ----------------------------------------------------------------------------------------- */

/* Modes after the standard's state machines (sections 3.2.3 and 4.2.4 of FMI 2.0.4). */
enum { I = 1, N = 2, E = 4, C = 8, S = 16, T = 32, ANY = 63 };

typedef struct Call {
    const char *name;
    int modes[2]; /* where it is legal: model exchange, co-simulation; 0: nowhere */
} Call;

static const Call call[] = {
    {"SetupExperiment", {I, I}},
    {"EnterInitializationMode", {I, I}},
    {"ExitInitializationMode", {N, N}},
    {"Terminate", {E | C, S}},
    {"Reset", {ANY, ANY}},
    {"GetReal", {ANY & ~I, ANY & ~I}},
    {"SetReal", {I | N | E | C, I | N | S}}, /* of an input */
    {"SetReal of a state", {I | N, I | N}},
    {"GetFMUstate", {ANY, ANY}},
    {"SetFMUstate", {ANY, ANY}},
    {"EnterEventMode", {E | C, 0}},
    {"NewDiscreteStates", {E, 0}},
    {"EnterContinuousTimeMode", {E, 0}},
    {"CompletedIntegratorStep", {C, 0}},
    {"SetTime", {E | C, 0}},
    {"SetContinuousStates", {C, 0}},
    {"GetDerivatives", {ANY & ~I, 0}},
    {"GetContinuousStates", {ANY & ~I, 0}},
    {"GetNominalsOfContinuousStates", {ANY, 0}},
    {"GetEventIndicators", {ANY & ~I, 0}},
    {"DoStep", {0, S}},
    {"CancelStep", {0, 0}},
    {"SetRealInputDerivatives", {0, I | N | S}},
    {"GetRealStatus", {0, S | T}},
    {"GetBooleanStatus", {0, S | T}},
};

enum { CALLS = sizeof call / sizeof *call };

typedef struct Attack {
    const Unit *unit;
    Component c;
    int kind, mode, kept_mode;
    double time, kept_time;
    void *kept;
    int input, state; /* variables, -1: none */
} Attack;

static Status make(Attack *a, int which)
{
    const Unit *unit = a->unit;
    const size_t n = (size_t)unit->d.states;
    double x[1000], value = 0;
    EventInfo info;
    int flag[2], order = 1;
    const unsigned *input = a->input >= 0 ? &unit->d.variable[a->input].reference : NULL;
    const unsigned *state = &unit->d.variable[a->state].reference;
    switch (which) {
    case 0: return unit->SetupExperiment(a->c, 0, 0, 0, 0, 0);
    case 1: return unit->EnterInitializationMode(a->c);
    case 2: return unit->ExitInitializationMode(a->c);
    case 3: return unit->Terminate(a->c);
    case 4: return unit->Reset(a->c);
    case 5: return unit->GetReal(a->c, &unit->d.variable[unit->d.rate[chance((unsigned)n)]].reference, 1, &value);
    case 6: /* friction takes no 0, so what it starts with */
        value = input && unit->d.variable[a->input].starts ? unit->d.variable[a->input].start : 0;
        return unit->SetReal(a->c, input, input != NULL, &value);
    case 7: value = unit->d.variable[a->state].start; return unit->SetReal(a->c, state, 1, &value);
    case 8: return unit->GetFMUstate(a->c, &a->kept);
    case 9: return unit->SetFMUstate(a->c, a->kept);
    case 10: return unit->EnterEventMode(a->c);
    case 11: return unit->NewDiscreteStates(a->c, &info);
    case 12: return unit->EnterContinuousTimeMode(a->c);
    case 13: return unit->CompletedIntegratorStep(a->c, 1, &flag[0], &flag[1]);
    case 14: return unit->SetTime(a->c, 0.001 * chance(10));
    case 15:
        memset(x, 0, sizeof x);
        if (a->kind == EXCHANGE && a->mode == C) /* elsewhere looking might change what an illegal call may not */
            need(unit->GetContinuousStates(a->c, x, n), "fmi2GetContinuousStates");
        return unit->SetContinuousStates(a->c, x, n);
    case 16: return unit->GetDerivatives(a->c, x, n);
    case 17: return unit->GetContinuousStates(a->c, x, n);
    case 18: return unit->GetNominalsOfContinuousStates(a->c, x, n);
    case 19: return unit->GetEventIndicators(a->c, x, (size_t)unit->d.indicators);
    case 20: return unit->DoStep(a->c, a->time, 0.001, 1);
    case 21: return unit->CancelStep(a->c);
    case 22: return unit->SetRealInputDerivatives(a->c, input, input != NULL, &order, &value);
    case 23: return unit->GetRealStatus(a->c, 2, &value);
    default: return unit->GetBooleanStatus(a->c, 3, &flag[0]);
    }
}

/* What a legal call does to the mode. */
static void follow(Attack *a, int which)
{
    switch (which) {
    case 1: a->mode = N; break;
    case 2: a->mode = a->kind == EXCHANGE ? E : S; break;
    case 3: a->mode = T; break;
    case 4: a->mode = I, a->time = 0; break;
    case 8: a->kept_mode = a->mode, a->kept_time = a->time; break;
    case 9: a->mode = a->kept_mode, a->time = a->kept_time; break;
    case 10: a->mode = E; break;
    case 12: a->mode = C; break;
    case 20: a->time += 0.001; break;
    default: break;
    }
}

static char *bytes_of(const Unit *unit, Component c, size_t *size)
{
    void *state = NULL;
    need(unit->GetFMUstate(c, &state), "fmi2GetFMUstate");
    need(unit->SerializedFMUstateSize(c, state, size), "fmi2SerializedFMUstateSize");
    char *bytes = malloc(*size);
    need(unit->SerializeFMUstate(c, state, bytes, *size), "fmi2SerializeFMUstate");
    need(unit->FreeFMUstate(c, &state), "fmi2FreeFMUstate");
    return bytes;
}

static void attack(const Unit *unit, unsigned seed, long calls)
{
    long legal = 0, illegal = 0;
    loud = 0;
    random_state = seed;
    for (int kind = EXCHANGE; kind <= STEPS; ++kind) {
        Attack a = {.unit = unit, .kind = kind, .mode = I, .kept_mode = I, .input = -1, .state = -1};
        for (int i = 0; i < unit->d.variables; ++i)
            if (!strcmp(unit->d.variable[i].causality, "input") && unit->d.variable[i].type == REAL)
                a.input = i;
        for (int i = 0; i < unit->d.states; ++i)
            if (unit->d.variable[unit->d.state[i]].starts)
                a.state = unit->d.state[i];
        a.c = instantiate(unit, "attacked", kind);
        need(unit->GetFMUstate(a.c, &a.kept), "fmi2GetFMUstate");
        for (long k = 0; k < calls; ++k) {
            int which = (int)chance(CALLS);
            if ((which == 4 || which == 3) && chance(8))
                which = 20; /* else there is little between resets */
            bool allowed = call[which].modes[kind] & a.mode;
            if (unit->d.version == 3 && which == 10)
                allowed = kind == EXCHANGE && a.mode == C; /* section 3.2 of FMI 3.0 */
            if (unit->d.version == 3 && (which == 0 || which > 21))
                continue; /* not functions of FMI 3.0 */
            /* without inputs there is nothing to set, and that is never wrong */
            if (a.input < 0 && (which == 6 || which == 22))
                continue;
            size_t size, after;
            char *before = allowed ? NULL : bytes_of(unit, a.c, &size);
            const int said = messages;
            const Status status = make(&a, which);
            /* a warning: the road under a wheel goes on by its normal, and takes no derivatives */
            const bool fine = status == OK || (which == 22 && status == WARNING);
            if (allowed ? !fine : status != ERROR) {
                fprintf(stderr, "importer: fmi2%s (%s) in mode %d returned %d\n", call[which].name,
                        kind == EXCHANGE ? "model exchange" : "co-simulation", a.mode, (int)status);
                exit(1);
            }
            if (allowed) {
                follow(&a, which);
                ++legal;
                continue;
            }
            ++illegal;
            expect(messages > said, "an error without a message");
            char *then = bytes_of(unit, a.c, &after);
            expect(size == after && !memcmp(before, then, size), "an illegal call changed the instance");
            free(before);
            free(then);
        }
        unit->FreeFMUstate(a.c, &a.kept);
        unit->FreeInstance(a.c);
    }
    expect(!allocated, "memory is left behind");
    expect(legal > calls / 4 && illegal > calls / 4, "too few calls of a kind");
    fprintf(stderr, "importer: %ld legal and %ld illegal calls\n", legal, illegal);
}

/* ---- wrong arguments -------------------------------------------------------------------------------------------- */

static void misuse(const Unit *unit)
{
    const Callbacks silent = {NULL, NULL, NULL, NULL, NULL};
    const unsigned nobody = 0xfffffff0u, time = unit->d.variable[0].reference;
    double value = 1, nan_value = NAN;
    int whole = 1, order = 1;
    size_t size;
    void *state = NULL;
    loud = 0;
    expect(!unit->Instantiate("a", STEPS, "{00000000-0000-0000-0000-000000000000}", "", &callbacks, 0, 0),
           "wrong GUID");
    expect(messages == 1, "a wrong GUID is not logged");
    expect(!unit->Instantiate("a", STEPS, NULL, "", &callbacks, 0, 0), "GUID NULL");
    expect(!unit->Instantiate(NULL, STEPS, unit->d.token, "", &callbacks, 0, 0), "name NULL");
    expect(!unit->Instantiate("", STEPS, unit->d.token, "", &callbacks, 0, 0), "empty name");
    expect(unit->d.version == 3 || !unit->Instantiate("a", 7, unit->d.token, "", &callbacks, 0, 0), "wrong type");
    expect(!unit->Instantiate("a", STEPS, unit->d.token, "", NULL, 0, 0), "no callbacks");
    expect(unit->GetReal(NULL, &time, 1, &value) == ERROR, "an instance that is NULL");
    unit->FreeInstance(NULL);
    Component c = unit->Instantiate("quiet", STEPS, unit->d.token, NULL, &silent, 0, 1);
    expect(c != NULL, "callbacks may be NULL");
    unit->FreeInstance(c);

    c = instantiate(unit, "vehicle", STEPS);
    expect(unit->SetupExperiment(c, 0, 0, NAN, 0, 0) == ERROR, "start time NaN");
    expect(unit->SetupExperiment(c, 0, 0, 1, 1, 0) == ERROR, "stop before start");
    initialize(unit, c, 1, 0, NULL);
    expect(unit->GetReal(c, &nobody, 1, &value) == ERROR, "unknown reference, real");
    expect(unit->SetReal(c, &nobody, 1, &value) == ERROR, "unknown reference, real, set");
    expect(unit->GetInteger(c, &time, 1, &whole) == ERROR, "a real variable as a whole one");
    expect(unit->GetBoolean(c, &time, 1, &whole) == ERROR, "no variable is Boolean");
    expect(unit->GetReal(c, NULL, 1, &value) == ERROR, "references NULL");
    expect(unit->GetReal(c, NULL, 0, NULL) == OK, "no references");
    expect(unit->DoStep(c, 0.5, 0.001, 1) == ERROR, "a communication point elsewhere");
    expect(unit->DoStep(c, 0, -0.001, 1) == ERROR, "a step backwards");
    expect(unit->DoStep(c, 0, NAN, 1) == ERROR, "a step NaN");
    expect(unit->DoStep(c, 0, 2, 1) == ERROR, "a step behind the stop time");
    for (int i = 0; i < unit->d.variables; ++i)
        if (!strcmp(unit->d.variable[i].causality, "input")) {
            const unsigned reference = unit->d.variable[i].reference;
            double before, after;
            need(unit->GetReal(c, &reference, 1, &before), "fmi2GetReal");
            messages = 0;
            expect(unit->SetReal(c, &reference, 1, &nan_value) == DISCARD, "an input NaN");
            expect(messages == 1, "NaN is not logged");
            need(unit->GetReal(c, &reference, 1, &after), "fmi2GetReal");
            expect(before == after, "NaN was taken");
            if (unit->d.version == 3)
                continue;
            expect(unit->SetRealInputDerivatives(c, &reference, 1, &order, &nan_value) != OK, "a derivative NaN");
            order = 3;
            expect(unit->SetRealInputDerivatives(c, &reference, 1, &order, &value) != OK, "a derivative of order 3");
            order = 1;
        }
    need(unit->DoStep(c, 0, 0.001, 1), "a step after all of that");
    need(unit->GetFMUstate(c, &state), "fmi2GetFMUstate");
    need(unit->SerializedFMUstateSize(c, state, &size), "size");
    char *bytes = calloc(1, size);
    void *other = NULL;
    expect(unit->SerializeFMUstate(c, state, bytes, size - 1) == ERROR, "no room for a state");
    expect(unit->DeSerializeFMUstate(c, bytes, size, &other) == ERROR && !other, "bytes that are no state");
    need(unit->SerializeFMUstate(c, state, bytes, size), "fmi2SerializeFMUstate");
    expect(unit->DeSerializeFMUstate(c, bytes, size - 1, &other) == ERROR && !other, "a part of a state");
    Component exchange = instantiate(unit, "other", EXCHANGE);
    expect(unit->SetFMUstate(exchange, state) == ERROR, "the state of the other interface");
    need(unit->FreeFMUstate(c, &state), "fmi2FreeFMUstate");
    need(unit->FreeFMUstate(c, &state), "fmi2FreeFMUstate of NULL");
    free(bytes);
    unit->FreeInstance(exchange);
    unit->FreeInstance(c);
    expect(!allocated, "memory is left behind");
}

int main(int count, char **word)
{
    if (count < 4)
        fail("usage: see the first lines of importer.c");
    const Unit unit = unit_load(word[1], word[2]);
    Unit other = {.d = {.version = 0}};
    if (count > 5 && strstr(word[3], ".so")) { /* a second FMU */
        other = unit_load(word[3], word[4]);
        word += 2;
        count -= 2;
    }
    const char *task = word[3];
    double number[5] = {0};
    int given = 0;
    while (given < 5 && 4 + given < count && !strchr(word[4 + given], '=')) {
        number[given] = strtod(word[4 + given], NULL);
        ++given;
    }
    char **rest = word + 4 + given;
    const int rests = count - 4 - given;
    if (!strcmp(task, "steps") && given == 2)
        steps(&unit, number[0], number[1], rests, rest);
    else if (!strcmp(task, "cvode") && given == 3)
        cvode(&unit, number[0], NULL, number[1], number[2], rests, rest);
    else if (!strcmp(task, "road") && given == 5)
        road(&unit, number, number[3], number[4], rests, rest);
    else if (!strcmp(task, "slope") && given == 5)
        cvode(&unit, 1e-9, number, number[3], number[4], rests, rest);
    else if (!strcmp(task, "control") && given == 2)
        control(&unit, number[0], number[1]);
    else if ((!strcmp(task, "couple") || !strcmp(task, "both")) && given == 2 && rests == 0)
        (task[0] == 'c' ? couple : both)(&unit, &other, number[0], number[1]);
    else if (!strcmp(task, "rollback") && given == 3)
        rollback(&unit, number[0], number[1], (unsigned)number[2]);
    else if (!strcmp(task, "attack") && given == 2)
        attack(&unit, (unsigned)number[0], (long)number[1]);
    else if (!strcmp(task, "dependencies"))
        dependencies(&unit);
    else if (!strcmp(task, "derivatives") && given == 0)
        check_derivatives(&unit, rests, rest);
    else if (!strcmp(task, "early") && given == 2)
        early(&unit, number[0], number[1]);
    else if (!strcmp(task, "misuse"))
        misuse(&unit);
    else
        fail("usage: see the first lines of importer.c");
    return 0;
}
