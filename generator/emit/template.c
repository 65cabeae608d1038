/* SPDX-License-Identifier: MIT
 * Templates: readable C, or HTML, in which a line that is nothing but a comment with a name between two @ marks is
 * replaced, and a line that begins with a comment's opening and a minus sign is a remark that is not copied. A table
 * of names and functions says what replaces such a line; a name that the table does not have is an error, and so is a
 * name of the table that no template has. */
#include "base/file.h"
#include "base/message.h"
#include "emit/emit.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

const Source *template_source(Pool *pool, const char *templates, const char *name)
{
    Source *source = pool_alloc(pool, sizeof *source);
    source->path = templates ? pool_print(pool, "%s/%s", templates, name) : name;
    if (templates) {
        source->bytes = file_read(pool, source->path, TEXT_MOST, &source->size);
        return source;
    }
    for (const Embedded *file = embedded; file->name; ++file)
        if (!strcmp(file->name, name)) {
            source->bytes = file->bytes;
            source->size = file->size;
            return source;
        }
    diag_fail((Place){NULL, 0, 0}, NULL, "template '%s' is not built in", name);
}

static bool word_character(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* A known word that is a whole part of an identifier: PREFIX in PREFIX_setup, but neither in MYPREFIX nor in PREFIXED.
 */
static size_t replace_word(const char *s, size_t left, const char *word, const char *by, Text *out)
{
    size_t length = strlen(word);
    bool whole = left >= length && !memcmp(s, word, length) && (left == length || !isalnum((unsigned char)s[length]));
    if (!whole)
        return 0;
    text_print(out, "%s", by);
    return length;
}

static void expand_line(Text *out, const char *line, size_t size, const char *prefix, const char *upper,
                        const char *class)
{
    for (size_t i = 0; i < size;) {
        bool starts = i == 0 || !word_character(line[i - 1]) || line[i - 1] == '_';
        size_t taken = 0;
        if (starts) {
            taken = replace_word(line + i, size - i, "PREFIX", prefix, out);
            if (!taken)
                taken = replace_word(line + i, size - i, "UPPER", upper, out);
            if (!taken && class)
                taken = replace_word(line + i, size - i, "CLASS", class, out);
        }
        if (!taken)
            text_add(out, line + i, taken = 1);
        i += taken;
    }
}

/* Comments as C and as HTML has them. */
static const struct {
    const char *open, *close, *remark;
} comment[] = {{"/* @", "@ */", "/*-"}, {"<!-- @", "@ -->", "<!---"}};

enum { COMMENTS = sizeof comment / sizeof *comment };

static bool starts_with(const char *s, size_t size, const char *start)
{
    return size >= strlen(start) && !memcmp(s, start, strlen(start));
}

/* The name in a line that is nothing but a comment, with the name between two @ marks, or NULL. *indent: spaces before
 * the comment; *at: bytes before the name. */
static const char *insertion_name(Pool *pool, const char *line, size_t size, int *indent, size_t *at)
{
    size_t i = 0;
    while (i < size && line[i] == ' ')
        ++i;
    *indent = (int)i;
    for (int c = 0; c < COMMENTS; ++c) {
        size_t open = strlen(comment[c].open), close = strlen(comment[c].close);
        *at = i + open;
        if (size - i >= open + close && starts_with(line + i, size - i, comment[c].open) &&
            !memcmp(line + size - close, comment[c].close, close))
            return pool_print(pool, "%.*s", (int)(size - i - open - close), line + i + open);
    }
    return NULL;
}

static bool is_remark(const char *line, size_t size)
{
    bool remark = false;
    for (int c = 0; c < COMMENTS; ++c)
        remark = remark || starts_with(line, size, comment[c].remark);
    return remark;
}

/* ---- insertion points ----------------------------------------------------------------------------------------- */

static const Insertion *find_insertion(const Insertions *points, const char *name)
{
    for (; points; points = points->general)
        for (const Insertion *point = points->point; point->name; ++point)
            if (!strcmp(point->name, name))
                return point;
    return NULL;
}

static int point_count(const Insertions *points)
{
    int count = 0;
    while (points->point[count].name)
        ++count;
    return count;
}

static _Noreturn void fail_unknown(Pool *pool, const Source *source, size_t offset, const Insertions *points,
                                   const char *name)
{
    int count = 0;
    for (const Insertions *p = points; p; p = p->general)
        count += point_count(p);
    const char **known = pool_alloc(pool, (size_t)(count + 1) * sizeof *known);
    count = 0;
    for (const Insertions *p = points; p; p = p->general)
        for (const Insertion *point = p->point; point->name; ++point)
            known[count++] = point->name;
    const char *nearest = diag_nearest(name, known, count);
    Text all = {.pool = pool};
    for (int i = 0; i < count; ++i)
        text_print(&all, "%s'%s'", i ? ", " : "", known[i]);
    diag_fail(diag_place(source, offset),
              nearest ? pool_print(pool, "did you mean '@%s@'?", nearest)
              : count ? pool_print(pool, "the names known here are %s", all.s)
                      : "this template has no insertion points",
              "unknown insertion point '@%s@'", name);
}

/* The next line of a template with an insertion point, from *line on, or NULL. Moves *line past it. */
static const char *next_insertion(Pool *pool, const Source *source, const char **line, size_t *offset)
{
    const char *const end = source->bytes + source->size;
    while (*line < end) {
        const char *start = *line, *stop = memchr(start, '\n', (size_t)(end - start));
        const size_t length = (size_t)((stop ? stop : end) - start);
        int indent;
        size_t at;
        const char *name = insertion_name(pool, start, length, &indent, &at);
        *line += length + 1;
        if (name) {
            *offset = (size_t)(start - source->bytes) + at;
            return name;
        }
    }
    return NULL;
}

/* Mark the own points of a table that a template has; each point of the template must be known. */
static void check_template(Pool *pool, const Source *source, const Insertions *points, bool *used)
{
    const char *line = source->bytes, *name;
    size_t offset;
    while ((name = next_insertion(pool, source, &line, &offset)) != NULL) {
        const Insertion *found = find_insertion(points, name);
        if (!found)
            fail_unknown(pool, source, offset, points, name);
        for (int i = 0; points->point[i].name; ++i)
            used[i] = used[i] || found == &points->point[i];
    }
}

static void check_points(Pool *pool, const char *templates, const Insertions *points)
{
    const int count = point_count(points);
    bool used[count + 1];
    memset(used, 0, sizeof used);
    const Source *first = NULL;
    Text names = {.pool = pool};
    for (int t = 0; points->template[t]; ++t) {
        const Source *source = template_source(pool, templates, points->template[t]);
        check_template(pool, source, points, used);
        first = first ? first : source;
        text_print(&names, "%s%s", t ? ", " : "", points->template[t]);
    }
    for (int i = 0; i < count; ++i)
        if (!used[i])
            diag_fail((Place){.source = first},
                      pool_print(pool,
                                 "put a line with nothing but a comment with '@%s@' where its text belongs; of %s",
                                 points->point[i].name, names.s),
                      "no template has the insertion point '@%s@'", points->point[i].name);
}

void templates_check(Pool *pool, const char *templates, const Insertions *const *points)
{
    for (; *points; ++points)
        check_points(pool, templates, *points);
}

static void insert(Pool *pool, const Source *source, size_t offset, const Insertions *points, const char *name,
                   void *context, Text *out, int indent)
{
    const Insertion *point = find_insertion(points, name);
    if (!point)
        fail_unknown(pool, source, offset, points, name);
    point->write(context, out, indent);
}

void template_expand(Pool *pool, Text *out, const char *templates, const char *name, const char *prefix,
                     const char *class, const Insertions *points, void *context)
{
    const Source *source = template_source(pool, templates, name);
    const char *const text = source->bytes, *const text_end = text + source->size;
    char *upper = pool_print(pool, "%s", prefix);
    for (char *c = upper; *c; ++c)
        *c = (char)toupper((unsigned char)*c);
    for (const char *line = text; line < text_end;) {
        const char *end = memchr(line, '\n', (size_t)(text_end - line));
        size_t length = (size_t)((end ? end : text_end) - line), at;
        int indent;
        const char *what = insertion_name(pool, line, length, &indent, &at);
        if (what) {
            insert(pool, source, (size_t)(line - text) + at, points, what, context, out, indent);
        } else if (!is_remark(line, length)) {
            expand_line(out, line, length, prefix, upper, class);
            text_print(out, "\n");
        }
        line += length + 1;
    }
}
