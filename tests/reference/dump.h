/* SPDX-License-Identifier: MIT
 * The dumped model, models/FORMAT.md section 11, as the reference sees it. */
#ifndef REFERENCE_DUMP_H
#define REFERENCE_DUMP_H

#include "formula.h"

#include <stdbool.h>

enum { GROUND = -1 };

typedef struct Body {
    char *name;
    double mass, com[3], inertia[6], position[3], euler[4];
} Body;

typedef enum JointType {
    REVOLUTE,
    SPHERICAL,
    PRISMATIC,
    CYLINDRICAL,
    UNIVERSAL,
    FIXED,
    DISTANCE,
    REVOLUTE_SPHERICAL,
    POINT_ON_LINE,
    POINT_IN_PLANE,
    PARALLEL,
    PERPENDICULAR,
    SCREW,
    RACK_AND_PINION,
    GEARED,
    COUPLED,
    JOINT_TYPES
} JointType;

typedef struct Joint {
    JointType type;
    int body[2];
    double point[2][3], axis[2][3], length, offset;
    double side[2][3]; /* of a screw, rack, gear or coupler */
    Formula *value;    /* of a gear or coupler */
    char *name;
} Joint;

typedef enum CoordinateType { LENGTH, TRANSLATION, ANGLE, COORDINATE_TYPES } CoordinateType;

typedef struct Coordinate {
    char *name;
    CoordinateType type;
    int body[2];
    double point[2][3], axis[3], reference[2][3], design, offset, range[2];
    bool driven;
} Coordinate;

typedef struct Force {
    int coordinate; /* -1: between points, about an axis, or a load */
    int body[2];    /* GROUND possible; a load: body, and in whose frame (GROUND: world) */
    double point[2][3], stiffness, damping, free;
    bool about;                      /* an axis: */
    double axis[3], reference[2][3]; /* as of a coordinate */
    bool stop;                       /* contact beyond: */
    double low, high, fade;          /* infinite where there is no end */
    const Lookup *table;             /* in place of stiffness, or NULL */
    Formula *law[11];                /* NULL, or [0]: what is added to spring and damper; a load: force and torque; of
                                      * the air: coefficients of force and moment, of drag, wind, density */
    bool load, aero;                 /* aero: a load too, whose force and torque are those of the air */
    double area, reference_length;
    bool bushing; /* frame: row-major, to that of either body; law: force and torque on the second body */
    double frame[2][9], stiffness_matrix[36], damping_matrix[36];
} Force;

/* A tire, with its data by their names; a pair of TMeasy's is `name` and `name.2`. */
typedef struct Tire {
    bool tmeasy;
    int mode; /* USE_MODE */
    double radius, stiffness, damping, bottom_stiffness, bottom, low_speed, relaxation[2];
    int count;
    char (*name)[24];
    double *value;
} Tire;

typedef struct Wheel {
    char *name;
    int body;
    double center[3], radius, stiffness, damping, fade;
    const Tire *tire; /* NULL: it presses and nothing else; what follows does not count then */
    double axis[3], spin_inertia, windup;
    bool mirrored;
    Formula *drive, *brake; /* brake NULL: has none */
    int drive_body;
} Wheel;

typedef struct Differential {
    int outputs, wheel[2], differential[2]; /* one of the two, the other -1 */
    double ratio, split, inertia;
    Formula *lock; /* NULL: none */
} Differential;

typedef struct Powertrain {
    double inertia, idle, limit; /* idle, limit: 0 where there is none */
    Formula *throttle, *torque;
    int capacity, multiplication; /* tables */
    int reverse, gears, start_gear;
    double *gear; /* [gears] from the last reverse one to the last forward one */
    double latency, duration, turbine;
    int differentials;
    Differential *differential; /* the last is the root */
} Powertrain;

typedef struct Subset {
    int bodies, *body, joints, *joint, coordinates, *coordinate;
} Subset;

typedef struct Model {
    double gravity[3];
    bool free_base;
    int bodies, joints, coordinates, forces, tires, wheels, subsets;
    Body *body;
    Joint *joint;
    Coordinate *coordinate;
    Force *force;
    Tire *tire;
    Wheel *wheel;
    Powertrain *powertrain; /* NULL: none */
    Subset *subset;
    int inputs, tables, states;
    int driven_inputs; /* how many belong to driven coordinates: the first ones */
    double *input;     /* values */
    char **input_name;
    double *state; /* values of its own states */
    double *spin;  /* [wheels] of those with tires, values */
    char **state_name;
    Formula **state_rate;
    Lookup *table;
    double length; /* length scale, m: largest distance between two points at design; 1 when all coincide */
} Model;

extern const int joint_rows[JOINT_TYPES]; /* scalar equations */

/* Read a dump from a file ("-": standard input) or a text; anything unexpected fails with a message. */
Model *model_read(const char *path);
Model *model_parse(const char *text, const char *name);
void model_free(Model *model);
/* A number of a tire's data. */
double tire_number(const Tire *tire, const char *name);
/* A point given in the frame of a body, in the model frame at design. */
void design_point(const Model *model, int body, const double point[3], double out[3]);
/* Characteristic length of a subset, m: largest distance at design between its bodies' centres of mass and the points
 * of its joints and coordinates; the model's when they coincide. */
double subset_length(const Model *model, const Subset *subset);

#endif
