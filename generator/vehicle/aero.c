/* SPDX-License-Identifier: MIT
 * Forces of the air on a body (FORMAT.md section 7.2), in the axes of the body. */
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/forces.h"
#include "vehicle/vehicle.h"

/* A formula of the element; 0 where it has none. */
static Ex law_at(Whole *whole, const Force *force, int law, const Ex *local)
{
    return force->law[law] ? whole_law(whole, force->law[law], local) : 0;
}

/* Velocity of the element's point and, less that, of the wind, both in the axes of the body. */
static void motions(Whole *whole, const Force *force, Ex own[3], Ex wind[3])
{
    Dag *dag = whole->dag;
    const Vector point = whole_point(whole, force->body[0], force->point[0]);
    const Ex *A = whole->motion[force->body[0]].A;
    Ex v[3], world[3];
    for (int i = 0; i < 3; ++i)
        world[i] = law_at(whole, force, AERO_WIND + i, NULL);
    whole_velocity_in_base(whole, &point, v);
    ex_apply_transposed(dag, A, v, own);
    ex_apply_transposed(dag, whole->R, world, v);
    ex_apply_transposed(dag, A, v, wind);
}

/* Incidence, sideslip and speed of the motion through the air. The angles have no value where the component that they
 * are taken of has none: 0 there, and so are their derivatives, and that of a speed whose square is too small for a
 * number. */
static void airflow(Dag *dag, const Ex u[3], Ex local[FORCE_LOCALS])
{
    const Ex level = ex_add(dag, ex_mul(dag, u[0], u[0]), ex_mul(dag, u[1], u[1]));
    const Ex square = ex_add(dag, level, ex_mul(dag, u[2], u[2]));
    const Ex rise = ex_op(dag, OP_ATAN2, ex_neg(dag, u[2]), ex_sqrt(dag, level), 0);
    local[AERO_INCIDENCE] = ex_op(dag, OP_POSITIVE, square, rise, 0);
    local[AERO_SIDESLIP] = ex_op(dag, OP_POSITIVE, level, ex_op(dag, OP_ATAN2, u[1], u[0], 0), 0);
    local[AERO_SPEED] = ex_op(dag, OP_POSITIVE, square, ex_sqrt(dag, square), 0);
}

void aero_wrench(Whole *whole, const Force *force, Ex value[6], Ex size[2])
{
    Dag *dag = whole->dag;
    Ex own[3], wind[3], u[3], local[FORCE_LOCALS], coefficients[2] = {0};
    motions(whole, force, own, wind);
    ex_sub3(dag, own, wind, u);
    airflow(dag, u, local);
    const Ex density = ex_mul(dag, ex_literal(dag, 0.5), whole_law(whole, force->law[AERO_DENSITY], NULL));
    const Ex share =
        ex_mul(dag, density, whole_law(whole, force->area, NULL)); /* of the dynamic pressure, times area */
    const Ex speed = local[AERO_SPEED], drag = law_at(whole, force, AERO_DRAG, local);
    const Ex length = force->length ? whole_law(whole, force->length, NULL) : 0;
    for (int i = 0; i < 6; ++i) {
        const Ex coefficient = law_at(whole, force, i, local);
        Ex along = ex_mul(dag, coefficient, speed);
        along = i < 3 ? ex_sub(dag, along, ex_mul(dag, drag, u[i])) : ex_mul(dag, length, along);
        value[i] = ex_mul(dag, ex_mul(dag, share, speed), along);
        coefficients[i / 3] = ex_add(dag, coefficients[i / 3], ex_op(dag, OP_ABS, coefficient, 0, 0));
    }
    Ex most = 0; /* of the speed through the air, before own motion and wind cancel */
    for (int i = 0; i < 3; ++i)
        most = ex_add(dag, most, ex_add(dag, ex_op(dag, OP_ABS, own[i], 0, 0), ex_op(dag, OP_ABS, wind[i], 0, 0)));
    const Ex pressure = ex_mul(dag, ex_op(dag, OP_ABS, share, 0, 0), ex_mul(dag, most, most));
    coefficients[0] = ex_add(dag, coefficients[0], ex_op(dag, OP_ABS, drag, 0, 0));
    size[0] = ex_mul(dag, pressure, coefficients[0]);
    size[1] = ex_mul(dag, ex_mul(dag, pressure, length), coefficients[1]);
}
