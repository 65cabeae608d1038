/* SPDX-License-Identifier: MIT
 * Where bodies are in the world and how they move, from what blocks give in the base's frame. */
#include "base/vec3.h"
#include "subset/subset.h"
#include "validate/compare.h"
#include "validate/run.h"
#include "vehicle/vehicle.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* ---- from the base's frame to the world -------------------------------------------------------------------------- */

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

void compare_set_rate(World *world, int b, const double v[3], const double omega[3], double (*rate)[BODY_Q])
{
    copy3(v, rate[b]);
    euler_rate(world->q[b] + 3, omega, rate[b] + 3);
    for (int i = 3; i < BODY_Q; ++i)
        rate[b][i] *= 0.5;
}

void compare_motion3(const Comparison *c, int body, int number, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = run_motion(c->v.run, body, number + i, c->k);
}

void compare_place_base(Comparison *c)
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

void compare_base_origin(const Comparison *c, double r[3], double v[3])
{
    const Run *run = c->v.run;
    const int twist = 7 + run->plan->free_coordinates;
    for (int i = 0; i < 3; ++i) {
        r[i] = run->model->free_base ? run->y[i][c->k] : run->model->body[BODY_BASE].position[i];
        v[i] = run->model->free_base ? run->y[twist + i][c->k] : 0;
    }
}

void compare_place_body(Comparison *c, int b)
{
    World *world = c->world;
    const double *B = world->A[BODY_BASE], *turn = world->omega[BODY_BASE];
    double A[9], R[9], p[4], t[3], s[3], q[BODY_Q], v[3], omega[3], base[3], drift[3];
    compare_base_origin(c, base, drift);
    for (int i = 0; i < 9; ++i)
        A[i] = run_motion(c->v.run, b, MOTION_A + i, c->k);
    euler_of(A, p);
    mat_from_euler(p, R);
    for (int i = 0; i < 9; ++i)
        compare(c, KIND_ROTATION, c->v.model->body[b].name, R[i] - A[i], 1);
    /* from the base's origin to the reference point, and on to the centre of mass */
    double to_point[3], to_mass[3], arm[3];
    compare_motion3(c, b, MOTION_C, t);
    apply3(B, t, to_point);
    sub3(c->v.model->body[b].com, c->v.run->plan->origin[b], arm);
    apply3(R, arm, t);
    apply3(B, t, to_mass);
    add3(base, to_point, q);
    add3(q, to_mass, q);
    euler_product(world->q[BODY_BASE] + 3, p, q + 3);
    world_set_q(world, b, q);
    compare_motion3(c, b, MOTION_OMEGA, t);
    apply3(B, t, omega);
    add3(omega, turn, omega);
    compare_motion3(c, b, MOTION_VELOCITY, t);
    apply3(B, t, v);
    add3(v, drift, v);
    cross3(turn, to_point, t);
    add3(v, t, v);
    cross3(omega, to_mass, s);
    add3(v, s, v);
    compare_set_rate(world, b, v, omega, world->qd);
    world_set_rate(world, b, world->qd[b]);
    c->speed = fmax(c->speed, norm3(v) + world->size * norm3(omega));
}

/* ---- accelerations ----------------------------------------------------------------------------------------------- */

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
    compare_set_rate(world, BODY_BASE, out, alpha, world->qdd);
}

void compare_add_unit_motion(const Comparison *c, int b, int from, int j, double rate, double out[6])
{
    double at[3], origin[3], arm[3], swing[3], S[6];
    compare_motion3(c, b, MOTION_C, at);
    compare_motion3(c, from, MOTION_C, origin);
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
            compare_add_unit_motion(c, b, body, j, c->world->xdd[subset->dep[j]], own);
        body = subset->carrier;
    }
}

static void accelerate_body(Comparison *c, int b, const double base_a[3], const double base_alpha[3])
{
    World *world = c->world;
    const Run *run = c->v.run;
    const double *B = world->A[BODY_BASE], *turn = world->omega[BODY_BASE], *omega = world->omega[b];
    double own[6], alpha[3], a[3], t[3], s[3], to_point[3], to_mass[3], arm[3], relative[3];
    compare_motion3(c, b, MOTION_ALPHA, own);
    compare_motion3(c, b, MOTION_ACCELERATION, own + 3);
    add_unit_motions(c, b, own);
    compare_motion3(c, b, MOTION_C, t);
    apply3(B, t, to_point);
    compare_motion3(c, b, MOTION_OMEGA, t);
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
    compare_motion3(c, b, MOTION_VELOCITY, t);
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
    compare_set_rate(world, b, a, alpha, world->qdd);
    c->swing = fmax(c->swing, norm3(a) + world->size * (norm3(alpha) + dot3(omega, omega)));
}

void compare_accelerate(Comparison *c, const double a[3], const double own_alpha[3])
{
    double alpha[3];
    apply3(c->world->A[BODY_BASE], own_alpha, alpha);
    if (c->v.model->free_base)
        accelerate_base(c, a, alpha);
    for (int b = 1; b < c->v.model->bodies; ++b)
        accelerate_body(c, b, a, alpha);
}
