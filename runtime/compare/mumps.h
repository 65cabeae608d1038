/* SPDX-License-Identifier: MIT
 *
 * The plug-in that calls MUMPS. MUMPS brings a Fortran library of its own, and one engine for comparison needs it: so
 * gicrun is built without it, and loads plugin/mumps_plugin.c as a shared object when that engine is asked for. The
 * plug-in uses nothing of gicrun. */
#ifndef COMPARE_MUMPS_H
#define COMPARE_MUMPS_H

#include "base/pool.h"

#include <stdint.h>

/* A symmetric indefinite matrix and a right-hand side. The arrays belong to the caller. */
typedef struct MumpsSystem {
    int unknowns;
    int64_t entries;   /* of one triangle and the diagonal */
    int *row, *column; /* [entries] numbered from 1 */
    double *value;     /* [entries] may change from one solution to the next */
    double *right;     /* [unknowns] in: right-hand side; out: solution */
} MumpsSystem;

/* What `solve` returns besides the number of the unknown, from 0, where the matrix is singular. */
enum { MUMPS_SOLVED = -1, MUMPS_SINGULAR = -2 /* MUMPS does not say where */, MUMPS_FAILED = -3 };

/* error: what MUMPS says in INFOG(1) and INFOG(2); 0, 0 where it could not go on at all. */
typedef struct MumpsPlugin {
    /* The analysis: places count, values do not. Keeps the system's arrays. NULL: failed. */
    void *(*open)(const MumpsSystem *system, int error[2]);
    /* MUMPS_SOLVED, MUMPS_FAILED, MUMPS_SINGULAR or an unknown. */
    int (*solve)(void *opened, int error[2]);
    void (*close)(void *opened);
} MumpsPlugin;

/* The one symbol of the plug-in that gicrun looks for; another number where MumpsPlugin changes. */
#define MUMPS_SYMBOL "gicrun_mumps_1"
extern const MumpsPlugin gicrun_mumps_1;

/* Debian's packages. */
#define MUMPS_PACKAGES "libmumps-headers-dev '^libmumps-seq-5'"

/* mumps_load.c: the plug-in, from lib/gicgen/mumps.so beside the folder of the running program or in it. NULL: it is
 * not there or can't be loaded, *why. */
const MumpsPlugin *mumps_load(Pool *pool, const char **why);

#endif
