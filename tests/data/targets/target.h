/* SPDX-License-Identifier: MIT
 * What programs here want of the machine they run on, and what they print. */
#ifndef TARGET_H
#define TARGET_H

#include "gic_runtime.h"

void target_print(const char *text);
/* Instructions since some time, modulo 2^32; to be asked at least once in 6e8 of them. 0: the machine does not tell. */
uint32_t target_instructions(void);
/* So many instructions and a few more, to judge the counts by; only where the machine tells them. */
enum { TARGET_LOOP = 4000000 };
void target_loop(void);
/* Say what there is to say about the run, and stop: `failed` is 0 or 1. Returns only where main may. */
void target_end(int failed);

/* print.c. A line with sign, exponent and fraction as hexadecimal digits, most significant first; ten digits. */
void print_bits(gic_real value);
void print_whole(uint32_t value);

#endif
