/* SPDX-License-Identifier: MIT
 *
 * wasm: modules of WebAssembly, run by an interpreter. A module has one arithmetic wherever it runs, so that what the
 * page of gicrun --drive computes in a browser is computed here to the last bit.
 *
 * Known are version 1.0, sign extensions, conversions that saturate, and copies and fills of memory; not known are
 * imports, vectors, several results, and more than one memory or table. */
#ifndef WASM_WASM_H
#define WASM_WASM_H

#include "base/pool.h"

#include <stddef.h>
#include <stdint.h>

typedef struct Wasm Wasm;

/* A number of any type; which one it is, the module says. */
typedef union WasmCell {
    int32_t i32;
    uint32_t u32;
    int64_t i64;
    uint64_t u64;
    float f32;
    double f64;
} WasmCell;

/* A module of `size` bytes with its memory as it is at first; NULL: *why says what can't be read. */
Wasm *wasm_open(Pool *pool, const void *bytes, size_t size, const char **why);
/* Call an exported function with count arguments in cell[]; its result comes into cell[0]. NULL: good; else why it did
 * not end: there is no such function with so many arguments, or what it did may not be done. */
const char *wasm_call(Wasm *wasm, const char *name, WasmCell *cell, int count);
/* So many bytes of its memory, until the next call; NULL: they are not all in it. */
unsigned char *wasm_memory(Wasm *wasm, uint32_t at, uint64_t size);
/* Numbers in memory have the least byte first. */
uint64_t wasm_load(const unsigned char *byte, int bytes);
void wasm_store(unsigned char *byte, int bytes, uint64_t value);

#endif
