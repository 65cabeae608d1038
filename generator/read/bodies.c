/* SPDX-License-Identifier: MIT
 * Bodies: mass, inertia and the pose of the body frame at design (FORMAT.md section 3). */
#include "base/vec3.h"
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

enum { BODY_MASS, BODY_COM, BODY_INERTIA, BODY_POSITION, BODY_ORIENTATION, BODY_SHAPE, BODY_KEYS };

static const Key body_key[BODY_KEYS] = {
    [BODY_MASS] = {"mass", KEY_MEASURE, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [BODY_COM] = {"com", KEY_POINT, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [BODY_INERTIA] = {"inertia", KEY_INERTIA, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [BODY_POSITION] = {"position", KEY_POINT, ALL_FORMS, 0, BOUND_NONE, 0},
    [BODY_ORIENTATION] = {"orientation", KEY_ORIENTATION, ALL_FORMS, 0, BOUND_NONE, 0},
    [BODY_SHAPE] = {"shape", KEY_SHAPE, ALL_FORMS, 0, BOUND_NONE, 0},
};

enum { INERTIA_KEYS = 6 };

static const Key inertia_key[INERTIA_KEYS] = {
    {"xx", KEY_MEASURE, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    {"yy", KEY_MEASURE, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    {"zz", KEY_MEASURE, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    {"xy", KEY_ODD, ALL_FORMS, 0, BOUND_NONE, 0},
    {"xz", KEY_MEASURE, ALL_FORMS, 0, BOUND_NONE, 0},
    {"yz", KEY_ODD, ALL_FORMS, 0, BOUND_NONE, 0},
};

enum { ORIENTATION_EULER, ORIENTATION_ANGLE, ORIENTATION_AXES, ORIENTATION_FORMS };
enum { TURN_EULER, TURN_AXIS, TURN_ANGLE, TURN_X, TURN_Z, TURN_KEYS };

static const Key orientation_key[TURN_KEYS] = {
    [TURN_EULER] = {"euler", KEY_EULER, FORM(ORIENTATION_EULER), FORM(ORIENTATION_EULER), BOUND_NONE, 0},
    [TURN_AXIS] = {"axis", KEY_TURN, FORM(ORIENTATION_ANGLE), FORM(ORIENTATION_ANGLE), BOUND_NONE, 0},
    [TURN_ANGLE] = {"angle", KEY_NUMBER, FORM(ORIENTATION_ANGLE), FORM(ORIENTATION_ANGLE), BOUND_NONE, 0},
    [TURN_X] = {"x", KEY_AXIS, FORM(ORIENTATION_AXES), FORM(ORIENTATION_AXES), BOUND_NONE, 0},
    [TURN_Z] = {"z", KEY_AXIS, FORM(ORIENTATION_AXES), FORM(ORIENTATION_AXES), BOUND_NONE, 0},
};

static const char *const orientation_form[ORIENTATION_FORMS] = {
    [ORIENTATION_EULER] = "by Euler parameters",
    [ORIENTATION_ANGLE] = "by axis and angle",
    [ORIENTATION_AXES] = "by the directions x and z",
};

static const char *const body_about[BODY_KEYS] = {
    [BODY_MASS] = "mass, kg",
    [BODY_COM] = "centre of mass at design, m, model frame",
    [BODY_INERTIA] = "about the centre of mass, in axes parallel to the body frame, kg m^2; a list or a map",
    [BODY_POSITION] = "origin of the body frame at design, m, model frame; default: com",
    [BODY_ORIENTATION] = "axes of the body frame at design; default: those of the model frame",
    [BODY_SHAPE] = "how it is drawn by gicrun --animate: box, cylinder, a path of an .obj file, or a map",
};

static const char *const inertia_about[INERTIA_KEYS] = {
    "moment of inertia about the x axis, kg m^2",
    "moment of inertia about the y axis, kg m^2",
    "moment of inertia about the z axis, kg m^2",
    "element xy of the inertia matrix, minus the integral of x y dm, kg m^2; default 0",
    "element xz of the inertia matrix, minus the integral of x z dm, kg m^2; default 0",
    "element yz of the inertia matrix, minus the integral of y z dm, kg m^2; default 0",
};

static const char *const orientation_about[TURN_KEYS] = {
    [TURN_EULER] = "Euler parameters of the body frame",
    [TURN_AXIS] = "axis of the rotation from the model frame",
    [TURN_ANGLE] = "angle of the rotation about the axis, rad",
    [TURN_X] = "direction of the x axis of the body",
    [TURN_Z] = "direction that the z axis of the body is nearest to; y = z cross x",
};

const Section body_section = {body_key, BODY_KEYS, NULL, 0, NULL, NULL, body_about};
const Section inertia_section = {inertia_key, INERTIA_KEYS, NULL, 0, NULL, NULL, inertia_about};
const Section orientation_section = {orientation_key, TURN_KEYS, NULL, 0, orientation_form, NULL, orientation_about};

static const double triangle_tolerance = 1e-9, euler_tolerance = 1e-6;
/* Sine of the smallest angle between the given x and z directions. */
static const double axes_tolerance = 1e-9;

/* True if the symmetric matrix (xx, yy, zz, xy, xz, yz) is positive definite: the pivots of L D L^T are. */
static bool positive_definite(const double m[6])
{
    if (!(m[0] > 0))
        return false;
    double l10 = m[3] / m[0], l20 = m[4] / m[0];
    double d1 = m[1] - l10 * m[3], s21 = m[5] - l20 * m[3];
    if (!(d1 > 0))
        return false;
    return m[2] - l20 * m[4] - s21 / d1 * s21 > 0;
}

/* True if the triangle inequality holds: the principal values of trace/2 - inertia are (b + c - a)/2 and so on, and
 * none may be negative. The tolerance is relative to b + c, which at the limit is half of the trace. */
static bool of_a_body(const double inertia[6])
{
    double trace = inertia[0] + inertia[1] + inertia[2], slack = triangle_tolerance * trace / 4, spread[6];
    for (int i = 0; i < 6; ++i)
        spread[i] = i < 3 ? trace / 2 - inertia[i] + slack : -inertia[i];
    return isfinite(trace) && positive_definite(spread);
}

/* Require that a symmetric matrix of formulas is positive definite: conditions on its pivots. */
static void require_definite(const Reader *reader, const Ex m[6], const char *text)
{
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    Ex l10 = ex_div(dag, m[3], m[0]), l20 = ex_div(dag, m[4], m[0]);
    Ex d1 = ex_sub(dag, m[1], ex_mul(dag, l10, m[3])), s21 = ex_sub(dag, m[5], ex_mul(dag, l20, m[3]));
    Ex d2 = ex_sub(dag, ex_sub(dag, m[2], ex_mul(dag, l20, m[4])), ex_mul(dag, ex_div(dag, s21, d1), s21));
    tuning_require(tuning, m[0], false, text);
    tuning_require(tuning, d1, false, text);
    tuning_require(tuning, d2, false, text);
}

/* The same checks for set-up, where the inertia follows parameters. */
static void inertia_tune(const Reader *reader, const char *what, const double inertia[6], Ex tuned[6])
{
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    Ex m[6], spread[6], slack = ex_literal(dag, 0.5 + triangle_tolerance / 4);
    if (!any_tuned(tuned, 6))
        return;
    tuning_set(tuning, inertia, tuned, 6);
    formulas(reader, inertia, tuned, 6, m);
    require_definite(reader, m, pool_print(reader->pool, "%s must be positive definite", what));
    Ex trace = ex_add(dag, ex_add(dag, m[0], m[1]), m[2]);
    for (int i = 0; i < 6; ++i)
        spread[i] = i < 3 ? ex_sub(dag, ex_mul(dag, slack, trace), m[i]) : ex_neg(dag, m[i]);
    require_definite(reader, spread,
                     pool_print(reader->pool, "%s: no principal value may be larger than the sum of the others", what));
}

static void inertia_read(Reader *reader, const Item *item, const Entry *body, double inertia[6])
{
    const char *what = pool_print(reader->pool, "inertia of %s", body->what);
    Ex tuned[6] = {0};
    if (item->kind == ITEM_MAP) {
        Value value[INERTIA_KEYS];
        section_read(reader, &inertia_section, 0, &(Entry){"inertia", what, item->at, item}, value);
        for (int i = 0; i < 6; ++i) {
            inertia[i] = value[i].number[0];
            tuned[i] = value[i].tuned[0];
        }
    } else if (item->kind == ITEM_LIST && item->count == 3)
        vector_read(reader, item, what, inertia, 3, tuned);
    else
        diag_fail(item->at, "write [Ixx, Iyy, Izz] or {xx: , yy: , zz: , xy: , xz: , yz: }",
                  "%s must be a list of three numbers or a map", what);
    if (!positive_definite(inertia))
        diag_fail(item->at, "check signs and magnitudes; xy, xz, yz are the elements of the matrix",
                  "%s is not positive definite", what);
    if (!of_a_body(inertia))
        diag_fail(item->at, "check the values; for a flat body the largest is the sum of the others",
                  "%s is that of no body: a principal value is larger than the sum of the other two", what);
    inertia_tune(reader, what, inertia, tuned);
}

void spin_take(const Reader *reader, const Wheel *wheel, const char *what, Place at)
{
    static const int entry[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    Body *body = &reader->model->body[wheel->body];
    Dag *dag = reader->model->tuning->dag;
    Ex tuned[6], s[3];
    for (int i = 0; i < 3; ++i)
        s[i] = tuned_or_fixed(reader->model, &wheel->axis[i]);
    for (int i = 0; i < 6; ++i) {
        Ex square = ex_mul(dag, s[entry[i][0]], s[entry[i][1]]);
        tuned[i] = ex_sub(dag, tuned_or_fixed(reader->model, &body->inertia[i]),
                          ex_mul(dag, ex_literal(dag, wheel->spin_inertia), square));
    }
    for (int i = 0; i < 6; ++i)
        body->inertia[i] -= wheel->spin_inertia * wheel->axis[entry[i][0]] * wheel->axis[entry[i][1]];
    if (!positive_definite(body->inertia))
        diag_fail(at, "give the body the inertia of everything that it carries, wheels included",
                  "spin_inertia of %s is as much as body '%s' has about that axis, or more", what, body->name);
    if (!of_a_body(body->inertia))
        diag_fail(at, "give the body the inertia of everything that it carries, wheels included",
                  "without spin_inertia of %s the inertia of body '%s' is that of no body: a principal value is larger "
                  "than the sum of the other two",
                  what, body->name);
    tuned_reduce(reader, tuned, 6);
    inertia_tune(reader, pool_print(reader->pool, "what spin leaves of the inertia of body '%s'", body->name),
                 body->inertia, tuned);
}

/* Euler parameters of the rotation matrix with columns x, y, z (Shepperd: divide by the largest parameter). */
static void euler_from_axes(const double x[3], const double y[3], const double z[3], double p[4])
{
    double trace = x[0] + y[1] + z[2];
    double square[4] = {1 + trace, 1 + 2 * x[0] - trace, 1 + 2 * y[1] - trace, 1 + 2 * z[2] - trace};
    int largest = 0;
    for (int i = 1; i < 4; ++i)
        if (square[i] > square[largest])
            largest = i;
    double twist[3] = {y[2] - z[1], z[0] - x[2], x[1] - y[0]}; /* 4 e0 e */
    double sum[3] = {z[1] + y[2], x[2] + z[0], y[0] + x[1]};   /* 4 (e2 e3, e3 e1, e1 e2) */
    p[largest] = square[largest];
    if (largest == 0)
        memcpy(p + 1, twist, sizeof twist);
    else {
        int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
        p[0] = twist[i];
        p[1 + j] = sum[k];
        p[1 + k] = sum[j];
    }
    vector_normalize(p, 4);
    double sign = p[0] < 0 ? -1 : 1;
    for (int i = 0; i < 4; ++i)
        p[i] *= sign;
}

void orientation_read(Reader *reader, const Item *item, const Entry *of, double euler[4])
{
    Entry entry = {"orientation", pool_print(reader->pool, "orientation of %s", of->what), item->at, item};
    bool is_map = item->kind == ITEM_MAP;
    int form = is_map && doc_find(item, "euler")                               ? ORIENTATION_EULER
               : is_map && (doc_find(item, "axis") || doc_find(item, "angle")) ? ORIENTATION_ANGLE
                                                                               : ORIENTATION_AXES;
    Value value[TURN_KEYS];
    reader->fixed = true;
    section_read(reader, &orientation_section, form, &entry, value);
    reader->fixed = false;
    if (form == ORIENTATION_EULER) {
        memcpy(euler, value[TURN_EULER].number, 4 * sizeof *euler);
        double square = euler[0] * euler[0] + dot3(euler + 1, euler + 1);
        if (!(fabs(sqrt(square) - 1) <= euler_tolerance))
            diag_fail(value[TURN_EULER].item->at, "write them with at least seven digits; [1, 0, 0, 0] is no rotation",
                      "%s: the norm of the Euler parameters is %.9g, not 1", entry.what, sqrt(square));
        vector_normalize(euler, 4);
    } else if (form == ORIENTATION_ANGLE) {
        double half = value[TURN_ANGLE].number[0] / 2;
        euler[0] = cos(half);
        for (int i = 0; i < 3; ++i)
            euler[1 + i] = sin(half) * value[TURN_AXIS].number[i];
        vector_normalize(euler, 4);
    } else {
        const double *x = value[TURN_X].number;
        double *z = value[TURN_Z].number, y[3], along = dot3(z, x);
        for (int i = 0; i < 3; ++i)
            z[i] -= along * x[i];
        if (norm3(z) < axes_tolerance)
            diag_fail(value[TURN_Z].item->at, "give a z direction that is not along x", "%s: x and z are parallel",
                      entry.what);
        vector_normalize(z, 3);
        cross3(z, x, y);
        euler_from_axes(x, y, z, euler);
    }
}

/* Read a body; it is added after those that the model has. */
static void body_read(Reader *reader, const Entry *entry)
{
    int index = reader->model->bodies++;
    Body *body = reader->model->body + index;
    Value value[BODY_KEYS];
    section_read(reader, &body_section, 0, entry, value);
    *body = (Body){.name = entry->name, .at = entry->at, .mass = value[BODY_MASS].number[0], .euler = {1, 0, 0, 0}};
    const double *com = value[BODY_COM].number;
    const Value *position = value[BODY_POSITION].item ? value + BODY_POSITION : value + BODY_COM;
    memcpy(body->position, position->number, sizeof body->position);
    tuning_set(reader->model->tuning, &body->mass, value[BODY_MASS].tuned, 1);
    tuning_set(reader->model->tuning, body->position, position->tuned, 3);
    if (value[BODY_ORIENTATION].item)
        orientation_read(reader, value[BODY_ORIENTATION].item, entry, body->euler);
    inertia_read(reader, value[BODY_INERTIA].item, entry, body->inertia);
    body_point(reader, index, com, value[BODY_COM].tuned, value[BODY_COM].item->at, body->com);
    body->shape = shape_read(reader, value[BODY_SHAPE].item, entry, index);
}

void bodies_read(Reader *reader, const Item *base, const Item *bodies)
{
    Model *model = reader->model;
    int count, first = 0;
    Entry *entry = section_entries(reader, bodies, "body", &count);
    if (count == 0)
        diag_fail(bodies->at, "add a body: `name: {mass: , com: , inertia: }`", "the model has no body");
    const char *base_name = doc_word(base, "base");
    model->free_base = strcmp(base_name, "ground") != 0;
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(count + 1));
    for (int i = 0; i < count; ++i) {
        name[i] = entry[i].name;
        if (!strcmp(name[i], "ground") || !strcmp(name[i], "world"))
            diag_fail(entry[i].at, "take another name",
                      "the name '%s' is reserved: it is the ground, which never moves", name[i]);
    }
    if (model->free_base) {
        while (first < count && strcmp(name[first], base_name))
            ++first;
        if (first == count) {
            name[count] = "ground";
            const char *nearest = diag_nearest(base_name, name, count + 1);
            diag_fail(base->at,
                      nearest ? pool_print(reader->pool, "did you mean '%s'?", nearest)
                              : "name one of the bodies, or `ground` for a fixed base",
                      "base: there is no body '%s'", base_name);
        }
    }
    model->body = pool_alloc(reader->pool, sizeof *model->body * (size_t)(count + 1));
    if (!model->free_base)
        model->body[model->bodies++] = (Body){.name = "ground", .at = base->at, .euler = {1, 0, 0, 0}};
    else
        body_read(reader, entry + first);
    for (int i = 0; i < count; ++i)
        if (!model->free_base || i != first)
            body_read(reader, entry + i);
}

void body_point(const Reader *reader, int body, const double x[3], const Ex tuned_x[3], Place at, double out[3])
{
    const double zero[3] = {0, 0, 0};
    const double *origin = body == BODY_GROUND ? zero : reader->model->body[body].position;
    double d[3];
    Ex formula[3];
    formulas(reader, x, tuned_x, 3, formula);
    for (int i = 0; i < 3; ++i) {
        d[i] = x[i] - origin[i];
        formula[i] = ex_sub(reader->model->tuning->dag, formula[i], tuned_or_fixed(reader->model, origin + i));
    }
    body_direction(reader, body, d, formula, out);
    if (!isfinite(norm3(out)))
        diag_fail(at, "coordinates are in metres", "the point is too far away");
}

void body_direction(const Reader *reader, int body, const double x[3], const Ex tuned_x[3], double out[3])
{
    Dag *dag = reader->model->tuning->dag;
    double A[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Ex turn[9], formula[3], turned[3];
    if (body == BODY_GROUND) {
        memcpy(out, x, 3 * sizeof *out);
    } else {
        mat_from_euler(reader->model->body[body].euler, A);
        apply3_transposed(A, x, out);
    }
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    formulas(reader, x, tuned_x, 3, formula);
    ex_apply_transposed(dag, turn, formula, turned);
    tuning_set(reader->model->tuning, out, turned, 3);
}
