/* SPDX-License-Identifier: MIT
 * The results of a subset's solution with balanced sums, in all that refers to them. */
#include "expression/expression.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

static void replace_all(const Ex *image, Ex *e, int count)
{
    for (int i = 0; i < count; ++i)
        e[i] = image[e[i]];
}

static void replace_images(Pool *pool, const Ex *image, Motion *motion)
{
    Image *own = pool_alloc(pool, ((size_t)motion->images + 1) * sizeof *own);
    for (int i = 0; i < motion->images; ++i) {
        own[i] = motion->image[i];
        replace_all(image, own[i].v, 3);
    }
    motion->image = own;
}

void formula_balance(Work *w, Formula *formula)
{
    Block *solve = &formula->solve;
    const Layout *layout = &formula->layout;
    Ex *root = pool_alloc(w->pool, (size_t)(solve->stores + solve->checks + 1) * sizeof *root);
    for (int i = 0; i < solve->stores; ++i)
        root[i] = solve->store[i].value;
    for (int i = 0; i < solve->checks; ++i)
        root[solve->stores + i] = solve->check[i].value;
    const int nodes = w->dag->nodes;
    const Ex *image = balance_sums(w->pool, w->dag, root, solve->stores + solve->checks);
    for (int i = 0; i < solve->stores; ++i)
        solve->store[i].value = image[solve->store[i].value];
    for (int i = 0; i < solve->checks; ++i)
        solve->check[i].value = image[solve->check[i].value];
    for (int b = 0; b < layout->bodies; ++b) {
        for (int i = 0; i < MOTION_S + 6 * layout->deps; ++i)
            replace_all(image, motion_number(&formula->motion[b], i), 1);
        replace_images(w->pool, image, &formula->motion[b]);
    }
    replace_all(image, formula->inertia, layout->inertia_size);
    replace_all(image, (Ex *)formula->body, layout->bodies * (int)(sizeof *formula->body / sizeof(Ex)));
    formula->balanced = image;
    formula->unbalanced = nodes;
}
