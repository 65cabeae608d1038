/* SPDX-License-Identifier: MIT
 * The vehicle of a page of --drive as WebAssembly: generated code for any scene, the runtime core, roads, driver and
 * hands, compiled by clang for a machine without a system. */
#include "base/file.h"
#include "base/message.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "host/host.h"
#include "run/drive.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "validate/validate.h"
#include "vehicle/vehicle.h"

#include <errno.h>
#include <string.h>

/* What is compiled with it, among the embedded files. */
static const char *const part[] = {"gic_runtime.h",  "gic_runtime.c", "gic_road.h", "gic_road.c", "profile_form.h",
                                   "profile_form.c", "driver.h",      "driver.c",   "hands.h",    "hands.c",
                                   "knot_cross.h",   "knot_cross.c",  NULL};

typedef struct Build {
    Pool *pool;
    const Model *model;
    const Scene *scene;
    Text c, h, drive;
    const char *message, *remedy; /* why it failed, reported after the folder is removed */
    const char *code;
    size_t size;
} Build;

static void write_scene(void *context, Text *out, int indent)
{
    const Build *b = context;
    (void)indent;
    drive_scene(out, b->model, b->scene);
}

static const Insertion drive_point[] = {{"scene", write_scene}, {NULL, NULL}};
static const Insertions drive_points = {(const char *const[]){"drive.c.in", NULL}, drive_point, NULL};

static bool put_sources(Build *b, const char *folder)
{
    bool good = folder_put(b->pool, folder, "model.c", b->c.s, b->c.size) &&
                folder_put(b->pool, folder, "model.h", b->h.s, b->h.size) &&
                folder_put(b->pool, folder, "drive.c", b->drive.s, b->drive.size);
    for (int i = 0; good && part[i]; ++i) {
        const Source *source = template_source(b->pool, NULL, part[i]);
        good = folder_put(b->pool, folder, part[i], source->bytes, source->size);
    }
    return good;
}

/* Run clang in the folder, with words of ours and files; false: it failed, see message. */
static bool clang(Build *b, const char *folder, const char *words, const char *const *files)
{
    int count;
    const char **all = compiler_words(b->pool, "clang", words, "", &count), *said;
    char **argv = NULL;
    int words_count = 0;
    for (int i = 0; i < count; ++i)
        *POOL_PUSH(b->pool, argv, words_count) = pool_print(b->pool, "%s", all[i]);
    for (; *files; ++files)
        *POOL_PUSH(b->pool, argv, words_count) = pool_print(b->pool, "%s/%s", folder, *files);
    *POOL_PUSH(b->pool, argv, words_count) = NULL;
    const int status = process_run(b->pool, argv, "", &said);
    if (!status)
        return true;
    b->remedy = "install clang, its linker and a C library for WebAssembly (Debian: apt-get install clang lld "
                "wasi-libc libclang-rt-dev-wasm32)";
    b->message = status == PROCESS_NOT_STARTED ? pool_print(b->pool, "clang can't be started: %s", said)
                 : status == PROCESS_INTERRUPTED
                     ? "interrupted"
                     : pool_print(b->pool, "clang can't compile for WebAssembly: %.*s", (int)strcspn(said, "\n"), said);
    return false;
}

/* What clang would compute of constants by the C library of its own machine, or replace. */
#define FUNCTIONS_OF_MUSL \
    " -fno-builtin-sin -fno-builtin-cos -fno-builtin-tan -fno-builtin-asin -fno-builtin-acos -fno-builtin-atan" \
    " -fno-builtin-atan2 -fno-builtin-exp -fno-builtin-log -fno-builtin-pow -fno-builtin-tanh" \
    " -fno-builtin-hypot -fno-builtin-expm1"

/* One object at a time, and linked without options that optimize: clang would hand the module to a wasm-opt of any age.
 */
static void compile(Build *b, const char *folder)
{
    static const char compiling[] =
        "--target=wasm32-wasi -std=c11 -O2 -ffp-contract=off -fno-math-errno" FUNCTIONS_OF_MUSL " -c -o";
    static const char *const source[] = {"model",        "drive",  "gic_runtime", "gic_road",
                                         "profile_form", "driver", "hands",       "knot_cross"};
    enum { SOURCES = sizeof source / sizeof *source };
    const char *object[SOURCES + 1] = {NULL};
    if (!put_sources(b, folder)) {
        b->message = pool_print(b->pool, "can't write to %s: %s", folder, strerror(errno));
        b->remedy = "make room there, or set TMPDIR to another folder";
        return;
    }
    for (int i = 0; i < SOURCES; ++i) {
        object[i] = pool_print(b->pool, "%s.o", source[i]);
        const char *files[] = {pool_print(b->pool, "%s.c", source[i]), NULL};
        if (!clang(b, folder, pool_print(b->pool, "%s %s/%s", compiling, folder, object[i]), files))
            return;
    }
    if (!clang(b, folder,
               pool_print(b->pool, "--target=wasm32-wasi -nostartfiles -Wl,--no-entry -Wl,--strip-all -o %s/drive.wasm",
                          folder),
               object))
        return;
    const char *bytes = file_read(b->pool, pool_print(b->pool, "%s/drive.wasm", folder), TABLE_MOST, &b->size);
    b->code = bytes;
}

static void generate_sources(Build *b, const Request *request)
{
    const Sequence *sequence = sequence_find(b->pool, b->model);
    const Formulation *f = formulate_narrow(b->pool, model_assemble(b->pool, b->model, sequence), sequence,
                                            request->solve, request->recovery, NULL);
    formulation_validate(b->pool, f, NULL);
    generate(b->pool, f, &style_readable, NULL, "model.h", &b->c, &b->h);
    templates_check(b->pool, NULL, (const Insertions *const[]){&drive_points, NULL});
    template_expand(b->pool, &b->drive, NULL, "drive.c.in", b->model->name, NULL, &drive_points, b);
}

const char *drive_code(Pool *pool, const Model *model, const Scene *scene, const Request *request, size_t *size,
                       const char **why, const char **remedy)
{
    Build b = {.pool = pool, .model = model, .scene = scene};
    b.c.pool = b.h.pool = b.drive.pool = pool;
    generate_sources(&b, request);
    interrupt_hold();
    const char *folder = folder_make(pool);
    if (folder) {
        compile(&b, folder);
        folder_remove(folder);
    } else {
        b.message = pool_print(pool, "can't make a folder in %s: %s", temporary_folder(), strerror(errno));
        b.remedy = "set TMPDIR to a folder that can be written";
    }
    interrupt_release();
    *why = b.message;
    *remedy = b.remedy;
    *size = b.size;
    return b.code;
}
