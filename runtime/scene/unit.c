/* SPDX-License-Identifier: MIT
 * Units in which pictures and pages show numbers: models/SCENE.md section 1. Files stay SI. */
#include "base/message.h"
#include "base/text.h"
#include "base/yaml.h"
#include "scene/scene.h"

#include <string.h>

static const ShownUnit known[] = {
    {"deg", "rad", 57.295779513082323},
    {"deg/s", "rad/s", 57.295779513082323},
    {"deg/s^2", "rad/s^2", 57.295779513082323},
    {"rpm", "rad/s", 9.5492965855137202},
    {"km/h", "m/s", 3.6},
    {"mph", "m/s", 1 / 0.44704},
    {"g", "m/s^2", 1 / 9.80665},
    {"mm", "m", 1000},
    {"kN", "N", 1e-3},
    {"kN m", "N m", 1e-3},
    {"kJ", "J", 1e-3},
    {"kW", "W", 1e-3},
};
enum { KNOWN = sizeof known / sizeof *known };

static const ShownUnit *unit_named(Pool *pool, const Item *item)
{
    const char *word = doc_word(item, "name of a unit"), *name[KNOWN];
    Text all = {.pool = pool};
    for (int i = 0; i < KNOWN; ++i) {
        name[i] = known[i].name;
        text_print(&all, "%s%s", i ? ", " : "choose of ", known[i].name);
        if (!strcmp(word, known[i].name))
            return &known[i];
    }
    const char *nearest = diag_nearest(word, name, KNOWN);
    diag_fail(item->at, nearest ? pool_print(pool, "did you mean '%s'?", nearest) : all.s,
              "pictures and pages do not know the unit '%s'", word);
}

void scene_read_units(Pool *pool, const Item *root, Scene *scene)
{
    const Item *list = doc_find(root, "units");
    if (list && list->kind != ITEM_LIST)
        diag_fail(list->at, "write [deg, km/h, g]", "units must be a list of names of units");
    for (int i = 0; list && i < list->count; ++i) {
        const ShownUnit *unit = unit_named(pool, list->value[i]), *before = scene_unit(scene, unit->of);
        if (before)
            diag_fail(list->value[i]->at, "keep one of them", "'%s' and '%s' are both for numbers in %s", before->name,
                      unit->name, unit->of);
        *POOL_PUSH(pool, scene->unit, scene->units) = unit;
    }
}

const ShownUnit *scene_unit(const Scene *scene, const char *of)
{
    for (int i = 0; i < scene->units; ++i)
        if (!strcmp(scene->unit[i]->of, of))
            return scene->unit[i];
    return NULL;
}
