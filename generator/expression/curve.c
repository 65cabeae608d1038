/* SPDX-License-Identifier: MIT
 * Functions of one number as tables of polynomials: an arc tangent, sine and cosine of a multiple of one, a tangent.
 *
 * A cell is a quarter of an octave, the first one goes from 0 to 1/4, so that a cell is found from the bits of the
 * argument. Its polynomial has degree 6: value and slope of the function at both ends, so that values and slopes go on
 * without a step, and its value at three places between. It is found with sums, products, quotients and roots alone:
 * the same digits on every machine. */
#include "expression/curve.h"
#include "expression/expression.h"

#include <math.h>
#include <string.h>

enum { OCTAVE = 4, FIRST_EXPONENT = -2, DEGREE = 6, PLACES = 33 };

/* The arc tangent by halving the angle twice and its series: within 4 units of the last place. */
double curve_arc_tangent(double x)
{
    const double quarter_turn = 1.57079632679489661923;
    if (x > 1)
        return quarter_turn - curve_arc_tangent(1 / x);
    for (int i = 0; i < 2; ++i)
        x /= 1 + sqrt(1 + x * x);
    double sum = 0;
    for (int n = 27; n >= 1; n -= 2)
        sum = 1.0 / n - x * x * sum;
    return 4 * x * sum;
}

/* Value and slope of the function itself, x >= 0. */
static void curve_exact(const Curve *curve, double x, double *value, double *slope)
{
    double sine, cosine;
    const double spread = 1 / (1 + x * x);
    if (curve->kind == CURVE_ATAN) {
        *value = curve_arc_tangent(x);
        *slope = spread;
        return;
    }
    portable_sincos(curve->kind == CURVE_TAN ? x : curve->factor * curve_arc_tangent(x), &sine, &cosine);
    if (curve->kind == CURVE_SINE) {
        *value = sine;
        *slope = curve->factor * cosine * spread;
    } else if (curve->kind == CURVE_COSINE) {
        *value = cosine;
        *slope = -curve->factor * sine * spread;
    } else {
        *value = sine / cosine;
        *slope = 1 / (cosine * cosine);
    }
}

/* Where cell `at` begins; it ends where the next one begins. */
static double cell_begin(int at)
{
    if (at == 0)
        return 0;
    const int octave = (at - 1) / OCTAVE, part = (at - 1) % OCTAVE;
    return ldexp(1 + (double)part / OCTAVE, FIRST_EXPONENT + octave);
}

double curve_end(const Curve *curve)
{
    return cell_begin(curve->cells);
}

/* Divided differences of the conditions at ends and places between, and from them the coefficients about `centre`. */
static void cell_fit(const Curve *curve, double begin, double end, double *cell)
{
    /* ends twice, for the slopes; the places make the largest |(1 - t^2)^2 t (t^2 - c^2)| small, t from -1 to 1 */
    const double c = 0.51, t[DEGREE + 1] = {-1, -1, 1, 1, 0, -c, c};
    const double middle = (begin + end) / 2, half = (end - begin) / 2, centre = begin == 0 ? 0 : middle;
    double x[DEGREE + 1], difference[DEGREE + 1], slope[DEGREE + 1];
    for (int i = 0; i <= DEGREE; ++i) {
        x[i] = (middle + half * t[i] - centre) / half;
        curve_exact(curve, middle + half * t[i], &difference[i], &slope[i]);
    }
    for (int k = 1; k <= DEGREE; ++k)
        for (int i = DEGREE; i >= k; --i)
            difference[i] =
                x[i] == x[i - k] ? slope[i] * half : (difference[i] - difference[i - 1]) / (x[i] - x[i - k]);
    /* Newton's form to powers, by Horner's rule */
    double power[DEGREE + 1] = {0};
    for (int i = DEGREE; i >= 0; --i) {
        for (int k = DEGREE; k >= 1; --k)
            power[k] = power[k - 1] - x[i] * power[k];
        power[0] = difference[i] - x[i] * power[0];
    }
    double scale = 1;
    for (int k = 0; k <= DEGREE; ++k, scale *= half)
        cell[k] = power[k] / scale;
    cell[DEGREE + 1] = centre;
    if (begin == 0) /* exact at 0, where a wheel rolls freely */
        curve_exact(curve, 0, &cell[0], &cell[1]);
}

double curve_value(const Curve *curve, double x)
{
    if (curve_is_short(curve))
        return short_curve_value(curve, x);
    const double a = fabs(x);
    double value, slope;
    if (!(a < curve_end(curve))) { /* not a number counts as beyond, too */
        const double arc = curve->kind == CURVE_TAN ? tan(x) : atan(x);
        return curve->kind == CURVE_SINE     ? sin(curve->factor * arc)
               : curve->kind == CURVE_COSINE ? cos(curve->factor * arc)
                                             : arc;
    }
    int64_t bits;
    memcpy(&bits, &a, sizeof bits);
    const int place = (int)(bits >> 50) - 4083;
    const double *cell = curve->cell[place > 0 ? place : 0], s = a - cell[DEGREE + 1], z = s * s;
    slope = (cell[4] + s * cell[5]) + z * cell[6];
    value = (cell[0] + s * cell[1]) + z * (cell[2] + s * cell[3]) + z * z * slope;
    return x < 0 && curve->kind != CURVE_COSINE ? -value : value;
}

void curve_make(Pool *pool, Curve *curve)
{
    if (curve_is_short(curve)) {
        short_curve_make(curve);
        return;
    }
    curve->cells = curve->kind == CURVE_TAN ? 1 + 2 * OCTAVE : PLACES; /* up to 1, up to 64 */
    curve->cell = pool_alloc(pool, (size_t)curve->cells * sizeof *curve->cell);
    curve->error = 0;
    for (int i = 0; i < curve->cells; ++i)
        cell_fit(curve, cell_begin(i), cell_begin(i + 1), curve->cell[i]);
    enum { LOOKS = 64 }; /* the error has four extrema in a cell */
    for (int i = 0; i < curve->cells; ++i)
        for (int k = 0; k < LOOKS; ++k) {
            const double x = cell_begin(i) + (cell_begin(i + 1) - cell_begin(i)) * (k + 0.5) / LOOKS;
            double value, slope;
            curve_exact(curve, x, &value, &slope);
            curve->error = fmax(curve->error, fabs(curve_value(curve, x) - value));
        }
}

/* ---- formulas with curves ------------------------------------------------------------------------------------- */

/* The curve of that kind, made if it is new; -1: it would be too far off. */
static int curve_find(Pool *pool, Curves *curves, CurveKind kind, double factor)
{
    const double useful =
        1e-7; /* of a value, which is 1 at most but for arc tangents; curves of usual tires are 2e-8 off */
    for (int i = 0; i < curves->count; ++i)
        if (curves->curve[i].kind == kind && curves->curve[i].factor == factor)
            return i;
    Curve curve = {.kind = kind, .factor = factor};
    curve_make(pool, &curve);
    if (!(curve.error <= useful))
        return -1;
    *POOL_PUSH(pool, curves->curve, curves->count) = curve;
    return curves->count - 1;
}

/* Is a node a literal times an arc tangent, or one alone? Sets the factor and the argument of the arc tangent. */
static bool is_arc(const Dag *dag, Ex e, double *factor, Ex *argument)
{
    const Node *arc = &dag->node[e];
    *factor = 1;
    for (int i = 0; i < 2 && arc->op == OP_MUL; ++i)
        if (dag->node[arc->arg[i]].op == OP_LITERAL && dag->node[arc->arg[1 - i]].op == OP_ATAN) {
            *factor = ex_value(dag, arc->arg[i], 0);
            arc = &dag->node[arc->arg[1 - i]];
        }
    *argument = arc->arg[0];
    return arc->op == OP_ATAN;
}

/* The curve that a node is, and its argument; -1: none. */
static int curve_of(Pool *pool, Curves *curves, const Dag *dag, Ex e, bool lanes, Ex *argument)
{
    const Node *node = &dag->node[e];
    double factor;
    *argument = node->arg[0];
    if (node->level < LEVEL_VARIABLE)
        return -1;
    if (node->op == OP_ATAN)
        return curve_find(pool, curves, lanes ? CURVE_SHORT_ATAN : CURVE_ATAN, 1);
    if (node->op == OP_TAN)
        return curve_find(pool, curves, lanes ? CURVE_SHORT_TAN : CURVE_TAN, 1);
    if (node->op != OP_SIN && node->op != OP_COS)
        return -1;
    const bool sine = node->op == OP_SIN, arc = is_arc(dag, node->arg[0], &factor, argument);
    if (lanes && arc && fabs(factor) <= 2)
        return curve_find(pool, curves, sine ? CURVE_SHORT_SINE : CURVE_SHORT_COSINE, factor);
    if (lanes) {
        *argument = node->arg[0];
        return curve_find(pool, curves, sine ? CURVE_SHORT_SIN : CURVE_SHORT_COS, 1);
    }
    return arc ? curve_find(pool, curves, sine ? CURVE_SINE : CURVE_COSINE, factor) : -1;
}

Block block_with_curves(const Block *block, Curves *curves, bool lanes)
{
    Dag *dag = block->dag;
    Pool *pool = dag->pool;
    const int nodes = dag->nodes;
    Ex *image = pool_alloc(pool, (size_t)nodes * sizeof *image);
    bool *needed = pool_alloc(pool, (size_t)nodes * sizeof *needed);
    for (int i = 0; i < block->stores; ++i)
        needed[block->store[i].value] = true;
    for (int e = nodes - 1; e >= 0; --e) /* arguments have smaller numbers */
        for (int i = 0; needed[e] && i < ex_arity((Op)dag->node[e].op); ++i)
            needed[dag->node[e].arg[i]] = true;
    dag->curves = curves;
    for (Ex e = 0; e < (Ex)nodes; ++e) {
        const Node node = dag->node[e]; /* a copy: nodes move as others are made */
        image[e] = e;
        if (!needed[e] || node.level < LEVEL_VARIABLE || !ex_arity((Op)node.op))
            continue;
        Ex argument;
        const int curve = curve_of(pool, curves, dag, e, lanes, &argument);
        if (curve >= 0) {
            image[e] = ex_op(dag, OP_CURVE, image[argument], (Ex)curve, 0);
            continue;
        }
        Ex arg[3] = {node.arg[0], node.arg[1], node.arg[2]};
        for (int i = 0; i < ex_arity((Op)node.op); ++i)
            arg[i] = image[arg[i]];
        if (memcmp(arg, node.arg, sizeof arg) != 0)
            image[e] = ex_op(dag, (Op)node.op, arg[0], arg[1], arg[2]);
    }
    Block out = *block;
    out.store = NULL;
    out.stores = 0;
    for (int i = 0; i < block->stores; ++i)
        block_store(&out, image[block->store[i].value], block->store[i].target);
    return out;
}
