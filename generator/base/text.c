/* SPDX-License-Identifier: MIT
 * Texts that grow. */
#include "base/text.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void text_reserve(Text *text, size_t more)
{
    if (text->size + more + 1 <= text->room)
        return;
    size_t room = text->room ? text->room : 256;
    while (room < text->size + more + 1)
        room *= 2;
    text->s = pool_grow(text->pool, text->s, text->size, room);
    text->room = room;
}

void text_add(Text *text, const char *s, size_t size)
{
    text_reserve(text, size);
    if (size > 0) /* an empty text has no place yet */
        memcpy(text->s + text->size, s, size);
    text->size += size;
    text->s[text->size] = 0;
}

void text_html(Text *text, const char *s)
{
    for (; *s; ++s)
        switch (*s) {
        case '&': text_print(text, "&amp;"); break;
        case '<': text_print(text, "&lt;"); break;
        case '>': text_print(text, "&gt;"); break;
        case '"': text_print(text, "&quot;"); break;
        default: text_add(text, s, 1);
        }
}

uint64_t text_hash(const char *s, size_t size)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; ++i)
        hash = (hash ^ (unsigned char)s[i]) * 0x100000001b3u;
    return hash;
}

void text_print(Text *text, const char *format, ...)
{
    text_reserve(text, 120); /* enough for most prints */
    for (bool again = false;; again = true) {
        va_list args;
        va_start(args, format);
        size_t size = (size_t)vsnprintf(text->s + text->size, text->room - text->size, format, args);
        va_end(args);
        if (again || text->size + size < text->room) {
            text->size += size;
            return;
        }
        text_reserve(text, size);
    }
}
