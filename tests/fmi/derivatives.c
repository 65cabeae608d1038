/* SPDX-License-Identifier: MIT
 * Directional derivatives against differences of what the FMU itself computes, in model exchange; adjoint ones
 * (FMI 3.0) against directional ones. */
#include "importer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is compared: references of unknowns and of knowns, and where the knowns are. */
typedef struct Problem {
    const Unit *unit;
    Component c;
    size_t n, unknowns, knowns;
    unsigned *unknown, *known;
    int *state; /* [knowns] index among the states, -1: an input */
    bool *road; /* [knowns] it is a number of the road */
    double *x;  /* [n] */
} Problem;

static Problem problem_new(const Unit *unit, Component c)
{
    const Description *d = &unit->d;
    const size_t count = (size_t)d->variables + 1, n = (size_t)d->states;
    Problem p = {.unit = unit,
                 .c = c,
                 .n = n,
                 .unknown = calloc(count, sizeof *p.unknown),
                 .known = calloc(count, sizeof *p.known),
                 .state = calloc(count, sizeof *p.state),
                 .road = calloc(count, sizeof *p.road),
                 .x = calloc(n + 1, sizeof *p.x)};
    for (int i = 0; i < d->variables; ++i) {
        const Variable *v = &d->variable[i];
        int state = (int)n - 1;
        while (state >= 0 && d->state[state] != i)
            --state;
        if (v->type == REAL && (!strcmp(v->causality, "output") || v->derivative >= 0))
            p.unknown[p.unknowns++] = v->reference;
        if (state >= 0 || (v->type == REAL && !strcmp(v->causality, "input"))) {
            p.state[p.knowns] = state;
            p.road[p.knowns] = !strncmp(v->name, "road.", 5);
            p.known[p.knowns++] = v->reference;
        }
    }
    return p;
}

/* Add `factor` times all unknowns, where known k is `step` away from where it is, to sum[]. */
static void add_moved(const Problem *p, size_t k, double step, double factor, double *sum)
{
    double value = 0, moved, result;
    if (p->state[k] < 0) {
        need(p->unit->GetReal(p->c, &p->known[k], 1, &value), "fmi2GetReal");
        moved = value + step;
        need(p->unit->SetReal(p->c, &p->known[k], 1, &moved), "fmi2SetReal");
    } else {
        p->x[p->state[k]] += step;
        need(p->unit->SetContinuousStates(p->c, p->x, p->n), "fmi2SetContinuousStates");
    }
    for (size_t i = 0; i < p->unknowns; ++i) {
        need(p->unit->GetReal(p->c, &p->unknown[i], 1, &result), "fmi2GetReal");
        sum[i] += factor * result;
    }
    if (p->state[k] < 0) {
        need(p->unit->SetReal(p->c, &p->known[k], 1, &value), "fmi2SetReal");
    } else {
        p->x[p->state[k]] -= step;
        need(p->unit->SetContinuousStates(p->c, p->x, p->n), "fmi2SetContinuousStates");
    }
}

/* Column k of what is compared, [unknowns] each; the largest deviation relative to the column's largest number and to
 * what rounding makes of differences of a large number. */
static double compare_column(const Problem *p, size_t k, double *exact, double *other)
{
    static const double place[4] = {-2, -1, 1, 2}, factor[4] = {1, -8, 8, -1};
    const double one = 1, step = 1e-5;
    double largest = 1e-3, worst = 0;
    need(p->unit->GetDirectionalDerivative(p->c, p->unknown, p->unknowns, &p->known[k], 1, &one, exact),
         "fmi2GetDirectionalDerivative");
    memset(other, 0, p->unknowns * sizeof *other);
    for (int i = 0; i < 4; ++i)
        add_moved(p, k, place[i] * step, factor[i] / (12 * step), other);
    for (size_t i = 0; i < p->unknowns; ++i)
        largest = fmax(largest, fabs(other[i]));
    for (size_t i = 0; i < p->unknowns; ++i) {
        double value;
        need(p->unit->GetReal(p->c, &p->unknown[i], 1, &value), "fmi2GetReal");
        worst = fmax(worst, fabs(exact[i] - other[i]) / (largest + 1e-3 * fabs(value)));
    }
    return worst;
}

static double chance(void)
{
    return rand() / (RAND_MAX + 1.0) - 0.5;
}

/* u . J v = (J^T u) . v */
static void compare_adjoint(const Problem *p, double tolerance)
{
    double *u = calloc(p->unknowns + 1, sizeof *u), *v = calloc(p->knowns + 1, sizeof *v);
    double *Jv = calloc(p->unknowns + 1, sizeof *Jv), *Jtu = calloc(p->knowns + 1, sizeof *Jtu);
    double left = 0, right = 0, size = 0;
    for (size_t i = 0; i < p->unknowns; ++i)
        u[i] = chance();
    for (size_t k = 0; k < p->knowns; ++k)
        v[k] = tolerance < 1e-9 && p->road[k] ? 0 : chance(); /* by the road there are differences */
    need(p->unit->GetDirectionalDerivative(p->c, p->unknown, p->unknowns, p->known, p->knowns, v, Jv), "a derivative");
    need(p->unit->GetAdjointDerivative(p->c, p->unknown, p->unknowns, p->known, p->knowns, u, Jtu), "an adjoint one");
    for (size_t i = 0; i < p->unknowns; ++i)
        left += u[i] * Jv[i], size += fabs(u[i] * Jv[i]);
    for (size_t k = 0; k < p->knowns; ++k)
        right += Jtu[k] * v[k], size += fabs(Jtu[k] * v[k]);
    fprintf(stderr, "importer: adjoint %.2e\n", fabs(left - right) / size);
    expect(fabs(left - right) <= tolerance * size, "adjoint derivatives are others than directional ones");
}

void check_derivatives(const Unit *unit, int count, char **word)
{
    Component c = instantiate(unit, "vehicle", EXCHANGE);
    double seed = NAN, out, *exact, *other;
    unsigned nothing = 0xfffffff;
    initialize_on(unit, c, NULL, 1, count, word);
    event(unit, c);
    Problem p = problem_new(unit, c);
    exact = calloc(p.unknowns + 1, sizeof *exact);
    other = calloc(p.unknowns + 1, sizeof *other);
    need(unit->GetContinuousStates(c, p.x, p.n), "fmi2GetContinuousStates");
    for (size_t i = 0; i < p.n; ++i) /* nothing is zero, nor at a kink */
        p.x[i] += 1e-3 * (1.5 + chance());
    need(unit->SetContinuousStates(c, p.x, p.n), "fmi2SetContinuousStates");
    for (int road = 0; road < 2; ++road) { /* first without the road, which counts as given once it is set */
        double worst = 0;
        for (size_t k = 0; k < p.knowns; ++k) {
            const double now = road || !p.road[k] ? compare_column(&p, k, exact, other) : 0;
            if (now > 1e-6)
                fprintf(stderr, "importer: derivatives by value reference %u are %.2e off\n", p.known[k], now);
            worst = fmax(worst, now);
        }
        fprintf(stderr, "importer: %d x %d derivatives, %.2e off differences\n", (int)p.unknowns, (int)p.knowns, worst);
        expect(worst <= 1e-6, "derivatives are others than differences");
        if (unit->GetAdjointDerivative)
            compare_adjoint(&p, road ? 1e-6 : 1e-12);
    }
    expect(unit->GetDirectionalDerivative(c, p.unknown, 1, p.known, 1, &seed, &out) == DISCARD, "a seed is no number");
    seed = 1;
    expect(unit->GetDirectionalDerivative(c, &nothing, 1, p.known, 1, &seed, &out) == ERROR, "an unknown is none");
    expect(unit->GetDirectionalDerivative(c, p.unknown, 1, &nothing, 1, &seed, &out) == ERROR, "a known is none");
    unit->FreeInstance(c);
}
