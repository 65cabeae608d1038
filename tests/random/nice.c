/* SPDX-License-Identifier: MIT
 * Numbers as people write them: 0, 1, 1/2, axes, quarter turns, points where there is one already. `nice` of a vehicle
 * is how often they come in place of general ones. */
#include "vehicle.h"

#include <math.h>
#include <string.h>

static double any_of(Vehicle *v, const double *x, int count)
{
    return x[pick(v, count)];
}

bool is_nice(Vehicle *v)
{
    return chance(v, v->nice);
}

double nice_size(Vehicle *v, double low, double high)
{
    static const double size[] = {1, 1, 1, 0.5, 2, 10};
    double x = is_nice(v) ? any_of(v, size, 6) : uniform(v, low, high);
    return x < low || x > high ? 1 : x;
}

Vec nice_axis(Vehicle *v)
{
    Vec out = {{0, 0, 0}};
    if (v->axes && chance(v, 0.4))
        return v->axis[pick(v, v->axes)];
    if (is_nice(v))
        out.x[pick(v, 3)] = chance(v, 0.6) ? 1 : -1;
    else
        do
            out = near_to(v, 0, 0, 0, 1);
        while (norm(out) < 0.3);
    if (v->axes < KNOWN)
        v->axis[v->axes++] = out;
    return out;
}

Vec nice_across(Vehicle *v, Vec u)
{
    if (!is_nice(v))
        return across(v, u);
    for (int i = pick(v, 3), k = 0; k < 3; ++k, i = (i + 1) % 3) {
        Vec side = {{0, 0, 0}};
        side.x[i] = chance(v, 0.7) ? 1 : -1;
        Vec out = cross(u, side);
        if (norm(out) > 0.3 * norm(u))
            return out;
    }
    return across(v, u);
}

Vec nice_step(Vehicle *v, Vec from)
{
    static const double part[] = {0, 0, 0, 1, -1, 0.5, -0.5, 2};
    if (!is_nice(v))
        return near_to(v, from.x[0], from.x[1], from.x[2], 1);
    for (int i = 0; i < 3; ++i)
        from.x[i] += any_of(v, part, 8);
    return from;
}

Vec nice_point(Vehicle *v, Vec near)
{
    Vec out = v->points && chance(v, 0.25 * v->nice) ? v->place[pick(v, v->points)] : nice_step(v, near);
    if (v->points < KNOWN)
        v->place[v->points++] = out;
    return out;
}

/* About the centre of mass; the principal values obey the triangle inequality. */
static void say_nice_inertia(Vehicle *v, Entry *body, double mass)
{
    if (is_nice(v)) {
        static const double sphere[] = {1, 0.1, 0.1, 0.5}, slender[] = {0.02, 0.05};
        double x = any_of(v, sphere, 4), z = chance(v, 0.3) ? any_of(v, slender, 2) : x;
        int along = pick(v, 3);
        for (int i = 0; i < 3; ++i)
            say(body, "%s%.9g", i ? ", " : ", inertia: [", i == along ? fmin(z, 2 * x) : x);
        say(body, "]");
        return;
    }
    double half[3];
    for (int i = 0; i < 3; ++i)
        half[i] = uniform(v, 0.3, 0.8);
    for (int i = 0; i < 3; ++i)
        say(body, "%s%.6g", i ? ", " : ", inertia: [",
            mass / 5 * (half[(i + 1) % 3] * half[(i + 1) % 3] + half[(i + 2) % 3] * half[(i + 2) % 3]));
    say(body, "]");
}

/* Quarter and half turns, or anything, or what it is by default. */
static void say_nice_orientation(Vehicle *v, Entry *body)
{
    static const char *const turned[] = {"{euler: [0.7071067811865476, 0.7071067811865476, 0, 0]}",
                                         "{euler: [0, 0, 0, 1]}",
                                         "{euler: [0.5, 0.5, 0.5, 0.5]}",
                                         "{axis: [0, 0, 1], angle: 1.5707963267948966}",
                                         "{axis: [0, 1, 0], angle: 3.141592653589793}",
                                         "{x: [0, 0, 1], z: [-1, 0, 0]}"};
    if (chance(v, 0.4))
        return;
    if (is_nice(v)) {
        say(body, ", orientation: %s", turned[pick(v, 6)]);
        return;
    }
    Vec u = near_to(v, 0.5, 0.5, 0.5, 0.45);
    say(body, ", orientation: {axis: [%.6g, %.6g, %.6g]", u.x[0], u.x[1], u.x[2]);
    say(body, ", angle: %.6g}", uniform(v, -3, 3));
}

int nice_body(Vehicle *v, const char *prefix, Vec com)
{
    Entry *body = add(v, BODY, prefix);
    double mass = nice_size(v, 0.5, 4);
    say_number(v, body, "mass: ", mass);
    say_point(v, body, ", com: ", com);
    say_nice_inertia(v, body, mass);
    if (chance(v, 0.5)) {
        const Vec origin = {{0, 0, 0}};
        say_point(v, body, ", position: ", is_nice(v) && chance(v, 0.5) ? origin : nice_point(v, com));
    }
    if (!v->halves)
        say_nice_orientation(v, body);
    return v->section[BODY].count - 1;
}

int nice_dual(Vehicle *v, const char *type, int a, int b, const Geometry *with, bool turns)
{
    static const double design[] = {1, -1, 0.5, 1.5707963267948966, 5, -3, 100};
    Entry *entry = add(v, COORDINATE, "w");
    int index = v->section[COORDINATE].count - 1;
    const bool length = !strcmp(type, "length"), angle = !strcmp(type, "angle");
    double at = length ? norm(combine(1, *with->points[0], -1, *with->points[1])) : 0;
    double reach = length ? 0.3 * at : angle ? (turns ? 7 : 0.6) : 0.5;
    say_connection(v, entry, type, a, b, with);
    if (!length && chance(v, 0.2)) {
        at = is_nice(v) ? any_of(v, design, 7) : round(100 * uniform(v, -1, 1)) / 100;
        say(entry, ", design: %.17g", at);
    }
    entry->design = at;
    say(entry, ", range: [%.17g, ", at - reach);
    say(entry, "%.17g]", at + reach);
    if (index > 0 && !v->conserves && !v->halves && chance(v, 0.15))
        say(entry, ", driven: true");
    if (chance(v, 0.4)) {
        Entry *force = add(v, FORCE, "spring");
        force->coordinate = index;
        say(force, "type: spring_damper, coordinate: %s", entry->name);
        say_number(v, force, ", stiffness: ", nice_size(v, 0.1, 100));
        if (!v->conserves)
            say_number(v, force, ", damping: ", nice_size(v, 0, 2));
        if (chance(v, 0.5))
            say_number(v, force, ", free: ", is_nice(v) ? (double)(pick(v, 3) - 1) : uniform(v, -1, 1));
    }
    return index;
}
