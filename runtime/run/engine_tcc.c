/* SPDX-License-Identifier: MIT
 * The engine `tcc`: generated code compiled by libtcc into memory of this process. It takes no file and no compiler,
 * and some milliseconds; the code is about half as fast as an optimizing compiler's, with the same bits. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/engines.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "tape/tape.h"
#include "validate/validate.h"
#include "vehicle/vehicle.h"

#include <errno.h>
#include <libtcc.h>
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/mman.h>

/* Compiled code and its pages. Upstream's libtcc allocates memory and keeps it with its state; that of Debian 12 makes
 * pages of the heap executable, and ends the program if it may not. */
typedef struct Jit {
    TCCState *state; /* NULL: freed */
    void *pages;     /* NULL: they belong to the state */
    bool inside;     /* libtcc is at work for it */
    size_t size;
} Jit;

/* ---- the text ------------------------------------------------------------------------------------------------- */

typedef struct Sources {
    const char *runtime;
    const Text *h, *c;
} Sources;

/* The text without its includes, since there are no files. */
static void add_without_includes(Text *out, const char *source)
{
    static const char include[] = "#include";
    for (const char *line = source, *end; *line; line = end) {
        end = line + strcspn(line, "\n");
        end += *end != 0;
        if (strncmp(line, include, strlen(include)))
            text_add(out, line, (size_t)(end - line));
    }
}

static void write_runtime(void *context, Text *out, int indent)
{
    const Sources *sources = context;
    (void)indent;
    add_without_includes(out, sources->runtime);
}

static void write_header(void *context, Text *out, int indent)
{
    const Sources *sources = context;
    (void)indent;
    add_without_includes(out, sources->h->s);
}

static void write_code(void *context, Text *out, int indent)
{
    const Sources *sources = context;
    (void)indent;
    add_without_includes(out, sources->c->s);
}

static const Insertion jit_point[] = {
    {"runtime", write_runtime}, {"header", write_header}, {"code", write_code}, {NULL, NULL}};

static const Insertions jit_points = {(const char *const[]){"jit.c.in", NULL}, jit_point, NULL};

static const char *jit_text(Pool *pool, const Model *model, const EngineOptions *options)
{
    Text c = {.pool = pool}, h = {.pool = pool}, text = {.pool = pool};
    Sources sources = {.h = &h, .c = &c};
    for (const Embedded *file = embedded; file->name; ++file)
        if (!strcmp(file->name, "gic_runtime.h"))
            sources.runtime = file->bytes;
    const Sequence *sequence = sequence_find(pool, model);
    const Formulation *formulation = formulate_narrow(pool, model_assemble(pool, model, sequence), sequence,
                                                      options->solve, options->recovery, options->facts);
    formulation_validate(pool, formulation, options->validation);
    Style style = style_direct;
    style.implicit = options->implicit;
    style.exponential = options->exponential;
    style.spread = options->spread;
    style.splitting = options->splitting;
    style.exact = options->exact;
    generate(pool, formulation, &style, NULL, NULL, &c, &h);
    templates_check(pool, NULL, (const Insertions *const[]){&jit_points, NULL});
    template_expand(pool, &text, NULL, "jit.c.in", model->name, NULL, &jit_points, &sources);
    return text.s;
}

/* ---- compilation ------------------------------------------------------------------------------------------------ */

/* A function's address for tcc_add_symbol; C knows no way from a function's pointer to an object's but by a number. */
/* clang-format off */
#define HOST_FUNCTION(name) {#name, (uintptr_t)(name)}
/* clang-format on */

static void add_host_functions(TCCState *state)
{
    const struct {
        const char *name;
        uintptr_t address;
    } function[] = {
        HOST_FUNCTION(memset),
        HOST_FUNCTION(memcpy),
        HOST_FUNCTION(memmove),
        HOST_FUNCTION(sqrt),
        HOST_FUNCTION(fabs),
        HOST_FUNCTION(sin),
        HOST_FUNCTION(cos),
        HOST_FUNCTION(tan),
        HOST_FUNCTION(asin),
        HOST_FUNCTION(acos),
        HOST_FUNCTION(atan),
        HOST_FUNCTION(atan2),
        HOST_FUNCTION(exp),
        HOST_FUNCTION(log),
        HOST_FUNCTION(tanh),
        HOST_FUNCTION(pow),
        HOST_FUNCTION(gic_status_text),
        HOST_FUNCTION(gic_finite),
        HOST_FUNCTION(gic_bounded),
        HOST_FUNCTION(gic_unwound),
        HOST_FUNCTION(gic_step),
        HOST_FUNCTION(gic_time),
        HOST_FUNCTION(gic_orientation),
        HOST_FUNCTION(gic_table_value),
        HOST_FUNCTION(gic_restart),
        HOST_FUNCTION(gic_rates_match),
        HOST_FUNCTION(gic_road_bend),
        HOST_FUNCTION(gic_road_friction_slope),
    };
    for (size_t i = 0; i < sizeof function / sizeof *function; ++i)
        tcc_add_symbol(state, function[i].name, (const void *)function[i].address);
}

/* A tcc error function: `said` is a Text. */
static void collect(void *said, const char *message)
{
    text_print(said, "%s%s", ((Text *)said)->size ? "; " : "", message);
}

/* Define the errors that tests plant. */
static void plant(TCCState *state)
{
    (void)state;
#define PLANT_TEXT(x) #x
#define PLANT_VALUE(x) PLANT_TEXT(x)
#ifdef GIC_PLANT_MOTION
    tcc_define_symbol(state, "GIC_PLANT_MOTION", PLANT_VALUE(GIC_PLANT_MOTION));
#endif
#ifdef GIC_PLANT_RATE
    tcc_define_symbol(state, "GIC_PLANT_RATE", PLANT_VALUE(GIC_PLANT_RATE));
#endif
}

/* Executable pages, or NULL with errno where the system refuses them. */
static void *executable_pages(size_t size)
{
    void *pages = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED)
        return NULL;
    if (!mprotect(pages, size, PROT_READ | PROT_WRITE | PROT_EXEC))
        return pages;
    const int error = errno;
    munmap(pages, size);
    errno = error;
    return NULL;
}

/* Put the compiled code into executable memory. 0: done, -1: tcc failed, 1: the system refuses. */
static int place(Jit *jit)
{
#ifdef TCC_RELOCATE_AUTO
    const int size = tcc_relocate(jit->state, NULL);
    if (size < 0)
        return -1;
    jit->size = (size_t)size;
    jit->pages = executable_pages(jit->size);
    if (!jit->pages)
        return 1;
    return tcc_relocate(jit->state, jit->pages);
#else
    void *probe = executable_pages(1);
    if (!probe)
        return 1;
    munmap(probe, 1);
    return tcc_relocate(jit->state);
#endif
}

/* libtcc compiles for one thread at a time. */
static pthread_mutex_t at_work = PTHREAD_MUTEX_INITIALIZER;

static void jit_enter(Jit *jit)
{
    pthread_mutex_lock(&at_work);
    jit->inside = true;
}

static void jit_leave(Jit *jit)
{
    jit->inside = false;
    pthread_mutex_unlock(&at_work);
}

static void jit_free(void *freed)
{
    Jit *jit = freed;
    if (!jit->inside)
        jit_enter(jit);
    if (jit->state)
        tcc_delete(jit->state);
    jit_leave(jit);
    if (jit->pages)
        munmap(jit->pages, jit->size);
}

static void jit_close(const Engine *engine)
{
    caught_disown(engine->memory);
    jit_free(engine->memory);
}

const Engine *engine_tcc(Pool *pool, const Model *model, const EngineOptions *options)
{
    const char *text = jit_text(pool, model, options);
    Text said = {.pool = pool};
    Jit *jit = pool_alloc(pool, sizeof *jit);
    const double before = cpu_seconds();
    caught_own(jit_free, jit);
    jit_enter(jit);
    jit->state = tcc_new();
    if (!jit->state)
        diag_fail(program_place(), NULL, "no memory for tcc");
    tcc_set_error_func(jit->state, &said, collect);
    tcc_set_options(jit->state, "-nostdlib -nostdinc");
    tcc_set_output_type(jit->state, TCC_OUTPUT_MEMORY);
    add_host_functions(jit->state);
    plant(jit->state);
    const int status = tcc_compile_string(jit->state, text) ? -1 : place(jit);
    const int reason = errno;
    jit_leave(jit);
    if (status < 0)
        diag_fail(program_place(), "use another engine: --engine cc or --engine tape",
                  "tcc can't compile the generated code: %s", said.s ? said.s : "it does not say why");
    if (status) {
        if (!options->quiet)
            diag_note(pool_print(pool,
                                 "%s: note: the system refuses executable memory (%s), so the model is interpreted\n",
                                 program_place().source->path, strerror(reason)));
        caught_disown(jit);
        jit_free(jit);
        return engine_tape(pool, model, options);
    }
    const gic_model *code = tcc_get_symbol(jit->state, pool_print(pool, "%s_model", model->name));
    if (jit->pages) { /* the state is no longer needed */
        jit_enter(jit);
        tcc_delete(jit->state);
        jit->state = NULL;
        jit_leave(jit);
    }
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = "tcc",
                       .code = code,
                       .facts = options->facts,
                       .compiling = cpu_seconds() - before,
                       .bytes = jit->size,
                       .memory = jit,
                       .standard = code->state,
                       .standard_count = code->slow_count + code->fast_count,
                       .close = jit_close};
    return engine;
}
