/* SPDX-License-Identifier: MIT
 * The drawing of a model: each body by the points fixed to it, links and springs by lines between points. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "run/animate.h"
#include "scene/scene.h"

#include <math.h>

typedef struct Shaper {
    Pool *pool;
    const Model *model;
    Shapes *shapes;
} Shaper;

/* A number of the model at the scene's values of parameters. */
static double number(const Model *model, const double *at)
{
    const Ex formula = tuned_number(model, at);
    return formula ? ex_value(model->tuning->dag, formula, 0) : *at;
}

static void vector(const Model *model, const double *at, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = number(model, at + i);
}

/* Set the numbers of the model for other values of parameters [tunables]; NULL: for those of the file, as other code
 * expects. */
static void set_parameters(const Model *model, const double *value)
{
    if (!model->tuning)
        return;
    Dag *dag = model->tuning->dag;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *parameter = &model->parameter[i];
        if (!parameter->tunable)
            continue;
        const Ex input = ex_input(dag, element_at(ARRAY_p, parameter->index), &parameter->value);
        ex_set_sample(dag, input, 0, value ? value[parameter->index] : parameter->value);
    }
    dag_evaluate(dag, 0, 1);
}

/* ---- points ------------------------------------------------------------------------------------------------------ */

static void add_point(const Shaper *shaper, int body, const double x[3])
{
    if (body == BODY_GROUND)
        return;
    Shape *shape = &shaper->shapes->body[body];
    Point *point = POOL_PUSH(shaper->pool, shape->point, shape->points);
    *point = (Point){{x[0], x[1], x[2]}};
}

static void add_points(const Shaper *shaper, const int body[2], double (*at)[3])
{
    for (int k = 0; k < 2; ++k) {
        double x[3];
        vector(shaper->model, at[k], x);
        add_point(shaper, body[k], x);
    }
}

/* A joint that is a link without mass, drawn as a line. */
static bool is_link(const Joint *joint)
{
    return joint->type == JOINT_DISTANCE || joint->type == JOINT_REVOLUTE_SPHERICAL;
}

static bool is_at_point(const Joint *joint)
{
    return !is_link(joint) && joint->type != JOINT_PARALLEL && joint->type != JOINT_PERPENDICULAR;
}

/* Largest distance of a body's points from x. */
static double reach(const Shape *shape, const double x[3])
{
    double most = 0;
    for (int i = 0; i < shape->points; ++i) {
        const double *p = shape->point[i].x;
        most = fmax(most, hypot(hypot(p[0] - x[0], p[1] - x[1]), p[2] - x[2]));
    }
    return most;
}

/* Half the diagonal of the solid box that stands for a body without points away from a hinge. */
static double half_diagonal(const Shape *shape)
{
    return norm3(shape->box) / 2;
}

/* A hinge is drawn as wide as a third of the smaller body at it: an arm between a hinge and a ball joint becomes a
 * triangle. A body all of whose points are at its hinges keeps them, and is as large as its inertia says. */
static void add_hinges(const Shaper *shaper)
{
    const Model *model = shaper->model;
    int *points = pool_alloc(shaper->pool, (size_t)model->bodies * sizeof *points);
    for (int b = 0; b < model->bodies; ++b)
        points[b] = shaper->shapes->body[b].points;
    for (int j = 0; j < model->joints; ++j) {
        const Joint *joint = &model->joint[j];
        double x[2][3], far[2], width = INFINITY;
        if (joint->type != JOINT_REVOLUTE && joint->type != JOINT_CYLINDRICAL)
            continue;
        for (int k = 0; k < 2; ++k) {
            Shape plain = shaper->shapes->body[joint->body[k]];
            plain.points = points[joint->body[k]]; /* points of hinges are not counted */
            vector(model, joint->point[k], x[k]);
            far[k] = reach(&plain, x[k]);
            const double size = far[k] > 0 ? far[k] : half_diagonal(&plain);
            width = size > 0 ? fmin(width, size / 3) : width;
        }
        for (int k = 0; k < 2 && isfinite(width); ++k)
            for (int side = -1; side <= 1; side += 2) {
                double end[3];
                for (int i = 0; i < 3; ++i)
                    end[i] = x[k][i] + side * width * number(model, &joint->axis[k][i]);
                if (far[k] > 0)
                    add_point(shaper, joint->body[k], end);
            }
    }
}

/* Edges of a solid box of the body's mass and moments of inertia. */
static void inertia_box(const Model *model, const Body *body, double box[3])
{
    double J[3], sum = 0;
    const double mass = number(model, &body->mass);
    for (int i = 0; i < 3; ++i)
        sum += J[i] = number(model, &body->inertia[i]);
    for (int i = 0; i < 3; ++i)
        box[i] = mass > 0 ? sqrt(fmax(6 * (sum - 2 * J[i]) / mass, 0)) : 0;
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static void add_line(const Shaper *shaper, const char *name, const char *kind, const int body[2], double (*at)[3])
{
    Shapes *shapes = shaper->shapes;
    Line *line = POOL_PUSH(shaper->pool, shapes->line, shapes->lines);
    *line = (Line){.name = name, .kind = kind, .body = {body[0], body[1]}};
    for (int k = 0; k < 2; ++k)
        vector(shaper->model, at[k], line->point[k]);
}

static bool is_elastic(const Model *model, const Force *force)
{
    return force_is_spring(force) && (force->table >= 0 || law_number(force->stiffness, model) > 0);
}

/* True if a spring acts along the coordinate. */
static bool is_sprung(const Model *model, int coordinate)
{
    for (int f = 0; f < model->forces; ++f)
        if (model->force[f].coordinate == coordinate && is_elastic(model, &model->force[f]))
            return true;
    return false;
}

static void add_lines(const Shaper *shaper)
{
    const Model *model = shaper->model;
    for (int j = 0; j < model->joints; ++j) {
        Joint *joint = &model->joint[j];
        if (is_link(joint))
            add_line(shaper, joint->name, "link", joint->body, joint->point);
    }
    for (int c = 0; c < model->coordinates; ++c) {
        Coordinate *w = &model->coordinate[c];
        if (w->type == COORDINATE_LENGTH)
            add_line(shaper, w->name, is_sprung(model, c) ? "spring" : "damper", w->body, w->point);
    }
    for (int f = 0; f < model->forces; ++f) {
        Force *force = &model->force[f];
        if (force->type == FORCE_POINTS || force->type == FORCE_POINTS_LAW)
            add_line(shaper, force->name, is_elastic(model, force) ? "spring" : "damper", force->body, force->point);
        if (force->type == FORCE_BUSHING) {
            add_line(shaper, force->name, "bushing", force->body, force->point);
            Line *line = &shaper->shapes->line[shaper->shapes->lines - 1];
            for (int k = 0; k < 2; ++k) /* z of its frame */
                apply3(force->bushing->frame[k], (const double[]){0, 0, 1}, line->axis[k]);
        }
    }
}

/* ---- wheels ------------------------------------------------------------------------------------------------------ */

/* Wheels turn about the y axis of the drawing. */
static void add_wheels(const Shaper *shaper)
{
    const Model *model = shaper->model;
    Shapes *shapes = shaper->shapes;
    const size_t count = (size_t)model->wheels + 1;
    shapes->center = pool_alloc(shaper->pool, count * sizeof *shapes->center);
    shapes->axis = pool_alloc(shaper->pool, count * sizeof *shapes->axis);
    shapes->width = pool_alloc(shaper->pool, count * sizeof *shapes->width);
    for (int w = 0; w < model->wheels; ++w) {
        const Wheel *wheel = &model->wheel[w];
        double A[9];
        mat_from_euler(model->body[wheel->body].euler, A);
        apply3_transposed(A, (const double[]){0, 1, 0}, shapes->axis[w]);
        if (wheel->tire >= 0)
            vector(model, wheel->axis, shapes->axis[w]);
        vector(model, wheel->center, shapes->center[w]);
        const double width = wheel->tire >= 0 ? model->tire[wheel->tire].width : 0;
        shapes->width[w] = width > 0 ? width : 0.6 * wheel->radius; /* a usual width of car tires */
        add_point(shaper, wheel->body, shapes->center[w]);
    }
}

Shapes shapes_of(Pool *pool, const Model *model, const Scene *scene)
{
    Shapes shapes = {.body = pool_alloc(pool, (size_t)model->bodies * sizeof *shapes.body)};
    const Shaper shaper = {pool, model, &shapes};
    set_parameters(model, scene->parameter);
    for (int b = 0; b < model->bodies; ++b) {
        vector(model, model->body[b].com, shapes.body[b].com);
        inertia_box(model, &model->body[b], shapes.body[b].box);
        if (model->body[b].mass > 0)
            add_point(&shaper, b, shapes.body[b].com);
    }
    add_wheels(&shaper);
    add_lines(&shaper);
    for (int j = 0; j < model->joints; ++j)
        if (is_at_point(&model->joint[j]))
            add_points(&shaper, model->joint[j].body, model->joint[j].point);
    for (int i = 0; i < shapes.lines; ++i)
        for (int k = 0; k < 2; ++k)
            add_point(&shaper, shapes.line[i].body[k], shapes.line[i].point[k]);
    add_hinges(&shaper);
    looks_choose(pool, model, &shapes);
    set_parameters(model, NULL);
    return shapes;
}

/* ---- how large --------------------------------------------------------------------------------------------------- */

void pose_point(const double *pose, const double s[3], double out[3])
{
    double A[9];
    mat_from_euler(pose + 3, A);
    apply3(A, s, out);
    for (int i = 0; i < 3; ++i)
        out[i] += pose[i];
}

void shapes_bounds(const Model *model, const Shapes *shapes, const double *pose, double low[3], double high[3])
{
    for (int b = 0; b < model->bodies; ++b)
        for (int i = 0; i < shapes->body[b].points; ++i) {
            double x[3];
            pose_point(pose + 7 * b, shapes->body[b].point[i].x, x);
            for (int c = 0; c < 3; ++c) {
                low[c] = fmin(low[c], x[c]);
                high[c] = fmax(high[c], x[c]);
            }
        }
}

double shapes_size(const Model *model, const double low[3], const double high[3])
{
    double size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    for (int w = 0; w < model->wheels; ++w)
        size = fmax(size, 4 * model->wheel[w].radius);
    return size > 0 ? size : 1;
}
