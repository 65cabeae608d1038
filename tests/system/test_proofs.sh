#!/bin/sh
# SPDX-License-Identifier: MIT
# test_proofs.sh: proofs.md has a row for every function that looks at numbers of the expression graph or compares with a
# tolerance, and no row for one that does not exist.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# What reads values of nodes or sampled configurations, and what says that a difference is nothing. In runtime/ numbers are
# numbers: there only named tolerances decide.
values='[^a-z_](ex_value|ex_is|ex_is_number|formula_value|formula_is_constant|node_evaluate|random_uniform|random_bits|sampling_pose|sampling_coordinate|is_sound|along_axis|is_light)\('
values="$values"'|dag->value|from->value \+|sampling->(S|swing|usable|pose|target)'
tolerance='[^a-zA-Z0-9_.][0-9.]+e-([6-9]|1[0-9])'

# deciding FILE...: "file function" of each line that matches $pattern; for a constant outside of functions its name
deciding() {
    for file in "$@"; do
        awk -v pattern="$pattern" -v file="${file#"$root"/*/}" '
            /^[a-zA-Z_].*\(/ && !/;$/ { head = $0; sub(/\(.*/, "", head); sub(/.*[ *]/, "", head) }
            /^\{/ { name = head }
            /^\}/ { name = ""; next }
            /^ \*|^\/\*|^#/ { next }
            { gsub(/\/\*.*\*\//, ""); gsub(/"[^"]*"/, "") }
            $0 ~ pattern {
                here = name
                if (here == "" && /^(static )?const double/) { here = $0; sub(/^(static )?const double \(?\*?/, "", here); sub(/[ ,=\[;].*/, "", here) }
                if (here != "") print file, here
            }' "$file"
    done | sort -u
}

rows() { grep '^| `' "$root/tests/proofs.md"; }

{
    pattern="$values|$tolerance"
    deciding "$root"/generator/*/*.c
    pattern="const double.*$tolerance"
    deciding "$root"/runtime/*/*.c "$root"/runtime/plugin/*.c
} >"$work/decisions"
rows >"$work/rows"
check "decisions are found" test "$(wc -l <"$work/decisions")" -gt 100

: >"$work/out"
while read -r file function; do
    grep -F "| \`$file\` |" "$work/rows" | grep -qF "\`$function\`" || echo "proofs.md has no row for $function of $file"
done <"$work/decisions" >"$work/out"
check "each has a row" test ! -s "$work/out"

: >"$work/out"
sed 's/^| `\([a-z0-9_/]*\.c\)` | \([^|]*\) |.*/\1 \2/' "$work/rows" | tr -d '`,' | while read -r file functions; do
    for function in $functions; do
        path=$root/generator/$file
        [ -f "$path" ] || path=$root/runtime/$file
        [ -f "$path" ] || path=$root/runtime/plugin/$file
        grep -qw "$function" "$path" || echo "proofs.md has a row for $function, which $file does not have"
    done
done >"$work/out"
check "each row is about something" test ! -s "$work/out"

: >"$work/out"
awk -F '|' 'NF != 7 || $4 ~ /^ *$/ || $5 !~ /structure|exact|bound|check|choice|open/ || $6 ~ /^ *$/' "$work/rows" >"$work/out"
check "each row gives a decision, a reason and a test" test ! -s "$work/out"

: >"$work/out"
sed -n 's/.*| \([^|]*\) |$/\1/p' "$work/rows" | grep -o 'test_[a-z_]*\.[a-z]*' | sort -u | while read -r name; do
    [ -f "$root/tests/system/$name" ] || [ -f "$root/tests/unit/$name" ] || echo "proofs.md names $name, which is no test"
done >"$work/out"
check "tests that rows name exist" test ! -s "$work/out"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
