#!/bin/sh
# SPDX-License-Identifier: MIT
# test_jit.sh GICGEN GICRUN STATES DENY_EXEC: the engines `tcc` and `auto`. Both do the operations of the other engines
# that run generated formulas in the same order, so results must agree byte by byte, and so must statuses: with compiled
# code along scenes of every model, with `tape` at ROWS (default 20) random states. What can be missing
# is: compiler, folder for temporary files, executable memory.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
deny_exec=$(realpath "$4")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
mkdir tmp
TMPDIR=$work/tmp
GICGEN_CACHE=$work/cache
export TMPDIR GICGEN_CACHE

clean() { [ -z "$(ls -A tmp)" ]; }
# gicrun with nothing to start and nowhere to write but where it is told to
alone() { env -i PATH=/nonexistent TMPDIR=/nonexistent "$gicrun" "$@"; }

# compiles in a tenth of the time
echo "exec ${CC:-cc} \"\$@\" -O0" >cc
quick="sh $work/cc"

# ---- the same bits ------------------------------------------------------------------------------------------------

# same_as MODEL SCENE COMPILER ENGINES [OPTION...]: summaries but for the time that it took
same_as() {
    model=$1
    scene=$2
    compiler=$3
    engines=$4
    shift 4
    "$gicrun" "$@" --engine cc --cc "$compiler" "$model" "$scene" -o run.csv 2>said
    verdict $? "$scene: cc $*"
    mv run.csv compiled.csv
    grep -v 'CPU time' said >compiled.said
    for engine in $engines; do
        alone "$@" --engine "$engine" "$model" "$scene" -o run.csv 2>said && cmp compiled.csv run.csv >>said &&
            grep -v 'CPU time' said | diff - compiled.said >>said && [ "$(wc -l <run.csv)" -gt 2 ]
        verdict $? "$scene: $engine $*"
    done
}
# same_run MODEL SCENE COMPILER: all engines; the tape has formulas for any scene
same_run() {
    same_as "$@" "tcc auto"
    same_as "$@" "tcc tape" --general
}
sed 's/^duration: .*/duration: 1.5/' "$root/models/scenes/paper_run.scene" >hmmwv.scene
same_run "$root/models/hmmwv.veh" hmmwv.scene "${CC:-cc}"
same_run "$root/models/hmmwv.veh" "$root/models/scenes/spin.scene" "$quick"
for model in "$root"/models/*.veh; do
    name=$(basename "$model" .veh)
    scene=$root/models/scenes/$name.scene
    if [ -f "$scene" ]; then
        sed 's/^duration: .*/duration: 0.04/; s/^output_step: .*//' "$scene" >"$name.scene"
        same_run "$model" "$name.scene" "$quick"
    fi
done

# same_states MODEL OPTION...: some out of reach, or, of an angle, thousands of turns away; some no state at all
same_states() {
    model=$1
    shift
    "$gicgen" --dump-model "$model" >dump 2>said && "$states" dump --count "${ROWS:-20}" --seed 7 >plain.csv 2>said &&
        awk -F, -v OFS=, 'NR == 1 { base = /e0/ } NR % 7 == 0 { $(base ? 14 : 1) += NR % 2 ? 4e9 : 4e4 } { print }' \
            plain.csv >states.csv &&
        alone "$@" --engine tape --eval states.csv "$model" -o tape.csv 2>said &&
        alone "$@" --engine tcc --eval states.csv "$model" -o tcc.csv 2>said && cmp tape.csv tcc.csv >>said &&
        grep -q ',0,"ok"' tcc.csv && grep -q ',-[0-9]*,"' tcc.csv
    verdict $? "states of $model $*"
}
sed "s|parts/|$root/models/parts/|g; s/^model: .*/model: steered/; s/^  rack: *{type: translation,/& driven: true,/" \
    "$root/models/hmmwv.veh" >steered.veh
for model in "$root"/models/*.veh steered.veh "$root"/tests/data/laws/*.veh "$root/tests/data/tuning/car.veh"; do
    same_states "$model"
done
"$gicgen" --dump-model "$root/models/hmmwv14.veh" >dump &&
    sh "$root/tests/lib/reactions.sh" dump "$root/models/hmmwv14.veh" >reactions.veh
same_states reactions.veh
same_states reactions.veh --solve augmented

# ---- auto: compiled code takes over -------------------------------------------------------------------------------

# some seconds, and a model that is compiled in a fraction of one
sed 's/^duration: .*/duration: 600/; s/^step: .*/step: 0.0002/; s/^integrator: .*/integrator: rk4/
    s/^output_step: .*/output_step: 1/' "$root/models/scenes/pendulum.scene" >long.scene
pendulum=$root/models/pendulum.veh
alone -q --engine tcc "$pendulum" long.scene -o long.csv 2>said
verdict $? "a long run"
# long LABEL REMARK OPTION...: auto gives the same, and tells how it went
long() {
    label=$1
    remark=$2
    shift 2
    "$gicrun" "$@" "$pendulum" long.scene -o auto.csv 2>said && cmp long.csv auto.csv >>said &&
        grep -q "^  compiled code  *$remark" said && [ "$(grep -c . said)" -eq 8 ] && clean
    verdict $? "auto: $label"
}
long "changes to compiled code" 'from t = [1-9]' --cc "$quick"
# every number of the code is another one in the last digit
cat >other <<'END'
for word; do
    case $word in
    */model.c) sed -i 's/^#define R(x) .*/#define R(x) (GIC_R(x) * GIC_R(1.0000000000000003))/' "$word" ;;
    esac
done
END
cat cc >>other
long "does not change to code with other bits" 'not used' --cc "sh $work/other"
long "a compiler that fails" "none: 'false' failed" --cc false
long "no compiler" "none: '/nonexistent' failed" --cc /nonexistent
# a library with nothing in it
echo 'while [ "$1" != -o ]; do shift; done; echo >"$2"' >empty
long "a compiler that makes something else" 'none' --cc "sh $work/empty"

# long enough for a compiler that shares the processor
sed 's/^integrator: .*/integrator: rkck/; s/^step: .*/tolerance: 1e-13/; s/^duration: .*/duration: 15000/' \
    "$root/models/scenes/pendulum.scene" | sed 's/^output_step: .*/output_step: 50/' >variable.scene
alone -q --engine tcc "$pendulum" variable.scene -o variable.csv 2>said &&
    "$gicrun" --cc "$quick" "$pendulum" variable.scene -o auto.csv 2>said && cmp variable.csv auto.csv >>said &&
    grep -q 'compiled code  *from' said
verdict $? "auto: changes between variable steps"

# a compiler that takes its time is ended with the run, or with a signal
printf 'echo $$ >%s/pid\nsleep 3000\n' "$work" >slow
"$gicrun" -q --cc "sh $work/slow" "$pendulum" long.scene -o auto.csv 2>said && cmp long.csv auto.csv >>said &&
    [ -s pid ] && ! kill -0 "$(cat pid)" 2>/dev/null && clean
verdict $? "auto: a run that ends before the compiler"
rm -f pid
sed 's/^duration: .*/duration: 100000/' long.scene >longer.scene
"$gicrun" -q --cc "sh $work/slow" "$pendulum" longer.scene -o auto.csv 2>said &
child=$!
waited=0
while [ ! -s pid ] && [ $waited -lt 100 ]; do
    sleep 0.1
    waited=$((waited + 1))
done
kill -TERM $child
wait $child 2>/dev/null
[ $? -eq 143 ] && [ -s pid ] && ! kill -0 "$(cat pid)" 2>/dev/null && clean
verdict $? "auto: SIGTERM ends run and compiler"

# ---- no support files ---------------------------------------------------------------------------------------------

# an empty folder in their place; a mount that no other process sees
support=$(dirname "$(tcc -print-search-dirs | sed -n 's/^ *\(.*\/libtcc1\.a\)$/\1/p')")
if [ -f "$support/libtcc1.a" ] && unshare -m mount -t tmpfs none "$support" 2>said; then
    "$gicrun" -q --engine tape "$pendulum" "$root/models/scenes/pendulum.scene" -o tape.csv &&
        unshare -m sh -c 'mount -t tmpfs none "$0" && [ ! -e "$0/libtcc1.a" ] && exec "$@"' "$support" \
            "$gicrun" -q --general --engine tcc "$pendulum" "$root/models/scenes/pendulum.scene" -o bare.csv 2>said &&
        cmp tape.csv bare.csv >>said
    verdict $? "tcc without its support files"
else
    echo "not tried without the support files of tcc, for this user can't hide them"
fi

# ---- no executable memory -----------------------------------------------------------------------------------------

"$gicrun" -q --engine tape "$root/models/hmmwv.veh" hmmwv.scene -o tape.csv
for engine in tcc auto; do
    "$deny_exec" "$gicrun" --engine $engine "$root/models/hmmwv.veh" hmmwv.scene -o denied.csv 2>said &&
        [ "$(grep -c '^gicrun: note: .*executable memory' said)" -eq 1 ] && cmp tape.csv denied.csv >>said
    verdict $? "$engine: interpreted where executable memory is refused"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
