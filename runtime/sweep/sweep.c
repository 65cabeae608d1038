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
#include "run/choose_step.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"
#include "sweep/report.h"
#include "run/stiff_states.h"
#include "sweep/sweep.h"

#include <dlfcn.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { VEHICLES = 64, LANES = 4 };

/* Can the C compiler be started? */
static bool compiler_starts(Pool *pool, const EngineOptions *code)
{
    char **argv = NULL;
    const char *said;
    int words, count = 0;
    const char **word = compiler_words(pool, code->compiler, "--version", "", &words);
    for (int i = 0; i < words; ++i)
        *POOL_PUSH(pool, argv, count) = pool_print(pool, "%s", word[i]);
    *POOL_PUSH(pool, argv, count) = NULL;
    interrupt_hold();
    const bool starts = words && process_run(pool, argv, "", &said) != PROCESS_NOT_STARTED;
    interrupt_release();
    return starts;
}

/* Code for many vehicles, or for one. */
static const Engine *open_lanes_or_one(Pool *pool, const SweepRequest *request, const Model *model, const Scene *scene,
                                       const gic_batch_model **many)
{
    const Batch batch = {VEHICLES, LANES};
    const Engine *engine = NULL;
    const char *why = lanes_unfit(scene, model);
    EngineOptions code = request->code;
    code.implicit = scene_implicit(scene);
    code.exponential = scene->method == GIC_EXP3;
    code.spread = scene->spread;
    code.splitting = scene_splitting(pool, model, scene, code.solve, code.recovery);
    if (request->engine && !engine_has_implicit(request->engine))
        scene_no_implicit_engine(pool, scene, request->engine);
    if (request->engine)
        return engine_open(pool, request->engine, model, &code);
    const bool tried = !why;
    if (tried)
        engine = engine_batch(pool, model, &code, &batch, IN_LANES, many, &why);
    if (engine)
        return engine;
    if (!request->quiet)
        diag_note(
            pool_print(pool, "%s: note: each run by itself instead of lanes: %s\n", program_place().source->path, why));
    const bool compiled = *many || (!tried && compiler_starts(pool, &code));
    return engine_open(pool, compiled ? "cc" : "tcc", model, &code);
}

static const Engine *open_code(Pool *pool, const SweepRequest *request, const Model *model, const Scene *scene,
                               const gic_batch_model **many)
{
    const Engine *engine = open_lanes_or_one(pool, request, model, scene, many);
    engine_check_shares(engine, scene);
    return engine;
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

/* A text without tabs and line ends. */
static const char *one_line(Pool *pool, const char *text)
{
    char *line = pool_print(pool, "%s", text);
    for (char *c = line; *c; ++c)
        if ((unsigned char)*c < ' ')
            *c = ' ';
    return line;
}

static void add_fact(Pool *pool, SweepForm *form, const char *name, const char *value)
{
    *POOL_PUSH(pool, form->fact, form->facts) = (SweepFact){name, one_line(pool, value)};
}

static const char *hash_text(Pool *pool, uint64_t hash)
{
    return pool_print(pool, "%016llx", (unsigned long long)hash);
}

/* All that determines the results: the program, model and scene with all files that they name, the varied numbers, and
 * how code is compiled; but for what is in the compiler. Nothing of where it is and when it was made. */
static void add_facts(Pool *pool, const Sweep *sweep, const EngineOptions *code, SweepForm *form)
{
    Text options = {.pool = pool}, compiler = {.pool = pool};
    const SweepPlan *plan = sweep->plan;
    for (int v = 0; v < plan->varied; ++v)
        text_print(&options, plan->vary[v].count ? "%s--vary %s=%.17g:%.17g:%lld" : "%s--vary %s=%.17g:%.17g",
                   v ? " " : "", plan->vary[v].name, plan->vary[v].low, plan->vary[v].high,
                   (long long)plan->vary[v].count);
    if (plan->latin)
        text_print(&options, " --latin %lld --seed %llu", (long long)plan->latin, (unsigned long long)plan->seed);
    if (plan->bases)
        text_print(&options, " --sobol %lld", (long long)plan->bases);
    for (int m = 0; m < sweep->metrics; ++m)
        text_print(&options, " --metric '%s'", sweep->metric[m].word);
    if (form->samples)
        text_print(&options, " --series");
    int words;
    const char **word = compiler_words(pool, code->compiler, build_flags, code->flags, &words);
    for (int i = 0; i < words; ++i)
        text_print(&compiler, "%s%s", i ? " " : "", word[i]);
    add_fact(pool, form, "format", "gicsweep 1");
    add_fact(pool, form, "gicgen", GICGEN_VERSION);
    add_fact(pool, form, "program_hash", hash_text(pool, program_hash(pool)));
    add_fact(pool, form, "model", sweep->model->name);
    if (sweep->model->description)
        add_fact(pool, form, "description", sweep->model->description);
    add_fact(pool, form, "model_hash", hash_text(pool, source_hash(sweep->model->source)));
    add_fact(pool, form, "scene_hash", hash_text(pool, source_hash(sweep->scene->source)));
    if (sweep->chosen) /* should two machines choose otherwise, their parts don't go together */
        add_fact(pool, form, "integrator",
                 pool_print(pool, "%s, steps of %.17g s", integrator_name(sweep->scene->method), sweep->scene->step));
    add_fact(pool, form, "engine", sweep->engine->name);
    add_fact(pool, form, "lanes", sweep->many ? "yes" : "no");
    add_fact(pool, form, "options", options.s);
    add_fact(pool, form, "compiler", compiler.s);
}

/* A key of the facts, and of the compiler. */
static const char *sweep_key(Pool *pool, const SweepForm *form, const EngineOptions *code)
{
    Text text = {.pool = pool};
    int words;
    const char **word = compiler_words(pool, code->compiler, build_flags, code->flags, &words);
    for (int f = 0; f < form->facts; ++f)
        text_print(&text, "%s %s\n", form->fact[f].name, form->fact[f].value);
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

/* Columns: the number of the run, the varied numbers, status and time, three of each output of the scene, metrics; and,
 * if asked for, series of the scene's outputs. */
static SweepForm form_of(const Sweep *sweep, bool series)
{
    static const char *const part[][2] = {
        {"end", "at the end"}, {"min", "the least at output times"}, {"max", "the greatest at output times"}};
    enum { OTHERS = 3, PARTS = sizeof part / sizeof *part };
    Pool *pool = sweep->pool;
    const Scene *scene = sweep->scene;
    const int varied = sweep->plan->varied;
    SweepForm form = {.columns = OTHERS + varied + PARTS * scene->columns + sweep->metrics,
                      .series = series ? scene->columns : 0,
                      .bases = sweep->plan->bases};
    SweepColumn *next = form.column = pool_alloc(pool, sizeof *next * (size_t)(form.columns + form.series));
    form.samples = form.series ? scene->outputs + 1 : 0;
    form.apart = form.series ? scene->output_step : 0;
    *next++ = (SweepColumn){"runs", "run", NULL, "number of the run"};
    for (int v = 0; v < varied; ++v) {
        const Vary *vary = &sweep->plan->vary[v];
        *next++ = (SweepColumn){"parameters", one_line(pool, vary->name), unit_of(sweep, vary),
                                pool_print(pool, "from %.17g to %.17g", vary->low, vary->high)};
    }
    Text status = {.pool = pool};
    for (int s = 0; s >= GIC_ERROR_PIVOT; --s)
        text_print(&status, "%s%d: %s", s ? "; " : "", s, gic_status_text(s));
    *next++ = (SweepColumn){"runs", "status", NULL, one_line(pool, status.s)};
    *next++ = (SweepColumn){"runs", "time", "s", "that the run reached"};
    for (int c = 0; c < scene->columns; ++c) {
        const gic_signal *of = &scene->signal[scene->column[c]];
        for (int p = 0; p < PARTS; ++p)
            *next++ = (SweepColumn){"outputs", pool_print(pool, "%s.%s", of->name, part[p][0]), of->unit,
                                    pool_print(pool, "%s, %s", of->name, part[p][1])};
    }
    for (int m = 0; m < sweep->metrics; ++m) {
        const char *equals = strchr(sweep->metric[m].word, '=') + 1;
        *next++ = (SweepColumn){"metrics", sweep->metric[m].name, sweep->metric[m].unit,
                                one_line(pool, equals + strspn(equals, " "))};
    }
    for (int c = 0; c < form.series; ++c) {
        const gic_signal *of = &scene->signal[scene->column[c]];
        *next++ = (SweepColumn){"series", of->name, of->unit,
                                pool_print(pool, "%s over time; nan: the run had ended", of->name)};
    }
    return form;
}

/* No two columns have one name. */
static void check_names(const Sweep *sweep, const SweepForm *form)
{
    for (int m = 0; m < sweep->metrics; ++m)
        for (int c = 0; c < form->columns; ++c)
            if (c != form->columns - sweep->metrics + m && !strcmp(form->column[c].name, sweep->metric[m].name))
                diag_fail_call(program_place(), "give it another name",
                               "the table has a column '%s' without the metric of this name", form->column[c].name);
}

static void write_results(const Sweep *sweep, const char *path)
{
    Pool *pool = sweep->pool;
    const Journal *journal = sweep->journal;
    const SweepForm *form = sweep->form;
    double *value = pool_alloc(pool, sizeof *value * ((size_t)form->series * (size_t)form->samples + 1));
    Table *table = table_open(pool, path, form, sweep->plan->count);
    for (int64_t r = 0; r < sweep->plan->count; ++r) {
        if (journal->series && !series_get(journal->series, sweep->plan->first + r, value)) {
            table_abandon(table);
            diag_fail(program_place(), "the same command makes these runs again", "%s has lost the series of run %lld",
                      journal->series->path, (long long)r);
        }
        table_row(table, journal->row[r], value);
    }
    table_close(table);
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
static void open_sweep(Sweep *sweep, const SweepRequest *request, bool planned, SweepTable *table)
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
    const Scene *drawn = sweep->scene;
    sweep->solve = request->code.solve;
    sweep->scene = equilibrium_start(pool, model, sweep->scene, request->code.solve);
    sweep->chosen = sweep->scene->automatic;
    sweep->scene = scene_choose_step(pool, model, sweep->scene, request->code.solve,
                                     !request->engine || engine_has_implicit(request->engine), request->quiet);
    sweep->drawn = sweep->chosen ? scene_with_choice(pool, drawn, sweep->scene) : drawn;
    sweep->engine = open_code(pool, request, model, sweep->scene, &sweep->many);
    table->engine = sweep->engine;
    plan_close(pool, sweep->plan, model, sweep->engine);
    table->form = form_of(sweep, request->series);
    add_facts(pool, sweep, &request->code, &table->form);
    sweep->form = &table->form;
    check_names(sweep, sweep->form);
    if (!sweep->plan->parts && !planned)
        table_check(pool, request->results, sweep->form);
}

/* What the page shall have. */
static SweepReport open_report(const Sweep *sweep, const SweepRequest *request)
{
    const ReportRequest *page = &request->page;
    const char *const others[] = {request->results, pool_print(sweep->pool, "%s.journal", request->results), NULL};
    source_keep(sweep->model->source, page->path);
    source_keep(sweep->scene->source, page->path);
    return sweep_report_open(sweep->pool, page, sweep->form, sweep->plan->runs, others);
}

void sweep_all(Pool *pool, const Model *model, const Scene *scene, const SweepRequest *request, SweepTable *table)
{
    const double begun = clock_seconds(CLOCK_MONOTONIC);
    SweepPlan plan = {.latin = request->latin,
                      .seed = request->seed,
                      .bases = request->sobol,
                      .part = request->part,
                      .parts = request->parts};
    Sweep sweep = {.pool = pool,
                   .model = model,
                   .scene = scene,
                   .plan = &plan,
                   .metrics = request->metrics,
                   .metric = request->metric,
                   .quiet = request->quiet,
                   .processes = share_processes()};
    open_sweep(&sweep, request, false, table);
    const SweepReport report = request->page.path ? open_report(&sweep, request) : (SweepReport){.path = NULL};
    const FolderPlan parts = {sweep_key(pool, sweep.form, &request->code), plan.runs, plan.parts, table->form};

    interrupt_hold();
    if (plan.part)
        folder_plan_write(pool, request->results, &parts);
    const char *path = plan.part ? folder_journal(pool, request->results, plan.part)
                                 : pool_print(pool, "%s.journal", request->results);
    Journal journal = journal_open(pool, path, plan.part ? folder_key(pool, &parts, plan.part) : parts.key, sweep.form,
                                   plan.first, plan.count);
    if (!plan.part) /* under the journal's lock */
        temporary_clear(pool, request->results);
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
        if (report.path) /* before the journal goes: the same command makes a page that can't be written */
            sweep_report_write(pool, sweep.form, plan.count, journal.row, &report, request->quiet);
        write_results(&sweep, request->results);
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
    SweepPlan plan = {.latin = request->latin, .seed = request->seed, .bases = request->sobol, .parts = request->parts};
    Sweep sweep = {.pool = pool,
                   .model = model,
                   .scene = scene,
                   .plan = &plan,
                   .metrics = request->metrics,
                   .metric = request->metric,
                   .quiet = request->quiet};
    open_sweep(&sweep, request, true, table);
    interrupt_hold();
    const double each = sweep_seconds(&sweep);
    if (each < 0)
        diag_fail_as(pool_print(pool, "%s: interrupted; nothing is planned\n", program_place().source->path));
    const double all = each * (double)plan.runs;
    const double wanted = plan.parts ? plan.parts : fmax(1, ceil(all / seconds)), most = fmin(JOBS, (double)plan.runs);
    const int parts = (int)(plan.parts ? wanted : fmin(wanted, most));
    folder_plan_write(pool, request->results,
                      &(FolderPlan){sweep_key(pool, sweep.form, &request->code), plan.runs, parts, table->form});
    job_write(pool, request->results, command, words, parts, SLACK * all / parts);
    interrupt_release();
    if (!request->quiet)
        diag_note(pool_print(pool,
                             "%s: %lld runs in %d parts of about %.3g s on one processor: sbatch %s/job.sh, then %s "
                             "--merge %s -o results.csv\n",
                             sweep.engine->code->name, (long long)plan.runs, parts, all / parts, request->results,
                             program_place().source->path, request->results));
}
