#!/bin/sh
# SPDX-License-Identifier: MIT
# drive.sh GICRUN [MODEL.veh SCENE]: frames a second of the page of --drive in chromium without a graphics card, what a
# picture takes of the processor, and the time of a step, at two sizes of the window. A row of a table each.
set -eu
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$gicrun" -q --drive "$work/drive.html" "${2:-$root/models/hmmwv_vehicle.veh}" "${3:-$root/models/scenes/full_run.scene}"
python3 -B "$root/tests/bench/drive.py" "$work/drive.html" "$work" 640x480 1280x720
