/* SPDX-License-Identifier: MIT
 *
 * tape: the engine that interprets the expression graph of the generated code. */
#ifndef TAPE_TAPE_H
#define TAPE_TAPE_H

#include "engine/engine.h"
#include "model/model.h"

/* engine_tape.c: the expression graph of the generated code, interpreted. */
const Engine *engine_tape(Pool *pool, const Model *model, const EngineOptions *options);

#endif
