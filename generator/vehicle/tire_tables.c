/* SPDX-License-Identifier: MIT
 * Tires by table (models/TIRES.md section 11): the blocks of tires' forces with curves in place of arc tangents and of
 * sines and cosines of them, and by how much that changes forces and moments. */
#include "base/message.h"
#include "expression/curve.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tire_numbers.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

#include <math.h>

/* Inputs of a tire's block that are varied. */
enum { VARY_LOAD, VARY_KAPPA, VARY_TANGENT, VARY_CAMBER, VARY_FRICTION, VARIED };

typedef struct Probe {
    Dag *dag;
    const Tire *tire;
    Ex input[VARIED];
    double kept[VARIED]; /* their values at sample 0 before */
} Probe;

static double limited(double limit, double most)
{
    return fmin(fabs(limit), most);
}

/* Place `number` of a sequence that fills the five dimensions evenly (Roberts' R5), as inputs. Slips gather at 0, loads
 * go from a thousandth of the nominal one to the largest of the data. */
static void set_place(const Probe *probe, int number)
{
    const double golden = 1.13472413840151949; /* x^6 = x + 1 */
    const double *pac = probe->tire->number;
    double u[VARIED], step = 1;
    for (int i = 0; i < VARIED; ++i) {
        step /= golden;
        u[i] = 0.5 + number * step;
        u[i] -= floor(u[i]);
    }
    const double nominal = pac[PAC_LFZO] * pac[PAC_FNOMIN], most = fmin(pac[PAC_FZMAX], 5 * nominal);
    double side[VARIED];
    for (int i = 0; i < VARIED; ++i)
        side[i] = 2 * u[i] - 1;
    for (int i = VARY_KAPPA; i <= VARY_TANGENT; ++i)
        if (number % 2)
            side[i] *= side[i] * fabs(side[i]);
    const double kappa = side[VARY_KAPPA] > 0 ? pac[PAC_KPUMAX] : pac[PAC_KPUMIN];
    const double alpha = side[VARY_TANGENT] > 0 ? pac[PAC_ALPMAX] : pac[PAC_ALPMIN];
    const double camber = side[VARY_CAMBER] > 0 ? pac[PAC_CAMMAX] : pac[PAC_CAMMIN];
    const double value[VARIED] = {[VARY_LOAD] = nominal / 1000 + u[VARY_LOAD] * (fmax(most, nominal) - nominal / 1000),
                                  [VARY_KAPPA] = side[VARY_KAPPA] * limited(kappa, 1.5),
                                  [VARY_TANGENT] = tan(side[VARY_TANGENT] * limited(alpha, 1.55)),
                                  [VARY_CAMBER] = side[VARY_CAMBER] * limited(camber, 0.5),
                                  [VARY_FRICTION] = number % 4 < 2 ? 1 : 0.1 + 1.1 * u[VARY_FRICTION]};
    for (int i = 0; i < VARIED; ++i)
        ex_set_sample(probe->dag, probe->input[i], 0, value[i]);
    if (number % 8 == 3) /* and loads down to nothing, as where a wheel lifts */
        ex_set_sample(probe->dag, probe->input[VARY_LOAD], 0, nominal * exp(-20 * u[VARY_LOAD]));
    /* weights of combined slip are largest at these slips, with stiff data in a narrow peak */
    const double off = side[VARY_CAMBER] * exp(-14 * u[VARY_FRICTION]);
    const double peak[] = {-pac[PAC_RHY1] - pac[PAC_RHY2] * (value[VARY_LOAD] / nominal - 1), -pac[PAC_RHX1]};
    for (int i = 0; i < 2; ++i)
        if (number % 8 == 5 + 2 * i)
            ex_set_sample(probe->dag, probe->input[i ? VARY_TANGENT : VARY_KAPPA], 0, peak[i] + off);
}

/* The largest share of forces in the load, and of moments in the load by the radius, of a difference. */
static double share_of(const WheelClass *class, const Tire *tire, double load, const double *a, const double *b)
{
    double worst = 0;
    for (int i = 0; i < class->tire.stores; ++i) {
        const int force = class->tire.store[i].target.index;
        const double share = fabs(a[i] - b[i]) / (force == TIRE_FX || force == TIRE_FY ? load : load * tire->radius);
        worst = share <= worst ? worst : share; /* what is not finite stays */
    }
    return worst;
}

static void forces(const Block *block, double *out)
{
    for (int i = 0; i < block->stores; ++i)
        out[i] = ex_value(block->dag, block->store[i].value, 0);
}

/* What the errors of all curves add up to at a place, each as large as it is anywhere. Where a narrow peak is missed,
 * forces still change with the curve's value as much as on it, so that this is seen from beside it. Not a proof: forces
 * with a pole have places at which nothing is seen. */
static double errors_add_up(const WheelClass *class, const Tire *tire, double load)
{
    Dag *dag = class->by_table.dag;
    const int stores = class->by_table.stores;
    double at[stores], moved[stores], sum[stores], none[stores];
    forces(&class->by_table, at);
    for (int i = 0; i < stores; ++i)
        sum[i] = none[i] = 0;
    for (Ex e = 1; e < (Ex)dag->nodes; ++e) {
        if (dag->node[e].op != OP_CURVE)
            continue;
        dag->moved = e;
        dag->moves = dag->curves->curve[dag->node[e].arg[1]].error;
        dag_evaluate(dag, 0, 1);
        forces(&class->by_table, moved);
        for (int i = 0; i < stores; ++i)
            sum[i] += fabs(moved[i] - at[i]);
    }
    dag->moved = 0;
    return share_of(class, tire, load, sum, none);
}

/* table_error and table_bound of a class. */
static void measure(WheelClass *class, const Tire *tire)
{
    static const int place[VARIED] = {CONTACT_LOAD, CONTACT_KAPPA, CONTACT_TANGENT, CONTACT_CAMBER, CONTACT_FRICTION};
    Dag *dag = class->tire.dag;
    Probe probe = {.dag = dag, .tire = tire};
    double none[dag->samples], by_formula[class->tire.stores], by_table[class->tire.stores];
    for (int s = 0; s < dag->samples; ++s)
        none[s] = 0;
    for (int i = 0; i < VARIED; ++i) {
        probe.input[i] = ex_input(dag, element_at(ARRAY_contact, place[i]), none);
        probe.kept[i] = ex_value(dag, probe.input[i], 0);
    }
    for (int number = 0; number < TIRE_TABLE_PLACES; ++number) {
        set_place(&probe, number);
        dag_evaluate(dag, 0, 1);
        const double load = ex_value(dag, probe.input[VARY_LOAD], 0);
        forces(&class->tire, by_formula);
        forces(&class->by_table, by_table);
        const double error = share_of(class, tire, load, by_formula, by_table);
        class->table_error = error <= class->table_error ? class->table_error : error;
        if (number < TIRE_TABLE_BOUND_PLACES) {
            const double bound = errors_add_up(class, tire, load);
            class->table_bound = bound <= class->table_bound ? class->table_bound : bound;
        }
    }
    for (int i = 0; i < VARIED; ++i)
        ex_set_sample(dag, probe.input[i], 0, probe.kept[i]);
    dag_evaluate(dag, 0, 1);
}

const Formulation *formulation_tire_tables(Pool *pool, const Formulation *formulation)
{
    const double share = 0.5; /* of the bound, at most: places between those that are measured may be worse */
    const Model *model = formulation->model;
    const Wheels *from = formulation->wheels;
    if (!from || !from->count)
        diag_fail((Place){model->source, 0, 0}, "leave --tire-tables out", "no wheel of '%s' has a tire", model->name);
    Formulation *out = pool_alloc(pool, sizeof *out);
    Wheels *wheels = pool_alloc(pool, sizeof *wheels);
    Curves *curves = pool_alloc(pool, sizeof *curves);
    *out = *formulation;
    *wheels = *from;
    wheels->class = pool_alloc(pool, (size_t)from->classes * sizeof *wheels->class);
    for (int c = 0; c < from->classes; ++c) {
        WheelClass *class = &wheels->class[c];
        *class = from->class[c];
        const Tire *tire = &model->tire[model->wheel[class->member[0]].tire];
        if (tire->type != TIRE_PAC2002 || tire->mode == 0)
            continue;
        class->by_table = block_with_curves(&class->tire, curves);
        measure(class, tire);
        if (!(class->table_bound <= TIRE_TABLE_BOUND))
            diag_fail(tire->at, "leave --tire-tables out",
                      "errors of tables for tire '%s' may add up to %.1e of its load; %.0e is the bound", tire->name,
                      class->table_bound, TIRE_TABLE_BOUND);
        if (!(class->table_error <= share * TIRE_TABLE_BOUND))
            diag_fail(
                tire->at, "leave --tire-tables out",
                "tire '%s' by table is off by %.1e of its load, measured at %d places; %.0e is the bound, and half "
                "of it the most that may be measured",
                tire->name, class->table_error, TIRE_TABLE_PLACES, TIRE_TABLE_BOUND);
    }
    if (!curves->count)
        diag_fail((Place){model->source, 0, 0}, "leave --tire-tables out",
                  "no tire of '%s' has a Magic Formula for slip forces, and tables are for those alone", model->name);
    wheels->curves = curves;
    out->wheels = wheels;
    return out;
}
