/* SPDX-License-Identifier: MIT
 *
 * gicrun: the program that generates, compiles and runs a model in one go. Its parts, file by file, in the order in
 * which they are used; conventions as in gicgen.h. */
#ifndef GICRUN_H
#define GICRUN_H

#include "engine.h"
#include "gic_road.h"
#include "variable.h"

/* ---- gicrun.c: the command line ------------------------------------------------------------------------ */

/* What the command line asks for. */
typedef struct Request {
    const char *model, *scene; /* paths; scene may be NULL with `states` */
    const char *states;        /* --eval, or NULL */
    bool rests, modes;         /* --equilibrium, --modes */
    const char *results;       /* "-": standard output; NULL: none */
    const char *picture;       /* NULL: none */
    const char *page;          /* --animate, or NULL */
    const char *engine;        /* one of engine_name */
    Solve solve;
    Recovery recovery;
    int lanes;              /* as in EngineOptions */
    const char *compiler;   /* command, perhaps with options */
    const char *flags;      /* more options of the compiler */
    const char *integrator; /* instead of the scene's, or NULL */
    double tolerance;       /* instead of the scene's, or 0 */
    bool general;           /* code for any scene */
    bool quiet;
} Request;

/* ---- usage.c: a command line that is none ------------------------------------------------------------------ */

/* `program: error: message 'word'` and how to find out more; exit status 2. word may be NULL. */
_Noreturn void usage_fail(const char *program, const char *message, const char *word);

/* The whole number that word says, from least to most; anything else is usage_fail. */
int64_t usage_whole(const char *program, const char *message, const char *word, int64_t least, int64_t most);

/* ---- process.c: other programs, and signals that ask to stop -------------------------------------------- */

/* The place of messages that are not about an input file: `gicsweep: error: ...`, by the name that the program was
 * called by. */
Place program_place(void);

/* Between hold and release all signals of stop_signals() wait, so that what was begun can be put in order: temporary files
 * removed, results kept. Release lets them through: one that has arrived ends the program there. */
void interrupt_hold(void);
bool interrupt_arrived(void);
void interrupt_release(void);

enum { PROCESS_NOT_STARTED = -1, PROCESS_INTERRUPTED = -2 };

/* Run argv[0], searched in PATH, with `input` as its standard input; call between hold and release. Returns the exit
 * status (128 + signal when one killed it) or one of the above; *said: all it printed, or why it didn't start. */
int process_run(Pool *pool, char *const argv[], const char *input, const char **said);
/* The same with its standard output into an open file, beside its messages in *said. */
int process_run_into(Pool *pool, char *const argv[], const char *input, int output, const char **said);

/* A file without a name, for what a child reads or prints: unlike a pipe it never blocks either side. -1: none; and all
 * that is in one. */
int nameless_file(Pool *pool);
const char *nameless_text(Pool *pool, int file);

/* $TMPDIR or /tmp. */
const char *temporary_folder(void);

/* ---- scene.c, scene_*.c: what the vehicle does and where; models/SCENE.md --------- */

/* How an input runs over time: `count` knots joined by quintics, or a sine that is faded in over its first period. */
typedef struct Profile {
    int input;   /* index in input[] */
    bool driven; /* rate and acceleration follow */
    int count;   /* of knots; 0: sine */
    double *time, *value;
    double amplitude, frequency, offset, start;
} Profile;

typedef struct Driver Driver; /* driver.h */
typedef struct Rest Rest;     /* rest.h */

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

typedef struct Scene {
    const Source *source;
    double duration, step, output_step; /* step is 0 where a scene of variable steps has none */
    int64_t outputs;                    /* output times after the one at 0 */
    int64_t per_output;                 /* constant steps from one output time to the next */
    int32_t method;                     /* gic_method, or one of variable.h */
    double tolerance;                   /* of variable steps */
    int32_t ratio;                      /* of AB3: fast steps in a step */
    double steady;                      /* of gic_step_steady; 0: always fast steps */
    double position[3], euler[4], velocity[3], angular_velocity[3]; /* of the base, free base only */
    bool along, equilibrium; /* is the velocity one of `speed` along the base's x axis; start in static equilibrium? */
    double speed;
    double *value, *rate; /* [coordinates] at time 0; not used where driven */
    bool placed, *given;  /* does the scene give the position, [coordinates] the values? Else they are the model's */
    double *fast;         /* [fast states] at time 0, NAN: as wheels roll */
    int32_t gear;         /* at time 0, of a powertrain */
    const gic_road *road; /* NULL: flat at z = 0 */
    double *parameter;    /* [tunables] */
    int profiles, columns, curves, panels;
    Profile *profile;
    Driver *driver;     /* changes as the run goes on; NULL: nobody drives */
    Rest *rest;         /* the same; NULL: the vehicle never sleeps */
    RoadCourse *course; /* what pages draw on the road; NULL: nothing */
    /* What can be written and drawn: components of outputs, in the order of output[], then inputs. Indices into it:
     * columns of the results; curves over time of the picture; its panels of one over another, x and y. */
    const gic_signal *signal;
    int *column, *curve, (*panel)[2];
    bool plotted;    /* does the scene say what is drawn? */
    bool held;       /* the base, at `position` and `euler` */
    double massless; /* kg: bodies below lose their mass; 0: none does */
    Place massless_at;
    double lost; /* by scene_rig(): see model_lost() */
    const char *massless_names;
    int driven, *drive; /* free coordinates of the model that are driven, by the last profiles */
} Scene;

/* Read a scene for a model. Any mistake ends in diag_fail. integrator: instead of the scene's, or NULL; tolerance: the
 * same, or 0. */
const Scene *scene_read(Pool *pool, const char *path, const Model *model, const char *integrator, double tolerance);
/* scene_fit.c: end with a message where the scene (root: of its file `path`) uses names that the model lacks and a model
 * in its folder, in the folder above it or beside the model has: the scene is for that one. */
void scene_check_fit(Pool *pool, const Item *root, const char *path, const Model *model);
/* The velocity of a scene with `speed`, from the orientation. */
void scene_along(Scene *scene);
/* Say so where a coordinate's values from low to high are not all in its range. */
void scene_warn_range(const Coordinate *coordinate, Place at, double low, double high);
/* The method of a name, -1: there is none; the name of a method. */
int32_t integrator_method(const char *name);
const char *integrator_name(int32_t method);
bool tolerance_known(double tolerance); /* can variable steps respect it? */
/* A profile as it stands in a scene. */
void profile_read(Pool *pool, const Item *item, Profile *profile);
/* Value, rate and acceleration of a profile. */
void profile_at(const Profile *profile, double time, double out[3]);
/* A gic_input_function; `user` is the Scene. */
void scene_inputs(void *user, int32_t lane, double time, double *input);
/* The first time after `time` at which a profile is less smooth than elsewhere, or INFINITY. */
double scene_next_kink(const Scene *scene, double time);
/* The longest step (s) that misses no period of a sine among the inputs, or INFINITY. */
double scene_longest_step(const Scene *scene);
/* The time up to which all inputs surely stay as they are at `time`, `time` itself where they may move. */
double scene_quiet_until(const Scene *scene, double time);
/* scene_outputs.c: columns, curves and panels of a scene. */
void scene_read_outputs(Pool *pool, const Item *root, const Model *model, Scene *scene);
/* scene_facts.c: what is known about a run of the scene beforehand. path: of the scene; drawn: is there a picture? */
const Facts *scene_facts(Pool *pool, const Model *model, const Scene *scene, const char *path, bool drawn);
/* The same file: states that the scene can have, for formulation_validate(). */
const struct Validation *scene_validation(Pool *pool, const Model *model, const Scene *scene);
/* Where the initial state is its own mirror image but for rounding, as static equilibrium leaves it, without that. */
const Scene *scene_even(Pool *pool, const Model *model, const Scene *scene);
/* The same scene for the engine's code: where that rests on facts, with signals of its outputs, and its road. */
const Scene *scene_narrow(Pool *pool, const Scene *scene, const Model *model, const Engine *engine);
/* scene_driver.c: the driver of a `driver:` item; step: s, 0 where steps vary. */
Driver *driver_read(Pool *pool, const Item *item, const Model *model, double step);
/* scene_course.c: what a `course:` item describes. */
RoadCourse *course_read(Pool *pool, const Item *item);
/* scene_road.c: the road a `road:` item describes. */
const gic_road *road_read(Pool *pool, const Item *item);
/* scene_road_file.c: the table in the file that `item` names, seen from the folder of the scene; what: "road". header:
 * the columns it is to have. */
const struct CsvTable *scene_file(Pool *pool, const Item *item, const char *what, const char *header);
/* The same file: roads whose heights are in the file that the key `file` names. */
const gic_road *table_file_read(Pool *pool, const Item *item);
const gic_road *grid_file_read(Pool *pool, const Item *item);

/* Index of `word` among names, or failure with the nearest one, or all of them where they are few; kind: "output". */
int scene_name_index(Pool *pool, const Item *item, const char *word, const char *kind, const char *const *name,
                     int count);

/* Checked access beyond doc.c. need: the value of a key that must be there; number: or `absent` where there is none;
 * numbers: a list of at least `least` numbers. */
#define CHECK_KEYS(item, what, ...) \
    doc_check_keys((item), (what), (const char *const[]){__VA_ARGS__}, \
                   (int)(sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *)))
const Item *scene_need(const Item *map, const char *key, const char *what);
double scene_number(const Item *map, const char *key, const char *what, double absent);
double scene_positive(const Item *item, const char *what);
double *scene_numbers(Pool *pool, const Item *item, const char *what, int least);

/* ---- csv.c ---------------------------------------------------------------------------------------------- */

/* A results file in the making: written beside `path` and renamed when it is closed. */
typedef struct Csv {
    Pool *pool; /* for names */
    FILE *file;
    const char *path, *temporary; /* temporary: NULL for standard output, devices and pipes */
    bool inside;                  /* a row */
} Csv;

Csv csv_open(Pool *pool, const char *path);
/* `text` as a cell: in quotes where it has commas, quotes or ends of lines, which become blanks. */
const char *csv_quoted(Pool *pool, const char *text);
void csv_name(Csv *csv, const char *name, const char *unit); /* a cell `name [unit]`; unit may be NULL */
void csv_time(Csv *csv, double value);                       /* to 15 digits: 0.28, as a person would write it */
void csv_number(Csv *csv, double value);                     /* reads back bit-exactly */
enum { CSV_DIGITS = 32 };                                    /* room for a number as text */
const char *csv_digits(double value, char text[CSV_DIGITS]); /* the text of csv_number(), in `text` */
void csv_text(Csv *csv, const char *text);                   /* in quotes; NULL: an empty cell */
void csv_end_row(Csv *csv);
void csv_close(Csv *csv);   /* exits with a message where not all could be written */
void csv_abandon(Csv *csv); /* instead of csv_close: no results are left */

/* A table of numbers with named columns. */
typedef struct CsvTable {
    const Source *source;
    int columns, rows;
    const char **name, **unit; /* unit: in brackets behind the name, NULL: none */
    size_t *at;                /* where the names begin in the source */
    double *value;             /* [rows][columns] */
    size_t *line;              /* [rows] where each begins in the source */
} CsvTable;

/* header: the first line that messages suggest; by: the file that names this one, NULL: the user does. Where a file
 * names it and its first line has none of the columns, no message shows what stands there. */
const CsvTable *csv_read(Pool *pool, const char *path, const char *header, const Source *by);
Place csv_place(const CsvTable *table, int row);
Place csv_name_place(const CsvTable *table, int column);
/* End with a message where a column states another unit than the one that its numbers are taken for. */
void csv_check_unit(Pool *pool, const CsvTable *table, int column, const char *unit);

/* ---- plot.c --------------------------------------------------------------------------------------------- */

/* Curves over time, and panels of one signal over another; `sample` holds rows of time, `curves` values, and x and y of
 * each panel. */
typedef struct Plot {
    const char *title;
    int curves, panels, rows;
    const gic_signal *signal; /* [curves + 2 panels] of what stands in a row behind the time */
    double *sample;
} Plot;

/* Picture by gnuplot, SVG or PNG by the ending of `path`; curves of the same unit share a panel. */
void plot_write(Pool *pool, const Plot *plot, const char *path);
/* quantity.c: what is measured in a unit, "force"; of units that we do not know "value". */
const char *unit_quantity(const char *unit);
/* "force [N]"; of numbers without a unit "no unit" */
const char *quantity_text(Pool *pool, const char *unit);
/* Ends with a message where there is no gnuplot: before the run whose picture it should draw. */
void plot_check(Pool *pool);
/* For scripts of gnuplot: a text in quotes, with a blank in front of a `>` behind `]]`. */
void plot_text(Text *text, const char *s);

enum { PLOT_NO_FILE = -3 /* beside process_run's */ };

/* Let gnuplot run a script whose picture becomes the file `path`. Returns what process_run does, PLOT_NO_FILE where the
 * file can't be made, 1 when it is not whole or could not be renamed; *said: why. */
int gnuplot_run(Pool *pool, const char *script, const char *path, const char **said);
bool plot_known(const char *path); /* does `path` end in .svg or .png? */

/* ---- animate.c: a page of HTML in which the model moves ------------------------------------------------- */

typedef struct Animation Animation;

/* Before a run of a scene, whose name the page shows. */
Animation *animation_new(Pool *pool, const Model *model, const Scene *scene, const char *scene_path);
/* At each output time, with outputs computed: keep what is seen where the time is one of a frame. Returns a status. */
int animation_frame(Animation *animation, const gic_model *code, gic_head *self);
/* The page; exits with a message when it can't be written. */
void animation_write(Animation *animation, const char *path);

typedef struct StepWatch StepWatch; /* step_watch.h */

/* ---- simulate.c, eval.c --------------------------------------------------------------------------------- */

/* Bring an instance to a scene's initial state, on its road and with its inputs. Returns the status of setup. */
int scene_start(const Engine *engine, const Scene *scene, gic_head *self);
/* All that can be written and drawn, as in Scene. */
gic_signal *scene_signals(Pool *pool, const Model *model);
/* scene_rig.c: the keys of rigs. Then the model as the scene has it, and the scene for that; NULL: no scene. Those who
 * can't: fail where it is a rig's. */
void rig_read(Pool *pool, const Item *root, const Model *model, Scene *scene);
const Model *scene_rig(Pool *pool, const Model *model, const Scene **scene);
void scene_no_rig(const Scene *scene);
/* The present value of signal[i] of a scene, of an instance whose outputs are computed. */
double scene_value(const gic_model *code, gic_head *self, int i);
/* Part of that: wheels roll, but for fast states that the scene (NULL: none) gives. Returns a status. */
int scene_set_fast(const gic_model *model, const Scene *scene, gic_head *self);
/* One step of a scene, by the engine's code or faster one: a constant one, or where `variable` is given one towards
 * `end` that stops at kinks of inputs. Before it the driver looks, where it is time for that. */
int scene_step(const Engine *engine, const gic_model *model, const Scene *scene, Variable *variable, gic_head *self,
               double end);
/* Outputs at the present time, computed on a copy of the instance, so that how often someone looks leaves no trace in
 * the results; those of a vehicle that sleeps stay. *slumber: 0 at first, and the same number from call to call. */
int scene_outputs(const gic_model *model, const Scene *scene, const gic_head *self, gic_head *copy, int64_t *slumber);
/* equilibrium.c: the scene, or where it asks for it one that starts in static equilibrium. Ends in diag_fail where
 * there is none. */
const Scene *equilibrium_start(Pool *pool, const Model *model, const Scene *scene, Solve solve);
/* Run a scene: results, picture, page (animation: NULL where none is asked for), summary. mechanism: what the engine
 * was made for. A failure on the way keeps what was computed, with the last good state, and ends in diag_fail. */
void simulate(Pool *pool, const Engine *engine, const Model *mechanism, const Scene *scene, Animation *animation,
              StepWatch *watch, const Request *request);
/* Evaluate rows of states (--eval). scene may be NULL; only its road is used. */
void evaluate(Pool *pool, const Engine *engine, const Scene *scene, const Request *request);

#endif
