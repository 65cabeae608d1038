#!/bin/sh
# SPDX-License-Identifier: MIT
# test_report.sh GICGEN: the page of --report against the emitted code (operations counted in its text), what a
# compiler makes of it (sizes, constants, stack at -O0 and -O2), what it says when it runs (signals, right-hand sides a
# step), and --sequence.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# compile FILE REAL HOW OPTION: object and call graph with stack usage
compile() {
    # shellcheck disable=SC2086  # none or one word
    gcc -std=c99 -"$3" -ffp-contract=off -I"$root/runtime" -I. $4 -fcallgraph-info=su -c "$1" \
        -o "$(basename "$1" .c).$2.$3.o"
}

for real in double float; do
    define=$([ $real = float ] && echo -DGIC_FLOAT)
    for how in O0 O2; do
        compile "$root/runtime/gic_runtime.c" $real $how "$define"
        verdict $? "gic_runtime.c, $real, $how"
    done
done

# compare NAME MODEL OPTION...: the page about a model with all that it can be compared with
compare() {
    name=$1
    model=$2
    shift 2
    "$gicgen" "$@" "$model" -o "$name.c" && "$gicgen" "$@" --report "$name.html" "$model" &&
        "$gicgen" --sequence "$model" >"$name.sequence"
    verdict $? "$name: no code, report or sequence"
    compile "$name.c" double O0 && compile "$name.c" float O0 -DGIC_FLOAT && compile "$name.c" double O2
    verdict $? "$name: not compiled"
    for real in double float; do
        define=$([ $real = float ] && echo -DGIC_FLOAT)
        nm -S "$name.$real.O0.o" >"$name.$real.symbols"
        # shellcheck disable=SC2086  # none or one word
        cc -std=c99 $define -DMODEL="$name" -DHEADER="\"$name.h\"" -I"$root/runtime" -I. "$root/tests/data/report/facts.c" \
            "$name.$real.O0.o" "gic_runtime.$real.O0.o" -lm -o facts && ./facts >"$name.$real.facts"
        verdict $? "$name, $real: no facts"
    done
    /usr/bin/python3 "$root/tests/data/report/page.py" "$name.html" "$work/$name" "$name.sequence" "$name.double.facts" \
        "$name.float.facts" >said 2>&1
    verdict $? "$name: $(tail -n 1 said)"
    passed=$((passed + $(grep -c '^good' said)))
    failed=$((failed + $(grep -c '^bad' said)))
    sed -n "s/^bad/FAIL $name:/p" said
}

for model in "$root"/models/*.veh "$root/tests/data/laws/cart.veh"; do
    compare "$(basename "$model" .veh)" "$model"
    form=$(sed -n 's/^ \* Equations of motion in the \([a-z]*\) form.*/\1/p' "$name.c" | head -n 1)
    [ -n "$form" ] && grep -q "in the $form form" "$name.html"
    verdict $? "$name does not name the form"
done

# with reactions of all joints, and in the other form
"$gicgen" --dump-model "$root/models/hmmwv.veh" >hmmwv.json
sh "$root/tests/lib/reactions.sh" hmmwv.json "$root/models/hmmwv.veh" | sed 's/^model: .*/model: reacting/' >reacting.veh
sed 's/^model: .*/model: augmented/' reacting.veh >augmented.veh
compare reacting reacting.veh
grep -q '<td>wrenches</td>' reacting.html && [ "$(grep -c '<td>react</td>' reacting.html)" -eq 4 ]
verdict $? "no operations of reactions"
compare augmented augmented.veh --solve augmented
grep -q 'in the augmented form' augmented.html
verdict $? "the augmented form is not named"

# where parameters are used
grep -q '<td>k</td><td>N/m</td><td class="n">4000</td><td>force strut_l, force strut_r, force jet, force bumper_l, force bumper_r, force twist</td>' cart.html
verdict $? "users of parameter k: $(grep '<td>k</td>' cart.html)"

# names and texts are escaped
sed 's|^model: .*|&\ndescription: "a <b> \& \\"c\\" </p>"|; s|unit: N/m,|unit: "<N/m>",|' \
    "$root/tests/data/laws/cart.veh" >odd.veh
"$gicgen" --report - odd.veh >odd.html
verdict $? "no report on standard output"
grep -q '<p>a &lt;b&gt; &amp; &quot;c&quot; &lt;/p&gt;</p>' odd.html && grep -q '<td>&lt;N/m&gt;</td>' odd.html
verdict $? "texts are not escaped: $(grep -n 'description\|N/m' odd.html)"

# the same page again, byte for byte
"$gicgen" --report again.html "$root/models/hmmwv.veh" && cmp -s again.html hmmwv.html
verdict $? "the page is not the same again"

# without Graphviz the page says so
mkdir bin
PATH=$work/bin "$gicgen" --report plain.html "$root/models/pendulum.veh"
verdict $? "no page without Graphviz"
grep -q 'Graphviz' plain.html && ! grep -q '<svg' plain.html
verdict $? "no word of Graphviz"

# without a C compiler, and with templates of one's own that do not compile, the page says so and has all the rest
PATH=$work/bin "$gicgen" --report plain.html "$root/models/pendulum.veh" && grep -q "No sizes: the C compiler 'cc' can't be started" plain.html &&
    grep -q '<h2>Signals</h2>' plain.html && ! grep -q 'id="stack"' plain.html
verdict $? "no word of a missing compiler"
mkdir templates
cp -r "$root"/templates/* templates
sed -i 's/^    gic_head head;/    wonder it;\n&/' templates/model.h.in
"$gicgen" --templates templates --report strange.html "$root/models/pendulum.veh" && grep -q "No sizes: the C compiler 'cc' can't compile it" strange.html
verdict $? "no word of code that does not compile"

# clang knows sizes, no stacks
CC=clang "$gicgen" --report clang.html "$root/models/pendulum.veh" && grep -q 'clang</code>, which does not tell stacks' clang.html &&
    [ "$(grep 'instance</td>' clang.html)" = "$(grep 'instance</td>' pendulum.html)" ]
verdict $? "sizes by clang: $(grep instance clang.html)"

# mistakes
"$gicgen" --report nowhere/page.html "$root/models/pendulum.veh" 2>err
[ $? -eq 1 ] && grep -q "nowhere/page.html: error: can't create" err
verdict $? "an unwritable page: $(cat err)"
"$gicgen" --report page.html missing.veh 2>err
[ $? -eq 1 ] && grep -q "missing.veh: error: can't open" err && [ ! -e page.html ]
verdict $? "a missing model: $(cat err)"
"$gicgen" --report page.txt "$root/models/pendulum.veh" 2>err
[ $? -eq 2 ] && grep -q 'must end in .html' err
verdict $? "a page of another kind: $(cat err)"
"$gicgen" --report page.html --sequence "$root/models/pendulum.veh" 2>err
[ $? -eq 2 ] && grep -q 'only one of' err
verdict $? "two tasks: $(cat err)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
