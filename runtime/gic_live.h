/* SPDX-License-Identifier: MIT
 *
 * gic_live: packets of gicrun --live, models/LIVE.md section 2, for programs that drive a vehicle there. C99 or C++,
 * for any processor; nothing to link. A packet is a head and what follows it: numbers, or text. */
#ifndef GIC_LIVE_H
#define GIC_LIVE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum {
    GIC_LIVE_VERSION = 1,
    GIC_LIVE_HEAD = 40,    /* bytes */
    GIC_LIVE_MOST = 65507, /* bytes of a packet */
    /* kinds of packets: to gicrun, and from it */
    GIC_LIVE_ASK = 'A',
    GIC_LIVE_INPUTS = 'I',
    GIC_LIVE_NAMES = 'N',
    GIC_LIVE_OUTPUTS = 'O',
    /* flags of inputs: the scene may drive again; rates and accelerations of driven coordinates are the sender's */
    GIC_LIVE_BACK = 1,
    GIC_LIVE_EXACT = 2,
    /* flags of outputs: inputs of packets are held; the run is over; this step missed its deadline */
    GIC_LIVE_HELD = 1,
    GIC_LIVE_OVER = 2,
    GIC_LIVE_MISSED = 4
};

typedef struct gic_live_head {
    int kind;
    unsigned flags;
    uint64_t number;  /* of inputs: rising; of outputs: steps so far */
    uint64_t hash;    /* of the names */
    uint64_t echo;    /* of outputs: the number of the last inputs that were taken */
    uint32_t count;   /* numbers that follow, or bytes of text */
    uint32_t dropped; /* of outputs: packets dropped so far */
} gic_live_head;

static inline void gic_live_put(unsigned char *at, uint64_t value, int bytes)
{
    int i;
    for (i = 0; i < bytes; ++i)
        at[i] = (unsigned char)(value >> 8 * i & 255);
}

static inline uint64_t gic_live_get(const unsigned char *at, int bytes)
{
    uint64_t value = 0;
    int i;
    for (i = 0; i < bytes; ++i)
        value |= (uint64_t)at[i] << 8 * i;
    return value;
}

/* Write a head into the first GIC_LIVE_HEAD bytes of a packet. */
static inline void gic_live_put_head(unsigned char *packet, const gic_live_head *head)
{
    memcpy(packet, "gic", 3);
    packet[3] = (unsigned char)head->kind;
    gic_live_put(packet + 4, GIC_LIVE_VERSION, 2);
    gic_live_put(packet + 6, head->flags, 2);
    gic_live_put(packet + 8, head->number, 8);
    gic_live_put(packet + 16, head->hash, 8);
    gic_live_put(packet + 24, head->echo, 8);
    gic_live_put(packet + 32, head->count, 4);
    gic_live_put(packet + 36, head->dropped, 4);
}

/* Read the head of a packet of `size` bytes; 0: it is no packet of this version. */
static inline int gic_live_get_head(const unsigned char *packet, size_t size, gic_live_head *head)
{
    if (size < GIC_LIVE_HEAD || memcmp(packet, "gic", 3) != 0 || gic_live_get(packet + 4, 2) != GIC_LIVE_VERSION)
        return 0;
    head->kind = packet[3];
    head->flags = (unsigned)gic_live_get(packet + 6, 2);
    head->number = gic_live_get(packet + 8, 8);
    head->hash = gic_live_get(packet + 16, 8);
    head->echo = gic_live_get(packet + 24, 8);
    head->count = (uint32_t)gic_live_get(packet + 32, 4);
    head->dropped = (uint32_t)gic_live_get(packet + 36, 4);
    return 1;
}

/* Number i after the head. */
static inline void gic_live_put_number(unsigned char *packet, uint32_t i, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    gic_live_put(packet + GIC_LIVE_HEAD + 8 * (size_t)i, bits, 8);
}

static inline double gic_live_get_number(const unsigned char *packet, uint32_t i)
{
    const uint64_t bits = gic_live_get(packet + GIC_LIVE_HEAD + 8 * (size_t)i, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The hash of the names, FNV-1a of 64 bits. */
static inline uint64_t gic_live_hash(const char *text, size_t size)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    size_t i;
    for (i = 0; i < size; ++i)
        hash = (hash ^ (unsigned char)text[i]) * UINT64_C(1099511628211);
    return hash;
}

#endif
