/* SPDX-License-Identifier: MIT
 * bench_calls.c for generated code of single precision. */
#define GIC_FLOAT
#include "bench_calls.c"
