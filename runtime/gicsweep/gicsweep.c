/* SPDX-License-Identifier: MIT
 * gicsweep: one scene over many values of parameters, inputs and initial states. This file: the command line, over the
 * library. */
#include "base/file.h"
#include "host/gic.h"
#include "host/host.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "usage: gicsweep MODEL.veh SCENE --vary NAME=LOW:HIGH:COUNT ... [-o results.csv]\n"
    "       gicsweep MODEL.veh SCENE --latin COUNT --vary NAME=LOW:HIGH ... [-o results.csv]\n"
    "       gicsweep MODEL.veh SCENE --sobol COUNT --vary NAME=LOW:HIGH ... --metric ...\n"
    "       gicsweep MODEL.veh SCENE --vary ... --slurm FOLDER | --shard I/N -o FOLDER\n"
    "       gicsweep --merge FOLDER [-o results.csv] [--report FILE [--front ...]]\n"
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
    "      --sobol COUNT  sensitivity: runs at COUNT base points, each as many as numbers vary and\n"
    "                     two more; Sobol' indices of each metric go to standard output,\n"
    "                     and into HDF5\n"
    "      --metric 'NAME [UNIT]=FUNCTION(FORMULA)'\n"
    "                     one more column: end, min, max, mean, rms, rms_wk, rms_wd, integral,\n"
    "                     time_of_min, time_of_max, crossing or overshoot of a formula of outputs,\n"
    "                     inputs and parameters, over output times; rms(FORMULA, WEIGHT) and\n"
    "                     crossing(FORMULA, LEVEL), too: models/SCENE.md section 6\n"
    "      --report FILE  a page: response surfaces of the metrics, of second order by least squares,\n"
    "                     with their errors; and fronts\n"
    "      --front min:NAME,max:NAME,...\n"
    "                     on the page: the Pareto front of metrics that are to be small or large;\n"
    "                     given as often as one likes\n"
    "      --seed NUMBER  of the random numbers; the same seed, the same runs; default: 1\n"
    "  -o, --output FILE  results as CSV, or as HDF5 if FILE ends in .h5; default: sweep.csv.\n"
    "                     Finished runs are kept in FILE.journal: the same command goes on\n"
    "                     where it was stopped\n"
    "      --series       in HDF5 also the scene's outputs at all output times\n"
    "      --shard I/N    only part I of N of the runs, 1 to N, perhaps each on another machine;\n"
    "                     -o names the folder of all parts, each of which goes on where it was\n"
    "                     stopped\n"
    "      --slurm FOLDER plan that: FOLDER/job.sh is an array of Slurm jobs, one for each part\n"
    "      --chunk SECONDS\n"
    "                     what a part takes one processor, as measured; default: 600\n"
    "      --parts N      so many parts instead\n"
    "      --merge FOLDER one table of all parts, with the bytes of one sweep, and with --report\n"
    "                     its page; says what is missing\n"
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
    const char **vary, **metric, **front; /* [count of words] */
    const char *planned, *merged;         /* folders of --slurm and --merge; NULL: not asked for */
    double chunk;                         /* s; 0: not given */
    bool series, quiet, seeded;
} Asked;

static void read_vary(void *asked, char *word)
{
    Asked *a = asked;
    a->vary[a->sweep.varied++] = word;
}

static void read_metric(void *asked, char *word)
{
    Asked *a = asked;
    a->metric[a->sweep.metrics++] = word;
}

static void read_front(void *asked, char *word)
{
    Asked *a = asked;
    a->front[a->sweep.fronts++] = word;
}

static void read_latin(void *asked, char *word)
{
    ((Asked *)asked)->sweep.latin =
        usage_whole("gicsweep", "--latin takes 1 to 10000000 runs, not", word, 1, GICL_SWEEP_MOST);
}

static void read_sobol(void *asked, char *word)
{
    ((Asked *)asked)->sweep.sobol =
        usage_whole("gicsweep", "--sobol takes 16 to 10000000 base points, not", word, 16, GICL_SWEEP_MOST);
}

static void read_seed(void *asked, char *word)
{
    ((Asked *)asked)->seeded = true;
    ((Asked *)asked)->sweep.seed =
        (uint64_t)usage_whole("gicsweep", "--seed takes a whole number from 0 on, not", word, 0, INT64_MAX);
}

static void read_shard(void *asked, char *word)
{
    gicl_sweep *sweep = &((Asked *)asked)->sweep;
    static const char form[] = "--shard takes I/N, part I of N, 1 to N and N at most 10000, not";
    char *end;
    const long part = strtol(word, &end, 10), parts = *end == '/' ? strtol(end + 1, &end, 10) : 0;
    if (*end || part < 1 || part > parts || parts > GICL_PARTS_MOST)
        usage_fail("gicsweep", form, word);
    sweep->part = (int)part;
    sweep->parts = (int)parts;
}

static void read_chunk(void *asked, char *word)
{
    char *end;
    const double seconds = strtod(word, &end);
    if (end == word || *end || !(seconds > 0 && seconds <= 1e8))
        usage_fail("gicsweep", "--chunk takes seconds above 0, not", word);
    ((Asked *)asked)->chunk = seconds;
}

static void read_parts(void *asked, char *word)
{
    Asked *a = asked;
    if (a->sweep.part)
        usage_fail("gicsweep", "--shard says how many parts there are; without it:", word);
    a->sweep.parts = (int)usage_whole("gicsweep", "--parts takes 1 to 10000, not", word, 1, GICL_PARTS_MOST);
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
        {"sobol", .read = read_sobol},
        {"metric", .read = read_metric},
        {"report", .text = &sweep->report},
        {"front", .read = read_front},
        {"seed", .read = read_seed},
        {"output", 'o', .text = &sweep->results},
        {"series", .on = &asked->series},
        {"shard", .read = read_shard},
        {"slurm", .text = &asked->planned},
        {"chunk", .read = read_chunk},
        {"parts", .read = read_parts},
        {"merge", .text = &asked->merged},
        {"engine", .read = read_engine},
        {"cc", .text = &asked->options.compiler},
        {"cflags", .text = &asked->options.flags},
        {"quiet", 'q', .on = &asked->quiet},
    };
    const int first = options_read("gicsweep", (const char *const[]){help, NULL}, count, word, option,
                                   (int)(sizeof option / sizeof *option), asked, NULL);
    if (asked->merged && (first < count || sweep->varied || sweep->part || asked->planned))
        usage_fail("gicsweep", "--merge takes -o, --report and --front; all else is in the folder", asked->merged);
    sweep->quiet = asked->quiet;
    sweep->series = asked->series;
    if (!sweep->results)
        sweep->results = sweep->part ? NULL : asked->planned ? asked->planned : "sweep.csv";
    else if (asked->planned)
        usage_fail("gicsweep", "--slurm names a folder, and -o belongs to --merge, not", sweep->results);
    if (sweep->fronts && !sweep->report)
        usage_fail("gicsweep", "--front goes onto a page: --report FILE", NULL);
    if (sweep->report && (file_is_special(sweep->report) || !strcmp(sweep->report, "-")))
        usage_fail("gicsweep", "a report goes into a file, not to", sweep->report);
    sweep->front = asked->front;
    if (asked->merged)
        return;
    if (sweep->part && asked->planned)
        usage_fail("gicsweep", "--slurm plans all parts, --shard makes one of them", NULL);
    if (!sweep->results)
        usage_fail("gicsweep", "--shard needs the folder of all parts: -o FOLDER", NULL);
    if ((asked->chunk > 0 && !asked->planned) || (sweep->parts && !sweep->part && !asked->planned))
        usage_fail("gicsweep", "--chunk and --parts go with --slurm", NULL);
    if (asked->chunk > 0 && sweep->parts)
        usage_fail("gicsweep", "--chunk or --parts, not both", NULL);
    if (count - first != 2)
        usage_fail("gicsweep", "one model and one scene, please", NULL);
    if (!sweep->varied)
        usage_fail("gicsweep", "nothing is varied: --vary NAME=LOW:HIGH:COUNT", NULL);
    if (file_is_special(sweep->results) || !strcmp(sweep->results, "-"))
        usage_fail("gicsweep", "results go into a file, so that a stopped sweep can go on, not to", sweep->results);
    if (sweep->sobol && sweep->latin)
        usage_fail("gicsweep", "--latin or --sobol, not both", NULL);
    if (asked->seeded && !sweep->latin)
        usage_fail("gicsweep", "--seed goes with --latin: other runs have no random numbers", NULL);
    if (sweep->sobol && !sweep->metrics)
        usage_fail("gicsweep", "--sobol needs metrics: --metric NAME=FUNCTION(FORMULA)", NULL);
    if (sweep->report && !sweep->metrics)
        usage_fail("gicsweep", "--report needs metrics: --metric NAME=FUNCTION(FORMULA)", NULL);
    if (sweep->report && (sweep->part || asked->planned))
        usage_fail("gicsweep", "--report is of all parts: give it to --merge, not here:", sweep->report);
    if (asked->series && !sweep->part && !asked->planned && !path_ends(sweep->results, ".h5") &&
        !path_ends(sweep->results, ".hdf5"))
        usage_fail("gicsweep", "--series needs HDF5: -o FILE.h5, not", sweep->results);
    asked->model = word[first];
    sweep->scene = word[first + 1];
    sweep->vary = asked->vary;
    sweep->metric = asked->metric;
}

/* The words that make one part, but for --shard and -o. Returns their number. */
static int command_of(const Asked *asked, char *const *called, const char **word)
{
    static char self[4096];
    static char number[3][24];
    const gicl_sweep *sweep = &asked->sweep;
    const ssize_t size = readlink("/proc/self/exe", self, sizeof self - 1);
    int words = 0;
    word[words++] = size > 0 ? self : called[0];
    word[words++] = asked->model;
    word[words++] = sweep->scene;
    for (int v = 0; v < sweep->varied; ++v) {
        word[words++] = "--vary";
        word[words++] = sweep->vary[v];
    }
    for (int m = 0; m < sweep->metrics; ++m) {
        word[words++] = "--metric";
        word[words++] = sweep->metric[m];
    }
    if (sweep->latin) {
        snprintf(number[0], sizeof number[0], "%lld", (long long)sweep->latin);
        snprintf(number[1], sizeof number[1], "%llu", (unsigned long long)sweep->seed);
        const char *const more[] = {"--latin", number[0], "--seed", number[1]};
        memcpy(word + words, more, sizeof more);
        words += 4;
    }
    if (sweep->sobol) {
        snprintf(number[2], sizeof number[2], "%lld", (long long)sweep->sobol);
        word[words++] = "--sobol";
        word[words++] = number[2];
    }
    if (sweep->series)
        word[words++] = "--series";
    const char *const pair[][2] = {{"--engine", sweep->alone ? asked->options.engine : NULL},
                                   {"--cc", asked->options.compiler},
                                   {"--cflags", asked->options.flags}};
    for (size_t i = 0; i < sizeof pair / sizeof *pair; ++i)
        if (pair[i][1]) {
            word[words++] = pair[i][0];
            word[words++] = pair[i][1];
        }
    return words;
}

int main(int count, char **word)
{
    enum { OTHERS = 16 };
    const char *vary[count], *metric[count], *front[count], *command[2 * count + OTHERS];
    enum { CHUNK = 600 /* s */ };
    Asked asked = {.options = {.size = sizeof asked.options},
                   .sweep = {.size = sizeof asked.sweep, .seed = 1},
                   .vary = vary,
                   .metric = metric,
                   .front = front};
    read_command_line(&asked, count, word);
    const gicl_listener terminal = {
        .size = sizeof terminal, .program = program_place().source->path, .hear = terminal_hear, .signals = 1};
    gicl_library *library = gicl_open();
    gicl_messages *said = gicl_messages_new();
    gicl_handle model;
    if (!library || !said)
        out_of_memory();
    int status = gicl_listen(library, &terminal, said);
    if (status == GICL_OK && asked.merged) {
        const gicl_sweep *sweep = &asked.sweep;
        status = sweep->report ? gicl_sweep_merge_report(library, asked.merged, sweep->results, sweep->report,
                                                         sweep->front, sweep->fronts, asked.quiet, said)
                               : gicl_sweep_merge(library, asked.merged, sweep->results, asked.quiet, said);
        gicl_messages_free(said);
        gicl_close(library);
        return status;
    }
    if (status == GICL_OK)
        status = gicl_model_open(library, asked.model, &asked.options, &model, said);
    if (status == GICL_OK && asked.planned)
        status = gicl_sweep_plan(library, model, &asked.sweep, asked.chunk > 0 ? asked.chunk : CHUNK, command,
                                 command_of(&asked, word, command), said);
    else if (status == GICL_OK)
        status = gicl_sweep_run(library, model, &asked.sweep, NULL, said);
    gicl_messages_free(said);
    gicl_close(library);
    return terminal_close("gicsweep", status); /* GICL_FAILED and GICL_WRONG are exit statuses */
}
