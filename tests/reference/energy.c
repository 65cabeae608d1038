/* SPDX-License-Identifier: MIT
 * Energies, and the power of everything that is not in them: not from the forces but as what changes their sum, from
 * the accelerations. */
#include "solve.h"

#include <quadmath.h>

const char *const energy_name[3] = {"kinetic", "potential", "power"};

typedef struct Term {
    quad sum, scale;
} Term;

static void add(Term *term, quad x)
{
    term->sum += x;
    term->scale += fabsq(x);
}

/* Kinetic energy and its rate; gravity's. */
static void add_body(const Solver *solver, int index, Term *kinetic, Term *potential, quad *rate)
{
    const Model *model = solver->model;
    const Body *body = &model->body[index];
    const quad *q = solver->configuration->q[index], *v = solver->configuration->rate[index];
    const quad *a = solver->second[index], m = body->mass;
    const double *I = body->inertia;
    const quad J[3][3] = {{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}};
    quad G[3][4], omega[3], alpha[3];
    euler_rate_matrix(q + 3, G);
    for (int i = 0; i < 3; ++i) {
        omega[i] = 2 * quad_dot(G[i], v + 3, 4);
        alpha[i] = 2 * quad_dot(G[i], a + 3, 4);
        add(kinetic, m * v[i] * v[i] / 2);
        add(potential, -m * model->gravity[i] * q[i]);
        *rate += m * v[i] * (a[i] - model->gravity[i]);
    }
    for (int i = 0; i < 3; ++i) {
        add(kinetic, omega[i] * quad_dot(J[i], omega, 3) / 2);
        *rate += omega[i] * quad_dot(J[i], alpha, 3);
    }
}

/* Of a spring or stop with a stiffness. */
static void add_spring(const Solver *solver, int index, Term *potential, quad *work)
{
    const Force *force = &solver->model->force[index];
    quad x, x_rate;
    if (force->load || force->table)
        return;
    if (force->bushing) {
        quad strain[6], rate[6];
        bushing_strain(solver->model, solver->configuration, index, strain, rate);
        for (int i = 0; i < 36; ++i) {
            add(potential, force->stiffness_matrix[i] * strain[i / 6] * strain[i % 6] / 2);
            *work += force->stiffness_matrix[i] * strain[i / 6] * rate[i % 6];
        }
        return;
    }
    element_extension(solver->model, solver->configuration, index, &x, &x_rate);
    quad over = force->stop ? fmaxq(0, x - force->high) - fmaxq(0, force->low - x) : x - force->free;
    add(potential, force->stiffness * over * over / 2);
    *work += force->stiffness * over * x_rate;
}

void solve_energy(Solver *solver)
{
    const Model *model = solver->model;
    Term kinetic = {0}, potential = {0};
    quad rate = 0;
    for (int k = solver->first; k < model->bodies; ++k)
        add_body(solver, k, &kinetic, &potential, &rate);
    for (int i = 0; i < model->forces; ++i)
        add_spring(solver, i, &potential, &rate);
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *wheel = &model->wheel[i];
        const WheelState *at = &solver->wheel[i];
        quad spin = at->value[SPIN];
        add(&kinetic, wheel->spin_inertia * spin * spin / 2);
        rate += wheel->spin_inertia * spin * at->value[SPIN_RATE];
        solver->energy_scale[2] += wheel->spin_inertia * fabsq(spin) * at->scale[SPIN_RATE];
    }
    for (int c = 0; c < model->coordinates; ++c)
        solver->energy_scale[2] += solver->drive_scale[c] * fabsq(solver->configuration->w_rate[c]);
    solver->energy[0] = kinetic.sum;
    solver->energy[1] = potential.sum;
    solver->energy[2] = rate;
    solver->energy_scale[0] = kinetic.scale;
    solver->energy_scale[1] = potential.scale;
}
