#!/bin/sh
# SPDX-License-Identifier: MIT
# test_readable.sh GICGEN: generated code as people read it: no line over 120 columns in any form of it; numbers of state,
# inputs, outputs, parameters and motions by enumerators; sections with a comment; names of temporaries that collide with
# nothing, whatever a model calls its things.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
cc=${CC:-cc}

# columns FILE...: none over 120
columns() {
    for file in "$@"; do
        long=$(awk 'length > 120' "$file" | wc -l)
        [ "$long" -eq 0 ]
        verdict $? "$file has $long lines over 120 columns: $(awk 'length > 120' "$file" | head -n 2)"
    done
}

columns "$root"/generated/*.[ch]
for options in "--lanes 4" "--lanes 8" "--batch 8" "--solve augmented" "--scene $root/models/scenes/cruise.scene"; do
    case $options in --batch*) vehicle=hmmwv ;; *) vehicle=hmmwv_vehicle ;; esac
    # shellcheck disable=SC2086
    "$gicgen" $options "$root/models/$vehicle.veh" -o form.c >out 2>err
    verdict $? "gicgen $options"
    columns form.c form.h
done

# functions of the whole vehicle index these arrays by name alone; "rate" there is the rate of the state
for model in "$root"/generated/*.c; do
    name=$(basename "$model" .c)
    sed -n "/int ${name}_dynamics(/,/^}/p;/int ${name}_measure(/,/^}/p" "$model" >whole
    sed -n "/int ${name}_inverse(/,/^}/p;/void ${name}_\(link_wheels\|place\)(/,/^}/p" "$model" >>whole
    sed -n "/int ${name}_\(wheel_[a-z_]*\|drive\|grip\)(/,/^}/p" "$model" |
        grep -v -E 'if \(contact\[0\] > |^ *gic_real |road_height' >wheels
    arrays='x|xd|acc|pose|tau|size|link|grip|fast|torque|force|contact|gear|watch'
    # behind the numbers of wheels, twelve each, link[] has coordinates and signals that formulas read; they have no names
    behind=$(sed -n 's/^ *[A-Z0-9_]*_LINK_OF_[A-Z0-9_]* = \([0-9]*\),/\1/p' "$model" "${model%.c}.h" | sort -n | tail -n 1)
    named() {
        awk -v behind=$((${behind:--12} + 12)) '{ kept = $0
            while (match($0, /(^|[^a-z_])link\[[0-9]+\]/)) { i = substr($0, RSTART, RLENGTH); gsub(/[^0-9]/, "", i)
                if (i + 0 < behind) { print kept; next } $0 = substr($0, 1, RSTART - 1) " read" substr($0, RSTART + RLENGTH) }
            print }' "$1"
    }
    named whole >named.whole
    named wheels >named.wheels
    ! { grep -E "\b(y|u|p|out|rate|$arrays)\[[0-9]+[] ]" named.whole || grep -E "\b(rate|$arrays)\[[0-9]+[] ]" named.wheels; } >bare
    verdict $? "$name: a bare index: $(head -n 1 bare)"
    ! grep -q -E '\b(motion|inertia|m[0-9]*|n)\[[0-9]+\]' "$model"
    verdict $? "$name: a bare index of a motion: $(grep -E '\b(motion|inertia|m[0-9]*|n)\[[0-9]+\]' "$model" | head -n 1)"
done
for title in 'mass matrix' 'wheel tire_f_l' 'applied forces' 'right-hand side' accelerations 'pose, in closed form' \
    velocities 'quadratic-velocity terms' 'what the bodies add'; do
    grep -q "^ *\/\* $title" "$root/generated/hmmwv.c"
    verdict $? "no section '$title'"
done
grep -q 'const gic_real omega_x = ' "$root/generated/hmmwv.c"
verdict $? "angular velocities have no names"

# every column of a table of constants has a name, and where that is one of the model's file, its rows have that number:
# a mass or a moment of inertia of the row's own body
cat >columns.py <<'END'
import json, re, sys
text, bodies = open(sys.argv[1]).read(), {b["name"]: b for b in json.load(open(sys.argv[2]))["bodies"]}
entry = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "xz": 4, "yz": 5}
table_of = r"(/\* Columns[^/]*(?: / [^/]*)*\*/\n)?static const gic_real \w+_k_\w+\[(\d+)\]\[(\d+)\] = \{\n(.*?)\n\};"
compared = 0
for table in re.finditer(table_of, text, re.S):
    if table[2] == "1" or not re.search(r"R\((?!0\.0\))", table[4]):  # one member: numbers stand where they are used
        continue
    names = re.findall(r"^ \*\s+(\d+)  (\S.*)$", table[1] or "", re.M)
    if [int(n) for n, _ in names] != list(range(int(table[3]))):
        sys.exit(f"{table[0][:200]}: columns without a name")
    first = re.search(r"names of (\w+)", table[1])[1]
    rows = [(body, [float(x) for x in re.findall(r"R\(([^)]*)\)", row)])
            for body, row in re.findall(r"\{ /\* (\w+) \*/(.*?)\},", table[4], re.S)]
    for n, what in names:
        part = re.fullmatch(first + r"\.(mass|J_(\w\w))", what)
        for body, row in rows if part else []:
            expected = bodies[body]["mass"] if part[1] == "mass" else bodies[body]["inertia"][entry[part[2]]]
            compared += 1
            if abs(row[int(n)] - expected) > 1e-15 * abs(expected):
                sys.exit(f"{what} of {body} is {row[int(n)]}, the model says {expected}")
print(compared)
END
compared=0
for model in "$root"/generated/*.c; do
    "$gicgen" --dump-model "$root/models/$(basename "$model" .c).veh" >dump 2>err && found=$(python3 columns.py "$model" dump 2>err)
    verdict $? "$(basename "$model"): $(cat err)"
    compared=$((compared + ${found:-0}))
done
[ "$compared" -ge 4 ]
verdict $? "only $compared constants have a name of the model's file"

# an old compiler of C++ and one of C take it, and what users call their things changes nothing
rename() {
    sed "s/^model: pendulum\$/model: $1/" "$root/models/pendulum.veh" >"$1.veh"
    "$gicgen" "$1.veh" -o "$1.c" >out 2>err
    verdict $? "gicgen with a model '$1'"
    columns "$1.c" "$1.h"
    "$cc" -std=c99 -Wall -Wextra -Wpedantic -Werror -I"$root/runtime" -c "$1.c" -o "$1.o" >out 2>err
    verdict $? "code of a model '$1'"
}
grep -q '^model: pendulum$' "$root/models/pendulum.veh"
verdict $? "the model's name stands where it is changed"
for name in omega rate_of velocity inertia force layout c i_first t12 e m motion pose_of mass alpha; do
    rename "$name"
done
# two of them in one translation unit
cat omega.c alpha.c inertia.c >both.c
"$cc" -std=c99 -Wall -Wextra -Werror -I"$root/runtime" -I. -c both.c -o both.o >out 2>err
verdict $? "three models in one translation unit"

# a long description is broken in its string and stays what it is
words=$(printf 'a word %.0s' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20)end
sed "s/^description: .*/description: \"$words\"/" "$root/models/pendulum.veh" >long.veh
"$gicgen" long.veh -o long.c >out 2>err
verdict $? "a long description"
columns long.c long.h
printf '#include "%s"\n#include <stdio.h>\nint main(void)\n{\n    puts(pendulum_model.description);\n    return 0;\n}\n' long.h >main.c
"$cc" -I"$root/runtime" main.c long.c "$root/runtime/gic_runtime.c" -lm -o long >out 2>err && [ "$(./long)" = "$words" ]
verdict $? "the description changed: $(./long 2>&1)"

# so is one of escapes and letters of several bytes, with blanks to break it at and without, for every compiler
# long_text TEXT: a description of it a hundred times
long_text() {
    long=$(yes -- "$1" | head -n 100 | tr -d '\n')x
    description=$(printf '%s' "$long" | sed "s/'/''/g") awk '
        /^description:/ { print "description: '\''" ENVIRON["description"] "'\''"; next } { print }' \
        "$root/models/pendulum.veh" >long.veh
    "$gicgen" long.veh -o long.c >out 2>err
    verdict $? "a long description of '$1'"
    strings=$(grep -c '^ *(*"' long.c)
    [ "$strings" -ge 3 ] && [ "$(grep '^ *(*"' long.c | awk 'length > 120' | wc -l)" -eq 0 ]
    verdict $? "a long description of '$1' is not broken"
    for how in "$cc -std=c99 -trigraphs -Wall -Wextra" "g++ -x c++ -Wall -Wextra" "clang -std=c99 -Wall -Wextra" tcc; do
        # shellcheck disable=SC2086  # list of words
        $how -Werror -Wno-trigraphs -I"$root/runtime" main.c long.c "$root/runtime/gic_runtime.c" -lm -o long >out 2>err &&
            [ "$(./long)" = "$long" ]
        verdict $? "$how: the description of '$1' changed: $(head -n 3 err)"
    done
}
# shellcheck disable=SC1003  # a backslash is meant
for text in 'ab\' '"' '?' '??/' 'é' 'two \" ? ' '\ " '; do
    long_text "$text"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
