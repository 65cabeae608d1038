/* SPDX-License-Identifier: MIT
 * Why a run ended with a status, and what to do about it. */
#include "run/run_remedy.h"

const char *run_remedy(int status)
{
    switch (status) {
    case GIC_ERROR_REACH:
    case GIC_ERROR_NEWTON:
        return "a step led to where the bodies don't reach, from the state in the last row of the results: try a "
               "shorter "
               "step, and check springs, stops and driven coordinates that allow such a motion";
    case GIC_ERROR_SINGULAR:
        return "the last row of the results is the last state that the coordinates determine: choose others that do, "
               "or "
               "stops that end the motion before";
    case GIC_ERROR_RESULT:
    case GIC_ERROR_INPUT: return "the run has probably become unstable: try a shorter step";
    case GIC_ERROR_ORIENTATION: return "the base turns too far within a step, by more than 0.2 rad: try a shorter step";
    case GIC_ERROR_UNSTABLE:
        return "try a shorter step, or variable ones (--integrator adams); where that changes nothing, the model "
               "itself is unstable: gicrun --modes shows its eigenvalues";
    case GIC_ERROR_PIVOT:
        return "try a shorter step; where that changes nothing, the model itself is unstable: gicrun --modes shows its "
               "eigenvalues";
    case GIC_ERROR_ASSUMPTION: return "--general makes code that takes nothing for granted";
    case GIC_ERROR_EVENTS:
        return "try a shorter step, or a longer `duration` of the transmission's shifts; `locate: false` with "
               "constant ones goes over contacts";
    case GIC_ERROR_RESIDUAL:
        return "results so far are suspect too; --engine gic shares no formulas with this code: please report model "
               "and scene";
    case GIC_ERROR_ARGUMENT: return "the tolerance can't be reached in double precision: write a larger one";
    default: return NULL;
    }
}

const char *run_remedy_at_start(int status)
{
    switch (status) {
    case GIC_ERROR_ASSUMPTION:
    case GIC_ERROR_RESIDUAL: return run_remedy(status);
    case GIC_ERROR_RESULT:
        return "does a formula divide by zero there, or take a root of a negative number? Are initial velocities or "
               "loads too large?";
    default: return "is the initial state one that the mechanism can reach from its design?";
    }
}

DeadCentre run_dead_centre(Pool *pool, const Model *model, const gic_model *code, gic_head *last, int status,
                           int subset)
{
    DeadCentre found = {0};
    if (status == GIC_ERROR_REACH || status == GIC_ERROR_NEWTON || status == GIC_ERROR_SINGULAR)
        found = dead_centre_find(pool, model, code, last, subset);
    if (found.finding)
        found.finding = pool_print(pool, "%s: subset '%s'", found.finding, code->subset_name[subset]);
    return found;
}
