/* SPDX-License-Identifier: MIT
 * The page of --animate: poses of all bodies, wheels and curves at the frames, as JSON in a page without other
 * files. The scripts that show them are templates/animate*.in. */
#include "base/file.h"
#include "base/message.h"
#include "base/vec3.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_road.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/animate.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* Frames: 50 a second; more in a run so short that it would have less than FEWEST, fewer in one so long that it would
 * have more than MOST. FEWEST: smooth at a tenth of the speed; MOST: 6 MB for two minutes of the HMMWV. */
enum { FEWEST = 600, MOST = 6000 };

static const double frame_rate = 50;

enum { POSE = 7, WHEEL_CHANNELS = 10 }; /* angle, force, contact; load, longitudinal slip, slip angle */

/* Indices in output[] of a wheel's outputs, -1: none. */
typedef struct WheelOutputs {
    int wheel, tire, contact; /* fz, deflection, its rate, height; fx, fy, ...; x, y, z */
} WheelOutputs;

enum { TIRE_KAPPA = 5 }; /* component of OUTPUT_TIRE; alpha follows */

struct Animation {
    Page page; /* first: animate_json.c looks at it */
    Pool *pool;
    const Model *model;
    const Scene *scene;
    const char *scene_path;
    Shapes shapes;
    int64_t times, every; /* output times so far; one in `every` is a frame */
    int frames, channels;
    int wheels, curves;    /* index of their first channels, after those of the bodies */
    int *signal, signals;  /* of the scene, all that are not hidden; those of its `plot` first */
    const CsvTable *other; /* results of another run; NULL: none */
    const char *other_name;
    int others;         /* curves that it has, their channels after those of the curves */
    int *column, *mine; /* [others] column of it; index in signal[] */
    Ghost *ghost;       /* its vehicle; NULL: none */
    int ghosts;         /* index of its first channel: poses, and angles of wheels */
    WheelOutputs *told; /* [wheels] */
    double *spin;       /* [wheels] spins of wheels with tires at the frame before, rad/s */
    double *value;      /* [frames][channels] */
};

/* What the scene plots, then everything else that results could have. */
static void add_signals(Animation *a)
{
    const Model *model = a->model;
    const Scene *scene = a->scene;
    a->signal =
        pool_alloc(a->pool, sizeof *a->signal * (size_t)(model->output_components + model->inputs + scene->curves + 1));
    memcpy(a->signal, scene->curve, sizeof *a->signal * (size_t)scene->curves);
    a->signals = scene->curves;
    for (int at = 0, output = 0; at < model->output_components + model->inputs;) {
        const bool input = output >= model->outputs, hidden = !input && model->output[output].hidden;
        for (int last = at + (input ? 1 : model->output[output].count); at < last; ++at) {
            bool plotted = hidden;
            for (int i = 0; i < scene->curves; ++i)
                plotted = plotted || scene->curve[i] == at;
            if (!plotted)
                a->signal[a->signals++] = at;
        }
        ++output;
    }
}

/* The curves that another run has too, and its vehicle. */
static void add_others(Animation *a, const Engine *engine, const CsvTable *other, const char *other_name)
{
    const size_t room = sizeof(int) * ((size_t)a->signals + 1);
    a->column = pool_alloc(a->pool, room);
    a->mine = pool_alloc(a->pool, room);
    a->other = other;
    a->other_name = other_name;
    for (int i = 0; i < a->signals; ++i) {
        const int column = plot_column(a->pool, other, &a->scene->signal[a->signal[i]]);
        if (column < 0)
            continue;
        a->column[a->others] = column;
        a->mine[a->others++] = i;
    }
    a->channels += a->others;
    a->ghost = other->rows ? ghost_new(a->pool, a->model, engine, a->scene, other) : NULL;
    a->ghosts = a->channels;
    if (a->ghost)
        a->channels += POSE * a->model->bodies + a->model->wheels;
    if (!a->ghost && (!a->others || !other->rows))
        diag_fail((Place){other->source, 1, 1}, "give it results of a run with the outputs of the scene's `plot`",
                  "the table has none of the curves of the page");
    if (!a->ghost)
        diag_warn((Place){other->source, 1, 1},
                  a->model->free_base
                      ? "a second vehicle needs outputs `position` and `roll_pitch_yaw` or `orientation` "
                        "of the base in these results"
                      : "a second mechanism needs outputs of coordinates in these results",
                  "the page shows its curves only");
}

/* The value of a curve of the other run at a time, straight between its rows. */
static double other_value(const Animation *a, int i, double time)
{
    const CsvTable *t = a->other;
    int low = 0, high = t->rows - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (t->value[middle * t->columns] <= time)
            low = middle;
        else
            high = middle;
    }
    const double *p = t->value + low * t->columns, *q = t->value + high * t->columns;
    const double share = high > low ? fmin(fmax((time - p[0]) / (q[0] - p[0]), 0), 1) : 0;
    return share < 1 ? p[a->column[i]] + share * (q[a->column[i]] - p[a->column[i]]) : q[a->column[i]];
}

Animation *animation_new(Pool *pool, const Model *model, const Engine *engine, const Scene *scene,
                         const char *scene_path, const CsvTable *other, const char *other_name)
{
    Animation *a = pool_alloc(pool, sizeof *a);
    const double most = fmin(fmax(frame_rate * scene->duration, FEWEST), MOST);
    *a = (Animation){
        .page = {pool, model->name}, .pool = pool, .model = model, .scene = scene, .scene_path = scene_path};
    a->shapes = shapes_of(pool, model, scene);
    a->every = (int64_t)fmax(ceil((double)scene->outputs / most), 1);
    a->wheels = POSE * model->bodies;
    a->curves = a->wheels + WHEEL_CHANNELS * model->wheels;
    add_signals(a);
    a->channels = a->curves + a->signals;
    if (other)
        add_others(a, engine, other, other_name);
    a->told = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *a->told);
    for (int w = 0; w < model->wheels; ++w)
        a->told[w] = (WheelOutputs){animate_output(model, OUTPUT_WHEEL, w), animate_output(model, OUTPUT_TIRE, w),
                                    animate_output(model, OUTPUT_CONTACT, w)};
    a->spin = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *a->spin);
    a->value = pool_alloc(pool, (size_t)(scene->outputs / a->every + 1) * (size_t)a->channels * sizeof *a->value);
    return a;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* p and -p are the same orientation; take the one near the frame before, since frames are interpolated. */
static void keep_sign(double *pose, const double *before)
{
    double product = 0;
    for (int i = 3; i < POSE; ++i)
        product += pose[i] * before[i];
    for (int i = 3; i < POSE && product < 0; ++i)
        pose[i] = -pose[i];
}

static const double *pose_of(const double *frame, int body)
{
    return frame + POSE * body;
}

/* The angle of a wheel without tire: the way of its centre along the road since the frame before, divided by its
 * radius. */
static double rolled(const Animation *a, int w, const double *frame, const double *before)
{
    const Wheel *wheel = &a->model->wheel[w];
    const double up[3] = {0, 0, 1};
    double A[9], axis[3], ahead[3], now[3], then[3];
    mat_from_euler(pose_of(frame, wheel->body) + 3, A);
    apply3(A, a->shapes.axis[w], axis);
    cross3(axis, up, ahead);
    pose_point(pose_of(frame, wheel->body), a->shapes.center[w], now);
    pose_point(pose_of(before, wheel->body), a->shapes.center[w], then);
    for (int i = 0; i < 3; ++i)
        now[i] -= then[i];
    return dot3(now, ahead) / fmax(norm3(ahead), 1e-9) / wheel->radius;
}

/* The angle that the body of a wheel has turned about the wheel's axis since the frame before. */
static double carried(const Animation *a, int w, const double *frame, const double *before)
{
    const int body = a->model->wheel[w].body;
    const double *p = pose_of(before, body) + 3, *q = pose_of(frame, body) + 3;
    double turn[3]; /* vector part of the quaternion from p to q, frame of the body */
    cross3(q + 1, p + 1, turn);
    for (int i = 0; i < 3; ++i)
        turn[i] += p[0] * q[1 + i] - q[0] * p[1 + i];
    return 2 * asin(fmin(fmax(dot3(turn, a->shapes.axis[w]), -1), 1));
}

/* The angle of a wheel that spins, against the body that carries it, since the frame before. */
static double spun(const Animation *a, int w, const double *frame, const double *before, double spin)
{
    const double step = (double)a->every * a->scene->output_step;
    return (a->spin[w] + spin) / 2 * step - carried(a, w, frame, before);
}

/* Force on the tire in the world, from the outputs: along the contact axes (models/TIRES.md section 3). */
static void tire_force(const Animation *a, int w, const double *output, const double *frame, const double contact[3],
                       double force[3])
{
    const WheelOutputs *told = &a->told[w];
    const gic_road *road = a->scene->road;
    double h[3] = {0}, A[9], s[3], ahead[3], left[3];
    if (road)
        road->height(road, 0, 0, contact[0], contact[1], h);
    const double norm = sqrt(1 + h[1] * h[1] + h[2] * h[2]);
    const double normal[3] = {-h[1] / norm, -h[2] / norm, 1 / norm};
    mat_from_euler(pose_of(frame, a->model->wheel[w].body) + 3, A);
    apply3(A, a->shapes.axis[w], s);
    cross3(s, normal, ahead);
    const double length = fmax(norm3(ahead), 1e-6);
    for (int i = 0; i < 3; ++i)
        ahead[i] /= length;
    cross3(normal, ahead, left);
    for (int i = 0; i < 3; ++i) {
        force[i] = told->wheel >= 0 ? output[told->wheel] * normal[i] : 0;
        if (told->tire >= 0)
            force[i] += output[told->tire] * ahead[i] + output[told->tire + 1] * left[i];
    }
}

/* spin: of a wheel with a tire, rad/s; else 0. */
static void set_wheel(const Animation *a, int w, const double *output, double spin, double *frame, const double *before)
{
    const Wheel *wheel = &a->model->wheel[w];
    const WheelOutputs *told = &a->told[w];
    double *channel = frame + a->wheels + WHEEL_CHANNELS * w, *force = channel + 1, *contact = channel + 4;
    channel[0] = before ? before[a->wheels + WHEEL_CHANNELS * w] : 0;
    if (before)
        channel[0] += wheel->tire >= 0 ? spun(a, w, frame, before, spin) : rolled(a, w, frame, before);
    a->spin[w] = spin;
    pose_point(pose_of(frame, wheel->body), a->shapes.center[w], contact);
    if (told->wheel >= 0)
        channel[7] = output[told->wheel];
    for (int i = 0; told->tire >= 0 && i < 2; ++i)
        channel[8 + i] = output[told->tire + TIRE_KAPPA + i];
    if (told->wheel >= 0)
        contact[2] = output[told->wheel + 3];
    if (told->contact >= 0)
        memcpy(contact, output + told->contact, 3 * sizeof *contact);
    if (wheel->tire >= 0)
        tire_force(a, w, output, frame, contact, force);
    else if (told->wheel >= 0)
        force[2] = output[told->wheel];
}

/* The second vehicle: its wheels roll. */
static void set_ghost(const Animation *a, double time, double *frame, const double *before)
{
    double *pose = frame + a->ghosts, *angle = pose + POSE * a->model->bodies;
    ghost_poses(a->ghost, time, pose);
    for (int b = 0; before && b < a->model->bodies; ++b)
        keep_sign(pose + POSE * b, before + a->ghosts + POSE * b);
    for (int w = 0; w < a->model->wheels; ++w)
        angle[w] =
            before ? before[a->ghosts + POSE * a->model->bodies + w] + rolled(a, w, pose, before + a->ghosts) : 0;
}

int animation_frame(Animation *a, const gic_model *code, gic_head *self)
{
    if (a->times++ % a->every)
        return GIC_OK;
    const double *output = instance_array(self, code->output_offset);
    const double *fast = (const double *)instance_array(self, code->state_offset) + code->slow_count;
    double *frame = a->value + (size_t)a->frames * (size_t)a->channels;
    const double *before = a->frames ? frame - a->channels : NULL;
    const int status = code->poses(self, frame);
    if (status != GIC_OK)
        return status;
    for (int b = 0; before && b < a->model->bodies; ++b)
        keep_sign(frame + POSE * b, before + POSE * b);
    for (int w = 0; w < a->model->wheels; ++w)
        set_wheel(a, w, output, a->model->wheel[w].tire >= 0 ? fast[a->model->wheel[w].fast] : 0, frame, before);
    for (int i = 0; i < a->signals; ++i)
        frame[a->curves + i] = scene_value(code, self, a->signal[i]);
    for (int i = 0; i < a->others; ++i)
        frame[a->curves + a->signals + i] = other_value(a, i, gic_time(self));
    if (a->ghost)
        set_ghost(a, gic_time(self), frame, before);
    ++a->frames;
    return GIC_OK;
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

/* A power of ten, 1e-5 to 1e-4 of x. */
static double unit_for(double x)
{
    return x > 0 ? pow(10, floor(log10(x)) - 4) : 1;
}

static double channel_unit(const Animation *a, int c, double length)
{
    if (c < a->wheels)
        return c % POSE < 3 ? length : 1e-5;
    if (a->ghost && c >= a->ghosts && c < a->ghosts + a->wheels)
        return (c - a->ghosts) % POSE < 3 ? length : 1e-5;
    if (a->ghost && c >= a->ghosts + a->wheels)
        return 1e-3;
    if (c < a->curves && (c - a->wheels) % WHEEL_CHANNELS == 0)
        return 1e-3;
    if (c < a->curves && (c - a->wheels) % WHEEL_CHANNELS > 7)
        return 1e-5;
    if (c < a->curves && (c - a->wheels) % WHEEL_CHANNELS > 3 && (c - a->wheels) % WHEEL_CHANNELS < 7)
        return length;
    double most = 0;
    for (int k = 0; k < a->frames; ++k)
        most = fmax(most, fabs(a->value[(size_t)k * (size_t)a->channels + (size_t)c]));
    /* signals that nobody asked for may be zero but for rounding */
    return c >= a->curves + a->scene->curves ? fmax(unit_for(most), 1e-9) : unit_for(most);
}

/* Second differences of smooth motion are short numbers. */
static void json_channel(const Animation *a, int c, double unit, Text *out)
{
    int64_t value = 0, step = 0;
    bool still = true;
    text_print(out, "{\"unit\":%.9g,\"values\":[", unit);
    for (int k = 1; k < a->frames; ++k)
        still = still &&
                llround(a->value[(size_t)k * (size_t)a->channels + (size_t)c] / unit) == llround(a->value[c] / unit);
    for (int k = 0; k < (still ? 1 : a->frames); ++k) {
        const int64_t now = llround(a->value[(size_t)k * (size_t)a->channels + (size_t)c] / unit), change = now - value;
        text_print(out, "%s%lld", k ? "," : "", (long long)(k > 1 ? change - step : change));
        step = k ? change : 0;
        value = now;
    }
    text_print(out, "]}");
}

static void json_wheels(const Animation *a, Text *out)
{
    text_print(out, "\"wheels\":[");
    for (int w = 0; w < a->model->wheels; ++w) {
        const int angle = a->wheels + WHEEL_CHANNELS * w;
        text_print(out, w ? ",\n" : "\n");
        json_wheel(out, a->model, &a->shapes, w, angle);
        if (a->told[w].wheel >= 0 || a->told[w].tire >= 0)
            text_print(out, ",\"force\":[%d,%d,%d],\"contact\":[%d,%d,%d]", angle + 1, angle + 2, angle + 3, angle + 4,
                       angle + 5, angle + 6);
        if (a->told[w].wheel >= 0)
            text_print(out, ",\"load\":%d", angle + 7);
        if (a->told[w].tire >= 0)
            text_print(out, ",\"slip\":[%d,%d]", angle + 8, angle + 9);
        text_print(out, "}");
    }
    text_print(out, "],\n");
}

/* All signals, those of the scene's `plot` marked; then those of the other run. */
static void json_curves(const Animation *a, Text *out)
{
    text_print(out, "\"curves\":[");
    for (int k = 0; k < a->signals; ++k) {
        const gic_signal *signal = &a->scene->signal[a->signal[k]];
        text_print(out, "%s\n{", k ? "," : "");
        json_key(out, "name", signal->name);
        json_key(out, "unit", signal->unit);
        json_key(out, "quantity", unit_quantity(signal->unit));
        text_print(out, "\"values\":%d,\"plotted\":%s}", a->curves + k, k < a->scene->curves ? "true" : "false");
    }
    for (int k = 0; k < a->others; ++k) {
        const gic_signal *signal = &a->scene->signal[a->signal[a->mine[k]]];
        text_print(out, ",\n{");
        json_key(out, "name", pool_print(out->pool, "%s (%s)", signal->name, a->other_name));
        json_key(out, "unit", signal->unit);
        json_key(out, "quantity", unit_quantity(signal->unit));
        text_print(out, "\"values\":%d,\"beside\":%d,\"until\":%.9g}", a->curves + a->signals + k, a->mine[k],
                   a->other->value[(a->other->rows - 1) * a->other->columns]);
    }
    text_print(out, "],\n");
}

/* The second vehicle: null where there is none. */
static void json_ghost(const Animation *a, Text *out)
{
    const char *const *name;
    text_print(out, "\"ghost\":");
    if (!a->ghost) {
        text_print(out, "null,\n");
        return;
    }
    text_print(out, "{");
    json_key(out, "name", a->other_name);
    text_print(out, "\"motion\":%d,\"angle\":%d,\"until\":%.9g,\"untold\":[", a->ghosts, a->ghosts + a->wheels,
               ghost_end(a->ghost));
    const int untold = ghost_untold(a->ghost, &name);
    for (int i = 0; i < untold; ++i) {
        text_print(out, i ? "," : "");
        json_text(out, name[i]);
    }
    text_print(out, "]},\n");
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

/* Size of the vehicle at the start, or of all moving bodies on a fixed base; and the lowest height of any point at any
 * frame. */
static double extent(const Animation *a, double *lowest)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    *lowest = INFINITY;
    for (int k = 0; k < a->frames; ++k) {
        double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
        shapes_bounds(a->model, &a->shapes, a->value + (size_t)k * (size_t)a->channels, least, most);
        *lowest = fmin(*lowest, least[2]);
        for (int c = 0; c < 3 && (!k || !a->model->free_base); ++c) {
            low[c] = fmin(low[c], least[c]);
            high[c] = fmax(high[c], most[c]);
        }
    }
    return shapes_size(a->model, low, high);
}

/* The path of the base over the frames, along which the road is drawn, then that of the second vehicle; of a fixed base
 * the middle of the other bodies. */
static double *way_of(const Animation *a, int *count)
{
    const bool two = a->ghost && a->model->free_base;
    double *way = pool_alloc(a->pool, (size_t)a->frames * 4 * sizeof *way);
    *count = two ? 2 * a->frames : a->frames;
    for (int k = 0; k < a->frames && two; ++k)
        memcpy(way + 2 * (a->frames + k), a->value + (size_t)k * (size_t)a->channels + a->ghosts, 2 * sizeof *way);
    for (int k = 0; k < a->frames; ++k)
        for (int i = 0; i < 2; ++i) {
            const double *frame = a->value + (size_t)k * (size_t)a->channels;
            const int others = a->model->bodies - 1;
            if (a->model->free_base)
                way[2 * k + i] = frame[i];
            for (int b = 1; b <= others && !a->model->free_base; ++b)
                way[2 * k + i] += pose_of(frame, b)[i] / others;
        }
    return way;
}

static void json_run(const Animation *a, Text *out)
{
    double lowest;
    const double size = extent(a, &lowest), length = unit_for(size);
    const char *slash = strrchr(a->scene_path, '/');
    text_print(out, "{");
    json_key(out, "model", a->model->name);
    json_key(out, "description", a->model->description);
    json_key(out, "scene", slash ? slash + 1 : a->scene_path);
    json_drawing(out, a->model);
    json_units(out, a->scene);
    text_print(out, "\"free\":%s,\"size\":%.6g,\"frames\":%d,\"frame_step\":%.15g,\n",
               a->model->free_base ? "true" : "false", size, a->frames, (double)a->every * a->scene->output_step);
    json_bodies(out, a->model, &a->shapes);
    json_lines(out, &a->shapes);
    json_wheels(a, out);
    json_curves(a, out);
    json_ghost(a, out);
    json_course(out, a->scene);
    text_print(out, ",\n");
    text_print(out, "\"road\":");
    int places;
    const double *way = way_of(a, &places);
    const gic_road_plane below = {.head = {.height = gic_plane_height}, .z0 = lowest - 0.05 * size};
    const gic_road_plane level = {.head = {.height = gic_plane_height}};
    road_tiles(out, !a->model->wheels ? &below.head : a->scene->road ? a->scene->road : &level.head, size, way, places);
    text_print(out, ",\n\"channels\":[");
    for (int c = 0; c < a->channels; ++c) {
        text_print(out, c ? ",\n" : "\n");
        json_channel(a, c, channel_unit(a, c, length), out);
    }
    text_print(out, "]}\n");
}

static void write_data(void *context, Text *out, int indent)
{
    (void)indent;
    json_run(context, out);
}

static const Insertion page_point[] = {{"data", write_data}, {NULL, NULL}};

static const Insertions page_points = {(const char *const[]){"animate.html.in", "animate_motion.js.in",
                                                             "animate_ground.js.in", "animate_curves.js.in",
                                                             "animate_save.js.in", "animate_page.js.in", NULL},
                                       page_point, &animate_parts};

void animation_write(Animation *a, const char *path)
{
    Text page = {.pool = a->pool};
    templates_check(a->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(a->pool, &page, NULL, "animate.html.in", a->model->name, NULL, &page_points, a);
    file_write(path, page.s, page.size);
}
