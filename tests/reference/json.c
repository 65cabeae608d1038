/* SPDX-License-Identifier: MIT
 * Recursive-descent JSON (RFC 8259). */
#include "json.h"

#include "support.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 64 };

typedef struct Reader {
    const char *name, *start, *at;
    int depth;
} Reader;

static _Noreturn void bad(const Reader *reader, const char *what)
{
    int line = 1;
    for (const char *s = reader->start; s < reader->at; ++s)
        line += *s == '\n';
    fail("%s:%d: %s", reader->name, line, what);
}

static char next(Reader *reader)
{
    while (*reader->at && strchr(" \t\r\n", *reader->at))
        ++reader->at;
    return *reader->at;
}

static void want(Reader *reader, char c)
{
    if (next(reader) != c)
        bad(reader, "a bracket, comma, colon or quote is missing");
    ++reader->at;
}

static unsigned hex4(Reader *reader)
{
    unsigned code = 0;
    for (int i = 0; i < 4; ++i) {
        char c = *reader->at++;
        if (!isxdigit((unsigned char)c))
            bad(reader, "\\u wants four hexadecimal digits");
        code = 16 * code + (unsigned)(isdigit((unsigned char)c) ? c - '0' : (c | 32) - 'a' + 10);
    }
    return code;
}

/* One escape behind its backslash, as UTF-8; returns the new end of the text. */
static char *escape(Reader *reader, char *end)
{
    char c = *reader->at++;
    static const char from[] = "\"\\/bfnrt", to[] = "\"\\/\b\f\n\r\t";
    const char *found = c ? strchr(from, c) : NULL;
    if (found) {
        *end++ = to[found - from];
    } else if (c == 'u') {
        unsigned code = hex4(reader);
        if (code < 0x80) {
            *end++ = (char)code;
        } else if (code < 0x800) {
            *end++ = (char)(0xc0 | code >> 6);
            *end++ = (char)(0x80 | (code & 63));
        } else {
            *end++ = (char)(0xe0 | code >> 12);
            *end++ = (char)(0x80 | (code >> 6 & 63));
            *end++ = (char)(0x80 | (code & 63));
        }
    } else {
        bad(reader, "unknown escape in a text");
    }
    return end;
}

static char *text(Reader *reader)
{
    want(reader, '"');
    const char *close = reader->at;
    while (*close && *close != '"')
        close += *close == '\\' && close[1] ? 2 : 1;
    char *out = grab((size_t)(close - reader->at) + 1, 1), *end = out; /* an escape never grows */
    while (*reader->at != '"') {
        if ((unsigned char)*reader->at < ' ')
            bad(reader, "a text has no closing quote");
        if (*reader->at == '\\') {
            ++reader->at;
            end = escape(reader, end);
        } else {
            *end++ = *reader->at++;
        }
    }
    ++reader->at;
    *end = 0;
    return out;
}

static bool word(Reader *reader, const char *s)
{
    size_t size = strlen(s);
    if (strncmp(reader->at, s, size))
        return false;
    reader->at += size;
    return true;
}

static Json *value(Reader *reader);

static void members(Reader *reader, Json *json, char close)
{
    ++reader->at;
    if (++reader->depth > DEEPEST)
        bad(reader, "too deeply nested");
    while (next(reader) != close) {
        if (json->count)
            want(reader, ',');
        size_t room = (size_t)json->count + 1;
        json->item = realloc(json->item, room * sizeof *json->item);
        json->key = realloc(json->key, room * sizeof *json->key);
        if (!json->item || !json->key)
            fail("out of memory");
        json->key[json->count] = NULL;
        if (close == '}') {
            json->key[json->count] = text(reader);
            want(reader, ':');
        }
        json->item[json->count++] = value(reader);
    }
    ++reader->at;
    --reader->depth;
}

static Json *value(Reader *reader)
{
    Json *json = grab(1, sizeof *json);
    char c = next(reader);
    if (c == '{' || c == '[') {
        json->kind = c == '{' ? JSON_OBJECT : JSON_LIST;
        members(reader, json, c == '{' ? '}' : ']');
    } else if (c == '"') {
        json->kind = JSON_TEXT;
        json->text = text(reader);
    } else if (word(reader, "null")) {
        json->kind = JSON_NULL;
    } else if (word(reader, "true") || word(reader, "false")) {
        json->kind = JSON_BOOL;
        json->number = reader->at[-2] == 'u';
    } else {
        char *end;
        json->kind = JSON_NUMBER;
        json->number = strtod(reader->at, &end);
        if (end == reader->at || !(c == '-' || isdigit((unsigned char)c)))
            bad(reader, "a value is missing");
        reader->at = end;
    }
    return json;
}

Json *json_parse(const char *source, const char *name)
{
    Reader reader = {.name = name, .start = source, .at = source};
    Json *json = value(&reader);
    if (next(&reader))
        bad(&reader, "text behind the end of the JSON value");
    return json;
}

void json_free(Json *json)
{
    for (int i = 0; i < json->count; ++i) {
        json_free(json->item[i]);
        free(json->key[i]);
    }
    free(json->item);
    free(json->key);
    free(json->text);
    free(json);
}

const Json *json_get(const Json *object, const char *key)
{
    if (object->kind != JSON_OBJECT)
        fail("an object with '%s' is wanted", key);
    for (int i = 0; i < object->count; ++i)
        if (!strcmp(object->key[i], key))
            return object->item[i];
    fail("key '%s' is missing", key);
}

double json_number(const Json *object, const char *key)
{
    const Json *json = json_get(object, key);
    if (json->kind != JSON_NUMBER && json->kind != JSON_BOOL && json->kind != JSON_NULL)
        fail("'%s' is not a number", key);
    return json->number;
}

void json_numbers(const Json *object, const char *key, double *out, int size)
{
    const Json *json = json_get(object, key);
    memset(out, 0, (size_t)size * sizeof *out);
    if (json->kind == JSON_NULL)
        return;
    if (json->kind != JSON_LIST || json->count != size)
        fail("'%s' is not a list of %d numbers", key, size);
    for (int i = 0; i < size; ++i) {
        if (json->item[i]->kind != JSON_NUMBER)
            fail("'%s' is not a list of %d numbers", key, size);
        out[i] = json->item[i]->number;
    }
}

const char *json_text(const Json *object, const char *key)
{
    const Json *json = json_get(object, key);
    if (json->kind != JSON_TEXT)
        fail("'%s' is not a text", key);
    return json->text;
}
