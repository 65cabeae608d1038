/* SPDX-License-Identifier: MIT
 * Equations of gears and couplers as functions of q alone: see coupled.h. */
#include "compare/coupled.h"

#include <string.h>

static bool follows(const World *world, const CoupledRow *row, int coordinate)
{
    return !world->model->coordinate[coordinate].driven && law_follows(world->tie[row->tie].law, coordinate);
}

static int place_of(const CoupledRow *row, int body)
{
    int i = 0;
    while (i < row->bodies && row->body[i] != body)
        ++i;
    return i;
}

static void add_bodies(Pool *pool, CoupledRow *row, const int body[2])
{
    for (int end = 0; end < 2; ++end)
        if (place_of(row, body[end]) == row->bodies)
            *POOL_PUSH(pool, row->body, row->bodies) = body[end];
}

CoupledRows coupled_rows_new(Pool *pool, const World *world)
{
    CoupledRows rows = {0, NULL};
    for (int t = 0; t < world->constraints; ++t) {
        if (!world->tie[t].law)
            continue;
        CoupledRow *row = POOL_PUSH(pool, rows.row, rows.rows);
        *row = (CoupledRow){.tie = t};
        add_bodies(pool, row, world->tie[t].body);
        for (int c = 0; c < world->model->coordinates; ++c)
            if (follows(world, row, c))
                add_bodies(pool, row, world->model->coordinate[c].body);
        row->J = pool_alloc(pool, (size_t)row->bodies * sizeof *row->J);
    }
    return rows;
}

void coupled_rows_place(const CoupledRows *rows, World *world, const double *near)
{
    for (int c = 0; c < world->model->coordinates; ++c) {
        bool any = false;
        for (int i = 0; i < rows->rows; ++i)
            any = any || follows(world, &rows->row[i], c);
        if (!any)
            continue;
        double w[2];
        world_coordinate(world, c, near[c], w);
        world->x[c] = w[0];
        world->xd[c] = w[1];
    }
}

static void add(const World *world, CoupledRow *row, int tie, double factor)
{
    const double *J = world->J + ROW_J * world->tie[tie].first;
    for (int end = 0; end < 2; ++end, J += BODY_Q) {
        double *to = row->J[place_of(row, world->tie[tie].body[end])];
        for (int i = 0; i < BODY_Q; ++i)
            to[i] += factor * J[i];
    }
}

void coupled_rows_differentiate(const CoupledRows *rows, const World *world)
{
    double way[world->model->coordinates + 1];
    memset(way, 0, sizeof way);
    for (int i = 0; i < rows->rows; ++i) {
        CoupledRow *row = &rows->row[i];
        memset(row->J, 0, (size_t)row->bodies * sizeof *row->J);
        add(world, row, row->tie, 1);
        for (int c = 0; c < world->model->coordinates; ++c) {
            if (!follows(world, row, c))
                continue;
            way[c] = 1; /* J_w q' + dual w' = 0 */
            add(world, row, world->coordinate_tie[c], -world_dual(world, row->tie, way) / world->dual[c]);
            way[c] = 0;
        }
    }
}
