/* SPDX-License-Identifier: MIT
 * gicbench: measure engines and integrators. This file: the command line, over the library. */
#include "base/file.h"
#include "host/gic.h"
#include "host/host.h"

#include <string.h>
#include <unistd.h>

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

/* What is asked for. */
typedef struct Asked {
    gicl_bench bench;
    const char **engine; /* with room for all of its words */
    bool quick, rhs, drive, scenes, precision;
} Asked;

static bool engine_known(const char *word)
{
    const char *name;
    for (int i = 0; (name = gicl_word("engine", i)); ++i)
        if (!strcmp(name, word))
            return true;
    return false;
}

/* Names separated by commas. */
static void read_engines(void *asked, char *names)
{
    Asked *a = asked;
    char *rest;
    a->bench.engines = 0;
    for (char *name = strtok_r(names, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
        if (!engine_known(name))
            usage_fail("gicbench", "there is no engine", name);
        if (a->bench.engines == GICL_BENCH_ENGINES)
            usage_fail("gicbench", "--engines takes fewer names; what is", name);
        a->engine[a->bench.engines++] = name;
    }
    if (!a->bench.engines)
        usage_fail("gicbench", "--engines needs at least one name", NULL);
}

static void read_batch(void *asked, char *word)
{
    ((Asked *)asked)->bench.vehicles =
        (int)usage_whole("gicbench", "--batch takes 1 to 65536 vehicles, not", word, 1, 65536);
}

/* The files of --precision: a model, its scenes, perhaps more models. */
static void check_precision(gicl_bench *bench)
{
    const char *const *file = bench->file;
    if (bench->files < 2)
        usage_fail("gicbench", "--precision takes a model and its scenes, please", NULL);
    for (int i = 1; i <= bench->files; ++i)
        if ((i == bench->files || path_ends(file[i], ".veh")) && (i == 1 || path_ends(file[i - 1], ".veh")))
            usage_fail("gicbench", "a scene is missing after the model", file[i - 1]);
    if (bench->picture && !plot_known(bench->picture))
        usage_fail("gicbench", "--plot writes .svg or .png, not", bench->picture);
    if (bench->folder && path_ends(bench->folder, ".csv")) {
        bench->rows = bench->folder;
        bench->folder = NULL;
    }
}

static void read_command_line(Asked *asked, int count, char **word)
{
    gicl_bench *bench = &asked->bench;
    const Option option[] = {
        {"output", 'o', .text = &bench->folder}, {"engines", .read = read_engines},
        {"quick", .on = &asked->quick},          {"rhs", .on = &asked->rhs},
        {"drive", .on = &asked->drive},          {"batch", .read = read_batch},
        {"scenes", .on = &asked->scenes},        {"precision", .on = &asked->precision},
        {"plot", .text = &bench->picture},       {"cc", .text = &bench->compiler},
        {"cflags", .text = &bench->flags},
    };
    const int first = options_read("gicbench", (const char *const[]){help, NULL}, count, word, option,
                                   (int)(sizeof option / sizeof *option), asked, NULL);
    const int files = count - first;
    bench->file = (const char *const *)word + first;
    bench->files = files;
    bench->engine = asked->engine;
    bench->quick = asked->quick;
    if (asked->rhs + asked->drive + asked->scenes + asked->precision + (bench->vehicles > 0) > 1)
        usage_fail("gicbench", "one of --rhs, --drive, --batch, --scenes and --precision, please", NULL);
    if (bench->picture && !asked->precision)
        usage_fail("gicbench", "--plot goes with --precision; the others draw into their folder", NULL);
    bench->kind = asked->precision      ? "precision"
                  : asked->scenes       ? "scenes"
                  : asked->rhs          ? "rhs"
                  : asked->drive        ? "drive"
                  : bench->vehicles > 0 ? "batch"
                                        : "compare";
    if (asked->precision)
        check_precision(bench);
    else if (asked->scenes && (files < 2 || files % 2))
        usage_fail("gicbench", "a model and a scene, please, or several pairs of them", NULL);
    else if ((asked->drive || bench->vehicles) && files != 2)
        usage_fail("gicbench", "a model and a scene, please", NULL);
    else if (asked->rhs && (files < 1 || files > 2))
        usage_fail("gicbench", "a model, please, and perhaps a scene", NULL);
    else if (!asked->scenes && !asked->rhs && (files < 2 || files > 3) && !asked->drive && !bench->vehicles)
        usage_fail("gicbench", "a model and a scene, please, and perhaps one in which the vehicle turns", NULL);
    if (!strcmp(bench->kind, "compare") && !bench->folder)
        bench->folder = "gicbench";
}

/* Lines of progress are for files too, where they stay. */
static void hear(void *context, const gicl_message *message)
{
    if (message->kind != GICL_PROGRESS || isatty(STDERR_FILENO))
        terminal_hear(context, message);
    else if (*message->printed)
        fprintf(stderr, "%s\n", message->printed);
}

int main(int count, char **word)
{
    const char *engine[GICL_BENCH_ENGINES];
    Asked asked = {.bench = {.size = sizeof asked.bench}, .engine = engine};
    read_command_line(&asked, count, word);
    const gicl_listener terminal = {
        .size = sizeof terminal, .program = program_place().source->path, .hear = hear, .signals = 1};
    gicl_library *library = gicl_open();
    gicl_messages *said = gicl_messages_new();
    if (!library || !said)
        out_of_memory();
    int status = gicl_listen(library, &terminal, said);
    if (status == GICL_OK)
        status = gicl_measure(library, &asked.bench, said);
    if (status == GICL_OK)
        fputc('\n', stderr);
    gicl_messages_free(said);
    gicl_close(library);
    return status; /* GICL_FAILED and GICL_WRONG are exit statuses */
}
