/* SPDX-License-Identifier: MIT
 * dz/dt = f + A z, and derivatives by inputs and parameters and of outputs: right-hand side and outputs of the engine
 * `tape` in dual numbers, one direction after the other.
 *
 * The dependent coordinates q solve Phi(q, x) = 0 by Newton's iteration q1 = q0 - J(q0)^-1 Phi(q0, x). At a solution q0
 * one correction in dual numbers has the exact derivative, whatever derivative q0 came with, for
 * dq1 = dq0 - J^-1 (J dq0 + Phi_x dx) = -J^-1 Phi_x dx (implicit function theorem). A second one then finds that of the
 * velocity Jacobian S, which depends on q. So a recovered configuration takes two corrections, and nothing is
 * iterated. Where q has a closed form, that is all it takes.
 *
 * A parked vehicle stands on kinks: |V| of a tire's slip at V = 0. There the derivative is the mean of both sides, the
 * limit of central differences, so that it does not depend on the sign of what is zero but for rounding. One-sided
 * derivatives obey the chain rule through kinks, means do not (|V| times a condition on V); so both are played. */
#include "base/vec3.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/linearize.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "tape/engine_tape.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

/* Share of a number's unit within which a state counts as being at a kink. Rounding leaves 1e-15, an equilibrium 1e-12.
 */
static const double at_kink = 1e-9;

/* ---- in Euler parameters: the right-hand side along dy -------------------------------------------------- */

/* The dependent Euler parameter follows from the other three; dy: [states]. */
static int orient(const Instance *self, const double *y, const double *dy, double e[4], double de[4])
{
    const gic_model *code = &tape_of(self)->code;
    int32_t dependent;
    int64_t switches = 0;
    memcpy(e, (const double[4]){1, 0, 0, 0}, 4 * sizeof *e);
    memset(de, 0, 4 * sizeof *de);
    if (!code->free_base)
        return GIC_OK;
    memcpy(&dependent, (const char *)self + code->discrete_offset, sizeof dependent);
    const int status = gic_orientation(y + 3, &dependent, &switches, e);
    if (status != GIC_OK)
        return status;
    memcpy(de, dy + 3, 4 * sizeof *de);
    de[dependent] = 0;
    for (int i = 0; i < 4; ++i)
        if (i != dependent)
            de[dependent] -= e[i] * de[i] / e[dependent];
    return GIC_OK;
}

/* Addresses of the numbers that a subset's blocks read and write, in an instance or in its derivatives. */
static void link_subset(Instance *self, TapeLinks *links, int s, double *q, double *step)
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const Subset *subset = &plan->sequence->subset[s];
    const Layout *layout = engine->class[subset->class].layout;
    double *all = tape_start(self), *start = all + plan->start_offset[s];
    const double *xd = tape_array(self, engine->xd_offset);
    tape_link(self, links, subset);
    links->array[CLASS_q] = q;
    links->array[CLASS_s] = start + layout->start_S;
    links->array[CLASS_f] = start + layout->start_factors;
    links->array[CLASS_start] = start;
    links->array[CLASS_motion] = tape_array(self, engine->motion_offset) + plan->motion_offset[subset->body[0]];
    links->array[CLASS_inertia] = tape_array(self, engine->inertia_offset) + plan->inertia_offset[s];
    links->array[CLASS_step] = step;
    links->array[CLASS_reach] = step + 1;
    if (!engine->class[subset->class].closed)
        memcpy(q, start, 7 * (size_t)subset->bodies * sizeof *q);
    for (int j = 0; j < subset->deps; ++j) {
        links->x[j] = all[subset->dep[j]];
        links->rate[j] = xd[subset->dep[j]];
        links->change[j] = 0;
    }
}

/* Which side of kinks; or the journal in which all is noted for the way back. */
typedef struct Sides {
    double near;
    int *kinks;
    TapeJournal *journal;
} Sides;

/* What link_subset() copied: the Newton start, on which the solution does not depend, and coordinates. */
static void note_links(const Linear *linear, TapeLinks *slope, int s)
{
    const TapeEngine *engine = linear->engine;
    const Subset *subset = &engine->formulation->sequence->subset[s];
    double *all = tape_start(linear->slope), *xd = tape_array(linear->slope, engine->xd_offset);
    memset(linear->q, 0, 7 * (size_t)subset->bodies * sizeof(double));
    journal_copy(linear->journal, NULL, linear->q, 7 * subset->bodies);
    journal_copy(linear->journal, NULL, slope->change, subset->deps);
    for (int j = 0; j < subset->deps; ++j) {
        journal_copy(linear->journal, all + subset->dep[j], &slope->x[j], 1);
        journal_copy(linear->journal, xd + subset->dep[j], &slope->rate[j], 1);
    }
}

/* Derivatives of all subsets; the configuration in `value` is recovered already. y, dy: the state and its change. */
static int recover(const Linear *linear, const double *y, const double *dy, const Sides *sides)
{
    const TapeEngine *engine = linear->engine;
    const Sequence *sequence = engine->formulation->sequence;
    const TapeWorld none = {.near = sides->near, .kinks = sides->kinks, .journal = sides->journal};
    TapeLinks *value = linear->links[0], *slope = linear->links[1];
    if (engine->code.free_base) {
        memcpy(value->turn, y + linear->places + 4, sizeof value->turn);
        memcpy(slope->turn, dy + linear->places + 4, sizeof slope->turn);
    }
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        if (subset->class < 0)
            continue;
        link_subset(linear->value, value, s, engine->q, linear->step[0]);
        link_subset(linear->slope, slope, s, linear->q, linear->step[1]);
        if (sides->journal)
            note_links(linear, slope, s);
        const int corrections = engine->class[subset->class].closed ? 1 : 2;
        for (int i = 0; i < corrections; ++i) {
            const int status = tape_play_dual(engine->class[subset->class].solve, engine->member[s], value->array,
                                              slope->array, &none, engine->frame, linear->frame);
            if (status != GIC_OK)
                return status;
        }
    }
    return GIC_OK;
}

/* Coordinates and their rates, in derivatives of an instance. */
static void scatter(const Linear *linear, const double *dy, const double *du)
{
    const TapeEngine *engine = linear->engine;
    const Plan *plan = engine->formulation->plan;
    double *dx = tape_array(linear->slope, engine->x_offset), *dxd = tape_array(linear->slope, engine->xd_offset);
    double *start = tape_start(linear->slope);
    for (int w = 0; w < plan->model->coordinates; ++w) {
        const Coordinate *c = &plan->model->coordinate[w];
        dx[w] = start[w] = c->driven ? du[c->input] : dy[plan->coordinate_state[w]];
        dxd[w] = c->driven ? du[c->input + 1] : dy[plan->coordinate_rate[w]];
    }
}

/* A direction, in the instance of derivatives: what changes besides the state. Geometric parameters change the derived
 * numbers. */
static int set_direction(const Linear *linear, const Direction *along, TapeJournal *journal)
{
    const gic_model *code = &linear->engine->code;
    double *dp = tape_array(linear->slope, code->parameter_offset);
    memcpy(tape_array(linear->slope, code->input_offset), along->u, (size_t)code->input_count * sizeof(double));
    memcpy(tape_array(linear->slope, code->port_offset), along->port, (size_t)code->port_count * sizeof(double));
    memcpy(dp, along->p, (size_t)code->parameter_count * sizeof *dp);
    bool tuned = journal && linear->engine->derive;
    for (int i = 0; linear->engine->derive && i < code->parameter_count; ++i)
        tuned = tuned || dp[i] != 0;
    return tuned ? tape_derive_dual(linear->value, linear->slope, journal, linear->frame) : GIC_OK;
}

/* linear->drate: derivatives of the state's rate and of the outputs along linear->along, one-sided where `kinks` are
 * met; linear->rate: their values on that side; linear->link: links with their derivatives. `self` has just been
 * evaluated at its state. sides: with the share of the direction within which kinks are met. outputs: number of
 * outputs; 0: they are not looked at. part: what of it. */
static int rate_to_side(const Linear *linear, const Instance *self, LinearPart part, const Sides *sides, int outputs)
{
    const TapeEngine *engine = linear->engine;
    const gic_model *code = &engine->code;
    const double time = gic_time(self), *dy = linear->along.y;
    const int states = code->slow_count + code->fast_count;
    double *e = linear->euler[0], *de = linear->euler[1], *array[WHOLE_COUNT], *slope[WHOLE_COUNT];
    memcpy(linear->value, self, code->size);
    memset(linear->slope, 0, code->size);
    linear->slope->context = engine;
    linear->slope->head.flip = self->head.flip;
    const double *y = tape_array(linear->value, code->state_offset);
    int status = orient(self, y, dy, e, de);
    if (status == GIC_OK)
        status = set_direction(linear, &linear->along, sides->journal);
    if (status != GIC_OK)
        return status;
    scatter(linear, dy, linear->along.u);
    memset(linear->links[1]->turn, 0, sizeof linear->links[1]->turn);
    if (part != LINEAR_FAST && part != LINEAR_SHIFT)
        status = recover(linear, y, dy, sides);
    if (status != GIC_OK)
        return status;
    const TapeWorld world = {.table = engine->table,
                             .road = self->head.road,
                             .lane = self->head.lane,
                             .time = time,
                             .head = &linear->value->head,
                             .near = sides->near,
                             .kinks = sides->kinks,
                             .journal = sides->journal};
    tape_arrays(linear->value, &time, y, e, linear->rate, NULL, linear->rate + states, array);
    tape_arrays(linear->slope, linear->along.time, dy, de, linear->drate, NULL, linear->drate + states, slope);
    if (part == LINEAR_SHIFT)
        return tape_choose_dual(engine, &world, array, slope, linear->choice, linear->frame);
    if (engine->wheel && part != LINEAR_FAST)
        status = tape_link_wheels_dual(engine, &world, array, slope, linear->link, linear->frame);
    if (engine->wheel && part != LINEAR_LINKS && status == GIC_OK)
        status = tape_turn_wheels_dual(engine, &world, array, slope, linear->link, linear->frame);
    if (part == LINEAR_PRESS && status == GIC_OK)
        return tape_play_dual(engine->contacts, 0, array, slope, &world, engine->frame, linear->frame);
    if (part != LINEAR_RATE || status != GIC_OK)
        return status;
    status = tape_play_dual(engine->dynamics, 0, array, slope, &world, engine->frame, linear->frame);
    if (status == GIC_OK && outputs && engine->wrenches)
        status = tape_react_dual((Instance *const[]){linear->value, linear->slope}, linear->links, &world, array, slope,
                                 linear->frame);
    if (status == GIC_OK && outputs)
        status = tape_play_dual(engine->outputs, 0, array, slope, &world, engine->frame, linear->frame);
    return status;
}

/* True if a rate or an output jumps: the difference between both sides is more than slopes can make of their distance.
 */
static bool is_jump(int count, double near, const double *const rate[2], const double *const drate[2])
{
    for (int i = 0; i < count; ++i) {
        const double between = near * (fabs(drate[0][i]) + fabs(drate[1][i]));
        if (fabs(rate[0][i] - rate[1][i]) > equilibrium_limit * (1 + fabs(rate[0][i])) + 2 * between)
            return true;
    }
    return false;
}

/* The direction the other way. */
static void turn_round(const Linear *linear)
{
    const gic_model *code = &linear->engine->code;
    const Direction *along = &linear->along;
    for (int i = 0; i < code->slow_count + code->fast_count; ++i)
        along->y[i] = -along->y[i];
    for (int i = 0; i < code->input_count; ++i)
        along->u[i] = -along->u[i];
    for (int i = 0; i < code->port_count; ++i)
        along->port[i] = -along->port[i];
    for (int i = 0; i < code->parameter_count; ++i)
        along->p[i] = -along->p[i];
    *along->time = -*along->time;
}

/* linear->drate: derivatives of the state's rate and of the outputs along linear->along; at kinks the mean of both
 * sides. *jump: set where one of them is another one on the other side. */
static int rate_along(const Linear *linear, const Instance *self, double near, int outputs, bool *jump)
{
    const int count = linear->engine->code.slow_count + linear->engine->code.fast_count + outputs;
    double other_rate[count + 1], other[count + 1];
    int kinks = 0;
    const Sides sides = {near, &kinks, NULL};
    int status = rate_to_side(linear, self, LINEAR_RATE, &sides, outputs);
    if (status != GIC_OK || !kinks)
        return status;
    memcpy(other_rate, linear->rate, (size_t)count * sizeof *other);
    memcpy(other, linear->drate, (size_t)count * sizeof *other);
    turn_round(linear);
    status = rate_to_side(linear, self, LINEAR_RATE, &sides, outputs);
    *jump = *jump || is_jump(count, near, (const double *const[]){linear->rate, other_rate},
                             (const double *const[]){linear->drate, other});
    for (int i = 0; i < count; ++i)
        linear->drate[i] = (other[i] - linear->drate[i]) / 2;
    return status;
}

/* ---- in small motions ----------------------------------------------------------------------------------- */

/* Indices of a free base's numbers in the state, and of its places and rates among small motions. */
enum { POSITION = 0, PARAMETERS = 3, DISPLACEMENT = 0, ROTATION = 3, BASE_PLACES = 6 };

static const double *base_velocity(const Linear *linear, const double *y)
{
    return y + linear->places + 1;
}

static const double *base_turn(const Linear *linear, const double *y)
{
    return y + linear->places + 4;
}

/* dp = G(p)^T theta / 2: the change of Euler parameters by a small rotation about the body's own axes. */
static void parameters_turned(const double p[4], const double theta[3], double dp[4])
{
    double c[3];
    cross3(p + 1, theta, c);
    dp[0] = -dot3(p + 1, theta) / 2;
    for (int i = 0; i < 3; ++i)
        dp[i + 1] = (p[0] * theta[i] + c[i]) / 2;
}

/* dy: the change of the state that belongs to small motions z [count]. With the rotation R to the world, velocity
 * v = R u changes by R (du + theta x u). */
static void state_change(const Linear *linear, const double *y, const double *z, double *dy)
{
    const gic_model *code = &linear->engine->code;
    const int base = code->free_base ? BASE_PLACES : 0, places = linear->places, extra = code->free_base;
    memcpy(dy + base + extra, z + base, (size_t)(places - base) * sizeof *dy);
    memcpy(dy + places + extra + base, z + places + base, (size_t)(linear->count - places - base) * sizeof *dy);
    if (!code->free_base)
        return;
    double R[9], u[3], du[3];
    mat_from_euler(y + PARAMETERS, R);
    apply3(R, z + DISPLACEMENT, dy + POSITION);
    parameters_turned(y + PARAMETERS, z + ROTATION, dy + PARAMETERS);
    apply3_transposed(R, base_velocity(linear, y), u);
    cross3(z + ROTATION, u, du);
    for (int i = 0; i < 3; ++i)
        du[i] += z[places + i];
    apply3(R, du, dy + places + 1);
    memcpy(dy + places + 4, z + places + 3, 3 * sizeof *dy);
}

/* The rate f of small motions' places and velocities, [count], from the state's rate. */
static void motion_rate(const Linear *linear, const double *y, const double *rate, double *f)
{
    const gic_model *code = &linear->engine->code;
    const int base = code->free_base ? BASE_PLACES : 0, places = linear->places, extra = code->free_base;
    memcpy(f + base, rate + base + extra, (size_t)(places - base) * sizeof *f);
    memcpy(f + places + base, rate + places + extra + base, (size_t)(linear->count - places - base) * sizeof *f);
    if (!code->free_base)
        return;
    double R[9], u[3], c[3];
    const double *turn = base_turn(linear, y);
    mat_from_euler(y + PARAMETERS, R);
    apply3_transposed(R, base_velocity(linear, y), u);
    memcpy(f + DISPLACEMENT, u, sizeof u);
    memcpy(f + ROTATION, turn, 3 * sizeof *f);
    apply3_transposed(R, rate + places + 1, f + places);
    cross3(turn, u, c);
    for (int i = 0; i < 3; ++i)
        f[places + i] -= c[i];
    memcpy(f + places + 3, rate + places + 4, 3 * sizeof *f);
}

/* And its change along z. In the frame of the base, which turns with omega and is turned by theta:
 *     rho' = du + theta x u - omega x rho          theta' = d omega - omega x theta
 *     du'  = R^T dv' - theta x R^T v' - d omega x u - omega x du */
static void motion_rate_change(const Linear *linear, const double *y, const double *rate, const double *z,
                               const double *drate, double *df)
{
    const gic_model *code = &linear->engine->code;
    const int base = code->free_base ? BASE_PLACES : 0, places = linear->places, extra = code->free_base;
    memcpy(df + base, drate + base + extra, (size_t)(places - base) * sizeof *df);
    memcpy(df + places + base, drate + places + extra + base, (size_t)(linear->count - places - base) * sizeof *df);
    if (!code->free_base)
        return;
    double R[9], u[3], a[3], c[5][3];
    const double *omega = base_turn(linear, y), *theta = z + ROTATION, *du = z + places, *domega = z + places + 3;
    mat_from_euler(y + PARAMETERS, R);
    apply3_transposed(R, base_velocity(linear, y), u);
    apply3_transposed(R, rate + places + 1, a);
    apply3_transposed(R, drate + places + 1, df + places);
    memcpy(df + places + 3, drate + places + 4, 3 * sizeof *df);
    cross3(theta, u, c[0]);
    cross3(omega, z + DISPLACEMENT, c[1]);
    for (int i = 0; i < 3; ++i)
        df[DISPLACEMENT + i] = du[i] + c[0][i] - c[1][i];
    cross3(omega, theta, c[0]);
    for (int i = 0; i < 3; ++i)
        df[ROTATION + i] = domega[i] - c[0][i];
    cross3(theta, a, c[0]);
    cross3(domega, u, c[1]);
    cross3(omega, du, c[2]);
    for (int i = 0; i < 3; ++i)
        df[places + i] -= c[0][i] + c[1][i] + c[2][i];
}

int linear_start(const Linear *linear, Instance *self, double *f)
{
    const gic_model *code = &linear->engine->code;
    const double *y = tape_array(self, code->state_offset);
    const int status = code->rhs(self, gic_time(self), y, linear->evaluated);
    if (status == GIC_OK)
        motion_rate(linear, y, linear->evaluated, f);
    return status;
}

/* Set linear->along to a unit of one number; z: [count], 1 for it if it is one of the motions, else 0. Returns the
 * share of the direction within which kinks count as met. */
static double point_along(const Linear *linear, Instance *self, LinearKind kind, int j, double *z)
{
    const gic_model *code = &linear->engine->code;
    const Direction *along = &linear->along;
    memset(z, 0, (size_t)linear->count * sizeof *z);
    memset(along->y, 0, (size_t)(code->slow_count + code->fast_count) * sizeof *along->y);
    memset(along->u, 0, (size_t)code->input_count * sizeof *along->u);
    memset(along->port, 0, (size_t)code->port_count * sizeof *along->port);
    memset(along->p, 0, (size_t)code->parameter_count * sizeof *along->p);
    *along->time = 0;
    double *const number[] = {
        [LINEAR_MOTION] = z, [LINEAR_INPUT] = along->u, [LINEAR_PORT] = along->port, [LINEAR_PARAMETER] = along->p};
    number[kind][j] = 1;
    if (kind == LINEAR_MOTION)
        state_change(linear, tape_array(self, code->state_offset), z, along->y);
    const double value = kind == LINEAR_PARAMETER ? tape_array(self, code->parameter_offset)[j] : 1;
    return at_kink * (kind == LINEAR_MOTION ? linear->reach[j] : value != 0 ? fabs(value) : 1);
}

void linear_direction(const Linear *linear, Instance *self, LinearKind kind, int j)
{
    double z[linear->count + 1];
    (void)point_along(linear, self, kind, j, z);
}

/* Numbers of a part whose derivatives are found. */
typedef struct Part {
    double *number;
    int count;
} Part;

static Part results_of(const Linear *linear, LinearPart part, int outputs)
{
    const gic_model *code = &linear->engine->code;
    switch (part) {
    case LINEAR_LINKS: return (Part){linear->link[1], code->link_count};
    case LINEAR_FAST: return (Part){linear->drate + code->slow_count, code->fast_count};
    case LINEAR_SHIFT: return (Part){linear->choice[1], linear->choices};
    case LINEAR_PRESS: return (Part){linear->drate, code->slow_count + code->fast_count + code->contact_count};
    default: return (Part){linear->drate, code->slow_count + code->fast_count + outputs};
    }
}

int linear_slope(const Linear *linear, const Instance *self, LinearPart part, int outputs)
{
    const Part result = results_of(linear, part, outputs);
    int kinks = 0;
    const int status = rate_to_side(linear, self, part, &(Sides){.kinks = &kinks}, outputs);
    if (status != GIC_OK || !kinks || !gic_finite(result.number, result.count)) /* on one side: sqrt(abs(x)) at 0 */
        return status;
    return rate_to_side(linear, self, part, &(Sides){.near = -1}, outputs);
}

/* From derivatives by what orient(), scatter() and recover() made of the state and inputs to those by these. */
static void gather_back(const Linear *linear)
{
    const TapeEngine *engine = linear->engine;
    const Plan *plan = engine->formulation->plan;
    const double *dx = tape_array(linear->slope, engine->x_offset), *dxd = tape_array(linear->slope, engine->xd_offset);
    const double *start = tape_start(linear->slope), *e = linear->euler[0], *de = linear->euler[1];
    const Direction *along = &linear->along;
    const gic_model *code = &engine->code;
    memcpy(along->u, tape_array(linear->slope, code->input_offset), (size_t)code->input_count * sizeof(double));
    memcpy(along->port, tape_array(linear->slope, code->port_offset), (size_t)code->port_count * sizeof(double));
    memcpy(along->p, tape_array(linear->slope, code->parameter_offset), (size_t)code->parameter_count * sizeof(double));
    for (int w = 0; w < plan->model->coordinates; ++w) {
        const Coordinate *c = &plan->model->coordinate[w];
        *(c->driven ? &along->u[c->input] : &along->y[plan->coordinate_state[w]]) += dx[w] + start[w];
        *(c->driven ? &along->u[c->input + 1] : &along->y[plan->coordinate_rate[w]]) += dxd[w];
    }
    if (!code->free_base)
        return;
    int32_t dependent;
    int64_t switches = 0;
    double again[4];
    memcpy(&dependent, (const char *)linear->value + code->discrete_offset, sizeof dependent);
    gic_orientation(tape_array(linear->value, code->state_offset) + 3, &dependent, &switches, again);
    for (int i = 0; i < 3; ++i)
        along->y[linear->places + 4 + i] += linear->links[1]->turn[i];
    for (int i = 0; i < 4; ++i)
        if (i != dependent)
            along->y[3 + i] += de[i] - e[i] / e[dependent] * de[dependent];
}

/* The numbers of linear->along, and of links. */
enum { PARTS = 6 };

static void parts_of(const Linear *linear, LinearPart of, Part part[PARTS])
{
    const gic_model *code = &linear->engine->code;
    const Direction *along = &linear->along;
    part[0] = (Part){along->y, code->slow_count + code->fast_count};
    part[1] = (Part){along->u, code->input_count};
    part[2] = (Part){along->port, code->port_count};
    part[3] = (Part){along->p, code->parameter_count};
    part[4] = (Part){linear->link[1], of == LINEAR_FAST ? code->link_count : 0};
    part[5] = (Part){along->time, 1};
}

/* True if the derivatives along a direction with everything in it are finite: then what has infinite factors does not
 * change. The direction is lost. */
static bool is_smooth(const Linear *linear, const Instance *self, LinearPart of, int outputs, const Part part[PARTS])
{
    for (int k = 0; k < PARTS; ++k)
        for (int i = 0; i < part[k].count; ++i)
            part[k].number[i] = 1 + 0.1 * i / part[k].count;
    const Part result = results_of(linear, of, outputs);
    return linear_slope(linear, self, of, outputs) == GIC_OK && gic_finite(result.number, result.count);
}

/* The same, and the direction stays as it was. */
static bool stays_smooth(const Linear *linear, const Instance *self, LinearPart of, int outputs, const Part part[PARTS])
{
    int count = 1;
    for (int k = 0; k < PARTS; ++k)
        count += part[k].count;
    double kept[count], *at = kept;
    for (int k = 0; k < PARTS; at += part[k++].count)
        memcpy(at, part[k].number, (size_t)part[k].count * sizeof *at);
    const bool smooth = is_smooth(linear, self, of, outputs, part);
    at = kept;
    for (int k = 0; k < PARTS; at += part[k++].count)
        memcpy(part[k].number, at, (size_t)part[k].count * sizeof *at);
    return smooth;
}

int linear_pull(const Linear *linear, const Instance *self, LinearPart of, int outputs)
{
    Part part[PARTS];
    parts_of(linear, of, part);
    const Part result = results_of(linear, of, outputs);
    double weight[result.count + 1];
    memcpy(weight, result.number, (size_t)result.count * sizeof *weight);
    for (int k = 0; k < PARTS; ++k)
        memset(part[k].number, 0, (size_t)part[k].count * sizeof(double));
    journal_begin(linear->journal);
    const int status = rate_to_side(linear, self, of, &(Sides){.journal = linear->journal}, outputs);
    if (status != GIC_OK)
        return status;
    memset(linear->link[1], 0, (size_t)linear->engine->code.link_count * sizeof *weight);
    /* results that are not asked for, as conditions behind the formula, have no weight, whatever stood there */
    memset(linear->drate, 0, (size_t)linear->results * sizeof *weight);
    memcpy(result.number, weight, (size_t)result.count * sizeof *weight);
    const int infinite = journal_back(linear->journal);
    gather_back(linear);
    return !infinite || stays_smooth(linear, self, of, outputs, part) ? GIC_OK : GIC_ERROR_RESULT;
}

int linear_column(const Linear *linear, Instance *self, LinearKind kind, int j, double *df, int outputs, double *dout,
                  bool *jump)
{
    const gic_model *code = &linear->engine->code;
    const double *y = tape_array(self, code->state_offset);
    double z[linear->count + 1];
    const double near = point_along(linear, self, kind, j, z);
    *jump = false;
    const int status = rate_along(linear, self, near, outputs, jump);
    if (status != GIC_OK)
        return self->head.status = status;
    motion_rate_change(linear, y, linear->evaluated, z, linear->drate, df);
    for (int i = 0; i < outputs; ++i)
        dout[i] = linear->drate[code->slow_count + code->fast_count + i];
    return GIC_OK;
}

int linearize(const Linear *linear, Instance *self, double *f, double *A)
{
    const int count = linear->count;
    double column[count + 1];
    int status = linear_start(linear, self, f);
    for (int j = 0; j < count && status == GIC_OK; ++j) {
        status = linear_column(linear, self, LINEAR_MOTION, j, column, 0, NULL, &linear->jumps[j]);
        for (int i = 0; i < count; ++i)
            A[i * count + j] = column[i];
    }
    if (status != GIC_OK)
        return status;
    return gic_finite(A, count * count) ? GIC_OK : GIC_ERROR_RESULT;
}

void linear_move(const Linear *linear, Instance *self, const double *z)
{
    const gic_model *code = &linear->engine->code;
    const int base = code->free_base ? BASE_PLACES : 0;
    double *y = tape_array(self, code->state_offset);
    for (int i = base; i < linear->places; ++i)
        y[i + code->free_base] += z[i];
    for (int i = 2 * linear->places; i < linear->count; ++i)
        y[i + code->free_base] += z[i];
    if (!code->free_base)
        return;
    double R[9], dr[3], p[4], axis[3], c[3];
    mat_from_euler(y + PARAMETERS, R);
    apply3(R, z + DISPLACEMENT, dr);
    for (int i = 0; i < 3; ++i)
        y[POSITION + i] += dr[i];
    const double angle = norm3(z + ROTATION), share = angle > 0 ? sin(angle / 2) / angle : 0.5;
    memcpy(p, y + PARAMETERS, sizeof p);
    for (int i = 0; i < 3; ++i)
        axis[i] = share * z[ROTATION + i];
    cross3(p + 1, axis, c);
    y[PARAMETERS] = p[0] * cos(angle / 2) - dot3(p + 1, axis);
    for (int i = 0; i < 3; ++i)
        y[PARAMETERS + 1 + i] = p[0] * axis[i] + p[i + 1] * cos(angle / 2) + c[i];
    code->settle(self, y);
}

/* ---- opening -------------------------------------------------------------------------------------------- */

static void add_number(Pool *pool, Linear *linear, const char *name, double reach, double piece)
{
    int same = linear->count, also = linear->count;
    *POOL_PUSH(pool, linear->name, same) = name;
    *POOL_PUSH(pool, linear->piece, also) = piece;
    *POOL_PUSH(pool, linear->reach, linear->count) = reach;
}

/* Units of wheels' fast states, which come first: 1 rad/s, slips of 0.1, the windup of a slipping brake. */
static void describe_wheels(Linear *linear)
{
    static const double reach[FAST_MOST] = {
        [FAST_SPIN] = 1, [FAST_SLIP_X] = 0.1, [FAST_SLIP_Y] = 0.1, [FAST_BRAKE] = 1};
    const Model *model = linear->engine->formulation->model;
    for (int i = 0; i < model->wheels; ++i)
        for (int k = 0; model->wheel[i].tire >= 0 && k < wheel_fast_states(&model->wheel[i]); ++k) {
            const int number = 2 * linear->places + linear->of_wheels++;
            linear->reach[number] = reach[k];
            linear->slips[number] = k == FAST_SLIP_X || k == FAST_SLIP_Y;
        }
}

/* A coordinate's name, or `coordinate/name` if it is also that of a displacement of the base. */
static const char *place_name(Pool *pool, const char *name, const char *const base[], int count)
{
    for (int i = 0; i < count; ++i)
        if (!strcmp(name, base[i]))
            return pool_print(pool, "coordinate/%s", name);
    return name;
}

/* Names of places, also used for their rates, and of fast states; the last fast state of a powertrain is a clock and is
 * left out, as is what controllers hold. */
static void name_numbers(Pool *pool, Linear *linear)
{
    static const char *const base[BASE_PLACES] = {"x", "y", "z", "roll", "pitch", "yaw"};
    const double small = 0.1;
    const TapeEngine *engine = linear->engine;
    const gic_model *code = &engine->code;
    linear->clocks = model_held(engine->formulation->model);
    linear->clocks += engine->formulation->model->powertrain ? POWERTRAIN_FAST - POWERTRAIN_AGE : 0;
    for (int half = 0; half < 2; ++half) {
        for (int i = 0; code->free_base && i < BASE_PLACES; ++i)
            add_number(pool, linear, base[i], small, small);
        for (int c = 0; c < code->coordinate_count; ++c)
            if (code->coordinate_state[c] >= 0)
                add_number(pool, linear,
                           place_name(pool, code->coordinate[c].name, base, code->free_base ? BASE_PLACES : 0), small,
                           engine->piece[c]);
        linear->places = half ? linear->places : linear->count;
    }
    for (int i = 0; i < code->fast_count - linear->clocks; ++i)
        add_number(pool, linear, code->state[code->slow_count + i].name, 1, 1);
    linear->slips = pool_alloc(pool, (size_t)linear->count + 1);
    linear->jumps = pool_alloc(pool, (size_t)linear->count + 1);
    describe_wheels(linear);
}

Linear *linear_open(Pool *pool, const Engine *engine)
{
    const TapeEngine *tape = engine->context;
    const Formulation *f = tape->formulation;
    Linear *linear = pool_alloc(pool, sizeof *linear);
    int bodies = 0;
    for (int c = 0; c < f->sequence->classes; ++c)
        bodies = tape->class[c].layout->bodies > bodies ? tape->class[c].layout->bodies : bodies;
    *linear = (Linear){.engine = tape, .journal = journal_new(pool)};
    for (int side = 0; side < 2; ++side) {
        linear->links[side] = pool_alloc(pool, sizeof *linear->links[side]);
        *linear->links[side] = tape_links_new(pool, f);
        linear->step[side] = pool_alloc(pool, 2 * sizeof(double));
        linear->euler[side] = pool_alloc(pool, 4 * sizeof(double));
    }
    name_numbers(pool, linear);
    const size_t states = (size_t)(tape->code.slow_count + tape->code.fast_count + 1);
    const size_t results =
        states + (size_t)(tape->code.output_count > tape->code.contact_count ? tape->code.output_count
                                                                             : tape->code.contact_count);
    linear->value = (Instance *)(void *)instance_new(pool, engine);
    linear->slope = (Instance *)(void *)instance_new(pool, engine);
    linear->frame = pool_alloc(pool, (size_t)(tape->slots + 1) * sizeof(double));
    linear->q = pool_alloc(pool, (size_t)(7 * bodies + 1) * sizeof(double));
    linear->along = (Direction){.y = pool_alloc(pool, states * sizeof(double)),
                                .time = pool_alloc(pool, sizeof(double)),
                                .u = pool_alloc(pool, (size_t)(tape->code.input_count + 1) * sizeof(double)),
                                .port = pool_alloc(pool, (size_t)(tape->code.port_count + 1) * sizeof(double)),
                                .p = pool_alloc(pool, (size_t)(tape->code.parameter_count + 1) * sizeof(double))};
    linear->evaluated = pool_alloc(pool, states * sizeof(double));
    linear->rate = pool_alloc(pool, results * sizeof(double));
    linear->drate = pool_alloc(pool, results * sizeof(double));
    linear->results = (int)results;
    linear->choices = f->model->powertrain ? 2 * f->model->powertrain->forward : 0;
    for (int side = 0; side < 2; ++side) {
        linear->choice[side] = pool_alloc(pool, (size_t)(linear->choices + 1) * sizeof(double));
        linear->link[side] = pool_alloc(pool, (size_t)(tape->code.link_count + 1) * sizeof(double));
    }
    return linear;
}
