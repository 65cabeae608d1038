/* SPDX-License-Identifier: MIT
 * The scene of a page of --drive as C: tables that templates/drive.c.in works with. */
#include "base/message.h"
#include "gic_road.h"
#include "host/host.h"
#include "run/drive.h"
#include "run/variable_step.h"
#include "scene/driver.h"
#include "scene/hands.h"
#include "scene/profile.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* Numbers of a road: 20 MB of C. */
enum { ROAD_MOST = 1000000 };

static void number(Text *out, double value)
{
    char digits[CSV_DIGITS];
    csv_digits(value, digits);
    if (isinf(value))
        text_print(out, value < 0 ? "-INFINITY" : "INFINITY");
    else
        text_print(out, strpbrk(digits, ".e") ? "%s" : "%s.0", digits);
}

/* A table `name` of a type, without numbers one 0. */
static void numbers(Text *out, const char *name, const double *value, int count)
{
    text_print(out, "static double %s[] = {", name);
    for (int i = 0; i < count; ++i) {
        text_print(out, i % 8 ? ", " : "\n    ");
        number(out, value[i]);
        if (i % 8 == 7 && i + 1 < count)
            text_print(out, ",");
    }
    text_print(out, count ? "};\n" : "0};\n");
}

/* ---- road -------------------------------------------------------------------------------------------------------- */

typedef struct RoadText {
    Text *out;
    const Scene *scene;
    int roads, left; /* numbers that may still come */
} RoadText;

static void road_numbers(RoadText *r, const char *name, const double *value, int count)
{
    r->left -= count;
    if (r->left < 0)
        diag_fail((Place){r->scene->source, 0, 0}, "make the road shorter, or its spacing larger",
                  "the road has more than %d numbers, too many for a page", ROAD_MOST);
    numbers(r->out, pool_print(r->out->pool, "%s_%d", name, r->roads), value, count);
}

/* "road_3 = {{height, friction}", of a type. */
static void road_head(const RoadText *r, int own, const char *type, const char *height, const char *friction)
{
    text_print(r->out, "static const gic_road_%s road_%d = {{gic_%s_height, %s}", type, own, height, friction);
}

static void road_values(const RoadText *r, const double *value, int count)
{
    for (int i = 0; i < count; ++i) {
        text_print(r->out, ", ");
        number(r->out, value[i]);
    }
}

static void bumps_text(RoadText *r, const gic_road_bumps *road, int own)
{
    const int width = sizeof *road->bump / sizeof(double);
    r->left -= width * road->count;
    text_print(r->out, "static const gic_bump bump_%d[] = {", own);
    for (int i = 0; i < road->count; ++i) {
        const gic_bump *b = &road->bump[i];
        const double value[] = {b->x, b->length, b->height, b->y_low, b->y_high};
        text_print(r->out, "%s{", i ? ",\n    " : "\n    ");
        for (int k = 0; k < width; ++k) {
            text_print(r->out, k ? ", " : "");
            number(r->out, value[k]);
        }
        text_print(r->out, "}");
    }
    text_print(r->out, road->count ? "};\n" : "{0}};\n");
    road_head(r, own, "bumps", "bumps", "NULL");
    text_print(r->out, ", bump_%d, %d, ", own, road->count);
    number(r->out, road->longest);
}

static void table_text(RoadText *r, const gic_road_table *road, int own)
{
    const struct {
        const char *name;
        const double *value;
    } part[] = {{"x", road->x},
                {"left", road->left},
                {"right", road->right},
                {"slope_left", road->slope_left},
                {"slope_right", road->slope_right}};
    for (size_t i = 0; i < sizeof part / sizeof *part; ++i)
        road_numbers(r, part[i].name, part[i].value, road->count);
    road_head(r, own, "table", "table", "NULL");
    for (size_t i = 0; i < sizeof part / sizeof *part; ++i)
        text_print(r->out, ", %s_%d", part[i].name, own);
    text_print(r->out, ", %d", road->count);
}

static void grid_text(RoadText *r, const gic_road_grid *road, int own)
{
    road_numbers(r, "height", road->height, road->nx * road->ny);
    road_head(r, own, "grid", "grid", "NULL");
    road_values(r, (const double[]){road->x0, road->y0, road->dx, road->dy}, 4);
    text_print(r->out, ", %d, %d, height_%d", road->nx, road->ny, own);
}

static int road_text(RoadText *r, const gic_road *road);

static void sum_text(RoadText *r, const gic_road_sum *road, int *own)
{
    Text list = {.pool = r->out->pool};
    for (int i = 0; i < road->count; ++i)
        text_print(&list, "%s&road_%d.head", i ? ", " : "", road_text(r, road->part[i]));
    *own = ++r->roads;
    text_print(r->out, "static const gic_road *const part_%d[] = {%s};\n", *own, list.s);
    road_head(r, *own, "sum", "sum", "NULL");
    text_print(r->out, ", part_%d, %d", *own, road->count);
}

static void patched_text(RoadText *r, const gic_road_patched *road, int *own)
{
    const int under = road->under ? road_text(r, road->under) : 0;
    *own = ++r->roads;
    text_print(r->out, "static const gic_friction_patch patch_%d[] = {", *own);
    for (int i = 0; i < road->count; ++i) {
        const gic_friction_patch *p = &road->patch[i];
        const double value[] = {p->x_low, p->x_high, p->y_low, p->y_high, p->value, p->fade};
        text_print(r->out, "%s{", i ? ",\n    " : "\n    ");
        for (size_t k = 0; k < sizeof value / sizeof *value; ++k) {
            text_print(r->out, k ? ", " : "");
            number(r->out, value[k]);
        }
        text_print(r->out, "}");
    }
    text_print(r->out, road->count ? "};\n" : "{0}};\n");
    road_head(r, *own, "patched", "patched", "gic_patched_friction");
    text_print(r->out, under ? ", &road_%d.head, " : ", NULL, ", under);
    number(r->out, road->value);
    text_print(r->out, ", patch_%d, %d", *own, road->count);
}

/* The road, after the roads that it is made of. Returns its number. */
static int road_text(RoadText *r, const gic_road *road)
{
    const void *all = road;
    int own = 0;
    if (road->height == gic_sum_height) {
        sum_text(r, all, &own);
    } else if (road->height == gic_patched_height) {
        patched_text(r, all, &own);
    } else {
        own = ++r->roads;
        if (road->height == gic_plane_height) {
            const gic_road_plane *plane = all;
            road_head(r, own, "plane", "plane", "NULL");
            road_values(r, (const double[]){plane->z0, plane->sx, plane->sy}, 3);
        } else if (road->height == gic_sine_height) {
            const gic_road_sine *sine = all;
            road_head(r, own, "sine", "sine", "NULL");
            road_values(r, (const double[]){sine->amplitude, sine->wavelength, sine->x0, sine->phase_per_y}, 4);
        } else if (road->height == gic_bumps_height) {
            bumps_text(r, all, own);
        } else if (road->height == gic_table_height) {
            table_text(r, all, own);
        } else {
            grid_text(r, all, own);
        }
    }
    text_print(r->out, "};\n");
    return own;
}

static void put_road(Text *out, const Scene *scene)
{
    RoadText r = {out, scene, 0, ROAD_MOST};
    if (scene->road)
        text_print(out, "static const gic_road *const road = &road_%d.head;\n", road_text(&r, scene->road));
    else
        text_print(out, "static const gic_road *const road = NULL;\n");
}

/* ---- initial state ----------------------------------------------------------------------------------------------- */

static void put_start(Text *out, int *count, int index, double value)
{
    text_print(out, "%s{%d, ", (*count)++ ? ",\n    " : "\n    ", index);
    number(out, value);
    text_print(out, "}");
}

static void put_starts(Text *out, int *count, int first, const double *value, int values)
{
    for (int i = 0; i < values; ++i)
        put_start(out, count, first + i, value[i]);
}

/* As simulate.c sets the state: FORMAT.md section 10. */
static void put_state(Text *out, const Model *model, const Scene *scene)
{
    int slow = 0, fast = 0, own = 0, free = 0;
    for (int i = 0; i < model->coordinates; ++i)
        free += !model->coordinate[i].driven;
    const int pose = model->free_base ? 7 : 0, twist = model->free_base ? 6 : 0, half = pose + free;
    text_print(out, "static const Start slow_start[] = {");
    if (model->free_base) {
        if (scene->placed)
            put_starts(out, &slow, 0, scene->position, 3);
        put_starts(out, &slow, 3, scene->euler, 4);
        put_starts(out, &slow, half, scene->velocity, 3);
        put_starts(out, &slow, half + 3, scene->angular_velocity, 3);
    }
    for (int i = 0; i < model->coordinates; ++i) {
        if (model->coordinate[i].driven)
            continue;
        if (scene->given[i])
            put_start(out, &slow, pose + own, scene->value[i]);
        put_start(out, &slow, half + twist + own++, scene->rate[i]);
    }
    text_print(out, slow ? "};\nstatic const Start fast_start[] = {" : "{0}};\nstatic const Start fast_start[] = {");
    for (int i = 0; i < model->fast_states; ++i)
        if (!isnan(scene->fast[i]))
            put_start(out, &fast, i, scene->fast[i]);
    text_print(out, fast ? "};\n" : "{0}};\n");
    text_print(out, "enum { SLOW_STARTS = %d, FAST_STARTS = %d, GEAR = %d };\n", slow, fast, (int)scene->gear);
}

/* ---- what drives ------------------------------------------------------------------------------------------------- */

/* A formula of time as a curve with its values, rates and accelerations at the ends of steps. */
static Profile without_formula(Pool *pool, const Scene *scene, const Profile *from)
{
    enum { MOST = 100000 };
    Profile p = *from;
    if (p.form != PROFILE_FORMULA)
        return p;
    p.count = (int)fmin(ceil(scene->duration / scene->step), MOST) + 1;
    double **part[] = {&p.time, &p.value, &p.rate, &p.acceleration};
    for (int k = 0; k < 4; ++k)
        *part[k] = pool_alloc(pool, sizeof(double) * (size_t)p.count);
    for (int i = 0; i < p.count; ++i) {
        double out[3];
        p.time[i] = i * scene->duration / (p.count - 1);
        profile_at(from, p.begin + p.time[i], out);
        for (int k = 0; k < 3; ++k)
            (*part[k + 1])[i] = out[k];
    }
    p.form = PROFILE_CURVE;
    return p;
}

static void profile_tables(Text *out, const Profile *p, const char *name)
{
    const struct {
        const char *name;
        const double *value;
    } part[] = {{"time", p->time}, {"value", p->value}, {"rate", p->rate}, {"acceleration", p->acceleration}};
    for (size_t i = 0; i < sizeof part / sizeof *part; ++i)
        if (part[i].value)
            numbers(out, pool_print(out->pool, "%s_%s", name, part[i].name), part[i].value, p->count);
}

static void profile_text(Text *out, const Profile *p, const char *name)
{
    const struct {
        const char *name;
        bool there;
    } table[] = {{"time", p->time}, {"value", p->value}, {"rate", p->rate}, {"acceleration", p->acceleration}};
    const struct {
        const char *name;
        double value;
    } value[] = {{"begin", p->begin},   {"amplitude", p->amplitude}, {"frequency", p->frequency},
                 {"offset", p->offset}, {"start", p->start},         {"end", p->end},
                 {"last", p->last}};
    text_print(out, "{.input = %d, .driven = %d, .form = %d, .count = %d, .logarithmic = %d", p->input, p->driven,
               (int)p->form, p->count, p->logarithmic);
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i)
        if (table[i].there)
            text_print(out, ", .%s = %s_%s", table[i].name, name, table[i].name);
    for (size_t i = 0; i < sizeof value / sizeof *value; ++i)
        if (value[i].value != 0) {
            text_print(out, ", .%s = ", value[i].name);
            number(out, value[i].value);
        }
    text_print(out, "}");
}

static void put_profiles(Text *out, const Scene *scene)
{
    Text list = {.pool = out->pool};
    for (int i = 0; i < scene->profiles; ++i) {
        const char *name = pool_print(out->pool, "profile_%d", i);
        const Profile p = without_formula(out->pool, scene, &scene->profile[i]);
        profile_tables(out, &p, name);
        text_print(&list, i ? ",\n    " : "\n    ");
        profile_text(&list, &p, name);
    }
    text_print(out, "static const Profile profile[] = {%s};\n", scene->profiles ? list.s : "{0}");
}

static void put_driver(Text *out, const Scene *scene)
{
    const Driver *d = scene->driver;
    if (!d) {
        text_print(out, "static const Driver driver = {.accelerator = -1, .brake = -1, .steering = -1};\n");
        return;
    }
    const Profile target = without_formula(out->pool, scene, &d->speed);
    if (d->accelerator >= 0)
        profile_tables(out, &target, "speed");
    if (d->steering >= 0)
        numbers(out, "path", (const double *)d->path.point, 2 * d->path.count);
    const struct {
        const char *name;
        double value;
    } value[] = {{"gain", d->gain},           {"integral", d->integral},   {"straight", d->straight},
                 {"middle", d->middle},       {"full[0]", d->full[0]},     {"full[1]", d->full[1]},
                 {"per_angle", d->per_angle}, {"wheelbase", d->wheelbase}, {"preview", d->preview},
                 {"shortest", d->shortest},   {"limit", d->limit},         {"adapt", d->adapt},
                 {"period", d->period},       {"reach", d->reach},         {"path.step", d->path.step}};
    text_print(out, "static const Driver driver = {.accelerator = %d, .brake = %d, .steering = %d, .driven = %d",
               d->accelerator, d->brake, d->steering, d->driven);
    for (size_t i = 0; i < sizeof value / sizeof *value; ++i) {
        text_print(out, ",\n    .%s = ", value[i].name);
        number(out, value[i].value);
    }
    if (d->steering >= 0)
        text_print(out, ",\n    .path.count = %d, .path.closed = %d, .path.point = (double(*)[2])path", d->path.count,
                   d->path.closed);
    if (d->accelerator >= 0) {
        text_print(out, ",\n    .speed = ");
        profile_text(out, &target, "speed");
    }
    text_print(out, "};\n");
}

/* Times at which profiles of driven coordinates are less smooth: knot.c. */
static void put_knots(Text *out, const Scene *scene)
{
    enum { MOST = 10000 };
    double *time = NULL;
    int count = 0;
    for (double at = scene_next_knot(scene, 0); isfinite(at) && count < MOST; at = scene_next_knot(scene, at))
        *POOL_PUSH(out->pool, time, count) = at;
    numbers(out, "knot", time, count);
    text_print(out, "enum { KNOTS = %d };\n", count);
}

/* All inputs but rates and accelerations of driven coordinates. */
static void put_hands(Text *out, const Model *model)
{
    int hands = 0;
    text_print(out, "static const Hand hand[] = {");
    for (int i = 0; i < model->inputs; ++i)
        if (!strchr(model->input[i].name, '.'))
            text_print(out, "%s{.input = %d, .driven = %d}", hands++ ? ",\n    " : "\n    ", i,
                       scene_driven_by(model, i) != NULL);
    text_print(out, "%s{0}};\nenum { HANDS = %d };\n", hands ? ", " : "", hands);
}

void drive_scene(Text *out, const Model *model, const Scene *scene)
{
    if (scene->method >= METHOD_ADAMS)
        diag_fail((Place){scene->source, 0, 0}, "write `integrator: ab3` and a step",
                  "a page takes constant steps, and this scene has variable ones");
    scene_no_implicit(scene, "a page of --drive");
    put_road(out, scene);
    put_state(out, model, scene);
    put_profiles(out, scene);
    put_knots(out, scene);
    put_driver(out, scene);
    put_hands(out, model);
    text_print(out, "enum { PROFILES = %d, DRIVER = %d, PARAMETERS = %d, BODIES = %d };\n", scene->profiles,
               scene->driver != NULL, model->tunables, model->bodies);
    text_print(out, "enum { METHOD = %d, RATIO = %d, LOOK_STEPS = %d, LOCATE = %d, MOST = %d };\n", (int)scene->method,
               (int)scene->ratio, hands_steps(scene->step), scene->locate, scene->most_work);
    text_print(out, "static const double STEP = ");
    number(out, scene->step);
    text_print(out, ", STEADY = ");
    number(out, scene->steady);
    text_print(out, ";\n");
}
