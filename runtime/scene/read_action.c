/* SPDX-License-Identifier: MIT
 * `until` and `when` of scenes: models/SCENE.md section 13. Conditions that can never become true are refused. */
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "scene/action.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;

typedef struct Reader {
    Pool *pool;
    const Model *model;
    Scene *scene;
    Actions *actions;
} Reader;

/* ---- names -------------------------------------------------------------------------------------------------- */

/* held: the scene holds the base, which then has no state. */
static void collect_names(Reader *reader, bool held)
{
    static const char *const base[] = {"speed", "roll", "pitch", "yaw"};
    Actions *actions = reader->actions;
    const gic_signal *signal = scene_signals(reader->pool, reader->model);
    actions->signals = reader->model->output_components + reader->model->inputs;
    for (int i = 0; i < actions->signals; ++i)
        *POOL_PUSH(reader->pool, actions->local, actions->locals) = signal[i].name;
    for (int i = 0; i < 4 && reader->model->free_base && !held; ++i)
        *POOL_PUSH(reader->pool, actions->local, actions->locals) = base[i];
    actions->watch = pool_alloc(reader->pool, sizeof *actions->watch * (size_t)(actions->signals + 1));
    for (int i = 0; i < actions->signals; ++i)
        actions->watch[i] = -1;
}

/* Signals that a condition needs. */
static void watch(Reader *reader, const Law *law)
{
    Actions *actions = reader->actions;
    Scene *scene = reader->scene;
    if (law->op == LAW_LOCAL && law->index < actions->signals && actions->watch[law->index] < 0) {
        actions->watch[law->index] = scene->watches;
        *POOL_PUSH(reader->pool, scene->watched, scene->watches) = law->index;
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        watch(reader, law->arg[i]);
}

/* ---- can it become true? ------------------------------------------------------------------------------------ */

typedef struct Range {
    double low, high;
} Range;

static const Range anything = {-INFINITY, INFINITY};

static Range range_of_signal(const Reader *reader, int signal)
{
    const Model *model = reader->model;
    const Powertrain *powertrain = model->powertrain;
    if (signal >= reader->actions->signals) {
        const int base = signal - reader->actions->signals; /* speed, roll, pitch, yaw */
        return base == 0 ? anything : base == 2 ? (Range){-pi / 2, pi / 2} : (Range){-pi, pi};
    }
    int at = 0;
    for (int i = 0; i < model->outputs; at += model->output[i++].count) {
        const int part = signal - at;
        if (part < 0 || part >= model->output[i].count)
            continue;
        const char *dot = strrchr(model->output[i].component[part], '.');
        if (model->output[i].type == OUTPUT_POWERTRAIN && dot && !strcmp(dot, ".gear"))
            return (Range){-powertrain->reverse, powertrain->forward};
        if (model->output[i].type == OUTPUT_POWERTRAIN && dot && !strcmp(dot, ".throttle"))
            return (Range){0, 1};
        if (model->output[i].type == OUTPUT_WHEEL && dot && !strcmp(dot, ".fz"))
            return (Range){0, INFINITY};
    }
    return anything;
}

static Range hull(const double *x, int count)
{
    Range range = {INFINITY, -INFINITY};
    for (int i = 0; i < count; ++i) {
        if (isnan(x[i]))
            return anything;
        range.low = fmin(range.low, x[i]);
        range.high = fmax(range.high, x[i]);
    }
    return range;
}

/* 0 times infinity is 0: one factor is 0 itself, the other some number. */
static double times(double a, double b)
{
    return a == 0 || b == 0 ? 0 : a * b;
}

static Range range_of_call(Op op, Range a, Range b, Range c)
{
    switch (op) {
    case OP_ADD: return (Range){a.low + b.low, a.high + b.high};
    case OP_SUB: return (Range){a.low - b.high, a.high - b.low};
    case OP_NEG: return (Range){-a.high, -a.low};
    case OP_MUL:
        return hull((double[4]){times(a.low, b.low), times(a.low, b.high), times(a.high, b.low), times(a.high, b.high)},
                    4);
    case OP_ABS: return (Range){a.low > 0 ? a.low : a.high < 0 ? -a.high : 0, fmax(fabs(a.low), fabs(a.high))};
    case OP_MIN: return (Range){fmin(a.low, b.low), fmin(a.high, b.high)};
    case OP_MAX: return (Range){fmax(a.low, b.low), fmax(a.high, b.high)};
    case OP_SQRT:
    case OP_EXP: return (Range){0, INFINITY};
    case OP_SIN:
    case OP_COS:
    case OP_TANH: return (Range){-1, 1};
    case OP_ATAN: return (Range){-pi / 2, pi / 2};
    case OP_POSITIVE: return a.low > 0 ? b : a.high <= 0 ? c : (Range){fmin(b.low, c.low), fmax(b.high, c.high)};
    default: return anything;
    }
}

/* All values that a formula can have during the scene, and perhaps more. */
static Range range_of(const Reader *reader, const Law *law)
{
    Range x[3] = {{0, 0}};
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        x[i] = range_of(reader, law->arg[i]);
    switch (law->op) {
    case LAW_NUMBER: return (Range){law->number, law->number};
    case LAW_TIME: return (Range){0, reader->scene->duration};
    case LAW_LOCAL: return range_of_signal(reader, law->index);
    case LAW_CALL: return range_of_call((Op)law->call, x[0], x[1], x[2]);
    default: return anything;
    }
}

/* True if it consists of time and numbers. *timed: the time occurs in it. */
static bool is_of_time(const Law *law, bool *timed)
{
    bool only = law->op == LAW_NUMBER || law->op == LAW_CALL || law->op == LAW_TIME || law->op == LAW_PARAMETER;
    *timed = *timed || law->op == LAW_TIME;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        only = is_of_time(law->arg[i], timed) && only;
    return only;
}

/* True if a condition on the time alone becomes true during the run, as its values at many times show. */
static bool comes_true(Reader *reader, const Action *action)
{
    enum { LOOKS = 20000 };
    const gic_model none = {.slow_count = 0};
    gic_head clock = {.start_time = 0};
    Scene with = *reader->scene;
    with.actions = reader->actions;
    bool held = true;
    for (int i = 0; i <= LOOKS; ++i) {
        clock.start_time = with.duration * i / (double)LOOKS;
        const bool holds = action_value(action, &with, &none, &clock, NULL, 0) > 0;
        if (holds && !held)
            return true;
        held = holds;
    }
    return false;
}

static void check_condition(Reader *reader, const Action *action)
{
    bool timed = false;
    const bool alone = is_of_time(action->law, &timed);
    const Range range = range_of(reader, action->law);
    if (alone && !timed)
        diag_fail(action->at, "name an output, an input, a coordinate or `time` in it",
                  "the condition '%s' is the same all along", action->text);
    if (range.high <= 0)
        diag_fail(action->at, "compare with a value that is reached in this scene", "the condition '%s' can never hold",
                  action->text);
    if (range.low > 0)
        diag_fail(action->at, "compare with a value that is crossed in this scene",
                  "the condition '%s' holds from the start, and can never become true", action->text);
    if (alone && !comes_true(reader, action))
        diag_fail(action->at, "time runs forwards, from 0 to `duration`: compare it with `>`",
                  "the condition '%s' does not become true between 0 and %.9g s", action->text,
                  reader->scene->duration);
}

/* ---- reading ------------------------------------------------------------------------------------------------ */

static Action *read_condition(Reader *reader, const Item *item, const char *what)
{
    const LawNames names = {
        .model = reader->model, .local = reader->actions->local, .locals = reader->actions->locals, .hide = true};
    const char *text = doc_word(item, what);
    Action *action = POOL_PUSH(reader->pool, reader->actions->action, reader->actions->count);
    *action = (Action){.at = item->at, .text = text, .law = law_parse(reader->pool, item, what, &names)};
    watch(reader, action->law);
    check_condition(reader, action);
    return action;
}

/* The profile of an input that an action changes; one that the scene leaves alone keeps the model's value until then.
 */
static int profile_of(Reader *reader, const Item *key)
{
    Scene *scene = reader->scene;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(reader->model->inputs + 1));
    for (int i = 0; i < reader->model->inputs; ++i)
        name[i] = reader->model->input[i].name;
    const int input = scene_name_index(reader->pool, key, key->text, "input", name, reader->model->inputs);
    for (int i = 0; i < scene->profiles; ++i)
        if (scene->profile[i].input == input)
            return i;
    Profile *profile = scene_profile(reader->pool, reader->model, scene, key, name);
    profile->count = 1;
    profile->time = pool_alloc(reader->pool, sizeof(double));
    profile->value = pool_alloc(reader->pool, sizeof(double));
    profile->value[0] = profile->offset;
    return scene->profiles - 1;
}

/* Read a profile once, so that its mistakes show before the run. */
static void try_profile(Reader *reader, const Change *change, const Profile *like)
{
    Profile trial = {.driven = like->driven,
                     .unit = like->unit,
                     .offset = like->offset,
                     .end = like->until,
                     .until = like->until,
                     .model = like->model};
    profile_read(reader->pool, change->item, change->name, &trial);
}

static void read_changes(Reader *reader, const Item *map, Action *action)
{
    if (map->kind != ITEM_MAP)
        diag_fail(map->at, "write {name: number or profile}", "inputs must be a map");
    for (int k = 0; k < map->count; ++k) {
        const int at = profile_of(reader, map->key[k]);
        Change *change = POOL_PUSH(reader->pool, action->change, action->changes);
        *change = (Change){at, map->key[k]->text, map->value[k]};
        try_profile(reader, change, &reader->scene->profile[at]);
    }
}

static void read_target(Reader *reader, const Item *item, Action *action)
{
    const Driver *driver = reader->scene->driver;
    if (!driver || driver->accelerator < 0)
        diag_fail(item->at, "add `driver: {speed: {target: 20}}`", "a target, but no driver keeps a speed");
    Change *change = POOL_PUSH(reader->pool, action->change, action->changes);
    *change = (Change){-1, "speed", item};
    try_profile(reader, change, &driver->speed);
}

static void read_mark(Reader *reader, const Item *item, Action *action)
{
    action->mark = doc_word(item, "mark");
    if (!action->mark[0] || action->mark[strcspn(action->mark, ",\"[]")])
        diag_fail(item->at, "write a name without commas, quotes and brackets", "'%s' can't name a column",
                  action->mark);
    for (int i = 0; i < reader->actions->count - 1; ++i)
        if (reader->actions->action[i].mark && !strcmp(reader->actions->action[i].mark, action->mark))
            diag_fail(item->at, "choose another one", "the mark '%s' is set by two conditions", action->mark);
    ++reader->actions->marks;
}

static void read_when(Reader *reader, const Item *item)
{
    CHECK_KEYS(item, "an entry of `when`", "if", "inputs", "target", "mark");
    Action *action = read_condition(reader, scene_need(item, "if", "an entry of `when`"), "the condition");
    const Item *inputs = doc_find(item, "inputs"), *target = doc_find(item, "target"), *mark = doc_find(item, "mark");
    if (!inputs && !target && !mark)
        diag_fail(item->at, "add `inputs`, `target` or `mark`", "nothing happens when '%s'", action->text);
    if (inputs)
        read_changes(reader, inputs, action);
    if (target)
        read_target(reader, target, action);
    if (mark)
        read_mark(reader, mark, action);
}

Actions *actions_read(Pool *pool, const Item *root, const Model *model, Scene *scene)
{
    const Item *until = doc_find(root, "until"), *when = doc_find(root, "when");
    if (!until && !when)
        return NULL;
    Reader reader = {pool, model, scene, pool_alloc(pool, sizeof *reader.actions)};
    reader.actions->model = model;
    const Item *hold = doc_find(root, "base");
    collect_names(&reader, hold && hold->kind == ITEM_SCALAR && !strcmp(hold->text, "fixed"));
    if (until)
        read_condition(&reader, until, "the condition of `until`")->ends = true;
    if (when && when->kind != ITEM_LIST)
        diag_fail(when->at, "write a list: - {if: \"speed > 10\", mark: fast}", "`when` must be a list");
    for (int i = 0; when && i < when->count; ++i)
        read_when(&reader, when->value[i]);
    return reader.actions;
}
