/* SPDX-License-Identifier: MIT
 * Poses of bodies in the drawing, as formulas of geometric parameters. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "subset/subset.h"

/* The reference point of a body in the drawing. */
static void reference_drawn(const Model *model, const double (*from)[3], int body, Ex out[3])
{
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], origin[3], offset[3];
    mat_from_euler(model->drawn[body].euler, A);
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    for (int i = 0; i < 3; ++i)
        origin[i] = tuned_or_fixed(model, &from[body][i]);
    ex_apply(dag, turn, origin, offset);
    for (int i = 0; i < 3; ++i)
        out[i] = ex_add(dag, tuned_or_fixed(model, &model->drawn[body].position[i]), offset[i]);
}

void body_drawn(const Model *model, const double (*origin)[3], int anchor, int body, Ex c[3], double p[4])
{
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], own[3], from[3];
    reference_drawn(model, origin, body, own);
    reference_drawn(model, origin, anchor, from);
    ex_sub3(dag, own, from, own);
    mat_from_euler(model->drawn[anchor].euler, A);
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    ex_apply_transposed(dag, turn, own, c);
    euler_relative(model->drawn[anchor].euler, model->drawn[body].euler, p);
}
