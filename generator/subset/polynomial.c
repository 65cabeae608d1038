/* SPDX-License-Identifier: MIT
 * Recovery by polynomials: the motion of a class of subsets of one coordinate as polynomials of that coordinate over
 * its range. Chebyshev series are fitted to exact_motion.c's solutions, cut where what is left out is below the bound,
 * and written as powers of t, which goes from -1 to 1 over the range. What the emitted statements give, in double
 * precision, is then compared with exact solutions at many points. */
#include "base/message.h"
#include "base/plant.h"
#include "base/quad.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/exact_motion.h"
#include "subset/polynomial_proof.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

enum {
    NODES = 96, /* points of the fit: zeros of the Chebyshev polynomial of that degree */
    DEGREE_MOST = 40,
    POINTS = 2001,    /* points of the verification, at equal distances, both ends among them */
    BODY_NUMBERS = 26 /* of a body: place 3, Euler parameters 4, S 6, alpha and acceleration 6; its pose q 7 */
};

static const double smallest = 1e-17; /* a number that stays below this share of its scale is 0 */

typedef struct Fit {
    Work *w;
    Formula *formula;
    Quad cosine[4 * NODES]; /* of multiples of pi / (2 NODES) */
    int numbers;            /* of a member: BODY_NUMBERS a body */
    Quad *node, *point;     /* [members][NODES or POINTS][numbers] exact numbers */
    double *low, *high;     /* [members] the range */
    Quad scale[KINDS];      /* what errors are relative to: the largest over members and ranges */
    int *degree;            /* [numbers] */
    double *power;          /* [numbers][members][DEGREE_MOST + 1] coefficients of powers of t */
} Fit;

static int kind_of(int number)
{
    const int place = number % BODY_NUMBERS;
    return place < 3    ? KIND_PLACE
           : place < 7  ? KIND_ROTATION
           : place < 10 ? KIND_TURN
           : place < 13 ? KIND_GLIDE
           : place < 16 ? KIND_ALPHA
           : place < 19 ? KIND_ACCELERATION
           : place < 22 ? KIND_PLACE
                        : KIND_ROTATION;
}

/* Euler parameters of a rotation, of the two signs the one nearer to `before`. */
static void euler_of(const Quad A[9], const Quad before[4], Quad p[4])
{
    const Quad trace = A[0] + A[4] + A[8];
    Quad square[4] = {1 + trace, 1 + 2 * A[0] - trace, 1 + 2 * A[4] - trace, 1 + 2 * A[8] - trace};
    int most = 0;
    for (int i = 1; i < 4; ++i)
        most = square[i] > square[most] ? i : most;
    const Quad r = quad_sqrt(square[most]) / 2, s = 1 / (4 * r);
    const Quad odd[3] = {A[7] - A[5], A[2] - A[6], A[3] - A[1]};
    p[most] = r;
    for (int i = 1; i < 4; ++i)
        if (most == 0)
            p[i] = odd[i - 1] * s;
        else if (i != most)
            p[i] = (A[3 * (i - 1) + most - 1] + A[3 * (most - 1) + i - 1]) * s;
    if (most)
        p[0] = odd[most - 1] * s;
    Quad along = 0;
    for (int i = 0; i < 4; ++i)
        along += p[i] * before[i];
    for (int i = 0; along < 0 && i < 4; ++i)
        p[i] = -p[i];
}

/* The numbers of a subset's motion at unit rate, of which `last` has those found before. */
static void numbers_of(const Fit *fit, const Quad *motion, const Quad *q, const Quad *last, Quad *out)
{
    const int size = fit->formula->layout.motion_size;
    for (int b = 0; b < fit->w->first->bodies; ++b, out += BODY_NUMBERS, last += BODY_NUMBERS) {
        const Quad *m = motion + (size_t)(b * size);
        for (int i = 0; i < 3; ++i) {
            out[i] = m[MOTION_C + i];
            out[13 + i] = m[MOTION_ALPHA + i];
            out[16 + i] = m[MOTION_ACCELERATION + i];
        }
        euler_of(m + MOTION_A, last + 3, out + 3);
        for (int i = 0; i < 6; ++i)
            out[7 + i] = m[MOTION_S + i];
        for (int i = 0; i < 7; ++i)
            out[19 + i] = q ? q[7 * b + i] : 0;
    }
}

static const char *bodies_text(const Work *w, int member)
{
    Text out = {.pool = w->pool};
    const Subset *subset = subset_member(w, member);
    for (int b = 0; b < subset->bodies; ++b)
        text_print(&out, "%s'%s'", b ? ", " : "", w->model->body[subset->body[b]].name);
    return out.s;
}

/* The value of the coordinate at a point of the sweep: NODES, or POINTS. */
static Quad value_at(const Fit *fit, int member, bool nodes, int i)
{
    const Quad low = fit->low[member], high = fit->high[member];
    const Quad t = nodes ? -fit->cosine[2 * i + 1] : -1 + (Quad)(2 * i) / (POINTS - 1);
    return !nodes && i == POINTS - 1 ? high : (low + high) / 2 + (high - low) / 2 * t;
}

/* Follow a member from its design to both ends of its range: numbers at nodes and points. Ends in a message where the
 * subset is lost. */
static void sweep(Fit *fit, Exact *exact, int member)
{
    const Work *w = fit->w;
    const int s = w->class->member[member], numbers = fit->numbers;
    const Coordinate *c = &w->model->coordinate[w->sequence->subset[s].dep[0]];
    Quad last[numbers], out[numbers];
    for (int direction = -1; direction < 2; direction += 2) {
        exact_reset(exact);
        memset(last, 0, sizeof last);
        int at[2];
        for (int nodes = 0; nodes < 2; ++nodes) { /* the first one on that side */
            at[nodes] = direction > 0 ? 0 : (nodes ? NODES : POINTS) - 1;
            while (at[nodes] >= 0 && at[nodes] < (nodes ? NODES : POINTS) &&
                   direction * (value_at(fit, member, nodes, at[nodes]) - (Quad)c->design) < 0)
                at[nodes] += direction;
        }
        for (;;) {
            const bool left[2] = {at[0] >= 0 && at[0] < POINTS, at[1] >= 0 && at[1] < NODES};
            if (!left[0] && !left[1])
                break;
            int nodes = left[1];
            if (left[0] && left[1])
                nodes = direction * (value_at(fit, member, 1, at[1]) - value_at(fit, member, 0, at[0])) < 0;
            const Quad x = value_at(fit, member, nodes, at[nodes]);
            const char *lost = exact_solve(exact, s, x);
            if (lost)
                diag_fail(c->at,
                          pool_print(w->pool,
                                     "end the range of '%s' before that value, or leave out "
                                     "`--recovery polynomial`",
                                     c->name),
                          "%s at %s = %.6g, within its range [%g, %g]: the pose of %s is no polynomial of it there",
                          lost, c->name, (double)x, c->range[0], c->range[1], bodies_text(w, member));
            numbers_of(fit, exact_numbers(exact, s), exact_pose(exact, s), last, out);
            Quad *to = nodes ? fit->node + ((size_t)member * NODES + (size_t)at[1]) * (size_t)numbers
                             : fit->point + ((size_t)member * POINTS + (size_t)at[0]) * (size_t)numbers;
            memcpy(to, out, sizeof out);
            memcpy(last, out, sizeof last);
            at[nodes] += direction;
        }
    }
    /* both sides begin at the design, but Euler parameters have two signs */
    for (int b = 0; b < w->first->bodies; ++b) {
        const Quad *p = fit->point + (size_t)member * POINTS * (size_t)numbers + (size_t)(BODY_NUMBERS * b + 3);
        for (int nodes = 0; nodes < 2; ++nodes)
            for (int i = 0; i < (nodes ? NODES : POINTS); ++i) {
                Quad *own = (nodes ? fit->node + ((size_t)member * NODES + (size_t)i) * (size_t)numbers
                                   : fit->point + ((size_t)member * POINTS + (size_t)i) * (size_t)numbers) +
                            (BODY_NUMBERS * b + 3);
                const Quad *before = nodes || i == 0 ? p : own - numbers;
                Quad along = 0;
                for (int j = 0; j < 4; ++j)
                    along += own[j] * before[j];
                for (int j = 0; along < 0 && j < 4; ++j)
                    own[j] = -own[j];
            }
    }
}

/* Angular and linear numbers have one scale, by the subset's size. Accelerations are compared with those of a body that
 * turns at unit rate too, so that motions along straight lines have a scale. */
static void set_scales(Fit *fit)
{
    const Quad size = fit->formula->size;
    Quad most[KINDS] = {0};
    for (size_t i = 0; i < (size_t)(fit->w->class->members * POINTS); ++i)
        for (int j = 0; j < fit->numbers; ++j)
            most[kind_of(j)] = quad_max(most[kind_of(j)], quad_abs(fit->point[i * (size_t)fit->numbers + (size_t)j]));
    fit->scale[KIND_PLACE] = size;
    fit->scale[KIND_ROTATION] = 1;
    fit->scale[KIND_TURN] = quad_max(most[KIND_TURN], most[KIND_GLIDE] / size);
    fit->scale[KIND_GLIDE] = size * fit->scale[KIND_TURN];
    fit->scale[KIND_ALPHA] = quad_max(quad_max(most[KIND_ALPHA], most[KIND_ACCELERATION] / size),
                                      fit->scale[KIND_TURN] * fit->scale[KIND_TURN]);
    fit->scale[KIND_ACCELERATION] = size * fit->scale[KIND_ALPHA];
}

/* Coefficients of a number's Chebyshev series, [NODES]. */
static void series(const Fit *fit, int member, int number, Quad *c)
{
    for (int k = 0; k < NODES; ++k) {
        Quad sum = 0;
        for (int i = 0; i < NODES; ++i)
            sum += fit->node[((size_t)member * NODES + (size_t)i) * (size_t)fit->numbers + (size_t)number] *
                   fit->cosine[k * (2 * i + 1) % (4 * NODES)];
        c[k] = (k ? 2 : 1) * sum / NODES * (k % 2 ? -1 : 1);
    }
}

/* From a Chebyshev series up to a degree to powers of t. */
static void powers(const Quad *c, int degree, double *out)
{
    Quad before[DEGREE_MOST + 1] = {1}, now[DEGREE_MOST + 1] = {0, 1}, next[DEGREE_MOST + 1],
                              sum[DEGREE_MOST + 1] = {c[0]};
    for (int k = 1; k <= degree; ++k) {
        for (int i = 0; i <= k; ++i)
            sum[i] += c[k] * now[i];
        for (int i = 0; i <= DEGREE_MOST; ++i)
            next[i] = (i ? 2 * now[i - 1] : 0) - before[i];
        memcpy(before, now, sizeof now);
        memcpy(now, next, sizeof now);
    }
    for (int i = 0; i <= degree; ++i)
        out[i] = (double)sum[i];
}

/* Degrees and coefficients; false: a series does not fall below the bound. */
static bool fit_numbers(Fit *fit, double bound)
{
    const int members = fit->w->class->members;
    Quad c[members][NODES];
    for (int j = 0; j < fit->numbers; ++j) {
        const Quad scale = fit->scale[kind_of(j)];
        int degree = -1; /* a number that is 0 */
        for (int m = 0; m < members; ++m) {
            series(fit, m, j, c[m]);
            Quad tail = 0;
            int k = NODES - 1;
            for (; k >= 0; --k) {
                tail += quad_abs(c[m][k]);
                if (tail > (k ? 0.25 * bound : smallest) * scale)
                    break;
            }
            degree = k > degree ? k : degree;
        }
        if (degree > DEGREE_MOST)
            return false;
        fit->degree[j] = degree;
        for (int m = 0; m < members && degree >= 0; ++m)
            powers(c[m], degree, fit->power + ((size_t)j * (size_t)members + (size_t)m) * (DEGREE_MOST + 1));
    }
    return true;
}

/* Largest difference, relative to the scales, of what statements in double precision give at all points. */
static double verify(const Fit *fit)
{
    const int members = fit->w->class->members;
    Quad worst = 0;
    for (int m = 0; m < members; ++m) {
        const double middle = (fit->low[m] + fit->high[m]) / 2, slope = 2 / (fit->high[m] - fit->low[m]);
        for (int i = 0; i < POINTS; ++i) {
            const Quad *exact = fit->point + ((size_t)m * POINTS + (size_t)i) * (size_t)fit->numbers;
            const double x = (double)value_at(fit, m, false, i), t = (x - middle) * slope;
            /* x is rounded: its effect on a number is that number's derivative times the difference */
            const Quad off = (Quad)x - value_at(fit, m, false, i);
            for (int j = 0; j < fit->numbers; ++j) {
                const double *a = fit->power + ((size_t)j * (size_t)members + (size_t)m) * (DEGREE_MOST + 1);
                double value = 0, derivative = 0;
                for (int k = fit->degree[j]; k >= 0; --k) {
                    derivative = derivative * t + value;
                    value = value * t + a[k];
                }
                const Quad error = quad_abs(value - exact[j] - (Quad)(derivative * slope) * off);
                worst = quad_max(worst, error / fit->scale[kind_of(j)]);
            }
        }
    }
    return (double)worst;
}

/* ---- the blocks ------------------------------------------------------------------------------------------------ */

static const char *number_name(Work *w, int number, int power)
{
    static const char *const name[BODY_NUMBERS] = {"c_x",     "c_y",     "c_z",   "p_0",   "p_1",   "p_2", "p_3",
                                                   "S_0",     "S_1",     "S_2",   "S_3",   "S_4",   "S_5", "alpha_x",
                                                   "alpha_y", "alpha_z", "acc_x", "acc_y", "acc_z", "q_x", "q_y",
                                                   "q_z",     "q_p0",    "q_p1",  "q_p2",  "q_p3"};
    return pool_print(w->pool, "%s.%s_t%d", w->model->body[w->first->body[number / BODY_NUMBERS]].name,
                      name[number % BODY_NUMBERS], power);
}

/* A constant of the class from the numbers of the members. */
static Ex constant(Work *w, const double *value, const char *name)
{
    const Ex e = ex_constant(w->dag, value);
    ex_describe(w->dag, e, "%s", name);
    return e;
}

/* The polynomial of a number at t, by Horner's rule. */
static Ex horner(const Fit *fit, int number, Ex t)
{
    Work *w = fit->w;
    const int members = w->class->members;
    double value[members];
    Ex sum = 0;
    for (int k = fit->degree[number]; k >= 0; --k) {
        for (int m = 0; m < members; ++m)
            value[m] = fit->power[((size_t)number * (size_t)members + (size_t)m) * (DEGREE_MOST + 1) + (size_t)k];
        for (int m = 0; k == 2 && number < 7 && m < members && planted("polynomial"); ++m)
            value[m] += 2e-13 * (double)fit->scale[kind_of(number)]; /* twice the bound: only the proof sees it */
        sum = ex_add(w->dag, ex_mul(w->dag, sum, t), constant(w, value, number_name(w, number, k)));
    }
    return sum;
}

/* From the coordinate to t. */
static Ex parameter(const Fit *fit, Ex x)
{
    Work *w = fit->w;
    double middle[w->class->members], slope[w->class->members];
    for (int m = 0; m < w->class->members; ++m) {
        middle[m] = (fit->low[m] + fit->high[m]) / 2;
        slope[m] = 2 / (fit->high[m] - fit->low[m]);
    }
    const char *name = w->model->coordinate[w->first->dep[0]].name;
    return ex_mul(w->dag, ex_sub(w->dag, x, constant(w, middle, pool_print(w->pool, "%s.middle", name))),
                  constant(w, slope, pool_print(w->pool, "%s.slope", name)));
}

/* Motions from the polynomials; numbers that are the same in every configuration are taken over. */
static void make_motions(const Fit *fit, Motion *motion)
{
    Work *w = fit->w;
    Dag *dag = w->dag;
    const Ex t = parameter(fit, w->x[0]), rate = w->rate[0], square = ex_mul(dag, rate, rate);
    for (int b = 0; b < w->first->bodies; ++b) {
        Motion *m = &motion[b];
        const int first = BODY_NUMBERS * b;
        Ex p[4];
        *m = (Motion){.deps = 1, .S = pool_alloc(w->pool, 6 * sizeof *m->S)};
        for (int i = 0; i < 4; ++i)
            p[i] = horner(fit, first + 3 + i, t);
        ex_rotation(dag, p, m->A);
        for (int i = 0; i < 3; ++i) {
            m->c[i] = horner(fit, first + i, t);
            m->alpha[i] = ex_mul(dag, horner(fit, first + 13 + i, t), square);
            m->acceleration[i] = ex_mul(dag, horner(fit, first + 16 + i, t), square);
        }
        for (int i = 0; i < 6; ++i)
            m->S[i] = horner(fit, first + 7 + i, t);
        for (int i = 0; i < MOTION_S + 6; ++i) {
            const Ex known = *motion_number(&fit->formula->motion[b], i);
            if (formula_is_constant(fit->formula, known))
                *motion_number(m, i) = known;
        }
        for (int i = 0; i < 6; ++i) {
            Ex *speed = i < 3 ? &m->omega[i] : &m->velocity[i - 3];
            *speed = ex_mul(dag, m->S[i], rate);
        }
    }
}

static Polynomial *make_blocks(Fit *fit, double bound, double worst)
{
    Work *w = fit->w;
    Dag *dag = w->dag;
    Formula *formula = fit->formula;
    const Layout *layout = &formula->layout;
    const int members = w->class->members, bodies = w->first->bodies;
    Polynomial *found = pool_alloc(w->pool, sizeof *found);
    Motion *motion = pool_alloc(w->pool, (size_t)bodies * sizeof *motion);
    *found = (Polynomial){.motion = motion,
                          .solve = {.dag = dag, .scheduled = true},
                          .edge = {.dag = dag},
                          .within = {.dag = dag},
                          .bound = bound,
                          .worst = worst,
                          .points = POINTS,
                          .low = fit->low,
                          .high = fit->high,
                          .flag = layout->start_size};
    dag_section(dag, "motions, by polynomials of the coordinate");
    make_motions(fit, motion);
    for (int b = 0; b < bodies; ++b)
        for (int i = 0; i < MOTION_S + 6; ++i)
            block_store(&found->solve, *motion_number(&motion[b], i),
                        element_at(ARRAY_motion, b * layout->motion_size + i));
    dag_section(dag, "what the bodies add to the inertia and to the equations of motion");
    if (layout->inertia_size) {
        BodyInertia body[bodies];
        const Ex *inertia = subset_inertia(w, layout, motion, body);
        for (int i = 0; i < layout->inertia_size; ++i)
            block_store(&found->solve, inertia[i], element_at(ARRAY_inertia, i));
    }
    dag_section(dag, "pose at the end of the range");
    double end[members];
    memcpy(end, fit->low, sizeof end);
    const char *name = w->model->coordinate[w->first->dep[0]].name;
    const Ex low = constant(w, end, pool_print(w->pool, "%s.low", name));
    memcpy(end, fit->high, sizeof end);
    const Ex high = constant(w, end, pool_print(w->pool, "%s.high", name));
    const Ex t = parameter(fit, ex_op(dag, OP_MAX, low, ex_op(dag, OP_MIN, high, w->x[0], 0), 0));
    for (int b = 0; b < bodies; ++b)
        for (int i = 0; i < 7; ++i)
            block_store(&found->edge, horner(fit, BODY_NUMBERS * b + 19 + i, t), element_at(ARRAY_q, 7 * b + i));
    dag_section(dag, NULL);
    const Ex later = ex_add(dag, w->x[0], ex_mul(dag, ex_input(dag, element_at(ARRAY_ahead, 0), NULL), w->rate[0]));
    const Ex inside[] = {ex_sub(dag, w->x[0], low), ex_sub(dag, high, w->x[0]), ex_sub(dag, later, low),
                         ex_sub(dag, high, later)};
    for (int i = 0; i < 4; ++i)
        block_store(&found->within, inside[i], element_at(ARRAY_inside, i));
    for (int j = 0; j < fit->numbers; ++j)
        if (j % BODY_NUMBERS < 19)
            found->degree = fit->degree[j] > found->degree ? fit->degree[j] : found->degree;
    return found;
}

void subset_polynomial(Work *w, Formula *formula, Formula *const *made, const Sampling *sampling, double bound)
{
    const int members = w->class->members;
    if (w->first->deps != 1 || w->first->carrier != BODY_BASE) {
        formula->exact_because = "its motion relative to the base depends on several coordinates, or on none";
        return;
    }
    if (formula->react.stores) {
        formula->exact_because = "reactions of its joints are asked for, which need factors";
        return;
    }
    if (QUAD_BITS < 113) {
        formula->exact_because = "gicgen was built where there are no numbers of quad precision";
        return;
    }
    const Coordinate *c = &w->model->coordinate[w->first->dep[0]];
    Exact *exact = exact_new(w, made, formula, sampling);
    if (exact_is_tuned(exact))
        diag_fail(c->at,
                  "take `tunable` from the parameters that move its points or its design, or leave out "
                  "`--recovery polynomial`",
                  "the geometry of %s follows tunable parameters: no polynomial of '%s' fits all their values",
                  bodies_text(w, 0), c->name);
    Fit fit = {.w = w, .formula = formula, .numbers = BODY_NUMBERS * w->first->bodies};
    const size_t numbers = (size_t)fit.numbers, all = (size_t)members;
    for (int i = 0; i < 4 * NODES; ++i) {
        Quad sine;
        quad_sincos(quad_pi() * i / (2 * NODES), &sine, &fit.cosine[i]);
    }
    fit.low = pool_alloc(w->pool, all * sizeof *fit.low);
    fit.high = pool_alloc(w->pool, all * sizeof *fit.high);
    fit.node = pool_alloc(w->pool, all * NODES * numbers * sizeof *fit.node);
    fit.point = pool_alloc(w->pool, all * POINTS * numbers * sizeof *fit.point);
    fit.degree = pool_alloc(w->pool, numbers * sizeof *fit.degree);
    fit.power = pool_alloc(w->pool, numbers * all * (DEGREE_MOST + 1) * sizeof *fit.power);
    for (int m = 0; m < members; ++m) {
        const Coordinate *own = &w->model->coordinate[subset_member(w, m)->dep[0]];
        fit.low[m] = own->range[0];
        fit.high[m] = own->range[1];
        sweep(&fit, exact, m);
    }
    set_scales(&fit);
    if (!fit_numbers(&fit, bound)) {
        formula->exact_because = pool_print(
            w->pool, "the range [%g, %g] of '%s' takes polynomials of a degree above %d; a shorter one may not",
            fit.low[0], fit.high[0], c->name, DEGREE_MOST);
        return;
    }
    const double worst = verify(&fit);
    if (!(worst <= bound)) {
        formula->exact_because = "rounding of the polynomials is above the bound";
        return;
    }
    Polynomial *found = make_blocks(&fit, bound, worst);
    double scale[KINDS];
    for (int i = 0; i < KINDS; ++i)
        scale[i] = (double)fit.scale[i];
    const char *gap = polynomial_prove(w, formula, found, exact_new(w, made, formula, sampling), scale);
    if (gap) {
        formula->exact_because = gap;
        formula->unproved = true;
        return;
    }
    formula->polynomial = found;
    ++formula->layout.start_size; /* whether the start is a polynomial's */
}
