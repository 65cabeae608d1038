/* SPDX-License-Identifier: MIT
 * What each reader gets, and what must hold of what it makes of it: see fuzz.c. */
#include "targets.h"

#include "base/text.h"
#include "base/yaml.h"
#include "emit/emit.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "read/reader.h"
#include "scene/scene.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void input_write(const Bytes *input, const char *bytes, size_t size)
{
    if (ftruncate(input->file, 0) || pwrite(input->file, bytes, size, 0) != (ssize_t)size)
        abort();
}

static void check(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "fuzz: finding: %s\n", what);
    abort();
}

/* Outside of strings the only words of JSON are these; a number that is not finite would be another. */
static void check_json(const char *s)
{
    while (*s) {
        if (*s == '"')
            while (*++s != '"')
                s += *s == '\\';
        if (!isalpha((unsigned char)*s)) {
            ++s;
            continue;
        }
        const size_t length = strcspn(s, " ,]}:\n");
        const bool known = (length == 4 && !memcmp(s, "true", 4)) || (length == 5 && !memcmp(s, "false", 5)) ||
                           (length == 4 && !memcmp(s, "null", 4)) ||
                           (*s == 'e' && strchr("+-0123456789", s[1])); /* of a number */
        check(known, "a word in the dumped model");
        s += length;
    }
}

/* ---- models -------------------------------------------------------------------------------------------------- */

static const Model *whole_model(Pool *pool, const char *path, const Sequence **sequence)
{
    const Model *model = model_read(pool, path);
    *sequence = sequence_find(pool, model);
    return model_assemble(pool, model, *sequence);
}

static void read_veh(const Bytes *input)
{
    Pool *pool = pool_new();
    const Sequence *sequence;
    Text dump = {.pool = pool}, graph = {.pool = pool}, table = {.pool = pool};
    input_write(input, input->bytes, input->size);
    const Model *model = whole_model(pool, input->path, &sequence);
    model_dump(&dump, model, sequence);
    check_json(dump.s);
    graph_draw(&graph, model, sequence);
    sequence_print(&table, model, sequence);
    if (model->bodies > 2)
        return;
    Text c = {.pool = pool}, h = {.pool = pool};
    generate(pool, formulate(pool, model, sequence, SOLVE_REDUCED, RECOVERY_AUTO), &style_readable, NULL, "x.h", &c,
             &h);
}

/* A formula of a force, or behind `=` of a parameter, in double quotes whatever it is made of. */
static void read_formula(const Bytes *input)
{
    static const char model[] =
        "gicgen: 1\nmodel: fuzzed\nbase: ground\n"
        "parameters: {k: {value: 3, tunable: true}, c: 2%s}\n"
        "tables: {stop: {x: [0, 1, 2], y: [0, 1, 5]}, soft: {x: [0, 1, 2], y: [0, 1, 5], interpolation: cubic}}\n"
        "bodies: {arm: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}}\n"
        "joints: {pin: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}}\n"
        "coordinates: {w: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}}\n"
        "inputs: {u: {default: 0.5}}\n"
        "forces: {law: {type: force, coordinate: w, value: %s}}\n";
    Pool *pool = pool_new();
    Text quoted = {.pool = pool};
    const bool constant = input->size && input->bytes[0] == '=';
    text_print(&quoted, "\"");
    for (const char *s = input->bytes + constant; *s; ++s)
        text_print(&quoted, isalnum((unsigned char)*s) ? "%c" : "\\x%02x", (unsigned char)*s);
    text_print(&quoted, "\"");
    const char *parameter = constant ? pool_print(pool, ", p: %s", quoted.s) : "";
    const char *file = pool_print(pool, model, parameter, constant ? "p" : quoted.s);
    input_write(input, file, strlen(file));
    const Sequence *sequence;
    const Model *whole = whole_model(pool, input->path, &sequence);
    const Formulation *formulation = formulate(pool, whole, sequence, SOLVE_REDUCED, RECOVERY_AUTO);
    Text c = {.pool = pool}, h = {.pool = pool}, dump = {.pool = pool};
    model_dump(&dump, whole, sequence);
    check_json(dump.s);
    generate(pool, formulation, &style_readable, NULL, "x.h", &c, &h);
}

static void read_tir(const Bytes *input)
{
    Pool *pool = pool_new();
    Source source = {.path = input->path};
    const Item item = {.kind = ITEM_SCALAR, .at = {&source, 0, 0}, .text = input->path};
    const Reader reader = {.pool = pool};
    Tire tire = {0};
    input_write(input, input->bytes, input->size);
    tir_read(&reader, &item, "tire 'front'", &tire);
    check(isfinite(tire.radius) && tire.radius > 0, "radius of a tire");
    check(isfinite(tire.stiffness) && tire.stiffness > 0, "stiffness of a tire");
    check(isfinite(tire.damping) && isfinite(tire.width) && isfinite(tire.low_speed), "numbers of a tire");
}

/* ---- scenes and roads --------------------------------------------------------------------------------------- */

/* Read once: a vehicle with all that scenes can speak of, and a mechanism on the ground with a driven coordinate. */
static const Model *scene_model[2];

static void prepare_scene(void)
{
    static const char *const path[] = {"models/hmmwv_vehicle.veh", "models/quarter_car.veh"};
    /* with no other models beside it, which would be read in child processes for messages (scene/fit.c) */
    static const Source alone = {.path = "/proc/self/model.veh"};
    for (int i = 0; i < 2; ++i) {
        const Sequence *sequence;
        Pool *pool = pool_new();
        Model *model = pool_alloc(pool, sizeof *model);
        *model = *whole_model(pool, path[i], &sequence);
        model->source = &alone;
        scene_model[i] = model;
    }
}

/* Roads are data for their functions alone: no position may lead outside of them. */
static void check_road(const gic_road *road)
{
    static const double place[] = {0, -0.0, 1, -1, 0.37, 50, -1e3, 1e12, -1e12, 1e300, INFINITY, NAN};
    for (size_t i = 0; i < sizeof place / sizeof *place; ++i)
        for (size_t k = 0; k < sizeof place / sizeof *place; ++k) {
            double h[3] = {0};
            road->height(road, 0, 0.1, place[i], place[k], h);
            if (road->friction)
                road->friction(road, 0, 0.1, place[i], place[k]);
        }
}

static void read_scene(const Bytes *input)
{
    Pool *pool = pool_new();
    input_write(input, input->bytes, input->size);
    const Model *model = scene_model[strstr(input->bytes, "rack") != NULL];
    const Scene *scene = scene_read(pool, input->path, model, NULL, 0);
    check(scene->outputs > 0 && scene->duration > 0, "times of a scene");
    if (scene->road)
        check_road(scene->road);
    /* coordinates that the scene drives come after the inputs of the model, three numbers each */
    double *value = pool_alloc(pool, sizeof *value * (size_t)(model->inputs + 3 * scene->driven + 1));
    for (double time = 0; time < 3; time += 0.3)
        scene_inputs((void *)(uintptr_t)scene, 0, time, value);
    scene_next_kink(scene, 0.5);
    for (int i = 0; i < model->coordinates; ++i)
        check(isfinite(scene->value[i]) && isfinite(scene->rate[i]), "initial values");
}

/* The first byte says what kind of a table the rest is. */
static void read_road(const Bytes *input)
{
    Pool *pool = pool_new();
    if (!input->size)
        return;
    input_write(input, input->bytes + 1, input->size - 1);
    Source source = {.path = input->path};
    const Place at = {&source, 0, 0};
    Item file = {.kind = ITEM_SCALAR, .at = at, .text = "file"}, path = file;
    path.text = input->path;
    const Item map = {.kind = ITEM_MAP, .at = at, .count = 1, .key = (Item *[]){&file}, .value = (Item *[]){&path}};
    if (input->bytes[0] == 't')
        check_road(table_file_read(pool, &map));
    else if (input->bytes[0] == 'g')
        check_road(grid_file_read(pool, &map));
    else
        csv_read(pool, input->path, "x", NULL);
}

const Target targets[] = {{"veh", NULL, read_veh},   {"formula", NULL, read_formula},
                          {"tir", NULL, read_tir},   {"scene", prepare_scene, read_scene},
                          {"road", NULL, read_road}, {NULL, NULL, NULL}};
