#!/bin/sh
# SPDX-License-Identifier: MIT
# test_theory.sh GICGEN GICRUN: generator/THEORY.md is true. Each row of its worked example has a formula, which awk evaluates,
# a name in generated code, which a program prints, and a value: all three are equal. The same state by gicrun --eval has the
# same acceleration. On the generator's pages functions, files and types that are named exist.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
page=$root/generator/THEORY.md
cd "$work" || exit 1

w=0.5
v=2
# rows: "name<TAB>formula<TAB>value", of the table whose third column is generated code
sed -n 's/^|[^|]*| `\([^`]*\)` | `\([a-z]*\[[0-9]*\]\)` | \([-0-9.e]*\) |$/\2	\1	\3/p' "$page" >rows
check 'the page has its example' [ "$(wc -l <rows)" -ge 12 ]

"$gicgen" "$root/models/pendulum.veh" -o pendulum.c
{
    echo '#include "pendulum.c"'
    echo '#include <stdio.h>'
    echo 'int main(void) { static pendulum body; int status = pendulum_setup(&body);'
    echo "body.state[0] = $w, body.state[1] = $v; if (status == GIC_OK) status = pendulum_outputs(&body);"
    cut -f 1 rows | while read -r name; do printf 'printf("%s\\t%%.17g\\n", body.%s);\n' "$name" "$name"; done
    echo 'return status; }'
} >print.c
compile() { "${CC:-cc}" -I. -I"$root/runtime" print.c "$root/runtime/gic_runtime.c" -lm -o print >out 2>err && ./print >printed; }
check 'the generated code runs at that state' compile
cut -f 2 rows | while read -r formula; do printf 'printf "%%.17g\\n", %s\n' "$formula"; done >formulas
awk "BEGIN { w = $w; v = $v; $(tr '\n' ';' <formulas) }" >evaluated
paste rows printed evaluated >all
# 1 name, 2 formula, 3 value on the page, 4 name, 5 printed, 6 evaluated
equal() { awk -F '\t' -v a="$1" -v b="$2" -v tolerance="$3" '$1 != $4 || $5 == "" || $6 == "" || ($a - $b)^2 > tolerance^2 { print; bad = 1 }
    END { exit bad || NR < 12 }' all >said; }
check 'formulas and generated code agree' equal 5 6 4e-15
check 'and so do the numbers on the page' equal 3 5 1e-14

printf 'angle,angle.rate\n%s,%s\n' $w $v >states
"$gicrun" --eval states "$root/models/pendulum.veh" -o results
accelerates() {
    awk -F, -v expected="$(sed -n 's/^rate\[1\]	[^	]*	//p' rows)" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^angle.acceleration/) c = i }
        NR == 2 { exit !(c && ($c - expected)^2 < 1e-26) }' results
}
check 'gicrun --eval finds the acceleration of the page' accelerates

# names() FILE: what stands in backticks
names() { grep -o '`[^`]*`' "$1" | tr -d '`' | sort -u; }
for file in "$root/generator/THEORY.md" "$root/generator/README.md"; do
    : >missing
    names "$file" | while read -r name; do
        case $name in
        *' '* | *'*'*) continue ;;
        *.c | *.h | *.c.in | *.h.in | *.veh | *.sh | *.py | *.1)
            for place in "" generator/ tests/; do [ ! -e "$root/$place$name" ] || continue 2; done
            [ "$name" != pendulum.c ] && ! grep -q "^+++ b/.*$name$" "$root"/tests/walks/*.patch && echo "$name"
            ;;
        *'()') grep -rqw "${name%()}" "$root/generator" "$root/runtime" "$root/tests/reference" "$root/tests/walks" || echo "$name" ;;
        PREFIX_* | GIC_* | MOTION_* | INERTIA_* | PART_* | JOINT_* | FORCE_* | OUTPUT_*)
            grep -rqw "$name" "$root/generator" "$root/runtime" "$root/templates" "$root/tests/walks" || echo "$name"
            ;;
        pendulum_*) grep -qw "$name" pendulum.c || echo "$name" ;;
        esac
    done >missing
    cp missing said
    check "what $(basename "$file") names is there" [ ! -s missing ]
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
