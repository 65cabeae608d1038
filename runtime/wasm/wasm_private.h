/* SPDX-License-Identifier: MIT
 *
 * Shared by the files of wasm: a module that has been read. Instructions have the numbers of WebAssembly 1.0. */
#ifndef WASM_WASM_PRIVATE_H
#define WASM_WASM_PRIVATE_H

#include "wasm/wasm.h"

#include <stdbool.h>

enum {
    WASM_PAGE = 65536,
    WASM_MOST_PAGES = 16384,      /* of 65536 that there may be: 1 GB */
    WASM_MOST_CALLS = 1000,       /* one in another */
    WASM_MOST_CELLS = 1024 * 1024 /* of the stack */
};

/* Instructions that have operands in the module; those from I32_EQZ on are in play.c. */
enum {
    WASM_UNREACHABLE,
    WASM_NOP,
    WASM_BLOCK,
    WASM_LOOP,
    WASM_IF,
    WASM_ELSE,
    WASM_END = 0x0b,
    WASM_BR,
    WASM_BR_IF,
    WASM_BR_TABLE,
    WASM_RETURN,
    WASM_CALL,
    WASM_CALL_INDIRECT,
    WASM_DROP = 0x1a,
    WASM_SELECT,
    WASM_LOCAL_GET = 0x20,
    WASM_LOCAL_SET,
    WASM_LOCAL_TEE,
    WASM_GLOBAL_GET,
    WASM_GLOBAL_SET,
    WASM_LOAD = 0x28,
    WASM_STORE = 0x36,
    WASM_SIZE = 0x3f,
    WASM_GROW,
    WASM_I32,
    WASM_I64,
    WASM_F32,
    WASM_F64,
    WASM_NUMERIC,
    WASM_NUMERIC_END = 0xc5,
    WASM_MORE = 0xfc,   /* a prefix */
    WASM_MORE_0 = 0x100 /* what follows the prefix is counted from here */
};

/* One to be carried out: branches know where they go, and blocks are gone. */
typedef struct WasmStep {
    uint16_t op;
    uint16_t
        keep;    /* of branches and of WASM_RETURN: cells that stay on top, 0 or 1; of numeric ones: operands but one */
    uint32_t to; /* of branches: the step; of others the index or offset */
    WasmCell value; /* of constants; of branches u32: height that the stack is cut to, from the function's first cell */
} WasmStep;

typedef struct WasmType {
    int parameters, results;
    const unsigned char *kind; /* [parameters + results] */
} WasmType;

typedef struct WasmFunction {
    uint32_t type;
    uint32_t first;         /* step */
    uint32_t locals, cells; /* with parameters; of locals and operands at most */
} WasmFunction;

typedef struct WasmExport {
    const char *name;
    uint32_t function;
} WasmExport;

struct Wasm {
    Pool *pool;
    int types, functions, globals, exports, steps, entries;
    WasmType *type;
    WasmFunction *function;
    WasmCell *global;
    WasmExport *exported;
    WasmStep *step;
    uint32_t *entry; /* [entries] of the table: function + 1, 0: none */
    unsigned char *memory;
    uint32_t pages, most;
    WasmCell *stack; /* [WASM_MOST_CELLS] */
};

/* Call a function whose arguments stand at the stack's cell `at`, where its result comes. NULL: good. */
const char *wasm_play(Wasm *wasm, uint32_t function, uint32_t at, int depth);

#endif
