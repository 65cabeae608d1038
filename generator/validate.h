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
 * side; numbers that no block has stored are NAN. The other side is the World of the comparison engines
 * (runtime/world.h): the definitions of joints and coordinates in world coordinates with Euler parameters, forces body
 * by body, tires and powertrain by formulas of their own. From the blocks it takes poses, velocities and accelerations
 * alone, and compares:
 *
 *   solve              every joint and coordinate fits, rotations are rotations; J q' + Psi_w w' = 0 for the
 * velocities, and for a unit rate of each coordinate with what S says; J q'' + Psi_w w'' = gamma dynamics           the
 * virtual power of Newton's and Euler's equations vanishes for each independent coordinate, so that no multiplier is
 * needed; rates of coordinates are their velocities link, torque,      forces on carriers, slips, loads, rates of fast
 * states as tires and powertrain have them contact, tire, balance, drive outputs, poses     each as the World has it
 *   wrenches, react    reactions as the topology-based solver has them
 *   predict, chord     the first correction is of second order in the move, the next one smaller
 *   inverse, energy    the residual of the equations of motion at any accelerations; both sides of the power balance
 *   shift              what a change of gear follows
 *   derive             models with geometric parameters at other values of them, too
 *
 * Code in lanes is looked at in the same way, its blocks with their rows of lanes. Code for one scene is compared with
 * code for all scenes, at states that the scene can have, with its inputs at times of its whole duration: with both
 * sides alike where it computes one side for both, with numbers to both sides of thresholds in formulas. Batches, and
 * code in single precision, are printed from the same blocks.
 *
 * Not seen here: the printing of blocks as C (emit.c) and the templates, which tests compare with the tape; which of
 * several poses that fit is found, for the way there is this file's own.
 *
 * Tolerances (validate.c) are relative to the magnitudes that were added up. A state at which a block refuses to go on
 * (a status), or at which forces are no numbers, is left out; GICGEN_VALIDATION in the environment prints how many
 * were, and the worst of each kind. States are the same in every run.
 *
 * build/check/gicgen_planted is gicgen with errors that can be planted (plant.h): tests/test_validation.sh sees that
 * each is found. */
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

/* Ends in diag_fail with "gicgen found an error of its own" where a check fails. scene: NULL: the formulation is for
 * all scenes. */
void formulation_validate(Pool *pool, const Formulation *formulation, const Validation *scene);

#endif
