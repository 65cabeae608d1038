#!/bin/sh
# SPDX-License-Identifier: MIT
# reactions.sh DUMP MODEL.veh: a model that includes another and asks for the reaction force of each of its joints,
# under the joint's name, and for the force of each driven coordinate, `drive_NAME`. DUMP is the other's dump.
cat <<END
gicgen: 1
include: $2
model: $(sed -n 's/.*"model": "\([^"]*\)".*/\1/p' "$1" | head -n 1)
outputs:
END
awk '/^ *"[a-z]+": \[/ { section = $1 }
    section == "\"joints\":" && match($0, /\{"name": "[^"]*"/) {
        name = substr($0, RSTART + 10, RLENGTH - 11)
        print "  " name ": {type: reaction, joint: " name "}" }
    section == "\"coordinates\":" && /"driven": true/ && match($0, /\{"name": "[^"]*"/) {
        name = substr($0, RSTART + 10, RLENGTH - 11)
        print "  drive_" name ": {type: drive_force, coordinate: " name "}" }' "$1"
