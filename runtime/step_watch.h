/* SPDX-License-Identifier: MIT
 *
 * Steps that are too long although none is refused: a motion that grows from step to step until tires or stops hold it
 * (FORMAT.md section 14). A run with constant steps is watched as it goes, at no cost that is felt, and judged after
 * it. */
#ifndef STEP_WATCH_H
#define STEP_WATCH_H

#include "gicrun.h"

/* For a run of a scene by an engine; model and scene: for code for any scene, before scene_narrow(). NULL: nobody
 * watches, for steps vary, or are too few for anything to be said. */
StepWatch *step_watch_new(Pool *pool, const Model *model, const Scene *scene, const Engine *engine);
/* After each step of an instance, which is only read. code: the engine's, or faster one; copy: the instance that
 * outputs are computed on, for engines may have factors for no more than those two. It is overwritten unless the
 * vehicle sleeps.
 */
void step_watch_step(StepWatch *watch, const gic_model *code, gic_head *self, gic_head *copy);
/* After the run: what is wrong with it, with the time from which on it is, the quantity that moves and the longest
 * step; *remedy: what to do about it. NULL: nothing. */
const char *step_watch_judge(StepWatch *watch, const char **remedy);

#endif
