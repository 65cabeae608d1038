/* SPDX-License-Identifier: MIT
 * Redundant joints. A row of a joint is a screw: a force along a line or a couple between its two bodies. The rank
 * of all screws at several assembled configurations tells how many equations of a joint are independent of the
 * others'; another type is proposed if its screws give the same rank at each configuration. */
#include "base/message.h"
#include "base/text.h"
#include "base/vec3.h"
#include "model/model.h"
#include "sequence/redundant.h"
#include "sequence/screws.h"

#include <math.h>
#include <string.h>

enum {
    DIRECTIONS = 16, /* tried for the axis of a joint */
    BODIES_MOST = 24 /* larger parts take too long */
};

static const double clearly_better = 4; /* required ratio of the distance from singular to that of another joint */
static const double better = 1.05;      /* the same for a coordinate: the axis of the motion itself is best */

/* ---- the mechanism --------------------------------------------------------------------------------------- */

static void to_model(const Model *model, int body, const double x[3], bool point, double out[3])
{
    memcpy(out, x, 3 * sizeof *out);
    if (body == BODY_GROUND)
        return;
    double A[9];
    mat_from_euler(model->body[body].euler, A);
    apply3(A, x, out);
    for (int i = 0; point && i < 3; ++i)
        out[i] += model->body[body].position[i];
}

static Link link_new(const Model *model, const int *local, const int body[2], const double point[2][3],
                     const double axis0[3], const double axis1[3])
{
    Link link = {.body = {0}};
    for (int end = 0; end < 2; ++end) {
        link.owner[end] = body[end];
        link.body[end] = body[end] == BODY_GROUND ? -1 : local[body[end]];
        to_model(model, body[end], point[end], true, link.point[end]);
    }
    to_model(model, body[0], axis0, false, link.axis[0]);
    to_model(model, axis1 == axis0 ? body[0] : body[1], axis1, false, link.axis[1]);
    return link;
}

static Link link_of(const Model *model, const int *local, int edge)
{
    static const double z[3] = {0, 0, 1};
    if (edge < model->joints) {
        const Joint *j = &model->joint[edge];
        const bool plain = norm3(j->axis[0]) < 0.5;
        Link link = link_new(model, local, j->body, j->point, plain ? z : j->axis[0],
                             plain || norm3(j->axis[1]) < 0.5 ? (plain ? z : j->axis[0]) : j->axis[1]);
        link.type = j->type;
        if (j->type == JOINT_RACK_AND_PINION)
            to_model(model, j->body[0], j->side[0], false, link.axis[1]);
        link.length = j->length;
        link.offset = j->offset;
        link.coordinate = joint_is_coupled(j->type); /* it holds bodies as one does */
        link.kind = link.coordinate ? (CoordinateType)joint_measure(j->type) : COORDINATE_LENGTH;
        return link;
    }
    const Coordinate *c = &model->coordinate[edge - model->joints];
    const double *axis = norm3(c->axis) < 0.5 ? z : c->axis;
    Link link = link_new(model, local, c->body, c->point, axis, axis);
    link.coordinate = true;
    link.kind = c->type;
    return link;
}

static bool make_links(Relax *relax, const bool *body, const bool *edge)
{
    const Model *model = relax->model;
    int local[model->bodies + 1], count = 0;
    for (int i = 0; i < model->bodies; ++i)
        local[i] = body[i] ? relax->bodies++ : -1;
    for (int i = 0; i < model->joints + model->coordinates; ++i)
        count += edge[i];
    relax->n = BODY_TWIST * relax->bodies;
    relax->index = pool_alloc(relax->pool, (size_t)(count + 1) * sizeof *relax->index);
    relax->link = pool_alloc(relax->pool, (size_t)(count + relax->n + 1) * sizeof *relax->link);
    for (int i = 0, k = 0; i < model->joints + model->coordinates; ++i)
        if (edge[i]) {
            if (i < model->joints && !model->joint[i].drawn)
                return false;
            relax->index[k] = i;
            relax->link[k++] = link_of(model, local, i);
            ++*(i < model->joints ? &relax->joints : &relax->coordinates);
        }
    for (int i = 0; i < relax->joints; ++i)
        for (int k = 0; k < 3; ++k)
            relax->centre[k] += relax->link[i].point[1][k] / relax->joints;
    for (int i = 0; i < relax->joints; ++i)
        for (int k = 0; k < 3; ++k)
            relax->size = fmax(relax->size, fabs(relax->link[i].point[1][k] - relax->centre[k]));
    if (!(relax->size > 1e-9))
        relax->size = 1;
    const size_t rows = (size_t)(ROWS_MOST * (count + 2) + relax->n), n = (size_t)relax->n;
    relax->gone = pool_alloc(relax->pool, (size_t)relax->joints + 1);
    relax->changed = pool_alloc(relax->pool, (size_t)relax->joints + 1);
    relax->A = pool_alloc(relax->pool, rows * n * sizeof(double));
    relax->N = pool_alloc(relax->pool, n * n * sizeof(double));
    relax->b = pool_alloc(relax->pool, n * sizeof(double));
    return relax->joints > 0;
}

/* ---- candidates ------------------------------------------------------------------------------------------ */

static void add_direction(double (*direction)[3], int *count, const double way[3])
{
    const double norm = norm3(way);
    if (!(norm > 1e-9) || *count == DIRECTIONS)
        return;
    for (int i = 0; i < *count; ++i) {
        double cross[3];
        cross3(direction[i], way, cross);
        if (norm3(cross) < 1e-6 * norm)
            return;
    }
    int first = 0;
    while (fabs(way[first]) < 1e-6 * norm)
        ++first;
    for (int i = 0; i < 3; ++i)
        direction[*count][i] = way[i] / (way[first] < 0 ? -norm : norm);
    ++*count;
}

/* Candidate directions for an axis at a joint: its own, the model's axes, lines to other joints, axes of other joints.
 */
static int directions(const Relax *relax, const Link *link, double (*direction)[3])
{
    int count = 0;
    if (!link->coordinate && screws_have(link->type, "acdehijkl"))
        for (int end = 0; end < 2; ++end)
            add_direction(direction, &count, link->axis[end]);
    for (int i = 0; i < relax->joints; ++i) { /* the line between the two ball joints of a body */
        const Link *other = &relax->link[i];
        if (other == link || other->type != JOINT_SPHERICAL || link->type != JOINT_SPHERICAL)
            continue;
        const double way[3] = {link->point[0][0] - other->point[0][0], link->point[0][1] - other->point[0][1],
                               link->point[0][2] - other->point[0][2]};
        add_direction(direction, &count, way);
    }
    for (int i = 0; i < relax->joints; ++i)
        if (screws_have(relax->link[i].type, "acd"))
            add_direction(direction, &count, relax->link[i].axis[0]);
    for (int i = 0; i < 3; ++i) {
        double e[3] = {0};
        e[i] = 1;
        add_direction(direction, &count, e);
    }
    return count;
}

/* True if the rows of `other` are dependent on those of the joints, so that it removes no further motion; always true
 * if motions are to be removed. */
static bool implied(const Relax *relax, const Link *other, const int *rank)
{
    double least;
    for (int c = 0; c < relax->configurations && relax->counted == relax->joints; ++c)
        if (screws_rank(relax, c, relax->joints, -1, other, &least) != rank[c])
            return false;
    return true;
}

/* Distance of the rows from singular with `other` in place of link `without`; 0 if they do not have rank[] everywhere.
 */
static double quality(const Relax *relax, int count, int without, const Link *other, const int *rank)
{
    double worst = 1, least;
    for (int c = 0; c < relax->configurations; ++c) {
        if (screws_rank(relax, c, count, without, other, &least) != rank[c])
            return 0;
        worst = fmin(worst, least);
    }
    return worst;
}

static void take_better(Link *best, double *best_quality, const Link *candidate, double its_quality, double factor)
{
    if (its_quality > factor * *best_quality) {
        *best = *candidate;
        *best_quality = its_quality;
    }
}

/* Find the best type with `needed` equations in place of joint k; false: there is none. */
static bool replace(Relax *relax, int k, int needed, const int *rank)
{
    static const JointType order[] = {JOINT_POINT_ON_LINE, JOINT_SPHERICAL,     JOINT_CYLINDRICAL,
                                      JOINT_UNIVERSAL,     JOINT_REVOLUTE,      JOINT_POINT_IN_PLANE,
                                      JOINT_PARALLEL,      JOINT_PERPENDICULAR, JOINT_PRISMATIC};
    const Link *own = &relax->link[k];
    double direction[DIRECTIONS][3], best_quality = 0;
    const int count = directions(relax, own, direction);
    const bool placed = screws_have(own->type, "abcdefij");
    Link best = *own;
    for (size_t t = 0; t < sizeof order / sizeof *order; ++t) {
        if (joint_equations[order[t]] != needed || (!placed && !screws_have(order[t], "kl")))
            continue;
        const bool two = screws_have(order[t], "el"), any = order[t] != JOINT_SPHERICAL;
        for (int i = 0; i < (any ? count : 1); ++i)
            for (int j = 0; j < (two ? count : 1); ++j) {
                Link candidate = *own;
                candidate.type = order[t];
                memcpy(candidate.axis[0], direction[i], sizeof direction[i]);
                memcpy(candidate.axis[1], direction[two ? j : i], sizeof direction[i]);
                if ((two && fabs(dot3(direction[i], direction[j])) > 1e-9) || !implied(relax, &candidate, rank))
                    continue;
                take_better(&best, &best_quality, &candidate, quality(relax, relax->counted, k, &candidate, rank),
                            clearly_better);
            }
    }
    if (!(best_quality > 0))
        return false;
    relax->link[k] = best;
    return true;
}

static int equations_left(const Relax *relax)
{
    int rows = 0;
    for (int i = 0; i < relax->joints; ++i)
        rows += relax->gone[i] ? 0 : joint_equations[relax->link[i].type];
    return rows;
}

/* Equations of joint k that are independent of the others, the maximum over all configurations. */
static int needed_of(const Relax *relax, int k, const int *rank)
{
    int needed = 0;
    double least;
    for (int c = 0; c < relax->configurations; ++c) {
        const int missing = rank[c] - screws_rank(relax, c, relax->counted, k, NULL, &least);
        needed = missing > needed ? missing : needed;
    }
    return needed;
}

/* True if joint k is a better choice than the best so far, which loses as many equations: a joint of one equation is
 * likely to be misplaced; else a joint that remains is better than one that is removed. */
static bool preferred(const Relax *relax, int k, int needed, int best, int best_needed)
{
    if (joint_equations[relax->link[best].type] == 1 || relax->counted > relax->joints)
        return false;
    return joint_equations[relax->link[k].type] == 1 || (!best_needed && needed);
}

/* Weaken the joint that can lose most equations, the last one of equals. */
static bool relax_once(Relax *relax, const int *rank)
{
    bool tried[relax->joints + 1];
    memset(tried, 0, sizeof tried);
    for (;;) {
        int best = -1, best_drop = 0, best_needed = 0;
        for (int k = relax->joints - 1; k >= 0; --k) {
            if (tried[k] || relax->gone[k])
                continue;
            const int needed = needed_of(relax, k, rank), drop = joint_equations[relax->link[k].type] - needed;
            if (drop > best_drop || (drop && drop == best_drop && preferred(relax, k, needed, best, best_needed)))
                best = k, best_drop = drop, best_needed = needed;
        }
        if (best < 0)
            return false;
        relax->gone[best] = !best_needed;
        if (!best_needed || replace(relax, best, best_needed, rank))
            return relax->changed[best] = true;
        tried[best] = true;
    }
}

/* ---- coordinates ----------------------------------------------------------------------------------------- */

/* A coordinate that determines one motion more than the rows before it; false: none is found. */
static bool find_coordinate(const Relax *relax, int count, const int *rank, Link *found)
{
    int wanted[relax->configurations];
    double best_quality = 0;
    for (int c = 0; c < relax->configurations; ++c)
        wanted[c] = rank[c] + 1;
    for (int k = 0; k < relax->joints; ++k) {
        const Link *joint = &relax->link[k];
        double direction[DIRECTIONS][3];
        const int ways = directions(relax, joint, direction);
        for (int kind = 0; kind < 2; ++kind)
            for (int i = 0; i < ways; ++i) {
                Link candidate = *joint;
                candidate.coordinate = true;
                candidate.kind = kind ? COORDINATE_TRANSLATION : COORDINATE_ANGLE;
                memcpy(candidate.axis[0], direction[i], sizeof direction[i]);
                memcpy(candidate.axis[1], direction[i], sizeof direction[i]);
                /* an angle is meant for bodies whose joint keeps its axis */
                const bool fits =
                    kind ? screws_have(joint->type, "cdghijkl") : !screws_have(joint->type, "ad") || i == 0;
                if (fits)
                    take_better(found, &best_quality, &candidate, quality(relax, count, -1, &candidate, wanted),
                                better);
            }
    }
    return best_quality > 0;
}

/* ---- text ------------------------------------------------------------------------------------------------ */

static double tidy(double x)
{
    return fabs(x) < 1e-9 ? 0 : x;
}

static void print_vector(Text *text, const char *key, const double x[3])
{
    text_print(text, "%s[%.9g, %.9g, %.9g]", key, tidy(x[0]), tidy(x[1]), tidy(x[2]));
}

/* Axes of the model frame are written as drawn, others with whole components if these are small. */
static void print_axis(Text *text, const char *key, const double axis[3])
{
    double least = 1, whole[3];
    for (int i = 0; i < 3; ++i)
        if (fabs(axis[i]) > 1e-6)
            least = fmin(least, fabs(axis[i]));
    for (int i = 0; i < 3; ++i) {
        whole[i] = axis[i] / least;
        if (fabs(whole[i] - nearbyint(whole[i])) > 1e-9 || fabs(whole[i]) > 9) {
            print_vector(text, key, axis);
            return;
        }
        whole[i] = nearbyint(whole[i]);
    }
    print_vector(text, key, whole);
}

static const char *body_name(const Model *model, int body)
{
    return body == BODY_GROUND ? "ground" : model->body[body].name;
}

static void print_entry(const Relax *relax, const Link *link, const char *name, Text *text)
{
    const char *type = !link->coordinate                ? joint_type_name[link->type]
                       : link->kind == COORDINATE_ANGLE ? "angle"
                                                        : "translation";
    text_print(text, "`%s: {type: %s, bodies: [%s, %s]", name, type, body_name(relax->model, link->owner[0]),
               body_name(relax->model, link->owner[1]));
    if (!link->coordinate && screws_have(link->type, "abdefij"))
        print_vector(text, ", point: ", link->point[1]);
    if (link->coordinate || screws_have(link->type, "acdijk"))
        print_axis(text, ", axis: ", link->axis[0]);
    if (!link->coordinate && screws_have(link->type, "el")) {
        print_axis(text, ", axes: [", link->axis[0]);
        print_axis(text, ", ", link->axis[1]);
        text_print(text, "]");
    }
    text_print(text, "}`");
}

static void print_joint(const Relax *relax, int k, Text *text)
{
    const Joint *joint = &relax->model->joint[relax->index[k]];
    text_print(text, "%s", text->size ? ", " : "");
    if (relax->gone[k]) {
        text_print(text, "remove joint '%s' (%s, %d)%s", joint->name, joint_type_name[joint->type],
                   joint_equations[joint->type],
                   relax->counted == relax->joints ? ": the others say all that it says" : "");
        return;
    }
    text_print(text, "make joint '%s' (%s, %d) a %s (%d): ", joint->name, joint_type_name[joint->type],
               joint_equations[joint->type], joint_type_name[relax->link[k].type],
               joint_equations[relax->link[k].type]);
    print_entry(relax, &relax->link[k], joint->name, text);
}

/* True if it is driven or a force acts along it: then it is unlikely to be a mistake. */
static bool used(const Model *model, int coordinate)
{
    bool any = model->coordinate[coordinate].driven;
    for (int i = 0; i < model->forces; ++i)
        any = any || model->force[i].coordinate == coordinate;
    return any;
}

/* True if there are more coordinates than motions at the design and none can be removed, or if no motion is left for
 * any: then a joint is stronger than intended. */
static bool joint_too_strong(const Relax *relax, int rank)
{
    const Model *model = relax->model;
    int spare = 0;
    for (int k = 0; k < relax->coordinates; ++k)
        spare += !used(model, relax->index[relax->joints + k] - model->joints);
    return relax->coordinates && (rank == relax->n || relax->coordinates - (relax->n - rank) > spare);
}

/* A name for the i-th additional coordinate. */
static const char *free_name(const Relax *relax, int i)
{
    const Model *model = relax->model;
    for (int number = i + 1;; ++number) {
        const char *name = pool_print(relax->pool, "added%d", number);
        bool taken = false;
        for (int c = 0; c < model->coordinates; ++c)
            taken = taken || !strcmp(model->coordinate[c].name, name);
        if (!taken)
            return name;
    }
}

/* Remove or change coordinates that determine no new motion; add one for each undetermined motion. */
static bool settle_coordinates(Relax *relax, int *rank, Text *text, Place *at)
{
    const Model *model = relax->model;
    int count = relax->joints, spare[relax->coordinates + 1], spares = 0, added = 0;
    Link own[relax->coordinates + 1];
    memcpy(own, relax->link + relax->joints, (size_t)relax->coordinates * sizeof *own);
    for (int i = 0; i < 2 * relax->coordinates; ++i) { /* first the coordinates that something refers to */
        const int k = i % relax->coordinates;
        if (used(model, relax->index[relax->joints + k] - model->joints) != (i < relax->coordinates))
            continue;
        relax->link[count] = own[k];
        int grown[relax->configurations];
        double least;
        bool good = true;
        for (int c = 0; c < relax->configurations; ++c) {
            grown[c] = screws_rank(relax, c, count + 1, -1, NULL, &least);
            good = good && (c || grown[c] > rank[c]); /* beyond the design the rank may grow */
        }
        if (!good) {
            spare[spares++] = relax->index[relax->joints + k] - model->joints;
            continue;
        }
        for (int c = 0; c < relax->configurations; ++c)
            rank[c] = rank[c] + 1;
        ++count;
        if (grown[relax->configurations - 1] != rank[relax->configurations - 1])
            relax->configurations = 1; /* singular somewhere on the walk: compare at the design only */
    }
    for (; rank[0] < relax->n; ++added) {
        Link found;
        if (!find_coordinate(relax, count, rank, &found)) {
            relax->configurations = 1; /* no type fits on the whole walk: try at the design only */
            if (!find_coordinate(relax, count, rank, &found))
                return false;
        }
        relax->link[count++] = found;
        for (int c = 0; c < relax->configurations; ++c)
            ++rank[c];
        const char *name = added < spares ? model->coordinate[spare[added]].name : free_name(relax, added);
        text_print(text, "%s%s coordinate '%s': ", text->size ? ", " : "", added < spares ? "change" : "add", name);
        print_entry(relax, &found, name, text);
        if (!at->source && added < spares)
            *at = model->coordinate[spare[added]].at;
    }
    for (int i = added; i < spares; ++i) {
        text_print(text, "%sremove dual coordinate '%s'%s", text->size ? ", " : "", model->coordinate[spare[i]].name,
                   count == relax->joints ? ": the joints leave no motion for it" : "");
        if (!at->source)
            *at = model->coordinate[spare[i]].at;
    }
    return true;
}

const char *relax_suggest(Pool *pool, const Model *model, const bool *body, const bool *edge, bool joints_stay,
                          Place *at)
{
    Relax relax = {.pool = pool, .model = model};
    Text text = {.pool = pool};
    int bodies = 0;
    double least;
    for (int i = 0; i < model->bodies; ++i)
        bodies += body[i];
    if (bodies > BODIES_MOST || !make_links(&relax, body, edge))
        return NULL;
    screws_walk(&relax);
    int rank[2 * WALK + 1];
    for (int c = 0; c < relax.configurations; ++c)
        rank[c] = screws_rank(&relax, c, relax.joints, -1, NULL, &least);
    relax.counted = relax.joints;
    if (joint_too_strong(&relax, rank[0])) {
        relax.counted += relax.coordinates;
        relax.configurations = 1;
        rank[0] = screws_rank(&relax, 0, relax.counted, -1, NULL, &least);
    }
    while (equations_left(&relax) + relax.counted - relax.joints > rank[0])
        if (joints_stay || !relax_once(&relax, rank))
            return NULL;
    Place place = {0};
    for (int k = 0; k < relax.joints; ++k)
        if (relax.changed[k]) {
            if (!place.source)
                place = model->joint[relax.index[k]].at;
            print_joint(&relax, k, &text);
        }
    if (relax.counted > relax.joints && text.size)
        text_print(&text, ", for the joints leave less motion than the coordinates need");
    if ((relax.counted == relax.joints && !settle_coordinates(&relax, rank, &text, &place)) || !text.size)
        return NULL;
    *at = place;
    return text.s;
}

/* ---- dead centres ---------------------------------------------------------------------------------------- */

enum {
    STEPS_TO = 200,   /* to the dead centre */
    STEPS_ROUND = 200 /* after it, while other joints are watched */
};

/* A joint's coordinate, and how it changes after the dead centre. */
typedef struct Serving {
    Link link;
    double rate, last;
    int turns;
    bool outermost; /* its joint is on a body that stands still, and it determines one body only */
} Serving;

/* True if a coordinate measures this joint's motion already. */
static bool is_told(const Model *model, const Link *joint, CoordinateType kind)
{
    for (int i = 0; i < model->coordinates; ++i) {
        const Coordinate *c = &model->coordinate[i];
        const bool same = c->body[0] == joint->owner[0] && c->body[1] == joint->owner[1];
        const bool crossed = c->body[0] == joint->owner[1] && c->body[1] == joint->owner[0];
        if (c->type == kind && (same || crossed))
            return true;
    }
    return false;
}

static int find_serving(const Relax *relax, int joints, Serving *serving)
{
    int count = 0;
    for (int i = 0; i < joints; ++i) {
        const Link *joint = &relax->link[i];
        if (joint->type != JOINT_REVOLUTE && joint->type != JOINT_PRISMATIC)
            continue;
        Serving one = {.link = *joint, .outermost = joint->body[0] < 0 || joint->body[1] < 0};
        one.link.coordinate = true;
        one.link.kind = joint->type == JOINT_REVOLUTE ? COORDINATE_ANGLE : COORDINATE_TRANSLATION;
        if (!is_told(relax->model, joint, one.link.kind))
            serving[count++] = one;
    }
    return count;
}

/* Walk on from the dead centre and record changes. */
static void watch(Relax *relax, Pose3 *place, double *way, Serving *serving, int count)
{
    for (int k = 0; k < STEPS_ROUND; ++k) {
        for (int i = 0; i < count; ++i) {
            const double rate = screws_speed(relax, &serving[i].link, place, way);
            if (k == 0)
                serving[i].rate = rate;
            serving[i].turns += k > 0 && rate * serving[i].last < 0;
            serving[i].last = rate;
        }
        if (!screws_step(relax, place, way))
            return;
    }
}

static bool serves_better(const Serving *one, const Serving *other)
{
    if (one->turns != other->turns)
        return one->turns < other->turns;
    if (one->outermost != other->outermost)
        return one->outermost;
    return fabs(one->rate) > fabs(other->rate);
}

/* Make the coordinate the last link and hold all others, as joints do. */
static bool release(Relax *relax, int coordinate)
{
    const int count = relax->joints + relax->coordinates;
    for (int i = relax->joints; i < count; ++i)
        if (relax->index[i] == relax->model->joints + coordinate) {
            const Link released = relax->link[i];
            memmove(relax->link + i, relax->link + i + 1, (size_t)(count - 1 - i) * sizeof released);
            relax->link[count - 1] = released;
            relax->joints = count - 1;
            return true;
        }
    return false;
}

const char *relax_instead(Pool *pool, const Model *model, const bool *body, const bool *edge, int coordinate,
                          double value, bool *always)
{
    Relax relax = {.pool = pool, .model = model};
    int bodies = 0;
    for (int i = 0; i < model->bodies; ++i)
        bodies += body[i];
    if (bodies > BODIES_MOST || !make_links(&relax, body, edge))
        return NULL;
    const int joints = relax.joints;
    if (!release(&relax, coordinate))
        return NULL;
    Serving serving[joints + 1];
    const int count = find_serving(&relax, joints, serving);
    const Link *released = &relax.link[relax.joints];
    Pose3 place[bodies + 1];
    double way[relax.n + 1], before = 0;
    for (int b = 0; b < bodies; ++b)
        place[b] = (Pose3){.A = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    memset(way, 0, sizeof way);
    screws_speed(&relax, released, place, way); /* leaves the coordinate's row in A */
    const double side = value < model->coordinate[coordinate].design ? -1 : 1;
    for (int i = 0; i < relax.n; ++i)
        way[i] = side * relax.A[i];
    for (int k = 0;; ++k) {
        if (k == STEPS_TO || !screws_step(&relax, place, way))
            return NULL;
        const double speed = screws_speed(&relax, released, place, way);
        if (speed * before < 0)
            break;
        before = speed;
    }
    watch(&relax, place, way, serving, count);
    const Serving *best = NULL;
    for (int i = 0; i < count; ++i)
        if (fabs(serving[i].rate) > 0.05 && (!best || serves_better(&serving[i], best)))
            best = &serving[i];
    if (!best)
        return NULL;
    Text text = {.pool = pool};
    print_entry(&relax, &best->link, model->coordinate[coordinate].name, &text);
    *always = !best->turns;
    return text.s;
}
