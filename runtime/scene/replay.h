/* SPDX-License-Identifier: MIT
 *
 * Replay of what someone did on a page of gicrun --drive: models/SCENE.md section 14. */
#ifndef SCENE_REPLAY_H
#define SCENE_REPLAY_H

#include "host/host.h"
#include "scene/hands.h"
#include "scene/scene.h"

struct Replay {
    int rows, count;            /* looks; hands */
    const double *time, *value; /* [rows] s; [rows][count] targets */
    const bool *holds;          /* [rows] from this look on the hands drive, else the scene does */
    Hand *hand;                 /* [count] */
    /* during the run */
    int next; /* row */
    bool holding;
};

/* Is the recording in a file one of a page, unlike those of --live? */
bool replay_is_of_page(Pool *pool, const char *path);
/* The scene with the hands and the parameters of a recording, up to its end. Fails if it was not recorded with the
 * model and the scene. Conditions and sleep are left out, as on the page. */
const Scene *scene_replay(Pool *pool, const Model *model, const Scene *scene, const char *path);
void replay_start(Replay *replay);
/* Do what is due at `time`, before a step of an instance with input[]. */
void replay_look(const Scene *scene, double time, double *input);
/* Write what the hands hold into input[]. */
void replay_inputs(const Replay *replay, double time, double *input);

#endif
