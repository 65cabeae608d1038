/* SPDX-License-Identifier: MIT
 *
 * A vehicle at rest sleeps: models/SCENE.md section 9. */
#ifndef REST_H
#define REST_H

#include "gicrun.h"

struct Rest {
    Pool *pool;
    /* as the scene has it */
    double within; /* how far each number of the state may move while the vehicle rests, in its unit */
    double after;  /* s that it has to rest before it sleeps */
    /* as the run has it */
    const gic_model *model; /* that the arrays are for */
    int clock;              /* index of a state that is nothing but time, -1: none */
    bool asleep;
    int64_t slumbers; /* times that it fell asleep */
    double since;     /* it rests; the state, and all else that rates depend on, then */
    double *state, *around;
    int32_t *discrete;
    const gic_road *road;
    double quiet, *input; /* inputs stay till then; room for them */
};

/* scene_rest.c: the `sleep:` item of a scene with constant steps. */
Rest *rest_read(Pool *pool, const Item *item, const Model *model);
/* rest.c: awake at the instance's state. */
void rest_start(Rest *rest, const gic_model *model, gic_head *self);
/* A step asleep: time goes on, the state stays. False: it is awake, or wakes for this step. */
bool rest_step(Rest *rest, const gic_model *model, const Scene *scene, gic_head *self);
/* After a step awake: has it rested long enough? */
void rest_watch(Rest *rest, const gic_model *model, gic_head *self);

#endif
