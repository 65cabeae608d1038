/* SPDX-License-Identifier: MIT
 * Derivatives of the vehicles of a batch: each is taken out of it with MODEL_batch_store() and differentiated by the
 * code for one vehicle. The same bits as of a vehicle that made the same steps by itself, by tangent, jacobian and
 * adjoint.
 *
 *     gcc -DMODEL=car '-DCODE="car_batch.h"' batch.c car.c car_batch.c gic_runtime.c -lm
 */
#include CODE

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(name) JOIN(MODEL, name)

enum { VEHICLES = 6, STEPS = 40 };

static MODEL single[VEHICLES], member;
static OF(_batch) batch;
static OF(_direction) mine, theirs;
static gic_real left[1 << 16], right[1 << 16];

static void seed_direction(OF(_direction) * along, int32_t count)
{
    memset(along, 0, sizeof *along);
    for (int32_t i = 0; i < count; ++i)
        along->state[i] = along->rate[i] = (gic_real)(1 + i % 5);
}

static int differs(const char *what, const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) ? printf("%s is another one\n", what) : 0;
}

int main(void)
{
    const gic_model *const code = &OF(_model);
    const int32_t n = code->slow_count + code->fast_count;
    const size_t rates = (size_t)n * sizeof(gic_real);
    const size_t entries = (size_t)n * (size_t)(n + code->input_count + code->parameter_count + code->port_count);
    int bad = entries > sizeof left / sizeof *left || OF(_batch_setup)(&batch) != GIC_OK;
    for (int i = 0; i < VEHICLES && !bad; ++i) {
        bad |= OF(_setup)(&single[i]) != GIC_OK;
        single[i].state[n - 1] += (gic_real)0.01 * (gic_real)i;
        OF(_batch_load)(&batch, i, &single[i]);
    }
    bad |= OF(_batch_step)(&batch, GIC_R(0.002), GIC_AB3, STEPS) != VEHICLES;
    for (int i = 0; i < VEHICLES && !bad; ++i) {
        for (int k = 0; k < STEPS; ++k)
            bad |= OF(_step)(&single[i], GIC_R(0.002), GIC_AB3) != GIC_OK;
        OF(_batch_store)(&batch, i, &member);
        bad |= differs("state", member.state, single[i].state, rates);
        const gic_real time = gic_time(&member);
        seed_direction(&mine, n);
        seed_direction(&theirs, n);
        bad |= OF(_tangent)(&member, time, member.state, &mine) != GIC_OK;
        bad |= OF(_tangent)(&single[i], time, single[i].state, &theirs) != GIC_OK;
        bad |= differs("tangent", mine.rate, theirs.rate, rates);
        bad |= OF(_jacobian)(&member, time, member.state, &mine, left) != GIC_OK;
        bad |= OF(_jacobian)(&single[i], time, single[i].state, &theirs, right) != GIC_OK;
        bad |= differs("jacobian", left, right, entries * sizeof *left);
        seed_direction(&mine, n);
        seed_direction(&theirs, n);
        bad |= OF(_adjoint)(&member, time, member.state, &mine, left) != GIC_OK;
        bad |= OF(_adjoint)(&single[i], time, single[i].state, &theirs, right) != GIC_OK;
        bad |= differs("adjoint", mine.state, theirs.state, rates);
    }
    /* the batch goes on as if nobody had looked */
    bad |= OF(_batch_step)(&batch, GIC_R(0.002), GIC_AB3, 1) != VEHICLES;
    printf("%s\n", bad ? "not so" : "the same bits");
    return bad != 0;
}
