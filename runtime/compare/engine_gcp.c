/* SPDX-License-Identifier: MIT
 * Engines gcp1 and gcp2: generalized coordinate partitioning (Wehage and Haug 1982), what Serban and Haug 2000 compare
 * their method with. Independent coordinates are picked from q numerically (partition.h), all dependent ones are
 * recovered together by Newton on the whole of Phi, and picked anew when the dependent block degrades. gcp1 solves for
 * accelerations with the topology-based solver, gcp2 with MUMPS.
 *
 * The state is all of q and q'. Of it the right-hand side uses the independent ones; the dependent ones, integrated
 * along, are where Newton begins, so that it has little to do, and their rates' history is there when the choice
 * changes: no multistep history is lost. */
#include "base/message.h"
#include "base/random.h"
#include "compare/compare.h"
#include "compare/coupled.h"
#include "compare/interpreted.h"
#include "compare/partition.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "world/equations.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* Factors of Phi_u are kept from one evaluation to the next. Each instance in use has its own, so that calls on one
 * (the copy that computes outputs) do not change another (the run). */
enum { SHARES = 2 };

typedef struct Share {
    const Instance *owner;
    Partition *partition;
    int64_t used;
} Share;

typedef struct Gcp {
    const Engine *gic; /* recovers all bodies from a state in dual coordinates, to start from */
    Instance *start;
    Share share[SHARES];
    int64_t uses;
    Partition *partition;      /* of the instance that is being evaluated */
    const Instance *recovered; /* the instance whose Jacobian the World holds; NULL: none, because its recovery
                                * failed */
    int (*outputs)(void *self), (*poses)(void *self, double *pose);
    CoupledRows coupled; /* of gears and couplers */
    const double *near;  /* [coordinates] where the instance that is being evaluated has been */
    int columns;
    double *b; /* [rows of the partition] */
} Gcp;

/* Numbers that an instance keeps. */
typedef struct Memory {
    double *chosen;  /* [columns] of its partition */
    double *usual;   /* of its partition; 0: none, because set-up failed */
    double *shift;   /* [2 columns] from the integrated q, q' to the recovered ones at the start of a step */
    double *shifted; /* 1: shift is there */
    double *checks;  /* how often its partition was looked at */
    double *near;    /* [coordinates] last values: angles go on from there */
} Memory;

static Memory memory_of(const Interpreted *context, const Instance *self)
{
    const Gcp *gcp = context->engine;
    Memory memory = {.chosen = instance_own(self)};
    memory.usual = memory.chosen + gcp->columns;
    memory.shift = memory.usual + 1;
    memory.shifted = memory.shift + 2 * gcp->columns;
    memory.checks = memory.shifted + 1;
    memory.near = memory.checks + 1;
    return memory;
}

/* ---- the equations ---------------------------------------------------------------------------------------------- */

static int column_of(const World *world, int body)
{
    return BODY_Q * (body - world->first);
}

/* Phi_q at the World's configuration, of which the partition reads the numbers. */
static bool find_jacobian(const Gcp *gcp, World *world)
{
    bool right = true;
    coupled_rows_place(&gcp->coupled, world, gcp->near);
    for (int t = 0; t < world->constraints; ++t)
        right = world_rows(world, t) && right;
    coupled_rows_differentiate(&gcp->coupled, world);
    return right;
}

static bool refactor(const Gcp *gcp, World *world, EngineProfile *profile)
{
    Partition *partition = gcp->partition;
    ++profile->factorizations;
    find_jacobian(gcp, world);
    const double begun = profile_clock(profile);
    const bool good = partition_factor(partition);
    profile->recovery_solver += profile_clock(profile) - begun;
    return good;
}

/* Phi at the present q, followed by the normalizations (p^T p - 1) / 2. */
static void find_values(const Gcp *gcp, World *world, double *b)
{
    coupled_rows_place(&gcp->coupled, world, gcp->near);
    for (int t = 0; t < world->constraints; ++t)
        world_values(world, t);
    memcpy(b, world->value, sizeof *b * (size_t)world->constraint_rows);
    b += world->constraint_rows;
    for (int body = world->first; body < world->bodies; ++body) {
        const double *p = world->q[body] + 3;
        *b++ = 0.5 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3] - 1);
    }
}

/* Phi_q q' + Phi_t, with J of the present q. */
static void find_rates(const Gcp *gcp, World *world, double *b)
{
    coupled_rows_place(&gcp->coupled, world, gcp->near);
    for (int t = 0; t < world->constraints; ++t) {
        const Tie *tie = &world->tie[t];
        for (int r = 0; r < tie->rows; ++r)
            *b++ = world_product(world, t, r, (const double(*)[BODY_Q])world->qd);
        if (tie->law || tie->coordinate >= 0)
            b[-1] += world_dual(world, t, world->xd);
    }
    for (int body = world->first; body < world->bodies; ++body) {
        const double *p = world->q[body] + 3, *pd = world->qd[body] + 3;
        *b++ = p[0] * pd[0] + p[1] * pd[1] + p[2] * pd[2] + p[3] * pd[3];
    }
}

static void set_positions(World *world, const double *q)
{
    for (int body = world->first; body < world->bodies; ++body)
        world_set_q(world, body, q + column_of(world, body));
}

static void set_rates(World *world, const double *qd)
{
    for (int body = world->first; body < world->bodies; ++body)
        world_set_rate(world, body, qd + column_of(world, body));
}

/* Take b from the dependent ones among numbers [bodies][7] from the first moving body on; the largest part, positions
 * relative to the mechanism's size. */
static double correct(const World *world, const Partition *partition, const double *b, double *number)
{
    double largest = 0;
    for (int u = 0; u < partition->rows; ++u) {
        const int j = partition->dependent[u];
        const double part = fabs(b[u]) / (j % BODY_Q < 3 ? world->size : 1);
        number[j] -= b[u];
        if (!(part <= largest))
            largest = part; /* not a number stays one */
    }
    return largest;
}

static double solved(Partition *partition, EngineProfile *profile, const World *world, double *b, double *number)
{
    const double begun = profile_clock(profile);
    partition_solve(partition, b);
    profile->recovery_solver += profile_clock(profile) - begun;
    ++profile->newton;
    return correct(world, partition, b, number);
}

/* ---- recovery --------------------------------------------------------------------------------------------------- */

enum { CORRECTIONS = 16 };

static const double slow = 0.02; /* if a correction shrinks less, factorize anew: that costs about three corrections */
static const double leap = 0.5;  /* a larger one may lead to another assembly mode */
static const double rounding = 1e-14; /* relative to the mechanism's size */

/* Newton with old factors while they serve: all dependent coordinates from the independent ones, in world->q. */
static int recover_positions(const Interpreted *context, Instance *self)
{
    World *world = context->world;
    const Gcp *gcp = context->engine;
    double *q = world->q[world->first], before = INFINITY, far = 0;
    for (int body = world->first; body < world->bodies; ++body)
        for (int i = 0; i < 3; ++i)
            far = fmax(far, fabs(world->q[body][i]));
    const double enough = fmax(rounding, 4e-16 * far / world->size);
    for (int i = 0; i < CORRECTIONS; ++i) {
        find_values(gcp, world, gcp->b);
        const double step = solved(gcp->partition, context->profile, world, gcp->b, q);
        ++self->head.correction_count;
        if (!(step < leap))
            return GIC_ERROR_NEWTON;
        set_positions(world, q);
        /* what the next correction would be: known from two corrections with the same factors */
        const double ratio = step / before;
        if (step <= enough || (before < INFINITY && ratio < slow && step * ratio <= enough)) {
            ++self->head.newton_count;
            self->head.largest_step = fmax(self->head.largest_step, step * step);
            return GIC_OK;
        }
        if (ratio > slow || (!i && step > slow)) {
            if (!refactor(gcp, world, context->profile))
                return GIC_ERROR_SINGULAR;
            before = INFINITY;
        } else {
            before = step;
        }
    }
    return GIC_ERROR_NEWTON;
}

/* The same for velocities: linear, so that old factors only need repetition. J of the present q is there. */
static int recover_rates(const Interpreted *context)
{
    World *world = context->world;
    const Gcp *gcp = context->engine;
    double *qd = world->qd[world->first], before = INFINITY, scale = 1;
    for (int j = 0; j < gcp->columns; ++j)
        scale = fmax(scale, fabs(qd[j]) / (j % BODY_Q < 3 ? world->size : 1));
    for (int i = 0; i < CORRECTIONS; ++i) {
        find_rates(gcp, world, gcp->b);
        const double step = solved(gcp->partition, context->profile, world, gcp->b, qd) / scale;
        const double ratio = step / before;
        if (!(step < INFINITY))
            return GIC_ERROR_SINGULAR;
        if (step <= rounding || (i && ratio < slow && step * ratio <= rounding)) {
            set_rates(world, qd);
            return GIC_OK;
        }
        if (ratio > slow) {
            ++context->profile->factorizations;
            if (!partition_factor(gcp->partition))
                return GIC_ERROR_SINGULAR;
            before = INFINITY;
        } else {
            before = step;
        }
    }
    return GIC_ERROR_NEWTON;
}

/* Values and rates of driven coordinates. */
static void gather_driven(World *world)
{
    for (int c = 0; c < world->model->coordinates; ++c)
        if (world->model->coordinate[c].driven) {
            const double *input = world->input + world->model->coordinate[c].input;
            world->x[c] = input[0];
            world->xd[c] = input[1];
            world->xdd[c] = input[2];
        }
}

/* Values, rates and equations of the free coordinates, functions of q and q' here. */
static void find_coordinates(World *world, const Memory *memory)
{
    for (int c = 0; c < world->model->coordinates; ++c)
        if (!world->model->coordinate[c].driven) {
            double w[2];
            world_coordinate(world, c, memory->near[c], w);
            world->x[c] = w[0];
            world->xd[c] = w[1];
        }
}

/* The partition of this instance becomes the one in use. A share that changes hands forgets its factors. */
static void take_share(const Interpreted *context, const Instance *self)
{
    Gcp *gcp = context->engine;
    Share *share = gcp->share;
    for (int i = 0; i < SHARES; ++i)
        if (gcp->share[i].owner == self || (share->owner != self && gcp->share[i].used < share->used))
            share = &gcp->share[i];
    if (share->owner != self)
        partition_forget(share->partition);
    share->owner = self;
    share->used = ++gcp->uses;
    gcp->partition = share->partition;
}

static int use_partition(const Interpreted *context, const Instance *self, const Memory *memory)
{
    const Gcp *gcp = context->engine;
    take_share(context, self);
    Partition *partition = gcp->partition;
    if (*memory->usual == 0)
        return GIC_ERROR_SINGULAR;
    if (!memcmp(partition->chosen, memory->chosen, sizeof(double) * (size_t)gcp->columns))
        return GIC_OK;
    find_jacobian(gcp, context->world);
    return partition_adopt(partition, memory->chosen, *memory->usual) ? GIC_OK : GIC_ERROR_SINGULAR;
}

static int recover(const Interpreted *context, Instance *self, const Memory *memory, const double *state)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    Gcp *gcp = context->engine;
    const double begun = profile_clock(profile), solver = profile->recovery_solver;
    gcp->near = memory->near;
    set_positions(world, state);
    set_rates(world, state + gcp->columns);
    gather_driven(world);
    gcp->recovered = NULL;
    int status = use_partition(context, self, memory);
    if (status == GIC_OK)
        status = recover_positions(context, self);
    if (status == GIC_OK)
        status = find_jacobian(gcp, world) ? recover_rates(context) : GIC_ERROR_NEWTON;
    if (status == GIC_OK) {
        find_coordinates(world, memory);
        gcp->recovered = self;
    } else {
        partition_forget(gcp->partition); /* factors of where it failed */
    }
    const double taken = profile_clock(profile) - begun;
    profile->recovery += taken;
    profile->recovery_functions += taken - (profile->recovery_solver - solver);
    return status;
}

static int place(const Interpreted *context, Instance *self, const double *state)
{
    const Memory memory = memory_of(context, self);
    return recover(context, self, &memory, state);
}

/* ---- right-hand side -------------------------------------------------------------------------------------------- */

static int accelerate(const Interpreted *context, Instance *self, double *rate)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    const Gcp *gcp = context->engine;
    const double begun = profile_clock(profile);
    int status = world_forces(world);
    if (status != GIC_OK)
        return status;
    world_spread(world);
    for (int t = 0; t < world->ties; ++t)
        world_gamma(world, t);
    const double ready = profile_clock(profile);
    status = world_accelerate(world);
    interpreted_name_lost(context, self, status);
    const double solved_at = profile_clock(profile);
    memcpy(rate, world->qd[world->first], sizeof *rate * (size_t)gcp->columns);
    memcpy(rate + gcp->columns, world->qdd[world->first], sizeof *rate * (size_t)gcp->columns);
    profile->acceleration += profile_clock(profile) - begun;
    profile->acceleration_functions += ready - begun;
    profile->acceleration_solver += solved_at - ready;
    return status;
}

static int evaluate(const Interpreted *context, Instance *self, const double *state, double *rate)
{
    World *world = context->world;
    const Gcp *gcp = context->engine;
    const Memory memory = memory_of(context, self);
    int status = recover(context, self, &memory, state);
    ++context->profile->evaluations;
    if (status == GIC_OK)
        status = accelerate(context, self, rate);
    if (status == GIC_OK)
        memcpy(memory.near, world->x, sizeof(double) * (size_t)world->model->coordinates);
    if (status != GIC_OK || state != instance_array(&self->head, context->code.state_offset))
        return status;
    const double *q = world->q[world->first], *qd = world->qd[world->first];
    for (int j = 0; j < gcp->columns; ++j) {
        memory.shift[j] = q[j] - state[j];
        memory.shift[gcp->columns + j] = qd[j] - state[gcp->columns + j];
    }
    *memory.shifted = 1;
    return GIC_OK;
}

/* True if Phi_u has come near to singular since its coordinates were chosen. One independent coordinate is checked
 * per step, since a choice stays good for far more steps than there are coordinates. */
static bool degraded(const Memory *memory, Partition *partition)
{
    const double most = 2;
    return partition->columns > partition->rows &&
           !(partition_amplification(partition, (int64_t)*memory->checks) < most * partition->usual);
}

static int choose(const Interpreted *context, const Memory *memory)
{
    const Gcp *gcp = context->engine;
    find_jacobian(gcp, context->world);
    if (!partition_choose(gcp->partition))
        return GIC_ERROR_SINGULAR;
    memcpy(memory->chosen, gcp->partition->chosen, sizeof(double) * (size_t)gcp->columns);
    *memory->usual = gcp->partition->usual;
    return GIC_OK;
}

/* The end of a step: dependent coordinates move by what their recovery at its start found, so that they do not drift
 * from the independent ones, and the choice is made anew where it has become bad. A state that is refused leaves
 * everything as it was. */
static int settle(void *instance, double *state)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const Gcp *gcp = context->engine;
    World *world = context->world;
    const Memory memory = memory_of(context, self);
    const size_t size = 2 * sizeof *state * (size_t)gcp->columns;
    double moved[2 * gcp->columns + 1];
    if (!gic_bounded(state, context->code.slow_count + context->code.fast_count))
        return GIC_ERROR_INPUT;
    const bool shifted = *memory.shifted > 0;
    for (int j = 0; j < 2 * gcp->columns; ++j)
        moved[j] = state[j] + (shifted ? memory.shift[j] : 0);
    ((Gcp *)context->engine)->near = memory.near;
    set_positions(world, moved);
    if (gcp->recovered != self)
        find_jacobian(gcp, world);
    int status = use_partition(context, self, &memory);
    const bool bad = status == GIC_OK && degraded(&memory, gcp->partition);
    /* What becomes independent must fit what was, or the change would be felt. An integrator of variable steps has no
     * state here at their start, but the inputs of their end. */
    if (bad && !shifted) {
        status = recover(context, self, &memory, state);
        if (status == GIC_OK) {
            memcpy(moved, world->q[world->first], size / 2);
            memcpy(moved + gcp->columns, world->qd[world->first], size / 2);
        }
    }
    if (bad && status == GIC_OK)
        status = choose(context, &memory);
    if (status != GIC_OK)
        return status;
    memcpy(state, moved, size);
    *memory.shifted = 0;
    ++*memory.checks;
    self->head.switch_count += bad;
    context->profile->repartitions += bad;
    return GIC_OK;
}

/* ---- to and from states in dual coordinates --------------------------------------------------------------------- */

static int enter(gic_head *head, const double *standard)
{
    Instance *self = (Instance *)(void *)head;
    const Interpreted *context = self->context;
    const Gcp *gcp = context->engine;
    const Interpreted *gic = gcp->gic->context;
    const gic_model *own = &context->code, *code = &gic->code;
    const Memory memory = memory_of(context, self);
    World *world = context->world;
    double *state = instance_array(head, own->state_offset);
    int status = code->setup_with(gcp->start, instance_array(head, own->parameter_offset));
    memcpy(instance_array(&gcp->start->head, code->input_offset), instance_array(head, own->input_offset),
           sizeof(double) * (size_t)code->input_count);
    if (status == GIC_OK)
        status =
            gic_finite(standard, code->slow_count) ? interpreted_load(gcp->start, gic_time(head)) : GIC_ERROR_INPUT;
    if (status == GIC_OK)
        status = gic->place(gic, gcp->start, standard);
    if (status != GIC_OK) {
        head->subset = gcp->start->head.subset;
        return head->status = status;
    }
    memcpy(state, gic->world->q[world->first], sizeof *state * (size_t)gcp->columns);
    memcpy(state + gcp->columns, gic->world->qd[world->first], sizeof *state * (size_t)gcp->columns);
    memcpy(memory.near, gic->world->x, sizeof(double) * (size_t)world->model->coordinates);
    *memory.shifted = 0;
    set_positions(world, state);
    world->input = instance_array(head, own->input_offset);
    gather_driven(world);
    take_share(context, self);
    ((Gcp *)context->engine)->near = memory.near;
    ((Gcp *)context->engine)->recovered = NULL;
    return head->status = choose(context, &memory);
}

/* Outputs and poses from factors of their own, so that they are the same however often someone looks. */
static int outputs(void *instance)
{
    const Interpreted *context = ((const Instance *)instance)->context;
    take_share(context, instance);
    partition_forget(((const Gcp *)context->engine)->partition);
    return ((const Gcp *)context->engine)->outputs(instance);
}

static int poses(void *instance, double *pose)
{
    const Interpreted *context = ((const Instance *)instance)->context;
    take_share(context, instance);
    partition_forget(((const Gcp *)context->engine)->partition);
    return ((const Gcp *)context->engine)->poses(instance, pose);
}

static void leave(const gic_head *head, double *standard, double *rate)
{
    interpreted_standard(((const Instance *)(const void *)head)->context, standard, rate);
}

static int start(const Interpreted *context, Instance *self)
{
    /* setup has put the initial state there in dual coordinates */
    const double *state = instance_array(&self->head, context->code.state_offset);
    double standard[context->standard_count + 1];
    memcpy(standard, state, sizeof *standard * (size_t)context->standard_count);
    return enter(&self->head, standard);
}

/* ---- opening ---------------------------------------------------------------------------------------------------- */

static void add_entry(PartitionRow *row, int column, const double *value)
{
    if (*value == 0)
        return;
    row->column[row->count] = column;
    row->value[row->count++] = value;
}

/* All derivatives by the bodies of such a row: slopes of a formula may vanish anywhere. */
static void coupled_pattern(const World *world, const CoupledRow *coupled, PartitionRow *row)
{
    for (int k = 0; k < coupled->bodies; ++k)
        for (int i = 0; i < BODY_Q && coupled->body[k] >= world->first; ++i) {
            if (row->count == PARTITION_WIDTH)
                diag_fail(world->model->joint[coupled->tie].at, "use --engine gic, or those of generated code",
                          "joint '%s' follows coordinates of too many bodies for engines gcp1 and gcp2",
                          world->model->joint[coupled->tie].name);
            row->column[row->count] = column_of(world, coupled->body[k]) + i;
            row->value[row->count++] = &coupled->J[k][i];
        }
}

/* Which derivatives can be other than 0: those that are not, at some placement of the bodies without any symmetry. */
static PartitionRow *find_pattern(Pool *pool, World *world, const CoupledRows *coupled)
{
    const int bodies = world->bodies - world->first, rows = world->constraint_rows + bodies;
    PartitionRow *row = pool_alloc(pool, ((size_t)rows + 1) * sizeof *row), *next = row;
    Random random = {.state = 1};
    for (int body = world->first; body < world->bodies; ++body) {
        double q[BODY_Q], square = 0;
        for (int i = 0; i < BODY_Q; ++i)
            q[i] = random_uniform(&random, 0.5, 1);
        for (int i = 3; i < BODY_Q; ++i)
            square += q[i] * q[i];
        for (int i = 3; i < BODY_Q; ++i)
            q[i] /= sqrt(square);
        world_set_q(world, body, q);
    }
    for (int t = 0; t < world->constraints; ++t) {
        const Tie *tie = &world->tie[t];
        const CoupledRow *own = coupled->row;
        while (own < coupled->row + coupled->rows && own->tie != t)
            ++own;
        if (own < coupled->row + coupled->rows) {
            coupled_pattern(world, own, next++);
            continue;
        }
        world_rows(world, t);
        for (int r = 0; r < tie->rows; ++r, ++next)
            for (int end = 0; end < 2; ++end)
                for (int i = 0; i < BODY_Q && tie->body[end] >= world->first; ++i)
                    add_entry(next, column_of(world, tie->body[end]) + i,
                              world->J + ROW_J * tie->first + BODY_Q * (tie->rows * end + r) + i);
    }
    for (int body = world->first; body < world->bodies; ++body, ++next)
        for (int i = 3; i < BODY_Q; ++i)
            add_entry(next, column_of(world, body) + i, &world->q[body][i]);
    return row;
}

static const gic_signal *signals(Pool *pool, const World *world)
{
    static const char *const part[2][BODY_Q] = {{"r.x", "r.y", "r.z", "e0", "e1", "e2", "e3"},
                                                {"v.x", "v.y", "v.z", "e0.rate", "e1.rate", "e2.rate", "e3.rate"}};
    static const char *const unit[2][2] = {{"m", "1"}, {"m/s", "1/s"}};
    const int columns = BODY_Q * (world->bodies - world->first), fast = world->model->fast_states;
    gic_signal *signal = pool_alloc(pool, (size_t)(2 * columns + fast + 1) * sizeof *signal);
    for (int j = 0; j < 2 * columns; ++j) {
        const int rate = j >= columns, i = j % columns, body = i / BODY_Q + world->first;
        signal[j] = (gic_signal){pool_print(pool, "%s.%s", world->model->body[body].name, part[rate][i % BODY_Q]),
                                 unit[rate][i % BODY_Q > 2]};
    }
    memcpy(signal + 2 * columns, descriptor_fast_states(pool, world->model), sizeof *signal * (size_t)fast);
    return signal;
}

/* All of q and q' instead of the slow states of FORMAT.md section 10. */
static void set_states(Pool *pool, Interpreted *context, int own)
{
    gic_model *code = &context->code;
    const size_t states = (size_t)(own + code->fast_count);
    code->slow_count = own;
    descriptor_controllers(pool, context->world->model, code);
    code->state = signals(pool, context->world);
    code->state_offset = descriptor_place(code, states);
    code->rate_offset = descriptor_place(code, states);
    code->history_offset = descriptor_place(code, GIC_HISTORY(states, (size_t)code->fast_count));
    code->scratch_offset = descriptor_place(code, descriptor_scratch(code, states));
}

/* Nothing is derived from the design: q goes on from a configuration that gic finds. */
static int design(const Interpreted *context, Instance *self)
{
    (void)context, (void)self;
    return GIC_OK;
}

static void close_gcp(const Engine *engine)
{
    const Interpreted *context = engine->context;
    const Gcp *gcp = context->engine;
    for (int i = 0; i < SHARES; ++i)
        partition_close(gcp->share[i].partition);
    context->world->solver->close(context->world->solving);
}

static const Engine *open_gcp(Pool *pool, const char *name, const Model *drawn, const EngineOptions *options,
                              const Solver *solver)
{
    const Sequence *sequence = sequence_find(pool, drawn);
    const Model *model = model_assemble(pool, drawn, sequence);
    const int bodies = model->bodies - !model->free_base, columns = BODY_Q * bodies;
    Interpreted *context = interpreted_new(pool, model, sequence, (size_t)(3 * columns + 3 + model->coordinates));
    World *world = context->world;
    Gcp *gcp = pool_alloc(pool, sizeof *gcp);
    const int rows = world->constraint_rows + bodies;
    *gcp = (Gcp){.gic = engine_gic(pool, model, options),
                 .columns = columns,
                 .coupled = coupled_rows_new(pool, world),
                 .b = pool_alloc(pool, ((size_t)rows + 1) * sizeof(double))};
    for (int i = 0; i < SHARES; ++i)
        gcp->share[i].partition = partition_new(pool, rows, columns, find_pattern(pool, world, &gcp->coupled));
    gcp->start = (Instance *)(void *)instance_new(pool, gcp->gic);
    world_set_solver(pool, world, solver);
    context->design = design;
    context->place = place;
    context->start = start;
    context->evaluate = evaluate;
    context->engine = gcp;
    context->code.settle = settle;
    gcp->outputs = context->code.outputs;
    gcp->poses = context->code.poses;
    context->code.outputs = outputs;
    context->code.poses = poses;
    Engine *engine = interpreted_engine(pool, name, context);
    set_states(pool, context, 2 * columns);
    engine->enter = enter;
    engine->leave = leave;
    engine->close = close_gcp;
    return engine;
}

const Engine *engine_gcp1(Pool *pool, const Model *model, const EngineOptions *options)
{
    return open_gcp(pool, "gcp1", model, options, &topology_solver);
}

const Engine *engine_gcp2(Pool *pool, const Model *model, const EngineOptions *options)
{
    return open_gcp(pool, "gcp2", model, options, &mumps_solver);
}
