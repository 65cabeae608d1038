#!/bin/sh
# SPDX-License-Identifier: MIT
# test_about_axis.sh GICGEN GICRUN: springs, stops and forces about an axis between ground and a body that is free (FORMAT.md
# section 7), drawn at quarter and half turns: they generate although states of the validation lie where their angle has no
# value or jumps; against the closed solution about the axis itself, and engine gic at states askew.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# body KIND AXIS EULER ELEMENT: a ball of 1 kg m^2 that floats, as the base or by six coordinates
body() {
    printf 'gicgen: 1\nmodel: ball\ngravity: [0, 0, 0]\n'
    if [ "$1" = base ]; then
        printf 'base: ball\n'
    else
        printf 'base: ground\ncoordinates:\n'
        for way in 1,0,0 0,1,0 0,0,1; do
            printf '  x%s: {type: translation, bodies: [ground, ball], axis: [%s]}\n' "$(echo $way | tr -d ,)" $way
            printf '  t%s: {type: angle, bodies: [ground, ball], axis: [%s]}\n' "$(echo $way | tr -d ,)" $way
        done
    fi
    cat <<END
bodies: {ball: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1], orientation: {euler: $3}}}
forces: {about: {$4, bodies: [ground, ball], axis: $2}}
outputs:
  turn: {type: angular_velocity, body: ball}
  about: {type: force, element: about}
END
}
half=0.7071067811865476
for kind in base coordinates; do
    for axis in '[1, 0, 0]' '[0, 1, 0]' '[0, 0, 1]' '[1, 1, 0]'; do
        for euler in '[1, 0, 0, 0]' '[0, 0, 1, 0]' "[$half, 0, $half, 0]" '[0.5, 0.5, 0.5, 0.5]'; do
            for element in 'type: spring_damper, stiffness: 10' 'type: spring_damper, stiffness: 10, damping: 1' \
                'type: stop, low: -1, high: 1, stiffness: 10' 'type: force, value: "-10 * angle"'; do
                body $kind "$axis" "$euler" "$element" >ball.veh
                "$gicgen" ball.veh -o ball.c 2>err
                verdict $? "$kind, about $axis, drawn at $euler, $element: $(head -1 err)"
            done
        done
    done
done

# about the axis: phi'' = -10 phi from phi' = w, up to nine tenths of half a turn
for axis in '[1, 0, 0]' '[0, 1, 0]' '[0, 0, 1]'; do
    for euler in '[1, 0, 0, 0]' '[0, 0, 1, 0]' "[$half, 0, $half, 0]"; do
        for w in 1 -3 8.9; do
            body base "$axis" "$euler" 'type: spring_damper, stiffness: 10' >ball.veh
            # the same direction in the body's own axes
            turn=$(echo "$axis $euler $w" | tr -d '[],' | awk '{ q = $4; a = -$5; b = -$6; c = -$7; x = $1; y = $2; z = $3
                tx = 2 * (b * z - c * y); ty = 2 * (c * x - a * z); tz = 2 * (a * y - b * x)
                printf "[%.17g, %.17g, %.17g]", $8 * (x + q * tx + b * tz - c * ty), $8 * (y + q * ty + c * tx - a * tz), $8 * (z + q * tz + a * ty - b * tx) }')
            echo "{gicscene: 1, duration: 2, step: 0.001, integrator: rk4, output_step: 0.25, initial: {angular_velocity: $turn}}" >ball.scene
            for way in '' --general '--engine gic' '--engine tape'; do
                # shellcheck disable=SC2086  # options
                "$gicrun" -q $way ball.veh ball.scene -o ball.csv 2>err &&
                    awk -F, -v w="$w" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^about/) k = i; next }
                        { r = sqrt(10); d = $k - 10 * w / r * sin(r * $1); if (!(d * d <= 1e-18 * w * w)) bad = 1 } END { exit bad || NR != 10 }' ball.csv
                verdict $? "about $axis at $w rad/s, drawn at $euler, ${way:-by default}: $(head -1 err)"
            done
        done
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
