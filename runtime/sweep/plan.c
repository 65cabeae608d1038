/* SPDX-License-Identifier: MIT
 * The runs of a sweep: a grid, or a Latin hypercube. */
#include "base/catch.h"
#include "base/message.h"
#include "engine/engine.h"
#include "host/host.h"
#include "model/model.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_qrng.h>

/* A mistake in a word of the call. */
static _Noreturn void refuse(const char *message, const char *word)
{
    char how[200];
    snprintf(how, sizeof how, "`%s -h` shows how", program_place().source->path);
    diag_fail_call(program_place(), how, "%s '%s'", message, word);
}

void vary_read(Pool *pool, SweepPlan *plan, const char *word)
{
    static const char form[] = "--vary takes name=low:high or name=low:high:count, not";
    const char *equals = strchr(word, '=');
    Vary vary = {.name = pool_print(pool, "%.*s", (int)(equals ? equals - word : 0), word)};
    if (!equals || equals == word)
        refuse(form, word);
    char *end;
    vary.low = strtod(equals + 1, &end);
    if (end == equals + 1 || *end != ':')
        refuse(form, word);
    const char *next = end + 1;
    vary.high = strtod(next, &end);
    if (end == next || (*end && *end != ':') || !isfinite(vary.low) || !isfinite(vary.high))
        refuse(form, word);
    if (*end) {
        next = end + 1;
        vary.count = strtoll(next, &end, 10);
        if (end == next || *end || vary.count < 1 || vary.count > SWEEP_RUNS_MOST)
            refuse("a count must be a whole number from 1 to 10000000 in", word);
    }
    *POOL_PUSH(pool, plan->vary, plan->varied) = vary;
}

/* The input of a name; a driven coordinate has three, of which the first bears its name. */
static int input_of(const Model *model, const char *name)
{
    for (int i = 0; i < model->inputs; ++i)
        if (!strcmp(model->input[i].name, name) && !strchr(name, '.'))
            return i;
    return -1;
}

static int parameter_of(const Model *model, const char *name)
{
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable && !strcmp(model->parameter[i].name, name))
            return model->parameter[i].index;
    return -1;
}

static int state_of(const Engine *engine, const char *name)
{
    for (int i = 0; i < engine->standard_count; ++i)
        if (!strcmp(engine->standard[i].name, name))
            return i;
    return -1;
}

/* Warn if a varied initial value, or a varied input of a driven coordinate, leaves the coordinate's range. */
static void warn_range(const Vary *vary, const Model *model, const char *name)
{
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *own = &model->coordinate[i];
        if ((vary->kind == VARY_STATE && !strcmp(own->name, name)) ||
            (vary->kind == VARY_INPUT && own->driven && own->input == vary->index))
            scene_warn_range(own, program_place(), fmin(vary->low, vary->high), fmax(vary->low, vary->high));
    }
}

static void look_up(Pool *pool, Vary *vary, const Model *model, const Engine *engine)
{
    static const char *const kind[] = {"parameter/", "input/", "state/"};
    const char *slash = strchr(vary->name, '/'), *name = slash ? slash + 1 : vary->name;
    const int place[] = {parameter_of(model, name), input_of(model, name), state_of(engine, name)};
    int found = 0;
    if (!strcmp(vary->name, "speed") && model->free_base) {
        vary->kind = VARY_SPEED;
        return;
    }
    for (int k = 0; k < 3; ++k)
        if (place[k] >= 0 && (!slash || !strncmp(vary->name, kind[k], strlen(kind[k])))) {
            vary->kind = (VaryKind)k;
            vary->index = place[k];
            ++found;
        }
    if (found > 1)
        diag_fail(program_place(), "write parameter/NAME, input/NAME or state/NAME",
                  "'%s' is the name of more than one thing in this model", vary->name);
    if (!found)
        diag_fail(program_place(),
                  pool_print(pool,
                             "the parameter must be `tunable: true` in %s; inputs and states have the names in "
                             "the header that gicgen writes; `speed` is a vehicle's",
                             model->source->path),
                  "nothing that can be varied is called '%s'", vary->name);
    warn_range(vary, model, name);
}

/* The generator splitmix64: the same numbers on every machine. */
static uint64_t next_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double random_share(uint64_t *state)
{
    return (double)(next_random(state) >> 11) * 0x1p-53;
}

/* Each number takes each of its `latin` equal parts once, in an order of its own. Only the runs of this part of the
 * sweep are kept. */
static void make_latin(Pool *pool, SweepPlan *plan)
{
    const size_t numbers = (size_t)plan->varied * (size_t)plan->count + 1;
    Pool *scratch = pool_new();
    int32_t *place = pool_alloc(scratch, (size_t)plan->latin * sizeof *place);
    uint64_t state = plan->seed;
    plan->place = pool_alloc(pool, numbers * sizeof *plan->place);
    plan->share = pool_alloc(pool, numbers * sizeof *plan->share);
    for (int v = 0; v < plan->varied; ++v) {
        for (int64_t i = 0; i < plan->latin; ++i)
            place[i] = (int32_t)i;
        for (int64_t i = plan->latin - 1; i > 0; --i) {
            const int64_t other = (int64_t)(random_share(&state) * (double)(i + 1));
            const int32_t kept = place[i];
            place[i] = place[other];
            place[other] = kept;
        }
        for (int64_t i = 0; i < plan->latin; ++i) {
            const double share = random_share(&state);
            const int64_t at = i - plan->first;
            if (at < 0 || at >= plan->count)
                continue;
            plan->place[v * plan->count + at] = place[i];
            plan->share[v * plan->count + at] = share;
        }
    }
    pool_free(scratch);
}

/* Where a failure ends a call and not the program. */
static void free_sequence(void *sequence)
{
    gsl_qrng_free(sequence);
}

/* Points of Sobol's sequence, from its beginning, though only those of this part are kept. */
static void make_points(Pool *pool, SweepPlan *plan)
{
    const int each = plan->varied + 2, numbers = 2 * plan->varied;
    const int64_t first = plan->first / each, last = (plan->first + plan->count - 1) / each;
    gsl_qrng *sequence = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)numbers);
    if (!sequence)
        out_of_memory();
    caught_own(free_sequence, sequence);
    double unused[2 * SOBOL_MOST];
    plan->point = pool_alloc(pool, sizeof *plan->point * (size_t)((last - first + 1) * numbers));
    for (int64_t j = 0; j <= last; ++j)
        gsl_qrng_get(sequence, j < first ? unused : plan->point + (j - first) * numbers);
    caught_disown(sequence);
    gsl_qrng_free(sequence);
}

int64_t part_first(int64_t runs, int part, int parts)
{
    return runs / parts * (part - 1) + runs % parts * (part - 1) / parts;
}

void plan_close(Pool *pool, SweepPlan *plan, const Model *model, const Engine *engine)
{
    plan->runs = 1;
    for (int v = 0; v < plan->varied; ++v) {
        Vary *vary = &plan->vary[v];
        look_up(pool, vary, model, engine);
        for (int w = 0; w < v; ++w)
            if (plan->vary[w].kind == vary->kind && plan->vary[w].index == vary->index)
                refuse("--vary is given twice for", vary->name);
        if (plan->latin && vary->count)
            refuse("with --latin a range has no count of its own:", vary->name);
        if (plan->bases && vary->count)
            refuse("with --sobol a range has no count of its own:", vary->name);
        if (!plan->latin && !plan->bases && !vary->count)
            refuse("without --latin or --sobol a range needs a count, name=low:high:count:", vary->name);
        plan->runs *= vary->count ? vary->count : 1;
        if (plan->runs > SWEEP_RUNS_MOST)
            refuse("these are more than ten million runs; --latin takes fewer, not so many as", vary->name);
    }
    if (plan->latin)
        plan->runs = plan->latin;
    if (plan->bases && plan->varied > SOBOL_MOST)
        refuse("--sobol takes 20 numbers that vary at most, not so many as", plan->vary[plan->varied - 1].name);
    if (plan->bases)
        plan->runs = plan->bases * (plan->varied + 2);
    if (plan->runs > SWEEP_RUNS_MOST)
        refuse("these are more than ten million runs: --sobol takes so many times the varied numbers and two, not with",
               plan->vary[plan->varied - 1].name);
    plan->count = plan->runs;
    if (plan->parts > plan->runs)
        diag_fail_call(program_place(), "choose fewer", "%d parts are more than the %lld runs of this sweep",
                       plan->parts, (long long)plan->runs);
    if (plan->part) {
        plan->first = part_first(plan->runs, plan->part, plan->parts);
        plan->count = part_first(plan->runs, plan->part + 1, plan->parts) - plan->first;
    }
    if (plan->latin)
        make_latin(pool, plan);
    if (plan->bases)
        make_points(pool, plan);
}

double plan_value(const SweepPlan *plan, int varied, int64_t run)
{
    const Vary *vary = &plan->vary[varied];
    if (plan->latin) {
        const int64_t at = varied * plan->count + run - plan->first;
        const double share = ((double)plan->place[at] + plan->share[at]) / (double)plan->latin;
        return vary->low + share * (vary->high - vary->low);
    }
    if (plan->bases) {
        const int each = plan->varied + 2, which = (int)(run % each); /* A, B, or A with B's value of one number */
        const double *point = plan->point + (run / each - plan->first / each) * 2 * plan->varied;
        const double share = point[which == 1 || which == varied + 2 ? plan->varied + varied : varied];
        return vary->low + share * (vary->high - vary->low);
    }
    for (int v = plan->varied - 1; v > varied; --v)
        run /= plan->vary[v].count;
    const int64_t step = run % vary->count, last = vary->count - 1;
    return step == last && last ? vary->high
           : last               ? vary->low + (double)step / (double)last * (vary->high - vary->low)
                                : vary->low;
}
