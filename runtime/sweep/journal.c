/* SPDX-License-Identifier: MIT
 * The journal of a sweep: lines are appended, never changed, and written before the next batch begins: a kill takes
 * none of them. Onto the disk they go once a second; what a machine that stops loses of them is made again. The first
 * line identifies the sweep. Each other line has a checksum: an incomplete or damaged one is ignored, so that its run
 * is made again. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static _Noreturn void journal_fail(const Journal *journal, const char *what)
{
    diag_fail(program_place(), file_remedy(errno), "can't %s %s: %s", what, journal->path, strerror(errno));
}

static const double behind_most = 1; /* s by which the disk is behind, where runs are added */

/* Onto the disk. */
static void sync_now(Journal *journal)
{
    journal->behind = false;
    if (journal->series)
        series_sync(journal->series);
    if (fsync(journal->file) && errno != EINVAL) /* not every file system knows it */
        journal_fail(journal, "write");
    journal->synced = clock_seconds(CLOCK_MONOTONIC);
}

static void append(Journal *journal, const char *bytes, size_t size)
{
    while (size) {
        const ssize_t n = write(journal->file, bytes, size);
        if (n < 0)
            journal_fail(journal, "write");
        bytes += n;
        size -= (size_t)n;
    }
    journal->behind = true;
}

static void note(Journal *journal, const RunResult *result)
{
    const char **row = &journal->row[result->run - journal->first];
    if (*row && strcmp(*row, result->row) != 0)
        diag_fail(program_place(), "do all nodes have the same libraries? remove it, and make its runs again",
                  "%s has two rows of run %lld that differ", journal->path, (long long)result->run);
    if (*row)
        return;
    *row = result->row;
    ++journal->finished;
    journal->failed += result->status != GIC_OK;
    if (result->status != GIC_OK && (journal->first_status == GIC_OK || result->run < journal->first_failed)) {
        journal->first_status = result->status;
        journal->first_failed = result->run;
        journal->first_reason = result->reason;
    }
}

/* "checksum run status row" */
static const char *line_of(Pool *pool, const RunResult *result)
{
    const char *text = pool_print(pool, "%lld %d %s", (long long)result->run, result->status, result->row);
    return pool_print(pool, "%016llx %s\n", (unsigned long long)text_hash(text, strlen(text)), text);
}

/* Take a line without its end; a damaged one is passed over. */
static void take_line(Journal *journal, const char *line)
{
    char *end;
    const unsigned long long sum = strtoull(line, &end, 16);
    if (*end != ' ' || sum != text_hash(end + 1, strlen(end + 1)))
        return;
    const int64_t run = strtoll(end + 1, &end, 10);
    const int status = (int)strtol(end, &end, 10);
    const bool ours = *end == ' ' && run >= journal->first && run < journal->first + journal->runs;
    if (ours && (!journal->series || series_get(journal->series, run, journal->room)))
        note(journal, &(RunResult){run, status, end + 1, NULL});
}

/* The file, which begins with text[size], should begin with the line `first`. */
static _Noreturn void refuse_foreign(const Journal *journal, const char *text, size_t size, const char *first)
{
    static const char part[] = " part "; /* as folder_key() has it */
    const char *wanted = strstr(first, part), *end = memchr(text, '\n', size);
    const size_t same = wanted ? (size_t)(wanted - first) + strlen(part) : 0;
    if (wanted && end && (size_t)(end - text) > same && !memcmp(text, first, same))
        diag_fail(program_place(), "remove it: its runs are made again by the same command",
                  "%s is the journal of part %.*s of this sweep, not of part %.*s", journal->path,
                  (int)(end - text - (ptrdiff_t)same), text + same, (int)strcspn(first + same, "\n"), first + same);
    diag_fail(
        program_place(), "remove it, or choose another place with -o",
        "%s is of another sweep: another model, scene, file that they name, range, compiler, processor or program",
        journal->path);
}

/* Take what is in the file: whole lines. Returns the bytes up to the end of the last one. */
static size_t take(Journal *journal, const char *first)
{
    size_t size;
    char *text = file_read(journal->pool, journal->path, SIZE_MAX, &size);
    size_t good = strlen(first);
    if (size < good || memcmp(text, first, good) != 0)
        refuse_foreign(journal, text, size, first);
    for (char *end; (end = memchr(text + good, '\n', size - good)); good = (size_t)(end + 1 - text)) {
        *end = 0;
        take_line(journal, text + good);
    }
    return good;
}

static Journal journal_new(Pool *pool, const char *path, const Series *series, int64_t first, int64_t runs)
{
    Journal journal = {.pool = pool, .path = path, .file = -1, .series = series, .first = first, .runs = runs};
    journal.room = series ? pool_alloc(pool, series->numbers * sizeof *journal.room) : NULL;
    journal.row = pool_alloc(pool, sizeof *journal.row * (size_t)(runs + 1));
    return journal;
}

static const char *first_line(Pool *pool, const char *key)
{
    return pool_print(pool, "gicsweep journal %s\n", key);
}

Journal journal_read(Pool *pool, const char *path, const char *key, const SweepForm *form, int64_t first, int64_t runs)
{
    const Series *series = form->samples ? series_read(pool, series_path(pool, path), form, first) : NULL;
    Journal journal = journal_new(pool, path, series, first, runs);
    const char *line = first_line(pool, key);
    struct stat is = {.st_size = 0};
    if (stat(path, &is) && errno != ENOENT)
        journal_fail(&journal, "read");
    if (is.st_size >= (off_t)strlen(line)) /* a shorter one is being begun */
        take(&journal, line);
    return journal;
}

/* Where a failure ends a call and not the program. */
static void let_go(void *held)
{
    close(*(const int *)held);
}

Journal journal_open(Pool *pool, const char *path, const char *key, const SweepForm *form, int64_t first_run,
                     int64_t runs)
{
    Journal journal = journal_new(pool, path, NULL, first_run, runs);
    const char *first = first_line(pool, key);
    journal.file = open(journal.path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (journal.file < 0)
        journal_fail(&journal, "open");
    struct stat is;
    if (fstat(journal.file, &is) || !S_ISREG(is.st_mode) || is.st_uid != geteuid())
        diag_fail(program_place(), "remove it, or choose another place with -o", "%s is no file, or somebody else's",
                  journal.path);
    journal.held = pool_alloc(pool, sizeof *journal.held);
    *journal.held = journal.file;
    caught_own(let_go, journal.held);
    if (flock(journal.file, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)
        diag_fail(program_place(), "wait for it, or choose another place with -o", "another gicsweep is writing %s",
                  journal.path);
    if (form->samples) { /* by the holder of the lock */
        journal.series = series_open(pool, series_path(pool, path), form, first_run);
        journal.room = pool_alloc(pool, journal.series->numbers * sizeof *journal.room);
    }
    const off_t size = lseek(journal.file, 0, SEEK_END);
    if (size < (off_t)strlen(first)) {
        const char *bytes = file_read(journal.pool, journal.path, SIZE_MAX, &(size_t){0});
        if (strncmp(bytes, first, (size_t)size) != 0)
            refuse_foreign(&journal, bytes, (size_t)size, first);
        if (ftruncate(journal.file, 0))
            journal_fail(&journal, "write");
        append(&journal, first, strlen(first));
        sync_now(&journal);
    } else if (ftruncate(journal.file, (off_t)take(&journal, first))) {
        journal_fail(&journal, "write");
    }
    return journal;
}

void journal_add(Journal *journal, const RunResult *result, int results)
{
    Text text = {.pool = journal->pool};
    for (int i = 0; i < results; ++i) {
        text_print(&text, "%s", line_of(journal->pool, &result[i]));
        note(journal, &result[i]);
    }
    append(journal, text.s, text.size);
    if (clock_seconds(CLOCK_MONOTONIC) - journal->synced >= behind_most)
        sync_now(journal);
}

void journal_close(Journal *journal)
{
    if (journal->behind)
        sync_now(journal);
    if (journal->series)
        series_close(journal->series);
    caught_disown(journal->held);
    close(journal->file);
}

void journal_remove(Journal *journal)
{
    unlink(journal->path);
    if (journal->series)
        series_remove(journal->series);
    journal->behind = false;
    journal_close(journal);
}
