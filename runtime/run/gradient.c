/* SPDX-License-Identifier: MIT
 * The gradient of a number of a run: its end value, an integral or a maximum. */
#include "run/gradient.h"
#include "base/message.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/limits.h"
#include "run/adjoint_run.h"
#include "run/number_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void begin(Gradient *gradient)
{
    gradient->value = 0;
    for (int k = 0; k < gradient->variables; ++k)
        gradient->derivative[k] = 0;
}

/* Add a part of the present formula. */
static void add(Gradient *gradient, double weight, double value, const double *slope)
{
    gradient->value += weight * value;
    for (int k = 0; k < gradient->variables; ++k)
        gradient->derivative[k] += weight * slope[k];
}

/* The trapezium of the last step, of `length` s, which a condition ends; up to now its start has half a whole step.
 * late: derivatives of the time of the end; NULL: it stays. */
static void end_integral(Gradient *gradient, double step, double length, double before, const double *slope_before,
                         double value, const double *slope, const double *late)
{
    add(gradient, (length - step) / 2, before, slope_before);
    add(gradient, length / 2, value, slope);
    for (int k = 0; late && k < gradient->variables; ++k)
        gradient->derivative[k] += (before + value) / 2 * late[k];
}

/* Forwards: as many derivatives in each step as there are variables. */
static int go_forwards(Gradient *gradient, TangentRun *run, ScalarKind kind, const Scene *scene, double *slope)
{
    double value = 0, before = 0, *slope_before = slope + gradient->variables;
    const int64_t steps = scene->outputs * scene->per_output;
    bool last = steps == 0;
    int status = tangent_begin(run, scene);
    for (int64_t i = 0; status == GIC_OK; ++i) {
        const bool first = i == 0;
        if (kind != SCALAR_END || last)
            status = tangent_look(run, &value, slope);
        if (kind == SCALAR_INTEGRAL) {
            add(gradient, (first || last ? 0.5 : 1) * scene->step, value, slope);
            gradient->time = tangent_time(run);
        } else if (kind == SCALAR_END ? last : first || value > gradient->value) {
            begin(gradient);
            add(gradient, 1, value, slope);
            gradient->time = tangent_time(run);
        }
        if (status != GIC_OK || last)
            break;
        const double start = tangent_time(run), *late;
        before = value;
        memcpy(slope_before, slope, (size_t)gradient->variables * sizeof *slope);
        status = tangent_step(run);
        const bool ended = tangent_ended(run, &late);
        last = i + 1 == steps || ended;
        if (kind == SCALAR_INTEGRAL && status == GIC_OK && ended) {
            status = tangent_look(run, &value, slope);
            end_integral(gradient, scene->step, tangent_time(run) - start, before, slope_before, value, slope, late);
            gradient->time = tangent_time(run);
            break;
        }
    }
    return status;
}

/* What the number of a run is of the formula at the ends of steps. */
typedef struct Sum {
    ScalarKind kind;
    double step, last;   /* last: length of the last step, s */
    int64_t steps, most; /* most: at whose end it is largest */
} Sum;

static double weight_of(const void *context, int64_t step)
{
    const Sum *sum = context;
    if (sum->kind == SCALAR_INTEGRAL) {
        const double after = step == sum->steps ? 0 : step == sum->steps - 1 ? sum->last : sum->step;
        const double before = step == 0 ? 0 : step == sum->steps ? sum->last : sum->step;
        return (before + after) / 2;
    }
    return step == (sum->kind == SCALAR_END ? sum->steps : sum->most);
}

/* Backwards: all derivatives at once. */
static int go_backwards(Gradient *gradient, TangentRun *run, ScalarKind kind, const Scene *scene)
{
    Sum sum = {kind, scene->step, scene->step, scene->outputs * scene->per_output, 0};
    double value = 0, most = 0, before = 0, by_end = 0;
    const double *late;
    int status = tangent_begin(run, scene);
    for (int64_t i = 0; i <= sum.steps && status == GIC_OK; ++i) {
        const double start = tangent_time(run);
        before = value;
        if (kind == SCALAR_MAXIMUM || (kind == SCALAR_INTEGRAL && scene->actions))
            status = tangent_look(run, &value, NULL);
        if (i == 0 || value > most) {
            most = value;
            sum.most = i;
        }
        if (kind != SCALAR_MAXIMUM || sum.most == i)
            gradient->time = tangent_time(run);
        if (status == GIC_OK && i < sum.steps)
            status = tangent_step(run);
        if (status == GIC_OK && i < sum.steps && tangent_ended(run, &late)) {
            sum.steps = i + 1;
            sum.last = tangent_time(run) - start;
        }
    }
    if (kind == SCALAR_INTEGRAL)
        by_end = (before + value) / 2;
    if (kind != SCALAR_MAXIMUM)
        gradient->time = tangent_time(run);
    return status == GIC_OK ? adjoint_find(run, weight_of, &sum, by_end, &gradient->value, gradient->derivative)
                            : status;
}

/* The names of words NAME and NAME=VALUE; value: NAN where there is none. */
static const char **read_words(Pool *pool, const char *const *word, int count, double *value)
{
    const char **name = pool_alloc(pool, ((size_t)count + 1) * sizeof *name);
    for (int i = 0; i < count; ++i) {
        const char *equals = strchr(word[i], '=');
        char *end = NULL;
        name[i] = equals ? pool_print(pool, "%.*s", (int)(equals - word[i]), word[i]) : word[i];
        value[i] = equals ? strtod(equals + 1, &end) : NAN;
        if (equals && (end == equals + 1 || *end || !isfinite(value[i])))
            diag_fail_call(program_place(), "write a number behind it: parameter/k=100",
                           "'%s' has no number behind the name", word[i]);
    }
    return name;
}

/* The scene with the values of words, and the variables with them. initial: with values at time 0, too. */
static const Scene *with_values(Pool *pool, const Model *model, const Scene *scene, Gradient *gradient,
                                const char *const *name, const double *value, int count, bool initial)
{
    Scene *copy = scene_with_numbers(pool, model, scene);
    RunVariable *variable = pool_alloc(pool, ((size_t)gradient->variables + 1) * sizeof *variable);
    memcpy(variable, gradient->variable, (size_t)gradient->variables * sizeof *variable);
    gradient->variable = variable;
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < gradient->variables && !isnan(value[i]); ++k)
            if (!strcmp(name[i], variable[k].name) && (initial || variable[k].kind != BY_INITIAL)) {
                number_places_check(model, copy, &variable[k], 1, "--gradient");
                *number_place(model, copy, &variable[k]) = variable[k].value = value[i];
            }
    BrokenLimit broken;
    if (limit_broken(model, copy->parameter, &broken))
        diag_fail_call(program_place(), "choose other values of the parameters",
                       "with these parameters the model is impossible: %s", broken.text);
    return copy;
}

const Gradient *gradient_find(Pool *pool, const Scalar *scalar, const Scene *scene, Solve solve,
                              const char *const *wanted, int count)
{
    const int few = 2; /* forwards they take less time */
    const Model *model = scalar->model;
    double *value = pool_alloc(pool, ((size_t)count + 1) * sizeof *value);
    const char **name = read_words(pool, wanted, count, value);
    const Scene *given = scene;
    scene = equilibrium_start(pool, model, given, solve);
    TangentRun *run = tangent_open_backwards(pool, model, scene, solve, name, count);
    Gradient *gradient = pool_alloc(pool, sizeof *gradient);
    *gradient = (Gradient){.variables = 0};
    gradient->variables = tangent_variables(run, &gradient->variable);
    const bool backwards = gradient->variables > few && adjoint_fits(model, scene);
    if (!backwards)
        run = tangent_open(pool, model, scene, solve, name, count);
    if (given->equilibrium) {
        given = with_values(pool, model, given, gradient, name, value, count, false);
        const Equilibrium *found = equilibrium_find(pool, model, given, solve);
        scene = scene_even(pool, model, equilibrium_scene(pool, given, found));
        tangent_rests(run, found);
    }
    scene = with_values(pool, model, scene, gradient, name, value, count, true);
    const size_t room = (size_t)(gradient->variables + 1) * sizeof(double);
    gradient->derivative = pool_alloc(pool, room);
    const int status = backwards ? go_backwards(gradient, run, scalar->kind, scene)
                                 : go_forwards(gradient, run, scalar->kind, scene, pool_alloc(pool, 2 * room));
    if (status != GIC_OK)
        tangent_fail(run, status);
    return gradient;
}
