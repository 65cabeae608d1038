/* SPDX-License-Identifier: MIT
 * What the pages of --animate and --drive have in common: shapes as JSON, and parts of the page. */
#include "base/vec3.h"
#include "emit/emit.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/animate.h"

#include <string.h>

enum { POSE = 7 };

int animate_output(const Model *model, OutputType type, int wheel)
{
    int at = 0;
    for (int i = 0; i < model->outputs; at += model->output[i++].count)
        if (model->output[i].type == type && model->output[i].index == wheel)
            return at;
    return -1;
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

void json_text(Text *out, const char *s)
{
    text_print(out, "\"");
    for (; s && *s; ++s)
        if (*s == '"' || *s == '\\')
            text_print(out, "\\%c", *s);
        else if ((unsigned char)*s < ' ' || *s == '<')
            text_print(out, "\\u%04x", (unsigned)*s);
        else
            text_add(out, s, 1);
    text_print(out, "\"");
}

void json_vector(Text *out, const char *key, const double v[3])
{
    text_print(out, "\"%s\":[%.6g,%.6g,%.6g]", key, v[0], v[1], v[2]);
}

void json_drawing(Text *out, const Model *model)
{
    double A[9], axis[3];
    mat_from_euler(model->body[BODY_BASE].euler, A);
    apply3_transposed(A, (const double[]){1, 0, 0}, axis);
    json_vector(out, "ahead", axis);
    text_print(out, ",");
    apply3_transposed(A, (const double[]){0, 0, 1}, axis);
    json_vector(out, "up", axis);
    text_print(out, ",");
}

void json_units(Text *out, const Scene *scene)
{
    text_print(out, "\"units\":{");
    for (int i = 0; i < scene->units; ++i)
        text_print(out, "%s\"%s\":[\"%s\",%.17g]", i ? "," : "", scene->unit[i]->of, scene->unit[i]->name,
                   scene->unit[i]->factor);
    text_print(out, "},\n");
}

void json_key(Text *out, const char *key, const char *value)
{
    text_print(out, "\"%s\":", key);
    json_text(out, value);
    text_print(out, ",");
}

void json_bodies(Text *out, const Model *model, const Shapes *shapes)
{
    text_print(out, "\"bodies\":[");
    for (int b = 0; b < model->bodies; ++b) {
        const Shape *shape = &shapes->body[b];
        text_print(out, "%s\n{", b ? "," : "");
        json_key(out, "name", model->body[b].name);
        text_print(out, "\"motion\":%d,\"mass\":%.6g,", POSE * b, model->body[b].mass);
        json_vector(out, "com", shape->com);
        text_print(out, ",");
        json_vector(out, "box", shape->box);
        text_print(out, ",");
        json_look(out, shape);
        text_print(out, ",\"points\":[");
        for (int i = 0; i < shape->points; ++i)
            text_print(out, "%s[%.6g,%.6g,%.6g]", i ? "," : "", shape->point[i].x[0], shape->point[i].x[1],
                       shape->point[i].x[2]);
        text_print(out, "]}");
    }
    text_print(out, "],\n");
}

void json_lines(Text *out, const Shapes *shapes)
{
    text_print(out, "\"lines\":[");
    for (int i = 0; i < shapes->lines; ++i) {
        const Line *line = &shapes->line[i];
        text_print(out, "%s\n{", i ? "," : "");
        json_key(out, "name", line->name);
        json_key(out, "kind", line->kind);
        text_print(out, "\"a\":%d,\"b\":%d,", line->body[0], line->body[1]);
        json_vector(out, "p", line->point[0]);
        text_print(out, ",");
        json_vector(out, "q", line->point[1]);
        if (!strcmp(line->kind, "bushing")) {
            text_print(out, ",");
            json_vector(out, "u", line->axis[0]);
            text_print(out, ",");
            json_vector(out, "v", line->axis[1]);
        }
        text_print(out, "}");
    }
    text_print(out, "],\n");
}

void json_wheel(Text *out, const Model *model, const Shapes *shapes, int w, int angle)
{
    const Wheel *wheel = &model->wheel[w];
    text_print(out, "{");
    json_key(out, "name", wheel->name);
    text_print(out, "\"body\":%d,\"radius\":%.6g,\"width\":%.6g,\"angle\":%d,", wheel->body, wheel->radius,
               shapes->width[w], angle);
    json_vector(out, "center", shapes->center[w]);
    text_print(out, ",");
    json_vector(out, "axis", shapes->axis[w]);
}

/* ---- parts of pages ---------------------------------------------------------------------------------------------- */

static void part(const Page *page, const char *name, Text *out)
{
    template_expand(page->pool, out, NULL, name, page->name, NULL, &animate_parts, NULL);
}

static void write_style(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_style.css.in", out);
}

static void write_vectors(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_vectors.js.in", out);
}

static void write_motion(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_motion.js.in", out);
}

static void write_mesh(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_mesh.js.in", out);
}

static void write_ground(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_ground.js.in", out);
}

static void write_view(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_view.js.in", out);
}

static void write_mouse(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_mouse.js.in", out);
}

static void write_ink(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_ink.js.in", out);
}

static void write_curves(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_curves.js.in", out);
}

static void write_wheels(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_wheels.js.in", out);
}

static void write_save(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_save.js.in", out);
}

static void write_page(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "animate_page.js.in", out);
}

static void write_drive_motion(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_motion.js.in", out);
}

static void write_drive_ground(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_ground.js.in", out);
}

static void write_drive_input(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_input.js.in", out);
}

static void write_drive_curves(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_curves.js.in", out);
}

static void write_drive_gg(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_gg.js.in", out);
}

static void write_drive_pace(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_pace.js.in", out);
}

static void write_drive_page(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_page.js.in", out);
}

static void write_worker(void *context, Text *out, int indent)
{
    (void)indent;
    part(context, "drive_worker.js.in", out);
}

static const Insertion part_point[] = {{"style", write_style},
                                       {"vectors", write_vectors},
                                       {"motion", write_motion},
                                       {"mesh", write_mesh},
                                       {"ground", write_ground},
                                       {"view", write_view},
                                       {"mouse", write_mouse},
                                       {"ink", write_ink},
                                       {"curves", write_curves},
                                       {"wheels", write_wheels},
                                       {"save", write_save},
                                       {"page", write_page},
                                       {"drive_motion", write_drive_motion},
                                       {"drive_ground", write_drive_ground},
                                       {"drive_input", write_drive_input},
                                       {"drive_curves", write_drive_curves},
                                       {"drive_gg", write_drive_gg},
                                       {"drive_pace", write_drive_pace},
                                       {"drive_page", write_drive_page},
                                       {"worker", write_worker},
                                       {NULL, NULL}};

const Insertions animate_parts = {(const char *const[]){NULL}, part_point, NULL};
