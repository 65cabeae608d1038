#!/bin/sh
# SPDX-License-Identifier: MIT
# wheels.sh DUMP: lines for the `outputs` of a model, DUMP being its dump: all that its wheels tell, under NAME_load,
# NAME_tire and NAME_contact, its powertrain, under line, and its energies.
awk '/^ *"[a-z]+": \[/ { section = $1 }
    section == "\"wheels\":" && match($0, /\{"name": "[^"]*"/) {
        name = substr($0, RSTART + 10, RLENGTH - 11)
        print "  " name "_load: {type: wheel, wheel: " name "}"
        if (/"tire": [0-9]/) {
            print "  " name "_tire: {type: tire, wheel: " name "}"
            print "  " name "_contact: {type: contact, wheel: " name "}" } }
    /^ *"powertrain": \{/ { print "  line: {type: powertrain}" }
    END { print "  energies: {type: energy}" }' "$1"
