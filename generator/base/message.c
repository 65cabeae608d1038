/* SPDX-License-Identifier: MIT
 * Messages for people: a place, what is wrong there, the line with a caret, what to write instead. */
#include "base/message.h"
#include "base/catch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MESSAGE = 1000,   /* bytes of one message */
    WINDOW = 160,     /* characters shown of a long line */
    WINDOW_LEAD = 80, /* of these, characters before the caret */
    WORD = 64         /* longer words are not compared */
};

/* Length in bytes of the line break at s; 0: none. Line breaks are those of YAML, so that line numbers match the
 * parser's. */
static size_t line_break(const char *s, const char *end)
{
    size_t left = (size_t)(end - s);
    if (left >= 2 && s[0] == '\r' && s[1] == '\n')
        return 2;
    if (left >= 1 && (s[0] == '\r' || s[0] == '\n'))
        return 1;
    if (left >= 2 && !memcmp(s, "\xc2\x85", 2))
        return 2;
    if (left >= 3 && (!memcmp(s, "\xe2\x80\xa8", 3) || !memcmp(s, "\xe2\x80\xa9", 3)))
        return 3;
    return 0;
}

/* Length in bytes of the UTF-8 character at s; *shown: true if it may be sent to a terminal. */
static size_t character(const char *s, const char *end, bool *shown)
{
    const unsigned char *u = (const unsigned char *)s;
    size_t size = u[0] < 0x80 ? 1 : u[0] >= 0xf0 ? 4 : u[0] >= 0xe0 ? 3 : 2;
    bool valid = u[0] < 0x80 || (u[0] >= 0xc2 && u[0] < 0xf5);
    if (size > (size_t)(end - s))
        valid = false;
    for (size_t i = 1; valid && i < size; ++i)
        valid = (u[i] & 0xc0) == 0x80;
    bool control = u[0] < 0x20 || u[0] == 0x7f || (valid && u[0] == 0xc2 && u[1] < 0xa0);
    *shown = valid && !control;
    return valid ? size : 1;
}

/* Where a message goes: to stderr at once, for memory may be out; or into a text, for one that is caught. */
typedef struct Out {
    bool kept;
    bool full; /* there was no memory for all of it */
    char *s;
    size_t size, room;
} Out;

static void put(Out *out, const char *s, size_t size)
{
    if (!out->kept) {
        fwrite(s, 1, size, stderr);
        return;
    }
    if (out->size + size + 1 > out->room) {
        const size_t room = 2 * (out->size + size + 1);
        char *grown = realloc(out->s, room);
        out->full = out->full || !grown;
        if (!grown)
            return;
        out->s = grown;
        out->room = room;
    }
    memcpy(out->s + out->size, s, size);
    out->size += size;
    out->s[out->size] = 0;
}

static void put_text(Out *out, const char *s)
{
    put(out, s, strlen(s));
}

static void put_character(Out *out, const char *s, size_t size, bool shown)
{
    put(out, shown ? s : "?", shown ? size : 1);
}

/* Names from a file may hold any byte: bytes that could control a terminal or start a new line become '?'. */
static void put_clean(Out *out, const char *s)
{
    const char *end = s + strlen(s);
    while (s < end) {
        bool shown;
        size_t size = character(s, end, &shown);
        put_character(out, s, size, shown);
        s += size;
    }
}

const char *diag_line(Place at)
{
    const char *s = at.source->bytes, *end = s + at.source->size;
    for (int line = 1; line < at.line && s < end;) {
        size_t size = line_break(s, end);
        line += size > 0;
        s += size ? size : 1;
    }
    return s;
}

/* The source line of `at`, or a window of a long one, and a caret below the column. Tabs are repeated before the
 * caret, so that it stands right whatever their width. */
static void put_line(Out *out, Place at)
{
    const char *s = diag_line(at), *end = at.source->bytes + at.source->size;
    int first = at.column > WINDOW ? at.column - WINDOW_LEAD : 1;
    char blank[WINDOW + 1]; /* the space under the shown text; no Pool is used, because memory may be out */
    int blanks = 0;
    put_text(out, first > 1 ? "  ..." : "  ");
    for (int column = 1; s < end && !line_break(s, end); ++column) {
        bool shown;
        size_t size = character(s, end, &shown);
        bool tab = *s == '\t';
        if (column >= first + WINDOW) {
            put_text(out, "...");
            break;
        }
        if (column >= first)
            put_character(out, s, size, shown || tab);
        if (column >= first && column < at.column)
            blank[blanks++] = tab ? '\t' : ' ';
        s += size;
    }
    put_text(out, first > 1 ? "\n     " : "\n  ");
    put(out, blank, (size_t)blanks);
    put_text(out, "^\n");
}

static void put_message(Out *out, Place at, const char *kind, const char *remedy, const char *message)
{
    const bool placed = at.source && at.line > 0;
    char number[2 * 12 + 4];
    put_text(out, at.source ? at.source->path : "gicgen");
    put_text(out, ":");
    snprintf(number, sizeof number, "%d:%d:", at.line, at.column);
    put_text(out, placed ? number : "");
    put_text(out, " ");
    put_text(out, kind);
    put_text(out, ": ");
    put_clean(out, message);
    put_text(out, "\n");
    if (placed && !at.source->hidden)
        put_line(out, at);
    if (at.source && at.source->mirrored) {
        put_text(out, "  note: mirrored from '");
        put_text(out, at.source->mirrored);
        put_text(out, "'\n");
    }
    for (const Source *s = at.source; s && s->named_at.source; s = s->named_at.source) {
        snprintf(number, sizeof number, ":%d:%d\n", s->named_at.line, s->named_at.column);
        put_text(out, "  included at ");
        put_text(out, s->named_at.source->path);
        put_text(out, number);
    }
    if (remedy) {
        put_text(out, "  remedy: ");
        put_clean(out, remedy);
        put_text(out, "\n");
    }
}

/* Hand a message to who catches it. */
static void tell(Place at, MessageKind kind, bool call, const char *remedy, const char *text, const Out *printed)
{
    Out clean = {.kept = true}, way = {.kept = true};
    put_clean(&clean, text);
    put_clean(&way, remedy ? remedy : "");
    const bool full = printed->full || clean.full || way.full;
    caught_tell(&(Message){.kind = kind,
                           .call = call,
                           .file = at.source ? at.source->path : NULL,
                           .line = at.line,
                           .column = at.column,
                           .text = full      ? NULL
                                   : clean.s ? clean.s
                                             : "",
                           .remedy = remedy ? way.s : NULL,
                           .printed = printed->s});
    free(clean.s);
    free(way.s);
}

static void report(Place at, MessageKind kind, bool call, const char *remedy, const char *format, va_list args)
{
    char message[MESSAGE];
    Out out = {.kept = catching()};
    vsnprintf(message, sizeof message, format, args);
    put_message(&out, at, kind == MESSAGE_ERROR ? "error" : "warning", remedy, message);
    if (out.kept)
        tell(at, kind, call, remedy, message, &out);
    free(out.s);
}

_Noreturn void diag_fail(Place at, const char *remedy, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report(at, MESSAGE_ERROR, false, remedy, format, args);
    va_end(args);
    caught_fail();
    exit(1);
}

_Noreturn void diag_fail_call(Place at, const char *remedy, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report(at, MESSAGE_ERROR, true, remedy, format, args);
    va_end(args);
    caught_fail();
    exit(2);
}

void diag_warn(Place at, const char *remedy, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report(at, MESSAGE_WARNING, false, remedy, format, args);
    va_end(args);
}

_Noreturn void diag_fail_as(const char *printed)
{
    if (catching())
        caught_tell(&(Message){.kind = MESSAGE_ERROR, .text = printed, .printed = printed});
    else
        fputs(printed, stderr);
    caught_fail();
    exit(1);
}

void diag_note(const char *text)
{
    if (catching())
        caught_tell(&(Message){.kind = MESSAGE_NOTE, .text = text, .printed = text});
    else
        fputs(text, stderr);
}

void diag_text(const char *text)
{
    if (catching())
        caught_tell(&(Message){.kind = MESSAGE_TEXT, .text = text, .printed = text});
    else
        fputs(text, stdout);
}

void diag_progress(const char *text)
{
    if (catching())
        caught_tell(&(Message){.kind = MESSAGE_PROGRESS, .text = text, .printed = text});
}

Place diag_place(const Source *source, size_t offset)
{
    Place at = {source, 1, 1};
    const char *s = source->bytes, *end = s + source->size;
    const char *target = s + (offset < source->size ? offset : source->size);
    while (s < target) {
        bool shown;
        size_t size = line_break(s, end);
        if (size) {
            ++at.line;
            at.column = 1;
            s += size;
        } else {
            ++at.column;
            s += character(s, end, &shown);
        }
    }
    return at;
}

/* Edit distance, a swap of neighbours counted as one, case ignored. Words are shorter than WORD. */
static int distance(const char *a, const char *b)
{
    int rows[3][WORD + 1];
    int m = (int)strlen(a), n = (int)strlen(b);
    for (int j = 0; j <= n; ++j)
        rows[0][j] = j;
    for (int i = 1; i <= m; ++i) {
        const int *before = rows[(i + 1) % 3], *above = rows[(i - 1) % 3];
        int *row = rows[i % 3];
        row[0] = i;
        for (int j = 1; j <= n; ++j) {
            int best = above[j - 1] + ((a[i - 1] | 32) != (b[j - 1] | 32));
            if (above[j] + 1 < best)
                best = above[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && before[j - 2] + 1 < best)
                best = before[j - 2] + 1;
            row[j] = best;
        }
    }
    return rows[m % 3][n];
}

const char *diag_nearest(const char *word, const char *const *words, int count)
{
    size_t length = strlen(word);
    const char *nearest = NULL;
    int least = (int)(length < 3 ? 1 : length < WORD ? length / 3 : 0) + 1;
    for (int i = 0; i < count; ++i) {
        if (length >= WORD || strlen(words[i]) >= WORD)
            continue;
        int d = distance(word, words[i]);
        if (d < least) {
            least = d;
            nearest = words[i];
        }
    }
    return nearest;
}
