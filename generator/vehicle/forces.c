/* SPDX-License-Identifier: MIT
 * Applied forces (FORMAT.md sections 7 and 8), body by body and as generalised forces. */
#include "base/plant.h"
#include "base/table.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/forces.h"
#include "vehicle/vehicle.h"

#include <string.h>

static Ex magnitude(Dag *dag, Ex e)
{
    return ex_op(dag, OP_ABS, e, 0, 0);
}

static Ex magnitude3(Dag *dag, const Ex v[3])
{
    return ex_add(dag, magnitude(dag, v[0]), ex_add(dag, magnitude(dag, v[1]), magnitude(dag, v[2])));
}

/* Record the magnitudes of the latest element's terms. */
static void set_terms(const Whole *whole, Loads *loads, Ex a, Ex b)
{
    if (whole->sized)
        loads->terms = ex_add(whole->dag, magnitude(whole->dag, a), magnitude(whole->dag, b));
}

/* Count the latest element's terms as a force or torque on a body; arm NULL: a torque. */
static void count_size(const Whole *whole, Loads *loads, int body, const Ex *arm)
{
    Dag *dag = whole->dag;
    if (!whole->sized || body == BODY_GROUND)
        return;
    Ex *size = loads->size[body];
    size[0] = ex_add(dag, size[0], arm ? ex_mul(dag, magnitude3(dag, arm), loads->terms) : loads->terms);
    if (arm)
        size[1] = ex_add(dag, size[1], loads->terms);
}

Ex load_part(Whole *whole, Ex value, bool internal)
{
    Dag *dag = whole->dag;
    Loads *loads = whole->loads;
    if (!whole->parted || dag->node[value].level < LEVEL_VARIABLE)
        return value;
    *POOL_PUSH(dag->pool, loads->part, loads->parts) = (LoadPart){value, internal};
    return ex_input(dag, element_at(ARRAY_cut, loads->parts - 1), NULL);
}

bool load_is_internal(const Force *force)
{
    return force->body[0] != BODY_GROUND && force->body[1] != BODY_GROUND;
}

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
    count_size(whole, loads, body, point->arm);
}

/* Sum the forces on the bodies, and project them on the coordinates. */
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
    whole_hand_on(whole, (const Ex(*)[6])loads->wrench, loads->along);
}

/* A torque (base frame) on a body. */
static void twist(Whole *whole, Loads *loads, int body, const Ex torque[3])
{
    if (body != BODY_GROUND)
        ex_add3(whole->dag, loads->wrench[body], torque, loads->wrench[body]);
    count_size(whole, loads, body, NULL);
}

static Ex table_lookup(Whole *whole, int table, Ex x)
{
    Dag *dag = whole->dag;
    if (dag->node[x].op == OP_LITERAL)
        return ex_literal(dag, table_value(&whole->model->table[table], ex_value(dag, x, 0)));
    return ex_op(dag, OP_TABLE, x, (Ex)table, 0);
}

Ex whole_post(const Whole *whole, const Wheel *wheel, int order)
{
    return wheel->post ? ex_input(whole->dag, element_at(ARRAY_u, wheel->post - 1 + order), NULL) : 0;
}

Ex whole_law(Whole *whole, const Law *law, const Ex *local)
{
    Dag *dag = whole->dag;
    Ex arg[3] = {0};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        arg[i] = whole_law(whole, law->arg[i], local);
    switch (law->op) {
    case LAW_NUMBER: {
        const Ex number = whole_number(whole, &law->number);
        return ex_is_number(dag, number) ? ex_literal(dag, law->number) : number;
    }
    case LAW_INPUT: return ex_input(dag, element_at(ARRAY_u, law->index), NULL);
    case LAW_STATE: return whole->z[law->index];
    case LAW_VALUE: return whole->x[law->index];
    case LAW_RATE: return whole->xd[law->index];
    case LAW_TIME: return ex_input(dag, element_at(ARRAY_time, 0), NULL);
    case LAW_LOCAL: return local[law->index];
    case LAW_SIGNAL: {
        const Ex signal = whole_signal(whole, law->index);
        return law->number < 0 ? ex_neg(dag, signal) : signal;
    }
    default: return law_top(dag, whole->model, law, arg);
    }
}

/* 0 at s = 0, 1 for s >= 1, smooth between. */
static Ex fade_in(Dag *dag, Ex s)
{
    s = ex_op(dag, OP_MIN, s, ex_literal(dag, 1), 0);
    return ex_mul(dag, ex_mul(dag, s, s), ex_sub(dag, ex_literal(dag, 3), ex_add(dag, s, s)));
}

/* Force of an element's spring, by its stiffness or table, at extension and rate; adds to the energy sums. A table has
 * no integral here, so its power counts instead of its potential. */
static Ex elastic_force(Whole *whole, Loads *loads, const Force *force, Ex extension, Ex rate)
{
    Dag *dag = whole->dag;
    Ex elastic = force->table < 0 ? ex_mul(dag, whole_law(whole, force->stiffness, NULL), extension)
                                  : table_lookup(whole, force->table, extension);
    Ex power = ex_mul(dag, elastic, rate);
    if (force->table < 0) {
        loads->potential =
            ex_add(dag, loads->potential, ex_mul(dag, ex_literal(dag, 0.5), ex_mul(dag, elastic, extension)));
        loads->potential_rate = ex_add(dag, loads->potential_rate, power);
    } else {
        loads->power = ex_sub(dag, loads->power, power);
    }
    return elastic;
}

/* Spring and damper in parallel: tension at value and rate. */
static Ex spring_damper(Whole *whole, Loads *loads, const Force *force, Ex value, Ex rate)
{
    Dag *dag = whole->dag;
    Ex free = whole_law(whole, force->free, NULL), extension = ex_sub(dag, value, free);
    Ex elastic = elastic_force(whole, loads, force, extension, rate);
    Ex viscous = ex_mul(dag, whole_law(whole, force->damping, NULL), planted("force") ? value : rate);
    set_terms(whole, loads, elastic, viscous);
    if (whole->sized && force->table < 0) { /* magnitudes of the two whose difference is the extension */
        Ex length = ex_add(dag, magnitude(dag, value), magnitude(dag, free));
        Ex most = ex_mul(dag, magnitude(dag, whole_law(whole, force->stiffness, NULL)), length);
        loads->terms = ex_add(dag, loads->terms, most);
    }
    loads->power = ex_sub(dag, loads->power, ex_mul(dag, viscous, rate));
    return ex_add(dag, elastic, viscous);
}

/* Force of one end of a stop at `beyond`, the depth, and its rate. */
static Ex contact(Whole *whole, Loads *loads, const Force *force, Ex beyond, Ex rate)
{
    Dag *dag = whole->dag;
    Ex depth = ex_op(dag, OP_MAX, beyond, 0, 0), fade = whole_law(whole, force->fade, NULL);
    Ex elastic = elastic_force(whole, loads, force, depth, rate);
    Ex damping = ex_mul(dag, whole_law(whole, force->damping, NULL), fade_in(dag, ex_div(dag, depth, fade)));
    Ex free = ex_add(dag, elastic, ex_mul(dag, damping, rate)), push = ex_op(dag, OP_MAX, free, 0, 0);
    loads->press[loads->presses++] = ex_op(dag, OP_POSITIVE, beyond, free, beyond);
    loads->power = ex_sub(dag, loads->power, ex_mul(dag, ex_sub(dag, push, elastic), rate));
    return push;
}

/* Both ends of a stop: tension at value and rate. */
static Ex stop(Whole *whole, Loads *loads, const Force *force, Ex value, Ex rate)
{
    Dag *dag = whole->dag;
    Ex tension = 0;
    if (force->high) {
        Ex beyond = ex_sub(dag, value, whole_law(whole, force->high, NULL));
        tension = contact(whole, loads, force, beyond, rate);
    }
    if (force->low) {
        Ex beyond = ex_sub(dag, whole_law(whole, force->low, NULL), value);
        tension = ex_sub(dag, tension, contact(whole, loads, force, beyond, ex_neg(dag, rate)));
    }
    return tension;
}

/* Force of an element between points or about an axis against a growing length or angle. */
static Ex resistance(Whole *whole, Loads *loads, const Force *force, Ex value, Ex rate)
{
    Dag *dag = whole->dag;
    if (force_is_spring(force))
        return spring_damper(whole, loads, force, value, rate);
    if (force_is_stop(force)) {
        Ex tension = stop(whole, loads, force, value, rate);
        set_terms(whole, loads, tension, 0);
        return tension;
    }
    Ex tension = whole_law(whole, force->law[0], (const Ex[FORCE_LOCALS]){value, rate});
    set_terms(whole, loads, tension, 0);
    loads->power = ex_sub(dag, loads->power, ex_mul(dag, tension, rate));
    return tension;
}

static void add_along(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Force *force = &whole->model->force[index];
    int w = force->coordinate;
    Ex Q;
    if (force_is_law(force)) {
        Q = whole_law(whole, force->law[0], NULL);
        set_terms(whole, loads, Q, 0);
        loads->power = ex_add(dag, loads->power, ex_mul(dag, Q, whole->xd[w]));
    } else {
        Q = ex_neg(dag, resistance(whole, loads, force, whole->x[w], whole->xd[w]));
    }
    loads->element[index] = Q;
    loads->own[w] = ex_add(dag, loads->own[w], load_part(whole, Q, true));
    if (whole->sized)
        loads->own_size[w] = ex_add(dag, loads->own_size[w], loads->terms);
}

static void add_between(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Force *force = &whole->model->force[index];
    Vector end[2];
    Ex d[3], rate[3], F[3];
    for (int i = 0; i < 2; ++i)
        end[i] = whole_point(whole, force->body[i], force->point[i]);
    ex_sub3(dag, end[1].v, end[0].v, d);
    ex_sub3(dag, end[1].rate, end[0].rate, rate);
    Ex length = ex_sqrt(dag, ex_dot(dag, d, d)), scale = ex_div(dag, ex_literal(dag, 1), length);
    Ex speed = ex_mul(dag, scale, ex_dot(dag, d, rate));
    Ex tension = resistance(whole, loads, force, length, speed);
    loads->element[index] = tension;
    ex_scale3(dag, ex_mul(dag, load_part(whole, tension, load_is_internal(force)), scale), d, F);
    push(whole, loads, force->body[0], &end[0], F);
    for (int i = 0; i < 3; ++i)
        F[i] = ex_neg(dag, F[i]);
    push(whole, loads, force->body[1], &end[1], F);
}

void force_direction(Whole *whole, int body, const Ex local[3], Ex out[3])
{
    if (body == BODY_GROUND)
        ex_apply_transposed(whole->dag, whole->R, local, out);
    else
        ex_apply(whole->dag, whole->motion[body].A, local, out);
}

/* A pair of torques T n on the first body and -T n on the second, whose power is -T angle'. With x = e_1 . f_1,
 * y = e_2 . f_1 the derivative of atan2(y, x) is n . (omega_b - omega_a), n = (u - (u . f_1) f_1) / (x^2 + y^2), which
 * is u where f_1 stays perpendicular to it. */
static void add_about(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Force *force = &whole->model->force[index];
    Ex local[4][3]; /* u, e_1, e_2, f_1 */
    Ex u[3], e1[3], e2[3], f1[3], n[3], turn[2][3], speed[3];
    for (int i = 0; i < 3; ++i) {
        local[0][i] = whole_number(whole, &force->axis[i]);
        local[1][i] = whole_number(whole, &force->reference[0][i]);
        local[3][i] = whole_number(whole, &force->reference[1][i]);
    }
    ex_cross(dag, local[0], local[1], local[2]);
    force_direction(whole, force->body[0], local[0], u);
    force_direction(whole, force->body[0], local[1], e1);
    force_direction(whole, force->body[0], local[2], e2);
    force_direction(whole, force->body[1], local[3], f1);
    for (int i = 0; i < 2; ++i) {
        ex_zero3(dag, turn[i]);
        if (force->body[i] == BODY_GROUND)
            ex_sub3(dag, turn[i], whole->turn, turn[i]);
        else
            ex_add3(dag, turn[i], whole->motion[force->body[i]].omega, turn[i]);
    }
    Ex x = ex_dot(dag, e1, f1), y = ex_dot(dag, e2, f1);
    Ex square = ex_add(dag, ex_mul(dag, x, x), ex_mul(dag, y, y));
    ex_scale3(dag, ex_dot(dag, u, f1), f1, n);
    ex_sub3(dag, u, n, n);
    ex_scale3(dag, ex_div(dag, ex_literal(dag, 1), square), n, n);
    ex_sub3(dag, turn[1], turn[0], speed);
    Ex torque = resistance(whole, loads, force, ex_op(dag, OP_ATAN2, y, x, 0), ex_dot(dag, n, speed));
    loads->element[index] = torque;
    if (whole->sized)
        loads->terms = ex_mul(dag, loads->terms, magnitude3(dag, n));
    ex_scale3(dag, load_part(whole, torque, load_is_internal(force)), n, n);
    twist(whole, loads, force->body[0], n);
    for (int i = 0; i < 3; ++i)
        n[i] = ex_neg(dag, n[i]);
    twist(whole, loads, force->body[1], n);
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
    if (whole->sized)
        loads->terms = magnitude3(dag, force);
    push(whole, loads, body, &point, force);
    if (whole->sized)
        loads->terms = magnitude3(dag, torque);
    twist(whole, loads, body, torque);
    whole_velocity_in_base(whole, &point, v);
    ex_add3(dag, whole->turn, whole->motion[body].omega, total);
    loads->power = ex_add(dag, loads->power, ex_add(dag, ex_dot(dag, force, v), ex_dot(dag, torque, total)));
}

/* Both bodies are pushed along the same line, through the second one's point. */
static void add_bushing(Whole *whole, Loads *loads, const Force *force)
{
    Dag *dag = whole->dag;
    const BushingLoad load = bushing_load(whole, force);
    Ex back[3], moment[3], size[2] = {load.size[0], load.size[1]};
    loads->terms = size[0];
    push(whole, loads, force->body[1], &load.end[1], load.force);
    ex_sub3(dag, (Ex[3]){0}, load.force, back);
    push(whole, loads, force->body[0], &load.end[0], back);
    loads->terms = size[1];
    twist(whole, loads, force->body[1], load.torque);
    ex_cross(dag, load.arm, back, moment);
    ex_sub3(dag, moment, load.torque, moment);
    if (whole->sized)
        loads->terms = ex_add(dag, size[1], ex_mul(dag, magnitude3(dag, load.arm), size[0]));
    twist(whole, loads, force->body[0], moment);
    loads->potential = ex_add(dag, loads->potential, load.potential);
    loads->potential_rate = ex_add(dag, loads->potential_rate, load.potential_rate);
    loads->power = ex_add(dag, loads->power, load.power);
}

static void add_force(Whole *whole, Loads *loads, int index)
{
    const Force *force = &whole->model->force[index];
    Ex value[6] = {0}, size[2];
    if (force->coordinate >= 0) {
        add_along(whole, loads, index);
    } else if (force_is_torque(force)) {
        add_about(whole, loads, index);
    } else if (force->bushing) {
        add_bushing(whole, loads, force);
    } else if (!force_is_wrench(force)) {
        add_between(whole, loads, index);
    } else {
        for (int i = 0; i < 6 && force->type == FORCE_LOAD; ++i)
            value[i] = force->law[i] ? whole_law(whole, force->law[i], NULL) : 0;
        if (force->type == FORCE_AERO) {
            const Vector point = whole_point(whole, force->body[0], force->point[0]);
            aero_wrench(whole, force, value, size);
            loads->terms = size[0];
            count_size(whole, loads, force->body[0], point.arm);
            loads->terms = size[1];
            count_size(whole, loads, force->body[0], NULL);
        }
        for (int i = 0; i < 6; ++i)
            value[i] = load_part(whole, value[i], false);
        add_load(whole, loads, force->body[0], force->body[1], force->point[0], value, value + 3);
    }
}

static void add_port(Whole *whole, Loads *loads, int index)
{
    const Port *port = &whole->model->port[index];
    Ex value[6];
    for (int i = 0; i < 6; ++i)
        value[i] = ex_input(whole->dag, element_at(ARRAY_port, 6 * index + i), NULL);
    add_load(whole, loads, port->body, port->in, port->point, value, value + 3);
}

/* A wheel with a tire: its force is known already. */
static void add_rolling_wheel(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Wheel *wheel = &whole->model->wheel[index];
    Ex grip[GRIP_NUMBERS], axis[3], local[3];
    for (int i = 0; i < GRIP_NUMBERS; ++i)
        grip[i] = whole_grip(whole, index, i);
    add_load(whole, loads, wheel->body, BODY_GROUND, wheel->center, grip + GRIP_FORCE, grip + GRIP_TORQUE);
    loads->power = ex_add(dag, loads->power, grip[GRIP_POWER]);
    memcpy(loads->wheel[index], grip + GRIP_LOAD, sizeof *loads->wheel);
    loads->wheel[index][3] = ex_add(dag, loads->wheel[index][3], whole_post(whole, wheel, 0));
    loads->press[index] = grip[GRIP_PRESS];
    if (!wheel_is_driven(whole->model, index))
        return;
    /* reaction of the drive */
    for (int i = 0; i < 3; ++i)
        local[i] = whole_number(whole, &wheel->axis[i]);
    ex_apply(dag, whole->motion[wheel->body].A, local, axis);
    ex_scale3(dag, ex_neg(dag, grip[GRIP_DRIVE]), axis, axis);
    if (whole->sized)
        loads->terms = magnitude3(dag, axis);
    twist(whole, loads, wheel->drive_body, axis);
    if (wheel->drive_body == BODY_GROUND)
        return;
    ex_add3(dag, whole->turn, whole->motion[wheel->drive_body].omega, local);
    loads->power = ex_add(dag, loads->power, ex_dot(dag, axis, local));
}

static void add_wheel(Whole *whole, Loads *loads, int index)
{
    Dag *dag = whole->dag;
    const Wheel *wheel = &whole->model->wheel[index];
    Vector center = whole_point(whole, wheel->body, wheel->center);
    Ex at[3], v[3], F[3];
    whole_position(whole, &center, at);
    whole_velocity(whole, &center, v);
    Ex road = ex_op(dag, OP_ROAD, at[0], at[1], 0), under = ex_op(dag, OP_ROAD_PART, road, 0, 0);
    Ex h = ex_add(dag, under, whole_post(whole, wheel, 0));
    Ex slope_x = ex_op(dag, OP_ROAD_PART, road, 1, 0), slope_y = ex_op(dag, OP_ROAD_PART, road, 2, 0);
    Ex deflection = ex_sub(dag, ex_add(dag, whole_number(whole, &wheel->radius), h), at[2]);
    Ex rate = ex_sub(dag, ex_add(dag, ex_mul(dag, slope_x, v[0]), ex_mul(dag, slope_y, v[1])), v[2]);
    rate = ex_add(dag, rate, whole_post(whole, wheel, 1));
    Ex share = ex_div(dag, ex_literal(dag, 1), whole_number(whole, &wheel->fade));
    Ex s = ex_op(dag, OP_MAX, ex_mul(dag, share, deflection), 0, 0);
    Ex viscous = ex_mul(dag, ex_mul(dag, whole_number(whole, &wheel->damping), fade_in(dag, s)), rate);
    if (whole->sized) {
        Ex height = ex_add(dag, magnitude(dag, h), magnitude(dag, at[2]));
        Ex most = ex_add(dag, whole_number(whole, &wheel->radius), height);
        set_terms(whole, loads, ex_mul(dag, whole_number(whole, &wheel->stiffness), most), viscous);
    }
    /* without contact the deflection is negative and the damping has faded to 0, so limiting at 0 suffices */
    Ex free = ex_add(dag, ex_mul(dag, whole_number(whole, &wheel->stiffness), deflection), viscous);
    Ex fz = ex_op(dag, OP_MAX, free, 0, 0);
    loads->press[index] = free;
    ex_scale3(dag, load_part(whole, fz, false), whole->R + 6, F);
    push(whole, loads, wheel->body, &center, F);
    loads->power = ex_add(dag, loads->power, ex_mul(dag, fz, v[2]));
    const Ex all[4] = {fz, deflection, rate, h};
    for (int i = 0; i < 4; ++i)
        loads->wheel[index][i] = all[i];
}

static void make_wheel(Whole *whole, int index)
{
    Loads *loads = whole->loads;
    const Wheel *wheel = &whole->model->wheel[index];
    if (loads->pressed[index])
        return;
    loads->pressed[index] = true;
    dag_section(whole->dag, pool_print(whole->dag->pool, "wheel %s", wheel->name));
    (wheel->tire < 0 ? add_wheel : add_rolling_wheel)(whole, loads, index);
}

static void make_force(Whole *whole, int index);

/* Make the forces that a formula reads. */
static void make_read(void *user, const Law *law)
{
    Whole *whole = user;
    const Signal *signal = &whole->model->signal[law->index];
    if (signal->law)
        law_signals(signal->law, make_read, whole);
    else if (signal->output.type == OUTPUT_FORCE)
        make_force(whole, signal->output.index);
    else if (signal->output.type == OUTPUT_WHEEL)
        make_wheel(whole, signal->output.index);
}

/* Elements are in the order of the file, but those that a formula reads come before its own. No formula follows itself:
 * read/signals.c. */
static void make_force(Whole *whole, int index)
{
    Loads *loads = whole->loads;
    const Force *force = &whole->model->force[index];
    if (loads->made[index])
        return;
    loads->made[index] = true;
    for (int i = 0; i < FORCE_MOST_LAWS; ++i)
        law_signals(force->law[i], make_read, whole);
    dag_section(whole->dag, pool_print(whole->dag->pool, "force %s", force->name));
    add_force(whole, loads, index);
    if (loads->element[index])
        ex_label(whole->dag, loads->element[index], "force_%s", force->name);
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
    loads->size = pool_alloc(pool, (size_t)model->bodies * sizeof *loads->size);
    loads->own_size = pool_alloc(pool, (size_t)(model->coordinates + 1) * sizeof *loads->own_size);
    loads->made = pool_alloc(pool, (size_t)(model->forces + 1) * sizeof *loads->made);
    loads->pressed = pool_alloc(pool, (size_t)(model->wheels + 1) * sizeof *loads->pressed);
    loads->press = pool_alloc(pool, (size_t)(model->wheels + 2 * model->forces + 1) * sizeof *loads->press);
    loads->presses = model->wheels;
    whole->loads = loads;
    for (int i = 0; i < model->forces; ++i)
        make_force(whole, i);
    for (int i = 0; i < model->wheels; ++i)
        make_wheel(whole, i);
    for (int i = 0; i < model->ports; ++i) {
        dag_section(whole->dag, pool_print(pool, "port %s", model->port[i].name));
        add_port(whole, loads, i);
    }
    dag_section(whole->dag, "applied forces: moment and force on the base, and along each coordinate");
    project(whole, loads);
    return loads;
}
