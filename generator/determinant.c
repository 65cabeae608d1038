/* SPDX-License-Identifier: MIT
 * Is a class of subsets near a singular configuration? What emitted code looks at before it goes on. The numbers that
 * say how near is too near are here and nowhere else. */
#include "linear.h"
#include "rows.h"
#include "subset.h"

#include <string.h>

/* A determinant this small relative to that at the design, or of the other sign, means that independence is lost
 * (Serban and Haug 2000, eq. 6). It is the distance to where two solutions meet, as an angle: poses are off by epsilon
 * divided by it, what follows from the matrix there by epsilon divided by its square, and by what chains of bodies make
 * of that. With 1e-3 accelerations at random states next to it were found 1e-7 off (tests/stress/near_singular.sh). */
static const double determinant_loss = 8e-3;
/* Of what the determinant says about the way to there: the design need not be as far from there as can be, and bodies
 * may become faster. */
static const double reserve = 0.5;

/* The determinant of J, but for constant factors, as a share of that at the design. */
static Ex relative_determinant(Work *w, const Factors *factors)
{
    Dag *dag = w->dag;
    Ex determinant = ex_literal(dag, 1);
    double scale[w->class->members];
    for (int first = 0; first < factors->n; first = factors_block_end(factors, first))
        if (dag->node[factors->determinant[first]].level == LEVEL_VARIABLE)
            determinant = ex_mul(dag, determinant, factors->determinant[first]);
    for (int i = 0; i < w->class->members; ++i)
        scale[i] = 1 / ex_value(dag, determinant, i * w->configurations);
    return ex_mul(dag, ex_constant(dag, scale), determinant);
}

static bool same_bodies(const Connection *a, const Connection *b, bool crossed)
{
    return !memcmp(&a->end[0], &b->end[crossed], sizeof a->end[0]) &&
           !memcmp(&a->end[1], &b->end[!crossed], sizeof a->end[1]);
}

/* Does a hinge about this angle's own axis join its bodies? Then the direction that tells the angle stays across the
 * axis, the guard never gets smaller than at the design, and a closed form can't have left its branch. */
static bool angle_is_hinged(const Work *w, const Connection *angle)
{
    for (int i = 0; i < w->connections; ++i) {
        const Connection *tie = &w->connection[i];
        if (tie->is_coordinate || !(joint_parts[w->model->joint[tie->index].type] & PART_PARALLEL))
            continue;
        for (int crossed = 0; crossed < 2; ++crossed)
            if (same_bodies(angle, tie, crossed)) {
                Ex opposite[3];
                const Ex *axis = tie->fixture.axis[crossed];
                ex_scale3(w->dag, ex_literal(w->dag, -1), axis, opposite);
                if (!memcmp(angle->fixture.axis[0], axis, sizeof opposite) ||
                    !memcmp(angle->fixture.axis[0], opposite, sizeof opposite))
                    return true;
            }
    }
    return false;
}

/* Is this the only joint of its bodies that keeps axes parallel? Then a closed form takes directions from it. */
static bool joint_gives_directions(const Work *w, const Connection *tie)
{
    for (int i = 0; i < w->connections; ++i) {
        const Connection *other = &w->connection[i];
        if (other == tie || other->is_coordinate ||
            !(joint_parts[w->model->joint[other->index].type] & PART_PARALLEL))
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
        if (w->row[r].guard &&
            !(closed && (tie->is_coordinate ? angle_is_hinged : joint_gives_directions)(w, tie)))
            block_check(&formula->solve, w->row[r].guard, false, 0, "GIC_ERROR_SINGULAR");
    }
    const Ex determinant = relative_determinant(w, factors);
    return dag->node[determinant].level == LEVEL_VARIABLE ? ex_mul(dag, ex_literal(dag, reserve), determinant) : 0;
}

/* A step that passes the place would see the coordinates turn back there, and miss that the bodies go on, into the
 * other assembly mode. The determinant is an angle, which bodies that turn, or glide, at most reduce by theirs. */
void determinant_check_ahead(Work *w, Formula *formula, Ex determinant, const Motion *motion)
{
    Dag *dag = w->dag;
    Ex speed = 0;
    if (!determinant)
        return;
    for (int b = 0; b < w->first->bodies; ++b) {
        Ex turning = 0, gliding = 0;
        for (int i = 0; i < 3; ++i) {
            turning = ex_add(dag, turning, ex_op(dag, OP_ABS, motion[b].omega[i], 0, 0));
            gliding = ex_add(dag, gliding, ex_op(dag, OP_ABS, motion[b].velocity[i], 0, 0));
        }
        speed = ex_add(dag, speed, turning ? turning : ex_mul(dag, ex_literal(dag, 1 / w->size), gliding));
    }
    Ex left = ex_sub(dag, determinant, ex_mul(dag, ex_input(dag, "ahead[0]", NULL), speed));
    block_check(&formula->solve, left, false, reserve * determinant_loss, "GIC_ERROR_SINGULAR");
}
