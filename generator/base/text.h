/* SPDX-License-Identifier: MIT
 *
 * Texts that grow, and numbers as C source. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include "base/pool.h"

#include <stdint.h>

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

/* A number as C source that reads back bit-exactly: R(0.5). */
const char *emit_number(Pool *pool, double value);
/* The same with text before and after it. */
const char *emit_number_within(Pool *pool, const char *before, double value, const char *after);

#endif
