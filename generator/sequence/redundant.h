/* SPDX-License-Identifier: MIT
 *
 * Joints whose equations repeat those of others, and types with the missing equations only. */
#ifndef SEQUENCE_REDUNDANT_H
#define SEQUENCE_REDUNDANT_H

#include "base/message.h"
#include "model/model.h"

/* A remedy for bodies whose joints and dual coordinates are too many, or repeat each other: joints with fewer equations
 * that leave the same motions, and what coordinates these motions then need, each as an entry of the file. body
 * [bodies]: those that are to be determined, all others stand still; edge [joints + coordinates]: what determines them.
 * NULL: none is found. joints_stay: only coordinates may change. *at: the place of the first thing to change. */
const char *relax_suggest(Pool *pool, const Model *model, const bool *body, const bool *edge, bool joints_stay,
                          Place *at);

/* An entry for coordinate `coordinate` that goes on where it turns back, on the way from the drawing towards `value`;
 * NULL: it is not found to turn back there, or nothing else goes on. body, edge: as above; all other coordinates stand
 * still. *always: it turns back nowhere. */
const char *relax_instead(Pool *pool, const Model *model, const bool *body, const bool *edge, int coordinate,
                          double value, bool *always);

#endif
