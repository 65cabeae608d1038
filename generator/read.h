/* SPDX-License-Identifier: MIT
 *
 * Private to read.c and read_*.c. A section of a `.veh` file is a table of keys; the same table checks what a person
 * wrote (unknown, missing and misplaced keys, kinds, bounds) and reads it.
 */
#ifndef GICGEN_READ_H
#define GICGEN_READ_H

#include "gicgen.h"

struct stat;

/* What the value of a key is, and where section_read leaves it in a Value. Vectors and points: model frame. */
typedef enum KeyKind {
    KEY_TYPE,          /* one of the section's types, for section_type */
    KEY_ITEM,          /* read by the section itself: item */
    KEY_FORMULA,       /* likewise: a number or a formula */
    KEY_FORCE_VECTOR,  /* likewise: three of those, components of a force */
    KEY_TORQUE_VECTOR, /* likewise, of a torque */
    KEY_INERTIA,       /* likewise: a list of numbers or a map of inertia_section */
    KEY_ORIENTATION,   /* likewise: a map of orientation_section */
    KEY_LIST,          /* numbers: item */
    KEY_TEXT,          /* text */
    KEY_INTERPOLATION, /* one of two words (kind_words); flag: it is the second */
    KEY_BEYOND,        /* the same */
    KEY_SIDE,          /* the same; the mirror exchanges the words */
    KEY_NAME,          /* text */
    KEY_NUMBER,        /* number[0], which follows no tunable parameter */
    KEY_MEASURE,       /* number[0], which may */
    KEY_ODD,           /* the same as KEY_MEASURE; changes its sign in the mirror */
    KEY_PAIR,          /* number[0], number[1], each within the bound */
    KEY_FLAG,          /* flag */
    KEY_RANGE,         /* number[0] < number[1] */
    KEY_VECTOR,        /* number[0..2] */
    KEY_AXIS,          /* number[0..2], unit length */
    KEY_TURN,          /* the same; an axis that something turns about, which the mirror reverses (axial) */
    KEY_DUAL_AXIS,     /* the same as KEY_TURN where the type is `angle`, else as KEY_AXIS */
    KEY_AXES,          /* number[0..2], number[3..5], each of unit length */
    KEY_EULER,         /* number[0..3] */
    KEY_POINT,         /* number[0..2] */
    KEY_POINTS,        /* number[0..2], number[3..5] */
    KEY_BODY,          /* index[0]; ground only where it is the base */
    KEY_BODIES,        /* index[0] and index[1], different; likewise */
    KEY_FORCE_BODIES,  /* the same, ground always allowed */
    KEY_FRAME,         /* a body or `world`: index[0], BODY_GROUND for world */
    KEY_COORDINATE,    /* index[0] */
    KEY_JOINT,         /* index[0] */
    KEY_FORCE,         /* index[0] */
    KEY_TIRE,          /* index[0] */
    KEY_WHEEL,         /* index[0] */
    KEY_TABLE,         /* index[0] */
    KEY_SHAPE,         /* item: a word, a path or a map of shape_section */
    KEY_PATH,          /* text: a path; its item is negated where a mirror image is meant */
    KEY_SERIES,        /* a list of any length: item */
    KEY_OUTPUTS,       /* names of one or two wheels or differentials: item */
    KEY_ENGINE,        /* item: a map of engine_section, and so on */
    KEY_CONVERTER,
    KEY_TRANSMISSION,
    KEY_DIFFERENTIALS, /* item: a map of named entries of differential_section */
    KEY_POWERTRAIN,    /* item: a map of powertrain_section */
    KEY_KINDS
} KeyKind;

typedef enum Bound { BOUND_NONE, BOUND_NOT_NEGATIVE, BOUND_POSITIVE } Bound;

/* Sections whose entries come in several forms (types) say by bits which forms know a key and which need it. */
#define FORM(form) (1u << (form))
#define ALL_FORMS (~0u)

typedef struct Key {
    const char *name;
    KeyKind kind;
    unsigned allowed, required;
    Bound bound;     /* numbers */
    double fallback; /* numbers: when the key is absent */
} Key;

typedef struct Section {
    const Key *key;
    int keys;
    const char *const *type; /* what the key `type` may be, where there is one */
    int types;
    const char *const *form;    /* names of the forms, for messages; NULL: there is one form */
    const unsigned *type_forms; /* the forms that a type can have; NULL: type i has form i */
    const char *const *about;   /* [keys] what the key means, with its unit, in a line; no quotes or backslashes */
} Section;

typedef struct Value {
    const Item *item; /* NULL: the key is absent */
    double number[6];
    Ex tuned[6]; /* what they follow, in the model's tuning; 0: no tunable parameter */
    int index[2];
    const char *text;
    bool flag;
} Value;

typedef struct Point {
    const char *name;
    double x[3];
    Ex tuned[3]; /* as in Value */
} Point;

typedef struct Reader {
    Pool *pool;
    Model *model;
    Point *point;
    int points;
    bool fixed; /* what is being read may follow no tunable parameter */
} Reader;

/* One entry of a map of named things. */
typedef struct Entry {
    const char *name, *what; /* "hinge", "joint 'hinge'" */
    Place at;                /* of the name */
    const Item *item;
} Entry;

/* The tables of the sections whose entries hold values that a mirror, a move or a prefix changes. */
extern const Section file_section, part_section;
extern const Section parameter_section, table_section, port_section;
extern const Section body_section, shape_section, inertia_section, orientation_section, joint_section;
extern const Section coordinate_section;
extern const Section input_section, force_section, tire_section, wheel_section, output_section;
extern const Section powertrain_section, engine_section, converter_section, transmission_section, differential_section;

/* What to write for each kind of value, for people. */
extern const char *const kind_example[KEY_KINDS];
/* Of kinds that are one of two words: those, the default first; else NULL. */
extern const char *const kind_words[KEY_KINDS][2];
/* The section of the entries of a group of the file ("joints"); NULL: points, or no group. */
const Section *group_section(const char *group);

/* ---- rewrite.c: entries written anew ---- */

/* What becomes of an entry of a file and of the names in it. */
typedef struct Rewrite {
    Pool *pool;
    const Item *file;     /* the names of its entries change, and what refers to them */
    const char *prefix;   /* goes in front of every name, "": none */
    bool mirror;          /* y becomes -y, and names change sides */
    double shift[3];      /* added to every point, before the mirror */
    const Source *source; /* where messages place what is written anew; NULL: where it stood */
} Rewrite;

/* Whether a key of a file holds a map of named entries that rewriting knows. */
bool is_group(const char *group);
/* The entry of a file's group ("bodies") that comes of `entry`, and the word that comes of `item`, a reference to the
 * group or the name of an entry of it. What doesn't fit the tables stays as it is, for the reader to refuse. */
Item *entry_rewrite(const Rewrite *rewrite, const char *group, Item *entry);
Item *name_rewrite(const Rewrite *rewrite, const char *group, Item *item);
/* A map of a section, in which what can be written anew is. */
Item *map_rewrite(const Rewrite *rewrite, const Section *section, Item *map);
/* The name on the other side: `_l` becomes `_r` and `_r` becomes `_l`; NULL for any other name. */
const char *name_mirrored(Pool *pool, const char *name);

/* ---- symmetry.c, include.c ---- */

/* The file with a mirror image `*_r` behind every entry `*_l` that has none (FORMAT.md section 13). */
const Item *file_mirrored(Pool *pool, const Item *file);
/* A file of this format's version with all that it includes (FORMAT.md section 12), as if written in one. */
const Item *file_included(Pool *pool, const char *path);
/* The path of the file that `item` names, `name`, from the folder of `file`; what can't be read ends in diag_fail. use:
 * what is done with it, "include". */
const char *path_check(Pool *pool, const Item *item, const char *file, const char *name, const char *use,
                       struct stat *identity);

/* ---- read_keys.c ---- */

/* Names begin with a letter, of letters, digits and `_`; `what` is what bears the name ("a body"). */
void name_check(const char *name, const char *what, Place at);

/* The entries of a map of `thing`s ("joint"), in the order of the file, their names checked; none when map is NULL. */
Entry *section_entries(Reader *reader, const Item *map, const char *thing, int *count);
/* The form that an entry's `type` selects. */
int section_type(Reader *reader, const Section *section, const Entry *entry);
/* Check an entry against the keys of a form and read them: value[k] belongs to section->key[k]. */
void section_read(Reader *reader, const Section *section, int form, const Entry *entry, Value *value);
/* Does the text of a scalar mention a parameter? */
bool mentions_parameter(const Reader *reader, const Item *item);
/* A number, or a formula of parameters; a vector of such. tuned: what they follow, 0: no tunable parameter; NULL:
 * tunable parameters end in diag_fail. */
double number_read(Reader *reader, const Item *item, const char *what, Ex *tuned);
void vector_read(Reader *reader, const Item *item, const char *what, double *out, int size, Ex *tuned);
/* Is a number what its key asks for, and is a point where models are: FORMAT.md section 14? */
void bound_check(const Key *key, const Item *item, const char *what, double number);
void point_check(const Item *item, const char *what, const double x[3]);
/* The prefix of all generated names must be an identifier that C, C++ and their libraries leave free. */
void model_name_check(const char *name, Place at);
/* reserved.c: why a name is none of those ("is reserved in C or C++"), or NULL. */
const char *name_reserved(const char *name);
/* `vector` divided by its norm, without overflow; false when it is zero. */
bool vector_normalize(double *vector, int size);
/* Names that differ only in case or in `.` against `_` would give the same name in generated code. */
void generated_names_check(Reader *reader, const char *thing, const char *const *name, const Place *at, int count);

/* ---- read_bodies.c ---- */

void bodies_read(Reader *reader, const Item *base, const Item *bodies);
/* A point or a direction of the model frame, and what it follows, in the frame of a body (BODY_GROUND: unchanged); out:
 * its place in the Model. */
void body_point(const Reader *reader, int body, const double x[3], const Ex tuned[3], Place at, double out[3]);
void body_direction(const Reader *reader, int body, const double x[3], const Ex tuned[3], double out[3]);
/* Take the spin inertia of a wheel off the inertia of the body that carries it, which must leave that of a body. */
void spin_take(const Reader *reader, const Wheel *wheel, const char *what, Place at);

/* ---- read_shape.c ---- */

/* The `shape` of a body that has mass, centre of mass and frame; NULL where item is. */
const BodyShape *shape_read(Reader *reader, const Item *item, const Entry *body, int index);

/* ---- read_links.c: joints and dual coordinates; read_loads.c: inputs, forces; read_outputs.c ---- */

/* ---- read_laws.c: parameters, tables, ports ---- */

void parameters_read(Reader *reader, const Item *map);
void tables_read(Reader *reader, const Item *map);
void ports_read(Reader *reader, const Item *map);

void joints_read(Reader *reader, const Item *map);
void coordinates_read(Reader *reader, const Item *map);
void inputs_read(Reader *reader, const Item *map);
void forces_read(Reader *reader, const Item *map);
void outputs_read(Reader *reader, const Item *map);

/* ---- read_tires.c, tir.c, read_wheels.c ---- */

void tires_read(Reader *reader, const Item *map);
/* The tire of the `.tir` file that `item` names, all but what the model says of it. what: "tire 'front'". */
void tir_read(const Reader *reader, const Item *item, const char *what, Tire *tire);
void wheels_read(Reader *reader, const Item *map);
/* Refuses a drive_body where nothing drives the wheel; after the powertrain was read, whose mistakes could be why. map:
 * of the wheels. */
void wheels_driven_check(const Reader *reader, const Item *map);

/* ---- read_powertrain.c ---- */

void powertrain_read(Reader *reader, const Item *item);

/* The unit vector perpendicular to a unit axis that is as near as can be to the axis of the model frame to which it is
 * least parallel (e_1 of FORMAT.md section 5), fixed in both bodies; all in the model frame but `out`, its places in
 * the Model. */
void perpendicular_set(const Reader *reader, const double axis[3], const Ex tuned[3], const int body[2],
                       double out[2][3]);
/* x_b - x_a of two points of the model frame and its norm; both ends in one place end in diag_fail. *tuned: what the
 * norm follows, 0: no parameter. */
double points_distance(const Reader *reader, const Value *points, const char *what, double d[3], Ex *tuned);

/* ---- read_tuned.c: the same steps as formulas, for numbers that follow tunable parameters ---- */

bool any_tuned(const Ex *tuned, int count);
/* Formulas of numbers, whether they follow parameters or not. */
void formulas(const Reader *reader, const double *number, const Ex *tuned, int count, Ex *out);
/* Formulas that follow no parameter become 0. */
void tuned_reduce(const Reader *reader, Ex *formula, int count);
/* A given direction u becomes a unit vector. */
void axis_tune(const Reader *reader, const double u[3], Ex tuned[3], const char *what);
/* The perpendicular to a unit axis of FORMAT.md section 5, e_1. */
void perpendicular_tune(const Reader *reader, const double axis[3], const Ex tuned[3], Ex out[3]);
/* What is perpendicular to the axis of a joint: as near as can be to `side`, which is so in the file, lest pivots go.
 */
void side_tune(const Reader *reader, const double axis[3], const Ex tuned[3], const double side[3], const char *what,
               Ex out[3]);
/* The second of two unit axes becomes its part perpendicular to the first; tolerance: largest cosine between them. */
void square_tune(const Reader *reader, const double axes[6], Ex tuned[6], double tolerance, const char *what);
/* What x_b - x_a follows, as `formulas` has it; what its norm follows, 0: no parameter. */
void points_formula(const Reader *reader, const Value *points, Ex d[3]);
Ex distance_tune(const Reader *reader, const Value *points, const char *what);
/* Length and offset of a link, from the drawing to given ones. */
void link_tune(const Reader *reader, const Value *points, const Value *axis, const Value *length, const Value *offset,
               double tolerance, const char *what, Joint *joint);
/* Design and initial value of a coordinate stay inside its range. */
void range_tune(const Reader *reader, const Value *range, const char *what, const Coordinate *coordinate);

#endif
