#!/bin/sh
# SPDX-License-Identifier: MIT
# test_arguments.sh GICGEN: files that ask the one which includes them for numbers, points and bodies (FORMAT.md section 12): three
# axles of one file against the same written out, given numbers and names, passed on through a file between, with defaults
# and mirror images; mistakes, with the place in either file.
gicgen=$(realpath "$1")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
mkdir parts

cat >parts/axle.veh <<'END'
gicgen: 1
arguments:
  carrier: body
  hub: point
  mass: {type: number, default: 50}
  rate: number
parameters: {half: mass / 2}
points: {top_l: [0, 0.5, 1]}
bodies:
  beam: {mass: mass, com: hub, inertia: [half, 1, half]}
joints:
  slide: {type: prismatic, bodies: [carrier, beam], axis: [0, 0, 1], point: [0, 0, 0.3]}
coordinates:
  bump: {type: translation, bodies: [carrier, beam], axis: [0, 0, 1]}
forces:
  spring: {type: spring_damper, coordinate: bump, stiffness: rate, damping: rate / 100 + mass}
  strut_l: {type: spring_damper, bodies: [carrier, beam], points: [top_l, hub], stiffness: "2 * rate"}
END
# passes on what it is asked for
cat >parts/rear.veh <<'END'
gicgen: 1
arguments: {carrier: body, stiff: number, where: {type: point, default: [0, 0, 0.5]}}
include: {file: axle.veh, prefix: r_, with: {carrier: carrier, hub: where, rate: stiff, mass: 70}}
END
cat >truck.veh <<'END'
gicgen: 1
model: truck
base: frame
include:
  - {file: parts/axle.veh, prefix: a_, at: [3, 0, 0], with: {carrier: frame, hub: [3, 0, 0.5], rate: 2e5}}
  - {file: parts/axle.veh, prefix: b_, at: [-1, 0, 0], with: {carrier: frame, hub: second, rate: soft, mass: 60}}
  - {file: parts/rear.veh, prefix: c_, at: [-2, 0, 0], with: {carrier: bogie, stiff: soft}}
points: {second: [-1, 0, 0.25]}
parameters: {soft: {value: 1e5, tunable: true}}
bodies:
  frame: {mass: 1000, com: [0, 0, 1], inertia: [100, 1000, 1000]}
  bogie: {mass: 100, com: [-2, 0, 1], inertia: [10, 10, 10]}
joints: {pivot: {type: revolute, bodies: [frame, bogie], point: [-2, 0, 1], axis: [0, 1, 0]}}
coordinates: {nod: {type: angle, bodies: [frame, bogie], axis: [0, 1, 0]}}
END
cat >written.veh <<'END'
gicgen: 1
model: truck
base: frame
parameters: {soft: {value: 1e5, tunable: true}}
bodies:
  a_beam: {mass: 50, com: [3, 0, 0.5], inertia: [25, 1, 25]}
  b_beam: {mass: 60, com: [-1, 0, 0.25], inertia: [30, 1, 30]}
  c_r_beam: {mass: 70, com: [-2, 0, 0.5], inertia: [35, 1, 35]}
  frame: {mass: 1000, com: [0, 0, 1], inertia: [100, 1000, 1000]}
  bogie: {mass: 100, com: [-2, 0, 1], inertia: [10, 10, 10]}
joints:
  a_slide: {type: prismatic, bodies: [frame, a_beam], axis: [0, 0, 1], point: [3, 0, 0.3]}
  b_slide: {type: prismatic, bodies: [frame, b_beam], axis: [0, 0, 1], point: [-1, 0, 0.3]}
  c_r_slide: {type: prismatic, bodies: [bogie, c_r_beam], axis: [0, 0, 1], point: [-2, 0, 0.3]}
  pivot: {type: revolute, bodies: [frame, bogie], point: [-2, 0, 1], axis: [0, 1, 0]}
coordinates:
  a_bump: {type: translation, bodies: [frame, a_beam], axis: [0, 0, 1]}
  b_bump: {type: translation, bodies: [frame, b_beam], axis: [0, 0, 1]}
  c_r_bump: {type: translation, bodies: [bogie, c_r_beam], axis: [0, 0, 1]}
  nod: {type: angle, bodies: [frame, bogie], axis: [0, 1, 0]}
forces:
  a_spring: {type: spring_damper, coordinate: a_bump, stiffness: 2e5, damping: 2050}
  a_strut_l: {type: spring_damper, bodies: [frame, a_beam], points: [[3, 0.5, 1], [3, 0, 0.5]], stiffness: 4e5}
  b_spring: {type: spring_damper, coordinate: b_bump, stiffness: soft, damping: soft / 100 + 60}
  b_strut_l: {type: spring_damper, bodies: [frame, b_beam], points: [[-1, 0.5, 1], [-1, 0, 0.25]], stiffness: 2 * soft}
  c_r_spring: {type: spring_damper, coordinate: c_r_bump, stiffness: soft, damping: soft / 100 + 70}
  c_r_strut_l: {type: spring_damper, bodies: [bogie, c_r_beam], points: [[-2, 0.5, 1], [-2, 0, 0.5]], stiffness: 2 * soft}
END
for model in truck written; do
    "$gicgen" --dump-model $model.veh 2>err | sed '/"name": "._\(r_\)*\(mass\|half\|rate\)", "unit"/d; /"name": "soft", "unit"/d' >$model.dump
done
[ -s truck.dump ] && cmp truck.dump written.dump >said 2>&1
verdict $? 'three axles against the same written out'
"$gicgen" --dump-model truck.veh 2>err | grep -q '"name": "soft",.*"tunable": true'
verdict $? 'the tunable parameter of the including file stays tunable'

# ---- mistakes
# refused FILE PLACE MESSAGE REMEDY PART-OF-INCLUSION [INCLUDED-AT]: one message, and where the file is included
refused() {
    sed "5s|{file.*|$5|; 6,7d" truck.veh >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "$1:$2: error: $3" said && grep -qF "  remedy: $4" said
    verdict $? "refused: $3"
    if [ -n "$6" ]; then
        [ "$(grep '^  included at ' said)" = "  included at $6" ]
        verdict $? "with where the file is included: $(grep '^  included at ' said)"
    fi
}
refused bad.veh 5:5 "the included file asks for 'rate', a number" 'add `with: {rate: ...}`: a number' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0, 0.5]}}'
refused bad.veh 5:67 "the included file has no argument 'rates'" 'it has: carrier, hub, mass, rate' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0, 0], rates: 1}}'
refused bad.veh 5:44 "'carrier' is a body of the included file" 'write the name of a body' '{file: parts/axle.veh, with: {carrier: 3, hub: [3, 0, 0], rate: 1}}'
refused bad.veh 5:56 "'hub' is a point of the included file" 'write [x, y, z], or the name' '{file: parts/axle.veh, with: {carrier: frame, hub: 0.5, rate: 1}}'
refused bad.veh 5:75 "'rate' is a number of the included file" 'write a number' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0, 0.5], rate: [1]}}'
refused bad.veh 5:44 "bodies of joint 'slide': there is no body 'frume'" "did you mean 'frame'?" '{file: parts/axle.veh, with: {carrier: frume, hub: [3, 0, 0.5], rate: 1}}'
refused parts/axle.veh 16:62 "stiffness of force 'spring' must not be negative (rate)" 'write zero or a positive number' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0, 0.5], rate: -1}}' bad.veh:5:12
refused bad.veh 5:56 "point 'hub' must have 3 numbers, not 2" 'write [x, y, z]' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0], rate: 1}}'
"$gicgen" parts/axle.veh -o alone.c >out 2>said
grep -qF "parts/axle.veh:3:3: error: a file with arguments has no values for them by itself" said
verdict $? "alone: $(head -n 1 said)"
sed -i 's/^  carrier: body/  carrier: boddy/' parts/axle.veh
refused parts/axle.veh 3:12 "argument 'carrier': there is no type 'boddy'" 'one of: number, point, body' '{file: parts/axle.veh, with: {carrier: frame, hub: [3, 0, 0.5], rate: 1}}' bad.veh:5:12

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
