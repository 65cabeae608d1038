/* SPDX-License-Identifier: MIT
 *
 * YAML as a tree that knows its places. */
#ifndef BASE_YAML_H
#define BASE_YAML_H

#include "base/message.h"

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
/* The same for a text that stands in memory; path: of the file that it is in place of. */
const Item *doc_read_text(Pool *pool, const char *path, const char *text, size_t size);
/* The same for the bytes of an earlier reading. */
const Item *doc_read_again(Pool *pool, const Source *known);
/* The same for a file that the item `by` of another file names. If it contains no word of the NULL-terminated list
 * `key`, it is not a file of that kind: the message then shows nothing of its contents. */
const Item *doc_read_named(Pool *pool, const char *path, const Item *by, const char *const *key);
/* Value of a key of a map, or NULL. */
const Item *doc_find(const Item *map, const char *key);

/* True if a scalar looks like a decimal number. */
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
