/* SPDX-License-Identifier: MIT
 * The validation of a formulation: all states, code for a scene against code for any, and messages. */
#include "base/message.h"
#include "base/random.h"
#include "base/version.h"
#include "expression/expression.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "validate/compare.h"
#include "validate/play.h"
#include "validate/run.h"
#include "validate/validate.h"
#include "validate/validate_private.h"
#include "vehicle/vehicle.h"
#include "world/equations.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Name and largest difference of each kind. Differences by rounding are below 1e-11 in the models and some hundred
 * random vehicles with the worst condition that is allowed; a wrong formula makes a difference of the size of the
 * quantity. */
static const struct {
    const char *block, *text;
    double most;
} kind[KINDS] = {
    [KIND_ROTATION] = {"solve", "a rotation that is none", 1e-9},
    [KIND_POSE] = {"solve", "poses that do not fit", 1e-8},
    [KIND_VELOCITY] = {"solve", "velocities that are not those of the poses", 1e-7},
    [KIND_PARTIAL] = {"solve", "S that is not the derivative of the poses", 1e-7},
    [KIND_ACCELERATION] = {"solve", "accelerations that are not those of the velocities", 1e-6},
    [KIND_MOTION] = {"dynamics", "accelerations that do not solve the equations of motion", 1e-6},
    [KIND_RATE] = {"dynamics", "rates of coordinates that are not their velocities", 1e-9},
    [KIND_FAST] = {"wheels", "rates of fast states that tires and powertrain do not have", 1e-6},
    [KIND_WHEEL] = {"wheels", "a wheel that does not do what its tire does", 1e-6},
    [KIND_OUTPUT] = {"outputs", "outputs that are not those of the motion", 1e-6},
    [KIND_POSES] = {"poses", "poses of bodies that are not those of the motion", 1e-8},
    [KIND_REACTION] = {"react", "reactions that do not hold the bodies", 1e-6},
    [KIND_ATTITUDE] = {"outputs", "orientations that are not those of the motion", 1e-6},
    [KIND_FOLLOW] = {"predict and chord", "corrections of poses that do not lead to the solution", 1e-2},
    [KIND_INVERSE] = {"inverse", "equations of motion of the self-test that are not those of the bodies", 1e-6},
    [KIND_ENERGY] = {"energy", "powers that are not those of the forces", 1e-6},
    [KIND_SHIFT] = {"shift", "a choice of gears that is not that of its formulas", 1e-6},
    [KIND_SCENE] = {"code for the scene", "other rates than code for all scenes has", 1e-6},
    [KIND_SCENE_OUTPUT] = {"code for the scene", "other outputs than code for all scenes has", 1e-6},
};

void compare(Comparison *c, Kind which, const char *what, double difference, double scale)
{
    const double share = difference == 0 ? 0 : fabs(difference) / (kind[which].most * scale);
    if (share <= c->worst[which].share)
        return;
    c->worst[which] = (Finding){isnan(share) ? HUGE_VAL : share, which, what, difference, scale, c->index};
}

/* The state of an engine that drives nothing and is not an output, which code for a scene keeps constant; -1: none. */
static int idle_engine(const Comparison *c)
{
    const Model *model = c->v.model;
    const bool seen = !model->powertrain || !c->v.facts->neutral || model_reads(model, OUTPUT_POWERTRAIN);
    return seen ? -1 : c->v.run->plan->states + model->powertrain->fast + POWERTRAIN_SPEED;
}

/* Compare code for a scene with code for any scene at the same state. */
static void compare_scene(Comparison *c)
{
    const Model *model = c->v.model;
    const Run *all = c->v.run, *scene = c->scene;
    const int states = all->plan->states;
    double largest = 1;
    for (int i = 0; i < states; ++i)
        largest = fmax(largest, fabs(all->rate[i][c->k]));
    for (int i = 0; i < states + model->fast_states; ++i) {
        const double right = all->rate[i][c->k];
        if (i == idle_engine(c))
            continue;
        compare(c, KIND_SCENE, c->state_name[i], scene->rate[i][c->k] - right, i < states ? largest : fabs(right) + 1);
    }
    for (int i = 0; c->self_test && i < all->plan->unknowns; ++i)
        compare(c, KIND_SCENE, unknown_name(c, i), scene->tau[i][c->k] - all->tau[i][c->k],
                fabs(all->tau[i][c->k]) + c->push);
    for (int i = 0; i < model->wheels; ++i)
        for (int j = 0; model->wheel[i].tire >= 0 && j < GRIP_POWER; ++j) {
            const int at = GRIP_NUMBERS * wheel_rolling(model, i) + j;
            const double right = all->grip[at][c->k];
            compare(c, KIND_SCENE, model->wheel[i].name, scene->grip[at][c->k] - right,
                    fabs(right) + (j < GRIP_KAPPA && j != GRIP_HEIGHT ? c->world->rolling[i].fz : 0) + 1);
        }
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count) {
        for (int j = 0; j < model->output[i].count; ++j)
            c->out[at + j] = all->out[at + j][c->k];
        compare_output(c, KIND_SCENE_OUTPUT, &model->output[i], scene->out + at, c->out + at);
    }
    for (int i = 0; i < 7 * model->bodies; ++i)
        compare(c, KIND_SCENE_OUTPUT, model->body[i / 7].name, scene->pose[i][c->k] - all->pose[i][c->k], 1);
}

/* ---- all states -----------------------------------------------------------------------------------------------------
 */

static void say(const Comparison *c)
{
    const Finding *worst = &c->worst[0];
    for (int i = 0; i < KINDS; ++i) {
        if (getenv("GICGEN_VALIDATION"))
            fprintf(stderr, "%-55s %-20s %10.2e of %9.2e at %d: %.1e\n", kind[i].text,
                    c->worst[i].what ? c->worst[i].what : "", c->worst[i].value, c->worst[i].scale, c->worst[i].state,
                    c->worst[i].share * kind[i].most);
        if (c->worst[i].share > 1 && worst->share <= 1)
            worst = &c->worst[i];
    }
    if (getenv("GICGEN_VALIDATION"))
        fprintf(stderr, "compared %d, left out %d: %s of %s\n", c->compared, c->left, c->refused ? c->refused : "-",
                c->where ? c->where : "-");
    const Place place = {c->v.model->source, 0, 0};
    if (worst->share <= 1 && !c->compared)
        diag_warn(place, "look at the ranges of the coordinates, and at what the self-test says",
                  "the code could not be compared with anything: at each of %d states it ends in %s of '%s'", c->left,
                  c->refused, c->where);
    if (worst->share <= 1)
        return;
    const bool scene = worst->kind == KIND_SCENE || worst->kind == KIND_SCENE_OUTPUT;
    diag_fail(place,
              scene ? "this is no mistake of yours, and no such code is written or run: code for all scenes (gicrun "
                      "--general) does without it. Please report it with the files of model and scene and this message"
                    : "this is no mistake of yours, and no code is written or run; gicrun --engine gic does without "
                      "it. Please report it with the model file, those that it includes, and this message",
              "gicgen found an error of its own: %s: %s: at '%s' it is off by %.3g, of %.3g (state %d of the "
              "validation, gicgen " GICGEN_VERSION ")",
              kind[worst->kind].block, kind[worst->kind].text, worst->what, worst->value, worst->scale, worst->state);
}

/* f: for any scene. */
static Comparison *comparison_new(Pool *pool, const Formulation *f, const gic_road *road)
{
    const Model *model = f->model;
    Comparison *c = pool_alloc(pool, sizeof *c);
    const size_t number = sizeof(double);
    const int states = f->plan->states + model->fast_states;
    *c = (Comparison){.v = {.pool = pool, .model = model, .run = run_new(pool, f, road)},
                      .world = world_unsolved(pool, model, f->sequence),
                      .input = pool_alloc(pool, ((size_t)model->inputs + 1) * number),
                      .parameter = pool_alloc(pool, ((size_t)model->tunables + 1) * number),
                      .port = pool_alloc(pool, (6 * (size_t)model->ports + 1) * number),
                      .fast = pool_alloc(pool, ((size_t)model->fast_states + 1) * number),
                      .out = pool_alloc(pool, ((size_t)model->output_components + 1) * number),
                      .state_name = pool_alloc(pool, ((size_t)states + 1) * sizeof *c->state_name),
                      .acc = pool_alloc(pool, ((size_t)f->plan->unknowns + 1) * sizeof *c->acc),
                      .twist = pool_alloc(pool, (size_t)model->bodies * sizeof *c->twist)};
    for (int i = 0; i < states; ++i)
        c->state_name[i] = state_number(pool, f, i).name;
    for (int i = 0; i < model->outputs; ++i)
        if (output_reads(model, &model->output[i], OUTPUT_REACTION) && !c->world->solver && !model_massless(model))
            world_set_solver(pool, c->world, &topology_solver);
    return c;
}

/* Copy the columns of a scene's run from the run for any scene. */
static void copy_state(const Run *from, Run *to)
{
    const Model *model = from->model;
    const size_t row = sizeof(Values);
    memcpy(to->y, from->y, row * (size_t)(from->plan->states + model->fast_states));
    memcpy(to->u, from->u, row * (size_t)model->inputs);
    memcpy(to->p, from->p, row * (size_t)model->tunables);
    memcpy(to->port, from->port, row * 6 * (size_t)model->ports);
    memcpy(to->gear, from->gear, row * POWERTRAIN_DISCRETE);
    memcpy(to->time, from->time, row);
}

static void compare_column(Comparison *c)
{
    const Run *run = c->v.run;
    if (run->refused[c->k]) {
        if (c->index == 0 && run->refused[c->k] == run_lost)
            compare(c, KIND_POSE, run->where[c->k], 1, 1);
        ++c->left;
        c->refused = c->refused ? c->refused : run->refused[c->k];
        c->where = c->where ? c->where : run->where[c->k];
        return;
    }
    ++c->compared;
    if (!compare_state(c))
        return;
    if (c->scene && !c->scene->refused[c->k])
        compare_scene(c);
    else if (c->scene && c->index == 0)
        compare(c, KIND_SCENE, c->scene->where[c->k], 1, 1);
}

/* A wavy, slightly slippery road for models without a scene. */
static const gic_road *any_road(Pool *pool)
{
    gic_road_sine *waves = pool_alloc(pool, sizeof *waves);
    gic_road_patched *road = pool_alloc(pool, sizeof *road);
    *waves = (gic_road_sine){{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.05, 3, 0.3, 0.7};
    *road = (gic_road_patched){
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &waves->head,
        0.8,
        NULL,
        0};
    return &road->head;
}

/* Accelerations for the self-test's equations: the computed ones and others. */
static void choose_accelerations(Comparison *c)
{
    const Run *run = c->v.run;
    const Plan *plan = run->plan;
    const int twist = 7 + plan->free_coordinates;
    Random random = {.state = 3};
    for (int k = 0; k < STATES; ++k) {
        for (int i = 0; c->v.model->free_base && i < 3; ++i) {
            c->acc[i][k] = run->rate[twist + 3 + i][k] + random_uniform(&random, -1, 1);
            c->acc[3 + i][k] = random_uniform(&random, -10, 10);
        }
        for (int j = 0; j < c->v.model->coordinates; ++j)
            if (plan->coordinate_unknown[j] >= 0)
                c->acc[plan->coordinate_unknown[j]][k] =
                    run->rate[plan->coordinate_rate[j]][k] + random_uniform(&random, -1, 1);
    }
}

/* A correction must be much smaller than the one before it, and the first one of second order in the move: with 1e-4
 * its square's square is 1e-16. Compared at the design, since corrections shrink slowly near singular configurations.
 */
static void compare_corrections(void *context, int subset, Values size[3])
{
    Comparison *c = context;
    const Sequence *sequence = c->v.run->plan->sequence;
    const char *name = sequence->class[sequence->subset[subset].class].name;
    const double rounding[3] = {0, 1e-10, 1e-24};
    c->index = 0;
    for (int i = 1; i < 3 && !c->v.run->refused[0]; ++i)
        compare(c, KIND_FOLLOW, name, size[i][0], size[i - 1][0] + rounding[i]);
}

/* Coordinates that are constant in a scene: driven ones with constant inputs, and antisymmetric ones if both sides are
 * alike. */
static void find_held(const Comparison *c, bool *held)
{
    const Model *model = c->v.model;
    for (int i = 0; i < model->coordinates; ++i) {
        const bool odd = c->v.mirror && c->v.mirror->coordinate[i] == i && c->v.mirror->sign[i] < 0;
        held[i] = odd || (model->coordinate[i].driven && c->v.facts && c->v.facts->fixed[model->coordinate[i].input]);
    }
}

static void compare_columns(Comparison *c, int first)
{
    Run *run = c->v.run;
    bool held[c->v.model->coordinates + 1];
    find_held(c, held);
    for (int k = 0; k < STATES; ++k)
        state_place(&c->v, first + k, k);
    run_evaluate(run);
    c->self_test = first == 0;
    if (c->self_test) {
        choose_accelerations(c);
        run_inverse(run, c->acc);
    }
    if (c->scene) {
        copy_state(run, c->scene);
        run_evaluate(c->scene);
        if (c->self_test)
            run_inverse(c->scene, c->acc);
    }
    for (c->k = 0; c->k < STATES; ++c->k) {
        c->index = first + c->k;
        compare_column(c);
    }
    if (c->self_test)
        run_follow(run, held, compare_corrections, c);
    if (c->self_test && c->scene)
        run_follow(c->scene, held, compare_corrections, c);
}

/* ---- other values of geometric parameters */

/* Set the model's numbers for these parameters. False: they are impossible. */
static bool tune(const Model *model, const double *parameter)
{
    const Tuning *tuning = model->tuning;
    Dag *dag = tuning->dag;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *own = &model->parameter[i];
        if (own->tunable)
            ex_set_sample(dag, ex_input(dag, element_at(ARRAY_p, own->index), &own->value), 0, parameter[own->index]);
    }
    dag_evaluate(dag, 0, 1);
    for (int i = 0; i < tuning->conditions; ++i) {
        const double value = ex_value(dag, tuning->condition[i].value, 0);
        if (!(tuning->condition[i].zero ? value >= 0 : value > 0))
            return false;
    }
    for (int i = 0; i < tuning->numbers; ++i) {
        const double value = ex_value(dag, tuning->number[i].formula, 0);
        if (!isfinite(value))
            return false;
        *(double *)tuning->number[i].at = value;
    }
    return true;
}

/* Compare with the model's numbers for other parameters. */
static void compare_tuned(Comparison *c)
{
    const Model *model = c->v.model;
    const Tuning *tuning = model->tuning;
    if (!tuning)
        return;
    Random random = {.state = 5};
    const size_t size = sizeof(double), numbers = (size_t)tuning->numbers + 1, tunables = (size_t)model->tunables + 1;
    double *was = pool_alloc(c->v.pool, numbers * size), *changed = pool_alloc(c->v.pool, tunables * size);
    const Ex rest = ex_input(tuning->dag, element_at(ARRAY_rest, 0), &(const double){0});
    const size_t values = (size_t)tuning->dag->nodes * (size_t)tuning->dag->samples * size;
    double *value = memcpy(pool_alloc(c->v.pool, values), tuning->dag->value, values);
    for (int i = 0; i < tuning->numbers; ++i)
        was[i] = *tuning->number[i].at;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *own = &model->parameter[i];
        const double share = 0.003 * random_uniform(&random, -1, 1);
        if (own->tunable)
            changed[own->index] = own->geometric ? own->value + share * (own->value == 0 ? 1 : own->value) : own->value;
    }
    ex_set_sample(tuning->dag, rest, 0, 0);
    if (tune(model, changed)) {
        world_adopt(c->world);
        c->v.geometry = changed;
        compare_columns(c, STATES);
        c->v.geometry = NULL;
    }
    memcpy(tuning->dag->value, value, values);
    for (int i = 0; i < tuning->numbers; ++i)
        *(double *)tuning->number[i].at = was[i];
    world_adopt(c->world);
}

void formulation_validate(Pool *pool, const Formulation *f, const Validation *scene)
{
    const Formulation *general = f->general ? f->general : f;
    const int most = 96, states = 32 + 2 * f->model->coordinates;
    const int count = (states > most ? most : states + STATES - 1) / STATES * STATES;
    const char *why;
    Comparison *c = comparison_new(pool, general, f->general && scene ? scene->road : any_road(pool));
    if (f->general && scene) {
        c->scene = run_new(pool, f, scene->road);
        c->v.scene = scene;
        c->v.facts = f->narrowing->facts;
        c->v.mirror = f->narrowing->image ? mirror_find(pool, f->model, &why) : NULL;
    }
    kinks_find(&c->v);
    for (int first = 0; first < count; first += STATES)
        compare_columns(c, first);
    if (!c->scene)
        compare_tuned(c);
    say(c);
}
