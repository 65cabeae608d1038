#!/bin/sh
# SPDX-License-Identifier: MIT
# test_dead_centre.sh GICRUN: what is said of runs that end at a dead centre or a change point, whose places are derived
# by hand beside each mechanism; the remedy, applied as it is printed, runs through. Links of 1 and 2 m, hinges along x,
# y and z.
gicrun=$(realpath "$1")
found=$(realpath "$(dirname "$0")/../random/found")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
: >said

# point X Z: in the plane across $axis
point() {
    case $axis in
    x) echo "[0, $1, $2]" ;;
    y) echo "[$2, 0, $1]" ;;
    z) echo "[$1, $2, 0]" ;;
    esac
}
direction() { case $axis in x) echo "[1, 0, 0]" ;; y) echo "[0, 1, 0]" ;; z) echo "[0, 0, 1]" ;; esac; }
body() { echo "  $1: {mass: 1, com: $(point "$2" "$3"), inertia: [0.1, 0.1, 0.1]}"; }
hinge() { echo "  $1: {type: $2, bodies: [$3], point: $(point "$4" "$5"), axis: $(direction)}"; }

# The end of a file; stands for the coordinate too.
outputs() {
    echo "outputs:
  turn: {type: coordinate, coordinate: turn}
  energy: {type: energy}"
}

# rhombus GROUND [CRANK]: crank (1 m, or CRANK), coupler and rocker 1 m long on a ground of GROUND, but for a coupler that
# makes up for the crank and a rocker that is longer with the ground
rhombus() {
    printf '%s\n' "gicgen: 1" "model: rhombus" "gravity: [0, 0, 0]" "base: ground" "bodies:"
    crank=${2:-1}
    body crank 0 0.5
    body coupler 0.5 1
    body rocker 1 0.5
    echo "joints:"
    hinge first revolute "ground, crank" 0 0
    hinge second revolute "crank, coupler" 0 "$crank"
    hinge third revolute "ground, rocker" "$1" 0
    hinge last point_on_line "coupler, rocker" 1 1
    echo "coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: $(direction), range: [-9, 9]}"
    outputs
}

# strut: a rod of 1 m with a strut of sqrt(5) m to its end from 2 m behind its hinge
strut() {
    printf '%s\n' "gicgen: 1" "model: strut" "gravity: [0, 0, 0]" "base: ground" "bodies:"
    body rod 0 1
    echo "joints:"
    hinge first revolute "ground, rod" 0 0
    echo "coordinates:
  turn: {type: length, bodies: [ground, rod], points: [$(point -2 0), $(point 0 1)], range: [0.5, 4]}"
    outputs
}

# slider: crank 1 m, upright, rod of sqrt(5) m, slider 2 m from the crank's hinge
slider() {
    printf '%s\n' "gicgen: 1" "model: slider" "gravity: [0, 0, 0]" "base: ground" "bodies:"
    body crank 0 0.5
    body rod 1 0.5
    body slider 2 0
    echo "joints:"
    hinge first revolute "ground, crank" 0 0
    hinge second revolute "crank, rod" 0 1
    echo "  guide: {type: prismatic, bodies: [ground, slider], point: $(point 2 0), axis: $(point 1 0)}"
    hinge last point_on_line "rod, slider" 2 0
    echo "coordinates:
  turn: {type: translation, bodies: [ground, slider], axis: $(point 1 0), range: [-9, 9]}"
    outputs
}

# linkage CRANK GROUND COORDINATE_BODIES: a crank upright at the origin, a rocker of 2 m upright at GROUND, a coupler
# between their ends
linkage() {
    echo "gicgen: 1
model: linkage
base: ground
bodies:"
    body crank 0 "$(awk "BEGIN { print $1 / 2 }")"
    body coupler 1 1.5
    body rocker "$2" 1
    echo "joints:"
    hinge first revolute "ground, crank" 0 0
    hinge second revolute "crank, coupler" 0 "$1"
    hinge third revolute "ground, rocker" "$2" 0
    hinge last point_on_line "coupler, rocker" "$2" 2
    echo "coordinates:
  turn: {type: angle, bodies: [$3], axis: $(direction), range: [-9, 9]}"
    outputs
}

# scene RATE: of the coordinate, 4 s, without gravity
scene() {
    printf '%s\n' "gicscene: 1" "duration: 4" "step: 0.001" "integrator: rk4" "output_step: 0.1" \
        "initial: {rates: {turn: $1}}" >scene
}

# ended WHAT VALUE NAME: the last run ended at WHAT, at this value (+- 1e-5) of turn; its last row is of that time
ended() {
    check "$3: it ends" exits 1
    check "$3: it says where" says "error: the run ends at t = [0-9.]* s: a $1 at 'turn' = "
    sed -n "s/.* at 'turn' = \([-0-9.e]*\) .*/\1/p" err >value
    awk -v wanted="$2" 'NR == 1 { d = $1 - wanted; good = d < 1e-5 && d > -1e-5 } END { exit !good }' value
    verdict $? "$3: at $(cat value) instead of $2"
    time=$(sed -n 's/.*ends at t = \([0-9.]*\) s.*/\1/p' err)
    check "$3: the last row is the last state" grep -q "^${time%?}" csv
    [ "$(tail -n 1 csv | cut -d, -f1 | cut -c1-4)" = "$(echo "$time" | cut -c1-4)" ]
    verdict $? "$3: the last row is not at $time: $(tail -n 1 csv)"
}

# remedied NAME: the coordinate that the remedy names runs through, as with the engine gic, and keeps its energy
remedied() {
    entry=$(sed -n 's/^  remedy: to go on there, .*`\(turn: {.*}\)`.*/\1/p' err)
    check "$1: a coordinate instead" [ -n "$entry" ]
    sed "s/^  turn: {type: \(angle\|translation\|length\).*/  $(echo "$entry" | sed 's/}$/, range: [-99, 99]}/')/" m.veh >r.veh
    for engine in tcc gic; do
        run --quiet --engine $engine r.veh scene -o $engine.csv
        check "$1: the remedy runs through ($engine)" exits 0
    done
    # kinetic energy is all there is, without gravity
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /energy.kinetic/) k = i; next }
        { if (NR == 2) first = $k; d = $k / first - 1; if (d * d > worst) worst = d * d }
        END { exit !(NR == 42 && worst < 1e-12) }' tcc.csv
    verdict $? "$1: energy is not kept"
    paste -d, tcc.csv gic.csv | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) { d = $i - $(i + NF / 2);
        if (d > 1e-5 || d < -1e-5) bad = 1 } } END { exit bad || NR < 42 }'
    verdict $? "$1: not as with the engine gic"
}

for axis in x y z; do
    # Crank 1, coupler sqrt(5), rocker 2, ground 2. The rocker turns back where crank and coupler are on one line, of 1 +
    # sqrt(5) or sqrt(5) - 1: its angle above the ground is then acos((4 + 4 - (sqrt(5) +- 1)^2) / 8), 108 or 36 degrees,
    # and 90 as drawn. The crank goes round.
    linkage 1 2 "ground, rocker" | sed "s/^base: ground/gravity: [0, 0, 0]\n&/" >m.veh
    for rate in 1 -1; do
        scene $rate
        for engine in gic tape tcc; do
            run --quiet --engine $engine m.veh scene -o csv
            ended "dead centre" "$([ $rate = 1 ] && echo 0.9424778 || echo -0.3141593)" "rocker $axis $rate $engine"
        done
        check "rocker $axis $rate: the crank" says 'to go on there, .*bodies: \[ground, crank\]'
        check "rocker $axis $rate: it goes round" says 'to go on there, .*never turns back'
        remedied "rocker $axis $rate"
    done
    # strut and rod on one line, of 2 + 1 and 2 - 1
    strut >m.veh
    for rate in 1 -1; do
        scene $rate
        run --quiet m.veh scene -o csv
        ended "dead centre" $((2 + rate)) "strut $axis $rate"
        remedied "strut $axis $rate"
    done
    # crank and rod on one line: the slider at 1 + sqrt(5) and at sqrt(5) - 1 from the hinge, 2 as drawn
    slider >m.veh
    for rate in 1 -1; do
        scene $rate
        run --quiet m.veh scene -o csv
        ended "dead centre" "$([ $rate = 1 ] && echo 1.2360680 || echo -0.7639320)" "slider $axis $rate"
        remedied "slider $axis $rate"
    done
    # variable steps come near, ever shorter, and end there as well; energy leaves no state beyond
    for integrator in rkck adams bdf; do
        for rate in 1 2; do
            scene $rate
            run --quiet --integrator $integrator m.veh scene -o csv
            ended "dead centre" 1.2360680 "slider $axis $rate by $integrator"
        done
    done
    # at a quarter turn the rhombus is folded, and two motions cross
    rhombus 1 >m.veh
    scene 1
    run --quiet m.veh scene -o csv
    ended "change point" 1.5707963 "rhombus $axis"
    check "rhombus $axis: remedy" says "remedy: make the links' lengths differ, the one that 'turn' moves a little shorter"
    # 0.9 + the longest, sqrt(1.01), is less than 1 + 1 (Grashof): the crank goes round
    rhombus 1 0.9 >m.veh
    run --quiet m.veh scene -o csv
    verdict "$status" "rhombus $axis: a shorter crank goes round"
    # a ground longer by 0.02: then the crank turns back where coupler and rocker are on one line, or goes through
    rhombus 1.02 >m.veh
    run --quiet m.veh scene -o csv
    [ "$status" -eq 0 ] || ! says 'change point'
    verdict $? "rhombus $axis: motions part"
done
# Equal parallel arms with ball joints become vertical: there the hub is free to turn both in the plane and to steer, two
# ranks at once. A rack at rest, before the arm in the file, would meet a dead centre of its own 0.1 m aside.
cat >m.veh <<'END'
gicgen: 1
model: corner
gravity: [0, 0, 0]
base: ground
bodies:
  upper: {mass: 2, com: [1, 0.55, 0.5], inertia: [0.1, 0.1, 0.1]}
  lower: {mass: 4, com: [1, 0.55, 0.2], inertia: [0.1, 0.1, 0.1]}
  hub: {mass: 20, com: [1, 0.7, 0.3], inertia: [1, 1, 1]}
  rack: {mass: 5, com: [0.9, 0, 0.3], inertia: [0.2, 0.05, 0.2]}
joints:
  upper: {type: revolute, bodies: [ground, upper], point: [1, 0.4, 0.5], axis: [1, 0, 0]}
  lower: {type: revolute, bodies: [ground, lower], point: [1, 0.4, 0.2], axis: [1, 0, 0]}
  top: {type: spherical, bodies: [upper, hub], point: [1, 0.7, 0.5]}
  bottom: {type: spherical, bodies: [lower, hub], point: [1, 0.7, 0.2]}
  rack: {type: prismatic, bodies: [ground, rack], axis: [0, 1, 0]}
  rod: {type: distance, bodies: [rack, hub], points: [[0.9, 0.4, 0.3], [0.9, 0.7, 0.3]]}
coordinates:
  rack: {type: translation, bodies: [ground, rack], axis: [0, 1, 0], range: [-1, 1], driven: true}
  turn: {type: angle, bodies: [ground, lower], axis: [1, 0, 0], range: [-9, 9]}
END
for sign in '' -; do
    scene ${sign}1
    run --quiet m.veh scene -o csv
    ended "change point" ${sign}1.5707963 "parallel arms ${sign}1 rad/s"
    check "parallel arms: whose links" says "the one that 'turn' moves a little shorter"
done
# a search that long steps do not get through ends all the same
timeout 100 "$gicrun" -q --engine tape "$found/long_search.veh" "$found/long_search.scene" -o csv 2>said
[ $? -eq 1 ] && grep -q 'near a singular configuration' said
verdict $? "search from a place between two bars"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
