/* SPDX-License-Identifier: MIT
 * --manoeuvre: the manoeuvres by name with their keys, and what is written: a table, CSV, time histories, a page. */
#include "base/file.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/manoeuvre.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SPEED(value) \
    { \
        "speed", "m/s", "speed", value, 1, 120 \
    }
#define GRADIENTS \
    {"low", "m/s^2", "lateral acceleration from which gradients are taken", 0.5, 0.01, 10}, \
        {"high", "m/s^2", "and up to which", 2, 0.05, 12}, \
    { \
        "growth", "m/s^3", "of the lateral acceleration", 0.2, 0.02, 2 \
    }

const ManoeuvreKind manoeuvre_kind[] = {
    {"steady-speed",
     "Steady cornering, constant speed",
     manoeuvre_steady_speed,
     {SPEED(22.222222222222221), GRADIENTS}},
    {"steady-radius",
     "Steady cornering, constant radius",
     manoeuvre_steady_radius,
     {{"radius", "m", "of the circle", 40, 5, 1000}, GRADIENTS}},
    {"step-steer",
     "Step of the steering",
     manoeuvre_step_steer,
     {SPEED(22.222222222222221), {"ay", "m/s^2", "lateral acceleration in the end", 4, 0.1, 15}}},
    {"ramp-steer",
     "Ramp of the steering",
     manoeuvre_ramp_steer,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "lateral acceleration in the end", 4, 0.1, 15},
      {"rate", "rad/s", "of the steer angle of the wheels", 0.05, 0.001, 2}}},
    {"sine",
     "A period of a sine of the steering",
     manoeuvre_sine,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "lateral acceleration of the first peak", 4, 0.1, 15},
      {"frequency", "Hz", "of the sine", 0.5, 0.1, 4}}},
    {"sine-dwell",
     "Sine with dwell",
     manoeuvre_sine_dwell,
     {SPEED(22.222222222222221), {"most", "A", "largest amplitude, in angles of 0.3 g", 6.5, 1.5, 20}}},
    {"frequency",
     "Frequency response to steering",
     manoeuvre_frequency,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "steady lateral acceleration of the amplitude", 1, 0.01, 8},
      {"to", "Hz", "highest frequency", 3, 1, 10},
      {"duration", "s", "of the sweep", 60, 10, 600}}},
    {"random",
     "Random steering",
     manoeuvre_random,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "steady lateral acceleration of the steering's rms", 1, 0.01, 8},
      {"to", "Hz", "highest frequency", 3, 1, 10},
      {"duration", "s", "of the steering", 120, 30, 1200},
      {"seed", "", "of the phases", 1, 0, 1e9}}},
    {"lane-change",
     "Double lane change",
     manoeuvre_lane_change,
     {{"width", "m", "of the vehicle; 0: of its wheels", 0, 0, 4}, {"part", "", "of ISO 3888: 1 or 2", 2, 1, 2}}},
    {"single-lane-change",
     "Single lane change",
     manoeuvre_single_lane_change,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "lateral acceleration of the path", 2, 0.1, 8},
      {"frequency", "Hz", "of its sine", 0.4, 0.1, 2}}},
    {"lift-off",
     "Accelerator released in a turn",
     manoeuvre_lift_off,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "lateral acceleration in the turn", 4, 0.1, 15},
      {"driver", "", "1: a driver keeps the circle; 0: the steering stays", 0, 0, 1}}},
    {"turn-braking",
     "Braking in a turn",
     manoeuvre_turn_braking,
     {SPEED(22.222222222222221),
      {"ay", "m/s^2", "lateral acceleration in the turn", 4, 0.1, 15},
      {"brake", "1", "pedal at most", 0.5, 0.01, 1},
      {"driver", "", "1: a driver keeps the circle; 0: the steering stays", 0, 0, 1}}},
    {"j-turn",
     "J-turn",
     manoeuvre_j_turn,
     {{"speed", "m/s", "the fastest", 26.8224, 5, 60},
      {"from", "m/s", "the slowest", 15.6464, 5, 60},
      {"angle", "A", "of the steering, in angles of 0.3 g", 8, 1, 20},
      {"rate", "rad/s", "of the steer angle of the wheels", 1, 0.1, 10}}},
    {"fishhook",
     "Fishhook",
     manoeuvre_fishhook,
     {{"speed", "m/s", "the fastest", 22.352, 5, 60},
      {"from", "m/s", "the slowest", 15.6464, 5, 60},
      {"angle", "A", "of the steering, in angles of 0.3 g", 6.5, 1, 20},
      {"rate", "rad/s", "of the steer angle of the wheels", 0.75, 0.1, 10}}},
    {"braking",
     "Braking straight ahead",
     manoeuvre_braking,
     {SPEED(27.777777777777779), {"brake", "1", "pedal", 1, 0.01, 1}}},
    {"split-braking",
     "Braking on split friction",
     manoeuvre_split_braking,
     {SPEED(22.222222222222221),
      {"brake", "1", "pedal", 0.3, 0.01, 1},
      {"low", "1", "friction of the left side, of the right one", 0.3, 0.01, 1},
      {"driver", "", "1: steers straight ahead; 0: nobody does", 1, 0, 1}}},
    {"coast-down",
     "Coast-down",
     manoeuvre_coast,
     {SPEED(27.777777777777779), {"to", "m/s", "speed at its end", 5, 0.5, 100}}},
    {"acceleration",
     "Acceleration from rest",
     manoeuvre_acceleration,
     {{"accelerator", "1", "pedal", 1, 0.01, 1}, {"duration", "s", "at most", 120, 5, 1000}}},
    {"elasticity",
     "Acceleration from a speed",
     manoeuvre_elasticity,
     {{"low", "m/s", "from", 16.666666666666668, 1, 100},
      {"high", "m/s", "to", 27.777777777777779, 2, 120},
      {"accelerator", "1", "pedal", 1, 0.01, 1}}},
    {"ride",
     "Ride on a random road",
     manoeuvre_ride,
     {SPEED(22.222222222222221),
      {"class", "", "of the road by ISO 8608: 1 is A, 8 is H", 2, 1, 8},
      {"duration", "s", "that is evaluated", 60, 10, 600},
      {"seed", "", "of the road", 1, 0, 1e9}}},
    {"ride-speeds",
     "Ride at several speeds",
     manoeuvre_ride_speeds,
     {{"low", "m/s", "the slowest", 5, 1, 100},
      {"high", "m/s", "the fastest", 25, 2, 120},
      {"class", "", "of the road by ISO 8608: 1 is A, 8 is H", 2, 1, 8},
      {"duration", "s", "that is evaluated", 30, 10, 600},
      {"seed", "", "of the road", 1, 0, 1e9}}},
    {"four-post",
     "On four posts",
     manoeuvre_posts,
     {{"speed", "m/s", "of the road that passes under it", 22.222222222222221, 1, 120},
      {"class", "", "of the road by ISO 8608: 1 is A, 8 is H", 2, 1, 8},
      {"duration", "s", "of the road", 30, 10, 600},
      {"seed", "", "of the road", 1, 0, 1e9},
      {"amplitude", "m", "of the posts in sweeps", 0.001, 1e-5, 0.1},
      {"to", "Hz", "highest frequency of sweeps", 20, 2, 50}}},
    {0}};

void manoeuvre_keep(Manoeuvre *manoeuvre, const Trial *trial)
{
    *POOL_PUSH(manoeuvre->pool, manoeuvre->trial, manoeuvre->trials) = trial;
}

/* ---- the command line ----------------------------------------------------------------------------------- */

static const ManoeuvreKind *kind_of(Pool *pool, const char *name)
{
    for (const ManoeuvreKind *kind = manoeuvre_kind; kind->name; ++kind)
        if (!strcmp(kind->name, name))
            return kind;
    Text known = {.pool = pool};
    for (const ManoeuvreKind *kind = manoeuvre_kind; kind->name; ++kind)
        text_print(&known, "%s %s", kind == manoeuvre_kind ? "one of" : ",", kind->name);
    diag_fail_call(program_place(), known.s, "there is no manoeuvre '%s'", name);
}

static _Noreturn void refuse_key(Pool *pool, const ManoeuvreKind *kind, const char *word)
{
    Text known = {.pool = pool};
    for (int k = 0; k < MANOEUVRE_KEYS && kind->key[k].name; ++k)
        text_print(&known, "%s %s=%.6g%s%s (%s; %g to %g)", k ? "," : "one of", kind->key[k].name, kind->key[k].value,
                   *kind->key[k].unit ? " " : "", kind->key[k].unit, kind->key[k].about, kind->key[k].least,
                   kind->key[k].most);
    diag_fail_call(program_place(), known.s, "%s takes no '%s'", kind->name, word);
}

/* key=value of the command line; given: the keys before it. */
static void read_key(Pool *pool, const ManoeuvreKind *kind, const char *word, double *value, bool *given)
{
    static const char decimal[] = "0123456789+-.eE"; /* strtod() takes others, too: 0x10, inf */
    const char *sign = strchr(word, '=');
    for (int k = 0; sign && k < MANOEUVRE_KEYS && kind->key[k].name; ++k) {
        const ManoeuvreKey *key = &kind->key[k];
        if (strlen(key->name) != (size_t)(sign - word) || strncmp(key->name, word, (size_t)(sign - word)) != 0)
            continue;
        char *end;
        value[k] = strtod(sign + 1, &end);
        if (*end || end == sign + 1 || sign[1 + strspn(sign + 1, decimal)] ||
            !(value[k] >= key->least && value[k] <= key->most))
            diag_fail_call(program_place(), pool_print(pool, "%s=%.6g is usual", key->name, key->value),
                           "'%s' is no decimal number from %.6g to %.6g %s", word, key->least, key->most, key->unit);
        if (!*key->unit && value[k] != round(value[k]))
            diag_fail_call(program_place(), pool_print(pool, "%s=%.6g is usual", key->name, key->value),
                           "'%s' is no whole number from %.6g to %.6g", word, key->least, key->most);
        if (given[k])
            diag_fail_call(program_place(), "leave one out", "'%s' is given twice, the second time by '%s'", key->name,
                           word);
        given[k] = true;
        return;
    }
    refuse_key(pool, kind, word);
}

static int key_of(const ManoeuvreKind *kind, const char *name)
{
    int k = 0;
    while (strcmp(kind->key[k].name, name) != 0)
        ++k;
    return k;
}

/* Keys that have to be below others, and by how much at least: gradients need a way between. */
static void check_order(Pool *pool, const ManoeuvreKind *kind, const double *value)
{
    static const struct {
        const char *manoeuvre, *low, *high;
        double apart;
    } of[] = {{"steady-speed", "low", "high", 0.1}, {"steady-radius", "low", "high", 0.1},
              {"coast-down", "to", "speed", 0.1},   {"elasticity", "low", "high", 0.1},
              {"ride-speeds", "low", "high", 0.1},  {"j-turn", "from", "speed", 0},
              {"fishhook", "from", "speed", 0}};
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        if (strcmp(kind->name, of[i].manoeuvre) != 0)
            continue;
        const int low = key_of(kind, of[i].low), high = key_of(kind, of[i].high);
        if (value[high] - value[low] > of[i].apart * (1 - 1e-9))
            continue;
        diag_fail_call(program_place(),
                       pool_print(pool, "choose %s below %s; %s=%.6g and %s=%.6g are usual", of[i].low, of[i].high,
                                  of[i].low, kind->key[low].value, of[i].high, kind->key[high].value),
                       "%s=%.6g is not %sbelow %s=%.6g %s", of[i].low, value[low],
                       value[low] < value[high] ? "0.1 " : "", of[i].high, value[high], kind->key[low].unit);
    }
}

/* ---- results -------------------------------------------------------------------------------------------- */

/* Rows of all trials, SI. */
static void write_trace(const Manoeuvre *m, const char *path)
{
    const Model *model = m->car->model;
    const int channels = m->car->units ? TRIAL_CHANNELS : TRIAL_OF_ONE;
    interrupt_hold();
    Csv csv = csv_open(m->pool, path);
    csv_name(&csv, "trial", NULL);
    for (int c = 0; c < channels; ++c)
        csv_name(&csv, trial_signal[c].name,
                 c != TRIAL_STEER       ? trial_signal[c].unit
                 : m->car->steering < 0 ? "1"
                                        : model->input[m->car->steering].unit);
    for (int w = 0; w < model->wheels; ++w) {
        csv_name(&csv, pool_print(m->pool, "%s.load", model->wheel[w].name), "N");
        csv_name(&csv, pool_print(m->pool, "%s.road", model->wheel[w].name), "m");
        const int travel = m->car->travel[w];
        csv_name(&csv, pool_print(m->pool, "%s.travel", model->wheel[w].name),
                 travel >= 0 && model->coordinate[travel].type == COORDINATE_ANGLE ? "rad" : "m");
    }
    csv_end_row(&csv);
    for (int t = 0; t < m->trials; ++t)
        for (int i = 0; i < m->trial[t]->rows; ++i) {
            csv_name(&csv, m->trial[t]->name, NULL);
            csv_time(&csv, m->trial[t]->row[i][TRIAL_TIME]);
            for (int c = 1; c < channels; ++c)
                csv_number(&csv, m->trial[t]->row[i][c]);
            for (int k = 0; k < model->wheels * TRIAL_OF_WHEEL; ++k)
                csv_number(&csv, m->trial[t]->wheel[i * model->wheels * TRIAL_OF_WHEEL + k]);
            csv_end_row(&csv);
        }
    csv_close(&csv);
    interrupt_release();
}

/* Straight ahead, told from there on: lateral acceleration, m/s^2, and roll, rad. */
static const double slight[] = {0.01, 1e-3};

static const char *side(double left)
{
    return left > 0 ? "left" : "right";
}

static Manoeuvre drive(Pool *pool, const Model *model, const ManoeuvreKind *kind, const double *value,
                       const Request *request)
{
    Manoeuvre m = {.pool = pool, .value = value};
    m.car = car_open(pool, model, request);
    if (!request->quiet)
        equilibrium_warn_ranges(m.car->sheet.found, (Place){model->source, 0, 0});
    m.result = pool_alloc(pool, sizeof *m.result);
    *m.result = (Sheet){.pool = pool, .model = model};
    kind->run(&m);
    manoeuvre_pedal_rows(&m);
    if (m.car->sheet.kc->units)
        sheet_note(m.result, m.car->sheet.kc->units);
    const double *aside = m.car->aside;
    if (fabs(aside[0]) > slight[0] || fabs(aside[1]) > slight[1])
        sheet_note(m.result,
                   pool_print(pool,
                              "straight ahead at %.3g m/s, with the steering as it is set up, the vehicle "
                              "%s%s: left and right differ",
                              aside[2],
                              fabs(aside[0]) > slight[0] / 100 ? pool_print(pool, "turns to the %s by %.2g m/s^2 and ",
                                                                            side(aside[0]), fabs(aside[0]))
                                                               : "",
                              pool_print(pool, "leans to the %s by %.2g deg", side(aside[1]),
                                         57.29577951308232 * fabs(aside[1]))));
    engine_rest(m.car->engine);
    return m;
}

/* The values of a manoeuvre's keys, [MANOEUVRE_KEYS]. */
static void read_keys(Pool *pool, const ManoeuvreKind *kind, const Request *request, double *value)
{
    bool given[MANOEUVRE_KEYS] = {false};
    for (int k = 0; k < MANOEUVRE_KEYS; ++k)
        value[k] = kind->key[k].value;
    for (int k = 0; k < request->keys; ++k)
        read_key(pool, kind, request->key[k], value, given);
    check_order(pool, kind, value);
}

const ManoeuvreKey *manoeuvre_key(Pool *pool, const char *manoeuvre, const char *name)
{
    const ManoeuvreKind *kind = kind_of(pool, manoeuvre);
    for (int k = 0; k < MANOEUVRE_KEYS && kind->key[k].name; ++k)
        if (!strcmp(kind->key[k].name, name))
            return &kind->key[k];
    return NULL;
}

Manoeuvre manoeuvre_drive(Pool *pool, const Model *model, const Request *request)
{
    const ManoeuvreKind *kind = kind_of(pool, request->manoeuvre);
    double *value = pool_alloc(pool, MANOEUVRE_KEYS * sizeof *value);
    read_keys(pool, kind, request, value);
    return drive(pool, model, kind, value, request);
}

void manoeuvre_report(Pool *pool, const Model *model, const Request *request)
{
    const ManoeuvreKind *kind = kind_of(pool, request->manoeuvre);
    Manoeuvre m = manoeuvre_drive(pool, model, request);
    const char *name = NULL;
    Manoeuvre other;
    if (request->compare) {
        other = manoeuvre_drive(pool, sheet_other(pool, model, request->compare, &name), request);
        sheet_compare(m.result, other.result, name);
        engine_close(other.car->engine);
    }
    if (request->trace)
        write_trace(&m, request->trace);
    if (request->report)
        manoeuvre_page(&m, name ? &other : NULL, name, kind, request->report);
    if (request->results)
        sheet_csv(m.result, request->results);
    else
        sheet_print(m.result, pool_print(pool, ": %s, models/MANOEUVRES.md defines these", kind->title));
    sheet_notes(m.result, request);
    engine_close(m.car->engine);
}
