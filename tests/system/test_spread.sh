#!/bin/sh
# SPDX-License-Identifier: MIT
# test_spread.sh GICGEN GICRUN: Jacobians that steps make by shares: the whole from pieces has the bits of the whole, orders stay, a copy
# in the middle of shares goes on with the same bits; steps that check themselves make no shares.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
cat >spread.c <<'END'
#include <math.h>
#include <stdio.h>
#include <string.h>
#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)
enum { STATES = sizeof((MODEL *)0)->state / sizeof(gic_real) };
static MODEL car, copy;
static int failed;
static void begin(int keep)
{
    failed += JOIN(MODEL, _setup)(&car) != GIC_OK;
    car.implicit.keep = keep;
#ifdef SPREAD
    car.implicit.spread = 1;
#endif
}
static void run(gic_method method, int steps, int keep)
{
    begin(keep);
    for (int i = 0; i < steps; ++i)
        failed += JOIN(MODEL, _step)(&car, 0.128 / steps, method) != GIC_OK;
}
static double off(const gic_real *right)
{
    double most = 0;
    for (int i = 0; i < STATES; ++i)
        most = fmax(most, fabs(car.state[i] - right[i]));
    return most;
}
int main(void)
{
    static const gic_method method[] = {GIC_ROS2, GIC_ROS3, GIC_IMEX};
    static const int order[] = {2, 3, 2}, keep[] = {2, 9, 33};
    static gic_real right[STATES];
    run(GIC_RK4, 8192, 1);
    memcpy(right, car.state, sizeof right);
    for (int m = 0; m < 3; ++m) {
        run(method[m], 64, 1);
        for (int i = 0; i < STATES; ++i)
            printf("%a\n", (double)car.state[i]);
        for (int k = 0; k < 3; ++k) {
            run(method[m], 128, keep[k]);
            const double coarse = off(right);
            run(method[m], 512, keep[k]);
            const double slope = log2(coarse / off(right)) / 2;
            if (!(slope > order[m] - 0.25))
                failed += fprintf(stderr, "method %d, keep %d: order %g\n", (int)method[m], keep[k], slope);
            if (car.implicit.jacobian_count > 512 / keep[k] + 3)
                failed += fprintf(stderr, "too many Jacobians\n");
        }
        for (int at = 18; at < 40; at += 3) {
            begin(16);
            for (int i = 0; i < 60; ++i) {
                if (i == at)
                    copy = car;
                failed += JOIN(MODEL, _step)(&car, 0.001, method[m]) != GIC_OK;
            }
            for (int i = at; i < 60; ++i)
                failed += JOIN(MODEL, _step)(&copy, 0.001, method[m]) != GIC_OK;
            failed += memcmp(copy.state, car.state, sizeof car.state) != 0;
        }
        /* steps that check themselves make no shares, and rounds end in time */
        begin(16);
        int checks = 0;
        for (int i = 0; i < 900; ++i) {
            const int unchecked = car.head.unchecked, shared = car.implicit.shared, used = car.implicit.used;
            failed += JOIN(MODEL, _step)(&car, 0.0005, method[m]) != GIC_OK;
            if (i > 16 && car.head.unchecked > unchecked && used < 16 && shared > 0) {
                ++checks;
                failed += car.implicit.shared != shared;
            }
        }
#ifdef SPREAD
        if (checks < 3 || car.implicit.jacobian_count > 900 / 16 + 3)
            failed += fprintf(stderr, "method %d: %d checks, %d Jacobians\n", (int)method[m], checks, (int)car.implicit.jacobian_count);
#endif
    }
    return failed != 0;
}
END
# spread MODEL
spread() {
    model=$1
    for way in plain shares; do
        set --
        [ $way = plain ] || set -- -DSPREAD
        "$gicgen" --implicit ${1:+--spread-jacobian} "$root/models/$model.veh" -o "$model.c" &&
            cc -std=c99 -O1 -Wall -Wextra -Wshadow -Werror -I. -I"$root/runtime" "$@" -DMODEL="$model" spread.c "$model.c" "$root/runtime/gic_runtime.c" -o run -lm
        check "$model, $way: compiles" [ $? -eq 0 ]
        ./run >$way.txt
        check "$model, $way: orders, copies" [ $? -eq 0 ]
    done
    check "$model: pieces make the whole" cmp -s plain.txt shares.txt
}
# ports move columns of the derivatives, not of implicit steps: both have rows of one length
cat >both.c <<'END'
#include "cart.h"
#include <stdio.h>
int main(void)
{
    static const gic_method method[] = {GIC_ROS2, GIC_ROS3, GIC_IMEX};
    static cart car;
    int failed = 0;
    for (int m = 0; m < 3; ++m) {
        failed += cart_setup(&car) != GIC_OK;
        car.implicit.keep = 8;
        car.implicit.spread = 1;
        for (int i = 0; i < 100; ++i)
            failed += cart_step(&car, 0.001, method[m]) != GIC_OK;
        for (int i = 0; i < CART_STATES; ++i)
            printf("%a\n", car.state[i]);
    }
    return failed != 0;
}
END
for more in '' --derivatives; do
    # shellcheck disable=SC2086  # no word or one
    "$gicgen" --implicit --spread-jacobian $more "$root/tests/data/laws/cart.veh" -o cart.c 2>err &&
        cc -std=c99 -O1 -fsanitize=address -Wall -Wextra -Wshadow -Werror -ffp-contract=off -I. -I"$root/runtime" both.c cart.c "$root/runtime/gic_runtime.c" -o run -lm &&
        ./run >"both$more.txt"
    check "ports, shares $more" [ $? -eq 0 ]
done
check "ports: the same bits with derivatives" cmp -s both.txt both--derivatives.txt
spread quarter_car
spread hmmwv_tires
spread pendulum
check "no file" [ ! -e x.fmu ]
"$gicgen" --spread-jacobian "$root/models/quarter_car.veh" -o x.c 2>err
check "shares without implicit steps" [ $? -eq 2 ]
check "no code" [ ! -e x.c ]
cat >spread.scene <<'END'
gicscene: 1
duration: 0.2
step: 0.004
integrator: imex
keep_jacobian: 8
spread_jacobian: true
END
"$gicrun" --engine tcc "$root/models/quarter_car.veh" spread.scene -o out.csv 2>err
check "gicrun takes it" [ $? -eq 0 ]
sed '/keep/d' spread.scene >one.scene
"$gicrun" --engine tcc "$root/models/quarter_car.veh" one.scene -o none.csv 2>err
check "not with a Jacobian each" sh -c '[ ! -e none.csv ] && grep -q "spread_jacobian needs a Jacobian that is kept" err'
# stands on a slope of 15 %: tires are springs there, and nothing creeps, with shares as without; where it comes to
# stand the steps of the first second decide, in which it settles and tires slide
sed 's/^step: .*/step: 0.01\nintegrator: ros3\nkeep_jacobian: 8/; s/^duration: .*/duration: 20/; /^ratio/d' "$root/models/scenes/tires_park.scene" >kept.scene
{ cat kept.scene && echo 'spread_jacobian: true'; } >shared.scene
for way in kept shared; do
    "$gicrun" --engine tcc "$root/models/hmmwv_tires.veh" $way.scene -o $way.csv 2>err
    check "parked, $way" [ $? -eq 0 ]
    tail -41 $way.csv | awk -F, 'NR == 1 { for (i = 1; i <= 4; ++i) v[i] = $i } { last = $2; for (i = 2; i <= 4; ++i) { d = $i - v[i]; bad += d * d > 1e-14 } } END { exit !(NR == 41 && !bad) }'
    check "parked, $way: 4 s without creep, 1e-7 m" [ $? -eq 0 ]
done
awk -F, 'NR == FNR { last = $0; next } { own = $0 } END { split(last, a, ","); split(own, b, ","); for (i = 2; i <= 4; ++i) bad += (a[i] - b[i]) ^ 2 > 1e-12; exit bad > 0 }' kept.csv shared.csv
check "both stand at one place, 1e-6 m" [ $? -eq 0 ]
"$gicrun" --engine tcc --solve augmented "$root/models/hmmwv_tires.veh" shared.scene -o augmented.csv 2>err
check "another form has no shares" [ $? -eq 1 ]
check "which is told" grep -q 'not made by shares' err
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
