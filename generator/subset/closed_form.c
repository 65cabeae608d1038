/* SPDX-License-Identifier: MIT
 * Closed forms: the poses of a subset's bodies, found one after the other by geometry. For each body a point, then
 * a direction, then its rotation is found. Each step intersects a sphere with two planes: with one point of a body
 * known, a distance or a plane is an equation v . (A b) = k about a body-fixed vector b. Of the two intersections
 * the one on the side of the design is taken; the other one lies beyond a singular configuration. */
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/tunable.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

/* The known part of an unknown body's pose: body frame from the reference point on the left, base frame on the right.
 */
typedef struct KnownPose {
    bool anchored, triad, turned, placed;
    Ex s[3], x[3];             /* anchored: point s is at x */
    Ex own[3][3], known[3][3]; /* triad: own[0] is along known[0]; own[1], own[2] were along known[1], known[2] at the
                                * design */
    int arms;
    Ex arm[2][3], image[2][3]; /* vectors whose images are known */
} KnownPose;

/* An equation about an unknown body. */
typedef enum ScalarKind {
    SCALAR_PLANE,     /* normal . (x_s - x) = k */
    SCALAR_OWN_PLANE, /* (A normal) . (x - x_s) = k */
    SCALAR_SPHERE,    /* |x_s - x|^2 = k */
    SCALAR_DIRECTION  /* (A normal) . x = 0 */
} ScalarKind;

typedef struct Scalar {
    ScalarKind kind;
    const char *name; /* of the joint or coordinate */
    Ex s[3], normal[3], x[3], k;
} Scalar;

/* v . (A b) = k */
typedef struct Projection {
    const char *name;
    Ex v[3], b[3], k;
} Projection;

typedef struct Closed {
    Work *w;
    Dag *dag;
    Motion *pose;
    Block *block;
    KnownPose *hold; /* [bodies] */
} Closed;

enum { SCALARS_MOST = 64 };

/* ---- numbers ----------------------------------------------------------------------------------------------- */

static bool same3(const Ex a[3], const Ex b[3])
{
    return !memcmp(a, b, 3 * sizeof *a);
}

static bool is_zero3(const Ex a[3])
{
    return same3(a, (Ex[3]){0});
}

static bool varies3(const Dag *dag, const Ex a[3])
{
    return dag->node[a[0]].level == LEVEL_VARIABLE || dag->node[a[1]].level == LEVEL_VARIABLE ||
           dag->node[a[2]].level == LEVEL_VARIABLE;
}

/* True if a is larger than rounding relative to b at all samples that were reached. */
static bool is_sound(const Closed *z, Ex a, Ex b)
{
    const double least = 1e-8;
    for (int s = 0; s < z->dag->samples; ++s)
        if (z->w->alive[s] && !(ex_value(z->dag, a, s) > least * ex_value(z->dag, b, s)))
            return false;
    return true;
}

/* sum of s_i a_i */
static void combine(Dag *dag, int count, const Ex *s, const Ex *const *a, Ex out[3])
{
    Ex sum[3] = {0}, term[3];
    for (int i = 0; i < count; ++i) {
        ex_scale3(dag, s[i], a[i], term);
        ex_add3(dag, sum, term, sum);
    }
    memcpy(out, sum, sizeof sum);
}

/* If both solutions are nearer to each other than this (the sine of the angle to the place where they meet),
 * coordinates are not independent, and a step can't tell whether a motion passes the place or turns back. */
static const double meeting = 0.01;

/* The sign of an expression at the design; where geometry is tuned, at the drawing with the values of the parameters.
 */
static double sign_at_design(const Work *w, int member, int e, int unused, Ex *formula)
{
    (void)unused;
    if (w->model->tuning) {
        Dag *dag = w->model->tuning->dag;
        const Ex opposite = ex_neg(dag, subset_at_drawing(w, member, (Ex)e));
        if (dag->node[opposite].level == LEVEL_VARIABLE)
            *formula = ex_op(dag, OP_POSITIVE, opposite, ex_literal(dag, -1), ex_literal(dag, 1));
    }
    return ex_value(w->dag, (Ex)e, member * w->configurations) < 0 ? -1 : 1;
}

/* The root of `square` with the sign that `probe` has at the design; out of reach the square is negative. whole: the
 * square where the two solutions are opposite. */
static Ex branch_root(Closed *z, Ex square, Ex whole, Ex probe)
{
    block_check(z->block, square, false, 0, GIC_ERROR_NEWTON);
    Ex least = ex_mul(z->dag, ex_literal(z->dag, meeting * meeting), whole);
    block_check(z->block, ex_sub(z->dag, square, least), false, 0, GIC_ERROR_SINGULAR);
    const Ex sign = subset_constant(z->w, sign_at_design, (int)probe, 0);
    ex_describe(z->dag, sign, "sign");
    return ex_mul(z->dag, sign, ex_sqrt(z->dag, square));
}

/* A b, or a point, as found when the samples were followed. */
static void followed_vector(const Closed *z, int b, const Ex s[3], Ex out[3])
{
    ex_apply(z->dag, z->w->pose[b].A, s, out);
}

/* The vector a with v1 . a = k1, v2 . a = k2, a . a = square; `followed`: its value at the samples. */
static bool meet(Closed *z, const Ex v1[3], Ex k1, const Ex v2[3], Ex k2, Ex square, const Ex followed[3], Ex out[3])
{
    Dag *dag = z->dag;
    Ex n[3], one = ex_literal(dag, 1);
    ex_cross(dag, v1, v2, n);
    Ex det = ex_dot(dag, n, n), g11 = ex_dot(dag, v1, v1), g12 = ex_dot(dag, v1, v2), g22 = ex_dot(dag, v2, v2);
    if (!is_sound(z, det, ex_mul(dag, g11, g22)))
        return false;
    /* det times the shares of v1 and v2, and det times the square of the remaining part along n */
    Ex share1 = ex_sub(dag, ex_mul(dag, k1, g22), ex_mul(dag, k2, g12));
    Ex share2 = ex_sub(dag, ex_mul(dag, k2, g11), ex_mul(dag, k1, g12));
    Ex whole = ex_mul(dag, square, det);
    Ex rest = ex_sub(dag, ex_sub(dag, whole, ex_mul(dag, share1, k1)), ex_mul(dag, share2, k2));
    Ex inverse = ex_div(dag, one, det), root = branch_root(z, rest, whole, ex_dot(dag, n, followed));
    Ex along1 = ex_mul(dag, share1, inverse), along2 = ex_mul(dag, share2, inverse);
    Ex across = ex_mul(dag, root, inverse);
    combine(dag, 3, (Ex[]){along1, along2, across}, (const Ex *[]){v1, v2, n}, out);
    return true;
}

/* ---- what the rest of the mechanism says about a body ---------------------------------------------------------- */

static bool is_resolved(const Closed *z, End end)
{
    return end.unknown < 0 || z->hold[end.unknown].placed;
}

static const Motion *motion_at(const Closed *z, End end)
{
    return subset_motion(z->w, z->pose, end);
}

static void point_at(const Closed *z, const Connection *tie, int end, Ex out[3])
{
    const Vector point = vector_point(z->dag, motion_at(z, tie->end[end]), tie->fixture.point[end]);
    memcpy(out, point.v, sizeof point.v);
}

static void axis_at(const Closed *z, const Connection *tie, int end, const Ex u[3], Ex out[3])
{
    const Vector axis = vector_axis(z->dag, motion_at(z, tie->end[end]), u);
    memcpy(out, axis.v, sizeof axis.v);
}

/* The end of a connection that is at an unknown body; -1: neither. */
static int end_at(const Connection *tie, int body)
{
    return tie->end[0].unknown == body ? 0 : tie->end[1].unknown == body ? 1 : -1;
}

static int parts_of(const Work *w, const Connection *tie)
{
    return tie->is_coordinate ? 0 : joint_parts[w->model->joint[tie->index].type];
}

/* normal: a direction of the first end; the plane has the distance `offset` from the point of that end. */
static Scalar plane(const Closed *z, const Connection *tie, int end, const Ex normal[3], Ex offset)
{
    Scalar scalar = {.kind = end ? SCALAR_PLANE : SCALAR_OWN_PLANE, .k = offset, .name = connection_name(z->w, tie)};
    memcpy(scalar.s, tie->fixture.point[end], sizeof scalar.s);
    memcpy(scalar.normal, normal, sizeof scalar.normal);
    if (end)
        axis_at(z, tie, 0, normal, scalar.normal);
    point_at(z, tie, 1 - end, scalar.x);
    return scalar;
}

static Scalar sphere(const Closed *z, const Connection *tie, int end, Ex square)
{
    Scalar scalar = {.kind = SCALAR_SPHERE, .k = square, .name = connection_name(z->w, tie)};
    memcpy(scalar.s, tie->fixture.point[end], sizeof scalar.s);
    point_at(z, tie, 1 - end, scalar.x);
    return scalar;
}

/* own: a direction of the body; other: one of the other end, perpendicular to it. */
static Scalar direction(const Closed *z, const Connection *tie, int end, const Ex own[3], const Ex other[3])
{
    Scalar scalar = {.kind = SCALAR_DIRECTION, .name = connection_name(z->w, tie)};
    memcpy(scalar.normal, own, sizeof scalar.normal);
    axis_at(z, tie, 1 - end, other, scalar.x);
    return scalar;
}

static int coordinate_scalar(const Closed *z, const Connection *tie, int end, Scalar *out)
{
    Dag *dag = z->dag;
    const Fixture *fixture = &tie->fixture;
    Ex x = tie->x, turned[3];
    switch (tie->measure) {
    case COORDINATE_LENGTH: *out = sphere(z, tie, end, ex_mul(dag, x, x)); break;
    case COORDINATE_TRANSLATION: *out = plane(z, tie, end, fixture->axis[0], ex_sub(dag, x, fixture->offset)); break;
    case COORDINATE_ANGLE: {
        /* cos(w) e_2 - sin(w) e_1 is perpendicular to f_1 */
        Ex angle = ex_sub(dag, x, fixture->offset);
        Ex s = ex_neg(dag, ex_op(dag, OP_SIN, angle, 0, 0)), c = ex_op(dag, OP_COS, angle, 0, 0);
        combine(dag, 2, (Ex[]){s, c}, (const Ex *[]){fixture->side[0][0], fixture->side[1][0]}, turned);
        const Ex *f1 = fixture->side[0][1];
        *out = direction(z, tie, end, end ? f1 : turned, end ? turned : f1);
        break;
    }
    default: return 0;
    }
    return 1;
}

static int joint_scalars(const Closed *z, const Connection *tie, int end, Scalar *out)
{
    const Fixture *fixture = &tie->fixture;
    int count = 0, parts = parts_of(z->w, tie);
    for (int i = 0; parts & PART_LINE && i < 2; ++i)
        out[count++] = plane(z, tie, end, fixture->side[i][0], 0);
    if (parts & PART_ALONG)
        out[count++] = plane(z, tie, end, fixture->axis[0], fixture->offset);
    if (parts & PART_LENGTH)
        out[count++] = sphere(z, tie, end, fixture->square);
    if (parts & PART_CROSS)
        out[count++] = direction(z, tie, end, fixture->axis[end], fixture->axis[1 - end]);
    return count;
}

/* A joint at which an unknown body shares a point with a resolved one. */
static const Connection *anchor_of(const Closed *z, int body, int *end)
{
    for (int i = 0; i < z->w->connections; ++i) {
        const Connection *tie = &z->w->connection[i];
        *end = end_at(tie, body);
        if (*end >= 0 && parts_of(z->w, tie) & PART_POINT && is_resolved(z, tie->end[1 - *end]))
            return tie;
    }
    return NULL;
}

/* A neighbour with a known point, too: the common point is on a sphere about it. */
static int sphere_of_neighbour(const Closed *z, const Connection *tie, int end, Scalar *out)
{
    int held;
    const Connection *anchor = parts_of(z->w, tie) & PART_POINT ? anchor_of(z, tie->end[1 - end].unknown, &held) : NULL;
    if (!anchor)
        return 0;
    Ex d[3];
    ex_sub3(z->dag, tie->fixture.point[1 - end], anchor->fixture.point[held], d);
    *out = (Scalar){.kind = SCALAR_SPHERE, .k = ex_dot(z->dag, d, d), .name = connection_name(z->w, tie)};
    memcpy(out->s, tie->fixture.point[end], sizeof out->s);
    point_at(z, anchor, 1 - held, out->x);
    return 1;
}

static int collect_scalars(const Closed *z, int body, Scalar *out)
{
    int count = 0;
    for (int i = 0; i < z->w->connections && count + ROWS_MAX <= SCALARS_MOST; ++i) {
        const Connection *tie = &z->w->connection[i];
        int end = end_at(tie, body);
        if (end < 0)
            continue;
        if (!is_resolved(z, tie->end[1 - end]))
            count += sphere_of_neighbour(z, tie, end, out + count);
        else
            count += (tie->measure >= 0 ? coordinate_scalar : joint_scalars)(z, tie, end, out + count);
    }
    return count;
}

/* ---- points and directions --------------------------------------------------------------------------------------- */

static void add_arm(Closed *z, KnownPose *hold, const Ex s[3], const Ex image[3])
{
    if (hold->arms == 2 || !is_sound(z, ex_dot(z->dag, s, s), ex_literal(z->dag, 0)))
        return;
    memcpy(hold->arm[hold->arms], s, 3 * sizeof *s);
    memcpy(hold->image[hold->arms++], image, 3 * sizeof *image);
}

/* Axes that stay parallel, with directions perpendicular to them. Without a lock those of the two bodies do not
 * correspond: for an axis that never turns any perpendicular directions serve. */
static void add_triad(const Closed *z, KnownPose *hold, const Connection *tie, int end)
{
    const Fixture *fixture = &tie->fixture;
    const Ex *own[3] = {fixture->axis[end], fixture->side[0][end], fixture->side[1][end]};
    const Ex *other[3] = {fixture->axis[1 - end], fixture->side[0][1 - end], fixture->side[1][1 - end]};
    hold->triad = true;
    for (int i = 0; i < 3; ++i) {
        memcpy(hold->own[i], own[i], sizeof hold->own[i]);
        axis_at(z, tie, 1 - end, other[i], hold->known[i]);
    }
    if (tie->still)
        memcpy(hold->known[1], tie->across, sizeof tie->across);
}

/* The rotation of a body on a hinge whose coordinate is an angle: e and f are the directions that define the angle. */
static void turn_by_angle(Closed *z, KnownPose *hold, const Connection *angle, int end)
{
    Dag *dag = z->dag;
    const Fixture *fixture = &angle->fixture;
    const Ex turn = ex_sub(dag, angle->x, fixture->offset);
    const Ex c = ex_op(dag, OP_COS, turn, 0, 0), s = ex_op(dag, OP_SIN, turn, 0, 0);
    Ex axis[2][3], f2[3], e[3][3], f[3][3];
    for (int i = 0; i < 2; ++i)
        subset_hinge_axis(z->w, angle, i, axis[i]);
    ex_cross(dag, axis[1], fixture->side[0][1], f2);
    const Ex *first[3] = {axis[0], fixture->side[0][0], fixture->side[1][0]};
    const Ex *second[3] = {axis[1], fixture->side[0][1], f2};
    Ex(*const known)[3] = end ? e : f;
    for (int i = 0; i < 3; ++i) {
        axis_at(z, angle, 1 - end, end ? first[i] : second[i], known[i]);
        memcpy(hold->own[i], end ? second[i] : first[i], sizeof hold->own[i]);
    }
    /* f1 = c e1 + s e2, f2 = c e2 - s e1, and back */
    const Ex across = end ? s : ex_neg(dag, s);
    memcpy(hold->known[0], known[0], sizeof hold->known[0]);
    combine(dag, 2, (Ex[]){c, across}, (const Ex *[]){known[1], known[2]}, hold->known[1]);
    combine(dag, 2, (Ex[]){c, ex_neg(dag, across)}, (const Ex *[]){known[2], known[1]}, hold->known[2]);
    hold->triad = hold->turned = true;
}

/* All that joints to resolved bodies determine at once. */
static void find_held(Closed *z, int body, KnownPose *hold)
{
    for (int i = 0; i < z->w->connections; ++i) {
        const Connection *tie = &z->w->connection[i];
        int end = end_at(tie, body), parts = parts_of(z->w, tie);
        if (end < 0 || !is_resolved(z, tie->end[1 - end]))
            continue;
        if (tie->measure >= 0 && !hold->turned && subset_is_hinged(z->w, tie))
            turn_by_angle(z, hold, tie, end);
        if (parts & PART_PARALLEL && !hold->turned && (!hold->triad || parts & PART_LOCK))
            add_triad(z, hold, tie, end);
        hold->turned = hold->turned || parts & PART_LOCK;
        if (!(parts & PART_POINT))
            continue;
        Ex x[3], s[3];
        point_at(z, tie, 1 - end, x);
        if (!hold->anchored) {
            hold->anchored = true;
            memcpy(hold->s, tie->fixture.point[end], sizeof hold->s);
            memcpy(hold->x, x, sizeof hold->x);
            continue;
        }
        ex_sub3(z->dag, tie->fixture.point[end], hold->s, s);
        ex_sub3(z->dag, x, hold->x, x);
        add_arm(z, hold, s, x);
    }
}

static void set_image(Closed *z, int body, const Ex s[3], const Ex v[3])
{
    motion_image(z->dag, &z->pose[body], s, v);
}

/* A = sum of image_i row_i^T */
static void set_rotation(Closed *z, int body, const Ex (*image)[3], const Ex (*row)[3])
{
    Dag *dag = z->dag;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            z->pose[body].A[3 * i + j] =
                ex_dot(dag, (Ex[]){image[0][i], image[1][i], image[2][i]}, (Ex[]){row[0][j], row[1][j], row[2][j]});
    z->hold[body].turned = true;
}

static Projection projection_of(const Closed *z, const KnownPose *hold, const Scalar *scalar)
{
    Dag *dag = z->dag;
    Projection p = {.k = scalar->k, .name = scalar->name};
    Ex d[3], half = ex_literal(dag, 0.5);
    ex_sub3(dag, scalar->x, hold->x, d);
    ex_sub3(dag, scalar->s, hold->s, p.b);
    for (int i = 0; i < 3; ++i) {
        ex_describe(dag, d[i], "%s.distance_%c", p.name, "xyz"[i]);
        ex_describe(dag, p.b[i], "%s.arm_%c", p.name, "xyz"[i]);
    }
    memcpy(p.v, d, sizeof p.v);
    switch (scalar->kind) {
    case SCALAR_PLANE:
        memcpy(p.v, scalar->normal, sizeof p.v);
        p.k = ex_add(dag, scalar->k, ex_dot(dag, scalar->normal, d));
        break;
    case SCALAR_OWN_PLANE:
        p.k = ex_add(dag, scalar->k, ex_dot(dag, scalar->normal, p.b));
        memcpy(p.b, scalar->normal, sizeof p.b);
        break;
    case SCALAR_SPHERE: {
        /* constants first: fewer operations and roundings */
        Ex square = ex_dot(dag, p.b, p.b), reach = ex_dot(dag, d, d);
        p.k = dag->node[scalar->k].level < LEVEL_VARIABLE ? ex_add(dag, reach, ex_sub(dag, square, scalar->k))
                                                          : ex_sub(dag, ex_add(dag, reach, square), scalar->k);
        p.k = ex_mul(dag, half, p.k);
        ex_describe(dag, square, "%s.arm^2", p.name);
        ex_describe(dag, reach, "%s.distance^2", p.name);
        break;
    }
    case SCALAR_DIRECTION:
        memcpy(p.v, scalar->x, sizeof p.v);
        memcpy(p.b, scalar->normal, sizeof p.b);
        break;
    }
    return p;
}

/* ---- steps of the rotation ------------------------------------------------------------------------------------ */

/* Two equations about one vector: a sphere meets two planes. */
static bool find_arm(Closed *z, int body, const Projection *p, int count)
{
    KnownPose *hold = &z->hold[body];
    for (int i = 0; i < count; ++i)
        for (int j = i + 1; j < count; ++j) {
            Ex followed[3], image[3];
            if (!same3(p[i].b, p[j].b) || is_zero3(p[i].b))
                continue;
            followed_vector(z, body, p[i].b, followed);
            if (!meet(z, p[i].v, p[i].k, p[j].v, p[j].k, ex_dot(z->dag, p[i].b, p[i].b), followed, image))
                continue;
            add_arm(z, hold, p[i].b, image);
            return true;
        }
    return false;
}

/* The body turns about a known axis by an angle that satisfies a cos + b sin = k. */
static bool turn_triad(Closed *z, int body, const Projection *p)
{
    Dag *dag = z->dag;
    const KnownPose *hold = &z->hold[body];
    const Ex(*t)[3] = hold->known, (*u)[3] = hold->own;
    Ex part[3], quarter[3], followed[3], probe[3], vt[3];
    for (int i = 0; i < 3; ++i) {
        part[i] = ex_dot(dag, p->b, u[i]);
        vt[i] = ex_dot(dag, p->v, t[i]);
    }
    Ex a = ex_add(dag, ex_mul(dag, part[1], vt[1]), ex_mul(dag, part[2], vt[2]));
    Ex b = ex_sub(dag, ex_mul(dag, part[1], vt[2]), ex_mul(dag, part[2], vt[1]));
    Ex k = ex_sub(dag, p->k, ex_mul(dag, part[0], vt[0]));
    Ex square = ex_add(dag, ex_mul(dag, a, a), ex_mul(dag, b, b));
    ex_describe(dag, a, "%s.a", p->name);
    ex_describe(dag, b, "%s.b", p->name);
    ex_describe(dag, square, "(a^2 + b^2 of %s)", p->name);
    if (!is_sound(z, square, ex_mul(dag, ex_dot(dag, p->v, p->v), ex_dot(dag, p->b, p->b))))
        return false;
    followed_vector(z, body, p->b, followed);
    ex_cross(dag, t[0], p->v, probe);
    Ex root = branch_root(z, ex_sub(dag, square, ex_mul(dag, k, k)), square, ex_dot(dag, probe, followed));
    Ex inverse = ex_div(dag, ex_literal(dag, 1), square);
    ex_describe(dag, inverse, "1 / (a^2 + b^2 of %s)", p->name);
    Ex c = ex_mul(dag, ex_sub(dag, ex_mul(dag, a, k), ex_mul(dag, b, root)), inverse);
    Ex s = ex_mul(dag, ex_add(dag, ex_mul(dag, b, k), ex_mul(dag, a, root)), inverse);
    Ex *A = z->pose[body].A, side[3][3];
    memcpy(side[0], t[0], sizeof side[0]);
    combine(dag, 2, (Ex[]){c, s}, (const Ex *[]){t[1], t[2]}, side[1]);
    combine(dag, 2, (Ex[]){c, ex_neg(dag, s)}, (const Ex *[]){t[2], t[1]}, side[2]);
    if (varies3(dag, t[1]) || varies3(dag, t[2]))
        set_rotation(z, body, (const Ex(*)[3])side, u);
    else
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                Ex even = ex_add(dag, ex_mul(dag, t[1][i], u[1][j]), ex_mul(dag, t[2][i], u[2][j]));
                Ex odd = ex_sub(dag, ex_mul(dag, t[2][i], u[1][j]), ex_mul(dag, t[1][i], u[2][j]));
                A[3 * i + j] =
                    ex_add(dag, ex_mul(dag, t[0][i], u[0][j]), ex_add(dag, ex_mul(dag, c, even), ex_mul(dag, s, odd)));
            }
    z->hold[body].turned = true;
    /* the vector itself: from its components along the axis, perpendicular to it, and a quarter turn further */
    combine(dag, 2, (Ex[]){part[1], part[2]}, (const Ex *[]){t[1], t[2]}, quarter);
    combine(dag, 2, (Ex[]){part[1], ex_neg(dag, part[2])}, (const Ex *[]){t[2], t[1]}, probe);
    combine(dag, 3, (Ex[]){part[0], c, s}, (const Ex *[]){t[0], quarter, probe}, followed);
    set_image(z, body, p->b, followed);
    for (int i = 0; i < 3; ++i)
        set_image(z, body, u[i], side[i]);
    return true;
}

/* The rotation, from the images of an arm and of a vector `across` that is perpendicular to it. */
static void turn_pair(Closed *z, int body, const Ex arm[3], const Ex image[3], const Ex across[3], const Ex y[3])
{
    Dag *dag = z->dag;
    Ex third[3], row[3][3], own[3], square1 = ex_dot(dag, arm, arm), square2 = ex_dot(dag, across, across);
    Ex one = ex_literal(dag, 1), inverse1 = ex_div(dag, one, square1), inverse2 = ex_div(dag, one, square2);
    ex_cross(dag, arm, across, own);
    ex_cross(dag, image, y, third);
    ex_scale3(dag, inverse1, arm, row[0]);
    ex_scale3(dag, inverse2, across, row[1]);
    ex_scale3(dag, ex_mul(dag, inverse1, inverse2), own, row[2]);
    Ex images[3][3];
    memcpy(images[0], image, sizeof images[0]);
    memcpy(images[1], y, sizeof images[1]);
    memcpy(images[2], third, sizeof images[2]);
    set_rotation(z, body, (const Ex(*)[3])images, (const Ex(*)[3])row);
}

/* The part of b perpendicular to an arm; returns the share of b along the arm. */
static Ex split(Dag *dag, const Ex arm[3], const Ex b[3], Ex across[3])
{
    Ex share = ex_div(dag, ex_dot(dag, arm, b), ex_dot(dag, arm, arm)), along[3];
    ex_scale3(dag, share, arm, along);
    ex_sub3(dag, b, along, across);
    return share;
}

/* The body turns about a known arm; the angle is measured from the plane of the arm and v. */
static bool turn_arm(Closed *z, int body, const Projection *p)
{
    Dag *dag = z->dag;
    const KnownPose *hold = &z->hold[body];
    const Ex *arm = hold->arm[0], *image = hold->image[0];
    Ex across[3], level[3], n[3], y[3], followed[3], whole[3], one = ex_literal(dag, 1);
    Ex square1 = ex_dot(dag, arm, arm), share = split(dag, arm, p->b, across), square2 = ex_dot(dag, across, across);
    if (!is_sound(z, square2, ex_dot(dag, p->b, p->b)))
        return false;
    Ex along = ex_dot(dag, p->v, image);
    ex_scale3(dag, ex_div(dag, along, square1), image, level);
    ex_sub3(dag, p->v, level, level);
    Ex square = ex_dot(dag, level, level);
    if (!is_sound(z, square, ex_dot(dag, p->v, p->v)))
        return false;
    ex_cross(dag, image, level, n);
    Ex inverse = ex_div(dag, one, square), k = ex_sub(dag, p->k, ex_mul(dag, share, along));
    followed_vector(z, body, p->b, followed);
    /* for the angle itself: n is as long as level and arm together */
    Ex most = ex_mul(dag, square2, square), rest = ex_sub(dag, most, ex_mul(dag, k, k));
    Ex root = branch_root(z, rest, most, ex_dot(dag, n, followed)), scale = ex_sqrt(dag, ex_div(dag, one, square1));
    Ex beside = ex_mul(dag, k, inverse), along_n = ex_mul(dag, ex_mul(dag, scale, root), inverse);
    combine(dag, 2, (Ex[]){beside, along_n}, (const Ex *[]){level, n}, y);
    turn_pair(z, body, arm, image, across, y);
    combine(dag, 2, (Ex[]){share, one}, (const Ex *[]){image, y}, whole);
    set_image(z, body, arm, image);
    set_image(z, body, p->b, whole);
    return true;
}

/* The rotation from two arms, or from an axis and an arm. */
static bool turn_known(Closed *z, int body)
{
    Dag *dag = z->dag;
    const KnownPose *hold = &z->hold[body];
    const Ex *first = hold->triad ? hold->own[0] : hold->arm[0];
    const Ex *first_image = hold->triad ? hold->known[0] : hold->image[0];
    int second = hold->triad ? 0 : 1;
    if (hold->arms <= second)
        return false;
    Ex across[3], y[3];
    Ex share = split(dag, first, hold->arm[second], across);
    if (!is_sound(z, ex_dot(dag, across, across), ex_dot(dag, hold->arm[second], hold->arm[second])))
        return false;
    const Ex minus = ex_neg(dag, share);
    combine(dag, 2, (Ex[]){minus, ex_literal(dag, 1)}, (const Ex *[]){first_image, hold->image[second]}, y);
    turn_pair(z, body, first, first_image, across, y);
    set_image(z, body, first, first_image);
    set_image(z, body, hold->arm[second], hold->image[second]);
    return true;
}

static bool find_rotation(Closed *z, int body, const Projection *p, int count)
{
    const KnownPose *hold = &z->hold[body];
    if (!hold->triad && !hold->arms && !find_arm(z, body, p, count))
        return false;
    if (turn_known(z, body))
        return true;
    for (int i = 0; i < count; ++i)
        if ((hold->triad ? turn_triad : turn_arm)(z, body, &p[i]))
            return true;
    return false;
}

/* ---- place of a body whose rotation is known ------------------------------------------------------------------- */

/* n . c = k, or |c - n|^2 = k. */
typedef struct Locus {
    Ex n[3], k;
} Locus;

static bool meet_planes(Closed *z, const Locus *a, Ex c[3])
{
    Dag *dag = z->dag;
    Ex n[3][3], k[3];
    for (int i = 0; i < 3; ++i)
        ex_cross(dag, a[(i + 1) % 3].n, a[(i + 2) % 3].n, n[i]);
    Ex det = ex_dot(dag, a[0].n, n[0]), square = ex_mul(dag, det, det), size = ex_literal(dag, 1);
    for (int i = 0; i < 3; ++i)
        size = ex_mul(dag, size, ex_dot(dag, a[i].n, a[i].n));
    if (!is_sound(z, square, size))
        return false;
    for (int i = 0; i < 3; ++i)
        k[i] = ex_div(dag, a[i].k, det);
    combine(dag, 3, k, (const Ex *[]){n[0], n[1], n[2]}, c);
    return true;
}

static bool find_point(Closed *z, int body, const Scalar *scalar, int count)
{
    Dag *dag = z->dag;
    Motion *pose = &z->pose[body];
    Locus plane_of[SCALARS_MOST], sphere_of[SCALARS_MOST];
    int planes = 0, spheres = 0;
    for (int i = 0; i < count; ++i) {
        const Vector arm = vector_axis(dag, pose, scalar[i].s), normal = vector_axis(dag, pose, scalar[i].normal);
        const Ex *n = scalar[i].kind == SCALAR_PLANE ? scalar[i].normal : normal.v;
        Ex at[3], k = scalar[i].kind == SCALAR_PLANE ? scalar[i].k : ex_neg(dag, scalar[i].k);
        ex_sub3(dag, scalar[i].x, arm.v, at);
        if (scalar[i].kind == SCALAR_SPHERE) {
            Locus *locus = &sphere_of[spheres++];
            memcpy(locus->n, at, sizeof at);
            locus->k = scalar[i].k;
        } else if (scalar[i].kind != SCALAR_DIRECTION) {
            Locus *locus = &plane_of[planes++];
            memcpy(locus->n, n, sizeof locus->n);
            locus->k = ex_add(dag, k, ex_dot(dag, n, at));
        }
    }
    if (planes == 3 && !spheres)
        return meet_planes(z, plane_of, pose->c);
    if (planes != 2 || spheres != 1)
        return false;
    Ex followed[3], k[2], out[3];
    ex_sub3(dag, z->w->pose[body].c, sphere_of->n, followed);
    for (int i = 0; i < 2; ++i)
        k[i] = ex_sub(dag, plane_of[i].k, ex_dot(dag, plane_of[i].n, sphere_of->n));
    if (!meet(z, plane_of[0].n, k[0], plane_of[1].n, k[1], sphere_of->k, followed, out))
        return false;
    ex_add3(dag, sphere_of->n, out, pose->c);
    return true;
}

/* ---- bodies, subsets -----------------------------------------------------------------------------------------------
 */

static bool place_body(Closed *z, int body)
{
    Dag *dag = z->dag;
    KnownPose *hold = &z->hold[body];
    Motion *pose = &z->pose[body];
    Scalar scalar[SCALARS_MOST];
    Projection projection[SCALARS_MOST];
    *hold = (KnownPose){.placed = false};
    *pose = (Motion){.S = NULL};
    find_held(z, body, hold);
    int count = collect_scalars(z, body, scalar);
    if (hold->turned) {
        set_rotation(z, body, (const Ex(*)[3])hold->known, (const Ex(*)[3])hold->own);
        for (int i = 0; i < 3; ++i)
            set_image(z, body, hold->own[i], hold->known[i]);
    } else if (hold->anchored) {
        for (int i = 0; i < count; ++i)
            projection[i] = projection_of(z, hold, &scalar[i]);
        if (!find_rotation(z, body, projection, count))
            return false;
    } else if (!hold->triad) { /* no point is known yet: directions alone, as those of three angles */
        int directions = 0;
        for (int i = 0; i < count; ++i)
            if (scalar[i].kind == SCALAR_DIRECTION)
                projection[directions++] = projection_of(z, hold, &scalar[i]);
        if (!find_rotation(z, body, projection, directions))
            return false;
    } else {
        return false;
    }
    if (hold->anchored) {
        const Vector arm = vector_axis(dag, pose, hold->s);
        ex_sub3(dag, hold->x, arm.v, pose->c);
    } else if (!find_point(z, body, scalar, count)) {
        return false;
    }
    return hold->placed = true;
}

/* True if the closed form gives the poses that Newton's iteration found, at every sample. Then it uses the right
 * equations, each once. */
static bool is_confirmed(const Closed *z)
{
    const Work *w = z->w;
    const double rounding = 1e-8;
    for (int b = 0; b < w->first->bodies; ++b)
        for (int i = 0; i < 12; ++i)
            for (int s = 0; s < w->dag->samples; ++s) {
                Ex own = i < 3 ? z->pose[b].c[i] : z->pose[b].A[i - 3];
                Ex followed = i < 3 ? w->pose[b].c[i] : w->pose[b].A[i - 3];
                double error = fabs(ex_value(w->dag, own, s) - ex_value(w->dag, followed, s));
                if (w->alive[s] && !(error < rounding * (i < 3 ? w->size : 1)))
                    return false;
            }
    return true;
}

bool subset_closed(Work *w, Motion *pose, Block *block)
{
    Closed z = {.w = w,
                .dag = w->dag,
                .pose = pose,
                .block = block,
                .hold = pool_alloc(w->pool, (size_t)w->first->bodies * sizeof *z.hold)};
    int placed = 0, before;
    do {
        before = placed;
        for (int b = 0; b < w->first->bodies; ++b)
            if (!z.hold[b].placed) {
                const int checks = block->checks;
                if (place_body(&z, b))
                    ++placed;
                else
                    block->checks = checks;
            }
    } while (placed > before);
    return placed == w->first->bodies && is_confirmed(&z);
}
