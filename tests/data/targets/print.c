/* SPDX-License-Identifier: MIT
 * Numbers by target_print(), without a library. */
#include "target.h"

void print_bits(gic_real value)
{
    static const char digit[] = "0123456789abcdef";
    unsigned char bytes[sizeof value];
    char text[2 * sizeof value + 2];
    unsigned i;
    for (i = 0; i < sizeof value; ++i)
        bytes[i] = ((const unsigned char *)&value)[sizeof value - 1 - i]; /* all targets are little-endian */
    for (i = 0; i < sizeof value; ++i) {
        text[2 * i] = digit[bytes[i] >> 4];
        text[2 * i + 1] = digit[bytes[i] & 15];
    }
    text[2 * i] = '\n';
    text[2 * i + 1] = 0;
    target_print(text);
}

void print_whole(uint32_t value)
{
    char text[] = "0000000000";
    int i;
    for (i = 9; i >= 0; --i, value /= 10)
        text[i] = (char)('0' + value % 10);
    target_print(text);
}
