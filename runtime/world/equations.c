/* SPDX-License-Identifier: MIT */
#include "base/vec3.h"
#include "model/model.h"
#include "world/equations.h"

#include <math.h>

Equations *equations_new(Pool *pool, int bodies, bool free_base, int constraints, const Constraint *constraint)
{
    Equations *equations = pool_alloc(pool, sizeof *equations);
    *equations = (Equations){.bodies = bodies,
                             .constraints = constraints,
                             .free_base = free_base,
                             .constraint = constraint,
                             .first = pool_alloc(pool, (size_t)(constraints + 1) * sizeof(int)),
                             .mass = pool_alloc(pool, (size_t)bodies * sizeof(Mass))};
    for (int i = 0; i < constraints; ++i)
        equations->first[i + 1] = equations->first[i] + constraint[i].rows;
    equations->rows = equations->first[constraints];
    return equations;
}

void equations_mass(Equations *equations, int body, double mass, const double inertia[6])
{
    const double *J = inertia;
    Mass *to = &equations->mass[body];
    /* J = L L^T, T = L^-T */
    double a = sqrt(J[0]), b = J[3] / a, c = J[4] / a;
    double d = sqrt(J[1] - b * b), e = (J[5] - b * c) / d, f = sqrt(J[2] - c * c - e * e);
    *to = (Mass){.root = 1 / sqrt(mass),
                 .inertia = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]},
                 .T = {1 / a, -b / (a * d), (b * e - c * d) / (a * d * f), 0, 1 / d, -e / (d * f), 0, 0, 1 / f}};
}

bool equations_moves(const Equations *equations, int body)
{
    return body > BODY_BASE || (body == BODY_BASE && equations->free_base);
}

void equations_body(const Equations *equations, int body, const Numbers *numbers, Scaling *scaling, double f[6])
{
    const Mass *mass = &equations->mass[body];
    const double *p = numbers->q + 7 * body + 3, *rate = numbers->rate + 7 * body + 3;
    const double *force = numbers->force + 6 * body, *T = mass->T;
    /* G: body axes, omega = 2 G p' */
    double G[3][4] = {{-p[1], p[0], p[3], -p[2]}, {-p[2], -p[3], p[0], p[1]}, {-p[3], p[2], -p[1], p[0]}};
    double A[9], momentum[3], gyroscopic[3], moment[3], omega[3];
    for (int i = 0; i < 3; ++i)
        omega[i] = 2 * (G[i][0] * rate[0] + G[i][1] * rate[1] + G[i][2] * rate[2] + G[i][3] * rate[3]);
    mat_from_euler(p, A);
    apply3(mass->inertia, omega, momentum);
    cross3(omega, momentum, gyroscopic);
    apply3_transposed(A, force + 3, moment);
    for (int i = 0; i < 3; ++i)
        moment[i] -= gyroscopic[i];
    for (int i = 0; i < 3; ++i)
        f[i] = force[i] * mass->root;
    f[3] = T[0] * moment[0];
    f[4] = T[1] * moment[0] + T[4] * moment[1];
    f[5] = T[2] * moment[0] + T[5] * moment[1] + T[8] * moment[2];

    scaling->root = mass->root;
    scaling->square = rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2] + rate[3] * rate[3];
    for (int i = 0; i < 4; ++i) {
        double g0 = 0.5 * G[0][i], g1 = 0.5 * G[1][i], g2 = 0.5 * G[2][i];
        scaling->p[i] = p[i];
        scaling->H[3 * i] = g0 * T[0];
        scaling->H[3 * i + 1] = g0 * T[1] + g1 * T[4];
        scaling->H[3 * i + 2] = g0 * T[2] + g1 * T[5] + g2 * T[8];
    }
}

void equations_side(const Scaling *scaling, int rows, const double *jacobian, double *out, int row_step,
                    int column_step, double *gamma)
{
    const Scaling s = *scaling;
    for (int i = 0; i < rows; ++i, jacobian += 7, out += row_step) {
        const double *j = jacobian + 3;
        for (int k = 0; k < 3; ++k)
            out[column_step * k] = s.root * jacobian[k];
        for (int k = 0; k < 3; ++k)
            out[column_step * (3 + k)] = j[0] * s.H[k] + j[1] * s.H[3 + k] + j[2] * s.H[6 + k] + j[3] * s.H[9 + k];
        gamma[i] += s.square * (j[0] * s.p[0] + j[1] * s.p[1] + j[2] * s.p[2] + j[3] * s.p[3]);
    }
}

void equations_acceleration(const Scaling *scaling, const double minus_y[6], double acceleration[7])
{
    for (int i = 0; i < 3; ++i)
        acceleration[i] = -scaling->root * minus_y[i];
    for (int i = 0; i < 4; ++i)
        acceleration[3 + i] = -scaling->square * scaling->p[i] - scaling->H[3 * i] * minus_y[3] -
                              scaling->H[3 * i + 1] * minus_y[4] - scaling->H[3 * i + 2] * minus_y[5];
}
