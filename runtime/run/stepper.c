/* SPDX-License-Identifier: MIT */
#include "base/message.h"
#include "gic_runtime.h"
#include "host/bdf.h"
#include "host/gsl_errors.h"
#include "host/host.h"
#include "run/stepper.h"
#include "scene/scene.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <stdlib.h>

struct Stepper {
    const StepperSystem *system;
    gsl_odeiv2_system of_gsl;
    gsl_odeiv2_driver *driver; /* NULL: CVODE */
    const BdfPlugin *plugin;
    BdfSystem of_plugin;
    void *bdf;
    bool fresh;       /* no history */
    double time[2];   /* s, at the begin and the end of the last step of CVODE, with states */
    double *state[2]; /* in one allocation, with `rate` */
    double *rate[2];  /* of these, where `known` */
    bool known[2];
};

static const BdfPlugin *plugin(void)
{
    const char *why;
    Pool *pool = pool_new();
    const BdfPlugin *found = plugin_load(pool, "bdf.so", BDF_SYMBOL, &why);
    if (!found)
        diag_fail(program_place(),
                  "install it (Debian: apt-get install " BDF_PACKAGES "), then `make` and, where gicgen is installed, "
                  "`make install` again; or take adams or rkck",
                  "the integrator bdf needs SUNDIALS: %s", why);
    pool_free(pool);
    return found;
}

bool stepper_there(int32_t method)
{
    const char *why;
    Pool *pool = pool_new();
    const bool there = method != METHOD_BDF || plugin_load(pool, "bdf.so", BDF_SYMBOL, &why);
    pool_free(pool);
    return there;
}

void stepper_need(int32_t method)
{
    if (method == METHOD_BDF)
        (void)plugin();
}

static int rate_for_gsl(double time, const double *state, double *rate, void *user)
{
    const StepperSystem *system = user;
    return system->rate(system->user, time, state, rate) ? GSL_FAILURE : GSL_SUCCESS;
}

static bool open_gsl(Stepper *s, int32_t method, double tolerance, double first)
{
    gsl_errors_return();
    s->of_gsl = (gsl_odeiv2_system){rate_for_gsl, NULL, s->system->count, (void *)s->system};
    s->driver = gsl_odeiv2_driver_alloc_standard_new(
        &s->of_gsl, method == METHOD_ADAMS ? gsl_odeiv2_step_msadams : gsl_odeiv2_step_rkck, first, tolerance,
        tolerance, 1, 0);
    return s->driver;
}

static bool open_bdf(Stepper *s, double tolerance)
{
    const size_t n = s->system->count;
    double *numbers = calloc(4 * n, sizeof *numbers);
    s->state[0] = numbers;
    if (!numbers)
        return false;
    s->state[1] = numbers + n;
    s->rate[0] = numbers + 2 * n;
    s->rate[1] = numbers + 3 * n;
    s->of_plugin = (BdfSystem){n, tolerance, s->system->rate, s->system->jacobian, s->system->user};
    s->bdf = s->plugin->open(&s->of_plugin);
    return s->bdf;
}

Stepper *stepper_open(int32_t method, const StepperSystem *system, double tolerance, double first)
{
    const BdfPlugin *bdf = method == METHOD_BDF ? plugin() : NULL;
    Stepper *stepper = calloc(1, sizeof *stepper);
    if (!stepper)
        return NULL;
    stepper->system = system;
    stepper->plugin = bdf;
    stepper->fresh = true;
    if (bdf ? open_bdf(stepper, tolerance) : open_gsl(stepper, method, tolerance, first))
        return stepper;
    stepper_close(stepper);
    return NULL;
}

void stepper_close(Stepper *stepper)
{
    if (!stepper)
        return;
    if (stepper->driver)
        gsl_odeiv2_driver_free(stepper->driver);
    if (stepper->bdf)
        stepper->plugin->close(stepper->bdf);
    free(stepper->state[0]);
    free(stepper);
}

void stepper_restart(Stepper *stepper)
{
    stepper->fresh = true;
    if (!stepper->driver)
        return;
    gsl_odeiv2_step_reset(stepper->driver->s);
    gsl_odeiv2_evolve_reset(stepper->driver->e); /* which keeps the rate at the end of the last step */
}

static void copy(const Stepper *s, double *to, const double *from)
{
    for (size_t i = 0; i < s->system->count; ++i)
        to[i] = from[i];
}

/* The last end becomes the begin. */
static void move_on(Stepper *s, double time, const double *state)
{
    s->known[0] = s->known[1] && !s->fresh;
    if (s->known[0])
        copy(s, s->rate[0], s->rate[1]);
    s->known[1] = false;
    s->time[0] = time;
    copy(s, s->state[0], state);
}

static int step_bdf(Stepper *s, double *time, double end, double *step, double *state)
{
    move_on(s, *time, state);
    if (s->fresh && s->plugin->start(s->bdf, *time, state, *step))
        return -1;
    s->fresh = false;
    if (s->plugin->step(s->bdf, time, end, state, step))
        return -1;
    s->time[1] = *time;
    copy(s, s->state[1], state);
    return 0;
}

int stepper_step(Stepper *stepper, double *time, double end, double *step, double *state)
{
    gsl_odeiv2_driver *driver = stepper->driver;
    if (!driver)
        return step_bdf(stepper, time, end, step, state);
    const int result =
        gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, &stepper->of_gsl, time, end, step, state);
    return result == GSL_SUCCESS ? 0 : -1;
}

/* CVODE does not tell rates: they are evaluated where someone asks. */
static const double *rate_at(Stepper *s, int end)
{
    if (!s->known[end])
        s->known[end] = !s->system->rate(s->system->user, s->time[end], s->state[end], s->rate[end]);
    return s->known[end] ? s->rate[end] : NULL;
}

const double *stepper_rate(Stepper *stepper)
{
    return stepper->driver ? stepper->driver->e->dydt_in : rate_at(stepper, 0);
}

const double *stepper_rate_there(Stepper *stepper)
{
    return stepper->driver ? stepper->driver->e->dydt_out : rate_at(stepper, 1);
}
