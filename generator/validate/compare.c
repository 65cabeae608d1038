/* SPDX-License-Identifier: MIT
 * The results of blocks at one state, compared with the definitions of joints, forces and outputs in world
 * coordinates. */
#include "base/vec3.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "validate/compare.h"
#include "validate/play.h"
#include "validate/run.h"
#include "vehicle/vehicle.h"
#include "world/wheel.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* ---- equations --------------------------------------------------------------------------------------------------- */

static const char *tie_name(const Comparison *c, int index)
{
    const Tie *tie = &c->world->tie[index];
    return tie->joint >= 0 ? c->v.model->joint[tie->joint].name : c->v.model->coordinate[tie->coordinate].name;
}

/* J x of a row, and the sum of the magnitudes of its terms. */
static double row_product(const Comparison *c, int index, int row, const double (*x)[BODY_Q], double *scale)
{
    const Tie *tie = &c->world->tie[index];
    const double *J = c->world->J + ROW_J * tie->first + BODY_Q * row;
    double sum = 0;
    for (int end = 0; end < 2; ++end, J += BODY_Q * tie->rows)
        for (int i = 0; i < BODY_Q; ++i) {
            const double term = J[i] * x[tie->body[end]][i];
            sum += term;
            *scale += fabs(term);
        }
    return sum;
}

/* Residuals of all constraints at rates or accelerations x and w. gamma: with the quadratic-velocity terms. */
static void compare_rows(Comparison *c, Kind which, const double (*x)[BODY_Q], const double *w, bool gamma,
                         double floor)
{
    World *world = c->world;
    for (int t = 0; t < world->ties; ++t) {
        const Tie *tie = &world->tie[t];
        for (int r = 0; r < tie->rows; ++r) {
            double scale = 0, rest = row_product(c, t, r, x, &scale);
            if (r == 0) {
                const double term = world_dual(world, t, w);
                rest += term;
                scale += fabs(term);
            }
            if (gamma) {
                rest -= world->gamma[tie->first + r];
                scale += fabs(world->gamma[tie->first + r]);
            }
            compare(c, which, tie_name(c, t), rest, scale + floor);
        }
    }
}

/* Twists of the centres of mass at unit rate of one coordinate, the base at rest. */
static void unit_rates(Comparison *c, int coordinate)
{
    World *world = c->world;
    const Plan *plan = c->v.run->plan;
    const double *B = world->A[BODY_BASE];
    double S[world->bodies][6], at[3], from[3], arm[3], t[3]; /* S: of reference points, base frame */
    memset(S, 0, sizeof S);
    for (int s = 0; s < plan->sequence->subsets; ++s)
        for (int i = 0; plan->sequence->subset[s].class >= 0 && i < plan->sequence->subset[s].bodies; ++i) {
            const Subset *subset = &plan->sequence->subset[s];
            const int b = subset->body[i];
            if (subset->carrier != BODY_BASE) { /* computed before */
                compare_motion3(c, b, MOTION_C, at);
                compare_motion3(c, subset->carrier, MOTION_C, from);
                sub3(at, from, arm);
                memcpy(S[b], S[subset->carrier], sizeof S[b]);
                cross3(S[b], arm, t);
                add3(S[b] + 3, t, S[b] + 3);
            }
            for (int j = 0; j < subset->deps; ++j)
                if (subset->dep[j] == coordinate)
                    compare_add_unit_motion(c, b, b, j, 1, S[b]);
        }
    for (int b = 0; b < world->bodies; ++b) {
        apply3(B, S[b], c->twist[b] + 3);
        apply3(B, S[b] + 3, c->twist[b]);
        sub3(c->v.model->body[b].com, plan->origin[b], at);
        apply3(world->A[b], at, arm);
        cross3(c->twist[b] + 3, arm, t);
        add3(c->twist[b], t, c->twist[b]);
    }
}

/* Twists of the bodies at unit rate of the base: about (0 to 2) or along (3 to 5) an axis of its frame. */
static void unit_rates_of_base(Comparison *c, int axis)
{
    World *world = c->world;
    double u[3], r[3], v[3], arm[3];
    compare_base_origin(c, r, v);
    for (int i = 0; i < 3; ++i)
        u[i] = world->A[BODY_BASE][3 * i + axis % 3];
    for (int b = 0; b < world->bodies; ++b) {
        double *twist = c->twist[b];
        memset(twist, 0, sizeof *c->twist);
        if (axis >= 3) {
            copy3(u, twist);
            continue;
        }
        sub3(world->q[b], r, arm);
        cross3(u, arm, twist);
        copy3(u, twist + 3);
    }
}

/* What a row may be off by where all its terms vanish. motion: the largest speed or acceleration of a point, m/s or
 * m/s^2. Poses are right to their rounding only, and a row that compares angles multiplies what they are off by with
 * angular velocities, which are at most motion / size. */
static double row_floor(const Comparison *c, double motion)
{
    return 1e-3 * motion / fmin(c->world->size, 1);
}

static void compare_partials(Comparison *c)
{
    World *world = c->world;
    double(*x)[BODY_Q] = pool_alloc(c->v.pool, sizeof *x * (size_t)world->bodies);
    double *w = pool_alloc(c->v.pool, sizeof *w * ((size_t)c->v.model->coordinates + 1));
    for (int j = 0; j < c->v.model->coordinates; ++j) {
        unit_rates(c, j);
        for (int b = 0; b < world->bodies; ++b)
            compare_set_rate(world, b, c->twist[b], c->twist[b] + 3, x);
        memset(w, 0, sizeof *w * ((size_t)c->v.model->coordinates + 1));
        w[j] = 1;
        compare_rows(c, KIND_PARTIAL, (const double(*)[BODY_Q])x, w, false, 1e-3 * fmin(world->size, 1));
    }
}

/* Virtual power of inertia less applied forces at the rates in `twist`. */
static double virtual_power(const Comparison *c, double *scale)
{
    const World *world = c->world;
    double sum = 0;
    for (int b = world->first; b < world->bodies; ++b) {
        const double *J = c->v.model->body[b].inertia, *A = world->A[b], *omega = world->omega[b], *t = c->twist[b];
        const double matrix[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]};
        double local[3], momentum[3], gyro[3], turn[3], moved[3];
        apply3_transposed(A, omega, local);
        apply3(matrix, local, moved);
        apply3(A, moved, momentum);
        cross3(omega, momentum, gyro);
        apply3_transposed(A, world->alpha[b], local);
        apply3(matrix, local, moved);
        apply3(A, moved, turn);
        for (int i = 0; i < 3; ++i) {
            const double term[5] = {t[i] * c->v.model->body[b].mass * world->qdd[b][i], -t[i] * world->wrench[b][i],
                                    t[3 + i] * turn[i], t[3 + i] * gyro[i], -t[3 + i] * world->wrench[b][3 + i]};
            for (int j = 0; j < 5; ++j) {
                sum += term[j];
                *scale += fabs(term[j]);
            }
        }
    }
    return sum;
}

/* Residuals of the equations of motion of all unknowns, and the forces of drives. tau [unknowns] */
static void find_balance(Comparison *c, double *tau, double *scale, double *drive)
{
    const Plan *plan = c->v.run->plan;
    for (int i = 0; c->v.model->free_base && i < 6; ++i) {
        unit_rates_of_base(c, i);
        scale[i] = 0;
        tau[i] = virtual_power(c, &scale[i]);
    }
    for (int j = 0; j < c->v.model->coordinates; ++j) {
        const int unknown = plan->coordinate_unknown[j];
        double sum = 0;
        unit_rates(c, j);
        const double rest = virtual_power(c, &sum) - c->world->along[j];
        if (unknown >= 0) {
            tau[unknown] = rest;
            scale[unknown] = sum + fabs(c->world->along[j]);
        } else {
            drive[j] = rest;
        }
    }
}

const char *unknown_name(const Comparison *c, int unknown)
{
    static const char *const base[6] = {"moment about x", "moment about y", "moment about z",
                                        "force along x",  "force along y",  "force along z"};
    const Plan *plan = c->v.run->plan;
    if (c->v.model->free_base && unknown < 6)
        return base[unknown];
    int j = 0;
    while (plan->coordinate_unknown[j] != unknown)
        ++j;
    return c->v.model->coordinate[j].name;
}

/* ---- one state --------------------------------------------------------------------------------------------------- */

static void load(Comparison *c)
{
    const Run *run = c->v.run;
    const Model *model = c->v.model;
    World *world = c->world;
    for (int i = 0; i < model->inputs; ++i)
        c->input[i] = run->u[i][c->k];
    for (int i = 0; i < model->tunables; ++i)
        c->parameter[i] = run->p[i][c->k];
    for (int i = 0; i < 6 * model->ports; ++i)
        c->port[i] = run->port[i][c->k];
    for (int i = 0; i < model->fast_states; ++i)
        c->fast[i] = run->y[run->plan->states + i][c->k];
    for (int i = 0; i < POWERTRAIN_DISCRETE; ++i)
        c->gear[i] = (int32_t)run->gear[i][c->k];
    world->time = run->time[c->k];
    world->input = c->input;
    world->parameter = c->parameter;
    world->port = c->port;
    world->fast = c->fast;
    world->gear = c->gear;
    world->road = run->scenery.road;
    for (int i = 0; i < model->coordinates; ++i) {
        const int rate = run->plan->coordinate_rate[i];
        world->x[i] = run->x[i][c->k];
        world->xd[i] = run->xd[i][c->k];
        world->xdd[i] = rate >= 0 ? run->rate[rate][c->k] : c->input[model->coordinate[i].input + 2];
    }
    /* the rounding of a body's weight and of rates of 1 remains if all else is 0 */
    c->speed = 1e-6;
    c->swing = 1e-6 * (1 + norm3(model->gravity));
    for (int i = 0; i < model->coordinates; ++i) {
        const double size = model->coordinate[i].type == COORDINATE_ANGLE ? world->size : 1;
        c->speed = fmax(c->speed, size * fabs(world->xd[i]));
    }
}

/* Rates of coordinates and of the base's pose. */
static void compare_rates(Comparison *c)
{
    const Model *model = c->v.model;
    const Run *run = c->v.run;
    const Plan *plan = run->plan;
    const int twist = 7 + plan->free_coordinates;
    for (int i = 0; i < model->coordinates; ++i)
        if (plan->coordinate_state[i] >= 0)
            compare(c, KIND_RATE, model->coordinate[i].name,
                    run->rate[plan->coordinate_state[i]][c->k] - c->world->xd[i], 1 + fabs(c->world->xd[i]));
    for (int i = 0; model->free_base && i < 7; ++i) {
        const double right = i < 3 ? run->y[twist + i][c->k] : c->world->qd[BODY_BASE][i];
        compare(c, KIND_RATE, base_state_name[i], run->rate[i][c->k] - right, 1 + fabs(right));
    }
}

static void compare_fast(Comparison *c)
{
    const Model *model = c->v.model;
    const Run *run = c->v.run;
    for (int i = 0; i < model->fast_states; ++i) {
        const double right = c->world->fast_rate[i], given = run->rate[run->plan->states + i][c->k];
        compare(c, KIND_FAST, c->state_name[run->plan->states + i], given - right, fabs(right) + 1);
    }
}

/* Forces of the wheels with tires on their carriers, and the numbers that set-up uses. */
static void compare_grip(Comparison *c)
{
    const Model *model = c->v.model;
    for (int i = 0; i < model->wheels; ++i) {
        if (model->wheel[i].tire < 0)
            continue;
        const Rolling *r = &c->world->rolling[i];
        Values *grip = c->v.run->grip + GRIP_NUMBERS * wheel_rolling(model, i);
        const double force = 1 + norm3(r->force);
        const struct {
            int number;
            double right, scale;
        } part[] = {
            {GRIP_FORCE, r->force[0], force},
            {GRIP_FORCE + 1, r->force[1], force},
            {GRIP_FORCE + 2, r->force[2], force},
            {GRIP_DRIVE, r->drive, 1 + fabs(r->drive)},
            {GRIP_BRAKE, r->brake, 1 + fabs(r->brake)},
            {GRIP_LOAD, r->fz, force},
            {GRIP_DEFLECTION, r->deflection, 1},
            {GRIP_HEIGHT, r->height, 1},
            {GRIP_KAPPA, r->kappa, 1 + fabs(r->kappa)},
            {GRIP_CAMBER, r->camber, 1},
            {GRIP_SPEED_X, r->speed[0], 1 + fabs(r->speed[0])},
            {GRIP_SPEED_Y, r->speed[1], 1 + fabs(r->speed[1])},
            {GRIP_RADIUS, r->rolling_radius, 1},
        };
        for (size_t j = 0; j < sizeof part / sizeof *part; ++j)
            compare(c, KIND_WHEEL, model->wheel[i].name, grip[part[j].number][c->k] - part[j].right, part[j].scale);
    }
}

/* What a formula of a length or angle changes by over the size of the model, or over a radian, as it does here: it has
 * the rounding of what it reads. 0: it has no slope here. */
static double law_swing(const World *world, const Force *force, double extent, double size)
{
    const double little = 1e-6;
    const double way = world_law(world, force->law[0], (const double[FORCE_LOCALS]){extent + little * size}) -
                       world_law(world, force->law[0], (const double[FORCE_LOCALS]){extent});
    return isfinite(way) ? fabs(way) / little : 0;
}

static void find_push(Comparison *c)
{
    const World *world = c->world;
    c->push = c->watts = 0;
    for (int b = world->first; b < world->bodies; ++b) {
        const double *f = world->wrench[b];
        c->push = fmax(c->push, norm3(f) + norm3(f + 3) / world->size);
        c->push = fmax(c->push, c->v.model->body[b].mass * c->swing);
        for (int i = 0; i < 3; ++i)
            c->watts += fabs(f[i] * world->qd[b][i]) + fabs(f[3 + i] * world->omega[b][i]);
    }
    for (int i = 0; i < c->v.model->forces; ++i) {
        const Force *force = &c->v.model->force[i];
        c->push = fmax(c->push, fabs(world->element[i]));
        /* a spring at its free length has the rounding of that length */
        if (force_is_spring(force) && force->table < 0)
            c->push = fmax(c->push, fabs(world_law(world, force->stiffness, NULL)) * world->size);
        if (force->type == FORCE_POINTS_LAW || force->type == FORCE_AXIS_LAW)
            c->push =
                fmax(c->push, law_swing(world, force, world->extent[i], force_is_torque(force) ? 1 : world->size));
        /* nor do displacements and rotations vanish by more than their rounding */
        for (int k = 0; force->bushing && k < BUSHING_NUMBERS; ++k)
            if (force->bushing->stiffness[k])
                c->push =
                    fmax(c->push, fabs(world_law(world, force->bushing->stiffness[k], NULL)) * fmax(world->size, 1));
    }
    for (int i = 0; i < c->v.model->coordinates; ++i)
        c->watts += fabs(world->along[i] * world->xd[i]);
    for (int i = 0; i < c->v.model->wheels; ++i)
        if (c->v.model->wheel[i].tire >= 0)
            c->watts += fabs(world->rolling[i].power);
}

/* The unknowns as the self-test has them: acceleration of the base in its own frame, less gravity. */
static void compare_unknowns(Comparison *c)
{
    const Run *run = c->v.run;
    const Plan *plan = run->plan;
    const int twist = 7 + plan->free_coordinates;
    double own[3], world[3];
    for (int i = 0; c->v.model->free_base && i < 3; ++i)
        world[i] = run->rate[twist + i][c->k] - c->v.model->gravity[i];
    if (c->v.model->free_base)
        apply3_transposed(c->world->A[BODY_BASE], world, own);
    for (int i = 0; i < plan->unknowns; ++i) {
        double right = 0;
        if (c->v.model->free_base && i < 6)
            right = i < 3 ? run->rate[twist + 3 + i][c->k] : own[i - 3];
        for (int j = 0; j < c->v.model->coordinates; ++j)
            right = plan->coordinate_unknown[j] == i ? c->world->xdd[j] : right;
        compare(c, KIND_ENERGY, unknown_name(c, i), run->acc[i][c->k] - right, fabs(right) + c->swing);
    }
}

/* Growth of kinetic and potential energy against the power of dampers, tires and drives. drive: forces of drives
 * [coordinates] */
static void compare_energy(Comparison *c, const double *drive)
{
    const Run *run = c->v.run;
    double right = c->world->power, scale = c->watts + fabs(run->energy[2][c->k]) + 1e-3 * (1 + c->push);
    for (int j = 0; j < c->v.model->coordinates; ++j)
        if (c->v.model->coordinate[j].driven) {
            right += drive[j] * c->world->xd[j];
            scale += fabs(drive[j] * c->world->xd[j]);
        }
    for (int i = 0; i < 2; ++i)
        compare(c, KIND_ENERGY, i ? "power" : "growth", run->energy[i][c->k] - right, scale);
    compare_unknowns(c);
}

/* The numbers that decide on a change of gear. */
static void compare_shift(Comparison *c)
{
    const Powertrain *powertrain = c->v.model->powertrain;
    if (!powertrain)
        return;
    Values *choice = c->v.run->choice;
    const int count = powertrain->forward - 1;
    double right[2 * powertrain->forward];
    right[CHOICE_SELECTOR] = powertrain->selector ? world_law(c->world, powertrain->selector, NULL) : 1;
    right[CHOICE_TURBINE] = c->world->driveline.turbine_speed;
    for (int i = 0; i < count; ++i) {
        right[CHOICE_UP + i] = world_law(c->world, powertrain->up[i], NULL);
        right[CHOICE_UP + count + i] = world_law(c->world, powertrain->down[i], NULL);
    }
    for (int i = 0; i < CHOICE_UP + 2 * count; ++i)
        compare(c, KIND_SHIFT, "shift", choice[i][c->k] - right[i], 1 + fabs(right[i]));
}

static void compare_motion(Comparison *c)
{
    const Run *run = c->v.run;
    const int n = run->plan->unknowns, twist = 7 + run->plan->free_coordinates;
    double a[3] = {0}, alpha[3] = {0}, tau[n + 1], scale[n + 1], drive[c->v.model->coordinates + 1];
    for (int i = 0; c->v.model->free_base && i < 3; ++i) {
        a[i] = run->rate[twist + i][c->k];
        alpha[i] = run->rate[twist + 3 + i][c->k];
    }
    compare_accelerate(c, a, alpha);
    for (int t = 0; t < c->world->ties; ++t)
        world_gamma(c->world, t);
    compare_rows(c, KIND_ACCELERATION, (const double(*)[BODY_Q])c->world->qdd, c->world->xdd, true,
                 row_floor(c, c->swing));
    find_push(c);
    find_balance(c, tau, scale, drive);
    for (int i = 0; i < n; ++i)
        compare(c, KIND_MOTION, unknown_name(c, i), tau[i], scale[i] + 1e-3 * c->push);
    for (int j = 0; j < c->v.model->coordinates; ++j)
        if (c->v.model->coordinate[j].driven)
            c->world->multiplier[c->world->tie[c->world->coordinate_tie[j]].first] = drive[j] / c->world->dual[j];
    compare_rates(c);
    compare_fast(c);
    compare_grip(c);
    compare_energy(c, drive);
    compare_shift(c);
}

/* True if a component of an output is a force, moment or torque; else it is a length, rate or slip. */
static bool is_push(const Output *output, int component)
{
    switch (output->type) {
    case OUTPUT_FORCE:
    case OUTPUT_DRIVE_FORCE:
    case OUTPUT_REACTION: return true;
    case OUTPUT_WHEEL: return component == 0;
    case OUTPUT_TIRE: return component < 5 || component >= 10;
    default: return false;
    }
}

/* The magnitude that differences of an output's component are relative to. */
static double output_scale(const Comparison *c, const Output *output, const double *value, int component)
{
    double size = 0;
    for (int j = 0; j < output->count; ++j)
        size = fmax(size, fabs(value[j]));
    if (is_push(output, component))
        return size + (output->type == OUTPUT_WHEEL || output->type == OUTPUT_TIRE ? 1 : c->push);
    switch (output->type) {
    case OUTPUT_ACCELERATION: return size + c->swing;
    case OUTPUT_VELOCITY:
    case OUTPUT_ANGULAR_VELOCITY: return size + c->speed + 1e-3;
    case OUTPUT_ENERGY: return component < 2 ? fabs(value[0]) + fabs(value[1]) + 1 : size + c->watts + 1;
    case OUTPUT_COORDINATE: return fabs(value[component]) + (component == 2 ? c->swing : 1);
    case OUTPUT_SIGNAL: return world_law_size(c->world, c->v.model->signal[output->index].law, NULL) + 1;
    default: return fabs(value[component]) + 1;
    }
}

/* The rotation for given roll, pitch and yaw. */
static void attitude_of(const double angle[3], double A[9])
{
    const double r[4] = {cos(angle[0] / 2), sin(angle[0] / 2), 0, 0},
                 p[4] = {cos(angle[1] / 2), 0, sin(angle[1] / 2), 0},
                 y[4] = {cos(angle[2] / 2), 0, 0, sin(angle[2] / 2)};
    double t[4], e[4];
    euler_product(y, p, t);
    euler_product(t, r, e);
    mat_from_euler(e, A);
}

/* Angles and Euler parameters may jump although the rotation does not, so rotations are compared. If the body's x axis
 * is vertical, roll and yaw are about the same axis and only their sum or difference is defined: then the axis alone is
 * compared. */
static void compare_attitude(Comparison *c, Kind which, const Output *output, const double *value, const double *right)
{
    double A[9], B[9];
    const bool angles = output->type == OUTPUT_ROLL_PITCH_YAW;
    (angles ? attitude_of : mat_from_euler)(value, A);
    (angles ? attitude_of : mat_from_euler)(right, B);
    const bool upright = angles && hypot(B[0], B[3]) < 1e-4;
    for (int i = 0; i < 9; ++i)
        compare(c, which, output->name, upright && i % 3 ? 0 : A[i] - B[i], 1);
}

/* A formula that has no value at a state, such as the root of a negative number, can't be compared there, nor an angle
 * where it jumps by a whole turn. Code takes 0 times anything as 0, and so may have a value where there is none. */
static bool has_no_value(const Comparison *c, const Output *output, double right)
{
    return output->type == OUTPUT_SIGNAL &&
           (!isfinite(right) || world_law_jumps(c->world, c->v.model->signal[output->index].law));
}

/* Compare an output's components, at column k, with given values. */
void compare_output(Comparison *c, Kind which, const Output *output, Values *given, const double *right)
{
    double value[OUTPUT_MAX_COMPONENTS];
    for (int j = 0; j < output->count; ++j)
        value[j] = given[j][c->k];
    if (output->type == OUTPUT_ORIENTATION || output->type == OUTPUT_ROLL_PITCH_YAW) {
        compare_attitude(c, which == KIND_OUTPUT ? KIND_ATTITUDE : which, output, value, right);
        return;
    }
    for (int j = 0; j < output->count; ++j)
        if (!has_no_value(c, output, right[j]))
            compare(c, which, output->component[j], value[j] - right[j], output_scale(c, output, right, j));
}

static void compare_outputs(Comparison *c, bool reactions)
{
    const Model *model = c->v.model;
    world_outputs(c->world, c->out);
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        if (output_reads(model, &model->output[i], OUTPUT_REACTION) == reactions)
            compare_output(c, reactions ? KIND_REACTION : KIND_OUTPUT, &model->output[i], c->v.run->out + at,
                           c->out + at);
}

static void compare_poses(Comparison *c)
{
    const Model *model = c->v.model;
    double pose[7 * model->bodies], e[4], A[9], B[9];
    world_poses(c->world, pose);
    for (int b = 0; b < model->bodies; ++b) {
        for (int i = 0; i < 3; ++i)
            compare(c, KIND_POSES, model->body[b].name, c->v.run->pose[7 * b + i][c->k] - pose[7 * b + i],
                    c->world->size + fabs(pose[7 * b + i]));
        for (int i = 0; i < 4; ++i)
            e[i] = c->v.run->pose[7 * b + 3 + i][c->k];
        mat_from_euler(e, A);
        mat_from_euler(pose + 7 * b + 3, B);
        for (int i = 0; i < 9; ++i)
            compare(c, KIND_POSES, model->body[b].name, A[i] - B[i], 1);
    }
}

/* Compare multipliers with those of the comparison engines' topology-based solver. */
static void compare_reactions(Comparison *c)
{
    if (!c->world->solver)
        return;
    world_forces(c->world);
    world_spread(c->world);
    for (int t = 0; t < c->world->ties; ++t)
        world_gamma(c->world, t);
    if (world_accelerate(c->world) == GIC_OK)
        compare_outputs(c, true);
}

/* Compare the self-test's residual of the equations of motion at other accelerations. */
static void compare_inverse(Comparison *c)
{
    const Run *run = c->v.run;
    const Plan *plan = run->plan;
    World *world = c->world;
    const int n = plan->unknowns;
    double a[3] = {0}, alpha[3] = {0}, own[3], tau[n + 1], scale[n + 1], drive[c->v.model->coordinates + 1];
    for (int i = 0; c->v.model->free_base && i < 3; ++i) {
        alpha[i] = c->acc[i][c->k];
        own[i] = c->acc[3 + i][c->k];
    }
    if (c->v.model->free_base) {
        apply3(world->A[BODY_BASE], own, a);
        add3(a, c->v.model->gravity, a);
    }
    for (int j = 0; j < c->v.model->coordinates; ++j)
        if (plan->coordinate_unknown[j] >= 0)
            world->xdd[j] = c->acc[plan->coordinate_unknown[j]][c->k];
    compare_accelerate(c, a, alpha);
    world_forces(world);
    find_balance(c, tau, scale, drive);
    for (int i = 0; i < n; ++i)
        compare(c, KIND_INVERSE, unknown_name(c, i), run->tau[i][c->k] - tau[i], scale[i] + 1e-3 * c->push);
}

/* True if forces and rates of fast states are finite. Some formulas have no value at such states: a wheel that lies
 * flat has no rolling direction, an element between coinciding points no direction of force, one about an axis no angle
 * where what it follows lies along it. */
static bool forces_exist(Comparison *c)
{
    const double flat = 1.57, meeting = 1e-6;
    const World *world = c->world;
    double sum = 0;
    if (world_forces(c->world) != GIC_OK)
        return false;
    if (world->shortest < meeting * world->size || world->unclear)
        return false;
    for (int b = world->first; b < world->bodies; ++b)
        for (int i = 0; i < 6; ++i)
            sum += world->wrench[b][i];
    for (int i = 0; i < c->v.model->coordinates; ++i)
        sum += world->along[i];
    for (int i = 0; i < c->v.model->fast_states; ++i)
        sum += world->fast_rate[i];
    for (int i = 0; i < c->v.model->wheels; ++i)
        if (c->v.model->wheel[i].tire >= 0 && !(fabs(world->rolling[i].camber) < flat))
            return false;
    return isfinite(sum) && world_signals_are_sure(world);
}

/* True if formulas of gears and couplers have values and derivatives that leave digits to compare: near a pole, or far
 * up an exponential function, a body is so far away, or so fast, that rounding is all that there is. */
static bool couplings_exist(const Comparison *c)
{
    const double most = 1e5; /* squares of such numbers leave six digits of what is not squared */
    const Model *model = c->v.model;
    for (int j = 0; j < model->joints; ++j) {
        if (!joint_is_coupled(model->joint[j].type))
            continue;
        const Jet jet = world_jet(c->world, model->joint[j].value, c->world->xd);
        if (!(fabs(jet.value) < most && fabs(jet.rate) < most && fabs(jet.second) < most))
            return false;
    }
    return true;
}

bool compare_state(Comparison *c)
{
    World *world = c->world;
    load(c);
    if (!couplings_exist(c))
        return false;
    compare_place_base(c);
    for (int b = 1; b < c->v.model->bodies; ++b)
        compare_place_body(c, b);
    double far = 1; /* rounding grows with the distance, to where a steep formula of a coupler has moved a body */
    for (int b = 1; b < c->v.model->bodies; ++b)
        for (int i = 0; i < 3; ++i)
            far = fmax(far, fabs(world->q[b][i] - world->q[BODY_BASE][i]));
    for (int t = 0; t < world->ties; ++t) {
        compare(c, KIND_POSE, tie_name(c, t), world_tie_residual(world, t), far);
        if (!world_rows(world, t))
            compare(c, KIND_POSE, tie_name(c, t), 1, 1);
    }
    compare_rows(c, KIND_VELOCITY, (const double(*)[BODY_Q])world->qd, world->xd, false, row_floor(c, c->speed));
    compare_partials(c);
    if (!forces_exist(c))
        return false;
    compare_motion(c);
    compare_outputs(c, false);
    compare_poses(c);
    compare_reactions(c);
    if (c->self_test)
        compare_inverse(c);
    return true;
}
