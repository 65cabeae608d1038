/* SPDX-License-Identifier: MIT
 * Long lines of generated code are broken at blanks: in comments, elsewhere between tokens. A string that is longer
 * than a line becomes adjacent strings in parentheses, without which compilers take them for a comma that was
 * forgotten.
 */
#include "base/text.h"
#include "emit/emit_private.h"

#include <ctype.h>
#include <string.h>

enum { COLUMNS = 120 };

typedef enum Where { IN_CODE, IN_COMMENT } Where;

/* Number of bytes of the character of a string that begins at s; an escape is one. Trigraphs: quoted() writes none. */
static size_t character_size(const char *s)
{
    size_t size = 1;
    if (*s == '\\' && s[1] == 'x') {
        size = 2 + strspn(s + 2, "0123456789abcdefABCDEF");
    } else if (*s == '\\') {
        const size_t digits = strspn(s + 1, "01234567");
        size = digits > 3 ? 4 : digits ? 1 + digits : 2;
    }
    while (((unsigned char)s[size] & 0xc0u) == 0x80u) /* the rest of a character in UTF-8 */
        ++size;
    return size;
}

/* Number of bytes of the string literal that begins at s. */
static size_t string_size(const char *s)
{
    size_t size = 1;
    while (s[size] != '"')
        size += character_size(s + size);
    return size + 1;
}

static bool is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* True if a line is not broken at the blank s[i]: in code before an operator with blanks around it or within a
 * declaration such as "const type *name", in a comment before its end. */
static bool stays(const char *s, size_t i, Where where)
{
    const char *next = s + i + 1;
    const size_t size = strspn(next, "+-*/?:&|<>=!");
    if (where == IN_COMMENT)
        return next[0] == '*' && next[1] == '/';
    return (size && next[size] == ' ') || (is_word(s[i - 1]) && (is_word(*next) || *next == '*'));
}

/* End of what begins at i and is not broken: up to a blank; if `together`, to one where a person would
 * break, outside of brackets. */
static size_t piece_end(const char *s, size_t i, size_t size, Where *where, bool together)
{
    int deep = 0;
    while (i < size && s[i] == ' ')
        ++i;
    while (i < size && (s[i] != ' ' || (together && (deep > 0 || stays(s, i, *where))))) {
        if (*where == IN_COMMENT) {
            *where = s[i] == '*' && s[i + 1] == '/' ? IN_CODE : IN_COMMENT;
            i += *where == IN_CODE ? 2 : 1;
        } else if (s[i] == '/' && s[i + 1] == '*') {
            *where = IN_COMMENT;
            i += 2;
        } else if (s[i] == '"') {
            i += string_size(s + i);
        } else {
            deep += s[i] == '[' ? 1 : s[i] == ']' ? -1 : 0;
            ++i;
        }
        if (*where == IN_COMMENT)
            deep = 0;
    }
    return i;
}

/* The string literal at s in lines of `indent` blanks; returns its size. */
static size_t wrap_string(Text *out, const char *s, int indent)
{
    const size_t size = string_size(s), room = (size_t)(COLUMNS - indent - 6);
    size_t i = 1;
    text_print(out, "(\"");
    while (i < size - 1) {
        size_t end = i, last = i;
        for (; end < size - 1 && end + character_size(s + end) - i <= room; end += character_size(s + end))
            if (s[end] == ' ')
                last = end + 1;
        if (end == size - 1 || last == i)
            last = end;
        text_add(out, s + i, last - i);
        i = last;
        if (i < size - 1)
            text_print(out, "\"\n%*s\"", indent + 1, "");
    }
    text_print(out, "\")");
    return size;
}

/* Code without a blank in which it could be broken and with strings that are longer than a line: broken in those. */
static void wrap_strings(Text *out, const char *s, size_t size, int indent)
{
    for (size_t i = 0; i < size;) {
        const size_t literal = s[i] == '"' ? string_size(s + i) : 0;
        if (literal > (size_t)(COLUMNS - indent) - 2) {
            i += wrap_string(out, s + i, indent);
        } else {
            text_add(out, s + i, literal ? literal : 1);
            i += literal ? literal : 1;
        }
    }
}

/* How the line goes on after a break: blanks, in a comment that fills lines with its star. listed: the line before
 * ended with a comma or "= {", so that this one stands in a list already. */
static const char *continuation(Pool *pool, const char *s, Where where, bool listed)
{
    const int indent = (int)strspn(s, " ");
    const bool opens = where == IN_CODE && s[indent] == '/' && s[indent + 1] == '*';
    return opens                                     ? pool_print(pool, "%*s * ", indent, "")
           : where == IN_COMMENT && s[indent] == '*' ? pool_print(pool, "%*s* ", indent, "")
                                                     : pool_print(pool, "%*s", listed ? indent : indent + 4, "");
}

/* One line longer than COLUMNS that begins in code or in a comment; returns in which the next one begins. The words of
 * a comment that do not fit go to *rest if the comment goes on with the next line. */
static Where wrap_line(Text *out, const char *s, size_t size, Where where, bool listed, const char **rest)
{
    const char *const next = continuation(out->pool, s, where, listed);
    const size_t further = strlen(next);
    size_t column = 0;
    for (size_t i = 0, end; i < size; i = end) {
        const Where before = where;
        end = piece_end(s, i, size, &where, true);
        size_t blanks = strspn(s + i, " ");
        if (end - i - blanks + further > COLUMNS) { /* too long for a line of its own */
            where = before;
            end = piece_end(s, i, size, &where, false);
        }
        if (i && column + end - i > COLUMNS) {
            i += blanks;
            blanks = 0;
            if (rest) {
                *rest = pool_print(out->pool, "%.*s ", (int)(size - i), s + i);
                text_print(out, "\n");
                return before;
            }
            text_print(out, "\n%s", next);
            column = further;
        }
        column += end - i;
        text_add(out, s + i, blanks);
        if (before == IN_CODE && column > COLUMNS)
            wrap_strings(out, s + i + blanks, end - i - blanks, (int)strspn(next, " "));
        else
            text_add(out, s + i + blanks, end - i - blanks);
    }
    text_print(out, "\n");
    return where;
}

/* In what the line after s[0..size-1] begins. */
static Where line_end(const char *s, size_t size, Where where)
{
    for (size_t i = 0; i < size;)
        i = piece_end(s, i, size, &where, false);
    return where;
}

/* True if words that a line has no room for can go to the next one: that goes on with the same paragraph of a comment
 * or with the same list of arguments. */
static bool goes_on(const char *s, size_t size, const char *next, Where after, bool listed)
{
    const size_t indent = strspn(s, " "), deeper = strspn(next, " ");
    const char *n = next + deeper;
    if (after == IN_COMMENT)
        return n[0] == '*' && n[1] == ' ' && n[2] != ' ';
    return size && s[size - 1] == ',' && s[indent] != '{' && deeper == (listed ? indent : indent + 4);
}

/* A rule, "---- title ------", that a name made longer than a line: shorter. Returns its length. */
static size_t shorten_rule(Pool *pool, const char **s, size_t size)
{
    const size_t over = size > COLUMNS ? size - COLUMNS : 0;
    size_t dashes = 0;
    while (size > 3 + dashes && !strncmp(*s + size - 3, " */", 3) && (*s)[size - 4 - dashes] == '-')
        ++dashes;
    if (!over || dashes < over + 4)
        return size;
    *s = pool_print(pool, "%.*s */", (int)(COLUMNS - 3), *s);
    return COLUMNS;
}

/* The line to write: what the one before it had no room for, after its indentation and star, and its own words. */
static const char *with_rest(Pool *pool, const char *rest, const char *line, size_t size)
{
    size_t from = strspn(line, " ");
    if (!*rest)
        return line;
    from += line[from] == '*' ? 2 : 0;
    return pool_print(pool, "%.*s%s%.*s", (int)from, line, rest, (int)(size - from), line + from);
}

char *wrap_lines(Pool *pool, const char *text, size_t *size)
{
    Text out = {.pool = pool};
    Where where = IN_CODE;
    const char *rest = "";
    bool listed = false;
    for (const char *line = text, *end; line < text + *size; line = end + 1) {
        end = memchr(line, '\n', (size_t)(text + *size - line));
        if (!end)
            end = text + *size;
        const char *s = with_rest(pool, rest, line, (size_t)(end - line));
        const size_t length = shorten_rule(pool, &s, (size_t)(end - line) + strlen(rest));
        const Where after = line_end(s, length, where);
        rest = "";
        if (length <= COLUMNS || *s == '#' || s[length - 1] == '\\') {
            text_add(&out, s, length);
            text_print(&out, "\n");
            where = after;
        } else {
            const bool flows = goes_on(s, length, end + 1, after, listed);
            where = wrap_line(&out, s, length, where, listed, flows ? &rest : NULL);
        }
        listed = length > 2 && (s[length - 1] == ',' || !strncmp(s + length - 3, "= {", 3));
    }
    *size = out.size;
    return out.s;
}
