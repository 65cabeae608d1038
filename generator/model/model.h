/* SPDX-License-Identifier: MIT
 *
 * model: the contents of a `.veh` file with all references resolved; formulas. SI units. */
#ifndef MODEL_MODEL_H
#define MODEL_MODEL_H

#include "base/message.h"

#include <stdbool.h>

typedef struct Item Item;   /* base/yaml.h */
typedef struct Table Table; /* base/table.h */

/* ---- formula.c: formulas of force laws, as FORMAT.md section 6 defines them */

typedef enum LawOp {
    LAW_NUMBER,    /* number */
    LAW_PARAMETER, /* index */
    LAW_INPUT,     /* index */
    LAW_STATE,     /* index, among entries of `states` */
    LAW_VALUE,     /* of coordinate index */
    LAW_RATE,
    LAW_TIME,
    LAW_LOCAL,  /* index among the local names, such as `length`, that the formula's place offers */
    LAW_SIGNAL, /* of signal index, times number: 1, or -1 where a mirror image reads what changes its sign there */
    LAW_TABLE,  /* index, arg[0] */
    LAW_CALL    /* op `call` of the expression graph with arguments */
} LawOp;

typedef struct Law {
    LawOp op;
    int call; /* an Op */
    double number;
    int index;
    const struct Law *arg[3];
    const char *name; /* as written, for the dump */
    int size;         /* nodes in it, those of its parameters counted at each use */
} Law;

typedef struct SignalReads SignalReads;

/* The meaning of the names in a formula. */
typedef struct LawNames {
    const struct Model *model; /* coordinates, inputs, parameters, tables */
    const char *const *local;  /* local names of this formula, or NULL */
    int locals;
    unsigned odd;       /* bits of those that change their sign in the mirror */
    bool hide;          /* local names hide equal names of the model; else a formula that uses such a name is refused */
    bool constant;      /* only numbers and parameters are allowed */
    const char *remedy; /* the remedy if another name is used */
    SignalReads *reads; /* where names are noted that may be signals; NULL: such a name is unknown at once */
    const char *barred; /* "formulas of gears", which may read no signals: signals noted are refused; NULL: allowed */
    const char *early; /* "states", whose formulas are evaluated before forces are known: signals that follow forces are
                        * refused; NULL: allowed */
} LawNames;

/* A name in a formula that is none of the names known when the formula is read: one of a signal, which the reader finds
 * once all outputs are read (read/signals.c). */
typedef struct SignalRead {
    Law *law; /* LAW_SIGNAL, whose index and sign the reader sets */
    const char *name;
    Place at;         /* of the name */
    const char *what; /* the formula, for messages: "value of force 'drag'" */
    bool mirrored;    /* the formula belongs to a mirror image */
    LawNames names;
} SignalRead;

struct SignalReads {
    int count;
    SignalRead *read;
};

/* End in diag_fail for a name in a formula `what` that means nothing there; more, count: further names that do. */
_Noreturn void law_name_unknown(Pool *pool, const LawNames *names, const char *what, const char *name, Place at,
                                const char *const *more, int count);

/* Parse a scalar of the file as a formula; mistakes end in diag_fail at their place inside the text. */
const Law *law_parse(Pool *pool, const Item *item, const char *what, const LawNames *names);
/* True if the value of the law follows a tunable parameter. */
bool law_is_tunable(const Law *law, const struct Model *model);
/* Value at set-up, with parameters and inputs as in the file; the law has no local names. */
double law_number(const Law *law, const struct Model *model);

enum { BODY_BASE = 0, BODY_GROUND = -1 };

typedef enum ShapeType { SHAPE_BOX, SHAPE_CYLINDER, SHAPE_MESH, SHAPE_TYPES } ShapeType;

/* How a body is drawn; own frame. No part of the mechanics. */
typedef struct BodyShape {
    Place at;
    ShapeType type;
    double size[3];        /* edges of a box, m; 0: from the inertia */
    double radius, length; /* of a cylinder, m; 0: from the inertia */
    bool along, placed;    /* axis and center are given; else they follow from the inertia and the centre of mass */
    double axis[3], center[3];
    const char *file; /* of a mesh, the path as written */
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
    const BodyShape *shape;       /* NULL: the model gives none */
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
    JOINT_SCREW,
    JOINT_RACK_AND_PINION,
    JOINT_GEAR,
    JOINT_COUPLER,
    JOINT_TYPES
} JointType;

typedef struct Joint {
    const char *name;
    Place at;
    JointType type;
    int body[2];
    double point[2][3], axis[2][3]; /* each in the frame of its body; axes are unit vectors */
    double side[2][3]; /* a direction perpendicular to the axis of body[0] in the drawing, in both bodies; of a rack
                        * the one that it moves along */
    double length,
        offset;       /* as in the joint's equations, if the type has them; of a screw, and of a rack with the
                       * other sign, the way that a turn by 1 rad makes; of a gear or coupler `value` at the design */
    const Law *value; /* of a gear or coupler: the turn or way, of numbers, parameters and coordinates */
    bool drawn;       /* length and offset are those of the drawing, so that the joint fits without assembly */
} Joint;

/* True for joints that tie a way to a turn, of which whole turns count. */
bool joint_is_geared(JointType type);
/* True for joints that hold what a coordinate measures, see joint_measure(), at a formula of coordinates. */
bool joint_is_coupled(JointType type);

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
    Place at;
    double initial;
    bool read; /* a formula names it, or it belongs to a driven coordinate */
} Input;

/* A number of the model's own that changes at a rate (FORMAT.md section 7.3), or that controllers hold (section 7.4).
 */
typedef struct State {
    const char *name, *unit;
    Place at;
    double initial;
    const struct Law *rate; /* NULL: held */
    int fast;               /* index among the model's fast states */
    bool read;              /* a formula names it */
} State;

/* What a controller holds; states by their indices in the model's `state`. */
typedef struct ControlRule {
    const char *name; /* "speed.force" */
    int state;        /* the value in effect; delayed ones follow, newest first */
    int signal;       /* of its formula, -1: a program supplies the value */
    int waiting;      /* values on their way */
    double late;      /* s from a sample to when the oldest of them takes effect; 0: at the sample */
    int effects;      /* number of the next effect; -1: late is 0 */
    double quantum;   /* 0: none */
} ControlRule;

typedef struct Controller {
    const char *name;
    Place at;
    double period, offset; /* s */
    int samples;           /* state: number of the next sample */
    int rules;
    ControlRule *rule;
} Controller;

typedef struct Parameter {
    const char *name, *unit;
    Place at;
    double value;
    bool tunable;
    int index;      /* tunable: index among tunable parameters */
    const Law *law; /* formula of tunable parameters; NULL: none */
    bool geometric; /* tunable and used by points, axes, masses and so on: it acts at set-up only */
    bool read;      /* a formula names it */
} Parameter;

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
    FORCE_AERO, /* of the air on a body */
    FORCE_BUSHING,
    FORCE_TYPES
} ForceType;

/* What FORCE_BUSHING adds. Axes of its frame: along x, y, z, then about them. */
enum { BUSHING_AXES = 6, BUSHING_NUMBERS = 21 };
typedef struct Bushing {
    double frame[2][9]; /* from its frame to that of either body, at the drawing */
    /* [BUSHING_NUMBERS] lower triangles of symmetric matrices, row by row; of numbers and parameters, NULL: 0 */
    const struct Law *stiffness[BUSHING_NUMBERS], *damping[BUSHING_NUMBERS];
} Bushing;

/* Place of an element of such a triangle. */
static inline int bushing_place(int row, int column)
{
    return row < column ? column * (column + 1) / 2 + row : row * (row + 1) / 2 + column;
}

/* Cosine of the rotation between both ends of a bushing, of 3 rad, up to which it is defined. */
#define BUSHING_COSINE (-0.99)

/* Formulas of FORCE_AERO behind the six that a load has, too. */
enum { AERO_DRAG = 6, AERO_WIND, AERO_DENSITY = AERO_WIND + 3, FORCE_MOST_LAWS };

typedef struct Force {
    const char *name;
    Place at;
    ForceType type;
    int coordinate; /* along a coordinate, else -1 */
    int body[2];    /* of points or axis, BODY_GROUND possible; FORCE_LOAD, FORCE_AERO: the body, and the body in whose
                     * frame force and torque are given */
    double point[2][3];
    double axis[3], reference[2][3];              /* as in Coordinate */
    const struct Law *stiffness, *damping, *free; /* of numbers and parameters */
    const struct Law *low, *high, *fade;          /* of a stop: the same; NULL for an end that it does not have */
    const struct Law *area, *length;              /* of FORCE_AERO: the same */
    const Bushing *bushing;                       /* of FORCE_BUSHING */
    int table;                                    /* in place of stiffness; -1: none */
    const struct Law *law[FORCE_MOST_LAWS];       /* [0]: generalised force, tension or torque; FORCE_LOAD: force,
                                                   * torque; FORCE_AERO: their coefficients, and AERO_...;
                                                   * FORCE_BUSHING: what it exerts besides; NULL: 0 */
} Force;

bool force_is_spring(const Force *force);
bool force_is_stop(const Force *force);
bool force_is_law(const Force *force);
/* True for elements about an axis. */
bool force_is_torque(const Force *force);
/* True for elements that act with force and torque, which have no single number. */
bool force_is_wrench(const Force *force);
/* How many formulas a force element has, those that are NULL counted; numbers such as stiffness are none of them. */
int force_laws(const Force *force);

/* Of FORCE_POINTS_LAW: length, speed; of FORCE_AXIS_LAW: angle, speed; of FORCE_BUSHING: displacements and their rates;
 * of coefficients of FORCE_AERO: */
enum { AERO_INCIDENCE, AERO_SIDESLIP, AERO_SPEED, AERO_LOCALS, FORCE_LOCALS = 2 * BUSHING_AXES };

typedef enum TireType { TIRE_PAC2002, TIRE_TMEASY, TIRE_TYPES } TireType;
typedef enum TireSide { SIDE_LEFT, SIDE_RIGHT, SIDE_SYMMETRIC } TireSide;

/* SI units. */
typedef struct Tire {
    const char *name;
    Place at;
    TireType type;
    TireSide side; /* the side that the data belong to */
    int mode;      /* PAC2002: 0 to 4 */
    double radius; /* R, unloaded */
    double width;  /* for pictures only; 0: unknown */
    double stiffness, damping, bottom_stiffness, bottom /* k, c, k_b, rho_b */;
    double low_speed;     /* v_low */
    double relaxation[2]; /* sigma_x, sigma_y if given or constant; 0: from number[] */
    const double *number; /* [PAC_COUNT] or [TMEASY_COUNT], tire_numbers.h */
} Tire;

/* A contact with the road: with a tire it spins, without it is a vertical spring and damper. */
typedef struct Wheel {
    const char *name;
    Place at;
    int body;
    double center[3];                        /* frame of body */
    double radius, stiffness, damping, fade; /* with a tire: those of the tire; fade is the wheel's own */
    int tire;                                /* -1: none; then the members below are unused */
    double axis[3];                          /* s, frame of body */
    double spin_inertia;                     /* already subtracted from the inertia of body */
    bool mirrored;                           /* mounted on the side other than the tire's own */
    const struct Law *drive, *brake;         /* NULL: none; local 0: spin */
    int drive_body;
    double windup;
    int fast; /* index of its first fast state among the model's: spin, slip_x, slip_y and, with a brake, brake */
    int post; /* 1 + the index of the input by which the road under it is raised, m; that of its rate follows. 0: none
               */
} Wheel;

enum { FAST_SPIN, FAST_SLIP_X, FAST_SLIP_Y, FAST_BRAKE, FAST_MOST };

/* 3 or 4; 0 without a tire. */
int wheel_fast_states(const Wheel *wheel);

/* Passes the torque at its input to one or two outputs, each a wheel or another differential. */
typedef struct Differential {
    const char *name;
    Place at;
    int outputs;
    int wheel[2], differential[2]; /* each output is one of the two; the other is -1 */
    double ratio, split, inertia;
    const struct Law *lock; /* NULL: none */
} Differential;

typedef struct Powertrain {
    Place at;
    double inertia, idle, limit;         /* of the engine; idle, limit: 0: none */
    const struct Law *throttle, *torque; /* torque: local 0 speed, 1 throttle */
    int capacity, multiplication;        /* tables of the converter */
    int forward, reverse;                /* gears */
    double *gear;                        /* [reverse + 1 + forward] ratios of gears -reverse to forward; neutral: 0 */
    const struct Law *selector;          /* NULL: forward */
    const struct Law **up, **down;       /* [forward - 1] */
    double latency, duration, turbine;   /* s, s, inertia */
    int differentials;                   /* each stands after those that it drives; the last one is the root */
    Differential *differential;
    int fast;       /* index of its first fast state among the model's */
    int start_gear; /* at set-up */
} Powertrain;

enum { POWERTRAIN_SPEED, POWERTRAIN_AGE, POWERTRAIN_FAST };       /* fast states, rad/s and s */
enum { POWERTRAIN_GEAR, POWERTRAIN_BEFORE, POWERTRAIN_DISCRETE }; /* discrete states, after that of the base */

extern const char *const wheel_fast_name[FAST_MOST]; /* "spin" */
extern const char *const powertrain_fast_name[POWERTRAIN_FAST];
extern const char *const powertrain_discrete_name[POWERTRAIN_DISCRETE];
/* Time since the last shift at set-up, s: long enough for any shift to be over. */
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
    OUTPUT_SIGNAL,
    OUTPUT_TYPES
} OutputType;

enum { OUTPUT_MAX_COMPONENTS = 12, TIRE_SPIN = 8 /* component of OUTPUT_TIRE; its rate follows */ };

typedef struct Output {
    const char *name;
    Place at;
    OutputType type;
    int body;                                     /* if the type has one */
    double point[3];                              /* frame of body */
    int in;                                       /* body in whose frame components are given, BODY_GROUND: world */
    int index;                                    /* coordinate, force element, joint, wheel or signal */
    int count;                                    /* components */
    const char *component[OUTPUT_MAX_COMPONENTS]; /* full names: "chassis.x" */
    const char *unit[OUTPUT_MAX_COMPONENTS];
    bool hidden;  /* made for pages of results or for a rule: scenes can not name it and results do not show it */
    bool sampled; /* of a rule: code for a scene has it, too */
} Output;

/* A quantity that formulas read by its name (FORMAT.md section 7.1): a formula of its own, or a component of an output.
 */
typedef struct Signal {
    const char *name, *unit;
    Place at;
    const Law *law; /* an entry of `signals`; NULL: a component of `output` */
    Output output;
    int component;
} Signal;

typedef struct Model {
    const Source *source;
    const char *name, *description;
    double *gravity; /* [3]; copies of a model share it, as tunable numbers are found by their addresses */
    bool free_base;  /* body 0 is the base: the chassis, or ground with mass 0 */
    int bodies, joints, coordinates, forces, wheels, inputs, outputs, output_components;
    int parameters, tunables, tables, ports, tires, fast_states;
    int states; /* entries of `states`, then what controllers hold */
    int controllers;
    int signals; /* entries of `signals`, then the components of outputs that formulas read */
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
    State *state;
    Signal *signal;
    Controller *controller;
    struct Tuning *tuning; /* tunable.h; NULL: only numbers of force laws are tunable */
    struct Limit *limit;   /* limits.h: of force elements' numbers that follow tunable parameters */
    int limits;
    const Body *drawn; /* [bodies] poses in the drawing; those of `body` are assembled */
} Model;

/* How many states are held, the last ones. */
int model_held(const Model *model);
/* Place of a rule's formula among the components of outputs; -1: it has none. */
int rule_output(const Model *model, const ControlRule *rule);

/* True if whole turns of angles move something: adding 2 pi to one is another configuration. */
bool model_counts_turns(const Model *model);

/* Number of discrete states: one of a free base, and those of a powertrain. */
int model_discretes(const Model *model);

/* Where a force begins or ends: a wheel, or an end of a stop. */
typedef struct ContactSite {
    const Wheel *wheel; /* NULL: an end of `stop` */
    const Force *stop;
    bool high;
} ContactSite;

/* Contact `index` in the order of Formulation.contacts; false: there is none. */
bool model_contact(const Model *model, int index, ContactSite *site);
/* "wheel 'left'", "the high end of stop 'bump'" */
const char *contact_text(Pool *pool, const ContactSite *site);
/* True if the wheel has a `drive` or the powertrain drives it. */
bool wheel_is_driven(const Model *model, int wheel);

extern const char *const joint_type_name[JOINT_TYPES]; /* as in the file: "revolute" */
extern const int joint_equations[JOINT_TYPES];         /* FORMAT.md section 4 */
extern const char *const coordinate_type_name[COORDINATE_TYPES];
extern const char *const output_type_name[OUTPUT_TYPES];

/* States of a free base, as FORMAT.md section 10 names them: pose, then twist. */
enum { BASE_STATES = 13 };
extern const char *const base_state_name[BASE_STATES];

/* True if a component of outputs of this type follows from the motion of bodies alone, spins of wheels included. */
bool output_is_motion(OutputType type, int component);
/* True if an output is of a type, or a signal whose formula reads such an output. */
bool output_reads(const Model *model, const Output *output, OutputType type);
/* True if an output or the formula of a force element reads an output of a type. */
bool model_reads(const Model *model, OutputType type);
/* True if an output asks for the reaction of this joint; for the drive force of this coordinate. */
bool reaction_wanted(const Model *model, int joint);
bool drive_wanted(const Model *model, int coordinate);

/* What a joint with a formula holds at its value; -1: the joint has no formula. */
int joint_measure(JointType type);
/* True if a formula reads the value of this coordinate; of any if coordinate is -1. */
bool law_follows(const Law *law, int coordinate);
/* True if a joint has a formula that does. */
bool joint_follows(const Joint *joint, int coordinate);

/* Call `see` for the signals that a formula reads by name, without those which they read in turn; law NULL: none. */
void law_signals(const Law *law, void (*see)(void *user, const Law *signal), void *user);

/* The name of a body without mass, ground excepted; NULL: there is none. */
const char *model_massless(const Model *model);

/* The number of wheels with tires before this one. */
int wheel_rolling(const Model *model, int wheel);

#endif
