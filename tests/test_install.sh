#!/bin/sh
# SPDX-License-Identifier: MIT
# test_install.sh GICGEN GICRUN GICBENCH: what `make install` installs works from any folder and without the sources,
# pkg-config finds it, manuals name every option that -h names and no other, and `make uninstall` leaves nothing.
root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/checking.sh
. "$(dirname "$0")/checking.sh"
build=$(cd "$(dirname "$1")" && pwd)

# a blank-free prefix that is not the default, collected elsewhere as packagers do
prefix=/opt/gic
made() {
    make --no-print-directory -s -C "$root" BUILD="$build" WERROR=-Werror DESTDIR="$work/stage" PREFIX=$prefix "$@"
}
umask 077 # modes of what is installed must not depend on it
check 'make install' made install
there=$work/stage$prefix

# ---- files and modes ---------------------------------------------------------------------------------------

modes() { [ -z "$(find "$there" "$@")" ] || { find "$there" "$@" -printf '%m %p\n'; false; }; }
check 'folders may be read by all' modes -type d ! -perm 0755
check 'programs may be run by all' modes -path "$there/bin/*" ! -perm 0755
check 'other files may be read by all and run by none' modes -type f ! -path "$there/bin/*" ! -perm 0644
for file in bin/gicgen bin/gicrun bin/gicsweep bin/gicbench include/gic_runtime.h include/gic_road.h include/gic_batch.h include/gic_lanes.h \
    lib/libgic_runtime.a \
    lib/pkgconfig/gicgen.pc share/gicgen/gic_runtime.c share/gicgen/gic_road.c share/gicgen/models/hmmwv.veh \
    share/gicgen/models/parts/chassis.veh share/gicgen/models/scenes/paper_run.scene \
    share/gicgen/models/roads/field_track.csv share/gicgen/models/tires/hmmwv_pac2002.tir \
    share/gicgen/models/FORMAT.md share/man/man1/gicgen.1 share/man/man1/gicrun.1 \
    share/man/man1/gicsweep.1 share/man/man1/gicbench.1; do
    check "$file is there" [ -s "$there/$file" ]
done
models() { find "$1/models" -type f | wc -l; }
check 'all models are there' [ "$(models "$there/share/gicgen")" -eq "$(models "$root")" ]
check 'nothing speaks of the place of collection, and nothing is left to fill in' \
    sh -c "! grep -rIl -e '$work' -e '@PREFIX@' -e '@VERSION@' '$there'"

# ---- manuals -----------------------------------------------------------------------------------------------

# options PATTERN: all words - or -- on standard input that look like options, each once
options() { grep -oE -- '(^|[^[:alnum:]-])--?[[:alpha:]][[:alnum:]-]*' | sed 's/^[^-]*//' | sort -u; }
for program in gicgen gicrun gicsweep gicbench; do
    page=$there/share/man/man1/$program.1
    "$there/bin/$program" -h | options >"$work/help"
    # .It Fl o , Fl -output Ar file
    sed -n 's/^\.It Fl //p' "$page" | sed 's/ , Fl /\n/g' | sed 's/ .*//; s/^/-/' | sort >"$work/page"
    check "$program has options" grep -q -- --version "$work/help"
    check "$program: the manual has the options of -h" diff "$work/help" "$work/page"
    for heading in NAME SYNOPSIS DESCRIPTION 'EXIT STATUS' FILES EXAMPLES; do
        check "$program: the manual has $heading" grep -q "^\.Sh $heading$" "$page"
    done
    "$there/bin/$program" -h | grep -oE '\$[A-Z_]+' | tr -d '$' | sort -u >"$work/variables"
    check "$program: the manual has the environment of -h" sh -c \
        "while read -r v; do grep -q \"^\.\(It \)\{0,1\}Ev \$v\" '$page' || exit 1; done <'$work/variables'"
    # style would ask for manuals of other packages too
    check "$program: mandoc finds nothing" mandoc -T lint -W warning "$page"
done

# ---- programs from another folder --------------------------------------------------------------------------

mkdir "$work/elsewhere"
cd "$work/elsewhere" || exit 1
PATH=$there/bin:$PATH
PKG_CONFIG_PATH=$there/lib/pkgconfig
export PATH PKG_CONFIG_PATH
# the files stand below DESTDIR here, unlike after a package's installation
config() { pkg-config --define-variable=prefix="$there" "$@" gicgen; }

check 'gicgen works' gicgen "$there/share/gicgen/models/hmmwv.veh" -o hmmwv.c
sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '/^```/d' >main.c
# shellcheck disable=SC2046  # lists of words
{
    check "README's example in double precision" cc -std=c99 -Wall -Wextra -Werror -O1 $(config --cflags) \
        main.c hmmwv.c $(config --libs) -o double
    check "README's example in single precision" cc -std=c99 -Wall -Wextra -Werror -O1 -DGIC_FLOAT $(config --cflags) \
        main.c hmmwv.c $(config --libs) -o single
    check "README's example with the runtime as source" cc -std=c99 -O1 $(config --cflags) main.c hmmwv.c \
        "$(config --variable=runtime)" -lm -o source
    check 'the runtime in a shared object' cc -shared -fPIC -O0 $(config --cflags) hmmwv.c $(config --libs) -Wl,-z,defs \
        -o model.so
}
# its chassis stands at 0.474 m
for program in double single source; do
    stands() { "./$program" | awk '/^ok: / { z = $6 } END { exit !(z > 0.473 && z < 0.475) }'; }
    check "the program $program runs" stands
done
version() { [ "gicgen $(pkg-config --modversion gicgen)" = "$(gicgen --version)" ]; }
check "pkg-config's version is gicgen's" version
recorded() { [ "$(pkg-config --variable=runtime gicgen)" = $prefix/share/gicgen/gic_runtime.c ]; }
check 'pkg-config names the installed place' recorded
check 'gicrun works' gicrun "$there/share/gicgen/models/pendulum.veh" \
    "$there/share/gicgen/models/scenes/pendulum.scene" -o run.csv
check 'its results are there' grep -q '^time' run.csv
check 'gicbench works' gicbench --version

# ---- uninstall ---------------------------------------------------------------------------------------------

: >"$there/bin/foreign"
check 'make uninstall' made uninstall
check 'only what is foreign stays' [ "$(find "$work/stage" -type f)" = "$there/bin/foreign" ]
check 'no folder of its own stays' [ ! -e "$there/share/gicgen" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
