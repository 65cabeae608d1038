/* SPDX-License-Identifier: MIT
 *
 * The plug-in that calls CVODE of SUNDIALS: backward differentiation formulas, variable step and order 1 to 5. The
 * integrator `bdf` alone needs it: so programs are built without it, and load plugin/cvode_plugin.c as a shared object
 * then. The plug-in uses nothing of theirs. */
#ifndef HOST_BDF_H
#define HOST_BDF_H

#include <stddef.h>

/* y' = f(t, y) with `count` numbers, 1 or more. Functions return 0; otherwise a shorter step is tried. */
typedef struct BdfSystem {
    size_t count;
    double tolerance; /* of the estimated error of a step: tolerance (1 + |y|) for each number */
    int (*rate)(void *user, double time, const double *state, double *rate);
    /* matrix[row + count * column]: derivatives of the rates by the state; all numbers are 0 before */
    int (*jacobian)(void *user, double time, const double *state, const double *rate, double *matrix);
    void *user;
} BdfSystem;

typedef struct BdfPlugin {
    void *(*open)(const BdfSystem *system); /* which stays where it is; NULL: no memory */
    /* Forget the history, and begin at a state; first: s, the longest first step. Returns 0, or -1. */
    int (*start)(void *bdf, double time, const double *state, double first);
    /* One step, no further than to `end`, which is later than *time; *next: the length (s) that the following one would
     * have. Returns 0, or -1 where no step is short enough. */
    int (*step)(void *bdf, double *time, double end, double *state, double *next);
    void (*close)(void *bdf);
} BdfPlugin;

/* The one symbol of the plug-in that programs look for; another number where BdfPlugin changes. */
#define BDF_SYMBOL "gicrun_bdf_1"
extern const BdfPlugin gicrun_bdf_1;

/* Debian's package. */
#define BDF_PACKAGES "libsundials-dev"

#endif
