#!/bin/sh
# SPDX-License-Identifier: MIT
# test_read.sh GICGEN: every broken file of tests/data/mistakes must be refused with the one message that its first line
# announces as `# expect: LINE:COLUMN: fragment of the message`, with a caret, exit status 1 and nothing else. A second
# line `# remedy: fragment` announces the remedy as well; a line `# file: path` that the mistake stands in another
# file, seen from tests/data/mistakes, and a line `# note: text` a note.
gicgen=$1
here=$(dirname "$0")/..
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# why FILE: the first thing that is wrong with the answer to FILE, or nothing
why() {
    expected=$(sed -n '1s/.*# expect: //p' "$1")
    place=$(printf '%s\n' "$expected" | cut -d: -f1-2)
    fragment=$(printf '%s\n' "$expected" | sed 's/^[^:]*:[^:]*: //')
    column=${place#*:}
    remedy=$(sed -n '2s/^# remedy: //p' "$1")
    note=$(sed -n 's/^# note: //p' "$1")
    other=$(sed -n 's/^# file: //p' "$1")
    file=${other:+$here/data/mistakes/$other}
    file=${file:-$1}
    "$gicgen" --dump-model "$1" >"$work/out" 2>"$work/err"
    status=$?
    head -n 1 "$work/err" >"$work/message"
    if [ -z "$expected" ]; then
        echo "no '# expect:' in its first line"
    elif [ "$status" -ne 1 ]; then
        echo "exit status $status"
    elif [ -s "$work/out" ]; then
        echo "something on standard output"
    elif [ "$(grep -c 'error:' "$work/err")" -ne 1 ]; then
        echo "not exactly one error"
    elif ! grep -qF -e "$file:$place: error: " "$work/message"; then
        echo "not at $place: $(cat "$work/message")"
    elif ! grep -qF -e "$fragment" "$work/message"; then
        echo "not '$fragment': $(cat "$work/message")"
    elif ! sed -n 3p "$work/err" | grep -q '^[[:blank:]]*^$'; then
        echo "no caret"
    elif [ "$column" -lt 100 ] && [ "$(sed -n 3p "$work/err" | tr -d '\n' | wc -c)" -ne $((column + 2)) ]; then
        echo "the caret is not below column $column"
    elif [ "$(sed -n 's/^  note: //p' "$work/err")" != "$note" ]; then
        echo "not the note '$note': $(grep '^  note: ' "$work/err")"
    elif ! grep '^  remedy: ' "$work/err" >"$work/remedy"; then
        echo "no remedy"
    elif ! grep -qF -e "$remedy" "$work/remedy"; then
        echo "not the remedy '$remedy': $(cat "$work/remedy")"
    fi
}

for file in "$here"/data/mistakes/*.veh; do
    reason=$(why "$file")
    if [ -z "$reason" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $file: $reason"
    fi
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 300 ]
