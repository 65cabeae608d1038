/* SPDX-License-Identifier: MIT
 * Checks whether a scene fits a model. If not, the message names the models beside it that the scene fits. What is
 * wrong with other files is nobody's concern. */
#define _DEFAULT_SOURCE /* scandir */
#include "base/catch.h"
#include "base/file.h"
#include "base/yaml.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "scene/scene.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum {
    MOST_SHOWN = 4,  /* names in a message */
    MOST_FILES = 100 /* files of a folder that are tried */
};

/* Names of one kind that a scene uses: those of the model, and the items in the scene that name others. */
typedef struct Kind {
    const char *one;
    const char **name;
    int count, lacking;
    const Item **lacks;
} Kind;

enum { INPUTS, COORDINATES, STATES, PARAMETERS, OUTPUTS, KINDS };

/* Names and parts that a scene uses and the model lacks. */
typedef struct Fit {
    Pool *pool;
    Kind kind[KINDS];
    const Item *free_base, *powertrain; /* the item that needs it; NULL: not needed, or the model has it */
} Fit;

/* ---- what the model has ------------------------------------------------------------------------------------- */

static void has(Fit *fit, int kind, const char *name)
{
    *POOL_PUSH(fit->pool, fit->kind[kind].name, fit->kind[kind].count) = name;
}

static Fit names_of(Pool *pool, const Model *model)
{
    Fit fit = {
        pool,
        {{.one = "input"}, {.one = "free coordinate"}, {.one = "fast state"}, {.one = "parameter"}, {.one = "output"}},
        NULL,
        NULL};
    for (int i = 0; i < model->inputs; ++i)
        has(&fit, INPUTS, model->input[i].name);
    for (int i = 0; i < model->coordinates; ++i)
        if (!model->coordinate[i].driven)
            has(&fit, COORDINATES, model->coordinate[i].name);
    const gic_signal *state = descriptor_fast_states(pool, model);
    for (int i = 0; i < model->fast_states; ++i)
        has(&fit, STATES, state[i].name);
    for (int i = 0; i < model->parameters; ++i)
        has(&fit, PARAMETERS, model->parameter[i].name);
    for (int i = 0; i < model->outputs; ++i) {
        has(&fit, OUTPUTS, model->output[i].name);
        for (int k = 0; k < model->output[i].count; ++k)
            has(&fit, OUTPUTS, model->output[i].component[k]);
    }
    for (int i = 0; i < model->inputs; ++i)
        has(&fit, OUTPUTS, pool_print(pool, "input.%s", model->input[i].name));
    return fit;
}

/* ---- what the scene uses: mistakes of other sorts are for the reader of the scene ---------------------------------
 */

static void use(Fit *fit, int k, const Item *at, const char *name)
{
    Kind *kind = &fit->kind[k];
    for (int i = 0; i < kind->count; ++i)
        if (!strcmp(kind->name[i], name))
            return;
    for (int i = 0; i < kind->lacking; ++i)
        if (!strcmp(kind->lacks[i]->text, name))
            return;
    Item *lack = pool_alloc(fit->pool, sizeof *lack);
    *lack = (Item){.at = at->at, .text = name};
    *POOL_PUSH(fit->pool, kind->lacks, kind->lacking) = lack;
}

static const Item *map_at(const Item *map, const char *key)
{
    const Item *item = map && map->kind == ITEM_MAP ? doc_find(map, key) : NULL;
    return item;
}

static void use_keys(Fit *fit, int kind, const Item *map)
{
    for (int i = 0; map && map->kind == ITEM_MAP && i < map->count; ++i)
        use(fit, kind, map->key[i], map->key[i]->text);
}

static void use_list(Fit *fit, const Item *list)
{
    for (int i = 0; list && list->kind == ITEM_LIST && i < list->count; ++i) {
        const Item *item = list->value[i];
        if (item->kind == ITEM_SCALAR)
            use(fit, OUTPUTS, item, item->text);
        for (int k = 0; item->kind == ITEM_MAP && k < item->count; ++k)
            if (item->value[k]->kind == ITEM_SCALAR)
                use(fit, OUTPUTS, item->value[k], item->value[k]->text);
    }
}

/* An input that the driver moves: by its key, or the default name. */
static void use_driven(Fit *fit, const Item *map, const char *key, const char *absent)
{
    const Item *named = map_at(map, key);
    if (map && map->kind == ITEM_MAP && (!named || named->kind == ITEM_SCALAR))
        use(fit, INPUTS, named ? named : map, named ? named->text : absent);
}

static Fit fit_of(Pool *pool, const Item *root, const Model *model)
{
    static const char *const of_base[] = {"position", "orientation", "velocity", "speed", "angular_velocity"};
    Fit fit = names_of(pool, model);
    const Item *initial = map_at(root, "initial"), *driver = map_at(root, "driver");
    use_keys(&fit, INPUTS, map_at(root, "inputs"));
    use_driven(&fit, map_at(driver, "speed"), "accelerator", "accelerator");
    use_driven(&fit, map_at(driver, "speed"), "brake", "brake");
    use_driven(&fit, map_at(driver, "steering"), "input", "steering");
    use_keys(&fit, COORDINATES, map_at(root, "driven"));
    use_keys(&fit, COORDINATES, map_at(initial, "coordinates"));
    use_keys(&fit, COORDINATES, map_at(initial, "rates"));
    use_keys(&fit, STATES, map_at(initial, "states"));
    use_keys(&fit, PARAMETERS, map_at(root, "parameters"));
    use_list(&fit, map_at(root, "outputs"));
    use_list(&fit, map_at(root, "plot"));
    for (size_t i = 0; i < sizeof of_base / sizeof *of_base && !model->free_base && !fit.free_base; ++i)
        fit.free_base = map_at(initial, of_base[i]);
    if (!model->free_base && !fit.free_base)
        fit.free_base = driver;
    fit.powertrain = model->powertrain ? NULL : map_at(initial, "gear");
    return fit;
}

static bool fits(const Fit *fit)
{
    bool good = !fit->free_base && !fit->powertrain;
    for (int k = 0; k < KINDS; ++k)
        good = good && !fit->kind[k].lacking;
    return good;
}

/* ---- models beside it ------------------------------------------------------------------------------------------- */

typedef struct Trial {
    const char *scene, *model;
    bool good;
} Trial;

static void try_files(void *tried)
{
    Trial *trial = tried;
    Pool *pool = pool_new();
    const Item *root = doc_read(pool, trial->scene);
    const Fit fit = fit_of(pool, root, model_read(pool, trial->model));
    trial->good = fits(&fit) && map_at(root, "gicscene");
    pool_free(pool);
}

/* True if the scene in a file fits the model in another file. Files with errors do not. */
static bool files_fit(const char *scene, const char *model)
{
    Messages unheard = {NULL, NULL, NULL};
    Trial trial = {scene, model, false};
    const bool good = caught(&unheard, try_files, &trial);
    messages_clear(&unheard);
    return good && trial.good;
}

/* The folder of a file, with its slash. */
static const char *folder_of(Pool *pool, const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? pool_print(pool, "%.*s", (int)(slash - path + 1), path) : "";
}

static bool is_file(const char *path)
{
    struct stat there;
    return !stat(path, &there) && S_ISREG(there.st_mode);
}

/* Files of a folder with this ending that fit: models for the scene if `model` is NULL, else scenes for the model. */
static void find_fitting(Pool *pool, const char *folder, const char *scene, const char *model, const char ***path,
                         int *count)
{
    struct dirent **entry;
    const int entries = scandir(*folder ? folder : ".", &entry, NULL, alphasort);
    for (int i = 0, seen = 0; i < entries; free(entry[i++])) {
        const char *file = pool_print(pool, "%s%s", folder, entry[i]->d_name);
        if (!path_ends(entry[i]->d_name, model ? ".scene" : ".veh") || !is_file(file) || ++seen > MOST_FILES)
            continue;
        bool known = false;
        for (int k = 0; k < *count; ++k)
            known = known || files_are_one((*path)[k], file);
        if (!known && files_fit(model ? file : scene, model ? model : file))
            *POOL_PUSH(pool, *path, *count) = file;
    }
    if (entries >= 0)
        free(entry);
}

/* ---- the message ------------------------------------------------------------------------------------------------ */

static void add_name(Text *text, int i, int count, const char *name)
{
    if (i < MOST_SHOWN || count == MOST_SHOWN + 1)
        text_print(text, "%s%s", i ? ", " : "", name);
    else if (i == MOST_SHOWN)
        text_print(text, " and %d more", count - i);
}

/* The first thing that the model lacks, with its place, and all others of its kind. */
static Place say_needs(const Fit *fit, const Model *model, Text *needs, Text *lack)
{
    for (int k = 0; k < KINDS; ++k) {
        const Kind *kind = &fit->kind[k];
        if (!kind->lacking)
            continue;
        text_print(needs, "the %s%s ", kind->one, kind->lacking > 1 ? "s" : "");
        for (int i = 0; i < kind->lacking; ++i)
            add_name(needs, i, kind->lacking, kind->lacks[i]->text);
        text_print(lack, "has no %s '%s'", kind->one, kind->lacks[0]->text);
        for (int c = 0; c < model->coordinates; ++c)
            if (!strcmp(model->coordinate[c].name, kind->lacks[0]->text) && model->coordinate[c].driven)
                text_print(lack, ": it is driven, and `inputs` describe its motion");
        return kind->lacks[0]->at;
    }
    text_print(needs, fit->free_base ? "a free base" : "a powertrain");
    text_print(lack, fit->free_base ? "has a fixed base" : "has no powertrain");
    return fit->free_base ? fit->free_base->at : fit->powertrain->at;
}

static const char *stem(Pool *pool, const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot && dot > name ? pool_print(pool, "%.*s", (int)(dot - name), name) : name;
}

void scene_check_fit(Pool *pool, const Item *root, const char *path, const Model *model)
{
    const Fit fit = fit_of(pool, root, model);
    if (fits(&fit) || !strcmp(path, "-"))
        return;
    const char **other = NULL, **scene = NULL;
    const char *folder = folder_of(pool, path), *beside = folder_of(pool, model->source->path);
    int others = 0, scenes = 0;
    find_fitting(pool, beside, path, NULL, &other, &others);
    find_fitting(pool, folder, path, NULL, &other, &others);
    find_fitting(pool, pool_print(pool, "%s../", folder), path, NULL, &other, &others);
    if (!others)
        return;
    if (is_file(model->source->path)) /* standard input can't be read again */
        find_fitting(pool, folder, NULL, model->source->path, &scene, &scenes);
    Text needs = {.pool = pool}, lack = {.pool = pool}, names = {.pool = pool}, remedy = {.pool = pool};
    const Place at = say_needs(&fit, model, &needs, &lack);
    for (int i = 0; i < others; ++i)
        add_name(&names, i, others, stem(pool, other[i]));
    text_print(&remedy, "run it with %s", other[0]);
    for (int i = 0; i < scenes; ++i) {
        text_print(&remedy, "%s",
                   i ? "" : pool_print(pool, ", or '%s' with the scene%s ", model->name, scenes > 1 ? "s" : ""));
        add_name(&remedy, i, scenes, stem(pool, scene[i]));
    }
    diag_fail(at, remedy.s, "%s is for models with %s: %s; '%s' %s", stem(pool, path), needs.s, names.s, model->name,
              lack.s);
}
