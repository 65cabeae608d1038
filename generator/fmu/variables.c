/* SPDX-License-Identifier: MIT
 * The variables of an FMU, in the order of modelDescription.xml. Names are those of gicrun: outputs as they are, the
 * others in groups: input, parameter, port, state, solver. */
#include "base/file.h"
#include "emit/emit.h"
#include "fmu/fmu_private.h"

#include <math.h>
#include <string.h>

unsigned variable_reference(const Variable *variable)
{
    return (unsigned)variable->kind * KIND_SIZE + (unsigned)variable->index;
}

bool is_output(const Variable *variable)
{
    return variable->kind == KIND_OUTPUT || variable->kind == KIND_PLACE;
}

bool is_initial_unknown(const Variable *variable)
{
    return variable->initial && !strcmp(variable->initial, "calculated") && variable->kind != KIND_INDICATOR;
}

int event_indicators(const Variables *all)
{
    int count = 0;
    for (int i = 0; i < all->count; ++i)
        count += all->variable[i].kind == KIND_INDICATOR;
    return count;
}

Experiment experiment_of(const Scene *scene)
{
    /* without a scene: steps that all of our models take, and ten seconds */
    Experiment experiment = {.step = 0.001, .stop = 10, .method = GIC_AB3, .ratio = 1, .keep = 1};
    if (!scene)
        return experiment;
    experiment.stop = scene->duration;
    if (scene->method < METHOD_ADAMS) {
        experiment.step = scene->step;
        experiment.method = scene->method;
        experiment.ratio = scene->ratio;
        experiment.keep = scene_implicit(scene) ? scene->keep : 1;
        experiment.spread = scene_implicit(scene) && scene->spread;
        experiment.steady = scene->steady;
        experiment.locate = scene->locate;
        experiment.most_work = scene->most_work;
    }
    return experiment;
}

typedef struct Making {
    Pool *pool;
    const Formulation *f;
    const Model *model;
    const Scene *scene;
    Variables *all;
} Making;

static Variable *add(Making *m, int kind, int index, const char *name, const char *unit, const char *description)
{
    Variables *all = m->all;
    Variable *variable = POOL_PUSH(m->pool, all->variable, all->count);
    if (!index)
        all->first[kind] = all->count - 1;
    *variable = (Variable){.name = name,
                           .description = description,
                           .unit = unit,
                           .causality = "local",
                           .variability = "continuous",
                           .kind = kind,
                           .index = index,
                           .least = NAN,
                           .most = NAN,
                           .of = -1};
    return variable;
}

static void set_start(Variable *variable, double start)
{
    variable->starts = true;
    variable->start = start;
}

/* ---- states ------------------------------------------------------------------------------------------------ */

static int state_coordinate(const Making *m, int state, bool *rate)
{
    for (int w = 0; w < m->model->coordinates; ++w) {
        *rate = m->f->plan->coordinate_rate[w] == state;
        if (*rate || m->f->plan->coordinate_state[w] == state)
            return w;
    }
    return -1;
}

/* What a controller holds, or will when its delay ends: a group of the rule's name has both, as names are those of
 * values or of groups. NULL: no state of a rule. */
static const char *rule_state_name(const Making *m, int fast)
{
    const Model *model = m->model;
    for (int i = 0; i < model->controllers; ++i)
        for (int j = 0; j < model->controller[i].rules; ++j) {
            const ControlRule *rule = &model->controller[i].rule[j];
            const int way = fast - model->state[rule->state].fast;
            if (way == 0)
                return pool_print(m->pool, "state.%s.value", rule->name);
            if (way > 0 && way <= rule->waiting)
                return pool_print(m->pool, "state.%s.delayed_%d", rule->name, way);
        }
    return NULL;
}

/* Name, description and nominal value of a state. */
static void name_state(Making *m, int state, const char **name, const char **description, double *nominal)
{
    static const char *const base[] = {"position of the base's origin", "Euler parameter of the base",
                                       "velocity of the base's origin, world frame",
                                       "angular velocity of the base, its own frame"};
    const char *own = state_number(m->pool, m->f, state).name;
    bool rate;
    const int w = state_coordinate(m, state, &rate);
    *nominal = 1;
    *name = pool_print(m->pool, w >= 0 && !rate ? "state.%s.value" : "state.%s", own);
    if (w >= 0) {
        *description = pool_print(m->pool, "%s coordinate '%s'", rate ? "rate of" : "", m->model->coordinate[w].name);
        *description += rate ? 0 : 1;
        if (m->model->coordinate[w].type != COORDINATE_ANGLE)
            *nominal = 0.1; /* m, or m/s: travel of suspensions */
    } else if (state >= m->f->plan->states) {
        const char *held = rule_state_name(m, state - m->f->plan->states);
        *name = held ? held : *name;
        *description = pool_print(m->pool, "fast state '%s'", own);
        *nominal = path_ends(own, ".spin") ? 10 : path_ends(own, ".speed") ? 100 : 1;
        if (path_ends(own, ".slip_x") || path_ends(own, ".slip_y"))
            *nominal = 0.1;
    } else {
        const int which = state < 7 ? state : state - m->f->plan->free_coordinates;
        *description = base[which < 3 ? 0 : which < 7 ? 1 : which < 10 ? 2 : 3];
        *nominal = which < 3 ? 10 : 1;
    }
}

/* True if the scene gives the state a start value. */
static bool scene_start_value(const Making *m, int state, double *value)
{
    const Scene *scene = m->scene;
    bool rate;
    if (!scene)
        return false;
    const int w = state_coordinate(m, state, &rate);
    if (state >= m->f->plan->states) {
        *value = scene->fast[state - m->f->plan->states];
        return !isnan(*value);
    }
    if (w >= 0) {
        *value = rate ? scene->rate[w] : scene->value[w];
        return rate || scene->given[w];
    }
    const int which = state < 7 ? state : state - m->f->plan->free_coordinates;
    *value = which < 3    ? scene->position[which]
             : which < 7  ? scene->euler[which - 3]
             : which < 10 ? scene->velocity[which - 7]
                          : scene->angular_velocity[which - 10];
    return which >= 3 || scene->placed;
}

/* The wheel that a fast state belongs to, -1: to none. */
static int state_wheel(const Making *m, int state)
{
    const int fast = state - m->f->plan->states;
    for (int i = 0; i < m->model->wheels && fast >= 0; ++i) {
        const Wheel *wheel = &m->model->wheel[i];
        if (wheel->tire >= 0 && fast >= wheel->fast && fast < wheel->fast + wheel_fast_states(wheel))
            return i;
    }
    return -1;
}

/* Set-up decides: wheels start rolling, and positions follow geometric parameters. */
static bool is_calculated(const Making *m, int state)
{
    bool rate;
    double value;
    if (scene_start_value(m, state, &value))
        return false;
    const bool position = state < 7 && m->model->free_base;
    return state_wheel(m, state) >= 0 ||
           (m->model->tuning && (position || (state_coordinate(m, state, &rate) >= 0 && !rate)));
}

static void add_states(Making *m)
{
    const int states = m->f->plan->states + m->model->fast_states;
    const char *name, *description;
    double nominal;
    for (int i = 0; i < states; ++i) {
        const StateNumber number = state_number(m->pool, m->f, i);
        name_state(m, i, &name, &description, &nominal);
        Variable *v = add(m, KIND_STATE, i, name, number.unit, description);
        const int wheel = state_wheel(m, i);
        v->nominal = nominal;
        v->initial = is_calculated(m, i) ? "calculated" : "exact";
        v->terminal = wheel >= 0 ? m->model->wheel[wheel].name : NULL;
        if (!is_calculated(m, i)) {
            double start;
            v->given = scene_start_value(m, i, &start);
            set_start(v, v->given ? start : number.initial);
        }
        v->reinit = m->model->powertrain && i == m->f->plan->states + m->model->powertrain->fast + POWERTRAIN_AGE;
    }
    for (int i = 0; i < states; ++i) {
        const Variable *state = &m->all->variable[m->all->first[KIND_STATE] + i];
        const char *unit = !strcmp(state->unit, "1")       ? "1/s"
                           : !strcmp(state->unit, "s")     ? "1"
                           : !strcmp(state->unit, "m/s")   ? "m/s^2"
                           : !strcmp(state->unit, "rad/s") ? "rad/s^2"
                                                           : pool_print(m->pool, "%s/s", state->unit);
        const char *rate = pool_print(m->pool, "der(%s)", state->name);
        const int of = m->all->first[KIND_STATE] + i;
        Variable *v = add(m, KIND_DERIVATIVE, i, rate, unit, pool_print(m->pool, "time derivative of %s", state->name));
        v->initial = "calculated";
        v->of = of;
    }
    if (m->model->powertrain) {
        Variable *gear = add(m, KIND_DISCRETE, m->model->free_base, "state.transmission.gear", NULL,
                             "gear of the transmission, 0: neutral, -1: first reverse gear");
        m->all->first[KIND_DISCRETE] = m->all->count - 1;
        gear->type = TYPE_WHOLE;
        gear->variability = "discrete";
        gear->initial = "exact";
        gear->terminal = "powertrain";
        gear->least = -m->model->powertrain->reverse;
        gear->most = m->model->powertrain->forward;
        set_start(gear, m->scene ? m->scene->gear : m->model->powertrain->start_gear);
        Variable *event = add(m, KIND_INDICATOR, 0, "state.transmission.due", "1",
                              "event indicator: 1 in the present gear, -1 where another one is due");
        event->initial = "calculated";
        event->terminal = "powertrain";
    }
}

static void add_contacts(Making *m)
{
    ContactSite site;
    for (int i = 0; m->f->contacts && i < m->f->contacts->stores && model_contact(m->model, i, &site); ++i) {
        const char *end = site.high ? "high" : "low";
        const char *name = site.wheel ? site.wheel->name : pool_print(m->pool, "%s.%s", site.stop->name, end);
        Variable *v = add(
            m, KIND_INDICATOR, event_indicators(m->all), pool_print(m->pool, "state.contact.%s", name), "1",
            pool_print(m->pool, "event indicator: its sign says whether %s has a load", contact_text(m->pool, &site)));
        v->initial = "calculated";
        if (site.wheel)
            v->terminal = name;
    }
}

/* ---- the others -------------------------------------------------------------------------------------------- */

static void add_inputs(Making *m)
{
    double value[m->model->inputs + 1];
    for (int i = 0; i < m->model->inputs; ++i)
        value[i] = m->model->input[i].initial;
    if (m->scene)
        scene_inputs((void *)m->scene, 0, 0, value);
    for (int i = 0; i < m->model->inputs; ++i) {
        const Input *input = &m->model->input[i];
        const char *name = pool_print(m->pool, "input.%s", input->name);
        const char *description = pool_print(m->pool, "input '%s'", input->name);
        for (int w = 0; w < m->model->coordinates; ++w) {
            const Coordinate *c = &m->model->coordinate[w];
            static const char *const part[] = {"value", "rate", "acceleration"};
            if (!c->driven || i < c->input || i > c->input + 2)
                continue;
            name = pool_print(m->pool, "input.%s.%s", c->name, part[i - c->input]);
            description = pool_print(m->pool, "%s of driven coordinate '%s'", part[i - c->input], c->name);
        }
        Variable *v = add(m, KIND_INPUT, i, name, input->unit, description);
        v->causality = "input";
        set_start(v, value[i]);
    }
}

static void add_ports(Making *m)
{
    static const char axis[] = "xyz";
    for (int i = 0; i < m->model->ports; ++i) {
        const Port *port = &m->model->port[i];
        for (int c = 0; c < 6; ++c) {
            const char *what = c < 3 ? "force" : "torque";
            Variable *v = add(m, KIND_PORT, 6 * i + c,
                              pool_print(m->pool, "port.%s.%s.%c", port->name, what, axis[c % 3]), c < 3 ? "N" : "N m",
                              pool_print(m->pool, "external %s on body '%s'", what, m->model->body[port->body].name));
            v->causality = "input";
            v->terminal = port->name;
            set_start(v, 0);
        }
    }
}

/* The road under each wheel, where the importer has one. */
static void add_road(Making *m)
{
    static const struct {
        const char *name, *unit, *description;
        double start;
    } part[] = {{"height", "m", "height of the road under the wheel's centre", 0},
                {"normal.x", "1", "normal of the road there", 0},
                {"normal.y", "1", "normal of the road there", 0},
                {"normal.z", "1", "normal of the road there, greater than zero; of any length", 1},
                {"friction", "1", "friction there, relative to the road that the tire was measured on", 1}};
    enum { PARTS = sizeof part / sizeof *part };
    for (int i = 0; i < PARTS * m->model->wheels; ++i) {
        const char *wheel = m->model->wheel[i / PARTS].name;
        Variable *v = add(m, KIND_ROAD, i, pool_print(m->pool, "road.%s.%s", wheel, part[i % PARTS].name),
                          part[i % PARTS].unit, part[i % PARTS].description);
        v->causality = "input";
        v->terminal = wheel;
        set_start(v, part[i % PARTS].start);
    }
}

static void add_places(Making *m)
{
    for (int i = 0; i < 2 * m->model->wheels; ++i) {
        const char *wheel = m->model->wheel[i / 2].name;
        Variable *v = add(m, KIND_PLACE, i, pool_print(m->pool, "road.%s.%c", wheel, "xy"[i % 2]), "m",
                          pool_print(m->pool, "%c of the wheel's centre in the world", "xy"[i % 2]));
        v->causality = "output";
        v->initial = "calculated";
        v->terminal = wheel;
    }
}

static void add_parameters(Making *m)
{
    for (int i = 0; i < m->model->parameters; ++i) {
        const Parameter *parameter = &m->model->parameter[i];
        if (!parameter->tunable)
            continue;
        Variable *v = add(m, KIND_PARAMETER, parameter->index, pool_print(m->pool, "parameter.%s", parameter->name),
                          parameter->unit,
                          pool_print(m->pool, "parameter '%s'%s", parameter->name,
                                     parameter->geometric ? ", acts when the vehicle is set up" : ""));
        v->causality = "parameter";
        v->variability = parameter->geometric ? "fixed" : "tunable";
        v->initial = "exact";
        set_start(v, m->scene ? m->scene->parameter[parameter->index] : parameter->value);
    }
}

static void add_outputs(Making *m)
{
    int index = 0;
    for (int i = 0; i < m->model->outputs; ++i) {
        const Output *output = &m->model->output[i];
        for (int c = 0; c < output->count; ++c) {
            /* of a rule: beside what it holds */
            const char *name =
                output->sampled ? pool_print(m->pool, "state.%s", output->component[c]) : output->component[c];
            Variable *v = add(m, KIND_OUTPUT, index++, name, output->unit[c],
                              pool_print(m->pool, "output '%s' (%s)", output->name, output_type_name[output->type]));
            const bool wheel =
                output->type == OUTPUT_WHEEL || output->type == OUTPUT_TIRE || output->type == OUTPUT_CONTACT;
            v->causality = "output";
            v->initial = "calculated";
            v->terminal = wheel                               ? m->model->wheel[output->index].name
                          : output->type == OUTPUT_POWERTRAIN ? "powertrain"
                                                              : NULL;
        }
    }
}

/* Number k of the parameters of co-simulation's steps. */
static Variable *add_step_parameter(Making *m, int k, const char *name, const char *unit, const char *description)
{
    Variable *v = add(m, KIND_SOLVER, k, name, unit, description);
    v->causality = "parameter";
    v->variability = "fixed";
    v->initial = "exact";
    return v;
}

static void add_step_count(Making *m, int k, const char *name, const char *description, int most, int start)
{
    Variable *v = add_step_parameter(m, k, name, NULL, description);
    v->type = TYPE_WHOLE;
    v->least = 1;
    v->most = most;
    set_start(v, start);
}

static void add_solver(Making *m, bool implicit, bool shares)
{
    const Experiment experiment = experiment_of(m->scene);
    Variable *v =
        add_step_parameter(m, 0, "solver.step", "s",
                           "longest step within a communication step; these are divided into steps of equal length");
    v->least = 1e-9;
    set_start(v, experiment.step);
    v = add_step_parameter(m, 1, "solver.method", NULL, "integrator of co-simulation");
    v->type = TYPE_METHOD;
    set_start(v, experiment.method + 1);
    add_step_count(m, 2, "solver.ratio", "steps of wheels and powertrain in a step of the bodies; with RK4 1",
                   GIC_RATIOS, experiment.ratio);
    if (implicit)
        add_step_count(m, 3, "solver.keep_jacobian", "with implicit methods: steps with one Jacobian", KEEP_MOST,
                       experiment.keep);
    if (shares) {
        add_step_count(m, 4, "solver.spread_jacobian", "1: steps that keep a Jacobian make the next one by shares", 1,
                       experiment.spread);
        m->all->variable[m->all->count - 1].least = 0;
    }
    if (m->f->contacts) {
        add_step_count(m, 5, "solver.locate",
                       "1: steps are made in parts where contacts begin or end, 2: also where loads bend, 0: neither",
                       2, experiment.locate);
        m->all->variable[m->all->count - 1].least = 0;
    }
    if (m->f->contacts || m->model->powertrain) {
        add_step_count(m, 6, "solver.most_work",
                       "the most evaluations of a step, right-hand sides and looks at contacts and gears; 0: no bound",
                       SCENE_MOST_WORK, experiment.most_work);
        m->all->variable[m->all->count - 1].least = 0;
    }
}

const Variables *variables_make(Pool *pool, const Formulation *f, const Scene *scene, bool implicit, bool shares)
{
    Making m = {pool, f, f->model, scene, pool_alloc(pool, sizeof *m.all)};
    Variable *time = add(&m, KIND_TIME, 0, "time", "s", "time");
    time->causality = "independent";
    add_inputs(&m);
    add_ports(&m);
    add_road(&m);
    add_outputs(&m);
    add_places(&m);
    add_parameters(&m);
    add_solver(&m, implicit, shares);
    add_states(&m);
    add_contacts(&m);
    return m.all;
}
