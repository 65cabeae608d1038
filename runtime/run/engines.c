/* SPDX-License-Identifier: MIT
 * The engines by name. */
#include "base/message.h"
#include "compare/compare.h"
#include "compare/mumps.h"
#include "engine/engine.h"
#include "host/host.h"
#include "model/model.h"
#include "run/engines.h"
#include "run/stepper.h"
#include "run/stiff_states.h"
#include "tape/tape.h"

#include <string.h>
#include <sys/resource.h>

typedef const Engine *Open(Pool *pool, const Model *model, const EngineOptions *options);

const char *const engine_name[] = {"auto", "tcc", "cc", "gic", "gcp1", "gcp2", "tape", "page", NULL};

/* Whatever the page's vehicle computes is not an engine's: who runs it has another one beside it. */
static const Engine *no_engine(Pool *pool, const Model *model, const EngineOptions *options)
{
    (void)pool;
    (void)model;
    (void)options;
    diag_fail_call(program_place(), "take another engine", "the engine 'page' goes with a run of one scene by gicrun");
}

static Open *const engine_opener[] = {engine_auto, engine_tcc,  engine_cc,   engine_gic,
                                      engine_gcp1, engine_gcp2, engine_tape, no_engine};

static int engine_index(const char *name)
{
    for (int i = 0; engine_name[i]; ++i)
        if (!strcmp(engine_name[i], name))
            return i;
    return -1;
}

bool engine_known(const char *name)
{
    return engine_index(name) >= 0;
}

bool engine_is_whole(const char *name)
{
    return engine_opener[engine_index(name)] != no_engine;
}

bool engine_generates(const char *name)
{
    Open *const open = engine_opener[engine_index(name)];
    return open != engine_gic && open != engine_gcp1 && open != engine_gcp2;
}

const char *engine_missing(Pool *pool, const char *name)
{
    const char *why;
    return engine_opener[engine_index(name)] != engine_gcp2 || mumps_load(pool, &why) ? NULL : MUMPS_PACKAGES;
}

const Engine *engine_open(Pool *pool, const char *name, const Model *model, const EngineOptions *options)
{
    return engine_opener[engine_index(name)](pool, model, options);
}

/* Implicit steps need derivatives. */
bool engine_has_implicit(const char *name)
{
    return engine_generates(name) && engine_opener[engine_index(name)] != engine_tape && engine_is_whole(name);
}

static void check_implicit(Pool *pool, const char *name, const Scene *scene)
{
    if (!engine_has_implicit(name))
        scene_no_implicit_engine(pool, scene, name);
}

void engine_check_shares(const Engine *engine, const Scene *scene)
{
    if (scene->spread && engine->code && engine->code->implicit && !engine->code->implicit->share_count)
        diag_fail((Place){scene->source, 0, 0}, "remove spread_jacobian from the scene",
                  "the Jacobian of this model is not made by shares (models/STIFF.md)");
}

const Engine *engine_open_run(Pool *pool, const char *name, const Model *model, const Scene *scene, const char *path,
                              bool drawn, const EngineOptions *options)
{
    EngineOptions own = *options;
    own.exact = scene->method == METHOD_BDF && engine_has_implicit(name);
    own.implicit = scene_implicit(scene) || own.exact;
    own.exponential = scene->method == GIC_EXP3;
    own.spread = scene->spread;
    own.splitting = scene_splitting(pool, model, scene, options->solve, options->recovery);
    if (own.splitting && !options->quiet)
        diag_note(pool_print(pool, "%s: note: %s\n", scene->source->path, own.splitting->summary));
    stepper_need(scene->method);
    if (scene_implicit(scene))
        check_implicit(pool, name, scene);
    own.facts = path && !own.implicit ? scene_facts(pool, model, scene, path, drawn) : NULL;
    own.validation = scene_validation(pool, model, scene);
    const Engine *engine = engine_open(pool, name, model, &own);
    engine_check_shares(engine, scene);
    return engine;
}
