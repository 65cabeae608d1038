/* SPDX-License-Identifier: MIT
 * Is a class of subsets near a singular configuration? What emitted code looks at before it goes on. The numbers that
 * say how near is too near are here and nowhere else. */
#include "linear.h"
#include "rows.h"
#include "subset.h"

#include <math.h>
#include <string.h>

/* A determinant this small relative to that at the design, or of the other sign, means that independence is lost
 * (Serban and Haug 2000, eq. 6). It is the distance to where two solutions meet, as an angle: poses are off by epsilon
 * divided by it, what follows from the matrix there by epsilon divided by its square, and by what chains of bodies make
 * of that. With 1e-3 accelerations at random states next to it were found 1e-7 off (tests/stress/near_singular.sh). The
 * same of a direction that tells an angle: what is left of it across the axis. */
static const double determinant_loss = 8e-3;
/* A design that is worse conditioned than most has less to lose: the condition, times 2.4 or more for the ratio of the
 * largest to the least singular value, may become this before the determinant's share says stop. 2.2e-16 times its
 * square is what accelerations are promised to, 1e-8. */
static const double worst_condition = 2500;
/* Of what the determinant says about the way to there: the design need not be as far from there as can be, and bodies
 * may become faster. */
static const double reserve = 0.5;

/* A drawing with tuned geometry whose determinant is less than this share of the file's is singular itself. */
static const double drawing_loss = 1e-4;

double subset_condition(const Work *w, int s)
{
    double A[w->n * w->n];
    for (int i = 0; i < w->n * w->n; ++i)
        A[i] = ex_value(w->dag, w->J[i], s) / (i % w->n % 6 < 3 ? w->size : 1);
    return linear_condition(w->n, A);
}

double subset_singular_share(const Work *w, int s)
{
    return fmax(determinant_loss, subset_condition(w, s) / worst_condition);
}

/* What makes a determinant relative to that at the design; where geometry is tuned, at the drawing with the values of
 * the parameters. */
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
            *formula = ex_op(dag, OP_POSITIVE, left,
                             ex_div(dag, ex_literal(dag, reserve * (determinant_loss / share)), drawn),
                             ex_literal(dag, 0));
    }
    return reserve / at_file;
}

/* The determinant of J, but for constant factors; a constant where all of them are. */
static Ex varying_determinant(Dag *dag, const Factors *factors)
{
    Ex determinant = ex_literal(dag, 1);
    for (int first = 0; first < factors->n; first = factors_block_end(factors, first))
        if (dag->node[factors->determinant[first]].level == LEVEL_VARIABLE)
            determinant = ex_mul(dag, determinant, factors->determinant[first]);
    return determinant;
}

/* Is this the only joint of its bodies that keeps axes parallel? Then a closed form takes directions from it. */
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
        if (w->row[r].guard && !(closed && (tie->is_coordinate ? subset_is_hinged : joint_gives_directions)(w, tie)))
            block_check(&formula->solve, w->row[r].guard, false, tie->is_coordinate ? determinant_loss : 0,
                        "GIC_ERROR_SINGULAR");
    }
    const Ex determinant = varying_determinant(dag, factors);
    if (dag->node[determinant].level < LEVEL_VARIABLE)
        return 0;
    return ex_mul(dag, subset_constant(w, scale_of_design, (int)determinant, 0), determinant);
}

/* A body that carries all others: a rotation that they have in common brings none of them nearer to a singular
 * configuration. NULL: the base, or the subset's frame. */
static const Motion *carrier_of(const Work *w)
{
    for (int i = 0; i < w->connections; ++i)
        for (int end = 0; end < 2; ++end)
            if (w->connection[i].end[end].unknown < 0 && w->connection[i].end[end].known < 0)
                return NULL;
    return w->anchored ? NULL : &w->known[0];
}

/* A step that passes the place would see the coordinates turn back there, and miss that the bodies go on, into the
 * other assembly mode. The determinant is an angle, which bodies that turn, or glide, at most reduce by theirs. */
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
    Ex left = ex_sub(dag, determinant, ex_mul(dag, ex_input(dag, "ahead[0]", NULL), speed));
    block_check(&formula->solve, left, false, reserve * determinant_loss, "GIC_ERROR_SINGULAR");
}
