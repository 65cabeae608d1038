/* SPDX-License-Identifier: MIT
 * What gicrun finds out about a model, as results: runs, static equilibrium, modes, linear models. The code is that of
 * gicrun, from the scene to the numbers. */
#include "base/message.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/gic.h"
#include "library/library_private.h"
#include "library/result_private.h"
#include "model/model.h"
#include "run/choose_step.h"
#include "run/engines.h"
#include "run/gradient.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <dlfcn.h>
#include <math.h>
#include <string.h>

/* A call in work. What it makes is in the result's pool, so that rows of a run that ends early stay. */
typedef struct Work {
    OpenModel *open;
    const char *path; /* of the scene; NULL: none */
    double at;
    const char *formula; /* of a gradient, and its words */
    const char *const *word;
    int words;
    Result *result;
    const Engine *engine; /* that is to be closed; NULL: none */
    RunColumns columns;
} Work;

static void make_result(void *context)
{
    Work *work = context;
    Pool *pool = pool_new();
    work->result = pool_alloc(pool, sizeof *work->result);
    work->result->pool = pool;
    work->columns.pool = pool;
}

/* failed: the engine's own memory was released as all that the work had. */
static void close_engine(Work *work, bool failed)
{
    if (!work->engine)
        return;
    if (!failed)
        engine_close(work->engine);
    if (work->engine->library)
        dlclose(work->engine->library);
    work->engine = NULL;
}

/* The model and the scene (NULL: none) as the run has them. */
static const Model *read_scene(const Work *work, const Scene **scene)
{
    Pool *pool = work->result->pool;
    const OpenModel *open = work->open;
    const Model *model = model_for(open, pool);
    *scene = work->path ? scene_read(pool, pool_print(pool, "%s", work->path), model, open->integrator, open->tolerance)
                        : NULL;
    return scene_rig(pool, model, scene);
}

/* ---- the four kinds of work ----------------------------------------------------------------------------------- */

static void run_scene(void *context)
{
    Work *work = context;
    const OpenModel *open = work->open;
    Pool *pool = work->result->pool;
    const Scene *scene;
    const Model *model = read_scene(work, &scene);
    scene = equilibrium_start(pool, model, scene, open->options.solve);
    scene = scene_choose_step(pool, model, scene, open->options.solve, engine_has_implicit(open->engine_name), true);
    work->engine = engine_open_run(pool, open->engine_name, model, scene, open->general ? NULL : work->path, false,
                                   &open->options);
    const Request request = {.scene = work->path, .quiet = true, .columns = &work->columns};
    simulate(pool, work->engine, model, scene, NULL, &request);
}

/* An array of an instance of the engine tape as one row. */
static void add_row(Result *result, const char *name, Instance *self, size_t offset, int count,
                    const gic_signal *signal)
{
    double *row = pool_alloc(result->pool, sizeof *row * (size_t)(count + 1));
    memcpy(row, tape_array(self, offset), sizeof *row * (size_t)count);
    result_add(result, name, 1, count, row, NULL, signal);
}

static void find_equilibrium(void *context)
{
    Work *work = context;
    Pool *pool = work->result->pool;
    const Scene *scene;
    const Model *model = read_scene(work, &scene);
    const Equilibrium *found = equilibrium_find(pool, model, scene, work->open->options.solve);
    work->engine = engine_open(pool, work->open->engine_name, model, &work->open->options);
    equilibrium_settle(pool, work->engine, scene, false, found);
    const gic_model *code = found->engine->code;
    add_row(work->result, "state", found->self, code->state_offset, code->slow_count + code->fast_count, code->state);
    add_row(work->result, "input", found->self, code->input_offset, code->input_count, code->input);
    add_row(work->result, "output", found->self, code->output_offset, code->output_count, code->output);
}

static void find_modes(void *context)
{
    Work *work = context;
    Pool *pool = work->result->pool;
    const Scene *scene;
    const Model *model = read_scene(work, &scene);
    const Equilibrium *found = equilibrium_find(pool, model, scene, work->open->options.solve);
    bool moves;
    const Modes *modes = modes_about(pool, scene, false, found, &moves);
    gic_signal *column = NULL;
    int columns = 0;
    const char *unit, *name;
    while ((name = modes_column(pool, found->linear, columns, &unit)))
        *POOL_PUSH(pool, column, columns) = (gic_signal){name, unit};
    const int rows = modes->zeros + modes->count;
    double *data = pool_alloc(pool, sizeof *data * (size_t)(rows * columns + 1));
    for (int r = 0; r < rows; ++r)
        for (int k = 0; k < columns; ++k)
            data[r * columns + k] = modes_value(found->linear, modes, r - modes->zeros, k);
    result_add(work->result, "modes", rows, columns, data, NULL, column);
}

static void find_linear(void *context)
{
    Work *work = context;
    Pool *pool = work->result->pool;
    Result *result = work->result;
    const Scene *scene;
    const Model *model = read_scene(work, &scene);
    const OperatingPoint point = operating_point(pool, model, scene, work->open->options.solve, work->at);
    const LinearModel *m = linear_model(pool, &point, model->output_components, false);
    gic_signal *neutral = pool_alloc(pool, sizeof *neutral * (size_t)(m->neutral + 1));
    for (int k = 0; k < m->neutral; ++k)
        neutral[k] = (gic_signal){m->neutral_name[k], "1"};
    result_add(result, "A", m->states, m->states, m->A, m->rate, m->state);
    result_add(result, "B", m->states, m->inputs, m->B, m->rate, m->input);
    result_add(result, "C", m->outputs, m->states, m->C, m->output, m->state);
    result_add(result, "D", m->outputs, m->inputs, m->D, m->output, m->input);
    result_add(result, "E", m->states, m->parameters, m->E, m->rate, m->parameter);
    result_add(result, "F", m->outputs, m->parameters, m->F, m->output, m->parameter);
    result_add(result, "N", m->states, m->neutral, m->N, m->state, neutral);
    result_add(result, "f", m->states, 1, m->f, m->rate, NULL);
    result_add(result, "z0", m->states, 1, m->z0, m->state, NULL);
    result_add(result, "u0", m->inputs, 1, m->u0, m->input, NULL);
    result_add(result, "y0", m->outputs, 1, m->y0, m->output, NULL);
    result_add(result, "p0", m->parameters, 1, m->p0, m->parameter, NULL);
    result_add(result, "time", 1, 1, &m->time, NULL, NULL);
}

static void find_gradient(void *context)
{
    Work *work = context;
    Pool *pool = work->result->pool;
    const Solve solve = work->open->options.solve;
    const Scene *scene;
    const Model *model = read_scene(work, &scene);
    const Scalar scalar = scalar_read(pool, model, scene, pool_print(pool, "%s", work->formula));
    const Gradient *gradient = gradient_find(pool, &scalar, scene, solve, work->word, work->words);
    gic_signal *row = pool_alloc(pool, sizeof *row * (size_t)(gradient->variables + 1));
    double *value = pool_alloc(pool, sizeof *value * (size_t)(gradient->variables + 1));
    for (int k = 0; k < gradient->variables; ++k) {
        row[k] = (gic_signal){gradient->variable[k].name, gradient->variable[k].unit};
        value[k] = gradient->variable[k].value;
    }
    result_add(work->result, "number", 1, 1, &gradient->value, NULL, NULL);
    result_add(work->result, "time", 1, 1, &gradient->time, NULL, NULL);
    result_add(work->result, "variable", gradient->variables, 1, value, row, NULL);
    result_add(work->result, "derivative", gradient->variables, 1, gradient->derivative, row, NULL);
}

/* ---- calls ---------------------------------------------------------------------------------------------------- */

static void add_columns(void *context)
{
    const Work *work = context;
    const RunColumns *c = &work->columns;
    result_add(work->result, "columns", c->rows, c->columns, c->value, NULL, c->signal);
}

/* Do it, with a scene if `wanted`. The result is kept where it has arrays. */
static int analyse_work(gicl_library *library, gicl_handle model, Work work, bool wanted, void (*kind)(void *context),
                        gicl_handle *result, gicl_messages *said)
{
    if (result)
        *result = 0;
    const Use use = use_begin(library, model, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use.status;
    work.open = use.thing;
    if (!result || (wanted && !work.path))
        return use_end(
            &use, call_wrong(said, NULL, "%s must not be NULL", result ? "the scene" : "the place for the handle"));
    int status = call_work(library, said, make_result, &work);
    if (status != GICL_OK)
        return use_end(&use, status);
    status = call_work(library, said, kind, &work);
    close_engine(&work, status != GICL_OK);
    if (work.columns.rows && call_work(library, said, add_columns, &work) != GICL_OK)
        status = GICL_FAILED;
    if (status == GICL_OK || work.result->count) {
        *result = handle_new(library, THING_RESULT, work.result);
        if (!*result)
            status = call_wrong(said, NULL, "no memory for another handle");
    }
    if (!*result)
        pool_free(work.result->pool);
    return use_end(&use, status);
}

static int analyse(gicl_library *library, gicl_handle model, const char *scene, bool wanted, double at,
                   void (*kind)(void *context), gicl_handle *result, gicl_messages *said)
{
    return analyse_work(library, model, (Work){.path = scene, .at = at}, wanted, kind, result, said);
}

int gicl_run(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result, gicl_messages *said)
{
    return analyse(library, model, scene, true, NAN, run_scene, result, said);
}

int gicl_equilibrium(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result,
                     gicl_messages *said)
{
    return analyse(library, model, scene, false, NAN, find_equilibrium, result, said);
}

int gicl_modes(gicl_library *library, gicl_handle model, const char *scene, gicl_handle *result, gicl_messages *said)
{
    return analyse(library, model, scene, false, NAN, find_modes, result, said);
}

int gicl_linearize(gicl_library *library, gicl_handle model, const char *scene, double at, gicl_handle *result,
                   gicl_messages *said)
{
    if (result)
        *result = 0;
    call_begin(library, said);
    if (!isnan(at) && !(at >= 0 && isfinite(at)))
        return call_wrong(said, NULL, "the time must be finite and at least 0, or NaN for rest");
    return analyse(library, model, scene, !isnan(at), at, find_linear, result, said);
}

int gicl_gradient(gicl_library *library, gicl_handle model, const char *scene, const char *formula,
                  const char *const *word, int words, gicl_handle *result, gicl_messages *said)
{
    if (result)
        *result = 0;
    call_begin(library, said);
    if (!formula || words < 0 || (words && !word))
        return call_wrong(said, NULL, "the formula must not be NULL, and `word` has `words` words");
    const Work work = {.path = scene, .at = NAN, .formula = formula, .word = word, .words = words};
    return analyse_work(library, model, work, true, find_gradient, result, said);
}
