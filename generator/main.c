/* SPDX-License-Identifier: MIT
 * gicgen: the command line. */
#include "../runtime/gicrun.h"
#include "effort.h"
#include "validate.h"

#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: gicgen MODEL.veh [-o FILE.c]      write FILE.c and its header (default: <model>.c here)\n"
    "       gicgen --batch N MODEL.veh [-o FILE.c]\n"
    "                                         write code for N vehicles at once (default: <model>_batch.c), to be\n"
    "                                         compiled beside <model>.c\n"
    "       gicgen --scene FILE.scene MODEL.veh [-o FILE.c]\n"
    "                                         write code for that scene alone, with nothing that it doesn't need\n"
    "       gicgen --main MODEL.veh           print a C program that calls <model>.h, to start from\n"
    "       gicgen --sequence MODEL.veh       print the computational sequence\n"
    "       gicgen --graph FILE MODEL.veh     draw bodies, joints and stages: FILE.svg (needs Graphviz) or FILE.dot\n"
    "       gicgen --report FILE.html MODEL.veh\n"
    "                                         write a page about the code: sequence, operations, memory, signals\n"
    "       gicgen --dump-model MODEL.veh     print the resolved model as JSON\n"
    "       gicgen --list-keys                all keys of a model file\n"
    "       gicgen --schema                   the same as a JSON Schema for editors\n"
    "\n"
    "options:\n"
    "  -o FILE          where to write; FILE.c gets a FILE.h beside it; `-` is standard output\n"
    "  --lanes W        alike parts of the vehicle side by side in vectors of up to W numbers, a power of 2 up to 16;\n"
    "                   with --batch: vehicles in one vector (default 4). The code is for gcc and clang\n"
    "  --solve FORM     of the equations of motion: auto (default: fewer operations), reduced, articulated for long\n"
    "                   chains, or augmented, with all multipliers\n"
    "  --recovery WAY   of dependent coordinates: auto (default), newton, or closed wherever there is a closed form\n"
    "  --scene FILE     also with --report: what the scene saves, and why\n"
    "  --templates DIR  take templates from DIR instead of the built-in ones\n"
    "  -h, --help       this text\n"
    "  --version        the version\n"
    "\n"
    "MODEL.veh is described in models/FORMAT.md, FILE.scene in models/SCENE.md; `-` reads standard input.\n";

typedef enum Task { TASK_GENERATE, TASK_BATCH, TASK_MAIN, TASK_SEQUENCE, TASK_GRAPH, TASK_REPORT, TASK_DUMP } Task;

typedef struct Options {
    Task task;
    Solve solve;
    Recovery recovery;
    Batch batch;
    const char *model, *scene, *output, *page, *templates; /* page: of --graph or --report; scene: NULL: none */
} Options;

static _Noreturn void usage_error(const char *message, const char *word)
{
    fprintf(stderr, "gicgen: error: %s%s%s\n%s", message, word ? ": " : "", word ? word : "", usage);
    exit(2);
}

static const char *argument(int count, char **word, int *i)
{
    if (*i + 1 >= count)
        usage_error("an argument is missing after", word[*i]);
    return word[++*i];
}

static void set_task(Options *options, Task task)
{
    if (options->task != TASK_GENERATE)
        usage_error("only one of --batch, --main, --sequence, --graph, --report and --dump-model can be asked for",
                    NULL);
    options->task = task;
}

/* What the reader knows, without a model. */
static void print_tables(bool schema)
{
    Pool *pool = pool_new();
    Text text = {.pool = pool};
    (schema ? schema_print : keys_print)(&text);
    file_write("-", text.s, text.size);
    pool_free(pool);
}

/* A whole number from 1 on. */
static int whole_argument(const char *option, const char *word, int most)
{
    char *end;
    long value = strtol(word, &end, 10);
    if (end == word || *end || value < 1 || value > most)
        usage_error(option, word);
    return (int)value;
}

static Options read_options(int count, char **word)
{
    Options options = {.task = TASK_GENERATE};
    bool formed = false, recovered = false;
    for (int i = 1; i < count; ++i) {
        const char *w = word[i];
        if (!strcmp(w, "-h") || !strcmp(w, "--help")) {
            fputs(usage, stdout);
            exit(0);
        } else if (!strcmp(w, "--version")) {
            puts("gicgen " GICGEN_VERSION);
            exit(0);
        } else if (!strcmp(w, "--list-keys") || !strcmp(w, "--schema")) {
            print_tables(!strcmp(w, "--schema"));
            exit(0);
        } else if (!strcmp(w, "-o")) {
            options.output = argument(count, word, &i);
        } else if (!strcmp(w, "--batch")) {
            set_task(&options, TASK_BATCH);
            options.batch.vehicles =
                whole_argument("--batch takes a number of vehicles up to 65536, not", argument(count, word, &i), 65536);
        } else if (!strcmp(w, "--lanes")) {
            options.batch.lanes = lanes_of(argument(count, word, &i));
            if (!options.batch.lanes)
                usage_error("--lanes takes 2, 4, 8 or 16, not", word[i]);
        } else if (!strcmp(w, "--solve")) {
            const char *form = argument(count, word, &i);
            formed = true;
            options.solve = solve_of(form);
            if (options.solve == SOLVES)
                usage_error("--solve takes auto, reduced, articulated or augmented, not", form);
        } else if (!strcmp(w, "--recovery")) {
            const char *way = argument(count, word, &i);
            recovered = true;
            options.recovery = recovery_of(way);
            if (options.recovery == RECOVERIES)
                usage_error("--recovery takes auto, newton or closed, not", way);
        } else if (!strcmp(w, "--scene")) {
            options.scene = argument(count, word, &i);
        } else if (!strcmp(w, "--templates")) {
            options.templates = argument(count, word, &i);
        } else if (!strcmp(w, "--main")) {
            set_task(&options, TASK_MAIN);
        } else if (!strcmp(w, "--sequence")) {
            set_task(&options, TASK_SEQUENCE);
        } else if (!strcmp(w, "--dump-model")) {
            set_task(&options, TASK_DUMP);
        } else if (!strcmp(w, "--graph") || !strcmp(w, "--report")) {
            set_task(&options, !strcmp(w, "--graph") ? TASK_GRAPH : TASK_REPORT);
            options.page = argument(count, word, &i);
        } else if (w[0] == '-' && w[1]) {
            usage_error("unknown option", w);
        } else if (options.model) {
            usage_error("more than one model given", w);
        } else {
            options.model = w;
        }
    }
    if (!options.model)
        usage_error("no model given", NULL);
    if (options.scene && options.task != TASK_GENERATE && options.task != TASK_REPORT)
        usage_error("--scene is for code and --report", NULL);
    const bool code = options.task == TASK_GENERATE || options.task == TASK_BATCH;
    if (options.output && options.page)
        usage_error("--graph and --report name their file themselves, without -o", options.output);
    if ((formed || recovered) && !code && options.task != TASK_REPORT)
        usage_error(formed ? "--solve is for code and --report" : "--recovery is for code and --report", NULL);
    if (options.batch.lanes && !code)
        usage_error("--lanes is for code", NULL);
    if (options.batch.lanes && options.scene)
        usage_error("--lanes and --scene are not for the same code: leave one out", NULL);
    if (options.task == TASK_BATCH && !options.batch.lanes)
        options.batch.lanes = 4;
    return options;
}

/* A scene: the model before it, and what is known of it; NULL: none. */
typedef struct Setting {
    const Model *drawn;
    const Facts *facts;
    const Validation *validation;
} Setting;

static const Formulation *formulation_of(Pool *pool, const Model *model, const Sequence *sequence,
                                         const Options *options, const Setting *setting)
{
    if (!setting->facts || formulation_chains(pool, model, sequence, options->solve))
        return formulate(pool, model, sequence, options->solve, options->recovery);
    return formulate_explained(pool, setting->drawn, model, sequence, options->solve, options->recovery,
                               setting->facts);
}

/* FILE.c and FILE.h; the code includes <model>.h, so the names must agree. */
static void write_code(Pool *pool, const Model *model, const Sequence *sequence, const Options *options,
                       const Setting *setting)
{
    Text c = {.pool = pool}, h = {.pool = pool};
    bool batch = options->task == TASK_BATCH;
    const char *path = options->output ? options->output : pool_print(pool, batch ? "%s_batch.c" : "%s.c", model->name);
    if (strcmp(path, "-") && !path_ends(path, ".c"))
        usage_error("the generated file must end in .c", path);
    const char *header = pool_print(pool, "%.*sh", (int)strlen(path) - 1, path);
    const char *slash = strrchr(header, '/'), *name = slash ? slash + 1 : header;
    const bool told = effort_tell(pool, model, sequence, options->solve);
    const Formulation *formulation = formulation_of(pool, model, sequence, options, setting);
    if (!batch && options->batch.lanes)
        formulation = formulation_lanes(pool, formulation, options->batch.lanes);
    effort_step(told, "its formulas are made; they are compared with an independent solution next");
    formulation_validate(pool, formulation, setting->validation);
    effort_step(told, "they agree; the C is written next");
    name = strcmp(path, "-") ? name : NULL;
    if (batch && batch_missing(formulation))
        diag_fail((Place){model->source, 0, 0}, "simulate such a model vehicle by vehicle, in threads of your own",
                  "code for many vehicles at once can't have %s yet", batch_missing(formulation));
    if (batch)
        generate_batch(pool, formulation, &options->batch, options->templates, pool_print(pool, "%s.h", model->name),
                       name, &c, &h);
    else
        generate(pool, formulation, &style_readable, options->templates, name, &c, &h);
    if (!strcmp(path, "-")) {
        text_add(&h, c.s, c.size);
        file_write(path, h.s, h.size);
        return;
    }
    file_write_both(header, &h, path, &c);
}

static void write_graph(Pool *pool, const Model *model, const Sequence *sequence, const Options *options)
{
    Text dot = {.pool = pool};
    graph_draw(&dot, model, sequence);
    if (path_ends(options->page, ".svg"))
        picture_write(pool, options->page, &dot);
    else if (path_ends(options->page, ".dot") || !strcmp(options->page, "-"))
        file_write(options->page, dot.s, dot.size);
    else
        usage_error("the picture's name must end in .svg or .dot", options->page);
}

static void write_report(Pool *pool, const Model *model, const Sequence *sequence, const Options *options,
                         const Setting *setting)
{
    Text c = {.pool = pool}, h = {.pool = pool}, page = {.pool = pool};
    if (strcmp(options->page, "-") && !path_ends(options->page, ".html"))
        usage_error("the report's name must end in .html", options->page);
    const Formulation *formulation = formulation_of(pool, model, sequence, options, setting);
    formulation_validate(pool, formulation, setting->validation);
    generate(pool, formulation, &style_readable, options->templates, NULL, &c, &h);
    report_print(&page, options->page, options->templates, formulation, &c, &h);
    file_write(options->page, page.s, page.size);
}

/* No output may be one of the inputs: code and its header, or a page. */
static void check_outputs(Pool *pool, const Options *options, const Source *input)
{
    const char *output = options->page ? options->page : options->output;
    if (!output)
        return;
    source_keep(input, output);
    if (path_ends(output, ".c"))
        source_keep(input, pool_print(pool, "%.*sh", (int)strlen(output) - 1, output));
}

int main(int count, char **word)
{
    Options options = read_options(count, word);
    Pool *pool = pool_new();
    const Model *model = model_read(pool, options.model);
    Setting setting = {model, NULL, NULL};
    check_outputs(pool, &options, model->source);
    if (options.scene) {
        const Scene *scene = scene_read(pool, options.scene, model, NULL, 0);
        check_outputs(pool, &options, scene->source);
        model = scene_rig(pool, model, &scene);
        setting.facts = scene_facts(pool, model, scene, options.scene, false);
        setting.validation = scene_validation(pool, model, scene);
    }
    const Sequence *sequence = sequence_find(pool, model);
    model = model_assemble(pool, model, sequence);
    Text text = {.pool = pool};
    switch (options.task) {
    case TASK_GENERATE:
    case TASK_BATCH: write_code(pool, model, sequence, &options, &setting); break;
    case TASK_GRAPH: write_graph(pool, model, sequence, &options); break;
    case TASK_REPORT: write_report(pool, model, sequence, &options, &setting); break;
    case TASK_MAIN:
    case TASK_SEQUENCE:
    case TASK_DUMP:
        if (options.task == TASK_MAIN)
            example_write(pool, model, options.templates, pool_print(pool, "%s.h", model->name), &text);
        else if (options.task == TASK_DUMP)
            model_dump(&text, model, sequence);
        else
            sequence_print(&text, model, sequence);
        file_write(options.output ? options.output : "-", text.s, text.size);
        break;
    }
    pool_free(pool);
    return 0;
}
