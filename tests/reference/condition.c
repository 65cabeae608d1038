/* SPDX-License-Identifier: MIT
 * Condition of the subsets: singular values by one-sided Jacobi rotations, in double. */
#include "solve.h"

#include "support.h"

#include <math.h>
#include <stdlib.h>

/* One sweep over all pairs of columns of a square row-major matrix; returns the largest cosine between two of them. */
static double sweep(double *a, int n)
{
    double largest = 0;
    for (int p = 0; p < n; ++p)
        for (int q = p + 1; q < n; ++q) {
            double pp = 0, qq = 0, pq = 0;
            for (int i = 0; i < n; ++i) {
                pp += a[i * n + p] * a[i * n + p];
                qq += a[i * n + q] * a[i * n + q];
                pq += a[i * n + p] * a[i * n + q];
            }
            if (pq == 0)
                continue;
            largest = fmax(largest, fabs(pq) / sqrt(pp * qq));
            double cotangent = (qq - pp) / (2 * pq);
            double tangent = copysign(1, cotangent) / (fabs(cotangent) + hypot(1, cotangent));
            double c = 1 / hypot(1, tangent), s = c * tangent;
            for (int i = 0; i < n; ++i) {
                double x = a[i * n + p], y = a[i * n + q];
                a[i * n + p] = c * x - s * y;
                a[i * n + q] = s * x + c * y;
            }
        }
    return largest;
}

/* Squares of the singular values, in any order. */
static void singular_squares(double *a, int n, double *square)
{
    for (int i = 0; i < 60 && sweep(a, n) > 1e-14; ++i)
        ;
    for (int j = 0; j < n; ++j) {
        square[j] = 0;
        for (int i = 0; i < n; ++i)
            square[j] += a[i * n + j] * a[i * n + j];
    }
}

/* One row of a subset's Jacobian, normalized. */
static void twist_row(const Solver *solver, const Subset *subset, const Row *row, double length, double *out)
{
    int n = 6 * subset->bodies;
    double size = 0;
    for (int b = 0; b < subset->bodies; ++b)
        for (int side = 0; side < 2; ++side) {
            if (row->body[side] != subset->body[b])
                continue;
            quad G[3][4];
            euler_rate_matrix(solver->configuration->q[subset->body[b]] + 3, G);
            for (int i = 0; i < 3; ++i) {
                /* p' = G^T omega / 2 */
                out[6 * b + i] = (double)quad_dot(G[i], row->slope[side] + 3, 4) / (2 * length);
                out[6 * b + 3 + i] = (double)row->slope[side][i];
            }
        }
    for (int j = 0; j < n; ++j)
        size = hypot(size, out[j]);
    for (int j = 0; j < n && size > 0; ++j)
        out[j] /= size;
}

/* Squares of the singular values of a subset's Jacobian [6 bodies]; returns how many. To be freed. */
static int subset_squares(const Solver *solver, const Subset *subset, double **square)
{
    const Model *model = solver->model;
    int n = 6 * subset->bodies, rows = subset->coordinates, at = 0;
    for (int i = 0; i < subset->joints; ++i)
        rows += joint_rows[model->joint[subset->joint[i]].type];
    if (rows != n)
        fail("the subset of body '%s' has %d equations for %d unknowns", model->body[subset->body[0]].name, rows, n);
    double *a = grab((size_t)n * (size_t)n, sizeof *a), length = subset_length(model, subset);
    for (int i = 0; i < subset->joints; ++i) {
        int joint = subset->joint[i];
        for (int row = joint_row(model, joint); row < joint_row(model, joint + 1); ++row)
            twist_row(solver, subset, &solver->row[row], length, a + n * at++);
    }
    for (int i = 0; i < subset->coordinates; ++i)
        twist_row(solver, subset, &solver->row[joint_row(model, model->joints) + subset->coordinate[i]], length,
                  a + n * at++);
    *square = grab((size_t)n, sizeof **square);
    singular_squares(a, n, *square);
    free(a);
    return n;
}

double subset_condition(const Solver *solver, const Subset *subset)
{
    double *square, low = HUGE_VAL, high = 0;
    int n = subset_squares(solver, subset, &square);
    for (int j = 0; j < n; ++j) {
        low = fmin(low, square[j]);
        high = fmax(high, square[j]);
    }
    free(square);
    return low > 0 ? sqrt(high / low) : HUGE_VAL;
}

double subset_determinant(const Solver *solver, const Subset *subset)
{
    double *square, product = 1;
    int n = subset_squares(solver, subset, &square);
    for (int j = 0; j < n; ++j)
        product *= square[j];
    free(square);
    return sqrt(product);
}

void begin_way(Solver *solver)
{
    const Model *model = solver->model;
    for (int i = 0; i < model->subsets && !solver->design_known; ++i)
        if (!is_base(&model->subset[i]))
            solver->design_determinant[i] = subset_determinant(solver, &model->subset[i]);
    solver->design_known = true;
    solver->way_condition = worst_condition(solver);
    solver->way_determinant = 1;
}

double angles_told(const Solver *solver)
{
    const Model *model = solver->model;
    double least = 1;
    for (int c = 0; c < model->coordinates; ++c)
        if (model->coordinate[c].type == ANGLE)
            least = fmin(least, (double)-solver->row[joint_row(model, model->joints) + c].w_slope);
    return least;
}

void go_on(Solver *solver)
{
    const Model *model = solver->model;
    solver->way_condition = fmax(solver->way_condition, worst_condition(solver));
    solver->way_determinant = fmin(solver->way_determinant, angles_told(solver));
    for (int i = 0; i < model->subsets; ++i)
        if (!is_base(&model->subset[i]))
            solver->way_determinant = fmin(solver->way_determinant, subset_determinant(solver, &model->subset[i]) /
                                                                        solver->design_determinant[i]);
}

bool is_base(const Subset *subset)
{
    return subset->bodies == 1 && subset->body[0] == 0;
}

double worst_condition(const Solver *solver)
{
    double worst = 1;
    for (int i = 0; i < solver->model->subsets; ++i)
        if (!is_base(&solver->model->subset[i]))
            worst = fmax(worst, subset_condition(solver, &solver->model->subset[i]));
    /* where two points meet, nothing says in which direction a force between them acts */
    for (int i = 0; i < solver->model->forces; ++i) {
        const Force *force = &solver->model->force[i];
        quad length, rate;
        if (force->bushing && bushing_cosine(solver->configuration, force) < -0.99)
            worst = HUGE_VAL; /* nor near half a turn about which axis it was */
        if (force->load || force->about || force->bushing || force->coordinate >= 0)
            continue;
        element_extension(solver->model, solver->configuration, i, &length, &rate);
        worst = fmax(worst, length > 0 ? solver->model->length / (double)length : HUGE_VAL);
    }
    return worst;
}
