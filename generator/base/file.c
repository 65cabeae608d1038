/* SPDX-License-Identifier: MIT
 * Whole files, read and written. */
#include "base/catch.h"
#include "base/file.h"
#include "base/message.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *file_remedy(int reason)
{
    switch (reason) {
    case EACCES:
    case EPERM:
        return "`ls -ld` on it and its folder shows who may: get the right (chmod, chown), or name another place";
    case ENOENT: return "check the path; folders on the way to a file must exist";
    case ENOTDIR: return "check the path: one of the folders on the way is a file";
    case EISDIR: return "that is a folder: name a file in it";
    case EROFS: return "that file system is read-only: name another place";
    case ENOSPC:
    case EDQUOT: return "make room on the disk, or name another place";
    default: return "name another place";
    }
}

static _Noreturn void file_fail(const char *path, const char *what)
{
    diag_fail((Place){&(Source){.path = path}, 0, 0}, file_remedy(errno), "%s: %s", what, strerror(errno));
}

bool file_is_special(const char *path)
{
    struct stat is;
    return !stat(path, &is) && !S_ISREG(is.st_mode) && !S_ISDIR(is.st_mode);
}

/* Identity of the folder in which `path` stands, and the name there. */
static const char *find_folder(const char *path, struct stat *folder)
{
    const char *slash = strrchr(path, '/');
    Pool *pool = pool_new();
    const char *name = slash ? pool_print(pool, "%.*s", (int)(slash - path + 1), path) : ".";
    const bool there = !stat(name, folder);
    pool_free(pool);
    return there ? slash ? slash + 1 : path : NULL;
}

bool files_are_one(const char *path, const char *other)
{
    if (!path || !other || !strcmp(path, "-") || !strcmp(other, "-") || file_is_special(path))
        return false;
    struct stat a, b;
    if (!stat(path, &a) && !stat(other, &b))
        return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
    const char *name = find_folder(path, &a), *other_name = find_folder(other, &b);
    return name && other_name && a.st_dev == b.st_dev && a.st_ino == b.st_ino && !strcmp(name, other_name);
}

bool path_ends(const char *path, const char *end)
{
    const size_t n = strlen(path), m = strlen(end);
    return n > m && !strcmp(path + n - m, end);
}

/* A file that is being written under a temporary name. Until it is renamed, signals that would leave the temporary file
 * behind are held back, and so is the signal of a failing write, which would come before the message. */
typedef struct Moving {
    const char *path;
    char *name;                 /* the temporary name; NULL: not made yet, or renamed */
    const struct Moving *other; /* a second file that is written together with this one; NULL: none */
} Moving;

/* Remove temporary files, then exit with a message about a file that can't be written. */
static _Noreturn void write_fail(const Moving *moving, const char *what)
{
    const int reason = errno;
    if (moving->name)
        remove(moving->name);
    if (moving->other && moving->other->name)
        remove(moving->other->name);
    errno = reason;
    file_fail(moving->path, what);
}

static void temporary_write(Pool *pool, Moving *moving, const char *bytes, size_t size)
{
    char *name;
    FILE *file = temporary_open(pool, moving->path, &name);
    if (!file)
        write_fail(moving, "can't create");
    moving->name = name;
    const bool written = fwrite(bytes, 1, size, file) == size;
    if (fclose(file) || !written)
        write_fail(moving, "can't write");
}

static void temporary_move(Moving *moving)
{
    if (rename(moving->name, moving->path))
        write_fail(moving, "can't write");
    moving->name = NULL;
}

/* Write one file, or two if other_path is not NULL, and rename them when both are complete. */
static void move_in(Moving *first, const char *bytes, size_t size, const char *other_path, const Text *other)
{
    Pool *pool = pool_new(); /* allocated before any temporary file exists, since allocation may exit */
    Moving second = {.path = other_path, .other = first};
    const sigset_t stop = stop_signals();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &stop, &before);
    temporary_write(pool, first, bytes, size);
    if (other_path)
        temporary_write(pool, &second, other->s, other->size);
    first->other = &second;
    temporary_move(first);
    if (other_path)
        temporary_move(&second);
    pool_free(pool);
    sigprocmask(SIG_SETMASK, &before, NULL);
}

void file_check(const char *path)
{
    struct stat is;
    if (!strcmp(path, "-"))
        return;
    if (file_is_special(path)) {
        if (access(path, W_OK))
            file_fail(path, "can't open");
        return;
    }
    if (!stat(path, &is) && S_ISDIR(is.st_mode)) {
        errno = EISDIR;
        file_fail(path, "can't create");
    }
    Pool *pool = pool_new();
    Moving moving = {.path = path};
    const sigset_t stop = stop_signals();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &stop, &before);
    temporary_write(pool, &moving, "", 0);
    remove(moving.name);
    sigprocmask(SIG_SETMASK, &before, NULL);
    pool_free(pool);
}

void file_write(const char *path, const char *bytes, size_t size)
{
    if (!strcmp(path, "-")) {
        if (fwrite(bytes, 1, size, stdout) != size || fflush(stdout))
            file_fail("standard output", "can't write");
        return;
    }
    if (file_is_special(path)) {
        FILE *device = fopen(path, "wb");
        if (!device)
            file_fail(path, "can't open");
        const bool all = fwrite(bytes, 1, size, device) == size;
        if (fclose(device) || !all)
            file_fail(path, "can't write");
        return;
    }
    move_in(&(Moving){.path = path}, bytes, size, NULL, NULL);
}

void file_write_both(const char *path, const Text *text, const char *other_path, const Text *other)
{
    if (file_is_special(path) || file_is_special(other_path)) {
        file_write(path, text->s, text->size);
        file_write(other_path, other->s, other->size);
        return;
    }
    move_in(&(Moving){.path = path}, text->s, text->size, other_path, other);
}

static void close_file(void *file)
{
    fclose(file);
}

char *file_read(Pool *pool, const char *path, size_t most, size_t *size)
{
    bool standard = !strcmp(path, "-");
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (!file)
        file_fail(path, "can't open");
    if (!standard)
        caught_own(close_file, file);
    Text text = {.pool = pool};
    char buffer[1 << 14];
    for (size_t n; text.size <= most && (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
        text_add(&text, buffer, n);
    if (ferror(file))
        file_fail(path, "can't read");
    if (text.size > most)
        diag_fail((Place){&(Source){.path = path}, 0, 0}, "is it the file that was meant?",
                  "larger than the %zu MB that are read of such a file", most >> 20);
    if (!standard) {
        caught_disown(file);
        fclose(file);
    }
    text_add(&text, "", 0);
    *size = text.size;
    return text.s;
}
