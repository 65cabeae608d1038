/* SPDX-License-Identifier: MIT
 * The interpreter: steps of a function on a stack of cells. Sums, products and so on are those of IEEE 754, which C's
 * are as well without contraction and excess precision; where C leaves something open, the comments say what
 * WebAssembly wants. */
#include "wasm/wasm_private.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

uint64_t wasm_load(const unsigned char *byte, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
        value |= (uint64_t)byte[i] << (8 * i);
    return value;
}

void wasm_store(unsigned char *byte, int bytes, uint64_t value)
{
    for (int i = 0; i < bytes; ++i)
        byte[i] = (unsigned char)(value >> (8 * i));
}

unsigned char *wasm_memory(Wasm *wasm, uint32_t at, uint64_t size)
{
    return size <= (uint64_t)wasm->pages * WASM_PAGE && at <= (uint64_t)wasm->pages * WASM_PAGE - size
               ? wasm->memory + at
               : NULL;
}

/* The bytes of a load or store; NULL: outside of memory. */
static unsigned char *place(Wasm *w, uint32_t base, uint32_t offset, unsigned size)
{
    const uint64_t at = (uint64_t)base + offset;
    return at <= UINT32_MAX ? wasm_memory(w, (uint32_t)at, size) : NULL;
}

static uint32_t grow(Wasm *w, uint32_t more)
{
    const uint32_t before = w->pages;
    if (more > w->most - before)
        return UINT32_MAX;
    if (more)
        w->memory = pool_grow(w->pool, w->memory, (size_t)before * WASM_PAGE, (size_t)(before + more) * WASM_PAGE);
    w->pages += more;
    return before;
}

/* ---- what C leaves open ------------------------------------------------------------------------------------------ */

static uint32_t leading(uint64_t value, uint32_t bits)
{
    uint32_t zeros = 0;
    for (uint32_t i = bits; i-- > 0 && !(value >> i & 1);)
        ++zeros;
    return zeros;
}

static uint32_t trailing(uint64_t value, uint32_t bits)
{
    uint32_t zeros = 0;
    while (zeros < bits && !(value >> zeros & 1))
        ++zeros;
    return zeros;
}

static uint32_t ones(uint64_t value)
{
    uint32_t count = 0;
    for (; value; value &= value - 1)
        ++count;
    return count;
}

static uint64_t turn(uint64_t value, uint64_t by, uint32_t bits)
{
    const uint64_t mask = bits == 64 ? ~(uint64_t)0 : ((uint64_t)1 << bits) - 1;
    by %= bits;
    return by ? (value << by | (value & mask) >> (bits - by)) & mask : value;
}

/* A shift to the right that keeps the sign. */
static int64_t shift_signed(int64_t value, uint64_t by)
{
    return value < 0 ? (int64_t) ~(~(uint64_t)value >> by) : (int64_t)((uint64_t)value >> by);
}

/* NaN where one is; -0 below 0. */
static double least(double a, double b)
{
    if (isnan(a) || isnan(b))
        return a + b;
    return a < b || (a == b && signbit(a)) ? a : b;
}

static double most(double a, double b)
{
    if (isnan(a) || isnan(b))
        return a + b;
    return a > b || (a == b && !signbit(a)) ? a : b;
}

/* Towards zero, into low <= x < high; *good: it is in there. Else the nearest end, and 0 for NaN. */
static double into(double x, double low, double high, double last, bool *good)
{
    const double whole = trunc(x);
    *good = whole >= low && whole < high;
    return *good ? whole : isnan(x) ? 0 : whole < low ? low : last;
}

/* A number as whole one of 32 or 64 bits. *good: it has one; else the nearest end. */
static WasmCell whole_of(double x, bool wide, bool negative, bool *good)
{
    const double two32 = 4294967296.0, two64 = 18446744073709551616.0;
    WasmCell out = {.u64 = 0};
    if (!wide && negative) {
        const double whole = into(x, -two32 / 2, two32 / 2, two32 / 2 - 1, good);
        out.i32 = (int32_t)whole;
    } else if (!wide) {
        const double whole = into(x, 0, two32, two32 - 1, good);
        out.u32 = (uint32_t)whole;
    } else if (negative) {
        const double whole = into(x, -two64 / 2, two64 / 2, NAN, good);
        out.i64 = isnan(whole) ? INT64_MAX : (int64_t)whole;
    } else {
        const double whole = into(x, 0, two64, NAN, good);
        out.u64 = isnan(whole) ? UINT64_MAX : (uint64_t)whole;
    }
    return out;
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

/* Copies and fills of memory by the three cells from `cell` on. */
static bool move_memory(Wasm *w, int op, const WasmCell *cell)
{
    const uint32_t size = cell[2].u32;
    unsigned char *to = wasm_memory(w, cell[0].u32, size);
    const unsigned char *from = op == WASM_MORE_0 + 10 ? wasm_memory(w, cell[1].u32, size) : to;
    if (!to || !from)
        return false;
    if (op == WASM_MORE_0 + 10)
        memmove(to, from, size);
    else
        memset(to, (int)(cell[1].u32 & 0xff), size);
    return true;
}

/* Of loads and stores: bytes, those of the 23 in the order of their numbers. */
static const unsigned char width[] = {4, 8, 4, 8, 1, 1, 2, 2, 1, 1, 2, 2, 4, 4, 4, 8, 4, 8, 1, 2, 1, 2, 4};

/* As wasm_load(), by code without a loop. */
static uint64_t load(const unsigned char *from, int bytes)
{
    return bytes == 8 ? wasm_load(from, 8) : bytes == 4 ? wasm_load(from, 4) : bytes == 2 ? wasm_load(from, 2) : *from;
}

static void store(unsigned char *to, int bytes, uint64_t value)
{
    if (bytes == 8)
        wasm_store(to, 8, value);
    else if (bytes == 4)
        wasm_store(to, 4, value);
    else if (bytes == 2)
        wasm_store(to, 2, value);
    else
        *to = (unsigned char)value;
}

static WasmCell loaded(const unsigned char *from, int op)
{
    const uint64_t bits = load(from, width[op - WASM_LOAD]);
    WasmCell out = {.u64 = bits};
    switch (op) {
    case 0x28: /* i32.load */
    case 0x2a: /* f32.load */
    case 0x2d: /* i32.load8_u */
    case 0x2f: /* i32.load16_u */ out.u32 = (uint32_t)bits; break;
    case 0x2c: /* i32.load8_s */ out.i32 = (int8_t)bits; break;
    case 0x2e: /* i32.load16_s */ out.i32 = (int16_t)bits; break;
    case 0x30: /* i64.load8_s */ out.i64 = (int8_t)bits; break;
    case 0x32: /* i64.load16_s */ out.i64 = (int16_t)bits; break;
    case 0x34: /* i64.load32_s */ out.i64 = (int32_t)bits; break;
    default: break;
    }
    return out;
}

static uint64_t stored(WasmCell value, int op)
{
    return op == 0x36 || op == 0x38 || op == 0x3a || op == 0x3b ? value.u32 : value.u64;
}

/* A division of whole numbers; what it may not do, else NULL. */
static const char *divide(WasmCell *a, WasmCell b, int op)
{
    const bool wide = op >= 0x7f, none = wide ? !b.u64 : !b.u32;
    const bool over = wide ? a->i64 == INT64_MIN && b.i64 == -1 : a->i32 == INT32_MIN && b.i32 == -1;
    if (none)
        return "it divides by zero";
    switch (op) {
    case 0x6d:
    case 0x7f:
        if (over)
            return "a quotient is too large";
        if (wide)
            a->i64 /= b.i64;
        else
            a->i32 /= b.i32;
        break;
    case 0x6e: a->u32 /= b.u32; break;
    case 0x6f: a->i32 = over ? 0 : a->i32 % b.i32; break;
    case 0x70: a->u32 %= b.u32; break;
    case 0x80: a->u64 /= b.u64; break;
    case 0x81: a->i64 = over ? 0 : a->i64 % b.i64; break;
    default: a->u64 %= b.u64;
    }
    return NULL;
}

/* Conversions of numbers into whole ones, those that end the call and those that do not. */
static const char *truncate_number(WasmCell *a, int op)
{
    const bool saturates = op >= WASM_MORE_0;
    const int which = saturates ? op - WASM_MORE_0 : op < 0xae ? op - 0xa8 : op - 0xae + 4;
    bool good;
    *a = whole_of(which & 2 ? a->f64 : a->f32, which >= 4, !(which & 1), &good);
    return good || saturates ? NULL : "a number is no whole one";
}

/* clang-format off */
#define CASE(op, to, expression) case op: a->to = (expression); break;
#define COMPARED(op, of, sign) CASE(op, u32, a->of sign b.of)
/* clang-format on */

/* Numeric instructions: *a becomes the result of itself and of b, which those with one operand do not use. */
static const char *compute(int op, WasmCell *a, WasmCell b)
{
    switch (op) {
        CASE(0x45, u32, !a->u32)
        COMPARED(0x46, u32, ==)
        COMPARED(0x47, u32, !=)
        COMPARED(0x48, i32, <)
        COMPARED(0x49, u32, <)
        COMPARED(0x4a, i32, >)
        COMPARED(0x4b, u32, >)
        COMPARED(0x4c, i32, <=)
        COMPARED(0x4d, u32, <=)
        COMPARED(0x4e, i32, >=)
        COMPARED(0x4f, u32, >=)
        CASE(0x50, u32, !a->u64)
        COMPARED(0x51, u64, ==)
        COMPARED(0x52, u64, !=)
        COMPARED(0x53, i64, <)
        COMPARED(0x54, u64, <)
        COMPARED(0x55, i64, >)
        COMPARED(0x56, u64, >)
        COMPARED(0x57, i64, <=)
        COMPARED(0x58, u64, <=)
        COMPARED(0x59, i64, >=)
        COMPARED(0x5a, u64, >=)
        COMPARED(0x5b, f32, ==)
        COMPARED(0x5c, f32, !=)
        COMPARED(0x5d, f32, <)
        COMPARED(0x5e, f32, >)
        COMPARED(0x5f, f32, <=)
        COMPARED(0x60, f32, >=)
        COMPARED(0x61, f64, ==)
        COMPARED(0x62, f64, !=)
        COMPARED(0x63, f64, <)
        COMPARED(0x64, f64, >)
        COMPARED(0x65, f64, <=)
        COMPARED(0x66, f64, >=)
        CASE(0x67, u32, leading(a->u32, 32))
        CASE(0x68, u32, trailing(a->u32, 32))
        CASE(0x69, u32, ones(a->u32))
        CASE(0x6a, u32, a->u32 + b.u32)
        CASE(0x6b, u32, a->u32 - b.u32)
        CASE(0x6c, u32, a->u32 * b.u32)
        CASE(0x71, u32, a->u32 & b.u32)
        CASE(0x72, u32, a->u32 | b.u32)
        CASE(0x73, u32, a->u32 ^ b.u32)
        CASE(0x74, u32, a->u32 << (b.u32 & 31))
        CASE(0x75, i32, (int32_t)shift_signed(a->i32, b.u32 & 31))
        CASE(0x76, u32, a->u32 >> (b.u32 & 31))
        CASE(0x77, u32, (uint32_t)turn(a->u32, b.u32, 32))
        CASE(0x78, u32, (uint32_t)turn(a->u32, 32 - (b.u32 & 31), 32))
        CASE(0x79, u64, leading(a->u64, 64))
        CASE(0x7a, u64, trailing(a->u64, 64))
        CASE(0x7b, u64, ones(a->u64))
        CASE(0x7c, u64, a->u64 + b.u64)
        CASE(0x7d, u64, a->u64 - b.u64)
        CASE(0x7e, u64, a->u64 * b.u64)
        CASE(0x83, u64, a->u64 & b.u64)
        CASE(0x84, u64, a->u64 | b.u64)
        CASE(0x85, u64, a->u64 ^ b.u64)
        CASE(0x86, u64, a->u64 << (b.u64 & 63))
        CASE(0x87, i64, shift_signed(a->i64, b.u64 & 63))
        CASE(0x88, u64, a->u64 >> (b.u64 & 63))
        CASE(0x89, u64, turn(a->u64, b.u64, 64))
        CASE(0x8a, u64, turn(a->u64, 64 - (b.u64 & 63), 64))
        CASE(0x8b, u32, a->u32 & 0x7fffffff)
        CASE(0x8c, u32, a->u32 ^ 0x80000000)
        CASE(0x8d, f32, ceilf(a->f32))
        CASE(0x8e, f32, floorf(a->f32))
        CASE(0x8f, f32, truncf(a->f32))
        CASE(0x90, f32, nearbyintf(a->f32))
        CASE(0x91, f32, sqrtf(a->f32))
        CASE(0x92, f32, a->f32 + b.f32)
        CASE(0x93, f32, a->f32 - b.f32)
        CASE(0x94, f32, a->f32 * b.f32)
        CASE(0x95, f32, a->f32 / b.f32)
        CASE(0x96, f32, (float)least(a->f32, b.f32))
        CASE(0x97, f32, (float)most(a->f32, b.f32))
        CASE(0x98, u32, (a->u32 & 0x7fffffff) | (b.u32 & 0x80000000))
        CASE(0x99, u64, a->u64 & INT64_MAX)
        CASE(0x9a, u64, a->u64 ^ (uint64_t)1 << 63)
        CASE(0x9b, f64, ceil(a->f64))
        CASE(0x9c, f64, floor(a->f64))
        CASE(0x9d, f64, trunc(a->f64))
        CASE(0x9e, f64, nearbyint(a->f64))
        CASE(0x9f, f64, sqrt(a->f64))
        CASE(0xa0, f64, a->f64 + b.f64)
        CASE(0xa1, f64, a->f64 - b.f64)
        CASE(0xa2, f64, a->f64 * b.f64)
        CASE(0xa3, f64, a->f64 / b.f64)
        CASE(0xa4, f64, least(a->f64, b.f64))
        CASE(0xa5, f64, most(a->f64, b.f64))
        CASE(0xa6, u64, (a->u64 & INT64_MAX) | (b.u64 & (uint64_t)1 << 63))
        CASE(0xa7, u32, (uint32_t)a->u64)
        CASE(0xac, i64, a->i32)
        CASE(0xad, u64, a->u32)
        CASE(0xb2, f32, (float)a->i32)
        CASE(0xb3, f32, (float)a->u32)
        CASE(0xb4, f32, (float)a->i64)
        CASE(0xb5, f32, (float)a->u64)
        CASE(0xb6, f32, (float)a->f64)
        CASE(0xb7, f64, a->i32)
        CASE(0xb8, f64, a->u32)
        CASE(0xb9, f64, (double)a->i64)
        CASE(0xba, f64, (double)a->u64)
        CASE(0xbb, f64, a->f32)
        CASE(0xc0, i32, (int8_t)a->u32)
        CASE(0xc1, i32, (int16_t)a->u32)
        CASE(0xc2, i64, (int8_t)a->u64)
        CASE(0xc3, i64, (int16_t)a->u64)
        CASE(0xc4, i64, (int32_t)a->u64)
    case 0x6d:
    case 0x6e:
    case 0x6f:
    case 0x70:
    case 0x7f:
    case 0x80:
    case 0x81:
    case 0x82: return divide(a, b, op);
    case 0xa8:
    case 0xa9:
    case 0xaa:
    case 0xab:
    case 0xae:
    case 0xaf:
    case 0xb0:
    case 0xb1: return truncate_number(a, op);
    default: /* 0xbc to 0xbf: the same bits under another type */ break;
    }
    return NULL;
}

const char *wasm_play(Wasm *w, uint32_t own, uint32_t at, int depth)
{
    const WasmFunction *function = &w->function[own];
    const WasmType *type = &w->type[function->type];
    if (depth > WASM_MOST_CALLS || at + (uint64_t)function->cells > WASM_MOST_CELLS)
        return "its calls go too deep";
    WasmCell *base = w->stack + at, *top = base + function->locals; /* the first cell that is free */
    memset(base + type->parameters, 0, sizeof *base * (function->locals - (uint32_t)type->parameters));
    const WasmStep *step = w->step + function->first;
    for (;;) {
        const char *why = NULL;
        const int op = step->op;
        switch (op) {
        case WASM_UNREACHABLE: return "it has come where it may not";
        case WASM_IF:
            if ((--top)->u32)
                break;
            step = w->step + step->to;
            continue;
        case WASM_BR_TABLE: {
            const uint32_t which = (--top)->u32;
            step += 1 + (which < step->to ? which : step->to);
            continue;
        }
        case WASM_BR_IF:
            if (!(--top)->u32)
                break;
            /* fall through */
        case WASM_BR:
            if (step->keep)
                base[step->value.u32] = top[-1];
            top = base + step->value.u32 + step->keep;
            step = w->step + step->to;
            continue;
        case WASM_RETURN:
            if (step->keep)
                base[0] = top[-1];
            return NULL;
        case WASM_CALL:
        case WASM_CALL_INDIRECT: {
            uint32_t called = step->to;
            if (op == WASM_CALL_INDIRECT) {
                const uint32_t entry = (--top)->u32;
                called = entry < (uint32_t)w->entries ? w->entry[entry] - 1 : UINT32_MAX;
                if (called == UINT32_MAX || w->function[called].type != step->to)
                    return "it calls what is no such function";
            }
            const WasmType *of = &w->type[w->function[called].type];
            top -= of->parameters;
            why = wasm_play(w, called, (uint32_t)(top - w->stack), depth + 1);
            top += of->results;
            break;
        }
        case WASM_DROP: --top; break;
        case WASM_SELECT:
            top -= 2;
            if (!top[1].u32)
                top[-1] = top[0];
            break;
        case WASM_LOCAL_GET: *top++ = base[step->to]; break;
        case WASM_LOCAL_SET: base[step->to] = *--top; break;
        case WASM_LOCAL_TEE: base[step->to] = top[-1]; break;
        case WASM_GLOBAL_GET: *top++ = w->global[step->to]; break;
        case WASM_GLOBAL_SET: w->global[step->to] = *--top; break;
        case WASM_SIZE: (top++)->u32 = w->pages; break;
        case WASM_GROW: top[-1].u32 = grow(w, top[-1].u32); break;
        case WASM_I32:
        case WASM_I64:
        case WASM_F32:
        case WASM_F64: *top++ = step->value; break;
        case WASM_MORE_0 + 10:
        case WASM_MORE_0 + 11:
            top -= 3;
            if (!move_memory(w, op, top))
                return "it moves what is outside of its memory";
            break;
        default:
            if (op >= WASM_MORE_0)
                why = truncate_number(top - 1, op);
            else if (op >= WASM_NUMERIC) {
                top -= step->keep;
                why = compute(op, top - 1, top[0]);
            } else if (op >= WASM_STORE) {
                top -= 2;
                unsigned char *to = place(w, top[0].u32, step->to, width[op - WASM_LOAD]);
                if (!to)
                    return "it writes outside of its memory";
                store(to, width[op - WASM_LOAD], stored(top[1], op));
            } else {
                const unsigned char *from = place(w, top[-1].u32, step->to, width[op - WASM_LOAD]);
                if (!from)
                    return "it reads outside of its memory";
                top[-1] = loaded(from, op);
            }
        }
        if (why)
            return why;
        ++step;
    }
}

const char *wasm_call(Wasm *w, const char *name, WasmCell *cell, int count)
{
    for (int i = 0; i < w->exports; ++i) {
        const WasmType *type = &w->type[w->function[w->exported[i].function].type];
        if (!*name || strcmp(w->exported[i].name, name) != 0 || type->parameters != count)
            continue;
        memcpy(w->stack, cell, sizeof *cell * (size_t)count);
        const char *why = wasm_play(w, w->exported[i].function, 0, 0);
        if (!why && type->results)
            cell[0] = w->stack[0];
        return why;
    }
    return "there is no such function";
}
