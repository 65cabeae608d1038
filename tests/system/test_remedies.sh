#!/bin/sh
# SPDX-License-Identifier: MIT
# test_remedies.sh GICGEN GICRUN: each remedy of a message, applied as it is printed, leads to a model that is accepted:
# of each file of tests/data/mistakes (remedies.py), and of mechanisms whose joints repeat each other (mechanisms.py).
tests=$(dirname "$0")/..
export PYTHONDONTWRITEBYTECODE=1
{
    python3 "$tests/tools/remedies.py" "$1"
    python3 "$tests/tools/mechanisms.py" "$1" "$2"
} 2>&1 | awk '
    /^[0-9]+ passed, [0-9]+ failed$/ { passed += $1; failed += $3; ++parts; next }
    { print }
    END { failed += parts != 2; print passed " passed, " failed " failed"; exit failed != 0 }'
