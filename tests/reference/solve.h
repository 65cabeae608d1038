/* SPDX-License-Identifier: MIT
 * Positions, velocities and accelerations of the whole mechanism: the plain augmented system of all bodies in
 * world-frame Cartesian coordinates with Euler parameters, dense, in quadruple precision. */
#ifndef REFERENCE_SOLVE_H
#define REFERENCE_SOLVE_H

#include "mechanism.h"
#include "powertrain.h"

/* A state as FORMAT.md section 10 has it, with driven coordinates among the others. */
typedef struct State {
    quad r[3], e[4], v[3], omega[3]; /* free base: origin, Euler parameters, world velocity of the origin,
                                        angular velocity in the base frame */
    quad *w, *w_rate, *w_second;     /* [coordinates]; w_second is read where they are driven */
    quad (*fast)[FAST_STATES];       /* [wheels] */
    Line line;
} State;

/* What a joint exerts on its second body at its point of that, world frame; scales: sums of magnitudes of the
 * contributions of the single terms, of the torque with what the force's arm from the centre of mass adds. */
typedef struct Reaction {
    quad force[3], torque[3], force_scale, torque_scale;
} Reaction;

/* Work space and results for one model after another state. */
typedef struct Solver {
    const Model *model;
    bool coarse;             /* factors are those of double precision, good enough for the way */
    bool brisk;              /* what needs steps below a thousandth of the way is not reached; way_* are filled */
    int rows, moving, first; /* constraint rows; bodies that move; the first of them */
    Configuration *configuration, *trial;
    Row *row;
    Factors *dependent;               /* bodies 1.. where base and coordinates are given */
    Factors *augmented;               /* all accelerations and multipliers */
    quad *unknown;                    /* work: right-hand side, then solution */
    quad (*force)[BODY_COORDINATES];  /* work: generalized forces, [bodies] */
    quad (*second)[BODY_COORDINATES]; /* result: q'' of every body */
    quad (*bias)[BODY_COORDINATES];   /* result: q'' where those of base and free coordinates are 0 */
    quad a[3], alpha[3];              /* result, free base: world acceleration of the origin; rate of omega */
    quad *w_second;                   /* result: [coordinates]; driven: as given */
    quad *drive_force;                /* result: [coordinates] multiplier along a driven one; free: 0 */
    /* result: sums of magnitudes of the contributions of the single terms to a, alpha, w'': gravity and velocity term
     * of every body, every force element, every wheel; to w'' with those to the accelerations of both its ends, whose
     * difference it is */
    quad a_scale, alpha_scale, *w_scale;
    quad *drive_scale;               /* result: the same for drive_force */
    Reaction *reaction;              /* result: [joints] */
    WheelState *wheel;               /* result: [wheels] */
    LineState line;                  /* result, of a powertrain */
    quad energy[3], energy_scale[3]; /* result: kinetic, potential; rate of their sum but for its own, W */
    double *design_determinant;      /* [subsets] subset_determinant() at the design, once that is known */
    bool design_known;
    /* result of solve_positions(): the worst condition on the way from the design, both ends included; and the smallest
     * determinant of a subset relative to that at the design, at most 1 */
    double way_condition, way_determinant;
    quad sum_error; /* result: largest deviation of the contributions' sum from the whole,
                       relative to the scale */
} Solver;

Solver *solver_new(const Model *model);
void solver_free(Solver *solver);
State *state_new(const Model *model);
void state_free(State *state);

/* The Euler parameter of largest magnitude from the other three; false when they exceed unit length. */
bool recover_largest(quad e[4]);

/* Pose of all bodies by continuation from design along the straight line of coordinates, into
 * solver->configuration->q, w. False when that is not reached: no solution, or a singular configuration on the way. */
bool solve_positions(Solver *solver, const State *state);
/* The same by Newton's iteration alone from poses that are near: pose[body][7], of body frames; those of the base are
 * not looked at. False when that does not converge to one within a hundredth of the model's length, or rad. */
bool solve_near(Solver *solver, const State *state, quad (*pose)[BODY_COORDINATES]);
/* Rates of all bodies, into configuration->rate, w_rate. After solve_positions. */
void solve_velocities(Solver *solver, const State *state);
/* Everything marked "result". After solve_velocities. */
bool solve_accelerations(Solver *solver, const State *state, const Road *road);

/* A joint's share of what solver->unknown solves; its scales are those of this solution alone. reactions.c. */
Reaction joint_reaction(const Solver *solver, int joint);

/* Energies and power (TIRES.md section 4) with their scales, from all other results. energy.c. */
void solve_energy(Solver *solver);
extern const char *const energy_name[3];

/* World position of a body's frame origin. */
void body_origin(const Model *model, const Configuration *configuration, int body, quad out[3]);
/* Is it the free base alone, or the ground, which nothing is recovered for? */
bool is_base(const Subset *subset);
/* Condition number (2-norm) of a subset other than that: Jacobian of its joints and coordinates with respect to
 * (L omega, velocity of the centre of mass) of its bodies, L = subset_length, rows normalized. The worst of all subsets
 * of the dump's sequence, 1 without any; and, where a force acts between two points, the model's length relative to
 * their distance. After solve_positions. condition.c. */
double subset_condition(const Solver *solver, const Subset *subset);
double worst_condition(const Solver *solver);
/* Magnitude of the determinant of the same Jacobian. */
double subset_determinant(const Solver *solver, const Subset *subset);
/* What is left across its axis, and on the right side, of the direction that tells an angle, of the angle for which
 * that is least: 1 at the design, 0 where it tells none. Rows are evaluated. */
double angles_told(const Solver *solver);
/* Of way_condition and way_determinant (the least of angles_told, too): the present configuration is the design, as far
 * as bodies stand relative to the base; it is on the way. Rows are evaluated. */
void begin_way(Solver *solver);
void go_on(Solver *solver);

#endif
