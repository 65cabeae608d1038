/* SPDX-License-Identifier: MIT
 * target.h on a bare Cortex-M: vectors, start-up, and semihosting for output. The stack is painted before main runs, so
 * that its deepest use can be told afterwards. */
#include "target.h"

extern uint32_t stack_low[], stack_top[], data_start[], data_end[], data_load[], bss_start[], bss_end[];
int main(void);
void reset(void);
static void fault(void);

enum { SEMIHOSTING_WRITE0 = 4, SEMIHOSTING_EXIT = 0x18, EXIT_GOOD = 0x20026, EXIT_FAULT = 0x20023 };

enum { SYSTICK_ON = 5 /* at the processor's clock */, SYSTICK_ALL = 0xffffff };
static volatile uint32_t *const systick = (volatile uint32_t *)0xe000e010u; /* control, first value, value */

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
    systick[1] = SYSTICK_ALL;
    systick[2] = 0;
    systick[0] = SYSTICK_ON;
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

/* By SysTick, which counts 25 MHz down: under `qemu -icount shift=0` an instruction takes 1 ns, so that a count is 40
 * of them. */
uint32_t target_instructions(void)
{
    static uint32_t last, count;
    const uint32_t now = systick[2];
    count += ((last - now) & SYSTICK_ALL) * 40;
    last = now;
    return count;
}

void target_loop(void)
{
    __asm__ volatile("mov r0, %0\n1: subs r0, #1\n bne 1b" : : "r"(TARGET_LOOP / 2) : "r0", "cc");
}

void target_end(int failed)
{
    const uint32_t *deepest = stack_low;
    while (*deepest == paint)
        ++deepest;
    target_print("stack ");
    print_whole((uint32_t)(stack_top - deepest) * 4);
    target_print(" bytes\n");
    semihosting(SEMIHOSTING_EXIT, (const void *)(failed ? EXIT_FAULT : EXIT_GOOD));
    for (;;) {
    }
}
