/* SPDX-License-Identifier: MIT
 * One instance of the model as an importer sees it: see fmu_core.h. */
#include "fmu_core.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const gic_model *const model = &FMU_DESCRIPTOR;

static const char *const mode_name[] = {"instantiated",  "initialization mode", "event mode", "continuous-time mode",
                                        "between steps", "failed step",         "terminated"};

/* ---- messages ----------------------------------------------------------------------------------------------- */

fmu_result fmu_say(fmu_instance *instance, fmu_result result, const char *format, ...)
{
    static const char *const category[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError"};
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    instance->log(instance, result, category[result], text);
    return result;
}

fmu_result fmu_legal(fmu_instance *instance, const char *call, int32_t modes)
{
    int mode = 0;
    if (instance->data.mode & modes)
        return FMU_OK;
    while (mode < 6 && instance->data.mode != 1 << mode)
        ++mode;
    return fmu_say(instance, FMU_ERROR, "%s is not allowed here (%s)", call, mode_name[mode]);
}

/* A status of generated code as a message. */
static fmu_result said(fmu_instance *instance, fmu_result result, const FMU_TYPE *of, const char *what, int status)
{
    const gic_head *head = &of->head;
    const char *text = gic_status_text(status), *about = "", *name = "";
    if ((status == GIC_ERROR_GEOMETRY || status == GIC_ERROR_ASSUMPTION) && head->condition >= 0 &&
        head->condition < model->condition_count)
        about = "condition", name = model->condition_text[head->condition];
    else if (status == GIC_ERROR_EVENTS && gic_event_name(model, head))
        return fmu_say(instance, result, "%s at t = %.9g s: %s: %s", what, (double)gic_time(of), text,
                       gic_event_name(model, head));
    else if (head->grown >= 0 && head->grown < model->slow_count + model->fast_count)
        about = "state", name = model->state[head->grown].name;
    else if (head->subset >= 0 && head->subset < model->subset_count)
        about = "subset", name = model->subset_name[head->subset];
    if (name[0])
        return fmu_say(instance, result, "%s at t = %.9g s: %s: %s '%s'", what, (double)gic_time(of), text, about,
                       name);
    return fmu_say(instance, result, "%s at t = %.9g s: %s", what, (double)gic_time(of), text);
}

/* ---- inputs over a communication step ----------------------------------------------------------------------- */

static gic_real held_at(const fmu_data *data, gic_real time, int32_t i)
{
    const gic_real after = time - data->point;
    return data->held[i] + after * (data->slope[i][0] + GIC_R(0.5) * after * data->slope[i][1]);
}

/* A driven coordinate goes on with its rate and acceleration, every input and port with the derivatives that were set.
 */
static void input_function(void *user, int32_t lane, gic_real time, gic_real *input)
{
    fmu_data *data = (fmu_data *)user;
    FMU_TYPE *one = input == data->self.input ? &data->self : &data->shown;
    int32_t i;
    (void)lane;
    for (i = 0; i < FMU_INPUTS; ++i)
        input[i] = held_at(data, time, i);
    for (i = 0; i < FMU_PORTS; ++i)
        one->port[i] = held_at(data, time, FMU_INPUTS + i);
}

/* ... that of which input `input` is a part; -1: all. */
static void drive(fmu_data *data, int32_t input)
{
    int32_t c;
    for (c = 0; c < model->coordinate_count; ++c) {
        const int32_t i = model->coordinate_input[c];
        if (i < 0 || (input >= 0 && (input < i || input > i + 2)))
            continue;
        data->slope[i][0] = data->held[i + 1];
        data->slope[i][1] = data->slope[i + 1][0] = data->held[i + 2];
        data->slope[i + 1][1] = data->slope[i + 2][0] = data->slope[i + 2][1] = GIC_R(0.0);
    }
}

/* Heads point to this instance. In model exchange inputs are what the importer sets. */
static void adopt(fmu_data *data)
{
    FMU_TYPE *one[2];
    int i;
    one[0] = &data->self;
    one[1] = &data->shown;
    for (i = 0; i < 2; ++i) {
        one[i]->head.road = fmu_ground_adopt(&data->ground);
        one[i]->head.input_function = data->exchange ? NULL : input_function;
        one[i]->head.user = data->exchange ? NULL : data;
    }
}

static void changed(fmu_data *data)
{
    data->rated = data->seen = data->located = 0;
}

/* Where wheels are. */
static fmu_result locate(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    int status;
    if (data->located || FMU_WHEELS == 0)
        return FMU_OK;
    data->shown = data->self;
    data->seen = 0;
    status = fmu_places(&data->shown, data->place);
    if (status != GIC_OK)
        return said(instance, FMU_DISCARD, &data->shown, "wheels have no place", status);
    data->located = 1;
    return FMU_OK;
}

/* Where there is a road, it is that under the wheels at the present state. */
static fmu_result stand(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    fmu_result result;
    if (!data->ground.given || data->moving)
        return FMU_OK;
    result = locate(instance);
    if (result == FMU_OK)
        fmu_ground_stand(&data->ground, &data->self, data->place);
    return result;
}

/* ---- initialization ----------------------------------------------------------------------------------------- */

void fmu_reset(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    const int32_t exchange = data->exchange;
    int32_t i;
    memset(data, 0, sizeof *data);
    data->exchange = exchange;
    data->mode = FMU_INSTANTIATED;
    fmu_ground_reset(&data->ground);
    for (i = 0; i < FMU_STATES; ++i) {
        data->start[i] = fmu_start_state[i];
        data->set[i] = fmu_start_given[i];
    }
    for (i = 0; i < FMU_INPUTS; ++i)
        data->held[i] = data->self.input[i] = fmu_start_input[i];
    for (i = 0; i < FMU_PARAMETERS; ++i)
        data->parameter[i] = fmu_start_parameter[i];
    data->step = FMU_START_STEP;
    data->method = FMU_START_METHOD;
    data->ratio = FMU_START_RATIO;
    data->keep = FMU_START_KEEP;
    data->spread = FMU_START_SPREAD;
    data->locate = FMU_START_LOCATE;
    data->most = FMU_START_MOST;
    data->gear = FMU_START_GEAR;
}

fmu_result fmu_experiment(fmu_instance *instance, double start, int stops, double stop)
{
    fmu_data *data = &instance->data;
    if (!isfinite(start) || (stops && !(stop >= start)))
        return fmu_say(instance, FMU_ERROR, "start time %g s and stop time %g s are no interval", start, stop);
    data->start_time = data->point = (gic_real)start;
    data->stops = stops != 0;
    data->stop_time = (gic_real)stop;
    data->ready = 0;
    return FMU_OK;
}

/* RK4 has one rate. */
static int32_t ratio_of(const fmu_data *data)
{
    return data->method == GIC_RK4 + 1 ? 1 : data->ratio;
}

fmu_result fmu_initialize(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    int32_t i;
    int status;
    if (data->ready)
        return FMU_OK;
    if (data->most > 0 && data->most < GIC_LEAST_MOST(ratio_of(data)))
        return fmu_say(instance, FMU_ERROR, "solver.most_work must be 0, or %d and more with solver.ratio %d, not %d",
                       (int)GIC_LEAST_MOST(ratio_of(data)), (int)ratio_of(data), (int)data->most);
    status = model->setup_with(&data->self, data->parameter);
    if (status != GIC_OK)
        return said(instance, FMU_ERROR, &data->self, "the model can't be set up", status);
    adopt(data);
    data->self.head.locate = data->locate;
    data->self.head.most = data->most;
    if (model->implicit) {
        gic_implicit_head *head = (gic_implicit_head *)(void *)((char *)&data->self + model->implicit->head_offset);
        head->keep = data->keep;
        head->spread = data->spread;
    }
    gic_restart(&data->self, data->start_time);
    drive(data, -1);
    for (i = 0; i < FMU_INPUTS; ++i)
        data->self.input[i] = data->held[i];
    for (i = 0; i < FMU_PORTS; ++i)
        data->self.port[i] = data->held[FMU_INPUTS + i];
    for (i = 0; i < model->slow_count; ++i)
        if (data->set[i])
            data->self.state[i] = data->start[i];
    changed(data);
    if (stand(instance) != FMU_OK)
        return FMU_ERROR;
    status = model->roll ? model->roll(&data->self) : GIC_OK;
    if (status != GIC_OK)
        return said(instance, FMU_ERROR, &data->self, "no initial state with rolling wheels", status);
    for (; i < FMU_STATES; ++i)
        if (data->set[i])
            data->self.state[i] = data->start[i];
    for (i = model->free_base; i < model->discrete_count; ++i)
        data->self.discrete[i] = data->gear;
    data->ready = 1;
    changed(data);
    return FMU_OK;
}

/* ---- values ------------------------------------------------------------------------------------------------- */

static fmu_result unknown(fmu_instance *instance, uint32_t reference)
{
    return fmu_say(instance, FMU_ERROR, "there is no variable of this type with value reference %u",
                   (unsigned)reference);
}

/* Rates at the present state. */
static fmu_result rates(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    fmu_result result = fmu_initialize(instance);
    int status;
    if (result != FMU_OK || data->rated)
        return result;
    result = stand(instance);
    if (result != FMU_OK)
        return result;
    status = model->rhs(&data->self, fmu_time(instance), data->self.state, data->rate);
    if (status != GIC_OK)
        return said(instance, FMU_DISCARD, &data->self, "no derivatives", status);
    data->rated = 1;
    return FMU_OK;
}

/* Outputs at the present state, on a copy. */
static fmu_result look(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    fmu_result result = fmu_initialize(instance);
    int status;
    if (result != FMU_OK || data->seen)
        return result;
    result = stand(instance);
    if (result != FMU_OK)
        return result;
    data->shown = data->self;
    data->shown.head.grown = -1;
    data->shown.head.unchecked = 0;
    status = model->outputs(&data->shown);
    if (status != GIC_OK)
        return said(instance, FMU_DISCARD, &data->shown, "no outputs", status);
    data->seen = 1;
    return FMU_OK;
}

fmu_result fmu_get_real(fmu_instance *instance, uint32_t reference, double *value)
{
    fmu_data *data = &instance->data;
    const int32_t kind = (int32_t)(reference / FMU_KIND), i = (int32_t)(reference % FMU_KIND);
    fmu_result result = FMU_OK;
    if (kind == FMU_TIME && i == 0) {
        *value = fmu_time(instance);
    } else if (kind == FMU_STATE && i < FMU_STATES) {
        result = fmu_initialize(instance);
        *value = data->self.state[i];
    } else if (kind == FMU_DERIVATIVE && i < FMU_STATES) {
        result = data->exchange ? rates(instance) : look(instance);
        *value = data->exchange ? data->rate[i] : data->shown.rate[i];
    } else if (kind == FMU_INPUT && i < FMU_INPUTS) {
        *value = data->held[i];
    } else if (kind == FMU_OUTPUT && i < FMU_OUTPUTS) {
        result = look(instance);
        *value = data->shown.output[i];
    } else if (kind == FMU_PARAMETER && i < FMU_PARAMETERS) {
        *value = data->parameter[i];
    } else if (kind == FMU_PORT && i < FMU_PORTS) {
        *value = data->held[FMU_INPUTS + i];
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_STEP) {
        *value = data->step;
    } else if (kind == FMU_INDICATOR && i < FMU_INDICATORS) {
        double all[FMU_INDICATORS + 1];
        result = fmu_get_indicators(instance, all, FMU_INDICATORS);
        *value = result == FMU_OK ? all[i] : 0.0;
    } else if (kind == FMU_ROAD && i < FMU_PLANE * FMU_WHEELS) {
        *value = data->ground.plane[i / FMU_PLANE][i % FMU_PLANE];
    } else if (kind == FMU_PLACE && i < 2 * FMU_WHEELS) {
        result = fmu_initialize(instance);
        if (result == FMU_OK)
            result = locate(instance);
        *value = data->place[i / 2][i % 2];
    } else {
        return unknown(instance, reference);
    }
    return result;
}

enum { BEFORE = FMU_INSTANTIATED | FMU_INITIALIZATION, BETWEEN = FMU_EVENT | FMU_STEP };

/* A number of the plane under a wheel. */
static fmu_result set_road(fmu_instance *instance, int32_t i, double value)
{
    fmu_data *data = &instance->data;
    const int32_t part = i % FMU_PLANE;
    if (part == FMU_NORMAL_Z && !(value > 0))
        return fmu_say(instance, FMU_DISCARD,
                       "the normal of the road must point upwards: z %g is not greater than zero", value);
    if (part == FMU_FRICTION && !(value > 0))
        return fmu_say(instance, FMU_DISCARD, "friction must be greater than zero: %g", value);
    data->ground.plane[i / FMU_PLANE][part] = (gic_real)value;
    data->ground.given = 1;
    adopt(data);
    return FMU_OK;
}

fmu_result fmu_set_real(fmu_instance *instance, uint32_t reference, double value)
{
    fmu_data *data = &instance->data;
    const int32_t kind = (int32_t)(reference / FMU_KIND), i = (int32_t)(reference % FMU_KIND);
    const int32_t mode = data->mode;
    int32_t modes = BEFORE;
    if (!isfinite(value))
        return fmu_say(instance, FMU_DISCARD, "value reference %u: %g is not a finite number; the value stays as it is",
                       (unsigned)reference, value);
    if (kind == FMU_INPUT || kind == FMU_PORT || kind == FMU_ROAD)
        modes |= BETWEEN | FMU_CONTINUOUS;
    else if (kind == FMU_PARAMETER && i < FMU_PARAMETERS && !model->parameter_geometric[i])
        modes |= BETWEEN;
    if (kind == FMU_INPUT && i < FMU_INPUTS && mode & modes) {
        data->held[i] = (gic_real)value;
        if (!data->exchange)
            drive(data, i);
        data->self.input[i] = (gic_real)value;
    } else if (kind == FMU_PORT && i < FMU_PORTS && mode & modes) {
        data->held[FMU_INPUTS + i] = data->self.port[i] = (gic_real)value;
    } else if (kind == FMU_ROAD && i < FMU_PLANE * FMU_WHEELS && mode & modes) {
        const fmu_result result = set_road(instance, i, value);
        if (result != FMU_OK)
            return result;
    } else if (kind == FMU_PARAMETER && i < FMU_PARAMETERS && mode & modes) {
        data->parameter[i] = data->self.parameter[i] = (gic_real)value;
    } else if (kind == FMU_STATE && i < FMU_STATES && mode & modes) {
        if (!gic_bounded(&(const gic_real){(gic_real)value}, 1))
            return fmu_say(instance, FMU_DISCARD, "'%s' can't be as large as %g", model->state[i].name, value);
        data->start[i] = (gic_real)value;
        data->set[i] = 1;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_STEP && mode & modes) {
        if (!(value >= 1e-9)) /* as the model description says */
            return fmu_say(instance, FMU_DISCARD, "solver.step must be 1e-9 s or more, not %g", value);
        data->step = (gic_real)value;
    } else if (mode & modes) {
        return unknown(instance, reference);
    } else {
        return fmu_say(instance, FMU_ERROR, "the variable with value reference %u can't be set now",
                       (unsigned)reference);
    }
    if (mode & BEFORE)
        data->ready = 0;
    changed(data);
    return FMU_OK;
}

/* Has the code Jacobians by shares? */
static int shares(void)
{
    return model->implicit && model->implicit->share_count > 0;
}

/* Is there something that happens within steps? */
static int has_events(void)
{
    return model->contacts || model->shift;
}

fmu_result fmu_get_integer(fmu_instance *instance, uint32_t reference, int32_t *value)
{
    fmu_data *data = &instance->data;
    const int32_t kind = (int32_t)(reference / FMU_KIND), i = (int32_t)(reference % FMU_KIND);
    if (kind == FMU_SOLVER &&
        (i == FMU_SOLVER_METHOD || i == FMU_SOLVER_RATIO || (i == FMU_SOLVER_KEEP && model->implicit))) {
        *value = i == FMU_SOLVER_METHOD ? data->method : i == FMU_SOLVER_RATIO ? data->ratio : data->keep;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_SPREAD && shares()) {
        *value = data->spread;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_LOCATE && model->contacts) {
        *value = data->locate;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_MOST && has_events()) {
        *value = data->most;
    } else if (kind == FMU_DISCRETE && model->discrete_count > model->free_base && i == model->free_base) {
        const fmu_result result = fmu_initialize(instance);
        *value = data->self.discrete[i];
        return result;
    } else {
        return unknown(instance, reference);
    }
    return FMU_OK;
}

fmu_result fmu_set_integer(fmu_instance *instance, uint32_t reference, int32_t value)
{
    fmu_data *data = &instance->data;
    const int32_t kind = (int32_t)(reference / FMU_KIND), i = (int32_t)(reference % FMU_KIND);
    if (!(data->mode & BEFORE))
        return fmu_say(instance, FMU_ERROR, "the variable with value reference %u can't be set now",
                       (unsigned)reference);
    if (kind == FMU_SOLVER && i == FMU_SOLVER_METHOD) {
        const int32_t own = !model->implicit ? GIC_RK4 : model->implicit->exponential_offset ? GIC_EXP3 : GIC_IMEX;
        const int32_t most = own + 1;
        if (value < GIC_AB3 + 1 || value > most)
            return fmu_say(instance, FMU_DISCARD, "solver.method is %s, not %d",
                           own == GIC_EXP3   ? "1 (AB3), 2 (RK4), 3 (ROS2), 4 (ROS3), 5 (IMEX) or 6 (EXP3)"
                           : model->implicit ? "1 (AB3), 2 (RK4), 3 (ROS2), 4 (ROS3) or 5 (IMEX)"
                                             : "1 (AB3) or 2 (RK4)",
                           (int)value);
        data->method = value;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_RATIO) {
        if (value < 1 || value > GIC_RATIOS)
            return fmu_say(instance, FMU_DISCARD, "solver.ratio must be from 1 to %d, not %d", GIC_RATIOS, (int)value);
        data->ratio = value;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_KEEP && model->implicit) {
        if (value < 1 || value > FMU_MOST_KEEP)
            return fmu_say(instance, FMU_DISCARD, "solver.keep_jacobian must be from 1 to %d, not %d",
                           (int)FMU_MOST_KEEP, (int)value);
        data->keep = value;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_SPREAD && shares()) {
        if (value < 0 || value > 1)
            return fmu_say(instance, FMU_DISCARD, "solver.spread_jacobian is 0 or 1, not %d", (int)value);
        data->spread = value;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_LOCATE && model->contacts) {
        if (value < 0 || value > 2)
            return fmu_say(instance, FMU_DISCARD, "solver.locate is 0, 1 or 2, not %d", (int)value);
        data->locate = value;
    } else if (kind == FMU_SOLVER && i == FMU_SOLVER_MOST && has_events()) {
        if (value < 0 || value > FMU_MOST_WORK)
            return fmu_say(instance, FMU_DISCARD, "solver.most_work must be from 0 to %d, not %d", (int)FMU_MOST_WORK,
                           (int)value);
        data->most = value;
    } else if (kind == FMU_DISCRETE && model->discrete_count > model->free_base && i == model->free_base) {
        if (value < FMU_LEAST_GEAR || value > FMU_MOST_GEAR)
            return fmu_say(instance, FMU_DISCARD, "there is no gear %d", (int)value);
        data->gear = value;
    } else {
        return unknown(instance, reference);
    }
    data->ready = 0;
    changed(data);
    return FMU_OK;
}

fmu_result fmu_set_slope(fmu_instance *instance, uint32_t reference, int32_t order, double value)
{
    const int32_t kind = (int32_t)(reference / FMU_KIND), i = (int32_t)(reference % FMU_KIND);
    if (kind == FMU_ROAD && i < FMU_PLANE * FMU_WHEELS)
        return fmu_say(instance, FMU_WARNING, "the road goes on by its normal; derivatives of it are not taken");
    if (!(kind == FMU_INPUT && i < FMU_INPUTS) && !(kind == FMU_PORT && i < FMU_PORTS))
        return fmu_say(instance, FMU_ERROR, "value reference %u: derivatives are for inputs", (unsigned)reference);
    if (order < 1 || order > 2)
        return fmu_say(instance, FMU_ERROR, "derivatives of inputs are of order 1 or 2, not %d", (int)order);
    if (!isfinite(value))
        return fmu_say(instance, FMU_DISCARD, "a derivative is not a finite number; it stays as it is");
    instance->data.slope[kind == FMU_PORT ? FMU_INPUTS + i : i][order - 1] = (gic_real)value;
    changed(&instance->data);
    return FMU_OK;
}

/* ---- model exchange ----------------------------------------------------------------------------------------- */

double fmu_time(const fmu_instance *instance)
{
    const fmu_data *data = &instance->data;
    return data->ready ? (double)gic_time(&data->self) : (double)data->start_time;
}

fmu_result fmu_set_time(fmu_instance *instance, double time)
{
    if (!isfinite(time))
        return fmu_say(instance, FMU_DISCARD, "the time is not a finite number");
    gic_restart(&instance->data.self, (gic_real)time);
    changed(&instance->data);
    return FMU_OK;
}

static fmu_result count_right(fmu_instance *instance, size_t count)
{
    return count == FMU_STATES ? FMU_OK
                               : fmu_say(instance, FMU_ERROR, "there are %d continuous states, not %u", (int)FMU_STATES,
                                         (unsigned)count);
}

fmu_result fmu_set_states(fmu_instance *instance, const double *x, size_t count)
{
    fmu_data *data = &instance->data;
    gic_real next[FMU_STATES_ROOM];
    size_t i;
    if (count_right(instance, count) != FMU_OK)
        return FMU_ERROR;
    for (i = 0; i < count; ++i)
        next[i] = (gic_real)x[i];
    if (!gic_bounded(next, (int32_t)count))
        return fmu_say(instance, FMU_DISCARD, "a continuous state is beyond all bounds; states stay as they are");
    memcpy(data->self.state, next, count * sizeof *next);
    changed(data);
    return FMU_OK;
}

fmu_result fmu_get_states(fmu_instance *instance, double *x, size_t count)
{
    fmu_result result = count_right(instance, count);
    size_t i;
    if (result == FMU_OK)
        result = fmu_initialize(instance);
    for (i = 0; result == FMU_OK && i < count; ++i)
        x[i] = instance->data.self.state[i];
    return result;
}

fmu_result fmu_get_rates(fmu_instance *instance, double *rate, size_t count)
{
    fmu_result result = count_right(instance, count);
    size_t i;
    if (result == FMU_OK)
        result = rates(instance);
    for (i = 0; result == FMU_OK && i < count; ++i)
        rate[i] = instance->data.rate[i];
    return result;
}

fmu_result fmu_get_nominals(fmu_instance *instance, double *x, size_t count)
{
    fmu_result result = count_right(instance, count);
    size_t i;
    for (i = 0; result == FMU_OK && i < count; ++i)
        x[i] = fmu_nominal[i];
    return result;
}

int fmu_event_due(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    if (!model->shift)
        return 0;
    data->shown = data->self;
    data->seen = 0;
    return model->shift(&data->shown);
}

/* Contacts at the present state, on a copy. */
static fmu_result touch(fmu_instance *instance, double *value)
{
    fmu_data *data = &instance->data;
    gic_real press[GIC_CONTACTS];
    int32_t i;
    int status;
    const fmu_result result = stand(instance);
    if (result != FMU_OK)
        return result;
    data->shown = data->self;
    data->seen = 0;
    status = model->contacts->press(&data->shown, fmu_time(instance), data->shown.state, press);
    if (status != GIC_OK)
        return said(instance, FMU_DISCARD, &data->shown, "no contacts", status);
    for (i = 0; i < model->contact_count; ++i)
        value[i] = press[i];
    return FMU_OK;
}

fmu_result fmu_get_indicators(fmu_instance *instance, double *value, size_t count)
{
    fmu_result result;
    if (count != FMU_INDICATORS)
        return fmu_say(instance, FMU_ERROR, "there are %d event indicators, not %u", (int)FMU_INDICATORS,
                       (unsigned)count);
    result = fmu_initialize(instance);
    if (result == FMU_OK && model->shift)
        value[0] = fmu_event_due(instance) ? -1.0 : 1.0;
    if (result == FMU_OK && count > (size_t)(model->shift != NULL))
        result = touch(instance, value + (model->shift != NULL));
    return result;
}

int fmu_event(fmu_instance *instance)
{
    fmu_data *data = &instance->data;
    const int shifted = model->shift && model->shift(&data->self);
    if (shifted)
        changed(data);
    return shifted;
}

const char *fmu_no_exchange(void)
{
    return model->controller_count ? "the model has sampled controllers, which only co-simulation samples" : NULL;
}

/* ---- fixed steps -------------------------------------------------------------------------------------------- */

static int one_step(fmu_data *data, gic_real step)
{
    return gic_step_dual_by(model, &data->self, step, data->method - 1, ratio_of(data), FMU_STEADY);
}

fmu_result fmu_do_step(fmu_instance *instance, double point, double length)
{
    fmu_data *data = &instance->data;
    const double now = fmu_time(instance), near = 1e-9 * (1 + fabs(point));
    double count, step;
    int32_t i;
    int status = GIC_OK, ended = 0;
    if (!(length > 0) || !isfinite(length))
        return fmu_say(instance, FMU_ERROR, "the communication step must be longer than zero, not %g s", length);
    if (!(fabs(point - now) <= near))
        return fmu_say(instance, FMU_ERROR, "the communication point is %.9g s, but the vehicle is at %.9g s", point,
                       now);
    if (data->stops && point + length > data->stop_time + near)
        return fmu_say(instance, FMU_ERROR, "the step ends after the stop time, %.9g s", (double)data->stop_time);
    count = ceil(length / data->step - 1e-9);
    if (count < 1)
        count = 1;
    if (count > 1e9)
        return fmu_say(instance, FMU_ERROR, "the communication step takes more than 1e9 steps of solver.step");
    step = length / count;
    if (fabs(step - data->step) <= 1e-9 * data->step)
        step = data->step; /* the same to the last bit, so that multistep history counts */
    data->point = gic_time(&data->self);
    changed(data);
    if (stand(instance) != FMU_OK)
        return FMU_DISCARD;
    data->moving = 1;
    for (i = 0; i < (int32_t)count && status == GIC_OK && !ended; ++i) {
        status = one_step(data, (gic_real)step);
        changed(data);
        ended = status == GIC_OK && i + 1 < (int32_t)count && instance->between && instance->between(instance);
    }
    for (i = 0; i < FMU_INPUTS + FMU_PORTS; ++i)
        data->held[i] = held_at(data, gic_time(&data->self), i);
    data->point = gic_time(&data->self);
    memset(data->slope, 0, sizeof data->slope);
    drive(data, -1);
    data->moving = 0;
    if (data->ground.given && locate(instance) == FMU_OK)
        fmu_ground_move(&data->ground, data->place);
    if (status == GIC_OK)
        return FMU_OK;
    data->mode = FMU_FAILED;
    return said(instance, FMU_DISCARD, &data->self, "a step failed", status);
}

/* ---- copies ------------------------------------------------------------------------------------------------- */

typedef struct fmu_copy {
    char token[64];
    uint64_t size, real;
    fmu_data data;
} fmu_copy;

size_t fmu_copy_size(void)
{
    return sizeof(fmu_copy);
}

static void without_addresses(FMU_TYPE *one)
{
    one->head.input_function = NULL;
    one->head.user = NULL;
    one->head.road = NULL;
}

void fmu_copy_out(const fmu_instance *instance, char *bytes)
{
    fmu_copy *copy = (fmu_copy *)(void *)bytes;
    memset(copy, 0, sizeof *copy);
    strncpy(copy->token, FMU_TOKEN, sizeof copy->token - 1);
    copy->size = sizeof *copy;
    copy->real = sizeof(gic_real);
    memcpy(&copy->data, &instance->data, sizeof copy->data);
    without_addresses(&copy->data.self);
    without_addresses(&copy->data.shown);
    copy->data.ground.head.height = NULL;
    copy->data.ground.head.friction = NULL;
}

fmu_result fmu_copy_check(fmu_instance *instance, const char *bytes, size_t size)
{
    char token[sizeof((fmu_copy *)NULL)->token] = FMU_TOKEN;
    uint64_t sizes[2];
    if (size == sizeof(fmu_copy))
        memcpy(sizes, bytes + offsetof(fmu_copy, size), sizeof sizes);
    if (size != sizeof(fmu_copy) || memcmp(bytes, token, sizeof token) || sizes[0] != sizeof(fmu_copy) ||
        sizes[1] != sizeof(gic_real))
        return fmu_say(instance, FMU_ERROR, "these bytes are not a state of this FMU");
    return FMU_OK;
}

fmu_result fmu_copy_in(fmu_instance *instance, const char *bytes, size_t size)
{
    const int32_t exchange = instance->data.exchange;
    int32_t copied;
    if (fmu_copy_check(instance, bytes, size) != FMU_OK)
        return FMU_ERROR;
    memcpy(&copied, bytes + offsetof(fmu_copy, data) + offsetof(fmu_data, exchange), sizeof copied);
    if (copied != exchange)
        return fmu_say(instance, FMU_ERROR, "this is the state of an instance of the other interface");
    memcpy(&instance->data, bytes + offsetof(fmu_copy, data), sizeof instance->data);
    adopt(&instance->data);
    return FMU_OK;
}
