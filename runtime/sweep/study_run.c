/* SPDX-License-Identifier: MIT
 * One run of a study with --vary: a model of its own from the same bytes, perhaps with another one beside it, and what
 * outlives them. A vehicle that fails leaves the other one alone. */
#include "base/catch.h"
#include "base/message.h"
#include "engine/engine.h"
#include "host/host.h"
#include "read/read.h"
#include "run/kc.h"
#include "run/kc_joints.h"
#include "run/manoeuvre.h"
#include "scene/scene.h"
#include "sweep/study.h"

#include <math.h>
#include <string.h>

/* One vehicle of a run. */
typedef struct Making {
    const StudySweep *sweep;
    int64_t number;
    int who; /* 0: the model, 1: the one beside it */
    Pool *pool;
    StudyRun *run;
    Sheet sheet;
} Making;

/* A scene, whose parameters are those of its file but for what is varied. */
static const Scene *scene_of(const Making *making, const Model *model, const char *file)
{
    const SweepPlan *plan = &making->sweep->plan;
    const Scene *scene = scene_read(making->pool, file, model, NULL, 0);
    for (int v = 0; v < plan->varied; ++v)
        for (int i = 0; i < model->parameters; ++i)
            if (model->parameter[i].tunable && !strcmp(model->parameter[i].name, plan->vary[v].name))
                scene->parameter[model->parameter[i].index] = plan_value(plan, v, making->number);
    return scene;
}

/* Motions that an axle can not make, as notes. */
static void tell_refusals(Making *making, const KcStudy *study)
{
    for (int a = 0; a < study->kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            if (!study->curve[a][m])
                sheet_note(&making->sheet, kc_stop(making->pool, study, a, m, 0));
}

static void make_kc(Making *making, const Model *model, const Scene *scene, const Request *request)
{
    Pool *keep = making->sweep->pool, *pool = making->pool;
    const KcStudy study = kc_study(pool, model, scene, request);
    kc_must_move(model, &study);
    if (making->sweep->kind == STUDY_KC) {
        making->sheet = kc_sheet(pool, model, &study);
        study_curves_kc(keep, &study, making->who, making->run);
    } else {
        const KcCarrying *carrying = kc_carrying(pool, model, scene, request, &study);
        making->sheet = kc_carrying_sheet(carrying, model);
        study_curves_joints(keep, &study, carrying, making->who, making->run);
    }
    tell_refusals(making, &study);
}

static void make_one(void *context)
{
    Making *making = context;
    const StudySweep *sweep = making->sweep;
    const SweepPlan *plan = &sweep->plan;
    Pool *pool = making->pool;
    Request request = *sweep->request;
    FileNumber *setting = pool_alloc(pool, (size_t)plan->varied * sizeof *setting);
    const char **key = pool_alloc(pool, (size_t)(request.keys + plan->varied) * sizeof *key);
    int settings = 0;
    memcpy(key, request.key, (size_t)request.keys * sizeof *key);
    for (int v = 0; v < plan->varied; ++v) {
        const char *name = plan->vary[v].name;
        const double value = plan_value(plan, v, making->number);
        if (sweep->kind == STUDY_MANOEUVRE && manoeuvre_key(pool, request.manoeuvre, name))
            key[request.keys++] = pool_print(pool, "%s=%.17g", name, value);
        else if (!making->who || sweep->moves[v])
            setting[settings++] = (FileNumber){name, value};
    }
    request.key = key;
    request.quiet = true;
    const Model *base = making->who ? sweep->beside : sweep->model;
    const char *file = making->who ? sweep->scene_beside : request.scene;
    const Model *model = model_read_set(pool, base, setting, settings);
    const Scene *scene = file ? scene_of(making, model, file) : NULL;
    if (scene)
        model = model_read_fixed(pool, base, setting, settings, scene->parameter);
    if (making->who) /* its parameters alone */
        scene = NULL;
    switch (sweep->kind) {
    case STUDY_KC:
    case STUDY_JOINTS: make_kc(making, model, scene, &request); break;
    case STUDY_LOADS: making->sheet = kc_loads_sheet(pool, model, kc_loads_open(pool, model, scene, &request)); break;
    case STUDY_SHEET:
        making->sheet = sheet_study(pool, model, scene, &request);
        if (!making->who)
            sheet_follow_modes(&making->sheet, sweep->shapes);
        break;
    case STUDY_MANOEUVRE: {
        const Manoeuvre manoeuvre = manoeuvre_drive(pool, model, &request);
        making->sheet = *manoeuvre.result;
        study_curves_manoeuvre(sweep->pool, &manoeuvre, making->who, making->run);
        engine_close(manoeuvre.car->engine);
        break;
    }
    }
}

/* ---- what outlives a run -------------------------------------------------------------------------------- */

/* Numbers outlive the pool of their run. All have the section that they stand in. */
static void keep_rows(Pool *pool, const Sheet *sheet, StudyRun *run)
{
    const char *section = NULL;
    run->rows = sheet->rows;
    run->row = pool_alloc(pool, ((size_t)sheet->rows + 1) * sizeof *run->row);
    for (int i = 0; i < sheet->rows; ++i) {
        const SheetRow *row = &sheet->row[i];
        section = row->section ? pool_print(pool, "%s", row->section) : section;
        run->row[i] = *row;
        run->row[i].section = section;
        run->row[i].name = pool_print(pool, "%s", row->name);
        run->row[i].title = pool_print(pool, "%s", row->title);
        run->row[i].unit = pool_print(pool, "%s", row->unit);
        run->row[i].shown = pool_print(pool, "%s", row->shown);
        run->row[i].place = row->place ? pool_print(pool, "%s", row->place) : NULL;
    }
}

/* What is to be known of numbers is told once, with the first run that says so. */
static void keep_note(StudySweep *sweep, const Making *making, const char *text)
{
    for (int i = 0; i < sweep->notes; ++i)
        if (sweep->note[i].who == making->who && !strcmp(sweep->note[i].text, text)) {
            sweep->note[i].runs += sweep->note[i].last != making->number;
            sweep->note[i].last = making->number;
            return;
        }
    *POOL_PUSH(sweep->pool, sweep->note, sweep->notes) =
        (StudyNote){pool_print(sweep->pool, "%s", text), making->who, 1, making->number, making->number};
}

/* Warnings and notes of a vehicle; of one that failed, why. */
static const char *hear(StudySweep *sweep, const Making *making, const Messages *said, bool good)
{
    const char *reason = "it failed";
    for (const Message *message = said->first; message; message = message->next) {
        if (message->kind == MESSAGE_WARNING && good)
            keep_note(sweep, making, message->text);
        if (message->kind != MESSAGE_ERROR)
            continue;
        reason = pool_print(sweep->pool, "%s", message->text);
        if (!sweep->first)
            sweep->first = pool_print(sweep->pool, "%s", message->printed);
        if (message->call) /* what would fail in each run */
            diag_fail_call(program_place(), message->remedy ? pool_print(sweep->pool, "%s", message->remedy) : NULL,
                           "%s", reason);
    }
    for (int i = 0; good && i < making->sheet.notes; ++i)
        keep_note(sweep, making, making->sheet.note[i]);
    return good ? NULL : reason;
}

/* Both vehicles' numbers beside each other. The sheet of one that failed is empty. */
static void put_beside(StudySweep *sweep, Making *own, Making *other, const StudyRun *run)
{
    if (run->reason[0]) { /* as if they were its own, but for their values */
        if (!run->reason[1])
            sheet_follow_modes(&other->sheet, sweep->shapes);
        own->sheet = other->sheet;
        for (int i = 0; i < own->sheet.rows; ++i) {
            own->sheet.row[i].other = own->sheet.row[i].value;
            own->sheet.row[i].value = NAN;
        }
        return;
    }
    if (run->reason[1])
        return;
    if (sweep->kind == STUDY_SHEET)
        sheet_match_modes(&own->sheet, &other->sheet, sweep->shapes);
    sheet_compare(&own->sheet, &other->sheet, sweep->name[1]);
}

void study_make(StudySweep *sweep, int64_t number)
{
    StudyRun *run = &sweep->run[number];
    Pool *pool = pool_new();
    Making making[2];
    for (int who = 0; who < 2; ++who) {
        Messages said = {NULL, NULL, NULL};
        making[who] = (Making){sweep, number, who, pool, run, {.pool = pool, .model = sweep->model}};
        if (who && !sweep->beside)
            break;
        const int curves = run->curves;
        const bool good = caught(&said, make_one, &making[who]);
        run->reason[who] = hear(sweep, &making[who], &said, good);
        if (!good) {
            run->curves = curves;
            making[who].sheet = (Sheet){.pool = pool, .model = sweep->model};
        }
        messages_clear(&said);
    }
    if (sweep->beside)
        put_beside(sweep, &making[0], &making[1], run);
    keep_rows(sweep->pool, &making[0].sheet, run);
    pool_free(pool);
}
