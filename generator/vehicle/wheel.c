/* SPDX-License-Identifier: MIT
 * Wheels with tires (models/TIRES.md sections 3 and 4): contact with the road and slip, the tire's forces, the
 * wheel's spin and the load on its carrier. Wheels with the same tire are one class: one function, with a row of
 * constants for each wheel. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

#include <string.h>

typedef struct Build {
    const Model *model;
    Dag *dag;
    WheelClass *class;
    const Wheel *first;
    const Tire *tire;
    Ex mirror;                       /* -1 if mounted on the side other than the tire's own, else 1 */
    Ex c[3], v[3], s[3], omega[3];   /* from link[] */
    Ex spin, slip_x, slip_y, windup; /* fast states */
} Build;

/* ---- pieces --------------------------------------------------------------------------------------------------- */

static void read_array(Dag *dag, Array array, int offset, int count, const double *sample, Ex *out)
{
    for (int i = 0; i < count; ++i) {
        double value[dag->samples];
        for (int s = 0; s < dag->samples; ++s)
            value[s] = sample[i];
        out[i] = ex_input(dag, element_at(array, offset + i), value);
    }
}

/* A number of each member of the class with its name; `at`: the number of the first one. */
static Ex member_number(const Build *b, const char *name, const double *at)
{
    double value[b->class->members];
    ptrdiff_t offset = (const char *)at - (const char *)b->first;
    for (int i = 0; i < b->class->members; ++i)
        memcpy(&value[i], (const char *)&b->model->wheel[b->class->member[i]] + offset, sizeof *value);
    const Ex e = ex_constant(b->dag, value);
    ex_describe(b->dag, e, "%s.%s", b->first->name, name);
    return e;
}

static Ex absolute(Dag *dag, Ex x)
{
    return ex_op(dag, OP_ABS, x, 0, 0);
}

Ex positive_part(Dag *dag, Ex x)
{
    return ex_op(dag, OP_MAX, x, 0, 0);
}

Ex smooth_step(Dag *dag, Ex s)
{
    s = ex_op(dag, OP_MIN, positive_part(dag, s), ex_literal(dag, 1), 0);
    return ex_mul(dag, ex_mul(dag, s, s), ex_sub(dag, ex_literal(dag, 3), ex_add(dag, s, s)));
}

static Ex norm(Dag *dag, const Ex x[3])
{
    return ex_sqrt(dag, ex_dot(dag, x, x));
}

static void divide3(Dag *dag, const Ex x[3], Ex by, Ex out[3])
{
    ex_scale3(dag, ex_div(dag, ex_literal(dag, 1), by), x, out);
}

/* out = unit vector along s x n, with a bound for a wheel that lies flat. */
static void forwards(Dag *dag, const Ex s[3], const Ex n[3], Ex out[3])
{
    const double least = 1e-6;
    Ex t[3];
    ex_cross(dag, s, n, t);
    divide3(dag, t, ex_op(dag, OP_MAX, norm(dag, t), ex_literal(dag, least), 0), out);
}

/* Normal of the road at (x, y); *height there. */
static void road_normal(Dag *dag, Ex x, Ex y, Ex n[3], Ex *height)
{
    Ex road = ex_op(dag, OP_ROAD, x, y, 0);
    *height = ex_op(dag, OP_ROAD_PART, road, 0, 0);
    n[0] = ex_neg(dag, ex_op(dag, OP_ROAD_PART, road, 1, 0));
    n[1] = ex_neg(dag, ex_op(dag, OP_ROAD_PART, road, 2, 0));
    n[2] = ex_literal(dag, 1);
    divide3(dag, n, norm(dag, n), n);
}

static void store3(Block *block, const Ex x[3], Array array, int offset)
{
    for (int i = 0; i < 3; ++i)
        block_store(block, x[i], element_at(array, offset + i));
}

/* ---- contact and slip ------------------------------------------------------------------------------------------- */

/* The contact of the wheel with the road. */
typedef struct Contact {
    Ex x[3], y[3], n[3], arm[3];
    Ex camber, radius, deflection, rate, fade, load, press, height, v[3] /* v_P */;
} Contact;

static Contact contact_with_road(const Build *b)
{
    const double least_cosine = 0.05;
    Dag *dag = b->dag;
    const Tire *tire = b->tire;
    Contact at;
    Ex under[3], p[3], g[3], d[3], t[3], rolling[3], height;
    road_normal(dag, b->c[0], b->c[1], under, &height);
    forwards(dag, b->s, under, t);
    ex_cross(dag, b->s, t, p);
    ex_scale3(dag, ex_literal(dag, tire->radius), p, p);
    ex_add3(dag, b->c, p, p);
    road_normal(dag, p[0], p[1], at.n, &at.height);
    g[0] = p[0], g[1] = p[1], g[2] = at.height;
    forwards(dag, b->s, at.n, at.x);
    ex_cross(dag, at.n, at.x, at.y);
    ex_cross(dag, b->s, at.x, d);
    Ex sine = ex_op(dag, OP_MIN, ex_dot(dag, b->s, at.n), ex_literal(dag, 1), 0);
    at.camber = ex_op(dag, OP_ASIN, ex_op(dag, OP_MAX, sine, ex_literal(dag, -1), 0), 0, 0);
    Ex cosine = ex_op(dag, OP_MAX, ex_neg(dag, ex_dot(dag, d, at.n)), ex_literal(dag, least_cosine), 0);
    Ex share = ex_div(dag, ex_literal(dag, 1), cosine);
    ex_sub3(dag, b->c, g, t);
    at.radius = ex_mul(dag, ex_dot(dag, t, at.n), share);
    at.deflection = ex_sub(dag, ex_literal(dag, tire->radius), at.radius);
    ex_scale3(dag, at.radius, d, at.arm);
    ex_scale3(dag, ex_dot(dag, b->omega, b->s), b->s, t);
    ex_sub3(dag, b->omega, t, t);
    ex_cross(dag, t, at.arm, rolling);
    ex_add3(dag, b->v, rolling, at.v);
    at.rate = ex_neg(dag, ex_mul(dag, ex_dot(dag, at.v, at.n), share));
    Ex elastic = ex_mul(dag, ex_literal(dag, tire->stiffness), positive_part(dag, at.deflection));
    if (tire->bottom_stiffness > 0) {
        Ex beyond = positive_part(dag, ex_sub(dag, at.deflection, ex_literal(dag, tire->bottom)));
        elastic = ex_add(dag, elastic, ex_mul(dag, ex_literal(dag, tire->bottom_stiffness), beyond));
    }
    at.fade = smooth_step(dag, ex_div(dag, at.deflection, member_number(b, "fade", &b->first->fade)));
    Ex viscous = ex_mul(dag, ex_mul(dag, ex_literal(dag, tire->damping), at.fade), at.rate);
    /* without contact the deflection is negative and the damping has faded to 0, so limiting at 0 suffices */
    Ex free = ex_add(dag, elastic, viscous), per = ex_literal(dag, 1 / tire->stiffness);
    at.load = positive_part(dag, free);
    at.press = ex_op(dag, OP_POSITIVE, at.deflection, ex_mul(dag, per, free), at.deflection);
    return at;
}

static void relaxation(const Build *b, const Contact *at, Ex length[2])
{
    Dag *dag = b->dag;
    length[0] = length[1] = 0;
    if (b->tire->type == TIRE_PAC2002)
        pac2002_relaxation(dag, b->tire, at->load, ex_mul(dag, b->mirror, at->camber), length);
    for (int i = 0; i < 2; ++i)
        if (b->tire->relaxation[i] > 0)
            length[i] = ex_literal(dag, b->tire->relaxation[i]);
}

static Ex rolling_radius(const Build *b, const Contact *at)
{
    return b->tire->type == TIRE_PAC2002 ? pac2002_radius(b->dag, b->tire, at->deflection)
                                         : tmeasy_radius(b->dag, b->tire, at->radius);
}

static void build_contact(Build *b)
{
    const double tau = 0.01, slide = 0.3; /* TIRES.md section 4: tau, s, and kappa_0 */
    Dag *dag = b->dag;
    Block *block = &b->class->contact;
    const Contact at = contact_with_road(b);
    Ex P[3], length[2];
    ex_add3(dag, b->c, at.arm, P);
    Ex friction = ex_op(dag, OP_FRICTION, P[0], P[1], 0);
    block_check(block, friction, false, 0, GIC_ERROR_ROAD);
    Ex vx = ex_dot(dag, at.x, at.v), vy = ex_dot(dag, at.y, at.v), radius = rolling_radius(b, &at);
    Ex sliding = ex_sub(dag, vx, ex_mul(dag, b->spin, radius)), speed = absolute(dag, vx);
    Ex low = smooth_step(dag, ex_mul(dag, ex_literal(dag, 1 / b->tire->low_speed), speed));
    low = ex_sub(dag, ex_literal(dag, 1), low);
    Ex loss = ex_mul(dag, ex_literal(dag, 1 / slide), low), lead = ex_mul(dag, ex_literal(dag, tau), low);
    relaxation(b, &at, length);
    Ex decay_x = ex_add(dag, speed, ex_mul(dag, loss, absolute(dag, sliding)));
    Ex decay_y = ex_add(dag, speed, ex_mul(dag, loss, absolute(dag, vy)));
    Ex rate_x = ex_add(dag, ex_mul(dag, at.fade, sliding), ex_mul(dag, decay_x, b->slip_x));
    Ex rate_y = ex_sub(dag, ex_mul(dag, at.fade, vy), ex_mul(dag, decay_y, b->slip_y));
    rate_x = ex_neg(dag, ex_div(dag, rate_x, length[0]));
    rate_y = ex_div(dag, rate_y, length[1]);
    block_store(block, rate_x, element_at(ARRAY_rate, FAST_SLIP_X));
    block_store(block, rate_y, element_at(ARRAY_rate, FAST_SLIP_Y));
    block_store(block, at.load, element_at(ARRAY_contact, CONTACT_LOAD));
    block_store(block, ex_add(dag, b->slip_x, ex_mul(dag, lead, rate_x)), element_at(ARRAY_contact, CONTACT_KAPPA));
    block_store(block, ex_add(dag, b->slip_y, ex_mul(dag, lead, rate_y)), element_at(ARRAY_contact, CONTACT_TANGENT));
    block_store(block, at.camber, element_at(ARRAY_contact, CONTACT_CAMBER));
    block_store(block, friction, element_at(ARRAY_contact, CONTACT_FRICTION));
    block_store(block, vx, element_at(ARRAY_contact, CONTACT_SPEED));
    block_store(block, at.deflection, element_at(ARRAY_contact, CONTACT_DEFLECTION));
    block_store(block, at.radius, element_at(ARRAY_contact, CONTACT_RADIUS));
    store3(block, at.x, ARRAY_contact, CONTACT_X);
    store3(block, at.y, ARRAY_contact, CONTACT_Y);
    store3(block, at.n, ARRAY_contact, CONTACT_N);
    store3(block, at.arm, ARRAY_contact, CONTACT_ARM);
    block_store(block, at.load, element_at(ARRAY_grip, GRIP_LOAD));
    block_store(block, at.deflection, element_at(ARRAY_grip, GRIP_DEFLECTION));
    block_store(block, at.rate, element_at(ARRAY_grip, GRIP_DEFLECTION_RATE));
    block_store(block, at.height, element_at(ARRAY_grip, GRIP_HEIGHT));
    block_store(block, at.press, element_at(ARRAY_grip, GRIP_PRESS));
    store3(block, P, ARRAY_grip, GRIP_POINT);
    block_store(block, vx, element_at(ARRAY_grip, GRIP_SPEED_X));
    block_store(block, vy, element_at(ARRAY_grip, GRIP_SPEED_Y));
    block_store(block, radius, element_at(ARRAY_grip, GRIP_RADIUS));
}

/* ---- forces of the tire -------------------------------------------------------------------------------------------
 */

/* Read contact[], which the contact block stores; sample values are those of a rolling wheel. */
static void read_contact(const Build *b, Ex contact[CONTACT_NUMBERS])
{
    const double sunk = 0.01, speed = 10;
    double sample[CONTACT_NUMBERS] = {[CONTACT_LOAD] = b->tire->stiffness * sunk,
                                      [CONTACT_FRICTION] = 1,
                                      [CONTACT_SPEED] = speed,
                                      [CONTACT_DEFLECTION] = sunk,
                                      [CONTACT_RADIUS] = b->tire->radius - sunk,
                                      [CONTACT_X] = 1,
                                      [CONTACT_Y + 1] = 1,
                                      [CONTACT_N + 2] = 1,
                                      [CONTACT_ARM + 2] = sunk - b->tire->radius};
    read_array(b->dag, ARRAY_contact, 0, CONTACT_NUMBERS, sample, contact);
}

static void build_tire(Build *b)
{
    Dag *dag = b->dag;
    Ex contact[CONTACT_NUMBERS], force[TIRE_FORCES];
    read_contact(b, contact);
    const Rolling rolling = {.load = contact[CONTACT_LOAD],
                             .kappa = contact[CONTACT_KAPPA],
                             .tangent = ex_mul(dag, b->mirror, contact[CONTACT_TANGENT]),
                             .camber = ex_mul(dag, b->mirror, contact[CONTACT_CAMBER]),
                             .friction = contact[CONTACT_FRICTION],
                             .speed = contact[CONTACT_SPEED],
                             .spin = b->spin,
                             .deflection = contact[CONTACT_DEFLECTION],
                             .radius = contact[CONTACT_RADIUS]};
    (b->tire->type == TIRE_PAC2002 ? pac2002_forces : tmeasy_forces)(dag, b->tire, &rolling, force);
    force[TIRE_FY] = ex_mul(dag, b->mirror, force[TIRE_FY]);
    force[TIRE_MX] = ex_mul(dag, b->mirror, force[TIRE_MX]);
    force[TIRE_MZ] = ex_mul(dag, b->mirror, force[TIRE_MZ]);
    for (int i = 0; i < TIRE_FORCES; ++i)
        block_store(&b->class->tire, force[i], element_at(ARRAY_force, i));
}

/* ---- balance of the wheel ------------------------------------------------------------------------------------------
 */

/* Torque of the brake, up to `most`; its rate is stored. */
static Ex brake_torque(const Build *b, Ex most, Ex relative)
{
    const double tau = 0.01, grips = 0.7, give = 100; /* s; zeta from which it begins to slip; largest windups per
                                                       * second */
    Dag *dag = b->dag;
    Ex one = ex_literal(dag, 1), windup = member_number(b, "windup", &b->first->windup);
    Ex share = ex_div(dag, relative, ex_mul(dag, ex_literal(dag, give), windup));
    Ex speed = ex_div(dag, relative, ex_sqrt(dag, ex_add(dag, one, ex_mul(dag, share, share))));
    speed = ex_div(dag, speed, windup);
    Ex slip = ex_sub(dag, absolute(dag, b->windup), ex_literal(dag, grips));
    slip = smooth_step(dag, ex_mul(dag, ex_literal(dag, 1 / (1 - grips)), slip));
    slip = ex_op(dag, OP_POSITIVE, ex_mul(dag, b->windup, relative), slip, 0);
    Ex rate = ex_sub(dag, speed, ex_mul(dag, ex_mul(dag, slip, b->windup), absolute(dag, speed)));
    block_store(&b->class->balance, rate, element_at(ARRAY_rate, FAST_BRAKE));
    Ex part = ex_add(dag, b->windup, ex_mul(dag, ex_literal(dag, tau), rate));
    part = ex_op(dag, OP_MIN, ex_op(dag, OP_MAX, part, ex_literal(dag, -1), 0), one, 0);
    return ex_mul(dag, positive_part(dag, most), part);
}

static void build_balance(Build *b)
{
    Dag *dag = b->dag;
    Block *block = &b->class->balance;
    Ex contact[CONTACT_NUMBERS], tire[TIRE_FORCES], torque[2], F[3], M[3], t[3];
    read_contact(b, contact);
    read_array(dag, ARRAY_force, 0, TIRE_FORCES, (const double[TIRE_FORCES]){0}, tire);
    read_array(dag, ARRAY_torque, 0, 2, (const double[2]){0}, torque);
    const Ex along[3] = {tire[TIRE_FX], tire[TIRE_FY], contact[CONTACT_LOAD]};
    const Ex about[3] = {tire[TIRE_MX], tire[TIRE_MY], tire[TIRE_MZ]};
    ex_apply_transposed(dag, contact + CONTACT_X, along, F); /* its rows are the axes of the contact */
    ex_apply_transposed(dag, contact + CONTACT_X, about, M);
    ex_cross(dag, contact + CONTACT_ARM, F, t);
    ex_add3(dag, M, t, M);
    Ex inertia = member_number(b, "spin_inertia", &b->first->spin_inertia), onto = ex_dot(dag, b->s, M);
    Ex relative = ex_sub(dag, b->spin, ex_dot(dag, b->s, b->omega));
    Ex drive = b->first->drive ? torque[0] : 0, brake = b->first->brake ? brake_torque(b, torque[1], relative) : 0;
    Ex turning = ex_sub(dag, ex_add(dag, onto, drive), brake);
    block_store(block, ex_div(dag, turning, inertia), element_at(ARRAY_rate, FAST_SPIN));
    /* on the carrier: the moment not about the axis, the brake torque, and the gyroscopic moment */
    ex_scale3(dag, ex_sub(dag, brake, onto), b->s, t);
    ex_add3(dag, M, t, M);
    ex_cross(dag, b->omega, b->s, t);
    ex_scale3(dag, ex_mul(dag, inertia, b->spin), t, t);
    ex_sub3(dag, M, t, M);
    store3(block, F, ARRAY_grip, GRIP_FORCE);
    store3(block, M, ARRAY_grip, GRIP_TORQUE);
    block_store(block, drive, element_at(ARRAY_grip, GRIP_DRIVE));
    block_store(block, brake, element_at(ARRAY_grip, GRIP_BRAKE));
    block_store(block, ex_mul(dag, turning, b->spin), element_at(ARRAY_grip, GRIP_POWER));
    for (int i = 0; i < TIRE_FORCES; ++i)
        block_store(block, tire[i], element_at(ARRAY_grip, GRIP_TIRE + i));
    block_store(block, contact[CONTACT_KAPPA], element_at(ARRAY_grip, GRIP_KAPPA));
    block_store(block, contact[CONTACT_TANGENT], element_at(ARRAY_grip, GRIP_TANGENT));
    block_store(block, contact[CONTACT_CAMBER], element_at(ARRAY_grip, GRIP_CAMBER));
}

/* ---- classes -------------------------------------------------------------------------------------------------------
 */

static bool are_alike(const Wheel *a, const Wheel *b)
{
    return a->tire == b->tire && !a->drive == !b->drive && !a->brake == !b->brake;
}

static void class_build(Pool *pool, const Model *model, WheelClass *class)
{
    const double speed = 10; /* m/s, at the samples */
    const Wheel *first = &model->wheel[class->member[0]];
    const Tire *tire = &model->tire[first->tire];
    Build b = {.model = model, .dag = dag_new(pool, class->members, class->members), .class = class, .first = first};
    double side[class->members];
    for (int i = 0; i < class->members; ++i)
        side[i] = model->wheel[class->member[i]].mirrored ? -1 : 1;
    b.tire = tire;
    b.mirror = ex_constant(b.dag, side);
    ex_describe(b.dag, b.mirror, "%s.mirrored: -1, else 1", first->name);
    class->name = first->name;
    class->contact.dag = class->tire.dag = class->balance.dag = b.dag;
    read_array(b.dag, ARRAY_link, LINK_C, 3, (const double[3]){0, 0, tire->radius}, b.c);
    read_array(b.dag, ARRAY_link, LINK_V, 3, (const double[3]){speed, 0, 0}, b.v);
    read_array(b.dag, ARRAY_link, LINK_S, 3, (const double[3]){0, 1, 0}, b.s);
    read_array(b.dag, ARRAY_link, LINK_OMEGA, 3, (const double[3]){0, 0, 0}, b.omega);
    read_array(b.dag, ARRAY_fast, FAST_SPIN, 1, (const double[1]){speed / tire->radius}, &b.spin);
    read_array(b.dag, ARRAY_fast, FAST_SLIP_X, 1, (const double[1]){0}, &b.slip_x);
    read_array(b.dag, ARRAY_fast, FAST_SLIP_Y, 1, (const double[1]){0}, &b.slip_y);
    read_array(b.dag, ARRAY_fast, FAST_BRAKE, 1, (const double[1]){0}, &b.windup);
    build_contact(&b);
    build_tire(&b);
    build_balance(&b);
}

static void classes_find(Pool *pool, const Model *model, Wheels *wheels)
{
    for (int i = 0; i < model->wheels; ++i) {
        if (model->wheel[i].tire < 0)
            continue;
        int c = 0;
        while (c < wheels->classes && !are_alike(&model->wheel[wheels->class[c].member[0]], &model->wheel[i]))
            ++c;
        if (c == wheels->classes)
            *POOL_PUSH(pool, wheels->class, wheels->classes) = (WheelClass){.members = 0};
        WheelClass *class = &wheels->class[c];
        *POOL_PUSH(pool, class->member, class->members) = i;
    }
    for (int c = 0; c < wheels->classes; ++c)
        class_build(pool, model, &wheels->class[c]);
}

/* ---- what moves wheels, and turns them */

/* Add a number to link[]; returns it as formulas read it. */
static Ex link_number(Linking *l, Ex value)
{
    const int place = l->wheels->links++;
    block_store(&l->wheels->link, value, element_at(ARRAY_link, place));
    return ex_input(l->formulas->dag, element_at(ARRAY_link, place), NULL);
}

/* A fast state as formulas at fast steps read it. */
static Ex fast_state(const Linking *l, int index)
{
    return ex_input(l->formulas->dag, element_at(ARRAY_fast, index), NULL);
}

/* Add a component of an output, one that follows from motion alone (read/signals.c). */
static void link_signal(Linking *l, int index)
{
    const Signal *signal = &l->whole->model->signal[index];
    const bool spin = signal->output.type == OUTPUT_TIRE;
    l->linked[index] = spin ? fast_state(l, l->whole->model->wheel[signal->output.index].fast + FAST_SPIN)
                            : link_number(l, whole_signal(l->whole, index));
}

/* Add what a formula reads to link[]: free coordinates and signals. */
static void link_names(Linking *l, const Law *law)
{
    if (!law)
        return;
    if (law->op == LAW_SIGNAL) {
        const Law *const named = l->whole->model->signal[law->index].law;
        if (named)
            link_names(l, named);
        else if (!l->linked[law->index])
            link_signal(l, law->index);
    }
    if ((law->op == LAW_VALUE || law->op == LAW_RATE) && !l->whole->model->coordinate[law->index].driven) {
        bool rate = law->op == LAW_RATE;
        bool *there = &l->there[rate][law->index];
        if (!*there)
            (rate ? l->formulas->xd : l->formulas->x)[law->index] =
                link_number(l, (rate ? l->whole->xd : l->whole->x)[law->index]);
        *there = true;
    }
    for (int i = 0; i < 3; ++i)
        link_names(l, law->arg[i]);
}

Ex fast_law(Linking *l, const Law *law, const Ex *local)
{
    link_names(l, law);
    return whole_law(l->formulas, law, local);
}

/* Of a wheel on a post its place and velocity count from the post, which is the road to it. */
static void link_wheel(Whole *whole, Block *block, const Wheel *wheel, int offset)
{
    Dag *dag = whole->dag;
    const Motion *motion = &whole->motion[wheel->body];
    Ex axis[3], turn[3], out[3];
    Vector center = whole_point(whole, wheel->body, wheel->center);
    whole_position(whole, &center, out);
    out[2] = ex_sub(dag, out[2], whole_post(whole, wheel, 0));
    store3(block, out, ARRAY_link, offset + LINK_C);
    whole_velocity(whole, &center, out);
    out[2] = ex_sub(dag, out[2], whole_post(whole, wheel, 1));
    store3(block, out, ARRAY_link, offset + LINK_V);
    for (int i = 0; i < 3; ++i)
        axis[i] = whole_number(whole, &wheel->axis[i]);
    ex_apply(dag, motion->A, axis, turn);
    ex_apply(dag, whole->R, turn, out);
    store3(block, out, ARRAY_link, offset + LINK_S);
    ex_add3(dag, whole->turn, motion->omega, turn);
    ex_apply(dag, whole->R, turn, out);
    store3(block, out, ARRAY_link, offset + LINK_OMEGA);
}

static void formula_torques(Linking *l, const Wheel *wheel, int place)
{
    Dag *dag = l->formulas->dag;
    const Ex spin = ex_input(dag, element_at(ARRAY_fast, wheel->fast + FAST_SPIN), NULL);
    const Law *const law[2] = {wheel->drive, wheel->brake};
    for (int i = 0; i < 2; ++i) {
        block_store(&l->wheels->torque, law[i] ? fast_law(l, law[i], &spin) : 0, element_at(ARRAY_torque, place + i));
    }
}

const Wheels *wheels_formulate(Pool *pool, const Plan *plan)
{
    const Model *model = plan->model;
    const size_t coordinates = (size_t)model->coordinates + 1;
    Wheels *wheels = pool_alloc(pool, sizeof *wheels);
    Linking l = {.whole = whole_new(pool, plan),
                 .formulas = whole_new(pool, plan),
                 .wheels = wheels,
                 .there = {pool_alloc(pool, coordinates * sizeof(bool)), pool_alloc(pool, coordinates * sizeof(bool))},
                 .linked = pool_alloc(pool, ((size_t)model->signals + 1) * sizeof(Ex))};
    l.formulas->linked = l.linked;
    for (int i = 0; i < model->states; ++i)
        l.formulas->z[i] = fast_state(&l, model->state[i].fast);
    wheels->link.dag = l.whole->dag;
    wheels->torque.dag = l.formulas->dag;
    classes_find(pool, model, wheels);
    for (int w = 0; w < model->coordinates; ++w)
        if (model->coordinate[w].driven) { /* a driven coordinate: from the inputs at that time */
            int input = model->coordinate[w].input;
            l.formulas->x[w] = ex_input(l.formulas->dag, element_at(ARRAY_u, input), NULL);
            l.formulas->xd[w] = ex_input(l.formulas->dag, element_at(ARRAY_u, input + 1), NULL);
        }
    for (int i = 0; i < model->wheels; ++i)
        if (model->wheel[i].tire >= 0)
            link_wheel(l.whole, &wheels->link, &model->wheel[i], LINK_NUMBERS * wheels->count++);
    wheels->links = LINK_NUMBERS * wheels->count;
    for (int i = 0; i < model->wheels; ++i)
        if (model->wheel[i].tire >= 0)
            formula_torques(&l, &model->wheel[i], 2 * wheel_rolling(model, i));
    for (int i = 0; i < model->states; ++i)
        block_store(&wheels->torque, model->state[i].rate ? fast_law(&l, model->state[i].rate, NULL) : 0,
                    element_at(ARRAY_rate, model->state[i].fast));
    if (model->powertrain)
        powertrain_formulate(pool, &l);
    if (wheels->links == 0)
        link_number(&l, 0); /* arrays have at least one number */
    return wheels;
}
