/* SPDX-License-Identifier: MIT
 *
 * The matrix of world/equations.h given to MUMPS as a whole: the general sparse symmetric indefinite solver of the
 * comparison. */
#include "base/message.h"
#include "compare/mumps.h"
#include "host/host.h"
#include "world/equations.h"

#include <string.h>

typedef struct Mumps {
    const Equations *equations;
    const MumpsPlugin *plugin;
    void *opened; /* of the plug-in */
    MumpsSystem system;
    int *unknown;   /* [bodies] first of a body's unknowns; the multipliers follow */
    int multiplier; /* first of those */
    int *start;     /* [constraints][2] where Y of a constraint and body begins in the matrix, -1: the body is fixed */
    double *gamma;  /* [rows] */
    Scaling *scaling;
} Mumps;

static _Noreturn void mumps_fail(const int error[2])
{
    if (error[0] == 0)
        diag_fail(program_place(), "is there memory enough?", "MUMPS gave up");
    diag_fail(program_place(), "is there memory enough?", "MUMPS failed with error %d, %d", error[0], error[1]);
}

/* The matrix's places, a body's diagonal first, then the blocks of Y row by row. All but those of Y keep their value.
 */
static void matrix_place(Mumps *solver)
{
    const Equations *equations = solver->equations;
    MumpsSystem *system = &solver->system;
    int count = 0;
    for (; count < solver->multiplier; ++count) {
        system->row[count] = system->column[count] = count + 1;
        system->value[count] = -1;
    }
    for (int i = 0; i < equations->constraints; ++i)
        for (int end = 0; end < 2; ++end) {
            int body = equations->constraint[i].body[end];
            bool moves = equations_moves(equations, body);
            solver->start[2 * i + end] = moves ? count : -1;
            for (int k = 0; moves && k < 6 * equations->constraint[i].rows; ++k, ++count) {
                system->row[count] = solver->multiplier + equations->first[i] + k / 6 + 1;
                system->column[count] = solver->unknown[body] + k % 6 + 1;
                system->value[count] = 1; /* any number: the analysis is about places */
            }
        }
    system->entries = count;
}

static void *solver_open(Pool *pool, const Equations *equations)
{
    Mumps *solver = pool_alloc(pool, sizeof *solver);
    MumpsSystem *system = &solver->system;
    const char *why;
    int error[2];
    solver->equations = equations;
    solver->plugin = mumps_load(pool, &why);
    if (!solver->plugin)
        diag_fail(program_place(),
                  "install it (Debian: apt-get install " MUMPS_PACKAGES
                  "), then `make` and, where gicgen is installed, "
                  "`make install` again; or take gcp1, the same method with another solver",
                  "the engine gcp2 needs MUMPS: %s", why);
    solver->unknown = pool_alloc(pool, (size_t)equations->bodies * sizeof(int));
    solver->start = pool_alloc(pool, 2 * (size_t)equations->constraints * sizeof(int));
    solver->gamma = pool_alloc(pool, (size_t)equations->rows * sizeof(double));
    solver->scaling = pool_alloc(pool, (size_t)equations->bodies * sizeof(Scaling));
    for (int i = 0; i < equations->bodies; ++i) {
        solver->unknown[i] = solver->multiplier;
        solver->multiplier += equations_moves(equations, i) ? 6 : 0;
    }
    system->unknowns = solver->multiplier + equations->rows;
    const size_t most = (size_t)(solver->multiplier + 12 * equations->rows);
    system->right = pool_alloc(pool, (size_t)system->unknowns * sizeof(double));
    system->row = pool_alloc(pool, most * sizeof(int));
    system->column = pool_alloc(pool, most * sizeof(int));
    system->value = pool_alloc(pool, most * sizeof(double));
    matrix_place(solver);
    solver->opened = solver->plugin->open(system, error);
    if (!solver->opened)
        mumps_fail(error);
    return solver;
}

/* The constraint that the unknown belongs to, or the first one on its body. */
static int constraint_of(const Mumps *solver, int unknown)
{
    const Equations *equations = solver->equations;
    for (int i = 0; i < equations->constraints; ++i) {
        if (unknown >= solver->multiplier + equations->first[i] &&
            unknown < solver->multiplier + equations->first[i + 1])
            return i;
        for (int end = 0; end < 2; ++end) {
            int body = equations->constraint[i].body[end];
            if (equations_moves(equations, body) && unknown >= solver->unknown[body] &&
                unknown < solver->unknown[body] + 6)
                return i;
        }
    }
    return 0;
}

static int solver_solve(void *opened, const Numbers *numbers)
{
    Mumps *solver = opened;
    const Equations *equations = solver->equations;
    double *right = solver->system.right;
    int error[2];
    for (int i = 0; i < equations->bodies; ++i)
        if (equations_moves(equations, i))
            equations_body(equations, i, numbers, &solver->scaling[i], right + solver->unknown[i]);
    memcpy(solver->gamma, numbers->gamma, (size_t)equations->rows * sizeof(double));
    for (int i = 0; i < equations->constraints; ++i) {
        const Constraint *constraint = &equations->constraint[i];
        for (int end = 0; end < 2; ++end)
            if (solver->start[2 * i + end] >= 0)
                equations_side(&solver->scaling[constraint->body[end]], constraint->rows,
                               numbers->jacobian + 14 * equations->first[i] + 7 * end * constraint->rows,
                               solver->system.value + solver->start[2 * i + end], 6, 1,
                               solver->gamma + equations->first[i]);
    }
    for (int i = 0; i < equations->rows; ++i)
        right[solver->multiplier + i] = -solver->gamma[i];

    const int result = solver->plugin->solve(solver->opened, error);
    if (result == MUMPS_FAILED)
        mumps_fail(error);
    if (result != MUMPS_SOLVED)
        return constraint_of(solver, result == MUMPS_SINGULAR ? solver->multiplier : result);
    memcpy(numbers->multiplier, right + solver->multiplier, (size_t)equations->rows * sizeof(double));
    for (int i = 0; i < equations->bodies; ++i)
        if (equations_moves(equations, i))
            equations_acceleration(&solver->scaling[i], right + solver->unknown[i], numbers->acceleration + 7 * i);
    if (!equations->free_base)
        memset(numbers->acceleration, 0, 7 * sizeof(double));
    return -1;
}

static void solver_close(void *opened)
{
    Mumps *solver = opened;
    solver->plugin->close(solver->opened);
}

const Solver mumps_solver = {"mumps", solver_open, solver_solve, solver_close};
