/* SPDX-License-Identifier: MIT
 * Applied forces (FORMAT.md sections 7 and 8), body by body and as generalised forces. */
#include "gicgen.h"

/* A force F (base frame) on a point of a body. */
static void push(Whole *whole, Loads *loads, int body, const Vector *point, const Ex F[3])
{
    Dag *dag = whole->dag;
    if (body == BODY_GROUND)
        return;
    Ex moment[3], *wrench = loads->wrench[body];
    ex_cross(dag, point->arm, F, moment);
    ex_add3(dag, wrench, moment, wrench);
    ex_add3(dag, wrench + 3, F, wrench + 3);
}

/* What acts on the bodies as forces on everything and along the coordinates. */
static void project(Whole *whole, Loads *loads)
{
    Dag *dag = whole->dag;
    for (int w = 0; w < whole->model->coordinates; ++w)
        loads->along[w] = loads->own[w];
    for (int b = 0; b < whole->model->bodies; ++b) {
        const Ex *moment = loads->wrench[b], *force = moment + 3;
        Ex t[3];
        ex_cross(dag, whole->motion[b].c, force, t);
        ex_add3(dag, loads->moment, t, loads->moment);
        ex_add3(dag, loads->moment, moment, loads->moment);
        ex_add3(dag, loads->force, force, loads->force);
        for (int j = 0; b != BODY_BASE && j < whole_subset(whole, b)->deps; ++j) {
            const Ex *S = whole->motion[b].S + 6 * j;
            Ex *along = &loads->along[whole_subset(whole, b)->dep[j]];
            *along = ex_add(dag, *along, ex_add(dag, ex_dot(dag, moment, S), ex_dot(dag, force, S + 3)));
        }
    }
}

/* A formula as an expression; local: what its place offers. */
static Ex law_value(Whole *whole, const Law *law, const Ex *local)
{
    Dag *dag = whole->dag;
    const Model *model = whole->model;
    Ex arg[3] = {0};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = law_value(whole, law->arg[i], local);
    switch (law->op) {
    case LAW_NUMBER: return ex_literal(dag, law->number);
    case LAW_PARAMETER: {
        const Parameter *parameter = &model->parameter[law->index];
        if (!parameter->tunable)
            return ex_literal(dag, parameter->value);
        return ex_input(dag, pool_print(dag->pool, "p[%d]", parameter->index), NULL);
    }
    case LAW_INPUT: return ex_input(dag, pool_print(dag->pool, "u[%d]", law->index), NULL);
    case LAW_VALUE: return whole->x[law->index];
    case LAW_RATE: return whole->xd[law->index];
    case LAW_TIME: return ex_input(dag, "time", NULL);
    case LAW_LOCAL: return local[law->index];
    case LAW_TABLE:
        if (dag->node[arg[0]].op == OP_LITERAL)
            return ex_literal(dag, table_value(&model->table[law->index], ex_value(dag, arg[0], 0)));
        return ex_op(dag, OP_TABLE, arg[0], (Ex)law->index, 0);
    default: break;
    }
    switch ((Op)law->call) {
    case OP_NEG: return ex_neg(dag, arg[0]);
    case OP_ADD: return ex_add(dag, arg[0], arg[1]);
    case OP_SUB: return ex_sub(dag, arg[0], arg[1]);
    case OP_MUL: return ex_mul(dag, arg[0], arg[1]);
    case OP_DIV: return ex_div(dag, arg[0], arg[1]);
    case OP_POW: return ex_pow(dag, arg[0], arg[1]);
    default: return ex_op(dag, (Op)law->call, arg[0], arg[1], arg[2]);
    }
}

/* Spring and damper in parallel: tension at extension and rate; adds to the energy sums. */
static Ex spring_damper(Whole *whole, Loads *loads, const Force *force, Ex value, Ex rate)
{
    Dag *dag = whole->dag;
    Ex extension = ex_sub(dag, value, law_value(whole, force->free, NULL));
    Ex elastic = ex_mul(dag, law_value(whole, force->stiffness, NULL), extension);
    Ex viscous = ex_mul(dag, law_value(whole, force->damping, NULL), rate);
    loads->potential =
        ex_add(dag, loads->potential, ex_mul(dag, ex_literal(dag, 0.5), ex_mul(dag, elastic, extension)));
    loads->potential_rate = ex_add(dag, loads->potential_rate, ex_mul(dag, elastic, rate));
    loads->power = ex_sub(dag, loads->power, ex_mul(dag, viscous, rate));
    return ex_add(dag, elastic, viscous);
}

static void add_along(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Force *force = &whole->model->force[index];
    int w = force->coordinate;
    Ex Q;
    if (force->type == FORCE_COORDINATE) {
        Q = ex_neg(dag, spring_damper(whole, loads, force, whole->x[w], whole->xd[w]));
    } else {
        Q = law_value(whole, force->law[0], NULL);
        loads->power = ex_add(dag, loads->power, ex_mul(dag, Q, whole->xd[w]));
    }
    loads->element[index] = Q;
    loads->own[w] = ex_add(dag, loads->own[w], Q);
}

static void add_between(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Force *force = &whole->model->force[index];
    Vector end[2];
    Ex d[3], rate[3], F[3], tension;
    for (int i = 0; i < 2; ++i)
        end[i] = whole_point(whole, force->body[i], force->point[i]);
    ex_sub3(dag, end[1].v, end[0].v, d);
    ex_sub3(dag, end[1].rate, end[0].rate, rate);
    Ex length = ex_sqrt(dag, ex_dot(dag, d, d)), scale = ex_div(dag, ex_literal(dag, 1), length);
    Ex speed = ex_mul(dag, scale, ex_dot(dag, d, rate));
    if (force->type == FORCE_POINTS) {
        tension = spring_damper(whole, loads, force, length, speed);
    } else {
        tension = law_value(whole, force->law[0], (const Ex[FORCE_LOCALS]){length, speed});
        loads->power = ex_sub(dag, loads->power, ex_mul(dag, tension, speed));
    }
    loads->element[index] = tension;
    ex_scale3(dag, ex_mul(dag, tension, scale), d, F);
    push(whole, loads, force->body[0], &end[0], F);
    for (int i = 0; i < 3; ++i)
        F[i] = ex_neg(dag, F[i]);
    push(whole, loads, force->body[1], &end[1], F);
}

/* Force and torque on a body, components in the frame of body `in` (BODY_GROUND: world). */
static void add_load(Whole *whole, Loads *loads, int body, int in, const double at[3], const Ex F[3], const Ex T[3])
{
    Dag *dag = whole->dag;
    Vector point = whole_point(whole, body, at);
    Ex force[3], torque[3], v[3], total[3];
    if (in == BODY_GROUND) {
        ex_apply_transposed(dag, whole->R, F, force);
        ex_apply_transposed(dag, whole->R, T, torque);
    } else {
        ex_apply(dag, whole->motion[in].A, F, force);
        ex_apply(dag, whole->motion[in].A, T, torque);
    }
    push(whole, loads, body, &point, force);
    ex_add3(dag, loads->wrench[body], torque, loads->wrench[body]);
    whole_velocity_in_base(whole, &point, v);
    ex_add3(dag, whole->turn, whole->motion[body].omega, total);
    loads->power = ex_add(dag, loads->power, ex_add(dag, ex_dot(dag, force, v), ex_dot(dag, torque, total)));
}

static void add_force(Whole *whole, Loads *loads, int index)
{
    const Force *force = &whole->model->force[index];
    Ex value[6] = {0};
    switch (force->type) {
    case FORCE_COORDINATE:
    case FORCE_COORDINATE_LAW: add_along(whole, loads, index); break;
    case FORCE_POINTS:
    case FORCE_POINTS_LAW: add_between(whole, loads, index); break;
    default:
        for (int i = 0; i < 6; ++i)
            value[i] = force->law[i] ? law_value(whole, force->law[i], NULL) : 0;
        add_load(whole, loads, force->body[0], force->body[1], force->point[0], value, value + 3);
    }
}

static void add_port(Whole *whole, Loads *loads, int index)
{
    const Port *port = &whole->model->port[index];
    Ex value[6];
    for (int i = 0; i < 6; ++i)
        value[i] = ex_input(whole->dag, pool_print(whole->dag->pool, "port[%d]", 6 * index + i), NULL);
    add_load(whole, loads, port->body, port->in, port->point, value, value + 3);
}

static void add_wheel(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Wheel *wheel = &whole->model->wheel[index];
    Vector center = whole_point(whole, wheel->body, wheel->center);
    Ex at[3], v[3], F[3], one = ex_literal(dag, 1);
    whole_position(whole, &center, at);
    whole_velocity(whole, &center, v);
    Ex road = ex_op(dag, OP_ROAD, at[0], at[1], 0), h = ex_op(dag, OP_ROAD_PART, road, 0, 0);
    Ex slope_x = ex_op(dag, OP_ROAD_PART, road, 1, 0), slope_y = ex_op(dag, OP_ROAD_PART, road, 2, 0);
    Ex deflection = ex_sub(dag, ex_add(dag, ex_literal(dag, wheel->radius), h), at[2]);
    Ex rate = ex_sub(dag, ex_add(dag, ex_mul(dag, slope_x, v[0]), ex_mul(dag, slope_y, v[1])), v[2]);
    Ex s = ex_op(dag, OP_MAX, ex_mul(dag, ex_literal(dag, 1 / wheel->fade), deflection), 0, 0);
    s = ex_op(dag, OP_MIN, s, one, 0);
    Ex fade = ex_mul(dag, ex_mul(dag, s, s), ex_sub(dag, ex_literal(dag, 3), ex_add(dag, s, s)));
    Ex viscous = ex_mul(dag, ex_mul(dag, ex_literal(dag, wheel->damping), fade), rate);
    /* without contact the deflection is negative and fades the damping to 0, so the limit at 0 says it all */
    Ex fz = ex_op(dag, OP_MAX, ex_add(dag, ex_mul(dag, ex_literal(dag, wheel->stiffness), deflection), viscous), 0, 0);
    ex_scale3(dag, fz, whole->R + 6, F);
    push(whole, loads, wheel->body, &center, F);
    loads->power = ex_add(dag, loads->power, ex_mul(dag, fz, v[2]));
    const Ex all[4] = {fz, deflection, rate, h};
    for (int i = 0; i < 4; ++i)
        loads->wheel[index][i] = all[i];
}

Loads *loads_make(Whole *whole)
{
    Pool *pool = whole->dag->pool;
    const Model *model = whole->model;
    Loads *loads = pool_alloc(pool, sizeof *loads);
    loads->wrench = pool_alloc(pool, (size_t)model->bodies * sizeof *loads->wrench);
    loads->own = pool_alloc(pool, (size_t)(model->coordinates + 1) * sizeof *loads->own);
    loads->along = pool_alloc(pool, (size_t)(model->coordinates + 1) * sizeof *loads->along);
    loads->element = pool_alloc(pool, (size_t)(model->forces + 1) * sizeof *loads->element);
    loads->wheel = pool_alloc(pool, (size_t)(model->wheels + 1) * sizeof *loads->wheel);
    for (int i = 0; i < model->forces; ++i)
        add_force(whole, loads, i);
    for (int i = 0; i < model->wheels; ++i)
        add_wheel(whole, loads, i);
    for (int i = 0; i < model->ports; ++i)
        add_port(whole, loads, i);
    project(whole, loads);
    return loads;
}
