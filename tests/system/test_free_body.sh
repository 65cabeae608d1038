#!/bin/sh
# SPDX-License-Identifier: MIT
# test_free_body.sh GICGEN GICRUN: bodies that force elements alone hold, by three translations and three angles (FORMAT.md
# section 5.1): recovered in closed form; natural frequencies on four bushings by hand; a top that spins and nods over several
# turns against the closed solution; where the angles end; engines and ways of generating.
# Accelerations against quad precision are in test_accelerations, derivatives in test_tangent.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# body NAME INERTIA FORCES: a body of 4 kg that nothing ties to ground
body() {
    cat <<END
gicgen: 1
model: $1
gravity: [0, 0, 0]
base: ground
bodies: {cab: {mass: 4, com: [1, 2, 3], inertia: [$2]}}
coordinates:
  x: {type: translation, bodies: [ground, cab], axis: [1, 0, 0]}
  y: {type: translation, bodies: [ground, cab], axis: [0, 1, 0]}
  z: {type: translation, bodies: [ground, cab], axis: [0, 0, 1]}
  roll: {type: angle, bodies: [ground, cab], axis: [1, 0, 0], range: [-20, 20]}
  pitch: {type: angle, bodies: [ground, cab], axis: [0, 1, 0], range: [-1.4, 1.4]}
  yaw: {type: angle, bodies: [ground, cab], axis: [0, 0, 1], range: [-1.4, 1.4]}
forces: {$3}
outputs:
  omega: {type: angular_velocity, body: cab, in: cab}
  cab: {type: position, body: cab}
  turn: {type: orientation, body: cab}
  e: {type: energy}
END
}

# ---- no iteration is left: the code is that of closed forms
body top '1, 2, 2' '' >top.veh
mkdir closed newton && "$gicgen" top.veh -o top.c && "$gicgen" --recovery closed top.veh -o closed/top.c &&
    "$gicgen" --recovery newton top.veh -o newton/top.c && cmp -s top.c closed/top.c && ! cmp -s top.c newton/top.c
verdict $? 'the closed form is found and taken'

# ---- four bushings of 100, 200 and 300 N/m at x = 1 +- 0.5, y = 2 +- 0.4, in the height of the centre of mass:
# x'' = -400/4 x, y'' = -800/4 y, z'' = -1200/4 z; roll: 1200 * 0.16 / 2; pitch: 1200 * 0.25 / 3; yaw: (400 * 0.16 + 800 * 0.25) / 4
four=
for at in '1.5, 2.4' '1.5, 1.6' '0.5, 2.4' '0.5, 1.6'; do
    four="${four}m${#four}: {type: bushing, bodies: [ground, cab], point: [$at, 3], stiffness: [100, 200, 300, 0, 0, 0]}, "
done
body mounted '2, 3, 4' "$four" >mounted.veh
printf 'gicscene: 1\nduration: 1\nstep: 0.01\n' >still.scene
"$gicrun" --modes mounted.veh still.scene >modes 2>err
modes=$(awk 'BEGIN { for (i = split("100 200 300 96 100 66", k, " "); i > 0; --i) printf "%.6g\n", sqrt(k[i]) / 6.283185307179586 }' | sort -g)
awk '$0 ~ /^ *[0-9]/ { print }' modes | tr -s ' ' >rows
for hertz in $modes; do
    awk -v want="$hertz" '{ for (i = 1; i <= NF; ++i) if ($i ~ /^[0-9.e+-]+$/ && ($i - want) ^ 2 < 1e-6 * want ^ 2) found = 1 } END { exit !found }' rows
    verdict $? "a natural frequency of $hertz Hz on four bushings"
done
every_way 'on four bushings' 1e-10 mounted.veh still.scene

# ---- a body of moments 1, 2, 2 without forces: about its own x axis it keeps its angular velocity n, and what it has across turns
# at n (2 - 1) / 2; 12 rad/s for 1.5 s are almost three turns of roll
printf 'gicscene: 1\nduration: 1.5\nstep: 0.0005\noutput_step: 0.1\nintegrator: rk4\ninitial: {rates: {roll: 12, pitch: 1, x: 2, y: -1}}\n' >top.scene
"$gicrun" -q top.veh top.scene -o top.csv 2>err
for number in 'omega.x 12' 'omega.y cos(6*t)' 'omega.z -sin(6*t)' 'cab.x 1+2*t' 'cab.y 2-t' 'cab.z 3' 'e.kinetic 0.5*(144+2*1)+0.5*4*5'; do
    column "${number%% *}" top.csv | awk '{ t = 0.1 * (NR - 1); d = $1 - ('"${number#* }"'); if (!(d * d <= 1e-16)) { bad = 1; print t, $1, d } } END { exit bad || NR != 16 }' >off
    verdict $? "a top: $number: $(head -2 off | tail -1)"
done
# its axis goes round the angular momentum (12, 2, 0) at |L| / 2 = 6.08 rad/s, at the same angle
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if (index($i, "turn.e0 ") == 1 || $i == "turn.e0") e = i } next }
    { a = $e; b = $(e + 1); c = $(e + 2); d = $(e + 3); x = 2 * (a * a + b * b) - 1; y = 2 * (b * c + a * d); z = 2 * (b * d - a * c)
      l = sqrt(148); t = 0.1 * (NR - 2); w = l / 2; cs = 12 / l; sn = 2 / l
      # across the momentum the axis begins at sn (sn, -cs, 0) and turns about (cs, sn, 0)
      X = cs * cs + sn * sn * cos(w * t); Y = cs * sn - sn * cs * cos(w * t); Z = -sn * sin(w * t)
      q = (x - X) ^ 2 + (y - Y) ^ 2 + (z - Z) ^ 2; if (!(q <= 1e-15)) { bad = 1; print t, x, y, z, X, Y, Z } } END { exit bad || NR != 17 }' top.csv >off
verdict $? "a top: its axis: $(head -1 off)"
some_ways 'a top' 1e-8 top.veh top.scene '' '--general' '--engine cc --lanes 4' '--solve augmented' '--recovery newton' '--engine gcp1'

# ---- places and attitudes in any order: roll over any turns, pitch and yaw up to a quarter turn
{
    echo x,y,z,roll,pitch,yaw,x.rate,y.rate,z.rate,roll.rate,pitch.rate,yaw.rate
    for angles in 0,0,0 1.5707963267948966,0,0 3.141592653589793,0.5,-0.5 -12.566370614359172,1,1 100,-1.2,1.3 0,1.4,-1.4; do
        echo "0.1,-0.2,0.3,$angles,0,0,0,1,2,3"
    done
} >places
for way in '' '--engine gic' '--recovery newton' '--solve augmented'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" $way --eval places top.veh -o eval.csv 2>err
    # the axes: x_b is along (cos p cos w, cos p sin w, -sin p cos w); of y_b the part across x is along (cos r, sin r)
    paste -d, places eval.csv | awk -F, 'NR == 1 { for (i = 13; i <= NF; ++i) { if ($i ~ /^status/) k = i; if ($i ~ /^cab.e0/) e = i } next }
        { r = $4; p = $5; w = $6; a = $e; b = $(e + 1); c = $(e + 2); d = $(e + 3)
          X = 2 * (a * a + b * b) - 1; Y = 2 * (b * c + a * d); Z = 2 * (b * d - a * c)
          x = cos(p) * cos(w); y = cos(p) * sin(w); z = -sin(p) * cos(w); l = sqrt(x * x + y * y + z * z)
          q = (X - x / l) ^ 2 + (Y - y / l) ^ 2 + (Z - z / l) ^ 2
          yy = 2 * (a * a + c * c) - 1; yz = 2 * (c * d + a * b); m = sqrt(yy * yy + yz * yz); q += (yy / m - cos(r)) ^ 2 + (yz / m - sin(r)) ^ 2
          if ($k != 0 || !(q <= 1e-24)) { bad = 1; print } } END { exit bad || NR != 7 }' >off
    verdict $? "attitudes ${way:-by default}: $(head -1 off)"
done
# beyond, a status and no number that is none
{
    head -1 places
    for angles in 0,1.569,0 0,0,1.569 0,-1.57,1.57 0,2,0; do echo "0,0,0,$angles,0,0,0,0,0,0"; done
} >beyond
"$gicrun" --eval beyond top.veh -o eval.csv 2>err
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^status/) k = i; next } $k == 0 { bad = 1 } END { exit bad || NR != 5 }' eval.csv && ! grep -qi nan eval.csv
verdict $? 'a quarter turn of pitch or yaw'

# ---- a cab on mounts with an arm on mounts
model=$root/tests/data/laws/free.veh
printf 'gicscene: 1\nduration: 0.5\nstep: 0.001\noutput_step: 0.1\nintegrator: rk4\ninitial: {rates: {roll: 1, arm_yaw: 3, swing: 2}, angular_velocity: [0.1, 0.2, 0.3]}\n' >car.scene
every_way 'a cab and an arm' 1e-9 "$model" car.scene
"$gicgen" "$model" -o mounted.c && "$gicgen" --batch 4 "$model" -o batch.c && "$gicgen" --derivatives "$model" -o tangent.c 2>said
verdict $? 'a batch, and derivatives'
for file in mounted batch tangent; do
    cc -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -I. -I"$root/runtime" $file.c 2>said
    verdict $? "no warnings: $file.c"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
