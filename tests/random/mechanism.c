/* SPDX-License-Identifier: MIT
 * Random mechanisms of a few bodies: trees and loops, with every type of joint and coordinate, whose numbers are those
 * that people write or general ones. */
#include "vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int any_body(Vehicle *v)
{
    int k = pick(v, v->section[BODY].count - v->own + 1);
    return k ? v->own + k - 1 : BASE;
}

/* A body for a joint at p: its centre of mass is there, or beside it. */
static int body_at(Vehicle *v, const char *prefix, Vec p)
{
    return nice_body(v, prefix, is_nice(v) && chance(v, 0.3) ? p : nice_step(v, p));
}

static Vec any_point(Vehicle *v)
{
    return nice_point(v, (Vec){{0, 0, 0}});
}

static void turning(Vehicle *v, int a, int b, Vec u)
{
    nice_dual(v, "angle", a, b, &(Geometry){.axis = &u}, true);
}

static void angle(Vehicle *v, int a, int b, Vec u)
{
    nice_dual(v, "angle", a, b, &(Geometry){.axis = &u}, false);
}

static void slide(Vehicle *v, int a, int b, Vec p, Vec u)
{
    nice_dual(v, "translation", a, b, &(Geometry){.points = {&p, &p}, .axis = &u}, false);
}

/* The length between a point of each; those must differ. */
static void length(Vehicle *v, int a, int b, Vec p)
{
    Vec q = nice_step(v, p), s = nice_step(v, q);
    while (norm(combine(1, q, -1, s)) < 0.3)
        s = nice_step(v, q);
    nice_dual(v, "length", a, b, &(Geometry){.points = {&q, &s}}, false);
}

static Vec apart(Vehicle *v, Vec p)
{
    Vec q = nice_step(v, p);
    while (norm(combine(1, p, -1, q)) < 0.3)
        q = nice_step(v, p);
    return q;
}

static void tie(Vehicle *v, int a, int b, Vec p)
{
    Vec q = nice_step(v, p), s = apart(v, q);
    join(v, "rod", "distance", a, b, &(Geometry){.points = {&q, &s}});
}

/* ---- bodies with one carrier each: trees ---- */

/* b turns on a about u, by a revolute or what is equal to it. */
static void turn_on(Vehicle *v, int a, int b, Vec p, Vec u)
{
    switch (chance(v, 0.7) ? 0 : 1 + pick(v, 3)) {
    case 1:
        join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
        join(v, "stop", "point_in_plane", a, b, &(Geometry){.point = &p, .axis = &u});
        break;
    case 2:
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        join(v, "same", "parallel", a, b, &(Geometry){.axis = &u});
        break;
    case 3:
        join(v, "line", "point_on_line", a, b, &(Geometry){.point = &p, .axis = &u});
        join(v, "stop", "point_in_plane", a, b, &(Geometry){.point = &p, .axis = &u});
        join(v, "same", "parallel", a, b, &(Geometry){.axis = &u});
        break;
    default: join(v, "hinge", "revolute", a, b, &(Geometry){.point = &p, .axis = &u});
    }
}

static void slide_on(Vehicle *v, int a, int b, Vec p, Vec u)
{
    if (chance(v, 0.7)) {
        join(v, "guide", "prismatic", a, b, &(Geometry){.point = chance(v, 0.5) ? &p : NULL, .axis = &u});
        return;
    }
    Vec s = nice_across(v, u), t = cross(u, s);
    join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
    join(v, "key", "perpendicular", a, b, &(Geometry){.axes = {&s, &t}});
}

static void branch(Vehicle *v)
{
    int a = any_body(v);
    Vec p = any_point(v), u = nice_axis(v), s = nice_across(v, u), t = cross(u, s);
    int b = body_at(v, "link", p), kind = pick(v, 14);
    switch (kind) {
    case 0:
    case 1:
    case 2:
    case 3:
        turn_on(v, a, b, p, u);
        turning(v, a, b, u);
        break;
    case 4:
        turn_on(v, a, b, p, u);
        length(v, a, b, p);
        break;
    case 5:
    case 6:
        slide_on(v, a, b, p, u);
        slide(v, a, b, p, u);
        break;
    case 7:
        join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
        turning(v, a, b, u);
        slide(v, a, b, p, u);
        break;
    case 8:
        join(v, "cross", "universal", a, b, &(Geometry){.point = &p, .axes = {&u, &s}});
        angle(v, a, b, u);
        angle(v, b, a, s);
        break;
    case 9:
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        angle(v, a, b, u);
        angle(v, a, b, s);
        angle(v, a, b, t);
        break;
    case 10:
        join(v, "plane", "point_in_plane", a, b, &(Geometry){.point = &p, .axis = &u});
        join(v, "same", "parallel", a, b, &(Geometry){.axis = &u});
        turning(v, a, b, u);
        slide(v, a, b, p, s);
        slide(v, a, b, p, t);
        break;
    case 11:
        join(v, "line", "point_on_line", a, b, &(Geometry){.point = &p, .axis = &u, .ordered = true});
        join(v, "same", "parallel", a, b, &(Geometry){.axis = &u});
        turning(v, a, b, u);
        slide(v, a, b, p, u);
        break;
    case 12: join(v, "weld", "fixed", a, b, &(Geometry){.point = chance(v, 0.5) ? &p : NULL}); break;
    default:
        /* three lengths to a ball */
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        for (int i = 0; i < 3; ++i)
            length(v, a, b, p);
    }
}

/* ---- loops of one body between two carriers ---- */

static void loop(Vehicle *v)
{
    int a = any_body(v), c = any_body(v);
    Vec p = any_point(v), u = nice_axis(v), s = nice_across(v, u);
    int b = body_at(v, "part", p);
    switch (pick(v, 8)) {
    case 0:
        turn_on(v, a, b, p, u);
        tie(v, c, b, p);
        break;
    case 1:
        slide_on(v, a, b, p, u);
        tie(v, c, b, p);
        break;
    case 2:
        join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
        tie(v, c, b, p);
        if (chance(v, 0.5))
            angle(v, a, b, u);
        else
            slide(v, a, b, p, u);
        break;
    case 3:
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        tie(v, c, b, p);
        tie(v, c, b, p);
        angle(v, a, b, u);
        break;
    case 4: {
        Vec q = apart(v, p), r = apart(v, q);
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        join(v, "link", "revolute_spherical", c, b, &(Geometry){.points = {&r, &q}, .axis = &u, .ordered = true});
        tie(v, c, b, p);
        break;
    }
    case 5:
        join(v, "cross", "universal", a, b, &(Geometry){.point = &p, .axes = {&u, &s}});
        tie(v, c, b, p);
        length(v, c, b, p);
        break;
    case 6: {
        Vec q = apart(v, p);
        join(v, "ball", "spherical", a, b, &(Geometry){.point = &p});
        join(v, "line", "point_on_line", c, b, &(Geometry){.point = &q, .axis = &u, .ordered = true});
        angle(v, a, b, u);
        break;
    }
    default:
        for (int i = 0; i < 5; ++i)
            tie(v, i % 2 ? c : a, b, p);
        length(v, a, b, p);
    }
}

/* ---- linkages on one carrier, in a plane or across ---- */

/* x s + y t in the plane of a linkage, from `origin`. */
static Vec in_plane(Vec origin, Vec s, double x, Vec t, double y)
{
    return combine(1, combine(1, origin, x, s), y, t);
}

static void linkage(Vehicle *v)
{
    int a = any_body(v), planar = chance(v, 0.7);
    Vec p = any_point(v), u = nice_axis(v), s = nice_across(v, u), t = cross(u, s);
    s = combine(1 / norm(s), s, 0, s);
    t = combine(1 / norm(t), t, 0, t);
    double r = nice_size(v, 0.3, 2), l = nice_size(v, 0.5, 3), d = nice_size(v, 0.5, 3);
    bool upright = is_nice(v);
    Vec q = upright ? in_plane(p, s, 0, t, r) : in_plane(p, s, r * uniform(v, -1, 1), t, r),
        base = in_plane(p, s, d, t, 0);
    Vec e = upright ? in_plane(p, s, d, t, l) : in_plane(p, s, d * uniform(v, 0.5, 1.5), t, l * uniform(v, 0.3, 1));
    if (!planar)
        e = combine(1, e, 0.5, u);
    if (norm(combine(1, e, -1, q)) < 0.2)
        e = in_plane(e, s, 0.5, t, 0.5);
    int crank = body_at(v, "crank", p);
    turn_on(v, a, crank, p, u);
    if (chance(v, 0.5))
        turning(v, a, crank, u);
    else
        angle(v, a, crank, u);
    int coupler = nice_body(v, "coupler", combine(0.5, q, 0.5, e)), last;
    const bool slider = chance(v, 0.4);
    if (slider) {
        last = body_at(v, "slider", e);
        slide_on(v, a, last, e, s);
    } else {
        last = body_at(v, "rocker", e);
        turn_on(v, a, last, base, u);
    }
    if (planar) {
        join(v, "hinge", "revolute", crank, coupler, &(Geometry){.point = &q, .axis = &u});
        join(v, "line", "point_on_line", coupler, last, &(Geometry){.point = &e, .axis = &u});
    } else {
        Vec way = combine(1, e, -1, q), side = nice_across(v, way), other = cross(way, side);
        join(v, "ball", "spherical", crank, coupler, &(Geometry){.point = &q});
        join(v, "cross", "universal", coupler, last, &(Geometry){.point = &e, .axes = {&side, &other}});
    }
}

/* ---- forces ---- */

/* Steps and switches at times and places that are met in a run, or never. */
static void add_law(Vehicle *v, int coordinate)
{
    const Entry *along = &v->section[COORDINATE].entry[coordinate];
    Entry *force = add(v, FORCE, "law");
    static const double late[] = {0, 0.1, 0.2, 0.3, 1.05, 1.1}, apart[] = {0.0123, 0.1123, -0.0877, 10};
    double size = nice_size(v, 0.1, 10), when = is_nice(v) ? late[pick(v, 6)] : uniform(v, 0, 1.2);
    /* near to where it is, but not where: engines that integrate other coordinates know it but for rounding */
    double where = along->design + apart[pick(v, 4)], fast = chance(v, 0.5) ? 1.0123 : 0.1123;
    say(force, "type: force, coordinate: %s, value: \"", along->name);
    switch (pick(v, 6)) {
    case 0: say(force, "if(time > %.6g, %.6g, 0)\"", when, size); break;
    case 1: say(force, "-%.6g * %s - rate(%s)\"", size, along->name, along->name); break;
    case 2: say(force, "if(%s > %.6g, -%.6g, 0)\"", along->name, where, size); break;
    case 3: say(force, "max(0, %.6g * (time - %.6g))\"", size, when); break;
    case 4:
        say(force, "if(abs(rate(%s)) > %.6g, %.6g, 0) + %.6g * min(time, 1)\"", along->name, fast, size, size);
        break;
    default: say(force, "%.6g * sin(%.6g * time)\"", size, nice_size(v, 0.5, 10));
    }
}

/* A formula that reads an output, of a body or of an element before it. */
static void add_reader(Vehicle *v)
{
    const int coordinate = pick(v, v->section[COORDINATE].count), body = pick(v, v->section[BODY].count);
    const char *along = v->section[COORDINATE].entry[coordinate].name, *axis = &"xyz"[pick(v, 3)];
    static const double apart[] = {0.0123, 0.1123, -0.0877, 10}; /* bounds that no state meets but for rounding */
    const double size = nice_size(v, 0.1, 10), where = apart[pick(v, 4)];
    const bool base = body == BASE && v->fixed;
    static const char *const type[] = {"position", "velocity", "angular_velocity", "roll_pitch_yaw"};
    const int which = pick(v, base ? 1 : 4);
    Entry *output = add(v, OUTPUT, "read");
    say(output, "type: %s, body: %s", type[which], body_name(v, body));
    if (!base && (which == 1 || which == 2) && chance(v, 0.5))
        say(output, ", in: %s", body_name(v, pick(v, v->section[BODY].count)));
    Entry *force = add(v, FORCE, "reader");
    say(force, "type: force, coordinate: %s, value: \"", along);
    if (which == 3) /* roll and yaw say nothing where the pitch is a quarter turn */
        say(force, "-%.6g * sin(%s.pitch)\"", size, output->name);
    else if (chance(v, 0.3))
        say(force, "if(%s.%c > %.6g, -%.6g, 0)\"", output->name, axis[0], where, size);
    else
        say(force, "-%.6g * %s.%c\"", size, output->name, axis[0]);
    if (chance(v, 0.5))
        return;
    Entry *seen = add(v, OUTPUT, "seen"), *echo = add(v, FORCE, "echo");
    say(seen, "type: force, element: %s", force->name);
    say(echo, "type: force, coordinate: %s, value: \"0.5 * %s - %.6g * time\"", along, seen->name, size);
}

/* A filter of what moves, and a force that follows it; perhaps another one behind it. */
static void add_filter(Vehicle *v)
{
    const int coordinate = pick(v, v->section[COORDINATE].count), body = pick(v, v->section[BODY].count);
    const char *along = v->section[COORDINATE].entry[coordinate].name, *before = along;
    const double size = nice_size(v, 0.1, 10), lag = nice_size(v, 0.05, 1);
    Entry *output = add(v, OUTPUT, "read");
    say(output, "type: %s, body: %s", body == BASE && v->fixed ? "position" : "velocity", body_name(v, body));
    for (int i = 1 + chance(v, 0.3); i > 0; --i) {
        Entry *state = add(v, STATE, "lag");
        say(state, "rate: \"(%s%s - %s) / %.6g", before, i == 1 ? "" : " + time", state->name, lag);
        if (chance(v, 0.5))
            say(state, " + %.6g * %s.%c", size, output->name, "xyz"[pick(v, 3)]);
        if (chance(v, 0.3))
            say(state, " - tanh(rate(%s))", along);
        say(state, "\"");
        if (chance(v, 0.5))
            say(state, ", initial: %.6g", nice_size(v, -1, 1));
        before = state->name;
    }
    Entry *force = add(v, FORCE, "follower");
    say(force, "type: force, coordinate: %s, value: \"-%.6g * %s\"", along, size, before);
}

/* Air on a body, still or in a wind, by numbers or by how the body moves through it; no coefficient jumps where the
 * sideslip does, at motion backward or along z, which nice states have but for rounding. */
static void add_air(Vehicle *v)
{
    const int body = any_body(v);
    static const char *const wind[] = {"[0, 0, 0]", "[1, 0, 0]", "[0, -1, 0]", "[0.3, \"0.5 * time\", -0.2]"};
    static const char *const force[] = {
        "[0, 0, -0.5]", "[0, \"-0.5 * sin(sideslip) * cos(incidence)\", 0.25 * incidence]", "[0, 0, cos(incidence)]",
        "[-0.1, \"cos(sideslip) * cos(incidence)\", \"0.1 * airspeed\"]"};
    if (body == BASE && v->fixed)
        return;
    Entry *element = add(v, FORCE, "air");
    say(element, "type: aero, body: %s, wind: %s", body_name(v, body), wind[pick(v, 4)]);
    if (chance(v, 0.7))
        say_point(v, element, ", point: ", any_point(v));
    say_number(v, element, ", area: ", nice_size(v, 0.1, 2));
    say(element, ", force: %s", force[pick(v, 4)]);
    if (chance(v, 0.7))
        say_number(v, element, ", drag: ", nice_size(v, 0, 2));
    if (chance(v, 0.5))
        say(element, ", length: 0.5, moment: [0, -0.2 * incidence, \"-sin(sideslip) * cos(incidence)\"]");
    if (chance(v, 0.3))
        say(element, ", density: 1");
}

static void add_nice_element(Vehicle *v)
{
    int b = any_body(v), a = any_body(v);
    Entry *force = add(v, FORCE, "between");
    Vec p = any_point(v), q = apart(v, p);
    if (a == b)
        a = NOTHING;
    if (v->fixed && (a == NOTHING || a == BASE))
        a = BASE;
    if (a == b) {
        force->dropped = true;
        return;
    }
    say(force, "type: spring_damper, bodies: [%s, %s]", body_name(v, a), body_name(v, b));
    say_point(v, force, ", points: [", p);
    say_point(v, force, ", ", q);
    say(force, "]");
    say_number(v, force, ", stiffness: ", nice_size(v, 0.1, 100));
    if (!v->conserves)
        say_number(v, force, ", damping: ", nice_size(v, 0, 2));
    if (is_nice(v))
        say(force, ", free: 0");
}

/* Six axes at a point, some of them free; a matrix whose rows outweigh the rest of them, so that it gives no energy. */
static void add_bushing(Vehicle *v)
{
    static const char *const orientation[] = {"{axis: [0, 0, 1], angle: 1.5707963267948966}",
                                              "{x: [1, 1, 0], z: [0, 0, 1]}", "{axis: [1, 2, 3], angle: 0.7}",
                                              "{euler: [0, 1, 0, 0]}"};
    static const char *const matrix =
        "[[20], [-5, 30], [1, 0, 20], [2, 0, 0, 10], [0, 3, 0, 1, 12], [1, 0, -2, 0, 2, 10]]";
    static const char *const law[] = {", force: [1, 0, -0.5]", ", torque: [0, 0, 1]",
                                      ", force: [\"-5 * dx^3\", 0, \"-dz_rate\"]",
                                      ", torque: [\"-2 * rx\", \"sin(ry)\", \"-rz_rate * abs(rz_rate)\"]"};
    int a = any_body(v), b = any_body(v);
    if (a == b)
        a = v->fixed ? BASE : NOTHING;
    if (a == b || (v->fixed && (a == NOTHING || b == NOTHING)))
        return;
    Entry *element = add(v, FORCE, "bushing");
    say(element, "type: bushing, bodies: [%s, %s]", body_name(v, a), body_name(v, b));
    say_point(v, element, ", point: ", any_point(v));
    if (chance(v, 0.5))
        say(element, ", orientation: %s", orientation[pick(v, 4)]);
    if (chance(v, 0.3)) {
        say(element, ", stiffness: %s", matrix);
    } else {
        for (int i = 0; i < 6; ++i)
            say(element, "%s%.6g", i ? ", " : ", stiffness: [", chance(v, 0.3) ? 0 : nice_size(v, 0.1, 50));
        say(element, "]");
    }
    if (v->conserves)
        return;
    if (chance(v, 0.5))
        say(element, ", damping: [1, 0, 2, 0.5, 0, 1]");
    if (chance(v, 0.5))
        say(element, "%s", law[pick(v, 4)]);
}

/* A turn that goes with a way: a bolt in a nut, or a pinion and a rack on one carrier. */
static void gearing(Vehicle *v)
{
    const double size = nice_size(v, 0.2, 1), ratio = chance(v, 0.5) ? size : -size;
    int a = any_body(v);
    Vec p = any_point(v), u = nice_axis(v), s = nice_across(v, u);
    int b = body_at(v, "pinion", p), way = b;
    Entry *joint;
    if (chance(v, 0.4)) {
        join(v, "sleeve", "cylindrical", a, b, &(Geometry){.point = &p, .axis = &u});
        joint = join(v, "thread", "screw", a, b, &(Geometry){.point = &p, .axis = &u, .ordered = true});
        s = u;
    } else {
        way = body_at(v, "rack", any_point(v));
        turn_on(v, a, b, p, u);
        slide_on(v, a, way, p, s);
        joint =
            join(v, "teeth", "rack_and_pinion", way, b, &(Geometry){.point = &p, .axes = {&u, &s}, .ordered = true});
    }
    say_number(v, joint, ", ratio: ", ratio);
    if (chance(v, 0.6))
        turning(v, a, b, u);
    else
        slide(v, a, way, p, s);
}

/* A body that turns or slides by a formula of the turn of another one. */
static void following(Vehicle *v)
{
    static const char *const formula[] = {"-2 * %s",
                                          "%s - 0.3 * sin(%s)",
                                          "sin(%s)",
                                          "2 * cos(%s)",
                                          "tanh(%s) + %s / 3",
                                          "atan2(sin(%s), 3 + cos(%s))",
                                          "exp(sin(%s)) / sqrt(1.5 + cos(%s)^2)"};
    const Vec p = any_point(v), u = nice_axis(v), q = any_point(v), s = nice_axis(v);
    const int a = any_body(v), first = body_at(v, "leader", p), c = any_body(v), b = body_at(v, "follower", q);
    turn_on(v, a, first, p, u);
    turning(v, a, first, u);
    const Section *coordinates = &v->section[COORDINATE];
    const char *leader = coordinates->entry[coordinates->count - 1].name;
    const bool turns = chance(v, 0.6);
    if (turns)
        turn_on(v, c, b, q, s);
    else
        slide_on(v, c, b, q, s);
    Entry *joint =
        join(v, "follow", turns ? "gear" : "coupler", c, b, &(Geometry){.point = &q, .axis = &s, .ordered = true});
    const char *form = formula[pick(v, (int)(sizeof formula / sizeof *formula))];
    say(joint, ", value: \"");
    for (; *form; ++form)
        if (form[0] == '%' && form[1] == 's')
            say(joint, "%s", leader), ++form;
        else
            say(joint, "%c", *form);
    say(joint, "\"");
}

/* ---- the whole ---- */

static void add_unit(Vehicle *v)
{
    if (!v->halves && chance(v, 0.12)) {
        (chance(v, 0.5) ? gearing : following)(v);
        return;
    }
    switch (pick(v, 8)) {
    case 0:
    case 1: linkage(v); break;
    case 2:
    case 3: loop(v); break;
    default: branch(v);
    }
}

static void add_base(Vehicle *v)
{
    if (v->halves) {
        Entry *base = add(v, BODY, "base");
        Vec com = nice_step(v, (Vec){{0, 0, 0}});
        say_number(v, base, "mass: ", nice_size(v, 0.5, 4));
        say(base, ", com: [%.9g, 0, %.9g], inertia: [1, 1, 0.5]", com.x[0], com.x[2]);
        return;
    }
    int base = nice_body(v, "base", any_point(v));
    if (v->fixed) {
        Entry *ground = &v->section[BODY].entry[base];
        strcpy(ground->name, "ground");
        ground->dropped = true;
    }
}

/* What there is on one side. */
static void add_side(Vehicle *v)
{
    int first = v->section[COORDINATE].count;
    v->own = v->section[BODY].count;
    for (int i = 1 + chance(v, 0.3); i > 0; --i)
        add_unit(v);
    for (int i = pick(v, 3); i > 0 && !v->conserves && v->section[COORDINATE].count > first; --i)
        add_law(v, first + pick(v, v->section[COORDINATE].count - first));
}

/* The same on the left and on the right; then, mostly, something that is on one side alone, perhaps not from the
 * beginning. */
static void add_halves(Vehicle *v)
{
    Mirror mirror;
    const int points = v->points, axes = v->axes;
    begin_left(v, &mirror);
    add_side(v);
    begin_right(v, &mirror);
    v->points = points;
    v->axes = axes;
    add_side(v);
    end_mirror(v, &mirror);
    if (!v->conserves && v->section[COORDINATE].count && chance(v, 0.7))
        add_law(v, pick(v, v->section[COORDINATE].count));
}

void build_mechanism(Vehicle *v)
{
    static const double share[] = {0.5, 0.5, 0.9, 1, 0};
    static const char *const gravity[] = {"[0, 0, 0]", "[0, 0, -10]", "[0, -1, 0]", "[1, 0.5, -9.81]"};
    v->nice = share[pick(v, 5)];
    v->halves = chance(v, 0.15);
    v->fixed = !v->halves && chance(v, 0.6);
    v->tuned = !v->halves && chance(v, 0.1);
    v->conserves = chance(v, v->halves ? 0.2 : 0.5);
    v->own = 1;
    if (!v->halves && chance(v, 0.4))
        v->gravity = gravity[pick(v, 4)];
    add_base(v);
    if (v->halves)
        add_halves(v);
    else
        for (int i = 1 + chance(v, 0.5) + chance(v, 0.3); i > 0; --i)
            add_unit(v);
    if (!v->section[COORDINATE].count) {
        Vec p = any_point(v), u = nice_axis(v);
        int b = body_at(v, "link", p);
        turn_on(v, BASE, b, p, u);
        turning(v, BASE, b, u);
    }
    for (int i = pick(v, 3); i > 0 && !v->halves; --i)
        add_nice_element(v);
    if (!v->halves && chance(v, 0.3))
        add_bushing(v);
    for (int i = pick(v, 3); i > 0 && !v->conserves && !v->halves; --i)
        add_law(v, pick(v, v->section[COORDINATE].count));
    for (int i = pick(v, 4); i > 1 && !v->conserves && !v->halves; --i)
        add_reader(v);
    if (!v->conserves && !v->halves && chance(v, 0.3))
        add_air(v);
    if (!v->conserves && !v->halves && chance(v, 0.3))
        add_filter(v);
    for (int i = 0; i < v->section[COORDINATE].count; ++i)
        say(add(v, OUTPUT, "out"), "type: coordinate, coordinate: %s", v->section[COORDINATE].entry[i].name);
    for (int i = v->fixed; i < v->section[BODY].count; ++i) {
        say(add(v, OUTPUT, "at"), "type: position, body: %s", body_name(v, i));
        say(add(v, OUTPUT, "turned"), "type: orientation, body: %s", body_name(v, i));
    }
    say(add(v, OUTPUT, "energies"), "type: energy");
}
