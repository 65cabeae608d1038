/* SPDX-License-Identifier: MIT
 *
 * scene: the motion that a vehicle is driven through, and the road; models/SCENE.md. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "base/message.h"
#include "gic_runtime.h"

typedef struct Item Item;   /* base/yaml.h */
typedef struct Model Model; /* model/model.h */
typedef struct Coordinate Coordinate;
typedef struct Engine Engine; /* engine/engine.h */
typedef struct Facts Facts;   /* vehicle/vehicle.h */
typedef struct Plane Plane;
typedef struct Profile Profile; /* profile.h */

/* ---- scene.c, scene_*.c: what the vehicle does and where; models/SCENE.md */

typedef struct Driver Driver;           /* driver.h */
typedef struct Actions Actions;         /* action.h */
typedef struct Sleep Sleep;             /* sleep.h */
typedef struct Replay Replay;           /* replay.h */
typedef struct PageVehicle PageVehicle; /* run/page_vehicle.h */
typedef struct Hold Hold;               /* hold.h */

/* A line on the road: its points, m, world. */
typedef struct Mark {
    int count;
    double (*point)[2];
} Mark;

/* Cones and the edges of lanes, models/SCENE.md section 12. The vehicle does not feel them. */
typedef struct RoadCourse {
    Mark cones, *edge;
    int edges;
} RoadCourse;

/* A unit in which pictures and pages show numbers in `of`, of SI: so many of it are one of that. */
typedef struct ShownUnit {
    const char *name, *of;
    double factor;
} ShownUnit;

typedef struct Scene {
    const Source *source;
    const Item *root;                   /* the file's keys, for messages */
    double duration, step, output_step; /* step is 0 if a scene of variable steps has none */
    int64_t outputs;                    /* output times after the one at 0 */
    int64_t per_output;                 /* constant steps from one output time to the next */
    int32_t method;                     /* gic_method, or one of run/variable_step.h */
    bool automatic;                     /* method and step are to be chosen: run/choose_step.h */
    double tolerance;                   /* of variable steps */
    int32_t ratio;                      /* fast steps in a step; 1: one rate for everything */
    double steady;                      /* of gic_step_steady; 0: always fast steps */
    int most_work;                      /* gic_head.most; 0: no bound */
    int32_t keep;                       /* of implicit steps: steps with one Jacobian */
    bool spread;                        /* these steps make the next one by shares */
    bool stiff; /* implicit steps treat states with a share in stiff motions implicitly, alone */
    int locate; /* gic_head.locate: constant steps are made in parts at contacts */
    double position[3], euler[4], velocity[3], angular_velocity[3]; /* of the base, free base only */
    bool along, equilibrium; /* the velocity is a `speed` along the base's x axis; start in static equilibrium */
    double speed;
    bool rested;          /* it has come to rest: the `speed` is along the base's heading on the road, */
    double climb;         /* which rises so much a metre there */
    double *value, *rate; /* [coordinates] at time 0; not used for driven ones */
    bool placed, *given;  /* the scene gives the position, [coordinates] the values; else they are the model's */
    double *fast;         /* [fast states] at time 0, NAN: as rolling wheels have it */
    int32_t gear;         /* at time 0, of a powertrain */
    const gic_road *road; /* NULL: flat at z = 0 */
    double *parameter;    /* [tunables] */
    int profiles, columns, curves, panels;
    Profile *profile;
    Driver *driver;     /* changes during the run; NULL: no driver */
    Sleep *rest;        /* changes during the run; NULL: the vehicle never sleeps */
    Replay *replay;     /* the same; NULL: nothing is replayed */
    PageVehicle *page;  /* the same; what computes instead of the engine; NULL: the engine */
    Hold *hold;         /* the same; NULL: inputs do not come from outside */
    Actions *actions;   /* the same; NULL: nothing depends on a condition */
    RoadCourse *course; /* cones and lanes for pages; NULL: none */
    /* All signals: components of outputs in the order of output[], then inputs. Indices into it: columns of the
     * results; curves over time; panels of one signal over another, x and y. */
    const gic_signal *signal;
    int *column, *curve, (*panel)[2];
    int watches, *watched; /* signals that conditions see, indices as those */
    bool plotted;          /* the scene names the curves */
    const ShownUnit **unit;
    int units;
    const Model *fixed; /* of a rig: the model with the scene's numbers in place of geometric parameters, by which it
                         * is read; NULL: it has none */
    bool held;          /* the base is fixed at `position` and `euler` */
    double massless;    /* kg: bodies below this mass lose it; 0: none does */
    Place massless_at;
    double lost; /* from scene_rig(): see model_lost() */
    const char *massless_names;
    int driven,
        *drive;       /* free coordinates of the model that the scene drives, by the last profiles but those of posts */
    int posts, *post; /* wheels under which it raises the road, by the last profiles */
} Scene;

/* Read a scene for a model. Any mistake ends in diag_fail. integrator, tolerance: replace the scene's; NULL, 0: do not.
 */
const Scene *scene_read(Pool *pool, const char *path, const Model *model, const char *integrator, double tolerance);
/* The same of a text in memory; name: what messages call it. */
const Scene *scene_read_text(Pool *pool, const char *name, const char *text, const Model *model);
/* fit.c: end with a message if the scene (root: of its file `path`) uses names that the model lacks but a model in its
 * folder, in the folder above or beside the model has: the scene is for that model. */
void scene_check_fit(Pool *pool, const Item *root, const char *path, const Model *model);
/* The velocity of a scene with `speed`: along the base's x axis, or along the road once it has come to rest. */
void scene_along(Scene *scene);
/* Warn if values of a coordinate between low and high are outside its range. */
void scene_warn_range(const Coordinate *coordinate, Place at, double low, double high);
/* The method of a name, -1: none; the name of a method. */
int32_t integrator_method(const char *name);
/* Their names, from 0; NULL: no more. */
const char *integrator_word(int index);
const char *integrator_name(int32_t method);
enum {
    KEEP_MOST = 1000,         /* steps with one Jacobian */
    SCENE_MOST_WORK = 1000000 /* evaluations of a step that may be asked for */
};
/* True for methods that need code with implicit steps: GIC_ROS2, GIC_ROS3, GIC_IMEX, GIC_EXP3. */
bool method_implicit(int32_t method);
bool scene_implicit(const Scene *scene); /* the same of its method */
/* The method for parts of a step, of any length: GIC_RK4 or an implicit one. */
int32_t scene_method_of_parts(const Scene *scene);
/* Where the scene has this key; the file as a whole if it does not. */
Place scene_place(const Scene *scene, const char *key);
/* Fail if the scene has the integrator `auto`. what: "a page" */
void scene_no_auto(const Scene *scene, const char *what);
/* Fail if the scene has an implicit integrator or `auto`; for what does not take one. what: "a page" */
void scene_no_implicit(const Scene *scene, const char *what);
/* The same for an engine. */
void scene_no_implicit_engine(Pool *pool, const Scene *scene, const char *engine);
bool tolerance_known(double tolerance); /* true if variable steps can keep this tolerance */
/* A new profile for the input that `key` names; name: of all inputs. Fails if the input has one. */
Profile *scene_profile(Pool *pool, const Model *model, Scene *scene, const Item *key, const char *const *name);
/* The driven coordinate whose value is this input, or NULL. */
const Coordinate *scene_driven_by(const Model *model, int input);
/* Warn where a driven coordinate would leave its range. */
void scene_check_profile(const Scene *scene, const Model *model, const Profile *profile, Place at);
/* read_input_file.c: a profile for each column of the table that `input_file` names. */
void scene_read_input_file(Pool *pool, const Item *item, const Model *model, const char *const *name, Scene *scene);
/* A gic_input_function; `user` is the Scene. */
void scene_inputs(void *user, int32_t lane, double time, double *input);
/* The first time after `time` at which a profile is less smooth; INFINITY: none. */
double scene_next_kink(const Scene *scene, double time);
/* The same for profiles of driven coordinates alone, whose jerk jumps there. */
double scene_next_knot(const Scene *scene, double time);
/* The longest step (s) from `time` that skips no feature of the inputs, or INFINITY. */
double scene_longest_step(const Scene *scene, double time);
/* The time up to which all inputs are constant; `time` itself if that is unknown. */
double scene_quiet_until(const Scene *scene, double time);
/* read_outputs.c: columns, curves and panels of a scene. */
void scene_read_outputs(Pool *pool, const Item *root, const Model *model, Scene *scene);
/* unit.c: units of pictures and pages; that for a unit of SI, NULL: SI. */
void scene_read_units(Pool *pool, const Item *root, Scene *scene);
const ShownUnit *scene_unit(const Scene *scene, const char *of);
/* facts.c: facts about a run of the scene. path: of the scene; drawn: a picture is asked for. */
const Facts *scene_facts(Pool *pool, const Model *model, const Scene *scene, const char *path, bool drawn);
/* facts.c: the plane that a road is, NULL: it is none, or its friction is not the same everywhere. */
const Plane *scene_plane(Pool *pool, const gic_road *road);
/* read_sleep.c: a part of the model that changes with time by itself, "force 'shake'"; NULL: none. */
const char *scene_restless(Pool *pool, const Model *model);
/* facts.c: states that the scene can have, for formulation_validate(). */
const struct Validation *scene_validation(Pool *pool, const Model *model, const Scene *scene);
/* The scene with an initial state that is exactly symmetric if it is symmetric to rounding, as after a search for
 * static equilibrium. */
const Scene *scene_even(Pool *pool, const Model *model, const Scene *scene);
/* The scene for the engine's code: if that relies on facts, with the signals of its outputs, and without the road that
 * is part of it. */
const Scene *scene_narrow(Pool *pool, const Scene *scene, const Model *model, const Engine *engine);
/* read_driver.c: the driver of a `driver:` item; step: s, 0 where steps vary. */
Driver *driver_read(Pool *pool, const Item *item, const Model *model, double step);
/* course.c: cones and lanes of a `course:` item. */
RoadCourse *course_read(Pool *pool, const Item *item);
/* read_road.c: the road a `road:` item describes. */
const gic_road *road_read(Pool *pool, const Item *item);
/* read_road_file.c: the table in the file that `item` names, relative to the folder of the scene; what: "road". header:
 * the expected columns. */
const struct CsvTable *scene_file(Pool *pool, const Item *item, const char *what, const char *header);
/* read_road_file.c: roads whose heights are in the file that the key `file` names. */
const gic_road *table_file_read(Pool *pool, const Item *item);
const gic_road *grid_file_read(Pool *pool, const Item *item);

/* Index of `word` among names; fails with the nearest name, or all of them if they are few; kind: "output". */
int scene_name_index(Pool *pool, const Item *item, const char *word, const char *kind, const char *const *name,
                     int count);

/* Checked access beyond base/yaml.c. need: the value of a required key; number: or `absent` if there is none; numbers:
 * a list of at least `least` numbers. */
#define CHECK_KEYS(item, what, ...) \
    doc_check_keys((item), (what), (const char *const[]){__VA_ARGS__}, \
                   (int)(sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *)))
const Item *scene_need(const Item *map, const char *key, const char *what);
double scene_number(const Item *map, const char *key, const char *what, double absent);
double scene_positive(const Item *item, const char *what);
double *scene_numbers(Pool *pool, const Item *item, const char *what, int least);

/* All signals, as in Scene. */
gic_signal *scene_signals(Pool *pool, const Model *model);
/* read_rig.c: read the keys `base`, `driven`, `posts` and `massless`. */
/* True: the scene holds the base, drives coordinates or leaves out masses: geometric parameters have fixed values then.
 */
bool rig_wanted(const Item *root);
void rig_read(Pool *pool, const Item *root, const Model *model, Scene *scene);
/* The model with its base held, coordinates driven and masses removed as the scene says; *scene is replaced by the
 * scene for that model. *scene NULL: no scene, the model is returned unchanged. */
const Model *scene_rig(Pool *pool, const Model *model, const Scene **scene);
/* Fail if the scene uses a rig; for programs that do not support one. */
void scene_no_rig(const Scene *scene);

/* In addition to the methods of gic_runtime.h (gic_method), which have constant steps. */
enum {
    METHOD_ADAMS = 100, /* Adams-Moulton, variable step and order 1 to 12: in place of the paper's DDABM */
    METHOD_RKCK,        /* Runge-Kutta of Cash and Karp, order 5: cheaper than Adams down to errors of 1e-8 */
    METHOD_BDF          /* backward differentiation formulas, order 1 to 5: CVODE, for stiff models */
};

#endif
