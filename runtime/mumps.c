/* SPDX-License-Identifier: MIT
 *
 * The matrix of equations.h given to MUMPS as a whole: the general sparse symmetric indefinite solver of the
 * comparison. The analysis is done once, numerical factorization and solution at every call.
 *
 * The settings are the fastest of all orderings and scalings for the HMMWV's matrix, 109 x 109: 15 % less time than
 * the default ones. Two fifths of what remains goes into bookkeeping that MUMPS 5.5 does at every call whatever the
 * settings: it adds up how large a file of its data would be. */
#define _DEFAULT_SOURCE /* sigaltstack */
#include "equations.h"
#include "gicrun.h"

#include <dmumps_c.h>
#include <setjmp.h>
#include <signal.h>
#include <string.h>

enum { JOB_OPEN = -1, JOB_CLOSE = -2, JOB_ANALYSE = 1, JOB_FACTOR_AND_SOLVE = 5 };
enum { SYMMETRIC_INDEFINITE = 2, HOST_WORKS = 1, SEQUENTIAL = -987654 };
enum { APPROXIMATE_MINIMUM_DEGREE = 0, NO_SCALING = 0, COMPRESSED_GRAPH = 2 };
enum { NO_ROOM_FOR_INTEGERS = -8, NO_ROOM_FOR_NUMBERS = -9, SINGULAR = -10 };

/* A pivot below this part of the matrix's norm is lost. */
static const double LEAST_PIVOT = 1e-13;

/* Numbered from 1, as in the manual. */
#define ICNTL(i) icntl[(i)-1]
#define CNTL(i) cntl[(i)-1]
#define INFOG(i) infog[(i)-1]

typedef struct Mumps {
    const Equations *equations;
    DMUMPS_STRUC_C mumps;
    int *unknown;   /* [bodies] first of a body's unknowns; the multipliers follow */
    int multiplier; /* first of those */
    int *start;     /* [constraints][2] where Y of a constraint and body begins in the matrix, -1: the body is fixed */
    double *right;  /* right-hand side, and then the solution */
    double *gamma;  /* [rows] */
    Scaling *scaling;
} Mumps;

/* Where this thread goes on if MUMPS cannot, null outside of it. MUMPS does not look whether it got all of its memory:
 * it falls on what it did not get, it calls the function of MPI below, or Fortran's way of saying so calls itself until
 * the stack ends. So the handler, which has no other way to know, stands on a stack of its own. */
static _Thread_local sigjmp_buf *way_out;
static _Thread_local char stack_of_handler[16384];
static struct sigaction handler_before;

static void fallen(int signal)
{
    if (!way_out)
        sigaction(signal, &handler_before, NULL); /* not in MUMPS: it falls again, as it would have */
    else
        siglongjmp(*way_out, 1);
}

/* On the thread that is going to call MUMPS. */
static void watch_falls(void)
{
    const stack_t stack = {.ss_sp = stack_of_handler, .ss_size = sizeof stack_of_handler};
    struct sigaction action = {.sa_handler = fallen, .sa_flags = SA_ONSTACK}, now;
    sigaltstack(&stack, NULL);
    sigaction(SIGSEGV, NULL, &now);
    if (now.sa_handler != fallen)
        sigaction(SIGSEGV, &action, &handler_before);
}

void mpi_abort_(const int *communicator, const int *code, int *error);

/* In place of that of the library for one process, which would end the program with status 0, as if all were well. */
void mpi_abort_(const int *communicator, const int *code, int *error)
{
    (void)communicator, (void)code, (void)error;
    siglongjmp(*way_out, 1);
}

/* Call MUMPS. False if it could not go on: nothing can be asked of it any more. */
static bool call(DMUMPS_STRUC_C *mumps, int job)
{
    sigjmp_buf here;
    mumps->job = job;
    if (sigsetjmp(here, 1)) {
        way_out = NULL;
        return false;
    }
    way_out = &here;
    dmumps_c(mumps);
    way_out = NULL;
    return true;
}

/* Call MUMPS, with more room where that is missing. */
static void run(DMUMPS_STRUC_C *mumps, int job)
{
    bool whole = call(mumps, job);
    while (whole && (mumps->INFOG(1) == NO_ROOM_FOR_INTEGERS || mumps->INFOG(1) == NO_ROOM_FOR_NUMBERS)) {
        mumps->ICNTL(14) *= 2;
        whole = call(mumps, job);
    }
    if (!whole)
        diag_fail(program_place(), "is there memory enough?", "MUMPS gave up");
    if (mumps->INFOG(1) < 0 && mumps->INFOG(1) != SINGULAR)
        diag_fail(program_place(), "is there memory enough?", "MUMPS failed with error %d, %d", mumps->INFOG(1),
                  mumps->INFOG(2));
}

/* The matrix's places, a body's diagonal first, then the blocks of Y row by row. All but those of Y keep their value.
 */
static void matrix_place(Mumps *solver)
{
    const Equations *equations = solver->equations;
    DMUMPS_STRUC_C *mumps = &solver->mumps;
    int count = 0;
    for (; count < solver->multiplier; ++count) {
        mumps->irn[count] = mumps->jcn[count] = count + 1;
        mumps->a[count] = -1;
    }
    for (int i = 0; i < equations->constraints; ++i)
        for (int end = 0; end < 2; ++end) {
            int body = equations->constraint[i].body[end];
            bool moves = equations_moves(equations, body);
            solver->start[2 * i + end] = moves ? count : -1;
            for (int k = 0; moves && k < 6 * equations->constraint[i].rows; ++k, ++count) {
                mumps->irn[count] = solver->multiplier + equations->first[i] + k / 6 + 1;
                mumps->jcn[count] = solver->unknown[body] + k % 6 + 1;
                mumps->a[count] = 1; /* any number: the analysis is about places */
            }
        }
    mumps->nnz = count;
}

static void *solver_open(Pool *pool, const Equations *equations)
{
    Mumps *solver = pool_alloc(pool, sizeof *solver);
    DMUMPS_STRUC_C *mumps = &solver->mumps;
    solver->equations = equations;
    solver->unknown = pool_alloc(pool, (size_t)equations->bodies * sizeof(int));
    solver->start = pool_alloc(pool, 2 * (size_t)equations->constraints * sizeof(int));
    solver->gamma = pool_alloc(pool, (size_t)equations->rows * sizeof(double));
    solver->scaling = pool_alloc(pool, (size_t)equations->bodies * sizeof(Scaling));
    for (int i = 0; i < equations->bodies; ++i) {
        solver->unknown[i] = solver->multiplier;
        solver->multiplier += equations_moves(equations, i) ? 6 : 0;
    }
    const int unknowns = solver->multiplier + equations->rows;
    const size_t most = (size_t)(solver->multiplier + 12 * equations->rows);
    solver->right = pool_alloc(pool, (size_t)unknowns * sizeof(double));

    mumps->par = HOST_WORKS;
    mumps->sym = SYMMETRIC_INDEFINITE;
    mumps->comm_fortran = SEQUENTIAL;
    watch_falls();
    run(mumps, JOB_OPEN);
    mumps->n = unknowns;
    mumps->irn = pool_alloc(pool, most * sizeof(MUMPS_INT));
    mumps->jcn = pool_alloc(pool, most * sizeof(MUMPS_INT));
    mumps->a = pool_alloc(pool, most * sizeof(double));
    mumps->rhs = solver->right;
    matrix_place(solver);
    for (int i = 1; i <= 4; ++i)
        mumps->ICNTL(i) = 0; /* silent */
    mumps->ICNTL(7) = APPROXIMATE_MINIMUM_DEGREE;
    mumps->ICNTL(8) = NO_SCALING;
    mumps->ICNTL(12) = COMPRESSED_GRAPH;
    mumps->ICNTL(14) = 100; /* per cent of room for pivots that come later than planned */
    mumps->ICNTL(24) = 1;   /* look for pivots that vanish */
    mumps->CNTL(3) = LEAST_PIVOT;
    run(mumps, JOB_ANALYSE);
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
    DMUMPS_STRUC_C *mumps = &solver->mumps;
    double *right = solver->right;
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
                               mumps->a + solver->start[2 * i + end], 6, 1, solver->gamma + equations->first[i]);
    }
    for (int i = 0; i < equations->rows; ++i)
        right[solver->multiplier + i] = -solver->gamma[i];

    run(mumps, JOB_FACTOR_AND_SOLVE);
    if (mumps->INFOG(1) == SINGULAR || mumps->INFOG(28) > 0)
        return constraint_of(solver, mumps->INFOG(28) > 0 ? mumps->pivnul_list[0] - 1 : solver->multiplier);
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
    call(&solver->mumps, JOB_CLOSE); /* if that fails, results are there all the same */
}

const Solver mumps_solver = {"mumps", solver_open, solver_solve, solver_close};
