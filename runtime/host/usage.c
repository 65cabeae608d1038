/* SPDX-License-Identifier: MIT
 * Errors in the command line. */
#include "host/host.h"

#include <errno.h>
#include <stdlib.h>

void usage_fail(const char *program, const char *message, const char *word)
{
    fprintf(stderr, "%s: error: %s%s%s%s\n  remedy: `%s -h` shows how\n", program, message, word ? " '" : "",
            word ? word : "", word ? "'" : "", program);
    exit(2);
}

int64_t usage_whole(const char *program, const char *message, const char *word, int64_t least, int64_t most)
{
    char *end;
    errno = 0;
    const long long value = strtoll(word, &end, 10);
    if (errno == ERANGE || end == word || *end || value < least || value > most)
        usage_fail(program, message, word);
    return value;
}
