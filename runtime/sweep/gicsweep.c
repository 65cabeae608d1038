/* SPDX-License-Identifier: MIT
 * gicsweep: one scene over many values of parameters, inputs and initial states. This file: the command line. */
#include "base/file.h"
#include "base/message.h"
#include "base/version.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "engine/object_cache.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] = "usage: gicsweep MODEL.veh SCENE --vary NAME=LOW:HIGH:COUNT ... [-o results.csv]\n"
                           "       gicsweep MODEL.veh SCENE --latin COUNT --vary NAME=LOW:HIGH ... [-o results.csv]\n"
                           "\n"
                           "Runs a scene with all combinations of values, or with COUNT combinations of a Latin\n"
                           "hypercube, several vehicles at once. A row of the results for each run: the varied\n"
                           "values, the status (0: good, else the run ended at `time`, or was found unstable then),\n"
                           "of each output of the scene the value at the end, the least and the greatest at output\n"
                           "times.\n"
                           "\n"
                           "      --vary NAME=LOW:HIGH:COUNT\n"
                           "                     a tunable parameter, an input (constant through the run), a number\n"
                           "                     of the initial state, or `speed`, along the vehicle; where a name\n"
                           "                     has several meanings parameter/NAME, input/NAME, state/NAME. In a\n"
                           "                     grid the last one varies fastest\n"
                           "      --latin COUNT  so many runs: each number takes each of COUNT parts of its range\n"
                           "                     once, in random order\n"
                           "      --seed NUMBER  of the random numbers; the same seed, the same runs; default: 1\n"
                           "  -o, --output FILE  results as CSV; default: sweep.csv. Finished runs are kept in\n"
                           "                     FILE.journal: the same command goes on where it was stopped\n"
                           "      --engine NAME  each run by itself, by an engine of gicrun\n"
                           "      --cc COMMAND   C compiler, perhaps with options; default: $CC or cc\n"
                           "      --cflags FLAGS more options for it, after ours, in one word\n"
                           "  -q, --quiet        neither progress nor summary\n"
                           "  -h, --help         this text\n"
                           "      --version      version\n"
                           "\n"
                           "Vehicles run in the lanes of vectors where compiler and model allow that, else each by\n"
                           "itself, with the same digits; and in $OMP_NUM_THREADS processes, by default one for each\n"
                           "processor.\n"
                           "Exit status: 0 good, even if runs failed; 1 error in a file; 2 wrong usage.\n";

enum { VEHICLES = 64, LANES = 4 };

typedef struct Options {
    const char *model, *scene, *results, *engine; /* engine NULL: lanes */
    EngineOptions code;
    SweepPlan plan;
    bool quiet;
} Options;

/* For reading the command line. */
typedef struct Reading {
    Pool *pool;
    Options o;
} Reading;

static void read_vary(void *reading, char *word)
{
    vary_read(((Reading *)reading)->pool, &((Reading *)reading)->o.plan, word);
}

static void read_latin(void *reading, char *word)
{
    ((Reading *)reading)->o.plan.latin =
        usage_whole("gicsweep", "--latin takes 1 to 10000000 runs, not", word, 1, SWEEP_RUNS_MOST);
}

static void read_seed(void *reading, char *word)
{
    ((Reading *)reading)->o.plan.seed =
        (uint64_t)usage_whole("gicsweep", "--seed takes a whole number from 0 on, not", word, 0, INT64_MAX);
}

static void read_engine(void *reading, char *word)
{
    if (!engine_known(word))
        usage_fail("gicsweep", "there is no engine", word);
    ((Reading *)reading)->o.engine = word;
}

static Options read_command_line(Pool *pool, int count, char **word)
{
    Reading reading = {pool,
                       {.results = "sweep.csv", .plan.seed = 1, .code = {.compiler = compiler_default(), .flags = ""}}};
    Options *o = &reading.o;
    const Option option[] = {
        {"vary", .read = read_vary},          {"latin", .read = read_latin},   {"seed", .read = read_seed},
        {"output", 'o', .text = &o->results}, {"engine", .read = read_engine}, {"cc", .text = &o->code.compiler},
        {"cflags", .text = &o->code.flags},   {"quiet", 'q', .on = &o->quiet},
    };
    const int first =
        options_read("gicsweep", help, count, word, option, (int)(sizeof option / sizeof *option), &reading, NULL);
    o->code.quiet = o->quiet;
    if (count - first != 2)
        usage_fail("gicsweep", "one model and one scene, please", NULL);
    if (!o->plan.varied)
        usage_fail("gicsweep", "nothing is varied: --vary NAME=LOW:HIGH:COUNT", NULL);
    if (file_is_special(o->results) || !strcmp(o->results, "-"))
        usage_fail("gicsweep", "results go into a file, so that a stopped sweep can go on, not to", o->results);
    o->model = word[first];
    o->scene = word[first + 1];
    return *o;
}

/* Why lanes can't be used; NULL: they can. */
static const char *against_lanes(const Scene *scene, const Model *model)
{
    if (scene->method > GIC_RK4)
        return "steps of a scene with variable ones are each run's own";
    if (scene->driver)
        return "a driver drives one vehicle";
    if (scene->ratio > 1 && model->fast_states)
        return "they know no fast steps yet";
    if (scene->locate)
        return "they go over contacts";
    return NULL;
}

/* Code for many vehicles, or for one. */
static const Engine *open_code(Pool *pool, const Options *o, const Model *model, const Scene *scene,
                               const gic_batch_model **many)
{
    const Batch batch = {VEHICLES, LANES};
    const Engine *engine = NULL;
    const char *why = against_lanes(scene, model);
    if (o->engine)
        return engine_open(pool, o->engine, model, &o->code);
    const bool tried = !why;
    if (tried)
        engine = engine_batch(pool, model, &o->code, &batch, "-O3 -march=native", many, &why);
    if (engine)
        return engine;
    if (!o->quiet)
        fprintf(stderr, "gicsweep: note: each run by itself instead of lanes: %s\n", why);
    return engine_open(pool, *many || !tried ? "cc" : "tcc", model, &o->code);
}

/* A hash of this program. */
static uint64_t program_hash(Pool *pool)
{
    static const char self[] = "/proc/self/exe"; /* elsewhere the version has to do */
    size_t size = 0;
    const char *bytes = access(self, R_OK) ? "" : file_read(pool, self, TABLE_MOST, &size);
    return text_hash(bytes, size);
}

/* A key of all that determines the results: the program, model and scene with all files that they name, the varied
 * numbers, and how code is compiled. */
static const char *sweep_key(Pool *pool, const Sweep *sweep, const EngineOptions *code)
{
    Text text = {.pool = pool};
    const SweepPlan *plan = sweep->plan;
    text_print(&text, "%s %016llx %016llx %016llx %s %d %lld %llu", GICGEN_VERSION,
               (unsigned long long)program_hash(pool), (unsigned long long)source_hash(sweep->model->source),
               (unsigned long long)source_hash(sweep->scene->source), sweep->engine->name, sweep->many != NULL,
               (long long)plan->latin, (unsigned long long)plan->seed);
    for (int v = 0; v < plan->varied; ++v)
        text_print(&text, " %s=%.17g:%.17g:%lld", plan->vary[v].name, plan->vary[v].low, plan->vary[v].high,
                   (long long)plan->vary[v].count);
    int words;
    const char **word = compiler_words(pool, code->compiler, build_flags, code->flags, &words);
    for (int i = 0; i < words; ++i)
        text_print(&text, " %s", word[i]);
    return cache_key(pool, (const char *const[]){text.s, compiler_identity(pool, word, words), NULL});
}

/* The unit of a varied number. */
static const char *unit_of(const Sweep *sweep, const Vary *vary)
{
    switch (vary->kind) {
    case VARY_PARAMETER: return sweep->engine->code->parameter[vary->index].unit;
    case VARY_INPUT: return sweep->engine->code->input[vary->index].unit;
    case VARY_STATE: return sweep->engine->standard[vary->index].unit;
    default: return "m/s";
    }
}

static void write_results(const Sweep *sweep, const char *path)
{
    static const char *const part[] = {"end", "min", "max"};
    Pool *pool = sweep->pool;
    Csv csv = csv_open(pool, path);
    csv_name(&csv, "run", NULL);
    for (int v = 0; v < sweep->plan->varied; ++v)
        csv_name(&csv, sweep->plan->vary[v].name, unit_of(sweep, &sweep->plan->vary[v]));
    csv_name(&csv, "status", NULL);
    csv_name(&csv, "time", "s");
    for (int c = 0; c < sweep->scene->columns; ++c) {
        const gic_signal *signal = &sweep->scene->signal[sweep->scene->column[c]];
        for (int p = 0; p < 3; ++p)
            csv_name(&csv, pool_print(pool, "%s.%s", signal->name, part[p]), signal->unit);
    }
    csv_end_row(&csv);
    for (int64_t r = 0; r < sweep->plan->runs; ++r) {
        fputs(sweep->journal->row[r], csv.file);
        csv_end_row(&csv);
    }
    csv_close(&csv);
}

/* begun: when the program began, which reads and compiles first; start: when the runs did. */
static void summary(const Sweep *sweep, int64_t before, double begun, double start, const char *results)
{
    const double end = clock_seconds(CLOCK_MONOTONIC);
    const Journal *journal = sweep->journal;
    const int64_t done = journal->finished - before;
    fprintf(stderr, "%s: %lld runs in %s", sweep->engine->code->name, (long long)journal->finished, results);
    if (before)
        fprintf(stderr, ", %lld of them from an earlier start", (long long)before);
    fprintf(stderr, "; %s", sweep->many ? "in lanes" : "each by itself");
    if (sweep->processes > 1)
        fprintf(stderr, ", up to %d processes", sweep->processes);
    fprintf(stderr, ", %.3g s: %.3g s to read and compile, %.3g s of runs, %.4g runs/s\n", end - begun, start - begun,
            end - start, (double)done / fmax(end - start, 1e-9));
    if (journal->failed)
        fprintf(stderr, "  %lld failed, the first is run %lld: %s\n", (long long)journal->failed,
                (long long)journal->first_failed,
                journal->first_reason ? journal->first_reason : gic_status_text(journal->first_status));
}

int main(int count, char **word)
{
    const double begun = clock_seconds(CLOCK_MONOTONIC);
    Pool *pool = pool_new();
    Options o = read_command_line(pool, count, word);
    const Model *model = model_read(pool, o.model);
    const Scene *scene = scene_read(pool, o.scene, model, NULL, 0);
    const char *const journal_path = pool_print(pool, "%s.journal", o.results);
    for (int i = 0; i < 2; ++i) {
        source_keep(model->source, i ? journal_path : o.results);
        source_keep(scene->source, i ? journal_path : o.results);
    }
    scene_no_rig(scene);
    scene = equilibrium_start(pool, model, scene, o.code.solve);
    Sweep sweep = {.pool = pool,
                   .model = model,
                   .scene = scene,
                   .plan = &o.plan,
                   .quiet = o.quiet,
                   .processes = share_processes()};
    sweep.engine = open_code(pool, &o, model, scene, &sweep.many);
    plan_close(pool, &o.plan, model, sweep.engine);

    interrupt_hold();
    Journal journal = journal_open(pool, o.results, sweep_key(pool, &sweep, &o.code), o.plan.runs);
    const int64_t before = journal.finished;
    const double start = clock_seconds(CLOCK_MONOTONIC);
    sweep.journal = &journal;
    const bool complete = sweep_run(&sweep);
    if (!complete) {
        fprintf(stderr, "gicsweep: interrupted; %lld of %lld runs are kept in %s: the same command goes on\n",
                (long long)journal.finished, (long long)journal.runs, journal.path);
        interrupt_release();
        exit(1);
    }
    write_results(&sweep, o.results);
    journal_remove(&journal);
    interrupt_release();
    if (!o.quiet)
        summary(&sweep, before, begun, start, o.results);
    engine_close(sweep.engine);
    pool_free(pool);
    return 0;
}
