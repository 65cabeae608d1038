/* SPDX-License-Identifier: MIT
 * Formulas of time with their first and second derivatives, by the chain rule from the leaves up. */
#include "base/table.h"
#include "expression/expression.h"
#include "model/model.h"
#include "scene/profile.h"

#include <math.h>

/* A value with its derivatives by time. */
typedef struct Jet {
    double x, v, a;
} Jet;

/* g(u) from g, dg/du, d2g/du2 at u. */
static Jet through(Jet u, double g, double first, double second)
{
    return (Jet){g, first * u.v, second * u.v * u.v + first * u.a};
}

static Jet add(Jet a, Jet b, double sign)
{
    return (Jet){a.x + sign * b.x, a.v + sign * b.v, a.a + sign * b.a};
}

static Jet multiply(Jet a, Jet b)
{
    return (Jet){a.x * b.x, a.v * b.x + a.x * b.v, a.a * b.x + 2 * a.v * b.v + a.x * b.a};
}

static Jet reciprocal(Jet u)
{
    const double g = 1 / u.x;
    return through(u, g, -g * g, 2 * g * g * g);
}

static Jet exponential(Jet u)
{
    const double g = exp(u.x);
    return through(u, g, g, g);
}

static Jet logarithm(Jet u)
{
    return through(u, log(u.x), 1 / u.x, -1 / (u.x * u.x));
}

static Jet arc_tangent(Jet u)
{
    const double g = 1 / (1 + u.x * u.x);
    return through(u, atan(u.x), g, -2 * u.x * g * g);
}

/* The angle of (x, y): y'x - yx' over x^2 + y^2, whose derivative follows by the rule for quotients. */
static Jet arc_tangent_of(Jet y, Jet x)
{
    const double square = x.x * x.x + y.x * y.x, turn = y.v * x.x - y.x * x.v;
    const double square_rate = 2 * (x.x * x.v + y.x * y.v), turn_rate = y.a * x.x - y.x * x.a;
    return (Jet){atan2(y.x, x.x), turn / square, (turn_rate * square - turn * square_rate) / (square * square)};
}

static Jet power(Jet u, Jet e)
{
    if (e.v != 0 || e.a != 0) {
        const Jet whole = exponential(multiply(e, logarithm(u)));
        return (Jet){pow(u.x, e.x), whole.v, whole.a};
    }
    const double n = e.x;
    /* n 0^(n - 1) is infinite for small n; as a factor of 0 it must be 0 */
    const double first = n == 0 ? 0 : n * pow(u.x, n - 1),
                 second = n == 0 || n == 1 ? 0 : n * (n - 1) * pow(u.x, n - 2);
    return through(u, pow(u.x, n), first, second);
}

static Jet of_one(Op op, Jet u)
{
    const double s = sin(u.x), c = cos(u.x);
    switch (op) {
    case OP_NEG: return (Jet){-u.x, -u.v, -u.a};
    case OP_ABS: return u.x < 0 ? (Jet){-u.x, -u.v, -u.a} : u;
    case OP_SQRT: {
        const double g = sqrt(u.x);
        return u.v == 0 && u.a == 0 ? (Jet){g, 0, 0} : through(u, g, 1 / (2 * g), -1 / (4 * g * g * g));
    }
    case OP_SIN: return through(u, s, c, -s);
    case OP_COS: return through(u, c, -s, -c);
    case OP_TAN: return through(u, tan(u.x), 1 / (c * c), 2 * s / (c * c * c));
    case OP_ASIN:
    case OP_ACOS: {
        const double root = sqrt(1 - u.x * u.x), first = 1 / root, second = u.x / (root * root * root);
        return op == OP_ASIN ? through(u, asin(u.x), first, second) : through(u, acos(u.x), -first, -second);
    }
    case OP_ATAN: return arc_tangent(u);
    case OP_EXP: return exponential(u);
    case OP_LOG: return logarithm(u);
    case OP_TANH: {
        const double g = tanh(u.x), first = 1 - g * g;
        return through(u, g, first, -2 * g * first);
    }
    default: return (Jet){NAN, NAN, NAN};
    }
}

static Jet of_several(Op op, const Jet u[3])
{
    switch (op) {
    case OP_ADD: return add(u[0], u[1], 1);
    case OP_SUB: return add(u[0], u[1], -1);
    case OP_MUL: return multiply(u[0], u[1]);
    case OP_DIV: {
        Jet quotient = multiply(u[0], reciprocal(u[1]));
        quotient.x = u[0].x / u[1].x;
        return quotient;
    }
    case OP_MIN: return u[1].x < u[0].x ? u[1] : u[0];
    case OP_MAX: return u[1].x > u[0].x ? u[1] : u[0];
    case OP_POW: return power(u[0], u[1]);
    case OP_ATAN2: return arc_tangent_of(u[0], u[1]);
    case OP_POSITIVE: return u[0].x > 0 ? u[1] : u[2];
    default: return of_one(op, u[0]);
    }
}

/* A table's value, and slopes by the formulas of its pieces. */
static Jet of_table(const Table *table, Jet u)
{
    const int last = table->count - 1;
    const bool before = u.x <= table->x[0], behind = u.x >= table->x[last];
    const double value = table_value(table, u.x);
    if (before || behind)
        return through(u, value, table->onward ? table->slope[before ? 0 : last] : 0, 0);
    int i = 0;
    while (u.x >= table->x[i + 1])
        ++i;
    const double h = table->x[i + 1] - table->x[i], t = (u.x - table->x[i]) / h;
    const double chord = (table->y[i + 1] - table->y[i]) / h;
    if (!table->cubic)
        return through(u, value, chord, 0);
    const double a = table->slope[i], b = table->slope[i + 1], bend = a + b - 2 * chord;
    return through(u, value, a + t * (2 * (3 * chord - 2 * a - b) + 3 * t * bend),
                   (2 * (3 * chord - 2 * a - b) + 6 * t * bend) / h);
}

static Jet jet_of(const Law *law, const Model *model, double time)
{
    if (law->op == LAW_LOCAL)
        return (Jet){time, 1, 0};
    if (law->op != LAW_CALL && law->op != LAW_TABLE)
        return (Jet){law_number(law, model), 0, 0};
    Jet u[3] = {{0, 0, 0}};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        u[i] = jet_of(law->arg[i], model, time);
    return law->op == LAW_TABLE ? of_table(&model->table[law->index], u[0]) : of_several((Op)law->call, u);
}

void formula_of_time(const Law *law, const Model *model, double time, double out[3])
{
    const Jet jet = jet_of(law, model, time);
    out[0] = jet.x;
    out[1] = jet.v;
    out[2] = jet.a;
}

static bool has_time(const Law *law)
{
    bool has = law->op == LAW_LOCAL;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        has = has || has_time(law->arg[i]);
    return has;
}

const char *formula_of_time_kink(const Law *law)
{
    if (!has_time(law))
        return NULL;
    if (law->op == LAW_TABLE)
        return law->name;
    const bool bends = law->op == LAW_CALL &&
                       (law->call == OP_ABS || law->call == OP_MIN || law->call == OP_MAX || law->call == OP_POSITIVE);
    if (bends)
        return law->name;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (formula_of_time_kink(law->arg[i]))
            return formula_of_time_kink(law->arg[i]);
    return NULL;
}
