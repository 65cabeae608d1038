#!/bin/sh
# SPDX-License-Identifier: MIT
# words.sh GICGEN: texts and names that would be code if they could. Texts must arrive in the compiled program byte for
# byte, trigraphs on, and stay text on the pages; names are refused or compile as C99, GNU C and C++, in all places at
# once (short: some of them).
gicgen=$(realpath "$1")
runtime=$(realpath "$(dirname "$0")/../../runtime")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
cc=${CC:-cc}

# model NAME TEXT WORD: TEXT as YAML in single quotes
model() {
    cat <<END
gicgen: 1
model: $1
description: '$2'
base: ground
bodies: {$3: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}}
joints: {$3: {type: revolute, bodies: [ground, $3], point: [0, 0, 0], axis: [0, 1, 0]}}
coordinates: {w_$3: {type: angle, bodies: [ground, $3], axis: [0, 1, 0]}}
inputs: {$3: {unit: '$2'}}
parameters: {p_$3: {value: 1, tunable: true, unit: '$2'}}
tables: {$3: {x: [0, 1], y: [0, 1]}}
forces: {$3: {type: force, coordinate: w_$3, value: p_$3 * $3 + $3(w_$3)}}
outputs: {$3: {type: position, body: $3}}
END
}
cat >main.c <<'END'
#include "car.h"
#include <stdio.h>
int main(void)
{
    return printf("%s\n%s\n%s\n", car_model.description, car_model.input[0].unit, car_model.parameter[0].unit) < 0;
}
END

# ---- texts, a line each ----
cat >texts <<'END'
plain
"); system("touch spoilt"); ("
\" \\ \
ends in a backslash \
??/" ??/ ???/ ??=define ??( ??'
%s%n%d%100000s
`touch spoilt` $(touch spoilt) ${HOME}
</script><script>alert(1)</script><!-- ]]> &amp; &lt;
// # line 1 "x"
é ü 漢字 𝄞 ‮ right to left
@%:#$ {} [] 'single' "double"
END
awk 'BEGIN { while (i++ < 10000) printf "a"; print "" }' >>texts
printf 'a*/b\na/*b\n' >refused_texts
"$gicgen" --report harmless.html - <<END >/dev/null 2>&1 || exit 1
$(model car plain arm)
END
tags() { grep -o '<[a-zA-Z/!]*' "$1" | sort | uniq -c; }
tried=0 good=0 refused=0 wrong=
count() {
    tried=$((tried + 1))
    if [ -n "$1" ]; then
        wrong=${wrong:-$2: $1}
        echo "$2: $1" >&2
    fi
}
while IFS= read -r text; do
    model car "$(printf '%s' "$text" | sed "s/'/''/g")" arm >car.veh
    reason=
    if ! "$gicgen" car.veh -o car.c 2>err; then
        reason="refused: $(head -n 1 err)"
    elif ! $cc -std=c99 -trigraphs -w -I"$runtime" car.c main.c "$runtime/gic_runtime.c" -lm -o car 2>err; then
        reason="does not compile: $(grep -m 1 error err)"
    elif ! ./car >said || ! printf '%s\n%s\n%s\n' "$text" "$text" "$text" | cmp -s - said; then
        reason="arrives as $(head -c 100 said | head -n 1)"
    elif ! "$gicgen" --report page.html car.veh 2>err || ! tags harmless.html >tags || ! tags page.html | cmp -s tags; then
        reason="other tags on the page"
    elif ! "$gicgen" --dump-model car.veh | python3 -m json.tool >/dev/null 2>err; then
        reason="no JSON: $(tail -n 1 err)"
    elif ! "$gicgen" --main car.veh >example.c || ! $cc -std=c99 -trigraphs -w -I. -I"$runtime" -c example.c 2>err; then
        reason="the example does not compile: $(grep -m 1 error err)"
    elif [ -e spoilt ]; then
        reason="became a command"
    fi
    count "$reason" "$(printf '%.30s' "$text" | tr '|' '/')"
    [ -n "$reason" ] || good=$((good + 1))
done <texts
while IFS= read -r text; do
    model car "$text" arm >car.veh
    reason=
    "$gicgen" car.veh -o car.c 2>err && reason=taken
    count "$reason" "$text"
    [ -n "$reason" ] || refused=$((refused + 1))
done <refused_texts
echo "words | texts | $tried | $good | $refused | | ${wrong:-ok}"

# ---- names ----
cat >names <<'END'
a int main self state result x q sin sinf size_t NULL EOF M_PI INT32_MAX linux unix std index signal y0 jn gamma lgamma_r
f32addf64 strtof64 printf typeof asm and class template near far step setup rhs outputs model car gic gic_real time rate
count inputs e E I d f l u ull
END
cat >headers.c <<'END'
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
END
if [ "$STRESS" != short ]; then
    for language in "-x c -std=gnu17 -D_GNU_SOURCE" "-x c++"; do
        # shellcheck disable=SC2086  # list of words
        { $cc $language -E -P headers.c && $cc $language -E -dM headers.c; } 2>err
    done | grep -oE '\b[A-Za-z][A-Za-z0-9_]{0,39}\b' >>names
fi
tried=0 good=0 refused=0 wrong=
for name in $(tr ' ' '\n' <names | sort -u); do
    reason=
    model "$name" text arm >name.veh
    model car text "$name" >word.veh
    rm -f name.c word.c
    if "$gicgen" name.veh -o name.c 2>err; then
        for language in "-x c -std=c99" "-x c -std=gnu17 -D_GNU_SOURCE" "-x c++"; do
            # shellcheck disable=SC2086  # list of words
            $cc $language -w -I"$runtime" -include stdlib.h -fsyntax-only name.c 2>err ||
                reason="as a model's: $(grep -m 1 error err)"
        done
        good=$((good + 1))
    else
        [ "$(grep -c 'error: ' err)" -eq 1 ] || reason="refused without a message"
        refused=$((refused + 1))
    fi
    if "$gicgen" word.veh -o word.c 2>err; then
        $cc -std=c99 -Wall -Wextra -Werror -I"$runtime" -fsyntax-only word.c 2>err ||
            reason="as an entry's: $(grep -m 1 error err)"
    elif [ "$(grep -c 'error: ' err)" -ne 1 ]; then
        reason="refused without a message"
    fi
    count "$reason" "$name"
done
echo "words | names | $tried | $good | $refused | | ${wrong:-ok}"
