#!/bin/sh
# SPDX-License-Identifier: MIT
# test_cli.sh GICGEN: the command line: exit statuses, files and messages, and that no partial output is left behind.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work" || exit 1

# run STATUS ARGUMENT...: calls gicgen; its words are in out and err
run() {
    wanted=$1
    shift
    "$gicgen" "$@" >out 2>err </dev/null
    status=$?
    [ "$status" -eq "$wanted" ]
    verdict $? "gicgen $*: exit status $status instead of $wanted: $(head -n 3 err)"
}

# says FILE TEXT
says() {
    grep -q -F -e "$2" "$1"
    verdict $? "$1 lacks '$2': $(head -n 3 "$1")"
}

model=$root/models/hmmwv.veh

for option in -h --help; do
    run 0 "$option"
    says out "usage: gicgen MODEL.veh"
done
run 0 --version
says out "gicgen 0."
run 2
says err "no model given"
run 2 --frobnicate "$model"
says err "unknown option: --frobnicate"
run 2 "$model" "$model"
says err "more than one model"
run 2 "$model" -o
says err "an argument is missing after: -o"
run 2 --sequence --dump-model "$model"
says err "only one of"
run 2 "$model" -o code.txt
says err "must end in .c: code.txt"
run 2 --graph picture.jpeg "$model"
says err "must end in .svg or .dot"
run 2 "$model" --solve
says err "an argument is missing after: --solve"
run 2 "$model" --solve quickly
says err "--solve takes auto, reduced, articulated or augmented, not: quickly"
run 2 "$model" --recovery quickly
says err "--recovery takes auto, newton, closed or polynomial, not: quickly"
run 2 --report page.html -o page.c "$model"
says err "--graph and --report name their file themselves, without -o: page.c"
run 2 --solve reduced --sequence "$model"
says err "--solve is for code and --report"
run 2 --recovery closed --dump-model "$model"
says err "--recovery is for code and --report"
run 2 --batch 0 "$model"
says err "--batch takes a number of vehicles up to 65536, not: 0"
run 2 --batch 8 --lanes 3 "$model"
says err "--lanes takes 2, 4, 8 or 16, not: 3"
run 2 --batch 8 --derivatives "$model"
says err "--derivatives is for the code of one vehicle in any scene"
run 2 --lanes 4 --fmu 2 --scene "$root/models/scenes/paper_run.scene" "$model"
says err "--lanes is for code"
run 1 --batch 8 "$root/models/semitrailer.veh"
says err "can't have outputs of reactions"
run 1 missing.veh
says err "missing.veh: error: can't open"
run 1 "$root/models"
says err "error: can't read"
[ -z "$(find . -name '*.c' -o -name '*.h' -o -name '*.tmp')" ]
verdict $? "a refused call left files: $(ls)"

# the code goes where it is asked for, and its include names the header beside it
run 0 "$model"
[ -s hmmwv.c ] && [ -s hmmwv.h ]
verdict $? "no hmmwv.c and hmmwv.h"
run 0 "$model" -o other.c
grep -q '^#include "other.h"$' other.c && cmp -s hmmwv.h other.h
verdict $? "other.c does not include other.h"
run 0 "$model" -o -
# less what ties the one file to the other
{ cat hmmwv.h && sed '/^#include "hmmwv.h"$/,/^#endif$/d' hmmwv.c; } >together
grep -v '^$' together >a && grep -v '^$' out >b && cmp -s a b
verdict $? "standard output is not header and code"
(cd "$root/models" && "$gicgen" - -o "$work/stdin.c") <"$model" && sed 's/"stdin.h"/"hmmwv.h"/' stdin.c | cmp -s - hmmwv.c
verdict $? "a model from standard input gives other code"

# an old file survives whatever goes wrong, and nothing else is left
echo old >kept.c
echo old >kept.h
sed "s/damping: 500/damping: minus/; s|parts/|$root/models/parts/|g" "$model" >broken.veh
run 1 broken.veh -o kept.c
[ "$(cat kept.c kept.h)" = "old
old" ]
verdict $? "a broken model touched the old output"
mkdir locked
echo old >locked/kept.c
chmod a-w locked
if [ ! -w locked ]; then # root may write anyway
    run 1 "$model" -o locked/kept.c
    says err "error: can't create"
    [ "$(cat locked/kept.c)" = old ]
    verdict $? "an unwritable folder touched the old output"
fi
run 1 "$model" -o nowhere/code.c
says err "nowhere/code.h: error: can't create"
"$gicgen" "$model" -o - >/dev/full 2>err
[ $? -eq 1 ]
verdict $? "a full disk is no failure"
says err "can't write"

# pictures
run 0 --graph hmmwv.dot "$model"
run 0 --graph hmmwv.svg "$model"
for body in chassis rack lca_f_l lca_r_r wheel_f_r wheel_r_l; do
    says hmmwv.dot "$body"
    says hmmwv.svg ">$body<"
done
says hmmwv.svg "</svg>"
mkdir bin
PATH=$work/bin "$gicgen" --graph none.svg "$model" 2>err
[ $? -eq 1 ] && [ ! -e none.svg ]
verdict $? "a picture without Graphviz"
says err "apt-get install graphviz"

# what is no file stays what it is: as root a rename would replace a device
mkfifo pipe
cat pipe >piped &
run 0 --dump-model "$model" -o pipe
wait
[ -p pipe ]
verdict $? "a pipe is gone"
"$gicgen" --dump-model "$model" | cmp -s - piped
verdict $? "what comes through a pipe"

# templates of one's own
mkdir templates
cp "$root"/templates/*.in templates
run 0 --templates templates "$model" -o same.c
sed 's/"same.h"/"hmmwv.h"/' same.c | cmp -s - hmmwv.c
verdict $? "the same templates give other code"
sed -i 's/^int PREFIX_setup(/\/* our own *\/\n&/' templates/model.c.in
run 0 --templates templates "$model" -o own.c
says own.c "/* our own */"
run 1 --templates empty "$model" -o none.c
says err "empty/model.c.in: error: can't open"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
