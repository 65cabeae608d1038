/* SPDX-License-Identifier: MIT
 * Multiply-adds that the processor can do in a second: the limit of straight-line code. The Makefile compiles this
 * file so that x * a + b is one instruction where the processor has one, and no loop is vectorized that does not say
 * so. */
#include "bench/bench.h"
#include "engine/engine.h"

#include <math.h>

/* A multiply-add takes some 4 or 5 cycles, and two can begin in each: this many must be under way. More would not fit
 * into 16 registers. */
#define CHAINS(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7) X(8) X(9) X(10) X(11)

enum { UNDER_WAY = 12, ROUNDS = 20000, TRIALS = 8 };

#define CHAIN_BEGIN(i) x##i = a + i,
#define CHAIN_STEP(i) x##i = x##i * a + b;
#define CHAIN_ADD(i) last += x##i;

/* ROUNDS multiply-adds in each chain, on numbers that converge to 1; first: a double of `last`. Numbers pass through a
 * volatile, so that nothing is computed beforehand or left out. */
#define KERNEL(name, target, type, first) \
    target static void name(void) \
    { \
        volatile double place = 0.5; \
        const type a = (type){0} + place, b = a; \
        type CHAINS(CHAIN_BEGIN) last = a; \
        for (int i = 0; i < ROUNDS; ++i) { \
            CHAINS(CHAIN_STEP) \
        } \
        CHAINS(CHAIN_ADD) \
        place = first; \
    }

typedef double Pair __attribute__((vector_size(16)));
KERNEL(plain, , double, last)
KERNEL(pairs, , Pair, last[0])

#ifdef __x86_64__
typedef double Four __attribute__((vector_size(32)));
typedef double Eight __attribute__((vector_size(64)));
KERNEL(fused, __attribute__((target("fma"))), double, last)
KERNEL(fours, __attribute__((target("avx2,fma"))), Four, last[0])
KERNEL(eights, __attribute__((target("avx512f,fma"))), Eight, last[0])
#endif

/* Multiply-adds in a second, of the shortest of some trials. */
static double rate_of(void (*kernel)(void))
{
    double best = INFINITY;
    for (int trial = 0; trial < TRIALS; ++trial) {
        const double before = clock_seconds(CLOCK_MONOTONIC);
        kernel();
        best = fmin(best, clock_seconds(CLOCK_MONOTONIC) - before);
    }
    return (int)UNDER_WAY * (double)ROUNDS / best;
}

Limit limit_measure(void)
{
    void (*scalar)(void) = plain, (*vector)(void) = pairs;
    int lanes = 2;
#ifdef __x86_64__
    if (__builtin_cpu_supports("fma")) {
        scalar = fused;
        if (__builtin_cpu_supports("avx512f"))
            vector = eights, lanes = 8;
        else if (__builtin_cpu_supports("avx2"))
            vector = fours, lanes = 4;
    }
#endif
    return (Limit){rate_of(scalar), lanes * rate_of(vector), lanes};
}
