# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# scenes.sh: scenes of tests about integrators; to be sourced.

# scene DURATION STEP LINE...: of a run with rows at its whole tenths
scene() {
    printf 'gicscene: 1\nduration: %s\nstep: %s\noutput_step: %s\n' "$1" "$2" "$(awk "BEGIN { print $1 / 10 }")"
    shift 2
    printf '%s\n' "$@"
}
# rest_of SCENE: its lines but for times, steps and pictures
rest_of() {
    awk '/^[a-z]/ { gone = /^(gicscene|duration|step|integrator|output_step|ratio|steady|sleep|plot|locate|tolerance)/ } !gone' "$1"
}
