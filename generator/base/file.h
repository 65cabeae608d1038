/* SPDX-License-Identifier: MIT
 *
 * Files: read and written as a whole, temporary names, signals that stop a program. */
#ifndef BASE_FILE_H
#define BASE_FILE_H

#include "base/text.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>

/* ---- file.c */

/* Write a file under a temporary name beside it, then rename it: readers see all of it or the old one. "-" is standard
 * output. Exits with a message that names the file if it can't be written. */
void file_write(const char *path, const char *bytes, size_t size);
/* The same for two files that belong together: if one can't be written, neither is replaced. */
void file_write_both(const char *path, const Text *text, const char *other_path, const Text *other);
/* Call before long work whose result file_write will write: exits with a message if no file can be made at `path`. */
void file_check(const char *path);
/* The remedy for an errno of opening, reading or writing a file. */
const char *file_remedy(int reason);
/* True if `path` is a device or a pipe. Such a file is written in place: a rename would replace it. */
bool file_is_special(const char *path);
/* True if both paths name one file, which need not exist yet. False for NULL, "-" and devices. */
bool files_are_one(const char *path, const char *other);
/* True if `path` ends with `end` and has at least one character before it. */
bool path_ends(const char *path, const char *end);
enum {
    TEXT_MOST = 4 << 20,   /* bytes of a file that people write: a model with all included files, a scene, a tire */
    KEYS_MOST = 10000,     /* keys of one map, which is searched linearly */
    TABLE_MOST = 512 << 20 /* bytes of a file that programs write, such as a table */
};

/* All bytes of a file ("-": standard input), zero-terminated. Exits with a message if the file can't be read or has
 * more than `most` bytes: devices and pipes may never end. */
char *file_read(Pool *pool, const char *path, size_t most, size_t *size);

/* ---- temporary.c */

/* Open a new file beside `path` for writing. Its name is random (*name) and did not exist, so no link is followed. NULL
 * with errno set if it can't be made. The caller renames it to `path` or removes it. */
FILE *temporary_open(Pool *pool, const char *path, char **name);
/* Remove temporary files of `path` that programs which were killed have left. For one that alone may write it now. */
void temporary_clear(Pool *pool, const char *path);

enum { SIGNAL_MOST = 64 /* the largest signal number */ };

/* The signals that end the program by default: requests to stop, alarms, limits, and those of a failing write; without
 * those that the parent process set to be ignored (nohup). */
sigset_t stop_signals(void);

#endif
