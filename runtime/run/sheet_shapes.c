/* SPDX-License-Identifier: MIT
 * Pictures of mode shapes for the sheet: the base as a box over its axles, and the wheels, from the side and from
 * behind, in motion over one period. They move by the eigenvector alone, as if the mode did not decay. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/sheet.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

enum { CORNERS = SHEET_CORNERS, PHASES = 16, WIDE = 150, TALL = 70 };

static const double pi = 3.141592653589793;
static const double largest = 0.12; /* displacement over wheelbase, or over the track of a single axle */
static const double small = 1e-5;   /* of the eigenvector, for its displacements: pictures only */

/* Corners of a box over the wheels' centres at design, in the frame of the base's body. */
static void box(const Sheet *sheet, double corner[CORNERS][3])
{
    const Model *model = sheet->model;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int w = 0; w < model->wheels; ++w) {
        const Wheel *wheel = &model->wheel[w];
        const Body *body = &model->body[wheel->body];
        double A[9], at[3];
        mat_from_euler(body->euler, A);
        apply3(A, wheel->center, at);
        for (int i = 0; i < 3; ++i) {
            at[i] += body->position[i] - model->body[BODY_BASE].position[i];
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    const double tall = 0.25 * (high[0] - low[0] + high[1] - low[1]);
    for (int k = 0; k < CORNERS; ++k) {
        const double at[3] = {k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], high[2] + (k & 4 ? tall : 0)};
        double A[9];
        mat_from_euler(model->body[BODY_BASE].euler, A);
        apply3_transposed(A, at, corner[k]);
    }
}

/* Places of all points of an instance. Returns a status. */
static int places(const Sheet *sheet, Instance *self, double (*out)[3])
{
    const Model *model = sheet->model;
    const gic_model *code = sheet->found->engine->code;
    double pose[7 * model->bodies], corner[CORNERS][3], A[9];
    int status = code->outputs(self);
    if (status == GIC_OK)
        status = code->poses(self, pose);
    if (status != GIC_OK)
        return status;
    box(sheet, corner);
    for (int k = 0; k < CORNERS + model->wheels; ++k) {
        const int body = k < CORNERS ? BODY_BASE : model->wheel[k - CORNERS].body;
        mat_from_euler(pose + 7 * body + 3, A);
        apply3(A, k < CORNERS ? corner[k] : model->wheel[k - CORNERS].center, out[k]);
        add_scaled3(1, pose + 7 * body, out[k]);
    }
    return GIC_OK;
}

bool sheet_shape_of(const Sheet *sheet, const Mode *mode, SheetShape *shape)
{
    const Linear *linear = sheet->found->linear;
    const gic_model *code = sheet->found->engine->code;
    const size_t size = (size_t)(CORNERS + sheet->model->wheels) * sizeof *shape->rest;
    Instance *self = (Instance *)(void *)instance_new(sheet->pool, sheet->found->engine);
    double *z = pool_alloc(sheet->pool, (size_t)linear->count * sizeof *z), most = 0;
    shape->points = CORNERS + sheet->model->wheels;
    shape->rest = pool_alloc(sheet->pool, size);
    memcpy(self, sheet->found->self, code->size);
    int status = places(sheet, self, shape->rest);
    for (int i = 0; i < 2 * linear->places; ++i)
        most = fmax(most, fabs(mode->shape[i]));
    for (int part = 0; part < 2 && status == GIC_OK && most > 0; ++part) {
        shape->move[part] = pool_alloc(sheet->pool, size);
        memcpy(self, sheet->found->self, code->size);
        for (int i = 0; i < linear->places; ++i)
            z[i] = small * mode->shape[part * linear->places + i] / most;
        linear_move(linear, self, z);
        status = places(sheet, self, shape->move[part]);
        for (int k = 0; k < shape->points && status == GIC_OK; ++k)
            sub3(shape->move[part][k], shape->rest[k], shape->move[part][k]);
    }
    return status == GIC_OK && most > 0;
}

/* A point in a phase, as a view from the side (axis 0) or from behind (axis 1) shows it. */
typedef struct View {
    const SheetShape *shape;
    int axis;
    double scale, grow, middle, ground;
} View;

static void at_phase(const View *view, int k, int phase, double out[2])
{
    const double turn = 2 * pi * phase / PHASES, c = view->grow * cos(turn), s = view->grow * sin(turn);
    double at[3];
    for (int i = 0; i < 3; ++i)
        at[i] = view->shape->rest[k][i] + c * view->shape->move[0][k][i] - s * view->shape->move[1][k][i];
    out[0] = WIDE / 2.0 + (view->axis ? -1 : 1) * view->scale * (at[view->axis] - view->middle);
    out[1] = TALL - 8 - view->scale * (at[2] - view->ground);
}

/* A polyline through points, in all phases. */
static void line(Text *out, const View *view, const int *point, int count)
{
    double at[2];
    text_print(
        out,
        "<polygon class=\"base\"><animate attributeName=\"points\" dur=\"2s\" repeatCount=\"indefinite\" values=\"");
    for (int phase = 0; phase <= PHASES; ++phase)
        for (int i = 0; i < count; ++i) {
            at_phase(view, point[i], phase, at);
            text_print(out, "%s%.1f,%.1f", i ? " " : phase ? ";" : "", at[0], at[1]);
        }
    text_print(out, "\"/></polygon>\n");
}

static void disc(Text *out, const View *view, int k, double radius)
{
    static const char *const name[] = {"cx", "cy"};
    double at[2];
    text_print(out, "<ellipse class=\"wheel\" rx=\"%.1f\" ry=\"%.1f\">", view->axis ? radius * 0.25 : radius, radius);
    for (int i = 0; i < 2; ++i) {
        text_print(out, "<animate attributeName=\"%s\" dur=\"2s\" repeatCount=\"indefinite\" values=\"", name[i]);
        for (int phase = 0; phase <= PHASES; ++phase) {
            at_phase(view, k, phase, at);
            text_print(out, "%s%.1f", phase ? ";" : "", at[i]);
        }
        text_print(out, "\"/>");
    }
    text_print(out, "</ellipse>\n");
}

void sheet_shape(const Sheet *sheet, const Mode *mode, Text *out)
{
    static const int outline[2][4] = {{0, 1, 5, 4}, {0, 2, 6, 4}};
    const Model *model = sheet->model;
    SheetShape shape;
    if (!sheet_shape_of(sheet, mode, &shape))
        return;
    double most = 0, low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < shape.points; ++k)
        for (int i = 0; i < 3; ++i) {
            most = fmax(most, hypot(shape.move[0][k][i], shape.move[1][k][i]));
            low[i] = fmin(low[i], shape.rest[k][i]);
            high[i] = fmax(high[i], shape.rest[k][i]);
        }
    const double size = fmax(high[0] - low[0], high[1] - low[1]);
    if (!(most > 0 && size > 0))
        return;
    for (int axis = 0; axis < 2; ++axis) {
        const View view = {&shape,
                           axis,
                           0.6 * WIDE / size,
                           largest * size / most,
                           (low[axis] + high[axis]) / 2,
                           low[2] - model->wheel[0].radius};
        text_print(out, "<svg class=\"shape\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\">", WIDE, TALL, WIDE,
                   TALL);
        text_print(out, "<path d=\"M0 %dH%d\" stroke=\"#bbb\"/>\n", TALL - 8, WIDE);
        line(out, &view, outline[axis], 4);
        for (int w = 0; w < model->wheels; ++w)
            disc(out, &view, CORNERS + w, view.scale * model->wheel[w].radius);
        text_print(out, "</svg>");
    }
}
