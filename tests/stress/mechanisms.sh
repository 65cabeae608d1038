#!/bin/sh
# SPDX-License-Identifier: MIT
# mechanisms.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE REFERENCE_LONG GICSWEEP SINGLE: random mechanisms with numbers that people write
# against quad precision (tests/lib/mechanisms.sh), 200,000 (short: 20) of them from the seed 10,001 on, in parts of 200 on
# all processors; one in 400 goes through a C compiler, which takes longer than all else. That takes hours: after SECONDS_EACH (6000) no new part is begun, and the next call goes on with those
# that are missing. What parts found stays in $BUILD/stress/mechanisms/; remove that folder to begin anew.
if [ "$STRESS" = short ]; then all=${MECHANISMS:-20} part=10; else all=${MECHANISMS:-200000} part=200; fi
folder=$(dirname "$2")/stress/mechanisms
[ "$STRESS" != short ] || folder=$(mktemp -d) || exit 1
mkdir -p "$folder" || exit 1
COMPILED=${COMPILED:-400}
export COMPILED
until=$(($(date +%s) + ${SECONDS_EACH:-6000}))
here=$(dirname "$0")

# Parts in turn, each by the worker whose folder could be made first.
worker() {
    first=10001
    while [ $first -le $((10000 + all)) ] && [ "$(date +%s)" -lt $until ]; do
        if [ ! -f "$folder/$first" ] && mkdir "$folder/$first.begun" 2>/dev/null; then
            FIRST=$first LAST=$((first + part - 1)) sh "$here/../lib/mechanisms.sh" "$@" >"$folder/$first.begun/found" 2>&1 &&
                mv "$folder/$first.begun/found" "$folder/$first"
            rm -rf "$folder/$first.begun"
        fi
        first=$((first + part))
    done
}

# what a call that was interrupted left
rm -rf "$folder"/*.begun
i=0
while [ $i -lt "$(nproc)" ]; do
    worker "$@" &
    i=$((i + 1))
done
wait
cat "$folder"/* | awk -v all="$all" '
    /^mechanisms / {
        for (i = 1; i < NF; i += 2)
            if ($i == "worst") worst = worst > $(i + 1) + 0 ? worst : $(i + 1) + 0
            else sum[$i] += $(i + 1)
        next
    }
    { first = first ? first : $0; print >"/dev/stderr" }
    END {
        gsub(/[|]/, "/", first)
        done = sum["mechanisms"]
        remark = done < all ? "ok: " all - done " are left for the next call; " : "ok: "
        remark = remark sum["rows"] " rows, " sum["runs"] " runs, " sum["baseless"] " refused without cause"
        printf "mechanisms | random mechanisms | %d | %d | %d | %g of all terms | %s\n", done, done - sum["refused"],
            sum["refused"], worst, sum["failures"] ? sum["failures"] " failures, the first: " first : remark
    }'
[ "$STRESS" != short ] || rm -rf "$folder"
