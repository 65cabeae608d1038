/* SPDX-License-Identifier: MIT
 * From model file to callable code: generate in this process, take the object that an earlier run kept, else compile in
 * a private folder, load, keep a copy, tidy up. The folder is gone in any case; the code stays loaded until the program
 * ends. */
#define _GNU_SOURCE /* dl_iterate_phdr */
#include "base/file.h"
#include "base/message.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "engine/object_cache.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "validate/validate.h"
#include "vehicle/vehicle.h"

#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* An error on the way from the texts to loaded code, reported after the folder is removed. */
typedef struct Failure {
    const char *message, *remedy;
} Failure;

typedef struct Build {
    Pool *pool;
    const char *model;           /* its name */
    Text c, h, batch_c, batch_h; /* the last two empty: one vehicle at a time */
    const char **words;          /* compiler and options */
    int count;                   /* of words */
    const char *shelf, *key;     /* folder of kept objects, NULL: none; and the key of this one */
    const char *unkept;          /* why the object is not kept, or NULL */
    size_t real;                 /* bytes of its numbers */
    const char *copy;            /* path for a copy of the object, NULL: none */
    double compiling;            /* s of CPU time of the compiler, 0: not needed */
    const gic_batch_model *batch;
    void *library; /* the loaded object */
    Failure failure;
} Build;

/* Model and runtime as source files. */
static bool put_sources(const Build *b, const char *folder)
{
    Pool *pool = b->pool;
    bool good = folder_put(pool, folder, "model.c", b->c.s, b->c.size) &&
                folder_put(pool, folder, "model.h", b->h.s, b->h.size);
    if (good && b->batch_c.s)
        good = folder_put(pool, folder, "batch.c", b->batch_c.s, b->batch_c.size) &&
               folder_put(pool, folder, "batch.h", b->batch_h.s, b->batch_h.size);
    return good && folder_put_core(pool, folder);
}

/* A key of all that determines the object. */
static const char *build_key(Build *b)
{
    const char **text = NULL;
    int count = 0;
    *POOL_PUSH(b->pool, text, count) = b->c.s;
    *POOL_PUSH(b->pool, text, count) = b->h.s;
    if (b->batch_c.s) {
        *POOL_PUSH(b->pool, text, count) = b->batch_c.s;
        *POOL_PUSH(b->pool, text, count) = b->batch_h.s;
    }
    for (const Embedded *file = embedded; file->name; ++file)
        if (is_core(file))
            *POOL_PUSH(b->pool, text, count) = file->bytes;
    for (int i = 0; i < b->count; ++i)
        *POOL_PUSH(b->pool, text, count) = b->words[i];
    *POOL_PUSH(b->pool, text, count) = compiler_identity(b->pool, b->words, b->count);
    *POOL_PUSH(b->pool, text, count) = NULL;
    return cache_key(b->pool, text);
}

static void object_copy(Pool *pool, const char *from, const char *to)
{
    size_t size;
    const char *bytes = file_read(pool, from, TABLE_MOST, &size);
    file_write(to, bytes, size);
}

/* The descriptor in an object, which stays loaded; NULL: see failure. */
static const gic_model *load(Build *b, const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        b->failure = (Failure){pool_print(b->pool, "the compiled model can't be loaded: %s", dlerror()),
                               "if the folder forbids execution, set TMPDIR to one that allows it"};
        return NULL;
    }
    const gic_model *code = dlsym(library, pool_print(b->pool, "%s_model", b->model));
    b->batch = b->batch_c.s ? dlsym(library, pool_print(b->pool, "%s_batch_model", b->model)) : NULL;
    if (code && code->abi_version == GIC_ABI_VERSION && code->real_size == b->real) {
        if (b->copy)
            object_copy(b->pool, path, b->copy);
        b->library = library;
        return code;
    }
    b->failure = (Failure){pool_print(b->pool, "the compiled model does not fit: %s", gic_status_text(GIC_ERROR_ABI)),
                           "does the compiler command change the number type or the target machine?"};
    dlclose(library);
    return NULL;
}

/* Compile in a folder and load. */
static const gic_model *compile(Build *b, const char *folder)
{
    Pool *pool = b->pool;
    if (!put_sources(b, folder)) {
        b->failure = (Failure){pool_print(pool, "can't write to %s: %s", folder, strerror(errno)),
                               "make room there, or set TMPDIR to another folder"};
        return NULL;
    }
    const char *object = pool_print(pool, "%s/model.so", folder), *said;
    const char *const ours[] = {
        "-o",  object, pool_print(pool, "%s/model.c", folder), pool_print(pool, "%s/gic_runtime.c", folder),
        "-lm", NULL};
    char **argv = NULL;
    int count = 0;
    for (int i = 0; i < b->count; ++i)
        *POOL_PUSH(pool, argv, count) = pool_print(pool, "%s", b->words[i]);
    if (b->batch_c.s)
        *POOL_PUSH(pool, argv, count) = pool_print(pool, "%s/batch.c", folder);
    for (size_t i = 0; i < sizeof ours / sizeof *ours; ++i)
        *POOL_PUSH(pool, argv, count) = ours[i] ? pool_print(pool, "%s", ours[i]) : NULL;
    const double before = cpu_seconds();
    const int status = process_run(pool, argv, "", &said);
    b->compiling = cpu_seconds() - before;
    if (status == PROCESS_INTERRUPTED)
        return NULL;
    if (status == PROCESS_NOT_STARTED) {
        b->failure = (Failure){pool_print(pool, "the C compiler '%s' can't be started: %s", argv[0], said),
                               "install one (Debian: apt-get install gcc libc6-dev), or name yours: --cc, or set CC"};
        return NULL;
    }
    if (status) {
        if (!b->batch_c.s)
            diag_note(said);
        b->failure = (Failure){pool_print(pool, "the C compiler '%s' failed on the generated code (status %d)%s",
                                          argv[0], status, b->batch_c.s ? "" : "; its messages are above"),
                               "is it a C99 compiler with libc headers (Debian: libc6-dev)? Try another one with --cc, "
                               "or other options"};
        return NULL;
    }
    const gic_model *code = load(b, object);
    if (code && b->shelf && !cache_keep(pool, b->shelf, b->key, object, cache_limit()))
        b->unkept = pool_print(pool, "can't write to %s: %s", b->shelf, strerror(errno));
    return code;
}

static const gic_model *compile_privately(Build *b)
{
    const char *folder = folder_make(b->pool);
    if (!folder) {
        b->failure =
            (Failure){pool_print(b->pool, "can't make a folder in %s: %s", temporary_folder(), strerror(errno)),
                      "set TMPDIR to a folder that can be written"};
        return NULL;
    }
    const gic_model *code = compile(b, folder);
    folder_remove(folder);
    return code;
}

/* Load the object of an earlier run; a bad one is removed. */
static const gic_model *take_kept(Build *b)
{
    const char *path = cache_find(b->pool, b->shelf, b->key);
    const gic_model *code = path ? load(b, path) : NULL;
    if (path && !code)
        unlink(path);
    b->failure = (Failure){NULL, NULL};
    return code;
}

typedef struct Extent {
    uintptr_t inside; /* an address */
    size_t bytes;     /* of the object that it is in */
} Extent;

/* A dl_iterate_phdr function: ends at the object with the address. */
static int add_segments(struct dl_phdr_info *info, size_t size, void *context)
{
    Extent *extent = context;
    size_t bytes = 0;
    bool here = false;
    (void)size;
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const ElfW(Phdr) *segment = &info->dlpi_phdr[i];
        if (segment->p_type != PT_LOAD)
            continue;
        bytes += segment->p_memsz;
        here |= extent->inside - (info->dlpi_addr + segment->p_vaddr) < segment->p_memsz;
    }
    if (here)
        extent->bytes = bytes;
    return here;
}

/* Memory of the loaded object. */
static size_t object_bytes(const gic_model *code)
{
    Extent extent = {(uintptr_t)code, 0};
    dl_iterate_phdr(add_segments, &extent);
    return extent.bytes;
}

/* Take the kept object, or compile. NULL: interrupted, or see failure. */
static const gic_model *open_code(Build *b)
{
    interrupt_hold();
    b->shelf = cache_folder(b->pool, &b->unkept);
    b->key = build_key(b);
    const gic_model *code = b->shelf ? take_kept(b) : NULL;
    if (!code)
        code = compile_privately(b);
    interrupt_release();
    return code;
}

static Engine *engine_of(Pool *pool, const Build *b, const EngineOptions *options, const gic_model *code)
{
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = "cc",
                       .code = code,
                       .facts = options->facts,
                       .standard = code->state,
                       .standard_count = code->slow_count + code->fast_count,
                       .compiling = b->compiling,
                       .library = b->library,
                       .bytes = object_bytes(code)};
    return engine;
}

static Build build_new(Pool *pool, const Formulation *formulation, const EngineOptions *options, const char *flags)
{
    Build b = {.pool = pool, .model = formulation->model->name, .copy = options->object};
    b.real = options->single ? sizeof(float) : sizeof(gic_real);
    b.c.pool = b.h.pool = b.batch_c.pool = b.batch_h.pool = pool;
    Style style = style_readable;
    style.implicit = options->implicit;
    style.exponential = options->exponential;
    style.spread = options->spread;
    style.splitting = options->splitting;
    style.exact = options->exact;
    generate(pool, formulation, &style, NULL, "model.h", &b.c, &b.h);
    b.words = compiler_words(pool, options->compiler, build_flags, pool_print(pool, "%s %s", flags, options->flags),
                             &b.count);
    return b;
}

static const Formulation *formulation_of(Pool *pool, const Model *model, const EngineOptions *options)
{
    const Sequence *sequence = sequence_find(pool, model);
    const Formulation *f = formulate_narrow(pool, model_assemble(pool, model, sequence), sequence, options->solve,
                                            options->recovery, options->facts);
    if (options->lanes)
        f = formulation_lanes(pool, f, options->lanes);
    formulation_validate(pool, f, options->validation);
    return f;
}

static void check_command(const EngineOptions *options)
{
    if (!options->compiler[strspn(options->compiler, " \t")])
        diag_fail(program_place(), "name it: --cc gcc, or set CC", "the compiler command is empty");
}

const Engine *engine_cc(Pool *pool, const Model *model, const EngineOptions *options)
{
    check_command(options);
    Build b = build_new(pool, formulation_of(pool, model, options), options, "");
    const gic_model *code = open_code(&b);
    if (!code)
        diag_fail(program_place(), b.failure.remedy, "%s", b.failure.message);
    if (b.unkept && !options->quiet)
        diag_note(pool_print(pool, "%s: note: the compiled model is not kept for the next run: %s\n",
                             program_place().source->path, b.unkept));
    return engine_of(pool, &b, options, code);
}

const Engine *engine_batch(Pool *pool, const Model *model, const EngineOptions *options, const Batch *batch,
                           const char *flags, const gic_batch_model **many, const char **why)
{
    check_command(options);
    const Formulation *formulation = formulation_of(pool, model, options);
    *why = batch_missing(formulation);
    if (*why) {
        *why = pool_print(pool, "it can't have %s yet", *why);
        return NULL;
    }
    Build b = build_new(pool, formulation, options, flags);
    generate_batch(pool, formulation, batch, NULL, "model.h", "batch.h", &b.batch_c, &b.batch_h);
    const gic_model *code = open_code(&b);
    *many = b.batch;
    *why = b.failure.message ? b.failure.message : "interrupted, or not in the object";
    return code && b.batch ? engine_of(pool, &b, options, code) : NULL;
}
