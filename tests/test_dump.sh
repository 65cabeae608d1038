#!/bin/sh
# SPDX-License-Identifier: MIT
# test_dump.sh GICGEN COMPARE_DUMP: dumps of tests/dump/*.veh against hand-written ones beside them.
gicgen=$1
compare=$2
here=$(dirname "$0")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

pass() { passed=$((passed + 1)); }
fail() {
    failed=$((failed + 1))
    echo "FAIL $1"
}

for expected in "$here"/dump/*.json; do
    model=${expected%.json}.veh
    if ! "$gicgen" --dump-model "$model" >"$work/dump"; then
        fail "$model: not read"
    elif "$compare" "$expected" "$work/dump"; then
        pass
    else
        fail "$model: dumped otherwise than expected"
    fi
done

# the comparison itself must notice one changed digit and a changed text
"$gicgen" --dump-model "$here/dump/free_base.veh" >"$work/dump" || fail "free_base: not read"
for change in 's/0\.25,/0.2500000000001,/' 's/"tire"/"tyre"/' 's/"driven": true/"driven": false/'; do
    sed "$change" "$work/dump" >"$work/changed"
    if cmp -s "$work/dump" "$work/changed" || "$compare" "$here/dump/free_base.json" "$work/changed" 2>"$work/err"; then
        fail "compare_dump does not notice $change"
    else
        pass
    fi
done

# `-` is standard input
"$gicgen" --dump-model - <"$here/dump/free_base.veh" >"$work/again"
if [ -s "$work/again" ] && cmp -s "$work/dump" "$work/again"; then
    pass
else
    fail "standard input gives another dump than the file"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 9 ]
