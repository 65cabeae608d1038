/* SPDX-License-Identifier: MIT
 * calls.c for generated code of single precision. */
#define GIC_FLOAT
#include "calls.c"
