/* SPDX-License-Identifier: MIT
 * Proof of polynomials, interval by interval from the design to both ends of a range: the motion by enclosure.c, and
 * the statements that become code by the same arithmetic, in which each operation may round as double precision does.
 * The difference of both bounds the error. Intervals of which nothing can be proved are halved. */
#include "subset/polynomial_proof.h"

#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/enclosure.h"

#include <float.h>
#include <math.h>

enum { PARTS = 8, HALVED_MOST = 6 }; /* of a way from the design to an end; how often a part is halved */

typedef struct Proof {
    const Work *w;
    const Formula *formula;
    Polynomial *polynomial;
    const double *scale;
    Enclosure *enclosure;
    const bool *needed; /* [nodes] by the polynomials' motions */
    TaylorModel *node;
    int member;
    Quad most;
    int intervals;
} Proof;

static int kind_of(int place)
{
    static const int kind[] = {KIND_ROTATION, KIND_TURN, KIND_GLIDE, KIND_ALPHA, KIND_ACCELERATION};
    return place < MOTION_A       ? KIND_PLACE
           : place < MOTION_OMEGA ? KIND_ROTATION
           : place < MOTION_S     ? kind[1 + (place - MOTION_OMEGA) / 3]
                                  : kind[1 + (place - MOTION_S) / 3];
}

static TaylorModel input(const void *context, Element element)
{
    const Proof *proof = context;
    TaylorModel found = taylor_constant(1); /* the rate */
    if (element.array == ARRAY_x)
        found = *enclosure_coordinate(proof->enclosure);
    else if (element.array != ARRAY_rate)
        found.off = NAN;
    return found;
}

/* The largest error over one interval, relative to the scales; infinite where nothing can be said. */
static Quad error_over(Proof *proof, Quad from, Quad to)
{
    const Work *w = proof->w;
    const Formula *f = proof->formula;
    const int s = w->class->member[proof->member], size = f->layout.motion_size;
    if (!enclosure_extend(proof->enclosure, s, from, to))
        return HUGE_VAL;
    enclosure_evaluate(w->dag, proof->member * (w->dag->samples / w->dag->members), proof->needed, input, proof,
                       DBL_EPSILON / 2, proof->node);
    const TaylorModel *exact = enclosure_motion(proof->enclosure, s);
    Quad most = 0;
    for (int i = 0; i < f->layout.bodies * size; ++i) {
        const Ex own = *motion_number((Motion *)&proof->polynomial->motion[i / size], i % size);
        if (own == *motion_number(&f->motion[i / size], i % size))
            continue; /* a constant that both have */
        TaylorModel difference;
        taylor_sum(&exact[i], &proof->node[own], -1, &difference);
        most = quad_max(most, taylor_most(&difference) / (Quad)proof->scale[kind_of(i % size)]);
    }
    return most;
}

/* From one value of the coordinate to another one; false: it can't be proved. */
static bool prove(Proof *proof, Quad from, Quad to, int halved)
{
    const Quad error = error_over(proof, from, to);
    if (error <= (Quad)proof->polynomial->bound) {
        enclosure_accept(proof->enclosure, proof->w->class->member[proof->member]);
        proof->most = quad_max(proof->most, error);
        ++proof->intervals;
        return true;
    }
    const Quad middle = (from + to) / 2;
    return halved < HALVED_MOST && prove(proof, from, middle, halved + 1) && prove(proof, middle, to, halved + 1);
}

const char *polynomial_prove(const Work *w, const Formula *formula, Polynomial *polynomial, Exact *exact,
                             const double *scale)
{
    const int count = formula->layout.bodies * formula->layout.motion_size;
    Ex root[count];
    for (int i = 0; i < count; ++i)
        root[i] = *motion_number((Motion *)&polynomial->motion[i / formula->layout.motion_size],
                                 i % formula->layout.motion_size);
    Proof proof = {.w = w,
                   .formula = formula,
                   .polynomial = polynomial,
                   .scale = scale,
                   .enclosure = enclosure_new(exact),
                   .needed = dag_needed(w->dag, root, count),
                   .node = pool_alloc(w->pool, (size_t)w->dag->nodes * sizeof *proof.node)};
    for (int m = 0; m < w->class->members; ++m) {
        const Coordinate *c = &w->model->coordinate[subset_member(w, m)->dep[0]];
        proof.member = m;
        for (int side = 0; side < 2; ++side) {
            const Quad design = (Quad)c->design, end = (Quad)(side ? polynomial->high[m] : polynomial->low[m]);
            enclosure_reset(proof.enclosure);
            for (int i = 0; i < PARTS && end != design; ++i) {
                const Quad from = design + (end - design) * (Quad)i / PARTS,
                           to = i == PARTS - 1 ? end : design + (end - design) * (Quad)(i + 1) / PARTS;
                if (!prove(&proof, from, to, 0))
                    return pool_print(w->pool,
                                      "it can't be proved that errors are below %g with '%s' between %g and %g",
                                      polynomial->bound, c->name, (double)from, (double)to);
            }
        }
    }
    polynomial->most = (double)proof.most * (1 + DBL_EPSILON);
    polynomial->intervals = proof.intervals;
    return NULL;
}
