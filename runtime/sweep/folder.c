/* SPDX-License-Identifier: MIT
 * A sweep in parts: its folder. Nothing in it is changed after it is written, journals grow; no clock and no lock
 * decides what is valid, but hashes of contents. */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "base/version.h"
#include "host/host.h"
#include "sweep/report.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PLAN_MOST = 4 << 20 /* bytes */ };

static const char *plan_path(Pool *pool, const char *folder)
{
    return pool_print(pool, "%s/plan", folder);
}

const char *folder_journal(Pool *pool, const char *folder, int part)
{
    return pool_print(pool, "%s/part_%d.journal", folder, part);
}

const char *folder_key(Pool *pool, const FolderPlan *plan, int part)
{
    return pool_print(pool, "%s part %d of %d", plan->key, part, plan->parts);
}

/* ---- the plan ---------------------------------------------------------------------------------------------- */

static const char last[] = "hash "; /* the last line: of all bytes before it */

static const char *plan_text(Pool *pool, const FolderPlan *plan)
{
    Text text = {.pool = pool};
    text_print(&text, "gicsweep plan %s\nkey %s\nruns %lld\nparts %d\n", GICGEN_VERSION, plan->key,
               (long long)plan->runs, plan->parts);
    const SweepForm *form = &plan->form;
    for (int f = 0; f < form->facts; ++f)
        text_print(&text, "fact %s\t%s\n", form->fact[f].name, form->fact[f].value);
    if (form->bases)
        text_print(&text, "bases %lld\n", (long long)form->bases);
    if (form->samples)
        text_print(&text, "samples %lld\napart %.17g\n", (long long)form->samples, form->apart);
    for (int c = 0; c < form->columns + form->series; ++c) {
        const SweepColumn *column = &form->column[c];
        text_print(&text, "%s %s\t%s\t%s\t%s\n", c < form->columns ? "column" : "series", column->group, column->name,
                   column->description, column->unit ? column->unit : "");
    }
    text_print(&text, "%s%016llx\n", last, (unsigned long long)text_hash(text.s, text.size));
    return text.s;
}

static _Noreturn void refuse(const char *path, const char *why)
{
    diag_fail(program_place(), "plan the sweep into another folder; journals in this one are left as they are", "%s %s",
              path, why);
}

/* The text after a word at the beginning of a line, which it ends; NULL: another word. */
static char *after(char **line, const char *word)
{
    char *text = *line, *end = strchr(text, '\n');
    if (!end || strncmp(text, word, strlen(word)) != 0)
        return NULL;
    *end = 0;
    *line = end + 1;
    return text + strlen(word);
}

/* The text up to a tab, which it ends; *text moves past it. NULL: there is none. */
static char *before_tab(char **text)
{
    char *from = *text, *tab = from ? strchr(from, '\t') : NULL;
    *text = tab ? tab + 1 : NULL;
    if (tab)
        *tab = 0;
    return tab ? from : NULL;
}

/* What the table looks like, from the lines after the first ones. False: they are none of ours. */
static bool form_read(Pool *pool, char **line, SweepForm *form)
{
    char *text;
    while ((text = after(line, "fact "))) {
        const char *name = before_tab(&text);
        *POOL_PUSH(pool, form->fact, form->facts) = (SweepFact){name, text};
        if (!name)
            return false;
    }
    const char *bases = after(line, "bases ");
    form->bases = bases ? strtoll(bases, NULL, 10) : 0;
    const char *samples = after(line, "samples "), *apart = samples ? after(line, "apart ") : NULL;
    form->samples = apart ? strtoll(samples, NULL, 10) : 0;
    form->apart = apart ? strtod(apart, NULL) : 0;
    for (bool series = false;; series = true) {
        while ((text = after(line, series ? "series " : "column "))) {
            SweepColumn column = {.group = before_tab(&text)};
            column.name = before_tab(&text);
            column.description = before_tab(&text);
            if (!column.description)
                return false;
            column.unit = *text ? text : NULL;
            int *count = series ? &form->series : &form->columns, all = form->columns + form->series;
            *POOL_PUSH(pool, form->column, all) = column;
            ++*count;
        }
        if (series)
            return form->columns && form->samples >= 0 && !form->series == !form->samples;
    }
}

FolderPlan folder_plan_read(Pool *pool, const char *folder)
{
    const char *path = plan_path(pool, folder);
    size_t size;
    char *text = file_read(pool, path, PLAN_MOST, &size), *line = text;
    const char *version = after(&line, "gicsweep plan ");
    if (!version || strlen(text) + 1 + strlen(line) != size)
        refuse(path, "is no plan of gicsweep");
    if (strcmp(version, GICGEN_VERSION) != 0)
        refuse(path, pool_print(pool, "is of gicsweep %s, and this is %s", version, GICGEN_VERSION));
    text[strlen(text)] = '\n';
    char *end = text;
    for (char *next; (next = strstr(end + 1, last)); end = next)
        ;
    if (end == text || end[-1] != '\n' ||
        strcmp(end, pool_print(pool, "%s%016llx\n", last, (unsigned long long)text_hash(text, (size_t)(end - text)))) !=
            0)
        refuse(path, "has been edited");
    FolderPlan plan = {.key = after(&line, "key ")};
    const char *runs = after(&line, "runs "), *parts = after(&line, "parts ");
    plan.runs = runs ? strtoll(runs, NULL, 10) : 0;
    plan.parts = parts ? (int)strtol(parts, NULL, 10) : 0;
    if (!plan.key || plan.runs < 1 || plan.runs > SWEEP_RUNS_MOST || plan.parts < 1 || plan.parts > plan.runs)
        refuse(path, "is no plan of gicsweep");
    if (!form_read(pool, &line, &plan.form) || plan.form.bases < 0 || plan.form.bases > plan.runs)
        refuse(path, "is no plan of gicsweep");
    return plan;
}

void folder_plan_write(Pool *pool, const char *folder, const FolderPlan *plan)
{
    const char *path = plan_path(pool, folder), *text = plan_text(pool, plan);
    if (mkdir(folder, 0777) && errno != EEXIST)
        diag_fail(program_place(), file_remedy(errno), "can't make the folder %s: %s", folder, strerror(errno));
    if (access(path, F_OK)) {
        file_write(path, text, strlen(text));
        return;
    }
    const FolderPlan other = folder_plan_read(pool, folder);
    if (!strcmp(plan_text(pool, &other), text))
        return;
    if (!strcmp(other.key, plan->key) && other.parts != plan->parts)
        refuse(path, pool_print(pool, "has %d parts, not %d", other.parts, plan->parts));
    refuse(path,
           "is of another sweep: another model, scene, file that they name, range, compiler, processor or program");
}

/* ---- one table ----------------------------------------------------------------------------------------------- */

/* Parts that are missing as Slurm takes them, "2,5-7", and how many runs of them; parts 0: none. */
typedef struct Missing {
    Text list;
    int parts, from, to;
    int64_t runs;
} Missing;

static void put_range(Missing *missing)
{
    if (missing->from)
        text_print(&missing->list, missing->to > missing->from ? "%s%d-%d" : "%s%d", missing->list.size ? "," : "",
                   missing->from, missing->to);
}

static void add_missing(Missing *missing, int part, int64_t runs)
{
    missing->runs += runs;
    ++missing->parts;
    if (missing->from && part == missing->to + 1) {
        missing->to = part;
        return;
    }
    put_range(missing);
    missing->from = missing->to = part;
}

/* How to make them: by the script, where the sweep was planned with one. */
static const char *missing_remedy(Pool *pool, const Missing *missing, const char *folder, int parts)
{
    const char *one = missing->parts > 1 ? "I" : missing->list.s;
    const char *which = missing->parts > 1 ? pool_print(pool, ", I = %s", missing->list.s) : "";
    if (!access(pool_print(pool, "%s/job.sh", folder), F_OK))
        return pool_print(pool, "start them again: sbatch --array=%s %s/job.sh, or gicsweep --shard %s/%d%s",
                          missing->list.s, folder, one, parts, which);
    return pool_print(pool, "start them again: gicsweep --shard %s/%d -o %s with the same model, scene and options%s",
                      one, parts, folder, which);
}

void folder_merge(Pool *pool, const char *folder, const char *results, const ReportRequest *page, bool quiet)
{
    const FolderPlan plan = folder_plan_read(pool, folder);
    Missing missing = {.list = {.pool = pool}};
    int64_t failed = 0;
    if (files_are_one(results, plan_path(pool, folder)))
        diag_fail_call(program_place(), "choose another file", "results do not go to %s", results);
    SweepReport report = {.path = NULL};
    if (page->path)
        report = sweep_report_open(pool, page, &plan.form, plan.runs,
                                   (const char *const[]){results, plan_path(pool, folder), NULL});
    const char **row = pool_alloc(pool, sizeof *row * (size_t)(page->path ? plan.runs + 1 : 1));
    interrupt_hold();
    table_check(pool, results, &plan.form);
    const size_t numbers = (size_t)plan.form.series * (size_t)plan.form.samples;
    double *value = pool_alloc(pool, (numbers + 1) * sizeof *value);
    Table *table = table_open(pool, results, &plan.form, plan.runs);
    for (int part = 1; part <= plan.parts; ++part) {
        Pool *own = pool_new(); /* one part at a time is in memory */
        const int64_t first = part_first(plan.runs, part, plan.parts);
        const int64_t runs = part_first(plan.runs, part + 1, plan.parts) - first;
        const Journal journal =
            journal_read(own, folder_journal(own, folder, part), folder_key(own, &plan, part), &plan.form, first, runs);
        failed += journal.failed;
        if (journal.finished < runs)
            add_missing(&missing, part, runs - journal.finished);
        for (int64_t r = 0; r < runs && !missing.parts; ++r) {
            if (journal.series && !series_get(journal.series, first + r, value))
                diag_fail(program_place(), "try again", "%s changes while it is read", journal.series->path);
            table_row(table, journal.row[r], value);
            if (page->path)
                row[first + r] = pool_print(pool, "%s", journal.row[r]);
        }
        if (journal.series)
            series_close(journal.series);
        pool_free(own);
    }
    if (missing.parts) {
        table_abandon(table);
        put_range(&missing);
        diag_fail(program_place(), missing_remedy(pool, &missing, folder, plan.parts),
                  "%lld of %lld runs in %s are missing, in %s %s of %d", (long long)missing.runs, (long long)plan.runs,
                  folder, missing.parts > 1 ? "parts" : "part", missing.list.s, plan.parts);
    }
    if (page->path)
        sweep_report_write(pool, &plan.form, plan.runs, row, &report, quiet);
    table_close(table);
    interrupt_release();
    if (!quiet)
        diag_note(pool_print(pool, "%s: %lld runs of %d parts in %s, %lld failed\n", program_place().source->path,
                             (long long)plan.runs, plan.parts, results, (long long)failed));
}
