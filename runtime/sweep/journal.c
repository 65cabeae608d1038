/* SPDX-License-Identifier: MIT
 * The journal of a sweep: lines are appended, never changed, and written to the disk before the next batch begins.
 * The first line identifies the sweep; an incomplete last line is ignored. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static _Noreturn void journal_fail(const Journal *journal, const char *what)
{
    diag_fail(program_place(), file_remedy(errno), "can't %s %s: %s", what, journal->path, strerror(errno));
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
    if (fsync(journal->file) && errno != EINVAL) /* not every file system knows it */
        journal_fail(journal, "write");
}

static void note(Journal *journal, const RunResult *result)
{
    if (journal->row[result->run])
        return;
    journal->row[result->run] = result->row;
    ++journal->finished;
    journal->failed += result->status != GIC_OK;
    if (result->status != GIC_OK && (journal->first_status == GIC_OK || result->run < journal->first_failed)) {
        journal->first_status = result->status;
        journal->first_failed = result->run;
        journal->first_reason = result->reason;
    }
}

/* "run status row"; false: the line has another form. */
static bool take_line(Journal *journal, const char *line)
{
    char *end;
    const long long run = strtoll(line, &end, 10);
    if (end == line || *end != ' ' || run < 0 || run >= journal->runs)
        return false;
    const char *next = end + 1;
    const long status = strtol(next, &end, 10);
    if (end == next || *end != ' ')
        return false;
    note(journal, &(RunResult){run, (int)status, end + 1, NULL});
    return true;
}

static _Noreturn void refuse_foreign(const Journal *journal)
{
    diag_fail(program_place(), "remove it, or choose another place with -o",
              "%s is of another sweep: another model, scene, file that they name, range, compiler or program",
              journal->path);
}

/* What is in the file: whole lines. */
static void take(Journal *journal, const char *first)
{
    size_t size;
    const char *bytes = file_read(journal->pool, journal->path, SIZE_MAX, &size);
    char *text = pool_alloc(journal->pool, size + 1);
    memcpy(text, bytes, size);
    if (strncmp(text, first, strlen(first)) != 0)
        refuse_foreign(journal);
    size_t good = strlen(first);
    for (char *end; (end = strchr(text + good, '\n')); good = (size_t)(end + 1 - text)) {
        *end = 0;
        if (!take_line(journal, text + good))
            break;
    }
    if (ftruncate(journal->file, (off_t)good))
        journal_fail(journal, "write");
}

/* Where a failure ends a call and not the program. */
static void let_go(void *held)
{
    close(*(const int *)held);
}

Journal journal_open(Pool *pool, const char *results, const char *key, int64_t runs)
{
    Journal journal = {.pool = pool, .path = pool_print(pool, "%s.journal", results), .runs = runs};
    const char *first = pool_print(pool, "gicsweep journal %s\n", key);
    journal.row = pool_alloc(pool, sizeof *journal.row * (size_t)runs);
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
    const off_t size = lseek(journal.file, 0, SEEK_END);
    if (size < (off_t)strlen(first)) {
        const char *bytes = file_read(journal.pool, journal.path, SIZE_MAX, &(size_t){0});
        if (strncmp(bytes, first, (size_t)size) != 0)
            refuse_foreign(&journal);
        if (ftruncate(journal.file, 0))
            journal_fail(&journal, "write");
        append(&journal, first, strlen(first));
    } else {
        take(&journal, first);
    }
    return journal;
}

void journal_add(Journal *journal, const RunResult *result, int results)
{
    Text text = {.pool = journal->pool};
    for (int i = 0; i < results; ++i) {
        text_print(&text, "%lld %d %s\n", (long long)result[i].run, result[i].status, result[i].row);
        note(journal, &result[i]);
    }
    append(journal, text.s, text.size);
}

void journal_close(const Journal *journal)
{
    caught_disown(journal->held);
    close(journal->file);
}

void journal_remove(Journal *journal)
{
    unlink(journal->path);
    journal_close(journal);
}
