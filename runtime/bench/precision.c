/* SPDX-License-Identifier: MIT
 * Run time against error of complete vehicles with their scenes: constant and variable steps, single and dual rate,
 * changes of gear within steps and at their ends, contacts within steps and gone over. */
#include "base/file.h"
#include "base/message.h"
#include "bench/bench.h"
#include "bench/precision.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "run/stepper.h"
#include "scene/scene.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum {
    MOST_ROWS = 96,
    PARTS = 4,          /* the scene's step, its half, .. */
    TOLERANCES = 7,     /* with --quick every other one */
    IMPLICIT = 5,       /* colour of ros2, ros3, imex, bdf */
    GROUP_REFERENCE = 6 /* of the line at the reference's uncertainty */
};

static const double tolerance[TOLERANCES] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

/* A way with one of its steps or tolerances. */
typedef struct Result {
    const char *way;
    int group; /* of curves with one colour */
    const Engine *engine;
    gic_head *self;
    Ride ride;
    RideEnd end;
    double error;   /* m */
    double order;   /* from the row before, with twice the step; NAN: none */
    double *second; /* [repetitions] CPU time for a second of the vehicle's time */
} Result;

/* A scene of one model. */
typedef struct Study {
    const Bench *bench;
    const char *model_name, *scene_name; /* of their files */
    const Engine *engine, *exact;        /* exact: with the Jacobian that bdf wants; NULL: no scene is stiff */
    gic_head *self, *exact_self;
    const Scene *scene;
    Reference reference;
    int rows;
    Result row[MOST_ROWS];
} Study;

/* A model with its scenes, all read before anything runs. */
typedef struct Vehicle {
    const char *name; /* of the file */
    const Model *model;
    int scenes;
    const Scene **scene;
    const char **scene_name;
} Vehicle;

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- what is read ----------------------------------------------------------------------------------------- */

static const Scene *read_one(const Bench *bench, const Model *model, const char *path)
{
    const Scene *scene = scene_read(bench->pool, path, model, NULL, 0);
    const Place at = {scene->source, 0, 0};
    scene_no_rig(scene);
    if (scene->automatic)
        scene_no_implicit(scene, "gicbench");
    if (!(scene->step > 0))
        diag_fail(at, "write a step: constant steps are tried with it, its half, its quarter and its eighth",
                  "the scene has no step");
    return equilibrium_start(bench->pool, model, scene, bench->options.solve);
}

/* Models, each followed by its scenes; the first file is a model, later ones are if they end in .veh. */
static Vehicle *read_files(const Bench *bench, int *vehicles, int *scenes)
{
    Pool *pool = bench->pool;
    Vehicle *vehicle = NULL;
    *vehicles = *scenes = 0;
    for (int i = 0; i < bench->files; ++i) {
        const char *path = bench->file[i];
        if (!i || path_ends(path, ".veh")) {
            *POOL_PUSH(pool, vehicle, *vehicles) = (Vehicle){.name = file_name(path), .model = model_read(pool, path)};
            continue;
        }
        Vehicle *last = &vehicle[*vehicles - 1];
        int names = last->scenes;
        *POOL_PUSH(pool, last->scene_name, names) = file_name(path);
        *POOL_PUSH(pool, last->scene, last->scenes) = read_one(bench, last->model, path);
        ++*scenes;
    }
    return vehicle;
}

/* Scenes with an implicit integrator say by it that their vehicle is stiff. */
static bool is_stiff(const Scene *scene)
{
    return scene_implicit(scene) || scene->method == METHOD_BDF;
}

/* ---- the ways --------------------------------------------------------------------------------------------- */

static void add_row(Study *study, const char *way, int group, Ride ride)
{
    Result *row = &study->row[study->rows++];
    const bool exact = study->exact && ride.setting.method == METHOD_BDF;
    *row = (Result){.way = way,
                    .engine = exact ? study->exact : study->engine,
                    .self = exact ? study->exact_self : study->self,
                    .group = group,
                    .ride = ride,
                    .order = NAN};
    row->second = pool_alloc(study->bench->pool, sizeof *row->second * (size_t)study->bench->repetitions);
}

/* The scene's step and its parts. `ride` without its setting; `what` is told after the way's name. */
static void add_parts(Study *study, const char *way, const char *what, int group, int32_t method, Ride ride)
{
    for (int i = 0; i < PARTS; ++i) {
        ride.setting = (Setting){method, study->scene->step / (1 << i)};
        add_row(study, pool_print(study->bench->pool, "%s%s", way, what), group, ride);
    }
}

/* Constant steps; if the gear changes in the scene, also with these changes at steps' ends; if contacts do, also with
 * them located. */
static void add_constant(Study *study, const char *way, int group, int32_t method, int32_t ratio)
{
    add_parts(study, way, "", group, method, (Ride){.ratio = ratio});
    if (study->reference.touches)
        add_parts(study, way, ", contacts located", group, method, (Ride){.ratio = ratio, .locate = true});
    if (study->reference.shifts)
        add_parts(study, way, ", late gears", group, method, (Ride){.ratio = ratio, .change = GEAR_AT_END});
}

static void add_variable(Study *study, const char *way, int group, int32_t method)
{
    for (int i = 0; i < TOLERANCES; i += study->bench->quick ? 2 : 1)
        add_row(study, way, group, (Ride){.setting = {method, tolerance[i]}, .ratio = 1});
}

static void add_all(Study *study)
{
    const int32_t ratio = study->scene->ratio;
    add_constant(study, "ab3, one rate", 0, GIC_AB3, 1);
    if (ratio > 1 && study->engine->code->fast_count)
        add_constant(study, pool_print(study->bench->pool, "ab3, dual rate 1:%d", ratio), 1, GIC_AB3, ratio);
    add_constant(study, "rk4", 2, GIC_RK4, 1);
    add_variable(study, "adams", 3, METHOD_ADAMS);
    add_variable(study, "rkck", 4, METHOD_RKCK);
    if (!is_stiff(study->scene))
        return;
    const int32_t keep = study->scene->keep;
    for (int32_t method = GIC_ROS2; method <= GIC_EXP3; ++method) {
        const bool keeps = keep > 1 && method != GIC_EXP3; /* which makes all steps with the first Jacobian */
        const char *kept = keeps ? pool_print(study->bench->pool, ", a Jacobian for %d steps", keep) : "";
        add_parts(study, integrator_name(method), "", IMPLICIT, method, (Ride){.ratio = 1});
        if (keeps)
            add_parts(study, integrator_name(method), kept, IMPLICIT, method, (Ride){.ratio = 1, .keep = keep});
        if (ratio > 1 && study->engine->code->fast_count)
            add_parts(study, integrator_name(method), pool_print(study->bench->pool, "%s, dual rate 1:%d", kept, ratio),
                      IMPLICIT, method, (Ride){.ratio = ratio, .keep = keeps ? keep : 0});
    }
    if (study->exact)
        add_variable(study, "bdf", IMPLICIT, METHOD_BDF);
}

/* ---- measurements ----------------------------------------------------------------------------------------- */

/* True if the row's error is meaningful: the run ends well, and the error exceeds that of the reference. */
static bool is_told(const Study *study, const Result *row)
{
    return row->end.status == GIC_OK && row->error > study->reference.uncertainty;
}

static double simulated(const Study *study)
{
    return (double)study->scene->outputs * study->scene->output_step;
}

/* Errors of all rows, and orders of those with constant steps. Returns what they took, s. */
static double measure_errors(Study *study)
{
    double seconds = 0;
    for (int i = 0; i < study->rows; ++i) {
        Result *row = &study->row[i];
        Pool *pool = pool_new();
        Track track = track_new(pool, study->scene, study->engine->code);
        bench_progress(study->bench, "%s: error of %s, %s", study->scene_name, row->way,
                       setting_text(pool, row->ride.setting));
        row->end = ride_run(row->engine, row->self, study->scene, &row->ride, &track);
        row->error = track_distance(&track, &study->reference.track);
        seconds += row->end.second;
        pool_free(pool);
        const Result *before = row - 1;
        if (i && setting_constant(row->ride.setting) && !strcmp(row->way, before->way) && is_told(study, row) &&
            is_told(study, before))
            row->order = log2(before->error / row->error);
    }
    return seconds;
}

/* CPU times, all rows by turns. */
static void measure_times(Study *study)
{
    for (int r = 0; r < study->bench->repetitions; ++r) {
        bench_progress(study->bench, "%s: repetition %d of %d", study->scene_name, r + 1, study->bench->repetitions);
        for (int i = 0; i < study->rows; ++i) {
            Result *row = &study->row[i];
            if (row->end.status == GIC_OK)
                row->second[r] =
                    ride_run(row->engine, row->self, study->scene, &row->ride, NULL).second / simulated(study);
        }
    }
}

/* ---- the report ------------------------------------------------------------------------------------------- */

static Spread time_of(const Study *study, const Result *row)
{
    return spread_of(study->bench->pool, row->second, study->bench->repetitions);
}

static void tell_row(const Study *study, Sheet *table, const Result *row)
{
    Pool *pool = study->bench->pool;
    table_cell(pool, table, "%s", study->model_name);
    table_cell(pool, table, "%s", study->scene_name);
    table_cell(pool, table, "%s", row->way);
    table_cell(pool, table, "%s", setting_text(pool, row->ride.setting));
    if (row->end.status != GIC_OK) {
        table_cell(pool, table, "ends at %.3g s", row->end.time);
        while (table->cells % table->columns)
            table_cell(pool, table, "-");
        return;
    }
    table_cell(pool, table, is_told(study, row) ? "%.2e" : "below %.1e",
               is_told(study, row) ? row->error : study->reference.uncertainty);
    table_cell(pool, table, isnan(row->order) ? "-" : "%.1f", row->order);
    spread_cells(pool, table, time_of(study, row), 1e3);
    table_cell(pool, table, "%lld", (long long)row->end.rhs);
    table_cell(pool, table, "%lld", (long long)row->end.fast);
}

/* The row with the least time whose error is `most` at most; NULL: none. */
static const Result *cheapest(const Study *study, double most)
{
    const Result *best = NULL;
    for (const Result *row = study->row; row < study->row + study->rows; ++row)
        if (row->end.status == GIC_OK && fmax(row->error, study->reference.uncertainty) <= most &&
            (!best || time_of(study, row).median < time_of(study, best).median))
            best = row;
    return best;
}

static void tell_best(const Study *study)
{
    Pool *pool = study->bench->pool;
    static const struct {
        double most;
        const char *text;
    } limit[] = {{1e-3, "1 mm"}, {1e-5, "0.01 mm"}};
    Text text = {.pool = pool};
    for (size_t i = 0; i < sizeof limit / sizeof *limit; ++i) {
        const Result *best = cheapest(study, limit[i].most);
        text_print(&text, i ? "; " : "");
        if (best)
            text_print(&text, "within %s: %s, %s, %.3g ms for a second", limit[i].text, best->way,
                       setting_text(pool, best->ride.setting), 1e3 * time_of(study, best).median);
        else
            text_print(&text, "within %s: none", limit[i].text);
    }
    report_headline(study->bench->report, "%s with the least CPU time %s.", study->scene_name, text.s);
}

static const Chart *tell_chart(const Study *study, const char *name)
{
    Pool *pool = study->bench->pool;
    const bool base = study->engine->code->free_base;
    const double uncertainty = study->reference.uncertainty;
    Chart *chart =
        report_chart(study->bench->report, name,
                     pool_print(pool, "%s, %s: CPU time against error", study->scene_name, study->model_name),
                     pool_print(pool, "largest error of the position of %s, metres", base ? "the chassis" : "any body"),
                     "CPU time, milliseconds for a second of driving");
    chart->under = true;
    double low = INFINITY, high = 0;
    for (const Result *row = study->row; row < study->row + study->rows; ++row) {
        if (!is_told(study, row))
            continue;
        const double time = 1e3 * time_of(study, row).median;
        chart_point(pool, chart, row->way, row->group, row->error, time);
        low = fmin(low, time);
        high = fmax(high, time);
    }
    chart_point(pool, chart, "reference uncertain to the left", GROUP_REFERENCE, uncertainty, low);
    chart_point(pool, chart, "reference uncertain to the left", GROUP_REFERENCE, uncertainty, high);
    return chart;
}

/* Ways whose runs end well and can be told from the reference. */
static void tell_equal_errors(const Study *study, const char *name)
{
    Pool *pool = study->bench->pool;
    WayRows way[MOST_ROWS];
    int ways = 0;
    for (int i = 0; i < study->rows;) {
        const char *this = study->row[i].way;
        double *error = pool_alloc(pool, sizeof *error * MOST_ROWS);
        const double **second = pool_alloc(pool, sizeof *second * MOST_ROWS);
        WayRows *rows = &way[ways];
        *rows = (WayRows){this, 0, error, second};
        for (; i < study->rows && !strcmp(study->row[i].way, this); ++i)
            if (is_told(study, &study->row[i])) {
                error[rows->rows] = study->row[i].error;
                second[rows->rows++] = study->row[i].second;
            }
        ways += rows->rows > 0;
    }
    equal_error_tell(study->bench->report, name, study->model_name, study->scene_name, way, ways,
                     study->bench->repetitions);
}

static Sheet *tell_scene(const Study *study, int number, const Chart **chart)
{
    Report *report = study->bench->report;
    Pool *pool = report->pool;
    const Reference *reference = &study->reference;
    const char *name = pool_print(pool, "precision%d", number);
    report_heading(report, pool_print(pool, "%s, %s", study->scene_name, study->model_name));
    report_text(report,
                "%.6g s; the scene's step is %g ms. Reference: %s. It differs by %.1e m from %s and by %.1e m from %s; "
                "errors of %.1e m or less are not told.",
                simulated(study), 1e3 * study->scene->step, reference->name, reference->distance[0],
                reference->check[0], reference->distance[1], reference->check[1], reference->uncertainty);
    *chart = tell_chart(study, name);
    Sheet *table = report_table(report, name, "CPU time for a second of driving, and error",
                                "model|scene|way|step or tolerance|error [m]|order|CPU [ms]|lowest|highest|"
                                "right-hand sides|fast rates");
    for (int i = 0; i < study->rows; ++i)
        tell_row(study, table, &study->row[i]);
    if (is_stiff(study->scene))
        tell_equal_errors(study, pool_print(pool, "equal%d", number));
    tell_best(study);
    return table;
}

static void tell_begin(const Bench *bench, const char *engine)
{
    report_heading(bench->report, "CPU time against error, events included");
    report_text(bench->report,
                "Engine %s, code for any scene; nothing is left out at run time (`steady`, `sleep`). Error: the "
                "largest distance of the base's position from the reference at the scene's output times; of any body "
                "where the base is fixed. CPU time is that of the integration alone, without outputs, for a second of "
                "the vehicle's time: median, lowest and highest of %d repetitions, in each of which all ways take "
                "their turns. Order: of the error from the row before, with twice the step. The reference and its "
                "first check repeat the step before a change of gear by bisection, with a code of their own; the "
                "second check shares the equations of motion with them, and nothing of the integrators.",
                engine, bench->repetitions);
    report_text(
        bench->report,
        "Ways: constant steps find the time of a change of gear within the step and go on from there; "
        "`late gears`, for scenes in which the gear changes, leaves it to the end of the step in which it is due. "
        "`contacts located`, for scenes in which wheels or stops get or lose their load, makes steps in parts there "
        "(`locate: true`). Variable steps end at both. Scenes with an implicit integrator (`ros2`, `ros3`, `imex`, "
        "`exp3`, `bdf`) are gone by all of these too, and times are compared at equal errors.");
}

/* ---- files of their own ------------------------------------------------------------------------------------- */

/* The rows of all tables, with the first one's header. */
static void write_rows(Csv *csv, Sheet *const *table, int tables)
{
    for (int t = 0; t < tables; ++t)
        for (int i = t ? table[t]->columns : 0; i < table[t]->cells; i += table[t]->columns) {
            for (int k = i; k < i + table[t]->columns; ++k)
                csv_name(csv, table[t]->cell[k], NULL);
            csv_end_row(csv);
        }
}

static void measure(Study *study, int scenes_left)
{
    study->reference = precision_reference(study->bench, study->engine, study->self, study->scene);
    add_all(study);
    const double seconds = measure_errors(study);
    bench_expect(study->bench, seconds * (study->bench->repetitions + scenes_left * (study->bench->repetitions + 2)));
    measure_times(study);
}

/* All scenes of a model; table, chart: filled from the first on. Returns how many. */
static int measure_vehicle(const Bench *bench, const Vehicle *vehicle, int done, int scenes, Sheet **table,
                           const Chart **chart)
{
    Pool *pool = bench->pool;
    bench_progress(bench, "%s: engine %s", vehicle->name, bench->engine_name);
    bool stiff = false;
    for (int i = 0; i < vehicle->scenes; ++i)
        stiff = stiff || is_stiff(vehicle->scene[i]);
    EngineOptions options = bench->options;
    if (stiff && !engine_has_implicit(bench->engine_name))
        diag_fail((Place){vehicle->scene[0]->source, 0, 0}, "take --engines cc or tcc",
                  "the engine '%s' has no derivatives for implicit steps", bench->engine_name);
    options.implicit = options.exponential = stiff;
    const Engine *engine = engine_open(pool, bench->engine_name, vehicle->model, &options), *exact = NULL;
    options.exact = true;
    if (stiff && stepper_there(METHOD_BDF))
        exact = engine_open(pool, bench->engine_name, vehicle->model, &options);
    for (int i = 0; i < vehicle->scenes; ++i) {
        Study *study = pool_alloc(pool, sizeof *study);
        *study = (Study){.bench = bench,
                         .model_name = vehicle->name,
                         .scene_name = vehicle->scene_name[i],
                         .engine = engine,
                         .self = instance_new(pool, engine),
                         .exact = exact,
                         .exact_self = exact ? instance_new(pool, exact) : NULL,
                         .scene = vehicle->scene[i]};
        measure(study, scenes - done - i - 1);
        table[i] = tell_scene(study, done + i + 1, &chart[i]);
    }
    engine_close(engine);
    if (exact)
        engine_close(exact);
    return vehicle->scenes;
}

/* The charts that have points. */
static void write_picture(const Bench *bench, const Chart **chart, int charts)
{
    int count = 0;
    for (int i = 0; i < charts; ++i)
        if (chart[i]->count)
            chart[count++] = chart[i];
    if (!count)
        diag_fail(program_place(), "shorter steps in the scene", "no picture %s: no run has an error to show",
                  bench->picture);
    charts_write(bench->pool, chart, count, bench->picture);
}

/* End with a message if the picture can't be drawn or written, before minutes of work are spent. */
static void check_picture(const Bench *bench)
{
    char *temporary;
    plot_check(bench->pool);
    interrupt_hold();
    FILE *file = temporary_open(bench->pool, bench->picture, &temporary);
    const int error = errno;
    if (file) {
        fclose(file);
        unlink(temporary);
    }
    interrupt_release();
    if (!file)
        diag_fail(program_place(), file_remedy(error), "can't create %s: %s", bench->picture, strerror(error));
}

void bench_precision(const Bench *bench)
{
    Pool *pool = bench->pool;
    int vehicles, scenes, done = 0;
    const Vehicle *vehicle = read_files(bench, &vehicles, &scenes);
    Csv csv = {.file = NULL};
    if (bench->picture)
        check_picture(bench);
    if (bench->rows)
        csv = csv_open(pool, bench->rows);
    bench_machine(bench);
    tell_begin(bench, bench->engine_name);
    Sheet **table = pool_alloc(pool, sizeof *table * (size_t)scenes);
    const Chart **chart = pool_alloc(pool, sizeof *chart * (size_t)scenes);
    for (const Vehicle *v = vehicle; v < vehicle + vehicles; ++v)
        done += measure_vehicle(bench, v, done, scenes, table + done, chart + done);
    if (csv.file) {
        write_rows(&csv, table, scenes);
        csv_close(&csv);
    }
    if (bench->picture)
        write_picture(bench, chart, scenes);
}
