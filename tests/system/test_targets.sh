#!/bin/sh
# SPDX-License-Identifier: MIT
# test_targets.sh GICGEN: the HMMWV, emitted, cross-compiled and run on the processors it is meant for, under QEMU: a bare
# Cortex-M7 in double and single precision, and 64-bit ARM Linux. Every bit of the state must be the host's: without
# contraction all of them compute in IEEE arithmetic, and the run needs no function of libm but sqrt. Code, data and stack
# sizes are printed.
gicgen=$1
targets=$(cd "$(dirname "$0")/../data/targets" && pwd)
runtime=$(cd "$(dirname "$0")/../../runtime" && pwd)
models=$(cd "$(dirname "$0")/../../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

"$gicgen" "$models/hmmwv.veh" -o "$work/hmmwv.c" || exit 1
cp "$runtime"/gic_runtime.[ch] "$runtime"/gic_road.[ch] "$targets"/* "$work/"
cd "$work" || exit 1
options="-std=c99 -O2 -ffp-contract=off -Wall -Wextra -Werror -I."
code="drive.c print.c hmmwv.c gic_runtime.c gic_road.c"
# a run that diverges would still agree with itself: the chassis' height after it, from its bits on the host
height() {
    python3 -c "import struct, sys
lines = open('$1').read().split()[:-1]
print(struct.unpack('>' + 'df'[len(lines[-1]) == 8], bytes.fromhex(lines[-23 + 2]))[0])"
}

for real in double float; do
    define=$([ $real = float ] && echo -DGIC_FLOAT)
    # shellcheck disable=SC2086  # lists of words
    cc $options $define $code hosted.c -o "host_$real" -lm && "./host_$real" >"host_$real.txt"
    verdict $? "host, $real"
    [ "$(wc -l <"host_$real.txt")" -eq $((8 * 24 + 1)) ]
    verdict $? "host, $real: numbers printed"
    height "host_$real.txt" | awk '{ exit !($1 > 0.3 && $1 < 2) }'
    verdict $? "host, $real: the chassis stays on its wheels ($(height "host_$real.txt"))"

    # shellcheck disable=SC2086
    aarch64-linux-gnu-gcc $options $define -static $code hosted.c -o "arm64_$real" -lm &&
        qemu-aarch64 "./arm64_$real" >"arm64_$real.txt"
    verdict $? "aarch64, $real"
    cmp "host_$real.txt" "arm64_$real.txt"
    verdict $? "aarch64, $real: same bits as the host"

    # fpv5-d16: the Cortex-M7 with double precision; -nostartfiles: cortex_m.c starts it
    # shellcheck disable=SC2086
    arm-none-eabi-gcc -mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 $options $define -ffunction-sections \
        -fno-math-errno -nostartfiles -Wl,--gc-sections -T mps2_an500.ld cortex_m.c $code -o "m7_$real" -lm &&
        qemu-system-arm -M mps2-an500 -display none -monitor none -serial none -semihosting-config enable=on,target=native \
            -kernel "m7_$real" >"m7_$real.out" 2>&1
    verdict $? "Cortex-M7, $real"
    grep -v '^stack' "m7_$real.out" | cmp - "host_$real.txt"
    verdict $? "Cortex-M7, $real: same bits as the host"
    stack=$(sed -n 's/^stack 0*\([1-9][0-9]*\) bytes$/\1/p' "m7_$real.out")
    [ -n "$stack" ] && [ "$stack" -lt 16384 ]
    verdict $? "Cortex-M7, $real: stack of '$stack' bytes is below 16 kB"
    arm-none-eabi-size "m7_$real" | awk -v real="$real" -v stack="$stack" \
        'NR == 2 { print "Cortex-M7, " real ": " $1 + $2 " bytes of code and constants, " $3 " of data, " stack " of stack" }'
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
