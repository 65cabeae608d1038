/* SPDX-License-Identifier: MIT
 * The augmented system
 *
 *     [ M      0      Phi_q^T  Psi_d^T ] [ q''    ]   [ Q     ]
 *     [ Phi_q  0      0        0       ] [ w''    ] = [ gamma ]
 *     [ Psi_q  Psi_w  0        0       ] [ lambda ]   [ gamma ]
 *
 * of all bodies, where a driven coordinate has a given w'' and in its place a multiplier. Velocity terms are the
 * rows' bias. The scales come from the same matrix: with gamma = 0 its solution is linear in Q, so that every term of
 * Q - M b, b the accelerations where those of base and free coordinates are zero, yields its own contribution. */
#include "solve.h"

#include "support.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

static void inertia_matrix(const Body *body, quad J[3][3])
{
    const double *I = body->inertia;
    const double full[3][3] = {{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            J[i][j] = full[i][j];
}

/* 7 x 7: m I, 4 G^T J G */
static void mass_matrix(const Body *body, const quad *q, quad M[BODY_COORDINATES][BODY_COORDINATES])
{
    quad J[3][3], G[3][4];
    inertia_matrix(body, J);
    euler_rate_matrix(q + 3, G);
    memset(M, 0, BODY_COORDINATES * sizeof *M);
    for (int i = 0; i < 3; ++i) {
        M[i][i] = body->mass;
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 4; ++k)
                for (int l = 0; l < 4; ++l)
                    M[3 + k][3 + l] += 4 * G[i][k] * J[i][j] * G[j][l];
    }
}

/* Derivative of the i-th row by coordinate c, by way of a formula. */
static quad followed(const Solver *solver, int i, int c)
{
    const Row *row = &solver->row[i];
    return row->follows ? row->w_slope * law_slope(solver->model, solver->configuration, row->follows, c) : 0;
}

/* A row that follows a free coordinate: its w'' has the place of the multiplier of the coordinate's own row, which is
 * -(d row / dw) / (d own row / dw) times that of the row, since nothing else acts along w. */
static void factor_follow(Solver *solver, int i, int c)
{
    const int n = solver->augmented->size, bodies = BODY_COORDINATES * solver->moving;
    const int place = solver->rows - solver->model->coordinates + c;
    const Row *own = &solver->row[place];
    const quad slope = followed(solver, i, c);
    quad *a = solver->augmented->a;
    if (slope == 0 || solver->model->coordinate[c].driven)
        return;
    a[(bodies + i) * n + bodies + place] = slope;
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j < BODY_COORDINATES && own->body[side] >= solver->first; ++j) {
            const int column = BODY_COORDINATES * (own->body[side] - solver->first) + j;
            a[column * n + bodies + i] -= slope / own->w_slope * own->slope[side][j];
        }
}

static void factor_fill(Solver *solver)
{
    const Model *model = solver->model;
    const Configuration *at = solver->configuration;
    int n = solver->augmented->size, bodies = BODY_COORDINATES * solver->moving;
    quad *a = solver->augmented->a;
    factors_clear(solver->augmented);
    for (int k = 0; k < solver->moving; ++k) {
        quad M[BODY_COORDINATES][BODY_COORDINATES];
        int start = BODY_COORDINATES * k, normal = bodies + solver->rows + k;
        mass_matrix(&model->body[solver->first + k], at->q[solver->first + k], M);
        for (int i = 0; i < BODY_COORDINATES; ++i)
            memcpy(a + (start + i) * n + start, M[i], sizeof M[i]);
        for (int j = 0; j < 4; ++j)
            a[normal * n + start + 3 + j] = a[(start + 3 + j) * n + normal] = at->q[solver->first + k][3 + j];
    }
    for (int i = 0; i < solver->rows; ++i) {
        const Row *row = &solver->row[i];
        int line = bodies + i;
        bool free_coordinate = row->coordinate >= 0 && !model->coordinate[row->coordinate].driven;
        for (int side = 0; side < 2; ++side)
            for (int j = 0; j < BODY_COORDINATES && row->body[side] >= solver->first; ++j) {
                int column = BODY_COORDINATES * (row->body[side] - solver->first) + j;
                a[line * n + column] = row->slope[side][j];
                if (!free_coordinate)
                    a[column * n + line] = row->slope[side][j];
            }
        if (free_coordinate)
            a[line * n + line] = row->w_slope;
    }
    for (int i = 0; i < solver->rows; ++i)
        for (int c = 0; c < model->coordinates; ++c)
            factor_follow(solver, i, c);
}

/* Right-hand sides of all second-derivative equations, into out[rows + bodies from `first_body`]. */
static void second_sides(const Solver *solver, const State *state, int first_body, quad *out)
{
    const Model *model = solver->model;
    for (int i = 0; i < solver->rows; ++i) {
        const Row *row = &solver->row[i];
        out[i] = -row->bias;
        if (row->coordinate >= 0 && model->coordinate[row->coordinate].driven)
            out[i] -= row->w_slope * state->w_second[row->coordinate];
        for (int c = 0; c < model->coordinates; ++c)
            if (model->coordinate[c].driven)
                out[i] -= followed(solver, i, c) * state->w_second[c];
    }
    for (int k = first_body; k < model->bodies; ++k) {
        const quad *rate = solver->configuration->rate[k] + 3;
        out[solver->rows + k - first_body] = -quad_dot(rate, rate, 4);
    }
}

/* Accelerations where those of base and free coordinates are zero. */
static void solve_bias(Solver *solver, const State *state)
{
    const Model *model = solver->model;
    const Configuration *at = solver->configuration;
    memset(solver->bias, 0, (size_t)model->bodies * sizeof *solver->bias);
    if (model->free_base) {
        static const double origin[3] = {0};
        quad *base = solver->bias[0], s[3], B[3][4], B_rate[3][4];
        const quad *p = at->q[0] + 3, *rate = at->rate[0] + 3;
        from_com(model, 0, origin, s);
        rotation_slope(p, s, B);
        rotation_slope(rate, s, B_rate);
        for (int j = 0; j < 4; ++j)
            base[3 + j] = -p[j] * quad_dot(rate, rate, 4);
        for (int i = 0; i < 3; ++i)
            base[i] = -quad_dot(B[i], base + 3, 4) - quad_dot(B_rate[i], rate, 4);
    }
    quad *x = solver->unknown;
    second_sides(solver, state, 1, x);
    for (int i = 0; i < solver->rows; ++i)
        for (int side = 0; side < 2; ++side)
            if (solver->row[i].body[side] == 0)
                x[i] -= quad_dot(solver->row[i].slope[side], solver->bias[0], BODY_COORDINATES);
    quad_solve(solver->dependent, x);
    for (int k = 1; k < model->bodies; ++k)
        memcpy(solver->bias[k], x + BODY_COORDINATES * (k - 1), sizeof solver->bias[k]);
}

static void clear_force(Solver *solver)
{
    memset(solver->force, 0, (size_t)solver->model->bodies * sizeof *solver->force);
}

static void add_gravity(Solver *solver, int body)
{
    for (int i = 0; i < 3; ++i)
        solver->force[body][i] += (quad)solver->model->body[body].mass * solver->model->gravity[i];
}

/* -2 G^T (omega x J omega) */
static void add_gyroscopic(Solver *solver, int body)
{
    const quad *q = solver->configuration->q[body], *rate = solver->configuration->rate[body];
    quad J[3][3], G[3][4], omega[3], spin[3], moment[3];
    inertia_matrix(&solver->model->body[body], J);
    euler_rate_matrix(q + 3, G);
    for (int i = 0; i < 3; ++i)
        omega[i] = 2 * quad_dot(G[i], rate + 3, 4);
    for (int i = 0; i < 3; ++i)
        spin[i] = quad_dot(J[i], omega, 3);
    quad_cross(omega, spin, moment);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j)
            solver->force[body][3 + j] -= 2 * G[i][j] * moment[i];
}

static void add_bias(Solver *solver, int body)
{
    quad M[BODY_COORDINATES][BODY_COORDINATES];
    mass_matrix(&solver->model->body[body], solver->configuration->q[body], M);
    for (int i = 0; i < BODY_COORDINATES; ++i)
        solver->force[body][i] -= quad_dot(M[i], solver->bias[body], BODY_COORDINATES);
}

/* Accelerations of the groups, as they follow from q'' of the base and w''. */
typedef struct Groups {
    quad a[3], alpha[3];
} Groups;

/* q'' of the base to its groups; `moving`: with the terms of its present velocity. */
static Groups base_groups(const Solver *solver, const quad *second, bool moving)
{
    static const double origin[3] = {0};
    const quad *p = solver->configuration->q[0] + 3, *rate = solver->configuration->rate[0] + 3;
    Groups groups;
    quad s[3], B[3][4], B_rate[3][4], G[3][4];
    from_com(solver->model, 0, origin, s);
    rotation_slope(p, s, B);
    rotation_slope(rate, s, B_rate);
    euler_rate_matrix(p, G);
    for (int i = 0; i < 3; ++i) {
        groups.a[i] = second[i] + quad_dot(B[i], second + 3, 4) + (moving ? quad_dot(B_rate[i], rate, 4) : 0);
        groups.alpha[i] = 2 * quad_dot(G[i], second + 3, 4);
    }
    return groups;
}

static quad norm(const quad x[3])
{
    return sqrtq(quad_dot(x, x, 3));
}

static quad *unknown_row(const Solver *solver, int row)
{
    return solver->unknown + BODY_COORDINATES * solver->moving + row;
}

/* The sum over all terms, as it grows; compared with the whole at the end. */
typedef struct Sum {
    Groups groups;
    quad *w, *drive;
    Reaction *reaction;
} Sum;

/* How fast the two ends of a coordinate accelerate, added up: angular accelerations for an angle, else those of the
 * points. The coordinate's own acceleration is a difference of the two. */
static quad ends(const Solver *solver, const Coordinate *coordinate)
{
    const Model *model = solver->model;
    quad sum = 0;
    for (int side = 0; side < 2; ++side) {
        int body = coordinate->body[side];
        if (body < solver->first)
            continue;
        const quad *second = solver->unknown + BODY_COORDINATES * (body - solver->first);
        const quad *p = solver->configuration->q[body] + 3;
        quad s[3], B[3][4], x[3];
        if (coordinate->type == ANGLE) {
            euler_rate_matrix(p, B);
            for (int i = 0; i < 3; ++i)
                x[i] = 2 * quad_dot(B[i], second + 3, 4);
        } else {
            from_com(model, body, coordinate->point[side], s);
            rotation_slope(p, s, B);
            for (int i = 0; i < 3; ++i)
                x[i] = second[i] + quad_dot(B[i], second + 3, 4);
        }
        sum += norm(x);
    }
    return sum;
}

/* The force that drives a coordinate: the row's multiplier acts as -dPsi/dq lambda; along w that is dPsi/dw lambda. */
static quad drive_force(const Solver *solver, int coordinate)
{
    int row = solver->rows - solver->model->coordinates + coordinate;
    quad force = *unknown_row(solver, row) * solver->row[row].w_slope;
    if (!solver->model->coordinate[coordinate].driven)
        return 0;
    for (int i = 0; i < solver->rows; ++i)
        force += *unknown_row(solver, i) * followed(solver, i, coordinate);
    return force;
}

/* Magnitudes of the moments about its centre of mass that all joints of a body exert on it. */
static quad joint_moments(const Solver *solver, const Reaction *reaction, int body)
{
    const Model *model = solver->model;
    quad sum = 0, s[3];
    for (int j = 0; j < model->joints; ++j)
        for (int side = 0; side < 2; ++side)
            if (model->joint[j].body[side] == body) {
                from_com(model, body, model->joint[j].point[side], s);
                sum += norm(reaction[j].torque) + norm(reaction[j].force) * norm(s);
            }
    return sum;
}

static bool hands_on_torque(const Joint *joint)
{
    return joint->type != SPHERICAL && joint->type != DISTANCE && joint->type != REVOLUTE_SPHERICAL &&
           joint->type != POINT_ON_LINE && joint->type != POINT_IN_PLANE;
}

/* The terms of which a joint's torque is left on one of its bodies: the moments of that body's joints, and where it
 * carries another body by a joint that hands torques on, those of that one. What a light plate between a trailer's
 * hinge and a tractor's lets through is what is left of the trailer's forces on their long arms, though none has an arm
 * on the plate. */
static quad torque_terms(const Solver *solver, const Reaction *reaction, int joint, int side)
{
    const Model *model = solver->model;
    const int body = model->joint[joint].body[side];
    quad sum = joint_moments(solver, reaction, body);
    for (int j = 0; j < model->joints; ++j)
        if (j != joint && model->joint[j].body[0] == body && hands_on_torque(&model->joint[j]))
            sum += joint_moments(solver, reaction, model->joint[j].body[1]);
    return sum;
}

/* The same of drive forces and reactions. A torque is what is left of the moments that the joints of a body exert,
 * where a force on a long arm may turn a light strut, say, hardly at all: they are terms too, those of the body where
 * they are smaller. */
static void contribution_forces(Solver *solver, Sum *sum)
{
    const Model *model = solver->model;
    for (int c = 0; c < model->coordinates; ++c) {
        quad drive = drive_force(solver, c);
        sum->drive[c] += drive;
        solver->drive_scale[c] += fabsq(drive);
    }
    Reaction *reaction = grab((size_t)model->joints + 1, sizeof *reaction);
    for (int j = 0; j < model->joints; ++j)
        reaction[j] = joint_reaction(solver, j);
    for (int j = 0; j < model->joints; ++j) {
        const Reaction *own = &reaction[j];
        Reaction *total = &sum->reaction[j];
        quad moments = torque_terms(solver, reaction, j, 1);
        if (model->joint[j].body[0] >= solver->first)
            moments = fminq(moments, torque_terms(solver, reaction, j, 0));
        for (int i = 0; i < 3; ++i) {
            total->force[i] += own->force[i];
            total->torque[i] += own->torque[i];
        }
        total->force_scale += own->force_scale;
        total->torque_scale += own->torque_scale + moments;
    }
    free(reaction);
}

/* Solve for what solver->force alone does, and add magnitudes to the scales. */
static void contribution(Solver *solver, Sum *sum)
{
    const Model *model = solver->model;
    quad power = 0;
    for (int k = solver->first; k < model->bodies; ++k)
        power += quad_dot(solver->force[k], solver->configuration->rate[k], BODY_COORDINATES);
    solver->energy_scale[2] += fabsq(power);
    memset(solver->unknown, 0, (size_t)solver->augmented->size * sizeof *solver->unknown);
    memcpy(solver->unknown, solver->force[solver->first], (size_t)solver->moving * sizeof *solver->force);
    quad_solve(solver->augmented, solver->unknown);
    if (model->free_base) {
        Groups groups = base_groups(solver, solver->unknown, false);
        for (int i = 0; i < 3; ++i) {
            sum->groups.a[i] += groups.a[i];
            sum->groups.alpha[i] += groups.alpha[i];
        }
        solver->a_scale += norm(groups.a);
        solver->alpha_scale += norm(groups.alpha);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven) {
            quad w = *unknown_row(solver, solver->rows - model->coordinates + c);
            sum->w[c] += w;
            solver->w_scale[c] += fabsq(w) + ends(solver, &model->coordinate[c]);
        }
    contribution_forces(solver, sum);
    clear_force(solver);
}

/* Larger of the error so far and that of a sum, relative to its scale. */
static quad worse(quad error, quad sum, quad whole, quad scale)
{
    return sum == whole ? error : fmaxq(error, fabsq(sum - whole) / scale);
}

/* Deviations of the sums of drive forces and reactions from the whole, which takes over the scales. */
static void compare_forces(Solver *solver, const Sum *sum)
{
    for (int c = 0; c < solver->model->coordinates; ++c)
        solver->sum_error = worse(solver->sum_error, sum->drive[c], solver->drive_force[c], solver->drive_scale[c]);
    for (int j = 0; j < solver->model->joints; ++j) {
        const Reaction *own = &sum->reaction[j];
        Reaction *whole = &solver->reaction[j];
        whole->force_scale = own->force_scale;
        whole->torque_scale = own->torque_scale;
        for (int i = 0; i < 3; ++i) {
            solver->sum_error = worse(solver->sum_error, own->force[i], whole->force[i], own->force_scale);
            solver->sum_error = worse(solver->sum_error, own->torque[i], whole->torque[i], own->torque_scale);
        }
    }
}

static void scales(Solver *solver)
{
    const Model *model = solver->model;
    size_t coordinates = (size_t)model->coordinates;
    Sum sum = {.w = grab(coordinates, sizeof *sum.w),
               .drive = grab(coordinates, sizeof *sum.drive),
               .reaction = grab((size_t)model->joints, sizeof *sum.reaction)};
    solver->a_scale = solver->alpha_scale = solver->energy_scale[2] = solver->sum_error = 0;
    memset(solver->w_scale, 0, coordinates * sizeof *solver->w_scale);
    memset(solver->drive_scale, 0, coordinates * sizeof *solver->drive_scale);
    clear_force(solver);
    for (int k = solver->first; k < model->bodies; ++k) {
        add_gravity(solver, k);
        contribution(solver, &sum);
        add_gyroscopic(solver, k);
        add_bias(solver, k);
        contribution(solver, &sum);
    }
    for (int i = 0; i < model->forces; ++i) {
        add_force_element(model, solver->configuration, solver->row, i, solver->force);
        contribution(solver, &sum);
    }
    for (int i = 0; i < model->wheels; ++i) {
        add_wheel(model, solver->configuration, i, solver->wheel[i].value, solver->force);
        contribution(solver, &sum);
    }
    for (int i = 0; i < 3 && model->free_base; ++i) {
        quad a = fabsq(sum.groups.a[i] - solver->a[i]), alpha = fabsq(sum.groups.alpha[i] - solver->alpha[i]);
        solver->sum_error = fmaxq(solver->sum_error, a > 0 ? a / solver->a_scale : 0);
        solver->sum_error = fmaxq(solver->sum_error, alpha > 0 ? alpha / solver->alpha_scale : 0);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (!model->coordinate[c].driven && sum.w[c] != solver->w_second[c])
            solver->sum_error = fmaxq(solver->sum_error, fabsq(sum.w[c] - solver->w_second[c]) / solver->w_scale[c]);
    compare_forces(solver, &sum);
    free(sum.w);
    free(sum.drive);
    free(sum.reaction);
}

bool solve_accelerations(Solver *solver, const State *state, const Road *road)
{
    const Model *model = solver->model;
    const Configuration *at = solver->configuration;
    rows_evaluate(model, at, solver->row);
    solve_bias(solver, state);
    factor_fill(solver);
    if (!quad_factor(solver->augmented))
        return false;
    clear_force(solver);
    for (int k = solver->first; k < model->bodies; ++k) {
        add_gravity(solver, k);
        add_gyroscopic(solver, k);
    }
    for (int i = 0; i < model->forces; ++i)
        add_force_element(model, at, solver->row, i, solver->force);
    for (int i = 0; i < model->wheels; ++i)
        wheel_evaluate(model, at, road, i, state->fast[i], &solver->wheel[i]);
    if (model->powertrain)
        line_evaluate(model, at, &state->line, solver->wheel, &solver->line);
    for (int i = 0; i < model->wheels; ++i)
        add_wheel(model, at, i, solver->wheel[i].value, solver->force);
    memcpy(solver->unknown, solver->force[solver->first], (size_t)solver->moving * sizeof *solver->force);
    second_sides(solver, state, solver->first, unknown_row(solver, 0));
    quad_solve(solver->augmented, solver->unknown);
    memset(solver->second, 0, (size_t)model->bodies * sizeof *solver->second);
    memcpy(solver->second[solver->first], solver->unknown, (size_t)solver->moving * sizeof *solver->second);
    for (int c = 0; c < model->coordinates; ++c) {
        int row = solver->rows - model->coordinates + c;
        bool driven = model->coordinate[c].driven;
        solver->w_second[c] = driven ? state->w_second[c] : *unknown_row(solver, row);
        solver->drive_force[c] = drive_force(solver, c);
    }
    for (int j = 0; j < model->joints; ++j)
        solver->reaction[j] = joint_reaction(solver, j);
    if (model->free_base) {
        Groups groups = base_groups(solver, solver->second[0], true);
        memcpy(solver->a, groups.a, sizeof groups.a);
        memcpy(solver->alpha, groups.alpha, sizeof groups.alpha);
    }
    scales(solver);
    solve_energy(solver);
    return true;
}
