/* SPDX-License-Identifier: MIT
 *
 * Random numbers that are the same on every machine. */
#ifndef BASE_RANDOM_H
#define BASE_RANDOM_H

#include <stdint.h>

/* splitmix64: the same sequence on every machine. */
typedef struct Random {
    uint64_t state;
} Random;

uint64_t random_bits(Random *random);
double random_uniform(Random *random, double low, double high);

#endif
