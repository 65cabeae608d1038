/* SPDX-License-Identifier: MIT
 * The key `sleep`: models/SCENE.md section 9. */
#include "base/yaml.h"
#include "model/model.h"
#include "scene/scene.h"
#include "scene/sleep.h"

static bool law_reads_time(const Model *model, const Law *law)
{
    if (!law || law->op == LAW_TIME)
        return law;
    if (law->op == LAW_SIGNAL)
        return law_reads_time(model, model->signal[law->index].law); /* NULL: an output, of something looked at here */
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (law_reads_time(model, law->arg[i]))
            return true;
    return false;
}

static bool any_reads_time(const Model *model, const Law *const *law, int count)
{
    for (int i = 0; i < count; ++i)
        if (law_reads_time(model, law[i]))
            return true;
    return false;
}

static bool powertrain_reads_time(const Model *model, const Powertrain *powertrain)
{
    const Law *const law[] = {powertrain->throttle, powertrain->torque, powertrain->selector};
    if (any_reads_time(model, law, 3) || any_reads_time(model, powertrain->up, powertrain->forward - 1) ||
        any_reads_time(model, powertrain->down, powertrain->forward - 1))
        return true;
    for (int i = 0; i < powertrain->differentials; ++i)
        if (law_reads_time(model, powertrain->differential[i].lock))
            return true;
    return false;
}

const char *scene_restless(Pool *pool, const Model *model)
{
    for (int i = 0; i < model->forces; ++i)
        if (any_reads_time(model, model->force[i].law, sizeof model->force[i].law / sizeof *model->force[i].law))
            return pool_print(pool, "force '%s'", model->force[i].name);
    if (model->controllers)
        return pool_print(pool, "controller '%s'", model->controller[0].name);
    for (int i = 0; i < model->states; ++i)
        if (law_reads_time(model, model->state[i].rate))
            return pool_print(pool, "state '%s'", model->state[i].name);
    for (int i = 0; i < model->wheels; ++i)
        if (law_reads_time(model, model->wheel[i].drive) || law_reads_time(model, model->wheel[i].brake))
            return pool_print(pool, "wheel '%s'", model->wheel[i].name);
    return model->powertrain && powertrain_reads_time(model, model->powertrain) ? "the powertrain" : NULL;
}

Sleep *sleep_read(Pool *pool, const Item *item, const Model *model)
{
    const double within = 1e-4, after = 1;
    Sleep *rest = pool_alloc(pool, sizeof *rest);
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write {within: 1e-4, after: 1}", "sleep must be a map");
    CHECK_KEYS(item, "sleep", "within", "after");
    rest->pool = pool;
    rest->within = doc_find(item, "within") ? scene_positive(doc_find(item, "within"), "within") : within;
    rest->after = doc_find(item, "after") ? scene_positive(doc_find(item, "after"), "after") : after;
    const char *moves = scene_restless(pool, model);
    if (moves)
        diag_fail(item->at, "remove it", "%s of '%s' changes with time by itself, so that nothing rests", moves,
                  model->name);
    return rest;
}
