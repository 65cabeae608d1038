/* SPDX-License-Identifier: MIT
 *
 * run: the engines by name, and the two engines that use others. */
#ifndef RUN_ENGINES_H
#define RUN_ENGINES_H

#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/scene.h"

/* The engines' names, ended by NULL; the first is the default. */
extern const char *const engine_name[];
bool engine_known(const char *name);

/* True if it runs by itself, in any study; `page` has another engine beside it, in gicrun alone. */
bool engine_is_whole(const char *name);

/* True if it runs generated code; other engines interpret the model. */
bool engine_generates(const char *name);

/* True if its code can have implicit steps. */
bool engine_has_implicit(const char *name);

/* The Debian packages that it needs and that are missing here; NULL: none. */
const char *engine_missing(Pool *pool, const char *name);

/* Open the engine of that name for a model. Every failure ends in diag_fail. */
const Engine *engine_open(Pool *pool, const char *name, const Model *model, const EngineOptions *options);
/* The same for a run of a scene, validated at states of it. path: its file, NULL: the code is one for all scenes;
 * drawn: what it plots is wanted. */
const Engine *engine_open_run(Pool *pool, const char *name, const Model *model, const Scene *scene, const char *path,
                              bool drawn, const EngineOptions *options);

/* Fail if the scene asks for Jacobians by shares, and the engine's code with implicit steps has none. */
void engine_check_shares(const Engine *engine, const Scene *scene);

/* engine_auto.c: the engine `tcc`, with a compiler for faster code in the background. */
const Engine *engine_auto(Pool *pool, const Model *model, const EngineOptions *options);
/* Call between two steps: faster code, which gives the same bits from the state of `present` on; NULL: not yet, or
 * never. The first call starts the compiler, so use it for long runs. */
const gic_model *engine_faster(const Engine *engine, const gic_head *present);
/* The same, once the compiler is through: for runs that can't wait later. NULL: there is none, or a signal has arrived.
 */
const gic_model *engine_settle(const Engine *engine, const gic_head *present);
/* The outcome of that, for people; NULL: not begun or not finished. */
const char *engine_remark(const Engine *engine);
/* Call after the last step: ends the work begun by engine_faster. */
void engine_rest(const Engine *engine);
/* engine_tcc.c: generated code compiled into memory; the engine `tape` if the system refuses to execute that. */
const Engine *engine_tcc(Pool *pool, const Model *model, const EngineOptions *options);

#endif
