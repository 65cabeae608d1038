/* SPDX-License-Identifier: MIT
 * Checks of emitted code for singular configurations of a class of subsets. All bounds on the distance from a
 * singular configuration are in this file. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "expression/factorize.h"
#include "model/tunable.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

/* A determinant below this share of that at the design, or of the other sign, means that independence is lost (Serban
 * and Haug 2000, eq. 6). The determinant is the distance, as an angle, from the place where two solutions meet: errors
 * of poses are epsilon divided by it, errors of velocities and accelerations epsilon divided by its square, times the
 * gain of a chain of bodies. With 1e-3 accelerations at random states next to the bound were 1e-7 off
 * (tests/stress/near_singular.sh). The same bound holds for a direction that defines an angle: the length of its part
 * perpendicular to the axis. */
static const double determinant_loss = 8e-3;
/* For a badly conditioned design the bound is larger: the condition at the bound (times 2.4 or more, the ratio of the
 * largest to the least singular value) may not exceed this. 2.2e-16 times its square is the promised accuracy of
 * accelerations, 1e-8. */
static const double worst_condition = 2500;
/* Share of the estimated distance that a step may use: the design need not be the most distant configuration, and
 * bodies may become faster. */
static const double reserve = 0.5;

/* A drawing with tuned geometry is singular if its determinant is less than this share of the file's. */
static const double drawing_loss = 1e-4;

static bool is_geared(const Work *w, const Connection *tie)
{
    return !tie->is_coordinate && joint_is_geared(w->model->joint[tie->index].type);
}

/* A screw turns a body far on a short way. That is a matter of the units of ways and angles, not of the distance from a
 * singular configuration: then the best units count. */
double subset_condition(const Work *w, int s)
{
    double A[w->n * w->n];
    bool geared = false;
    for (int i = 0; i < w->n * w->n; ++i)
        A[i] = ex_value(w->dag, w->J[i], s) / (i % w->n % 6 < 3 ? w->size : 1);
    for (int i = 0; i < w->connections; ++i)
        geared = geared || is_geared(w, &w->connection[i]);
    const double condition = linear_condition(w->n, A);
    return geared ? fmin(condition, linear_condition_in_best_units(w->n, A)) : condition;
}

double subset_singular_share(const Work *w, int s)
{
    return fmax(determinant_loss, subset_condition(w, s) / worst_condition);
}

/* The factor that makes a determinant relative to that at the design; with tuned geometry, at the drawing with the
 * values of the parameters. */
static double scale_of_design(const Work *w, int member, int determinant, int unused, Ex *formula)
{
    const double share = subset_singular_share(w, member * w->configurations);
    const double at_file = ex_value(w->dag, (Ex)determinant, member * w->configurations) * (share / determinant_loss);
    (void)unused;
    if (w->model->tuning) {
        Dag *dag = w->model->tuning->dag;
        const Ex drawn = subset_at_drawing(w, member, (Ex)determinant);
        const double least = drawing_loss * fabs(at_file);
        const Ex left = ex_sub(dag, ex_op(dag, OP_ABS, drawn, 0, 0), ex_literal(dag, least));
        if (dag->node[drawn].level == LEVEL_VARIABLE)
            *formula =
                ex_op(dag, OP_POSITIVE, left, ex_div(dag, ex_literal(dag, reserve * (determinant_loss / share)), drawn),
                      ex_literal(dag, 0));
    }
    return reserve / at_file;
}

/* True if this factor of the determinant is the guard of a screw or rack: the cosine of how far its turn is from that
 * of its way, 1 wherever the joint holds. */
static bool is_guard_of_gear(const Work *w, Ex factor)
{
    for (int r = 0; r < w->n; ++r)
        if (is_geared(w, &w->connection[w->row_of[r]]) && w->row[r].guard == factor)
            return true;
    return false;
}

/* The determinant of J without constant factors; a constant if all are constant. */
static Ex varying_determinant(const Work *w, const Factors *factors)
{
    Dag *dag = w->dag;
    Ex determinant = ex_literal(dag, 1);
    for (int first = 0; first < factors->n; first = factors_block_end(factors, first))
        if (dag->node[factors->determinant[first]].level == LEVEL_VARIABLE &&
            !is_guard_of_gear(w, factors->determinant[first]))
            determinant = ex_mul(dag, determinant, factors->determinant[first]);
    return determinant;
}

/* True if this is the only joint of its bodies that keeps axes parallel; a closed form then takes directions from it.
 */
static bool joint_gives_directions(const Work *w, const Connection *tie)
{
    for (int i = 0; i < w->connections; ++i) {
        const Connection *other = &w->connection[i];
        if (other == tie || other->is_coordinate || !(joint_parts[w->model->joint[other->index].type] & PART_PARALLEL))
            continue;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                if (tie->end[a].unknown >= 0 && tie->end[a].unknown == other->end[b].unknown)
                    return false;
    }
    return true;
}

Ex determinant_check(Work *w, Formula *formula, const Factors *factors, bool closed)
{
    Dag *dag = w->dag;
    for (int r = 0; r < w->n; ++r) {
        const Connection *tie = &w->connection[w->row_of[r]];
        if (w->row[r].guard && !(closed && (tie->measure >= 0 ? subset_is_hinged : joint_gives_directions)(w, tie)))
            block_check(&formula->solve, w->row[r].guard, false, tie->measure >= 0 ? determinant_loss : 0,
                        GIC_ERROR_SINGULAR);
    }
    const Ex determinant = varying_determinant(w, factors);
    if (dag->node[determinant].level < LEVEL_VARIABLE)
        return 0;
    const Ex scale = subset_constant(w, scale_of_design, (int)determinant, 0);
    ex_describe(dag, scale, "scale of the determinant");
    return ex_mul(dag, scale, determinant);
}

/* The body that carries all bodies of the subset: a rotation in common with it does not bring them nearer to a singular
 * configuration. NULL: the base, or the subset's frame. */
static const Motion *carrier_of(const Work *w)
{
    for (int i = 0; i < w->connections; ++i)
        for (int end = 0; end < 2; ++end)
            if (w->connection[i].end[end].unknown < 0 && w->connection[i].end[end].known < 0)
                return NULL;
    return w->anchored ? NULL : &w->known[0];
}

/* A step beyond the singular configuration would see coordinates turn back while bodies go on into the other assembly
 * mode. The determinant is an angle; rotations (or moves relative to the size) of the bodies reduce it by at most their
 * own amount. */
void determinant_check_ahead(Work *w, Formula *formula, Ex determinant, const Motion *motion)
{
    Dag *dag = w->dag;
    Ex speed = 0;
    if (!determinant)
        return;
    const Motion *carrier = carrier_of(w);
    for (int b = 0; b < w->first->bodies; ++b) {
        Ex turning = 0, gliding = 0;
        for (int i = 0; i < 3; ++i) {
            const Ex relative = carrier ? ex_sub(dag, motion[b].omega[i], carrier->omega[i]) : motion[b].omega[i];
            turning = ex_add(dag, turning, ex_op(dag, OP_ABS, relative, 0, 0));
            gliding = ex_add(dag, gliding, ex_op(dag, OP_ABS, motion[b].velocity[i], 0, 0));
        }
        speed = ex_add(dag, speed, turning ? turning : ex_mul(dag, ex_literal(dag, 1 / w->size), gliding));
    }
    Ex left = ex_sub(dag, determinant, ex_mul(dag, ex_input(dag, element_at(ARRAY_ahead, 0), NULL), speed));
    block_check(&formula->solve, left, false, reserve * determinant_loss, GIC_ERROR_SINGULAR);
}
