/* SPDX-License-Identifier: MIT
 * Applied forces (FORMAT.md sections 6 to 8) as a force at the centre of mass and a torque about it, body by body. */
#include "base/table.h"
#include "base/vec3.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/wheel.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* A point of a body, or of ground: arm from the centre of mass, place and velocity. */
typedef struct Point {
    int body;
    double arm[3], r[3], v[3];
} Point;

static inline Point point_at(const World *world, int body, const double s[3])
{
    Point p = {.body = body};
    if (body == BODY_GROUND) {
        copy3(s, p.r);
        return p;
    }
    double local[3], rate[3];
    sub3(s, world->model->body[body].com, local);
    apply3(world->A[body], local, p.arm);
    add3(world->q[body], p.arm, p.r);
    cross3(world->omega[body], p.arm, rate);
    add3(world->qd[body], rate, p.v);
    return p;
}

static inline void push(World *world, const Point *point, const double F[3])
{
    if (point->body == BODY_GROUND)
        return;
    double torque[3], *wrench = world->wrench[point->body];
    cross3(point->arm, F, torque);
    add3(wrench, F, wrench);
    add3(wrench + 3, torque, wrench + 3);
}

/* ---- laws ------------------------------------------------------------------------------------------------ */

static double call_at(const World *world, const Law *law, const double *local)
{
    const double a = world_law(world, law->arg[0], local), b = law->arg[1] ? world_law(world, law->arg[1], local) : 0;
    switch ((Op)law->call) {
    case OP_NEG: return -a;
    case OP_ADD: return a + b;
    case OP_SUB: return a - b;
    case OP_MUL: return a * b;
    case OP_DIV: return a / b;
    case OP_SQRT: return sqrt(a);
    case OP_ABS: return fabs(a);
    case OP_SIN: return sin(a);
    case OP_COS: return cos(a);
    case OP_TAN: return tan(a);
    case OP_ASIN: return asin(a);
    case OP_ACOS: return acos(a);
    case OP_ATAN: return atan(a);
    case OP_EXP: return exp(a);
    case OP_LOG: return log(a);
    case OP_TANH: return tanh(a);
    case OP_POW: return pow(a, b);
    case OP_ATAN2: return atan2(a, b);
    case OP_MIN: return a < b ? a : b;
    case OP_MAX: return a > b ? a : b;
    default: return a > 0 ? b : world_law(world, law->arg[2], local); /* OP_POSITIVE */
    }
}

static double table_at(const Table *table, double x)
{
    const gic_table t = {table->x, table->y, table->slope, table->count, table->cubic, table->onward};
    return gic_table_value(&t, x);
}

double world_law(const World *world, const Law *law, const double *local)
{
    switch (law->op) {
    case LAW_NUMBER: return law->number;
    case LAW_PARAMETER: {
        const Parameter *parameter = &world->model->parameter[law->index];
        if (parameter->law)
            return world_law(world, parameter->law, local);
        return parameter->tunable ? world->parameter[parameter->index] : parameter->value;
    }
    case LAW_INPUT: return world->input[law->index];
    case LAW_STATE: return world->fast[world->model->state[law->index].fast];
    case LAW_VALUE: return world->x[law->index];
    case LAW_RATE: return world->xd[law->index];
    case LAW_TIME: return world->time;
    case LAW_LOCAL: return local[law->index];
    case LAW_SIGNAL: return law->number * world_signal(world, law->index);
    case LAW_TABLE: return table_at(&world->model->table[law->index], world_law(world, law->arg[0], local));
    default: return call_at(world, law, local);
    }
}

double world_law_size(const World *world, const Law *law, const double *local)
{
    const bool call = law->op == LAW_CALL;
    const double value = fabs(world_law(world, law, local));
    if (law->op == LAW_SIGNAL && world->model->signal[law->index].law)
        return world_law_size(world, world->model->signal[law->index].law, NULL);
    if (!call || (law->call != OP_ADD && law->call != OP_SUB && law->call != OP_MUL && law->call != OP_DIV))
        return value;
    const double a = world_law_size(world, law->arg[0], local), b = world_law_size(world, law->arg[1], local);
    if (law->call == OP_MUL)
        return a * b;
    return law->call == OP_DIV ? a / fabs(world_law(world, law->arg[1], local)) : a + b;
}

/* ---- elements -------------------------------------------------------------------------------------------- */

static inline double fade_in(double s)
{
    s = fmin(s, 1);
    return s * s * (3 - 2 * s);
}

/* Of a spring, by its stiffness or table; rate: of the extension. */
static double elastic_force(World *world, const Force *force, double extension, double rate)
{
    if (force->table >= 0)
        return table_at(&world->model->table[force->table], extension);
    const double elastic = world_law(world, force->stiffness, NULL) * extension;
    world->potential += 0.5 * elastic * extension;
    world->stored += elastic * rate;
    return elastic;
}

/* What one end of a stop pushes. */
static double contact(World *world, const Force *force, int end, double depth, double rate)
{
    Touch *touch = &world->touch[world->model->wheels + 2 * (force - world->model->force) + end];
    *touch = (Touch){depth, rate, 0, 0};
    if (!(depth > 0))
        return 0;
    const double damping =
        world_law(world, force->damping, NULL) * fade_in(depth / world_law(world, force->fade, NULL));
    touch->elastic = elastic_force(world, force, depth, rate);
    touch->damping = damping * rate;
    return fmax(0, touch->elastic + touch->damping);
}

/* The resistance against growth of an element between points, about an axis, or along a coordinate without a
 * formula. */
static double resistance(World *world, const Force *force, double value, double rate)
{
    if (force_is_law(force))
        return world_law(world, force->law[0], (const double[FORCE_LOCALS]){value, rate});
    if (force_is_spring(force))
        return elastic_force(world, force, value - world_law(world, force->free, NULL), rate) +
               world_law(world, force->damping, NULL) * rate;
    double tension = 0;
    if (force->high)
        tension += contact(world, force, 0, value - world_law(world, force->high, NULL), rate);
    if (force->low)
        tension -= contact(world, force, 1, world_law(world, force->low, NULL) - value, -rate);
    return tension;
}

static void add_along(World *world, int index)
{
    const Force *force = &world->model->force[index];
    const int w = force->coordinate;
    const double Q = force_is_law(force) ? world_law(world, force->law[0], NULL)
                                         : -resistance(world, force, world->x[w], world->xd[w]);
    world->element[index] = Q;
    world->along[w] += Q;
    world->power += Q * world->xd[w];
}

static void add_between(World *world, int index)
{
    const Force *force = &world->model->force[index];
    const Point a = point_at(world, force->body[0], force->point[0]),
                b = point_at(world, force->body[1], force->point[1]);
    double d[3], rate[3], F[3];
    sub3(b.r, a.r, d);
    sub3(b.v, a.v, rate);
    const double length = norm3(d), speed = dot3(d, rate) / length;
    const double tension = resistance(world, force, length, speed);
    world->shortest = fmin(world->shortest, length);
    world->extent[index] = length;
    world->element[index] = tension;
    world->power -= tension * speed;
    for (int i = 0; i < 3; ++i)
        F[i] = tension / length * d[i];
    push(world, &a, F);
    for (int i = 0; i < 3; ++i)
        F[i] = -F[i];
    push(world, &b, F);
}

/* A direction fixed in a body, or in ground. */
static inline void direction(const World *world, int body, const double u[3], double out[3])
{
    if (body == BODY_GROUND)
        copy3(u, out);
    else
        apply3(world->A[body], u, out);
}

/* Torques T n on the first body and -T n on the second, n being the derivative of the angle by the relative rotation.
 */
static void add_about(World *world, int index)
{
    static const double still[3] = {0, 0, 0};
    const Force *force = &world->model->force[index];
    const int a = force->body[0], b = force->body[1];
    double u[3], e1[3], e2[3], f1[3], n[3], turn[3];
    direction(world, a, force->axis, u);
    direction(world, a, force->reference[0], e1);
    direction(world, b, force->reference[1], f1);
    cross3(u, e1, e2);
    const double x = dot3(e1, f1), y = dot3(e2, f1);
    copy3(u, n);
    add_scaled3(-dot3(u, f1), f1, n);
    sub3(b == BODY_GROUND ? still : world->omega[b], a == BODY_GROUND ? still : world->omega[a], turn);
    /* below: the direction on the axis, or the other way; roundings decide the angle */
    const double square = x * x + y * y, flat = 1e-6, behind = 1e-7;
    world->unclear = world->unclear || square < flat || (x < 0 && fabs(y) < behind);
    const double rate = dot3(n, turn) / square, angle = atan2(y, x), torque = resistance(world, force, angle, rate);
    world->extent[index] = angle;
    world->element[index] = torque;
    world->power -= torque * rate;
    if (a != BODY_GROUND)
        add_scaled3(torque / square, n, world->wrench[a] + 3);
    if (b != BODY_GROUND)
        add_scaled3(-torque / square, n, world->wrench[b] + 3);
}

/* Force and torque, components in the frame of body `in`. */
static void add_load(World *world, int body, int in, const double at[3], const double load[6])
{
    const Point point = point_at(world, body, at);
    double F[3], T[3], *wrench = world->wrench[body];
    if (in == BODY_GROUND) {
        copy3(load, F);
        copy3(load + 3, T);
    } else {
        apply3(world->A[in], load, F);
        apply3(world->A[in], load + 3, T);
    }
    push(world, &point, F);
    add3(wrench + 3, T, wrench + 3);
    world->power += dot3(F, point.v) + dot3(T, world->omega[body]);
}

void world_airflow(const World *world, const Force *force, double u[3])
{
    const Point point = point_at(world, force->body[0], force->point[0]);
    double through[3];
    for (int i = 0; i < 3; ++i)
        through[i] = point.v[i] - (force->law[AERO_WIND + i] ? world_law(world, force->law[AERO_WIND + i], NULL) : 0);
    apply3_transposed(world->A[force->body[0]], through, u);
}

/* Force and moment of the air, in the axes of the body. */
static void aero(const World *world, const Force *force, double load[6])
{
    double u[3], local[FORCE_LOCALS], C[FORCE_MOST_LAWS] = {0};
    world_airflow(world, force, u);
    local[AERO_SIDESLIP] = u[0] == 0 && u[1] == 0 ? 0 : atan2(u[1], u[0]);
    local[AERO_INCIDENCE] = norm3(u) == 0 ? 0 : atan2(-u[2], hypot(u[0], u[1]));
    local[AERO_SPEED] = norm3(u);
    for (int i = 0; i <= AERO_DRAG; ++i)
        C[i] = force->law[i] ? world_law(world, force->law[i], local) : 0;
    const double pressure = 0.5 * world_law(world, force->law[AERO_DENSITY], NULL) * dot3(u, u);
    const double scale = pressure * world_law(world, force->area, NULL);
    for (int i = 0; i < 3; ++i) {
        load[i] = scale * (C[i] - C[AERO_DRAG] * (local[AERO_SPEED] > 0 ? u[i] / local[AERO_SPEED] : 0));
        load[3 + i] = force->length ? scale * world_law(world, force->length, NULL) * C[3 + i] : 0;
    }
}

/* The rotation of its second end against the first, by three numbers: along the axes of the first. Cosine of its angle;
 * axis: of both ends in the world. */
static double bushing_turn(const World *world, const Force *force, double axis[2][3][3], double turn[3])
{
    double cosine = -0.5;
    for (int end = 0; end < 2; ++end)
        for (int k = 0; k < 3; ++k) {
            const double *F = force->bushing->frame[end];
            direction(world, force->body[end], (const double[3]){F[k], F[3 + k], F[6 + k]}, axis[end][k]);
        }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        turn[i] = (dot3(axis[0][k], axis[1][j]) - dot3(axis[0][j], axis[1][k])) / 2;
        cosine += dot3(axis[0][i], axis[1][i]) / 2;
    }
    const double sine = norm3(turn), angle = atan2(sine, cosine);
    for (int i = 0; i < 3; ++i)
        turn[i] *= sine > 0 ? angle / sine : 1;
    return cosine;
}

bool world_bushing_is_sure(const World *world, const Force *force)
{
    double axis[2][3][3], turn[3];
    return bushing_turn(world, force, axis, turn) > BUSHING_COSINE + 1e-7;
}

/* The share of turn x (turn x v) in the rate of a rotation vector, FORMAT.md section 7.5. */
static double bushing_share(double angle)
{
    if (angle < 0.05) /* the next term is 1e-14 of the first */
        return (1 + angle * angle / 60 * (1 + angle * angle / 42)) / 12;
    return (1 - angle / 2 / tan(angle / 2)) / (angle * angle);
}

/* v + s turn x v / 2 + share turn x (turn x v) */
static void bushing_turned(const double turn[3], double s, const double v[3], double out[3])
{
    double once[3], twice[3];
    cross3(turn, v, once);
    cross3(turn, once, twice);
    copy3(v, out);
    add_scaled3(s / 2, once, out);
    add_scaled3(bushing_share(norm3(turn)), twice, out);
}

static double bushing_row(const World *world, const Law *const matrix[BUSHING_NUMBERS], int row, const double *x)
{
    double sum = 0;
    for (int i = 0; i < BUSHING_AXES; ++i) {
        const Law *law = matrix[bushing_place(row, i)];
        const double number = law ? world_law(world, law, NULL) : 0;
        sum += number == 0 ? 0 : number * x[i]; /* what does not count may have no value */
    }
    return sum;
}

static void add_bushing(World *world, const Force *force)
{
    static const double still[3] = {0, 0, 0};
    const Bushing *bushing = force->bushing;
    const double *omega[2];
    double axis[2][3][3], arm[3], v[3], swept[3], turning[3], q[FORCE_LOCALS], Q[BUSHING_AXES], own[3];
    double F[3] = {0, 0, 0}, T[3] = {0, 0, 0};
    Point end[2];
    for (int i = 0; i < 2; ++i) {
        end[i] = point_at(world, force->body[i], force->point[i]);
        omega[i] = force->body[i] == BODY_GROUND ? still : world->omega[force->body[i]];
    }
    const bool defined = bushing_turn(world, force, axis, q + 3) > BUSHING_COSINE;
    for (int k = 0; k < 3 && !defined; ++k)
        q[3 + k] = NAN;
    sub3(end[1].r, end[0].r, arm);
    cross3(omega[0], arm, swept);
    sub3(end[1].v, end[0].v, v);
    sub3(v, swept, v);
    sub3(omega[1], omega[0], turning);
    for (int k = 0; k < 3; ++k) {
        q[k] = dot3(axis[0][k], arm);
        q[BUSHING_AXES + k] = dot3(axis[0][k], v);
        own[k] = dot3(axis[0][k], turning);
    }
    bushing_turned(q + 3, -1, own, q + BUSHING_AXES + 3);
    for (int i = 0; i < BUSHING_AXES; ++i) {
        const double elastic = bushing_row(world, bushing->stiffness, i, q);
        Q[i] = (force->law[i] ? world_law(world, force->law[i], q) : 0) - elastic -
               bushing_row(world, bushing->damping, i, q + BUSHING_AXES);
        if (elastic != 0) {
            world->potential += 0.5 * elastic * q[i];
            world->stored += elastic * q[BUSHING_AXES + i];
        }
    }
    copy3(Q + 3, own);
    if (own[0] != 0 || own[1] != 0 || own[2] != 0)
        bushing_turned(q + 3, 1, Q + 3, own);
    for (int k = 0; k < 3; ++k) {
        add_scaled3(Q[k], axis[0][k], F);
        add_scaled3(own[k], axis[0][k], T);
    }
    world->power += dot3(F, v) + dot3(T, turning);
    push(world, &end[1], F);
    if (force->body[1] != BODY_GROUND)
        add3(world->wrench[force->body[1]] + 3, T, world->wrench[force->body[1]] + 3);
    if (force->body[0] == BODY_GROUND)
        return;
    Point acted = end[0]; /* of the first body, where the second one's point is */
    add3(acted.arm, arm, acted.arm);
    push(world, &acted, (const double[3]){-F[0], -F[1], -F[2]});
    add_scaled3(-1, T, world->wrench[force->body[0]] + 3);
}

static void add_force(World *world, int index)
{
    const Force *force = &world->model->force[index];
    double load[6];
    if (force->coordinate >= 0) {
        add_along(world, index);
    } else if (force_is_torque(force)) {
        add_about(world, index);
    } else if (force->bushing) {
        add_bushing(world, force);
    } else if (!force_is_wrench(force)) {
        add_between(world, index);
    } else {
        for (int i = 0; i < 6 && force->type == FORCE_LOAD; ++i)
            load[i] = force->law[i] ? world_law(world, force->law[i], NULL) : 0;
        if (force->type == FORCE_AERO)
            aero(world, force, load);
        add_load(world, force->body[0], force->body[1], force->point[0], load);
    }
}

/* ---- wheels ---------------------------------------------------------------------------------------------- */

double world_post(const World *world, const Wheel *wheel, int order)
{
    return wheel->post ? world->input[wheel->post - 1 + order] : 0;
}

/* A vertical spring and damper. */
static int add_contact(World *world, int index)
{
    const Wheel *wheel = &world->model->wheel[index];
    const Point center = point_at(world, wheel->body, wheel->center);
    double road[3] = {0, 0, 0};
    if (world->road)
        world->road->height(world->road, world->lane, world->time, center.r[0], center.r[1], road);
    if (!gic_finite(road, 3))
        return GIC_ERROR_ROAD;
    const double height = road[0] + world_post(world, wheel, 0), deflection = wheel->radius + height - center.r[2];
    const double rate = road[1] * center.v[0] + road[2] * center.v[1] + world_post(world, wheel, 1) - center.v[2];
    Touch *touch = &world->touch[index];
    *touch = (Touch){deflection, rate, 0, 0};
    if (deflection > 0) {
        touch->elastic = wheel->stiffness * deflection;
        touch->damping = wheel->damping * fade_in(deflection / wheel->fade) * rate;
    }
    const double fz = fmax(0, touch->elastic + touch->damping);
    push(world, &center, (const double[3]){0, 0, fz});
    world->power += fz * center.v[2];
    double *out = world->wheel[index];
    out[0] = fz;
    out[1] = deflection;
    out[2] = rate;
    out[3] = height;
    return GIC_OK;
}

void world_wheel_motion(const World *world, int index, WheelMotion *motion)
{
    const Wheel *wheel = &world->model->wheel[index];
    const Point center = point_at(world, wheel->body, wheel->center);
    copy3(center.r, motion->center);
    copy3(center.v, motion->velocity);
    motion->center[2] -= world_post(world, wheel, 0);
    motion->velocity[2] -= world_post(world, wheel, 1);
    apply3(world->A[wheel->body], wheel->axis, motion->axis);
    copy3(world->omega[wheel->body], motion->omega);
    motion->drive_turn = dot3(motion->axis, world->omega[wheel->drive_body]);
}

/* A wheel for itself, as if it had no powertrain. */
static int turn_wheel(World *world, int index, const double *fast, double *rate)
{
    const Wheel *wheel = &world->model->wheel[index];
    const WheelMotion *motion = &world->motion[index];
    Rolling *rolling = &world->rolling[index];
    const Tire *tire = &world->model->tire[wheel->tire];
    const Ground ground = {world->road, world->lane, world->time};
    const double *spin = &fast[FAST_SPIN];
    const double drive = wheel->drive ? world_law(world, wheel->drive, spin) : 0;
    const double brake = wheel->brake ? world_law(world, wheel->brake, spin) : 0;
    const int status = wheel_touch(wheel, tire, &ground, motion, rolling);
    world->touch[index] = (Touch){rolling->deflection, rolling->deflection_rate, rolling->elastic, rolling->damping};
    if (status == GIC_OK)
        wheel_turn(wheel, tire, motion, drive, brake, fast, rate, rolling);
    return status;
}

int world_wheels_turn(World *world, const double *fast, double *rate)
{
    const Model *model = world->model;
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *wheel = &model->wheel[i];
        const int at = wheel->fast;
        int status = GIC_OK;
        if (wheel->tire >= 0)
            status = turn_wheel(world, i, fast + at, rate + at);
        if (status != GIC_OK)
            return status;
    }
    for (int i = 0; i < model->states; ++i)
        rate[model->state[i].fast] = model->state[i].rate ? world_law(world, model->state[i].rate, NULL) : 0;
    if (model->powertrain)
        world_drive(world, fast, rate);
    return GIC_OK;
}

static void add_tire(World *world, int index)
{
    const Wheel *wheel = &world->model->wheel[index];
    const WheelMotion *motion = &world->motion[index];
    const Rolling *rolling = &world->rolling[index];
    const double post = world_post(world, wheel, 0);
    double arm[3], moment[3], *carrier = world->wrench[wheel->body], *driver = world->wrench[wheel->drive_body] + 3;
    sub3(motion->center, world->q[wheel->body], arm);
    arm[2] += post;
    cross3(arm, rolling->force, moment);
    add3(carrier, rolling->force, carrier);
    add3(carrier + 3, moment, carrier + 3);
    add3(carrier + 3, rolling->torque, carrier + 3);
    add3(driver, rolling->reaction, driver);
    world->power += rolling->power + rolling->force[2] * world_post(world, wheel, 1);
    memcpy(world->wheel[index],
           (const double[4]){rolling->fz, rolling->deflection, rolling->deflection_rate, rolling->height + post},
           sizeof world->wheel[index]);
}

/* Wheels, with tires or not. */
static int add_wheels(World *world)
{
    const Model *model = world->model;
    int status = GIC_OK;
    for (int i = 0; i < model->wheels && status == GIC_OK; ++i)
        if (model->wheel[i].tire < 0)
            status = add_contact(world, i);
        else
            world_wheel_motion(world, i, &world->motion[i]);
    if (status == GIC_OK)
        status = world_wheels_turn(world, world->fast, world->fast_rate);
    for (int i = 0; i < model->wheels && status == GIC_OK; ++i)
        if (model->wheel[i].tire >= 0)
            add_tire(world, i);
    return status;
}

int world_forces(World *world)
{
    const Model *model = world->model;
    for (int b = 0; b < world->bodies; ++b) {
        for (int i = 0; i < 3; ++i) {
            world->wrench[b][i] = model->body[b].mass * model->gravity[i];
            world->wrench[b][3 + i] = 0;
        }
    }
    memset(world->along, 0, (size_t)model->coordinates * sizeof *world->along);
    world->potential = world->stored = world->power = 0;
    world->shortest = INFINITY;
    world->unclear = false;
    const int status = add_wheels(world);
    if (status != GIC_OK)
        return status;
    for (int i = 0; i < model->forces; ++i)
        add_force(world, world->order[i]);
    for (int i = 0; i < model->ports; ++i) {
        const Port *port = &model->port[i];
        add_load(world, port->body, port->in, port->point, world->port + 6 * i);
    }
    world->power += world->stored;
    return GIC_OK;
}

void world_push(World *world, int coordinate, double force)
{
    /* the multiplier of Psi: Psi_w^T multiplier = force */
    const Tie *tie = &world->tie[world->coordinate_tie[coordinate]];
    const double *J = world->J + ROW_J * tie->first, multiplier = force / world->dual[coordinate];
    for (int end = 0; end < 2; ++end, J += BODY_Q) {
        double *wrench = world->wrench[tie->body[end]], torque[3];
        add_scaled3(-multiplier, J, wrench);
        euler_turn(world->q[tie->body[end]] + 3, J + 3, torque); /* the p part is 2 E^T torque */
        add_scaled3(-0.5 * multiplier, torque, wrench + 3);
    }
}

void world_spread(World *world)
{
    for (int c = 0; c < world->model->coordinates; ++c)
        if (world->along[c] != 0)
            world_push(world, c, world->along[c]);
}
