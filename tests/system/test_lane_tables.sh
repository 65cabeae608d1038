#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lane_tables.sh GICGEN: tables in lanes, which code for many vehicles has (templates/batch_vectors.c.in), give the bits
# of gic_table_value() (tests/data/lanes/tables.c): short tables, searched in all lanes at once, and long ones; of either
# number type, with 2 to 16 lanes, by gcc and clang.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cp "$root"/runtime/gic_runtime.[ch] "$root/runtime/gic_batch.h" "$root/runtime/gic_lanes.h" "$root"/runtime/gic_road*.h "$work/"
cd "$work" || exit 1
# the smallest model of those whose code for many vehicles has it
cat >mass.veh <<'XXX'
gicgen: 1
model: mass
base: ground
bodies:
  mass: {mass: 2, position: [0, 0, 0], com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: prismatic, bodies: [ground, mass], axis: [1, 0, 0]}
coordinates:
  s: {type: translation, bodies: [ground, mass], axis: [1, 0, 0], range: [-100, 100]}
states:
  lag: {rate: s - lag}
outputs:
  s: {type: coordinate, coordinate: s}
XXX
"$gicgen" mass.veh >said 2>&1
verdict $? "the model: $(cat said)"

# agrees LANES COMPILER...
agrees() {
    lanes=$1
    shift
    rm -f tables
    "$gicgen" --batch 4 --lanes "$lanes" mass.veh >said 2>&1 &&
        "$@" -Wall -Wextra -Wno-unused-function -Wno-psabi -Werror -ffp-contract=off '-DBATCH="mass_batch.c"' -I. "$root/tests/data/lanes/tables.c" mass.c \
            gic_runtime.c -lm -o tables >said 2>&1 && ./tables >said 2>&1
    verdict $? "$lanes lanes: $*: $(head -3 said)"
}
agrees 4 gcc -std=c11 -O1
agrees 2 gcc -std=c11 -O0 -DGIC_FLOAT
agrees 8 gcc -std=c11 -O3 -DGIC_FLOAT
agrees 4 clang -std=c11 -O2
agrees 16 clang -std=c11 -O1 -DGIC_FLOAT

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
