/* SPDX-License-Identifier: MIT
 * The determinant that closed forms have from their roots against the product of the pivots of Newton's matrix, at all
 * configurations that pivots are chosen at. */
#include "base/pool.h"
#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What `solve` looks at last: the determinant relative to that at the design, less what a step ahead takes from it,
 * here nothing. NULL: it is the same everywhere. */
static const Check *determinant_of(const Formula *formula)
{
    const Block *solve = &formula->solve;
    const Check *last = solve->checks ? &solve->check[solve->checks - 1] : NULL;
    return last && !last->magnitude && last->status == GIC_ERROR_SINGULAR ? last : NULL;
}

/* Returns how many numbers were compared. */
static int compare(const char *path, double *smallest)
{
    /* relative: poses from both ways differ by 1e-13, and no sample is near to singular */
    const double tolerance = 1e-9;
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    const Sequence *sequence = sequence_find(pool, model);
    model = model_assemble(pool, model, sequence);
    const Formulation *closed = formulate(pool, model, sequence, SOLVE_REDUCED, RECOVERY_CLOSED);
    const Formulation *newton = formulate(pool, model, sequence, SOLVE_REDUCED, RECOVERY_NEWTON);
    assert_int_equal(closed->sequence->classes, newton->sequence->classes);
    int compared = 0, configurations = closed->sampling->configurations;
    for (int c = 0; c < closed->sequence->classes; ++c) {
        const Class *class = &closed->sequence->class[c];
        const Formula *formula = closed->plan->formula[c], *other = newton->plan->formula[c];
        const Check *check = determinant_of(formula), *other_check = determinant_of(other);
        if (!formula->closed || !check)
            continue;
        assert_non_null(other_check);
        assert_true(check->least == other_check->least);
        for (int s = 0; s < formula->dag->samples; ++s) {
            const Subset *subset = &closed->sequence->subset[class->member[s / configurations]];
            bool usable = true;
            for (int b = 0; b < subset->bodies; ++b)
                usable = usable && closed->sampling->usable[subset->body[b] * configurations + s % configurations];
            if (!usable)
                continue;
            const double value = ex_value(formula->dag, check->value, s);
            const double expected = ex_value(other->dag, other_check->value, s);
            if (!(fabs(value - expected) <= tolerance * fabs(expected)))
                fail_msg("%s: subset '%s', sample %d: %.17g, by pivots %.17g", path, class->name, s, value, expected);
            *smallest = fmin(*smallest, value);
            ++compared;
        }
    }
    pool_free(pool);
    return compared;
}

static void test_models(void **state)
{
    (void)state;
    static const char *const path[] = {"models/hmmwv.veh",          "models/hmmwv14.veh",    "models/five_link.veh",
                                       "models/quarter_car.veh",    "models/solid_axle.veh", "models/trailing_arm.veh",
                                       "tests/bench/four_alike.veh"};
    double smallest = INFINITY;
    int compared = 0;
    for (size_t i = 0; i < sizeof path / sizeof *path; ++i) {
        const int more = compare(path[i], &smallest);
        print_message("%s: %d determinants\n", path[i], more);
        compared += more;
    }
    /* they do vary: what is compared is no constant */
    assert_true(compared > 100 && smallest < 0.4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
