/* SPDX-License-Identifier: MIT
 * From model file to callable code: generate in this process, compile in a private folder, load, tidy up. The folder is
 * gone in any case; the code stays loaded until the program ends. */
#include "gicrun.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool put(Pool *pool, const char *folder, const char *name, const char *bytes, size_t size)
{
    FILE *file = fopen(pool_print(pool, "%s/%s", folder, name), "wb");
    if (!file)
        return false;
    bool written = fwrite(bytes, 1, size, file) == size;
    return !fclose(file) && written;
}

static void remove_folder(Pool *pool, const char *folder)
{
    DIR *listing = opendir(folder);
    if (!listing)
        return;
    for (struct dirent *entry; (entry = readdir(listing));)
        if (entry->d_name[0] != '.')
            unlink(pool_print(pool, "%s/%s", folder, entry->d_name));
    closedir(listing);
    rmdir(folder);
}

/* Model and runtime as source files. */
static bool put_sources(Pool *pool, const char *folder, const Text *c, const Text *h)
{
    bool good = put(pool, folder, "model.c", c->s, c->size) && put(pool, folder, "model.h", h->s, h->size);
    for (const Embedded *file = embedded; good && file->name; ++file)
        if (!strncmp(file->name, "gic_runtime.", strlen("gic_runtime.")))
            good = put(pool, folder, file->name, file->bytes, file->size);
    return good;
}

const char build_flags[] = "-std=c99 -O2 -fPIC -shared -ffp-contract=off -fno-math-errno";

/* Words of the compiler command (a user may add options), then ours. */
static char *const *compiler_command(Pool *pool, const char *compiler, const char *folder)
{
    const char *const ours[] = {
        "-o", pool_print(pool, "%s/model.so", folder),
        pool_print(pool, "%s/model.c", folder), pool_print(pool, "%s/gic_runtime.c", folder), "-lm",
    };
    char **argv = NULL, *rest;
    int count = 0;
    char *word = strtok_r(pool_print(pool, "%s %s", compiler, build_flags), " \t", &rest);
    for (; word; word = strtok_r(NULL, " \t", &rest))
        *POOL_PUSH(pool, argv, count) = word;
    for (size_t i = 0; i < sizeof ours / sizeof *ours; ++i)
        *POOL_PUSH(pool, argv, count) = pool_print(pool, "%s", ours[i]);
    *POOL_PUSH(pool, argv, count) = NULL;
    return argv;
}

/* What went wrong between the two texts and loaded code, to be told once the folder is gone. */
typedef struct Failure {
    const char *message, *remedy;
} Failure;

static void *compile_and_load(Pool *pool, const char *folder, const char *compiler, const Text *c, const Text *h,
                              Failure *failure)
{
    if (!put_sources(pool, folder, c, h)) {
        *failure = (Failure){pool_print(pool, "can't write to %s: %s", folder, strerror(errno)),
                             "make room there, or set TMPDIR to another folder"};
        return NULL;
    }
    char *const *argv = compiler_command(pool, compiler, folder);
    const char *said;
    int status = process_run(pool, argv, "", &said);
    if (status == PROCESS_INTERRUPTED)
        return NULL;
    if (status == PROCESS_NOT_STARTED) {
        *failure = (Failure){pool_print(pool, "the C compiler '%s' can't be started: %s", argv[0], said),
                             "install one (Debian: apt-get install gcc libc6-dev), or name yours: --cc, or set CC"};
        return NULL;
    }
    if (status) {
        fputs(said, stderr);
        *failure = (Failure){pool_print(pool, "the C compiler '%s' failed on the generated code (status %d); its "
                                              "messages are above", argv[0], status),
                             "is it a C99 compiler with libc headers (Debian: libc6-dev)? Try another one with --cc"};
        return NULL;
    }
    void *library = dlopen(pool_print(pool, "%s/model.so", folder), RTLD_NOW | RTLD_LOCAL);
    if (!library)
        *failure = (Failure){pool_print(pool, "the compiled model can't be loaded: %s", dlerror()),
                             "if the folder forbids execution, set TMPDIR to one that allows it"};
    return library;
}

const Engine *engine_cc(Pool *pool, const Model *model, const EngineOptions *options)
{
    Text c = {.pool = pool}, h = {.pool = pool};
    if (!options->compiler[strspn(options->compiler, " \t")])
        diag_fail(gicrun_place, "name it: --cc gcc, or set CC", "the compiler command is empty");
    const Sequence *sequence = sequence_find(pool, model);
    const Formulation *formulation = formulate(pool, model_assemble(pool, model, sequence), sequence, options->solve);
    generate(pool, formulation, NULL, "model.h", &c, &h);

    interrupt_hold();
    char *folder = pool_print(pool, "%s/gicrun-XXXXXX", temporary_folder());
    Failure failure = {NULL, NULL};
    void *library = NULL;
    if (mkdtemp(folder)) {
        library = compile_and_load(pool, folder, options->compiler, &c, &h, &failure);
        remove_folder(pool, folder);
    } else {
        failure = (Failure){pool_print(pool, "can't make a folder in %s: %s", temporary_folder(), strerror(errno)),
                            "set TMPDIR to a folder that can be written"};
    }
    interrupt_release();
    if (failure.message)
        diag_fail(gicrun_place, failure.remedy, "%s", failure.message);

    const gic_model *code = dlsym(library, pool_print(pool, "%s_model", model->name));
    if (!code || code->abi_version != GIC_ABI_VERSION || code->real_size != sizeof(gic_real))
        diag_fail(gicrun_place, "does the compiler command change the number type or the target machine?",
                  "the compiled model does not fit: %s", gic_status_text(GIC_ERROR_ABI));
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = "cc", .code = code, .standard = code->state, .standard_count = code->slow_count};
    return engine;
}
