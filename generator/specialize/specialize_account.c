/* SPDX-License-Identifier: MIT
 * What each thing that is known about a scene saves, one after the other, and why it may be left out. */
#include "base/text.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "specialize/specialize.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

typedef struct Accounting {
    Pool *pool;
    const Model *model;
    const Sequence *sequence;
    Solve solve;
    Recovery recovery;
    const Facts *all;
    Facts known; /* so far */
    Account *account;
} Accounting;

static void add_row(Accounting *a, const Formulation *f, const char *what, const char *why)
{
    const Figures *figures = figures_new(a->pool, f);
    *POOL_PUSH(a->pool, a->account->row, a->account->rows) =
        (AccountRow){what, why, figures_rhs(figures, 1, 1), figures_outputs(figures)};
}

/* One more thing is known. */
static void learn(Accounting *a, const char *what, const char *why)
{
    add_row(a, formulate_narrow(a->pool, a->model, a->sequence, a->solve, a->recovery, &a->known), what, why);
}

/* Of the model as it was drawn, which the rig comes after. */
static void learn_massless(Accounting *a, const Model *drawn)
{
    const char *names;
    if (a->all->massless == 0)
        return;
    const Model *light = model_lighten(a->pool, drawn, drawn, a->all->massless, &names);
    const Sequence *first = sequence_find(a->pool, light);
    add_row(a, formulate(a->pool, model_assemble(a->pool, light, first), first, a->solve, a->recovery),
            pool_print(a->pool, "bodies below %.6g kg massless, an approximation", a->all->massless),
            pool_print(a->pool, "the scene asks for it: %s; a motion of coordinates loses up to %.3g of its inertia",
                       a->all->massless_names, a->all->lost));
}

static void learn_outputs(Accounting *a)
{
    int wanted = 0, reactions = 0;
    if (!a->all->wanted)
        return;
    for (int i = 0; i < a->model->outputs; ++i) {
        wanted += a->all->wanted[i];
        reactions += !a->all->wanted[i] && a->model->output[i].type == OUTPUT_REACTION;
    }
    a->known.wanted = a->all->wanted;
    learn(a, "outputs nobody asks for",
          pool_print(a->pool, "%d of %d outputs are asked for%s", wanted, a->model->outputs,
                     reactions ? ", and fewer reactions" : ""));
}

static void learn_ports(Accounting *a)
{
    if (!a->all->idle || !a->model->ports)
        return;
    a->known.idle = true;
    learn(a, "ports", "nothing in a scene acts on one");
}

static void learn_parameters(Accounting *a)
{
    if (!a->all->parameter || !a->model->tunables)
        return;
    a->known.parameter = a->all->parameter;
    learn(a, "parameters folded", "they keep their values all along");
}

static void learn_inputs(Accounting *a)
{
    Text list = {.pool = a->pool};
    for (int i = 0; i < a->model->inputs; ++i)
        if (a->all->fixed[i] && !strchr(a->model->input[i].name, '.'))
            text_print(&list, "%s%s", list.size ? ", " : "", a->model->input[i].name);
    if (!list.size)
        return;
    a->known.fixed = a->all->fixed;
    a->known.input = a->all->input;
    learn(a, "inputs folded, driven coordinates at rest", pool_print(a->pool, "these keep their values: %s", list.s));
}

static void learn_road(Accounting *a)
{
    if (!a->model->wheels)
        return;
    a->known.plane = a->all->plane;
    learn(a, "road and friction without look-up",
          a->all->plane ? "the road is a plane with one friction" : "refused: the road is no plane with one friction");
}

static void learn_powertrain(Accounting *a)
{
    if (!a->model->powertrain)
        return;
    a->known.neutral = a->all->neutral;
    learn(a, "no powertrain",
          a->all->neutral ? "the transmission is in neutral all along" : "refused: a gear may be engaged");
}

static void learn_symmetry(Accounting *a)
{
    a->known.asymmetry = a->all->asymmetry;
    a->known.across = a->all->across;
    const Formulation *f = formulate_narrow(a->pool, a->model, a->sequence, a->solve, a->recovery, &a->known);
    const char *why = f->narrowing->asymmetry;
    add_row(a, f, "one side for both",
            why ? pool_print(a->pool, "refused: %s", why)
                : "model, initial state, inputs and road are the same on both sides");
}

const Formulation *formulate_explained(Pool *pool, const Model *drawn, const Model *model, const Sequence *sequence,
                                       Solve solve, Recovery recovery, const Facts *facts)
{
    /* figures are those of iterations, which polynomials stand in front of */
    const Recovery counted = recovery == RECOVERY_POLYNOMIAL ? RECOVERY_AUTO : recovery;
    Accounting a = {pool, model, sequence, solve, counted, facts, *facts, pool_alloc(pool, sizeof *a.account)};
    a.known.wanted = NULL;
    a.known.fixed = pool_alloc(pool, (size_t)model->inputs + 1);
    a.known.parameter = NULL;
    a.known.plane = NULL;
    a.known.across = false;
    a.known.idle = a.known.neutral = false;
    a.known.asymmetry = "it is not looked at yet";
    const Sequence *first = sequence_find(pool, drawn);
    add_row(&a, formulate(pool, model_assemble(pool, drawn, first), first, solve, counted), "code for any scene", "");
    learn_massless(&a, drawn);
    if (drawn->free_base != model->free_base || drawn->inputs != model->inputs)
        learn(&a, "equations of a held base and driven coordinates", "the scene is one of a rig");
    learn_outputs(&a);
    learn_ports(&a);
    learn_parameters(&a);
    learn_inputs(&a);
    learn_road(&a);
    learn_powertrain(&a);
    learn_symmetry(&a);
    Narrowing *narrowing = pool_alloc(pool, sizeof *narrowing);
    Formulation *out = pool_alloc(pool, sizeof *out);
    *out = *formulate_narrow(pool, model, sequence, solve, recovery, facts);
    *narrowing = *out->narrowing;
    narrowing->account = a.account;
    out->narrowing = narrowing;
    return out;
}
