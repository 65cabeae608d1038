/* SPDX-License-Identifier: MIT
 * Formulas of gears and couplers with their first and second derivatives along a direction: Taylor arithmetic. */
#include "expression/expression.h"
#include "model/model.h"
#include "world/world.h"

#include <math.h>

/* f(a) from f and its first two derivatives at the value of a. */
static Jet through(Jet a, double f, double slope, double bend)
{
    return (Jet){f, slope * a.rate, slope * a.second + bend * a.rate * a.rate};
}

static Jet sum(Jet a, Jet b, double sign)
{
    return (Jet){a.value + sign * b.value, a.rate + sign * b.rate, a.second + sign * b.second};
}

static Jet product(Jet a, Jet b)
{
    return (Jet){a.value * b.value, a.rate * b.value + a.value * b.rate,
                 a.second * b.value + 2 * a.rate * b.rate + a.value * b.second};
}

static Jet reciprocal(Jet a)
{
    const double f = 1 / a.value;
    return through(a, f, -f * f, 2 * f * f * f);
}

static Jet logarithm(Jet a)
{
    return through(a, log(a.value), 1 / a.value, -1 / (a.value * a.value));
}

static Jet exponential(Jet a)
{
    const double f = exp(a.value);
    return through(a, f, f, f);
}

static Jet power(Jet a, Jet b)
{
    const double n = b.value;
    if (b.rate == 0 && b.second == 0)
        return through(a, pow(a.value, n), n == 0 ? 0 : n * pow(a.value, n - 1),
                       n == 0 || n == 1 ? 0 : n * (n - 1) * pow(a.value, n - 2));
    Jet f = exponential(product(b, logarithm(a)));
    f.value = pow(a.value, n);
    return f;
}

/* The angle of (b, a): its rate is that of a b' - b a' over the square. */
static Jet angle(Jet a, Jet b)
{
    const double square = a.value * a.value + b.value * b.value;
    const double across = b.value * a.rate - a.value * b.rate, along = a.value * a.rate + b.value * b.rate;
    const double bend = b.value * a.second - a.value * b.second;
    return (Jet){atan2(a.value, b.value), across / square, bend / square - 2 * across * along / (square * square)};
}

static Jet call(Op op, Jet a, Jet b)
{
    const double x = a.value;
    switch (op) {
    case OP_NEG: return sum((Jet){0, 0, 0}, a, -1);
    case OP_ADD: return sum(a, b, 1);
    case OP_SUB: return sum(a, b, -1);
    case OP_MUL: return product(a, b);
    case OP_DIV: return product(a, reciprocal(b));
    case OP_SQRT: return through(a, sqrt(x), 0.5 / sqrt(x), -0.25 / (x * sqrt(x)));
    case OP_SIN: return through(a, sin(x), cos(x), -sin(x));
    case OP_COS: return through(a, cos(x), -sin(x), -cos(x));
    case OP_TAN: return through(a, tan(x), 1 + tan(x) * tan(x), 2 * tan(x) * (1 + tan(x) * tan(x)));
    case OP_ASIN: return through(a, asin(x), 1 / sqrt(1 - x * x), x / pow(1 - x * x, 1.5));
    case OP_ACOS: return through(a, acos(x), -1 / sqrt(1 - x * x), -x / pow(1 - x * x, 1.5));
    case OP_ATAN: return through(a, atan(x), 1 / (1 + x * x), -2 * x / ((1 + x * x) * (1 + x * x)));
    case OP_EXP: return exponential(a);
    case OP_LOG: return logarithm(a);
    case OP_TANH: {
        const double slope = 1 - tanh(x) * tanh(x);
        return through(a, tanh(x), slope, -2 * tanh(x) * slope);
    }
    case OP_POW: return power(a, b);
    default: return angle(a, b); /* OP_ATAN2: the reader lets no other through */
    }
}

Jet world_jet(const World *world, const Law *law, const double *way)
{
    const Parameter *parameter = law->op == LAW_PARAMETER ? &world->model->parameter[law->index] : NULL;
    if (parameter && parameter->law)
        return world_jet(world, parameter->law, NULL);
    if (parameter)
        return (Jet){parameter->tunable && world->parameter ? world->parameter[parameter->index] : parameter->value, 0,
                     0};
    if (law->op == LAW_NUMBER)
        return (Jet){law->number, 0, 0};
    if (law->op == LAW_VALUE)
        return (Jet){world->x[law->index], way ? way[law->index] : 0, 0};
    const Jet a = world_jet(world, law->arg[0], way);
    return call((Op)law->call, a, law->arg[1] ? world_jet(world, law->arg[1], way) : (Jet){0, 0, 0});
}
