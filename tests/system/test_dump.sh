#!/bin/sh
# SPDX-License-Identifier: MIT
# test_dump.sh GICGEN COMPARE_DUMP: dumps of tests/data/dump/*.veh against hand-written ones beside them, or where symmetry
# or inclusion do work, against the dump of the same model written out without them (*_written.veh).
gicgen=$1
compare=$2
here=$(dirname "$0")/..
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

pass() { passed=$((passed + 1)); }
fail() {
    failed=$((failed + 1))
    echo "FAIL $1"
}

for expected in "$here"/data/dump/*.json; do
    model=${expected%.json}.veh
    if ! "$gicgen" --dump-model "$model" >"$work/dump"; then
        fail "$model: not read"
    elif "$compare" "$expected" "$work/dump"; then
        pass
    else
        fail "$model: dumped otherwise than expected"
    fi
done

# a written-out model has names ending in _L instead of _l, which would have a mirror image
for written in "$here"/data/dump/*_written.veh; do
    model=${written%_written.veh}.veh
    if ! "$gicgen" --dump-model "$written" >"$work/names" || ! "$gicgen" --dump-model "$model" >"$work/dump"; then
        fail "$model or $written: not read"
    elif sed 's/_L\([".]\)/_l\1/g' "$work/names" >"$work/expected" && "$compare" "$work/expected" "$work/dump"; then
        pass
    else
        fail "$model: dumped otherwise than $written"
    fi
done

# the comparison itself must notice one changed digit and a changed text
"$gicgen" --dump-model "$here/data/dump/free_base.veh" >"$work/dump" || fail "free_base: not read"
for change in 's/0\.25,/0.2500000000001,/' 's/"tire"/"tyre"/' 's/"driven": true/"driven": false/'; do
    sed "$change" "$work/dump" >"$work/changed"
    if cmp -s "$work/dump" "$work/changed" || "$compare" "$here/data/dump/free_base.json" "$work/changed" 2>"$work/err"; then
        fail "compare_dump does not notice $change"
    else
        pass
    fi
done

# `-` is standard input
"$gicgen" --dump-model - <"$here/data/dump/free_base.veh" >"$work/again"
if [ -s "$work/again" ] && cmp -s "$work/dump" "$work/again"; then
    pass
else
    fail "standard input gives another dump than the file"
fi

# standard input includes files of the folder one is in
program=$(cd "$(dirname "$gicgen")" && pwd)/$(basename "$gicgen")
(cd "$here/data/dump" && "$program" --dump-model -) <"$here/data/dump/include.veh" >"$work/again"
"$gicgen" --dump-model "$here/data/dump/include.veh" >"$work/dump"
if [ -s "$work/again" ] && cmp -s "$work/dump" "$work/again"; then
    pass
else
    fail "standard input includes other files than the file"
fi

# 16 levels of inclusion are read, 17 are not
cp "$here/data/dump/parts/complete.veh" "$work/level0.veh"
level=0
while [ "$level" -lt 17 ]; do
    above=$((level + 1))
    printf 'gicgen: 1\ninclude: level%d.veh\nmodel: deep\n' "$level" >"$work/level$above.veh"
    level=$above
done
if "$gicgen" --dump-model "$work/level16.veh" >"$work/dump" && grep -q '"turn"' "$work/dump"; then
    pass
else
    fail "16 levels of inclusion are too many"
fi
"$gicgen" --dump-model "$work/level17.veh" >"$work/dump" 2>"$work/err"
if [ $? -eq 1 ] && [ ! -s "$work/dump" ] && grep -q 'level1.veh:2:10: error: .*16 levels' "$work/err"; then
    pass
else
    fail "17 levels of inclusion: $(cat "$work/err")"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 15 ]
