#!/bin/sh
# SPDX-License-Identifier: MIT
# test_contact_variable.sh GICRUN: variable steps go over no contact, at any tolerance: closed solutions and one of its
# own, by variable.py and let_go.py.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

cp "$root/tests/data/contact/stops.veh" .
check "stops under variable steps" \
    sh -c "python3 '$root/tests/data/contact/variable.py' '$gicrun' stops.veh >said 2>&1"

check "a damped stop that lets go and takes hold again" \
    sh -c "python3 '$root/tests/data/contact/let_go.py' '$gicrun' >said 2>&1"

# a switch for what is always done
scene() { printf 'gicscene: 1\nduration: 0.1\noutput_step: 0.1\nintegrator: adams\nlocate: %s\n' "$1" >now.scene; }
scene true
run -q stops.veh now.scene -o on.csv
check "locate: true says what is so" exits 0
scene false
run -q stops.veh now.scene -o off.csv
check "locate: false is refused" exits 1
check "with place and remedy" says 'now.scene:5:.*variable steps always end at contacts.*'
check "without results" [ ! -e off.csv ]
printf 'gicscene: 1\nduration: 0.1\nstep: 0.01\nlocate: false\n' >now.scene
run -q stops.veh now.scene --integrator rkck -o off.csv
check "the same where the command line asks for them" exits 1

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
