/* SPDX-License-Identifier: MIT
 * gicbench: measure engines and integrators. This file: the command line. */
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
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char help[] = "usage: gicbench [--quick] [-o FOLDER] MODEL.veh SCENE [TURNING_SCENE]\n"
                           "       gicbench --rhs [--quick] [-o FOLDER] MODEL.veh [SCENE]\n"
                           "       gicbench --drive [--quick] [-o FOLDER] MODEL.veh SCENE\n"
                           "       gicbench --batch N [--quick] [-o FOLDER] MODEL.veh SCENE\n"
                           "       gicbench --scenes [--quick] [-o FOLDER] MODEL.veh SCENE [MODEL.veh SCENE]...\n"
                           "       gicbench --precision [--quick] [-o FILE.csv|FOLDER] [--plot FILE.svg|FILE.png]\n"
                           "                MODEL.veh SCENE... [MODEL.veh SCENE...]...\n"
                           "\n"
                           "Runs a scene with all engines and integrators and writes a folder: index.html with\n"
                           "tables and pictures, the same as text, a CSV file a table.\n"
                           "\n"
                           "      --rhs            one right-hand side alone, of every variant of the code:\n"
                           "                       operations, time, distance from the processor's limit, as\n"
                           "                       text; with -o also as a folder\n"
                           "      --drive          the scene as it stands, with its step and ratio: CPU time, and\n"
                           "                       what of it goes into multibody system, tires and powertrain;\n"
                           "                       as text, with -o also as a folder\n"
                           "      --batch N        likewise steps of N vehicles in lanes (gicgen --batch), and one\n"
                           "                       after another\n"
                           "      --scenes         each scene with general code and with code for it alone:\n"
                           "                       operations, CPU time, difference of the results\n"
                           "      --precision      CPU time against error of vehicles with their scenes, events\n"
                           "                       included: constant and variable steps, single and dual rate;\n"
                           "                       as text, with -o as CSV or as a folder\n"
                           "      --plot FILE      the picture of --precision\n"
                           "  -o, --output FOLDER  default: gicbench\n"
                           "      --engines NAMES  some engines, separated by commas; the others are compared\n"
                           "                       with the first; default: all\n"
                           "      --quick          few repetitions, few settings\n"
                           "      --cc COMMAND     C compiler of generated code; default: $CC or cc\n"
                           "      --cflags FLAGS   more options for it, after ours, in one word\n"
                           "  -h, --help           this text\n"
                           "      --version        version\n"
                           "\n"
                           "Exit status: 0 good, 1 error in a file or during a run, 2 wrong usage.\n";

/* Names separated by commas. */
static const char *const *engine_list(Pool *pool, char *names)
{
    const char **list = NULL;
    int engines = 0;
    char *rest;
    for (char *name = strtok_r(names, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
        if (!engine_known(name))
            usage_fail("gicbench", "there is no engine", name);
        *POOL_PUSH(pool, list, engines) = name;
    }
    if (!engines)
        usage_fail("gicbench", "--engines needs at least one name", NULL);
    *POOL_PUSH(pool, list, engines) = NULL;
    return list;
}

/* The engines from the `first` of engine_name on that are available here, ended by NULL; prints those left out. */
static const char *const *engines_here(Pool *pool, int first)
{
    int count = 0;
    for (int i = first; engine_name[i]; ++i)
        ++count;
    const char **list = pool_alloc(pool, ((size_t)count + 1) * sizeof *list), **end = list;
    for (int i = first; engine_name[i]; ++i) {
        const char *package = engine_missing(pool, engine_name[i]);
        if (package)
            fprintf(
                stderr,
                "gicbench: note: the engine %s is left out: it needs MUMPS (Debian: apt-get install %s; then make)\n",
                engine_name[i], package);
        else
            *end++ = engine_name[i];
    }
    return list;
}

/* For reading the command line. */
typedef struct Reading {
    Bench bench;
    const char *const *names; /* of the engines, ended by NULL; NULL: not given */
} Reading;

static void read_engines(void *reading, char *word)
{
    Reading *r = reading;
    r->names = r->bench.starting = engine_list(r->bench.pool, word);
}

static void read_batch(void *reading, char *word)
{
    ((Reading *)reading)->bench.vehicles =
        (int)usage_whole("gicbench", "--batch takes 1 to 65536 vehicles, not", word, 1, 65536);
}

/* The files of --precision: a model, its scenes, perhaps more models. */
static void read_precision(Bench *bench, int files, char *const *file)
{
    if (files < 2)
        usage_fail("gicbench", "--precision takes a model and its scenes, please", NULL);
    for (int i = 1; i <= files; ++i)
        if ((i == files || path_ends(file[i], ".veh")) && (i == 1 || path_ends(file[i - 1], ".veh")))
            usage_fail("gicbench", "a scene is missing after the model", file[i - 1]);
    if (bench->picture && !plot_known(bench->picture))
        usage_fail("gicbench", "--plot writes .svg or .png, not", bench->picture);
    if (bench->folder && path_ends(bench->folder, ".csv")) {
        bench->rows = bench->folder;
        bench->folder = NULL;
    }
    bench->files = files;
    bench->file = file;
}

/* What the command line asks for, and the names of the engines, ended by NULL. */
static Bench read_command_line(Pool *pool, int count, char **word, const char *const **names)
{
    Reading reading = {.bench = {.pool = pool, .options = {.compiler = compiler_default(), .flags = ""}}};
    bool scenes = false;
    const Option option[] = {
        {"output", 'o', .text = &reading.bench.folder},
        {"engines", .read = read_engines},
        {"quick", .on = &reading.bench.quick},
        {"rhs", .on = &reading.bench.rhs},
        {"drive", .on = &reading.bench.drive},
        {"batch", .read = read_batch},
        {"scenes", .on = &scenes},
        {"precision", .on = &reading.bench.precision},
        {"plot", .text = &reading.bench.picture},
        {"cc", .text = &reading.bench.options.compiler},
        {"cflags", .text = &reading.bench.options.flags},
    };
    const int first =
        options_read("gicbench", help, count, word, option, (int)(sizeof option / sizeof *option), &reading, NULL);
    Bench bench = reading.bench;
    bench.repetitions = bench.quick ? 3 : 9;
    *names = reading.names;
    if (!*names) {
        bench.starting = engines_here(pool, 1); /* auto and tcc run the same operations as cc, more slowly: */
        *names = bench.starting + 1;            /* they matter for the start, where auto is tcc */
    }
    const int files = count - first;
    if (bench.rhs + bench.drive + scenes + bench.precision + (bench.vehicles > 0) > 1)
        usage_fail("gicbench", "one of --rhs, --drive, --batch, --scenes and --precision, please", NULL);
    if (bench.picture && !bench.precision)
        usage_fail("gicbench", "--plot goes with --precision; the others draw into their folder", NULL);
    bench.engine_name = (*names)[0];
    if (bench.precision) {
        read_precision(&bench, files, word + first);
        return bench;
    }
    if (scenes) {
        if (files < 2 || files % 2)
            usage_fail("gicbench", "a model and a scene, please, or several pairs of them", NULL);
        if (!engine_generates(bench.engine_name))
            usage_fail("gicbench", "--scenes compares generated code, which is not what runs in the engine",
                       bench.engine_name);
        bench.files = files;
        bench.file = word + first;
        return bench;
    }
    if ((bench.drive || bench.vehicles) && files != 2)
        usage_fail("gicbench", "a model and a scene, please", NULL);
    if (bench.rhs && (files < 1 || files > 2))
        usage_fail("gicbench", "a model, please, and perhaps a scene", NULL);
    if (!bench.rhs && (files < 2 || files > 3))
        usage_fail("gicbench", "a model and a scene, please, and perhaps one in which the vehicle turns", NULL);
    bench.model_path = word[first];
    bench.scene_path = word[first + 1]; /* or the NULL at the end */
    bench.spin_path = bench.scene_path ? word[first + 2] : NULL;
    if (!bench.rhs && !bench.drive && !bench.vehicles && !bench.folder)
        bench.folder = "gicbench";
    return bench;
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
    report_tell(bench->report, stdout);
}

/* Right-hand sides alone, steps in lanes alone, or scene after scene. */
static void evaluate_alone(const Bench *bench)
{
    if (bench->folder)
        make_folder(bench->folder);
    if (bench->precision) {
        bench_precision(bench);
        report_tell(bench->report, stdout);
        return;
    }
    bench_machine(bench);
    if (bench->vehicles)
        bench_batch(bench);
    else if (bench->files)
        bench_scenes(bench);
    else
        bench_rhs(bench);
    report_tell(bench->report, stdout);
}

int main(int count, char **word)
{
    Pool *pool = pool_new();
    const char *const *name;
    Bench bench = read_command_line(pool, count, word, &name);
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
    fputc('\n', stderr);
    pool_free(pool);
    return 0;
}
