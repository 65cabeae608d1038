#!/bin/sh
# SPDX-License-Identifier: MIT
# test_random_mechanisms.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE REFERENCE_LONG GICSWEEP SINGLE: random mechanisms of a few bodies, trees
# and loops on free and fixed bases, half of whose numbers are such as people write, by every way of generating and every
# engine, against quad precision, and their runs by energy: MECHANISMS (300) of them, from the seed FIRST (1) on, on
# all processors; tests/lib/mechanisms.sh says how they are judged. `make stress` has 200,000. REFUSALS=ignore: refusals
# without cause are counted and shown, and are no failures.
first=${FIRST:-1}
count=${MECHANISMS:-300}
workers=$(nproc)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
tests=$(dirname "$0")/..
ROWS=${ROWS:-2}
COMPILED=${COMPILED:-50}
export ROWS COMPILED
i=0
while [ $i -lt "$workers" ]; do
    FIRST=$((first + count * i / workers)) LAST=$((first + count * (i + 1) / workers - 1)) \
        sh "$tests/lib/mechanisms.sh" "$@" >"$work/$i" 2>&1 &
    i=$((i + 1))
done
wait
awk -v count="$count" '
    /^mechanisms / {
        ++ended
        for (i = 1; i < NF; i += 2)
            if ($i == "worst") worst = worst > $(i + 1) + 0 ? worst : $(i + 1) + 0
            else sum[$i] += $(i + 1)
        next
    }
    { print "FAIL " $0 }
    END {
        failed = sum["failures"]
        if (sum["mechanisms"] != count || sum["rows"] == 0 || sum["runs"] == 0) {
            print "FAIL not all were tried"
            ++failed
        }
        printf "%d mechanisms, %d refused by gicgen, %d rows compared, %d refused without cause, %d runs, worst %g\n",
            sum["mechanisms"], sum["refused"], sum["rows"], sum["baseless"], sum["runs"], worst
        printf "%d passed, %d failed\n", sum["comparisons"] + sum["runs"], failed
        exit failed != 0
    }' "$work"/*
