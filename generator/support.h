/* SPDX-License-Identifier: MIT
 *
 * What every stage of the generator stands on: memory, text, messages, and YAML as a tree. */
#ifndef GICGEN_SUPPORT_H
#define GICGEN_SUPPORT_H

#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* ---- util.c: memory, text, random numbers, small vector algebra ------------------------------- */

typedef struct Pool Pool;

Pool *pool_new(void);                      /* an empty pool; exits with a message when memory is out */
void pool_free(Pool *pool);                /* frees the pool and all that came from it */
void *pool_alloc(Pool *pool, size_t size); /* zeroed, aligned for any type */
void *pool_grow(Pool *pool, void *old, size_t old_size, size_t size); /* copy into a larger block */
char *pool_print(Pool *pool, const char *format, ...) __attribute__((format(printf, 2, 3)));
char *pool_vprint(Pool *pool, const char *format, va_list args);

/* What every allocation of a Pool does where there is no memory: one message, exit status 1. */
_Noreturn void out_of_memory(void);

/* Make room for one more element behind the first `count` of `array`; sizes double. */
#define POOL_PUSH(pool, array, count) \
    ((((count) & ((count)-1)) == 0 \
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
/* A text for HTML: what means something there as an entity. */
void text_html(Text *text, const char *s);
/* FNV-1a of so many bytes: the same on every machine. */
uint64_t text_hash(const char *s, size_t size);

/* splitmix64: the same sequence on every machine. */
typedef struct Random {
    uint64_t state;
} Random;

uint64_t random_bits(Random *random);
double random_uniform(Random *random, double low, double high);

double vec_dot(const double a[3], const double b[3]);
void vec_cross(const double a[3], const double b[3], double out[3]); /* out may not alias */
double vec_norm(const double a[3]);
void mat_from_euler(const double p[4], double A[9]);                            /* A(p) of FORMAT.md section 1 */
void euler_relative(const double p0[4], const double p[4], double out[4]);      /* of A(p0)^T A(p) */
void mat_apply(const double A[9], const double x[3], double out[3]);            /* A x */
void mat_apply_transposed(const double A[9], const double x[3], double out[3]); /* A^T x */

/* Write a whole file under a temporary name beside it and rename it: readers see all of it or the old one.
 * "-" is standard output. Exits with a message naming the file when it can't be written. */
void file_write(const char *path, const char *bytes, size_t size);
/* The same with two files that belong together: neither is replaced where one can't be written. */
void file_write_both(const char *path, const Text *text, const char *other_path, const Text *other);
/* Before long work whose result file_write will write: ends with a message where no file can be made at `path`. */
void file_check(const char *path);
/* What to do about an errno of opening, reading or writing a file. */
const char *file_remedy(int reason);
/* Is there something at `path` that is no file, a device or pipe? It is written to as it is: a rename would replace it.
 */
bool file_is_special(const char *path);
/* Does a path end so, with something before it? */
bool path_ends(const char *path, const char *end);
enum {
    TEXT_MOST = 4 << 20,   /* bytes of a model with all that it includes, of a scene, of a tire: for people to write */
    KEYS_MOST = 10000,     /* of one map, which is looked through from its beginning */
    TABLE_MOST = 512 << 20 /* bytes of tables and other files that programs write */
};

/* All bytes of a file ("-": standard input), terminated. Exits with a message when it can't be read, or has more than
 * `most` bytes: devices and pipes may never end. */
char *file_read(Pool *pool, const char *path, size_t most, size_t *size);

/* ---- temporary.c -------------------------------------------------------------------------------- */

/* A new file beside `path`, open for writing, whose random name *name nobody has put there before: no link is followed.
 * NULL with errno: it can't be made. The caller renames it to `path`, or removes it. */
FILE *temporary_open(Pool *pool, const char *path, char **name);

enum { SIGNAL_MOST = 64 /* the greatest number of a signal */ };

/* The signals that would end the program where it stands, unless whoever started it wants them ignored (nohup): those
 * that ask to stop, alarms and limits, and those of a write that fails. */
sigset_t stop_signals(void);

/* ---- diag.c: messages for people ---------------------------------------------------------------- */

/* A place in an input file. line and column count from 1; 0: the file as a whole. */
typedef struct Place {
    const struct Source *source;
    int line, column;
} Place;

typedef struct Source {
    const char *path; /* as the user gave it */
    const char *bytes;
    size_t size;
    const char *mirrored; /* its places stand for the mirror image of this entry; NULL: for what is written there */
    bool hidden;          /* messages show places in it, but not what stands there: nobody knows yet what file it is */
    struct Named *named;  /* the files that it names: source.c */
} Source;

/* Print `path:line:col: error: <message>`, the source line with a caret under the column, in a mirror image
 * `  note: mirrored from '<entry>'`, and `  remedy: <remedy>` (remedy may be NULL), all to stderr; exit with status 1.
 */
_Noreturn void diag_fail(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The same as a warning; returns. */
void diag_warn(Place at, const char *remedy, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The line of a place, to its end and on. */
const char *diag_line(Place at);
/* The place of a byte of a source: its line, and its column in characters (UTF-8). */
Place diag_place(const Source *source, size_t offset);
/* Of `count` words the one most like `word` (edit distance), or NULL when none is near. */
const char *diag_nearest(const char *word, const char *const *words, int count);

/* ---- source.c: input files and those that they name ---------------------------------------------- */

/* Read a file as file_read() does; by: the file that names it, NULL: the user does. */
Source *source_read(Pool *pool, const char *path, size_t most, const Source *by);
/* End with a message where a file to be written is this input, or one that it names. */
void source_keep(const Source *source, const char *output);
/* A hash of what stands in it and in all files that it names. */
uint64_t source_hash(const Source *source);

/* ---- doc.c: YAML into a tree that knows its places ---------------------------------------------- */

typedef enum ItemKind { ITEM_SCALAR, ITEM_LIST, ITEM_MAP } ItemKind;

typedef struct Item {
    ItemKind kind;
    Place at;
    const char *text;    /* scalar: its text (may hold any byte but is terminated) */
    bool quoted;         /* scalar: quoted, so never a number */
    bool negated;        /* scalar: of a mirror image; its number is -(written + shift) */
    double shift;        /* scalar: of a moved file; its number is written + shift */
    int count;           /* list: elements; map: pairs */
    struct Item **value; /* list: the elements; map: the values */
    struct Item **key;   /* map: the keys, all scalars */
} Item;

/* Parse a file ("-": standard input) into a tree. YAML errors, aliases to ancestors, duplicate keys, nesting deeper
 * than 64 and more than one document end in diag_fail. */
const Item *doc_read(Pool *pool, const char *path);
/* The same for a file that another one names, in the item `by`. Where no word of the list `key`, which ends with NULL,
 * stands in it, it is no such file, and the message shows nothing of it. */
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

#endif
