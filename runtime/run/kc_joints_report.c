/* SPDX-License-Identifier: MIT
 * --kc --joints: what joints and the steering carry: a table at the position of set-up, all positions as CSV, curves on
 * a page, two models beside each other. */
#include "base/file.h"
#include "base/text.h"
#include "base/version.h"
#include "base/vec3.h"
#include "emit/emit.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/kc_joints.h"
#include "run/panel.h"
#include "run/sheet.h"

#include <math.h>
#include <string.h>

struct KcCarrying {
    Pool *pool;
    const KcStudy *study;
    const KcJoints *joints;
    KcCarried *(*at)[KC_MOTIONS]; /* [axles] of [rows][KC_CASES][joints + 1]; NULL: no such motion */
    bool *seen;                   /* [axles][joints + 1] at the positions that are looked at */
    bool set_up_alone;            /* only the rows at set-up that tables show are looked at */
};

/* Cases that tables and pages show, and by how much of the load. The first DRAWN are those of pages. */
static const struct {
    int by;
    const char *title;
    double size;
} shown[] = {{KC_BY_SPRINGS, "springs", 1},
             {KC_BY_LOADS + 2 * KC_VERTICAL, "vertical", 1000},
             {KC_BY_LOADS + 2 * KC_LATERAL, "lateral", 1000},
             {KC_BY_LOADS + 2 * KC_LONGITUDINAL, "longitudinal", 1000},
             {KC_BY_LOADS + 2 * KC_ALIGNING, "aligning", 100},
             {KC_BY_LOADS + 2 * KC_VERTICAL + 1, "opp. vert.", 1000},
             {KC_BY_LOADS + 2 * KC_LONGITUDINAL + 1, "opp. long.", 1000},
             {KC_BY_LOADS + 2 * KC_ALIGNING + 1, "opp. align.", 100}};
enum { SHOWN = sizeof shown / sizeof *shown, DRAWN = KC_CASES_DRAWN };

static const KcCarried *carried_at(const KcCarrying *c, int axle, KcMotion motion, int row, int by, int j)
{
    return &c->at[axle][motion][((size_t)row * KC_CASES + (size_t)by) * (size_t)(c->joints->joints + 1) + (size_t)j];
}

/* The tension of a rod, what holds the steering, else how large the force is. */
static double number_of(const KcCarried *carried)
{
    return isnan(carried->along) ? norm3(carried->force) : carried->along;
}

static bool *seen_of(const KcCarrying *c, int axle)
{
    return c->seen + axle * (c->joints->joints + 1);
}

/* The motion whose row at set-up tables show; false: the axle can't be moved. */
static bool usual(const KcCarrying *c, int axle, KcMotion *motion, int *row)
{
    for (KcMotion m = 0; m < KC_MOTIONS; ++m)
        if (c->at[axle][m]) {
            *motion = m;
            *row = c->study->curve[axle][m]->zero;
            return true;
        }
    return false;
}

static void find_all(KcCarrying *c, const Kc *kc)
{
    const KcJoints *k = c->joints;
    const size_t size = (size_t)KC_CASES * (size_t)(k->joints + 1);
    c->at = pool_alloc(c->pool, (size_t)kc->axles * sizeof *c->at);
    c->seen = pool_alloc(c->pool, (size_t)kc->axles * (size_t)(k->joints + 1) * sizeof *c->seen);
    for (int a = 0; a < kc->axles; ++a) {
        bool done = false;
        for (KcMotion m = 0; m < KC_MOTIONS; ++m) {
            const KcCurve *curve = kc_joints_refusal(k, &kc->axle[a]) ? NULL : c->study->curve[a][m];
            c->at[a][m] = curve && !done ? pool_alloc(c->pool, (size_t)curve->rows * size * sizeof(KcCarried)) : NULL;
            for (int r = 0; c->at[a][m] && r < curve->rows; ++r) {
                if (c->set_up_alone && r != curve->zero)
                    continue;
                KcCarried *to = c->at[a][m] + (size_t)r * size;
                const char *why = kc_joints_at(k, &kc->axle[a], curve->row[r].w, to);
                if (why)
                    diag_fail((Place){kc->model->source, 0, 0}, NULL, "axle %s, %s: %s", kc->axle[a].name,
                              kc_motion_name[m], why);
                for (int j = 0; j <= k->joints; ++j)
                    seen_of(c, a)[j] = seen_of(c, a)[j] || kc_joint_seen(k, to, j);
            }
            done = c->set_up_alone && c->at[a][m];
        }
    }
}

static KcCarrying open_all(Pool *pool, const Model *model, const Scene *scene, const Request *request,
                           const KcStudy *study)
{
    KcCarrying c = {.pool = pool, .study = study};
    c.set_up_alone = !request->report && (request->compare || request->varied || !request->results);
    KcMotion motion;
    int row;
    c.joints = kc_joints_open(pool, model, scene, request->solve, study->kc);
    find_all(&c, study->kc);
    for (int a = 0; a < study->kc->axles; ++a)
        if (usual(&c, a, &motion, &row))
            return c;
    diag_fail((Place){model->source, 0, 0}, "name an axle whose joints hold its wheels",
              "no axle of model '%s' has joints whose loads are known: %s: %s", model->name, study->kc->axle[0].name,
              kc_joints_refusal(c.joints, &study->kc->axle[0]));
}

/* ---- a table -------------------------------------------------------------------------------------------- */

/* What a reader sees of joint j: its name; of the steering, which comes last, with the word. */
static const char *title_of(const KcCarrying *c, const KcAxle *axle, int j)
{
    if (j < c->joints->joints)
        return kc_joint_name(c->joints, axle, j);
    return pool_print(c->pool, "steering: %s", c->study->kc->model->coordinate[axle->steer].name);
}

static void print_axle(Text *out, const KcCarrying *c, int a)
{
    const KcAxle *axle = &c->study->kc->axle[a];
    KcMotion motion;
    int row;
    text_print(out, "\n%s\n", axle->name);
    if (kc_joints_refusal(c->joints, axle))
        text_print(out, "  not there: %s\n", kc_joints_refusal(c->joints, axle));
    if (!usual(c, a, &motion, &row))
        return;
    text_print(out, "  %-18s", "N; steering N, N m");
    for (int i = 0; i < SHOWN; ++i)
        text_print(out, " %12s", shown[i].title);
    for (int j = 0; j <= c->joints->joints; ++j) {
        if (!seen_of(c, a)[j])
            continue;
        text_print(out, "\n  %-18s", title_of(c, axle, j));
        for (int i = 0; i < SHOWN; ++i)
            text_print(out, " %12s",
                       kc_shown(out->pool, number_of(carried_at(c, a, motion, row, shown[i].by, j)), shown[i].size));
    }
    text_print(out, "\n");
}

/* ---- CSV ------------------------------------------------------------------------------------------------ */

static const char *const component[6] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};

/* Does any axle load a joint? */
static bool seen_anywhere(const KcCarrying *c, int j)
{
    for (int a = 0; a < c->study->kc->axles; ++a)
        if (seen_of(c, a)[j])
            return true;
    return false;
}

static void cell(Csv *csv, double value)
{
    if (isnan(value))
        csv_text(csv, NULL);
    else
        csv_number(csv, value + 0.0);
}

static void write_row(Csv *csv, const KcCarrying *c, int a, KcMotion m, int r, int by)
{
    const Kc *kc = c->study->kc;
    const KcAxle *axle = &kc->axle[a];
    const KcRow *row = &c->study->curve[a][m]->row[r];
    const KcLoad load = by < KC_BY_LOADS ? KC_LOADS : kc_case_load(by);
    csv_name(csv, axle->name, NULL);
    csv_name(csv, kc_motion_name[m], NULL);
    cell(csv, m == KC_STEER ? 0 : row->at);
    cell(csv, axle->steer >= 0 ? row->w[axle->steer] : NAN);
    csv_name(csv, load < KC_LOADS ? kc_load_name[load] : "springs", NULL);
    csv_number(csv, load < KC_LOADS && kc_case_opposed(by));
    csv_name(csv, load == KC_LOADS ? "1" : load == KC_ALIGNING ? "N m" : "N", NULL);
    cell(csv, carried_at(c, a, m, r, by, c->joints->joints)->along);
    for (int j = 0; j < c->joints->joints; ++j) {
        const KcCarried *at = carried_at(c, a, m, r, by, j);
        if (!seen_anywhere(c, j))
            continue;
        for (int i = 0; i < 6; ++i)
            cell(csv, !seen_of(c, a)[j] ? NAN : i < 3 ? at->force[i] : at->torque[i - 3]);
        if (c->joints->rod[j] >= 0)
            cell(csv, seen_of(c, a)[j] ? at->along : NAN);
    }
    csv_end_row(csv);
}

static void write_csv(const KcCarrying *c, const char *path)
{
    static const char *const first[] = {"axle", "motion", "travel", "steering", "load", "opposed", "unit", "holds"};
    const Kc *kc = c->study->kc;
    interrupt_hold();
    Csv csv = csv_open(c->pool, path);
    for (size_t i = 0; i < sizeof first / sizeof *first; ++i)
        csv_name(&csv, first[i], NULL);
    for (int j = 0; j < c->joints->joints; ++j) {
        if (!seen_anywhere(c, j))
            continue;
        for (int i = 0; i < 6; ++i)
            csv_name(&csv, pool_print(c->pool, "%s.%s", c->joints->name[j], component[i]), NULL);
        if (c->joints->rod[j] >= 0)
            csv_name(&csv, pool_print(c->pool, "%s.tension", c->joints->name[j]), NULL);
    }
    csv_end_row(&csv);
    for (int a = 0; a < kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            for (int r = 0; c->at[a][m] && r < c->study->curve[a][m]->rows; ++r)
                for (int by = 0; by < KC_CASES; ++by)
                    write_row(&csv, c, a, m, r, by);
    csv_close(&csv);
    interrupt_release();
}

/* ---- numbers with names --------------------------------------------------------------------------------- */

/* Of number_of() by a unit of the load: N, or N m of a steering that turns; by N m of an aligning load. */
static const char *unit_of(const KcCarrying *c, const KcAxle *axle, int j, int by)
{
    static const char *const unit[2][3] = {{"N", "1", "1/m"}, {"N m", "m", "1"}};
    const bool turns = j == c->joints->joints && c->study->kc->model->coordinate[axle->steer].type == COORDINATE_ANGLE;
    return unit[turns][by < KC_BY_LOADS ? 0 : kc_case_load(by) == KC_ALIGNING ? 2 : 1];
}

Sheet kc_carrying_sheet(const KcCarrying *c, const Model *model)
{
    Sheet sheet = {.pool = c->pool, .model = model};
    for (int a = 0; a < c->study->kc->axles; ++a) {
        const KcAxle *axle = &c->study->kc->axle[a];
        const char *section = pool_print(c->pool, "Axle: %s", axle->name);
        KcMotion motion;
        int row;
        if (!usual(c, a, &motion, &row))
            continue;
        for (int j = 0; j <= c->joints->joints; ++j)
            for (int by = 0; by < KC_CASES && seen_of(c, a)[j]; ++by) {
                const KcCarried *at = carried_at(c, a, motion, row, by, j);
                const bool loaded = by >= KC_BY_LOADS;
                const char *name = kc_joint_name(c->joints, axle, j);
                const char *load = loaded ? kc_load_name[kc_case_load(by)] : "springs";
                const char *opposed = loaded && kc_case_opposed(by) ? "opposed" : "";
                if (isnan(number_of(at)))
                    continue;
                sheet_add(&sheet, section,
                          pool_print(c->pool, "%s.%s.%s%s%s", axle->name, name, load, *opposed ? "." : "", opposed),
                          pool_print(c->pool, "%s: %s%s%s", name, load, *opposed ? ", " : "", opposed),
                          unit_of(c, axle, j, by), number_of(at));
                if (by >= KC_BY_LOADS && kc_case_load(by) == KC_ALIGNING) { /* N by N m, which is no curvature */
                    sheet.row[sheet.rows - 1].shown = sheet.row[sheet.rows - 1].unit;
                    sheet.row[sheet.rows - 1].scale = 1;
                }
                section = NULL;
            }
    }
    return sheet;
}

/* ---- curves ---------------------------------------------------------------------------------------------- */

const KcCarrying *kc_carrying(Pool *pool, const Model *model, const Scene *scene, const Request *request,
                              const KcStudy *study)
{
    KcCarrying *c = pool_alloc(pool, sizeof *c);
    *c = open_all(pool, model, scene, request, study);
    return c;
}

const char *kc_carrying_curve(const KcCarrying *c, int axle, KcMotion motion, int drawn, int j, double *y,
                              const char **title, const char **unit)
{
    const KcAxle *of = &c->study->kc->axle[axle];
    if (c->set_up_alone || !c->at[axle][motion] || j > c->joints->joints)
        return NULL;
    const bool turns =
        j == c->joints->joints && of->steer >= 0 && c->study->kc->model->coordinate[of->steer].type == COORDINATE_ANGLE;
    for (int r = 0; r < c->study->curve[axle][motion]->rows; ++r)
        y[r] = seen_of(c, axle)[j] ? number_of(carried_at(c, axle, motion, r, shown[drawn].by, j)) * shown[drawn].size
                                   : NAN;
    *title = shown[drawn].title;
    *unit = turns ? "N m" : "N";
    return kc_joint_name(c->joints, of, j);
}

/* ---- the page ------------------------------------------------------------------------------------------- */

static void draw_motion(Text *out, const KcCarrying *c, int a, const KcCurve *of)
{
    const Kc *kc = c->study->kc;
    const KcAxle *axle = &kc->axle[a];
    double scale, *x = pool_alloc(c->pool, (size_t)of->rows * sizeof *x);
    double *y = pool_alloc(c->pool, (size_t)of->rows * DRAWN * sizeof *y);
    Panel panel = {.unit = "N", .rows = of->rows, .curves = DRAWN, .x = x, .y = y};
    panel.below = kc_abscissa(c->pool, kc, axle, of->motion, &scale);
    text_print(out, "<h3>%s", kc_motion_title[of->motion]);
    for (int i = 0; i < DRAWN; ++i)
        text_print(out, " <span style=\"color:%s\">%s%s</span>", panel_color(i),
                   i == 1 ? "&#9476;&#9476; " : "&#8212; ", shown[i].title);
    text_print(out, "</h3>\n<div class=\"curves\">\n");
    for (int j = 0; j <= c->joints->joints; ++j) {
        if (!seen_of(c, a)[j])
            continue;
        for (int r = 0; r < of->rows; ++r) {
            x[r] = of->row[r].at * scale;
            for (int i = 0; i < DRAWN; ++i)
                y[i * of->rows + r] = number_of(carried_at(c, a, of->motion, r, shown[i].by, j)) * shown[i].size;
        }
        panel.title = title_of(c, axle, j);
        if (j == c->joints->joints && kc->model->coordinate[axle->steer].type == COORDINATE_ANGLE)
            panel.unit = "N m";
        panel_draw(out, &panel);
    }
    text_print(out, "</div>\n");
}

static void write_axles(void *context, Text *out, int indent)
{
    const KcCarrying *c = context;
    (void)indent;
    kc_stops_html(out, c->study, NULL);
    for (int a = 0; a < c->study->kc->axles; ++a) {
        text_print(out, "<h2>Axle: %s</h2>\n", c->study->kc->axle[a].name);
        if (kc_joints_refusal(c->joints, &c->study->kc->axle[a]))
            text_print(out, "<p class=\"stop\">not there: %s</p>\n",
                       kc_joints_refusal(c->joints, &c->study->kc->axle[a]));
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            if (c->at[a][m])
                draw_motion(out, c, a, c->study->curve[a][m]);
    }
}

static void write_identity(void *context, Text *out, int indent)
{
    const KcCarrying *c = context;
    (void)indent;
    text_print(out, "<p>");
    text_html(out, c->study->kc->model->name);
    text_print(out,
               ": what joints and steering carry, by springs and by 1 kN or 100 N m a wheel. gicgen " GICGEN_VERSION
               ".</p>\n");
}

static const Insertion points[] = {{"identity", write_identity}, {"axles", write_axles}, {NULL, NULL}};
static const Insertions page_points = {(const char *const[]){"kc.html.in", NULL}, points, NULL};

static void write_page(KcCarrying *c, const char *path)
{
    Text out = {.pool = c->pool};
    templates_check(c->pool, NULL, (const Insertions *const[]){&page_points, NULL});
    template_expand(c->pool, &out, NULL, "kc.html.in", c->study->kc->model->name, NULL, &page_points, c);
    file_write(path, out.s, out.size);
}

/* ---- the page of two ------------------------------------------------------------------------------------ */

typedef struct Both {
    const KcCarrying *of[2];
    const char *name[2];
    const Sheet *sheet;
} Both;

/* The axle of a name, in a motion that it can make; -1: there is none. */
static int axle_of(const KcCarrying *c, const char *name, KcMotion m)
{
    for (int a = 0; a < c->study->kc->axles; ++a)
        if (!strcmp(c->study->kc->axle[a].name, name))
            return c->at[a][m] ? a : -1;
    return -1;
}

/* What a joint of that name carries in all drawn cases, y [DRAWN][rows]. Returns its unit; NULL: no load reaches it. */
static const char *find_carried(const KcCarrying *c, int a, KcMotion m, const char *name, int rows, double *y)
{
    const char *title, *unit, *own;
    for (int j = 0; (own = kc_carrying_curve(c, a, m, 0, j, y, &title, &unit)); ++j) {
        if (strcmp(own, name) != 0 || !seen_of(c, a)[j])
            continue;
        for (int i = 1; i < DRAWN; ++i)
            kc_carrying_curve(c, a, m, i, j, y + (size_t)i * (size_t)rows, &title, &unit);
        return unit;
    }
    return NULL;
}

/* The joint of a name in both vehicles, each with its own abscissae: a color a case, the other one dashed. */
static void draw_joint(Text *out, const Both *both, const int axle[2], KcMotion m, const char *name)
{
    int rows[2] = {0, 0}, at = 0;
    const char *unit = NULL;
    Panel panel = {.title = name, .curves = 2 * DRAWN, .pairs = true};
    for (int k = 0; k < 2; ++k)
        rows[k] = axle[k] >= 0 ? both->of[k]->study->curve[axle[k]][m]->rows : 0;
    panel.rows = rows[0] + rows[1];
    const size_t all = (size_t)panel.rows;
    double *x = pool_alloc(out->pool, (all + 1) * sizeof *x),
           *own = pool_alloc(out->pool, (DRAWN * all + 1) * sizeof *own);
    panel.x = x;
    panel.y = pool_alloc(out->pool, (2 * DRAWN * all + 1) * sizeof *panel.y);
    for (size_t i = 0; i < 2 * DRAWN * all; ++i)
        panel.y[i] = NAN;
    for (int k = 0; k < 2; at += rows[k++]) {
        if (axle[k] < 0)
            continue;
        const KcStudy *study = both->of[k]->study;
        const KcCurve *of = study->curve[axle[k]][m];
        const char *has = find_carried(both->of[k], axle[k], m, name, rows[k], own);
        double scale;
        const char *below = kc_abscissa(out->pool, study->kc, &study->kc->axle[axle[k]], m, &scale);
        panel.below = panel.below && strcmp(panel.below, below) != 0
                          ? pool_print(out->pool, "%s; %s", panel.below, below)
                          : below;
        for (int r = 0; r < rows[k]; ++r) {
            x[at + r] = of->row[r].at * scale;
            for (int i = 0; has && (!unit || !strcmp(unit, has)) && i < DRAWN; ++i)
                panel.y[(size_t)(2 * i + k) * all + (size_t)(at + r)] = own[i * rows[k] + r];
        }
        unit = unit ? unit : has;
    }
    panel.unit = unit;
    panel_draw(out, &panel);
}

static void draw_both(Text *out, const Both *both, const char *name, KcMotion m)
{
    const int axle[2] = {axle_of(both->of[0], name, m), axle_of(both->of[1], name, m)};
    if (axle[0] < 0 && axle[1] < 0)
        return;
    text_print(out, "<h3>%s: %s", name, kc_motion_title[m]);
    for (int i = 0; i < DRAWN; ++i)
        text_print(out, " <span style=\"color:%s\">&#8212; %s</span>", panel_color(i), shown[i].title);
    text_print(out, "</h3>\n<div class=\"curves\">\n");
    for (int k = 0; k < 2; ++k)
        for (int j = 0; axle[k] >= 0 && j <= both->of[k]->joints->joints; ++j) {
            const KcCarrying *c = both->of[k], *first = both->of[0];
            const char *joint = kc_joint_name(c->joints, &c->study->kc->axle[axle[k]], j);
            bool drawn = !seen_of(c, axle[k])[j];
            for (int i = 0; k && axle[0] >= 0 && i <= first->joints->joints; ++i)
                drawn = drawn || (seen_of(first, axle[0])[i] &&
                                  !strcmp(joint, kc_joint_name(first->joints, &first->study->kc->axle[axle[0]], i)));
            if (!drawn)
                draw_joint(out, both, axle, m, joint);
        }
    text_print(out, "</div>\n");
}

static void write_both(void *context, Text *out, int indent)
{
    const Both *both = context;
    (void)indent;
    for (int k = 0; k < 2; ++k)
        kc_stops_html(out, both->of[k]->study, both->name[k]);
    sheet_tables(both->sheet, out);
    for (int k = 0; k < 2; ++k)
        for (int a = 0; a < both->of[k]->study->kc->axles; ++a) {
            const char *name = both->of[k]->study->kc->axle[a].name;
            bool before = false;
            for (int b = 0; k && b < both->of[0]->study->kc->axles; ++b)
                before = before || !strcmp(both->of[0]->study->kc->axle[b].name, name);
            for (KcMotion m = 0; m < KC_MOTIONS && !before; ++m)
                draw_both(out, both, name, m);
        }
}

static void write_identity_of_both(void *context, Text *out, int indent)
{
    const Both *both = context;
    (void)indent;
    text_print(out,
               "<p>What joints and steering carry, by springs and by loads of each wheel (curves 1 kN or 100 N m, the "
               "table 1 N or 1 N m): ");
    text_html(out, both->name[0]);
    text_print(out, " drawn through, ");
    text_html(out, both->name[1]);
    text_print(out, " dashed. What differs is marked. gicgen " GICGEN_VERSION ".</p>\n");
}

static const Insertion points_of_both[] = {{"identity", write_identity_of_both}, {"axles", write_both}, {NULL, NULL}};
static const Insertions both_points = {(const char *const[]){"kc.html.in", NULL}, points_of_both, NULL};

static void write_page_of_both(Pool *pool, Both *both, const char *path)
{
    Text out = {.pool = pool};
    templates_check(pool, NULL, (const Insertions *const[]){&both_points, NULL});
    template_expand(pool, &out, NULL, "kc.html.in", both->name[0], NULL, &both_points, both);
    file_write(path, out.s, out.size);
}

static void compare(Pool *pool, const Model *model, const KcCarrying *c, const Request *request)
{
    const char *name;
    const Model *model_of_other = sheet_other(pool, model, request->compare, &name);
    const KcStudy study = kc_study(pool, model_of_other, NULL, request);
    kc_must_move(model_of_other, &study);
    const KcCarrying other = open_all(pool, model_of_other, NULL, request, &study);
    Sheet sheet = kc_carrying_sheet(c, model);
    const Sheet beside = kc_carrying_sheet(&other, model_of_other);
    sheet_compare(&sheet, &beside, name);
    if (request->results)
        sheet_csv(&sheet, request->results);
    if (request->report)
        write_page_of_both(pool, &(Both){{c, &other}, {model->name, name}, &sheet}, request->report);
    if (!request->results && !request->report)
        sheet_print(&sheet, ": joints, models/KC.md defines it");
}

void kc_joints_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    const KcStudy study = kc_study(pool, model, scene, request);
    kc_must_move(model, &study);
    KcCarrying c = open_all(pool, model, scene, request, &study);
    if (request->compare) {
        compare(pool, model, &c, request);
        return;
    }
    if (request->results)
        write_csv(&c, request->results);
    if (request->report)
        write_page(&c, request->report);
    Text text = {.pool = pool}, *out = &text;
    if (request->results || request->report) {
        kc_tell_stops(out, &study, pool_print(pool, "%s: note: ", program_place().source->path));
        if (text.s && !request->quiet)
            diag_note(text.s);
        return;
    }
    text_print(out, "what joints of %s carry, by springs and by 1 kN or 100 N m a wheel; models/KC.md defines it\n",
               model->name);
    for (int a = 0; a < study.kc->axles; ++a)
        print_axle(out, &c, a);
    text_print(out, "\n");
    kc_tell_stops(out, &study, "");
    diag_text(text.s);
}
