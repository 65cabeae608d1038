/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of gicrun --animate. Poses are 7 numbers, FORMAT.md section 1. */
#ifndef RUN_ANIMATE_H
#define RUN_ANIMATE_H

#include "base/text.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/scene.h"

/* ---- animate_shape.c: how a model looks, from nothing but its points, axes and masses --------------------------- */

typedef struct Point {
    double x[3];
} Point;

/* How a body is drawn: as a frame of bars about its points (the base of a vehicle); as points only (ground); as the
 * hull of its points; as a transparent box with its points (heavy bodies of a vehicle, bodies of one point); by the
 * `shape` of the model. */
typedef enum Look { LOOK_FRAME, LOOK_POINTS, LOOK_HULL, LOOK_GLASS, LOOK_BOX, LOOK_CYLINDER, LOOK_MESH, LOOKS } Look;

extern const char *const look_name[LOOKS];

/* Body frame: points of joints, springs and wheels, and the centre of mass. box: edges of the solid box with the body's
 * mass and moments of inertia. */
typedef struct Shape {
    Point *point;
    int points;
    double com[3], box[3];
    Look look;
    double middle[3], axis[3], size[3]; /* of a box: edges along x, y, z; of a cylinder: radius, length */
    const BodyShape *mesh;
} Shape;

/* A line from a point of a body to one of another (BODY_GROUND: world). kind: "link", "spring", "damper" or "bushing",
 * whose ring is at the first one and whose pin is at the second one, along axes of these. */
typedef struct Line {
    const char *name, *kind;
    int body[2];
    double point[2][3], axis[2][3];
} Line;

typedef struct Shapes {
    Shape *body; /* [bodies] */
    Line *line;
    int lines;
    double (*center)[3], (*axis)[3], *width; /* [wheels] frame of the body that carries it; m */
} Shapes;

/* With the scene's values of parameters. */
Shapes shapes_of(Pool *pool, const Model *model, const Scene *scene);
/* The place in the world of a point of a body. */
void pose_point(const double *pose, const double s[3], double out[3]);
/* Widen low and high so that all points of all bodies at poses [bodies][7] are between. */
void shapes_bounds(const Model *model, const Shapes *shapes, const double *pose, double low[3], double high[3]);
/* The size of a vehicle, or of a mechanism, whose points are between low and high; more than 0. */
double shapes_size(const Model *model, const double low[3], const double high[3]);

/* ---- animate_look.c: which shape a body has ---------------------------------------------------------------------- */

/* Call after points, boxes and wheels of all bodies are set; the second function prints the JSON of one. */
void looks_choose(Pool *pool, const Model *model, Shapes *shapes);
void json_look(Text *out, const Shape *shape);

/* ---- animate_json.c: what the pages of --animate and --drive have in common ----------------------------------------
 */

/* A page in the making: the first member of the context of its templates. */
typedef struct Page {
    Pool *pool;
    const char *name; /* of the model */
} Page;

/* Parts that pages have in common, by the name of their insertion points. */
extern const Insertions animate_parts;

/* Index in output[] of the first component of an output about a wheel; -1: none. */
int animate_output(const Model *model, OutputType type, int wheel);
/* A text in quotes, in which '<', that could end the script in HTML, is escaped; "key":"value",; "key":[x,y,z]. */
void json_text(Text *out, const char *s);
void json_key(Text *out, const char *key, const char *value);
void json_vector(Text *out, const char *key, const double v[3]);
/* "ahead":[..],"up":[..],: directions x and z of the drawing in the frame of the base. */
void json_drawing(Text *out, const Model *model);
/* "units":{unit of SI:[shown unit, factor],...}, */
void json_units(Text *out, const Scene *scene);
/* "bodies":[..], whose poses are 7 channels each; "lines":[..],; the object of a wheel but for its end, whose angle is
 * a channel. */
void json_bodies(Text *out, const Model *model, const Shapes *shapes);
void json_lines(Text *out, const Shapes *shapes);
void json_wheel(Text *out, const Model *model, const Shapes *shapes, int w, int angle);

/* ---- animate_course.c: what stands and is painted on the road -----------------------------------------------------
 */

/* JSON: cones, edges of lanes and the driver's path of a scene. */
void json_course(Text *out, const Scene *scene);

/* ---- animate_ghost.c: another run as a second vehicle ------------------------------------------------------------ */

typedef struct Ghost Ghost;

/* Of a table with at least one row; NULL: it does not tell where the base is, or on a fixed base none of the
 * coordinates. */
Ghost *ghost_new(Pool *pool, const Model *model, const Engine *engine, const Scene *scene,
                 const struct CsvTable *table);
/* Poses [bodies][7] at a time; after the table's end those at its end. */
void ghost_poses(Ghost *ghost, double time, double *pose);
/* The time of the last row, s. */
double ghost_end(const Ghost *ghost);
/* How many coordinates are not told, and their names. */
int ghost_untold(const Ghost *ghost, const char *const **name);

/* ---- animate_road.c: the road along a way ------------------------------------------------------------------------ */

/* JSON: heights of the road, and its friction where it is not 1, in square tiles near `way`, [count][x, y]. size: of
 * the vehicle, m. */
void road_tiles(Text *out, const gic_road *road, double size, const double *way, int count);

#endif
