/* SPDX-License-Identifier: MIT
 * Random formulas, of a size that stays near 1 where their variables do. */
#include "vehicle.h"

void add_gains(Vehicle *v)
{
    for (int i = 0; i < GAINS; ++i) {
        Entry *gain = add(v, PARAMETER, "gain"), *input = add(v, INPUT, "input");
        if (i == 0)
            say(gain, "value: %.4g, tunable: true", uniform(v, 0.2, 1));
        else
            say(gain, "value: \"%.4g * %s + %.3g\"", uniform(v, 0.2, 1), v->gain[i - 1], uniform(v, 0, 0.5));
        say(input, "default: %.4g", uniform(v, -0.5, 0.5));
        v->gain[i] = gain->name;
        v->input[i] = input->name;
    }
}

static void say_leaf(Vehicle *v, Entry *entry, const char *const *variable, int variables)
{
    switch (variables ? pick(v, 5) : pick(v, 3)) {
    case 0: say(entry, "%.4g", uniform(v, 0.1, 2)); break;
    case 1: say(entry, "%s", v->gain[pick(v, GAINS)]); break;
    case 2: say(entry, "%s", v->input[pick(v, GAINS)]); break;
    default: say(entry, "%s", variable[pick(v, variables)]);
    }
}

/* A `%` is another formula. Where a function grows fast or ends, what stands in it is limited. */
static const char *const shape[] = {
    "% + %",
    "% - %",
    "(%) * (%)",
    "-(%)",
    "(%) / (1.5 + (%)^2)",
    "sin(%)",
    "cos(pi * (%))",
    "tan(tanh(%))",
    "tanh(%)",
    "atan(%)",
    "atan2(%, 1 + abs(%))",
    "exp(tanh(%))",
    "log(1.5 + abs(%))",
    "sqrt(0.1 + abs(%))",
    "asin(0.9 * tanh(%))",
    "acos(0.9 * tanh(%))",
    "(0.2 + abs(%))^1.3",
    "pow(0.2 + abs(%), tanh(%))",
    "tanh(%)^3",
    "min(%, %)",
    "max(%, %, %)",
    "if(% < %, %, %)",
    "if(% >= 0.3 and not (% <= %), %, %)",
    "if(% > 0 or % < 0.1, %, %)",
};

void say_formula(Vehicle *v, Entry *entry, int depth, const char *const *variable, int variables)
{
    if (depth == 0 || chance(v, 0.15)) {
        say_leaf(v, entry, variable, variables);
        return;
    }
    if (chance(v, 0.1)) {
        say(entry, "%s(", add_table(v, 1, 1));
        say_formula(v, entry, depth - 1, variable, variables);
        say(entry, ")");
        return;
    }
    for (const char *s = shape[pick(v, sizeof shape / sizeof *shape)]; *s; ++s)
        if (*s == '%')
            say_formula(v, entry, depth - 1, variable, variables);
        else
            say(entry, "%c", *s);
}

void say_any_formula(Vehicle *v, Entry *entry, int depth)
{
    const Section *all = &v->section[COORDINATE];
    char text[4][48] = {{0}};
    const char *variable[4];
    for (int i = 0; i < 4; ++i) {
        append(text[i], sizeof text[i], i % 2 ? "rate(%s)" : "%s", all->entry[pick(v, all->count)].name);
        variable[i] = text[i];
    }
    say_formula(v, entry, depth, variable, 4);
}
