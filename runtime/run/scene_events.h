/* SPDX-License-Identifier: MIT
 *
 * scene_events: steps of a scene that end where a condition becomes true (`until`, `when`; models/SCENE.md section 13),
 * and what became of the vehicle. */
#ifndef RUN_SCENE_EVENTS_H
#define RUN_SCENE_EVENTS_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/variable_step.h"
#include "scene/scene.h"

typedef struct SceneEvents SceneEvents;

/* For one run of a scene that has conditions; self: at its start. NULL: the scene has none. *status: of the look at the
 * start. */
SceneEvents *scene_events_new(Pool *pool, const Engine *engine, const Scene *scene, const gic_head *self, int *status);
/* As scene_step(). Where conditions become true within the step, the integration stops there, does what belongs to
 * them, and goes on to the step's end; *ended: one of them ends the run, and `self` is at its time. */
int scene_events_step(SceneEvents *events, const gic_model *model, Variable *variable, gic_head *self, double end,
                      bool *ended);

/* ---- what became of the vehicle, from looks at output times */

typedef struct Outcome {
    double tipped; /* s: when it leant by more than 60 degrees first; NAN: never */
    double left;   /* s: since when its base is beyond the road's data, NAN: it is not, or began there */
    double rest;   /* s: since when it is at rest, NAN: it is not */
    bool moved;    /* has it been in motion? */
    bool inside;   /* has it been on the road's data? */
} Outcome;

Outcome outcome_new(void);
/* standard: the state as in FORMAT.md section 10, of a free base. */
void outcome_look(Outcome *outcome, const gic_model *code, const gic_road *road, double time, const double *standard);

#endif
