/* SPDX-License-Identifier: MIT
 * The key `sleep`: models/SCENE.md section 9. */
#include "base/yaml.h"
#include "model/model.h"
#include "scene/scene.h"
#include "scene/sleep.h"

static bool law_reads_time(const Law *law)
{
    if (!law || law->op == LAW_TIME)
        return law;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (law_reads_time(law->arg[i]))
            return true;
    return false;
}

static bool any_reads_time(const Law *const *law, int count)
{
    for (int i = 0; i < count; ++i)
        if (law_reads_time(law[i]))
            return true;
    return false;
}

static bool powertrain_reads_time(const Powertrain *powertrain)
{
    const Law *const law[] = {powertrain->throttle, powertrain->torque, powertrain->selector};
    if (any_reads_time(law, 3) || any_reads_time(powertrain->up, powertrain->forward - 1) ||
        any_reads_time(powertrain->down, powertrain->forward - 1))
        return true;
    for (int i = 0; i < powertrain->differentials; ++i)
        if (law_reads_time(powertrain->differential[i].lock))
            return true;
    return false;
}

/* A part of the model that changes with time by itself; NULL: none. */
static const char *restless(const Model *model)
{
    for (int i = 0; i < model->forces; ++i)
        if (any_reads_time(model->force[i].law, (int)(sizeof model->force[i].law / sizeof *model->force[i].law)))
            return model->force[i].name;
    for (int i = 0; i < model->wheels; ++i)
        if (law_reads_time(model->wheel[i].drive) || law_reads_time(model->wheel[i].brake))
            return model->wheel[i].name;
    return model->powertrain && powertrain_reads_time(model->powertrain) ? "powertrain" : NULL;
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
    if (restless(model))
        diag_fail(item->at, "remove it", "'%s' of '%s' changes with time by itself, so that nothing rests",
                  restless(model), model->name);
    return rest;
}
