/* SPDX-License-Identifier: MIT
 * What the test programs share: memory, whole files, messages. They share no code with generator or runtime. */
#ifndef REFERENCE_SUPPORT_H
#define REFERENCE_SUPPORT_H

#include <stddef.h>
#include <stdio.h>

/* Print `error: <message>` to stderr and exit with status 1. */
_Noreturn void fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* `count` zeroed elements of `size` bytes, to be freed by the caller; never NULL, fails when memory is out. */
void *grab(size_t count, size_t size);
/* All bytes of a file ("-": standard input) behind one another and terminated, to be freed by the caller. */
char *slurp(const char *path);
/* Open a file for writing (NULL or "-": standard output), and close it; both fail with a message. */
FILE *output_open(const char *path);
void output_close(FILE *file, const char *path);
/* A finite number that fills the whole of `text`; `what` names it in the message. */
double number_of(const char *text, const char *what);

#endif
