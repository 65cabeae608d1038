#!/bin/sh
# SPDX-License-Identifier: MIT
# test_fmu_platforms.sh GICGEN: binaries of FMUs for 64-bit ARM Linux and 64-bit Windows run under QEMU and Wine: loaded,
# another GUID refused, co-simulation. The pendulum and the HMMWV need no function of libm but sqrt for a step, so that
# every bit is this machine's; with tires and powertrain, functions of another libm differ by a unit in the last place,
# which the motion carries on: 1e-9 of 1 and the value.
gicgen=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/fmi/small/lib.sh
. "$(dirname "$0")/../fmi/small/lib.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
GICGEN_CACHE=
WINEPREFIX=$work/prefix
WINEDEBUG=-all
export GICGEN_CACHE WINEPREFIX WINEDEBUG
wine=$(command -v /usr/lib/wine/wine64 wine64 wine | head -n 1)
if [ -z "$wine" ]; then
    # the package has another name for this command
    check "wine is installed: sh tests/install.sh test" eval '! apt-cache show wine64 >/dev/null 2>&1'
    echo "not tried: Windows, for this system has no package wine64"
elif ! timeout 300 "$wine" cmd /c exit >"$work/out" 2>&1; then
    # containers and sandboxes may forbid what Wine needs of a kernel
    echo "not tried: Windows, for Wine does not start here: $(tail -n 1 "$work/out")"
    wine=
fi
case $(uname -m) in
x86_64) ;;
*) echo "this machine is no x86_64: binaries are looked for under another name"; exit 1 ;;
esac

# steps COMPILER OUTPUT [FLAG ...]: the program that runs FMUs
steps() {
    compiler=$1 output=$2
    shift 2
    "$compiler" -std=c11 -Wall -Wextra -Werror -O1 -DVERSION=$version "$root/tests/fmi/small/steps.c" -o "$work/$output" "$@"
}
# near FILE FILE: numbers agree
near() {
    paste -d ' ' "$1" "$2" | awk '{ d = $2 - $4; m = $2 < 0 ? -$2 : $2; if (d < 0) d = -d
        if (!(d <= 1e-9 * (1 + m))) { print; bad = 1 } } END { exit bad || NR < 3 }'
}
# same MODEL FILE: as here, to the last bit but for models with tires
same() {
    case $1 in
    *vehicle) near "$work/here.txt" "$2" ;;
    *) cut -d ' ' -f 1 "$work/here.txt" >"$work/here.bits" && cut -d ' ' -f 1 "$2" | cmp - "$work/here.bits" ;;
    esac >"$work/out" 2>&1
}

for version in 2 3; do
    linux=linux64 arm=aarch64-linux windows=win64
    [ $version = 2 ] || { linux=x86_64-linux windows=x86_64-windows; }
    steps "${CC:-cc}" here -ldl >"$work/out" 2>&1 && steps aarch64-linux-gnu-gcc arm -ldl >>"$work/out" 2>&1 &&
        steps x86_64-w64-mingw32-gcc windows.exe >>"$work/out" 2>&1
    verdict $? "the program that runs FMI $version.0 compiles for all three"
    for model in pendulum hmmwv hmmwv_vehicle; do
        name=$model$version
        unit "$name" $version "$root/models/$model.veh"
        verdict $? "$model: FMI $version.0"
        set -- "$(token "$name")" "$(outputs "$name")"
        "$work/here" 0.01 100 "$work/$name/binaries/$linux/$model.so" "$@" >"$work/here.txt" 2>"$work/err" &&
            [ "$(wc -l <"$work/here.txt")" -gt 3 ]
        verdict $? "$model, FMI $version.0: here"
        qemu-aarch64 -L /usr/aarch64-linux-gnu "$work/arm" 0.01 100 "$work/$name/binaries/$arm/$model.so" "$@" \
            >"$work/arm.txt" 2>"$work/err" && same "$model" "$work/arm.txt"
        verdict $? "$model, FMI $version.0: ARM"
        [ -n "$wine" ] || continue
        "$wine" "$work/windows.exe" 0.01 100 "$work/$name/binaries/$windows/$model.dll" "$@" 2>"$work/err" |
            tr -d '\r' >"$work/windows.txt"
        [ "$(wc -l <"$work/windows.txt")" -eq "$(wc -l <"$work/here.txt")" ] && same "$model" "$work/windows.txt"
        verdict $? "$model, FMI $version.0: Windows"
    done
done

# Wine's server goes on for some seconds and would write into a folder that is gone
[ -z "$wine" ] || "$(dirname "$wine")/wineserver" -k >"$work/out" 2>&1
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
