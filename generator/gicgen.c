/* SPDX-License-Identifier: MIT
 * gicgen: the command line. */
#include "base/file.h"
#include "base/message.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "host/host.h"
#include "fmu/fmu.h"
#include "model/model.h"
#include "read/read.h"
#include "report/report.h"
#include "run/stiff_states.h"
#include "scene/scene.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "validate/validate.h"
#include "vehicle/effort.h"
#include "vehicle/vehicle.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: gicgen MODEL.veh [-o FILE.c]      write FILE.c and its header (default: <model>.c here)\n"
    "       gicgen --batch N MODEL.veh [--scene FILE.scene] [-o FILE.c]\n"
    "                                         write code for N vehicles at once (default: <model>_batch.c), to be\n"
    "                                         compiled beside <model>.c for the same scene; if that is no rig, the\n"
    "                                         one for any scene will do\n"
    "       gicgen --scene FILE.scene MODEL.veh [--lanes W] [-o FILE.c]\n"
    "                                         write code for that scene alone, with nothing that it doesn't need\n"
    "       gicgen --fmu 2|3 MODEL.veh [--scene FILE.scene] [-o FILE.fmu]\n"
    "                                         write a unit of FMI 2.0 or 3.0 for other simulators (default: "
    "<model>.fmu)\n"
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
    "  --derivatives    code with functions for derivatives of rates and outputs too; units of FMI with directional\n"
    "                   derivatives\n"
    "  --implicit       code that takes implicit steps too, for stiff models (models/STIFF.md); units of FMI\n"
    "                   likewise\n"
    "  --exponential    with --implicit: exponential steps, too\n"
    "  --spread-jacobian  with --implicit: steps that keep a Jacobian may share the work of the next\n"
    "  --stiff STEP     with --implicit: only states with a share in motions that are stiff in steps of STEP seconds\n"
    "                   are implicit\n"
    "  --tire-tables    Magic Formulas by table, in lanes by short polynomials, within 1e-6 of a wheel's load:\n"
    "                   quicker (models/TIRES.md)\n"
    "  --solve FORM     of the equations of motion: auto (default: fewer operations), reduced, articulated for long\n"
    "                   chains, or augmented, with all multipliers\n"
    "  --recovery WAY   of dependent coordinates: auto (default), newton, closed wherever there is a closed form, or\n"
    "                   polynomial: as auto, with polynomials in place of iterations within a coordinate's range\n"
    "  --scene FILE     also with --report: what the scene saves, and why; with --fmu: what the unit starts with\n"
    "  --templates DIR  take templates from DIR instead of the built-in ones\n"
    "  -h, --help       this text\n"
    "  --version        the version\n"
    "\n"
    "MODEL.veh is described in models/FORMAT.md, FILE.scene in models/SCENE.md; `-` reads standard input.\n";

typedef enum Task {
    TASK_GENERATE,
    TASK_BATCH,
    TASK_FMU,
    TASK_MAIN,
    TASK_SEQUENCE,
    TASK_GRAPH,
    TASK_REPORT,
    TASK_DUMP
} Task;

typedef struct Options {
    Task task;
    Solve solve;
    Recovery recovery;
    Batch batch;
    int fmi;                                               /* version of an FMU */
    const char *model, *scene, *output, *page, *templates; /* page: of --graph or --report; scene: NULL: none */
    bool formed, recovered;                                /* are `solve` and `recovery` given? */
    bool derivatives, implicit, exponential, spread, tire_tables;
    double stiff; /* s; 0: all states are implicit */
} Options;

static _Noreturn void usage_error(const char *message, const char *word)
{
    fprintf(stderr, "gicgen: error: %s%s%s\n  remedy: `gicgen -h` shows how\n", message, word ? ": " : "",
            word ? word : "");
    exit(2);
}

/* Print the tables of keys; needs no model. */
static void print_tables(bool schema)
{
    Pool *pool = pool_new();
    Text text = {.pool = pool};
    (schema ? schema_print : keys_print)(&text);
    file_write("-", text.s, text.size);
    pool_free(pool);
}

/* A whole number between 1 and `most`. */
static int whole_argument(const char *option, const char *word, int most)
{
    char *end;
    long value = strtol(word, &end, 10);
    if (end == word || *end || value < 1 || value > most)
        usage_error(option, word);
    return (int)value;
}

static void read_batch(void *options, char *word)
{
    ((Options *)options)->batch.vehicles =
        whole_argument("--batch takes a number of vehicles up to 65536, not", word, 65536);
}

static void read_lanes(void *options, char *word)
{
    ((Options *)options)->batch.lanes = lanes_of(word);
    if (!((Options *)options)->batch.lanes)
        usage_error("--lanes takes 2, 4, 8 or 16, not", word);
}

static void read_stiff(void *options, char *word)
{
    char *end;
    const double step = strtod(word, &end);
    if (end == word || *end || !(step > 0) || step > DBL_MAX)
        usage_error("--stiff takes the length of a step in seconds, above 0, not", word);
    ((Options *)options)->stiff = step;
}

static void read_solve(void *options, char *form)
{
    ((Options *)options)->formed = true;
    ((Options *)options)->solve = solve_of(form);
    if (((Options *)options)->solve == SOLVES)
        usage_error("--solve takes auto, reduced, articulated or augmented, not", form);
}

static void read_recovery(void *options, char *way)
{
    ((Options *)options)->recovered = true;
    ((Options *)options)->recovery = recovery_of(way);
    if (((Options *)options)->recovery == RECOVERIES)
        usage_error("--recovery takes auto, newton, closed or polynomial, not", way);
}

static void read_fmu(void *options, char *word)
{
    if (strcmp(word, "2") && strcmp(word, "3"))
        usage_error("--fmu takes 2 or 3, the version of FMI, not", word);
    ((Options *)options)->fmi = word[0] - '0';
}

static Options read_options(int count, char **word)
{
    Options options = {.task = TASK_GENERATE};
    bool keys = false, schema = false, main_program = false, sequence = false, dump = false;
    const char *graph = NULL, *report = NULL;
    const Option option[] = {
        {NULL, 'o', .text = &options.output},
        {"list-keys", .on = &keys},
        {"schema", .on = &schema},
        {"batch", .read = read_batch},
        {"fmu", .read = read_fmu},
        {"lanes", .read = read_lanes},
        {"solve", .read = read_solve},
        {"recovery", .read = read_recovery},
        {"scene", .text = &options.scene},
        {"derivatives", .on = &options.derivatives},
        {"implicit", .on = &options.implicit},
        {"exponential", .on = &options.exponential},
        {"spread-jacobian", .on = &options.spread},
        {"stiff", .read = read_stiff},
        {"tire-tables", .on = &options.tire_tables},
        {"templates", .text = &options.templates},
        {"main", .on = &main_program},
        {"sequence", .on = &sequence},
        {"dump-model", .on = &dump},
        {"graph", .text = &graph},
        {"report", .text = &report},
    };
    const int first = options_read("gicgen", (const char *const[]){usage, NULL}, count, word, option,
                                   (int)(sizeof option / sizeof *option), &options, usage_error);
    if (keys || schema) {
        print_tables(schema);
        exit(0);
    }
    const bool asked[] = {[TASK_BATCH] = options.batch.vehicles,
                          [TASK_FMU] = options.fmi,
                          [TASK_MAIN] = main_program,
                          [TASK_SEQUENCE] = sequence,
                          [TASK_GRAPH] = graph,
                          [TASK_REPORT] = report,
                          [TASK_DUMP] = dump};
    for (Task task = TASK_BATCH; task <= TASK_DUMP; ++task)
        if (asked[task] && options.task != TASK_GENERATE)
            usage_error(
                "only one of --batch, --fmu, --main, --sequence, --graph, --report and --dump-model can be asked for",
                NULL);
        else if (asked[task])
            options.task = task;
    options.page = graph ? graph : report;
    if (count > first + 1)
        usage_error("more than one model given", word[first + 1]);
    options.model = word[first];
    if (!options.model)
        usage_error("no model given", NULL);
    const bool fmu = options.task == TASK_FMU;
    const bool code = options.task == TASK_GENERATE || options.task == TASK_BATCH || fmu;
    if (options.scene && !code && options.task != TASK_REPORT)
        usage_error("--scene is for code, --report and --fmu", NULL);
    if (options.output && options.page)
        usage_error("--graph and --report name their file themselves, without -o", options.output);
    if ((options.formed || options.recovered) && !code && options.task != TASK_REPORT)
        usage_error(options.formed ? "--solve is for code and --report" : "--recovery is for code and --report", NULL);
    if (options.batch.lanes && (!code || fmu))
        usage_error("--lanes is for code, without --fmu and --report", NULL);
    if (options.derivatives && !fmu && (options.task != TASK_GENERATE || options.scene))
        usage_error("--derivatives is for the code of one vehicle in any scene, without --batch and --scene; "
                    "vehicles of a batch have derivatives beside it (models/DERIVATIVES.md, Many vehicles)",
                    NULL);
    if (options.spread && !options.implicit)
        usage_error("--spread-jacobian goes with --implicit", NULL);
    if (options.exponential && !options.implicit)
        usage_error("--exponential goes with --implicit", NULL);
    if (options.stiff > 0 && !options.implicit)
        usage_error("--stiff goes with --implicit", NULL);
    if (options.stiff > 0 && options.exponential)
        usage_error("--stiff does not go with --exponential, whose steps treat all states alike", NULL);
    if (options.implicit && !fmu && (options.task != TASK_GENERATE || options.scene))
        usage_error("--implicit is for an FMU and the code of one vehicle in any scene, without --batch and --scene",
                    NULL);
    if (options.tire_tables && options.task != TASK_GENERATE && options.task != TASK_BATCH)
        usage_error("--tire-tables is for code: it goes with --batch, --derivatives, --implicit, --lanes, --scene, "
                    "--solve and --recovery, and not with --fmu, --main, --report and what looks at a model",
                    NULL);
    if (options.recovery == RECOVERY_POLYNOMIAL && options.task != TASK_GENERATE && options.task != TASK_BATCH)
        usage_error(
            "--recovery polynomial is for code, without --fmu and --report; leave them out, or take --recovery auto",
            NULL);
    if (options.task == TASK_BATCH && !options.batch.lanes)
        options.batch.lanes = 4;
    return options;
}

/* A scene: the model as the file has it, and facts about the scene; NULL: no scene. */
typedef struct Setting {
    const Model *drawn;
    const Facts *facts;
    const Validation *validation;
    const Scene *scene;
    const Splitting *splitting; /* of implicit steps; NULL: all states are implicit */
} Setting;

static const Formulation *formulation_of(Pool *pool, const Model *model, const Sequence *sequence,
                                         const Options *options, const Setting *setting)
{
    if (!setting->facts || formulation_chains(pool, model, sequence, options->solve))
        return formulate(pool, model, sequence, options->solve, options->recovery);
    return formulate_explained(pool, setting->drawn, model, sequence, options->solve, options->recovery,
                               setting->facts);
}

/* Polynomials were asked for: end with a message if no subset has any, warn of those whose errors could not be bounded.
 */
static void check_polynomials(const Model *model, const Formulation *f)
{
    const Place at = {model->source, 0, 0};
    const char *because = "it has no subset of one coordinate that takes Newton's iteration";
    bool any = false;
    for (int c = 0; c < f->sequence->classes; ++c) {
        any = any || f->plan->formula[c]->polynomial;
        if (f->plan->formula[c]->exact_because)
            because = f->plan->formula[c]->exact_because;
    }
    if (!any)
        diag_fail(at, "leave out `--recovery polynomial`", "no subset of the model can be recovered by polynomials: %s",
                  because);
    for (int c = 0; c < f->sequence->classes; ++c)
        if (f->plan->formula[c]->unproved)
            diag_warn(at, "none is needed; a shorter range may bring polynomials", "'%s' keeps Newton's iteration: %s",
                      f->sequence->class[c].name, f->plan->formula[c]->exact_because);
}

/* FILE.c and FILE.h; the code includes <model>.h, so the names must agree. */
static void write_code(Pool *pool, const Model *model, const Sequence *sequence, const Options *options,
                       const Setting *setting)
{
    Text c = {.pool = pool}, h = {.pool = pool};
    Style style = style_readable;
    style.derivatives = options->derivatives;
    style.implicit = options->implicit;
    style.exponential = options->exponential;
    style.spread = options->spread;
    style.splitting = setting->splitting;
    bool batch = options->task == TASK_BATCH;
    const char *path = options->output ? options->output : pool_print(pool, batch ? "%s_batch.c" : "%s.c", model->name);
    if (strcmp(path, "-") && !path_ends(path, ".c"))
        usage_error("the generated file must end in .c", path);
    const char *header = pool_print(pool, "%.*sh", (int)strlen(path) - 1, path);
    const char *slash = strrchr(header, '/'), *name = slash ? slash + 1 : header;
    const bool told = effort_tell(pool, model, sequence, options->solve);
    const Formulation *formulation = formulation_of(pool, model, sequence, options, setting);
    if (options->recovery == RECOVERY_POLYNOMIAL)
        check_polynomials(model, formulation);
    if (!batch && options->batch.lanes)
        formulation = formulation_lanes(pool, formulation, options->batch.lanes);
    effort_step(told, "its formulas are made; they are compared with an independent solution next");
    formulation_validate(pool, formulation, setting->validation);
    effort_step(told, "they agree; the C is written next");
    name = strcmp(path, "-") ? name : NULL;
    if (options->tire_tables)
        formulation = formulation_tire_tables(pool, formulation, batch);
    if (batch && batch_missing(formulation))
        diag_fail((Place){model->source, 0, 0}, "simulate such a model vehicle by vehicle, in threads of your own",
                  "code for many vehicles at once can't have %s yet", batch_missing(formulation));
    if (batch)
        generate_batch(pool, formulation, &options->batch, options->templates, pool_print(pool, "%s.h", model->name),
                       name, &c, &h);
    else
        generate(pool, formulation, &style, options->templates, name, &c, &h);
    if (!strcmp(path, "-")) {
        text_add(&h, c.s, c.size);
        file_write(path, h.s, h.size);
        return;
    }
    file_write_both(header, &h, path, &c);
}

static void write_fmu(Pool *pool, const Model *model, const Sequence *sequence, const Options *options,
                      const Setting *setting)
{
    const char *path = options->output ? options->output : pool_print(pool, "%s.fmu", model->name);
    if (!path_ends(path, ".fmu"))
        usage_error("the name of an FMU must end in .fmu", path);
    const Formulation *formulation = formulate(pool, model, sequence, options->solve, options->recovery);
    formulation_validate(pool, formulation, NULL);
    Style style = style_readable;
    style.derivatives = options->derivatives;
    style.implicit = options->implicit || (setting->scene && scene_implicit(setting->scene));
    style.exponential = options->exponential || (setting->scene && setting->scene->method == GIC_EXP3);
    style.spread = options->spread || (setting->scene && setting->scene->spread);
    style.splitting = setting->splitting;
    fmu_write(pool, options->fmi, formulation, setting->scene, &style, options->templates, path);
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
    const CodeMemory code = code_memory(pool, model->name, &c, &h);
    report_print(&page, options->page, options->templates, formulation, &c, &code);
    file_write(options->page, page.s, page.size);
}

/* Refuse outputs that are inputs: the code and its header, or a page. */
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
    Setting setting = {.drawn = model};
    check_outputs(pool, &options, model->source);
    if (options.scene) {
        const Scene *scene = scene_read(pool, options.scene, model, NULL, 0);
        check_outputs(pool, &options, scene->source);
        if (options.task == TASK_FMU)
            scene_no_auto(scene, "an FMU");
        else
            scene_no_implicit(scene, "code for one scene");
        model = scene_rig(pool, model, &scene);
        setting.scene = scene;
        if (options.task != TASK_FMU) {
            setting.facts = scene_facts(pool, model, scene, options.scene, false);
            setting.validation = scene_validation(pool, model, scene);
        }
    }
    if (options.stiff > 0)
        setting.splitting = stiff_states(pool, model, options.solve, options.recovery, options.stiff);
    else if (setting.scene && options.task == TASK_FMU)
        setting.splitting = scene_splitting(pool, model, setting.scene, options.solve, options.recovery);
    const Sequence *sequence = sequence_find(pool, model);
    model = model_assemble(pool, model, sequence);
    Text text = {.pool = pool};
    switch (options.task) {
    case TASK_GENERATE:
    case TASK_BATCH: write_code(pool, model, sequence, &options, &setting); break;
    case TASK_FMU: write_fmu(pool, model, sequence, &options, &setting); break;
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
