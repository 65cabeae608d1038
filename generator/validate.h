/* SPDX-License-Identifier: MIT
 *
 * Translation validation: before code is written or run, the very blocks that it is made of are evaluated at some
 * states, and what they give is compared with routes that share no formula with them.
 *
 *     blocks of the formulation  --validate_play.c-->  numbers at states (validate_states.c)
 *                                                        |  validate_run.c: what calls what, as the templates do
 *                                                        v
 *     joints, bodies, forces     --runtime/world.c-->  compared in validate.c
 *
 * validate_play.c interprets a block as it is emitted (after balancing, scheduling and packing), several states side by
 * side. The other side is the World of the comparison engines (runtime/world.h): the definitions of joints and
 * coordinates in world coordinates with Euler parameters, forces body by body, tires and powertrain by formulas of
 * their own. From the blocks it takes poses, velocities and accelerations alone, and asks of them
 *
 *   poses          every joint and coordinate fits, rotations are rotations
 *   velocities     J q' + Psi_w w' = 0; S: the same for a unit rate of each coordinate
 *   accelerations  J q'' + Psi_w w'' = gamma; the virtual power of Newton's and Euler's equations vanishes for each
 *                  independent coordinate, so that no multiplier is needed
 *   fast states    rates as tires and powertrain have them
 *   outputs        each as the World has it; poses of all bodies; the self-test's residual of the equations of motion
 *
 * The same for code in lanes, whose blocks read rows of lanes, and for code for one scene at states that the scene can
 * have, with its inputs at times of its whole duration. Batches and other number types are printed from the same blocks.
 * What it does not see: the printing of blocks as C (emit.c) and the templates, which tests compare with the tape.
 *
 * Tolerances are relative to what was added up, see validate.c. A state at which the blocks refuse to go on (a status)
 * is left out. To see that it is alive, build with PLANT=-DGICGEN_PLANT: then the environment variable GICGEN_PLANT names
 * an error that is planted (planted() in support.h), and tests/test_validation.sh sees each one found. */
#ifndef VALIDATE_H
#define VALIDATE_H

#include "narrow.h"

#include "../runtime/gic_runtime.h"

/* What a scene does, of a formulation for one: inputs at a time, its road, its duration, times at which inputs begin to
 * move or stop [moments], and inputs that may have any value at any time [inputs]. */
typedef struct Validation {
    void (*inputs)(void *context, int32_t unused, double time, double *input);
    void *context;
    const gic_road *road; /* NULL: flat */
    double duration;
    const double *moment;
    int moments;
    const bool *free;
} Validation;

/* Ends in diag_fail with "gicgen found an error of its own" where a check fails. scene: NULL: the formulation is for all
 * scenes. */
void formulation_validate(Pool *pool, const Formulation *formulation, const Validation *scene);

#endif
