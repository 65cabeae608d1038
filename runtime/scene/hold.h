/* SPDX-License-Identifier: MIT
 *
 * Inputs that come from outside while a run goes on, held from step to step: gicrun --live, models/LIVE.md. Runs that
 * are recorded and runs that repeat the recording hold the same numbers at the same steps by the same functions. */
#ifndef SCENE_HOLD_H
#define SCENE_HOLD_H

#include "host/host.h"
#include "scene/hands.h"
#include "scene/scene.h"

/* Who has the inputs: the scene; someone who gives them, and driven coordinates move to their values, or move as told,
 * with rates and accelerations. In recordings they are these numbers. */
typedef enum HoldBy { HOLD_SCENE, HOLD_TARGETS, HOLD_EXACT } HoldBy;

struct Hold {
    int inputs, *input; /* those that may come from outside; [inputs] indices in input[] */
    int hands, *first;  /* the same without rates and accelerations of driven coordinates; [hands] places in input */
    Hand *hand;         /* [hands] */
    /* of a recording; without one they come by hold_take() */
    int rows;
    const double *time, *row; /* [rows] s; [rows][inputs] */
    const int *kind;          /* [rows] HoldBy */
    /* during the run */
    int next; /* row */
    HoldBy by;
    bool touched;  /* someone else than the scene had the inputs */
    double *value; /* [inputs] */
};

/* Of a scene some inputs of which come by hold_take(): names of inputs between commas; NULL: all of them. Fails where
 * the model has no such input. */
Hold *hold_new(Pool *pool, const Model *model, const char *names);
/* Of a recording; fails if it was not made with the model and the scene. */
Hold *hold_recorded(Pool *pool, const Model *model, const Scene *scene, const CsvTable *table);
/* Is a table the recording of such a run? It has no other columns. */
bool hold_is(const CsvTable *table);
/* The columns of a recording after its time. */
void hold_names(Csv *csv, const Hold *hold, const Model *model);
void hold_start(Hold *hold);
/* At `time`, before a step of an instance with input[]: someone gives value[hold->inputs], or the scene gets them back.
 * False: nothing is different from before. */
bool hold_take(const Scene *scene, double time, HoldBy by, const double *value, double *input);
/* Do what is due at `time` by the recording. */
void hold_look(const Scene *scene, double time, double *input);
/* Write what is held into input[]. What the scene's driver does not move stays where it was when the scene gets them.
 */
void hold_inputs(const Hold *hold, const Driver *driver, double time, double *input);

#endif
