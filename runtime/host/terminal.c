/* SPDX-License-Identifier: MIT
 * Messages of the library in a terminal. */
#include "host/gic.h"
#include "host/host.h"

#include <stdio.h>
#include <unistd.h>

void terminal_hear(void *context, const gicl_message *message)
{
    (void)context;
    if (message->kind != GICL_PROGRESS)
        fputs(message->printed, message->kind == GICL_TEXT ? stdout : stderr);
    else if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r%s\x1b[K", message->printed);
}
