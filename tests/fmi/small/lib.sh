# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# lib.sh: what scripts need that run FMUs by steps.c; to be sourced after checking.sh, with $gicgen set.

# unit NAME VERSION MODEL.veh: an FMU in $work/NAME
# shellcheck disable=SC2154  # $gicgen and $work are set by who sources this
unit() {
    "$gicgen" --fmu "$2" "$3" -o "$work/$1.fmu" >"$work/out" 2>"$work/err" && mkdir "$work/$1" &&
        python3 -m zipfile -e "$work/$1.fmu" "$work/$1"
}
token() { sed -n 's/.* \(guid\|instantiationToken\)="\([^"]*\)".*/\2/p' "$work/$1/modelDescription.xml"; }
# value references of all outputs of a unit, with commas
outputs() {
    tr '\n' ' ' <"$work/$1/modelDescription.xml" | sed 's/>/>\n/g' | grep 'causality="output"' |
        sed 's/.*valueReference="\([0-9]*\)".*/\1/' | paste -s -d , -
}
