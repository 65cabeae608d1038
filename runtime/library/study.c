/* SPDX-License-Identifier: MIT
 * What gicrun writes: runs, pages, tables. */
#include "base/file.h"
#include "base/message.h"
#include "engine/engine.h"
#include "host/gic.h"
#include "host/host.h"
#include "library/library_private.h"
#include "model/model.h"
#include "read/read.h"
#include "run/choose_step.h"
#include "run/engines.h"
#include "run/gradient.h"
#include "run/identify.h"
#include "run/kc.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/manoeuvre.h"
#include "run/optimize.h"
#include "run/page_vehicle.h"
#include "run/run.h"
#include "run/sheet.h"
#include "run/trim.h"
#include "scene/replay.h"
#include "scene/scene.h"
#include "sweep/study.h"
#include "vehicle/vehicle.h"

#include <dlfcn.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

typedef enum Kind {
    RUN,
    DRIVE,
    EVAL,
    EQUILIBRIUM,
    MODES,
    LINEARIZE,
    KC,
    SHEET,
    MANOEUVRE,
    TRIM,
    GRADIENT,
    IDENTIFY,
    OPTIMIZE,
    LIVE,
    KINDS
} Kind;

static const char *const kind_name[KINDS] = {"run",       "drive",    "eval",     "equilibrium", "modes",
                                             "linearize", "kc",       "sheet",    "manoeuvre",   "trim",
                                             "gradient",  "identify", "optimize", "live"};

/* ---- the call -------------------------------------------------------------------------------------------------- */

enum { ALL = (1 << KINDS) - 1 };
#define IN(kind) (1 << (kind))

/* Words of a study, the kinds that take them, and those that need them. */
static const struct {
    const char *name;
    size_t offset;
    int takes, needs;
} word_of[] = {
    {"scene", offsetof(gicl_study, scene), ALL & ~IN(MANOEUVRE),
     IN(RUN) | IN(DRIVE) | IN(GRADIENT) | IN(IDENTIFY) | IN(OPTIMIZE) | IN(LIVE)},
    {"results", offsetof(gicl_study, results), ALL & ~IN(DRIVE), IN(EVAL) | IN(LINEARIZE)},
    {"page", offsetof(gicl_study, page), IN(RUN) | IN(DRIVE) | IN(KC) | IN(SHEET) | IN(MANOEUVRE), IN(DRIVE)},
    {"plot", offsetof(gicl_study, plot), IN(RUN), 0},
    {"with", offsetof(gicl_study, with), IN(RUN), 0},
    {"replay", offsetof(gicl_study, replay), IN(RUN), 0},
    {"states", offsetof(gicl_study, states), IN(EVAL), IN(EVAL)},
    {"axle", offsetof(gicl_study, axle), IN(KC), 0},
    {"compare", offsetof(gicl_study, compare), IN(KC) | IN(SHEET) | IN(MANOEUVRE), 0},
    {"manoeuvre", offsetof(gicl_study, manoeuvre), IN(MANOEUVRE), IN(MANOEUVRE)},
    {"formula", offsetof(gicl_study, formula), IN(GRADIENT) | IN(OPTIMIZE), IN(GRADIENT) | IN(OPTIMIZE)},
    {"measured", offsetof(gicl_study, measured), IN(IDENTIFY), IN(IDENTIFY)},
    {"trace", offsetof(gicl_study, trace), IN(MANOEUVRE), 0},
    {"record", offsetof(gicl_study, record), IN(LIVE), 0},
    {"inputs", offsetof(gicl_study, inputs), IN(LIVE), 0},
    {"joystick", offsetof(gicl_study, joystick), IN(LIVE), 0},
    {"axes", offsetof(gicl_study, axes), IN(LIVE), 0},
};

static const char *word(const gicl_study *study, size_t i)
{
    return *(const char *const *)(const void *)((const char *)study + word_of[i].offset);
}

/* GICL_OK, or GICL_WRONG with a message. signals: those that ask to stop are the library's. */
static int check_words(const gicl_study *study, Kind kind, bool signals, gicl_messages *said)
{
    for (size_t i = 0; i < sizeof word_of / sizeof *word_of; ++i) {
        const bool given = word(study, i);
        if (given && !(word_of[i].takes & IN(kind)))
            return call_wrong(said, "leave it NULL", "%s takes no '%s'", study->kind, word_of[i].name);
        if (!given && word_of[i].needs & IN(kind))
            return call_wrong(said, NULL, "%s needs '%s'", study->kind, word_of[i].name);
    }
    if (study->at && (kind != LINEARIZE || !study->scene))
        return call_wrong(said, "leave it NULL", "'at' goes with linearize and a scene");
    if (study->at && !(*study->at >= 0 && isfinite(*study->at)))
        return call_wrong(said, NULL, "'at' must be finite and at least 0");
    if ((study->travel != 0 || study->loads || study->joints) && kind != KC)
        return call_wrong(said, "leave them 0", "'travel', 'loads' and 'joints' go with kc");
    if (study->loads && study->joints)
        return call_wrong(said, "leave one of them 0", "'loads' and 'joints' are two studies");
    if (study->travel != 0 && !(study->travel > 0 && study->travel <= 10))
        return call_wrong(said, NULL, "'travel' must be above 0 and at most 10 m");
    if (!study->joystick != !study->axes)
        return call_wrong(said, "give both, or none", "'axes' says what 'joystick' moves");
    if ((study->port != 0 || study->seconds != 0) && kind != LIVE)
        return call_wrong(said, "leave them 0", "'port' and 'seconds' go with live");
    if (study->port < 0 || study->port > 65535)
        return call_wrong(said, NULL, "'port' must be from 1 to 65535, or 0 for one that is free");
    if (!(study->seconds >= 0 && study->seconds <= 1e9))
        return call_wrong(said, NULL, "'seconds' must be from 0 to 1e9");
    if (kind == LIVE && study->seconds == 0 && !signals)
        return call_wrong(said, "give it 'seconds', or a listener with 'signals'",
                          "nothing would end a live run: no signal is the library's");
    const int keyed = IN(MANOEUVRE) | IN(TRIM) | IN(GRADIENT) | IN(IDENTIFY) | IN(OPTIMIZE) | IN(LINEARIZE);
    if (study->keys < 0 || (study->keys && (!(keyed & IN(kind)) || !study->key)))
        return call_wrong(
            said, NULL,
            "'keys' is the number of words in 'key', which go with manoeuvre, trim, linearize, gradient, identify and "
            "optimize");
    const int varying = IN(KC) | IN(SHEET) | IN(MANOEUVRE);
    if (study->varied < 0 || (study->varied && (!(varying & IN(kind)) || !study->vary)))
        return call_wrong(said, NULL,
                          "'varied' is the number of words in 'vary', which go with kc, sheet and manoeuvre");
    if (study->varied && study->trace)
        return call_wrong(said, "leave it NULL", "'vary' goes without 'trace'");
    if (kind == SHEET && study->page && !study->varied)
        return call_wrong(said, "'results' that end in .html are one", "'page' of sheet goes with 'vary'");
    if (study->keys && study->at)
        return call_wrong(said, "leave it NULL", "'at' is one operating point, and 'key' another one");
    if (kind == TRIM && study->results && !trim_file_known(study->results))
        return call_wrong(said, NULL, "'results' of trim must end in .csv or .scene, or be -");
    if (study->with && !study->plot && !study->page)
        return call_wrong(said, NULL, "'with' goes with 'plot' or 'page'");
    if (study->plot && !plot_known(study->plot))
        return call_wrong(said, NULL, "'plot' must end in .svg or .png");
    if (kind == LINEARIZE && !linear_file_known(study->results))
        return call_wrong(said, NULL, "'results' of linearize must end in .csv, .npz or .mat, or be -");
    return GICL_OK;
}

/* ---- the work -------------------------------------------------------------------------------------------------- */

typedef struct Writing {
    OpenModel *open;
    const gicl_study *study;
    Kind kind;
    Pool *pool;
    const Engine *engine; /* that is to be closed; NULL: none */
} Writing;

/* Refuse outputs that are inputs, or one file. */
static void check_outputs(const Request *request, const Model *model, const Scene *scene)
{
    const char *const output[] = {request->results, request->picture, request->page,  request->driven,
                                  request->report,  request->trace,   request->record};
    const Source states = {.path = request->states ? request->states : "-"};
    for (size_t i = 0; i < sizeof output / sizeof *output; ++i) {
        if (!output[i])
            continue;
        for (size_t k = 0; k < i; ++k)
            if (files_are_one(output[i], output[k]))
                diag_fail_call(program_place(), "choose another one", "two outputs go to the file '%s'", output[i]);
        file_check(output[i]);
        source_keep(model->source, output[i]);
        source_keep(&states, output[i]);
        if (request->other)
            source_keep(request->other->source, output[i]);
        if (scene)
            source_keep(scene->source, output[i]);
    }
}

/* Of a path, or NULL, without its folders. */
static const char *name_of(const char *path)
{
    const char *slash = path ? strrchr(path, '/') : NULL;
    return slash ? slash + 1 : path;
}

static Request request_of(const Writing *w)
{
    const gicl_study *s = w->study;
    const EngineOptions *options = &w->open->options;
    return (Request){.scene = s->scene,
                     .states = s->states,
                     .loads = s->loads,
                     .joints = s->joints,
                     .axle = s->axle,
                     .travel = s->travel,
                     .report = w->kind == KC || w->kind == SHEET || w->kind == MANOEUVRE ? s->page : NULL,
                     .compare = s->compare,
                     .manoeuvre = s->manoeuvre,
                     .trace = s->trace,
                     .formula = s->formula,
                     .measured = s->measured,
                     .keys = s->keys,
                     .key = s->key,
                     .varied = s->varied,
                     .vary = s->vary,
                     .results = s->results,
                     .picture = s->plot,
                     .with = s->with,
                     .page = w->kind == RUN ? s->page : NULL,
                     .driven = w->kind == DRIVE ? s->page : NULL,
                     .engine = w->open->engine_name,
                     .solve = options->solve,
                     .recovery = options->recovery,
                     .compiler = options->compiler,
                     .flags = options->flags,
                     .record = s->record,
                     .inputs = s->inputs,
                     .joystick = s->joystick,
                     .axes = s->axes,
                     .port = s->port,
                     .seconds = s->seconds,
                     .quiet = s->quiet};
}

/* The results of another run, which --with draws: rows in the order of time. */
static const CsvTable *other_results(Pool *pool, const char *path)
{
    const CsvTable *table = csv_read(pool, path, "time [s],chassis.z [m]", NULL);
    if (strcmp(table->name[0], "time") != 0)
        diag_fail(csv_name_place(table, 0), "give a file that gicrun wrote by -o",
                  "results of a run begin with a column `time [s]`, not with '%s'", table->name[0]);
    csv_check_unit(pool, table, 0, "s");
    for (int r = 1; r < table->rows; ++r)
        if (table->value[r * table->columns] < table->value[(r - 1) * table->columns])
            diag_fail(csv_place(table, r), "give a file that gicrun wrote by -o", "time goes back from %.6g to %.6g s",
                      table->value[(r - 1) * table->columns], table->value[r * table->columns]);
    return table;
}

/* The reports on the static equilibrium. */
static void report_rest(const Writing *w, const Model *model, const Scene *scene, const Request *request)
{
    const Equilibrium *found = equilibrium_find(w->pool, model, scene, request->solve);
    if (w->kind == EQUILIBRIUM)
        equilibrium_report(w->pool, w->engine, scene, request, found);
    else
        modes_report(w->pool, scene, request, found);
}

static bool has_engine_page(const Writing *w)
{
    return !strcmp(w->open->engine_name, "page");
}

/* Is the run to have the page's digits: asked for, or a page's recording, unless another engine is asked for? */
static bool wants_page(const Writing *w)
{
    const bool asked = has_engine_page(w), automatic = !strcmp(w->open->engine_name, "auto");
    return w->kind == RUN && (asked || (automatic && w->study->replay && replay_is_of_page(w->pool, w->study->replay)));
}

/* A scene, perhaps one of a recording, that the vehicle of a page of `whole` computes, where one can be made and the
 * recording is one of it. Conditions and sleep are left out, as on the page. */
static const Scene *on_page(const Writing *w, const Model *model, const Scene *whole, const Scene *scene,
                            const Request *request)
{
    const char *why, *remedy;
    PageVehicle *page = page_vehicle_new(w->pool, model, whole, request, &why, &remedy);
    if (!page && has_engine_page(w))
        diag_fail(program_place(), remedy, "%s", why);
    if (!page)
        diag_warn(program_place(), remedy, "%s; the replay differs from the page in the last digits", why);
    if (!page || (scene->replay && !page_vehicle_takes(page, scene)))
        return scene;
    Scene *out = pool_alloc(w->pool, sizeof *out);
    *out = *scene;
    out->page = page;
    out->actions = NULL;
    out->rest = NULL;
    return out;
}

/* With an engine. */
static void compute(Writing *w, const Model *model, const Scene *scene, const Request *request)
{
    Pool *pool = w->pool;
    const OpenModel *open = w->open;
    const bool runs = w->kind == RUN || w->kind == DRIVE || w->kind == LIVE;
    LivePort *port = NULL;
    if (runs)
        scene = equilibrium_start(pool, model, scene, request->solve);
    if (w->kind == RUN)
        scene = scene_choose_step(pool, model, scene, request->solve, engine_has_implicit(open->engine_name),
                                  request->quiet);
    const Scene *whole = scene;
    if (w->study->replay)
        scene = scene_replay(pool, model, scene, w->study->replay);
    if (wants_page(w))
        scene = on_page(w, model, whole, scene, request);
    if (w->kind == LIVE) {
        scene = live_scene(pool, model, scene, request);
        port = live_port_open(pool, request->port, model, scene); /* before the compiler has worked for nothing */
    }
    EngineOptions options = open->options;
    options.quiet = request->quiet;
    /* a page shows whatever outputs tell; lanes are for code for all scenes */
    const bool general = open->general || request->page || request->driven || w->study->replay || port ||
                         (scene && scene->page) || options.lanes;
    const char *engine = scene && scene->page ? "tcc" : open->engine_name;
    w->engine =
        runs ? engine_open_run(pool, engine, model, scene, general ? NULL : request->scene, request->picture, &options)
             : engine_open(pool, engine, model, &options);
    if (w->kind == DRIVE)
        drive_write(pool, model, scene, w->engine, request);
    else if (w->kind == LIVE)
        live(pool, w->engine, model, scene, port, request);
    else if (w->kind == EVAL)
        evaluate(pool, w->engine, scene, request);
    else if (!runs)
        report_rest(w, model, scene, request);
    else
        simulate(pool, w->engine, model, scene,
                 request->page ? animation_new(pool, model, w->engine, scene, request->scene, request->other,
                                               name_of(request->with))
                               : NULL,
                 request);
}

static void make_pool(void *context)
{
    ((Writing *)context)->pool = pool_new();
}

static StudyKind study_kind(const Writing *w)
{
    return w->kind == SHEET       ? STUDY_SHEET
           : w->kind == MANOEUVRE ? STUDY_MANOEUVRE
           : w->study->loads      ? STUDY_LOADS
           : w->study->joints     ? STUDY_JOINTS
                                  : STUDY_KC;
}

static void write_study(void *context)
{
    Writing *w = context;
    Pool *pool = w->pool;
    OpenModel *open = w->open;
    Request request = request_of(w);
    if (w->kind == DRIVE && !engine_generates(open->engine_name))
        diag_fail_call(program_place(), "`gicrun -h` shows how",
                       "a page of --drive runs generated code, and does not go with --engine '%s'", open->engine_name);
    const Model *model = model_once(open, pool);
    if (request.page || request.driven || wants_page(w)) /* the page shows forces of all wheels as arrows */
        model = model_watch_wheels(pool, model);
    const Scene *scene =
        request.scene ? scene_read(pool, request.scene, model, open->integrator, open->tolerance) : NULL;
    if (scene && model->tuning && !request.varied && (w->kind == KC || w->kind == SHEET))
        model = model_read_fixed(pool, model, NULL, 0, scene->parameter);
    if (request.with)
        request.other = other_results(pool, request.with);
    if (w->kind != RUN && w->kind != EVAL && w->kind != EQUILIBRIUM && w->kind != MODES && scene && scene->automatic)
        scene_no_implicit(scene, w->study->kind);
    check_outputs(&request, model, scene);
    if (request.picture)
        plot_check(pool);
    if (request.varied)
        study_sweep(pool, model, study_kind(w), &request);
    else if (w->kind == MANOEUVRE)
        manoeuvre_report(pool, model, &request);
    else if (w->kind == KC)
        kc_report(pool, model, scene, &request);
    else if (w->kind == SHEET)
        sheet_report(pool, model, scene, &request);
    else {
        model = scene_rig(pool, model, &scene);
        if (w->kind == LINEARIZE) {
            const OperatingPoint point =
                request.keys ? operating_point_trim(pool, model, scene, &request)
                             : operating_point(pool, model, scene, request.solve, w->study->at ? *w->study->at : NAN);
            linear_report(pool, model, &point, &request);
        } else if (w->kind == TRIM)
            trim_report(pool, model, scene, &request);
        else if (w->kind == GRADIENT)
            gradient_report(pool, model, scene, &request);
        else if (w->kind == IDENTIFY)
            identify_report(pool, model, scene, &request);
        else if (w->kind == OPTIMIZE)
            optimize_report(pool, model, scene, &request);
        else
            compute(w, model, scene, &request);
    }
}

int gicl_write(gicl_library *library, gicl_handle model, const gicl_study *study, gicl_messages *said)
{
    const Use use = use_begin(library, model, THING_MODEL, said);
    if (use.status != GICL_OK)
        return use.status;
    if (!study || study->size != sizeof *study)
        return use_end(&use,
                       call_wrong(said, "set size to sizeof(gicl_study), and compile with the library's own gic.h",
                                  "a study has %zu bytes, not %zu", sizeof *study, study ? study->size : 0));
    Writing w = {.open = use.thing, .study = study, .kind = RUN};
    while (w.kind < KINDS && (!study->kind || strcmp(study->kind, kind_name[w.kind]) != 0))
        ++w.kind;
    if (w.kind == KINDS)
        return use_end(
            &use,
            call_wrong(said,
                       "one of run, drive, eval, equilibrium, modes, linearize, kc, sheet, manoeuvre, trim, gradient, "
                       "identify, optimize, live",
                       "there is no study '%s'", study->kind ? study->kind : ""));
    int status = check_words(study, w.kind, said && said->list.listener && said->list.listener->signals, said);
    if (status != GICL_OK)
        return use_end(&use, status);
    status = call_work(library, said, make_pool, &w);
    if (status != GICL_OK)
        return use_end(&use, status);
    status = call_work(library, said, write_study, &w);
    /* an engine's own memory was released with a work that failed */
    if (status == GICL_OK && w.engine)
        engine_close(w.engine);
    if (w.engine && w.engine->library)
        dlclose(w.engine->library);
    pool_free(w.pool);
    return use_end(&use, status);
}
