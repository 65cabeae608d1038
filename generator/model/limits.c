/* SPDX-License-Identifier: MIT
 * What the file may not say of a number holds for values of tunable parameters, too: those that set-up checks
 * (tunable.c) and those of force elements. */
#include "model/limits.h"
#include "base/table.h"
#include "model/tunable.h"

#include <math.h>

void limit_add(Pool *pool, Model *model, const Limit *limit)
{
    if (law_is_tunable(limit->law, model) || (limit->less && law_is_tunable(limit->less, model)))
        *POOL_PUSH(pool, model->limit, model->limits) = *limit;
}

/* The number of a law for values of the tunable parameters. */
static double number_with(const Law *law, const Model *model, const double *value)
{
    double x[3] = {0};
    if (law->op == LAW_PARAMETER) {
        const Parameter *parameter = &model->parameter[law->index];
        return parameter->tunable ? value[parameter->index]
               : parameter->law   ? number_with(parameter->law, model, value)
                                  : parameter->value;
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        x[i] = number_with(law->arg[i], model, value);
    if (law->op == LAW_NUMBER) {
        const Ex formula = model->tuning ? tuned_number(model, &law->number) : 0;
        return formula ? tuned_value(model, formula, value) : law->number;
    }
    return law->op == LAW_TABLE  ? table_value(&model->table[law->index], x[0])
           : law->op == LAW_CALL ? op_value((Op)law->call, x[0], x[1], x[2])
                                 : law_number(law, model);
}

/* Does a law follow the tunable parameter with this index? */
static bool follows(const Law *law, const Model *model, int index)
{
    if (law->op == LAW_PARAMETER) {
        const Parameter *parameter = &model->parameter[law->index];
        return parameter->tunable ? parameter->index == index : parameter->law && follows(parameter->law, model, index);
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        if (follows(law->arg[i], model, index))
            return true;
    return false;
}

/* Is a number within its limit? NaN is not. */
static bool holds(double number, bool zero)
{
    return isfinite(number) && (zero ? number >= 0 : number > 0);
}

bool limit_broken(const Model *model, const double *value, BrokenLimit *broken)
{
    for (int i = 0; i < model->limits; ++i) {
        const Limit *limit = &model->limit[i];
        const double number = number_with(limit->law, model, value);
        if (!holds(limit->less ? number - number_with(limit->less, model, value) : number, limit->zero)) {
            *broken = (BrokenLimit){limit->text, limit, 0, number};
            return true;
        }
    }
    const Tuning *tuning = model->tuning;
    for (int i = 0; tuning && i < tuning->late; ++i) {
        const Condition *condition = &tuning->condition[i];
        const double number = tuned_value(model, condition->value, value);
        if (!holds(number, condition->zero)) {
            *broken = (BrokenLimit){condition->text, NULL, condition->value, number};
            return true;
        }
    }
    return false;
}

bool limit_follows(const Model *model, const BrokenLimit *broken, int index)
{
    const Limit *limit = broken->limit;
    return limit ? follows(limit->law, model, index) || (limit->less && follows(limit->less, model, index))
                 : tuned_follows(model, broken->formula, index);
}
