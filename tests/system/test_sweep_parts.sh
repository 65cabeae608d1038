#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_parts.sh GICSWEEP: a sweep in parts, which are killed, asked to stop, requeued and begun again, has the bytes of
# one process, and no run is lost or made twice: by a loop, and by a Slurm cluster of one node that this test starts; full and
# read-only file systems, damaged and foreign files, wrong clocks; a million runs in bounded memory and few files.
gicsweep=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/slurm.sh
. "$(dirname "$0")/../lib/slurm.sh"
GICGEN_CACHE=$work/kept
OMP_NUM_THREADS=2
export GICGEN_CACHE OMP_NUM_THREADS
car=models/hmmwv_tires.veh
mounted=
slurm=
trap '[ -z "$slurm" ] || slurm_stop; [ -z "$mounted" ] || umount "$mounted"; rm -rf "$work"' EXIT

# says TEXT STATUS COMMAND...: it ends with the status and the text in its message
says() {
    text=$1
    status=$2
    shift 2
    "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err"
}

# number MOST: a random number below MOST; the same ones in each test
seed=1
number() {
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    picked=$((seed / 65536 % $1))
}

cat >"$work/s.scene" <<'YYY'
gicscene: 1
ratio: 2
duration: 2
step: 0.002
road: {type: bumps, bumps: [{x: 4, length: 2, height: 0.06, tracks: left}]}
outputs: [chassis.z]
YYY
runs=240

# sweep ARGUMENT...: run by run, so that it can be ended between them
sweep() {
    "$gicsweep" --engine cc "$car" "$work/s.scene" --latin $runs --seed 7 --vary speed=4:6 --vary spring_f_l=0.23:0.24 "$@"
}
# task I [FOLDER]: as Slurm starts it
task() {
    exec env SLURM_ARRAY_TASK_ID="$1" sh "${2:-$work/plan}/job.sh"
}
# process_of TASK PLAN: the processes of a task's gicsweep
process_of() {
    grep -lzx -- "$1/8" /proc/[0-9]*/cmdline 2>/dev/null | while read -r file; do
        grep -qzx -- "$2" "$file" 2>/dev/null && echo "$file" | cut -d/ -f3
    done
}
files() { find "$1" -type f | wc -l; }
merge() { "$gicsweep" --merge "${1:-$work/plan}" -o "$work/merged.csv"; }
# once FOLDER: no run is in the journals twice, and all are there
once() {
    [ "$(sed 1d "$1"/part_1.journal | wc -l)" -gt 0 ] &&
        for journal in "$1"/part_*.journal; do sed 1d "$journal"; done | cut -d' ' -f2 | sort -n >"$work/made" &&
        [ "$(wc -l <"$work/made")" -eq $runs ] && [ -z "$(uniq -d "$work/made")" ]
}

sweep -q -o "$work/whole.csv" 2>"$work/err"
check "one process" [ $? -eq 0 ]

# ---- eight tasks by a loop, in any order, each killed or asked to stop on its way some times

check "a plan" eval 'sweep --slurm "$work/plan" --parts 8 2>"$work/err"'
check "which says what to do" grep -q "$runs runs in 8 parts .* sbatch .*/plan/job.sh, then .* --merge" "$work/err"
check "two files" [ "$(cd "$work/plan" && echo ./*)" = "./job.sh ./plan" ]
check "a script that the shell takes" sh -n "$work/plan/job.sh"
check "nothing is made yet" says "240 of 240 runs in .* are missing, in parts 1-8 of 8" 1 merge
check "and no table" [ ! -e "$work/merged.csv" ]
# cut I SIGNAL: begin a task and end it when it has some rows more
cut_short() {
    journal="$work/plan/part_$1.journal"
    had=$(cat "$journal" 2>/dev/null | wc -l)
    number 6
    more=$((had + 1 + picked))
    (task "$1") >"$work/out" 2>"$work/err" &
    child=$!
    while kill -0 $child 2>/dev/null && [ "$(cat "$journal" 2>/dev/null | wc -l)" -lt $more ]; do sleep 0.01; done
    kill "-$2" $child 2>/dev/null
    wait "$child" 2>/dev/null
}
for i in 5 2 8 1; do cut_short $i KILL; done
: >"$work/asked"
for i in 3 7 5 8 4 6; do
    cut_short $i TERM
    cat "$work/err" >>"$work/asked"
done
# one at least: on a busy machine some are done before they are asked
check "asked to stop: says what is kept" grep -q "interrupted; [0-9]* of 30 runs are kept in .*/part_[345678].journal" "$work/asked"
for i in 2 4 5 6 7; do # those that were done all the same lose rows, so that what is missing is known
    [ ! -e "$work/plan/part_$i.journal" ] || sed -i '6,$d' "$work/plan/part_$i.journal"
done
printf '1234 5 0 half a li' >>"$work/plan/part_2.journal" # as a kill within a write leaves it
for i in 8 3 1; do
    (task $i) >"$work/out" 2>"$work/err"
    check "task $i goes on" [ $? -eq 0 ]
done
check "what is missing" says "in parts 2,4-7 of 8" 1 merge
check "and how to start it" grep -q "remedy: .*sbatch --array=2,4-7 .*/plan/job.sh" "$work/err"
for i in 7 6 5 4 2; do (task $i) >"$work/out" 2>"$work/err"; done
check "one table" merge 2>"$work/err"
check "with the bytes of one process" cmp -s "$work/whole.csv" "$work/merged.csv"
check "no run is lost, none made twice" once "$work/plan"
(task 4) >"$work/out" 2>"$work/err"
check "a finished task makes nothing" grep -q "30 runs in .*, 30 of them from an earlier start" "$work/err"
check "files of tasks, not of runs" [ "$(files "$work/plan")" -eq 10 ]

# by --shard alone, without a plan made before; the folder has a blank
sweep -q --shard 2/3 -o "$work/own folder" 2>"$work/err"
check "parts that are missing, without a script" eval 'says "in parts 1,3 of 3" 1 merge "$work/own folder" &&
    grep -q "remedy: .*: gicsweep --shard I/3 -o $work/own folder with .*, I = 1,3$" "$work/err" && ! grep -q sbatch "$work/err"'
sweep -q --shard 1/3 -o "$work/own folder" 2>"$work/err"
check "one that is missing" eval 'says "in part 3 of 3" 1 merge "$work/own folder" && grep -q "remedy: .*: gicsweep --shard 3/3 -o " "$work/err"'
sweep -q --shard 3/3 -o "$work/own folder" 2>"$work/err"
check "--shard" merge "$work/own folder" 2>"$work/err"
check "has the same bytes" cmp -s "$work/whole.csv" "$work/merged.csv"
check "another number of parts" says "has 3 parts, not 4" 1 sweep --shard 1/4 -o "$work/own folder"
check "a grid" eval '"$gicsweep" -q "$car" "$work/s.scene" --vary speed=4:6:7 --vary spring_f_l=0.23:0.24:3 -o "$work/grid.csv" &&
    for i in 1 2 3 4; do "$gicsweep" -q "$car" "$work/s.scene" --vary speed=4:6:7 --vary spring_f_l=0.23:0.24:3 --shard $i/4 \
        -o "$work/grid" || break; done && merge "$work/grid" && cmp -s "$work/grid.csv" "$work/merged.csv"'

# ---- two at once: one of them writes

# The first stands still while the second begins; where it was done before it could be stopped, once more.
for try in 1 2 3 4 5 6 7 8 9 10; do
    rm -f "$work/plan/part_6.journal"
    (task 6) >"$work/out" 2>"$work/err" &
    child=$!
    while kill -0 $child 2>/dev/null && [ "$(cat "$work/plan/part_6.journal" 2>/dev/null | wc -l)" -lt 2 ]; do sleep 0.01; done
    first=$(process_of 6 "$work/plan")
    # shellcheck disable=SC2086  # words
    [ -n "$first" ] && kill -STOP $first 2>/dev/null && break
    wait "$child"
done
(task 6) >"$work/out" 2>"$work/second"
check "a second process at the same part, the first stopped after $try tries" grep -q "another gicsweep is writing .*/part_6.journal" "$work/second"
# shellcheck disable=SC2086  # words
kill -CONT $first
wait "$child"
check "the first makes it" once "$work/plan"

# ---- files that are not what they should be

# fresh: a plan of which parts 1 and 2 are made
fresh() {
    rm -rf "$work/bad"
    cp -r "$work/plan" "$work/bad"
    sed "s|/plan'|/bad'|g" "$work/plan/job.sh" >"$work/bad/job.sh"
}
both() {
    check "$1: a task" says "$2" 1 task_quietly 2
    check "$1: the table" says "$2" 1 merge "$work/bad"
}
task_quietly() { (task "$1" "$work/bad"); }
fresh
sed -i "s/^runs .*/runs 239/" "$work/bad/plan"
both "an edited plan" "plan has been edited"
fresh
sed -i "s/^gicsweep plan .*/gicsweep plan 0.0.9/" "$work/bad/plan"
both "a plan of another version" "is of gicsweep 0.0.9, and this is"
fresh
echo mine >"$work/bad/plan"
both "no plan" "is no plan of gicsweep"
fresh
sed -i "s/'--seed' '7'/'--seed' '8'/" "$work/bad/job.sh"
check "an edited command" says "plan is of another sweep" 1 task_quietly 2
fresh
sed -i '1s/journal ./journal x/' "$work/bad/part_2.journal"
both "a journal of another version" "part_2.journal is of another sweep"
fresh
cp "$work/bad/part_3.journal" "$work/bad/part_2.journal"
both "a journal of another part" "part_2.journal is the journal of part 3 of 8 of this sweep, not of part 2 of 8"
# a digit, a blank, and what a machine leaves that lost its power
for damage in '3s/,0\.2/,0.3/' '9s/$/ /' '12s/.*/\x00\x00\x00/'; do
    fresh
    sed -i "$damage" "$work/bad/part_2.journal"
    check "damaged, $damage: a run is missing" says "1 of 240 runs in .* are missing, in part 2 of 8" 1 merge "$work/bad"
    check "which is made again" task_quietly 2 2>"$work/err"
    check "and the bytes are those" eval 'merge "$work/bad" 2>"$work/err" && cmp -s "$work/whole.csv" "$work/merged.csv"'
done
# a row with other numbers and a checksum that is right, as nodes with different libraries make them
fresh
/usr/bin/python3 - "$work/bad/part_2.journal" <<'YYY'
import sys
line = open(sys.argv[1]).read().splitlines()[3]
text = line.split(" ", 1)[1] + "1"
sum = 0xcbf29ce484222325
for byte in text.encode():
    sum = (sum ^ byte) * 0x100000001b3 % 2**64
open(sys.argv[1], "a").write(f"{sum:016x} {text}\n")
YYY
both "two rows of a run that differ" "part_2.journal has two rows of run 32 that differ"

# ---- clocks that are wrong

fresh
rm "$work/bad/part_5.journal"
touch -d '3 days' "$work/bad/plan" "$work/bad"
touch -d '40 years ago' "$work/bad/part_4.journal" "$work/bad/job.sh"
touch -d '2 hours' "$work/bad/part_3.journal"
check "files of nodes whose clocks are wrong" eval 'task_quietly 5 2>"$work/err" && task_quietly 4 2>>"$work/err" &&
    merge "$work/bad" 2>>"$work/err" && cmp -s "$work/whole.csv" "$work/merged.csv"'

# ---- a file system that is full, or read-only

# a limit on the size of files, as a quota
fresh
rm "$work/bad/part_2.journal"
check "a quota" eval '(trap "" XFSZ; ulimit -f 2; task 2 "$work/bad") >"$work/out" 2>"$work/err"; [ $? -eq 1 ]'
check "a message" grep -q "can't write .*/part_2.journal: File too large" "$work/err"
kept=$(sed 1d "$work/bad/part_2.journal" | grep -c '^[0-9a-f]\{16\} [0-9]* 0 .*,.*,.*,.*,.*,.*,.*$')
check "some rows are kept" [ "$kept" -gt 3 ]
check "the rest is made afterwards" eval 'task_quietly 2 2>"$work/err" && merge "$work/bad" 2>"$work/said" &&
    cmp -s "$work/whole.csv" "$work/merged.csv"'
check "and no run twice" once "$work/bad"
mkdir "$work/small"
if mount -t tmpfs -o size=20k none "$work/small" 2>"$work/err"; then
    mounted=$work/small
    sweep --slurm "$work/small/plan" --parts 8 2>"$work/err"
    for i in 1 2 3 4 5 6 7 8; do (task $i "$work/small/plan") >"$work/out" 2>>"$work/err"; done
    check "full: a message" grep -q "can't write .*/part_[0-9].journal: No space left on device" "$work/err"
    check "runs are missing" says "runs in .* are missing" 1 merge "$work/small/plan"
    mount -o remount,size=1m "$work/small"
    mount -o remount,ro "$work/small"
    (task 8 "$work/small/plan") >"$work/out" 2>"$work/err"
    check "read-only: a message" grep -q "can't open .*/part_8.journal: Read-only file system" "$work/err"
    check "a plan" says "can't make the folder .*: Read-only file system" 1 sweep --slurm "$work/small/other"
    mount -o remount,rw "$work/small"
    for i in 1 2 3 4 5 6 7 8; do (task $i "$work/small/plan") >"$work/out" 2>>"$work/err"; done
    mount -o remount,ro "$work/small"
    check "after all of it the same bytes" eval 'merge "$work/small/plan" 2>"$work/err" && cmp -s "$work/whole.csv" "$work/merged.csv"'
    check "and no run twice" once "$work/small/plan"
    umount "$work/small" && mounted=
else
    echo "skipped: full and read-only file systems; mount: $(head -n 1 "$work/err")"
fi

# ---- parts of a stated duration

check "parts of half a second" eval 'sweep --slurm "$work/chunks" --chunk 0.5 2>"$work/err"'
parts=$(sed -n 's/^parts //p' "$work/chunks/plan")
check "more than one" [ "$parts" -gt 1 ]
# processor time, which other programs don't lengthen
/usr/bin/python3 - "$work/chunks" <<'YYY' >"$work/out" 2>&1
import os, resource, subprocess, sys
env = dict(os.environ, SLURM_ARRAY_TASK_ID="2")
subprocess.run(["sh", sys.argv[1] + "/job.sh"], env=env, check=True)
spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
assert 0.05 < spent < 4, spent
YYY
check "which they take, within what compiling takes and a busy machine makes of it" [ $? -eq 0 ]

# ---- a million runs: memory and files

cat >"$work/cart.veh" <<'YYY'
gicgen: 1
model: cart
base: ground
bodies:
  cart: {mass: 2, position: [0, 0, 0], com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  s: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-100, 100]}
outputs:
  s: {type: coordinate, coordinate: s}
YYY
printf '%s\n' 'gicscene: 1' 'duration: 0.1' 'step: 0.01' 'outputs: [s.value]' >"$work/cart.scene"
# peak ARGUMENT...: MB that gicsweep takes at most
peak() {
    /usr/bin/python3 -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)' "$gicsweep" -q "$@" 2>>"$work/err"
}
carts() {
    many=$1
    shift
    peak "$work/cart.veh" "$work/cart.scene" --vary s=0:1 --latin "$many" "$@"
}
few=$(carts 1000 --shard 1/4 -o "$work/few")
part=$(carts 1000000 --shard 1000/1000 -o "$work/many")
planned=$(carts 1000000 --slurm "$work/planned" --parts 1000)
# what the other parts would have made: journals by the rule that stands in sweep/journal.c, computed here
/usr/bin/python3 - "$work/many" <<'YYY' 2>>"$work/err"
import sys
import numpy
head = open(sys.argv[1] + "/part_1000.journal").readline()
rows = numpy.char.zfill(numpy.arange(1000000).astype("U7"), 7)
text = numpy.char.add(numpy.char.add(rows, " 0 "), rows).astype("S17")
byte = text.view("u1").reshape(len(rows), 17)
sum = numpy.full(len(rows), 0xcbf29ce484222325, "u8")
for i in range(17):
    sum = (sum ^ byte[:, i]) * numpy.uint64(0x100000001b3)
for part in range(1, 1001):
    with open(f"{sys.argv[1]}/part_{part}.journal", "w") as file:
        file.write(head.replace("part 1000 of", f"part {part} of"))
        for r in range((part - 1) * 1000, part * 1000):
            file.write(f"{sum[r]:016x} {text[r].decode()}\n")
YYY
merged=$(peak --merge "$work/many" -o "$work/million.csv")
check "a million runs: files of parts" [ "$(files "$work/many")" -eq 1001 ]
check "and of a plan" [ "$(files "$work/planned")" -eq 2 ]
check "the table" eval 'sed 1d "$work/million.csv" | awk "\$0 != sprintf(\"%07d\", NR - 1) { bad = 1 } END { exit bad || NR != 1000000 }"'
check "memory for a part: $few MB of a thousand runs, $part MB of a million" [ "$part" -lt $((few + 16)) ]
check "for planning: $planned MB" [ "$planned" -lt $((few + 48)) ]
check "for one table: $merged MB" [ "$merged" -lt $((few + 16)) ]

# ---- Slurm: eight tasks, killed, asked to stop, requeued at random

# disturb JOB: something happens to one of its tasks
disturb() {
    number 8
    i=$((picked + 1))
    case $(($(wc -l <"$work/disturbed") % 3)) in
    0) what=requeue ;;
    1) what=KILL ;;
    2) what=TERM ;;
    esac
    if [ "$what" = requeue ]; then
        scontrol requeue "$1_$i" >/dev/null 2>&1 || return
    else
        process=$(process_of $i "$plan")
        [ -n "$process" ] || return
        # shellcheck disable=SC2086  # words
        kill "-$what" $process 2>/dev/null || return
    fi
    echo "$what $i" >>"$work/disturbed"
}
if slurm_start "$work/slurm"; then
    : >"$work/disturbed"
    begun=0
    # A machine may run all tasks before it gets to disturb six: then again, with runs of twice the length.
    for seconds in 4 8 16 32 64; do
        plan=$work/slurmed_$seconds
        sed -i "s/^duration: .*/duration: $seconds/" "$work/s.scene"
        sweep -q -o "$work/whole.csv" 2>"$work/err"
        sweep --slurm "$plan" --parts 8 2>"$work/err"
        job=$(sbatch --parsable "$plan/job.sh" 2>"$work/err")
        check "Slurm takes the script" [ -n "$job" ]
        tries=0
        while [ $((tries += 1)) -le 12 ]; do
            begun=$((begun + 1))
            while [ -n "$(squeue -h -j "$job" 2>/dev/null)" ]; do
                [ "$(wc -l <"$work/disturbed")" -ge 16 ] || disturb "$job"
                sleep 0.1
                for i in 1 2 3 4 5 6 7 8; do # without the two minutes that Slurm waits after requeuing
                    scontrol update JobId="${job}_$i" StartTime=now 2>/dev/null
                done
            done
            merge "$plan" 2>"$work/err" && break
            array=$(sed -n 's/.*sbatch \(--array=[0-9,-]*\) .*/\1/p' "$work/err")
            [ -n "$array" ] || break
            job=$(sbatch --parsable "$array" "$plan/job.sh" 2>"$work/err")
        done
        check "Slurm: one table" merge "$plan" 2>"$work/err"
        check "with the bytes of one process" cmp -s "$work/whole.csv" "$work/merged.csv"
        check "no run is lost, none made twice" once "$plan"
        [ "$(wc -l <"$work/disturbed")" -lt 6 ] || break
    done
    check "tasks were disturbed" [ "$(wc -l <"$work/disturbed")" -ge 6 ]
    check "logs of tasks" [ -s "$plan/part_1.log" ]
    echo "Slurm $(sbatch --version | cut -d' ' -f2): $begun submissions; $(cut -d' ' -f1 "$work/disturbed" | sort | uniq -c | tr -s ' \n' ' ')"
    slurm_stop
else
    echo "skipped: Slurm does not start here: $slurm_why"
fi

# ---- the command line

check "no part 0" says "--shard takes I/N" 2 sweep --shard 0/8 -o "$work/e"
check "no part 9 of 8" says "--shard takes I/N" 2 sweep --shard 9/8 -o "$work/e"
check "no N" says "--shard takes I/N" 2 sweep --shard 3 -o "$work/e"
check "no folder" says "--shard needs the folder" 2 sweep --shard 3/8
check "more parts than runs" says "241 parts are more than the 240 runs" 2 sweep --shard 3/241 -o "$work/e"
check "a plan with -o" says "--slurm names a folder" 2 sweep --slurm "$work/e" -o "$work/f"
check "a plan of a part" says "--slurm plans all parts" 2 sweep --slurm "$work/e" --shard 1/8
check "a chunk alone" says "go with --slurm" 2 sweep --chunk 5
check "a chunk and parts" says "not both" 2 sweep --slurm "$work/e" --chunk 5 --parts 8
check "no time" says "--chunk takes seconds" 2 sweep --slurm "$work/e" --chunk 0
check "merging with a model" says "--merge takes -o, --report and --front" 2 "$gicsweep" --merge "$work/plan" "$car"
check "merging nothing" says "/nowhere/plan: error: can't open" 1 "$gicsweep" --merge "$work/nowhere"
check "merging over the plan" says "results do not go to" 2 "$gicsweep" --merge "$work/plan" -o "$work/plan/plan"
check "nothing is made" [ ! -e "$work/e" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
