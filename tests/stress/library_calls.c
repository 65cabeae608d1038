/* SPDX-License-Identifier: MIT
 * library_calls FIRST LAST CALLS THREADS MODEL[=SCENE]...: random sequences of calls of the library, one for each seed
 * from FIRST to LAST: models, instances, batches and results in any order, closed and foreign handles, wrong sizes,
 * NULL, NaN and huge numbers. A call that is wrong by gic.h must be GICL_WRONG, any other must not; each that fails
 * must say why and leave the vehicle as it was, each good step finite states. In several threads each has things of its
 * own and calls with those of others. Prints a row for run.sh; the same arguments give the same calls. */
#include "host/gic.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THINGS = 40, KINDS = 4, VEHICLES = 5, NUMBERS = 400, FOREIGN = 64 };

typedef enum Kind { MODEL, INSTANCE, BATCH, RESULT } Kind;

typedef struct Thing {
    gicl_handle handle;
    Kind kind;
    bool open;
    int made_as; /* of models, instances and batches: which model, with which options */
    int vehicles, lanes;
} Thing;

/* What threads see of one another. */
typedef struct Shared {
    pthread_mutex_t lock;
    gicl_handle handle[FOREIGN];
    int count;
} Shared;

typedef struct Fuzz {
    gicl_library *lib;
    gicl_messages *said, *list; /* said: NULL in some calls */
    Shared *shared;             /* NULL: there is one thread */
    uint64_t random;
    unsigned seed;
    int models;
    char **model;
    Thing thing[THINGS];
    int things;
    char *snapshot;
    size_t snapshot_size;
    int snapshot_of;
    long tried, good, refused, wrong;
    uint64_t digest; /* of statuses */
} Fuzz;

static uint64_t draw(Fuzz *f)
{
    f->random ^= f->random >> 12;
    f->random ^= f->random << 25;
    f->random ^= f->random >> 27;
    return f->random * 0x2545f4914f6cdd1du >> 16;
}

static int below(Fuzz *f, int count)
{
    return (int)(draw(f) % (uint64_t)count);
}

static bool once_in(Fuzz *f, int count)
{
    return below(f, count) == 0;
}

static double odd_number(Fuzz *f)
{
    static const double odd[] = {NAN,     INFINITY, -INFINITY, 0.0,  -0.0, 1e-320, DBL_MAX, -DBL_MAX,
                                 DBL_MIN, 1e20,     -1e20,     1e-9, 1.0,  -1.0,   0.5,     1e6};
    return odd[below(f, sizeof odd / sizeof *odd)];
}

static int odd_count(Fuzz *f)
{
    static const int odd[] = {-1, 0, 1, 2, 3, 7, 1000, INT_MAX, INT_MIN, 1 << 24, (1 << 24) + 1};
    return odd[below(f, sizeof odd / sizeof *odd)];
}

static int open_count(const Fuzz *f, Kind kind)
{
    int count = 0;
    for (int i = 0; i < f->things; ++i)
        count += f->thing[i].open && f->thing[i].kind == kind;
    return count;
}

/* ---- judging ---------------------------------------------------------------------------------------------------- */

enum { MAY = 2 }; /* wrong or not: who knows */

static _Noreturn void found(const Fuzz *f, const char *call, int status, const char *what)
{
    gicl_message message;
    fprintf(stderr, "seed %u, call %ld, %s: status %d: %s\n", f->seed, f->tried, call, status, what);
    for (int i = 0; gicl_message_get(f->list, i, &message); ++i)
        fputs(message.printed, stderr);
    exit(1);
}

/* Another thread is using the thing, which no call can know beforehand. */
static bool is_busy(const Fuzz *f)
{
    gicl_message message;
    return f->shared && (!f->said || (gicl_message_get(f->said, 0, &message) && strstr(message.text, "another call")));
}

/* Count a call; wrong: by gic.h, or MAY. Returns the status. */
static int judge(Fuzz *f, const char *call, int wrong, int status)
{
    gicl_message message;
    const int count = gicl_message_count(f->said);
    ++f->tried;
    *(status == GICL_OK ? &f->good : &f->refused) += 1;
    f->wrong += status == GICL_WRONG;
    f->digest = (f->digest ^ (uint64_t)(unsigned)status) * 0x100000001b3u;
    if (status > GICL_WRONG)
        found(f, call, status, "there is no such status");
    if (wrong == 1 && status != GICL_WRONG)
        found(f, call, status, "the call is wrong");
    if (wrong == 0 && status == GICL_WRONG && !is_busy(f))
        found(f, call, status, "the call is right");
    if (f->said && status != GICL_OK) {
        if (!gicl_message_get(f->said, count - 1, &message) || message.kind != GICL_ERROR || !*message.text ||
            !strstr(message.printed, message.text) || gicl_message_get(f->said, count, &message))
            found(f, call, status, "it does not say why");
    }
    for (int i = 0; f->said && status == GICL_OK && gicl_message_get(f->said, i, &message); ++i)
        if (message.kind == GICL_ERROR)
            found(f, call, status, "it fails and says so in messages alone");
    return status;
}

/* ---- handles ---------------------------------------------------------------------------------------------------- */

static void keep(Fuzz *f, gicl_handle handle, Kind kind, int made_as, int vehicles, int lanes)
{
    int place = f->things;
    if (f->things < THINGS)
        ++f->things;
    else
        do
            place = below(f, THINGS);
        while (f->thing[place].open && !once_in(f, THINGS));
    if (f->thing[place].open)
        judge(f, "free", false, gicl_free(f->lib, f->thing[place].handle, f->said));
    f->thing[place] = (Thing){handle, kind, true, made_as, vehicles, lanes};
    if (f->shared) {
        pthread_mutex_lock(&f->shared->lock);
        f->shared->handle[f->shared->count++ % FOREIGN] = handle;
        pthread_mutex_unlock(&f->shared->lock);
    }
}

/* A handle for a call about such a thing; *wrong: it is closed, of another kind, or none at all. */
static Thing pick(Fuzz *f, Kind kind, int *wrong)
{
    Thing picked = {.kind = kind};
    int count = 0;
    *wrong = false;
    for (int i = 0; i < f->things; ++i)
        if (f->thing[i].open && f->thing[i].kind == kind && once_in(f, ++count))
            picked = f->thing[i];
    if (picked.open && !once_in(f, 10))
        return picked;
    const int way = below(f, 4);
    if (way < 2 && f->things)
        picked = f->thing[below(f, f->things)];
    else
        picked = (Thing){.handle = way == 2 || f->shared ? draw(f) : picked.handle + ((uint64_t)1 << below(f, 64))};
    for (int i = 0; i < f->things; ++i)
        if (f->thing[i].open && f->thing[i].handle == picked.handle)
            picked = f->thing[i];
    *wrong = !picked.open || picked.kind != kind;
    return picked;
}

/* The first number of vehicle v; others follow at `lanes` places each. */
static double *view(Fuzz *f, const Thing *thing, int v, int kind, int *count)
{
    double *data;
    size_t stride = 0;
    const int status = thing->kind == BATCH
                           ? gicl_batch_view(f->lib, thing->handle, kind, &data, count, &stride, f->said)
                           : gicl_view(f->lib, thing->handle, kind, &data, count, f->said);
    judge(f, "view", false, status);
    return status == GICL_OK ? data + stride * (size_t)(v / thing->lanes) + v % thing->lanes : NULL;
}

typedef struct Look {
    int count, lanes;
    double *at, number[NUMBERS];
} Look;

static Look look(Fuzz *f, const Thing *thing, int v, int kind)
{
    Look l = {.lanes = thing->lanes};
    l.at = view(f, thing, v, kind, &l.count);
    if (l.count > NUMBERS)
        found(f, "view", 0, "more numbers than this program has room for");
    for (int i = 0; l.at && i < l.count; ++i)
        l.number[i] = l.at[i * l.lanes];
    return l;
}

static void check_same(const Fuzz *f, const char *call, int status, const Look *before)
{
    for (int i = 0; before->at && i < before->count; ++i)
        if (memcmp(&before->at[i * before->lanes], &before->number[i], sizeof(double)) != 0)
            found(f, call, status, "the state has changed");
}

static void check_finite(const Fuzz *f, const char *call, const double *number, int count, int lanes)
{
    for (int i = 0; number && i < count; ++i)
        if (!isfinite(number[i * lanes]))
            found(f, call, 0, "a number is not finite");
}

/* ---- calls ------------------------------------------------------------------------------------------------------ */

static const char *const engines[] = {"tcc", "tape", NULL};

/* A word of the command line apart: *scene: NULL: it names none. */
static const char *model_path(const Fuzz *f, int m, char path[], const char **scene)
{
    strcpy(path, f->model[m]);
    char *equals = strchr(path, '=');
    if (equals)
        *equals = 0;
    *scene = equals ? equals + 1 : NULL;
    return path;
}

static void open_model(Fuzz *f)
{
    char path[1000];
    const char *scene;
    const int m = below(f, f->models), e = below(f, 3);
    gicl_options options = {.size = sizeof options, .engine = engines[e], .general = once_in(f, 3)};
    const char *given = model_path(f, m, path, &scene);
    gicl_handle handle = 7;
    int wrong = false;
    switch (below(f, 12)) {
    case 0: options.size += (size_t)odd_count(f) | 1, wrong = true; break;
    case 1: options.engine = "fortran", wrong = MAY; break;
    case 2: options.tolerance = odd_number(f), wrong = MAY; break;
    case 3: options.integrator = "euler", wrong = MAY; break;
    case 4: options.solve = "", options.recovery = "auto"; break;
    case 5: given = NULL, wrong = true; break;
    case 6: given = once_in(f, 2) ? "/" : "no.veh"; break;
    case 7: given = "-", wrong = true; break;
    default: break;
    }
    const int status = judge(f, "model_open", wrong, gicl_model_open(f->lib, given, &options, &handle, f->said));
    if (status == GICL_OK)
        keep(f, handle, MODEL, 3 * m + e, 0, 1);
    else if (handle)
        found(f, "model_open", status, "a handle of nothing");
}

static void open_text(Fuzz *f)
{
    static const char sound[] =
        "gicgen: 1\nmodel: top\nbase: ground\ngravity: [0, 0, -9.81]\nbodies:\n  b: {mass: 1, com: "
        "[0, 0, 1], inertia: [1, 1, 1]}\njoints:\n  j: {type: revolute, bodies: [ground, b], point: "
        "[0, 0, 0], axis: [0, 1, 0]}\ncoordinates:\n  a: {type: rotation, joint: j}\n";
    char text[sizeof sound];
    size_t size = sizeof sound - 1;
    gicl_handle handle = 7;
    memcpy(text, sound, sizeof sound);
    for (int changes = below(f, 4); changes > 0; --changes)
        text[below(f, (int)size)] = (char)below(f, 256);
    if (once_in(f, 4))
        size = (size_t)below(f, (int)size);
    const char *name = once_in(f, 10) ? NULL : "top.veh", *given = once_in(f, 10) ? NULL : text;
    const int status =
        judge(f, "model_text", !name || !given, gicl_model_text(f->lib, name, given, size, NULL, &handle, f->said));
    if (status == GICL_OK)
        keep(f, handle, MODEL, -1, 0, 1);
    else if (handle)
        found(f, "model_text", status, "a handle of nothing");
}

static void ask_names(Fuzz *f)
{
    int wrong, count = -1, kind = below(f, GICL_KINDS), index = -1;
    const Thing model = pick(f, MODEL, &wrong);
    const char *name = NULL, *unit = NULL, *again;
    if (once_in(f, 6)) {
        kind = odd_count(f);
        wrong |= kind < 0 || kind >= GICL_KINDS;
    }
    int status = judge(f, "count", wrong, gicl_count(f->lib, model.handle, kind, &count, f->said));
    if (status != GICL_OK)
        return;
    judge(f, "count", true, gicl_count(f->lib, model.handle, kind, NULL, f->said));
    for (int i = 0; i < count; ++i)
        if (judge(f, "signal", false, gicl_signal(f->lib, model.handle, kind, i, &name, &unit, f->said)) == GICL_OK &&
            (judge(f, "find", false, gicl_find(f->lib, model.handle, kind, name, &index, f->said)) != GICL_OK ||
             (index != i &&
              (gicl_signal(f->lib, model.handle, kind, index, &again, NULL, f->said), strcmp(again, name)))))
            found(f, "find", 0, "a name is not found at its place");
    const int odd = odd_count(f);
    judge(f, "signal", odd < 0 || odd >= count, gicl_signal(f->lib, model.handle, kind, odd, NULL, NULL, f->said));
    judge(f, "find", true, gicl_find(f->lib, model.handle, kind, "no such name", &index, f->said));
    judge(f, "find", true, gicl_find(f->lib, model.handle, kind, NULL, &index, f->said));
}

static void generate_code(Fuzz *f)
{
    int wrong;
    const Thing model = pick(f, MODEL, &wrong);
    const char *c = NULL, *h = NULL;
    const bool none = once_in(f, 4);
    if (judge(f, "generate", wrong || none, gicl_generate(f->lib, model.handle, &c, none ? NULL : &h, f->said)) ==
            GICL_OK &&
        (!strlen(c) || !strlen(h)))
        found(f, "generate", 0, "no code");
}

static void make_vehicles(Fuzz *f)
{
    int wrong, vehicles = 1 + below(f, VEHICLES);
    char path[1000];
    const char *scene = NULL;
    const bool batch = once_in(f, 2);
    const Thing model = pick(f, MODEL, &wrong);
    gicl_handle handle = 7;
    if (once_in(f, 2))
        model_path(f, model.open && model.made_as >= 0 && !once_in(f, 4) ? model.made_as / 3 : below(f, f->models),
                   path, &scene);
    else if (once_in(f, 8))
        scene = once_in(f, 2) ? "/" : "no.scene";
    if (batch && once_in(f, 6)) {
        do
            vehicles = odd_count(f);
        while (vehicles > 1000 && vehicles <= 1 << 24); /* 16 million are allowed, and take long */
        wrong |= vehicles < 1 || vehicles > 1000;
    }
    int lanes = 1;
    if (batch && vehicles == 3) /* one number of vehicles, for code is compiled for it */
        wrong |= (lanes = once_in(f, 4) ? odd_count(f) : 2) < 1 || lanes > 2;
    const bool none = once_in(f, 10);
    gicl_handle *place = none ? NULL : &handle;
    const int status = judge(f, "new", wrong || none,
                             batch ? gicl_batch_new(f->lib, model.handle, scene, vehicles, lanes, place, f->said)
                                   : gicl_instance_new(f->lib, model.handle, scene, place, f->said));
    if (status == GICL_OK)
        keep(f, handle, batch ? BATCH : INSTANCE, model.made_as, batch ? vehicles : 1, lanes);
    else if (!none && handle)
        found(f, "new", status, "a handle of nothing");
}

static void write_numbers(Fuzz *f)
{
    int wrong;
    const Thing thing = pick(f, once_in(f, 2) ? INSTANCE : BATCH, &wrong);
    if (wrong || (thing.kind != INSTANCE && thing.kind != BATCH))
        return;
    const int v = below(f, thing.vehicles);
    int count = 0;
    double *data = view(f, &thing, v, below(f, GICL_KINDS), &count);
    if (data && count > 0) {
        double *number = &data[below(f, count) * thing.lanes];
        *number = once_in(f, 3) ? odd_number(f) : *number * (1 + 1e-3 * (below(f, 100) - 50));
    }
}

static void write_restart(Fuzz *f)
{
    int wrong;
    const Thing one = pick(f, INSTANCE, &wrong);
    const double time = once_in(f, 2) ? odd_number(f) : 1e-3 * below(f, 10000);
    double now = 7;
    if (judge(f, "restart", wrong || !isfinite(time), gicl_restart(f->lib, one.handle, time, f->said)) == GICL_OK &&
        judge(f, "time", false, gicl_time(f->lib, one.handle, &now, f->said)) == GICL_OK && now != time)
        found(f, "restart", 0, "another time");
    judge(f, "time", true, gicl_time(f->lib, one.handle, NULL, f->said));
}

static void set_up(Fuzz *f)
{
    int wrong, parameters = 0;
    double parameter[NUMBERS];
    const Thing one = pick(f, INSTANCE, &wrong);
    if (wrong) {
        judge(f, "set_up", true, gicl_set_up(f->lib, one.handle, NULL, 0, f->said));
        return;
    }
    const Look own = look(f, &one, 0, GICL_PARAMETER), state = look(f, &one, 0, GICL_STATE);
    parameters = own.count;
    memcpy(parameter, own.number, sizeof parameter);
    for (int i = 0; i < parameters; ++i)
        if (once_in(f, 4))
            parameter[i] = once_in(f, 4) ? odd_number(f) : parameter[i] * (1 + 1e-2 * below(f, 10));
    const int count = once_in(f, 4) ? odd_count(f) : parameters;
    const double *given = once_in(f, 5) ? NULL : once_in(f, 5) ? own.at : parameter;
    const int status =
        judge(f, "set_up", count != (given ? parameters : 0), gicl_set_up(f->lib, one.handle, given, count, f->said));
    if (status != GICL_OK) {
        check_same(f, "set_up", status, &own);
        check_same(f, "set_up", status, &state);
    }
}

typedef struct Steps {
    double step;
    int method, ratio;
    int64_t steps;
} Steps;

static Steps draw_steps(Fuzz *f)
{
    Steps s = {1e-4 * (1 + below(f, 50)), below(f, 2), 1, below(f, 20)};
    if (once_in(f, 4))
        s.method = odd_count(f);
    if (once_in(f, 4))
        s.ratio = once_in(f, 2) ? odd_count(f) : 2 + below(f, 5);
    if (once_in(f, 8))
        s.step = odd_number(f);
    if (once_in(f, 10))
        s.steps = s.step > 0 ? -1 : INT64_MAX; /* who asks for many gets them */
    if (once_in(f, 20))
        s.steps = INT64_MIN;
    return s;
}

enum { FIRST_IMPLICIT = 2, LAST_IMPLICIT = 4 }; /* methods ros2 to imex, which only some models have */

/* Whether a call with these steps is wrong, or MAY. */
static int wrong_steps(const Steps *s)
{
    if (s->steps < 0)
        return true;
    return s->method >= FIRST_IMPLICIT && s->method <= LAST_IMPLICIT ? MAY : false;
}

static void step(Fuzz *f)
{
    int wrong;
    const Thing one = pick(f, INSTANCE, &wrong);
    const Steps s = draw_steps(f);
    const Look before = wrong ? (Look){0} : look(f, &one, 0, GICL_STATE);
    const int64_t steps = s.steps > 0 && s.steps < 100 ? 1 : s.steps;
    int status = judge(f, "step", wrong ? wrong : wrong_steps(&s),
                       gicl_step(f->lib, one.handle, s.step, s.method, s.ratio, steps, f->said));
    if (status != GICL_OK) {
        check_same(f, "step", status, &before);
        return;
    }
    check_finite(f, "step", before.at, steps ? before.count : 0, 1);
    status = judge(f, "step", false, gicl_step(f->lib, one.handle, s.step, s.method, s.ratio, s.steps, f->said));
    if (status == GICL_OK && steps)
        check_finite(f, "step", before.at, before.count, 1);
}

static void step_batch(Fuzz *f)
{
    int wrong;
    int32_t each[VEHICLES + 1000], first = 0;
    uint8_t which[VEHICLES + 1000];
    const Thing many = pick(f, BATCH, &wrong);
    const Steps s = draw_steps(f);
    if (wrong) {
        judge(f, "batch_step", true, gicl_batch_step(f->lib, many.handle, s.step, s.method, s.ratio, 1, each, f->said));
        judge(f, "batch_reset", true, gicl_batch_reset(f->lib, many.handle, NULL, f->said));
        judge(f, "batch_restart", true, gicl_batch_restart(f->lib, many.handle, NULL, f->said));
        judge(f, "batch_outputs", true, gicl_batch_outputs(f->lib, many.handle, each, f->said));
        return;
    }
    const int v = below(f, many.vehicles);
    const Look before = look(f, &many, v, GICL_STATE);
    for (int i = 0; i < many.vehicles; ++i) {
        which[i] = (uint8_t)(once_in(f, 2) ? below(f, 256) : 0);
        each[i] = INT32_MAX;
    }
    int status;
    switch (below(f, 6)) {
    case 0:
        status = judge(f, "batch_reset", false, gicl_batch_reset(f->lib, many.handle, which, f->said));
        if (!which[v])
            check_same(f, "batch_reset", status, &before);
        return;
    case 1:
        judge(f, "batch_restart", false,
              gicl_batch_restart(f->lib, many.handle, once_in(f, 2) ? which : NULL, f->said));
        return;
    case 2:
        status = judge(f, "batch_outputs", false, gicl_batch_outputs(f->lib, many.handle, each, f->said));
        check_same(f, "batch_outputs", status, &before);
        break;
    default:
        status = judge(f, "batch_step", wrong_steps(&s),
                       gicl_batch_step(f->lib, many.handle, s.step, s.method, s.ratio,
                                       s.steps > 0 && s.steps < 100 ? 1 : s.steps, each, f->said));
        if (status == GICL_WRONG)
            return;
        if (each[v] != 0)
            check_same(f, "batch_step", status, &before);
        else if (s.steps)
            check_finite(f, "batch_step", before.at, before.count, before.lanes);
    }
    for (int i = many.vehicles - 1; i >= 0 && status != GICL_WRONG; --i)
        first = each[i] ? each[i] : first;
    if (status != GICL_WRONG && first != status)
        found(f, "batch", status, "the statuses of the vehicles are others");
}

static void evaluate(Fuzz *f)
{
    int wrong, n;
    double state[NUMBERS], rate[NUMBERS], again[NUMBERS];
    const Thing one = pick(f, INSTANCE, &wrong);
    const Look own = wrong ? (Look){0} : look(f, &one, 0, GICL_STATE);
    n = own.count;
    memcpy(state, own.number, sizeof state);
    if (n && once_in(f, 3))
        state[below(f, n)] = odd_number(f);
    const double time = once_in(f, 4) ? odd_number(f) : 0.5;
    const int count = once_in(f, 6) ? odd_count(f) : n;
    int status = judge(f, "rhs", wrong || count != n || !own.at,
                       gicl_rhs(f->lib, one.handle, time, state, rate, count, f->said));
    check_same(f, "rhs", status, &own);
    if (status == GICL_OK)
        check_finite(f, "rhs", rate, n, 1);
    judge(f, "rhs", true, gicl_rhs(f->lib, one.handle, time, NULL, rate, n, f->said));
    if (wrong || !own.at)
        return;
    /* from the instance's own state, and into one place */
    if (judge(f, "rhs", false, gicl_rhs(f->lib, one.handle, 0, own.at, rate, n, f->said)) == GICL_OK) {
        memcpy(again, own.number, sizeof again);
        if (judge(f, "rhs", false, gicl_rhs(f->lib, one.handle, 0, again, again, n, f->said)) != GICL_OK)
            found(f, "rhs", 0, "a state is refused that was good");
        check_finite(f, "rhs", again, n, 1);
        for (int i = 0; i < n; ++i)
            if (fabs(again[i] - rate[i]) > 1e-6 * (1 + fabs(rate[i])))
                found(f, "rhs", 0, "another rate where state and rate are one array");
    }
    status = judge(f, "outputs", false, gicl_outputs(f->lib, one.handle, f->said));
    check_same(f, "outputs", status, &own);
    if (status == GICL_OK) {
        const Look outputs = look(f, &one, 0, GICL_OUTPUT);
        check_finite(f, "outputs", outputs.at, outputs.count, 1);
    }
}

static void snapshot(Fuzz *f)
{
    int wrong;
    const Thing one = pick(f, INSTANCE, &wrong);
    size_t size = 0;
    judge(f, "snapshot_size", wrong, gicl_snapshot_size(f->lib, one.handle, &size, f->said));
    judge(f, "snapshot_size", true, gicl_snapshot_size(f->lib, one.handle, NULL, f->said));
    if (once_in(f, 2) || wrong) {
        const bool same = !wrong && f->snapshot && f->snapshot_of == one.made_as && one.made_as >= 0;
        const size_t given = once_in(f, 4) ? (size_t)odd_count(f) : f->snapshot_size;
        const bool usable = given == f->snapshot_size;
        const size_t at = f->snapshot_size ? (size_t)draw(f) % f->snapshot_size : 0;
        const char change = (char)(f->snapshot && usable && once_in(f, 3) ? 1 + below(f, 255) : 0);
        if (f->snapshot)
            f->snapshot[at] = (char)(f->snapshot[at] ^ change);
        /* an instance of a text, or of the other word for an engine, may or may not be of that model */
        const Look before = wrong ? (Look){0} : look(f, &one, 0, GICL_STATE);
        const int bad = wrong || !f->snapshot || change || (!usable && given != size) ? 1 : same && usable ? 0 : MAY;
        if (usable || given != size) {
            const int status = judge(f, "restore", bad, gicl_restore(f->lib, one.handle, f->snapshot, given, f->said));
            if (status != GICL_OK)
                check_same(f, "restore", status, &before);
        }
        if (f->snapshot)
            f->snapshot[at] = (char)(f->snapshot[at] ^ change);
        return;
    }
    char *bytes = malloc(size + 1);
    judge(f, "snapshot", size != size / 2, gicl_snapshot(f->lib, one.handle, bytes, size / 2, f->said));
    judge(f, "snapshot", true, gicl_snapshot(f->lib, one.handle, NULL, size, f->said));
    if (judge(f, "snapshot", false, gicl_snapshot(f->lib, one.handle, bytes, size, f->said)) == GICL_OK) {
        free(f->snapshot);
        f->snapshot = bytes;
        f->snapshot_size = size;
        f->snapshot_of = one.made_as;
    } else
        free(bytes);
}

static void analyse(Fuzz *f)
{
    int wrong;
    char path[1000];
    const char *scene = NULL;
    const Thing model = pick(f, MODEL, &wrong);
    gicl_handle handle = 7;
    if (!once_in(f, 4))
        model_path(f, model.open && model.made_as >= 0 ? model.made_as / 3 : below(f, f->models), path, &scene);
    const bool none = once_in(f, 10);
    gicl_handle *place = none ? NULL : &handle;
    const double at = once_in(f, 2) ? NAN : once_in(f, 2) ? odd_number(f) : 0.01;
    int status;
    switch (below(f, 4)) {
    case 0:
        status = judge(f, "run", wrong || none || !scene, gicl_run(f->lib, model.handle, scene, place, f->said));
        break;
    case 1:
        status = judge(f, "equilibrium", wrong || none, gicl_equilibrium(f->lib, model.handle, scene, place, f->said));
        break;
    case 2: status = judge(f, "modes", wrong || none, gicl_modes(f->lib, model.handle, scene, place, f->said)); break;
    default:
        status = judge(f, "linearize", wrong || none || (!isnan(at) && (!scene || !(at >= 0) || isinf(at))),
                       gicl_linearize(f->lib, model.handle, scene, at, place, f->said));
    }
    if (none)
        return;
    if (handle)
        keep(f, handle, RESULT, 0, 0, 1);
    else if (status == GICL_OK)
        found(f, "analyse", status, "no result");
}

static void read_result(Fuzz *f)
{
    int wrong, arrays = 0;
    gicl_array a;
    const Thing result = pick(f, RESULT, &wrong);
    judge(f, "array_count", true, gicl_array_count(f->lib, result.handle, NULL, f->said));
    if (judge(f, "array_count", wrong, gicl_array_count(f->lib, result.handle, &arrays, f->said)) != GICL_OK)
        return;
    const int odd = odd_count(f);
    judge(f, "array_get", odd < 0 || odd >= arrays, gicl_array_get(f->lib, result.handle, odd, &a, sizeof a, f->said));
    judge(f, "array_get", true, gicl_array_get(f->lib, result.handle, 0, &a, sizeof a - 1, f->said));
    judge(f, "array_get", true, gicl_array_get(f->lib, result.handle, 0, NULL, sizeof a, f->said));
    for (int i = 0; i < arrays; ++i) {
        judge(f, "array_get", false, gicl_array_get(f->lib, result.handle, i, &a, sizeof a, f->said));
        size_t letters = strlen(a.name);
        for (int64_t r = 0; r < a.rows * a.columns; ++r)
            letters += isinf(a.data[r]) ? 1 : 0;
        for (int64_t r = 0; a.row_name && r < a.rows; ++r)
            letters += strlen(a.row_name[r]) + strlen(a.row_unit[r]);
        for (int k = 0; a.column_name && k < a.columns; ++k)
            letters += strlen(a.column_name[k]) + strlen(a.column_unit[k]);
        f->digest += letters;
    }
}

static void close_thing(Fuzz *f)
{
    if (!f->things)
        return;
    Thing *thing = &f->thing[below(f, f->things)];
    if (judge(f, "free", !thing->open, gicl_free(f->lib, thing->handle, f->said)) == GICL_OK)
        thing->open = false;
    judge(f, "free", true, gicl_free(f->lib, once_in(f, 2) ? 0 : draw(f) | (uint64_t)1 << 63, f->said));
}

static void without_library(Fuzz *f)
{
    gicl_handle handle;
    int count;
    judge(f, "NULL", true, gicl_model_open(NULL, f->model[0], NULL, &handle, f->said));
    judge(f, "NULL", true, gicl_instance_new(NULL, 1, NULL, &handle, f->said));
    judge(f, "NULL", true, gicl_count(NULL, 1, 0, &count, f->said));
    judge(f, "NULL", true, gicl_free(NULL, 1, f->said));
    judge(f, "NULL", true,
          gicl_close(NULL) == GICL_WRONG && f->said ? gicl_run(NULL, 1, "x", &handle, f->said) : GICL_WRONG);
}

/* With the handle of another thread, which may be at work, closed, or anything. */
static void call_foreign(Fuzz *f)
{
    if (!f->shared)
        return;
    double time;
    int count;
    pthread_mutex_lock(&f->shared->lock);
    const gicl_handle handle =
        f->shared->count ? f->shared->handle[below(f, f->shared->count < FOREIGN ? f->shared->count : FOREIGN)] : 0;
    pthread_mutex_unlock(&f->shared->lock);
    judge(f, "foreign", MAY, gicl_time(f->lib, handle, &time, f->said));
    judge(f, "foreign", MAY, gicl_outputs(f->lib, handle, f->said));
    judge(f, "foreign", MAY, gicl_count(f->lib, handle, GICL_STATE, &count, f->said));
    judge(f, "foreign", MAY, gicl_batch_outputs(f->lib, handle, NULL, f->said));
    judge(f, "foreign", MAY, gicl_array_count(f->lib, handle, &count, f->said));
}

static void *calls(void *given)
{
    static void (*const call[])(Fuzz *) = {make_vehicles, make_vehicles, step,        step,        step,
                                           step_batch,    step_batch,    step_batch,  evaluate,    write_numbers,
                                           snapshot,      snapshot,      set_up,      set_up,      ask_names,
                                           read_result,   write_restart, close_thing, close_thing, call_foreign};
    static void (*const costly[])(Fuzz *) = {open_model, open_model, open_text,      generate_code,
                                             analyse,    analyse,    without_library};
    Fuzz *f = given;
    const long most = f->tried;
    f->tried = 0;
    while (f->tried < most) {
        f->said = once_in(f, 10) ? NULL : f->list;
        if (open_count(f, MODEL) < 2)
            open_model(f);
        else if (open_count(f, INSTANCE) + open_count(f, BATCH) < 4)
            make_vehicles(f);
        else if (once_in(f, 40))
            costly[below(f, sizeof costly / sizeof *costly)](f);
        else
            call[below(f, sizeof call / sizeof *call)](f);
    }
    free(f->snapshot);
    f->snapshot = NULL;
    return NULL;
}

static void sequence(Fuzz *f, unsigned seed, int threads, long most)
{
    enum { THREADS = 16 };
    static Fuzz each[THREADS];
    pthread_t id[THREADS];
    Shared shared = {.lock = PTHREAD_MUTEX_INITIALIZER};
    gicl_library *lib = gicl_open();
    for (int t = 0; t < threads; ++t) {
        each[t] = (Fuzz){.lib = lib, .list = gicl_messages_new(), .shared = threads > 1 ? &shared : NULL, .seed = seed};
        each[t].random = ((uint64_t)seed * THREADS + (uint64_t)t + 1) * 0x9e3779b97f4a7c15u | 1;
        each[t].models = f->models;
        each[t].model = f->model;
        each[t].tried = most;
        for (int i = 0; i < 20; ++i)
            draw(&each[t]);
    }
    for (int t = 1; t < threads; ++t)
        if (pthread_create(&id[t], NULL, calls, &each[t]))
            exit(2);
    calls(&each[0]);
    for (int t = 0; t < threads; ++t) {
        if (t > 0)
            pthread_join(id[t], NULL);
        f->tried += each[t].tried;
        f->good += each[t].good;
        f->refused += each[t].refused;
        f->wrong += each[t].wrong;
        f->digest = (f->digest ^ each[t].digest) * 0x100000001b3u;
        gicl_messages_free(each[t].list);
    }
    gicl_close(lib);
}

int main(int count, char **word)
{
    if (count < 6)
        return 2;
    const unsigned first = (unsigned)strtoul(word[1], NULL, 10), last = (unsigned)strtoul(word[2], NULL, 10);
    const long most = strtol(word[3], NULL, 10);
    const int threads = (int)strtol(word[4], NULL, 10);
    Fuzz all = {.models = count - 5, .model = word + 5};
    for (unsigned seed = first; seed <= last; ++seed)
        sequence(&all, seed, threads, most);
    printf("library_calls | seeds %u to %u, %d threads | %ld | %ld | %ld | %ld wrong calls refused | ok: %016llx\n",
           first, last, threads, all.tried, all.good, all.refused, all.wrong, (unsigned long long)all.digest);
    return 0;
}
