/* SPDX-License-Identifier: MIT
 * Messages of the library in a terminal. */
#include "host/gic.h"
#include "host/host.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int terminal_close(const char *program, int status)
{
    const bool failed = fflush(stdout) != 0 || ferror(stdout);
    if (failed && !status)
        fprintf(stderr,
                "%s: error: standard output can't be written: %s\n  remedy: is the disk full? `-o FILE` names a file\n",
                program, strerror(errno));
    return failed && !status ? GICL_FAILED : status;
}

void terminal_hear(void *context, const gicl_message *message)
{
    (void)context;
    if (message->kind != GICL_PROGRESS)
        fputs(message->printed, message->kind == GICL_TEXT ? stdout : stderr);
    else if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r%s\x1b[K", message->printed);
}
