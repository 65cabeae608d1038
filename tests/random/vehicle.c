/* SPDX-License-Identifier: MIT
 * Random numbers, entries and the parts that vehicles are made of. */
#include "vehicle.h"

#include "../reference/support.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void start_random(Vehicle *v, double seed)
{
    v->random = ((uint64_t)seed + 1) * 0x9e3779b97f4a7c15u | 1;
    for (int i = 0; i < 20; ++i)
        uniform(v, 0, 1); /* neighbouring seeds part */
    v->seed = v->random;
}

/* xorshift64* */
double uniform(Vehicle *v, double low, double high)
{
    v->random ^= v->random >> 12;
    v->random ^= v->random << 25;
    v->random ^= v->random >> 27;
    return low + (high - low) * ((double)(v->random * 0x2545f4914f6cdd1du >> 11) * 0x1p-53);
}

bool chance(Vehicle *v, double probability)
{
    return uniform(v, 0, 1) < probability;
}

int pick(Vehicle *v, int count)
{
    return (int)uniform(v, 0, count);
}

/* ---- points and directions, model frame ---- */

Vec near_to(Vehicle *v, double x, double y, double z, double spread)
{
    Vec out = {{x, y, z}};
    for (int i = 0; i < 3; ++i)
        out.x[i] = round(1000 * (out.x[i] + uniform(v, -spread, spread))) / 1000;
    return out;
}

/* The same, by random numbers that follow from the place itself: they don't depend on the order in which a compiler
 * evaluates arguments. */
static Vec shifted(Vehicle *v, double x, double y, double z, double spread)
{
    const double place[] = {x, y, z, spread};
    uint64_t kept = v->random;
    v->random = v->seed;
    for (int i = 0; i < 4; ++i) {
        v->random ^= (uint64_t)(int64_t)round(1e6 * place[i]) * 0x9e3779b97f4a7c15u;
        uniform(v, 0, 1);
    }
    Vec out = near_to(v, x, y, z, spread);
    v->random = kept;
    return out;
}

Vec point(Vehicle *v, double x, double y, double z)
{
    return shifted(v, x, y, z, 0.025);
}

Vec direction(Vehicle *v, double x, double y, double z)
{
    return shifted(v, x, y, z, 0.15);
}

Vec combine(double p, Vec a, double q, Vec b)
{
    for (int i = 0; i < 3; ++i)
        a.x[i] = p * a.x[i] + q * b.x[i];
    return a;
}

Vec cross(Vec a, Vec b)
{
    Vec out;
    for (int i = 0; i < 3; ++i)
        out.x[i] = a.x[(i + 1) % 3] * b.x[(i + 2) % 3] - a.x[(i + 2) % 3] * b.x[(i + 1) % 3];
    return out;
}

double norm(Vec a)
{
    return sqrt(a.x[0] * a.x[0] + a.x[1] * a.x[1] + a.x[2] * a.x[2]);
}

Vec across(Vehicle *v, Vec u)
{
    Vec other, out;
    do {
        other = near_to(v, 0, 0, 0, 1);
        out = cross(u, other);
    } while (norm(out) < 0.5 * norm(u) * norm(other));
    return out;
}

/* ---- entries ---- */

void append(char *text, size_t size, const char *format, ...)
{
    size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    int wanted = vsnprintf(text + used, size - used, format, args);
    va_end(args);
    if (wanted < 0 || (size_t)wanted >= size - used)
        fail("an entry is too long: %s", text);
}

void say(Entry *entry, const char *format, ...)
{
    char *const text[] = {entry->text, entry->plain};
    for (int i = 0; i < 2; ++i) {
        size_t used = strlen(text[i]), size = sizeof entry->text;
        va_list args;
        va_start(args, format);
        int wanted = vsnprintf(text[i] + used, size - used, format, args);
        va_end(args);
        if (wanted < 0 || (size_t)wanted >= size - used)
            fail("an entry is too long: %s", text[i]);
    }
}

Entry *add(Vehicle *v, Kind kind, const char *prefix)
{
    Section *section = &v->section[kind];
    if (section->count == MOST)
        fail("the vehicle is too large");
    Entry *entry = &section->entry[section->count++];
    const char *side = v->image ? "_r" : v->mirrors ? "_l" : "";
    append(entry->name, sizeof entry->name, "%s%s_%d%s", v->part[v->part_now].name, prefix, ++v->names, side);
    entry->end[0] = entry->end[1] = entry->coordinate = entry->image = NOTHING;
    entry->part = v->part_now;
    entry->is_image = v->image;
    return entry;
}

/* ---- images ---- */

void begin_left(Vehicle *v, Mirror *mirror)
{
    mirror->random = v->random;
    mirror->names = v->names;
    for (int kind = 0; kind < KINDS; ++kind)
        mirror->first[kind] = v->section[kind].count;
    v->mirrors = true;
}

void begin_right(Vehicle *v, const Mirror *mirror)
{
    v->random = mirror->random;
    v->names = mirror->names;
    v->image = true;
    for (int kind = 0; kind < KINDS; ++kind)
        v->left_count[kind] = v->section[kind].count - mirror->first[kind];
}

void end_mirror(Vehicle *v, const Mirror *mirror)
{
    for (int kind = 0; kind < KINDS; ++kind) {
        Section *section = &v->section[kind];
        int first = mirror->first[kind], count = v->left_count[kind];
        if (section->count != first + 2 * count)
            fail("the right side has another number of entries than the left one");
        for (int i = first; i < first + count; ++i)
            section->entry[i].image = i + count;
    }
    v->mirrors = v->image = false;
}

/* ---- numbers ---- */

/* `value` in a file whose points are moved by `shift`; in an image it has the factor `sign`. */
static void say_component(Vehicle *v, Entry *entry, const char *lead, double value, double sign, double shift)
{
    if (!v->image)
        sign = 1;
    if (!v->tuned || !chance(v, 0.04)) {
        append(entry->text, sizeof entry->text, "%s%.9g", lead, value - shift);
        append(entry->plain, sizeof entry->plain, "%s%.9g", lead, sign * value);
        return;
    }
    Entry *parameter = add(v, PARAMETER, "number");
    bool twice = v->rich && chance(v, 0.3);
    double half = twice ? (value - shift) / 2 : value - shift;
    say(parameter, "value: %.*g, tunable: true", twice ? 10 : 9, half);
    append(entry->text, sizeof entry->text, twice ? "%s\"2 * %s\"" : "%s%s", lead, parameter->name);
    if (sign > 0 && shift == 0)
        append(entry->plain, sizeof entry->plain, twice ? "%s\"2 * %s\"" : "%s%s", lead, parameter->name);
    else
        append(entry->plain, sizeof entry->plain, "%s\"%d * (%.9g + %d * %s)\"", lead, (int)sign, shift, 1 + twice,
               parameter->name);
}

void say_number(Vehicle *v, Entry *entry, const char *lead, double value)
{
    say_component(v, entry, lead, value, 1, 0);
}

static void say_three(Vehicle *v, Entry *entry, const char *lead, Vec u, Vec sign, Vec shift)
{
    say(entry, "%s", lead);
    for (int i = 0; i < 3; ++i)
        say_component(v, entry, i ? ", " : "[", u.x[i], sign.x[i], shift.x[i]);
    say(entry, "]");
}

static const Vec zero = {{0, 0, 0}}, same = {{1, 1, 1}}, reflected = {{1, -1, 1}}, turned = {{-1, 1, -1}};

void say_point(Vehicle *v, Entry *entry, const char *lead, Vec u)
{
    if (v->rich && chance(v, 0.1)) {
        Entry *point = add(v, POINT, "point");
        say_three(v, point, "", u, reflected, v->part[v->part_now].at);
        say(entry, "%s%s", lead, point->name);
    } else {
        say_three(v, entry, lead, u, reflected, v->part[v->part_now].at);
    }
}

void say_direction(Vehicle *v, Entry *entry, const char *lead, Vec u)
{
    say_three(v, entry, lead, u, reflected, zero);
}

void say_turning(Vehicle *v, Entry *entry, const char *lead, Vec u)
{
    say_three(v, entry, lead, u, turned, zero);
}

void say_vector(Vehicle *v, Entry *entry, const char *lead, Vec u)
{
    say_three(v, entry, lead, u, same, zero);
}

/* Where no parameter may stand: `count` numbers, in an image times `sign`. */
static void say_fixed(Vehicle *v, Entry *entry, int digits, const double *x, const double *sign, int count)
{
    for (int i = 0; i < count; ++i) {
        append(entry->text, sizeof entry->text, "%s%.*g", i ? ", " : "[", digits, x[i]);
        append(entry->plain, sizeof entry->plain, "%s%.*g", i ? ", " : "[", digits, (v->image ? sign[i] : 1) * x[i]);
    }
    say(entry, "]");
}

const char *body_name(const Vehicle *v, int body)
{
    return body == NOTHING ? "ground" : v->section[BODY].entry[body].name;
}

void culprit(Vehicle *v, const char *name)
{
    append(v->culprits, sizeof v->culprits, "%s%s", *v->culprits ? " " : "", name);
}

void culprit_bodies(Vehicle *v, const Entry *entry)
{
    for (int side = 0; side < 2; ++side)
        if (entry->end[side] > BASE)
            culprit(v, body_name(v, entry->end[side]));
}

/* ---- bodies ---- */

/* Random Euler parameters and their rotation matrix. */
static void any_rotation(Vehicle *v, double p[4], double A[3][3])
{
    double size;
    do {
        size = 0;
        for (int i = 0; i < 4; ++i) {
            p[i] = uniform(v, -1, 1);
            size += p[i] * p[i];
        }
    } while (size > 1 || size < 0.1);
    for (int i = 0; i < 4; ++i)
        p[i] /= sqrt(size);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        A[i][i] = 2 * (p[0] * p[0] + p[1 + i] * p[1 + i]) - 1;
        A[i][j] = 2 * (p[1 + i] * p[1 + j] - p[0] * p[1 + k]);
        A[i][k] = 2 * (p[1 + i] * p[1 + k] + p[0] * p[1 + j]);
    }
}

static void say_orientation(Vehicle *v, Entry *body)
{
    double p[4], A[3][3];
    any_rotation(v, p, A);
    static const double euler[] = {1, -1, 1, -1};
    switch (pick(v, 4)) {
    case 0:
        say(body, ", orientation: {euler: ");
        say_fixed(v, body, 17, p, euler, 4);
        say(body, "}");
        break;
    case 1:
        say(body, ", orientation: {axis: ");
        say_fixed(v, body, 6, p + 1, turned.x, 3);
        say(body, ", angle: %.6g}", uniform(v, -3, 3));
        break;
    case 2: {
        Vec x = near_to(v, 0.5, 0.5, 0.5, 0.45);
        say(body, ", orientation: {x: ");
        say_fixed(v, body, 9, x.x, reflected.x, 3);
        say(body, ", z: ");
        say_fixed(v, body, 9, across(v, x).x, reflected.x, 3);
        say(body, "}");
        break;
    }
    }
}

static int body_with(Vehicle *v, const char *prefix, Vec com, double mass, double size, double spin)
{
    Entry *body = add(v, BODY, prefix);
    double p[4], A[3][3], half[3], J[3][3] = {{0}};
    any_rotation(v, p, A);
    mass *= uniform(v, 0.7, 1.4);
    for (int i = 0; i < 3; ++i)
        half[i] = size * uniform(v, 0.5, 1.5);
    for (int k = 0; k < 3; ++k) {
        double principal = mass / 5 * (half[(k + 1) % 3] * half[(k + 1) % 3] + half[(k + 2) % 3] * half[(k + 2) % 3]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                J[i][j] += principal * A[i][k] * A[j][k] + (k == i && k == j ? spin : 0);
    }
    say_number(v, body, "mass: ", mass);
    say_point(v, body, ", com: ", com);
    say(body, ", inertia: {xx: ");
    static const char *const name[] = {"", ", yy: ", ", zz: ", ", xy: ", ", xz: ", ", yz: "};
    static const double sign[] = {1, 1, 1, -1, 1, -1};
    const double element[] = {J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2]};
    for (int i = 0; i < 6; ++i) {
        say(body, "%s", name[i]);
        append(body->text, sizeof body->text, "%.9g", element[i]);
        append(body->plain, sizeof body->plain, "%.9g", (v->image ? sign[i] : 1) * element[i]);
    }
    say(body, "}");
    if (chance(v, 0.7))
        say_point(v, body, ", position: ", near_to(v, com.x[0], com.x[1], com.x[2], 0.2));
    say_orientation(v, body);
    return v->section[BODY].count - 1;
}

int add_body(Vehicle *v, const char *prefix, Vec com, double mass, double size)
{
    return body_with(v, prefix, com, mass, size, 0);
}

int add_carrier(Vehicle *v, const char *prefix, Vec com, double mass, double size)
{
    return body_with(v, prefix, com, mass, size, 2 * v->spin);
}

/* ---- joints ---- */

void say_connection(Vehicle *v, Entry *entry, const char *type, int a, int b, const Geometry *with)
{
    bool swap = !with->ordered && chance(v, 0.5);
    entry->end[0] = a;
    entry->end[1] = b;
    say(entry, "type: %s, bodies: [%s, %s]", type, body_name(v, swap ? b : a), body_name(v, swap ? a : b));
    if (with->point)
        say_point(v, entry, ", point: ", *with->point);
    if (with->points[0]) {
        say_point(v, entry, ", points: [", *with->points[swap]);
        say_point(v, entry, ", ", *with->points[!swap]);
        say(entry, "]");
    }
    if (with->axis && !strcmp(type, "angle"))
        say_turning(v, entry, ", axis: ", *with->axis);
    else if (with->axis)
        say_direction(v, entry, ", axis: ", *with->axis);
    if (with->axes[0]) {
        say_direction(v, entry, ", axes: [", *with->axes[swap]);
        say_direction(v, entry, ", ", *with->axes[!swap]);
        say(entry, "]");
    }
}

Entry *join(Vehicle *v, const char *prefix, const char *type, int a, int b, const Geometry *with)
{
    Entry *joint = add(v, JOINT, prefix);
    say_connection(v, joint, type, a, b, with);
    return joint;
}

Entry *hinge(Vehicle *v, int a, int b, Vec p, Vec u)
{
    Entry *first;
    if (chance(v, 0.15)) {
        Vec near = combine(1, u, 0.05 * norm(u), near_to(v, 0, 0, 0, 1));
        element(v, a, b, &(Geometry){.axis = &near}, 500);
    }
    switch (chance(v, 0.7) ? 0 : 1 + pick(v, 2)) {
    case 1:
        first = join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
        join(v, "stop", "point_in_plane", a, b, &(Geometry){.point = &p, .axis = &u});
        return first;
    case 2:
        first = join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        join(v, "same", "parallel", a, b, &(Geometry){.axis = &u});
        return first;
    default: return join(v, "hinge", "revolute", a, b, &(Geometry){.point = &p, .axis = &u});
    }
}

Entry *guide(Vehicle *v, int a, int b, Vec p, Vec u, bool plain)
{
    if (plain || chance(v, 0.7))
        return join(v, "guide", "prismatic", a, b, &(Geometry){.point = chance(v, 0.5) ? &p : NULL, .axis = &u});
    Vec s = across(v, u), t = cross(u, s);
    Entry *first = join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
    join(v, "key", "perpendicular", a, b, &(Geometry){.axes = {&s, &t}});
    return first;
}

void weld(Vehicle *v, int a, int b, Vec p)
{
    if (chance(v, 0.7)) {
        join(v, "weld", "fixed", a, b, &(Geometry){.point = chance(v, 0.5) ? &p : NULL});
        return;
    }
    Vec u = near_to(v, 0.5, 0.5, 0.5, 0.45), s = across(v, u), t = cross(u, s);
    hinge(v, a, b, p, u);
    join(v, "key", "perpendicular", a, b, &(Geometry){.axes = {&s, &t}});
}

Entry *ball(Vehicle *v, int a, int b, Vec p)
{
    return join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
}

Entry *rod(Vehicle *v, int a, int b, Vec p_a, Vec p_b)
{
    Entry *joint = join(v, "rod", "distance", a, b, &(Geometry){.points = {&p_a, &p_b}});
    if (chance(v, 0.1))
        say_number(v, joint, ", length: ", norm(combine(1, p_a, -1, p_b)) * uniform(v, 0.985, 1.015));
    return joint;
}

/* ---- coordinates ---- */

const char *add_table(Vehicle *v, double width, double force)
{
    Entry *table = add(v, TABLE, "curve");
    say(table, "x: [%.6g, %.6g, 0, %.6g, %.6g]", -width, -0.4 * width, 0.3 * width, width);
    say(table, ", y: [%.6g, %.6g, 0, %.6g, %.6g]", -force, -0.6 * force, 0.1 * force, force);
    say(table, ", interpolation: %s", chance(v, 0.5) ? "cubic" : "linear");
    say(table, ", beyond: %s", chance(v, 0.5) ? "constant" : "linear");
    return table->name;
}

static void begin_law(Entry *force, const char *type, const Entry *place)
{
    say(force, "type: %s, ", type);
    append(force->text, sizeof force->text, "%s", place->text);
    append(force->plain, sizeof force->plain, "%s", place->plain);
}

/* Laws of all kinds behind where an element acts: `x` and `rate` are what formulas call its value, which is `design` in
 * the drawing and moves by `reach`. */
static void say_law(Vehicle *v, Entry *force, const Entry *place, const char *x, const char *rate, double design,
                    double reach, double stiffness)
{
    double strength = stiffness * reach;
    switch (pick(v, 5)) {
    case 0:
        begin_law(force, "force", place);
        say(force, ", value: \"%.4g * (%s - %.6g)", -0.1 * stiffness, x, design);
        say(force, " - %.4g * tanh(10 * %s) + %s(%s)\"", 0.1 * strength, rate, add_table(v, 1, 0.1 * strength), rate);
        break;
    case 1:
        begin_law(force, "stop", place);
        say_number(v, force, ", low: ", design - reach * uniform(v, 0.1, 0.9));
        if (chance(v, 0.6))
            say_number(v, force, ", high: ", design + reach * uniform(v, 0.1, 0.9));
        say_number(v, force, ", stiffness: ", stiffness * uniform(v, 0.5, 2));
        say_number(v, force, ", damping: ", stiffness * uniform(v, 0, 0.05));
        if (chance(v, 0.5))
            say_number(v, force, ", fade: ", reach * uniform(v, 0.1, 0.5));
        break;
    case 2:
        begin_law(force, "stop", place);
        say_number(v, force, ", high: ", design + reach * uniform(v, -0.5, 0.5));
        say(force, ", table: %s, fade: %.4g", add_table(v, reach, strength), 0.3 * reach);
        break;
    case 3:
        begin_law(force, "spring_damper", place);
        say(force, ", table: %s", add_table(v, reach, strength));
        say_number(v, force, ", free: ", design + reach * uniform(v, -1, 1));
        break;
    default:
        begin_law(force, "spring_damper", place);
        say_number(v, force, ", stiffness: ", stiffness * uniform(v, 0, 1));
        say_number(v, force, ", damping: ", stiffness * uniform(v, 0, 0.1));
    }
}

void element(Vehicle *v, int a, int b, const Geometry *with, double stiffness)
{
    Entry *force = add(v, FORCE, "element"), *place = grab(1, sizeof *place);
    say(place, "bodies: [%s, %s]", body_name(v, a), body_name(v, b));
    if (with->axis) {
        say_turning(v, place, ", axis: ", *with->axis);
        say_law(v, force, place, "angle", "speed", 0, 0.2, stiffness);
    } else {
        say_point(v, place, ", points: [", *with->points[0]);
        say_point(v, place, ", ", *with->points[1]);
        say(place, "]");
        say_law(v, force, place, "length", "speed", norm(combine(1, *with->points[0], -1, *with->points[1])), 0.02,
                stiffness);
    }
    free(place);
}

static void add_spring(Vehicle *v, int coordinate, double stiffness, double free)
{
    Entry *force = add(v, FORCE, "force");
    force->coordinate = coordinate;
    const char *name = v->section[COORDINATE].entry[coordinate].name;
    if (chance(v, 0.1)) {
        say(force, "type: force, coordinate: %s, value: %.4g", name, uniform(v, -0.02, 0.02) * stiffness);
        return;
    }
    say(force, "type: spring_damper, coordinate: %s", name);
    say_number(v, force, ", stiffness: ", stiffness * uniform(v, 0.5, 2));
    say_number(v, force, ", damping: ", stiffness * uniform(v, 0, 0.1));
    say_number(v, force, ", free: ", free);
}

/* One more element along a coordinate. */
static void add_law(Vehicle *v, int coordinate, double design, double reach, double stiffness)
{
    Entry *force = add(v, FORCE, "law");
    force->coordinate = coordinate;
    const char *name = v->section[COORDINATE].entry[coordinate].name;
    char rate[48] = "";
    Entry *place = grab(1, sizeof *place);
    say(place, "coordinate: %s", name);
    append(rate, sizeof rate, "rate(%s)", name);
    say_law(v, force, place, name, rate, design, reach, stiffness);
    free(place);
}

Entry *coordinate(Vehicle *v, const char *prefix, const char *type, int a, int b, const Geometry *with, double reach,
                  double stiffness, bool may_drive)
{
    Entry *entry = add(v, COORDINATE, prefix);
    int index = v->section[COORDINATE].count - 1;
    bool length = !strcmp(type, "length");
    double design = length ? norm(combine(1, *with->points[0], -1, *with->points[1])) : 0;
    say_connection(v, entry, type, a, b, with);
    if (!length && chance(v, 0.3)) {
        design = round(100 * uniform(v, -1, 1)) / 100;
        say(entry, ", design: %.9g", design);
    }
    say(entry, ", range: [%.9g, ", design - reach * uniform(v, 0.7, 1.2));
    say(entry, "%.9g]", design + reach * uniform(v, 0.7, 1.2));
    if (chance(v, 0.2))
        say(entry, ", initial: %.9g", design + reach * uniform(v, -0.5, 0.5));
    /* the first one is free, and its image too */
    if (may_drive && index > (v->image ? v->left_count[COORDINATE] : 0) && chance(v, 0.4))
        say(entry, ", driven: true");
    if (stiffness > 0 && chance(v, 0.9))
        add_spring(v, index, stiffness, design + reach * uniform(v, -1, 1));
    if (stiffness > 0 && chance(v, 0.25))
        add_law(v, index, design, reach, stiffness);
    return entry;
}
