/* SPDX-License-Identifier: MIT
 * target.h on a bare Cortex-M: vectors, start-up, and semihosting for output. The stack is painted before main runs, so
 * that its deepest use can be told afterwards. */
#include "target.h"

#include <stdint.h>

extern uint32_t stack_low[], stack_top[], data_start[], data_end[], data_load[], bss_start[], bss_end[];
int main(void);
void reset(void);
static void fault(void);

enum { SEMIHOSTING_WRITE0 = 4, SEMIHOSTING_EXIT = 0x18, EXIT_GOOD = 0x20026, EXIT_FAULT = 0x20023 };

static const uint32_t paint = 0x6b6b6b6bu;

__attribute__((section(".vectors"), used)) static const struct {
    void *stack;
    void (*handler[15])(void);
} vectors = {stack_top, {reset, fault, fault, fault, fault, fault}};

static void semihosting(int operation, const void *argument)
{
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void reset(void)
{
    /* the floating-point unit is off after reset: coprocessors 10 and 11 */
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20;
    __asm__ volatile("dsb\n isb");
    uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; ++to)
        *to = *from++;
    for (uint32_t *to = bss_start; to < bss_end; ++to)
        *to = 0;
    uint32_t *here;
    __asm__ volatile("mov %0, sp" : "=r"(here));
    for (uint32_t *to = stack_low; to < here - 16; ++to)
        *to = paint;
    target_end(main());
}

static void fault(void)
{
    target_print("fault\n");
    target_end(1);
}

void target_print(const char *text)
{
    semihosting(SEMIHOSTING_WRITE0, text);
}

void target_end(int failed)
{
    const uint32_t *deepest = stack_low;
    uint32_t used;
    char text[] = "stack 0000000000 bytes\n";
    while (*deepest == paint)
        ++deepest;
    used = (uint32_t)(stack_top - deepest) * 4;
    for (int i = 15; i > 5; --i, used /= 10)
        text[i] = (char)('0' + used % 10);
    target_print(text);
    semihosting(SEMIHOSTING_EXIT, (const void *)(failed ? EXIT_FAULT : EXIT_GOOD));
    for (;;) {
    }
}
