/* SPDX-License-Identifier: MIT
 *
 * Private to generator/read. A section of a `.veh` file is a table of keys; the same table checks the file
 * (unknown, missing and misplaced keys, kinds, bounds) and reads it. */
#ifndef READ_READER_H
#define READ_READER_H

#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"

struct FileNumber; /* read.h */
struct stat;

/* The kind of value of a key, and the member of Value in which section_read leaves it. Vectors and points: model frame.
 */
typedef enum KeyKind {
    KEY_TYPE,          /* one of the section's types; read by section_type */
    KEY_ITEM,          /* read by the section itself: item */
    KEY_FORMULA,       /* read by the section itself: a number or a formula */
    KEY_STIFFNESS,     /* read by the section itself: a formula, or such of six axes: a list or a triangle */
    KEY_FORCE_VECTOR,  /* read by the section itself: three formulas, components of a force */
    KEY_WORLD_VECTOR,  /* read by the section itself: three formulas, of the world, which the mirror leaves as it is */
    KEY_TORQUE_VECTOR, /* read by the section itself: three formulas, components of a torque */
    KEY_INERTIA,       /* read by the section itself: a list of numbers or a map of inertia_section */
    KEY_ORIENTATION,   /* read by the section itself: a map of orientation_section */
    KEY_LIST,          /* a list of numbers: item */
    KEY_TEXT,          /* text */
    KEY_INTERPOLATION, /* one of two words (kind_words); flag: true for the second one */
    KEY_BEYOND,        /* one of two words, likewise */
    KEY_SIDE,          /* one of two words, likewise; the mirror exchanges them */
    KEY_NAME,          /* text */
    KEY_NUMBER,        /* number[0], which may not follow a tunable parameter */
    KEY_MEASURE,       /* number[0], which may follow one */
    KEY_ODD,           /* as KEY_MEASURE; the mirror changes its sign */
    KEY_PAIR,          /* number[0], number[1], each within the bound */
    KEY_FLAG,          /* flag */
    KEY_RANGE,         /* number[0] < number[1] */
    KEY_VECTOR,        /* number[0..2] */
    KEY_AXIS,          /* number[0..2], unit length */
    KEY_TURN,          /* as KEY_AXIS; an axis of rotation, which the mirror reverses (axial vector) */
    KEY_DUAL_AXIS,     /* as KEY_TURN if the type is `angle` or `gear`, else as KEY_AXIS */
    KEY_AXES,          /* number[0..2], number[3..5], each of unit length */
    KEY_EULER,         /* number[0..3] */
    KEY_POINT,         /* number[0..2] */
    KEY_POINTS,        /* number[0..2], number[3..5] */
    KEY_BODY,          /* index[0]; ground only if it is the base */
    KEY_BODIES,        /* index[0] and index[1], different; ground only if it is the base */
    KEY_FORCE_BODIES,  /* as KEY_BODIES, ground always allowed */
    KEY_FRAME,         /* a body or `world`: index[0], BODY_GROUND for world */
    KEY_COORDINATE,    /* index[0] */
    KEY_JOINT,         /* index[0] */
    KEY_FORCE,         /* index[0] */
    KEY_TIRE,          /* index[0] */
    KEY_WHEEL,         /* index[0] */
    KEY_TABLE,         /* index[0] */
    KEY_SIGNAL,        /* index[0] */
    KEY_SHAPE,         /* item: a word, a path or a map of shape_section */
    KEY_PATH,          /* text: a path; its item is negated if the mirror image of the file's contents is meant */
    KEY_SERIES,        /* a list of any length: item */
    KEY_OUTPUTS,       /* names of one or two wheels or differentials: item */
    KEY_ENGINE,        /* item: a map of engine_section, and so on */
    KEY_CONVERTER,
    KEY_TRANSMISSION,
    KEY_DIFFERENTIALS, /* item: a map of named entries of differential_section */
    KEY_POWERTRAIN,    /* item: a map of powertrain_section */
    KEY_RULES,         /* item: a map of named entries of rule_section, or of formulas */
    KEY_KINDS
} KeyKind;

typedef enum Bound { BOUND_NONE, BOUND_NOT_NEGATIVE, BOUND_POSITIVE } Bound;

/* If the entries of a section have several forms (types), bits say which forms know a key and which require it. */
#define FORM(form) (1u << (form))
#define ALL_FORMS (~0u)

typedef struct Key {
    const char *name;
    KeyKind kind;
    unsigned allowed, required;
    Bound bound;     /* numbers */
    double fallback; /* numbers: the value if the key is absent */
} Key;

typedef struct Section {
    const Key *key;
    int keys;
    const char *const *type; /* the words of the key `type`, if the section has one */
    int types;
    const char *const *form;    /* names of the forms, for messages; NULL: there is one form */
    const unsigned *type_forms; /* the forms of each type; NULL: type i has form i */
    const char *const *about;   /* [keys] one line about the key with its unit; no quotes or backslashes */
} Section;

typedef struct Value {
    const Item *item; /* NULL: the key is absent */
    double number[6];
    Ex tuned[6]; /* formulas of the numbers in the model's tuning; 0: follows no tunable parameter */
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
    bool fixed; /* values of this entry may follow no tunable parameter */
    SignalReads reads;
} Reader;

/* One entry of a map of named things. */
typedef struct Entry {
    const char *name, *what; /* "hinge", "joint 'hinge'" */
    Place at;                /* of the name */
    const Item *item;
} Entry;

/* Sections of the file and of an `include` entry, whose values a mirror image, a move or a prefix changes. */
extern const Section file_section, part_section;
extern const Section parameter_section, table_section, port_section;
extern const Section body_section, shape_section, inertia_section, orientation_section, joint_section;
extern const Section argument_section;
extern const Section coordinate_section;
extern const Section input_section, force_section, tire_section, wheel_section, output_section, signal_section,
    state_section, controller_section, rule_section;
extern const Section powertrain_section, engine_section, converter_section, transmission_section, differential_section;

/* An example of each kind of value, for remedies. */
extern const char *const kind_example[KEY_KINDS];
/* The two words of kinds that are one of two, the default first; else NULL. */
extern const char *const kind_words[KEY_KINDS][2];
/* The section of the entries of a group of the file ("joints"); NULL: points, or no group. */
const Section *group_section(const char *group);

/* ---- rewrite.c: entries written anew ---- */

/* ---- arguments.c ---- */

/* A name by which an included file refers to what the including one gives it. */
typedef struct Argument {
    const char *group, *name; /* of an entry ("points") */
    const char *to;           /* the name of the including file that it stands for; NULL: it is an entry itself */
    Place at;                 /* of that name */
    const Item *value;        /* of that entry, as the including file has it; NULL: the default */
} Argument;

typedef struct Arguments {
    int count;
    Argument *argument;
} Arguments;

/* NULL: there is none of that name. */
const Argument *argument_find(const Arguments *arguments, const char *group, const char *name);
/* The file with entries for arguments that are not names, once `with` (NULL: nothing is given) has been checked against
 * what it asks for; at: of the inclusion. */
const Item *arguments_bind(Reader *reader, const Item *file, const Item *with, Place at, Arguments *arguments);

/* A change of the entries of a file and of the names in them: mirror image, move, prefix. */
typedef struct Rewrite {
    Pool *pool;
    const Item *file;           /* names of this file's entries change, and references to them */
    const char *prefix;         /* in front of every name; "": none */
    bool mirror;                /* y becomes -y, and names change their side */
    double shift[3];            /* added to every point, before the mirror */
    const Arguments *arguments; /* names that stand for others, NULL: none */
    const Source *source;       /* the place of rewritten entries in messages; NULL: the place of the original */
} Rewrite;

/* True if a key of a file holds a map of named entries that a Rewrite changes. */
bool is_group(const char *group);
/* The rewritten copy of `entry` of a group ("bodies"), and the rewritten word `item`, a reference to the group or the
 * name of an entry. Values that do not fit the tables are copied unchanged; the reader refuses them. */
Item *entry_rewrite(const Rewrite *rewrite, const char *group, Item *entry);
Item *name_rewrite(const Rewrite *rewrite, const char *group, Item *item);
/* The rewritten copy of a map of a section. */
Item *map_rewrite(const Rewrite *rewrite, const Section *section, Item *map);
/* The name on the other side: `_l` becomes `_r` and `_r` becomes `_l`; NULL for any other name. */
const char *name_mirrored(Pool *pool, const char *name);

/* ---- mirror_images.c, include.c ---- */

/* The file with a mirror image `*_r` after every entry `*_l` that has none (FORMAT.md section 13). */
const Item *file_mirrored(Pool *pool, const Item *file);
/* A file and all files that it includes (FORMAT.md section 12), as if written as one; the version is checked. */
const Item *file_included(Pool *pool, const char *path);
/* The same where a text in memory is in place of the file. */
const Item *text_included(Pool *pool, const char *path, const char *text, size_t size);
/* The same from the bytes of an earlier reading of it and of the files that it includes. */
const Item *known_included(Pool *pool, const Source *known);
/* set.c: true if settings_put() takes this name. */
bool setting_known(Pool *pool, const Item *file, const char *name);
/* set.c: a file with other numbers in place of its own. */
const Item *settings_put(Pool *pool, const Item *file, const struct FileNumber *setting, int count);
/* The same for the values of all tunable parameters of the model that was read from it, mirror images too. */
const Item *parameters_put(Pool *pool, const Item *file, const Model *model, const double *value);
/* The path of the file `name`, which `item` names, relative to the folder of `file`; ends in diag_fail if it can't be
 * read. use: its purpose in messages, "include". */
const char *path_check(Pool *pool, const Item *item, const char *file, const char *name, const char *use,
                       struct stat *identity);

/* ---- section.c ---- */

/* A name must be letters, digits and `_` and begin with a letter; `what`: the named thing ("a body"). */
void name_check(const char *name, const char *what, Place at);

/* The entries of a map of `thing`s ("joint") in the order of the file, with their names checked; map NULL: none. */
Entry *section_entries(Reader *reader, const Item *map, const char *thing, int *count);
/* The form that an entry's `type` selects. */
int section_type(Reader *reader, const Section *section, const Entry *entry);
/* Check an entry against the keys of a form and read them: value[k] belongs to section->key[k]. */
void section_read(Reader *reader, const Section *section, int form, const Entry *entry, Value *value);
/* True if the text of a scalar mentions a parameter. */
bool mentions_parameter(const Reader *reader, const Item *item);
/* A number or a formula of parameters; a vector of such. tuned: its formulas, 0: follows no tunable parameter; NULL:
 * tunable parameters end in diag_fail. */
double number_read(Reader *reader, const Item *item, const char *what, Ex *tuned);
void vector_read(Reader *reader, const Item *item, const char *what, double *out, int size, Ex *tuned);
/* Check a number against the bound of its key, and a point against the largest distance from the origin (FORMAT.md
 * section 14). */
void bound_check(const Key *key, const Item *item, const char *what, double number);
/* What the key asks of `what`, for values of tunable parameters: "fade of force 'stop' must be greater than zero". */
const char *bound_text(Pool *pool, const Key *key, const char *what);
void point_check(const Item *item, const char *what, const double x[3]);
/* The prefix of generated names must be an identifier that C, C++ and their libraries do not use. */
void model_name_check(const char *name, Place at);
/* reserved_names.c: why a name can't be used ("is reserved in C or C++"); NULL: it can. */
const char *name_reserved(const char *name);
/* Divide `vector` by its norm, without overflow; false if it is zero. */
bool vector_normalize(double *vector, int size);
/* Refuse names that are equal in generated code: they differ only in case or in `.` against `_`. */
void generated_names_check(Reader *reader, const char *thing, const char *const *name, const Place *at, int count);

/* ---- bodies.c ---- */

void bodies_read(Reader *reader, const Item *base, const Item *bodies);
/* Euler parameters of an `orientation` of an entry. */
void orientation_read(Reader *reader, const Item *item, const Entry *of, double euler[4]);
/* A point or a direction of the model frame, and its formula, in the frame of a body (BODY_GROUND: unchanged); out:
 * where the Model keeps it. */
void body_point(const Reader *reader, int body, const double x[3], const Ex tuned[3], Place at, double out[3]);
void body_direction(const Reader *reader, int body, const double x[3], const Ex tuned[3], double out[3]);
/* Subtract the spin inertia of a wheel from the inertia of the body that carries it; the rest must be the inertia of a
 * body. */
void spin_take(const Reader *reader, const Wheel *wheel, const char *what, Place at);

/* ---- shape.c ---- */

/* The `shape` of a body whose mass, centre of mass and frame are known; item NULL: none is given. */
const BodyShape *shape_read(Reader *reader, const Item *item, const Entry *body, int index);

/* ---- joints.c: joints and dual coordinates; forces.c: inputs, forces; outputs.c ---- */

/* ---- parameters.c: parameters, tables, ports ---- */

void parameters_read(Reader *reader, const Item *map);
void tables_read(Reader *reader, const Item *map);
void ports_read(Reader *reader, const Item *map);

void joints_read(Reader *reader, const Item *map);
/* Formulas of gears and couplers, once all names are known that formulas may contain. */
void couplers_read(Reader *reader, const Item *map);
/* coupler_bends.c: warn where the formula of a coupler, `what`, jumps or bends within the range of a coordinate. */
void coupler_bends(const Model *model, const Law *law, const Item *item, const char *what);
void coordinates_read(Reader *reader, const Item *map);
void inputs_read(Reader *reader, const Item *map);
void forces_read(Reader *reader, const Item *map);
void outputs_read(Reader *reader, const Item *map);
/* Refuse outputs that have the same name in generated code. */
void outputs_names_check(Reader *reader);

/* True if the mirror changes the sign of a component of outputs of this type. */
bool output_is_odd(OutputType type, int component);
/* True if it follows accelerations, which follow forces, or all forces of elements. */
bool output_follows_accelerations(OutputType type, int component);

/* ---- states.c ---- */

/* The entries of `states` but their rates, which formulas follow: before any formula but those of parameters is read.
 */
void states_declare(Reader *reader, const Item *map);
/* Their rates, after the wheels, whose fast states come before theirs. */
void states_read(Reader *reader, const Item *map);
/* After all that has states: fail if a state's name in generated code is another one's, too. */
void own_states_check(Reader *reader);

/* A value at set-up must be one that a state may have. */
void initial_check(const Item *item, const char *what, double initial);

/* ---- controllers.c ---- */

/* The entries of `controllers` without their formulas: names and what they hold, after `states`. */
void controllers_declare(Reader *reader, const Item *map);
/* Places of what they hold, after all other fast states. */
void controllers_place(Reader *reader);
/* Their formulas, after the outputs, behind which these of theirs stand. */
void controllers_read(Reader *reader, const Item *map);

/* ---- signals.c ---- */

/* True for a word that means something of its own in some formula: `time`, or `speed` of a force between points. */
bool is_formula_word(const char *name);
/* Refuse a name that formulas have for something else; thing: "signal". */
void formula_name_check(const Reader *reader, const Entry *entry, const char *thing);
/* The entries of `signals`, before forces are read. */
void signals_read(Reader *reader, const Item *map);
/* Once outputs are read: find the signals that formulas read, and refuse forces that would follow accelerations or
 * themselves. */
void signals_close(Reader *reader);

/* ---- unread.c ---- */

/* Warn of entries that no formula and no other entry refers to. Call when all is read. */
void unread_tell(const Reader *reader);

/* ---- tires.c, tir_file.c, wheels.c ---- */

void tires_read(Reader *reader, const Item *map);
/* The tire of the `.tir` file that `item` names; keys of the model are not applied. what: "tire 'front'". */
void tir_read(const Reader *reader, const Item *item, const char *what, Tire *tire);
void wheels_read(Reader *reader, const Item *map);
/* Refuse a drive_body of a wheel that nothing drives. Call after the powertrain is read, since a mistake there may be
 * the reason. map: of the wheels. */
void wheels_driven_check(const Reader *reader, const Item *map);

/* ---- powertrain.c ---- */

void powertrain_read(Reader *reader, const Item *item);

/* The direction e_1 of FORMAT.md section 5 for a unit axis: the perpendicular to it nearest to the axis of the model
 * frame that is least parallel to it; fixed in both bodies. All in the model frame but `out`, where the Model keeps it.
 */
void perpendicular_set(const Reader *reader, const double axis[3], const Ex tuned[3], const int body[2],
                       double out[2][3]);
/* x_b - x_a of two points of the model frame, and its norm; points that coincide end in diag_fail. *tuned: formula of
 * the norm, 0: follows no parameter. */
double points_distance(const Reader *reader, const Value *points, const char *what, double d[3], Ex *tuned);

/* ---- tunable_geometry.c: the same steps as formulas, for numbers that follow tunable parameters ---- */

bool any_tuned(const Ex *tuned, int count);
/* Formulas of numbers; a literal for a number that follows no parameter. */
void formulas(const Reader *reader, const double *number, const Ex *tuned, int count, Ex *out);
/* Replace formulas that follow no parameter by 0. */
void tuned_reduce(const Reader *reader, Ex *formula, int count);
/* Formulas for the unit vector of a given direction u. */
void axis_tune(const Reader *reader, const double u[3], Ex tuned[3], const char *what);
/* Formulas for e_1 of FORMAT.md section 5. */
void perpendicular_tune(const Reader *reader, const double axis[3], const Ex tuned[3], Ex out[3]);
/* Formulas for a direction perpendicular to the axis of a joint. It is the one nearest to `side`, the direction in the
 * file, so that pivots chosen there remain valid. */
void side_tune(const Reader *reader, const double axis[3], const Ex tuned[3], const double side[3], const char *what,
               Ex out[3]);
/* Formulas for the part of the second unit axis that is perpendicular to the first; tolerance: largest cosine between
 * them. */
void square_tune(const Reader *reader, const double axes[6], Ex tuned[6], double tolerance, const char *what);
/* Formulas of the components of x_b - x_a, and of its norm; norm 0: follows no parameter. */
void points_formula(const Reader *reader, const Value *points, Ex d[3]);
Ex distance_tune(const Reader *reader, const Value *points, const char *what);
/* Formulas of length and offset of a link on the way from the drawing to the given ones. */
void link_tune(const Reader *reader, const Value *points, const Value *axis, const Value *length, const Value *offset,
               double tolerance, const char *what, Joint *joint);
/* Conditions at set-up: design and initial value of a coordinate stay inside its range. */
void range_tune(const Reader *reader, const Value *range, const char *what, const Coordinate *coordinate);

#endif
