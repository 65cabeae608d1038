/* SPDX-License-Identifier: MIT
 * cvodes DURATION TOLERANCE OUTPUT [STATE=VALUE ...]: the gradient of an output at the end of a run from the design, by
 * initial states and parameters, by the adjoint of SUNDIALS' CVODES over code of `gicgen --derivatives`: a continuous
 * adjoint, with steps of its own, which knows nothing of gicrun's. Compiled with -DNAME=... and -DHEADER=... of a
 * model; rows NAME,DERIVATIVE, the first the output itself. */
#include HEADER

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_version.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#define JOIN(a, b) a##b
#define OF(name, end) JOIN(name, end)
enum { MOST = 400 };

typedef struct Run {
    NAME car;
    OF(NAME, _direction) work;
    double jacobian[MOST * MOST];
    int states, parameters, columns;
} Run;

static void expect(int good, const char *what)
{
    if (!good) {
        fprintf(stderr, "cvodes: %s\n", what);
        exit(1);
    }
}

static int rate(double time, N_Vector y, N_Vector f, void *context)
{
    Run *run = context;
    return OF(NAME, _rhs)(&run->car, time, N_VGetArrayPointer(y), N_VGetArrayPointer(f));
}

static int jacobian_at(Run *run, double time, N_Vector y)
{
    return OF(NAME, _jacobian)(&run->car, time, N_VGetArrayPointer(y), &run->work, run->jacobian);
}

/* l' = -J^T l */
static int adjoint_rate(double time, N_Vector y, N_Vector l, N_Vector f, void *context)
{
    Run *run = context;
    const double *by = N_VGetArrayPointer(l);
    double *out = N_VGetArrayPointer(f);
    const int status = jacobian_at(run, time, y);
    for (int k = 0; k < run->states; ++k) {
        out[k] = 0;
        for (int i = 0; i < run->states; ++i)
            out[k] -= run->jacobian[i * run->columns + k] * by[i];
    }
    return status;
}

/* q' = -(df/dp)^T l */
static int parameter_rate(double time, N_Vector y, N_Vector l, N_Vector f, void *context)
{
    Run *run = context;
    const double *by = N_VGetArrayPointer(l);
    double *out = N_VGetArrayPointer(f);
    const int status = jacobian_at(run, time, y), first = run->columns - run->parameters;
    for (int k = 0; k < run->parameters; ++k) {
        out[k] = 0;
        for (int i = 0; i < run->states; ++i)
            out[k] -= run->jacobian[i * run->columns + first + k] * by[i];
    }
    return status;
}

static N_Vector vector(int count, SUNContext context)
{
    N_Vector v = N_VNew_Serial(count > 0 ? count : 1, context);
    N_VConst(0, v);
    return v;
}

int main(int count, char **word)
{
    static Run run;
    const gic_model *model = &OF(NAME, _model);
    expect(count > 3, "cvodes DURATION TOLERANCE OUTPUT [STATE=VALUE ...]");
    const double duration = atof(word[1]), tolerance = atof(word[2]);
    run.states = model->slow_count + model->fast_count;
    run.parameters = model->parameter_count;
    run.columns = run.states + model->input_count + run.parameters;
    expect(run.columns <= MOST && OF(NAME, _setup)(&run.car) == GIC_OK, "set-up");
    SUNContext context;
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(NULL, &context);
#endif
    N_Vector y = vector(run.states, context);
    double *state = N_VGetArrayPointer(y), reached;
    memcpy(state, run.car.state, (size_t)run.states * sizeof *state);
    for (int i = 4; i < count; ++i) {
        const char *equals = strchr(word[i], '=');
        int found = 0;
        for (int k = 0; k < run.states && equals; ++k)
            if (!strncmp(model->state[k].name, word[i], (size_t)(equals - word[i])) &&
                !model->state[k].name[equals - word[i]]) {
                state[k] = atof(equals + 1);
                found = 1;
            }
        expect(found, word[i]);
    }
    int output = -1, checks, backward;
    for (int k = 0; k < model->output_count; ++k)
        output = strcmp(model->output[k].name, word[3]) ? output : k;
    expect(output >= 0, word[3]);

    void *solver = CVodeCreate(CV_ADAMS, context);
    SUNNonlinearSolver fixed = SUNNonlinSol_FixedPoint(y, 0, context);
    expect(!CVodeInit(solver, rate, 0, y) && !CVodeSStolerances(solver, tolerance, tolerance) &&
               !CVodeSetUserData(solver, &run) && !CVodeSetNonlinearSolver(solver, fixed) &&
               !CVodeSetMaxNumSteps(solver, 1000000) && !CVodeAdjInit(solver, 200, CV_POLYNOMIAL),
           "forwards");
    expect(CVodeF(solver, duration, y, &reached, CV_NORMAL, &checks) >= 0, "the run");

    /* by state and parameters at the end */
    memcpy(run.car.state, state, (size_t)run.states * sizeof *state);
    expect(jacobian_at(&run, duration, y) == GIC_OK, "the end");
    expect(OF(NAME, _jacobian_outputs)(&run.car, &run.work, run.jacobian) == GIC_OK, "outputs");
    N_Vector l = vector(run.states, context), q = vector(run.parameters, context);
    const double *last = run.jacobian + (run.states + output) * run.columns;
    memcpy(N_VGetArrayPointer(l), last, (size_t)run.states * sizeof *last);
    memcpy(N_VGetArrayPointer(q), last + run.columns - run.parameters, (size_t)run.parameters * sizeof *last);
    printf("%s,%.17g\n", word[3], run.car.output[output]);

    SUNNonlinearSolver fixed_back = SUNNonlinSol_FixedPoint(l, 0, context);
    expect(!CVodeCreateB(solver, CV_ADAMS, &backward) && !CVodeInitB(solver, backward, adjoint_rate, duration, l) &&
               !CVodeSStolerancesB(solver, backward, tolerance, tolerance) &&
               !CVodeSetUserDataB(solver, backward, &run) && !CVodeSetNonlinearSolverB(solver, backward, fixed_back) &&
               !CVodeSetMaxNumStepsB(solver, backward, 1000000) &&
               !CVodeQuadInitB(solver, backward, parameter_rate, q) &&
               !CVodeQuadSStolerancesB(solver, backward, tolerance, tolerance) &&
               !CVodeSetQuadErrConB(solver, backward, 1),
           "backwards");
    expect(CVodeB(solver, 0, CV_NORMAL) >= 0 && CVodeGetB(solver, backward, &reached, l) >= 0 &&
               CVodeGetQuadB(solver, backward, &reached, q) >= 0,
           "the way back");
    for (int k = 0; k < run.states; ++k)
        printf("%s,%.17g\n", model->state[k].name, N_VGetArrayPointer(l)[k]);
    for (int k = 0; k < run.parameters; ++k)
        printf("parameter/%s,%.17g\n", model->parameter[k].name, N_VGetArrayPointer(q)[k]);
    return 0;
}
