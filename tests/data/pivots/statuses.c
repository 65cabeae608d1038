/* SPDX-License-Identifier: MIT
 * Pairs of sledges with more and more above: accelerations are right, or there is a status that names the coordinate
 * and its subset; one instance, and with BATCH several in lanes. The pair's upper pivot is its diagonal entry over (A +
 * B) / A for masses A below and B above. Double precision. */
#include "sledges.h"
#ifdef BATCH
#include "sledges_batch.h"
#endif

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct {
    double left, right; /* (A + B) / A */
    int state;          /* that it fails at, -1: it does not */
} trial[] = {{1.5, 2.5, -1},
             {999e3, 7, -1},
             {7, 999e3, -1},
             {1001e3, 7, SLEDGES_STATE_SLIDE_L},
             {7, 1001e3, SLEDGES_STATE_SLIDE_R},
             {3, 1e9, SLEDGES_STATE_SLIDE_R},
             {1e12, 3, SLEDGES_STATE_SLIDE_L},
             {999e3, 1e15, SLEDGES_STATE_SLIDE_R}};
enum { TRIALS = sizeof trial / sizeof *trial };

static int failures;

static void check(int good, const char *what, int i)
{
    if (!good) {
        printf("FAIL trial %d: %s\n", i, what);
        ++failures;
    }
}

static int begin(sledges *self, int i)
{
    static const double below = 2;
    sledges_setup(self);
    self->parameter[SLEDGES_PARAMETER_LOWER_L] = self->parameter[SLEDGES_PARAMETER_LOWER_R] = below;
    self->parameter[SLEDGES_PARAMETER_UPPER_L] = below * (trial[i].left - 1);
    self->parameter[SLEDGES_PARAMETER_UPPER_R] = below * (trial[i].right - 1);
    return sledges_setup_with(self, self->parameter);
}

/* The status of a call, and what it says that it is about. */
static void check_status(const sledges *self, int status, int i)
{
    static const char *const name[] = {"run_l", "run_r", "slide_l", "slide_r"};
    static const char *const subset[] = {"lower_l", "lower_r", "upper_l", "upper_r"};
    const char *const state = sledges_status_state(self), *const about = sledges_status_subset(self);
    check(status == (trial[i].state < 0 ? GIC_OK : GIC_ERROR_MASS), "status", i);
    check(self->head.status == status, "status kept", i);
    if (trial[i].state < 0)
        check(!state, "a good state is about something", i);
    else
        check(state && !strcmp(state, name[trial[i].state]) && about && !strcmp(about, subset[trial[i].state]),
              "other names", i);
}

/* By Newton: at rest the ground's springs push with 7 N, those between with -3 N. */
static void check_rates(const double *rate, int i)
{
    const double below = 2, ratio[] = {trial[i].left, trial[i].right};
    for (int side = 0; side < 2; ++side) {
        const double run = 10 / below, slide = -3 / (below * (ratio[side] - 1)) - run;
        check(fabs(rate[SLEDGES_STATE_RUN_L_RATE + side] - run) <= 1e-8 * run, "acceleration below", i);
        check(fabs(rate[SLEDGES_STATE_SLIDE_L_RATE + side] - slide) <= 1e-8 * run, "acceleration above", i);
    }
}

int main(void)
{
    static sledges self;
    double rate[SLEDGES_STATES];
    for (int i = 0; i < TRIALS; ++i) {
        check(begin(&self, i) == GIC_OK, "set-up", i);
        int status = sledges_rhs(&self, 0, self.state, rate);
        check_status(&self, status, i);
        if (status == GIC_OK)
            check_rates(rate, i);
        status = sledges_step(&self, 0.001, GIC_RK4);
        check_status(&self, status, i);
    }
#ifdef BATCH
    static sledges_batch all;
    check(sledges_batch_setup(&all) == GIC_OK, "batch", -1);
    for (int i = 0; i < TRIALS; ++i) {
        begin(&self, i);
        sledges_batch_load(&all, i, &self);
    }
    check(sledges_batch_step(&all, 0.001, GIC_RK4, 1) == 3, "those that go on", -1);
    for (int i = 0; i < TRIALS; ++i) {
        sledges_batch_store(&all, i, &self);
        check_status(&self, sledges_batch_status(&all, i), i);
    }
#endif
    printf("%d failures\n", failures);
    return failures != 0;
}
