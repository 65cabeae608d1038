/* SPDX-License-Identifier: MIT
 * random_vehicle --seed S [--broken | --mechanism | --rich FOLDER --tire FILE]
 *
 * Prints a random vehicle in the format of models/FORMAT.md: bodies that hold suspensions, drawn from a grammar of
 * axles and corners, each of which brings as many equations and coordinates as its bodies have freedoms. Equal seeds
 * give equal vehicles.
 *
 * With --broken one mistake is made: the format stays valid, the mechanism does not. The first line of stderr names
 * the culprits, bodies, joints and coordinates of which an error message must name at least one.
 *
 * With --mechanism it is none, but a few bodies in trees and loops of any joints and coordinates, with numbers such as
 * people write as often as general ones.
 *
 * With --rich it has tires, a powertrain, formulas and inputs too, left sides of which the reader makes the right ones,
 * and axles in files that it includes: FOLDER/S.veh and what that includes, a tire like that of the .tir FILE, and
 * FOLDER/S.plain.veh, in which everything is written out. */
#include "random/vehicle.h"
#include "reference/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "usage: random_vehicle --seed S [--broken | --mechanism | --rich FOLDER --tire FILE]\n";

/* What holds up an arm that turns about u through p: the angle, or a spring to `foot` on the arm from `seat`. */
static void suspend(Vehicle *v, int carrier, int arm, Vec p, Vec u, Vec seat, Vec foot)
{
    if (v->mistake == SPRING_THROUGH_HINGE) {
        v->mistake = NO_MISTAKE;
        foot = combine(2, p, -1, seat);
        Entry *entry =
            coordinate(v, "spring", "length", carrier, arm, &(Geometry){.points = {&seat, &foot}}, 0.02, 40000, false);
        culprit(v, entry->name);
        culprit_bodies(v, entry);
    } else if (chance(v, 0.35)) {
        coordinate(v, "bar", "angle", carrier, arm, &(Geometry){.axis = &u}, 0.2, 8000, false);
    } else {
        coordinate(v, "spring", "length", carrier, arm, &(Geometry){.points = {&seat, &foot}}, 0.025, 40000, false);
    }
}

/* ---- what holds a corner ---- */

/* A body between the base and an axle: on a hinge, a guide, or on primitives that leave it to turn and slide. */
static int add_frame(Vehicle *v, int carrier, double x)
{
    Vec com = point(v, x, 0, 0.45), p = point(v, x, 0.05, 0.5);
    int frame = add_body(v, "frame", com, 60, 0.4);
    bool twice = v->mistake == PARALLEL_TWICE;
    switch (twice ? 2 : pick(v, 4)) {
    case 0: {
        Vec u = direction(v, 1, 0, 0);
        hinge(v, carrier, frame, p, u);
        coordinate(v, "roll", "angle", carrier, frame, &(Geometry){.axis = &u}, 0.1, 60000, false);
        break;
    }
    case 1: {
        Vec u = direction(v, 0.2, 0, 1);
        guide(v, carrier, frame, p, u, false);
        coordinate(v, "lift", "translation", carrier, frame, &(Geometry){.axis = &u}, 0.03, 300000, true);
        break;
    }
    case 2: {
        Vec u = direction(v, 0, 1, 0);
        Entry *same = join(v, "same", "parallel", carrier, frame, &(Geometry){.axis = &u});
        join(v, "line", "point_on_line", carrier, frame, &(Geometry){.point = &p, .axis = &u});
        if (twice) {
            v->mistake = NO_MISTAKE;
            culprit(v, same->name);
            culprit(v, join(v, "same", "parallel", carrier, frame, &(Geometry){.axis = &u})->name);
            culprit(v, body_name(v, frame));
            break;
        }
        coordinate(v, "pitch", "angle", carrier, frame, &(Geometry){.axis = &u}, 0.1, 60000, false);
        if (chance(v, 0.5))
            coordinate(v, "shift", "translation", carrier, frame, &(Geometry){.points = {&p, &p}, .axis = &u}, 0.03,
                       300000, false);
        else
            join(v, "cam", "point_in_plane", carrier, frame,
                 &(Geometry){.point = &com, .axis = &(Vec){{0.2, 1, uniform(v, -0.3, 0.3)}}});
        break;
    }
    default: {
        Vec s = direction(v, 1, 0, 0), t = cross(s, direction(v, 0, 0, 1));
        join(v, "cross", "universal", carrier, frame, &(Geometry){.point = &p, .axes = {&s, &t}});
        for (int side = -1; side <= 1; side += 2) {
            Vec seat = point(v, x + 0.4, 0.45 * side, 0.9), foot = point(v, x + 0.35, 0.4 * side, 0.5);
            coordinate(v, "mount", "length", carrier, frame, &(Geometry){.points = {&seat, &foot}}, 0.02, 300000,
                       false);
        }
    }
    }
    return frame;
}

/* The bodies that the tie rods of the left and right corner begin at. */
typedef struct Steering {
    int body[2];
} Steering;

static int pitman(Vehicle *v, int carrier, double x, double side, Vec axis)
{
    int arm = add_body(v, "pitman", point(v, x - 0.25, 0.3 * side, 0.33), 3, 0.15);
    hinge(v, carrier, arm, point(v, x - 0.38, 0.35 * side, 0.33), axis);
    return arm;
}

static Steering add_steering(Vehicle *v, int carrier, double x)
{
    bool twice = v->mistake == PRISMATIC_TWICE;
    Vec y = direction(v, 0, 1, 0), z = direction(v, 0, 0, 1), middle = point(v, x - 0.15, 0, 0.33);
    int kind = twice ? 0 : pick(v, 4);
    if (kind == 3)
        return (Steering){{carrier, carrier}};
    if (kind == 0) {
        int rack = add_body(v, "rack", middle, 8, 0.3);
        Entry *first = guide(v, carrier, rack, middle, y, twice);
        if (twice) {
            v->mistake = NO_MISTAKE;
            culprit(v, first->name);
            culprit(v, guide(v, carrier, rack, middle, y, true)->name);
            culprit(v, body_name(v, rack));
        }
        coordinate(v, "rack", "translation", carrier, rack, &(Geometry){.axis = &y}, 0.03, 60000, true);
        return (Steering){{rack, rack}};
    }
    /* two arms, and between them a massless link or a body */
    int left = pitman(v, carrier, x, 1, z), right = pitman(v, carrier, x, -1, direction(v, 0, 0, 1));
    Vec end[2] = {point(v, x - 0.16, 0.3, 0.33), point(v, x - 0.16, -0.3, 0.33)};
    if (kind == 1) {
        rod(v, left, right, end[0], end[1]);
    } else {
        int relay = add_body(v, "relay", point(v, x - 0.16, 0, 0.33), 4, 0.2);
        Vec s = direction(v, 0, 0, 1), t = cross(s, y);
        ball(v, left, relay, end[0]);
        join(v, "cross", "universal", right, relay, &(Geometry){.point = &end[1], .axes = {&s, &t}});
    }
    coordinate(v, "steer", "angle", carrier, left, &(Geometry){.axis = &z}, 0.12, 8000, true);
    return (Steering){{left, right}};
}

/* ---- corners: each ends in the body that carries the wheel ---- */

typedef struct Place {
    int carrier, steering; /* bodies that links and tie rods begin at */
    double x, side;        /* of the axle; 1 left, -1 right */
} Place;

static Vec at(Vehicle *v, const Place *place, double dx, double y, double z)
{
    return point(v, place->x + dx, y * place->side, z);
}

static int add_knuckle(Vehicle *v, const Place *place)
{
    return add_carrier(v, "knuckle", at(v, place, 0, 0.72, 0.34), 40, 0.2);
}

/* An arm on a hinge, held up directly or through a rocker that it pushes. */
static int add_arm(Vehicle *v, const Place *place)
{
    int arm = add_body(v, "arm", at(v, place, 0, 0.5, 0.27), 10, 0.2), carrier = place->carrier;
    Vec p = at(v, place, 0, 0.33, 0.3), u = direction(v, 1, 0, 0), foot = at(v, place, 0.02, 0.55, 0.28);
    hinge(v, carrier, arm, p, u);
    if (v->mistake != SPRING_THROUGH_HINGE && chance(v, 0.25)) {
        int rocker = add_body(v, "rocker", at(v, place, 0, 0.32, 0.67), 2, 0.1);
        Vec pivot = at(v, place, 0, 0.3, 0.65), r = direction(v, 1, 0, 0);
        hinge(v, carrier, rocker, pivot, r);
        rod(v, rocker, arm, at(v, place, 0.02, 0.42, 0.68), foot);
        suspend(v, carrier, rocker, pivot, r, at(v, place, 0, 0.1, 0.75), at(v, place, 0, 0.28, 0.8));
    } else {
        suspend(v, carrier, arm, p, u, at(v, place, 0.03, 0.45, 0.75), foot);
    }
    if (chance(v, 0.15)) {
        int bar = add_body(v, "roll_bar", at(v, place, -0.2, 0.45, 0.41), 3, 0.15);
        hinge(v, carrier, bar, at(v, place, -0.3, 0.35, 0.4), direction(v, 0, 1, 0));
        rod(v, bar, arm, at(v, place, -0.05, 0.5, 0.42), at(v, place, -0.05, 0.52, 0.27));
    }
    return arm;
}

/* The knuckle turns about the line between two balls; the tie rod holds it. */
static void tie_knuckle(Vehicle *v, const Place *place, int knuckle, Vec low, Vec high)
{
    Vec end = at(v, place, -0.14, 0.66, 0.34);
    bool on_kingpin = v->mistake == TIE_ROD_ON_KINGPIN;
    if (on_kingpin)
        end = combine(0.5, low, 0.5, high);
    Vec start = at(v, place, -0.15, 0.36, 0.32);
    if (!on_kingpin) {
        rod(v, place->steering, knuckle, start, end);
        return;
    }
    v->mistake = NO_MISTAKE;
    culprit(v, join(v, "rod", "distance", place->steering, knuckle, &(Geometry){.points = {&start, &end}})->name);
    culprit(v, body_name(v, knuckle));
}

static int wishbones(Vehicle *v, const Place *place)
{
    int arm = add_arm(v, place), knuckle = add_knuckle(v, place);
    Vec low = at(v, place, 0, 0.68, 0.24), high = at(v, place, -0.02, 0.62, 0.62), in = at(v, place, -0.01, 0.38, 0.58),
        u = direction(v, 1, 0, 0);
    ball(v, arm, knuckle, low);
    if (chance(v, 0.5)) {
        join(v, "link", "revolute_spherical", place->carrier, knuckle,
             &(Geometry){.points = {&in, &high}, .axis = &u, .ordered = true});
    } else {
        int upper = add_body(v, "upper", at(v, place, 0, 0.5, 0.6), 6, 0.15);
        hinge(v, place->carrier, upper, in, u);
        ball(v, upper, knuckle, high);
    }
    tie_knuckle(v, place, knuckle, low, high);
    return knuckle;
}

static int strut(Vehicle *v, const Place *place)
{
    int arm = add_arm(v, place), knuckle = add_knuckle(v, place);
    int damper = add_body(v, "strut", at(v, place, -0.04, 0.58, 0.7), 5, 0.15);
    Vec low = at(v, place, 0, 0.68, 0.24), seat = at(v, place, -0.01, 0.62, 0.45),
        top = at(v, place, -0.05, 0.55, 0.85), u = combine(1, top, -1, seat), s = across(v, u), t = cross(u, s);
    ball(v, arm, knuckle, low);
    if (chance(v, 0.5)) {
        guide(v, knuckle, damper, seat, u, false);
        ball(v, damper, place->carrier, top);
    } else {
        join(v, "sleeve", "cylindrical", knuckle, damper, &(Geometry){.point = &seat, .axis = &u});
        join(v, "cross", "universal", place->carrier, damper, &(Geometry){.point = &top, .axes = {&s, &t}});
    }
    tie_knuckle(v, place, knuckle, low, top);
    return knuckle;
}

static int trailing_arm(Vehicle *v, const Place *place)
{
    int arm = add_carrier(v, "trailing", at(v, place, 0.1, 0.6, 0.35), 30, 0.25);
    Vec p = at(v, place, 0.45, 0.45, 0.35), u = direction(v, 0, 1, 0);
    hinge(v, place->carrier, arm, p, u);
    suspend(v, place->carrier, arm, p, u, at(v, place, 0.15, 0.5, 0.75), at(v, place, 0.15, 0.52, 0.35));
    return arm;
}

static int swing_axle(Vehicle *v, const Place *place)
{
    int arm = add_carrier(v, "swing", at(v, place, 0, 0.5, 0.34), 30, 0.25);
    Vec p = at(v, place, 0, 0.2, 0.35), u = direction(v, 1, 0, 0);
    hinge(v, place->carrier, arm, p, u);
    suspend(v, place->carrier, arm, p, u, at(v, place, 0.05, 0.4, 0.75), at(v, place, 0.05, 0.5, 0.35));
    return arm;
}

static int five_links(Vehicle *v, const Place *place)
{
    static const double in[5][3] = {
        {0.3, 0.35, 0.25}, {-0.35, 0.35, 0.27}, {0.25, 0.4, 0.55}, {-0.2, 0.42, 0.57}, {-0.25, 0.37, 0.35}};
    static const double out[5][3] = {
        {0.05, 0.68, 0.22}, {-0.06, 0.68, 0.23}, {0.03, 0.64, 0.58}, {-0.04, 0.63, 0.6}, {-0.16, 0.66, 0.36}};
    int knuckle = add_knuckle(v, place);
    for (int i = 0; i < 5; ++i)
        rod(v, i == 4 ? place->steering : place->carrier, knuckle, at(v, place, in[i][0], in[i][1], in[i][2]),
            at(v, place, out[i][0], out[i][1], out[i][2]));
    Vec seat = at(v, place, 0.03, 0.5, 0.85), foot = at(v, place, 0.02, 0.64, 0.3);
    coordinate(v, "spring", "length", place->carrier, knuckle, &(Geometry){.points = {&seat, &foot}}, 0.03, 40000,
               false);
    return knuckle;
}

/* A shaft from the carrier to the wheel's carrier, free to become longer. */
static void add_shaft(Vehicle *v, const Place *place, int knuckle)
{
    Vec in = at(v, place, 0, 0.2, 0.38), out = at(v, place, 0, 0.62, 0.35), u = combine(1, out, -1, in),
        s = across(v, u), t = cross(u, s);
    int shaft = add_body(v, "shaft", combine(0.5, in, 0.5, out), 6, 0.15);
    if (chance(v, 0.5)) {
        join(v, "cross", "universal", place->carrier, shaft, &(Geometry){.point = &in, .axes = {&s, &t}});
        join(v, "line", "point_on_line", shaft, knuckle, &(Geometry){.point = &out, .axis = &u, .ordered = true});
    } else {
        ball(v, knuckle, shaft, out);
        join(v, "line", "point_on_line", shaft, place->carrier, &(Geometry){.point = &in, .axis = &u, .ordered = true});
        join(v, "key", "perpendicular", knuckle, shaft, &(Geometry){.axes = {&s, &t}});
    }
}

static void add_wheel(Vehicle *v, const Place *place, int carrier)
{
    Vec center = at(v, place, 0, 0.78, 0.32);
    double choice = uniform(v, 0, 1);
    if (choice < 0.35) {
        int hub = add_carrier(v, "hub", center, 20, 0.25);
        Vec u = direction(v, 0, 1, 0);
        if (choice < 0.15) {
            weld(v, carrier, hub, center);
        } else {
            hinge(v, carrier, hub, center, u);
            coordinate(v, "spin", "angle", carrier, hub, &(Geometry){.axis = &u}, 2, 0, true);
        }
        carrier = hub;
    }
    Entry *wheel = add(v, WHEEL, "wheel");
    say(wheel, "body: %s", body_name(v, carrier));
    say_point(v, wheel, ", center: ", center);
    if (v->tired && chance(v, 0.85)) {
        say_rolling(v, wheel, carrier);
        return;
    }
    say_number(v, wheel, ", radius: ", uniform(v, 0.3, 0.36));
    say_number(v, wheel, ", stiffness: ", uniform(v, 1e5, 3e5));
    say_number(v, wheel, ", damping: ", uniform(v, 0, 800));
}

static void add_corner(Vehicle *v, const Place *place)
{
    int kind = pick(v, v->mistake == TIE_ROD_ON_KINGPIN ? 2 : v->mistake == SPRING_THROUGH_HINGE ? 4 : 5), carrier;
    switch (kind) {
    case 0: carrier = wishbones(v, place); break;
    case 1: carrier = strut(v, place); break;
    case 2: carrier = trailing_arm(v, place); break;
    case 3: carrier = swing_axle(v, place); break;
    default: carrier = five_links(v, place);
    }
    if (chance(v, 0.2))
        add_shaft(v, place, carrier);
    add_wheel(v, place, carrier);
}

/* ---- axles ---- */

/* Two lower links, and two upper ones or one with a track bar. */
static void solid_axle(Vehicle *v, int carrier, double x)
{
    double ahead = chance(v, 0.5) ? 0.6 : -0.6;
    int axle = add_carrier(v, "axle", point(v, x, 0, 0.36), 120, 0.4);
    bool track_bar = chance(v, 0.5);
    for (int side = -1; side <= 1; side += 2) {
        Place place = {carrier, carrier, x, side};
        Vec seat = at(v, &place, 0.02, 0.48, 0.75), foot = at(v, &place, 0, 0.52, 0.4);
        rod(v, carrier, axle, at(v, &place, ahead, 0.45, 0.35), at(v, &place, 0, 0.5, 0.27));
        if (!track_bar)
            rod(v, carrier, axle, at(v, &place, 0.8 * ahead, 0.45, 0.53), at(v, &place, 0, 0.12, 0.56));
        coordinate(v, "spring", "length", carrier, axle, &(Geometry){.points = {&seat, &foot}}, 0.03, 40000, false);
        add_wheel(v, &place, axle);
    }
    if (track_bar) {
        rod(v, carrier, axle, point(v, x + 0.8 * ahead, 0.05, 0.55), point(v, x, 0.03, 0.57));
        rod(v, carrier, axle, point(v, x - 0.1, -0.45, 0.45), point(v, x - 0.08, 0.45, 0.41));
    }
}

/* A planar linkage somewhere on a carrier, closed by a point on a line. */
static void four_bar(Vehicle *v, int carrier)
{
    Vec u = direction(v, 0, 1, 0),
        p[4] = {point(v, 0, 0.2, 1), point(v, 0.02, 0.2, 1.2), point(v, 0.4, 0.2, 1.3), point(v, 0.45, 0.2, 1)};
    int crank = add_body(v, "crank", combine(0.5, p[0], 0.5, p[1]), 2, 0.1),
        coupler = add_body(v, "coupler", combine(0.5, p[1], 0.5, p[2]), 3, 0.15),
        rocker = add_body(v, "rocker", combine(0.5, p[2], 0.5, p[3]), 3, 0.1);
    join(v, "hinge", "revolute", carrier, crank, &(Geometry){.point = &p[0], .axis = &u});
    join(v, "hinge", "revolute", crank, coupler, &(Geometry){.point = &p[1], .axis = &u});
    join(v, "hinge", "revolute", carrier, rocker, &(Geometry){.point = &p[3], .axis = &u});
    join(v, "line", "point_on_line", coupler, rocker, &(Geometry){.point = &p[2], .axis = &u});
    coordinate(v, "crank", "angle", carrier, crank, &(Geometry){.axis = &u}, 0.3, 50, true);
}

/* What comes next goes into a file of its own, somewhere else and with a prefix, or neither. */
static void begin_part(Vehicle *v)
{
    Part *part = &v->part[v->part_now = ++v->parts];
    snprintf(part->name, sizeof part->name, "p%d_", v->parts);
    part->has_prefix = chance(v, 0.6);
    if (chance(v, 0.6))
        part->at = near_to(v, 0, 0, 0, 2);
}

static void add_axle(Vehicle *v, double x)
{
    int carrier = BASE;
    bool wants_frame = v->mistake == PARALLEL_TWICE;
    if (v->rich && v->parts < PARTS && chance(v, 0.5))
        begin_part(v);
    for (double probability = wants_frame ? 1 : 0.35; chance(v, probability); probability = 0.3)
        carrier = add_frame(v, carrier, x);
    bool wants_corner = v->mistake == TIE_ROD_ON_KINGPIN || v->mistake == SPRING_THROUGH_HINGE;
    if (!wants_corner && v->mistake != PRISMATIC_TWICE && chance(v, 0.2)) {
        solid_axle(v, carrier, x);
        v->part_now = 0;
        return;
    }
    Steering steering = {{carrier, carrier}};
    if (v->mistake == PRISMATIC_TWICE || chance(v, 0.6))
        steering = add_steering(v, carrier, x);
    if (v->rich && steering.body[0] == steering.body[1] && chance(v, 0.6)) {
        Mirror mirror;
        const Place left = {carrier, steering.body[0], x, 1};
        begin_left(v, &mirror);
        add_corner(v, &left);
        begin_right(v, &mirror);
        add_corner(v, &left);
        end_mirror(v, &mirror);
    } else {
        for (int i = 0; i < 2; ++i)
            add_corner(v, &(Place){carrier, steering.body[i], x, i ? -1 : 1});
    }
    v->part_now = 0;
}

/* ---- the whole vehicle ---- */

/* Between any two bodies. */
static void add_element(Vehicle *v)
{
    int count = v->section[BODY].count, b = BASE + 1 + pick(v, count - 1), a = pick(v, b + 1) - 1;
    Vec end = {{0.8, uniform(v, -1, 1), 0.9}};
    element(v, a, b, &(Geometry){.points = {&(Vec){{0.1, 0.2, 0.3}}, &end}}, 5000);
}

/* A force and a torque on a body, in the frame of another or of the world. */
static void add_load(Vehicle *v)
{
    int body = BASE + 1 + pick(v, v->section[BODY].count - 1), in = pick(v, body + 1);
    Entry *force = add(v, FORCE, "load");
    say(force, "type: load, body: %s, in: %s", body_name(v, body), in == BASE ? "world" : body_name(v, in));
    say_point(v, force, ", point: ", point(v, 0, 0, 0.5));
    say_vector(v, force, ", force: ", near_to(v, 0, 0, 0, 200));
    say_vector(v, force, ", torque: ", near_to(v, 0, 0, 0, 50));
}

/* Forces that are formulas of anything. */
static void add_formulas(Vehicle *v)
{
    for (int i = pick(v, 4); i > 0; --i) {
        Entry *force = add(v, FORCE, "formula");
        const Entry *along = &v->section[COORDINATE].entry[pick(v, v->section[COORDINATE].count)];
        say(force, "type: force, coordinate: %s, value: \"%.4g * (", along->name, uniform(v, 10, 300));
        say_any_formula(v, force, 3);
        say(force, ")\"");
    }
    if (chance(v, 0.5)) {
        int body = BASE + 1 + pick(v, v->section[BODY].count - 1), in = pick(v, body + 1);
        Entry *load = add(v, FORCE, "load");
        say(load, "type: load, body: %s, in: %s", body_name(v, body), in == BASE ? "world" : body_name(v, in));
        for (int part = chance(v, 0.5); part < 2; ++part)
            for (int i = 0; i < 3; ++i) {
                say(load, i ? "\", \"" : part ? ", torque: [\"" : ", force: [\"");
                say(load, "%.4g * (", uniform(v, -50, 50));
                say_any_formula(v, load, 1);
                say(load, i < 2 ? ")" : ")\"]");
            }
    }
}

static void add_outputs(Vehicle *v)
{
    static const char *const type[] = {"position",    "velocity",       "acceleration",
                                       "orientation", "roll_pitch_yaw", "angular_velocity"};
    for (int i = 0; i < 4; ++i) {
        int body = (v->fixed ? 1 : 0) + pick(v, v->section[BODY].count - (v->fixed ? 1 : 0));
        say(add(v, OUTPUT, "out"), "type: %s, body: %s", type[pick(v, 6)], body_name(v, body));
    }
    for (int i = 0; i < v->section[COORDINATE].count; ++i)
        if (!v->section[COORDINATE].entry[i].dropped && chance(v, 0.3))
            say(add(v, OUTPUT, "out"), "type: coordinate, coordinate: %s", v->section[COORDINATE].entry[i].name);
    say(add(v, OUTPUT, "out"), "type: energy");
}

static void build(Vehicle *v)
{
    static const double x[] = {1.4, -1.4, -2.4};
    v->fixed = chance(v, 0.15);
    v->tuned = chance(v, 0.3);
    if (v->rich) {
        add_gains(v);
        v->tired = chance(v, 0.7);
        v->driven = v->tired && chance(v, 0.5);
        v->spin = uniform(v, 0.1, 2);
        if (v->tired)
            add_tires(v);
    }
    Vec com = point(v, 0, 0, 0.6);
    int base = add_body(v, "chassis", com, 1500, 0.9), axles = 1 + pick(v, 2) + chance(v, 0.2);
    if (v->fixed) {
        Entry *ground = &v->section[BODY].entry[base];
        strcpy(ground->name, "ground");
        ground->dropped = true;
    }
    for (int i = 0; i < axles; ++i)
        add_axle(v, x[i]);
    if (chance(v, 0.2))
        four_bar(v, BASE);
    for (int i = pick(v, 3); i > 0; --i)
        add_element(v);
    if (chance(v, 0.3))
        add_load(v);
    if (v->rich)
        add_formulas(v);
    if (v->driven)
        add_powertrain(v);
}

static void drop(Vehicle *v, Kind kind)
{
    Section *section = &v->section[kind];
    int index = pick(v, section->count);
    Entry *entry = &section->entry[index];
    entry->dropped = true;
    culprit_bodies(v, entry);
    for (int i = 0; i < v->section[FORCE].count && kind == COORDINATE; ++i)
        if (v->section[FORCE].entry[i].coordinate == index)
            v->section[FORCE].entry[i].dropped = true;
}

/* The mistakes that need no place of their own in the vehicle. */
static void make_mistake(Vehicle *v, Mistake mistake)
{
    int body = BASE + 1 + pick(v, v->section[BODY].count - 1);
    Vec p = near_to(v, 0, 0, 0.5, 1), q = near_to(v, 0, 0, 1.5, 1);
    Entry *extra = NULL;
    switch (mistake) {
    case JOINT_MISSING: drop(v, JOINT); break;
    case COORDINATE_MISSING: drop(v, COORDINATE); break;
    case JOINT_TOO_MANY: extra = rod(v, BASE, body, p, q); break;
    case COORDINATE_TOO_MANY:
        extra = coordinate(v, "extra", "length", BASE, body, &(Geometry){.points = {&p, &q}}, 0.05, 1000, false);
        break;
    case BODY_LOOSE: culprit(v, body_name(v, add_body(v, "loose", p, 5, 0.2))); break;
    default: break;
    }
    if (extra) {
        culprit(v, extra->name);
        culprit_bodies(v, extra);
    }
}

int main(int argc, char **argv)
{
    double seed = -1;
    bool broken = false, mechanism = false;
    const char *folder = NULL, *tire = NULL;
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--seed") && i + 1 < argc) {
            seed = number_of(argv[++i], "--seed");
        } else if (!strcmp(argv[i], "--broken")) {
            broken = true;
        } else if (!strcmp(argv[i], "--mechanism")) {
            mechanism = true;
        } else if (!strcmp(argv[i], "--rich") && i + 1 < argc) {
            folder = argv[++i];
        } else if (!strcmp(argv[i], "--tire") && i + 1 < argc) {
            tire = argv[++i];
        } else {
            fputs(usage, stderr);
            return 2;
        }
    }
    if (!(seed >= 0 && seed < 0x1p53) || !folder != !tire || !!folder + broken + mechanism > 1) {
        fputs(usage, stderr);
        return 2;
    }
    Vehicle *v = grab(1, sizeof *v);
    start_random(v, seed);
    Mistake mistake = broken ? (Mistake)(1 + (int)fmod(seed, MISTAKES - 1)) : NO_MISTAKE;
    v->mistake = mistake;
    v->rich = folder;
    if (mechanism) {
        build_mechanism(v);
    } else {
        build(v);
        make_mistake(v, mistake);
        add_outputs(v);
    }
    if (folder)
        write_files(v, folder, seed, tire);
    else
        write_plain(v, stdout, seed);
    if (broken)
        fprintf(stderr, "%s\n", v->culprits);
    free(v);
    return 0;
}
