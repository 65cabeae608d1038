/* SPDX-License-Identifier: MIT
 * Positions by continuation, velocities. */
#include "solve.h"

#include "support.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

Solver *solver_new(const Model *model)
{
    Solver *solver = grab(1, sizeof *solver);
    size_t bodies = (size_t)model->bodies, coordinates = (size_t)model->coordinates;
    solver->model = model;
    solver->rows = row_count(model);
    solver->first = model->free_base ? 0 : 1;
    solver->moving = model->bodies - solver->first;
    int dependent = BODY_COORDINATES * (model->bodies - 1);
    if (solver->rows + model->bodies - 1 != dependent)
        fail("%d equations for %d dependent coordinates", solver->rows + model->bodies - 1, dependent);
    int augmented = BODY_COORDINATES * solver->moving + solver->rows + solver->moving;
    solver->configuration = configuration_new(model);
    solver->trial = configuration_new(model);
    solver->row = grab((size_t)solver->rows, sizeof *solver->row);
    solver->dependent = factors_new(dependent);
    solver->augmented = factors_new(augmented);
    solver->unknown = grab((size_t)augmented, sizeof *solver->unknown);
    solver->force = grab(bodies, sizeof *solver->force);
    solver->second = grab(bodies, sizeof *solver->second);
    solver->bias = grab(bodies, sizeof *solver->bias);
    solver->w_second = grab(coordinates, sizeof *solver->w_second);
    solver->drive_force = grab(coordinates, sizeof *solver->drive_force);
    solver->w_scale = grab(coordinates, sizeof *solver->w_scale);
    solver->design_determinant = grab((size_t)model->subsets, sizeof *solver->design_determinant);
    solver->drive_scale = grab(coordinates, sizeof *solver->drive_scale);
    solver->wheel = grab((size_t)model->wheels, sizeof *solver->wheel);
    solver->reaction = grab((size_t)model->joints, sizeof *solver->reaction);
    return solver;
}

void solver_free(Solver *solver)
{
    configuration_free(solver->configuration);
    configuration_free(solver->trial);
    factors_free(solver->dependent);
    factors_free(solver->augmented);
    free(solver->row);
    free(solver->unknown);
    free(solver->force);
    free(solver->second);
    free(solver->bias);
    free(solver->w_second);
    free(solver->drive_force);
    free(solver->w_scale);
    free(solver->design_determinant);
    free(solver->drive_scale);
    free(solver->reaction);
    free(solver->wheel);
    free(solver);
}

State *state_new(const Model *model)
{
    State *state = grab(1, sizeof *state);
    state->e[0] = 1;
    state->w = grab((size_t)model->coordinates, sizeof *state->w);
    state->w_rate = grab((size_t)model->coordinates, sizeof *state->w_rate);
    state->w_second = grab((size_t)model->coordinates, sizeof *state->w_second);
    state->fast = grab((size_t)model->wheels, sizeof *state->fast);
    return state;
}

void state_free(State *state)
{
    free(state->w);
    free(state->w_rate);
    free(state->w_second);
    free(state->fast);
    free(state);
}

bool recover_largest(quad e[4])
{
    int largest = 0;
    for (int i = 1; i < 4; ++i)
        if (fabsq(e[i]) > fabsq(e[largest]))
            largest = i;
    quad rest = 1;
    for (int i = 0; i < 4; ++i)
        if (i != largest)
            rest -= e[i] * e[i];
    if (!(rest > 0))
        return false;
    e[largest] = copysignq(sqrtq(rest), e[largest]);
    return true;
}

void body_origin(const Model *model, const Configuration *configuration, int body, quad out[3])
{
    static const double origin[3] = {0};
    quad s[3], arm[3];
    from_com(model, body, origin, s);
    rotate(configuration->q[body] + 3, s, arm);
    for (int i = 0; i < 3; ++i)
        out[i] = configuration->q[body][i] + arm[i];
}

/* The design configuration, moved rigidly so that the base has the pose of the state. */
static void start_at_design(const Solver *solver, const State *state)
{
    const Model *model = solver->model;
    Configuration *to = solver->configuration;
    quad base[4], move[4], norm;
    for (int i = 0; i < 4; ++i)
        base[i] = i ? -(quad)model->body[0].euler[i] : model->body[0].euler[0];
    norm = sqrtq(quad_dot(base, base, 4));
    for (int i = 0; i < 4; ++i)
        base[i] /= norm;
    euler_product(state->e, base, move);
    for (int k = 0; k < model->bodies; ++k) {
        const Body *body = &model->body[k];
        quad p[4], com[3], arm[3], place[3], moved[3];
        for (int i = 0; i < 4; ++i)
            p[i] = body->euler[i];
        norm = sqrtq(quad_dot(p, p, 4));
        for (int i = 0; i < 4; ++i)
            p[i] /= norm;
        for (int i = 0; i < 3; ++i)
            com[i] = body->com[i];
        rotate(p, com, arm);
        for (int i = 0; i < 3; ++i)
            place[i] = body->position[i] + arm[i] - model->body[0].position[i];
        rotate(move, place, moved);
        for (int i = 0; i < 3; ++i)
            to->q[k][i] = state->r[i] + moved[i];
        euler_product(move, p, to->q[k] + 3);
    }
    /* no rounding of the products in the base itself: its parameters are those of the state */
    memcpy(to->q[0] + 3, state->e, sizeof state->e);
    for (int c = 0; c < model->coordinates; ++c)
        to->w[c] = model->coordinate[c].design;
    memset(to->rate, 0, (size_t)model->bodies * sizeof *to->rate);
    memset(to->w_rate, 0, (size_t)model->coordinates * sizeof *to->w_rate);
}

/* Factor the Jacobian of solver->row and the normalizations (p^T p - 1) / 2 = 0 with respect to the coordinates of
 * bodies 1.. */
static bool factor_dependent(Solver *solver, const Configuration *configuration)
{
    Factors *factors = solver->dependent;
    int n = factors->size;
    factors_clear(factors);
    for (int i = 0; i < solver->rows; ++i)
        for (int side = 0; side < 2; ++side) {
            int body = solver->row[i].body[side];
            if (body > 0)
                memcpy(factors->a + i * n + BODY_COORDINATES * (body - 1), solver->row[i].slope[side],
                       sizeof solver->row[i].slope[side]);
        }
    for (int k = 1; k < solver->model->bodies; ++k)
        for (int j = 0; j < 4; ++j)
            factors->a[(solver->rows + k - 1) * n + BODY_COORDINATES * (k - 1) + 3 + j] = configuration->q[k][3 + j];
    return (solver->coarse ? coarse_factor : quad_factor)(factors);
}

/* Residuals of all equations, negated, into solver->unknown; returns the largest. */
static quad residual(Solver *solver, const Configuration *configuration)
{
    quad largest = 0;
    for (int i = 0; i < solver->dependent->size; ++i) {
        quad value;
        if (i < solver->rows) {
            value = solver->row[i].value;
        } else {
            const quad *p = configuration->q[i - solver->rows + 1] + 3;
            value = (quad_dot(p, p, 4) - 1) / 2;
        }
        solver->unknown[i] = -value;
        largest = fmaxq(largest, fabsq(value));
    }
    return largest;
}

/* One Newton correction with the present factors; returns its size (metres relative to the model's length). */
static quad correct(Solver *solver, Configuration *configuration)
{
    quad size = 0;
    rows_evaluate(solver->model, configuration, solver->row);
    residual(solver, configuration);
    (solver->coarse ? coarse_solve : quad_solve)(solver->dependent, solver->unknown);
    for (int k = 1; k < solver->model->bodies; ++k)
        for (int j = 0; j < BODY_COORDINATES; ++j) {
            quad step = solver->unknown[BODY_COORDINATES * (k - 1) + j];
            configuration->q[k][j] += step;
            size = fmaxq(size, fabsq(j < 3 ? step / solver->model->length : step));
        }
    return size;
}

/* One step of continuation to the coordinates in `trial`, from a configuration whose Jacobian is factored: a tangent
 * step, then corrections that must shrink fast, else the step is too long to be sure of the branch. */
static bool continue_to(Solver *solver, Configuration *trial)
{
    quad tangent = correct(solver, trial);
    if (tangent > 0.3)
        return false;
    for (quad last = tangent; last > (solver->coarse ? 1e-6 : CLOSE);) {
        quad size = correct(solver, trial);
        if (!(size < 0.25 * last))
            return false;
        last = size;
    }
    return true;
}

static bool refactor(Solver *solver, const Configuration *configuration)
{
    rows_evaluate(solver->model, configuration, solver->row);
    return factor_dependent(solver, configuration);
}

/* From a configuration whose Jacobian is factored to the last digits. */
static bool polish(Solver *solver, const State *state)
{
    const Model *model = solver->model;
    Configuration *good = solver->configuration;
    for (int c = 0; c < model->coordinates; ++c)
        good->w[c] = state->w[c];
    /* places have the rounding of their distance from the origin, which a thread divides by its ratio */
    const quad far = fabsq(good->q[0][0]) + fabsq(good->q[0][1]) + fabsq(good->q[0][2]);
    quad enough = far > 1000 ? ROUGHLY / 1000 * far : ROUGHLY;
    for (int i = 0; i < model->joints; ++i)
        if (model->joint[i].type == SCREW || model->joint[i].type == RACK_AND_PINION)
            enough = fmaxq(enough, ROUGHLY / 100 * far / fabsq((quad)model->joint[i].offset));
    for (int i = 0; i < 20; ++i) {
        rows_evaluate(model, good, solver->row);
        const bool is_enough = residual(solver, good) < enough;
        correct(solver, good);
        if (is_enough)
            return refactor(solver, good);
    }
    return false;
}

bool solve_near(Solver *solver, const State *state, quad (*pose)[BODY_COORDINATES])
{
    const Model *model = solver->model;
    Configuration *at = solver->configuration;
    start_at_design(solver, state);
    for (int k = 1; k < model->bodies; ++k) {
        static const double origin[3] = {0};
        quad s[3], arm[3];
        const quad norm = sqrtq(quad_dot(pose[k] + 3, pose[k] + 3, 4));
        for (int i = 0; i < 4; ++i)
            at->q[k][3 + i] = pose[k][3 + i] / norm;
        from_com(model, k, origin, s);
        rotate(at->q[k] + 3, s, arm);
        for (int i = 0; i < 3; ++i)
            at->q[k][i] = pose[k][i] - arm[i];
    }
    for (int c = 0; c < model->coordinates; ++c)
        at->w[c] = state->w[c];
    for (quad size = 0.01, last = 1; size > 1e-14; last = size)
        if (!refactor(solver, at) || !((size = correct(solver, at)) < 0.01) || !(size < last))
            return false;
    return refactor(solver, at) && polish(solver, state);
}

/* Continuation along the straight line from the coordinates of a configuration whose Jacobian is factored. */
static bool walk(Solver *solver, const quad *to)
{
    const Model *model = solver->model;
    Configuration *good = solver->configuration, *trial = solver->trial;
    quad *from = grab((size_t)model->coordinates, sizeof *from), done = 0, step = 0.25;
    int sign = solver->dependent->sign;
    memcpy(from, good->w, (size_t)model->coordinates * sizeof *from);
    const quad shortest = solver->brisk ? 1e-3 : 1e-24;
    while (done < 1 && step >= shortest && !(solver->brisk && solver->way_determinant < 0.01)) {
        step = fminq(step, 1 - done);
        configuration_copy(model, trial, good);
        for (int c = 0; c < model->coordinates; ++c)
            trial->w[c] = from[c] + (done + step) * (to[c] - from[c]);
        /* a change of the determinant's sign means that a singular configuration was jumped over; a direction that
         * points away from its angle, that it was, along the axis, where it tells none */
        if (continue_to(solver, trial) && refactor(solver, trial) && solver->dependent->sign == sign &&
            angles_told(solver) > 0) {
            configuration_copy(model, good, trial);
            if (solver->brisk)
                go_on(solver);
            done += step;
            step *= 2;
        } else {
            step = refactor(solver, good) ? step / 2 : 0;
        }
    }
    free(from);
    return done >= 1;
}

/* Does one whole turn of an angle lead back to the present configuration? */
static bool turns_round(Solver *solver, int coordinate)
{
    const Model *model = solver->model;
    Configuration *at = solver->configuration, *before = configuration_new(model);
    const quad turn = 2 * acosq(-1);
    quad *to = grab((size_t)model->coordinates, sizeof *to), apart = 0;
    configuration_copy(model, before, at);
    memcpy(to, at->w, (size_t)model->coordinates * sizeof *to);
    to[coordinate] += turn;
    bool round = walk(solver, to);
    for (int k = 1; k < model->bodies && round; ++k) {
        const quad sign = quad_dot(at->q[k] + 3, before->q[k] + 3, 4) < 0 ? -1 : 1;
        for (int j = 0; j < BODY_COORDINATES; ++j)
            apart = fmaxq(apart, fabsq(at->q[k][j] - (j < 3 ? 1 : sign) * before->q[k][j]));
    }
    configuration_copy(model, at, before);
    configuration_free(before);
    free(to);
    return round && apart < 1e-4 * (1 + model->length) && refactor(solver, at);
}

/* From the design to the coordinates, but for whole turns of angles more than 100 rad away (FORMAT.md section 14: a
 * thousand pieces of a tenth) where one of them leads back to where it began. */
static bool go_from_design(Solver *solver, const State *state)
{
    const quad turn = 2 * acosq(-1), far = 100;
    const Model *model = solver->model;
    if (!refactor(solver, solver->configuration) || !continue_to(solver, solver->configuration) ||
        !refactor(solver, solver->configuration))
        return false;
    begin_way(solver);
    quad *to = grab((size_t)model->coordinates, sizeof *to);
    for (int c = 0; c < model->coordinates; ++c) {
        const quad way = state->w[c] - model->coordinate[c].design;
        const bool is_far = model->coordinate[c].type == ANGLE && fabsq(way) > far;
        to[c] = state->w[c] - (is_far ? turn * rintq(way / turn) : 0);
    }
    bool reached = walk(solver, to);
    for (int c = 0; c < model->coordinates && reached; ++c)
        reached = to[c] == state->w[c] || turns_round(solver, c);
    free(to);
    return reached;
}

bool solve_positions(Solver *solver, const State *state)
{
    start_at_design(solver, state);
    solver->coarse = solver->brisk;
    bool reached = go_from_design(solver, state);
    solver->coarse = false;
    return reached && (!solver->brisk || refactor(solver, solver->configuration)) && polish(solver, state);
}

void solve_velocities(Solver *solver, const State *state)
{
    const Model *model = solver->model;
    Configuration *at = solver->configuration;
    memset(at->rate, 0, (size_t)model->bodies * sizeof *at->rate);
    memcpy(at->w_rate, state->w_rate, (size_t)model->coordinates * sizeof *at->w_rate);
    if (model->free_base) {
        static const double origin[3] = {0};
        quad G[3][4], B[3][4], s[3];
        euler_rate_matrix(at->q[0] + 3, G);
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 3; ++i)
                at->rate[0][3 + j] += G[i][j] * state->omega[i] / 2;
        from_com(model, 0, origin, s);
        rotation_slope(at->q[0] + 3, s, B);
        for (int i = 0; i < 3; ++i)
            at->rate[0][i] = state->v[i] - quad_dot(B[i], at->rate[0] + 3, 4);
    }
    /* with the rates of all other bodies at zero a row's rate is the right-hand side of theirs */
    rows_evaluate(model, at, solver->row);
    memset(solver->unknown, 0, (size_t)solver->dependent->size * sizeof *solver->unknown);
    for (int i = 0; i < solver->rows; ++i)
        solver->unknown[i] = -solver->row[i].rate;
    quad_solve(solver->dependent, solver->unknown);
    for (int k = 1; k < model->bodies; ++k)
        memcpy(at->rate[k], solver->unknown + BODY_COORDINATES * (k - 1), sizeof at->rate[k]);
}
