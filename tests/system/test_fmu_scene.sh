#!/bin/sh
# SPDX-License-Identifier: MIT
# test_fmu_scene.sh GICGEN GICRUN: what Functional Mock-up Units take from a scene, by the importer of tests/fmi: contacts
# that are located within steps, posts; what is refused, at the line of its key; and a signal while a compiler runs.
gicgen=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/fmi/lib.sh
. "$(dirname "$0")/../fmi/lib.sh"
importer -o "$work/importer" >"$work/out" 2>"$work/err"
verdict $? "the importer compiles"

# write LOCATE: a scene of $step, $method and $start
write() {
    printf '%s\n' 'gicscene: 1' 'duration: 2' "step: $step" "$method" 'output_step: 0.02' "locate: $1" "$start"
}
run() { "$gicrun" --general --engine tcc "$vehicle" "$1" -o "$2" >"$work/said" 2>&1; }
found() { grep -q "contacts located  *[1-9]" "$work/said"; }
differ() { ! cmp -s "$1" "$2"; }

# located LOCATE OTHER: of the scene, and one that the importer chooses instead, 0 to 2
located() {
    of="$(basename "$vehicle" .veh), $method, locate: $1, FMI $version.0"
    set -- "$1" "$2" "$(echo false true loads | cut -d' ' -f$(($2 + 1)))"
    write "$1" >"$work/asked.scene"
    write "$3" >"$work/other.scene"
    write false >"$work/blind.scene"
    run "$work/other.scene" "$work/other.csv" && run "$work/blind.scene" "$work/blind.csv" &&
        run "$work/asked.scene" "$work/steps.csv" && found && differ "$work/steps.csv" "$work/blind.csv"
    verdict $? "$of: gicrun finds contacts within steps"
    unit "$vehicle" "$work/asked.scene"
    verdict $? "$of: unit"
    check "$of: its description" described
    drive steps 0.02 2 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "$of: co-simulation is gicrun's, bit for bit"
    drive steps 0.02 2 "solver.locate=$2" >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/other.csv"
    verdict $? "$of: $3 that the importer chooses"
    drive rollback 0.02 1 7 >"$work/out" 2>"$work/err"
    verdict $? "$of: going back"
}
# a wheel that hops while a load slides between two stops: 18 contacts made or lost
vehicle=$root/tests/data/contact/hop.veh
step=0.002
start='initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}'
version=2 method='integrator: rk4' && located true 0
version=3 method='integrator: ab3' && located true 2
version=3 method='integrator: ros3' && located true 0
version=2 method=$(printf 'integrator: imex\nkeep_jacobian: 4') && located loads 1
says_of() { # MESSAGE NAME=VALUE
    ! drive steps 0.02 1 "$2" >"$work/out" 2>"$work/err" && says "$1"
}
check "nothing but 0, 1 and 2" says_of "solver.locate is 0, 1 or 2, not 3" solver.locate=3
check "nothing below 0" says_of "solver.locate is 0, 1 or 2, not -1" solver.locate=-1
# bounded work: of the scene, as gicrun's, and another that the importer chooses
for version in 2 3; do
    method=$(printf 'integrator: imex\nkeep_jacobian: 4')
    { write true; echo 'most_work: 12'; } >"$work/bound.scene"
    { write true; echo 'most_work: 40'; } >"$work/wider.scene"
    run "$work/wider.scene" "$work/wider.csv" && run "$work/bound.scene" "$work/steps.csv" && grep -q 'events gone over  *[1-9]' "$work/said" &&
        unit "$vehicle" "$work/bound.scene" && drive steps 0.02 2 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "FMI $version.0: bounded work is gicrun's, bit for bit"
    drive steps 0.02 2 solver.most_work=40 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/wider.csv" && differ "$work/wider.csv" "$work/steps.csv"
    verdict $? "FMI $version.0: more work that the importer allows"
    check "FMI $version.0: no less than a step takes" says_of "solver.most_work must be 0, or 8 and more with solver.ratio 1, not 7" solver.most_work=7
    check "FMI $version.0: no negative work" says_of "solver.most_work must be from 0 to 1000000, not -1" solver.most_work=-1
done
# fast states, fast steps
vehicle=$root/models/hmmwv_tires.veh
start='initial: {position: [0, 0, 0.2], velocity: [10, 0, 0]}'
version=2 method=$(printf 'integrator: ab3\nratio: 4') && located true 2
# no contacts: no variable, and the scene's key changes nothing
vehicle=$root/models/pendulum.veh
start='initial: {}'
method='integrator: rk4'
write true >"$work/asked.scene"
run "$work/asked.scene" "$work/steps.csv" && unit "$vehicle" "$work/asked.scene" &&
    ! grep -q "solver.locate" "$work/unit/modelDescription.xml" && drive steps 0.02 2 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
verdict $? "a model without contacts"

# a post under the wheel; what plots, pages and results show is not the FMU's
printf '%s\n' 'gicscene: 1' 'description: a post' 'duration: 0.5' 'step: 0.002' 'integrator: rk4' 'output_step: 0.02' \
    'posts: {tire: 0.02}' 'units: [mm]' >"$work/post.scene"
vehicle=$root/models/quarter_car.veh
run "$work/post.scene" "$work/steps.csv" && unit "$vehicle" "$work/post.scene" &&
    drive steps 0.02 0.5 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
verdict $? "a wheel on a post: co-simulation is gicrun's, bit for bit"

# a car that is held while geometry is tuned: an importer's values are those of a scene
held() { # NAME VALUE
    printf '%s\n' 'gicscene: 1' 'duration: 0.5' 'step: 0.002' 'integrator: rk4' 'output_step: 0.02' 'base: fixed' \
        'initial: {position: [0, 0, 0.5]}' \
        'driven: {spring_f_l: 0.24, spring_f_r: 0.245, spring_r_l: 0.305, spring_r_r: 0.305, rack: 0}' "parameters: {$1: $2}"
}
vehicle=$root/tests/data/tuning/car.veh
version=2
held toe 0.01 >"$work/held.scene"
run "$work/held.scene" "$work/drawn.csv" && unit "$vehicle" "$work/held.scene"
verdict $? "a car that is held: unit"
for value in "hinge_l 0.48" "toe 0" "tie_l 0.53"; do
    name=${value% *}
    value=${value#* }
    held "$name" "$value" >"$work/tuned.scene"
    run "$work/tuned.scene" "$work/steps.csv" && differ "$work/steps.csv" "$work/drawn.csv" &&
        drive steps 0.02 0.5 "parameter.$name=$value" >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "a car that is held, $name tuned: co-simulation is gicrun's, bit for bit"
done

# refused: the fourth line of the scene
refuses() { # MESSAGE LINE [INTEGRATOR]
    printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.01' "$2" >"$work/wrong.scene"
    [ -z "$3" ] || echo "integrator: $3" >>"$work/wrong.scene"
    "$gicgen" --fmu 3 "$root/models/quarter_car.veh" --scene "$work/wrong.scene" -o "$work/wrong.fmu" >"$work/out" 2>"$work/err"
    [ $? -ne 0 ] && says "wrong.scene:4:[0-9]*: error: $1" && says remedy && [ ! -e "$work/wrong.fmu" ]
    verdict $? "refused: $2"
}
for word in adams rkck bdf; do
    refuses "co-simulation of an FMU has constant steps, not those of" "integrator: $word"
done
refuses "an FMU does not choose an integrator (auto) yet" "integrator: auto"
refuses "an FMU has no conditions" 'until: "time > 0.5"'
refuses "an FMU has no conditions" 'when: [{if: "time > 0.5", mark: late}]'
refuses "an FMU can't have a road of its own yet" "road: {type: flat}"
refuses "a vehicle in an FMU never sleeps" "sleep: {}"
refuses "an FMU can't start in static equilibrium by itself yet" "initial: {equilibrium: true}"
refuses "ab3 has constant steps and no tolerance" "tolerance: 1e-6" ab3

# a signal while the compiler for another platform runs: it is passed on, and nothing is said
mkdir "$work/slow"
printf '#!/bin/sh\ntouch "%s/runs"\nexec sleep 30\n' "$work" >"$work/slow/aarch64-linux-gnu-gcc"
chmod +x "$work/slow/aarch64-linux-gnu-gcc"
mkdir "$work/temporary"
TMPDIR=$work/temporary CC=$work/plain_cc PATH=$work/slow:$PATH "$gicgen" --fmu 2 "$root/models/pendulum.veh" -o "$work/ended.fmu" >"$work/out" 2>"$work/err" &
child=$!
waited=0
while [ "$waited" -lt 300 ] && [ ! -e "$work/runs" ]; do
    sleep 0.1
    waited=$((waited + 1))
done
kill -TERM "$child"
wait "$child" 2>/dev/null
[ $? -eq 143 ] && [ ! -s "$work/err" ] && [ ! -e "$work/ended.fmu" ] && [ -z "$(ls "$work/temporary")" ]
verdict $? "SIGTERM while a compiler runs"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
