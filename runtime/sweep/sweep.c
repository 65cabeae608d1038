/* SPDX-License-Identifier: MIT
 * A sweep from the plan to the file of results. */
#define _GNU_SOURCE /* dladdr */
#include "base/catch.h"
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
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

#include <dlfcn.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { VEHICLES = 64, LANES = 4 };

/* Why lanes can't be used; NULL: they can. */
static const char *against_lanes(const Scene *scene, const Model *model)
{
    if (scene->method > GIC_RK4)
        return "steps of a scene with variable ones are each run's own";
    if (scene->driver)
        return "a driver drives one vehicle";
    if (scene->ratio > 1 && model->fast_states)
        return "fast steps are made run by run";
    if (scene->locate)
        return "contacts within steps are looked for run by run";
    return NULL;
}

/* Code for many vehicles, or for one. */
static const Engine *open_code(Pool *pool, const SweepRequest *request, const Model *model, const Scene *scene,
                               const gic_batch_model **many)
{
    const Batch batch = {VEHICLES, LANES};
    const Engine *engine = NULL;
    const char *why = against_lanes(scene, model);
    if (request->engine)
        return engine_open(pool, request->engine, model, &request->code);
    const bool tried = !why;
    if (tried)
        engine = engine_batch(pool, model, &request->code, &batch, IN_LANES, many, &why);
    if (engine)
        return engine;
    if (!request->quiet)
        diag_note(
            pool_print(pool, "%s: note: each run by itself instead of lanes: %s\n", program_place().source->path, why));
    return engine_open(pool, *many || !tried ? "cc" : "tcc", model, &request->code);
}

static uint64_t file_hash(Pool *pool, const char *path)
{
    size_t size = 0;
    const char *bytes = access(path, R_OK) ? "" : file_read(pool, path, TABLE_MOST, &size);
    return text_hash(bytes, size);
}

/* A hash of this program, or of the library that we are in. */
static uint64_t program_hash(Pool *pool)
{
    static const char self[] = "/proc/self/exe"; /* elsewhere the version has to do */
    Dl_info is;
    const bool library = dladdr(self, &is) && is.dli_fname && strstr(is.dli_fname, ".so");
    return file_hash(pool, library ? is.dli_fname : self);
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
    for (int m = 0; m < sweep->metrics; ++m)
        text_print(&text, " %s", sweep->metric[m].word);
    int words;
    const char **word = compiler_words(pool, code->compiler, build_flags, code->flags, &words);
    for (int i = 0; i < words; ++i)
        text_print(&text, " %s", word[i]);
    return cache_key(pool, (const char *const[]){text.s, compiler_contents(pool, word, words), NULL});
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

/* Columns: the number of the run, the varied numbers, status and time, three of each output of the scene, metrics. */
static gic_signal *signals_of(const Sweep *sweep, int *count)
{
    static const char *const part[] = {"end", "min", "max"};
    enum { OTHERS = 3, PARTS = sizeof part / sizeof *part };
    Pool *pool = sweep->pool;
    const int varied = sweep->plan->varied;
    *count = OTHERS + varied + PARTS * sweep->scene->columns + sweep->metrics;
    gic_signal *signal = pool_alloc(pool, sizeof *signal * (size_t)*count), *next = signal;
    *next++ = (gic_signal){"run", NULL};
    for (int v = 0; v < varied; ++v)
        *next++ = (gic_signal){sweep->plan->vary[v].name, unit_of(sweep, &sweep->plan->vary[v])};
    *next++ = (gic_signal){"status", NULL};
    *next++ = (gic_signal){"time", "s"};
    for (int c = 0; c < sweep->scene->columns; ++c) {
        const gic_signal *of = &sweep->scene->signal[sweep->scene->column[c]];
        for (int p = 0; p < PARTS; ++p)
            *next++ = (gic_signal){pool_print(pool, "%s.%s", of->name, part[p]), of->unit};
    }
    for (int m = 0; m < sweep->metrics; ++m)
        *next++ = (gic_signal){sweep->metric[m].name, sweep->metric[m].unit};
    return signal;
}

/* No two columns have one name. */
static void check_names(const Sweep *sweep, const gic_signal *signal, int columns)
{
    for (int m = 0; m < sweep->metrics; ++m)
        for (int c = 0; c < columns; ++c)
            if (c != columns - sweep->metrics + m && !strcmp(signal[c].name, sweep->metric[m].name))
                diag_fail_call(program_place(), "give it another name",
                               "the table has a column '%s' without the metric of this name", signal[c].name);
}

static void write_results(const Sweep *sweep, const char *path, const gic_signal *signal, int columns)
{
    Pool *pool = sweep->pool;
    Csv csv = csv_open(pool, path);
    for (int c = 0; c < columns; ++c)
        csv_name(&csv, signal[c].name, signal[c].unit);
    csv_end_row(&csv);
    for (int64_t r = 0; r < sweep->plan->count; ++r) {
        fputs(sweep->journal->row[r], csv.file);
        csv_end_row(&csv);
    }
    csv_close(&csv);
}

/* begun: when the sweep began, which compiles first; start: when the runs did; results: where they are. */
static void summary(const Sweep *sweep, int64_t before, double begun, double start, const char *results)
{
    const double end = clock_seconds(CLOCK_MONOTONIC);
    Text text = {.pool = sweep->pool};
    const Journal *journal = sweep->journal;
    const int64_t done = journal->finished - before;
    text_print(&text, "%s: %lld runs in %s", sweep->engine->code->name, (long long)journal->finished, results);
    if (before)
        text_print(&text, ", %lld of them from an earlier start", (long long)before);
    text_print(&text, "; %s", sweep->many ? "in lanes" : "each by itself");
    if (sweep->processes > 1)
        text_print(&text, ", up to %d processes", sweep->processes);
    text_print(&text, ", %.3g s: %.3g s to read and compile, %.3g s of runs, %.4g runs/s\n", end - begun, start - begun,
               end - start, (double)done / fmax(end - start, 1e-9));
    if (journal->failed)
        text_print(&text, "  %lld failed, the first is run %lld: %s\n", (long long)journal->failed,
                   (long long)journal->first_failed,
                   journal->first_reason ? journal->first_reason : gic_status_text(journal->first_status));
    diag_note(text.s);
}

/* All that comes before the runs: names are looked up, code is compiled. */
static void open_sweep(Sweep *sweep, const SweepRequest *request, SweepTable *table)
{
    Pool *pool = sweep->pool;
    const Model *model = sweep->model;
    const char *const journal_path = pool_print(pool, "%s.journal", request->results);
    for (int v = 0; v < request->varied; ++v)
        vary_read(pool, sweep->plan, request->vary[v]);
    for (int i = 0; i < 2; ++i) {
        source_keep(model->source, i ? journal_path : request->results);
        source_keep(sweep->scene->source, i ? journal_path : request->results);
    }
    scene_no_rig(sweep->scene);
    scene_no_implicit(sweep->scene, "a sweep");
    sweep->scene = equilibrium_start(pool, model, sweep->scene, request->code.solve);
    sweep->engine = open_code(pool, request, model, sweep->scene, &sweep->many);
    table->engine = sweep->engine;
    plan_close(pool, sweep->plan, model, sweep->engine);
    table->signal = signals_of(sweep, &table->columns);
    check_names(sweep, table->signal, table->columns);
}

void sweep_all(Pool *pool, const Model *model, const Scene *scene, const SweepRequest *request, SweepTable *table)
{
    const double begun = clock_seconds(CLOCK_MONOTONIC);
    SweepPlan plan = {.latin = request->latin, .seed = request->seed, .part = request->part, .parts = request->parts};
    Sweep sweep = {.pool = pool,
                   .model = model,
                   .scene = scene,
                   .plan = &plan,
                   .metrics = request->metrics,
                   .metric = request->metric,
                   .quiet = request->quiet,
                   .processes = share_processes()};
    open_sweep(&sweep, request, table);
    const FolderPlan parts = {sweep_key(pool, &sweep, &request->code), plan.runs, plan.parts, table->columns,
                              (gic_signal *)table->signal};

    interrupt_hold();
    if (plan.part)
        folder_plan_write(pool, request->results, &parts);
    const char *path = plan.part ? folder_journal(pool, request->results, plan.part)
                                 : pool_print(pool, "%s.journal", request->results);
    Journal journal =
        journal_open(pool, path, plan.part ? folder_key(pool, &parts, plan.part) : parts.key, plan.first, plan.count);
    const int64_t before = journal.finished;
    const double start = clock_seconds(CLOCK_MONOTONIC);
    sweep.journal = &journal;
    if (!sweep_run(&sweep)) {
        const char *text = pool_print(
            pool, "%s: interrupted; %lld of %lld runs are kept in %s: the same command goes on\n",
            program_place().source->path, (long long)journal.finished, (long long)journal.runs, journal.path);
        journal_close(&journal);
        diag_fail_as(text);
    }
    table->runs = plan.count;
    table->row = journal.row;
    if (plan.part) {
        journal_close(&journal);
    } else {
        write_results(&sweep, request->results, table->signal, table->columns);
        journal_remove(&journal);
    }
    interrupt_release();
    if (!request->quiet)
        summary(&sweep, before, begun, start, plan.part ? path : request->results);
}

void sweep_plan(Pool *pool, const Model *model, const Scene *scene, const SweepRequest *request, double seconds,
                const char *const *command, int words, SweepTable *table)
{
    enum { JOBS = 1000 /* of an array, as Slurm has it without another setting */, SLACK = 4 };
    SweepPlan plan = {.latin = request->latin, .seed = request->seed, .parts = request->parts};
    Sweep sweep = {.pool = pool,
                   .model = model,
                   .scene = scene,
                   .plan = &plan,
                   .metrics = request->metrics,
                   .metric = request->metric,
                   .quiet = request->quiet};
    open_sweep(&sweep, request, table);
    interrupt_hold();
    const double each = sweep_seconds(&sweep);
    if (each < 0)
        diag_fail_as(pool_print(pool, "%s: interrupted; nothing is planned\n", program_place().source->path));
    const double all = each * (double)plan.runs;
    const double wanted = plan.parts ? plan.parts : fmax(1, ceil(all / seconds)), most = fmin(JOBS, (double)plan.runs);
    const int parts = (int)(plan.parts ? wanted : fmin(wanted, most));
    folder_plan_write(pool, request->results,
                      &(FolderPlan){sweep_key(pool, &sweep, &request->code), plan.runs, parts, table->columns,
                                    (gic_signal *)table->signal});
    job_write(pool, request->results, command, words, parts, SLACK * all / parts);
    interrupt_release();
    if (!request->quiet)
        diag_note(pool_print(pool,
                             "%s: %lld runs in %d parts of about %.3g s on one processor: sbatch %s/job.sh, then %s "
                             "--merge %s -o results.csv\n",
                             sweep.engine->code->name, (long long)plan.runs, parts, all / parts, request->results,
                             program_place().source->path, request->results));
}
