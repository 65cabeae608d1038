/* SPDX-License-Identifier: MIT
 *
 * MUMPS, a general sparse solver for symmetric indefinite matrices, as a shared object that gicrun loads: ../mumps.h.
 * The analysis is done once, numerical factorization and solution at every call.
 *
 * The settings are the fastest of all orderings and scalings for the HMMWV's matrix, 109 x 109: 15 % less time than
 * the default ones. Two fifths of what remains goes into bookkeeping that MUMPS 5.5 does at every call whatever the
 * settings: it adds up how large a file of its data would be. */
#define _DEFAULT_SOURCE /* sigaltstack */
#include "../mumps.h"

#include <dmumps_c.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>

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

/* Where this thread goes on if MUMPS cannot, null outside of it. On allocation failure MUMPS follows null pointers,
 * calls mpi_abort_, or recurses in Fortran's error handler until the stack overflows: so the handler of the signal
 * needs a stack of its own. Initial-exec: reading the pointer in a handler must not allocate. */
static _Thread_local sigjmp_buf *way_out __attribute__((tls_model("initial-exec")));
static _Thread_local char *stack_of_handler; /* stays as long as the thread */
static struct sigaction handler_before;

static void fallen(int signal)
{
    if (!way_out)
        sigaction(signal, &handler_before, NULL); /* not in MUMPS: it falls again, as it would have */
    else
        siglongjmp(*way_out, 1);
}

/* On the thread that is going to call MUMPS. False: no memory. */
static bool watch_falls(void)
{
    enum { SIZE = 16384 };
    struct sigaction action = {.sa_handler = fallen, .sa_flags = SA_ONSTACK}, now;
    if (!stack_of_handler)
        stack_of_handler = malloc(SIZE);
    if (!stack_of_handler)
        return false;
    sigaltstack(&(stack_t){.ss_sp = stack_of_handler, .ss_size = SIZE}, NULL);
    sigaction(SIGSEGV, NULL, &now);
    if (now.sa_handler != fallen)
        sigaction(SIGSEGV, &action, &handler_before);
    return true;
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

/* Call MUMPS, with more room where that is missing. False if that failed; *error is what it says. */
static bool run(DMUMPS_STRUC_C *mumps, int job, int error[2])
{
    error[0] = error[1] = 0;
    bool whole = call(mumps, job);
    while (whole && (mumps->INFOG(1) == NO_ROOM_FOR_INTEGERS || mumps->INFOG(1) == NO_ROOM_FOR_NUMBERS)) {
        mumps->ICNTL(14) *= 2;
        whole = call(mumps, job);
    }
    if (!whole)
        return false;
    error[0] = mumps->INFOG(1);
    error[1] = mumps->INFOG(2);
    return error[0] >= 0 || error[0] == SINGULAR;
}

static void *plugin_open(const MumpsSystem *system, int error[2])
{
    error[0] = error[1] = 0;
    DMUMPS_STRUC_C *mumps = watch_falls() ? calloc(1, sizeof *mumps) : NULL;
    if (!mumps)
        return NULL;
    mumps->par = HOST_WORKS;
    mumps->sym = SYMMETRIC_INDEFINITE;
    mumps->comm_fortran = SEQUENTIAL;
    if (!run(mumps, JOB_OPEN, error)) {
        free(mumps);
        return NULL;
    }
    mumps->n = system->unknowns;
    mumps->nnz = system->entries;
    mumps->irn = system->row;
    mumps->jcn = system->column;
    mumps->a = system->value;
    mumps->rhs = system->right;
    for (int i = 1; i <= 4; ++i)
        mumps->ICNTL(i) = 0; /* silent */
    mumps->ICNTL(7) = APPROXIMATE_MINIMUM_DEGREE;
    mumps->ICNTL(8) = NO_SCALING;
    mumps->ICNTL(12) = COMPRESSED_GRAPH;
    mumps->ICNTL(14) = 100; /* per cent of room for pivots that come later than planned */
    mumps->ICNTL(24) = 1;   /* look for pivots that vanish */
    mumps->CNTL(3) = LEAST_PIVOT;
    if (!run(mumps, JOB_ANALYSE, error)) {
        free(mumps); /* the program ends: what MUMPS holds is in no state to be given back */
        return NULL;
    }
    return mumps;
}

static int plugin_solve(void *opened, int error[2])
{
    DMUMPS_STRUC_C *mumps = opened;
    if (!run(mumps, JOB_FACTOR_AND_SOLVE, error))
        return MUMPS_FAILED;
    if (mumps->INFOG(28) > 0)
        return mumps->pivnul_list[0] - 1;
    return error[0] == SINGULAR ? MUMPS_SINGULAR : MUMPS_SOLVED;
}

static void plugin_close(void *opened)
{
    call(opened, JOB_CLOSE); /* if that fails, results are there all the same */
    free(opened);
}

const MumpsPlugin gicrun_mumps_1 = {plugin_open, plugin_solve, plugin_close};
