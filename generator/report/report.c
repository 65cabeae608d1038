/* SPDX-License-Identifier: MIT
 * The page of --report: the model, its sequence, and the cost of its code. */
#include "base/text.h"
#include "base/version.h"
#include "emit/emit.h"
#include "expression/expression.h"
#include "model/model.h"
#include "report/report.h"
#include "sequence/sequence.h"
#include "vehicle/vehicle.h"

#include <stdlib.h>
#include <string.h>

typedef struct Report {
    Pool *pool;
    const char *path;
    const Formulation *formulation;
    const Figures *figures;
    const Model *model;
    const Sequence *sequence;
    const CodeMemory *code;
    int chords, passes, pieces; /* bounds of the code: corrections with old factors and with new ones, pieces */
} Report;

enum { STAGES_OF_RK4 = 4 };

/* ---- HTML -------------------------------------------------------------------------------------------------------- */

/* `columns`: titles separated by bars; a title that begins with a number sign is of a column of numbers. */
static void table_open(Text *out, const char *id, const char *caption, const char *columns)
{
    text_print(out, "<table id=\"%s\">\n<caption>%s</caption>\n<thead><tr>", id, caption);
    for (const char *end; *columns; columns = end + (*end != 0)) {
        end = columns + strcspn(columns, "|");
        bool number = *columns == '#';
        text_print(out, "<th%s>%.*s</th>", number ? " class=\"n\"" : "", (int)(end - columns - number),
                   columns + number);
    }
    text_print(out, "</tr></thead>\n<tbody>\n");
}

static void table_close(Text *out)
{
    text_print(out, "</tbody>\n</table>\n");
}

static void row_open(Text *out)
{
    text_print(out, "<tr>");
}

static void row_close(Text *out)
{
    text_print(out, "</tr>\n");
}

static void cell(Text *out, const char *s)
{
    text_print(out, "<td>");
    text_html(out, s);
    text_print(out, "</td>");
}

static void cell_number(Text *out, double value)
{
    text_print(out, "<td class=\"n\">%.15g</td>", value);
}

/* One more word of a list in a cell. */
static void listed(Text *list, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void listed(Text *list, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    text_print(list, "%s%s", list->size ? ", " : "", pool_vprint(list->pool, format, args));
    va_end(args);
}

static void cell_list(Text *out, const Text *list)
{
    cell(out, list->size ? list->s : "");
}

/* ---- sections ---------------------------------------------------------------------------------------------------- */

static void identity(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Model *model = r->model;
    const Sequence *sequence = r->sequence;
    text_print(out, "<p>");
    text_html(out, model->description);
    text_print(out,
               "</p>\n<p>%d bodies on a %s base, <code>%s</code>; %d joints, %d dual coordinates, %d force elements, "
               "%d wheels. %d coordinates, %d equations, %d degrees of freedom.</p>\n",
               sequence->unknowns / 7, model->free_base ? "free" : "fixed", model->body[BODY_BASE].name, model->joints,
               model->coordinates, model->forces, model->wheels, sequence->unknowns, sequence->equations,
               sequence->dof);
    if (model->fast_states > model->states)
        text_print(out, "<p>Wheels with tires%s have %d fast states.</p>\n",
                   model->powertrain ? " and the powertrain" : "", model->fast_states - model->states);
    if (model->states)
        text_print(out, "<p>It has %d state%s of its own.</p>\n", model->states, model->states > 1 ? "s" : "");
    text_print(out, "<p>Equations of motion in the %s form. Code of gicgen %s; model hash <code>%s</code>.</p>\n",
               solve_name[r->formulation->plan->solve], GICGEN_VERSION, r->formulation->hash);
}

/* The assumptions of code for one scene, and the operations that they save. */
static void scene(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Narrowing *narrowing = r->formulation->narrowing;
    if (!narrowing)
        return;
    text_print(out, "<h2>Scene</h2>\n<p>This code is for the scene <code>");
    text_html(out, narrowing->facts->scene);
    text_print(out, "</code> alone. What it takes for granted it checks in each call, which ends with "
                    "<code>GIC_ERROR_ASSUMPTION</code> and the text of what is broken.</p>\n");
    table_open(out, "assumptions", "Assumptions", "what is taken for granted");
    for (int i = 0; i < narrowing->assumptions; ++i) {
        row_open(out);
        cell(out, narrowing->assumption[i].text);
        row_close(out);
    }
    table_close(out);
    table_open(out, "savings", "What is left out, one after the other, and the operations that are left",
               "what|why|#right-hand side before|#after|#outputs before|#after");
    for (int i = 1; i < narrowing->account->rows; ++i) {
        const AccountRow *row = &narrowing->account->row[i];
        row_open(out);
        cell(out, row->what);
        cell(out, row->why);
        cell_number(out, count_sum(row[-1].rhs));
        cell_number(out, count_sum(row->rhs));
        cell_number(out, count_sum(row[-1].outputs));
        cell_number(out, count_sum(row->outputs));
        row_close(out);
    }
    table_close(out);
}

static void sequence(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Model *model = r->model;
    table_open(out, "sequence", "Stages and subsets",
               "#subset|#stage|class|bodies|joints (equations)|coordinates|known before|#unknowns|#equations|motion "
               "depends on");
    for (int s = 0; s < r->sequence->subsets; ++s) {
        const Subset *subset = &r->sequence->subset[s];
        Text bodies = {.pool = r->pool}, joints = bodies, coordinates = bodies, knowns = bodies, deps = bodies;
        int unknowns, equations;
        for (int i = 0; i < subset->bodies; ++i)
            listed(&bodies, "%s", model->body[subset->body[i]].name);
        for (int i = 0; i < subset->joints; ++i) {
            const Joint *joint = &model->joint[subset->joint[i]];
            listed(&joints, "%s (%s %d)", joint->name, joint_type_name[joint->type], joint_equations[joint->type]);
        }
        for (int i = 0; i < subset->coordinates; ++i) {
            const Coordinate *c = &model->coordinate[subset->coordinate[i]];
            listed(&coordinates, "%s (%s%s)", c->name, coordinate_type_name[c->type], c->driven ? ", driven" : "");
        }
        for (int i = 0; i < subset->knowns; ++i)
            listed(&knowns, "%s", model->body[subset->known[i]].name);
        for (int i = 0; i < subset->deps; ++i)
            listed(&deps, "%s", model->coordinate[subset->dep[i]].name);
        subset_shape(model, subset, &unknowns, &equations);
        row_open(out);
        cell_number(out, s + 1);
        cell_number(out, subset->stage);
        cell(out, subset->class < 0 ? "base: its dependent Euler parameter" : r->sequence->class[subset->class].name);
        cell_list(out, &bodies);
        cell_list(out, &joints);
        cell_list(out, &coordinates);
        cell_list(out, &knowns);
        cell_number(out, unknowns);
        cell_number(out, equations);
        cell_list(out, &deps);
        row_close(out);
    }
    table_close(out);
}

static void graph(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    Text dot = {.pool = r->pool}, svg = {.pool = r->pool};
    graph_draw(&dot, r->model, r->sequence);
    if (!picture_make(r->path, &dot, &svg)) {
        text_print(out, "<p>No drawing: Graphviz's program <code>dot</code> is not installed.</p>\n");
        return;
    }
    /* skip the header of a stand-alone picture */
    const char *from = strstr(svg.s, "<svg");
    text_print(out, "%s", from ? from : svg.s);
}

static void count_row(Text *out, const char *what, const char *block, int times, Count c)
{
    const int number[] = {times, c.add, c.multiply, c.divide, c.root, c.function};
    row_open(out);
    cell(out, what);
    cell(out, block);
    for (size_t i = 0; i < sizeof number / sizeof *number; ++i)
        cell_number(out, number[i]);
    cell_number(out, c.add + c.multiply + c.divide + c.root + c.function);
    row_close(out);
}

static void operations(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Figures *f = r->figures;
    table_open(out, "operations", "Operations of each block, once",
               "of|block|#subsets|#add|#multiply|#divide|#root|#function|#all");
    for (int c = 0; c < r->sequence->classes; ++c) {
        const Class *class = &r->sequence->class[c];
        if (!f->class[c].closed) {
            count_row(out, class->name, "predict", class->members, f->class[c].predict);
            count_row(out, class->name, "chord", class->members, f->class[c].chord);
        }
        count_row(out, class->name, f->class[c].closed ? "closed form" : "solve", class->members, f->class[c].solve);
        if (f->reacting[c])
            count_row(out, class->name, "react", f->reacting[c], f->react[c]);
    }
    count_row(out, "all together", "forces and equations of motion", 1, f->dynamics);
    const Wheels *wheels = r->formulation->wheels;
    if (wheels) {
        const bool rolls = wheels->count > 0, own = r->model->states > 0;
        count_row(out, "all together", rolls ? "motion of the wheels" : "what rates of own states read", 1, f->link);
        count_row(out, "all together",
                  !own    ? "drives and brakes"
                  : rolls ? "drives, brakes, rates of own states"
                          : "rates of own states",
                  1, f->torque);
        for (int c = 0; c < wheels->classes; ++c)
            count_row(out, wheels->class[c].name, "wheel with its tire", wheels->class[c].members, f->wheel[c]);
        if (r->model->powertrain)
            count_row(out, "all together", "powertrain", 1, f->drive);
    }
    if (formulation_reacts(r->formulation))
        count_row(out, "all together", "wrenches", 1, f->wrenches);
    count_row(out, "all together", "outputs", 1, f->outputs);
    table_close(out);
}

static void bounds(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    text_print(
        out,
        "<p><code>GIC_CHORDS</code> = %d chords and <code>GIC_PASSES</code> = %d solves a subset; beyond them a call "
        "ends with a status. A change that turns some body by more than about 0.1 rad (or moves it by 0.1 of its "
        "subset's size) is followed in several pieces, each of them one recovery of all subsets; a call in more "
        "than <code>GIC_PIECES</code> = %d pieces ends with a status; whole turns of an angle that far away do not "
        "count.</p>\n",
        r->chords, r->passes, r->pieces);
}

static void total_row(Text *out, const char *what, Count c, double times)
{
    const double number[] = {c.add, c.multiply, c.divide, c.root, c.function};
    double sum = 0;
    row_open(out);
    cell(out, what);
    for (size_t i = 0; i < sizeof number / sizeof *number; ++i) {
        cell_number(out, times * number[i]);
        sum += times * number[i];
    }
    cell_number(out, sum);
    row_close(out);
}

static void totals(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Figures *f = r->figures;
    Count usual = figures_rhs(f, 1, 1), worst = figures_rhs(f, r->chords, r->passes), asked = usual;
    count_add(&asked, figures_outputs(f), 1);
    table_open(out, "totals", "Operations of whole calls", "call|#add|#multiply|#divide|#root|#function|#all");
    total_row(out, "right-hand side, usual", usual, 1);
    total_row(out, "right-hand side, worst case in one piece", worst, 1);
    total_row(out, "every further piece, worst case", figures_recovery(f, r->chords, r->passes), 1);
    total_row(out, "AB3 step, usual", usual, 1);
    total_row(out, "AB3 step, worst case", worst, 1);
    total_row(out, "RK4 step or one of the first two AB3 steps, usual", usual, STAGES_OF_RK4);
    total_row(out, "RK4 step or one of the first two AB3 steps, worst case", worst, STAGES_OF_RK4);
    if (r->formulation->wheels)
        total_row(out, r->formulation->wheels->count > 0 ? "fast step: all wheels" : "fast step", f->fast, 1);
    total_row(out, "outputs, usual", asked, 1);
    if (r->formulation->contacts)
        total_row(out, "look at contacts", figures_look(f), 1);
    table_close(out);
}

static const char *unit_of(const Coordinate *c)
{
    return c->type == COORDINATE_ANGLE ? "rad" : "m";
}

static void pieces(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    if (!r->model->coordinates)
        return;
    table_open(out, "pieces", "Change of each coordinate since the last good configuration that makes one piece",
               "coordinate|#change|unit|#range from|#to");
    for (int w = 0; w < r->model->coordinates; ++w) {
        const Coordinate *c = &r->model->coordinate[w];
        row_open(out);
        cell(out, c->name);
        text_print(out, "<td class=\"n\">%.3g</td>", coordinate_piece(r->formulation, w));
        cell(out, unit_of(c));
        cell_number(out, c->range[0]);
        cell_number(out, c->range[1]);
        row_close(out);
    }
    table_close(out);
}

static void size_row(Text *out, const char *what, const size_t bytes[2])
{
    row_open(out);
    cell(out, what);
    cell_number(out, (double)bytes[0]);
    cell_number(out, (double)bytes[1]);
    row_close(out);
}

static void part_row(Text *out, const char *what, int numbers)
{
    size_row(out, what, (const size_t[]){(size_t)numbers * sizeof(double), (size_t)numbers * sizeof(float)});
}

static void memory(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const CodeMemory *code = r->code;
    const Plan *plan = r->formulation->plan;
    if (code->why) {
        text_print(out, "<p id=\"memory\">No sizes: ");
        text_html(out, code->why);
        text_print(out, ".</p>\n");
        return;
    }
    table_open(out, "memory", "Bytes", "what|#double|#float");
    size_row(out, "instance", code->instance);
    part_row(out, "of it starts of Newton's method, two", 2 * plan->start_size);
    part_row(out, "of it motions of the bodies", plan->motion_size);
    part_row(out, "of it inertia of the subsets", plan->inertia_size);
    size_row(out, "constants of the code, without the texts of names", code->constants);
    size_row(out, "of it numbers of the subsets", code->numbers);
    table_close(out);
}

const char *const code_function[CODE_FUNCTIONS] = {"setup", "rhs", "step", "outputs", "poses", "self_test"};

static void stack(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const CodeMemory *code = r->code;
    if (code->why)
        return;
    text_print(out, "<p>Sizes are those of the compiler <code>");
    text_html(out, code->compiler);
    text_print(out, code->stacks
                        ? "</code>.</p>\n"
                        : "</code>, which does not tell stacks; gcc does (<code>-fcallgraph-info</code>).</p>\n");
    if (!code->stacks)
        return;
    table_open(out, "stack", "Bytes of stack", "function|#double|#float");
    for (int i = 0; i < CODE_FUNCTIONS; ++i)
        size_row(out, pool_print(r->pool, "%s_%s", r->model->name, code_function[i]),
                 (const size_t[]){code->stack[0][i], code->stack[1][i]});
    table_close(out);
}

/* ---- signals ----------------------------------------------------------------------------------------------------- */

static bool law_uses(const Model *model, const Law *law, int parameter)
{
    if (!law)
        return false;
    bool uses = law->op == LAW_PARAMETER && law->index == parameter;
    if (law->op == LAW_SIGNAL)
        uses = law_uses(model, model->signal[law->index].law, parameter);
    for (int i = 0; i < 3; ++i)
        uses = uses || law_uses(model, law->arg[i], parameter);
    return uses;
}

static bool powertrain_uses(const Model *model, int parameter)
{
    const Powertrain *powertrain = model->powertrain;
    bool uses = law_uses(model, powertrain->throttle, parameter) || law_uses(model, powertrain->torque, parameter) ||
                law_uses(model, powertrain->selector, parameter);
    for (int i = 0; i < powertrain->forward - 1; ++i)
        uses = uses || law_uses(model, powertrain->up[i], parameter) || law_uses(model, powertrain->down[i], parameter);
    for (int i = 0; i < powertrain->differentials; ++i)
        uses = uses || law_uses(model, powertrain->differential[i].lock, parameter);
    return uses;
}

static bool force_uses(const Model *model, const Force *force, int parameter)
{
    const Law *const number[] = {force->stiffness, force->damping, force->free, force->low,
                                 force->high,      force->fade,    force->area, force->length};
    bool uses = false;
    for (size_t i = 0; i < sizeof number / sizeof *number; ++i)
        uses = uses || law_uses(model, number[i], parameter);
    for (size_t i = 0; i < sizeof force->law / sizeof *force->law; ++i)
        uses = uses || law_uses(model, force->law[i], parameter);
    for (int i = 0; force->bushing && i < BUSHING_NUMBERS; ++i)
        uses = uses || law_uses(model, force->bushing->stiffness[i], parameter) ||
               law_uses(model, force->bushing->damping[i], parameter);
    return uses;
}

/* Kind and name of the element that a number of the model belongs to; NULL: none. */
static const char *owner_of(const Report *r, const double *at)
{
    const Model *m = r->model;
    const struct {
        const char *kind;
        const void *first;
        int count;
        size_t size; /* size of an element, which begins with its name */
    } group[] = {{"body", m->body, m->bodies, sizeof *m->body},
                 {"body", m->drawn, m->drawn ? m->bodies : 0, sizeof *m->drawn},
                 {"joint", m->joint, m->joints, sizeof *m->joint},
                 {"coordinate", m->coordinate, m->coordinates, sizeof *m->coordinate},
                 {"force", m->force, m->forces, sizeof *m->force},
                 {"wheel", m->wheel, m->wheels, sizeof *m->wheel},
                 {"port", m->port, m->ports, sizeof *m->port},
                 {"output", m->output, m->outputs, sizeof *m->output}};
    const char *number = (const char *)at;
    for (size_t i = 0; i < sizeof group / sizeof *group; ++i)
        for (int k = 0; k < group[i].count; ++k) {
            const char *thing = (const char *)group[i].first + (size_t)k * group[i].size;
            if (number >= thing && number < thing + group[i].size)
                return pool_print(r->pool, "%s %s", group[i].kind, *(const char *const *)(const void *)thing);
        }
    return at >= m->gravity && at < m->gravity + 3 ? "gravity" : NULL;
}

/* The elements with numbers that follow a tunable parameter, each once. */
static void users_list(const Report *r, int parameter, Text *users)
{
    const Model *m = r->model;
    for (int k = 0; k < m->forces; ++k)
        if (force_uses(m, &m->force[k], parameter))
            listed(users, "force %s", m->force[k].name);
    for (int k = 0; k < m->wheels; ++k)
        if (law_uses(m, m->wheel[k].drive, parameter) || law_uses(m, m->wheel[k].brake, parameter))
            listed(users, "wheel %s", m->wheel[k].name);
    if (m->powertrain && powertrain_uses(m, parameter))
        listed(users, "the %s", "powertrain");
    const Element input = element_at(ARRAY_p, m->parameter[parameter].index);
    const char **seen = NULL;
    int owners = 0;
    for (int i = 0; m->tuning && i < m->tuning->numbers; ++i) {
        const Dag *dag = m->tuning->dag;
        const bool *needed = dag_needed(dag, &m->tuning->number[i].formula, 1);
        const char *owner = owner_of(r, m->tuning->number[i].at);
        bool uses = false;
        for (int e = 0; e < dag->nodes; ++e)
            uses = uses || (needed[e] && dag->node[e].op == OP_INPUT && element_same(*dag->node[e].element, input));
        for (int k = 0; k < owners && owner; ++k)
            uses = uses && strcmp(seen[k], owner);
        if (uses && owner)
            listed(users, "%s", *POOL_PUSH(r->pool, seen, owners) = owner);
    }
}

/* Begin a section of signals; if there are none, print that and return false. */
static bool signals_open(Text *out, int count, const char *id, const char *caption, const char *columns)
{
    if (count)
        table_open(out, id, caption, columns);
    else
        text_print(out, "<p>%s: none.</p>\n", caption);
    return count;
}

static void signal_row(Text *out, int index, const char *name, const char *unit)
{
    row_open(out);
    cell_number(out, index);
    cell(out, name);
    cell(out, unit);
}

static void states(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    int count = r->formulation->plan->states + r->model->fast_states;
    if (!signals_open(out, count, "states", "States", "#place|name|unit|#at set-up"))
        return;
    for (int i = 0; i < count; ++i) {
        const StateNumber number = state_number(r->pool, r->formulation, i);
        signal_row(out, i, number.name, number.unit);
        cell_number(out, number.initial);
        row_close(out);
    }
    table_close(out);
}

static void inputs(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Model *model = r->model;
    if (!signals_open(out, model->inputs, "inputs", "Inputs", "#place|name|unit|#default"))
        return;
    for (int i = 0; i < model->inputs; ++i) {
        signal_row(out, i, model->input[i].name, model->input[i].unit);
        cell_number(out, model->input[i].initial);
        row_close(out);
    }
    table_close(out);
}

static void parameters(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Model *model = r->model;
    if (!signals_open(out, model->tunables, "parameters", "Tunable parameters", "#place|name|unit|#default|used by"))
        return;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *p = &model->parameter[i];
        Text users = {.pool = r->pool};
        if (!p->tunable)
            continue;
        users_list(r, i, &users);
        signal_row(out, p->index, p->name, p->unit);
        cell_number(out, p->value);
        cell_list(out, &users);
        row_close(out);
    }
    table_close(out);
}

static void ports(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    const Model *model = r->model;
    if (!signals_open(out, model->ports, "ports", "Ports", "#place of force x y z (N), torque x y z (N m)|name|body"))
        return;
    for (int i = 0; i < model->ports; ++i) {
        row_open(out);
        cell_number(out, 6 * i);
        cell(out, model->port[i].name);
        cell(out, model->body[model->port[i].body].name);
        row_close(out);
    }
    table_close(out);
}

static void outputs(void *context, Text *out, int indent)
{
    const Report *r = context;
    (void)indent;
    if (!signals_open(out, r->model->outputs, "outputs", "Outputs", "#place|name|unit|type"))
        return;
    for (int i = 0, place = 0; i < r->model->outputs; ++i) {
        const Output *output = &r->model->output[i];
        for (int c = 0; c < output->count; ++c) {
            signal_row(out, place++, output->component[c], output->unit[c]);
            cell(out, output_type_name[output->type]);
            row_close(out);
        }
    }
    table_close(out);
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

static const Insertion report_point[] = {
    {"identity", identity},     {"scene", scene},   {"sequence", sequence}, {"graph", graph},
    {"operations", operations}, {"bounds", bounds}, {"totals", totals},     {"pieces", pieces},
    {"memory", memory},         {"stack", stack},   {"states", states},     {"inputs", inputs},
    {"parameters", parameters}, {"ports", ports},   {"outputs", outputs},   {NULL, NULL}};

static const Insertions report_points = {(const char *const[]){"report.html.in", NULL}, report_point, NULL};

/* A number that the code defines; 0: it does not. */
static int defined(const Report *r, const Text *c, const char *name)
{
    const char *word = pool_print(r->pool, "#define %s ", name), *at = strstr(c->s, word);
    return at ? atoi(at + strlen(word)) : 0;
}

void report_print(Text *out, const char *path, const char *templates, const Formulation *f, const Text *c,
                  const CodeMemory *code)
{
    Report r = {.pool = out->pool,
                .path = path,
                .formulation = f,
                .figures = figures_new(out->pool, f),
                .model = f->model,
                .sequence = f->sequence,
                .code = code};
    r.chords = defined(&r, c, "GIC_CHORDS");
    r.passes = defined(&r, c, "GIC_PASSES");
    r.pieces = defined(&r, c, "GIC_PIECES");
    templates_check(r.pool, templates, (const Insertions *const[]){&report_points, NULL});
    template_expand(r.pool, out, templates, "report.html.in", r.model->name, NULL, &report_points, &r);
}
