# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# lib.sh: what scripts need that run FMUs in the importer; to be sourced after checking.sh, with $gicgen and $root set.

# other platforms are not what this is about, and take two thirds of the time; $all_platforms has them
# shellcheck disable=SC2154  # $work is set by who sources this
mkdir "$work/without"
for name in aarch64-linux-gnu-gcc x86_64-w64-mingw32-gcc; do
    printf '#!/bin/sh\nexit 1\n' >"$work/without/$name"
    chmod +x "$work/without/$name"
done
# shellcheck disable=SC2034  # for who sources this
all_platforms=$PATH
PATH=$work/without:$PATH
case $(uname -m) in
x86_64) ;;
*) echo "this machine is no x86_64: binaries are looked for under another name"; exit 1 ;;
esac

# units compile without optimization, in a tenth of the time: bits do not depend on it, and gicrun's code is optimized
printf '#!/bin/sh\nexec %s "$@" -O0\n' "${CC:-cc}" >"$work/plain_cc"
chmod +x "$work/plain_cc"

# shellcheck disable=SC2154
here=$root/tests/fmi
strict="-std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -g -O1"
libraries="-lsundials_cvode -lsundials_nvecserial -lsundials_sunlinsoldense -lsundials_sunmatrixdense -lxml2 -ldl -lm"
# SUNDIALS of Debian 13 has a core library of its own, and communicators of MPI in its interface
if [ -n "$(find /usr/lib -name libsundials_core.so -print -quit)" ]; then
    mpi=$(pkgconf --cflags mpi-c)
    libraries="-lsundials_core $libraries $(pkgconf --libs mpi-c)"
fi
# shellcheck disable=SC2034  # for who sources this
sanitize="-fsanitize=address,undefined -fno-sanitize-recover=all"
# importer FLAGS
importer() {
    # shellcheck disable=SC2086  # lists of words
    ${CC:-cc} $strict "$@" ${mpi-} -I/usr/include/libxml2 "$here"/*.c $libraries
}

# unpack FMU FOLDER
unpack() { mkdir "$2" && python3 -m zipfile -e "$1" "$2"; }

# unit MODEL.veh [SCENE]: an FMU of version $version in $work/unit
# shellcheck disable=SC2154  # $version
unit() {
    rm -rf "$work/unit"
    CC=$work/plain_cc "$gicgen" --fmu "$version" "$1" ${2:+--scene "$2"} -o "$work/unit.fmu" >"$work/out" 2>"$work/err" &&
        unpack "$work/unit.fmu" "$work/unit"
}
platform() { [ "$version" = 2 ] && echo "linux64" || echo "x86_64-linux"; }
drive() {
    library=$(echo "$work/unit/binaries/$(platform)/"*.so)
    "$work/importer" "$library" "$work/unit/modelDescription.xml" "$@"
}
described() {
    xmllint --noout --relaxng "$here/description_$version.rng" "$work/unit/modelDescription.xml" >"$work/out" 2>&1 &&
        python3 "$here/rules.py" "$work/unit/modelDescription.xml" "$@" >>"$work/out" 2>&1
}

# as_run TOLERANCE FILE [UNIT ...]: what the importer wrote is what gicrun wrote to FILE
as_run() {
    # shellcheck disable=SC2086  # a list of words
    python3 "$here/compare.py" "$2" "$work/unit.csv" "$1" $3 >"$work/out" 2>&1
}
