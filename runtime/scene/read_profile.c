/* SPDX-License-Identifier: MIT
 * Profiles of inputs as scenes write them: models/SCENE.md section 4. */
#include "base/table.h"
#include "base/yaml.h"
#include "model/model.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* Rising times and as many values, from the keys `times` and `values`. */
static void read_points(Pool *pool, const Item *item, const char *what, Profile *profile)
{
    const Item *times = scene_need(item, "times", what), *values = scene_need(item, "values", what);
    profile->time = scene_numbers(pool, times, pool_print(pool, "times of %s", what), 1);
    profile->value = scene_numbers(pool, values, pool_print(pool, "values of %s", what), 1);
    profile->count = times->count;
    if (values->count != times->count)
        diag_fail(values->at, "one value for each time", "%s have %d times and %d values", what, times->count,
                  values->count);
    for (int i = 1; i < times->count; ++i)
        if (profile->time[i] <= profile->time[i - 1])
            diag_fail(times->value[i]->at, pool_print(pool, "sort the %s by time", what), "times of %s must rise",
                      what);
}

static void read_knots(Pool *pool, const Item *item, Profile *profile)
{
    CHECK_KEYS(item, "knots", "times", "values");
    read_points(pool, item, "knots", profile);
}

/* As knots, from a list. */
static void set_knots(Pool *pool, Profile *profile, int count, const double *time, const double *value)
{
    const size_t size = sizeof(double) * (size_t)count;
    profile->count = count;
    profile->time = memcpy(pool_alloc(pool, size), time, size);
    profile->value = memcpy(pool_alloc(pool, size), value, size);
}

static void read_constant(Pool *pool, const Item *item, Profile *profile)
{
    const double value = doc_number(item, "value of an input");
    set_knots(pool, profile, 1, (double[1]){0}, &value);
}

static void read_sine(Pool *pool, const Item *item, Profile *profile)
{
    (void)pool;
    CHECK_KEYS(item, "a sine input", "amplitude", "frequency", "offset", "start");
    profile->form = PROFILE_SINE;
    profile->amplitude = doc_number(scene_need(item, "amplitude", "a sine input"), "amplitude");
    profile->frequency = scene_positive(scene_need(item, "frequency", "a sine input"), "frequency");
    profile->offset = scene_number(item, "offset", "offset", profile->offset);
    profile->start = scene_number(item, "start", "start", 0);
}

static void read_chirp(Pool *pool, const Item *item, Profile *profile)
{
    const char *const what = "a chirp input";
    CHECK_KEYS(item, what, "amplitude", "from", "to", "duration", "growth", "offset", "start");
    const Item *duration = scene_need(item, "duration", what), *growth = doc_find(item, "growth");
    const char *word = growth ? doc_word(growth, "growth") : "linear";
    profile->form = PROFILE_CHIRP;
    profile->amplitude = doc_number(scene_need(item, "amplitude", what), "amplitude");
    profile->frequency = scene_positive(scene_need(item, "from", what), "the first frequency");
    profile->last = scene_positive(scene_need(item, "to", what), "the last frequency");
    profile->offset = scene_number(item, "offset", "offset", profile->offset);
    profile->start = scene_number(item, "start", "start", 0);
    profile->end = profile->start + scene_positive(duration, "duration of a chirp");
    if (strcmp(word, "linear") && strcmp(word, "logarithmic"))
        diag_fail(growth->at, "write linear or logarithmic", "the frequency of a chirp can't grow in a way '%s'", word);
    profile->logarithmic = !strcmp(word, "logarithmic") && profile->last != profile->frequency;
    const double least = 1 / profile->frequency + 1 / profile->last;
    if (profile->end - profile->start < least)
        diag_fail(duration->at, pool_print(pool, "write at least %.6g", least),
                  "the chirp is shorter than its first and its last period, over which it fades in and out");
}

typedef struct Move {
    double from, to, start, duration;
} Move;

static Move read_move(const Item *item, const char *what, const char *duration, const Profile *profile)
{
    Move move = {.from = scene_number(item, "from", "from", profile->offset),
                 .to = doc_number(scene_need(item, "to", what), "to"),
                 .start = scene_number(item, "start", "start", 0)};
    move.duration = scene_positive(scene_need(item, duration, what), duration);
    return move;
}

static void read_step(Pool *pool, const Item *item, Profile *profile)
{
    CHECK_KEYS(item, "a step input", "from", "to", "start", "rise");
    const Move m = read_move(item, "a step input", "rise", profile);
    set_knots(pool, profile, 2, (double[2]){m.start, m.start + m.duration}, (double[2]){m.from, m.to});
}

/* A straight move with corners, over `blend` s each, in which the rate follows 3 s^2 - 2 s^3. */
static void read_ramp(Pool *pool, const Item *item, Profile *profile)
{
    CHECK_KEYS(item, "a ramp input", "from", "to", "start", "duration", "blend");
    const Move m = read_move(item, "a ramp input", "duration", profile);
    const Item *corner = doc_find(item, "blend");
    const double blend = corner ? scene_positive(corner, "blend") : m.duration / 10;
    if (blend > m.duration / 2)
        diag_fail(corner->at, pool_print(pool, "write at most %.6g", m.duration / 2),
                  "the ramp's two corners are longer than the ramp");
    const double rate = (m.to - m.from) / (m.duration - blend), corners = rate * blend / 2, end = m.start + m.duration;
    const bool straight = end - blend > m.start + blend; /* else the corners meet */
    const double time[4] = {m.start, m.start + blend, end - blend, end};
    const double value[4] = {m.from, m.from + corners, m.to - corners, m.to}, rates[4] = {0, rate, rate, 0};
    set_knots(pool, profile, 4, time, value);
    profile->form = PROFILE_CURVE;
    profile->rate = memcpy(pool_alloc(pool, sizeof rates), rates, sizeof rates);
    profile->acceleration = pool_alloc(pool, sizeof rates); /* 0 */
    if (straight)
        return;
    profile->count = 3;
    profile->time[2] = end;
    profile->value[2] = m.to;
    profile->rate[2] = 0;
}

/* `count` moves there and back, `period` apart. */
static void read_pulse(Pool *pool, const Item *item, Profile *profile)
{
    const char *const what = "a pulse input";
    enum { PULSES = 100000 };
    CHECK_KEYS(item, what, "from", "to", "start", "rise", "duration", "period", "count");
    const Move m = read_move(item, what, "rise", profile);
    const Item *length = scene_need(item, "duration", what), *again = doc_find(item, "period");
    const Item *many = doc_find(item, "count");
    const double duration = scene_positive(length, "duration"), period = again ? scene_positive(again, "period") : 0;
    const double count = many ? scene_positive(many, "count") : 1;
    const double rounding = 1e-12 * duration; /* of numbers that are meant to be equal */
    if (duration < 2 * m.duration - rounding)
        diag_fail(length->at, pool_print(pool, "write at least %.6g, twice the rise", 2 * m.duration),
                  "the pulse ends before it has risen and fallen");
    if (count != floor(count) || count > (double)PULSES)
        diag_fail(many->at, "write how many pulses there are", "count must be a whole number from 1 to %d", PULSES);
    if (count > 1 && !again)
        diag_fail(many->at, "add `period: ...`", "several pulses need the key 'period'");
    if (count > 1 && period < duration - rounding)
        diag_fail(again->at, pool_print(pool, "write at least %.6g", duration), "a pulse begins before the last ended");
    const int knots = 4 * (int)count;
    profile->time = pool_alloc(pool, sizeof(double) * (size_t)knots);
    profile->value = pool_alloc(pool, sizeof(double) * (size_t)knots);
    profile->count = 0;
    for (int i = 0; i < knots; ++i) {
        const double begin = m.start + i / 4 * period;
        const double edge[4] = {0, m.duration, duration - m.duration, duration}, time = begin + edge[i % 4];
        /* a pulse that falls once it has risen, or begins as the last ends, has one knot there */
        if (profile->count > 0 && time <= profile->time[profile->count - 1] + rounding)
            continue;
        profile->time[profile->count] = time;
        profile->value[profile->count++] = i % 4 == 1 || i % 4 == 2 ? m.to : m.from;
    }
}

/* ---- curves through samples --------------------------------------------------------------------------------- */

/* The rate at the first of four samples (step 1) or the last (step -1) of the cubic through them; of fewer samples of
 * the polynomial through all. Newton's divided differences. */
static double end_rate(const double *time, const double *value, int count, int step)
{
    const int points = count < 4 ? count : 4;
    double c[4], rate = 0, product = 1;
    for (int i = 0; i < points; ++i)
        c[i] = value[step * i];
    for (int k = 1; k < points; ++k) {
        for (int i = points - 1; i >= k; --i)
            c[i] = (c[i] - c[i - 1]) / (time[step * i] - time[step * (i - k)]);
        rate += c[k] * product;
        product *= time[0] - time[step * k];
    }
    return rate;
}

/* Rates of the cubic spline through samples, count >= 2: accelerations are alike on both sides of each,
 * v_(i-1) / h_(i-1) + 2 (1 / h_(i-1) + 1 / h_i) v_i + v_(i+1) / h_i = 3 (c_(i-1) / h_(i-1) + c_i / h_i) with widths h
 * and chords c; at the ends those of cubics through four samples. */
static void spline_rates(Pool *pool, const double *time, const double *value, int count, double *rate)
{
    const int last = count - 1;
    double *upper = pool_alloc(pool, sizeof *upper * (size_t)count);
    rate[0] = end_rate(time, value, count, 1);
    rate[last] = end_rate(time + last, value + last, count, -1);
    for (int i = 1; i < last; ++i) {
        const double h0 = time[i] - time[i - 1], h1 = time[i + 1] - time[i];
        const double c0 = (value[i] - value[i - 1]) / h0, c1 = (value[i + 1] - value[i]) / h1;
        const double pivot = 2 / h0 + 2 / h1 - (i > 1 ? upper[i - 1] / h0 : 0);
        upper[i] = 1 / (h1 * pivot);
        rate[i] = (3 * (c0 / h0 + c1 / h1) - rate[i - 1] / h0) / pivot;
    }
    for (int i = last - 1; i >= 1; --i)
        rate[i] -= upper[i] * rate[i + 1];
}

/* The acceleration of the cubic between samples k and k + 1, at k. */
static double cubic_acceleration(const Profile *p, int k, int next)
{
    const double h = p->time[next] - p->time[k];
    return (6 * (p->value[next] - p->value[k]) / h - 4 * p->rate[k] - 2 * p->rate[next]) / h;
}

void profile_through(Pool *pool, Profile *profile, int count, double *time, double *value, bool monotone)
{
    profile->form = count > 1 ? PROFILE_CURVE : PROFILE_KNOTS;
    profile->count = count;
    profile->time = time;
    profile->value = value;
    profile->sampled = true;
    if (count < 2)
        return;
    double *rate = profile->rate = pool_alloc(pool, sizeof *rate * (size_t)count);
    double *acceleration = pool_alloc(pool, sizeof *acceleration * (size_t)count);
    if (monotone) {
        table_slopes(&(Table){.count = count, .x = time, .y = value, .slope = rate});
    } else {
        spline_rates(pool, time, value, count, rate);
        for (int i = 0; i < count; ++i)
            acceleration[i] = cubic_acceleration(profile, i, i + 1 < count ? i + 1 : i - 1);
        profile->acceleration = acceleration;
    }
    /* constant before and after: at rest where the scene sees that */
    if (time[0] > 0)
        rate[0] = acceleration[0] = 0;
    if (time[count - 1] < profile->end)
        rate[count - 1] = acceleration[count - 1] = 0;
}

bool profile_fit_monotone(const Item *item, bool driven)
{
    const char *word = item ? doc_word(item, "fit") : driven ? "spline" : "monotone";
    if (strcmp(word, "monotone") && strcmp(word, "spline"))
        diag_fail(item->at, "write spline or monotone", "there is no fit '%s'", word);
    if (driven && !strcmp(word, "monotone"))
        diag_fail(item->at, "write spline",
                  "the acceleration of a monotone curve jumps, and a driven coordinate needs one");
    return !strcmp(word, "monotone");
}

static void read_samples(Pool *pool, const Item *item, Profile *profile)
{
    CHECK_KEYS(item, "samples", "times", "values", "fit");
    read_points(pool, item, "samples", profile);
    const bool monotone = profile_fit_monotone(doc_find(item, "fit"), profile->driven);
    profile_through(pool, profile, profile->count, profile->time, profile->value, monotone);
}

/* ---- formulas ----------------------------------------------------------------------------------------------- */

static void read_formula(Pool *pool, const Item *item, Profile *profile)
{
    static const char *const local[] = {"time"};
    const LawNames names = {.model = profile->model,
                            .local = local,
                            .locals = 1,
                            .constant = true,
                            .remedy = "the formula of an input may use `time`, numbers and fixed parameters"};
    profile->form = PROFILE_FORMULA;
    profile->law = law_parse(pool, item, "the formula of an input", &names);
    if (law_is_tunable(profile->law, profile->model))
        diag_fail(item->at, "write its value as a number", "the formula of an input uses a tunable parameter");
}

/* Check a formula's values at times of the scene: finite, with rate and acceleration for a driven coordinate. */
static void check_formula(const Item *item, const Profile *profile)
{
    enum { LOOKS = 2000 };
    const double unknown = 1000, end = profile->end > 0 ? profile->end : unknown; /* s */
    const char *kink = profile->driven ? formula_of_time_kink(profile->law) : NULL;
    if (kink)
        diag_fail(item->at, "write `samples`, `knots`, `ramp` or `step`, whose corners are smooth",
                  "the rate of '%s' may jump, and a driven coordinate needs an acceleration", kink);
    for (int i = 0; i <= LOOKS; ++i) {
        const double time = end * i / (double)LOOKS;
        double at[3];
        profile_at(profile, time, at);
        for (int k = 0; k < (profile->driven ? 3 : 1); ++k)
            if (!isfinite(at[k]))
                diag_fail(item->at, "look for a division by zero or a root of a negative number",
                          "the %s of the formula is no finite number at time %.6g s",
                          ((const char *const[]){"value", "rate", "acceleration"})[k], time);
    }
}

/* ---- every form --------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    void (*read)(Pool *pool, const Item *item, Profile *profile);
} form[] = {{"constant", read_constant}, {"knots", read_knots},     {"sine", read_sine},
            {"step", read_step},         {"ramp", read_ramp},       {"pulse", read_pulse},
            {"chirp", read_chirp},       {"samples", read_samples}, {"formula", read_formula}};

enum { FORMS = sizeof form / sizeof *form };

void profile_read(Pool *pool, const Item *item, const char *name, Profile *profile)
{
    const char *remedy = "write a number, or {FORM: {..}} with constant, knots, sine, step, ramp, pulse, chirp, "
                         "samples, file or formula";
    if (item->kind == ITEM_SCALAR) {
        read_constant(pool, item, profile);
        return;
    }
    CHECK_KEYS(item, "an input", "constant", "knots", "sine", "step", "ramp", "pulse", "chirp", "samples", "file",
               "formula");
    if (item->count != 1)
        diag_fail(item->at, remedy, "an input must be described in one way");
    const Item *value = item->value[0];
    for (int i = 0; i < FORMS; ++i)
        if (!strcmp(item->key[0]->text, form[i].name))
            form[i].read(pool, value, profile);
    if (!strcmp(item->key[0]->text, "file"))
        profile_read_file(pool, value, name, profile);
    if (profile->form == PROFILE_FORMULA)
        check_formula(value, profile);
}
