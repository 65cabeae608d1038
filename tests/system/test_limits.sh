#!/bin/sh
# SPDX-License-Identifier: MIT
# test_limits.sh GICRUN GICSWEEP: values of tunable parameters by scenes and sweeps are held to the limits of the file: what it
# refuses, they refuse, with the scene's place; what is at the edge of a limit and allowed runs.
gicrun=$(realpath "$1")
gicsweep=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

# model NAME=VALUE: the model with one number other than usual; `spare` follows `fade` by a formula
model() {
    cat <<END | sed "s|^  ${1%=*}: {value: [^,]*,|  ${1%=*}: {value: ${1#*=},|"
gicgen: 1
model: limits
base: ground
gravity: [0, 0, 0]
parameters:
  high: {value: 0.1, unit: m, tunable: true}
  low: {value: -0.1, unit: m, tunable: true}
  fade: {value: 0.02, unit: m, tunable: true}
  spare: fade - 0.01
  stiff: {value: 4000, unit: N/m, tunable: true}
  damp: {value: 600, unit: Ns/m, tunable: true}
  mass: {value: 2, unit: kg, tunable: true}
  spring: {value: 100, unit: N/m, tunable: true}
  couple: {value: 10, unit: N/m, tunable: true}
  lead: {value: 0.5, unit: m, tunable: true}
bodies:
  m: {mass: mass, com: [0, 0, 0], inertia: [1, 1, 1]}
  wheel: {mass: 1, com: [0, 1, 0], inertia: [1, 1, 1]}
joints:
  g: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
  axle: {type: revolute, bodies: [ground, wheel], point: [0, 1, 0], axis: [0, 1, 0]}
  teeth: {type: rack_and_pinion, bodies: [m, wheel], point: [0, 1, 0], axes: [[0, 1, 0], [1, 0, 0]], ratio: lead}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-9, 9]}
forces:
  end: {type: stop, coordinate: x, low: low, high: high, stiffness: stiff, damping: damp, fade: fade}
  soft: {type: spring_damper, coordinate: x, stiffness: spring, damping: damp}
  rubber: {type: bushing, bodies: [ground, m], point: [0, 0, 0],
           stiffness: [[100], [couple, 400], [0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1]]}
  far: {type: stop, coordinate: x, high: 5, stiffness: 2 * stiff + 1, fade: 2 * spare}
outputs:
  x: {type: coordinate, coordinate: x}
END
}
scene() { printf 'gicscene: 1\nduration: 0.1\nstep: 0.01\nparameters:\n  %s\n  %s\n' "$1" "$2"; }

model none=0 >limits.veh
while read -r key value what; do
    model "$key=$value" >wrong.veh
    scene 'low: -0.1' 'high: 0.1' >now.scene
    [ "$key" = low ] && scene 'high: 0.1' 'fade: 0.02' >now.scene
    run -q wrong.veh now.scene -o out.csv
    # the same in the file: refused as it is read, whatever a scene says
    check "$key: $value in the file" exits 1
    check "$key: $value in the file: its place" says '^wrong.veh:[0-9]*:[0-9]*: error: '
    scene 'spring: 50' "$key: $value" >now.scene
    [ "$key" = spring ] && scene 'high: 0.1' "$key: $value" >now.scene
    for engine in tape tcc gic; do
        run -q --engine $engine limits.veh now.scene -o out.csv
        check "$key: $value in a scene, $engine" exits 1
        check "$key: $value in a scene, $engine: its place" says "^now.scene:6:$((${#key} + 5)): error: .*$what"
        check "$key: $value in a scene, $engine: a remedy" says 'remedy: '
        check "$key: $value in a scene, $engine: no results" [ ! -e out.csv ]
    done
    scene 'spring: 50' 'stiff: 3000' >now.scene
    "$gicsweep" --vary "$key=$value:$value:1" limits.veh now.scene -o sweep.csv >out 2>err
    check "$key: $value in a sweep has a status" [ "$(awk -F, 'NR == 2 {print $3}' sweep.csv)" = -11 ]
    check "$key: $value in a sweep is named" grep -q "$what" err
    rm -f sweep.csv*
done <<'END'
high -0.2 high of force 'end' must be above low
high -0.1 high of force 'end' must be above low
low 0.1 high of force 'end' must be above low
fade 0 fade of force 'end' must be greater than zero
fade -1 fade of force 'end' must be greater than zero
fade 0.01 fade of force 'far' must be greater than zero
stiff -1 stiffness of force 'end' must not be negative
damp -5 damping of force 'end' must not be negative
spring -1e-9 stiffness of force 'soft' must not be negative
mass 0 mass of body 'm' must be greater than zero
mass -1 mass of body 'm' must be greater than zero
couple 201 stiffness of force 'rubber' must be positive semidefinite
couple -300 stiffness of force 'rubber' must be positive semidefinite
lead 0 ratio of joint 'teeth' must not be 0
END

# at the edges
while read -r key value; do
    scene 'spring: 50' "$key: $value" >now.scene
    [ "$key" = spring ] && scene 'high: 0.1' "$key: $value" >now.scene
    run -q --engine tape limits.veh now.scene -o out.csv
    check "$key: $value runs" exits 0
    rm -f out.csv
done <<'END'
stiff 0
damp 0
spring 0
fade 0.0101
couple 200
couple -200
lead -0.5
high 0.05
END

# two that break a limit together: the first of them in the scene
scene 'high: 1' 'low: 2' >now.scene
run -q limits.veh now.scene
check "two together" says '^now.scene:5:9: error: .*high of force'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
