/* SPDX-License-Identifier: MIT
 * The choice looks at small motions about states of the run's first tenth of a second: at its first state, and at three
 * more on the way, which variable steps go. Explicit steps are shortened until all these motions are stable; implicit
 * ones are as long as the scene's. Work is counted in right-hand sides, so that the choice is the same on all machines.
 * imex, of order 2, is offered where the scene keeps Jacobians and no motion is lost with it that ros3 shows. */
#include "base/message.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/choose_step.h"
#include "run/engines.h"
#include "run/linearize.h"
#include "run/run.h"
#include "run/step_growth.h"
#include "run/variable_step.h"

#include <math.h>
#include <string.h>

enum {
    LOOKS = 4,
    STEPS = 5000, /* variable ones at most; where more are needed, the motion that asks for them is seen by then */
    METHODS = 4
};

static const double start = 0.1;     /* s that are looked at */
static const double reserve = 0.9;   /* of the longest stable step: motions change along the run */
static const double accuracy = 1e-6; /* of the way */

/* The methods and the work of a step in right-hand sides, without and for a new Jacobian; measured: models/STIFF.md. */
static const struct {
    int32_t method;
    double work, jacobian;
} offer[METHODS] = {{GIC_AB3, 1, 0}, {GIC_RK4, 4, 0}, {GIC_ROS3, 6, 7}, {GIC_IMEX, 1.6, 7}};

/* What limits an explicit method. */
typedef struct Limit {
    double step, time; /* s; INFINITY, 0: nothing does */
    Mode mode;
} Limit;

typedef struct Choice {
    Pool *pool;
    const Engine *engine;
    const Linear *linear;
    const Scene *ahead; /* the scene by variable steps, without what depends on conditions */
    gic_head *self, *copy;
    Limit limit[METHODS];
    bool offered[METHODS];
} Choice;

/* True if a step of imex resolves to mode_accuracy all motions that one of ros3 resolves so. */
static bool imex_shows(const Modes *modes, double step)
{
    for (int k = 0; k < modes->count; ++k) {
        const Mode *mode = &modes->mode[k];
        if (step_accurate(GIC_ROS3, mode->real, mode->imaginary, mode_accuracy) >= step &&
            step_accurate(GIC_IMEX, mode->real, mode->imaginary, mode_accuracy) < step)
            return false;
    }
    return true;
}

/* Take the motions about the present state into account. A state without derivatives is passed over. */
static void look(Choice *choice, int32_t ratio)
{
    Pool *pool = choice->pool;
    const gic_model *code = choice->engine->code;
    const size_t count = (size_t)choice->linear->count;
    double *f = pool_alloc(pool, sizeof *f * (count + 1)), *A = pool_alloc(pool, sizeof *A * (count * count + 1));
    memcpy(choice->copy, choice->self, code->size);
    const int status = code->outputs(choice->copy);
    choice->copy->input_function = NULL;
    if (status != GIC_OK || linearize(choice->linear, (Instance *)(void *)choice->copy, f, A) != GIC_OK)
        return;
    const Modes *modes = modes_try(pool, choice->linear, A);
    for (int i = 0; modes && i < METHODS; ++i) {
        if (offer[i].method == GIC_IMEX)
            choice->offered[i] = choice->offered[i] && imex_shows(modes, choice->ahead->step);
        const StepLimit found =
            modes_step(choice->linear, modes, offer[i].method, offer[i].method == GIC_AB3 ? ratio : 1);
        if (found.stable < choice->limit[i].step)
            choice->limit[i] = (Limit){found.stable, gic_time(choice->self), *found.limits};
    }
}

/* Look at the start of the run. Where it does not go on, the run itself will say so. */
static void go(Choice *choice, int32_t ratio)
{
    const Scene *scene = choice->ahead;
    int status = scene_start(choice->engine, scene, choice->self);
    if (status != GIC_OK)
        diag_fail((Place){scene->source, 0, 0},
                  "is the initial state one that the mechanism can reach from its design?", "the run can't start: %s",
                  instance_status(choice->pool, choice->engine->code, choice->self, status));
    Variable *variable = variable_open(choice->engine->code, scene->method, scene->tolerance);
    if (!variable)
        diag_fail(program_place(), NULL, "no memory for the integrator");
    const double end = fmin(start, scene->duration);
    int steps = 0;
    for (int i = 0; i < LOOKS && status == GIC_OK && steps < STEPS; ++i) {
        const double next = end * i / (LOOKS - 1);
        while (status == GIC_OK && gic_time(choice->self) < next && steps++ < STEPS)
            status = scene_step(choice->engine, choice->engine->code, scene, variable, choice->self, next);
        if (status == GIC_OK)
            look(choice, ratio);
    }
    variable_close(variable);
}

static double parts_of(const Limit *limit, double step)
{
    return fmax(1, ceil(step / (reserve * limit->step) * (1 - 1e-12)));
}

/* The name of what moves most. */
static const char *mover(const Linear *linear, const Mode *mode)
{
    int most = 0;
    for (int i = 0; i < linear->count - linear->places; ++i)
        most = mode->share[i] > mode->share[most] ? i : most;
    return linear->name[most < linear->places ? most : most + linear->places];
}

static void tell(const Choice *choice, const Scene *asked, const Scene *scene, const double work[METHODS],
                 bool implicit)
{
    Text text = {.pool = choice->pool}, *out = &text;
    text_print(out, "%s: integrator auto: %s, steps of %.6g s", asked->source->path, integrator_name(scene->method),
               scene->step);
    const Limit *limit = &choice->limit[0];
    if (limit->step < INFINITY) {
        text_print(out, "\n  ab3 is stable up to %.4g s, rk4 up to %.4g s: '%s', eigenvalue %.4g", limit->step,
                   choice->limit[1].step, mover(choice->linear, &limit->mode), limit->mode.real + 0.0);
        if (limit->mode.imaginary > 0)
            text_print(out, " +- %.4gi", limit->mode.imaginary);
        text_print(out, " 1/s at t = %.3g s", limit->time);
    }
    text_print(out, "\n  right-hand sides for %.6g s, about:", asked->step);
    for (int i = 0; i < METHODS; ++i)
        if (choice->offered[i])
            text_print(out, " %s %.4g", integrator_name(offer[i].method), work[i]);
    text_print(out, "%s\n", implicit ? "" : "; no implicit steps with this engine");
    diag_note(text.s);
}

const Scene *scene_choose_step(Pool *pool, const Model *model, const Scene *scene, Solve solve, bool implicit,
                               bool quiet)
{
    if (!scene->automatic)
        return scene;
    Scene *ahead = pool_alloc(pool, sizeof *ahead), *chosen = pool_alloc(pool, sizeof *chosen);
    *ahead = *scene;
    ahead->automatic = false;
    ahead->method = METHOD_RKCK;
    ahead->tolerance = accuracy;
    ahead->actions = NULL;
    ahead->rest = NULL;
    Choice choice = {.pool = pool, .ahead = ahead};
    choice.engine = engine_open(pool, "tape", model, &(EngineOptions){.solve = solve, .quiet = true});
    choice.linear = linear_open(pool, choice.engine);
    choice.self = instance_new(pool, choice.engine);
    choice.copy = instance_new(pool, choice.engine);
    for (int i = 0; i < METHODS; ++i) {
        choice.limit[i] = (Limit){.step = INFINITY};
        choice.offered[i] =
            offer[i].method <= GIC_RK4 || (implicit && (offer[i].method != GIC_IMEX || scene->keep > 1));
    }
    go(&choice, scene->ratio);
    double work[METHODS];
    int best = 0;
    for (int i = 0; i < METHODS; ++i) {
        work[i] = (offer[i].work + offer[i].jacobian / scene->keep) * parts_of(&choice.limit[i], scene->step);
        if (work[i] < work[best] && choice.offered[i])
            best = i;
    }
    const double parts = parts_of(&choice.limit[best], scene->step);
    *chosen = *scene;
    chosen->automatic = false;
    chosen->method = offer[best].method;
    chosen->step = scene->step / parts;
    chosen->per_output = scene->per_output * (int64_t)parts;
    if (chosen->method != GIC_AB3) {
        chosen->ratio = 1;
        chosen->steady = 0;
    }
    if (!quiet)
        tell(&choice, scene, chosen, work, implicit);
    return chosen;
}

const Scene *scene_with_choice(Pool *pool, const Scene *scene, const Scene *chosen)
{
    Scene *own = pool_alloc(pool, sizeof *own);
    *own = *scene;
    own->automatic = chosen->automatic;
    own->method = chosen->method;
    own->step = chosen->step;
    own->per_output = chosen->per_output;
    own->ratio = chosen->ratio;
    own->steady = chosen->steady;
    return own;
}
