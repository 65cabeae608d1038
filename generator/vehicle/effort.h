/* SPDX-License-Identifier: MIT */
#ifndef VEHICLE_EFFORT_H
#define VEHICLE_EFFORT_H

#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"

/* Print on stderr the time and memory that code for a large model will take, FORMAT.md section 14; false: the model is
 * not large. */
bool effort_tell(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);
/* Print progress on stderr for a large model. */
void effort_step(bool told, const char *step);

#endif
