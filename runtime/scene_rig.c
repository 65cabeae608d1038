/* SPDX-License-Identifier: MIT
 * Scenes as on a test rig, with a base that is held and coordinates that are driven: models/SCENE.md section 10. */
#include "gicrun.h"

#include <string.h>

static void check_rig(const Scene *scene, const Model *model, Place at, const char *what)
{
    if (model->tuning)
        diag_fail(at, "give geometric parameters numbers in the model", "%s, and '%s' has geometric parameters", what,
                  model->name);
    if (scene->driver)
        diag_fail(at, "remove the driver: nobody can drive on a rig", "%s, and there is a driver", what);
}

void rig_read(Pool *pool, const Item *root, const Model *model, Scene *scene)
{
    const Item *base = doc_find(root, "base"), *driven = doc_find(root, "driven");
    if (base) {
        const char *word = doc_word(base, "base");
        if (strcmp(word, "free") && strcmp(word, "fixed"))
            diag_fail(base->at, "write fixed, or free", "the base can't be '%s'", word);
        scene->held = !strcmp(word, "fixed") && model->free_base;
        if (scene->held)
            check_rig(scene, model, base->at, "the base is held");
    }
    if (!driven)
        return;
    const char **name = pool_alloc(pool, sizeof *name * (size_t)(model->coordinates + 1));
    for (int i = 0; i < model->coordinates; ++i)
        name[i] = model->coordinate[i].name;
    if (driven->kind != ITEM_MAP)
        diag_fail(driven->at, "write {name: number or profile}", "driven coordinates must be a map");
    check_rig(scene, model, driven->at, "coordinates are driven");
    for (int k = 0; k < driven->count; ++k) {
        const Item *key = driven->key[k];
        const int w = scene_name_index(pool, key, key->text, "coordinate", name, model->coordinates);
        const Coordinate *coordinate = &model->coordinate[w];
        if (coordinate->driven)
            diag_fail(key->at, "describe it under `inputs`", "coordinate '%s' is driven anyway", name[w]);
        if (scene->given[w])
            diag_fail(key->at, "remove it from `initial`", "the profile of '%s' says where it begins", name[w]);
        Profile *profile = POOL_PUSH(pool, scene->profile, scene->profiles);
        *profile =
            (Profile){.input = model->inputs + 3 * scene->driven, .driven = coordinate, .offset = coordinate->initial};
        profile_read(pool, driven->value[k], profile);
        *POOL_PUSH(pool, scene->drive, scene->driven) = w;
    }
}

const Model *scene_rig(Pool *pool, const Model *model, const Scene **scene)
{
    if (!*scene || (!(*scene)->held && !(*scene)->driven))
        return model;
    Scene *own = pool_alloc(pool, sizeof *own);
    *own = **scene;
    if (own->held)
        model = model_hold(pool, model, own->position, own->euler);
    model = model_drive(pool, model, own->drive, own->driven);
    own->signal = scene_signals(pool, model); /* the new inputs stand behind the others */
    *scene = own;
    return model;
}

void scene_no_rig(const Scene *scene)
{
    if (scene->held || scene->driven)
        diag_fail((Place){scene->source, 0, 0}, "run it with gicrun", "the scene is one of a rig (`base`, `driven`)");
}
