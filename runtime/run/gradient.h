/* SPDX-License-Identifier: MIT
 *
 * gradient: derivatives of a number of a whole run by its initial state, tunable parameters and inputs (gicrun
 * --gradient), by the definitions of models/SCENE.md section 8. */
#ifndef RUN_GRADIENT_H
#define RUN_GRADIENT_H

#include "base/pool.h"
#include "model/model.h"
#include "run/run.h"
#include "run/tangent_run.h"
#include "scene/scene.h"

/* ---- gradient_formula.c: what is asked for */

typedef enum ScalarKind { SCALAR_END, SCALAR_INTEGRAL, SCALAR_MAXIMUM } ScalarKind;

/* A number of a run: the value of a formula at its end, its integral, or its largest value. */
typedef struct Scalar {
    ScalarKind kind;
    const Model *model; /* whose outputs are the formula and the conditions of the scene */
} Scalar;

/* text: a formula of FORMAT.md section 6, alone or as integral(...) or maximum(...), which reads outputs, too; scene:
 * whose conditions are outputs after it, or NULL. Ends in diag_fail. */
Scalar scalar_read(Pool *pool, const Model *model, const Scene *scene, const char *text);

/* ---- gradient.c: the run */

typedef struct Gradient {
    double value, time; /* time: of the end, or of the maximum, s */
    int variables;
    const RunVariable *variable;
    double *derivative; /* [variables] */
} Gradient;

/* wanted, count: as in tangent_open(), which ends the program where it must; NAME=VALUE sets the number first.
 * scene: may start in equilibrium, which is found here. */
const Gradient *gradient_find(Pool *pool, const Scalar *scalar, const Scene *scene, Solve solve,
                              const char *const *wanted, int count);

/* ---- gradient_report.c */

/* --gradient: a table, and a file: a page where its name ends in .html, else CSV. */
void gradient_report(Pool *pool, const Model *model, const Scene *scene, const Request *request);

/* ---- gradient_page.c: sensitivities as bars. number: a line that says what they are of. */
void gradient_page(Pool *pool, const char *name, const Gradient *gradient, const char *number, const char *path);

#endif
