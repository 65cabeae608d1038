#!/bin/sh
# SPDX-License-Identifier: MIT
# test_turned.sh GICGEN GICRUN REFERENCE AGREE: mechanisms on bodies that turn. None of their states is singular, however
# far what carries them has turned, by quarters, halves or many turns; all are accepted and within 5e-13 of the
# reference in quad precision, as in test_accelerations.sh. And what is singular is told where it begins.
gicgen=$1
gicrun=$2
reference=$3
agree=$4
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# same LABEL EXPECTED FOUND
same() {
    [ "$2" = "$3" ]
    verdict $? "$1: expected '$2', found '$3'"
}

# A table that turns about z, and what stands on it. Gravity slants.
# table NAME BASE [COORDINATE...]: bodies, joints and coordinates in $work/bodies, joints, coordinates
table() {
    cat <<END
gicgen: 1
model: $1
base: $2
gravity: [2, 1, -9.81]
bodies:
$([ "$2" = ground ] || echo "  $2: {mass: 10, com: [0, 0, -0.5], inertia: [1, 2, 3]}")
  table: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
$(cat "$work/bodies")
joints:
  turn: {type: revolute, bodies: [$2, table], point: [0, 0, 0], axis: [0, 0, 1]}
$(cat "$work/joints")
coordinates:
  turn: {type: angle, bodies: [$2, table], axis: [0, 0, 1]}
$(cat "$work/coordinates")
END
}

# slider along x; hinge about x, y and a slanting axis; a ball joint with three angles; a hinge on a hinge
slider() {
    echo '  slider: {mass: 1, com: [0.5, 0, 0], inertia: [0.1, 0.2, 0.3]}' >"$work/bodies"
    echo '  slide: {type: prismatic, bodies: [table, slider], axis: [1, 0, 0]}' >"$work/joints"
    echo '  w: {type: translation, bodies: [table, slider], axis: [1, 0, 0], range: [-0.4, 0.4]}' >"$work/coordinates"
}
hinge() {
    echo '  arm: {mass: 1, com: [1, 0, 0.5], inertia: [0.1, 0.2, 0.3]}' >"$work/bodies"
    echo "  hinge: {type: revolute, bodies: [$2], point: [1, 0, 0], axis: $1}" >"$work/joints"
    echo "  w: {type: angle, bodies: [$2], axis: $1}" >"$work/coordinates"
}
two_hinges() {
    hinge '[0, 1, 0]' 'table, arm'
    echo '  rod: {mass: 0.5, com: [1, 0, 1.5], inertia: [0.1, 0.1, 0.05]}' >>"$work/bodies"
    echo '  elbow: {type: revolute, bodies: [arm, rod], point: [1, 0, 1], axis: [1, 0, 0]}' >>"$work/joints"
    echo '  v: {type: angle, bodies: [arm, rod], axis: [1, 0, 0]}' >>"$work/coordinates"
}
# a bar that stands on two struts of the table, one of which a coordinate lengthens: a loop of three bodies
loop() {
    cat >"$work/bodies" <<'END'
  crank: {mass: 1, com: [0, 0, 0.5], inertia: [0.1, 0.1, 0.01]}
  bar: {mass: 1, com: [1, 0, 1], inertia: [0.01, 0.1, 0.1]}
  strut: {mass: 1, com: [2, 0, 0.5], inertia: [0.1, 0.1, 0.01]}
END
    cat >"$work/joints" <<'END'
  a: {type: revolute, bodies: [table, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  b: {type: revolute, bodies: [crank, bar], point: [0, 0, 1], axis: [0, 1, 0]}
  c: {type: point_on_line, bodies: [bar, strut], point: [2, 0, 1], axis: [0, 1, 0]}
  d: {type: revolute, bodies: [table, strut], point: [2, 0, 0], axis: [0, 1, 0]}
END
    echo '  w: {type: angle, bodies: [table, crank], axis: [0, 1, 0], range: [-1, 1]}' >"$work/coordinates"
}
# five rods hold a body to the table, a sixth one is the coordinate
platform() {
    echo '  top: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}' >"$work/bodies"
    cat >"$work/joints" <<'END'
  p1: {type: distance, bodies: [table, top], points: [[1, 0, 0], [1, 0.5, 1]]}
  p2: {type: distance, bodies: [table, top], points: [[1, 1, 0], [0.5, 1, 1]]}
  p3: {type: distance, bodies: [table, top], points: [[-1, 1, 0], [-0.5, 1, 1]]}
  p4: {type: distance, bodies: [table, top], points: [[-1, 0, 0], [-1, 0.5, 1]]}
  p5: {type: distance, bodies: [table, top], points: [[0, -1, 0], [-0.5, -1, 1]]}
END
    echo '  w: {type: length, bodies: [table, top], points: [[0, -1, 0], [0.5, -1, 1]], range: [1, 1.2]}' >"$work/coordinates"
}

# states COORDINATES VALUES BASE: the table at quarters and halves of a turn, and in between; others at their values.
# Everything moves, so that no sum of terms is 0 throughout.
states() {
    awk -v names="$1" -v values="$2" -v base="$3" 'BEGIN {
        n = split(names, name, ","); split(values, value, ","); quarter = atan2(1, 0)
        split("-8 -3 -2 -1 0.7 1 2 5", turns, " ")
        line = base == "ground" ? "turn,turn.rate" : "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z,turn,turn.rate"
        for (i = 1; i <= n; ++i) line = line "," name[i] "," name[i] ".rate"
        print line
        for (k = 1; k in turns; ++k) for (j = 1; j in value; ++j) {
            half = k % 2 # the base upside down at every other state
            line = base == "ground" ? "" : sprintf("1,2,0,%d,%d,0,0,1,0,2,0,1,1,", 1 - half, half)
            line = line sprintf("%.17g,1", turns[k] * quarter)
            for (i = 1; i <= n; ++i) line = line sprintf(",%s,-0.5", value[j])
            print line
        }
    }'
}

# judge NAME COORDINATES VALUES
judge() {
    for base in ground car; do
        table "m_$1" $base >"$work/$1.veh"
        states "$2" "$3" $base >"$work/states"
        "$gicgen" --dump-model "$work/$1.veh" >"$work/dump" 2>"$work/said" &&
            "$reference" "$work/dump" "$work/states" -o "$work/accelerations" 2>"$work/said"
        for options in "--recovery closed" "--recovery newton" "--solve augmented"; do
            # shellcheck disable=SC2086  # two words
            "$gicrun" --engine tape $options --eval "$work/states" "$work/$1.veh" -o "$work/results" 2>"$work/said"
            same "$1 on $base, $options: refused" "" "$(grep 'no result' "$work/said")"
            "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 5e-13 >"$work/log" 2>&1
            same "$1 on $base, $options" 0 $?
        done
    done
}

angles='0,1.5707963267948966,3.1415926535897931'
slider
judge slider w '0,-0.4'
while read -r axis bodies; do
    hinge "$axis" "$bodies"
    judge "hinge" w "$angles"
done <<'END'
[1,0,0] table, arm
[0,1,0] arm, table
[0,0,1] table, arm
[1,-1,0.5] arm, table
END
two_hinges
judge two_hinges w,v "$angles"
loop
judge loop w '0,-0.5,1'
platform
judge platform w '1.1180339887498949,1.15,1.1'

# fast and for long: 100 rad/s and steps of 10 ms, a quarter turn in 1.6 of them; energy stays
hinge '[1, 0, 0]' 'table, arm'
table fast ground >"$work/fast.veh"
echo 'outputs: {e: {type: energy}}' >>"$work/fast.veh"
cat >"$work/fast.scene" <<'END'
gicscene: 1
duration: 2
step: 0.0005
integrator: rk4
output_step: 0.5
initial: {rates: {turn: 100, w: 100}}
END
for options in "--engine tape" "--engine tape --recovery newton"; do
    # shellcheck disable=SC2086
    "$gicrun" $options "$work/fast.veh" "$work/fast.scene" -o "$work/run.csv" >"$work/said" 2>&1
    same "fast, $options" 0 $?
    sed -i 's/^step:.*/step: 0.0005/' "$work/fast.scene"
    drift=$(awk -F, 'NR == 2 { first = $2 + $3 } NR > 2 { d = ($2 + $3 - first) / first; if (d < 0) d = -d; if (d > most) most = d }
        END { print most < 1e-5 ? "small" : most }' "$work/run.csv")
    same "fast, $options: energy" small "$drift"
done
# one step of 10 ms at 100 rad/s: refused as too long for the motion, if at all, and not as singular
sed -i 's/^step:.*/step: 0.01/; s/^duration:.*/duration: 0.5/; s/w: 100/w: 1/; s/turn: 100/turn: 60/' "$work/fast.scene"
"$gicrun" --engine tape "$work/fast.veh" "$work/fast.scene" -o "$work/run.csv" >"$work/said" 2>&1
same "10 ms at 60 rad/s" "" "$(grep singular "$work/said")"

# The pose of a ball joint by three angles stops being told where a direction falls onto its axis: at a quarter turn of
# the first one. Up to there all ways agree, beyond none goes on.
cat >"$work/ball.veh" <<'END'
gicgen: 1
model: ball
base: ground
bodies:
  top: {mass: 1, com: [1, 0, 1], inertia: [1, 2, 3]}
joints:
  ball: {type: spherical, bodies: [ground, top], point: [0, 0, 1]}
coordinates:
  yaw: {type: angle, bodies: [ground, top], axis: [0, 0, 1]}
  pitch: {type: angle, bodies: [ground, top], axis: [0, 1, 0]}
  roll: {type: angle, bodies: [ground, top], axis: [1, 0, 0]}
END
printf 'yaw,pitch,roll,yaw.rate,pitch.rate,roll.rate\n0,0,0,1,1,1\n1,0,0,1,0,1\n1.5,0,0,1,0,1\n1.6,0,0,1,0,1\n2,0,0,1,0,1\n' >"$work/states"
for options in "--recovery closed" "--recovery newton" "--solve augmented"; do
    # shellcheck disable=SC2086
    "$gicrun" --engine tape $options --eval "$work/states" "$work/ball.veh" -o "$work/results" 2>/dev/null
    same "ball, $options" "1 1 1 0 0 " "$(awk -F, 'NR > 1 { printf "%d ", $1 != "" }' "$work/results")"
done

# Six hinges, of which the last is told by a ball joint and one right angle: the determinant touches zero at -pi/6 and
# does not change its sign there.
cat >"$work/bricard.veh" <<'END'
gicgen: 1
model: bricard
gravity: [0, -9.81, 0]
base: ground
bodies:
  r1: {mass: 1, com: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1]}
  r2: {mass: 1, com: [1, -0.5, 0], inertia: [0.1, 0.1, 0.1]}
  r3: {mass: 1, com: [1, -1, 0.5], inertia: [0.1, 0.1, 0.1]}
  r4: {mass: 1, com: [0.5, -1, 1], inertia: [0.1, 0.1, 0.1]}
  r5: {mass: 1, com: [0, -0.5, 1], inertia: [0.1, 0.1, 0.1]}
joints:
  j0: {type: revolute, bodies: [ground, r1], point: [0, 0, 0], axis: [0, 1, 0]}
  j1: {type: revolute, bodies: [r1, r2], point: [1, 0, 0], axis: [0, 0, 1]}
  j2: {type: revolute, bodies: [r2, r3], point: [1, -1, 0], axis: [1, 0, 0]}
  j3: {type: revolute, bodies: [r3, r4], point: [1, -1, 1], axis: [0, 1, 0]}
  j4: {type: revolute, bodies: [r4, r5], point: [0, -1, 1], axis: [0, 0, 1]}
  j5: {type: spherical, bodies: [r5, ground], point: [0, 0, 1]}
  j6: {type: perpendicular, bodies: [r5, ground], axes: [[1, 0, 0], [0, 1, 0]]}
coordinates:
  phi: {type: angle, bodies: [ground, r1], axis: [0, 1, 0], range: [-3, 3]}
outputs:
  e: {type: energy}
END
"$gicgen" "$work/bricard.veh" -o "$work/bricard.c" 2>"$work/said"
found=$(sed -n "s/.*coordinate 'phi' stops being independent at \(-[0-9.]*\),.*/\1/p" "$work/said")
same "Bricard's place" near "$(awk -v x="$found" 'BEGIN { d = x + 0.5235987755982988; print d * d < 1e-4 ? "near" : x }')"
cat >"$work/bricard.scene" <<'END'
gicscene: 1
duration: 10
step: 0.005
integrator: rk4
output_step: 1
END
"$gicrun" --engine tape "$work/bricard.veh" "$work/bricard.scene" -o "$work/run.csv" >"$work/said" 2>&1
same "Bricard's motion between such places" 0 $?
drift=$(awk -F, 'NR == 2 { first = $2 + $3 } NR > 2 { d = $2 + $3 - first; if (d < 0) d = -d; if (d > most) most = d }
    END { print most < 1e-4 ? "small" : most }' "$work/run.csv")
same "Bricard's energy" small "$drift"
sed -i 's/^duration:.*/&\ninitial: {rates: {phi: -8}}/' "$work/bricard.scene"
"$gicrun" --engine tape "$work/bricard.veh" "$work/bricard.scene" -o "$work/run.csv" >"$work/said" 2>&1
same "Bricard's passage is refused" "1 1" "$? $(grep -c 'near a singular configuration' "$work/said")"

# A strut that passes the hinge of its arm at a small distance: the design is near the place where its length stops
# telling the pose, or, at 1e-4 of its own length, next to it.
strut() {
    cat <<END
gicgen: 1
model: strut
base: ground
bodies: {arm: {mass: 1, com: [0.5, 0, 0], inertia: [0.1, 0.2, 0.3]}}
joints: {hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}}
coordinates: {w: {type: length, bodies: [ground, arm], points: [[1, 0, $1], [0.5, 0, 0]]}}
END
}
for distance in 0.1 0.02 0.01 0.005 0.001; do
    strut $distance >"$work/strut.veh"
    awk -v e=$distance 'BEGIN { printf "w,w.rate\n%.17g,1\n%.17g,0\n", sqrt(0.25 + e * e), sqrt(0.25 + e * e) }' >"$work/states"
    "$gicgen" --dump-model "$work/strut.veh" >"$work/dump" 2>"$work/said" &&
        "$reference" "$work/dump" "$work/states" -o "$work/accelerations" 2>"$work/said"
    for options in "" "--recovery newton" "--solve augmented"; do
        # shellcheck disable=SC2086
        "$gicrun" --engine tape $options --eval "$work/states" "$work/strut.veh" -o "$work/results" 2>/dev/null
        "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 1e-8 --condition 1e9 >"$work/log" 2>&1
        same "strut $distance from the hinge, $options" 0 $?
    done
done
strut 0.0001 >"$work/strut.veh"
"$gicgen" "$work/strut.veh" -o "$work/strut.c" >"$work/said" 2>&1
same "strut next to the hinge" "1 1" "$? $(grep -c "next to a singular one: coordinate 'w'" "$work/said")"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
