/* SPDX-License-Identifier: MIT
 * gicrun: generate, compile and run a model. This file: the command line. */
#include "base/file.h"
#include "base/message.h"
#include "engine/engine.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/kc.h"
#include "run/linear_model.h"
#include "run/linearize.h"
#include "run/manoeuvre.h"
#include "run/run.h"
#include "run/sheet.h"
#include "scene/replay.h"
#include "scene/scene.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: gicrun MODEL.veh SCENE [-o results.csv] [--plot picture.svg|picture.png]\n"
    "              [--with other.csv] [--animate page.html] [--replay recording.csv]\n"
    "       gicrun --drive page.html MODEL.veh SCENE\n"
    "       gicrun --eval states.csv MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --equilibrium|--modes MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --linearize [--at TIME] MODEL.veh [SCENE] [-o results.csv|.npz|.mat]\n"
    "       gicrun --kc [--axle NAME] [--report page.html] MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --sheet MODEL.veh [SCENE] [-o page.html|results.csv]\n"
    "       gicrun --manoeuvre NAME MODEL.veh [key=value ...] [-o results.csv] [--trace FILE]\n"
    "              [--report page.html]\n"
    "\n"
    "Generates C for a vehicle model, compiles it and runs a scene; or studies the model.\n"
    "\n"
    "  -o, --output FILE  results as CSV; - is standard output (the default, unless a\n"
    "                     picture or a page is asked for)\n"
    "      --plot FILE    draw the scene's `plot`, with gnuplot\n"
    "      --with FILE    draw other results too, in dots\n"
    "      --animate FILE write a page for a browser in which the model moves along its road\n"
    "      --drive FILE   write a page in which one drives the model; needs clang and lld\n"
    "      --replay FILE  repeat what it recorded\n"
    "      --eval FILE    CSV of states to evaluate, a column a name; - is standard input;\n"
    "                     a scene gives the road only\n"
    "      --equilibrium  find the static equilibrium near the scene's initial state, with its\n"
    "                     inputs and road at time 0, or near the model's: coordinates, forces,\n"
    "                     wheel loads; -o: the state as a row that --eval reads\n"
    "      --modes        eigenvalues, frequencies and damping of small motions about it, with\n"
    "                     the scene's velocities; -o: the same as CSV\n"
    "      --linearize    the linear model about the same state: A, B, C, D and derivatives by\n"
    "                     tunable parameters, with names and units; -o: as CSV, or for NumPy\n"
    "                     or MATLAB\n"
    "      --at TIME      with --linearize: about the state of a run of the scene at TIME, s\n"
    "      --kc           kinematics of axles over travel and steering, models/KC.md; -o: as CSV\n"
    "      --axle NAME, --travel M\n"
    "                     of --kc: front, rear or a number from the front; up and down, m (0.08)\n"
    "      --loads        with --kc: compliance instead\n"
    "      --sheet        the vehicle on a page, models/SHEET.md\n"
    "      --manoeuvre NAME\n"
    "                     standard manoeuvres, models/MANOEUVRES.md; an unknown name lists\n"
    "      --trace FILE   of --manoeuvre: what the vehicle did, as CSV\n"
    "      --report FILE  of --kc and --manoeuvre: a page of curves\n"
    "      --compare FILE with --kc, --sheet, --manoeuvre: another beside it\n"
    "      --integrator NAME\n"
    "                     ab3, rk4 (constant steps), adams or rkck (variable steps) instead\n"
    "                     of the scene's\n"
    "      --tolerance NUMBER of these\n"
    "      --engine NAME  auto (default): generated code compiled in this process (tcc), in a\n"
    "                     long run by the C compiler too (cc); tape: formulas interpreted;\n"
    "                     gic, gcp1, gcp2\n"
    "      --solve FORM   of the equations of motion: auto (default), reduced, articulated or augmented\n"
    "      --recovery WAY of dependent coordinates: newton; closed, wherever there is a closed\n"
    "                     form; auto (default), whichever takes less\n"
    "      --general      code for any scene; else it leaves out what its scene doesn't need\n"
    "      --lanes W      with --engine cc: alike parts in vectors of 2, 4, 8 or 16 numbers\n"
    "      --cc COMMAND   C compiler of cc and auto, perhaps with options; default: $CC or cc\n"
    "      --cflags FLAGS more options for it, after ours, in one word\n"
    "  -q, --quiet        neither progress nor summary\n"
    "  -h, --help         this text\n"
    "      --version      version\n"
    "\n"
    "gicrun(1): $CC, $GICGEN_CACHE, $GICGEN_CACHE_SIZE, $XDG_CACHE_HOME and $TMPDIR.\n"
    "\n"
    "models/FORMAT.md describes models, models/SCENE.md scenes and the columns of --eval.\n"
    "Exit status: 0 good, 1 error in a file or during the run, or a run that was unstable,\n"
    "2 wrong usage.\n";

static void read_tolerance(void *request, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || !tolerance_known(value))
        usage_fail("gicrun", "--tolerance must be a number between 1e-13 and 0.1, unlike", word);
    ((Request *)request)->tolerance = value;
}

static void read_at(void *request, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || end == word || !(value >= 0 && isfinite(value)))
        usage_fail("gicrun", "--at must be a time in s, 0 or more, unlike", word);
    ((Request *)request)->at = value;
}

static void read_travel(void *request, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || end == word || !(value > 0 && value <= 10))
        usage_fail("gicrun", "--travel must be a length in m, above 0 and at most 10, unlike", word);
    ((Request *)request)->travel = value;
}

static void read_engine(void *request, char *name)
{
    ((Request *)request)->engine = name;
    if (engine_known(name))
        return;
    fprintf(stderr, "gicrun: error: there is no engine '%s'\n  remedy: one of", name);
    for (int i = 0; engine_name[i]; ++i)
        fprintf(stderr, "%s %s", i ? "," : "", engine_name[i]);
    fputs("\n", stderr);
    exit(2);
}

static void read_solve(void *request, char *form)
{
    ((Request *)request)->solve = solve_of(form);
    if (((Request *)request)->solve == SOLVES)
        usage_fail("gicrun", "--solve takes auto, reduced, articulated or augmented, not", form);
}

static void read_recovery(void *request, char *way)
{
    ((Request *)request)->recovery = recovery_of(way);
    if (((Request *)request)->recovery == RECOVERIES)
        usage_fail("gicrun", "--recovery takes auto, newton or closed, not", way);
}

static void read_lanes(void *request, char *word)
{
    ((Request *)request)->lanes = lanes_of(word);
    if (!((Request *)request)->lanes)
        usage_fail("gicrun", "--lanes takes 2, 4, 8 or 16, not", word);
}

/* False: something else than to run a scene is asked for. */
static bool is_run(const Request *request)
{
    return !request->states && !request->rests && !request->modes && !request->linear && !request->kinematics &&
           !request->sheet && !request->manoeuvre;
}

static Request read_command_line(int count, char **word)
{
    Request request = {.engine = engine_name[0], .compiler = compiler_default(), .flags = "", .at = NAN};
    const Option option[] = {
        {"output", 'o', .text = &request.results},
        {"plot", .text = &request.picture},
        {"with", .text = &request.with},
        {"animate", .text = &request.page},
        {"drive", .text = &request.driven},
        {"replay", .text = &request.recording},
        {"eval", .text = &request.states},
        {"equilibrium", .on = &request.rests},
        {"modes", .on = &request.modes},
        {"linearize", .on = &request.linear},
        {"at", .read = read_at},
        {"kc", .on = &request.kinematics},
        {"sheet", .on = &request.sheet},
        {"manoeuvre", .text = &request.manoeuvre},
        {"trace", .text = &request.trace},
        {"loads", .on = &request.loads},
        {"axle", .text = &request.axle},
        {"travel", .read = read_travel},
        {"report", .text = &request.report},
        {"compare", .text = &request.compare},
        {"integrator", .text = &request.integrator},
        {"tolerance", .read = read_tolerance},
        {"engine", .read = read_engine},
        {"solve", .read = read_solve},
        {"recovery", .read = read_recovery},
        {"general", .on = &request.general},
        {"lanes", .read = read_lanes},
        {"cc", .text = &request.compiler},
        {"cflags", .text = &request.flags},
        {"quiet", 'q', .on = &request.quiet},
    };
    const int first =
        options_read("gicrun", help, count, word, option, (int)(sizeof option / sizeof *option), &request, NULL);
    const int files = count - first;
    if (files < 1)
        usage_fail("gicrun", "no model given", NULL);
    if (request.rests + request.modes + request.linear + request.kinematics + request.sheet + (request.states != NULL) +
            (request.manoeuvre != NULL) >
        1)
        usage_fail("gicrun",
                   "one of --eval, --equilibrium, --modes, --linearize, --kc, --sheet and --manoeuvre, please", NULL);
    if (!request.kinematics && (request.axle || request.travel > 0 || request.loads))
        usage_fail("gicrun", "--axle, --travel and --loads go with --kc", NULL);
    if (request.report && !request.kinematics && !request.manoeuvre)
        usage_fail("gicrun", "--report goes with --kc or --manoeuvre", NULL);
    if (request.trace && !request.manoeuvre)
        usage_fail("gicrun", "--trace goes with --manoeuvre", NULL);
    if (request.compare && !request.sheet && !request.manoeuvre && !request.kinematics)
        usage_fail("gicrun", "--compare goes with --kc, --sheet or --manoeuvre", NULL);
    if (request.compare && request.kinematics && (request.report || request.loads))
        usage_fail("gicrun",
                   "--kc --compare is a table at the position of set-up: it goes without --report and --loads", NULL);
    if (request.loads && (request.report || request.travel > 0))
        usage_fail("gicrun", "--loads is at the position of set-up: it goes without --travel and --report", NULL);
    if (request.report && !path_ends(request.report, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", request.report);
    const bool runs = is_run(&request), at = !isnan(request.at);
    if (at && !request.linear)
        usage_fail("gicrun", "--at goes with --linearize", NULL);
    if (files < 2 && (runs || at))
        usage_fail("gicrun", "no scene given", NULL);
    request.key = word + first + 1;
    request.keys = request.manoeuvre ? files - 1 : 0;
    if (files > 2 && !request.manoeuvre)
        usage_fail("gicrun", "one model and one scene, please; what is", word[first + 2]);
    request.model = word[first];
    request.scene = files > 1 && !request.manoeuvre ? word[first + 1] : NULL;
    if (!strcmp(request.model, "-"))
        usage_fail("gicrun", "the model must be a file", NULL);
    if (request.lanes && strcmp(request.engine, "cc") != 0)
        usage_fail("gicrun", "--lanes goes with --engine cc, not with", request.engine);
    if (request.linear && strcmp(request.engine, engine_name[0]) != 0 && strcmp(request.engine, "tape") != 0)
        usage_fail("gicrun", "derivatives are those of the engine tape: --linearize does not go with --engine",
                   request.engine);
    if (request.driven && !engine_generates(request.engine))
        usage_fail("gicrun", "a page of --drive runs generated code, and does not go with --engine", request.engine);
    if (request.integrator && integrator_method(request.integrator) < 0)
        usage_fail("gicrun", "there are ab3, rk4, adams and rkck; there is no integrator", request.integrator);
    if (request.picture && !runs)
        usage_fail("gicrun",
                   "--plot goes with a run, not with --eval, --equilibrium, --modes, --linearize, --kc, --sheet or "
                   "--manoeuvre",
                   NULL);
    if (request.picture && !plot_known(request.picture))
        usage_fail("gicrun", "the picture must end in .svg or .png, unlike", request.picture);
    if (request.with && !request.picture && !request.page)
        usage_fail("gicrun", "--with goes with --plot or --animate, which draw the other run beside this one", NULL);
    if (request.page && !runs)
        usage_fail("gicrun",
                   "--animate goes with a run, not with --eval, --equilibrium, --modes, --linearize, --kc, --sheet or "
                   "--manoeuvre",
                   NULL);
    if (request.page && !path_ends(request.page, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", request.page);
    if (request.driven && (!runs || request.results || request.picture || request.page || request.recording))
        usage_fail("gicrun",
                   "--drive writes a page and no results: it goes neither with -o, --plot, --animate and --replay "
                   "nor with --eval, --equilibrium, --modes, --linearize, --kc, --sheet and --manoeuvre",
                   NULL);
    if (request.driven && !path_ends(request.driven, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", request.driven);
    if (request.recording && !runs)
        usage_fail("gicrun",
                   "--replay goes with a run, not with --eval, --equilibrium, --modes, --linearize, --kc, --sheet or "
                   "--manoeuvre",
                   NULL);
    if (request.linear && request.results && !linear_file_known(request.results))
        usage_fail("gicrun", "the linear model must end in .csv, .npz or .mat, unlike", request.results);
    if (!request.results && !request.picture && !request.page && !request.driven &&
        (runs || request.states || request.linear))
        request.results = "-";
    return request;
}

static void linear(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const OperatingPoint point = operating_point(pool, model, scene, request->solve, request->at);
    linear_report(pool, model, &point, request);
}

/* The reports on the static equilibrium. */
static void analyse(Pool *pool, const Model *model, const Scene *scene, const Engine *engine, const Request *request)
{
    const Equilibrium *found = equilibrium_find(pool, model, scene, request->solve);
    if (request->rests)
        equilibrium_report(pool, engine, scene, request, found);
    else
        modes_report(pool, scene, request, found);
}

/* Refuse outputs that are inputs of the run, or one file. */
static void check_outputs(const Request *request, const Model *model, const Scene *scene)
{
    const char *const output[] = {request->results, request->picture, request->page,
                                  request->driven,  request->report,  request->trace};
    const Source states = {.path = request->states ? request->states : "-"};
    for (size_t i = 0; i < sizeof output / sizeof *output; ++i) {
        if (!output[i])
            continue;
        if (i > 0 && files_are_one(output[i], request->results))
            usage_fail("gicrun",
                       i == 1   ? "--plot needs another file than the results, which go to"
                       : i == 2 ? "--animate needs another file than the results, which go to"
                       : i == 4 ? "--report needs another file than the results, which go to"
                       : i == 5 ? "--trace needs another file than the results, which go to"
                                : "--drive needs another file than the results, which go to",
                       request->results);
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

int main(int count, char **word)
{
    Request request = read_command_line(count, word);
    Pool *pool = pool_new();
    const Model *model = model_read(pool, request.model);
    if (request.page || request.driven) /* the page shows forces of all wheels as arrows */
        model = model_watch_wheels(pool, model);
    const Scene *scene =
        request.scene ? scene_read(pool, request.scene, model, request.integrator, request.tolerance) : NULL;
    if (request.with)
        request.other = csv_read(pool, request.with, "time [s],chassis.z [m]", NULL);
    check_outputs(&request, model, scene);
    if (request.picture)
        plot_check(pool);
    if (request.manoeuvre) {
        manoeuvre_report(pool, model, &request);
        pool_free(pool);
        return 0;
    }
    if (request.kinematics || request.sheet) {
        (request.kinematics ? kc_report : sheet_report)(pool, model, scene, &request);
        pool_free(pool);
        return 0;
    }
    model = scene_rig(pool, model, &scene);
    if (request.linear) {
        linear(pool, model, scene, &request);
        pool_free(pool);
        return 0;
    }
    const bool runs = is_run(&request);
    if (runs)
        scene = equilibrium_start(pool, model, scene, request.solve);
    if (request.recording)
        scene = scene_replay(pool, model, scene, request.recording);
    const EngineOptions options = {.solve = request.solve,
                                   .recovery = request.recovery,
                                   .lanes = request.lanes,
                                   .compiler = request.compiler,
                                   .flags = request.flags,
                                   .quiet = request.quiet};
    /* a page shows whatever outputs tell; lanes are for code for all scenes */
    const bool general = request.general || request.page || request.driven || request.recording || request.lanes;
    const Engine *engine = runs ? engine_open_run(pool, request.engine, model, scene, general ? NULL : request.scene,
                                                  request.picture, &options)
                                : engine_open(pool, request.engine, model, &options);
    if (request.driven)
        drive_write(pool, model, scene, engine, &request);
    else if (request.states)
        evaluate(pool, engine, scene, &request);
    else if (request.rests || request.modes)
        analyse(pool, model, scene, engine, &request);
    else
        simulate(pool, engine, model, scene,
                 request.page ? animation_new(pool, model, scene, request.scene, request.other, name_of(request.with))
                              : NULL,
                 &request);
    engine_close(engine);
    pool_free(pool);
    return 0;
}
