#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tutorial.sh GICRUN: the six steps of models/README.md: every step rests, leans, brakes and steers as statics and
# Newton's law say, worked out by hand here.
gicrun=$(realpath "$1")
tutorial=$(cd "$(dirname "$0")/../../models/tutorial" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# near VALUE EXPECTED TOLERANCE
near() { echo "$1 is not $2 within $3" >"$work/said"; awk -v v="$1" -v e="$2" -v t="$3" 'BEGIN { exit !(v != "" && (v - e)^2 <= t^2) }'; }
# at NAME TIME FILE: the value of a column in the row of a time; 1e99: there is none
at() {
    awk -F, -v name="$1" -v time="$2" 'BEGIN { value = 1e99 }
        NR == 1 { for (i = 1; i <= NF; ++i) { sub(/ .*/, "", $i); if ($i == name) c = i } }
        NR > 1 && c && ($1 - time)^2 < 1e-12 { value = $c } END { print value }' "$3"
}
equilibrium() { run --equilibrium "$tutorial/$1.veh"; }
# told PATTERN: the number behind it in the last printed text
told() { sed -n "s/^$1 *\([-0-9.e]*\).*/\1/p" "$work/out" | tail -n 1; }

# 1: the arm's weight about the hinge, 40 g 0.35 = F 0.3
equilibrium 1_arm
check 'the arm rests' exits 0
check 'its spring at rest' near "$(sed -n 's/^spring *\([0-9.]*\) m$/\1/p' out)" 0.4 1e-6
check "its spring's force" near "$(sed -n 's/^spring *\([-0-9.]*\) N$/\1/p' out)" -457.8 0.01
run -q "$tutorial/1_arm.veh" "$tutorial/1_arm.scene" -o 1.csv
check 'the arm swings' exits 0
# about the hinge: I + m d^2 = 2 + 40 0.35^2 = 6.9 kg m^2, k 0.3^2 = 1800 N m / rad, period 0.389 s; after five of them
# it has died out to exp(-c 0.3^2 / (2 6.9) t) of 0.05 m = 0.00395 m, but for the change of the lever: 10 percent
peak() { awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^spring.value/) c = i } $1 > 1.8 && $1 < 2 && $c > m { m = $c } END { print m }' 1.csv; }
check 'how it dies out' near "$(peak)" 0.40395 0.0004

# 2: the road carries both bodies; the spring 340 g 0.4 - 40 g 0.35 = F 0.3
equilibrium 2_corner
check "the corner's wheel load" near "$(told sum)" 3335.4 0.001
# levers as they are within the turn of the arm at rest, 1e-3
check "the corner's spring" near "$(sed -n 's/^spring *\([-0-9.]*\) N$/\1/p' out)" 3989.4 4
run -q "$tutorial/2_corner.veh" "$tutorial/2_corner.scene" -o 2.csv
check 'the corner is dropped' exits 0

# 3: the wheels carry the car
equilibrium 3_car
check "the car's wheel loads" near "$(told sum)" 13341.6 0.01
run -q "$tutorial/3_car.veh" "$tutorial/3_car.scene" -o 3.csv
check 'the car drives over a bump' exits 0
# before the bump it goes straight on at 5 m/s, front wheels at x = 1.3
check 'it rolls before the bump' near "$(at attitude.roll 0.5 3.csv)" 0 1e-9
check 'and goes straight on' near "$(at chassis.x 0.5 3.csv)" 2.5 1e-3

# 4: wheel rates 40000 (0.3 / 0.4)^2 = 22500 N/m, with the bar 2.5 times that, each in series with the tire's 200000;
# roll stiffness of an axle 2 k 0.75^2, less m g h of the chassis about the road, to second order of levers: 10 percent
run -q "$tutorial/4_roll.veh" "$tutorial/4_roll.scene" -o 4.csv
check 'the car leans' exits 0
sed 's/bar: 30000/bar: 0/' "$tutorial/4_roll.scene" >without.scene
run -q "$tutorial/4_roll.veh" without.scene -o 4_without.csv
check 'and without its bar' exits 0
leans() { awk -v a="$(at attitude.roll 5 4.csv)" -v b="$(at attitude.roll 5 4_without.csv)" 'BEGIN { print a / b }'; }
expected() { awk 'BEGIN { t = 200000; s = 22500; b = 2.5 * s; y = 2 * 0.75^2; s = s * t / (s + t); b = b * t / (b + t)
    g = 1200 * 9.81 * 0.5; print (2 * s * y - g) / ((s + b) * y - g) }'; }
check 'less with its bar' near "$(leans)" "$(expected)" 0.06

# 5: 4 x 400 N m at 0.3 m radius brake 1360 kg and the spin of four wheels, 0.8 / 0.3^2 each, and rolling resistance 0.01 g
run -q "$tutorial/5_tires.veh" "$tutorial/5_tires.scene" -o 5.csv
check 'the car brakes' exits 0
brakes() { awk -v a="$(at velocity.x 1.5 5.csv)" -v b="$(at velocity.x 2.5 5.csv)" 'BEGIN { print a - b }'; }
slows() { awk 'BEGIN { r = 0.3; print 1600 / r / (1360 + 4 * 0.8 / r^2) + 0.0981 }'; }
check 'as hard as its brakes' near "$(brakes)" "$(slows)" 0.1

# 6: the path is the circle about (0, 30), passed at 10 m/s
run -q "$tutorial/6_steering.veh" "$tutorial/6_steering.scene" -o 6.csv
check 'the car steers' exits 0
radius() { awk -v x="$(at chassis.x "$1" 6.csv)" -v y="$(at chassis.y "$1" 6.csv)" 'BEGIN { print sqrt(x^2 + (y - 30)^2) }'; }
speed() { awk -v x="$(at velocity.x "$1" 6.csv)" -v y="$(at velocity.y "$1" 6.csv)" 'BEGIN { print sqrt(x^2 + y^2) }'; }
for time in 5 12 20 25; do
    check "on the circle at $time s" near "$(radius $time)" 30 0.3
done
# once the driver's integral part has found the accelerator that the curve takes, 1 / 0.1 s
for time in 15 25; do
    check "at 10 m/s at $time s" near "$(speed $time)" 10 0.2
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
