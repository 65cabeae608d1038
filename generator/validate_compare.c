/* SPDX-License-Identifier: MIT
 * What blocks give at one state, compared with the definitions of joints, forces and outputs in world coordinates. */
#include "validate_compare.h"

#include "powertrain.h"

#include "../runtime/small.h"

#include <math.h>
#include <string.h>

/* ---- from the base's frame to the world -----------------------------------------------------------------------------
 */

/* Euler parameters of a rotation. */
static void euler_of(const double A[9], double p[4])
{
    const double square[4] = {1 + A[0] + A[4] + A[8], 1 + A[0] - A[4] - A[8], 1 - A[0] + A[4] - A[8],
                              1 - A[0] - A[4] + A[8]};
    int i = 0;
    for (int j = 1; j < 4; ++j)
        if (square[j] > square[i])
            i = j;
    const double whole = 2 * sqrt(square[i]);
    const double odd[3] = {A[7] - A[5], A[2] - A[6], A[3] - A[1]};
    const double even[3] = {A[1] + A[3], A[2] + A[6], A[5] + A[7]}; /* xy, xz, yz */
    p[i] = whole / 4;
    if (i == 0) {
        for (int j = 0; j < 3; ++j)
            p[1 + j] = odd[j] / whole;
    } else {
        p[0] = odd[i - 1] / whole;
        for (int j = 1; j < 4; ++j)
            if (j != i)
                p[j] = even[i + j - 3] / whole;
    }
    double norm = 0;
    for (int j = 0; j < 4; ++j)
        norm += p[j] * p[j];
    for (int j = 0; j < 4; ++j)
        p[j] /= sqrt(norm);
}

static void set_rate(World *world, int b, const double v[3], const double omega[3], double (*rate)[BODY_Q])
{
    copy3(v, rate[b]);
    euler_rate(world->q[b] + 3, omega, rate[b] + 3);
    for (int i = 3; i < BODY_Q; ++i)
        rate[b][i] *= 0.5;
}

static void motion3(const Comparison *c, int body, int number, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = run_motion(c->v.run, body, number + i, c->k);
}

static void place_base(Comparison *c)
{
    const Run *run = c->v.run;
    double state[13];
    if (!c->v.model->free_base)
        return;
    const int twist = 7 + run->plan->free_coordinates;
    for (int i = 0; i < 7; ++i)
        state[i] = run->y[i][c->k];
    for (int i = 0; i < 6; ++i)
        state[7 + i] = run->y[twist + i][c->k];
    world_set_base(c->world, state, state + 3, state + 7, state + 10);
}

/* Position and velocity of the base's origin. */
static void base_origin(const Comparison *c, double r[3], double v[3])
{
    const Run *run = c->v.run;
    const int twist = 7 + run->plan->free_coordinates;
    for (int i = 0; i < 3; ++i) {
        r[i] = run->model->free_base ? run->y[i][c->k] : run->model->body[BODY_BASE].position[i];
        v[i] = run->model->free_base ? run->y[twist + i][c->k] : 0;
    }
}

/* Pose and velocity of a body from its motion: of the centre of mass, which is `arm` from the reference point. */
static void place_body(Comparison *c, int b)
{
    World *world = c->world;
    const double *B = world->A[BODY_BASE], *turn = world->omega[BODY_BASE];
    double A[9], R[9], p[4], t[3], s[3], q[BODY_Q], v[3], omega[3], base[3], drift[3];
    base_origin(c, base, drift);
    for (int i = 0; i < 9; ++i)
        A[i] = run_motion(c->v.run, b, MOTION_A + i, c->k);
    euler_of(A, p);
    mat_from_euler(p, R);
    for (int i = 0; i < 9; ++i)
        compare(c, KIND_ROTATION, c->v.model->body[b].name, R[i] - A[i], 1);
    /* from the base's origin to the reference point, and on to the centre of mass */
    double to_point[3], to_mass[3], arm[3];
    motion3(c, b, MOTION_C, t);
    apply3(B, t, to_point);
    sub3(c->v.model->body[b].com, c->v.run->plan->origin[b], arm);
    apply3(R, arm, t);
    apply3(B, t, to_mass);
    add3(base, to_point, q);
    add3(q, to_mass, q);
    euler_product(world->q[BODY_BASE] + 3, p, q + 3);
    world_set_q(world, b, q);
    motion3(c, b, MOTION_OMEGA, t);
    apply3(B, t, omega);
    add3(omega, turn, omega);
    motion3(c, b, MOTION_VELOCITY, t);
    apply3(B, t, v);
    add3(v, drift, v);
    cross3(turn, to_point, t);
    add3(v, t, v);
    cross3(omega, to_mass, s);
    add3(v, s, v);
    set_rate(world, b, v, omega, world->qd);
    world_set_rate(world, b, world->qd[b]);
    c->speed = fmax(c->speed, sqrt(dot3(v, v)) + world->size * sqrt(dot3(omega, omega)));
}

/* ---- accelerations
 * ----------------------------------------------------------------------------------------------------
 */

/* From the base's acceleration (world) and angular acceleration (world) and w'': of the centre of mass, as above. */
static void accelerate_base(Comparison *c, const double a[3], const double alpha[3])
{
    World *world = c->world;
    const double *omega = world->omega[BODY_BASE];
    double arm[3], t[3], s[3], out[3];
    apply3(world->A[BODY_BASE], c->v.model->body[BODY_BASE].com, arm);
    cross3(alpha, arm, out);
    cross3(omega, arm, t);
    cross3(omega, t, s);
    add3(out, s, out);
    add3(out, a, out);
    copy3(alpha, world->alpha[BODY_BASE]);
    set_rate(world, BODY_BASE, out, alpha, world->qdd);
}

/* Add S of a body, of its reference point, times a rate, for the j-th coordinate of a body that carries it or of
 * itself. */
static void add_unit_motion(const Comparison *c, int b, int from, int j, double rate, double out[6])
{
    double at[3], origin[3], arm[3], swing[3], S[6];
    motion3(c, b, MOTION_C, at);
    motion3(c, from, MOTION_C, origin);
    sub3(at, origin, arm);
    for (int i = 0; i < 6; ++i)
        S[i] = rate * run_motion(c->v.run, from, MOTION_S + 6 * j + i, c->k);
    cross3(S, arm, swing);
    for (int i = 0; i < 6; ++i)
        out[i] += S[i] + (i < 3 || from == b ? 0 : swing[i - 3]);
}

/* What the accelerations of all coordinates give a body. */
static void add_unit_motions(const Comparison *c, int b, double own[6])
{
    const Sequence *sequence = c->v.run->plan->sequence;
    for (int body = b; body != BODY_BASE;) {
        const Subset *subset = &sequence->subset[sequence->body_subset[body]];
        for (int j = 0; j < subset->deps; ++j)
            add_unit_motion(c, b, body, j, c->world->xdd[subset->dep[j]], own);
        body = subset->carrier;
    }
}

static void accelerate_body(Comparison *c, int b, const double base_a[3], const double base_alpha[3])
{
    World *world = c->world;
    const Run *run = c->v.run;
    const double *B = world->A[BODY_BASE], *turn = world->omega[BODY_BASE], *omega = world->omega[b];
    double own[6], alpha[3], a[3], t[3], s[3], to_point[3], to_mass[3], arm[3], relative[3];
    motion3(c, b, MOTION_ALPHA, own);
    motion3(c, b, MOTION_ACCELERATION, own + 3);
    add_unit_motions(c, b, own);
    motion3(c, b, MOTION_C, t);
    apply3(B, t, to_point);
    motion3(c, b, MOTION_OMEGA, t);
    apply3(B, t, relative);
    cross3(turn, relative, s);
    apply3(B, own, alpha);
    add3(alpha, s, alpha);
    add3(alpha, base_alpha, alpha);
    /* of the reference point: carried along, Coriolis, relative */
    cross3(base_alpha, to_point, a);
    cross3(turn, to_point, t);
    cross3(turn, t, s);
    add3(a, s, a);
    motion3(c, b, MOTION_VELOCITY, t);
    apply3(B, t, relative);
    cross3(turn, relative, t);
    add_scaled3(2, t, a);
    apply3(B, own + 3, t);
    add3(a, t, a);
    add3(a, base_a, a);
    /* of the centre of mass */
    sub3(c->v.model->body[b].com, run->plan->origin[b], arm);
    apply3(world->A[b], arm, to_mass);
    cross3(alpha, to_mass, t);
    add3(a, t, a);
    cross3(omega, to_mass, t);
    cross3(omega, t, s);
    add3(a, s, a);
    copy3(alpha, world->alpha[b]);
    set_rate(world, b, a, alpha, world->qdd);
    c->swing = fmax(c->swing, sqrt(dot3(a, a)) + world->size * (sqrt(dot3(alpha, alpha)) + dot3(omega, omega)));
}

/* All bodies at accelerations of the base's origin (world), of its rotation (base frame) and world->xdd. */
static void accelerate(Comparison *c, const double a[3], const double own_alpha[3])
{
    double alpha[3];
    apply3(c->world->A[BODY_BASE], own_alpha, alpha);
    if (c->v.model->free_base)
        accelerate_base(c, a, alpha);
    for (int b = 1; b < c->v.model->bodies; ++b)
        accelerate_body(c, b, a, alpha);
}

/* ---- equations
 * --------------------------------------------------------------------------------------------------------
 */

static const char *tie_name(const Comparison *c, int index)
{
    const Tie *tie = &c->world->tie[index];
    return tie->joint >= 0 ? c->v.model->joint[tie->joint].name : c->v.model->coordinate[tie->coordinate].name;
}

/* J x of a row, and the sum of magnitudes. */
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

/* All ties at rates or accelerations x and w: what remains. gamma: with the quadratic terms. */
static void compare_rows(Comparison *c, Kind which, const double (*x)[BODY_Q], const double *w, bool gamma,
                         double floor)
{
    World *world = c->world;
    for (int t = 0; t < world->ties; ++t) {
        const Tie *tie = &world->tie[t];
        for (int r = 0; r < tie->rows; ++r) {
            double scale = 0, rest = row_product(c, t, r, x, &scale);
            if (tie->coordinate >= 0) {
                const double term = world->dual[tie->coordinate] * w[tie->coordinate];
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

/* Bodies at a unit rate of one coordinate, the base held, in `twist`: of the centres of mass. */
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
            if (subset->carrier != BODY_BASE) { /* found before */
                motion3(c, b, MOTION_C, at);
                motion3(c, subset->carrier, MOTION_C, from);
                sub3(at, from, arm);
                memcpy(S[b], S[subset->carrier], sizeof S[b]);
                cross3(S[b], arm, t);
                add3(S[b] + 3, t, S[b] + 3);
            }
            for (int j = 0; j < subset->deps; ++j)
                if (subset->dep[j] == coordinate)
                    add_unit_motion(c, b, b, j, 1, S[b]);
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

/* Bodies at a unit rate of the base: about (0 to 2) or along (3 to 5) an axis of its frame. */
static void unit_rates_of_base(Comparison *c, int axis)
{
    World *world = c->world;
    double u[3], r[3], v[3], arm[3];
    base_origin(c, r, v);
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

static void compare_partials(Comparison *c)
{
    World *world = c->world;
    double(*x)[BODY_Q] = pool_alloc(c->v.pool, sizeof *x * (size_t)world->bodies);
    double *w = pool_alloc(c->v.pool, sizeof *w * ((size_t)c->v.model->coordinates + 1));
    for (int j = 0; j < c->v.model->coordinates; ++j) {
        unit_rates(c, j);
        for (int b = 0; b < world->bodies; ++b)
            set_rate(world, b, c->twist[b], c->twist[b] + 3, x);
        memset(w, 0, sizeof *w * ((size_t)c->v.model->coordinates + 1));
        w[j] = 1;
        compare_rows(c, KIND_PARTIAL, (const double(*)[BODY_Q])x, w, false, 1e-3 * fmin(world->size, 1));
    }
}

/* Virtual power of what moves the bodies less what acts on them at the rates in `twist`. */
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

/* Equations of motion of all unknowns, and the forces of drives. tau [unknowns] */
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

/* ---- one state ------------------------------------------------------------------------------------------------------
 */

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
    /* rounding of a body's weight and of rates of 1 is left where all else is 0 */
    c->speed = 1e-6;
    c->swing = 1e-6 * (1 + sqrt(dot3(model->gravity, model->gravity)));
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

/* What the wheels with tires hand on, to their carriers and to set-up. */
static void compare_grip(Comparison *c)
{
    const Model *model = c->v.model;
    for (int i = 0; i < model->wheels; ++i) {
        if (model->wheel[i].tire < 0)
            continue;
        const Rolling *r = &c->world->rolling[i];
        Values *grip = c->v.run->grip + GRIP_NUMBERS * wheel_rolling(model, i);
        const double force = 1 + sqrt(dot3(r->force, r->force));
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

static void find_push(Comparison *c)
{
    const World *world = c->world;
    c->push = c->watts = 0;
    for (int b = world->first; b < world->bodies; ++b) {
        const double *f = world->wrench[b];
        c->push = fmax(c->push, sqrt(dot3(f, f)) + sqrt(dot3(f + 3, f + 3)) / world->size);
        c->push = fmax(c->push, c->v.model->body[b].mass * c->swing);
        for (int i = 0; i < 3; ++i)
            c->watts += fabs(f[i] * world->qd[b][i]) + fabs(f[3 + i] * world->omega[b][i]);
    }
    for (int i = 0; i < c->v.model->forces; ++i) {
        const Force *force = &c->v.model->force[i];
        c->push = fmax(c->push, fabs(world->element[i]));
        /* a spring at its free length has the rounding of that */
        if (force_is_spring(force) && force->table < 0)
            c->push = fmax(c->push, fabs(world_law(world, force->stiffness, NULL)) * world->size);
    }
    for (int i = 0; i < c->v.model->coordinates; ++i)
        c->watts += fabs(world->along[i] * world->xd[i]);
    for (int i = 0; i < c->v.model->wheels; ++i)
        if (c->v.model->wheel[i].tire >= 0)
            c->watts += fabs(world->rolling[i].power);
}

/* Accelerations as the self-test has them: of the base in its own frame, less gravity. */
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

/* Growth of kinetic and potential energy, and the power of all else: both are that of dampers, tires and drives. drive:
 * forces of drives [coordinates] */
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

/* What a change of gear follows. */
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
    accelerate(c, a, alpha);
    for (int t = 0; t < c->world->ties; ++t)
        world_gamma(c->world, t);
    compare_rows(c, KIND_ACCELERATION, (const double(*)[BODY_Q])c->world->qdd, c->world->xdd, true,
                 1e-3 * c->swing * fmin(c->world->size, 1));
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

/* Which components of an output are forces, moments or torques; the others of the same are lengths, rates, slips. */
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

/* What differences of a component of an output are relative to. */
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
    default: return fabs(value[component]) + 1;
    }
}

/* The rotation that roll, pitch and yaw say. */
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

/* Angles and Euler parameters jump where the rotation does not: the rotations are compared. Where the body's x axis is
 * vertical, roll and yaw are of the same axis and each for itself is any: then the axis alone is compared. */
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

/* An output's components against what is right, at column k. */
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
        compare(c, which, output->component[j], value[j] - right[j], output_scale(c, output, right, j));
}

static void compare_outputs(Comparison *c, bool reactions)
{
    const Model *model = c->v.model;
    world_outputs(c->world, c->out);
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        if ((model->output[i].type == OUTPUT_REACTION) == reactions)
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

/* Multipliers by the topology-based solver of the comparison engines. */
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

/* The self-test's residual of the equations of motion at other accelerations. */
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
    accelerate(c, a, alpha);
    world_forces(world);
    find_balance(c, tau, scale, drive);
    for (int i = 0; i < n; ++i)
        compare(c, KIND_INVERSE, unknown_name(c, i), run->tau[i][c->k] - tau[i], scale[i] + 1e-3 * c->push);
}

/* Are forces and rates of fast states numbers? Some formulas have none beyond what they are meant for; a wheel that
 * lies flat on the road has no direction in which it would roll, and an element whose points meet none in which it
 * pulls. */
static bool forces_exist(Comparison *c)
{
    const double flat = 1.57, meeting = 1e-6;
    const World *world = c->world;
    double sum = 0;
    if (world_forces(c->world) != GIC_OK)
        return false;
    if (world->shortest < meeting * world->size)
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
    return isfinite(sum);
}

bool compare_state(Comparison *c)
{
    World *world = c->world;
    load(c);
    place_base(c);
    for (int b = 1; b < c->v.model->bodies; ++b)
        place_body(c, b);
    for (int t = 0; t < world->ties; ++t) {
        compare(c, KIND_POSE, tie_name(c, t), world_tie_residual(world, t), 1);
        if (!world_rows(world, t))
            compare(c, KIND_POSE, tie_name(c, t), 1, 1);
    }
    compare_rows(c, KIND_VELOCITY, (const double(*)[BODY_Q])world->qd, world->xd, false,
                 1e-3 * c->speed * fmin(world->size, 1));
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
