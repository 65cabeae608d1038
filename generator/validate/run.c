/* SPDX-License-Identifier: MIT
 * Calls the blocks of a formulation as the templates do: recovery subset by subset, wheels, accelerations,
 * reactions, outputs. Poses are found from the design by Newton's iteration with new factors at each correction;
 * the way to a pose does not matter, since the result is checked. */
#include "base/random.h"
#include "base/table.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "validate/play.h"
#include "validate/run.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

#include <math.h>
#include <string.h>

/* Most corrections at the end of a way, and most pieces of a way. */
enum { CORRECTIONS = 10, PIECES = 48 };
/* Length of a piece in pieces of generated code; square of a correction that counts as zero, and of one after which
 * poses are right to rounding, since the next one is its square. */
static const double longer = 4, settled = 1e-24, enough = 1e-15;

typedef struct ClassPrograms {
    const Program *solve, *residual, *react, *predict, *chord;
} ClassPrograms;

typedef struct WheelPrograms {
    const Program *contact, *tire, *balance;
} WheelPrograms;

struct RunPrograms {
    ClassPrograms *class;
    WheelPrograms *wheel;
    const Program *dynamics, *outputs, *poses, *inverse, *wrenches, *link, *torque, *drive, *shift, *derive, *energy;
    int rows; /* largest number of rows of a frame */
    int arrays;
    Binding *array; /* arrays of the block that is evaluated */
    Values *q;      /* poses of all bodies, 7 a body */
    Values *own;    /* of a subset's bodies */
    Values *design; /* the same at the design */
    Values *x, *rate, *at, *contact, *force;
    Values turn[3], ahead, step, rest;
};

const char run_lost[] = "corrections that do not end";

static Values *rows(Pool *pool, int count)
{
    return pool_alloc(pool, ((size_t)count + 1) * sizeof(Values));
}

/* ---- what is known beforehand -------------------------------------------------------------------------------------
 */

static const Program *record(Run *run, const Block *block)
{
    const Program *program = play_record(run->pool, block, run->formulation->known_most);
    if (play_rows(program) > run->programs->rows)
        run->programs->rows = play_rows(program);
    return program;
}

/* Find the numbers of motions that no block stores because they are constant. Blocks do not read them from memory. */
static void find_constants(Run *run)
{
    const Plan *plan = run->plan;
    for (int i = 0; i < plan->motion_size; ++i)
        run->settled[i] = NAN;
    for (int b = 1; b < run->model->bodies; ++b) {
        const int s = plan->sequence->body_subset[b];
        const Subset *subset = &plan->sequence->subset[s];
        const Formula *formula = plan->formula[subset->class];
        const int member = class_place(&plan->sequence->class[subset->class], s);
        for (int i = 0; i < formula->layout.motion_size; ++i) {
            const Ex found = *motion_number(&formula->motion[subset_place(subset, b)], i);
            if (formula_is_constant(formula, found))
                run->settled[plan->motion_offset[b] + plan->stride[s] * i] = formula_value(formula, found, member);
        }
    }
}

/* Poses of the bodies in the assembled model, where recovery starts: reference points and Euler parameters, relative to
 * the body that a subset is solved in the frame of. */
static void find_design(Run *run)
{
    const Sequence *sequence = run->plan->sequence;
    for (int b = 0; b < run->model->bodies; ++b) {
        const int s = sequence->body_subset[b];
        const bool solved = b != BODY_BASE && sequence->subset[s].class >= 0;
        double q[7];
        sampling_design(run->formulation->sampling, run->model, run->plan->origin,
                        solved ? subset_anchor(run->model, sequence, s) : BODY_BASE, b, q);
        for (int i = 0; i < 7; ++i)
            for (int k = 0; k < STATES; ++k)
                run->programs->design[7 * b + i][k] = q[i];
    }
}

static void record_all(Run *run)
{
    const Formulation *f = run->formulation;
    struct RunPrograms *programs = run->programs;
    programs->class = pool_alloc(run->pool, ((size_t)f->sequence->classes + 1) * sizeof *programs->class);
    for (int c = 0; c < f->sequence->classes; ++c) {
        const Formula *formula = f->plan->formula[c];
        programs->class[c] = (ClassPrograms){record(run, &formula->solve), record(run, &formula->residual),
                                             run->reacts ? record(run, &formula->react) : NULL,
                                             record(run, &formula->predict), record(run, &formula->chord)};
    }
    programs->dynamics = record(run, f->dynamics);
    programs->outputs = record(run, f->outputs);
    programs->poses = record(run, f->poses);
    programs->inverse = record(run, f->inverse);
    programs->energy = record(run, f->energy);
    if (run->reacts)
        programs->wrenches = record(run, f->wrenches);
    if (f->model->tuning)
        programs->derive = record(run, derive_block(run->pool, f->plan));
    if (!f->wheels)
        return;
    programs->wheel = pool_alloc(run->pool, ((size_t)f->wheels->classes + 1) * sizeof *programs->wheel);
    for (int c = 0; c < f->wheels->classes; ++c) {
        const WheelClass *class = &f->wheels->class[c];
        programs->wheel[c] =
            (WheelPrograms){record(run, &class->contact), record(run, &class->tire), record(run, &class->balance)};
    }
    programs->link = record(run, &f->wheels->link);
    programs->torque = record(run, &f->wheels->torque);
    if (f->model->powertrain)
        programs->drive = record(run, &f->wheels->drive);
    if (f->model->powertrain)
        programs->shift = record(run, &f->wheels->shift);
}

Run *run_new(Pool *pool, const Formulation *f, const gic_road *road)
{
    const Model *model = f->model;
    const Plan *plan = f->plan;
    const int bodies = model->bodies, states = plan->states + model->fast_states;
    Run *run = pool_alloc(pool, sizeof *run);
    *run = (Run){.pool = pool,
                 .formulation = f,
                 .plan = plan,
                 .model = model,
                 .reacts = f->wrenches && plan->multipliers ? reactions_needed(pool, model, f->sequence) : NULL,
                 .y = rows(pool, states),
                 .u = rows(pool, model->inputs),
                 .p = rows(pool, model->tunables),
                 .port = rows(pool, 6 * model->ports),
                 .gear = rows(pool, POWERTRAIN_DISCRETE),
                 .x = rows(pool, model->coordinates),
                 .xd = rows(pool, model->coordinates),
                 .e = rows(pool, 4),
                 .m = rows(pool, plan->motion_size),
                 .n = rows(pool, plan->inertia_size),
                 .start = rows(pool, plan->start_size),
                 .lambda = rows(pool, plan->multipliers + 6),
                 .link = rows(pool, f->wheels ? f->wheels->links : 0),
                 .grip = rows(pool, f->wheels ? GRIP_NUMBERS * f->wheels->count : 0),
                 .watch = rows(pool, WATCH_NUMBERS),
                 .torque = rows(pool, f->wheels ? 2 * f->wheels->count : 0),
                 .rate = rows(pool, states),
                 .out = rows(pool, model->output_components),
                 .pose = rows(pool, 7 * bodies),
                 .tau = rows(pool, plan->unknowns),
                 .energy = rows(pool, 3),
                 .acc = rows(pool, plan->unknowns),
                 .choice = rows(pool, model->powertrain ? 2 * model->powertrain->forward : 0),
                 .settled = pool_alloc(pool, ((size_t)plan->motion_size + 1) * sizeof(double))};
    struct RunPrograms *programs = run->programs = pool_alloc(pool, sizeof *programs);
    programs->arrays = PLAY_KNOWN + 2 * f->known_most;
    programs->array = pool_alloc(pool, (size_t)programs->arrays * sizeof *programs->array);
    programs->q = rows(pool, 7 * bodies);
    programs->own = rows(pool, 7 * bodies);
    programs->design = rows(pool, 7 * bodies);
    programs->x = rows(pool, f->dependence_most);
    programs->rate = rows(pool, f->dependence_most);
    programs->at = rows(pool, model->coordinates);
    programs->contact = rows(pool, CONTACT_NUMBERS);
    programs->force = rows(pool, TIRE_FORCES);
    gic_table *table = pool_alloc(pool, ((size_t)model->tables + 1) * sizeof *table);
    for (int i = 0; i < model->tables; ++i) {
        const Table *own = &model->table[i];
        table[i] = (gic_table){own->x, own->y, own->slope, own->count, own->cubic, own->onward};
    }
    run->scenery = (Scenery){.table = table, .road = road, .time = run->time};
    record_all(run);
    run->derived = rows(pool, plan->derived->count);
    run->frame = rows(pool, programs->rows);
    if (!f->general)
        find_constants(run);
    find_design(run);
    return run;
}

double run_motion(const Run *run, int body, int number, int state)
{
    const int s = run->plan->sequence->body_subset[body];
    const int place = run->plan->motion_offset[body] + run->plan->stride[s] * number;
    return isnan(run->settled[place]) ? run->m[place][state] : run->settled[place];
}

/* ---- playing --------------------------------------------------------------------------------------------------------
 */

static void bind(Run *run, int array, Values *row)
{
    run->programs->array[array] = (Binding){row, 1};
}

static void run_play(Run *run, const Program *program, int member, const char *what)
{
    play(program, member, run->programs->array, &run->scenery, run->frame);
    for (int k = 0; k < STATES; ++k)
        if (run->scenery.refused[k] && !run->refused[k]) {
            run->refused[k] = run->scenery.refused[k];
            run->where[k] = what;
        }
}

/* Bind the arrays of blocks about the whole vehicle. */
static void bind_whole(Run *run)
{
    struct RunPrograms *programs = run->programs;
    bind(run, PLAY_time, &run->time);
    bind(run, PLAY_y, run->y);
    bind(run, PLAY_e, run->e);
    bind(run, PLAY_x, run->x);
    bind(run, PLAY_xd, run->xd);
    bind(run, PLAY_u, run->u);
    bind(run, PLAY_m, run->m);
    bind(run, PLAY_n, run->n);
    bind(run, PLAY_p, run->p);
    bind(run, PLAY_port, run->port);
    bind(run, PLAY_rate, run->rate);
    bind(run, PLAY_acc, run->acc);
    bind(run, PLAY_out, run->out);
    bind(run, PLAY_pose, run->pose);
    bind(run, PLAY_tau, run->tau);
    bind(run, PLAY_energy, run->energy);
    bind(run, PLAY_choice, run->choice);
    bind(run, PLAY_lambda, run->lambda);
    bind(run, PLAY_link, run->link);
    bind(run, PLAY_DERIVED, run->derived);
    bind(run, PLAY_GRIP, run->grip);
    bind(run, PLAY_WATCH, run->watch);
    bind(run, PLAY_rest, &programs->rest);
}

/* ---- recovery -------------------------------------------------------------------------------------------------------
 */

static void bind_subset(Run *run, int s)
{
    const Plan *plan = run->plan;
    const Subset *subset = &plan->sequence->subset[s];
    struct RunPrograms *programs = run->programs;
    bind(run, PLAY_x, programs->x);
    bind(run, PLAY_rate, programs->rate);
    bind(run, PLAY_turn, programs->turn);
    bind(run, PLAY_ahead, &programs->ahead);
    bind(run, PLAY_step, &programs->step);
    bind(run, PLAY_d, run->derived + plan->derived_offset[s]);
    programs->array[PLAY_start] = (Binding){run->start + plan->start_offset[s], plan->stride[s]};
    programs->array[PLAY_motion] = (Binding){run->m + plan->motion_offset[subset->body[0]], plan->stride[s]};
    programs->array[PLAY_inertia] = (Binding){run->n + plan->inertia_offset[s], plan->stride[s]};
    for (int i = 0; i < subset->knowns; ++i) {
        const int body = subset->known[i];
        programs->array[PLAY_KNOWN + i] =
            (Binding){run->m + plan->motion_offset[body], plan->stride[plan->sequence->body_subset[body]]};
    }
    for (int j = 0; j < subset->deps; ++j) {
        memcpy(programs->x[j], programs->at[subset->dep[j]], sizeof(Values));
        memcpy(programs->rate[j], run->xd[subset->dep[j]], sizeof(Values));
    }
}

static double largest(const Run *run, const Values row)
{
    double most = 0;
    for (int k = 0; k < STATES; ++k)
        if (!run->refused[k] && !(row[k] <= most))
            most = row[k];
    return most;
}

static const char not_finite[] = "numbers that are not finite";

/* States in which the motion of a subset has numbers that are not finite, as those of a coupler whose formula has no
 * value there, are refused: generated code ends in a status there, too. */
static void refuse_infinite(Run *run, const Subset *subset, const char *what)
{
    for (int k = 0; k < STATES; ++k)
        for (int b = 0; b < subset->bodies && !run->refused[k]; ++b)
            for (int i = 0; i < MOTION_S && !run->refused[k]; ++i)
                if (!isfinite(run_motion(run, subset->body[b], i, k))) {
                    run->refused[k] = not_finite;
                    run->where[k] = what;
                }
}

/* Solve one subset at programs->at. */
static void solve_subset(Run *run, int s, bool last)
{
    const Plan *plan = run->plan;
    const Subset *subset = &plan->sequence->subset[s];
    struct RunPrograms *programs = run->programs;
    const Formula *formula = plan->formula[subset->class];
    const Program *solve = programs->class[subset->class].solve;
    const int member = class_place(&plan->sequence->class[subset->class], s);
    const char *name = plan->sequence->class[subset->class].name;
    bind_subset(run, s);
    if (formula->closed) {
        run_play(run, solve, member, name);
        refuse_infinite(run, subset, name);
        return;
    }
    Values *q = programs->own;
    for (int b = 0; b < subset->bodies; ++b)
        memcpy(q + 7 * b, programs->q + 7 * subset->body[b], 7 * sizeof(Values));
    bind(run, PLAY_q, q);
    for (int i = 0; i < (last ? CORRECTIONS : 2); ++i) {
        run_play(run, solve, member, name);
        if (largest(run, programs->step) <= settled)
            break;
    }
    for (int k = 0; k < STATES && last; ++k)
        if (!(programs->step[k] <= enough) && !run->refused[k]) {
            run->refused[k] = run_lost;
            run->where[k] = name;
        }
    for (int b = 0; b < subset->bodies; ++b)
        memcpy(programs->q + 7 * subset->body[b], q + 7 * b, 7 * sizeof(Values));
}

static void find_residual(Run *run)
{
    const Sequence *sequence = run->plan->sequence;
    Values worst[2] = {{0}};
    memset(run->residual, 0, sizeof run->residual);
    for (int s = 0; s < sequence->subsets; ++s) {
        const int class = sequence->subset[s].class;
        if (class < 0 || narrowing_image(run->formulation->narrowing, s))
            continue;
        bind_subset(run, s);
        bind(run, PLAY_worst, worst);
        play(run->programs->class[class].residual, class_place(&sequence->class[class], s), run->programs->array,
             &run->scenery, run->frame);
        for (int k = 0; k < STATES; ++k)
            run->residual[k] = fmax(run->residual[k], fmax(worst[0][k], worst[1][k]));
    }
}

static int pieces_of_way(const Run *run)
{
    double most = 1;
    for (int c = 0; c < run->model->coordinates; ++c)
        for (int k = 0; k < STATES; ++k)
            most = fmax(most, fabs(run->x[c][k] - run->model->coordinate[c].design) /
                                  (longer * coordinate_piece(run->formulation, c)));
    return (int)fmin(ceil(most), PIECES);
}

static void recover(Run *run)
{
    struct RunPrograms *programs = run->programs;
    const int twist = 7 + run->plan->free_coordinates, pieces = pieces_of_way(run);
    if (run->model->free_base)
        memcpy(programs->turn, run->y + twist + 3, sizeof programs->turn);
    memcpy(programs->q, programs->design, 7 * (size_t)run->model->bodies * sizeof(Values));
    for (int piece = 1; piece <= pieces; ++piece) {
        for (int c = 0; c < run->model->coordinates; ++c)
            for (int k = 0; k < STATES; ++k) {
                const double from = run->model->coordinate[c].design, to = run->x[c][k];
                programs->at[c][k] = piece == pieces ? to : from + (to - from) * piece / pieces;
            }
        for (int s = 0; s < run->plan->sequence->subsets; ++s)
            if (run->plan->sequence->subset[s].class >= 0 && !narrowing_image(run->formulation->narrowing, s))
                solve_subset(run, s, piece == pieces);
    }
    find_residual(run);
}

/* ---- wheels with tires */

static void play_wheel(Run *run, int class, int member, int wheel)
{
    const int place = wheel_rolling(run->model, wheel), fast = run->plan->states + run->model->wheel[wheel].fast;
    const WheelPrograms *programs = &run->programs->wheel[class];
    const char *const name = run->model->wheel[wheel].name;
    Values *contact = run->programs->contact, *force = run->programs->force;
    bind(run, PLAY_link, run->link + LINK_NUMBERS * place);
    bind(run, PLAY_fast, run->y + fast);
    bind(run, PLAY_torque, run->torque + 2 * place);
    bind(run, PLAY_rate, run->rate + fast);
    bind(run, PLAY_grip, run->grip + GRIP_NUMBERS * place);
    bind(run, PLAY_contact, contact);
    bind(run, PLAY_force, force);
    memset(force, 0, TIRE_FORCES * sizeof(Values));
    run_play(run, programs->contact, member, name);
    const Scenery before = run->scenery;
    play(programs->tire, member, run->programs->array, &run->scenery, run->frame);
    for (int k = 0; k < STATES; ++k)
        if (!(contact[CONTACT_LOAD][k] > 0)) { /* without contact the tire forces are zero */
            run->scenery.refused[k] = before.refused[k];
            for (int i = 0; i < TIRE_FORCES; ++i)
                force[i][k] = 0;
        }
    run_play(run, programs->balance, member, name);
}

static void engage(const Run *run, Values gear[GEAR_NUMBERS])
{
    const Powertrain *powertrain = run->model->powertrain;
    for (int k = 0; k < STATES; ++k) {
        gear[GEAR_NUMBER][k] = run->gear[0][k];
        for (int i = 0; i < 2; ++i) {
            const int own = (int)run->gear[i][k];
            gear[GEAR_RATIO + i][k] = powertrain->gear[powertrain->reverse + own];
            gear[GEAR_ENGAGED + i][k] = own ? 1 : 0;
        }
    }
}

static void mirror_row(Values *row, int at, int of, double sign)
{
    for (int k = 0; k < STATES; ++k)
        row[at][k] = sign * row[of][k];
}

/* Copy the results of the wheel on the other side, as generated code does. */
static void mirror_wheel(Run *run, int wheel, int leader)
{
    const Wheel *own = &run->model->wheel[wheel], *other = &run->model->wheel[leader];
    const int at = GRIP_NUMBERS * wheel_rolling(run->model, wheel),
              of = GRIP_NUMBERS * wheel_rolling(run->model, leader);
    for (int i = 0; i < wheel_fast_states(own); ++i)
        mirror_row(run->rate + run->plan->states, own->fast + i, other->fast + i, wheel_fast_sign(i));
    for (int i = 0; i < GRIP_NUMBERS; ++i)
        if (i != GRIP_POINT + 1)
            mirror_row(run->grip, at + i, of + i, wheel_grip_sign(i));
    Values *a = &run->link[LINK_NUMBERS * wheel_rolling(run->model, wheel) + LINK_C + 1];
    Values *b = &run->link[LINK_NUMBERS * wheel_rolling(run->model, leader) + LINK_C + 1];
    for (int k = 0; k < STATES; ++k)
        run->grip[at + GRIP_POINT + 1][k] = (*a)[k] + (*b)[k] - run->grip[of + GRIP_POINT + 1][k];
}

static void turn_wheels(Run *run)
{
    const Wheels *wheels = run->formulation->wheels;
    Values gear[GEAR_NUMBERS];
    run_play(run, run->programs->link, 0, "links of wheels");
    bind(run, PLAY_fast, run->y + run->plan->states);
    bind(run, PLAY_torque, run->torque);
    bind(run, PLAY_rate, run->rate + run->plan->states);
    run_play(run, run->programs->torque, 0, "torques of wheels");
    for (int c = 0; c < wheels->classes; ++c)
        for (int i = 0; i < wheels->class[c].members; ++i)
            if (!narrowing_wheel_image(run->formulation->narrowing, wheels->class[c].member[i]))
                play_wheel(run, c, i, wheels->class[c].member[i]);
    if (run->programs->drive) {
        engage(run, gear);
        bind(run, PLAY_link, run->link);
        bind(run, PLAY_fast, run->y + run->plan->states);
        bind(run, PLAY_rate, run->rate + run->plan->states);
        bind(run, PLAY_grip, run->grip);
        bind(run, PLAY_watch, run->watch);
        bind(run, PLAY_gear, gear);
        run_play(run, run->programs->drive, 0, "powertrain");
        run_play(run, run->programs->shift, 0, "choice of gears");
    }
    for (int w = 0; w < run->model->wheels; ++w)
        if (narrowing_wheel_image(run->formulation->narrowing, w))
            mirror_wheel(run, w, run->formulation->narrowing->wheel[w]);
    bind_whole(run);
}

/* ---- reactions ------------------------------------------------------------------------------------------------------
 */

/* Multipliers in reverse computational order; the load on bodies of earlier subsets is subtracted from their wrenches.
 */
static void react(Run *run)
{
    const Plan *plan = run->plan;
    const Sequence *sequence = plan->sequence;
    const int onto = PLAY_KNOWN + run->formulation->known_most;
    Values spare[6] = {{0}};
    for (int s = sequence->subsets - 1; s >= 0; --s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || !run->reacts[s])
            continue;
        bind_subset(run, s);
        bind(run, PLAY_w, run->lambda + plan->multiplier_offset[subset->body[0]]);
        const Layout *layout = &plan->formula[subset->class]->layout;
        run->programs->array[PLAY_f] =
            (Binding){run->start + plan->start_offset[s] + plan->stride[s] * layout->start_factors, plan->stride[s]};
        for (int i = 0; i < subset->knowns; ++i) {
            const int body = subset->known[i];
            bind(run, onto + i,
                 run->reacts[sequence->body_subset[body]] ? run->lambda + plan->multiplier_offset[body] : spare);
        }
        run_play(run, run->programs->class[subset->class].react, class_place(&sequence->class[subset->class], s),
                 "reactions");
    }
}

/* ---- all of it ------------------------------------------------------------------------------------------------------
 */

/* Coordinates from the state if free, from the inputs if driven. */
static void gather(Run *run)
{
    for (int w = 0; w < run->model->coordinates; ++w) {
        const Coordinate *c = &run->model->coordinate[w];
        memcpy(run->x[w], c->driven ? run->u[c->input] : run->y[run->plan->coordinate_state[w]], sizeof(Values));
        memcpy(run->xd[w], c->driven ? run->u[c->input + 1] : run->y[run->plan->coordinate_rate[w]], sizeof(Values));
    }
    memset(run->e, 0, 4 * sizeof(Values));
    for (int k = 0; k < STATES; ++k)
        run->e[0][k] = 1;
    if (run->model->free_base)
        memcpy(run->e, run->y + 3, 4 * sizeof(Values));
}

/* Overwrite rows with NAN, so that a read of a number that was not stored shows. */
static void forget(Values *row, int count)
{
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < STATES; ++k)
            row[i][k] = NAN;
}

static void forget_all(Run *run)
{
    const Formulation *f = run->formulation;
    forget(run->m, run->plan->motion_size);
    forget(run->n, run->plan->inertia_size);
    forget(run->start, run->plan->start_size);
    forget(run->lambda, run->plan->multipliers);
    forget(run->rate, run->plan->states + run->model->fast_states);
    forget(run->out, run->model->output_components);
    forget(run->pose, 7 * run->model->bodies);
    if (f->wheels) {
        forget(run->link, f->wheels->links);
        forget(run->grip, GRIP_NUMBERS * f->wheels->count);
        forget(run->torque, 2 * f->wheels->count);
        forget(run->watch, WATCH_NUMBERS);
    }
}

void run_evaluate(Run *run)
{
    forget_all(run);
    memset(run->scenery.refused, 0, sizeof run->scenery.refused);
    memset(run->refused, 0, sizeof run->refused);
    memset(run->programs->ahead, 0, sizeof run->programs->ahead);
    gather(run);
    bind_whole(run);
    if (run->programs->derive)
        run_play(run, run->programs->derive, 0, "numbers that follow parameters");
    recover(run);
    bind_whole(run);
    if (run->programs->link)
        turn_wheels(run);
    run_play(run, run->programs->dynamics, 0, "dynamics");
    if (run->reacts) {
        run_play(run, run->programs->wrenches, 0, "reactions");
        react(run);
        bind_whole(run);
    }
    run_play(run, run->programs->outputs, 0, "outputs");
    run_play(run, run->programs->poses, 0, "poses");
    run_play(run, run->programs->energy, 0, "energy");
}

void run_inverse(Run *run, Values *acc)
{
    bind_whole(run);
    bind(run, PLAY_acc, acc);
    run_play(run, run->programs->inverse, 0, "inverse");
}

/* ---- from one configuration to the next -----------------------------------------------------------------------------
 */

/* `change` of all coordinates, relative to the largest change in one piece. */
static void make_changes(Run *run, const bool *held, Values *change)
{
    const double share = 0.001;
    Random random = {.state = 1};
    for (int c = 0; c < run->model->coordinates; ++c)
        for (int k = 0; k < STATES; ++k) {
            const double part = share * random_uniform(&random, -1, 1);
            change[c][k] = held[c] ? 0 : part * coordinate_piece(run->formulation, c);
            run->programs->at[c][k] = run->x[c][k] + change[c][k];
        }
}

void run_follow(Run *run, const bool *held, void (*found)(void *context, int subset, Values size[3]), void *context)
{
    const Plan *plan = run->plan;
    const Sequence *sequence = plan->sequence;
    struct RunPrograms *programs = run->programs;
    Values *old = rows(run->pool, plan->start_size), *change = rows(run->pool, run->model->coordinates);
    Values *own = rows(run->pool, run->formulation->dependence_most), size[3] = {{0}};
    memcpy(old, run->start, (size_t)plan->start_size * sizeof *old);
    make_changes(run, held, change);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0 || narrowing_image(run->formulation->narrowing, s))
            continue;
        if (plan->formula[subset->class]->closed) {
            solve_subset(run, s, true);
            continue;
        }
        const Layout *layout = &plan->formula[subset->class]->layout;
        const ClassPrograms *class = &programs->class[subset->class];
        const int member = class_place(&sequence->class[subset->class], s), stride = plan->stride[s];
        bind_subset(run, s);
        for (int j = 0; j < subset->deps; ++j)
            memcpy(own[j], change[subset->dep[j]], sizeof *own);
        for (int b = 0; b < subset->bodies; ++b)
            memcpy(programs->own + 7 * b, programs->q + 7 * subset->body[b], 7 * sizeof(Values));
        bind(run, PLAY_change, own);
        bind(run, PLAY_q, programs->own);
        bind(run, PLAY_reach, &size[0]);
        programs->array[PLAY_s] = (Binding){old + plan->start_offset[s] + stride * layout->start_S, stride};
        programs->array[PLAY_f] = (Binding){old + plan->start_offset[s] + stride * layout->start_factors, stride};
        run_play(run, class->predict, member, "prediction");
        for (int i = 1; i < 3; ++i) {
            bind(run, PLAY_step, &size[i]);
            run_play(run, class->chord, member, "corrections");
        }
        found(context, s, size);
        for (int b = 0; b < subset->bodies; ++b)
            memcpy(programs->q + 7 * subset->body[b], programs->own + 7 * b, 7 * sizeof(Values));
        solve_subset(run, s, true);
    }
}
