/* SPDX-License-Identifier: MIT
 *
 * Sleep of a vehicle at rest: models/SCENE.md section 9. */
#ifndef SCENE_SLEEP_H
#define SCENE_SLEEP_H

#include "base/message.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/scene.h"

struct Sleep {
    Pool *pool;
    /* from the scene */
    double within; /* largest move of each number of the state while the vehicle rests, in its unit */
    double after;  /* s of rest before it sleeps */
    /* during the run */
    const gic_model *model; /* of the arrays */
    int clock;              /* index of a state that only counts time, -1: none */
    bool asleep;
    int64_t slumbers; /* number of times that it fell asleep */
    double since;     /* begin of the rest; the state and all other numbers that rates depend on, then */
    double *state, *around;
    int32_t *discrete;
    const gic_road *road;
    double quiet, *input; /* inputs are constant until then; room for inputs */
};

/* read_sleep.c: reads the `sleep:` item of a scene with constant steps. */
Sleep *sleep_read(Pool *pool, const Item *item, const Model *model);
/* Begin awake at the instance's state. */
void sleep_start(Sleep *rest, const gic_model *model, gic_head *self);
/* A step asleep: time advances, the state stays. False: it is awake, or wakes for this step. */
bool sleep_step(Sleep *rest, const gic_model *model, const Scene *scene, gic_head *self);
/* After a step awake: fall asleep if it has rested long enough. */
void sleep_watch(Sleep *rest, const gic_model *model, gic_head *self);

#endif
