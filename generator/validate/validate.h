/* SPDX-License-Identifier: MIT
 *
 * Translation validation: before code is written or run, its blocks are evaluated at some states, and the results are
 * compared with definitions that share no formula with them.
 *
 *     blocks of the formulation  -- play.c -->  numbers at states (states.c)
 *                                                 |  run.c: calls the blocks as the templates do
 *                                                 v
 *     joints, bodies, forces  -- runtime/world/world.c -->  compared in compare.c, reported in validate.c
 *
 * play.c interprets a block as it is emitted (after balancing, scheduling and packing), several states side by side;
 * numbers that no block has stored are NAN. The other side is the World of the comparison engines
 * (runtime/world/world.h): joints and coordinates in world coordinates with Euler parameters, forces body by body,
 * tires and powertrain by formulas of their own. The World takes poses, velocities and accelerations from the blocks
 * and nothing else. Compared are, block by block:
 *
 *     solve: all joints and coordinates fit, and rotations are rotations.
 *     solve: J q' + Psi_w w' = 0 for the velocities, and for the twists S of unit rates of the coordinates.
 *     solve: J q'' + Psi_w w'' = gamma for the accelerations.
 *     dynamics: the virtual power of Newton's and Euler's equations vanishes for each independent coordinate.
 *     dynamics: rates of coordinates and of the base's pose are its velocities.
 *     link, torque, contact, tire, balance, drive: forces on carriers, slips, loads, rates of fast states.
 *     outputs, poses: their definitions.
 *     wrenches, react: reactions of the topology-based solver.
 *     predict, chord: the first correction is of second order in the move, the next one is smaller.
 *     inverse, energy: residual of the equations of motion at any accelerations; both sides of the power balance.
 *     shift: the numbers that decide on a change of gear.
 *     derive: all of these for other values of geometric parameters.
 *
 * Code in lanes is validated in the same way, with rows of lanes. Code for one scene is compared with code for any
 * scene, at states that the scene can have, with its inputs at times of its whole duration: symmetric states if it
 * computes one side for both, and numbers on both sides of thresholds in formulas. Code for many vehicles and code in
 * single precision are printed from the same blocks.
 *
 * Not validated here: the printing of blocks as C (emit/block_text.c) and the templates, which tests compare with the
 * tape; the choice among several poses that fit, since run.c follows its own way to them.
 *
 * Tolerances (validate.c) are relative to the magnitudes of the terms. A state that a block refuses (a status), or at
 * which forces are not finite, is skipped; with GICGEN_VALIDATION in the environment gicgen prints the number of
 * skipped states, and the largest difference of each kind. States are the same in every run.
 *
 * build/check/gicgen_planted is gicgen with errors that can be planted (base/plant.h): tests/system/test_validation.sh
 * plants each of them and checks that it is found. */
#ifndef VALIDATE_VALIDATE_H
#define VALIDATE_VALIDATE_H

#include "specialize/specialize.h"
#include "vehicle/vehicle.h"

/* Ends in diag_fail with "gicgen found an error of its own" if a comparison fails. scene NULL: the formulation is
 * for any scene. */
void formulation_validate(Pool *pool, const Formulation *formulation, const Validation *scene);

#endif
