/* SPDX-License-Identifier: MIT
 * What the banner of generated code says of recovery by polynomials. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

static const char *members_text(const Generation *g, const Class *class, const Polynomial *p)
{
    Text out = {.pool = g->pool};
    for (int i = 0; i < class->members; ++i) {
        const Coordinate *c = &g->model->coordinate[g->sequence->subset[class->member[i]].dep[0]];
        text_print(&out, "%s%s in [%g, %g]", i ? ", " : "", c->name, p->low[i], p->high[i]);
    }
    return out.s;
}

void write_polynomials(const Generation *g, Text *out)
{
    bool any = false;
    for (int c = 0; c < g->sequence->classes; ++c)
        any = any || g->plan->formula[c]->polynomial;
    if (!any)
        return;
    text_print(
        out,
        " *\n * Polynomials (--recovery polynomial) in place of Newton's iteration while a coordinate is within its\n"
        " * range, now and at the end of the step. Bound: of errors of places relative to the subset's size, of "
        "rotation\n"
        " * matrices, and of unit velocities and accelerations relative to the largest of their kind. Fitted in quad\n"
        " * precision. Proved for all of the range by interval arithmetic, where each operation may round as double\n"
        " * precision does, and compared with solutions of the equations at points.\n");
    for (int c = 0; c < g->sequence->classes; ++c) {
        const Class *class = &g->sequence->class[c];
        const Formula *f = g->plan->formula[c];
        const Polynomial *p = f->polynomial;
        if (p)
            text_print(
                out,
                " *   '%s': of %s;\n *       degree at most %d, bound %g, proved %.2g by %d intervals, largest error"
                " found %.2g at %d points\n",
                class->name, members_text(g, class, p), p->degree, p->bound, p->most, p->intervals, p->worst,
                p->points);
        else if (f->exact_because)
            text_print(out, " *   '%s': none, for %s\n", class->name, f->exact_because);
    }
}
