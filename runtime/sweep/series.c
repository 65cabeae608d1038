/* SPDX-License-Identifier: MIT
 * Outputs over time of the runs of a sweep, while it is made: each run has its place in the file, a checksum and its
 * numbers, so that processes write without knowing of each other and a run that is made again replaces itself. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static _Noreturn void series_fail(const Series *series, const char *what)
{
    diag_fail(program_place(), file_remedy(errno), "can't %s %s: %s", what, series->path, strerror(errno));
}

const char *series_path(Pool *pool, const char *journal)
{
    static const char end[] = ".journal";
    return pool_print(pool, "%.*s.series", (int)(strlen(journal) - strlen(end)), journal);
}

/* Where a failure ends a call and not the program. */
static void let_go(void *held)
{
    close(*(const int *)held);
}

static Series *series_new(Pool *pool, const char *path, const SweepForm *form, int64_t first, int flags)
{
    Series *series = pool_alloc(pool, sizeof *series);
    *series = (Series){path, open(path, flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666),
                       pool_alloc(pool, sizeof *series->held), first, (size_t)form->series * (size_t)form->samples};
    struct stat is;
    if (series->file < 0 && (flags & O_CREAT || errno != ENOENT))
        series_fail(series, "open");
    if (series->file >= 0 && (fstat(series->file, &is) || !S_ISREG(is.st_mode)))
        diag_fail(program_place(), "remove it, or choose another place with -o", "%s is no file", path);
    *series->held = series->file;
    if (series->file >= 0)
        caught_own(let_go, series->held);
    return series;
}

Series *series_open(Pool *pool, const char *path, const SweepForm *form, int64_t first)
{
    return series_new(pool, path, form, first, O_RDWR | O_CREAT);
}

Series *series_read(Pool *pool, const char *path, const SweepForm *form, int64_t first)
{
    return series_new(pool, path, form, first, O_RDONLY);
}

static off_t place_of(const Series *series, int64_t run)
{
    return (off_t)((run - series->first) * (int64_t)(sizeof(uint64_t) + series->numbers * sizeof(double)));
}

/* Never 0, which is what a place has that was not written. */
static uint64_t checksum(const Series *series, int64_t run, const double *value)
{
    return (text_hash((const char *)value, series->numbers * sizeof *value) ^ (uint64_t)run) | 1;
}

static void put(const Series *series, off_t at, const void *from, size_t size)
{
    for (const char *bytes = from; size;) {
        const ssize_t n = pwrite(series->file, bytes, size, at);
        if (n < 0 && errno != EINTR)
            series_fail(series, "write");
        bytes += n < 0 ? 0 : n;
        at += n < 0 ? 0 : n;
        size -= n < 0 ? 0 : (size_t)n;
    }
}

void series_put(const Series *series, int64_t run, const double *value)
{
    const uint64_t sum = checksum(series, run, value);
    const off_t at = place_of(series, run);
    put(series, at, &sum, sizeof sum);
    put(series, at + (off_t)sizeof sum, value, series->numbers * sizeof *value);
}

static bool get(const Series *series, off_t at, void *to, size_t size)
{
    for (char *bytes = to; size;) {
        const ssize_t n = pread(series->file, bytes, size, at);
        if (n < 0 && errno != EINTR)
            series_fail(series, "read");
        if (!n)
            return false;
        bytes += n < 0 ? 0 : n;
        at += n < 0 ? 0 : n;
        size -= n < 0 ? 0 : (size_t)n;
    }
    return true;
}

bool series_get(const Series *series, int64_t run, double *value)
{
    uint64_t sum = 0;
    const off_t at = place_of(series, run);
    return series->file >= 0 && get(series, at, &sum, sizeof sum) &&
           get(series, at + (off_t)sizeof sum, value, series->numbers * sizeof *value) &&
           sum == checksum(series, run, value);
}

void series_sync(const Series *series)
{
    if (fsync(series->file) && errno != EINVAL) /* not every file system knows it */
        series_fail(series, "write");
}

void series_close(const Series *series)
{
    if (series->file < 0)
        return;
    caught_disown(series->held);
    close(series->file);
}

void series_remove(const Series *series)
{
    unlink(series->path);
}
