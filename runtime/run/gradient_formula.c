/* SPDX-License-Identifier: MIT
 * The formula of --gradient as the only output of a model. */
#include "base/pool.h"
#include "run/condition_output.h"
#include "run/formula_output.h"
#include "run/gradient.h"

Scalar scalar_read(Pool *pool, const Model *from, const Scene *scene, const char *text)
{
    const char *integral = formula_inside(pool, text, "integral"), *maximum = formula_inside(pool, text, "maximum");
    const char *formula = integral ? integral : maximum ? maximum : text;
    Model *model = formula_output(pool, from, "--gradient", "gradient", formula);
    model = condition_outputs(pool, model, scene);
    formula_alone(pool, model, 1 + 2 * condition_count(scene));
    return (Scalar){integral ? SCALAR_INTEGRAL : maximum ? SCALAR_MAXIMUM : SCALAR_END, model};
}
