/* SPDX-License-Identifier: MIT
 *
 * formula_output: formulas that a user asks for on a command line, as outputs of the model. */
#ifndef RUN_FORMULA_OUTPUT_H
#define RUN_FORMULA_OUTPUT_H

#include "base/pool.h"
#include "model/model.h"

/* What stands between the parentheses of NAME(...); NULL: the text is another one. */
const char *formula_inside(Pool *pool, const char *text, const char *name);

/* The model with one more output, hidden, the value of a formula of FORMAT.md section 6, which reads outputs, too.
 * option: in messages, "--gradient". Ends in diag_fail. */
Model *formula_output(Pool *pool, const Model *from, const char *option, const char *name, const char *formula);

/* Only the last `count` outputs of such a model, no longer hidden, are left, and behind them what its controllers read.
 */
void formula_alone(Pool *pool, Model *model, int count);

#endif
