/* SPDX-License-Identifier: MIT
 * Studies over a grid: what is varied is looked up, each run has a model of its own from the same bytes, and a run that
 * fails leaves the others alone. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "host/host.h"
#include "read/read.h"
#include "run/kc.h"
#include "run/manoeuvre.h"
#include "scene/scene.h"
#include "sweep/study.h"

#include <math.h>
#include <string.h>

/* ---- what is varied ------------------------------------------------------------------------------------- */

static const char *unit_of(const StudySweep *sweep, const char *name)
{
    const ManoeuvreKey *key =
        sweep->kind == STUDY_MANOEUVRE ? manoeuvre_key(sweep->pool, sweep->request->manoeuvre, name) : NULL;
    if (key)
        return *key->unit ? key->unit : "1";
    for (int i = 0; i < sweep->model->parameters; ++i)
        if (!strcmp(sweep->model->parameter[i].name, name))
            return sweep->model->parameter[i].unit;
    return "m";
}

static void plan(StudySweep *sweep)
{
    SweepPlan *plan = &sweep->plan;
    plan->runs = 1;
    for (int v = 0; v < sweep->request->varied; ++v)
        vary_read(sweep->pool, plan, sweep->request->vary[v]);
    sweep->unit = pool_alloc(sweep->pool, (size_t)plan->varied * sizeof *sweep->unit);
    for (int v = 0; v < plan->varied; ++v) {
        const char *name = plan->vary[v].name;
        for (int w = 0; w < v; ++w)
            if (!strcmp(plan->vary[w].name, name))
                diag_fail_call(program_place(), "leave one out", "--vary is given twice for '%s'", name);
        if (!plan->vary[v].count)
            diag_fail_call(program_place(), "write name=low:high:count", "--vary %s needs a count", name);
        plan->runs *= plan->vary[v].count;
        if (plan->runs > STUDY_RUNS_MOST)
            diag_fail_call(program_place(), "choose smaller counts", "these are more than %d studies", STUDY_RUNS_MOST);
        sweep->unit[v] = unit_of(sweep, name);
    }
}

const char *study_label(const StudySweep *sweep, int64_t run)
{
    const char *label = "";
    for (int v = 0; v < sweep->plan.varied; ++v)
        label = pool_print(sweep->pool, "%s%s%s = %.6g", label, v ? ", " : "", sweep->plan.vary[v].name,
                           plan_value(&sweep->plan, v, run));
    return label;
}

/* ---- a run ---------------------------------------------------------------------------------------------- */

typedef struct Making {
    const StudySweep *sweep;
    int64_t number;
    StudyRun *run;
} Making;

/* The scene of a run, whose parameters are those of the file's scene but for what is varied. */
static const Scene *scene_of(Pool *pool, const StudySweep *sweep, const Model *model, int64_t number)
{
    if (!sweep->request->scene)
        return NULL;
    const Scene *scene = scene_read(pool, sweep->request->scene, model, NULL, 0);
    for (int v = 0; v < sweep->plan.varied; ++v)
        for (int i = 0; i < model->parameters; ++i)
            if (model->parameter[i].tunable && !strcmp(model->parameter[i].name, sweep->plan.vary[v].name))
                scene->parameter[model->parameter[i].index] = plan_value(&sweep->plan, v, number);
    return scene;
}

/* Numbers outlive the pool of their run. */
static void keep_rows(Pool *pool, const Sheet *sheet, StudyRun *run)
{
    run->rows = sheet->rows;
    run->row = pool_alloc(pool, ((size_t)sheet->rows + 1) * sizeof *run->row);
    for (int i = 0; i < sheet->rows; ++i) {
        const SheetRow *row = &sheet->row[i];
        run->row[i] = *row;
        run->row[i].section = row->section ? pool_print(pool, "%s", row->section) : NULL;
        run->row[i].name = pool_print(pool, "%s", row->name);
        run->row[i].title = pool_print(pool, "%s", row->title);
        run->row[i].unit = pool_print(pool, "%s", row->unit);
        run->row[i].shown = pool_print(pool, "%s", row->shown);
        run->row[i].place = NULL;
    }
}

static void make(void *context)
{
    const Making *making = context;
    const StudySweep *sweep = making->sweep;
    const SweepPlan *plan = &sweep->plan;
    Pool *pool = pool_new();
    Request request = *sweep->request;
    FileNumber *setting = pool_alloc(pool, (size_t)plan->varied * sizeof *setting);
    const char **key = pool_alloc(pool, (size_t)(request.keys + plan->varied) * sizeof *key);
    int settings = 0;
    memcpy(key, request.key, (size_t)request.keys * sizeof *key);
    for (int v = 0; v < plan->varied; ++v) {
        const char *name = plan->vary[v].name;
        const double value = plan_value(plan, v, making->number);
        if (sweep->kind == STUDY_MANOEUVRE && manoeuvre_key(pool, request.manoeuvre, name))
            key[request.keys++] = pool_print(pool, "%s=%.17g", name, value);
        else
            setting[settings++] = (FileNumber){name, value};
    }
    request.key = key;
    request.quiet = true;
    const Model *model = model_read_set(pool, sweep->model, setting, settings);
    const Scene *scene = scene_of(pool, sweep, model, making->number);
    if (scene && model->tuning)
        model = model_read_fixed(pool, model, scene->parameter);
    if (sweep->kind == STUDY_KC) {
        const KcStudy study = kc_study(pool, model, scene, &request);
        const Sheet sheet = kc_sheet(pool, model, &study);
        keep_rows(sweep->pool, &sheet, making->run);
        study_curves_kc(sweep->pool, &study, making->run);
    } else if (sweep->kind == STUDY_SHEET) {
        const Sheet sheet = sheet_study(pool, model, scene, &request);
        keep_rows(sweep->pool, &sheet, making->run);
    } else {
        const Manoeuvre manoeuvre = manoeuvre_drive(pool, model, &request);
        keep_rows(sweep->pool, manoeuvre.result, making->run);
        study_curves_manoeuvre(sweep->pool, &manoeuvre, making->run);
        engine_close(manoeuvre.car->engine);
    }
    pool_free(pool);
}

static void make_runs(StudySweep *sweep)
{
    int64_t failed = 0;
    const char *first = NULL;
    sweep->run = pool_alloc(sweep->pool, (size_t)sweep->plan.runs * sizeof *sweep->run);
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        Messages said = {NULL, NULL, NULL};
        diag_progress(pool_print(sweep->pool, "%lld of %lld", (long long)r + 1, (long long)sweep->plan.runs));
        if (!caught(&said, make, &(Making){sweep, r, &sweep->run[r]})) {
            const char *reason = "it failed";
            for (const Message *message = said.first; message; message = message->next) {
                if (message->kind != MESSAGE_ERROR)
                    continue;
                reason = pool_print(sweep->pool, "%s", message->text);
                first = first ? first : pool_print(sweep->pool, "%s", message->printed);
                if (message->call) /* what would fail in each run */
                    diag_fail_call(program_place(),
                                   message->remedy ? pool_print(sweep->pool, "%s", message->remedy) : NULL, "%s",
                                   reason);
            }
            sweep->run[r] = (StudyRun){.reason = reason};
            ++failed;
        }
        messages_clear(&said);
    }
    diag_progress("");
    if (failed == sweep->plan.runs)
        diag_fail_as(first ? first : "no run has results\n");
}

/* ---- all runs ------------------------------------------------------------------------------------------- */

/* The column of a number, near where it was in the run before; a new one if there is none. */
static int column_of(StudySweep *sweep, const SheetRow *row, int guess)
{
    if (guess < sweep->columns && !strcmp(sweep->column[guess].name, row->name))
        return guess;
    for (int c = 0; c < sweep->columns; ++c)
        if (!strcmp(sweep->column[c].name, row->name))
            return c;
    *POOL_PUSH(sweep->pool, sweep->column, sweep->columns) = *row;
    return sweep->columns - 1;
}

static void collect(StudySweep *sweep)
{
    for (int64_t r = 0; r < sweep->plan.runs; ++r)
        for (int i = 0, at = 0; i < sweep->run[r].rows; ++i)
            at = column_of(sweep, &sweep->run[r].row[i], at) + 1;
    const size_t count = (size_t)sweep->plan.runs * (size_t)sweep->columns;
    sweep->value = pool_alloc(sweep->pool, (count + 1) * sizeof *sweep->value);
    for (size_t k = 0; k < count; ++k)
        sweep->value[k] = NAN;
    for (int64_t r = 0; r < sweep->plan.runs; ++r)
        for (int i = 0, at = 0; i < sweep->run[r].rows; ++i) {
            const int column = column_of(sweep, &sweep->run[r].row[i], at);
            sweep->value[r * sweep->columns + column] = sweep->run[r].row[i].value;
            at = column + 1;
        }
}

bool study_changes(const StudySweep *sweep, int column)
{
    double low = INFINITY, high = -INFINITY;
    bool missing = false, finite = false;
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        const double value = sweep->value[r * sweep->columns + column];
        if (sweep->run[r].reason)
            continue;
        missing = missing || !isfinite(value);
        finite = finite || isfinite(value);
        if (isfinite(value)) {
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    return finite && (missing || high - low > 1e-9 * fmax(1, fmax(fabs(low), fabs(high))));
}

static void write_csv(const StudySweep *sweep, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(sweep->pool, path);
    csv_name(&csv, "run", NULL);
    for (int v = 0; v < sweep->plan.varied; ++v)
        csv_name(&csv, sweep->plan.vary[v].name, sweep->unit[v]);
    for (int c = 0; c < sweep->columns; ++c)
        csv_name(&csv, sweep->column[c].name, sweep->column[c].unit);
    csv_end_row(&csv);
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        csv_time(&csv, (double)r);
        for (int v = 0; v < sweep->plan.varied; ++v)
            csv_number(&csv, plan_value(&sweep->plan, v, r));
        for (int c = 0; c < sweep->columns; ++c)
            if (isnan(sweep->value[r * sweep->columns + c]))
                csv_text(&csv, NULL);
            else
                csv_number(&csv, sweep->value[r * sweep->columns + c]);
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

static const char *const about[] = {"kinematics, models/KC.md", "sheet, models/SHEET.md",
                                    "manoeuvre, models/MANOEUVRES.md"};

/* What changes, a column a run. */
static void print(const StudySweep *sweep)
{
    Text text = {.pool = sweep->pool}, *out = &text;
    const char *section = NULL;
    int same = 0;
    text_print(out, "%s: %s\n\n", sweep->model->name, about[sweep->kind]);
    for (int v = 0; v < sweep->plan.varied; ++v) {
        text_print(out, "  %-60s%-9s", sweep->plan.vary[v].name, sweep->unit[v]);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            text_print(out, " %14.6g", plan_value(&sweep->plan, v, r));
        text_print(out, "\n");
    }
    for (int c = 0; c < sweep->columns; ++c) {
        const SheetRow *column = &sweep->column[c];
        section = column->section ? column->section : section;
        if (!study_changes(sweep, c)) {
            ++same;
            continue;
        }
        if (section)
            text_print(out, "\n%s\n", section);
        section = NULL;
        text_print(out, "  %-60s%-9s", column->title, column->shown);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            text_print(out, " %14s", kc_shown(sweep->pool, sweep->value[r * sweep->columns + c], column->scale));
        text_print(out, "\n");
    }
    text_print(out, "\n%d other numbers do not change.\n", same);
    diag_text(text.s);
}

void study_sweep(Pool *pool, const Model *model, StudyKind kind, const Request *request)
{
    StudySweep sweep = {.pool = pool, .model = model, .kind = kind, .request = request};
    plan(&sweep);
    make_runs(&sweep);
    collect(&sweep);
    if (request->results)
        write_csv(&sweep, request->results);
    if (request->report)
        study_page(&sweep, request->report);
    if (!request->results && !request->report)
        print(&sweep);
    for (int64_t r = 0; r < sweep.plan.runs; ++r)
        if (sweep.run[r].reason && !request->quiet)
            diag_note(pool_print(pool, "%s: note: no results with %s: %s\n", program_place().source->path,
                                 study_label(&sweep, r), sweep.run[r].reason));
}
