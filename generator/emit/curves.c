/* SPDX-License-Identifier: MIT
 * Functions of one number by table: PREFIX_curve_0 and on, of the tires. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/curve.h"
#include "vehicle/vehicle.h"

static const char *name_of(Pool *pool, const Curve *curve, const char *sine, const char *cosine, const char *arc)
{
    if (curve->kind == CURVE_ATAN || curve->kind == CURVE_TAN)
        return pool_print(pool, "%s(x)", curve->kind == CURVE_ATAN ? arc : "GIC_TAN");
    const char *function = curve->kind == CURVE_SINE ? sine : cosine;
    if (curve->factor == 1)
        return pool_print(pool, "%s(%s(x))", function, arc);
    return pool_print(pool, "%s(%s * %s(x))", function, emit_number(pool, curve->factor), arc);
}

static void write_curves(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Curves *curves = g->formulation->wheels->curves;
    for (int i = 0; i < curves->count; ++i) {
        const Curve *curve = &curves->curve[i];
        if (curve_is_short(curve))
            continue;
        const char *model = g->model->name, *exact = name_of(g->pool, curve, "GIC_SIN", "GIC_COS", "GIC_ATAN");
        line(out, indent, "static const gic_real %s_curve_%d_cell[%d][%d] = {", model, i, curve->cells, CURVE_NUMBERS);
        for (int c = 0; c < curve->cells; ++c) {
            text_print(out, "%*s{", indent + 4, "");
            for (int k = 0; k < CURVE_NUMBERS; ++k)
                text_print(out, "%s%s", k ? ", " : "", emit_number(g->pool, curve->cell[c][k]));
            text_print(out, "},\n");
        }
        line(out, indent, "};\n");
        line(out, indent, "/* %s within %.1e up to |x| = %g; beyond, the function itself. */", exact, curve->error,
             curve_end(curve));
        line(out, indent, "static gic_real %s_curve_%d(gic_real x)", model, i);
        line(out, indent, "{");
        line(out, indent + 4, "const gic_real a = GIC_FABS(x);");
        line(out, indent + 4, "if (!(a < %s))", emit_number(g->pool, curve_end(curve)));
        line(out, indent + 8, "return %s;", exact);
        if (curve->kind == CURVE_COSINE) {
            line(out, indent + 4, "return %s_curve(%s_curve_%d_cell, a);", model, model, i);
        } else {
            line(out, indent + 4, "const gic_real value = %s_curve(%s_curve_%d_cell, a);", model, model, i);
            line(out, indent + 4, "return x < R(0.0) ? -value : value;");
        }
        line(out, indent, "}\n");
    }
}

static const Insertion curve_point[] = {{"curves", write_curves}, {NULL, NULL}};

const Insertions curve_points = {(const char *const[]){"curves.c.in", NULL}, curve_point, NULL};

bool has_table_curves(const Generation *g)
{
    const Curves *curves = g->formulation->wheels->curves;
    bool any = false;
    for (int i = 0; curves && i < curves->count; ++i)
        any = any || !curve_is_short(&curves->curve[i]);
    return any;
}

/* The tires of a class, between quotation marks; tires are numbered by the model. */
static const char *tires_of(const Generation *g, const WheelClass *class)
{
    Text out = {.pool = g->pool};
    int count = 0;
    for (int t = 0; t < g->model->tires; ++t) {
        bool has = false;
        for (int i = 0; i < class->members; ++i)
            has = has || g->model->wheel[class->member[i]].tire == t;
        if (has)
            text_print(&out, "%s'%s'", count++ ? ", " : "", g->model->tire[t].name);
    }
    return pool_print(g->pool, "%s %s", count > 1 ? "Tires" : "Tire", out.s);
}

void write_curve_error(const Generation *g, Text *out)
{
    const Wheels *wheels = g->formulation->wheels;
    for (int c = 0; wheels && wheels->curves && c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        if (class->by_table.stores)
            text_print(out,
                       " * %s by %s (--tire-tables): forces off by at most %.1e of the load, moments of load "
                       "times radius,\n * measured at %d places in the ranges of its data; where errors of all %s "
                       "add up, at most %.1e, at %d\n * places. %.0e is the bound.\n *\n",
                       tires_of(g, class), class->short_curves ? "short polynomials" : "table", class->table_error,
                       TIRE_TABLE_PLACES, class->short_curves ? "polynomials" : "tables", class->table_bound,
                       TIRE_TABLE_BOUND_PLACES, TIRE_TABLE_BOUND);
    }
}
