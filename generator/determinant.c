/* SPDX-License-Identifier: MIT
 * Is a class of subsets near a singular configuration? What emitted code looks at before it goes on. The numbers that
 * say how near is too near are here and nowhere else. */
#include "subset.h"

#include <math.h>

/* A determinant this small relative to that at the design, or of the other sign, means that independence is lost
 * (Serban and Haug 2000, eq. 6). It is the distance to where two solutions meet, as an angle: poses are off by epsilon
 * divided by it, what follows from the matrix there by epsilon divided by its square, and by what chains of bodies make
 * of that. With 1e-3 accelerations at random states next to it were found 1e-7 off (tests/stress/near_singular.sh). */
static const double determinant_loss = 8e-3;
/* Of what the determinant says about the way to there: the design need not be as far from there as can be, and bodies
 * may become faster. */
static const double reserve = 0.5;
/* A pivot this much smaller than at any sample makes multipliers so large that they cost as many digits. */
static const double pivot_loss = 1e-4;

/* Is it the same in all configurations, as of a body that turns about a joint by an angle? A wheel may spin. */
static bool is_steady(const Work *w, Ex e)
{
    const double rounding = 1e-9;
    int seen = 0;
    for (int s = 0; s < w->dag->samples; ++s) {
        const double design = ex_value(w->dag, e, s / w->configurations * w->configurations);
        if (!w->alive[s] || s % w->configurations == 0)
            continue;
        ++seen;
        if (!(fabs(ex_value(w->dag, e, s) - design) <= rounding * fabs(design)))
            return false;
    }
    return seen > 0;
}

Ex determinant_check(Work *w, Formula *formula, const Factors *factors, bool guarded)
{
    Ex determinant = 0;
    for (int k = 0; k < w->n; ++k) {
        Ex pivot = factors->pivot[k];
        if (w->dag->node[pivot].level < LEVEL_VARIABLE)
            continue;
        double usual = 0;
        for (int s = 0; s < w->dag->samples; ++s)
            usual = fmax(usual, fabs(ex_value(w->dag, pivot, s)));
        block_check(&formula->solve, pivot, true, pivot_loss * usual, "GIC_ERROR_SINGULAR");
        determinant = determinant ? ex_mul(w->dag, determinant, pivot) : pivot;
    }
    for (int r = 0; guarded && r < w->n; ++r)
        if (w->row[r].guard)
            block_check(&formula->solve, w->row[r].guard, false, 0, "GIC_ERROR_SINGULAR");
    if (!determinant || is_steady(w, determinant))
        return 0;
    double scale[w->class->members];
    for (int i = 0; i < w->class->members; ++i)
        scale[i] = reserve / ex_value(w->dag, determinant, i * w->configurations);
    return ex_mul(w->dag, ex_constant(w->dag, scale), determinant);
}

/* The determinant may not be lost before `ahead` is over, either: a step that passes the place would see the
 * coordinates turn back there, and miss that the bodies go on, into the other assembly mode. It is an angle, which
 * bodies that turn, or glide, at most reduce by theirs. */
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
