/* SPDX-License-Identifier: MIT
 *
 * The last state of a run that has outputs. A step may lead to a state that has none, which shows only in the next one,
 * when it can't begin: AB3 has no rate there before. So states before the last two steps are kept. */
#ifndef RUN_LAST_GOOD_H
#define RUN_LAST_GOOD_H

#include "engine/engine.h"

typedef struct LastGood LastGood;

LastGood *last_good_new(Pool *pool, const Engine *engine);
/* At the start of a run: nothing is kept. */
void last_good_forget(LastGood *good);
/* Before a step, and before a driver looks: keep what outputs depend on. */
void last_good_keep(LastGood *good, const gic_model *model, const gic_head *self);
/* After a step of `self` has failed, or its outputs have: make `copy` the last state that is kept and has outputs, with
 * these computed, and what `failed` (which may be `copy`) knows of the failure. False: there is none. */
bool last_good_outputs(const LastGood *good, const gic_model *model, const gic_head *self, const gic_head *failed,
                       gic_head *copy);

#endif
