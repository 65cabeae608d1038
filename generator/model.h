/* SPDX-License-Identifier: MIT
 *
 * The model: what a `.veh` file says, resolved. */
#ifndef GICGEN_MODEL_H
#define GICGEN_MODEL_H

#include "support.h"

/* ---- law.c: formulas of force laws, as FORMAT.md section 6 defines them ------------------------------------ */

typedef enum LawOp {
    LAW_NUMBER,    /* number */
    LAW_PARAMETER, /* index */
    LAW_INPUT,     /* index */
    LAW_VALUE,     /* of coordinate index */
    LAW_RATE,
    LAW_TIME,
    LAW_LOCAL, /* index: what the place of the formula offers, such as `length` */
    LAW_TABLE, /* index, arg[0] */
    LAW_CALL   /* op `call` of the expression graph with arguments */
} LawOp;

typedef struct Law {
    LawOp op;
    int call; /* an Op */
    double number;
    int index;
    const struct Law *arg[3];
    const char *name; /* as written, for the dump */
    int size;         /* nodes in it, those that its parameters are made of counted where they stand */
} Law;

/* What the names in a formula mean. */
typedef struct LawNames {
    const struct Model *model; /* coordinates, inputs, parameters, tables */
    const char *const *local;  /* names of this place, or NULL */
    int locals;
    bool hide;          /* they may hide names of the model; else a formula that uses such a one is refused */
    bool constant;      /* nothing but numbers and parameters is allowed */
    const char *remedy; /* why, when that is broken */
} LawNames;

/* Parse a scalar of the file as a formula; mistakes end in diag_fail at their place inside the text. */
const Law *law_parse(Pool *pool, const Item *item, const char *what, const LawNames *names);
/* Does the law change through a tunable parameter? */
bool law_is_tunable(const Law *law, const struct Model *model);
/* Its value at set-up, with parameters and inputs at their file's values; without locals. */
double law_number(const Law *law, const struct Model *model);

/* ---- read.c, dump.c: the model, as models/FORMAT.md defines it ----------------------------------- */

enum { BODY_BASE = 0, BODY_GROUND = -1 };

typedef enum ShapeType { SHAPE_BOX, SHAPE_CYLINDER, SHAPE_MESH, SHAPE_TYPES } ShapeType;

/* How a body is drawn; own frame. No part of the mechanics. */
typedef struct BodyShape {
    Place at;
    ShapeType type;
    double size[3];        /* edges of a box, m; 0: follow from the inertia */
    double radius, length; /* of a cylinder, m; likewise */
    bool along, placed;    /* are axis and center given? Else as the inertia suggests, and the centre of mass */
    double axis[3], center[3];
    const char *file; /* of a mesh, as it is written */
    int corners, triangles;
    double (*corner)[3];
    int (*triangle)[3]; /* anticlockwise from outside */
} BodyShape;

typedef struct Body {
    const char *name;
    Place at;
    double mass, com[3] /* own frame */;
    double inertia[6]; /* xx yy zz xy xz yz, own axes, about com; less the spin inertia of the wheels that it carries */
    double position[3], euler[4]; /* body frame at design, model frame */
    const BodyShape *shape;       /* NULL: the model names none */
} Body;

typedef enum JointType {
    JOINT_REVOLUTE,
    JOINT_SPHERICAL,
    JOINT_PRISMATIC,
    JOINT_CYLINDRICAL,
    JOINT_UNIVERSAL,
    JOINT_FIXED,
    JOINT_DISTANCE,
    JOINT_REVOLUTE_SPHERICAL,
    JOINT_POINT_ON_LINE,
    JOINT_POINT_IN_PLANE,
    JOINT_PARALLEL,
    JOINT_PERPENDICULAR,
    JOINT_TYPES
} JointType;

typedef struct Joint {
    const char *name;
    Place at;
    JointType type;
    int body[2];
    double point[2][3], axis[2][3]; /* each in the frame of its body; axes are unit vectors */
    double side[2][3];     /* a direction perpendicular to the axis of body[0] in the drawing, in both bodies */
    double length, offset; /* as the equations have them, where the type does */
    bool drawn;            /* length and offset are those of the drawing: nothing to assemble */
} Joint;

typedef enum CoordinateType {
    COORDINATE_LENGTH,
    COORDINATE_TRANSLATION,
    COORDINATE_ANGLE,
    COORDINATE_TYPES
} CoordinateType;

typedef struct Coordinate {
    const char *name;
    Place at;
    CoordinateType type;
    int body[2];
    double point[2][3], axis[3] /* frame of body[0] */;
    double reference[2][3]; /* angle: e_1 in the frame of body[0], f_1 in that of body[1] */
    double design, initial, offset, range[2];
    bool driven;
    int input; /* driven: index of its value in inputs; rate and acceleration follow */
} Coordinate;

typedef struct Input {
    const char *name, *unit;
    double initial;
} Input;

typedef struct Parameter {
    const char *name, *unit;
    Place at;
    double value;
    bool tunable;
    int index;      /* tunable: place among parameters at run time */
    const Law *law; /* what it is made of, where tunable ones are among that; else NULL */
    bool geometric; /* tunable: points, axes, masses and so on depend on it, so that it acts at set-up */
} Parameter;

/* y over rising x; slopes make it a monotone cubic (FORMAT.md section 7). */
typedef struct Table {
    const char *name;
    Place at;
    int count;
    double *x, *y, *slope;
    bool cubic;
    bool onward; /* beyond the ends: goes on straight; else constant */
} Table;

/* An external force and torque on a body, supplied at run time. */
typedef struct Port {
    const char *name;
    Place at;
    int body, in;
    double point[3];
} Port;

/* Three laws in three places: along a coordinate, between points, about an axis. */
typedef enum ForceType {
    FORCE_COORDINATE, /* spring and damper */
    FORCE_POINTS,
    FORCE_AXIS,
    FORCE_COORDINATE_LAW, /* a formula */
    FORCE_POINTS_LAW,
    FORCE_AXIS_LAW,
    FORCE_COORDINATE_STOP, /* one-sided contact */
    FORCE_POINTS_STOP,
    FORCE_AXIS_STOP,
    FORCE_LOAD, /* force and torque on a body */
    FORCE_TYPES
} ForceType;

typedef struct Force {
    const char *name;
    Place at;
    ForceType type;
    int coordinate; /* along a coordinate, else -1 */
    int body[2];    /* of points or axis, BODY_GROUND possible; FORCE_LOAD: body, and in whose frame */
    double point[2][3];
    double axis[3], reference[2][3];              /* as in Coordinate */
    const struct Law *stiffness, *damping, *free; /* of numbers and parameters */
    const struct Law *low, *high, *fade;          /* the same, of a stop; without one end NULL */
    int table;                                    /* takes the place of stiffness, else -1 */
    const struct Law *law[6]; /* [0]: generalised force, tension or torque; FORCE_LOAD: force, torque, NULL: 0 */
} Force;

bool force_is_spring(const Force *force);
bool force_is_stop(const Force *force);
bool force_is_law(const Force *force);
/* About an axis of its own. */
bool force_is_torque(const Force *force);

enum { FORCE_LOCALS = 2 }; /* of FORCE_POINTS_LAW: length, speed; of FORCE_AXIS_LAW: angle, speed */

/* ---- tires and wheels: models/TIRES.md ---- */

typedef enum TireType { TIRE_PAC2002, TIRE_TMEASY, TIRE_TYPES } TireType;
typedef enum TireSide { SIDE_LEFT, SIDE_RIGHT, SIDE_SYMMETRIC } TireSide;

/* SI units. */
typedef struct Tire {
    const char *name;
    Place at;
    TireType type;
    TireSide side; /* its own */
    int mode;      /* PAC2002: 0 to 4 */
    double radius; /* R, unloaded */
    double width;  /* for pictures only; 0: not known */
    double stiffness, damping, bottom_stiffness, bottom /* k, c, k_b, rho_b */;
    double low_speed;     /* v_low */
    double relaxation[2]; /* sigma_x, sigma_y where they are given or constant; 0: they follow from number[] */
    const double *number; /* [PAC_COUNT] or [TMEASY_COUNT], tire.h */
} Tire;

/* A contact with the road: with a tire it spins, without it is a vertical spring and damper. */
typedef struct Wheel {
    const char *name;
    Place at;
    int body;
    double center[3];                        /* frame of body */
    double radius, stiffness, damping, fade; /* with a tire: those of the tire; fade is the wheel's own */
    int tire;                                /* -1: none, and nothing below counts */
    double axis[3];                          /* s, frame of body */
    double spin_inertia;                     /* taken off the inertia of body already */
    bool mirrored;                           /* mounted on the side that is not the tire's own */
    const struct Law *drive, *brake;         /* NULL: none; local 0: spin */
    int drive_body;
    double windup;
    int fast; /* index of its first fast state among the model's: spin, slip_x, slip_y and, with a brake, brake */
} Wheel;

enum { FAST_SPIN, FAST_SLIP_X, FAST_SLIP_Y, FAST_BRAKE, FAST_MOST };

/* 3 or 4; 0 without a tire. */
int wheel_fast_states(const Wheel *wheel);

/* ---- powertrain: models/POWERTRAIN.md ---- */

/* Passes the torque at its input on to one or two outputs, each a wheel or another differential. */
typedef struct Differential {
    const char *name;
    Place at;
    int outputs;
    int wheel[2], differential[2]; /* one of the two, the other -1 */
    double ratio, split, inertia;
    const struct Law *lock; /* NULL: none */
} Differential;

typedef struct Powertrain {
    Place at;
    double inertia, idle, limit;         /* of the engine; idle, limit: 0 where there is none */
    const struct Law *throttle, *torque; /* torque: local 0 speed, 1 throttle */
    int capacity, multiplication;        /* tables of the converter */
    int forward, reverse;                /* gears */
    double *gear;                        /* [reverse + 1 + forward] ratios of gears -reverse to forward; neutral: 0 */
    const struct Law *selector;          /* NULL: forward */
    const struct Law **up, **down;       /* [forward - 1] */
    double latency, duration, turbine;   /* s, s, inertia */
    int differentials;                   /* outputs stand before what drives them; the last is the root */
    Differential *differential;
    int fast;       /* index of its first fast state among the model's */
    int start_gear; /* at set-up */
} Powertrain;

enum { POWERTRAIN_SPEED, POWERTRAIN_AGE, POWERTRAIN_FAST };       /* fast states, rad/s and s */
enum { POWERTRAIN_GEAR, POWERTRAIN_BEFORE, POWERTRAIN_DISCRETE }; /* discrete states, behind that of the base */

extern const char *const powertrain_fast_name[POWERTRAIN_FAST];
extern const char *const powertrain_discrete_name[POWERTRAIN_DISCRETE];
/* Time since the last shift at set-up, s: long ago. */
#define POWERTRAIN_FIRST_AGE 100.0

typedef enum OutputType {
    OUTPUT_POSITION,
    OUTPUT_VELOCITY,
    OUTPUT_ACCELERATION,
    OUTPUT_ORIENTATION,
    OUTPUT_ROLL_PITCH_YAW,
    OUTPUT_ANGULAR_VELOCITY,
    OUTPUT_COORDINATE,
    OUTPUT_FORCE,
    OUTPUT_DRIVE_FORCE,
    OUTPUT_REACTION,
    OUTPUT_WHEEL,
    OUTPUT_TIRE,
    OUTPUT_CONTACT,
    OUTPUT_POWERTRAIN,
    OUTPUT_ENERGY,
    OUTPUT_TYPES
} OutputType;

enum { OUTPUT_MAX_COMPONENTS = 12 };

typedef struct Output {
    const char *name;
    Place at;
    OutputType type;
    int body;                                     /* where the type has one */
    double point[3];                              /* frame of body */
    int in;                                       /* body in whose frame components are given, BODY_GROUND: world */
    int index;                                    /* coordinate, force element, joint or wheel */
    int count;                                    /* components */
    const char *component[OUTPUT_MAX_COMPONENTS]; /* full names: "chassis.x" */
    const char *unit[OUTPUT_MAX_COMPONENTS];
    bool hidden; /* for our own pages: scenes neither write nor name it */
} Output;

typedef struct Model {
    const Source *source;
    const char *name, *description;
    double gravity[3];
    bool free_base; /* body 0 is the base: the chassis, or ground with mass 0 */
    int bodies, joints, coordinates, forces, wheels, inputs, outputs, output_components;
    int parameters, tunables, tables, ports, tires, fast_states;
    Body *body;
    Joint *joint;
    Coordinate *coordinate;
    Force *force;
    Tire *tire;
    Wheel *wheel;
    Powertrain *powertrain; /* NULL: none */
    Input *input;
    Output *output;
    Parameter *parameter;
    Table *table;
    Port *port;
    struct Tuning *tuning; /* tune.c; NULL: no number but those of force laws is tunable */
    const Body *drawn;     /* [bodies] where they stand in the drawing; `body` is assembled */
} Model;

/* Discrete states: that of a free base, those of a powertrain. */
int model_discretes(const Model *model);
/* Does a `drive` of its own or the powertrain turn this wheel? */
bool wheel_is_driven(const Model *model, int wheel);

extern const char *const joint_type_name[JOINT_TYPES]; /* as in the file: "revolute" */
extern const int joint_equations[JOINT_TYPES];         /* FORMAT.md section 4 */
extern const char *const coordinate_type_name[COORDINATE_TYPES];
extern const char *const output_type_name[OUTPUT_TYPES];
extern const char *const shape_type_name[SHAPE_TYPES];

/* schema.c: a JSON Schema of `.veh` files for editors, and all their keys as a table for people; both from the reader's
 * own tables. */
void schema_print(Text *out);
void keys_print(Text *out);

/* Read and resolve a `.veh` file. Any mistake ends in diag_fail. */
const Model *model_read(Pool *pool, const char *path);
/* The model with hidden outputs of type wheel, and of tires tire and contact, of each wheel that has none. */
const Model *model_watch_wheels(Pool *pool, const Model *model);

/* States of a free base, as FORMAT.md section 10 names them: pose, then twist. */
enum { BASE_STATES = 13 };
extern const char *const base_state_name[BASE_STATES];

#endif
