/* SPDX-License-Identifier: MIT
 *
 * compare: the engines of published methods, interpreted, which share no formulas with generated code, on purpose:
 * recovery, bounds and checks stand here a second time, so that one judges the other. */
#ifndef COMPARE_COMPARE_H
#define COMPARE_COMPARE_H

#include "engine/engine.h"
#include "model/model.h"

/* engine_gic.c: the method of Serban and Haug 2000, interpreted. */
const Engine *engine_gic(Pool *pool, const Model *model, const EngineOptions *options);
/* engine_gcp.c: generalized coordinate partitioning, with the topology-based solver and with MUMPS. */
const Engine *engine_gcp1(Pool *pool, const Model *model, const EngineOptions *options);
const Engine *engine_gcp2(Pool *pool, const Model *model, const EngineOptions *options);

#endif
