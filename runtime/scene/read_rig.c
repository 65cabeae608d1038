/* SPDX-License-Identifier: MIT
 * The model as a scene has it: on a test rig the base is fixed, coordinates are driven and wheels stand on posts
 * (models/SCENE.md section 10), light bodies lose their mass (section 9). */
#include "base/yaml.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "specialize/specialize.h"

#include <math.h>
#include <string.h>

static void check_rig(const Scene *scene, Place at, const char *what)
{
    if (scene->driver)
        diag_fail(at, "remove the driver: nobody can drive on a rig", "%s, and there is a driver", what);
}

static void read_massless(const Item *item, const Model *model, Scene *scene)
{
    if (item->kind != ITEM_MAP)
        diag_fail(item->at, "write {below: 6}, a mass in kg", "massless must be a map");
    CHECK_KEYS(item, "massless", "below");
    scene->massless = scene_positive(scene_need(item, "below", "massless"), "below");
    scene->massless_at = item->at;
    const Body *base = &model->body[BODY_BASE];
    if (model->free_base && base->mass < scene->massless)
        diag_fail(item->at, "choose a smaller mass", "the base '%s' of %.6g kg would be without mass", base->name,
                  base->mass);
}

bool rig_wanted(const Item *root)
{
    return doc_find(root, "base") || doc_find(root, "driven") || doc_find(root, "posts") || doc_find(root, "massless");
}

/* ---- posts -------------------------------------------------------------------------------------------------- */

/* A post that moves as a road that passes under it: samples of h(x + speed t, y). */
static void read_passing(Pool *pool, const Item *item, Profile *profile)
{
    static const double apart = 0.0025; /* s */
    CHECK_KEYS(item, "a road under a post", "road", "x", "y", "speed");
    const gic_road *road = road_read(pool, doc_find(item, "road"));
    const double x = scene_number(item, "x", "x of a post", 0), y = scene_number(item, "y", "y of a post", 0);
    const double speed = scene_positive(scene_need(item, "speed", "a road under a post"), "speed of the road");
    const int count = (int)ceil(profile->end / apart) + 2;
    double *time = pool_alloc(pool, sizeof *time * (size_t)count),
           *height = pool_alloc(pool, sizeof *time * (size_t)count);
    for (int k = 0; k < count; ++k) {
        double h[3];
        time[k] = k * apart;
        road->height(road, 0, 0, x + speed * time[k], y, h);
        height[k] = h[0];
    }
    profile_through(pool, profile, count, time, height, false);
}

static void read_posts(Pool *pool, const Item *posts, const Model *model, Scene *scene)
{
    const char **name = pool_alloc(pool, sizeof *name * (size_t)(model->wheels + 1));
    for (int i = 0; i < model->wheels; ++i)
        name[i] = model->wheel[i].name;
    if (posts->kind != ITEM_MAP)
        diag_fail(posts->at, "write {wheel: profile}", "posts must be a map");
    check_rig(scene, posts->at, "wheels are on posts");
    for (int k = 0; k < posts->count; ++k) {
        const Item *key = posts->key[k], *value = posts->value[k];
        const int w = scene_name_index(pool, key, key->text, "wheel", name, model->wheels);
        Profile *profile = POOL_PUSH(pool, scene->profile, scene->profiles);
        *profile = (Profile){.input = model->inputs + 3 * scene->driven + 2 * scene->posts,
                             .post = true,
                             .unit = "m",
                             .end = scene->duration,
                             .until = scene->duration,
                             .model = model};
        if (value->kind == ITEM_MAP && doc_find(value, "road"))
            read_passing(pool, value, profile);
        else
            profile_read(pool, value, key->text, profile);
        *POOL_PUSH(pool, scene->post, scene->posts) = w;
    }
}

/* ---- coordinates, and all of it ----------------------------------------------------------------------------- */

static void read_driven(Pool *pool, const Item *driven, const Model *model, Scene *scene)
{
    const char **name = pool_alloc(pool, sizeof *name * (size_t)(model->coordinates + 1));
    for (int i = 0; i < model->coordinates; ++i)
        name[i] = model->coordinate[i].name;
    if (driven->kind != ITEM_MAP)
        diag_fail(driven->at, "write {name: number or profile}", "driven coordinates must be a map");
    check_rig(scene, driven->at, "coordinates are driven");
    for (int k = 0; k < driven->count; ++k) {
        const Item *key = driven->key[k];
        const int w = scene_name_index(pool, key, key->text, "coordinate", name, model->coordinates);
        const Coordinate *coordinate = &model->coordinate[w];
        if (coordinate->driven)
            diag_fail(key->at, "describe it under `inputs`", "coordinate '%s' is driven anyway", name[w]);
        if (scene->given[w])
            diag_fail(key->at, "remove it from `initial`", "the profile of '%s' says where it begins", name[w]);
        Profile *profile = POOL_PUSH(pool, scene->profile, scene->profiles);
        *profile = (Profile){.input = model->inputs + 3 * scene->driven,
                             .driven = coordinate,
                             .unit = coordinate->type == COORDINATE_ANGLE ? "rad" : "m",
                             .offset = coordinate->initial,
                             .end = scene->duration,
                             .until = scene->duration,
                             .model = model};
        profile_read(pool, driven->value[k], key->text, profile);
        *POOL_PUSH(pool, scene->drive, scene->driven) = w;
    }
}

void rig_read(Pool *pool, const Item *root, const Model *model, Scene *scene)
{
    if (doc_find(root, "massless"))
        read_massless(doc_find(root, "massless"), model, scene);
    const Item *base = doc_find(root, "base");
    if (base) {
        const char *word = doc_word(base, "base");
        if (strcmp(word, "free") && strcmp(word, "fixed"))
            diag_fail(base->at, "write fixed, or free", "the base can't be '%s'", word);
        scene->held = !strcmp(word, "fixed") && model->free_base;
        if (scene->held)
            check_rig(scene, base->at, "the base is held");
    }
    if (doc_find(root, "driven"))
        read_driven(pool, doc_find(root, "driven"), model, scene);
    if (doc_find(root, "posts"))
        read_posts(pool, doc_find(root, "posts"), model, scene);
}

/* numbers: the model with the scene's values in place of its geometric parameters. */
static const Model *lighten(Pool *pool, const Model *model, const Model *numbers, Scene *scene)
{
    const Model *light = model_lighten(pool, model, numbers, scene->massless, &scene->massless_names);
    if (!scene->massless_names)
        diag_fail(scene->massless_at, "remove it, or choose a larger mass", "no body of '%s' is lighter than %.6g kg",
                  model->name, scene->massless);
    scene->lost = model_lost(pool, numbers, scene->massless);
    if (scene->lost >= 1)
        diag_fail(scene->massless_at,
                  "choose a smaller mass, so that each free coordinate still moves one that has some",
                  "without the mass of %s a coordinate has no inertia", scene->massless_names);
    return light;
}

static const Model *rigged(Pool *pool, const Model *model, const Scene *scene)
{
    if (scene->held)
        model = model_hold(pool, model, scene->position, scene->euler);
    model = model_drive(pool, model, scene->drive, scene->driven);
    return model_post(pool, model, scene->post, scene->posts);
}

const Model *scene_rig(Pool *pool, const Model *model, const Scene **scene)
{
    if (!*scene || (!(*scene)->held && !(*scene)->driven && !(*scene)->posts && (*scene)->massless == 0))
        return model;
    Scene *own = pool_alloc(pool, sizeof *own);
    *own = **scene;
    model = rigged(pool, model, own);
    if (own->massless != 0)
        model = lighten(pool, model, own->fixed ? rigged(pool, own->fixed, own) : model, own);
    own->signal = scene_signals(pool, model); /* new inputs are added after the others */
    *scene = own;
    return model;
}

void scene_no_rig(const Scene *scene)
{
    if (scene->actions)
        diag_fail((Place){scene->source, 0, 0}, "run it with gicrun", "the scene has conditions (`until`, `when`)");
    if (scene->held || scene->driven || scene->posts)
        diag_fail((Place){scene->source, 0, 0}, "run it with gicrun",
                  "the scene is one of a rig (`base`, `driven`, `posts`)");
    if (scene->massless != 0)
        diag_fail(scene->massless_at, "run it with gicrun", "the scene leaves out the mass of light bodies");
}
