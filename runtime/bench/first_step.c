/* SPDX-License-Identifier: MIT
 * Generated against interpreted: the time until the first step, the time of a step from then on, and the number of
 * steps after which generated code has taken less in all. Each start is a process of its own, so that nothing is
 * loaded, allocated or compiled there yet. */
#include "base/catch.h"
#include "base/text.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const Setting setting = {GIC_AB3, 0.005};

/* A way to the first step. */
typedef struct Way {
    const char *name, *engine;
    const char *flags; /* of the compiler, before the user's */
    bool kept;         /* may use the object of an earlier start */
    bool generated;
    bool slow; /* not with --quick */
} Way;

static const Way every_way[] = {
    {"cc", "cc", "", .generated = true},
    {"cc (kept)", "cc", "", .kept = true, .generated = true},
    {"cc -O3", "cc", "-O3 ", .generated = true, .slow = true},
    {"tcc", "tcc", "", .generated = true},
    {"tape", "tape", "", .generated = false},
    {"gic", "gic", "", .generated = false},
    {"gcp1", "gcp1", "", .generated = false},
    {"gcp2", "gcp2", "", .generated = false},
};

enum { WAYS = sizeof every_way / sizeof *every_way };

/* Times of one start and of the steps after it, s. */
typedef struct Start {
    bool good;
    double cpu, elapsed;     /* from the model's file to the end of the first step, the compiler included */
    double compiling;        /* CPU time of compilation alone */
    double step, evaluation; /* medians of elapsed time over the steps that follow */
    size_t bytes;            /* of code and constants; 0: interpreted, or not known */
} Start;

/* The tried ways, and their starts by repetition. */
typedef struct Starts {
    int ways;
    const Way *way[WAYS];
    Start *start[WAYS]; /* [repetitions] */
} Starts;

/* ---- the child ------------------------------------------------------------------------------------------------- */

/* Steps of the scene, each timed, and at each a right-hand side on a copy. */
static void time_steps(const Engine *engine, gic_head *self, const Scene *scene, Start *start)
{
    Pool *pool = pool_new();
    const gic_model *code = engine->code;
    const int steps = (int)(scene->duration / scene->step);
    double *step = pool_alloc(pool, sizeof *step * (size_t)(steps + 1));
    double *evaluation = pool_alloc(pool, sizeof *evaluation * (size_t)(steps + 1));
    double *rate = pool_alloc(pool, sizeof *rate * (size_t)(code->slow_count + code->fast_count));
    gic_head *copy = instance_new(pool, engine);
    const double look = bench_look(pool);
    int done = 0;
    for (int status = GIC_OK; done <= steps && status == GIC_OK; ++done) {
        double before = clock_seconds(CLOCK_MONOTONIC);
        status = scene_step(engine, code, scene, NULL, self, 0);
        step[done] = clock_seconds(CLOCK_MONOTONIC) - before - look;
        memcpy(copy, self, code->size);
        before = clock_seconds(CLOCK_MONOTONIC);
        code->rhs(copy, gic_time(copy), instance_array(copy, code->state_offset), rate);
        evaluation[done] = clock_seconds(CLOCK_MONOTONIC) - before - look;
    }
    start->step = spread_of(pool, step, done).median;
    start->evaluation = spread_of(pool, evaluation, done).median;
    pool_free(pool);
}

/* From the model's file on. */
static Start start_here(const Bench *bench, const Way *way)
{
    Start start = {.good = false};
    const double cpu = cpu_seconds(), elapsed = clock_seconds(CLOCK_MONOTONIC);
    Pool *pool = pool_new();
    EngineOptions options = bench->options;
    options.flags = pool_print(pool, "%s%s", way->flags, options.flags);
    options.quiet = true;
    if (!way->kept)
        setenv("GICGEN_CACHE", "", 1);
    const Model *model = model_read(pool, bench->model_path);
    const Scene scene = bench_scene(scene_read(pool, bench->scene_path, model, NULL, 0), setting);
    const Engine *engine = engine_open(pool, way->engine, model, &options);
    gic_head *self = instance_new(pool, engine);
    const bool stepped = scene_start(engine, &scene, self) == GIC_OK &&
                         scene_step(engine, engine->code, &scene, NULL, self, 0) == GIC_OK;
    start.cpu = cpu_seconds() - cpu;
    start.elapsed = clock_seconds(CLOCK_MONOTONIC) - elapsed;
    start.compiling = engine->compiling;
    start.bytes = engine->bytes;
    /* tcc falls back to the tape without executable memory, and cc compiles without a cache: other ways */
    start.good = stepped && way->generated == !engine->context && way->kept <= (engine->compiling <= 0);
    if (start.good)
        time_steps(engine, self, &scene, &start);
    return start;
}

typedef struct Apart {
    const Bench *bench;
    const Way *way;
    Start start;
} Apart;

static void start_caught(void *context)
{
    Apart *apart = context;
    apart->start = start_here(apart->bench, apart->way);
}

/* In a process of its own, which a failure ends, whoever called, with its message. */
static _Noreturn void start_and_send(const Bench *bench, const Way *way, int pipe)
{
    Apart apart = {.bench = bench, .way = way};
    const Listener ours = {.program = program_place().source, .signals = true};
    Messages said = {NULL, NULL, &ours};
    const bool good = caught(&said, start_caught, &apart);
    for (const Message *message = said.first; message; message = message->next)
        fputs(message->printed, stderr);
    _exit(!good || write(pipe, &apart.start, sizeof apart.start) != sizeof apart.start);
}

/* The same in a process of its own, which sends the result through a pipe. */
static Start start_apart(const Bench *bench, const Way *way)
{
    Start start = {.good = false};
    int ends[2];
    if (pipe(ends))
        return start;
    fflush(NULL); /* else the child would write it too */
    const pid_t child = fork();
    if (child == 0)
        start_and_send(bench, way, ends[1]);
    close(ends[1]);
    if (child < 0 || read(ends[0], &start, sizeof start) != sizeof start)
        start.good = false;
    close(ends[0]);
    if (child > 0)
        waitpid(child, NULL, 0);
    return start;
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static bool all_good(const Bench *bench, const Start *start)
{
    bool good = true;
    for (int r = 0; r < bench->repetitions; ++r)
        good &= start[r].good;
    return good;
}

/* One of the numbers of all repetitions, by its place in a Start. */
static double *numbers(const Bench *bench, const Start *start, size_t offset)
{
    double *number = pool_alloc(bench->pool, sizeof *number * (size_t)bench->repetitions);
    for (int r = 0; r < bench->repetitions; ++r)
        memcpy(&number[r], (const char *)&start[r] + offset, sizeof *number);
    return number;
}

/* The remaining cells of a row whose way failed. */
static void failed_cells(Pool *pool, Sheet *table)
{
    while (table->cells % table->columns)
        table_cell(pool, table, "failed");
}

static void start_table(const Bench *bench, const Starts *starts)
{
    Pool *pool = bench->pool;
    Sheet *table = report_table(bench->report, "start", "From the model's file to the end of the first step",
                                "engine|compiling [ms]|low|high|CPU [ms]|low|high|elapsed [ms]|low|high|"
                                "code and constants [kB]");
    for (int w = 0; w < starts->ways; ++w) {
        const Start *start = starts->start[w];
        table_cell(pool, table, "%s", starts->way[w]->name);
        if (!all_good(bench, start)) {
            failed_cells(pool, table);
            continue;
        }
        const size_t offset[] = {offsetof(Start, compiling), offsetof(Start, cpu), offsetof(Start, elapsed)};
        for (size_t i = 0; i < sizeof offset / sizeof *offset; ++i)
            spread_cells(pool, table, spread_of(pool, numbers(bench, start, offset[i]), bench->repetitions), 1e3);
        table_cell(pool, table, start->bytes ? "%.1f" : "-", 1e-3 * (double)start->bytes);
    }
}

/* first: the way that others are compared with */
static void step_table(const Bench *bench, const Starts *starts)
{
    Pool *pool = bench->pool;
    const Start *first = starts->start[0];
    Sheet *table = report_table(bench->report, "start_steps", "From then on",
                                pool_print(pool,
                                           "engine|right-hand side [us]|low|high|step [us]|low|high|"
                                           "right-hand side over that of %s|low|high",
                                           starts->way[0]->name));
    for (int w = 0; w < starts->ways; ++w) {
        const Start *start = starts->start[w];
        table_cell(pool, table, "%s", starts->way[w]->name);
        if (!all_good(bench, start) || !all_good(bench, first)) {
            failed_cells(pool, table);
            continue;
        }
        const double *evaluation = numbers(bench, start, offsetof(Start, evaluation));
        const double *compared = numbers(bench, first, offsetof(Start, evaluation));
        spread_cells(pool, table, spread_of(pool, evaluation, bench->repetitions), 1e6);
        spread_cells(pool, table, spread_of(pool, numbers(bench, start, offsetof(Start, step)), bench->repetitions),
                     1e6);
        spread_cells(pool, table, spread_of_ratio(pool, evaluation, compared, bench->repetitions), 1);
    }
}

/* The least number of steps after which generated code has taken less CPU time, from the model's file on; INFINITY:
 * none. */
static double break_even(const Start *generated, const Start *interpreted)
{
    const double behind = generated->cpu - interpreted->cpu, gain = interpreted->step - generated->step;
    if (behind < 0)
        return 1;
    return gain > 0 ? 2 + floor(behind / gain) : INFINITY; /* the first step is in `behind` */
}

static const char *steps_text(Pool *pool, double steps)
{
    return steps < INFINITY ? pool_print(pool, "%.0f", steps) : "never";
}

static void break_even_table(const Bench *bench, const Starts *starts)
{
    Pool *pool = bench->pool;
    Text columns = {.pool = pool};
    text_print(&columns, "steps until .. is ahead of");
    for (int w = 0; w < starts->ways; ++w)
        if (!starts->way[w]->generated)
            text_print(&columns, "|%s|low|high", starts->way[w]->name);
    Sheet *table =
        report_table(bench->report, "break_even", "Break-even steps, generated against interpreted", columns.s);
    double *steps = pool_alloc(pool, sizeof *steps * (size_t)bench->repetitions);
    for (int g = 0; g < starts->ways; ++g) {
        if (!starts->way[g]->generated)
            continue;
        table_cell(pool, table, "%s", starts->way[g]->name);
        for (int i = 0; i < starts->ways; ++i) {
            if (starts->way[i]->generated)
                continue;
            if (!all_good(bench, starts->start[g]) || !all_good(bench, starts->start[i])) {
                for (int column = 0; column < 3; ++column)
                    table_cell(pool, table, "failed");
                continue;
            }
            for (int r = 0; r < bench->repetitions; ++r)
                steps[r] = break_even(&starts->start[g][r], &starts->start[i][r]);
            const Spread spread = spread_of(pool, steps, bench->repetitions);
            table_cell(pool, table, "%s", steps_text(pool, ceil(spread.median)));
            table_cell(pool, table, "%s", steps_text(pool, spread.low));
            table_cell(pool, table, "%s", steps_text(pool, spread.high));
        }
    }
}

static void start_chart(const Bench *bench, const Starts *starts)
{
    Pool *pool = bench->pool;
    Chart *chart = report_chart(bench->report, "break_even", "CPU time, the start included", "steps", "CPU time [s]");
    chart->note = "Where two lines cross, the one has made up for the other.";
    for (int w = 0; w < starts->ways; ++w) {
        const Start *start = starts->start[w];
        if (!all_good(bench, start))
            continue;
        const double cpu = spread_of(pool, numbers(bench, start, offsetof(Start, cpu)), bench->repetitions).median;
        const double step = spread_of(pool, numbers(bench, start, offsetof(Start, step)), bench->repetitions).median;
        for (double steps = 1; steps < 2e7; steps *= sqrt(10))
            chart_point(pool, chart, starts->way[w]->name, w, steps, cpu + (steps - 1) * step);
    }
}

/* ---- the experiment ------------------------------------------------------------------------------------------------
 */

/* The ways to the requested engines. */
static Starts ways_of(const Bench *bench)
{
    Starts starts = {.ways = 0};
    for (int w = 0; w < WAYS; ++w) {
        bool wanted = false;
        for (int i = 0; bench->starting[i]; ++i)
            wanted |= !strcmp(bench->starting[i], every_way[w].engine);
        if (!wanted || (every_way[w].slow && bench->quick))
            continue;
        starts.start[starts.ways] = pool_alloc(bench->pool, sizeof(Start) * (size_t)bench->repetitions);
        starts.way[starts.ways++] = &every_way[w];
    }
    return starts;
}

void bench_start(const Bench *bench)
{
    Starts starts = ways_of(bench);
    bool generated = false, interpreted = false;
    for (int r = 0; r < bench->repetitions; ++r)
        for (int w = 0; w < starts.ways; ++w) {
            bench_progress(bench, "start: repetition %d of %d, %s", r + 1, bench->repetitions, starts.way[w]->name);
            starts.start[w][r] = start_apart(bench, starts.way[w]);
            generated |= starts.way[w]->generated;
            interpreted |= !starts.way[w]->generated;
        }
    if (!starts.ways)
        return;
    report_heading(bench->report, "Generated against interpreted");
    report_text(bench->report,
                "What it takes from the model's file to the end of the first step, everything included but loading "
                "gicbench itself: reading, generating or preparing, compiling, set-up, the step. CPU time includes the "
                "compiler's, compiling is that alone. Each start is a process of its own; cc (kept) finds the "
                "object of an earlier start. Memory is that of code and constants. After the first, steps are those of "
                "AB3 with %s, one right-hand side each: medians over a run. Medians, lowest and highest of %d "
                "repetitions, engines alternating, ratios formed within a repetition.",
                setting_text(bench->pool, setting), bench->repetitions);
    start_table(bench, &starts);
    step_table(bench, &starts);
    if (generated && interpreted)
        break_even_table(bench, &starts);
    start_chart(bench, &starts);
}
