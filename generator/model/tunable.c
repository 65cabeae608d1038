/* SPDX-License-Identifier: MIT
 * Numbers that follow tunable parameters: their formulas, found by the numbers' addresses in the model. */
#include "base/table.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

Tuning *tuning_new(Pool *pool)
{
    Tuning *tuning = pool_alloc(pool, sizeof *tuning);
    tuning->dag = dag_new(pool, 1, 1);
    return tuning;
}

Ex tuned_number(const Model *model, const double *at)
{
    for (int i = 0; model->tuning && i < model->tuning->numbers; ++i)
        if (model->tuning->number[i].at == at)
            return model->tuning->number[i].formula;
    return 0;
}

Ex tuned_or_fixed(const Model *model, const double *at)
{
    Ex formula = tuned_number(model, at);
    return formula ? formula : ex_literal(model->tuning->dag, *at);
}

Ex tuned_difference(const Model *model, const double *a, const double *b)
{
    if (!tuned_number(model, a) && !tuned_number(model, b))
        return 0;
    Dag *dag = model->tuning->dag;
    Ex difference = ex_sub(dag, tuned_or_fixed(model, a), tuned_or_fixed(model, b));
    return dag->node[difference].level == LEVEL_VARIABLE ? difference : 0;
}

void tuning_set(Tuning *tuning, const double *at, const Ex *formula, int count)
{
    for (int i = 0; i < count; ++i) {
        int k = 0;
        if (tuning->dag->node[formula[i]].level != LEVEL_VARIABLE)
            continue;
        while (k < tuning->numbers && tuning->number[k].at != at + i)
            ++k;
        TunedNumber *number =
            k < tuning->numbers ? &tuning->number[k] : POOL_PUSH(tuning->dag->pool, tuning->number, tuning->numbers);
        *number = (TunedNumber){at + i, formula[i]};
    }
}

void tuning_drop(Tuning *tuning, const double *at, int count)
{
    int left = 0;
    for (int i = 0; i < tuning->numbers; ++i) {
        const uintptr_t place = (uintptr_t)tuning->number[i].at, first = (uintptr_t)at;
        if (place < first || place >= first + (size_t)count * sizeof *at)
            tuning->number[left++] = tuning->number[i];
    }
    tuning->numbers = left;
}

void tuning_copy(const Model *model, const double *to, const double *from, int count)
{
    for (int i = 0; i < count; ++i) {
        Ex formula = tuned_number(model, from + i);
        if (formula)
            tuning_set(model->tuning, to + i, &formula, 1);
    }
}

void tuning_copy_all(const Model *model, const void *to, const void *from, size_t bytes)
{
    const int numbers = model->tuning ? model->tuning->numbers : 0; /* copies add to them */
    for (int i = 0; i < numbers; ++i) {
        const TunedNumber number = model->tuning->number[i];
        const uintptr_t at = (uintptr_t)number.at, first = (uintptr_t)from;
        if (at >= first && at < first + bytes)
            tuning_set(model->tuning, (const double *)(const void *)((const char *)to + (at - first)), &number.formula,
                       1);
    }
}

void output_copy(const Model *model, Output *to, const Output *from)
{
    *to = *from;
    if (model->tuning)
        tuning_copy(model, to->point, from->point, 3);
}

void tuning_require(Tuning *tuning, Ex value, bool zero, const char *text)
{
    if (tuning->dag->node[value].level == LEVEL_VARIABLE)
        *POOL_PUSH(tuning->dag->pool, tuning->condition, tuning->conditions) = (Condition){value, zero, text};
}

double tuned_value(const Model *model, Ex formula, const double *parameter)
{
    const Dag *dag = model->tuning->dag;
    const bool *needed = dag_needed(dag, &formula, 1);
    double *value = pool_alloc(dag->pool, sizeof *value * ((size_t)formula + 1));
    for (Ex e = 0; e <= formula; ++e) {
        const Node *node = &dag->node[e];
        value[e] = 0;
        if (!needed[e])
            continue;
        if (node->op == OP_INPUT)
            value[e] = node->element->array == ARRAY_p ? parameter[node->element->index] : 0; /* `rest` */
        else if (node->level == LEVEL_LITERAL)
            value[e] = ex_value(dag, e, 0);
        else if (node->op == OP_TABLE)
            value[e] = table_value(&model->table[node->arg[1]], value[node->arg[0]]);
        else
            value[e] = op_value((Op)node->op, value[node->arg[0]], value[node->arg[1]], value[node->arg[2]]);
    }
    return value[formula];
}

bool tuned_follows(const Model *model, Ex formula, int index)
{
    const Dag *dag = model->tuning->dag;
    const bool *needed = dag_needed(dag, &formula, 1);
    for (Ex e = 0; e <= formula; ++e)
        if (needed[e] && dag->node[e].op == OP_INPUT && dag->node[e].element->array == ARRAY_p &&
            dag->node[e].element->index == index)
            return true;
    return false;
}

static const char *const late_text[LATE_CONDITIONS] = {
    [LATE_MASSES] = "in the augmented form of the equations of motion no body may have more than 1e9 times the mass of "
                    "another",
    [LATE_MODE] = "closed forms find the mechanism in another assembly mode than the drawing with these values; write "
                  "the values into the file",
};

void tuning_close(Model *model)
{
    Tuning *tuning = model->tuning;
    Dag *dag = tuning->dag;
    bool any = false;
    int roots = 0;
    dag->tables = model->table;
    Ex *root = pool_alloc(dag->pool, (size_t)(tuning->numbers + tuning->conditions + 1) * sizeof *root);
    for (int i = 0; i < tuning->numbers; ++i)
        root[roots++] = tuning->number[i].formula;
    for (int i = 0; i < tuning->conditions; ++i)
        root[roots++] = tuning->condition[i].value;
    const bool *needed = dag_needed(dag, root, roots);
    for (int e = 0; e < dag->nodes; ++e) {
        if (!needed[e] || dag->node[e].op != OP_INPUT)
            continue;
        if (dag->node[e].element->array == ARRAY_rest) {
            tuning->assembles = true;
            continue;
        }
        for (int i = 0; i < model->parameters; ++i)
            if (model->parameter[i].tunable && dag->node[e].element->index == model->parameter[i].index)
                any = model->parameter[i].geometric = true;
    }
    tuning->late = tuning->conditions;
    for (int i = 0; i < LATE_CONDITIONS; ++i)
        *POOL_PUSH(dag->pool, tuning->condition, tuning->conditions) =
            (Condition){ex_literal(dag, 1), false, late_text[i]};
    if (!any)
        model->tuning = NULL;
}
