/* SPDX-License-Identifier: MIT
 * Wheels, with a tire or without (FORMAT.md section 8, TIRES.md section 1). */
#include "base/yaml.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

enum { PLAIN, ROLLING, FORMS };

enum {
    ROLL_BODY,
    ROLL_CENTER,
    ROLL_RADIUS,
    ROLL_STIFFNESS,
    ROLL_DAMPING,
    ROLL_FADE,
    ROLL_TIRE,
    ROLL_SPIN_INERTIA,
    ROLL_AXIS,
    ROLL_SIDE,
    ROLL_DRIVE,
    ROLL_DRIVE_BODY,
    ROLL_BRAKE,
    ROLL_WINDUP,
    ROLL_KEYS
};

static const Key wheel_key[ROLL_KEYS] = {
    [ROLL_BODY] = {"body", KEY_BODY, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ROLL_CENTER] = {"center", KEY_POINT, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ROLL_RADIUS] = {"radius", KEY_MEASURE, FORM(PLAIN), FORM(PLAIN), BOUND_POSITIVE, 0},
    [ROLL_STIFFNESS] = {"stiffness", KEY_MEASURE, FORM(PLAIN), FORM(PLAIN), BOUND_POSITIVE, 0},
    [ROLL_DAMPING] = {"damping", KEY_MEASURE, FORM(PLAIN), 0, BOUND_NOT_NEGATIVE, 0},
    [ROLL_FADE] = {"fade", KEY_MEASURE, ALL_FORMS, 0, BOUND_POSITIVE, 0.01},
    [ROLL_TIRE] = {"tire", KEY_TIRE, FORM(ROLLING), FORM(ROLLING), BOUND_NONE, 0},
    [ROLL_SPIN_INERTIA] = {"spin_inertia", KEY_NUMBER, FORM(ROLLING), FORM(ROLLING), BOUND_POSITIVE, 0},
    [ROLL_AXIS] = {"axis", KEY_TURN, FORM(ROLLING), 0, BOUND_NONE, 0},
    [ROLL_SIDE] = {"side", KEY_SIDE, FORM(ROLLING), 0, BOUND_NONE, 0},
    [ROLL_DRIVE] = {"drive", KEY_FORMULA, FORM(ROLLING), 0, BOUND_NONE, 0},
    [ROLL_DRIVE_BODY] = {"drive_body", KEY_BODY, FORM(ROLLING), 0, BOUND_NONE, 0},
    [ROLL_BRAKE] = {"brake", KEY_FORMULA, FORM(ROLLING), 0, BOUND_NONE, 0},
    [ROLL_WINDUP] = {"windup", KEY_NUMBER, FORM(ROLLING), 0, BOUND_POSITIVE, 0.1},
};

static const char *const wheel_about[ROLL_KEYS] = {
    [ROLL_BODY] = "the body that carries the wheel",
    [ROLL_CENTER] = "centre of the wheel at design, m, model frame",
    [ROLL_RADIUS] = "radius without load, m",
    [ROLL_STIFFNESS] = "vertical stiffness of the tire, N/m",
    [ROLL_DAMPING] = "vertical damping of the tire, N s/m; default 0",
    [ROLL_FADE] = "deflection over which damping builds up, m; default 0.01",
    [ROLL_TIRE] = "entry of tires: the wheel rolls",
    [ROLL_SPIN_INERTIA] = "moment of inertia of what spins, about its axis, kg m^2",
    [ROLL_AXIS] = "axis of spin at design, pointing to the left, model frame; default [0, 1, 0]",
    [ROLL_SIDE] = "side of the vehicle that the tire is on; default: by the sign of the y of center",
    [ROLL_DRIVE] = "torque of the drive on the wheel, N m, any formula, also of spin (rad/s); default 0",
    [ROLL_DRIVE_BODY] = "the body that takes the reaction of the drive; default: the base",
    [ROLL_BRAKE] = "torque up to which the brake holds, N m, any formula, also of spin (rad/s); default: no brake",
    [ROLL_WINDUP] = "angle by which a locked brake gives way until it slips, rad; default 0.1",
};

static const char *const wheel_form[FORMS] = {[PLAIN] = "without a tire", [ROLLING] = "with a tire"};

const Section wheel_section = {wheel_key, ROLL_KEYS, NULL, 0, wheel_form, NULL, wheel_about};

/* A formula that may use the spin of the wheel; NULL: the key is absent. */
static const Law *spin_law(Reader *reader, const Entry *entry, const Value *value, int key)
{
    static const char *const local[] = {"spin"};
    LawNames names = {.model = reader->model, .local = local, .locals = 1, .reads = &reader->reads, .early = "wheels"};
    if (!value[key].item)
        return NULL;
    return law_parse(reader->pool, value[key].item,
                     pool_print(reader->pool, "%s of %s", wheel_key[key].name, entry->what), &names);
}

/* Refuse a key that qualifies another one which is absent. */
static void belongs_check(const Reader *reader, const Entry *entry, const Value *value, int key, int to)
{
    if (value[key].item && !value[to].item)
        diag_fail(value[key].item->at,
                  pool_print(reader->pool, "add `%s: formula`, or take it away", wheel_key[to].name),
                  "%s of %s says nothing without %s", wheel_key[key].name, entry->what, wheel_key[to].name);
}

static void rolling_read(Reader *reader, const Entry *entry, const Value *value, Wheel *wheel)
{
    const Tire *tire = &reader->model->tire[value[ROLL_TIRE].index[0]];
    const double left[3] = {0, 1, 0};
    const Ex fixed[3] = {0};
    const Value *axis = value[ROLL_AXIS].item ? &value[ROLL_AXIS] : NULL;
    bool right = value[ROLL_SIDE].item ? value[ROLL_SIDE].flag : value[ROLL_CENTER].number[1] < 0;
    if (value[ROLL_FADE].tuned[0])
        diag_fail(value[ROLL_FADE].item->at, "leave out `tunable: true` of that parameter, or use it elsewhere",
                  "fade of %s is fixed when the code is generated, for it has a tire", entry->what);
    belongs_check(reader, entry, value, ROLL_WINDUP, ROLL_BRAKE);
    wheel->tire = value[ROLL_TIRE].index[0];
    wheel->radius = tire->radius;
    wheel->stiffness = tire->stiffness;
    wheel->damping = tire->damping;
    wheel->spin_inertia = value[ROLL_SPIN_INERTIA].number[0];
    wheel->mirrored = tire->side != SIDE_SYMMETRIC && right != (tire->side == SIDE_RIGHT);
    wheel->drive = spin_law(reader, entry, value, ROLL_DRIVE);
    wheel->drive_body = value[ROLL_DRIVE_BODY].item ? value[ROLL_DRIVE_BODY].index[0] : BODY_BASE;
    wheel->brake = spin_law(reader, entry, value, ROLL_BRAKE);
    wheel->windup = value[ROLL_WINDUP].number[0];
    body_direction(reader, wheel->body, axis ? axis->number : left, axis ? axis->tuned : fixed, wheel->axis);
    spin_take(reader, wheel, entry->what, value[ROLL_SPIN_INERTIA].item->at);
}

static void wheel_read(Reader *reader, const Entry *entry, Wheel *wheel)
{
    Tuning *tuning = reader->model->tuning;
    bool rolling = entry->item->kind == ITEM_MAP && doc_find(entry->item, "tire");
    Value value[ROLL_KEYS];
    section_read(reader, &wheel_section, rolling ? ROLLING : PLAIN, entry, value);
    *wheel = (Wheel){
        .name = entry->name,
        .at = entry->at,
        .body = value[ROLL_BODY].index[0],
        .radius = value[ROLL_RADIUS].number[0],
        .stiffness = value[ROLL_STIFFNESS].number[0],
        .damping = value[ROLL_DAMPING].number[0],
        .fade = value[ROLL_FADE].number[0],
        .tire = -1,
        .drive_body = BODY_GROUND,
    };
    if (!reader->model->free_base && wheel->body == BODY_BASE)
        diag_fail(value[ROLL_BODY].item->at, "name the body that carries it", "%s: ground can't roll on the road",
                  entry->what);
    body_point(reader, wheel->body, value[ROLL_CENTER].number, value[ROLL_CENTER].tuned, value[ROLL_CENTER].item->at,
               wheel->center);
    if (rolling) {
        rolling_read(reader, entry, value, wheel);
    } else {
        tuning_set(tuning, &wheel->radius, value[ROLL_RADIUS].tuned, 1);
        tuning_set(tuning, &wheel->stiffness, value[ROLL_STIFFNESS].tuned, 1);
        tuning_set(tuning, &wheel->damping, value[ROLL_DAMPING].tuned, 1);
        tuning_set(tuning, &wheel->fade, value[ROLL_FADE].tuned, 1);
    }
}

void wheels_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "wheel", &model->wheels);
    model->wheel = pool_alloc(reader->pool, sizeof *model->wheel * (size_t)(model->wheels + 1));
    for (int i = 0; i < model->wheels; ++i) {
        wheel_read(reader, &entry[i], &model->wheel[i]);
        model->wheel[i].fast = model->fast_states;
        model->fast_states += wheel_fast_states(&model->wheel[i]);
    }
}

void wheels_driven_check(const Reader *reader, const Item *map)
{
    const Model *model = reader->model;
    for (int i = 0; i < model->wheels; ++i) {
        const Item *body = model->wheel[i].tire < 0 ? NULL : doc_find(map->value[i], wheel_key[ROLL_DRIVE_BODY].name);
        if (body && !wheel_is_driven(model, i))
            diag_fail(body->at, "add `drive: formula`, or take it away",
                      "drive_body of wheel '%s' says nothing without drive", model->wheel[i].name);
    }
}
