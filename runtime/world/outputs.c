/* SPDX-License-Identifier: MIT
 * Outputs by name (FORMAT.md section 9), poses and self-test of a World. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/wheel.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* Motion of a point of a body, or of ground. */
typedef struct Track {
    double r[3], v[3], a[3];
} Track;

static Track track(const World *world, int body, const double s[3])
{
    Track t = {{0}, {0}, {0}};
    if (body == BODY_GROUND) {
        copy3(s, t.r);
        return t;
    }
    double local[3], arm[3], rate[3], turn[3], swing[3];
    sub3(s, world->model->body[body].com, local);
    apply3(world->A[body], local, arm);
    cross3(world->omega[body], arm, rate);
    cross3(world->alpha[body], arm, turn);
    cross3(world->omega[body], rate, swing);
    add3(world->q[body], arm, t.r);
    add3(world->qd[body], rate, t.v);
    add3(world->qdd[body], turn, t.a);
    add3(t.a, swing, t.a);
    return t;
}

/* Components of a world vector in the frame that an output asks for. */
static void express(const World *world, int in, const double vector[3], double *out)
{
    if (in == BODY_GROUND)
        copy3(vector, out);
    else
        apply3_transposed(world->A[in], vector, out);
}

/* Euler parameters of a body, with e0 >= 0 for all but the base. */
static void orientation(const World *world, int body, double *out)
{
    static const double level[4] = {1, 0, 0, 0};
    const double *p = body == BODY_GROUND ? level : world->q[body] + 3;
    const double sign = body > BODY_BASE && p[0] < 0 ? -1 : 1;
    for (int i = 0; i < 4; ++i)
        out[i] = sign * p[i];
}

static void attitude(const World *world, int body, double *out)
{
    static const double level[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double *A = body == BODY_GROUND ? level : world->A[body];
    out[0] = atan2(A[7], A[8]);
    out[1] = asin(fmin(fmax(-A[6], -1), 1));
    out[2] = atan2(A[3], A[0]);
}

static void angular_momentum(const World *world, int body, const double rate[3], double out[3])
{
    const double *J = world->model->body[body].inertia;
    double local[3];
    apply3_transposed(world->A[body], rate, local);
    apply3(world->A[body],
           (const double[3]){J[0] * local[0] + J[3] * local[1] + J[4] * local[2],
                             J[3] * local[0] + J[1] * local[1] + J[5] * local[2],
                             J[4] * local[0] + J[5] * local[1] + J[2] * local[2]},
           out);
}

/* Multiplier of a driven coordinate's row as the force along the coordinate. */
static double drive_force(const World *world, int coordinate)
{
    return world->multiplier[world->tie[world->coordinate_tie[coordinate]].first] * world->dual[coordinate];
}

/* Power of the drives of coordinates. */
static double drive_power(const World *world)
{
    double power = 0;
    for (int c = 0; c < world->model->coordinates; ++c)
        if (world->model->coordinate[c].driven)
            power += drive_force(world, c) * world->xd[c];
    return power;
}

/* Kinetic, potential, and the power of all that is in neither. */
static void energy(const World *world, double out[3])
{
    out[0] = 0;
    out[1] = world->potential;
    out[2] = world->power + drive_power(world);
    for (int b = world->first; b < world->bodies; ++b) {
        const double mass = world->model->body[b].mass, *v = world->qd[b];
        double momentum[3];
        angular_momentum(world, b, world->omega[b], momentum);
        out[0] += 0.5 * (mass * dot3(v, v) + dot3(world->omega[b], momentum));
        out[1] -= mass * dot3(world->model->gravity, world->q[b]);
    }
    for (int i = 0; i < world->model->wheels; ++i) {
        const Wheel *wheel = &world->model->wheel[i];
        if (wheel->tire >= 0) {
            const double spin = world->fast[wheel->fast + FAST_SPIN];
            out[0] += 0.5 * wheel->spin_inertia * spin * spin;
        }
    }
}

static void tire(const World *world, int index, double *out)
{
    const int at = world->model->wheel[index].fast + FAST_SPIN;
    const Rolling *wheel = &world->rolling[index];
    const double value[] = {wheel->tire.fx,  wheel->tire.fy,       wheel->tire.mx, wheel->tire.my,
                            wheel->tire.mz,  wheel->kappa,         wheel->alpha,   wheel->camber,
                            world->fast[at], world->fast_rate[at], wheel->drive,   wheel->brake};
    memcpy(out, value, sizeof value);
}

static void powertrain(const World *world, double *out)
{
    const Driveline *d = &world->driveline;
    const double value[] = {world->fast[world->model->powertrain->fast + POWERTRAIN_SPEED],
                            d->engine_torque,
                            d->throttle,
                            world->gear[POWERTRAIN_GEAR],
                            d->ratio,
                            d->turbine_speed,
                            d->turbine_torque,
                            d->pump_torque};
    memcpy(out, value, sizeof value);
}

/* Of a row, what its multiplier puts on the body at one end as force and torque about the centre of mass: -J^T
 * multiplier. */
static void add_row_force(const World *world, const Tie *tie, int row, int end, double out[6])
{
    const int body = tie->body[end];
    const double *J = world->J + ROW_J * tie->first + BODY_Q * (tie->rows * end + row);
    const double multiplier = world->multiplier[tie->first + row];
    double torque[3];
    euler_turn(world->q[body] + 3, J + 3, torque); /* the p part is 2 E^T torque */
    add_scaled3(-multiplier, J, out);
    add_scaled3(-0.5 * multiplier, torque, out + 3);
}

/* Force and torque of a joint on its second body, at its point of that. */
static void reaction(const World *world, const Output *output, double *out)
{
    const Tie *tie = &world->tie[output->index]; /* joints come first */
    const Joint *joint = &world->model->joint[output->index];
    const int body = tie->body[1];
    double wrench[6] = {0}, local[3], arm[3], moment[3];
    for (int r = 0; r < tie->rows; ++r)
        add_row_force(world, tie, r, 1, wrench);
    sub3(joint->point[1], world->model->body[body].com, local);
    apply3(world->A[body], local, arm);
    cross3(arm, wrench, moment);
    sub3(wrench + 3, moment, wrench + 3);
    express(world, output->in, wrench, out);
    express(world, output->in, wrench + 3, out + 3);
}

void world_output(const World *world, const Output *output, double *out)
{
    const int body = output->body, i = output->index;
    const Track point = track(world, body, output->point);
    switch (output->type) {
    case OUTPUT_POSITION: copy3(point.r, out); break;
    case OUTPUT_VELOCITY: express(world, output->in, point.v, out); break;
    case OUTPUT_ACCELERATION: express(world, output->in, point.a, out); break;
    case OUTPUT_ORIENTATION: orientation(world, body, out); break;
    case OUTPUT_ROLL_PITCH_YAW: attitude(world, body, out); break;
    case OUTPUT_ANGULAR_VELOCITY:
        express(world, output->in, body == BODY_GROUND ? (const double[3]){0, 0, 0} : world->omega[body], out);
        break;
    case OUTPUT_COORDINATE:
        out[0] = world->x[i];
        out[1] = world->xd[i];
        out[2] = world->xdd[i];
        break;
    case OUTPUT_FORCE: out[0] = world->element[i]; break;
    case OUTPUT_DRIVE_FORCE: out[0] = drive_force(world, i); break;
    case OUTPUT_REACTION: reaction(world, output, out); break;
    case OUTPUT_WHEEL: memcpy(out, world->wheel[i], sizeof world->wheel[i]); break;
    case OUTPUT_TIRE: tire(world, i, out); break;
    case OUTPUT_CONTACT:
        copy3(world->rolling[i].point, out);
        out[2] += world_post(world, &world->model->wheel[i], 0);
        break;
    case OUTPUT_POWERTRAIN: powertrain(world, out); break;
    case OUTPUT_ENERGY: {
        double all[3];
        energy(world, all);
        memcpy(out, all, sizeof *out * (size_t)output->count);
        break;
    }
    case OUTPUT_SIGNAL: out[0] = world_signal(world, i); break;
    default: break;
    }
}

void world_outputs(const World *world, double *out)
{
    for (int i = 0; i < world->model->outputs; ++i) {
        world_output(world, &world->model->output[i], out);
        out += world->model->output[i].count;
    }
}

void world_poses(const World *world, double *pose)
{
    static const double origin[3] = {0, 0, 0};
    for (int b = 0; b < world->bodies; ++b, pose += BODY_Q) {
        const Track t = track(world, b, origin);
        copy3(t.r, pose);
        orientation(world, b, pose + 3);
    }
}

/* Largest force and largest torque of a body. Where all of one kind cancel to rounding, the other says of what; where
 * nothing acts at all, 1e-6 m/s^2 does. */
static void compare_sizes(const Body *body, double most[2])
{
    const double least = 1e-6;
    const double radius = sqrt((body->inertia[0] + body->inertia[1] + body->inertia[2]) / (2 * body->mass));
    const double force = fmax(most[0], least * body->mass), torque = most[1];
    most[0] = force;
    if (radius > 0 && isfinite(radius)) {
        most[0] = fmax(force, torque / radius);
        most[1] = fmax(torque, force * radius);
    }
}

/* Newton's and Euler's equations with the constraints' forces, and the power of all that is neither gravity nor spring
 * against the growth of kinetic and potential energy: what remains relative to the sum of magnitudes. */
static void balance(const World *world, gic_self_test *result)
{
    double growth = world->stored, scale = fabs(world->stored), worst = 0;
    for (int b = world->first; b < world->bodies; ++b) {
        const double mass = world->model->body[b].mass, *omega = world->omega[b];
        double momentum[3], gyro[3], inertial[6], rest[6], size[6];
        angular_momentum(world, b, omega, momentum);
        cross3(omega, momentum, gyro);
        angular_momentum(world, b, world->alpha[b], inertial + 3);
        add3(inertial + 3, gyro, inertial + 3);
        for (int i = 0; i < 3; ++i)
            inertial[i] = mass * world->qdd[b][i];
        for (int i = 0; i < 6; ++i) {
            rest[i] = inertial[i] - world->wrench[b][i];
            size[i] = fabs(inertial[i]) + fabs(world->wrench[b][i]);
        }
        for (int t = 0; t < world->constraints; ++t) {
            const Tie *tie = &world->tie[t];
            for (int end = 0; end < 2; ++end)
                for (int r = 0; tie->body[end] == b && r < tie->rows; ++r) {
                    double force[6] = {0};
                    add_row_force(world, tie, r, end, force);
                    for (int i = 0; i < 6; ++i) {
                        rest[i] -= force[i];
                        size[i] += fabs(force[i]);
                    }
                }
        }
        /* of a body that turns fast in place, what its rotation makes of arms cancels, and its rounding remains */
        const double central = mass * dot3(omega, omega) * world->size, turning = norm3(omega) * norm3(momentum);
        double most[2] = {fmax(central, fmax(size[0], fmax(size[1], size[2]))),
                          fmax(turning, fmax(size[3], fmax(size[4], size[5])))};
        compare_sizes(&world->model->body[b], most);
        for (int i = 0; i < 6; ++i) {
            const double rate = i < 3 ? world->qd[b][i] : omega[i - 3];
            worst = fmax(worst, rest[i] == 0 ? 0 : fabs(rest[i]) / most[i / 3]);
            growth += inertial[i] * rate;
            scale += size[i] * fabs(rate);
        }
        growth -= mass * dot3(world->model->gravity, world->qd[b]);
    }
    for (int i = 0; i < world->model->wheels; ++i)
        if (world->model->wheel[i].tire >= 0) {
            const int at = world->model->wheel[i].fast + FAST_SPIN;
            const double part = world->model->wheel[i].spin_inertia * world->fast[at] * world->fast_rate[at];
            growth += part;
            scale += fabs(part) + fabs(world->rolling[i].power);
        }
    result->balance = worst;
    result->energy = fabs(growth - world->power - drive_power(world)) / (scale > 0 ? scale : 1);
}

void world_self_test(World *world, gic_self_test *result)
{
    *result = (gic_self_test){.smallest_pivot = 1};
    balance(world, result);
    result->constraint = world_residual(world);
}
