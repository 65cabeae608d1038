/* SPDX-License-Identifier: MIT
 * Tires: TIRES.md sections 1 and 6. */
#include "base/yaml.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

/* Keys of the data: those of TMEASY_LIST. */
#define CARCASS_ENUM(name) CARCASS_##name,
enum {
    CARCASS_FILE,
    CARCASS_TYPE,
    CARCASS_RELAXATION,
    CARCASS_RADIUS,
    CARCASS_RIM_RADIUS,
    CARCASS_STIFFNESS,
    CARCASS_DAMPING,
    CARCASS_LOW_SPEED,
    TMEASY_LIST(CARCASS_ENUM, CARCASS_ENUM) CARCASS_KEYS
};
#undef CARCASS_ENUM

#define OF_FILE FORM(TIRE_PAC2002)
#define OF_DATA FORM(TIRE_TMEASY)
#define PAIR(name) [CARCASS_##name] = {#name, KEY_PAIR, OF_DATA, OF_DATA, BOUND_POSITIVE, 0}

static const Key tire_key[CARCASS_KEYS] = {
    [CARCASS_FILE] = {"file", KEY_TEXT, OF_FILE, OF_FILE, BOUND_NONE, 0},
    [CARCASS_TYPE] = {"type", KEY_TYPE, OF_DATA, OF_DATA, BOUND_NONE, 0},
    [CARCASS_RELAXATION] = {"relaxation", KEY_PAIR, ALL_FORMS, 0, BOUND_POSITIVE, 0},
    [CARCASS_RADIUS] = {"radius", KEY_NUMBER, OF_DATA, OF_DATA, BOUND_POSITIVE, 0},
    [CARCASS_RIM_RADIUS] = {"rim_radius", KEY_NUMBER, OF_DATA, 0, BOUND_POSITIVE, 0},
    [CARCASS_STIFFNESS] = {"stiffness", KEY_NUMBER, OF_DATA, OF_DATA, BOUND_POSITIVE, 0},
    [CARCASS_DAMPING] = {"damping", KEY_NUMBER, OF_DATA, OF_DATA, BOUND_NOT_NEGATIVE, 0},
    [CARCASS_LOW_SPEED] = {"low_speed", KEY_NUMBER, OF_DATA, 0, BOUND_POSITIVE, 1},
    [CARCASS_load] = {"load", KEY_NUMBER, OF_DATA, OF_DATA, BOUND_POSITIVE, 0},
    [CARCASS_friction] = {"friction", KEY_NUMBER, OF_DATA, 0, BOUND_POSITIVE, 1},
    [CARCASS_rolling_resistance] = {"rolling_resistance", KEY_NUMBER, OF_DATA, 0, BOUND_NOT_NEGATIVE, 0},
    PAIR(dfx0),
    PAIR(fxm),
    PAIR(fxs),
    PAIR(dfy0),
    PAIR(fym),
    PAIR(fys),
    PAIR(sxm),
    PAIR(sxs),
    PAIR(sym),
    PAIR(sys),
    [CARCASS_trail] = {"trail", KEY_PAIR, OF_DATA, OF_DATA, BOUND_NOT_NEGATIVE, 0},
    PAIR(sq0),
    PAIR(sqe),
};

static const char *const tire_about[CARCASS_KEYS] = {
    [CARCASS_FILE] = "path of a .tir file, from the folder of the file that it stands in",
    [CARCASS_TYPE] = "a tire whose data stand here, not in a .tir file",
    [CARCASS_RELAXATION] = "relaxation lengths along and across, m; default: those of the tire",
    [CARCASS_RADIUS] = "radius without load, m",
    [CARCASS_RIM_RADIUS] = "radius of the rim, m; default: it never touches the road",
    [CARCASS_STIFFNESS] = "vertical stiffness, N/m",
    [CARCASS_DAMPING] = "vertical damping, N s/m",
    [CARCASS_LOW_SPEED] = "speed below which slip is damped, m/s; default 1",
    [CARCASS_load] = "nominal load, N",
    [CARCASS_friction] = "friction of the road that the data belong to; default 1",
    [CARCASS_rolling_resistance] = "rolling resistance over load; default 0",
    [CARCASS_dfx0] = "longitudinal force over slip at its beginning, N, at the nominal load and at twice that",
    [CARCASS_fxm] = "largest longitudinal force, N, at the nominal load and at twice that",
    [CARCASS_fxs] = "longitudinal force of sliding, N, at the nominal load and at twice that",
    [CARCASS_dfy0] = "lateral force over slip at its beginning, N, at the nominal load and at twice that",
    [CARCASS_fym] = "largest lateral force, N, at the nominal load and at twice that",
    [CARCASS_fys] = "lateral force of sliding, N, at the nominal load and at twice that",
    [CARCASS_sxm] = "longitudinal slip of the largest force, at the nominal load and at twice that",
    [CARCASS_sxs] = "longitudinal slip from which the tire slides, at the nominal load and at twice that",
    [CARCASS_sym] = "lateral slip of the largest force, at the nominal load and at twice that",
    [CARCASS_sys] = "lateral slip from which the tire slides, at the nominal load and at twice that",
    [CARCASS_trail] = "pneumatic trail over contact length without slip, at the nominal load and at twice that",
    [CARCASS_sq0] = "lateral slip where the trail vanishes first, at the nominal load and at twice that",
    [CARCASS_sqe] = "lateral slip from which the trail stays zero, at the nominal load and at twice that",
};

static const char *const tire_type[] = {"tmeasy"};
static const char *const tire_form[TIRE_TYPES] = {[TIRE_PAC2002] = "from a file", [TIRE_TMEASY] = "tmeasy"};
static const unsigned tire_type_forms[] = {OF_DATA};

const Section tire_section = {tire_key, CARCASS_KEYS, tire_type, 1, tire_form, tire_type_forms, tire_about};

/* Highest load, relative to the nominal one, for which a tire has data. */
static const double load_most = 3.5;

/* Slip at p times the nominal load; force divided by p. Both are linear in p. */
static double slip_at(const double y[2], double p)
{
    return y[0] + (y[1] - y[0]) * (p - 1);
}

static double force_at(const double y[2], double p)
{
    return 2 * y[0] - y[1] / 2 - (y[0] - y[1] / 2) * p;
}

/* Forces and slips must be positive from no load to the highest, and keep their order: sliding at a larger slip and at
 * a smaller force than the maximum. */
static void data_check(const Entry *entry, const Value *value)
{
    static const struct {
        int key, above; /* above: the key whose numbers must be larger than these, or -1 */
        bool force, equal;
    } rule[] = {
        {CARCASS_dfx0, -1, true, false},          {CARCASS_dfy0, -1, true, false},
        {CARCASS_fxm, -1, true, false},           {CARCASS_fym, -1, true, false},
        {CARCASS_fxs, CARCASS_fxm, true, true},   {CARCASS_fys, CARCASS_fym, true, true},
        {CARCASS_sxm, CARCASS_sxs, false, false}, {CARCASS_sym, CARCASS_sys, false, false},
        {CARCASS_sxs, -1, false, false},          {CARCASS_sys, -1, false, false},
        {CARCASS_sq0, CARCASS_sqe, false, false}, {CARCASS_sqe, -1, false, false},
    };
    for (size_t i = 0; i < sizeof rule / sizeof *rule; ++i)
        for (int end = 0; end < 2; ++end) {
            const Value *y = &value[rule[i].key], *above = rule[i].above < 0 ? NULL : &value[rule[i].above];
            double (*at)(const double y[2], double p) = rule[i].force ? force_at : slip_at;
            double p = end ? load_most : 0, low = at(y->number, p), high = above ? at(above->number, p) : INFINITY;
            if (!(low > 0))
                diag_fail(y->item->at,
                          rule[i].force ? "the second number lies between 1.2 and 4 times the first"
                                        : "the second number lies between 0.6 and 2 times the first",
                          "%s of %s does not stay above zero from no load to %g times the nominal one",
                          tire_key[rule[i].key].name, entry->what, load_most);
            if (!(low < high || (rule[i].equal && low == high)))
                diag_fail(y->item->at, "check both numbers of both",
                          "%s of %s does not stay below %s from no load to %g times the nominal one",
                          tire_key[rule[i].key].name, entry->what, tire_key[rule[i].above].name, load_most);
        }
}

static void tmeasy_read(const Reader *reader, const Entry *entry, const Value *value, Tire *tire)
{
    static const double rim_gap = 0.01, rim_share = 5; /* gap between rim and road, m; stiffness relative to the tire's
                                                        */
    double *number = pool_alloc(reader->pool, sizeof *number * TMEASY_COUNT);
#define TAKE(name) number[TMEASY_##name] = value[CARCASS_##name].number[0];
#define TAKE_TWO(name) TAKE(name) number[TMEASY_##name##_TWICE] = value[CARCASS_##name].number[1];
    TMEASY_LIST(TAKE, TAKE_TWO)
#undef TAKE_TWO
#undef TAKE
    data_check(entry, value);
    tire->number = number;
    tire->side = SIDE_SYMMETRIC;
    tire->radius = value[CARCASS_RADIUS].number[0];
    tire->stiffness = value[CARCASS_STIFFNESS].number[0];
    tire->damping = value[CARCASS_DAMPING].number[0];
    tire->low_speed = value[CARCASS_LOW_SPEED].number[0];
    tire->relaxation[0] = 0.5 * tire->radius;
    tire->relaxation[1] = tire->radius;
    if (value[CARCASS_RIM_RADIUS].item) {
        tire->bottom_stiffness = rim_share * tire->stiffness;
        tire->bottom = tire->radius - value[CARCASS_RIM_RADIUS].number[0] - rim_gap;
        if (!(tire->bottom > 0))
            diag_fail(value[CARCASS_RIM_RADIUS].item->at, "write the radius of the rim, inside the tire",
                      "rim_radius of %s leaves less than 0.01 m of tire", entry->what);
    }
}

static void tire_read(const Reader *reader, const Entry *entry, const Value *value, Tire *tire)
{
    if (tire->type == TIRE_TMEASY)
        tmeasy_read(reader, entry, value, tire);
    else
        tir_read(reader, value[CARCASS_FILE].item, entry->what, tire);
    for (int i = 0; i < 2 && value[CARCASS_RELAXATION].item; ++i)
        tire->relaxation[i] = value[CARCASS_RELAXATION].number[i];
}

void tires_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "tire", &model->tires);
    model->tire = pool_alloc(reader->pool, sizeof *model->tire * (size_t)(model->tires + 1));
    for (int i = 0; i < model->tires; ++i) {
        Value value[CARCASS_KEYS];
        const Item *item = entry[i].item;
        bool map_given = item->kind == ITEM_MAP, file = map_given && doc_find(item, "file");
        if (map_given && !file && !doc_find(item, "type"))
            diag_fail(entry[i].at, "add `file: name.tir`, or `type: tmeasy` and its data",
                      "%s has neither a file nor a type", entry[i].what);
        int form = file ? TIRE_PAC2002 : (section_type(reader, &tire_section, &entry[i]), TIRE_TMEASY);
        section_read(reader, &tire_section, form, &entry[i], value);
        model->tire[i] = (Tire){.name = entry[i].name, .at = entry[i].at, .type = (TireType)form};
        tire_read(reader, &entry[i], value, &model->tire[i]);
    }
}
