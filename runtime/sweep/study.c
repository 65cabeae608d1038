/* SPDX-License-Identifier: MIT
 * Studies over a grid: what is varied is looked up, numbers of all runs are put into columns, and written. */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "read/read.h"
#include "run/kc.h"
#include "run/manoeuvre.h"
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

/* ---- all runs ------------------------------------------------------------------------------------------- */

int64_t study_next_failed(const StudySweep *sweep, int64_t k)
{
    while (k < 2 * sweep->plan.runs && !sweep->run[k / 2].reason[k % 2])
        ++k;
    return k < 2 * sweep->plan.runs ? k : -1;
}

const char *study_failure(const StudySweep *sweep, int64_t k)
{
    return pool_print(sweep->pool, "%s%swith %s: %s", sweep->beside ? sweep->name[k % 2] : "", sweep->beside ? " " : "",
                      study_label(sweep, k / 2), sweep->run[k / 2].reason[k % 2]);
}

const char *study_note(const StudySweep *sweep, const StudyNote *note)
{
    const char *who = sweep->beside ? pool_print(sweep->pool, "%s: ", sweep->name[note->who]) : "";
    if (note->runs == sweep->plan.runs)
        return pool_print(sweep->pool, "%s%s", who, note->text);
    return pool_print(sweep->pool, "%swith %s%s: %s", who, study_label(sweep, note->first),
                      note->runs > 1 ? pool_print(sweep->pool, " and in %lld other runs", (long long)note->runs - 1)
                                     : "",
                      note->text);
}

static void make_runs(StudySweep *sweep)
{
    bool any = false;
    sweep->shapes = sheet_shapes(sweep->pool);
    sweep->run = pool_alloc(sweep->pool, (size_t)sweep->plan.runs * sizeof *sweep->run);
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        diag_progress(pool_print(sweep->pool, "%lld of %lld", (long long)r + 1, (long long)sweep->plan.runs));
        study_make(sweep, r);
        any = any || !sweep->run[r].reason[0] || (sweep->beside && !sweep->run[r].reason[1]);
    }
    diag_progress("");
    if (!any)
        diag_fail_as(sweep->first ? sweep->first : "no run has results\n");
}

/* ---- their numbers -------------------------------------------------------------------------------------- */

/* The column of a number, which is usually the one after that of the number before; -1: there is none. */
static int column_of(const StudySweep *sweep, const SheetRow *row, int guess)
{
    if (guess < sweep->columns && sheet_is_same(&sweep->column[guess], row))
        return guess;
    for (int c = 0; c < sweep->columns; ++c)
        if (sheet_is_same(&sweep->column[c], row))
            return c;
    return -1;
}

/* A new number comes after the one before it. */
static void add_columns(StudySweep *sweep, const StudyRun *run)
{
    for (int i = 0, at = 0; i < run->rows; ++i) {
        const int column = column_of(sweep, &run->row[i], at);
        if (column < 0) {
            const char *name = sheet_free_name(sweep->pool, sweep->column, sweep->columns, run->row[i].name);
            POOL_PUSH(sweep->pool, sweep->column, sweep->columns);
            memmove(sweep->column + at + 1, sweep->column + at,
                    (size_t)(sweep->columns - 1 - at) * sizeof *sweep->column);
            sweep->column[at] = run->row[i];
            sweep->column[at].name = name;
        }
        at = (column < 0 ? at : column) + 1;
    }
}

static void collect(StudySweep *sweep)
{
    const int vehicles = sweep->beside ? 2 : 1;
    for (int failed = 0; failed < 2; ++failed) /* names are the model's where it has results */
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            if (!sweep->run[r].reason[0] == !failed)
                add_columns(sweep, &sweep->run[r]);
    const size_t count = (size_t)sweep->plan.runs * (size_t)sweep->columns;
    for (int who = 0; who < vehicles; ++who) {
        sweep->value[who] = pool_alloc(sweep->pool, (count + 1) * sizeof **sweep->value);
        for (size_t k = 0; k < count; ++k)
            sweep->value[who][k] = NAN;
    }
    for (int64_t r = 0; r < sweep->plan.runs; ++r)
        for (int i = 0, at = 0; i < sweep->run[r].rows; ++i) {
            const SheetRow *row = &sweep->run[r].row[i];
            const int column = column_of(sweep, row, at);
            for (int who = 0; who < vehicles; ++who)
                sweep->value[who][r * sweep->columns + column] = who ? row->other : row->value;
            at = column + 1;
        }
}

/* Of one vehicle. few: fewer than two runs have results. */
static bool changes(const StudySweep *sweep, int who, int column, bool *few)
{
    double low = INFINITY, high = -INFINITY;
    bool missing = false, finite = false;
    int64_t runs = 0;
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        const double value = sweep->value[who][r * sweep->columns + column];
        if (sweep->run[r].reason[who])
            continue;
        ++runs;
        missing = missing || !isfinite(value);
        finite = finite || isfinite(value);
        if (isfinite(value)) {
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    *few = *few && runs < 2;
    return finite && (missing || high - low > 1e-9 * fmax(1, fmax(fabs(low), fabs(high))));
}

bool study_changes(const StudySweep *sweep, int column)
{
    bool few = true, any = false;
    for (int who = 0; who < (sweep->beside ? 2 : 1); ++who)
        any = changes(sweep, who, column, &few) || any;
    return any || few;
}

bool study_differs(const StudySweep *sweep, int column, int64_t run)
{
    SheetRow row = sweep->column[column];
    if (!sweep->beside || sweep->run[run].reason[0] || sweep->run[run].reason[1])
        return false;
    row.value = sweep->value[0][run * sweep->columns + column];
    row.other = sweep->value[1][run * sweep->columns + column];
    return !(isnan(row.value) && isnan(row.other)) && sheet_differs(&row);
}

static bool differs_anywhere(const StudySweep *sweep, int column)
{
    for (int64_t r = 0; r < sweep->plan.runs; ++r)
        if (study_differs(sweep, column, r))
            return true;
    return false;
}

const char *study_shown(const StudySweep *sweep, int who, int column, int64_t run)
{
    if (sweep->run[run].reason[who])
        return "failed";
    return kc_shown(sweep->pool, sweep->value[who][run * sweep->columns + column], sweep->column[column].scale);
}

/* ---- what is written ------------------------------------------------------------------------------------ */

static void cell(Csv *csv, double value)
{
    if (isnan(value))
        csv_text(csv, NULL);
    else
        csv_number(csv, value);
}

static void write_names(const StudySweep *sweep, Csv *csv)
{
    csv_name(csv, "run", NULL);
    for (int v = 0; v < sweep->plan.varied; ++v)
        csv_name(csv, sweep->plan.vary[v].name, sweep->unit[v]);
    for (int c = 0; c < sweep->columns; ++c) {
        const SheetRow *column = &sweep->column[c];
        csv_name(csv, column->name, column->unit);
        if (sweep->beside) {
            csv_name(csv, pool_print(sweep->pool, "%s.other", column->name), column->unit);
            csv_name(csv, pool_print(sweep->pool, "%s.difference", column->name), column->unit);
        }
    }
    csv_end_row(csv);
}

static void write_csv(const StudySweep *sweep, const char *path)
{
    interrupt_hold();
    Csv csv = csv_open(sweep->pool, path);
    write_names(sweep, &csv);
    for (int64_t r = 0; r < sweep->plan.runs; ++r) {
        csv_time(&csv, (double)r);
        for (int v = 0; v < sweep->plan.varied; ++v)
            csv_number(&csv, plan_value(&sweep->plan, v, r));
        for (int c = 0; c < sweep->columns; ++c) {
            const double own = sweep->value[0][r * sweep->columns + c];
            cell(&csv, own);
            if (!sweep->beside)
                continue;
            const double other = sweep->value[1][r * sweep->columns + c];
            cell(&csv, other);
            cell(&csv, isfinite(other - own) ? other - own : NAN);
        }
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

static const char *const about[] = {"kinematics, models/KC.md", "compliance, models/KC.md", "joints, models/KC.md",
                                    "sheet, models/SHEET.md", "manoeuvre, models/MANOEUVRES.md"};

static void print_row(const StudySweep *sweep, Text *out, int c)
{
    const SheetRow *column = &sweep->column[c];
    for (int who = 0; who < (sweep->beside ? 2 : 1); ++who) {
        text_print(out, "  %-60s%-9s", who ? pool_print(sweep->pool, "  of %s", sweep->name[1]) : column->title,
                   who ? "" : column->shown);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            text_print(out, " %14s%s", study_shown(sweep, who, c, r),
                       !sweep->beside                      ? ""
                       : who && study_differs(sweep, c, r) ? "*"
                                                           : " ");
        text_print(out, "\n");
    }
}

/* What changes, a column a run. */
static void print(const StudySweep *sweep)
{
    Text text = {.pool = sweep->pool}, *out = &text;
    const char *section = "";
    int same = 0, apart = 0;
    text_print(out, "%s%s%s: %s\n\n", sweep->name[0], sweep->beside ? " and " : "", sweep->beside ? sweep->name[1] : "",
               about[sweep->kind]);
    for (int v = 0; v < sweep->plan.varied; ++v) {
        text_print(out, "  %-60s%-9s", sweep->plan.vary[v].name, sweep->unit[v]);
        for (int64_t r = 0; r < sweep->plan.runs; ++r)
            text_print(out, " %14.6g%s", plan_value(&sweep->plan, v, r), sweep->beside ? " " : "");
        text_print(out, "\n");
    }
    for (int c = 0; c < sweep->columns; ++c) {
        const SheetRow *column = &sweep->column[c];
        if (!study_changes(sweep, c)) {
            ++same;
            apart += differs_anywhere(sweep, c);
            continue;
        }
        if (column->section && strcmp(column->section, section) != 0)
            text_print(out, "\n%s\n", section = column->section);
        print_row(sweep, out, c);
    }
    text_print(out, "\n%d other numbers do not change%s.\n", same,
               sweep->beside ? pool_print(sweep->pool, "; %d of them differ between the two", apart) : "");
    for (int64_t k = -1; (k = study_next_failed(sweep, k + 1)) >= 0;)
        text_print(out, "No results: %s.\n", study_failure(sweep, k));
    diag_text(text.s);
}

/* Notes, and at last that runs failed. */
static void tell(const StudySweep *sweep)
{
    enum { NOTES = 12 /* that are told one by one */ };
    Pool *pool = sweep->pool;
    const char *program = program_place().source->path;
    int64_t failed = 0;
    const char *first = NULL;
    for (int i = 0; i < sweep->notes && i < NOTES && !sweep->request->quiet; ++i)
        diag_note(pool_print(pool, "%s: note: %s\n", program, study_note(sweep, &sweep->note[i])));
    if (sweep->notes > NOTES && !sweep->request->quiet)
        diag_note(pool_print(pool, "%s: note: and %d other notes\n", program, sweep->notes - NOTES));
    for (int64_t k = -1; (k = study_next_failed(sweep, k + 1)) >= 0; ++failed) {
        first = first ? first : study_failure(sweep, k);
        if (failed && !sweep->request->quiet)
            diag_note(pool_print(pool, "%s: note: no results %s\n", program, study_failure(sweep, k)));
    }
    if (first)
        diag_fail(program_place(), NULL, "%lld of %lld %s no results, the first %s", (long long)failed,
                  (long long)sweep->plan.runs * (sweep->beside ? 2 : 1), failed > 1 ? "runs have" : "runs has", first);
}

/* What stands beside the model, and which of the numbers it has. */
static void find_beside(StudySweep *sweep)
{
    const char *file = sweep->request->compare;
    sweep->name[0] = sweep->model->name;
    if (!file)
        return;
    const Model *other = sheet_other(sweep->pool, sweep->model, file, &sweep->name[1]);
    const bool scene = path_ends(file, ".scene");
    sweep->scene_beside = scene ? file : NULL;
    sweep->beside = scene ? sweep->model : other;
    sweep->moves = pool_alloc(sweep->pool, (size_t)sweep->plan.varied * sizeof *sweep->moves);
    for (int v = 0; v < sweep->plan.varied; ++v) {
        const char *name = sweep->plan.vary[v].name;
        sweep->moves[v] = scene || model_has_number(sweep->pool, other, name);
        const bool key = sweep->kind == STUDY_MANOEUVRE && manoeuvre_key(sweep->pool, sweep->request->manoeuvre, name);
        if (!sweep->moves[v] && !key && !sweep->request->quiet)
            diag_note(pool_print(sweep->pool, "%s: note: %s has no '%s', which changes nothing of it\n",
                                 program_place().source->path, sweep->name[1], name));
    }
}

void study_sweep(Pool *pool, const Model *model, StudyKind kind, const Request *request)
{
    StudySweep sweep = {.pool = pool, .model = model, .kind = kind, .request = request};
    plan(&sweep);
    find_beside(&sweep);
    make_runs(&sweep);
    collect(&sweep);
    if (request->results)
        write_csv(&sweep, request->results);
    if (request->report)
        study_page(&sweep, request->report);
    if (!request->results && !request->report)
        print(&sweep);
    tell(&sweep);
}
