/* SPDX-License-Identifier: MIT
 * Bushings (FORMAT.md section 7.5): displacement and rotation of their second end against the first, in the axes of the
 * first, and the force and torque that do their work. */
#include "expression/expression.h"
#include "model/model.h"
#include "subset/subset.h"
#include "vehicle/forces.h"
#include "vehicle/vehicle.h"

/* The axes of one end in the base frame, one a row: the matrix that takes vectors to components along them. */
static void axes_of(Whole *whole, const Force *force, int end, Ex axis[9])
{
    for (int k = 0; k < 3; ++k) {
        Ex local[3];
        for (int i = 0; i < 3; ++i)
            local[i] = whole_number(whole, &force->bushing->frame[end][3 * i + k]);
        force_direction(whole, force->body[end], local, axis + 3 * k);
    }
}

/* With the rotation by an angle t about n: g = tan(t / 2) n, a = (t / 2) / tan(t / 2), b = (1 - a) / tan^2(t / 2), so
 * that the rotation vector t n is 2 a g. Both are smooth at 0, where a series stands for them. */
typedef struct Turn {
    Ex g[3], a, b;
} Turn;

static Turn turn_of(Dag *dag, const Ex first[9], const Ex second[9])
{
    static const double small = 1.0 / 64;
    enum { TERMS = 9 }; /* the next one is below small^9 / 21 = 3e-18 */
    Turn turn;
    Ex sine[3], cosine = ex_literal(dag, -0.5);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Ex twice =
            ex_sub(dag, ex_dot(dag, first + 3 * k, second + 3 * j), ex_dot(dag, first + 3 * j, second + 3 * k));
        sine[i] = ex_mul(dag, ex_literal(dag, 0.5), twice);
        cosine = ex_add(dag, cosine, ex_mul(dag, ex_literal(dag, 0.5), ex_dot(dag, first + 3 * i, second + 3 * i)));
    }
    /* nothing finite beyond 3 rad: the direction turns round at half a turn */
    const Ex one = ex_literal(dag, 1), whole = ex_add(dag, one, cosine);
    const Ex within = ex_sub(dag, cosine, ex_literal(dag, BUSHING_COSINE));
    ex_scale3(dag, ex_div(dag, one, ex_op(dag, OP_POSITIVE, within, whole, 0)), sine, turn.g);
    const Ex square = ex_dot(dag, turn.g, turn.g), large = ex_sub(dag, square, ex_literal(dag, small));
    Ex series = 0;
    for (int k = TERMS - 1; k >= 0; --k) /* 1/3 - x/5 + x^2/7 ... */
        series = ex_add(dag, ex_literal(dag, (k % 2 ? -1.0 : 1.0) / (2 * k + 3)), ex_mul(dag, square, series));
    const Ex most = ex_op(dag, OP_MAX, square, ex_literal(dag, small), 0), root = ex_sqrt(dag, most);
    const Ex half = ex_div(dag, ex_op(dag, OP_ATAN, root, 0, 0), root);
    turn.a = ex_op(dag, OP_POSITIVE, large, half, ex_sub(dag, one, ex_mul(dag, square, series)));
    turn.b = ex_op(dag, OP_POSITIVE, large, ex_div(dag, ex_sub(dag, one, half), most), series);
    return turn;
}

/* a (v + s g x v) + b g (g . v): the rate of the rotation vector for v the angular velocity and s = -1; the torque for
 * v what does work with that rate and s = 1. */
static void turned(Dag *dag, const Turn *turn, bool opposite, const Ex v[3], Ex out[3])
{
    Ex across[3], along[3];
    ex_cross(dag, turn->g, v, across);
    (opposite ? ex_sub3 : ex_add3)(dag, v, across, out);
    ex_scale3(dag, turn->a, out, out);
    ex_scale3(dag, ex_mul(dag, turn->b, ex_dot(dag, turn->g, v)), turn->g, along);
    ex_add3(dag, out, along, out);
}

static Ex magnitudes(Dag *dag, const Ex v[3])
{
    Ex sum = 0;
    for (int i = 0; i < 3; ++i)
        sum = ex_add(dag, sum, ex_op(dag, OP_ABS, v[i], 0, 0));
    return sum;
}

/* out = matrix times x, and the sums of the magnitudes of the terms, of which x are differences of `size`. */
static void product(Whole *whole, const Law *const matrix[BUSHING_NUMBERS], const Ex x[BUSHING_AXES],
                    const Ex size[BUSHING_AXES], Ex out[BUSHING_AXES], Ex terms[2])
{
    Dag *dag = whole->dag;
    for (int i = 0; i < BUSHING_AXES; ++i) {
        out[i] = 0;
        for (int j = 0; j < BUSHING_AXES; ++j) {
            const Law *law = matrix[bushing_place(i, j)];
            const Ex number = law ? whole_law(whole, law, NULL) : 0;
            out[i] = ex_add(dag, out[i], ex_mul(dag, number, x[j]));
            terms[i / 3] = ex_add(dag, terms[i / 3], ex_mul(dag, ex_op(dag, OP_ABS, number, 0, 0), size[j]));
        }
    }
}

/* Angular velocity of an end relative to the base. */
static void omega_of(Whole *whole, int body, Ex out[3])
{
    ex_zero3(whole->dag, out);
    if (body == BODY_GROUND)
        ex_sub3(whole->dag, out, whole->turn, out);
    else
        ex_add3(whole->dag, out, whole->motion[body].omega, out);
}

BushingLoad bushing_load(Whole *whole, const Force *force)
{
    Dag *dag = whole->dag;
    BushingLoad load = {.potential = 0};
    Ex axis[2][9], omega[2][3], v[3], swept[3], turning[3];
    Ex local[FORCE_LOCALS], size[FORCE_LOCALS], elastic[BUSHING_AXES], viscous[BUSHING_AXES], Q[BUSHING_AXES];
    for (int i = 0; i < 2; ++i) {
        load.end[i] = whole_point(whole, force->body[i], force->point[i]);
        axes_of(whole, force, i, axis[i]);
        omega_of(whole, force->body[i], omega[i]);
    }
    ex_sub3(dag, load.end[1].v, load.end[0].v, load.arm);
    /* velocity of the second point as the first body sees it */
    ex_sub3(dag, load.end[1].rate, load.end[0].rate, v);
    ex_cross(dag, omega[0], load.arm, swept);
    ex_sub3(dag, v, swept, v);
    ex_sub3(dag, omega[1], omega[0], turning);
    const Turn turn = turn_of(dag, axis[0], axis[1]);
    ex_apply(dag, axis[0], load.arm, local);
    ex_scale3(dag, ex_add(dag, turn.a, turn.a), turn.g, local + 3);
    ex_apply(dag, axis[0], v, local + BUSHING_AXES);
    ex_apply(dag, axis[0], turning, v);
    turned(dag, &turn, true, v, local + BUSHING_AXES + 3);
    for (int k = 0; k < FORCE_LOCALS; ++k)
        size[k] = ex_literal(dag, 1);
    for (int k = 0; k < 3 && whole->sized; ++k) { /* of what cancels */
        size[k] = ex_add(dag, magnitudes(dag, load.end[0].v), magnitudes(dag, load.end[1].v));
        size[BUSHING_AXES + 3 + k] = ex_add(dag, magnitudes(dag, omega[0]), magnitudes(dag, omega[1]));
        size[BUSHING_AXES + k] =
            ex_add(dag, ex_add(dag, magnitudes(dag, load.end[0].rate), magnitudes(dag, load.end[1].rate)),
                   ex_mul(dag, size[BUSHING_AXES + 3 + k], size[k]));
    }
    product(whole, force->bushing->stiffness, local, size, elastic, load.size);
    product(whole, force->bushing->damping, local + BUSHING_AXES, size + BUSHING_AXES, viscous, load.size);
    for (int i = 0; i < BUSHING_AXES; ++i) {
        const Ex given = force->law[i] ? whole_law(whole, force->law[i], local) : 0;
        const Ex rate = local[BUSHING_AXES + i], other = ex_sub(dag, given, viscous[i]);
        load.size[i / 3] = ex_add(dag, load.size[i / 3], ex_op(dag, OP_ABS, given, 0, 0));
        Q[i] = ex_sub(dag, other, elastic[i]);
        const Ex twice = ex_mul(dag, elastic[i], local[i]);
        load.potential = ex_add(dag, load.potential, ex_mul(dag, ex_literal(dag, 0.5), twice));
        load.potential_rate = ex_add(dag, load.potential_rate, ex_mul(dag, elastic[i], rate));
        load.power = ex_add(dag, load.power, ex_mul(dag, other, rate));
    }
    for (int i = 0; i < BUSHING_AXES; ++i)
        Q[i] = load_part(whole, Q[i], load_is_internal(force));
    turned(dag, &turn, false, Q + 3, v);
    ex_apply_transposed(dag, axis[0], Q, load.force);
    ex_apply_transposed(dag, axis[0], v, load.torque);
    return load;
}
