/* SPDX-License-Identifier: MIT
 *
 * Steps that are too long although none is refused: a motion that grows from step to step until tires or stops hold it
 * (FORMAT.md section 14). A run with constant steps is watched as it goes, at no cost that is felt, and judged after
 * it. */
#ifndef RUN_STABILITY_WATCH_H
#define RUN_STABILITY_WATCH_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/run.h"
#include "scene/scene.h"

typedef struct StepTheory StepTheory;
typedef struct StepWatch StepWatch;

/* What the runs of a model have in common: its equations for small motions, opened when first asked for. The model: for
 * code for any scene, before scene_narrow(). */
StepTheory *step_theory_new(Pool *pool, const Model *model);
/* The sum of squares of the angular frequencies, 1/s^2, that springs make at a state of a scene's run by an engine
 * that integrates the state of FORMAT.md section 10, whatever dampers do: the trace of stiffness over mass, which a
 * contact of stiffness k with a mass m behind it makes larger by k / m. NAN: not known. */
double step_theory_stiffness(StepTheory *theory, const Scene *scene, const Engine *engine, double time,
                             const double *state, const double *input, const int32_t *discrete);
/* For a run of a scene, also before scene_narrow(), by an engine. NULL: the run is not watched, because its steps
 * vary, are too few, or implicit with all states and a Jacobian of its own in each. seldom: look at few steps, for runs
 * whose instances are not at hand. */
StepWatch *step_watch_new(Pool *pool, StepTheory *theory, const Scene *scene, const Engine *engine, bool seldom);
/* Call after each step of an instance, which is only read. code: the engine's, or faster one; copy: the instance on
 * which outputs are computed (engines may keep factors for these two only); it is overwritten unless the vehicle
 * sleeps. */
void step_watch_step(StepWatch *watch, const gic_model *code, gic_head *self, gic_head *copy);
/* Number of steps, of a vehicle that is awake, before the one that step_watch_step() expects next; step_watch_pass
 * tells that they have been made. */
int64_t step_watch_idle(const StepWatch *watch);
void step_watch_pass(StepWatch *watch, int64_t steps);
/* After the run: what is wrong with it, with the time from which on it is, the quantity that moves and the longest
 * step; *remedy: what to do about it. NULL: nothing. */
const char *step_watch_judge(StepWatch *watch, const char **remedy);

#endif
