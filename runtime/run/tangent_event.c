/* SPDX-License-Identifier: MIT
 * Conditions in a run with derivatives. Where one has become true in a step, the time T at which its formula g is 0 is
 * found, and the step is made again as far as there by RK4. T is a clock: it comes later by -dg / (dg/dT), where dg is
 * the change with T as it is, and dg/dT that of g where the piece is longer. So the state at T, and all that follows
 * from T, has the derivative of these very steps: the rest of the step, which is shorter, and inputs that begin at T.
 *
 * What jumps, as the gear, makes a condition true at a time that does not change. Comparisons jump too, so the formula
 * is the guard of condition_output.h; what jumps in it as a state passes a bound has no derivative. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/condition_output.h"
#include "run/tangent_private.h"
#include "scene/action.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <float.h>
#include <math.h>
#include <string.h>

Saved *tangent_saved_new(const TangentRun *run)
{
    Saved *saved = pool_alloc(run->pool, sizeof *saved);
    saved->both = pool_alloc(run->pool, run->descriptor.size);
    saved->self = pool_alloc(run->pool, run->code->size);
    saved->live = pool_alloc(run->pool, (size_t)run->states + 1);
    return saved;
}

void tangent_save(const TangentRun *run, Saved *saved, const TrailStep *next)
{
    memcpy(saved->both, run->both, run->descriptor.size);
    memcpy(saved->self, run->self, run->code->size);
    memcpy(saved->live, run->live, (size_t)run->states);
    saved->next = *next;
    if (run->trail)
        saved->mark = trail_mark(run->trail);
}

void tangent_restore(const TangentRun *run, const Saved *saved, TrailStep *next)
{
    memcpy(run->both, saved->both, run->descriptor.size);
    memcpy(run->self, saved->self, run->code->size);
    memcpy(run->live, saved->live, (size_t)run->states);
    *next = saved->next;
    if (run->trail)
        trail_rewind(run->trail, &saved->mark);
}

void tangent_events_open(TangentRun *run, int conditions)
{
    const size_t all = (size_t)(run->descriptor.slow_count + run->descriptor.fast_count);
    Happened *happened = &run->happened;
    happened->conditions = conditions;
    happened->end = -1;
    happened->begun = pool_alloc(run->pool, ((size_t)run->scene->profiles + 1) * sizeof *happened->begun);
    for (int i = 0; i < run->scene->profiles; ++i)
        happened->begun[i].present = pool_alloc(run->pool, ((size_t)run->carried + 1) * sizeof(double));
    happened->start = tangent_saved_new(run);
    happened->inner = tangent_saved_new(run);
    happened->fixed = pool_alloc(run->pool, (all + 1) * sizeof(double));
    happened->longer = pool_alloc(run->pool, (all + 1) * sizeof(double));
}

/* ---- clocks ------------------------------------------------------------------------------------------------- */

static int new_clock(TangentRun *run)
{
    Happened *happened = &run->happened;
    const size_t size = ((size_t)run->carried + 1) * sizeof(double);
    double *clock = pool_alloc(run->pool, size);
    memset(clock, 0, size);
    *POOL_PUSH(run->pool, happened->clock, happened->clocks) = clock;
    return happened->clocks - 1;
}

const double *tangent_clock(const TangentRun *run, int clock)
{
    return clock < 0 ? NULL : run->happened.clock[clock];
}

static double clock_slope(const TangentRun *run, int clock, int k)
{
    return clock < 0 ? 0 : run->happened.clock[clock][k];
}

bool tangent_has_begun(const TangentRun *run, int input)
{
    for (int i = 0; i < run->scene->profiles && run->happened.happenings; ++i)
        if (run->happened.begun[i].has && run->scene->profile[i].input == input)
            return true;
    return false;
}

void tangent_begun_inputs(const TangentRun *run, int k, double time, double *change)
{
    for (int i = 0; i < run->scene->profiles && run->happened.happenings; ++i) {
        const Profile *profile = &run->scene->profile[i];
        const Begun *begun = &run->happened.begun[i];
        double rate[3], unit[3] = {0};
        if (!begun->has)
            continue;
        tangent_profile_rates(profile, time, rate);
        if (begun->unit)
            profile_at(begun->unit, time, unit);
        for (int j = 0; j < profile_orders(profile); ++j)
            change[profile->input + j] = unit[j] * begun->present[k] - rate[j] * clock_slope(run, begun->clock, k);
    }
}

/* ---- pieces ------------------------------------------------------------------------------------------------- */

/* To a time in `parts` parts; late, later: clocks of the present time and of that one. */
static int make_piece(TangentRun *run, double time, int parts, int late, int later, TrailStep *next)
{
    const double start = gic_time(run->both);
    run->rest = (Rest){.going = late >= 0 || later >= 0,
                       .start = start,
                       .end = time,
                       .late = tangent_clock(run, late),
                       .later = tangent_clock(run, later)};
    next->piece_start = start;
    next->piece_end = time;
    next->late = late;
    next->later = later;
    next->piece = run->trail ? trail_steps(run->trail) : 0;
    const int status = tangent_parts_to(run, time, parts, next);
    run->rest.going = false;
    return status;
}

int tangent_guard_output(const TangentRun *run, int condition)
{
    return run->outputs + run->happened.conditions + condition;
}

/* Outputs, or the numbers of contacts, of the vehicle at the present state; returns a status. */
static int look_there(const TangentRun *run, double *press)
{
    const double time = gic_time(run->both);
    double *state = tape_array(run->self, run->code->state_offset);
    tangent_inputs_of(run, time);
    tangent_take(run, tangent_array(run, run->descriptor.state_offset), 0, state);
    return press ? run->code->contacts->press(run->self, time, state, press) : run->code->outputs(run->self);
}

/* Above 0 if a condition is true at the present state. */
static int truth(const TangentRun *run, int c, double *value)
{
    const int status = look_there(run, NULL);
    *value = tape_array(run->self, run->code->output_offset)[run->outputs + c];
    return status;
}

int tangent_guard(const TangentRun *run, int guard, double *value)
{
    const int contact = guard - run->happened.conditions;
    double press[GIC_CONTACTS];
    const int status = look_there(run, contact < 0 ? NULL : press);
    *value = contact < 0 ? tape_array(run->self, run->code->output_offset)[tangent_guard_output(run, guard)]
                         : press[contact];
    return status;
}

int tangent_guard_slope(const TangentRun *run, int guard, const double *along, double late, int k, double *slope)
{
    const Direction *direction = &run->linear->along;
    const double time = gic_time(run->both);
    double rate[run->inputs + 1];
    if (k < 0) {
        memset(direction->u, 0, (size_t)run->inputs * sizeof *rate);
        memset(direction->port, 0, (size_t)run->code->port_count * sizeof *rate);
        memset(direction->p, 0, (size_t)run->code->parameter_count * sizeof *rate);
    } else {
        tangent_point(run, k);
    }
    memcpy(direction->y, along, (size_t)run->states * sizeof *along);
    *direction->time = late;
    tangent_input_rates(run, time, rate);
    for (int i = 0; i < run->inputs; ++i)
        direction->u[i] += late * rate[i];
    const int contact = guard - run->happened.conditions;
    const int status = contact < 0
                           ? linear_slope(run->linear, run->self, LINEAR_RATE, tangent_guard_output(run, guard) + 1)
                           : linear_slope(run->linear, run->self, LINEAR_PRESS, 0);
    *slope = run->linear->drate[run->states + (contact < 0 ? tangent_guard_output(run, guard) : contact)];
    return status;
}

/* A piece that ends at `time`, as guard c is 0 there, at the clock *later. */
static int located_piece(TangentRun *run, double time, int parts, int late, int c, TrailStep *next, int *later)
{
    Happened *happened = &run->happened;
    const int clock = *later = new_clock(run);
    const size_t size = (size_t)(run->descriptor.slow_count + run->descriptor.fast_count) * sizeof(double);
    double *both = tangent_array(run, run->descriptor.state_offset), value, slope = 0;
    double part[run->states + 1], longer[run->states + 1];
    int status = GIC_OK;
    if (!run->carried) {
        status = make_piece(run, time, parts, late, clock, next);
        if (status != GIC_OK || !run->trail)
            return status;
        TrailStep *last = trail_last(run->trail);
        last->guard = trail_events(run->trail);
        last->condition = c;
        tangent_state(run, part);
        tangent_note(run, TRAIL_RATE, time, part, run->states, part, 0);
        return GIC_OK;
    }
    tangent_save(run, happened->inner, next);
    status = make_piece(run, time, parts, late, clock, next);
    memcpy(happened->fixed, both, size);
    tangent_restore(run, happened->inner, next);
    for (int k = 0; k < run->carried; ++k)
        happened->clock[clock][k] = 1;
    if (status == GIC_OK)
        status = make_piece(run, time, parts, late, clock, next);
    if (status == GIC_OK)
        status = tangent_guard(run, c, &value);
    tangent_take(run, both, 1, longer);
    tangent_take(run, happened->fixed, 1, part);
    for (int i = 0; i < run->states; ++i)
        longer[i] -= part[i];
    if (status == GIC_OK)
        status = tangent_guard_slope(run, c, longer, 1, -1, &slope);
    memset(happened->clock[clock], 0, (size_t)run->carried * sizeof(double));
    tangent_set_inputs(run, time); /* with the time as it is */
    for (int k = 0; k < run->carried && status == GIC_OK; ++k) {
        double own = 0;
        tangent_take(run, happened->fixed, 1 + k, part);
        status = tangent_guard_slope(run, c, part, 0, k, &own);
        const double by = -own / slope;
        happened->clock[clock][k] = by;
        for (int i = 0; i < run->states; ++i)
            part[i] += by * longer[i];
        tangent_put(run, part, 1 + k, both);
    }
    return status == GIC_OK && !gic_finite(happened->clock[clock], run->carried) ? GIC_ERROR_RESULT : status;
}

int tangent_piece(TangentRun *run, double time, int parts, int late, int guard, TrailStep *next, int *later)
{
    if (guard >= 0 && !run->plain)
        return located_piece(run, time, parts, late, guard, next, later);
    *later = -1;
    return make_piece(run, time, parts, late, -1, next);
}

/* On to `time` past samples of controllers, whose times stay; c: the condition that is true there, -1: none, and the
 * time stays. *later: the clock of `time`. */
static int walk(TangentRun *run, double time, int late, int c, TrailStep *next, int *later)
{
    const int ratio = run->scene->ratio;
    double at = INFINITY;
    int event = -1, status = GIC_OK, count = 0;
    const double way = time - gic_time(run->both);
    if (run->code->controller_count > 0)
        status = tangent_sample(run, &event, &at);
    if (event >= 0)
        next->sample = event;
    while (status == GIC_OK && tangent_is_before(run, at, time)) {
        const int parts = (int)ceil(ratio * (at - gic_time(run->both)) / way);
        status = count++ < GIC_SAMPLES ? make_piece(run, at, parts, late, -1, next) : GIC_ERROR_EVENTS;
        late = -1;
        if (status == GIC_OK)
            status = tangent_sample(run, &next->sample, &at);
    }
    *later = -1;
    if (status != GIC_OK)
        return status;
    const int parts = (int)ceil(0.999 * ratio * (time - gic_time(run->both)) / way);
    return tangent_piece(run, time, parts, late, c, next, later);
}

static Actions *actions_of(const TangentRun *run)
{
    return run->scene->actions;
}

/* Condition c is why the run has no derivative: `before`, its formula, `after`. Returns a status. */
static int blame(TangentRun *run, int c, const char *before, const char *after)
{
    const Action *action = &actions_of(run)->action[c];
    run->happened.blamed = action;
    run->happened.failed = pool_print(run->pool, "%scondition '%s'%s", before, action->text, after);
    return GIC_ERROR_RESULT;
}

/* ---- when a condition becomes true ---------------------------------------------------------------------------- */

/* The guard of condition c, or its value, at a time of the step, where the run is then. */
static int value_there(TangentRun *run, const Saved *start, double time, int c, bool guard, double *value)
{
    TrailStep next;
    int later;
    tangent_restore(run, start, &next);
    run->plain = true;
    int status = walk(run, time, -1, -1, &next, &later);
    if (status == GIC_OK)
        status = guard ? tangent_guard(run, c, value) : truth(run, c, value);
    run->plain = false;
    return status;
}

/* True if the condition follows from more than the time. */
static bool condition_moves(const TangentRun *run, int c, int *status)
{
    const Linear *linear = run->linear;
    const gic_model *code = run->code;
    if (*status != GIC_OK)
        return false;
    memset(linear->drate, 0, (size_t)(run->states + code->output_count) * sizeof *linear->drate);
    linear->drate[run->states + tangent_guard_output(run, c)] = 1;
    *status = linear_pull(linear, run->self, LINEAR_RATE, code->output_count);
    bool moves = false;
    for (int i = 0; i < run->states; ++i)
        moves = moves || linear->along.y[i] != 0;
    for (int i = 0; i < code->input_count; ++i)
        moves = moves || linear->along.u[i] != 0;
    for (int i = 0; i < code->parameter_count; ++i)
        moves = moves || linear->along.p[i] != 0;
    return moves;
}

typedef struct Found {
    double time; /* s */
    bool moves;  /* the time follows from variables */
} Found;

/* True if controllers sample, or their values take effect, at this time. */
static bool is_instant(const TangentRun *run, double time)
{
    bool is = false;
    for (int c = 0; c < run->model->controllers; ++c) {
        const Controller *controller = &run->model->controller[c];
        for (int i = -1; i < controller->rules; ++i) {
            const double periods =
                (time - controller->offset - (i < 0 ? 0 : controller->rule[i].late)) / controller->period;
            is = is || fabs(periods - round(periods)) < 1e-9 * (1 + fabs(periods));
        }
    }
    return is;
}

/* Bisection, with the secant where that is quicker, from `low`, where a number of condition c is at_low, not above 0,
 * to `high`, where it is at_high, above 0; both come as close as rounding lets them. */
typedef struct Bracket {
    double low, high, at_low, at_high;
} Bracket;

static int close_in(TangentRun *run, const Saved *start, int c, bool guard, double close, Bracket *b)
{
    double weight_low = fmin(b->at_low, 0), weight_high = b->at_high;
    int status = GIC_OK;
    for (int i = 0; i < 200 && status == GIC_OK && b->high - b->low > 2 * close; ++i) {
        const double share = weight_low / (weight_low - weight_high);
        double value, middle = b->low + (i % 3 < 2 && share >= 0 && share <= 1 ? share : 0.5) * (b->high - b->low);
        middle = fmin(fmax(middle, b->low + close), b->high - close);
        status = value_there(run, start, middle, c, guard, &value);
        *(value > 0 ? &b->high : &b->low) = middle;
        *(value > 0 ? &b->at_high : &b->at_low) = value;
        /* Illinois: the end that stays counts half */
        weight_low = value > 0 ? weight_low / 2 : value;
        weight_high = value > 0 ? value : weight_high / 2;
    }
    return status;
}

/* True if condition c gets to 0 from below and stays there, at a time that follows from variables: before, it does. */
static bool grazes(TangentRun *run, const Saved *start, int c, const Bracket *b, int *status)
{
    double value;
    *status = value_there(run, start, b->low, c, true, &value);
    return condition_moves(run, c, status);
}

/* Of a condition whose guard is `there` at the end of the step, `end`, where the condition is true. */
static int locate(TangentRun *run, const Saved *start, double end, int c, double there, Found *found)
{
    const double first = gic_time(start->both), width = end - first;
    const double close = fmax(1e-14 * width, 4 * DBL_EPSILON * fabs(end));
    const bool guard = there > 0; /* else it stays at 0, and the condition's value tells where it gets there */
    double value, before, slope = 0, rate[run->states + 1];
    TrailStep next;
    tangent_restore(run, start, &next);
    int status = tangent_guard(run, c, &before);
    Bracket b = {.low = first, .high = end, .at_low = before, .at_high = there};
    if (status == GIC_OK)
        status = value_there(run, start, end, c, guard, &value);
    if (status == GIC_OK && value <= 0) { /* the whole step says so, but not its parts of RK4 */
        b.low = end;
        b.at_low = value;
    } else {
        b.at_high = value;
    }
    if (status == GIC_OK)
        status = close_in(run, start, c, guard, close, &b);
    const double least = fmax(1e-12 * width, 8 * run->scene->ratio * DBL_EPSILON * fabs(end)); /* of a piece */
    found->time = fmax(b.high, first + least);
    if (status == GIC_OK && !guard)
        status = value_there(run, start, b.low, c, true, &b.at_low);
    if (status == GIC_OK)
        status = value_there(run, start, found->time, c, true, &value);
    run->plain = true;
    if (status == GIC_OK)
        status = run->descriptor.rhs(run->both, found->time, tangent_array(run, run->descriptor.state_offset),
                                     run->happened.longer);
    run->plain = false;
    if (status != GIC_OK)
        return status;
    b.at_high = guard ? b.at_high : value;
    tangent_take(run, run->happened.longer, 0, rate);
    status = tangent_guard(run, c, &value);
    if (status == GIC_OK)
        status = tangent_guard_slope(run, c, rate, 1, -1, &slope);
    const double jump = b.at_high - fmin(b.at_low, 0), most = 1e-3 * width;
    const double size = fmax(fmax(fabs(there), fabs(before)), 1e-9);
    found->moves = slope > 0 && jump <= slope * most && condition_moves(run, c, &status);
    if (found->moves && !actions_of(run)->action[c].ends) /* what comes after has to have a piece of the step */
        found->time = fmin(found->time, end - least);
    if (status == GIC_OK && !found->moves && jump > slope * most && jump > 0 && !is_instant(run, b.high) &&
        condition_jumps(run->model, c))
        return blame(run, c, "", ", whose `if` jumps, and not between comparisons,");
    if (status == GIC_OK && slope <= 0 && jump <= 1e-9 * size && b.high < end && grazes(run, start, c, &b, &status))
        return blame(run, c, "", ", which becomes true without crossing 0,");
    return status;
}

/* ---- what happens --------------------------------------------------------------------------------------------- */

static int note_held(const TangentRun *run)
{
    Actions *actions = actions_of(run);
    int status = GIC_OK;
    for (int i = 0; i < actions->count && status == GIC_OK; ++i) {
        double value = 0;
        if (!actions->action[i].done)
            status = truth(run, i, &value);
        actions->action[i].held = value > 0;
    }
    return status;
}

bool tangent_knots_move(const TangentRun *run)
{
    bool move = false;
    for (int i = 0; i < run->scene->profiles; ++i)
        move = move || (run->happened.begun[i].has && run->scene->profile[i].driven);
    return move;
}

int tangent_events_begin(TangentRun *run)
{
    Actions *actions = actions_of(run);
    Happened *happened = &run->happened;
    happened->ended = false;
    happened->end = -1;
    happened->clocks = happened->happenings = 0;
    happened->failed = NULL;
    happened->blamed = NULL;
    for (int i = 0; i < run->scene->profiles; ++i)
        happened->begun[i].has = false;
    for (int i = 0; happened->conditions && i < actions->count; ++i)
        actions->action[i].done = false;
    return happened->conditions ? note_held(run) : GIC_OK;
}

/* The first condition that has become true since the step began; -1: none has. */
static int first_action(TangentRun *run, Saved *start, Saved *end, Found *first, int *which)
{
    const Actions *actions = actions_of(run);
    TrailStep next;
    int status = GIC_OK;
    *which = -1;
    for (int i = 0; i < actions->count && status == GIC_OK; ++i) {
        Found found = {0};
        double value = 0;
        if (actions->action[i].done || actions->action[i].held)
            continue;
        tangent_restore(run, end, &next);
        status = truth(run, i, &value);
        if (status != GIC_OK || !(value > 0))
            continue;
        status = tangent_guard(run, i, &value);
        if (status != GIC_OK)
            continue;
        status = locate(run, start, gic_time(end->both), i, value, &found);
        if (status == GIC_OK && (*which < 0 || found.time < first->time)) {
            *first = found;
            *which = i;
        }
    }
    tangent_restore(run, end, &next);
    return status;
}

/* What a profile changes by where the value that it begins from is more by 1; NULL: nothing. It enters linearly. */
static const Profile *unit_of(Pool *pool, const Profile *now, const Profile *more)
{
    Profile *unit = pool_alloc(pool, sizeof *unit);
    bool any = more->amplitude != now->amplitude || more->offset != now->offset;
    const bool points = now->form == PROFILE_KNOTS || now->form == PROFILE_CURVE;
    *unit = *now;
    unit->amplitude = more->amplitude - now->amplitude;
    unit->offset = more->offset - now->offset;
    if (!points)
        return any && now->form != PROFILE_FORMULA ? unit : NULL;
    const double *const from[] = {now->value, now->rate, now->acceleration};
    const double *const to[] = {more->value, more->rate, more->acceleration};
    double **const by[] = {&unit->value, &unit->rate, &unit->acceleration};
    any = false;
    for (int r = 0; r < 3; ++r) {
        if (!from[r])
            continue;
        *by[r] = pool_alloc(pool, (size_t)now->count * sizeof(double));
        for (int i = 0; i < now->count; ++i) {
            (*by[r])[i] = to[r][i] - from[r][i];
            any = any || (*by[r])[i] != 0;
        }
    }
    return any ? unit : NULL;
}

/* Its profiles begin, at the clock of the present time. */
static int happen(TangentRun *run, int which, int clock)
{
    Action *action = &actions_of(run)->action[which];
    Happened *happened = &run->happened;
    const double time = gic_time(run->both), *input = tangent_array(run, run->descriptor.input_offset);
    double rate[run->inputs + 1], present[run->inputs + 1];
    action->time = time;
    tangent_set_inputs(run, time);
    tangent_input_rates(run, time, rate);
    memcpy(present, input, (size_t)run->inputs * sizeof *input);
    for (int i = 0; i < action->changes; ++i) {
        const int at = action->change[i].profile;
        if (at < 0)
            return blame(run, which, "a `target` of the driver that begins with ", "");
        const Profile *profile = &run->scene->profile[at];
        Begun *begun = &happened->begun[at], old = *begun;
        *POOL_PUSH(run->pool, happened->happening, happened->happenings) =
            (Happening){.profile = at, .time = time, .before = *profile, .begun = old, .clock = clock};
        Begun next = {
            .has = true, .clock = clock, .present = pool_alloc(run->pool, sizeof(double) * ((size_t)run->carried + 1))};
        for (int k = 0; k < run->carried; ++k)
            next.present[k] =
                input[run->inputs * (1 + k) + profile->input] + rate[profile->input] * clock_slope(run, clock, k);
        const Profile more = action_profile(run->pool, &action->change[i], profile, time, present[profile->input] + 1);
        const Profile now = action_profile(run->pool, &action->change[i], profile, time, present[profile->input]);
        next.unit = unit_of(run->pool, &now, &more);
        *begun = next;
    }
    action_start(run->pool, action, run->scene, present);
    tangent_set_inputs(run, time);
    return GIC_OK;
}

/* An action and those that are true as well once it has happened. next: of the step that begins then. */
static int happen_all(TangentRun *run, int which, int clock, TrailStep *next)
{
    const Actions *actions = actions_of(run);
    double at;
    int event = -1, status = GIC_OK;
    next->happens = run->happened.happenings;
    if (run->code->controller_count > 0)
        status = tangent_sample(run, &event, &at);
    if (event >= 0 && clock >= 0)
        return blame(run, which, "", ", which becomes true as a controller samples,");
    if (event >= 0)
        next->sample = event;
    while (status == GIC_OK && which >= 0) {
        status = happen(run, which, clock);
        if (actions->action[which].ends) {
            run->happened.ended = true;
            run->happened.end = clock;
            break;
        }
        which = -1;
        for (int i = 0; i < actions->count && status == GIC_OK && which < 0; ++i) {
            double value = 0;
            if (!actions->action[i].done && !actions->action[i].held)
                status = truth(run, i, &value);
            if (status == GIC_OK && value > 0)
                which = i;
        }
    }
    next->happened = run->happened.happenings;
    return status;
}

/* What happens at the end of a step, for the way back: a step that has nothing else. */
static void add_empty(const TangentRun *run, TrailStep *next)
{
    if (run->trail && (next->sample >= 0 || next->happened > next->happens)) {
        next->first = next->gear = next->knots = next->end = trail_events(run->trail);
        *trail_add_step(run->trail) = *next;
    }
    *next = trail_part;
}

void tangent_events_before(TangentRun *run, const TrailStep *next)
{
    if (run->happened.conditions)
        tangent_save(run, run->happened.start, next);
}

int tangent_events_after(TangentRun *run)
{
    Happened *happened = &run->happened;
    Saved *start = happened->start, *end = happened->inner;
    const double target = gic_time(run->both);
    const gic_head kept = run->both->head;
    int which, late = -1, clock, status = GIC_OK;
    Found found = {0};
    if (!happened->conditions)
        return GIC_OK;
    for (;;) {
        tangent_save(run, end, &trail_part);
        status = first_action(run, start, end, &found, &which);
        if (status != GIC_OK || which < 0)
            break;
        TrailStep next = trail_part;
        clock = -1;
        if (found.moves || found.time < target) {
            tangent_restore(run, start, &next);
            status = walk(run, found.time, late, found.moves ? which : -1, &next, &clock);
        }
        if (status == GIC_OK)
            status = happen_all(run, which, clock, &next);
        if (status != GIC_OK)
            return status;
        if (happened->ended || !(gic_time(run->both) < target)) {
            add_empty(run, &next);
            if (happened->ended)
                return status;
        }
        late = clock;
        tangent_save(run, start, &next);
        status = note_held(run);
        if (status == GIC_OK && gic_time(run->both) < target)
            status = walk(run, target, late, -1, &next, &clock);
        if (status != GIC_OK)
            return status;
        run->both->head.start_time = kept.start_time;
        run->both->head.steps = kept.steps;
        run->both->head.step = kept.step;
        run->both->head.method = kept.method;
        run->both->head.ratio = kept.ratio;
        run->both->head.history = 0;
    }
    return status == GIC_OK ? note_held(run) : status;
}
