/* SPDX-License-Identifier: MIT
 *
 * range_watch: coordinates that leave the ranges that the model states for them, as rows show. */
#ifndef RUN_RANGE_WATCH_H
#define RUN_RANGE_WATCH_H

#include "base/pool.h"
#include "base/text.h"
#include "gic_runtime.h"
#include "model/model.h"

typedef struct RangeWatch RangeWatch;

/* For one run of a model; nothing has been seen yet. */
RangeWatch *range_watch_new(Pool *pool, const Model *model);
/* At a row: `at` is an instance of `code`, whose state array has coordinates (m or rad) at code->coordinate_state[]. */
void range_watch_look(RangeWatch *watch, const gic_model *code, const gic_head *at);
/* A line for each coordinate that was outside: since when (s), and how far it went (m or rad). */
void range_watch_print(const RangeWatch *watch, Text *out);

#endif
