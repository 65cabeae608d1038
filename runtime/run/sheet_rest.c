/* SPDX-License-Identifier: MIT
 * The sheet's masses, loads, attitude and axles at rest. Places and inertias are in the axes of the drawing, carried
 * along by the base. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/sheet.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

/* Rotation from the world to the carried axes, and the place of the drawing's origin in the world. */
typedef struct Carried {
    double turn[9], origin[3];
} Carried;

static Carried carried(const Sheet *sheet, const double *pose)
{
    const Body *base = &sheet->model->body[BODY_BASE];
    Carried c;
    double now[9], drawn[9], lever[3];
    mat_from_euler(pose + 3, now);
    mat_from_euler(base->euler, drawn);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            c.turn[3 * i + j] = 0;
            for (int k = 0; k < 3; ++k)
                c.turn[3 * i + j] += drawn[3 * i + k] * now[3 * j + k];
        }
    apply3_transposed(c.turn, base->position, lever);
    sub3(pose, lever, c.origin);
    return c;
}

/* inertia += that of a mass m at d, and of the axis u with the moment `spin`. */
static void add_point(double inertia[9], double m, const double d[3], double spin, const double u[3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            inertia[3 * i + j] += m * ((i == j ? dot3(d, d) : 0) - d[i] * d[j]) + spin * u[i] * u[j];
}

/* inertia += R I R^T of a body whose own axes have the rotation R to the carried ones. */
static void add_turned(double inertia[9], const double own[6], const double R[9])
{
    const double I[9] = {own[0], own[3], own[4], own[3], own[1], own[5], own[4], own[5], own[2]};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 9; ++k)
                inertia[3 * i + j] += R[3 * i + k / 3] * I[k] * R[3 * j + k % 3];
}

static void masses(Sheet *sheet, const double *pose, const Carried *c)
{
    static const double none[3];
    const Model *model = sheet->model;
    double inertia[9] = {0}, first[3] = {0}, (*at)[3], (*R)[9];
    at = pool_alloc(sheet->pool, (size_t)model->bodies * sizeof *at);
    R = pool_alloc(sheet->pool, (size_t)model->bodies * sizeof *R);
    for (int b = 0; b < model->bodies; ++b) {
        double A[9], com[3], world[3];
        mat_from_euler(pose + 7 * b + 3, A);
        apply3(A, model->body[b].com, com);
        for (int i = 0; i < 3; ++i)
            world[i] = pose[7 * b + i] + com[i] - c->origin[i];
        apply3(c->turn, world, at[b]);
        for (int k = 0; k < 9; ++k)
            for (int i = 0; i < 3; ++i)
                R[b][k] += c->turn[3 * (k / 3) + i] * A[3 * i + k % 3];
        sheet->mass += model->body[b].mass;
        add_scaled3(model->body[b].mass, at[b], first);
    }
    for (int i = 0; i < 3; ++i)
        sheet->com[i] = first[i] / sheet->mass;
    for (int b = 0; b < model->bodies; ++b) {
        double d[3];
        sub3(at[b], sheet->com, d);
        add_point(inertia, model->body[b].mass, d, 0, none);
        add_turned(inertia, model->body[b].inertia, R[b]);
    }
    for (int w = 0; w < model->wheels; ++w)
        if (model->wheel[w].tire >= 0) { /* its part was taken out of the body's inertia */
            double u[3];
            apply3(R[model->wheel[w].body], model->wheel[w].axis, u);
            add_point(inertia, 0, none, model->wheel[w].spin_inertia, u);
        }
    sheet_add(sheet, "Mass", "mass", "Mass", "kg", sheet->mass);
    sheet_add(sheet, NULL, "base_mass", "Mass of the base", "kg", model->body[BODY_BASE].mass);
    sheet_add(sheet, NULL, "com_x", "Centre of mass, x of the drawing", "m", sheet->com[0]);
    sheet_add(sheet, NULL, "com_y", "Centre of mass, y", "m", sheet->com[1]);
    sheet_add(sheet, NULL, "com_z", "Centre of mass, z", "m", sheet->com[2]);
    sheet_add(sheet, NULL, "inertia_xx", "Inertia about it, xx", "kg m^2", inertia[0]);
    sheet_add(sheet, NULL, "inertia_yy", "Inertia, yy", "kg m^2", inertia[4]);
    sheet_add(sheet, NULL, "inertia_zz", "Inertia, zz", "kg m^2", inertia[8]);
    sheet_add(sheet, NULL, "inertia_xy", "Inertia, xy", "kg m^2", inertia[1]);
    sheet_add(sheet, NULL, "inertia_xz", "Inertia, xz", "kg m^2", inertia[2]);
    sheet_add(sheet, NULL, "inertia_yz", "Inertia, yz", "kg m^2", inertia[5]);
}

/* Rows of a wheel, or of one of dual wheels. Returns its load. */
static double add_load(Sheet *sheet, const KcAxle *axle, int wheel, int part)
{
    const Equilibrium *found = sheet->found;
    const double *output = tape_array(found->self, found->engine->code->output_offset);
    const Wheel *one = axle->wheel[wheel].part[part];
    const int number = (int)(one - sheet->kc->model->wheel);
    const double *of = output + equilibrium_wheel(found, number);
    const char *name = sheet_wheel(sheet, one->name);
    sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.load", name), pool_print(sheet->pool, "Load of %s", one->name),
              "N", of[0]);
    sheet_place(sheet, axle, wheel, part, "load");
    sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.deflection", name),
              pool_print(sheet->pool, "Deflection of %s", one->name), "m", of[1]);
    sheet_place(sheet, axle, wheel, part, "deflection");
    const char *faded = equilibrium_faded(sheet->pool, found, output, number);
    if (faded)
        sheet_note(sheet, faded);
    return of[0];
}

/* Loads, deflections and heights of the wheels at rest; the road under them. */
static void loads(Sheet *sheet, const double *pose, const Carried *c)
{
    const Equilibrium *found = sheet->found;
    const double *output = tape_array(found->self, found->engine->code->output_offset);
    const Model *model = sheet->model;
    double total = 0, road = 0, world[3], com[3];
    for (int w = 0; w < model->wheels; ++w) {
        total += output[equilibrium_wheel(found, w)];
        road += output[equilibrium_wheel(found, w) + 3] / model->wheels;
    }
    copy3(sheet->com, com);
    apply3_transposed(c->turn, com, world);
    sheet_add(sheet, "At rest", "load", "Load of all wheels", "N", total);
    sheet_add(sheet, NULL, "com_height", "Height of the centre of mass over the road", "m",
              world[2] + c->origin[2] - road);
    sheet_add(sheet, NULL, "base_height", "Height of the origin of the base's frame", "m", pose[2] - road);
    sheet_add(sheet, NULL, "pitch", "Pitch against the drawing (nose down is positive)", "rad", -asin(c->turn[2]));
    sheet_add(sheet, NULL, "roll", "Roll against the drawing (right down is positive)", "rad",
              atan2(c->turn[5], c->turn[8]));
    for (int a = 0; a < sheet->kc->axles; ++a) {
        const KcAxle *axle = &sheet->kc->axle[a];
        double sum = 0;
        for (int i = 0; i < axle->wheels; ++i)
            for (int k = 0; k < axle->wheel[i].parts; ++k)
                sum += add_load(sheet, axle, i, k);
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.load", axle->name),
                  pool_print(sheet->pool, "Load of axle %s", axle->name), "N", sum);
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.share", axle->name),
                  pool_print(sheet->pool, "Share of axle %s", axle->name), "1", sum / total);
    }
}

double sheet_axle_place(const Sheet *sheet, const KcAxle *axle, double *aside)
{
    const KcAxle none = {.steer = -1};
    KcLook *look = kc_look_new(sheet->kc, &none);
    double x = 0;
    *aside = 0;
    if (kc_look(sheet->kc, sheet->w, look) != GIC_OK)
        return NAN;
    for (int i = 0; i < axle->wheels; ++i) {
        KcPose pose;
        kc_pose(&axle->wheel[i], look, &pose);
        x += pose.contact[0] / axle->wheels;
        const KcWheel *wheel = &axle->wheel[i];
        double A[9], apart[3], drawn[3];
        mat_from_euler(sheet->model->body[wheel->wheel->body].euler, A);
        for (int k = 0; k < wheel->parts; ++k) { /* dual wheels, along their axis, which points to the left */
            sub3(wheel->part[k]->center, wheel->wheel->center, apart);
            apply3(A, apart, drawn);
            *aside = fmax(*aside,
                          fabs(pose.contact[1] - sheet->kc->middle + copysign(norm3(apart), drawn[1]) * pose.axis[1]));
        }
    }
    return x;
}

static void add_axle(Sheet *sheet, const KcAxle *axle)
{
    static const int of_wheel[] = {KC_CAMBER,      KC_TOE,    KC_RATE,  KC_CAMBER_RATE, KC_TOE_RATE,
                                   KC_INCLINATION, KC_CASTER, KC_SCRUB, KC_TRAIL,       KC_BRAKE_ANGLE};
    static const int of_axle[] = {KC_TRACK,     KC_CENTRE_HEIGHT, KC_FORCE_HEIGHT,
                                  KC_ROLL_RATE, KC_ANTI_BRAKE,    KC_ANTI_DRIVE};
    KcRow row;
    const char *section = pool_print(sheet->pool, "Axle: %s", axle->name);
    if (axle->refusal) {
        sheet_miss(sheet, pool_print(sheet->pool, "axle %s: %s", axle->name, axle->refusal));
        return;
    }
    const int status = kc_position(sheet->kc, axle, sheet->w, &row);
    if (status != GIC_OK) {
        sheet_miss(sheet, pool_print(sheet->pool, "axle %s: %s", axle->name, kc_status(sheet->kc, status)));
        return;
    }
    for (size_t k = 0; k < sizeof of_axle / sizeof *of_axle; ++k)
        if (!isnan(row.axle[of_axle[k]])) {
            const KcQuantity *q = &kc_of_axle[of_axle[k]];
            sheet_add(sheet, section, pool_print(sheet->pool, "%s.%s", axle->name, q->name), q->title, q->unit,
                      row.axle[of_axle[k]]);
            section = NULL;
        }
    for (size_t k = 0; k < sizeof of_wheel / sizeof *of_wheel; ++k)
        for (int i = 0; i < axle->wheels; ++i)
            if (!isnan(row.wheel[i][of_wheel[k]])) {
                const KcQuantity *q = &kc_of_wheel[of_wheel[k]];
                sheet_add(sheet, section,
                          pool_print(sheet->pool, "%s.%s", sheet_wheel(sheet, axle->wheel[i].name), q->name),
                          pool_print(sheet->pool, "%s, %s", q->title, axle->wheel[i].name), q->unit,
                          row.wheel[i][of_wheel[k]]);
                sheet_place(sheet, axle, i, 0, q->name);
                section = NULL;
            }
}

/* The smallest turning circle of both ends of the steering. */
static void turning_circle(Sheet *sheet, const KcAxle *axle)
{
    const char *why;
    const KcCurve *curve = kc_sweep(sheet->kc, axle, KC_STEER, kc_usual_travel, &why);
    double least = INFINITY;
    for (int i = 0; curve && i < curve->rows; ++i)
        if (curve->row[i].axle[KC_RADIUS] < least)
            least = curve->row[i].axle[KC_RADIUS];
    if (isfinite(least))
        sheet_add(sheet, NULL, pool_print(sheet->pool, "%s.turning_circle", axle->name),
                  "Turning circle, diameter, of the outer contact", "m", 2 * least);
}

void sheet_rest(Sheet *sheet)
{
    const Equilibrium *found = sheet->found;
    const gic_model *code = found->engine->code;
    double *pose = pool_alloc(sheet->pool, 7 * (size_t)sheet->model->bodies * sizeof *pose);
    int status = code->outputs(found->self);
    if (status == GIC_OK)
        status = code->poses(found->self, pose);
    if (status != GIC_OK)
        diag_fail((Place){sheet->model->source, 0, 0}, NULL, "no poses at rest: %s",
                  instance_status(sheet->pool, code, &found->self->head, status));
    const Carried c = carried(sheet, pose);
    masses(sheet, pose, &c);
    loads(sheet, pose, &c);
    const Kc *kc = sheet->kc;
    double aside, *x = pool_alloc(sheet->pool, (size_t)kc->axles * sizeof *x);
    for (int a = 0; a < kc->axles; ++a)
        x[a] = sheet_axle_place(sheet, &kc->axle[a], &aside);
    sheet->wheelbase = kc_wheelbase(kc, x);
    if (kc->units)
        sheet_note(sheet, kc->units);
    if (sheet->wheelbase > 0)
        sheet_add(sheet, NULL, "wheelbase", "Wheelbase", "m", sheet->wheelbase);
    for (int a = 0; a < kc->axles; ++a) {
        add_axle(sheet, &kc->axle[a]);
        if (!kc->axle[a].refusal && kc->axle[a].steer >= 0)
            turning_circle(sheet, &kc->axle[a]);
    }
}
