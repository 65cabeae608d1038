#!/bin/sh
# SPDX-License-Identifier: MIT
# test_live.sh GICRUN: gicrun --live: recordings replay to the same bytes, by every way inputs may come; bad packets are
# counted by their reasons and change nothing; signals end it with whole files; its clients work; mistakes are messages. No
# check depends on how long something took.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
case $gicrun in /*) ;; *) gicrun=$PWD/$gicrun ;; esac
cd "$work" || exit 1
vehicle=$root/models/hmmwv_vehicle.veh
lane=$root/models/scenes/lane_change.scene
quarter=$root/models/quarter_car.veh
tool() { /usr/bin/python3 -B "$root/tests/tools/live.py" "$@" >"$work/said" 2>&1; }

# begin ARGUMENTS: a run at a free port, which becomes $port once it is there
begin() {
    : >out
    : >err
    env --default-signal=INT "$gicrun" --live 0 "$@" >out 2>err & # the shell lets what is in the background ignore it
    runner=$!
    port=
    while [ -z "$port" ] && kill -0 $runner 2>"$work/said"; do
        port=$(sed -n 's/.* at port \([0-9]*\) of .*/\1/p' err)
        sleep 0.1
    done
}
end() {
    wait $runner
    status=$?
}
# again MODEL SCENE: replayed, it is the same
again() {
    "$gicrun" -q --replay inputs.csv "$@" -o again.csv >"$work/said" 2>&1 && cmp live.csv again.csv >"$work/said" 2>&1
}
# the three columns of steps, and the bare thread's, add up to their last row, and the first to the steps of the run
sums() {
    awk '/ in [0-9]+ steps of / { for (i = 1; i < NF; ++i) if ($(i + 1) == "steps") steps = $i }
        /us, up to/ { on = 1; next }
        on && $1 == "all" { good = $2 == steps && $4 == steps && $5 == steps
            for (i = 2; i <= 5; ++i) good = good && sum[i] == $i
            seen = 1; on = 0 }
        on { for (i = 2; i <= 5; ++i) sum[i] += $i }
        END { exit !(seen && good && steps > 0) }' err
}

# ---- nobody comes

begin "$vehicle" "$lane" --seconds 1 -o live.csv --record inputs.csv
end
check 'a run' exits 0
check 'histograms have all steps' sums
check 'all steps of its time' says 'in 166 steps of 0.006 s'
check 'it replays' again "$vehicle" "$lane"
"$gicrun" -q --general "$vehicle" "$lane" -o plain.csv
# by the same code, the scene's own run begins in the same way
same_start() { head -n "$(wc -l <live.csv)" plain.csv | cmp - live.csv >"$work/said" 2>&1; }
check 'it is the run of the scene' same_start

# ---- someone drives: everything, some inputs, with rates, and gives them back

begin "$vehicle" "$lane" --seconds 4 -o live.csv --record inputs.csv
tool drive "$port"
verdict $? 'all inputs are taken over, held, and given back'
end
check 'it ends well' exits 0
check 'histograms have all steps' sums
check 'taken over once, and given back' says 'taken over           1 times, given back 1 times'
check 'it replays, byte for byte' again "$vehicle" "$lane"
"$gicrun" -q --engine tape --replay inputs.csv "$vehicle" "$lane" -o tape.csv
check 'by another engine too' cmp live.csv tape.csv
hands() { cut -d, -f2 inputs.csv | sed 1d | uniq | tr '\n' ' ' | grep -qx "$1 "; }
check 'the recording says who drove, and how' hands '0 1 2 0'

begin "$vehicle" "$lane" --inputs accelerator,brake --seconds 5 -o live.csv --record inputs.csv
/usr/bin/python3 -B "$root/runtime/examples/live_client.py" "$port" 1.5 >said 2>&1
verdict $? 'the client in Python'
end
check 'it drove' grep -q 'm/s at t' said
check 'it took the pedals over and gave them back' says 'taken over           1 times, given back 1 times'
check 'nothing of it was dropped' says ' 0 dropped'
check 'it replays: the driver steered meanwhile' again "$vehicle" "$lane"

${CC:-cc} -std=c99 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Wpedantic -Werror -O2 -I"$root/runtime" \
    "$root/runtime/examples/live_client.c" -o client -lm >said 2>&1
verdict $? 'the client in C compiles'
begin "$vehicle" "$lane" --inputs accelerator,brake --seconds 5 -o live.csv --record inputs.csv
./client "$port" 1.5 >said 2>&1
verdict $? 'it drives'
end
check 'it took the pedals over and gave them back' says 'taken over           1 times, given back 1 times'
check 'nothing of it was dropped' says ' 0 dropped'
check 'it replays' again "$vehicle" "$lane"

# a joystick: its device is a pipe here, with the bytes that Linux's has
cat >stick.py <<'END'
import struct, sys, time
with open(sys.argv[1], 'wb', buffering=0) as stick:
    def tell(value, kind, number):
        stick.write(struct.pack('<IhBB', 0, value, kind, number))
    for number, value in ((0, 0), (2, -32767), (5, -32767), (7, 12345)):
        tell(value, 0x82, number)
    tell(0, 0x81, 0)
    tell(1, 0x40, 0)  # no such kind
    time.sleep(.5)
    tell(16384, 2, 5)
    stick.write(struct.pack('<IhBB', 0, -32767, 2, 0)[:3])
    time.sleep(.3)
    stick.write(struct.pack('<IhBB', 0, -32767, 2, 0)[3:])
    tell(1, 1, 0)
    time.sleep(.7)
END
mkfifo stick
begin "$vehicle" "$lane" --seconds 6 -o live.csv --record inputs.csv
/usr/bin/python3 stick.py stick &
/usr/bin/python3 -B "$root/runtime/examples/live_joystick.py" "$port" stick rack=axis0:0.03:-0.03 accelerator=axis5:0:1 \
    brake=axis2:0:1 selector=button0:0:1 >out2 2>said
[ $? -eq 1 ] && grep -q 'stick is gone; the scene has the inputs again' said
verdict $? 'a joystick that is unplugged says so'
end
check 'it took the inputs over and gave them back' says 'taken over           1 times, given back 1 times'
check 'nothing of it was dropped' says ' 0 dropped'
check 'the recording says so' hands '0 1 0'
# held FIRST..LAST, by name: axes and buttons are mapped to the ends
held() { /usr/bin/python3 -B - "$@" <<'END'
import csv, sys
rows = [r for r in csv.DictReader(open('inputs.csv')) if r['hands [1]'] == '1']
name = next(k for k in rows[0] if k.startswith('held.' + sys.argv[1] + ' '))
seen = [float(r[name]) for r in rows]
sys.exit(not all(abs(a - float(b)) < 1e-9 for a, b in zip((seen[0], seen[-1]), sys.argv[2:])))
END
}
check 'an axis in the middle, then at its end' held rack 0 0.03
check 'an axis at its end, then over the middle' held accelerator 0 0.75000762962
check 'a pedal that is not pressed' held brake 0 0
check 'a button' held selector 0 1
check 'it replays' again "$vehicle" "$lane"

# the same by gicrun itself; packets do not come in between. The pipe stays open until all is said
axes=rack=axis0:0.03:-0.03,accelerator=axis5:0:1,brake=axis2:0:1,selector=button0:0:1
exec 4<>stick
begin "$vehicle" "$lane" --seconds 6 -o live.csv --record inputs.csv --joystick stick --axes "$axes" 4>&-
/usr/bin/python3 stick.py stick &
writer=$!
sleep 1
(cd "$root/tests/tools" && /usr/bin/python3 -B -c 'import live, sys; p = live.Peer(int(sys.argv[1])); p.send(p.begin)' "$port") >said 2>&1
wait "$writer"
exec 4>&-
end
check 'a joystick that is gone is told' says 'warning: the joystick stick is gone at t = '
check 'the joystick took the inputs over and gave them back' says 'taken over           1 times, given back 1 times'
check 'packets meanwhile were dropped' says ' 1 dropped: 1 of another sender'
check 'its recording says so' hands '0 1 0'
check 'its axis in the middle, then at its end' held rack 0 0.03
check 'its axis at an end, then over the middle' held accelerator 0 0.75000762962
check 'its pedal that is not pressed' held brake 0 0
check 'its button' held selector 0 1
check 'its run replays' again "$vehicle" "$lane"
for wrong in rack=axis0:1 rack=axle0:0:1 rack=axis0:a:1 rack=axis0:-1:1 pinion=axis0:0:1 rack=axis256:0:0.01 rack=axis0.5:0:0.01; do
    "$gicrun" --live 0 "$vehicle" "$lane" --seconds 1 --joystick stick --axes $wrong -o no.csv >out 2>err
    [ $? -eq 1 ] && [ ! -e no.csv ] && [ "$(grep -c 'error: ' err) $(grep -c 'remedy: ' err)" = '1 1' ]
    verdict $? "no mapping of gicrun: $wrong"
done
"$gicrun" --live 0 "$vehicle" "$lane" --seconds 1 --joystick none --axes rack=axis0:0:0.01 >out 2>err
check 'no such device' says "can't open the joystick none: No such file"
"$gicrun" --live 0 "$vehicle" "$lane" --seconds 1 --joystick stick >out 2>err
[ $? -eq 2 ]
verdict $? 'a joystick that moves nothing'
for wrong in rack=axis0:1 rack=axle0:0:1 rack=axis0:a:1; do
    begin "$vehicle" "$lane" --seconds 2
    /usr/bin/python3 -B "$root/runtime/examples/live_joystick.py" "$port" stick $wrong >out2 2>said
    [ $? -eq 1 ] && grep -q "instead of '$wrong'" said
    verdict $? "no mapping: $wrong"
    end
done

# ---- packets that are wrong

begin "$vehicle" "$lane" --seconds 6 -o live.csv --record inputs.csv
tool wrong "$port"
verdict $? 'packets of all kinds of mistakes, counted one by one'
end
check 'the run does not mind' exits 0
check 'histograms have all steps' sums
for reason in '3 of a wrong size' '3 of another kind or version' '1 for another model or scene' '1 with unknown flags' \
    '3 not finite numbers' '2 outside of a' '2 old or repeated' '1 of another sender'; do
    check "dropped: $reason" says "$reason"
done
check 'it replays' again "$vehicle" "$lane"

begin "$vehicle" "$lane" --seconds 9 -o live.csv --record inputs.csv
tool fuzz "$port" 4000
verdict $? 'thousands of random packets'
end
check 'the run does not mind' exits 0
check 'none of them drove' says '0 packets good'
check 'none of them was recorded' [ "$(wc -l <inputs.csv)" -eq 3 ]
check 'it is the run of the scene still' same_start

# ---- who sends nothing any more has given back

begin "$vehicle" "$lane" --seconds 4 -o live.csv --record inputs.csv
tool leave "$port"
verdict $? 'someone leaves without a word, and another one may drive'
end
check 'taken over twice' says 'taken over           2 times, given back 2 times'
check 'it replays' again "$vehicle" "$lane"

# ---- a model without a driver; signals

for signal in INT TERM; do
    begin "$quarter" "$root/models/scenes/quarter_car.scene" -o live.csv --record inputs.csv
    sleep 1
    kill -s $signal $runner
    end
    check "SIG$signal ends it well" exits 0
    check 'with its table' sums
    check 'with whole files' again "$quarter" "$root/models/scenes/quarter_car.scene"
done

# ---- a run that fails: its recording fails as well

cat <<'END' >failing.veh
gicgen: 1
model: failing
base: ground
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  g: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0]}
inputs:
  push: {unit: N}
forces:
  f: {type: force, coordinate: x, value: "push - 1e6 * x"}
END
printf 'gicscene: 1\nduration: 2\nstep: 0.005\ninitial: {coordinates: {x: 0.01}}\n' >failing.scene
run --live 0 failing.veh failing.scene --seconds 3 --record inputs.csv
check 'a run that fails' exits 1
run -q --replay inputs.csv failing.veh failing.scene -o again.csv
check 'fails when it is replayed' exits 1
# a rod and its strut come on one line where the strut is 2 + 1 m long
cat >strut.veh <<'END'
gicgen: 1
model: strut
gravity: [0, 0, 0]
base: ground
bodies: {rod: {mass: 1, com: [0, 1, 0], inertia: [0.1, 0.1, 0.1]}}
joints: {hinge: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 0, 1]}}
coordinates: {strut: {type: length, bodies: [ground, rod], points: [[-2, 0, 0], [0, 1, 0]], range: [0.5, 4]}}
END
printf 'gicscene: 1\nduration: 2\nstep: 0.005\ninitial: {rates: {strut: 1}}\n' >strut.scene
run --live 0 strut.veh strut.scene --seconds 2
check 'a dead centre ends the run' exits 1
check 'it is named' says "dead centre.*'strut' = 3 m"

# ---- mistakes

begin "$quarter" "$root/models/scenes/quarter_car.scene" --seconds 20
"$gicrun" --live "$port" "$quarter" "$root/models/scenes/quarter_car.scene" --seconds 1 -o none.csv >out2 2>err2
[ $? -eq 1 ] && grep -q "can't take port $port of the loopback interface" err2 && grep -q 'another program has it' err2
verdict $? 'a port that is taken'
check 'and no files' [ ! -e none.csv ]
kill "$runner"
end
for port in -1 65536 x '' 5.5; do
    run --live "$port" "$quarter" "$root/models/scenes/quarter_car.scene"
    check "no port: '$port'" exits 2
    check 'it says what a port is' says 'takes a port from 1 to 65535'
done
run --live 0 "$vehicle" "$lane" --inputs accelerator,brke
check 'an input that is none' exits 1
check 'it says so' says "has no input 'brke'"
check 'it has a remedy' says "did you mean 'brake'?"
run --live 0 "$vehicle" "$lane" --inputs ,
check 'no input' says 'no inputs are named'
run --live 0 --integrator adams "$vehicle" "$lane"
check 'variable steps' says 'only constant steps keep a clock'
for wrong in '--plot a.svg' '--animate a.html' '--replay a.csv' '--modes'; do
    # shellcheck disable=SC2086  # two words
    run --live 0 $wrong "$vehicle" "$lane"
    check "not with $wrong" exits 2
done
run "$vehicle" "$lane" --record inputs.csv
check '--record alone' says 'go with --live'
run --live 0 "$vehicle" "$lane" --seconds 1 --record live.csv -o live.csv
check 'one file for both' exits 2
if unshare -n true 2>"$work/said"; then
    unshare -n "$gicrun" --live 5005 "$quarter" "$root/models/scenes/quarter_car.scene" --seconds 1 >out 2>err
    status=$?
    check 'no route' exits 1
    check 'it has a remedy' says 'ip link set lo up'
fi
if [ "$(id -u)" -eq 0 ] && command -v setpriv >"$work/said"; then
    setpriv --bounding-set=-all --inh-caps=-all sh -c 'ulimit -l 64; ulimit -r 0; exec "$@"' sh \
        "$gicrun" --live 0 "$quarter" "$root/models/scenes/quarter_car.scene" --seconds 0.2 >out 2>err
    status=$?
    check 'without rights it runs' exits 0
    check 'it says what is not locked' says 'memory is not locked'
    check 'and what is not raised' says 'not raised to SCHED_FIFO'
    check 'and what to do' says '/etc/security/limits.conf'
fi

# recordings that were changed
begin "$vehicle" "$lane" --seconds 0.3 --record inputs.csv
end
# refused TEXT: a replay of changed.csv ends in this message
refused() {
    run -q --replay changed.csv "$vehicle" "$lane" -o again.csv
    [ "$status" -eq 1 ] && says "$1"
}
sed 's/held.brake/held.break/' inputs.csv >changed.csv
check 'another input' refused "has no input 'break'"
cut -d, -f1-3,5- inputs.csv >changed.csv
check 'no rate' refused "has no column 'held.rack.rate'"
sed '2s/^0,0/0,3/' inputs.csv >changed.csv
check 'unknown hands' refused 'hands must be 0, 1 or 2'
sed '2s/^0,/0.001,/' inputs.csv >changed.csv
check 'a time between steps' refused 'multiple of the step'
sed '$s/^[^,]*,/0,/' inputs.csv >changed.csv
check 'times that do not rise' refused 'times must rise'
sed '$d' inputs.csv >changed.csv
check 'one row' refused 'fewer than two rows'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
