/* SPDX-License-Identifier: MIT
 * Numbers of a run by formula, from its values at output times: models/SCENE.md section 6. */
#include "base/message.h"
#include "host/host.h"
#include "run/formula_output.h"
#include "sweep/sweep.h"

#include <math.h>
#include <string.h>

static const char *const kind_name[METRIC_KINDS] = {"end",      "min",       "max",         "mean",
                                                    "rms",      "integral",  "time_of_min", "time_of_max",
                                                    "crossing", "overshoot", "rms_wk",      "rms_wd"};

static _Noreturn void refuse(const char *why, const char *word)
{
    diag_fail_call(program_place(), "`gicsweep -h` shows how", "%s '%s'", why, word);
}

/* The comma between two arguments; NULL: there is one argument. */
static const char *comma_of(const char *text)
{
    int depth = 0;
    for (; *text && (*text != ',' || depth); ++text)
        depth += (*text == '(') - (*text == ')');
    return *text ? text : NULL;
}

/* A text without blanks around it. */
static char *trimmed(Pool *pool, const char *text, size_t size)
{
    for (; size && text[size - 1] == ' '; --size)
        ;
    for (; size && *text == ' '; --size)
        ++text;
    return pool_print(pool, "%.*s", (int)size, text);
}

/* Name, and unit in brackets, before the equals sign. */
static void read_name(Pool *pool, const char *word, const char *equals, Metric *metric)
{
    char *name = trimmed(pool, word, (size_t)(equals - word)), *bracket = strstr(name, " [");
    const size_t size = strlen(name);
    for (const char *c = name; *c; ++c)
        if ((unsigned char)*c < ' ' || *c == ',' || *c == '"')
            refuse("a name, and a unit, has no commas, quotes, line ends or tabs:", word);
    if (bracket && name[size - 1] == ']') {
        name[size - 1] = 0;
        metric->unit = bracket + 2;
        name = trimmed(pool, name, (size_t)(bracket - name));
    }
    if (!*name)
        refuse("--metric takes NAME=FUNCTION(FORMULA), not", word);
    metric->name = name;
}

/* The unit of a metric of a formula, where that is the name of an output; NULL: not known. */
static const char *unit_of(const Model *model, MetricKind kind, const char *formula)
{
    if (kind == METRIC_TIME_OF_MIN || kind == METRIC_TIME_OF_MAX || kind == METRIC_CROSSING)
        return "s";
    if (kind == METRIC_OVERSHOOT)
        return "1";
    for (int i = 0; i < model->outputs && kind != METRIC_INTEGRAL; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            if (!model->output[i].hidden && !strcmp(model->output[i].component[k], formula))
                return model->output[i].unit[k];
    return NULL;
}

const Model *metric_read(Pool *pool, const Model *model, const char *word, Metric *metric)
{
    const char *equals = strchr(word, '='), *inside = NULL;
    *metric = (Metric){.word = word, .other = -1};
    if (!equals)
        refuse("--metric takes NAME=FUNCTION(FORMULA), not", word);
    read_name(pool, word, equals, metric);
    const char *call = trimmed(pool, equals + 1, strlen(equals + 1));
    for (int k = 0; k < METRIC_KINDS && !inside; ++k)
        if ((inside = formula_inside(pool, call, kind_name[k])))
            metric->kind = (MetricKind)k;
    for (int k = 0; k < METRIC_KINDS && !inside; ++k)
        if (!strncmp(call, kind_name[k], strlen(kind_name[k])) && call[strlen(kind_name[k])] == '(')
            refuse("parentheses do not match in", word);
    if (!inside)
        refuse(
            "--metric knows end, min, max, mean, rms, rms_wk, rms_wd, integral, time_of_min, time_of_max, crossing and "
            "overshoot of a formula, not",
            word);
    const char *comma = comma_of(inside);
    if (comma && metric->kind != METRIC_RMS && metric->kind != METRIC_CROSSING)
        refuse("only rms takes a weight and crossing a level after a comma, not", word);
    const char *option = pool_print(pool, "--metric %s", metric->name);
    const char *formula = trimmed(pool, inside, comma ? (size_t)(comma - inside) : strlen(inside));
    if (!metric->unit)
        metric->unit = unit_of(model, metric->kind, formula);
    metric->signal = model->output_components;
    model = formula_output(pool, model, option, pool_print(pool, "metric %d", metric->signal), formula);
    if (comma) {
        metric->other = model->output_components;
        model = formula_output(pool, model, option, pool_print(pool, "metric %d", metric->other), comma + 1);
    }
    return model;
}

static double half_sum(double step, double before, double now)
{
    return step * 0.5 * (before + now);
}

static bool is_ride(const Metric *metric)
{
    return metric->kind == METRIC_RMS_WK || metric->kind == METRIC_RMS_WD;
}

/* What happens between two samples, in which values change linearly, or their squares do. */
static void pass(const Metric *metric, MetricState *s, double time, double value, double other)
{
    const double step = time - s->time;
    if (is_ride(metric)) {
        const double before = s->filtered;
        s->filtered = ride_filter_step(&s->filter, step, value);
        s->integral += half_sum(step, before * before, s->filtered * s->filtered);
        s->weight += step;
        return;
    }
    if (metric->kind == METRIC_RMS) {
        s->integral += half_sum(step, s->other * s->value * s->value, other * value * value);
        s->weight += half_sum(step, s->other, other);
        return;
    }
    s->integral += half_sum(step, s->value, value);
    s->weight += step;
    const double level = metric->other >= 0 ? 1 : 0;
    const double before = s->value - level * s->other, now = value - level * other;
    if (isnan(s->crossing) && (now == 0 || (before < 0) != (now < 0)))
        s->crossing = s->time + step * (before / (before - now));
}

void metric_see(const Metric *metric, MetricState *s, double time, double value, double other)
{
    if (s->samples++) {
        pass(metric, s, time, value, other);
    } else {
        const double level = metric->other >= 0 ? other : 0;
        *s = (MetricState){.samples = 1,
                           .begin = time,
                           .first = value,
                           .least = value,
                           .greatest = value,
                           .time_of_least = time,
                           .time_of_greatest = time,
                           .crossing = value == level ? time : (double)NAN};
        if (is_ride(metric))
            s->filter = ride_filter_begin(metric->kind == METRIC_RMS_WK ? RIDE_K : RIDE_D, value);
    }
    if (value < s->least) {
        s->least = value;
        s->time_of_least = time;
    }
    if (value > s->greatest) {
        s->greatest = value;
        s->time_of_greatest = time;
    }
    s->time = time;
    s->value = value;
    s->other = other;
}

double metric_value(const Metric *metric, const MetricState *s)
{
    const bool spread = s->samples > 1;
    const double change = s->value - s->first;
    if (!s->samples)
        return NAN;
    switch (metric->kind) {
    case METRIC_END: return s->value;
    case METRIC_MIN: return s->least;
    case METRIC_MAX: return s->greatest;
    case METRIC_MEAN: return spread ? s->integral / s->weight : s->value;
    case METRIC_RMS:
        return !spread && metric->other < 0 ? fabs(s->value)
               : s->weight > 0              ? sqrt(s->integral / s->weight)
                                            : (double)NAN;
    case METRIC_RMS_WK:
    case METRIC_RMS_WD: return spread ? sqrt(s->integral / s->weight) : (double)NAN;
    case METRIC_INTEGRAL: return s->integral;
    case METRIC_TIME_OF_MIN: return s->time_of_least;
    case METRIC_TIME_OF_MAX: return s->time_of_greatest;
    case METRIC_CROSSING: return s->crossing;
    default:
        return change > 0   ? (s->greatest - s->value) / change
               : change < 0 ? (s->least - s->value) / change
                            : (double)NAN;
    }
}
