/* SPDX-License-Identifier: MIT
 * Models of the library: read at once, compiled when first needed. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "host/gic.h"
#include "library/library_private.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/stiff_states.h"
#include "scene/scene.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "validate/validate.h"
#include "vehicle/vehicle.h"

#include <dlfcn.h>
#include <string.h>

/* ---- words ---------------------------------------------------------------------------------------------------- */

const char *gicl_word(const char *member, int index)
{
    if (!member || index < 0)
        return NULL;
    if (!strcmp(member, "solve"))
        return index < SOLVES ? solve_name[index] : NULL;
    if (!strcmp(member, "recovery"))
        return index < RECOVERY_POLYNOMIAL ? recovery_name[index] : NULL; /* it is the last one, for gicgen alone */
    if (!strcmp(member, "integrator"))
        return integrator_word(index);
    int i = 0;
    while (i < index && engine_name[i])
        ++i;
    return !strcmp(member, "engine") ? engine_name[i] : NULL;
}

/* ---- opening ------------------------------------------------------------------------------------------------ */

typedef struct Opening {
    const char *path, *text; /* text: NULL: the file has it */
    size_t size;
    const gicl_options *options;
    OpenModel *model;
} Opening;

static const char *kept(Pool *pool, const char *text, const char *absent)
{
    return pool_print(pool, "%s", text && *text ? text : absent);
}

/* Engines of instances: they have the state of FORMAT.md section 10 itself, and change no code while they run. */
static const char *const engines[] = {"tcc", "cc", "tape"};

static _Noreturn void option_fail(const char *option, const char *word, const char *words)
{
    static const Source library = {.path = "libgic"};
    diag_fail((Place){&library, 0, 0}, words, "the option %s can't be '%s'", option, word);
}

static void take_options(OpenModel *model, const gicl_options *given)
{
    static const gicl_options none = {.size = sizeof none};
    Pool *pool = model->pool;
    const gicl_options *o = given ? given : &none;
    model->engine_name = kept(pool, o->engine, engines[0]);
    if (!engine_known(model->engine_name))
        option_fail("engine", model->engine_name, "one of tcc, cc, tape, auto, gic, gcp1, gcp2, page");
    if (o->lanes && strcmp(model->engine_name, "cc") != 0)
        option_fail("lanes", pool_print(pool, "%d", o->lanes), "0, or the engine cc");
    if (o->lanes && !lanes_of(pool_print(pool, "%d", o->lanes)))
        option_fail("lanes", pool_print(pool, "%d", o->lanes), "one of 0, 2, 4, 8, 16");
    model->options = (EngineOptions){.solve = solve_of(kept(pool, o->solve, "auto")),
                                     .recovery = recovery_of(kept(pool, o->recovery, "auto")),
                                     .lanes = o->lanes,
                                     .compiler = kept(pool, o->compiler, compiler_default()),
                                     .flags = kept(pool, o->flags, ""),
                                     .quiet = true};
    if (model->options.solve == SOLVES)
        option_fail("solve", o->solve, "one of auto, reduced, articulated, augmented");
    if (model->options.recovery >= RECOVERY_POLYNOMIAL)
        option_fail("recovery", o->recovery, "one of auto, newton, closed");
    if (o->integrator && integrator_method(o->integrator) < 0)
        option_fail("integrator", o->integrator, "one of ab3, rk4, ros2, ros3, imex, exp3, adams, rkck, bdf, auto");
    model->integrator = o->integrator ? kept(pool, o->integrator, "") : NULL;
    model->tolerance = o->tolerance;
    if (o->tolerance != 0 && !tolerance_known(o->tolerance))
        option_fail("tolerance", pool_print(pool, "%g", o->tolerance), "a number between 1e-13 and 0.1");
    model->general = o->general;
}

static void open_model(void *context)
{
    Opening *opening = context;
    Pool *pool = pool_new();
    OpenModel *model = pool_alloc(pool, sizeof *model);
    model->pool = pool;
    take_options(model, opening->options);
    model->name = pool_print(pool, "%s", opening->path);
    if (opening->text) {
        char *text = pool_alloc(pool, opening->size + 1);
        memcpy(text, opening->text, opening->size);
        model->model = model_read_text(pool, model->name, text, opening->size);
    } else
        model->model = model_read(pool, model->name);
    opening->model = model;
}

static int finish_opening(gicl_library *library, Opening *opening, gicl_handle *handle, gicl_messages *said)
{
    const int status = call_work(library, said, open_model, opening);
    if (status != GICL_OK)
        return status;
    OpenModel *model = opening->model;
    pthread_mutex_init(&model->lock, NULL);
    atomic_init(&model->users, 1);
    atomic_flag_clear(&model->taken);
    *handle = handle_new(library, THING_MODEL, model);
    if (*handle)
        return GICL_OK;
    model_let(model);
    return call_wrong(said, NULL, "no memory for another handle");
}

static int check_opening(const gicl_library *library, const void *given, const gicl_options *options,
                         gicl_handle *handle, gicl_messages *said)
{
    call_begin(library, said);
    if (handle)
        *handle = 0;
    if (!library || !given || !handle)
        return call_wrong(said, NULL, "library, model and the place for the handle must not be NULL");
    if (options && options->size != sizeof *options)
        return call_wrong(said, "set size to sizeof(gicl_options), and compile with the library's own gic.h",
                          "the options have %zu bytes, not %zu", options->size, sizeof *options);
    return GICL_OK;
}

int gicl_model_open(gicl_library *library, const char *path, const gicl_options *options, gicl_handle *handle,
                    gicl_messages *said)
{
    const int status = check_opening(library, path, options, handle, said);
    if (status == GICL_OK && !strcmp(path, "-"))
        return call_wrong(said, "read it and call gicl_model_text()", "the model must be a file");
    return status == GICL_OK ? finish_opening(library, &(Opening){.path = path, .options = options}, handle, said)
                             : status;
}

int gicl_model_text(gicl_library *library, const char *name, const char *text, size_t size, const gicl_options *options,
                    gicl_handle *handle, gicl_messages *said)
{
    const int status = check_opening(library, name ? text : NULL, options, handle, said);
    Opening opening = {.path = name, .text = text, .size = size, .options = options};
    return status == GICL_OK ? finish_opening(library, &opening, handle, said) : status;
}

void model_keep(OpenModel *model)
{
    atomic_fetch_add(&model->users, 1);
}

void model_let(void *let)
{
    OpenModel *model = let;
    if (atomic_fetch_sub(&model->users, 1) > 1)
        return;
    if (model->engine) {
        engine_close(model->engine);
        if (model->engine->library)
            dlclose(model->engine->library);
        pool_free(model->engine_pool);
    }
    if (model->code_pool)
        pool_free(model->code_pool);
    pthread_mutex_destroy(&model->lock);
    pool_free(model->pool);
}

/* ---- models of calls ------------------------------------------------------------------------------------------ */

typedef struct Again {
    Pool *pool;
    const Model *earlier, *model;
} Again;

static void read_again(void *context)
{
    Again *again = context;
    again->model = model_read_again(again->pool, again->earlier);
}

/* Validation and limits try other parameters on the formulas of tunable geometry, and analyses add to them: so each
 * call has a model of its own, from the bytes that the open one was read from. Its warnings were said then. */
const Model *model_for(const OpenModel *open, Pool *pool)
{
    Again again = {pool, open->model, open->model};
    Messages said = {NULL, NULL, NULL};
    if (!open->model->tuning)
        return open->model;
    const bool good = caught(&said, read_again, &again);
    for (const Message *message = good ? NULL : said.first; message; message = message->next)
        caught_tell(message);
    messages_clear(&said);
    if (!good)
        caught_fail();
    return again.model;
}

const Model *model_once(OpenModel *open, Pool *pool)
{
    return atomic_flag_test_and_set(&open->taken) ? model_for(open, pool) : open->model;
}

/* ---- code --------------------------------------------------------------------------------------------------- */

bool model_implicit(const OpenModel *model)
{
    return model->integrator && method_implicit(integrator_method(model->integrator));
}

const Engine *model_code(const OpenModel *model, Pool *pool, const Scene *wanted)
{
    const char *name = strcmp(model->engine_name, "auto") != 0 ? model->engine_name : engines[0];
    bool own = false;
    for (size_t i = 0; i < sizeof engines / sizeof *engines; ++i)
        own = own || !strcmp(name, engines[i]);
    if (!own)
        option_fail("engine", name, "for instances and batches one of tcc, cc, tape");
    EngineOptions options = model->options;
    options.lanes = 0; /* of runs alone */
    options.implicit = model_implicit(model) && engine_has_implicit(name);
    options.exponential = options.implicit && integrator_method(model->integrator) == GIC_EXP3;
    options.spread = options.implicit && wanted && wanted->spread;
    const Model *own_model = model_for(model, pool);
    if (options.implicit && wanted)
        options.splitting = scene_splitting(pool, own_model, wanted, options.solve, options.recovery);
    return engine_open(pool, name, own_model, &options);
}

static void open_engine(void *context)
{
    OpenModel *model = context;
    Pool *pool = pool_new();
    model->engine = model_code(model, pool, NULL);
    model->engine_pool = pool;
}

int model_engine(const gicl_library *library, OpenModel *model, gicl_messages *said)
{
    pthread_mutex_lock(&model->lock);
    const int status = model->engine ? GICL_OK : call_work(library, said, open_engine, model);
    if (status != GICL_OK)
        model->engine = NULL;
    pthread_mutex_unlock(&model->lock);
    return status;
}

void model_enter(OpenModel *model)
{
    if (model->engine->context)
        pthread_mutex_lock(&model->lock);
}

void model_leave(OpenModel *model)
{
    if (model->engine->context)
        pthread_mutex_unlock(&model->lock);
}

static void generate_code(void *context)
{
    OpenModel *open = context;
    Pool *pool = pool_new();
    Text c = {.pool = pool}, h = {.pool = pool};
    const Model *own = model_for(open, pool);
    const Sequence *sequence = sequence_find(pool, own);
    const Model *model = model_assemble(pool, own, sequence);
    const Formulation *formulation = formulate(pool, model, sequence, open->options.solve, open->options.recovery);
    formulation_validate(pool, formulation, NULL);
    generate(pool, formulation, &style_readable, NULL, pool_print(pool, "%s.h", model->name), &c, &h);
    open->c = c.s;
    open->h = h.s;
    open->code_pool = pool;
}

int gicl_generate(gicl_library *library, gicl_handle handle, const char **c, const char **h, gicl_messages *said)
{
    const Use use = use_begin(library, handle, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!c || !h)
        return use_end(&use, call_wrong(said, NULL, "the places for the texts must not be NULL"));
    OpenModel *model = use.thing;
    pthread_mutex_lock(&model->lock);
    const int status = model->c ? GICL_OK : call_work(library, said, generate_code, model);
    *c = model->c;
    *h = model->h;
    pthread_mutex_unlock(&model->lock);
    return use_end(&use, status);
}

/* ---- names -------------------------------------------------------------------------------------------------- */

const gic_signal *model_signals(const gic_model *code, int kind, int *count, size_t *offset)
{
    const struct {
        const gic_signal *signal;
        int count;
        size_t offset;
    } of[GICL_KINDS] = {
        [GICL_STATE] = {code->state, code->slow_count + code->fast_count, code->state_offset},
        [GICL_RATE] = {code->state, code->slow_count + code->fast_count, code->rate_offset},
        [GICL_INPUT] = {code->input, code->input_count, code->input_offset},
        [GICL_OUTPUT] = {code->output, code->output_count, code->output_offset},
        [GICL_PARAMETER] = {code->parameter, code->parameter_count, code->parameter_offset},
        [GICL_PORT] = {code->port, code->port_count, code->port_offset},
    };
    static const gic_signal none[1];
    if (kind < 0 || kind >= GICL_KINDS)
        return NULL;
    *count = of[kind].count;
    if (offset)
        *offset = of[kind].offset;
    return of[kind].signal ? of[kind].signal : none;
}

/* Begin a call about names; *signal: of that kind. */
static Use names_begin(gicl_library *library, gicl_handle handle, int kind, const gic_signal **signal, int *count,
                       gicl_messages *said)
{
    Use use = use_begin(library, handle, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use;
    OpenModel *model = use.thing;
    use.status = kind >= 0 && kind < GICL_KINDS
                     ? model_engine(library, model, said)
                     : call_wrong(said, "kinds are GICL_STATE to GICL_PORT", "there is no kind %d", kind);
    if (use.status == GICL_OK)
        *signal = model_signals(model->engine->code, kind, count, NULL);
    if (use.status != GICL_OK)
        use_end(&use, use.status);
    return use;
}

int gicl_count(gicl_library *library, gicl_handle model, int kind, int *count, gicl_messages *said)
{
    const gic_signal *signal = NULL;
    int found;
    const Use use = names_begin(library, model, kind, &signal, &found, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!count)
        return use_end(&use, call_wrong(said, NULL, "the place for the number must not be NULL"));
    *count = found;
    return use_end(&use, GICL_OK);
}

int gicl_signal(gicl_library *library, gicl_handle model, int kind, int index, const char **name, const char **unit,
                gicl_messages *said)
{
    const gic_signal *signal = NULL;
    int count;
    const Use use = names_begin(library, model, kind, &signal, &count, said);
    if (use.status != GICL_OK)
        return use.status;
    if (index < 0 || index >= count)
        return use_end(&use, call_wrong(said, NULL, "there is no number %d among %d", index, count));
    if (name)
        *name = signal[index].name;
    if (unit)
        *unit = signal[index].unit;
    return use_end(&use, GICL_OK);
}

typedef struct Seeking {
    const gic_signal *signal;
    int count, kind, index;
    const char *name;
    gicl_messages *said;
} Seeking;

static void seek(void *context)
{
    static const char *const kind_name[GICL_KINDS] = {"state", "state", "input", "output", "parameter", "port"};
    static const Source library = {.path = "libgic"};
    Seeking *s = context;
    for (s->index = 0; s->index < s->count; ++s->index)
        if (!strcmp(s->signal[s->index].name, s->name))
            return;
    Pool *pool = pool_new();
    const char **name = pool_alloc(pool, sizeof *name * (size_t)(s->count + 1));
    Text all = {.pool = pool};
    for (int i = 0; i < s->count; ++i) {
        name[i] = s->signal[i].name;
        text_print(&all, "%s%s", i ? ", " : "", name[i]);
    }
    const char *nearest = diag_nearest(s->name, name, s->count);
    const char *remedy = nearest    ? pool_print(pool, "is '%s' meant?", nearest)
                         : s->count ? pool_print(pool, "it has %s", all.s)
                                    : "it has none";
    diag_fail((Place){&library, 0, 0}, remedy, "the model has no %s '%s'", kind_name[s->kind], s->name);
}

int gicl_find(gicl_library *library, gicl_handle model, int kind, const char *name, int *index, gicl_messages *said)
{
    Seeking seeking = {.name = name, .kind = kind};
    const Use use = names_begin(library, model, kind, &seeking.signal, &seeking.count, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!name || !index)
        return use_end(&use, call_wrong(said, NULL, "the name and the place for its number must not be NULL"));
    if (call_work(library, said, seek, &seeking) != GICL_OK)
        return use_end(&use, GICL_WRONG);
    *index = seeking.index;
    return use_end(&use, GICL_OK);
}
