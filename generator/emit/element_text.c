/* SPDX-License-Identifier: MIT
 * Elements of arrays as C text: their indices as enumerators, and what temporaries are called that are stored there. */
#include "base/text.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/powertrain_numbers.h"
#include "model/tire_numbers.h"
#include "vehicle/wheel.h"

#include <ctype.h>
#include <string.h>

static const char *const array_text[ARRAY_COUNT] = {
#define ARRAY_TEXT(name, text, what) [ARRAY_##name] = text,
    ARRAY_LIST(ARRAY_TEXT)
#undef ARRAY_TEXT
};

/* Numbers of a subset's inertia: INERTIA_* of subset/subset.h. */
static const char *const inertia_name[INERTIA_COORDINATE] = {
    "FIRST_X",   "FIRST_Y", "FIRST_Z", "SECOND_XX", "SECOND_YY", "SECOND_ZZ", "SECOND_XY", "SECOND_XZ",
    "SECOND_YZ", "FORCE_X", "FORCE_Y", "FORCE_Z",   "MOMENT_X",  "MOMENT_Y",  "MOMENT_Z"};
/* Of what a coordinate adds to the equations of motion, 7 numbers each. */
static const char *const coordinate_name[7] = {"FORCE_X",  "FORCE_Y",  "FORCE_Z", "MOMENT_X",
                                               "MOMENT_Y", "MOMENT_Z", "BIAS"};

/* Numbers of one wheel in its arrays: LINK_*, GRIP_*, CONTACT_* and so on of the headers of vehicle/. */
static const char *const link_name[] = {"C_X", "C_Y", "C_Z", "V_X",     "V_Y",     "V_Z",
                                        "S_X", "S_Y", "S_Z", "OMEGA_X", "OMEGA_Y", "OMEGA_Z"};
static const char *const grip_name[] = {
    "FORCE_X", "FORCE_Y", "FORCE_Z",    "TORQUE_X",        "TORQUE_Y", "TORQUE_Z", "DRIVE",
    "BRAKE",   "LOAD",    "DEFLECTION", "DEFLECTION_RATE", "HEIGHT",   "FX",       "FY",
    "MX",      "MY",      "MZ",         "KAPPA",           "TANGENT",  "CAMBER",   "POINT_X",
    "POINT_Y", "POINT_Z", "SPEED_X",    "SPEED_Y",         "RADIUS",   "POWER",    "PRESS"};
static const char *const contact_name[] = {"LOAD",   "KAPPA", "TANGENT", "CAMBER", "FRICTION", "SPEED", "DEFLECTION",
                                           "RADIUS", "X_X",   "X_Y",     "X_Z",    "Y_X",      "Y_Y",   "Y_Z",
                                           "N_X",    "N_Y",   "N_Z",     "ARM_X",  "ARM_Y",    "ARM_Z"};
static const char *const force_name[] = {"FX", "FY", "MX", "MY", "MZ"};
static const char *const torque_name[] = {"DRIVE", "BRAKE"};
static const char *const fast_name[] = {"SPIN", "SLIP_X", "SLIP_Y", "BRAKE"};
_Static_assert(sizeof link_name / sizeof *link_name == LINK_NUMBERS, "all have names");
_Static_assert(sizeof grip_name / sizeof *grip_name == GRIP_NUMBERS, "all have names");
_Static_assert(sizeof contact_name / sizeof *contact_name == CONTACT_NUMBERS, "all have names");
_Static_assert(sizeof force_name / sizeof *force_name == TIRE_FORCES, "all have names");
_Static_assert(sizeof fast_name / sizeof *fast_name == FAST_MOST, "all have names");
/* Of a powertrain: POWERTRAIN_GEAR and so on. */
static const char *const gear_name[] = {"NUMBER", "RATIO", "RATIO_BEFORE", "ENGAGED", "ENGAGED_BEFORE"};
static const char *const watch_name[] = {"ENGINE_SPEED", "ENGINE_TORQUE", "THROTTLE",       "GEAR",
                                         "RATIO",        "TURBINE_SPEED", "TURBINE_TORQUE", "PUMP_TORQUE"};
static const char *const choice_name[] = {"SELECTOR", "TURBINE", "UP"};
_Static_assert(sizeof gear_name / sizeof *gear_name == GEAR_NUMBERS, "all have names");
_Static_assert(sizeof watch_name / sizeof *watch_name == WATCH_NUMBERS, "all have names");
/* A pose of a body; unknowns of the base; parts of the energy balance. */
static const char *const pose_name[7] = {"X", "Y", "Z", "P0", "P1", "P2", "P3"};
static const char *const base_unknown_name[6] = {"ALPHA_X",        "ALPHA_Y",        "ALPHA_Z",
                                                 "ACCELERATION_X", "ACCELERATION_Y", "ACCELERATION_Z"};
static const char *const energy_name[3] = {"RATE", "POWER", "MAGNITUDES"};

/* ---- names --------------------------------------------------------------------------------------------------------
 */

/* Names in capitals, NULL where two are the same. */
static const char **capitals(Pool *pool, const char **name, int count)
{
    for (int i = 0; i < count; ++i) {
        name[i] = capital(pool, name[i]);
        for (int k = 0; k < i; ++k)
            if (!strcmp(name[i], name[k]))
                return NULL;
    }
    return name;
}

const Naming *naming_new(Pool *pool, const Formulation *formulation, const char *upper)
{
    Naming *naming = pool_alloc(pool, sizeof *naming);
    const Model *model = formulation->model;
    const Sequence *sequence = formulation->sequence;
    const char **body = pool_alloc(pool, ((size_t)model->bodies + 1) * sizeof *body);
    const char **subset = pool_alloc(pool, ((size_t)sequence->subsets + 1) * sizeof *subset);
    const char **coordinate = pool_alloc(pool, ((size_t)model->coordinates + 1) * sizeof *coordinate);
    const char **wheel = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *wheel);
    for (int b = 0; b < model->bodies; ++b)
        body[b] = model->body[b].name;
    for (int w = 0; w < model->coordinates; ++w)
        coordinate[w] = model->coordinate[w].name;
    for (int i = 0; i < model->wheels; ++i)
        wheel[i] = model->wheel[i].name;
    for (int s = 0; s < sequence->subsets; ++s)
        subset[s] = sequence->subset[s].bodies ? model->body[sequence->subset[s].body[0]].name
                                               : pool_print(pool, "subset %d", s);
    *naming = (Naming){.formulation = formulation,
                       .upper = upper,
                       .coordinate = capitals(pool, coordinate, model->coordinates),
                       .wheel = capitals(pool, wheel, model->wheels)};
    if (formulation->plan->lanes)
        return naming;
    naming->body = capitals(pool, body, model->bodies);
    naming->subset = capitals(pool, subset, sequence->subsets);
    return naming;
}

static void write_enumerators(const Generation *g, Text *out, int indent, const char *kind, const char *const *name,
                              int count)
{
    for (int i = 0; i < count; ++i)
        line(out, indent, "%s_%s%s = %d,", g->upper, kind, name[i], i);
}

#define WRITE_ENUMERATORS(g, out, indent, kind, name) \
    write_enumerators(g, out, indent, kind, name, (int)(sizeof(name) / sizeof *(name)))

/* Coordinates, poses, unknowns of the equations of motion. */
static void write_numbers_of_poses(const Generation *g, Text *out, int indent)
{
    const Naming *naming = g->style->naming;
    const Model *model = g->model;
    for (int w = 0; naming->coordinate && w < model->coordinates; ++w)
        line(out, indent, "%s_X_%s = %d,", g->upper, naming->coordinate[w], w);
    WRITE_ENUMERATORS(g, out, indent, "Q_", pose_name);
    for (int b = 0; naming->body && b < model->bodies; ++b)
        line(out, indent, "%s_POSE_%s = %d,", g->upper, naming->body[b], 7 * b);
    if (model->free_base)
        WRITE_ENUMERATORS(g, out, indent, "UNKNOWN_", base_unknown_name);
    for (int w = 0; naming->coordinate && w < model->coordinates; ++w)
        if (g->plan->coordinate_unknown[w] >= 0)
            line(out, indent, "%s_UNKNOWN_OF_%s = %d,", g->upper, naming->coordinate[w],
                 g->plan->coordinate_unknown[w]);
    WRITE_ENUMERATORS(g, out, indent, "ENERGY_", energy_name);
}

/* Of one wheel, where those of each wheel begin, of the powertrain. */
static void write_numbers_of_wheels(const Generation *g, Text *out, int indent)
{
    const Naming *naming = g->style->naming;
    const Model *model = g->model;
    if (!g->formulation->wheels || g->formulation->wheels->count == 0)
        return;
    WRITE_ENUMERATORS(g, out, indent, "LINK_", link_name);
    WRITE_ENUMERATORS(g, out, indent, "GRIP_", grip_name);
    WRITE_ENUMERATORS(g, out, indent, "CONTACT_", contact_name);
    WRITE_ENUMERATORS(g, out, indent, "TIRE_", force_name);
    WRITE_ENUMERATORS(g, out, indent, "TORQUE_", torque_name);
    WRITE_ENUMERATORS(g, out, indent, "FAST_", fast_name);
    for (int i = 0; naming->wheel && i < model->wheels; ++i) {
        const int place = model->wheel[i].tire < 0 ? -1 : wheel_rolling(model, i);
        if (place < 0)
            continue;
        line(out, indent, "%s_LINK_OF_%s = %d,", g->upper, naming->wheel[i], LINK_NUMBERS * place);
        line(out, indent, "%s_GRIP_OF_%s = %d,", g->upper, naming->wheel[i], GRIP_NUMBERS * place);
        line(out, indent, "%s_TORQUE_OF_%s = %d,", g->upper, naming->wheel[i], 2 * place);
        line(out, indent, "%s_FAST_OF_%s = %d,", g->upper, naming->wheel[i], model->wheel[i].fast);
    }
    if (!model->powertrain)
        return;
    WRITE_ENUMERATORS(g, out, indent, "GEAR_", gear_name);
    WRITE_ENUMERATORS(g, out, indent, "WATCH_", watch_name);
    WRITE_ENUMERATORS(g, out, indent, "CHOICE_", choice_name);
}

void write_layout(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Naming *naming = g->style->naming;
    const Sequence *sequence = g->sequence;
    if (!naming)
        return;
    line(out, 0, "#ifndef %s_LAYOUT_NAMES", g->upper); /* for one vehicle and for many in one translation unit */
    line(out, 0, "#define %s_LAYOUT_NAMES", g->upper);
    text_print(
        out,
        "/* Places of numbers: in the motion of a body, in the inertia of a subset; where those of a body and of a "
        "subset\n * begin among all. */\nenum {\n");
    for (int i = 0; i < MOTION_S; ++i)
        line(out, indent + 4, "%s_%s = %d,", g->upper, motion_number_name(i), i);
    line(out, indent + 4, "%s_S = %d, /* unit velocities, 6 numbers a coordinate */", g->upper, MOTION_S);
    write_enumerators(g, out, indent + 4, "I_", inertia_name, INERTIA_COORDINATE);
    line(out, indent + 4, "%s_I_COORDINATE = %d, /* 7 numbers a coordinate, then the mass matrix */", g->upper,
         INERTIA_COORDINATE);
    for (int b = 0; naming->body && b < g->model->bodies; ++b)
        if (sequence->body_subset[b] >= 0 && sequence->subset[sequence->body_subset[b]].class >= 0)
            line(out, indent + 4, "%s_MOTION_%s = %d,", g->upper, naming->body[b], g->plan->motion_offset[b]);
    for (int s = 0; naming->subset && s < sequence->subsets; ++s)
        if (sequence->subset[s].class >= 0)
            line(out, indent + 4, "%s_INERTIA_%s = %d,", g->upper, naming->subset[s], g->plan->inertia_offset[s]);
    for (int s = 0; naming->subset && s < sequence->subsets; ++s)
        line(out, indent + 4, "%s_SUBSET_%s = %d,", g->upper, naming->subset[s], s);
    write_numbers_of_poses(g, out, indent + 4);
    write_numbers_of_wheels(g, out, indent + 4);
    line(out, indent + 4, "%s_LAYOUT_END = 0", g->upper);
    text_print(out, "};\n#endif\n\n");
    text_print(
        out,
        "/* Names of the columns of constants below: point_a, point_b, axis_a ... of a joint or a coordinate are in "
        "the frames\n * of its first and its second body, from their reference points; side and third are "
        "perpendicular to the axis. A turn\n * solves a cosine + b sine = k; distance and arm: its two points "
        "from the point that is turned about. com and J of a\n * body: its centre of mass from the reference "
        "point, its moments of inertia. */\n\n");
}

/* ---- indices ------------------------------------------------------------------------------------------------------
 */

static const char *number(Pool *pool, int index)
{
    return pool_print(pool, "%d", index);
}

/* A number of a body's motion. */
static const char *motion_index(Pool *pool, const Naming *naming, int i)
{
    return i < MOTION_S ? pool_print(pool, "%s_%s", naming->upper, motion_number_name(i))
                        : pool_print(pool, "%s_S + %d", naming->upper, i - MOTION_S);
}

static const char *inertia_index(Pool *pool, const Naming *naming, int i)
{
    return i < INERTIA_COORDINATE ? pool_print(pool, "%s_I_%s", naming->upper, inertia_name[i])
                                  : pool_print(pool, "%s_I_COORDINATE + %d", naming->upper, i - INERTIA_COORDINATE);
}

/* Of m[], all bodies' numbers. */
static const char *all_motion_index(Pool *pool, const Naming *naming, int i)
{
    const Plan *plan = naming->formulation->plan;
    const Sequence *sequence = plan->sequence;
    for (int b = 0; naming->body && b < plan->model->bodies; ++b) {
        const int s = sequence->body_subset[b];
        if (s < 0 || sequence->subset[s].class < 0)
            continue;
        const int own = i - plan->motion_offset[b];
        if (own >= 0 && own < plan->formula[sequence->subset[s].class]->layout.motion_size)
            return pool_print(pool, "%s_MOTION_%s + %s", naming->upper, naming->body[b],
                              motion_index(pool, naming, own));
    }
    return number(pool, i);
}

/* Of n[], all subsets' numbers. */
static const char *all_inertia_index(Pool *pool, const Naming *naming, int i)
{
    const Plan *plan = naming->formulation->plan;
    const Sequence *sequence = plan->sequence;
    for (int s = 0; naming->subset && s < sequence->subsets; ++s) {
        const int own = i - plan->inertia_offset[s];
        if (sequence->subset[s].class >= 0 && own >= 0 &&
            own < plan->formula[sequence->subset[s].class]->layout.inertia_size)
            return pool_print(pool, "%s_INERTIA_%s + %s", naming->upper, naming->subset[s],
                              inertia_index(pool, naming, own));
    }
    return number(pool, i);
}

static const char *state_index(Pool *pool, const Naming *naming, int i)
{
    const Formulation *f = naming->formulation;
    if (i < 0 || i >= f->plan->states + f->model->fast_states)
        return number(pool, i);
    return pool_print(pool, "%s_STATE_%s", naming->upper, capital(pool, state_number(pool, f, i).name));
}

const char *state_text(Pool *pool, const Naming *naming, int state)
{
    return naming && state >= 0 ? state_index(pool, naming, state) : number(pool, state);
}

const char *input_text(Pool *pool, const Naming *naming, int input)
{
    return naming && input < naming->formulation->model->inputs
               ? pool_print(pool, "%s_INPUT_%s", naming->upper,
                            capital(pool, naming->formulation->model->input[input].name))
               : number(pool, input);
}

const char *subset_text(Pool *pool, const Naming *naming, int subset)
{
    return naming && naming->subset && subset >= 0
               ? pool_print(pool, "%s_SUBSET_%s", naming->upper, naming->subset[subset])
               : number(pool, subset);
}

static const char *output_index(Pool *pool, const Naming *naming, int i)
{
    const Model *model = naming->formulation->model;
    for (int k = 0, first = 0; k < model->outputs; first += model->output[k++].count)
        if (i < first + model->output[k].count)
            return pool_print(pool, "%s_OUTPUT_%s", naming->upper,
                              capital(pool, model->output[k].component[i - first]));
    return number(pool, i);
}

static const char *parameter_index(Pool *pool, const Naming *naming, int i)
{
    const Model *model = naming->formulation->model;
    for (int k = 0; k < model->parameters; ++k)
        if (model->parameter[k].tunable && model->parameter[k].index == i)
            return pool_print(pool, "%s_PARAMETER_%s", naming->upper, capital(pool, model->parameter[k].name));
    return number(pool, i);
}

/* One of `count` numbers with names, %s_KIND_NAME. */
static const char *named(Pool *pool, const Naming *naming, const char *kind, const char *const *name, int count, int i)
{
    return i >= 0 && i < count ? pool_print(pool, "%s_%s_%s", naming->upper, kind, name[i]) : number(pool, i);
}
#define NAMED(pool, naming, kind, name, i) named(pool, naming, kind, name, (int)(sizeof(name) / sizeof *(name)), i)

/* A number of a wheel, `each` for one of them, in an array of all. */
static const char *wheel_index(Pool *pool, const Naming *naming, const char *kind, const char *const *name, int each,
                               int i)
{
    const Model *model = naming->formulation->model;
    if (naming->scope == SCOPE_WHEEL)
        return named(pool, naming, kind, name, each, i);
    for (int w = 0; naming->wheel && w < model->wheels; ++w)
        if (model->wheel[w].tire >= 0 && wheel_rolling(model, w) == i / each)
            return pool_print(pool, "%s_%s_OF_%s + %s_%s_%s", naming->upper, kind, naming->wheel[w], naming->upper,
                              kind, name[i % each]);
    return number(pool, i);
}

/* A fast state among them: of a wheel, or as a state. */
static const char *fast_index(Pool *pool, const Naming *naming, int i)
{
    if (naming->scope == SCOPE_WHEEL)
        return NAMED(pool, naming, "FAST", fast_name, i);
    /* (int): C++20 has no arithmetic between enumerations */
    return pool_print(pool, "(int)%s - %s_SLOW", state_index(pool, naming, naming->formulation->plan->states + i),
                      naming->upper);
}

const char *coordinate_text(Pool *pool, const Naming *naming, int coordinate)
{
    return naming && naming->coordinate ? pool_print(pool, "%s_X_%s", naming->upper, naming->coordinate[coordinate])
                                        : number(pool, coordinate);
}

const char *body_motion_text(const Generation *g, int body)
{
    const Naming *naming = g->style->naming;
    return naming && naming->body ? pool_print(g->pool, "%s_MOTION_%s", naming->upper, naming->body[body])
                                  : number(g->pool, g->plan->motion_offset[body]);
}

const char *subset_inertia_text(const Generation *g, int subset)
{
    const Naming *naming = g->style->naming;
    return naming && naming->subset ? pool_print(g->pool, "%s_INERTIA_%s", naming->upper, naming->subset[subset])
                                    : number(g->pool, g->plan->inertia_offset[subset]);
}

const char *wheel_place_text(const Generation *g, const char *array, int wheel, int place)
{
    const Naming *naming = g->style->naming;
    return naming && naming->wheel ? pool_print(g->pool, "%s_%s_OF_%s", naming->upper, array, naming->wheel[wheel])
                                   : number(g->pool, place);
}

/* An unknown of the equations of motion. */
static const char *unknown_index(Pool *pool, const Naming *naming, int i)
{
    const Plan *plan = naming->formulation->plan;
    if (naming->scope == SCOPE_FAST)
        return fast_index(pool, naming, i);
    for (int w = 0; naming->coordinate && w < plan->model->coordinates; ++w)
        if (plan->coordinate_unknown[w] == i)
            return pool_print(pool, "%s_UNKNOWN_OF_%s", naming->upper, naming->coordinate[w]);
    return plan->model->free_base ? NAMED(pool, naming, "UNKNOWN", base_unknown_name, i) : number(pool, i);
}

/* Of poses of all bodies, or of those of a subset. */
static const char *pose_index(Pool *pool, const Naming *naming, bool whole, int i)
{
    const char *own = NAMED(pool, naming, "Q", pose_name, i % 7);
    if (whole && naming->body)
        return pool_print(pool, "%s_POSE_%s + %s", naming->upper, naming->body[i / 7], own);
    return i < 7 ? own : pool_print(pool, "%d + %s", i - i % 7, own);
}

/* A rate: of the state, of fast states, or of the coordinates of a class. */
static const char *rate_index(Pool *pool, const Naming *naming, int i)
{
    return naming->scope == SCOPE_WHOLE   ? state_index(pool, naming, i)
           : naming->scope == SCOPE_CLASS ? number(pool, i)
                                          : fast_index(pool, naming, i);
}

static const char *index_text(Pool *pool, const Naming *naming, Element e)
{
    const Model *model = naming ? naming->formulation->model : NULL;
    if (!naming)
        return number(pool, e.index);
    switch (e.array) {
    case ARRAY_y:
    case ARRAY_self_state: return state_index(pool, naming, e.index);
    case ARRAY_u:
    case ARRAY_self_input: return input_text(pool, naming, e.index);
    case ARRAY_p: return parameter_index(pool, naming, e.index);
    case ARRAY_port:
        return pool_print(pool, "%s_PORT_%s + %d", naming->upper, capital(pool, model->port[e.index / 6].name),
                          e.index % 6);
    case ARRAY_out: return output_index(pool, naming, e.index);
    case ARRAY_m: return all_motion_index(pool, naming, e.index);
    case ARRAY_n: return all_inertia_index(pool, naming, e.index);
    case ARRAY_known: return motion_index(pool, naming, e.index);
    case ARRAY_inertia: return inertia_index(pool, naming, e.index);
    case ARRAY_motion:
        if (naming->class && e.index >= naming->class->layout.motion_size)
            return pool_print(pool, "%d + %s", e.index - e.index % naming->class->layout.motion_size,
                              motion_index(pool, naming, e.index % naming->class->layout.motion_size));
        return motion_index(pool, naming, e.index);
    case ARRAY_rate: return rate_index(pool, naming, e.index);
    case ARRAY_x:
    case ARRAY_xd: return naming->scope == SCOPE_CLASS ? number(pool, e.index) : coordinate_text(pool, naming, e.index);
    case ARRAY_q: return pose_index(pool, naming, false, e.index);
    case ARRAY_start:
        return naming->class && e.index < naming->class->layout.start_S ? pose_index(pool, naming, false, e.index)
                                                                        : number(pool, e.index);
    case ARRAY_pose: return pose_index(pool, naming, true, e.index);
    case ARRAY_acc:
    case ARRAY_left:
    case ARRAY_tau:
    case ARRAY_size: return unknown_index(pool, naming, e.index);
    case ARRAY_energy: return NAMED(pool, naming, "ENERGY", energy_name, e.index);
    case ARRAY_link: return wheel_index(pool, naming, "LINK", link_name, LINK_NUMBERS, e.index);
    case ARRAY_grip:
    case ARRAY_self_grip: return wheel_index(pool, naming, "GRIP", grip_name, GRIP_NUMBERS, e.index);
    case ARRAY_torque: return wheel_index(pool, naming, "TORQUE", torque_name, 2, e.index);
    case ARRAY_contact: return NAMED(pool, naming, "CONTACT", contact_name, e.index);
    case ARRAY_force: return NAMED(pool, naming, "TIRE", force_name, e.index);
    case ARRAY_fast: return fast_index(pool, naming, e.index);
    case ARRAY_gear: return NAMED(pool, naming, "GEAR", gear_name, e.index);
    case ARRAY_watch:
    case ARRAY_self_watch: return NAMED(pool, naming, "WATCH", watch_name, e.index);
    case ARRAY_choice:
        return e.index < CHOICE_UP ? NAMED(pool, naming, "CHOICE", choice_name, e.index)
                                   : pool_print(pool, "%s_CHOICE_UP + %d", naming->upper, e.index - CHOICE_UP);
    default: return number(pool, e.index);
    }
}

/* Its array's name, with the number of one of several; of derivatives: dm, along->grip. */
static const char *array_name(Pool *pool, Element e)
{
    static const char own[] = "self->";
    const bool several = e.array == ARRAY_known || e.array == ARRAY_onto || e.array == ARRAY_column_known;
    const char *name = several ? pool_print(pool, "%s%d", array_text[e.array], e.which) : array_text[e.array];
    if (!e.slope)
        return name;
    return strncmp(name, own, sizeof own - 1) ? pool_print(pool, "d%s", name)
                                              : pool_print(pool, "along->%s", name + sizeof own - 1);
}

const char *element_text(Pool *pool, const Naming *naming, Element e)
{
    switch (e.array) {
    case ARRAY_number: return emit_number(pool, e.number);
    case ARRAY_time:
    case ARRAY_reach:
    case ARRAY_step:
    case ARRAY_rest: return array_text[e.array];
    case ARRAY_right:
    case ARRAY_part:
        return pool_print(pool, "%s[%d][%s]", array_text[e.array], e.index,
                          e.which < 0 ? "c" : pool_print(pool, "%d", e.which));
    default: return pool_print(pool, "%s[%s]", array_name(pool, e), index_text(pool, naming, e));
    }
}

const char *element_row_text(Pool *pool, const Naming *naming, Element e, int step)
{
    if (step == 1)
        return element_text(pool, naming, e);
    const char *index = index_text(pool, naming, e), *plus = strchr(index, '+');
    if (!naming)
        return pool_print(pool, "%s[%d]", array_name(pool, e), e.index * step);
    return pool_print(pool, plus ? "%s[%d * (%s)]" : "%s[%d * %s]", array_name(pool, e), step, index);
}

const char *element_address(Pool *pool, const Naming *naming, Element e)
{
    return pool_print(pool, "%s + %s", array_name(pool, e), index_text(pool, naming, e));
}

/* ---- temporaries --------------------------------------------------------------------------------------------------
 */

/* An identifier of what stands between and in names. */
const char *variable_name(Pool *pool, const char *s)
{
    char *out = pool_print(pool, "%s", s), *end = out;
    for (; *s; ++s) {
        const char c = isalnum((unsigned char)*s) ? (char)tolower((unsigned char)*s) : '_';
        if (c != '_' || (end > out && end[-1] != '_'))
            *end++ = c;
    }
    *end = 0;
    return out;
}

static const char *motion_variable(Pool *pool, const Naming *naming, int i)
{
    const int size = naming->class ? naming->class->layout.motion_size : MOTION_S, body = i / size, own = i % size;
    const char *name = own < MOTION_S ? motion_number_name(own)
                                      : pool_print(pool, "s_%d_%d", (own - MOTION_S) / 6, (own - MOTION_S) % 6);
    return variable_name(pool, body ? pool_print(pool, "%s_%d", name, body + 1) : name);
}

static const char *inertia_variable(Pool *pool, const Naming *naming, int i)
{
    const int deps = naming->class ? naming->class->layout.deps : 0, own = i - INERTIA_COORDINATE;
    if (own < 0)
        return variable_name(pool, pool_print(pool, "inertia %s", inertia_name[i]));
    if (own < 7 * deps)
        return variable_name(pool, pool_print(pool, "along %d %s", own / 7, coordinate_name[own % 7]));
    return pool_print(pool, "mass_%d", own - 7 * deps);
}

const char *element_variable(Pool *pool, const Naming *naming, Element e)
{
    if (e.slope)
        return NULL;
    const char *index = index_text(pool, naming, e);
    const size_t upper = strlen(naming->upper) + 1;
    switch (e.array) {
    case ARRAY_motion: return motion_variable(pool, naming, e.index);
    case ARRAY_inertia: return inertia_variable(pool, naming, e.index);
    case ARRAY_rate:
    case ARRAY_out:
        if (naming->scope != SCOPE_WHOLE || isdigit((unsigned char)*index))
            return NULL;
        return variable_name(pool, pool_print(pool, "%s %s", e.array == ARRAY_rate ? "rate of" : "",
                                              index + upper + (e.array == ARRAY_rate ? strlen("STATE_") : 0)));
    case ARRAY_tau: return pool_print(pool, "residual_%d", e.index);
    case ARRAY_lambda: return pool_print(pool, "lambda_%d", e.index);
    default: return NULL;
    }
}
