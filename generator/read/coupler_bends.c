/* SPDX-License-Identifier: MIT
 * Where the formula of a gear or coupler jumps or bends within the range of a coordinate, which no motion passes:
 * formulas such as atan2(y, x) do where their arguments go round, and sqrt(x^2) at 0. Looked for along each coordinate,
 * the others at their design values; what is found is a warning. */
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "read/reader.h"

#include <math.h>

enum { PIECES = 500, HALVINGS = 12 }; /* down to the reach of differences */

/* Ways along one coordinate. */
typedef struct Way {
    const Model *model;
    const Law *law;
    int coordinate;
    double reach; /* of differences */
} Way;

static double value(const Way *way, const Law *law, double x)
{
    double arg[3] = {0};
    if (law->op == LAW_VALUE)
        return law->index == way->coordinate ? x : way->model->coordinate[law->index].design;
    if (law->op != LAW_CALL)
        return law_number(law, way->model);
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = value(way, law->arg[i], x);
    return op_value((Op)law->call, arg[0], arg[1], arg[2]);
}

static double number(const Way *way, double x)
{
    return value(way, way->law, x);
}

static double slope(const Way *way, double x)
{
    return (number(way, x + way->reach) - number(way, x - way->reach)) / (2 * way->reach);
}

typedef double Number(const Way *way, double x);

/* Does f change as much over a thousandth and less of a piece as over the piece? Then *at is where. least: changes that
 * count. What changes evenly loses half of its change at each halving. */
static bool changes_at_once(const Way *way, Number *f, double low, double high, double least, double *at)
{
    double a = f(way, low), b = f(way, high);
    const double whole = fabs(b - a);
    if (!(whole > least) || !isfinite(whole))
        return false;
    for (int i = 0; i < HALVINGS; ++i) {
        const double middle = 0.5 * (low + high), m = f(way, middle);
        if (!isfinite(m))
            return false;
        if (fabs(m - a) > fabs(b - m))
            high = middle, b = m;
        else
            low = middle, a = m;
        if (!(fabs(b - a) > 0.4 * whole))
            return false;
    }
    *at = 0.5 * (low + high);
    return true;
}

static double largest(const Way *way, Number *f)
{
    const double *range = way->model->coordinate[way->coordinate].range, width = range[1] - range[0];
    double most = 0;
    for (int i = 0; i <= PIECES; ++i) {
        const double size = fabs(f(way, range[0] + width * i / PIECES));
        if (isfinite(size) && size > most)
            most = size;
    }
    return most;
}

/* The first place, if there is one. Changes that are rounding, of differences too, do not count. */
static bool find(const Way *way, Number *f, double *at)
{
    const double *range = way->model->coordinate[way->coordinate].range, width = range[1] - range[0];
    const double rounding = 1e-6 * largest(way, number) / (f == slope ? width : 1);
    const double least = fmax(1e-3 * largest(way, f), rounding);
    for (int i = 0; i < PIECES; ++i)
        if (changes_at_once(way, f, range[0] + width * i / PIECES, range[0] + width * (i + 1) / PIECES, least, at)) {
            if (fabs(*at) < 1e-6 * width)
                *at = 0;
            return true;
        }
    return false;
}

void coupler_bends(const Model *model, const Law *law, const Item *item, const char *what)
{
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *coordinate = &model->coordinate[i];
        const double width = coordinate->range[1] - coordinate->range[0];
        const Way way = {model, law, i, 1e-7 * width};
        double at;
        if (!law_follows(law, i))
            continue;
        const bool jumps = find(&way, number, &at);
        if (jumps || find(&way, slope, &at))
            diag_warn(
                item->at, "end the range before that value, or write a formula that is smooth there",
                "%s %s at %s = %.4g, inside its range [%.6g, %.6g]: no motion passes there (the other coordinates "
                "at their design values)",
                what, jumps ? "jumps" : "bends", coordinate->name, at, coordinate->range[0], coordinate->range[1]);
    }
}
