/* SPDX-License-Identifier: MIT
 * What a block of vehicles holds of each of them beside states, inputs and the like, and all of it on the way between a
 * lane of the block and a vehicle of its own. */
#include "base/text.h"
#include "emit/batch_private.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "vehicle/vehicle.h"

#include <string.h>

void write_batch_members(const Generation *g, Text *out, int indent)
{
    const char *name = g->model->name, *upper = g->upper;
    if (g->formulation->wheels) {
        line(out, indent, "%s_lane mean[%s_STATES - %s_SLOW]; /* of the rates of the fast states, of steady steps */",
             name, upper, upper);
        line(out, indent, "%s_lane link[3 * %s_LINKS]; /* what moves the fast states, at the last three slow steps */",
             name, upper);
    }
    if (wheels_roll(g))
        line(out, indent, "%s_lane grip[%s_GRIP * %s_ROLLING]; /* what the wheels do */", name, upper, upper);
    if (g->model->powertrain)
        line(out, indent, "%s_lane watch[%d]; /* of the powertrain */", name, WATCH_NUMBERS);
    if (g->formulation->contacts)
        line(out, indent, "%s_lane touch[2 * %s_CONTACTS]; /* how near contacts were */", name, upper);
    line(out, indent, "%s_lane recovered_at[2 * %s_COORDINATE_ROOM + 4]; /* where the recovery in `work` was */", name,
         upper);
    line(out, indent, "%s_mask recovered; /* lanes in which there is one */", name);
}

/* An array of a block and of one vehicle, and how many numbers it has. */
typedef struct Exchange {
    bool used;
    const char *block, *one, *size;
} Exchange;

static void write_arrays_exchange(const Exchange *array, int count, Text *out, int indent, bool load)
{
    for (const Exchange *a = array; a < array + count; ++a) {
        if (!a->used)
            continue;
        line(out, indent, "for (i = 0; i < %s; ++i)", a->size);
        if (load)
            line(out, indent + 4, "block->%s[i][l] = one->%s;", a->block, a->one);
        else
            line(out, indent + 4, "one->%s = block->%s[i][l];", a->one, a->block);
    }
}

static void write_more(const Generation *g, Text *out, int indent, bool load)
{
    const char *upper = g->upper;
    const bool fast = g->formulation->wheels;
    Pool *const pool = g->pool;
    const Exchange always[] = {
        {fast, "mean", pool_print(pool, "history[2 * %s_STATES + i]", upper),
         pool_print(pool, "%s_STATES - %s_SLOW", upper, upper)},
        {g->model->powertrain, "watch", "watch[i]", pool_print(pool, "%d", WATCH_NUMBERS)},
        {fast, "link", "link[i]", pool_print(pool, "3 * %s_LINKS", upper)},
        {wheels_roll(g), "grip", "grip[i]", pool_print(pool, "%s_GRIP * %s_ROLLING", upper, upper)},
        {g->formulation->contacts, "touch", "touch[i]", pool_print(pool, "2 * %s_CONTACTS", upper)}};
    const Exchange recovered[] = {
        {true, "recovered_at", "recovered_at[i]", pool_print(pool, "4 + 2 * %s_COORDINATE_ROOM", upper)},
        {true, "work.x", "x[i]", pool_print(pool, "%s_COORDINATES", upper)},
        {true, "work.xd", "xd[i]", pool_print(pool, "%s_COORDINATES", upper)},
        {true, "work.motion", "motion[i]", pool_print(pool, "%s_MOTION_ROOM", upper)},
        {true, "work.inertia", "inertia[i]", pool_print(pool, "%s_INERTIA_ROOM", upper)},
        {true, "work.multiplier", "multiplier[i]", pool_print(pool, "%s_MULTIPLIER_ROOM", upper)}};
    write_arrays_exchange(always, sizeof always / sizeof *always, out, indent, load);
    if (load)
        line(out, indent, "block->recovered[l] = -(one->recovered == 1 + one->head.flip);");
    else
        line(out, indent, "one->recovered = block->recovered[l] != 0;");
    line(out, indent, load ? "if (block->recovered[l]) {" : "if (one->recovered) {");
    write_arrays_exchange(recovered, sizeof recovered / sizeof *recovered, out, indent + 4, load);
    line(out, indent, "}");
}

void write_batch_exchange(const Generation *g, Text *out, int indent, bool load)
{
    static const struct {
        const char *member, *count;
    } array[] = {{"state", "STATES"}, {"input", "INPUTS"}, {"output", "OUTPUTS"},  {"parameter", "PARAMETERS"},
                 {"port", "PORTS"},   {"rate", "STATES"},  {"history", "HISTORY"}, {"derived", "DERIVED"}};
    for (size_t a = 0; a < sizeof array / sizeof *array; ++a) {
        const char *member = array[a].member;
        if (!strcmp(member, "derived") && !g->model->tuning)
            continue;
        if (!strcmp(member, "history"))
            line(out, indent, "for (i = 0; i < 2 * %s_STATES; ++i)", g->upper);
        else
            line(out, indent, "for (i = 0; i < %s_%s; ++i)", g->upper, array[a].count);
        if (load)
            line(out, indent + 4, "block->%s[i][l] = one->%s[i];", member, member);
        else
            line(out, indent + 4, "one->%s[i] = block->%s[i][l];", member, member);
    }
    line(out, indent, "for (i = 0; i < %s_DISCRETES; ++i)", g->upper);
    if (load)
        line(out, indent + 4, "block->discrete[i][l] = one->discrete[i];");
    else
        line(out, indent + 4, "one->discrete[i] = (int32_t)block->discrete[i][l];");
    write_more(g, out, indent, load);
}
