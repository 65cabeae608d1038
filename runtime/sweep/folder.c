/* SPDX-License-Identifier: MIT
 * A sweep in parts: its folder. Nothing in it is changed after it is written, journals grow; no clock and no lock
 * decides what is valid, but hashes of contents. */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "base/version.h"
#include "host/host.h"
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
    for (int c = 0; c < plan->columns; ++c)
        text_print(&text, "column %s%s%s\n", plan->signal[c].name, plan->signal[c].unit ? "\t" : "",
                   plan->signal[c].unit ? plan->signal[c].unit : "");
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
    for (char *name; (name = after(&line, "column "));) {
        char *unit = strchr(name, '\t');
        if (unit)
            *unit++ = 0;
        *POOL_PUSH(pool, plan.signal, plan.columns) = (gic_signal){name, unit};
    }
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

void folder_merge(Pool *pool, const char *folder, const char *results, bool quiet)
{
    const FolderPlan plan = folder_plan_read(pool, folder);
    Missing missing = {.list = {.pool = pool}};
    int64_t failed = 0;
    if (files_are_one(results, plan_path(pool, folder)))
        diag_fail_call(program_place(), "choose another file", "results do not go to %s", results);
    interrupt_hold();
    Csv csv = csv_open(pool, results);
    for (int c = 0; c < plan.columns; ++c)
        csv_name(&csv, plan.signal[c].name, plan.signal[c].unit);
    csv_end_row(&csv);
    for (int part = 1; part <= plan.parts; ++part) {
        Pool *own = pool_new(); /* one part at a time is in memory */
        const int64_t first = part_first(plan.runs, part, plan.parts);
        const int64_t runs = part_first(plan.runs, part + 1, plan.parts) - first;
        const Journal journal =
            journal_read(own, folder_journal(own, folder, part), folder_key(own, &plan, part), first, runs);
        failed += journal.failed;
        if (journal.finished < runs)
            add_missing(&missing, part, runs - journal.finished);
        for (int64_t r = 0; r < runs && !missing.parts; ++r) {
            fputs(journal.row[r], csv.file);
            csv_end_row(&csv);
        }
        pool_free(own);
    }
    if (missing.parts) {
        csv_abandon(&csv);
        put_range(&missing);
        diag_fail(program_place(), missing_remedy(pool, &missing, folder, plan.parts),
                  "%lld of %lld runs in %s are missing, in %s %s of %d", (long long)missing.runs, (long long)plan.runs,
                  folder, missing.parts > 1 ? "parts" : "part", missing.list.s, plan.parts);
    }
    csv_close(&csv);
    interrupt_release();
    if (!quiet)
        diag_note(pool_print(pool, "%s: %lld runs of %d parts in %s, %lld failed\n", program_place().source->path,
                             (long long)plan.runs, plan.parts, results, (long long)failed));
}
