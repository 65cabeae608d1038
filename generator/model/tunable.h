/* SPDX-License-Identifier: MIT
 *
 * Numbers of a model that follow tunable parameters, and its formulas, as expressions. */
#ifndef MODEL_TUNABLE_H
#define MODEL_TUNABLE_H

#include "expression/expression.h"
#include "model/model.h"

/* ---- law.c: formulas as expressions */

/* A law as an expression; tunable parameters are p[i]. The first form takes a law of numbers, parameters and tables;
 * the second makes the operation at the top of a law (not an input, coordinate, time or local name) with these
 * arguments. */
Ex law_expression(Dag *dag, const Model *model, const Law *law);
Ex law_top(Dag *dag, const Model *model, const Law *law, const Ex arg[3]);

/* ---- tunable.c: numbers that follow tunable parameters */

/* A number that must be greater than 0 (`zero`: at least 0) for all values of the parameters. */
typedef struct Condition {
    Ex value;
    bool zero;
    const char *text; /* "mass of body 'arm' must be greater than zero" */
} Condition;

typedef struct TunedNumber {
    const double *at;
    Ex formula;
} TunedNumber;

/* A Model has its numbers for the parameter values of the file. For other values set-up evaluates these formulas, which
 * are nodes of a graph of their own, found by the address of the number in the Model. Inputs of the graph: p[i], the
 * tunable parameters; `rest`, the remaining share of the way from the drawing to the given lengths. */
typedef struct Tuning {
    Dag *dag;
    int numbers, conditions;
    int late; /* conditions from this one on are checked by blocks of emitted code: on masses, on the assembly mode */
    TunedNumber *number;
    Condition *condition;
    bool assembles; /* some length differs from the drawing's: formulas depend on `rest` */
} Tuning;

/* Conditions from Tuning.late on. Their formula is the literal 1, since numbers alone do not decide them. */
enum { LATE_MASSES, LATE_MODE, LATE_CONDITIONS };

Tuning *tuning_new(Pool *pool);
/* The formula of a number of the model; 0 if it follows no parameter. The second function returns a literal in place of
 * 0. */
Ex tuned_number(const Model *model, const double *at);
Ex tuned_or_fixed(const Model *model, const double *at);
/* The formula of the difference of the numbers at a and b; 0 if it follows no parameter. */
Ex tuned_difference(const Model *model, const double *a, const double *b);
/* Set the formulas of `count` numbers, replacing earlier ones, but for formulas that are 0 or a literal. */
void tuning_set(Tuning *tuning, const double *at, const Ex *formula, int count);
/* `count` numbers follow no parameter any more. */
void tuning_drop(Tuning *tuning, const double *at, int count);
/* Give `count` copies of numbers the formulas of the originals. */
void tuning_copy(const Model *model, const double *to, const double *from, int count);
/* The same for all numbers in a copy of `bytes` of the model. */
void tuning_copy_all(const Model *model, const void *to, const void *from, size_t bytes);
/* Copy an output of the model with the formulas of its point. */
void output_copy(const Model *model, Output *to, const Output *from);
void tuning_require(Tuning *tuning, Ex value, bool zero, const char *text);
/* The value of a formula of the model's Tuning for values of its tunable parameters, at the given lengths; and whether
 * it follows the one with this index. */
double tuned_value(const Model *model, Ex formula, const double *parameter);
bool tuned_follows(const Model *model, Ex formula, int index);
/* Call after reading: determines which parameters are geometric. A model without geometric ones gets no tuning. */
void tuning_close(Model *model);

/* Numbers that emitted code keeps in derived[], as formulas of a Tuning: geometric parameters first. */
typedef struct Derived {
    int count;
    Ex *formula;
} Derived;

#endif
