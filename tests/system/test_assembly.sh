#!/bin/sh
# SPDX-License-Identifier: MIT
# test_assembly.sh GICGEN GICRUN: mechanisms put together to lengths that the drawing does not have, initial values,
# angles over several turns, and Newton starts on the wrong side.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
runtime=$(cd "$(dirname "$0")/../../runtime" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# vectors.awk: what the checks below compute with; at(BODY, POINT, out): world place of a body-fixed point of the
# dumped model
cat >vectors.awk <<'AWK'
BEGIN { bodies = 0 }
function size(x) { return x < 0 ? -x : x }
function numbers(line, key, out,    part, n) {
    if (!match(line, "\"" key "\": \\[[^]]*\\]")) return 0
    part = substr(line, RSTART, RLENGTH)
    sub(/.*\[/, "", part)
    sub(/\]/, "", part)
    n = split(part, out, ", ")
    return n
}
function scalar(line, key,    part) {
    if (!match(line, "\"" key "\": [-0-9.e+]+")) return "none"
    part = substr(line, RSTART, RLENGTH)
    sub(/.*: /, "", part)
    return part + 0
}
# A(p) v for the Euler parameters p[1..4], by x + 2 e0 (e x v) + 2 e x (e x v)
function rotate(p, v, out,    c, d) {
    cross(p[2], p[3], p[4], v[1], v[2], v[3], c)
    cross(p[2], p[3], p[4], c[1], c[2], c[3], d)
    for (i = 1; i <= 3; ++i) out[i] = v[i] + 2 * p[1] * c[i] + 2 * d[i]
}
function cross(ax, ay, az, bx, by, bz, out) {
    out[1] = ay * bz - az * by; out[2] = az * bx - ax * bz; out[3] = ax * by - ay * bx
}
function at(body, v, out,    p, x) {
    for (i = 1; i <= 4; ++i) p[i] = euler[body, i]
    rotate(p, v, x)
    for (i = 1; i <= 3; ++i) out[i] = position[body, i] + x[i]
}
function direction(body, v, out,    p) {
    for (i = 1; i <= 4; ++i) p[i] = euler[body, i]
    rotate(p, v, out)
}
function worse(x) { if (!(size(x) <= worst)) worst = size(x) }
/^    \{"name": .*"euler": / {
    numbers($0, "position", x)
    numbers($0, "euler", p)
    for (i = 1; i <= 3; ++i) position[bodies, i] = x[i]
    for (i = 1; i <= 4; ++i) euler[bodies, i] = p[i]
    worse(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2 + p[4] ^ 2 - 1)
    ++bodies
}
AWK
# residual.awk: largest residual of the joints of a dump, by the equations of FORMAT.md section 4
cat >residual.awk <<'AWK'
/^    \{"name": .*"point_b": .*"axis_b": .*"length": / {
    a = scalar($0, "a")
    b = scalar($0, "b")
    numbers($0, "point_a", s)
    at(a, s, xa)
    numbers($0, "point_b", s)
    at(b, s, xb)
    for (i = 1; i <= 3; ++i) d[i] = xb[i] - xa[i]
    squares = d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2
    if (numbers($0, "axis_a", s)) direction(a, s, ua)
    if (/"type": "(distance|revolute_spherical)"/) { worse(sqrt(squares) - scalar($0, "length")); ++rows }
    if (/"type": "revolute_spherical"/) {
        worse(ua[1] * d[1] + ua[2] * d[2] + ua[3] * d[3] - scalar($0, "offset"))
        ++rows
    }
    if (/"type": "(revolute|spherical)"/) { for (i = 1; i <= 3; ++i) worse(d[i]); ++rows }
    if (/"type": "revolute"/) {
        numbers($0, "axis_b", s)
        direction(b, s, ub)
        cross(ua[1], ua[2], ua[3], ub[1], ub[2], ub[3], c)
        for (i = 1; i <= 3; ++i) worse(c[i])
    }
}
END { if (rows != joints || bodies == 0) print "only " rows " rows"; else printf "%.3g\n", worst }
AWK

# fits NAME ROWS: the dumped design of NAME.veh fulfils its joints (ROWS of them counted) to 1e-12
fits() {
    "$gicgen" --dump-model "$1.veh" >"$1.dump" 2>"$1.err"
    verdict $? "$1 is not assembled: $(cat "$1.err")"
    cat vectors.awk residual.awk >both.awk
    residual=$(awk -v joints="$2" -f both.awk "$1.dump")
    echo "$residual" | awk '{ exit !(NF == 1 && $1 ~ /^[0-9]/ && $1 <= 1e-12) }'
    verdict $? "$1: joints of the design are off by $residual"
}

# ---- a four-bar with a longer coupler than drawn -------------------------------------------------------------

four_bar() {
    cat <<END
gicgen: 1
model: $1
base: ground
bodies:
  crank: {mass: 1, com: [0, 0, 1], inertia: [0.5, 0.5, 0.5]}
  rocker: {mass: 1, com: [2.5, 0, 1], inertia: [0.5, 0.5, 0.5]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, rocker], point: [3, 0, 0], axis: [0, 1, 0]}
  coupler: {type: distance, bodies: [crank, rocker], points: [[0, 0, 2], [2, 0, 2]], length: $2}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: [-0.3, 1]$3}
outputs:
  B: {type: position, body: crank, point: [0, 0, 2]}
  C: {type: position, body: rocker, point: [2, 0, 2]}
  turn: {type: coordinate, coordinate: turn}
  energy: {type: energy}
END
}

# The crank stays where it is drawn; the rocker's tip is the upper one of two points 2.3 (or 1.5, 3) from (0, 0, 2)
# and sqrt(5) from the pivot (3, 0, 0). With a along the line between these, 13 = (distance)^2:  a = (length^2 - 5 +
# 13) / (2 sqrt(13)).
for length in 2.3 1.5 3; do
    four_bar "longer" $length >longer.veh
    fits longer 3
    cat vectors.awk - >both.awk <<'AWK'
END {
    long = sqrt(13)
    a = (length_given ^ 2 - 5 + 13) / (2 * long)
    h = sqrt(length_given ^ 2 - a ^ 2)
    tip[1] = -0.5; tip[2] = 0; tip[3] = 1  # from the centre of mass, where the body frame is
    at(2, tip, c)
    worse(c[1] - (3 * a + 2 * h) / long)
    worse(c[2])
    worse(c[3] - (2 - 2 * a / long + 3 * h / long))
    split("0 0 1", drawn, " ")
    for (i = 1; i <= 3; ++i) worse(position[1, i] - drawn[i])
    worse(euler[1, 1] - 1)
    exit !(bodies == 3 && worst <= 1e-12)
}
AWK
    awk -v length_given=$length -f both.awk longer.dump
    verdict $? "coupler of $length: not where two circles meet: $(cat longer.dump)"
done

# as drawn: nothing moves, to the bit
four_bar drawn 2 >drawn.veh
fits drawn 3
grep -q '"name": "rocker".*"position": \[2.5, 0, 1\], "euler": \[1, 0, 0, 0\]' drawn.dump
verdict $? "a length as drawn moves the rocker: $(cat drawn.dump)"

# ---- a wheel suspension: both lengths of an upper arm, its offset, and a tie rod -----------------------------

cat >corner.veh <<'END'
gicgen: 1
model: corner
base: chassis
bodies:
  chassis:
    {mass: 100, com: [0, 0, 0], inertia: [9, 9, 9], position: [0.3, -0.2, 0.5], orientation: {axis: [1, 2, 3], angle: 0.7}}
  arm:
    {mass: 5, com: [0, 0.3, 0], inertia: [1, 1, 1], position: [0, 0.2, 0.1], orientation: {axis: [0, 1, 1], angle: -0.4}}
  knuckle: {mass: 9, com: [0, 0.7, 0.2], inertia: [0.2, 0.2, 0.2]}
joints:
  hinge: {type: revolute, bodies: [chassis, arm], point: [0, 0, 0], axis: [1, 0.1, 0]}
  ball: {type: spherical, bodies: [arm, knuckle], point: [0, 0.6, 0]}
  upper: {type: revolute_spherical, bodies: [chassis, knuckle], points: [[0, 0.1, 0.4], [0.01, 0.55, 0.4]], axis: [1, 0, 0],
    length: 0.44, offset: 0.03}
  tie: {type: distance, bodies: [knuckle, chassis], points: [[-0.2, 0.6, 0.1], [-0.2, 0.1, 0.12]], length: 0.52}
coordinates:
  spring: {type: length, bodies: [chassis, arm], points: [[0, 0.2, 0.5], [0, 0.35, 0]]}
END
# four joints: hinge, ball, tie give a row each, the upper arm two
fits corner 5
# chassis and arm, which the spring holds, stay as they are drawn
"$gicgen" --dump-model corner.veh | grep '"name": "\(chassis\|arm\)", "mass"' >assembled
sed 's/length: 0.44, offset: 0.03}/}/; s/, length: 0.52}/}/' corner.veh >corner_drawn.veh
"$gicgen" --dump-model corner_drawn.veh >corner.dump
grep '"name": "\(chassis\|arm\)", "mass"' corner.dump >as_drawn
cat assembled as_drawn | awk '{ gsub(/[^-0-9.e+]+/, " "); for (i = 1; i <= NF; ++i) v[NR, i] = $i; n[NR] = NF }
    END { for (r = 1; r <= 2; ++r) for (i = 1; i <= n[r]; ++i) if ((v[r, i] - v[r + 2, i]) ^ 2 > 1e-24) bad = 1
          exit bad || NR != 4 || n[1] < 17 || n[1] != n[3] }'
verdict $? "assembly moves what the spring holds: $(cat assembled as_drawn)"
# and the knuckle has really been moved
cat vectors.awk residual.awk >both.awk
sed 's/"length": 0.4[0-9]*/"length": 0.44/' corner.dump | awk -v joints=5 -f both.awk | awk '{ exit !($1 > 1e-3) }'
verdict $? "the check of residuals does not see that lengths differ"

# ---- initial values ------------------------------------------------------------------------------------------

printf '%s\n' "gicscene: 1" "duration: 0.3" "step: 0.001" "integrator: rk4" "output_step: 0.3" >plain.scene
four_bar begun 2.3 ", initial: 0.25" >begun.veh
"$gicrun" --quiet begun.veh plain.scene -o begun.csv 2>begun.err
verdict $? "no run from an initial value: $(cat begun.err)"
# (columns: time B C turn rate acceleration energy)
awk -F, 'NR == 2 { exit !($8 == 0.25 && ($2 - 2 * sin(0.25)) ^ 2 < 1e-24 && ($4 - 2 * cos(0.25)) ^ 2 < 1e-24 &&
    (sqrt(($5 - $2) ^ 2 + ($7 - $4) ^ 2) - 2.3) ^ 2 < 1e-24 && (($5 - 3) ^ 2 + $7 ^ 2 - 5) ^ 2 < 1e-23) }' begun.csv
verdict $? "the run does not begin at 0.25: $(head -n 2 begun.csv)"

# the scene's word is the last
printf '%s\n' "initial: {coordinates: {turn: 0.75}}" | cat plain.scene - >given.scene
"$gicrun" --quiet begun.veh given.scene -o given.csv 2>given.err
awk -F, 'NR == 2 { exit !($8 == 0.75 && ($2 - 2 * sin(0.75)) ^ 2 < 1e-24 &&
    (sqrt(($5 - $2) ^ 2 + ($7 - $4) ^ 2) - 2.3) ^ 2 < 1e-24) }' given.csv
verdict $? "the run does not begin at 0.75: $(head -n 2 given.csv)"

# ---- angles over several turns -------------------------------------------------------------------------------

# A pendulum with L = 1 (see models/pendulum.veh), thrown with 10 rad/s: it passes the top and goes on turning. The
# reference is RK4 on angle'' = 9.81 cos(angle) at a tenth of the step.
cat >pendulum.veh <<'END'
gicgen: 1
model: pendulum
base: ground
bodies:
  rod: {mass: 1, position: [0, 0, 0], com: [-0.5, 0, 0], inertia: [0.25, 0.25, 0.25]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, -1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, rod], axis: [0, -1, 0]}
outputs:
  bob: {type: position, body: rod, point: [-1, 0, 0]}
  angle: {type: coordinate, coordinate: angle}
END
for rate in 10 -10; do
    printf '%s\n' "gicscene: 1" "duration: 4" "step: 0.0005" "integrator: rk4" "output_step: 0.01" \
        "initial: {rates: {angle: $rate}}" >turns.scene
    "$gicrun" --quiet pendulum.veh turns.scene -o turns.csv 2>turns.err
    verdict $? "pendulum at $rate rad/s: $(cat turns.err)"
    # (columns: time bob angle rate acceleration)
    awk -F, -v rate=$rate '
        function size(x) { return x < 0 ? -x : x }
        function step(h,    k1, k2, k3, k4, l1, l2, l3, l4) {
            k1 = v; l1 = 9.81 * cos(w)
            k2 = v + h / 2 * l1; l2 = 9.81 * cos(w + h / 2 * k1)
            k3 = v + h / 2 * l2; l3 = 9.81 * cos(w + h / 2 * k2)
            k4 = v + h * l3; l4 = 9.81 * cos(w + h * k3)
            w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4)
        }
        NR == 2 { w = 0; v = rate }
        NR > 2 { for (i = 0; i < 200; ++i) step(5e-5) }
        NR > 1 {
            if (size($5 - w) > 1e-8 || size($6 - v) > 1e-7) bad = bad " " $1
            if (size($2 + cos(w)) > 1e-8 || size($4 + sin(w)) > 1e-8) bad = bad " bob at " $1
            if (size($6 ^ 2 / 2 - 9.81 * sin($5) - 50) > 1e-7) bad = bad " energy at " $1
            if (NR > 2 && ($5 - last) * rate <= 0) bad = bad " falls at " $1
            last = $5
        }
        END {
            if (NR != 402 || size(last) < 10 * 3.14159265) bad = bad " ends at " last
            print bad
            exit bad != ""
        }' turns.csv >bad
    verdict $? "pendulum at $rate rad/s, wrong at: $(cut -c 1-200 bad)"
done

# a crank that turns with its rocker swinging: ground 3, crank 0.5, coupler 3, rocker 1; the rocker's tip stays above
# the ground
cat >crank.veh <<'END'
gicgen: 1
model: crank
base: ground
gravity: [0, 0, 0]
bodies:
  crank: {mass: 1, com: [0, 0, 0], inertia: [0.5, 0.5, 0.5]}
  rocker: {mass: 1, com: [3, 0, 0.5], inertia: [0.1, 0.1, 0.1]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, rocker], point: [3, 0, 0], axis: [0, 1, 0]}
  coupler: {type: distance, bodies: [crank, rocker], points: [[0, 0, 0.5], [3, 0, 1]], length: 3}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0]}
outputs:
  B: {type: position, body: crank, point: [0, 0, 0.5]}
  C: {type: position, body: rocker, point: [3, 0, 1]}
  turn: {type: coordinate, coordinate: turn}
  energy: {type: energy}
END
printf '%s\n' "gicscene: 1" "duration: 6" "step: 0.001" "integrator: rk4" "output_step: 0.01" \
    "initial: {rates: {turn: 6}}" >crank.scene
"$gicrun" --quiet crank.veh crank.scene -o crank.csv 2>crank.err
verdict $? "crank: $(cat crank.err)"
awk -F, '
    function size(x) { return x < 0 ? -x : x }
    NR == 2 { energy = $11 }
    NR > 1 {
        if (size(sqrt(($5 - $2) ^ 2 + ($7 - $4) ^ 2) - 3) > 1e-11) bad = bad " coupler at " $1
        if (size(($5 - 3) ^ 2 + $7 ^ 2 - 1) > 1e-11 || $7 < 0.1) bad = bad " rocker at " $1
        if (size($2 - 0.5 * sin($8)) > 1e-12 || size($4 - 0.5 * cos($8)) > 1e-12) bad = bad " crank at " $1
        if (size($11 / energy - 1) > 1e-8) bad = bad " energy at " $1
        last = $8
    }
    END {
        if (NR != 602 || last < 10 * 3.14159265) bad = bad " ends at " last
        print bad
        exit bad != ""
    }' crank.csv >bad
verdict $? "crank, wrong at: $(cut -c 1-200 bad)"

# ---- Newton from the wrong side ------------------------------------------------------------------------------

# Every body of one joint, with the pose that its recovery starts from turned by hand. A twentieth of a radian must
# not be seen in the result. Half a turn about the axis of an angle, or about z, is the other root of that angle,
# which is none: no result, or the right one. The same holds a bit beside it for any axis. (Exactly half a turn about
# x reverses the axes of a joint and leaves the angle; two slides and a weld have such roots about every axis: nothing
# that moves continuously comes there, and nothing looks.)
cat >sides.veh <<'END'
gicgen: 1
model: sides
base: ground
bodies:
  rod: {mass: 1, com: [0.2, 0, 1], inertia: [1, 1, 1]}
  cart: {mass: 1, com: [0.2, 2, 1], inertia: [1, 1, 1]}
  sleeve: {mass: 1, com: [0.2, 4, 1], inertia: [1, 1, 1]}
  plate: {mass: 1, com: [0.2, 6, 1], inertia: [1, 1, 1]}
  block: {mass: 1, com: [0.2, 8, 1], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, rod], point: [0, 0, 0.5], axis: [0, 1, 0]}
  guide: {type: prismatic, bodies: [ground, cart], point: [0, 2, 0.5], axis: [0, 1, 0]}
  tube: {type: cylindrical, bodies: [ground, sleeve], point: [0, 4, 0.5], axis: [0, 1, 0]}
  ball: {type: spherical, bodies: [ground, plate], point: [0, 6, 0.5]}
  level: {type: parallel, bodies: [ground, plate], axis: [0, 1, 0]}
  weld: {type: fixed, bodies: [ground, block], point: [0, 8, 0.5]}
coordinates:
  swing: {type: angle, bodies: [ground, rod], axis: [0, 1, 0], initial: 0.25}
  glide: {type: translation, bodies: [ground, cart], axis: [0, 1, 0]}
  push: {type: translation, bodies: [ground, sleeve], axis: [0, 1, 0], points: [[0, 4, 0.5], [0, 4, 0.5]]}
  twist: {type: angle, bodies: [ground, sleeve], axis: [0, 1, 0]}
  lean: {type: angle, bodies: [ground, plate], axis: [0, 1, 0]}
END
cat >main.c <<'END'
#include "sides.c" /* where bodies stand in start[] is known in there alone */

#include <stdio.h>

/* q (position, Euler parameters) turned about a coordinate axis through `point`. */
static void turn(gic_real *q, const gic_real point[3], int axis, gic_real angle)
{
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const gic_real c = cos(angle / 2), s = sin(angle / 2), e0 = q[3], e[3] = {q[4], q[5], q[6]};
    const gic_real a = q[j] - point[j], b = q[k] - point[k];
    q[j] = point[j] + cos(angle) * a - sin(angle) * b;
    q[k] = point[k] + sin(angle) * a + cos(angle) * b;
    q[3] = c * e0 - s * e[axis];
    q[4 + axis] = c * e[axis] + s * e0;
    q[4 + j] = c * e[j] - s * e[k];
    q[4 + k] = c * e[k] + s * e[j];
}

int main(void)
{
    static const gic_real angle[] = {0, 0.05, 3.14159265358979323846, 3.1};
    sides good, bad;
    gic_real rate[SIDES_STATE_ROOM], pose[2][7 * SIDES_BODIES];
    if (sides_setup(&good) != GIC_OK || sides_poses(&good, pose[0]) != GIC_OK || good.x[0] != 0.25)
        return 1;
    for (int body = 1; body < SIDES_BODIES; ++body)
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < 4; ++i) {
                const gic_real point[3] = {0, 2 * (body - 1), 0.5};
                gic_real off = 0;
                sides_snapshot(&good, &bad);
                turn(bad.start[bad.head.flip] + sides_design[body - 1].place, point, axis, angle[i]);
                int status = sides_rhs(&bad, 0, bad.state, rate);
                if (sides_poses(&bad, pose[1]) == GIC_OK)
                    for (int j = 0; j < 7 * SIDES_BODIES; ++j)
                        off = fmax(off, fabs(pose[1][j] - pose[0][j]));
                printf("%s %c %g %d %.2g\n", sides_model.body_name[body], "xyz"[axis], angle[i], status, off);
            }
    return 0;
}
END
"$gicgen" sides.veh -o sides.c &&
    cc -std=c99 -O1 -I. -I"$runtime" main.c "$runtime/gic_runtime.c" -lm -o sides && ./sides >sides.out
verdict $? "wrong side: no program, or it can't be set up"
[ "$(wc -l <sides.out)" -eq 60 ]
verdict $? "wrong side: $(wc -l <sides.out) trials"
while read -r body axis angle status off; do
    case $body.$axis.$angle in
    *.0 | *.0.05) [ "$status" -eq 0 ] && echo "$off" | awk '{ exit !($1 < 1e-13) }' ;;
    *) [ "$status" -ne 0 ] || echo "$off" | awk '{ exit !($1 < 1e-13) }' ;;
    esac
    verdict $? "$body, start turned by $angle about $axis: status $status, result off by $off"
done <sides.out

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
