/* SPDX-License-Identifier: MIT
 *
 * The equations of motion of bodies under constraints as one linear system for accelerations and multipliers
 * (Serban and Haug 2000, equation 16), and what solvers of it share.
 *
 *     M q'' + Phi_q^T lambda = Q,   Phi_q q'' = gamma,   q = (r, p) a body: mass centre and Euler parameters
 *
 * Euler parameters have no inertia along p itself, so M is singular. A body's six accelerations y, in which its mass
 * matrix is the identity, replace its seven: r'' = y_r / sqrt(m) and p'' = H y_p - (p' . p') p, where H = G^T T / 2
 * and T T^T is the inverse of the inertia about the mass centre in body axes. The normalizations are gone, and with
 * Y = Phi_q dq''/dy all is one symmetric matrix whose sparsity is the mechanism's graph:
 *
 *     [ -I  Y^T ] [ -y     ]   [ f      ]      f: applied forces and gyroscopic moments, scaled like y
 *     [  Y   0  ] [ lambda ] = [ -gamma ]      gamma: less what (p' . p') p contributes
 *
 * Dual coordinates w that are free have no rows here: they have no inertia, so where an element acts along w with Q_w,
 * the multiplier of Psi(w, q) = 0 is Psi_w^-T Q_w; its force -Psi_q^T Psi_w^-T Q_w on the bodies is an applied one, and
 * w'' follows from q''. Driven ones are constraints like joints, and their multiplier is the drive's.
 */
#ifndef WORLD_EQUATIONS_H
#define WORLD_EQUATIONS_H

#include "base/pool.h"

#include <stdbool.h>

/* Rows of Phi that concern the same two bodies: a joint, or a driven coordinate. */
typedef struct Constraint {
    int body[2]; /* BODY_GROUND: none */
    int rows;    /* 1 to 6 */
} Constraint;

/* Constants of a body. */
typedef struct Mass {
    double root;             /* 1 / sqrt(m) */
    double inertia[9], T[9]; /* T: upper triangular */
} Mass;

/* Mechanism and masses. Body 0 is the base; it does not move where the base is fixed. */
typedef struct Equations {
    int bodies, constraints, rows;
    bool free_base;
    const Constraint *constraint;
    int *first; /* [constraints + 1] first row of each */
    Mass *mass; /* [bodies] */
} Equations;

/* What changes from one solution to the next. A body that does not move has rates of 0. */
typedef struct Numbers {
    const double *q, *rate; /* [bodies][7] r, p (of unit length) and their rates */
    const double *jacobian; /* a constraint: two blocks [rows][7], one a body, from 14 x its first row on */
    const double *gamma;    /* [rows] */
    const double *force;    /* [bodies][6] applied force, and moment about the mass centre, world axes */
    double *acceleration;   /* out: [bodies][7] q'' */
    double *multiplier;     /* out: [rows] lambda */
} Numbers;

/* Two ways of solving, interchangeable. */
typedef struct Solver {
    const char *name;
    /* All that depends on the mechanism alone. Exits with a message when memory is out. */
    void *(*open)(Pool *pool, const Equations *equations);
    /* Accelerations and multipliers. Returns -1, or the constraint that is not independent of the others; then there is
     * no result. Numbers that aren't finite give results that aren't, or are refused. */
    int (*solve)(void *solver, const Numbers *numbers);
    /* Give back what doesn't come from the pool. */
    void (*close)(void *solver);
} Solver;

/* The block elimination of topology.c; no allocation but in open. */
extern const Solver topology_solver;
/* MUMPS, a sparse solver for general symmetric matrices; compare/mumps.c. */
extern const Solver mumps_solver;

/* Keeps `constraint`. Masses are to be set before the first solution. */
Equations *equations_new(Pool *pool, int bodies, bool free_base, int constraints, const Constraint *constraint);
/* inertia: xx yy zz xy xz yz about the mass centre, body axes. May change between solutions. */
void equations_mass(Equations *equations, int body, double mass, const double inertia[6]);
/* Does the body accelerate? */
bool equations_moves(const Equations *equations, int body);

/* A body's way from y to q'' at the present motion. */
typedef struct Scaling {
    double root, H[12] /* 4 x 3 */, p[4], square /* p' . p' */;
} Scaling;

/* The scaling of a body that moves, and its f[6]. */
void equations_body(const Equations *equations, int body, const Numbers *numbers, Scaling *scaling, double f[6]);
/* Y of one constraint and body: row r, column k of it in out[row_step * r + column_step * k]. gamma[rows] becomes the
 * right-hand side for y: Phi_q times the body's (p' . p') p is added. */
void equations_side(const Scaling *scaling, int rows, const double *jacobian, double *out, int row_step,
                    int column_step, double *gamma);
/* q'' of one body from -y. */
void equations_acceleration(const Scaling *scaling, const double minus_y[6], double acceleration[7]);

#endif
