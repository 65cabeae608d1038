/* SPDX-License-Identifier: MIT
 *
 * Why a run ended with a status, and what to do about it. */
#ifndef RUN_RUN_REMEDY_H
#define RUN_RUN_REMEDY_H

#include "gic_runtime.h"
#include "model/model.h"
#include "run/dead_centre.h"

/* What to do about a run that ended with a status; NULL: nobody knows. */
const char *run_remedy(int status);
/* The same where its start failed. */
const char *run_remedy_at_start(int status);
/* The dead centre at which a run ended with this status, with the subset's name in the finding; finding NULL: there is
 * none. The others as in dead_centre_find(). */
DeadCentre run_dead_centre(Pool *pool, const Model *model, const gic_model *code, gic_head *last, int status,
                           int subset);

#endif
