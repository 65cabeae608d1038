/* SPDX-License-Identifier: MIT
 *
 * A stretch of a run made again in small steps, by another method: does the run move where these come to rest, or stay
 * where they move? For implicit and exponential steps, whose Jacobian may be an old one, and whose fast states may go
 * on by themselves. */
#ifndef RUN_STEP_REPLAY_H
#define RUN_STEP_REPLAY_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "scene/scene.h"

/* What a stretch of both shows. */
typedef struct Replay {
    int moves; /* number of state[] that the run's steps keep moving, -1: none: over more than three times the range */
    int stays; /* number of a place that they keep, though small ones move it that far and the run's are short enough to
                * show it, -1: none */
} Replay;

/* Goes on from an instance of a scene's run, which is only read, for some steps with inputs held, by the run's steps
 * and by `parts` steps of RK4 in each, and compares ranges within the last of these steps. Those below longest[i] / 100
 * don't count, nor do any where a step fails. longest: [states] the largest ways in a step that the run's results show.
 */
Replay step_replay(Pool *pool, const Engine *engine, const Scene *scene, const gic_head *from, int parts,
                   const double *longest);

#endif
