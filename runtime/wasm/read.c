/* SPDX-License-Identifier: MIT
 * Reading of a module: sections one after another, and bodies of functions as steps. Whatever is wrong is noted once;
 * from then on nothing but zeros is read, so that reading ends. */
#include "wasm/wasm_private.h"

#include <string.h>

typedef struct Reader {
    Wasm *w;
    Pool *pool;
    const unsigned char *at, *end;
    const char *why; /* NULL: good so far */
} Reader;

/* A block that is open. */
typedef struct Block {
    int op;
    uint32_t height, start; /* cells below it; step at which a loop begins */
    uint16_t keep;          /* its result: cells */
    int waiting, otherwise; /* the last of the steps that go to its end, a chain by `to`; of an `if`: the step that goes
                             * to its `else`; -1: none */
} Block;

/* A function's body, as it is read. */
typedef struct Body {
    WasmFunction *function;
    Block *block;
    int blocks;
    uint32_t height;
    int dead; /* blocks that are never reached are open, or 1: up to the end of the innermost one; 0: none */
} Body;

static void wrong(Reader *r, const char *why)
{
    if (!r->why)
        r->why = why;
    r->at = r->end;
}

static unsigned char byte(Reader *r)
{
    if (r->at < r->end)
        return *r->at++;
    wrong(r, "it ends too early");
    return 0;
}

/* A whole number in parts of 7 bits. */
static uint64_t whole(Reader *r, bool negative)
{
    uint64_t value = 0;
    for (int shift = 0; shift < 70; shift += 7) {
        const unsigned char part = byte(r);
        value |= shift < 64 ? (uint64_t)(part & 0x7f) << shift : 0;
        if (part & 0x80)
            continue;
        if (negative && (part & 0x40) && shift + 7 < 64)
            value |= ~(uint64_t)0 << (shift + 7);
        return value;
    }
    wrong(r, "a number is too long");
    return 0;
}

static uint32_t index_of(Reader *r)
{
    const uint64_t value = whole(r, false);
    if (value > UINT32_MAX)
        wrong(r, "a number is too large");
    return value > UINT32_MAX ? 0 : (uint32_t)value;
}

/* How many things follow, each of a byte at least. */
static int count_of(Reader *r)
{
    const uint32_t count = index_of(r);
    if (count <= (size_t)(r->end - r->at) && count < 1 << 24)
        return (int)count;
    wrong(r, "it has fewer bytes than things");
    return 0;
}

static const unsigned char *bytes_of(Reader *r, uint32_t count)
{
    const unsigned char *here = r->at;
    if (count > (size_t)(r->end - r->at)) {
        wrong(r, "it ends too early");
        return NULL;
    }
    r->at += count;
    return here;
}

static uint64_t fixed(Reader *r, int count)
{
    const unsigned char *here = bytes_of(r, (uint32_t)count);
    return here ? wasm_load(here, count) : 0;
}

/* ---- sections but code ------------------------------------------------------------------------------------------- */

static bool same_type(const WasmType *a, const WasmType *b)
{
    return a->parameters == b->parameters && a->results == b->results &&
           !memcmp(a->kind, b->kind, (size_t)(a->parameters + a->results));
}

static void read_types(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        WasmType type = {0};
        if (byte(r) != 0x60)
            wrong(r, "it has types that are no functions");
        type.parameters = count_of(r);
        const unsigned char *from = bytes_of(r, (uint32_t)type.parameters);
        type.results = count_of(r);
        const unsigned char *to = bytes_of(r, (uint32_t)type.results);
        if (type.results > 1)
            wrong(r, "it has functions with several results");
        if (r->why)
            return;
        unsigned char *kind = pool_alloc(r->pool, (size_t)(type.parameters + type.results) + 1);
        memcpy(kind, from, (size_t)type.parameters);
        memcpy(kind + type.parameters, to, (size_t)type.results);
        type.kind = kind;
        *POOL_PUSH(r->pool, r->w->type, r->w->types) = type;
    }
}

/* The index of a type; equal types have that of the first. */
static uint32_t type_of(Reader *r)
{
    const uint32_t type = index_of(r);
    if (type >= (uint32_t)r->w->types) {
        wrong(r, "a function has no type");
        return 0;
    }
    for (uint32_t i = 0; i < type; ++i)
        if (same_type(&r->w->type[i], &r->w->type[type]))
            return i;
    return type;
}

static void read_functions(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left)
        *POOL_PUSH(r->pool, r->w->function, r->w->functions) = (WasmFunction){.type = type_of(r)};
}

/* Sizes of a memory or table, at first and at most. */
static void read_limits(Reader *r, uint32_t *least, uint32_t *most)
{
    const unsigned char flags = byte(r);
    *least = index_of(r);
    const uint32_t bound = flags ? index_of(r) : *most;
    *most = bound < *most ? bound : *most;
    if (flags > 1)
        wrong(r, "its memory or table is of an unknown kind");
}

static void read_table(Reader *r)
{
    uint32_t least = 0, most = 1 << 20;
    const int count = count_of(r);
    if (count > 1 || (count && byte(r) != 0x70))
        wrong(r, "it has several tables, or one of things that are no functions");
    if (count)
        read_limits(r, &least, &most);
    if (least > most)
        wrong(r, "its table is too large");
    if (r->why)
        return;
    r->w->entries = (int)least;
    r->w->entry = pool_alloc(r->pool, sizeof *r->w->entry * ((size_t)least + 1));
}

static void read_memory(Reader *r)
{
    uint32_t least = 0, most = WASM_MOST_PAGES;
    const int count = count_of(r);
    if (count > 1)
        wrong(r, "it has several memories");
    if (count)
        read_limits(r, &least, &most);
    if (least > WASM_MOST_PAGES)
        wrong(r, "its memory is too large");
    if (r->why)
        return;
    r->w->pages = least;
    r->w->most = most < WASM_MOST_PAGES ? most : WASM_MOST_PAGES;
    r->w->memory = pool_alloc(r->pool, (size_t)least * WASM_PAGE + 1);
}

/* What stands after an instruction for a constant. */
static WasmCell literal(Reader *r, int op)
{
    WasmCell value = {.u64 = 0};
    if (op == WASM_I32)
        value.u32 = (uint32_t)whole(r, true);
    else if (op == WASM_I64)
        value.u64 = whole(r, true);
    else if (op == WASM_F32)
        value.u32 = (uint32_t)fixed(r, 4);
    else
        value.u64 = fixed(r, 8);
    return value;
}

/* A constant, or the value of a global. */
static WasmCell constant(Reader *r)
{
    WasmCell value = {.u64 = 0};
    const unsigned char op = byte(r);
    if (op >= WASM_I32 && op <= WASM_F64)
        value = literal(r, op);
    else if (op == WASM_GLOBAL_GET) {
        const uint32_t global = index_of(r);
        if (global < (uint32_t)r->w->globals)
            value = r->w->global[global];
        else
            wrong(r, "a constant is that of no global");
    } else
        wrong(r, "a constant is computed in an unknown way");
    if (byte(r) != WASM_END)
        wrong(r, "a constant is computed in an unknown way");
    return value;
}

static void read_globals(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        byte(r); /* type */
        byte(r); /* may it change? */
        const WasmCell value = constant(r);
        *POOL_PUSH(r->pool, r->w->global, r->w->globals) = value;
    }
}

static void read_exports(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        const uint32_t length = index_of(r);
        const unsigned char *name = bytes_of(r, length);
        const unsigned char kind = byte(r);
        const uint32_t own = index_of(r);
        if (r->why || kind != 0)
            continue;
        if (own >= (uint32_t)r->w->functions)
            wrong(r, "it exports a function that it lacks");
        else
            *POOL_PUSH(r->pool, r->w->exported, r->w->exports) =
                (WasmExport){pool_print(r->pool, "%.*s", (int)length, (const char *)name), own};
    }
}

static void read_entries(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        if (index_of(r) != 0)
            wrong(r, "its table is filled in an unknown way");
        uint32_t at = constant(r).u32;
        for (int more = count_of(r); more > 0 && !r->why; --more, ++at) {
            const uint32_t own = index_of(r);
            if (at >= (uint32_t)r->w->entries || own >= (uint32_t)r->w->functions)
                wrong(r, "its table has no room for its functions");
            else
                r->w->entry[at] = own + 1;
        }
    }
}

static void read_data(Reader *r)
{
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        const uint32_t kind = index_of(r);
        if (kind != 0 && !(kind == 2 && index_of(r) == 0))
            wrong(r, "its memory is filled in an unknown way");
        const uint32_t at = constant(r).u32, size = index_of(r);
        const unsigned char *from = bytes_of(r, size);
        unsigned char *to = wasm_memory(r->w, at, size);
        if (!to)
            wrong(r, "its memory has no room for its data");
        if (!r->why && size)
            memcpy(to, from, size);
    }
}

/* ---- code -------------------------------------------------------------------------------------------------------- */

static int put(Reader *r, const Body *b, WasmStep step)
{
    if (b->dead)
        return -1;
    *POOL_PUSH(r->pool, r->w->step, r->w->steps) = step;
    return r->w->steps - 1;
}

/* Cells that come off the stack, and those that go onto it. */
static void moves(Reader *r, Body *b, uint32_t off, uint32_t on)
{
    if (b->dead)
        return;
    if (b->height < b->block[b->blocks - 1].height + off) {
        wrong(r, "a function takes more from the stack than there is");
        return;
    }
    b->height += on - off;
    if (b->height > b->function->cells)
        b->function->cells = b->height;
}

/* What follows is not reached until the block ends. */
static void stops(Body *b)
{
    if (!b->dead)
        b->dead = 1;
}

static void opens(Reader *r, Body *b, int op)
{
    const unsigned char kind = byte(r);
    if (kind != 0x40 && (kind < 0x7c || kind > 0x7f))
        wrong(r, "it has blocks of an unknown type");
    if (b->dead) {
        ++b->dead;
        return;
    }
    int otherwise = -1;
    if (op == WASM_IF) {
        moves(r, b, 1, 0);
        otherwise = put(r, b, (WasmStep){.op = WASM_IF});
    }
    *POOL_PUSH(r->pool, b->block, b->blocks) =
        (Block){op, b->height, (uint32_t)r->w->steps, kind != 0x40, -1, otherwise};
}

/* A branch out of the block that is the `depth`th from within. */
static void branches(Reader *r, Body *b, int op, uint32_t depth)
{
    if (depth >= (uint32_t)b->blocks) {
        if (!b->dead)
            wrong(r, "a branch goes to no block");
        return;
    }
    Block *block = &b->block[(uint32_t)b->blocks - 1 - depth];
    const bool back = block->op == WASM_LOOP;
    WasmStep step = {.op = (uint16_t)op, .keep = back ? 0 : block->keep, .value.u32 = block->height};
    step.to = back ? block->start : (uint32_t)block->waiting;
    const int own = put(r, b, step);
    if (own >= 0 && !back)
        block->waiting = own;
}

static void otherwise(Reader *r, Body *b)
{
    if (b->dead > 1)
        return;
    Block *block = &b->block[b->blocks - 1];
    if (block->op != WASM_IF || block->otherwise < 0) {
        wrong(r, "an else has no if");
        return;
    }
    branches(r, b, WASM_BR, 0);
    r->w->step[block->otherwise].to = (uint32_t)r->w->steps;
    block->otherwise = -1;
    b->dead = 0;
    b->height = block->height;
}

static void closes(Reader *r, Body *b)
{
    if (b->dead > 1) {
        --b->dead;
        return;
    }
    const Block block = b->block[--b->blocks];
    if (!b->dead && b->height != block.height + block.keep)
        wrong(r, "a block leaves more or less on the stack than it says");
    for (int i = block.waiting, next; i >= 0; i = next) {
        next = (int)r->w->step[i].to;
        r->w->step[i].to = (uint32_t)r->w->steps;
    }
    if (block.otherwise >= 0)
        r->w->step[block.otherwise].to = (uint32_t)r->w->steps;
    b->dead = 0;
    b->height = block.height + block.keep;
    if (b->height > b->function->cells)
        b->function->cells = b->height;
}

static void chooses(Reader *r, Body *b)
{
    const int count = count_of(r);
    moves(r, b, 1, 0);
    put(r, b, (WasmStep){.op = WASM_BR_TABLE, .to = (uint32_t)count});
    for (int i = 0; i <= count && !r->why; ++i)
        branches(r, b, WASM_BR, index_of(r));
    stops(b);
}

static void calls(Reader *r, Body *b, int op)
{
    uint32_t own, type;
    if (op == WASM_CALL) {
        own = index_of(r);
        if (own >= (uint32_t)r->w->functions) {
            wrong(r, "it calls a function that it lacks");
            return;
        }
        type = r->w->function[own].type;
    } else {
        own = type = type_of(r);
        if (index_of(r) != 0 || r->why) {
            wrong(r, "it calls by another table");
            return;
        }
        moves(r, b, 1, 0);
    }
    moves(r, b, (uint32_t)r->w->type[type].parameters, (uint32_t)r->w->type[type].results);
    put(r, b, (WasmStep){.op = (uint16_t)op, .to = own});
}

static void variables(Reader *r, Body *b, int op)
{
    const uint32_t own = index_of(r);
    const bool local = op <= WASM_LOCAL_TEE;
    if (own >= (local ? b->function->locals : (uint32_t)r->w->globals))
        wrong(r, "a variable is not there");
    const bool set = op == WASM_LOCAL_SET || op == WASM_GLOBAL_SET, tee = op == WASM_LOCAL_TEE;
    moves(r, b, set || tee, !set);
    put(r, b, (WasmStep){.op = (uint16_t)op, .to = own});
}

static void accesses(Reader *r, Body *b, int op)
{
    index_of(r); /* alignment */
    const uint32_t offset = index_of(r);
    moves(r, b, op < WASM_STORE ? 1 : 2, op < WASM_STORE);
    put(r, b, (WasmStep){.op = (uint16_t)op, .to = offset});
}

static void constants(Reader *r, Body *b, int op)
{
    const WasmCell value = literal(r, op);
    moves(r, b, 0, 1);
    put(r, b, (WasmStep){.op = (uint16_t)op, .value = value});
}

/* What follows the prefix: conversions that saturate, copies and fills. */
static void more(Reader *r, Body *b)
{
    enum { CONVERSIONS = 8, COPY = 10, FILL = 11 };
    const uint32_t op = index_of(r);
    if (op == COPY || op == FILL)
        for (uint32_t i = COPY; i <= COPY + (op == COPY); ++i)
            if (byte(r) != 0)
                wrong(r, "it has several memories");
    if (op >= CONVERSIONS && op != COPY && op != FILL)
        wrong(r, "it has an unknown instruction");
    moves(r, b, op < CONVERSIONS ? 1 : 3, op < CONVERSIONS);
    put(r, b, (WasmStep){.op = (uint16_t)(WASM_MORE_0 + op)});
}

/* Operands of numeric instructions: two but for those that test, round and convert. */
static uint32_t operands(int op)
{
    static const struct {
        int first, last;
    } unary[] = {{0x45, 0x45}, {0x50, 0x50}, {0x67, 0x69}, {0x79, 0x7b}, {0x8b, 0x91}, {0x99, 0x9f}, {0xa7, 0xc4}};
    for (size_t i = 0; i < sizeof unary / sizeof *unary; ++i)
        if (op >= unary[i].first && op <= unary[i].last)
            return 1;
    return 2;
}

static void simple(Reader *r, Body *b, int op)
{
    const bool numeric = op >= WASM_NUMERIC && op < WASM_NUMERIC_END;
    if (op == WASM_DROP)
        moves(r, b, 1, 0);
    else if (op == WASM_SELECT)
        moves(r, b, 3, 1);
    else if (op == WASM_SIZE || op == WASM_GROW) {
        if (byte(r) != 0)
            wrong(r, "it has several memories");
        moves(r, b, op == WASM_GROW, 1);
    } else if (numeric)
        moves(r, b, operands(op), 1);
    else if (op != WASM_UNREACHABLE && op != WASM_NOP)
        wrong(r, "it has an unknown instruction");
    if (op != WASM_NOP)
        put(r, b, (WasmStep){.op = (uint16_t)op, .keep = numeric && operands(op) == 2});
    if (op == WASM_UNREACHABLE)
        stops(b);
}

static void instruction(Reader *r, Body *b)
{
    const int op = byte(r);
    if (op == WASM_BLOCK || op == WASM_LOOP || op == WASM_IF)
        opens(r, b, op);
    else if (op == WASM_ELSE)
        otherwise(r, b);
    else if (op == WASM_END)
        closes(r, b);
    else if (op == WASM_BR || op == WASM_BR_IF) {
        moves(r, b, op == WASM_BR_IF, 0);
        branches(r, b, op, index_of(r));
        if (op == WASM_BR)
            stops(b);
    } else if (op == WASM_BR_TABLE)
        chooses(r, b);
    else if (op == WASM_RETURN) {
        branches(r, b, WASM_BR, (uint32_t)b->blocks - 1);
        stops(b);
    } else if (op == WASM_CALL || op == WASM_CALL_INDIRECT)
        calls(r, b, op);
    else if (op >= WASM_LOCAL_GET && op <= WASM_GLOBAL_SET)
        variables(r, b, op);
    else if (op >= WASM_LOAD && op < WASM_SIZE)
        accesses(r, b, op);
    else if (op >= WASM_I32 && op <= WASM_F64)
        constants(r, b, op);
    else if (op == WASM_MORE)
        more(r, b);
    else
        simple(r, b, op);
}

static void read_body(Reader *r, WasmFunction *function)
{
    const WasmType *type = &r->w->type[function->type];
    const uint32_t size = index_of(r);
    const unsigned char *end = r->at + (size <= (size_t)(r->end - r->at) ? size : 0);
    uint64_t locals = (uint64_t)type->parameters;
    for (int left = count_of(r); left > 0 && !r->why; --left) {
        locals += index_of(r);
        byte(r); /* type */
        if (locals > 50000)
            wrong(r, "a function has too many variables");
    }
    Body body = {.function = function, .height = (uint32_t)locals};
    function->locals = function->cells = (uint32_t)locals;
    function->first = (uint32_t)r->w->steps;
    *POOL_PUSH(r->pool, body.block, body.blocks) =
        (Block){WASM_BLOCK, (uint32_t)locals, function->first, (uint16_t)type->results, -1, -1};
    while (body.blocks && !r->why)
        instruction(r, &body);
    put(r, &body, (WasmStep){.op = WASM_RETURN, .keep = (uint16_t)type->results});
    if (r->at != end)
        wrong(r, "a function does not end where it says");
}

static void read_code(Reader *r)
{
    if (count_of(r) != r->w->functions)
        wrong(r, "it has other functions than it says");
    for (int i = 0; i < r->w->functions && !r->why; ++i)
        read_body(r, &r->w->function[i]);
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static void read_start(Reader *r)
{
    const uint32_t own = index_of(r);
    if (own >= (uint32_t)r->w->functions)
        wrong(r, "it starts with a function that it lacks");
    if (!r->why)
        *POOL_PUSH(r->pool, r->w->exported, r->w->exports) = (WasmExport){"", own};
}

static void read_imports(Reader *r)
{
    if (count_of(r))
        wrong(r, "it imports something");
}

static void read_sections(Reader *r)
{
    static void (*const section[])(Reader *) = {NULL,       read_types,   read_imports, read_functions,
                                                read_table, read_memory,  read_globals, read_exports,
                                                read_start, read_entries, read_code,    read_data};
    const unsigned char *end = r->end;
    unsigned last = 0;
    while (r->at < end && !r->why) {
        const unsigned char kind = byte(r);
        const uint32_t size = index_of(r);
        const unsigned char *next = bytes_of(r, size);
        if (r->why || kind == 0 || kind == 12) /* names; the number of data */
            continue;
        if (kind >= sizeof section / sizeof *section || kind <= last) {
            wrong(r, "its sections are not those of a module");
            return;
        }
        last = kind;
        r->at = next;
        r->end = next + size;
        section[kind](r);
        if (!r->why && r->at != r->end)
            wrong(r, "a section does not end where it says");
        r->end = end;
    }
}

Wasm *wasm_open(Pool *pool, const void *bytes, size_t size, const char **why)
{
    static const unsigned char head[] = {0, 'a', 's', 'm', 1, 0, 0, 0};
    Wasm *w = pool_alloc(pool, sizeof *w);
    Reader r = {.w = w, .pool = pool, .at = bytes, .end = (const unsigned char *)bytes + size};
    *why = "it is no module of WebAssembly";
    if (size < sizeof head || memcmp(bytes, head, sizeof head) != 0)
        return NULL;
    w->pool = pool;
    r.at += sizeof head;
    w->memory = pool_alloc(pool, 1);
    read_sections(&r);
    if (!r.why && w->functions && !w->steps)
        r.why = "it has no code";
    *why = r.why;
    if (r.why)
        return NULL;
    w->stack = pool_alloc(pool, sizeof *w->stack * WASM_MOST_CELLS);
    for (int i = 0; i < w->exports; ++i)
        if (!*w->exported[i].name && (*why = wasm_play(w, w->exported[i].function, 0, 0)))
            return NULL;
    return w;
}
