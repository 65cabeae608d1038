#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lock.sh GICGEN GICRUN: a block under dry friction and a wheel with a brake slide, come to rest, are held and
# break loose: closed solutions where there are any, an integration from kink to kink elsewhere; every integrator, to
# 1e-10. Friction is regularized in both: the solutions are those of the regularized laws, which
# tests/data/lock/lock.py states.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

cp "$root/tests/data/lock/lock.veh" .
python3 "$root/tests/data/lock/lock.py" "$gicrun" lock.veh >said
verdict $? "slides, is held, breaks loose"
tail -n 1 said

# Snapshots while it slides, at the end of that, held and loose: a copy of the instance goes on to the same last bit, by
# either method, in either precision.
cp "$root"/runtime/gic_runtime.[ch] .
cat >snapshot.c <<'END'
#include "lock.h"
#include <stdio.h>
#include <string.h>

static lock first, copy;

static int step(lock *instance, int ratio)
{
    return (ratio ? gic_step_dual(&lock_model, instance, GIC_R(0.01), ratio)
                  : gic_step(&lock_model, instance, GIC_R(0.01), GIC_RK4)) != GIC_OK;
}

int main(void)
{
    int bad = 0, ways[] = {0, 1, 5};
    for (int way = 0; way < 3; ++way)
        for (int taken = 0; taken < 240; taken += 5) {
            memset(&first, 0, sizeof first);
            bad += lock_setup(&first) != GIC_OK;
            first.state[LOCK_STATE_X_RATE] = GIC_R(0.5375);
            first.state[LOCK_STATE_WHEEL_SPIN] = GIC_R(0.46875);
            first.state[LOCK_STATE_WHEEL_BRAKE] = 1;
            for (int k = 0; k < 250; ++k) {
                if (k == taken)
                    memcpy(&copy, &first, sizeof first);
                bad += step(&first, ways[way]);
                if (k >= taken)
                    bad += step(&copy, ways[way]) + (memcmp(&first, &copy, sizeof first) != 0);
            }
        }
    printf("%d bad\n", bad);
    return bad != 0;
}
END
"$gicgen" lock.veh -o lock.c >out 2>err
for real in '' -DGIC_FLOAT; do
    # shellcheck disable=SC2086  # nothing or one word
    cc -std=c99 -Wall -Wextra -Werror -O1 $real snapshot.c lock.c gic_runtime.c -lm -o snapshot >out 2>err &&
        ./snapshot >said
    verdict $? "snapshots $real"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
