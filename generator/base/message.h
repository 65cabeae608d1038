/* SPDX-License-Identifier: MIT
 *
 * Messages for people, and the input files that they name. Bad input ends in diag_fail(), which prints one message and
 * exits with status 1. */
#ifndef BASE_MESSAGE_H
#define BASE_MESSAGE_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- message.c */

/* A place in an input file. line and column count from 1; 0: the file as a whole. */
typedef struct Place {
    const struct Source *source;
    int line, column;
} Place;

typedef struct Source {
    const char *path; /* as the user gave it */
    const char *bytes;
    size_t size;
    const char *mirrored; /* of a mirror image: the entry it was made from, at whose place it is reported; NULL: the
                           * entry itself */
    bool hidden;          /* messages show no text of this file: it is not yet known to be a file of the expected kind
                           */
    Place named_at;       /* where another file names it; no source: the user does */
    struct Named *named;  /* the files that this file names: source.c */
    const struct Source *known; /* an earlier reading, whose bytes and those of the files that it names are taken; NULL:
                                 * files are read */
} Source;

/* Each of the following goes to who catches it, where someone does: catch.h.
 * Print `path:line:col: error: <message>`, the source line with a caret under the column, in a mirror image
 * `  note: mirrored from '<entry>'`, in a file that others include where they do, and `  remedy: <remedy>` (remedy may
 * be NULL), all to stderr; exit with status 1.
 */
_Noreturn void diag_fail(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The same as a warning; returns. */
void diag_warn(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The same as diag_fail() for a mistake of who calls; exit status 2. */
_Noreturn void diag_fail_call(Place at, const char *remedy, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same for an error that another process found and told in full. */
_Noreturn void diag_fail_as(const char *printed);
/* Print a text for people as it is, such as what another program said; the lines end in it. */
void diag_note(const char *text);
/* The same for a text that is a result: to standard output. */
void diag_text(const char *text);
/* How far the work is, in a few words, for who listens; "": it is over. */
void diag_progress(const char *text);
/* The source line of a place; the text after the line follows. */
const char *diag_line(Place at);
/* The place of a byte of a source: its line, and its column in characters (UTF-8). */
Place diag_place(const Source *source, size_t offset);
/* The word of `count` words that is nearest to `word` (edit distance); NULL if none is near. */
const char *diag_nearest(const char *word, const char *const *words, int count);

/* ---- source.c: input files and those that they name */

/* Read a file as file_read() does. by: the file that names it; NULL: the user does. */
Source *source_read(Pool *pool, const char *path, size_t most, const Source *by);
/* The same from a text in memory, zero-terminated after `size` bytes, in place of the file. */
Source *source_text(Pool *pool, const char *path, const char *text, size_t size);
/* The same from the bytes of an earlier reading; files that it names too. */
Source *source_again(Pool *pool, const Source *known);
/* Exit with a message if the file to be written is this input or a file that it names. */
void source_keep(const Source *source, const char *output);
/* A hash of the contents of this file and of all files that it names. */
uint64_t source_hash(const Source *source);

#endif
