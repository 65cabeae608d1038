/* SPDX-License-Identifier: MIT
 * Dead centres: from the last good state the bodies of the lost subset go on along the motion that their joints leave
 * when one coordinate is let go. Where this coordinate turns back, it stops being independent, and any joint that goes
 * on turning there offers a coordinate in its place. Where the joints themselves lose a rank, two motions cross, and no
 * coordinate tells them apart. */
#include "base/text.h"
#include "base/vec3.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/dead_centre.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "world/world.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <math.h>
#include <string.h>

enum {
    NEAR = 60,   /* usual steps in which the dead centre must be found */
    CLOSE = 60,  /* shorter steps towards it */
    ROUND = 800, /* steps after it in which other coordinates are watched */
    CORRECTIONS = 12,
    SHORTENINGS = 40,   /* of two usual steps, in which the smallest pivot is least */
    UNKNOWNS_MOST = 280 /* larger mechanisms take too long */
};

static const double usual_step = 0.02;   /* rad, or relative to the size of the mechanism */
static const double close_enough = 1e-7; /* the same, from a dead centre */
static const double crossing = 1e-4;     /* smallest pivot there below which more than the coordinate is lost */

/* The relative motion in a joint after the dead centre. */
typedef struct Candidate {
    double rate, last; /* at the dead centre, and at the last step */
    int turns;         /* number of times that it turned back */
} Candidate;

typedef struct Search {
    Pool *pool;
    World *world;
    const Subset *subset; /* the moving bodies: the lost subset with all subsets that it depends on */
    const Subset *lost;
    int n;                /* unknowns: BODY_Q a body */
    int released;         /* the coordinate whose row is left out */
    double *A, *t, *b;    /* [n][n], motion that is left [n], scratch [n] */
    int sign;             /* signs of the determinant of all rows but the released one's, and t */
    double least;         /* smallest pivot of the same, of rows of size 1 */
    Candidate *candidate; /* [joints of the subset] */
} Search;

static int local_of(const Subset *subset, int body)
{
    for (int i = 0; i < subset->bodies; ++i)
        if (subset->body[i] == body)
            return i;
    return -1;
}

/* Solve A x = b, overwriting both; rows of A have size 1. Returns the sign of the determinant, 0: singular. *least: the
 * smallest pivot. */
static int solve(int n, double *A, double *b, double *least)
{
    int sign = 1;
    *least = 1;
    for (int k = 0; k < n; ++k) {
        int best = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(A[n * i + k]) > fabs(A[n * best + k]))
                best = i;
        *least = fmin(*least, fabs(A[n * best + k]));
        if (!(*least > 1e-13))
            return 0;
        for (int j = 0; best != k && j < n; ++j) {
            const double swap = A[n * k + j];
            A[n * k + j] = A[n * best + j], A[n * best + j] = swap;
        }
        const double swap = b[k];
        b[k] = b[best], b[best] = swap;
        sign *= (best != k ? -1 : 1) * (A[n * k + k] < 0 ? -1 : 1);
        for (int i = k + 1; i < n; ++i) {
            const double factor = A[n * i + k] / A[n * k + k];
            for (int j = k; factor != 0 && j < n; ++j)
                A[n * i + j] -= factor * A[n * k + j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j)
            b[k] -= A[n * k + j] * b[j];
        b[k] /= A[n * k + k];
    }
    return sign;
}

/* One row of a tie over the subset's unknowns, lengths relative to the size; returns its value. */
static double row_of(const Search *search, const Tie *tie, int r, double *row)
{
    const World *world = search->world;
    const double *J = world->J + ROW_J * tie->first + BODY_Q * r;
    double largest = 0;
    memset(row, 0, sizeof *row * (size_t)search->n);
    for (int end = 0; end < 2; ++end, J += BODY_Q * tie->rows) {
        const int local = local_of(search->subset, tie->body[end]);
        for (int i = 0; local >= 0 && i < BODY_Q; ++i) {
            row[BODY_Q * local + i] = J[i] * (i < 3 ? world->size : 1);
            largest = fmax(largest, fabs(row[BODY_Q * local + i]));
        }
    }
    for (int i = 0; largest > 0 && i < search->n; ++i)
        row[i] /= largest;
    return largest > 0 ? world->value[tie->first + r] / largest : 0;
}

/* A: all rows of the subset but the released coordinate's, normalizations, and t last; b: their residuals. Returns the
 * largest residual. */
static double fill(const Search *search)
{
    World *world = search->world;
    const int n = search->n;
    double worst = 0;
    int row = 0;
    for (int t = 0; t < search->subset->joints + search->subset->coordinates; ++t) {
        const int c = t < search->subset->joints ? -1 : search->subset->coordinate[t - search->subset->joints];
        if (c >= 0 && c == search->released)
            continue;
        const int index = c < 0 ? search->subset->joint[t] : world->coordinate_tie[c];
        world_rows(world, index);
        for (int r = 0; r < world->tie[index].rows; ++r, ++row) {
            search->b[row] = -row_of(search, &world->tie[index], r, search->A + n * row);
            worst = fmax(worst, fabs(search->b[row]));
        }
    }
    for (int i = 0; i < search->subset->bodies; ++i, ++row) {
        memset(search->A + n * row, 0, sizeof *search->A * (size_t)n);
        memcpy(search->A + n * row + BODY_Q * i + 3, world->q[search->subset->body[i]] + 3, 4 * sizeof *search->A);
        search->b[row] = 0;
    }
    memcpy(search->A + n * row, search->t, sizeof *search->A * (size_t)n);
    search->b[row] = 0;
    return worst;
}

static void move(const Search *search, const double *change, double factor)
{
    for (int i = 0; i < search->subset->bodies; ++i) {
        double dq[BODY_Q];
        for (int k = 0; k < BODY_Q; ++k)
            dq[k] = factor * change[BODY_Q * i + k] * (k < 3 ? search->world->size : 1);
        world_move(search->world, search->subset->body[i], dq);
    }
}

/* Compute t anew, of length 1, on the side of the present one. Returns the sign of the determinant; 0: there is no
 * unique motion. */
static int tangent(Search *search)
{
    const int n = search->n;
    double square = 0;
    fill(search);
    memset(search->b, 0, sizeof *search->b * (size_t)n);
    search->b[n - 1] = 1;
    const int sign = solve(n, search->A, search->b, &search->least);
    for (int i = 0; i < n; ++i)
        square += search->b[i] * search->b[i];
    if (!sign || !(square > 0) || !isfinite(square))
        return 0;
    for (int i = 0; i < n; ++i)
        search->t[i] = search->b[i] / sqrt(square);
    return sign;
}

/* Rate of the released coordinate along t; *value: its value, near the former one. */
static double speed(const Search *search, double *value)
{
    World *world = search->world;
    double out[2];
    for (int b = 0; b < world->bodies; ++b) {
        const int local = local_of(search->subset, b);
        double rate[BODY_Q];
        for (int i = 0; i < BODY_Q; ++i)
            rate[i] = local < 0 ? 0 : search->t[BODY_Q * local + i] * (i < 3 ? world->size : 1);
        world_set_rate(world, b, rate);
    }
    world_coordinate(world, search->released, *value, out);
    *value = out[0];
    return out[1];
}

static void save(const Search *search, double *place, bool back)
{
    for (int i = 0; i < search->subset->bodies; ++i, place += BODY_Q)
        if (back)
            world_set_q(search->world, search->subset->body[i], place);
        else
            memcpy(place, search->world->q[search->subset->body[i]], BODY_Q * sizeof *place);
    for (int i = 0; i < search->n; ++i, ++place)
        if (back)
            search->t[i] = *place;
        else
            *place = search->t[i];
}

/* One step along t, back to where all rows hold. Returns the sign of the determinant, 0: lost. */
static int step_on(Search *search, double length)
{
    move(search, search->t, length);
    for (int i = 0; i < CORRECTIONS; ++i) {
        const double worst = fill(search);
        if (worst < 1e-11)
            break;
        if (!(worst < 1) || !solve(search->n, search->A, search->b, &search->least))
            return 0;
        move(search, search->b, 1);
    }
    return fill(search) < 1e-9 ? tangent(search) : 0;
}

/* Choose the sign of t with which the released coordinate moves in `direction`. */
static bool set_out(Search *search, double direction, double *value)
{
    const int n = search->n, c = search->released;
    World *world = search->world;
    world_rows(world, world->coordinate_tie[c]);
    row_of(search, &world->tie[world->coordinate_tie[c]], 0, search->t);
    if (!tangent(search))
        return false;
    if (speed(search, value) * direction < 0)
        for (int i = 0; i < n; ++i)
            search->t[i] = -search->t[i];
    search->sign = tangent(search);
    return search->sign != 0;
}

/* Relative rate in a joint along t: of a turn about its axis, or of sliding; *sliding tells which. */
static double joint_rate(const Search *search, int joint, bool *sliding)
{
    World *world = search->world;
    const Joint *j = &world->model->joint[joint];
    const int a = j->body[0], b = j->body[1];
    double axis[3], turn[3], arm[2][3], way[3], velocity[2][3];
    *sliding = j->type == JOINT_PRISMATIC;
    if (j->type != JOINT_REVOLUTE && j->type != JOINT_PRISMATIC)
        return 0;
    apply3(world->A[a], j->axis[0], axis);
    sub3(world->omega[b], world->omega[a], turn);
    if (!*sliding)
        return dot3(axis, turn);
    for (int end = 0; end < 2; ++end) {
        const int body = j->body[end];
        apply3(world->A[body], world->tie[joint].arm[end], arm[end]);
        cross3(world->omega[body], arm[end], velocity[end]);
        add3(velocity[end], world->qd[body], velocity[end]);
    }
    sub3(velocity[1], velocity[0], way);
    return dot3(axis, way) / world->size;
}

/* Watch all joints from here on, once around if the motion is closed. */
static void watch_joints(Search *search, double value)
{
    const Subset *subset = search->subset;
    bool sliding;
    for (int k = 0; k < ROUND; ++k) {
        speed(search, &value);
        for (int i = 0; i < subset->joints; ++i) {
            Candidate *candidate = &search->candidate[i];
            const double rate = joint_rate(search, subset->joint[i], &sliding);
            if (k == 0)
                candidate->rate = rate;
            else if (rate * candidate->last < 0)
                ++candidate->turns;
            candidate->last = rate;
        }
        if (!step_on(search, usual_step))
            return;
    }
}

/* True if the joint connects to a body that stands still here: its coordinate then determines one body only. */
static bool outermost(const Search *search, int i)
{
    const int *body = search->world->model->joint[search->subset->joint[i]].body;
    return local_of(search->subset, body[0]) < 0 || local_of(search->subset, body[1]) < 0;
}

static bool better(const Search *search, int i, int j)
{
    const Candidate *one = &search->candidate[i], *other = &search->candidate[j];
    if (one->turns != other->turns)
        return one->turns < other->turns;
    if (outermost(search, i) != outermost(search, j))
        return outermost(search, i);
    return fabs(one->rate) > fabs(other->rate);
}

/* The joint whose coordinate to propose; -1: none. */
static int best_joint(const Search *search)
{
    const double least = 0.02;
    int best = -1;
    for (int i = 0; i < search->subset->joints; ++i)
        if (fabs(search->candidate[i].rate) > least && (best < 0 || better(search, i, best)))
            best = i;
    return best;
}

static double tidy(double x)
{
    return fabs(x) < 1e-9 ? 0 : x;
}

static const char *replacement(const Search *search, int joint)
{
    const Model *model = search->world->model;
    const Joint *j = &model->joint[joint];
    double A[9], axis[3];
    mat_from_euler(model->body[j->body[0]].euler, A);
    apply3(A, j->axis[0], axis);
    return pool_print(search->pool, "{type: %s, bodies: [%s, %s], axis: [%.6g, %.6g, %.6g]}",
                      j->type == JOINT_PRISMATIC ? "translation" : "angle", model->body[j->body[0]].name,
                      model->body[j->body[1]].name, tidy(axis[0]), tidy(axis[1]), tidy(axis[2]));
}

static const char *names(const Search *search)
{
    Text text = {.pool = search->pool};
    for (int i = 0; i < search->lost->bodies; ++i)
        text_print(&text, "%s'%s'", i ? ", " : "", search->world->model->body[search->lost->body[i]].name);
    return text.s;
}

/* The finding if the coordinate turned back at `value`. */
static DeadCentre turned_back(Search *search, double value)
{
    Pool *pool = search->pool;
    const Model *model = search->world->model;
    const Coordinate *c = &model->coordinate[search->released];
    watch_joints(search, value);
    const int best = best_joint(search);
    DeadCentre found = {
        .finding =
            pool_print(pool,
                       "a dead centre at '%s' = %.6g %s, which it does not pass: two assemblies meet there, and the "
                       "coordinate stops determining %s",
                       c->name, value, c->type == COORDINATE_ANGLE ? "rad" : "m", names(search)),
        .remedy = pool_print(pool, "keep '%s' on this side of %.6g", c->name, value)};
    if (best >= 0 && !c->driven)
        found.remedy =
            pool_print(pool,
                       "to go on there, make '%s' a coordinate that %s: `%s: %s`; else keep it on this side "
                       "of %.6g",
                       c->name, search->candidate[best].turns ? "does not turn back there" : "never turns back",
                       c->name, replacement(search, search->subset->joint[best]), value);
    return found;
}

/* The finding if the rows stop determining the motion. With a single coordinate in the subset two motions of the
 * mechanism cross there. With several, coordinates may depend on each other, such as angles whose axes become parallel.
 */
static DeadCentre crossed(const Search *search, double value)
{
    Pool *pool = search->pool;
    const Model *model = search->world->model;
    const Coordinate *c = &model->coordinate[search->released];
    const char *unit = c->type == COORDINATE_ANGLE ? "rad" : "m";
    if (search->lost->coordinates > 1) {
        Text all = {.pool = pool};
        for (int i = 0; i < search->lost->coordinates; ++i)
            text_print(&all, "%s'%s'", i ? ", " : "", model->coordinate[search->lost->coordinate[i]].name);
        return (DeadCentre){
            .finding =
                pool_print(pool, "a singular configuration at '%s' = %.6g %s: there coordinates %s stop determining %s",
                           c->name, value, unit, all.s, names(search)),
            .remedy = pool_print(pool,
                                 "keep '%s' on this side of %.6g, or choose other coordinates, such as angles whose "
                                 "axes do not fall onto each other there",
                                 c->name, value)};
    }
    return (DeadCentre){
        .finding = pool_print(pool,
                              "a change point at '%s' = %.6g %s: two motions of %s cross there, and no coordinate "
                              "tells which of them goes on",
                              c->name, value, unit, names(search)),
        .remedy = pool_print(pool,
                             "make the links' lengths differ, the one that '%s' moves a little shorter, so that the "
                             "motions part, or keep '%s' on this side of %.6g",
                             c->name, c->name, value)};
}

/* A place on the way, and the search that it is of. */
typedef struct From {
    Search *search;
    double *place; /* as save() has it */
    double value;  /* of the released coordinate */
} From;

/* The smallest pivot `length` further on. */
static double least_at(double length, void *context)
{
    const From *from = context;
    save(from->search, from->place, true);
    return step_on(from->search, length) ? from->search->least : 0;
}

/* Where two ranks are lost at once, as of equal parallel arms that become vertical, the determinant touches 0 and keeps
 * its sign. True if it does so between `from` and two steps on, where the pivot after one step is smaller than at both
 * ends, at *value. */
static bool touches(From *from, double *value)
{
    gsl_function least = {least_at, from};
    gsl_min_fminimizer *search = gsl_min_fminimizer_alloc(gsl_min_fminimizer_goldensection);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    double smallest = INFINITY;
    if (search && !gsl_min_fminimizer_set(search, &least, usual_step, 0, 2 * usual_step))
        for (int k = 0; k < SHORTENINGS && !gsl_min_fminimizer_iterate(search); ++k)
            smallest = gsl_min_fminimizer_f_minimum(search);
    if (smallest < crossing) {
        /* poses are known to the root of the residual only there: from beside it, where the pivot is a straight line */
        const double x = gsl_min_fminimizer_x_minimum(search), beside = usual_step / 20;
        double at[2] = {from->value, from->value};
        const double before = least_at(x - beside, from);
        speed(from->search, &at[0]);
        const double after = least_at(x + beside, from);
        speed(from->search, &at[1]);
        *value = (at[0] * after + at[1] * before) / (before + after);
    }
    gsl_set_error_handler(handler);
    if (search)
        gsl_min_fminimizer_free(search);
    return smallest < crossing;
}

/* Search along one coordinate. direction: sign of its rate, 0: both; *value: where the coordinate is, and where it is
 * at the finding. */
static DeadCentre look_ahead(Search *search, double direction, double *value)
{
    double place[2 * search->n], earlier[2 * search->n], length = usual_step;
    DeadCentre none = {NULL, NULL};
    if (!set_out(search, direction, value))
        return none;
    double before = speed(search, value), least[2] = {0, search->least};
    From from = {search, earlier, *value};
    /* A place that stopped a step lies within that step: four of a quarter are stopped again. Where they pass, what
     * stopped the long one was its length. */
    for (int usual = 0, shorter = 0, passed = 0; usual < NEAR && shorter < CLOSE;) {
        const double here = *value;
        save(search, place, false);
        const int sign = step_on(search, length);
        const double now = speed(search, value);
        if (sign && sign * search->sign > 0 && now * before > 0) {
            double there[2 * search->n];
            save(search, there, false);
            const double further = *value, pivot = search->least;
            if (length == usual_step && least[1] < least[0] && least[1] < pivot && touches(&from, value))
                return crossed(search, *value);
            save(search, there, true);
            memcpy(earlier, place, sizeof earlier);
            from.value = here;
            *value = further;
            least[0] = least[1];
            least[1] = pivot;
            before = now;
            ++*(length < usual_step ? &shorter : &usual);
            if (length < usual_step && ++passed > 4)
                length *= 4, passed = 0;
            if (length < usual_step)
                least[0] = least[1] = 0;
            continue;
        }
        passed = 0;
        const bool cross = sign * search->sign <= 0 || search->least < crossing;
        save(search, place, true);
        *value = here;
        if (length < close_enough)
            return cross ? crossed(search, here) : turned_back(search, here);
        length /= 4;
    }
    return none;
}

/* Set the World to the state of the instance; false: its joints do not fit, as after a change of parameters. */
static bool place_world(World *world, const gic_model *code, gic_head *last, double *rate)
{
    const Model *model = world->model;
    double pose[BODY_Q * code->body_count];
    if (code->body_count != model->bodies || code->coordinate_count != model->coordinates ||
        code->poses(last, pose) != GIC_OK)
        return false;
    for (int b = world->first; b < world->bodies; ++b) {
        double q[BODY_Q], A[9];
        memcpy(q, pose + BODY_Q * b, sizeof q);
        mat_from_euler(q + 3, A);
        apply3(A, model->body[b].com, q);
        add3(q, pose + BODY_Q * b, q);
        world_set_q(world, b, q);
    }
    const double *state = instance_array(last, code->state_offset), *input = instance_array(last, code->input_offset);
    for (int c = 0; c < model->coordinates; ++c) {
        const int at = code->coordinate_state[c], given = code->coordinate_input[c];
        double out[2];
        world_coordinate(world, c, at >= 0 ? state[at] : input[given], out);
        world->x[c] = out[0];
        rate[c] = at >= 0 ? state[at + code->slow_count / 2] : input[given + 1];
    }
    return world_residual(world) < 1e-5;
}

static void gather_ints(Pool *pool, int **list, int *count, const int *more, int added)
{
    int *all = pool_alloc(pool, (size_t)(*count + added + 1) * sizeof *all);
    memcpy(all, *list ? *list : all, (size_t)*count * sizeof *all);
    memcpy(all + *count, more, (size_t)added * sizeof *all);
    *list = all;
    *count += added;
}

/* The lost subset and all subsets that it depends on, as one. */
static Subset gather(Pool *pool, const Sequence *sequence, int lost)
{
    Subset all = {.class = 0};
    bool wanted[sequence->subsets];
    memset(wanted, 0, sizeof wanted);
    wanted[lost] = true;
    for (int s = lost; s >= 0; --s) { /* in computational order: subsets come after those they depend on */
        const Subset *subset = &sequence->subset[s];
        if (!wanted[s] || subset->class < 0)
            continue;
        for (int i = 0; i < subset->knowns; ++i)
            wanted[sequence->body_subset[subset->known[i]]] = true;
        gather_ints(pool, &all.body, &all.bodies, subset->body, subset->bodies);
        gather_ints(pool, &all.joint, &all.joints, subset->joint, subset->joints);
        gather_ints(pool, &all.coordinate, &all.coordinates, subset->coordinate, subset->coordinates);
    }
    return all;
}

static void search_subset(Search *search, const Subset *subset, int coordinate)
{
    const size_t n = (size_t)(BODY_Q * subset->bodies);
    search->subset = subset;
    search->released = coordinate;
    search->n = (int)n;
    search->A = pool_alloc(search->pool, n * n * sizeof *search->A);
    search->b = pool_alloc(search->pool, n * sizeof *search->b);
    search->t = pool_alloc(search->pool, n * sizeof *search->t);
    search->candidate = pool_alloc(search->pool, (size_t)(subset->joints + 1) * sizeof *search->candidate);
}

DeadCentre dead_centre_find(Pool *pool, const Model *model, const gic_model *code, gic_head *last, int subset)
{
    const DeadCentre none = {NULL, NULL};
    const Sequence *sequence = sequence_find(pool, model);
    if (subset < 0 || subset >= sequence->subsets || sequence->subset[subset].class < 0 || model_massless(model))
        return none;
    const Subset *lost = &sequence->subset[subset], all = gather(pool, sequence, subset);
    if (BODY_Q * all.bodies > UNKNOWNS_MOST)
        return none;
    Search search = {
        .pool = pool, .world = world_new(pool, model_assemble(pool, model, sequence), sequence), .lost = lost};
    DeadCentre found = none;
    double rate[model->coordinates + 1], soonest = INFINITY;
    /* Of coordinates that move the one that is there first; of those at rest any, where no other finds one. */
    for (int k = 0; k < 3 * lost->deps && (k < lost->deps || !found.finding); ++k) {
        const int c = lost->dep[k % lost->deps];
        if (!place_world(search.world, code, last, rate))
            return none;
        if ((rate[c] != 0) != (k < lost->deps))
            continue;
        search_subset(&search, &all, c);
        double value = search.world->x[c];
        const DeadCentre one = look_ahead(&search, rate[c] != 0 ? rate[c] : k < 2 * lost->deps ? 1 : -1, &value);
        const double time = rate[c] != 0 ? (value - search.world->x[c]) / rate[c] : 0;
        if (one.finding && time < soonest) {
            found = one;
            soonest = time;
        }
    }
    return found;
}
