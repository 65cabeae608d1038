/* SPDX-License-Identifier: MIT
 * A vehicle of models/FORMAT.md while it is put together at random: entries of its sections, as text. */
#ifndef RANDOM_VEHICLE_H
#define RANDOM_VEHICLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum Kind {
    PARAMETER,
    TABLE,
    BODY,
    JOINT,
    COORDINATE,
    FORCE,
    WHEEL,
    OUTPUT,
    POINT,
    INPUT,
    TIRE,
    STATE,
    DIFFERENTIAL,
    KINDS
} Kind;

typedef enum Mistake {
    NO_MISTAKE,
    JOINT_MISSING,
    COORDINATE_MISSING,
    JOINT_TOO_MANY,
    COORDINATE_TOO_MANY,
    BODY_LOOSE,
    PRISMATIC_TWICE,      /* the rack guided twice */
    PARALLEL_TWICE,       /* as many equations as unknowns, and yet one thing said twice */
    TIE_ROD_ON_KINGPIN,   /* singular everywhere */
    SPRING_THROUGH_HINGE, /* singular at the design */
    MISTAKES
} Mistake;

enum { MOST = 400, BASE = 0, NOTHING = -1, PARTS = 4, GAINS = 3, KNOWN = 30 };

typedef struct Entry {
    char name[32];
    char text[1200];  /* as a file of its part has it */
    char plain[1200]; /* as one file without inclusion and mirror images has it */
    int end[2];       /* bodies that it concerns, or NOTHING */
    int coordinate;   /* of a force, or NOTHING */
    double design;    /* of a coordinate that nice_dual() made */
    int part;         /* file that it stands in; 0: the vehicle's own */
    int image;        /* its mirror image in the same section, or NOTHING */
    bool is_image;    /* only a plain file has it */
    bool dropped;
} Entry;

/* A point or direction of the model frame. */
typedef struct Vec {
    double x[3];
} Vec;

/* A file that the vehicle includes. */
typedef struct Part {
    Vec at;          /* added to its points */
    bool has_prefix; /* its names lack `name` in the file */
    char name[16];   /* that all its names begin with */
} Part;

typedef struct Section {
    int count;
    Entry entry[MOST];
} Section;

typedef struct Vehicle {
    uint64_t random, seed; /* random numbers: as they stand, as they started */
    bool fixed;            /* the base is the ground */
    bool tuned;            /* some of its numbers are tunable parameters */
    int names;             /* given so far */
    Mistake mistake;       /* still to be made while the vehicle is put together */
    char culprits[300];
    bool rich;             /* with tires, formulas, inclusion, mirror images */
    int parts, part_now;   /* files that it includes; that entries go into, or 0 */
    Part part[PARTS + 1];  /* [0] is the vehicle's own */
    bool mirrors, image;   /* what is added is the left one of two; or the right one */
    int left_count[KINDS]; /* of an image: how many entries its left one has */
    bool tired, driven;    /* its wheels roll; a powertrain drives them */
    double spin;           /* kg m^2, the most that a wheel's spin inertia may be */
    const char *gain[GAINS], *input[GAINS];
    char powertrain[4000];
    double nice;         /* how often a number is such as people write */
    bool conserves;      /* nothing takes energy away or brings any */
    const char *gravity; /* as the file has it, or NULL */
    bool halves;         /* what is built on a free base is there twice, on the left and on the right */
    int own;             /* bodies from here on may carry others, and the base */
    int points, axes;    /* that others may have too */
    Vec place[KNOWN], axis[KNOWN];
    Section section[KINDS];
} Vehicle;

/* ---- random numbers; equal seeds give equal ones ---- */

void start_random(Vehicle *v, double seed);
double uniform(Vehicle *v, double low, double high);
bool chance(Vehicle *v, double probability);
int pick(Vehicle *v, int count);

/* ---- points and directions, model frame ---- */

/* Whole millimetres, so that points made of others by halving and doubling lie exactly where they should. */
Vec near_to(Vehicle *v, double x, double y, double z, double spread);
Vec point(Vehicle *v, double x, double y, double z);
/* A direction not far from the one given; its length is of no account. */
Vec direction(Vehicle *v, double x, double y, double z);
/* p a + q b */
Vec combine(double p, Vec a, double q, Vec b);
Vec cross(Vec a, Vec b);
double norm(Vec a);
/* Some direction perpendicular to u. */
Vec across(Vehicle *v, Vec u);

/* ---- entries ---- */

void append(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* In all files alike. */
void say(Entry *entry, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A number, or in its place the name of a tunable parameter that has its value. */
void say_number(Vehicle *v, Entry *entry, const char *lead, double value);
/* What a mirror does to three numbers: see section 13 of FORMAT.md. */
void say_point(Vehicle *v, Entry *entry, const char *lead, Vec u);
void say_direction(Vehicle *v, Entry *entry, const char *lead, Vec u);
void say_turning(Vehicle *v, Entry *entry, const char *lead, Vec u);
/* Three numbers that are the same in a mirror. */
void say_vector(Vehicle *v, Entry *entry, const char *lead, Vec u);
/* Begin what stands on the left, and its image on the right, which is the same again: whoever calls adds both by the
 * same calls. What is added after both has no image. */
typedef struct Mirror {
    uint64_t random;
    int names, first[KINDS];
} Mirror;
void begin_left(Vehicle *v, Mirror *mirror);
void begin_right(Vehicle *v, const Mirror *mirror);
void end_mirror(Vehicle *v, const Mirror *mirror);
/* A new entry of a section with a name of its own. */
Entry *add(Vehicle *v, Kind kind, const char *prefix);
const char *body_name(const Vehicle *v, int body);
/* Put a name among those of which a message must have one; the bodies of an entry that move. */
void culprit(Vehicle *v, const char *name);
void culprit_bodies(Vehicle *v, const Entry *entry);

/* What a joint or coordinate is made of; members that its type does not have are NULL. */
typedef struct Geometry {
    const Vec *point, *points[2], *axis, *axes[2];
    bool ordered; /* bodies must not change places */
} Geometry;

/* Type, bodies and geometry, the bodies in either order. */
void say_connection(Vehicle *v, Entry *entry, const char *type, int a, int b, const Geometry *with);

/* ---- parts ---- */

/* An ellipsoid of random half axes about `size`, turned against the body frame; its frame stands anywhere near. */
int add_body(Vehicle *v, const char *prefix, Vec com, double mass, double size);
/* The same, and heavy enough about all axes for what spins on it. */
int add_carrier(Vehicle *v, const char *prefix, Vec com, double mass, double size);
Entry *join(Vehicle *v, const char *prefix, const char *type, int a, int b, const Geometry *with);
/* b turns on a about u: a revolute, or what is equal to it. */
Entry *hinge(Vehicle *v, int a, int b, Vec p, Vec u);
/* b slides on a along u: a prismatic joint (always, where `plain`), or what is equal to it. */
Entry *guide(Vehicle *v, int a, int b, Vec p, Vec u, bool plain);
/* b is fixed on a, by a joint or by what is equal to it. */
void weld(Vehicle *v, int a, int b, Vec p);
Entry *ball(Vehicle *v, int a, int b, Vec p);
/* An element of some kind between two points of two bodies or, with an axis, about that. */
void element(Vehicle *v, int a, int b, const Geometry *with, double stiffness);
/* A rod, sometimes of another length than drawn. */
Entry *rod(Vehicle *v, int a, int b, Vec p_a, Vec p_b);
/* A dual coordinate, mostly with a spring. `reach` is half the width of its range; stiffness 0: no spring. */
Entry *coordinate(Vehicle *v, const char *prefix, const char *type, int a, int b, const Geometry *with, double reach,
                  double stiffness, bool may_drive);
/* A table over `width` on either side of 0, where it is 0, and `force` at the end. */
const char *add_table(Vehicle *v, double width, double force);

/* ---- of rich vehicles ---- */

/* A formula of `variable`s of a size of about 1, and of gains and inputs; some numbers in size. */
void say_formula(Vehicle *v, Entry *entry, int depth, const char *const *variable, int variables);
/* One of all coordinates and their rates. */
void say_any_formula(Vehicle *v, Entry *entry, int depth);
void add_gains(Vehicle *v);
void add_tires(Vehicle *v);
/* The rest of a wheel's entry: what rolls. `carrier` is a body. */
void say_rolling(Vehicle *v, Entry *wheel, int carrier);
void add_powertrain(Vehicle *v);
/* Writes SEED.veh, what it includes, its tire, and SEED.plain.veh, which is the same in one file written out. `tire` is
 * the path of a .tir file to vary. */
void write_files(Vehicle *v, const char *folder, double seed, const char *tire);
/* The same in one file. */
void write_plain(Vehicle *v, FILE *out, double seed);

/* ---- numbers that people write: nice.c ---- */

bool is_nice(Vehicle *v);
/* 1, 1/2, 2, 0.1 or 10, or anything between low and high. */
double nice_size(Vehicle *v, double low, double high);
/* An axis of the model frame, one that there is already, or any; perpendicular to u. */
Vec nice_axis(Vehicle *v);
Vec nice_across(Vehicle *v, Vec u);
/* A point 0, 1/2, 1 or 2 m away along the axes, or any. The second: or one that there is already. */
Vec nice_step(Vehicle *v, Vec from);
Vec nice_point(Vehicle *v, Vec near);
/* A body of about 1 kg and 1 m; a coordinate, whose range is more than a turn where it is an angle that
 * `turns`: their indices. */
int nice_body(Vehicle *v, const char *prefix, Vec com);
int nice_dual(Vehicle *v, const char *type, int a, int b, const Geometry *with, bool turns);

/* mechanism.c: the whole of it, outputs too. */
void build_mechanism(Vehicle *v);

#endif
