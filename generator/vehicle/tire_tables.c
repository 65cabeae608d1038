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
    int sample; /* of the member that has the tire */
    const Tire *tire;
    Ex input[VARIED];
    double kept[VARIED]; /* their values before */
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
        ex_set_sample(probe->dag, probe->input[i], probe->sample, value[i]);
    if (number % 8 == 3) /* and loads down to nothing, as where a wheel lifts */
        ex_set_sample(probe->dag, probe->input[VARY_LOAD], probe->sample, nominal * exp(-20 * u[VARY_LOAD]));
    /* weights of combined slip are largest at these slips, with stiff data in a narrow peak */
    const double off = side[VARY_CAMBER] * exp(-14 * u[VARY_FRICTION]);
    const double peak[] = {-pac[PAC_RHY1] - pac[PAC_RHY2] * (value[VARY_LOAD] / nominal - 1), -pac[PAC_RHX1]};
    for (int i = 0; i < 2; ++i)
        if (number % 8 == 5 + 2 * i)
            ex_set_sample(probe->dag, probe->input[i ? VARY_TANGENT : VARY_KAPPA], probe->sample, peak[i] + off);
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

static void forces(const Block *block, int sample, double *out)
{
    for (int i = 0; i < block->stores; ++i)
        out[i] = ex_value(block->dag, block->store[i].value, sample);
}

/* What the errors of all curves add up to at a place, each as large as it is anywhere. Where a narrow peak is missed,
 * forces still change with the curve's value as much as on it, so that this is seen from beside it. Not a proof: forces
 * with a pole have places at which nothing is seen. */
static double errors_add_up(const WheelClass *class, const Probe *probe, double load)
{
    Dag *dag = class->by_table.dag;
    const int sample = probe->sample;
    const int stores = class->by_table.stores;
    double at[stores], moved[stores], sum[stores], none[stores];
    forces(&class->by_table, sample, at);
    for (int i = 0; i < stores; ++i)
        sum[i] = none[i] = 0;
    for (Ex e = 1; e < (Ex)dag->nodes; ++e) {
        if (dag->node[e].op != OP_CURVE)
            continue;
        dag->moved = e;
        const Curve *curve = &dag->curves->curve[dag->node[e].arg[1]];
        dag->moves = curve->error;
        if (curve->kind == CURVE_SHORT_TAN) /* of x + n pi/2, |x| <= pi/4, the error is 1 + tan^2 as large at most */
            dag->moves *= fmax(1, pow(ex_value(dag, e, sample), 2));
        dag_evaluate(dag, sample, 1);
        forces(&class->by_table, sample, moved);
        for (int i = 0; i < stores; ++i)
            sum[i] += fabs(moved[i] - at[i]);
    }
    dag->moved = 0;
    return share_of(class, probe->tire, load, sum, none);
}

/* Raise table_error and table_bound of a class to those of a tire, which a member has. */
static void measure(WheelClass *class, const Tire *tire, int member)
{
    static const int place[VARIED] = {CONTACT_LOAD, CONTACT_KAPPA, CONTACT_TANGENT, CONTACT_CAMBER, CONTACT_FRICTION};
    Dag *dag = class->tire.dag;
    const int sample = member * (dag->samples / dag->members);
    Probe probe = {.dag = dag, .sample = sample, .tire = tire};
    double none[dag->samples], by_formula[class->tire.stores], by_table[class->tire.stores];
    for (int s = 0; s < dag->samples; ++s)
        none[s] = 0;
    for (int i = 0; i < VARIED; ++i) {
        probe.input[i] = ex_input(dag, element_at(ARRAY_contact, place[i]), none);
        probe.kept[i] = ex_value(dag, probe.input[i], sample);
    }
    for (int number = 0; number < TIRE_TABLE_PLACES; ++number) {
        set_place(&probe, number);
        dag_evaluate(dag, sample, 1);
        const double load = ex_value(dag, probe.input[VARY_LOAD], sample);
        forces(&class->tire, sample, by_formula);
        forces(&class->by_table, sample, by_table);
        const double error = share_of(class, tire, load, by_formula, by_table);
        class->table_error = error <= class->table_error ? class->table_error : error;
        if (number < TIRE_TABLE_BOUND_PLACES) {
            const double bound = errors_add_up(class, &probe, load);
            class->table_bound = bound <= class->table_bound ? class->table_bound : bound;
        }
    }
    for (int i = 0; i < VARIED; ++i)
        ex_set_sample(dag, probe.input[i], sample, probe.kept[i]);
    dag_evaluate(dag, sample, 1);
}

/* Measure a tire, and end with a message if the bound is not met. */
static void check(WheelClass *class, const Tire *tire, int member)
{
    const double share = 0.5; /* of the bound, at most: places between those that are measured may be worse */
    const char *way = class->short_curves ? "short polynomials" : "tables";
    measure(class, tire, member);
    if (!(class->table_bound <= TIRE_TABLE_BOUND))
        diag_fail(tire->at, "leave --tire-tables out",
                  "errors of %s for tire '%s' may add up to %.1e of its load; %.0e is the bound", way, tire->name,
                  class->table_bound, TIRE_TABLE_BOUND);
    if (!(class->table_error <= share * TIRE_TABLE_BOUND))
        diag_fail(tire->at, "leave --tire-tables out",
                  "tire '%s' by %s is off by %.1e of its load, measured at %d places; %.0e is the bound, and half "
                  "of it the most that may be measured",
                  tire->name, class->short_curves ? way : "table", class->table_error, TIRE_TABLE_PLACES,
                  TIRE_TABLE_BOUND);
}

const Formulation *formulation_tire_tables(Pool *pool, const Formulation *formulation, bool batch)
{
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
        const Tire *first = &model->tire[model->wheel[class->member[0]].tire];
        if (first->type != TIRE_PAC2002 || first->mode == 0)
            continue;
        class->short_curves = batch || wheel_class_lanes(formulation, class) > 1;
        class->by_table = block_with_curves(&class->tire, curves, class->short_curves);
        for (int i = 0; i < class->members; ++i) { /* in lanes they may have different tires */
            const int tire = model->wheel[class->member[i]].tire;
            bool known = false;
            for (int k = 0; k < i; ++k)
                known = known || model->wheel[class->member[k]].tire == tire;
            if (!known)
                check(class, &model->tire[tire], i);
        }
    }
    if (!curves->count)
        diag_fail((Place){model->source, 0, 0}, "leave --tire-tables out",
                  "no tire of '%s' has a Magic Formula for slip forces, and tables are for those alone", model->name);
    wheels->curves = curves;
    out->wheels = wheels;
    return out;
}
