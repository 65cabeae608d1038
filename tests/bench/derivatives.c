/* SPDX-License-Identifier: MIT
 * What derivatives cost, by turns in one run: a right-hand side, a tangent, a Jacobian (all with a state that changes
 * at every call, as in an integrator). MODEL and CODE as in tests/derivatives/program.c. Prints nanoseconds, the least
 * of 200 turns. */
#define _POSIX_C_SOURCE 199309L
#include "gic_runtime.c"
#include CODE

#include <stdio.h>
#include <time.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(name) JOIN(MODEL, name)

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static MODEL self;
static OF(_direction) along;
static gic_real jacobian[1 << 16];

/* A state near the one of set-up. */
static void vary(int i, gic_real *state)
{
    int k;
    memcpy(state, self.state, sizeof self.state);
    for (k = OF(_model).free_base ? 7 : 0; k < OF(_model).slow_count; ++k)
        state[k] += 1e-4 * (double)((i * 7 + k * 3) % 11);
}

int main(void)
{
    enum { CALLS = 2000, TURNS = 200 };
    const gic_model *code = &OF(_model);
    double least[3] = {1e30, 1e30, 1e30}, sum = 0;
    gic_real state[sizeof self.state / sizeof(gic_real)], rate[sizeof self.state / sizeof(gic_real)];
    int turn, i, bad = OF(_setup)(&self);
    if (code->free_base)
        self.state[code->slow_count > 13 ? 7 + (code->slow_count - 13) / 2 : 7] = 10; /* v.x, m/s */
    for (turn = 0; turn < TURNS; ++turn) {
        double from = now(), took;
        for (i = 0; i < CALLS; ++i) {
            vary(i, state);
            bad |= OF(_rhs)(&self, 0, state, rate);
            sum += rate[code->slow_count - 1];
        }
        took = (now() - from) / CALLS;
        least[0] = took < least[0] ? took : least[0];
        along.state[code->slow_count - 1] = 1;
        from = now();
        for (i = 0; i < CALLS; ++i) {
            vary(i, state);
            bad |= OF(_tangent)(&self, 0, state, &along);
            sum += along.rate[code->slow_count - 1];
        }
        took = (now() - from) / CALLS;
        least[1] = took < least[1] ? took : least[1];
        from = now();
        for (i = 0; i < CALLS / 50; ++i) {
            vary(i, state);
            bad |= OF(_jacobian)(&self, 0, state, &along, jacobian);
            sum += jacobian[0];
        }
        took = (now() - from) / (CALLS / 50);
        least[2] = took < least[2] ? took : least[2];
    }
    printf("right-hand side %.0f ns, tangent %.0f ns, %.2f times, jacobian %.0f ns, %.1f times%s\n", least[0], least[1],
           least[1] / least[0], least[2], least[2] / least[0], bad || sum != sum ? ", with a status" : "");
    return bad != 0;
}
