/* SPDX-License-Identifier: MIT
 * gicrun: generate, compile and run a model. This file: the command line, over the library. */
#include "base/file.h"
#include "host/gic.h"
#include "host/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: gicrun MODEL.veh SCENE [-o results.csv] [--plot picture.svg|picture.png]\n"
    "              [--with other.csv] [--animate page.html] [--replay recording.csv]\n"
    "       gicrun --drive page.html MODEL.veh SCENE\n"
    "       gicrun --live PORT MODEL.veh SCENE [--inputs NAMES] [--seconds S] [-o results.csv]\n"
    "              [--record inputs.csv]\n"
    "       gicrun --eval states.csv MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --equilibrium|--modes MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --linearize [--at TIME] MODEL.veh [SCENE] [-o results.csv|.npz|.mat]\n"
    "       gicrun --gradient FORMULA MODEL.veh SCENE [NAME[=VALUE] ...] [-o page.html|gradient.csv]\n"
    "       gicrun --identify measured.csv MODEL.veh SCENE NAME ... [-o page.html|found.csv]\n"
    "       gicrun --optimize FORMULA MODEL.veh SCENE NAME=LOW:HIGH ... [-o page.html|found.csv]\n"
    "       gicrun --trim [--linearize] MODEL.veh [SCENE] key=value ... [-o results.csv|.scene]\n"
    "       gicrun --kc [--axle NAME] [--report page.html] MODEL.veh [SCENE] [-o results.csv]\n"
    "       gicrun --sheet MODEL.veh [SCENE] [-o page.html|results.csv]\n"
    "       gicrun --manoeuvre NAME MODEL.veh [key=value ...] [-o results.csv] [--trace FILE]\n"
    "              [--report page.html]\n"
    "\n"
    "Runs a scene with a vehicle model, or studies the model.\n"
    "\n";

static const char help[] =
    "  -o, --output FILE  results as CSV; - is standard output (default without a picture or page)\n"
    "      --plot FILE    draw the scene's `plot`, with gnuplot\n"
    "      --with FILE    draw other results too, in dots\n"
    "      --animate FILE write a page for a browser in which the model moves\n"
    "      --drive FILE   write a page in which one drives the model; needs clang and lld\n"
    "      --live PORT    run as fast as time passes, with inputs and outputs by UDP on this computer,\n"
    "                     models/LIVE.md; 0: a port that is free\n"
    "      --inputs NAMES of --live: those that packets give, between commas; else all\n"
    "      --joystick DEVICE  of --live: a joystick drives, /dev/input/js0, by --axes, words\n"
    "                     NAME=axis0:LOW:HIGH or NAME=button0:LOW:HIGH with commas between them\n"
    "      --seconds S    of --live: so long; else until Ctrl-C\n"
    "      --record FILE  of --live: the inputs as they were held\n"
    "      --replay FILE  repeat what a page of --drive or --live recorded\n"
    "      --eval FILE    CSV of states to evaluate, a column a name; - is standard input\n"
    "      --equilibrium  static equilibrium near the initial state; -o: as a row that --eval reads\n"
    "      --modes        eigenvalues, frequencies and damping of small motions about it, with\n"
    "                     the scene's velocities\n"
    "      --linearize    the linear model about the same state: A, B, C, D and derivatives by\n"
    "                     tunable parameters; -o: as CSV, or for NumPy or MATLAB\n"
    "      --at TIME      with --linearize: about a run of the scene at TIME, s\n"
    "      --trim         steady driving at speed=20, straight ahead, or at lateral=4 or\n"
    "                     curvature=0.01: state, steering and pedals; -o: as a row, as a scene\n"
    "      --gradient FORMULA\n"
    "                     derivatives of its value at the end, of integral(FORMULA) or of\n"
    "                     maximum(FORMULA) by initial state, parameters, inputs\n"
    "      --identify FILE parameters from measurements\n"
    "      --optimize FORMULA  numbers with which it is nearest to 0, models/OPTIMIZE.md\n"
    "      --kc           kinematics of axles over travel and steering, models/KC.md\n"
    "      --axle NAME, --travel M\n"
    "                     of --kc: front, rear or a number from the front; up and down, m (0.08)\n"
    "      --loads, --joints\n"
    "                     with --kc: compliance, or what joints and steering carry, instead\n"
    "      --sheet        the vehicle on a page, models/SHEET.md\n"
    "      --manoeuvre NAME one of models/MANOEUVRES.md; an unknown name lists\n"
    "      --vary NAME=LOW:HIGH:COUNT  of these: parameters, POINT.z, keys\n"
    "      --trace FILE   of --manoeuvre: what the vehicle did, as CSV\n"
    "      --report FILE  of --kc, --manoeuvre and --vary: a page of curves\n"
    "      --compare FILE with --kc, --sheet, --manoeuvre: another beside it, or a scene\n"
    "      --integrator NAME  in place of the scene's: ab3, rk4, ros2, ros3, imex, exp3, adams, rkck,\n"
    "                     bdf, auto\n"
    "      --tolerance NUMBER of these\n"
    "      --engine NAME  auto (default): generated code compiled in this process (tcc), in a\n"
    "                     long run by the C compiler too (cc); tape, gic, gcp1, gcp2;\n"
    "                     page: what a page of --drive computes\n"
    "      --solve FORM   of the equations of motion: auto, reduced, articulated or augmented\n"
    "      --recovery WAY of dependent coordinates: newton, closed or auto (default)\n"
    "      --general      code for any scene, not for this one alone\n"
    "      --lanes W      with --engine cc: vectors of 2, 4, 8 or 16 numbers\n"
    "      --cc COMMAND   C compiler of cc and auto; default: $CC or cc\n"
    "      --cflags FLAGS more options for it, in one word\n"
    "  -q, --quiet        neither progress nor summary\n"
    "  -h, --help, --version\n"
    "\n"
    "gicrun(1): $CC, $GICGEN_CACHE, $GICGEN_CACHE_SIZE, $XDG_CACHE_HOME and $TMPDIR.\n"
    "models/FORMAT.md describes models, models/SCENE.md scenes and columns of --eval.\n"
    "Exit status: 0 good, 1 error in a file or during the run, 2 wrong usage.\n";

/* What is asked for. */
enum { VARIED_MOST = 16 };

typedef struct Asked {
    const char *vary[VARIED_MOST]; /* [study.varied] */
    const char *model;
    bool rests, modes, linear, trim, kinematics, sheet, loads, joints, live, general, quiet;
    const char *animated, *driven, *report, *optimized; /* --animate, --drive, --report, --optimize */
    double at;                                          /* --at; NAN: not given */
    gicl_options options;
    gicl_study study;
} Asked;

static void read_tolerance(void *asked, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || !(value >= 1e-13 && value <= 0.1))
        usage_fail("gicrun", "--tolerance must be a number between 1e-13 and 0.1, unlike", word);
    ((Asked *)asked)->options.tolerance = value;
}

static void read_at(void *asked, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || end == word || !(value >= 0 && isfinite(value)))
        usage_fail("gicrun", "--at must be a time in s, 0 or more, unlike", word);
    ((Asked *)asked)->at = value;
}

static void read_travel(void *asked, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || end == word || !(value > 0 && value <= 10))
        usage_fail("gicrun", "--travel must be a length in m, above 0 and at most 10, unlike", word);
    ((Asked *)asked)->study.travel = value;
}

static void read_live(void *asked, char *word)
{
    ((Asked *)asked)->live = true;
    ((Asked *)asked)->study.port = (int)usage_whole(
        "gicrun", "--live takes a port from 1 to 65535, or 0 for one that is free, unlike", word, 0, 65535);
}

static void read_seconds(void *asked, char *word)
{
    char *end;
    const double value = strtod(word, &end);
    if (*end || end == word || !(value > 0 && value <= 1e9))
        usage_fail("gicrun", "--seconds must be a time in s, above 0 and at most 1e9, unlike", word);
    ((Asked *)asked)->study.seconds = value;
}

static void read_vary(void *asked, char *word)
{
    gicl_study *study = &((Asked *)asked)->study;
    if (study->varied == VARIED_MOST)
        usage_fail("gicrun", "--vary is given too often, with", word);
    ((Asked *)asked)->vary[study->varied++] = word;
}

/* Is a word one of those that an option may have? */
static bool known(const char *option, const char *word)
{
    const char *name;
    for (int i = 0; (name = gicl_word(option, i)); ++i)
        if (!strcmp(name, word))
            return true;
    return false;
}

static void read_engine(void *asked, char *name)
{
    const char *other;
    ((Asked *)asked)->options.engine = name;
    if (known("engine", name))
        return;
    fprintf(stderr, "gicrun: error: there is no engine '%s'\n  remedy: one of", name);
    for (int i = 0; (other = gicl_word("engine", i)); ++i)
        fprintf(stderr, "%s %s", i ? "," : "", other);
    fputs("\n", stderr);
    exit(2);
}

static void read_solve(void *asked, char *form)
{
    ((Asked *)asked)->options.solve = form;
    if (!known("solve", form))
        usage_fail("gicrun", "--solve takes auto, reduced, articulated or augmented, not", form);
}

static void read_recovery(void *asked, char *way)
{
    ((Asked *)asked)->options.recovery = way;
    if (!known("recovery", way))
        usage_fail("gicrun", "--recovery takes auto, newton or closed, not", way);
}

static void read_lanes(void *asked, char *word)
{
    static const char *const lanes[] = {"2", "4", "8", "16"};
    for (size_t i = 0; i < sizeof lanes / sizeof *lanes; ++i)
        if (!strcmp(word, lanes[i]))
            ((Asked *)asked)->options.lanes = 2 << i;
    if (!((Asked *)asked)->options.lanes)
        usage_fail("gicrun", "--lanes takes 2, 4, 8 or 16, not", word);
}

static bool linear_file_known(const char *path)
{
    return !strcmp(path, "-") || path_ends(path, ".csv") || path_ends(path, ".npz") || path_ends(path, ".mat");
}

static Asked read_command_line(int count, char **word)
{
    Asked asked = {.options = {.size = sizeof asked.options, .engine = gicl_word("engine", 0)},
                   .at = NAN,
                   .study = {.size = sizeof asked.study}};
    gicl_study *study = &asked.study;
    const Option option[] = {
        {"output", 'o', .text = &study->results},
        {"plot", .text = &study->plot},
        {"with", .text = &study->with},
        {"animate", .text = &asked.animated},
        {"drive", .text = &asked.driven},
        {"live", .read = read_live},
        {"seconds", .read = read_seconds},
        {"record", .text = &study->record},
        {"inputs", .text = &study->inputs},
        {"joystick", .text = &study->joystick},
        {"axes", .text = &study->axes},
        {"replay", .text = &study->replay},
        {"eval", .text = &study->states},
        {"equilibrium", .on = &asked.rests},
        {"modes", .on = &asked.modes},
        {"linearize", .on = &asked.linear},
        {"at", .read = read_at},
        {"trim", .on = &asked.trim},
        {"gradient", .text = &study->formula},
        {"identify", .text = &study->measured},
        {"optimize", .text = &asked.optimized},
        {"kc", .on = &asked.kinematics},
        {"sheet", .on = &asked.sheet},
        {"manoeuvre", .text = &study->manoeuvre},
        {"vary", .read = read_vary},
        {"trace", .text = &study->trace},
        {"loads", .on = &asked.loads},
        {"joints", .on = &asked.joints},
        {"axle", .text = &study->axle},
        {"travel", .read = read_travel},
        {"report", .text = &asked.report},
        {"compare", .text = &study->compare},
        {"integrator", .text = &asked.options.integrator},
        {"tolerance", .read = read_tolerance},
        {"engine", .read = read_engine},
        {"solve", .read = read_solve},
        {"recovery", .read = read_recovery},
        {"general", .on = &asked.general},
        {"lanes", .read = read_lanes},
        {"cc", .text = &asked.options.compiler},
        {"cflags", .text = &asked.options.flags},
        {"quiet", 'q', .on = &asked.quiet},
    };
    const int first = options_read("gicrun", (const char *const[]){usage, help, NULL}, count, word, option,
                                   (int)(sizeof option / sizeof *option), &asked, NULL);
    const int files = count - first;
    if (files < 1)
        usage_fail("gicrun", "no model given", NULL);
    const bool by_run = study->formula || study->measured || asked.optimized;
    const bool derives = asked.linear || asked.trim || by_run;
    if (asked.rests + asked.modes + (asked.linear || asked.trim) + asked.kinematics + asked.sheet +
            (study->states != NULL) + (study->manoeuvre != NULL) + (study->formula != NULL) +
            (study->measured != NULL) + (asked.optimized != NULL) >
        1)
        usage_fail("gicrun",
                   "one of --eval, --equilibrium, --modes, --linearize, --trim, --gradient, --identify, --optimize, "
                   "--kc, --sheet and --manoeuvre, please",
                   NULL);
    if (!asked.kinematics && (study->axle || study->travel > 0 || asked.loads || asked.joints))
        usage_fail("gicrun", "--axle, --travel, --loads and --joints go with --kc", NULL);
    if (asked.report && !asked.kinematics && !study->manoeuvre && !(asked.sheet && study->varied))
        usage_fail("gicrun", "--report goes with --kc, --manoeuvre or --vary", NULL);
    if (study->varied && !asked.kinematics && !study->manoeuvre && !asked.sheet)
        usage_fail("gicrun", "--vary goes with --kc, --sheet or --manoeuvre; scenes are varied by gicsweep", NULL);
    if (study->varied && study->trace)
        usage_fail("gicrun", "--vary goes without --trace", NULL);
    if ((study->varied || asked.kinematics || study->manoeuvre) && study->results && path_ends(study->results, ".html"))
        usage_fail("gicrun", "with --kc, --manoeuvre and --vary a page is made by --report, not by -o", study->results);
    if (study->trace && !study->manoeuvre)
        usage_fail("gicrun", "--trace goes with --manoeuvre", NULL);
    if (study->compare && !asked.sheet && !study->manoeuvre && !asked.kinematics)
        usage_fail("gicrun", "--compare goes with --kc, --sheet or --manoeuvre", NULL);
    if (study->compare && path_ends(word[first], ".scene"))
        usage_fail("gicrun", "a scene to compare with stands after --compare, the model at the end, not", word[first]);
    if (asked.loads && asked.joints)
        usage_fail("gicrun", "one of --loads and --joints, please", NULL);
    if (asked.loads && study->travel > 0)
        usage_fail("gicrun", "--loads is at the position of set-up: it goes without --travel", NULL);
    if (asked.report && !path_ends(asked.report, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", asked.report);
    const bool runs = !study->states && !asked.rests && !asked.modes && !derives && !asked.kinematics && !asked.sheet &&
                      !study->manoeuvre;
    const bool at = !isnan(asked.at);
    if (at && !asked.linear)
        usage_fail("gicrun", "--at goes with --linearize", NULL);
    if (at && asked.trim)
        usage_fail("gicrun", "the operating point is that of --at or that of --trim, not both", NULL);
    if (files < 2 && (runs || at || by_run))
        usage_fail("gicrun", "no scene given", NULL);
    const bool keyed = study->manoeuvre || asked.trim || by_run;
    const bool keys_first = study->manoeuvre || (asked.trim && files > 1 && strchr(word[first + 1], '='));
    const int scenes = files > 1 && !keys_first;
    study->key = (const char *const *)word + first + 1 + scenes;
    study->keys = keyed ? files - 1 - scenes : 0;
    if (asked.trim && study->keys == 0)
        usage_fail("gicrun", "--trim needs a speed, m/s: gicrun --trim MODEL.veh speed=20 lateral=4", NULL);
    if (files > 2 && !keyed)
        usage_fail("gicrun", "one model and one scene, please; what is", word[first + 2]);
    asked.model = word[first];
    if (keyed && strchr(asked.model, '=') && access(asked.model, F_OK) != 0)
        usage_fail("gicrun", "the model comes before key=value, not after", asked.model);
    study->scene = scenes ? word[first + 1] : NULL;
    if (!strcmp(asked.model, "-"))
        usage_fail("gicrun", "the model must be a file", NULL);
    if (asked.options.lanes && strcmp(asked.options.engine, "cc") != 0)
        usage_fail("gicrun", "--lanes goes with --engine cc, not with", asked.options.engine);
    if (derives && strcmp(asked.options.engine, gicl_word("engine", 0)) != 0 &&
        strcmp(asked.options.engine, "tape") != 0)
        usage_fail("gicrun",
                   asked.linear      ? "derivatives are those of the engine tape: --linearize does not go with --engine"
                   : asked.trim      ? "derivatives are those of the engine tape: --trim does not go with --engine"
                   : study->formula  ? "derivatives are those of the engine tape: --gradient does not go with --engine"
                   : study->measured ? "derivatives are those of the engine tape: --identify does not go with --engine"
                                     : "derivatives are those of the engine tape: --optimize does not go with --engine",
                   asked.options.engine);
    if (asked.options.integrator && !known("integrator", asked.options.integrator))
        usage_fail("gicrun",
                   "there are ab3, rk4, ros2, ros3, imex, exp3, adams, rkck, bdf and auto; there is no integrator",
                   asked.options.integrator);
    if (study->plot && !runs)
        usage_fail("gicrun",
                   "--plot goes with a run, not with --eval, --equilibrium, --modes, --linearize, --trim, --gradient, "
                   "--identify, --optimize, --kc, "
                   "--sheet or "
                   "--manoeuvre",
                   NULL);
    if (study->plot && !plot_known(study->plot))
        usage_fail("gicrun", "the picture must end in .svg or .png, unlike", study->plot);
    if (study->with && !study->plot && !asked.animated)
        usage_fail("gicrun", "--with goes with --plot or --animate, which draw the other run beside this one", NULL);
    if (asked.animated && !runs)
        usage_fail("gicrun",
                   "--animate goes with a run, not with --eval, --equilibrium, --modes, --linearize, --trim, "
                   "--gradient, --identify, --optimize, --kc, "
                   "--sheet or "
                   "--manoeuvre",
                   NULL);
    if (asked.animated && !path_ends(asked.animated, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", asked.animated);
    if (asked.driven && (!runs || study->results || study->plot || asked.animated || study->replay))
        usage_fail("gicrun",
                   "--drive writes a page and no results: it goes neither with -o, --plot, --animate and --replay "
                   "nor with --eval, --equilibrium, --modes, --linearize, --trim, --gradient, --identify, "
                   "--optimize, --kc, --sheet and --manoeuvre",
                   NULL);
    if (asked.driven && !path_ends(asked.driven, ".html"))
        usage_fail("gicrun", "the page must end in .html, unlike", asked.driven);
    if (asked.live && (!runs || study->plot || asked.animated || asked.driven || study->replay))
        usage_fail("gicrun",
                   "--live is a run that time and packets drive: it goes neither with --plot, --animate, --drive and "
                   "--replay nor with --eval, --equilibrium, --modes, --linearize, --trim, --gradient, --identify, "
                   "--optimize, --kc, --sheet and --manoeuvre",
                   NULL);
    if (!asked.live && (study->record || study->inputs || study->joystick || study->axes || study->seconds > 0))
        usage_fail("gicrun", "--inputs, --joystick, --axes, --record and --seconds go with --live", NULL);
    if (!study->joystick != !study->axes)
        usage_fail("gicrun", "--joystick and --axes go together: a device, and what it moves", NULL);
    if (study->replay && !runs)
        usage_fail("gicrun",
                   "--replay goes with a run, not with --eval, --equilibrium, --modes, --linearize, --trim, "
                   "--gradient, --identify, --optimize, --kc, "
                   "--sheet or "
                   "--manoeuvre",
                   NULL);
    if (asked.linear && study->results && !linear_file_known(study->results))
        usage_fail("gicrun", "the linear model must end in .csv, .npz or .mat, unlike", study->results);
    if (asked.trim && !asked.linear && study->results && strcmp(study->results, "-") != 0 &&
        !path_ends(study->results, ".csv") && !path_ends(study->results, ".scene"))
        usage_fail("gicrun", "the motion must end in .csv or .scene, unlike", study->results);
    if (!study->results && !study->plot && !asked.animated && !asked.driven && !asked.live &&
        (runs || study->states || asked.linear))
        study->results = "-";
    study->kind = study->states      ? "eval"
                  : asked.rests      ? "equilibrium"
                  : asked.modes      ? "modes"
                  : asked.linear     ? "linearize"
                  : asked.trim       ? "trim"
                  : study->formula   ? "gradient"
                  : study->measured  ? "identify"
                  : asked.optimized  ? "optimize"
                  : asked.kinematics ? "kc"
                  : asked.sheet      ? "sheet"
                  : study->manoeuvre ? "manoeuvre"
                  : asked.driven     ? "drive"
                  : asked.live       ? "live"
                                     : "run";
    study->formula = asked.optimized ? asked.optimized : study->formula;
    study->page = asked.animated ? asked.animated : asked.driven ? asked.driven : asked.report;
    study->loads = asked.loads;
    study->joints = asked.joints;
    study->quiet = asked.quiet;
    asked.options.general = asked.general;
    return asked;
}

/* Outputs that are one file with the results. */
static void check_outputs(const Asked *asked)
{
    const gicl_study *study = &asked->study;
    const struct {
        const char *path, *message;
    } output[] = {{study->plot, "--plot needs another file than the results, which go to"},
                  {asked->animated, "--animate needs another file than the results, which go to"},
                  {asked->report, "--report needs another file than the results, which go to"},
                  {study->trace, "--trace needs another file than the results, which go to"},
                  {study->record, "--record needs another file than the results, which go to"}};
    for (size_t i = 0; i < sizeof output / sizeof *output; ++i)
        if (files_are_one(output[i].path, study->results))
            usage_fail("gicrun", output[i].message, study->results);
}

int main(int count, char **word)
{
    Asked asked = read_command_line(count, word);
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
    if (status == GICL_OK) {
        check_outputs(&asked);
        asked.study.vary = asked.vary;
        asked.study.at = isnan(asked.at) ? NULL : &asked.at;
        status = gicl_write(library, model, &asked.study, said);
    }
    gicl_messages_free(said);
    gicl_close(library);
    return terminal_close("gicrun", status); /* GICL_FAILED and GICL_WRONG are exit statuses */
}
