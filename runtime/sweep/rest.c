/* SPDX-License-Identifier: MIT
 * Runs that begin in static equilibrium: each in that of its own numbers, as gicrun has it for a scene with these. */
#include "base/catch.h"
#include "run/run.h"
#include "scene/scene.h"
#include "sweep/run_private.h"
#include "sweep/sweep.h"

#include <string.h>

bool rest_varies(const Sweep *sweep)
{
    bool varies = false;
    for (int v = 0; v < sweep->plan->varied; ++v)
        varies |= sweep->plan->vary[v].kind != VARY_STATE;
    return sweep->drawn->equilibrium && varies;
}

typedef struct Finding {
    const Sweep *sweep;
    const Scene *scene, *found;
    Pool *pool;
} Finding;

static void find(void *context)
{
    Finding *f = context;
    f->pool = pool_new();
    f->found = equilibrium_start(f->pool, f->sweep->model, f->scene, f->sweep->solve);
}

static void *copy(Pool *pool, const void *from, size_t size)
{
    return from ? memcpy(pool_alloc(pool, size + 1), from, size) : NULL;
}

bool rest_find(Pool *pool, const Sweep *sweep, Scene *scene, const char **why)
{
    const size_t coordinates = (size_t)sweep->model->coordinates, fast = (size_t)sweep->model->fast_states;
    Messages said = {.first = NULL};
    Finding f = {.sweep = sweep, .scene = scene};
    const bool good = caught(&said, find, &f);
    if (good) {
        *scene = *f.found;
        scene->value = copy(pool, scene->value, coordinates * sizeof *scene->value);
        scene->given = copy(pool, scene->given, coordinates * sizeof *scene->given);
        scene->rate = copy(pool, scene->rate, coordinates * sizeof *scene->rate);
        scene->fast = copy(pool, scene->fast, fast * sizeof *scene->fast);
        pool_free(f.pool);
    } else {
        const char *text = "no static equilibrium found";
        for (const Message *message = said.first; message; message = message->next)
            if (message->kind == MESSAGE_ERROR && message->text)
                text = message->text;
        *why = pool_print(pool, "%s", text);
    }
    messages_clear(&said);
    return good;
}
