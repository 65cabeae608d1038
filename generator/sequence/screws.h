/* SPDX-License-Identifier: MIT
 *
 * Rows of joints and dual coordinates as screws, a force along a line or a couple between two bodies, and their
 * rank at assembled configurations. Private to screws.c and redundant.c. Lengths are relative to a size. */
#ifndef SEQUENCE_SCREWS_H
#define SEQUENCE_SCREWS_H

#include "model/model.h"

enum {
    BODY_TWIST = 6,
    ROWS_MOST = 6, /* of one joint */
    WALK = 16      /* configurations on each side of the design */
};

/* A joint or a coordinate as it is drawn, in the model frame. */
typedef struct Link {
    JointType type;
    bool coordinate;
    CoordinateType kind;
    int body[2];  /* index among the moving bodies, -1: stands still */
    int owner[2]; /* the same in the model */
    double point[2][3], axis[2][3], length, offset;
} Link;

/* Displacement from the drawing: x -> A x + t. */
typedef struct Pose3 {
    double A[9], t[3];
} Pose3;

typedef struct Relax {
    Pool *pool;
    const Model *model;
    int bodies, joints, coordinates, n; /* n: BODY_TWIST a body */
    int *index;                         /* [joints + coordinates] in the model */
    Link *link;                         /* the same; joints first */
    bool *gone;                         /* [joints] to be removed */
    bool *changed;                      /* [joints] */
    int counted;                        /* links whose rank counts: the joints; with the coordinates if these must
                                         * remain */
    double centre[3], size;
    int configurations;
    Pose3 *place;  /* [configurations][bodies] */
    double *A;     /* room for [rows][n] */
    double *N, *b; /* [n][n], [n] */
} Relax;

/* True if the type is one of these letters: a revolute, b spherical, c prismatic, d cylindrical, e universal, f fixed,
 * g distance, h revolute_spherical, i point_on_line, j point_in_plane, k parallel, l perpendicular,
 * m screw, n rack_and_pinion, o gear, p coupler. */
bool screws_have(JointType type, const char *letters);
/* Rank of the first `count` links without link `without` (-1: none) and without removed ones, with `other` (NULL:
 * none), at a configuration; *least: the smallest pivot. */
int screws_rank(const Relax *relax, int configuration, int count, int without, const Link *other, double *least);
/* One step from a configuration [bodies] along the allowed motion nearest to `way` [n], which is replaced by that
 * motion. False: the motion ends there. */
bool screws_step(Relax *relax, Pose3 *place, double *way);
/* Rate of a coordinate for the twist `way`. */
double screws_speed(const Relax *relax, const Link *link, const Pose3 *place, const double *way);
/* Fill place[]: the drawing, and configurations on an allowed motion, in both directions as far as it goes. */
void screws_walk(Relax *relax);

#endif
