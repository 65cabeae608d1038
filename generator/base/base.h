/* SPDX-License-Identifier: MIT
 *
 * base: memory, text, files, messages for people, YAML as a tree, small vectors, tables. Every other folder stands on
 * it.
 *
 * Conventions. Memory comes from a Pool that lives as long as the program's main context: nothing is freed one by one.
 * Bad input ends in diag_fail(), which prints one message and exits with status 1. Vectors are double[3], matrices
 * row-major, Euler parameters (e0, e1, e2, e3). SI units. */
#ifndef BASE_BASE_H
#define BASE_BASE_H

#include "base/vec3.h"

#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* ---- memory.c: memory, text, random numbers */

typedef struct Pool Pool;

Pool *pool_new(void);                      /* an empty pool; exits with a message when memory is out */
void pool_free(Pool *pool);                /* frees the pool and all that came from it */
void *pool_alloc(Pool *pool, size_t size); /* zeroed, aligned for any type */
void *pool_grow(Pool *pool, void *old, size_t old_size, size_t size); /* copy into a larger block */
char *pool_print(Pool *pool, const char *format, ...) __attribute__((format(printf, 2, 3)));
char *pool_vprint(Pool *pool, const char *format, va_list args);

/* Print that memory is out and exit with status 1; every allocation of a Pool ends here if it fails. */
_Noreturn void out_of_memory(void);

/* Make room for one more element after the first `count` of `array`; the capacity doubles. */
#define POOL_PUSH(pool, array, count) \
    ((((count) & (-1 + (count))) == 0 \
          ? (void)((array) = pool_grow((pool), (array), (size_t)(count) * sizeof *(array), \
                                       (size_t)((count) ? 2 * (count) : 1) * sizeof *(array))) \
          : (void)0), \
     &(array)[(count)++])

/* A growing text; `s` is always terminated. */
typedef struct Text {
    Pool *pool;
    char *s;
    size_t size, room;
} Text;

void text_print(Text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
void text_add(Text *text, const char *s, size_t size);
/* Append text to HTML: characters with a meaning in HTML become entities. */
void text_html(Text *text, const char *s);
/* FNV-1a hash of `size` bytes: the same on every machine. */
uint64_t text_hash(const char *s, size_t size);

/* splitmix64: the same sequence on every machine. */
typedef struct Random {
    uint64_t state;
} Random;

uint64_t random_bits(Random *random);
double random_uniform(Random *random, double low, double high);

/* ---- vector.c, and vec3.h: small vector algebra */

void mat_from_euler(const double p[4], double A[9]);                       /* A(p) of FORMAT.md section 1 */
void euler_relative(const double p0[4], const double p[4], double out[4]); /* Euler parameters of A(p0)^T A(p) */

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
/* True if files written at the two paths would be one file, there already or not. NULL, "-" and devices are nobody's.
 */
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

enum { SIGNAL_MOST = 64 /* the largest signal number */ };

/* The signals that end the program by default: requests to stop, alarms, limits, and those of a failing write; without
 * those that the parent process set to be ignored (nohup). */
sigset_t stop_signals(void);

/* ---- message.c: messages for people */

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
    struct Named *named;  /* the files that this file names: source.c */
} Source;

/* Print `path:line:col: error: <message>`, the source line with a caret under the column, in a mirror image
 * `  note: mirrored from '<entry>'`, and `  remedy: <remedy>` (remedy may be NULL), all to stderr; exit with status 1.
 */
_Noreturn void diag_fail(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The same as a warning; returns. */
void diag_warn(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The source line of a place; the text after the line follows. */
const char *diag_line(Place at);
/* The place of a byte of a source: its line, and its column in characters (UTF-8). */
Place diag_place(const Source *source, size_t offset);
/* The word of `count` words that is nearest to `word` (edit distance); NULL if none is near. */
const char *diag_nearest(const char *word, const char *const *words, int count);

/* ---- source.c: input files and those that they name */

/* Read a file as file_read() does. by: the file that names it; NULL: the user does. */
Source *source_read(Pool *pool, const char *path, size_t most, const Source *by);
/* Exit with a message if the file to be written is this input or a file that it names. */
void source_keep(const Source *source, const char *output);
/* A hash of the contents of this file and of all files that it names. */
uint64_t source_hash(const Source *source);

/* ---- yaml.c: YAML into a tree that knows its places */

typedef enum ItemKind { ITEM_SCALAR, ITEM_LIST, ITEM_MAP } ItemKind;

typedef struct Item {
    ItemKind kind;
    Place at;
    const char *text;    /* scalar: its text (may hold any byte but is terminated) */
    bool quoted;         /* scalar: written in quotes, so never a number */
    bool negated;        /* scalar: of a mirror image; its number is -(written + shift) */
    bool mirrored;       /* scalar: of a mirror image, whose formulas read the quantities of the other side */
    double shift;        /* scalar: of a moved file; its number is written + shift */
    int count;           /* list: elements; map: pairs */
    struct Item **value; /* list: the elements; map: the values */
    struct Item **key;   /* map: the keys, all scalars */
} Item;

/* Parse a file ("-": standard input) into a tree. YAML errors, aliases to ancestors, duplicate keys, nesting deeper
 * than 64 and more than one document end in diag_fail. */
const Item *doc_read(Pool *pool, const char *path);
/* The same for a file that the item `by` of another file names. If it contains no word of the NULL-terminated list
 * `key`, it is not a file of that kind: the message then shows nothing of its contents. */
const Item *doc_read_named(Pool *pool, const char *path, const Item *by, const char *const *key);
/* Value of a key of a map, or NULL. */
const Item *doc_find(const Item *map, const char *key);

/* Does a scalar look like a decimal number? */
bool doc_is_decimal(const Item *item);

/* Checked access for readers of `.veh` and scene files; each ends in diag_fail naming what was expected. `what` names
 * the thing in messages ("mass of body 'chassis'"). */
double doc_number(const Item *item, const char *what);
bool doc_bool(const Item *item, const char *what);
const char *doc_word(const Item *item, const char *what);
void doc_vector(const Item *item, const char *what, double *out, int size);
/* Every key of `map` must be one of `allowed`; the message lists them and suggests the nearest. */
void doc_check_keys(const Item *map, const char *what, const char *const *allowed, int count);

/* y over increasing x; with slopes, a monotone cubic (FORMAT.md section 6). */
typedef struct Table {
    const char *name;
    Place at;
    int count;
    double *x, *y, *slope;
    bool cubic;
    bool onward; /* beyond the ends: linear with the end's slope; else constant */
    bool read;   /* a formula or another entry names it */
} Table;

/* ---- interpolate.c: tables of FORMAT.md section 7 */

/* Slopes of the monotone cubic (Fritsch and Carlson), from x and y. */
void table_slopes(Table *table);
double table_value(const Table *table, double x);

/* A number as C source that reads back bit-exactly: R(0.5). */
const char *emit_number(Pool *pool, double value);
/* The same with text before and after it. */
const char *emit_number_within(Pool *pool, const char *before, double value, const char *after);

#endif
