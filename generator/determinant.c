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

/* The product of the roots as a determinant, and its reciprocal, for which no division waits for a root. False: it is
 * not as the determinant of J everywhere, `determinant`, but for a factor [members], which samples tell; where geometry
 * can be tuned, it is another one for other values, which no sample has. */
static bool from_roots(Work *w, const Branches *branches, Ex determinant, Ex *product, Ex *reciprocal)
{
    Dag *dag = w->dag;
    Ex root = ex_literal(dag, 1);
    double scale[w->class->members];
    for (int i = 0; i < branches->count; ++i)
        root = ex_mul(dag, root, ex_sqrt(dag, branches->square[i]));
    if (w->model->tuning || !is_steady(w, ex_div(dag, determinant, root)))
        return false;
    for (int i = 0; i < w->class->members; ++i)
        scale[i] = ex_value(dag, determinant, i * w->configurations) / ex_value(dag, root, i * w->configurations);
    /* the factor first: products of squares alone may be too small for single precision */
    Ex factor = ex_constant(dag, scale), square = factor;
    for (int i = 0; i < branches->count; ++i)
        square = ex_mul(dag, square, branches->square[i]);
    *product = ex_mul(dag, factor, root);
    *reciprocal = ex_mul(dag, root, ex_div(dag, ex_literal(dag, 1), square));
    return true;
}

/* Is nothing divided by the k-th pivot but what it solves for itself? */
static bool is_last(const Factors *factors, int k)
{
    for (int r = k + 1; r < factors->n; ++r)
        if (factors->entry[factors->n * r + k])
            return false;
    return true;
}

Ex determinant_check(Work *w, Formula *formula, Factors *factors, const Branches *branches)
{
    Dag *dag = w->dag;
    Ex determinant = 0, before = ex_literal(dag, 1), product, reciprocal;
    int last = -1;
    for (int k = 0; k < w->n; ++k)
        if (dag->node[factors->pivot[k]].level == LEVEL_VARIABLE) {
            before = last < 0 ? before : ex_mul(dag, before, factors->pivot[last]);
            determinant = ex_mul(dag, before, factors->pivot[k]);
            last = k;
        }
    const bool rooted = branches && last >= 0 && is_last(factors, last) && !is_steady(w, determinant) &&
                        from_roots(w, branches, determinant, &product, &reciprocal);
    if (rooted) {
        determinant = product;
        factors->entry[w->n * last + last] = ex_mul(dag, before, reciprocal);
    }
    for (int k = 0; k < w->n; ++k) {
        Ex pivot = factors->pivot[k];
        if (dag->node[pivot].level < LEVEL_VARIABLE || (rooted && k == last))
            continue;
        double usual = 0;
        for (int s = 0; s < dag->samples; ++s)
            usual = fmax(usual, fabs(ex_value(dag, pivot, s)));
        block_check(&formula->solve, pivot, true, pivot_loss * usual, "GIC_ERROR_SINGULAR");
    }
    for (int r = 0; !branches && r < w->n; ++r)
        if (w->row[r].guard)
            block_check(&formula->solve, w->row[r].guard, false, 0, "GIC_ERROR_SINGULAR");
    if (!determinant || is_steady(w, determinant))
        return 0;
    double scale[w->class->members];
    for (int i = 0; i < w->class->members; ++i)
        scale[i] = reserve / ex_value(dag, determinant, i * w->configurations);
    return ex_mul(dag, ex_constant(dag, scale), determinant);
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
