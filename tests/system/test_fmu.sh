#!/bin/sh
# SPDX-License-Identifier: MIT
# test_fmu.sh GICGEN GICRUN: Functional Mock-up Units of all models, by an importer of our own (tests/fmi): co-simulation is
# gicrun's bit for bit, model exchange under CVODE agrees with variable steps, going back, calls in any order, sanitizers.
gicgen=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)

# shellcheck source=tests/fmi/lib.sh
. "$(dirname "$0")/../fmi/lib.sh"
importer -o "$work/importer" >"$work/out" 2>"$work/err"
verdict $? "the importer compiles"

parts() {
    for part in sources/buildDescription.xml terminalsAndIcons/terminalsAndIcons.xml; do
        xmllint --noout --relaxng "$here/parts_3.rng" "$work/unit/$part" >"$work/out" 2>&1 || return 1
    done
    described "$work/unit/terminalsAndIcons/terminalsAndIcons.xml"
}

# every_model MODEL SCENE DURATION OUTPUT_STEP [INPUT=VALUE ...]: of models/, or of tests/data/laws
every_model() {
    model=$1
    file=$root/models/$1.veh
    drawn=$root/models/scenes/$2.scene
    [ -e "$file" ] || file=$root/tests/data/laws/$1.veh
    [ -e "$drawn" ] || drawn=$root/tests/data/laws/$2.scene
    scene=$work/$1.scene
    duration=$3
    output=$4
    python3 "$here/scene.py" "$drawn" "$duration" "$output" ${5:+"$5"} ${6:+"$6"} >"$scene" &&
        "$gicrun" -q --general "$file" "$scene" -o "$work/steps.csv" 2>"$work/err" &&
        "$gicrun" -q --general --integrator adams --tolerance 1e-11 "$file" "$scene" \
            -o "$work/variable.csv" 2>>"$work/err"
    verdict $? "$model: gicrun"
    for version in 2 3; do
        unit "$file" "$scene"
        verdict $? "$model: FMI $version.0"
        check "$model: its description" described
        [ $version = 2 ] || check "$model: sources and terminals" parts
        drive steps "$output" "$duration" >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
        verdict $? "$model, FMI $version.0: co-simulation is gicrun's, bit for bit"
        drive cvode 1e-9 "$output" "$duration" >"$work/unit.csv" 2>"$work/err" &&
            as_run 1e-7 "$work/variable.csv" "m rad 1 m/s rad/s"
        verdict $? "$model, FMI $version.0: model exchange by CVODE is gicrun's variable steps"
        drive rollback "$output" "$(awk "BEGIN { print $output * 20 }")" 7 >"$work/out" 2>"$work/err"
        verdict $? "$model, FMI $version.0: going back"
        drive dependencies >"$work/out" 2>"$work/err"
        verdict $? "$model, FMI $version.0: dependencies"
    done
}

# with_derivatives MODEL.veh [NAME=VALUE ...]
with_derivatives() {
    name=$(basename "$1" .veh)
    for version in 2 3; do
        rm -rf "$work/unit"
        CC=$work/plain_cc "$gicgen" --fmu "$version" --derivatives "$1" -o "$work/unit.fmu" >"$work/out" 2>"$work/err" &&
            unpack "$work/unit.fmu" "$work/unit"
        verdict $? "$name: FMI $version.0 with derivatives"
        check "$name: its description" described
        grep -q 'providesDirectionalDerivative' "$work/unit/modelDescription.xml"
        verdict $? "$name: it says so"
        model=$1
        shift
        drive derivatives "$@" >"$work/out" 2>"$work/err"
        verdict $? "$name, FMI $version.0: derivatives are differences"
        set -- "$model" "$@"
    done
}
with_derivatives "$root/models/quarter_car.veh"
with_derivatives "$here/front.veh"
with_derivatives "$root/models/hmmwv_vehicle.veh" state.v.x=8 input.brake=0.1 input.accelerator=0.3

every_model andrews andrews 0.005 0.0001
every_model states states 1 0.02
every_model pendulum pendulum 2 0.01
every_model quarter_car quarter_car 2 0.01
every_model trailing_arm trailing_arm 2 0.01
every_model solid_axle solid_axle 1 0.01
every_model five_link five_link 1 0.01
every_model hmmwv paper_run 1 0.01
every_model hmmwv14 hmmwv14 0.5 0.01
every_model hmmwv_full hmmwv_full 0.5 0.01
every_model hmmwv_tires tires_brake 0.8 0.02
every_model hmmwv_tmeasy tires_brake 0.8 0.02
every_model hmmwv_vehicle straight 1.5 0.03 accelerator=0.3 gear=3

# sampled controllers: co-simulation alone, steps in parts
sed 's/@period@/0.03/; s/@offset@/0.005/; s/@delay@/0.04/; s/@quantum@//; s/@mean@/0.1/; s/@mean_offset@/0/; s/@spring@/18/; s/@start@/0.5/' \
    "$root/tests/controllers/loop.veh.in" >"$work/loop.veh"
printf 'gicscene: 1\nstep: 0.007\noutput_step: 0.07\nduration: 1.4\nintegrator: ab3\n' >"$work/loop.scene"
"$gicrun" -q --general "$work/loop.veh" "$work/loop.scene" -o "$work/steps.csv" 2>"$work/err"
verdict $? "loop: gicrun"
for version in 2 3; do
    unit "$work/loop.veh" "$work/loop.scene"
    verdict $? "loop: FMI $version.0"
    check "loop: its description" described
    grep -q '<CoSimulation' "$work/unit/modelDescription.xml" && ! grep -q '<ModelExchange' "$work/unit/modelDescription.xml"
    verdict $? "loop, FMI $version.0: no model exchange"
    drive steps 0.07 1.4 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "loop, FMI $version.0: co-simulation is gicrun's, bit for bit"
    drive rollback 0.07 1.4 7 >"$work/out" 2>"$work/err"
    verdict $? "loop, FMI $version.0: going back"
    drive cvode 1e-9 0.07 1.4 >"$work/out" 2>"$work/err"
    [ $? -ne 0 ] && grep -q 'only co-simulation' "$work/err"
    verdict $? "loop, FMI $version.0: an instance for model exchange is refused"
done
# a road of the master's, wheel by wheel: gicrun has the whole slope
slope="0.03 -0.02 0.5"
on_slope() {
    python3 "$here/scene.py" "$root/models/scenes/$2.scene" "$3" "$4" "road=$(echo "$slope" | tr ' ' ,)" >"$work/slope.scene" &&
        python3 "$here/scene.py" "$root/models/scenes/$2.scene" "$3" "$4" >"$work/flat.scene" &&
        "$gicrun" -q --general "$root/models/$1.veh" "$work/slope.scene" -o "$work/steps.csv" 2>"$work/err" &&
        "$gicrun" -q --general --integrator adams --tolerance 1e-11 "$root/models/$1.veh" "$work/slope.scene" \
            -o "$work/variable.csv" 2>>"$work/err"
    verdict $? "$1 on a slope: gicrun"
    for version in 2 3; do
        unit "$root/models/$1.veh" "$work/flat.scene"
        # shellcheck disable=SC2086  # three numbers
        drive road $slope "$4" "$3" >"$work/unit.csv" 2>"$work/err" && as_run 1e-10 "$work/steps.csv"
        verdict $? "$1 on the master's slope, FMI $version.0: co-simulation is gicrun's"
        # shellcheck disable=SC2086  # three numbers
        drive slope $slope "$4" "$3" >"$work/unit.csv" 2>"$work/err" &&
            as_run 1e-7 "$work/variable.csv" "m rad 1 m/s rad/s"
        verdict $? "$1 on the master's slope, FMI $version.0: model exchange is gicrun's variable steps"
    done
}
on_slope five_link five_link 0.5 0.01
on_slope hmmwv_tires tires_brake 0.8 0.02

# two FMUs in one process: different vehicles by turns; one pulls the other; a controller in the master
version=2
second() { # MODEL.veh NAME
    unit "$1" && rm -rf "${work:?}/$2" && mv "$work/unit" "$work/$2"
}
two() { # NAME NAME TASK ...
    one=$1 other=$2
    shift 2
    "$work/importer" "$work/$one/binaries/linux64/"*.so "$work/$one/modelDescription.xml" \
        "$work/$other/binaries/linux64/"*.so "$work/$other/modelDescription.xml" "$@"
}
hidden() { ! nm -D --defined-only "$1" | grep -v " fmi2"; }
second "$root/models/hmmwv_vehicle.veh" vehicle && second "$root/models/five_link.veh" five_link &&
    second "$here/front.veh" front && second "$here/rear.veh" rear
verdict $? "FMUs to couple"
two vehicle five_link both 0.01 0.3 >"$work/out" 2>"$work/err"
verdict $? "two vehicles in one process run as each alone, bit for bit"
check "symbols are hidden" hidden "$work/vehicle/binaries/linux64/hmmwv_vehicle.so"
"$gicrun" -q --general "$here/tow.veh" "$here/tow.scene" -o "$work/steps.csv" 2>"$work/err" &&
    two front rear couple 0.001 1 >"$work/coarse.csv" 2>>"$work/err" &&
    two front rear couple 0.0001 1 >"$work/unit.csv" 2>>"$work/err" && as_run 5e-4 "$work/steps.csv" "m m/s"
verdict $? "a carriage that pulls another one, two FMUs, moves as both in one model"
worse() { mv "$work/coarse.csv" "$work/unit.csv" && ! as_run 1e-3 "$work/steps.csv" "m m/s" && as_run 5e-3 "$work/steps.csv" "m m/s"; }
check "... ten times as far off with a step ten times as long" worse
python3 "$here/scene.py" "$root/models/scenes/straight.scene" 6 0.03 accelerator=0.2 gear=2 >"$work/ahead.scene"
unit "$root/models/hmmwv_vehicle.veh" "$work/ahead.scene" && drive control 0.006 6 >"$work/out" 2>"$work/err"
verdict $? "a controller in the master steers the vehicle to the yaw rate that it wants"

# gears: two changes, which fixed steps and event indicators locate within steps
scene=$work/gears.scene
python3 "$here/scene.py" "$root/models/scenes/full_run.scene" 4 0.03 accelerator=0.9 >"$scene"
sed -e 's/"step": 0.006/"step": 0.00025/; s/"integrator": "ab3"/"integrator": "rk4"/; /"ratio"/d' "$scene" >"$work/short.scene"
"$gicrun" -q --general "$root/models/hmmwv_vehicle.veh" "$scene" -o "$work/steps.csv" 2>"$work/err" &&
    "$gicrun" -q --general "$root/models/hmmwv_vehicle.veh" "$work/short.scene" -o "$work/short.csv" 2>>"$work/err"
verdict $? "gears: gicrun"
for version in 2 3; do
    unit "$root/models/hmmwv_vehicle.veh" "$scene"
    drive steps 0.03 4 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "gears, FMI $version.0: co-simulation is gicrun's, bit for bit"
    drive cvode 1e-10 0.03 4 >"$work/unit.csv" 2>"$work/err" && grep -q "importer: 2 events" "$work/err" &&
        as_run 1e-7 "$work/short.csv" "m rad 1 m/s rad/s"
    verdict $? "gears, FMI $version.0: model exchange by CVODE changes them where short steps of gicrun do"
done

drive early 0.03 0.3 >"$work/out" 2>"$work/err"
verdict $? "FMI 3.0: intermediate updates and early return"

# contacts: a wheel hops on its tire, landing and leaving 5 times each in 2 s (at 0.1 s and 0.203 s later, every 0.403 s);
# a load slides between two stops, hits and leaves them 4 times each (first at 0.1875 s, 0.157 s in one, 0.3125 s between)
hop=$root/tests/data/contact/hop.veh
printf '%s\n' 'gicscene: 1' 'duration: 2' 'step: 0.0002' 'integrator: rk4' 'output_step: 0.01' 'locate: true' \
    'initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}' >"$work/hop.scene"
"$gicrun" -q --general "$hop" "$work/hop.scene" -o "$work/hop.csv" 2>"$work/err"
verdict $? "contacts: gicrun"
for version in 2 3; do
    unit "$hop" "$work/hop.scene"
    check "contacts: their description" described
    drive cvode 1e-11 0.01 2 >"$work/unit.csv" 2>"$work/err" && grep -q "importer: 0 events, 18 contacts" "$work/err" &&
        as_run 1e-7 "$work/hop.csv"
    verdict $? "contacts, FMI $version.0: CVODE stops at each of them"
done

# sources alone: C99, no warning, no library but libm; and what the importer does under sanitizers, but for what it reads
# of XML, which it keeps to the end
printf 'leak:xml\nleak:description\n' >"$work/kept"
sources() {
    (cd "$work/unit/sources" &&
        ${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -O1 -g "$@" -fPIC -shared ./*.c -o "$work/sources.so" \
            -Wl,--no-undefined -lm) >"$work/out" 2>"$work/err"
}
needed() { [ "$(readelf -d "$work/sources.so" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | tr '\n' ' ')" = "libm.so.6 libc.so.6 " ]; }
# shellcheck disable=SC2086  # a list of words
importer $sanitize -o "$work/sanitized" 2>"$work/err"
verdict $? "the importer compiles for sanitizers"
for version in 2 3; do
    unit "$here/everything.veh"
    sources
    verdict $? "FMI $version.0: sources compile as C99 without warnings"
    check "FMI $version.0: sources need libm alone" needed
    # shellcheck disable=SC2086  # a list of words
    sources $sanitize
    verdict $? "FMI $version.0: sources compile for sanitizers"
    for task in "attack 1 3000" "attack 2 3000" "attack 3 3000" "misuse" "rollback 0.004 0.2 5"; do
        # shellcheck disable=SC2086  # a list of words
        LSAN_OPTIONS=suppressions=$work/kept:print_suppressions=0 "$work/sanitized" "$work/sources.so" "$work/unit/modelDescription.xml" $task >"$work/out" 2>"$work/err"
        verdict $? "FMI $version.0, sanitizers: $task"
    done
done
# ... of a model with a wheel, so that there is a road
version=2
unit "$root/models/quarter_car.veh"
# shellcheck disable=SC2086  # a list of words
sources $sanitize
verdict $? "a wheel: sources compile for sanitizers"
for task in "attack 4 3000" "misuse" "rollback 0.004 0.2 5" "road 0.01 0.02 0.5 0.004 0.1"; do
    # shellcheck disable=SC2086  # a list of words
    LSAN_OPTIONS=suppressions=$work/kept:print_suppressions=0 "$work/sanitized" "$work/sources.so" "$work/unit/modelDescription.xml" $task >"$work/out" 2>"$work/err"
    verdict $? "a wheel, sanitizers: $task"
done

# the same bytes again; all platforms
PATH=$all_platforms
version=2
"$gicgen" --fmu 2 "$root/models/pendulum.veh" -o "$work/one.fmu" 2>"$work/err" &&
    TMPDIR=$work "$gicgen" --fmu 2 "$root/models/pendulum.veh" -o "$work/other.fmu" 2>>"$work/err" &&
    cmp "$work/one.fmu" "$work/other.fmu" >"$work/out"
verdict $? "the same bytes again"
unpack "$work/one.fmu" "$work/platforms"
has() { [ -s "$work/platforms/$1" ]; }
# there COMPILER FILE: the binary is there where the compiler is
there() {
    if command -v "$1" >/dev/null; then has "$2"; else says "$1 is not there"; fi
}
check "binary for Linux" has binaries/linux64/pendulum.so
check "binary for ARM" there aarch64-linux-gnu-gcc binaries/aarch64-linux/pendulum.so
check "binary for Windows" there x86_64-w64-mingw32-gcc binaries/win64/pendulum.dll
check "page" has documentation/index.html
check "licence" has documentation/licenses/LICENSE
check "picture" has model.png

# without a compiler: sources alone, and it says so
CC=$work/no_compiler "$gicgen" --fmu 2 "$root/models/pendulum.veh" -o "$work/bare.fmu" >"$work/out" 2>"$work/err"
verdict $? "without a compiler"
check "... it says so" says "none for.*no_compiler is not there"

# mistakes
refuses() {
    name=$1 text=$2
    shift 2
    rm -f "$work/wrong.fmu"
    "$gicgen" "$@" >"$work/out" 2>"$work/err"
    [ $? -ne 0 ] && says "$text" && [ ! -e "$work/wrong.fmu" ]
    verdict $? "$name"
}
refuses "another version" "takes 2 or 3" --fmu 1 "$root/models/pendulum.veh" -o "$work/wrong.fmu"
refuses "another ending" "must end in .fmu" --fmu 2 "$root/models/pendulum.veh" -o "$work/wrong.zip"
refuses "a scene with a road" "road of its own" --fmu 2 "$root/models/hmmwv.veh" --scene \
    "$root/models/scenes/paper_run.scene" -o "$work/wrong.fmu"
refuses "a scene that starts in equilibrium" "static equilibrium" --fmu 2 "$root/models/hmmwv_vehicle.veh" --scene \
    "$root/models/scenes/straight.scene" -o "$work/wrong.fmu"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
