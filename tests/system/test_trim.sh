#!/bin/sh
# SPDX-License-Identifier: MIT
# test_trim.sh GICRUN: steady driving, `gicrun --trim` (tests/vehicle/trim.py); what it says; vehicles that can't, wrong words.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
car=$models/hmmwv_vehicle.veh
/usr/bin/python3 -B "$root/tests/vehicle/trim.py" "$gicrun" "$models" "$root/tests/data/manoeuvre/linear.veh" "$work" >"$work/said" 2>&1
verdict $? "steady driving"
grep -c . "$work/said" >/dev/null && tail -n 1 "$work/said"

# ---- what is said
run --trim "$car" speed=10 lateral=2.5
check 'the motion' prints 'steady cornering at 10 m/s, 2.5 m/s^2 to the left (40 m radius)'
check 'inputs for a scene' prints '^  accelerator: 0'
sed -n '/^initial:/,$p' "$work/out" >"$work/start"
printf 'gicscene: 1\nduration: 0.1\nstep: 0.005\n' | cat - "$work/start" >"$work/printed.scene"
run -q "$car" "$work/printed.scene"
check 'what is printed is the start of a scene' exits 0
run --trim "$car" speed=10 lateral=2.5 -o "$work/state.csv"
cp "$work/state.csv" "$work/told.csv"
run -q --trim "$car" speed=10 lateral=2.5 -o "$work/state.csv"
check 'quiet: nothing but the file' sh -c '[ ! -s "$1/out" ] && cmp -s "$1/state.csv" "$1/told.csv"' sh "$work"
run -q --eval "$work/state.csv" "$car" -o "$work/rates.csv"
check 'a row that --eval reads' exits 0
run --trim "$car" speed=10 -o "$work/a.scene"
run --trim "$car" speed=10 -o "$work/b.scene"
check 'the same bytes again' cmp "$work/a.scene" "$work/b.scene"
run --trim "$car" speed=2 gear=3
check 'a gear that it leaves' says 'the transmission leaves gear 3 there by itself'
run --trim "$models/hmmwv_tires.veh" speed=20 lateral=2
check 'a vehicle without a drive' exits 0
check 'its speed is held' says 'nothing drives: the speed is held, and changes by -0'
# without any resistance to rolling a curve takes next to no drive, straight on none
for vehicle in linear trike; do
    for speed in 2 5 10 15; do
        run --trim "$root/tests/data/manoeuvre/$vehicle.veh" speed=$speed lateral=0.5
        check "$vehicle at $speed m/s" exits 0
    done
done
run --linearize --trim "$car" speed=10 lateral=2.5 -o "$work/model.csv"
check 'a linear model' prints 'linear model about steady cornering at 10 m/s'

# a car that counts its way, and one with a lag
mkdir "$work/models" && cp -r "$models/." "$work/models/"
cat >>"$work/models/hmmwv_vehicle.veh" <<'END'
states:
  way: {rate: chassis_velocity.x, unit: m}
END
run --trim "$work/models/hmmwv_vehicle.veh" speed=10 lateral=2.5
check 'a distance that counts on is no hindrance' exits 0
sed -i 's/  way: .*/  way: {rate: "1 - way", unit: m}/' "$work/models/hmmwv_vehicle.veh"
run --trim "$work/models/hmmwv_vehicle.veh" speed=10 lateral=2.5
check 'a state that settles has settled' prints '^    way: 1$'

# ---- what can not be, and wrong words
rm -f "$work"/no.*
ends() { exits "$1" && says "$2" && [ ! -e "$work/no.csv" ] && [ ! -e "$work/no.npz" ] && [ ! -e "$work/no.scene" ]; }
mistake() { # STATUS TEXT OPTION...: said, and no file is left
    wanted=$1
    text=$2
    shift 2
    run "$@"
    check "$text" ends "$wanted" "$text"
}
mistake 1 'no steady cornering at 10 m/s beyond a lateral acceleration of 6' --trim "$car" speed=10 lateral=9 -o "$work/no.csv"
mistake 1 "it takes 'rack' at .*, beyond its range" --trim "$car" speed=5 curvature=0.2 -o "$work/no.scene"
mistake 1 'no steady driving at 40 m/s straight ahead in a forward gear' --trim "$car" speed=40 -o "$work/no.csv"
mistake 1 'no steady driving at 2 m/s straight ahead in gear 0' --trim "$car" speed=2 gear=0 -o "$work/no.csv"
# 0.03 kg on 1e7 N/m: the last digit of 0.5 m is 1e-9 N, 4e-8 m/s^2
cat >"$work/stiff.veh" <<END
gicgen: 1
include: $car
model: stiff
bodies:
  ballast: {mass: 0.03, com: [0, 0, 0.5], inertia: [0.01, 0.01, 0.01]}
joints:
  rail: {type: prismatic, bodies: [chassis, ballast], axis: [0, 1, 0]}
coordinates:
  aside: {type: length, bodies: [chassis, ballast], points: [[0.3, -0.37, 0.51], [0.3, 0.13, 0.51]], range: [0.2, 1.7]}
forces:
  stiff: {type: spring_damper, coordinate: aside, stiffness: 1e7, damping: 10, free: 0.5}
END
mistake 1 'found to nine digits, but rounding leaves a rate of .* of aside.rate, above 1e-9' --trim "$work/stiff.veh" speed=10 lateral=2.5 -o "$work/no.csv"
check 'what to do about rounding' says 'remedy: .*more mass or less stiffness there'
mistake 1 'give it a driven coordinate that steers' --trim "$models/tutorial/5_tires.veh" speed=10 lateral=1 -o "$work/no.csv"
mistake 1 "the base of model 'pendulum' is fixed" --trim "$models/pendulum.veh" speed=1
mistake 1 "controller 'traction_l' changes by itself" --trim "$models/formula_student.veh" speed=10
printf 'gicscene: 1\nduration: 1\nstep: 0.005\nroad: {type: slope, x: 0.1}\n' >"$work/hill.scene"
mistake 1 'steady driving is on a level road' --trim "$car" "$work/hill.scene" speed=10
mistake 2 'needs a speed' --trim "$car"
mistake 2 'unlike .speed=0' --trim "$car" speed=0
mistake 2 'unlike .speed=0x10' --trim "$car" speed=0x10
mistake 2 'no such key' --trim "$car" speed=10 radius=40
mistake 2 'given twice' --trim "$car" speed=10 speed=11
mistake 2 'curvature and lateral are one thing' --trim "$car" speed=10 lateral=1 curvature=0.01
mistake 2 'no such gear' --trim "$car" speed=10 gear=9
mistake 2 'no such gear' --trim "$models/hmmwv_tires.veh" speed=10 gear=1
mistake 2 "no input 'wheel'" --trim "$car" speed=10 steer=wheel
mistake 2 'two inputs' --trim "$car" speed=10 steer=rack drive=rack
mistake 2 'must end in .csv or .scene' --trim "$car" speed=10 -o "$work/no.txt"
mistake 2 'that of --at or that of --trim' --linearize --at 1 --trim "$car" "$models/scenes/cruise.scene" speed=10
mistake 2 'no scene given' --at 1 --linearize "$car"
mistake 2 'does not go with --engine' --trim --engine gic "$car" speed=10
mistake 2 'one of --eval' --trim --modes "$car" speed=10

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
