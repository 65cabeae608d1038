/* SPDX-License-Identifier: MIT
 * What derivatives cost, by turns in one run: a right-hand side, a tangent along all states, along one coordinate (the
 * last one) and along its rate, a Jacobian (all with a state that changes at every call, as in an integrator). A
 * tangent computes the right-hand side too: "extra" is what it takes beyond that. MODEL and CODE as in
 * tests/derivatives/program.c. Prints nanoseconds, the least of 200 turns. */
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

enum { CALLS = 2000, TURNS = 200, DENSE = 0, COORDINATE, RATE, DIRECTIONS };
static const char *const direction_name[DIRECTIONS] = {"all states", "a coordinate", "a rate"};

static void aim(int direction)
{
    const int slow = OF(_model).slow_count, last = OF(_model).free_base ? (slow - 13) / 2 + 6 : slow / 2 - 1;
    int k;
    memset(along.state, 0, sizeof along.state);
    for (k = 0; k < slow && direction == DENSE; ++k)
        along.state[k] = 1 + 0.01 * k;
    if (direction == COORDINATE)
        along.state[last] = 1;
    if (direction == RATE)
        along.state[slow - 1] = 1;
}

int main(void)
{
    const gic_model *code = &OF(_model);
    double least[2 + DIRECTIONS], sum = 0, from, took;
    gic_real state[sizeof self.state / sizeof(gic_real)], rate[sizeof self.state / sizeof(gic_real)];
    int turn, i, d, bad = OF(_setup)(&self);
    for (d = 0; d < 2 + DIRECTIONS; ++d)
        least[d] = 1e30;
    if (code->free_base)
        self.state[code->slow_count > 13 ? 7 + (code->slow_count - 13) / 2 : 7] = 10; /* v.x, m/s */
    for (turn = 0; turn < TURNS; ++turn) {
        from = now();
        for (i = 0; i < CALLS; ++i) {
            vary(i, state);
            bad |= OF(_rhs)(&self, 0, state, rate);
            sum += rate[code->slow_count - 1];
        }
        took = (now() - from) / CALLS;
        least[0] = took < least[0] ? took : least[0];
        for (d = 0; d < DIRECTIONS; ++d) {
            aim(d);
            from = now();
            for (i = 0; i < CALLS; ++i) {
                vary(i, state);
                bad |= OF(_tangent)(&self, 0, state, &along);
                sum += along.rate[code->slow_count - 1];
            }
            took = (now() - from) / CALLS;
            least[2 + d] = took < least[2 + d] ? took : least[2 + d];
        }
        from = now();
        for (i = 0; i < CALLS / 50; ++i) {
            vary(i, state);
            bad |= OF(_jacobian)(&self, 0, state, &along, jacobian);
            sum += jacobian[0];
        }
        took = (now() - from) / (CALLS / 50);
        least[1] = took < least[1] ? took : least[1];
    }
    printf("right-hand side %.0f ns", least[0]);
    for (d = 0; d < DIRECTIONS; ++d)
        printf(", tangent along %s %.0f ns, %.2f times (extra %.2f)", direction_name[d], least[2 + d],
               least[2 + d] / least[0], least[2 + d] / least[0] - 1);
    printf(", jacobian %.0f ns, %.1f times%s\n", least[1], least[1] / least[0],
           bad || sum != sum ? ", with a status" : "");
    return bad != 0;
}
