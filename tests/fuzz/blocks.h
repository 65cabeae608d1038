/* SPDX-License-Identifier: MIT
 * Readers leave by exit() when a file is wrong. A fuzzer goes on in the same process and frees then what they had
 * allocated: all that malloc and its like gave between blocks_begin and blocks_end. Blocks of a Pool are allocated one
 * by one meanwhile. */
#ifndef FUZZ_BLOCKS_H
#define FUZZ_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>

struct Pool;

void blocks_begin(void);
void blocks_end(void);

#endif
