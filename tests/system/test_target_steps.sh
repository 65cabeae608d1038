#!/bin/sh
# SPDX-License-Identifier: MIT
# test_target_steps.sh GICGEN: explicit and implicit steps of a vehicle on an emulated bare Cortex-M7 (tests/data/targets/steps.c):
# every bit of the state is the host's, with elementary functions of the test's own on both; and how many instructions a step takes, with those of
# newlib. QEMU's `-icount shift=0` lets an instruction take 1 ns, so a timer counts them, to 40; instructions are not cycles. Judged by a loop of known
# length, by the same counts in another run, and by what the methods have in common. The vehicle is hmmwv_vehicle with
# half an accelerator, or what environment variables name: MODEL, INPUT and its VALUE; with STIFF, a step in s, states without a share in motions that are stiff then are explicit.
gicgen=$1
model=${MODEL:-hmmwv_vehicle}
input=${INPUT:-ACCELERATOR}
value=${VALUE:-0.5}
targets=$(cd "$(dirname "$0")/../data/targets" && pwd)
runtime=$(cd "$(dirname "$0")/../../runtime" && pwd)
models=$(cd "$(dirname "$0")/../../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# shellcheck disable=SC2086  # a list of words
"$gicgen" --implicit --spread-jacobian ${STIFF:+--stiff $STIFF} "$models/$model.veh" -o "$work/$model.c" || exit 1
cp "$runtime"/gic_runtime.[ch] "$targets"/* "$work/"
cd "$work" || exit 1
upper=$(echo "$model" | tr '[:lower:]' '[:upper:]')
# sine and cosine of one angle would be another function of glibc's
options="-std=c99 -O2 -ffp-contract=off -fno-builtin-sin -Wall -Wextra -Werror -I. -DMODEL=$model -DINPUT=${upper}_INPUT_$input -DVALUE=$value"
m7="-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 -ffunction-sections -fno-math-errno -nostartfiles -Wl,--gc-sections -T mps2_an500.ld"
code="steps.c print.c gic_runtime.c"
qemu="qemu-system-arm -M mps2-an500 -display none -monitor none -serial none -semihosting-config enable=on,target=native"

# shellcheck disable=SC2086  # lists of words
{
    cc $options -c "$model.c" -o host.o && cc $options -c -fno-builtin elementary.c && cc $options host.o elementary.o $code hosted.c -o host -lm
    verdict $? "compiles for the host"
    arm-none-eabi-gcc ${m7%-nostartfiles*} $options -c "$model.c" -o m7.o && arm-none-eabi-gcc ${m7%-nostartfiles*} $options -fno-builtin -c elementary.c &&
        arm-none-eabi-gcc $m7 $options m7.o elementary.o $code cortex_m.c -o m7_own -lm && arm-none-eabi-gcc $m7 $options m7.o $code cortex_m.c -o m7 -lm
    verdict $? "compiles for the Cortex-M7"
    ./host >host.txt && $qemu -kernel m7_own >own.txt 2>&1 </dev/null && $qemu -icount shift=0 -kernel m7 >first.txt 2>&1 </dev/null &&
        $qemu -icount shift=0 -kernel m7 >second.txt 2>&1 </dev/null
    verdict $? "runs"
}

state() { grep -v '^count\|^stack' "$1"; }
state own.txt >own_state.txt
state host.txt | cmp - own_state.txt
verdict $? "the host's bits"
cmp first.txt second.txt
verdict $? "the same counts in each run"
python3 - "$model" <<'EOF' >said 2>&1
import struct, sys

def lines(path, counts):
    return [line.split(None, 4) for line in open(path) if line.startswith("count") == counts and not line.startswith("stack")]

def states(path):
    return [struct.unpack(">d", bytes.fromhex(line[0]))[0] for line in lines(path, False) if line[0] != "ok"]

count = {name.strip(): [int(n) for n in numbers] for _, *numbers, name in lines("first.txt", True)}
print(f"{sys.argv[1]}, Cortex-M7, instructions of 1 ms: mean, longest, longest without those that check")
for name, numbers in count.items():
    print("{:26} {:9} {:9} {:9}".format(name, *numbers))
print(open("first.txt").read().splitlines()[-1])
own, newlib = states("own.txt"), states("first.txt")
assert len(own) == len(newlib) and len(own) % 28 == 0, len(own)
apart = max(abs(a - b) / (1 + abs(b)) for a, b in zip(own, newlib))
print(f"own functions against newlib's: {apart:.1e}")
assert apart < 1e-9
# the loop, a timer of 40, and what asks it
assert 0 <= count["loop"][0] - 4000000 <= 120, count["loop"]
whole, _, plain = count["ros2, a Jacobian each"]
for method in "ros2, keep 16", "imex, keep 16":
    mean, longest, _ = count[method]
    shared, longest_shared, _ = count[method + ", shares"]
    assert abs(shared / mean - 1) < 0.03, method      # the same work
    assert longest_shared < 0.5 * longest, method     # but not at once
    assert longest_shared < 2 * shared, method
    assert longest > 0.6 * whole, method
# the work of a Jacobian and its factors from what it takes in each step or in 16, and from 16 or 32, of which 200 steps have no whole number
work = 16 / 15 * (whole - count["ros2, keep 16"][0])
assert abs(32 * (count["ros2, keep 16, shares"][0] - count["ros2, keep 32, shares"][0]) / work - 1) < 0.1
# one right-hand side a step for two
assert 0.5 < count["imex, keep 16"][0] / count["ros2, keep 16"][0] < 0.75
assert plain <= whole * 1.02
EOF
verdict $? "counts"
cat said
grep -v '^[0-9a-f]*$' first.txt | grep -q '^stack' && [ "$(sed -n 's/^stack 0*\([1-9][0-9]*\) bytes$/\1/p' first.txt)" -lt 16384 ]
verdict $? "stack below 16 kB"
arm-none-eabi-size m7 | awk 'NR == 2 { print "Cortex-M7: " $1 + $2 " bytes of code and constants, " $3 " of data" }'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
