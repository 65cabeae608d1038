/* SPDX-License-Identifier: MIT
 *
 * report: the page about a model and its code. */
#ifndef REPORT_REPORT_H
#define REPORT_REPORT_H

#include "base/text.h"

#include <stdbool.h>

typedef struct Formulation Formulation; /* vehicle/vehicle.h */

/* The functions whose stack a page shows. */
enum { CODE_FUNCTIONS = 6 };
extern const char *const code_function[CODE_FUNCTIONS];

/* What code takes in memory as a C compiler says, bytes: [0] in double precision, [1] in single. */
typedef struct CodeMemory {
    const char *compiler;             /* the command */
    const char *why;                  /* it says nothing; NULL: it says all but perhaps stacks */
    size_t instance[2], constants[2]; /* constants without the texts of names */
    size_t numbers[2];                /* of the constants: of the subsets */
    bool stacks;                      /* did it tell them? */
    /* below a call, without the C library's and the user's own functions: what it takes without optimization and a
     * quarter more, enough for code that is optimized */
    size_t stack[2][CODE_FUNCTIONS];
} CodeMemory;

/* One HTML page: the model, its sequence, and the cost of its code (c as generate() makes it). `path`: the file of the
 * page, for messages. */
void report_print(Text *out, const char *path, const char *templates, const Formulation *f, const Text *c,
                  const CodeMemory *code);

#endif
