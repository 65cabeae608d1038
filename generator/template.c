/* SPDX-License-Identifier: MIT
 * Templates: readable C in which a line that is nothing but a comment with a name between two @ marks is replaced, and
 * a line that begins with a comment's opening and a minus sign is a remark that is not copied. */
#include "gicgen.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char *template_text(Pool *pool, const char *templates, const char *name, size_t *size)
{
    if (templates)
        return file_read(pool, pool_print(pool, "%s/%s", templates, name), size);
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

/* The name in a line of the form `    / * @name@ * /` (without the blanks inside), or NULL. */
static const char *insertion(Pool *pool, const char *line, size_t size, int *indent)
{
    size_t i = 0;
    while (i < size && line[i] == ' ')
        ++i;
    const char *from = line + i;
    size_t left = size - i;
    *indent = (int)i;
    if (left < 8 || memcmp(from, "/* @", 4) || memcmp(line + size - 4, "@ */", 4))
        return NULL;
    return pool_print(pool, "%.*s", (int)(left - 8), from + 4);
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
        bool remark = length >= 3 && !memcmp(line, "/*-", 3);
        if (what) {
            insert(context, what, out, indent);
        } else if (!remark) {
            expand_line(out, line, length, prefix, upper, class);
            text_print(out, "\n");
        }
        line += length + 1;
    }
}
