/* SPDX-License-Identifier: MIT
 * The page of --drive: the vehicle as WebAssembly, what it looks like, and what one may move, in a page without other
 * files. The scripts are templates/drive*.in and some of templates/animate*.in. */
#include "run/drive.h"

#include "base/file.h"
#include "base/message.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_road.h"
#include "host/host.h"
#include "model/model.h"
#include "run/animate.h"
#include "run/run.h"
#include "scene/hands.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

typedef struct DrivePage {
    Page page; /* first: animate_json.c looks at it */
    const Model *model;
    const Scene *scene;
    const Request *request;
    const gic_model *code; /* descriptor */
    Shapes shapes;
    Roles roles;
    double size, lowest;
    const char *module;
    size_t module_size;
} DrivePage;

static void number(Text *out, const char *key, double value)
{
    char digits[CSV_DIGITS];
    text_print(out, "\"%s\":%s", key, csv_digits(value, digits));
}

/* ---- what one may move --------------------------------------------------------------------------------------------
 */

/* The ends of an input's slider: those of its role, of its driven coordinate, of the scene's profile, else 0 and 1. */
static void ends_of(const DrivePage *p, int input, double *low, double *high)
{
    const Coordinate *driven = scene_driven_by(p->model, input);
    const double now = p->model->input[input].initial;
    *low = fmin(now, 0);
    *high = fmax(now, 1);
    if (input == p->roles.accelerator || input == p->roles.brake)
        return;
    if (input == p->roles.selector && p->model->powertrain)
        *low = p->model->powertrain->reverse ? -1 : 0;
    if (driven) {
        *low = driven->range[0];
        *high = driven->range[1];
    }
    for (int i = 0; i < p->scene->profiles; ++i)
        if (p->scene->profile[i].input == input) {
            const ProfilePeaks peaks = profile_peaks(&p->scene->profile[i], p->scene->duration);
            *low = fmin(*low, peaks.low);
            *high = fmax(*high, peaks.high);
        }
}

static const char *role_of(const Roles *roles, int input)
{
    return input == roles->accelerator ? "accelerator"
           : input == roles->brake     ? "brake"
           : input == roles->steering  ? "steering"
           : input == roles->selector  ? "selector"
                                       : "";
}

static void json_hands(const DrivePage *p, Text *out)
{
    const char *between = "\n";
    text_print(out, "\"hands\":[");
    for (int i = 0; i < p->model->inputs; ++i) {
        const Input *input = &p->model->input[i];
        double low, high;
        if (strchr(input->name, '.'))
            continue;
        ends_of(p, i, &low, &high);
        text_print(out, "%s{", between);
        json_key(out, "name", input->name);
        json_key(out, "unit", input->unit);
        json_key(out, "role", role_of(&p->roles, i));
        text_print(out, "\"input\":%d,", i);
        number(out, "rest", input->initial);
        text_print(out, ",");
        number(out, "low", low);
        text_print(out, ",");
        number(out, "high", high);
        text_print(out, "}");
        between = ",\n";
    }
    text_print(out, "],\n");
    number(out, "left", p->roles.left);
    text_print(out, ",");
    number(out, "right", p->roles.right);
    text_print(out, ",\n");
}

/* Parameters in the order of parameter[]. */
static void json_parameters(const DrivePage *p, Text *out)
{
    text_print(out, "\"parameters\":[");
    for (int k = 0; k < p->model->tunables; ++k)
        for (int i = 0; i < p->model->parameters; ++i) {
            const Parameter *parameter = &p->model->parameter[i];
            if (!parameter->tunable || parameter->index != k)
                continue;
            text_print(out, "%s{", k ? ",\n" : "\n");
            json_key(out, "name", parameter->name);
            json_key(out, "unit", parameter->unit ? parameter->unit : "1");
            number(out, "value", p->scene->parameter[k]);
            text_print(out, "}");
        }
    text_print(out, "],\n");
}

/* ---- what is seen -------------------------------------------------------------------------------------------------
 */

static void json_drive_wheels(const DrivePage *p, Text *out)
{
    const int first = 7 * p->model->bodies;
    text_print(out, "\"wheels\":[");
    for (int w = 0; w < p->model->wheels; ++w) {
        const Wheel *wheel = &p->model->wheel[w];
        const int angle = first + 7 * w, spin = wheel->tire >= 0 ? p->code->slow_count + wheel->fast : -1;
        text_print(out, w ? ",\n" : "\n");
        json_wheel(out, p->model, &p->shapes, w, angle);
        text_print(out, ",\"spin\":%d,\"told\":[%d,%d,%d],\"force\":[%d,%d,%d],\"contact\":[%d,%d,%d]}", spin,
                   animate_output(p->model, OUTPUT_WHEEL, w), animate_output(p->model, OUTPUT_TIRE, w),
                   animate_output(p->model, OUTPUT_CONTACT, w), angle + 1, angle + 2, angle + 3, angle + 4, angle + 5,
                   angle + 6);
    }
    text_print(out, "],\n");
}

static void json_signals(const DrivePage *p, Text *out)
{
    const Scene *scene = p->scene;
    text_print(out, "\"signals\":[");
    for (int i = 0; i < p->code->output_count + p->code->input_count; ++i) {
        text_print(out, i ? ",\n{" : "\n{");
        json_key(out, "name", scene->signal[i].name);
        json_key(out, "unit", scene->signal[i].unit);
        text_print(out, "\"quantity\":");
        json_text(out, unit_quantity(scene->signal[i].unit));
        text_print(out, "}");
    }
    text_print(out, "],\n\"columns\":[");
    for (int i = 0; i < scene->columns; ++i)
        text_print(out, "%s%d", i ? "," : "", scene->column[i]);
    text_print(out, "],\"plotted\":[");
    for (int i = 0; i < scene->curves; ++i)
        text_print(out, "%s%d", i ? "," : "", scene->curve[i]);
    text_print(out, "],\n");
}

static bool is_level(const gic_road *road)
{
    return !road || road->height == gic_plane_height;
}

static void write_data(void *context, Text *out, int indent)
{
    const DrivePage *p = context;
    const char *slash = strrchr(p->request->scene, '/');
    (void)indent;
    text_print(out, "{");
    json_key(out, "model", p->model->name);
    json_key(out, "description", p->model->description);
    json_key(out, "scene", slash ? slash + 1 : p->request->scene);
    json_drawing(out, p->model);
    json_units(out, p->scene);
    text_print(out, "\"free\":%s,\"size\":%.6g,\"lowest\":%.6g,\"level\":%s,\n", p->model->free_base ? "true" : "false",
               p->size, p->lowest, is_level(p->scene->road) ? "true" : "false");
    number(out, "step", p->scene->step);
    text_print(out, ",\"outputs\":%d,\"look\":%d,\"driver\":%s,\"states\":%d,\"gear\":%d,\n", p->code->output_count,
               hands_steps(p->scene->step), p->scene->driver ? "true" : "false",
               p->code->slow_count + p->code->fast_count, p->model->powertrain ? p->code->free_base : -1);
    /* of the base: FORMAT.md section 10 */
    text_print(out, "\"velocity\":%d,\n", p->code->slow_count / 2 + 1);
    json_bodies(out, p->model, &p->shapes);
    json_lines(out, &p->shapes);
    json_drive_wheels(p, out);
    json_hands(p, out);
    json_parameters(p, out);
    json_signals(p, out);
    json_course(out, p->scene);
    text_print(out, "}\n");
}

/* The module in base 64. */
static void write_code(void *context, Text *out, int indent)
{
    static const char letter[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const DrivePage *p = context;
    (void)indent;
    for (size_t i = 0; i < p->module_size; i += 3) {
        char four[4] = "====";
        unsigned bits = 0;
        const size_t left = p->module_size - i < 3 ? p->module_size - i : 3;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < left ? (unsigned char)p->module[i + k] : 0);
        for (size_t k = 0; k <= left; ++k)
            four[k] = letter[bits >> (18 - 6 * k) & 63];
        text_add(out, four, 4);
    }
    text_print(out, "\n");
}

static const Insertion page_point[] = {{"data", write_data}, {"code", write_code}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"drive.html.in", "drive_motion.js.in",
                                                             "drive_ground.js.in", "drive_input.js.in",
                                                             "drive_curves.js.in", "drive_gg.js.in", "drive_pace.js.in",
                                                             "drive_page.js.in", "drive_worker.js.in", NULL},
                                       page_point, &animate_parts};

/* Size and lowest point at the scene's start. */
static void measure(DrivePage *p, Pool *pool, const Engine *engine)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double *pose = pool_alloc(pool, sizeof *pose * 7 * ((size_t)p->model->bodies + 1));
    gic_head *self = instance_new(pool, engine);
    int status = scene_start(engine, p->scene, self);
    if (status == GIC_OK)
        status = engine->code->poses(self, pose);
    if (status != GIC_OK)
        diag_fail((Place){p->scene->source, 0, 0}, NULL, "the page can't start: %s",
                  instance_status(pool, engine->code, self, status));
    shapes_bounds(p->model, &p->shapes, pose, low, high);
    p->size = shapes_size(p->model, low, high);
    p->lowest = p->model->wheels ? 0 : low[2] - 0.05 * p->size;
}

void drive_write(Pool *pool, const Model *model, const Scene *scene, const Engine *engine, const Request *request)
{
    DrivePage p = {.page = {pool, model->name},
                   .model = model,
                   .scene = scene,
                   .request = request,
                   .code = engine->code,
                   .shapes = shapes_of(pool, model, scene)};
    Text page = {.pool = pool};
    measure(&p, pool, engine);
    p.roles = drive_roles(pool, model, scene, engine);
    const char *why, *remedy;
    p.module = drive_code(pool, model, scene, request, &p.module_size, &why, &remedy);
    if (!p.module)
        diag_fail(program_place(), remedy, "%s", why);
    templates_check(pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(pool, &page, NULL, "drive.html.in", model->name, NULL, &page_points, &p);
    file_write(request->driven, page.s, page.size);
}
