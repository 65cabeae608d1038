/* SPDX-License-Identifier: MIT */
#include "formula.h"

#include "support.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

static SignalSource *source_read(const Json *json)
{
    if (json->count != 9)
        fail("a signal in a formula has 9 parts, not %d", json->count);
    SignalSource *source = grab(1, sizeof *source);
    const char *type = json->item[1]->text;
    source->type = strcpy(grab(strlen(type) + 1, 1), type);
    source->component = (int)json->item[2]->number;
    source->body = (int)json->item[3]->number;
    source->in = (int)json->item[4]->number;
    source->index = (int)json->item[5]->number;
    for (int i = 0; i < 3; ++i)
        source->point[i] = json->item[6 + i]->number;
    return source;
}

Formula *formula_read(const Json *json)
{
    Formula *formula = grab(1, sizeof *formula);
    if (json->kind == JSON_NUMBER) {
        formula->number = json->number;
        return formula;
    }
    if (json->kind != JSON_LIST || !json->count || json->item[0]->kind != JSON_TEXT)
        fail("a formula is a number or a list that begins with an operator");
    const char *op = json->item[0]->text;
    formula->op = strcpy(grab(strlen(op) + 1, 1), op);
    if (!strcmp(op, "signal")) {
        formula->source = source_read(json);
        return formula;
    }
    bool indexed = !strcmp(op, "value") || !strcmp(op, "rate") || !strcmp(op, "input") || !strcmp(op, "state") ||
                   !strcmp(op, "table");
    int first = 1 + indexed;
    if (json->count < first || json->count - first > 3)
        fail("wrong number of arguments of '%s' in a formula", op);
    if (indexed)
        formula->index = (int)json->item[1]->number;
    formula->arguments = json->count - first;
    for (int i = 0; i < formula->arguments; ++i)
        formula->argument[i] = formula_read(json->item[first + i]);
    return formula;
}

void formula_free(Formula *formula)
{
    if (!formula)
        return;
    for (int i = 0; i < formula->arguments; ++i)
        formula_free(formula->argument[i]);
    if (formula->source)
        free(formula->source->type);
    free(formula->source);
    free(formula->op);
    free(formula);
}

static quad negative(quad a, quad b)
{
    (void)b;
    return -a;
}

static quad plus(quad a, quad b)
{
    return a + b;
}
static quad minus(quad a, quad b)
{
    return a - b;
}
static quad times(quad a, quad b)
{
    return a * b;
}
static quad over(quad a, quad b)
{
    return a / b;
}

#define OF_ONE(name, function) \
    static quad name(quad a, quad b) \
    { \
        (void)b; \
        return function(a); \
    }
OF_ONE(of_sqrt, sqrtq)
OF_ONE(of_abs, fabsq)
OF_ONE(of_sin, sinq)
OF_ONE(of_cos, cosq)
OF_ONE(of_tan, tanq)
OF_ONE(of_asin, asinq)
OF_ONE(of_acos, acosq)
OF_ONE(of_atan, atanq)
OF_ONE(of_exp, expq)
OF_ONE(of_log, logq)
OF_ONE(of_tanh, tanhq)

static const struct {
    const char *name;
    int arguments;
    quad (*function)(quad a, quad b);
} operation[] = {{"-", 1, negative},   {"+", 2, plus},       {"-", 2, minus},      {"*", 2, times},
                 {"/", 2, over},       {"sqrt", 1, of_sqrt}, {"abs", 1, of_abs},   {"sin", 1, of_sin},
                 {"cos", 1, of_cos},   {"tan", 1, of_tan},   {"asin", 1, of_asin}, {"acos", 1, of_acos},
                 {"atan", 1, of_atan}, {"exp", 1, of_exp},   {"log", 1, of_log},   {"tanh", 1, of_tanh},
                 {"atan2", 2, atan2q}, {"pow", 2, powq},     {"min", 2, fminq},    {"max", 2, fmaxq}};

quad formula_value(const Formula *formula, const Surroundings *around)
{
    if (!formula->op)
        return formula->number;
    quad x[3] = {0};
    for (int i = 0; i < formula->arguments; ++i)
        x[i] = formula_value(formula->argument[i], around);
    const char *op = formula->op;
    if (formula->source)
        return signal_value(formula->source, around);
    if (!strcmp(op, "value"))
        return around->w[formula->index];
    if (!strcmp(op, "rate"))
        return around->w_rate[formula->index];
    if (!strcmp(op, "input"))
        return around->input[formula->index];
    if (!strcmp(op, "state"))
        return around->state[formula->index];
    if (!strcmp(op, "table"))
        return lookup_at(&around->table[formula->index], x[0]);
    if (!strcmp(op, "time"))
        return around->time;
    if (!strcmp(op, "length") || !strcmp(op, "angle"))
        return around->local.length;
    if (!strcmp(op, "speed"))
        return around->local.speed;
    if (!strcmp(op, "spin"))
        return around->local.spin;
    if (!strcmp(op, "throttle"))
        return around->local.throttle;
    if (!strcmp(op, "incidence"))
        return around->local.incidence;
    if (!strcmp(op, "sideslip"))
        return around->local.sideslip;
    if (!strcmp(op, "airspeed"))
        return around->local.airspeed;
    if (!strcmp(op, "if"))
        return x[0] > 0 ? x[1] : x[2];
    static const char *const strain[] = {"dx",      "dy",      "dz",      "rx",      "ry",      "rz",
                                         "dx_rate", "dy_rate", "dz_rate", "rx_rate", "ry_rate", "rz_rate"};
    for (size_t i = 0; i < sizeof strain / sizeof *strain; ++i)
        if (!strcmp(op, strain[i]))
            return around->local.bushing[i];
    for (size_t i = 0; i < sizeof operation / sizeof *operation; ++i)
        if (operation[i].arguments == formula->arguments && !strcmp(operation[i].name, op))
            return operation[i].function(x[0], x[1]);
    fail("unknown operator '%s' in a formula", op);
}

quad formula_size(const Formula *formula, const Surroundings *around)
{
    const char *op = formula->op ? formula->op : "";
    quad size[2] = {0};
    const bool sum = !strcmp(op, "+") || !strcmp(op, "-"), product = !strcmp(op, "*"), quotient = !strcmp(op, "/");
    if (!sum && !product && !quotient)
        return fabsq(formula_value(formula, around));
    for (int i = 0; i < formula->arguments; ++i)
        size[i] = formula_size(formula->argument[i], around);
    if (product)
        return size[0] * size[1];
    return quotient ? size[0] / fabsq(formula_value(formula->argument[1], around)) : size[0] + size[1];
}

/* ---- tables ------------------------------------------------------------------------------------------- */

void lookup_read(Lookup *table, const Json *json)
{
    table->count = json_get(json, "x")->count;
    table->x = grab((size_t)table->count, sizeof *table->x);
    table->y = grab((size_t)table->count, sizeof *table->y);
    json_numbers(json, "x", table->x, table->count);
    json_numbers(json, "y", table->y, table->count);
    table->cubic = !strcmp(json_text(json, "interpolation"), "cubic");
    table->onward = !strcmp(json_text(json, "beyond"), "linear");
}

void lookup_free(Lookup *table)
{
    free(table->x);
    free(table->y);
}

static quad secant(const Lookup *table, int i)
{
    return ((quad)table->y[i + 1] - table->y[i]) / ((quad)table->x[i + 1] - table->x[i]);
}

/* FORMAT.md section 6: slope at a point of the monotone cubic. */
static quad slope(const Lookup *table, int i)
{
    if (i == 0)
        return secant(table, 0);
    if (i == table->count - 1)
        return secant(table, i - 1);
    quad before = secant(table, i - 1), after = secant(table, i);
    if (before * after <= 0)
        return 0;
    quad h0 = (quad)table->x[i] - table->x[i - 1], h1 = (quad)table->x[i + 1] - table->x[i];
    quad w1 = 2 * h1 + h0, w2 = h1 + 2 * h0;
    return (w1 + w2) / (w1 / before + w2 / after);
}

quad lookup_at(const Lookup *table, quad x)
{
    int last = table->count - 1, i = 0;
    if (x < table->x[0])
        return table->y[0] + (table->onward ? secant(table, 0) * (x - table->x[0]) : 0);
    if (x >= table->x[last])
        return table->y[last] + (table->onward ? secant(table, last - 1) * (x - table->x[last]) : 0);
    while (x >= table->x[i + 1])
        ++i;
    quad h = (quad)table->x[i + 1] - table->x[i], d = x - table->x[i], s = secant(table, i);
    if (!table->cubic)
        return table->y[i] + s * d;
    /* Newton's form of the Hermite cubic */
    quad m0 = slope(table, i), m1 = slope(table, i + 1), c = (s - m0) / h, e = (m0 + m1 - 2 * s) / (h * h);
    return table->y[i] + d * (m0 + d * (c + (d - h) * e));
}
