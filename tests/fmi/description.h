/* SPDX-License-Identifier: MIT
 *
 * What an importer reads of modelDescription.xml, FMI 2.0 or 3.0, by libxml2. Written from the standard's text. */
#ifndef FMI_DESCRIPTION_H
#define FMI_DESCRIPTION_H

#include <stdbool.h>

typedef enum Type { REAL, WHOLE, OTHER } Type;

typedef struct Variable {
    const char *name, *causality, *variability, *initial, *unit; /* "" where absent */
    unsigned reference;
    Type type;
    bool starts;
    double start;
    bool everything;               /* as an unknown: does it depend on all knowns? Else on these: */
    int dependencies, *dependency; /* indices of variables */
    long derivative;               /* FMI 2.0: index of the state; FMI 3.0: its reference; -1: none */
} Variable;

typedef struct Description {
    int version; /* 2 or 3 */
    const char *token, *identifier;
    int variables;
    Variable *variable;
    int states, *state, *rate; /* indices of variables, in the order of the derivatives */
    int indicators;            /* of events */
} Description;

/* Ends the program with a message where the file is not as the standard says. */
Description description_read(const char *path);
/* Index of a variable, -1: there is none. */
int description_find(const Description *d, const char *name);

#endif
