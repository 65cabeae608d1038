/* SPDX-License-Identifier: MIT
 * The readers that fuzz attacks: see fuzz.c. */
#ifndef FUZZ_TARGETS_H
#define FUZZ_TARGETS_H

#include <stddef.h>

/* Bytes to read, terminated; the file at `path` holds what input_write puts there. */
typedef struct Bytes {
    const char *path;
    int file;
    const char *bytes;
    size_t size;
} Bytes;

typedef struct Target {
    const char *name;
    void (*prepare)(void);            /* once, or NULL */
    void (*read)(const Bytes *input); /* and check what it made of them; refuses by exit(1) */
} Target;

extern const Target targets[]; /* the last has no name */

#endif
