/* SPDX-License-Identifier: MIT
 * Scenes with code for any scene and with code for each alone: operations, CPU time, difference of the results. */
#include "base/message.h"
#include "base/text.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"
#include "scene/sleep.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

/* The ways in which a scene is run: with all that it may leave out needed, and as gicrun does. */
enum { GENERAL, SPECIAL, WAYS };

typedef struct Way {
    const Engine *engine;
    const Scene *scene;
    gic_head *self, *copy;
    double rhs, fast; /* operations of a right-hand side, and of rates of the fast states alone */
    double *second;   /* [repetitions] CPU time of a run, with outputs */
    double *result;   /* [output times][columns] */
} Way;

/* ---- what is run ------------------------------------------------------------------------------------------------ */

static double operations(Count count)
{
    return (double)count.add + count.multiply + count.divide + count.root + count.function;
}

static void count_operations(Pool *pool, Way *way, const Formulation *formulation)
{
    const Figures *figures = figures_new(pool, formulation);
    way->rhs = operations(figures_rhs(figures, 1, 1));
    way->fast = operations(figures->fast);
}

/* The model with those outputs alone that a scene asks for. */
static const Model *with_outputs(Pool *pool, const Model *model, const bool *wanted)
{
    Model *own = pool_alloc(pool, sizeof *own);
    *own = *model;
    own->output = pool_alloc(pool, sizeof *own->output * (size_t)(model->outputs + 1));
    own->outputs = own->output_components = 0;
    for (int i = 0; i < model->outputs; ++i)
        if (wanted[i]) {
            own->output[own->outputs++] = model->output[i];
            own->output_components += model->output[i].count;
        }
    return own;
}

/* Code for any scene has a base that is free, and can only be held on a rig by what the base weighs: a mass that forces
 * of 1e5 N move by 1e-5 m in 10 s, without gravity. */
static const Model *with_heavy_base(Pool *pool, const Model *model)
{
    const double heavy = 1e12; /* kg, kg m^2 */
    Model *own = pool_alloc(pool, sizeof *own);
    const size_t bodies = sizeof *model->body * (size_t)model->bodies;
    *own = *model;
    own->body = pool_grow(pool, model->body, bodies, bodies);
    own->body[BODY_BASE].mass = heavy;
    for (int i = 0; i < 3; ++i) {
        own->gravity[i] = 0;
        own->body[BODY_BASE].inertia[i] = heavy;
    }
    return own;
}

/* The scene from its beginning, and its model as on its rig. */
static const Scene *begin(const Bench *bench, Pool *pool, const char *path, const Model **model, int kind)
{
    const Scene *scene = scene_read(pool, path, *model, NULL, 0);
    if (kind == GENERAL) {
        Scene *loose = pool_alloc(pool, sizeof *loose);
        *loose = *scene;
        loose->held = false;
        loose->massless = 0;
        if (scene->held)
            *model = with_heavy_base(pool, *model);
        scene = loose;
    }
    *model = scene_rig(pool, *model, &scene);
    return equilibrium_start(pool, *model, scene, bench->options.solve);
}

static Way open_way(const Bench *bench, Pool *pool, const Model *model, const char *path, int kind)
{
    EngineOptions options = bench->options;
    Scene *scene = pool_alloc(pool, sizeof *scene);
    if (kind == GENERAL)
        model = with_outputs(pool, model,
                             scene_facts(pool, model, scene_read(pool, path, model, NULL, 0), path, false)->wanted);
    *scene = *begin(bench, pool, path, &model, kind);
    if (kind == GENERAL) {
        scene->rest = NULL;
        scene->steady = 0;
    } else {
        options.facts = scene_facts(pool, model, scene, path, false);
        options.validation = scene_validation(pool, model, scene);
    }
    Way way = {.engine = engine_open(pool, bench->engine_name, model, &options)};
    way.scene = scene_narrow(pool, scene, model, way.engine);
    way.self = instance_new(pool, way.engine);
    way.copy = instance_new(pool, way.engine);
    way.second = pool_alloc(pool, sizeof *way.second * (size_t)bench->repetitions);
    way.result = pool_alloc(pool, sizeof *way.result * (size_t)((scene->outputs + 1) * scene->columns + 1));
    const Sequence *sequence = sequence_find(pool, model);
    count_operations(pool, &way,
                     formulate_narrow(pool, model_assemble(pool, model, sequence), sequence, bench->options.solve,
                                      bench->options.recovery, options.facts));
    return way;
}

/* ---- runs ------------------------------------------------------------------------------------------------------- */

/* One run, as gicrun makes it; CPU seconds. Returns the status that ended it. */
static int run(const Way *way, double *second)
{
    const gic_model *code = way->engine->code;
    const Scene *scene = way->scene;
    double *next = way->result;
    int64_t slumber = 0;
    int status = scene_start(way->engine, scene, way->self);
    const double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int64_t k = 0; status == GIC_OK && k <= scene->outputs; ++k) {
        for (int64_t i = 0; k && i < scene->per_output && status == GIC_OK; ++i)
            status = scene_step(way->engine, code, scene, NULL, way->self, 0);
        if (status == GIC_OK)
            status = scene_outputs(code, scene, way->self, way->copy, &slumber);
        for (int i = 0; status == GIC_OK && i < scene->columns; ++i)
            *next++ = scene_value(code, way->copy, scene->column[i]);
    }
    *second = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
    return status;
}

/* Largest difference of two results, each column relative to its largest magnitude, at least 1. */
static double difference(const Way *way)
{
    const Scene *scene = way[GENERAL].scene;
    double largest = 0;
    for (int c = 0; c < scene->columns; ++c) {
        double size = 1, apart = 0;
        for (int64_t k = 0; k <= scene->outputs; ++k) {
            const double a = way[GENERAL].result[k * scene->columns + c],
                         b = way[SPECIAL].result[k * scene->columns + c];
            size = fmax(size, fabs(a));
            apart = isnan(a - b) ? INFINITY : fmax(apart, fabs(a - b));
        }
        largest = fmax(largest, apart / size);
    }
    return largest;
}

/* Operations in a second of the scene, millions. */
static double effort(const Way *way)
{
    const gic_head *head = way->self;
    const double all = (double)head->rhs_count * way->rhs + (double)head->fast_count * way->fast;
    return all / gic_time(head) / 1e6;
}

/* What a run left out, in parts of what there was. */
static const char *left_out(Pool *pool, const Way *way)
{
    const gic_head *head = way->self;
    const struct {
        const char *name;
        int64_t count;
    } skip[] = {{"asleep", head->sleep_count},
                {"fast rates", head->steady_count},
                {"tires in the air", head->air_count},
                {"recoveries", head->kept_count}};
    Text text = {.pool = pool};
    for (size_t i = 0; i < sizeof skip / sizeof *skip; ++i)
        if (skip[i].count)
            text_print(&text, "%s%s %lld", text.size ? "; " : "", skip[i].name, (long long)skip[i].count);
    return text.size ? text.s : "-";
}

/* ---- the table -------------------------------------------------------------------------------------------------- */

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void scene_row(const Bench *bench, Sheet *table, const char *model_path, const char *scene_path, const Way *way)
{
    Pool *pool = bench->pool;
    const int count = bench->repetitions;
    table_cell(pool, table, "%s", file_name(scene_path));
    table_cell(pool, table, "%s", file_name(model_path));
    for (int k = 0; k < WAYS; ++k)
        table_cell(pool, table, "%.0f", way[k].rhs);
    for (int k = 0; k < WAYS; ++k)
        table_cell(pool, table, "%.4g", effort(&way[k]));
    table_cell(pool, table, "%.3g", effort(&way[SPECIAL]) / effort(&way[GENERAL]));
    for (int k = 0; k < WAYS; ++k)
        table_cell(pool, table, "%.4g", 1e3 * spread_of(pool, way[k].second, count).median);
    spread_cells(pool, table, spread_of_ratio(pool, way[SPECIAL].second, way[GENERAL].second, count), 1);
    table_cell(pool, table, "%.2g", difference(way));
    table_cell(pool, table, "%s", left_out(pool, &way[SPECIAL]));
}

/* Returns the median ratio of the times. */
static double measure_scene(const Bench *bench, Sheet *table, const char *model_path, const char *scene_path)
{
    Pool *pool = pool_new();
    const Model *model = model_read(pool, model_path);
    Way way[WAYS];
    for (int k = 0; k < WAYS; ++k)
        way[k] = open_way(bench, pool, model, scene_path, k);
    const Place at = {way[GENERAL].scene->source, 0, 0};
    if (!way[GENERAL].scene->per_output)
        diag_fail(at, "write `integrator: ab3` and a step", "a scene is timed with constant steps");
    for (int r = 0; r < bench->repetitions; ++r)
        for (int k = 0; k < WAYS; ++k) {
            bench_progress(bench, "%s, repetition %d of %d", file_name(scene_path), r + 1, bench->repetitions);
            const int status = run(&way[k], &way[k].second[r]);
            if (status != GIC_OK)
                diag_fail(at, "a benchmark needs a scene that runs to its end", "the run ends at t = %.6g s: %s",
                          gic_time(way[k].self), instance_status(pool, way[k].engine->code, way[k].self, status));
        }
    scene_row(bench, table, model_path, scene_path, way);
    const double ratio = spread_of_ratio(pool, way[SPECIAL].second, way[GENERAL].second, bench->repetitions).median;
    for (int k = 0; k < WAYS; ++k)
        engine_close(way[k].engine);
    pool_free(pool);
    return ratio;
}

void bench_scenes(const Bench *bench)
{
    report_heading(bench->report, "Scenes with code for each");
    report_text(bench->report,
                "Engine %s. General: code for any scene, with the outputs that the scene asks for. Specialised: code "
                "for the scene alone, and what it allows to leave out at run time. CPU time of the whole run with its "
                "outputs, median of %d runs, general and specialised ones alternating; ratios run by run, with "
                "extremes. Operations: additions, multiplications, divisions, roots and functions, of one right-hand "
                "side, and in millions in a second of the scene. Difference: the largest of all results, relative to "
                "the largest magnitude of each, which counts as 1 at least. On a rig, general code holds the base by a "
                "mass of 1e12 kg without gravity.",
                bench->engine_name, bench->repetitions);
    Sheet *table =
        report_table(bench->report, "scenes", "General and specialised",
                     "scene|model|rhs general|rhs specialised|general [M/s]|specialised [M/s]|operations ratio|"
                     "general [ms]|specialised [ms]|time ratio|lowest|highest|difference|left out");
    double *ratio = pool_alloc(bench->pool, sizeof *ratio * (size_t)bench->files);
    for (int i = 0; i < bench->files; i += 2) {
        bench_progress(bench, "scene %d of %d", i / 2 + 1, bench->files / 2);
        ratio[i / 2] = measure_scene(bench, table, bench->file[i], bench->file[i + 1]);
        bench_extrapolate(bench, i + 2, bench->files);
    }
    const Spread all = spread_of(bench->pool, ratio, bench->files / 2);
    report_headline(bench->report,
                    "Code for one scene alone takes %.2g times the CPU time of general code: median of %d scenes, from "
                    "%.2g to %.2g.",
                    all.median, bench->files / 2, all.low, all.high);
}
