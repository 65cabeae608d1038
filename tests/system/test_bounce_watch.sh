#!/bin/sh
# SPDX-License-Identifier: MIT
# test_bounce_watch.sh GICRUN GICSWEEP: runs whose bodies bounce higher than their stops let them are reported, others are not.
gicrun=$(realpath "$1")
gicsweep=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1
cp "$root/tests/data/contact/drop.veh" .

check "heights of bounces against the drop height" sh -c "python3 '$root/tests/data/contact/drop.py' '$gicrun' drop.veh >said 2>&1"

scene() {
    printf 'gicscene: 1\nduration: 2\nstep: %s\nlocate: %s\n' "$1" "$2"
    printf 'initial: {coordinates: {z: 0.2}}\nparameters: {k: 10000, c: %s}\n' "$3"
}
scene 0.01 false 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "100 rad/s at 10 ms by AB3 fails" exits 1
check "with element, time and factor" says "the low end of stop 'floor' gives back more than it may: at t = .* a body bounces 3.99 times"
check "and the remedy" says "remedy: take steps of at most about 0.0016 s, or .locate: true."
check "all results are there" [ "$(wc -l <now.csv)" -eq 202 ]
scene 0.0016 false 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "the step that it tells is quiet" exits 0
scene 0.0016 true 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "so are contacts that are located" exits 0
scene 0.01 false 100 >now.scene
run -q drop.veh now.scene -o now.csv
check "a stop with a damper at 10 ms fails too" exits 1
for method in ab3 rk4; do
    grep -v '^ratio' "$root/models/scenes/tires_rough.scene" >rough.scene
    run -q --integrator "$method" "$root/models/hmmwv_tires.veh" rough.scene -o rough.csv
    check "a rough road is no stop: $method" sh -c "! grep -q 'gives back' err"
done

# pushed onto a stop by a constant force a body comes to rest there, or bounces as high as it began: it never has more than
# the sqrt(2 F 0.1) m/s of its way to the stop. Where the force is 20 N it is just there at the end of a step, its gap 0
while read -r force damping method step wrong; do
    cat >pushed.veh <<END
gicgen: 1
model: pushed
base: ground
gravity: [0, 0, 0]
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  p: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-10, 10]}
forces:
  push: {type: force, coordinate: x, value: "$force"}
  s: {type: stop, coordinate: x, high: 0.1, stiffness: 1e6, damping: $damping, fade: 0.0001}
outputs:
  x: {type: coordinate, coordinate: x}
END
    for locate in false true; do
        printf 'gicscene: 1\nduration: %s\nintegrator: %s\nstep: %s\nlocate: %s\n' "$(awk "BEGIN { print 200 * $step }")" "$method" "$step" $locate >pushed.scene
        run -q pushed.veh pushed.scene -o pushed.csv
        # it is reported where a rate is above, and nowhere else
        fast=$(awk -F, -v most="$(awk "BEGIN { print 1.02 * sqrt(0.2 * $force) }")" 'NR > 1 && $3 ^ 2 > most ^ 2 { n = 1 } END { print n + 0 }' pushed.csv)
        check "$force N, $damping N s/m, $method, $step s, locate $locate" exits "$fast"
        [ $locate = true ] || check "and that is wrong" [ "$fast" -eq "$wrong" ]
        [ "$fast" -eq 0 ] || check "as a stop that gives back too much, or a step that goes too far" says "the high end of stop 's' gives back more than it may\|moves too far within a step"
    done
done <<END
50 2000 ros3 0.01 1
50 2000 ros2 0.01 1
50 2000 exp3 0.02 1
50 2000 rk4 0.02 1
50 2000 rk4 0.01 1
50 2000 imex 0.02 1
20 0 rk4 0.02 1
20 2000 rk4 0.02 1
20 0 ab3 0.01 1
5 2000 ros3 0.01 1
50 2000 rk4 0.0004 0
20 0 rk4 0.0002 0
50 2000 ros3 0.0002 0
END

# between two undamped stops a body keeps its 1 m/s; thrown back hundreds of times as fast it is never free for long
cat >between.veh <<END
gicgen: 1
model: between
base: ground
gravity: [0, 0, 0]
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  p: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-10, 10]}
forces:
  s: {type: stop, coordinate: x, low: -0.2, high: 0.2, stiffness: 1e6}
outputs:
  x: {type: coordinate, coordinate: x}
END
for method in ab3 ros2 ros3 imex; do
    printf 'gicscene: 1\nduration: 2\nintegrator: %s\nstep: 0.005\ninitial: {rates: {x: 1}, coordinates: {x: 0.1}}\n' $method >between.scene
    run -q between.veh between.scene -o between.csv
    check "between two stops by $method" exits 1
done

# Stops so stiff that a contact is 0.0005 to 0.1 of a step. A body comes up as high as it was let go from, within 4 %,
# or the run fails; most of these methods would throw it away by kilometres.
for method in ab3 rk4 ros2 ros3 imex exp3; do
    thrown=
    for k in 1.5e8 1e9 1e10 6e10 1e12; do
        for located in false true; do
            scene 0.002 $located 0 | sed "s/k: 10000/k: $k/" >stiff.scene
            rm -f stiff.csv
            "$gicrun" -q --integrator $method drop.veh stiff.scene -o stiff.csv 2>err
            status=$?
            highest=$(awk -F, 'NR > 1 && $2 > most {most = $2} END {print most + 0}' stiff.csv)
            [ $status -ne 0 ] || awk -v z="$highest" 'BEGIN {exit !(z < 0.2 * 1.04)}' ||
                thrown="$thrown $k $located $highest"
        done
    done
    check "none is thrown away in silence by $method:$thrown" [ -z "$thrown" ]
done

# sweeps: the same verdicts, in lanes and each by itself. Heights from 0.1 m, where a bounce is the same at all heights
# but for where the steps fall
for step in 0.01 0.001; do
    scene $step false 0 | sed '/^initial/d' >sweep.scene
    for way in "" "--engine tape"; do
        # shellcheck disable=SC2086  # words
        "$gicsweep" $way drop.veh sweep.scene --vary z=0.1:0.3:5 -o sweep.csv 2>err
        [ "$(sed 1d sweep.csv | cut -d, -f3 | sort | uniq -c | tr -s ' ')" = "$([ $step = 0.01 ] && echo ' 5 -14' || echo ' 5 0')" ]
        verdict $? "a sweep with steps of $step s $way: $(cut -d, -f1-3 sweep.csv | tr '\n' ' ')"
        [ $step = 0.001 ] || check "which says why $way" says "the low end of stop 'floor' gives back more than it may"
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
