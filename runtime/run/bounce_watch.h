/* SPDX-License-Identifier: MIT
 *
 * Contacts that give back more than they may because steps are too long for them (FORMAT.md section 14). A run with
 * constant steps is watched as it goes, on an instance of the watch's own: results keep their digits. */
#ifndef RUN_BOUNCE_WATCH_H
#define RUN_BOUNCE_WATCH_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/stability_watch.h"
#include "scene/scene.h"

typedef struct BounceWatch BounceWatch;

/* For a run of a scene, before scene_narrow(), by an engine. NULL: steps vary, the code has no contacts, or the engine
 * integrates numbers of its own. */
BounceWatch *bounce_watch_new(Pool *pool, StepTheory *theory, const Scene *scene, const Engine *engine);
/* Call before the first step and after each step of an instance, which is only read. code: the engine's, or faster one.
 */
void bounce_watch_step(BounceWatch *watch, const gic_model *code, const gic_head *self);
/* Number of steps before the one that bounce_watch_step() looks at next; bounce_watch_pass() stands for calls for so
 * many of them at most. */
int64_t bounce_watch_idle(const BounceWatch *watch);
void bounce_watch_pass(BounceWatch *watch, int64_t steps);
/* After the run: the contact that gives back too much, when and by how much; *remedy: what to do about it. NULL:
 * nothing was found. */
const char *bounce_watch_judge(const BounceWatch *watch, const char **remedy);

#endif
