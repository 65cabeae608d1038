/* SPDX-License-Identifier: MIT
 * What implicit steps need of a model, with Style.implicit: room in the instance, the unknowns of their linear systems,
 * and the Jacobian. The rate of a position, or of a coordinate, is a state itself: that row of the system is solved as
 * it stands, and the position is no unknown. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "vehicle/columns.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* The state that is the rate of a state; -1: none is. */
static int rate_of(const Generation *g, int state)
{
    const Plan *plan = g->plan;
    if (g->model->free_base && state < 3)
        return 7 + plan->free_coordinates + state;
    for (int w = 0; w < g->model->coordinates; ++w)
        if (!g->model->coordinate[w].driven && plan->coordinate_state[w] == state)
            return plan->coordinate_rate[w];
    return -1;
}

/* The state whose rate is a state; -1: it is none's. */
static int position_of(const Generation *g, int state)
{
    for (int i = 0; i < states(g); ++i)
        if (rate_of(g, i) == state)
            return i;
    return -1;
}

static bool is_implicit(const Generation *g, int state)
{
    return !g->style->splitting || g->style->splitting->implicit[state];
}

/* Is a state an unknown of the linear systems? */
static bool is_unknown(const Generation *g, int state)
{
    return rate_of(g, state) < 0 && is_implicit(g, state);
}

static int unknowns(const Generation *g)
{
    int count = 0;
    for (int i = 0; i < states(g); ++i)
        count += is_unknown(g, i);
    return count;
}

/* Which states are implicit, as comments. */
static void write_splitting(const Generation *g, Text *out, int indent)
{
    const char *start = g->style->splitting->told;
    for (size_t length; *start; start += length + (start[length] == '\n')) {
        length = strcspn(start, "\n");
        line(out, indent, "/* %.*s */", (int)length, start);
    }
}

void write_implicit_sizes(Generation *whole, Text *out, int indent)
{
    Generation *g = one_by_one(whole);
    if (!g->style->implicit)
        return;
    if (g->style->splitting)
        write_splitting(g, out, indent);
    line(out, indent, "%s_IMPLICIT_UNKNOWNS = %d,", g->upper, unknowns(g));
    if (!has_tangents(g))
        line(out, indent, "%s_JACOBIAN_COLUMNS = %d, /* of implicit steps */", g->upper, jacobian_columns(g));
}

void write_implicit_members(void *context, Text *out, int indent)
{
    Generation *g = one_by_one(context);
    if (!g->style->implicit)
        return;
    const RateColumns *weighed = weighed_columns(g);
    line(out, 0, "#define %s_IMPLICIT 1 /* for code of many vehicles */", g->upper);
    line(out, indent, "gic_implicit_head implicit; /* of implicit steps: .keep is for the caller */");
    line(out, indent, "gic_real implicit_number[GIC_IMPLICIT(%s_STATE_ROOM, %d) + %d%s];", g->upper,
         jacobian_columns(g), weighed ? weighed->masses : 0, is_spread(g) ? spread_numbers(g) : "");
    line(out, indent, "int32_t implicit_pivot[%s];", /* C has no empty arrays */
         unknowns(g) ? pool_print(g->pool, "%s_IMPLICIT_UNKNOWNS", g->upper) : "1");
}

void write_exponential_member(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->style->exponential)
        line(out, indent, "gic_real exponential[GIC_EXPONENTIAL(%s_STATE_ROOM)];", g->upper);
}

int implicit_unknowns(const Generation *g, int **unknown, int **position)
{
    int count = 0;
    *unknown = pool_alloc(g->pool, ((size_t)states(g) + 1) * sizeof **unknown);
    *position = pool_alloc(g->pool, ((size_t)states(g) + 1) * sizeof **position);
    for (int i = 0; i < states(g); ++i)
        if (is_unknown(g, i)) {
            (*unknown)[count] = i;
            (*position)[count++] = position_of(g, i);
        }
    return count;
}

static void write_implicit_factors(void *context, Text *out, int indent)
{
    Generation *g = context;
    int *unknown, *position;
    (void)implicit_unknowns(g, &unknown, &position);
    write_elimination_factors(g, out, indent, unknowns(g), unknown, position);
}

static void write_implicit_solution(void *context, Text *out, int indent)
{
    Generation *g = context;
    int *unknown, *position;
    (void)implicit_unknowns(g, &unknown, &position);
    write_elimination_solution(g, out, indent, unknowns(g), unknown, position);
    for (int i = 0; i < states(g); ++i)
        if (!is_implicit(g, i))
            line(out, indent, "u[%d] = b[%d]; /* explicit: %s */", i, i, state_number(g->pool, g->formulation, i).name);
}

bool implicit_is_short(Generation *g)
{
    int *unknown, *position;
    if (g->style->exact)
        return false;
    (void)implicit_unknowns(g, &unknown, &position);
    return unknowns(g) > 0 && elimination_is_short(g, unknowns(g), unknown, position);
}

static void write_elimination(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (implicit_is_short(g))
        template_expand(g->pool, out, g->templates,
                        is_spread(g) ? "implicit_eliminate_spread.c.in" : "implicit_eliminate.c.in", g->model->name,
                        NULL, &implicit_points, g);
}

static void write_functions(void *context, Text *out, int indent)
{
    Generation *g = context;
    const bool own = implicit_is_short(g);
    line(out, indent, "%s,", own ? pool_print(g->pool, "%s_factorize", g->model->name) : "NULL");
    line(out, indent, "%s,", own ? pool_print(g->pool, "%s_solve", g->model->name) : "NULL");
}

static void write_unknowns(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < states(g); ++i)
        if (is_unknown(g, i))
            line(out, indent, "%d, /* %s */", i, state_number(g->pool, g->formulation, i).name);
    if (unknowns(g) == 0)
        line(out, indent, "0, /* none */");
}

static void write_positions(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < states(g); ++i)
        if (is_unknown(g, i))
            line(out, indent, "%d,", position_of(g, i));
    if (unknowns(g) == 0)
        line(out, indent, "0,");
}

static void write_jacobian_call(void *context, Text *out, int indent)
{
    Generation *g = context;
    const char *name = g->model->name;
    if (weighed_columns(g))
        line(out, indent, "return %s_forces_at_once((%s *)self, time, state, jacobian);", name, name);
    else
        line(out, indent, "%s_direction along; /* work space */", name);
    if (!weighed_columns(g))
        line(out, indent,
             "return %s_tangent_columns((%s *)self, time, state, &along, %s_STATES, %s_STATES + %s_INPUTS, "
             "jacobian);",
             name, name, g->upper, g->upper, g->upper);
}

static void write_weighed(void *context, Text *out, int indent)
{
    (void)indent;
    if (weighed_columns(context))
        write_weighed_columns(context, out);
}

static void write_mass_tables(void *context, Text *out, int indent)
{
    Generation *g = context;
    const RateColumns *weighed = weighed_columns(g);
    if (weighed)
        line(out, indent, "%s_MASSES, %s_mass_row, %s_mass_column,", g->upper, g->model->name, g->model->name);
    else
        line(out, indent, "0, NULL, NULL,");
    if (is_spread(g))
        line(out, indent, "(int)%s_SHARES + (int)%s_FACTORS, %s_share_work, %s_any_share,", g->model->name,
             g->model->name, g->model->name, g->model->name);
    else
        line(out, indent, "0, NULL, NULL,");
}

static void write_exponential(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, g->style->exponential ? "offsetof(%s, exponential)," : "0,", g->model->name);
}

static void write_share(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (is_spread(g))
        template_expand(g->pool, out, g->templates, "implicit_share.c.in", g->model->name, NULL, &implicit_points, g);
}

static const Insertion implicit_point[] = {{"implicit weighed", write_weighed},
                                           {"implicit masses", write_mass_tables},
                                           {"implicit exponential", write_exponential},
                                           {"implicit jacobian", write_jacobian_call},
                                           {"implicit elimination", write_elimination},
                                           {"implicit functions", write_functions},
                                           {"implicit factors", write_implicit_factors},
                                           {"implicit factor shares", write_factor_shares},
                                           {"implicit factor table", write_factor_table},
                                           {"implicit shares", write_share_work_table},
                                           {"implicit share", write_share},
                                           {"implicit solution", write_implicit_solution},
                                           {"implicit unknowns", write_unknowns},
                                           {"implicit positions", write_positions},
                                           {NULL, NULL}};

const Insertions implicit_points = {(const char *const[]){"implicit.c.in", "implicit_eliminate.c.in",
                                                          "implicit_eliminate_spread.c.in", "implicit_share.c.in",
                                                          NULL},
                                    implicit_point, NULL};

void write_implicit_code(Generation *g, Text *out)
{
    if (g->style->implicit)
        template_expand(g->pool, out, g->templates, "implicit.c.in", g->model->name, NULL, &implicit_points, g);
}

void write_implicit(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent, "%s,", g->style->implicit ? pool_print(g->pool, "&%s_implicit", g->model->name) : "NULL");
}
