/* SPDX-License-Identifier: MIT
 * The formula of --gradient as the only output of a model. */
#include "base/pool.h"
#include "run/formula_output.h"
#include "run/gradient.h"

Scalar scalar_read(Pool *pool, const Model *from, const char *text)
{
    const char *integral = formula_inside(pool, text, "integral"), *maximum = formula_inside(pool, text, "maximum");
    const char *formula = integral ? integral : maximum ? maximum : text;
    Model *model = formula_output(pool, from, "--gradient", "gradient", formula);
    formula_alone(pool, model, 1);
    return (Scalar){integral ? SCALAR_INTEGRAL : maximum ? SCALAR_MAXIMUM : SCALAR_END, model};
}
