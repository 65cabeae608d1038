#!/bin/sh
# SPDX-License-Identifier: MIT
# test_event_bits.sh GICGEN GICRUN: what happens within steps is the same to the last bit whoever compiles the code and
# however often it runs: contacts of tires and stops, gears, by every integrator; a copy of a vehicle goes on as the
# vehicle itself, before, in and after its events; vehicles side by side meet stops each at its own time as they do
# alone. Ways whose rounding is another one, the tape's and vectors of lanes, find the same events.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1
models=$root/models

# scene NAME DURATION LINE...: the start of a scene of the repository, with these lines
scene() {
    grep -v '^locate\|^step\|^ratio\|^integrator\|^outputs\|^duration' "$models/scenes/$1.scene"
    shift
    echo "duration: $1"
    shift
    printf '%s\n' "$@"
}

# run NAME ENGINE...: now.scene into NAME.csv, the number of contacts into NAME.count
run() {
    name_of_run=$1
    shift
    # shellcheck disable=SC2068  # options
    "$gicrun" --engine $@ "$vehicle" now.scene -o "$name_of_run.csv" 2>"$name_of_run.said" || return 1
    sed -n 's/^  contacts located *\([0-9]*\).*/\1/p' "$name_of_run.said" >"$name_of_run.count"
}
same_run() { run "$@" && cmp -s "$1.csv" tcc.csv && cmp -s "$1.count" tcc.count; }

# near LIMIT NAME ENGINE...: as many contacts, the chassis (all numbers where there is none) within LIMIT
near() {
    limit=$1
    shift
    run "$@" && cmp -s "$1.count" tcc.count && paste -d, "$1.csv" tcc.csv | awk -F, -v limit="$limit" '
        NR == 1 {
            for (i = 1; i <= NF / 2; ++i) {
                all[++m] = i
                if ($i ~ /^chassis\.[xyz] /)
                    at[++n] = i
            }
            next
        }
        {
            for (k = 1; k <= (n ? n : m); ++k) {
                i = n ? at[k] : all[k]
                d = ($i - $(i + NF / 2))^2
                if (!(d <= most))
                    most = d
            }
        }
        END {printf "%.3g\n", sqrt(most) >"off"; exit !(NR > 10 && sqrt(most) <= limit)}'
}

# every_way WHAT CONTACTS LIMIT: now.scene; so many contacts at least
every_way() {
    run tcc tcc
    check "$1: $(cat tcc.count) contacts" [ "$(cat tcc.count)" -ge "$2" ]
    check "$1: again" same_run again tcc
    check "$1: cc" same_run cc cc
    check "$1: code that changes on the way" same_run auto auto
    check "$1: tape" near "$3" tape tape
    check "$1: lanes" near "$3" lanes cc --lanes 4
}

# limits: what rounding makes of constant steps; what other variable steps make of a tolerance
vehicle=$models/hmmwv_tires.veh
scene tires_jump 1.2 'integrator: ab3' 'ratio: 4' 'step: 0.002' 'locate: true' >now.scene
every_way 'tires, AB3 at two rates' 10 1e-10
scene tires_jump 1.2 'integrator: rk4' 'step: 0.002' 'locate: true' >now.scene
every_way 'tires, RK4' 10 1e-10
scene tires_jump 1.2 'integrator: rkck' 'tolerance: 1e-9' >now.scene
every_way 'tires, rkck' 30 1e-6
scene tires_jump 1.2 'integrator: adams' 'tolerance: 1e-8' >now.scene
every_way 'tires, adams' 30 1e-5
vehicle=$models/hmmwv_vehicle.veh
scene full_run 4 'integrator: ab3' 'ratio: 6' 'step: 0.006' 'locate: true' \
    'road: {type: table, x: [200, 203, 204, 206, 206.5], height: [0, 0, 0.06, 0.3, 0]}' >now.scene
every_way 'tires and gears, AB3 at two rates' 10 1e-9
check 'gears change there' awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ /^drive\.gear /) k = i; next}
    {if ($k != last) ++changes; last = $k} END {exit !(k && changes > 1)}' tcc.csv
cp "$root/tests/data/contact/hop.veh" "$root/tests/data/contact/stops.veh" .
vehicle=hop.veh
printf 'gicscene: 1\nduration: 2\nstep: 0.002\noutput_step: 0.01\nintegrator: ab3\nlocate: true\n' >now.scene
echo 'initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}' >>now.scene
every_way 'a wheel and stops, AB3' 15 1e-10

# Copies of a vehicle with tires that drives over an edge at 12 m/s, at times before, in and after its contacts.
for file in runtime.h runtime.c road.h road.c batch.h lanes.h; do cp "$root/runtime/gic_$file" .; done
cat >snapshot.c <<'END'
#include "gic_road.h"
#include "hmmwv_tires.h"
#include <stdio.h>
#include <string.h>

static hmmwv_tires first, copy;

static int step(hmmwv_tires *car, int way)
{
    return (way == 2 ? gic_step(&hmmwv_tires_model, car, GIC_R(0.002), GIC_RK4)
                     : gic_step_dual(&hmmwv_tires_model, car, GIC_R(0.002), way ? 4 : 1)) != GIC_OK;
}

int main(void)
{
    static const gic_real x[] = {1, 2, 3, GIC_R(3.2)}, height[] = {0, GIC_R(0.1), GIC_R(0.4), 0};
    static gic_real left[4], right[4];
    gic_road_table road = {{gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE}, x, height, height, left, right, 4};
    int bad = gic_road_table_setup(&road) != GIC_OK;
    for (int way = 0; way < 3; ++way)
        for (int taken = 0; taken < 300; taken += 13) {
            memset(&first, 0, sizeof first);
            bad += hmmwv_tires_setup(&first) != GIC_OK;
            first.head.locate = 1;
            first.head.road = &road.head;
            first.state[HMMWV_TIRES_STATE_V_X] = 12;
            bad += hmmwv_tires_model.roll(&first) != GIC_OK;
            for (int k = 0; k < 320; ++k) {
                if (k == taken)
                    memcpy(&copy, &first, sizeof first);
                bad += step(&first, way);
                if (k >= taken)
                    bad += step(&copy, way) + (memcmp(&first, &copy, sizeof first) != 0);
            }
            bad += first.head.contact_count < 6;
        }
    printf("%d bad, %ld contacts\n", bad, (long)first.head.contact_count);
    return bad != 0;
}
END
"$gicgen" "$models/hmmwv_tires.veh" -o hmmwv_tires.c >out 2>err &&
    cc -std=c99 -Wall -Wextra -Werror -O1 snapshot.c hmmwv_tires.c gic_runtime.c gic_road.c -lm -o snapshot \
        >out 2>err && ./snapshot >said
verdict $? 'snapshots of a vehicle with tires'

# Many masses between stops, each of which meets them at times of its own: the bits of the code for one, which goes over
# contacts as lanes do.
cat >many.c <<'END'
#include "stops_batch.h"
#include <stdio.h>
#include <string.h>

static stops one[STOPS_VEHICLES], copy;
static stops_batch batch;

int main(void)
{
    int bad = stops_batch_setup(&batch) != GIC_OK, turns[STOPS_VEHICLES] = {0}, different = 0;
    for (int i = 0; i < STOPS_VEHICLES; ++i) {
        bad += stops_setup(&one[i]) != GIC_OK;
        one[i].state[STOPS_STATE_S_RATE] = GIC_R(0.5) + GIC_R(0.375) * (gic_real)i;
        one[i].state[STOPS_STATE_X_RATE] = GIC_R(1.0) + GIC_R(0.25) * (gic_real)(i % 4);
        stops_batch_load(&batch, i, &one[i]);
    }
    for (int k = 0; k < 1500; ++k) {
        bad += stops_batch_step(&batch, GIC_R(0.002), GIC_AB3, 1) != STOPS_VEHICLES;
        for (int i = 0; i < STOPS_VEHICLES; ++i) {
            const gic_real before = one[i].state[STOPS_STATE_S_RATE];
            bad += stops_step(&one[i], GIC_R(0.002), GIC_AB3) != GIC_OK;
            stops_batch_store(&batch, i, &copy);
            bad += memcmp(copy.state, one[i].state, sizeof copy.state) != 0;
            turns[i] += before * one[i].state[STOPS_STATE_S_RATE] < 0;
        }
    }
    for (int i = 1; i < STOPS_VEHICLES; ++i)
        different += turns[i] != turns[i - 1];
    printf("%d bad, %d to %d turns\n", bad, turns[0], turns[STOPS_VEHICLES - 1]);
    return bad || different < 3;
}
END
"$gicgen" stops.veh -o stops.c >out 2>err && "$gicgen" --batch 10 --lanes 4 stops.veh -o stops_batch.c >out 2>err &&
    cc -std=gnu99 -O2 -ffp-contract=off many.c stops.c stops_batch.c gic_runtime.c -lm -o many >out 2>err &&
    ./many >said
verdict $? 'stops in different lanes'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
