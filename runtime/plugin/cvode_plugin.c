/* SPDX-License-Identifier: MIT
 *
 * CVODE of SUNDIALS 6 and 7 as a shared object that programs load: host/bdf.h. Newton's iteration with the Jacobian
 * that the program has, factorized as a dense matrix. */
#include "host/bdf.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

enum { MOST_TRIES = 60 /* of a step, each shorter; by halves down to rounding */ };

typedef struct Bdf {
    const BdfSystem *system;
    SUNContext context;
    N_Vector state;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    void *cvode;
    int begun; /* CVodeInit has been called */
} Bdf;

static int rate(double time, N_Vector state, N_Vector result, void *context)
{
    const BdfSystem *system = ((const Bdf *)context)->system;
    return system->rate(system->user, time, N_VGetArrayPointer(state), N_VGetArrayPointer(result)) ? 1 : 0;
}

static int jacobian(double time, N_Vector state, N_Vector at, SUNMatrix matrix, void *context, N_Vector work1,
                    N_Vector work2, N_Vector work3)
{
    const BdfSystem *system = ((const Bdf *)context)->system;
    (void)work1, (void)work2, (void)work3;
    return system->jacobian(system->user, time, N_VGetArrayPointer(state), N_VGetArrayPointer(at), SM_DATA_D(matrix))
               ? 1
               : 0;
}

/* CVODE bounds the mean of squares of error times weight by 1; where this holds, no number's error is above its own
 * bound. */
static int weights(N_Vector state, N_Vector weight, void *context)
{
    const BdfSystem *system = ((const Bdf *)context)->system;
    const double *y = N_VGetArrayPointer(state), root = sqrt((double)system->count);
    double *w = N_VGetArrayPointer(weight);
    for (size_t i = 0; i < system->count; ++i)
        w[i] = root / (system->tolerance * (1 + fabs(y[i])));
    return 0;
}

static void close_bdf(void *opened)
{
    Bdf *bdf = opened;
    if (bdf->cvode)
        CVodeFree(&bdf->cvode);
    if (bdf->solver)
        SUNLinSolFree(bdf->solver);
    if (bdf->matrix)
        SUNMatDestroy(bdf->matrix);
    if (bdf->state)
        N_VDestroy(bdf->state);
    if (bdf->context)
        SUNContext_Free(&bdf->context);
    free(bdf);
}

/* What went wrong is told by the program. */
static int be_silent(Bdf *bdf)
{
#if SUNDIALS_VERSION_MAJOR >= 7
    return SUNContext_ClearErrHandlers(bdf->context);
#else
    return CVodeSetErrFile(bdf->cvode, NULL);
#endif
}

static void *open_bdf(const BdfSystem *system)
{
    const sunindextype n = (sunindextype)system->count;
    Bdf *bdf = calloc(1, sizeof *bdf);
    if (!bdf)
        return NULL;
    bdf->system = system;
#if SUNDIALS_VERSION_MAJOR >= 7
    const int failed = SUNContext_Create(SUN_COMM_NULL, &bdf->context);
#else
    const int failed = SUNContext_Create(NULL, &bdf->context);
#endif
    if (!failed) {
        bdf->state = N_VNew_Serial(n, bdf->context);
        bdf->matrix = SUNDenseMatrix(n, n, bdf->context);
        bdf->cvode = CVodeCreate(CV_BDF, bdf->context);
    }
    if (bdf->state && bdf->matrix)
        bdf->solver = SUNLinSol_Dense(bdf->state, bdf->matrix, bdf->context);
    if (bdf->cvode && bdf->solver && !be_silent(bdf))
        return bdf;
    close_bdf(bdf);
    return NULL;
}

/* What is set once. */
static int prepare(Bdf *bdf, double time)
{
    return CVodeInit(bdf->cvode, rate, time, bdf->state) || CVodeSetUserData(bdf->cvode, bdf) ||
           CVodeWFtolerances(bdf->cvode, weights) || CVodeSetLinearSolver(bdf->cvode, bdf->solver, bdf->matrix) ||
           CVodeSetJacFn(bdf->cvode, jacobian) || CVodeSetMaxErrTestFails(bdf->cvode, MOST_TRIES) ||
           CVodeSetMaxConvFails(bdf->cvode, MOST_TRIES) || CVodeSetMaxHnilWarns(bdf->cvode, -1);
}

static int start(void *opened, double time, const double *state, double first)
{
    Bdf *bdf = opened;
    memcpy(N_VGetArrayPointer(bdf->state), state, bdf->system->count * sizeof *state);
    const int failed = bdf->begun ? CVodeReInit(bdf->cvode, time, bdf->state) : prepare(bdf, time);
    bdf->begun = 1;
    return failed || CVodeSetInitStep(bdf->cvode, first) ? -1 : 0;
}

static int step(void *opened, double *time, double end, double *state, double *next)
{
    Bdf *bdf = opened;
    double reached = *time;
    if (CVodeSetStopTime(bdf->cvode, end))
        return -1;
    const int result = CVode(bdf->cvode, end, bdf->state, &reached, CV_ONE_STEP);
    if (result < 0 || !(reached > *time) || CVodeGetCurrentStep(bdf->cvode, next)) /* it may go on by nothing */
        return -1;
    *time = result == CV_TSTOP_RETURN || reached > end ? end : reached;
    memcpy(state, N_VGetArrayPointer(bdf->state), bdf->system->count * sizeof *state);
    return 0;
}

const BdfPlugin gicrun_bdf_1 = {open_bdf, start, step, close_bdf};
