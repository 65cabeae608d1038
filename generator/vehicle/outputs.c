/* SPDX-License-Identifier: MIT
 * Outputs by name (FORMAT.md section 9) and the poses of all bodies. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Rotation of a body to the world. */
static void body_rotation(Whole *whole, int body, Ex A[9])
{
    Dag *dag = whole->dag;
    for (int i = 0; i < 9; ++i)
        A[i] = i % 4 == 0 ? ex_literal(dag, 1) : 0;
    if (body == BODY_GROUND)
        return;
    const Ex *own = whole->motion[body].A, *R = whole->R;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            A[3 * i + j] = ex_dot(dag, R + 3 * i, (Ex[]){own[j], own[3 + j], own[6 + j]});
}

/* A vector from base axes into the frame that an output asks for. */
static void express(Whole *whole, int in, const Ex base[3], Ex out[3])
{
    if (in == BODY_GROUND)
        ex_apply(whole->dag, whole->R, base, out);
    else
        ex_apply_transposed(whole->dag, whole->motion[in].A, base, out);
}

/* Euler parameters of a rotation from the largest of the four squares, which is at least 1/4. Row i of the symmetric
 * matrix 4 p p^T is 4 p_i p. */
static void euler_of_rotation(Dag *dag, const Ex A[9], Ex p[4])
{
    Ex K[4][4], one = ex_literal(dag, 1), largest, row[4];
    K[0][0] = ex_add(dag, one, ex_add(dag, A[0], ex_add(dag, A[4], A[8])));
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        K[1 + i][1 + i] = ex_add(dag, one, ex_sub(dag, A[4 * i], ex_add(dag, A[4 * j], A[4 * k])));
        K[0][1 + i] = K[1 + i][0] = ex_sub(dag, A[3 * k + j], A[3 * j + k]);
        K[1 + j][1 + k] = K[1 + k][1 + j] = ex_add(dag, A[3 * k + j], A[3 * j + k]);
    }
    largest = K[0][0];
    memcpy(row, K[0], sizeof row);
    for (int i = 1; i < 4; ++i) {
        Ex more = ex_sub(dag, K[i][i], largest);
        for (int j = 0; j < 4; ++j)
            row[j] = ex_op(dag, OP_POSITIVE, more, K[i][j], row[j]);
        largest = ex_op(dag, OP_MAX, K[i][i], largest, 0);
    }
    Ex scale = ex_div(dag, ex_literal(dag, 0.5), ex_sqrt(dag, largest));
    for (int i = 0; i < 4; ++i)
        p[i] = ex_mul(dag, row[i], scale);
}

/* World Euler parameters of a body: base times relative. */
static void body_euler(Whole *whole, int body, Ex p[4])
{
    Dag *dag = whole->dag;
    if (body == BODY_BASE || body == BODY_GROUND) {
        for (int i = 0; i < 4; ++i)
            p[i] = body == BODY_BASE ? whole->e[i] : ex_literal(dag, i == 0);
        return;
    }
    Ex own[4], cross[3], product[4];
    euler_of_rotation(dag, whole->motion[body].A, own);
    const Ex *e = whole->e;
    product[0] = ex_sub(dag, ex_mul(dag, e[0], own[0]), ex_dot(dag, e + 1, own + 1));
    ex_cross(dag, e + 1, own + 1, cross);
    for (int i = 0; i < 3; ++i)
        product[1 + i] =
            ex_add(dag, ex_add(dag, ex_mul(dag, e[0], own[1 + i]), ex_mul(dag, own[0], e[1 + i])), cross[i]);
    for (int i = 0; i < 4; ++i) /* -0 keeps e0 >= 0 */
        p[i] = ex_op(dag, OP_POSITIVE, product[0], product[i], ex_neg(dag, product[i]));
}

static void tire_components(Whole *whole, int wheel, Ex *out)
{
    static const int from_grip[] = {GRIP_TIRE,     GRIP_TIRE + 1, GRIP_TIRE + 2, GRIP_TIRE + 3,
                                    GRIP_TIRE + 4, GRIP_KAPPA,    GRIP_TANGENT,  GRIP_CAMBER};
    for (int i = 0; i < 8; ++i)
        out[i] = whole_grip(whole, wheel, from_grip[i]);
    out[6] = ex_op(whole->dag, OP_ATAN, out[6], 0, 0);
    out[8] = whole_fast(whole, ARRAY_y, wheel, FAST_SPIN);
    out[9] = whole->accelerated ? whole_fast(whole, ARRAY_rate, wheel, FAST_SPIN) : 0;
    out[10] = whole_grip(whole, wheel, GRIP_DRIVE);
    out[11] = whole_grip(whole, wheel, GRIP_BRAKE);
}

static void output_components(Whole *whole, const Output *output, Ex out[OUTPUT_MAX_COMPONENTS])
{
    const Accelerated *at = whole->accelerated;
    Dag *dag = whole->dag;
    Vector point = {.point = true};
    Ex t[3], A[9];
    if (output->type == OUTPUT_POSITION || output->type == OUTPUT_VELOCITY || output->type == OUTPUT_ACCELERATION)
        point = whole_point(whole, output->body, output->point);
    switch (output->type) {
    case OUTPUT_POSITION: whole_position(whole, &point, out); break;
    case OUTPUT_VELOCITY:
        if (output->in == BODY_GROUND) {
            whole_velocity(whole, &point, out);
        } else {
            whole_velocity_in_base(whole, &point, t);
            express(whole, output->in, t, out);
        }
        break;
    case OUTPUT_ACCELERATION:
        whole_acceleration(whole, output->body, &point, at->alpha, at->a, at->w2, t);
        ex_add3(dag, t, whole->gravity, t);
        express(whole, output->in, t, out);
        break;
    case OUTPUT_ORIENTATION: body_euler(whole, output->body, out); break;
    case OUTPUT_ROLL_PITCH_YAW: {
        body_rotation(whole, output->body, A);
        Ex one = ex_literal(dag, 1),
           sine = ex_op(dag, OP_MIN, ex_op(dag, OP_MAX, ex_neg(dag, A[6]), ex_literal(dag, -1), 0), one, 0);
        out[0] = ex_op(dag, OP_ATAN2, A[7], A[8], 0);
        out[1] = ex_op(dag, OP_ASIN, sine, 0, 0);
        out[2] = ex_op(dag, OP_ATAN2, A[3], A[0], 0);
        break;
    }
    case OUTPUT_ANGULAR_VELOCITY:
        ex_zero3(dag, t);
        if (output->body != BODY_GROUND)
            ex_add3(dag, whole->turn, whole->motion[output->body].omega, t);
        express(whole, output->in, t, out);
        break;
    case OUTPUT_COORDINATE:
        out[0] = whole->x[output->index];
        out[1] = whole->xd[output->index];
        out[2] = at ? at->w2[output->index] : 0;
        break;
    case OUTPUT_FORCE: out[0] = whole->loads->element[output->index]; break;
    case OUTPUT_DRIVE_FORCE:
        out[0] = whole->plan->solve == SOLVE_AUGMENTED ? whole_drive_reaction(whole, output->index)
                                                       : whole_drive_force(whole, output->index);
        break;
    case OUTPUT_REACTION: {
        Ex force[3], torque[3];
        whole_reaction(whole, output->index, force, torque);
        express(whole, output->in, force, out);
        express(whole, output->in, torque, out + 3);
        break;
    }
    case OUTPUT_WHEEL: memcpy(out, whole->loads->wheel[output->index], 4 * sizeof *out); break;
    case OUTPUT_TIRE: tire_components(whole, output->index, out); break;
    case OUTPUT_CONTACT:
        for (int i = 0; i < 3; ++i)
            out[i] = whole_grip(whole, output->index, GRIP_POINT + i);
        out[2] = ex_add(dag, out[2], whole_post(whole, &whole->model->wheel[output->index], 0));
        break;
    case OUTPUT_POWERTRAIN:
        for (int i = 0; i < output->count; ++i)
            out[i] = whole_watch(whole, i);
        break;
    case OUTPUT_ENERGY: {
        out[0] = 0;
        out[1] = whole->loads->potential;
        out[2] = whole_power(whole, whole->loads);
        Ex half = ex_literal(dag, 0.5);
        for (int i = 0; i < whole->model->wheels; ++i) {
            const Wheel *wheel = &whole->model->wheel[i];
            if (wheel->tire < 0)
                continue;
            Ex spin = whole_fast(whole, ARRAY_y, i, FAST_SPIN);
            Ex turning = ex_mul(dag, ex_literal(dag, 0.5 * wheel->spin_inertia), ex_mul(dag, spin, spin));
            out[0] = ex_add(dag, out[0], turning);
        }
        for (int b = whole->model->free_base ? 0 : 1; b < whole->model->bodies; ++b) {
            const Body *body = &whole->model->body[b];
            Ex v[3], total[3], J[6], gravity[3], mass = whole_number(whole, &body->mass);
            Vector com = whole_point(whole, b, body->com);
            whole_velocity(whole, &com, v);
            ex_add3(dag, whole->turn, whole->motion[b].omega, total);
            whole_inertia(whole, b, J);
            ex_apply(dag, (Ex[]){J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]}, total, t);
            Ex twice = ex_add(dag, ex_mul(dag, mass, ex_dot(dag, v, v)), ex_dot(dag, total, t));
            out[0] = ex_add(dag, out[0], ex_mul(dag, half, twice));
            for (int i = 0; i < 3; ++i)
                gravity[i] = whole_number(whole, &whole->model->gravity[i]);
            whole_position(whole, &com, t);
            out[1] = ex_sub(dag, out[1], ex_mul(dag, mass, ex_dot(dag, gravity, t)));
        }
        break;
    }
    case OUTPUT_SIGNAL: out[0] = whole_signal(whole, output->index); break;
    default: break;
    }
}

Ex whole_signal(Whole *whole, int index)
{
    const Signal *signal = &whole->model->signal[index];
    if (signal->law)
        return whole_law(whole, signal->law, NULL);
    if (whole->linked)
        return whole->linked[index];
    Ex out[OUTPUT_MAX_COMPONENTS] = {0};
    output_components(whole, &signal->output, out);
    return out[signal->component];
}

Block *outputs_block(Whole *whole)
{
    Dag *dag = whole->dag;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    Accelerated accelerated;
    whole_accelerations(whole, accelerated.alpha, accelerated.a, &accelerated.w2);
    loads_make(whole);
    whole->accelerated = &accelerated;
    int index = 0;
    for (int i = 0; i < whole->model->outputs; ++i) {
        Ex out[OUTPUT_MAX_COMPONENTS] = {0};
        dag_section(dag, pool_print(dag->pool, "output %s", whole->model->output[i].name));
        output_components(whole, &whole->model->output[i], out);
        for (int c = 0; c < whole->model->output[i].count; ++c)
            block_store(block, out[c], element_at(ARRAY_out, index++));
    }
    whole->accelerated = NULL;
    return block;
}

Block *contacts_block(Whole *whole)
{
    Dag *dag = whole->dag;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    const Loads *loads = loads_make(whole);
    for (int i = 0; i < loads->presses && i < GIC_CONTACTS; ++i)
        block_store(block, loads->press[i], element_at(ARRAY_press, i));
    return block->stores ? block : NULL;
}

Block *poses_block(Whole *whole)
{
    Dag *dag = whole->dag;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    for (int b = 0; b < whole->model->bodies; ++b) {
        dag_section(dag, pool_print(dag->pool, "pose of %s", whole->model->body[b].name));
        Ex at[3], p[4];
        Vector origin = whole_point(whole, b, (const double[3]){0, 0, 0});
        whole_position(whole, &origin, at);
        body_euler(whole, b, p);
        for (int i = 0; i < 3; ++i)
            block_store(block, at[i], element_at(ARRAY_pose, 7 * b + i));
        for (int i = 0; i < 4; ++i)
            block_store(block, p[i], element_at(ARRAY_pose, 7 * b + 3 + i));
    }
    return block;
}
