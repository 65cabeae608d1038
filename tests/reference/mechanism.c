/* SPDX-License-Identifier: MIT
 * Every constraint is put together from vectors that carry their own derivatives, by differences and dot products. */
#include "mechanism.h"

#include "support.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

Configuration *configuration_new(const Model *model)
{
    Configuration *configuration = grab(1, sizeof *configuration);
    configuration->q = grab((size_t)model->bodies, sizeof *configuration->q);
    configuration->rate = grab((size_t)model->bodies, sizeof *configuration->rate);
    configuration->w = grab((size_t)model->coordinates, sizeof *configuration->w);
    configuration->w_rate = grab((size_t)model->coordinates, sizeof *configuration->w_rate);
    return configuration;
}

void configuration_free(Configuration *configuration)
{
    free(configuration->q);
    free(configuration->rate);
    free(configuration->w);
    free(configuration->w_rate);
    free(configuration);
}

void configuration_copy(const Model *model, Configuration *to, const Configuration *from)
{
    memcpy(to->q, from->q, (size_t)model->bodies * sizeof *to->q);
    memcpy(to->rate, from->rate, (size_t)model->bodies * sizeof *to->rate);
    memcpy(to->w, from->w, (size_t)model->coordinates * sizeof *to->w);
    memcpy(to->w_rate, from->w_rate, (size_t)model->coordinates * sizeof *to->w_rate);
}

/* A vector of the world frame that depends on the coordinates of two bodies. */
typedef struct Arrow {
    quad value[3], rate[3], bias[3];
    bool on[2]; /* which of the two it depends on */
    quad slope[2][3][BODY_COORDINATES];
} Arrow;

/* The vector u fixed in a body, which is number `side` of the pair. */
static Arrow fixed_vector(const Configuration *configuration, int body, int side, const quad u[3])
{
    Arrow arrow = {.on = {side == 0, side == 1}};
    const quad *q = configuration->q[body], *rate = configuration->rate[body];
    quad B[3][4], B_rate[3][4];
    rotation_slope(q + 3, u, B);
    rotate(q + 3, u, arrow.value);
    for (int i = 0; i < 3; ++i)
        memcpy(arrow.slope[side][i] + 3, B[i], sizeof B[i]);
    /* most evaluations are about positions alone */
    if (rate[3] == 0 && rate[4] == 0 && rate[5] == 0 && rate[6] == 0)
        return arrow;
    rotation_slope(rate + 3, u, B_rate);
    for (int i = 0; i < 3; ++i) {
        arrow.rate[i] = quad_dot(B[i], rate + 3, 4);
        arrow.bias[i] = quad_dot(B_rate[i], rate + 3, 4);
    }
    return arrow;
}

/* The place of a point of a body, s from its centre of mass. */
static Arrow body_point(const Configuration *configuration, int body, int side, const quad s[3])
{
    Arrow arrow = fixed_vector(configuration, body, side, s);
    for (int i = 0; i < 3; ++i) {
        arrow.value[i] += configuration->q[body][i];
        arrow.rate[i] += configuration->rate[body][i];
        arrow.slope[side][i][i] = 1;
    }
    return arrow;
}

/* x_b - x_a of two points given in the frames of their bodies. */
static Arrow point_to_point(const Model *model, const Configuration *configuration, const int body[2],
                            const double point[2][3])
{
    quad s[2][3];
    from_com(model, body[0], point[0], s[0]);
    from_com(model, body[1], point[1], s[1]);
    Arrow a = body_point(configuration, body[0], 0, s[0]), b = body_point(configuration, body[1], 1, s[1]);
    b.on[0] = true;
    for (int i = 0; i < 3; ++i) {
        b.value[i] -= a.value[i];
        b.rate[i] -= a.rate[i];
        b.bias[i] -= a.bias[i];
        for (int j = 0; j < BODY_COORDINATES; ++j)
            b.slope[0][i][j] = -a.slope[0][i][j];
    }
    return b;
}

static Row dot(const Arrow *a, const Arrow *b)
{
    Row row = {.coordinate = -1,
               .value = quad_dot(a->value, b->value, 3),
               .rate = quad_dot(a->value, b->rate, 3) + quad_dot(a->rate, b->value, 3),
               .bias =
                   quad_dot(a->value, b->bias, 3) + 2 * quad_dot(a->rate, b->rate, 3) + quad_dot(a->bias, b->value, 3)};
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < BODY_COORDINATES; ++j) {
                if (b->on[side])
                    row.slope[side][j] += a->value[i] * b->slope[side][i][j];
                if (a->on[side])
                    row.slope[side][j] += b->value[i] * a->slope[side][i][j];
            }
    return row;
}

static Row component(const Arrow *a, int i)
{
    Row row = {.coordinate = -1, .value = a->value[i], .rate = a->rate[i], .bias = a->bias[i]};
    for (int side = 0; side < 2; ++side)
        memcpy(row.slope[side], a->slope[side][i], sizeof row.slope[side]);
    return row;
}

static void widen(const double *from, quad *to, int size)
{
    for (int i = 0; i < size; ++i)
        to[i] = from[i];
}

/* Two unit vectors that make a right-handed frame with the unit vector u. */
static void perpendiculars(const quad u[3], quad t[2][3])
{
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (fabsq(u[i]) < fabsq(u[least]))
            least = i;
    quad unit[3] = {0};
    unit[least] = 1;
    quad_cross(u, unit, t[0]);
    quad norm = sqrtq(quad_dot(t[0], t[0], 3));
    for (int i = 0; i < 3; ++i)
        t[0][i] /= norm;
    quad_cross(u, t[0], t[1]);
}

/* Unit vector i of the model frame, fixed in a body at design. */
static Arrow model_axis(const Model *model, const Configuration *configuration, int body, int side, int i)
{
    quad p[4], unit[3] = {0}, u[3];
    unit[i] = 1;
    widen(model->body[body].euler, p, 4);
    quad norm = sqrtq(quad_dot(p, p, 4));
    for (int k = 0; k < 4; ++k)
        p[k] /= norm;
    rotate_back(p, unit, u);
    return fixed_vector(configuration, body, side, u);
}

/* x_a = x_b */
static Row *points_meet(Row *row, const Arrow *d)
{
    for (int i = 0; i < 3; ++i)
        *row++ = component(d, i);
    return row;
}

/* The vector is parallel to an axis of body a: nothing of it across. */
static Row *along_axis(Row *row, const Configuration *configuration, int a, const quad axis[3], const Arrow *vector)
{
    quad across[2][3];
    perpendiculars(axis, across);
    for (int i = 0; i < 2; ++i) {
        Arrow t = fixed_vector(configuration, a, 0, across[i]);
        *row++ = dot(&t, vector);
    }
    return row;
}

/* b does not rotate relative to a: three pairs of axes that stay perpendicular. */
static Row *no_rotation(Row *row, const Model *model, const Configuration *configuration, const int body[2])
{
    for (int i = 0; i < 3; ++i) {
        Arrow f = model_axis(model, configuration, body[0], 0, i);
        Arrow g = model_axis(model, configuration, body[1], 1, (i + 1) % 3);
        *row++ = dot(&f, &g);
    }
    return row;
}

/* row = c row + s other, of two rows that concern the same bodies */
static void combine(Row *row, quad c, quad s, const Row *other)
{
    row->value = c * row->value + s * other->value;
    row->rate = c * row->rate + s * other->rate;
    row->bias = c * row->bias + s * other->bias;
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j < BODY_COORDINATES; ++j)
            row->slope[side][j] = c * row->slope[side][j] + s * other->slope[side][j];
}

/* The turn about the axis is `way` over the ratio, way = v . d: e_2.f_1 cos - e_1.f_1 sin of that angle vanishes. */
static Row geared(const Configuration *configuration, const Joint *joint, const Arrow *v, const Arrow *d)
{
    quad axis[3], side[2][3], third[3];
    widen(joint->axis[0], axis, 3);
    widen(joint->side[0], side[0], 3);
    widen(joint->side[1], side[1], 3);
    quad_cross(axis, side[0], third);
    const Arrow e_1 = fixed_vector(configuration, joint->body[0], 0, side[0]),
                e_2 = fixed_vector(configuration, joint->body[0], 0, third),
                f_1 = fixed_vector(configuration, joint->body[1], 1, side[1]);
    const Row x = dot(&e_1, &f_1), y = dot(&e_2, &f_1), way = dot(v, d);
    const quad angle = way.value / joint->offset, rate = way.rate / joint->offset;
    const quad c = cosq(angle), s = sinq(angle);
    Row row = y;
    combine(&row, c, -s, &x);
    const quad value = row.value;
    combine(&row, 1, -(s * y.value + c * x.value) / joint->offset, &way);
    row.value = value;
    row.bias -= 2 * (s * y.rate + c * x.rate) * rate; /* and -value rate^2, where the value is zero */
    return row;
}

quad law_slope(const Model *model, const Configuration *at, const Formula *law, int coordinate)
{
    quad way[model->coordinates + 1];
    for (int c = 0; c < model->coordinates; ++c)
        way[c] = c == coordinate;
    return formula_series(law, at->w, way).c[1];
}

static Row angle_row(const Configuration *configuration, const Coordinate *coordinate, quad theta, quad theta_rate);

/* As a coordinate has it, of which the formula is value, rate and, but for w'', second derivative. */
static Row coupled(const Model *model, const Configuration *configuration, const Joint *joint)
{
    const Series f = formula_series(joint->value, configuration->w, configuration->w_rate);
    const quad value = f.c[0] - joint->offset, rate = f.c[1], second = 2 * f.c[2];
    Row row;
    if (joint->type == GEARED) {
        Coordinate like = {.body = {joint->body[0], joint->body[1]}};
        memcpy(like.axis, joint->axis[0], sizeof like.axis);
        memcpy(like.reference, joint->side, sizeof like.reference);
        row = angle_row(configuration, &like, value, rate);
    } else {
        quad axis[3];
        widen(joint->axis[0], axis, 3);
        const Arrow d = point_to_point(model, configuration, joint->body, joint->point),
                    u = fixed_vector(configuration, joint->body[0], 0, axis);
        row = dot(&u, &d);
        row.value -= value;
        row.w_slope = -1;
        row.rate -= rate;
    }
    row.bias += row.w_slope * second;
    row.coordinate = -1;
    row.follows = joint->value;
    return row;
}

static void joint_evaluate(const Model *model, const Configuration *configuration, const Joint *joint, Row *row)
{
    int a = joint->body[0];
    quad axis[2][3];
    Arrow d = point_to_point(model, configuration, joint->body, joint->point), u[2];
    for (int side = 0; side < 2; ++side) {
        widen(joint->axis[side], axis[side], 3);
        u[side] = fixed_vector(configuration, joint->body[side], side, axis[side]);
    }
    Row *start = row;
    switch (joint->type) {
    case REVOLUTE:
        row = points_meet(row, &d);
        row = along_axis(row, configuration, a, axis[0], &u[1]);
        break;
    case SPHERICAL: row = points_meet(row, &d); break;
    case PRISMATIC:
        row = no_rotation(row, model, configuration, joint->body);
        row = along_axis(row, configuration, a, axis[0], &d);
        break;
    case CYLINDRICAL:
        row = along_axis(row, configuration, a, axis[0], &u[1]);
        row = along_axis(row, configuration, a, axis[0], &d);
        break;
    case UNIVERSAL:
        row = points_meet(row, &d);
        *row++ = dot(&u[0], &u[1]);
        break;
    case FIXED:
        row = points_meet(row, &d);
        row = no_rotation(row, model, configuration, joint->body);
        break;
    case REVOLUTE_SPHERICAL:
        *row = dot(&u[0], &d);
        row++->value -= joint->offset;
        /* fall through */
    case DISTANCE:
        *row = dot(&d, &d);
        row++->value -= (quad)joint->length * joint->length;
        break;
    case POINT_ON_LINE: row = along_axis(row, configuration, a, axis[0], &d); break;
    case POINT_IN_PLANE: *row++ = dot(&u[0], &d); break;
    case PARALLEL: row = along_axis(row, configuration, a, axis[0], &u[1]); break;
    case PERPENDICULAR: *row++ = dot(&u[0], &u[1]); break;
    case SCREW: *row++ = geared(configuration, joint, &u[0], &d); break;
    case RACK_AND_PINION:
        widen(joint->side[0], axis[1], 3);
        u[1] = fixed_vector(configuration, a, 0, axis[1]);
        *row++ = geared(configuration, joint, &u[1], &d);
        break;
    case GEARED:
    case COUPLED: *row++ = coupled(model, configuration, joint); break;
    case JOINT_TYPES: break;
    }
    for (Row *r = start; r < row; ++r)
        memcpy(r->body, joint->body, sizeof r->body);
}

/* e_2.f_1 cos(theta) - e_1.f_1 sin(theta) = 0: the angle of FORMAT.md section 5 without a branch cut, so that it goes
 * on over any number of turns. */
static Row angle_row(const Configuration *configuration, const Coordinate *coordinate, quad theta, quad theta_rate)
{
    int a = coordinate->body[0], b = coordinate->body[1];
    quad axis[3], reference[2][3], third[3];
    widen(coordinate->axis, axis, 3);
    widen(coordinate->reference[0], reference[0], 3);
    widen(coordinate->reference[1], reference[1], 3);
    quad_cross(axis, reference[0], third);
    Arrow e_1 = fixed_vector(configuration, a, 0, reference[0]), e_2 = fixed_vector(configuration, a, 0, third),
          f_1 = fixed_vector(configuration, b, 1, reference[1]);
    Row y = dot(&e_2, &f_1), x = dot(&e_1, &f_1);
    quad c = cosq(theta), s = sinq(theta);
    Row row = y;
    combine(&row, c, -s, &x);
    row.w_slope = -(s * y.value + c * x.value);
    row.bias -= 2 * (s * y.rate + c * x.rate) * theta_rate; /* and -value theta_rate^2, where the value is zero */
    row.rate += row.w_slope * theta_rate;
    return row;
}

static Row coordinate_evaluate(const Model *model, const Configuration *configuration, int index)
{
    const Coordinate *coordinate = &model->coordinate[index];
    quad w = configuration->w[index], w_rate = configuration->w_rate[index];
    Row row;
    if (coordinate->type == ANGLE) {
        row = angle_row(configuration, coordinate, w - coordinate->design, w_rate);
    } else {
        Arrow d = point_to_point(model, configuration, coordinate->body, coordinate->point);
        if (coordinate->type == LENGTH) {
            row = dot(&d, &d);
            row.value -= w * w;
            row.w_slope = -2 * w;
            row.rate -= 2 * w * w_rate;
            row.bias -= 2 * w_rate * w_rate;
        } else {
            quad axis[3];
            widen(coordinate->axis, axis, 3);
            Arrow u = fixed_vector(configuration, coordinate->body[0], 0, axis);
            row = dot(&u, &d);
            row.value -= w + coordinate->offset - coordinate->design;
            row.w_slope = -1;
            row.rate -= w_rate;
        }
    }
    row.body[0] = coordinate->body[0];
    row.body[1] = coordinate->body[1];
    row.coordinate = index;
    return row;
}

int joint_row(const Model *model, int joint)
{
    int row = 0;
    for (int i = 0; i < joint; ++i)
        row += joint_rows[model->joint[i].type];
    return row;
}

int row_count(const Model *model)
{
    return joint_row(model, model->joints) + model->coordinates;
}

void rows_evaluate(const Model *model, const Configuration *configuration, Row *rows)
{
    for (int i = 0; i < model->joints; ++i) {
        joint_evaluate(model, configuration, &model->joint[i], rows);
        rows += joint_rows[model->joint[i].type];
    }
    for (int i = 0; i < model->coordinates; ++i)
        rows[i] = coordinate_evaluate(model, configuration, i);
}

void from_com(const Model *model, int body, const double point[3], quad out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = (quad)point[i] - model->body[body].com[i];
}

void add_force(const Configuration *configuration, int body, const quad point[3], const quad F[3],
               quad (*Q)[BODY_COORDINATES])
{
    quad B[3][4];
    rotation_slope(configuration->q[body] + 3, point, B);
    for (int i = 0; i < 3; ++i) {
        Q[body][i] += F[i];
        for (int j = 0; j < 4; ++j)
            Q[body][3 + j] += B[i][j] * F[i];
    }
}

void point_motion(const Model *model, const Configuration *configuration, int body, const double point[3], quad x[3],
                  quad v[3])
{
    if (body == GROUND) {
        widen(point, x, 3);
        memset(v, 0, 3 * sizeof *v);
        return;
    }
    quad s[3];
    from_com(model, body, point, s);
    Arrow arrow = body_point(configuration, body, 0, s);
    memcpy(x, arrow.value, sizeof arrow.value);
    memcpy(v, arrow.rate, sizeof arrow.rate);
}

/* `find` of a law. The first inputs are those of driven coordinates (FORMAT.md section 5). */
static quad of_law(const Model *model, const Configuration *configuration, const Formula *law, Locals local,
                   quad (*find)(const Formula *formula, const Surroundings *around))
{
    if (!law)
        return 0;
    quad input[model->inputs + 1];
    int next = 0;
    for (int i = 0; i < model->inputs; ++i)
        input[i] = model->input[i];
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].driven) {
            input[next] = configuration->w[c];
            input[next + 1] = configuration->w_rate[c];
            next += 3;
        }
    Surroundings around = {.w = configuration->w,
                           .w_rate = configuration->w_rate,
                           .input = input,
                           .state = model->state,
                           .table = model->table,
                           .local = local,
                           .model = model,
                           .configuration = configuration};
    return find(law, &around);
}

quad law_value(const Model *model, const Configuration *configuration, const Formula *law, Locals local)
{
    return of_law(model, configuration, law, local, formula_value);
}

quad law_size(const Model *model, const Configuration *configuration, const Formula *law, Locals local)
{
    return of_law(model, configuration, law, local, formula_size);
}

/* Contact at one end of a stop, `depth` beyond it. */
static quad contact(const Force *force, quad depth, quad rate)
{
    if (depth <= 0)
        return 0;
    quad s = depth < force->fade ? depth / force->fade : 1;
    quad push = force->table ? lookup_at(force->table, depth) : force->stiffness * depth;
    return fmaxq(0, push + force->damping * (3 * s * s - 2 * s * s * s) * rate);
}

/* What spring and damper, or a stop, do against a growing length, angle or coordinate. */
static quad resistance(const Force *force, quad value, quad rate)
{
    if (force->stop)
        return contact(force, value - force->high, rate) - contact(force, force->low - value, -rate);
    quad extension = value - force->free;
    return (force->table ? lookup_at(force->table, extension) : force->stiffness * extension) + force->damping * rate;
}

/* From the first of its points to the second, with length and rate. */
static void span(const Model *model, const Configuration *configuration, const Force *force, quad d[3], quad *length,
                 quad *rate)
{
    quad x[2][3], v[2][3], d_rate[3];
    for (int k = 0; k < 2; ++k)
        point_motion(model, configuration, force->body[k], force->point[k], x[k], v[k]);
    for (int i = 0; i < 3; ++i) {
        d[i] = x[1][i] - x[0][i];
        d_rate[i] = v[1][i] - v[0][i];
    }
    *length = sqrtq(quad_dot(d, d, 3));
    *rate = quad_dot(d, d_rate, 3) / *length;
}

static void add_between(const Model *model, const Configuration *configuration, const Force *force,
                        quad (*Q)[BODY_COORDINATES])
{
    quad d[3], length, rate;
    span(model, configuration, force, d, &length, &rate);
    quad tension = resistance(force, length, rate) +
                   law_value(model, configuration, force->law[0], (Locals){.length = length, .speed = rate});
    for (int k = 0; k < 2; ++k) {
        if (force->body[k] == GROUND)
            continue;
        quad F[3], s[3];
        for (int i = 0; i < 3; ++i)
            F[i] = (k == 0 ? tension : -tension) * d[i] / length;
        from_com(model, force->body[k], force->point[k], s);
        add_force(configuration, force->body[k], s, F, Q);
    }
}

/* A vector of the world frame for `side`, of a body or of the ground. */
static Arrow direction(const Configuration *configuration, int body, int side, const quad u[3])
{
    if (body != GROUND)
        return fixed_vector(configuration, body, side, u);
    Arrow arrow = {.on = {false, false}};
    memcpy(arrow.value, u, sizeof arrow.value);
    return arrow;
}

/* The angle atan2(y, x), y = e_2 . f_1, x = e_1 . f_1: its slopes and rate; its value by itself. */
static Row turned(const Configuration *configuration, const Force *force, quad *value)
{
    quad axis[3], reference[2][3], third[3];
    widen(force->axis, axis, 3);
    widen(force->reference[0], reference[0], 3);
    widen(force->reference[1], reference[1], 3);
    quad_cross(axis, reference[0], third);
    Arrow e_1 = direction(configuration, force->body[0], 0, reference[0]),
          e_2 = direction(configuration, force->body[0], 0, third),
          f_1 = direction(configuration, force->body[1], 1, reference[1]);
    Row x = dot(&e_1, &f_1), angle = dot(&e_2, &f_1);
    quad square = x.value * x.value + angle.value * angle.value;
    *value = atan2q(angle.value, x.value);
    combine(&angle, x.value / square, -angle.value / square, &x);
    return angle;
}

/* Virtual work of a torque against that angle. */
static void add_about(const Model *model, const Configuration *configuration, const Force *force,
                      quad (*Q)[BODY_COORDINATES])
{
    quad value;
    Row angle = turned(configuration, force, &value);
    quad torque = resistance(force, value, angle.rate) +
                  law_value(model, configuration, force->law[0], (Locals){.length = value, .speed = angle.rate});
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j < BODY_COORDINATES && force->body[side] != GROUND; ++j)
            Q[force->body[side]][j] -= torque * angle.slope[side][j];
}

/* ---- bushings, FORMAT.md section 7.5: displacements and rotations with their own slopes, along which force and torque
 * do virtual work */

/* sum += factor times row */
static void add_row(Row *sum, quad factor, const Row *row)
{
    combine(sum, 1, factor, row);
}

static Arrow bushing_axis(const Configuration *configuration, const Force *force, int side, int i)
{
    const double *frame = force->frame[side];
    return direction(configuration, force->body[side], side, (const quad[3]){frame[i], frame[3 + i], frame[6 + i]});
}

static Arrow bushing_point(const Model *model, const Configuration *configuration, const Force *force, int side)
{
    quad s[3];
    if (force->body[side] == GROUND) {
        Arrow arrow = {.on = {false, false}};
        widen(force->point[side], arrow.value, 3);
        return arrow;
    }
    from_com(model, force->body[side], force->point[side], s);
    return body_point(configuration, force->body[side], side, s);
}

/* The rotation vector: s = n sin(angle) and the cosine by the matrix of direction cosines, then s angle / sin(angle).
 */
static void bushing_turn(Arrow axis[2][3], Row out[3])
{
    Row s[3], cosine = {.value = -0.5}, sine = {.value = 0}, angle, part;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        s[i] = (Row){.value = 0};
        part = dot(&axis[0][k], &axis[1][j]);
        add_row(&s[i], 0.5, &part);
        part = dot(&axis[0][j], &axis[1][k]);
        add_row(&s[i], -0.5, &part);
        part = dot(&axis[0][i], &axis[1][i]);
        add_row(&cosine, 0.5, &part);
    }
    const quad size = sqrtq(s[0].value * s[0].value + s[1].value * s[1].value + s[2].value * s[2].value);
    quad share = 1 + size * size / 6; /* angle over sine */
    Row share_row = {.value = 0};     /* and its change */
    if (size < 1e-8 && cosine.value > 0) {
        for (int i = 0; i < 3; ++i)
            add_row(&share_row, s[i].value / 3, &s[i]);
    } else {
        for (int i = 0; i < 3; ++i)
            add_row(&sine, s[i].value / size, &s[i]);
        const quad square = size * size + cosine.value * cosine.value, turned_by = atan2q(size, cosine.value);
        angle = (Row){.value = 0};
        add_row(&angle, cosine.value / square, &sine);
        add_row(&angle, -size / square, &cosine);
        share = turned_by / size;
        add_row(&share_row, 1 / size, &angle);
        add_row(&share_row, -share / size, &sine);
    }
    for (int i = 0; i < 3; ++i) {
        out[i] = (Row){.value = 0};
        add_row(&out[i], share, &s[i]);
        add_row(&out[i], s[i].value, &share_row);
        out[i].value = share * s[i].value;
    }
}

static void bushing_rows(const Model *model, const Configuration *configuration, const Force *force, Row out[6])
{
    Arrow axis[2][3], a = bushing_point(model, configuration, force, 0),
                      b = bushing_point(model, configuration, force, 1);
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < 3; ++i)
            axis[side][i] = bushing_axis(configuration, force, side, i);
    for (int i = 0; i < 3; ++i) {
        Row far = dot(&axis[0][i], &b), near = dot(&axis[0][i], &a);
        out[i] = far;
        add_row(&out[i], -1, &near);
    }
    bushing_turn(axis, out + 3);
}

quad bushing_cosine(const Configuration *configuration, const Force *force)
{
    quad cosine = -0.5;
    for (int i = 0; i < 3; ++i) {
        const Arrow a = bushing_axis(configuration, force, 0, i), b = bushing_axis(configuration, force, 1, i);
        cosine += quad_dot(a.value, b.value, 3) / 2;
    }
    return cosine;
}

void bushing_strain(const Model *model, const Configuration *configuration, int force, quad x[6], quad rate[6])
{
    Row row[6];
    bushing_rows(model, configuration, &model->force[force], row);
    for (int i = 0; i < 6; ++i) {
        x[i] = row[i].value;
        rate[i] = row[i].rate;
    }
}

static void add_bushing(const Model *model, const Configuration *configuration, const Force *force,
                        quad (*Q)[BODY_COORDINATES])
{
    Row row[6];
    Locals local = {0};
    bushing_rows(model, configuration, force, row);
    for (int i = 0; i < 6; ++i) {
        local.bushing[i] = row[i].value;
        local.bushing[6 + i] = row[i].rate;
    }
    for (int i = 0; i < 6; ++i) {
        quad along = law_value(model, configuration, force->law[i], local);
        for (int j = 0; j < 6; ++j)
            along -= force->stiffness_matrix[6 * i + j] * row[j].value + force->damping_matrix[6 * i + j] * row[j].rate;
        for (int side = 0; side < 2; ++side)
            for (int j = 0; j < BODY_COORDINATES && force->body[side] != GROUND; ++j)
                Q[force->body[side]][j] += along * row[i].slope[side][j];
    }
}

/* 2 G^T times its components in the body */
void add_torque(const Configuration *configuration, int body, const quad torque[3], quad (*Q)[BODY_COORDINATES])
{
    quad own[3], G[3][4];
    rotate_back(configuration->q[body] + 3, torque, own);
    euler_rate_matrix(configuration->q[body] + 3, G);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j)
            Q[body][3 + j] += 2 * G[i][j] * own[i];
}

/* FORMAT.md section 7.2, in the axes of the body. */
static void aero(const Model *model, const Configuration *configuration, const Force *force, quad load[6])
{
    const int body = force->body[0];
    quad x[3], v[3], u[3], coefficient[7], level, speed;
    point_motion(model, configuration, body, force->point[0], x, v);
    for (int i = 0; i < 3; ++i)
        v[i] -= law_value(model, configuration, force->law[7 + i], (Locals){0});
    rotate_back(configuration->q[body] + 3, v, u);
    level = hypotq(u[0], u[1]);
    speed = hypotq(level, u[2]);
    const Locals local = {.airspeed = speed,
                          .sideslip = level > 0 ? atan2q(u[1], u[0]) : 0,
                          .incidence = speed > 0 ? atan2q(-u[2], level) : 0};
    for (int i = 0; i < 7; ++i)
        coefficient[i] = law_value(model, configuration, force->law[i], local);
    const quad density = law_value(model, configuration, force->law[10], (Locals){0});
    const quad pressed = density * speed * speed / 2 * force->area; /* dynamic pressure times area */
    for (int i = 0; i < 3; ++i) {
        load[i] = pressed * coefficient[i] - density / 2 * force->area * coefficient[6] * speed * u[i];
        load[3 + i] = pressed * force->reference_length * coefficient[3 + i];
    }
}

static void add_load(const Model *model, const Configuration *configuration, const Force *force,
                     quad (*Q)[BODY_COORDINATES])
{
    quad given[6], world[6], s[3];
    int body = force->body[0], in = force->body[1];
    for (int i = 0; i < 6 && !force->aero; ++i)
        given[i] = law_value(model, configuration, force->law[i], (Locals){0});
    if (force->aero)
        aero(model, configuration, force, given);
    memcpy(world, given, sizeof world);
    for (int part = 0; in != GROUND && part < 2; ++part)
        rotate(configuration->q[in] + 3, given + 3 * part, world + 3 * part);
    from_com(model, body, force->point[0], s);
    add_force(configuration, body, s, world, Q);
    add_torque(configuration, body, world + 3, Q);
}

quad element_value(const Model *model, const Configuration *configuration, int force)
{
    const Force *element = &model->force[force];
    quad value, rate;
    element_extension(model, configuration, force, &value, &rate);
    quad law = law_value(model, configuration, element->law[0], (Locals){.length = value, .speed = rate});
    quad against = resistance(element, value, rate);
    return element->coordinate >= 0 ? law - against : law + against;
}

void add_force_element(const Model *model, const Configuration *configuration, const Row *rows, int force,
                       quad (*Q)[BODY_COORDINATES])
{
    const Force *element = &model->force[force];
    if (element->coordinate < 0) {
        void (*add)(const Model *, const Configuration *, const Force *, quad(*)[BODY_COORDINATES]) =
            element->load      ? add_load
            : element->about   ? add_about
            : element->bushing ? add_bushing
                               : add_between;
        add(model, configuration, element, Q);
        return;
    }
    int c = element->coordinate;
    quad along = element_value(model, configuration, force);
    /* virtual work: along * dw, with dw = -(dc/dq dq) / (dc/dw) */
    const Row *row = &rows[joint_row(model, model->joints) + c];
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j < BODY_COORDINATES; ++j)
            Q[row->body[side]][j] -= along * row->slope[side][j] / row->w_slope;
}

void element_extension(const Model *model, const Configuration *configuration, int force, quad *value, quad *rate)
{
    const Force *element = &model->force[force];
    quad d[3];
    if (element->coordinate >= 0) {
        *value = configuration->w[element->coordinate];
        *rate = configuration->w_rate[element->coordinate];
    } else if (element->about) {
        *rate = turned(configuration, element, value).rate;
    } else {
        span(model, configuration, element, d, value, rate);
    }
}
