/* SPDX-License-Identifier: MIT
 * How inputs of fuzz.c change: half of them in bytes, as libFuzzer does it, half in numbers, words and lines, or little
 * would pass YAML. */
#include <ctype.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *bytes, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed);

/* Numbers that formulas and conversions may not be ready for, and what is not a number. */
static const char *const odd[] = {"0",     "-0",         "1",     "-1",    "2",       "1e-320", "1e-200",
                                  "1e-12", "1e12",       "1e200", "1e308", "1.8e308", "-1e308", "0.5",
                                  "1e9",   "2147483648", "65536", "1e19",  "nan",     "",       "~",
                                  "[]",    "{}",         "true",  "*a",    "&a 1",    "0x10"};

enum { ODD = sizeof odd / sizeof *odd };

/* A run of equal kind, word or number, or a line. */
typedef struct Span {
    size_t from, size;
} Span;

static unsigned next_random(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static int is_word(int c)
{
    return isalnum(c) || c == '_' || c == '.' || c == '-' || c == '+';
}

/* One of the words, or of the lines with their ends; size 0: there is none. */
static Span pick(const uint8_t *bytes, size_t size, int line, unsigned *state)
{
    Span span = {0, 0};
    if (!size)
        return span;
    size_t at = next_random(state) % size;
    if (line) {
        while (at && bytes[at - 1] != '\n')
            --at;
        span.from = at;
        while (at < size && bytes[at++] != '\n')
            ;
    } else {
        while (at < size && !is_word(bytes[at]))
            ++at;
        span.from = at;
        while (span.from && at < size && is_word(bytes[span.from - 1]))
            --span.from;
        while (at < size && is_word(bytes[at]))
            ++at;
    }
    span.size = at - span.from;
    return span;
}

/* Put other bytes in place of a span. Returns the new size. */
static size_t put(uint8_t *bytes, size_t size, size_t most, Span span, const void *other, size_t length)
{
    if (size - span.size + length > most)
        return size;
    memmove(bytes + span.from + length, bytes + span.from + span.size, size - span.from - span.size);
    memcpy(bytes + span.from, other, length);
    return size - span.size + length;
}

/* A copy of a span in place of another one. */
static size_t copy(uint8_t *bytes, size_t size, size_t most, Span to, Span from)
{
    uint8_t *kept = malloc(from.size + 1);
    if (!kept)
        return size;
    memcpy(kept, bytes + from.from, from.size);
    size = put(bytes, size, most, to, kept, from.size);
    free(kept);
    return size;
}

size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed)
{
    unsigned state = seed;
    if (next_random(&state) % 2)
        return LLVMFuzzerMutate(bytes, size, most);
    for (unsigned changes = 1 + next_random(&state) % 3; changes; --changes) {
        const unsigned way = next_random(&state) % 5;
        Span to = pick(bytes, size, way > 2, &state);
        const Span from = pick(bytes, size, way > 2, &state);
        const char *number = odd[next_random(&state) % ODD];
        if (way == 3)
            to.size = 0; /* one line more */
        if (way == 0)
            size = put(bytes, size, most, to, number, strlen(number));
        else if (way == 1 || way == 3)
            size = copy(bytes, size, most, to, from);
        else if (way == 2)
            size = next_random(&state) % 4 ? size : put(bytes, size, most, to, "", 0);
        else
            size = put(bytes, size, most, to, "", 0);
    }
    return size;
}
