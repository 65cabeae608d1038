#!/bin/sh
# SPDX-License-Identifier: MIT
# test_mistakes.sh GICGEN RANDOM_VEHICLE: each kind of mistake of tests/random/broken.py once (MISTAKES: so many in all)
# in files of random vehicles: exit status 1, no output, one message at the right line with the culprit's name and a
# remedy. Mistakes of mechanisms that a few words can't make are in test_random.sh.
tests=$(dirname "$0")/..
PYTHONDONTWRITEBYTECODE=1 exec python3 "$tests/random/mistakes.py" "$1" "$2" "$tests/../models/tires/hmmwv_pac2002.tir" \
    "${MISTAKES:-395}"
