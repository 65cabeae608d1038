/* SPDX-License-Identifier: MIT
 *
 * MUMPS, a general sparse solver for symmetric indefinite matrices, as a shared object that gicrun loads: ../mumps.h.
 * The analysis is done once, numerical factorization and solution at every call.
 *
 * The settings are the fastest of all orderings and scalings for the HMMWV's matrix, 109 x 109: 15 % less time than
 * the default ones. Two fifths of what remains goes into bookkeeping that MUMPS 5.5 does at every call whatever the
 * settings: it adds up how large a file of its data would be. */
#define _DEFAULT_SOURCE /* sigaltstack */
#include "compare/mumps.h"

#include <dmumps_c.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

enum { JOB_OPEN = -1, JOB_CLOSE = -2, JOB_ANALYSE = 1, JOB_FACTOR_AND_SOLVE = 5 };
enum { SYMMETRIC_INDEFINITE = 2, HOST_WORKS = 1, SEQUENTIAL = -987654 };
enum { APPROXIMATE_MINIMUM_DEGREE = 0, NO_SCALING = 0, COMPRESSED_GRAPH = 2 };
enum { NO_ROOM_FOR_INTEGERS = -8, NO_ROOM_FOR_NUMBERS = -9, SINGULAR = -10 };

/* A pivot below this part of the matrix's norm is lost. */
static const double LEAST_PIVOT = 1e-13;

/* Numbered from 1, as in the manual. */
#define ICNTL(i) icntl[-1 + (i)]
#define CNTL(i) cntl[-1 + (i)]
#define INFOG(i) infog[-1 + (i)]

/* On allocation failure MUMPS follows null pointers, calls mpi_abort_, or recurses in Fortran's error handler until the
 * stack overflows. It can do nothing then but end, and neither can the program whose engine it is part of: it ends with
 * a message, from a signal handler with a stack of its own. By exit(), for the program removes its unfinished files
 * then; what was interrupted may hold a lock that exit() waits for, so that an alarm ends the program after two
 * seconds. */
static volatile sig_atomic_t in_mumps, closing; /* closing: all results are there, the program's end comes early */

static void give_up(int number)
{
    static const char message[] = "gcp2: error: MUMPS gave up\n  remedy: is there memory enough?\n";
    static const char late[] = "gcp2: MUMPS gave up after the last result, for want of memory\n";
    if (!in_mumps) {
        signal(number, SIG_DFL); /* it falls again, and ends the program */
        return;
    }
    in_mumps = 0;
    (void)!(closing ? write(STDERR_FILENO, late, sizeof late - 1) : write(STDERR_FILENO, message, sizeof message - 1));
    sigset_t alarms;
    sigemptyset(&alarms);
    sigaddset(&alarms, SIGALRM);
    signal(SIGALRM, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &alarms, NULL);
    alarm(2);
    exit(closing ? 0 : 1);
}

static void watch_falls(void)
{
    static char stack_of_handler[16384];
    sigaltstack(&(stack_t){.ss_sp = stack_of_handler, .ss_size = sizeof stack_of_handler}, NULL);
    sigaction(SIGSEGV, &(struct sigaction){.sa_handler = give_up, .sa_flags = SA_ONSTACK}, NULL);
}

void mpi_abort_(const int *communicator, const int *code, int *error);

/* In place of that of the library for one process, which would end the program with status 0, as if all were well. */
void mpi_abort_(const int *communicator, const int *code, int *error)
{
    (void)communicator, (void)code, (void)error;
    give_up(SIGSEGV);
}

/* Call MUMPS, with more room where that is missing. False if that failed; error is what it says. */
static bool run(DMUMPS_STRUC_C *mumps, int job, int error[2])
{
    mumps->job = job;
    in_mumps = 1;
    for (dmumps_c(mumps); mumps->INFOG(1) == NO_ROOM_FOR_INTEGERS || mumps->INFOG(1) == NO_ROOM_FOR_NUMBERS;
         dmumps_c(mumps)) {
        mumps->ICNTL(14) *= 2;
        mumps->job = job;
    }
    in_mumps = 0;
    error[0] = mumps->INFOG(1);
    error[1] = mumps->INFOG(2);
    return error[0] >= 0 || error[0] == SINGULAR;
}

static void *plugin_open(const MumpsSystem *system, int error[2])
{
    error[0] = error[1] = 0;
    DMUMPS_STRUC_C *mumps = calloc(1, sizeof *mumps);
    if (!mumps)
        return NULL;
    watch_falls();
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
    int error[2];
    closing = 1;
    run(opened, JOB_CLOSE, error); /* if that fails, results are there all the same */
    closing = 0;
    free(opened);
}

const MumpsPlugin gicrun_mumps_1 = {plugin_open, plugin_solve, plugin_close};
