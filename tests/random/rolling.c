/* SPDX-License-Identifier: MIT
 * What rolls and what drives it: tires, the rest of a wheel, powertrains. */
#include "vehicle.h"

#include "../reference/support.h"

#include <stdlib.h>
#include <string.h>

/* `[y1, y2]`, with the second a factor between the two times the first */
static void say_pair(Vehicle *v, Entry *tire, const char *key, double first, double low, double high)
{
    say(tire, ", %s: [%.6g, %.6g]", key, first, first * uniform(v, low, high));
}

void add_tires(Vehicle *v)
{
    Entry *file = add(v, TIRE, "pacejka"), *tire = add(v, TIRE, "tmeasy");
    say(file, "file: @TIRE@");
    if (chance(v, 0.3))
        say(file, ", relaxation: [%.3g, %.3g]", uniform(v, 0.1, 0.6), uniform(v, 0.1, 1));
    /* the second values follow the first ones so that maxima stay above what slides, and slips in their order */
    double forces = uniform(v, 1.5, 2.2), slips = uniform(v, 0.9, 1.3), most = uniform(v, 2500, 4500);
    say(tire, "type: tmeasy, radius: %.3g, stiffness: %.4g, damping: %.3g", uniform(v, 0.3, 0.36),
        uniform(v, 1.5e5, 3e5), uniform(v, 0, 800));
    if (chance(v, 0.5))
        say(tire, ", rim_radius: %.3g", uniform(v, 0.15, 0.22));
    say(tire, ", load: %.4g", uniform(v, 2500, 5000));
    if (chance(v, 0.5))
        say(tire, ", friction: %.3g, rolling_resistance: %.3g", uniform(v, 0.7, 1.1), uniform(v, 0, 0.03));
    say_pair(v, tire, "dfx0", most * uniform(v, 20, 40), forces, forces);
    say_pair(v, tire, "fxm", most, forces, forces);
    say_pair(v, tire, "fxs", most * uniform(v, 0.6, 1), forces, forces);
    say_pair(v, tire, "dfy0", most * uniform(v, 12, 30), forces, forces);
    say_pair(v, tire, "fym", most, forces, forces);
    say_pair(v, tire, "fys", most * uniform(v, 0.6, 1), forces, forces);
    say_pair(v, tire, "sxm", uniform(v, 0.1, 0.15), slips, slips);
    say_pair(v, tire, "sxs", uniform(v, 0.3, 0.9), slips, slips);
    say_pair(v, tire, "sym", uniform(v, 0.15, 0.22), slips, slips);
    say_pair(v, tire, "sys", uniform(v, 0.4, 0.9), slips, slips);
    say_pair(v, tire, "trail", uniform(v, 0.1, 0.2), 0.9, 1);
    say_pair(v, tire, "sq0", uniform(v, 0.15, 0.25), slips, slips);
    say_pair(v, tire, "sqe", uniform(v, 0.3, 0.5), slips, slips);
    if (chance(v, 0.5))
        say(tire, ", low_speed: %.3g", uniform(v, 0.5, 2));
}

void say_rolling(Vehicle *v, Entry *wheel, int carrier)
{
    static const char *const variable[] = {"tanh(0.1 * spin)", "tanh(spin)"};
    const char *const side[] = {"left", "right"};
    wheel->coordinate = 0; /* it rolls: a powertrain may drive it */
    say(wheel, ", tire: %s, spin_inertia: %.6g", v->section[TIRE].entry[chance(v, 0.6) ? 0 : 1].name,
        v->spin * uniform(v, 0.2, 1));
    if (chance(v, 0.5))
        say_turning(v, wheel, ", axis: ", direction(v, 0, 1, 0));
    if (chance(v, 0.2)) {
        int which = pick(v, 2);
        append(wheel->text, sizeof wheel->text, ", side: %s", side[which]);
        append(wheel->plain, sizeof wheel->plain, ", side: %s", side[v->image ? 1 - which : which]);
    }
    if (chance(v, 0.3))
        say(wheel, ", fade: %.3g", uniform(v, 0.005, 0.02));
    bool drive = chance(v, 0.4);
    if (drive) {
        say(wheel, ", drive: \"%.4g * (", uniform(v, -500, 500));
        say_formula(v, wheel, 2, variable, 2);
        say(wheel, ")\"");
    }
    if (v->fixed || ((drive || v->driven) && chance(v, 0.5)))
        if (drive || v->driven)
            say(wheel, ", drive_body: %s", body_name(v, carrier));
    if (chance(v, 0.6)) {
        say(wheel, ", brake: \"%.4g * (", uniform(v, 100, 1000));
        say_formula(v, wheel, 2, variable, 2);
        say(wheel, ")\"");
        if (chance(v, 0.5))
            say(wheel, ", windup: %.3g", uniform(v, 0.05, 0.3));
    }
}

/* A tree of differentials over all wheels that roll; false: there are none. */
static bool add_differentials(Vehicle *v)
{
    const Section *wheels = &v->section[WHEEL];
    const char *node[MOST];
    int nodes = 0;
    for (int i = 0; i < wheels->count; ++i)
        if (wheels->entry[i].coordinate == 0)
            node[nodes++] = wheels->entry[i].name;
    if (!nodes)
        return false;
    do {
        int first = pick(v, nodes);
        const char *a = node[first];
        node[first] = node[--nodes];
        Entry *differential = add(v, DIFFERENTIAL, "differential");
        if (nodes == 0 || chance(v, 0.15)) {
            say(differential, "outputs: [%s]", a);
        } else {
            int second = pick(v, nodes);
            say(differential, "outputs: [%s, %s]", a, node[second]);
            node[second] = node[--nodes];
            if (chance(v, 0.4))
                say(differential, ", split: %.3g", uniform(v, 0.2, 0.8));
            if (chance(v, 0.4)) {
                say(differential, ", lock: \"%.4g * (", uniform(v, 0, 200));
                say_formula(v, differential, 1, NULL, 0);
                say(differential, ")^2\"");
            }
        }
        if (chance(v, 0.7))
            say(differential, ", ratio: %.4g", uniform(v, 0.5, 5));
        if (chance(v, 0.5))
            say(differential, ", inertia: %.3g", uniform(v, 0, 0.5));
        node[nodes++] = differential->name;
    } while (nodes > 1);
    return true;
}

void add_powertrain(Vehicle *v)
{
    static const char *const variable[] = {"0.01 * speed", "throttle"};
    if (!add_differentials(v))
        return;
    Entry *text = grab(1, sizeof *text), *capacity = add(v, TABLE, "capacity"), *ratio = add(v, TABLE, "torque");
    say(capacity, "x: [0, 0.5, 0.9, 1], y: [%.4g, 13.5, 16, 25]", uniform(v, 9, 13));
    say(capacity, ", interpolation: %s", chance(v, 0.5) ? "cubic" : "linear");
    say(ratio, "x: [0, 0.7, 0.9, 1], y: [%.4g, 1.2, 1, 1]", uniform(v, 1.5, 2.5));
    say(text, "  engine: {inertia: %.4g, throttle: \"0.5 + ", uniform(v, 0.1, 2));
    say_formula(v, text, 2, NULL, 0);
    say(text, "\", torque: \"%.4g * throttle - 0.2 * speed + 20 * (", uniform(v, 100, 500));
    say_formula(v, text, 2, variable, 2);
    say(text, ")\"");
    double idle = uniform(v, 50, 90);
    if (chance(v, 0.6))
        say(text, ", idle: %.4g", idle);
    if (chance(v, 0.6))
        say(text, ", limit: %.4g", idle + uniform(v, 100, 300));
    say(text, "}\n  converter: {capacity: %s, torque: %s}\n", capacity->name, ratio->name);
    int gears = 1 + pick(v, 5);
    double gear = uniform(v, 2, 5);
    say(text, "  transmission: {forward: [%.4g", gear);
    for (int i = 1; i < gears; ++i)
        say(text, ", %.4g", gear *= uniform(v, 0.5, 0.8));
    say(text, "]");
    if (chance(v, 0.5))
        say(text, ", reverse: [%.4g]", -uniform(v, 2, 5));
    if (chance(v, 0.6))
        say(text, ", selector: \"2 * %s\"", v->input[1]);
    for (int up = 1; up >= 0 && gears > 1; --up)
        for (int i = 1; i < gears; ++i)
            say(text, "%s%.4g%s",
                i > 1 ? ", "
                : up  ? ", up: ["
                      : ", down: [",
                up ? 260 + 10.0 * i : 120 + 5.0 * i, i == gears - 1 ? "]" : "");
    if (chance(v, 0.5))
        say(text, ", latency: %.3g, duration: %.3g", uniform(v, 0.5, 2), uniform(v, 0.1, 0.6));
    if (chance(v, 0.5))
        say(text, ", inertia: %.3g", uniform(v, 0, 0.3));
    say(text, "}\n  differentials:\n");
    append(v->powertrain, sizeof v->powertrain, "%s", text->text);
    const Section *all = &v->section[DIFFERENTIAL];
    for (int i = 0; i < all->count; ++i)
        append(v->powertrain, sizeof v->powertrain, "    %s: {%s}\n", all->entry[i].name, all->entry[i].text);
    free(text);
}
