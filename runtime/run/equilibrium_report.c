/* SPDX-License-Identifier: MIT
 * The report of a static equilibrium for people and programs. */
#include "base/message.h"
#include "base/text.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "model/tunable.h"
#include "run/linearize.h"
#include "run/run.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <float.h>
#include <math.h>
#include <string.h>

static int32_t *discrete_states(gic_head *self, const gic_model *code)
{
    return (int32_t *)(void *)instance_array(self, code->discrete_offset);
}

/* True if the rate of a number of the state vanishes in the equilibrium. With locked wheels only those of slips must.
 */
static bool rests(const Equilibrium *found, int number)
{
    const Linear *linear = found->linear;
    const int i = number - found->engine->code->free_base;
    return i < 2 * linear->places || !found->locked || linear->slips[i];
}

/* Largest acceleration that an engine finds at a state, which has the layout of found->self. */
static double residual_by(Pool *pool, const Engine *engine, const Scene *scene, const Equilibrium *found, double *state)
{
    const gic_model *code = engine->code, *own = found->engine->code;
    gic_head *self = instance_new(pool, engine), *from = &found->self->head;
    double rate[engine->standard_count + 1], worst = 0;
    int status = code->setup_with(self, instance_array(from, own->parameter_offset));
    self->road = scene ? scene->road : NULL;
    for (int i = code->free_base; i < code->discrete_count; ++i) /* Euler parameters are found anew; locked: neutral */
        discrete_states(self, code)[i] = found->locked ? 0 : discrete_states(from, own)[i];
    memcpy(instance_array(self, code->input_offset), instance_array(from, own->input_offset),
           (size_t)code->input_count * sizeof(double));
    if (status == GIC_OK)
        status = engine_enter(engine, self, state);
    if (status == GIC_OK)
        status = engine_look(engine, self, state, rate);
    if (status != GIC_OK)
        diag_fail((Place){found->model->source, 0, 0}, "try another --engine",
                  "engine %s can't evaluate the equilibrium: %s", engine->name,
                  instance_status(pool, code, self, status));
    for (int i = found->linear->places + code->free_base; i < engine->standard_count - found->linear->clocks; ++i)
        if (rests(found, i))
            worst = fmax(worst, fabs(rate[i]));
    return worst;
}

/* To 1e-9, for people. */
static double shown(double value)
{
    return round(value * 1e9) / 1e9 + 0.0; /* no -0 */
}

static bool is_angle(const Equilibrium *found, int coordinate)
{
    return found->model->coordinate[coordinate].type == COORDINATE_ANGLE;
}

/* The largest of the positions and lengths; 1 for angles and other numbers. */
static double size_of(const Equilibrium *found, const double *state, bool angle)
{
    const gic_model *code = found->engine->code;
    double size = 0;
    if (angle)
        return 1;
    for (int i = 0; code->free_base && i < 3; ++i)
        size = fmax(size, fabs(state[i]));
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0 && !is_angle(found, c))
            size = fmax(size, fabs(state[code->coordinate_state[c]]));
    return size;
}

/* Set numbers of the state to 0 that are rounding: smaller than a part of others of their kind. The largest part of
 * PARTS is taken at which the engine finds the state at rest as before; NULL: at none of them.
 * A slip of 1e-15 is rounding for a car; in a mechanism with springs of 1e9 N/m a length of 1e-12 m is not. */
static const double *without_rounding(Pool *pool, const Engine *engine, const Scene *scene, const Equilibrium *found)
{
    static const double PARTS[] = {1e-12, DBL_EPSILON};
    const gic_model *code = found->engine->code;
    const int count = code->slow_count + code->fast_count;
    const double *state = tape_array(found->self, code->state_offset);
    double *size = pool_alloc(pool, sizeof(double) * (size_t)count);
    double *rounded = pool_alloc(pool, sizeof(double) * (size_t)count);
    for (int i = 0; i < count; ++i)
        size[i] = code->free_base && i < 3 ? size_of(found, state, false) : 1;
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            size[code->coordinate_state[c]] = size_of(found, state, is_angle(found, c));
    for (size_t k = 0; k < sizeof PARTS / sizeof *PARTS; ++k) {
        for (int i = 0; i < count; ++i)
            rounded[i] = fabs(state[i]) <= PARTS[k] * size[i] ? 0 : state[i];
        if (residual_by(pool, engine, scene, found, rounded) < equilibrium_limit)
            return rounded;
    }
    return NULL;
}

/* ---- tables --------------------------------------------------------------------------------------------- */

/* Yaw, pitch and roll of A = Rz(yaw) Ry(pitch) Rx(roll). */
static void print_base(Text *out, const Equilibrium *found, const double *state)
{
    const double degree = 3.141592653589793 / 180;
    double R[9];
    mat_from_euler(state + 3, R);
    text_print(out, "\n%-24s  x %.9g m, y %.9g m, z %.9g m\n", found->model->body[BODY_BASE].name, shown(state[0]),
               shown(state[1]), shown(state[2]));
    text_print(out, "%-24s  yaw %.6g deg, pitch %.6g deg, roll %.6g deg\n", "", shown(atan2(R[3], R[0]) / degree),
               shown(asin(fmax(-1, fmin(1, -R[6]))) / degree), shown(atan2(R[7], R[8]) / degree));
}

static void print_coordinates(Text *out, const Equilibrium *found, const double *state, const double *input)
{
    const gic_model *code = found->engine->code;
    if (code->coordinate_count)
        text_print(out, "\n%-24s  %16s\n", "coordinate", "value");
    for (int c = 0; c < code->coordinate_count; ++c) {
        const int at = code->coordinate_state[c];
        const double value = at < 0 ? input[code->coordinate_input[c]] : state[at];
        text_print(out, "%-24s  %16.9g %s%s\n", code->coordinate[c].name, value, code->coordinate[c].unit,
                   at < 0 ? ", driven" : "");
    }
}

static bool along_angle(const Model *model, const Force *force)
{
    return force_is_torque(force) ||
           (force->coordinate >= 0 && model->coordinate[force->coordinate].type == COORDINATE_ANGLE);
}

static void print_forces(Text *out, const Equilibrium *found, const double *output)
{
    const Model *model = found->model;
    bool begun = false;
    for (int i = 0; i < model->forces; ++i) {
        const int at = equilibrium_force(found, i);
        if (at < 0)
            continue;
        if (!begun)
            text_print(out, "\n%-24s  %16s\n", "force element", "force");
        begun = true;
        text_print(out, "%-24s  %16.9g %s\n", model->force[i].name, shown(output[at]),
                   along_angle(model, &model->force[i]) ? "N m" : "N");
    }
}

/* The weight that the wheels of a free base carry; 0: unknown. */
static double weight(const Model *model)
{
    double mass = 0;
    for (int b = 0; b < model->bodies; ++b) {
        if (tuned_number(model, &model->body[b].mass))
            return 0;
        mass += model->body[b].mass;
    }
    const bool vertical = model->gravity[0] == 0 && model->gravity[1] == 0;
    return model->free_base && vertical && !tuned_number(model, &model->gravity[2]) ? -mass * model->gravity[2] : 0;
}

static void print_wheels(Text *out, const Equilibrium *found, const double *output)
{
    const Model *model = found->model;
    double sum = 0;
    if (!model->wheels)
        return;
    text_print(out, "\n%-24s  %16s  %14s  %14s\n", "wheel", "load", "deflection", "road height");
    for (int i = 0; i < model->wheels; ++i) {
        const double *wheel = output + equilibrium_wheel(found, i);
        text_print(out, "%-24s  %14.9g N  %12.6g m  %12.6g m\n", model->wheel[i].name, wheel[0], wheel[1], wheel[3]);
        sum += wheel[0];
    }
    text_print(out, "%-24s  %14.9g N", "sum", sum);
    if (weight(model) > 0)
        text_print(out, ", weight %.9g N", weight(model));
    text_print(out, "\n");
    for (int i = 0; i < model->wheels; ++i) {
        const char *faded = equilibrium_faded(out->pool, found, output, i);
        if (faded)
            text_print(out, "%s%s\n", i ? "" : "\n", faded);
    }
}

/* Fast states of tires and brakes that are not 0. */
static void print_fast_states(Text *out, const Equilibrium *found, const double *state)
{
    const gic_model *code = found->engine->code;
    bool begun = false;
    for (int i = code->slow_count; i < code->slow_count + code->fast_count; ++i) {
        if (shown(state[i]) == 0)
            continue;
        if (!begun)
            text_print(out, "\n%-24s  %16s\n", "fast state", "value");
        begun = true;
        text_print(out, "%-24s  %16.9g %s\n", code->state[i].name, shown(state[i]), code->state[i].unit);
    }
}

/* The equilibrium as the start of a scene; exactly symmetric if it is symmetric to rounding. */
static const Scene *start_at(Pool *pool, const Equilibrium *found, const double *state)
{
    const gic_model *code = found->engine->code;
    Scene *start = pool_alloc(pool, sizeof *start);
    start->value = pool_alloc(pool, sizeof(double) * (size_t)(code->coordinate_count + 1));
    start->rate = pool_alloc(pool, sizeof(double) * (size_t)(code->coordinate_count + 1));
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            start->value[c] = state[code->coordinate_state[c]];
    for (int i = 0; code->free_base && i < 3; ++i)
        start->position[i] = state[i];
    for (int i = 0; code->free_base && i < 4; ++i)
        start->euler[i] = state[3 + i];
    return scene_even(pool, found->model, start);
}

/* [%.17g, ...] */
static void print_numbers(Text *out, const char *key, const double *number, int count)
{
    text_print(out, "  %s: [", key);
    for (int i = 0; i < count; ++i)
        text_print(out, "%s%.17g", i ? ", " : "", number[i]);
    text_print(out, "]\n");
}

void equilibrium_initial(Text *out, const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    const double *state = tape_array(found->self, code->state_offset);
    const Scene *start = start_at(out->pool, found, state);
    const double *at = start->position, *euler = start->euler;
    bool begun = false;
    text_print(out, "initial:\n");
    if (code->free_base) {
        print_numbers(out, "position", at, 3);
        text_print(out, "  orientation: {euler: [%.17g, %.17g, %.17g, %.17g]}\n", euler[0], euler[1], euler[2],
                   euler[3]);
        const double *velocity = state + found->linear->places + 1;
        if (norm3(velocity) > 0)
            print_numbers(out, "velocity", velocity, 3);
        if (norm3(velocity + 3) > 0)
            print_numbers(out, "angular_velocity", velocity + 3, 3);
    }
    for (int c = 0; c < code->coordinate_count; ++c) {
        if (code->coordinate_state[c] < 0)
            continue;
        text_print(out, "%s    %s: %.17g\n", begun ? "" : "  coordinates:\n", code->coordinate[c].name,
                   start->value[c]);
        begun = true;
    }
    if (code->discrete_count > code->free_base)
        text_print(out, "  gear: %d\n", discrete_states(&found->self->head, code)[code->free_base]);
    for (int i = 0; i < code->fast_count && !found->locked; ++i) /* else they roll with the scene's velocities */
        text_print(out, "%s    %s: %.17g\n", i ? "" : "  states:\n", code->state[code->slow_count + i].name,
                   state[code->slow_count + i]);
}

void equilibrium_tables(Text *out, const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    const double *state = tape_array(found->self, code->state_offset);
    const double *input = tape_array(found->self, code->input_offset);
    const double *output = tape_array(found->self, code->output_offset);
    if (code->free_base)
        print_base(out, found, state);
    print_coordinates(out, found, state, input);
    print_forces(out, found, output);
    print_wheels(out, found, output);
    print_fast_states(out, found, state);
    text_print(out, "\n");
    equilibrium_initial(out, found);
}

/* The whole table. */
static void print_table(Text *out, const Engine *engine, const Equilibrium *found, double residual)
{
    text_print(out, "%s: static equilibrium, found in %d steps\n", found->model->name, found->steps);
    text_print(out, "%-24s  %.2g m/s^2 or rad/s^2 (engine %s)\n", "largest acceleration", residual, engine->name);
    if (found->locked && found->linear->of_wheels)
        text_print(out, "%-24s  locked, for the scene starts in motion; they roll from there\n", "wheels");
    if (found->neutral)
        text_print(out, "%-24s  %s: moved along these it rests as well\n", "neutral", found->neutral);
    equilibrium_tables(out, found);
}

/* ---- for programs --------------------------------------------------------------------------------------- */

void equilibrium_row(Pool *pool, const Equilibrium *found, const char *path)
{
    const gic_model *code = found->engine->code;
    gic_head *self = &found->self->head;
    const struct {
        const char *kind;
        const gic_signal *signal;
        int count;
        size_t offset;
    } part[] = {{"state", code->state, code->slow_count + code->fast_count, code->state_offset},
                {"input", code->input, code->input_count, code->input_offset},
                {"parameter", code->parameter, code->parameter_count, code->parameter_offset}};
    interrupt_hold();
    Csv csv = csv_open(pool, path);
    for (size_t p = 0; p < sizeof part / sizeof *part; ++p)
        for (int i = 0; i < part[p].count; ++i) {
            const char *name = part[p].signal[i].name;
            bool taken = false;
            for (size_t q = 0; q < p; ++q)
                for (int k = 0; k < part[q].count; ++k)
                    taken = taken || !strcmp(part[q].signal[k].name, name);
            csv_name(&csv, taken ? pool_print(pool, "%s/%s", part[p].kind, name) : name, part[p].signal[i].unit);
        }
    for (int i = code->free_base; i < code->discrete_count; ++i)
        csv_name(&csv, code->discrete[i].name, code->discrete[i].unit);
    csv_end_row(&csv);
    for (size_t p = 0; p < sizeof part / sizeof *part; ++p)
        for (int i = 0; i < part[p].count; ++i)
            csv_number(&csv, instance_array(self, part[p].offset)[i]);
    for (int i = code->free_base; i < code->discrete_count; ++i)
        csv_number(&csv, discrete_states(self, code)[i]);
    csv_end_row(&csv);
    csv_close(&csv);
    interrupt_release();
}

void equilibrium_warn_ranges(const Equilibrium *found, Place at)
{
    const gic_model *code = found->engine->code;
    const double *state = tape_array(found->self, code->state_offset);
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            scene_warn_range(&found->model->coordinate[c], at, state[code->coordinate_state[c]],
                             state[code->coordinate_state[c]]);
}

static void warn_tipped(const Equilibrium *found, Place at)
{
    const double lean = equilibrium_lean(found);
    if (lean > equilibrium_tipped)
        diag_warn(at,
                  "bring the centre of mass between the wheels (`com`, `center`), or start the vehicle nearer to where "
                  "it stands",
                  "the vehicle does not rest on its wheels: it tips over and lies there leaning by %.0f degrees",
                  57.29577951308232 * lean);
}

/* Warn if a small disturbance grows. Free wheels and slips without load leave eigenvalues of about 1e-5 1/s around 0.
 */
static void warn_unstable(Pool *pool, const Equilibrium *found, Place at)
{
    const double slowest = 1e-4; /* 1/s */
    const Modes *modes = modes_find(pool, found->linear, found->A);
    for (int k = 0; k < modes->count; ++k)
        if (modes->mode[k].real > fmax(slowest, 1e-6 * hypot(modes->mode[k].real, modes->mode[k].imaginary))) {
            diag_warn(at, "--modes shows what moves; start elsewhere to find another one",
                      "the equilibrium is unstable: eigenvalue %.4g %+.4gi 1/s", modes->mode[k].real,
                      modes->mode[k].imaginary);
            return;
        }
}

double equilibrium_settle(Pool *pool, const Engine *engine, const Scene *scene, bool quiet, const Equilibrium *found)
{
    const gic_model *code = found->engine->code;
    double *state = tape_array(found->self, code->state_offset);
    const Place at = {scene ? scene->source : found->model->source, 0, 0};
    const double *rounded = without_rounding(pool, engine, scene, found);
    if (rounded)
        memcpy(state, rounded, (size_t)(code->slow_count + code->fast_count) * sizeof *state);
    const double residual = residual_by(pool, engine, scene, found, state);
    const int status = code->outputs(found->self);
    if (!(residual < equilibrium_limit))
        diag_fail(at, "try another --engine", "engine %s finds an acceleration of %.3g at the equilibrium",
                  engine->name, residual);
    if (status != GIC_OK)
        diag_fail(at, NULL, "no outputs: %s", instance_status(pool, code, &found->self->head, status));
    if (!quiet) {
        warn_tipped(found, at);
        equilibrium_warn_ranges(found, at);
        warn_unstable(pool, found, at);
    }
    return residual;
}

void equilibrium_report(Pool *pool, const Engine *engine, const Scene *scene, const Request *request,
                        const Equilibrium *found)
{
    const double residual = equilibrium_settle(pool, engine, scene, request->quiet, found);
    if (request->results && !strcmp(request->results, "-")) {
        equilibrium_row(pool, found, request->results);
        return;
    }
    if (!request->results || !request->quiet) {
        Text table = {.pool = pool};
        print_table(&table, engine, found, residual);
        diag_text(table.s);
    }
    /* last, so that a file is there only where nothing failed */
    if (request->results)
        equilibrium_row(pool, found, request->results);
}
