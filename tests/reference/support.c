/* SPDX-License-Identifier: MIT
 * Memory, whole files and messages of the test programs. */
#include "support.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

_Noreturn void fail(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("error: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(1);
}

void *grab(size_t count, size_t size)
{
    void *block = calloc(count ? count : 1, size);
    if (!block)
        fail("out of memory");
    return block;
}

char *slurp(const char *path)
{
    FILE *file = strcmp(path, "-") ? fopen(path, "rb") : stdin;
    if (!file)
        fail("%s: can't open: %s", path, strerror(errno));
    size_t size = 0, room = 1 << 16;
    char *text = grab(room, 1);
    for (size_t n; (n = fread(text + size, 1, room - size - 1, file)) > 0;) {
        size += n;
        if (room - size < 2) {
            text = realloc(text, room *= 2);
            if (!text)
                fail("out of memory");
        }
    }
    if (ferror(file))
        fail("%s: can't read", path);
    if (file != stdin)
        fclose(file);
    text[size] = 0;
    return text;
}

FILE *output_open(const char *path)
{
    FILE *file = path && strcmp(path, "-") ? fopen(path, "w") : stdout;
    if (!file)
        fail("%s: can't create: %s", path, strerror(errno));
    return file;
}

void output_close(FILE *file, const char *path)
{
    if (fflush(file) || ferror(file) || (file != stdout && fclose(file)))
        fail("%s: can't write: %s", path ? path : "standard output", strerror(errno));
}

double number_of(const char *text, const char *what)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !isfinite(value))
        fail("%s: '%s' is not a finite number", what, text);
    return value;
}
