/* SPDX-License-Identifier: MIT
 *
 * manoeuvre: a vehicle is driven through standard manoeuvres (gicrun --manoeuvre), by the definitions of
 * models/MANOEUVRES.md. Each finds its own speed and steering, runs scenes that it writes itself, and evaluates them.
 */
#ifndef RUN_MANOEUVRE_H
#define RUN_MANOEUVRE_H

#include "base/pool.h"
#include "base/text.h"
#include "engine/engine.h"
#include "model/model.h"
#include "run/run.h"
#include "run/sheet.h"

/* ---- manoeuvre_trial.c: one run ------------------------------------------------------------------------- */

/* What is recorded, SI: the place of the centre of mass of rest, of an articulated vehicle that of its first unit,
 * carried along by the base, and its motion in the plane along and across the vehicle's heading. Signs are those of ISO
 * 8855: left, to the left and right side down count. */
typedef enum Channel {
    TRIAL_TIME,
    TRIAL_STEER, /* value of the steering coordinate */
    TRIAL_ANGLE, /* road-wheel angle that it stands for */
    TRIAL_ACCELERATOR,
    TRIAL_BRAKE,
    TRIAL_X,
    TRIAL_Y,
    TRIAL_YAW, /* not wrapped */
    TRIAL_SPEED,
    TRIAL_SIDESLIP,
    TRIAL_YAW_RATE,
    TRIAL_AX,
    TRIAL_AY,
    TRIAL_AZ,
    TRIAL_ROLL,
    TRIAL_PITCH,
    TRIAL_LOAD, /* the smallest of the wheels' loads */
    /* of articulated vehicles: the centre of mass of the last unit; its heading less that of the base; 0 of others */
    TRIAL_LAST_X,
    TRIAL_LAST_Y,
    TRIAL_LAST_YAW_RATE,
    TRIAL_LAST_AY,
    TRIAL_LAST_ROLL,
    TRIAL_ARTICULATION,
    TRIAL_CHANNELS
} Channel;

extern const gic_signal trial_signal[TRIAL_CHANNELS];

/* And of each wheel: its load, N, the height of the road under it, m, and the coordinate that moves it up and down, m
 * or rad; 0 where there is none. */
typedef enum ChannelOfWheel { TRIAL_WHEEL_LOAD, TRIAL_WHEEL_ROAD, TRIAL_WHEEL_TRAVEL, TRIAL_OF_WHEEL } ChannelOfWheel;

typedef struct Trial {
    const char *name, *scene; /* scene: its text */
    int rows;
    double (*row)[TRIAL_CHANNELS];
    double *wheel; /* [rows][wheels][TRIAL_OF_WHEEL] */
    double *state; /* the state at its end, as in models/FORMAT.md section 10 */
    int gear;
    bool tipped;     /* it leant by more than 60 degrees, which ended it */
    const char *end; /* why it could not go on; NULL: it could */
} Trial;

enum { TRIAL_OF_ONE = TRIAL_LAST_X }; /* channels of a vehicle of one unit */

typedef struct TestCar TestCar;

/* True: the run may end after this row, the last of the trial. */
typedef bool TrialStop(void *context, const Trial *trial);
/* Run a scene, with the rows of its output times. stop: NULL, to its end. Mistakes of the scene end in diag_fail. */
Trial *trial_run(TestCar *car, const char *name, const char *scene, TrialStop *stop, void *context);

/* ---- manoeuvre_units.c: articulated vehicles ------------------------------------------------------------ */

/* The first unit is that of the base, the last the one that carries the rearmost axle. Unit centres are as drawn. */
typedef struct Units {
    double first[3]; /* centre of mass of the first one, in the axes of the base's body */
    int body;        /* of the last one: its heaviest body with the axes of the drawing */
    double last[3];  /* and its centre of mass, in that body's frame */
} Units;

/* The components of model_watch_body(), from its first one on. */
enum { UNIT_POSITION = 0, UNIT_ACCELERATION = 3, UNIT_ATTITUDE = 6, UNIT_TURN = 9 };

/* NULL: the vehicle has one unit, or none that a joint about the vertical parts from the rest. */
const Units *units_find(const Sheet *sheet);
/* The channels of the last unit in a row whose others are there. output: [12] those of model_watch_body(). */
void units_motion(const double *output, double *row);

/* ---- manoeuvre_car.c: what the vehicle can do ----------------------------------------------------------- */

/* A driver who keeps a speed, as `speed` of a driver of models/SCENE.md section 5; found: false where no gains are. */
typedef struct PedalDriver {
    double speed; /* m/s at which he was found; 0: not asked for */
    double gain, integral, full[2];
    bool found;
} PedalDriver;

struct TestCar {
    Pool *pool;
    const Model *model; /* the user's, with outputs of wheels */
    Sheet sheet;        /* at rest */
    const Engine *engine;
    const gic_model *code;  /* the engine's, later maybe faster one */
    double com[3];          /* centre of mass at rest, or that of the first unit, in the axes of the base's body */
    int accelerator, brake; /* inputs of unit 1 of these names; -1: the model has none */
    const KcAxle *axle;     /* that is steered; NULL: none, `unsteered` says why */
    const char *unsteered, *steer_remedy;
    int steering;          /* input of the steering coordinate; -1: none */
    double angle;          /* mean road-wheel angle to the left by a unit of it; of wheels behind, to the right */
    double straight;       /* its value straight ahead */
    double range[2];       /* of the road-wheel angle */
    int *load;             /* [wheels] components of outputs */
    int *travel;           /* [wheels] coordinates that move them up and down; -1: none */
    const Units *units;    /* NULL: it is one */
    int unit;              /* the first component of the outputs of the last one */
    double output_step;    /* s between rows */
    const char *rest;      /* place and coordinates at rest, as keys of a scene's `initial` */
    double settled;        /* the speed that was kept last; 0: none */
    const Trial *settling; /* how it was reached by pedals; NULL: it was not */
    PedalDriver pedals;    /* who keeps it, from car_pedals() on */
    double reached;        /* the speed at the end of the last attempt to */
    const char *running;   /* gear and engine speed then, as keys of `initial` */
    const char *remedy;    /* where it could not */
    double aside[3];       /* left straight ahead: m/s^2 to the left, rad leant to the left, at a speed, m/s */
    const Request *request;
};

TestCar *car_open(Pool *pool, const Model *model, const Request *request);
/* End with a message: the vehicle can not do it. */
_Noreturn void car_refuse(const TestCar *car, const char *remedy, const char *what);
/* End with a message where the vehicle is not steered; where it has no accelerator, or no brake. */
void car_need_steering(const TestCar *car);
void car_need_drive(const TestCar *car);
/* The same where the base's origin, by which drivers steer, is not between the wheels. */
void car_need_origin(const TestCar *car);
void car_need_brake(const TestCar *car);
/* The text of a scene that begins straight ahead at a speed, m/s. drives: the driver keeps the speed, where the car has
 * pedals; false: pedals are free. more: other keys, NULL: none. */
const char *car_scene(TestCar *car, double duration, double speed, bool drives, const char *more);
/* True: the vehicle runs straight ahead with the steering as it is set up, from a speed > 0 with free pedals. False: it
 * turns, *why and car->remedy. */
bool car_runs_straight(TestCar *car, double speed, const char **why);
/* Go on with an engine of the model on the posts of a scene; scenes afterwards have the same posts. Returns that model,
 * with outputs of wheels, and the scene for it. */
const Model *car_stand_on_posts(TestCar *car, const char *text, const Scene **scene);
/* Drive straight ahead until the speed is kept, so that scenes at about this speed begin in the right gear. False: it
 * is not, or the vehicle does not run straight, *why and car->remedy. Without pedals it rolls straight ahead, at a
 * speed of 0 nothing is done. car_settle(): the same, which ends in car_refuse(). */
bool car_keeps(TestCar *car, double speed, const char **why);
void car_settle(TestCar *car, double speed);
/* manoeuvre_pedals.c: `speed` of a scene's driver, with a target as it stands in a scene, m/s: with gains that are
 * found for the vehicle at the speed that was kept last, and before those of pedal_driver_first. */
extern const PedalDriver pedal_driver_first;
const char *car_pedals(TestCar *car, const char *target);
/* Steering coordinate of a road-wheel angle. */
double car_steering(const TestCar *car, double angle);
/* The steady road-wheel angle for a lateral acceleration of 1 m/s^2, by the linear model; NAN: there is none. */
double car_angle_by_acceleration(const TestCar *car, double speed);

/* ---- manoeuvre_fit.c: numbers from rows ----------------------------------------------------------------- */

/* The slope of the straight line through y over x by least squares; NAN below two different points. */
double fit_slope(int count, const double *x, const double *y);
/* The mean of a channel from a time on to another one. */
double trial_mean(const Trial *trial, Channel channel, double from, double to);
/* Its value at a time, linear between rows. */
double trial_at(const Trial *trial, Channel channel, double time);
/* The first time from `from` on at which a channel passes a value upwards (sign 1) or downwards (-1); NAN: never. */
double trial_passes(const Trial *trial, Channel channel, double from, double value, double sign);
/* True: at its last row it slides by more than 45 degrees off its heading, at more than 1 m/s. */
bool trial_spins(const Trial *trial);
/* The row from a time on at which sign times a channel is largest. */
int trial_peak(const Trial *trial, Channel channel, double from, double to, double sign);

/* ---- manoeuvre_report.c --------------------------------------------------------------------------------- */

/* A value that the user may give as key=value. */
typedef struct ManoeuvreKey {
    const char *name, *unit, *about; /* unit "": a whole number */
    double value, least, most;       /* value: unless the user gives one */
} ManoeuvreKey;

enum { MANOEUVRE_KEYS = 6 };

/* A diagram of the page: a channel over another one, of all trials. */
typedef struct ManoeuvreCurve {
    Channel x, y;
} ManoeuvreCurve;

/* A diagram of values that are no channel: gain and phase, by the run and beside it by the linear model. */
typedef struct ManoeuvreTable {
    const char *title, *unit, *below;
    int rows, curves;
    double *x, *y; /* y: [curves][rows] */
} ManoeuvreTable;

/* A manoeuvre under way. */
typedef struct Manoeuvre {
    Pool *pool;
    TestCar *car;
    Sheet *result;       /* its numbers and notes */
    const double *value; /* [MANOEUVRE_KEYS] of the keys */
    int trials, curves, tables;
    const Trial **trial; /* that were evaluated */
    ManoeuvreCurve *curve;
    ManoeuvreTable *table;
} Manoeuvre;

typedef struct ManoeuvreKind {
    const char *name, *title;
    void (*run)(Manoeuvre *manoeuvre);
    ManoeuvreKey key[MANOEUVRE_KEYS];
} ManoeuvreKind;

/* Keep a trial for the results. */
void manoeuvre_keep(Manoeuvre *manoeuvre, const Trial *trial);
/* The manoeuvres, the last without a name. */
extern const ManoeuvreKind manoeuvre_kind[];
/* --manoeuvre: run it and write what was asked for. Ends in usage_fail for unknown names and keys. */
void manoeuvre_report(Pool *pool, const Model *model, const Request *request);
/* Drive it, with its keys read; the caller closes the engine of its car. */
Manoeuvre manoeuvre_drive(Pool *pool, const Model *model, const Request *request);
/* The key of a name that a manoeuvre takes; NULL: it takes none. Ends in usage_fail for an unknown manoeuvre. */
const ManoeuvreKey *manoeuvre_key(Pool *pool, const char *manoeuvre, const char *name);
/* manoeuvre_page.c: the unit in which people read a channel, and the factor to it. */
const char *manoeuvre_shown(Channel channel, double *scale);
/* The page. other: a second vehicle, called `name`, whose curves stand in the same diagrams; NULL: none. */
void manoeuvre_page(const Manoeuvre *manoeuvre, const Manoeuvre *other, const char *name, const ManoeuvreKind *kind,
                    const char *path);

/* ---- manoeuvre_steer.c: what manoeuvres by steering share ------------------------------------------------ */

/* A vehicle that can be steered and driven, which keeps the speed value[0] straight ahead; or an end with a message. */
void manoeuvre_begin(Manoeuvre *manoeuvre);
/* End with a message where the vehicle tipped over or the run broke off. */
void manoeuvre_whole(Manoeuvre *manoeuvre, const Trial *trial, const char *remedy);
/* Curves of channels over time for the page. */
void manoeuvre_draw(Manoeuvre *manoeuvre, size_t count, const Channel *over);
/* `inputs` of a scene with the steering as samples `spacing`, s, apart: angle, rad, times a wave. */
const char *manoeuvre_steering(Manoeuvre *manoeuvre, double from, double to, double spacing, double angle,
                               double (*wave)(const void *context, double time), const void *context);

/* How an angle is found: drive with it, and the lateral acceleration that it ends in. what and verb: for messages. */
typedef struct AngleSearch {
    const Trial *(*drive)(Manoeuvre *manoeuvre, double angle, const char *name);
    double (*acceleration)(const Trial *trial);
    const char *what, *verb;
} AngleSearch;

/* The road-wheel angle, to the left, of a lateral acceleration, m/s^2, to 0.5 %: secants. Ends in car_refuse(). */
double manoeuvre_find_angle(Manoeuvre *manoeuvre, double wanted, const AngleSearch *search);
/* A: the angle of 0.3 g by the straight line through 0.1 to 0.375 g of steering that grows slowly to the left, and its
 * row in the results. Ends in car_refuse(). */
double manoeuvre_find_amplitude(Manoeuvre *manoeuvre);

/* manoeuvre_step.c: the angle whose step ends in value[1], its `inputs`, and a run with it at the speed value[0]. */
double manoeuvre_steady_angle(Manoeuvre *manoeuvre);
const char *manoeuvre_step_profile(Manoeuvre *manoeuvre, double angle);
const Trial *manoeuvre_step_trial(Manoeuvre *manoeuvre, double angle, const char *name);

/* manoeuvre_pedals.c: rows of what keeps the speed; none where no pedals were asked for. */
void manoeuvre_pedal_rows(Manoeuvre *manoeuvre);

/* manoeuvre_driver.c: s from look to look of drivers; s that a movement of theirs takes, at least the period. */
extern const double driver_period, driver_reach;
/* Derivatives of a movement; those that go on when another one replaces it. */
enum { DRIVER_MOVE = 8, DRIVER_KEPT = 4 };
/* The polynomial from a movement's value and three derivatives, and its end, to its derivatives when it begins:
 * movement_from() of scene/profile_form.h. */
void driver_movement(const double now[DRIVER_KEPT], double end, double out[DRIVER_MOVE]);

/* manoeuvre_driver.c: a driver who follows a path, found for a vehicle at a speed by its linear model. */
typedef struct PathDriver {
    double speed, adapt; /* m/s; 1/s: `adapt` of models/SCENE.md section 5, 0 where errors grow with it */
    double gain;         /* steer angle by that of a vehicle without slip: the steady one, or the best of some */
    double preview;      /* s that he looks ahead */
    double decay;        /* 1/s with which the slowest motion that he moves dies out; not above 0: it grows */
    double stable[2];    /* s: with previews between these it decays */
    double nearest;      /* m that he looks ahead at least; 0: 1.5 m, or less where that is more than at his speed */
} PathDriver;

/* The preview with which errors die out most quickly where he does not learn; adapt: 1/s with which he is to. False:
 * with none do they die out, *why. */
bool manoeuvre_find_driver(Manoeuvre *manoeuvre, double speed, double adapt, PathDriver *driver, const char **why);
/* The same, which ends in car_refuse(). */
PathDriver manoeuvre_driver(Manoeuvre *manoeuvre, double speed, double adapt);
/* `driver` of a scene: pedals, as text, "": none, and what he steers by but for `path`, as it stands in a scene. */
const char *manoeuvre_driver_text(const Manoeuvre *manoeuvre, const PathDriver *driver, const char *pedals,
                                  const char *path);
/* Rows of what was found; prefix: of their names, "": none. */
void manoeuvre_driver_rows(Manoeuvre *manoeuvre, const PathDriver *driver, const char *prefix);

/* manoeuvre_frequency.c: gain, phase, rad, negative where it lags, and coherence of a channel by the steer angle. */
typedef struct Response {
    double gain, phase, coherence;
} Response;
typedef Response RespondAt(const void *context, Channel channel, double frequency);
/* Rows and curves of yaw rate, lateral acceleration, roll and side slip up to a frequency, Hz; of articulated vehicles
 * also those of the last unit by the first one. */
void manoeuvre_responses(Manoeuvre *manoeuvre, RespondAt *at, const void *context, double to);
/* manoeuvre_linear.c: the same by the linear model straight ahead at a speed, m/s; NULL: there is none. */
typedef struct LinearResponse LinearResponse;
const LinearResponse *linear_response(const TestCar *car, double speed);
/* A RespondAt of it, as context; the coherence is 1. */
Response linear_response_at(const void *context, Channel channel, double frequency);
/* manoeuvre_frequency.c: car_angle_by_acceleration() at the speed value[0]; ends in car_refuse() where there is none.
 */
double manoeuvre_angle_by_acceleration(Manoeuvre *manoeuvre);
/* The amplitude, rad, of steering whose lateral acceleration is value[1] steadily, by the linear model at value[0]. */
double manoeuvre_linear_angle(Manoeuvre *manoeuvre);

/* manoeuvre_units.c: how an articulated vehicle follows steering that begins and ends straight ahead, from a time to
 * another one, s: rows of peaks of the last unit by those of the first, and of the damping after it. */
void manoeuvre_rearward(Manoeuvre *manoeuvre, const Trial *trial, double from, double to);
/* True: the vehicle has units of which such rows can be made. False: it is one, or a note says why there are none. */
bool manoeuvre_has_units(Manoeuvre *manoeuvre);

/* manoeuvre_straight.c: the rows of a run whose pedal moves at `begin`, s, as asked for from a speed, m/s. */
void manoeuvre_braked(Manoeuvre *manoeuvre, const Trial *trial, double begin, double speed);
/* True: the run may end below *context, m/s. */
bool manoeuvre_is_slow(void *context, const Trial *trial);
/* All wheels of one side, those within 1 mm of the middle left out, are without load in a row. */
bool manoeuvre_side_lifts(const TestCar *car, const Trial *trial, int row);
/* That, or it slides by more than 45 degrees off its heading: trial_spins(). */
bool manoeuvre_is_over(void *context, const Trial *trial);
/* The way along the plane from one time to another one, m. */
double manoeuvre_way(const Trial *trial, double from, double to);
/* The speed from which the vehicle, pedals free, has `speed` when the pedal begins to move, and when that is, s. */
double manoeuvre_speed_before(TestCar *car, double speed, double *begin);

/* ---- the manoeuvres: manoeuvre_steady.c and so on ------------------------------------------------------- */

void manoeuvre_steady_speed(Manoeuvre *manoeuvre);
void manoeuvre_steady_radius(Manoeuvre *manoeuvre);
void manoeuvre_step_steer(Manoeuvre *manoeuvre);
void manoeuvre_ramp_steer(Manoeuvre *manoeuvre);
void manoeuvre_sine(Manoeuvre *manoeuvre);
void manoeuvre_random(Manoeuvre *manoeuvre);
void manoeuvre_sine_dwell(Manoeuvre *manoeuvre);
void manoeuvre_single_lane_change(Manoeuvre *manoeuvre);
void manoeuvre_frequency(Manoeuvre *manoeuvre);
void manoeuvre_lane_change(Manoeuvre *manoeuvre);
void manoeuvre_braking(Manoeuvre *manoeuvre);
void manoeuvre_split_braking(Manoeuvre *manoeuvre);
void manoeuvre_turn_braking(Manoeuvre *manoeuvre);
void manoeuvre_lift_off(Manoeuvre *manoeuvre);
void manoeuvre_j_turn(Manoeuvre *manoeuvre);
void manoeuvre_fishhook(Manoeuvre *manoeuvre);
void manoeuvre_coast(Manoeuvre *manoeuvre);
void manoeuvre_acceleration(Manoeuvre *manoeuvre);
void manoeuvre_elasticity(Manoeuvre *manoeuvre);
void manoeuvre_ride(Manoeuvre *manoeuvre);
void manoeuvre_ride_speeds(Manoeuvre *manoeuvre);
void manoeuvre_posts(Manoeuvre *manoeuvre);
/* manoeuvre_straight.c: the speed, m/s, that does not grow any more by the whole accelerator; NAN: there is none, *why.
 */
double manoeuvre_top_speed(TestCar *car, const char **why);

/* manoeuvre_ride.c: s from the start of a run that are left out, and between rows; rows of accelerations and loads of a
 * run, and the curve of a density. */
extern const double ride_run_in, ride_sampling;
void manoeuvre_ride_numbers(Manoeuvre *manoeuvre, const Trial *trial);

#endif
