/* SPDX-License-Identifier: MIT
 * Templates: readable C, or HTML, in which a line that is nothing but a comment with a name between two @ marks is
 * replaced, and a line that begins with a comment's opening and a minus sign is a remark that is not copied. */
#include "gicgen.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char *template_text(Pool *pool, const char *templates, const char *name, size_t *size)
{
    if (templates)
        return file_read(pool, pool_print(pool, "%s/%s", templates, name), TEXT_MOST, size);
    for (const Embedded *file = embedded; file->name; ++file)
        if (!strcmp(file->name, name)) {
            *size = file->size;
            return file->bytes;
        }
    fprintf(stderr, "gicgen: error: template '%s' is not built in\n", name);
    exit(1);
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

/* The name in a line that is nothing but a comment, with the name between two @ marks, or NULL. */
static const char *insertion(Pool *pool, const char *line, size_t size, int *indent)
{
    size_t i = 0;
    while (i < size && line[i] == ' ')
        ++i;
    *indent = (int)i;
    for (int c = 0; c < COMMENTS; ++c) {
        size_t open = strlen(comment[c].open), close = strlen(comment[c].close);
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

void template_expand(Pool *pool, Text *out, const char *templates, const char *name, const char *prefix,
                     const char *class, Insert *insert, void *context)
{
    size_t size;
    const char *text = template_text(pool, templates, name, &size);
    char *upper = pool_print(pool, "%s", prefix);
    for (char *c = upper; *c; ++c)
        *c = (char)toupper((unsigned char)*c);
    for (const char *line = text; line < text + size;) {
        const char *end = memchr(line, '\n', (size_t)(text + size - line));
        size_t length = (size_t)((end ? end : text + size) - line);
        int indent;
        const char *what = insertion(pool, line, length, &indent);
        if (what) {
            insert(context, what, out, indent);
        } else if (!is_remark(line, length)) {
            expand_line(out, line, length, prefix, upper, class);
            text_print(out, "\n");
        }
        line += length + 1;
    }
}
