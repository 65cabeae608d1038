#!/bin/sh
# SPDX-License-Identifier: MIT
# test_by_hand.sh GICGEN GICRUN: the vehicles of models/VEHICLES.md, against what follows by hand from their hard points,
# masses and forces; what they do in their scenes; their energy. The published eigenvalues of the benchmark bicycle.
# tests/vehicle/MODEL.py works it out.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# by_hand MODEL
by_hand() {
    name=$1
    /usr/bin/python3 -B "$root/tests/vehicle/$name.py" "$gicgen" "$gicrun" "$root/models" "$work" >"$work/notes" 2>"$work/err"
    verdict $? "$name is worked out to the end"
    while read -r how what; do
        [ "$how" = good ]
        verdict $? "$name: $what"
    done <"$work/notes"
}
by_hand formula_student
by_hand semitrailer
by_hand motorcycle
by_hand benchmark_bicycle
by_hand hatchback

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
