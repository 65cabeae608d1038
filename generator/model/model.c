/* SPDX-License-Identifier: MIT
 * Functions of the model alone: names of its types, and properties of its parts. */
#include "model/model.h"
#include "model/tunable.h"

bool force_is_spring(const Force *force)
{
    return force->type == FORCE_COORDINATE || force->type == FORCE_POINTS || force->type == FORCE_AXIS;
}

bool force_is_stop(const Force *force)
{
    return force->type == FORCE_COORDINATE_STOP || force->type == FORCE_POINTS_STOP || force->type == FORCE_AXIS_STOP;
}

bool force_is_law(const Force *force)
{
    return force->type == FORCE_COORDINATE_LAW || force->type == FORCE_POINTS_LAW || force->type == FORCE_AXIS_LAW;
}

bool force_is_torque(const Force *force)
{
    return force->type == FORCE_AXIS || force->type == FORCE_AXIS_LAW || force->type == FORCE_AXIS_STOP;
}

bool force_is_wrench(const Force *force)
{
    return force->type == FORCE_LOAD || force->type == FORCE_AERO || force->type == FORCE_BUSHING;
}

int force_laws(const Force *force)
{
    return force->type == FORCE_AERO ? FORCE_MOST_LAWS : force_is_wrench(force) ? 6 : force_is_law(force);
}

int wheel_fast_states(const Wheel *wheel)
{
    return wheel->tire < 0 ? 0 : wheel->brake ? FAST_MOST : FAST_BRAKE;
}

const char *const wheel_fast_name[FAST_MOST] = {"spin", "slip_x", "slip_y", "brake"};
const char *const powertrain_fast_name[POWERTRAIN_FAST] = {"engine.speed", "transmission.age"};

const char *const powertrain_discrete_name[POWERTRAIN_DISCRETE] = {"transmission.gear", "transmission.before"};

int model_held(const Model *model)
{
    int held = 0;
    while (held < model->states && !model->state[model->states - 1 - held].rate)
        ++held;
    return held;
}

int rule_output(const Model *model, const ControlRule *rule)
{
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        if (rule->signal >= 0 && model->output[i].sampled && model->output[i].index == rule->signal)
            return at;
    return -1;
}

bool model_contact(const Model *model, int index, ContactSite *site)
{
    *site = (ContactSite){0};
    if (index < model->wheels) {
        site->wheel = &model->wheel[index];
        return true;
    }
    index -= model->wheels;
    for (int i = 0; i < model->forces; ++i) {
        const Force *force = &model->force[i];
        const int ends = force_is_stop(force) ? (force->high != NULL) + (force->low != NULL) : 0;
        if (index < ends) {
            site->stop = force;
            site->high = index == 0 && force->high;
            return true;
        }
        index -= ends;
    }
    return false;
}

const char *contact_text(Pool *pool, const ContactSite *site)
{
    return site->wheel ? pool_print(pool, "wheel '%s'", site->wheel->name)
                       : pool_print(pool, "the %s end of stop '%s'", site->high ? "high" : "low", site->stop->name);
}

int model_discretes(const Model *model)
{
    return model->free_base + (model->powertrain ? POWERTRAIN_DISCRETE : 0);
}

bool wheel_is_driven(const Model *model, int wheel)
{
    const Powertrain *powertrain = model->powertrain;
    for (int i = 0; powertrain && i < powertrain->differentials; ++i)
        if (powertrain->differential[i].wheel[0] == wheel || powertrain->differential[i].wheel[1] == wheel)
            return true;
    return model->wheel[wheel].drive;
}

const char *const joint_type_name[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = "revolute",
    [JOINT_SPHERICAL] = "spherical",
    [JOINT_PRISMATIC] = "prismatic",
    [JOINT_CYLINDRICAL] = "cylindrical",
    [JOINT_UNIVERSAL] = "universal",
    [JOINT_FIXED] = "fixed",
    [JOINT_DISTANCE] = "distance",
    [JOINT_REVOLUTE_SPHERICAL] = "revolute_spherical",
    [JOINT_POINT_ON_LINE] = "point_on_line",
    [JOINT_POINT_IN_PLANE] = "point_in_plane",
    [JOINT_PARALLEL] = "parallel",
    [JOINT_PERPENDICULAR] = "perpendicular",
    [JOINT_SCREW] = "screw",
    [JOINT_RACK_AND_PINION] = "rack_and_pinion",
    [JOINT_GEAR] = "gear",
    [JOINT_COUPLER] = "coupler",
};

const int joint_equations[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = 5,      [JOINT_SPHERICAL] = 3,       [JOINT_PRISMATIC] = 5, [JOINT_CYLINDRICAL] = 4,
    [JOINT_UNIVERSAL] = 4,     [JOINT_FIXED] = 6,           [JOINT_DISTANCE] = 1,  [JOINT_REVOLUTE_SPHERICAL] = 2,
    [JOINT_POINT_ON_LINE] = 2, [JOINT_POINT_IN_PLANE] = 1,  [JOINT_PARALLEL] = 2,  [JOINT_PERPENDICULAR] = 1,
    [JOINT_SCREW] = 1,         [JOINT_RACK_AND_PINION] = 1, [JOINT_GEAR] = 1,      [JOINT_COUPLER] = 1,
};

bool joint_is_geared(JointType type)
{
    return type == JOINT_SCREW || type == JOINT_RACK_AND_PINION;
}

bool joint_is_coupled(JointType type)
{
    return type == JOINT_GEAR || type == JOINT_COUPLER;
}

int joint_measure(JointType type)
{
    return type == JOINT_GEAR ? (int)COORDINATE_ANGLE : type == JOINT_COUPLER ? (int)COORDINATE_TRANSLATION : -1;
}

bool model_counts_turns(const Model *model)
{
    for (int i = 0; i < model->joints; ++i)
        if (joint_is_geared(model->joint[i].type) || joint_is_coupled(model->joint[i].type))
            return true;
    return false;
}

bool law_follows(const Law *law, int coordinate)
{
    if (law->op == LAW_VALUE && (coordinate < 0 || law->index == coordinate))
        return true;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (law_follows(law->arg[i], coordinate))
            return true;
    return false;
}

bool joint_follows(const Joint *joint, int coordinate)
{
    return joint->value && law_follows(joint->value, coordinate);
}

const char *const coordinate_type_name[COORDINATE_TYPES] = {
    [COORDINATE_LENGTH] = "length",
    [COORDINATE_TRANSLATION] = "translation",
    [COORDINATE_ANGLE] = "angle",
};

const char *const base_state_name[BASE_STATES] = {"r.x", "r.y", "r.z", "e0",      "e1",      "e2",     "e3",
                                                  "v.x", "v.y", "v.z", "omega.x", "omega.y", "omega.z"};

const char *const output_type_name[OUTPUT_TYPES] = {
    [OUTPUT_POSITION] = "position",
    [OUTPUT_VELOCITY] = "velocity",
    [OUTPUT_ACCELERATION] = "acceleration",
    [OUTPUT_ORIENTATION] = "orientation",
    [OUTPUT_ROLL_PITCH_YAW] = "roll_pitch_yaw",
    [OUTPUT_ANGULAR_VELOCITY] = "angular_velocity",
    [OUTPUT_COORDINATE] = "coordinate",
    [OUTPUT_FORCE] = "force",
    [OUTPUT_DRIVE_FORCE] = "drive_force",
    [OUTPUT_REACTION] = "reaction",
    [OUTPUT_WHEEL] = "wheel",
    [OUTPUT_TIRE] = "tire",
    [OUTPUT_CONTACT] = "contact",
    [OUTPUT_POWERTRAIN] = "powertrain",
    [OUTPUT_ENERGY] = "energy",
    [OUTPUT_SIGNAL] = "signal",
};

void law_signals(const Law *law, void (*see)(void *user, const Law *signal), void *user)
{
    if (!law)
        return;
    if (law->op == LAW_SIGNAL)
        see(user, law);
    for (int i = 0; i < 3; ++i)
        law_signals(law->arg[i], see, user);
}

int wheel_rolling(const Model *model, int wheel)
{
    int before = 0;
    for (int i = 0; i < wheel; ++i)
        before += model->wheel[i].tire >= 0;
    return before;
}

const char *model_massless(const Model *model)
{
    for (int b = model->free_base ? 0 : 1; b < model->bodies; ++b)
        if (model->body[b].mass == 0 && !tuned_number(model, &model->body[b].mass))
            return model->body[b].name;
    return NULL;
}

bool output_is_motion(OutputType type, int component)
{
    switch (type) {
    case OUTPUT_POSITION:
    case OUTPUT_VELOCITY:
    case OUTPUT_ORIENTATION:
    case OUTPUT_ROLL_PITCH_YAW:
    case OUTPUT_ANGULAR_VELOCITY: return true;
    case OUTPUT_COORDINATE: return component < 2;
    case OUTPUT_TIRE: return component == TIRE_SPIN;
    default: return false;
    }
}

/* A search for outputs of a type, of one index or of any (-1), among all that something reads. */
typedef struct Search {
    const Model *model;
    OutputType type;
    int index;
    bool found;
} Search;

static void search_output(Search *search, const Output *output);

static void search_signal(void *user, const Law *law)
{
    Search *search = user;
    const Signal *signal = &search->model->signal[law->index];
    if (signal->law)
        law_signals(signal->law, search_signal, search);
    else
        search_output(search, &signal->output);
}

static void search_output(Search *search, const Output *output)
{
    if (output->type == search->type && (search->index < 0 || output->index == search->index))
        search->found = true;
    if (output->type == OUTPUT_SIGNAL)
        law_signals(search->model->signal[output->index].law, search_signal, search);
}

bool output_reads(const Model *model, const Output *output, OutputType type)
{
    Search search = {.model = model, .type = type, .index = -1};
    search_output(&search, output);
    return search.found;
}

bool model_reads(const Model *model, OutputType type)
{
    Search search = {.model = model, .type = type, .index = -1};
    for (int i = 0; i < model->outputs; ++i)
        search_output(&search, &model->output[i]);
    for (int i = 0; i < model->forces; ++i)
        for (int k = 0; k < FORCE_MOST_LAWS; ++k)
            law_signals(model->force[i].law[k], search_signal, &search);
    for (int i = 0; i < model->states; ++i)
        law_signals(model->state[i].rate, search_signal, &search);
    return search.found;
}

static bool is_wanted(const Model *model, OutputType type, int index)
{
    Search search = {.model = model, .type = type, .index = index};
    for (int i = 0; i < model->outputs; ++i)
        search_output(&search, &model->output[i]);
    return search.found;
}

bool reaction_wanted(const Model *model, int joint)
{
    return is_wanted(model, OUTPUT_REACTION, joint);
}

bool drive_wanted(const Model *model, int coordinate)
{
    return is_wanted(model, OUTPUT_DRIVE_FORCE, coordinate);
}
