/* SPDX-License-Identifier: MIT
 * The vehicle of a page in gicrun: what drive_worker.js.in does with it in a browser. */
#include "run/page_vehicle.h"

#include "base/message.h"
#include "run/drive.h"
#include "scene/hands.h"
#include "scene/replay.h"
#include "wasm/wasm.h"

#include <string.h>

/* What places() of templates/drive.c.in tells, in its order. */
enum {
    PARAMETERS,
    TARGETS,
    WANTED,
    POSES,
    OUTPUTS,
    INPUTS,
    STATE,
    DISCRETE,
    ALL,
    ALL_SIZE,
    OWN_INPUTS,
    OWN_STATE,
    OWN_DISCRETE,
    PLACES
};

struct PageVehicle {
    const Scene *scene; /* as --drive has it */
    Wasm *wasm;
    uint32_t place[PLACES];
    int hands, *hand; /* [hands] inputs that the page moves */
    int parameters, look;
    int64_t steps;
};

/* Ends the run: a module that the page has does not do that. */
static _Noreturn void broken(const PageVehicle *page, const char *why)
{
    diag_fail((Place){page->scene->source, 0, 0}, "report it as an error of gicgen", "the page's code stops: %s", why);
}

static WasmCell call(const PageVehicle *page, const char *name)
{
    WasmCell out = {.u64 = 0};
    const char *why = wasm_call(page->wasm, name, &out, 0);
    if (why)
        broken(page, why);
    return out;
}

static unsigned char *memory(const PageVehicle *page, uint32_t at, uint64_t size)
{
    unsigned char *bytes = wasm_memory(page->wasm, at, size);
    if (!bytes)
        broken(page, "its arrays are not in its memory");
    return bytes;
}

static void get_numbers(const PageVehicle *page, int which, int count, double *out)
{
    const unsigned char *from = memory(page, page->place[which], 8 * (uint64_t)count);
    for (int i = 0; i < count; ++i) {
        const uint64_t bits = wasm_load(from + 8 * i, 8);
        memcpy(&out[i], &bits, sizeof bits);
    }
}

static void put_number(const PageVehicle *page, int which, int index, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    wasm_store(memory(page, page->place[which], 8 * ((uint64_t)index + 1)) + 8 * index, 8, bits);
}

static void get_discrete(const PageVehicle *page, int which, int count, int32_t *out)
{
    const unsigned char *from = memory(page, page->place[which], 4 * (uint64_t)count);
    for (int i = 0; i < count; ++i)
        out[i] = (int32_t)(uint32_t)wasm_load(from + 4 * i, 4);
}

/* ---- once -------------------------------------------------------------------------------------------------------- */

static void find_places(PageVehicle *page)
{
    const uint32_t at = call(page, "places").u32;
    for (int i = 0; i < PLACES; ++i)
        page->place[i] = (uint32_t)wasm_load(memory(page, at + 4 * (uint32_t)i, 4), 4);
}

PageVehicle *page_vehicle_new(Pool *pool, const Model *model, const Scene *scene, const Request *request,
                              const char **why, const char **remedy)
{
    PageVehicle *page = pool_alloc(pool, sizeof *page);
    size_t size;
    const char *code = drive_code(pool, model, scene, request, &size, why, remedy);
    if (!code)
        return NULL;
    page->scene = scene;
    page->wasm = wasm_open(pool, code, size, why);
    if (!page->wasm)
        broken(page, *why);
    page->parameters = model->tunables;
    page->look = hands_steps(scene->step);
    for (int i = 0; i < model->inputs; ++i)
        if (!strchr(model->input[i].name, '.'))
            *POOL_PUSH(pool, page->hand, page->hands) = i;
    find_places(page);
    return page;
}

/* The hand of a recording for the page's hand k, or -1. */
static int recorded(const PageVehicle *page, const Replay *replay, int k)
{
    for (int i = 0; i < replay->count; ++i)
        if (replay->hand[i].input == page->hand[k])
            return i;
    return -1;
}

bool page_vehicle_takes(const PageVehicle *page, const Scene *scene)
{
    for (int k = 0; k < page->hands; ++k)
        if (recorded(page, scene->replay, k) < 0)
            return false;
    return true;
}

/* ---- in the run -------------------------------------------------------------------------------------------------- */

/* The instance has the page's time, state and inputs: those of its own vehicle, or of the one that is shown. */
static void follow(const PageVehicle *page, const gic_model *model, gic_head *self, bool shown)
{
    gic_restart(self, call(page, "now").f64);
    get_numbers(page, shown ? STATE : OWN_STATE, model->slow_count + model->fast_count,
                instance_array(self, model->state_offset));
    get_numbers(page, shown ? INPUTS : OWN_INPUTS, model->input_count, instance_array(self, model->input_offset));
    get_discrete(page, shown ? DISCRETE : OWN_DISCRETE, model->discrete_count,
                 (int32_t *)(void *)((char *)self + model->discrete_offset));
}

int page_vehicle_start(const Scene *scene, const gic_model *model, gic_head *self)
{
    PageVehicle *page = scene->page;
    for (int i = 0; i < page->parameters; ++i)
        put_number(page, PARAMETERS, i, scene->parameter[i]);
    wasm_store(memory(page, page->place[WANTED], 4), 4, 0);
    page->steps = 0;
    const int status = call(page, "start").i32;
    self->input_function = NULL;
    follow(page, model, self, false);
    return status;
}

/* What the recording wants from now on. */
static void ask(PageVehicle *page, const Replay *replay)
{
    const int64_t row = page->steps / page->look;
    if (!replay || page->steps % page->look != 0 || row >= replay->rows)
        return;
    wasm_store(memory(page, page->place[WANTED], 4), 4, replay->holds[row]);
    for (int k = 0; k < page->hands; ++k)
        put_number(page, TARGETS, k, replay->value[row * replay->count + recorded(page, replay, k)]);
}

int page_vehicle_step(const Scene *scene, const gic_model *model, gic_head *self)
{
    PageVehicle *page = scene->page;
    ask(page, scene->replay);
    const int status = call(page, "step").i32;
    ++page->steps;
    follow(page, model, self, false);
    /* so that the recovery starts near by where someone looks */
    return status < 0 ? status : model->outputs(self);
}

int page_vehicle_outputs(const Scene *scene, const gic_model *model, const gic_head *self, gic_head *copy)
{
    const PageVehicle *page = scene->page;
    int status = call(page, "show").i32;
    memcpy(copy, self, model->size);
    if (status < 0)
        return status;
    follow(page, model, copy, true);
    copy->grown = -1;
    copy->unchecked = 0;
    status = model->outputs(copy); /* for poses; numbers are the page's */
    get_numbers(page, OUTPUTS, model->output_count, instance_array(copy, model->output_offset));
    return status;
}
