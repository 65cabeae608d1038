/* SPDX-License-Identifier: MIT
 * Errors planted in what blocks store. */
#include "base/plant.h"
#include "expression/expression.h"
#include "subset/subset.h"
#include "sequence/sequence.h"
#include "vehicle/plant_stores.h"
#include "vehicle/vehicle.h"

#include <stdio.h>
#include <string.h>

#ifdef GICGEN_PLANT

/* array[7], by its name in C. */
static const char *target_text(const Block *block, int store)
{
    static const char *const text[] = {
#define ARRAY_TEXT(name, text, what) text,
        ARRAY_LIST(ARRAY_TEXT)
#undef ARRAY_TEXT
    };
    const Element *target = &block->store[store].target;
    if (target->array == ARRAY_known || target->array == ARRAY_onto)
        return pool_print(block->dag->pool, "%s%d[%d]", text[target->array], target->which, target->index);
    return pool_print(block->dag->pool, "%s[%d]", text[target->array], target->index);
}

/* Make the chosen store of a block too large by a thousandth of itself and a thousandth of its unit. */
static void plant_block(const char *form, const char *name, const Block *block)
{
    const char *asked = what_is_planted();
    const size_t prefix = strlen(form) + strlen(name) + 2;
    for (int i = 0; block && i < block->stores && planted("list"); ++i)
        printf("%s:%s:%s\n", form, name, target_text(block, i));
    if (!block || strncmp(asked, form, strlen(form)) || strlen(asked) <= prefix || asked[strlen(form)] != ':' ||
        strncmp(asked + strlen(form) + 1, name, strlen(name)) || asked[prefix - 1] != ':')
        return;
    for (int i = 0; i < block->stores; ++i)
        if (!strcmp(target_text(block, i), asked + prefix)) {
            const Ex larger = ex_mul(block->dag, ex_literal(block->dag, 1.001), block->store[i].value);
            block->store[i].value = ex_add(block->dag, larger, ex_literal(block->dag, 0.001));
        }
}

void plant_stores(const Formulation *f, const char *form)
{
    plant_block(form, "dynamics", f->dynamics);
    plant_block(form, "outputs", f->outputs);
    plant_block(form, "poses", f->poses);
    plant_block(form, "inverse", f->inverse);
    plant_block(form, "wrenches", f->wrenches);
    plant_block(form, "energy", f->energy);
    for (int c = 0; c < f->sequence->classes; ++c) {
        const Formula *formula = f->plan->formula[c];
        plant_block(form, "solve", &formula->solve);
        plant_block(form, "predict", &formula->predict);
        plant_block(form, "chord", &formula->chord);
        plant_block(form, "react", &formula->react);
    }
    if (!f->wheels)
        return;
    plant_block(form, "link", &f->wheels->link);
    plant_block(form, "torque", &f->wheels->torque);
    plant_block(form, "drive", f->model->powertrain ? &f->wheels->drive : NULL);
    plant_block(form, "shift", f->model->powertrain ? &f->wheels->shift : NULL);
    for (int c = 0; c < f->wheels->classes; ++c) {
        plant_block(form, "contact", &f->wheels->class[c].contact);
        plant_block(form, "tire", &f->wheels->class[c].tire);
        plant_block(form, "balance", &f->wheels->class[c].balance);
    }
}

#else
typedef int plant_stores_is_empty;
#endif
