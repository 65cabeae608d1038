/* SPDX-License-Identifier: MIT */
#ifndef GICGEN_EFFORT_H
#define GICGEN_EFFORT_H

#include "gicgen.h"

/* Tell on stderr what code for a large model will take, FORMAT.md section 14; false: it is not large. */
bool effort_tell(Pool *pool, const Model *model, const Sequence *sequence, Solve solve);
/* Progress on stderr, of a model that is large. */
void effort_step(bool told, const char *step);

#endif
