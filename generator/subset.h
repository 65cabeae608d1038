/* SPDX-License-Identifier: MIT
 * One class of subsets while its formulas are made: shared by the files that treat subsets, and by no other. */
#ifndef GICGEN_SUBSET_H
#define GICGEN_SUBSET_H

#include "gicgen.h"

/* An end of a joint: what it is attached to. */
typedef struct End {
    int unknown; /* local index of an unknown body, or -1 */
    int known;   /* index among the knowns, or -1; both -1: the base */
} End;

/* One joint or dual coordinate of the class. */
typedef struct Connection {
    bool is_coordinate;
    int index; /* joint or coordinate of the first member */
    End end[2];
    Fixture fixture;
    int dep;         /* coordinate: its place among the deps */
    bool still;      /* the first end's axis never turns: */
    Ex across[2][3]; /* directions perpendicular to it, base frame, which stand for `side` */
} Connection;

typedef struct Work {
    Pool *pool;
    const Model *model;
    const Sequence *sequence;
    const Class *class;
    const Subset *first; /* first member */
    const double (*origin)[3];
    Dag *dag;
    int n; /* 6 a body */
    int connections;
    Connection *connection;
    Ex *q;        /* [7 bodies] */
    Motion *pose; /* of the unknowns: c and A only, at q */
    Motion *known;
    Motion base;
    bool plain;    /* rows are made in the base's frame and without what the solution knows of directions */
    bool anchored; /* q, S, pose, row, J and factors are relative to known 0, which is at rest at the origin then */
    Ex *x, *rate, *change;
    double size;    /* see Formula */
    int derived;    /* numbers that follow tunable parameters: d[] */
    Ex *derived_of; /* [derived][members] their formulas */
    Row *row;       /* [n] equations with the unknowns at q and at rest */
    int *row_of;    /* [n] connection that a row belongs to */
    Ex *J;          /* [n][n] Jacobian by the unknown twists */
    int configurations;
    bool *alive; /* [samples] reached the end of its path */
} Work;

/* Subset of the i-th member. */
const Subset *subset_member(const Work *w, int i);
/* A constant of the class from every member's number; *formula: what it follows, where that is not 0. */
typedef double SubsetNumber(const Work *w, int member, int a, int b, Ex *formula);
Ex subset_constant(Work *w, SubsetNumber *get, int a, int b);

/* size.c. Unit of lengths of a class, m: the largest distance of a connection's point from its body's reference point; where
 * the bodies extend a hundred times as far, that up to 1 m; 1 m where all points are reference points. */
double subset_size(const Work *w);
/* Largest distance of the bodies' reference points from the base's origin at the design, m. */
double subset_distance(const Work *w);

/* drawing.c: an expression of the class's graph for a member, where the mechanism is as drawn and at rest, as a formula of
 * the model's tuning, which it must have. */
Ex subset_at_drawing(const Work *w, int member, Ex e);

/* follow.c: take one member through its sample paths. Sets the graph's samples of that member to the ends of the paths,
 * w->alive, and what later subsets need of it in `sampling`. */
void subset_follow(Work *w, Sampling *sampling, int member);

/* follow.c: take one member, at the design values of its coordinates, from the drawing to where all equations hold. q
 * [7 bodies]: its poses then, relative to the base; they go into step 0 of the sampling. False when it can't be
 * followed. */
bool subset_assemble(Work *w, Sampling *sampling, int member, double *q);

/* follow.c, pieces for scan.c and singular.c. s: a sample of the class's graph; q [7 bodies]; twists [6 bodies]; slack
 * [n]. */
void subset_set_known(Work *w, int known, int s, const double pose[12]);
void subset_set_poses(Work *w, const double *q, int s);
void subset_move_pose(double q[7], const double twist[6]);
/* Newton from q, which moves, towards residuals `slack` (NULL: 0). False when it leaps or does not converge. */
bool subset_converge(Work *w, double *q, int s, const double *slack);
/* The sample of a subset at the design configuration; q: the poses there. */
void subset_to_design(Work *w, const Sampling *sampling, int subset, double *q);
void subset_get_poses(const Work *w, const Subset *member, int s, double (*pose)[12]);
double subset_determinant(const Work *w, int s);

/* determinant.c: condition of the subset's equations at a sample, at the design mostly: 1 at best, 3 to 10 is common;
 * and the share of the design's determinant below which the subset is near a singular configuration. */
double subset_condition(const Work *w, int s);
double subset_singular_share(const Work *w, int s);

/* scan.c: warn of coordinates that stop being independent inside their ranges. */
void subsets_scan(Pool *pool, const Model *model, const Sequence *sequence, Work **work, const Sampling *sampling);

/* singular.c: end with a message when a subset is singular at the design configuration. */
void subset_explain_singular(Work *w, const Sampling *sampling, int subset);

/* split.c: leave in class c the members that share pivots with its first one, and make a class of the others. False
 * when all of them do. */
bool class_split(Pool *pool, Sequence *sequence, int c, Work *w);

/* A class with its connections, inputs and equations, ready to be followed. */
Work *subset_open(Pool *pool, const Model *model, const Sequence *sequence, const Class *class,
                  const double (*origin)[3], const Sampling *sampling);
/* Which member of the class a subset is. */
int subset_index(const Work *w, int subset);

/* hinge.c: is this angle measured about the axis of a hinge between its bodies? */
bool subset_is_hinged(const Work *w, const Connection *angle);
/* That axis in the frame of the angle's first or second body; false: there is no such hinge. */
bool subset_hinge_axis(const Work *w, const Connection *angle, int end, Ex axis[3]);
/* Its row's derivatives are those of the angle between the bodies then, ends moving as given. */
void subset_hinge_row(const Work *w, const Connection *angle, const Motion *const end[2], Row *row);

/* anchor.c: unknowns [bodies] from the subset's frame into the base's. */
void subset_to_base(const Work *w, const Motion *relative, Motion *out);
/* The same for the numbers of sample s: pose of unknown b; twist of its reference point for a unit rate of a coordinate,
 * `carrier` being the anchor's (not read: the base). */
void subset_pose_in_base(const Work *w, int b, int s, double pose[12]);
void subset_twist_in_base(const Work *w, int b, int s, const double carrier[6], double twist[6]);

/* How an end of a connection moves in the subset's frame, the unknowns moving as given. */
const Motion *subset_motion(const Work *w, const Motion *unknown, End end);

/* All rows [n] of the class with the unknowns moving as given; row_of [n]: the connection of each. */
void subset_rows(Work *w, const Motion *unknown, Row *row, int *row_of);

/* residual.c: the class's block `residual`; formula->motion and layout are there. */
void subset_residual(Work *w, Formula *formula);

/* held.c: put what joints to known bodies say into poses [bodies]: c and A where they follow, with `directions` also
 * which way hinges point; and make 0 what remains of the equations [n] of joints that c and A fulfil. */
void subset_hold(Work *w, Motion *pose, bool directions);
bool subset_holds_point(const Work *w, int body);
bool subset_holds_rotation(const Work *w, int body);
void subset_drop_held(const Work *w, Row *row, const int *row_of);

/* settled.c: put constants of the class in place of those numbers of a known's motion, in the order of its own deps,
 * that are the same in every configuration. formula: [classes] those made so far, or NULL. */
void subset_settle(Work *w, Formula *const *formula, int known, Motion *motion);
/* Find joints about an axis of a known body that never turns. */
void subset_find_still(Work *w);
/* Store no numbers any more that nobody reads because they are settled. formula: [classes] all. */
void subsets_forget(Pool *pool, const Model *model, const Sequence *sequence, Formula *const *formula);

/* closed.c: where geometry gives the poses (c and A) of the unknowns step by step: fill them, with images of the
 * vectors found on the way, checks that they are within reach, and return true. */
bool subset_closed(Work *w, Motion *pose, Block *block);

/* determinant.c: checks in `solve`, where poses may be on a wrong branch, of the guards of w->row. Returns
 * the determinant of J relative to that at the design, as the share of it that is relied on; 0: it does not vary. */
Ex determinant_check(Work *w, Formula *formula, const Factors *factors, bool closed);
/* A check that this determinant (0: none) is not lost before `ahead` is over, the bodies moving as given [bodies]. */
void determinant_check_ahead(Work *w, Formula *formula, Ex determinant, const Motion *motion);

/* inertia.c: what the bodies, moving as given, add to the equations of motion: [inertia_size]. */
Ex *subset_inertia(Work *w, const Layout *layout, const Motion *motion);

/* react.c: the class's block `react`. factors, row [n]: those that the last solution left in memory. */
void subset_react(Work *w, const Factors *factors, const Row *row, Block *block);

#endif
