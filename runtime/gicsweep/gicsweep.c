/* SPDX-License-Identifier: MIT
 * gicsweep: one scene over many values of parameters, inputs and initial states. This file: the command line, over the
 * library. */
#include "base/file.h"
#include "host/gic.h"
#include "host/host.h"

#include <string.h>

static const char help[] = "usage: gicsweep MODEL.veh SCENE --vary NAME=LOW:HIGH:COUNT ... [-o results.csv]\n"
                           "       gicsweep MODEL.veh SCENE --latin COUNT --vary NAME=LOW:HIGH ... [-o results.csv]\n"
                           "\n"
                           "Runs a scene with all combinations of values, or with COUNT combinations of a Latin\n"
                           "hypercube, several vehicles at once. A row of the results for each run: the varied\n"
                           "values, the status (0: good, else the run ended at `time`, or was found unstable then),\n"
                           "of each output of the scene the value at the end, the least and the greatest at output\n"
                           "times.\n"
                           "\n"
                           "      --vary NAME=LOW:HIGH:COUNT\n"
                           "                     a tunable parameter, an input (constant through the run), a number\n"
                           "                     of the initial state, or `speed`, along the vehicle; where a name\n"
                           "                     has several meanings parameter/NAME, input/NAME, state/NAME. In a\n"
                           "                     grid the last one varies fastest\n"
                           "      --latin COUNT  so many runs: each number takes each of COUNT parts of its range\n"
                           "                     once, in random order\n"
                           "      --seed NUMBER  of the random numbers; the same seed, the same runs; default: 1\n"
                           "  -o, --output FILE  results as CSV; default: sweep.csv. Finished runs are kept in\n"
                           "                     FILE.journal: the same command goes on where it was stopped\n"
                           "      --engine NAME  each run by itself, by an engine of gicrun\n"
                           "      --cc COMMAND   C compiler, perhaps with options; default: $CC or cc\n"
                           "      --cflags FLAGS more options for it, after ours, in one word\n"
                           "  -q, --quiet        neither progress nor summary\n"
                           "  -h, --help         this text\n"
                           "      --version      version\n"
                           "\n"
                           "Vehicles run in the lanes of vectors where compiler and model allow that, else each by\n"
                           "itself, with the same digits; and in $OMP_NUM_THREADS processes, by default one for each\n"
                           "processor.\n"
                           "Exit status: 0 good, even if runs failed; 1 error in a file; 2 wrong usage.\n";

/* What is asked for. */
typedef struct Asked {
    const char *model;
    gicl_options options;
    gicl_sweep sweep;
    const char **vary; /* [count of words] */
    bool quiet;
} Asked;

static void read_vary(void *asked, char *word)
{
    Asked *a = asked;
    a->vary[a->sweep.varied++] = word;
}

static void read_latin(void *asked, char *word)
{
    ((Asked *)asked)->sweep.latin =
        usage_whole("gicsweep", "--latin takes 1 to 10000000 runs, not", word, 1, GICL_SWEEP_MOST);
}

static void read_seed(void *asked, char *word)
{
    ((Asked *)asked)->sweep.seed =
        (uint64_t)usage_whole("gicsweep", "--seed takes a whole number from 0 on, not", word, 0, INT64_MAX);
}

static void read_engine(void *asked, char *word)
{
    Asked *a = asked;
    const char *name;
    for (int i = 0; (name = gicl_word("engine", i)); ++i)
        if (!strcmp(name, word))
            a->options.engine = name;
    if (!a->options.engine)
        usage_fail("gicsweep", "there is no engine", word);
    a->sweep.alone = 1;
}

static void read_command_line(Asked *asked, int count, char **word)
{
    gicl_sweep *sweep = &asked->sweep;
    const Option option[] = {
        {"vary", .read = read_vary},
        {"latin", .read = read_latin},
        {"seed", .read = read_seed},
        {"output", 'o', .text = &sweep->results},
        {"engine", .read = read_engine},
        {"cc", .text = &asked->options.compiler},
        {"cflags", .text = &asked->options.flags},
        {"quiet", 'q', .on = &asked->quiet},
    };
    const int first =
        options_read("gicsweep", help, count, word, option, (int)(sizeof option / sizeof *option), asked, NULL);
    if (count - first != 2)
        usage_fail("gicsweep", "one model and one scene, please", NULL);
    if (!sweep->varied)
        usage_fail("gicsweep", "nothing is varied: --vary NAME=LOW:HIGH:COUNT", NULL);
    if (file_is_special(sweep->results) || !strcmp(sweep->results, "-"))
        usage_fail("gicsweep", "results go into a file, so that a stopped sweep can go on, not to", sweep->results);
    asked->model = word[first];
    sweep->scene = word[first + 1];
    sweep->vary = asked->vary;
    sweep->quiet = asked->quiet;
}

int main(int count, char **word)
{
    const char *vary[count];
    Asked asked = {.options = {.size = sizeof asked.options},
                   .sweep = {.size = sizeof asked.sweep, .results = "sweep.csv", .seed = 1},
                   .vary = vary};
    read_command_line(&asked, count, word);
    const gicl_listener terminal = {
        .size = sizeof terminal, .program = program_place().source->path, .hear = terminal_hear, .signals = 1};
    gicl_library *library = gicl_open();
    gicl_messages *said = gicl_messages_new();
    gicl_handle model;
    if (!library || !said)
        out_of_memory();
    int status = gicl_listen(library, &terminal, said);
    if (status == GICL_OK)
        status = gicl_model_open(library, asked.model, &asked.options, &model, said);
    if (status == GICL_OK)
        status = gicl_sweep_run(library, model, &asked.sweep, NULL, said);
    gicl_messages_free(said);
    gicl_close(library);
    return status; /* GICL_FAILED and GICL_WRONG are exit statuses */
}
