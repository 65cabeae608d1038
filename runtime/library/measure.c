/* SPDX-License-Identifier: MIT
 * Benchmarks: what gicbench does. */
#include "base/message.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "host/gic.h"
#include "host/host.h"
#include "library/library_private.h"
#include "run/engines.h"

#include <string.h>

typedef enum Kind { COMPARE, RHS, DRIVE, BATCH, SCENES, PRECISION, KINDS } Kind;

/* The kinds, and how many files they take. */
static const struct {
    const char *name;
    int least, most;
} of[KINDS] = {[COMPARE] = {"compare", 2, 3}, [RHS] = {"rhs", 1, 2},           [DRIVE] = {"drive", 2, 2},
               [BATCH] = {"batch", 2, 2},     [SCENES] = {"scenes", 2, 10000}, [PRECISION] = {"precision", 2, 10000}};

typedef struct Measuring {
    const gicl_bench *asked;
    Kind kind;
} Measuring;

static void measure(void *context)
{
    const Measuring *m = context;
    const gicl_bench *asked = m->asked;
    const char *const *file = asked->file;
    const bool many = m->kind == SCENES || m->kind == PRECISION;
    Pool *pool = pool_new();
    const char **name = asked->engines ? pool_alloc(pool, sizeof *name * (size_t)(asked->engines + 1)) : NULL;
    for (int i = 0; i < asked->engines; ++i)
        name[i] = asked->engine[i];
    const Bench bench = {.pool = pool,
                         .model_path = many ? NULL : file[0],
                         .scene_path = many || asked->files < 2 ? NULL : file[1],
                         .spin_path = many || asked->files < 3 ? NULL : file[2],
                         .folder = asked->folder,
                         .options = {.compiler = asked->compiler ? asked->compiler : compiler_default(),
                                     .flags = asked->flags ? asked->flags : ""},
                         .rhs = m->kind == RHS,
                         .drive = m->kind == DRIVE,
                         .precision = m->kind == PRECISION,
                         .quick = asked->quick,
                         .vehicles = m->kind == BATCH ? asked->vehicles : 0,
                         .files = many ? asked->files : 0,
                         .file = many ? file : NULL,
                         .rows = asked->rows,
                         .picture = asked->picture};
    bench_all(&bench, name);
    pool_free(pool);
}

static int check(const gicl_bench *asked, Kind *kind, gicl_messages *said)
{
    if (!asked || asked->size != sizeof *asked)
        return call_wrong(said, "set size to sizeof(gicl_bench), and compile with the library's own gic.h",
                          "a benchmark has %zu bytes, not %zu", sizeof *asked, asked ? asked->size : 0);
    *kind = COMPARE;
    while (*kind < KINDS && (!asked->kind || strcmp(asked->kind, of[*kind].name) != 0))
        ++*kind;
    if (*kind == KINDS)
        return call_wrong(said, "one of compare, rhs, drive, batch, scenes, precision", "there is no benchmark '%s'",
                          asked->kind ? asked->kind : "");
    const int files = asked->files;
    if (!asked->file || files < of[*kind].least || files > of[*kind].most || (*kind == SCENES && files % 2))
        return call_wrong(said, NULL, "%s takes %d to %d files, models and scenes, not %d", asked->kind,
                          of[*kind].least, of[*kind].most, asked->file ? files : 0);
    for (int i = 0; i < files; ++i)
        if (!asked->file[i])
            return call_wrong(said, NULL, "file %d is NULL", i);
    if (*kind == COMPARE && !asked->folder)
        return call_wrong(said, NULL, "compare needs a folder");
    if ((asked->rows || asked->picture) && *kind != PRECISION)
        return call_wrong(said, "leave them NULL", "'rows' and 'picture' go with precision");
    if (asked->picture && !plot_known(asked->picture))
        return call_wrong(said, NULL, "'picture' must end in .svg or .png");
    if ((*kind == BATCH) != (asked->vehicles != 0) || asked->vehicles < 0 || asked->vehicles > GICL_BENCH_VEHICLES)
        return call_wrong(said, NULL, "'vehicles' are 1 to %d of batch, else 0", GICL_BENCH_VEHICLES);
    if (asked->engines < 0 || asked->engines > GICL_BENCH_ENGINES || (asked->engines && !asked->engine))
        return call_wrong(said, NULL, "'engines' are at most %d names in 'engine'", GICL_BENCH_ENGINES);
    for (int i = 0; i < asked->engines; ++i)
        if (!asked->engine[i] || !engine_known(asked->engine[i]))
            return call_wrong(said, NULL, "there is no engine '%s'", asked->engine[i] ? asked->engine[i] : "");
    return GICL_OK;
}

int gicl_measure(gicl_library *library, const gicl_bench *asked, gicl_messages *said)
{
    Measuring m = {.asked = asked};
    call_begin(library, said);
    if (!library)
        return call_wrong(said, "gicl_open() makes a library", "the library is NULL");
    const int status = check(asked, &m.kind, said);
    return status == GICL_OK ? call_work(library, said, measure, &m) : status;
}
