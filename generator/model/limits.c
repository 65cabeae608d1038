/* SPDX-License-Identifier: MIT
 * What the file may not say of a number holds for values of tunable parameters, too: those that set-up checks
 * (tunable.c) and those of force elements. */
#include "model/limits.h"
#include "base/table.h"
#include "model/tunable.h"

#include <math.h>
#include <string.h>

/* The laws of a limit, NULL among them. */
static int laws_of(const Limit *limit, const Law *law[BUSHING_NUMBERS])
{
    if (limit->matrix) {
        memcpy(law, limit->matrix, BUSHING_NUMBERS * sizeof *law);
        return BUSHING_NUMBERS;
    }
    law[0] = limit->law;
    law[1] = limit->less;
    return 2;
}

void limit_add(Pool *pool, Model *model, const Limit *limit)
{
    const Law *law[BUSHING_NUMBERS];
    bool tunable = false;
    for (int i = laws_of(limit, law) - 1; i >= 0; --i)
        tunable = tunable || (law[i] && law_is_tunable(law[i], model));
    if (tunable)
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

/* The pivots of the elimination must not be negative. */
bool limit_semidefinite(const double matrix[BUSHING_NUMBERS])
{
    const double least = 1e-9; /* of an element on the diagonal: numbers of a file have some digits */
    double a[BUSHING_NUMBERS], diagonal[BUSHING_AXES];
    memcpy(a, matrix, sizeof a);
    for (int i = 0; i < BUSHING_AXES; ++i)
        diagonal[i] = a[bushing_place(i, i)];
    bool good = true;
    for (int k = 0; k < BUSHING_AXES; ++k) {
        const double pivot = a[bushing_place(k, k)];
        const bool gone = pivot <= least * diagonal[k];
        good = good && pivot >= -least * diagonal[k];
        for (int i = k + 1; i < BUSHING_AXES && gone; ++i)
            good = good && fabs(a[bushing_place(i, k)]) <= sqrt(least * diagonal[i] * diagonal[k]);
        for (int i = k + 1; i < BUSHING_AXES && !gone; ++i)
            for (int j = k + 1; j <= i; ++j)
                a[bushing_place(i, j)] -= a[bushing_place(i, k)] * a[bushing_place(j, k)] / pivot;
    }
    return good;
}

/* Does a limit hold for values of the tunable parameters? number: of which it is one */
static bool limit_holds(const Limit *limit, const Model *model, const double *value, double *number)
{
    if (limit->matrix) {
        double a[BUSHING_NUMBERS];
        *number = 0;
        for (int i = 0; i < BUSHING_NUMBERS; ++i)
            a[i] = limit->matrix[i] ? number_with(limit->matrix[i], model, value) : 0;
        return limit_semidefinite(a);
    }
    *number = number_with(limit->law, model, value);
    return holds(limit->less ? *number - number_with(limit->less, model, value) : *number, limit->zero);
}

bool limit_broken(const Model *model, const double *value, BrokenLimit *broken)
{
    for (int i = 0; i < model->limits; ++i) {
        const Limit *limit = &model->limit[i];
        double number;
        if (!limit_holds(limit, model, value, &number)) {
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
    const Law *law[BUSHING_NUMBERS];
    if (!broken->limit)
        return tuned_follows(model, broken->formula, index);
    for (int i = laws_of(broken->limit, law) - 1; i >= 0; --i)
        if (law[i] && follows(law[i], model, index))
            return true;
    return false;
}
