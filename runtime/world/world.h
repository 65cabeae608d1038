/* SPDX-License-Identifier: MIT
 *
 * What interpreted engines share: a mechanism in the world frame with Euler parameters, Serban and Haug 2000,
 * section 2. Generalized coordinates of a body are q = (r, p), 7 numbers: its centre of mass in the world and its Euler
 * parameters, always of unit length; generalized velocities q' = (r', p'), accelerations q''. omega = 2 E(p) p', omega'
 * = 2 E(p) p''. Vectors are world components unless said otherwise.
 *
 * No formula here comes from the generator, on purpose: what joints consist of, forces, tires, the powertrain with its
 * changes of gear and the values of formulas are written a second time, so that one judges the other.
 *
 * Everything that an evaluation writes belongs to the World and is free between calls; what an instance must remember
 * belongs to the instance (compare/interpreted.h). */
#ifndef WORLD_WORLD_H
#define WORLD_WORLD_H

#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "world/equations.h"
#include "world/wheel.h"

enum { BODY_Q = 7, ROW_J = 2 * BODY_Q, TIE_ROWS = 6 };

/* A joint, or the definition of a dual coordinate Psi(w, q) = 0: rows of equations between two bodies. */
typedef struct Tie {
    int body[2], joint, coordinate; /* index in the model, or -1 */
    int rows, first;                /* equations, and the place of the first one among all */
    int parts;                      /* what it consists of; world.c */
    const Law *law;                /* of a gear or coupler: the value that it holds, as a coordinate has one; or NULL */
    double arm[2][3];              /* points from the centres of mass, body frames */
    double axis[2][3], side[2][3]; /* u_a, u_b; two directions perpendicular to u_a, in body a */
    double other[3];               /* second side, in body b; of an angle f_1 */
    double length, offset;
} Tie;

/* World components of a tie's vectors at the last evaluation: what gamma needs again. */
typedef struct TieVectors {
    double arm[2][3], d[3] /* from the first point to the second */, axis[2][3], side[2][3], other[3];
} TieVectors;

/* Where a part can push another one and not pull it: a wheel on the road, one end of a stop. m, or rad */
typedef struct Touch {
    double depth, rate;      /* > 0: the parts have met; its rate */
    double elastic, damping; /* what would push, the sum of both, if it were one that could pull, too */
} Touch;

/* The powertrain at one moment, POWERTRAIN.md section 3: theta, i, T_e, omega_t, T_t, T_p. */
typedef struct Driveline {
    double throttle, ratio, engine_torque, turbine_speed, turbine_torque, pump_torque;
} Driveline;

typedef struct World {
    const Model *model; /* assembled */
    const Sequence *sequence;
    int bodies, first;                /* first: 0 where the base moves, 1 where it is ground */
    int ties, rows;                   /* joints in the order of the file, driven coordinates, free coordinates */
    int constraints, constraint_rows; /* how many of them, from the first, are joints and driven coordinates */
    Tie *tie;
    int *coordinate_tie;        /* [coordinates] */
    double size;                /* largest distance of a tie's point from its body's centre of mass, at least 0.01 m;
                                 * without such distances the range of a length or translation */
    double (*q_design)[BODY_Q]; /* [bodies] at the assembled design */

    /* what an evaluation starts from */
    double time;
    const double *input, *parameter, *port;
    const gic_road *road;
    int32_t lane;
    const double *linked, /* [signals] components of outputs where bodies are not known, from links; NULL: they are */
        *fast; /* [fast states] of wheels with tires and of the powertrain: TIRES.md, POWERTRAIN.md section 2 */
    const int32_t *gear; /* [POWERTRAIN_DISCRETE] of the powertrain */

    /* configuration: engines fill it, body by body (world_set_q, world_set_rate) and coordinate by coordinate. Ground
     * of a fixed base is there from the beginning. */
    double (*q)[BODY_Q], (*A)[9];      /* [bodies]; A: body axes to world axes */
    double (*qd)[BODY_Q], (*omega)[3]; /* [bodies] */
    double *x, *xd, *xdd;              /* [coordinates] */

    /* equations: world_rows(), world_gamma() */
    double *value;    /* [rows] Phi, Psi; m, m^2 / 2 of lengths, or 1 */
    double *J;        /* derivatives by q; a tie: two blocks [its rows][7], one a body, from ROW_J x its first row on.
                       * The derivative along p itself is 0, as if p were brought to unit length */
    double *dual;     /* [coordinates] Psi_w */
    double *tie_dual; /* [ties] the same of those that measure, gears and couplers too */
    double *gamma;    /* [rows] J q'' + Psi_w w'' = gamma */
    TieVectors *vectors; /* [ties] */

    /* applied forces: world_forces() */
    double (*wrench)[6]; /* [bodies] force and torque about the centre of mass; gravity is among them */
    double *along;       /* [coordinates] generalized force on w */
    int *order;          /* [forces] elements, those whose formulas read others after these */
    double *element;     /* [forces] Q or T of FORMAT.md section 7 */
    double *extent;     /* [forces] length (m) of elements between points, angle (rad) of those about an axis, else 0 */
    double (*wheel)[4]; /* [wheels] fz, deflection, deflection rate, road height */
    WheelMotion *motion; /* [wheels] with tires */
    int touches;
    Touch *touch; /* [touches] of wheels; from there on of each element the upper and the lower end. Those that can't
                   * touch have a depth of 0 */
    Rolling *rolling;    /* [wheels] with tires */
    Driveline driveline; /* of the powertrain */
    double *fast_rate;   /* [fast states] */
    double potential;    /* J, of springs */
    double shortest;     /* m, distance of the two points of an element that are nearest to each other */
    bool unclear;        /* the angle of an element about an axis has no value here, or jumps by a whole turn */
    double stored;       /* W, its rate */
    double power;        /* W, of all applied forces but gravity and springs; drives of coordinates apart */

    /* solution: world_accelerate() */
    double (*qdd)[BODY_Q], (*alpha)[3]; /* [bodies] alpha = omega' */
    double *multiplier;                 /* [rows] of constraints: M q'' + J^T multiplier = Q */
    Equations *equations;
    const Solver *solver;
    void *solving;
    int lost; /* after GIC_ERROR_MASS: the subset whose joints or drives are not independent of the others */
} World;

/* ---- world.c: kinematics --------------------------------------------------------------------------------- */

/* Everything that can be known before the first evaluation; bodies stand at the design. model: assembled. */
World *world_new(Pool *pool, const Model *model, const Sequence *sequence);
/* The same without a solver for accelerations; bodies may be without mass. */
World *world_unsolved(Pool *pool, const Model *model, const Sequence *sequence);
/* The model's numbers anew, after those that follow tunable parameters have changed: ties, masses, and as q_design the
 * poses of the drawing. */
void world_adopt(World *world);
/* p must have unit length. */
void world_set_q(World *world, int body, const double q[BODY_Q]);
void world_set_rate(World *world, int body, const double qd[BODY_Q]);
/* q += dq, then p back to unit length. */
void world_move(World *world, int body, const double dq[BODY_Q]);
/* Base from the state of FORMAT.md section 10, e of unit length. */
void world_set_base(World *world, const double r[3], const double e[4], const double v[3], const double omega_body[3]);

/* value of a tie's rows at the present q and x; leaves its vectors. */
void world_values(World *world, int tie);
/* The same with J and dual. False on the wrong branch: half a turn from where the equations are meant to hold. */
bool world_rows(World *world, int tie);
/* gamma from the vectors of the last call of one of the above, rates and xd. */
void world_gamma(World *world, int tie);
/* What rates or accelerations w [coordinates] add to the first row of a tie; 0 if it measures nothing. */
double world_dual(const World *world, int tie, const double *w);
/* J x of a row, x one of q', q'' or the like. */
double world_product(const World *world, int tie, int row, const double (*x)[BODY_Q]);
/* A dual coordinate as the explicit function of q and q': out = w, w'. An angle is the one nearest to `near`. Leaves
 * the tie's vectors, J and dual for that w. */
void world_coordinate(World *world, int coordinate, double near, double out[2]);
/* Largest constraint residual at the present configuration, relative to world->size; of one tie alone. */
double world_residual(World *world);
double world_tie_residual(World *world, int tie);

/* ---- coupling.c: formulas of gears and couplers ---------------------------------------------------------- */

/* A formula of coordinates, and its first and second derivative along `way` [coordinates]; NULL: value alone. */
typedef struct Jet {
    double value, rate, second;
} Jet;

Jet world_jet(const World *world, const Law *law, const double *way);

/* ---- forces.c: forces ----------------------------------------------------------------------------------- */

/* A formula at the World's coordinates, inputs, parameters and time; local: what the place of the formula offers. */
double world_law(const World *world, const Law *law, const double *local);
/* The sum of the magnitudes of its terms. */
double world_law_size(const World *world, const Law *law, const double *local);
/* signals.c: the value of a signal, of elements that have been evaluated. */
double world_signal(const World *world, int signal);
/* False where rounding decides whether a bushing has turned too far. */
bool world_bushing_is_sure(const World *world, const Force *force);
/* Motion of an element FORCE_AERO through the air, m/s, in the axes of its body. */
void world_airflow(const World *world, const Force *force, double u[3]);
/* Orders the elements by what their formulas read. */
void world_order(World *world);
/* False where a formula with signals may come out otherwise for rounding alone: at the bound of a condition, or where
 * an attitude angle or a sideslip jumps. */
bool world_signals_are_sure(const World *world);
/* True if the formula takes an angle by atan2 on the half line where it jumps by a whole turn: there the sign of a zero
 * decides, or rounding. */
bool world_law_jumps(const World *world, const Law *law);
/* The height of the post under a wheel, order 0, or its rate, 1; 0 where there is none. */
double world_post(const World *world, const Wheel *wheel, int order);
/* How the carrier of a wheel with a tire moves at the present configuration. Of a wheel on a post place and velocity
 * count from the post, which is the road to it. */
void world_wheel_motion(const World *world, int wheel, WheelMotion *motion);
/* All wheels with tires, and the powertrain, where carriers move as motion[] says: rates of these fast states, and
 * rolling and driveline. Of the World's configuration only formulas depend on coordinates. GIC_ERROR_ROAD as below. */
int world_wheels_turn(World *world, const double *fast, double *rate);
/* wrench, along, element, wheel, fast_rate at the present configuration. Forces along coordinates are not among the
 * wrenches before world_spread(). GIC_ERROR_ROAD where the road has no finite height. */
int world_forces(World *world);
/* Forces along coordinates as wrenches on the bodies; needs J and dual of the coordinates' ties. */
void world_spread(World *world);
/* A force along one coordinate, likewise. */
void world_push(World *world, int coordinate, double force);

/* ---- powertrain.c: the powertrain (POWERTRAIN.md) ----------------------------------------------------------- */

/* Rates of its fast states and of the spins of its wheels, half shaft torques as their drive, and driveline; after the
 * wheels have turned by themselves. */
void world_drive(World *world, const double *fast, double *rate);
/* Section 4 at these fast states: does a shift begin? Then gear has changed. */
bool world_shift(const World *world, const double *fast, int32_t gear[POWERTRAIN_DISCRETE]);
/* True if formulas that decide on shifting read coordinates of the mechanism. */
bool powertrain_watches_coordinates(const Powertrain *powertrain);

/* ---- accelerate.c: equations of motion ------------------------------------------------------------------- */

/* Choose the solver, and let it do what depends on the mechanism alone. world_new() begins with the topology-based
 * one. */
void world_set_solver(Pool *pool, World *world, const Solver *solver);
/* q'' and multipliers, alpha, and w'' of free coordinates (Serban and Haug 2000, equation 16; multipliers of free
 * coordinates' rows are known beforehand and among the wrenches). Needs wrench, J, dual and gamma of all ties, and xdd
 * of driven coordinates. GIC_ERROR_MASS where the constraints are not independent, or masses so unequal that they seem
 * not to be; `lost` tells where. */
int world_accelerate(World *world);

/* ---- outputs.c ------------------------------------------------------------------------------- */

/* All components of one output. */
void world_output(const World *world, const Output *output, double *out);
/* All components of all outputs at the present configuration and its accelerations. */
void world_outputs(const World *world, double *out);
/* World poses of the body frames, 7 numbers a body; signs as FORMAT.md section 9 has them. */
void world_poses(const World *world, double *pose);
/* The largest constraint residual, balance of the equations of motion, and of power: constraints do no work. symmetry
 * is 0 and smallest_pivot 1, for no mass matrix of the independent coordinates is built here. */
void world_self_test(World *world, gic_self_test *result);

#endif
