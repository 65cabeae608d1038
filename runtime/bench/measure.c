/* SPDX-License-Identifier: MIT
 * A benchmark from its files to its folder. */
#include "base/file.h"
#include "base/message.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

/* The engines from the `first` of engine_name on that are available here, ended by NULL; notes those left out. */
static const char *const *engines_here(Pool *pool, int first)
{
    int count = 0;
    for (int i = first; engine_name[i]; ++i)
        ++count;
    const char **list = pool_alloc(pool, ((size_t)count + 1) * sizeof *list), **end = list;
    for (int i = first; engine_name[i]; ++i) {
        const char *package = engine_missing(pool, engine_name[i]);
        if (package)
            diag_note(pool_print(
                pool, "%s: note: the engine %s is left out: it needs MUMPS (Debian: apt-get install %s; then make)\n",
                program_place().source->path, engine_name[i], package));
        else if (engine_is_whole(engine_name[i]))
            *end++ = engine_name[i];
    }
    return list;
}

/* Make the folder before minutes of work are spent. */
static void make_folder(const char *folder)
{
    struct stat there;
    if (mkdir(folder, 0777) && !(errno == EEXIST && !stat(folder, &there) && S_ISDIR(there.st_mode)))
        diag_fail(program_place(), file_remedy(errno), "can't make the folder %s: %s", folder, strerror(errno));
}

static const Scene *read_scene(const Bench *bench, const char *path)
{
    const Scene *scene = scene_read(bench->pool, path, bench->model, NULL, 0);
    scene_no_rig(scene);
    scene_no_implicit(scene, "gicbench");
    return equilibrium_start(bench->pool, bench->model, scene, bench->options.solve);
}

static void open_engines(Bench *bench, const char *const *name)
{
    for (int e = 0; name[e]; ++e) {
        bench_progress(bench, "engine %s", name[e]);
        *POOL_PUSH(bench->pool, bench->engine, bench->engines) =
            engine_open(bench->pool, name[e], bench->model, &bench->options);
    }
    bench->instance = pool_alloc(bench->pool, sizeof(gic_head *) * (size_t)bench->engines);
    for (int e = 0; e < bench->engines; ++e)
        bench->instance[e] = instance_new(bench->pool, bench->engine[e]);
}

static void close_engines(const Bench *bench)
{
    for (int e = 0; e < bench->engines; ++e)
        engine_close(bench->engine[e]);
}

/* How long compare() will take once the engines are open, s. opened: what that took, s. Times of evaluations are those
 * of the scene's first steps; their number is that of runs with the first engine. Right-hand sides are compiled in some
 * twenty ways, and each start opens the engine anew. */
static double comparison_seconds(const Bench *bench, double opened)
{
    enum { WAYS_TO_COMPILE = 20, ORDER_OF_SPIN = 4 * (250 + 500 + 1000) /* evaluations a second of the scene */ };
    const Setting ab3 = {GIC_AB3, 0.005};
    const Scene first = bench_scene(bench->scene, ab3);
    double evaluation, all = 0;
    for (int e = 0; e < bench->engines; ++e) {
        bench_step_seconds(bench->engine[e], bench->instance[e], &first, &evaluation);
        all += evaluation;
    }
    double seconds = all * sweep_evaluations(bench) * (1 + bench->repetitions);
    if (bench->spin)
        seconds += all * bench->spin->duration * ((double)ORDER_OF_SPIN + bench->repetitions / ab3.value);
    return seconds + opened * (WAYS_TO_COMPILE + bench->repetitions);
}

/* All engines and integrators on the scene. */
static void compare(Bench *bench, const char *const *name)
{
    if (bench_samples(bench->scene) < 2)
        diag_fail((Place){bench->scene->source, 0, 0}, "a longer duration", "a benchmark takes at least %g s",
                  bench_sample);
    make_folder(bench->folder);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    open_engines(bench, name);
    bench_expect(bench, comparison_seconds(bench, clock_seconds(CLOCK_MONOTONIC) - before));
    bench_machine(bench);
    bench_sweep(bench);
    bench_profile(bench);
    bench_rhs(bench);
    bench_spin(bench);
    bench_worst(bench);
    bench_start(bench);
    close_engines(bench);
}

/* The scene with its own settings. */
static void drive_alone(Bench *bench, const char *const *name)
{
    if (bench->folder)
        make_folder(bench->folder);
    open_engines(bench, name);
    bench_machine(bench);
    bench_drive(bench);
    close_engines(bench);
    report_tell(bench->report);
}

/* Right-hand sides alone, steps in lanes alone, or scene after scene. */
static void evaluate_alone(const Bench *bench)
{
    if (bench->folder)
        make_folder(bench->folder);
    if (bench->precision) {
        bench_precision(bench);
        report_tell(bench->report);
        return;
    }
    bench_machine(bench);
    if (bench->vehicles)
        bench_batch(bench);
    else if (bench->files)
        bench_scenes(bench);
    else
        bench_rhs(bench);
    report_tell(bench->report);
}

void bench_all(const Bench *asked, const char *const *name)
{
    Pool *pool = asked->pool;
    Bench bench = *asked;
    bench.repetitions = bench.quick ? 3 : 9;
    bench.starting = name;
    if (!name) {
        bench.starting = engines_here(pool, 1); /* auto and tcc run the same operations as cc, more slowly: */
        name = bench.starting + 1;              /* they matter for the start, where auto is tcc */
    }
    bench.engine_name = name[0];
    if (bench.files && !bench.precision && !engine_generates(bench.engine_name))
        diag_fail_call(program_place(), "`gicbench -h` shows how",
                       "--scenes compares generated code, which is not what runs in the engine '%s'",
                       bench.engine_name);
    Report report = {.pool = pool};
    Progress progress = {.begun = clock_seconds(CLOCK_MONOTONIC)};
    bench.report = &report;
    bench.progress = &progress;
    bench.model = bench.model_path ? model_read(pool, bench.model_path) : NULL;
    bench.scene = bench.scene_path ? read_scene(&bench, bench.scene_path) : NULL;
    bench.spin = bench.spin_path ? read_scene(&bench, bench.spin_path) : NULL;
    if (bench.rhs || bench.vehicles || bench.files)
        evaluate_alone(&bench);
    else if (bench.drive)
        drive_alone(&bench, name);
    else
        compare(&bench, name);
    if (bench.folder) {
        bench_progress(&bench, "writing %s", bench.folder);
        report_write(&report, bench.folder);
        bench_progress(&bench, "see %s/index.html", bench.folder);
    }
}
