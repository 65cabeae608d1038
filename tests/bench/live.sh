#!/bin/sh
# SPDX-License-Identifier: MIT
# live.sh GICRUN [SECONDS [MODEL.veh SCENE]]: an hour, or so long, of the complete HMMWV as fast as time passes. Fails where a
# step computes longer than it lasts, or where more deadlines are missed than the system's own jitter explains: that of the
# bare thread beside it, and three times the root of that.
set -eu
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$gicrun" --live 0 "${3:-$root/models/hmmwv_vehicle.veh}" "${4:-$root/models/scenes/lane_change.scene}" \
    --seconds "${2:-3600}" 2>"$work/said"
cat "$work/said"
awk '/^  missed deadlines / { missed = $3; own = $6 }
    /^  bare thread  .* times later/ { bare = $3; seen = 1 }
    END {
        good = seen && own == 0 && missed <= bare + 3 * sqrt(bare) + 3
        print good ? "good: no more deadlines are missed than the system explains" : "bad: deadlines are missed"
        exit !good
    }' "$work/said"
